//! Friction of whole models: a block on an incline, a block that stops, two blocks that hit each other (theory/examples#two-elements).

use crate::support::{drift, simulation, two_blocks};
use stoss::solver::{Balance, DecisionKind, Simulation};

/// Side of the block, its height, density, gravity.
const HEIGHT: f64 = 0.5;
const DENSITY: f64 = 2.0;
const GRAVITY: f64 = 10.0;

/// A block of 2 x 2 x 1 elements on a rigid plate, under a body force along (sin, 0, -cos) of an angle with the given tangent.
fn block(time: &str, tangent: f64, speed: f64, friction: &str) -> Simulation {
    let weight = DENSITY * GRAVITY / (1.0 + tangent * tangent).sqrt();
    let contact = format!("method = \"nts\"\nfriction = {friction}");
    loaded_block(time, &format!("[{}, 0, {}]", weight * tangent, -weight), speed, &contact)
}

/// The block under any body force; `contact` are the keys of the contact but for its surfaces.
fn loaded_block(time: &str, body_force: &str, speed: f64, contact: &str) -> Simulation {
    simulation(&format!(
        r#"
[scene]
title = "block on a plate"
kind = "dynamic"
[time]
{time}
[[body]]
name = "plate"
mesh = {{ generator = "block", min = [-1, -1, -1], max = [5, 2, 0], divisions = [5, 2, 1] }}
material = {{ law = "neo-hooke", young = 1e5, poisson = 0.3 }}
density = 1.0
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, {HEIGHT}], divisions = [2, 2, 1] }}
material = {{ law = "neo-hooke", young = 1e5, poisson = 0.3 }}
density = {DENSITY}
velocity = [{speed:?}, 0, 0]
[[prescribe]]
set = "plate.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "plate.top"
components = ["x", "y", "z"]
fixed = true
[[contact]]
slave = "block.bottom"
master = "plate.top"
{contact}
[[load]]
body = "block"
body_force = {body_force}
"#
    ))
}

/// Mean x of the block's nodes, and its mean velocity by the linear momentum.
fn place(s: &Simulation) -> (f64, f64) {
    let nodes = &s.model().bodies[1].nodes;
    let x = nodes.clone().map(|n| s.state().q[3 * n as usize]).sum::<f64>() / nodes.len() as f64;
    (x, s.balance().linear_momentum[0] / (DENSITY * HEIGHT))
}

fn cuts(s: &Simulation) -> usize {
    s.decisions().iter().filter(|d| d.kind == DecisionKind::Cut).count()
}

const MU: f64 = 0.3;

/// By how much the dissipation of a step may be negative, relative: not at all for exact stick.
fn round_off(stick: &str) -> f64 {
    if stick.contains("penalty") { 1e-15 } else { 0.0 }
}

/// Mean x displacement of the block's lower face.
fn lower_face(s: &Simulation) -> f64 {
    let (q, reference) = (&s.state().q, &s.model().reference);
    let nodes = s.model().bodies[1].nodes.clone().map(|n| 3 * n as usize).filter(|&c| reference[c + 2] == 0.0);
    let moved: Vec<f64> = nodes.map(|c| q[c] - reference[c]).collect();
    moved.iter().sum::<f64>() / moved.len() as f64
}

/// A block at a share of the friction angle, tan = share mu, under a weight that grows for one unit of time: a load that is there at once would swing beyond the bound.
fn gently_loaded(scheme: &str, end: f64, share: f64, stick: &str) -> Simulation {
    let tangent = share * MU;
    let weight = DENSITY * GRAVITY / (1.0 + tangent * tangent).sqrt();
    let load = format!("{{ table = [[0, 0, 0, 0], [1, {}, 0, {}]] }}", weight * tangent, -weight);
    let contact = format!("method = \"nts\"\nfriction = {{ law = \"coulomb\", mu = {MU}{stick} }}");
    let time = format!("end = {end:?}\nstep = 0.05\nintegrator = {{ scheme = \"{scheme}\" }}");
    loaded_block(&time, &load, 0.0, &contact)
}

/// Runs to the end; least and largest place of the lower face after a time, and the steps then.
fn range_after(s: &mut Simulation, time: f64) -> (f64, f64, u32) {
    let (mut least, mut most, mut steps) = (f64::INFINITY, f64::NEG_INFINITY, 0);
    while !s.finished() {
        s.advance().unwrap();
        if s.state().time > time {
            least = least.min(lower_face(s));
            most = most.max(lower_face(s));
            steps += 1;
        }
    }
    (least, most, steps)
}

