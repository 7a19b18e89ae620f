//! Rules for Rust sources.

use super::Violation;
use super::source::Source;

/// Longest file without a reason.
const MOST_LINES: usize = 700;

/// Files that may be longer, each with its reason.
const LONG_FILES: &[(&str, &str)] = &[];

/// Comment that explains why a call cannot fail.
const CANNOT_FAIL: &str = "cannot fail:";

/// All findings of one source file.
pub fn check(file: &str, content: &str) -> Vec<Violation> {
    let mut findings = Vec::new();
    let lines = content.lines().count();
    if lines > MOST_LINES && !LONG_FILES.iter().any(|(long, _)| *long == file) {
        findings.push(Violation::new(
            file,
            0,
            format!("{lines} lines, more than {MOST_LINES}: split it along its sense"),
        ));
    }
    if in_sources(file) && !content.starts_with("//!") {
        findings.push(Violation::new(file, 1, "does not start with `//!`: say what the module is"));
    }
    let source = Source::new(content);
    for (line, code) in source.code.iter().enumerate() {
        let mut tell = |message: &str| findings.push(Violation::new(file, line + 1, message));
        for unfinished in ["todo!", "unimplemented!", "dbg!", "#[ignore"] {
            if has_word(code, unfinished) {
                tell(&format!("{unfinished} is unfinished work"));
            }
        }
        for marker in ["FIXME", "XXX"] {
            if has_word(&source.comments[line], marker) {
                tell(&format!("{marker} is unfinished work"));
            }
        }
        // An `unsafe fn` states its demands in its documentation instead.
        let trusts = has_word(code, "unsafe {") || has_word(code, "unsafe impl");
        if trusts && !source.explained(line, "SAFETY:") {
            tell("`unsafe` without `// SAFETY:`");
        }
        if (code.contains("[allow(") || code.contains("[expect(")) && !attribute(&source, line).contains("reason") {
            tell("a lint is switched off without `reason = ...`");
        }
        if must_not_panic(file) && !source.test[line] && !source.explained(line, CANNOT_FAIL) {
            for call in [".unwrap()", ".expect(", "panic!", "unreachable!()", ".unwrap_err()"] {
                if has_word(code, call) && !is_passed_on(&source.code[line..], call) {
                    tell(&format!("`{call}` outside tests without `// {CANNOT_FAIL} ...`"));
                }
            }
        }
        if let Some(path) = included(code, content.split('\n').nth(line).unwrap_or_default())
            && leaves_repository(file, path)
        {
            tell(&format!("includes {path}, which is outside the repository"));
        }
    }
    findings
}

/// Entries of the list of long files that name no file.
pub fn stale_allowances(exists: impl Fn(&str) -> bool) -> Vec<Violation> {
    let stale = LONG_FILES.iter().filter(|(file, _)| !exists(file));
    stale.map(|(file, _)| Violation::new(file, 0, "is on the list of long files, but does not exist")).collect()
}

fn in_sources(file: &str) -> bool {
    file.contains("/src/") || file.starts_with("src/")
}

/// Library and program code; the test kit panics by design, as tests do, and xtask and its suites are chores.
fn must_not_panic(file: &str) -> bool {
    file.starts_with("crates/")
        && in_sources(file)
        && !file.starts_with("crates/testkit/")
        && !file.starts_with("crates/verification/")
        && !file.ends_with("/tests.rs")
        && !file.contains("/tests/")
}

/// True if `word` occurs and is not a part of a longer name.
fn has_word(text: &str, word: &str) -> bool {
    let name = |symbol: char| symbol.is_alphanumeric() || symbol == '_';
    text.match_indices(word).any(|(at, _)| {
        let (before, after) = (&text[..at], &text[at + word.len()..]);
        let starts = !word.starts_with(name) || !before.ends_with(name);
        let ends = !word.ends_with(name) || !after.starts_with(name);
        starts && ends
    })
}

/// True if `?` follows the call that starts on the first line: it is then a method of ours that returns an error.
fn is_passed_on(code: &[String], call: &str) -> bool {
    let first = code[0].split_once(call).map_or("", |(_, after)| after);
    let mut symbols = first.chars().chain(code[1..].iter().flat_map(|line| line.chars()));
    let mut depth = usize::from(call.ends_with('('));
    while depth > 0 {
        match symbols.next() {
            Some('(') => depth += 1,
            Some(')') => depth -= 1,
            Some(_) => {}
            None => return false,
        }
    }
    symbols.next() == Some('?')
}

