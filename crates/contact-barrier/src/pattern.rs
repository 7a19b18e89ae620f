//! One balanced pattern of weights between the closest points of the start and those of the end of a step: the discrete gradient of a squared distance.

use nalgebra::{Matrix3, Vector3};

/// Relative to the squared distances: what decides where the patterns of both ends are the same.
const BALANCE: f64 = 1e-20;

/// Part of the squared distances below which the excesses are round-off, and the patterns are the same to half of the digits: the balance has no derivative.
const SAME_PATTERN: f64 = 1e-18;

/// Closest weights over a list of points at the start of a step and at its end, with the positions there. The weights of each end have the sum zero.
#[derive(Clone, Copy)]
pub(crate) struct Ends<'a> {
    pub c_n: &'a [f64],
    pub c: &'a [f64],
    pub x_n: &'a [Vector3<f64>],
    pub x: &'a [Vector3<f64>],
    /// Sum of the squared distances at both ends.
    pub distances: f64,
}

/// How the closest points of the end move, over the same list of points: free directions `B_a`, and `dgamma_a/dx_j`.
#[derive(Clone, Copy)]
pub(crate) struct Along<'a> {
    pub directions: &'a [[f64; 2]],
    pub moves: &'a [[Vector3<f64>; 2]],
}

/// The pattern `c = (1 - lambda) c_n + lambda c_np1` whose excess over the distance is the same at both ends; theory/barrier#eq-balance, theory/barrier#eq-root.
///
/// `2 c_i r(c; q_m)` does the work `D_np1 - D_n`, without resultant and without moment about `q_m`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pattern {
    pub lambda: f64,
    /// `r(c; q_m)`; of the end of the step `r(c_np1; q_np1)`.
    pub r: Vector3<f64>,
    /// `r(c_np1; q_np1)`.
    pub r_end: Vector3<f64>,
    r_n: Vector3<f64>,
    /// `sum (c_np1 - c_n)_i x_i` at the start and at the end.
    z_n: Vector3<f64>,
    z: Vector3<f64>,
    /// Slope of the quadratic at its root; zero if there is nothing to be balanced.
    steep: f64,
    /// Derivative of the positions, at which the pattern acts, by those of the end.
    share: f64,
}

/// `sum w_i x_i` of weights with the sum zero.
pub(crate) fn sum(w: &[f64], x: &[Vector3<f64>]) -> Vector3<f64> {
    (1..w.len()).fold(Vector3::zeros(), |r, i| r + (x[i] - x[0]) * w[i])
}

impl Pattern {
    /// The pattern between both ends.
    pub fn between(ends: &Ends<'_>) -> Self {
        let Ends { c_n, c, x_n, x, distances } = *ends;
        let shifted =
            |x: &[Vector3<f64>]| (1..x.len()).fold(Vector3::zeros(), |z, i| z + (x[i] - x[0]) * (c[i] - c_n[i]));
        let (r_n, r_end, z_n, z) = (sum(c_n, x_n), sum(c, x), shifted(x_n), shifted(x));
        let (a, b) = (z_n.norm_squared(), 2.0 * z_n.dot(&r_n));
        let (d, e) = (z.norm_squared(), -2.0 * z.dot(&r_end));
        let same = a + b.abs() + d + e.abs() <= SAME_PATTERN * distances;
        let small = BALANCE * distances + f64::MIN_POSITIVE;
        let (a, d) = (a + small, d + small);
        // Round-off, and patches that turn inward, may make the radicand negative.
        let root = ((b + e) * (b + e) + 4.0 * b * d + 4.0 * a * (d + e)).max(0.0).sqrt();
        let lambda = 2.0 * (d + e) / (b + 2.0 * d + e + root);
        let lambda = if lambda.is_finite() { lambda.clamp(0.0, 1.0) } else { 0.5 };
        let steep = if same { 0.0 } else { 2.0 * (a - d) * lambda + b + 2.0 * d + e };
        let r = (r_n + r_end - z * (1.0 - lambda) + z_n * lambda) * 0.5;
        Self { lambda, r, r_end, r_n, z_n, z, steep, share: 0.5 }
    }

    /// The pattern of the end alone, which acts there.
    pub fn at_end(ends: &Ends<'_>) -> Self {
        let (r, none) = (sum(ends.c, ends.x), Vector3::zeros());
        Self { lambda: 1.0, r, r_end: r, r_n: none, z_n: none, z: none, steep: 0.0, share: 1.0 }
    }

    /// Weight of a point.
    pub fn weight(&self, ends: &Ends<'_>, i: usize) -> f64 {
        (1.0 - self.lambda) * ends.c_n[i] + self.lambda * ends.c[i]
    }

    /// Derivatives by the positions at the end; `d_lambda` and `d_r` get an entry for each point.
    pub fn differentiate(
        &self,
        ends: &Ends<'_>,
        along: &Along<'_>,
        d_lambda: &mut [Vector3<f64>],
        d_r: &mut [Matrix3<f64>],
    ) {
        let Self { lambda, r_end, r_n, z_n, z, steep, share, .. } = self;
        let (l, k) = (*lambda, 1.0 - lambda);
        let at = |x: &[Vector3<f64>], a: usize| {
            along.directions.iter().zip(x).fold(Vector3::zeros(), |t, (b, y)| t + (y - x[0]) * b[a])
        };
        let (at_n, at_end) = ([0, 1].map(|a| at(ends.x_n, a)), [0, 1].map(|a| at(ends.x, a)));
        // Where the pattern acts.
        let middle = |a: usize| if *share < 1.0 { (at_n[a] + at_end[a]) * 0.5 } else { at_end[a] };
        let (z_mid, at_mid) = ((z_n + z) * 0.5, [0, 1].map(middle));
        let factors = [0, 1].map(|a| (z_n * l + r_n).dot(&at_n[a]) * l + (r_end + z * l).dot(&at_end[a]) * k);
        for j in 0..ends.c.len() {
            let shift = ends.c[j] - ends.c_n[j];
            d_lambda[j] = match *steep > 0.0 {
                true => {
                    let by_place = (r_end * shift + z * ends.c[j] - z * (shift * k)) * k;
                    let by_foot = along.moves[j][0] * factors[0] + along.moves[j][1] * factors[1];
                    (by_place + by_foot) * (-2.0 / steep)
                }
                false => Vector3::zeros(),
            };
            d_r[j] = Matrix3::identity() * (share * self.weight(ends, j)) + z_mid * d_lambda[j].transpose();
            for a in 0..2 {
                d_r[j] += at_mid[a] * (along.moves[j][a] * l).transpose();
            }
        }
    }

    /// `dc_i/dx_j` by what [`Self::differentiate`] found.
    pub fn weight_gradient(
        &self,
        ends: &Ends<'_>,
        along: &Along<'_>,
        d_lambda: &[Vector3<f64>],
        i: usize,
        j: usize,
    ) -> Vector3<f64> {
        let ([s, t], [u, v]) = (along.directions[i], along.moves[j]);
        d_lambda[j] * (ends.c[i] - ends.c_n[i]) + u * (self.lambda * s) + v * (self.lambda * t)
    }
}
