//! The way from parts, instances and names to [`Contents`].

use std::collections::{BTreeMap, BTreeSet};

use super::model::{Instance, Names, Solid};
use super::reader::Reader;
use super::sets::{Labels, Set};
use super::types::{advice, known};
use crate::build::Builder;
use crate::contents::{Other, entry};
use crate::{Contents, MeshIoError};

/// The elements that labels mean.
#[derive(Default)]
struct Found {
    solids: Vec<u32>,
    /// Types of the others.
    others: BTreeSet<usize>,
}

struct Flatten {
    builder: Builder,
    instances: Vec<Instance>,
    /// Where the types of other elements begin in [`Contents::others`].
    first_other: usize,
}

impl Reader<'_> {
    /// Adds the elements of other types, and notes on those that are read as others, to [`Contents`].
    pub fn count_others(&mut self) {
        for other in &self.others {
            self.contents.others.push(Other {
                what: format!("elements {}", other.name),
                count: other.count,
                first: other.first,
                groups: Some(BTreeSet::new()),
                remedy: format!("Stoss computes with {}; {}", known(), advice(&other.name)),
            });
        }
        for (kind, (count, place)) in &self.taken {
            if let Some(note) = kind.note() {
                let first = self.contents.place_name(*place);
                self.contents.notes.push(format!("{note} ({count} elements, first in {first})"));
            }
        }
    }

    pub fn flatten(mut self) -> Result<Contents, MeshIoError> {
        let explicit = !self.instances.is_empty();
        let as_it_is = |part| Instance { name: String::new(), part, translation: [0.0; 3], rotation: None };
        let mut parts = self.parts.into_iter();
        let outside = parts.next().unwrap_or_default();
        if outside.size() > 0 {
            self.instances.push(as_it_is(outside));
        }
        if !explicit {
            self.instances.extend(parts.map(|part| Instance { name: part.name.clone(), ..as_it_is(part) }));
        }
        let first_other = self.contents.others.len() - self.others.len();
        let mut flatten = Flatten { builder: Builder::new(self.contents), instances: self.instances, first_other };
        if let Err(error) = flatten.all(&self.assembly) {
            // Elements of another type are the cause of whatever else may be wrong.
            flatten.builder.contents.refuse_others(None)?;
            return Err(error);
        }
        let mut contents = flatten.builder.finish();
        // What no element belongs to is no matter: an element type without elements.
        contents.others.retain(|o| o.count > 0);
        Ok(contents)
    }
}

impl Flatten {
    fn all(&mut self, assembly: &Names) -> Result<(), MeshIoError> {
        let instances = std::mem::take(&mut self.instances);
        let single = instances.len() == 1;
        for (i, instance) in instances.iter().enumerate() {
            if i > 0 {
                self.builder.open_scope();
            }
            self.place(instance)?;
        }
        self.instances = instances;
        for i in 0..self.instances.len() {
            let names = std::mem::take(&mut self.instances[i].part.names);
            let name = self.instances[i].name.clone();
            self.refuse_ambiguous(&names, if single { Some(assembly) } else { None }, i)?;
            let prefix = if single || name.is_empty() { String::new() } else { format!("{name}.") };
            self.names(&names, &prefix, Some(i), if single { Some(assembly) } else { None })?;
            if !name.is_empty() {
                self.instance_group(&name, i);
            }
        }
        self.names(assembly, "", None, None)
    }

    /// Nodes (translation, then rotation) and elements of an instance.
    fn place(&mut self, instance: &Instance) -> Result<(), MeshIoError> {
        let t = instance.translation;
        let rotation = match &instance.rotation {
            None => None,
            Some(rotation) => {
                let wrap = |source| MeshIoError::Mesh { path: self.builder.contents.path().to_owned(), source };
                Some((rotation.matrix().map_err(wrap)?, rotation.about))
            }
        };
        for &(number, x, place) in &instance.part.nodes {
            let y: [f64; 3] = std::array::from_fn(|i| x[i] + t[i]);
            let y = match &rotation {
                None => y,
                Some((r, p)) => std::array::from_fn(|i| p[i] + (0..3).map(|j| r[i][j] * (y[j] - p[j])).sum::<f64>()),
            };
            self.builder.node(number, y, place)?;
        }
        for Solid { number, kind, nodes, place } in &instance.part.elements {
            match kind.plane {
                Some(face) => self.builder.plane_element(*number, face, nodes, kind.name, *place)?,
                None => self.builder.element(*number, kind.kind, nodes, kind.name, *place)?,
            };
            self.builder.contents.element_types.push(kind.name);
        }
        Ok(())
    }

