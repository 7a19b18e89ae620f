//! Statics that chooses its increments, and its stabilisation.

use crate::support::simulation;
use stoss::solver::{Decision, DecisionKind, Simulation, SimulationError};

fn scene(time: &str, rest: &str) -> String {
    format!("[scene]\ntitle = \"statics\"\nkind = \"quasi-static\"\n[time]\n{time}\n{rest}")
}

const SYMMETRY: &str = r#"
[[prescribe]]
set = "block.left"
components = ["x"]
fixed = true
[[prescribe]]
set = "block.front"
components = ["y"]
fixed = true
"#;

/// A unit block pressed by `stroke` at its top.
fn pressed(time: &str, stroke: f64) -> String {
    let rest = format!(
        r#"
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2], grading = [1, 1, 1.3] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[prescribe]]
set = "block.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.top"
components = ["x", "y", "z"]
displacement = {{ table = [[0, 0, 0, 0], [1, 0.1, 0, {stroke:?}]] }}
"#
    );
    scene(time, &rest)
}

/// Sizes of the steps.
fn run(simulation: &mut Simulation) -> Vec<f64> {
    let mut steps = Vec::new();
    while !simulation.finished() {
        steps.push(simulation.advance().unwrap_or_else(|error| panic!("{error}")).dt);
    }
    steps
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn increments_grow_where_it_is_easy_and_lead_to_the_same_equilibrium() {
    let time = "end = 1.0\nstep = 0.25\nautomatic = { initial = 0.01, smallest = 1e-4 }";
    let mut chosen = simulation(&pressed(time, -0.2));
    let steps = run(&mut chosen);
    // 0.25 / 32 is the largest one that is not above 0.01.
    assert!((steps[0] - 0.25 / 32.0).abs() < 1e-15 && steps.len() < 24, "{steps:?}");
    assert!((steps.iter().fold(0.0, |a: f64, b| a.max(*b)) - 0.25).abs() < 1e-15, "{steps:?}");
    let grown: Vec<&Decision> = chosen.decisions().iter().filter(|d| d.kind == DecisionKind::Grow).collect();
    assert!(grown.len() >= 5 && grown.iter().all(|d| d.reason.contains("2 steps in a row took at most 6 iterations")));
    let mut fixed = simulation(&pressed("end = 1.0\nstep = 0.05", -0.2));
    run(&mut fixed);
    assert!(distance(&chosen.state().q, &fixed.state().q) < 1e-9);
    // The same scene again has the same bits, and so has a run that is resumed in the middle.
    let mut again = simulation(&pressed(time, -0.2));
    for _ in 0..7 {
        again.advance().unwrap();
    }
    let checkpoint = again.checkpoint("t", Default::default());
    let mut resumed = simulation(&pressed(time, -0.2));
    resumed.restore(checkpoint, "t").unwrap();
    assert_eq!(run(&mut resumed), steps[7..]);
    assert_eq!(run(&mut again), steps[7..]);
    assert!(again.state().q == chosen.state().q && resumed.state().q == chosen.state().q);
}

/// A column whose top is turned by 170 degrees, too much for one step.
fn twisted(time: &str) -> String {
    let rest = r#"
[[body]]
name = "column"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 3], divisions = [2, 2, 4] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[prescribe]]
set = "column.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "column.top"
rotation = { axis = [0, 0, 1], about = [0.5, 0.5, 0], degrees = { table = [[0, 0], [1, 170]] } }
"#;
    scene(time, rest)
}

#[test]
fn increments_are_halved_after_failures_down_to_the_smallest() {
    let time = |smallest: f64| {
        format!(
            "end = 1.0\nstep = 1.0\nautomatic = {{ initial = 1.0, smallest = {smallest:?} }}\n[solver]\nmax_iterations = 5"
        )
    };
    let mut chosen = simulation(&twisted(&time(0.01)));
    let steps = run(&mut chosen);
    let cuts: Vec<&Decision> = chosen.decisions().iter().filter(|d| d.kind == DecisionKind::Cut).collect();
    assert!(!cuts.is_empty() && cuts.iter().all(|d| !d.reason.is_empty()));
    assert!(steps.iter().all(|dt| *dt >= 0.01 && *dt < 1.0), "{steps:?}");
    let error = simulation(&twisted(&time(0.6))).advance();
    assert!(matches!(error, Err(SimulationError::StepFailed { .. })), "{error:?}");
    let mut fixed = simulation(&twisted("end = 1.0\nstep = 0.05"));
    run(&mut fixed);
    assert!(distance(&chosen.state().q, &fixed.state().q) < 1e-8);
}

