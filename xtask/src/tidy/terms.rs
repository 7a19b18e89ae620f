//! Rule for what users read: words of the field, and one name for one thing.
//!
//! Texts for users are Markdown without that for developers, the descriptions of the scene format, and the string
//! literals of the crates that speak with users. To ban a phrase, add it to [`TERMS`] with what to write in its place.

use super::Violation;
use super::source::Source;

/// Phrases that are not used, in lower case, and what says it instead.
const TERMS: [(&str, &str); 41] = [
    ("is told", "is reported"),
    ("are told", "are reported"),
    ("does not tell", "does not report"),
    ("lets out", "leaves out"),
    ("counts beyond an edge", "belongs to the facet beyond the edge"),
    ("the set stands", "the active set is settled"),
    ("ledger", "balance of energy, balance.csv"),
    ("blow of an impact", "force of an impact"),
    ("looks of the watch", "checks of the watch"),
    ("lie in each other", "overlap"),
    ("lies in each other", "overlaps"),
    ("mend the", "correct the"),
    ("deserves a look", "needs attention"),
    ("is looked at", "is checked"),
    ("are looked at", "are checked"),
    ("two looks", "two checks"),
    ("anew", "again"),
    ("in the place of", "in place of"),
    ("tells nothing", "gives no information"),
    ("work that nobody does", "work that no force does"),
    ("for ever", "without end"),
    ("to and fro", "back and forth"),
    ("keeps what it keeps", "conserves its quantities"),
    ("is no mistake", "is correct"),
    ("there at once", "applied in full at the start"),
    ("there twice", "redundant"),
    ("anything against anything", "contact between all surfaces"),
    ("acts on anything", "is in contact"),
    ("no neighbours", "not adjacent"),
    ("put inside", "inset"),
    ("round in a circle", "in a cycle"),
    ("by itself, in a circle", "in a cycle"),
    ("present folder", "current directory"),
    ("body bears", "body withstands"),
    ("bodies inside each other", "overlap, penetration"),
    ("a run that goes on", "a run that is running"),
    ("run goes on", "run is running"),
    ("modes without stiffness", "zero-energy modes"),
    ("came out wrong", "has a wrong result"),
    ("files that there are", "existing files"),
    ("that is looked for", "known"),
];

/// Documents of developers.
const DEVELOPERS: [&str; 4] = ["docs/ARCHITECTURE.md", "docs/how-to-add/", "docs/verification/", "docs/reuse/"];

/// Crates whose string literals are messages for users.
const SPEAKERS: [&str; 9] = [
    "crates/cli/src/",
    "crates/contact/src/",
    "crates/deck-import/src/",
    "crates/mesh-io/src/",
    "crates/report/src/",
    "crates/scene/src/",
    "crates/solver/src/",
    "crates/stoss/src/",
    "crates/watch/src/",
];

/// All findings of one file.
pub fn check(file: &str, content: &str) -> Vec<Violation> {
    let lines = read_by_users(file, content);
    let mut findings = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        // A phrase may go on in the next line.
        let next = lines.get(number + 1).map_or("", |next| next.trim_start());
        let text = format!("{} {next}", line.trim_end());
        for (term, instead) in TERMS {
            if starts(&text, term).any(|at| at < line.len()) {
                findings.push(Violation::new(file, number + 1, format!("says \"{term}\"; write \"{instead}\"")));
            }
        }
    }
    findings
}

/// The lines of a file as far as users read them, in lower case; code in backticks is blank.
fn read_by_users(file: &str, content: &str) -> Vec<String> {
    let document = file == "README.md" || file.starts_with("docs/");
    if document && file.ends_with(".md") && !DEVELOPERS.iter().any(|place| file.starts_with(place)) {
        content.lines().map(without_code).collect()
    } else if file == "docs/scene.schema.json" {
        content.lines().map(|line| without_code(&line.replace("\\n", " "))).collect()
    } else if file.ends_with(".rs") && SPEAKERS.iter().any(|place| file.starts_with(place)) {
        strings(content)
    } else {
        Vec::new()
    }
}

fn without_code(line: &str) -> String {
    let parts = line.split('`').enumerate();
    parts.map(|(at, part)| if at % 2 == 0 { part.to_lowercase() } else { " _ ".to_owned() }).collect()
}

/// The insides of string literals outside of tests; everything else is blank.
fn strings(content: &str) -> Vec<String> {
    let source = Source::new(content);
    let lines = content.split('\n').zip(source.code.iter().zip(&source.comments)).zip(&source.test);
    let inside = lines.map(|((line, (code, comments)), test)| {
        let symbols = line.chars().zip(code.chars().zip(comments.chars()));
        let literal = symbols.map(|(symbol, others)| if others == (' ', ' ') && !test { symbol } else { ' ' });
        // A backslash joins the next line.
        literal.collect::<String>().trim_end().trim_end_matches('\\').to_lowercase()
    });
    inside.collect()
}

/// Where a term begins as words of their own.
fn starts<'a>(text: &'a str, term: &'a str) -> impl Iterator<Item = usize> + 'a {
    let word = |symbol: char| symbol.is_alphanumeric() || symbol == '_' || symbol == '.';
    text.match_indices(term).map(|(at, _)| at).filter(move |at| {
        !text[..*at].ends_with(word) && !text[at + term.len()..].starts_with(|next: char| next.is_alphanumeric())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(file: &str, content: &str) -> Vec<usize> {
        check(file, content).into_iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn documents_of_users_are_read() {
        assert_eq!(lines("docs/guide/contact.md", "fine\nThat is told, `is told`.\nwhat it\nlets\nout\n"), [2, 4]);
        assert_eq!(lines("README.md", "The Ledger.\n"), [1]);
        assert_eq!(lines("docs/scene.schema.json", "\"it is\\ntold\"\n"), [1]);
        assert!(
            lines("docs/guide/contact.md", "`solver/ledger.rs`, ledgers, is tolder, this told, outlets out\n")
                .is_empty()
        );
        assert!(lines("docs/ARCHITECTURE.md", "The ledger.\n").is_empty());
    }

    #[test]
    fn messages_are_read_and_comments_are_not() {
        let text = "// is told\nlet a = \"b is told\";\nlet ledger = \"the \\\n    set stands\";\n#[cfg(test)]\nmod tests {\n    const A: &str = \"is told\";\n}\n";
        assert_eq!(lines("crates/scene/src/a.rs", text), [2, 3]);
        assert_eq!(lines("crates/solver/src/a.rs", text), [2, 3]);
        assert!(lines("crates/linalg/src/a.rs", text).is_empty());
    }
}
