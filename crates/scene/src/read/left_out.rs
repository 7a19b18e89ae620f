//! Reads `[[left_out]]`.

use super::Node;
use super::table::Table;
use crate::{LeftOut, Omission};

pub(super) fn left_out(table: &Table<'_>) -> Option<LeftOut> {
    let severity = table
        .required("severity", "severity = \"missing\"", |n: &Node<'_>| n.choice(Omission::NAMES, Omission::from_name));
    let keyword = table.required("keyword", "keyword = \"*COUPLING\"", Node::text);
    let line = table.optional("line", Node::text);
    let text = table.required("text", "text = \"its nodes are not coupled\"", Node::text);
    table.finish();
    Some(LeftOut { severity: severity?, keyword: keyword?, line: line?, text: text? })
}