    /// Refuses a name that means one set in the instance and another in the assembly: with one instance both share their names.
    fn refuse_ambiguous(&self, names: &Names, assembly: Option<&Names>, i: usize) -> Result<(), MeshIoError> {
        let Some(assembly) = assembly else { return Ok(()) };
        for (own, others) in [(&names.nodes, &assembly.nodes), (&names.elements, &assembly.elements)] {
            for (upper, set) in &own.all {
                if let Some(other) = others.all.get(upper)
                    && !set.internal
                    && !other.internal
                    && !set.labels.of_instance(i).same(&other.labels)
                {
                    let first = self.builder.contents.place_name(set.place);
                    let remedy = format!("the set of this name in {first} has other content: rename one of them");
                    return Err(self.builder.contents.error(other.place, &other.name, remedy));
                }
            }
        }
        for (upper, (name, pieces)) in &names.surfaces {
            if assembly.surfaces.contains_key(upper)
                && let Some(piece) = pieces.first()
            {
                let remedy = "part and assembly both have a surface of this name: rename one of them";
                return Err(self.builder.contents.error(piece.place, name, remedy));
            }
        }
        Ok(())
    }

    /// All sets and surfaces of an instance (whose labels have no instance yet) or of the assembly, but for sets that `taken` has too.
    fn names(
        &mut self,
        names: &Names,
        prefix: &str,
        instance: Option<usize>,
        taken: Option<&Names>,
    ) -> Result<(), MeshIoError> {
        let labels = |labels: &Labels| instance.map_or_else(|| labels.clone(), |i| labels.of_instance(i));
        for (upper, set) in &names.nodes.all {
            if taken.is_none_or(|taken| !taken.nodes.all.contains_key(upper)) {
                self.node_set(&format!("{prefix}{}", set.name), set, &labels(&set.labels))?;
            }
        }
        for (upper, set) in &names.elements.all {
            if taken.is_none_or(|taken| !taken.elements.all.contains_key(upper)) {
                self.element_set(&format!("{prefix}{}", set.name), set, &labels(&set.labels))?;
            }
        }
        for (name, of) in &names.nodes_of_elements {
            let name = names.nodes.find(name).map_or(name.as_str(), |set| &set.name);
            let nodes: BTreeSet<u32> = {
                let elements = self.elements(&labels(of))?.solids;
                elements.iter().flat_map(|&e| self.builder.contents.elements[e as usize].iter().copied()).collect()
            };
            entry(&mut self.builder.contents.node_sets, &format!("{prefix}{name}")).extend(nodes);
        }
        for (name, pieces) in names.surfaces.values() {
            let name = format!("{prefix}{name}");
            for piece in pieces {
                let elements = self.elements(&labels(&piece.labels))?.solids;
                let contents = &mut self.builder.contents;
                if piece.face.is_empty() {
                    entry(&mut contents.free_facets, &name).extend(elements);
                    continue;
                }
                let number = piece.face.strip_prefix('S').and_then(|number| number.parse::<usize>().ok());
                // The edges of a plane element are the faces of its layer behind the first two.
                let first = if contents.is_plane { 2 } else { 0 };
                let mut facets = Vec::with_capacity(elements.len());
                for e in elements {
                    let kind = contents.elements.kind(e as usize);
                    let faces = kind.faces().len() - first;
                    let Some(local) = number.filter(|n| (1..=faces).contains(n)) else {
                        let element = contents.element_source[e as usize].number;
                        let what = match contents.is_plane {
                            true => format!("element {element} is plane, with edges S1 to S{faces}"),
                            false => format!("element {element} is a {kind}, whose faces are S1 to S{faces}"),
                        };
                        return Err(contents.error(piece.place, &piece.face, what));
                    };
                    facets.push((e, first + local - 1));
                }
                entry(&mut contents.facet_sets, &name).extend(facets);
            }
        }
        Ok(())
    }

