//! Weighted gap as a function of a gap vector and of the diagonals of slave facets, with gradient and tangent.
//!
//! With frozen integrals the weighted gap of a slave node is a sum of terms `Phi(g, d1_f, d2_f, ..)` in which `g = sum_k
//! w_k x_k` and `d1_f = x_2 - x_0`, `d2_f = x_3 - x_1` are linear in the positions. A term needs nothing else: the
//! derivatives with respect to positions follow from constant coefficients.

use nalgebra::{Matrix3, Vector3};

/// Values of the arguments of a term: `g`, then two diagonals a facet.
pub(crate) type Arguments = [Vector3<f64>];

/// Value, gradient and derivative of the gradient of a term. `tangent` is row-major in blocks of three by three.
#[derive(Clone, Debug, Default)]
pub(crate) struct Term {
    pub value: f64,
    pub gradient: Vec<Vector3<f64>>,
    pub tangent: Vec<Matrix3<f64>>,
}

impl Term {
    fn reset(&mut self, count: usize) {
        self.value = 0.0;
        self.gradient.clear();
        self.gradient.resize(count, Vector3::zeros());
        self.tangent.clear();
        self.tangent.resize(count * count, Matrix3::zeros());
    }

    /// `n . g` with `n = c/|c|`, `c = -sum_f d1 x d2`: the mean of the facets' normals weighted by their areas, pointing
    /// into the slave (formulation §7.4). False if the normals cancel.
    pub fn normal_gap(&mut self, x: &Arguments, want_tangent: bool) -> bool {
        self.reset(x.len());
        let facets = (x.len() - 1) / 2;
        let g = x[0];
        let mut c = Vector3::zeros();
        let mut size = 0.0;
        for f in 0..facets {
            let (d1, d2) = (x[1 + 2 * f], x[2 + 2 * f]);
            c -= d1.cross(&d2);
            size += d1.norm() * d2.norm();
        }
        let length = c.norm();
        if length.is_nan() || length <= 1e-12 * size {
            return false;
        }
        let n = c / length;
        let along = n.dot(&g);
        // b = d Phi / d c
        let b = (g - n * along) / length;
        self.value = along;
        self.gradient[0] = n;
        for f in 0..facets {
            let (d1, d2) = (x[1 + 2 * f], x[2 + 2 * f]);
            self.gradient[1 + 2 * f] = b.cross(&d2);
            self.gradient[2 + 2 * f] = d1.cross(&b);
        }
        if !want_tangent {
            return true;
        }
        let count = x.len();
        let project = Matrix3::identity() - n * n.transpose();
        let by_g = project / length;
        let by_c = -(project * (along / length) + n * b.transpose() + b * n.transpose()) / length;
        // d c / d argument.
        let motion = |a: usize| {
            if a % 2 == 1 { x[a + 1].cross_matrix() } else { -x[a - 1].cross_matrix() }
        };
        for i in 1..count {
            let mi = motion(i).transpose();
            self.tangent[i * count] = mi * by_g;
            self.tangent[i] = by_g * motion(i);
            for j in 1..count {
                self.tangent[i * count + j] = mi * by_c * motion(j);
            }
        }
        for f in 0..facets {
            let (i, j) = (1 + 2 * f, 2 + 2 * f);
            self.tangent[i * count + j] += b.cross_matrix();
            self.tangent[j * count + i] -= b.cross_matrix();
        }
        true
    }

    /// `d . g` with the director `d = -d1 x d2 / 8 = -a1 x a2` at the centre of one facet (formulation §8.3).
    pub fn director_gap(&mut self, x: &Arguments) {
        self.reset(3);
        let (g, d1, d2) = (x[0], x[1], x[2]);
        let d = director(&d1, &d2);
        self.value = d.dot(&g);
        self.gradient[0] = d;
        self.gradient[1] = g.cross(&d2) / 8.0;
        self.gradient[2] = d1.cross(&g) / 8.0;
    }

    /// Discrete gradient of [`Term::director_gap`] between `x_n` and `x` with its derivative with respect to `x`: the
    /// director is an unknown with three constraints of its own, quadratic in invariants, and is eliminated with its
    /// multipliers (formulation §8.3). `G . (x - x_n)` is the change of the value. False if the mean director lies in the
    /// mean plane.
    pub fn director_discrete(&mut self, x_n: &Arguments, x: &Arguments, want_tangent: bool) -> bool {
        self.reset(3);
        let mean = |k: usize| 0.5 * (x_n[k] + x[k]);
        let (g, d1, d2) = (mean(0), mean(1), mean(2));
        let d = 0.5 * (director(&x_n[1], &x_n[2]) + director(&x[1], &x[2]));
        let product = |a: usize, b: usize| 0.5 * (x_n[a].dot(&x_n[b]) + x[a].dot(&x[b])) / 64.0;
        let (m11, m12, m22) = (product(1, 1), product(1, 2), product(2, 2));
        // g + l1 d1 + l2 d2 + l3 d = 0
        let Some(inverse) = Matrix3::from_columns(&[d1, d2, d]).try_inverse() else { return false };
        let l = -(inverse * g);
        let (e1, e2) = (d2 * m12 - d1 * m22, d1 * m12 - d2 * m11);
        self.value = director(&x[1], &x[2]).dot(&x[0]);
        self.gradient = vec![d, d * l[0] + e1 * l[2], d * l[1] + e2 * l[2]];
        if !want_tangent {
            return true;
        }
        let (one, zero) = (Matrix3::identity(), Matrix3::zeros());
        // Derivatives with respect to g, d1, d2 at the end.
        let dd = [zero, x[2].cross_matrix() / 16.0, -x[1].cross_matrix() / 16.0];
        for k in 0..3 {
            let half = |on: bool| if on { one * 0.5 } else { zero };
            let (dg, dd1, dd2) = (half(k == 0), half(k == 1), half(k == 2));
            let dl = -inverse * (dg + dd1 * l[0] + dd2 * l[1] + dd[k] * l[2]);
            let row = |i: usize| dl.row(i).into_owned();
            let (w1, w2) = (x[1].transpose() / 64.0, x[2].transpose() / 64.0);
            let none = Vector3::zeros().transpose();
            let dm11 = if k == 1 { w1 } else { none };
            let dm22 = if k == 2 { w2 } else { none };
            let dm12 = if k == 1 {
                0.5 * w2
            } else if k == 2 {
                0.5 * w1
            } else {
                none
            };
            let de1 = dd2 * m12 - dd1 * m22 + d2 * dm12 - d1 * dm22;
            let de2 = dd1 * m12 - dd2 * m11 + d1 * dm12 - d2 * dm11;
            self.tangent[k] = dd[k];
            self.tangent[3 + k] = dd[k] * l[0] + d * row(0) + de1 * l[2] + e1 * row(2);
            self.tangent[6 + k] = dd[k] * l[1] + d * row(1) + de2 * l[2] + e2 * row(2);
        }
        true
    }
}

