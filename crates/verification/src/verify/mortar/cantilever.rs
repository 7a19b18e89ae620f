//! Order of a cantilever that is tied in the middle, against that of one body.

use stoss_reference_cases::cantilever::{Field, cantilever, error, field};

use super::super::check::{Bound, Check, number};
use super::super::report::{Grid, ReportSection};
use super::super::{Bench, Findings, facade};
use crate::plot::{self, Labels, Series};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Least order that counts as two.
const ORDER: f64 = 1.9;
/// Largest distance from the order of one body.
const SAME: f64 = 0.1;

/// Elements a unit length: of the halves of the tied one that have them, and of the other halves.
const COARSEST: [usize; 2] = [2, 3];

fn solve(text: &str) -> Outcome<Vec<Field>> {
    let mut simulation = facade::simulation(text)?;
    facade::run(&mut simulation)?;
    let (x, q) = (&simulation.model().reference, &simulation.state().q);
    Ok(simulation.model().bodies.iter().map(|body| field(body.nodes.clone(), x, q)).collect())
}

/// Errors of both meshes and their orders.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    // A reference that is twelve times as fine as the coarsest mesh would spoil the order of a third level.
    let (finest, levels): (usize, &[usize]) = if bench.quick { (24, &[1, 2]) } else { (48, &[1, 2, 4]) };
    let reference = solve(&cantilever(&[finest], ""))?.remove(0);
    let size = reference.values().map(|u| u[0].hypot(u[1])).fold(0.0, larger);
    let forms = [
        ("matching mesh", ""),
        ("finer half slave, standard", "slave = \"b1.left\"\nmaster = \"b0.right\""),
        (
            "coarser half slave, dual",
            "slave = \"b0.right\"\nmaster = \"b1.left\"\nmultipliers = \"dual\"\nform = \"frame-invariant\"",
        ),
    ];
    let (mut lines, mut rows, mut matching) = (Vec::new(), Vec::new(), f64::NAN);
    for (name, tie) in forms {
        let mut errors = Vec::new();
        for k in levels {
            let all = COARSEST.map(|n| n * k);
            let parts = if tie.is_empty() { &all[..1] } else { &all[..] };
            errors.push(error(&solve(&cantilever(parts, tie))?, parts, &reference) / size);
        }
        let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        let last = orders.last().copied().unwrap_or(f64::NAN);
        let scene = format!("cantilever, {name}");
        let note = format!("errors {}", errors.iter().map(|e| number(*e)).collect::<Vec<_>>().join(", "));
        if tie.is_empty() {
            matching = last;
            findings.checks.push(Check::new(&scene, "order of the displacement", last, Bound::Unbounded).noted(note));
        } else {
            let bound = Bound::AtLeast(ORDER);
            findings.checks.push(Check::new(&scene, "order of the displacement", last, bound).noted(note));
            let near = Bound::Near { value: matching, tolerance: SAME };
            findings.checks.push(Check::new(&scene, "order against that of the matching mesh", last, near));
        }
        let steps: Vec<f64> = levels.iter().map(|k| 1.0 / (COARSEST[0] * k) as f64).collect();
        rows.push(std::iter::once(name.to_owned()).chain(errors.iter().map(|e| number(*e))).collect());
        lines.push(Series::new(name, &steps, errors));
    }
    let labels = Labels { title: "error of the nodes' displacement", x: "element length", y: "" };
    let head = ["mesh".to_owned()].into_iter().chain(levels.iter().map(|k| format!("1/{}", COARSEST[0] * k)));
    findings.sections.push(ReportSection {
        title: "Tied cantilever".into(),
            reading: "A cantilever of two meshes that do not match, tied by the mortar method, against one mesh. Right if the tie costs no order: all lines have slope 2.".into(),
        figures: vec![plot::log_log(labels, &lines, None, &[2.0])],
        tables: vec![Grid { caption: "Error over the largest displacement".into(), head: head.collect(), rows }],
    });
    Ok(())
}
