//! Formulas of the six components 11, 22, 33, 12, 23, 13 of symmetric tensors, for numbers and for several side by side ([`Number`]).

use crate::{INDEX_PAIRS, number::Number};

/// Place of `[row][column]` among the six components.
pub const COMPONENT_OF: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// First invariant, the trace `a_ii`.
#[inline(always)]
pub fn trace<T: Number>(a: &[T; 6]) -> T {
    a[0] + a[1] + a[2]
}

/// Second invariant `(tr(a)^2 - tr(a^2))/2`.
#[inline(always)]
pub fn second<T: Number>([xx, yy, zz, xy, yz, xz]: [T; 6]) -> T {
    xx * yy + yy * zz + xx * zz - xy * xy - yz * yz - xz * xz
}

/// Third invariant, the determinant.
#[inline(always)]
pub fn determinant<T: Number>([xx, yy, zz, xy, yz, xz]: [T; 6]) -> T {
    xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
}

/// Inverse, given the determinant (which must not be zero).
#[inline(always)]
pub fn inverse<T: Number>([xx, yy, zz, xy, yz, xz]: [T; 6], determinant: T) -> [T; 6] {
    let r = determinant.like(1.0) / determinant;
    [
        r * (yy * zz - yz * yz),
        r * (xx * zz - xz * xz),
        r * (xx * yy - xy * xy),
        r * (xz * yz - xy * zz),
        r * (xy * xz - xx * yz),
        r * (xy * yz - yy * xz),
    ]
}

/// `a : b = a_ij b_ij`.
#[inline(always)]
pub fn double_contraction<T: Number>(a: &[T; 6], b: &[T; 6]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]) * 2.0
}

/// Component `[row][column]` of `-(A_ik A_jl + A_il A_jk)/2`, which is `d C^-1 / d C` of `A = C^-1` (theory/kinematics#eq-identities).
#[inline(always)]
pub fn inverse_derivative<T: Number>(inverse: &[T; 6], row: usize, column: usize) -> T {
    let ((i, j), (k, l)) = (INDEX_PAIRS[row], INDEX_PAIRS[column]);
    // No closure, see `wide::Operation`.
    let straight = inverse[COMPONENT_OF[i][k]] * inverse[COMPONENT_OF[j][l]];
    (straight + inverse[COMPONENT_OF[i][l]] * inverse[COMPONENT_OF[j][k]]) * -0.5
}
