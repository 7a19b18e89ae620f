//! The law of impact in whole runs (theory/impacts): a rebound that does not depend on where in a step a gap closes, rest, momenta, and the books of the energy.

use crate::support::{problem_keys, simulation};
use stoss::solver::{Balance, Simulation};

fn phases() -> impl Iterator<Item = f64> {
    (0..10).map(|k| (f64::from(k) + 0.5) / 10.0)
}

pub(crate) fn head(end: f64, step: f64) -> String {
    format!(
        "[scene]\ntitle = \"impact\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = {step:?}\nintegrator = {{ scheme = \"energy-momentum\" }}\n"
    )
}

pub(crate) const FLOOR: &str =
    "[[rigid]]\nname = \"floor\"\nshape = { kind = \"plane\", size = [10, 10] }\nfixed = true\n";

pub(crate) fn rigid(name: &str, size: [f64; 3], position: [f64; 3], more: &str) -> String {
    format!(
        "[[rigid]]\nname = \"{name}\"\nshape = {{ kind = \"box\", size = {size:?} }}\nposition = {position:?}\ndensity = 1.0\n{more}"
    )
}

pub(crate) fn contact(slave: &str, master: &str, more: &str) -> String {
    format!("[[contact]]\nslave = \"{slave}\"\nmaster = \"{master}\"\n{more}")
}

fn books(balance: &Balance) -> f64 {
    balance.total() + balance.closing_loss + balance.impact_loss
}

/// Runs to the end; the largest change of the books beside the largest energy must be round-off.
pub(crate) fn run(run: &mut Simulation) -> f64 {
    let (first, mut worst, mut largest) = (books(run.balance()), 0.0_f64, run.balance().largest_energy);
    while !run.finished() {
        let balance = run.advance().unwrap_or_else(|e| panic!("{e}")).balance;
        largest = largest.max(balance.largest_energy);
        worst = worst.max((books(&balance) - first).abs());
    }
    worst / largest
}

/// Velocity of a part of mass `mass`.
fn velocity(run: &Simulation, part: usize, mass: f64) -> [f64; 3] {
    run.part_balance(part).linear_momentum.map(|p| p / mass)
}

#[test]
fn a_box_that_falls_flat_leaves_with_the_restitution_at_every_phase() {
    for method in ["nts", "mortar"] {
        for e in [0.0, 0.5, 1.0] {
            for phase in phases() {
                let dt = 0.01;
                let text = head(0.15, dt)
                    + &rigid("box", [1.0; 3], [0.0, 0.0, 0.5 + (3.0 + phase) * dt], "velocity = [0, 0, -1]\n")
                    + FLOOR
                    + &contact("box.bottom", "floor.all", &format!("method = \"{method}\"\nrestitution = {e:?}\n"));
                let mut simulation = simulation(&text);
                let off = run(&mut simulation);
                let up = velocity(&simulation, 0, 1.0);
                assert!((up[2] - e).abs() < 1e-10 && up[0].abs() + up[1].abs() < 1e-10, "{method} {e} {phase}: {up:?}");
                // All of it moves alike.
                let v = &simulation.state().v;
                let moved = v.chunks_exact(3).map(|v| v[2]).filter(|v| v.abs() > 1e-9);
                assert!(moved.clone().all(|v| (v - e).abs() < 1e-10), "{method} {e} {phase}");
                let loss = simulation.balance().impact_loss / (0.5 * (1.0 - e * e)).max(0.5);
                let expected = if e == 1.0 { 0.0 } else { 0.5 * (1.0 - e * e) / (0.5 * (1.0 - e * e)).max(0.5) };
                assert!((loss - expected).abs() < 1e-12 && off < 1e-12, "{method} {e} {phase}: {loss} {off:e}");
            }
        }
    }
}

