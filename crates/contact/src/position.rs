//! Where a node is.

use nalgebra::Vector3;

/// Position of a node in a vector of the model, `3 * nodes` entries, node-major: also the reference position, a displacement or a velocity, by what `q` holds.
///
/// # Panics
/// If `q` is too short; numbers of nodes are checked where surfaces are made.
#[inline]
pub fn position(q: &[f64], node: u32) -> Vector3<f64> {
    let i = 3 * node as usize;
    Vector3::new(q[i], q[i + 1], q[i + 2])
}
