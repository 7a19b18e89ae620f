//! `[sweep]`: runs of a scene with many values of its parameters.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// `[sweep]`: the cases of `stoss sweep`. Exactly one of `grid` and `cases`. A run of the scene by itself ignores it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Values of parameters: each combination is a case. Parameters are in alphabetical order; the last one varies
    /// fastest.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = "as the parameter")))]
    pub grid: BTreeMap<String, SweepValues>,
    /// List of cases, each with values of parameters; other parameters keep their value.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = "as the parameter")))]
    pub cases: Vec<BTreeMap<String, f64>>,
    /// Columns of result tables whose smallest and largest values are written to `sweep.csv`, as `TABLE.COLUMN`, for instance
    /// `contact.max_pressure`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub extremes: Vec<String>,
}

/// Values of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum SweepValues {
    /// A list.
    List(Vec<f64>),
    /// Equally spaced values.
    Range(SweepRange),
}

/// Equally spaced values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SweepRange {
    /// The first value.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = "as the parameter")))]
    pub from: f64,
    /// The last value.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = "as the parameter")))]
    pub to: f64,
    /// Number of values, both ends included, at least 2.
    pub count: u32,
}

impl SweepValues {
    /// The values in order.
    pub fn values(&self) -> Vec<f64> {
        match self {
            Self::List(values) => values.clone(),
            Self::Range(SweepRange { from, to, count }) => {
                let last = count.saturating_sub(1).max(1);
                (0..*count)
                    .map(|k| {
                        let s = f64::from(k) / f64::from(last);
                        // Both ends exactly.
                        (1.0 - s) * from + s * to
                    })
                    .collect()
            }
        }
    }
}

impl Sweep {
    /// Largest number of cases of a sweep.
    pub const MAX_CASES: usize = 100_000;

    /// Tables of results of which columns may be named in [`Self::extremes`].
    pub const TABLES: [&'static str; 6] = ["balance", "contact", "joints", "newton", "probes", "watch"];

    /// The parameters that some case gives, in alphabetical order.
    pub fn parameters(&self) -> Vec<&str> {
        let names = self.grid.keys().chain(self.cases.iter().flat_map(BTreeMap::keys));
        let mut names: Vec<&str> = names.map(String::as_str).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Number of cases.
    pub fn count(&self) -> usize {
        if self.grid.is_empty() {
            self.cases.len()
        } else {
            self.grid.values().fold(1, |count: usize, values| {
                count.saturating_mul(match values {
                    SweepValues::List(values) => values.len(),
                    SweepValues::Range(range) => range.count as usize,
                })
            })
        }
    }

    /// All cases in order: the values of the parameters that each gives.
    pub fn all(&self) -> Vec<BTreeMap<String, f64>> {
        if self.grid.is_empty() {
            return self.cases.clone();
        }
        let mut cases = vec![BTreeMap::new()];
        for (name, values) in &self.grid {
            let values = values.values();
            cases = cases
                .iter()
                .flat_map(|case| {
                    values.iter().map(move |&value| {
                        let mut case: BTreeMap<String, f64> = case.clone();
                        case.insert(name.clone(), value);
                        case
                    })
                })
                .collect();
        }
        cases
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_every_combination_once() {
        let grid = BTreeMap::from([
            ("mu".to_owned(), SweepValues::List(vec![0.0, 0.5])),
            ("radius".to_owned(), SweepValues::Range(SweepRange { from: 1.0, to: 1.3, count: 4 })),
        ]);
        let sweep = Sweep { grid, ..Sweep::default() };
        let cases = sweep.all();
        assert_eq!((sweep.count(), cases.len(), sweep.parameters()), (8, 8, vec!["mu", "radius"]));
        assert_eq!((cases[0]["mu"], cases[0]["radius"]), (0.0, 1.0));
        assert_eq!((cases[3]["mu"], cases[3]["radius"]), (0.0, 1.3));
        assert_eq!((cases[4]["mu"], cases[4]["radius"]), (0.5, 1.0));
        assert!((cases[1]["radius"] - 1.1).abs() < 1e-15);
    }
}
