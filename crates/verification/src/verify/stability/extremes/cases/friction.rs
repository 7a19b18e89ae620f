//! Friction: coefficients over two decades with stick by multipliers, tangential stiffnesses over many decades, slides over many facets in a step, and stick and slip that
//! alternate from step to step.

use super::super::case::{Case, Oracle, Touch, Word};
use super::super::evidence::Evidence;
use super::super::scene::{Block, Matter, Scene};
use crate::workspace::Outcome;

/// Schemes that admit friction.
const SCHEMES: [&str; 4] = ["energy-momentum", "midpoint", "generalised-alpha", "backward-euler"];

/// Those that admit friction of the mortar method.
const MORTAR: [&str; 3] = ["energy-momentum", "midpoint", "backward-euler"];

const GRAVITY: f64 = 10.0;

/// Coefficient of the blocks on a plate.
const MU: f64 = 0.3;

/// A cube that hits a larger block and slides on it; the meshes do not match.
fn oblique(family: &str, scheme: &'static str, friction: &str) -> Case {
    let matter = Matter::new(1e3, 1.0);
    let lower = Block { min: [-1.0, -1.0, -1.0], max: [1.0, 1.0, 0.0], divisions: [3, 3, 1] };
    let upper = Block { min: [-0.5, -0.5, 0.01], max: [0.5, 0.5, 1.01], divisions: [2, 2, 2] };
    let scene = Scene::new(Some(scheme), 0.004, 30, 10)
        .block("lower", lower, matter, [0.0; 3])
        .block("upper", upper, matter, [1.0, 0.5, -1.0])
        .contact("upper.bottom", "lower.top", "standard")
        .also(&format!("friction = {{ law = \"coulomb\", {friction} }}\n"));
    Case::contact(family, (scheme, "standard"), scene, Touch::UPPER)
}

/// A block that lies on a fixed plate of facets with a length along x; the contact is to be added.
fn on_plate(scheme: &str, [step, edge]: [f64; 2], steps: u32, speed: f64, travel: f64, force: &str) -> Scene {
    let length = (2.0 + travel).ceil();
    let plate = Block {
        min: [-1.0, -1.0, -1.0],
        max: [length, 2.0, 0.0],
        divisions: [((length + 1.0) / edge).round() as u32, 3, 1],
    };
    let block = Block { min: [0.0, 0.0, 0.0], max: [1.0, 1.0, 0.5], divisions: [2, 2, 1] };
    let matter = Matter::new(1e5, 1.0);
    Scene::new(Some(scheme), step, steps, 10)
        .block("lower", plate, matter, [0.0; 3])
        .block("upper", block, matter, [speed, 0.0, 0.0])
        .fixed("lower.bottom", &["x", "y", "z"])
        .fixed("lower.top", &["x", "y", "z"])
        .also(&format!("\n[[load]]\nbody = \"upper\"\nbody_force = {force}\n"))
}

/// Friction of the contact before.
fn friction() -> String {
    format!("friction = {{ law = \"coulomb\", mu = {MU} }}\n")
}

/// A supported case against a closed form.
fn supported(family: &str, scheme: &'static str, scene: Scene, oracle: Oracle) -> Case {
    Case { free: false, touch: Some(Touch::UPPER), ..Case::new(family, Some(scheme), scene, oracle) }
}

