//! Reads `[sets]`, and expressions in place of references to sets.

use crate::SetExpression;
use crate::expression::{Name, is_parameter_name};
use crate::read::{Node, Table, is_name};
use crate::set_parser::{self, Known, SetError, is_expression};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Words of expressions that are no names of sets.
const WORDS: [&str; 6] = ["x", "y", "z", "nearest", "normal", "ground"];

/// The names of `[sets]`, and the expressions found so far: each after those that it uses.
pub(crate) struct Sets<'a> {
    /// Names of the parts, and what those are that have no nodes to choose from.
    parts: Vec<(String, Option<&'static str>)>,
    /// False if there may be others.
    parts_complete: bool,
    named: BTreeMap<String, Node<'a>>,
    /// The part of each name that was read; `None` if it is wrong, which is reported.
    done: RefCell<BTreeMap<String, Option<String>>>,
    /// Names that are being read.
    open: RefCell<BTreeSet<String>>,
    list: RefCell<Vec<SetExpression>>,
}

impl<'a> Sets<'a> {
    /// The table's names, not yet read.
    pub(crate) fn new(root: &Table<'a>, parts: Vec<(String, Option<&'static str>)>, parts_complete: bool) -> Self {
        let table = root.get("sets").and_then(|node| node.table_like("{ left = \"block.all & x < 0.5\" }"));
        let named = table.iter().flat_map(|table| table.rest()).map(|(name, node)| (name.to_owned(), node)).collect();
        let (done, open, list) = Default::default();
        Self { parts, parts_complete, named, done, open, list }
    }

    /// Whether a set of a part is an expression or has its name from `[sets]`.
    pub(crate) fn contains(&self, part: &str, name: &str) -> bool {
        self.list.borrow().iter().any(|set| set.part == part && set.name == name)
    }

    /// The expressions, each after those that it uses.
    pub(crate) fn into_list(self) -> Vec<SetExpression> {
        self.list.into_inner()
    }

    /// The texts of `[sets]`.
    pub(crate) fn texts(&self) -> Option<BTreeMap<String, String>> {
        let good = self.done.borrow().values().all(Option::is_some);
        let text = |(name, node): (&String, &Node<'_>)| Some((name.clone(), node.string_value()?.to_owned()));
        if good { self.named.iter().map(text).collect() } else { None }
    }

    /// Reads all of `[sets]`; what is wrong is reported once.
    pub(crate) fn read(&self) {
        for name in self.named.keys() {
            self.part_of(name);
        }
    }

    /// The part of a name of `[sets]`; see [`Known::named`].
    fn part_of(&self, name: &str) -> Option<Option<String>> {
        let node = self.named.get(name)?;
        if let Some(done) = self.done.borrow().get(name) {
            return Some(done.clone());
        }
        let part = if self.open.borrow_mut().insert(name.to_owned()) {
            let part = self.name_allowed(name, node).and_then(|()| node.text()).and_then(|text| {
                let (part, region) = self.parse(node, &text)?;
                let set = SetExpression { part: part.clone(), name: name.to_owned(), key: node.key.clone(), region };
                // A circle is reported at its second entry.
                let whole = !self.done.borrow().contains_key(name);
                if whole {
                    self.list.borrow_mut().push(set);
                }
                whole.then_some(part)
            });
            self.open.borrow_mut().remove(name);
            part
        } else {
            node.fail("depends on itself, in a cycle", "define one of them by sets of its part only")
        };
        Some(self.done.borrow_mut().entry(name.to_owned()).or_insert(part).clone())
    }

    fn name_allowed(&self, name: &str, node: &Node<'_>) -> Option<()> {
        let what = if !is_name(name) || !is_parameter_name(&name.replace('-', "_")) || WORDS.contains(&name) {
            "cannot be the name of a set"
        } else if node.report.parameters.contains_key(name) {
            "is the name of a parameter"
        } else if self.parts.iter().any(|(part, _)| part == name) {
            "is the name of a part"
        } else {
            return Some(());
        };
        node.fail(
            format!("`{name}` {what}"),
            "use a letter, then letters, digits, `-` and `_`, and no other word of the scene",
        )
    }

    /// A reference as the scene keeps it, `part.set`: of an expression the set is its text, of a name of `[sets]` that name.
    pub(crate) fn reference(&self, node: &Node<'_>) -> Option<String> {
        let text = node.text()?;
        if let Some(part) = self.part_of(text.trim()) {
            return Some(format!("{}.{}", part?, text.trim()));
        }
        if !is_expression(&text) {
            return Some(text);
        }
        let text = text.trim();
        let (part, region) = self.parse(node, text)?;
        let name = text.strip_prefix(&part).and_then(|rest| rest.strip_prefix('.'));
        let name = name.map_or_else(|| format!("({text})"), str::to_owned);
        if let Some((_, Some(noun))) = self.parts.iter().find(|(known, _)| *known == part) {
            let message = format!("`{part}` is {noun}, which has no nodes to choose from");
            return node.fail(message, format!("write \"{part}.all\""));
        }
        if !self.contains(&part, &name) {
            let set = SetExpression { part: part.clone(), name: name.clone(), key: node.key.clone(), region };
            self.list.borrow_mut().push(set);
        }
        Some(format!("{part}.{name}"))
    }

    fn parse(&self, node: &Node<'_>, text: &str) -> Option<(String, crate::SetRegion)> {
        let known = Known {
            parts: self.parts.iter().map(|(part, _)| part.as_str()).collect(),
            parts_complete: self.parts_complete,
            named: &|name| self.part_of(name),
            names: self.named.keys().map(String::as_str).collect(),
            parameters: &|name| match node.report.parameters.get(name) {
                Some(Some(value)) => Name::Value(*value),
                Some(None) => Name::Wrong,
                None => Name::Unknown,
            },
        };
        match set_parser::parse(text, &known) {
            Ok(parsed) => Some(parsed),
            Err(SetError::Reported) => None,
            Err(SetError::Wrong(message, remedy, 0)) => node.fail(message, remedy),
            Err(SetError::Wrong(message, remedy, at)) => {
                let character = 1 + text.get(..at).map_or(0, |before| before.chars().count());
                node.fail(format!("character {character}: {message}"), remedy)
            }
        }
    }
}
