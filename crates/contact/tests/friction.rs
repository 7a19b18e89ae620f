//! Friction laws and their stepping: derivatives, the cone, dissipation, closed forms.

use proptest::prelude::*;
use std::sync::Arc;
use stoss_contact::friction::{
    Coulomb, Friction, FrictionEntry, FrictionLaw, FrictionPoint, LAWS, Regularised, Sliding, StaticDynamic, Stick,
};

const PENALTY: f64 = 40.0;

/// The largest traction over pressure of a row with the examples as parameters.
fn largest(entry: &FrictionEntry) -> Option<f64> {
    let name = entry.coefficient?;
    entry.law.parameters().find(|p| p.name == name).map(|p| p.example.number())
}

/// Every law of the catalogue.
fn laws() -> Vec<Arc<dyn FrictionLaw>> {
    LAWS.iter().map(|entry| entry.law.of_examples().unwrap()).collect()
}

fn vector(size: f64) -> impl Strategy<Value = [f64; 2]> {
    proptest::array::uniform2(-size..size)
}

fn point() -> impl Strategy<Value = FrictionPoint> {
    (vector(2.0), vector(0.1), -0.5..5.0_f64, 0.01..0.2_f64).prop_map(|(history, slip, pressure, step_size)| {
        FrictionPoint { history, slip, pressure, step_size, slid: 0.3, yielded: [0.0; 2] }
    })
}