/// Over so many facets in the first step; friction takes `mu g t` from the speed until the block rests.
fn slide(scheme: &'static str, facets: f64, mortar: bool) -> Case {
    const STEP: f64 = 0.02;
    const STEPS: u32 = 6;
    const EDGE: f64 = 0.1;
    let (speed, time) = (facets * EDGE / STEP, STEP * f64::from(STEPS));
    let scene = on_plate(scheme, [STEP, EDGE], STEPS, speed, speed * time, &format!("[0.0, 0.0, {:?}]", -GRAVITY));
    let [slave, master] = ["upper.bottom", "lower.top"];
    let (family, scene) = if mortar {
        ("mortar: slide over facets in a step", scene.mortar(slave, master))
    } else {
        ("slide over facets in a step", scene.contact(slave, master, "standard"))
    };
    let scene = scene.also(&friction()).probe("block", "upper.all", "velocity");
    let lost = (MU * GRAVITY * time).min(speed);
    let error =
        move |evidence: &Evidence| -> Outcome<f64> { Ok(((speed - evidence.probe("block.x")?) / lost - 1.0).abs()) };
    let about = "lost speed against mu g t, relative error";
    let oracle = Oracle::Closed { about, error: Box::new(error), bound: 1e-2, otherwise: Word::Drifts };
    supported(family, scheme, scene, oracle).named(format!("{scheme} {facets} facets"))
}

/// In every other step the load is twice the bound of friction, and the block slides; in the steps between it is half of it backwards,
/// and the block comes to rest.
///
/// A rigid block gains `mu g h` in a step, stops after 2/3 of the next one, and is then `mu g h^2 (1/2 + 1/3)` farther.
fn stick_and_slip(scheme: &'static str) -> Case {
    const STEP: f64 = 0.02;
    const CYCLES: u32 = 10;
    // The first cycle lets the block settle.
    let bound = MU * GRAVITY;
    let row = |time: f64, value: f64| format!("[{time:?}, {value:?}, 0.0, {:?}]", -GRAVITY);
    let mut table = vec![row(0.0, 0.0)];
    for cycle in 1..=CYCLES {
        let start = 2.0 * STEP * f64::from(cycle);
        let before = if cycle == 1 { 0.0 } else { -0.5 * bound };
        // Schemes evaluate loads at the end or in the middle of the step: the jump is just behind the end of the last one.
        for (time, value) in [
            (start + 0.01 * STEP, before),
            (start + 0.02 * STEP, 2.0 * bound),
            (start + 1.01 * STEP, 2.0 * bound),
            (start + 1.02 * STEP, -0.5 * bound),
        ] {
            table.push(row(time, value));
        }
    }
    let force = format!("{{ table = [{}] }}", table.join(", "));
    let scene = on_plate(scheme, [STEP, 1.0], 2 * (CYCLES + 1), 0.0, 1.0, &force)
        .contact("upper.bottom", "lower.top", "standard")
        .also(&friction())
        .probe("block", "upper.all", "displacement");
    let expected = f64::from(CYCLES) * bound * STEP * STEP * (0.5 + 1.0 / 3.0);
    let error = move |evidence: &Evidence| -> Outcome<f64> { Ok((evidence.probe("block.x")? / expected - 1.0).abs()) };
    // One step slips, one sticks: backward Euler goes h^2 mu g in the first and nothing in the second, a fifth too far.
    let about =
        "displacement against that of a rigid block, relative error; one step for each motion resolves it to a fifth";
    let oracle = Oracle::Closed { about, error: Box::new(error), bound: 0.25, otherwise: Word::Drifts };
    supported("stick and slip in turn at each step", scheme, scene, oracle)
}

/// All of them; quick mode takes the first of each family.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for scheme in SCHEMES {
        for mu in ["10", "3", "1", "0.3", "0.1", "0"] {
            let case = oblique("friction, coefficient", scheme, &format!("mu = {mu}"));
            cases.push(case.named(format!("{scheme} mu {mu}")));
        }
        for penalty in ["1e7", "1e6", "1e5", "1e4", "1e3", "1e2", "1e1"] {
            let case = oblique("friction, stiffness", scheme, &format!("mu = 0.3, penalty = {penalty}"));
            cases.push(case.named(format!("{scheme} penalty {penalty}")));
        }
        for facets in [10.0, 100.0, 1.0] {
            cases.push(slide(scheme, facets, false));
            if MORTAR.contains(&scheme) {
                cases.push(slide(scheme, facets, true));
            }
        }
        cases.push(stick_and_slip(scheme));
    }
    cases
}
