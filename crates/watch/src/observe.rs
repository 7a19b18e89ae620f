//! The watch: a check of one state, or of two consecutive states.

use crate::pairs::{Inside, TOUCHING, overlap};
use crate::predicates::{inside_element, nearest_point};
use crate::solids::{Shapes, SolidObservation};
use crate::surface::Surface;
use crate::sweep::{SweptBoxes, passages};
use crate::{WatchBody, WatchError, WatchFacet, WatchModel, WatchShape};
use nalgebra::Vector3;
use std::collections::{BTreeMap, BTreeSet};
use stoss_geometry::{Aabb, BoundingVolumeTree};
use stoss_mesh::Elements;

/// Number of facets up to which every step is checked; with more the checks are less frequent.
const FACETS_EVERY_STEP: usize = 4000;

/// A point of a body inside another body, or inside its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Penetration {
    /// The body.
    pub body: usize,
    /// Global number of the node; the nearest one if it is the middle of an edge or of a face.
    pub node: u32,
    /// The body that it is inside.
    pub into: usize,
    /// Distance to the nearest point of that body's surface (a length); of an open surface how far the body reaches to the side where there is less of it.
    pub depth: f64,
    /// Depth over the mean edge length of the facet there; of the facets of a rigid body, which may be large, that of the point's own facet counts too if it
    /// is smaller.
    pub relative: f64,
    /// Position of the point.
    pub position: [f64; 3],
}

/// A node that went into a body and out of it between two states.
#[derive(Clone, Debug, PartialEq)]
pub struct Tunnelling {
    /// The body of the node.
    pub body: usize,
    /// Global number of the node.
    pub node: u32,
    /// The body that it passed through.
    pub through: usize,
    /// Point where it went in.
    pub position: [f64; 3],
}

/// Findings about the geometry of one state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observation {
    /// The deepest point, in edge lengths, of each pair of bodies that overlap.
    pub penetrations: Vec<Penetration>,
    /// Nodes inside another body or inside their own.
    pub nodes_inside: usize,
    /// Edges that run through a body between two ends outside, or through an open surface.
    pub cutting: usize,
    /// Nodes that passed through a body since the state before.
    pub tunnelled: Vec<Tunnelling>,
}

impl Observation {
    /// The deepest of all.
    pub fn deepest(&self) -> Option<&Penetration> {
        self.penetrations.iter().max_by(|a, b| a.relative.total_cmp(&b.relative))
    }
}

/// Elements at the surface of a body, in which a fold of the body would be found.
#[derive(Debug)]
struct SurfaceElements {
    elements: Vec<u32>,
    /// Nodes of the elements around each node of the surface, sorted.
    around: Vec<Vec<u32>>,
    tree: BoundingVolumeTree,
}

/// Checks states of a model. Built once; a check allocates little.
#[derive(Debug)]
pub struct Watch {
    pub(crate) model: WatchModel,
    pub(crate) surfaces: Vec<Surface>,
    surface_elements: Vec<SurfaceElements>,
    /// Nodes of ties, by pairs of bodies in both orders.
    tied: Vec<([usize; 2], BTreeSet<u32>)>,
    pub(crate) shapes: Shapes,
    placed: bool,
    inside: Vec<bool>,
    /// Gaps between bodies in the reference, as far as they were asked for.
    pub(crate) gaps: BTreeMap<[usize; 2], f64>,
    /// Amounts by which the arches of the facets of two bodies change their gap in the reference.
    pub(crate) arches: BTreeMap<[usize; 2], [f64; 2]>,
}