/// Apexes of a box that bounces under gravity are `e^2k h`: restitution is that of the velocity at the start of the step, and what that is off is taken out again by the energy.
#[test]
fn apexes_of_a_bouncing_box_fall_by_the_square_of_the_restitution() {
    let (e, dt) = (0.8_f64, 0.02);
    for phase in [0.05, 0.35, 0.65, 0.95] {
        let h = 1.0 + 1.41 * phase * dt;
        let text = head(9.0, dt)
            + "[gravity]\nacceleration = [0, 0, -1]\n"
            + &rigid("box", [0.2; 3], [0.0, 0.0, 0.1 + h], "")
            + FLOOR
            + &contact("box.bottom", "floor.all", &format!("method = \"nts\"\nrestitution = {e:?}\n"));
        let mut simulation = simulation(&text);
        let (mut apexes, mut rising) = (Vec::new(), 0.0);
        while !simulation.finished() && apexes.len() < 3 {
            simulation.advance().unwrap();
            let up = velocity(&simulation, 0, 0.008)[2];
            if rising > 0.0 && up <= 0.0 {
                let balance = simulation.balance();
                apexes.push((balance.total() - books(balance) + 0.008 * h) / (0.008 * h));
            }
            rising = up;
        }
        for (k, apex) in apexes.iter().enumerate() {
            assert!((apex - e.powi(2 * (k as i32 + 1))).abs() < 1e-4, "{phase}: {apexes:?}");
        }
        assert_eq!(apexes.len(), 3);
    }
}

fn tilted(end: f64, more: &str) -> String {
    head(end, 0.005)
        + "[gravity]\nacceleration = [0, 0, -9.81]\n"
        + &rigid("box", [1.0, 0.6, 0.3], [0.0, 0.0, 0.75], "rotation = { axis = [1, 2, 0.5], degrees = 23 }\n")
        + FLOOR
        + &contact("box.all", "floor.all", more)
}

/// A tilted box that is dropped comes to rest with its weight as the contact force. The velocities of the step alone tremble for ever: nothing damps the rates of closed gaps and of rigidity.
#[test]
fn a_dropped_box_comes_to_rest() {
    let weight = 9.81 * 0.18;
    let mut simulation_of = simulation(&tilted(2.0, "method = \"nts\"\nrestitution = 0.3\n"));
    let off = run(&mut simulation_of);
    let speed = simulation_of.state().v.iter().fold(0.0_f64, |speed, v| speed.max(v.abs()));
    let force: f64 = simulation_of.advance().map(|_| 0.0).unwrap_or(0.0)
        + simulation_of.contact_force().chunks_exact(3).map(|f| f[2].max(0.0)).sum::<f64>();
    assert!(speed < 1e-6, "{speed:e}");
    assert!((force / weight - 1.0).abs() < 1e-5, "{force} {weight}");
    assert!(off < 1e-10, "{off:e}");
    let mut trembling = simulation(&tilted(2.0, "method = \"nts\"\nclosing = \"keep\"\n"));
    let mut fastest = 0.0_f64;
    while !trembling.finished() {
        let record = trembling.advance().unwrap();
        if record.time > 1.8 {
            fastest = trembling.state().v.iter().fold(fastest, |speed, v| speed.max(v.abs()));
        }
    }
    assert!(fastest > 1e-3, "{fastest:e}");
}

/// The rate with which a corner that meets the floor leaves it, beside `-e` times that before, has an error of the first order: the body turns within the step.
#[test]
fn a_corner_leaves_with_the_restitution_to_first_order() {
    for e in [0.0, 1.0] {
        let mut errors = Vec::new();
        for dt in [0.01, 0.005, 0.0025] {
            let mut worst = 0.0_f64;
            for phase in phases() {
                let text = head(1.0, dt)
                    + &rigid(
                        "box",
                        [1.0, 0.6, 0.3],
                        [0.0, 0.0, 0.62 + phase * dt],
                        "rotation = { axis = [1, 2, 0.5], degrees = 40 }\nvelocity = [0, 0, -1]\nangular_velocity = [0.3, -0.5, 0.8]\n",
                    )
                    + FLOOR
                    + &contact("box.all", "floor.all", &format!("method = \"nts\"\nrestitution = {e:?}\n"));
                let mut simulation = simulation(&text);
                loop {
                    let before = simulation.state().v.clone();
                    simulation.advance().unwrap();
                    if let Some(slot) = simulation.active()[0].iter().position(|active| *active) {
                        let node = simulation.contact_report(0).unwrap()[slot].node as usize;
                        worst = worst.max((simulation.state().v[3 * node + 2] + e * before[3 * node + 2]).abs());
                        break;
                    }
                    assert!(!simulation.finished(), "no contact");
                }
            }
            errors.push(worst);
        }
        assert!(errors[0] < 2e-2, "{e}: {errors:?}");
        assert!(errors[0] / errors[2] > 3.2, "{e}: {errors:?}");
    }
}

