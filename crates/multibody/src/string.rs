//! Elastic strings, which have axial stiffness only.

use crate::Embedded;
use crate::axis::check_lengths;
use crate::error::{PartDataError, finite, not_negative, positive};
use crate::kernel::{GradientAt, Kernel};
use crate::line::{MAX_ORDER, combine, cross, difference, element_count, gauss, nearest, norm, shapes};
use crate::quadratic::{Evaluation, Quadratics, QuadraticsBuilder};
use crate::response::Response;
use std::ops::Range;
use stoss_term::{At, Fault, ForceRule, Local, Rule, Term, Undefined, Vectors};

/// Stiffness and mass of a string.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StringMaterial {
    /// `E A`, a force.
    pub stiffness: f64,
    /// Mass per natural length.
    pub mass: f64,
    /// Whether the mass matrix is diagonal, `int N_I rho A ds`, and not consistent. A node that is stopped then does not change the motion of its neighbours at once.
    pub lumped: bool,
    /// Whether a string that is shorter than its natural length has no force at all. Otherwise it also resists compression, with an energy that tends to infinity as its length tends to zero.
    pub tension_only: bool,
}

/// A string with the positions of its nodes as unknowns, interpolated by Lagrange polynomials of order 1, 2 or 3, and `order + 1` Gauss points an element.
///
/// With `'` the derivative by natural length and `pi = r' . r'`, the squared stretch, the energy per natural length is
///
/// `W(pi) = EA/4 (pi - 1 - ln pi)`, thus the tension `EA/2 (nu - 1/nu)` at the stretch `nu = sqrt(pi)` (thesis (2.10));
///
/// with [`StringMaterial::tension_only`] zero for `pi < 1`, where it begins with zero slope.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticString {
    name: String,
    first: u32,
    order: usize,
    nodes: Vec<[f64; 3]>,
    material: StringMaterial,
    /// Natural length.
    length: f64,
    /// `order + 1` of each element in a row.
    points: Vec<Point>,
}

/// A Gauss point.
#[derive(Clone, Debug, PartialEq)]
struct Point {
    /// `pi`.
    stretch: Quadratics,
    energy: StringEnergy,
    /// Natural length that belongs to it.
    weight: f64,
    /// Shape functions.
    values: [f64; MAX_ORDER + 1],
}

impl ElasticString {
    /// A string whose vectors are numbered from `first` on, through `order * elements + 1` nodes (lengths); `stretch` is its present length over its natural
    /// length, 1 if it has no force there.
    ///
    /// # Errors
    /// [`PartDataError`].
    pub fn new(
        name: &str,
        first: u32,
        order: usize,
        nodes: Vec<[f64; 3]>,
        material: StringMaterial,
        stretch: f64,
    ) -> Result<Self, PartDataError> {
        let elements =
            element_count(nodes.len(), order).ok_or(PartDataError::Elements { nodes: nodes.len(), order })?;
        finite("coordinate of a string", &nodes)?;
        positive("stiffness of a string", material.stiffness)?;
        not_negative("mass per length of a string", material.mass)?;
        positive("stretch of a string", stretch)?;
        check_lengths(&nodes, order)?;
        let mut string = Self { name: name.to_owned(), first, order, nodes, material, length: 0.0, points: Vec::new() };
        for element in 0..elements {
            let own = &string.nodes[element * order..=(element + 1) * order];
            for &(xi, w) in gauss(order + 1) {
                let s = shapes(order, xi);
                let natural = norm(combine(&s.slopes[..=order], own)) / stretch;
                let mut builder = QuadraticsBuilder::new();
                let terms = (0..=order).map(|i| (first + (element * order + i) as u32, s.slopes[i] / natural));
                let slope = builder.form(&Embedded { constant: [0.0; 3], terms: terms.collect() });
                builder.function(0.0, &[(1.0, slope, slope)]);
                let weight = w * natural;
                string.length += weight;
                string.points.push(Point {
                    stretch: builder.build(),
                    energy: StringEnergy {
                        factor: 0.25 * weight * material.stiffness,
                        tension_only: material.tension_only,
                    },
                    weight,
                    values: s.values,
                });
            }
        }
        Ok(string)
    }

