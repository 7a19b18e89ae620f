//! What goes beyond the usual: fast impacts, contrasts, step sizes and thicknesses over decades, rest, degenerate surfaces.

use super::features::{apart_edges, edge_on_edge};
use super::judge::{judge, run};
use super::mesh::{Hexahedra, slab_with_slivers};
use super::scene::{Body, Scene};
use crate::verify::check::{Bound, Check};
use crate::verify::numbers::larger;
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;

/// Exit code of a scene that is refused.
const REFUSED: f64 = 2.0;

/// Measures all extremes.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let mut cases = vec![
        ("impact at half the speed of waves".to_owned(), fast(0.25, 0.02)),
        ("ratio of stiffness 1e6, soft on stiff".to_owned(), contrast([1.0, 1e6])),
        ("ratio of stiffness 1e6, stiff on soft".to_owned(), contrast([1e6, 1.0])),
        ("a cube on a face forty times its edges".to_owned(), sizes(0.05)),
    ];
    if !bench.quick {
        cases.push(("impact at the speed of waves".to_owned(), fast(0.5, 0.01)));
        cases.push(("a cube on a face forty times its edges, step 0.2".to_owned(), sizes(0.2)));
    }
    let steps: &[f64] = if bench.quick { &[1.0, 0.03] } else { &[1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001] };
    for &step in steps {
        cases.push((format!("edge on edge, step {step}"), edge_on_edge(step, "thickness = 0.02")));
    }
    let thicknesses: &[f64] = if bench.quick { &[0.1, 0.003] } else { &[0.1, 0.03, 0.01, 0.003, 0.001] };
    for &thickness in thicknesses {
        let contact = format!("thickness = {thickness:?}");
        cases.push((format!("edge on edge, thickness {thickness}"), apart_edges(0.05, &contact, 0.11)));
    }
    cases.extend(degenerate(bench.quick));
    for (name, scene) in &cases {
        judge(bench, findings, name, scene)?;
    }
    coincident(bench, findings)?;
    rest(bench, findings)
}

/// Two cubes that meet at twice `speed`; that of waves in a bar is 1.
fn fast(speed: f64, step: f64) -> Scene {
    let upper = Body::block("upper", [1.0; 3], [3; 3]).at([0.2, 0.1, 1.05]).velocity([0.0, 0.0, -speed]);
    let lower = Body::cube("lower").velocity([0.0, 0.0, speed]);
    Scene::dynamic(step, 2.0).watched(1).body(upper).body(lower).general("")
}

/// A tilted cube meets another one; Young's moduli of both.
fn contrast(young: [f64; 2]) -> Scene {
    let upper = Body::cube("upper").turned([1.0, 1.0, 0.0], 20.0).at([0.2, 0.1, 1.35]).velocity([0.0, 0.0, -0.1]);
    let lower = Body::cube("lower").velocity([0.0, 0.0, 0.1]);
    Scene::dynamic(0.05, 4.0).watched(1).body(upper.young(young[0])).body(lower.young(young[1])).general("")
}

/// A small cube with edges of 0.05 meets a facet with edges of 2.
fn sizes(step: f64) -> Scene {
    let small = Body::block("small", [0.1; 3], [2; 3]).turned([1.0, 1.0, 0.0], 20.0).at([0.23, 0.11, 0.62]);
    let large = Body::block("large", [2.0, 2.0, 1.0], [1; 3]);
    Scene::dynamic(step, 4.0).watched(1).body(small.velocity([0.0, 0.0, -0.2])).body(large).general("")
}

/// Surfaces that are in no general position.
fn degenerate(quick: bool) -> Vec<(String, Scene)> {
    let approach = |scene: Scene| scene.watched(1).general("friction = 0.3");
    let down = [0.0, 0.0, -0.1];
    let up = [0.0, 0.0, 0.1];
    let aligned = Scene::dynamic(0.05, 4.0)
        .body(Body::cube("upper").at([0.0, 0.0, 1.03]).velocity(down))
        .body(Body::cube("lower").velocity(up));
    let parallel = Scene::dynamic(0.05, 4.0)
        .body(Body::cube("upper").turned([1.0, 0.0, 0.0], 45.0).at([0.0, 0.0, 1.45]).velocity(down))
        .body(Body::cube("lower").turned([1.0, 0.0, 0.0], 45.0).velocity(up));
    let (axis, degrees) = ([1.0, -1.0, 0.0], 2.0_f64.sqrt().atan().to_degrees());
    let corners = Scene::dynamic(0.05, 4.0)
        .body(Body::cube("upper").turned(axis, degrees).at([0.0, 0.0, 3.0_f64.sqrt() + 0.03]).velocity(down))
        .body(Body::cube("lower").turned(axis, degrees).velocity(up));
    let bridge = |gap: f64| {
        let beam = Body::block("beam", [2.0, 1.0, 1.0], [4, 2, 2]).at([0.5, 0.0, 1.03]).velocity(down);
        let side = Body::cube("second").at([1.0 + gap, 0.0, 0.0]).velocity([0.0, 0.0, 0.05]);
        Scene::dynamic(0.05, 4.0).body(Body::cube("first").velocity([0.0, 0.0, 0.05])).body(side).body(beam)
    };
    let slivers = |height: f64| {
        let cube = Body::cube("cube").turned([1.0, 1.0, 0.0], 12.0).at([0.13, 0.07, 0.75]).velocity([0.05, 0.0, -0.1]);
        Scene::dynamic(0.05, 4.0)
            .body(cube)
            .obstacle("slab", "surface = { file = \"slab.stl\" }", [0.0; 3])
            .file("slab.stl", slab_with_slivers(height))
    };
    let mut cases = vec![
        ("faces exactly opposite".to_owned(), approach(aligned)),
        ("edges exactly parallel".to_owned(), approach(parallel)),
        ("corner exactly on corner".to_owned(), approach(corners)),
        ("two coplanar faces, 0.005 between them, below a third".to_owned(), approach(bridge(0.005))),
        ("rigid facets with slivers of height 1e-6".to_owned(), approach(slivers(1e-6))),
    ];
    if !quick {
        cases.push(("two coplanar faces that touch below a third".to_owned(), approach(bridge(0.0))));
        cases.push(("rigid facets with slivers of height 1e-3".to_owned(), approach(slivers(1e-3))));
        cases.push(("rigid facets with slivers of height 1e-9".to_owned(), approach(slivers(1e-9))));
    }
    cases
}