/// A bar of the side `L` that is stretched steadily loses the `fraction` of its strain energy.
#[test]
fn the_fraction_of_stabilisation_is_what_a_stretched_bar_loses() {
    let fraction = 3e-4;
    let rest = r#"
[[body]]
name = "bar"
mesh = { generator = "block", min = [0, 0, 0], max = [3, 0.2, 0.2], divisions = [10, 1, 1] }
material = { law = "saint-venant-kirchhoff", young = 700.0, poisson = 0.0 }
[[prescribe]]
set = "bar.all"
components = ["y", "z"]
fixed = true
[[prescribe]]
set = "bar.left"
components = ["x"]
fixed = true
[[prescribe]]
set = "bar.right"
components = ["x"]
displacement = { table = [[0, 0], [2, 3e-5]] }
"#;
    let time = format!("end = 2.0\nstep = 0.01\nstabilise = {{ fraction = {fraction:?} }}");
    let mut stabilised = simulation(&scene(&time, rest));
    let first = stabilised.balance().total();
    let mut worst = 0.0_f64;
    while !stabilised.finished() {
        let balance = stabilised.advance().unwrap().balance;
        worst = worst.max((balance.total() - first).abs());
    }
    let balance = stabilised.balance();
    let got = balance.stabilisation / balance.strain;
    // The force begins with a jump, of which the first of 200 steps sees half; masses are lumped on ten elements.
    assert!((got / fraction - 1.0).abs() < 0.015, "{got:e}");
    // The strains are 1e-5: what is not linear in the stress is that part of the energy.
    assert!(worst < 2e-5 * balance.strain, "{worst:e} of {:e}", balance.strain);
    assert!(stabilised.decisions().iter().all(|d| d.kind != DecisionKind::Warning));
    let mut plain = simulation(&scene("end = 2.0\nstep = 1.0", rest));
    run(&mut plain);
    assert!(distance(&plain.state().q, &stabilised.state().q) < 1e-12);
    assert_eq!(plain.balance().stabilisation, 0.0);
}

/// A body that nothing but its stabilisation holds: all work of the load goes there, in every step.
#[test]
fn the_work_of_a_load_on_a_free_body_goes_into_the_stabilisation() {
    let rest = r#"
[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 2, 1], divisions = [1, 2, 1] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[load]]
body = "block"
body_force = { table = [[0, 0, 0, 0], [1, 0.3, 0.0, 0.1]] }
"#;
    let mut free = simulation(&scene("end = 1.0\nstep = 0.05\nstabilise = { coefficient = 2.0 }", rest));
    let mut speed = [0.0; 3];
    for n in 1..=15 {
        let balance = free.advance().unwrap().balance;
        assert!(balance.total().abs() < 1e-13 * balance.stabilisation, "{:e}", balance.total());
        // c r v = b
        let (t, v) = (0.05 * f64::from(n), &free.state().v);
        speed = [0.3 * t / (2.0 * (1.0 - t)), 0.0, 0.1 * t / (2.0 * (1.0 - t))];
        for (k, v) in v.iter().enumerate() {
            assert!((v - speed[k % 3]).abs() < 1e-9, "{v} {speed:?}");
        }
    }
    assert!(speed[0] > 0.4 && free.balance().stabilisation > 0.01);
}

/// A block that has to close a gap before anything carries its load.
fn gap(gap: f64, time: &str) -> String {
    let rest = format!(
        r#"
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }}
position = [0, 0, {gap:?}]
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "ground"
mesh = {{ generator = "block", min = [-1, -1, -1], max = [2, 2, 0], divisions = [3, 3, 1] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
{SYMMETRY}
[[prescribe]]
set = "ground.all"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "block.top"
pressure = {{ table = [[0, 0], [1, 50.0]] }}
[[contact]]
method = "nts"
slave = "block.bottom"
master = "ground.top"
"#
    );
    scene(time, &rest)
}

