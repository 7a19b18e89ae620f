//! Stability maps: methods of contact, schemes and cells over stiffness, mass, step, Poisson's ratio, slenderness, mesh, friction, units, speed, gap and rest.
//!
//! Each cell is a run of a few elements with closed forms ([`problems`]). A run that the watch calls sound and whose closed form does not hold is a silent failure, which must not be. A
//! run that ends with an error must be explained ([`reasons`]). Full mode writes the table of cells, a picture of each map and the summary in the document; quick mode runs some
//! cells and holds them against the stored table.

mod axes;
mod case;
mod cell;
mod problems;
mod reasons;
mod stored;
mod text;

use super::super::check::{Bound, Check};
use super::super::launch::launch_within;
use super::super::report::{Grid, ReportSection};
use super::super::side_by_side::side_by_side;
use super::super::{Bench, Findings};
use crate::plot::{self, Cell, Labels};
use crate::workspace::{Outcome, write};
use case::Case;
use cell::{Found, Record, WORDS, Word};
use std::fmt::Write;
use std::time::Duration;

/// Where scenes and results go, below the folder of `verify`.
const FOLDER: &str = "maps";

/// The stored table, the folder of the pictures, and the document with the summary.
const TABLE: &str = "docs/verification/stability-maps.csv";
const PICTURES: &str = "docs/verification/stability";
const DOCUMENT: &str = "docs/verification/stability.md";

/// Lines of the document between which the summary is written.
const MARKS: [&str; 2] = ["<!-- maps: written by `cargo xtask verify stability` -->", "<!-- maps: end -->"];

/// Time after which a run counts as one that does not end, on a machine that does other things as well.
const LIMIT: Duration = Duration::from_secs(900);

/// Quick mode runs the last but one cell of every so many rows.
const EVERY: usize = 2;

/// Runs the maps, in quick mode some cells of them.
pub fn measure(bench: &Bench) -> Outcome<Findings> {
    let cases = if bench.quick { some(axes::cases()) } else { axes::cases() };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let run = |case: &Case| -> Result<Found, String> {
        let (name, scene) = (case.name(), case.problem.text.text());
        let launched = launch_within(bench, FOLDER, &name, scene, &[], LIMIT).map_err(|error| error.to_string())?;
        cell::read(case, &launched).map_err(|error| format!("{}: {error}", case.name()))
    };
    let mut found = side_by_side(&cases, threads, run).into_iter().collect::<Result<Vec<Found>, String>>()?;
    compare_units(&mut found);
    let records: Vec<Record> = found.into_iter().map(|found| found.record).collect();
    let known = stored::results(&bench.workspace.read(TABLE).unwrap_or_default());
    let mut findings = Findings::default();
    for (map, cells) in by_map(&records) {
        let names = |is: &dyn Fn(&Record) -> bool| -> Vec<String> {
            cells.iter().filter(|record| is(record)).map(|record| record.key[1..].join(" ")).collect()
        };
        let worse = names(&|record| known.get(&record.key).is_some_and(|word| record.word > *word));
        let silent = names(&|record| record.word == Word::Silent);
        let unexplained = names(&|record| record.word == Word::Named && reasons::of(record).is_none());
        for (quantity, cells) in [
            ("silent failures", silent),
            ("cells that are worse than stored", worse),
            ("named errors without an explanation", unexplained),
        ] {
            let check = Check::new(&format!("map {map}"), quantity, cells.len() as f64, Bound::AtMost(0.0));
            findings.checks.push(check.noted(cells.join("; ")));
        }
    }
    findings.sections.push(section(&records));
    if !bench.quick {
        publish(bench, &records)?;
    }
    Ok(findings)
}

