//! Deep ironing with friction in few large steps, either side as the slave, on three meshes of the slab and a fourth where three are not enough: effort, and
//! the force along over that across.

use toml::{Table, Value};

use super::super::check::{Bound, Check, number};
use super::super::report::{Grid, ReportSection};
use super::super::{Bench, Findings, Run};
use super::{entry, resistance};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Meshes of the slab.
const SLABS: [[i64; 3]; 3] = [[20, 5, 3], [27, 12, 6], [36, 16, 8]];
/// One more where the slab lies against the block's sides.
const FINEST: [i64; 3] = [48, 20, 10];
/// When full slip has been reached.
const STEADY: f64 = 14.0;
/// Iterations a step.
const ITERATIONS: f64 = 5.0;
/// Change of the ratio from the last mesh but one to the last, relative.
const CONVERGED: f64 = 0.005;
/// Change of that ratio where the slab is the slave and lies against the block's sides.
const CONVERGED_SLAB: f64 = 0.02;
/// Stiffness there of the springs of stick.
const SPRINGS: f64 = 1.0;

/// The block as the slave, the slab as the slave before the block's lower face, and before its sides as well.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    if bench.quick {
        return Ok(());
    }
    let mut rows = Vec::new();
    let mut ratios = Vec::new();
    let block = bench.scene("ironing-mortar-deep-block")?;
    for slab in SLABS {
        let run = bench.run_variant(&format!("deep-block-{}", slab[0]), &on_slab(&block, slab)?)?;
        findings.checks.push(run.completed(0));
        if let Some(ratio) =
            judge(&run, "block", slab, Bound::AtMost(0.0), Bound::AtMost(ITERATIONS), findings, &mut rows)?
        {
            ratios.push(ratio);
        }
    }
    convergence("deep-block-36", &ratios, CONVERGED, findings);
    let deep = bench.scene("ironing-mortar-deep")?;
    let run = bench.run_variant("deep-slab-20", &on_slab(&deep, SLABS[0])?)?;
    findings.checks.push(run.completed(0));
    judge(&run, "slab", SLABS[0], Bound::AtMost(0.0), Bound::AtMost(ITERATIONS), findings, &mut rows)?;
    ratios.clear();
    for slab in SLABS.into_iter().chain([FINEST]) {
        let scene = before_sides(&on_slab(&deep, slab)?)?;
        let run = bench.run_variant(&format!("deep-slab-sides-{}", slab[0]), &scene)?;
        findings.checks.push(run.completed(0));
        // The finer the slab, the more of its nodes come and go under the block in a step.
        let iterations = if slab == SLABS[0] { Bound::AtMost(ITERATIONS) } else { Bound::Unbounded };
        let what = "slab, sides are master too";
        ratios.extend(judge(&run, what, slab, Bound::AtMost(0.0), iterations, findings, &mut rows)?);
    }
    convergence("deep-slab-sides-48", &ratios, CONVERGED_SLAB, findings);
    // What soft springs take from the friction.
    for slab in &SLABS[..2] {
        let mut scene = before_sides(&on_slab(&deep, *slab)?)?;
        friction(&mut scene)?.remove("penalty");
        let run = bench.run_variant(&format!("deep-slab-sides-exact-{}", slab[0]), &scene)?;
        findings.checks.push(run.completed(0));
        judge(
            &run,
            "slab, sides are master too, exact stick",
            *slab,
            Bound::Unbounded,
            Bound::Unbounded,
            findings,
            &mut rows,
        )?;
    }
    let head = [
        "slave",
        "slab",
        "steps",
        "cuts",
        "iterations a step",
        "CPU seconds",
        "Fx over Fz",
        "largest distance from it",
    ];
    findings.sections.push(ReportSection {
        title: "Deep ironing with friction, 7 steps down and 15 along".into(),
            reading: "The ratio of the horizontal to the vertical force while the block slides, against its value on finer slabs. Right if it settles as the mesh is refined; steps and iterations tell what the depth costs.".into(),
        figures: Vec::new(),
        tables: vec![Grid {
            caption: format!(
                "Depth 0.7, coefficient 0.5; mean of the ratio from t = {STEADY}. With the sides in the master the friction there is part of it, the more the finer \
                 the slab, which lies against them. Springs of {SPRINGS} hold the full friction only after a slip of 0.75: exact stick gives more, and the more the finer"
            ),
            head: head.map(str::to_owned).to_vec(),
            rows,
        }],
    });
    Ok(())
}

