//! What general contact reports at the end of a step: forces between bodies, tractions and forces at the nodes of surfaces.

use super::GeneralContact;
use super::act::Act;
use super::areas::{Areas, Meeting, areas_of_triangles};
use super::joint::Joint;
use super::pressure::Pressures;
use crate::inset::OPPOSITE;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_geometry::{PairKind, closest};
use stoss_term::{BodyPair, SurfaceForce, SurfaceNode};

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
        let mut joint = Joint::default();
        for act in &self.acts {
            self.force(act, &mut joint, false);
            if act.end.is_integration_point {
                surface.meets.extend(self.meeting(act, triangles));
            }
            for (i, &point) in joint.points.iter().enumerate() {
                self.skin.shares(point, 1.0, &mut |k, share| {
                    surface.normal[k] -= joint.barrier[i] * share;
                    surface.friction[k] -= joint.friction[i] * share;
                });
            }
        }
        for candidate in &self.proximity.candidates {
            let point = candidate.points[0] as usize;
            if candidate.kind == PairKind::VertexTriangle && point < n {
                let distance = closest(candidate.kind, &candidate.of(&self.x)).distance_squared.sqrt();
                surface.distance[point] = surface.distance[point].min(distance);
            }
        }
        surface
    }

    /// A point of integration and a triangle that act on each other at the end of the step, if their surfaces face each other: the side of a block that stands on a plate does not face the plate, near as its lower edge may be.
    fn meeting(&self, act: &Act, triangles: &[Vector3<f64>]) -> Option<Meeting> {
        let (point, triangle) = (act.end.points[0], act.end.of[0]);
        let own = self.skin.triangle_of_integration_point(point)?;
        let [a, b] = [own, triangle].map(|t| triangles[t as usize]);
        let faces = a.dot(&b) < -OPPOSITE * a.norm() * b.norm();
        let is_near = act.close.distance_squared < act.thickness * act.thickness;
        let weights = std::array::from_fn(|i| -act.close.weights[i + 1]);
        (faces && is_near).then_some(Meeting { point, own, triangle, weights, weight: act.weight })
    }

    /// Forces, pressures and areas of each pair of bodies that act on each other.
    pub(super) fn pairs_of_bodies(&self) -> Vec<BodyPair> {
        let mut list: BTreeMap<[u32; 2], BodyPair> = BTreeMap::new();
        let mut pressures = Pressures::default();
        let mut joint = Joint::default();
        for act in &self.acts {
            let force = self.force(act, &mut joint, false);
            let [a, b] = act.end.classes.map(|class| self.rules.body(class));
            let bodies = [a.min(b), a.max(b)];
            let pair = list.entry(bodies).or_insert(BodyPair::none(bodies));
            let distance = act.close.distance_squared.sqrt();
            pair.distance = pair.distance.min(distance);
            pair.friction_work += force.work;
            if distance < act.thickness {
                pair.active += 1;
                pressures.add(self, bodies, act, &joint, force.first);
            }
            // Forces on the points of the first body; of a body on itself they cancel.
            let points = if a <= b { 0..force.first } else { force.first..joint.points.len() };
            for i in points.filter(|_| a != b) {
                let force = -(joint.barrier[i] + joint.friction[i]);
                let moment = self.x[joint.points[i] as usize].cross(&force);
                for c in 0..3 {
                    pair.force[c] += force[c];
                    pair.moment[c] += moment[c];
                }
            }
        }
        let areas = self.areas_in_contact();
        for (&bodies, &area) in &areas {
            list.entry(bodies).and_modify(|pair| pair.area = area);
        }
        for (bodies, pressure) in pressures.largest(self, &areas) {
            list.entry(bodies).and_modify(|pair| pair.pressure = pressure);
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
        let mut joint = Joint::default();
        for act in &self.acts {
            self.force(act, &mut joint, false);
            for (i, &point) in joint.points.iter().enumerate() {
                let force = -(joint.barrier[i] + joint.friction[i]);
                let moment = self.x[point as usize].cross(&force);
                self.skin.shares(point, 1.0, &mut |k, share| {
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
