//! Hertz: radius and largest pressure of the contact of two cylinders, and of a ball and a rigid plane, against the closed forms.
//!
//! The radius is read off the second moment of the pressure over its resultant, which is `a^2 / 4` for a line and `2 a^2 / 5` for a circle: an integral
//! over all facets of the slave, for which the node at the edge, where the contact ends within a facet, hardly matters.

use std::f64::consts::PI;
use std::path::Path;

use stoss_mesh::Facet;
use stoss_reference_element::CellKind;
use toml::{Table, Value};

use super::super::check::{Bound, Check, number};
use super::super::report::{Grid, ReportSection};
use super::super::{Bench, Findings, Run, newton};
use crate::hexahedra;
use crate::plot::{self, Labels, Series};
use crate::verify::numbers::larger;
use crate::vtu::Grid as Frame;
use crate::workspace::Outcome;

/// Largest relative error of radius and pressure on the shipped mesh, which has at most 20 elements across the contact.
const CLOSE: f64 = 0.02;
/// Part of the errors, at least of first order, and of what finite strains and sizes add, that is left with half the element length.
const FALL: f64 = 0.7;
const MODULUS: f64 = 1000.0;
const POISSON: f64 = 0.3;
/// Radius of the slave, upper body; the other cylinder has twice of it.
const RADIUS: f64 = 1.0;
/// Extent of the shipped cylinders along their axis.
const LENGTH: f64 = 0.01;
/// Resultant of the pressures over the force: their difference is that of facets and integration.
const BALANCE: f64 = 1e-4;

/// What touches what.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    /// Quarters of two cylinders of one material.
    Line,
    /// An eighth of a ball and a rigid plane.
    Point,
}

impl Shape {
    /// Radius of the contact and largest pressure under the force of the probe, which is that on the modelled part.
    fn analytic(self, force: f64) -> (f64, f64) {
        let plane_strain = MODULUS / (1.0 - POISSON * POISSON);
        match self {
            Shape::Line => {
                // Half of the force a length; both bodies yield; 1/R = 1/R1 + 1/(2 R1).
                let line = 2.0 * force / LENGTH;
                let a = (4.0 * line * RADIUS / 1.5 / (PI * 0.5 * plane_strain)).sqrt();
                (a, 2.0 * line / (PI * a))
            }
            Shape::Point => {
                let whole = 4.0 * force;
                let a = (0.75 * whole * RADIUS / plane_strain).cbrt();
                (a, 1.5 * whole / (PI * a * a))
            }
        }
    }

    /// Second moment of the pressure over its resultant and `a^2`.
    fn share(self) -> f64 {
        if self == Shape::Line { 0.25 } else { 0.4 }
    }

    /// Distance of a point from the middle of the contact.
    fn distance(self, x: [f64; 3]) -> f64 {
        if self == Shape::Line { x[0].abs() } else { x[0].hypot(x[1]) }
    }
}

/// A facet in its current position with the pressures of its nodes.
struct Loaded {
    x: [[f64; 3]; 4],
    pressure: [f64; 4],
}

/// The loaded facets of the slave, which is the first body.
fn surface(frame: &Frame, shape: Shape) -> Outcome<Vec<Loaded>> {
    let field = |name: &str| frame.point_data.get(name).ok_or_else(|| format!("no field {name} in the frame"));
    let (pressure, displacement) = (field("contact_pressure")?, field("displacement")?);
    let bodies = frame.cell_data.get("body").ok_or("no numbers of bodies in the frame")?;
    let on_surface = |n: usize| {
        let [x, y, z] = frame.points[n];
        let r = if shape == Shape::Line { x.hypot(z) } else { x.hypot(y).hypot(z) };
        (r - RADIUS).abs() < 1e-9
    };
    let mut found = Vec::new();
    for (cell, body) in hexahedra(frame).iter().zip(&bodies.values) {
        if *body != 0.0 {
            continue;
        }
        let nodes = cell.map(|n| n as u32);
        for facet in (0..6).map(|local| Facet::of_element(0, CellKind::Hex8, &nodes, local).nodes) {
            let facet = [0, 1, 2, 3].map(|k: usize| facet[k] as usize);
            if facet.iter().any(|&n| pressure.values[n] != 0.0) && facet.iter().all(|&n| on_surface(n)) {
                found.push(Loaded {
                    x: facet.map(|n| std::array::from_fn(|i| frame.points[n][i] + displacement.row(n)[i])),
                    pressure: facet.map(|n| pressure.values[n]),
                });
            }
        }
    }
    Ok(found)
}

