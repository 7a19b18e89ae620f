//! Coordinate augmentation in whole models: the three sizes of the system, the direct form, momenta (theory/coordinate-augmentation, theory/examples#two-elements).

use crate::support::{drift, simulation, two_blocks};
use stoss::solver::{Simulation, StepRecord};

const FRICTION: &str = r#"friction = { law = "coulomb", mu = 0.5, penalty = 1e4 }"#;

/// The default: exact stick.
const EXACT: &str = r#"friction = { law = "coulomb", mu = 0.5 }"#;

/// The two elements of theory/examples#two-elements (thesis, table 6.2); `contact`: the keys of the contact after its surfaces.
fn impact(scheme: &str, step: f64, end: f64, contact: &str) -> Simulation {
    simulation(&two_blocks(scheme, step, end, [0.0; 3], contact))
}

/// A block of 2 x 2 x 1 elements that slides over the facets of a deformable plate on which it lies; the plate is warped by its weight.
fn slide(scheme: &str, step: f64, contact: &str) -> Simulation {
    simulation(&format!(
        r#"
[scene]
title = "block on a plate"
kind = "dynamic"
[time]
end = 0.5
step = {step:?}
integrator = {{ scheme = "{scheme}" }}
[[body]]
name = "plate"
mesh = {{ generator = "block", min = [-1, -1, -1], max = [4, 2, 0], divisions = [10, 6, 1] }}
material = {{ law = "neo-hooke", young = 2e3, poisson = 0.3 }}
density = 1.0
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0.1, 0.05, 0], max = [1.1, 1.05, 0.5], divisions = [2, 2, 1] }}
material = {{ law = "neo-hooke", young = 2e3, poisson = 0.3 }}
density = 2.0
velocity = [4, 1, 0]
[[prescribe]]
set = "plate.bottom"
components = ["x", "y", "z"]
fixed = true
[[contact]]
slave = "block.bottom"
master = "plate.top"
{contact}
[[load]]
body = "block"
body_force = [0, 0, -40]
"#
    ))
}

struct Run {
    /// Positions after every step.
    q: Vec<Vec<f64>>,
    records: Vec<StepRecord>,
    /// Largest number of equations.
    equations: usize,
}

fn run(mut s: Simulation) -> Run {
    let mut run = Run { q: Vec::new(), records: vec![s.initial_record()], equations: s.equations() };
    while !s.finished() {
        run.records.push(s.advance().unwrap());
        run.q.push(s.state().q.clone());
        run.equations = run.equations.max(s.equations());
    }
    run
}

impl Run {
    fn contact_steps(&self) -> usize {
        self.records.iter().filter(|r| r.contact.as_ref().is_some_and(|c| c.active > 0)).count()
    }

    fn drifts(&self) -> [f64; 2] {
        let linear: Vec<_> = self.records.iter().map(|r| r.balance.linear_momentum).collect();
        let angular: Vec<_> = self.records.iter().map(|r| r.balance.angular_momentum).collect();
        [drift(&linear), drift(&angular)]
    }
}

