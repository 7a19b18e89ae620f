//! Probes: quantities written at every step.

use super::Problems;
use super::condition::resolve;
use super::multibody::Parts;
use super::placed::{Placed, index};
use crate::scene::{Quantity, Scene};
use crate::solver::{Model, Simulation};
use stoss_contact::JointReport;

/// Where a probe looks.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbeTarget {
    /// Global nodes.
    Nodes(Vec<u32>),
    /// A body.
    Body(usize),
    /// A rigid body, beam, string or point mass: its place among the parts of the model, and the nodes that stand for it, its centre or its surface.
    Part(usize, Vec<u32>),
    /// A point that vectors of the model carry with these weights, and its reference position.
    Point(Vec<(u32, f64)>, [f64; 3]),
    /// A joint, by its place among the contacts of the model.
    Joint(usize),
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
            ProbeTarget::Part(part, _) => simulation.part_balance(part),
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
            Quantity::JointForce => self.joint(simulation).map_or([f64::NAN; 3], |joint| joint.force.map(|f| -f)),
            Quantity::JointMoment => self.joint(simulation).map_or([f64::NAN; 3], |joint| {
                // About the point of the first side, on which the opposite force acts.
                let (r, f) = (joint.arm, joint.force);
                std::array::from_fn(|i| {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    -(joint.moment[i] + r[j] * f[k] - r[k] * f[j])
                })
            }),
            Quantity::JointAngle => {
                let angle = self.joint(simulation).and_then(|joint| Some(joint.coordinates.first()?.value));
                [angle.map_or(f64::NAN, f64::to_degrees), 0.0, 0.0]
            }
            Quantity::JointDisplacement => {
                let displacement = self.joint(simulation).and_then(|joint| Some(joint.coordinates.first()?.value));
                [displacement.unwrap_or(f64::NAN), 0.0, 0.0]
            }
            Quantity::AngularVelocity => self.angular_velocity(simulation),
            Quantity::Position => self.mean(&simulation.state().q),
            Quantity::Velocity => self.mean(&simulation.state().v),
            Quantity::Elevation => {
                let [x, y, z] = self.mean(&simulation.state().v);
                // What is at rest points nowhere.
                let angle = if [x, y, z] == [0.0; 3] { f64::NAN } else { z.atan2(x.hypot(y)).to_degrees() };
                [angle, 0.0, 0.0]
            }
            Quantity::Displacement => {
                let (q, x) = (self.mean(&simulation.state().q), self.mean(&simulation.model().reference));
                std::array::from_fn(|i| q[i] - x[i])
            }
        }
    }

    fn nodes(&self) -> &[u32] {
        match &self.target {
            ProbeTarget::Nodes(nodes) | ProbeTarget::Part(_, nodes) => nodes,
            ProbeTarget::Body(_) | ProbeTarget::Point(..) | ProbeTarget::Joint(_) | ProbeTarget::Model => &[],
        }
    }

    /// What the joint does; nothing once it is released or switched off.
    fn joint(&self, simulation: &Simulation) -> Option<JointReport> {
        let ProbeTarget::Joint(place) = self.target else { return None };
        simulation.model().contacts[place].method.joint(&simulation.state().q, &simulation.pressures()[place])
    }

    /// Of a rigid body.
    fn angular_velocity(&self, simulation: &Simulation) -> [f64; 3] {
        let ProbeTarget::Part(part, _) = self.target else { return [f64::NAN; 3] };
        let part = &simulation.model().parts[part];
        let directions = part.own_vectors().filter(|&vector| part.is_direction(vector));
        stoss_part::angular_velocity(directions, &simulation.state().q, &simulation.state().v)
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
        if let ProbeTarget::Point(terms, _) = &self.target {
            let component = |i: usize| terms.iter().map(|&(node, w)| w * vector[3 * node as usize + i]).sum();
            return std::array::from_fn(component);
        }
        let count = self.nodes().len().max(1) as f64;
        self.sum(vector).map(|s| s / count)
    }
}

/// The place of a part among those of the model, and the nodes that stand for it with a quantity: forces of contact are those on all of its nodes, supports act
/// on the vectors of a rigid body, and its motion is that of its centre.
fn part_target(placed: &[Placed], model: &Model, name: &str, quantity: Quantity) -> Option<ProbeTarget> {
    let p = model.parts.iter().position(|part| part.name() == name)?;
    let own = model.parts[p].own_vectors();
    let all = || placed.iter().find(|part| part.name == name).and_then(|part| part.nodes_of("all").ok());
    let nodes = match quantity {
        Quantity::ContactForce | Quantity::ContactMoment => all()?,
        Quantity::ReactionMoment => own.collect(),
        _ => vec![own.start],
    };
    Some(ProbeTarget::Part(p, nodes))
}

/// Whether a quantity tells of a motion, which any point of a rigid body has; forces act on nodes.
fn moves(quantity: Quantity) -> bool {
    use Quantity::{Displacement, Elevation, Position, Velocity};
    matches!(quantity, Displacement | Position | Velocity | Elevation)
}

pub(super) fn probes(
    scene: &Scene,
    placed: &[Placed],
    parts: &Parts,
    model: &Model,
    problems: &mut Problems<'_>,
) -> Vec<Probe> {
    let mut out = Vec::new();
    for (p, item) in scene.probes.iter().enumerate() {
        let target = if let Some(set) = &item.set {
            match resolve(placed, &format!("probe[{p}].set"), set, problems, Placed::nodes_of) {
                Some((_, nodes)) => ProbeTarget::Nodes(nodes),
                None => continue,
            }
        } else if let Some(joint) = item.joint.as_deref().and_then(|name| scene.joint_index(name)) {
            let Some(place) = parts.joints.get(joint).copied().flatten() else { continue };
            ProbeTarget::Joint(place)
        } else if let (true, Some(point), Some(terms)) = (
            moves(item.quantity),
            item.point,
            item.point.zip(item.body.as_deref()).and_then(|(x, b)| parts.point(b, x)),
        ) {
            ProbeTarget::Point(terms, point)
        } else if let (Some(point), Some(b)) = (item.point, item.body.as_deref().and_then(|b| index(placed, b))) {
            ProbeTarget::Nodes(vec![placed[b].nearest(point).0])
        } else if let Some(b) = item.body.as_deref().and_then(|b| scene.body_index(b)) {
            ProbeTarget::Body(b)
        } else if let Some(target) =
            item.body.as_deref().and_then(|name| part_target(placed, model, name, item.quantity))
        {
            target
        } else {
            ProbeTarget::Model
        };
        out.push(Probe { name: item.name.clone(), target, quantity: item.quantity });
    }
    out
}
