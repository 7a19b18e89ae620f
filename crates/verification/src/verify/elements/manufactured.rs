//! Rates of convergence against a solution that is made up: a smooth large deformation, whose stress gives the forces.
//!
//! With the first Piola-Kirchhoff stress `P` of the deformation `x(X)` the weak form `int P : grad N_I dV` is what the body force `-Div P` and
//! the tractions `P N` of that deformation do at node `I`; boundary nodes are held where it puts them.

use std::f64::consts::PI;
use std::sync::Arc;

use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::{SolidOptions, Volumetric};
use stoss_materials::NeoHooke;
use stoss_mesh::Mesh;
use stoss_mesh::generate::Block;
use stoss_reference_element::CellKind;
use stoss_tensor::{SymmetricTensor2, Tensor2};

use super::equilibrium::{Equilibrium, Load};
use super::{name, table};
use crate::plot::{self, Labels, Series};
use crate::verify::Findings;
use crate::verify::check::{Bound, Check, number};
use crate::verify::report::ReportSection;
use crate::workspace::Outcome;

/// Least rate of the error in L2, from one halving: the rate of theory, 2 and 3, less 0.2.
pub const RATES: [f64; 2] = [1.8, 2.8];
const AMPLITUDE: f64 = 0.05;

/// The deformation and its gradient. A block that is sheared, so that elements are no bricks.
fn exact(x: [f64; 3]) -> ([f64; 3], Tensor2) {
    let mut place = x;
    let mut gradient = Tensor2::identity();
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let (a, b) = (PI * x[j] + 0.3 * i as f64, 0.5 * PI * x[k]);
        place[i] += AMPLITUDE * (a.sin() * b.cos() + x[i] * x[k]);
        gradient[(i, i)] += AMPLITUDE * x[k];
        gradient[(i, j)] += AMPLITUDE * PI * a.cos() * b.cos();
        gradient[(i, k)] += AMPLITUDE * (x[i] - 0.5 * PI * a.sin() * b.sin());
    }
    (place, gradient)
}

/// A sheared unit cube of `n` elements an edge.
fn mesh(kind: CellKind, n: usize) -> Outcome<Mesh> {
    let mut mesh = Block::new([0.0; 3], [1.0; 3], [n; 3]).generate()?.with_cells(kind)?;
    for x in &mut mesh.nodes {
        *x = [x[0] + 0.2 * x[1], x[1] - 0.1 * x[2], x[2] + 0.15 * x[0]];
    }
    Ok(mesh)
}

/// Values at the integration points of the mass: place, weight, shape functions and their gradients.
pub fn at_points(mesh: &Mesh, mut visit: impl FnMut(&[u32], f64, [f64; 3], &[f64], &[[f64; 3]])) {
    for (element, (kind, nodes)) in mesh.elements.cells().enumerate() {
        let coordinates = mesh.element_coordinates(element as u32);
        for &(xi, weight) in kind.table().mass {
            let jacobian = Tensor2::from_fn(|i, j| coordinates.jacobian(xi)[i][j]);
            let Some(inverse) = jacobian.try_inverse() else { continue };
            let shape = (kind.table().shape)(xi);
            let natural = (kind.table().shape_gradient)(xi);
            let gradients: Vec<[f64; 3]> = natural[..nodes.len()]
                .iter()
                .map(|g| std::array::from_fn(|j| (0..3).map(|k| g[k] * inverse[(k, j)]).sum()))
                .collect();
            visit(nodes, weight * jacobian.determinant(), coordinates.at(xi), &shape[..nodes.len()], &gradients);
        }
    }
}

