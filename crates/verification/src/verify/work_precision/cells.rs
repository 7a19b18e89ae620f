//! Work and precision of the cells: a bar that bends in statics, and a bar that hits a wall.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;

use stoss_fe_solid::{SolidOptions, Volumetric};
use stoss_materials::NeoHooke;
use stoss_mesh::generate::Block;
use stoss_reference_element::{CellKind, Integration};

use super::{LEVEL, REFERENCE_SHARE};
use crate::plot::{self, Labels, Series};
use crate::verify::Findings;
use crate::verify::check::{Bound, Check, number};
use crate::verify::curve::{Curve, Point, relative_distance, timed};
use crate::verify::elements::equilibrium::{Equilibrium, Load};
use crate::verify::elements::manufactured::{RATES, at_points};
use crate::verify::elements::{keys, name};
use crate::verify::facade;
use crate::verify::report::{Grid, ReportSection};
use crate::workspace::Outcome;

/// Errors at which costs are reported.
const TARGETS: [f64; 3] = [3e-2, 1e-2, 1e-3];
/// Force per volume of the bending bar; it bends by a third of its height.
const FORCE: f64 = 0.01;

/// A run: what is compared, CPU seconds, unknowns.
type Run = (Vec<f64>, f64, usize);

/// A bar of 4 x 1 x 1, half of its width modelled, between planes of symmetry at its ends, under the forces `FORCE cos(pi x / 4)` across it, whose sum is zero:
/// displacements at 30 points that are nodes of every mesh. `n` elements a unit of length, twice as many across. The solution is smooth.
fn bending((kind, integration): (CellKind, Integration), n: usize) -> Outcome<Run> {
    let mesh = Block::new([0.0; 3], [4.0, 0.5, 1.0], [4 * n, n, 2 * n]).generate()?.with_cells(kind)?;
    let options = SolidOptions { integration, volumetric: Volumetric::Displacement };
    let law = std::sync::Arc::new(NeoHooke::from_young_poisson(1.0, 0.3)?);
    let is = |x: f64, at: f64| (x - at).abs() < 1e-9;
    // The support of the corner has no force.
    let held =
        |x: [f64; 3]| [is(x[0], 0.0) || is(x[0], 4.0), is(x[1], 0.0), is(x[0], 0.0) && is(x[1], 0.0) && is(x[2], 0.0)];
    let problem = Equilibrium::new(mesh, law, options, held, Vec::new())?;
    let mut forces = vec![0.0; 3 * problem.mesh.nodes.len()];
    at_points(&problem.mesh, |nodes, weight, x, shape, _| {
        for (node, shape) in nodes.iter().zip(shape) {
            forces[3 * *node as usize + 2] += weight * shape * FORCE * (FRAC_PI_4 * x[0]).cos();
        }
    });
    let (q, seconds) = timed(|| -> Outcome<_> {
        let mut q = problem.reference();
        let solves = problem.solve(&mut q, Load { forces: &forces, pressure: 0.0 })?;
        solves.map(|_| q).ok_or_else(|| "Newton's iteration does not end".into())
    })?;
    let mut common = BTreeMap::new();
    for (node, x) in problem.mesh.nodes.iter().enumerate() {
        let place = [x[0], 2.0 * x[1], 2.0 * x[2]];
        if place.iter().all(|x| is(*x, x.round())) {
            common.insert(place.map(|x| x.round() as i64), [0, 1, 2].map(|i| q[3 * node + i] - x[i]));
        }
    }
    Ok((common.into_values().flatten().collect(), seconds, problem.unknowns()))
}

