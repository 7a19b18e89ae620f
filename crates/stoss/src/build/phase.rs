//! The stages of a scene as they matter to what is built once: which scheme each has, and what acts in it.
//!
//! Whatever can differ between stages is decided by the methods themselves, when a step begins. What is decided here is refused or warned of if it is wrong in one of the stages in which the
//! thing acts, and chosen as for the first of them: what is off, and what comes later, changes nothing.

use crate::scene::{Integrator, Kind, Scene};
use crate::solver::Model;
use std::collections::BTreeSet;
use stoss_integrators::GradientRule;
use stoss_term::HeldNodes;

/// A stage; of a scene without stages the whole run.
#[derive(Clone, Debug)]
pub(super) struct Phase {
    /// `None`: statics.
    integrator: Option<Integrator>,
    step: f64,
    /// Names of what is switched off.
    off: BTreeSet<String>,
    /// Prescriptions of the model that are switched off.
    idle: BTreeSet<usize>,
}

impl Phase {
    /// The time-stepping scheme; `None` in statics.
    pub fn integrator(&self) -> Option<&Integrator> {
        self.integrator.as_ref()
    }

    /// Whether there is inertia.
    pub fn has_rates(&self) -> bool {
        self.integrator.is_some()
    }

    /// Nominal step size.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Where gradients of constraints are taken: in statics at the end point.
    pub fn rule(&self) -> GradientRule {
        // A scheme that cannot be made is reported where it is named.
        let scheme = self.integrator.as_ref().and_then(|integrator| integrator.make().ok());
        scheme.map_or(GradientRule::EndPoint, |scheme| scheme.rule(self.step).constraint.rule)
    }

    /// Name of the scheme if it takes them elsewhere than at the end of the step.
    pub fn scheme_within_step(&self) -> Option<&str> {
        let integrator = self.integrator.as_ref()?;
        (self.rule() != GradientRule::EndPoint).then_some(integrator.scheme.as_str())
    }

    /// Whether what has this name is not switched off; what has none always acts.
    #[cfg(any(feature = "general", feature = "nts", feature = "mortar"))]
    pub fn acts(&self, name: Option<&str>) -> bool {
        name.is_none_or(|name| !self.off.contains(name))
    }

    /// What the prescriptions that act say of the motion of nodes.
    pub fn held_nodes(&self, model: &Model) -> HeldNodes {
        model.held_nodes(|p| !self.idle.contains(&p))
    }
}

/// All stages, at least one.
#[derive(Clone, Debug)]
pub(super) struct Phases {
    list: Vec<Phase>,
    /// Prescriptions of the model that events release.
    released: BTreeSet<usize>,
}

impl Phases {
    /// The phases of a scene whose prescriptions have these places in the model.
    pub fn new(scene: &Scene, places: &[Option<usize>]) -> Self {
        let own = scene.time.integrator.clone().filter(|_| scene.is_dynamic());
        let idle = |off: &BTreeSet<String>| -> BTreeSet<usize> {
            let named = scene.prescriptions.iter().zip(places);
            let named = named.filter_map(|(item, place)| Some((item.name.as_ref()?, (*place)?)));
            named.filter(|(name, _)| off.contains(*name)).map(|(_, place)| place).collect()
        };
        let stage = |stage: &crate::scene::Stage| {
            let off: BTreeSet<String> = stage.off.iter().cloned().collect();
            let integrator = match stage.kind {
                Kind::QuasiStatic => None,
                Kind::Dynamic => stage.integrator.clone().or_else(|| own.clone()),
            };
            Phase { integrator, step: stage.step.unwrap_or(scene.time.step), idle: idle(&off), off }
        };
        let mut list: Vec<Phase> = scene.stages.iter().map(stage).collect();
        if list.is_empty() {
            let (off, idle) = (BTreeSet::new(), BTreeSet::new());
            list.push(Phase { integrator: own, step: scene.time.step, off, idle });
        }
        let released = idle(&scene.events.iter().map(|event| event.release.clone()).collect());
        Self { list, released }
    }

    /// All phases.
    pub fn all(&self) -> impl Iterator<Item = &Phase> + Clone {
        self.list.iter()
    }

    /// The first of them.
    #[cfg(feature = "general")]
    pub fn first(&self) -> &Phase {
        &self.list[0]
    }

    /// What prescriptions that act from the beginning to the end say of the motion of nodes.
    pub fn lasting(&self, model: &Model) -> HeldNodes {
        let ends = |p: usize| self.released.contains(&p) || self.list.iter().any(|phase| phase.idle.contains(&p));
        model.held_nodes(|p| !ends(p))
    }

    /// The phases in which what has this name acts; none if it is off from the beginning to the end.
    pub fn with<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Phase> + Clone {
        self.list.iter().filter(move |phase| !phase.off.contains(name))
    }

    /// The first of those, or if there is none the first of all.
    pub fn first_with<'a>(&'a self, name: &'a str) -> &'a Phase {
        self.with(name).next().unwrap_or(&self.list[0])
    }
}
