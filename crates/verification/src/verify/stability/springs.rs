//! Which scheme stays bounded at which step size and stiffness: the spring pendulum of theory/integrators#spring over eight decades.

use super::super::check::{Bound, Check};
use super::super::report::{Grid, ReportSection};
use super::super::{Bench, Findings};
use crate::plot::{self, Cell, Labels, Series};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;
use stoss_integrators::{SCHEMES, Scheme, scheme};
use stoss_model_problems::{AugmentedSpringPendulum, ModelError, ModelProblem, SpringPendulum, simulate};

/// One revolution, the slowest period of the problem at any stiffness (`T = 0.63`).
const PERIOD: f64 = 0.63;

/// Stiffnesses `c` of the map: eight decades.
const STIFFNESS: [f64; 9] = [1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10];

/// Steps over the slowest period.
const STEPS: [f64; 9] = [1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 6e-2, 1e-1];

/// Most steps of a run in full mode; ten revolutions unless that is more.
const MOST_STEPS: u64 = 20_000;

/// The same in quick mode.
const MOST_STEPS_QUICK: u64 = 600;

/// Energy may wander so much and still count as bounded: the order of the schemes at steps that resolve the motion.
const WANDER: f64 = 0.02;

/// Energy beyond this multiple of the start is a blow-up.
const BLOW_UP: f64 = 2.0;

/// Runs of the map in which Newton may find no solution for a scheme that keeps the energy. The system with augmented coordinates is harder to solve at
/// ten times the resolved step: its constraint is a further nonlinear equation.
const MOST_FAILURES: f64 = 3.0;

/// Names of the verdicts in the legend.
pub const VERDICTS: [&str; 5] = ["bounded", "dissipates", "drifts", "blows up", "Newton fails"];

/// What became of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Energy within [`WANDER`] of the start.
    Bounded,
    /// Energy falls; the fraction that is left.
    Dissipates(f64),
    /// Energy leaves the bound, but not by more than [`BLOW_UP`].
    Drifts(f64),
    /// Energy grows beyond [`BLOW_UP`] times the start; the factor.
    BlowsUp(f64),
    /// No solution was found.
    NewtonFails,
}

impl Verdict {
    /// Number in [`VERDICTS`].
    fn category(self) -> usize {
        match self {
            Self::Bounded => 0,
            Self::Dissipates(_) => 1,
            Self::Drifts(_) => 2,
            Self::BlowsUp(_) => 3,
            Self::NewtonFails => 4,
        }
    }

    fn cell(self) -> Cell {
        let text = match self {
            Self::Bounded | Self::NewtonFails => String::new(),
            Self::Dissipates(left) => format!("{left:.2}"),
            Self::Drifts(factor) => format!("{factor:.2}"),
            Self::BlowsUp(factor) if factor.is_finite() && factor < 1e4 => format!("{factor:.0}"),
            Self::BlowsUp(_) => "inf".into(),
        };
        Cell { category: Some(self.category()), text }
    }
}

/// Energy over its start, its largest and its last value.
struct Course {
    largest: f64,
    last: f64,
    error: Option<ModelError>,
}

/// Name of the energy-momentum scheme on the pendulum with an augmented coordinate.
const AUGMENTED: &str = "energy-momentum, augmented";

/// Every scheme on the pendulum, and [`AUGMENTED`].
fn names() -> impl Iterator<Item = &'static str> {
    SCHEMES.iter().map(|entry| entry.name).chain([AUGMENTED])
}

/// The scheme and the problem that a name stands for.
fn named(name: &str, pendulum: SpringPendulum) -> Outcome<(Box<dyn Scheme>, Box<dyn ModelProblem>)> {
    Ok(match name {
        AUGMENTED => (scheme("energy-momentum")?, Box::new(AugmentedSpringPendulum(pendulum))),
        _ => (scheme(name)?, Box::new(pendulum)),
    })
}

fn course(problem: &dyn ModelProblem, scheme: &dyn Scheme, dt: f64, steps: u64) -> Course {
    let (mut first, mut largest, mut last) = (f64::NAN, 0.0_f64, f64::NAN);
    let result = simulate(problem, scheme, dt, steps, |s| {
        if s.step == 0 {
            first = s.energy();
        }
        last = s.energy() / first;
        largest = largest.max(last);
    });
    Course { largest, last, error: result.err() }
}

/// Verdict of a run.
fn verdict(course: &Course) -> Verdict {
    match course.error {
        Some(ModelError::Unbounded { .. }) => Verdict::BlowsUp(f64::INFINITY),
        // It went up before there was no solution any more.
        Some(_) if course.largest > BLOW_UP => Verdict::BlowsUp(course.largest),
        Some(_) => Verdict::NewtonFails,
        None if course.last.is_nan() || course.largest > BLOW_UP => Verdict::BlowsUp(course.largest),
        None if course.largest > 1.0 + WANDER => Verdict::Drifts(course.largest),
        None if course.last < 1.0 - WANDER => Verdict::Dissipates(course.last),
        None => Verdict::Bounded,
    }
}