    /// Nodes of a straight string, for [`Self::new`].
    ///
    /// # Errors
    /// [`PartDataError`].
    pub fn straight_nodes(
        from: [f64; 3],
        to: [f64; 3],
        elements: usize,
        order: usize,
    ) -> Result<Vec<[f64; 3]>, PartDataError> {
        let steps = order * elements;
        if steps == 0 {
            return Err(PartDataError::Elements { nodes: 1, order });
        }
        let node = |i: usize| combine(&[1.0 - i as f64 / steps as f64, i as f64 / steps as f64], &[from, to]);
        Ok((0..=steps).map(node).collect())
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Reference positions of the nodes, all its vectors.
    pub fn reference(&self) -> &[[f64; 3]] {
        &self.nodes
    }

    /// Velocities of the nodes for a rigid motion, `v + w x (x - about)`.
    pub fn rigid_velocity(&self, velocity: [f64; 3], angular_velocity: [f64; 3], about: [f64; 3]) -> Vec<[f64; 3]> {
        let of = |&x: &[f64; 3]| {
            let turn = cross(angular_velocity, difference(x, about));
            std::array::from_fn(|i| velocity[i] + turn[i])
        };
        self.nodes.iter().map(of).collect()
    }

    /// Global number of the vector of a node.
    pub fn node_vector(&self, node: usize) -> u32 {
        self.first + node as u32
    }

    /// The position of a node.
    pub fn point(&self, node: usize) -> Embedded {
        Embedded::vector(self.node_vector(node))
    }

    /// The node whose reference position is nearest to a point.
    pub fn nearest_node(&self, x: [f64; 3]) -> usize {
        nearest(&self.nodes, x)
    }

    /// Order of the shape functions.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Natural length.
    pub fn natural_length(&self) -> f64 {
        self.length
    }

    /// Tension `EA/2 (nu - 1/nu)` at all Gauss points at `q`, element after element; negative where a string that is not for tension only is shortened.
    pub fn tensions(&self, q: &[f64]) -> Vec<f64> {
        let mut evaluation = Evaluation::default();
        let mut tension = |point: &Point| {
            point.stretch.evaluate(q, q, 1.0, false, &mut evaluation);
            let pi = evaluation.values[0];
            2.0 * point.energy.slope(pi) / point.weight * pi.sqrt()
        };
        self.points.iter().map(&mut tension).collect()
    }

    /// An error if the energy is not defined at `q`.
    fn check(&self, point: usize, stretch: &Evaluation) -> Result<(), Undefined> {
        let pi = stretch.values[0];
        // False for NaN.
        if pi > 0.0 || self.material.tension_only && pi == 0.0 {
            return Ok(());
        }
        let (element, point) = (point / (self.order + 1), point % (self.order + 1));
        let reason = format!("element {element} has the squared stretch {pi:e} at its Gauss point {point}");
        Err(Undefined { term: self.name.clone(), reason })
    }
}

impl Term for ElasticString {
    fn name(&self) -> &str {
        &self.name
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        self.points.chunks_exact(self.order + 1).for_each(|element| visit(element[0].stretch.vectors(), &[]));
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.force() else { return Ok(()) };
        let gradient = GradientAt::of(rule);
        let fractions: &[f64] = match gradient {
            GradientAt::Configuration(theta) => &[theta],
            GradientAt::Discrete => &[0.0, 1.0],
        };
        let (mut kernel, mut local, mut stretch) = (Kernel::default(), Local::default(), Evaluation::default());
        for (element, points) in self.points.chunks_exact(self.order + 1).enumerate() {
            local.nodes.clear();
            local.nodes.extend_from_slice(points[0].stretch.vectors());
            local.reset(want_tangent);
            for (k, point) in points.iter().enumerate() {
                for &fraction in fractions {
                    point.stretch.evaluate(at.q_n, at.q_np1, fraction, false, &mut stretch);
                    self.check(element * (self.order + 1) + k, &stretch)?;
                }
                kernel.evaluate(&point.stretch, &point.energy, at.q_n, at.q_np1, gradient, want_tangent);
                kernel.add_to(&mut local, want_tangent);
            }
            visit(&local);
        }
        Ok(())
    }

    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        let (mut stretch, mut sum) = (Evaluation::default(), 0.0);
        for (k, point) in self.points.iter().enumerate() {
            point.stretch.evaluate(q, q, 1.0, false, &mut stretch);
            self.check(k, &stretch)?;
            sum += point.energy.value(&stretch.values);
        }
        Ok(sum)
    }

