//! Area and pressure of a pair of bodies. A force at one point over its share of the area is uneven where meshes do not match, and the shares of points near a rim do not sum to the overlap: so the pressure is a mean over the facets around a
//! node, and the area that of the points of one side.

use super::GeneralContact;
use super::act::Act;
use super::begin::is_at_sharp;
use super::joint::Joint;
use crate::inset::OPPOSITE;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_geometry::{PairKind, closest};

/// Part of the facets around a node that is in contact, from which on their mean counts.
const PART: f64 = 0.25;

/// Force and reference area.
type Sum = (Vector3<f64>, f64);

/// Forces and areas of facets of pairs of bodies.
#[derive(Default)]
pub(super) struct Pressures {
    of: BTreeMap<([u32; 2], u32), Sum>,
    all: BTreeMap<[u32; 2], Sum>,
}

impl Pressures {
    /// Adds what a contact does, to both of its sides.
    pub fn add(&mut self, contact: &GeneralContact, bodies: [u32; 2], act: &Act, joint: &Joint, first: usize) {
        let skin = &contact.skin;
        let force: Vector3<f64> = joint.barrier[..first].iter().sum();
        let area = if act.end.is_integration_point { act.weight } else { 0.0 };
        let mut add = |triangles: &[u32], sign: f64| {
            let part = 1.0 / triangles.len().max(1) as f64;
            for &t in triangles {
                let sum = self.of.entry((bodies, skin.facet_of_triangle(t))).or_default();
                sum.0 += force * (sign * part);
                sum.1 += area * part;
            }
        };
        let point = act.end.points[0];
        if act.end.kind == PairKind::EdgeEdge {
            for (ends, sign) in [(&act.end.points[..2], 1.0), (&act.end.points[2..], -1.0)] {
                let beside = skin.beside(ends[0], ends[1]);
                add(&beside[..if beside[1] == u32::MAX { 1 } else { 2 }], sign);
            }
        } else {
            match skin.triangle_of_integration_point(point) {
                Some(own) => add(&[own], 1.0),
                None => add(skin.triangles_at(point), 1.0),
            }
            add(&act.end.of[..1], -1.0);
        }
        let all = self.all.entry(bodies).or_default();
        all.0 += force;
        all.1 += area;
    }

    /// The largest mean over the facets around a node, of those of which a part is in contact; of smaller contacts that over all. Shares of the area that do not sum to that in `areas` are all taken as if they did.
    pub fn largest(&self, contact: &GeneralContact, areas: &BTreeMap<[u32; 2], f64>) -> BTreeMap<[u32; 2], f64> {
        let skin = &contact.skin;
        let mut nodes: BTreeMap<([u32; 2], u32), (Sum, f64)> = BTreeMap::new();
        for (&(bodies, facet), &(force, area)) in &self.of {
            let whole = skin.area_of_facet(facet);
            for &node in skin.facets()[facet as usize].nodes.iter() {
                let sum = nodes.entry((bodies, node)).or_default();
                sum.0.0 += force;
                sum.0.1 += area;
                sum.1 += whole;
            }
        }
        let mut largest: BTreeMap<[u32; 2], f64> = BTreeMap::new();
        for ((bodies, _), ((force, area), whole)) in nodes {
            if area > PART * whole {
                let most = largest.entry(bodies).or_default();
                *most = most.max(force.norm() / area);
            }
        }
        for (&bodies, (force, area)) in &self.all {
            if *area > 0.0 {
                largest.entry(bodies).or_insert(force.norm() / area);
            }
        }
        for (bodies, largest) in &mut largest {
            if let (Some(area), Some((_, shares))) = (areas.get(bodies), self.all.get(bodies)) {
                *largest *= shares / area;
            }
        }
        largest
    }
}

impl GeneralContact {
    /// Reference area of the points of integration that are in the layer and opposite a triangle of another body, of the side of which they fill more of the facets that they are in: there a rim of the contact is one of the body.
    pub(super) fn areas_in_contact(&self) -> BTreeMap<[u32; 2], f64> {
        let (skin, thickness) = (&self.skin, self.options.thickness);
        let normal = |t: u32| {
            let [a, b, c] = skin.triangles()[t as usize].map(|p| self.x[p as usize]);
            (b - a).cross(&(c - a))
        };
        // What each point is nearest to, and whether it is opposite of it, beside the edges of its body.
        let mut points: BTreeMap<([u32; 2], u32), (f64, bool)> = BTreeMap::new();
        for c in self.proximity.candidates.iter().filter(|c| c.is_integration_point) {
            let Some(own) = skin.triangle_of_integration_point(c.points[0]) else { continue };
            let x = c.of(&self.x);
            if !c.may_meet(&x, &[Vector3::zeros(); 4], thickness) {
                continue;
            }
            let close = closest(c.kind, &x);
            let bodies = c.classes.map(|class| self.rules.body(class));
            let nearest = points.entry((bodies, c.points[0])).or_insert((thickness * thickness, false));
            if close.distance_squared < nearest.0 {
                let [m, n] = [own, c.of[0]].map(normal);
                let faces = m.dot(&n) < -OPPOSITE * m.norm() * n.norm();
                *nearest = (close.distance_squared, faces && !is_at_sharp(skin, c, &close));
            }
        }
        // Area of the points, and of the facets that have any.
        let mut sides: BTreeMap<[u32; 2], [f64; 2]> = BTreeMap::new();
        let mut last = None;
        for ((bodies, point), _) in points.into_iter().filter(|(_, nearest)| nearest.1) {
            let facet = skin.facet_of_point(point);
            let side = sides.entry(bodies).or_default();
            side[0] += skin.area_of_point(point);
            if last.replace((bodies, facet)) != Some((bodies, facet)) {
                side[1] += skin.area_of_facet(facet);
            }
        }
        let mut areas: BTreeMap<[u32; 2], f64> = BTreeMap::new();
        for (&[a, b], &[area, facets]) in &sides {
            let [other, of_others] = sides.get(&[b, a]).copied().unwrap_or([0.0, 1.0]);
            let area = match (area * of_others).total_cmp(&(other * facets)) {
                std::cmp::Ordering::Less => continue,
                std::cmp::Ordering::Equal => 0.5 * (area + other),
                std::cmp::Ordering::Greater => area,
            };
            // Of a body in contact with itself both sides are its own.
            areas.insert([a.min(b), a.max(b)], if a == b { 0.5 * area } else { area });
        }
        areas
    }
}
