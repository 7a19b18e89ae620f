//! Scenes at the edge of what can be computed, each with several schemes: every one must give the right answer within a stated
//! bound, or a named error with all completed steps kept. What is neither is a verdict with a figure, and
//! `docs/verification/stability.md` has its reason.
//!
//! A case is a [`Case`] in one of the files of `cases`; [`judge`] has the bounds.

mod case;
mod cases;
mod document;
mod evidence;
mod geometry;
mod judge;
mod scene;

use std::collections::BTreeMap;

use super::super::check::{Bound, Check, number};
use super::super::launch::launch;
use super::super::report::{Grid, ReportSection};
use super::super::{Bench, Findings};
use crate::workspace::{Outcome, write};
use case::{Case, Word};
use document::Found;
use judge::{Bases, Verdict};

/// Where scenes and results go, below the folder of `verify`.
const FOLDER: &str = "extremes";

/// Where the reasons are.
const DOCUMENT: &str = "docs/verification/stability.md";

/// Runs all cases, in quick mode one of each family that is marked.
pub fn measure(bench: &Bench) -> Outcome<Findings> {
    let documented = document::rows(&bench.workspace.read(DOCUMENT)?);
    let cases = if bench.quick { cases::representative() } else { cases::all() };
    let mut findings = Findings::default();
    let mut bases = Bases::new();
    let mut found = Vec::new();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut wall, mut rows) = (0.0, Vec::new());
    for case in &cases {
        let launched = launch(bench, FOLDER, &case.slug(), case.scene.text(), &case.files)?;
        wall += launched.run.ending.seconds;
        let verdict = judge::judge(case, launched, &mut bases);
        let outcome = Found {
            case: case.family.clone(),
            combination: case.combination.clone(),
            word: verdict.word,
            figure: verdict.figure,
        };
        let listed = document::listed(&documented, &outcome).is_some();
        *counts.entry(verdict.word.text()).or_default() += 1;
        rows.push(row(case, &verdict));
        findings.checks.push(check(case, &verdict, listed));
        found.push(outcome);
    }
    println!("verify: {} extreme cases in {wall:.1} s", cases.len());
    if !bench.quick {
        let stale = document::stale(&documented, &found);
        let check = Check::new(DOCUMENT, "verdicts that no longer occur", stale.len() as f64, Bound::AtMost(0.0));
        findings.checks.push(check.noted(stale.join("; ")));
        // What the document's table would be now; somebody has to find the reasons.
        write(&bench.folder.join(FOLDER).join("table.md"), &document::proposal(&documented, &found))?;
    }
    let counts = counts.iter().map(|(word, count)| vec![(*word).to_owned(), count.to_string()]).collect();
    findings.sections.push(ReportSection {
        title: "Extreme cases".into(),
            reading: "Every contact method and scheme on stiff, thin, fast and degenerate scenes. A run is accepted if it is exact in what it promises or ends with an error that names the cause; the table of docs/verification/stability.md must not get worse.".into(),
        figures: Vec::new(),
        tables: vec![
            Grid { caption: format!("{} combinations", cases.len()), head: head(&["verdict", "number"]), rows: counts },
            Grid {
                caption: "Every combination".into(),
                head: head(&["case", "combination", "verdict", "figure", "what it is"]),
                rows,
            },
        ],
    });
    Ok(findings)
}

fn head(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

fn row(case: &Case, verdict: &Verdict) -> Vec<String> {
    let Verdict { word, figure, about, .. } = verdict;
    vec![case.family.clone(), case.combination.clone(), word.text().to_owned(), number(*figure), about.clone()]
}

/// A verdict as a check: what is not right must be in the document.
fn check(case: &Case, verdict: &Verdict, listed: bool) -> Check {
    let Verdict { word, figure, bound, about } = verdict;
    let scene = format!("{}: {}", case.family, case.combination);
    if matches!(word, Word::Right) || listed && !matches!(word, Word::Wrong) {
        return Check::new(&scene, word.text(), *figure, *bound).noted(about.clone());
    }
    let note = match word {
        Word::Wrong => about.clone(),
        _ => format!("{} ({about}); {DOCUMENT} does not say why", number(*figure)),
    };
    Check::new(&scene, word.text(), f64::NAN, Bound::AtMost(0.0)).noted(note)
}
