//! Rigid bodies without rotation parameters.

use crate::Embedded;
use crate::constraint::{ConstraintSet, Equation};
use crate::quadratic::QuadraticsBuilder;
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, Vector3};
use std::ops::Range;
use stoss_term::{Rule, Term, Vectors};

/// Why a rigid body cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigidError {
    /// A mass, a principal value or a length is not positive and finite.
    #[error("{what} = {value:e} must be positive and finite")]
    NotPositive {
        /// Name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A coordinate is NaN or infinite.
    #[error("{what} is not finite")]
    NotFinite {
        /// Name of the number.
        what: &'static str,
    },
}

/// Mass, centre of mass and Euler tensor with its principal axes.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidMass {
    /// Mass.
    pub mass: f64,
    /// Centre of mass in the reference configuration (a length each).
    pub centre: [f64; 3],
    /// Principal values of the Euler tensor `int rho (x - c) (x - c)^T dV`, mass times length squared each.
    pub euler: [f64; 3],
    /// Principal axes in the reference configuration, right-handed, one a row.
    pub axes: [[f64; 3]; 3],
}

impl RigidMass {
    /// The mass from principal values about given axes.
    ///
    /// # Errors
    /// [`RigidError`]. Of the principal values one may be zero, for a plate; with two zeros a spin about the third axis has no inertia.
    pub fn new(mass: f64, centre: [f64; 3], euler: [f64; 3], axes: [[f64; 3]; 3]) -> Result<Self, RigidError> {
        if !(mass > 0.0 && mass.is_finite()) {
            return Err(RigidError::NotPositive { what: "mass", value: mass });
        }
        if !centre.iter().chain(axes.iter().flatten()).all(|x| x.is_finite()) {
            return Err(RigidError::NotFinite { what: "the centre or an axis" });
        }
        let mut sorted = euler;
        sorted.sort_by(f64::total_cmp);
        if !(sorted[0] >= 0.0 && sorted[1] > 0.0 && sorted[2].is_finite()) {
            let value = if sorted[0] < 0.0 { sorted[0] } else { sorted[1] };
            return Err(RigidError::NotPositive { what: "principal value of the Euler tensor", value });
        }
        Ok(Self { mass, centre, euler, axes })
    }

    /// The mass from an Euler tensor about the centre of mass, whose principal axes are found.
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub fn of_tensor(mass: f64, centre: [f64; 3], euler: [[f64; 3]; 3]) -> Result<Self, RigidError> {
        if !euler.iter().flatten().all(|x| x.is_finite()) {
            return Err(RigidError::NotFinite { what: "the Euler tensor" });
        }
        let tensor = Matrix3::from_fn(|i, j| 0.5 * (euler[i][j] + euler[j][i]));
        let off = tensor[(0, 1)].abs().max(tensor[(1, 2)].abs()).max(tensor[(0, 2)].abs());
        if off <= 1e-14 * tensor.trace() {
            // Round-off must not turn the axes of a ball or a cube.
            let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            return Self::new(mass, centre, [tensor[(0, 0)], tensor[(1, 1)], tensor[(2, 2)]], axes);
        }
        let eigen = SymmetricEigen::new(tensor);
        let columns = [0, 1].map(|k| eigen.eigenvectors.column(k).into_owned());
        let third = columns[0].cross(&columns[1]);
        let axes = [columns[0], columns[1], third].map(|a| [a.x, a.y, a.z]);
        let values = [0, 1, 2].map(|k| {
            let a = Vector3::from(axes[k]);
            (tensor * a).dot(&a)
        });
        // A plate has a principal value of zero, but for round-off.
        Self::new(mass, centre, values.map(|e| if e.abs() <= 1e-14 * tensor.trace() { 0.0 } else { e }), axes)
    }
}

/// A rigid body with the unknowns `(c, D_1, D_2, D_3)`: the centre of mass and three orthogonal directors of length `l` along the principal axes
/// (thesis (2.1)-(2.6), there with unit length). With `l` a length of the body all entries of `q` are lengths and all multipliers forces. The mass is
/// constant, `diag(m, E_1/l^2, E_2/l^2, E_3/l^2)`.
///
/// Rigidity is six constraints, [`RigidBody::constraints`].
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    name: String,
    first: u32,
    mass: RigidMass,
    length: f64,
}

impl RigidBody {
    /// Number of its vectors: the centre and three directors.
    pub const VECTORS: u32 = 4;

    /// A body whose vectors are numbered from `first` on.
    pub fn new(name: &str, first: u32, mass: RigidMass) -> Self {
        // The radius of gyration: the three directors together are as heavy as the centre then.
        let length = (mass.euler.iter().sum::<f64>() / mass.mass).sqrt();
        Self { name: name.to_owned(), first, mass, length }
    }

    /// A body without mass, to which nodes of a solid are coupled ([`crate::kinematic_coupling`], [`crate::distributing_coupling`]). The couplings
    /// must determine its motion, for it has no inertia. Velocities at the start must be those that the couplings say.
    ///
    /// # Errors
    /// [`RigidError`] if the length is not positive, or something is not finite.
    pub fn massless(
        name: &str,
        first: u32,
        point: [f64; 3],
        axes: [[f64; 3]; 3],
        length: f64,
    ) -> Result<Self, RigidError> {
        if !(length > 0.0 && length.is_finite()) {
            return Err(RigidError::NotPositive { what: "length of a body without mass", value: length });
        }
        if !point.iter().chain(axes.iter().flatten()).all(|x| x.is_finite()) {
            return Err(RigidError::NotFinite { what: "the point or an axis" });
        }
        let mass = RigidMass { mass: 0.0, centre: point, euler: [0.0; 3], axes };
        Ok(Self { name: name.to_owned(), first, mass, length })
    }

