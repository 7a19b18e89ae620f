//! Printed and obtained output: words in order, numbers within a tolerance.

/// When two numbers are equal.
#[derive(Clone, Copy)]
pub struct Tolerance {
    pub relative: f64,
    /// Two numbers below this are equal: for round-off.
    pub zero: f64,
}

impl Tolerance {
    fn same(&self, expected: f64, obtained: f64) -> bool {
        let largest = expected.abs().max(obtained.abs());
        largest < self.zero || (expected - obtained).abs() <= self.relative * largest
    }
}

const GAP: &str = "...";

#[derive(PartialEq, Debug)]
enum Piece {
    Word(String),
    Number(f64),
}

/// Words and numbers of a line. A number begins behind what is neither a letter nor a digit.
fn pieces(line: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for part in line.split_whitespace() {
        let mut rest = part;
        let mut word = String::new();
        while let Some(first) = rest.chars().next() {
            let free = !word.ends_with(|last: char| last.is_alphanumeric() || last == '_' || last == '.');
            let length = if free { number(rest) } else { 0 };
            if length == 0 {
                word.push(first);
                rest = &rest[first.len_utf8()..];
                continue;
            }
            if !word.is_empty() {
                pieces.push(Piece::Word(std::mem::take(&mut word)));
            }
            pieces.push(Piece::Number(rest[..length].parse().expect("the scanner takes numbers only")));
            rest = &rest[length..];
            // What follows a number directly is a word, as the unit in `3s`.
            let tail = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
            word.push_str(&rest[..tail]);
            rest = &rest[tail..];
        }
        if !word.is_empty() {
            pieces.push(Piece::Word(word));
        }
    }
    pieces
}

/// Bytes of the number at the beginning of a text, 0 if there is none.
fn number(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let sign = usize::from(matches!(bytes.first(), Some(b'-' | b'+')));
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut fraction = 0;
    if bytes.get(end) == Some(&b'.') {
        fraction = digits(end + 1);
        if fraction > 0 {
            end += 1 + fraction;
        }
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'-' | b'+')));
        let exponent = if end + 1 + sign < bytes.len() { digits(end + 1 + sign) } else { 0 };
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

fn line_agrees(expected: &str, obtained: &str, tolerance: Tolerance) -> bool {
    let (expected, open) = match expected.trim_end().strip_suffix(GAP) {
        Some(begin) => (begin, true),
        None => (expected, false),
    };
    let (expected, obtained) = (pieces(expected), pieces(obtained));
    let long_enough = if open { obtained.len() >= expected.len() } else { obtained.len() == expected.len() };
    long_enough
        && expected.iter().zip(&obtained).all(|pair| match pair {
            (Piece::Word(one), Piece::Word(other)) => one == other,
            (&Piece::Number(one), &Piece::Number(other)) => tolerance.same(one, other),
            _ => false,
        })
}

/// Compares printed lines, each with its number in the text, with an output. The error names the first line that does not fit, and what is there instead.
pub fn compare(expected: &[(usize, String)], output: &str, tolerance: Tolerance) -> Result<(), String> {
    let obtained: Vec<&str> = output.lines().filter(|line| !line.trim().is_empty()).collect();
    let expected: Vec<&(usize, String)> = expected.iter().filter(|(_, line)| !line.trim().is_empty()).collect();
    let parts: Vec<&[&(usize, String)]> = expected.split(|(_, line)| line.trim() == GAP).collect();
    let mut from = 0;
    for (number, part) in parts.iter().enumerate() {
        // How many lines of the part agree, if it begins there.
        let agree = |start: usize| {
            let pairs = part.iter().zip(&obtained[start.min(obtained.len())..]);
            pairs.take_while(|((_, line), have)| line_agrees(line, have, tolerance)).count()
        };
        let (first, last) = (number == 0, number + 1 == parts.len());
        let end = obtained.len().saturating_sub(part.len()).max(from);
        let starts = match (first, last) {
            (true, _) => 0..=0,
            (false, true) => end..=end,
            (false, false) => from..=end,
        };
        let start = starts.clone().find(|&start| agree(start) == part.len());
        let Some(start) = start else {
            let near = starts
                .max_by_key(|&start| (agree(start), std::cmp::Reverse(start)))
                .expect("there is a place to begin");
            let good = agree(near);
            let (line, text) = part[good];
            // In a gap where nothing fits the line with the same words says most.
            let any = Tolerance { relative: f64::INFINITY, zero: 0.0 };
            let alike = (good == 0 && !first)
                .then(|| obtained[from..].iter().find(|have| line_agrees(text, have, any)))
                .flatten();
            let have = alike.or(obtained.get(near + good)).map_or("(the output ends)", |have| *have);
            return Err(format!("  line {line}\n  expected: {text}\n  obtained: {have}\n"));
        };
        from = start + part.len();
    }
    match obtained.get(from) {
        Some(more) if parts.len() == 1 => Err(format!("  behind the last line\n  obtained: {more}\n")),
        _ => Ok(()),
    }
}
