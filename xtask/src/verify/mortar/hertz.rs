//! Hertz: radius and largest pressure of the contact of a cylinder and a block, and of a ball and a rigid plane, against the closed forms.

use std::f64::consts::PI;
use std::path::Path;

use toml::{Table, Value};

use super::super::check::{Bound, Check, number};
use super::super::report::{Grid, Section};
use super::super::{Bench, Findings, Run, newton};
use crate::plot::{self, Labels, Series};
use crate::vtu::Grid as Frame;
use crate::workspace::Outcome;

/// Largest relative error of radius and pressure on the shipped mesh, which has at most 20 elements across the contact.
const CLOSE: f64 = 0.02;
const MODULUS: f64 = 1000.0;
const POISSON: f64 = 0.3;
const RADIUS: f64 = 1.0;
/// Extent of the shipped cylinder along its axis.
const LENGTH: f64 = 0.01;
/// Nodes with less than this part of the largest pressure are no part of the fit: the edge cuts through their facets.
const FITTED: f64 = 0.5;

/// What touches what.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    /// A cylinder and a block of one material.
    Line,
    /// An eighth of a ball and a rigid plane.
    Point,
}

impl Shape {
    /// Radius of the contact and largest pressure under the force that the probe tells, which is that on the modelled part.
    fn analytic(self, force: f64) -> (f64, f64) {
        let plane_strain = MODULUS / (1.0 - POISSON * POISSON);
        match self {
            Shape::Line => {
                // Half of the force a length; both bodies yield.
                let line = 2.0 * force / LENGTH;
                let a = (4.0 * line * RADIUS / (PI * 0.5 * plane_strain)).sqrt();
                (a, 2.0 * line / (PI * a))
            }
            Shape::Point => {
                let whole = 4.0 * force;
                let a = (0.75 * whole * RADIUS / plane_strain).cbrt();
                (a, 1.5 * whole / (PI * a * a))
            }
        }
    }
}

/// Radius and largest pressure by the line through `p^2` over `r^2`, `p^2 = p0^2 (1 - r^2 / a^2)`, least squares.
fn fit(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let largest = points.iter().map(|(_, p)| *p).fold(0.0, f64::max);
    let fitted: Vec<(f64, f64)> =
        points.iter().filter(|(_, p)| *p >= FITTED * largest).map(|(r, p)| (r * r, p * p)).collect();
    let n = fitted.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| fitted.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|v| v.0), mean(&|v| v.1));
    let (xx, xy) = (mean(&|v| (v.0 - x).powi(2)), mean(&|v| (v.0 - x) * (v.1 - y)));
    let slope = xy / xx;
    let start = y - slope * x;
    (slope < 0.0 && start > 0.0).then(|| ((-start / slope).sqrt(), start.sqrt()))
}