    /// Length `l` of the directors.
    pub fn director_length(&self) -> f64 {
        self.length
    }

    /// Mass, centre, Euler tensor and axes in the reference configuration.
    pub fn mass(&self) -> &RigidMass {
        &self.mass
    }

    /// Reference values of the four vectors.
    pub fn reference(&self) -> [[f64; 3]; 4] {
        let director = |k: usize| self.mass.axes[k].map(|a| self.length * a);
        [self.mass.centre, director(0), director(1), director(2)]
    }

    /// Velocities of the four vectors for a velocity of the centre and an angular velocity.
    pub fn velocity(&self, velocity: [f64; 3], angular_velocity: [f64; 3]) -> [[f64; 3]; 4] {
        let spin = Vector3::from(angular_velocity);
        let of = |k: usize| {
            let v = spin.cross(&Vector3::from(self.reference()[k]));
            [v.x, v.y, v.z]
        };
        [velocity, of(1), of(2), of(3)]
    }

    /// Numbers of its vectors: the centre, then the directors.
    pub fn vectors(&self) -> Range<u32> {
        self.first..self.first + Self::VECTORS
    }

    /// Number of the first of its vectors, the centre.
    pub fn first(&self) -> u32 {
        self.first
    }

    /// The centre of mass.
    pub fn centre(&self) -> Embedded {
        Embedded::vector(self.first)
    }

    /// The point of the body that is at `x` in the reference configuration: `c + sum_k (x - c_0) . d_k0 / l D_k`.
    pub fn point(&self, x: [f64; 3]) -> Embedded {
        let arm: [f64; 3] = std::array::from_fn(|i| x[i] - self.mass.centre[i]);
        self.centre().plus(1.0, &self.direction(arm))
    }

    /// The vector fixed to the body that is `v` in the reference configuration.
    pub fn direction(&self, v: [f64; 3]) -> Embedded {
        let terms = (0..3).map(|k| {
            let axis = self.mass.axes[k];
            let component = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
            (self.first + 1 + k as u32, component / self.length)
        });
        Embedded { constant: [0.0; 3], terms: terms.filter(|&(_, w)| w != 0.0).collect() }
    }

    /// The six constraints of rigidity: `(D_i . D_j - l^2 delta_ij) / (2 l)`, off the diagonal `/ l`; lengths.
    pub fn constraints(&self) -> ConstraintSet {
        ConstraintSet::new(
            &format!("{} (rigidity)", self.name),
            self.length,
            vec![director_equations([1, 2, 3].map(|k| self.first + k), self.length)],
        )
        .as_rigidity()
    }

    /// Rotation of the body from the reference configuration at `q`: the orthogonal matrix nearest to `sum_k D_k / l (x) d_k0`, rows.
    pub fn rotation(&self, q: &[f64]) -> [[f64; 3]; 3] {
        let mut r = Matrix3::zeros();
        for k in 0..3 {
            let at = 3 * (self.first as usize + 1 + k);
            let now = Vector3::new(q[at], q[at + 1], q[at + 2]) / self.length;
            r += now * Vector3::from(self.mass.axes[k]).transpose();
        }
        let r = Rotation3::from_matrix_eps(&r, 1e-14, 30, Rotation3::identity());
        std::array::from_fn(|i| std::array::from_fn(|j| r[(i, j)]))
    }

    /// Angular velocity at `q`, `v`: `1/2 sum_k D_k x D_k' / l^2`.
    pub fn angular_velocity(&self, q: &[f64], v: &[f64]) -> [f64; 3] {
        stoss_term::angular_velocity(self.first + 1..self.first + 4, q, v)
    }
}

/// The six equations of three orthogonal directors of length `l`.
pub(crate) fn director_equations(directors: [u32; 3], length: f64) -> Equation {
    let mut builder = QuadraticsBuilder::new();
    let d = directors.map(|v| builder.form(&Embedded::vector(v)));
    for k in 0..3 {
        builder.function(-0.5 * length, &[(0.5 / length, d[k], d[k])]);
    }
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        builder.function(0.0, &[(1.0 / length, d[i], d[j])]);
    }
    Equation::each(builder.build())
}

impl Term for RigidBody {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn is_symmetric(&self, _rule: Rule) -> bool {
        true
    }

    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for RigidBody {
    fn own_vectors(&self) -> Range<u32> {
        self.vectors()
    }

    fn is_direction(&self, vector: u32) -> bool {
        vector != self.first
    }

    fn cluster(&self, _vector: u32) -> u32 {
        self.first
    }

    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        if self.mass.mass == 0.0 {
            return;
        }
        visit(self.first, self.first, self.mass.mass);
        for k in 0..3 {
            let v = self.first + 1 + k as u32;
            visit(v, v, self.mass.euler[k] / (self.length * self.length));
        }
    }
}
