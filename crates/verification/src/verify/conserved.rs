//! The figures of the table of conserved quantities in `docs/verification/conservation.md`, against the runs.

use std::collections::BTreeMap;

use super::Run;
use super::check::{Bound, Check, number};
use crate::workspace::Outcome;

/// Below this a figure is round-off, of which only the order counts.
const ROUND_OFF: f64 = 1e-11;

/// By how much the order of round-off may be missed: machines differ.
const ORDER: f64 = 10.0;

/// Figures have two digits.
const DIGITS: f64 = 0.06;

/// Where the table is.
pub const FILE: &str = "docs/verification/conservation.md";

/// Drifts of linear momentum, angular momentum and energy by scene; nothing where a cell begins with a word.
pub fn figures(page: &str) -> BTreeMap<String, [Option<f64>; 3]> {
    let rows = page.lines().filter_map(|line| {
        let cells: Vec<&str> = line.strip_prefix("| `scenes/")?.split('|').map(str::trim).collect();
        let scene = cells.first()?.split(".toml`").next()?.to_owned();
        let [.., linear, angular, energy, _] = cells.as_slice() else { return None };
        (cells.len() == 7).then(|| (scene, [linear, angular, energy].map(|cell| first_number(cell))))
    });
    rows.collect()
}

fn first_number(cell: &str) -> Option<f64> {
    cell.split_whitespace().next()?.parse().ok()
}

/// Rows for a run of a whole scene.
pub fn checks(run: &Run, figures: &[Option<f64>; 3], scales: [Option<f64>; 3]) -> Outcome<Vec<Check>> {
    let balance = run.balance()?;
    let [linear, angular, energy] = scales;
    let measured = [balance.linear_drift(linear), balance.angular_drift(angular), balance.energy_drift(energy)];
    let names = ["linear momentum", "angular momentum", "energy"];
    let rows = names.iter().zip(figures).zip(measured).filter_map(|((name, figure), measured)| {
        let figure = (*figure)?;
        let bound = match figure < ROUND_OFF {
            true => Bound::AtMost(ORDER * figure),
            false => Bound::Near { value: figure, tolerance: DIGITS * figure },
        };
        let note = format!("conservation.md: {}", number(figure));
        Some(Check::new(&run.name, format!("{name}, as the table says"), measured, bound).noted(note))
    });
    Ok(rows.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_there_and_names_shipped_scenes() {
        let workspace = crate::workspace::Workspace::find().unwrap();
        let found = figures(&workspace.read(FILE).unwrap());
        assert!(found.len() > 15, "{found:?}");
        for scene in found.keys() {
            assert!(workspace.path(format!("scenes/{scene}.toml")).is_file(), "{scene}");
        }
    }

    #[test]
    fn rows_of_the_table_are_found() {
        let text = "| `scenes/a.toml` | law | 100 | 6e-14 | 2e-13 | 7.6e-4 \u{b9} |\n| `scenes/b.toml`, `-03` | law | 5 | 1e-3 | 2 | never rises |\n| x | y |\n";
        let found = figures(text);
        assert_eq!(found["a"], [Some(6e-14), Some(2e-13), Some(7.6e-4)]);
        assert_eq!(found["b"], [Some(1e-3), Some(2.0), None]);
        assert_eq!(found.len(), 2);
    }
}
