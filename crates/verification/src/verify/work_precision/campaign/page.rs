//! The page of the campaign with its diagrams, and the table of the guide: all drawn from the stored results.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::front::{TARGETS, cheapest, finished, front, seconds, words};
use super::lines::{Axis, Line, lines};
use super::order::order;
use super::peers::{self, Peer};
use super::points;
use super::problem::{Problem, Reference};
use super::record::{Figures, Record, Records};
use super::stored::{HOME, Store};
use crate::plot::{self, Labels, Series};
use crate::workspace::{Outcome, read, write};

/// The page of the guide with the table of the cheapest choices.
const GUIDE: &str = "docs/guide/which-method.md";

/// Where that table begins and ends.
const MARKS: [&str; 2] = ["<!-- cheapest: begin -->", "<!-- cheapest: end -->"];

const HEAD: &str = "# Error against run time

    cargo xtask verify work-precision

runs everything again and writes this folder and the table of [which method](../../guide/which-method.md). Nothing here is written by hand. `cargo xtask verify --quick work-precision` repeats the coarsest
runs of each problem: an order that falls by 0.3, an error or a number of iterations that grows by 30 % falls short.

Each problem has a choice that the others are varied from. The full product of schemes and contact methods is run; cells, meshes, steps, solvers and tolerances are varied alone. Errors are relative, `|a - b| / |b|`
over all values of a quantity. CPU seconds are those of a whole run of the program with one thread, two runs side by side on two shared cores: differences below a quarter say nothing. Memory is the peak of the
process in MB. Orders are slopes by least squares of the logarithms of the four finest runs, with their 95 % interval; errors below three times that of the reference are left out of them. A run is on the front if no other one has a smaller error in
its time; runs that the watch does not call sound are on none, and are listed. A cheapest run is named where the target is at least three times the reference's own error. The iterative solver factorises systems of fewer than 1000
equations: such runs stand in the tables of orders alone.
";

/// Paths from the root of the repository, and texts. Problems that were never run are left out.
pub fn all(store: &Store, problems: &[&Problem]) -> Outcome<Vec<(String, String)>> {
    let mut stored = Vec::new();
    for problem in problems {
        if store.file(&format!("{HOME}/{}.csv", problem.name)).exists() {
            stored.push((*problem, store.records(problem)?));
        }
    }
    let mut files = Vec::new();
    let mut page = HEAD.to_owned();
    page.push_str("\n| problem | runs | cheapest for 10 % | 1 % | 0.1 % |\n|---|---|---|---|---|\n");
    for (problem, records) in &stored {
        let targets = TARGETS.map(|target| cheapest(records, target).map_or_else(|| "-".into(), figure)).join(" | ");
        let _ = writeln!(
            page,
            "| [{}](#{}) | {} | {targets} |",
            problem.title,
            anchor(problem.title),
            finished(records).count()
        );
    }
    let peers = store.peers()?;
    for (problem, records) in &stored {
        let own: Vec<&Peer> = peers.iter().filter(|peer| peer.problem == problem.name).collect();
        page.push_str(&section(problem, records));
        page.push_str(&peers::table(&own, problem.quantities[0]));
        for (end, chart) in charts(problem, records, &own) {
            files.push((format!("{HOME}/{}-{end}.svg", problem.name), chart));
        }
    }
    files.push((format!("{HOME}/README.md"), page));
    let guide = read(&store.file(GUIDE))?;
    if let Some(text) = between(&guide, &guide_table(&stored)) {
        files.push((GUIDE.to_owned(), text));
    }
    Ok(files)
}

/// Writes them.
pub fn write_all(store: &Store, problems: &[&Problem]) -> Outcome<()> {
    all(store, problems)?.iter().try_for_each(|(name, text)| write(&store.file(name), text))
}

