//! Probes: quantities written at every step.

use super::Problems;
use super::condition::resolve;
use super::extreme::Extreme;
use super::multibody::Parts;
use super::placed::{Placed, index};
use super::{state_output, supports};
use crate::scene::{Extremum, Quantity, Scene};
use crate::solver::{Model, Simulation, SurfaceForce};
use std::collections::BTreeSet;
use stoss_fe_solid::MaterialPoint;
use stoss_term::{At, ForceRule, JointReport, Local};

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
    /// A material point of a body.
    Material(usize, MaterialPoint),
    /// The extremum over nodes.
    Extreme(Extreme),
    /// Global nodes, and the places of the elastic supports among the parts of the model.
    Supports(Vec<u32>, Vec<usize>),
    /// A joint, by its place among the contacts of the model.
    Joint(usize),
    /// An equation, by its place among the contacts of the model.
    Equation(usize),
    /// The whole model.
    Model,
}

/// A probe: one or several numbers a step. Displacement, position and velocity are means over the nodes, reaction, its moment and contact
/// force are sums; energies and momenta are those of a body or of the whole model.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Name, unique.
    pub name: String,
    /// Place that is probed.
    pub target: ProbeTarget,
    /// Quantity that is probed.
    pub quantity: Quantity,
    /// What integrals over the model are divided by ([`super::Built::extent`]).
    pub extent: f64,
}

impl Probe {
    /// Heads of the columns: the name, with `.x`, `.y`, `.z` for vectors, `.xx` and so on for tensors; of extrema the name and `.node`.
    pub fn columns(&self) -> Vec<String> {
        let components = self.quantity.components();
        if matches!(self.target, ProbeTarget::Extreme(_)) {
            vec![self.name.clone(), format!("{}.node", self.name)]
        } else if components.is_empty() {
            vec![self.name.clone()]
        } else {
            components.iter().map(|component| format!("{}.{component}", self.name)).collect()
        }
    }

    /// The numbers of [`Self::columns`] at the last completed step.
    pub fn values(&self, simulation: &Simulation) -> Vec<f64> {
        let extent = if self.quantity.is_integral() { self.extent } else { 1.0 };
        match &self.target {
            ProbeTarget::Extreme(extreme) => {
                let [value, node] = extreme.value(simulation);
                vec![value / extent, node]
            }
            ProbeTarget::Material(body, point) => self.material(simulation, *body, point),
            _ => self.value(simulation)[..self.quantity.columns()].iter().map(|value| value / extent).collect(),
        }
    }

    /// What the interpolation of the element gives at a point; not a number where that is turned inside out.
    fn material(&self, simulation: &Simulation, body: usize, point: &MaterialPoint) -> Vec<f64> {
        if self.quantity.is_of_state() {
            let place = simulation.model().bodies[body].solid.state_output(self.quantity.name());
            let values = place.and_then(|place| simulation.state_output_at(body, point, place).ok());
            return values.unwrap_or_else(|| vec![f64::NAN; self.quantity.columns()]);
        }
        let Ok(state) = simulation.state_at(body, point) else {
            return vec![f64::NAN; self.quantity.columns()];
        };
        match self.quantity {
            Quantity::DeformationGradient => state.deformation_gradient.concat(),
            Quantity::GreenLagrangeStrain => state.green_lagrange.to_vec(),
            Quantity::LogarithmicStrain => {
                let f = &state.deformation_gradient;
                let f = stoss_tensor::Tensor2::from_fn(|row, column| f[row][column]);
                stoss_continuum::logarithmic_strain(&f).to_components().to_vec()
            }
            Quantity::PrincipalStresses => stoss_fe_solid::principal_stresses(&state.cauchy).to_vec(),
            Quantity::VonMises => vec![stoss_fe_solid::von_mises(&state.cauchy)],
            _ => state.cauchy.to_vec(),
        }
    }