/// Largest difference of any position in any step.
fn distance(a: &Run, b: &Run) -> f64 {
    assert_eq!(a.q.len(), b.q.len());
    a.q.iter().flatten().zip(b.q.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn cat(options: &str, friction: &str) -> String {
    format!("method = \"cat\"\n{options}\n{friction}")
}

/// Residuals fall quadratically once they are small, wherever constraints and pairings stay.
fn assert_quadratic(name: &str, run: &Run) {
    let mut checked = 0;
    for record in &run.records {
        for pair in record.newton.windows(2).skip(1).filter(|pair| pair.iter().all(|row| row.changes == 0)) {
            let (before, after) = (pair[0].residual, pair[1].residual);
            if (1e-9..1e-3).contains(&before) {
                checked += 1;
                assert!(after < 10.0 * before * before + 2e-12, "{name}, t = {}: {before:e} {after:e}", record.time);
            }
        }
    }
    assert!(checked > 3, "{name}: {checked}");
}

#[test]
fn all_sizes_of_the_system_have_the_same_solution() {
    for (scheme, step, end) in [("backward-euler", 0.02, 6.0), ("midpoint", 0.2, 20.0), ("midpoint", 0.05, 6.0)] {
        for friction in [FRICTION, EXACT, ""] {
            let at = |options: &str| {
                let found = run(impact(scheme, step, end, &cat(options, friction)));
                assert_quadratic(&format!("{scheme} {options}"), &found);
                found
            };
            let second = at("");
            assert!(second.contact_steps() > 3);
            for options in ["reduction = \"none\"", "reduction = \"first\"", "reduction = \"second\""] {
                let other = at(options);
                let far = distance(&second, &other);
                assert!(far < 1e-9, "{scheme} {step} {options} {friction}: {far:e}");
            }
        }
    }
}

#[test]
fn only_the_full_reduction_has_the_size_of_the_direct_form() {
    let equations = |contact: &str| run(impact("midpoint", 0.1, 3.0, contact)).equations;
    let direct = equations("method = \"nts\"");
    // Four slave nodes.
    for (reduction, further) in [("none", 16), ("first", 8), ("second", 0)] {
        assert_eq!(equations(&cat(&format!("reduction = \"{reduction}\""), "")), direct + further);
    }
}

/// The upper block travels about 2 until t = 20.
#[test]
fn it_agrees_with_the_direct_form() {
    for (scheme, step, end, friction, tolerance) in [
        // The equations are the same at the end point.
        ("backward-euler", 0.005, 6.0, FRICTION, 1e-8),
        ("backward-euler", 0.005, 6.0, EXACT, 1e-8),
        ("backward-euler", 0.02, 6.0, "", 1e-8),
        // At the midpoint the foot is not that of the mean coordinates: of second order in the step.
        ("midpoint", 0.02, 6.0, FRICTION, 1e-4),
        ("midpoint", 0.02, 6.0, EXACT, 1e-4),
        ("midpoint", 0.02, 6.0, "", 1e-4),
    ] {
        let direct = format!("method = \"nts\"\nclosing = \"keep\"\n{friction}");
        let far =
            distance(&run(impact(scheme, step, end, &direct)), &run(impact(scheme, step, end, &cat("", friction))));
        assert!(far < tolerance, "{scheme} {friction}: {far:e}");
    }
}

#[test]
fn momenta_are_constant() {
    for options in ["reduction = \"none\"", ""] {
        for (scheme, friction) in ["midpoint", "energy-momentum"].iter().flat_map(|s| [(s, FRICTION), (s, EXACT)]) {
            let found = run(impact(scheme, 0.2, 20.0, &cat(options, friction)));
            let [linear, angular] = found.drifts();
            assert!(linear < 1e-11 && angular < 1e-11, "{scheme} {options}: {linear:e} {angular:e}");
            let dissipation: Vec<f64> = found.records.iter().map(|r| r.balance.dissipation).collect();
            let last = dissipation[dissipation.len() - 1];
            let least = if friction == EXACT { 0.0 } else { -1e-15 * last };
            assert!(
                dissipation.windows(2).all(|d| d[1] - d[0] >= least) && last > 0.0,
                "{scheme} {options} {friction}"
            );
        }
        let found = run(impact("backward-euler", 0.02, 6.0, &cat(options, FRICTION)));
        assert!(found.drifts()[0] < 1e-11, "{:e}", found.drifts()[0]);
    }
}

/// Over the edges of many facets; at the end point every step is that of the direct form.
#[test]
fn it_slides_over_edges() {
    let decisions = |run: &Run| run.records.iter().map(|r| r.decisions.len()).sum::<usize>();
    for friction in
        [r#"friction = { law = "coulomb", mu = 0.2, penalty = 1e4 }"#, r#"friction = { law = "coulomb", mu = 0.2 }"#]
    {
        let direct = run(slide("backward-euler", 0.02, &format!("method = \"nts\"\n{friction}")));
        for reduction in ["none", "first", "second"] {
            let options = format!("reduction = \"{reduction}\"");
            let found = run(slide("backward-euler", 0.02, &cat(&options, friction)));
            assert_quadratic(&format!("slide {reduction}"), &found);
            assert!(distance(&direct, &found) < 1e-8, "{reduction}: {:e}", distance(&direct, &found));
            assert_eq!(decisions(&found), 0);
        }
        let [a, b, c] = ["none", "first", "second"]
            .map(|reduction| run(slide("midpoint", 0.01, &cat(&format!("reduction = \"{reduction}\""), friction))));
        assert!(distance(&a, &b) < 1e-8 && distance(&a, &c) < 1e-8, "{friction}");
    }
}

/// Kinetic, strain and spring energy are constant before and after the impact and never rise in it; the solids have their conserving stress.
#[test]
fn energies_of_the_impact() {
    for (step, friction) in [(0.02, FRICTION), (0.2, FRICTION), (0.02, EXACT), (0.2, EXACT)] {
        let found = run(impact("energy-momentum", step, 20.0, &cat("", friction)));
        let energy: Vec<f64> =
            found.records.iter().map(|r| r.balance.kinetic + r.balance.strain + r.balance.contact).collect();
        let active: Vec<usize> =
            found.records.iter().map(|r| r.contact.as_ref().map_or(0, |contact| contact.active)).collect();
        let first = active.iter().position(|&a| a > 0).unwrap();
        let last = active.iter().rposition(|&a| a > 0).unwrap();
        assert!(last + 10 < energy.len(), "it leaves again");
        let mut gain = f64::NEG_INFINITY;
        for k in 1..energy.len() {
            let change = (energy[k] - energy[k - 1]) / energy[0];
            if k < first || k > last + 1 {
                assert!(change.abs() < 1e-10, "step {k}: {change:e}");
            }
            gain = gain.max(change);
        }
        // Where the foot moves on a warped facet the work of the midpoint rule is not exact.
        assert!(gain < 1e-9, "{step} {friction}: {gain:e}");
        assert!(energy[last] < energy[0]);
    }
}

/// At the large step of the thesis both forms follow the fine solution; they are hardly off each other.
#[test]
fn at_large_steps_it_follows_the_fine_solution_and_the_direct_form() {
    // Travelled by then.
    const WAY: f64 = 0.6;
    for (friction, bound, apart) in [(FRICTION, 0.25, 1e-7), (EXACT, 0.03, 5e-6)] {
        let direct = format!("method = \"nts\"\n{friction}");
        let augmented = cat("", friction);
        let end = |step: f64, contact: &str| run(impact("midpoint", step, 6.0, contact)).q.pop().unwrap();
        let far = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let (fine, coarse) = (end(0.005, &augmented), end(0.2, &augmented));
        let off_coarse = far(&coarse, &end(0.2, &direct));
        let off_resolved = far(&end(0.02, &augmented), &end(0.02, &direct));
        let error = far(&coarse, &fine) / WAY;
        println!("{friction}: {error:e} of the way, forms apart by {off_coarse:e}, resolved {off_resolved:e}");
        // Still smaller steps resolve the rattling of the nodes, which amplifies the round-off between the forms.
        assert!(error < bound && off_coarse < 1e-6, "{friction}: {error:e} {off_coarse:e}");
        assert!(off_resolved < apart, "{friction}: {off_resolved:e}");
    }
}

/// In statics as at the end point.
#[test]
fn statics_are_those_of_the_direct_form() {
    let few = |contact: &str| {
        run(simulation(&format!(
            r#"
[scene]
title = "a block is pressed on a larger one and pushed"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [-1, -1, -1], max = [2, 2, 0], divisions = [3, 3, 1] }}
material = {{ law = "neo-hooke", young = 1e3, poisson = 0.3 }}
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [0.2, 0.3, 0], max = [0.9, 0.9, 1], divisions = [2, 2, 2] }}
material = {{ law = "neo-hooke", young = 1e3, poisson = 0.3 }}
[[prescribe]]
set = "lower.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "upper.top"
components = ["x", "y", "z"]
displacement = {{ table = [[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0, -0.1], [1.0, 0.2, 0.1, -0.1]] }}
[[contact]]
slave = "upper.bottom"
master = "lower.top"
friction = {{ law = "coulomb", mu = 0.2, penalty = 1e4 }}
{contact}
"#
        )))
    };
    let direct = few("method = \"nts\"");
    assert!(direct.contact_steps() > 0);
    for reduction in ["none", "first", "second"] {
        let found = few(&cat(&format!("reduction = \"{reduction}\""), ""));
        assert!(distance(&direct, &found) < 1e-9, "{reduction}: {:e}", distance(&direct, &found));
    }
}

