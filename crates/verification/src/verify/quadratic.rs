//! Whether Newton's iteration converges quadratically in the steps in contact of a run.
//!
//! Two measures. *Order*: `ln(r2/r1) / ln(r1/r0)` of the last three residuals of a step since its active set changed last. Where the last of the three is
//! round-off the quotient is a lower bound; it counts if it is large enough on its own, and says nothing otherwise. A linear iteration has
//! residuals enough to give itself away. *Corrections*: how many take a residual from below [`NEAR`] to round-off. Quadratic convergence with a
//! constant of one takes two, `1e-4 -> 1e-8 -> 1e-16`, one that gains two digits each time takes five; this needs no triple, so that steps with few
//! iterations count as well.

use super::check::{Bound, Check};
use super::newton::{StepResiduals, mean_iterations};
use super::{Findings, Run};
use crate::workspace::Outcome;

/// Least median order.
const QUADRATIC: f64 = 1.7;
/// Least number of orders for a median.
const FEW: usize = 5;
/// Relative residual from which an iteration on one branch (nothing changes between stick and slip) is quadratic.
const NEAR: f64 = 1e-4;
/// `log2(log(round-off) / log(NEAR))`.
const CORRECTIONS: f64 = 2.0;
/// Corrections from [`NEAR`] to round-off where convergence is linear.
const LINEAR_CORRECTIONS: f64 = 4.0;
/// Residuals that a note shows.
const SHOWN: usize = 6;

/// The order of a step, and whether it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    /// Observed, or bounded from below by more than [`QUADRATIC`].
    Known(f64),
    /// Too few residuals above round-off.
    Unknown,
}

fn quotient(residuals: &[f64]) -> Option<f64> {
    let [r0, r1, r2] = *residuals.last_chunk()?;
    let falls = r0 > r1 && r1 > r2;
    // A residual that is exactly zero is round-off as any other.
    falls.then(|| (r2.max(f64::MIN_POSITIVE) / r1).ln() / (r1 / r0).ln())
}

fn order(step: &StepResiduals) -> Order {
    let floor = step.round_off();
    let Some(last) = step.residuals.iter().rposition(|residual| *residual > floor) else { return Order::Unknown };
    let observed = quotient(&step.residuals[..=last]);
    let bound = step.residuals.get(..last + 2).and_then(quotient).filter(|bound| *bound > QUADRATIC);
    match (observed, bound) {
        (Some(observed), bound) => Order::Known(observed.max(bound.unwrap_or(observed))),
        (None, Some(bound)) => Order::Known(bound),
        (None, None) => Order::Unknown,
    }
}

/// Corrections from the first residual below [`NEAR`] to round-off; `None` if no residual is that small.
fn corrections(step: &StepResiduals) -> Option<usize> {
    let floor = step.round_off();
    let near = step.residuals.iter().position(|residual| *residual < NEAR)?;
    let end = step.residuals[near..].iter().position(|residual| *residual <= floor)?;
    Some(end)
}

/// Rows of a run: order and corrections with their bounds, residuals of one step as a note, iterations a step.
pub fn rows(run: &Run, findings: &mut Findings) -> Outcome<()> {
    rows_at(run, findings, Rate::Quadratic)
}

/// How fast Newton is to converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// Quadratic convergence, with an exact tangent.
    Quadratic,
    /// Linear convergence: mortar contact in dynamics leaves the second derivatives of the weights out of the tangent.
    Linear,
}

/// Rows of a run as [`rows`], for a run that is to converge at this rate.
pub fn rows_at(run: &Run, findings: &mut Findings, rate: Rate) -> Outcome<()> {
    let steps = run.newton()?;
    let touching: Vec<&StepResiduals> = steps.iter().filter(|step| step.active > 0.0).collect();
    let mut orders: Vec<f64> = touching
        .iter()
        .filter_map(|step| match order(step) {
            Order::Known(order) => Some(order),
            Order::Unknown => None,
        })
        .collect();
    orders.sort_by(f64::total_cmp);
    let median = orders.get(orders.len() / 2).copied().unwrap_or(f64::NAN);
    let bound = if orders.len() < FEW || rate == Rate::Linear { Bound::Unbounded } else { Bound::AtLeast(QUADRATIC) };
    let note = format!(
        "median of {} of {} steps in contact, since the last change of the active set; the others are at round-off too soon",
        orders.len(),
        touching.len()
    );
    findings.checks.push(Check::new(&run.name, "order of the last residuals in contact", median, bound).noted(note));
    let counts: Vec<usize> = touching.iter().copied().filter_map(corrections).collect();
    let mean = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
    let row = Check::new(
        &run.name,
        format!("corrections from below {NEAR:e} to round-off, mean of the steps in contact"),
        mean,
        Bound::AtMost(if rate == Rate::Linear { LINEAR_CORRECTIONS } else { CORRECTIONS }),
    );
    // The step with most residuals shows most.
    let example = touching.iter().max_by_key(|step| step.residuals.len());
    let example = example.map_or_else(String::new, |step| {
        let from = step.residuals.len().saturating_sub(SHOWN);
        let list: Vec<String> = step.residuals[from..].iter().map(|residual| format!("{residual:.1e}")).collect();
        format!("of {} steps; step {}: {}", counts.len(), step.step, list.join(", "))
    });
    findings.checks.push(row.noted(example));
    findings.checks.push(Check::new(&run.name, "iterations a step", mean_iterations(&steps), Bound::Unbounded));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(residuals: &[f64]) -> StepResiduals {
        StepResiduals { step: 1.0, active: 1.0, iterations: residuals.len() - 1, residuals: residuals.to_vec() }
    }

    /// What a linear iteration of this rate leaves.
    fn linear(rate: f64) -> StepResiduals {
        let residuals: Vec<f64> = (0..).map(|k| 0.1 * rate.powi(k)).take_while(|r| *r > 1e-15).collect();
        step(&[&residuals[..], &[1e-15]].concat())
    }

    #[test]
    fn quadratic_iterations_are_found_out() {
        let exact = step(&[1e-1, 1e-2, 1e-4, 1e-8, 1e-16]);
        assert!(matches!(order(&exact), Order::Known(o) if (o - 2.0).abs() < 1e-12), "{:?}", order(&exact));
        // 1e-8 is the first one below, 1e-16 is round-off.
        assert_eq!(corrections(&exact), Some(1));
        // At round-off after two corrections: the bound is enough.
        let short = step(&[1e-3, 1e-7, 3e-15]);
        assert!(matches!(order(&short), Order::Known(o) if o > 1.8));
        assert_eq!(corrections(&short), Some(1));
        // A nearly linear problem has no order.
        assert_eq!((order(&step(&[1e-5, 1e-15])), corrections(&step(&[1e-5, 1e-15]))), (Order::Unknown, Some(1)));
        assert_eq!(corrections(&step(&[1e-1, 1e-3])), None);
        // Two blocks, backward Euler: the last correction settles the positions, the residual before was round-off already.
        let settles = step(&[6.9e-3, 6.6e-8, 6.9e-15, 1.9e-16]);
        assert_eq!((order(&settles), corrections(&settles)), (Order::Unknown, Some(1)));
    }

    #[test]
    fn linear_iterations_are_found_out() {
        for rate in [0.5, 0.1, 1e-2, 1e-3] {
            let step = linear(rate);
            assert!(matches!(order(&step), Order::Known(o) if (o - 1.0).abs() < 0.3), "{rate}: {:?}", order(&step));
            assert!(corrections(&step).unwrap() as f64 > CORRECTIONS, "{rate}");
        }
    }
}
