//! The largest or smallest value of a quantity over nodes.

use crate::points::Points;
use crate::scene::{Extremum, Quantity};
use crate::solver::{Model, Simulation};

/// Where an extremum is sought, and of what.
#[derive(Clone, Debug, PartialEq)]
pub struct Extreme {
    /// Global nodes.
    nodes: Vec<u32>,
    /// Numbers of the nodes in the frames.
    numbers: Vec<u32>,
    /// The body of a stress or strain.
    body: Option<usize>,
    quantity: Quantity,
    /// Component; without one the length of a vector, and the largest or smallest principal value of a tensor.
    component: Option<usize>,
    reduce: Extremum,
}

impl Extreme {
    /// Global nodes.
    pub(super) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The extremum of `quantity`, or its component, at these nodes; stresses and strains belong to a body.
    pub(super) fn new(
        model: &Model,
        nodes: Vec<u32>,
        body: Option<usize>,
        quantity: Quantity,
        component: Option<usize>,
        reduce: Extremum,
    ) -> Self {
        let points = Points::of(model);
        let numbers = nodes.iter().map(|&node| points.place(node)).collect();
        Self { nodes, numbers, body, quantity, component, reduce }
    }

    /// The extremum and the number of its node, the first of equals; not a number where there is no value, as of reactions without supports.
    pub(super) fn value(&self, simulation: &Simulation) -> [f64; 2] {
        let values = self.values(simulation);
        let best = self.numbers.iter().zip(values).filter(|(_, value)| !value.is_nan()).reduce(|best, next| {
            let better = match self.reduce {
                Extremum::Max => next.1 > best.1,
                Extremum::Min => next.1 < best.1,
            };
            if better { next } else { best }
        });
        best.map_or([f64::NAN; 2], |(&number, value)| [value, f64::from(number)])
    }

    /// The value at each node.
    fn values(&self, simulation: &Simulation) -> Vec<f64> {
        let (model, state) = (simulation.model(), simulation.state());
        match self.quantity {
            quantity if quantity.is_of_material() => self.tensors(simulation),
            Quantity::Displacement => self.vectors(&state.q, Some(&model.reference)),
            Quantity::Position => self.vectors(&state.q, None),
            Quantity::Velocity => self.vectors(&state.v, None),
            Quantity::Reaction => self.vectors(&simulation.reactions(), None),
            Quantity::ContactForce => {
                let (mut forces, moved) = (simulation.contact_force().to_vec(), simulation.moved_contact_force());
                for of in self.nodes.iter().filter_map(|node| moved.get(node)) {
                    let carried = forces.iter_mut().skip(3 * of.node as usize);
                    carried.zip(of.force).for_each(|(carried, f)| *carried += f);
                }
                self.vectors(&forces, None)
            }
            // The others have no extrema.
            _ => Vec::new(),
        }
    }

    /// A component or the length of a vector, or of its difference to another one.
    fn vectors(&self, values: &[f64], from: Option<&[f64]>) -> Vec<f64> {
        let at = |node: u32| {
            let place = 3 * node as usize;
            let v = values.get(place..place + 3)?;
            let from = from.and_then(|from| from.get(place..place + 3)).unwrap_or(&[0.0; 3]);
            Some([v[0] - from[0], v[1] - from[1], v[2] - from[2]])
        };
        let value = |v: [f64; 3]| self.component.map_or_else(|| v[0].hypot(v[1]).hypot(v[2]), |c| v[c]);
        self.nodes.iter().map(|&node| at(node).map_or(f64::NAN, value)).collect()
    }

    /// Values of a stress or strain at each node.
    fn tensors(&self, simulation: &Simulation) -> Vec<f64> {
        let Some(number) = self.body else { return Vec::new() };
        let body = &simulation.model().bodies[number];
        let of_state = self.quantity.is_of_state().then(|| body.solid.state_output(self.quantity.name())).flatten();
        if self.quantity.is_of_state() && of_state.is_none() {
            // Refused when the scene was built.
            return Vec::new();
        }
        if let Some(place) = of_state.filter(|place| place.len == 1) {
            let nodal = simulation.at_nodes::<1>(number, |solid, q| solid.nodal_state_output(q, place));
            let Ok(nodal) = nodal else { return Vec::new() };
            return self.nodes.iter().map(|&node| nodal[(node - body.nodes.start) as usize][0]).collect();
        }
        let nodal = simulation.at_nodes(number, |solid, q| match (self.quantity, of_state) {
            (_, Some(place)) => solid.nodal_state_output(q, place),
            (Quantity::GreenLagrangeStrain, _) => solid.nodal_green_lagrange_strain(q),
            (Quantity::LogarithmicStrain, _) => solid.nodal_logarithmic_strain(q),
            _ => solid.nodal_cauchy_stress(q),
        });
        let Ok(nodal) = nodal else { return Vec::new() };
        let value = |tensor: &[f64; 6]| match (self.quantity, self.component) {
            (Quantity::VonMises, _) => stoss_fe_solid::von_mises(tensor),
            (Quantity::PrincipalStresses, Some(c)) => stoss_fe_solid::principal_stresses(tensor)[c],
            (_, Some(c)) => tensor[c],
            (_, None) => {
                let [largest, _, smallest] = stoss_fe_solid::principal_stresses(tensor);
                if self.reduce == Extremum::Max { largest } else { smallest }
            }
        };
        self.nodes.iter().map(|&node| value(&nodal[(node - body.nodes.start) as usize])).collect()
    }
}
