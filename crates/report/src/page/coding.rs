//! Numbers that change little from frame to frame, as few bytes.
//!
//! A stream has 16-bit codes, `frames` rows of equal length. Stored is the second difference in time (of the first row the row itself, of the
//! second row the first difference), modulo 2^16, folded so that small numbers of both signs are small, `0 -1 1 -2 2 ... -> 0 1 2 3 4 ...`, and then all low
//! bytes before all high bytes. A general compressor follows, for which most high bytes are zero.

/// Code of a value that is no number.
pub const NOTHING: u16 = 0;
/// Largest size of a signed code of [`Scale::Root`], from the zero code 2048.
const ROOT: f64 = 2047.0;
/// Code of zero.
const ZERO: f64 = 2048.0;

/// How the codes of a field become values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// `value = largest t |t|` with `t = (code - 2048) / 2047`: values near zero, such as gaps in contact, keep their digits
    /// (step `2e-7 largest`); the largest ones are rounded to one part in a thousand.
    Root {
        /// Largest magnitude.
        largest: f64,
    },
    /// `value = code - 2048`, exact: numbers of a state.
    Integer,
}

impl Scale {
    /// The scale for these values; those that are not finite are left out.
    pub fn of(values: &[f32]) -> Self {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        if finite().all(|value| value.fract() == 0.0 && value.abs() < 128.0) {
            return Self::Integer;
        }
        Self::Root { largest: finite().fold(0.0, |largest, value| largest.max(f64::from(value.abs()))) }
    }

    /// Code of a value.
    pub fn code(self, value: f32) -> u16 {
        let value = f64::from(value);
        if !value.is_finite() {
            return NOTHING;
        }
        let signed = match self {
            Self::Root { largest } if largest > 0.0 => (value.abs() / largest).sqrt().copysign(value) * ROOT,
            Self::Root { .. } => 0.0,
            Self::Integer => value,
        };
        (signed + ZERO).round() as u16
    }

    /// Value of a code.
    pub fn value(self, code: u16) -> f64 {
        let signed = f64::from(code) - ZERO;
        match self {
            _ if code == NOTHING => f64::NAN,
            Self::Root { largest } => largest * (signed / ROOT) * (signed / ROOT).abs(),
            Self::Integer => signed,
        }
    }
}

/// Appends the stored bytes of a stream with rows of `row` codes to `out`.
pub fn encode(codes: &[u16], row: usize, out: &mut Vec<u8>) {
    let before = |k: usize, rows: usize| k.checked_sub(rows * row).map_or(0, |k| codes[k]);
    let folded: Vec<u16> = (0..codes.len())
        .map(|k| {
            // The row of before the first is taken as the first one, at rest.
            let (last, earlier) = (before(k, 1), if k < 2 * row { before(k, 1) } else { before(k, 2) });
            let difference = codes[k].wrapping_sub(last.wrapping_mul(2).wrapping_sub(earlier));
            (difference << 1) ^ ((difference as i16) >> 15) as u16
        })
        .collect();
    out.extend(folded.iter().map(|code| *code as u8));
    out.extend(folded.iter().map(|code| (code >> 8) as u8));
}

/// The codes of stored bytes; the inverse of [`encode`].
pub fn decode(bytes: &[u8], row: usize) -> Vec<u16> {
    let (low, high) = bytes.split_at(bytes.len() / 2);
    let mut codes: Vec<u16> = Vec::with_capacity(low.len());
    for (k, (low, high)) in low.iter().zip(high).enumerate() {
        let folded = u16::from_le_bytes([*low, *high]);
        let difference = (folded >> 1) ^ (folded & 1).wrapping_neg();
        let last = if k < row { 0 } else { codes[k - row] };
        let earlier = if k < 2 * row { last } else { codes[k - 2 * row] };
        codes.push(difference.wrapping_add(last.wrapping_mul(2).wrapping_sub(earlier)));
    }
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn steady_motion_costs_nothing_after_two_rows() {
        let codes: Vec<u16> = (0..5).flat_map(|frame| [100 + 7 * frame, 60_000 - 300 * frame]).collect();
        let mut bytes = Vec::new();
        encode(&codes, 2, &mut bytes);
        assert_eq!(bytes[4..10], [0; 6]);
        assert_eq!(bytes[14..], [0; 6]);
    }

    #[test]
    fn states_are_exact_and_nothing_stays_nothing() {
        let states = [0.0, 1.0, 2.0, -3.0, f32::NAN];
        let scale = Scale::of(&states);
        assert_eq!(scale, Scale::Integer);
        assert_eq!(states.map(|v| scale.value(scale.code(v))).map(|v| v.to_string()), ["0", "1", "2", "-3", "NaN"]);
    }

    proptest! {
        #[test]
        fn every_stream_comes_back(codes in prop::collection::vec(any::<u16>(), 0..200), row in 1_usize..9) {
            let codes = &codes[..codes.len() / row * row];
            let mut bytes = Vec::new();
            encode(codes, row, &mut bytes);
            prop_assert_eq!(decode(&bytes, row), codes);
        }

        /// The rounded root is off by half a step, `1 / 4094`: `|t|^2` then by `(2 |t| + 1/4094) / 4094`.
        #[test]
        fn roots_are_close(values in prop::collection::vec(-1e6_f32..1e6, 2..50)) {
            let scale = Scale::of(&values);
            if let Scale::Root { largest } = scale {
                for value in values.iter().map(|value| f64::from(*value)) {
                    let root = (value.abs() / largest).sqrt();
                    let bound = largest * (2.0 * root + 1.0 / 4094.0) / 4094.0 * (1.0 + 1e-9);
                    prop_assert!((scale.value(scale.code(value as f32)) - value).abs() <= bound);
                }
            }
        }
    }
}
