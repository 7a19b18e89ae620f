//! The meaning of data lines.

use stoss_mesh::Rotation;

use super::fields::{fields, number, range, reals, unquote};
use super::model::{Kind, Solid, SurfaceEntry};
use super::reader::Reader;
use super::section::KeywordBlock;
use super::sets::Labels;
use crate::MeshIoError;
use crate::lines::Lines;

impl Reader<'_> {
    pub fn data(&mut self, lines: &Lines, data: &str) -> Result<(), MeshIoError> {
        // The section is put back, changed, unless there is an error.
        let mut section = std::mem::replace(&mut self.section, KeywordBlock::Skip);
        match &mut section {
            KeywordBlock::Skip => {}
            KeywordBlock::Node { set } => self.node(lines, data, set.as_deref())?,
            KeywordBlock::Element { kind, set, pending, place } => {
                for field in fields(data.strip_suffix(',').unwrap_or(data)) {
                    if pending.is_empty() {
                        *place = lines.place();
                    }
                    if pending.len() > kind.node_count() {
                        return Err(lines.error(field, format_args!(
                            "element {} has more than {2} nodes, and {1} has {2}: give the type that it is, or one element a line",
                            pending[0], kind.name, kind.node_count()
                        )));
                    }
                    pending.push(lines.parse(Some(field), "an element or node number")?);
                }
                if let [number, nodes @ ..] = pending.as_slice()
                    && nodes.len() == kind.node_count()
                {
                    let solid = Solid { number: *number, kind: *kind, nodes: kind.ours(nodes), place: *place };
                    self.solid(solid, set.as_deref());
                    pending.clear();
                }
            }
            KeywordBlock::OtherElement { kind, set, continued } => {
                if !*continued {
                    self.other_element(lines, data, *kind, set.as_deref());
                }
                *continued = data.ends_with(',');
            }
            KeywordBlock::Set { kind, name, generate, instance } => {
                let labels = self.set_labels(lines, data, *kind, *generate, *instance)?;
                self.names().sets_mut(*kind).open(name, lines.place(), false).labels.extend(&labels);
            }
            KeywordBlock::Surface { name, nodes } => self.surface(lines, data, name, *nodes)?,
            KeywordBlock::Instance { lines: count } => {
                *count += 1;
                self.placement(lines, data, *count)?;
            }
        }
        self.section = section;
        Ok(())
    }

    fn node(&mut self, lines: &Lines, data: &str, set: Option<&str>) -> Result<(), MeshIoError> {
        let place = lines.place();
        let number = lines.parse(fields(data).next(), "a node number")?;
        let [_, x @ ..] = reals::<4>(lines, data, "a coordinate")?;
        if let Some(part) = self.part() {
            part.nodes.push((number, x, place));
            if let Some(name) = set {
                part.names.nodes.open(name, place, false).labels.numbers.entry((0, number)).or_insert(place);
            }
        }
        Ok(())
    }

    fn solid(&mut self, solid: Solid, set: Option<&str>) {
        let Solid { number, kind, place, .. } = solid;
        self.taken.entry(kind).or_insert((0, place)).0 += 1;
        if let Some(part) = self.part() {
            part.elements.push(solid);
            if let Some(name) = set {
                part.names.elements.open(name, place, false).labels.numbers.entry((0, number)).or_insert(place);
            }
        }
    }

    fn other_element(&mut self, lines: &Lines, data: &str, kind: usize, set: Option<&str>) {
        self.others[kind].count += 1;
        let place = lines.place();
        let number = fields(data).next().and_then(|n| n.parse().ok());
        if let (Some(number), Some(part)) = (number, self.part()) {
            part.others.insert(number, kind);
            if let Some(name) = set {
                part.names.elements.open(name, place, false).labels.numbers.entry((0, number)).or_insert(place);
            }
        }
    }

    /// What a line of a set means.
    fn set_labels(
        &mut self,
        lines: &Lines,
        data: &str,
        kind: Kind,
        generate: bool,
        instance: Option<usize>,
    ) -> Result<Labels, MeshIoError> {
        let mut labels = Labels::default();
        // Numbers at the assembly mean the assembly's own nodes unless an instance is named.
        let own = instance.or(if self.at_assembly() { None } else { Some(0) });
        if generate {
            let range = range(lines, data)?;
            if let Some(scope) = own {
                labels.ranges.insert((scope, range), lines.place());
            }
            return Ok(labels);
        }
        for field in fields(data).filter(|f| !f.is_empty()) {
            match number(field) {
                Some((number, named)) => {
                    let scope = named.and_then(|name| self.instance(name)).or(own);
                    if let Some(scope) = scope {
                        labels.numbers.entry((scope, number)).or_insert(lines.place());
                    }
                }
                None => {
                    let name = unquote(field);
                    let of_instance = instance.and_then(|i| {
                        let set = self.instances[i].part.names.sets(kind).find(name)?;
                        Some(set.labels.of_instance(i))
                    });
                    match of_instance {
                        Some(found) => labels.extend(&found),
                        None => labels.extend(&self.find(lines, name, kind)?),
                    }
                }
            }
        }
        Ok(labels)
    }

    fn surface(&mut self, lines: &Lines, data: &str, name: &str, nodes: bool) -> Result<(), MeshIoError> {
        let mut fields = fields(data);
        let target = fields.next().unwrap_or_default();
        let kind = if nodes { Kind::Node } else { Kind::Element };
        let own = if self.at_assembly() { None } else { Some(0) };
        let labels = match number(target) {
            Some((number, named)) => {
                let scope = named.and_then(|name| self.instance(name)).or(own);
                let numbers = scope.map(|scope| ((scope, number), lines.place()));
                Labels { numbers: numbers.into_iter().collect(), ..Labels::default() }
            }
            None => self.find(lines, unquote(target), kind)?,
        };
        let place = lines.place();
        if nodes {
            self.names().nodes.open(name, place, false).labels.extend(&labels);
        } else if let Some((_, pieces)) = self.names().surfaces.get_mut(&name.to_uppercase()) {
            let face = fields.next().unwrap_or_default().to_uppercase();
            pieces.push(SurfaceEntry { labels, face, place });
        }
        Ok(())
    }

    fn placement(&mut self, lines: &Lines, data: &str, count: usize) -> Result<(), MeshIoError> {
        let Some(instance) = self.instances.last_mut() else { return Ok(()) };
        match count {
            1 => instance.translation = reals(lines, data, "a component of the translation")?,
            2 => {
                if fields(data).filter(|f| !f.is_empty()).count() < 7 {
                    return Err(lines.error(data, "a rotation has 7 numbers: two points of the axis and degrees"));
                }
                let [ax, ay, az, bx, by, bz, degrees] = reals(lines, data, "a number of the rotation")?;
                let axis = [bx - ax, by - ay, bz - az];
                let rotation = Rotation { axis, degrees, about: [ax, ay, az] };
                if let Err(error) = rotation.matrix() {
                    return Err(lines.error(data, error));
                }
                instance.rotation = Some(rotation);
            }
            _ => return Err(lines.error(data, "an instance has at most a translation and a rotation")),
        }
        Ok(())
    }
}
