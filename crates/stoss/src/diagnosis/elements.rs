//! Elements that cannot do what they should: slivers, and linear ones of a nearly incompressible material.

use super::case::DiagnosedRun;
use super::{Cause, Confidence, LikelyCause, Remedy, Where};
use crate::scene::{Generator, MeshSource};
use stoss_fe_solid::Volumetric;
use stoss_mesh::Mesh;
use stoss_solver::FailureKind;

/// Scaled Jacobian in the reference below which an element is a sliver.
const SLIVER: f64 = 0.05;
/// Poisson's ratio from which on elements without averages of the change of volume lock.
pub(super) const LOCKS: f64 = 0.495;

/// The smallest scaled Jacobian at the nodes of an element, and the node in it.
fn worst_corner(mesh: &Mesh, element: u32) -> (f64, usize) {
    mesh.element_coordinates(element).worst_node()
}

/// An element of the mesh that is nearly degenerate, where a run failed or in a body that is not sound.
pub(super) fn sliver(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    use FailureKind::{InsideOut, InvertedElement, NotConverged};
    if !case.is_bad() {
        return Vec::new();
    }
    let failed = case.failure().and_then(|failure| failure.place.element);
    let place = case.place();
    let mut list = Vec::new();
    for (b, body) in case.model().bodies.iter().enumerate() {
        let name = body.solid.name();
        let Some(mesh) = case.mesh(name) else { continue };
        let quality = mesh.quality();
        let of_failure = failed.filter(|&(other, _)| other == b).map(|(_, element)| element as u32);
        let worst =
            of_failure.filter(|&element| worst_corner(mesh, element).0 < SLIVER).unwrap_or(quality.worst_element);
        let (jacobian, corner) = worst_corner(mesh, worst);
        if jacobian >= SLIVER {
            continue;
        }
        let is_here = place.body.as_deref() == Some(name);
        let confidence = match (of_failure == Some(worst), is_here) {
            (true, _) if case.failed_by(&[InsideOut, InvertedElement, NotConverged]) => Confidence::High,
            (_, true) => Confidence::Medium,
            _ => Confidence::Low,
        };
        let node = mesh.elements[worst as usize][corner];
        let at = case.node(body.nodes.start + node);
        let mut evidence = vec![format!(
            "the scaled Jacobian of element {worst} is {jacobian:.1e} at node {node} in the undeformed mesh (1: a box, 0: flat); the smallest of the mesh is {:.1e}",
            quality.min_scaled_jacobian
        )];
        evidence.extend(case.failure().filter(|_| is_here).map(|failure| failure.reason.clone()));
        let generated =
            matches!(case.scene.bodies.get(b).map(|b| &b.mesh), Some(MeshSource::Generator(Generator::Hexahedron(_))));
        let from = match generated {
            true => format!(
                "`body[{b}].mesh.corners`: move the corner next to that node; the angle there is nearly 0 or 180 degrees"
            ),
            false => {
                "in the mesher: move the node or remesh the region; `stoss mesh info FILE` shows the worst element"
                    .to_owned()
            }
        };
        let mut remedies = vec![Remedy::words(format!("correct the mesh at node {node} of `{name}`, {from}"))];
        // Elements that are inverted at the integration points stop the run all the same.
        let is_inverted = case.failed_by(&[InvertedElement]);
        if !is_inverted && case.scene.solver.inside_out != crate::scene::InsideOut::Warn {
            remedies.push(Remedy::set("solver.inside_out", "\"warn\"", "the run continues with a warning while the Jacobian is positive at the integration points; do not trust the stresses there"));
        }
        list.push(LikelyCause {
            cause: Cause::Sliver,
            confidence,
            place: Where { text: format!("element {worst} at {}", at.text), element: Some(worst as usize), ..at },
            sentence: format!("element {worst} of `{name}` is a sliver: a small deformation is enough to turn its corner at node {node} inside out"),
            evidence,
            remedies,
        });
    }
    list
}

/// Reduced hex20 in a single row, where the system is singular in a motion of a body.
pub(super) fn single_rows(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    if !case.failed_by(&[FailureKind::Singular]) || case.failure().is_some_and(|failure| failure.place.slot.is_some()) {
        return Vec::new();
    }
    let place = case.place();
    let mut list = Vec::new();
    for (b, body) in case.model().bodies.iter().enumerate() {
        let name = body.solid.name();
        if !body.solid.has_own_modes() || place.body.as_deref() != Some(name) {
            continue;
        }
        let Some(rows) = case.mesh(name).map(crate::build::single_rows).filter(|rows| !rows.is_empty()) else {
            continue;
        };
        list.push(LikelyCause {
            cause: Cause::ZeroEnergyModes,
            confidence: Confidence::High,
            place: place.clone(),
            sentence: format!(
                "`{name}` has hex20 elements with reduced integration in a single row: such an element has zero-energy modes, which no neighbouring element prevents"
            ),
            evidence: vec![
                format!("{} of {} elements have no neighbour in two directions, the first is element {}", rows.len(), body.solid.element_count(), rows[0]),
                "the stiffness matrix is singular".to_owned(),
            ],
            remedies: vec![
                Remedy::set(format!("body[{b}].integration"), "\"full\"", "then there are no zero-energy modes"),
                Remedy::words("or take two elements through the thickness: more `divisions`, or a finer mesh"),
            ],
        });
    }
    list
}

/// Materials that are so incompressible that elements without averages of the change of volume lock.
pub(super) fn incompressible(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    let mut list = Vec::new();
    for (b, body) in case.model().bodies.iter().enumerate() {
        let nu = body.solid.law().small_strain_moduli().poisson_ratio();
        if nu < LOCKS || body.solid.options().volumetric == Volumetric::Mixed {
            continue;
        }
        let name = body.solid.name();
        let key = format!("body[{b}].material.poisson");
        let has_split = body.solid.law().volumetric().is_some();
        let mixed = has_split.then(|| {
            Remedy::set(
                format!("body[{b}].volumetric"),
                "\"mixed\"",
                "elements with averages of the change of volume do not lock",
            )
        });
        let softer = match case.scene.locate(&key) {
            Some(_) => Remedy::set(
                key,
                "0.49",
                "the bulk modulus is then fifty times the shear modulus, and elements do not lock",
            ),
            None => Remedy::words(format!(
                "give `body[{b}].material` a smaller bulk modulus: fifty times the shear modulus is enough"
            )),
        };
        // Locking is stiff, never singular.
        let is_singular = case.failed_by(&[FailureKind::Singular]);
        let is_here = case.is_bad() && !is_singular && case.place().body.as_deref() == Some(name);
        list.push(LikelyCause {
            cause: Cause::Incompressible,
            confidence: if is_here { Confidence::Medium } else { Confidence::Low },
            place: Where { text: format!("`{name}`"), body: Some(name.to_owned()), ..Where::default() },
            sentence: format!(
                "`{name}` is nearly incompressible (Poisson's ratio {nu}), and its elements lock: they are far too stiff, and the pressure oscillates from element to element"
            ),
            evidence: vec![format!("the bulk modulus is {:.0} times the shear modulus", 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)))],
            remedies: mixed.into_iter().chain([softer]).collect(),
        });
    }
    list
}
