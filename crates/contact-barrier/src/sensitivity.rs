//! How the closest points of a pair move along their features when its points move.

use nalgebra::Vector3;
use stoss_geometry::{ClosestPair, combine};

/// Smallest squared sine between two free directions that is inverted. Below it closest points of a sliver move by much more than the pair; the factor of nearly parallel edges is zero there.
const FLOOR: f64 = 1e-12;

/// Free directions `B_a` of closest weights, and how far the closest points move along them, theory/barrier#eq-closest-motion.
pub(crate) struct Sensitivity {
    /// `B_a`; `count` of them.
    pub directions: [[f64; 4]; 2],
    /// `T_a = sum_i B_ai x_i`.
    pub tangents: [Vector3<f64>; 2],
    /// `dgamma_a/dx_j`.
    pub moves: [[Vector3<f64>; 4]; 2],
    pub count: usize,
}

impl Sensitivity {
    /// The sensitivity of the closest points `closest` at `x`, `r` between them.
    pub fn new(closest: &ClosestPair, x: &[Vector3<f64>; 4], r: &Vector3<f64>) -> Self {
        let free = closest.free_directions();
        let count = free.as_slice().len();
        let mut directions = [[0.0; 4]; 2];
        directions[..count].copy_from_slice(free.as_slice());
        let tangents = directions.map(|b| combine(&b, x));
        let inverse = inverse_gram(&tangents[..count]);
        let mut moves = [[Vector3::zeros(); 4]; 2];
        for a in 0..count {
            for j in 0..4 {
                for b in 0..count {
                    moves[a][j] -= (tangents[b] * closest.weights[j] + r * directions[b][j]) * inverse[a][b];
                }
            }
        }
        Self { directions, tangents, moves, count }
    }
}

/// Inverse of `T_a . T_b` for none to two vectors.
fn inverse_gram(tangents: &[Vector3<f64>]) -> [[f64; 2]; 2] {
    match tangents {
        [t] => [[1.0 / t.norm_squared(), 0.0], [0.0; 2]],
        [t, s] => {
            let (tt, ts, ss) = (t.norm_squared(), t.dot(s), s.norm_squared());
            // |t x s|^2 keeps digits that tt ss - ts^2 loses.
            let determinant = t.cross(s).norm_squared().max(FLOOR * tt * ss);
            [[ss / determinant, -ts / determinant], [-ts / determinant, tt / determinant]]
        }
        _ => [[0.0; 2]; 2],
    }
}
