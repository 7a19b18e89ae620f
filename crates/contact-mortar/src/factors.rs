//! Smooth factors of the integrand: which facets are opposite each other, and how deep (theory/mortar#factors).
//!
//! Every factor is a continuously differentiable function of positions, built from invariants. So nothing is decided that an iterate could flip, and a
//! weighted gap with these factors is a state function like one without. Facets less than 60 degrees from opposed that touch have the factor one: patch
//! tests do not notice.

use crate::points::{PointVariation, QuadraturePoint};
use crate::surfaces::diagonals;
use nalgebra::Vector3;
use stoss_reference_element::Nodal;
use stoss_segmentation::{LOCAL, MASTER, SlaveFrame};

/// Cosines of the angle between opposed normals: from 85 degrees on a facet takes no part, up to 60 degrees it takes part wholly.
const FACING: [f64; 2] = [0.087_155_742_747_658_17, 0.5];
/// The depth from which points fade, in parts of the depth at which they are gone.
const FADING: f64 = 0.5;
/// The exponential gap is continued by its tangent below this value of `-beta gamma`.
const STEEPEST: f64 = 2.0;

/// Factors of the integrand at a Gauss point with the gap `gamma`: `facing(n_s, n_m) depth(gamma) nearness(beta gamma)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors {
    /// Whether facets have to look at each other. If not, all factors are one.
    pub facing: bool,
    /// Penetration at which points take no part any more, a length: what lies deeper is another side of the body. Infinite if there is none.
    pub deepest: f64,
    /// `beta`, one over a length: the mean of the gaps becomes the mean of `(1 - exp(-beta gamma)) / beta`, to which near points contribute more than far
    /// ones. Zero for the plain mean.
    pub nearness: f64,
}

/// `t^2 (3 - 2 t)` between 0 and 1, with its derivative.
fn ramp(t: f64) -> [f64; 2] {
    if t <= 0.0 {
        [0.0, 0.0]
    } else if t >= 1.0 {
        [1.0, 0.0]
    } else {
        [t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t)]
    }
}

/// `(1 - exp(-u)) / u` with its derivative; below `-2` `u` times it goes on along its tangent.
fn nearness(u: f64) -> [f64; 2] {
    if u.abs() < 1e-3 {
        [1.0 - u / 2.0 + u * u / 6.0 - u * u * u / 24.0, -0.5 + u / 3.0 - u * u / 8.0]
    } else if u > -STEEPEST {
        let e = (-u).exp();
        let value = (1.0 - e) / u;
        [value, (e - value) / u]
    } else {
        let e = STEEPEST.exp();
        let value = (1.0 - e + e * (u + STEEPEST)) / u;
        [value, (e - value) / u]
    }
}

/// Factor of a pair of facets, with derivatives.
#[derive(Clone, Debug)]
pub(crate) struct Facing {
    pub value: f64,
    pub derivative: [f64; LOCAL],
}

impl Factors {
    /// Factors of one.
    pub const NONE: Self = Self { facing: false, deepest: f64::INFINITY, nearness: 0.0 };

    /// How much a slave and a master facet look at each other, from 0 to 1.
    pub fn facing(&self, frame: &SlaveFrame, master: &Nodal<Vector3<f64>>) -> f64 {
        self.facing_of(frame, master, false).value
    }

