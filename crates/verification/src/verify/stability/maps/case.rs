//! A cell of a map: a run, and the closed forms that it is held against.

use super::text::{Text, Units};
use crate::table::Table;
use crate::workspace::Outcome;

/// What a run left.
pub struct Seen {
    /// `probes.csv`, a row for the start and one for each step.
    pub probes: Table,
    /// `balance.csv`.
    pub balance: Table,
}

impl Seen {
    /// Last entry of a column of the probes.
    pub fn last(&self, column: &str) -> Outcome<f64> {
        Ok(*self.probes.column(column)?.last().ok_or("probes.csv has no row")?)
    }

    /// Vectors of a probe.
    pub fn vectors(&self, name: &str) -> Outcome<Vec<[f64; 3]>> {
        let [x, y, z] = ["x", "y", "z"].map(|axis| format!("{name}.{axis}"));
        Ok(self.probes.vectors([&x, &y, &z])?)
    }

    /// Largest gain and largest loss of the total energy over its start.
    pub fn energy(&self) -> Outcome<[f64; 2]> {
        let total = self.balance.column("total")?;
        let start = *total.first().ok_or("balance.csv has no row")?;
        let most = total.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = total.iter().copied().fold(f64::INFINITY, f64::min);
        Ok([most / start - 1.0, 1.0 - least / start])
    }
}

/// A quantity beside its closed form.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// What it is.
    pub of: &'static str,
    /// How far it is off, relative.
    pub size: f64,
    /// How far it may be.
    pub bound: f64,
}

impl Deviation {
    /// Of a value from its closed form, relative to that.
    pub fn of(of: &'static str, value: f64, expected: f64, bound: f64) -> Self {
        Self { of, size: (value / expected - 1.0).abs(), bound }
    }

    /// Of a size that should be zero.
    pub fn zero(of: &'static str, size: f64, bound: f64) -> Self {
        Self { of, size: size.abs(), bound }
    }

    /// Over its bound; what is no number is infinitely far.
    pub fn used(&self) -> f64 {
        if self.size.is_finite() { self.size / self.bound } else { f64::INFINITY }
    }
}

/// What a finished run is held against.
pub type Oracle = Box<dyn Fn(&Seen) -> Outcome<Vec<Deviation>> + Send + Sync>;

/// A scene with its closed forms.
pub struct Problem {
    /// The scene.
    pub text: Text,
    /// The closed forms.
    pub oracle: Oracle,
}

/// One cell.
pub struct Case {
    /// The map that it belongs to: a method.
    pub map: &'static str,
    /// The row.
    pub axis: String,
    /// Place in the row.
    pub column: usize,
    /// The value on the axis.
    pub value: String,
    /// The scene and its closed forms.
    pub problem: Problem,
    /// Units in which the scene is that of the first cell of its row.
    pub units: Option<Units>,
}

impl Case {
    /// Name of the run, without dots: they would end the name of its log.
    pub fn name(&self) -> String {
        let name = format!("{}-{}-{}", self.map, self.axis, self.value).replace('.', "_");
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "_+-".contains(c) { c } else { '-' }).collect()
    }
}
