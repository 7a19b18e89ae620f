//! Parses expressions over sets; the grammar is in [`crate::SetExpression`]'s module.

use crate::expression::{self, ExpressionError, Formula, Name};
use crate::spelling::known;
use crate::{RegionKind, Relation, SetRegion};

/// Deepest nesting of brackets.
const DEPTH: usize = 64;

/// What the parser must know of the scene.
pub(crate) struct Known<'a> {
    /// Names of parts.
    pub(crate) parts: Vec<&'a str>,
    /// False if there may be others.
    pub(crate) parts_complete: bool,
    /// The part of a name of `[sets]`: `None` if there is no such name, `Some(None)` if it is wrong, which is reported.
    pub(crate) named: &'a dyn Fn(&str) -> Option<Option<String>>,
    /// Names of `[sets]`.
    pub(crate) names: Vec<&'a str>,
    /// Values of parameters.
    pub(crate) parameters: &'a dyn Fn(&str) -> Name,
}

/// Why a text is no expression over sets.
#[derive(Debug, PartialEq)]
pub(crate) enum SetError {
    /// Message, remedy, and byte at which it is.
    Wrong(String, String, usize),
    /// An error that is reported elsewhere.
    Reported,
}

/// True if a text has to be read as an expression and not as a plain `part.set`.
pub(crate) fn is_expression(text: &str) -> bool {
    text.contains(['&', '|', '!', '<', '>', '=', '(', ')', '\'']) || text.contains(" - ")
}

/// The part and the expression of a text.
pub(crate) fn parse(text: &str, known: &Known<'_>) -> Result<(String, SetRegion), SetError> {
    let mut parser = Parser { text, at: 0, depth: 0, known, part: None };
    let region = parser.union()?;
    parser.skip_space();
    if parser.at < text.len() {
        let message = "an operator is missing here, or a bracket is superfluous";
        return Err(parser.wrong(message, REMEDY));
    }
    match parser.part {
        Some(part) => Ok((part, region)),
        None => {
            let message = "names no part: which part the nodes belong to is not given";
            let example = known.parts.first().copied().unwrap_or("block");
            Err(SetError::Wrong(message.into(), format!("write for instance \"{example}.all & {text}\""), 0))
        }
    }
}

/// What to write instead.
const REMEDY: &str = "write for instance \"block.top & x > 0.2\"; put a set name with other characters in single quotes, as in \"block.'top (1)'\"";

const RELATIONS: [(&str, Relation); 7] = [
    ("<=", Relation::LessOrEqual),
    (">=", Relation::GreaterOrEqual),
    ("!=", Relation::NotEqual),
    ("==", Relation::Equal),
    ("=", Relation::Equal),
    ("<", Relation::Less),
    (">", Relation::Greater),
];

struct Parser<'a> {
    text: &'a str,
    /// Byte at which the rest begins.
    at: usize,
    depth: usize,
    known: &'a Known<'a>,
    /// Part of the sets so far.
    part: Option<String>,
}

