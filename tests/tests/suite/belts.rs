//! Belts: master surfaces that move along themselves while their mesh stays (theory/friction#belt).

use crate::support::simulation;
use stoss::solver::Simulation;

const SPEED: f64 = 0.5;
const MU: f64 = 0.2;
const GRAVITY: f64 = 9.81;

fn block(is_rigid: bool) -> &'static str {
    if is_rigid {
        "[[rigid]]\nname = \"block\"\nshape = { kind = \"box\", size = [1, 1, 0.4] }\nposition = [0, 0, 0.2]\ndensity = 2.5\n"
    } else {
        "[[body]]\nname = \"block\"\nmesh = { generator = \"block\", min = [-0.5, -0.5, 0], max = [0.5, 0.5, 0.4], divisions = [2, 2, 1] }\ndensity = 2.5\n\
         material = { law = \"neo-hooke\", young = 1e5, poisson = 0.3 }\ndamping = { stiffness = 0.01 }\n"
    }
}

/// A block of mass one on a belt at rest otherwise.
fn scene(scheme: &str, end: f64, method: &str, is_rigid: bool, velocity: &str) -> String {
    format!(
        "[scene]\ntitle = \"belt\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = 0.005\nintegrator = {{ scheme = \"{scheme}\" }}\n[gravity]\nacceleration = [0, 0, {:?}]\n{}\
         [[rigid]]\nname = \"floor\"\nshape = {{ kind = \"plane\", size = [10, 10] }}\nfixed = true\n\
         [[contact]]\nslave = \"block.bottom\"\nmaster = \"floor.all\"\nmethod = \"{method}\"\nfriction = {{ law = \"coulomb\", mu = {MU:?} }}\nsurface_velocity = {velocity}\n",
        -GRAVITY,
        block(is_rigid)
    )
}

/// Runs to the end; the velocity of the block, of mass one, in the mean of the last step: what sticks alternates from step to step under schemes that dissipate nothing.
fn run(simulation: &mut Simulation) -> [f64; 3] {
    let (mut before, mut last) = ([0.0; 3], [0.0; 3]);
    while !simulation.finished() {
        before = last;
        last = simulation.advance().unwrap_or_else(|e| panic!("{e}")).balance.linear_momentum;
    }
    std::array::from_fn(|i| 0.5 * (before[i] + last[i]))
}

/// `v = mu g t` until the block has the speed of the belt, and then that speed. The belt has supplied `m v^2`: half of it is heat, half the kinetic energy of the block.
#[test]
fn a_block_is_carried_along() {
    for method in ["nts", "mortar"] {
        for is_rigid in [true, false] {
            for scheme in ["energy-momentum", "midpoint", "backward-euler"] {
                let name = format!("{method} {scheme} rigid {is_rigid}");
                let tolerance = if is_rigid { 1e-6 } else { 3e-3 };
                let speed = |end: f64| {
                    let mut simulation = simulation(&scene(scheme, end, method, is_rigid, "[0.5, 0, 3]"));
                    (run(&mut simulation), *simulation.balance())
                };
                let (half, _) = speed(0.125);
                let expected = MU * GRAVITY * (0.125 - 0.0025);
                assert!(
                    (half[0] - expected).abs() < tolerance && half[1].abs() < tolerance,
                    "{name}: {half:?} {expected}"
                );
                let (last, books) = speed(0.4);
                assert!((last[0] - SPEED).abs() < tolerance, "{name}: {last:?}");
                if scheme == "energy-momentum" {
                    let heat = books.dissipation - books.dissipated_in_bodies();
                    assert!((books.external_work - SPEED * SPEED).abs() < 3e-3, "{name}: {books:?}");
                    assert!((heat - 0.5 * SPEED * SPEED).abs() < 3e-3, "{name}: {heat} {books:?}");
                    let rest = books.total() + books.closing_loss + books.impact_loss;
                    assert!(rest.abs() < 1e-9, "{name}: {rest:e} {books:?}");
                }
            }
        }
    }
}

/// A belt that starts slowly carries the block along without sliding: its way is the integral of the velocity.
#[test]
fn a_block_goes_along_with_a_belt_that_starts_slowly() {
    for method in ["nts", "mortar"] {
        let text = scene("energy-momentum", 0.8, method, true, "{ table = [[0, 0, 0, 0], [0.5, 0.3, 0.4, 0]] }");
        let mut simulation = simulation(&text);
        let (v, q) = (run(&mut simulation), &simulation.state().q);
        let way = [0.3, 0.4].map(|v| v * 0.25 + v * 0.3);
        let part = simulation.model().parts.iter().find(|part| part.name() == "block").unwrap();
        let at = 3 * part.own_vectors().start as usize;
        assert!((v[0] - 0.3).abs() < 1e-6 && (v[1] - 0.4).abs() < 1e-6, "{method}: {v:?}");
        assert!(
            (q[at] - way[0]).abs() < 1e-5 && (q[at + 1] - way[1]).abs() < 1e-5,
            "{method}: {:?} {way:?}",
            &q[at..at + 3]
        );
    }
}

/// A block that falls on a belt gets at most `mu` times the impulse of its impact, and never more than the speed of the belt.
#[test]
fn a_block_that_falls_on_a_belt_is_pushed_along() {
    for (mu, expected) in [(0.3, 0.3), (0.8, 0.5)] {
        for phase in [0.1, 0.4, 0.8] {
            let text = scene("energy-momentum", 0.1, "nts", true, "[0.5, 0, 0]")
                .replace(&format!("mu = {MU:?}"), &format!("mu = {mu:?}"))
                .replace("[gravity]\nacceleration = [0, 0, -9.81]\n", "")
                .replace(
                    "position = [0, 0, 0.2]",
                    &format!("position = [0, 0, {:?}]\nvelocity = [0, 0, -1]", 0.2 + 0.005 * (2.0 + phase)),
                );
            let mut simulation = simulation(&text);
            run(&mut simulation);
            let books = *simulation.balance();
            let up = books.linear_momentum;
            assert!((up[0] - expected).abs() < 1e-8 && up[2].abs() < 1e-8, "{mu} {phase}: {up:?}");
            // The belt supplies impulse times speed.
            assert!((books.external_work - expected * SPEED).abs() < 1e-8, "{mu} {phase}: {books:?}");
            let rest = books.total() + books.closing_loss + books.impact_loss;
            assert!((rest - 0.5).abs() < 1e-9, "{mu} {phase}: {books:?}");
        }
    }
}

#[test]
fn belts_need_friction_and_a_master() {
    let error = |from: &str, to: &str| {
        let text = scene("energy-momentum", 0.1, "nts", true, "[0.5, 0, 0]").replace(from, to);
        stoss::scene::parse(&text, "test.toml").unwrap_err().to_string()
    };
    assert!(error("friction = { law = \"coulomb\", mu = 0.2 }\n", "").contains("no effect without friction"));
    let by_cat = error("method = \"nts\"", "method = \"cat\"");
    assert!(["`nts`", "`mortar`", "not by `cat`"].iter().all(|part| by_cat.contains(part)), "{by_cat}");
    assert!(
        error("slave = \"block.bottom\"\nmaster = \"floor.all\"", "between = [\"block.bottom\", \"floor.all\"]")
            .contains("`slave` and `master`")
    );
    assert!(error("[0.5, 0, 0]", "[0.5, 0, 0]\nedges = \"general\"").contains("general contact"));
}
