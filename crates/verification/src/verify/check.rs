//! A measured quantity, its bound and the verdict.

use serde::Serialize;

/// What a measured value must satisfy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// A value that is not larger.
    AtMost(f64),
    /// A value that is not smaller.
    AtLeast(f64),
    /// A value that is not farther from `value` than `tolerance`.
    Near {
        /// Expected value.
        value: f64,
        /// Largest absolute difference.
        tolerance: f64,
    },
    /// No bound: the value is reported, not judged.
    Unbounded,
}

impl Bound {
    /// A value that is not a number satisfies no bound.
    pub fn holds(self, measured: f64) -> bool {
        match self {
            Self::AtMost(bound) => measured <= bound,
            Self::AtLeast(bound) => measured >= bound,
            Self::Near { value, tolerance } => (measured - value).abs() <= tolerance,
            Self::Unbounded => true,
        }
    }

    /// How much of the bound is used: 0 is exact, 1 is the bound itself. `None` without a bound, or where it is zero.
    pub fn used(self, measured: f64) -> Option<f64> {
        let ratio = match self {
            // Not `max`, which would hide what is not a number.
            Self::AtMost(bound) if bound > 0.0 => {
                if measured < 0.0 {
                    0.0
                } else {
                    measured / bound
                }
            }
            Self::AtLeast(bound) if bound > 0.0 => bound / measured,
            Self::Near { value, tolerance } if tolerance > 0.0 => (measured - value).abs() / tolerance,
            _ => return None,
        };
        Some(ratio)
    }

    /// Text of the bound as it is printed.
    pub fn text(self) -> String {
        match self {
            Self::AtMost(bound) => format!("<= {}", number(bound)),
            Self::AtLeast(bound) => format!(">= {}", number(bound)),
            Self::Near { value, tolerance: 0.0 } => format!("= {}", number(value)),
            Self::Near { value, tolerance } => format!("= {} +- {}", number(value), number(tolerance)),
            Self::Unbounded => "-".into(),
        }
    }
}

/// The words of [`Check::verdict`].
pub const OK: &str = "ok";
pub const SHORT: &str = "FALLS SHORT";
pub const REPORTED: &str = "reported";

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Name of the run.
    pub scene: String,
    /// What was measured.
    pub quantity: String,
    /// The value.
    pub measured: f64,
    /// What it must satisfy.
    pub bound: Bound,
    /// A note for the reader, e.g. that the run was shortened.
    pub note: String,
}

impl Check {
    /// Makes a row without a note.
    pub fn new(scene: &str, quantity: impl Into<String>, measured: f64, bound: Bound) -> Self {
        Self { scene: scene.to_owned(), quantity: quantity.into(), measured, bound, note: String::new() }
    }

    /// Adds a note.
    pub fn noted(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// True if the bound holds.
    pub fn holds(&self) -> bool {
        self.bound.holds(self.measured)
    }

    /// One word for the table.
    pub fn verdict(&self) -> &'static str {
        match (self.bound, self.holds()) {
            (Bound::Unbounded, _) => REPORTED,
            (_, true) => OK,
            (_, false) => SHORT,
        }
    }
}

/// A row as it is written to `report.json`.
#[derive(Serialize)]
pub struct CheckRecord<'a> {
    suite: &'a str,
    scene: &'a str,
    quantity: &'a str,
    /// `null` if it is not finite.
    measured: Option<f64>,
    bound: String,
    verdict: &'a str,
    note: &'a str,
}

impl<'a> CheckRecord<'a> {
    /// The record of a row of `suite`.
    pub fn new(suite: &'a str, check: &'a Check) -> Self {
        Self {
            suite,
            scene: &check.scene,
            quantity: &check.quantity,
            measured: check.measured.is_finite().then_some(check.measured),
            bound: check.bound.text(),
            verdict: check.verdict(),
            note: &check.note,
        }
    }
}

/// Counts plainly, small and large numbers with three digits.
pub fn number(value: f64) -> String {
    let plain = value == value.trunc() && value.abs() < 1e6;
    match value.abs() {
        _ if plain => format!("{value:.0}"),
        size if (0.01..1e6).contains(&size) => format!("{value:.4}"),
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_include_their_edge_and_refuse_nan() {
        let near = Bound::Near { value: 2.0, tolerance: 0.5 };
        assert!(Bound::AtMost(1.0).holds(1.0) && !Bound::AtMost(1.0).holds(1.1));
        assert!(Bound::AtLeast(1.0).holds(1.0) && !Bound::AtLeast(1.0).holds(0.9));
        assert!(near.holds(1.5) && near.holds(2.5) && !near.holds(2.6));
        for bound in [Bound::AtMost(1.0), Bound::AtLeast(1.0), near] {
            assert!(!bound.holds(f64::NAN));
        }
    }

    #[test]
    fn the_bound_itself_is_one() {
        assert_eq!(Bound::AtMost(2.0).used(2.0), Some(1.0));
        assert_eq!(Bound::AtLeast(2.0).used(4.0), Some(0.5));
        assert_eq!(Bound::Near { value: 1.0, tolerance: 0.5 }.used(0.75), Some(0.5));
        assert_eq!(Bound::AtMost(0.0).used(0.0), None);
        assert_eq!(Bound::Unbounded.used(1.0), None);
    }

    #[test]
    fn each_verdict_has_a_word() {
        let verdict = |bound| Check::new("s", "q", 1.0, bound).verdict();
        assert_eq!(
            [verdict(Bound::AtMost(2.0)), verdict(Bound::AtMost(0.5)), verdict(Bound::Unbounded)],
            ["ok", "FALLS SHORT", "reported"]
        );
        assert_eq!([3.0, 0.5, 1.25e-12].map(number), ["3", "0.5000", "1.25e-12"]);
    }
}