type Parsed = Result<SetRegion, SetError>;

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        // `at` moves by whole characters only.
        self.text.get(self.at..).unwrap_or_default()
    }

    fn skip_space(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
    }

    fn take(&mut self, token: &str) -> bool {
        self.skip_space();
        let found = self.rest().starts_with(token);
        if found {
            self.at += token.len();
        }
        found
    }

    fn wrong(&self, message: impl Into<String>, remedy: impl Into<String>) -> SetError {
        SetError::Wrong(message.into(), remedy.into(), self.at)
    }

    fn region(&self, start: usize, kind: RegionKind) -> SetRegion {
        let text = self.text.get(start..self.at).unwrap_or_default().trim().to_owned();
        SetRegion { text, kind }
    }

    fn union(&mut self) -> Parsed {
        self.skip_space();
        let start = self.at;
        let mut terms = vec![self.intersection()?];
        while self.take("|") {
            terms.push(self.intersection()?);
        }
        Ok(match (terms.len(), terms.pop()) {
            (1, Some(only)) => only,
            (_, last) => {
                terms.extend(last);
                self.region(start, RegionKind::Any(terms))
            }
        })
    }

    fn intersection(&mut self) -> Parsed {
        self.skip_space();
        let start = self.at;
        let mut factors = vec![self.factor()?];
        loop {
            if self.take("&") {
                factors.push(self.factor()?);
            } else if self.take("-") {
                let minus = self.at;
                let region = self.factor()?;
                let kind = RegionKind::Not(Box::new(region));
                factors.push(SetRegion {
                    text: format!("!{}", self.region(minus, RegionKind::Any(Vec::new())).text),
                    kind,
                });
            } else {
                break;
            }
        }
        Ok(match (factors.len(), factors.pop()) {
            (1, Some(only)) => only,
            (_, last) => {
                factors.extend(last);
                self.region(start, RegionKind::All(factors))
            }
        })
    }

    fn factor(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(self.wrong("is nested too deeply", "write parts of it in [sets]"));
        }
        let region = self.nested_factor()?;
        self.depth -= 1;
        Ok(region)
    }

    fn nested_factor(&mut self) -> Parsed {
        self.skip_space();
        let start = self.at;
        if self.rest().starts_with('!') && !self.rest().starts_with("!=") {
            self.at += 1;
            let region = self.factor()?;
            return Ok(self.region(start, RegionKind::Not(Box::new(region))));
        }
        if let Some(region) = self.set()? {
            return Ok(region);
        }
        if self.function("nearest") {
            let within = self.within()?;
            let point = [self.argument()?, self.argument()?, self.argument()?];
            self.close()?;
            return Ok(self.region(start, RegionKind::Nearest { within, point }));
        }
        if self.function("normal") {
            let within = self.within()?;
            let direction = [self.argument()?, self.argument()?, self.argument()?];
            let before = self.at;
            let degrees = self.argument()?;
            if direction == [0.0; 3] {
                return Err(SetError::Wrong(
                    "the direction is zero".into(),
                    "write for instance normal(block, 0, 0, 1, 30)".into(),
                    start,
                ));
            }
            if !(0.0..=180.0).contains(&degrees) {
                let message = format!("the angle {degrees} is not from 0 to 180 degrees");
                return Err(SetError::Wrong(
                    message,
                    "give the largest angle between normal and direction".into(),
                    before,
                ));
            }
            self.close()?;
            return Ok(self.region(start, RegionKind::Normal { within, direction, degrees }));
        }
        if !self.rest().starts_with('(') {
            return self.comparison();
        }
        // A bracket may begin a comparison, `(x + y) > 1`, or hold an expression over sets.
        match self.comparison() {
            Ok(region) => Ok(region),
            Err(SetError::Reported) => Err(SetError::Reported),
            Err(SetError::Wrong(message, remedy, at)) => {
                self.at = start + 1;
                let inner = self.union().and_then(|region| self.close().map(|()| region));
                inner.map(|region| self.region(start, region.kind)).map_err(|error| match error {
                    // Of the two readings the one that got farther is meant.
                    SetError::Wrong(.., there) if there < at => SetError::Wrong(message, remedy, at),
                    error => error,
                })
            }
        }
    }

    /// The name of a function with its opening bracket.
    fn function(&mut self, name: &str) -> bool {
        let start = self.at;
        if self.rest().starts_with(name) {
            self.at += name.len();
            if self.take("(") {
                return true;
            }
            self.at = start;
        }
        false
    }

    fn close(&mut self) -> Result<(), SetError> {
        if self.take(")") { Ok(()) } else { Err(self.wrong("a closing bracket is missing", "close every bracket")) }
    }

    /// The first argument of a function: a part, or an expression over sets.
    fn within(&mut self) -> Result<Box<SetRegion>, SetError> {
        self.skip_space();
        let start = self.at;
        let word = word(self.rest());
        let after = self.rest().get(word.len()..).unwrap_or_default().trim_start();
        if after.starts_with(',') && !self.known.names.contains(&word) {
            self.belongs(word, start)?;
            self.at += word.len();
            return Ok(Box::new(self.region(start, RegionKind::Set("all".to_owned()))));
        }
        self.union().map(Box::new)
    }

    /// A comma and a number.
    fn argument(&mut self) -> Result<f64, SetError> {
        if !self.take(",") {
            let remedy = "write nearest(part, x, y, z) or normal(part, nx, ny, nz, degrees)";
            return Err(self.wrong("an argument is missing", remedy));
        }
        self.skip_space();
        let start = self.at;
        let number = self.formula()?.constant().filter(|number| number.is_finite());
        number.ok_or_else(|| {
            SetError::Wrong("must be a finite number".into(), "write a number or parameters".into(), start)
        })
    }

    /// A set of a part, `part.(expression)`, or a name of `[sets]`.
    fn set(&mut self) -> Result<Option<SetRegion>, SetError> {
        let start = self.at;
        let part = word(self.rest());
        let after = self.rest().get(part.len()..).unwrap_or_default();
        if let Some(name) = after.strip_prefix('.') {
            let is_part = self.known.parts.contains(&part);
            let begins_name = name.starts_with(|c: char| c.is_alphabetic() || matches!(c, '_' | '\'' | '('));
            if !part.is_empty() && (is_part || begins_name) {
                self.belongs(part, start)?;
                self.at += part.len() + 1;
                return self.set_name(start).map(Some);
            }
        }
        // The longest word may contain minus signs.
        let short = part.split('-').next().unwrap_or_default();
        for name in [part, short] {
            match (self.known.named)(name) {
                Some(None) => return Err(SetError::Reported),
                Some(Some(owner)) => {
                    self.belongs(&owner, start)?;
                    self.at += name.len();
                    return Ok(Some(self.region(start, RegionKind::Set(name.to_owned()))));
                }
                None => {}
            }
        }
        Ok(None)
    }

    /// What follows the dot of a part.
    fn set_name(&mut self, start: usize) -> Parsed {
        let rest = self.rest();
        if let Some(quoted) = rest.strip_prefix('\'') {
            let Some(length) = quoted.find('\'').filter(|&length| length > 0) else {
                return Err(self.wrong("a name in single quotes is empty or has no end", REMEDY));
            };
            let name = quoted.get(..length).unwrap_or_default().to_owned();
            self.at += length + 2;
            return Ok(self.region(start, RegionKind::Set(name)));
        }
        if rest.starts_with('(') {
            self.at += 1;
            let region = self.union()?;
            self.close()?;
            return Ok(self.region(start, region.kind));
        }
        let ends =
            |c: char| c.is_whitespace() || matches!(c, '&' | '|' | '!' | '(' | ')' | '<' | '>' | '=' | ',' | '\'');
        let length = rest.find(ends).unwrap_or(rest.len());
        let name = rest.get(..length).unwrap_or_default().to_owned();
        if name.is_empty() {
            return Err(self.wrong("the name of a set is missing", REMEDY));
        }
        self.at += length;
        Ok(self.region(start, RegionKind::Set(name)))
    }

    /// Notes the part of a set: it must exist, and be the part of all other sets.
    fn belongs(&mut self, part: &str, at: usize) -> Result<(), SetError> {
        if !self.known.parts.contains(&part) {
            if !self.known.parts_complete {
                return Err(SetError::Reported);
            }
            let remedy = known(part, self.known.parts.iter().copied());
            return Err(SetError::Wrong(format!("there is no part `{part}`"), remedy, at));
        }
        match &self.part {
            Some(other) if other != part => {
                let message = format!("has sets of `{other}` and of `{part}`: a set belongs to one part");
                Err(SetError::Wrong(message, "write a table of its own for each part".into(), at))
            }
            _ => {
                self.part = Some(part.to_owned());
                Ok(())
            }
        }
    }

    /// `a < b`, or a chain `a < b < c`.
    fn comparison(&mut self) -> Parsed {
        let start = self.at;
        let mut terms = Vec::new();
        let mut left_at = self.at;
        self.formula()?;
        let mut left_end = self.at;
        while let Some(relation) = self.relation() {
            self.skip_space();
            let (right_at, _) = (self.at, self.formula()?);
            let right_end = self.at;
            let side = |from: usize, to: usize| self.text.get(from..to).unwrap_or_default().trim();
            let difference = format!("({}) - ({})", side(left_at, left_end), side(right_at, right_end));
            // Both sides were read before: only their length can be too much together.
            let (difference, _) = self.formula_of(&difference, 0).map_err(|error| self.complaint(error, start))?;
            let text = side(left_at, right_end).to_owned();
            terms.push(SetRegion { text, kind: RegionKind::Comparison { difference, relation } });
            (left_at, left_end) = (right_at, right_end);
        }
        match (terms.len(), terms.pop()) {
            (_, None) => Err(self.wrong("a comparison is missing here, or this is not a set", REMEDY)),
            (1, Some(only)) => Ok(only),
            (_, last) => {
                terms.extend(last);
                Ok(self.region(start, RegionKind::All(terms)))
            }
        }
    }

    fn relation(&mut self) -> Option<Relation> {
        RELATIONS.iter().find(|(token, _)| self.take(token)).map(|(_, relation)| *relation)
    }

    fn formula(&mut self) -> Result<Formula, SetError> {
        let (formula, end) = self.formula_of(self.text, self.at).map_err(|error| self.complaint(error, self.at))?;
        self.at = end;
        Ok(formula)
    }

    fn formula_of(&self, text: &str, at: usize) -> Result<(Formula, usize), ExpressionError> {
        expression::formula(text, at, &|name| match name {
            "x" => Name::Variable(0),
            "y" => Name::Variable(1),
            "z" => Name::Variable(2),
            other => (self.known.parameters)(other),
        })
    }

    fn complaint(&self, error: ExpressionError, start: usize) -> SetError {
        match error {
            ExpressionError::Reported => SetError::Reported,
            ExpressionError::UnknownName(name) => {
                let at = self.text.get(start..).and_then(|rest| rest.find(&name)).map_or(start, |i| start + i);
                let words = ["x", "y", "z"].into_iter().chain(self.known.names.iter().copied());
                let message = format!("`{name}` is not a coordinate, a parameter or a name of [sets]");
                SetError::Wrong(
                    message,
                    format!("{}; a set of a part is written part.set", known(&name, words.collect::<Vec<_>>())),
                    at,
                )
            }
            ExpressionError::Wrong { message, at } => {
                // The place counts characters from 1.
                let byte = self.text.char_indices().nth(at.saturating_sub(1)).map_or(self.text.len(), |(byte, _)| byte);
                SetError::Wrong(message, REMEDY.into(), byte)
            }
        }
    }
}

/// The word of letters, digits, `-` and `_` with which a text begins.
fn word(text: &str) -> &str {
    let length = text.find(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_')).unwrap_or(text.len());
    text.get(..length).unwrap_or_default()
}
