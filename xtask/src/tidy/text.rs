//! Rules for every text file: line ends, blanks, places that only exist on somebody's machine.

use super::Violation;

/// Files whose bytes are ours to keep tidy; test data may need odd bytes.
fn is_ours(file: &str) -> bool {
    let kinds = [".rs", ".toml", ".md", ".json", ".sh", ".txt", ".svg"];
    (kinds.iter().any(|kind| file.ends_with(kind)) || file.starts_with(".ci/"))
        && !file.contains("/data/")
        && !file.contains("proptest-regressions")
}

/// Absolute places. Written in halves, so that this file does not name them.
const PLACES: [&str; 4] = [concat!("/wo", "rk/"), concat!("/ro", "ot/"), concat!("/ho", "me/"), concat!("shar", "ed/")];

/// The sign before the number of a section. Documents here have anchors, so such a number belongs to a text that is not here.
const SECTION: char = '\u{a7}';

/// All findings of one file.
pub fn check(file: &str, content: &str) -> Vec<Violation> {
    let mut findings = Vec::new();
    for (number, line) in content.split('\n').enumerate() {
        let mut tell = |message: String| findings.push(Violation::new(file, number + 1, message));
        for place in PLACES.iter().filter(|place| names(line, place)) {
            tell(format!("names {place}, which is outside the repository"));
        }
        if cites_a_section(line) {
            tell("cites a section by its number, of a text outside the repository; cite theory/PAGE#ANCHOR".into());
        }
        if !is_ours(file) {
            continue;
        }
        if line.ends_with('\r') {
            tell("ends with CR LF".into());
        } else if line.ends_with([' ', '\t']) {
            tell("trailing blanks".into());
        }
        if line.contains('\t') {
            tell("tab".into());
        }
    }
    if is_ours(file) && !content.is_empty() && !content.ends_with('\n') {
        findings.push(Violation::new(file, 0, "does not end with a line end"));
    }
    if is_ours(file) && content.ends_with("\n\n") {
        findings.push(Violation::new(file, 0, "ends with empty lines"));
    }
    findings
}

/// True if `place` occurs as the beginning of a path, not as a part of a longer word.
fn names(line: &str, place: &str) -> bool {
    line.match_indices(place).any(|(at, _)| !line[..at].ends_with(|before: char| before.is_alphanumeric()))
}

/// True for the sign of a section, or the word "formulation", before a number.
fn cites_a_section(line: &str) -> bool {
    let number = |rest: &str| rest.trim_start_matches([' ', '(']).starts_with(|next: char| next.is_ascii_digit());
    let word = concat!("formul", "ation ");
    line.split(SECTION).skip(1).any(number) || line.to_lowercase().split(word).skip(1).any(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn messages(file: &str, content: &str) -> Vec<(usize, String)> {
        check(file, content).into_iter().map(|finding| (finding.line, finding.message)).collect()
    }

    #[test]
    fn blanks_tabs_and_line_ends() {
        let found = messages("a.rs", "fine\nblank \n\ttab\ncr\r\nlast");
        let lines: Vec<usize> = found.iter().map(|found| found.0).collect();
        assert_eq!(lines, [2, 3, 4, 0], "{found:?}");
        assert!(messages("a.rs", "fine\n").is_empty());
        assert_eq!(messages("a.rs", "fine\n\n").len(), 1);
        assert!(messages("crates/x/tests/data/odd.inp", "odd \r\n").is_empty());
    }

    #[test]
    fn places_outside_are_found_in_any_file() {
        let text = format!("see {}formulation.md\n", PLACES[0]);
        assert_eq!(messages("notes", &text).len(), 1);
        assert!(messages("notes", &format!("force{}power\n", PLACES[0])).is_empty());
        assert_eq!(messages("a.rs", &format!("// ../{}other.md\n", PLACES[3])).len(), 1);
    }

    #[test]
    fn sections_of_other_texts_are_not_cited() {
        for line in [format!("// {SECTION}4.2"), format!("{SECTION} 1"), concat!("(formul", "ation (3.2))").to_owned()]
        {
            assert_eq!(messages("a.toml", &format!("# fine\n{line}\n"))[0].0, 2, "{line}");
        }
        assert!(messages("a.md", &format!("{SECTION} is a sign, a formul{} of 2004\n", "ation")).is_empty());
    }
}
