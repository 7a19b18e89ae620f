//! Impacts of bodies that do not touch: each is as if it were alone (theory/impacts#groups).

use crate::impacts::{FLOOR, contact, head, rigid, run};
use crate::support::simulation;

/// Bodies far apart that land in the same step do not know of each other: one box, a box with another restitution, two boxes on a hinge, and a box that slides there.
#[test]
fn bodies_that_do_not_touch_land_as_each_alone() {
    let (dt, floor) = (0.01, FLOOR.replace("[10, 10]", "[400, 10]"));
    let landing = |phase: f64| 0.5 + (3.0 + phase) * dt + 0.5 * ((3.0 + phase) * dt).powi(2);
    let on_floor = |name: &str, e: f64, more: &str| {
        let more = format!("method = \"nts\"\nrestitution = {e:?}\n{more}");
        contact(&format!("{name}.bottom"), "floor.all", &more)
    };
    let falling =
        |name: &str, x: f64, phase: f64| rigid(name, [1.0; 3], [x, 0.0, landing(phase)], "velocity = [0, 0, -1]\n");
    let joint = "[[joint]]\nname = \"hinge\"\nkind = \"hinge\"\nbetween = [\"c\", \"d\"]\nat = [101, 0, 0.5]\naxis = [0, 1, 0]\n";
    // A list each of the names, and the text.
    let all = [
        (vec!["a"], falling("a", 0.0, 0.1) + &on_floor("a", 1.0, "")),
        (vec!["b"], falling("b", 50.0, 0.9) + &on_floor("b", 0.8, "")),
        (
            vec!["c", "d"],
            falling("c", 100.0, 0.5)
                + &falling("d", 102.0, 0.5)
                + joint
                + &on_floor("c", 1.0, "friction = { law = \"coulomb\", mu = 0.2 }\n"),
        ),
        (vec!["e"], rigid("e", [1.0; 3], [150.0, 0.0, 0.5], "velocity = [1, 0, 0]\n") + &on_floor("e", 1.0, "")),
    ];
    let after = |of: &[usize]| {
        let texts: String = of.iter().map(|&k| all[k].1.as_str()).collect();
        let text = head(0.06, dt) + "[gravity]\nacceleration = [0, 0, -1]\n" + &floor + &texts;
        let mut simulation = simulation(&text);
        let off = run(&mut simulation);
        let impacts = simulation.balance().impacts;
        assert!(off < 1e-12 && impacts >= 4, "{of:?}: {off:e} {impacts}");
        let parts = simulation.model().parts.iter().enumerate();
        let names: Vec<&str> = of.iter().flat_map(|&k| all[k].0.iter().copied()).collect();
        let motions = parts.filter(|(_, part)| names.contains(&part.name())).map(|(k, part)| {
            let state = simulation.state();
            let height = state.q[3 * part.own_vectors().start as usize + 2] - 0.5;
            let v: Vec<f64> =
                part.own_vectors().flat_map(|n| (0..3).map(move |i| 3 * n as usize + i)).map(|c| state.v[c]).collect();
            (simulation.part_balance(k).kinetic + height, v)
        });
        motions.collect::<Vec<(f64, Vec<f64>)>>()
    };
    let alone: Vec<(f64, Vec<f64>)> = (0..all.len()).flat_map(|k| after(&[k])).collect();
    assert!((alone[0].0 / landing(0.1) - 1.0).abs() < 1e-12, "{alone:?}");
    for (of, bodies) in [(vec![0, 1], 0..2), (vec![0, 1, 2, 3], 0..5)] {
        for (now, alone) in after(&of).iter().zip(&alone[bodies]) {
            assert!((now.0 - alone.0).abs() < 1e-12, "{of:?}: {now:?} {alone:?}");
            let off = now.1.iter().zip(&alone.1).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12, "{of:?}: {off:e}");
        }
    }
}