#[test]
fn a_door_leaves_its_stop_with_the_restitution() {
    for e in [0.0, 0.5, 1.0] {
        for dt in [0.01, 0.0101, 0.0103, 0.0107] {
            let text = head(1.0, dt)
                + &rigid(
                    "door",
                    [0.9, 0.04, 2.0],
                    [0.45, 0.0, 1.0],
                    "velocity = [0, 0.495, 0]\nangular_velocity = [0, 0, 1.1]\n",
                )
                + "[[joint]]\nname = \"hinge\"\nkind = \"hinge\"\nbetween = [\"ground\", \"door\"]\nat = [0, 0, 1]\naxis = [0, 0, 1]\nlimits = [0, 40]\n"
                + &format!("restitution = {e:?}\n");
            let mut simulation = simulation(&text);
            let first = *simulation.balance();
            let off = run(&mut simulation);
            let now = *simulation.balance();
            let part = now.kinetic / first.kinetic;
            assert!((part - e * e).abs() < 1e-10 && off < 1e-11, "{e} {dt}: {part} {off:e}");
            // It goes back.
            let turn = now.angular_momentum[2] / first.angular_momentum[2];
            assert!((turn + e).abs() < 1e-10, "{e} {dt}: {turn}");
            assert!((now.impact_loss - (1.0 - e * e) * first.kinetic).abs() < 1e-11, "{e} {dt}");
            assert_eq!(now.dissipation, 0.0);
        }
    }
}

fn cradle(e: f64, start: f64) -> String {
    let mut text = head(0.4, 0.01);
    for k in 0..5 {
        let (x, more) = if k == 0 { (-start, "velocity = [1, 0, 0]\n") } else { (0.1 * f64::from(k), "") };
        text += &rigid(&format!("b{k}"), [0.1; 3], [x, 0.0, 0.0], more);
    }
    for k in 0..4 {
        let more = format!("method = \"nts\"\nrestitution = {e:?}\n");
        text += &contact(&format!("b{}.left", k + 1), &format!("b{k}.right"), &more);
    }
    text
}

/// Newton's law for all gaps at once would send the first one back with 3/5.
#[test]
fn a_cradle_hands_the_impact_on() {
    for (e, others, last) in [(1.0, 0.0, 1.0), (0.9, 0.02, 0.92), (0.0, 0.2, 0.2)] {
        for start in [0.0512, 0.0537, 0.0581] {
            let mut simulation = simulation(&cradle(e, start));
            let off = run(&mut simulation);
            for k in 0..5 {
                let expected = if k == 4 { last } else { others };
                let along = velocity(&simulation, k, 0.001)[0];
                assert!((along - expected).abs() < 1e-10, "{e} {start}: {k} {along}");
            }
            assert!(off < 1e-12, "{off:e}");
        }
    }
}

#[test]
fn two_boxes_that_meet_in_space_keep_both_momenta() {
    for (e, left) in [(0.0, 0.252454), (0.5, 0.465172), (1.0, 1.0)] {
        let text = head(1.0, 0.01)
            + &rigid("a", [1.0, 0.6, 0.4], [0.0; 3], "velocity = [1, 0, 0]\nangular_velocity = [0.3, 0.5, 1.0]\n")
            + "[[rigid]]\nname = \"b\"\nshape = { kind = \"box\", size = [0.5, 1.5, 1.2] }\nrotation = { axis = [0, 0, 1], degrees = 10 }\nposition = [1.1, 0.1, 0.05]\n\
               density = 2.0\nangular_velocity = [0.0, 0.2, -0.5]\n"
            + &contact("a.right", "b.left", &format!("method = \"nts\"\nrestitution = {e:?}\n"));
        let mut simulation = simulation(&text);
        let first = *simulation.balance();
        assert!(run(&mut simulation) < 1e-11);
        let now = *simulation.balance();
        for i in 0..3 {
            assert!((now.linear_momentum[i] - first.linear_momentum[i]).abs() < 1e-12);
            assert!((now.angular_momentum[i] - first.angular_momentum[i]).abs() < 1e-12);
        }
        let tolerance = if e == 1.0 { 1e-10 } else { 1e-5 };
        assert!((now.kinetic / first.kinetic - left).abs() < tolerance, "{e}: {}", now.kinetic / first.kinetic);
    }
}

