//! Expressions over sets, evaluated: each becomes a set of its part, under its own name.

use super::Problems;
use super::placed::{Discretisation, Placed, index};
use crate::scene::{RegionKind, Relation, Scene, SetExpression, SetRegion, known};
use crate::solver::short;

use std::borrow::Cow;
use std::collections::BTreeSet;
use stoss_mesh::{Elements, Facet, MeshError};
use stoss_reference_element::FaceNodes;

/// Makes the sets of all expressions; returns a line for each with its numbers of nodes and facets, and their area in the reference.
/// Those that hold nowhere, or name what is not there, are problems.
pub(super) fn add(scene: &Scene, placed: &mut [Placed], problems: &mut Problems<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    for expression in scene.set_expressions() {
        let Some(part) = index(placed, &expression.part) else { continue };
        match make(&placed[part], expression) {
            Ok(made) => {
                lines.push(made.line(expression));
                made.store(&mut placed[part].shape, &expression.name);
            }
            Err((message, remedy)) => problems.add(expression.key.clone(), &expression.region.text, message, remedy),
        }
    }
    lines
}

/// What an expression holds at.
struct Made {
    nodes: Vec<u32>,
    /// Facets by number in [`Space::facets`].
    facets: Vec<u32>,
    /// Sum of the areas of the facets in the reference configuration.
    area: f64,
    elements: Vec<u32>,
}

impl Made {
    /// Line of `stoss check` that says what the set holds.
    fn line(&self, SetExpression { name, region, .. }: &SetExpression) -> String {
        let text = &region.text;
        let label = if name.contains(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_')) {
            text.clone()
        } else {
            format!("{name} = {text}")
        };
        let count = |n: usize, noun: &str| format!("{n} {noun}{}", if n == 1 { "" } else { "s" });
        let nodes = count(self.nodes.len(), "node");
        match self.facets.len() {
            0 => format!("{label}: {nodes}, no facets"),
            facets => {
                format!("{label}: {nodes}, {} with an area of {}", count(facets, "facet"), short(self.area, self.area))
            }
        }
    }

    fn store(self, shape: &mut Discretisation, name: &str) {
        let name = name.to_owned();
        match shape {
            Discretisation::Solid { mesh, .. } => {
                let boundary = if self.facets.is_empty() { Vec::new() } else { mesh.boundary_facets() };
                let facets: Vec<Facet> = self.facets.iter().map(|&f| boundary[f as usize]).collect();
                mesh.node_sets.insert(name.clone(), self.nodes);
                if !facets.is_empty() {
                    mesh.facet_sets.insert(name.clone(), facets);
                }
                if !self.elements.is_empty() {
                    mesh.element_sets.insert(name, self.elements);
                }
            }
            Discretisation::Surface(surface) => {
                surface.facet_sets.insert(name, self.facets);
            }
            Discretisation::Nodes { sets, .. } => {
                sets.insert(name, self.nodes);
            }
        }
    }
}

/// Message and remedy.
type Refused = (String, String);

fn make(placed: &Placed, expression: &SetExpression) -> Result<Made, Refused> {
    let space = Space::new(placed);
    if space.names().contains(&expression.name) {
        let message = format!("`{}` has a set `{}` of its own", placed.name, expression.name);
        return Err((message, "choose another name".into()));
    }
    let of_surface = matches!(placed.shape, Discretisation::Surface(_));
    let region = &expression.region;
    let nodes = space.select(region, Kind::Nodes)?;
    let facets = space.select(region, Kind::Facets)?;
    if nodes.is_empty() || (of_surface && facets.is_empty()) {
        let kind = if nodes.is_empty() { Kind::Nodes } else { Kind::Facets };
        return Err((space.why_empty(region, kind)?, "change the part that is empty".into()));
    }
    let elements = space.select(region, Kind::Elements)?;
    let area = facets.iter().map(|&f| 0.5 * norm(space.twice_area(&space.facets[f as usize]))).sum();
    Ok(Made { nodes, facets, area, elements })
}

/// What an expression is asked of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Nodes,
    Facets,
    Elements,
}

impl Kind {
    fn noun(self) -> &'static str {
        match self {
            Self::Nodes => "node",
            Self::Facets => "facet",
            Self::Elements => "element",
        }
    }
}

/// Two positions that are nearer than this part of the size of a part are the same one for a comparison, as in a plane set.
const TOLERANCE: f64 = 1.0e-6;
/// Step of the difference quotients that turn a difference of a comparison into a distance, over the size of the part.
const STEP: f64 = 1.0e-3;

/// A part as an expression sees it.
struct Space<'a> {
    placed: &'a Placed,
    positions: &'a [[f64; 3]],
    facets: Vec<FaceNodes>,
    elements: Cow<'a, Elements>,
    low: [f64; 3],
    high: [f64; 3],
}

