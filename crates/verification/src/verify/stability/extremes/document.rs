//! `docs/verification/stability.md` must list every verdict other than "right", with its reason.

use super::super::super::check::number;
use super::case::Word;

/// The columns of the table.
const HEAD: [&str; 4] = ["case", "combinations", "verdict", "reason"];

/// A row of the document.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    case: String,
    combinations: Vec<String>,
    verdict: String,
    reason: String,
}

/// What became of one combination.
#[derive(Clone, Debug)]
pub struct Found {
    /// The extreme.
    pub case: String,
    /// What is combined with it.
    pub combination: String,
    /// The verdict.
    pub word: Word,
    /// Its figure.
    pub figure: f64,
}

/// All rows, with a reason, of the tables with the columns case, combinations, verdict, reason.
pub fn rows(text: &str) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        if !line.trim_start().starts_with('|') {
            inside = false;
        } else if cells == HEAD {
            inside = true;
        } else if let (true, [case, combinations, verdict, reason]) = (inside, &cells[..])
            && !case.starts_with('-')
            && !reason.is_empty()
        {
            rows.push(Row {
                case: (*case).to_owned(),
                combinations: combinations.split(',').map(|name| name.trim().to_owned()).collect(),
                verdict: (*verdict).to_owned(),
                reason: (*reason).to_owned(),
            });
        }
    }
    rows
}

/// The row that gives this combination this verdict.
pub fn listed<'a>(rows: &'a [Row], found: &Found) -> Option<&'a Row> {
    rows.iter().find(|row| row.combinations.contains(&found.combination) && row.tells(found))
}

impl Row {
    /// True if case and verdict are these.
    fn tells(&self, found: &Found) -> bool {
        self.case == found.case && self.verdict.starts_with(found.word.text())
    }
}

/// What the document says, but what did not turn out so.
pub fn stale(rows: &[Row], found: &[Found]) -> Vec<String> {
    let mut stale = Vec::new();
    for row in rows {
        for name in &row.combinations {
            if !found.iter().any(|found| found.combination == *name && row.tells(found)) {
                stale.push(format!("{}: {name} {}", row.case, row.verdict));
            }
        }
    }
    stale
}

/// The table as it would be now, with the reasons that are known.
pub fn proposal(rows: &[Row], found: &[Found]) -> String {
    let mut groups: Vec<(&Found, &str, Vec<&Found>)> = Vec::new();
    for entry in found.iter().filter(|found| found.word != Word::Right) {
        let reason = listed(rows, entry).map_or("", |row| row.reason.as_str());
        match groups
            .iter_mut()
            .find(|(first, because, _)| first.case == entry.case && first.word == entry.word && *because == reason)
        {
            Some((_, _, members)) => members.push(entry),
            None => groups.push((entry, reason, vec![entry])),
        }
    }
    let mut text = format!("| {} |\n|---|---|---|---|\n", HEAD.join(" | "));
    for (first, reason, members) in groups {
        let names: Vec<&str> = members.iter().map(|found| found.combination.as_str()).collect();
        let figures = members.iter().map(|found| found.figure);
        let least = number(figures.clone().fold(f64::INFINITY, f64::min));
        let largest = number(figures.fold(f64::NEG_INFINITY, f64::max));
        let range = if least == largest { least } else { format!("{least} to {largest}") };
        text += &format!("| {} | {} | {} {range} | {reason} |\n", first.case, names.join(", "), first.word.text());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# T\n\n| a | b |\n|---|---|\n| x | y |\n\n| case | combinations | verdict | reason |\n|---|---|---|---|\n\
                        | gap 0 | midpoint, trapezoidal | dissipates 0.16 | closing |\n| jump | midpoint | named error 3 | why |\n\
                        | jump | trapezoidal | drifts | |\n";

    fn found(case: &str, combination: &str, word: Word) -> Found {
        Found { case: case.into(), combination: combination.into(), word, figure: 0.5 }
    }

    #[test]
    fn rows_with_a_reason_count() {
        let rows = rows(TEXT);
        assert_eq!(rows.len(), 2);
        let lists = |case, combination, word| listed(&rows, &found(case, combination, word)).is_some();
        assert!(lists("gap 0", "trapezoidal", Word::Dissipates));
        assert!(!lists("gap 0", "trapezoidal", Word::GainsEnergy));
        assert!(!lists("jump", "trapezoidal", Word::Drifts), "no reason is given");
        assert!(!lists("gap 1", "midpoint", Word::Dissipates));
    }

    #[test]
    fn a_verdict_that_no_longer_occurs_is_stale() {
        let all = |word| {
            let gap = |name: &str| found("gap 0", name, Word::Dissipates);
            [gap("midpoint"), gap("trapezoidal"), found("jump", "midpoint", word)]
        };
        assert!(stale(&rows(TEXT), &all(Word::NamedError)).is_empty());
        assert_eq!(stale(&rows(TEXT), &all(Word::Right)), ["jump: midpoint named error 3"]);
    }

    #[test]
    fn a_proposal_keeps_reasons_and_leaves_out_what_is_right() {
        let all = [
            found("gap 0", "midpoint", Word::Dissipates),
            Found { figure: 0.25, ..found("gap 0", "trapezoidal", Word::Dissipates) },
            found("gap 0", "backward-euler", Word::Dissipates),
            found("jump", "midpoint", Word::Right),
        ];
        let text = proposal(&rows(TEXT), &all);
        assert!(text.contains("| gap 0 | midpoint, trapezoidal | dissipates 0.2500 to 0.5000 | closing |"), "{text}");
        assert!(text.contains("| gap 0 | backward-euler | dissipates 0.5000 |  |") && !text.contains("jump"), "{text}");
    }
}