/// Velocities of both sides of a joint agree after each step of an impact: the law has all bilateral constraints in the system.
#[test]
fn sides_of_a_joint_move_alike_after_an_impact() {
    for e in [0.0, 1.0] {
        let text = head(0.3, 0.01)
            + &rigid("a", [1.0, 0.4, 0.4], [0.0, 0.0, 0.35], "velocity = [0, 0, -1]\n")
            + &rigid("b", [0.4, 0.4, 0.8], [0.7, 0.0, 0.95], "velocity = [0, 0, -1]\n")
            + FLOOR
            + "[[joint]]\nname = \"knee\"\nkind = \"ball\"\nbetween = [\"a\", \"b\"]\nat = [0.5, 0.2, 0.55]\n"
            + &contact("a.bottom", "floor.all", &format!("method = \"nts\"\nrestitution = {e:?}\n"));
        let mut simulation = simulation(&text);
        let nodes: Vec<usize> = simulation
            .model()
            .embedding
            .nodes()
            .iter()
            .map(|&node| node as usize)
            .filter(|&n| {
                let x = &simulation.model().reference[3 * n..3 * n + 3];
                (x[0] - 0.5).abs() + (x[1] - 0.2).abs() + (x[2] - 0.55).abs() < 1e-9
            })
            .collect();
        assert_eq!(nodes.len(), 2, "a corner of each");
        let mut closed = 0;
        while !simulation.finished() {
            let before = simulation.balance().impacts;
            simulation.advance().unwrap();
            if simulation.balance().impacts > before {
                closed += 1;
                let v = &simulation.state().v;
                for i in 0..3 {
                    assert!((v[3 * nodes[0] + i] - v[3 * nodes[1] + i]).abs() < 1e-10, "{e}");
                }
            }
        }
        assert!(closed > 0);
    }
}

fn bar(method: &str, n: [u32; 3], courant: f64, phase: f64, speed: f64) -> String {
    // Length, density and modulus are one: so is the speed of waves.
    let (dt, size) =
        (courant / f64::from(n[2]), [f64::from(n[0]) / f64::from(n[2]), f64::from(n[1]) / f64::from(n[2])]);
    let end = (8.0 * dt).max(4.0);
    head(end, dt)
        + &format!(
            "[[body]]\nname = \"bar\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [{:?}, {:?}, 1], divisions = {n:?} }}\nposition = [0, 0, {:?}]\n\
             material = {{ law = \"saint-venant-kirchhoff\", young = 1.0, poisson = 0.0 }}\ndensity = 1.0\nvelocity = [0, 0, {:?}]\n",
            size[0],
            size[1],
            speed * dt * (1.0 + phase),
            -speed
        )
        + FLOOR
        + &contact("bar.bottom", "floor.all", &format!("method = \"{method}\"\n"))
}

/// Rebound of a bar, and the energy that is left.
fn rebound(text: &str, mass: f64, speed: f64) -> [f64; 2] {
    let mut simulation = simulation(text);
    let first = *simulation.balance();
    assert!(run(&mut simulation) < 1e-10);
    let now = *simulation.balance();
    // What is lost is booked as the loss of impacts, and nothing is lost elsewhere.
    assert!(now.closing_loss.abs() < 1e-6 * first.kinetic && now.impact_capped == 0.0);
    [now.linear_momentum[2] / (mass * speed), (now.kinetic + now.strain) / first.kinetic]
}

/// The gap is held in the closing step: the step is the same at every phase. What is lost is the energy of the nodes at the surface, a number of the mesh.
#[test]
fn a_cube_rebounds_alike_at_every_phase() {
    for method in ["nts", "mortar"] {
        for courant in [0.3, 1.0, 3.0, 10.0] {
            let all: Vec<[f64; 2]> =
                phases().map(|phase| rebound(&bar(method, [2; 3], courant, phase, 1e-4), 1.0, 1e-4)).collect();
            let range = |k: usize| {
                let values = all.iter().map(|of| of[k]);
                values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
            };
            assert!(range(0) < 1e-6, "{method} {courant}: {all:?}");
            assert!(all.iter().all(|of| (of[1] - 0.857_143).abs() < 1e-5), "{method} {courant}: {all:?}");
        }
    }
}

#[test]
fn a_finer_bar_loses_less() {
    let [rebound, energy] = rebound(&bar("nts", [1, 1, 10], 0.3, 0.4, 1e-4), 0.01, 1e-4);
    assert!((rebound - 0.942).abs() < 2e-3 && (energy - 0.971).abs() < 1e-3, "{rebound} {energy}");
}

