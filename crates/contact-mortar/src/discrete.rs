//! The discrete gradient of a weighted gap between two configurations (theory/mortar#energy).
//!
//! `G = grad Phi(q_m) + theta w` does the work `Phi(q_1) - Phi(q_0)`. `w` is the part of the increment that is no rigid motion of the stencil, times positive weights
//! `a_k`: it has neither resultant nor moment about `q_m`, and of all corrections that have none and do that work `theta w` is the least one.

use nalgebra::{Matrix3, Vector3};
use stoss_contact::position;

/// A relative motion shorter than this, in edges, is round-off.
const NO_MOTION: f64 = 1e-9;
/// A defect of the work below this, in areas times edges, is round-off.
const NO_DEFECT: f64 = 1e-14;
/// Largest length of the correction, in lengths of the gradient.
const LARGEST: f64 = 1.0;

/// The increment of a stencil without its best rigid motion.
pub(crate) struct RelativeMotion {
    weights: Vec<f64>,
    /// Positions at `q_m` relative to their weighted mean.
    arms: Vec<Vector3<f64>>,
    total: f64,
    inertia: Option<Matrix3<f64>>,
    /// `w`, one a node.
    pub motion: Vec<Vector3<f64>>,
    /// `w . dq`, not negative.
    pub work: f64,
}

impl RelativeMotion {
    /// `weights`: `a_k` of the nodes, those beyond its end are zero.
    pub fn new(weights: &[f64], nodes: &[u32], q_0: &[f64], q_1: &[f64]) -> Self {
        let weights: Vec<f64> = (0..nodes.len()).map(|k| weights.get(k).copied().unwrap_or(0.0)).collect();
        let total: f64 = weights.iter().sum();
        let share = if total > 0.0 { 1.0 / total } else { 0.0 };
        let middle = |node: u32| (position(q_0, node) + position(q_1, node)) * 0.5;
        // Positions far from the origin lose no digits.
        let origin = middle(nodes[0]);
        let mut arms: Vec<Vector3<f64>> = nodes.iter().map(|&n| middle(n) - origin).collect();
        let mut motion: Vec<Vector3<f64>> = nodes.iter().map(|&n| position(q_1, n) - position(q_0, n)).collect();
        let mean = |v: &[Vector3<f64>]| -> Vector3<f64> {
            v.iter().zip(&weights).map(|(v, a)| v * *a).sum::<Vector3<f64>>() * share
        };
        let (centre, drift) = (mean(&arms), mean(&motion));
        arms.iter_mut().for_each(|arm| *arm -= centre);
        motion.iter_mut().for_each(|u| *u -= drift);
        let (mut inertia, mut spin) = (Matrix3::zeros(), Vector3::zeros());
        for ((arm, u), &a) in arms.iter().zip(&motion).zip(&weights) {
            inertia += (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * a;
            spin += arm.cross(u) * a;
        }
        let inertia = inertia.try_inverse().filter(|m| m.iter().all(|m| m.is_finite()));
        let turn = inertia.map_or(Vector3::zeros(), |inverse| inverse * spin);
        let mut work = 0.0;
        for ((u, arm), &a) in motion.iter_mut().zip(&arms).zip(&weights) {
            *u -= turn.cross(arm);
            work += a * u.norm_squared();
            *u *= a;
        }
        Self { weights, arms, total, inertia, motion, work }
    }

    /// `theta` for a defect of the work, and what of the defect it leaves. `area` and `edge` tell what is round-off, `gradient` is the length of the gradient.
    pub fn factor(&self, defect: f64, area: f64, edge: f64, gradient: f64) -> (f64, f64) {
        let still = self.work <= (NO_MOTION * edge).powi(2) * area;
        if still || self.inertia.is_none() || defect.abs() <= NO_DEFECT * area * edge {
            return (0.0, defect);
        }
        let theta = defect / self.work;
        let length = self.motion.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        if theta.abs() * length > LARGEST * gradient {
            let clipped = theta.signum() * LARGEST * gradient / length;
            return (clipped, defect - clipped * self.work);
        }
        (theta, 0.0)
    }

    /// Adds `factor` times the derivative of `w` with respect to `q_1` at fixed `q_m` to a row-major matrix: the weights times the projection on what is no rigid motion.
    pub fn add_projection(&self, factor: f64, columns: usize, out: &mut [f64]) {
        let Some(inertia) = self.inertia else { return };
        let turned: Vec<Matrix3<f64>> = self.arms.iter().map(|arm| arm.cross_matrix() * inertia).collect();
        for (k, (&a, turned)) in self.weights.iter().zip(&turned).enumerate().filter(|(_, (a, _))| **a > 0.0) {
            for (l, (&b, arm)) in self.weights.iter().zip(&self.arms).enumerate().filter(|(_, (b, _))| **b > 0.0) {
                // [arm_k] Theta^-1 [arm_l]^T
                let mut block = (Matrix3::identity() / self.total - turned * arm.cross_matrix()) * (-a * b);
                if k == l {
                    block += Matrix3::identity() * a;
                }
                for i in 0..3 {
                    for j in 0..3 {
                        out[(3 * k + i) * columns + 3 * l + j] += factor * block[(i, j)];
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;
    use proptest::prelude::*;

    proptest! {
        /// M5 and M6 of the document that the scheme follows.
        #[test]
        fn the_correction_has_neither_resultant_nor_moment(
            x in prop::collection::vec(-1.0f64..1.0, 21), u in prop::collection::vec(-0.3f64..0.3, 21),
            a in prop::collection::vec(0.01f64..1.0, 7), axis in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let nodes: Vec<u32> = (0..7).collect();
            let q_1: Vec<f64> = x.iter().zip(&u).map(|(x, u)| x + u).collect();
            let relative = RelativeMotion::new(&a, &nodes, &x, &q_1);
            let middle = |k: u32| (position(&x, k) + position(&q_1, k)) * 0.5;
            let force: Vector3<f64> = relative.motion.iter().sum();
            let moment: Vector3<f64> = nodes.iter().map(|&k| middle(k).cross(&relative.motion[k as usize])).sum();
            prop_assert!(force.amax() < 1e-13 && moment.amax() < 1e-13, "{force} {moment}");
            let work: f64 = nodes.iter().map(|&k| relative.motion[k as usize].dot(&position(&u, k))).sum();
            prop_assert!((work - relative.work).abs() < 1e-13);
            // The projection takes the increment to w.
            let mut projection = vec![0.0; 21 * 21];
            relative.add_projection(1.0, 21, &mut projection);
            for (row, w) in projection.chunks_exact(21).zip(relative.motion.iter().flat_map(|w| w.iter())) {
                let sum: f64 = row.iter().zip(&u).map(|(p, u)| p * u).sum();
                prop_assert!((sum - w).abs() < 1e-13);
            }
            let turn = Rotation3::new(Vector3::from(axis));
            let turned: Vec<f64> = x.chunks_exact(3).flat_map(|p| { let y = turn * Vector3::new(p[0], p[1], p[2]); [y.x + 1.0, y.y, y.z] }).collect();
            prop_assert!(RelativeMotion::new(&a, &nodes, &x, &turned).work < 1e-24);
        }
    }
}
