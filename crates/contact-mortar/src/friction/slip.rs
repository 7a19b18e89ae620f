//! Slip and friction force of one slave node as functions of gap vectors and diagonals (theory/friction#mortar).
//!
//! Each slave facet `e` around the node has four arguments: its part `g` of the node's weighted gap vector, the diagonals `d_1`, `d_2`, and, where
//! integrals move, `h`: the gap vector that `g` is compared with. That is the one of the positions of the start with the weights of the end.

use stoss_contact::dual::{Scalar, V3, cross, dot, unit};

/// How the slip of a step is measured (theory/friction#mortar).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlipMeasure {
    /// Change of the products `d . g` of gap vector and diagonals of each facet. Zero in every rigid motion; the force is conjugate to it, so that
    /// there is no moment whatever the gap is, and with the midpoint schemes the work is exact.
    #[default]
    Objective,
    /// Change of the gap vector, the thesis's measure (5.124) with the force (4.139), theory/friction#eq-direct. A rotation with a gap counts as slip; the moment of the force
    /// is the sum of `g x tau`.
    Direct,
}

/// Vectors `g`, `d_1`, `d_2`, `h` of one facet, of which its slip is made (theory/friction#mortar).
pub(crate) type Facet<T> = [V3<T>; 4];

fn minus<T: Scalar>(a: V3<T>, b: V3<T>) -> V3<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `f a + g b`.
fn sum<T: Scalar>(f: T, a: V3<T>, g: T, b: V3<T>) -> V3<T> {
    [f * a[0] + g * b[0], f * a[1] + g * b[1], f * a[2] + g * b[2]]
}

/// Components `m^ab s_b` of covariant ones, with the metric of two vectors.
fn raise<T: Scalar>(d: [V3<T>; 2], s: [T; 2]) -> [T; 2] {
    let [m_11, m_12, m_22] = [dot(&d[0], &d[0]), dot(&d[0], &d[1]), dot(&d[1], &d[1])];
    let inverse = T::constant(1.0) / (m_11 * m_22 - m_12 * m_12);
    [(m_22 * s[0] - m_12 * s[1]) * inverse, (m_11 * s[1] - m_12 * s[0]) * inverse]
}

fn constant<T: Scalar>(v: V3<f64>) -> V3<T> {
    v.map(T::constant)
}

impl SlipMeasure {
    /// A facet's part of the weighted slip of the step, a volume. `start`: `g`, `d_1`, `d_2` at `q_n`. `at_end`: `x` is taken at `q_np1` and `h`
    /// stands for the first one of `start`, otherwise `x` is taken at the midpoint, and `h` is not used.
    pub(crate) fn slip<T: Scalar>(self, at_end: bool, x: &Facet<T>, start: &[V3<f64>; 3]) -> V3<T> {
        let [g, d_1, d_2, h] = *x;
        let g_n = if at_end { h } else { constant(start[0]) };
        let twice = |v: V3<T>| v.map(|x| x.scale(2.0));
        let increment = if at_end { minus(g, g_n) } else { twice(minus(g, g_n)) };
        match self {
            Self::Direct => increment,
            Self::Objective => {
                let d = [d_1, d_2];
                let s: [T; 2] = std::array::from_fn(|a| {
                    let d_n = constant(start[1 + a]);
                    if at_end {
                        dot(&d[a], &g) - dot(&d_n, &g_n)
                    } else {
                        dot(&d[a], &increment) + dot(&twice(minus(d[a], d_n)), &g)
                    }
                });
                let [s_1, s_2] = raise(d, s);
                sum(s_1, d_1, s_2, d_2)
            }
        }
    }

