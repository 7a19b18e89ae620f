//! Elements that are inverted or nearly so, positions that are not finite or far away.

use crate::{WatchBody, WatchModel};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_mesh::Elements;
use stoss_reference_element::{CellKind, Integration, QuadratureRule};

/// Scaled Jacobian below which an element is poor, if the mesh was not so from the start.
const POOR: f64 = 0.02;

/// Sizes of the model beyond which a position is far away.
const FAR: f64 = 1.0e3;

/// Findings about the elements and positions of one state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidObservation {
    /// Body, element and smallest Jacobian of the worst element that is inverted at a Gauss point, times the volume in natural coordinates, over the mean of its edges
    /// cubed.
    pub inverted: Option<(usize, usize, f64)>,
    /// Body, element and smallest scaled Jacobian of the worst element that is inverted or nearly so at a node.
    pub poor: Option<(usize, usize, f64)>,
    /// The first node whose position is NaN or infinite.
    pub not_finite: Option<u32>,
    /// The node that is farthest from the reference, if that is more than a thousand sizes of the model, and how many sizes.
    pub far: Option<(u32, f64)>,
}

/// Derivatives of the shape functions of a cell at points of it, without the zeros.
#[derive(Debug)]
struct Frames {
    /// Nodes with a derivative for each point and direction, with that derivative.
    points: Vec<[Vec<(u8, f64)>; 3]>,
}

impl Frames {
    fn new(kind: CellKind, points: impl Iterator<Item = [f64; 3]>) -> Self {
        let of_point = |xi| {
            let gradient = (kind.table().shape_gradient)(xi);
            std::array::from_fn(|d| {
                let of_node = |(k, dn): (usize, &[f64; 3])| (dn[d] != 0.0).then_some((k as u8, dn[d]));
                gradient.iter().enumerate().filter_map(of_node).collect()
            })
        };
        Self { points: points.map(of_point).collect() }
    }

    /// Tangents along the natural directions at every point.
    fn tangents(&self, x: &[Vector3<f64>]) -> impl Iterator<Item = [Vector3<f64>; 3]> {
        let along =
            |list: &Vec<(u8, f64)>| list.iter().fold(Vector3::zeros(), |sum, &(k, dn)| sum + x[k as usize] * dn);
        self.points.iter().map(move |directions| [0, 1, 2].map(|d: usize| along(&directions[d])))
    }
}

/// Tangents along the natural directions at the Gauss points of full integration.
#[derive(Debug)]
pub(crate) struct Tangents<'a> {
    frames: &'a Frames,
    /// The points and their weights.
    pub rule: QuadratureRule,
}

impl Tangents<'_> {
    /// Tangents at each Gauss point of an element with nodes at `x`, a length per natural coordinate.
    pub fn at(&self, x: &[Vector3<f64>]) -> impl Iterator<Item = [Vector3<f64>; 3]> {
        self.frames.tangents(x)
    }
}

/// Data to check the shape of elements of one kind.
#[derive(Debug)]
struct Kind {
    nodes: Frames,
    gauss: Frames,
    rule: QuadratureRule,
    /// Volume in natural coordinates.
    volume: f64,
}

/// The shapes of all elements.
#[derive(Debug)]
pub(crate) struct Shapes {
    kinds: BTreeMap<CellKind, Kind>,
    /// Scaled Jacobian of each element in the reference, body after body.
    rest: Vec<f64>,
}

impl Shapes {
    pub fn new(model: &WatchModel) -> Self {
        let all = || model.bodies.iter().filter_map(WatchBody::elements);
        let kinds = all().flat_map(Elements::kinds).map(|kind| {
            let rule = kind.rule(Integration::Full).unwrap_or_default();
            let nodes = Frames::new(kind, kind.table().nodes.iter().copied());
            let gauss = Frames::new(kind, rule.iter().map(|(xi, _)| *xi));
            (kind, Kind { nodes, gauss, rule, volume: kind.table().family.volume() })
        });
        let mut shapes = Self { kinds: kinds.collect(), rest: Vec::new() };
        let mut x = Vec::new();
        for (kind, nodes) in all().flat_map(Elements::cells) {
            places(nodes, &model.reference, &mut x);
            let scaled = shapes.kinds[&kind].scaled_jacobian(&x);
            shapes.rest.push(scaled);
        }
        shapes
    }

