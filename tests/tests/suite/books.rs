//! Books of the energy by term: they close for any set of terms, and say who loses energy.

use crate::support::simulation;
use proptest::prelude::*;
use stoss::solver::{Books, Simulation, StepRecord};

fn shipped(name: &str) -> Simulation {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name).with_extension("toml");
    simulation(&std::fs::read_to_string(path).unwrap())
}

/// Runs some steps, and in each compares what all terms lost together with what the balance lacks; the difference is the residual of the equations over the step's motion.
fn closes(name: &str, mut run: Simulation, steps: usize, bound: f64, mut look: impl FnMut(&StepRecord, f64)) -> Books {
    let mut worst = 0.0_f64;
    for _ in 0..steps {
        let before = *run.balance();
        let record = run.advance().unwrap_or_else(|e| panic!("{name}: {e}"));
        let after = record.balance;
        let lost: f64 = record.books.iter().map(|posting| posting.remainder).sum();
        let lacks = before.total() - after.total() - (after.impact_loss - before.impact_loss);
        let scale = after.largest_energy + after.external_work.abs();
        worst = worst.max((lost - lacks).abs() / scale);
        look(&record, scale);
    }
    assert!(worst < bound, "{name}: {worst:e}");
    run.books().clone()
}

/// Contact that closes, friction, general contact, joints and beams, moving supports, loads that vary, impacts: always the remainders together are the change of the total.
#[test]
fn books_close_in_shipped_scenes() {
    for (name, steps) in [
        ("ball-plate", 20),
        ("ball-plate-midpoint", 12),
        ("resting-block", 20),
        ("two-blocks-friction", 40),
        ("block-impact-mortar", 12),
        ("general-contact", 30),
        ("general-chain", 10),
        ("trebuchet", 20),
        ("slide", 10),
        ("flight", 20),
        ("block-impact", 20),
    ] {
        closes(name, shipped(name), steps, 1e-9, |_, _| {});
    }
}

/// Under the energy-momentum scheme solids lose nothing, and the contact what closing gaps cost: the drift of the total energy is the contact's alone.
#[test]
fn the_drift_of_an_impact_is_the_contact_s() {
    let mut lost = 0.0;
    let books = closes("ball-plate", shipped("ball-plate"), 30, 1e-9, |record, scale| {
        let books = &record.books;
        for posting in books.bodies.iter().chain([&books.inertia]) {
            assert!(posting.remainder.abs() < 1e-12 * scale, "{}: {:e}", record.step, posting.remainder);
        }
        lost = record.balance.closing_loss;
    });
    let of_contact = books.couplings[0].remainder;
    assert!(lost > 1e-4 && (of_contact / lost - 1.0).abs() < 1e-9, "{of_contact:e} {lost:e}");
}

/// Backward Euler takes energy of a body that flies and vibrates, in the solid and by inertia: both shares are positive, and together the whole loss.
#[test]
fn backward_euler_loses_in_the_solid_and_by_inertia() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/flight.toml");
    let text = std::fs::read_to_string(path).unwrap().replacen("\"energy-momentum\"", "\"backward-euler\"", 1);
    let run = simulation(&text);
    let start = run.balance().total();
    let mut end = start;
    let books = closes("flight", run, 30, 1e-9, |record, _| end = record.balance.total());
    let [solid, inertia] = [books.bodies[0].remainder, books.inertia.remainder];
    assert!(solid > 0.0 && inertia > 0.0, "{solid} {inertia}");
    assert!(((solid + inertia) / (start - end) - 1.0).abs() < 1e-6, "{solid} {inertia} {}", start - end);
}

/// In statics nothing is measured.
#[test]
fn statics_has_no_remainders() {
    let mut run = shipped("patch-mortar");
    let record = run.advance().unwrap();
    assert!(record.books.bodies.iter().all(|posting| posting.remainder.is_nan() && posting.stored > 0.0));
}

/// Terms that may or may not be there.
const POOL: [&str; 7] = [
    "[gravity]\nacceleration = [0, 0, -1]\n",
    "[[load]]\nset = \"block.top\"\nfollower_pressure = { table = [[0, 0], [1, 50]] }\n",
    "[[load]]\nset = \"block.right\"\ntraction = { table = [[0, 0, 0, 0], [1, 30, 0, 10]] }\n",
    "[[spring]]\nname = \"spring\"\nbetween = [\"ball\", \"ground\"]\nat = [[0, 0, 1.31], [-2, 0, 0.5]]\nstiffness = 40.0\nrest_length = 1.0\ndamping = 3.0\n",
    "[[prescribe]]\nset = \"block.bottom\"\ncomponents = [\"z\"]\ndisplacement = { table = [[0, 0], [0.05, 0.01], [1, 0]] }\n",
    "[general_contact]\nfriction = 0.2\n",
    "damping = { mass = 0.1, stiffness = 0.002 }\n",
];

/// What stands on the block and falls on it.
const BALL: &str = "[[rigid]]\nname = \"ball\"\nshape = { kind = \"sphere\", radius = 0.3, divisions = 2 }\ndensity = 1.0\nposition = [0, 0, 1.31]\nvelocity = [0, 0.2, -1.0]\n";

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// For any set of terms the books close, and with the energy-momentum scheme what has an energy loses nothing.
    #[test]
    fn books_close_for_any_set_of_terms(chosen in prop::collection::vec(any::<bool>(), POOL.len()), euler in any::<bool>()) {
        let scheme = if euler { "backward-euler" } else { "energy-momentum" };
        let has = |k: usize| if chosen[k] { POOL[k] } else { "" };
        let text = format!(
            "[scene]\ntitle = \"pool\"\nkind = \"dynamic\"\n[time]\nend = 1.0\nstep = 0.01\nintegrator = {{ scheme = \"{scheme}\" }}\n\
             [[body]]\nname = \"block\"\nmesh = {{ generator = \"block\", min = [-0.5, -0.5, 0], max = [0.5, 0.5, 1], divisions = [2, 2, 2] }}\n\
             material = {{ law = \"neo-hooke\", lambda = 400.0, mu = 300.0 }}\ndensity = 1.0\nvelocity = [0.1, 0, 0]\n{}{BALL}{}",
            has(6),
            (0..6).map(has).collect::<String>(),
        );
        closes(&text, simulation(&text), 8, 1e-9, |record, scale| {
            let books = &record.books;
            let exact = books.bodies.iter().chain(&books.parts).chain([&books.inertia]).filter(|_| !euler);
            for posting in exact {
                assert!(posting.remainder.abs() < 1e-11 * scale, "{posting:?}\n{text}");
            }
        });
    }
}
