//! Geometrically exact beams by directors.

use crate::Embedded;
use crate::axis::BeamAxis;
use crate::constraint::ConstraintSet;
use crate::error::{PartDataError, positive};
use crate::kernel::{GradientAt, Kernel};
use crate::line::{MAX_ORDER, combine, cross, difference, gauss, nearest, norm, shapes};
use crate::quadratic::{Evaluation, Quadratics, QuadraticsBuilder, dot};
use crate::response::{QuadraticEnergy, Response};
use crate::rigid::director_equations;
use crate::section::Section;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;
use std::ops::Range;
use stoss_term::{At, Fault, ForceRule, Local, Rule, Term, Vectors};

/// A shear-deformable beam with the unknowns `(phi, D_1, D_2, D_3)` of each node: its position and three orthogonal directors of length `l`
/// ([`Self::director_length`]), all interpolated by Lagrange polynomials of order 1, 2 or 3 (Romero and Armero, Int. J. Numer. Meth. Engng 54 (2002) 1683;
/// Betsch and Steinmann, ibid. 1775; thesis chapter 2). With `d_k = D_k / l` and `'` the derivative by arc length of the reference axis the strains are
///
/// `Gamma_i = d_i . phi'`, `K_1 = (d_3 . d_2' - d_2 . d_3') / 2`, `K_2 = (d_1 . d_3' - d_3 . d_1') / 2`, `K_3 = (d_2 . d_1' - d_1 . d_2') / 2`,
///
/// less their values in the reference configuration, which is free of stress whatever its shape. The energy is half of `sum c_k strain_k^2` with
/// [`Section::stiffness`], integrated by `order` Gauss points an element (one less than full, against locking). The strains are quadratic in the
/// unknowns and the same in every frame: forces have no resultant and no moment about `q_mid`, and with the mean stress the work is exact.
///
/// Directors keep their length at nodes, by the six constraints of [`Self::constraints`] a node; between nodes they do not.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    name: String,
    first: u32,
    axis: BeamAxis,
    section: Section,
    /// `l`.
    length: f64,
    /// Mean length of an element.
    size: f64,
    /// `order` of each element in a row.
    points: Vec<Point>,
    mass: Vec<(u32, u32, f64)>,
}

/// A Gauss point.
#[derive(Clone, Debug, PartialEq)]
struct Point {
    strains: Quadratics,
    energy: QuadraticEnergy,
    /// Length of the axis from its start, in the reference configuration.
    arc: f64,
}

/// Internal forces and moments at a Gauss point, where they are most accurate; components along the directors there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionForces {
    /// Length of the reference axis from its start.
    pub arc: f64,
    /// Shear forces along `d_1`, `d_2` and tension along `d_3`.
    pub force: [f64; 3],
    /// Bending moments about `d_1`, `d_2` and torque about `d_3`.
    pub moment: [f64; 3],
}

impl Beam {
    /// Vectors of a node.
    pub const VECTORS: u32 = 4;

    /// A beam whose vectors are numbered from `first` on, node after node.
    ///
    /// The length of the directors is that of [`Self::default_director_length`].
    ///
    /// # Errors
    /// [`PartDataError`].
    pub fn new(name: &str, first: u32, axis: BeamAxis, section: Section) -> Result<Self, PartDataError> {
        let length = Self::default_director_length(&axis);
        Self::with_director_length(name, first, axis, section, length)
    }

    /// A beam with this length of the directors. The solution does not depend on it, the condition of the matrix and what tolerances mean do.
    ///
    /// # Errors
    /// [`PartDataError`].
    pub fn with_director_length(
        name: &str,
        first: u32,
        axis: BeamAxis,
        section: Section,
        length: f64,
    ) -> Result<Self, PartDataError> {
        section.check()?;
        positive("length of directors", length)?;
        let size = axis_length(&axis) / axis.elements() as f64;
        let mut beam =
            Self { name: name.to_owned(), first, axis, section, length, size, points: Vec::new(), mass: Vec::new() };
        beam.make_points();
        beam.make_mass();
        Ok(beam)
    }

