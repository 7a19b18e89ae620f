//! One contact of a scene, its surfaces found: what all methods look at and tell.

use super::phase::{Phase, Phases};
use super::young;
use super::{ContactPlan, FrictionPlan, OwnLaws, Placed, Problems};
use crate::points::Points;
use crate::scene::{Closing, Constraint, Enforcement, GapAtClosing, Integrals, Scene, split_set};
use crate::solver::Model;
use std::collections::BTreeSet;
use stoss_contact::{PairScales, face_each_other, finer_side};
use stoss_mesh::Mesh;
use stoss_reference_element::{FacePiece, FacetNodes};
use stoss_term::{Auxiliary, HeldNodes, Hold, Overlap, StepContext, Term};

/// One contact of a scene, its surfaces found.
pub(super) struct PairInput<'a> {
    pub scene: &'a Scene,
    pub placed: &'a [Placed],
    pub laws: &'a OwnLaws,
    pub phases: &'a Phases,
    pub key: String,
    pub item: &'a crate::scene::Contact,
    /// Slave and master.
    pub bodies: [usize; 2],
    pub facets: [&'a [FacetNodes]; 2],
    /// Pieces of the faces that the facets are of, slave and master.
    pub pieces: [&'a [FacePiece]; 2],
    /// Nodes of a slave that is a beam or string and their lengths; it has no facets then.
    pub line: &'a [(u32, f64)],
    /// The slave and why, where the scene leaves it open.
    pub chosen: Option<String>,
    /// Slave nodes of ties.
    pub tied: &'a BTreeSet<u32>,
    /// Whether nodes of a side have no mass: their velocities do not jump, and there is no impact.
    pub is_massless: bool,
}

impl PairInput<'_> {
    /// The stages in which the contact acts, with what is known of the motion of nodes in them.
    #[cfg(feature = "mortar")]
    pub fn acting<'a>(&'a self, label: &'a str, model: &'a Model) -> impl Iterator<Item = (&'a Phase, HeldNodes)> {
        self.phases.with(label).map(|phase| (phase, self.held_nodes(phase, model)))
    }

    /// What prescriptions and ties say of the motion of nodes in the first stage in which the contact acts.
    #[cfg(feature = "nts")]
    pub fn first_held_nodes(&self, model: &Model) -> HeldNodes {
        self.held_nodes(self.phases.first_with(&self.item.label()), model)
    }

    /// What prescriptions and ties say of the motion of nodes in a stage.
    fn held_nodes(&self, phase: &Phase, model: &Model) -> HeldNodes {
        let mut support = phase.held_nodes(model);
        self.tied.iter().for_each(|&node| support.hold(node, Hold::Wholly));
        support
    }

    /// Tells that the method cannot be made of these surfaces.
    pub fn refused(&self, error: &stoss_contact::ContactError, problems: &mut Problems<'_>) {
        let remedy = "choose two different, not degenerate surfaces of different bodies";
        problems.add(self.key.clone(), self.item.label(), error.to_string(), remedy);
    }

    /// What the contact will be computed with.
    pub fn plan(&self, method: &dyn Term, constraint: Constraint, friction: Option<FrictionPlan>) -> ContactPlan {
        let item = self.item;
        ContactPlan {
            name: item.label(),
            slave: self.chosen.clone(),
            method: item.method.name.to_owned(),
            constraint: constraint.name().to_owned(),
            enforcement: match item.enforcement {
                Enforcement::Multiplier => "multiplier".to_owned(),
                Enforcement::Penalty(stiffness) => format!("penalty {stiffness:e}"),
            },
            slots: method.slot_count() as u64,
            restitution: self.restitution().filter(|_| self.phases.all().any(Phase::has_rates) && self.is_rigid()),
            is_assumed: self.given_restitution().is_none(),
            unknowns_per_slot: 1 + Auxiliary::equations(method.auxiliaries()) as u64,
            friction,
        }
    }

    /// Looks at the initial gaps; returns the factor of the complementarity function.
    pub fn prepare(
        &self,
        method: &mut dyn Term,
        constraint: Constraint,
        model: &Model,
        problems: &mut Problems<'_>,
        warnings: &mut Vec<String>,
    ) -> f64 {
        let Self { scene, placed, key, item, bodies, .. } = self;
        let label = item.label();
        let phase = self.phases.first_with(&label);
        // The first frame shows the gaps of the nodes that are in reach, as later ones do.
        let speed = Points::of(model).largest(&model.velocity);
        let reach = 2.0 * speed * phase.step() + 0.5 * method.length_scale();
        let (support, rule) = (self.held_nodes(phase, model), phase.rule());
        let begins = StepContext {
            rates: phase.has_rates(),
            reach,
            held: &support,
            ..StepContext::new(&model.reference, rule, phase.step())
        };
        let reference_gap = self.reference_gap(problems);
        let becomes = reference_gap.overlap;
        if let Some(own) = method.unilateral_mut().and_then(|of| of.reference_gap_mut()) {
            own.set(reference_gap);
        }
        if let Err(error) = method.begin(&begins) {
            problems.add(key.clone(), label.clone(), error.to_string(), "correct the surfaces");
        }
        match method.report(&model.reference) {
            Ok(reports) => {
                let tolerance = 1.0e-9 * method.length_scale();
                let inside = reports.iter().filter(|r| r.gap.is_some_and(|g| g < -tolerance)).count();
                let deepest = reports.iter().filter_map(|r| r.gap).fold(0.0, f64::min);
                if inside > 0 && becomes != Overlap::Keep {
                    let keeps = constraint == Constraint::Modified || (item.method.integrates && phase.has_rates());
                    let then = match (becomes, keeps) {
                        (Overlap::Ramp, _) => "that gap closes until the end of the stage",
                        (_, true) => "they keep that gap",
                        (_, false) => "the first step closes that gap and changes the energy",
                    };
                    warnings.push(format!(
                        "{}: {inside} slave nodes begin behind the master surface (deepest gap {deepest:.3e}); {then}",
                        item.label()
                    ));
                }
            }
            Err(error) => problems.add(key.clone(), item.label(), error.to_string(), "correct the surfaces"),
        }
        if self.line.is_empty() && !face_each_other(self.facets, &model.reference) {
            warnings.push(format!(
                "{}: no facet of the slave faces one of the master; there can be no contact before the bodies have turned. Name the sides that touch",
                item.label()
            ));
        }
        if let [Some(slave), Some(master)] = bodies.map(|b| placed[b].mesh()) {
            let names = bodies.map(|b| &placed[b].name);
            warnings.extend(overlap(&item.label(), [(names[0], slave), (names[1], master)]));
        }
        let length = method.length_scale();
        let scales = PairScales {
            young: bodies.map(|b| young(model, b)),
            length,
            axial: (!self.line.is_empty()).then(|| self.axial(model)),
            inertia: self.inertia(model, length),
            step: scene.time.step,
        };
        scales.complementarity()
    }
}