/// On springs the face moves by traction over stiffness, no farther, and stays. Close to the bound the nodes with the lower pressures have slid until those
/// with the highest, which still stick, take the rest: it moves by what their springs yield at most (softer than
/// the block, that is, whose own deformation comes on top).
#[test]
fn springs_in_stick_yield_by_traction_over_stiffness() {
    for (share, penalty) in [(0.5, 1e4), (0.5, 1e6), (0.99, 1e3), (0.99, 1e4)] {
        let mut s = gently_loaded("backward-euler", 21.0, share, &format!(", penalty = {penalty:e}"));
        let (least, most, _) = range_after(&mut s, 11.0);
        let tangent = share * MU;
        let mean = DENSITY * GRAVITY * HEIGHT * tangent / (1.0 + tangent * tangent).sqrt();
        let highest = s.pressures().iter().flatten().fold(0.0_f64, |most, p| most.max(*p));
        let bound = if share < 0.9 { mean } else { MU * highest } / penalty;
        let drift = (most - least) / bound;
        println!("{share} {penalty:e}: {:.6} of the bound, mean {:e}, drift {drift:e}", most / bound, mean / penalty);
        assert!(
            most < 1.2 * bound && least > 0.8 * mean / penalty,
            "{share} {penalty:e}: {least:e} {most:e} of {bound:e}"
        );
        assert!(drift < 1e-6, "{share} {penalty:e}: {drift:e}");
    }
}

/// The schemes that keep all vibrations.
#[test]
fn conserving_schemes_stick_below_the_friction_angle() {
    for scheme in ["energy-momentum", "midpoint"] {
        let (least, most, steps) = range_after(&mut gently_loaded(scheme, 51.0, 0.99, ""), 1.01);
        println!("{scheme}: from {least:e} to {most:e} over {steps} steps");
        assert!(most - least < 1e-8 && steps >= 999, "{scheme}: {:e}", most - least);
    }
}

/// Distance and speed at a time of a point with `v' = -mu(v) g`, by the classical Runge-Kutta method, until it stops.
fn slide_of_a_point(mu: impl Fn(f64) -> f64, speed: f64, end: f64) -> (f64, f64) {
    const STEPS: usize = 60_000;
    let h = end / STEPS as f64;
    let (mut x, mut v) = (0.0, speed);
    let rate = |v: f64| -mu(v) * GRAVITY;
    for _ in 0..STEPS {
        let a = rate(v);
        let b = rate(v + 0.5 * h * a);
        let c = rate(v + 0.5 * h * b);
        let d = rate(v + h * c);
        let next = v + h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        if next <= 0.0 {
            return (x + 0.5 * v * v / -a, 0.0);
        }
        x += 0.5 * h * (v + next);
        v = next;
    }
    (x, v)
}

