//! Where the keys of a scene stand in its file.

use crate::SetExpression;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A place in the scene's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Byte range.
    pub span: Range<usize>,
}

/// File name, text and the places of all keys by path. Two sources always compare equal, so that scenes compare by meaning and not
/// by layout.
#[derive(Clone, Debug, Default)]
pub(crate) struct Source {
    pub(crate) file: String,
    pub(crate) text: String,
    /// Byte offset at which each line starts.
    line_starts: Vec<usize>,
    /// Span of the value of every key path.
    spans: BTreeMap<String, Range<usize>>,
    /// Expressions over sets, each after those that it uses.
    pub(crate) expressions: Vec<SetExpression>,
}

impl PartialEq for Source {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Source {
    pub(crate) fn new(text: &str, file: &str) -> Self {
        let line_starts = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        Self {
            file: file.to_owned(),
            text: text.to_owned(),
            line_starts,
            spans: BTreeMap::new(),
            expressions: Vec::new(),
        }
    }

    /// Expressions without a text.
    pub(crate) fn of_expressions(expressions: Vec<SetExpression>) -> Self {
        Self { expressions, ..Self::default() }
    }

    /// Records the span of every value below `table`.
    pub(crate) fn index(&mut self, table: &DeTable<'_>) {
        self.index_table(table, "");
    }

    fn index_table(&mut self, table: &DeTable<'_>, path: &str) {
        for (key, value) in table {
            self.index_value(value.get_ref(), value.span(), join(path, key.get_ref()));
        }
    }

    fn index_value(&mut self, value: &DeValue<'_>, span: Range<usize>, path: String) {
        match value {
            DeValue::Table(table) => self.index_table(table, &path),
            DeValue::Array(array) => {
                for (i, item) in array.iter().enumerate() {
                    self.index_value(item.get_ref(), item.span(), element(&path, i));
                }
            }
            _ => {}
        }
        self.spans.insert(path, span);
    }

    pub(crate) fn slice(&self, span: &Range<usize>) -> &str {
        self.text.get(span.clone()).unwrap_or_default()
    }

    /// Line and column of a byte range; ranges beyond the text are moved to its end.
    pub(crate) fn location(&self, span: Range<usize>) -> Location {
        let mut start = span.start.min(self.text.len());
        while !self.text.is_char_boundary(start) {
            start -= 1;
        }
        let line = self.line_starts.partition_point(|&s| s <= start).max(1);
        let line_start = self.line_starts.get(line - 1).copied().unwrap_or(0);
        let column = 1 + self.text.get(line_start..start).map_or(0, |s| s.chars().count());
        Location { line, column, span: start..span.end.clamp(start, self.text.len()) }
    }

    /// Place of a key, if it stands in the file.
    pub(crate) fn locate(&self, key: &str) -> Option<Location> {
        self.spans.get(key).map(|span| self.location(span.clone()))
    }

    /// Place of a key, or of the nearest table around it, or the start of the file.
    pub(crate) fn locate_nearest(&self, key: &str) -> Location {
        let mut path = key;
        loop {
            if let Some(location) = self.locate(path) {
                return location;
            }
            match path.rfind(['.', '[']) {
                Some(i) => path = &path[..i],
                None => return self.location(0..0),
            }
        }
    }
}

/// `path.key`.
pub(crate) fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// `path[index]`.
pub(crate) fn element(path: &str, index: usize) -> String {
    format!("{path}[{index}]")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_characters() {
        let source = Source::new("a = 1\nä = 2\n", "x");
        let start = source.text.find('2').unwrap();
        let location = source.location(start..start + 1);
        assert_eq!((location.line, location.column), (2, 5));
        let end = source.location(1000..2000);
        assert_eq!((end.line, end.column, end.span), (3, 1, 13..13));
    }

    #[test]
    fn keys_are_found_by_path() {
        let text = "[[body]]\nname = \"a\"\n[[body]]\nname = \"b\"\nsize = [1, [2, 3]]\n";
        let table = DeTable::parse(text).unwrap();
        let mut source = Source::new(text, "x");
        source.index(table.get_ref());
        assert_eq!(source.locate("body[1].name").unwrap().line, 4);
        assert_eq!(source.slice(&source.locate("body[1].size[1][0]").unwrap().span), "2");
        assert_eq!(source.locate("body[2]"), None);
        assert_eq!(source.locate("body[1]").unwrap().line, 3);
        assert_eq!(source.locate_nearest("body[1].size[1][7]"), source.locate("body[1].size[1]").unwrap());
        assert_eq!(source.locate_nearest("nowhere.at.all").line, 1);
    }
}
