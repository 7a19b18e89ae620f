//! The TRAIT of a part of a mechanical system other than a solid: rigid bodies, beams, strings, springs, dampers.
//!
//! All unknowns of a system are vectors in space, three components each, numbered together: the position of a node, the centre of a rigid
//! body, a director. A part may bring vectors of its own, gives them a constant mass, and has forces that depend on its own and other vectors.
//!
//! # What it is not
//! No implementation (those are in [`stoss-multibody`](https://docs.rs/stoss-multibody)), no constraint, no global system.
//!
//! # How to add a part
//! Implement [`Part`]. Forces that come from an energy `V(q)` must do the work `V(q_n) - V(q_np1)` under [`ForceRule::DiscreteGradient`], and must have neither
//! resultant nor moment about `(q_n + q_np1)/2`; then the energy-momentum scheme conserves energy and momenta. `docs/how-to-add/part.md` has the steps, with an example.
//!
#![doc = include_str!("../README.md")]

use std::ops::Range;

pub use stoss_integrators::ForceRule;

/// Angular velocity (three values, 1/time) of three orthogonal directors `D_k` of equal length `l` at positions `q` and velocities `v`: `1/2 sum_k D_k x D_k' / l^2`; a mean value if the directors do not
/// rotate rigidly. `directions` are the numbers of the three vectors.
pub fn angular_velocity(directions: impl IntoIterator<Item = u32>, q: &[f64], v: &[f64]) -> [f64; 3] {
    let mut spin = [0.0; 3];
    for vector in directions {
        let first = 3 * vector as usize;
        let (d, v) = (&q[first..first + 3], &v[first..first + 3]);
        let square: f64 = d.iter().map(|d| d * d).sum();
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            spin[i] += 0.5 * (d[j] * v[k] - d[k] * v[j]) / square;
        }
    }
    spin
}

/// Why a part cannot be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{part}: {reason}")]
pub struct PartError {
    /// Name of the part.
    pub part: String,
    /// The error, with element and value.
    pub reason: String,
}

/// Positions and rule of a step, for its evaluation; `3 * vectors` entries each.
#[derive(Clone, Copy, Debug)]
pub struct PartStep<'a> {
    /// Converged positions at `n`.
    pub q_n: &'a [f64],
    /// Iterate of the positions at `n+1`.
    pub q_np1: &'a [f64],
    /// Configuration at which forces are evaluated.
    pub rule: ForceRule,
    /// Step size.
    pub dt: f64,
    /// False in statics, where dampers do not act.
    pub has_rates: bool,
}

/// A dense contribution: `residual` is the internal force `dV/dq` (positive as in the residual `M a + F_int - F_ext`), `tangent` is
/// `d residual / d q_np1`, row-major; three rows for each of `vectors`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LocalForce {
    /// Global numbers of the vectors, each at most once.
    pub vectors: Vec<u32>,
    /// `3 * vectors` entries.
    pub residual: Vec<f64>,
    /// Row-major, `dim * dim` entries; meaningless if it was not requested.
    pub tangent: Vec<f64>,
}

impl LocalForce {
    /// Number of rows.
    pub fn dim(&self) -> usize {
        3 * self.vectors.len()
    }

    /// Sizes and clears the arrays for the present `vectors`.
    pub fn reset(&mut self, want_tangent: bool) {
        let n = self.dim();
        self.residual.clear();
        self.residual.resize(n, 0.0);
        if want_tangent {
            self.tangent.clear();
            self.tangent.resize(n * n, 0.0);
        }
    }
}

/// A part of a system, with constant mass and without internal state: all methods depend on the positions given to them only.
pub trait Part: Send + Sync + std::fmt::Debug {
    /// Name for reports and messages.
    fn name(&self) -> &str;

    /// Numbers of the vectors that belong to this part only; empty for springs and dampers.
    fn own_vectors(&self) -> Range<u32>;

    /// Whether one of the own vectors is a director: a translation of the system does not change it, so that it does not contribute to linear momentum.
    fn is_direction(&self, _vector: u32) -> bool {
        false
    }

    /// First of the own vectors that the linear solver keeps together with this one: those of a rigid body, or of a cross-section.
    fn cluster(&self, vector: u32) -> u32 {
        vector
    }

    /// Entries `M_ij` of the mass (a mass each; it acts alike on the three components) with `i <= j`.
    fn mass(&self, _visit: &mut dyn FnMut(u32, u32, f64)) {}

    /// Dead forces of a uniform acceleration `a` (gravity): `f_i = sum_j M_ij a` with the positions `j` among the own vectors. A vector is visited once for each of its
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

    /// Vectors of every contribution, in the order of [`Part::assemble`].
    fn stencils(&self, _visit: &mut dyn FnMut(&[u32])) {}

    /// Forces and, if asked, tangents.
    ///
    /// # Errors
    /// [`PartError`] if the energy is not defined at the configuration, for instance for a string of zero length.
    fn assemble(
        &self,
        _step: PartStep<'_>,
        _want_tangent: bool,
        _visit: &mut dyn FnMut(&LocalForce),
    ) -> Result<(), PartError> {
        Ok(())
    }

    /// Potential energy at a configuration.
    ///
    /// # Errors
    /// As [`Part::assemble`].
    fn energy(&self, _q: &[f64]) -> Result<f64, PartError> {
        Ok(0.0)
    }

    /// Energy that the dampers of this part dissipate in an accepted step; not negative.
    fn dissipated(&self, _step: PartStep<'_>) -> f64 {
        0.0
    }

    /// Whether the forces conserve linear momentum, that is, their resultant is zero. False for instance for a spring to
    /// the ground.
    fn conserves_linear_momentum(&self) -> bool {
        true
    }

    /// Whether the forces conserve angular momentum with schemes that can.
    fn conserves_angular_momentum(&self) -> bool {
        true
    }

    /// A characteristic length, to which deformations are compared.
    fn length_scale(&self) -> f64;

    /// A characteristic force: stiffness times characteristic length; zero without stiffness.
    fn force_scale(&self) -> f64 {
        0.0
    }

    /// Whether the tangent is symmetric unless forces are taken as discrete gradients.
    fn is_symmetric(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two positions with a consistent mass, and a direction that is coupled with the second.
    #[derive(Debug)]
    struct Three;

    impl Part for Three {
        fn name(&self) -> &str {
            "three"
        }
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
        fn length_scale(&self) -> f64 {
            1.0
        }
    }

    /// A uniform acceleration of the positions: `M (a, a, 0)`.
    #[test]
    fn weight_is_the_mass_times_the_acceleration_of_positions() {
        let mut force = [[0.0; 3]; 3];
        Three.weight([0.0, -1.0, 10.0], &mut |i, f| (0..3).for_each(|d| force[i as usize - 4][d] += f[d]));
        assert_eq!(force, [[0.0, -3.0, 30.0], [0.0, -3.0, 30.0], [0.0, -0.5, 5.0]]);
    }
}
