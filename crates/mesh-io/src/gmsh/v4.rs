//! The sections of MSH 4.1.

use super::State;
use crate::MeshIoError;
use crate::lines::Lines;

/// `$Entities`: for each entity its number, bounding box and physical groups.
pub(super) fn entities(lines: &mut Lines, state: &mut State) -> Result<(), MeshIoError> {
    let mut tokens = lines.expect("numbers of points, curves, surfaces and volumes")?.split_whitespace();
    let mut counts = [0usize; 4];
    for count in &mut counts {
        *count = lines.parse(tokens.next(), "a number of entities")?;
    }
    for (dimension, &count) in counts.iter().enumerate() {
        for _ in 0..count {
            let mut tokens = lines.expect("an entity")?.split_whitespace();
            let number: i64 = lines.parse(tokens.next(), "an entity number")?;
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                lines.parse::<f64>(tokens.next(), "a coordinate of the entity")?;
            }
            let physical: usize = lines.parse(tokens.next(), "the number of physical groups")?;
            let mut groups = Vec::new();
            for _ in 0..physical {
                // the sign is that of the orientation
                let group: i64 = lines.parse(tokens.next(), "the number of a physical group")?;
                groups.push(group.saturating_abs());
            }
            state.groups.insert((dimension, number), groups);
        }
    }
    Ok(())
}

/// `$Nodes`: blocks of node numbers, then their coordinates.
pub(super) fn nodes(lines: &mut Lines, state: &mut State) -> Result<(), MeshIoError> {
    let blocks = header(lines, "blocks of nodes")?;
    let mut numbers: Vec<u64> = Vec::new();
    for _ in 0..blocks {
        let mut tokens = lines.expect("a block of nodes: dimension, entity, parametric, count")?.split_whitespace();
        lines.parse::<usize>(tokens.next(), "a dimension")?;
        lines.parse::<i64>(tokens.next(), "an entity number")?;
        lines.parse::<u8>(tokens.next(), "0 or 1 for parametric coordinates")?;
        let count: usize = lines.parse(tokens.next(), "the number of nodes in the block")?;
        numbers.clear();
        for _ in 0..count {
            let line = lines.expect("a node number")?;
            numbers.push(lines.parse(Some(line), "a node number")?);
        }
        for &number in &numbers {
            let mut tokens = lines.expect("coordinates x y z")?.split_whitespace();
            let mut x = [0.0; 3];
            for c in &mut x {
                *c = lines.parse_real(tokens.next(), "a coordinate")?;
            }
            state.builder.node(number, x, lines.place())?;
        }
    }
    Ok(())
}

/// `$Elements`: blocks of elements of one type on one entity, each `number nodes...`.
pub(super) fn elements(lines: &mut Lines, state: &mut State) -> Result<(), MeshIoError> {
    let blocks = header(lines, "blocks of elements")?;
    let mut nodes = Vec::with_capacity(8);
    for _ in 0..blocks {
        let mut tokens = lines.expect("a block of elements: dimension, entity, type, count")?.split_whitespace();
        let dimension: usize = lines.parse(tokens.next(), "a dimension")?;
        let entity: i64 = lines.parse(tokens.next(), "an entity number")?;
        let kind: u32 = lines.parse(tokens.next(), "an element type")?;
        let count: usize = lines.parse(tokens.next(), "the number of elements in the block")?;
        let groups = state.groups.get(&(dimension, entity)).cloned().unwrap_or_default();
        for _ in 0..count {
            let line = lines.expect("an element: number, nodes")?;
            let mut tokens = line.split_whitespace();
            let number = lines.parse(tokens.next(), "an element number")?;
            nodes.clear();
            for token in tokens {
                nodes.push(lines.parse(Some(token), "a node number")?);
            }
            if let Some(wanted) = super::cells::node_count(kind).filter(|&wanted| wanted != nodes.len()) {
                let remedy = format!("an element of type {kind} has {wanted} nodes, not {}", nodes.len());
                return Err(lines.error(line, remedy));
            }
            state.element(number, kind, &groups, &nodes, lines.place())?;
        }
    }
    Ok(())
}

/// The first line of a section: number of blocks, number of items, smallest and largest number.
fn header(lines: &mut Lines, what: &str) -> Result<usize, MeshIoError> {
    let mut tokens = lines.expect(what)?.split_whitespace();
    let blocks = lines.parse(tokens.next(), &format!("the number of {what}"))?;
    for _ in 0..3 {
        lines.parse::<u64>(tokens.next(), "a number: blocks, items, smallest and largest number")?;
    }
    Ok(blocks)
}