    /// Mean distance of the nodes. `tests/beam_condition.rs` measures the condition of the linear equations of a clamped beam, multipliers scaled by `EA / h`: for
    /// elements of order 2 that are 200 radii of gyration long it is 2.5e7 with half of the element length, within 5 % of the best; with the radius of gyration it is
    /// 4.6e10, for the shear stiffness puts `kGA h / l^2` on the directors.
    pub fn default_director_length(axis: &BeamAxis) -> f64 {
        axis_length(axis) / (axis.positions().len() - 1) as f64
    }

    /// Strains at all Gauss points, with their values in the reference configuration.
    fn make_points(&mut self) {
        let (order, l) = (self.axis.order(), self.length);
        let mut reference = vec![0.0; 3 * self.first as usize];
        reference.extend(self.reference().iter().flatten());
        let mut at_reference = Evaluation::default();
        let mut start = 0.0;
        for element in 0..self.axis.elements() {
            let nodes = self.axis.element(element);
            let element_length = length_of(nodes, order);
            for &(xi, w) in gauss(order) {
                let s = shapes(order, xi);
                let stretch = norm(combine(&s.slopes[..=order], nodes));
                let slopes = s.slopes.map(|slope| slope / stretch);
                let mut builder = QuadraticsBuilder::new();
                let tangent = builder.form(&self.position_form(element, &slopes[..=order]));
                let d = [0, 1, 2].map(|k| builder.form(&self.director_form(element, k, &s.values[..=order])));
                let slope = [0, 1, 2].map(|k| builder.form(&self.director_form(element, k, &slopes[..=order])));
                for d in d {
                    builder.function(0.0, &[(1.0 / l, d, tangent)]);
                }
                let half = 0.5 / (l * l);
                for (a, b) in [(2, 1), (0, 2), (1, 0)] {
                    builder.function(0.0, &[(half, d[a], slope[b]), (-half, d[b], slope[a])]);
                }
                let strains = builder.build();
                strains.evaluate(&reference, &reference, 1.0, false, &mut at_reference);
                let weight = w * stretch;
                let energy = QuadraticEnergy {
                    stiffness: self.section.stiffness().map(|c| weight * c).to_vec(),
                    rest: at_reference.values.clone(),
                };
                let arc = start + 0.5 * (1.0 + xi) * element_length;
                self.points.push(Point { strains, energy, arc });
            }
            start += element_length;
        }
    }

    /// `sum_I w_I phi_I`.
    fn position_form(&self, element: usize, weights: &[f64]) -> Embedded {
        let terms = weights.iter().enumerate().map(|(i, &w)| (self.vector(element * self.axis.order() + i, 0), w));
        Embedded { constant: [0.0; 3], terms: terms.collect() }
    }

    /// `sum_I w_I (l d_k)_I`, a director of the section of the element.
    fn director_form(&self, element: usize, k: usize, weights: &[f64]) -> Embedded {
        let mut terms = Vec::new();
        for (i, &w) in weights.iter().enumerate() {
            let node = element * self.axis.order() + i;
            terms.extend(self.section_weights(element, i, k).map(|(j, c)| (self.vector(node, 1 + j), w * c)));
        }
        Embedded { constant: [0.0; 3], terms }
    }

