//! Reads `[parameters]` and evaluates expressions in place of numbers.

use crate::expression::{self, ExpressionError, Name};
use crate::read::{Node, PARAMETERS as TABLE, Parameters, Report, complaint};
use crate::source::join;
use crate::spelling::known;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use toml::de::{DeTable, DeValue};

/// Longest chain of parameters that use each other.
const CHAIN: usize = 100;

/// Reads the parameters of a document; those in `overrides` (name, expression) have these values instead.
pub(crate) fn read(report: &Report<'_>, root: &DeTable<'_>, overrides: &[(String, String)]) -> Parameters {
    let mut parameters = Parameters::new();
    let table = match root.get(TABLE) {
        None => None,
        Some(value) => match value.get_ref() {
            DeValue::Table(table) => Some((table, value.span())),
            // Reported with the other keys of the document.
            _ => return parameters,
        },
    };
    let empty = DeTable::default();
    let (map, span) = table.unwrap_or((&empty, 0..0));
    for (k, (name, expression)) in overrides.iter().enumerate() {
        if let Some((_, first)) = overrides[..k].iter().find(|(known, _)| known == name) {
            let message = format!("`--set {name}={first}` and `--set {name}={expression}`: it is given twice");
            let remedy = "remove one of the two".to_owned();
            report.add(report.source.location(span.clone()), join(TABLE, name), "", message, remedy);
        }
        if map.get(name.as_str()).is_none() {
            let names: Vec<&str> = map.keys().map(|key| key.get_ref().as_ref()).collect();
            let remedy = if names.is_empty() {
                format!("add `[{TABLE}]` with `{name} = 1.0`, and use it in the scene as \"{name}\"")
            } else {
                known(name, names)
            };
            let message = format!("`--set {name}={expression}`: the scene has no parameter of this name");
            report.add(report.source.location(span.clone()), join(TABLE, name), "", message, remedy);
        }
    }
    // A parameter may use others wherever they stand: each is evaluated when it is first asked for.
    let reader = Reader { report, map, overrides, done: RefCell::default(), open: RefCell::default() };
    for key in map.keys() {
        reader.value(key.get_ref());
    }
    parameters.extend(reader.done.into_inner());
    parameters
}

struct Reader<'a> {
    report: &'a Report<'a>,
    map: &'a DeTable<'a>,
    overrides: &'a [(String, String)],
    done: RefCell<Parameters>,
    /// Names of the parameters that are being evaluated.
    open: RefCell<BTreeSet<String>>,
}

impl Reader<'_> {
    /// The value of a parameter, evaluated once. What is wrong is reported once.
    fn value(&self, name: &str) -> Name {
        if let Some(value) = self.done.borrow().get(name) {
            return value.map_or(Name::Wrong, Name::Value);
        }
        let Some((key, value)) = self.map.get_key_value(name) else { return Name::Unknown };
        let node = Node { report: self.report, value: value.get_ref(), span: value.span(), key: join(TABLE, name) };
        if !self.open.borrow_mut().insert(name.to_owned()) {
            let _: Option<()> = node.fail("depends on itself, in a cycle", "give one of these parameters a number");
            self.done.borrow_mut().insert(name.to_owned(), None);
            return Name::Wrong;
        }
        let value = if self.open.borrow().len() > CHAIN {
            node.fail(format!("depends on a chain of more than {CHAIN} other parameters"), "give one of them a number")
        } else if expression::is_parameter_name(name) {
            self.read(name, &node)
        } else {
            let at = Node { span: key.span(), ..node };
            at.fail(
                "cannot be the name of a parameter",
                "use a letter, then letters, digits and `_`, and neither a coordinate (`x`, `y`, `z`) nor `pi` nor a function",
            )
        };
        self.open.borrow_mut().remove(name);
        // One of a circle is wrong already.
        let value = *self.done.borrow_mut().entry(name.to_owned()).or_insert(value);
        value.map_or(Name::Wrong, Name::Value)
    }

    fn read(&self, name: &str, node: &Node<'_>) -> Option<f64> {
        let text = match (self.overrides.iter().find(|(set, _)| set == name), node.value) {
            (Some((_, text)), _) => text.as_str(),
            (None, DeValue::String(text)) => text.as_ref(),
            (None, _) => return node.number(),
        };
        match expression::evaluate(text, &|other| self.value(other)) {
            Ok(value) => Some(value),
            Err(ExpressionError::Reported) => None,
            Err(error) => {
                let all = self.map.keys().map(|key| (key.get_ref().to_string(), None)).collect();
                let (message, remedy) = complaint(&error, &all)?;
                let set = self.overrides.iter().any(|(set, _)| set == name);
                let message = if set { format!("`--set {name}={text}`: {message}") } else { message };
                node.fail(message, remedy)
            }
        }
    }
}

/// The values of the table, which [`read`] has evaluated; `None` if one is wrong, which is reported.
pub(crate) fn values(node: &Node<'_>) -> Option<BTreeMap<String, f64>> {
    let table = node.table_like("{ radius = 0.5 }")?;
    let parameters = &node.report.parameters;
    table.rest().map(|(name, _)| Some((name.to_owned(), (*parameters.get(name)?)?))).collect()
}
