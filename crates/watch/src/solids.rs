//! Elements that are inverted or nearly so, positions that are no numbers or far away.

use crate::WatchModel;
use nalgebra::Vector3;

/// Corners with the three corners beside each, right-handed.
const CORNERS: [[usize; 4]; 8] =
    [[0, 1, 3, 4], [1, 2, 0, 5], [2, 3, 1, 6], [3, 0, 2, 7], [4, 7, 5, 0], [5, 4, 6, 1], [6, 5, 7, 2], [7, 6, 4, 3]];

/// Scaled Jacobian below which an element is poor, if the mesh was not so from the start.
const POOR: f64 = 0.02;

/// Sizes of the model beyond which a position is far away.
const FAR: f64 = 1.0e3;

/// What was seen of the elements and positions of one state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidObservation {
    /// Body, element and smallest Jacobian of the worst element that is inverted at a Gauss point (2 x 2 x 2), over the mean of its edges cubed.
    pub inverted: Option<(usize, usize, f64)>,
    /// Body, element and smallest scaled Jacobian of the worst element whose corners are inverted or nearly so.
    pub poor: Option<(usize, usize, f64)>,
    /// The first node whose position is no finite number.
    pub not_finite: Option<u32>,
    /// The node that is farthest from the reference, if that is more than a thousand sizes of the model, and how many sizes.
    pub far: Option<(u32, f64)>,
}

/// Looks at all elements and positions. `rest` holds the scaled Jacobian of each element in the reference, body after body.
pub(crate) fn observe(model: &WatchModel, rest: &[f64], q: &[f64]) -> SolidObservation {
    let mut seen = SolidObservation::default();
    if let Some(k) = q.iter().position(|x| !x.is_finite()) {
        seen.not_finite = Some((k / 3) as u32);
        return seen;
    }
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for x in model.reference.chunks_exact(3) {
        for i in 0..3 {
            low[i] = low[i].min(x[i]);
            high[i] = high[i].max(x[i]);
        }
    }
    let size = (0..3).map(|i| (high[i] - low[i]).powi(2)).sum::<f64>().sqrt();
    // Without bodies there is no size to compare with: a mass on a string may go anywhere.
    let points = if model.bodies.is_empty() || size == 0.0 { &[] } else { q };
    for (node, x) in points.chunks_exact(3).enumerate() {
        let beyond = (0..3).map(|i| (low[i] - x[i]).max(x[i] - high[i]).max(0.0)).fold(0.0, f64::max) / size;
        if beyond > FAR && seen.far.is_none_or(|(_, worst)| beyond > worst) {
            seen.far = Some((node as u32, beyond));
        }
    }
    let mut e = 0;
    for (b, body) in model.bodies.iter().enumerate() {
        for (k, hexahedron) in body.hexahedra().iter().enumerate() {
            let x = hexahedron.map(|node| Vector3::from_column_slice(&q[3 * node as usize..3 * node as usize + 3]));
            let scaled = scaled_jacobian(&x);
            if scaled < POOR && scaled < 0.5 * rest[e] {
                if seen.poor.is_none_or(|(.., worst)| scaled < worst) {
                    seen.poor = Some((b, k, scaled));
                }
                let jacobian = gauss_jacobian(&x);
                if jacobian <= 0.0 && seen.inverted.is_none_or(|(.., worst)| jacobian < worst) {
                    seen.inverted = Some((b, k, jacobian));
                }
            }
            e += 1;
        }
    }
    seen
}

/// Smallest triple product of the unit edges at a corner.
pub(crate) fn scaled_jacobian(x: &[Vector3<f64>; 8]) -> f64 {
    let at = |[o, a, b, c]: [usize; 4]| {
        let edges = [a, b, c].map(|k| x[k] - x[o]);
        let lengths: f64 = edges.iter().map(|edge| edge.norm()).product();
        edges[0].cross(&edges[1]).dot(&edges[2]) / lengths.max(f64::MIN_POSITIVE)
    };
    CORNERS.into_iter().map(at).fold(f64::INFINITY, f64::min)
}

/// Smallest determinant of the map from the unit cube at the Gauss points, over the mean edge cubed.
fn gauss_jacobian(x: &[Vector3<f64>; 8]) -> f64 {
    let edge = CORNERS.iter().flat_map(|&[o, others @ ..]| others.map(|k| (x[k] - x[o]).norm())).sum::<f64>() / 24.0;
    let point = 0.5 / 3.0_f64.sqrt();
    let mut least = f64::INFINITY;
    for k in 0..8 {
        let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let [u, v, w] = [0, 1, 2].map(|bit| 0.5 + sign(bit) * point);
        let along = |pairs: [[usize; 2]; 4], s: f64, t: f64| {
            let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
            pairs.iter().zip(weights).fold(Vector3::zeros(), |sum, ([a, b], weight)| sum + (x[*b] - x[*a]) * weight)
        };
        let du = along([[0, 1], [3, 2], [4, 5], [7, 6]], v, w);
        let dv = along([[0, 3], [1, 2], [4, 7], [5, 6]], u, w);
        let dw = along([[0, 4], [1, 5], [3, 7], [2, 6]], u, v);
        least = least.min(du.cross(&dv).dot(&dw) / edge.powi(3).max(f64::MIN_POSITIVE));
    }
    least
}
