//! The sections of binary MSH files of both versions.

use std::path::Path;

use super::binary::Bytes;
use super::{EMPTY, PARTITIONED, SAVE, State, cells, is_new};
use crate::{Contents, MeshIoError};

/// Reads a binary file.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Contents, MeshIoError> {
    let mut file = Bytes::new(path, bytes);
    file.expect("$MeshFormat")?;
    let place = file.place();
    let format = file.expect("version, file type and data size")?;
    let tokens: Vec<&str> = format.split_whitespace().collect();
    let version = tokens.first().copied().unwrap_or_default();
    let Some(new) = is_new(version) else {
        return Err(file.error(place, format!("MSH version {version}"), SAVE));
    };
    file.size = match tokens.get(2).copied() {
        Some("8") => 8,
        Some("4") if new => 4,
        _ => return Err(file.error(place, format, "expected version, file type and data size (8; of MSH 4.1 also 4)")),
    };
    let place = file.place();
    let one = file.int("the number 1")?;
    if one == 1_i32.swap_bytes() {
        file.big_endian = true;
    } else if one != 1 {
        return Err(file.error(place, one, "expected the number 1, from which the byte order follows"));
    }
    file.end("MeshFormat")?;
    let order = if file.big_endian { "big-endian" } else { "little-endian" };
    let mut state = State::new(path, format!("Gmsh MSH {version}, binary, {order}"));
    state.builder.contents.binary = true;

    let (mut nodes, mut elements) = (false, false);
    loop {
        let place = file.place();
        let Some(line) = file.line() else { break };
        let Some(section) = line.strip_prefix('$') else {
            let line: String = line.chars().take(20).collect();
            return Err(file.error(place, format!("{line:?}"), "expected the beginning of a section, such as $Nodes"));
        };
        match section {
            "PhysicalNames" => names(&mut file, &mut state)?,
            "Entities" if new => entities(&mut file, &mut state)?,
            "PartitionedEntities" => return Err(file.error(place, "a partitioned mesh", PARTITIONED)),
            "Nodes" => {
                nodes = true;
                if new { nodes_4(&mut file, &mut state)? } else { nodes_2(&mut file, &mut state)? }
            }
            "Elements" => {
                if !nodes {
                    return Err(file.error(place, "$Elements", "$Nodes must come before $Elements"));
                }
                elements = true;
                if new { elements_4(&mut file, &mut state)? } else { elements_2(&mut file, &mut state)? }
            }
            _ => {
                file.skip(section)?;
                continue;
            }
        }
        file.end(section)?;
    }
    if !elements {
        return Err(file.error(file.place(), "end of file", EMPTY));
    }
    state.finish()
}

/// A line with a count.
fn count(file: &mut Bytes, what: &str) -> Result<u64, MeshIoError> {
    let place = file.place();
    let line = file.expect(what)?;
    line.parse().map_err(|_| file.error(place, format!("{line:?}"), format!("expected {what}")))
}

/// `$PhysicalNames` is text.
fn names(file: &mut Bytes, state: &mut State) -> Result<(), MeshIoError> {
    for _ in 0..count(file, "the number of names")? {
        let place = file.place();
        let line = file.expect("dimension, number and name of a physical group")?;
        match super::physical_name(&line) {
            Some((dimension, group, name)) => drop(state.names.insert((dimension, group), name)),
            None => return Err(file.error(place, format!("{line:?}"), super::PHYSICAL_NAME)),
        }
    }
    Ok(())
}

fn coordinates(file: &mut Bytes) -> Result<[f64; 3], MeshIoError> {
    let mut x = [0.0; 3];
    for c in &mut x {
        *c = file.double("a coordinate")?;
    }
    Ok(x)
}

/// MSH 2.2: a line with the count, then int and three doubles a node.
fn nodes_2(file: &mut Bytes, state: &mut State) -> Result<(), MeshIoError> {
    let place = file.place();
    let count = count(file, "the number of nodes")?;
    file.room(place, count, 28, "nodes")?;
    for _ in 0..count {
        let place = file.place();
        let number = file.natural("a node number")?;
        let x = coordinates(file)?;
        state.builder.node(number, x, place)?;
    }
    Ok(())
}

