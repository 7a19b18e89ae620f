//! The ability to own vectors.

use crate::Term;
use std::ops::Range;

/// Vectors that belong to one term only, with a constant mass.
pub trait Vectors {
    /// Their numbers.
    fn own_vectors(&self) -> Range<u32>;

    /// Whether one of them is a director: a translation of the system does not change it, so that it does not contribute to linear momentum.
    fn is_direction(&self, _vector: u32) -> bool {
        false
    }

    /// First of them that the linear solver keeps together with this one: those of a rigid body, or of a cross-section.
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

/// The same of any term; those without the ability own no vector.
impl dyn Term + '_ {
    /// See [`Vectors::own_vectors`].
    pub fn own_vectors(&self) -> Range<u32> {
        self.vectors().map_or(0..0, |of| of.own_vectors())
    }

    /// See [`Vectors::is_direction`].
    pub fn is_direction(&self, vector: u32) -> bool {
        self.vectors().is_some_and(|of| of.is_direction(vector))
    }

    /// See [`Vectors::cluster`].
    pub fn cluster(&self, vector: u32) -> u32 {
        self.vectors().map_or(vector, |of| of.cluster(vector))
    }

    /// See [`Vectors::mass`].
    pub fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        if let Some(of) = self.vectors() {
            of.mass(visit);
        }
    }

    /// See [`Vectors::weight`].
    pub fn weight(&self, acceleration: [f64; 3], visit: &mut dyn FnMut(u32, [f64; 3])) {
        if let Some(of) = self.vectors() {
            of.weight(acceleration, visit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two positions with a consistent mass, and a direction that is coupled with the second.
    #[derive(Debug)]
    struct Three;

    impl Term for Three {
        fn name(&self) -> &str {
            "three"
        }
        fn length_scale(&self) -> f64 {
            1.0
        }
        fn vectors(&self) -> Option<&dyn Vectors> {
            Some(self)
        }
    }

    impl Vectors for Three {
        fn own_vectors(&self) -> Range<u32> {
            4..7
        }
        fn is_direction(&self, vector: u32) -> bool {
            vector == 6
        }
        fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
            [(4, 4, 2.0), (4, 5, 1.0), (5, 5, 2.0), (5, 6, 0.5), (6, 6, 7.0)]
                .iter()
                .for_each(|&(i, j, m)| visit(i, j, m));
        }
    }

    /// A uniform acceleration of the positions: `M (a, a, 0)`.
    #[test]
    fn weight_is_the_mass_times_the_acceleration_of_positions() {
        let mut force = [[0.0; 3]; 3];
        let three: &dyn Term = &Three;
        three.weight([0.0, -1.0, 10.0], &mut |i, f| (0..3).for_each(|d| force[i as usize - 4][d] += f[d]));
        assert_eq!(force, [[0.0, -3.0, 30.0], [0.0, -3.0, 30.0], [0.0, -0.5, 5.0]]);
    }
}
