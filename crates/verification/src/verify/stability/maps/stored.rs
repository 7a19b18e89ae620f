//! The stored table of the maps: `docs/verification/stability-maps.csv`.

use super::cell::{Record, WORDS, Word};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Columns of the table.
const HEAD: &str = "map,axis,value,result,exit,verdict,findings,steps,cuts,iterations,energy,check,off,bound,error";

/// The table of records.
pub fn write(records: &[Record]) -> String {
    let mut text = format!("{HEAD}\n");
    for record in records {
        let [map, axis, value] = &record.key;
        let exit = record.exit.map_or_else(|| "none".into(), |code| code.to_string());
        let energy = record.energy.map(figure).unwrap_or_default();
        let [of, off, bound] = match &record.worst {
            Some(worst) => [worst.of.to_owned(), figure(worst.size), figure(worst.bound)],
            None => Default::default(),
        };
        // cannot fail: writing to a String.
        let _ = writeln!(
            text,
            "{map},{},{value},{},{exit},{},{},{},{},{:.2},{energy},{of},{off},{bound},{}",
            axis.replace(',', ";"),
            record.word.text().replace(',', ";"),
            record.verdict,
            record.findings,
            record.steps,
            record.cuts,
            record.iterations,
            record.error
        );
    }
    text
}

/// Two digits; what is round-off, which machines do not share, is a bound.
fn figure(value: f64) -> String {
    if value.abs() < 1e-10 { "<1e-10".into() } else { format!("{value:.1e}") }
}

/// Results by map, axis and value.
pub fn results(text: &str) -> BTreeMap<[String; 3], Word> {
    const ALL: [Word; 5] = [Word::Right, Word::Cuts, Word::Doubtful, Word::Named, Word::Silent];
    let rows = text.lines().skip(1).filter_map(|line| {
        let mut cells = line.split(',');
        let [map, axis, value, result] = [cells.next()?, cells.next()?, cells.next()?, cells.next()?];
        let place = WORDS.iter().position(|word| word.replace(',', ";") == result)?;
        Some(([map.to_owned(), axis.replace(';', ","), value.to_owned()], ALL[place]))
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::super::case::Deviation;
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let worst = Some(Deviation { of: "force", size: 0.0123, bound: 0.05 });
        let record = Record {
            key: ["nts", "statics: Poisson's ratio, mixed", "0.3"].map(str::to_owned),
            column: 1,
            word: Word::Cuts,
            exit: Some(0),
            verdict: "sound".into(),
            findings: String::new(),
            steps: 12,
            cuts: 3,
            iterations: 2.345,
            energy: Some(1e-14),
            worst,
            error: String::new(),
        };
        let text = write(std::slice::from_ref(&record));
        assert!(text.ends_with(",0,sound,,12,3,2.35,<1e-10,force,1.2e-2,5.0e-2,\n"), "{text}");
        assert_eq!(results(&text), BTreeMap::from([(record.key, Word::Cuts)]));
    }
}