/// Two halves of a body have nodes at the same places: the layer would act there all the time, so the scene is refused, by name.
fn coincident(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let name = "coincident nodes within a body";
    let half = |from: f64| {
        Hexahedra::grid([2, 2, 1], false, |[i, j, k]| [0.5 * i as f64, 0.5 * j as f64, from + 0.5 * k as f64])
    };
    let body = Body::hexahedra("halves", "halves", &half(0.0).and(&half(0.5)));
    let scene = Scene::dynamic(0.05, 1.0).body(body).body(Body::cube("other").at([0.5, 0.5, 1.6])).general("");
    let launched = run(bench, name, &scene)?;
    let code = launched.run.ending.code.map_or(f64::NAN, f64::from);
    let row = Check::new(name, "exit code: refused", code, Bound::Near { value: REFUSED, tolerance: 0.0 });
    findings.checks.push(row.noted(launched.log.lines().next().unwrap_or_default()));
    let says = f64::from(u8::from(launched.log.contains("that are not adjacent are only")));
    findings.checks.push(Check::new(name, "the message names what is wrong", says, Bound::AtLeast(1.0)));
    Ok(())
}

/// A block that is set down by statics stays where it is, with friction, without damping.
fn rest(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    const GRAVITY: f64 = 0.005;
    const STEP: f64 = 0.1;
    const SLIP: f64 = 1e-4;
    let steps = if bench.quick { 300 } else { 10_000 };
    let name = format!("at rest for {steps} steps");
    let end = 1.0 + STEP * f64::from(steps);
    let scene = Scene::dynamic(STEP, end)
        .watched(if bench.quick { 10 } else { 100 })
        .body(Body::cube("block").at([0.0, 0.0, 0.53]))
        .obstacle("plane", "shape = { kind = \"plane\", size = [4.0, 4.0] }", [0.03, 0.05, 0.0])
        .gravity(GRAVITY)
        .also("\n[[stage]]\nname = \"settle\"\nkind = \"quasi-static\"\nuntil = 1.0\nstep = 0.25\nstabilise = { fraction = 1e-3 }\n")
        .also(&format!("\n[[stage]]\nname = \"rest\"\nkind = \"dynamic\"\nuntil = {end:?}\n"))
        .probe("place", "block.all", "position")
        .general(&format!("friction = 0.3\nslip_velocity = {SLIP:?}"));
    // Kinetic energy is almost nothing: the ledger is held against the weight times the thickness of the layer, below.
    let scene = Scene { keeps_energy: false, ..scene };
    let Some(done) = judge(bench, findings, &name, &scene)? else { return Ok(()) };
    let balance = done.table("balance.csv")?;
    let (time, total) = (balance.column("time")?, balance.column("total")?);
    let settled = time.iter().zip(total).filter(|(time, _)| **time > 1.0 - 1e-9).map(|(_, total)| *total);
    let totals: Vec<f64> = settled.collect();
    let start = totals.first().copied().unwrap_or(f64::NAN);
    let change = totals.iter().map(|total| (total - start).abs()).fold(0.0, larger);
    let scale = GRAVITY * 0.02;
    let row = Check::new(&name, "change of energy over weight times thickness", change / scale, Bound::AtMost(1e-9));
    findings.checks.push(row.noted(format!("{} states from the end of the statics on", totals.len())));
    let probes = done.table("probes.csv")?;
    let time = probes.column("time")?;
    for (column, quantity) in
        [("place.x", "drift sideways over the thickness"), ("place.z", "drift upwards over the thickness")]
    {
        let all = time.iter().zip(probes.column(column)?).filter(|(time, _)| **time > 1.0 - 1e-9);
        let values: Vec<f64> = all.map(|(_, x)| *x).collect();
        let first = values.first().copied().unwrap_or(f64::NAN);
        let drift = values.iter().map(|x| (x - first).abs()).fold(0.0, larger) / 0.02;
        // Friction creeps, more slowly than the speed of slip below which it falls.
        let bound = if column == "place.x" { SLIP * STEP * f64::from(steps) / 0.02 } else { 0.05 };
        findings.checks.push(Check::new(&name, quantity, drift, Bound::AtMost(bound)));
    }
    let contact = done.table("general.csv")?;
    let (time, force) = (contact.column("time")?, contact.column("force_z")?);
    let forces: Vec<f64> =
        time.iter().zip(force).filter(|(t, _)| **t > 1.0 + 1e-9).map(|(_, f)| f.abs() / GRAVITY).collect();
    let mean = forces.iter().sum::<f64>() / forces.len() as f64;
    let worst = forces.iter().map(|f| (f - 1.0).abs()).fold(0.0, larger);
    findings.checks.push(Check::new(
        &name,
        "mean force over the weight, less one",
        (mean - 1.0).abs(),
        Bound::AtMost(1e-3),
    ));
    findings.checks.push(Check::new(
        &name,
        "largest deviation of the force from the weight",
        worst,
        Bound::AtMost(0.05),
    ));
    Ok(())
}
