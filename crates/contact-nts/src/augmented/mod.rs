//! The coordinate augmentation technique (theory/coordinate-augmentation; thesis chapter 4).
//!
//! The convective coordinates `f` of the foot of a slave node are unknowns, and `Phi_A = (x - x(f)) . a_a(f) = 0` is a constraint with two
//! multipliers: constraints and friction are then explicit functions, and no derivative of a projection is needed. Three sizes of one
//! system, with the same solution:
//!
//! | [`Reduction`] | unknowns beside the positions | rows |
//! |---|---|---|
//! | `None` | `p`, `f`, `lambda_A` | gap, balance of `f`, `Phi_A`: 20 an element |
//! | `First` | `p`, `f` | `lambda_A` follows from the balance of `f`, theory/coordinate-augmentation#eq-first |
//! | `Second` | `p` | `f` follows from the linearised `Phi_A`, theory/coordinate-augmentation#eq-second; it iterates with Newton's method |
//!
//! Forces are those of the end point (`EndPoint`) or of `q_mid`, `f_mid = (f_n + f_np1) / 2` (`Midpoint`; `DiscreteGradient` is taken
//! as that: the solids have their conserving stress, the contact has not). The gradients of both constraints have neither resultant nor moment
//! at any `f`: momenta are exact for every gap, slip and traction. The energy is that of the direct form.
//!
//! Search, pairing, history, friction laws and return mapping are those of [`NodeToSurface`]. Over an edge `f_n` is the foot of the old
//! position on the extension of the new facet, and slip is measured from the old foot as in the direct form (theory/friction#eq-feet).

mod constraints;
mod element;

use crate::crossing::{local_of, spread};
use crate::friction::{FrictionElement, PointHistory, Slip};
use crate::kinematics::{Gap, LOCAL, mean, points};
use crate::method::NodeToSurface;
use crate::slot::{ElementNodes, Pairing};
use constraints::Constraints;
use element::{Dense, Equations, Traction, solve_2};
use stoss_contact::{ContactError, in_order, position};
use stoss_term::{
    At, Auxiliary, Fault, GradientRule, Hold, Local, ReferenceGap, Share, SlotReport, StepConfiguration, StepContext,
    Term, Unilateral, Work,
};

/// Coordinates at `n` on the extension of the facet of `n+1` are cut off here: any value conserves momenta, but far out the extension is
/// not the surface any more.
const FARTHEST: f64 = 3.0;

/// How much of the augmented system is eliminated. The solution is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reduction {
    /// No reduction: 20 unknowns an element.
    None,
    /// The multipliers of the foot.
    First,
    /// Multipliers and coordinates: the size of the direct form.
    #[default]
    Second,
}

/// Node-to-surface contact by coordinate augmentation.
#[derive(Clone, Debug)]
pub struct CoordinateAugmented {
    inner: NodeToSurface,
    reduction: Reduction,
}

impl NodeToSurface {
    /// Coordinates of a node at `n` on the extension of a facet.
    pub(crate) fn start_coordinates(&self, slot: usize, facet: u32) -> [f64; 2] {
        let patch = self.patch(facet, &self.q_n);
        let x = position(&self.q_n, self.node(slot));
        let foot = Gap::from_centre(&x, &patch).map_or_else(|| patch.closest_point(&x).xi, |gap| gap.xi);
        foot.map(|f| f.clamp(-FARTHEST, FARTHEST))
    }
}

/// Constraints and traction of one slot at an iterate.
struct Evaluated {
    force: Constraints,
    end: Constraints,
    traction: Traction,
}

impl CoordinateAugmented {
    /// The method from the direct one with its surfaces, constraint and friction.
    pub fn new(mut direct: NodeToSurface, reduction: Reduction) -> Self {
        direct.augmented = true;
        Self { inner: direct, reduction }
    }

    fn element(&self, slot: usize, pairing: Pairing) -> ElementNodes {
        // Without friction nothing depends on the facet at `n`.
        let pairing = if self.inner.friction.is_some() { pairing } else { Pairing::single(pairing.end) };
        ElementNodes::new(self.inner.node(slot), self.inner.search.surface(), pairing)
    }