    fn length_scale(&self) -> f64 {
        self.length * self.order as f64 / (self.nodes.len() - 1) as f64
    }

    fn force_scale(&self) -> f64 {
        self.material.stiffness
    }

    fn is_symmetric(&self, rule: Rule) -> bool {
        rule != Rule::Force(ForceRule::DiscreteGradient)
    }

    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for ElasticString {
    fn own_vectors(&self) -> Range<u32> {
        self.first..self.first + self.nodes.len() as u32
    }

    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        for (element, points) in self.points.chunks_exact(self.order + 1).enumerate() {
            let node = |i: usize| self.node_vector(element * self.order + i);
            for i in 0..=self.order {
                if self.material.lumped {
                    let sum: f64 = points.iter().map(|p| p.weight * p.values[i]).sum();
                    visit(node(i), node(i), self.material.mass * sum);
                    continue;
                }
                for j in i..=self.order {
                    let sum: f64 = points.iter().map(|p| p.weight * p.values[i] * p.values[j]).sum();
                    visit(node(i), node(j), self.material.mass * sum);
                }
            }
        }
    }
}

/// `W(pi) = c (pi - 1 - ln pi)`, for tension only zero below 1.
///
/// The discrete gradient is `c (1 - (ln pi_1 - ln pi_0) / (pi_1 - pi_0))`. With `y = (pi_1 - pi_0) / (pi_1 + pi_0)` the quotient is
/// `f(y) / ((pi_0 + pi_1)/2)`, `f(y) = atanh(y) / y = 1 + y^2/3 + y^4/5 + ...`, which is as smooth at `pi_1 = pi_0` as elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StringEnergy {
    factor: f64,
    tension_only: bool,
}

/// `atanh(y) / y` and its derivative for `y = (b - a) / (a + b)` of positive `a` and `b`.
fn area_tangent_quotient(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let y = (b - a) / sum;
    if y.abs() > 0.15 {
        // By the ratio: near 1 and -1 what is left of `1 - y` and `1 + y` has lost digits.
        let f = 0.5 * (b / a).ln() / y;
        return (f, (0.25 * (sum / a) * (sum / b) - f) / y);
    }
    // `f = sum y^2k / (2k + 1)` by Horner's rule; terms from y^20 on are below 1e-17.
    let (mut f, mut slope) = (0.0, 0.0);
    for k in (0..10).rev() {
        let k = f64::from(k);
        f = f * y * y + 1.0 / (2.0 * k + 1.0);
        slope = slope * y * y + 2.0 * (k + 1.0) / (2.0 * k + 3.0);
    }
    (f, slope * y)
}

impl StringEnergy {
    fn is_slack(&self, pi: f64) -> bool {
        self.tension_only && pi <= 1.0
    }

    fn slope(&self, pi: f64) -> f64 {
        if self.is_slack(pi) { 0.0 } else { self.factor * (pi - 1.0) / pi }
    }

    /// Discrete gradient of the smooth function and its derivative with respect to `b`.
    fn quotient(&self, a: f64, b: f64) -> (f64, f64) {
        let sum = a + b;
        let (f, df) = area_tangent_quotient(a, b);
        // dy/db = 2 a / sum^2.
        let gradient = 1.0 - 2.0 * f / sum;
        (self.factor * gradient, self.factor * (2.0 * f / (sum * sum) - 4.0 * a * df / (sum * sum * sum)))
    }
}

