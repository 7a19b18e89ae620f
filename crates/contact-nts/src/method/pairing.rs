//! Which facets a node is paired with, decided in [`stoss_term::Unilateral::repair`] and then fixed for the iterations.

use crate::gap_gradient::GapGradient;
use crate::kinematics::Gap;
use crate::method::NodeToSurface;
use crate::options::ConstraintForm;
use crate::slot::{ElementNodes, PairedSlot, Pairing};
use nalgebra::Vector3;
use stoss_contact::{ContactError, MasterPoint, SearchView, position};
use stoss_geometry::Patch;
use stoss_term::{GradientRule, StepConfiguration};

/// How far the foot at `n` may lie on the extension of the facet that a node closes on, in halves of an edge: up to one
/// facet beyond the edge the extension is still the same surface; farther off the crossing element is used.
const MODEST_EXTENSION: f64 = 2.0;

/// A node that moves farther than this relative to the master in a step (in multiples of the facets' length and of the depth limit)
/// without being found behind the surface is followed along its path in pieces of this length, so that it cannot jump through.
const UNCHECKED_MOTION: f64 = 0.5;

/// Most pieces of a path; only a step of hundreds of facets' lengths has longer pieces.
const MAX_PIECES: f64 = 1000.0;

/// A node off its surface comes back by at most this fraction of its slip in a step: the tilt of the contact force that keeps this free of work.
const MOST_TILT: f64 = 0.1;

/// Least part of the contact force over an edge, per pressure and area, along the normal of the facet at the midpoint; 1 where nothing is tilted.
const LEAST_PRESSING: f64 = 0.5;

/// A node nearer to the surface than this (in multiples of a master edge) is not brought back on a facet that it stays on.
const NEAR_ENOUGH: f64 = 1.0e-4;

/// A gap of more than this part of a facet is closed and not held: it would be felt in the depth.
const LARGEST_HELD: f64 = 0.1;

impl NodeToSurface {
    /// Motion of a node in the step relative to the material of a facet at its foot at `n+1`.
    fn slip(&self, slot: usize, facet: u32, q_np1: &[f64]) -> Result<f64, ContactError> {
        let gap = self.gap(slot, facet, q_np1)?;
        let xi = gap.kind.clamp(gap.xi);
        let relative = |q: &[f64]| position(q, self.node(slot)) - self.patch(facet, q).point(xi);
        Ok((relative(q_np1) - relative(&self.q_n)).norm())
    }

    /// Lets nodes that are off the surface but stay on their facet come nearer, as far as their slip allows; returns how many. At
    /// most once a step for each node.
    pub(crate) fn relax(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, ContactError> {
        let mut changes = 0;
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            let state = self.slots[slot];
            let Some(pairing) = state.pairing.filter(|p| p.start == p.end) else { continue };
            let off = state.kept - state.wanted;
            if state.committed.is_none() || state.relaxing || off.abs() <= NEAR_ENOUGH * self.length {
                continue;
            }
            let most = MOST_TILT * self.slip(slot, pairing.end, q_np1)?;
            if most > NEAR_ENOUGH * self.length {
                self.slots[slot].cross(pairing, most);
                changes += 1;
            }
        }
        Ok(changes)
    }

