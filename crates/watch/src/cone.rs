//! Distance of a force from the cone of the directions in which a surface can push.

use nalgebra::{Matrix3, Vector3};

/// Part of a vector below which another one is round-off of it.
const ROUND_OFF: f64 = 1.0e-12;

/// Largest sum of the coefficients, in parts of the force: walls that are opposite to each other and not quite parallel would give every force between them, with pressures that nothing asks for.
const LARGEST: f64 = 3.0;

/// What is left of `force` beside the nearest combination of `normals` with coefficients that are not negative and whose sum is at most [`LARGEST`] of the force: zero inside of their cone.
///
/// The nearest point of a convex cone is a combination of at most three of its directions. They are found one by one (Wolfe's method): a direction that has something in common with the
/// rest, the one with most of it first, joins those that carry the nearest point so far, and the best of their subsets is kept if it leaves less.
pub(crate) fn beside(force: &Vector3<f64>, normals: &[Vector3<f64>]) -> Vector3<f64> {
    let mut rest = *force;
    let mut carrying: Vec<usize> = Vec::new();
    // Each round has another set; so many are never needed.
    for _ in 0..normals.len() + 8 {
        let along: Vec<f64> = normals.iter().map(|n| n.dot(&rest)).collect();
        let mut order: Vec<usize> = (0..normals.len()).filter(|&k| along[k] > ROUND_OFF * force.norm()).collect();
        order.sort_by(|&a, &b| along[b].total_cmp(&along[a]));
        let joined = order.into_iter().filter(|next| !carrying.contains(next)).find_map(|next| {
            let tried: Vec<usize> = carrying.iter().copied().chain([next]).collect();
            best(force, normals, &tried).filter(|(shorter, _)| shorter.norm() < rest.norm() * (1.0 - ROUND_OFF))
        });
        match joined {
            Some(found) => (rest, carrying) = found,
            None => break,
        }
    }
    rest
}

/// The shortest rest that a subset of at most three of these directions leaves, with coefficients that are not negative and not too large, and the subset.
fn best(force: &Vector3<f64>, normals: &[Vector3<f64>], of: &[usize]) -> Option<(Vector3<f64>, Vec<usize>)> {
    let subsets = (1_u32..1 << of.len()).filter(|set| set.count_ones() <= 3);
    let rests = subsets.filter_map(|set| {
        let chosen: Vec<usize> = (0..of.len()).filter(|k| set >> k & 1 == 1).map(|k| of[k]).collect();
        let column = |k: usize| chosen.get(k).map_or_else(Vector3::zeros, |&n| normals[n]);
        let columns = Matrix3::from_columns(&[column(0), column(1), column(2)]);
        let mut gram = columns.transpose() * columns;
        (chosen.len()..3).for_each(|k| gram[(k, k)] = 1.0);
        let factors = gram.lu().solve(&(columns.transpose() * force))?;
        let rest = force - columns * factors;
        let is_allowed = factors.iter().all(|&factor| factor >= 0.0) && factors.sum() <= LARGEST * force.norm();
        (is_allowed && rest.iter().all(|x| x.is_finite())).then_some((rest, chosen))
    });
    rests.min_by(|a, b| a.0.norm().total_cmp(&b.0.norm()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(got: Vector3<f64>, expected: [f64; 3]) {
        assert!((got - Vector3::from(expected)).norm() < 1e-12, "{got:?}");
    }

    #[test]
    fn of_planes_edges_and_corners() {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let force = Vector3::new(0.3, -0.2, 2.0);
        // A plane takes its normal part, an edge what lies between its two normals, a corner all that lies between three.
        near(beside(&force, &[z]), [0.3, -0.2, 0.0]);
        near(beside(&force, &[z, x]), [0.0, -0.2, 0.0]);
        near(beside(&force, &[z, x, -y]), [0.0; 3]);
        near(beside(&force, &[z, x, y]), [0.0, -0.2, 0.0]);
        // Surfaces do not pull.
        near(beside(&-force, &[z]), [-0.3, 0.2, -2.0]);
        near(beside(&force, &[]), [0.3, -0.2, 2.0]);
        // Two walls that lean by a thousandth, with a floor between them, hold nothing along them; those of a wedge do.
        let walls = |lean: f64| [z, (y + x * lean).normalize(), (x * lean - y).normalize()];
        assert!(beside(&Vector3::new(0.3, 0.0, 2.0), &walls(1e-3)).norm() > 0.29);
        near(beside(&Vector3::new(0.3, 0.0, 2.0), &walls(1.0)), [0.0; 3]);
    }

    /// The rest is shorter than what any combination that is tried leaves, and has nothing in common with any direction: it is the distance from the cone.
    #[test]
    fn it_is_the_distance() {
        let mut state = 1_u64;
        // Numbers between -1 and 1 (Knuth's generator).
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for trial in 0..2000 {
            let normals: Vec<_> =
                (0..1 + trial % 12).map(|_| Vector3::new(random(), random(), 1.0).normalize()).collect();
            let force = Vector3::new(random(), random(), random());
            let rest = beside(&force, &normals);
            assert!(normals.iter().all(|n| n.dot(&rest) < 1e-9), "{trial}");
            let tried: Vector3<f64> = normals.iter().map(|n| n * random().abs()).sum();
            assert!(rest.norm() <= (force - tried).norm() + 1e-9, "{trial}");
            // What the cone can give leaves nothing.
            assert!(beside(&tried, &normals).norm() < 1e-9, "{trial}");
        }
    }
}