impl Response for StringEnergy {
    fn value(&self, phi: &[f64]) -> f64 {
        let pi = phi[0];
        // `ln_1p` keeps the digits of small strains.
        if self.is_slack(pi) { 0.0 } else { self.factor * ((pi - 1.0) - (pi - 1.0).ln_1p()) }
    }

    fn derivatives(&self, phi: &[f64], gradient: &mut [f64], second: &mut [f64]) {
        gradient[0] = self.slope(phi[0]);
        second[0] = if self.is_slack(phi[0]) { 0.0 } else { self.factor / (phi[0] * phi[0]) };
    }

    fn discrete_gradient(&self, phi_n: &[f64], phi_np1: &[f64], gradient: &mut [f64], derivative: &mut [f64]) {
        let (a, b) = (phi_n[0], phi_np1[0]);
        match (self.is_slack(a), self.is_slack(b)) {
            (true, true) => {}
            (false, false) => (gradient[0], derivative[0]) = self.quotient(a, b),
            (a_slack, _) => {
                // Across the kink only the taut part of the way has a force; `a` and `b` are apart, on different sides of 1.
                let (g, difference) = if a_slack {
                    (self.quotient(1.0, b).0 * (b - 1.0) / (b - a), b - a)
                } else {
                    (self.quotient(a, 1.0).0 * (1.0 - a) / (b - a), b - a)
                };
                gradient[0] = g;
                derivative[0] = (self.slope(b) - g) / difference;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn gradient(energy: StringEnergy, a: f64, b: f64) -> (f64, f64) {
        let (mut g, mut d) = ([0.0], [0.0]);
        energy.discrete_gradient(&[a], &[b], &mut g, &mut d);
        (g[0], d[0])
    }

    proptest! {
        /// Work of the discrete gradient, at any distance, across the kink or not; and its derivative against differences.
        #[test]
        fn discrete_gradient(a in 0.05..4.0_f64, exponent in -16.0..0.5_f64, up in any::<bool>(), tension_only in any::<bool>()) {
            let b = (a + if up { 10f64.powf(exponent) } else { -10f64.powf(exponent) }).max(0.02);
            let energy = StringEnergy { factor: 3.0, tension_only };
            let (g, d) = gradient(energy, a, b);
            let work = energy.value(&[b]) - energy.value(&[a]);
            prop_assert!((g * (b - a) - work).abs() < 4e-14, "{} {}", g * (b - a), work);
            // Between the gradients at both ends, which are monotonic.
            let (low, high) = (energy.slope(a.min(b)), energy.slope(a.max(b)));
            prop_assert!(low - 1e-12 * (1.0 + low.abs()) <= g && g <= high + 1e-12 * (1.0 + high.abs()));
            let h = 1e-5 * b;
            prop_assume!(!tension_only || (b - 1.0).abs() > 2.0 * h && (a - 1.0).abs() > 2.0 * h);
            let numeric = (gradient(energy, a, b + h).0 - gradient(energy, a, b - h).0) / (2.0 * h);
            prop_assert!((numeric - d).abs() < 2e-6 * (1.0 + 3.0 / (b * b) + 3.0 / (a * b)), "{numeric} {d}");
        }

        /// Series and closed form are one function.
        #[test]
        fn area_tangent(y in 0.1..0.2_f64) {
            let (f, slope) = area_tangent_quotient(1.0 - y, 1.0 + y);
            let exact = y.atanh() / y;
            prop_assert!((f - exact).abs() < 1e-15 * 4.0);
            prop_assert!((slope - (1.0 / (1.0 - y * y) - exact) / y).abs() < 2e-14);
        }
    }

    #[test]
    fn equal_ends_give_the_gradient() {
        for pi in [0.3, 1.0, 1.7] {
            let energy = StringEnergy { factor: 2.0, tension_only: false };
            let (g, d) = gradient(energy, pi, pi);
            assert!((g - 2.0 * (1.0 - 1.0 / pi)).abs() < 1e-15 * 8.0);
            // Half of the second derivative.
            assert!((d - 1.0 / (pi * pi)).abs() < 1e-14 / (pi * pi));
        }
    }
}
