//! Rust text taken apart: code without comments and strings, comments without code.

/// Lines of a source file in two views of equal shape.
#[derive(Debug)]
pub struct Source {
    /// Code; comments and the insides of strings are blank.
    pub code: Vec<String>,
    /// Comments; everything else is blank.
    pub comments: Vec<String>,
    /// True for lines inside `#[cfg(test)]` items.
    pub test: Vec<bool>,
}

impl Source {
    /// Takes a text apart.
    pub fn new(text: &str) -> Self {
        let (code, comments) = split(text);
        let code: Vec<String> = code.split('\n').map(str::to_owned).collect();
        let test = test_lines(&code);
        Self { code, comments: comments.split('\n').map(str::to_owned).collect(), test }
    }

    /// True if `marker` stands in a comment on this line, or above it within the same statement.
    pub fn explained(&self, line: usize, marker: &str) -> bool {
        let mut at = line;
        loop {
            if self.comments[at].contains(marker) {
                return true;
            }
            let Some(above) = at.checked_sub(1) else { return false };
            let code = self.code[above].trim_end();
            let comment_only = code.is_empty() && !self.comments[above].trim().is_empty();
            let unfinished = !code.is_empty() && !code.ends_with([';', '{', '}', ',']);
            if !(comment_only || unfinished) {
                // A comment behind the end of the statement before explains that one.
                return false;
            }
            at = above;
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Mode {
    Code,
    LineComment,
    BlockComment(usize),
    Text,
    RawText(usize),
}

fn split(text: &str) -> (String, String) {
    let symbols: Vec<char> = text.chars().collect();
    let (mut code, mut comments) = (String::with_capacity(text.len()), String::with_capacity(text.len()));
    let mut mode = Mode::Code;
    let mut at = 0;
    while at < symbols.len() {
        let here = symbols[at];
        let next = symbols.get(at + 1).copied().unwrap_or('\n');
        let mut width = 1;
        let mut in_comment = matches!(mode, Mode::LineComment | Mode::BlockComment(_));
        let mut in_code = mode == Mode::Code;
        match mode {
            Mode::Code => match here {
                '/' if next == '/' => (mode, in_code, in_comment) = (Mode::LineComment, false, true),
                '/' if next == '*' => (mode, in_code, in_comment, width) = (Mode::BlockComment(1), false, true, 2),
                '"' => mode = Mode::Text,
                'r' if raw_hashes(&symbols, at).is_some() => {
                    let hashes = raw_hashes(&symbols, at).unwrap_or(0);
                    (mode, width) = (Mode::RawText(hashes), hashes + 2);
                }
                '\'' => {
                    width = character_width(&symbols, at);
                    if width > 1 {
                        in_code = false;
                    }
                }
                _ => {}
            },
            Mode::LineComment if here == '\n' => (mode, in_comment) = (Mode::Code, false),
            Mode::BlockComment(depth) => match (here, next) {
                ('*', '/') => (mode, width) = (if depth == 1 { Mode::Code } else { Mode::BlockComment(depth - 1) }, 2),
                ('/', '*') => (mode, width) = (Mode::BlockComment(depth + 1), 2),
                _ => {}
            },
            Mode::Text => match here {
                '\\' => width = 2,
                '"' => (mode, in_code) = (Mode::Code, true),
                _ => {}
            },
            Mode::RawText(hashes)
                if here == '"' && symbols[at + 1..].iter().take_while(|c| **c == '#').count() >= hashes =>
            {
                (mode, width) = (Mode::Code, hashes + 1);
            }
            Mode::LineComment | Mode::RawText(_) => {}
        }
        for symbol in symbols.iter().skip(at).take(width) {
            let line_end = *symbol == '\n';
            code.push(if in_code || line_end { *symbol } else { ' ' });
            comments.push(if in_comment || line_end { *symbol } else { ' ' });
        }
        at += width;
    }
    (code, comments)
}

/// Number of `#` of a raw string that starts here, if one does.
fn raw_hashes(symbols: &[char], at: usize) -> Option<usize> {
    let word = |symbol: &char| symbol.is_alphanumeric() || *symbol == '_';
    let before = at.checked_sub(1).map(|before| symbols[before]);
    if before.is_some_and(|before| word(&before) && before != 'b') {
        return None;
    }
    let hashes = symbols[at + 1..].iter().take_while(|symbol| **symbol == '#').count();
    (symbols.get(at + 1 + hashes) == Some(&'"')).then_some(hashes)
}

/// Width of the character literal that starts here; 1 for a lifetime.
fn character_width(symbols: &[char], at: usize) -> usize {
    if symbols.get(at + 1) == Some(&'\\') {
        let end = symbols.iter().skip(at + 3).position(|symbol| *symbol == '\'');
        return end.map_or(1, |end| end + 4);
    }
    if symbols.get(at + 2) == Some(&'\'') { 3 } else { 1 }
}

/// Marks the item behind each `#[cfg(test)]`, to its closing brace or its semicolon.
fn test_lines(code: &[String]) -> Vec<bool> {
    let mut test = vec![false; code.len()];
    let mut line = 0;
    while line < code.len() {
        if !code[line].trim_start().starts_with("#[cfg(test)]") {
            line += 1;
            continue;
        }
        let mut depth = 0usize;
        'item: while line < code.len() {
            test[line] = true;
            for symbol in code[line].chars() {
                match symbol {
                    '{' => depth += 1,
                    '}' => depth = depth.saturating_sub(1),
                    ';' if depth == 0 => break 'item,
                    _ => continue,
                }
                if depth == 0 {
                    break 'item;
                }
            }
            line += 1;
        }
        line += 1;
    }
    test
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_and_comments_are_no_code() {
        let text = "let a = \"x // y \\\" z\"; // c \"d\"\nlet b = r#\"un\"safe\"#; /* one /* two */ three */ let c = 'x';\n\
                    let d: &'static str = \"\"; let e = '\\'';let f = b'\"'; g(\"tail\")";
        let source = Source::new(text);
        for word in ["x", "y", "z", "un", "safe", "one", "three", "tail"] {
            let found = source.code.iter().any(|line| line.split(|c: char| !c.is_alphanumeric()).any(|w| w == word));
            assert!(!found, "{word}: {:?}", source.code);
        }
        assert!(source.code[1].contains("let c ="));
        assert!(
            source.code[2].contains("&'static str")
                && source.code[2].contains("let f")
                && source.code[2].contains("g(")
        );
        assert!(source.comments[0].contains("c \"d\"") && !source.comments[0].contains("x //"));
        assert!(source.comments[1].contains("three"));
        assert_eq!(source.code.len(), 3);
    }

    #[test]
    fn test_items_are_marked_to_their_end() {
        let text = "fn a() {}\n#[cfg(test)]\nmod tests {\n    fn b() {\n    }\n}\nfn c() {}\n#[cfg(test)]\nmod more;\nfn d() {}";
        let source = Source::new(text);
        let marked: Vec<usize> = (0..source.test.len()).filter(|line| source.test[*line]).collect();
        assert_eq!(marked, [1, 2, 3, 4, 5, 7, 8]);
    }

    #[test]
    fn an_explanation_covers_its_statement_only() {
        let text = "// cannot fail: one\nlet a = b\n    .c()\n    .d();\nlet e = f();\nlet g = h(); // cannot fail: two\nlet i = j();";
        let source = Source::new(text);
        let covered: Vec<usize> = (0..7).filter(|line| source.explained(*line, "cannot fail:")).collect();
        assert_eq!(covered, [0, 1, 2, 3, 5]);
    }
}
