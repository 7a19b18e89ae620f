//! What acts beside solids and what it remembers: of a scene, and of its run.

use stoss_scene::Scene;
use stoss_solver::{Model, Simulation};

use super::comparison::{Comparison, Item, compare, flags};

/// Terms by what they are, and state beyond positions and velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Acting {
    /// Contact of pairs of surfaces, or a limit of a joint.
    pub unilateral: bool,
    /// General contact.
    pub general: bool,
    /// Ties, joints, couplings, equations, inclined supports, led rigid bodies.
    pub bilateral: bool,
    /// Rigid bodies, beams, strings, springs.
    pub parts: bool,
    /// Friction of contact: a table of points with their slip.
    pub friction: bool,
    /// Rates of Rayleigh damping.
    pub damping: bool,
    /// Inner state of materials that yield, creep or soften.
    pub inner_state: bool,
}

impl Acting {
    fn items(self) -> Vec<Item> {
        let Self { unilateral, general, bilateral, parts, friction, damping, inner_state } = self;
        flags(&[
            ("contact of pairs", unilateral),
            ("general contact", general),
            ("constraints", bilateral),
            ("parts", parts),
            ("friction", friction),
            ("damping", damping),
            ("inner state", inner_state),
        ])
    }

    /// Item by item.
    pub fn against(&self, asked: &Self) -> Comparison {
        compare(&asked.items(), &self.items())
    }

    /// What a scene asks for.
    pub fn asked(scene: &Scene) -> Self {
        let general = scene.general_contact();
        let coordinates = || scene.joints.iter().flat_map(stoss_scene::Joint::coordinates).map(|(_, acting)| acting);
        let limits = coordinates().any(|acting| acting.limits.is_some());
        let rubs = |contact: &stoss_scene::Contact| contact.friction.is_some();
        let flows = |body: &stoss_scene::Body| {
            let material = &body.material.inelasticity;
            material.plasticity.is_some() || !material.prony.is_empty() || material.mullins.is_some()
        };
        let general_friction = general.as_ref().is_some_and(|table| {
            let own = table.pairs.iter().filter_map(|pair| pair.friction.as_ref());
            std::iter::once(&table.friction).chain(own).any(|friction| friction.law().is_some())
        });
        Self {
            unilateral: !scene.contacts.is_empty() || limits,
            general: general.is_some(),
            bilateral: !scene.ties.is_empty()
                || !scene.joints.is_empty()
                || !scene.couplings.is_empty()
                || !scene.equations.is_empty()
                || !scene.supports.is_empty()
                || scene.prescriptions.iter().any(|item| item.rigid.is_some()),
            parts: !scene.rigids.is_empty()
                || !scene.beams.is_empty()
                || !scene.strings.is_empty()
                || !scene.masses.is_empty()
                || !scene.springs.is_empty(),
            friction: scene.contacts.iter().any(rubs) || general_friction,
            damping: scene.bodies.iter().any(|body| body.damping.is_some()),
            inner_state: scene.bodies.iter().any(flows),
        }
    }

    /// What a run has.
    pub fn found(simulation: &Simulation) -> Self {
        let model = simulation.model();
        let any =
            |is: &dyn Fn(&dyn stoss_term::Term) -> bool| model.contacts.iter().any(|coupling| is(&*coupling.term));
        Self {
            unilateral: any(&|term| term.unilateral().is_some()),
            general: any(&|term| term.potential().is_some()),
            bilateral: any(&|term| term.bilateral().is_some()),
            parts: !model.parts.is_empty(),
            friction: any(&|term| term.has_friction()),
            damping: model.bodies.iter().any(|body| body.damping.acts()),
            inner_state: model.bodies.iter().any(|body| body.solid.has_history()),
        }
    }
}

/// Bytes of what terms remember from step to step.
pub fn remembered(model: &Model) -> usize {
    model.contacts.iter().map(|coupling| coupling.term.save_history().len()).sum()
}
