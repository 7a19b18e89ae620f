//! Which rank has which elements.

use crate::{Body, Model};
use stoss_fe_solid::SolidBody;

/// The rank of each element of each body: parts of equal cost by recursive bisection, of all bodies together. A body whose averages reach across elements is on one rank, that of its first element.
pub(crate) fn of_elements(model: &Model, ranks: usize) -> Vec<Vec<u32>> {
    let centres: Vec<[f64; 3]> = model.bodies.iter().flat_map(|body| body.solid.element_centres()).collect();
    let costs: Vec<u64> = model.bodies.iter().flat_map(|body| costs(&body.solid)).collect();
    let all = stoss_mesh::bisect(&centres, &costs, ranks);
    let mut rest = &all[..];
    let of = |body: &Body| {
        let (own, others) = rest.split_at(body.solid.element_count());
        rest = others;
        if body.solid.is_indivisible() { vec![own[0]; own.len()] } else { own.to_vec() }
    };
    model.bodies.iter().map(of).collect()
}

/// Cost of each element: a tangent of all pairs of its nodes at each of its points.
fn costs(solid: &SolidBody) -> impl Iterator<Item = u64> {
    solid.elements().iter().map(|nodes| (nodes.len() * nodes.len()) as u64)
}
