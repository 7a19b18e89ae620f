//! The TRAIT of a part of a mechanical system that is no solid: rigid bodies, beams, strings, springs, dampers.
//!
//! All unknowns of a system are vectors in space, three components each, numbered together: the position of a node, the centre of a rigid
//! body, a director. A part may bring vectors of its own, gives them a constant mass, and has forces that depend on its own and other vectors.
//!
//! # What it is not
//! No part ([`stoss-multibody`](https://docs.rs/stoss-multibody) has some), no constraint, no global system.
//!
//! # How to add a part
//! Implement [`Part`]. Forces that come from an energy `V(q)` must do the work `V(q_n) - V(q_np1)` under [`ForceRule::DiscreteGradient`], and must have neither
//! resultant nor moment about `(q_n + q_np1)/2`; then the energy-momentum scheme keeps what it promises.
//!
#![doc = include_str!("../README.md")]

use std::ops::Range;

pub use stoss_integrators::ForceRule;

/// Angular velocity of orthogonal vectors `D_k` of one length that turn together, at `q`, `v`: `1/2 sum_k D_k x D_k' / l^2`, the mean if they do not quite. `directions` are
/// the numbers of the three vectors.
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
    /// What is wrong, with the element and the value.
    pub reason: String,
}

/// Positions that the evaluation of a step may read, `3 * vectors` entries each.
#[derive(Clone, Copy, Debug)]
pub struct PartStep<'a> {
    /// Converged positions at `n`.
    pub q_n: &'a [f64],
    /// Iterate of the positions at `n+1`.
    pub q_np1: &'a [f64],
    /// Where forces are taken.
    pub rule: ForceRule,
    /// Step size.
    pub dt: f64,
    /// False in statics, where nothing has a rate and dampers do not act.
    pub has_rates: bool,
}

/// One dense contribution: `residual` is the internal force `dV/dq` (it is resisted by the rest of the system), `tangent` row-major
/// `d residual / d q_np1`; three rows for each of `vectors`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LocalForce {
    /// Global numbers of the vectors, each at most once.
    pub vectors: Vec<u32>,
    /// `3 * vectors` entries.
    pub residual: Vec<f64>,
    /// Row-major; empty or stale if it was not asked for.
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

/// A part of a system with constant mass. Everything is constant but for the positions that are handed in.
pub trait Part: Send + Sync + std::fmt::Debug {
    /// Name for reports and messages.
    fn name(&self) -> &str;

    /// Vectors that belong to this part and to nothing else; empty for springs and dampers.
    fn own_vectors(&self) -> Range<u32>;

    /// Whether one of the own vectors is a direction: a translation of the system leaves it as it is, so that its momentum is none of linear momentum.
    fn is_direction(&self, _vector: u32) -> bool {
        false
    }

    /// First of the own vectors that belong closest to this one, for the linear solver: those of a rigid body, of a cross-section.
    fn cluster(&self, vector: u32) -> u32 {
        vector
    }

    /// Entries `M_ij` of the mass (a mass each; it acts alike on the three components) with `i <= j`.
    fn mass(&self, _visit: &mut dyn FnMut(u32, u32, f64)) {}

    /// Dead forces of a uniform acceleration `a` (gravity): `f_i = sum_j M_ij a` with the positions `j` among the own vectors. Visits a vector as often as
    /// the mass names it; what it gets adds up.
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
    /// [`PartError`] if the configuration has no energy, for instance a string of no length.
    fn assemble(
        &self,
        _step: PartStep<'_>,
        _want_tangent: bool,
        _visit: &mut dyn FnMut(&LocalForce),
    ) -> Result<(), PartError> {
        Ok(())
    }

    /// Energy at a configuration.
    ///
    /// # Errors
    /// As [`Part::assemble`].
    fn energy(&self, _q: &[f64]) -> Result<f64, PartError> {
        Ok(0.0)
    }

    /// What dampers of this part took out of the system in a step that was accepted; never negative.
    fn dissipated(&self, _step: PartStep<'_>) -> f64 {
        0.0
    }

    /// Whether the forces leave linear momentum as it is: they add up to zero. Not so where the ground takes a part of them, as with a spring that is
    /// tied to it.
    fn conserves_linear_momentum(&self) -> bool {
        true
    }

    /// Whether the forces leave angular momentum as it is, under schemes that conserve it.
    fn conserves_angular_momentum(&self) -> bool {
        true
    }

    /// A length of the part, the unit of its deformations.
    fn length_scale(&self) -> f64;

    /// Size of the forces that a motion of a length would need, a force; zero without stiffness.
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
