//! Slave nodes of which little is covered, where the integrals move with the iterate.
//!
//! A constraint on a sliver of a support needs a pressure out of all proportion, of either sign, and the slivers change with the iterate. Below a
//! fraction of the reference area the constraint is blended, smoothly in the covered area, with the equation that the node has the mean pressure of
//! its neighbours: its function then belongs to theirs, and constant pressures stay exact. Little is what is less than four fifths of that of the neighbour
//! of which most is covered: where a contact is smaller than a facet, those nodes carry it that have the most of it, until that is next to nothing.
//!
//! The same equation with a small factor on every node smooths the pressures: where the slave is finer or stiffer
//! than the master there are more pressures than the master's nodes can tell apart, and without it few of them carry all, other ones at every step.

use crate::method::MortarContact;
use crate::slot::Slot;
use stoss_contact::LocalContribution;

/// Fraction of the reference area of a slave node below which its constraint gives way.
const PARTLY_COVERED: f64 = 0.5;
/// Or this part of the fraction of its best covered neighbour if that is less. What the best one loses in a step beyond the rest has no neighbour to
/// give its pressure to, so that a uniform one would no longer be exact.
const OF_THE_BEST: f64 = 0.8;
/// The least such fraction: where less is covered of all nodes around, their pressures give way, down to nothing at the end of a slide off an edge.
const LEAST_COVERED: f64 = 0.1;
/// Compliance against the mean pressure, in edge lengths over Young's modulus, for a support that vanishes.
const COMPLIANCE: f64 = 0.3;

/// Blend of one slot: its row is `-(constraint * Phi + compliance * (p - mean))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Blend {
    /// Without unit; 1 for a support that is large enough.
    constraint: f64,
    /// Volume per traction; 0 for a support that is large enough.
    compliance: f64,
    /// Derivatives with respect to the support.
    d_constraint: f64,
    d_compliance: f64,
    /// An area by which the row becomes a length.
    area: f64,
}

/// What the method knows of the supports at the start of a step.
#[derive(Clone, Debug)]
pub(crate) struct Softening {
    /// Traction per length.
    stiffness: f64,
    /// Compliance of every node against the mean pressure of its neighbours, over area and stiffness.
    smoothing: f64,
    /// Slots whose mean pressure a slot with little support takes, for each slot.
    partners: Vec<Vec<u32>>,
    /// Fraction of the reference area from which on a slot's constraint is whole, for each slot.
    whole: Vec<f64>,
    /// Pressures of the iterate.
    pressures: Vec<f64>,
}

impl Blend {
    /// For a slot of whose `area` at most the part `whole` has to be covered. Nothing if the constraint is as it is.
    fn new(support: f64, area: f64, whole: f64, stiffness: f64, smoothing: f64) -> Option<Self> {
        let fraction = support / area;
        let everywhere = smoothing * area / stiffness;
        if fraction >= whole {
            let smoothed =
                Self { constraint: 1.0, compliance: everywhere, d_constraint: 0.0, d_compliance: 0.0, area: support };
            return (smoothing > 0.0).then_some(smoothed);
        }
        let part = fraction / whole;
        let largest = COMPLIANCE * area * whole / stiffness;
        let by_support = 1.0 / (area * whole);
        Some(Self {
            constraint: part,
            compliance: everywhere + largest * (1.0 - part) * (1.0 - part),
            d_constraint: by_support,
            d_compliance: -2.0 * largest * (1.0 - part) * by_support,
            area: area * whole * (COMPLIANCE + (1.0 - COMPLIANCE) * part),
        })
    }
}

impl MortarContact {
    /// The same contact with two compliances, where integrals move with the iterate (backward Euler, statics).
    ///
    /// Of slave nodes of which less than half is covered: `stiffness` is a traction per length, Young's modulus over an edge length, say; it decides on how
    /// a node fades when its support does, not on the rest. One that is not positive and finite is as none. Without it such nodes hand their
    /// multiplier over below a twentieth, all at once.
    ///
    /// Of every slave node against the difference of its pressure from the mean of its neighbours: its gap is `-smoothing * (p - mean) / stiffness`.
    /// Constant pressures stay exact; others are smoothed by what falls with the third power of the edge length. 0.1 to 0.5 let a slave that is finer
    /// or stiffer than its master slide in steps of the size of facets; 0, or what is not positive and finite, leaves the pressures as they are.
    #[must_use]
    pub fn with_softening(mut self, stiffness: f64, smoothing: f64) -> Self {
        let valid = |x: f64| x > 0.0 && x.is_finite();
        let count = self.without.len();
        self.softening = valid(stiffness).then(|| Softening {
            stiffness,
            smoothing: if valid(smoothing) { smoothing } else { 0.0 },
            partners: vec![Vec::new(); count],
            whole: vec![PARTLY_COVERED; count],
            pressures: vec![0.0; count],
        });
        self
    }