fn blocks(phase: f64, more: &str) -> String {
    let block = |name: &str, min: [f64; 3], max: [f64; 3], divisions: [u32; 3], more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {min:?}, max = {max:?}, divisions = {divisions:?} }}\n\
             material = {{ law = \"neo-hooke\", young = 1.0e6, poisson = 0.3 }}\ndensity = 1000.0\n{more}"
        )
    };
    head(0.12, 0.002)
        + &block("lower", [0.0; 3], [2.0, 2.0, 1.0], [4, 4, 2], "")
        + &block(
            "upper",
            [0.2, 0.2, 1.02],
            [1.2, 1.2, 2.02],
            [3, 3, 3],
            &format!("position = [0, 0, {:?}]\nvelocity = [1.0, 1.0, -2.0]\n", 0.004 * phase),
        )
        + &contact("upper.bottom", "lower.top", more)
}

#[test]
fn two_blocks_come_apart_alike_at_every_phase() {
    let momentum = |method: &str, phase: f64| {
        let mut simulation = simulation(&blocks(phase, method));
        let first = *simulation.balance();
        assert!(run(&mut simulation) < 1e-11);
        let now = *simulation.balance();
        for i in 0..3 {
            let off = (now.linear_momentum[i] - first.linear_momentum[i]).abs() / 2449.0;
            assert!(off < 1e-12, "{off:e}");
            let off = (now.angular_momentum[i] - first.angular_momentum[i]).abs() / 2449.0;
            assert!(off < 1e-12, "{off:e}");
        }
        simulation.body_balance(1).linear_momentum[2]
    };
    for method in ["method = \"nts\"\n", "method = \"mortar\"\n", "method = \"mortar\"\nmultipliers = \"dual\"\n"] {
        let all = [0.1, 0.35, 0.6, 0.85].map(|phase| momentum(method, phase));
        let range = all.iter().copied().fold(f64::MIN, f64::max) - all.iter().copied().fold(f64::MAX, f64::min);
        assert!(range < 1e-4 * all[0], "{method} {all:?}");
        assert!(!method.contains("nts") || (all[0] - 635.7).abs() < 0.1, "{all:?}");
    }
}

/// Two bars end to end, the first with a small speed.
fn bars([right, left]: [&str; 2], more: &str, poisson: f64, divisions: [u32; 3], shift: f64) -> String {
    let bar = |name: &str, from: [f64; 3], divisions: [u32; 3], more: &str| {
        let to = [from[0] + 3.5, from[1] + 1.0, from[2] + 1.0];
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {from:?}, max = {to:?}, divisions = {divisions:?} }}\n\
             material = {{ law = \"neo-hooke\", young = 1.0, poisson = {poisson:?} }}\ndensity = 1.0\n{more}"
        )
    };
    head(8.4, 0.12).replace("integrator", "max_cuts = 0\nintegrator")
        + &bar("a", [0.0; 3], [6, 2, 2], "velocity = [0.012, 0, 0]\n")
        + &bar("b", [3.505, shift, shift], divisions, "")
        + &contact(right, left, &format!("method = \"mortar\"\n{more}"))
}

/// The commonest impact there is, and one whose rims and mesh lines lie on each other, so that round-off decides which vertices the polygons have. A plane wave hands the
/// momentum on; what is missing to all of it is vibration of the mesh. No step is cut.
#[test]
fn two_bars_end_to_end_hand_the_momentum_on() {
    let check = |sides: [&str; 2], more: &str, poisson: f64, divisions: [u32; 3], shift: f64| {
        let mut simulation = simulation(&bars(sides, more, poisson, divisions, shift));
        let first = *simulation.balance();
        let case = format!("{sides:?} {more} {poisson} {divisions:?} {shift}");
        assert!(run(&mut simulation) < 1e-10, "{case}");
        let now = *simulation.balance();
        for i in 0..3 {
            let off = (now.linear_momentum[i] - first.linear_momentum[i]).abs();
            assert!(off < 1e-12 * 0.042, "{case} {off:e}");
        }
        let of_b = simulation.body_balance(1).linear_momentum[0];
        assert!((of_b / 0.042 - 1.0).abs() < 0.05, "{case} {of_b}");
    };
    let dual = "multipliers = \"dual\"\n";
    for sides in [["a.right", "b.left"], ["b.left", "a.right"]] {
        check(sides, "", 0.0, [6, 2, 2], 0.0);
        check(sides, dual, 0.3, [6, 2, 2], 0.0);
        check(sides, "", 0.0, [6, 3, 3], 0.0);
        check(sides, "", 0.0, [6, 2, 2], 1e-9);
        check(sides, dual, 0.0, [6, 2, 2], 1e-4);
    }
    check(["a.right", "b.left"], "closing = \"keep\"\n", 0.0, [6, 2, 2], 0.0);
    check(["a.right", "b.left"], "gap = \"close\"\n", 0.0, [6, 2, 2], 0.0);
}