    /// The tangents at the Gauss points of a kind of elements that the model has.
    pub fn tangents(&self, kind: CellKind) -> Tangents<'_> {
        let of = &self.kinds[&kind];
        Tangents { frames: &of.gauss, rule: of.rule }
    }

    /// Checks all elements and positions.
    pub fn observe(&self, model: &WatchModel, q: &[f64]) -> SolidObservation {
        let mut seen = SolidObservation::default();
        if let Some(k) = q.iter().position(|x| !x.is_finite()) {
            seen.not_finite = Some((k / 3) as u32);
            return seen;
        }
        seen.far = far(model, q);
        let (mut e, mut x) = (0, Vec::new());
        for (b, body) in model.bodies.iter().enumerate() {
            for (k, (kind, nodes)) in body.elements().into_iter().flat_map(Elements::cells).enumerate() {
                places(nodes, q, &mut x);
                let kind_data = &self.kinds[&kind];
                let scaled = kind_data.scaled_jacobian(&x);
                if scaled < POOR && scaled < 0.5 * self.rest[e] {
                    if seen.poor.is_none_or(|(.., worst)| scaled < worst) {
                        seen.poor = Some((b, k, scaled));
                    }
                    let jacobian = kind_data.gauss_jacobian(kind, &x);
                    if jacobian <= 0.0 && seen.inverted.is_none_or(|(.., worst)| jacobian < worst) {
                        seen.inverted = Some((b, k, jacobian));
                    }
                }
                e += 1;
            }
        }
        seen
    }
}

/// The node that is farthest from the reference, if that is far, and how many sizes of the model.
fn far(model: &WatchModel, q: &[f64]) -> Option<(u32, f64)> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for x in model.reference.chunks_exact(3) {
        for i in 0..3 {
            low[i] = low[i].min(x[i]);
            high[i] = high[i].max(x[i]);
        }
    }
    let size = (0..3).map(|i| (high[i] - low[i]).powi(2)).sum::<f64>().sqrt();
    // Without bodies there is no size to compare with: a mass on a string may go anywhere.
    let points = if model.bodies.is_empty() || size == 0.0 { &[] } else { q };
    let mut found: Option<(u32, f64)> = None;
    for (node, x) in points.chunks_exact(3).enumerate() {
        let beyond = (0..3).map(|i| (low[i] - x[i]).max(x[i] - high[i]).max(0.0)).fold(0.0, f64::max) / size;
        if beyond > FAR && found.is_none_or(|(_, worst)| beyond > worst) {
            found = Some((node as u32, beyond));
        }
    }
    found
}

/// Places of nodes in a state `q` (three a node).
pub(crate) fn places(nodes: &[u32], q: &[f64], x: &mut Vec<Vector3<f64>>) {
    x.clear();
    x.extend(nodes.iter().map(|&node| Vector3::from_column_slice(&q[3 * node as usize..3 * node as usize + 3])));
}

impl Kind {
    /// Smallest triple product of the unit tangents at a node; at the corners of linear elements they are the edges.
    fn scaled_jacobian(&self, x: &[Vector3<f64>]) -> f64 {
        let at = |tangents: [Vector3<f64>; 3]| {
            let lengths: f64 = tangents.iter().map(|tangent| tangent.norm()).product();
            tangents[0].cross(&tangents[1]).dot(&tangents[2]) / lengths.max(f64::MIN_POSITIVE)
        };
        self.nodes.tangents(x).map(at).fold(f64::INFINITY, f64::min)
    }

    /// Smallest determinant at the Gauss points times the volume in natural coordinates, over the mean edge cubed.
    fn gauss_jacobian(&self, kind: CellKind, x: &[Vector3<f64>]) -> f64 {
        let edges = kind.edges();
        let length = |[a, b]: [u8; 2]| (x[usize::from(b)] - x[usize::from(a)]).norm();
        let edge = edges.iter().map(|&ends| length(ends)).sum::<f64>() / edges.len() as f64;
        let unit = edge.powi(3).max(f64::MIN_POSITIVE) / self.volume;
        let at = |[u, v, w]: [Vector3<f64>; 3]| u.cross(&v).dot(&w) / unit;
        self.gauss.tangents(x).map(at).fold(f64::INFINITY, f64::min)
    }
}
