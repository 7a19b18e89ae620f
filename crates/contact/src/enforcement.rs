//! How the normal part is enforced: by a multiplier or by a penalty (theory/constraints#enforcement; thesis, remark 6).
//!
//! One interface for both: the pressure stays an unknown, and every closed slot has one scalar equation for it, [`NormalRow`]. The
//! system has the same size and pattern in all cases, the active set the same condition, and friction, which needs pressure and its derivative,
//! does not see the difference. A penalty is thus a diagonal term `-A/stiffness` in the row of the pressure: no large number
//! enters the matrix, and the multiplier is the limit of an infinite stiffness.

use crate::ContactError;

/// How the pressure of a closed slot follows from its gap `e` (less the gap that the constraint refers to). Stiffnesses are tractions per length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Enforcement {
    /// `e = 0` at the end of the step.
    #[default]
    Multiplier,
    /// A spring against penetration, energy `A stiffness <-e>^2 / 2`. Its pressure is `stiffness <-e>` where the equations are those of the
    /// end of the step; in a midpoint scheme it is the spring's energy difference over the way, so that its work is exact
    /// also in steps in which a node closes or opens.
    Penalty(f64),
}

/// The equation of one closed slot: its residual is `-A value`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalRow {
    /// Value, a length.
    pub value: f64,
    /// Derivative with respect to the gap at the end of the step.
    pub d_gap: f64,
    /// Derivative with respect to the pressure, length per traction.
    pub d_pressure: f64,
}

impl Enforcement {
    /// Checks the stiffness.
    ///
    /// # Errors
    /// [`ContactError::Stiffness`] if it is not positive and finite.
    pub fn checked(self) -> Result<Self, ContactError> {
        match self {
            Self::Penalty(value) if !(value > 0.0 && value.is_finite()) => Err(ContactError::Stiffness { value }),
            _ => Ok(self),
        }
    }

    /// The equation of a closed slot. `at_end`: the scheme's equations are those of the end point; `ends`: gaps at both ends of the step, less the
    /// gap that the constraint refers to.
    pub fn row(self, at_end: bool, ends: [f64; 2], pressure: f64) -> NormalRow {
        match self {
            Self::Multiplier => NormalRow { value: ends[1], d_gap: 1.0, d_pressure: 0.0 },
            Self::Penalty(stiffness) => {
                let (depth, slope) = if at_end { end_depth(ends[1]) } else { mean_depth(ends) };
                NormalRow { value: pressure / stiffness - depth, d_gap: -slope, d_pressure: 1.0 / stiffness }
            }
        }
    }

    /// What stands for the gap of a closed slot in the complementarity condition, at a solution. A slot with a spring opens once it is without
    /// penetration at the end (midpoint schemes: at both ends) of the step.
    pub fn complementarity(self, at_end: bool, ends: [f64; 2]) -> f64 {
        match self {
            Self::Multiplier => ends[1],
            Self::Penalty(_) if at_end || ends[0] >= 0.0 => ends[1].max(0.0),
            Self::Penalty(_) => 0.0,
        }
    }

    /// Energy of the spring at a gap, per area.
    pub fn stored(self, gap: f64) -> f64 {
        match self {
            Self::Penalty(stiffness) => 0.5 * stiffness * gap.min(0.0).powi(2),
            _ => 0.0,
        }
    }
}

/// Depth and its derivative at the end.
fn end_depth(gap: f64) -> (f64, f64) {
    if gap < 0.0 { (-gap, -1.0) } else { (0.0, 0.0) }
}

/// `(w_1 - w_0) / (e_0 - e_1)` with `w = <-e>^2 / 2`, and its derivative with respect to `e_1`.
fn mean_depth([start, end]: [f64; 2]) -> (f64, f64) {
    match (start < 0.0, end < 0.0) {
        (true, true) => (-0.5 * (start + end), -0.5),
        (false, false) => (0.0, 0.0),
        (false, true) => {
            let part = end / (start - end);
            (0.5 * end * part, part + 0.5 * part * part)
        }
        (true, false) => {
            let part = start / (end - start);
            (0.5 * start * part, -0.5 * part * part)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KINDS: [Enforcement; 2] = [Enforcement::Multiplier, Enforcement::Penalty(50.0)];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn rows_have_their_derivatives(
            start in -1.0..1.0_f64, end in -1.0..1.0_f64, p in -1.0..9.0_f64, kind in 0..2_usize, at_end: bool,
        ) {
            const H: f64 = 1e-5;
            prop_assume!(end.abs() > 1e-3 && (end - start).abs() > 1e-2);
            let row = |end: f64, p: f64| KINDS[kind].row(at_end, [start, end], p);
            let here = row(end, p);
            let by_gap = (row(end + H, p).value - row(end - H, p).value) / (2.0 * H);
            let by_pressure = (row(end, p + H).value - row(end, p - H).value) / (2.0 * H);
            prop_assert!((by_gap - here.d_gap).abs() < 1e-4 && (by_pressure - here.d_pressure).abs() < 1e-9);
        }

        /// Over any path the spring's force does as much work as its energy says; at the end point it never gives more.
        #[test]
        fn the_spring_is_conservative(path in proptest::collection::vec(-1.0..1.0_f64, 2..20)) {
            let spring = KINDS[1];
            for pair in path.windows(2) {
                let ends = [pair[0], pair[1]];
                let stored = spring.stored(ends[1]) - spring.stored(ends[0]);
                // The row is p / stiffness - depth.
                let pressure = |at_end| -50.0 * spring.row(at_end, ends, 0.0).value;
                prop_assert!((pressure(false) * (ends[0] - ends[1]) - stored).abs() < 1e-12);
                prop_assert!(pressure(true) * (ends[0] - ends[1]) - stored >= -1e-12);
                prop_assert!(pressure(false) >= 0.0 && pressure(true) >= 0.0);
            }
        }
    }

    #[test]
    fn opens_without_penetration_only() {
        let spring = KINDS[1];
        assert_eq!(spring.complementarity(true, [-1.0, 0.2]), 0.2);
        assert_eq!(spring.complementarity(false, [-1.0, 0.2]), 0.0);
        assert_eq!(spring.complementarity(false, [0.1, 0.2]), 0.2);
        assert_eq!(spring.complementarity(false, [0.1, -0.2]), 0.0);
        assert!(Enforcement::Penalty(0.0).checked().is_err() && Enforcement::Penalty(f64::NAN).checked().is_err());
        assert!(KINDS.iter().all(|kind| kind.checked().is_ok()));
    }
}