/// Resultant of the pressures and their second moment about the middle, by the 2 x 2 rule.
fn moments(facets: &[Loaded], shape: Shape) -> (f64, f64) {
    const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let (mut resultant, mut moment) = (0.0, 0.0);
    for Loaded { x, pressure } in facets {
        for [xi, eta] in CORNERS.map(|c| c.map(|c| c / 3.0_f64.sqrt())) {
            let sum = |weight: &dyn Fn([f64; 2]) -> f64| -> [f64; 3] {
                std::array::from_fn(|i| CORNERS.iter().zip(x).map(|(c, x)| 0.25 * weight(*c) * x[i]).sum())
            };
            let shape_of = |[a, b]: [f64; 2]| (1.0 + a * xi) * (1.0 + b * eta);
            let at = sum(&shape_of);
            let (a1, a2) = (sum(&|[a, b]| a * (1.0 + b * eta)), sum(&|[a, b]| b * (1.0 + a * xi)));
            let normal: [f64; 3] = std::array::from_fn(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                a1[j] * a2[k] - a1[k] * a2[j]
            });
            let area = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
            let p: f64 = CORNERS.iter().zip(pressure).map(|(c, p)| 0.25 * shape_of(*c) * p).sum();
            resultant += area * p;
            moment += area * p * shape.distance(at).powi(2);
        }
    }
    (resultant, moment)
}

/// Distance from the middle and pressure of the nodes that carry, outwards; of a cylinder those of one end.
fn profile(facets: &[Loaded], shape: Shape) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = facets
        .iter()
        .flat_map(|facet| facet.x.into_iter().zip(facet.pressure))
        .filter(|(x, p)| *p > 0.0 && (shape == Shape::Point || x[1] == 0.0))
        .map(|(x, p)| (shape.distance(x), p))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    // Neighbouring facets have nodes in common.
    found.dedup();
    found
}

/// The line on three meshes (quick: the shipped one), the point on two in full mode; `elements` are those of the refined zone, of which the contact
/// has about 5/6.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let mut shown = Shown::default();
    let close = Bound::AtMost(CLOSE);
    let shipped = bench.run_shipped(Path::new("scenes/hertz-cylinders.toml"))?;
    let middle = shown.add(&shipped, Shape::Line, close, findings)?;
    if shipped.succeeded() {
        bench.show(&shipped, findings);
    }
    if !bench.quick {
        let scene = bench.scene("hertz-cylinders")?;
        let run = bench.run_variant("hertz-cylinders-coarse", &variant(&scene, 5)?)?;
        let coarse = shown.add(&run, Shape::Line, Bound::Unbounded, findings)?;
        falls("hertz-cylinders", coarse, middle, findings);
        let run = bench.run_variant("hertz-cylinders-fine", &variant(&scene, 20)?)?;
        let fine = shown.add(&run, Shape::Line, close, findings)?;
        falls("hertz-cylinders-fine", middle, fine, findings);
        let run = bench.run_variant("hertz-ball-coarse", &variant(&bench.scene("hertz-ball")?, 4)?)?;
        let coarse = shown.add(&run, Shape::Point, Bound::Unbounded, findings)?;
        let run = bench.run_shipped(Path::new("scenes/hertz-ball.toml"))?;
        let fine = shown.add(&run, Shape::Point, close, findings)?;
        falls("hertz-ball", coarse, fine, findings);
    }
    let head = ["run", "force", "radius / analytic", "largest pressure / analytic", "outermost node / analytic"];
    let labels = Labels { title: "pressure", x: "distance from the middle / a", y: "p / p0" };
    findings.sections.push(ReportSection {
        title: "Hertz".into(),
            reading: "Cylinders and a ball are pressed onto a flat face; the closed forms are Hertz' (1882), for small contact faces. The pressures of the nodes should lie on the ellipse, closer on the finer mesh.".into(),
        figures: vec![plot::linear(labels, &shown.lines)],
        tables: vec![Grid {
            caption: "Radius from the second moment of the pressures over their resultant, largest pressure of a node, outermost node that carries: \
                      over the closed forms for the force that the support tells"
                .into(),
            head: head.map(str::to_owned).to_vec(),
            rows: shown.rows,
        }],
    });
    Ok(())
}

