//! Which rank has which elements.

use crate::{Body, Model};

/// The rank of each element of each body: parts of equal cost by recursive bisection, of all bodies together. A body whose averages reach across elements is on one rank.
pub(crate) fn of_elements(model: &Model, ranks: usize) -> Vec<Vec<u32>> {
    let (mut centres, mut costs) = (Vec::new(), Vec::new());
    for Body { solid, .. } in &model.bodies {
        if solid.is_indivisible() {
            let sum = solid.element_centres().fold([0.0; 3], |sum, x| std::array::from_fn(|i| sum[i] + x[i]));
            centres.push(sum.map(|x| x / solid.element_count() as f64));
            costs.push(solid.element_costs().iter().sum());
        } else {
            centres.extend(solid.element_centres());
            costs.extend(solid.element_costs());
        }
    }
    let mut parts = stoss_term::bisect(&centres, &costs, ranks).into_iter();
    let of = |Body { solid, .. }: &Body| {
        let count = solid.element_count();
        if solid.is_indivisible() {
            vec![parts.next().unwrap_or_default(); count]
        } else {
            parts.by_ref().take(count).collect()
        }
    };
    model.bodies.iter().map(of).collect()
}