/// A run that is resumed while gaps are held, and while they settle, has the same bits.
#[test]
fn held_gaps_are_history() {
    for method in ["nts", "mortar"] {
        let text = blocks(0.4, &format!("method = \"{method}\"\nsettle = 4\n"));
        let mut straight = simulation(&text);
        let mut checkpoint = None;
        while !straight.finished() {
            straight.advance().unwrap();
            if straight.step() == 17 {
                assert!(straight.active()[0].contains(&true), "{method}: not in contact");
                checkpoint = Some(straight.checkpoint("t", Default::default()));
            }
        }
        let mut resumed = simulation(&text);
        resumed.restore(checkpoint.unwrap(), "t").unwrap();
        while !resumed.finished() {
            resumed.advance().unwrap();
        }
        assert!(straight.state().q == resumed.state().q && straight.state().v == resumed.state().v, "{method}");
        assert_eq!(straight.balance(), resumed.balance(), "{method}");
    }
}

/// A cube that lands and rests comes down to the floor.
#[test]
fn a_gap_that_was_held_settles() {
    for method in ["nts", "mortar"] {
        let text = head(3.0, 0.01)
            + "[gravity]\nacceleration = [0, 0, -1]\n[[body]]\nname = \"cube\"\nmesh = { generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }\nposition = [0, 0, 0.003]\n\
               material = { law = \"saint-venant-kirchhoff\", young = 1000.0, poisson = 0.0 }\ndensity = 1.0\ndamping = { stiffness = 0.05 }\n"
            + FLOOR
            + &contact("cube.bottom", "floor.all", &format!("method = \"{method}\"\nsettle = 20\n"));
        let mut simulation = simulation(&text);
        let mut highest = 0.0_f64;
        while !simulation.finished() {
            simulation.advance().unwrap();
            if simulation.active()[0].iter().all(|active| *active) {
                let lowest =
                    |run: &Simulation| run.state().q[..24].chunks_exact(3).map(|x| x[2]).fold(f64::MAX, f64::min);
                highest = highest.max(lowest(&simulation));
            }
        }
        let z = simulation.state().q[..24].chunks_exact(3).map(|x| x[2]).fold(f64::MAX, f64::min);
        assert!(highest > 1e-5, "{method}: nothing was held, {highest:e}");
        assert!(z.abs() < 1e-7, "{method}: floats at {z:e}");
    }
}

/// A wall that moves by a prescription hits a box at rest: with a restitution of one the box leaves with twice its speed, and the work of the support is in the books.
#[test]
fn a_moving_wall_does_work() {
    for (e, speed) in [(0.0, 1.0), (0.5, 1.5), (1.0, 2.0)] {
        for phase in [0.1, 0.6] {
            let text = head(0.15, 0.01)
                + &rigid("box", [1.0; 3], [0.5 + 0.01 * (3.0 + phase), 0.0, 0.0], "")
                + "[[rigid]]\nname = \"wall\"\nshape = { kind = \"box\", size = [1, 4, 4] }\nposition = [-0.5, 0, 0]\ndensity = 1.0\n\
                   [[prescribe]]\nrigid = \"wall\"\ncomponents = [\"x\"]\ndisplacement = { table = [[0.0, 0.0], [10.0, 10.0]] }\n"
                + &contact("box.left", "wall.right", &format!("method = \"nts\"\nrestitution = {e:?}\n"));
            let mut simulation = simulation(&text);
            let off = run(&mut simulation);
            let along = velocity(&simulation, 0, 1.0)[0];
            assert!((along - speed).abs() < 1e-10, "{e} {phase}: {along}");
            assert!(off < 1e-11, "{e} {phase}: {off:e}");
            assert!((simulation.balance().impact_loss - 0.5 * (1.0 - e * e)).abs() < 1e-11, "{e} {phase}");
        }
    }
}

/// A rope that is let go above a floor is in free fall but for what lies there: its mass is lumped, and what stops a node does not pull at the others.
#[test]
fn a_rope_falls_freely_on_a_floor() {
    let text = head(1.2, 0.002)
        + "[gravity]\nacceleration = [0, 0, -1]\n[[string]]\nname = \"rope\"\nfrom = [0, 0, 0.002]\nto = [0, 0, 1.002]\nelements = 40\naxial = 1000.0\nmass = 1.0\ntension_only = true\n"
        + FLOOR
        + &contact("rope.all", "floor.all", "method = \"nts\"\n");
    let mut simulation = simulation(&text);
    run(&mut simulation);
    let rope = simulation.model().parts.iter().find(|part| part.name() == "rope").unwrap().own_vectors();
    let heights = rope.map(|node| simulation.state().q[3 * node as usize + 2]);
    let top = heights.fold(f64::MIN, f64::max);
    assert!((top - 0.282).abs() < 1e-3, "{top}");
}