/// The attribute that starts on this line, to the line with its `]`.
fn attribute(source: &Source, line: usize) -> String {
    let mut text = String::new();
    for code in &source.code[line..] {
        text.push_str(code);
        if code.contains(']') {
            break;
        }
    }
    text
}

/// Path of an `include_str!`, `include_bytes!`, `include!` or `#[path = ...]` on this line.
fn included<'a>(code: &str, line: &'a str) -> Option<&'a str> {
    let opening =
        ["include_str!(", "include_bytes!(", "include!(", "#[path"].iter().find(|opening| code.contains(**opening))?;
    let after = &line[line.find(opening)? + opening.len()..];
    after.split('"').nth(1)
}

/// True if a path relative to `file` climbs above the root, or is absolute.
fn leaves_repository(file: &str, path: &str) -> bool {
    let mut depth = file.matches('/').count() as isize;
    path.starts_with('/')
        || path.split('/').any(|part| {
            depth += match part {
                ".." => -1,
                "." | "" => 0,
                _ => 1,
            };
            depth < 0
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(file: &str, code: &str) -> Vec<String> {
        check(file, code).into_iter().map(|finding| finding.message).collect()
    }

    fn in_library(code: &str) -> Vec<String> {
        found("crates/x/src/a.rs", &format!("//! Module.\n{code}\n"))
    }

    #[test]
    fn panics_need_a_reason_outside_tests() {
        for call in ["a.unwrap();", "a.expect(\"b\");", "panic!(\"b\");", "unreachable!();"] {
            assert_eq!(in_library(call).len(), 1, "{call}");
            assert!(in_library(&format!("// cannot fail: c\n{call}")).is_empty(), "{call}");
            assert!(in_library(&format!("#[cfg(test)]\nmod tests {{\n{call}\n}}")).is_empty(), "{call}");
            assert!(found("crates/x/tests/a.rs", call).is_empty(), "{call}");
        }
        assert!(in_library("parser.expect(b(\n1))?;").is_empty());
        assert_eq!(in_library("a.expect(\"b\"); c?;").len(), 1);
        assert!(in_library("a.unwrap_or(1); a.expect_that(); \".unwrap()\"; // .unwrap()").is_empty());
    }

    #[test]
    fn unfinished_work_is_found_everywhere() {
        for code in ["todo!()", "unimplemented!()", "dbg!(a)", "#[ignore]", "// FIXME: a", "/* XXX */"] {
            assert_eq!(in_library(code).len(), 1, "{code}");
            assert_eq!(found("crates/x/tests/a.rs", code).len(), 1, "{code}");
        }
        assert!(in_library("\"todo!()\"; // todo!() as words").is_empty());
    }

    #[test]
    fn unsafe_needs_its_safety_and_lints_their_reason() {
        assert_eq!(in_library("unsafe { a() }").len(), 1);
        assert!(in_library("// SAFETY: b\nunsafe { a() }").is_empty());
        assert!(in_library("#![deny(unsafe_code)]\nunsafe fn b() {}").is_empty());
        assert_eq!(in_library("#[allow(dead_code)]").len(), 1);
        assert!(in_library("#[allow(\n    dead_code,\n    reason = \"b\"\n)]").is_empty());
    }

    #[test]
    fn modules_say_what_they_are() {
        assert_eq!(found("crates/x/src/lib.rs", "pub fn a() {}\n").len(), 1);
        assert!(found("crates/x/tests/a.rs", "fn a() {}\n").is_empty());
    }

    #[test]
    fn long_files_are_found() {
        assert!(in_library(&"\n".repeat(MOST_LINES - 2)).is_empty());
        assert_eq!(in_library(&"\n".repeat(MOST_LINES)).len(), 1);
        assert!(stale_allowances(|_| true).is_empty());
        assert_eq!(stale_allowances(|_| false).len(), LONG_FILES.len());
    }

    #[test]
    fn inclusions_stay_inside() {
        assert!(in_library("const A: &str = include_str!(\"../../../docs/a.md\");").is_empty());
        assert_eq!(in_library("const A: &str = include_str!(\"../../../../a.md\");").len(), 1);
        assert_eq!(in_library("const A: &str = include_str!(\"/a.md\");").len(), 1);
    }
}
