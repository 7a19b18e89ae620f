//! The barrier: energy of an elastic layer on the surfaces as a function of the squared distance.

/// An elastic layer of thickness `h` and modulus `kappa`, theory/barrier#eq-layer:
///
/// `psi(D) = kappa h 1/2 (1 - y)^2 / y`, `y = sqrt(D)/h`, for `0 < y < 1`; zero from `y = 1` on.
///
/// An energy an area (`kappa` a pressure, `h` a length, `D` a squared length). It is convex in `D`, falls, has a continuous derivative at `y = 1`, and is infinite at `D = 0`, in all of which functions are infinite or not a number.
/// Its pressure is `-dpsi/dsqrt(D) = kappa 1/2 (1 - y^2) / y^2`, that of an elastic layer of the stiffness `kappa/h` from the first touch on: under a small pressure `p` it gives way by `h p / kappa`.
///
/// It may be viscous ([`Layer::damped`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    modulus: f64,
    thickness: f64,
    damping: f64,
}

/// What the layer does in a step, an area; theory/barrier#eq-divided-difference, theory/barrier#eq-damped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LayerStep {
    /// The divided difference with the damping, `b_d <= 0`.
    pub b: f64,
    /// `db_d/dD_np1 >= 0`.
    pub slope: f64,
    /// Energy an area that the damping takes, `>= 0`.
    pub dissipated: f64,
}

impl Layer {
    /// A layer of a positive modulus (a pressure) and a positive thickness (a length).
    pub const fn new(modulus: f64, thickness: f64) -> Self {
        Self { modulus, thickness, damping: 0.0 }
    }

    /// Layer with viscous damping, of a relaxation time of the layer over the size of the step, not negative, no unit. 0 is no damping.
    ///
    /// It acts in steps ([`crate::PairStart`]), not at one state. It never pulls, and what it takes is in [`crate::PairForce::dissipated`]; theory/barrier#eq-damped, theory/barrier#eq-damping-loss.
    pub const fn damped(self, time_over_step: f64) -> Self {
        Self { damping: time_over_step, ..self }
    }

    /// Distance from which on nothing acts.
    pub const fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Whether a pair at a squared distance feels the layer.
    pub fn is_inside(&self, distance_squared: f64) -> bool {
        distance_squared < self.thickness * self.thickness
    }

    /// `y` and `1 - y`, the latter from the difference of the squares: it keeps its digits at the edge, where the energy is its second power.
    fn depth(&self, distance_squared: f64) -> [f64; 2] {
        let h_squared = self.thickness * self.thickness;
        let y = distance_squared.sqrt() / self.thickness;
        [y, (h_squared - distance_squared) / (h_squared * (1.0 + y))]
    }

    /// `psi`, `psi' <= 0` and `psi'' >= 0`, derivatives with respect to the squared distance.
    pub fn evaluate(&self, distance_squared: f64) -> [f64; 3] {
        if !self.is_inside(distance_squared) {
            return [0.0; 3];
        }
        let h = self.thickness;
        let [y, a] = self.depth(distance_squared);
        let energy = 0.5 * self.modulus * h * a * a / y;
        // d/dD = 1/(2 h^2 y) d/dy.
        let first = -self.modulus / (4.0 * h) * a * (1.0 + y) / (y * y * y);
        let second = self.modulus / (8.0 * h * h * h) * (3.0 - y * y) / (y * y * y * y * y);
        [energy, first, second]
    }

    /// The divided difference `b = (psi(D_np1) - psi(D_n)) / (D_np1 - D_n) <= 0` and `db/dD_np1 >= 0`, theory/barrier#eq-divided-difference.
    ///
    /// `psi` is a rational function of `y`, so the difference divides out: with `a = 1 - y` at both ends
    /// `b = -1/2 kappa/h (a_n + y_n a_np1) / (y_n y_np1 (y_n + y_np1))`, a sum of terms of one sign. Nothing cancels, however small the step.
    pub fn divided_difference(&self, distance_squared_n: f64, distance_squared_np1: f64) -> [f64; 2] {
        let h_squared = self.thickness * self.thickness;
        let change = distance_squared_np1 - distance_squared_n;
        match (self.is_inside(distance_squared_n), self.is_inside(distance_squared_np1)) {
            (false, false) => [0.0; 2],
            (true, true) => self.inside(distance_squared_n, distance_squared_np1),
            // One end is outside: the difference up to the edge of the layer, times the part of the way that is inside.
            (true, false) => {
                let [b, _] = self.inside(distance_squared_n, h_squared);
                let part = (h_squared - distance_squared_n) / change;
                [b * part, -b * part / change]
            }
            (false, true) => {
                let [b, db] = self.inside(h_squared, distance_squared_np1);
                let part = (distance_squared_np1 - h_squared) / change;
                [b * part, db * part + b * ((distance_squared_n - h_squared) / change) / -change]
            }
        }
    }