impl Watch {
    /// Finds the surfaces of the bodies.
    ///
    /// # Errors
    /// [`WatchError::Node`] if an element or a facet names a node that does not exist.
    pub fn new(model: WatchModel) -> Result<Self, WatchError> {
        let nodes = model.reference.len() / 3;
        for body in &model.bodies {
            let all: Vec<&[u32]> = match &body.shape {
                WatchShape::Solid(elements) => elements.iter().collect(),
                WatchShape::Surface { facets, .. } => facets.iter().map(WatchFacet::corners).collect(),
            };
            for (element, corners) in all.into_iter().enumerate() {
                if let Some(&node) = corners.iter().find(|&&node| node as usize >= nodes) {
                    return Err(WatchError::Node { body: body.name.clone(), element, node, nodes });
                }
            }
        }
        let surface = |body: &WatchBody| match &body.shape {
            WatchShape::Solid(elements) => Surface::of_elements(elements),
            WatchShape::Surface { facets, is_closed } => Surface::of_facets(facets, *is_closed, &model.reference),
        };
        let surfaces: Vec<Surface> = model.bodies.iter().map(surface).collect();
        let surface_elements =
            model.bodies.iter().zip(&surfaces).map(|(body, surface)| SurfaceElements::new(body.elements(), surface));
        let surface_elements = surface_elements.collect();
        let both = |tie: &crate::TiedPair| {
            let nodes: BTreeSet<u32> = tie.nodes.iter().copied().collect();
            let [a, b] = tie.bodies;
            [([a, b], nodes.clone()), ([b, a], nodes)]
        };
        let tied = model.ties.iter().flat_map(both).collect();
        let shapes = Shapes::new(&model);
        Ok(Self {
            model,
            surfaces,
            surface_elements,
            tied,
            shapes,
            placed: false,
            inside: Vec::new(),
            gaps: BTreeMap::new(),
            arches: BTreeMap::new(),
        })
    }

    /// Steps from one check to the next. It follows from the number of facets alone, so that verdicts are reproducible:
    /// the cost of a check is about proportional to the facets, that of a step grows faster.
    pub fn default_every(&self) -> u64 {
        let facets: usize = self.surfaces.iter().map(|surface| surface.facets.len()).sum();
        1 + (facets / FACETS_EVERY_STEP) as u64
    }

    /// The elements and positions of a state `q` (three a node).
    pub fn solids(&self, q: &[f64]) -> SolidObservation {
        self.shapes.observe(&self.model, q)
    }

    /// The geometry of a state `q` (three a node), and what passed through a body since the state `previous`. Positions that are not finite
    /// are reported by [`Self::solids`]; this check then finds nothing.
    pub fn geometry(&mut self, q: &[f64], previous: Option<&[f64]>) -> Observation {
        let mut seen = Observation::default();
        if q.iter().chain(previous.unwrap_or_default()).any(|x| !x.is_finite()) {
            return seen;
        }
        let mut before = Vec::new();
        if let Some(previous) = previous {
            for surface in &mut self.surfaces {
                surface.place(previous, !self.placed);
                before.push((surface.points.clone(), surface.bounds));
            }
            self.placed = true;
        }
        for surface in &mut self.surfaces {
            surface.place(q, !self.placed);
        }
        self.placed = true;
        for a in 0..self.surfaces.len() {
            for b in (0..self.surfaces.len()).filter(|&b| b != a) {
                self.pair(a, b, &mut seen);
            }
            self.own(a, q, &mut seen);
        }
        if !before.is_empty() {
            self.swept(&before, &mut seen);
        }
        seen
    }

    fn tied(&self, a: usize, b: usize) -> Option<&BTreeSet<u32>> {
        self.tied.iter().find(|(bodies, _)| *bodies == [a, b]).map(|(_, nodes)| nodes)
    }

    fn pair(&mut self, a: usize, b: usize, seen: &mut Observation) {
        let mut inside = std::mem::take(&mut self.inside);
        let (body, other) = (&self.surfaces[a], &self.surfaces[b]);
        let tied = self.tied(a, b);
        let found = overlap(body, other, |point| tied.is_some_and(|tied| touches(body, point, tied)), &mut inside);
        self.inside = inside;
        seen.nodes_inside += found.nodes;
        seen.cutting += found.edges;
        seen.penetrations.extend(found.deepest.map(|deepest| self.penetration(a, b, &deepest)));
    }

    fn penetration(&self, body: usize, into: usize, inside: &Inside) -> Penetration {
        let surface = &self.surfaces[body];
        let Inside { point, position, depth, relative } = *inside;
        Penetration {
            body,
            node: surface.nodes[surface.nodes_of(point)[0] as usize],
            into,
            depth,
            relative,
            position: position.into(),
        }
    }

