//! The skin of general contact of a scene, and what is wrong with it in words.

use super::interacting::point;
use super::separate::format_length;
use super::{Placed, Problems};
use crate::scene::GeneralContact as Table;
use crate::solver::Model;
use stoss_contact_barrier::{
    Bodies, Interactions, Nearer, Separation, SkinFacet, Start, StartError, StartFault, THINNEST, start,
};
use stoss_mesh::BOUNDARY;
use stoss_reference_element::FacetNodes;

/// What helps bodies that overlap.
const PART: &str = "move one of them, set `initial = \"separate\"`, or leave one of them out by `exclude`";

/// The parts of a scene and their model.
pub(super) struct PlacedParts<'a> {
    pub placed: &'a [Placed],
    pub model: &'a Model,
}

impl Bodies for PlacedParts<'_> {
    fn count(&self) -> u32 {
        self.placed.len() as u32
    }

    fn is_rigid(&self, body: u32) -> bool {
        self.placed[body as usize].mesh().is_none()
    }

    fn surface(&self, body: u32) -> Vec<FacetNodes> {
        self.placed[body as usize].facets_of(BOUNDARY).unwrap_or_default()
    }

    fn material_point(&self, body: u32, x: [f64; 3], beyond: f64) -> Option<Vec<(u32, f64)>> {
        let solid = &self.model.bodies[body as usize].solid;
        let point = solid.material_point_near(&self.model.reference, x, beyond)?;
        let (kind, nodes) = (solid.elements().kind(point.element), &solid.elements()[point.element]);
        Some(nodes.iter().copied().zip((kind.table().shape)(point.natural)).collect())
    }

    fn is_carried(&self, node: u32) -> bool {
        self.model.embedding.carriers(node).is_some()
    }
}

