//! What is known of a run: scene, model, facts of the solver, verdict of the watch.

use super::{Attempt, Remedy, Where, toml};
use crate::build::{OwnLaws, Placed, placed_parts};
use crate::scene::{Integrator, Scene, split_set};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use stoss_mesh::Mesh;
use stoss_reference_element::FacetNodes;
use stoss_solver::{FailedAttempt, FailureKind, Model, Place, Simulation};
use stoss_watch::{Severity, Verdict};

/// Most failed attempts that are reported.
const MOST_ATTEMPTS: usize = 4;

/// Case of a diagnosis: a run that stopped, came out wrong, or did neither.
pub struct DiagnosedRun<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The simulation at its last completed step.
    pub simulation: &'a Simulation,
    /// What the watch has found.
    pub verdict: &'a Verdict,
    /// What stopped it.
    error: Option<String>,
    folder: PathBuf,
    laws: OwnLaws,
    /// Made when somebody asks for a set or a mesh.
    parts: OnceCell<Vec<Placed>>,
    /// Names of the bodies as the verdict counts them: solids, then rigid surfaces.
    watched: Vec<String>,
}

impl<'a> DiagnosedRun<'a> {
    /// The case of a simulation of a scene whose mesh files are sought in `folder`; `watched` are the names of the bodies with a surface, in the order of the
    /// watch, and `error` is what stopped it.
    pub fn new(
        scene: &'a Scene,
        folder: &Path,
        laws: &OwnLaws,
        simulation: &'a Simulation,
        watched: Vec<String>,
        verdict: &'a Verdict,
        error: Option<String>,
    ) -> Self {
        let (folder, laws) = (folder.to_path_buf(), laws.clone());
        Self { scene, simulation, verdict, error, folder, laws, parts: OnceCell::new(), watched }
    }

    pub(super) fn model(&self) -> &Model {
        self.simulation.model()
    }

    /// The prescriptions that act now.
    pub(super) fn prescriptions(&self) -> impl Iterator<Item = &stoss_solver::Prescription> {
        let acting = self.model().prescriptions.iter().zip(self.simulation.acting_prescriptions());
        acting.filter(|(_, acts)| **acts).map(|(prescription, _)| prescription)
    }

    /// The last failed attempt, if it was what stopped the run.
    pub(super) fn failure(&self) -> Option<&FailedAttempt> {
        self.failures().last()
    }

    /// The failed attempts of the step that stopped the run; none if something else did.
    pub(super) fn failures(&self) -> &[FailedAttempt] {
        let failures = self.simulation.failures();
        let is_present = failures.last().is_some_and(|last| last.step > self.simulation.step());
        if self.error.is_some() && is_present { failures } else { &[] }
    }

    /// Whether the run stopped with one of these.
    pub(super) fn failed_by(&self, kinds: &[FailureKind]) -> bool {
        self.failure().is_some_and(|failure| kinds.contains(&failure.kind))
    }

    /// Whether an error stopped it.
    pub(super) fn is_stopped(&self) -> bool {
        self.error.is_some()
    }

    /// The smallest step that failed before the run stopped.
    pub(super) fn smallest_failed(&self) -> Option<f64> {
        self.failures().iter().map(|failure| failure.dt).min_by(f64::total_cmp)
    }

    /// Half the present step; nothing if as small a one failed already, or the run chooses its steps.
    pub(super) fn smaller_step(&self) -> Option<Remedy> {
        let smallest = self.smallest_failed().filter(|_| !self.is_automatic())?;
        let half = toml::down(0.5 * self.step_size());
        (half < smallest).then(|| Remedy::set(self.step_key(), toml::number(half), "half the present value"))
    }

    /// Whether the run chooses its steps in the present stage.
    pub(super) fn is_automatic(&self) -> bool {
        let stage = self.scene.stages.get(self.simulation.stage().saturating_sub(1) as usize);
        stage.and_then(|stage| stage.automatic.as_ref()).or(self.scene.time.automatic.as_ref()).is_some()
    }

    /// Nominal size of the steps of the present stage.
    pub(super) fn step_size(&self) -> f64 {
        let stage = self.scene.stages.get(self.simulation.stage().saturating_sub(1) as usize);
        stage.and_then(|stage| stage.step).unwrap_or(self.scene.time.step)
    }