    /// `D_k` of the section of a node of an element as `sum_j c_j D_j` of the node: one term, but at corners.
    fn section_weights(&self, element: usize, local: usize, k: usize) -> impl Iterator<Item = (usize, f64)> + use<'_> {
        let own = self.axis.frame(element, local);
        let of_node = &self.axis.triads()[element * self.axis.order() + local];
        let same = own == of_node;
        (0..3).filter_map(move |j| {
            let c = if same { f64::from(u8::from(j == k)) } else { dot(own[k], of_node[j]) };
            (c.abs() > 1e-14).then_some((j, c))
        })
    }

    /// `int rho A N_I N_J` between positions, `int rho I_k N_I N_J / l^2` between directors, exact for straight elements of equal node distances.
    fn make_mass(&mut self) {
        let order = self.axis.order();
        let mut entries = BTreeMap::new();
        let mut add = |i: u32, j: u32, m: f64| {
            if i <= j {
                *entries.entry((i, j)).or_insert(0.0) += m;
            }
        };
        for element in 0..self.axis.elements() {
            let nodes = self.axis.element(element);
            let mut products = [[0.0; MAX_ORDER + 1]; MAX_ORDER + 1];
            for &(xi, w) in gauss(order + 1) {
                let s = shapes(order, xi);
                let weight = w * norm(combine(&s.slopes[..=order], nodes));
                for (row, a) in products.iter_mut().zip(s.values) {
                    row.iter_mut().zip(s.values).for_each(|(p, b)| *p += weight * a * b);
                }
            }
            for i in 0..=order {
                for j in 0..=order {
                    let [a, b] = [i, j].map(|local| element * order + local);
                    add(self.vector(a, 0), self.vector(b, 0), self.section.mass * products[i][j]);
                    for (k, rotary) in self.section.rotary.iter().enumerate() {
                        let m = rotary * products[i][j] / (self.length * self.length);
                        for (p, c) in self.section_weights(element, i, k) {
                            for (q, e) in self.section_weights(element, j, k) {
                                add(self.vector(a, 1 + p), self.vector(b, 1 + q), m * c * e);
                            }
                        }
                    }
                }
            }
        }
        self.mass = entries.into_iter().map(|((i, j), m)| (i, j, m)).filter(|e| e.2 != 0.0).collect();
    }

    fn vector(&self, node: usize, of_node: usize) -> u32 {
        self.first + Self::VECTORS * node as u32 + of_node as u32
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.axis.positions().len()
    }

    /// Reference axis.
    pub fn axis(&self) -> &BeamAxis {
        &self.axis
    }

    /// The cross-section.
    pub fn section(&self) -> &Section {
        &self.section
    }

    /// Length `l` of the directors.
    pub fn director_length(&self) -> f64 {
        self.length
    }

    /// Length of the reference axis.
    pub fn length(&self) -> f64 {
        self.size * self.axis.elements() as f64
    }

    /// Global numbers of the four vectors of a node.
    pub fn node_vectors(&self, node: usize) -> [u32; 4] {
        [0, 1, 2, 3].map(|k| self.vector(node, k))
    }

    /// Reference values of all vectors, node after node.
    pub fn reference(&self) -> Vec<[f64; 3]> {
        let nodes = self.axis.positions().iter().zip(self.axis.triads());
        nodes
            .flat_map(|(&x, d)| {
                [x, d[0].map(|a| self.length * a), d[1].map(|a| self.length * a), d[2].map(|a| self.length * a)]
            })
            .collect()
    }

    /// Velocities of all vectors for a rigid motion: `v + w x (x - about)`, of directors `w x D`.
    pub fn rigid_velocity(&self, velocity: [f64; 3], angular_velocity: [f64; 3], about: [f64; 3]) -> Vec<[f64; 3]> {
        let turn = |(k, x): (usize, [f64; 3])| {
            let is_position = k.is_multiple_of(Self::VECTORS as usize);
            let turn = cross(angular_velocity, if is_position { difference(x, about) } else { x });
            std::array::from_fn(|i| turn[i] + if is_position { velocity[i] } else { 0.0 })
        };
        self.reference().into_iter().enumerate().map(turn).collect()
    }

    /// The node whose reference position is nearest to a point.
    pub fn nearest_node(&self, x: [f64; 3]) -> usize {
        nearest(self.axis.positions(), x)
    }

    /// The position of a node.
    pub fn centre(&self, node: usize) -> Embedded {
        Embedded::vector(self.vector(node, 0))
    }

    /// The unit director `d_(k+1)` of a node.
    pub fn director(&self, node: usize, k: usize) -> Embedded {
        Embedded { constant: [0.0; 3], terms: vec![(self.vector(node, 1 + k), 1.0 / self.length)] }
    }

    /// The vector fixed to the section of a node that is `v` in the reference configuration.
    pub fn direction(&self, node: usize, v: [f64; 3]) -> Embedded {
        let triad = &self.axis.triads()[node];
        (0..3).fold(Embedded::default(), |sum, k| sum.plus(dot(triad[k], v), &self.director(node, k)))
    }

    /// The point fixed to the section of a node that is at `x` in the reference configuration.
    pub fn point(&self, node: usize, x: [f64; 3]) -> Embedded {
        self.centre(node).plus(1.0, &self.direction(node, difference(x, self.axis.positions()[node])))
    }

    /// Rigidity of the directors of all nodes, six equations each as of a rigid body.
    pub fn constraints(&self) -> ConstraintSet {
        self.constraints_except(&[])
    }

    /// Rigidity of all nodes but some: of nodes whose directors are prescribed the equations would determine nothing.
    pub fn constraints_except(&self, held: &[usize]) -> ConstraintSet {
        let node = |i: usize| director_equations([1, 2, 3].map(|k| self.vector(i, k)), self.length);
        let equations = (0..self.node_count()).filter(|i| !held.contains(i)).map(node).collect();
        ConstraintSet::new(&format!("{} (rigidity)", self.name), self.length, equations).as_rigidity()
    }

    /// Rotation of the section of a node from the reference configuration at `q`, rows: the orthogonal matrix nearest to `sum_k d_k (x) d_k0`.
    pub fn rotation(&self, node: usize, q: &[f64]) -> [[f64; 3]; 3] {
        let mut r = Matrix3::zeros();
        for (k, d0) in self.axis.triads()[node].iter().enumerate() {
            r += Vector3::from(self.director(node, k).at(q)) * Vector3::from(*d0).transpose();
        }
        // Newton's iteration for the polar factor; the constraints hold to their tolerance, so that it begins near the end.
        for _ in 0..4 {
            if let Some(inverse) = r.try_inverse() {
                r = 0.5 * (r + inverse.transpose());
            }
        }
        std::array::from_fn(|i| std::array::from_fn(|j| r[(i, j)]))
    }

    /// Internal forces and moments at all Gauss points at `q`.
    pub fn section_forces(&self, q: &[f64]) -> Vec<SectionForces> {
        let mut strains = Evaluation::default();
        let mut at = |point: &Point| {
            point.strains.evaluate(q, q, 1.0, false, &mut strains);
            let rest = &point.energy.rest;
            let stress = |k: usize| self.section.stiffness()[k] * (strains.values[k] - rest[k]);
            SectionForces { arc: point.arc, force: [0, 1, 2].map(stress), moment: [3, 4, 5].map(stress) }
        };
        self.points.iter().map(&mut at).collect()
    }
}

