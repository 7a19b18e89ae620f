//! What people simulate: a ring that folds, blocks in a box, an O-ring, gears, a wedge, sheets, a knot, a chain.

use super::judge::judge;
use super::mesh::{band, gear, groove, torus, trefoil, tube, wedge};
use super::scene::{Body, Scene};
use crate::verify::check::{Bound, Check};
use crate::verify::numbers::larger;
use crate::verify::{Bench, Findings, Run};
use crate::workspace::Outcome;

/// Measures all parts; those of minutes in the full run only.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    for (name, scene) in folds(bench.quick) {
        judge(bench, findings, &name, &scene)?;
    }
    for (name, scene) in sheets(bench.quick) {
        judge(bench, findings, &name, &scene)?;
    }
    o_ring(bench, findings)?;
    wedges(bench, findings)?;
    let blocks = if bench.quick { 12 } else { 100 };
    judge(bench, findings, &format!("{blocks} blocks dropped into a box"), &in_a_box(blocks))?;
    if !bench.quick {
        gears(bench, findings)?;
        judge(bench, findings, "knot that is pulled", &knot(48, 0.2))?;
        judge(bench, findings, "chain of ten tori", &chain(10))?;
    } else {
        judge(bench, findings, "knot that is pulled, coarse", &knot(36, 0.17))?;
    }
    Ok(())
}

/// A value at the end of a run.
fn last(run: &Run, column: &str) -> Outcome<f64> {
    let probes = run.table("probes.csv")?;
    Ok(*probes.column(column)?.last().ok_or("probes.csv has no row")?)
}

/// A closed band that is squeezed until its inner side meets itself.
fn folds(quick: bool) -> Vec<(String, Scene)> {
    let cases: &[(f64, f64)] = if quick { &[(0.5, 0.1)] } else { &[(0.5, 0.1), (0.5, 0.05), (1.2, 0.05)] };
    let scene = |&(rate, step): &(f64, f64)| {
        let gradient = [[0.0; 3], [0.0, -rate, 0.0], [0.0; 3]];
        let ring = Body::hexahedra("ring", "ring", &band(24, 0.12, 0.4, 0.0)).gradient(gradient);
        let scene = Scene::dynamic(step, 6.0).watched(1).body(ring).general("");
        (format!("ring that folds, rate {rate}, step {step}"), scene)
    };
    cases.iter().map(scene).collect()
}

/// Two sheets, one element thick, a fiftieth of their edge.
fn sheets(quick: bool) -> Vec<(String, Scene)> {
    let cases: &[(u32, f64)] = if quick { &[(3, 0.1)] } else { &[(6, 0.05), (6, 0.2)] };
    let scene = |&(n, step): &(u32, f64)| {
        let sheet = |name: &'static str| Body::block(name, [1.0, 1.0, 0.02], [n, n, 1]);
        let upper = sheet("upper").turned([1.0, 0.3, 0.0], 8.0).at([0.0, 0.0, 0.05]).velocity([0.0, 0.0, -0.05]);
        let lower = sheet("lower").turned([0.0, 0.0, 1.0], 20.0).at([0.2, 0.1, -0.05]).velocity([0.0, 0.0, 0.05]);
        let scene = Scene::dynamic(step, 4.0).watched(1).body(upper).body(lower).general("");
        (format!("sheets a fiftieth thick, {n} x {n} elements, step {step}"), scene)
    };
    cases.iter().map(scene).collect()
}