    /// End of the present stage.
    pub(super) fn stage_end(&self) -> f64 {
        let stage = self.scene.stages.get(self.simulation.stage().saturating_sub(1) as usize);
        stage.map_or(self.scene.time.end, |stage| stage.until)
    }

    /// Whether it stopped or came out wrong or doubtful.
    pub(super) fn is_bad(&self) -> bool {
        self.error.is_some() || self.verdict.level != Severity::Sound
    }

    /// What happened, empty if nothing did.
    pub(super) fn what(&self) -> String {
        let found = self.verdict.reasons.first().map(|found| found.sentence.clone());
        self.error.clone().or(found).unwrap_or_default()
    }

    /// Place where it happened.
    pub(super) fn place(&self) -> Where {
        if let Some(failure) = self.failure() {
            return self.place_of(&failure.place);
        }
        let found = self.verdict.reasons.first().filter(|_| self.error.is_none());
        found.map_or_else(Where::default, |found| {
            let names = found.bodies.map(|[a, b]| [self.watched_name(a), self.watched_name(b)]);
            Where {
                text: match &names {
                    Some([a, b]) if a != b => format!("between `{a}` and `{b}`"),
                    Some([a, _]) => format!("`{a}`"),
                    None => String::new(),
                },
                body: names.map(|[a, _]| a),
                position: found.position,
                ..Where::default()
            }
        })
    }

    /// The last failed attempts in words.
    pub(super) fn attempts(&self) -> Vec<Attempt> {
        let failures = self.failures();
        let skipped = failures.len().saturating_sub(MOST_ATTEMPTS);
        let attempt = |failure: &FailedAttempt| Attempt {
            dt: failure.dt,
            reason: failure.reason.clone(),
            residuals: failure.newton.iter().map(|row| row.residual).filter(|r| r.is_finite()).collect(),
            changing: failure.slots.iter().map(|slot| (self.slot_name(slot.pair, slot.slot), slot.changes)).collect(),
        };
        failures[skipped..].iter().map(attempt).collect()
    }

    pub(super) fn slot_name(&self, pair: usize, slot: usize) -> String {
        let node = self.slot_node(pair, slot);
        let text = node.map_or_else(|| format!("slot {slot}"), |node| self.node(node).text);
        format!("{text} in contact `{}`", self.model().contacts[pair].name)
    }

    fn slot_node(&self, pair: usize, slot: usize) -> Option<u32> {
        Some(self.simulation.contact_report(pair).ok()?.get(slot)?.node)
    }

    /// Name of a body as the verdict counts.
    pub(super) fn watched_name(&self, body: usize) -> String {
        self.watched.get(body).cloned().unwrap_or_else(|| format!("body {body}"))
    }

    /// A place of the solver in words.
    pub(super) fn place_of(&self, place: &Place) -> Where {
        let mut found = match (place.node, place.element) {
            (Some(node), _) => self.node(node),
            (None, Some((body, element))) => self.element(body, element),
            (None, None) => Where::default(),
        };
        if let Some((_, element)) = place.element.filter(|_| place.node.is_some()) {
            found.text = format!("element {element} at {}", found.text);
            found.element = Some(element);
        }
        if let Some((pair, _)) = place.slot {
            let name = self.model().contacts[pair].name.clone();
            found.text =
                if found.text.is_empty() { format!("`{name}`") } else { format!("{} in `{name}`", found.text) };
            found.pair = Some(name);
        }
        found
    }

    /// A node.
    pub(super) fn node(&self, node: u32) -> Where {
        let model = self.model();
        let position = self.position(node);
        let [x, y, z] = position;
        let at = format!("({x:.4}, {y:.4}, {z:.4})");
        if let Some(body) = model.bodies.iter().find(|body| body.nodes.contains(&node)) {
            let (local, name) = (node - body.nodes.start, body.solid.name());
            return Where {
                text: format!("node {local} of `{name}` at {at}"),
                body: Some(name.to_owned()),
                node: Some(local),
                position: Some(position),
                ..Where::default()
            };
        }
        match model.parts.iter().find(|part| part.own_vectors().contains(&node)) {
            Some(part) => Where {
                text: format!("`{}`", part.name()),
                body: Some(part.name().to_owned()),
                position: (!part.is_direction(node)).then_some(position),
                ..Where::default()
            },
            None => Where { text: format!("the point {at}"), position: Some(position), ..Where::default() },
        }
    }

