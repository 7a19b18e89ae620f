//! `stoss table`: columns of a table of a run as text or as comma-separated values.

mod columns;
mod layout;

use crate::terminal::{say, tell};
use columns::{Column, Entries};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use stoss_report::folder::Folder;
use stoss_report::table::TextTable;
use stoss_report::units;

/// What `stoss table` is asked for.
#[derive(clap::Args)]
pub struct Table {
    /// Folders of results, whose probes are taken; folders of sweeps, of which it is `sweep.csv`; or tables by name (DIR/balance.csv).
    #[arg(required = true)]
    tables: Vec<PathBuf>,
    /// Columns by name, formulas of them, or NAME=FORMULA [default: an overview of all columns]. before(x) is the value in the row before, change(x) is x - before(x), sum(x) adds up the rows.
    #[arg(short, long, value_name = "COLUMN", num_args = 1..)]
    columns: Vec<String>,
    /// First, last, smallest and largest value of each column instead of the rows.
    #[arg(long, conflicts_with_all = ["last", "every"])]
    extremes: bool,
    /// Only the last row.
    #[arg(long)]
    last: bool,
    /// Every Nth row, from the first one on.
    #[arg(long, value_name = "N", default_value_t = 1, hide_default_value = true, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
    /// Only rows from this time on.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    from: Option<f64>,
    /// Only rows up to this time.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    until: Option<f64>,
    /// Significant digits of the numbers.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u8).range(1..=17))]
    digits: u8,
    /// Print comma-separated values with all digits.
    #[arg(long, conflicts_with = "digits")]
    csv: bool,
    /// Write comma-separated values into this file instead.
    #[arg(short, long, value_name = "FILE.csv", conflicts_with = "digits")]
    output: Option<PathBuf>,
}

/// A table and where it is.
struct Source {
    /// Name of the table as it was given.
    label: String,
    path: PathBuf,
    table: TextTable,
}

/// A problem, and the exit code for it.
type Failure = (String, u8);

/// Carries out `stoss table`.
pub fn print(asked: &Table) -> ExitCode {
    match carry_out(asked) {
        Ok(text) => tell(&text),
        Err((message, code)) => {
            say!("error: {message}");
            ExitCode::from(code)
        }
    }
}

fn carry_out(asked: &Table) -> Result<String, Failure> {
    let sources: Vec<Source> = asked.tables.iter().map(|path| Source::open(path)).collect::<Result<_, _>>()?;
    let is_overview = asked.extremes || (asked.columns.is_empty() && !asked.csv && asked.output.is_none());
    if asked.columns.is_empty() && (asked.last || asked.every > 1) && is_overview {
        return Err(("--last and --every choose rows: name --columns, or print all with --csv".to_owned(), 2));
    }
    if let Some(file) = asked.output.as_deref().filter(|file| is_a_result(file, &sources)) {
        let message =
            format!("{}: would replace a table that the program has written; choose another file", file.display());
        return Err((message, 2));
    }
    let mut parts = Vec::new();
    for source in &sources {
        let columns = match asked.columns.is_empty() {
            true => columns::of_table(&source.table),
            false => columns::choose(&source.table, &asked.columns)
                .map_err(|message| (format!("{}: {message}", source.path.display()), 2))?,
        };
        let window = source.window(asked)?;
        let columns = if is_overview { source.overview(&columns, &window) } else { rows(&columns, &window, asked) };
        parts.push((source.label.as_str(), columns));
    }
    let table = layout::joined(parts);
    match &asked.output {
        Some(file) => {
            std::fs::write(file, layout::separated(&table))
                .map_err(|error| (format!("{}: {error}", file.display()), 1))?;
            Ok(file.display().to_string())
        }
        None if asked.csv => Ok(layout::separated(&table).trim_end().to_owned()),
        None => Ok(layout::aligned(&table, usize::from(asked.digits))),
    }
}

/// Whether a file is one of the tables that are read, or an existing one in a folder of results.
fn is_a_result(file: &Path, sources: &[Source]) -> bool {
    let Ok(file) = file.canonicalize() else { return false };
    let is_source = sources.iter().any(|source| source.path.canonicalize().is_ok_and(|path| path == file));
    is_source
        || file.parent().is_some_and(|folder| folder.join("run.json").is_file() || folder.join("sweep.csv") == file)
}

/// The chosen ones of the rows of a window.
fn rows(columns: &[Column], window: &[usize], asked: &Table) -> Vec<Column> {
    let chosen: Vec<usize> = match asked.last {
        true => window.last().copied().into_iter().collect(),
        false => window.iter().copied().step_by(asked.every as usize).collect(),
    };
    let column = |column: &Column| Column {
        name: column.name.clone(),
        entries: match &column.entries {
            Entries::Numbers(values) => Entries::Numbers(chosen.iter().map(|&row| values[row]).collect()),
            Entries::Words(words) => Entries::Words(chosen.iter().map(|&row| words[row].clone()).collect()),
        },
    };
    columns.iter().map(column).collect()
}