    /// Auxiliary values of one slot.
    fn values<'a>(&self, slot: usize, auxiliaries: &'a [f64]) -> &'a [f64] {
        let count = self.auxiliaries().len();
        &auxiliaries[slot * count..(slot + 1) * count]
    }

    fn rule(rule: GradientRule) -> Result<bool, ContactError> {
        match rule {
            GradientRule::EndPoint => Ok(true),
            GradientRule::Midpoint | GradientRule::DiscreteGradient => Ok(false),
            GradientRule::StartPoint | GradientRule::EndPointMean => {
                Err(ContactError::RuleUnavailable { method: "coordinate augmentation", rule: format!("{rule:?}") })
            }
        }
    }

    /// Constraints and traction at coordinates `f` of `n+1`.
    fn evaluate(
        &self,
        slot: usize,
        element: &ElementNodes,
        pairing: Pairing,
        step: StepConfiguration<'_>,
        f: [f64; 2],
        pressure: f64,
        multiplier: [f64; 2],
        want_tangent: bool,
    ) -> Result<Evaluated, ContactError> {
        let failed = || ContactError::Projection { node: self.inner.node(slot), facet: pairing.end };
        let at_end = Self::rule(step.rule)?;
        let mut q = [0.0; 3 * crate::crossing::MAX_NODES];
        for (block, &node) in q.chunks_exact_mut(3).zip(element.list()) {
            let x_1 = position(step.q_np1, node);
            let x = if at_end { x_1 } else { (position(step.q_n, node) + x_1) * 0.5 };
            block.copy_from_slice(x.as_slice());
        }
        let kind = element.end.kind();
        let q_end = element.local(step.q_np1);
        let q_force = local_of(&element.end, |node| std::array::from_fn(|i| q[3 * node + i]));
        let end = Constraints::new(&q_end, kind, f).ok_or_else(failed)?;
        let (force, f_force) = if at_end {
            (end.clone(), f)
        } else {
            let f_force = mean(self.inner.start_coordinates(slot, pairing.end), f);
            (Constraints::new(&q_force, kind, f_force).ok_or_else(failed)?, f_force)
        };
        let mut traction = Traction::NONE;
        if let Some(surface) = &self.inner.friction {
            let (x, patch) = points(&q_force, kind);
            let at = Gap::at(&x, &patch, f_force).ok_or_else(failed)?;
            let (x, patch) = points(&q_end, kind);
            let at_np1 = Gap::at(&x, &patch, f).ok_or_else(failed)?;
            let history = PointHistory { multiplier, ..surface.points[slot] };
            let friction = FrictionElement {
                friction: &surface.friction,
                at_end,
                q: &q[..3 * element.count],
                at: (&at, &element.end),
                start: &element.start,
                history: &history,
                compliance: surface.compliance[slot],
                slip: Slip::Feet(&at_np1, &element.end),
                pressure,
                step_size: surface.step_size,
            };
            traction = Traction::new(&friction, &at_np1, &element.end, want_tangent);
        }
        Ok(Evaluated { force, end, traction })
    }

    fn equations<'a>(
        &self,
        slot: usize,
        element: &ElementNodes,
        at_end: bool,
        of: &'a Evaluated,
        pressure: f64,
    ) -> Equations<'a> {
        Equations {
            force: &of.force,
            nodes: spread(&element.end),
            at_end,
            end: &of.end,
            traction: &of.traction,
            pressure,
            reference: self.inner.slots[slot].reference + self.inner.reference_gap.of(slot),
            weight: self.slot_weight(slot),
            length: self.inner.length,
            n: 3 * element.count,
            frictional: self.frictional(),
            reduction: self.reduction,
        }
    }

    /// Number of multipliers of the friction, the first auxiliaries of each slot.
    fn frictional(&self) -> usize {
        if self.inner.has_stick_multipliers() { 2 } else { 0 }
    }

    /// Multipliers of the friction and all other auxiliaries of one slot.
    fn split<'a>(&self, values: &'a [f64]) -> ([f64; 2], &'a [f64]) {
        match values {
            [a, b, rest @ ..] if self.frictional() == 2 => ([*a, *b], rest),
            _ => ([0.0; 2], values),
        }
    }
}

impl Term for CoordinateAugmented {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn length_scale(&self) -> f64 {
        self.inner.length_scale()
    }

    fn has_friction(&self) -> bool {
        self.inner.has_friction()
    }

    fn slot_count(&self) -> usize {
        self.inner.slot_count()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.inner.slot_weight(slot)
    }