/// The skin, inset where bodies touch or face each other with a small gap, and the thickness of its layer. `inner`: pairs of bodies that go inside with all of their surfaces.
pub(super) fn skin(
    table: &Table,
    parts: &PlacedParts<'_>,
    rules: &Interactions,
    facets: Vec<SkinFacet>,
    inner: &[[u32; 2]],
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<Start> {
    let name = |body: u32| &parts.placed[body as usize].name[..];
    match start(table.thickness, parts, rules, &parts.model.reference, facets, inner) {
        Ok(start) => {
            let thickness = start.thickness;
            warnings.extend(start.nearer.iter().map(|&Nearer { bodies: [a, b], distance, place }| {
                format!(
                    "general_contact: `{}` and `{}` start {distance:.3e} apart near {}, less than the thickness {thickness:.3e}: their surfaces are inset as if they touched, forces begin \
                     where the bodies touch, and the bodies may overlap by up to the thickness; make `thickness` smaller than the gap, or leave it out",
                    name(a),
                    name(b),
                    point(place, start.edge)
                )
            }));
            Some(start)
        }
        Err(StartError { fault: StartFault::TooThin { thickness, shortest, default }, .. }) => {
            let message = format!(
                "is less than {THINNEST:e} of the shortest edge, {shortest:.3e}: no step size is small enough for so thin a layer"
            );
            let remedy = format!("choose at least {:.3e}; if it is left out it is {default:.3e}", THINNEST * shortest);
            problems.add("general_contact.thickness".into(), format!("{thickness:e}"), message, remedy);
            None
        }
        Err(error) => {
            let (message, remedy) = words(table, &name, &error);
            problems.add("general_contact".into(), "", message, remedy);
            None
        }
    }
}

/// Message and remedy of an error of the skin.
fn words<'a>(
    table: &Table,
    name: &dyn Fn(u32) -> &'a str,
    StartError { fault, edge }: &StartError,
) -> (String, String) {
    let at = |place: &[f64; 3]| point(*place, *edge);
    let deep = |body: u32, Separation { direction, length }: &Separation| {
        let by = point((*direction).into(), 1.0);
        format!("{} deep (the way out of `{}` is along {by})", format_length(*length), name(body))
    };
    match fault {
        StartFault::CrossesItself { body, place, count } => (
            format!(
                "the surface of `{}` intersects itself at the start, near {}; {count} pairs of facets cross",
                name(*body),
                at(place)
            ),
            "correct the mesh, or set `self = false`".into(),
        ),
        StartFault::Cross { bodies: [a, b], place, count, depth } => {
            let deep = depth.map_or(String::new(), |depth| format!(", {}", deep(*a, &depth)));
            let (a, b) = (name(*a), name(*b));
            let message = format!(
                "`{a}` and `{b}` overlap at the start, near {}{deep}; {count} pairs of facets cross",
                at(place)
            );
            (message, PART.into())
        }
        StartFault::Overlap { bodies: [a, b], depth } => {
            (format!("`{}` and `{}` overlap at the start, {}", name(*a), name(*b), deep(*a, depth)), PART.into())
        }
        StartFault::Inside { bodies: [a, b] } => (
            format!("one of `{}` and `{}` lies inside the other at the start", name(*a), name(*b)),
            "move one of them, or leave one of them out by `exclude`".into(),
        ),
        StartFault::NearItself { body, distance, place, may_be_thinner } => {
            let message = format!(
                "two parts of the surface of `{}` that are not adjacent are only {distance:.3e} apart near {}, so that the contact layer{} would act there all the time",
                name(*body),
                at(place),
                table.thickness.map_or(String::new(), |given| format!(" of the given thickness {given:.3e}"))
            );
            let remedy = match (may_be_thinner, table.thickness) {
                (true, Some(_)) => {
                    "make `thickness` smaller than that distance, or leave it out: it then follows from it; or set `self = false`"
                }
                (true, None) => "correct the mesh there, or set `self = false`",
                (false, _) => {
                    "correct the mesh there, or set `self = false`: no layer is thin enough, as between the faces of a closed crack"
                }
            };
            (message, remedy.into())
        }
        StartFault::NoInside { bodies: [a, b], thickness } => {
            let message = format!(
                "the rigid bodies `{}` and `{}` touch at the start, and neither surface can be inset: both are flat or not closed",
                name(*a),
                name(*b),
            );
            (message, format!("leave a gap of {thickness:.3e} between them"))
        }
        StartFault::NoRoom { body, place, depth, reason, touches, thickness } => {
            let why = match touches {
                true => "touches another body at the start".to_owned(),
                false => format!("is nearer to another body than the given thickness {thickness:.3e}"),
            };
            let message = format!(
                "`{}` {why}, and its surface cannot be inset by {depth:.3e} near {}: {reason}",
                name(*body),
                at(place)
            );
            let remedy =
                format!("leave a gap of {thickness:.3e}, make `thickness` smaller, or leave the body out by `exclude`");
            (message, remedy)
        }
        StartFault::NotKept { thickness } => (
            format!("inset surfaces of bodies that touch do not keep the thickness {thickness:.3e}"),
            "leave a gap between the bodies".into(),
        ),
        StartFault::InsetTooNear { bodies: [a, b], place, distance: None, .. } => {
            (format!("`{}` and `{}` overlap at the start, near {}", name(*a), name(*b), at(place)), PART.into())
        }
        StartFault::InsetTooNear { bodies: [a, b], place, distance: Some(distance), thickness } => {
            let message = format!(
                "inset surfaces of `{}` and `{}`, which touch at the start, are {distance:.3e} apart near {}, less than the thickness {thickness:.3e}",
                name(*a),
                name(*b),
                at(place)
            );
            (message, "make `thickness` smaller, or leave a gap between the bodies".into())
        }
        // What is new there is told in its words.
        _ => (
            StartError { fault: fault.clone(), edge: *edge }.to_string(),
            "see general contact in docs/guide/contact.md".into(),
        ),
    }
}