/// The finer mesh is better than the coarser one, radius and pressure together.
fn falls(name: &str, coarse: Option<[f64; 2]>, fine: Option<[f64; 2]>, findings: &mut Findings) {
    if let Some(([a, b], [c, d])) = coarse.zip(fine) {
        let quantity = "errors of radius and pressure, over those of the coarser mesh";
        findings.checks.push(Check::new(name, quantity, (c + d) / (a + b), Bound::AtMost(FALL)));
    }
}

/// Table and chart.
#[derive(Default)]
struct Shown {
    rows: Vec<Vec<String>>,
    lines: Vec<Series>,
}

impl Shown {
    /// Rows of a run; the errors of radius and pressure.
    fn add(&mut self, run: &Run, shape: Shape, bound: Bound, findings: &mut Findings) -> Outcome<Option<[f64; 2]>> {
        findings.checks.push(run.completed(0));
        if !run.succeeded() {
            return Ok(None);
        }
        let probes = run.table("probes.csv")?;
        let force = probes.column("force.z")?.last().copied().ok_or("no row in probes.csv")?;
        let (a, p0) = shape.analytic(force);
        let facets = surface(&run.last_frame()?, shape)?;
        let (resultant, moment) = moments(&facets, shape);
        let points = profile(&facets, shape);
        let largest = points.iter().map(|p| p.1).fold(0.0, larger);
        let edge = points.last().map_or(f64::NAN, |p| p.0);
        let ratios = [(moment / resultant / shape.share()).sqrt() / a, largest / p0, edge / a];
        let errors = [(ratios[0] - 1.0).abs(), (ratios[1] - 1.0).abs()];
        let note = format!("a = {}, p0 = {} for the force {}", number(a), number(p0), number(force));
        let mut row = |quantity: &str, value: f64, bound: Bound| {
            findings.checks.push(Check::new(&run.name, quantity, value, bound).noted(note.clone()));
        };
        let difference = (resultant / force - 1.0).abs();
        row("resultant of the pressures over the force, less 1", difference, Bound::AtMost(BALANCE));
        row("error of the contact radius (Hertz)", errors[0], bound);
        row("error of the largest pressure (Hertz)", errors[1], bound);
        row("outermost node that carries, over the radius", ratios[2], Bound::Unbounded);
        row("iterations a step", newton::mean_iterations(&run.newton()?), Bound::Unbounded);
        row("step cuts", run.summary_number("cuts")?, Bound::Unbounded);
        let fallbacks = run.summary()?["linear_solver_counts"]["pivoting_fallbacks"].as_f64().unwrap_or(f64::NAN);
        row("matrices without pivots inside the fronts", fallbacks, Bound::AtMost(0.0));
        findings.checks.push(run.coverage()?);
        let mut cells = vec![run.name.clone(), number(force)];
        cells.extend(ratios.iter().map(|ratio| format!("{ratio:.4}")));
        self.rows.push(cells);
        let r: Vec<f64> = points.iter().map(|p| p.0 / a).collect();
        self.lines.push(Series::new(&run.name, &r, points.iter().map(|p| p.1 / p0)));
        Ok(Some(errors))
    }
}

