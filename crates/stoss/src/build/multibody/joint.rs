//! Joints and springs: what they hold on each side.

use super::Parts;
use super::extent::extent;
use super::redundant::weights as typical_weights;
use crate::build::Problems;
use crate::scene::{
    ActingOn, CoordinateKind, Coupling, GROUND, Joint as SceneJoint, PartKind, Scene, Series, split_set,
};
use crate::solver::Model;
use std::sync::Arc;
use stoss_multibody::{
    CoordinateFriction, CoordinateOptions, CoordinateSpring, Embedded, Joint, JointFrame, PiecewiseLinear, Pretension,
    Spring, SpringData, Weights, axes_along,
};

/// Part of the size of an element by which a point may be away from the node that it is said to be.
const IN_PLACE: f64 = 1e-6;

/// One side of a joint or spring: what moves, and a length and a mass that are typical of it.
struct Side {
    frame: JointFrame,
    length: Option<f64>,
    mass: Option<f64>,
}

/// Finds what the sides of a joint hold on.
struct Sides<'a> {
    scene: &'a Scene,
    parts: &'a Parts,
    model: &'a Model,
}

impl Sides<'_> {
    /// The side of this name at a point, with three directions.
    fn find(
        &self,
        name: &str,
        at: [f64; 3],
        axes: [[f64; 3]; 3],
        coupling: Coupling,
        key: &str,
        problems: &mut Problems<'_>,
    ) -> Option<Side> {
        if name == GROUND {
            return Some(Side { frame: JointFrame::ground(at, axes), length: None, mass: None });
        }
        let (part, set) = split_set(name).map_or((name, None), |(part, set)| (part, Some(set)));
        // Points without directions get some that do not turn; no joint that needs others is let through by the scene.
        let point = |point: Embedded| JointFrame { point, axes: axes.map(Embedded::ground) };
        let mass_of = |name: &str| {
            let part = self.model.parts.iter().find(|part| part.name() == name)?;
            let mut total = 0.0;
            part.mass(&mut |i, j, m| {
                if !part.is_direction(i) && !part.is_direction(j) {
                    total += if i == j { m } else { 2.0 * m };
                }
            });
            Some(total).filter(|&m| m > 0.0)
        };
        let (frame, length) = match self.scene.part(part)? {
            (PartKind::Rigid, r) => {
                let body = &self.parts.rigids[r];
                (body.frame(at, axes), body.director_length())
            }
            (PartKind::Beam, b) => {
                let beam = &self.parts.beams[b];
                let node = match set {
                    Some("start") => 0,
                    Some("end") => beam.node_count() - 1,
                    _ => beam.nearest_node(at),
                };
                let frame = JointFrame { point: beam.point(node, at), axes: axes.map(|a| beam.direction(node, a)) };
                (frame, beam.director_length())
            }
            (PartKind::String, s) => {
                let string = &self.parts.strings[s];
                let node = if set == Some("start") { 0 } else { string.node_count() - 1 };
                (point(string.point(node)), string.natural_length() / string.node_count() as f64)
            }
            (PartKind::Mass, m) => {
                // A point has no length of its own.
                let frame = point(self.parts.masses[m].position());
                return Some(Side { frame, length: None, mass: mass_of(part) });
            }
            (PartKind::Body, b) => {
                let solid = &self.model.bodies[b].solid;
                if let Some(&node) = self.parts.nodes.get(name) {
                    let place: [f64; 3] = std::array::from_fn(|i| self.model.reference[3 * node as usize + i]);
                    let away = (0..3).map(|i| (place[i] - at[i]).powi(2)).sum::<f64>().sqrt();
                    if away > IN_PLACE * solid.characteristic_length() {
                        let message = format!(
                            "its one node is at {place:?}, not at {at:?}, and cannot carry a point at a distance"
                        );
                        problems.add(
                            key.to_owned(),
                            name,
                            message,
                            "correct the point, or name a set with three nodes or more",
                        );
                        return None;
                    }
                    return Some(Side {
                        frame: point(Embedded::vector(node)),
                        length: Some(solid.characteristic_length()),
                        mass: self.model.bodies[b].density.map(|d| d * solid.characteristic_length().powi(3)),
                    });
                }
                let Some(coupled) = self.parts.couplings.get(&(name.to_owned(), coupling)) else {
                    problems.add(
                        key.to_owned(),
                        name,
                        "the set has no nodes to connect the joint to",
                        "choose another set",
                    );
                    return None;
                };
                return Some(Side {
                    frame: coupled.frame(at, axes),
                    length: Some(solid.characteristic_length()),
                    mass: self.model.bodies[b].density.map(|d| d * solid.characteristic_length().powi(3)),
                });
            }
        };
        Some(Side { frame, length: Some(length), mass: mass_of(part) })
    }
}

/// The joints of a scene in its order; `None` for those with problems.
pub(super) fn joints(scene: &Scene, parts: &Parts, model: &Model, problems: &mut Problems<'_>) -> Vec<Option<Joint>> {
    let joint = |(j, item): (usize, &SceneJoint)| joint(scene, parts, model, item, &format!("joint[{j}]"), problems);
    scene.joints.iter().enumerate().map(joint).collect()
}