/// The state that contact and the load have together is found with stabilisation, and without it by springs that vanish inside the step.
#[test]
fn a_load_closes_a_gap_first() {
    let steps = "end = 1.0\nstep = 0.05\n";
    let mut alone = simulation(&gap(0.03, steps));
    run(&mut alone);
    assert!(alone.decisions().iter().any(|decision| decision.kind == DecisionKind::Smoothed));
    let mut closed = simulation(&gap(0.03, &format!("{steps}stabilise = {{ fraction = 1e-2 }}")));
    run(&mut closed);
    let text = gap(0.03, &format!("{steps}stabilise = {{ fraction = 1e-2 }}"));
    let (mut first, mut resumed) = (simulation(&text), simulation(&text));
    for _ in 0..6 {
        first.advance().unwrap();
    }
    resumed.restore(first.checkpoint("t", Default::default()), "t").unwrap();
    run(&mut resumed);
    assert!(resumed.state().q == closed.state().q && resumed.balance() == closed.balance());
    // Where nothing has to be closed no stabilisation is needed.
    let mut touching = simulation(&gap(0.0, steps));
    run(&mut touching);
    assert!(touching.balance().strain > 0.1);
    assert!(distance(&closed.state().q, &touching.state().q) < 1e-9);
    assert!(distance(&alone.state().q, &touching.state().q) < 1e-9);
    assert!((closed.balance().strain / touching.balance().strain - 1.0).abs() < 1e-9);
    let told = |d: &&Decision| d.kind == DecisionKind::Warning && d.reason.contains("stabilisation has dissipated");
    assert_eq!(closed.decisions().iter().filter(told).count(), 1);
}

/// Half of an arch of two straight bars with hinges at its foot and at its apex, where `drive` acts.
fn arch(time: &str, drive: &str) -> String {
    let rest = format!(
        r#"
[[body]]
name = "bar"
material = {{ law = "saint-venant-kirchhoff", young = 1000.0, poisson = 0.0 }}
[body.mesh]
generator = "hexahedron"
divisions = [4, 1, 1]
corners = [
    [0, 0, 0], [1, 0, 0.2], [1, 0.05, 0.2], [0, 0.05, 0],
    [0, 0, 0.05], [1, 0, 0.25], [1, 0.05, 0.25], [0, 0.05, 0.05],
]
[[prescribe]]
set = "bar.all"
components = ["y"]
fixed = true
[[set]]
name = "bar.foot"
body = "bar"
box = {{ min = [-0.01, -1, -0.01], max = [0.01, 1, 0.01] }}
[[set]]
name = "bar.tip"
body = "bar"
box = {{ min = [0.99, -1, 0.19], max = [1.01, 1, 0.21] }}
[[prescribe]]
set = "bar.foot"
components = ["x", "z"]
fixed = true
[[prescribe]]
set = "bar.tip"
components = ["x"]
fixed = true
{drive}
"#
    );
    scene(time, &rest)
}

/// Apex and what drives it: deflection, and force of the supports along z there.
fn apex(simulation: &Simulation) -> [f64; 2] {
    let reference = &simulation.model().reference;
    let tip = |n: &usize| reference[3 * n] == 1.0 && (reference[3 * n + 2] - 0.2).abs() < 1e-9;
    let nodes: Vec<usize> = (0..reference.len() / 3).filter(tip).collect();
    let force = nodes.iter().map(|n| simulation.reactions()[3 * n + 2]).sum();
    [simulation.state().q[3 * nodes[0] + 2] - reference[3 * nodes[0] + 2], force]
}

#[test]
fn an_arch_snaps_through_under_a_load_that_it_cannot_carry() {
    let load = 0.015;
    let push =
        format!("[[load]]\nset = \"bar.tip\"\nforce = {{ table = [[0, 0, 0, 0], [1, 0, 0, {:?}]] }}", -0.5 * load);
    let time =
        "end = 1.0\nstep = 0.1\nautomatic = { initial = 0.02, smallest = 1e-4 }\nstabilise = { fraction = 2e-4 }";
    let mut snapped = simulation(&arch(time, &push));
    run(&mut snapped);
    let [deflection, _] = apex(&snapped);
    assert!(deflection < -0.4, "it did not snap through: {deflection}");
    assert!(snapped.balance().stabilisation > 0.0);
    // The same equilibrium, reached by a motion of the apex along which every state is stable: it needs that force.
    let drive = format!(
        "[[prescribe]]\nset = \"bar.tip\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0, 0], [1, {deflection:?}]] }}"
    );
    let mut driven = simulation(&arch("end = 1.0\nstep = 0.05", &drive));
    let mut least = 0.0_f64;
    while !driven.finished() {
        driven.advance().unwrap();
        least = least.max(apex(&driven)[1]);
    }
    let [_, force] = apex(&driven);
    assert!((force + load).abs() < 1e-6 * load, "{force} against {load}");
    // On the way there the arch pushed back: that path has a jump under a given load.
    assert!(least > 0.0, "{least}");
}