/// The change of the ratio of the forces from the last mesh but one to the last; those before are reported.
fn convergence(name: &str, ratios: &[f64], bound: f64, findings: &mut Findings) {
    let changes: Vec<f64> = ratios.windows(2).map(|pair| (pair[1] / pair[0] - 1.0).abs()).collect();
    let [before @ .., last] = &changes[..] else { return };
    let quantity = "Fx over Fz: change from the last mesh but one to the last";
    let before: Vec<String> = before.iter().map(|change| number(*change)).collect();
    let note = format!("changes before it: {}", before.join(", "));
    findings.checks.push(Check::new(name, quantity, *last, Bound::AtMost(bound)).noted(note));
}

/// Checks and the table's row of a run; the mean ratio of the forces.
fn judge(
    run: &Run,
    slave: &str,
    slab: [i64; 3],
    cuts: Bound,
    iterations: Bound,
    findings: &mut Findings,
    rows: &mut Vec<Vec<String>>,
) -> Outcome<Option<f64>> {
    if !run.succeeded() {
        return Ok(None);
    }
    let [steps, cut, mean, cpu] = [
        run.summary_number("steps")?,
        run.summary_number("cuts")?,
        run.summary_number("mean_iterations")?,
        run.summary_number("cpu_seconds")?,
    ];
    let ratio = resistance(run, STEADY)?;
    let average = ratio.iter().sum::<f64>() / ratio.len() as f64;
    let apart = ratio.iter().map(|r| (r - average).abs()).fold(0.0, larger);
    let row =
        |quantity: &str, value: f64, bound: Bound| Check::new(&run.name, quantity, value, bound).noted(run.note());
    findings.checks.push(row("step cuts", cut, cuts));
    findings.checks.push(row("iterations a step", mean, iterations));
    findings.checks.push(
        row("Fx over Fz", average, Bound::Unbounded)
            .noted(format!("mean from t = {STEADY}; at most {} from it", number(apart))),
    );
    findings.checks.push(run.coverage()?);
    rows.push(vec![
        slave.to_owned(),
        slab.map(|n| n.to_string()).join(" x "),
        number(steps),
        number(cut),
        number(mean),
        number(cpu),
        number(average),
        number(apart),
    ]);
    Ok(Some(average))
}

fn on_slab(scene: &Table, slab: [i64; 3]) -> Outcome<Table> {
    let mut scene = scene.clone();
    scene.remove("expect");
    let mesh = entry(&mut scene, "body", 1)?.get_mut("mesh").and_then(Value::as_table_mut);
    mesh.ok_or("the slab has no mesh")?.insert("divisions".into(), slab.to_vec().into());
    Ok(scene)
}

fn friction(scene: &mut Table) -> Outcome<&mut Table> {
    let friction = entry(scene, "contact", 0)?.get_mut("friction").and_then(Value::as_table_mut);
    Ok(friction.ok_or("the contact has no friction")?)
}

/// The lower face of the block and its sides as one master surface.
fn before_sides(scene: &Table) -> Outcome<Table> {
    let mut scene = scene.clone();
    let set: Table = "name = \"indenter.shoe\"\nbody = \"indenter\"\n\
                      box = { min = [-inf, -inf, 2.9], max = [inf, inf, 3.76] }"
        .parse()?;
    scene.insert("set".into(), Value::Array(vec![Value::Table(set)]));
    let contact = entry(&mut scene, "contact", 0)?;
    contact.insert("master".into(), "indenter.shoe".into());
    friction(&mut scene)?.insert("penalty".into(), SPRINGS.into());
    Ok(scene)
}