    /// Nodes and centres of faces of a body inside elements of its own that share no node with the elements around it.
    fn own(&mut self, b: usize, q: &[f64], seen: &mut Observation) {
        let Some(all) = self.model.bodies[b].elements() else { return };
        let place = |node: u32| Vector3::from_column_slice(&q[3 * node as usize..3 * node as usize + 3]);
        let behind = &mut self.surface_elements[b];
        let elements = &behind.elements;
        behind.tree.refit(|k| bounds(all[elements[k] as usize].iter().map(|&node| place(node))));
        let (behind, surface) = (&self.surface_elements[b], &self.surfaces[b]);
        let mut deepest: Option<Inside> = None;
        let mut places = Vec::new();
        for (k, x) in surface.points.iter().enumerate() {
            let corners = surface.nodes_of(k as u32);
            let near = |node: &u32| corners.iter().any(|&c| behind.around[c as usize].binary_search(node).is_ok());
            let mut hit = false;
            behind.tree.query(&Aabb::from_points([x]), |s| {
                let element = behind.elements[s];
                let nodes = &all[element as usize];
                if hit || nodes.iter().any(near) {
                    return;
                }
                places.clear();
                places.extend(nodes.iter().map(|&node| place(node)));
                if !inside_element(all.kind(element as usize), &places, x) {
                    return;
                }
                // The nearest face of that element on the outside; it has one.
                let own = (0..surface.triangle_count()).filter(|&t| surface.element(t) == Some(element));
                let distance = |t: usize| (x - nearest_point(x, surface.triangle(t))).norm();
                let nearest = own.map(|t| (distance(t), t)).min_by(|a, b| a.0.total_cmp(&b.0));
                let Some((depth, t)) = nearest else { return };
                let relative = depth / surface.edge_length(t);
                hit = relative > TOUCHING;
                if hit && deepest.is_none_or(|worst| relative > worst.relative) {
                    deepest = Some(Inside { point: k as u32, position: *x, depth, relative });
                }
            });
            seen.nodes_inside += usize::from(hit && k < surface.nodes.len());
        }
        seen.penetrations.extend(deepest.map(|deepest| self.penetration(b, b, &deepest)));
    }

    fn swept(&self, before: &[(Vec<Vector3<f64>>, Aabb)], seen: &mut Observation) {
        let bounds: Vec<Aabb> =
            self.surfaces.iter().zip(before).map(|(surface, (_, then))| surface.bounds.union(then)).collect();
        for b in 0..self.surfaces.len() {
            let near: Vec<usize> = (0..bounds.len()).filter(|&a| a != b && bounds[a].overlaps(&bounds[b])).collect();
            if near.is_empty() {
                continue;
            }
            let regions: Vec<Aabb> = near.iter().map(|&a| bounds[a]).collect();
            let sweep = SweptBoxes::new(&self.surfaces[b], &before[b].0, &regions);
            for a in near {
                let (body, other, tied) = (&self.surfaces[a], &self.surfaces[b], self.tied(a, b));
                let exempt = |point| tied.is_some_and(|tied| touches(body, point, tied));
                let found = passages((body, &before[a].0), (other, &before[b].0, &sweep), exempt);
                seen.tunnelled.extend(found.into_iter().map(|passage| Tunnelling {
                    body: a,
                    node: body.nodes[passage.node as usize],
                    through: b,
                    position: passage.position.into(),
                }));
            }
        }
    }
}

/// Whether a point of a surface is one of these nodes, or the centre of a face with one of them.
fn touches(surface: &Surface, point: u32, nodes: &BTreeSet<u32>) -> bool {
    surface.nodes_of(point).iter().any(|&corner| nodes.contains(&surface.nodes[corner as usize]))
}

fn bounds(points: impl Iterator<Item = Vector3<f64>>) -> Aabb {
    points.fold(Aabb::empty(), |bounds, x| bounds.union(&Aabb::from_points([&x])))
}

impl SurfaceElements {
    fn new(all: Option<&Elements>, surface: &Surface) -> Self {
        let mut elements = surface.elements.clone();
        elements.sort_unstable();
        elements.dedup();
        let mut around = vec![Vec::new(); surface.nodes.len()];
        for element in all.into_iter().flat_map(Elements::iter) {
            for node in element {
                if let Ok(k) = surface.nodes.binary_search(node) {
                    around[k].extend_from_slice(element);
                }
            }
        }
        for nodes in &mut around {
            nodes.sort_unstable();
            nodes.dedup();
        }
        let boxes = vec![Aabb::from_points([&Vector3::zeros()]); elements.len()];
        Self { elements, around, tree: BoundingVolumeTree::build(&boxes) }
    }
}
