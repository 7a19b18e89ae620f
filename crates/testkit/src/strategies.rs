//! Random states: rotations, admissible deformation gradients and right Cauchy-Green tensors.
//!
//! Stretches stay between 0.2 and 2, `J` above 0.2: far enough to find a wrong formula, not so far that differences drown in round-off.

use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;
use stoss_tensor::SymmetricTensor2;

/// A random rotation (not uniformly distributed).
pub fn rotation() -> impl Strategy<Value = Matrix3<f64>> {
    proptest::array::uniform3(-3.0..3.0_f64).prop_map(|a| Rotation3::from_euler_angles(a[0], a[1], a[2]).into_inner())
}

/// `C = Q diag(stretch^2) Q^T` for given stretches.
fn with_stretches(stretches: [f64; 3], q: &Matrix3<f64>) -> SymmetricTensor2 {
    let squares = Vector3::from_fn(|i, _| stretches[i] * stretches[i]);
    SymmetricTensor2::from_matrix(&(q * Matrix3::from_diagonal(&squares) * q.transpose()))
}

/// Right Cauchy-Green tensors with stretches between 0.6 and 1.7 and any axes.
pub fn right_cauchy_green() -> impl Strategy<Value = SymmetricTensor2> {
    (proptest::array::uniform3(0.6..1.7_f64), rotation()).prop_map(|(s, q)| with_stretches(s, &q))
}

/// Strongly compressed states: `J` between 0.2 and 0.3.
pub fn crushed() -> impl Strategy<Value = SymmetricTensor2> {
    (proptest::array::uniform3(0.7..1.3_f64), 0.2..0.3_f64, rotation()).prop_map(|(s, j, q)| {
        let factor = (j / (s[0] * s[1] * s[2])).cbrt();
        with_stretches(s.map(|x| factor * x), &q)
    })
}

/// Two equal stretches, or three, exactly or up to a relative gap between 1e-14 and 1e-2.
pub fn repeated_stretches() -> impl Strategy<Value = SymmetricTensor2> {
    (0.5..1.6_f64, 0.5..1.6_f64, 2..16_i32, any::<[bool; 2]>(), rotation()).prop_map(
        |(a, b, power, [gap, three], q)| {
            let near = if gap { a * (1.0 + 10.0_f64.powi(-power)) } else { a };
            with_stretches([a, near, if three { a } else { b }], &q)
        },
    )
}

/// Pairs of states for a step, with increments from 1e-9 to about 1 in any direction; also equal ones.
pub fn step() -> impl Strategy<Value = (SymmetricTensor2, SymmetricTensor2)> {
    let near =
        (any_state(), proptest::array::uniform6(-1.0..1.0_f64), 1.0..9.0_f64).prop_map(|(c, direction, power)| {
            // Relative to the smallest eigenvalue: stays positive definite.
            let size = stoss_tensor::spectral_decomposition(&c).values[0] * 10.0_f64.powf(-power);
            let direction = SymmetricTensor2(direction);
            (c, c + direction * (size / direction.norm().max(0.1)))
        });
    prop_oneof![3 => (any_state(), any_state()), 5 => near, 1 => any_state().prop_map(|c| (c, c))]
}

/// Deformation gradients `R U` with `det F` between 0.2 and about 5, equal stretches included.
pub fn deformation_gradient() -> impl Strategy<Value = Matrix3<f64>> {
    (any_state(), rotation()).prop_map(|(c, r)| {
        let form = stoss_tensor::spectral_decomposition(&c);
        let stretch = (0..3)
            .fold(Matrix3::zeros(), |u, a| u + form.vectors[a] * form.vectors[a].transpose() * form.values[a].sqrt());
        r * stretch
    })
}

/// All of the above tensors.
pub fn any_state() -> impl Strategy<Value = SymmetricTensor2> {
    prop_oneof![3 => right_cauchy_green(), 1 => crushed(), 2 => repeated_stretches()]
}
