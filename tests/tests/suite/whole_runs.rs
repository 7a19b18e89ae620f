//! Whole small runs of random scenes: the energy-momentum scheme keeps both momenta and, but for what closing gaps and friction take, the energy.

use crate::support::simulation;
use proptest::prelude::*;

/// Two blocks that meet, not aligned, of different stiffness.
#[derive(Clone, Debug)]
struct Scene {
    ratio: f64,
    divisions: [[usize; 3]; 2],
    turn: f64,
    shift: [f64; 2],
    gap: f64,
    velocity: [f64; 3],
    contact: String,
}

impl Scene {
    fn text(&self) -> String {
        let Self { ratio, divisions: [upper, lower], turn, shift: [x, y], gap, velocity, contact } = self;
        let height = 1.0 + gap;
        format!(
            r#"
[scene]
title = "random"
kind = "dynamic"
[time]
end = 1.5
step = 0.05
integrator = {{ scheme = "energy-momentum" }}
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [-0.5, -0.5, 0.0], max = [0.5, 0.5, 1.0], divisions = {upper:?} }}
rotation = {{ axis = [0, 0, 1], degrees = {turn:?} }}
position = [{x:?}, {y:?}, {height:?}]
material = {{ law = "neo-hooke", young = 100.0, poisson = 0.3 }}
density = 1.0
velocity = {velocity:?}
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [-1.0, -1.0, 0.0], max = [1.0, 1.0, 1.0], divisions = {lower:?} }}
material = {{ law = "neo-hooke", young = {:?}, poisson = 0.3 }}
density = 1.0
[[contact]]
slave = "upper.bottom"
master = "lower.top"
{contact}
"#,
            100.0 * ratio
        )
    }
}

fn scenes() -> impl Strategy<Value = Scene> {
    let divisions = || [1..3_usize, 1..3, 1..3];
    let contacts = prop::sample::select(vec![
        "method = \"nts\"",
        "method = \"nts\"\nconstraint = \"modified\"",
        "method = \"nts\"\nfriction = { law = \"coulomb\", mu = 0.4 }",
        "method = \"mortar\"",
        "method = \"mortar\"\nintegrals = \"frozen\"",
        "method = \"mortar\"\nmultipliers = \"dual\"",
        "method = \"nts\"\ngap = \"close\"",
        "method = \"nts\"\nclosing = \"keep\"",
        "method = \"mortar\"\ngap = \"close\"",
        "method = \"mortar\"\nclosing = \"keep\"",
        "method = \"mortar\"\nfriction = { law = \"coulomb\", mu = 0.4 }",
    ]);
    (
        -1.0..1.0_f64,
        [divisions(), divisions()],
        -40.0..40.0_f64,
        [-0.3..0.3_f64, -0.3..0.3],
        prop_oneof![Just(0.0), 0.0..0.1_f64],
        [-0.5..0.5_f64, -0.5..0.5, -1.5..-0.2],
        contacts,
    )
        .prop_map(|(decades, divisions, turn, shift, gap, velocity, contact)| Scene {
            ratio: 10.0_f64.powf(decades),
            divisions,
            turn,
            shift,
            gap,
            velocity,
            contact: contact.to_owned(),
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn momenta_and_energy_are_kept(scene in scenes()) {
        let mut run = simulation(&scene.text());
        let first = *run.balance();
        // Of a body of mass one that moves as fast as the upper one does.
        let speed = scene.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        let energy = first.kinetic;
        let (mut touched, mut last) = (false, first);
        while !run.finished() {
            let record = run.advance().map_err(|error| TestCaseError::fail(error.to_string()))?;
            touched |= record.contact.as_ref().is_some_and(|contact| contact.active > 0);
            let now = record.balance;
            for i in 0..3 {
                let linear = (now.linear_momentum[i] - first.linear_momentum[i]).abs() / speed;
                let angular = (now.angular_momentum[i] - first.angular_momentum[i]).abs() / speed;
                prop_assert!(linear < 1e-11 && angular < 1e-11, "step {}: {linear:e} {angular:e}", record.step);
            }
            let change = (now.total() + now.closing_loss + now.impact_loss - first.total()).abs() / energy;
            prop_assert!(change < 1e-11, "step {}: energy {change:e}", record.step);
            prop_assert!(now.dissipation >= 0.0);
            // Closing gaps cost what the constraints say, and the law of impact only takes.
            prop_assert!(now.contact_remainder.abs() < 1e-11 * energy, "step {}: {:e}", record.step, now.contact_remainder);
            prop_assert!(now.impact_loss >= last.impact_loss - 1e-12 * energy, "step {}", record.step);
            prop_assert!(now.impact_loss == 0.0 || !scene.contact.contains("keep"));
            last = now;
        }
        prop_assert!(touched, "the blocks never met");
    }
}
