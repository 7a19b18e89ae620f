//! A value of the document with its path, and readers of plain values.
//!
//! Every reader returns `None` after it has reported what is wrong, so that reading goes on and all problems are found.

use super::old;
use super::values::{self, Parameters};
use crate::source::{Source, element};
use crate::spelling::known;
use crate::{Location, Problem};
use std::cell::{Cell, RefCell};
use std::ops::{Range, RangeInclusive};
use toml::de::DeValue;

/// The text, the parameters of its expressions, and the problems found so far.
pub(crate) struct Report<'a> {
    pub(crate) source: &'a Source,
    pub(crate) problems: RefCell<Vec<Problem>>,
    pub(crate) parameters: Parameters,
    /// Start and value of the expression that was evaluated last.
    pub(crate) evaluated: Cell<Option<(usize, f64)>>,
}

impl Report<'_> {
    pub(crate) fn add(&self, location: Location, key: String, value: &str, message: String, remedy: String) {
        let mut problems = self.problems.borrow_mut();
        // The first problem of a key is enough: what else is wrong with it may follow from it.
        if problems.iter().all(|problem| problem.key != key) {
            problems.push(Problem::new(&self.source.file, location, key, value, message, remedy));
        }
    }

    /// Removes what was reported of a key that is not there.
    pub(crate) fn withdraw(&self, key: &str) {
        self.problems.borrow_mut().retain(|problem| problem.key != key);
    }
}

/// A value with its place and its path.
#[derive(Clone)]
pub(crate) struct Node<'a> {
    pub(crate) report: &'a Report<'a>,
    pub(crate) value: &'a DeValue<'a>,
    pub(crate) span: Range<usize>,
    pub(crate) key: String,
}

impl<'a> Node<'a> {
    /// Reports a problem of this value; always `None`.
    pub(crate) fn fail<T>(&self, message: impl Into<String>, remedy: impl Into<String>) -> Option<T> {
        let source = self.report.source;
        let value = if self.value.is_table() && source.slice(&self.span).starts_with('[') {
            // The span of a table with a header is the header.
            ""
        } else {
            source.slice(&self.span)
        };
        let location = source.location(self.span.clone());
        let mut message = message.into();
        if let Some((start, number)) = self.report.evaluated.get()
            && start == self.span.start
            && self.is_string()
        {
            message = format!("is {number}, {message}");
        }
        self.report.add(location, self.key.clone(), value, message, remedy.into());
        None
    }

    pub(crate) fn is_table(&self) -> bool {
        self.value.is_table()
    }

    /// True for a string, which may be an expression.
    pub(crate) fn is_string(&self) -> bool {
        matches!(self.value, DeValue::String(_))
    }

    /// The value of an expression.
    fn expression(&self, text: &str) -> Option<f64> {
        match values::evaluate(text, &self.report.parameters) {
            Ok(value) => {
                self.report.evaluated.set(Some((self.span.start, value)));
                Some(value)
            }
            Err(Some((message, remedy))) => self.fail(message, remedy),
            Err(None) => None,
        }
    }

    /// Reports that this value is something else; always `None`.
    pub(crate) fn wrong_type<T>(&self, expected: &str, example: &str) -> Option<T> {
        let found = self.value.type_str();
        self.fail(format!("must be {expected}, found {}", with_article(found)), format!("write for instance {example}"))
    }

    /// True for the word that says the same as leaving a key out.
    pub(crate) fn is_auto(&self) -> bool {
        self.string_value() == Some("auto")
    }

