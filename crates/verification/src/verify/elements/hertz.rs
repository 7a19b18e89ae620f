//! Hertz's contact of an eighth of a ball with a rigid plane, with quadratic cells: radius and largest pressure.
//!
//! The nodal forces of contact are the internal forces at the surface. With quadratic shape functions `sum f_I r_I^2` is the second moment of the pressures, and
//! over their resultant it is `2 a^2 / 5`. The edge of the contact lies somewhere in a linear piece of a face (theory/elements#contact), half as long as the face:
//! that is the bound of the radius. The same force on a circle whose radius is off by a part of it has a pressure that is off by twice that part.

use std::f64::consts::PI;

use stoss::solver::Simulation;
use stoss_fe_solid::{ForceRule, SolidStep, Workspace};

use super::{facade, table};
use crate::verify::Findings;
use crate::verify::check::{Bound, Check, number};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

const CELLS: [&str; 2] = ["hex20", "tet10"];
const MODULUS: f64 = 1000.0;
const POISSON: f64 = 0.3;
/// Half of the refined zone and its elements. The radius of the contact is about 0.05 of the ball's.
const ZONE: f64 = 0.0525;
const ELEMENTS: u32 = 4;

fn scene(cell: &str) -> String {
    let plane = "[[prescribe]]\nset = \"plane.all\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n";
    let symmetry = [("left", "x"), ("front", "y")].map(|(set, component)| {
        format!("[[prescribe]]\nset = \"ball.{set}\"\ncomponents = [\"{component}\"]\nfixed = true\n")
    });
    let material = format!("material = {{ law = \"neo-hooke\", young = {MODULUS:?}, poisson = {POISSON:?} }}\n");
    format!(
        "[scene]\ntitle = \"Hertz\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.5\n\
         [[body]]\nname = \"ball\"\ncell = \"{cell}\"\n{material}\
         mesh = {{ generator = \"ball\", radius = 1.0, part = \"eighth\", divisions = [7, 2, 5], refinement = {{ half_width = {ZONE:?}, elements = {ELEMENTS} }} }}\n\
         [[body]]\nname = \"plane\"\n{material}mesh = {{ generator = \"block\", min = [-0.1, -0.1, -1.2], max = [0.4, 0.4, -1.0], divisions = [1, 1, 1] }}\n\
         [[contact]]\nmethod = \"mortar\"\nslave = \"ball.outer\"\nmaster = \"plane.top\"\n{plane}{}\
         [[prescribe]]\nset = \"ball.top\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0.0, 0.0], [1.0, -0.0025]] }}\n",
        symmetry.concat()
    )
}

/// Resultant of the contact forces and their second moment about the axis, on the modelled quarter of the contact.
fn moments(simulation: &Simulation) -> Outcome<(f64, f64)> {
    let (reference, q) = (&simulation.model().reference, &simulation.state().q);
    let mut force = vec![0.0; q.len()];
    let step = SolidStep { q_n: q, q_np1: q, rule: ForceRule::END_POINT };
    simulation.model().bodies[0].solid.assemble(step, 1.0, &mut force, None, &mut Workspace::default())?;
    let (mut resultant, mut moment) = (0.0, 0.0);
    for (n, x) in q.chunks_exact(3).enumerate() {
        // The upper half has the support, and no contact.
        if reference[3 * n + 2] < -0.5 {
            resultant += force[3 * n + 2];
            moment += force[3 * n + 2] * (x[0] * x[0] + x[1] * x[1]);
        }
    }
    Ok((resultant, moment))
}

/// Radius of the contact and largest pressure under the force on the modelled quarter.
fn analytic(force: f64) -> (f64, f64) {
    let whole = 4.0 * force;
    let a = (0.75 * whole * (1.0 - POISSON * POISSON) / MODULUS).cbrt();
    (a, 1.5 * whole / (PI * a * a))
}

/// Radius and pressure of each cell.
pub fn measure(findings: &mut Findings) -> Outcome<()> {
    let mut rows = Vec::new();
    for cell in CELLS {
        let mut simulation = facade::simulation(&scene(cell))?;
        facade::run(&mut simulation)?;
        let (force, moment) = moments(&simulation)?;
        let (a, p0) = analytic(force);
        let piece = 0.5 * ZONE / f64::from(ELEMENTS) / a;
        let pressures = simulation.pressures().first().ok_or("no contact")?;
        let ratios = [(2.5 * moment / force).sqrt() / a, pressures.iter().copied().fold(0.0, larger) / p0];
        let note = format!("a = {}, p0 = {}; a piece of a face is {} of a", number(a), number(p0), number(piece));
        let names = ["radius over the analytic one", "largest pressure over the analytic one"];
        for ((quantity, ratio), width) in names.into_iter().zip(ratios).zip([piece, 2.0 * piece]) {
            let bound = Bound::Near { value: 1.0, tolerance: width };
            findings.checks.push(Check::new(&format!("Hertz, {cell}"), quantity, ratio, bound).noted(note.clone()));
        }
        rows.push(vec![cell.to_owned(), number(force), number(ratios[0]), number(ratios[1]), number(piece)]);
    }
    let head = [
        "cell",
        "force",
        "radius over the analytic one",
        "largest pressure over the analytic one",
        "piece of a face over the radius",
    ];
    table(
        findings,
        "Hertz: ball on a rigid plane",
        "An eighth of a ball of quadratic elements, between planes of symmetry, is pressed onto a rigid plane; the closed forms are Hertz' (1882). 1 is exact; the error should stay within one linear piece of a face.",
        &head,
        rows,
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_times_area_is_the_force() {
        let (a, p0) = analytic(0.3);
        // The mean pressure is two thirds of the largest; 1/E* = 0.91e-3.
        assert!((2.0 / 3.0 * p0 * PI * a * a - 1.2).abs() < 1e-12);
        assert!((a.powi(3) - 0.75 * 1.2 * 0.91e-3).abs() < 1e-12);
    }
}