#[test]
fn what_is_not_available_is_refused() {
    let base = |scheme: &str, contact: &str| {
        format!(
            r#"
[scene]
title = "refused"
kind = "dynamic"
[time]
end = 1.0
step = 0.1
integrator = {{ scheme = "{scheme}" }}
[[body]]
name = "a"
mesh = {{ generator = "block", size = [1, 1, 1], divisions = [1, 1, 1] }}
material = {{ law = "neo-hooke", young = 1e3, poisson = 0.3 }}
density = 1.0
[[body]]
name = "b"
mesh = {{ generator = "block", size = [1, 1, 1], divisions = [1, 1, 1] }}
position = [0, 0, 2]
material = {{ law = "neo-hooke", young = 1e3, poisson = 0.3 }}
density = 1.0
[[contact]]
slave = "b.bottom"
master = "a.top"
{contact}
"#
        )
    };
    let scene = stoss::scene::parse(&base("trapezoidal", "method = \"cat\""), "test.toml").unwrap();
    let errors = stoss::build::build(&scene, std::path::Path::new(".")).unwrap_err().to_string();
    assert!(errors.contains("contact[0].method") && errors.contains("`trapezoidal`"), "{errors}");
    let text = base("midpoint", "method = \"nts\"\nreduction = \"first\"");
    let errors = stoss::scene::parse(&text, "test.toml").unwrap_err().to_string();
    assert!(errors.contains("`cat`"), "{errors}");
}