/// The map, figures 6.2 to 6.4 of the thesis, and the factors of theory/integrators#spring.
pub fn measure(bench: &Bench) -> Outcome<Findings> {
    let mut findings = Findings::default();
    let mut section = ReportSection { title: "stability: step size and stiffness".into(), reading: "A spring pendulum of any stiffness at any step (theory/integrators#spring). Each cell of the map is a run: what matters is how far to the right, at stiff springs and large steps, a scheme stays bounded and keeps what it promises.".into(), ..ReportSection::default() };
    let mut combinations = 0;
    let steps: &[f64] = if bench.quick { &STEPS[3..] } else { &STEPS };
    let mut table = Grid {
        caption: format!(
            "Spring pendulum over {} stiffnesses and {} steps: number of runs by verdict",
            STIFFNESS.len(),
            steps.len()
        ),
        head: std::iter::once("scheme").chain(VERDICTS).map(str::to_owned).collect(),
        rows: Vec::new(),
    };
    for name in names() {
        let mut counts = [0_usize; VERDICTS.len()];
        let mut cells = Vec::new();
        let mut outside = Vec::new();
        for stiffness in STIFFNESS {
            let (scheme, problem) = named(name, SpringPendulum::with_stiffness(stiffness))?;
            let row: Vec<Verdict> = steps
                .iter()
                .map(|&step| {
                    let most = if bench.quick { MOST_STEPS_QUICK } else { MOST_STEPS };
                    let count = ((10.0 / step) as u64).min(most);
                    verdict(&course(problem.as_ref(), scheme.as_ref(), step * PERIOD, count))
                })
                .collect();
            row.iter().for_each(|v| counts[v.category()] += 1);
            let not_bounded = steps.iter().zip(&row).filter(|(_, verdict)| **verdict != Verdict::Bounded);
            outside.extend(
                not_bounded.map(|(step, verdict)| format!("c = {stiffness:.0e}, step {step:.0e}: {verdict:?}")),
            );
            cells.push(row.into_iter().map(Verdict::cell).collect::<Vec<_>>());
        }
        combinations += counts.iter().sum::<usize>();
        let labels = Labels { title: name, x: "step over the slowest period", y: "stiffness" };
        let names = |values: &[f64]| values.iter().map(|v| format!("{v:.0e}")).collect::<Vec<_>>();
        section.figures.push(plot::map(labels, &names(steps), &names(&STIFFNESS), &VERDICTS, &cells));
        table.rows.push(std::iter::once(name.to_owned()).chain(counts.map(|n| n.to_string())).collect());
        if name.starts_with("energy-momentum") {
            let wrong = counts[1..4].iter().sum::<usize>();
            let quantity = format!("{name}: runs of the map whose energy is not kept");
            findings.checks.push(Check::new("spring", quantity, wrong as f64, Bound::AtMost(0.0)));
            let quantity = format!("{name}: runs of the map without a solution");
            let check = Check::new("spring", quantity, counts[4] as f64, Bound::AtMost(MOST_FAILURES));
            findings.checks.push(check.noted(outside.join("; ")));
        }
    }
    section.tables.push(table);
    findings.checks.push(Check::new(
        "spring",
        "combinations of scheme, step and stiffness",
        combinations as f64,
        Bound::AtLeast(150.0),
    ));
    findings.sections.push(section);
    known_factors(&mut findings)?;
    long_runs(bench, &mut findings)?;
    figures(&mut findings)?;
    Ok(findings)
}

/// The factors of theory/integrators#spring on the stiff spring, largest energy at the step 1e-2 and energy left at 5e-4.
fn known_factors(findings: &mut Findings) -> Outcome<()> {
    let stiff = SpringPendulum::stiff();
    for (name, dt, value, tolerance) in [
        // Chaotic: rounding decides about the last digits of the three that blow up.
        ("trapezoidal", 1e-2, 9.0, 1.0),
        ("midpoint", 1e-2, 527.0, 5.0),
        ("variational-midpoint", 1e-2, 527.0, 5.0),
        ("generalised-alpha", 1e-2, 322.0, 5.0),
        ("energy-momentum", 1e-2, 1.0, 1e-10),
        (AUGMENTED, 1e-2, 1.0, 1e-10),
        ("trapezoidal", 5e-4, 1.0, 0.02),
        ("midpoint", 5e-4, 1.0, 0.02),
        ("variational-midpoint", 5e-4, 1.0, 0.02),
    ] {
        let steps = (PERIOD / dt).round() as u64;
        let (scheme, problem) = named(name, stiff)?;
        let course = course(problem.as_ref(), scheme.as_ref(), dt, steps);
        let quantity = format!("{name}: largest energy over the first, step {dt:.0e}");
        findings.checks.push(Check::new("stiff spring", quantity, course.largest, Bound::Near { value, tolerance }));
    }
    for (name, value, tolerance) in
        [("backward-euler", 0.003, 0.001), ("generalised-alpha", 0.67, 0.01), ("energy-momentum", 1.0, 1e-10)]
    {
        let course = course(&stiff, scheme(name)?.as_ref(), 5e-4, 1260);
        let quantity = format!("{name}: energy left, step 5e-4");
        findings.checks.push(Check::new("stiff spring", quantity, course.last, Bound::Near { value, tolerance }));
    }
    let forward = course(&stiff, scheme("forward-euler")?.as_ref(), 5e-4, 1260);
    let blows_up = matches!(verdict(&forward), Verdict::BlowsUp(_));
    let quantity = "forward-euler: blows up, step 5e-4";
    findings.checks.push(Check::new("stiff spring", quantity, f64::from(u8::from(blows_up)), Bound::AtLeast(1.0)));
    Ok(())
}

