//! The mass point and the mathematical pendulum (figures 5.5, 5.6 and C.4 of the thesis), for the suite `conservation`.

use super::Findings;
use super::check::{Bound, Check};
use super::report::ReportSection;
use crate::plot::{self, Drawn, Labels, Series};
use crate::verify::numbers::largest;
use crate::workspace::Outcome;
use stoss_integrators::scheme;
use stoss_model_problems::{BouncingBar, ConstraintForm, MassPoint, ModelProblem, Pendulum, ReducedPendulum, simulate};

/// Values over time of one run.
#[derive(Default)]
struct History {
    time: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
    energy: Vec<f64>,
    violation: Vec<f64>,
}

fn run(problem: &dyn ModelProblem, name: &str, dt: f64, steps: u64) -> Outcome<History> {
    let mut h = History::default();
    simulate(problem, scheme(name)?.as_ref(), dt, steps, |s| {
        h.time.push(s.time);
        h.first.push(s.q[0]);
        h.second.push(s.q.get(1).copied().unwrap_or(0.0));
        h.energy.push(s.energy());
        h.violation.push(s.violation);
    })?;
    Ok(h)
}

/// Checks and figures of all three problems.
pub fn measure(findings: &mut Findings) -> Outcome<()> {
    mass_point(findings)?;
    pendulum(findings)?;
    bar(findings)
}

fn mass_point(findings: &mut Findings) -> Outcome<()> {
    for (form, figure, end, tolerance) in
        [(ConstraintForm::Standard, "5.5", 49.05, 5e-3), (ConstraintForm::Modified, "5.6", 159.65, 1e-10)]
    {
        let h = run(&MassPoint::new(form), "midpoint", 0.05, 120)?;
        let name = format!("mass point, {form:?}").to_lowercase();
        let mut check =
            |quantity: &str, value: f64, bound| findings.checks.push(Check::new(&name, quantity, value, bound));
        check("energy at the start", h.energy[0], Bound::Near { value: 159.65, tolerance: 1e-10 });
        check("energy at T = 6", h.energy[120], Bound::Near { value: end, tolerance });
        if form == ConstraintForm::Modified {
            let drift = largest(h.energy.iter().map(|e| (e / 159.65 - 1.0).abs()));
            check("energy drift", drift, Bound::AtMost(1e-12));
        }
        let title = |what: &str| format!("figure {figure}: {name}, {what}");
        let mut section = ReportSection { title: title("step 0.05"), reading: "A model problem of the thesis with two degrees of freedom, where the energies are known. With the modified constraint the energy is constant to round-off; with the standard one it falls when contact closes.".into(), ..ReportSection::default() };
        for (what, values) in [("height", &h.first), ("energy", &h.energy)] {
            let labels = Labels { title: &title(what), x: "time", y: what };
            section.figures.push(plot::linear(labels, &[Series::new(what, &h.time, values.iter().copied())]));
        }
        findings.sections.push(section);
    }
    Ok(())
}

fn pendulum(findings: &mut Findings) -> Outcome<()> {
    let (dt, steps) = (0.1, 400);
    let pendulum = Pendulum::default();
    let dae = run(&pendulum, "midpoint", dt, steps)?;
    let reduced = run(&ReducedPendulum(pendulum), "midpoint", dt, steps)?;
    let off =
        |h: &History| -> Vec<f64> { h.first.iter().zip(&h.second).map(|(x, y)| (x * x + y * y - 1.0).abs()).collect() };
    let (dae_off, reduced_off) = (off(&dae), off(&reduced));
    let mut check =
        |name: &str, quantity: &str, value: f64, bound| findings.checks.push(Check::new(name, quantity, value, bound));
    check(
        "pendulum, index 3",
        "largest distance from the manifold",
        largest(dae_off.iter().copied()),
        Bound::AtMost(1e-12),
    );
    let half = steps as usize / 2;
    let (early, late) = (largest(reduced_off[..half].iter().copied()), largest(reduced_off[half..].iter().copied()));
    check("pendulum, reduced index", "largest distance from the manifold, first half", early, Bound::AtLeast(1e-6));
    check("pendulum, reduced index", "second half over first half: the drift grows", late / early, Bound::AtLeast(1.1));
    let mut section = ReportSection { title: "figure C.4: pendulum, step 0.1".into(), reading: "A pendulum by its coordinates and a multiplier (index 3), and with the differentiated constraint (reduced index). The first stays on the circle to round-off, the second drifts off it: why constraints are enforced at positions here.".into(), ..ReportSection::default() };
    let path = |name: &str, h: &History| Series {
        name: name.into(),
        points: h.first.iter().copied().zip(h.second.iter().copied()).collect(),
    };
    let labels = Labels { title: "figure C.4: paths", x: "x1", y: "x2" };
    let paths = [path("index 3", &dae), path("reduced index", &reduced)];
    section.figures.push(plot::trajectory(labels, &paths, Drawn::Lines));
    let labels = Labels { title: "figure C.4: energy", x: "time", y: "energy" };
    let energies = [
        Series::new("index 3", &dae.time, dae.energy.iter().copied()),
        Series::new("reduced index", &reduced.time, reduced.energy.iter().copied()),
    ];
    section.figures.push(plot::linear(labels, &energies));
    let labels = Labels { title: "distance from the manifold", x: "time", y: "" };
    let distances =
        [Series::new("index 3", &dae.time, dae_off), Series::new("reduced index", &reduced.time, reduced_off)];
    section.figures.push(plot::logarithmic(labels, &distances, 1e-17));
    findings.sections.push(section);
    Ok(())
}

fn bar(findings: &mut Findings) -> Outcome<()> {
    let (dt, steps) = (0.005, 800);
    let mut section = ReportSection { title: "bouncing elastic bar, 80 elements".into(), reading: "A bar hits a rigid wall; the closed form has a front that stays at the wall for the time a wave takes there and back. Left its path, right the energies with the standard and the modified constraint.".into(), ..ReportSection::default() };
    let exact = BouncingBar::new(80, ConstraintForm::Standard);
    let mut fronts = Vec::new();
    let mut energies = Vec::new();
    for (form, name) in [(ConstraintForm::Standard, "standard"), (ConstraintForm::Modified, "modified")] {
        let problem = BouncingBar { form, ..exact };
        let h = run(&problem, "energy-momentum", dt, steps)?;
        let scale = problem.speed * problem.exact_duration();
        let error = largest(h.time.iter().zip(&h.first).map(|(&t, &x)| (x - problem.exact_front(t)).abs())) / scale;
        let scene = format!("bouncing bar, {name}");
        let mut check = |quantity: &str, value, bound| findings.checks.push(Check::new(&scene, quantity, value, bound));
        check("front node against the closed form, over v T", error, Bound::AtMost(0.05));
        if form == ConstraintForm::Modified {
            let drift = largest(h.energy.iter().map(|e| (e / h.energy[0] - 1.0).abs()));
            check("energy drift", drift, Bound::AtMost(1e-11));
        }
        fronts.push(Series::new(name, &h.time, h.first.iter().copied()));
        energies.push(Series::new(name, &h.time, h.energy.iter().map(|e| e / h.energy[0])));
        if form == ConstraintForm::Modified {
            fronts.push(Series::new("closed form", &h.time, h.time.iter().map(|&t| problem.exact_front(t))));
        }
    }
    let labels = Labels { title: "position of the front node", x: "time", y: "" };
    section.figures.push(plot::linear(labels, &fronts));
    let labels = Labels { title: "energy over its start", x: "time", y: "" };
    section.figures.push(plot::linear(labels, &energies));
    findings.sections.push(section);
    Ok(())
}