/// A block that slides under the other laws against the equation of motion of a point.
#[test]
fn other_laws_slow_a_block_down_as_their_equation_says() {
    let falling = |v: f64| 0.2 + 0.3 * (-(v / 0.5_f64).powi(2)).exp();
    let smooth = |v: f64| 0.3 * v / v.hypot(0.1);
    let laws: [(&str, &dyn Fn(f64) -> f64); 2] = [
        (r#"law = "static-dynamic", mu_static = 0.5, mu_dynamic = 0.2, speed = 0.5"#, &falling),
        (r#"law = "regularised", mu = 0.3, speed = 0.1"#, &smooth),
    ];
    for (law, mu) in laws {
        for scheme in ["backward-euler", "energy-momentum", "midpoint"] {
            let time = format!("end = 0.6\nstep = 0.002\nintegrator = {{ scheme = \"{scheme}\" }}");
            let mut s = block(&time, 0.0, 1.0, &format!("{{ {law} }}"));
            for end in [0.2, 0.6] {
                while s.state().time < end - 1e-9 {
                    s.advance().unwrap();
                }
                let (distance, speed) = slide_of_a_point(mu, 1.0, end);
                let (x, v) = (place(&s).0 - 0.5, place(&s).1);
                println!(
                    "{law} {scheme} t = {end}: {:e} of the distance, {:e} of the speed",
                    x / distance - 1.0,
                    v - speed
                );
                assert!((x / distance - 1.0).abs() < 1e-2, "{law} {scheme} {end}: {x} against {distance}");
                assert!((v - speed).abs() < 1e-2, "{law} {scheme} {end}: {v} against {speed}");
            }
            assert_eq!(cuts(&s), 0, "{law} {scheme}");
        }
    }
}

/// tan = 0.99 mu: after the first steps nothing moves, for a thousand steps.
#[test]
fn a_block_sticks_below_the_friction_angle() {
    for (stick, bound) in [(r#"penalty = 1e6, stick = "penalty""#, 1e-10), (r#"stick = "multiplier""#, 1e-12)] {
        let friction = format!(r#"{{ law = "coulomb", mu = {MU}, {stick} }}"#);
        let mut s =
            block("end = 51.0\nstep = 0.05\nintegrator = { scheme = \"backward-euler\" }", 0.99 * MU, 0.0, &friction);
        for _ in 0..20 {
            s.advance().unwrap();
        }
        let settled = s.state().q.clone();
        assert!((place(&s).0 - 0.5).abs() < 1e-3, "it did not slide away: {}", place(&s).0);
        for _ in 0..1000 {
            s.advance().unwrap();
        }
        let moved = s.state().q.iter().zip(&settled).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved < bound, "{stick}: moved by {moved:e}");
        assert_eq!(cuts(&s), 0, "{stick}");
    }
}

/// tan = 1.01 mu: it slides with the acceleration g (sin - mu cos), a hundredth of the friction. The weight grows for one unit of time, so that the
/// schemes that keep all vibrations have hardly any to keep. (Much smaller steps resolve how a sliding elastic block begins to flutter.)
#[test]
fn a_block_slides_above_the_friction_angle() {
    let tangent = 1.01 * MU;
    let weight = DENSITY * GRAVITY / (1.0 + tangent * tangent).sqrt();
    let load = format!("{{ table = [[0, 0, 0, 0], [1, {}, 0, {}]] }}", weight * tangent, -weight);
    let expected = GRAVITY * (tangent - MU) / (1.0 + tangent * tangent).sqrt();
    for scheme in ["backward-euler", "midpoint", "energy-momentum"] {
        for stick in [r#"stick = "multiplier""#, r#"penalty = 1e6"#] {
            let contact = format!("method = \"nts\"\nfriction = {{ law = \"coulomb\", mu = {MU}, {stick} }}");
            let time = format!("end = 5.0\nstep = 0.05\nintegrator = {{ scheme = \"{scheme}\" }}");
            let mut s = loaded_block(&time, &load, 0.0, &contact);
            let mut at = Vec::new();
            while !s.finished() {
                s.advance().unwrap();
                at.push((s.state().time, place(&s).1));
            }
            let (early, late) = (at[2 * at.len() / 5], at[at.len() - 1]);
            let found = (late.1 - early.1) / (late.0 - early.0);
            let error = found / expected - 1.0;
            println!("{scheme} {stick}: {error:e}");
            assert!(error.abs() < 1e-3, "{scheme} {stick}: acceleration {found} against {expected}");
        }
    }
}

/// A block with the speed 1 stops after v^2 / (2 mu g) and stays.
#[test]
fn a_block_stops_at_the_analytic_distance() {
    for (scheme, stick) in [
        ("backward-euler", r#"penalty = 1e6"#),
        ("backward-euler", r#"stick = "multiplier""#),
        ("midpoint", r#"stick = "multiplier""#),
        ("energy-momentum", r#"stick = "multiplier""#),
        ("energy-momentum", r#"penalty = 1e6"#),
    ] {
        let friction = format!(r#"{{ law = "coulomb", mu = {MU}, {stick} }}"#);
        // Backward Euler is of first order.
        let step = if scheme == "backward-euler" { 0.001 } else { 0.002 };
        let time = format!("end = 0.5\nstep = {step}\nintegrator = {{ scheme = \"{scheme}\" }}");
        let mut s = block(&time, 0.0, 1.0, &friction);
        let kinetic = s.balance().kinetic;
        let mut dissipation = 0.0;
        let mut at_04 = 0.0;
        while !s.finished() {
            let record = s.advance().unwrap();
            let b = record.balance;
            assert!(b.dissipation - dissipation >= -round_off(stick) * b.dissipation, "dissipation falls");
            let rest = b.friction_work - b.friction_stored - b.dissipation;
            assert!(rest.abs() < 1e-11 * kinetic, "{scheme} {stick}: work of friction, rest {rest:e}");
            dissipation = b.dissipation;
            if s.state().time < 0.4 {
                at_04 = place(&s).0;
            }
        }
        let expected = 1.0 / (2.0 * MU * GRAVITY);
        let distance = place(&s).0 - 0.5;
        assert!((distance / expected - 1.0).abs() < 5e-3, "{scheme} {stick}: {distance} against {expected}");
        assert!((place(&s).0 - at_04).abs() < 1e-3 * expected, "{scheme} {stick}: it stays");
        // All of the kinetic energy has gone into friction, but for what the conserving schemes keep in vibrations and lose in closings.
        let rest = if scheme == "backward-euler" { 5e-3 } else { 2e-2 };
        assert!((dissipation / kinetic - 1.0).abs() < rest, "{scheme} {stick}: {dissipation} of {kinetic}");
    }
}

/// The two elements of theory/examples#two-elements (thesis, table 6.2) with mu = 1/2.
fn impact(scheme: &str, step: f64, end: f64, friction: &str) -> Simulation {
    impact_with(scheme, step, end, &format!("friction = {friction}"))
}

/// The two elements of [`impact`] with any further keys of the contact.
fn impact_with(scheme: &str, step: f64, end: f64, contact: &str) -> Simulation {
    simulation(&two_blocks(scheme, step, end, [0.0; 3], &format!("method = \"nts\"\n{contact}")))
}

fn run(s: &mut Simulation) -> Vec<(Balance, usize, usize)> {
    let mut rows = vec![(*s.balance(), 0, 0)];
    while !s.finished() {
        let record = s.advance().unwrap();
        let contact = record.contact.unwrap();
        rows.push((record.balance, contact.active, contact.closed));
    }
    rows
}

fn mechanical(b: &Balance) -> f64 {
    b.kinetic + b.strain + b.contact
}

/// Energy-momentum: momenta to round-off; the energy is constant before and after, never rises, and what is lost is in the column `dissipation`, but
/// for the steps in which nodes close.
#[test]
fn two_blocks_energy_momentum() {
    for stick in ["penalty = 1e4", r#"stick = "multiplier""#] {
        let friction = format!(r#"{{ law = "coulomb", mu = 0.5, {stick} }}"#);
        let mut s = impact("energy-momentum", 0.1, 20.0, &friction);
        let rows = run(&mut s);
        let linear: Vec<_> = rows.iter().map(|r| r.0.linear_momentum).collect();
        let angular: Vec<_> = rows.iter().map(|r| r.0.angular_momentum).collect();
        assert!(drift(&linear) < 1e-11 && drift(&angular) < 1e-11, "{:e} {:e}", drift(&linear), drift(&angular));
        let scale = mechanical(&rows[0].0);
        let mut frictional = 0;
        for pair in rows.windows(2) {
            let ((a, ..), (b, active, closed)) = (&pair[0], &pair[1]);
            let change = mechanical(b) - mechanical(a);
            let dissipated = b.dissipation - a.dissipation;
            assert!(dissipated >= -round_off(stick) * scale, "dissipated {dissipated:e}");
            let rest = b.friction_work - b.friction_stored - b.dissipation;
            assert!(rest.abs() < 1e-11 * scale, "work of friction, rest {rest:e}");
            assert!(b.friction_stored == b.contact && (b.contact == 0.0) == (round_off(stick) == 0.0 || *active == 0));
            assert!(change <= 1e-11 * scale, "gain {change:e}");
            if *active == 0 {
                assert!((change + dissipated).abs() < 1e-11 * scale);
            }
            if *closed == 0 {
                assert!((b.total() - a.total()).abs() < 1e-11 * scale, "{}", b.total() - a.total());
            }
            frictional += usize::from(dissipated > 1e-6 * scale);
        }
        assert!(frictional > 3, "steps with friction: {frictional}");
        assert_eq!(cuts(&s), 0);
    }
}

/// The midpoint rule keeps the momenta; its energy is less after the impact than before; the upper block loses momentum along its slip.
#[test]
fn two_blocks_midpoint() {
    for (step, stick) in [(0.05, "penalty = 1e4"), (0.2, "penalty = 1e4"), (0.2, r#"stick = "multiplier""#)] {
        let friction = format!(r#"{{ law = "coulomb", mu = 0.5, {stick} }}"#);
        let mut s = impact("midpoint", step, 20.0, &friction);
        let rows = run(&mut s);
        let linear: Vec<_> = rows.iter().map(|r| r.0.linear_momentum).collect();
        let angular: Vec<_> = rows.iter().map(|r| r.0.angular_momentum).collect();
        assert!(drift(&linear) < 1e-11 && drift(&angular) < 1e-11, "{:e} {:e}", drift(&linear), drift(&angular));
        let first = &rows[0].0;
        let last = &rows[rows.len() - 1].0;
        assert!(mechanical(last) < mechanical(first) && last.dissipation > 0.0);
        for pair in rows.windows(2) {
            let dissipated = pair[1].0.dissipation - pair[0].0.dissipation;
            assert!(dissipated >= -round_off(stick) * last.dissipation, "dissipation falls");
        }
    }
}

/// Backward Euler, the schemes with friction at the midpoint, and stick by multipliers approach the same solution.
#[test]
fn schemes_agree_on_the_impact() {
    let upper = |scheme: &str, step: f64, rest: &str| {
        let friction = format!(r#"{{ law = "coulomb", mu = 0.5, {rest} }}"#);
        let mut s = impact(scheme, step, 6.0, &friction);
        run(&mut s);
        s.body_balance(0).linear_momentum.map(|p| p / 1000.0)
    };
    let exact = "stick = \"multiplier\"";
    let fine = upper("backward-euler", 0.005, exact);
    // Friction has turned part of the velocity along y, 0.1, into a motion of the lower block.
    assert!(fine[1] < 0.08, "{fine:?}");
    for (scheme, step, rest, tolerance) in [
        ("backward-euler", 0.005, "penalty = 1e4", 6e-3),
        ("midpoint", 0.2, exact, 5e-3),
        ("midpoint", 0.02, exact, 5e-3),
        ("energy-momentum", 0.1, exact, 5e-3),
        ("energy-momentum", 0.02, exact, 5e-3),
        ("energy-momentum", 0.005, exact, 5e-3),
    ] {
        let found = upper(scheme, step, rest);
        println!("{scheme} {step}: {found:?} against {fine:?}");
        for i in 0..3 {
            assert!((found[i] - fine[i]).abs() < tolerance, "{scheme}{rest}: {found:?} against {fine:?}");
        }
    }
}

/// Springs: the energy-momentum scheme keeps the energy in every step, closings included, and the penetration falls with the root of the
/// stiffness.
#[test]
fn two_blocks_by_penalty() {
    let mut depths = Vec::new();
    for stiffness in [1e4, 1e5] {
        let mut s = impact_with("energy-momentum", 0.05, 10.0, &format!("enforcement = {{ penalty = {stiffness:?} }}"));
        let (mut rows, mut depth) = (vec![*s.balance()], 0.0_f64);
        while !s.finished() {
            let record = s.advance().unwrap();
            depth = depth.max(-record.contact.unwrap().min_gap);
            rows.push(record.balance);
        }
        let linear: Vec<_> = rows.iter().map(|b| b.linear_momentum).collect();
        let angular: Vec<_> = rows.iter().map(|b| b.angular_momentum).collect();
        assert!(drift(&linear) < 1e-11 && drift(&angular) < 1e-11, "{:e} {:e}", drift(&linear), drift(&angular));
        let scale = rows[0].total();
        let energy = rows.iter().map(|b| (b.total() / scale - 1.0).abs()).fold(0.0, f64::max);
        assert!(energy < 1e-11, "energy drift {energy:e}");
        assert!(rows.iter().any(|b| b.contact > 1e-3 * scale), "the springs do something");
        depths.push(depth);
    }
    assert!(depths[0] > 1e-5 && depths[1] < 0.5 * depths[0], "{depths:?}");
}

/// The residuals of the steps in contact fall quadratically. (Last digits: round-off.)
#[test]
fn newton_is_quadratic() {
    for stick in ["penalty = 1e4", r#"stick = "multiplier""#] {
        newton_is_quadratic_with(stick);
    }
}

fn newton_is_quadratic_with(stick: &str) {
    let friction = format!(r#"{{ law = "coulomb", mu = 0.5, {stick} }}"#);
    let mut s = impact("energy-momentum", 0.1, 6.0, &friction);
    let (mut orders, mut steps, mut most) = (Vec::new(), 0, 0);
    while !s.finished() {
        let record = s.advance().unwrap();
        let residuals: Vec<f64> = record.newton.iter().map(|row| row.residual).collect();
        if record.contact.unwrap().active > 0 {
            println!("step {}: {residuals:?}", record.step);
            // Behind the last change of the active set, and of stick and slip: from 1e-4 to round-off in two iterations.
            let last = residuals.windows(2).rposition(|r| r[1] > r[0] && r[1] > 1e-11).map_or(0, |k| k + 1);
            let between = residuals[last..].iter().filter(|r| (1e-11..1e-4).contains(*r)).count();
            most = most.max(between);
            steps += 1;
            for r in residuals.windows(3) {
                if r[0] < 1e-1 && r[1] < r[0] && r[2] < r[1] && r[1] > 1e-11 {
                    let order = (r[2] / r[1]).ln() / (r[1] / r[0]).ln();
                    // With round-off in the last place it is a lower bound, which says something if it is large enough.
                    if r[2] > 1e-11 || order > 1.7 {
                        orders.push(order);
                    }
                }
            }
        }
    }
    orders.sort_by(f64::total_cmp);
    println!("{stick}: orders {orders:?}, {steps} steps, at most {most} residuals between 1e-4 and 1e-11");
    assert!(orders.len() > 3 && orders[orders.len() / 2] > 1.7, "{orders:?}");
    assert!(steps > 10 && most <= 2, "{most} of {steps}");
}

/// Multipliers with a coefficient far beyond real ones, and in steps far below what the impact needs: no step is cut, energy does not rise, dissipation
/// does not fall.
#[test]
fn exact_stick_in_extreme_impacts() {
    for (scheme, step, end, mu) in [
        ("energy-momentum", 0.1, 20.0, 10.0),
        ("backward-euler", 0.02, 20.0, 10.0),
        ("energy-momentum", 0.001, 2.7, 0.5),
        ("backward-euler", 0.001, 2.7, 0.5),
    ] {
        let mut s = impact(scheme, step, end, &format!(r#"{{ law = "coulomb", mu = {mu:?} }}"#));
        let rows = run(&mut s);
        let scale = mechanical(&rows[0].0);
        for pair in rows.windows(2) {
            let ((a, ..), (b, ..)) = (&pair[0], &pair[1]);
            assert!(b.dissipation >= a.dissipation, "{scheme} {step} {mu}: dissipation falls");
            assert!(mechanical(b) - mechanical(a) <= 1e-12 * scale, "{scheme} {step} {mu}: energy rises");
        }
        assert!(rows.iter().any(|row| row.1 > 0), "{scheme} {step} {mu}: they touch");
        assert_eq!(cuts(&s), 0, "{scheme} {step} {mu}");
    }
}

/// A smooth law turns its traction within a slip far below that of an impact: down to a hundredth of the speed of approach no step is cut.
#[test]
fn regularised_friction_in_an_impact() {
    for (method, scheme) in
        ["nts", "cat", "mortar"].iter().flat_map(|m| ["energy-momentum", "midpoint", "backward-euler"].map(|s| (m, s)))
    {
        for (step, speed) in [(0.1, 0.01), (0.1, 0.001), (0.01, 0.005), (0.01, 0.001)] {
            let contact =
                format!("method = \"{method}\"\nfriction = {{ law = \"regularised\", mu = 0.5, speed = {speed} }}");
            let mut s = simulation(&two_blocks(scheme, step, 5.0, [0.0; 3], &contact));
            let rows = run(&mut s);
            let name = format!("{method} {scheme} {step} {speed}");
            assert!(rows.iter().any(|row| row.1 > 0), "{name}: they touch");
            assert!(rows.windows(2).all(|w| w[1].0.dissipation >= w[0].0.dissipation), "{name}: dissipation falls");
            assert_eq!(cuts(&s), 0, "{name}");
        }
    }
}

#[test]
fn a_scheme_without_friction_is_refused() {
    let text = r#"
[scene]
title = "no friction"
kind = "dynamic"
[time]
end = 1.0
step = 0.1
integrator = { scheme = "trapezoidal" }
[[body]]
name = "a"
mesh = { generator = "block", size = [1, 1, 1], divisions = [1, 1, 1] }
material = { law = "neo-hooke", young = 1e3, poisson = 0.3 }
density = 1.0
[[body]]
name = "b"
mesh = { generator = "block", size = [1, 1, 1], divisions = [1, 1, 1] }
position = [0, 0, 2]
material = { law = "neo-hooke", young = 1e3, poisson = 0.3 }
density = 1.0
[[contact]]
method = "nts"
slave = "b.bottom"
master = "a.top"
friction = { law = "coulomb", mu = 0.3 }
"#;
    let scene = stoss::scene::parse(text, "test.toml").unwrap();
    let errors = stoss::build::build(&scene, std::path::Path::new(".")).unwrap_err().to_string();
    assert!(errors.contains("contact[0].friction") && errors.contains("`trapezoidal`"), "{errors}");
}

/// The load alternates between twice the bound of the friction and half of it backwards, from step to step: every step goes from slip to stick or
/// back. Newton's method must find the stick between two directions of slip.
#[test]
fn slip_and_stick_in_turn_need_no_cut() {
    let weight = DENSITY * GRAVITY;
    let mut rows = vec![format!("[0, 0, 0, {}]", -weight)];
    for k in 2..40 {
        let push = MU * weight * if k % 2 == 0 { 2.0 } else { -0.5 };
        let (from, to) = (0.02 * f64::from(k) + 2e-4, 0.02 * f64::from(k + 1));
        rows.extend([from, to].map(|t| format!("[{t:?}, {push:?}, 0, {}]", -weight)));
    }
    let force = format!("{{ table = [{}] }}", rows.join(", "));
    let methods = [
        "method = \"nts\"",
        "method = \"cat\"",
        "method = \"cat\"\nreduction = \"first\"",
        "method = \"cat\"\nreduction = \"none\"",
        "method = \"mortar\"",
    ];
    for (method, scheme) in
        methods.iter().flat_map(|m| ["backward-euler", "midpoint", "energy-momentum"].map(|s| (m, s)))
    {
        for stick in ["penalty = 1e4", "penalty = 1e5", "penalty = 1e7", "stick = \"multiplier\""] {
            let time = format!("end = 0.8\nstep = 0.02\nintegrator = {{ scheme = \"{scheme}\" }}");
            let contact = format!("{method}\nfriction = {{ law = \"coulomb\", mu = {MU}, {stick} }}");
            let mut s = loaded_block(&time, &force, 0.0, &contact);
            let mut dissipation = 0.0;
            while !s.finished() {
                let now = s.advance().unwrap().balance.dissipation;
                assert!(now - dissipation >= -round_off(stick) * now, "{method} {scheme} {stick}: dissipation falls");
                dissipation = now;
            }
            assert!(place(&s).0 > 0.5 + 1e-3, "{method} {scheme} {stick}: it slides");
            assert_eq!(cuts(&s), 0, "{method} {scheme} {stick}");
        }
    }
}

/// A block that is pressed on a held one and pulled along without sliding: the table of the contact has the load, whatever enforces stick.
#[test]
fn the_contact_force_of_a_sticking_block_is_its_load() {
    for method in ["mortar", "nts", "cat"] {
        for stick in ["", ", stick = \"penalty\""] {
            let text = format!(
                r#"
[scene]
title = "stick"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [-1, -1, -1], max = [2, 2, 0], divisions = [3, 3, 1] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[contact]]
method = "{method}"
slave = "upper.bottom"
master = "lower.top"
friction = {{ law = "coulomb", mu = 0.3{stick} }}
[[prescribe]]
set = "lower.all"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "upper.top"
traction = {{ table = [[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0, -20.0], [1.0, 3.0, 1.0, -20.0]] }}
"#
            );
            let mut simulation = simulation(&text);
            let mut force = [0.0; 3];
            for _ in 0..4 {
                force = simulation.advance().unwrap().contact.unwrap().force_on_slave;
            }
            let error = [-3.0, -1.0, 20.0].iter().zip(force).map(|(e, f)| (e - f).abs()).fold(0.0, f64::max);
            assert!(error < 1e-6, "{method}{stick}: {force:?}");
        }
    }
}