/// The scene with another number of elements over the first body's refined zone, all numbers of refined meshes in the same ratio.
fn variant(scene: &Table, elements: i64) -> Outcome<Table> {
    let mut scene = scene.clone();
    scene.remove("expect");
    let bodies = scene.get_mut("body").and_then(Value::as_array_mut).ok_or("the scene has no bodies")?;
    let mut ratio: Option<f64> = None;
    let count = |value: &Value| value.as_integer().ok_or("a number of elements that is no whole number");
    for mesh in bodies.iter_mut().filter_map(|body| body.get_mut("mesh").and_then(Value::as_table_mut)) {
        let Some(zone) = mesh.get_mut("refinement").and_then(Value::as_table_mut) else { continue };
        let shipped = count(zone.get("elements").ok_or("a refinement without elements")?)?;
        let ratio = *ratio.get_or_insert(elements as f64 / shipped as f64);
        let scaled = |shipped: i64| ((ratio * shipped as f64 - 1e-9).ceil().max(1.0) as i64).into();
        zone.insert("elements".into(), scaled(shipped));
        let divisions = mesh.get_mut("divisions").and_then(Value::as_array_mut).ok_or("a mesh without divisions")?;
        // Of a cylinder the last is the single one along its axis.
        for number in divisions.iter_mut().take(3) {
            *number = scaled(count(number)?);
        }
    }
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pressure 1 on a rectangle of 2 x 3: area 6, second moment 3 * 8 / 3 about x = 0, and 2 * 27 / 3 more about the z-axis.
    #[test]
    fn moments_of_a_rectangle() {
        let x = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 3.0, 1.0], [0.0, 3.0, 1.0]];
        let facets = [Loaded { x, pressure: [1.0; 4] }];
        let (area, moment) = moments(&facets, Shape::Line);
        assert!((area - 6.0).abs() < 1e-14 && (moment - 8.0).abs() < 1e-14, "{area} {moment}");
        let (_, moment) = moments(&facets, Shape::Point);
        assert!((moment - 26.0).abs() < 1e-13, "{moment}");
        assert_eq!(profile(&facets, Shape::Line), [(0.0, 1.0), (2.0, 1.0)]);
    }

    /// The pressure's resultant is the force: `pi a p0 / 2` a length, and `2 pi a^2 p0 / 3`.
    #[test]
    fn closed_forms_carry_the_force() {
        let (a, p0) = Shape::Line.analytic(0.003);
        assert!((0.5 * PI * a * p0 * LENGTH / 2.0 - 0.003).abs() < 1e-15);
        // p0 = E* a / (2 R), with 1/R = 1 + 1/2 and 1/E* = 2 * 0.91 / 1000.
        assert!((p0 / (1000.0 / 1.82 * a * 1.5 / 2.0) - 1.0).abs() < 1e-12);
        let (a, p0) = Shape::Point.analytic(0.003);
        assert!((2.0 / 3.0 * PI * a * a * p0 / 4.0 - 0.003).abs() < 1e-15);
        // p0 = 2 E* a / (pi R), E* = 1000 / 0.91.
        assert!((p0 / (2.0 * 1000.0 / 0.91 * a / PI) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn variants_scale_all_divisions() {
        let scene: Table = include_str!("../../../../../scenes/hertz-cylinders.toml").parse().unwrap();
        let changed = variant(&scene, 5).unwrap();
        let numbers = |body: usize| {
            let mesh = &changed["body"][body]["mesh"];
            let mut all: Vec<i64> =
                mesh["divisions"].as_array().unwrap().iter().filter_map(Value::as_integer).collect();
            all.push(mesh["refinement"]["elements"].as_integer().unwrap());
            all
        };
        assert_eq!((numbers(0), numbers(1)), (vec![10, 2, 7, 1, 5], vec![13, 3, 8, 1, 7]));
        assert_eq!(variant(&scene, 10).unwrap()["body"], scene["body"]);
        assert!(variant(&include_str!("../../../../../scenes/hertz-ball.toml").parse().unwrap(), 4).is_ok());
    }
}