    pub(crate) fn facing_of(&self, frame: &SlaveFrame, master: &Nodal<Vector3<f64>>, want_derivative: bool) -> Facing {
        let mut out = Facing { value: 1.0, derivative: [0.0; LOCAL] };
        if !self.facing {
            return out;
        }
        let [d_1, d_2] = diagonals(master);
        let area = d_1.cross(&d_2);
        let length = area.norm();
        let (slave, normal) = (frame.normal(), area / length);
        let cosine = -slave.dot(&normal);
        let [value, slope] = ramp((cosine - FACING[0]) / (FACING[1] - FACING[0]));
        // A facet without area is nowhere.
        out.value = if length > 0.0 { value } else { 0.0 };
        let slope = slope / (FACING[1] - FACING[0]);
        if !want_derivative || slope == 0.0 || out.value == 0.0 {
            return out;
        }
        for (i, turned) in frame.normal_derivatives().iter().enumerate() {
            let d = turned.transpose() * normal * -slope;
            (0..3).for_each(|c| out.derivative[3 * i + c] = d[c]);
        }
        // d n_m = (1 - n n^T) / |c| (dd_1 x d_2 + d_1 x dd_2)
        let b = (slave - normal * slave.dot(&normal)) * (-slope / length);
        let (by_1, by_2) = (d_2.cross(&b), b.cross(&d_1));
        let [c_1, c_2] = master.kind().diagonals();
        for k in 0..master.len() {
            let d = by_1 * c_1[k] + by_2 * c_2[k];
            (0..3).for_each(|c| out.derivative[MASTER + 3 * k + c] = d[c]);
        }
        out
    }

    /// Factor of a point with this gap, with its derivative.
    pub(crate) fn of_gap(&self, gap: f64) -> [f64; 2] {
        let mut out = [1.0, 0.0];
        if self.deepest.is_finite() {
            let range = (1.0 - FADING) * self.deepest;
            let [value, slope] = ramp((gap + self.deepest) / range);
            out = [value, slope / range];
        }
        if self.nearness > 0.0 && out[0] > 0.0 {
            let [value, slope] = nearness(self.nearness * gap);
            out = [out[0] * value, out[1] * value + out[0] * self.nearness * slope];
        }
        out
    }

    /// A gap deeper than this is on its way to losing its part.
    pub fn fading_depth(&self) -> f64 {
        FADING * self.deepest
    }

    /// Multiplies the weight of a point.
    pub(crate) fn apply(&self, facing: &Facing, point: &mut QuadraturePoint) {
        if self.facing {
            point.weight *= facing.value * self.of_gap(point.gap)[0];
        }
    }

    /// Multiplies the weight of a point, and its derivatives.
    pub(crate) fn apply_with_derivatives(
        &self,
        facing: &Facing,
        point: &mut QuadraturePoint,
        variation: &mut PointVariation,
    ) {
        if !self.facing {
            return;
        }
        let [value, slope] = self.of_gap(point.gap);
        let (whole, by_gap, by_facing) =
            (facing.value * value, point.weight * facing.value * slope, point.weight * value);
        for ((w, g), f) in variation.weight.iter_mut().zip(&variation.gap).zip(&facing.derivative) {
            *w = whole * *w + by_gap * g + by_facing * f;
        }
        point.weight *= whole;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_one_at_touching_faces_and_have_their_derivatives() {
        let factors = Factors { facing: true, deepest: 0.4, nearness: 12.0 };
        assert_eq!(factors.of_gap(0.0)[0], 1.0);
        assert_eq!(factors.of_gap(-0.4)[0], 0.0);
        for k in 0..200 {
            let gap = -0.45 + 0.005 * f64::from(k) + 1e-4;
            let difference = (factors.of_gap(gap + 1e-6)[0] - factors.of_gap(gap - 1e-6)[0]) / 2e-6;
            assert!((difference - factors.of_gap(gap)[1]).abs() < 1e-6, "{gap}: {difference}");
        }
    }

    /// The integrand `gamma e(beta gamma)` grows with the gap wherever depth does not fade it: no point ever pulls.
    #[test]
    fn the_exponential_gap_is_monotone() {
        let factors = Factors { facing: true, deepest: f64::INFINITY, nearness: 12.0 };
        let value = |gap: f64| gap * factors.of_gap(gap)[0];
        assert!((-100..100).all(|k| value(0.01 * f64::from(k + 1)) > value(0.01 * f64::from(k))));
    }
}