impl Source {
    fn open(asked: &Path) -> Result<Self, Failure> {
        let path = match asked.is_dir() {
            true => in_folder(asked)?,
            false => asked.to_path_buf(),
        };
        let table = TextTable::read(&path).map_err(|error| (error.to_string(), 1))?;
        Ok(Self { label: asked.display().to_string(), path, table })
    }

    /// Numbers of the rows in the chosen time.
    fn window(&self, asked: &Table) -> Result<Vec<usize>, Failure> {
        let all = 0..self.table.rows.len();
        if asked.from.is_none() && asked.until.is_none() {
            return Ok(all.collect());
        }
        let Some(time) = self.times() else {
            return Err((format!("{}: --from and --until need a column `time`", self.path.display()), 2));
        };
        let is_in = |row: &usize| {
            asked.from.is_none_or(|from| time[*row] >= from) && asked.until.is_none_or(|until| time[*row] <= until)
        };
        Ok(all.filter(is_in).collect())
    }

    fn times(&self) -> Option<Vec<f64>> {
        let columns = columns::of_table(&self.table);
        columns.into_iter().find(|column| column.name == "time").and_then(|column| match column.entries {
            Entries::Numbers(values) => Some(values),
            Entries::Words(_) => None,
        })
    }

    /// One row a column: its unit, first and last value, smallest and largest one with their times.
    fn overview(&self, columns: &[Column], window: &[usize]) -> Vec<Column> {
        let folder = self.path.parent().and_then(|folder| Folder::open(folder).ok());
        let stem = self.path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let unit = |name: &str| units::of_column(folder.as_ref()?, &stem, name);
        let times = self.times();
        let at = |row: Option<usize>| row.zip(times.as_ref()).map_or(f64::NAN, |(row, times)| times[row]);
        let shown: Vec<(&str, &[f64])> = columns
            .iter()
            .filter_map(|column| match &column.entries {
                Entries::Numbers(values) => Some((column.name.as_str(), values.as_slice())),
                Entries::Words(_) => None,
            })
            .collect();
        let row_of = |values: &[f64], better: fn(f64, f64) -> bool| {
            let numbers = window.iter().copied().filter(|&row| !values[row].is_nan());
            numbers.fold(None, |best: Option<usize>, row| match best {
                Some(best) if !better(values[row], values[best]) => Some(best),
                _ => Some(row),
            })
        };
        let value = |row: Option<usize>, values: &[f64]| row.map_or(f64::NAN, |row| values[row]);
        let numbers = |name: &str, of: &dyn Fn(&[f64]) -> f64| Column {
            name: name.to_owned(),
            entries: Entries::Numbers(shown.iter().map(|(_, values)| of(values)).collect()),
        };
        let words = |name: &str, of: &dyn Fn(&str) -> String| Column {
            name: name.to_owned(),
            entries: Entries::Words(shown.iter().map(|(name, _)| of(name)).collect()),
        };
        let (least, most) =
            (|values: &[f64]| row_of(values, |a, b| a < b), |values: &[f64]| row_of(values, |a, b| a > b));
        let mut overview = vec![words("column", &str::to_owned)];
        if shown.iter().any(|(name, _)| unit(name).is_some()) {
            overview.push(words("unit", &|name| unit(name).unwrap_or_default()));
        }
        overview.push(numbers("first", &|values| value(window.first().copied(), values)));
        overview.push(numbers("last", &|values| value(window.last().copied(), values)));
        overview.push(numbers("min", &|values| value(least(values), values)));
        overview.push(numbers("max", &|values| value(most(values), values)));
        if times.is_some() {
            overview.insert(overview.len() - 1, numbers("at time", &|values| at(least(values))));
            overview.push(numbers("at time", &|values| at(most(values))));
        }
        overview
    }
}

/// The table that a folder stands for: of a sweep its own, of a run its probes.
fn in_folder(folder: &Path) -> Result<PathBuf, Failure> {
    let found = ["sweep.csv", "probes.csv"].into_iter().map(|name| folder.join(name)).find(|path| path.is_file());
    if let Some(found) = found {
        return Ok(found);
    }
    let entries = std::fs::read_dir(folder).map_err(|error| (format!("{}: {error}", folder.display()), 1))?;
    let mut tables: Vec<String> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "csv"))
        .map(|path| path.display().to_string())
        .collect();
    tables.sort();
    let place = folder.display();
    Err(match tables.is_empty() {
        true => (format!("{place}: neither a run nor a sweep has left tables here"), 1),
        false => (format!("{place}: the run has no probes; name one of its tables: {}", tables.join(", ")), 2),
    })
}