    /// The first three of [`Self::values`], zero beyond them.
    pub fn value(&self, simulation: &Simulation) -> [f64; 3] {
        if let ProbeTarget::Extreme(_) | ProbeTarget::Material(..) = self.target {
            let values = self.values(simulation);
            return std::array::from_fn(|i| values.get(i).copied().unwrap_or_default());
        }
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
            Quantity::Reaction => self.sum(&simulation.reactions()),
            Quantity::ReactionMoment => self.moment(&simulation.reactions(), &simulation.state().q),
            Quantity::SupportForce => self.support_force(simulation),
            Quantity::ContactForce => {
                added(self.sum(simulation.contact_force()), self.moved(simulation).map(|moved| moved.force))
            }
            Quantity::ContactMoment => {
                let carried = self.moment(simulation.contact_force(), &simulation.state().q);
                added(carried, self.moved(simulation).map(|moved| moved.moment))
            }
            Quantity::EquationForce => [self.multipliers(simulation), 0.0, 0.0],
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
            // Of a material point: above.
            Quantity::CauchyStress
            | Quantity::GreenLagrangeStrain
            | Quantity::LogarithmicStrain
            | Quantity::PrincipalStresses
            | Quantity::VonMises
            | Quantity::EquivalentPlasticStrain
            | Quantity::PlasticStrain
            | Quantity::BackStress
            | Quantity::Yielding
            | Quantity::ViscousStrain
            | Quantity::DeformationGradient => [f64::NAN; 3],
            Quantity::Displacement => {
                let (q, x) = (self.mean(&simulation.state().q), self.mean(&simulation.model().reference));
                std::array::from_fn(|i| q[i] - x[i])
            }
        }
    }

    fn nodes(&self) -> &[u32] {
        match &self.target {
            ProbeTarget::Nodes(nodes) | ProbeTarget::Part(_, nodes) | ProbeTarget::Supports(nodes, _) => nodes,
            ProbeTarget::Body(_)
            | ProbeTarget::Point(..)
            | ProbeTarget::Material(..)
            | ProbeTarget::Extreme(_)
            | ProbeTarget::Joint(_)
            | ProbeTarget::Equation(_)
            | ProbeTarget::Model => &[],
        }
    }

    /// Force of springs and dashpots at the positions and velocities of the end of the step.
    fn support_force(&self, simulation: &Simulation) -> [f64; 3] {
        let ProbeTarget::Supports(nodes, supports) = &self.target else { return [f64::NAN; 3] };
        let state = simulation.state();
        // A step of one unit of time that ends here with the velocity of the state.
        let before: Vec<f64> = match &state.v[..] {
            [] => state.q.clone(),
            v => state.q.iter().zip(v).map(|(q, v)| q - v).collect(),
        };
        let rates = !simulation.is_static();
        let at = At { rates, ..At::force([&before, &state.q], ForceRule::END_POINT, 1.0) };
        let mut sum = [0.0; 3];
        for &support in supports {
            let mut add = |local: &Local| {
                for (node, force) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                    if nodes.binary_search(node).is_ok() {
                        sum.iter_mut().zip(force).for_each(|(s, f)| *s -= f);
                    }
                }
            };
            if simulation.model().parts[support].assemble(&at, false, &mut add).is_err() {
                return [f64::NAN; 3];
            }
        }
        sum
    }

    /// What the joint does; nothing once it is released or switched off.
    fn joint(&self, simulation: &Simulation) -> Option<JointReport> {
        let ProbeTarget::Joint(place) = self.target else { return None };
        simulation.model().contacts[place].joint(&simulation.state().q, &simulation.mean_pressures()[place])
    }

    /// Angular velocity of a rigid body.
    fn angular_velocity(&self, simulation: &Simulation) -> [f64; 3] {
        let ProbeTarget::Part(part, _) = self.target else { return [f64::NAN; 3] };
        let part = &simulation.model().parts[part];
        let directions = part.own_vectors().filter(|&vector| part.is_direction(vector));
        stoss_term::angular_velocity(directions, &simulation.state().q, &simulation.state().v)
    }

    /// Where contact forces act on the surface rather than on the nodes that carry them.
    fn moved<'a>(&'a self, simulation: &'a Simulation) -> impl Iterator<Item = &'a SurfaceForce> {
        let all = simulation.moved_contact_force();
        self.nodes().iter().filter_map(|node| all.get(node))
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

    /// The sum of the multipliers of an equation.
    fn multipliers(&self, simulation: &Simulation) -> f64 {
        let ProbeTarget::Equation(place) = self.target else { return f64::NAN };
        simulation.mean_pressures()[place].iter().sum()
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

/// The sum of vectors.
fn added(first: [f64; 3], others: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    others.fold(first, |sum, x| std::array::from_fn(|i| sum[i] + x[i]))
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

/// Warnings for probes of `reaction` at nodes on which elastic supports act, whose forces are not part of it.
pub(super) fn warnings(scene: &Scene, placed: &[Placed], probes: &[Probe]) -> Vec<String> {
    let supported: BTreeSet<u32> =
        scene.supports.iter().flat_map(|support| supports::nodes_of(placed, &support.set)).collect();
    let is_reaction = |probe: &&Probe| matches!(probe.quantity, Quantity::Reaction | Quantity::ReactionMoment);
    let on_support = probes.iter().filter(is_reaction).filter(|probe| {
        let nodes = match &probe.target {
            ProbeTarget::Extreme(extreme) => extreme.nodes(),
            _ => probe.nodes(),
        };
        nodes.iter().any(|node| supported.contains(node))
    });
    let warning = |probe: &Probe| {
        format!(
            "probe `{}`: `{}` has the forces of [[prescribe]] only, and a [[support]] acts on the same nodes; add a probe of `support_force`",
            probe.name, probe.quantity
        )
    };
    on_support.map(warning).collect()
}

/// Whether a quantity tells of a motion, which any point of a rigid body has; forces act on nodes.
fn moves(quantity: Quantity) -> bool {
    use Quantity::{Displacement, Elevation, Position, Velocity};
    matches!(quantity, Displacement | Position | Velocity | Elevation)
}

/// The nodes of an extremum.
fn extreme(
    scene: &Scene,
    placed: &[Placed],
    model: &Model,
    p: usize,
    item: &crate::scene::Probe,
    reduce: Extremum,
    problems: &mut Problems<'_>,
) -> Option<Extreme> {
    let (part, nodes) = match (&item.set, &item.body) {
        (Some(set), _) => resolve(placed, &format!("probe[{p}].set"), set, problems, Placed::nodes_of)?,
        (None, Some(body)) => {
            let key = format!("probe[{p}].body");
            if index(placed, body).is_none() {
                problems.add(key, body, "has no nodes", "name a part with a mesh or surface");
                return None;
            }
            resolve(placed, &key, &format!("{body}.all"), problems, Placed::nodes_of)?
        }
        (None, None) => return None,
    };
    let body = scene.body_index(&placed[part].name);
    if item.quantity.is_of_material() && body.is_none() {
        let message = format!("`{}` belongs to deformable bodies", item.quantity);
        problems.add(format!("probe[{p}]"), &item.name, message, "name a set of a deformable body");
        return None;
    }
    if let Some(body) = body {
        state_of(scene, model, body, p, item, problems)?;
    }
    let components = item.quantity.components();
    let component = item.component.and_then(|wanted| components.iter().position(|c| *c == wanted));
    Some(Extreme::new(model, nodes, body, item.quantity, component, reduce))
}

/// Refuses a quantity of the state of a material that the body's law does not have.
fn state_of(
    scene: &Scene,
    model: &Model,
    body: usize,
    p: usize,
    item: &crate::scene::Probe,
    problems: &mut Problems<'_>,
) -> Option<()> {
    let missing = item.quantity.is_of_state() && model.bodies[body].solid.state_output(item.quantity.name()).is_none();
    if !missing {
        return Some(());
    }
    let message = format!("{} has none", state_output::of_law(scene, body));
    let remedy = state_output::remedy(item.quantity.name());
    problems.add(format!("probe[{p}].quantity"), item.quantity.name(), message, remedy);
    None
}

/// The material point of a stress or strain.
fn material(
    scene: &Scene,
    placed: &[Placed],
    model: &Model,
    p: usize,
    item: &crate::scene::Probe,
    problems: &mut Problems<'_>,
) -> Option<ProbeTarget> {
    let (x, body) = (item.point?, scene.body_index(item.body.as_deref()?)?);
    state_of(scene, model, body, p, item, problems)?;
    match model.bodies[body].solid.material_point(&model.reference, x) {
        Some(point) => Some(ProbeTarget::Material(body, point)),
        None => {
            let (node, distance) = placed[body].nearest(x);
            let nearest: [f64; 3] = std::array::from_fn(|i| model.reference[3 * node as usize + i]);
            let message = format!("is in no element of `{}`", placed[body].name);
            let remedy = format!(
                "choose a point of the body in its place; the nearest node is at {nearest:?}, {distance:.3e} away"
            );
            problems.add(format!("probe[{p}].point"), format!("{x:?}"), message, remedy);
            None
        }
    }
}

pub(super) fn probes(
    scene: &Scene,
    placed: &[Placed],
    parts: &Parts,
    model: &Model,
    extent: f64,
    problems: &mut Problems<'_>,
) -> Vec<Probe> {
    let mut out = Vec::new();
    for (p, item) in scene.probes.iter().enumerate() {
        let target = if let Some(reduce) = item.reduce {
            match extreme(scene, placed, model, p, item, reduce, problems) {
                Some(extreme) => ProbeTarget::Extreme(extreme),
                None => continue,
            }
        } else if item.quantity.is_of_material() {
            match material(scene, placed, model, p, item, problems) {
                Some(target) => target,
                None => continue,
            }
        } else if let Some(set) = &item.set {
            match resolve(placed, &format!("probe[{p}].set"), set, problems, Placed::nodes_of) {
                Some((_, nodes)) => ProbeTarget::Nodes(nodes),
                None => continue,
            }
        } else if let Some(joint) = item.joint.as_deref().and_then(|name| scene.joint_index(name)) {
            let Some(place) = parts.joints.get(joint).copied().flatten() else { continue };
            ProbeTarget::Joint(place)
        } else if let Some(name) = &item.equation {
            let equation = scene.equations.iter().position(|equation| equation.name == *name);
            let Some(place) = equation.and_then(|e| parts.equations.get(e).copied().flatten()) else { continue };
            ProbeTarget::Equation(place)
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
        let target = match target {
            ProbeTarget::Nodes(mut nodes) if item.quantity == Quantity::SupportForce => {
                nodes.sort_unstable();
                nodes.dedup();
                let names: Vec<String> = scene.supports.iter().enumerate().map(|(s, item)| item.part_name(s)).collect();
                let is_support = |&part: &usize| names.iter().any(|name| model.parts[part].name() == name);
                ProbeTarget::Supports(nodes, (0..model.parts.len()).filter(is_support).collect())
            }
            target => target,
        };
        out.push(Probe { name: item.name.clone(), target, quantity: item.quantity, extent });
    }
    out
}