/// A flat box that meets a rough floor obliquely loses `mu (1 + e)` of its way, or all of it, at every phase, and what impact and friction take is in their books.
#[test]
fn friction_of_an_impact_is_that_of_its_impulse() {
    for method in ["nts", "mortar"] {
        for (e, mu) in [(0.0, 0.3), (0.5, 0.3), (0.5, 0.8), (1.0, 0.2)] {
            // The tractions of the step act over the gap that there is in its middle, and mortar contact gives the bodies their moment: an error of the first order.
            let tolerance = match (method, e) {
                ("nts", _) => 1e-9,
                (_, 0.0) => 1.5e-3,
                _ => 5e-5,
            };
            for phase in [0.05, 0.35, 0.65, 0.95] {
                // So thin that the friction does not turn it.
                let more = "velocity = [0.8, 0.6, -1]\n";
                let text = head(0.12, 0.01)
                    + &rigid("box", [1.0, 1.0, 1e-6], [0.0, 0.0, 5e-7 + 0.01 * (6.0 + phase)], more)
                    + FLOOR
                    + &contact(
                        "box.bottom",
                        "floor.all",
                        &format!(
                            "method = \"{method}\"\nrestitution = {e:?}\nfriction = {{ law = \"coulomb\", mu = {mu:?} }}\n"
                        ),
                    );
                let mut simulation = simulation(&text);
                let off = loop {
                    let first = books(simulation.balance());
                    let balance = simulation.advance().unwrap().balance;
                    if balance.impacts > 0 {
                        break (books(&balance) - first).abs() / balance.largest_energy;
                    }
                };
                let slides = f64::max(1.0 - mu * (1.0 + e), 0.0);
                let (v, balance) = (velocity(&simulation, 0, 1e-6), simulation.balance());
                let case = format!("{method} {e} {mu} {phase}: {v:?}");
                for (found, expected) in v.into_iter().zip([0.8 * slides, 0.6 * slides, e]) {
                    assert!((found - expected).abs() < tolerance, "{case}");
                }
                assert!(off < 1e-11, "{case}: {off:e}");
                // Of the impulse of friction over the mean speed of sliding, and of the impact.
                let by_friction = 0.5 * (1.0 - slides * slides);
                assert!(
                    (balance.friction_work / 1e-6 - by_friction).abs() < tolerance.max(1e-8),
                    "{case}: {balance:?}"
                );
                assert!(
                    (balance.impact_loss / 1e-6 - 0.5 * (1.0 - e * e)).abs() < tolerance.max(1e-8),
                    "{case}: {balance:?}"
                );
            }
        }
    }
}

/// A ball that slides over its impact loses `mu (1 + e)` of its speed, one that does not rolls with 5/7 of it. It turns within the step in which it meets the floor, with an error of the first order.
#[test]
fn a_ball_slides_or_rolls_after_an_impact() {
    for (e, mu, expected) in [(0.0, 0.1, 0.9), (0.5, 0.1, 0.85), (0.0, 0.8, 5.0 / 7.0), (0.5, 0.8, 5.0 / 7.0)] {
        let mut errors = Vec::new();
        for dt in [0.01, 0.0025] {
            let mut worst = 0.0_f64;
            for phase in [0.2, 0.5, 0.8] {
                let text = head(0.2, dt)
                    + &format!(
                        "[[rigid]]\nname = \"ball\"\nmass = 1.0\ninertia = [0.1, 0.1, 0.1]\nshape = {{ kind = \"sphere\", radius = 0.5, divisions = 4 }}\n\
                         position = [0, 0, {:?}]\nvelocity = [1, 0, -1]\n",
                        0.5 + (3.0 + phase) * dt
                    )
                    + FLOOR
                    + &contact(
                        "ball.all",
                        "floor.all",
                        &format!(
                            "method = \"nts\"\nrestitution = {e:?}\nfriction = {{ law = \"coulomb\", mu = {mu:?} }}\n"
                        ),
                    );
                let mut simulation = simulation(&text);
                while simulation.advance().unwrap().balance.impacts == 0 {}
                worst = worst.max((velocity(&simulation, 0, 1.0)[0] - expected).abs());
            }
            errors.push(worst);
        }
        assert!(errors[0] < 1.5e-2 && errors[1] < 0.5 * errors[0], "{e} {mu}: {errors:?}");
    }
}

