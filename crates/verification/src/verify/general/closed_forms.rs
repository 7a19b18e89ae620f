//! A cube that falls flat onto a rigid plane, and Hertz's contact: the layer against multipliers and closed forms.

use std::f64::consts::PI;

use super::judge::{judge, run};
use super::scene::{Body, Scene};
use crate::verify::check::{Bound, Check};
use crate::verify::{Bench, Findings, Run};
use crate::workspace::Outcome;

/// Distance of the impulse of the thinnest layer from that of the multipliers that keep energy: both set the mesh vibrating, each in its way.
const IMPULSE: f64 = 0.035;

/// Relative errors of Hertz's contact.
const HERTZ: f64 = 0.02;

/// Measures the impulse and Hertz's contact.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    impulse(bench, findings)?;
    cylinder(bench, findings)
}

/// Closing speed of the cube; its mass is 1.
const SPEED: f64 = 0.1;

fn fall(step: f64, contact: &str) -> Scene {
    Scene::dynamic(step, 4.0)
        .watched(1)
        .body(Body::cube("cube").at([0.0, 0.0, 0.53]).velocity([0.0, 0.0, -SPEED]))
        .obstacle("plane", "shape = { kind = \"plane\", size = [4.0, 4.0] }", [0.03, 0.05, 0.0])
        .also("\n[[probe]]\nname = \"momentum\"\nquantity = \"linear_momentum\"\n")
        .also(contact)
}

/// Impulses along z and sideways.
fn impulses(run: &Run) -> Outcome<[f64; 2]> {
    let probes = run.table("probes.csv")?;
    let last = |column: &str| -> Outcome<f64> { Ok(*probes.column(column)?.last().ok_or("probes.csv has no row")?) };
    let sideways = last("momentum.x")?.hypot(last("momentum.y")?);
    Ok([last("momentum.z")? + SPEED, sideways])
}

/// Multipliers with the gap zero at the end of a step take the energy of the nodes that close, at every step size; the layer keeps it. So the limit of a
/// thin layer is that of multipliers that keep energy (`constraint = "modified"`), at a small step.
fn impulse(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let named = |constraint: &str| {
        format!(
            "\n[[contact]]\nmethod = \"nts\"\nslave = \"cube.bottom\"\nmaster = \"plane.all\"\nconstraint = \"{constraint}\"\n"
        )
    };
    let mut reference = [f64::NAN; 2];
    for (k, constraint) in ["modified", "standard"].into_iter().enumerate() {
        let name = format!("flat impact, multipliers, {constraint}");
        let launched = run(bench, &name, &fall(0.00625, &named(constraint)))?;
        findings.checks.push(launched.run.completed(0));
        reference[k] = impulses(&launched.run)?[0];
    }
    let layers: &[(f64, f64)] = if bench.quick {
        &[(0.02, 0.025), (0.005, 0.025), (0.00125, 0.00625)]
    } else {
        &[(0.02, 0.0125), (0.01, 0.0125), (0.005, 0.0125), (0.0025, 0.0125), (0.00125, 0.00625)]
    };
    for &(thickness, step) in layers {
        let name = format!("flat impact, thickness {thickness} of the edge");
        let scene = fall(step, "").general(&format!("thickness = {thickness:?}"));
        let Some(done) = judge(bench, findings, &name, &scene)? else { continue };
        let [found, sideways] = impulses(&done)?;
        let note = format!(
            "{found:.5}; multipliers that keep energy {:.5}, those that lose what closing takes {:.5}; an elastic rebound would have {:.5}",
            reference[0],
            reference[1],
            2.0 * SPEED
        );
        let bound = if thickness < 0.002 { Bound::AtMost(IMPULSE) } else { Bound::Unbounded };
        let quantity = "impulse over that of multipliers that keep energy, less one";
        findings.checks.push(Check::new(&name, quantity, (found / reference[0] - 1.0).abs(), bound).noted(note));
        let note = "the plane is smooth: what guards and points near the inner edges of its four triangles give sideways, less than the thickness over the edge";
        let row = Check::new(&name, "impulse sideways over that along z", sideways / found, Bound::AtMost(thickness));
        findings.checks.push(row.noted(note));
    }
    Ok(())
}