/// A ring of round section in a groove is pressed down by a rigid lid, in equilibria; nothing else holds it.
fn o_ring(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let bottom = "groove.all & z < -0.54";
    for friction in [0.0, 0.2] {
        let name = format!("O-ring in a groove, friction {friction}");
        let ring = Body::hexahedra("ring", "o-ring", &torus(1.0, 0.2, 16, 2));
        let scene = Scene::equilibria(10, "stabilise = { fraction = 1e-3 }")
            .watched(1)
            .body(ring)
            .body(Body::hexahedra("groove", "groove", &groove(0.26, 16)).young(10.0))
            .also("\n[[rigid]]\nname = \"lid\"\nshape = { kind = \"box\", size = [3.2, 3.2, 0.2] }\nposition = [0.0, 0.0, 0.32]\n")
            .also("\n[[prescribe]]\nrigid = \"lid\"\ncomponents = [\"z\"]\ndisplacement = { table = [[0.0, 0.0], [1.0, -0.12]] }\n")
            .fixed(bottom, &["x", "y", "z"])
            .also("\n[[probe]]\nname = \"lid\"\nbody = \"lid\"\nquantity = \"reaction\"\n")
            .probe("floor", bottom, "reaction")
            .general(&format!("friction = {friction:?}\nslip_velocity = 0.01"));
        let Some(done) = judge(bench, findings, &name, &scene)? else { continue };
        let (lid, floor) = (last(&done, "lid.z")?, last(&done, "floor.z")?);
        let note = format!("lid {lid:.5}, floor {floor:.5}");
        let quantity = "what the lid presses over what the floor carries, less one";
        let row = Check::new(&name, quantity, (lid.abs() / floor.abs() - 1.0).abs(), Bound::AtMost(1e-6));
        findings.checks.push(row.noted(note));
    }
    Ok(())
}

/// Angle of a wedge and of its notch to either side.
const HALF: f64 = 30.0;

/// A wedge above a notch of two rigid walls.
fn notch(scene: Scene, height: f64, velocity: f64) -> Scene {
    let angle = HALF.to_radians();
    let (slope, cosine) = (angle.tan(), angle.cos());
    let body = Body::hexahedra("wedge", "wedge", &wedge(0.1, slope)).young(100.0).at([0.0, 0.0, height]);
    let body = if velocity > 0.0 { body.velocity([0.0, 0.0, -velocity]) } else { body };
    let mut scene = scene.watched(1).body(body);
    for (wall, side) in [("right", 1.0), ("left", -1.0)] {
        let shape = format!(
            "shape = {{ kind = \"box\", size = [0.4, 2.0, 3.0] }}\nrotation = {{ axis = [0, 1, 0], degrees = {:?} }}",
            side * HALF
        );
        scene = scene.obstacle(wall, &shape, [side * (slope + 0.2 / cosine), 0.0, 1.0]);
    }
    scene
}

/// A wedge with friction: thrown into a notch, and pressed into it by a force that grows and falls again.
fn wedges(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let thrown = notch(Scene::dynamic(0.05, 4.0), 0.35, 0.5).gravity(0.5);
    judge(
        bench,
        findings,
        "wedge thrown into a notch, friction 1.2",
        &thrown.general("friction = 1.2\nslip_velocity = 0.005"),
    )?;
    for friction in [0.3, 1.2] {
        pressed_wedge(bench, findings, friction)?;
    }
    Ok(())
}

