//! The surroundings of joints: there the surfaces of what is joined may overlap, which is no concern of the watch.

use super::overlap::Locator;
use super::{Joined, Placed};
use crate::scene::{Directions, Joint, Scene, split_set};
use std::collections::BTreeSet;
use std::f64::consts::PI;
use stoss_mesh::BOUNDARY;
use stoss_reference_element::FacetNodes;
use stoss_tensor::Vector3;

/// Pairs of facets of which all are checked.
const MOST: usize = 1_000_000;

/// Corners of a section that the joint is in the middle of belong to its surroundings, relative.
const ROUND_OFF: f64 = 1e-6;

/// The surface of a part, and what tells what is inside it.
struct Body<'a> {
    facets: Vec<FacetNodes>,
    locator: Option<Locator<'a>>,
    bounds: [Vector3; 2],
}

impl<'a> Body<'a> {
    /// `None` for parts without a surface.
    fn new(part: &'a Placed, reference: &[f64]) -> Option<Self> {
        let facets = part.facets_of(BOUNDARY).ok().filter(|facets| !facets.is_empty())?;
        let mut bounds = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
        for &node in facets.iter().flatten() {
            let x = at(reference, node);
            bounds = [bounds[0].inf(&x), bounds[1].sup(&x)];
        }
        Some(Self { facets, locator: part.mesh().map(Locator::new), bounds })
    }

    /// Half of the diagonal of its section: of the two smaller extents of the box around it.
    fn section(&self) -> f64 {
        let mut size: [f64; 3] = (self.bounds[1] - self.bounds[0]).into();
        size.sort_by(f64::total_cmp);
        0.5 * size[0].hypot(size[1])
    }

    fn contains(&self, x: &Vector3, reference: &[f64]) -> bool {
        if (0..3).any(|i| x[i] < self.bounds[0][i] || x[i] > self.bounds[1][i]) {
            return false;
        }
        match &self.locator {
            Some(locator) => locator.contains(&(*x).into()),
            None => self.facets.iter().map(|facet| solid_angle(facet, x, reference)).sum::<f64>() > 2.0 * PI,
        }
    }
}

fn at(reference: &[f64], node: u32) -> Vector3 {
    Vector3::from_column_slice(&reference[3 * node as usize..3 * node as usize + 3])
}

/// Angle under which a facet is seen, positive from within.
fn solid_angle(facet: &FacetNodes, x: &Vector3, reference: &[f64]) -> f64 {
    let corner = |k: usize| at(reference, facet[k]) - x;
    let triangle = |k: usize| {
        let [a, b, c] = [corner(0), corner(k), corner(k + 1)];
        let [p, q, r] = [a.norm(), b.norm(), c.norm()];
        2.0 * a.cross(&b).dot(&c).atan2(p * q * r + a.dot(&b) * r + b.dot(&c) * p + c.dot(&a) * q)
    };
    (1..facet.len() - 1).map(triangle).sum()
}

/// Distance of a point from what a joint holds: its points, its axis, its plane.
fn distance(joint: &Joint, x: &Vector3) -> f64 {
    let from = joint.at.both().map(|at| x - Vector3::from(at));
    let axis = joint.axis.and_then(|axis| Vector3::from(axis).try_normalize(0.0));
    match (joint.kind.directions, axis) {
        (Directions::Axis, Some(axis)) => from[0].cross(&axis).norm(),
        (Directions::Normal, Some(normal)) => from[0].dot(&normal).abs(),
        (Directions::Axis | Directions::Normal | Directions::Pair | Directions::None, _) => {
            from[0].norm().min(from[1].norm())
        }
    }
}

/// Nodes that a side of a joint holds on to, and whether these are all nodes of the surface of a part.
pub(super) fn held(placed: &[Placed], side: &str) -> (BTreeSet<u32>, bool) {
    let (part, set) = split_set(side).unwrap_or((side, BOUNDARY));
    let nodes_of = |set: &str| {
        let part = super::placed::index(placed, part)?;
        placed[part].nodes_of(set).ok()
    };
    let nodes: BTreeSet<u32> = nodes_of(set).into_iter().flatten().collect();
    let is_whole = nodes_of(BOUNDARY).is_none_or(|all| all.iter().all(|node| nodes.contains(node)));
    (nodes, is_whole)
}

/// Nodes that the sides of a joint hold on to, but for those that hold all of a part.
pub(super) fn held_of(placed: &[Placed], sides: &[String; 2]) -> BTreeSet<u32> {
    let held = sides.iter().map(|side| held(placed, side)).filter(|(_, is_whole)| !is_whole);
    held.flat_map(|(nodes, _)| nodes).collect()
}

/// Nodes around each joint between two parts with surfaces: those of the sets that it holds on to; as far as one part lies in the other in the reference, and half the diagonal of the thinner one's section beyond; and the corners of facets that lie in the other.
pub(super) fn surroundings(scene: &Scene, placed: &[Placed], reference: &[f64]) -> Vec<Joined> {
    let mut list = Vec::new();
    for joint in &scene.joints {
        let parts = joint.between.each_ref().map(|side| split_set(side).map_or(&side[..], |(part, _)| part));
        let [a, b] = parts.map(|name| placed.iter().find(|part| part.name == name));
        let (Some(a), Some(b)) = (a, b) else { continue };
        let (Some(a), Some(b)) = (Body::new(a, reference), Body::new(b, reference)) else { continue };
        let (mut nodes, mut overlap) = (BTreeSet::new(), 0.0_f64);
        for (own, other) in [(&a, &b), (&b, &a)] {
            // Many facets are small ones: some of them tell how far one part lies in the other.
            let pairs = if other.locator.is_some() { 0 } else { own.facets.len() * other.facets.len() };
            for facet in own.facets.iter().step_by(1 + pairs / MOST) {
                let corners: Vec<Vector3> = facet.iter().map(|&node| at(reference, node)).collect();
                let count = corners.len();
                let centre = corners.iter().sum::<Vector3>() / count as f64;
                let middles = (0..count).map(|k| (corners[k] + corners[(k + 1) % count]) * 0.5);
                let points = corners.iter().copied().chain(middles).chain([centre]);
                for x in points.filter(|x| other.contains(x, reference)) {
                    overlap = overlap.max(distance(joint, &x));
                    nodes.extend(facet.iter().copied());
                }
            }
        }
        let reach = (overlap + a.section().min(b.section())) * (1.0 + ROUND_OFF);
        nodes.extend(held_of(placed, &joint.between));
        let away = |node: &u32| distance(joint, &at(reference, *node));
        for facet in [&a, &b].into_iter().flat_map(|body| &body.facets) {
            nodes.extend(facet.iter().copied().filter(|node| away(node) <= reach));
            // The middle of a large facet may be near though its corners are not: it counts as one of them.
            let centre = facet.iter().map(|&node| at(reference, node)).sum::<Vector3>() / facet.len() as f64;
            if distance(joint, &centre) <= reach {
                nodes.extend(facet.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b))));
            }
        }
        list.push(Joined { parts: parts.map(str::to_owned), nodes: nodes.into_iter().collect() });
    }
    list
}