    /// The divided difference with the damping, and what the damping takes.
    pub(crate) fn step(&self, distance_squared_n: f64, distance_squared_np1: f64) -> LayerStep {
        let [b, slope] = self.divided_difference(distance_squared_n, distance_squared_np1);
        if self.damping == 0.0 {
            return LayerStep { b, slope, dissipated: 0.0 };
        }
        let change = distance_squared_np1 - distance_squared_n;
        let viscous = self.damping * self.slope_change(distance_squared_n, distance_squared_np1);
        if b + viscous >= 0.0 {
            // It would pull. The layer gives all of its energy up.
            return LayerStep { b: 0.0, slope: 0.0, dissipated: -b * change };
        }
        let [_, _, curvature] = self.evaluate(distance_squared_np1);
        LayerStep { b: b + viscous, slope: slope + self.damping * curvature, dissipated: viscous * change }
    }

    /// `psi'(D_np1) - psi'(D_n)`, of the sign of `D_np1 - D_n` or zero, theory/barrier#eq-slope-difference.
    ///
    /// With `a = 1 - y` at both ends it is `D_np1 - D_n` times `1/4 kappa/h^3 [y_n^2 + y_n y + y^2 a_n (1 + y_n)] / (y_n^3 y^3 (y_n + y))`: nothing cancels.
    fn slope_change(&self, distance_squared_n: f64, distance_squared_np1: f64) -> f64 {
        let h = self.thickness;
        let [d_n, d] = [distance_squared_n, distance_squared_np1].map(|d| d.min(h * h));
        let ([y_n, a_n], [y, _]) = (self.depth(d_n), self.depth(d));
        let sum = y_n * y_n + y_n * y + y * y * a_n * (1.0 + y_n);
        let product = y_n * y;
        0.25 * self.modulus / (h * h * h) * sum / (product * product * product * (y_n + y)) * (d - d_n)
    }

