//! The rotating indenter: forces and torque while it is pressed in and turned, with friction.

use std::path::Path;

use toml::{Table, Value};

use super::super::check::{Bound, Check};
use super::super::report::ReportSection;
use super::super::{Bench, Findings, newton};
use super::ITERATIONS;
use crate::plot::{self, Labels, Series};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Largest force along x and y over that along z: there is none in the continuum, by symmetry.
const ASIDE: f64 = 1e-4;
/// Quick mode: the beginning of the turn, larger steps, coarser meshes.
const QUICK_END: f64 = 1.2;
const QUICK_STEP: f64 = 0.02;
const QUICK_DIVISIONS: [[i64; 3]; 2] = [[6, 6, 4], [5, 5, 4]];

/// The shipped scene; in quick mode in larger steps on coarser meshes, to the beginning of the turn.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let run = if bench.quick {
        let scene = shortened(bench.scene("rotating-indenter")?)?;
        bench.run_variant("rotating-indenter-quick", &scene)?
    } else {
        bench.run_shipped(Path::new("scenes/rotating-indenter.toml"))?
    };
    findings.checks.push(run.completed(0));
    if !run.succeeded() {
        return Ok(());
    }
    let row =
        |quantity: &str, value: f64, bound: Bound| Check::new(&run.name, quantity, value, bound).noted(run.note());
    let steps = run.newton()?;
    findings.checks.push(row("iterations a step", newton::mean_iterations(&steps), Bound::AtMost(ITERATIONS)));
    findings.checks.push(row("step cuts", run.summary_number("cuts")?, Bound::Unbounded));
    findings.checks.push(run.coverage()?);
    let probes = run.table("probes.csv")?;
    let time = probes.column("time")?;
    let force = probes.vectors(["force.x", "force.y", "force.z"])?;
    let moment = probes.vectors(["moment.x", "moment.y", "moment.z"])?;
    let (Some(last), Some(turn)) = (force.last(), moment.last()) else {
        return Err("no row in probes.csv".into());
    };
    let aside = force.iter().map(|f| f[0].abs().max(f[1].abs())).fold(0.0, larger) / last[2].abs();
    findings.checks.push(row("force along x and y over that along z", aside, Bound::AtMost(ASIDE)));
    findings.checks.push(row("vertical force at the end", last[2], Bound::AtMost(0.0)));
    findings.checks.push(row("torque at the end", turn[2], Bound::AtLeast(0.0)));
    // Friction can carry no more than mu times the force, at the outermost node.
    let arm = turn[2] / last[2].abs();
    findings.checks.push(row(
        "torque over the force, at most mu times the half diagonal",
        arm,
        Bound::AtMost(2.0_f64.sqrt()),
    ));
    let rising: Vec<f64> = time.iter().zip(&moment).filter(|(t, _)| **t >= 1.0).map(|(_, m)| m[2]).collect();
    let falls = rising.windows(2).filter(|w| w[1] < w[0]).count();
    findings.checks.push(row("steps of the turn in which the torque falls", falls as f64, Bound::AtMost(0.0)));
    let lines = ["x", "y", "z"]
        .iter()
        .enumerate()
        .map(|(i, name)| Series::new(&format!("F{name}"), time, force.iter().map(move |f| f[i])));
    let torque = Series::new("Mz", time, moment.iter().map(|m| m[2]));
    findings.sections.push(ReportSection {
        title: "Rotating indenter".into(),
            reading: "An indenter is pressed into a block and turned about its axis. The horizontal forces must vanish by symmetry, and the torque reaches its plateau when all of the face slips.".into(),
        figures: vec![
            plot::linear(
                Labels { title: "forces on the indenter's top", x: "time", y: "" },
                &lines.collect::<Vec<_>>(),
            ),
            plot::linear(Labels { title: "torque about the axis", x: "time", y: "" }, &[torque]),
        ],
        tables: Vec::new(),
    });
    bench.show(&run, findings);
    Ok(())
}

fn shortened(mut scene: Table) -> Outcome<Table> {
    scene.remove("expect");
    let time = scene.get_mut("time").and_then(Value::as_table_mut).ok_or("the scene has no [time]")?;
    time.insert("end".into(), QUICK_END.into());
    time.insert("step".into(), QUICK_STEP.into());
    let bodies = scene.get_mut("body").and_then(Value::as_array_mut).ok_or("the scene has no bodies")?;
    for (body, divisions) in bodies.iter_mut().zip(QUICK_DIVISIONS) {
        let mesh = body.get_mut("mesh").and_then(Value::as_table_mut).ok_or("a body has no mesh")?;
        mesh.insert("divisions".into(), divisions.to_vec().into());
    }
    Ok(scene)
}