fn norm(v: [f64; 2]) -> f64 {
    v[0].hypot(v[1])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn derivatives_of_the_step(point in point(), law in 0..LAWS.len()) {
        let law = Arc::clone(&laws()[law]);
        let friction =
            Friction::new(law, PENALTY, Stick::Penalty).unwrap();
        let step = friction.step(&point);
        const H: f64 = 1e-6;
        let kink = std::cell::Cell::new(false);
        let difference = |change: &dyn Fn(&mut FrictionPoint, f64)| -> [f64; 2] {
            let at = |h: f64| {
                let mut moved = point;
                change(&mut moved, h);
                friction.step(&moved)
            };
            let [ahead, behind, far_ahead, far_behind] = [H, -H, 2.0 * H, -2.0 * H].map(at);
            // The branch may not change between the points.
            let here = at(4.0 * H).sticks != at(-4.0 * H).sticks || point.pressure.abs() < 1e-5;
            kink.set(kink.get() || here);
            // Of fourth order: a slip that has just begun turns its direction quickly.
            std::array::from_fn(|i| {
                (8.0 * (ahead.force[i] - behind.force[i]) - (far_ahead.force[i] - far_behind.force[i])) / (12.0 * H)
            })
        };
        for j in 0..2 {
            let by_history = difference(&|p, h| p.history[j] += h);
            let by_slip = difference(&|p, h| p.slip[j] += h);
            if !kink.get() {
                for i in 0..2 {
                    prop_assert!((by_history[i] - step.d_history[i][j]).abs() < 1e-7);
                    prop_assert!((by_slip[i] - step.d_slip[i][j]).abs() < 1e-7 * PENALTY, "{by_slip:?} {:?}", step.d_slip);
                }
            }
        }
        let by_pressure = difference(&|p, h| p.pressure += h);
        if !kink.get() {
            for i in 0..2 {
                prop_assert!((by_pressure[i] - step.d_pressure[i]).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn a_path_never_gains_energy(
        path in proptest::collection::vec((vector(0.1), -0.5..5.0_f64), 1..30),
        law in 0..LAWS.len(),
    ) {
        let largest = largest(&LAWS[law]);
        let law = Arc::clone(&laws()[law]);
        let friction =
            Friction::new(law, PENALTY, Stick::Penalty).unwrap();
        let mut history = [0.0; 2];
        for (slip, pressure) in path {
            let before = friction.stored(history);
            let step = friction.step(&FrictionPoint { history, slip, pressure, step_size: 0.05, slid: 0.0, yielded: [0.0; 2] });
            let scale = before + step.stored + step.work.abs();
            prop_assert!(step.dissipated >= -1e-15 * scale, "dissipated {:e} of {scale:e}", step.dissipated);
            // What it stands for.
            let rest = step.work + before - step.stored - step.dissipated;
            prop_assert!(rest.abs() <= 1e-14 * (1.0 + scale), "work {:e}, rest {rest:e}", step.work);
            // The force is in the cone.
            if let Some(largest) = largest {
                prop_assert!(norm(step.force) <= largest * pressure.max(0.0) + 1e-13);
            }
            history = step.force;
        }
    }
}

/// Exact stick, as the iteration leaves it: a sticking point dissipates nothing whatever slip round-off made of it, one that slides
/// never less than nothing.
#[test]
fn exact_stick_dissipates_nothing() {
    let friction = Friction::new(Arc::new(Coulomb::new(0.5).unwrap()), 100.0, Stick::Multiplier).unwrap();
    let step = |history: [f64; 2], slip: [f64; 2]| {
        let (step_size, slid, yielded) = (0.1, 0.0, [0.0; 2]);
        friction.step(&FrictionPoint { history, slip, pressure: 4.0, step_size, slid, yielded })
    };
    for slip in [-1e-17, 1e-17, -1e-3, 1e-3] {
        let s = step([1.0, 0.5], [slip, 0.0]);
        assert!(s.sticks && s.dissipated == 0.0 && s.work != 0.0, "{slip}: {s:?}");
    }
    // A slip that round-off turned round.
    let s = step([2.0 + 1e-12, 0.0], [-1e-17, 0.0]);
    assert!(!s.sticks && s.work < 0.0 && s.dissipated == -s.work, "{s:?}");
    // One that did not come from round-off shows.
    let s = step([3.5, 0.0], [-0.01, 0.0]);
    assert!(!s.sticks && (s.dissipated + 0.02).abs() < 1e-17, "{s:?}");
    let s = step([2.0, 0.0], [0.01, 0.0]);
    assert!(!s.sticks && (s.dissipated - 0.02).abs() < 1e-17 && s.dissipated == s.work);
}

/// What the compliance of a multiplier takes of the slip is stored and not dissipated, but for what backward Euler loses.
#[test]
fn a_compliance_takes_its_part_of_the_slip() {
    let friction = Friction::new(Arc::new(Coulomb::new(0.5).unwrap()), 100.0, Stick::Multiplier).unwrap();
    let compliance = 0.1;
    let (start, pressure): (f64, f64) = (1.0, 4.0);
    for (slip, traction) in [(0.0005, 1.5), (0.003, 2.0)] {
        let increment: f64 = traction - start;
        let yielded = [compliance * increment / 100.0, 0.0];
        let history = [start + friction.share(compliance) * increment, 0.0];
        let point = FrictionPoint { history, slip: [slip, 0.0], pressure, step_size: 0.1, slid: 0.0, yielded };
        let s = friction.step(&point);
        assert!((s.force[0] - traction).abs() < 1e-14, "converged: {s:?}");
        let stored = |t: f64| friction.stored_by(compliance, [t, 0.0]);
        let dissipated = s.dissipated + stored(increment);
        let expected = s.work + stored(start) - stored(traction);
        assert!((dissipated - expected).abs() < 1e-16, "{dissipated:e} {expected:e}");
        assert!((s.dissipated - traction * (slip - yielded[0])).abs() < 1e-16);
    }
}

/// A point slides there and back on a line: closed forms of the return mapping (theory/friction#eq-return).
#[test]
fn there_and_back() {
    let friction = Friction::new(Arc::new(Coulomb::new(0.5).unwrap()), 100.0, Stick::Penalty).unwrap();
    let step = |history: f64, slip: f64, pressure| {
        friction.step(&FrictionPoint {
            history: [history, 0.0],
            slip: [slip, 0.0],
            pressure,
            step_size: 1.0,
            slid: 0.0,
            yielded: [0.0; 2],
        })
    };
    // Stick: 100 * 0.01 = 1 < 0.5 * 4; backward Euler takes half of what the traction at the end works.
    let s = step(0.0, 0.01, 4.0);
    assert!(s.sticks && s.force == [1.0, 0.0]);
    assert!((s.work - 0.01).abs() < 1e-17 && (s.stored - 0.005).abs() < 1e-17 && (s.dissipated - 0.005).abs() < 1e-17);
    // On to slip at 2: trial 6.
    let s = step(1.0, 0.05, 4.0);
    assert!(!s.sticks && s.force == [2.0, 0.0]);
    // Unloading while the pressure falls to 2: the trial is 0.
    let s = step(2.0, -0.02, 2.0);
    assert!(s.sticks && s.force == [0.0, 0.0] && s.stored == 0.0 && (s.dissipated - 0.02).abs() < 1e-17);
    // No pressure, no friction.
    assert_eq!(step(1.0, 0.05, -1.0).force, [0.0, 0.0]);
}

#[test]
fn laws_at_known_speeds() {
    let at = |slip: f64| Sliding { pressure: 2.0, slip, step_size: 0.1, slid: 0.0 };
    let law = StaticDynamic::new(0.6, 0.2, 0.5).unwrap();
    assert!((law.coefficient(&at(0.0)).value - 0.6).abs() < 1e-15);
    // Speed 0.5: mu = 0.2 + 0.4 / e.
    assert!((law.coefficient(&at(0.05)).value - (0.2 + 0.4 / 1f64.exp())).abs() < 1e-15);
    assert!((law.coefficient(&at(5.0)).value - 0.2).abs() < 1e-15);
    // A speed of the transition so small that its square is zero.
    let law = StaticDynamic::new(0.6, 0.2, 1e-300).unwrap();
    for slip in [0.0, 1e-301, 1e-200, 1.0] {
        let found = law.coefficient(&Sliding { step_size: 1.0, ..at(slip) });
        assert!(found.value.is_finite() && found.d_slip.is_finite(), "{slip}: {found:?}");
    }
    let law = Regularised::new(0.5, 0.3).unwrap();
    // Speed 0.4: 0.4 / sqrt(0.4^2 + 0.3^2) = 0.8.
    assert!((law.coefficient(&at(0.04)).value - 0.4).abs() < 1e-15);
    assert!(!law.sticks());
}

/// The branch of a law without stick that Newton's method may look along is its tangent at rest.
#[test]
fn the_branch_of_a_smooth_law_is_its_tangent_at_rest() {
    let friction = Friction::new(Arc::new(Regularised::new(0.5, 0.3).unwrap()), 10.0, Stick::Penalty);
    let (friction, step_size) = (friction.unwrap(), 0.1);
    let at = |slip: [f64; 2]| FrictionPoint {
        history: [0.0; 2],
        slip,
        pressure: 2.0,
        step_size,
        slid: 0.0,
        yielded: [0.0; 2],
    };
    // mu p / (speed h), however large the slip.
    let stiffness = 0.5 * 2.0 / (0.3 * step_size);
    for slip in [[1e-9, 0.0], [0.4, -0.3]] {
        let branch = friction.sticking_step(&at(slip));
        for i in 0..2 {
            assert!((branch.force[i] - stiffness * slip[i]).abs() <= 1e-14 * stiffness, "{branch:?}");
            assert!((branch.d_slip[i][i] - stiffness).abs() <= 1e-14 * stiffness && branch.d_slip[i][1 - i] == 0.0);
        }
    }
    let (small, branch) = (friction.step(&at([1e-9, 0.0])), friction.sticking_step(&at([1e-9, 0.0])));
    assert!((small.force[0] / branch.force[0] - 1.0).abs() < 1e-14);
}

/// The slip that is reported is what no spring takes up; a law without stick has no spring, whatever stiffness there is.
#[test]
fn reported_slip_of_springs_and_of_laws_without_stick() {
    let slip_of = |law: Arc<dyn FrictionLaw>, stiffness: f64| {
        let friction = Friction::new(law, stiffness, Stick::Penalty).unwrap();
        let (pressure, step_size, slid) = (2.0, 0.1, 0.0);
        let (history, slip, yielded) = ([0.0; 2], [0.05, -0.02], [0.0; 2]);
        let point = FrictionPoint { history, slip, pressure, step_size, slid, yielded };
        friction.slot_friction(&friction.step(&point), history, slip, [pressure, slid, step_size])
    };
    for stiffness in [1.0, 1e6] {
        let smooth = slip_of(Arc::new(Regularised::new(0.5, 0.3).unwrap()), stiffness);
        assert_eq!(smooth.slip, [0.05, -0.02], "{stiffness}");
        let spring = slip_of(Arc::new(Coulomb::new(0.5).unwrap()), stiffness);
        let left: [f64; 2] = std::array::from_fn(|i| [0.05, -0.02][i] - spring.traction[i] / stiffness);
        assert!(norm([spring.slip[0] - left[0], spring.slip[1] - left[1]]) < 1e-16, "{spring:?} {left:?}");
        assert_eq!(spring.sticks, stiffness == 1.0);
    }
}

#[test]
fn parameters_out_of_range_are_errors() {
    assert!(Coulomb::new(-0.1).is_err() && Coulomb::new(f64::NAN).is_err() && Coulomb::new(0.0).is_ok());
    assert!(StaticDynamic::new(0.2, 0.3, 1.0).is_err() && StaticDynamic::new(0.3, 0.2, 0.0).is_err());
    assert!(Regularised::new(0.3, 0.0).is_err());
    let coulomb = Arc::new(Coulomb::new(0.1).unwrap());
    let error = Friction::new(coulomb, 0.0, Stick::Penalty).unwrap_err();
    assert_eq!(error.to_string(), "friction parameter `penalty` must be positive, but is 0");
}