impl PairInput<'_> {
    /// Axial stiffness of the beam or string that is the slave, a force.
    fn axial(&self, model: &Model) -> f64 {
        let part = model.parts.iter().find(|part| part.name() == self.placed[self.bodies[0]].name);
        part.map_or(f64::INFINITY, |part| part.force_scale())
    }

    /// Mass per area of the elements behind the surfaces: the larger one, zero in statics. If the slave is a line its mass per length.
    pub fn inertia(&self, model: &Model, length: f64) -> f64 {
        let solid = |b: usize| model.bodies.get(b).and_then(|body| body.density).map(|density| density * length);
        // Of a rigid body all of it, over an area of the size of a facet; of a line all of it over its length.
        let extent = match self.line {
            [] => length * length,
            line => line.iter().map(|(_, length)| length).sum(),
        };
        let rigid = |b: usize| {
            let part = model.parts.iter().find(|part| part.name() == self.placed[b].name)?;
            let mut mass = 0.0;
            part.mass(&mut |i, j, m| mass += if i == j && !part.is_direction(i) { m } else { 0.0 });
            Some(mass / extent)
        };
        let bodies = if self.line.is_empty() { &self.bodies[..] } else { &self.bodies[..1] };
        bodies.iter().filter_map(|&b| solid(b).or_else(|| rigid(b))).fold(0.0, f64::max)
    }
}

impl PairInput<'_> {
    /// True for contact of two rigid bodies (a line is none): of more than three nodes that stick their tractions are not determined.
    pub fn is_rigid(&self) -> bool {
        self.line.is_empty() && self.bodies.iter().all(|&b| self.placed[b].mesh().is_none())
    }
}