/// The cells of quick mode.
fn some(cases: Vec<Case>) -> Vec<Case> {
    let mut rows: Vec<Vec<Case>> = Vec::new();
    for case in cases {
        match rows.last_mut() {
            Some(row) if row[0].map == case.map && row[0].axis == case.axis => row.push(case),
            _ => rows.push(vec![case]),
        }
    }
    let chosen = rows.into_iter().step_by(EVERY);
    chosen
        .flat_map(|mut row| {
            let last_but_one = row.len().saturating_sub(2);
            // Other units are held against the first cell.
            let first = (row[0].units.is_some() && last_but_one > 0).then(|| row.remove(0));
            let rest = row.into_iter().filter(move |case| case.column == last_but_one);
            first.into_iter().chain(rest).collect::<Vec<_>>()
        })
        .collect()
}

/// Holds scenes in other units against the first cell of their row.
fn compare_units(found: &mut [Found]) {
    let mut base: Vec<f64> = Vec::new();
    for found in found.iter_mut() {
        if found.record.column == 0 {
            base.clone_from(&found.probes);
        } else {
            cell::compare(found, &base);
        }
    }
}

/// Records by map, in their order.
fn by_map(records: &[Record]) -> Vec<(&str, Vec<&Record>)> {
    let mut maps: Vec<(&str, Vec<&Record>)> = Vec::new();
    for record in records {
        let map = record.key[0].as_str();
        match maps.iter_mut().find(|(known, _)| *known == map) {
            Some((_, cells)) => cells.push(record),
            None => maps.push((map, vec![record])),
        }
    }
    maps
}

/// Number of cells of each word.
fn counts(cells: &[&Record]) -> [usize; WORDS.len()] {
    let mut counts = [0; WORDS.len()];
    cells.iter().for_each(|record| counts[record.word as usize] += 1);
    counts
}

/// The picture of a map: rows are axes, the first one at the top.
fn picture(map: &str, cells: &[&Record]) -> String {
    let mut axes: Vec<&str> = Vec::new();
    for record in cells {
        if !axes.contains(&record.key[1].as_str()) {
            axes.push(&record.key[1]);
        }
    }
    axes.reverse();
    let columns = cells.iter().map(|record| record.column + 1).max().unwrap_or(0);
    let row = |axis: &&str| {
        let mut row = vec![Cell::default(); columns];
        for record in cells.iter().filter(|record| record.key[1] == **axis) {
            row[record.column] = Cell { category: Some(record.word as usize), text: record.key[2].clone() };
        }
        row
    };
    let cells: Vec<Vec<Cell>> = axes.iter().map(row).collect();
    let labels = Labels { title: map, x: "place on the axis, values in the cells", y: "" };
    let names: Vec<String> = axes.iter().map(|axis| (*axis).to_owned()).collect();
    let places: Vec<String> = (1..=columns).map(|place| place.to_string()).collect();
    plot::map(labels, &places, &names, &WORDS, &cells)
}

fn section(records: &[Record]) -> ReportSection {
    let maps = by_map(records);
    let rows = maps.iter().map(|(map, cells)| {
        std::iter::once((*map).to_owned()).chain(counts(cells).map(|count| count.to_string())).collect()
    });
    ReportSection {
        title: "Stability maps".into(),
        reading: "Each cell is a run of a few elements with a closed form. Right: the closed form holds and the watch calls the run sound; doubtful: the watch says so; named error: the run ends with one, or with the verdict wrong; silent: the watch calls the run sound and the closed form does not hold.".into(),
        figures: maps.iter().map(|(map, cells)| picture(map, cells)).collect(),
        tables: vec![Grid {
            caption: format!("{} cells", records.len()),
            head: std::iter::once("map").chain(WORDS).map(str::to_owned).collect(),
            rows: rows.collect(),
        }],
    }
}

/// Writes table, pictures and summary.
fn publish(bench: &Bench, records: &[Record]) -> Outcome<()> {
    let path = |file: &str| bench.workspace.path(file);
    write(&path(TABLE), &stored::write(records))?;
    for (map, cells) in by_map(records) {
        write(&path(&format!("{PICTURES}/{}.svg", file(map))), &picture(map, &cells))?;
    }
    let page = bench.workspace.read(DOCUMENT)?;
    write(&path(DOCUMENT), &with_summary(&page, &summary(records))?)
}

