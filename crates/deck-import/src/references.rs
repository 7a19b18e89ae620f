//! Reference nodes: nodes that no solid element has, but a coupling, an equation, a spring or a pretension. They become rigid bodies and points without mass.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh_io::Solids;
use stoss_mesh_io::deck::{Deck, Target};

use crate::bodies::{Bodies, unique_name};

/// Added to the numbers of nodes of the assembly, which nodes of parts may have too.
const ASSEMBLY: u64 = 1 << 62;

/// What a reference node stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Role {
    /// A point.
    Point,
    /// A rigid body without mass.
    Body,
    /// A node whose displacements are the rotations of the body with this number.
    RotationsOf(usize),
    /// A node whose first displacement is the rotation of the body with this number about an axis.
    RotationAbout(usize, [f64; 3]),
}

/// A reference node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reference {
    /// Name of the part that it becomes.
    pub name: String,
    pub at: [f64; 3],
    pub role: Role,
    /// Components along which something acts on a point. Along the others it is fixed.
    pub is_used: [bool; 3],
    /// A mass that is joined to it.
    pub mass: f64,
}

/// A node that something is joined to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum End {
    /// A node of the mesh, and the body that it belongs to.
    Solid(usize, u32),
    /// A reference node.
    Reference(usize),
}

/// All reference nodes.
pub(crate) struct References {
    pub all: Vec<Reference>,
    /// Reference nodes by numbers of the deck; those of solids are not among them.
    index: BTreeMap<u64, usize>,
    /// Nodes that no solid has: place and sets, in upper case.
    free: BTreeMap<u64, ([f64; 3], BTreeSet<String>)>,
    /// Nodes of solids by their numbers.
    solid: BTreeMap<u64, u32>,
    places: Vec<[f64; 3]>,
    taken: BTreeSet<String>,
}

impl References {
    pub fn new(deck: &Deck, solids: &Solids, bodies: &Bodies) -> Self {
        let upper = |sets: Vec<String>| sets.iter().map(|set| set.to_uppercase()).collect();
        let sets_of = |number: &u64| {
            let own = deck.reference_sets.iter().filter(|(_, numbers)| numbers.contains(number));
            own.map(|(name, _)| name.clone()).collect()
        };
        let of_assembly = deck.reference_nodes.iter().map(|(number, at)| (ASSEMBLY + number, (*at, sets_of(number))));
        let free = deck.contents.other_nodes().into_iter().map(|node| (node.number, (node.at, upper(node.sets))));
        Self {
            all: Vec::new(),
            index: BTreeMap::new(),
            free: free.chain(of_assembly).collect(),
            solid: solids.node_numbers.iter().enumerate().rev().map(|(k, &number)| (number, k as u32)).collect(),
            places: solids.mesh.nodes.clone(),
            taken: bodies.all.iter().map(|body| body.name.to_uppercase()).collect(),
        }
    }

    /// The reference node of this number, which is made with this role if it is new; nothing if there is no such node. A node of a solid becomes a body beside it.
    pub fn make(&mut self, number: u64, role: Role) -> Option<usize> {
        if let Some(&known) = self.index.get(&number) {
            if self.all[known].role == Role::Point {
                self.all[known].role = role;
            }
            return Some(known);
        }
        let free = self.free.get(&number).map(|(at, _)| *at);
        let at = free.or_else(|| self.solid.get(&number).map(|&node| self.places[node as usize]))?;
        let name = unique_name(&format!("node-{}", number % ASSEMBLY), &mut self.taken);
        self.all.push(Reference { name, at, role, is_used: [false; 3], mass: 0.0 });
        if free.is_some() {
            self.index.insert(number, self.all.len() - 1);
        }
        Some(self.all.len() - 1)
    }

    /// The reference node that a line names, made as by [`Self::make`].
    pub fn make_named(&mut self, target: &Target, solids: &[u32], role: Role) -> Option<usize> {
        match self.numbers(target, solids)[..] {
            [number] => self.make(number, role),
            _ => None,
        }
    }

    /// A body at a place that no node has.
    pub fn make_body(&mut self, hint: &str, at: [f64; 3]) -> usize {
        let name = unique_name(hint, &mut self.taken);
        self.all.push(Reference { name, at, role: Role::Body, is_used: [false; 3], mass: 0.0 });
        self.all.len() - 1
    }

    /// A point with a mass at a place of a node of a solid; its name.
    pub fn make_mass(&mut self, hint: &str, at: [f64; 3], mass: f64) -> String {
        let name = unique_name(hint, &mut self.taken);
        self.all.push(Reference { name: name.clone(), at, role: Role::Point, is_used: [true; 3], mass });
        name
    }

    /// The node of this number, if it belongs to a body or to no element at all.
    pub fn end(&mut self, number: u64, bodies: &Bodies) -> Option<End> {
        match self.solid.get(&number) {
            Some(&node) => Some(End::Solid(bodies.owner(node)?, node)),
            None => Some(End::Reference(self.make(number, Role::Point)?)),
        }
    }

    pub fn place(&self, end: End) -> [f64; 3] {
        match end {
            End::Solid(_, node) => self.places[node as usize],
            End::Reference(r) => self.all[r].at,
        }
    }

    /// The reference nodes among those that a line names.
    pub fn of(&self, target: &Target) -> Vec<usize> {
        match target {
            Target::All => self.index.values().copied().collect(),
            Target::Number { number, .. } => self.index.get(number).copied().into_iter().collect(),
            Target::Set(name) => {
                let name = name.to_uppercase();
                let own = self
                    .index
                    .iter()
                    .filter(|(number, _)| self.free.get(number).is_some_and(|(_, sets)| sets.contains(&name)));
                own.map(|(_, &r)| r).collect()
            }
        }
    }

    /// Numbers of the nodes that a line names, of solids and others.
    pub fn numbers(&self, target: &Target, solids: &[u32]) -> Vec<u64> {
        match target {
            Target::Number { number, .. } => vec![*number],
            Target::All => Vec::new(),
            Target::Set(name) => {
                let name = name.to_uppercase();
                let of_solids: BTreeSet<u32> = solids.iter().copied().collect();
                let own = self.solid.iter().filter(|(_, node)| of_solids.contains(node)).map(|(&number, _)| number);
                let free = self.free.iter().filter(|(_, (_, sets))| sets.contains(&name)).map(|(&number, _)| number);
                own.chain(free).collect::<BTreeSet<u64>>().into_iter().collect()
            }
        }
    }

    /// The body and the degree of freedom that a degree of freedom of a reference node means.
    pub fn freedom(&self, r: usize, freedom: usize) -> Option<(usize, usize)> {
        match (self.all[r].role, freedom) {
            (Role::RotationsOf(body), 0..3) => Some((body, 3 + freedom)),
            (Role::Point, 0..3) | (Role::Body, _) => Some((r, freedom)),
            _ => None,
        }
    }
}