/// A bar of 1 x 1 x 2, a quarter of which is modelled, hits a rigid wall with a thirtieth of its wave speed and leaves it: the way of its centre of mass after every step. `n`
/// elements across the quarter.
fn impact((kind, integration): (CellKind, Integration), n: usize) -> Outcome<Run> {
    let support = |set: &str, components: &str| {
        format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [{components}]\nfixed = true\n")
    };
    let text = format!(
        "[scene]\ntitle = \"bar against a wall\"\nkind = \"dynamic\"\n[time]\nend = 0.2\nstep = 0.004\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
         [[body]]\nname = \"bar\"\n{}material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\ndensity = 1.0\nvelocity = [0, 0, -1]\n\
         mesh = {{ generator = \"block\", min = [0, 0, 0.01], max = [0.5, 0.5, 2.01], divisions = [{n}, {n}, {}] }}\n\
         [[body]]\nname = \"wall\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\ndensity = 1.0\n\
         mesh = {{ generator = \"block\", min = [-1, -1, -1], max = [2, 2, 0], divisions = [1, 1, 1] }}\n\
         [[contact]]\nmethod = \"mortar\"\nclosing = \"keep\"\nslave = \"bar.bottom\"\nmaster = \"wall.top\"\n{}{}{}",
        keys(kind, integration),
        4 * n,
        support("wall.all", "\"x\", \"y\", \"z\""),
        support("bar.left", "\"x\""),
        support("bar.front", "\"y\""),
    );
    let mut unknowns = 0;
    let (way, seconds) = timed(|| -> Outcome<_> {
        let mut simulation = facade::simulation(&text)?;
        let mut momentum = simulation.balance().linear_momentum[2];
        let (mut way, mut place, mut time) = (Vec::new(), 0.0, 0.0);
        // Speed and mass of the quarter.
        let mass = -momentum;
        while !simulation.finished() {
            simulation.advance()?;
            let (now, at) = (simulation.balance().linear_momentum[2], simulation.state().time);
            place += 0.5 * (momentum + now) / mass * (at - time);
            way.push(place);
            (momentum, time) = (now, at);
        }
        unknowns = simulation.equations();
        Ok(way)
    })?;
    Ok((way, seconds, unknowns))
}

