//! What general contact reports at the end of a step: forces between bodies, tractions and forces at the nodes of surfaces.

use super::GeneralContact;
use super::areas::{Areas, Meeting, areas_of_triangles};
use crate::StepForce;
use crate::proximity::Candidate;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_contact::{BodyPair, SurfaceForce, SurfaceNode};
use stoss_geometry::{PairKind, closest};

/// Cosine of the angle between the normals of two facets, one of them turned around, from which on they face each other.
const FACING: f64 = 0.5;

/// Forces at the places of [`Skin::surface_nodes`], and where surfaces meet.
struct Surface {
    normal: Vec<Vector3<f64>>,
    friction: Vec<Vector3<f64>>,
    distance: Vec<f64>,
    meets: Vec<Meeting>,
}

impl GeneralContact {
    /// Forces at the surface nodes in the step, and distances at its end.
    fn surface(&self, triangles: &[Vector3<f64>]) -> Surface {
        let n = self.skin.surface_nodes().len();
        let zero = || vec![Vector3::zeros(); n];
        let mut surface =
            Surface { normal: zero(), friction: zero(), distance: vec![f64::INFINITY; n], meets: Vec::new() };
        for active in &self.active {
            let candidate = &active.candidate;
            let StepForce { barrier, friction } = self.force(active, None);
            if candidate.is_integration_point {
                surface.meets.extend(self.meeting(candidate, triangles));
            }
            for i in 0..4 {
                self.skin.shares(candidate.points[i], 1.0, &mut |k, share| {
                    surface.normal[k] -= barrier.gradient[i] * share;
                    surface.friction[k] -= friction.gradient[i] * share;
                });
            }
        }
        for candidate in &self.proximity.candidates {
            let point = candidate.points[0] as usize;
            if candidate.term.kind == PairKind::VertexTriangle && point < n {
                let distance = closest(candidate.term.kind, &candidate.of(&self.x)).distance_squared.sqrt();
                surface.distance[point] = surface.distance[point].min(distance);
            }
        }
        surface
    }

    /// A point of integration and a triangle that act on each other at the end of the step, if their surfaces face each other: the side of a block that stands on a plate does not face the plate, near as its lower edge may be.
    fn meeting(&self, candidate: &Candidate, triangles: &[Vector3<f64>]) -> Option<Meeting> {
        let [point, ref corners @ ..] = candidate.points;
        let own = self.skin.triangle_of_integration_point(point)?;
        let [f, g] = candidate.facets;
        let other = if self.skin.facet_of_triangle(own) == f { g } else { f };
        let mut of_other = self.skin.triangles_of(other).iter().copied();
        let triangle = of_other.find(|&t| self.skin.triangles()[t as usize] == *corners)?;
        let [a, b] = [own, triangle].map(|t| triangles[t as usize]);
        let faces = a.dot(&b) < -FACING * a.norm() * b.norm();
        let pair = closest(candidate.term.kind, &candidate.of(&self.x));
        let is_near = pair.distance_squared < self.options.thickness * self.options.thickness;
        let weights = std::array::from_fn(|i| -pair.weights[i + 1]);
        (faces && is_near).then_some(Meeting { point, own, triangle, weights, weight: candidate.term.weight })
    }

    /// Forces, pressures and areas of each pair of bodies that act on each other.
    pub(super) fn pairs_of_bodies(&self) -> Vec<BodyPair> {
        let mut list: BTreeMap<[u32; 2], BodyPair> = BTreeMap::new();
        // Points of integration with their weights and forces: one may act on several triangles.
        let mut points: BTreeMap<([u32; 2], u32), (f64, Vector3<f64>)> = BTreeMap::new();
        for active in &self.active {
            let candidate = &active.candidate;
            let StepForce { barrier, friction } = self.force(active, None);
            let [a, b] = candidate.classes.map(|class| self.rules.body(class));
            let bodies = [a.min(b), a.max(b)];
            let pair = list.entry(bodies).or_insert(BodyPair::none(bodies));
            let x = candidate.of(&self.x);
            let distance = closest(candidate.term.kind, &x).distance_squared.sqrt();
            pair.distance = pair.distance.min(distance);
            pair.friction_work += friction.work;
            if distance < self.options.thickness {
                pair.active += 1;
                if candidate.is_integration_point {
                    let point = points.entry((bodies, candidate.points[0])).or_default();
                    point.0 = candidate.term.weight.max(point.0);
                    point.1 += barrier.gradient[0];
                }
            }
            // Forces on the points of the first body; of a body on itself they cancel.
            let first = candidate.term.kind.first_count();
            let points = if a <= b { 0..first } else { first..4 };
            for i in points.filter(|_| a != b) {
                let force = -(barrier.gradient[i] + friction.gradient[i]);
                let moment = x[i].cross(&force);
                for c in 0..3 {
                    pair.force[c] += force[c];
                    pair.moment[c] += moment[c];
                }
            }
        }
        for ((bodies, _), (weight, force)) in points {
            if let Some(pair) = list.get_mut(&bodies) {
                pair.area += weight;
                pair.pressure = pair.pressure.max(force.norm() / weight);
            }
        }
        list.into_values().collect()
    }

    /// Forces and moments at the nodes of an inset skin; none of another.
    pub(super) fn forces_at_surface_nodes(&self) -> Vec<SurfaceForce> {
        let nodes = self.skin.surface_nodes();
        if !self.skin.is_inset() {
            return Vec::new();
        }
        let mut sums = vec![[Vector3::zeros(); 2]; nodes.len()];
        for active in &self.active {
            let candidate = &active.candidate;
            let (StepForce { barrier, friction }, x) = (self.force(active, None), candidate.of(&self.x));
            for i in 0..4 {
                let force = -(barrier.gradient[i] + friction.gradient[i]);
                let moment = x[i].cross(&force);
                self.skin.shares(candidate.points[i], 1.0, &mut |k, share| {
                    sums[k][0] += force * share;
                    sums[k][1] += moment * share;
                });
            }
        }
        let all = nodes.iter().zip(sums).filter(|(_, sums)| *sums != [Vector3::zeros(); 2]);
        all.map(|(&node, [force, moment])| SurfaceForce { node, force: force.into(), moment: moment.into() }).collect()
    }

    /// Pressure, friction and distance at the surface nodes where something acts or is near.
    pub(super) fn tractions_at_surface_nodes(&self, q_np1: &[f64]) -> Vec<SurfaceNode> {
        let triangles = areas_of_triangles(&self.skin, q_np1);
        let surface = self.surface(&triangles);
        let areas = Areas::of(&self.skin, &triangles, &surface.meets);
        let mut list = Vec::new();
        for (k, &node) in self.skin.surface_nodes().iter().enumerate() {
            let (normal, friction, distance) = (surface.normal[k], surface.friction[k], surface.distance[k]);
            if distance.is_infinite() && normal == Vector3::zeros() && friction == Vector3::zeros() {
                continue;
            }
            let (area, outward) = areas.at(k);
            let friction = (friction - outward * outward.dot(&friction)) / area;
            list.push(SurfaceNode {
                node,
                pressure: -normal.dot(&outward) / area,
                friction: friction.into(),
                distance,
                area,
            });
        }
        list
    }
}
