//! Normal projection onto the extended patch (theory/node-to-surface#eq-projection).

use crate::Patch;
use crate::patch::{Monomials, unit_or_zero};
use nalgebra::Vector3;

/// Result of [`Patch::project`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Convective coordinates of the foot; not clamped, so that they may lie outside the facet.
    pub xi: [f64; 2],
    /// `g = (x - x(xi)) . n`, positive on the side of the normal.
    pub gap: f64,
    /// Unit normal `a_1 x a_2 / |a_1 x a_2|` at the foot.
    pub normal: Vector3<f64>,
    /// Whether the residual `r_a = (x - x(xi)) . a_a` vanishes to the tolerance.
    pub converged: bool,
}

/// Tolerance of `r_a`, relative to `|a_a|^2`: an error of about this size in the coordinates. One further step follows.
const TOLERANCE: f64 = 1e-12;
/// Damped steps for one start. Four to six suffice unless the start is bad.
const MAX_ITERATIONS: usize = 40;
/// Longest step in the coordinates on a patch that is not nearly a parallelogram: without it a start near a fold of the parametrisation converges
/// beyond the fold.
const MAX_STEP: f64 = 2.0;
/// The part of the way to the fold, where `a_2 = c_2 + c_12 xi` vanishes, that a step may take beyond that.
const FOLD_FRACTION: f64 = 0.25;

/// What Newton's method got from one start.
struct Attempt {
    xi: [f64; 2],
    converged: bool,
    residual: f64,
}

impl Patch {
    /// Foot of the normal from `x` on the patch extended beyond its edges.
    ///
    /// Solves `r_a = (x - x(xi)) . a_a = 0` by Newton's method from `start` (theory/node-to-surface#eq-projection). The iteration is damped and keeps to
    /// minima of the distance; if it fails, it is repeated from the closest point of the closed patch, the centre and points near the
    /// corners. After convergence one further step removes what the tolerance left, so that the error is round-off.
    ///
    /// On a warped patch there can be more than one foot; the one found is the one in whose basin `start` lies.
    pub fn project(&self, x: &Vector3<f64>, start: [f64; 2]) -> Projection {
        let monomials = self.monomials();
        let target = x - self.corners[0];
        let mut best = newton(&monomials, &target, start);
        if !best.converged {
            let near = self.closest_point(x).xi;
            let kind = self.kind();
            let centre = kind.centre();
            let near_corner = |v: &[f64; 2]| std::array::from_fn(|i| centre[i] + 0.9 * (v[i] - centre[i]));
            for other in [near, centre].into_iter().chain(kind.vertices().iter().map(near_corner)) {
                let attempt = newton(&monomials, &target, other);
                if attempt.converged || attempt.residual < best.residual {
                    best = attempt;
                }
                if best.converged {
                    break;
                }
            }
        }
        let [a_1, a_2] = monomials.tangents(best.xi);
        let area_vector = a_1.cross(&a_2);
        let normal = unit_or_zero(area_vector);
        Projection {
            xi: best.xi,
            gap: (target - monomials.point(best.xi)).dot(&normal),
            normal,
            converged: best.converged && area_vector.norm() > 0.0,
        }
    }
}

fn newton(patch: &Monomials, target: &Vector3<f64>, start: [f64; 2]) -> Attempt {
    let mut xi = start;
    let mut polish = false;
    let mut residual = f64::INFINITY;
    for _ in 0..MAX_ITERATIONS {
        let r = target - patch.point(xi);
        let [a_1, a_2] = patch.tangents(xi);
        let gradient = [r.dot(&a_1), r.dot(&a_2)];
        let (m_11, m_22) = (a_1.dot(&a_1), a_2.dot(&a_2));
        let previous = residual;
        residual = (gradient[0].abs() / m_11).max(gradient[1].abs() / m_22);
        if polish {
            // The extra step is kept unless round-off made it worse.
            return Attempt { xi, converged: true, residual: residual.min(previous) };
        }
        // What the subtraction in r can resolve: far from the patch the tolerance is out of reach of f64.
        let floor = 8.0 * f64::EPSILON * (target.norm() + r.norm());
        let floor = floor / m_11.min(m_22).sqrt();
        if residual.is_nan() || m_11.min(m_22) <= 0.0 {
            break;
        }
        polish = residual <= TOLERANCE.max(floor);

        // Half the Hessian of the squared distance: m_ab - r . a_ab.
        let m_12 = a_1.dot(&a_2);
        let mut h_12 = m_12 - r.dot(&patch.c_12);
        if m_11 * m_22 - h_12 * h_12 <= 1e-8 * m_11 * m_22 {
            // Not a minimum's Hessian: the Gauss-Newton form always descends.
            h_12 = if m_11 * m_22 - m_12 * m_12 > 1e-8 * m_11 * m_22 { m_12 } else { 0.0 };
        }
        let determinant = m_11 * m_22 - h_12 * h_12;
        let mut step = [
            (m_22 * gradient[0] - h_12 * gradient[1]) / determinant,
            (m_11 * gradient[1] - h_12 * gradient[0]) / determinant,
        ];
        if polish {
            xi = [xi[0] + step[0], xi[1] + step[1]];
            continue;
        }
        let length = step[0].abs().max(step[1].abs());
        let longest = MAX_STEP.max(FOLD_FRACTION * (m_11.min(m_22) / patch.c_12.norm_squared()).sqrt());
        if length > longest {
            step = step.map(|s| s * longest / length);
        }
        // Armijo on f = |r|^2 / 2, whose slope along the step is -(gradient . step).
        let slope = gradient[0] * step[0] + gradient[1] * step[1];
        let f = 0.5 * r.norm_squared();
        let mut factor = 1.0;
        // A decrease below the resolution of f cannot be tested: the full step is right there.
        if slope > 1e-13 * f {
            while factor > 1e-6 {
                let trial = [xi[0] + factor * step[0], xi[1] + factor * step[1]];
                if 0.5 * (target - patch.point(trial)).norm_squared() <= f - 1e-4 * factor * slope {
                    break;
                }
                factor *= 0.5;
            }
        }
        xi = [xi[0] + factor * step[0], xi[1] + factor * step[1]];
    }
    Attempt { xi, converged: false, residual: if residual.is_nan() { f64::INFINITY } else { residual } }
}