    fn set_carriers<'a>(&mut self, of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {
        self.inner.set_carriers(of);
    }

    fn set_share(&mut self, share: Share) -> Option<Share> {
        self.inner.set_share(share)
    }

    fn holds(&self, visit: &mut dyn FnMut(u32, Hold)) {
        self.inner.holds(visit);
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        let rule = if step.rule == GradientRule::DiscreteGradient { GradientRule::Midpoint } else { step.rule };
        self.inner.begin(&StepContext { rule, ..*step })
    }

    fn renew(&mut self, at: &At<'_>, want_tangent: bool) -> Result<bool, Fault> {
        self.inner.keep_multipliers(at.auxiliaries, self.auxiliaries().len());
        if want_tangent {
            self.inner.follow_friction(at.q_np1, at.multipliers, at.active)?;
        }
        Ok(false)
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        for slot in (0..self.slot_count()).filter(|&s| active[s]) {
            match self.inner.slots[slot].pairing {
                Some(pairing) => visit(self.element(slot, pairing).list(), &[slot as u32]),
                None => visit(&[self.inner.node(slot)], &[slot as u32]),
            }
        }
    }

    /// Multipliers of the friction, if stick is enforced by them; coordinates and multipliers times a master edge `L`, so that the former are lengths and the latter tractions; their rows are divided
    /// by `L`.
    fn auxiliaries(&self) -> &[Auxiliary] {
        use Auxiliary::{Balance, Condensed, Constraint};
        const NONE: [Auxiliary; 6] = [Constraint, Constraint, Balance, Balance, Constraint, Constraint];
        const FIRST: [Auxiliary; 4] = [Constraint; 4];
        const SECOND: [Auxiliary; 4] = [Constraint, Constraint, Condensed, Condensed];
        let all: &[Auxiliary] = match self.reduction {
            Reduction::None => &NONE,
            Reduction::First => &FIRST,
            Reduction::Second => &SECOND,
        };
        &all[2 - self.frictional()..]
    }

    fn start_auxiliaries(&self, at: &At<'_>, out: &mut [f64]) -> Result<(), Fault> {
        let Some(step) = StepConfiguration::of(at) else { return Ok(()) };
        let At { multipliers: pressures, active, .. } = *at;
        let length = self.inner.length;
        for (slot, values) in out.chunks_exact_mut(self.auxiliaries().len()).enumerate() {
            let Some(pairing) = self.inner.slots[slot].pairing.filter(|_| active[slot]) else {
                values.fill(0.0);
                continue;
            };
            let (multiplier, _) = self.split(values);
            let values = &mut values[self.frictional()..];
            let f = self.inner.gap(slot, pairing.end, step.q_np1)?.xi;
            values[..2].copy_from_slice(&f.map(|f| f * length));
            if self.reduction == Reduction::None {
                let element = self.element(slot, pairing);
                let of = self.evaluate(slot, &element, pairing, step, f, pressures[slot], multiplier, false)?;
                let equations = self.equations(slot, &element, Self::rule(step.rule)?, &of, pressures[slot]);
                let lambda = equations.multipliers().unwrap_or_default();
                values[2..].copy_from_slice(&lambda.map(|l| l * length));
            }
        }
        Ok(())
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(step) = StepConfiguration::of(at) else { return Ok(()) };
        let At { multipliers: pressures, active, .. } = *at;
        let mut started = Vec::new();
        if at.auxiliaries.is_empty() {
            started.resize(self.slot_count() * self.auxiliaries().len(), 0.0);
            self.start_auxiliaries(at, &mut started)?;
        }
        let auxiliaries = if at.auxiliaries.is_empty() { &started } else { at.auxiliaries };
        let at_end = Self::rule(step.rule)?;
        let further = Auxiliary::equations(self.auxiliaries());
        let length = self.inner.length;
        let slots: Vec<usize> = (0..self.slot_count()).filter(|&s| active[s]).collect();
        let compute = |&slot: &usize, (contribution, dense): &mut (Local, Dense)| -> Result<(), Fault> {
            contribution.auxiliaries = further;
            contribution.slots.clear();
            contribution.slots.push(slot as u32);
            contribution.nodes.clear();
            let values = self.values(slot, auxiliaries);
            let pressure = pressures[slot];
            let Some(pairing) = self.inner.slots[slot].pairing else {
                self.inner.without_partner(slot, pressure, values, want_tangent, contribution);
                return Ok(());
            };
            let failed = || ContactError::Projection { node: self.inner.node(slot), facet: pairing.end };
            let element = self.element(slot, pairing);
            contribution.nodes.extend_from_slice(element.list());
            if !self.inner.share.has(element.list()) {
                contribution.set_elsewhere();
                return Ok(());
            }
            let (multiplier, values) = self.split(values);
            let f = [values[0] / length, values[1] / length];
            let wants = want_tangent || self.reduction == Reduction::Second;
            let of = self.evaluate(slot, &element, pairing, step, f, pressure, multiplier, wants)?;
            let equations = self.equations(slot, &element, at_end, &of, pressure);
            let lambda = match values {
                [_, _, a, b] => [a / length, b / length],
                _ => [0.0; 2],
            };
            equations.reduced(lambda, want_tangent, dense).ok_or_else(failed)?;
            contribution.reset(want_tangent);
            let (dim, all) = (contribution.dim(), equations.dim());
            contribution.residual.copy_from_slice(&dense.residual[..dim]);
            if want_tangent {
                for (row, from) in contribution.tangent.chunks_exact_mut(dim).zip(dense.tangent.chunks_exact(all)) {
                    row.copy_from_slice(&from[..dim]);
                }
            }
            if let Some([tau, mismatch]) = of.traction.shift {
                // The residual is linear in the traction.
                let mut traction = of.traction.clone();
                for k in 0..2 {
                    traction.tau[k].value += tau[k];
                    traction.mismatch[k].value += mismatch[k];
                }
                let branch = Equations { traction: &traction, ..equations };
                branch.reduced(lambda, false, dense).ok_or_else(failed)?;
                contribution.shift.extend(dense.residual.iter().zip(&contribution.residual).map(|(b, r)| b - r));
            }
            if self.reduction == Reduction::Second {
                let [a, b] = of.end.foot;
                contribution.violation = a.abs().max(b.abs()) / (length * length);
            }
            Ok(())
        };
        in_order(&slots, compute, |_, (contribution, _)| visit(contribution))
    }

    fn recover(&self, at: &At<'_>, increment: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        if self.reduction != Reduction::Second {
            return Ok(());
        }
        let (length, active) = (self.inner.length, at.active);
        for (slot, out) in out.chunks_exact_mut(self.auxiliaries().len()).enumerate() {
            out.fill(0.0);
            let Some(pairing) = self.inner.slots[slot].pairing.filter(|_| active[slot]) else { continue };
            let failed = || ContactError::Projection { node: self.inner.node(slot), facet: pairing.end };
            let element = self.element(slot, pairing);
            let (_, values) = self.split(self.values(slot, at.auxiliaries));
            let f = [values[0] / length, values[1] / length];
            let end = Constraints::new(&element.local(at.q_np1), element.end.kind(), f).ok_or_else(failed)?;
            let du = element.local(increment);
            // theory/coordinate-augmentation#eq-second: df = -A_f^-1 (Phi_A + A_q dq).
            let rhs = [0, 1].map(|al| {
                let change: f64 = end.foot_gradient[al][..LOCAL].iter().zip(&du).map(|(a, d)| a * d).sum();
                -(end.foot[al] + change)
            });
            let df = solve_2(end.foot_by_coordinates(), rhs).ok_or_else(failed)?;
            out[self.frictional()..].copy_from_slice(&df.map(|d| d * length));
        }
        Ok(())
    }

    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        self.inner.work(at)
    }

    fn commit(&mut self, at: &At<'_>) {
        self.inner.commit(at);
    }

    fn report(&self, q: &[f64]) -> Result<Vec<SlotReport>, Fault> {
        self.inner.report(q)
    }

    fn save_history(&self) -> Vec<u8> {
        self.inner.save_history()
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        self.inner.load_history(bytes)
    }

    fn unilateral(&self) -> Option<&dyn Unilateral> {
        Some(self)
    }

    fn unilateral_mut(&mut self) -> Option<&mut dyn Unilateral> {
        Some(self)
    }
}

impl Unilateral for CoordinateAugmented {
    fn reference_gap(&self) -> Option<&ReferenceGap> {
        self.inner.reference_gap()
    }

    fn reference_gap_mut(&mut self) -> Option<&mut ReferenceGap> {
        self.inner.reference_gap_mut()
    }

    fn smooth_friction(&mut self, pressure: f64) {
        self.inner.smooth_friction(pressure);
    }

    fn complementarity_gaps(&self, q_np1: &[f64], active: &[bool], out: &mut [f64]) -> Result<(), Fault> {
        self.inner.complementarity_gaps(q_np1, active, out)
    }

    fn repair(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, Fault> {
        self.inner.repair(q_np1, active)
    }

    fn constraint_gradients(
        &self,
        q_np1: &[f64],
        active: &[bool],
        visit: &mut dyn FnMut(usize, &[u32], &[f64]),
    ) -> Result<(), Fault> {
        self.inner.constraint_gradients(q_np1, active, visit)
    }

    fn friction_coefficient(&self, slot: usize, pressure: f64, slip: [f64; 2]) -> Option<f64> {
        self.inner.friction_coefficient(slot, pressure, slip)
    }

    fn settling(&self, slot: usize) -> f64 {
        self.inner.settling(slot)
    }
}