/// Name of the picture of a map.
fn file(map: &str) -> String {
    map.replace(' ', "-")
}

/// A page with another text between the marks.
fn with_summary(page: &str, summary: &str) -> Outcome<String> {
    let [begin, end] = MARKS;
    let missing = || format!("{DOCUMENT} has not the lines {begin:?} and {end:?}");
    let (before, rest) = page.split_once(begin).ok_or_else(missing)?;
    let (_, after) = rest.split_once(end).ok_or_else(missing)?;
    Ok(format!("{before}{begin}\n\n{summary}\n{end}{after}"))
}

/// Numbers of cells, and the named errors with their regions.
fn summary(records: &[Record]) -> String {
    let mut text = format!("| map | {} |\n|---|{}\n", WORDS.join(" | "), "---|".repeat(WORDS.len()));
    // cannot fail: writing to a String.
    for (map, cells) in by_map(records) {
        let numbers = counts(&cells).map(|count| count.to_string()).join(" | ");
        let _ = writeln!(text, "| [{map}](stability/{}.svg) | {numbers} |", file(map));
    }
    let all: Vec<&Record> = records.iter().collect();
    let _ = writeln!(text, "| all {} | {} |", records.len(), counts(&all).map(|count| count.to_string()).join(" | "));
    text += "\nRuns that end with an error, or with the verdict wrong:\n\n| map | axis | values | error or finding | why |\n|---|---|---|---|---|\n";
    for (map, cells) in by_map(records) {
        let mut rows: Vec<(&Record, Vec<&str>)> = Vec::new();
        for record in cells.into_iter().filter(|record| record.word == Word::Named) {
            match rows.iter_mut().find(|(first, _)| first.key[1] == record.key[1] && said(first) == said(record)) {
                Some((_, values)) => values.push(&record.key[2]),
                None => rows.push((record, vec![&record.key[2]])),
            }
        }
        for (first, values) in rows {
            let why = reasons::of(first).unwrap_or("not explained");
            let _ = writeln!(text, "| {map} | {} | {} | {} | {why} |", first.key[1], values.join(", "), said(first));
        }
    }
    text
}

/// The error of a run, or the findings for which its verdict is wrong.
fn said(record: &Record) -> &str {
    if record.error.is_empty() { &record.findings } else { &record.error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_takes_the_place_between_the_marks() {
        let [begin, end] = MARKS;
        let page = format!("a\n{begin}\nold\n{end}\nb\n");
        assert_eq!(with_summary(&page, "new\n").unwrap(), format!("a\n{begin}\n\nnew\n\n{end}\nb\n"));
        assert!(with_summary("a\nb\n", "new").is_err());
    }

    #[test]
    fn quick_mode_takes_one_cell_of_a_row_and_the_base_of_units() {
        let cases = some(axes::cases());
        let of = |map: &str, axis: &str| -> Vec<&str> {
            cases.iter().filter(|case| case.map == map && case.axis == axis).map(|case| case.value.as_str()).collect()
        };
        let rows: std::collections::BTreeSet<(&str, &str)> = cases.iter().map(|c| (c.map, c.axis.as_str())).collect();
        for (map, axis) in rows {
            let values = of(map, axis);
            let expected = if axis.ends_with("units") { ["1", values[1]].to_vec() } else { vec![values[0]] };
            assert_eq!(values, expected, "{map} {axis}");
        }
    }

    #[test]
    fn the_document_has_the_marks() {
        let page = crate::workspace::Workspace::find().unwrap().read(DOCUMENT).unwrap();
        assert!(MARKS.iter().all(|mark| page.matches(mark).count() == 1));
    }
}
