//! A table of the document: required and optional keys, and those that nobody asked for.

use super::node::Node;
use super::old;
use crate::source::join;
use crate::spelling::{known, nearest};
use std::cell::{Cell, RefCell};
use toml::de::{DeTable, DeValue};

/// A key, whether others contradict it, what is wrong then, and what to do.
pub(crate) type Contradiction = (&'static str, bool, &'static str, &'static str);

pub(crate) struct Table<'a> {
    pub(crate) node: Node<'a>,
    map: &'a DeTable<'a>,
    known: RefCell<Vec<&'static str>>,
    /// True if the remaining keys were read, whatever they are called.
    exhausted: Cell<bool>,
    /// True if [`Self::finish`] found keys that nobody asked for.
    unknown: Cell<bool>,
}

impl<'a> Node<'a> {
    pub(crate) fn table(&self) -> Option<Table<'a>> {
        self.table_like("{ key = value }")
    }

    /// A table; nothing is reported if it is something else.
    pub(crate) fn raw_table(&self) -> Option<Table<'a>> {
        match self.value {
            DeValue::Table(map) => Some(Table::new(self.clone(), map)),
            _ => None,
        }
    }

    /// A table; `example` is shown if it is something else.
    pub(crate) fn table_like(&self, example: &str) -> Option<Table<'a>> {
        self.raw_table().or_else(|| self.wrong_type("a table", example))
    }
}

impl<'a> Table<'a> {
    pub(crate) fn new(node: Node<'a>, map: &'a DeTable<'a>) -> Self {
        Self { node, map, known: RefCell::default(), exhausted: Cell::new(false), unknown: Cell::new(false) }
    }

    /// The value of a key, which is known from now on.
    pub(crate) fn get(&self, key: &'static str) -> Option<Node<'a>> {
        self.known.borrow_mut().push(key);
        self.map.get(key).map(|value| Node {
            report: self.node.report,
            value: value.get_ref(),
            span: value.span(),
            key: join(&self.node.key, key),
        })
    }

    /// The values of all keys that nobody asked for so far; none of them is unknown from now on.
    pub(crate) fn rest(&self) -> impl Iterator<Item = (&'a str, Node<'a>)> {
        self.exhausted.set(true);
        let map = self.map;
        let known = self.known.borrow().clone();
        map.iter().filter(move |(key, _)| !known.contains(&key.get_ref().as_ref())).map(|(key, value)| {
            let node = Node {
                report: self.node.report,
                value: value.get_ref(),
                span: value.span(),
                key: join(&self.node.key, key.get_ref()),
            };
            (key.get_ref().as_ref(), node)
        })
    }

    /// True if the key is there, right or wrong.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.map.get(key).is_some()
    }

    /// True if the key was asked for.
    pub(crate) fn asks(&self, key: &str) -> bool {
        self.known.borrow().contains(&key)
    }

    /// Reports a problem of a key of this table, there or not; always `None`.
    pub(crate) fn fail<T>(
        &self,
        key: &'static str,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Option<T> {
        match self.get(key) {
            Some(node) => node.fail(message, remedy),
            None => {
                let location = self.node.report.source.location(self.node.span.clone());
                let path = join(&self.node.key, key);
                self.node.report.add(location, path, "", message.into(), remedy.into());
                None
            }
        }
    }

    /// Reports that a key is missing; always `None`.
    pub(crate) fn missing<T>(&self, key: &'static str, example: &str) -> Option<T> {
        self.fail(key, "is missing", format!("add it, for instance `{example}`"))
    }

    /// A key that must be there; `example` is shown if it is not.
    pub(crate) fn required<T>(
        &self,
        key: &'static str,
        example: &str,
        read: impl FnOnce(&Node<'a>) -> Option<T>,
    ) -> Option<T> {
        match self.get(key) {
            Some(node) => read(&node),
            None => self.missing(key, example),
        }
    }

    /// A key that may be left out: `Some(None)` then, `None` if it is wrong.
    pub(crate) fn optional<T>(
        &self,
        key: &'static str,
        read: impl FnOnce(&Node<'a>) -> Option<T>,
    ) -> Option<Option<T>> {
        match self.get(key) {
            Some(node) => read(&node).map(Some),
            None => Some(None),
        }
    }

    /// A key with a default.
    pub(crate) fn default<T>(
        &self,
        key: &'static str,
        default: T,
        read: impl FnOnce(&Node<'a>) -> Option<T>,
    ) -> Option<T> {
        self.optional(key, read).map(|value| value.unwrap_or(default))
    }

    /// Elements of an array of tables (`[[key]]`); none if the key is not there. An element that is not a table is reported.
    pub(crate) fn tables(&self, key: &'static str) -> Vec<Option<Table<'a>>> {
        let Some(node) = self.get(key) else { return Vec::new() };
        if node.value.is_table() {
            let _: Option<()> = node
                .fail("must be a list of tables", format!("write [[{key}]] with double brackets instead of [{key}]"));
            return vec![None];
        }
        let elements = RefCell::new(Vec::new());
        let listed = node.list(|item| {
            elements.borrow_mut().push(item.table());
            Some(())
        });
        if listed.is_none() {
            return vec![None];
        }
        elements.into_inner()
    }

    /// Reports contradictions, of each key the first one.
    pub(crate) fn refuse(&self, contradictions: &[Contradiction]) -> Option<()> {
        let mut wrong: Vec<&str> = Vec::new();
        for &(key, contradicts, message, remedy) in contradictions {
            if contradicts && self.has(key) && !wrong.contains(&key) {
                wrong.push(key);
                let _: Option<()> = self.fail(key, message, remedy);
            }
        }
        wrong.is_empty().then_some(())
    }

    /// True if a key is not known, so that it may be meant for one that is not there. Known after [`Self::finish`].
    pub(crate) fn has_unknown_key(&self) -> bool {
        self.unknown.get()
    }

    /// Reports every key that nobody asked for. Of a key that is likely meant for one that is not there only this is reported.
    pub(crate) fn finish(&self) {
        if self.exhausted.get() {
            return;
        }
        let known_keys = self.known.borrow();
        for (key, _) in self.map.iter() {
            if !known_keys.contains(&key.get_ref().as_ref()) {
                let location = self.node.report.source.location(key.span());
                let path = join(&self.node.key, key.get_ref());
                let mut keys: Vec<&str> = known_keys.clone();
                keys.sort_unstable();
                keys.dedup();
                let (message, remedy) = match old::key(&path) {
                    Some((message, remedy)) => (message, remedy.to_owned()),
                    None => {
                        let meant = nearest(key.get_ref(), keys.iter().copied());
                        if let Some(meant) = meant.filter(|meant| self.map.get(*meant).is_none()) {
                            self.node.report.withdraw(&join(&self.node.key, meant));
                        }
                        ("is an unknown key", known(key.get_ref(), keys))
                    }
                };
                self.unknown.set(true);
                self.node.report.add(location, path, "", message.into(), remedy);
            }
        }
    }
}