/// Half width and largest pressure of a cylinder of radius 1 under a force a length (Johnson, *Contact mechanics*, section 4.2 (c)); E = 1000, nu = 0.3.
fn of_hertz(force: f64) -> [f64; 2] {
    let modulus = 1000.0 / (1.0 - 0.09);
    let a = (4.0 * force / (PI * modulus)).sqrt();
    [a, 2.0 * force / (PI * a)]
}

/// A quarter of a cylinder is pressed onto a rigid plane, from a gap of a little more than the thickness; the layer is thinner than the indentation by a factor of 10 and more.
fn cylinder(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    const LENGTH: f64 = 0.01;
    const DEPTH: f64 = 0.0009;
    let cases: &[(u32, f64)] = if bench.quick { &[(10, 2e-5)] } else { &[(5, 2e-5), (10, 1e-4), (10, 2e-5)] };
    for &(elements, thickness) in cases {
        let name = format!("Hertz, {elements} elements over the half width, thickness {thickness}");
        let scaled = |n: u32| (n * elements).div_ceil(10);
        let mesh = format!(
            "{{ generator = \"cylinder\", radius = 1.0, length = {LENGTH:?}, part = \"quarter\", divisions = [{}, {}, {}, 1], refinement = {{ half_width = 0.026, elements = {elements} }} }}",
            scaled(20),
            scaled(4),
            scaled(14)
        );
        let scene = Scene::equilibria(4, "")
            .watched(1)
            .body(Body::generated("cylinder", &mesh, LENGTH * 0.25 * PI).young(1000.0))
            .obstacle("plane", "shape = { kind = \"plane\", size = [2.0, 2.0] }", [0.5, 0.0, -1.0 - 1.2 * thickness])
            .fixed("cylinder.all", &["y"])
            .fixed("cylinder.left", &["x"])
            .also(&format!(
                "\n[[prescribe]]\nset = \"cylinder.top\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0.0, 0.0], [1.0, -{DEPTH:?}]] }}\n"
            ))
            .general(&format!("self = false\nthickness = {thickness:?}"));
        let Some(done) = judge(bench, findings, &name, &scene)? else { continue };
        let table = done.table("general.csv")?;
        let last =
            |column: &str| -> Outcome<f64> { Ok(*table.column(column)?.last().ok_or("general.csv has no row")?) };
        // Half of the cylinder; forces have no part along x, so the moment about y is that of the pressure about x = 0, 4 a / (3 pi) from it in the mean.
        let (force, moment) = (last("force_z")?, last("moment_y")?);
        let [a, pressure] = of_hertz(2.0 * force.abs() / LENGTH);
        let found = 0.75 * PI * (moment / force).abs();
        let largest = last("max_pressure")?;
        let bound = if elements == 10 && thickness < 5e-5 { Bound::AtMost(HERTZ) } else { Bound::Unbounded };
        let note = format!("a = {a:.5}, found {found:.5}; p0 = {pressure:.3}, found {largest:.3}");
        let row = |quantity: &str, error: f64| Check::new(&name, quantity, error.abs(), bound).noted(note.clone());
        findings.checks.push(row("half width over the closed form, less one", found / a - 1.0));
        findings.checks.push(row("largest pressure over the closed form, less one", largest / pressure - 1.0));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressures_carry_the_force() {
        let [a, pressure] = of_hertz(0.3);
        assert!((0.5 * PI * a * pressure - 0.3).abs() < 1e-15);
        // p0 = E* a / (2 R)
        assert!((pressure / (1000.0 / 0.91 * 0.5 * a) - 1.0).abs() < 1e-12);
    }
}