    /// The text of a string; nothing is reported.
    pub(crate) fn string_value(&self) -> Option<&'a str> {
        if let DeValue::String(text) = self.value { Some(text.as_ref()) } else { None }
    }

    pub(crate) fn string(&self) -> Option<String> {
        match self.value {
            DeValue::String(text) => Some(text.to_string()),
            _ => self.wrong_type("a string", "\"text\""),
        }
    }

    /// A string that is not blank.
    pub(crate) fn text(&self) -> Option<String> {
        let text = self.string()?;
        if text.trim().is_empty() {
            return self.fail("must not be empty", "give it a name");
        }
        Some(text)
    }

    /// A name of letters, digits, `-` and `_`.
    pub(crate) fn name(&self) -> Option<String> {
        let text = self.text()?;
        if !is_name(&text) {
            return self.fail("is not a valid name", "use letters, digits, `-` and `_` only");
        }
        Some(text)
    }

    pub(crate) fn boolean(&self) -> Option<bool> {
        match self.value {
            DeValue::Boolean(value) => Some(*value),
            _ => self.wrong_type("true or false", "true"),
        }
    }

    /// A number, infinite ones included, NaN not; or an expression.
    pub(crate) fn extended(&self) -> Option<f64> {
        let value = match self.value {
            DeValue::String(text) => return self.expression(text),
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64),
            _ => return self.wrong_type("a number", "1.0"),
        };
        match value {
            Some(value) if !value.is_nan() => Some(value),
            Some(_) => self.fail("must be a number, not NaN", "write for instance 1.0"),
            None => self.fail("is not a number that can be read", "write for instance 1.0"),
        }
    }

    /// A finite number.
    pub(crate) fn number(&self) -> Option<f64> {
        let value = self.extended()?;
        if !value.is_finite() {
            return self.fail("must be finite", "write a finite number below 1e308 in magnitude");
        }
        Some(value)
    }

    pub(crate) fn positive(&self) -> Option<f64> {
        let value = self.number()?;
        if value <= 0.0 {
            return self.fail("must be positive", "write a number larger than 0");
        }
        Some(value)
    }

    pub(crate) fn not_negative(&self) -> Option<f64> {
        let value = self.number()?;
        if value < 0.0 {
            return self.fail("must not be negative", "write 0 or a larger number");
        }
        Some(value)
    }

    pub(crate) fn not_zero(&self) -> Option<f64> {
        let value = self.number()?;
        if value == 0.0 {
            return self.fail("must not be zero", "write a number other than 0");
        }
        Some(value)
    }

    /// A whole number in a range.
    pub(crate) fn whole(&self, range: RangeInclusive<u64>) -> Option<u64> {
        let value = match self.value {
            DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix()).ok(),
            DeValue::String(text) => {
                let value = self.expression(text)?;
                if value.fract() != 0.0 || value.abs() > EXACT {
                    return self.fail("must be a whole number", "use round(...), floor(...) or ceil(...)");
                }
                Some(value as i128)
            }
            _ => return self.wrong_type("a whole number", "1"),
        };
        match value.and_then(|i| u64::try_from(i).ok()).filter(|i| range.contains(i)) {
            Some(value) => Some(value),
            None if *range.end() == u64::MAX => {
                self.fail(format!("must be at least {}", range.start()), format!("write {} or more", range.start()))
            }
            None => self.fail(
                format!("must be from {} to {}", range.start(), range.end()),
                format!("write a whole number from {} to {}", range.start(), range.end()),
            ),
        }
    }

    /// A coefficient of restitution.
    pub(crate) fn restitution(&self) -> Option<f64> {
        let value = self.not_negative()?;
        if value > 1.0 {
            return self.fail("is more than 1", "choose a value from 0 (plastic) to 1 (elastic)");
        }
        Some(value)
    }

    /// A whole number from 1 that fits 32 bits.
    pub(crate) fn count(&self) -> Option<u32> {
        self.whole_within(1..=u32::MAX)
    }

    /// A whole number in a range that fits 32 bits.
    pub(crate) fn whole_within(&self, range: RangeInclusive<u32>) -> Option<u32> {
        self.whole(u64::from(*range.start())..=u64::from(*range.end())).map(|i| i as u32)
    }

    /// One of a list of names.
    pub(crate) fn choice<T>(&self, names: &[&str], from_name: impl Fn(&str) -> Option<T>) -> Option<T> {
        let DeValue::String(name) = self.value else {
            return self.wrong_type("a string", &names.first().map_or_else(String::new, |name| format!("\"{name}\"")));
        };
        match from_name(name) {
            Some(value) => Some(value),
            None => match old::word(&self.key, name) {
                Some((message, remedy)) => self.fail(message, remedy),
                None => self.fail("is unknown", known(name, names.iter().copied())),
            },
        }
    }

    fn items(&self, example: &str) -> Option<Vec<Node<'a>>> {
        match self.value {
            DeValue::Array(array) => Some(
                array
                    .iter()
                    .enumerate()
                    .map(|(i, item)| Node {
                        report: self.report,
                        value: item.get_ref(),
                        span: item.span(),
                        key: element(&self.key, i),
                    })
                    .collect(),
            ),
            _ => self.wrong_type("a list", example),
        }
    }

    /// A list of any length; every element is read, also after a bad one.
    pub(crate) fn list<T>(&self, read: impl Fn(&Node<'a>) -> Option<T>) -> Option<Vec<T>> {
        let items = self.items("[1.0, 2.0]")?;
        let values: Vec<Option<T>> = items.iter().map(read).collect();
        values.into_iter().collect()
    }

    /// A list of `N` elements.
    pub(crate) fn array<T, const N: usize>(&self, read: impl Fn(&Node<'a>) -> Option<T>) -> Option<[T; N]> {
        let items = self.items(&format!("a list of {N} values"))?;
        if items.len() != N {
            return self.fail(
                format!("must have {N} elements, found {}", items.len()),
                format!("write a list of {N} elements"),
            );
        }
        let values: Vec<Option<T>> = items.iter().map(read).collect();
        let values: Option<Vec<T>> = values.into_iter().collect();
        values?.try_into().ok()
    }

    /// Three finite numbers.
    pub(crate) fn vector(&self) -> Option<[f64; 3]> {
        self.array(Node::number)
    }

    /// Three finite numbers, not all zero.
    pub(crate) fn direction(&self) -> Option<[f64; 3]> {
        let vector = self.vector()?;
        if vector == [0.0; 3] {
            return self.fail("must not be the zero vector", "give a direction, for instance [0, 0, 1]");
        }
        Some(vector)
    }
}

/// Whole numbers up to here are exact in floating-point numbers.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// True for names of letters, digits, `-` and `_`.
pub(crate) fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '-' || c == '_')
}

/// A noun with its article.
pub(crate) fn with_article(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}
