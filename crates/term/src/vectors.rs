//! The ability to own vectors.

use std::ops::Range;

/// Vectors that belong to one term only, with a constant mass.
pub trait Vectors: Sync {
    /// Numbers of the term's own vectors.
    fn own_vectors(&self) -> Range<u32>;

    /// Number of components of each that are unknowns, the first ones: three of a vector in space, one of a number at a point, a temperature for instance. The others stay as they are. Numbers are scaled such
    /// that their rows are forces times a length over them: rows are judged together, by forces.
    fn width(&self) -> usize {
        3
    }

    /// Whether a vector is a director: a translation of the system does not change it, so that it does not contribute to linear momentum.
    fn is_direction(&self, _vector: u32) -> bool {
        false
    }

    /// First of the vectors that the linear solver keeps together with this one: those of a rigid body, or of a cross-section.
    fn cluster(&self, vector: u32) -> u32 {
        vector
    }

    /// Entries `M_ij` of the mass (a mass each; it acts alike on the three components) with `i <= j`.
    fn mass(&self, _visit: &mut dyn FnMut(u32, u32, f64)) {}

    /// Dead forces of a uniform acceleration `a` (gravity): `f_i = sum_j M_ij a` with the positions `j` among the vectors. A vector is visited once for each of its
    /// entries of the mass; the forces add up.
    fn weight(&self, acceleration: [f64; 3], visit: &mut dyn FnMut(u32, [f64; 3])) {
        self.mass(&mut |i, j, m| {
            let force = acceleration.map(|a| m * a);
            if !self.is_direction(j) {
                visit(i, force);
            }
            if i != j && !self.is_direction(i) {
                visit(j, force);
            }
        });
    }
}