/// `-a1 x a2` at the centre of a facet with diagonals `d1`, `d2`.
fn director(d1: &Vector3<f64>, d2: &Vector3<f64>) -> Vector3<f64> {
    d2.cross(d1) / 8.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn arguments(v: &[f64], base: bool) -> Vec<Vector3<f64>> {
        let start = [[0.1, -0.2, 0.3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.8, 0.3, 0.1], [-0.2, 2.2, -0.1]];
        (0..v.len() / 3)
            .map(|k| {
                let d = Vector3::new(v[3 * k], v[3 * k + 1], v[3 * k + 2]);
                if base { d + Vector3::from(start[k]) } else { d }
            })
            .collect()
    }

    /// Largest error of gradient and tangent against central differences, relative to one.
    fn error(x: &[Vector3<f64>], evaluate: impl Fn(&[Vector3<f64>]) -> Term, gradient_too: bool) -> f64 {
        let term = evaluate(x);
        let (n, h) = (x.len(), 1e-5);
        let mut worst = 0.0_f64;
        for k in 0..3 * n {
            let moved = |s: f64| {
                let mut y = x.to_vec();
                y[k / 3][k % 3] += s * h;
                evaluate(&y)
            };
            let (a, b) = (moved(1.0), moved(-1.0));
            if gradient_too {
                worst = worst.max(((a.value - b.value) / (2.0 * h) - term.gradient[k / 3][k % 3]).abs());
            }
            for i in 0..n {
                let difference = (a.gradient[i] - b.gradient[i]) / (2.0 * h);
                let column = term.tangent[i * n + k / 3].column(k % 3).into_owned();
                worst = worst.max((difference - column).amax());
            }
        }
        worst
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        #[test]
        fn tangents_are_derivatives(v in prop::collection::vec(-0.4f64..0.4, 15), w in prop::collection::vec(-0.3f64..0.3, 9)) {
            let evaluate = |x: &[Vector3<f64>]| { let mut t = Term::default(); assert!(t.normal_gap(x, true)); t };
            let e = error(&arguments(&v, true), evaluate, true);
            prop_assert!(e < 1e-8, "{e:e}");
            let x_n = arguments(&v[..9], true);
            let x: Vec<_> = x_n.iter().zip(arguments(&w, false)).map(|(a, b)| a + b).collect();
            let discrete = |x: &[Vector3<f64>]| { let mut t = Term::default(); assert!(t.director_discrete(&x_n, x, true)); t };
            let e = error(&x, discrete, false);
            prop_assert!(e < 1e-8, "{e:e}");
            let mut end = Term::default();
            end.director_gap(&x);
            let direct = |x: &[Vector3<f64>]| { let mut t = Term::default(); t.director_gap(x); t };
            let h = 1e-5;
            for k in 0..9 {
                let moved = |s: f64| { let mut y = x.clone(); y[k / 3][k % 3] += s * h; direct(&y).value };
                let difference = (moved(1.0) - moved(-1.0)) / (2.0 * h);
                prop_assert!((difference - end.gradient[k / 3][k % 3]).abs() < 1e-8);
            }
        }

        #[test]
        fn the_discrete_gradient_does_the_work_without_moment(
            v in prop::collection::vec(-0.4f64..0.4, 9), w in prop::collection::vec(-0.3f64..0.3, 9),
        ) {
            let x_n = arguments(&v, true);
            let x: Vec<_> = x_n.iter().zip(arguments(&w, false)).map(|(a, b)| a + b).collect();
            let (mut at_n, mut discrete) = (Term::default(), Term::default());
            at_n.director_gap(&x_n);
            prop_assert!(discrete.director_discrete(&x_n, &x, false));
            let work: f64 = (0..3).map(|k| discrete.gradient[k].dot(&(x[k] - x_n[k]))).sum();
            prop_assert!((work - (discrete.value - at_n.value)).abs() < 1e-13);
            let moment: Vector3<f64> = (0..3).map(|k| (0.5 * (x[k] + x_n[k])).cross(&discrete.gradient[k])).sum();
            prop_assert!(moment.amax() < 1e-13, "{moment}");
        }
    }
}
