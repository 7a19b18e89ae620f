//! Plane sections: how their meshes become slices, and what holds the sides of these.

use super::Problems;
use super::condition::InclinedPrescription;
use super::placed::{Discretisation, Placed};
use crate::scene::{BoxRegion, Component, PlaneSection, Prescribe, Scene, SetDefinition};
use std::borrow::Cow;
use std::collections::BTreeSet;
use stoss_mesh::slice::{AXIS, HIGH, LOW, MIDDLE, Slice};
use stoss_mesh::{ALL, Mesh};

/// Angle of the slice of a body of revolution in degrees. Shears between its sides are of the order of its square.
const ANGLE: f64 = 2.0;
/// Diagonal of the first mesh over the thickness of the slice of a plate or a long body.
const PARTS: f64 = 100.0;

/// The slice of a scene of sections; it is known with the first mesh.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SectionSlice {
    slice: Option<Slice>,
}

impl SectionSlice {
    /// What forces, areas, energies of the slice are divided by; 1 without a section.
    pub fn extent(self) -> f64 {
        self.slice.map_or(1.0, Slice::extent)
    }

    /// The slice of a layer of a scene with a section; otherwise the mesh as it is.
    pub fn slice(&mut self, scene: &Scene, key: &str, mesh: Mesh, problems: &mut Problems<'_>) -> Option<Mesh> {
        let Some(kind) = scene.header.section else { return Some(mesh) };
        let slice = *self.slice.get_or_insert_with(|| match kind {
            PlaneSection::Axisymmetric => Slice::Sector(ANGLE.to_radians()),
            PlaneSection::PlaneStrain | PlaneSection::PlaneStress => {
                let (low, high) = mesh.bounding_box();
                Slice::Plate((high[0] - low[0]).hypot(high[1] - low[1]) / PARTS)
            }
        });
        let remedy = "correct the mesh, or move it by `position`";
        mesh.slice(slice).map_err(|error| problems.add(format!("{key}.mesh"), "", error.to_string(), remedy)).ok()
    }
}

/// Whether a file whose mesh is `plane` goes with the scene; otherwise reports it.
#[cfg(feature = "mesh-files")]
pub(super) fn fits(scene: &Scene, plane: bool, key: &str, file: &str, problems: &mut Problems<'_>) -> Option<()> {
    let (message, remedy) = match (scene.header.section, plane) {
        (None, false) | (Some(_), true) => return Some(()),
        (None, true) => (
            "has plane elements only",
            "say in [scene] what they are a `section` of: \"axisymmetric\", \"plane-strain\" or \"plane-stress\"; or mesh the volume",
        ),
        (Some(_), false) => {
            ("has solid elements, and the scene has a `section`", "take a mesh of plane elements in the plane z = 0")
        }
    };
    problems.add(format!("{key}.file"), file, message, remedy);
    None
}

/// The region of a set, without bounds across the section.
pub(super) fn across<'a>(scene: &Scene, set: &'a SetDefinition) -> Cow<'a, SetDefinition> {
    match (scene.header.section, set.inside) {
        (Some(_), Some(BoxRegion { mut min, mut max })) => {
            (min[2], max[2]) = (f64::NEG_INFINITY, f64::INFINITY);
            Cow::Owned(SetDefinition { inside: Some(BoxRegion { min, max }), ..set.clone() })
        }
        _ => Cow::Borrowed(set),
    }
}

/// Reports tools that do not reach over the section.
pub(super) fn tools(scene: &Scene, placed: &[Placed], problems: &mut Problems<'_>) {
    if scene.header.section.is_none() {
        return;
    }
    for part in placed {
        let Discretisation::Surface(surface) = &part.shape else { continue };
        let has = |side: f64| surface.nodes.iter().any(|x| side * x[2] > 0.0);
        if !(has(1.0) && has(-1.0)) {
            let key = scene.rigids.iter().position(|rigid| rigid.name == part.name).unwrap_or_default();
            let message = "lies on one side of the section, z = 0, or in it: the slice would miss it";
            problems.add(format!("rigid[{key}].position"), &part.name, message, "let it reach over z = 0");
        }
    }
}

/// Supports without nodes that a tie moves: they lie in the sides of the slice where the master does. Those from the prescription `own` on are of sections.
pub(super) fn without_tied(
    mut inclined: Vec<InclinedPrescription>,
    own: usize,
    tied: &BTreeSet<u32>,
) -> Vec<InclinedPrescription> {
    for support in inclined.iter_mut().filter(|support| support.item >= own) {
        support.nodes.retain(|node| !tied.contains(node));
    }
    inclined.retain(|support| !support.nodes.is_empty());
    inclined
}

/// What holds the sides of the slices.
pub(super) fn supports(scene: &Scene, placed: &[Placed]) -> Vec<Prescribe> {
    let Some(kind) = scene.header.section else { return Vec::new() };
    let (sin, cos) = (0.5 * ANGLE.to_radians()).sin_cos();
    let mut held = Vec::new();
    for part in placed {
        let Some(mesh) = part.mesh() else { continue };
        let mut hold = |set: &str, components: &[Component], normal: Option<[f64; 3]>| {
            if set == ALL || mesh.node_sets.contains_key(set) {
                let fixed = Prescribe::fixed(format!("{}.{set}", part.name));
                held.push(Prescribe { components: components.to_vec(), normal, ..fixed });
            }
        };
        match kind {
            PlaneSection::Axisymmetric => {
                hold(LOW, &[], Some([sin, 0.0, cos]));
                hold(MIDDLE, &[Component::Z], None);
                hold(HIGH, &[], Some([-sin, 0.0, cos]));
                hold(AXIS, &[Component::X], None);
            }
            PlaneSection::PlaneStrain => hold(ALL, &[Component::Z], None),
            PlaneSection::PlaneStress => hold(LOW, &[Component::Z], None),
        }
    }
    held
}