/// A problem.
struct Problem {
    name: &'static str,
    about: &'static str,
    run: fn((CellKind, Integration), usize) -> Outcome<Run>,
    /// Elements of linear and of quadratic cells.
    levels: [&'static [usize]; 2],
    /// Elements of hex27 of the reference and of the mesh that tells its error.
    reference: [usize; 2],
    /// Smallest target that the reference can tell.
    least_target: f64,
    /// Whether the solution is smooth, so that the errors fall with the rates of theory.
    smooth: bool,
}

const PROBLEMS: [Problem; 2] = [
    Problem {
        name: "cells, bending",
        about: "Neo-Hooke bar 4 x 1 x 1 that bends by a third of its height, smooth; relative error of the displacements at 30 points",
        run: bending,
        levels: [&[2, 4, 6], &[1, 2, 3]],
        reference: [5, 4],
        least_target: 1e-3,
        smooth: true,
    },
    Problem {
        name: "cells, impact",
        about: "Neo-Hooke bar 1 x 1 x 2 that hits a rigid wall, energy-momentum, 50 steps, mortar; relative error of the way of its centre of mass",
        run: impact,
        levels: [&[1, 2, 4], &[1, 2]],
        reference: [3, 2],
        least_target: 1e-2,
        smooth: false,
    },
];

/// All cells on both problems; not in quick mode.
pub fn measure(findings: &mut Findings) -> Outcome<()> {
    PROBLEMS.iter().try_for_each(|problem| compare(problem, findings))
}

fn compare(problem: &Problem, findings: &mut Findings) -> Outcome<()> {
    let fine = |n| Ok::<_, Box<dyn std::error::Error>>((problem.run)((CellKind::Hex27, Integration::Full), n)?.0);
    let (reference, coarser) = (fine(problem.reference[0])?, fine(problem.reference[1])?);
    let own = relative_distance(&coarser, &reference);
    let note = format!("hex27, n = {}; against n = {}", problem.reference[0], problem.reference[1]);
    let bound = Bound::AtMost(REFERENCE_SHARE * problem.least_target);
    findings.checks.push(Check::new(problem.name, "error of the reference", own, bound).noted(note.clone()));
    let (mut curves, mut rows) = (Vec::new(), Vec::new());
    for cell in CellKind::with_rules() {
        let mut curve = Curve { scheme: name(cell.0, cell.1), ..Curve::default() };
        for &n in problem.levels[usize::from(cell.0.is_quadratic())] {
            let (found, seconds, unknowns) = match (problem.run)(cell, n) {
                Ok(run) => run,
                Err(error) => {
                    curve.failures.push(format!("n = {n}: {error}"));
                    continue;
                }
            };
            let error = relative_distance(&found, &reference);
            rows.push(vec![
                curve.scheme.clone(),
                n.to_string(),
                unknowns.to_string(),
                format!("{error:.1e}"),
                format!("{seconds:.1e}"),
            ]);
            // Sizes of elements in place of steps, unknowns in that of evaluations.
            let size = 1.0 / n as f64;
            curve.points.push(Point { dt: size, error, of_dissipation: None, seconds, evaluations: unknowns as u64 });
        }
        let mut check = |quantity: &str, value: f64, bound: Bound, note: String| {
            let scene = format!("{}, {}", problem.name, curve.scheme);
            findings.checks.push(Check::new(&scene, quantity, value, bound).noted(note));
        };
        let failed = curve.failures.len() as f64;
        check("runs without a result", failed, Bound::AtMost(0.0), curve.failures.join("; "));
        let errors: Vec<String> = curve.points.iter().map(|p| format!("{:.1e}", p.error)).collect();
        let rate = curve.order(0.0).unwrap_or(f64::NAN);
        let least = RATES[usize::from(cell.0.is_quadratic())];
        let bound = if problem.smooth { Bound::AtLeast(least) } else { Bound::Unbounded };
        check("rate of the two finest meshes", rate, bound, format!("errors {}", errors.join(", ")));
        curves.push(curve);
    }
    let series = |x: fn(&Point) -> f64| -> Vec<Series> {
        let line =
            |c: &Curve| Series { name: c.scheme.clone(), points: c.points.iter().map(|p| (x(p), p.error)).collect() };
        curves.iter().map(line).collect()
    };
    let chart = |title: &str, x: &str, lines: Vec<Series>| {
        plot::log_log(Labels { title, x, y: "relative error" }, &lines, Some(1e-9), &[-1.0, -2.0])
    };
    let targets: Vec<f64> = TARGETS.into_iter().filter(|target| *target >= problem.least_target).collect();
    let costs = |c: &Curve| {
        let seconds = targets.iter().map(|t| c.seconds_to(*t).map_or_else(|| "-".to_owned(), |s| format!("{s:.1e}")));
        std::iter::once(c.scheme.clone()).chain(seconds).collect()
    };
    let cheapest = |target: f64| {
        let mut reached: Vec<(f64, &str)> =
            curves.iter().filter_map(|c| Some((c.seconds_to(target)?, c.scheme.as_str()))).collect();
        reached.sort_by(|a, b| a.0.total_cmp(&b.0));
        let least = reached.first().map_or(f64::NAN, |r| r.0);
        let names: Vec<&str> = reached.iter().filter(|r| r.0 <= LEVEL * least).map(|r| r.1).collect();
        format!("at {target:.0e}: {}", if names.is_empty() { "none".to_owned() } else { names.join(", ") })
    };
    let sentence: Vec<String> = targets.iter().map(|target| cheapest(*target)).collect();
    let caption = format!(
        "{}. Reference: {note}, its own error {}. Cheapest, and what is within {LEVEL} times of it, {}.",
        problem.about,
        number(own),
        sentence.join("; ")
    );
    let head = std::iter::once("cell".to_owned()).chain(targets.iter().map(|t| format!("CPU s to {t:.0e}"))).collect();
    let runs = ["cell", "n", "unknowns", "error", "CPU s"].map(str::to_owned).to_vec();
    findings.sections.push(ReportSection {
        title: format!("work and precision: {}", problem.name),
        reading: "Error against CPU time and against unknowns, a line for each cell, a point for each mesh. The lower left is best; the slope is the order of the cell.".into(),
        figures: vec![
            chart("work", "CPU seconds", series(|p| p.seconds)),
            chart("unknowns", "unknowns", series(|p| p.evaluations as f64)),
        ],
        tables: vec![
            Grid { caption, head, rows: curves.iter().map(costs).collect() },
            Grid { caption: "Runs".into(), head: runs, rows },
        ],
    });
    Ok(())
}
