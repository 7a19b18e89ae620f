//! The inf-sup constant of mixed forms: the smallest `b` for which a pressure `p` has a displacement `u` with
//! `int p div u >= b |p| |u|`, in the norm `|u|^2 = 2 int e(u) : e(u)` of the strains, at the reference configuration (Chapelle and Bathe 1993).
//!
//! With the volumetric part `L` of the stiffness for unit modulus and the deviatoric one `S` its squares are the eigenvalues of `L u = b^2 S u`
//! that are not zero, as many as there are pressures. A form is stable if the least does not fall with the mesh.

use std::sync::Arc;

use stoss_fe_solid::{SolidOptions, Volumetric};
use stoss_materials::NeoHooke;
use stoss_mesh::generate::Block;
use stoss_reference_element::{CellKind, Integration};
use stoss_tensor::nalgebra::DMatrix;

use super::equilibrium::Equilibrium;
use super::table;
use crate::verify::Findings;
use crate::verify::check::{Bound, Check, number};
use crate::workspace::Outcome;

/// An eigenvalue below this is that of a pressure without displacement.
const ZERO: f64 = 1e-10;
/// The constant of a stable form with a mesh of half the size, over that of the coarser one.
const STEADY: f64 = 0.8;

/// The stiffness for a modulus, and the number of pressures.
fn stiffness(kind: CellKind, n: usize, lambda: f64) -> Outcome<(DMatrix<f64>, usize)> {
    let mesh = Block::new([0.0; 3], [1.0; 3], [n; 3]).generate()?.with_cells(kind)?;
    let options = SolidOptions { integration: Integration::Full, volumetric: Volumetric::Mixed };
    let law = Arc::new(NeoHooke::new(lambda, 1.0)?);
    let problem = Equilibrium::new(mesh, law, options, |x| [x[2] == 0.0; 3], Vec::new())?;
    let pressures = match kind {
        CellKind::Hex27 => 4 * problem.mesh.elements.len(),
        CellKind::Tet4 => problem.mesh.nodes.len(),
        _ => problem.mesh.elements.len(),
    };
    Ok((problem.dense_tangent(&problem.reference())?, pressures))
}

/// The constant, and the number of pressures without displacements.
fn constant(kind: CellKind, n: usize) -> Outcome<(f64, usize)> {
    let (one, pressures) = stiffness(kind, n, 1.0)?;
    let volumetric = stiffness(kind, n, 2.0)?.0 - &one;
    let norm = one - &volumetric;
    let factor = norm.cholesky().ok_or("the norm of the strains is not definite")?.l();
    let half = factor.solve_lower_triangular(&volumetric).ok_or("a factor is singular")?;
    let whole = factor.solve_lower_triangular(&half.transpose()).ok_or("a factor is singular")?;
    let mut values: Vec<f64> = (0.5 * (&whole + whole.transpose())).symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    let there: Vec<f64> = values.into_iter().take(pressures).filter(|v| *v > ZERO).collect();
    Ok((there.last().copied().unwrap_or(0.0).sqrt(), pressures - there.len()))
}

/// Two meshes, in full mode three. Of all forms only hex27 with linear pressures is stable; constants of the others fall with the mesh (theory/elements#inf-sup).
pub fn measure(findings: &mut Findings, quick: bool) -> Outcome<()> {
    let mut rows = Vec::new();
    let meshes: &[usize] = if quick { &[2, 3] } else { &[2, 3, 4] };
    for kind in CellKind::ALL {
        let stable = kind == CellKind::Hex27;
        let mut found = Vec::new();
        for n in meshes {
            found.push(constant(kind, *n)?);
        }
        let [.., a, b] = found.as_slice() else { continue };
        let bound = if stable { Bound::AtLeast(STEADY) } else { Bound::Unbounded };
        let scene = format!("inf-sup, {} mixed", kind.name());
        let note = format!("constants {}", found.iter().map(|f| number(f.0)).collect::<Vec<_>>().join(", "));
        findings
            .checks
            .push(Check::new(&scene, "constant over that of the coarser mesh", b.0 / a.0, bound).noted(note));
        let bound = if stable { Bound::AtMost(0.0) } else { Bound::Unbounded };
        findings.checks.push(Check::new(&scene, "pressures without displacements", b.1 as f64, bound));
        let mut row = vec![kind.name().to_owned()];
        row.extend(found.iter().map(|(constant, lost)| format!("{} ({lost})", number(*constant))));
        rows.push(row);
    }
    let head: &[&str] = if quick { &["form", "n = 2", "n = 3"] } else { &["form", "n = 2", "n = 3", "n = 4"] };
    table(
        findings,
        "Inf-sup constants of mixed forms on n x n x n cubes, in brackets pressures without displacements",
        "The smallest singular value that ties pressures to displacements (theory/elements). A form is stable if the constant does not fall as the mesh is refined.",
        head,
        rows,
    );
    Ok(())
}