/// The guide with another table between the marks; `None` without marks.
fn between(guide: &str, table: &str) -> Option<String> {
    let (before, rest) = guide.split_once(MARKS[0])?;
    let (_, after) = rest.split_once(MARKS[1])?;
    Some(format!("{before}{}\n{table}{}{after}", MARKS[0], MARKS[1]))
}

/// The anchor that a heading has.
fn anchor(title: &str) -> String {
    let kept = title
        .to_lowercase()
        .chars()
        .filter(|c| c.is_ascii_alphanumeric() || *c == ' ' || *c == '-')
        .collect::<String>();
    kept.replace(' ', "-")
}

fn figure((_, figures): (&Record, &Figures)) -> String {
    format!("{} ({:.1e})", seconds(figures.cpu_seconds), figures.errors[0])
}

/// A row for each problem: the cheapest choice for each error.
fn guide_table(stored: &[(&Problem, Records)]) -> String {
    let mut text = "| problem, error of | 10 % | 1 % | 0.1 % |\n|---|---|---|---|\n".to_owned();
    for (problem, records) in stored {
        let cell = |target| {
            cheapest(records, target)
                .map_or_else(|| "-".to_owned(), |found| format!("{}: {}", words(problem, found.0), figure(found)))
        };
        let cells = TARGETS.map(cell).join(" | ");
        let _ = writeln!(
            text,
            "| [{}](../verification/work-precision/README.md#{}), {} | {cells} |",
            problem.title,
            anchor(problem.title),
            problem.quantities[0]
        );
    }
    text
}

fn section(problem: &Problem, records: &Records) -> String {
    let mut text = format!("\n## {}\n\n{}\n\n", problem.title, problem.about);
    let own = |k: usize| format!("{:.1e}", records.reference_errors[k]);
    match problem.reference {
        Reference::Closed { source, .. } => {
            let _ = writeln!(text, "Reference: {source}.");
        }
        Reference::Converged { by, .. } => {
            let errors: Vec<String> =
                problem.quantities.iter().enumerate().map(|(k, name)| format!("{name} {}", own(k))).collect();
            let choice = [by.scheme, by.method, by.cell].join(", ");
            let _ = writeln!(
                text,
                "Reference: a run with {choice}, {} elements, {} steps; its own error: {}.",
                by.mesh,
                by.steps,
                errors.join(", ")
            );
        }
    }
    let best = problem.best;
    let _ = writeln!(
        text,
        "Varied from: {}, {}, {}, {} elements, {} steps, {}, tolerance {:e}.\n",
        best.scheme, best.method, best.cell, best.mesh, best.steps, best.solver, best.tolerance
    );
    let _ =
        writeln!(text, "![error against CPU seconds]({0}-work.svg) ![errors over sizes]({0}-size.svg)\n", problem.name);
    text.push_str(&front_table(problem, records));
    text.push_str(&order_table(problem, records));
    text.push_str(&not_run(records));
    text
}

fn front_table(problem: &Problem, records: &Records) -> String {
    let mut text = format!(
        "Front (first: {}):\n\n| choice | {} | CPU | MB | iterations | unknowns |\n",
        problem.quantities[0],
        problem.quantities.join(" | ")
    );
    let _ = writeln!(text, "|{}", "---|".repeat(problem.quantities.len() + 5));
    for (record, figures) in front(records) {
        let errors: Vec<String> = figures.errors.iter().map(|error| format!("{error:.1e}")).collect();
        let Figures { cpu_seconds, memory, iterations, unknowns, .. } = figures;
        let _ = writeln!(
            text,
            "| {} | {} | {} | {memory:.0} | {iterations} | {unknowns} |",
            words(problem, record),
            errors.join(" | "),
            seconds(*cpu_seconds)
        );
    }
    text
}

