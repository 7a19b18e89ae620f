//! A layer of the set-up, and how sets become one.

use crate::build::Placed;
use crate::scene::split_set;
use crate::solver::Model;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a layer shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A surface of a contact.
    Contact,
    /// A surface of a tie.
    Tie,
    /// A set that a coupling joins to a rigid body.
    Coupling,
    /// The points of an equation.
    Equation,
    /// A joint.
    Joint,
    /// A spring between two parts.
    Spring,
    /// A prescribed displacement.
    Prescribed,
    /// Springs and dashpots to the ground.
    Support,
    /// A load, or gravity.
    Load,
    /// A set that a part has.
    Set,
}

/// An arrow of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arrow {
    /// Where it begins, or ends if it `pushes`: reference position, a length each.
    pub at: [f32; 3],
    /// Direction of the arrow, a unit vector.
    pub along: [f32; 3],
    /// Whether it ends at its place.
    pub pushes: bool,
}

impl Arrow {
    /// Along a direction of any length; without a length it has none.
    pub fn new(at: [f64; 3], along: [f64; 3], pushes: bool) -> Self {
        let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
        let unit = |x: f64| if length > 0.0 { (x / length) as f32 } else { 0.0 };
        Self { at: at.map(|x| x as f32), along: along.map(unit), pushes }
    }
}

/// A layer of the page that shows a scene: one thing of it, as a contact, a support or a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Kind of the thing.
    pub kind: Kind,
    /// Name of the thing in the scene, or what it acts on if it has none.
    pub name: String,
    /// What else is to be said of it; may be empty.
    pub about: String,
    /// Places in the reference configuration, a length each.
    pub places: Vec<[f32; 3]>,
    /// Facets of three or four places, outward.
    pub facets: Vec<Vec<u32>>,
    /// Lines between two places.
    pub lines: Vec<[u32; 2]>,
    /// Directions of what acts.
    pub arrows: Vec<Arrow>,
}

impl Layer {
    /// One without anything to see.
    pub fn new(kind: Kind, name: String, about: String) -> Self {
        Self { kind, name, about, places: Vec::new(), facets: Vec::new(), lines: Vec::new(), arrows: Vec::new() }
    }

    /// Adds places.
    pub fn add_places(&mut self, places: &[[f64; 3]]) {
        self.places.extend(places.iter().map(|place| place.map(|x| x as f32)));
    }
}

/// A model with its parts.
pub(super) struct Space<'a> {
    pub model: &'a Model,
    pub placed: &'a [Placed],
}

impl Space<'_> {
    /// Reference position of a node.
    pub fn place(&self, node: u32) -> [f64; 3] {
        std::array::from_fn(|i| self.model.reference[3 * node as usize + i])
    }

    /// Nodes of a set `part.set`; none of one that is not there.
    pub fn nodes(&self, set: &str) -> Vec<u32> {
        self.part(set).and_then(|(part, set)| part.nodes_of(set).ok()).unwrap_or_default()
    }

    fn part<'b>(&self, set: &'b str) -> Option<(&Placed, &'b str)> {
        let (part, set) = split_set(set)?;
        Some((self.placed.iter().find(|placed| placed.name == part)?, set))
    }

    /// A layer with the facets of a set, or with its nodes if it has no facets.
    pub fn surface(&self, kind: Kind, name: String, set: &str, about: &str) -> Layer {
        let mut layer = Layer::new(kind, name, about.to_owned());
        let facets = self.part(set).and_then(|(part, set)| part.facets_of(set).ok()).unwrap_or_default();
        let mut numbers = BTreeMap::new();
        for facet in &facets {
            let corners = facet.iter().map(|&node| {
                *numbers.entry(node).or_insert_with(|| {
                    layer.add_places(&[self.place(node)]);
                    layer.places.len() as u32 - 1
                })
            });
            let corners = corners.collect();
            layer.facets.push(corners);
        }
        if facets.is_empty() {
            let nodes = self.nodes(set);
            layer.add_places(&nodes.iter().map(|&node| self.place(node)).collect::<Vec<_>>());
        }
        layer
    }

    /// Middle of some nodes; nothing without any.
    pub fn middle(&self, nodes: &[u32]) -> Option<[f64; 3]> {
        let count = nodes.len() as f64;
        let mean = |i: usize| nodes.iter().map(|&node| self.place(node)[i]).sum::<f64>() / count;
        (!nodes.is_empty()).then(|| std::array::from_fn(mean))
    }
}
