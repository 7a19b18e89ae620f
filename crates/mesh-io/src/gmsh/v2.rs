//! The sections of MSH 2.2.

use super::State;
use crate::MeshIoError;
use crate::lines::Lines;

/// `$Nodes`: count, then `number x y z`.
pub(super) fn nodes(lines: &mut Lines, state: &mut State) -> Result<(), MeshIoError> {
    let line = lines.expect("the number of nodes")?;
    let count: usize = lines.parse(Some(line), "the number of nodes")?;
    for _ in 0..count {
        let mut tokens = lines.expect("a node: number x y z")?.split_whitespace();
        let number = lines.parse(tokens.next(), "a node number")?;
        let mut x = [0.0; 3];
        for c in &mut x {
            *c = lines.parse_real(tokens.next(), "a coordinate")?;
        }
        state.builder.node(number, x, lines.place())?;
    }
    Ok(())
}

/// `$Elements`: count, then `number type tags... nodes...`, the first tag being the physical group.
pub(super) fn elements(lines: &mut Lines, state: &mut State) -> Result<(), MeshIoError> {
    let line = lines.expect("the number of elements")?;
    let count: usize = lines.parse(Some(line), "the number of elements")?;
    let mut nodes = Vec::with_capacity(8);
    for _ in 0..count {
        let line = lines.expect("an element: number, type, number of tags, tags, nodes")?;
        let mut tokens = line.split_whitespace();
        let number = lines.parse(tokens.next(), "an element number")?;
        let kind = lines.parse(tokens.next(), "an element type")?;
        let tags: usize = lines.parse(tokens.next(), "the number of tags")?;
        let mut group = None;
        for tag in 0..tags {
            let value: i64 = lines.parse(tokens.next(), "a tag")?;
            if tag == 0 && value != 0 {
                group = Some(value.saturating_abs());
            }
        }
        nodes.clear();
        for token in tokens {
            nodes.push(lines.parse(Some(token), "a node number")?);
        }
        if let Some(wanted) = super::cells::node_count(kind).filter(|&wanted| wanted != nodes.len()) {
            return Err(lines.error(line, format!("an element of type {kind} has {wanted} nodes, not {}", nodes.len())));
        }
        state.element(number, kind, group.as_slice(), &nodes, lines.place())?;
    }
    Ok(())
}