/// In equilibrium the walls carry the force: `F/2 = N sin a + T cos a`. With a coefficient far below tan a the wedge slides in at `T = mu N`; beyond it sticks.
fn pressed_wedge(bench: &Bench, findings: &mut Findings, friction: f64) -> Outcome<()> {
    const STEPS: u32 = 40;
    let name = format!("wedge pressed into a notch, friction {friction}");
    // A gap of 0.005 to the walls.
    let scene = notch(Scene::equilibria(STEPS, "stabilise = { fraction = 1e-4 }"), 0.1832, 0.0)
        .also("\n[[load]]\nset = \"wedge.all & z > 1.17 & -0.01 < x < 0.01\"\nforce = { table = [[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0, -0.3333333333333333], [1.0, 0.0, 0.0, 0.0]] }\n")
        .fixed("wedge.all & -0.01 < x < 0.01", &["x"])
        .fixed("wedge.all & -0.01 < y < 0.01", &["y"])
        .general(&format!("friction = {friction:?}\nslip_velocity = 0.001"));
    let Some(done) = judge(bench, findings, &name, &scene)? else { return Ok(()) };
    let text = crate::workspace::read(&done.folder.join("general.csv"))?;
    // The rows of one wall; both have the same names in every step.
    let mut lines = text.lines();
    let head = lines.next().unwrap_or_default();
    let rows: Vec<&str> = lines.filter(|line| line.contains("wedge,right,")).collect();
    let table = crate::table::Table::parse(&[&[head], &rows[..]].concat().join("\n"))?;
    let (sine, cosine) = HALF.to_radians().sin_cos();
    let forces = table.column("time")?.iter().zip(table.column("force_x")?).zip(table.column("force_z")?);
    let states: Vec<[f64; 3]> =
        forces.map(|((&time, x), z)| [time, z * sine - x * cosine, x * sine + z * cosine]).collect();
    let load = |time: f64| 0.5 * (1.0 - (2.0 * time - 1.0).abs());
    let (mut balance, mut bound, mut sliding) = (0.0_f64, 0.0_f64, f64::NAN);
    for &[time, normal, tangential] in states.iter().filter(|[time, ..]| (0.2..0.9).contains(time)) {
        balance = larger(balance, ((normal * sine + tangential * cosine) / load(time) - 1.0).abs());
        bound = larger(bound, (tangential / normal).abs());
        if time < 0.5 {
            sliding = tangential / normal;
        }
    }
    let mut row = |quantity: &str, measured: f64, bound: Bound| {
        findings.checks.push(Check::new(&name, quantity, measured, bound).noted(format!("{} states", states.len())));
    };
    row("what a wall carries over half of the force, less one", balance, Bound::AtMost(1e-3));
    row("largest friction over the normal force", bound, Bound::AtMost(friction * (1.0 + 1e-9)));
    let slides = Bound::Near { value: friction, tolerance: 0.05 * friction };
    let quantity = "friction over the normal force while the load grows";
    row(quantity, sliding, if friction < HALF.to_radians().tan() { slides } else { Bound::Unbounded });
    Ok(())
}

/// A number of cubes of one element and the edge 0.5 that fall, turned anyhow, into a box of rigid walls.
fn in_a_box(count: usize) -> Scene {
    const WIDTH: f64 = 3.0;
    let mut random = fastrand::Rng::with_seed(1);
    let mut uniform = |low: f64, high: f64| low + (high - low) * random.f64();
    let end = if count > 50 { 10.0 } else { 6.0 };
    let mut scene = Scene::dynamic(0.05, end).watched(5);
    let middle = 0.5 * WIDTH;
    for (name, size, at) in [
        ("floor", [WIDTH + 0.4, WIDTH + 0.4, 0.4], [middle, middle, -0.2]),
        ("west", [0.4, WIDTH + 0.4, 14.0], [-0.2, middle, 7.0]),
        ("east", [0.4, WIDTH + 0.4, 14.0], [WIDTH + 0.2, middle, 7.0]),
        ("south", [WIDTH, 0.4, 14.0], [middle, -0.2, 7.0]),
        ("north", [WIDTH, 0.4, 14.0], [middle, WIDTH + 0.2, 7.0]),
    ] {
        scene = scene.obstacle(name, &format!("shape = {{ kind = \"box\", size = {size:?} }}"), at);
    }
    for k in 0..count {
        let (layer, place) = (k / 9, k % 9);
        let [x, y] = [place / 3, place % 3].map(|i| 0.5 + i as f64 + uniform(-0.05, 0.05));
        let axis = [0; 3].map(|_| uniform(-1.0, 1.0));
        let name = format!("block-{k}");
        let block = Body::block(&name, [0.5; 3], [1; 3]).at([x, y, 0.5 + 0.9 * layer as f64]);
        let velocity = [uniform(-0.03, 0.03), uniform(-0.03, 0.03), -0.1];
        scene = scene.body(block.turned(axis, uniform(0.0, 90.0)).velocity(velocity));
    }
    scene.gravity(0.02).general("friction = 0.3")
}

