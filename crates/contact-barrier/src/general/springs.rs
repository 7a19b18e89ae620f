//! Friction of pairs that stick in statics: springs that carry over from step to step.

use super::{Active, GeneralContact};
use crate::FrictionForce;
use crate::proximity::Candidate;
use nalgebra::Vector3;
use stoss_contact::ContactError;
use stoss_geometry::PairKind;

/// Kinds of pairs, by their numbers in a checkpoint.
const KINDS: [PairKind; 4] =
    [PairKind::VertexTriangle, PairKind::EdgeEdge, PairKind::VertexEdge, PairKind::VertexVertex];

/// Bytes of a spring in a checkpoint.
const SPRING: usize = 49;

/// The friction of a pair that sticks, at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spring {
    pub kind: PairKind,
    pub points: [u32; 4],
    pub stretch: Vector3<f64>,
    /// Its energy.
    pub stored: f64,
}

impl GeneralContact {
    /// Springs at the end of the step, ascending; none in dynamics.
    pub(super) fn stretched(&self) -> Vec<Spring> {
        if self.has_rates || !self.rules.has_friction() {
            return Vec::new();
        }
        let of = |active: &Active| {
            let Candidate { term, points, .. } = active.candidate;
            let FrictionForce { stretch, stored, .. } = self.force(active, None).friction;
            (stored > 0.0).then_some(Spring { kind: term.kind, points, stretch, stored })
        };
        let mut springs: Vec<Spring> = self.active.iter().filter_map(of).collect();
        springs.sort_unstable_by_key(|spring| (spring.kind, spring.points));
        springs
    }
}

/// The history of springs for checkpoints.
pub(super) fn save(springs: &[Spring]) -> Vec<u8> {
    let mut out = Vec::with_capacity(SPRING * springs.len());
    for Spring { kind, points, stretch, stored } in springs {
        // cannot fail: it is one of the kinds.
        out.push(KINDS.iter().position(|k| k == kind).unwrap_or_default() as u8);
        points.iter().for_each(|point| out.extend_from_slice(&point.to_le_bytes()));
        stretch.iter().chain([stored]).for_each(|value| out.extend_from_slice(&value.to_le_bytes()));
    }
    out
}

/// The springs that [`save`] wrote, of a skin with so many points.
///
/// # Errors
/// [`ContactError::History`].
pub(super) fn load(bytes: &[u8], point_count: usize) -> Result<Vec<Spring>, ContactError> {
    let wrong = |reason: String| ContactError::History { reason };
    if !bytes.len().is_multiple_of(SPRING) {
        return Err(wrong(format!("{} bytes for springs of {SPRING} bytes", bytes.len())));
    }
    let read = |chunk: &[u8]| {
        let kind = *KINDS.get(chunk[0] as usize).ok_or_else(|| wrong(format!("no pair is of kind {}", chunk[0])))?;
        let points = std::array::from_fn(|i| u32::from_le_bytes(std::array::from_fn(|k| chunk[1 + 4 * i + k])));
        if let Some(point) = points.iter().find(|&&point| point as usize >= point_count) {
            return Err(wrong(format!("point {point} of {point_count}")));
        }
        let value = |i: usize| f64::from_le_bytes(std::array::from_fn(|k| chunk[17 + 8 * i + k]));
        Ok(Spring { kind, points, stretch: Vector3::new(value(0), value(1), value(2)), stored: value(3) })
    };
    bytes.chunks_exact(SPRING).map(read).collect()
}