fn length_of(nodes: &[[f64; 3]], order: usize) -> f64 {
    gauss(4).iter().map(|&(xi, w)| w * norm(combine(&shapes(order, xi).slopes[..=order], nodes))).sum()
}

fn axis_length(axis: &BeamAxis) -> f64 {
    (0..axis.elements()).map(|e| length_of(axis.element(e), axis.order())).sum()
}

impl Term for Beam {
    fn name(&self) -> &str {
        &self.name
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        self.points.chunks_exact(self.axis.order()).for_each(|element| visit(element[0].strains.vectors(), &[]));
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.force() else { return Ok(()) };
        let gradient = GradientAt::of(rule);
        let (mut kernel, mut local) = (Kernel::default(), Local::default());
        for element in self.points.chunks_exact(self.axis.order()) {
            local.nodes.clear();
            // The vectors of all points of an element are the same, in the same order.
            local.nodes.extend_from_slice(element[0].strains.vectors());
            local.reset(want_tangent);
            for point in element {
                kernel.evaluate(&point.strains, &point.energy, at.q_n, at.q_np1, gradient, want_tangent);
                kernel.add_to(&mut local, want_tangent);
            }
            visit(&local);
        }
        Ok(())
    }

    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        let mut strains = Evaluation::default();
        let mut of = |point: &Point| {
            point.strains.evaluate(q, q, 1.0, false, &mut strains);
            point.energy.value(&strains.values)
        };
        Ok(self.points.iter().map(&mut of).sum())
    }

    fn length_scale(&self) -> f64 {
        self.size
    }

    fn force_scale(&self) -> f64 {
        self.section.axial
    }

    fn is_symmetric(&self, rule: Rule) -> bool {
        rule != Rule::Force(ForceRule::DiscreteGradient)
    }

    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for Beam {
    fn own_vectors(&self) -> Range<u32> {
        self.first..self.first + Self::VECTORS * self.node_count() as u32
    }

    fn is_direction(&self, vector: u32) -> bool {
        !(vector - self.first).is_multiple_of(Self::VECTORS)
    }

    fn cluster(&self, vector: u32) -> u32 {
        vector - (vector - self.first) % Self::VECTORS
    }

    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        self.mass.iter().for_each(|&(i, j, m)| visit(i, j, m));
    }
}
