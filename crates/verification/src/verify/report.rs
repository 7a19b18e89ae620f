//! The results as a table in the terminal, as `report.html` and as `report.json`.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::Serialize;

use super::check::{Check, CheckRecord, OK, REPORTED, SHORT, number};
use super::origin::Origin;
use super::{Findings, Suite};
use crate::workspace::Outcome;

/// A part of the report.
#[derive(Debug, Default)]
pub struct ReportSection {
    /// Heading.
    pub title: String,
    /// What it shows, how to read it and its source; empty if the tables' captions say it.
    pub reading: String,
    /// SVG texts, shown side by side.
    pub figures: Vec<String>,
    /// Tables.
    pub tables: Vec<Grid>,
}

/// A table of words.
#[derive(Debug, Default)]
pub struct Grid {
    /// What it shows.
    pub caption: String,
    /// Column heads.
    pub head: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

type Results<'a> = [(&'a dyn Suite, Findings)];

/// The table of all checks for the terminal.
pub fn text(results: &Results) -> String {
    let mut rows = vec![["scene", "quantity", "measured", "bound", "verdict", "note"].map(str::to_owned)];
    rows.extend(results.iter().flat_map(|(_, findings)| &findings.checks).map(row));
    let mut widths = [0; 6];
    for row in &rows {
        for (width, entry) in widths.iter_mut().zip(row) {
            *width = (*width).max(entry.chars().count());
        }
    }
    let line = |row: &[String; 6]| {
        let padded: Vec<String> = row.iter().zip(widths).map(|(entry, width)| format!("{entry:width$}")).collect();
        format!("{}\n", padded.join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

fn row(check: &Check) -> [String; 6] {
    [
        check.scene.clone(),
        check.quantity.clone(),
        number(check.measured),
        check.bound.text(),
        check.verdict().to_owned(),
        check.note.clone(),
    ]
}

/// All checks as data.
pub fn json(results: &Results, quick: bool, origin: &Origin) -> Outcome<String> {
    #[derive(Serialize)]
    struct Report<'a> {
        origin: &'a Origin,
        quick: bool,
        passed: bool,
        checks: Vec<CheckRecord<'a>>,
    }
    let checks = results.iter().flat_map(|(suite, found)| found.checks.iter().map(|check| (suite.name(), check)));
    let report = Report {
        origin,
        quick,
        passed: checks.clone().all(|(_, check)| check.holds()),
        checks: checks.map(|(suite, check)| CheckRecord::new(suite, check)).collect(),
    };
    Ok(serde_json::to_string_pretty(&report)? + "\n")
}

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;max-width:1340px;margin:2em auto;padding:0 1em;color:#222}\
table{border-collapse:collapse;margin:1em 0}td,th{padding:.2em .8em;text-align:left;border-bottom:1px solid #ddd}\
td.n{font-variant-numeric:tabular-nums;text-align:right}.short{background:#fbdcd4}caption{text-align:left;color:#666}\
.figures{display:flex;flex-wrap:wrap;gap:12px}svg{max-width:100%;height:auto}";

/// The report; one file without references to others.
pub fn html(results: &Results, quick: bool, origin: &Origin) -> String {
    let short = results.iter().flat_map(|(_, findings)| &findings.checks).filter(|check| !check.holds()).count();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                title { "Stoss: verification" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Verification" }
                p {
                    @if short == 0 { "Every check holds." } @else { b { (short) " checks fall short." } }
                    @if quick { " Quick mode: long scenes are shortened." }
                }
                p { (origin.line()) }
                (summary(results))
                (contents(results))
                @for (suite, findings) in results {
                    h2 id=(suite.name()) { (suite.name()) }
                    p { (suite.about()) }
                    (checks_table(&findings.checks))
                    @for (i, section) in findings.sections.iter().enumerate() {
                        (section_markup(section, &anchor(*suite, i)))
                    }
                }
            }
        }
    };
    page.into_string()
}

/// A row for each suite: what was checked, what fell short, and the check that uses most of its bound.
fn summary(results: &Results) -> Markup {
    html! {
        h2 { "Summary" }
        p {
            "Checks with a bound that hold or fall short, and values that are reported without one. "
            "The part of the bound that is used is 0 for an exact result and 1 at the bound; the check that uses most is named."
        }
        table {
            tr { th { "suite" } th { "hold" } th { "fall short" } th { "reported" } th { "most used" } th { "by" } }
            @for (suite, findings) in results {
                @let count = |word: &str| findings.checks.iter().filter(|check| check.verdict() == word).count();
                @let worst = findings
                    .checks
                    .iter()
                    .filter_map(|check| Some((check, check.bound.used(check.measured)?)))
                    .max_by(|a, b| a.1.total_cmp(&b.1));
                tr class=[(count(SHORT) > 0).then_some("short")] {
                    td { a href={ "#" (suite.name()) } { (suite.name()) } }
                    td.n { (count(OK)) } td.n { (count(SHORT)) } td.n { (count(REPORTED)) }
                    @match worst {
                        Some((check, used)) => { td.n { (format!("{used:.3}")) } td { (check.scene) ": " (check.quantity) } },
                        None => { td {} td {} },
                    }
                }
            }
        }
    }
}

/// Links to the suites and their sections.
fn contents(results: &Results) -> Markup {
    html! {
        h2 { "Contents" }
        ul {
            @for (suite, findings) in results {
                li {
                    a href={ "#" (suite.name()) } { (suite.name()) } ": " (suite.about())
                    @for (i, section) in findings.sections.iter().enumerate() {
                        @if i > 0 { ", " } @else { br; }
                        a href={ "#" (anchor(*suite, i)) } { (section.title) }
                    }
                }
            }
        }
    }
}

/// Anchor of a section.
fn anchor(suite: &dyn Suite, section: usize) -> String {
    format!("{}-{section}", suite.name())
}

fn checks_table(checks: &[Check]) -> Markup {
    html! {
        table {
            tr { th { "scene" } th { "quantity" } th { "measured" } th { "bound" } th { "verdict" } th { "note" } }
            @for check in checks {
                tr class=[(!check.holds()).then_some("short")] {
                    @let [scene, quantity, measured, bound, verdict, note] = row(check);
                    td { (scene) } td { (quantity) } td.n { (measured) } td.n { (bound) } td { (verdict) } td { (note) }
                }
            }
        }
    }
}

fn section_markup(section: &ReportSection, anchor: &str) -> Markup {
    html! {
        h3 id=(anchor) { (section.title) }
        @if !section.reading.is_empty() { p { (section.reading) } }
        @if !section.figures.is_empty() {
            div.figures { @for figure in &section.figures { div { (PreEscaped(figure)) } } }
        }
        @for grid in &section.tables {
            table {
                caption { (grid.caption) }
                tr { @for head in &grid.head { th { (head) } } }
                @for row in &grid.rows { tr { @for entry in row { td.n { (entry) } } } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::Bound;
    use super::super::{Bench, Suite};
    use super::*;

    struct Sample;

    impl Suite for Sample {
        fn name(&self) -> &'static str {
            "sample"
        }
        fn about(&self) -> &'static str {
            "Sample."
        }
        fn measure(&self, _bench: &Bench) -> Outcome<Findings> {
            Ok(Findings::default())
        }
    }

    fn origin() -> Origin {
        Origin { cores: Some(2), ..Origin::default() }
    }

    fn results() -> Vec<(&'static dyn Suite, Findings)> {
        let checks = vec![
            Check::new("a", "drift", 1e-12, Bound::AtMost(1e-10)),
            Check::new("b", "drift <x>", f64::NAN, Bound::AtMost(1e-10)).noted("why"),
        ];
        let section = ReportSection {
            title: "T".into(),
            reading: "R.".into(),
            figures: vec!["<svg></svg>".into()],
            tables: vec![Grid::default()],
        };
        vec![(&Sample, Findings { checks, sections: vec![section], ..Findings::default() })]
    }

    #[test]
    fn a_nan_falls_short_in_all_three_forms() {
        let results = results();
        assert!(text(&results).lines().nth(2).unwrap().contains("FALLS SHORT"));
        let data: serde_json::Value = serde_json::from_str(&json(&results, true, &origin()).unwrap()).unwrap();
        assert_eq!(data["passed"], false);
        assert_eq!(data["origin"]["cores"], 2);
        assert!(data["origin"]["commit"].is_null());
        assert!(data["checks"][1]["measured"].is_null());
        assert_eq!(data["checks"][0]["verdict"], "ok");
        let page = html(&results, false, &origin());
        assert!(page.contains("class=\"short\"") && page.contains("drift &lt;x&gt;") && page.contains("<svg>"));
        assert!(page.contains("2 cores"));
    }

    #[test]
    fn the_report_refers_to_nothing_outside() {
        let page = html(&results(), true, &origin());
        for reference in ["http:", "https:", "src="] {
            assert!(!page.contains(reference), "{reference}");
        }
        assert!(page.split("href=").skip(1).all(|link| link.starts_with("\"#")));
    }

    #[test]
    fn the_summary_names_the_check_that_is_nearest_to_its_bound() {
        let page = html(&results(), true, &origin());
        for entry in ["href=\"#sample\"", "id=\"sample\"", "href=\"#sample-0\"", "id=\"sample-0\"", "<p>R.</p>"] {
            assert!(page.contains(entry), "{entry}");
        }
        // One holds, one falls short, none without a bound.
        assert!(page.contains("<td class=\"n\">1</td><td class=\"n\">1</td><td class=\"n\">0</td>"), "{page}");
        assert!(page.contains("NaN</td><td>b: drift &lt;x&gt;</td>"));
    }
}
