//! Keyword lines and data lines.

use super::fields::{fields, unquote};
use crate::MeshIoError;
use crate::lines::Lines;
use crate::place::FileLocation;

/// A keyword line: `*NAME, PARAMETER=VALUE, FLAG`.
#[derive(Clone)]
pub(crate) struct Keyword {
    /// Upper case, without the star, single spaces.
    pub name: String,
    /// Names in upper case without spaces; values without quotes.
    parameters: Vec<(String, Option<String>)>,
    /// Place of the line.
    pub place: FileLocation,
}

impl Keyword {
    /// The value of a parameter, if it is there and has one.
    pub fn value(&self, parameter: &str) -> Option<&str> {
        self.parameters.iter().find(|(name, _)| name == parameter).and_then(|(_, value)| value.as_deref())
    }

    /// True if the parameter is there.
    pub fn flag(&self, parameter: &str) -> bool {
        self.parameters.iter().any(|(name, _)| name == parameter)
    }

    /// The value of a parameter that must be there.
    pub fn require(&self, lines: &Lines, parameter: &str) -> Result<&str, MeshIoError> {
        match self.value(parameter) {
            Some(value) if !value.is_empty() => Ok(value),
            _ => Err(crate::lines::syntax(
                lines.path,
                self.place.at as usize,
                format_args!("*{}", self.name),
                format_args!("needs the parameter {parameter}=..."),
            )),
        }
    }

    /// Names of the parameters, in upper case without spaces.
    pub fn parameters(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(|(name, _)| name.as_str())
    }

    fn parse(text: &str, place: FileLocation) -> Keyword {
        let mut fields = fields(text);
        let name = fields.next().unwrap_or_default().trim_start_matches('*');
        let name = name.split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase();
        let parameters = fields
            .filter(|f| !f.is_empty())
            .map(|field| match field.split_once('=') {
                Some((name, value)) => (squeeze(name), Some(unquote(value).to_owned())),
                None => (squeeze(field), None),
            })
            .collect();
        Keyword { name, parameters, place }
    }
}

/// The name in upper case without white space.
fn squeeze(name: &str) -> String {
    name.split_whitespace().collect::<String>().to_uppercase()
}

/// One item of a file.
pub(super) enum Item<'a> {
    Keyword(Keyword),
    Data(&'a str),
}

/// The next keyword (with its continuation lines) or data line; comments are skipped.
pub(super) fn next<'a>(lines: &mut Lines<'a>) -> Option<Item<'a>> {
    let line = next_line(lines)?;
    if !line.starts_with('*') {
        return Some(Item::Data(line));
    }
    let start = lines.place();
    if !line.ends_with(',') {
        return Some(Item::Keyword(Keyword::parse(line, start)));
    }
    let mut text = line.to_owned();
    while text.ends_with(',') {
        // a keyword in the next line means that the comma was a slip
        let mut ahead = lines.clone();
        match next_line(&mut ahead) {
            Some(more) if !more.starts_with('*') => {
                text.push_str(more);
                *lines = ahead;
            }
            _ => break,
        }
    }
    Some(Item::Keyword(Keyword::parse(&text, start)))
}

fn next_line<'a>(lines: &mut Lines<'a>) -> Option<&'a str> {
    loop {
        let line = lines.next()?;
        if !line.starts_with("**") {
            return Some(line);
        }
    }
}