    /// Whether the constraint of a slot is blended or smoothed, so that its gap need not be zero.
    pub(crate) fn gives_way(&self, slot: usize, support: f64, area: f64) -> bool {
        let softening = self.softening.as_ref().filter(|_| self.moves_integrals());
        softening.is_some_and(|s| Blend::new(support, area, s.whole[slot], s.stiffness, s.smoothing).is_some())
    }

    pub(crate) fn is_soft(&self) -> bool {
        self.softening.is_some() && self.moves_integrals()
    }

    /// Chooses the partners of a step by the supports at its start.
    pub(crate) fn begin_softening(&mut self) {
        let (slave, without, integrated) = (&self.slave, &self.without, &self.integrated);
        let slots = integrated.as_ref().map_or(&[][..], |i| &i.slots);
        let Some(softening) = &mut self.softening else { return };
        softening.pressures.fill(0.0);
        let covered = |n: u32| {
            let n = n as usize;
            slots.get(n).filter(|_| !without[n]).map_or(0.0, |slot| slot.support / slot.area)
        };
        for (node, (partners, whole)) in softening.partners.iter_mut().zip(&mut softening.whole).enumerate() {
            let beside = slave.facets_around(node).iter().flat_map(|&f| slave.local_facets()[f as usize]);
            partners.clear();
            partners.extend(beside);
            let most = partners.iter().map(|&n| covered(n)).fold(0.0, f64::max);
            *whole = (OF_THE_BEST * most).clamp(LEAST_COVERED, PARTLY_COVERED);
            partners.retain(|&other| other as usize != node && covered(other) >= *whole);
            partners.sort_unstable();
            partners.dedup();
        }
    }

    pub(crate) fn follow_softening(&mut self, pressures: &[f64], active: &[bool]) {
        let Some(softening) = &mut self.softening else { return };
        for ((to, p), active) in softening.pressures.iter_mut().zip(pressures).zip(active) {
            *to = if *active { *p } else { 0.0 };
        }
    }

    fn blend(&self, slot: usize) -> Option<(Blend, &Softening)> {
        let softening = self.softening.as_ref().filter(|_| self.moves_integrals())?;
        let Slot { support, area, .. } = *self.slots().get(slot)?;
        // Without a partner there is no mean to smooth towards. Where less than the least is covered the pressure fades to zero all the same.
        let smoothing = if softening.partners[slot].is_empty() { 0.0 } else { softening.smoothing };
        let blend = Blend::new(support, area, softening.whole[slot], softening.stiffness, smoothing)?;
        Some((blend, softening))
    }

    /// Appends the slots whose pressures the row of a slot may depend on.
    pub(crate) fn push_partners(&self, slot: usize, active: &[bool], slots: &mut Vec<u32>) {
        if !self.is_soft() {
            return;
        }
        let partners = self.softening.iter().flat_map(|s| &s.partners[slot]);
        slots.extend(partners.filter(|&&p| active[p as usize]));
    }

    /// Mean pressure of a slot's partners.
    fn mean(softening: &Softening, slot: usize, pressure: impl Fn(usize) -> f64) -> f64 {
        let partners = &softening.partners[slot];
        let sum: f64 = partners.iter().map(|&p| pressure(p as usize)).sum();
        if partners.is_empty() { 0.0 } else { sum / partners.len() as f64 }
    }

    /// Blends the row of a slot, which `out` holds with all its derivatives.
    pub(crate) fn soften(
        &self,
        slot: usize,
        present: &Slot,
        pressures: &[f64],
        active: &[bool],
        want_tangent: bool,
        out: &mut LocalContribution,
    ) {
        let Some((blend, softening)) = self.blend(slot) else { return };
        let (n, dim) = (3 * out.nodes.len(), out.dim());
        let mean = Self::mean(softening, slot, |p| if active[p] { pressures[p] } else { 0.0 });
        let excess = pressures[slot] - mean;
        let row = out.residual[n];
        out.residual[n] = blend.constraint * row - blend.compliance * excess;
        if !want_tangent {
            return;
        }
        let tangent = &mut out.tangent[n * dim..][..dim];
        tangent.iter_mut().for_each(|t| *t *= blend.constraint);
        let by_support = blend.d_constraint * row - blend.d_compliance * excess;
        present.for_each_support_derivative(|column, d| tangent[column] += by_support * d);
        tangent[n] -= blend.compliance;
        let share = blend.compliance / softening.partners[slot].len().max(1) as f64;
        tangent[n + 1..n + out.slots.len()].iter_mut().for_each(|t| *t += share);
    }

    /// What stands for the gap of a slot with weighted gap `phi` in the rule of the active set.
    pub(crate) fn soft_gap(&self, slot: usize, phi: f64, support: f64) -> f64 {
        match self.blend(slot) {
            None => phi / support,
            Some((blend, softening)) => {
                let mean = Self::mean(softening, slot, |p| softening.pressures[p]);
                let excess = softening.pressures[slot] - mean;
                (blend.constraint * phi + blend.compliance * excess) / blend.area
            }
        }
    }
}