    /// Takes another facet at the midpoint where the force over an edge presses the node hardly against the one that was chosen; returns how many. At most once a
    /// step for each node.
    ///
    /// A node that moves along the normal of that facet and yet keeps its gap (it goes up a wall, and its midpoint projects on the floor) has a force across its
    /// motion: nothing is left of the normal, and the pressure would be determined by round-off.
    pub(crate) fn rechoose_midpoint_facets(&mut self, q_np1: &[f64], active: &[bool]) -> Result<usize, ContactError> {
        if self.augmented || !matches!(self.normal.rule, GradientRule::Midpoint | GradientRule::DiscreteGradient) {
            return Ok(0);
        }
        let mut gradient = GapGradient::default();
        let mut changes = 0;
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            let state = &self.slots[slot];
            let Some(pairing) = state.pairing.filter(|p| p.start != p.end && !state.rechosen) else { continue };
            let element = ElementNodes::new(self.node(slot), self.search.surface(), pairing);
            let end = self.gap(slot, pairing.end, q_np1)?;
            let step = StepConfiguration { q_n: &self.q_n, q_np1, rule: self.normal.rule };
            let of = PairedSlot { slot, element: &element, pairing, end: &end, step };
            self.gradient(of, false, &mut gradient)?;
            let Some(mid) = self.gap_at_midpoint(slot, pairing.mid, q_np1) else { continue };
            let pressing: f64 = (0..3).map(|i| mid.gradient[i] * gradient.values[i]).sum();
            if pressing < LEAST_PRESSING {
                let mid = if pairing.mid == pairing.end { pairing.start } else { pairing.end };
                self.slots[slot].pairing = Some(Pairing { mid, ..pairing });
                self.slots[slot].rechosen = true;
                changes += 1;
            }
        }
        Ok(changes)
    }

    /// The closest point of the master; its gap is that beyond the reference gap of the slot.
    pub(crate) fn closest(&self, view: &SearchView<'_>, slot: usize, q: &[f64]) -> MasterPoint {
        let normal = self.slave.normal(slot, q);
        let point = view.closest(&position(q, self.node(slot)), normal.as_ref());
        MasterPoint { gap: point.gap - self.reference_gap.of(slot), ..point }
    }

    pub(crate) fn pair(&self, view: &SearchView<'_>, slot: usize, q: &[f64], hint: u32) -> MasterPoint {
        let normal = self.slave.normal(slot, q);
        view.pair(&position(q, self.node(slot)), Some(hint), normal.as_ref())
    }

    /// Motion of a node from `n` relative to the master, and the number of pieces in which its path has to be followed; `None` if the
    /// motion is too small for a jump.
    pub(crate) fn pieces(&self, slot: usize, q_np1: &[f64]) -> Option<(f64, usize)> {
        let facet = self.search.surface().facets()[self.slots[slot].origin? as usize];
        let mean = |q: &[f64]| facet.iter().map(|&n| position(q, n)).sum::<Vector3<f64>>() / facet.len() as f64;
        let relative = |q: &[f64]| position(q, self.node(slot)) - mean(q);
        let motion = (relative(q_np1) - relative(&self.q_n)).norm();
        let length = self.search.surface().length_scale().min(self.search.depth_limit());
        let pieces = (motion / (UNCHECKED_MOTION * length)).ceil();
        (pieces > 1.0).then_some((motion, pieces.min(MAX_PIECES) as usize))
    }

    /// Nodes not found behind the surface at `q_np1` that went through it on their straight paths from `q_n`, with the
    /// facet that they went through and the (negative) gap to its extension.
    ///
    /// A path can dip below a convex surface and come out again (the chord over a ridge). It did come out if the signed distance, which is
    /// Lipschitz with constant 1, got back to a positive value no faster than the node moved; it jumps if the node is deep behind
    /// one sheet and nearer to another.
    pub(crate) fn jumps(&self, q_np1: &[f64], slots: &[usize]) -> Result<Vec<(usize, u32, f64)>, ContactError> {
        struct Path {
            slot: usize,
            motion: f64,
            pieces: usize,
            behind: Option<(u32, f64)>,
        }
        let path = |&slot: &usize| {
            let (motion, pieces) = self.pieces(slot, q_np1)?;
            Some(Path { slot, motion, pieces, behind: None })
        };
        let mut paths: Vec<Path> = slots.iter().filter_map(path).collect();
        let Some(pieces) = paths.iter().map(|p| p.pieces).max() else { return Ok(Vec::new()) };
        let mut q = Vec::with_capacity(q_np1.len());
        for piece in 1..=pieces {
            let s = piece as f64 / pieces as f64;
            q.clear();
            q.extend(self.q_n.iter().zip(q_np1).map(|(a, b)| a + s * (b - a)));
            let view = self.search.at(&q);
            for path in &mut paths {
                let point = self.closest(&view, path.slot, &q);
                let Some(pairing) = point.pairing else { continue };
                // The motion between two samples bounds the rise of the distance; some room for the master's turning.
                let rise = 1.5 * path.motion / pieces as f64;
                path.behind = match path.behind {
                    None if point.gap < 0.0 => Some((pairing.facet, point.gap)),
                    Some((facet, _)) if point.gap < 0.0 => Some((facet, point.gap)),
                    Some((_, depth)) if point.gap - depth <= rise => None,
                    unchanged => unchanged,
                };
            }
        }
        let mut jumps = Vec::new();
        for path in paths {
            if let Some((facet, _)) = path.behind {
                let gap = self.gap_beyond(path.slot, facet, q_np1)?;
                if gap < 0.0 {
                    jumps.push((path.slot, facet, gap));
                }
            }
        }
        Ok(jumps)
    }

    /// Facets wanted by the active slots whose node left its facet, or which have none yet.
    pub(crate) fn wanted(&self, q_np1: &[f64], active: &[bool]) -> Result<Vec<(usize, u32)>, ContactError> {
        let view = self.search.at(q_np1);
        let mut wanted = Vec::new();
        let mut lost = Vec::new();
        for slot in (0..self.slots.len()).filter(|&s| active[s]) {
            match self.slots[slot].pairing {
                Some(Pairing { end, .. }) => {
                    if self.gap(slot, end, q_np1)?.outside() > self.search.options().hysteresis
                        && let Some(pairing) = self.pair(&view, slot, q_np1, end).pairing
                        && pairing.facet != end
                    {
                        wanted.push((slot, pairing.facet));
                    }
                }
                None => match self.closest(&view, slot, q_np1) {
                    MasterPoint { pairing: Some(pairing), gap, .. } if gap < 0.0 => wanted.push((slot, pairing.facet)),
                    point => lost.push((slot, point.pairing.map(|p| p.facet))),
                },
            }
        }
        if !lost.is_empty() {
            let slots: Vec<usize> = lost.iter().map(|l| l.0).collect();
            let jumps = self.jumps(q_np1, &slots)?;
            for (slot, nearest) in lost {
                let through = jumps.iter().find(|j| j.0 == slot).map(|j| j.1);
                wanted.extend(through.or(nearest).or(self.slots[slot].origin).map(|facet| (slot, facet)));
            }
        }
        Ok(wanted)
    }

    /// Pairs a slot with `end`, and chooses the facet and the gap at `n` and the facet at the midpoint that go with it.
    ///
    /// A node in contact at `n` starts from its own facet, and goes to another one without work ([`crate::slot::Slot::cross`]). A node that closes in this step
    /// starts from the extension of the facet that it closes on, so that the element with 17 invariants applies, if its position at `n` projects
    /// on the near extension *and is not behind it*; otherwise from the facet that it was found at, with the true gap. In the closing step
    /// the energy changes by `-p g_n` (standard constraint): a negative gap to the extension beyond a ridge would gain energy, and
    /// under the modified constraint would be kept as a penetration; the true gap of an open node is positive.
    pub(crate) fn set_end(&mut self, slot: usize, end: u32, q_np1: &[f64]) -> Result<(), ContactError> {
        let state = self.slots[slot];
        let (start, gap_n) = match (state.committed, state.origin) {
            (Some(facet), _) if facet == end => {
                self.slots[slot].stay(facet);
                return Ok(());
            }
            (Some(start), _) => {
                let mid = self.facet_at_midpoint(slot, start, end, q_np1);
                let most = MOST_TILT * self.slip(slot, end, q_np1)?;
                self.slots[slot].cross(Pairing { start, mid, end }, most);
                return Ok(());
            }
            (None, origin) => {
                let x = position(&self.q_n, self.node(slot));
                let on_end = Gap::from_centre(&x, &self.patch(end, &self.q_n));
                let kept = self.reference_gap.of(slot);
                match (on_end, origin) {
                    (Some(gap), None) => (end, gap.gap - kept),
                    (Some(gap), Some(facet))
                        if facet == end
                            || gap.outside() <= MODEST_EXTENSION && gap.gap - kept >= state.origin_gap.min(0.0) =>
                    {
                        (end, gap.gap - kept)
                    }
                    (_, Some(facet)) => (facet, state.origin_gap),
                    (None, None) => return Err(ContactError::Projection { node: self.node(slot), facet: end }),
                }
            }
        };
        let mid = if start == end { end } else { self.facet_at_midpoint(slot, start, end, q_np1) };
        let holds = self.holds && gap_n > 0.0 && gap_n <= LARGEST_HELD * self.slave.length_scale();
        let slot = &mut self.slots[slot];
        slot.gap_n = gap_n;
        slot.reference = match self.constraint {
            // One that was left behind is not pushed out, which would take work that no force does.
            ConstraintForm::Standard if slot.kept < 0.0 => gap_n.min(0.0),
            ConstraintForm::Standard if holds => gap_n,
            ConstraintForm::Standard => 0.0,
            ConstraintForm::Modified => gap_n,
        };
        slot.held = if holds { gap_n } else { 0.0 };
        slot.pairing = Some(Pairing { start, mid, end });
        Ok(())
    }

    /// Gap of a node to the extension of a facet, both at the midpoint; `None` without a foot.
    fn gap_at_midpoint(&self, slot: usize, facet: u32, q_np1: &[f64]) -> Option<Gap> {
        let middle = |node: u32| (position(&self.q_n, node) + position(q_np1, node)) * 0.5;
        let patch = Patch::new(self.search.surface().facets()[facet as usize].map(middle));
        Gap::from_centre(&middle(self.node(slot)), &patch)
    }

    /// The facet of the midpoint: of start and end the one beyond whose edges the midpoint's foot lies less far.
    ///
    /// It is chosen here and not while assembling, so that the force is a smooth function of the iterate. Every choice conserves exactly.
    fn facet_at_midpoint(&self, slot: usize, start: u32, end: u32, q_np1: &[f64]) -> u32 {
        if self.augmented {
            return end;
        }
        let outside = |facet: u32| self.gap_at_midpoint(slot, facet, q_np1).map_or(f64::INFINITY, |gap| gap.outside());
        if outside(start) < outside(end) { start } else { end }
    }
}
