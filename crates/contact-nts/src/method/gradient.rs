//! The gradient of the gap that a rule takes, and its derivative.
//!
//! The gradient of the gap that the rules take, of a node paired with a *start* facet at `n` and an *end* facet at
//! `n+1`, which may be the same (each measured on the facet's extension, so that a foot beyond an edge is
//! allowed):
//!
//! | rule | gradient | derivative | no moment about |
//! |---|---|---|---|
//! | `StartPoint` | start facet, `q_n` | zero | `q_n` |
//! | `EndPoint` | end facet, `q_np1` | second variation | `q_np1` |
//! | `EndPointMean` | half of each of the two above | half the second variation | -- |
//! | `Midpoint` | facet of the midpoint, `q_mid` | half the second variation | `q_mid` |
//! | `DiscreteGradient` | [`crate::invariants`]; over edges [`crate::crossing`] | dual numbers; closed form | `q_mid` |
//!
//! A node that was in contact at `n` starts on the facet that its last step ended with; one that closes in this step
//! starts on the facet that its gap at `n` is measured to. The constraint row is the gap to the end facet at `q_np1`
//! under every rule. Linear momentum is exact under every rule. `EndPointMean` has a moment about `q_mid` that the
//! angular momentum of the trapezoidal rule sees: zero in a rigid motion, of second order in the motion on one facet,
//! the kink times the motion over an edge.

use crate::crossing::{Crossing, MAX_NODES, local_of};
use crate::gap_gradient::GapGradient;
use crate::invariants;
use crate::kinematics::{Gap, Local, points};
use crate::method::NodeToSurface;
use crate::slot::PairedSlot;
use stoss_contact::ContactError;
use stoss_term::GradientRule;

impl NodeToSurface {
    /// Gap gradient of the rule and, if asked for, its derivative with respect to `q_np1`, over the element's nodes.
    pub(crate) fn gradient(
        &self,
        at: PairedSlot<'_>,
        want_tangent: bool,
        out: &mut GapGradient,
    ) -> Result<(), ContactError> {
        let PairedSlot { slot, element, pairing, end, step } = at;
        let n = 3 * element.count;
        let failed = |facet| ContactError::Projection { node: self.node(slot), facet };
        out.reset(n, want_tangent);
        match step.rule {
            GradientRule::StartPoint => {
                let start = self.gap(slot, pairing.start, step.q_n)?;
                out.add_gradient(&start.gradient, &element.start, 1.0);
                return Ok(());
            }
            GradientRule::EndPoint => {
                out.set(&end.gradient, want_tangent.then(|| end.hessian()).as_ref(), &element.end, n, 1.0);
                return Ok(());
            }
            GradientRule::EndPointMean => {
                let start = self.gap(slot, pairing.start, step.q_n)?;
                let half = end.gradient.map(|g| 0.5 * g);
                out.set(&half, want_tangent.then(|| end.hessian()).as_ref(), &element.end, n, 0.5);
                out.add_gradient(&start.gradient, &element.start, 0.5);
                return Ok(());
            }
            // They need the midpoint.
            GradientRule::Midpoint | GradientRule::DiscreteGradient => {}
        }
        if pairing.start == pairing.end && !self.slots[slot].relaxing {
            let kind = end.kind;
            let [q_n, q_1] = [step.q_n, step.q_np1].map(|q| element.local(q));
            if step.rule == GradientRule::DiscreteGradient {
                let (x, patch) = points(&q_n, kind);
                // The same start as for `gap_n`, hence the same foot.
                let at_n = Gap::from_centre(&x, &patch).ok_or_else(|| failed(pairing.end))?;
                if want_tangent {
                    let (g, k) = invariants::discrete_gradient_and_tangent(&q_n, &q_1, &at_n, end, self.length)
                        .ok_or_else(|| failed(pairing.end))?;
                    out.set(&g, Some(&k), &element.end, n, 1.0);
                } else {
                    let g = invariants::discrete_gradient(&q_n, &q_1, &at_n, end, self.length)
                        .ok_or_else(|| failed(pairing.end))?;
                    out.set(&g, None, &element.end, n, 1.0);
                }
            } else {
                let q_mid: Local = std::array::from_fn(|k| 0.5 * (q_n[k] + q_1[k]));
                let (x, patch) = points(&q_mid, kind);
                let mid = Gap::project(&x, &patch, end.xi).ok_or_else(|| failed(pairing.end))?;
                out.set(&mid.gradient, want_tangent.then(|| mid.hessian()).as_ref(), &element.end, n, 0.5);
            }
            return Ok(());
        }
        let (mut q_n, mut q_1) = ([0.0; 3 * MAX_NODES], [0.0; 3 * MAX_NODES]);
        for (k, &node) in element.list().iter().enumerate() {
            let at = 3 * node as usize;
            q_n[3 * k..3 * k + 3].copy_from_slice(&step.q_n[at..at + 3]);
            q_1[3 * k..3 * k + 3].copy_from_slice(&step.q_np1[at..at + 3]);
        }
        let middle = |node: usize| std::array::from_fn(|i| 0.5 * (q_n[3 * node + i] + q_1[3 * node + i]));
        let (x, patch) = points(&local_of(&element.mid, middle), element.mid.kind());
        let mid = Gap::from_centre(&x, &patch).ok_or_else(|| failed(pairing.mid))?;
        Crossing {
            q_n: &q_n[..n],
            q_np1: &q_1[..n],
            gap_n: self.slots[slot].gap_n + self.reference_gap.of(slot),
            end: (end, &element.end),
            mid: (&mid, &element.mid),
            length: self.length,
        }
        .evaluate(&mut out.values[..n], &mut out.tangent);
        Ok(())
    }
}