fn order_table(problem: &Problem, records: &Records) -> String {
    let heads: Vec<String> = problem.quantities.iter().map(|name| format!("order of {name} | errors")).collect();
    let mut text = format!(
        "\n| line | over | {} | CPU, finest |\n|{}\n",
        heads.join(" | "),
        "---|".repeat(2 * problem.quantities.len() + 3)
    );
    for line in lines(problem) {
        let found: Vec<&Figures> = line.choices.iter().filter_map(|choice| records.figures(choice)).collect();
        let Some(last) = found.last() else { continue };
        let cells: Vec<String> = (0..problem.quantities.len())
            .map(|k| {
                let order = match line.axis {
                    Axis::Tolerance => "-".to_owned(),
                    _ => order(&points(records, &line, k)).map_or_else(|| "-".into(), |order| order.text()),
                };
                let errors: Vec<String> = found.iter().map(|figures| format!("{:.1e}", figures.errors[k])).collect();
                format!("{order} | {}", errors.join(", "))
            })
            .collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} |",
            line.name,
            line.axis.name(),
            cells.join(" | "),
            seconds(last.cpu_seconds)
        );
    }
    text
}

/// What has no figures, a reason a line, and what the watch does not call sound.
fn not_run(records: &Records) -> String {
    let mut reasons: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for row in &records.rows {
        let name = row.choice[..5].join(" ");
        match &row.result {
            Err(reason) => reasons.entry(reason.clone()).or_default().push(name),
            Ok(figures) if figures.verdict != "sound" => {
                reasons.entry(format!("verdict: {}", figures.verdict)).or_default().push(name)
            }
            Ok(_) => {}
        }
    }
    let mut text = String::new();
    for (reason, names) in reasons {
        let more = if names.len() > 6 { format!(" and {} more", names.len() - 6) } else { String::new() };
        let _ = writeln!(text, "\n- {reason}: {}{more}", names[..names.len().min(6)].join("; "));
    }
    text
}

/// Error against CPU time, and over the sizes of that axis along which most lines go.
fn charts(problem: &Problem, records: &Records, peers: &[&Peer]) -> [(&'static str, String); 2] {
    let lines: Vec<Line> = lines(problem).into_iter().filter(|line| line.axis != Axis::Tolerance).collect();
    let count = |axis| lines.iter().filter(|line| line.axis == axis).count();
    let axis = if count(Axis::Steps) > count(Axis::Mesh) { Axis::Steps } else { Axis::Mesh };
    let series = |lines: &mut dyn Iterator<Item = &Line>, x: &dyn Fn(&super::Choice, &Figures) -> f64| -> Vec<Series> {
        lines
            .map(|line| Series {
                name: line.name.clone(),
                points: line
                    .choices
                    .iter()
                    .filter_map(|choice| records.figures(choice).map(|figures| (x(choice, figures), figures.errors[0])))
                    .collect(),
            })
            // A line without runs has no place in the legend.
            .filter(|series: &Series| !series.points.is_empty())
            .collect()
    };
    let y = format!("error of {}", problem.quantities[0]);
    let labels = |x| Labels { title: problem.title, x, y: &y };
    let mut work = series(&mut lines.iter(), &|_, figures| figures.cpu_seconds);
    work.extend(peers::series(peers));
    let over = series(&mut lines.iter().filter(|line| line.axis == axis), &|choice, _| axis.size(choice));
    let x = if axis == Axis::Steps { "one over the number of steps" } else { "one over the number of elements" };
    [
        ("work", plot::log_log(labels("CPU seconds"), &work, Some(1e-13), &[-1.0, -2.0])),
        ("size", plot::log_log(labels(x), &over, Some(1e-13), &[1.0, 2.0])),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_stands_between_its_marks() {
        let guide = format!("a\n{}\nold\n{}\nb", MARKS[0], MARKS[1]);
        assert_eq!(between(&guide, "new\n").unwrap(), format!("a\n{}\nnew\n{}\nb", MARKS[0], MARKS[1]));
        assert_eq!(between("a", "new"), None);
        assert_eq!(anchor("Hertz's line, 2 x 3"), "hertzs-line-2-x-3");
    }
}
