//! General contact does not ask for sizes of facets, numbers of steps, or what bodies do that are far away.

use crate::support::simulation;
use stoss::solver::Simulation;

fn block(name: &str, min: [f64; 3], max: [f64; 3], divisions: [u32; 3], more: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {min:?}, max = {max:?}, divisions = {divisions:?} }}\n\
         material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\ndensity = 1.0\n{more}"
    )
}

fn statics(end: f64, step: f64) -> String {
    format!("[scene]\ntitle = \"sizes\"\nkind = \"quasi-static\"\n[time]\nend = {end:?}\nstep = {step:?}\n")
}

/// A block compressed by 2 % on a rigid plane of one facet: force, area and largest pressure.
fn pressed(size: f64) -> [f64; 3] {
    let text = statics(1.0, 0.2)
        + &block("s", [-0.37, -0.41, 0.0], [0.63, 0.59, 1.0], [4, 4, 4], "")
        + &format!(
            "[[rigid]]\nname = \"floor\"\nshape = {{ kind = \"plane\", size = [{size:?}, {size:?}], divisions = [1, 1] }}\nfixed = true\n"
        )
        + "[[prescribe]]\nset = \"s.top\"\ncomponents = [\"z\"]\ndisplacement = { table = [[0, 0], [1, -0.02]] }\n\
           [[prescribe]]\nset = \"s.top & x < -0.36 & y < -0.40 & z > 0.99\"\ncomponents = [\"x\", \"y\"]\nfixed = true\n\
           [[prescribe]]\nset = \"s.top & x > 0.62 & y < -0.40 & z > 0.99\"\ncomponents = [\"y\"]\nfixed = true\n";
    let mut run = simulation(&text);
    let mut seen = [0.0; 3];
    while !run.finished() {
        let contact = run.advance().unwrap_or_else(|e| panic!("{size}: {e}")).contact.unwrap();
        let [pair] = &contact.bodies[..] else { panic!("one pair") };
        seen = [pair.force[2].abs(), pair.area, pair.pressure];
    }
    seen
}

#[test]
fn a_block_feels_the_same_plane_whatever_its_size() {
    let small = pressed(2.0);
    // The force of a uniform strain of 0.02, without inset and layer.
    assert!((small[0] / 20.316 - 1.0).abs() < 1e-3 && (small[1] - 1.0).abs() < 1e-12, "{small:?}");
    for size in [40.0, 1000.0] {
        let large = pressed(size);
        for k in 0..3 {
            assert!((large[k] / small[k] - 1.0).abs() < 1e-6, "{size}: {large:?} {small:?}");
        }
    }
}

/// A block that is pressed on a plate by 4 % and then dragged.
fn dragged(step: f64) -> Simulation {
    let held = "components = [\"x\", \"y\", \"z\"]\n";
    let text = statics(2.0, step)
        + &block("plate", [-1.0, -1.0, -1.0], [4.0, 2.0, 0.0], [5, 3, 1], "")
        + &block("s", [0.0, 0.0, 0.0], [1.0, 1.0, 0.5], [2, 2, 1], "")
        + &format!("[[prescribe]]\nset = \"plate.bottom\"\n{held}fixed = true\n")
        + &format!("[[prescribe]]\nset = \"plate.top\"\n{held}fixed = true\n")
        + &format!(
            "[[prescribe]]\nset = \"s.top\"\n{held}displacement = {{ table = [[0, 0, 0, 0], [1, 0, 0, -0.02], [2, 0.1, 0, -0.02]] }}\n"
        )
        + "[general_contact]\nfriction = 0.3\n";
    simulation(&text)
}

#[test]
fn static_friction_does_not_fade_with_the_number_of_steps() {
    let mut ratios = Vec::new();
    for step in [0.1, 0.05, 0.002] {
        let mut run = dragged(step);
        let mut ratio = 0.0;
        while !run.finished() {
            let before = run.balance().dissipation;
            let record = run.advance().unwrap_or_else(|e| panic!("{step}: {e}"));
            let [pair] = &record.contact.unwrap().bodies[..] else { panic!("one pair") };
            ratio = (pair.force[0] / pair.force[2]).abs();
            let balance = record.balance;
            assert!(balance.dissipation >= before - 1e-12, "{step}: {} {before}", balance.dissipation);
            let work = balance.friction_stored + balance.dissipation;
            assert!((balance.friction_work - work).abs() <= 1e-10 * work, "{step}: {balance:?}");
        }
        assert!(
            run.balance().friction_stored > 0.0 && run.balance().dissipation > 20.0 * run.balance().friction_stored
        );
        ratios.push(ratio);
    }
    // Coulomb's, whatever the steps.
    assert!(
        ratios.iter().all(|ratio| (ratio / ratios[0] - 1.0).abs() < 2e-3 && (ratio - 0.3).abs() < 1e-3),
        "{ratios:?}"
    );
}

/// What springs of friction hold is in the checkpoint.
#[test]
fn static_friction_goes_on_with_the_same_bits() {
    let (mut straight, mut resumed) = (dragged(0.05), dragged(0.05));
    while straight.state().time < 1.22 {
        straight.advance().unwrap();
    }
    resumed.restore(straight.checkpoint("t", Default::default()), "t").unwrap();
    while !straight.finished() {
        straight.advance().unwrap();
        resumed.advance().unwrap();
    }
    assert!(straight.state().q == resumed.state().q && straight.balance() == resumed.balance());
}

/// What slides stays slower by friction in any inertial frame, and whatever flies past.
#[test]
fn sliding_is_the_same_in_any_inertial_frame() {
    let slid = |common: f64, with_third: bool| {
        let at = |v: [f64; 3]| format!("velocity = {:?}\n", [v[0], v[1] + common, v[2]]);
        let mut text = "[scene]\ntitle = \"sizes\"\nkind = \"dynamic\"\n[time]\nend = 0.2\nstep = 0.01\nintegrator = { scheme = \"energy-momentum\" }\n".to_owned()
            + &block("plate", [-1.0, -1.0, -1.0], [4.0, 2.0, 0.0], [5, 3, 1], &at([0.0; 3]))
            + &block("s", [0.0, 0.0, 0.01], [1.0, 1.0, 0.51], [2, 2, 1], &at([0.5, 0.0, -0.2]))
            + "[general_contact]\nfriction = 0.3\n";
        if with_third {
            text += &block("c", [500.0, 50.0, 50.0], [501.0, 51.0, 51.0], [1, 1, 1], &at([2000.0, 0.0, 0.0]));
        }
        let mut run = simulation(&text);
        while !run.finished() {
            run.advance().unwrap();
        }
        run.balance().dissipation
    };
    let lost = slid(0.0, false);
    assert!(lost > 0.01, "{lost}");
    for (common, with_third) in [(100.0, false), (0.0, true)] {
        let other = slid(common, with_third);
        // With a larger reach of the search a contact that comes into the layer knows more of the triangles that it came from, which turns its force a little in that step.
        assert!((other / lost - 1.0).abs() < 5e-4, "{common} {with_third}: {other} {lost}");
    }
}