impl<'a> Space<'a> {
    fn new(placed: &'a Placed) -> Self {
        let none = || Cow::Owned(Elements::new());
        let (positions, facets, elements): (&[[f64; 3]], Vec<FaceNodes>, _) = match &placed.shape {
            Discretisation::Solid { mesh, .. } => {
                let facets = mesh.boundary_facets().iter().map(|facet| facet.nodes).collect();
                (&mesh.nodes, facets, Cow::Borrowed(&mesh.elements))
            }
            Discretisation::Surface(surface) => {
                (&surface.nodes, surface.facets.iter().map(|&f| f.into()).collect(), none())
            }
            Discretisation::Nodes { positions, .. } => (positions, Vec::new(), none()),
        };
        let fold = |start: f64, f: fn(f64, f64) -> f64| -> [f64; 3] {
            std::array::from_fn(|i| positions.iter().map(|x| x[i]).fold(start, f))
        };
        let (low, high) = (fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max));
        Self { placed, positions, facets, elements, low, high }
    }

    fn size(&self) -> f64 {
        let size = (0..3).map(|i| self.high[i] - self.low[i]).fold(0.0, f64::max);
        // A single point is as far from others as from the origin.
        let far = self.low.iter().chain(&self.high).fold(0.0, |far: f64, x| far.max(x.abs()));
        [size, far].into_iter().find(|&length| length > 0.0).unwrap_or(1.0)
    }

    fn names(&self) -> Vec<String> {
        self.placed.set_names()
    }

    /// The nodes, or the facets or elements at all of whose nodes a region holds.
    fn select(&self, region: &SetRegion, kind: Kind) -> Result<Vec<u32>, Refused> {
        let places = self.places(kind);
        let holds = self.truth(region, kind, &places)?;
        let count = self.count(kind);
        let mut all = vec![true; count];
        for (&(_, owner), holds) in places.iter().zip(holds) {
            all[owner as usize] &= holds;
        }
        Ok((0..count as u32).filter(|&i| all[i as usize]).collect())
    }

    fn count(&self, kind: Kind) -> usize {
        match kind {
            Kind::Nodes => self.positions.len(),
            Kind::Facets => self.facets.len(),
            Kind::Elements => self.elements.len(),
        }
    }

    /// Every node of everything of a kind, with the number of what it belongs to.
    fn places(&self, kind: Kind) -> Vec<(u32, u32)> {
        let of = |nodes: &[u32], owner: usize| nodes.iter().map(|&n| (n, owner as u32)).collect::<Vec<_>>();
        match kind {
            Kind::Nodes => (0..self.positions.len() as u32).map(|n| (n, n)).collect(),
            Kind::Facets => self.facets.iter().enumerate().flat_map(|(f, nodes)| of(nodes, f)).collect(),
            Kind::Elements => self.elements.iter().enumerate().flat_map(|(e, nodes)| of(nodes, e)).collect(),
        }
    }

    /// Whether a region holds at each of these places.
    fn truth(&self, region: &SetRegion, kind: Kind, places: &[(u32, u32)]) -> Result<Vec<bool>, Refused> {
        Ok(match &region.kind {
            RegionKind::Set(name) => self.in_set(name, kind, places)?,
            RegionKind::Comparison { difference, relation } => {
                let at: Vec<bool> = self.positions.iter().map(|&x| self.compare(difference, *relation, x)).collect();
                places.iter().map(|&(node, _)| at[node as usize]).collect()
            }
            RegionKind::Nearest { within, point } => {
                let nodes = self.select(within, Kind::Nodes)?;
                let distance = |n: &u32| -> f64 {
                    let x = self.positions[*n as usize];
                    (0..3).map(|i| (x[i] - point[i]).powi(2)).sum()
                };
                let nearest = nodes.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                places.iter().map(|&(node, _)| Some(node) == nearest).collect()
            }
            RegionKind::Normal { within, direction, degrees } => {
                let facets = self.select(within, Kind::Facets)?;
                let least = degrees.to_radians().cos() - 1.0e-9;
                let length = norm(*direction);
                let faces = |f: &u32| {
                    let normal = self.normal(&self.facets[*f as usize]);
                    (0..3).map(|i| normal[i] * direction[i] / length).sum::<f64>() >= least
                };
                let facets: BTreeSet<u32> = facets.into_iter().filter(faces).collect();
                self.in_facets(&facets, kind, places)
            }
            RegionKind::Not(inner) => self.truth(inner, kind, places)?.into_iter().map(|holds| !holds).collect(),
            RegionKind::All(inner) => self.combine(inner, kind, places, |a, b| a && b)?,
            RegionKind::Any(inner) => self.combine(inner, kind, places, |a, b| a || b)?,
        })
    }

    fn combine(
        &self,
        inner: &[SetRegion],
        kind: Kind,
        places: &[(u32, u32)],
        operator: fn(bool, bool) -> bool,
    ) -> Result<Vec<bool>, Refused> {
        let mut all = inner.iter().map(|region| self.truth(region, kind, places));
        let first = all.next().unwrap_or_else(|| Ok(vec![false; places.len()]))?;
        all.try_fold(first, |sum, next| Ok(sum.into_iter().zip(next?).map(|(a, b)| operator(a, b)).collect()))
    }

    /// A difference of less than a millionth of the part's size in position counts as none.
    fn compare(&self, difference: &crate::scene::Formula, relation: Relation, x: [f64; 3]) -> bool {
        let step = STEP * self.size();
        let slope = |i: usize| {
            let along =
                |s: f64| difference.value(&std::array::from_fn::<f64, 3, _>(|k| if k == i { x[k] + s } else { x[k] }));
            (along(step) - along(-step)) / (2.0 * step)
        };
        let gradient = norm([slope(0), slope(1), slope(2)]);
        let tolerance = if gradient.is_finite() { TOLERANCE * self.size() * gradient } else { 0.0 };
        relation.holds(difference.value(&x), tolerance)
    }

    /// Whether each place is in a set: of a set of facets or elements these count for facets and elements, their nodes otherwise.
    fn in_set(&self, name: &str, kind: Kind, places: &[(u32, u32)]) -> Result<Vec<bool>, Refused> {
        let refused = |error: MeshError| match error {
            MeshError::UnknownSet { name, .. } => {
                let names = self.names();
                let remedy = known(&name, names.iter().map(String::as_str));
                (format!("`{}` has no set `{name}`", self.placed.name), remedy)
            }
            error => (error.to_string(), "name another set".into()),
        };
        match (&self.placed.shape, kind) {
            (Discretisation::Solid { mesh, .. }, Kind::Facets) => {
                if let Ok(facets) = mesh.facets_of(name) {
                    let facets: BTreeSet<(u32, u8)> = facets.iter().map(|f| (f.element, f.local)).collect();
                    let boundary = mesh.boundary_facets();
                    let inside: Vec<bool> = boundary.iter().map(|f| facets.contains(&(f.element, f.local))).collect();
                    return Ok(places.iter().map(|&(_, facet)| inside[facet as usize]).collect());
                }
            }
            (Discretisation::Surface(surface), Kind::Facets) => {
                let facets: BTreeSet<u32> = surface.facets_of(name).map_err(refused)?.into_iter().collect();
                return Ok(places.iter().map(|(_, facet)| facets.contains(facet)).collect());
            }
            (Discretisation::Solid { mesh, .. }, Kind::Elements) => {
                if let Ok(elements) = mesh.elements_of(name) {
                    let elements: BTreeSet<u32> = elements.into_iter().collect();
                    return Ok(places.iter().map(|(_, element)| elements.contains(element)).collect());
                }
            }
            _ => {}
        }
        let nodes = match &self.placed.shape {
            Discretisation::Solid { mesh, .. } => mesh.nodes_of(name),
            Discretisation::Surface(surface) => surface.nodes_of(name),
            Discretisation::Nodes { sets, .. } => {
                let unknown = || MeshError::UnknownSet { name: name.to_owned(), available: self.names() };
                sets.get(name).cloned().ok_or_else(unknown)
            }
        };
        let nodes: BTreeSet<u32> = nodes.map_err(refused)?.into_iter().collect();
        Ok(places.iter().map(|(node, _)| nodes.contains(node)).collect())
    }

    fn in_facets(&self, facets: &BTreeSet<u32>, kind: Kind, places: &[(u32, u32)]) -> Vec<bool> {
        if kind == Kind::Facets {
            return places.iter().map(|(_, facet)| facets.contains(facet)).collect();
        }
        let nodes: BTreeSet<u32> = facets.iter().flat_map(|&f| self.facets[f as usize].iter().copied()).collect();
        places.iter().map(|(node, _)| nodes.contains(node)).collect()
    }

    /// Outward unit normal of a facet, at its middle.
    fn normal(&self, facet: &FaceNodes) -> [f64; 3] {
        let n = self.twice_area(facet);
        let length = norm(n);
        n.map(|n| n / length)
    }

    /// Outward normal of a facet at its middle, as long as twice the facet's area.
    fn twice_area(&self, facet: &FaceNodes) -> [f64; 3] {
        let facet = facet.linear();
        let x = facet.map(|node| self.positions[node as usize]);
        let last = facet.len() - 1;
        let side = |from: usize, to: usize| -> [f64; 3] { std::array::from_fn(|i| x[to][i] - x[from][i]) };
        // The diagonals of a quadrilateral, two edges of a triangle.
        let (a, b) = (side(0, 2), side(1, if last == 3 { 3 } else { 0 }));
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    /// Which part of an expression that holds nowhere is to blame.
    fn why_empty(&self, region: &SetRegion, kind: Kind) -> Result<String, Refused> {
        let noun = kind.noun();
        if let RegionKind::All(inner) = &region.kind {
            let mut counts = Vec::new();
            for part in inner {
                let count = self.select(part, kind)?.len();
                if count == 0 {
                    return self.why_empty(part, kind);
                }
                counts.push(format!("`{}` ({count})", part.text));
            }
            return Ok(format!("is empty: {} have no {noun} in common", counts.join(" and ")));
        }
        let (name, low, high) = (&self.placed.name, self.low, self.high);
        Ok(format!("is empty: `{}` holds at no {noun} of `{name}`, which spans {low:?} to {high:?}", region.text))
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}