fn joint(
    scene: &Scene,
    parts: &Parts,
    model: &Model,
    item: &SceneJoint,
    key: &str,
    problems: &mut Problems<'_>,
) -> Option<Joint> {
    let [at_a, at_b] = item.at.both();
    let axes = match (item.axis, item.axes) {
        (Some(axis), _) => axes_along(axis)?,
        // The pin of the first side and that of the second, at right angles but for round-off in the scene.
        (None, Some([first, second])) => {
            let [a, ..] = axes_along(first)?;
            let along: f64 = (0..3).map(|i| second[i] * a[i]).sum();
            let [b, ..] = axes_along(std::array::from_fn(|i| second[i] - along * a[i]))?;
            let c = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            [a, b, c]
        }
        (None, None) => axes_along([1.0, 0.0, 0.0])?,
    };
    let sides = Sides { scene, parts, model };
    let side = |k: usize, at, problems: &mut Problems<'_>| {
        let coupling = item.coupling.unwrap_or(Coupling::Distributing);
        sides.find(&item.between[k], at, axes, coupling, &format!("{key}.between[{k}]"), problems)
    };
    let (a, b) = (side(0, at_a, problems)?, side(1, at_b, problems)?);
    let smaller = |x: Option<f64>, y: Option<f64>| x.into_iter().chain(y).fold(f64::INFINITY, f64::min);
    let length = Some(smaller(a.length, b.length)).filter(|l| l.is_finite());
    let length = length.unwrap_or_else(|| extent(scene, &model.reference));
    let apart = (0..3).map(|i| (at_b[i] - at_a[i]).powi(2)).sum::<f64>().sqrt();
    let kind = item.kind.kind(apart);
    let weights = match smaller(a.mass, b.mass) {
        mass if mass.is_finite() => Weights { mass, stiffness: 0.0 },
        _ => typical_weights(scene, model),
    };
    let made = Joint::new(&item.name, kind, &a.frame, &b.frame, length, &model.reference)
        .and_then(|joint| {
            // Of the joints with a pretension, sliders, there is one coordinate.
            let of = |kind, acting| options(kind, acting, item.pretension.as_ref());
            let mut acting = item.coordinates().into_iter().enumerate();
            acting.try_fold(joint, |joint, (k, (kind, acting))| joint.with_options_of(k, of(kind, acting)))
        })
        .map(|joint| joint.with_weights(weights));
    let remedy = "points and axes are those of the initial configuration; correct the joint or the place of its parts";
    made.map_err(|error| problems.add(key.to_owned(), &item.name, error.to_string(), remedy)).ok()
}

/// What acts on a coordinate: angles in radians from here on.
fn options(kind: CoordinateKind, item: ActingOn, pretension: Option<&crate::scene::Pretension>) -> CoordinateOptions {
    let unit = if kind == CoordinateKind::Angle { 1f64.to_radians() } else { 1.0 };
    let drive = |series: &Series, unit: f64| {
        let rows = series.rows().iter().map(|row| (row[0], unit * row[1])).collect();
        Arc::new(PiecewiseLinear(rows)) as Arc<dyn stoss_multibody::Drive>
    };
    let motor = item.motor.as_ref().and_then(|motor| {
        let angle = motor.angle.as_ref().map(|series| drive(series, 1f64.to_radians()));
        angle.or_else(|| motor.displacement.as_ref().map(|series| drive(series, 1.0)))
    });
    let friction = item.friction.as_ref();
    CoordinateOptions {
        spring: item.spring.as_ref().map(|s| CoordinateSpring { stiffness: s.stiffness, rest: unit * s.rest }),
        viscous: friction.map_or(0.0, |f| f.viscous) + item.spring.as_ref().map_or(0.0, |s| s.damping),
        friction: friction.filter(|f| f.coulomb.is_some() || f.coefficient.is_some()).map(|f| CoordinateFriction {
            bound: f.coulomb.unwrap_or(0.0),
            coefficient: f.coefficient.unwrap_or(0.0),
            radius: f.radius.unwrap_or(1.0),
        }),
        motor,
        pretension: pretension.map(|p| Pretension { force: drive(&p.force, 1.0), lock: p.lock }),
        limits: item.limits.map(|limits| limits.map(|l| unit * l)),
    }
}

/// Adds the springs of a scene.
pub(super) fn springs(
    scene: &Scene,
    parts: &Parts,
    model: &mut Model,
    problems: &mut Problems<'_>,
) -> Vec<Option<usize>> {
    const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut places = vec![None; scene.springs.len()];
    for (s, item) in scene.springs.iter().enumerate() {
        let key = format!("spring[{s}]");
        let sides = Sides { scene, parts, model };
        let mut side = |k: usize| {
            let key = format!("{key}.between[{k}]");
            sides.find(&item.between[k], item.at[k], AXES, Coupling::Distributing, &key, problems)
        };
        let (Some(a), Some(b)) = (side(0), side(1)) else { continue };
        let apart = (0..3).map(|i| (item.at[1][i] - item.at[0][i]).powi(2)).sum::<f64>().sqrt();
        let data = SpringData {
            stiffness: item.stiffness,
            rest_length: item.rest_length.unwrap_or(apart),
            tension_only: item.tension_only,
            damping: item.damping,
        };
        match Spring::new(&item.name, [a.frame.point, b.frame.point], data).map(|spring| spring.with_length(apart)) {
            Ok(spring) => {
                places[s] = Some(model.parts.len());
                model.parts.push(Box::new(spring));
            }
            Err(error) => problems.add(key, &item.name, error.to_string(), "correct the spring's data"),
        }
    }
    places
}
