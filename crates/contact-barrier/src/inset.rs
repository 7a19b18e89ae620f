//! Surfaces a little below those of the bodies, for bodies that touch at the start.

use nalgebra::{Matrix3, Vector3};

/// Normals that are the same up to this are one.
const SAME: f64 = 1e-9;

/// The shortest `m` with `n . m >= 1` for all of the unit normals `n`: 1 on a plane, `sqrt 2` at the edge and `sqrt 3` at the corner of a cube. `None` if there is none, as where facets of a
/// vertex face each other.
///
/// Points `a m` below the vertices of two bodies that a plane separates are at least `2 a` apart: a plane that supports a body at a vertex has a normal that is a convex combination of those of the facets there, up
/// to its length, and `n . m >= 1` holds for it as well.
pub fn mitre(normals: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let mut distinct: Vec<Vector3<f64>> = Vec::new();
    for n in normals {
        if distinct.iter().all(|other| other.dot(n) < 1.0 - SAME) {
            distinct.push(*n);
        }
    }
    let mut best: Option<Vector3<f64>> = None;
    let mut consider = |m: Vector3<f64>| {
        let admissible = m.iter().all(|c| c.is_finite()) && distinct.iter().all(|n| n.dot(&m) >= 1.0 - SAME);
        if admissible && best.is_none_or(|best| m.norm_squared() < best.norm_squared()) {
            best = Some(m);
        }
    };
    for (i, n) in distinct.iter().enumerate() {
        consider(*n);
        for (j, o) in distinct.iter().enumerate().skip(i + 1) {
            // The shortest vector with both products equal to one lies along the sum.
            consider((n + o) / (1.0 + n.dot(o)));
            for p in &distinct[j + 1..] {
                let rows = Matrix3::from_rows(&[n.transpose(), o.transpose(), p.transpose()]);
                if let Some(inverse) = rows.try_inverse() {
                    consider(inverse * Vector3::repeat(1.0));
                }
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn faces_edges_corners_and_wedges() {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        assert!((mitre(&[x, x]).unwrap().norm() - 1.0).abs() < 1e-15);
        assert!((mitre(&[x, y]).unwrap().norm() - 2f64.sqrt()).abs() < 1e-15);
        assert!((mitre(&[x, y, z]).unwrap().norm() - 3f64.sqrt()).abs() < 1e-14);
        // A wedge of the angle alpha: 1 / sin(alpha / 2).
        let alpha = 0.4f64;
        let other = Vector3::new(-alpha.cos(), alpha.sin(), 0.0);
        assert!((mitre(&[x, other]).unwrap().norm() - 1.0 / (0.5 * alpha).sin()).abs() < 1e-12);
        assert_eq!(mitre(&[x, -x]), None);
    }

    proptest! {
        /// Admissible, and no longer than any admissible vector of a random sample.
        #[test]
        fn it_is_the_shortest(seeds in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 1..6), tries in prop::collection::vec(prop::array::uniform3(-3.0..3.0f64), 200)) {
            let normals: Vec<Vector3<f64>> = seeds.iter().map(|s| (Vector3::new(s[0], s[1], 1.5)).normalize()).collect();
            let m = mitre(&normals).unwrap();
            prop_assert!(normals.iter().all(|n| n.dot(&m) >= 1.0 - 1e-8));
            for t in tries {
                let t = Vector3::from(t);
                if normals.iter().all(|n| n.dot(&t) >= 1.0) {
                    prop_assert!(t.norm() >= m.norm() * (1.0 - 1e-8));
                }
            }
        }
    }
}