/// Forces of a step in which something closed are those with its impulse: their sum times the step is the change of momentum, of contact, of supports and of joints.
#[test]
fn forces_of_a_step_with_an_impact_give_its_change_of_momentum() {
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    let minus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    for (method, e) in [("nts", 0.5), ("mortar", 0.0)] {
        let text = head(0.2, 0.01)
            + &rigid(
                "box",
                [1.0, 0.6, 0.3],
                [0.0, 0.0, 0.6],
                "rotation = { axis = [1, 2, 0.5], degrees = 23 }\nvelocity = [0.1, 0, -2]\n",
            )
            + FLOOR
            + &contact("box.all", "floor.all", &format!("method = \"{method}\"\nrestitution = {e:?}\n"));
        let mut simulation = simulation(&text);
        let mut before = *simulation.balance();
        while !simulation.finished() {
            let record = simulation.advance().unwrap();
            let change = minus(record.balance.linear_momentum, before.linear_momentum);
            let force = record.contact.unwrap().pairs[0].force;
            let dt = record.dt;
            assert!(
                apart(force.map(|f| dt * f), change) < 1e-12,
                "{method}: step {}: {force:?} {change:?}",
                record.step
            );
            before = record.balance;
        }
        assert!(before.impacts > 0);
    }
    // A block falls on another one that is held at its base.
    let base = "[[body]]\nname = \"base\"\nmesh = { generator = \"block\", min = [-1, -1, -1], max = [2, 2, 0], divisions = [3, 3, 1] }\n\
                material = { law = \"neo-hooke\", young = 1.0, poisson = 0.3 }\ndensity = 1.0\n\
                [[prescribe]]\nset = \"base.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n";
    let text = bar("nts", [2; 3], 0.3, 0.4, 0.01).replace(FLOOR, base).replace("floor.all", "base.top");
    let mut of_base = simulation(&text);
    let mut before = *of_base.balance();
    for _ in 0..20 {
        let record = of_base.advance().unwrap();
        let change = minus(record.balance.linear_momentum, before.linear_momentum);
        let mut force = [0.0; 3];
        of_base.reactions().chunks_exact(3).for_each(|f| (0..3).for_each(|i| force[i] += record.dt * f[i]));
        assert!(apart(force, change) < 1e-12, "base: step {}: {force:?} {change:?}", record.step);
        before = record.balance;
    }
    assert!(before.impacts > 0);
    let text = head(1.0, 0.0103)
        + &rigid(
            "door",
            [0.9, 0.04, 2.0],
            [0.45, 0.0, 1.0],
            "velocity = [0, 0.495, 0]\nangular_velocity = [0, 0, 1.1]\n",
        )
        + "[[joint]]\nname = \"hinge\"\nkind = \"hinge\"\nbetween = [\"ground\", \"door\"]\nat = [0, 0, 1]\naxis = [0, 0, 1]\nlimits = [0, 40]\n\
           restitution = 0.5\n";
    let mut door = simulation(&text);
    let mut before = *door.balance();
    while !door.finished() {
        let record = door.advance().unwrap();
        let change = minus(record.balance.linear_momentum, before.linear_momentum);
        let joints = door.model().contacts.iter().zip(door.mean_pressures());
        let report = joints.filter_map(|(pair, p)| pair.joint(&door.state().q, p)).next().unwrap();
        let impulse = report.force.map(|f| record.dt * f);
        assert!(apart(impulse, change) < 1e-12, "door: step {}: {impulse:?} {change:?}", record.step);
        before = record.balance;
    }
    assert!(before.impacts > 0);
}

#[test]
fn keys_that_do_not_fit_are_refused() {
    for (more, key) in [
        ("method = \"mortar\"\nclosing = \"restore\"\n", "contact[0].closing"),
        ("method = \"nts\"\nrestitution = 1.5\n", "contact[0].restitution"),
        ("method = \"nts\"\nclosing = \"keep\"\nrestitution = 0.5\n", "contact[0].restitution"),
        ("method = \"cat\"\ngap = \"hold\"\nclosing = \"impact\"\n", "contact[0].gap"),
    ] {
        assert_eq!(problem_keys(&blocks(0.0, more)), [key], "{more}");
    }
}
