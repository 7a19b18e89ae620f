//! What the slots report, and the check of coverage before a step is accepted.

use super::{COVERED, MortarContact};
use crate::means::means;
use crate::state::{Need, segmentation_error};
use stoss_contact::ContactError;
use stoss_term::{Coverage, SlotReport};

impl MortarContact {
    pub(super) fn check_coverage(&self, q_np1: &[f64]) -> Result<Coverage, ContactError> {
        if self.is_frozen() {
            return Ok(Coverage::default());
        }
        self.check_tunnelling()?;
        let Some(coverage) = self.coverage(q_np1).map_err(|e| segmentation_error(&e))? else {
            return Ok(Coverage::default());
        };
        match coverage.faults.first() {
            None => Ok(Coverage { defect: coverage.worst }),
            Some(first) => Err(ContactError::Coverage {
                faults: coverage.faults.len(),
                facet: first.slave_facet,
                uncovered: first.uncovered_opposite,
                double: first.double,
                open_edges: first.open_edges,
            }),
        }
    }

    pub(super) fn slot_reports(&self, q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        let fresh;
        let integrated = if self.step.is_at(q, &self.end.at) && !self.is_frozen() {
            &self.end
        } else {
            let mut tree = self.tree.clone();
            tree.update(&self.surfaces.master, q);
            let (candidates, _) = self.search(&tree, q, 0.0)?;
            let needs = self.surfaces.needs(Need::Value, &[]);
            fresh = self.surfaces.integrate(
                &candidates,
                q.into(),
                &needs,
                &self.surfaces.handing_over(None),
                &[],
                false,
            )?;
            &fresh
        };
        let mut means = means(&self.surfaces, &integrated.moments).into_iter();
        let slots = &integrated.slots;
        let nodes = self.surfaces.slave.nodes();
        let rows = self.surfaces.rows.iter().zip(slots).enumerate();
        let report = rows.map(|(k, (row, slot))| {
            let there = slot.support > COVERED * row.area;
            let gap = if there { slot.gap(q).map(|gap| gap / slot.support) } else { None };
            let own = self.reference_gap.of(k);
            let kept = self.step.reference.get(k).copied().unwrap_or(own);
            let of_law = gap.filter(|gap| self.options.overclosure.is_some() && *gap < own);
            SlotReport {
                node: nodes[row.local],
                weight: row.area,
                per_current_area: 1.0,
                area: slot.support,
                gap,
                normal: if gap.is_some() { slot.normal(q).into() } else { [0.0; 3] },
                feature: if gap.is_some() { "face" } else { "none" },
                reference_gap: of_law.unwrap_or(if there { kept } else { 0.0 }),
                friction: self.last_friction(k),
                means: means.next().unwrap_or_default(),
            }
        });
        Ok(report.collect())
    }
}
