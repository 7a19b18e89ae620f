//! Replacement of [`super::multibody`] where the feature is not built in: there are no parts. Scenes with some are refused before.

use super::condition::RigidMotion;
use super::mesh_files::MeshFiles;
use super::phase::Phases;
use super::placed::Placed;
use super::{Drawing, Problems};
use crate::scene::{Coupling, Prescribe, Scene};
use crate::solver::Model;

/// The parts of a program without multibody systems: none.
#[derive(Default)]
pub(super) struct Parts {
    pub placed: Vec<Placed>,
    pub lines: Vec<String>,
    pub drawing: Drawing,
    pub equations: Vec<Option<usize>>,
    pub joints: Vec<Option<usize>>,
    pub springs: Vec<Option<usize>>,
}

impl Parts {
    pub fn point(&self, _: &str, _: [f64; 3]) -> Option<Vec<(u32, f64)>> {
        None
    }

    pub fn reference_body(&self, _: &str, _: Coupling) -> Option<u32> {
        None
    }
}

pub(super) fn parts(_: &Scene, _: &mut Model, _: &mut MeshFiles, _: &mut Problems<'_>) -> Parts {
    Parts::default()
}

pub(super) fn fix(_: &Scene, _: &Parts, _: &mut Model) {}

pub(super) fn prescribe_rigid(_: &Prescribe, _: &Parts) -> Option<RigidMotion> {
    None
}

pub(super) fn constraints(
    _: &Scene,
    _: &[Placed],
    _: &Phases,
    _: &mut Parts,
    _: &mut Model,
    _: &mut Problems<'_>,
    _: &mut Vec<String>,
) {
}
