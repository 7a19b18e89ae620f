//! What `newton.csv` says about the iterations.

use crate::table::Table;

/// The iteration goes on until the residual falls no more, so the smallest residual of a step is its round-off; below this
/// many times of it the figures are spoilt.
const ABOVE_ROUND_OFF: f64 = 20.0;

/// Nor does a residual below this say anything: it is a sum of forces of the size 1, of which a few dozen carry an error of half an epsilon each. Where the
/// positions happen to settle, the last residual is smaller by chance.
const ROUND_OFF: f64 = 50.0 * f64::EPSILON;

/// The residuals of one step, in the order in which they were found.
#[derive(Clone, Debug, PartialEq)]
pub struct StepResiduals {
    /// Number of the step.
    pub step: f64,
    /// Number of active contact constraints at its end.
    pub active: f64,
    /// Number of corrections.
    pub iterations: usize,
    /// Norms of the residual since the active set changed last.
    pub residuals: Vec<f64>,
}

impl StepResiduals {
    /// Residuals up to this are spoilt by round-off.
    pub fn round_off(&self) -> f64 {
        let smallest = self.residuals.iter().copied().fold(f64::INFINITY, f64::min);
        ROUND_OFF.max(ABOVE_ROUND_OFF * smallest)
    }
}

/// Three consecutive residuals of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triple {
    /// Number of the step.
    pub step: f64,
    /// Number of active constraints.
    pub active: f64,
    /// The residuals.
    pub residuals: [f64; 3],
}

impl Triple {
    /// Observed order of convergence, `ln(r2/r1) / ln(r1/r0)`: 2 for a consistent tangent.
    pub fn order(&self) -> f64 {
        let [r0, r1, r2] = self.residuals;
        (r2 / r1).ln() / (r1 / r0).ln()
    }
}

/// Groups the rows `step,time,iteration,residual,increment,active,changes` by step. Iteration 0 is the predictor.
///
/// A row with `changes > 0`, or an iteration number that does not grow, begins another system: the residuals before it
/// say nothing about convergence.
pub fn steps(table: &Table) -> Result<Vec<StepResiduals>, String> {
    let column = |name| table.column(name);
    let (number, iteration, residual) = (column("step")?, column("iteration")?, column("residual")?);
    let (active, changes) = (column("active")?, column("changes")?);
    let mut steps: Vec<StepResiduals> = Vec::new();
    for row in 0..table.rows() {
        let same = row > 0 && number[row] == number[row - 1];
        if !same {
            steps.push(StepResiduals { step: number[row], active: active[row], iterations: 0, residuals: Vec::new() });
        }
        let Some(step) = steps.last_mut() else { continue };
        if same && (changes[row] > 0.0 || iteration[row] <= iteration[row - 1]) {
            step.residuals.clear();
        }
        step.iterations += usize::from(iteration[row] > 0.0);
        step.active = active[row];
        step.residuals.push(residual[row]);
    }
    Ok(steps)
}

/// Mean number of corrections a step; NaN without a step.
pub fn mean_iterations(steps: &[StepResiduals]) -> f64 {
    steps.iter().map(|step| step.iterations).sum::<usize>() as f64 / steps.len() as f64
}

/// The last three residuals of every step that fall, and the last of which is above round-off.
///
/// See [`StepResiduals::round_off`]; a step that stops early loses its last residual by this, which only makes the order look lower.
pub fn triples(steps: &[StepResiduals]) -> Vec<Triple> {
    steps.iter().filter_map(triple).collect()
}

fn triple(step: &StepResiduals) -> Option<Triple> {
    let round_off = step.round_off();
    let useful = step.residuals.iter().rposition(|residual| *residual > round_off)? + 1;
    let residuals: [f64; 3] = step.residuals[..useful].last_chunk().copied()?;
    let falls = residuals[0] > residuals[1] && residuals[1] > residuals[2];
    falls.then_some(Triple { step: step.step, active: step.active, residuals })
}

/// Up to `count` triples spread over the run; those with contact first.
pub fn typical(triples: &[Triple], count: usize) -> Vec<Triple> {
    let touching: Vec<Triple> = triples.iter().copied().filter(|triple| triple.active > 0.0).collect();
    let from = if touching.len() >= count { &touching[..] } else { triples };
    let shown = count.min(from.len());
    (0..shown).map(|place| from[place * from.len() / shown]).collect()
}

/// Median of the observed orders; NaN without a triple.
pub fn median_order(triples: &[Triple]) -> f64 {
    let mut orders: Vec<f64> = triples.iter().map(Triple::order).collect();
    orders.sort_by(f64::total_cmp);
    orders.get(orders.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "step,time,iteration,residual,increment,active,changes\n\
                       1,0.1,0,1e0,0,0,0\n1,0.1,1,1e-2,1,0,0\n1,0.1,2,1e-4,1,0,0\n1,0.1,3,1e-8,1,0,0\n1,0.1,4,1e-15,1,0,0\n\
                       2,0.2,0,1e1,0,0,0\n2,0.2,1,1e-3,1,0,0\n2,0.2,2,1e0,1,4,4\n2,0.2,3,1e-1,1,4,0\n2,0.2,4,1e-3,1,4,0\n";

    fn log() -> Vec<StepResiduals> {
        steps(&Table::parse(LOG).unwrap()).unwrap()
    }

    #[test]
    fn rows_are_grouped_and_restart_with_the_active_set() {
        let steps = log();
        assert_eq!(steps.len(), 2);
        assert_eq!((steps[0].iterations, steps[1].iterations), (4, 4));
        assert_eq!(steps[1].residuals, [1e0, 1e-1, 1e-3]);
        assert_eq!(steps[1].active, 4.0);
        assert_eq!(mean_iterations(&steps), 4.0);
    }

    #[test]
    fn the_order_of_exact_sequences_is_found() {
        let triples = triples(&log());
        assert_eq!(triples[0].residuals, [1e-2, 1e-4, 1e-8]);
        assert!((triples[0].order() - 2.0).abs() < 1e-12);
        let linear = Triple { step: 0.0, active: 0.0, residuals: [1.0, 0.1, 0.01] };
        assert!((linear.order() - 1.0).abs() < 1e-12);
        assert!(median_order(&[]).is_nan());
    }

    #[test]
    fn round_off_and_short_steps_are_left_out() {
        let step =
            |residuals: &[f64]| StepResiduals { step: 1.0, active: 0.0, iterations: 0, residuals: residuals.to_vec() };
        for end in [&[1e-15][..], &[1e-14, 1e-15], &[3e-15, 2e-15, 1e-15]] {
            let residuals = [&[1.0, 1e-2, 1e-4, 1e-8], end].concat();
            assert_eq!(triple(&step(&residuals)).unwrap().residuals, [1e-2, 1e-4, 1e-8]);
        }
        assert_eq!(triple(&step(&[1.0, 1e-2, 1e-8])), None);
        assert_eq!(triple(&step(&[1.0, 1e-2, 1e-1, 1e-8])), None);
    }

    #[test]
    fn typical_triples_prefer_contact() {
        let make = |step: usize, active: f64| Triple { step: step as f64, active, residuals: [1.0, 0.1, 0.01] };
        let triples: Vec<Triple> = (0..10).map(|step| make(step, f64::from(u8::from(step >= 5)))).collect();
        assert!(typical(&triples, 4).iter().all(|triple| triple.active > 0.0));
        assert_eq!(typical(&triples, 7).len(), 7);
        assert!(typical(&[], 3).is_empty());
    }
}
