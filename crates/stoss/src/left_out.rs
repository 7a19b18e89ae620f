//! What a deck has and the scene that was imported from it has not (`[[left_out]]`), in warnings and in the verdict.
//!
//! The watch sees what is computed, so that it finds nothing where a load is missing. Here is the one finding that says so, and the one place where it joins those of the watch.

use crate::scene::{LeftOut, Omission, Scene};
use stoss_watch::{Finding, FindingKind, Severity, Verdict};

/// Entries that the sentence of the finding repeats; more are counted.
const REPEATED: usize = 3;

fn of(scene: &Scene, severity: Omission) -> impl Iterator<Item = &LeftOut> {
    scene.left_out.iter().filter(move |entry| entry.severity == severity)
}

/// What a run is warned of: what is missing, then what is another law or setting.
pub(crate) fn warnings(scene: &Scene) -> Vec<String> {
    let missing = of(scene, Omission::Missing).map(|entry| format!("missing: {entry}"));
    missing.chain(of(scene, Omission::Changed).map(|entry| format!("not as in the deck: {entry}"))).collect()
}

/// What has no influence, for the plan of a run.
pub(crate) fn notes(scene: &Scene) -> Vec<String> {
    of(scene, Omission::Note).map(|entry| format!("note: {entry}")).collect()
}

/// Number of loads, supports, constraints, contacts and parts that are missing.
pub(crate) fn count(scene: &Scene) -> usize {
    of(scene, Omission::Missing).count()
}

/// The finding that something is missing; none if nothing is.
pub(crate) fn finding(scene: &Scene) -> Option<Finding> {
    let number = count(scene);
    if number == 0 {
        return None;
    }
    let words: Vec<String> = of(scene, Omission::Missing).take(REPEATED).map(ToString::to_string).collect();
    let more = match number.saturating_sub(REPEATED) {
        0 => String::new(),
        more => format!("; and {more} more in [[left_out]]"),
    };
    let sentence = format!(
        "the scene lacks what its deck has: {}{more}. Add it to the scene, then remove its entry of [[left_out]]",
        words.join("; ")
    );
    Some(Finding {
        level: Severity::Doubtful,
        kind: FindingKind::LeftOut,
        bodies: None,
        step: 0,
        time: 0.0,
        worst_time: None,
        sentence,
        position: None,
        figure: number as f64,
    })
}

/// The verdict of the watch together with what is missing, the worst first.
pub(crate) fn with(verdict: Verdict, missing: Option<&Finding>) -> Verdict {
    let Verdict { mut level, mut reasons } = verdict;
    if let Some(missing) = missing {
        level = level.max(missing.level);
        let place = reasons.partition_point(|found| found.level >= missing.level);
        reasons.insert(place, missing.clone());
    }
    Verdict { level, reasons }
}

/// The verdict of the watch alone: what happened in the run, for which a cause is looked for.
pub(crate) fn without(verdict: &Verdict) -> Verdict {
    let reasons: Vec<Finding> =
        verdict.reasons.iter().filter(|found| found.kind != FindingKind::LeftOut).cloned().collect();
    Verdict { level: reasons.first().map_or(Severity::Sound, |worst| worst.level), reasons }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(entries: &str) -> Scene {
        let text = format!(
            "[scene]\ntitle = \"t\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n[[body]]\nname = \"b\"\n\
             mesh = {{ generator = \"block\", size = [1, 1, 1], divisions = [1, 1, 1] }}\n\
             material = {{ law = \"neo-hooke\", young = 1.0, poisson = 0.3 }}\n{entries}"
        );
        crate::scene::parse(&text, "t.toml").unwrap_or_else(|errors| panic!("{errors}"))
    }

    fn entry(severity: &str, keyword: &str) -> String {
        format!(
            "[[left_out]]\nseverity = \"{severity}\"\nkeyword = \"{keyword}\"\nline = \"a.inp:7\"\ntext = \"it does not act\"\n"
        )
    }

    /// Only what is missing makes a verdict doubtful; a worse finding of the watch stays before it.
    #[test]
    fn what_is_missing_joins_the_verdict() {
        let harmless = scene(&(entry("changed", "*PLASTIC") + &entry("note", "*CONTROLS")));
        assert_eq!(finding(&harmless), None);
        assert_eq!(warnings(&harmless), ["not as in the deck: *PLASTIC (a.inp:7): it does not act"]);
        assert_eq!(notes(&harmless), ["note: *CONTROLS (a.inp:7): it does not act"]);
        assert_eq!(with(Verdict::default(), None), Verdict::default());

        let all: String = ["*CLOAD", "*MPC", "*SPRING", "*GAP"].map(|keyword| entry("missing", keyword)).concat();
        let missing = finding(&scene(&all)).unwrap();
        assert!(missing.sentence.contains("*CLOAD (a.inp:7): it does not act; *MPC"), "{}", missing.sentence);
        assert!(missing.sentence.contains("and 1 more in [[left_out]]"), "{}", missing.sentence);
        let verdict = with(Verdict::default(), Some(&missing));
        assert_eq!((verdict.level, verdict.reasons.len()), (Severity::Doubtful, 1));
        assert_eq!(without(&verdict), Verdict::default());

        let wrong = Finding { level: Severity::Wrong, kind: FindingKind::Balance, ..missing.clone() };
        let watched = Verdict { level: Severity::Wrong, reasons: vec![wrong] };
        let verdict = with(watched.clone(), Some(&missing));
        assert_eq!(verdict.level, Severity::Wrong);
        assert_eq!(
            verdict.reasons.iter().map(|found| found.kind).collect::<Vec<_>>(),
            [FindingKind::Balance, FindingKind::LeftOut]
        );
        assert_eq!(without(&verdict), watched);
    }
}
