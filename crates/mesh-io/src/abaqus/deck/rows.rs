//! Keywords with their data lines, and the fields of these.

use super::{DeckPlace, Target};
use crate::abaqus::block::Block;
use crate::abaqus::fields::{fields, number, unquote};
use crate::lines::real;
use crate::place::FileLocation;
use crate::{Contents, MeshIoError};

/// A data line with errors that say where it is.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    contents: &'a Contents,
    pub text: &'a str,
    pub at: FileLocation,
}

impl Block {
    pub fn place(&self) -> DeckPlace {
        self.keyword.place.into()
    }

    /// The data lines.
    pub(super) fn rows<'a>(&'a self, contents: &'a Contents) -> impl Iterator<Item = Row<'a>> {
        self.rows.iter().map(move |(text, at)| Row { contents, text, at: *at })
    }

    /// The first data line, or an error at the keyword.
    pub(super) fn first<'a>(&'a self, contents: &'a Contents, what: &str) -> Result<Row<'a>, MeshIoError> {
        self.rows(contents).next().ok_or_else(|| self.error(contents, format!("needs a data line: {what}")))
    }

    /// All numbers of the data lines; blank fields are left out.
    pub(super) fn numbers(&self, contents: &Contents) -> Result<Vec<f64>, MeshIoError> {
        let mut all = Vec::new();
        for row in self.rows(contents) {
            all.extend(row.numbers()?);
        }
        Ok(all)
    }

    /// The value of a parameter that must be there.
    pub(super) fn require(&self, contents: &Contents, parameter: &str) -> Result<String, MeshIoError> {
        match self.keyword.value(parameter) {
            Some(value) if !value.is_empty() => Ok(value.to_owned()),
            _ => Err(self.error(contents, format!("needs the parameter {parameter}=..."))),
        }
    }

    /// A number that is the value of a parameter, if the parameter is there.
    pub(super) fn number(&self, contents: &Contents, parameter: &str) -> Result<Option<f64>, MeshIoError> {
        let Some(value) = self.keyword.value(parameter) else { return Ok(None) };
        match real(value) {
            Some(number) => Ok(Some(number)),
            None => Err(contents.error(self.keyword.place, value, format!("expected a number for {parameter}"))),
        }
    }

    /// The number of a node or element that is the value of a parameter.
    pub(super) fn node(&self, contents: &Contents, parameter: &str) -> Result<u64, MeshIoError> {
        let text = self.require(contents, parameter)?;
        let remedy = format!("expected the number of a node or element for {parameter}");
        text.parse().map_err(|_| contents.error(self.keyword.place, &text, remedy))
    }

    /// A node or a set of nodes that is the value of a parameter.
    pub(super) fn target(&self, contents: &Contents, parameter: &str) -> Result<Target, MeshIoError> {
        let text = self.require(contents, parameter)?;
        Ok(match number(&text) {
            Some((number, instance)) => Target::Number { number, instance: instance.map(str::to_owned) },
            None => Target::Set(text),
        })
    }

    pub(super) fn error(&self, contents: &Contents, remedy: impl ToString) -> MeshIoError {
        contents.error(self.keyword.place, format!("*{}", self.keyword.name), remedy)
    }
}

impl<'a> Row<'a> {
    pub fn place(&self) -> DeckPlace {
        self.at.into()
    }

    pub fn error(&self, value: impl ToString, remedy: impl ToString) -> MeshIoError {
        self.contents.error(self.at, value, remedy)
    }

    /// A field, without white space and quotes; empty if there are not so many.
    pub fn field(&self, index: usize) -> &'a str {
        unquote(fields(self.text).nth(index).unwrap_or_default())
    }

    /// A name that must be there.
    pub fn name(&self, index: usize, what: &str) -> Result<String, MeshIoError> {
        match self.field(index) {
            "" => Err(self.error(self.text, format!("expected {what}"))),
            name => Ok(name.to_owned()),
        }
    }

    /// A number, if the field is not blank.
    pub fn optional(&self, index: usize, what: &str) -> Result<Option<f64>, MeshIoError> {
        match self.field(index) {
            "" => Ok(None),
            text => real(text).map(Some).ok_or_else(|| self.error(text, format!("expected {what}, a finite number"))),
        }
    }

    /// A number that must be there.
    pub fn real(&self, index: usize, what: &str) -> Result<f64, MeshIoError> {
        self.optional(index, what)?.ok_or_else(|| self.error(self.text, format!("expected {what}")))
    }

    /// Three numbers; those that are left out are zero.
    pub fn vector(&self, first: usize, what: &str) -> Result<[f64; 3], MeshIoError> {
        let mut vector = [0.0; 3];
        for (i, component) in vector.iter_mut().enumerate() {
            *component = self.optional(first + i, what)?.unwrap_or(0.0);
        }
        Ok(vector)
    }

    /// A degree of freedom (1 to 3 are those of solids); `None` for a blank field.
    pub fn freedom(&self, index: usize) -> Result<Option<u64>, MeshIoError> {
        match self.field(index) {
            "" => Ok(None),
            text => {
                let number = text.parse().ok();
                number.map(Some).ok_or_else(|| self.error(text, "expected a degree of freedom: 1, 2 or 3 for solids"))
            }
        }
    }

    /// All numbers; blank fields are left out.
    pub fn numbers(&self) -> Result<Vec<f64>, MeshIoError> {
        let fields = fields(self.text).filter(|field| !field.is_empty());
        fields.map(|f| real(f).ok_or_else(|| self.error(f, "expected a finite number"))).collect()
    }

    /// Number of fields.
    pub fn count(&self) -> usize {
        fields(self.text).count()
    }

    /// The number of a node or element, or another whole number.
    pub fn number(&self, index: usize, what: &str) -> Result<u64, MeshIoError> {
        let text = self.field(index);
        text.parse().map_err(|_| self.error(text, format!("expected {what}, a whole number")))
    }

    /// Nodes or elements that the first field means.
    pub fn target(&self) -> Target {
        self.target_at(0)
    }

    /// Nodes or elements that a field means.
    pub fn target_at(&self, index: usize) -> Target {
        let text = fields(self.text).nth(index).unwrap_or_default();
        match number(text) {
            _ if text.is_empty() => Target::All,
            Some((number, instance)) => Target::Number { number, instance: instance.map(str::to_owned) },
            None => Target::Set(unquote(text).to_owned()),
        }
    }
}