    /// The divided difference of two ends that are inside or at the edge.
    fn inside(&self, distance_squared_n: f64, distance_squared_np1: f64) -> [f64; 2] {
        let h = self.thickness;
        let ([y_n, a_n], [y, a]) = (self.depth(distance_squared_n), self.depth(distance_squared_np1));
        let scale = 0.5 * self.modulus / h;
        let numerator = a_n + y_n * a;
        let denominator = y_n * y * (y_n + y);
        // -d(numerator)/dy and d(denominator)/dy, none of them negative.
        let (falls, grows) = (y_n, y_n * (y_n + 2.0 * y));
        let slope = (falls + numerator * grows / denominator) / denominator;
        [-scale * numerator / denominator, scale * slope / (2.0 * h * h * y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LAYER: Layer = Layer::new(3.0, 0.25);

    fn squared_distance() -> impl Strategy<Value = f64> {
        (0.01..1.5f64).prop_map(|y| (0.25 * y) * (0.25 * y))
    }

    proptest! {
        #[test]
        fn derivatives_are_those_of_the_energy(d in squared_distance()) {
            let s = 1e-5 * d;
            prop_assume!((d - 0.0625).abs() > 2.0 * s);
            let ([_, first, second], [before, first_before, _], [after, first_after, _]) =
                (LAYER.evaluate(d), LAYER.evaluate(d - s), LAYER.evaluate(d + s));
            // Derivatives vanish at the edge like powers of 1 - y; the error of the differences falls more slowly.
            let edge = 1.0 / (1.0 - d.sqrt() / 0.25).abs();
            let round_off = 1e-15 * before * edge / s;
            prop_assert!(((after - before) / (2.0 * s) - first).abs() <= 1e-8 * edge * edge * first.abs() + round_off);
            let round_off = 1e-15 * first_before.abs() * edge / s;
            prop_assert!(((first_after - first_before) / (2.0 * s) - second).abs() <= 1e-8 * edge * edge * second + round_off);
            prop_assert!(first <= 0.0 && second >= 0.0);
        }

        #[test]
        fn the_divided_difference_is_one(d_n in squared_distance(), d in squared_distance()) {
            let [b, db] = LAYER.divided_difference(d_n, d);
            let (v_n, v) = (LAYER.evaluate(d_n)[0], LAYER.evaluate(d)[0]);
            prop_assert!((b * (d - d_n) - (v - v_n)).abs() <= 1e-14 * v_n.max(v));
            prop_assert!(b <= 0.0 && db >= 0.0);
            // Symmetric in the ends.
            let [swapped, _] = LAYER.divided_difference(d, d_n);
            prop_assert!((swapped - b).abs() <= 1e-14 * b.abs());
            let s = 1e-5 * d;
            prop_assume!((d - 0.0625).abs() > 2.0 * s && (d - d_n).abs() > 2.0 * s);
            let (before, after) = (LAYER.divided_difference(d_n, d - s)[0], LAYER.divided_difference(d_n, d + s)[0]);
            // The error of the differences has the third derivative, and the distances to the other end and to the edge in its scale.
            let scale = (d / (d - d_n)).powi(2).max((d / (d - 0.0625)).powi(2)).max(1.0);
            prop_assert!(((after - before) / (2.0 * s) - db).abs() <= 1e-9 * scale * db + 1e-14 * b.abs() / s);
        }

        #[test]
        fn small_steps_have_no_noise(d in (0.01..0.99f64).prop_map(|y| (0.25 * y) * (0.25 * y)), exponent in -16.0..-6.0f64) {
            let change = d * 10f64.powf(exponent);
            let [_, first, second] = LAYER.evaluate(d);
            let [b, db] = LAYER.divided_difference(d, d + change);
            // b = psi' + psi''/2 change + ..., db = psi''/2 + ...; relative to 1 - y, by which psi' vanishes at the edge.
            let edge = 1.0 / (1.0 - d.sqrt() / 0.25);
            prop_assert!((b - first - 0.5 * second * change).abs() <= (1e-14 + change / d * change / d * 100.0 * edge * edge) * edge * edge * first.abs());
            prop_assert!((db - 0.5 * second).abs() <= (1e-14 + 100.0 * change / d * edge) * edge * second);
        }
    }

    proptest! {
        #[test]
        fn the_damping_takes_energy_and_never_pulls(d_n in squared_distance(), d in squared_distance(), exponent in -3.0..3.0f64) {
            let damping = 10f64.powf(exponent);
            let layer = LAYER.damped(damping);
            let (undamped, step) = (LAYER.step(d_n, d), layer.step(d_n, d));
            prop_assert_eq!([undamped.b, undamped.slope, undamped.dissipated], [LAYER.divided_difference(d_n, d)[0], LAYER.divided_difference(d_n, d)[1], 0.0]);
            prop_assert!(step.b <= 0.0 && step.slope >= 0.0 && step.dissipated >= 0.0);
            let ([v_n, first_n, _], [v, first, _]) = (layer.evaluate(d_n), layer.evaluate(d));
            let viscous = damping * (first - first_n);
            prop_assert!((step.b - (undamped.b + viscous).min(0.0)).abs() <= 1e-13 * (undamped.b.abs() + damping * (first.abs() + first_n.abs())));
            let work = step.b * (d - d_n);
            prop_assert!((work - (v - v_n) - step.dissipated).abs() <= 1e-14 * (v.max(v_n) + work.abs()));
            // Approaching it is stiffer, separating softer.
            prop_assert!((step.b - undamped.b) * (d - d_n) >= 0.0);
            let s = 1e-5 * d;
            prop_assume!((d - 0.0625).abs() > 2.0 * s && (d - d_n).abs() > 2.0 * s);
            let (before, after) = (layer.step(d_n, d - s).b, layer.step(d_n, d + s).b);
            prop_assume!((before < 0.0) == (after < 0.0));
            let scale = (d / (d - d_n)).powi(2).max((d / (d - 0.0625)).powi(2)).max(1.0);
            let round_off = 1e-14 * (undamped.b.abs() + damping * (first.abs() + first_n.abs()));
            prop_assert!(((after - before) / (2.0 * s) - step.slope).abs() <= 1e-8 * scale * step.slope + round_off / s);
        }
    }

    #[test]
    fn closed_values() {
        // y = 1/2: psi = kappa h 1/2 1/2, pressure = kappa 1/2 3; dpsi/dD = -pressure / (2 sqrt D).
        let [energy, first, _] = LAYER.evaluate(0.125 * 0.125);
        assert!((energy - 3.0 * 0.25 * 0.25).abs() < 1e-15);
        assert!((first + 3.0 * 1.5 / 0.25).abs() < 1e-13);
        assert_eq!(LAYER.evaluate(0.0625), [0.0; 3]);
        assert_eq!(LAYER.divided_difference(0.0625, 0.07), [0.0; 2]);
    }
}