    /// What acts on `g`, `d_1`, `d_2` of a facet: a traction, and areas times tractions.
    pub(crate) fn force<T: Scalar>(self, x: &[V3<T>; 3], traction: V3<T>) -> [V3<T>; 3] {
        let [g, d_1, d_2] = *x;
        if self != Self::Objective {
            return [traction, [T::constant(0.0); 3], [T::constant(0.0); 3]];
        }
        let [t_1, t_2] = raise([d_1, d_2], [dot(&d_1, &traction), dot(&d_2, &traction)]);
        [sum(t_1, d_1, t_2, d_2), g.map(|x| t_1 * x), g.map(|x| t_2 * x)]
    }
}

/// A facet's part `-d_1 x d_2` of the direction of the nodal normal.
pub(crate) fn normal_part<T: Scalar>(x: &Facet<T>) -> V3<T> {
    cross(&x[2], &x[1])
}

/// Tangent vectors at a node with a normal `n` of this direction. The first one has the direction of `a + b x n` with the sums `a`, `b` of diagonals times
/// their coordinates (`frames`): `E_1` turned as the material is.
pub(crate) fn tangents<T: Scalar>(normal: V3<T>, along: [V3<T>; 2]) -> [V3<T>; 2] {
    let n = unit(normal);
    let one = T::constant(1.0);
    let line = sum(one, along[0], one, cross(&along[1], &n));
    let e_1 = unit(sum(T::constant(1.0), line, -dot(&n, &line), n));
    [e_1, cross(&n, &e_1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Vector3};
    use proptest::prelude::*;

    fn facet(v: &[f64]) -> [Vector3<f64>; 3] {
        let base = [[0.1, -0.2, 0.3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        std::array::from_fn(|k| Vector3::from(base[k]) + Vector3::new(v[3 * k], v[3 * k + 1], v[3 * k + 2]))
    }

    fn plain(x: &[Vector3<f64>; 3]) -> [V3<f64>; 3] {
        x.map(Into::into)
    }

    fn full(x: &[Vector3<f64>; 3], h: Vector3<f64>) -> Facet<f64> {
        [x[0].into(), x[1].into(), x[2].into(), h.into()]
    }

    proptest! {
        #[test]
        fn work_of_the_objective_force_is_that_of_the_slip(
            v in prop::collection::vec(-0.4f64..0.4, 9), w in prop::collection::vec(-0.4f64..0.4, 9), t in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let (start, end) = (facet(&v), facet(&w));
            let mid: [Vector3<f64>; 3] = std::array::from_fn(|k| 0.5 * (start[k] + end[k]));
            let measure = SlipMeasure::Objective;
            let slip = Vector3::from(measure.slip(false, &full(&mid, Vector3::zeros()), &plain(&start)));
            let force = measure.force(&plain(&mid), t).map(Vector3::from);
            let work: f64 = (0..3).map(|k| force[k].dot(&(end[k] - start[k]))).sum();
            prop_assert!((work - slip.dot(&Vector3::from(t))).abs() < 1e-13);
            let moment: Vector3<f64> = (0..3).map(|k| mid[k].cross(&force[k])).sum();
            prop_assert!(moment.amax() < 1e-13, "{moment}");
        }

        #[test]
        fn a_rotation_is_no_objective_slip(v in prop::collection::vec(-0.4f64..0.4, 9), axis in prop::array::uniform3(-1.5f64..1.5)) {
            let start = facet(&v);
            let turn = Rotation3::new(axis.into());
            let end = start.map(|x| turn * x);
            let mid: [Vector3<f64>; 3] = std::array::from_fn(|k| 0.5 * (start[k] + end[k]));
            let slip = |measure: SlipMeasure, at_end, x| Vector3::from(measure.slip(at_end, &x, &plain(&start))).amax();
            prop_assert!(slip(SlipMeasure::Objective, false, full(&mid, Vector3::zeros())) < 1e-13);
            prop_assert!(slip(SlipMeasure::Objective, true, full(&end, start[0])) < 1e-13);
            let turned = (end[0] - start[0]).amax();
            prop_assert!((slip(SlipMeasure::Direct, true, full(&end, start[0])) - turned).abs() < 1e-13);
        }
    }
}