/// Relative error of the displacements in L2 of `n` elements an edge.
fn error(kind: CellKind, options: SolidOptions, law: &Arc<dyn HyperelasticLaw>, n: usize) -> Outcome<Option<f64>> {
    let mesh = mesh(kind, n)?;
    let boundary: std::collections::BTreeSet<u32> =
        mesh.boundary_facets().iter().flat_map(|facet| facet.nodes.iter().copied().collect::<Vec<_>>()).collect();
    let places: std::collections::BTreeSet<[u64; 3]> =
        boundary.iter().map(|n| mesh.nodes[*n as usize].map(f64::to_bits)).collect();
    let problem =
        Equilibrium::new(mesh, law.clone(), options, |x| [places.contains(&x.map(f64::to_bits)); 3], Vec::new())?;
    let mut forces = vec![0.0; 3 * problem.mesh.nodes.len()];
    let mut failure = None;
    at_points(&problem.mesh, |nodes, weight, x, _, gradients| {
        let f = exact(x).1;
        match law.stress(&SymmetricTensor2::right_cauchy_green(&f)) {
            Ok(stress) => {
                let p = f * stress.to_matrix();
                for (node, g) in nodes.iter().zip(gradients) {
                    for i in 0..3 {
                        forces[3 * *node as usize + i] += weight * (0..3).map(|j| p[(i, j)] * g[j]).sum::<f64>();
                    }
                }
            }
            Err(error) => failure = Some(error),
        }
    });
    if let Some(failure) = failure {
        return Err(failure.into());
    }
    let mut q: Vec<f64> = problem.mesh.nodes.iter().flat_map(|x| exact(*x).0).collect();
    if problem.solve(&mut q, Load { forces: &forces, pressure: 0.0 })?.is_none() {
        return Ok(None);
    }
    let (mut off, mut all) = (0.0, 0.0);
    at_points(&problem.mesh, |nodes, weight, x, shape, _| {
        let place = exact(x).0;
        for i in 0..3 {
            let found: f64 = nodes.iter().zip(shape).map(|(n, s)| s * q[3 * *n as usize + i]).sum();
            off += weight * (found - place[i]).powi(2);
            all += weight * (place[i] - x[i]).powi(2);
        }
    });
    Ok(Some((off / all).sqrt()))
}

/// Each cell, with a compressible law and mixed near incompressibility.
pub fn measure(findings: &mut Findings, quick: bool) -> Outcome<()> {
    let compressible: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::from_young_poisson(1.0, 0.3)?);
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for (kind, integration) in CellKind::with_rules() {
        let coarse = if kind.is_quadratic() { 2 } else { 4 };
        let levels = if quick { 2 } else { 3 };
        let options = SolidOptions { integration, volumetric: Volumetric::Displacement };
        let name = name(kind, integration);
        let mut errors = Vec::new();
        for level in 0..levels {
            let n = coarse << level;
            errors.push((n as f64, error(kind, options, &compressible, n)?.unwrap_or(f64::NAN)));
        }
        let [.., a, b] = errors.as_slice() else { continue };
        let rate = (a.1 / b.1).log2();
        let bound = Bound::AtLeast(RATES[usize::from(kind.is_quadratic())]);
        let note = format!("errors {}", errors.iter().map(|e| number(e.1)).collect::<Vec<_>>().join(", "));
        let scene = format!("made-up solution, {name}");
        findings.checks.push(Check::new(&scene, "rate of the displacements in L2", rate, bound).noted(note));
        let mut row = vec![name.clone()];
        row.extend(errors.iter().map(|e| number(e.1)));
        row.push(format!("{rate:.2}"));
        rows.push(row);
        let n: Vec<f64> = errors.iter().map(|e| e.0).collect();
        lines.push(Series::new(&name, &n, errors.iter().map(|e| e.1)));
    }
    let head: &[&str] =
        if quick { &["cell", "coarse", "fine", "rate"] } else { &["cell", "coarse", "middle", "fine", "rate"] };
    table(
        findings,
        "Rates against a made-up solution",
        "Error of the displacements on two or three meshes and the observed order. 2 is right for linear cells, 3 for quadratic ones.",
        head,
        rows,
    );
    let labels = Labels { title: "error of the displacements in L2", x: "elements an edge", y: "relative error" };
    findings.sections.push(ReportSection {
        title: "Error against elements an edge".into(),
            reading: "The displacements of a smooth made-up field, for which the loads were computed, are sought again on finer meshes. A line is right if it is as steep as its dotted one: slope 2 for linear cells, 3 for quadratic ones.".into(),
        figures: vec![plot::log_log(labels, &lines, None, &[-2.0, -3.0])],
        tables: Vec::new(),
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_that_of_the_deformation() {
        let x = [0.3, -0.4, 0.7];
        let gradient = exact(x).1;
        for j in 0..3 {
            let at = |h: f64| {
                let mut x = x;
                x[j] += h;
                exact(x).0
            };
            let (a, b) = (at(1e-6), at(-1e-6));
            for i in 0..3 {
                assert!(((a[i] - b[i]) / 2e-6 - gradient[(i, j)]).abs() < 1e-9, "{i} {j}");
            }
        }
    }
}