    fn node_set(&mut self, name: &str, set: &Set, labels: &Labels) -> Result<(), MeshIoError> {
        let mut nodes = BTreeSet::new();
        for (&(scope, number), &place) in &labels.numbers {
            nodes.insert(self.builder.node_number(scope, number, place)?);
        }
        for (&(scope, [first, last, step]), &place) in &labels.ranges {
            if ((last - first) / step) as usize <= self.builder.node_numbers(scope).len() {
                let numbers = (first..=last).step_by(step as usize);
                nodes.extend(numbers.filter_map(|n| self.builder.node_number(scope, n, place).ok()));
            } else {
                let inside = |n: u64| first <= n && n <= last && (n - first).is_multiple_of(step);
                nodes.extend(self.builder.node_numbers(scope).filter(|&(n, _)| inside(n)).map(|(_, i)| i));
            }
        }
        if nodes.is_empty() && !labels.ranges.is_empty() {
            let remedy = "the ranges of this set have no node: correct them";
            return Err(self.builder.contents.error(set.place, &set.name, remedy));
        }
        entry(&mut self.builder.contents.node_sets, name).extend(nodes);
        Ok(())
    }

    fn element_set(&mut self, name: &str, set: &Set, labels: &Labels) -> Result<(), MeshIoError> {
        let found = self.elements(labels)?;
        if found.solids.is_empty() && found.others.is_empty() && !labels.ranges.is_empty() {
            let remedy = "the ranges of this set have no element: correct them";
            return Err(self.builder.contents.error(set.place, &set.name, remedy));
        }
        self.others_of(name, &found.others);
        if !found.solids.is_empty() {
            entry(&mut self.builder.contents.element_sets, name).extend(found.solids);
        }
        Ok(())
    }

    /// The elements of an instance as a group.
    fn instance_group(&mut self, name: &str, i: usize) {
        let others: BTreeSet<usize> = self.instances[i].part.others.values().copied().collect();
        self.others_of(name, &others);
        let elements: BTreeSet<u32> = self.builder.element_numbers(i).map(|(_, index)| index).collect();
        if !elements.is_empty() {
            self.builder.contents.instances.insert(name.to_owned(), elements);
            self.builder.contents.parts.insert(name.to_owned(), self.instances[i].part.name.clone());
        }
    }

    fn others_of(&mut self, name: &str, kinds: &BTreeSet<usize>) {
        for &kind in kinds {
            if let Some(groups) = &mut self.builder.contents.others[self.first_other + kind].groups {
                groups.insert(name.to_owned());
            }
        }
    }

    fn elements(&self, labels: &Labels) -> Result<Found, MeshIoError> {
        let mut found = Found::default();
        for (&(scope, number), &place) in &labels.numbers {
            match (self.builder.element_number(scope, number), self.instances[scope].part.others.get(&number)) {
                (Some(index), _) => found.solids.push(index),
                (None, Some(&kind)) => drop(found.others.insert(kind)),
                (None, None) => return Err(self.builder.contents.unknown("element", number, place)),
            }
        }
        for &(scope, [first, last, step]) in labels.ranges.keys() {
            let inside = |n: u64| (n - first).is_multiple_of(step);
            if ((last - first) / step) as usize <= self.builder.element_numbers(scope).len() {
                let numbers = (first..=last).step_by(step as usize);
                found.solids.extend(numbers.filter_map(|n| self.builder.element_number(scope, n)));
            } else {
                let numbers = self.builder.element_numbers(scope);
                let numbers = numbers.filter(|&(n, _)| first <= n && n <= last && inside(n));
                found.solids.extend(numbers.map(|(_, index)| index));
            }
            let others: &BTreeMap<u64, usize> = &self.instances[scope].part.others;
            found.others.extend(others.range(first..=last).filter(|&(&n, _)| inside(n)).map(|(_, &kind)| kind));
        }
        Ok(found)
    }
}
