//! Rigid bodies, beams, strings, joints and springs of a scene.

mod coupling;
mod equation;
mod extent;
mod joint;
mod line;
mod motion;
mod pretension;
mod redundant;
mod rigid;
mod support;

use super::mesh_files::MeshFiles;
use super::phase::Phases;
use super::placed::Placed;
use super::{Drawing, Problems};
use crate::scene::{Coupling, Kind, Scene};
use crate::solver::Model;
use std::collections::BTreeMap;
use stoss_multibody::{Beam, ConstraintSet, ElasticString, PointMass, RigidBody};
use stoss_term::{Bilateral as _, Term};

pub(super) use motion::{fix, prescribe_rigid};

/// What the parts of a scene that are no solids add to the model, for whoever needs more than the model knows.
#[derive(Default)]
pub(super) struct Parts {
    /// Parts in the order of the scene: rigid bodies, beams, strings, point masses.
    pub placed: Vec<Placed>,
    /// One line a part for `check`.
    pub lines: Vec<String>,
    /// What frames show.
    pub drawing: Drawing,
    /// Rigid bodies in the order of `[[rigid]]`.
    pub rigids: Vec<RigidBody>,
    /// Beams in the order of `[[beam]]`.
    pub beams: Vec<Beam>,
    /// Strings in the order of `[[string]]`.
    pub strings: Vec<ElasticString>,
    /// Point masses in the order of `[[mass]]`.
    pub masses: Vec<PointMass>,
    /// Reference bodies of sets of deformable bodies.
    pub couplings: BTreeMap<(String, Coupling), RigidBody>,
    /// Nodes of sets of one node, which joints and springs hold on to.
    pub nodes: BTreeMap<String, u32>,
    /// Place of each equation in the model's contacts.
    pub equations: Vec<Option<usize>>,
    /// Place of each joint in the model's contacts.
    pub joints: Vec<Option<usize>>,
    /// Place of each spring in the model's parts.
    pub springs: Vec<Option<usize>>,
}

/// Adds the parts to the model.
pub(super) fn parts(
    scene: &Scene,
    model: &mut Model,
    mesh_files: &mut MeshFiles,
    problems: &mut Problems<'_>,
) -> Parts {
    let mut parts = Parts::default();
    rigid::rigids(scene, model, mesh_files, &mut parts, problems);
    line::lines(scene, model, &mut parts, problems);
    parts
}

impl Parts {
    /// Carriers and weights of a point of a rigid body.
    pub fn point(&self, name: &str, x: [f64; 3]) -> Option<Vec<(u32, f64)>> {
        self.rigid(name).map(|body| body.point(x).terms)
    }

    /// First vector of the reference body of a set of a deformable body.
    pub fn reference_body(&self, set: &str, coupling: Coupling) -> Option<u32> {
        self.couplings.get(&(set.to_owned(), coupling)).map(RigidBody::first)
    }

    /// The rigid body of that name.
    pub fn rigid(&self, name: &str) -> Option<&RigidBody> {
        self.rigids.iter().find(|body| body.name() == name)
    }
}

/// Adds the constraints of the parts: rigidity, couplings of sets, equations, joints; and springs, which hold on the same things.
pub(super) fn constraints(
    scene: &Scene,
    placed: &[Placed],
    phases: &Phases,
    parts: &mut Parts,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) {
    let mut couplings = coupling::couplings(scene, placed, model, parts, problems);
    couplings.extend(coupling::named(scene, placed, parts, model, problems));
    let mut equations = equation::equations(scene, placed, parts, model, problems);
    let mut joints = joint::joints(scene, parts, model, problems);
    pretension::check(scene, placed, problems, warnings);
    let bodies = parts.rigids.iter().chain(parts.couplings.values());
    let mut rigidity: Vec<ConstraintSet> = bodies.map(RigidBody::constraints).collect();
    rigidity.extend(parts.beams.iter().map(Beam::constraints));
    if problems.list.is_empty() && !(couplings.is_empty() && joints.is_empty() && equations.is_empty()) {
        let held = redundant::Held { couplings: &mut couplings, equations: &mut equations, joints: &mut joints };
        redundant::examine(scene, phases, &rigidity, held, model, problems, warnings);
    }
    if scene.is_dynamic() && scene.stages.first().is_none_or(|stage| stage.kind == Kind::Dynamic) {
        warnings.extend(motion::velocities(scene, &couplings, &equations, &joints, model));
    }
    rigidity.into_iter().chain(couplings).for_each(|set| push(model, set));
    for equation in equations {
        parts.equations.push(equation.map(|equation| {
            push(model, equation);
            model.contacts.len() - 1
        }));
    }
    for joint in joints {
        parts.joints.push(joint.map(|joint| {
            let has_limits = joint.has_limits();
            push(model, joint);
            if let Some(pair) = model.contacts.last_mut().filter(|_| has_limits) {
                let item = scene.joints.iter().find(|item| item.name == pair.name);
                pair.restitution = Some(item.and_then(|item| item.restitution).unwrap_or(0.0));
            }
            model.contacts.len() - 1
        }));
    }
    parts.springs = joint::springs(scene, parts, model, problems);
    support::supports(scene, placed, model, problems);
}

fn push(model: &mut Model, constraint: impl Term + 'static) {
    let name = constraint.name().to_owned();
    model.contacts.push(crate::solver::CouplingTerm::new(name, constraint, 1.0));
}