/// MSH 2.2: a line with the count, then blocks: type, elements in it, number of tags, and for each element number, tags, nodes.
fn elements_2(file: &mut Bytes, state: &mut State) -> Result<(), MeshIoError> {
    let mut left = count(file, "the number of elements")?;
    let mut nodes = Vec::with_capacity(8);
    while left > 0 {
        let place = file.place();
        let kind = file.natural("an element type")? as u32;
        let count = file.natural("a number of elements")?;
        let tags = file.natural("a number of tags")?;
        if count == 0 || count > left {
            return Err(file.error(place, format!("{count} elements in a block"), format!("expected 1 to {left}")));
        }
        left -= count;
        let per_element = known_count(file, place, kind)?;
        for _ in 0..count {
            let place = file.place();
            let number = file.natural("an element number")?;
            file.room(place, tags, 4, "tags")?;
            let mut group = None;
            for tag in 0..tags {
                let value = i64::from(file.int("a tag")?);
                if tag == 0 && value != 0 {
                    group = Some(value.saturating_abs());
                }
            }
            nodes.clear();
            for _ in 0..per_element {
                nodes.push(file.natural("a node number")?);
            }
            state.element(number, kind, group.as_slice(), &nodes, place)?;
        }
    }
    Ok(())
}

fn known_count(file: &Bytes, place: crate::place::FileLocation, kind: u32) -> Result<usize, MeshIoError> {
    cells::node_count(kind).ok_or_else(|| {
        file.error(place, format!("element type {kind}"), "not known: in Gmsh set Mesh.ElementOrder = 1 or 2")
    })
}

/// MSH 4.1: for each entity its number, bounding box, physical groups and, but for points, its boundary.
fn entities(file: &mut Bytes, state: &mut State) -> Result<(), MeshIoError> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = file.size("a number of entities")?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let number = i64::from(file.int("an entity number")?);
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                file.double("a coordinate of the entity")?;
            }
            let mut groups = Vec::new();
            for _ in 0..file.size("the number of physical groups")? {
                groups.push(i64::from(file.int("the number of a physical group")?).saturating_abs());
            }
            if dimension > 0 {
                for _ in 0..file.size("a number of bounding entities")? {
                    file.int("a bounding entity")?;
                }
            }
            state.groups.insert((dimension, number), groups);
        }
    }
    Ok(())
}

/// The first four numbers of a section: blocks, items, smallest and largest number.
fn header(file: &mut Bytes) -> Result<u64, MeshIoError> {
    let blocks = file.size("a number of blocks")?;
    for _ in 0..3 {
        file.size("a number of items, smallest and largest number")?;
    }
    Ok(blocks)
}

/// MSH 4.1: blocks of node numbers, then their coordinates, and parametric ones if the entity has them.
fn nodes_4(file: &mut Bytes, state: &mut State) -> Result<(), MeshIoError> {
    let mut numbers = Vec::new();
    for _ in 0..header(file)? {
        let place = file.place();
        let dimension = file.natural("a dimension")?;
        file.int("an entity number")?;
        let parametric = file.int("0 or 1 for parametric coordinates")?;
        if dimension > 3 || !(0..=1).contains(&parametric) {
            let value = format!("dimension {dimension}, parametric {parametric}");
            return Err(file.error(
                place,
                value,
                "expected a dimension (0 to 3) and 0 or 1 for parametric coordinates",
            ));
        }
        let count = file.size("the number of nodes in the block")?;
        file.room(place, count, file.size + 24, "nodes")?;
        numbers.clear();
        for _ in 0..count {
            let place = file.place();
            numbers.push((file.size("a node number")?, place));
        }
        for &(number, place) in &numbers {
            let x = coordinates(file)?;
            for _ in 0..if parametric == 1 { dimension } else { 0 } {
                file.double("a parametric coordinate")?;
            }
            state.builder.node(number, x, place)?;
        }
    }
    Ok(())
}

/// MSH 4.1: blocks of elements of one type on one entity.
fn elements_4(file: &mut Bytes, state: &mut State) -> Result<(), MeshIoError> {
    let mut nodes = Vec::with_capacity(8);
    for _ in 0..header(file)? {
        let place = file.place();
        let dimension = file.natural("a dimension")? as usize;
        let entity = i64::from(file.int("an entity number")?);
        let kind = file.natural("an element type")? as u32;
        let count = file.size("the number of elements in the block")?;
        let per_element = known_count(file, place, kind)?;
        file.room(place, count, file.size * (1 + per_element), "elements")?;
        let groups = state.groups.get(&(dimension, entity)).cloned().unwrap_or_default();
        for _ in 0..count {
            let place = file.place();
            let number = file.size("an element number")?;
            nodes.clear();
            for _ in 0..per_element {
                nodes.push(file.size("a node number")?);
            }
            state.element(number, kind, &groups, &nodes, place)?;
        }
    }
    Ok(())
}