impl PairInput<'_> {
    /// Restitution of the law of impact, if the contact has it.
    pub fn restitution(&self) -> Option<f64> {
        let item = self.item;
        let has_law = match item.closing {
            Some(closing) => closing == Closing::Impact,
            // The tangential impulses of the step go with its normal ones. Rigid bodies that touch have them right; the nodes of a mesh open and close as it slides.
            None => {
                item.method.has_impact && (item.friction.is_none() || self.is_rigid() || item.restitution.is_some())
            }
        };
        (self.is_exact() && has_law && !self.is_massless).then(|| self.given_restitution().unwrap_or(0.0))
    }

    /// Whether closed gaps are equations that move with the positions.
    fn is_exact(&self) -> bool {
        self.item.constraint != Some(Constraint::Modified)
            && !matches!(self.item.enforcement, Enforcement::Penalty(_))
            && self.item.integrals != Some(Integrals::Frozen)
    }

    /// The restitution of the contact, or the larger one of its rigid bodies.
    fn given_restitution(&self) -> Option<f64> {
        let of_body = |set: &str| {
            let name = split_set(set).map_or(set, |(part, _)| part);
            self.scene.rigids.iter().find(|body| body.name == name)?.restitution
        };
        let of_bodies = self.item.surfaces().into_iter().filter_map(of_body);
        self.item.restitution.or_else(|| of_bodies.max_by(f64::total_cmp))
    }

    /// Whether a deformable solid is on a side.
    fn is_deformable(&self) -> bool {
        self.bodies.iter().any(|&b| self.placed[b].mesh().is_some())
    }

    /// Number of steps after which a gap that is held in the step in which it closes comes down; `None` if gaps are closed.
    pub fn hold(&self, model: &Model) -> Option<u32> {
        let holds = match self.item.gap {
            GapAtClosing::Auto => {
                self.line.is_empty() && self.item.method.has_impact && PairScales::holds_gaps(self.courant(model))
            }
            GapAtClosing::Close => false,
            GapAtClosing::Hold => true,
        };
        let can_hold = self.restitution().is_some() || self.is_massless && self.is_exact();
        (holds && can_hold).then(|| self.item.settle.unwrap_or(PairScales::SETTLE))
    }

    /// Elements that a wave passes through in a step, in the solid where they are fewest; infinite without a solid.
    fn courant(&self, model: &Model) -> f64 {
        let label = self.item.label();
        let dynamic = self.phases.with(&label).find(|phase| phase.has_rates());
        let step = dynamic.map_or(self.scene.time.step, Phase::step);
        let of = |&b: &usize| {
            let body = model.bodies.get(b)?;
            Some(PairScales::courant(young(model, b), body.density?, body.solid.characteristic_length(), step))
        };
        self.bodies.iter().filter_map(of).fold(f64::INFINITY, f64::min)
    }

    /// What to know of the restitution of deformable bodies.
    pub fn warn_of_restitution(&self, warnings: &mut Vec<String>) {
        if (self.is_deformable() || !self.line.is_empty()) && self.restitution().is_some_and(|e| e > 0.0) {
            warnings.push(format!(
                "{}: a side is deformable, and its rebound comes from its elasticity: `restitution` says only what becomes of the energy of the nodes at the surface. With more than 0 they chatter; \
                 remove it",
                self.item.label()
            ));
        }
    }
}

impl PairInput<'_> {
    /// Whether the slave has smaller facets than the master.
    pub fn is_slave_finer(&self, model: &Model) -> bool {
        finer_side(self.facets, &model.reference) == Some(0)
    }
}

/// A warning if two bodies overlap: what is deeper behind a surface than the search looks has no partner there.
fn overlap(label: &str, [(slave, slave_mesh), (master, master_mesh)]: [(&String, &Mesh); 2]) -> Option<String> {
    use super::overlap::Locator;
    let in_master = Locator::new(master_mesh).centres_of(slave_mesh);
    let in_slave = Locator::new(slave_mesh).centres_of(master_mesh);
    (in_master + in_slave > 0).then(|| {
        format!(
            "{label}: the bodies overlap: {in_master} elements of `{slave}` have their centre inside `{master}`, {in_slave} \
             of `{master}` inside `{slave}`; a node deeper behind a surface than the length of a facet finds no partner and is not \
             kept out: move one of the bodies"
        )
    })
}
