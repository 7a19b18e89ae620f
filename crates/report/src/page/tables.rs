//! Tables for the charts of the page: long ones are thinned, the iterations of Newton's method are one row a step.

use serde::Serialize;

use crate::Outcome;
use crate::folder::Folder;
use crate::table::Table;
use crate::units;

/// Rows that a chart of one run has at most, and those that each of many has at least: a screen has fewer columns of pixels.
const ROWS: usize = 6000;
const FEWEST: usize = 1000;

/// Tables that a page shows, by their file names without `.csv`.
const NAMES: [&str; 7] = ["balance", "terms", "newton", "contact", "probes", "joints", "watch"];

/// Columns of `terms.csv` that say what is stored at the end of a step, and not what happened in it.
const STATES: [&str; 2] = [".stored", ".hardening"];

/// A table of the page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Columns {
    /// File of the table without `.csv`.
    pub name: String,
    /// Names of the columns.
    pub names: Vec<String>,
    /// Units of the columns; empty for pure numbers and in runs without units.
    pub units: Vec<String>,
    /// The columns; numbers that are not finite become `null`.
    pub values: Vec<Vec<f64>>,
    /// Rows before it was thinned.
    pub rows: usize,
}

/// All tables of a folder, one of so many runs; what is wrong with one of them becomes a note.
pub fn all(folder: &Folder, runs: usize, notes: &mut Vec<String>) -> Vec<Columns> {
    let most = (ROWS / runs.max(1)).max(FEWEST);
    let mut read = |name: &str| -> Option<Columns> {
        one(folder, name, most).unwrap_or_else(|error| {
            notes.push(error.to_string());
            None
        })
    };
    NAMES.iter().filter_map(|name| read(name)).collect()
}

fn one(folder: &Folder, name: &str, most: usize) -> Outcome<Option<Columns>> {
    let file = format!("{name}.csv");
    let Some(table) = folder.table(&file)? else { return Ok(None) };
    let table = match name {
        "newton" => iterations(&table).map_err(|error| format!("{}: {error}", folder.path().join(&file).display()))?,
        "terms" => since_start(columns(&table)),
        _ => columns(&table),
    };
    let unit = |column: &String| units::of_column(folder, name, column).unwrap_or_default();
    let units = table.names.iter().map(unit).collect();
    Ok(Some(thinned(Columns { name: name.to_owned(), units, ..table }, most)))
}

fn columns(table: &Table) -> Columns {
    // cannot fail: the names are the table's own.
    let values = table.names().iter().map(|name| table.column(name).map(<[f64]>::to_vec).unwrap_or_default());
    let names = table.names().to_vec();
    Columns { name: String::new(), names, units: Vec::new(), values: values.collect(), rows: table.rows() }
}

/// Sums since the start of what terms dissipate, supply and lose or make in each step; what they store stays. A remainder that is not measured counts as none.
fn since_start(mut table: Columns) -> Columns {
    let of_steps =
        |name: &String| !matches!(name.as_str(), "step" | "time") && !STATES.iter().any(|state| name.ends_with(state));
    for (_, values) in table.names.iter().zip(&mut table.values).filter(|(name, _)| of_steps(name)) {
        let mut sum = 0.0;
        for value in values {
            sum += if value.is_finite() { *value } else { 0.0 };
            *value = sum;
        }
    }
    table
}

/// Number of the last iteration of each step and the residual there.
fn iterations(table: &Table) -> Result<Columns, String> {
    let names = ["step", "time", "iteration", "residual"];
    let [steps, times, iterations, residuals] = names.map(|name| table.column(name));
    let (steps, times, iterations, residuals) = (steps?, times?, iterations?, residuals?);
    let ends = (0..steps.len()).filter(|&row| steps.get(row + 1) != Some(&steps[row]));
    let mut values = vec![Vec::new(); 4];
    for row in ends {
        for (column, value) in values.iter_mut().zip([steps[row], times[row], iterations[row], residuals[row]]) {
            column.push(value);
        }
    }
    let names = ["step", "time", "iterations", "last residual"].map(str::to_owned).to_vec();
    Ok(Columns { name: String::new(), names, units: Vec::new(), rows: values[0].len(), values })
}

/// Keeps at most `most` rows: the table is cut into parts of equal length, and of each part the first and the last row stay
/// and those in which a column is largest or smallest.
fn thinned(mut table: Columns, most: usize) -> Columns {
    let a_part = 2 * table.values.len() + 2;
    let rows = table.values.first().map_or(0, Vec::len);
    if rows <= most || most < a_part {
        return table;
    }
    let length = rows.div_ceil(most / a_part);
    let mut keep = Vec::new();
    for start in (0..rows).step_by(length) {
        let end = rows.min(start + length);
        let mut part = vec![start, end - 1];
        for column in &table.values {
            let numbers = || (start..end).filter(|&row| column[row].is_finite());
            part.extend(numbers().min_by(|&a, &b| column[a].total_cmp(&column[b])));
            part.extend(numbers().max_by(|&a, &b| column[a].total_cmp(&column[b])));
        }
        part.sort_unstable();
        part.dedup();
        keep.extend(part);
    }
    for column in &mut table.values {
        *column = keep.iter().map(|&row| column[row]).collect();
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_stay() {
        let rows = 100_000;
        let mut wave: Vec<f64> = (0..rows).map(|row| (f64::from(row) * 0.01).sin()).collect();
        (wave[77_777], wave[12_345], wave[5]) = (40.0, -30.0, f64::NAN);
        let time: Vec<f64> = (0..rows).map(f64::from).collect();
        let names = vec!["time".to_owned(), "wave".to_owned()];
        let table =
            Columns { name: "probes".into(), names, units: Vec::new(), values: vec![time, wave], rows: rows as usize };
        let thin = thinned(table, 600);
        let (time, wave) = (&thin.values[0], &thin.values[1]);
        assert!(time.len() <= 600 && time.len() > 300 && thin.rows == 100_000);
        assert!(time.windows(2).all(|pair| pair[0] < pair[1]));
        let at = |time_of: f64| wave[time.iter().position(|&time| time == time_of).unwrap()];
        assert_eq!((at(77_777.0), at(12_345.0), time[0], time[time.len() - 1]), (40.0, -30.0, 0.0, 99_999.0));
        assert_eq!(thinned(thin.clone(), 600), thin);
    }

    #[test]
    fn a_step_is_one_row() {
        let text = "step,time,iteration,residual\n1,0.1,0,1e0\n1,0.1,1,1e-9\n2,0.2,0,3e0\n2,0.2,1,1e-3\n2,0.2,2,2e-8\n";
        let table = iterations(&Table::parse(text).unwrap()).unwrap();
        assert_eq!(table.values, [vec![1.0, 2.0], vec![0.1, 0.2], vec![1.0, 2.0], vec![1e-9, 2e-8]]);
        assert!(iterations(&Table::parse("step,time\n").unwrap()).is_err());
    }
}