/// Distance from the axis and pressure of the slave nodes that carry; the slave is the first body. Of a cylinder the nodes of one end.
fn pressures(frame: &Frame, shape: Shape) -> Outcome<Vec<(f64, f64)>> {
    let field = |name: &str| frame.point_data.get(name).ok_or_else(|| format!("no field {name} in the frame"));
    let (pressure, displacement) = (field("contact_pressure")?, field("displacement")?);
    let bodies = frame.cell_data.get("body").ok_or("no numbers of bodies in the frame")?;
    let mut of_slave = vec![false; frame.points.len()];
    for (cell, body) in frame.hexahedra.iter().zip(&bodies.values) {
        cell.iter().for_each(|&node| of_slave[node] |= *body == 0.0);
    }
    let carries = |n: &usize| of_slave[*n] && pressure.values[*n] > 0.0;
    let mut found: Vec<(f64, f64)> = (0..frame.points.len())
        .filter(carries)
        .filter(|&n| shape == Shape::Point || frame.points[n][1] == 0.0)
        .map(|n| {
            let x = |i: usize| frame.points[n][i] + displacement.row(n)[i];
            let r = if shape == Shape::Line { x(0).abs() } else { x(0).hypot(x(1)) };
            (r, pressure.values[n])
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(found)
}

/// The line on three meshes (quick: the shipped one), the point on two in full mode.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let mut rows = Vec::new();
    let mut lines = Vec::new();
    let mut curve =
        |run: &Run, shape: Shape, across: usize, bound: Bound, findings: &mut Findings| -> Outcome<Option<[f64; 2]>> {
            let Some(found) = hertz(run, shape, bound, findings)? else { return Ok(None) };
            rows.push(found.row(&run.name, across));
            lines.push(found.series(&format!("{}, {across} elements", run.name)));
            Ok(Some(found.errors))
        };
    let cylinder = bench.scene("hertz-cylinder")?;
    let close = Bound::AtMost(CLOSE);
    if !bench.quick {
        let mut errors = Vec::new();
        for elements in [3_i64, 6] {
            let name = format!("hertz-cylinder-{elements}");
            let run = bench.run_variant(&name, &variant(&cylinder, elements)?)?;
            errors.push(curve(&run, Shape::Line, across(elements), Bound::Told, findings)?);
        }
        let run = bench.run_shipped(Path::new("scenes/hertz-cylinder.toml"))?;
        errors.push(curve(&run, Shape::Line, across(12), close, findings)?);
        falls("hertz-cylinder", &errors, findings);
        bench.show(&run, findings)?;
        let ball = bench.scene("hertz-ball")?;
        let run = bench.run_variant("hertz-ball-4", &variant(&ball, 4)?)?;
        let coarse = curve(&run, Shape::Point, across(4), Bound::Told, findings)?;
        let run = bench.run_shipped(Path::new("scenes/hertz-ball.toml"))?;
        let fine = curve(&run, Shape::Point, across(8), close, findings)?;
        falls("hertz-ball", &[coarse, fine], findings);
    } else {
        let run = bench.run_shipped(Path::new("scenes/hertz-cylinder.toml"))?;
        curve(&run, Shape::Line, across(12), close, findings)?;
    }
    let head = [
        "run",
        "elements across",
        "force",
        "radius / analytic",
        "largest pressure / analytic",
        "largest of a node / analytic",
        "outermost node / analytic",
    ];
    findings.sections.push(Section {
        title: "Hertz".into(),
        figures: vec![plot::linear(Labels { title: "pressure", x: "distance from the axis / a", y: "p / p0" }, &lines)],
        tables: vec![Grid {
            caption: "Radius a and largest pressure p0 from the straight line through p^2 over r^2 (slave nodes with more than half of the largest \
                      pressure), over the closed forms for the force that the support tells"
                .into(),
            head: head.map(str::to_owned).to_vec(),
            rows,
        }],
    });
    Ok(())
}

/// Elements of the shipped scenes over the contact's width: the contact has 5/6 of the refined zone's.
fn across(elements: i64) -> usize {
    (2.0 * 5.0 / 6.0 * elements as f64).round() as usize
}

/// The finest mesh is better than the coarsest, in both quantities together.
fn falls(name: &str, errors: &[Option<[f64; 2]>], findings: &mut Findings) {
    let sum = |e: &Option<[f64; 2]>| e.map(|[a, p]| a + p);
    if let (Some(Some(coarse)), Some(Some(fine))) = (errors.first().map(sum), errors.last().map(sum)) {
        let row = Check::new(
            name,
            "errors of radius and pressure, finest over coarsest mesh",
            fine / coarse,
            Bound::AtMost(0.5),
        );
        findings.checks.push(row);
    }
}

/// What was read off a run.
struct Found {
    force: f64,
    /// Over the closed forms: radius and pressure of the fit, largest pressure of a node, outermost node that carries.
    ratios: [f64; 4],
    errors: [f64; 2],
    points: Vec<(f64, f64)>,
}

impl Found {
    fn row(&self, name: &str, across: usize) -> Vec<String> {
        let mut row = vec![name.to_owned(), across.to_string(), number(self.force)];
        row.extend(self.ratios.iter().map(|ratio| format!("{ratio:.4}")));
        row
    }

    fn series(&self, name: &str) -> Series {
        let r: Vec<f64> = self.points.iter().map(|p| p.0).collect();
        Series::new(name, &r, self.points.iter().map(|p| p.1))
    }
}

/// Rows of a run.
fn hertz(run: &Run, shape: Shape, bound: Bound, findings: &mut Findings) -> Outcome<Option<Found>> {
    findings.checks.push(run.completed(0));
    if !run.succeeded() {
        return Ok(None);
    }
    let probes = run.table("probes.csv")?;
    let force = probes.column("force.z")?.last().copied().ok_or("no row in probes.csv")?;
    let (a, p0) = shape.analytic(force);
    let points = pressures(&run.last_frame()?, shape)?;
    let Some((radius, peak)) = fit(&points) else {
        findings.checks.push(Check::new(&run.name, "nodes to fit", points.len() as f64, Bound::AtLeast(3.0)));
        return Ok(None);
    };
    let largest = points.iter().map(|p| p.1).fold(0.0, f64::max);
    let edge = points.last().map_or(f64::NAN, |p| p.0);
    let ratios = [radius / a, peak / p0, largest / p0, edge / a];
    let errors = [(ratios[0] - 1.0).abs(), (ratios[1] - 1.0).abs()];
    let note = format!("a = {}, p0 = {} for the force {}", number(a), number(p0), number(force));
    let mut row = |quantity: &str, value: f64, bound: Bound| {
        findings.checks.push(Check::new(&run.name, quantity, value, bound).noted(note.clone()));
    };
    row("error of the contact radius (Hertz)", errors[0], bound);
    row("error of the largest pressure (Hertz), fitted", errors[1], bound);
    row("error of the largest pressure (Hertz) of a node", (ratios[2] - 1.0).abs(), bound);
    row("outermost node that carries, over the radius", ratios[3], Bound::Told);
    row("iterations a step", newton::mean_iterations(&run.newton()?), Bound::Told);
    row("step cuts", run.summary_number("cuts")?, Bound::Told);
    let points = points.iter().map(|(r, p)| (r / a, p / p0)).collect();
    Ok(Some(Found { force, ratios, errors, points }))
}

/// The scene with another number of elements over the refined zone, all others in the same ratio.
fn variant(scene: &Table, elements: i64) -> Outcome<Table> {
    let mut scene = scene.clone();
    scene.remove("expect");
    let bodies = scene.get_mut("body").and_then(Value::as_array_mut).ok_or("the scene has no bodies")?;
    let meshes: Vec<&mut Table> =
        bodies.iter_mut().filter_map(|body| body.get_mut("mesh").and_then(Value::as_table_mut)).collect();
    let mut scale = None;
    for mesh in meshes {
        if let Some(zone) = mesh.get_mut("refinement").and_then(Value::as_table_mut) {
            let shipped = zone.get("elements").and_then(Value::as_integer).ok_or("a refinement without elements")?;
            zone.insert("elements".into(), elements.into());
            scale = Some(elements as f64 / shipped as f64);
        }
        let scale = scale.ok_or("the first body has no refinement")?;
        let divisions = mesh.get_mut("divisions").and_then(Value::as_array_mut).ok_or("a mesh without divisions")?;
        for number in divisions.iter_mut() {
            let shipped = number.as_integer().ok_or("a division that is no whole number")?;
            *number = ((scale * shipped as f64).ceil().max(1.0) as i64).into();
        }
    }
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_finds_an_exact_half_ellipse() {
        let points: Vec<(f64, f64)> =
            (0..10).map(|k| 0.1 * f64::from(k)).map(|r| (r, 3.0 * (1.0 - r * r / 0.9025).max(0.0).sqrt())).collect();
        let (a, p0) = fit(&points).unwrap();
        assert!((a - 0.95).abs() < 1e-12 && (p0 - 3.0).abs() < 1e-12, "{a} {p0}");
        assert!(fit(&[(0.0, 1.0), (1.0, 1.0)]).is_none());
    }

    /// The pressure's resultant is the force: pi a p0 / 2 a length, and 2 pi a^2 p0 / 3.
    #[test]
    fn closed_forms_carry_the_force() {
        let (a, p0) = Shape::Line.analytic(0.003);
        assert!((0.5 * PI * a * p0 * LENGTH / 2.0 - 0.003).abs() < 1e-15);
        let (a, p0) = Shape::Point.analytic(0.003);
        assert!((2.0 / 3.0 * PI * a * a * p0 / 4.0 - 0.003).abs() < 1e-15);
        // Indentation a^2 / R with the mean pressure 4 E* a / (3 pi R), E* = E / (1 - nu^2).
        assert!((2.0 / 3.0 * p0 / (4.0 * MODULUS / 0.91 * a / (3.0 * PI)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn variants_scale_all_divisions() {
        let scene: Table = include_str!("../../../../scenes/hertz-cylinder.toml").parse().unwrap();
        let changed = variant(&scene, 6).unwrap();
        assert_eq!(changed["body"][0]["mesh"]["refinement"]["elements"].as_integer(), Some(6));
        let shipped = scene["body"][1]["mesh"]["divisions"][0].as_integer().unwrap();
        assert_eq!(changed["body"][1]["mesh"]["divisions"][0].as_integer(), Some((shipped + 1) / 2));
        assert_eq!(changed["body"][0]["mesh"]["divisions"][3].as_integer(), Some(1));
    }
}
