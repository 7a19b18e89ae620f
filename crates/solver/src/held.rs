//! Joints between things of which some components are held.

use crate::numbering::Numbering;
use stoss_linalg::NONE;
use stoss_term::{GradientRule, Local, StepConfiguration, StepContext, Term};

/// Part of the length of a joint by which free components are moved to see which of its rows depend on them.
const PROBED: f64 = 1.0e-3;
/// Part of that below which a change of a row is round-off.
const SMALLEST_DEPENDENCE: f64 = 1.0e-9;

/// Which rows of a joint depend on components that are free, or on its own multipliers; `None` if it cannot be evaluated. Where of a node some components are held
/// and others are not, an equation may be about those that are held alone.
pub(crate) fn depends_on_free(
    method: &mut dyn Term,
    numbering: &Numbering,
    begins: &StepContext<'_>,
) -> Option<Vec<bool>> {
    let q = begins.q_n;
    let count = method.slot_count();
    let by = PROBED * method.length_scale();
    let moved = |phase: f64| -> Vec<f64> {
        let free = |k: usize| if numbering.equation[k] == NONE { 0.0 } else { by };
        q.iter().enumerate().map(|(k, q)| q + free(k) * (1.7 * (k + 1) as f64 + phase).sin()).collect()
    };
    let mut rows = |end: &[f64], multiplier: f64| -> Option<Vec<f64>> {
        let mut rows = vec![0.0; count];
        let auxiliaries = vec![0.0; count * method.auxiliaries().len()];
        let step = StepConfiguration { q_n: q, q_np1: end, rule: GradientRule::EndPoint };
        let mut add = |local: &Local| {
            let coordinates = 3 * local.nodes.len();
            local
                .slots
                .iter()
                .enumerate()
                .for_each(|(k, &slot)| rows[slot as usize] += local.residual[coordinates + k]);
        };
        let (multipliers, all) = (vec![multiplier; count], vec![true; count]);
        method.begin(begins).ok()?;
        method.assemble(&step.at(&multipliers, &all).with_auxiliaries(&auxiliaries), false, &mut add).ok()?;
        Some(rows)
    };
    let (still, other) = (rows(q, 0.0)?, rows(q, 1.0)?);
    let mut depends: Vec<bool> = still.iter().zip(other).map(|(a, b)| *a != b).collect();
    for phase in [0.3, 1.1] {
        let after = rows(&moved(phase), 0.0)?;
        for ((depends, a), b) in depends.iter_mut().zip(&still).zip(after) {
            *depends |= (a - b).abs() > SMALLEST_DEPENDENCE * by;
        }
    }
    Some(depends)
}
