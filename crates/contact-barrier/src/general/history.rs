//! What general contact knows of the steps before: contacts in the layer with their weights and thicknesses, and the springs of those that stick.

use super::GeneralContact;
use super::joint::Joint;
use nalgebra::Vector3;
use stoss_contact::ContactError;
use stoss_geometry::PairKind;

/// Kind and points of the pair that is nearest in a contact.
pub(super) type Key = (PairKind, [u32; 4]);

/// Kinds of pairs, by their numbers in a checkpoint.
const KINDS: [PairKind; 4] =
    [PairKind::VertexTriangle, PairKind::EdgeEdge, PairKind::VertexEdge, PairKind::VertexVertex];

/// Bytes of a key, a contact, and a spring in a checkpoint; the number of contacts comes first.
const KEY: usize = 17;
const HELD: usize = KEY + 16;
const SPRING: usize = KEY + 40;
const COUNT: usize = 8;

/// A contact that is in its layer at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    pub key: Key,
    pub weight: f64,
    pub thickness: f64,
}

/// What friction of a contact has come to at the end of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rubbed {
    /// Stretch and energy of the spring of a contact that sticks.
    pub stretch: Vector3<f64>,
    pub stored: f64,
    /// Path slid in this contact.
    pub slid: f64,
}

/// Spring of friction of a contact: its key, and what the friction has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spring {
    pub key: Key,
    pub rubbed: Rubbed,
}

/// The state between two steps, both lists ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct History {
    pub held: Vec<Held>,
    pub springs: Vec<Spring>,
}

impl GeneralContact {
    /// The history at the end of the step.
    pub(super) fn history_at_end(&self) -> History {
        let mut history = History::default();
        let mut joint = Joint::default();
        let has_friction = self.rules.has_friction();
        for act in &self.acts {
            let key = (act.end.kind, act.end.points);
            if act.close.distance_squared < act.thickness * act.thickness {
                history.held.push(Held { key, weight: act.weight, thickness: act.thickness });
            }
            if has_friction {
                let rubbed = self.force(act, &mut joint, false).rubbed;
                if rubbed != Rubbed::default() {
                    history.springs.push(Spring { key, rubbed });
                }
            }
        }
        history.held.sort_by_key(|held| held.key);
        history.springs.sort_by_key(|spring| spring.key);
        history
    }
}

impl History {
    /// Bytes for checkpoints; none at all if there is no history.
    pub fn save(&self) -> Vec<u8> {
        let Self { held, springs } = self;
        if held.is_empty() && springs.is_empty() {
            return Vec::new();
        }
        let mut out = Vec::with_capacity(COUNT + HELD * held.len() + SPRING * springs.len());
        out.extend_from_slice(&(held.len() as u64).to_le_bytes());
        for Held { key, weight, thickness } in held {
            save_key(key, &mut out);
            [weight, thickness].into_iter().for_each(|value| out.extend_from_slice(&value.to_le_bytes()));
        }
        for Spring { key, rubbed: Rubbed { stretch, stored, slid } } in springs {
            save_key(key, &mut out);
            stretch.iter().chain([stored, slid]).for_each(|value| out.extend_from_slice(&value.to_le_bytes()));
        }
        out
    }

    /// What [`Self::save`] wrote, of a skin with so many points.
    ///
    /// # Errors
    /// [`ContactError::History`].
    pub fn load(bytes: &[u8], point_count: usize) -> Result<Self, ContactError> {
        let wrong = |reason: String| ContactError::History { reason };
        if bytes.is_empty() {
            return Ok(Self::default());
        }
        let Some((count, rest)) = bytes.split_first_chunk::<COUNT>() else {
            return Err(wrong(format!("{} bytes, of which {COUNT} are the number of contacts", bytes.len())));
        };
        let count = u64::from_le_bytes(*count);
        let all = usize::try_from(count).ok().and_then(|count| count.checked_mul(HELD));
        let Some((held, springs)) = all.and_then(|all| rest.split_at_checked(all)) else {
            return Err(wrong(format!("{} bytes for {count} contacts of {HELD} bytes", rest.len())));
        };
        if !springs.len().is_multiple_of(SPRING) {
            return Err(wrong(format!("{} bytes for springs of {SPRING} bytes", springs.len())));
        }
        let key = |chunk: &[u8]| {
            let kind =
                *KINDS.get(chunk[0] as usize).ok_or_else(|| wrong(format!("no pair is of kind {}", chunk[0])))?;
            let points: [u32; 4] =
                std::array::from_fn(|i| u32::from_le_bytes(std::array::from_fn(|k| chunk[1 + 4 * i + k])));
            match points.iter().find(|&&point| point as usize >= point_count) {
                Some(point) => Err(wrong(format!("point {point} of {point_count}"))),
                None => Ok((kind, points)),
            }
        };
        let value = |chunk: &[u8], i: usize| f64::from_le_bytes(std::array::from_fn(|k| chunk[KEY + 8 * i + k]));
        let held = held.chunks_exact(HELD).map(|chunk| {
            let held = Held { key: key(chunk)?, weight: value(chunk, 0), thickness: value(chunk, 1) };
            match held.weight > 0.0 && held.thickness > 0.0 {
                true => Ok(held),
                false => {
                    Err(wrong(format!("a contact of the weight {} and the thickness {}", held.weight, held.thickness)))
                }
            }
        });
        let springs = springs.chunks_exact(SPRING).map(|chunk| {
            let stretch = Vector3::new(value(chunk, 0), value(chunk, 1), value(chunk, 2));
            Ok(Spring { key: key(chunk)?, rubbed: Rubbed { stretch, stored: value(chunk, 3), slid: value(chunk, 4) } })
        });
        Ok(Self { held: held.collect::<Result<_, _>>()?, springs: springs.collect::<Result<_, _>>()? })
    }
}

fn save_key((kind, points): &Key, out: &mut Vec<u8>) {
    // cannot fail: it is one of the kinds.
    out.push(KINDS.iter().position(|k| k == kind).unwrap_or_default() as u8);
    points.iter().for_each(|point| out.extend_from_slice(&point.to_le_bytes()));
}