/// Energy over very many steps of the stiff spring.
fn long_runs(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let steps = if bench.quick { 10_000 } else { 100_000 };
    for name in ["energy-momentum", AUGMENTED] {
        let (mut first, mut worst) = (f64::NAN, 0.0_f64);
        let (scheme, problem) = named(name, SpringPendulum::stiff())?;
        simulate(problem.as_ref(), scheme.as_ref(), 1e-2, steps, |s| {
            if s.step == 0 {
                first = s.energy();
            }
            worst = larger(worst, (s.energy() / first - 1.0).abs());
        })?;
        let quantity = format!("{name}: energy drift over {steps} steps of 1e-2");
        findings.checks.push(Check::new("stiff spring", quantity, worst, Bound::AtMost(1e-10)));
    }
    Ok(())
}

/// Figures 6.2 to 6.4 of the thesis: the reference paths, and the energies of all schemes on the stiff spring.
fn figures(findings: &mut Findings) -> Outcome<()> {
    let mut section = ReportSection { title: "figures 6.2, 6.3, 6.4: spring pendulum".into(), reading: "The spring pendulum of the thesis (chapter 6): reference paths of a soft and a stiff spring, and the energy of every scheme on the stiff one. A conserving scheme gives a horizontal line; blow-up and decay can be seen.".into(), ..ReportSection::default() };
    for (title, problem) in
        [("figure 6.2: soft spring", SpringPendulum::soft()), ("figure 6.2: stiff spring", SpringPendulum::stiff())]
    {
        let mut points = Vec::new();
        let every = 200;
        simulate(&problem, scheme("midpoint")?.as_ref(), 1e-5, 63_000, |s| {
            if s.step % every == 0 {
                // In the plane of the motion, spanned by (1, 0, 1)/sqrt 2 and the second axis.
                points.push(((s.q[0] + s.q[2]) / 2.0_f64.sqrt(), s.q[1]));
            }
        })?;
        let labels = Labels { title, x: "along (1, 0, 1)", y: "along (0, 1, 0)" };
        let series = [Series { name: "midpoint, step 1e-5".into(), points }];
        section.figures.push(plot::trajectory(labels, &series, plot::Drawn::Lines));
    }
    for (title, dt) in [("figure 6.3: stiff spring, step 5e-4", 5e-4), ("figure 6.4: stiff spring, step 1e-2", 1e-2)] {
        let mut series = Vec::new();
        for name in names().filter(|name| !["hht", "wbz", "newmark"].contains(name)) {
            let mut points = Vec::new();
            let mut first = f64::NAN;
            let (scheme, problem) = named(name, SpringPendulum::stiff())?;
            // A scheme that fails ends its line there.
            let _ = simulate(problem.as_ref(), scheme.as_ref(), dt, (PERIOD / dt).round() as u64, |s| {
                if s.step == 0 {
                    first = s.energy();
                }
                points.push((s.time, (s.energy() / first).clamp(1e-6, 1e6)));
            });
            series.push(Series { name: name.into(), points });
        }
        let labels = Labels { title, x: "time", y: "energy over its start" };
        section.figures.push(plot::logarithmic(labels, &series, 1e-3));
    }
    findings.sections.push(section);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_the_energy() {
        let of = |largest, last| verdict(&Course { largest, last, error: None });
        assert_eq!(of(1.001, 0.999), Verdict::Bounded);
        assert_eq!(of(1.0, 0.4), Verdict::Dissipates(0.4));
        assert_eq!(of(1.3, 0.9), Verdict::Drifts(1.3));
        assert_eq!(of(9.0, 1.0), Verdict::BlowsUp(9.0));
        assert!(matches!(of(f64::NAN, f64::NAN), Verdict::BlowsUp(_)), "a value that is no number is never bounded");
        let failed = ModelError::SingularTangent;
        assert_eq!(verdict(&Course { largest: 1.0, last: 1.0, error: Some(failed) }), Verdict::NewtonFails);
    }
}
