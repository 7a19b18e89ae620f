//! Probes: quantities written at every step.

use super::condition::resolve;
use super::{Placed, Problems};
use crate::scene::{Quantity, Scene};
use crate::solver::Simulation;

/// Where a probe looks.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbeTarget {
    /// Global nodes.
    Nodes(Vec<u32>),
    /// A body.
    Body(usize),
    /// The whole model.
    Model,
}

/// A probe: one or three numbers a step. Displacement, position and velocity are means over the nodes, reaction, its moment and contact
/// force are sums; energies and momenta are those of a body or of the whole model.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Name, unique.
    pub name: String,
    /// Where.
    pub target: ProbeTarget,
    /// What.
    pub quantity: Quantity,
}

impl Probe {
    /// Heads of the columns: the name, with `.x`, `.y`, `.z` for vectors.
    pub fn columns(&self) -> Vec<String> {
        if self.quantity.columns() == 1 {
            vec![self.name.clone()]
        } else {
            ["x", "y", "z"].map(|c| format!("{}.{c}", self.name)).to_vec()
        }
    }

    /// The numbers at the last completed step; the first [`Quantity::columns`] count.
    pub fn value(&self, simulation: &Simulation) -> [f64; 3] {
        let balance = match self.target {
            ProbeTarget::Body(body) => simulation.body_balance(body),
            _ => *simulation.balance(),
        };
        match self.quantity {
            Quantity::Energy => [balance.total(), 0.0, 0.0],
            Quantity::KineticEnergy => [balance.kinetic, 0.0, 0.0],
            Quantity::StrainEnergy => [balance.strain, 0.0, 0.0],
            Quantity::LinearMomentum => balance.linear_momentum,
            Quantity::AngularMomentum => balance.angular_momentum,
            Quantity::Reaction => self.sum(simulation.reactions()),
            Quantity::ReactionMoment => self.moment(simulation.reactions(), &simulation.state().q),
            Quantity::ContactForce => self.sum(simulation.contact_force()),
            Quantity::ContactMoment => self.moment(simulation.contact_force(), &simulation.state().q),
            // Scenes with joints and rigid bodies do not get here: see `unsupported`.
            Quantity::JointForce | Quantity::JointMoment | Quantity::JointAngle | Quantity::AngularVelocity => {
                [f64::NAN; 3]
            }
            Quantity::Position => self.mean(&simulation.state().q),
            Quantity::Velocity => self.mean(&simulation.state().v),
            Quantity::Displacement => {
                let (q, x) = (self.mean(&simulation.state().q), self.mean(&simulation.model().reference));
                std::array::from_fn(|i| q[i] - x[i])
            }
        }
    }

    fn nodes(&self) -> &[u32] {
        match &self.target {
            ProbeTarget::Nodes(nodes) => nodes,
            ProbeTarget::Body(_) | ProbeTarget::Model => &[],
        }
    }

    /// Sum over the nodes; zero if the vector does not exist in this model.
    fn sum(&self, vector: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        if !vector.is_empty() {
            for &node in self.nodes() {
                for (i, s) in sum.iter_mut().enumerate() {
                    *s += vector[3 * node as usize + i];
                }
            }
        }
        sum
    }

    /// Sum of `q x f` over the nodes; zero if the forces do not exist in this model.
    fn moment(&self, force: &[f64], q: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        if !force.is_empty() {
            for &node in self.nodes() {
                let first = 3 * node as usize;
                for (i, s) in sum.iter_mut().enumerate() {
                    let (j, k) = (first + (i + 1) % 3, first + (i + 2) % 3);
                    *s += q[j] * force[k] - q[k] * force[j];
                }
            }
        }
        sum
    }

    fn mean(&self, vector: &[f64]) -> [f64; 3] {
        let count = self.nodes().len().max(1) as f64;
        self.sum(vector).map(|s| s / count)
    }
}

pub(super) fn probes(scene: &Scene, placed: &[Placed], problems: &mut Problems<'_>) -> Vec<Probe> {
    let mut out = Vec::new();
    for (p, item) in scene.probes.iter().enumerate() {
        let target = if let Some(set) = &item.set {
            match resolve(placed, &format!("probe[{p}].set"), set, problems, Placed::nodes_of) {
                Some((_, nodes)) => ProbeTarget::Nodes(nodes),
                None => continue,
            }
        } else if let (Some(point), Some(b)) = (item.point, item.body.as_deref().and_then(|b| scene.body_index(b))) {
            ProbeTarget::Nodes(vec![placed[b].nearest(point).0])
        } else if let Some(b) = item.body.as_deref().and_then(|b| scene.body_index(b)) {
            ProbeTarget::Body(b)
        } else {
            ProbeTarget::Model
        };
        out.push(Probe { name: item.name.clone(), target, quantity: item.quantity });
    }
    out
}