/// A gear of 8 teeth turns one of 12, which has viscous friction in its hub, by one tooth.
fn gears(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    const TURN: f64 = 45.0;
    const END: f64 = 3.0;
    const APART: f64 = 2.0;
    let name = "two gears";
    let ramp: Vec<String> = (0..=12)
        .map(|k| {
            let part = f64::from(k) / 12.0;
            let circle = 2.0 * std::f64::consts::PI;
            format!("[{:?}, {:?}]", END * part, TURN * (part - (circle * part).sin() / circle))
        })
        .collect();
    let hub = format!("driven.all & hypot(x - {APART:?}, y) < 0.61");
    let driving = Body::hexahedra("driving", "gear-8", &gear(8, [0.3, 0.62, 0.92], 0.3)).young(100.0);
    let driven = Body::hexahedra("driven", "gear-12", &gear(12, [0.6, 1.02, 1.32], 0.3)).young(100.0);
    let scene = Scene::dynamic(0.02, END)
        .watched(2)
        .body(driving)
        .body(driven.at([APART, 0.0, 0.0]).turned([0.0, 0.0, 1.0], 15.0))
        .also(&format!(
            "\n[[prescribe]]\nset = \"driving.all & hypot(x, y) < 0.31\"\nrotation = {{ axis = [0, 0, 1], about = [0, 0, 0], degrees = {{ table = [{}] }} }}\n",
            ramp.join(", ")
        ))
        .also(&format!(
            "\n[[joint]]\nname = \"hub\"\nkind = \"hinge\"\nbetween = [\"ground\", \"{hub}\"]\nat = [{APART:?}, 0, 0]\naxis = [0, 0, 1]\ncoupling = \"kinematic\"\nfriction = {{ viscous = 0.5 }}\n"
        ))
        .also("\n[[probe]]\nname = \"angle\"\njoint = \"hub\"\nquantity = \"joint_angle\"\n")
        .fixed("driven.all & z < -0.14", &["z"])
        .general("friction = 0.1\nslip_velocity = 0.01");
    if let Some(done) = judge(bench, findings, name, &scene)? {
        let angle = last(&done, "angle")?;
        let bound = Bound::Near { value: -TURN * 8.0 / 12.0, tolerance: 15.0 };
        let row = Check::new(name, "angle of the driven gear: no tooth is skipped", angle, bound);
        findings.checks.push(row.noted("flanks are straight and have play; half a tooth is 15 degrees"));
    }
    Ok(())
}

/// A trefoil knot that is stretched until its strands meet.
pub fn knot(along: usize, radius: f64) -> Scene {
    let rate = 0.2;
    let gradient = [[-rate, 0.0, 0.0], [0.0, rate, 0.0], [0.0, 0.0, -rate]];
    let body = Body::hexahedra("knot", "knot", &tube(trefoil, radius, along)).gradient(gradient).spin([0.0, 0.0, 0.1]);
    Scene::dynamic(0.1, 5.0).watched(1).body(body).general("friction = 0.2")
}

/// A chain of linked tori, pulled apart from the middle.
pub fn chain(links: usize) -> Scene {
    const RING: f64 = 0.7;
    const TUBE: f64 = 0.17;
    let mesh = torus(RING, TUBE, 16, 2);
    let apart = 2.0 * (RING - TUBE) - 0.05;
    let middle = 0.5 * (links as f64 - 1.0);
    let mut scene = Scene::dynamic(0.1, 10.0).watched(2);
    for k in 0..links {
        let place = k as f64 - middle;
        let name = format!("link-{k}");
        let degrees = if k % 2 == 1 { 90.0 } else { 0.0 };
        let up = if k % 2 == 1 { -0.05 } else { 0.05 };
        let link = Body::hexahedra(&name, "link", &mesh).turned([1.0, 0.0, 0.0], degrees);
        scene = scene.body(link.at([apart * place, 0.0, 0.0]).velocity([0.1 * place / middle, 0.0, up]));
    }
    scene.general("self = false\nfriction = 0.2")
}