    /// An element of a body of the model.
    pub(super) fn element(&self, body: usize, element: usize) -> Where {
        let solid = &self.model().bodies[body].solid;
        let nodes: Vec<_> = solid.elements()[element].iter().map(|&node| self.position(node)).collect();
        let position: [f64; 3] = std::array::from_fn(|i| nodes.iter().map(|x| x[i]).sum::<f64>() / nodes.len() as f64);
        let [x, y, z] = position;
        Where {
            text: format!("element {element} of `{}` at ({x:.4}, {y:.4}, {z:.4})", solid.name()),
            body: Some(solid.name().to_owned()),
            element: Some(element),
            position: Some(position),
            ..Where::default()
        }
    }

    /// Position of a node at the end of the last completed step.
    pub(super) fn position(&self, node: u32) -> [f64; 3] {
        let at = 3 * node as usize;
        let q = &self.simulation.state().q;
        std::array::from_fn(|i| q.get(at + i).copied().unwrap_or(f64::NAN))
    }

    /// The mesh of a deformable body in its place.
    pub(super) fn mesh(&self, body: &str) -> Option<&Mesh> {
        self.part(body)?.mesh()
    }

    pub(super) fn part(&self, name: &str) -> Option<&Placed> {
        self.placed().iter().find(|part| part.name == name)
    }

    /// Names of all parts.
    pub(super) fn part_names(&self) -> Vec<String> {
        self.placed().iter().map(|part| part.name.clone()).collect()
    }

    fn placed(&self) -> &[Placed] {
        self.parts.get_or_init(|| placed_parts(self.scene, &self.folder, &self.laws))
    }

    /// Facets of a set `part.set`, none if it has none.
    pub(super) fn facets(&self, set: &str) -> Vec<FacetNodes> {
        let facets = || self.part(split_set(set)?.0)?.facets_of(split_set(set)?.1).ok();
        facets().unwrap_or_default()
    }

    /// Nodes of a set `part.set`, none if it has none.
    pub(super) fn nodes(&self, set: &str) -> Vec<u32> {
        let nodes = || self.part(split_set(set)?.0)?.nodes_of(split_set(set)?.1).ok();
        nodes().unwrap_or_default()
    }

    /// Largest extent of a body in the reference, and length of an edge of its elements: the cube root of their mean volume.
    pub(super) fn sizes(&self, body: usize) -> Option<(f64, f64)> {
        let model = self.model();
        let (solid, nodes) = (&model.bodies.get(body)?.solid, &model.bodies.get(body)?.nodes);
        let along = |i: usize| nodes.clone().map(move |node| model.reference[3 * node as usize + i]);
        let extent = |i: usize| along(i).fold(f64::MIN, f64::max) - along(i).fold(f64::MAX, f64::min);
        let size = (0..3).map(extent).fold(0.0, f64::max);
        Some((size, (solid.volume() / solid.element_count().max(1) as f64).cbrt()))
    }

    /// Number of the scene's contact that a pair of the model is.
    pub(super) fn contacts(&self) -> impl Iterator<Item = (usize, &crate::scene::Contact)> {
        let pairs = &self.model().contacts;
        self.scene
            .contacts
            .iter()
            .enumerate()
            .filter(move |(c, item)| pairs.get(*c).is_some_and(|pair| pair.name == item.label()))
    }

    /// Key and value of the scheme of the present stage, if it is dynamic.
    pub(super) fn integrator(&self) -> Option<(String, &Integrator)> {
        if !self.simulation.plan().rule.has_inertia() {
            return None;
        }
        let stage = (self.simulation.stage() as usize).saturating_sub(1);
        let own = self.scene.stages.get(stage).and_then(|stage| stage.integrator.as_ref());
        let own = own.map(|integrator| (format!("stage[{stage}].integrator"), integrator));
        own.or_else(|| Some(("time.integrator".to_owned(), self.scene.time.integrator.as_ref()?)))
    }

    /// Key of the step size of the present stage.
    pub(super) fn step_key(&self) -> String {
        let stage = self.simulation.stage() as usize;
        match self.scene.stages.is_empty() {
            true => "time.step".to_owned(),
            false => format!("stage[{}].step", stage.saturating_sub(1)),
        }
    }
}
