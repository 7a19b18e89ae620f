//! Kinds of coordinates of a joint: an angle that is followed over any number of turns, or a displacement.

use std::f64::consts::TAU;

/// Largest turn in a step, radians. The directions of the midpoint, which carry the torque, vanish at half a turn.
pub(crate) const LARGEST_TURN: f64 = 3.0;

/// What the coordinate is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoordinateKind {
    /// An angle `atan2(s, c)` about an axis, from side a to side b, in radians; of a hinge about `a_1` with `s = a_3 . b_2`, `c = a_2 . b_2`.
    Angle,
    /// The displacement `(x_b - x_a) . a_1`, a length.
    Displacement,
}

impl CoordinateKind {
    /// Value in `(-pi, pi]` or a length.
    pub(crate) fn principal(self, phi: [f64; 2]) -> f64 {
        match self {
            Self::Angle => phi[0].atan2(phi[1]),
            Self::Displacement => phi[0],
        }
    }

    /// Change between two configurations, by less than half a turn.
    pub(crate) fn change(self, start: [f64; 2], end: [f64; 2]) -> f64 {
        match self {
            Self::Angle => {
                let (x, y) = sine_and_cosine(start, end);
                x.atan2(y)
            }
            Self::Displacement => end[0] - start[0],
        }
    }

    /// Derivatives with respect to the invariants, and their derivatives.
    pub(crate) fn derivatives(self, phi: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        match self {
            Self::Angle => {
                let [s, c] = phi;
                let square = s * s + c * c;
                let (quartic, mixed) = (square * square, s * s - c * c);
                (
                    [c / square, -s / square],
                    [[-2.0 * s * c / quartic, mixed / quartic], [mixed / quartic, 2.0 * s * c / quartic]],
                )
            }
            Self::Displacement => ([1.0, 0.0], [[0.0; 2]; 2]),
        }
    }

    /// A discrete gradient `w` with `w . (end - start) = change`, and its derivatives with respect to `end`.
    ///
    /// With `x = c_n s_np1 - s_n c_np1` and `y = c_n c_np1 + s_n s_np1` it is `w = atan2(x, y) / x (c_mean, -s_mean)`, for `c_mean ds - s_mean dc = x`.
    pub(crate) fn discrete_gradient(self, start: [f64; 2], end: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        match self {
            Self::Angle => {
                let (x, y) = sine_and_cosine(start, end);
                let (ratio, by_x, by_y) = angle_over_sine(x, y);
                let mean = [0.5 * (start[1] + end[1]), -0.5 * (start[0] + end[0])];
                // With respect to s_np1 and c_np1.
                let change = [by_x * start[1] + by_y * start[0], -by_x * start[0] + by_y * start[1]];
                let mut second =
                    [[mean[0] * change[0], mean[0] * change[1]], [mean[1] * change[0], mean[1] * change[1]]];
                second[0][1] += 0.5 * ratio;
                second[1][0] -= 0.5 * ratio;
                (mean.map(|m| ratio * m), second)
            }
            Self::Displacement => ([1.0, 0.0], [[0.0; 2]; 2]),
        }
    }

    /// Full turns in a value.
    pub(crate) fn turns(self, value: f64, phi: [f64; 2]) -> i64 {
        match self {
            Self::Angle => ((value - self.principal(phi)) / TAU).round() as i64,
            Self::Displacement => 0,
        }
    }
}

fn sine_and_cosine(start: [f64; 2], end: [f64; 2]) -> (f64, f64) {
    (start[1] * end[0] - start[0] * end[1], start[1] * end[1] + start[0] * end[0])
}

/// `atan2(x, y) / x` and its derivatives with respect to `x` and `y`, for `y` positive if `x` is small.
fn angle_over_sine(x: f64, y: f64) -> (f64, f64, f64) {
    let square = x * x + y * y;
    if x.abs() > 0.05 * y.abs() {
        let ratio = x.atan2(y) / x;
        return (ratio, (y / square - ratio) / x, -1.0 / square);
    }
    // atan(t) / t = sum (-1)^k t^2k / (2k + 1), t = x / y; and its derivative over t. The ninth term is below 1e-22.
    let t = x / y;
    let (mut value, mut slope, mut power) = (0.0, 0.0, 1.0);
    for k in 0..9 {
        let odd = f64::from(2 * k + 1);
        value += power / odd;
        // Of t^(2k+2): (2k + 2) t^2k t.
        slope -= power * f64::from(2 * k + 2) / (odd + 2.0);
        power *= -t * t;
    }
    (value / y, slope * t / (y * y), -1.0 / square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The discrete gradient gives the change, also off the unit circle; all derivatives are those of differences.
        #[test]
        fn discrete_gradient_and_derivatives(start in 0.0..TAU, turn in -2.6..2.6_f64, r in 0.8..1.2_f64, small in any::<bool>()) {
            let kind = CoordinateKind::Angle;
            let turn = if small { 1e-3 * turn } else { turn };
            let a = [start.sin(), start.cos()];
            let b = [r * (start + turn).sin(), r * (start + turn).cos()];
            let (w, second) = kind.discrete_gradient(a, b);
            prop_assert!((w[0] * (b[0] - a[0]) + w[1] * (b[1] - a[1]) - turn).abs() < 1e-13);
            prop_assert!((kind.change(a, b) - turn).abs() < 1e-13);
            let (g, h) = kind.derivatives(b);
            let step = 1e-5;
            for l in 0..2 {
                let shifted = |by: f64| { let mut b = b; b[l] += by; b };
                let (ahead, behind) = (shifted(step), shifted(-step));
                prop_assert!(((kind.change(a, ahead) - kind.change(a, behind)) / (2.0 * step) - g[l]).abs() < 1e-8);
                for k in 0..2 {
                    let of = |b| kind.discrete_gradient(a, b).0[k];
                    prop_assert!(((of(ahead) - of(behind)) / (2.0 * step) - second[k][l]).abs() < 1e-6 * (1.0 + second[k][l].abs()));
                    let of = |b| kind.derivatives(b).0[k];
                    prop_assert!(((of(ahead) - of(behind)) / (2.0 * step) - h[k][l]).abs() < 1e-7);
                }
            }
        }
    }
}
