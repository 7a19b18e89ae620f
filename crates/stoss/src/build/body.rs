//! Meshes, laws, densities, initial velocities.

use super::fibres;
use super::mesh_files::MeshFiles;
use super::placed::{Discretisation, Placed};
use super::round;
use super::section::{self, SectionSlice};
use super::state_output;
use super::symmetry;
use super::trace::{Needs, Traces};
use super::{OwnLaws, ParameterError, Problems};
use crate::scene::{
    Body as SceneBody, Cell, Generator, Integration, Mass, Material, MeshFile, MeshSource, Portion as ScenePortion,
    Refinement as SceneRefinement, Rotation as SceneRotation, Rotations, Scene, SetDefinition, Volumetric, given,
};
use crate::solver::{Damping, Model};
use std::collections::BTreeMap;
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::{MassKind, SolidBody, SolidError, SolidOptions, Volumetric as SolidVolumetric};
use stoss_mesh::generate::{
    Ball, Block, Cylinder, Disc, Hexahedron, HollowBall, HollowTorus, Indenter, LBlock, Portion, Rectangle, Refinement,
};
use stoss_mesh::{Mesh, MeshError, Region, Rotation};
use stoss_reference_element::{CellKind, Integration as CellIntegration};

/// Adds all bodies to the model; bodies with problems are left out.
pub(super) fn bodies(
    scene: &Scene,
    laws: &OwnLaws,
    model: &mut Model,
    mesh_files: &mut MeshFiles,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> (Vec<Placed>, Vec<String>, SectionSlice) {
    let needs = Needs::of(scene);
    let mut section = SectionSlice::default();
    let mut placed = Vec::new();
    let mut lines = Vec::new();
    for (b, body) in scene.bodies.iter().enumerate() {
        let key = format!("body[{b}]");
        let law = match law(&body.material, laws) {
            Ok(law) => Some(law),
            Err(ParameterError { key: parameter, message, remedy }) if parameter.is_empty() => {
                problems.add(format!("{key}.material"), &body.material.law, message, remedy);
                None
            }
            Err(ParameterError { key: parameter, message, remedy }) => {
                let value = if parameter == "law" { &body.material.law } else { "" };
                problems.add(format!("{key}.material.{parameter}"), value, message, remedy);
                None
            }
        };
        let mut notes = Vec::new();
        let mesh = mesh(scene, b, mesh_files, &mut section, &mut notes, problems);
        let (Some(law), Some(mesh)) = (law, mesh) else { continue };
        let kinds = mesh.elements.kinds();
        if body.integration == Integration::Reduced
            && !kinds.iter().any(|kind| kind.rule(CellIntegration::Reduced).is_some())
        {
            let message = format!("{} has no reduced integration", names(&kinds));
            let remedy = "leave `integration` out, or make the elements hex20 or tet10 by `cell`";
            problems.add(format!("{key}.integration"), body.integration, message, remedy);
            continue;
        }
        if let Some(kind) = kinds.iter().find(|kind| matches!(kind, CellKind::Tet4 | CellKind::Wedge6)) {
            notes.push(format!(
                "{kind} is far too stiff in bending and for nearly incompressible materials: prefer `cell = \"quadratic\"`"
            ));
        }
        let first_node = (model.reference.len() / 3) as u32;
        let mut solid = match SolidBody::with_options(&body.name, &mesh, first_node, Arc::clone(&law), options(body)) {
            Ok(solid) => solid,
            Err(error @ SolidError::NoVolumetricPart { .. }) => {
                let remedy = "leave `volumetric` out, or choose another law than saint-venant-kirchhoff";
                problems.add(format!("{key}.volumetric"), body.volumetric(), error.to_string(), remedy);
                continue;
            }
            Err(error) => {
                problems.add(format!("{key}.mesh"), "", error.to_string(), "correct the mesh");
                continue;
            }
        };
        if let Some(of_body) = &body.material.inelasticity.fibres {
            let key = format!("{key}.material.fibres");
            if fibres::set(of_body, &key, &mesh, &mut solid, problems).is_none() {
                continue;
            }
        }
        for x in &mesh.nodes {
            model.reference.extend_from_slice(x);
            if scene.is_dynamic() {
                model.velocity.extend_from_slice(&body.initial_velocity(*x));
            }
        }
        let yields = body.material.inelasticity.plasticity.is_some();
        let follows_flow =
            body.integration == Integration::Reduced && kinds.iter().all(|kind| *kind == CellKind::Hex20);
        if yields && !follows_flow && body.volumetric == Some(Volumetric::Displacement) {
            warnings.push(format!(
                "body `{}`: elements with `volumetric = \"displacement\"` lock in plastic flow, which keeps the volume; leave `volumetric` out",
                body.name
            ));
        }
        let quality = mesh.quality();
        warnings.extend(quality.warning().map(|warning| format!("body `{}`: {warning}", body.name)));
        // The sides of a slice hold such modes.
        if body.integration == Integration::Reduced && scene.header.section.is_none() {
            warnings.extend(warn_of_single_rows(&body.name, &mesh));
        }
        lines.push(format!(
            "{}: {} nodes, {}{}, {}, {}",
            body.name,
            mesh.nodes.len(),
            names(&kinds),
            if body.volumetric() == Volumetric::Mixed { " mixed" } else { "" },
            state_output::described(&body.material, &*law),
            quality,
        ));
        lines.extend(notes.iter().map(|note| format!("{}: note: {note}", body.name)));
        model.bodies.push(crate::solver::Body {
            solid,
            nodes: first_node..first_node + mesh.nodes.len() as u32,
            density: body.density.filter(|_| scene.is_dynamic()),
            damping: body.damping.map_or_else(Damping::default, |d| Damping { mass: d.mass, stiffness: d.stiffness }),
            mass_kind: match body.mass {
                Mass::Consistent => MassKind::Consistent,
                Mass::Lumped => MassKind::Lumped,
            },
            massless: None,
        });
        let mut traces = Traces::add(&mesh, needs, first_node, model);
        if needs.trace {
            let finer = round::finer_facets(&key, &body.round, &mesh, problems);
            if let Err(x) = traces.refine(&finer, first_node, model) {
                let x = x.map(|x| crate::solver::short(x, 1.0));
                let message = format!(
                    "the surface is too far from the element at ({}): more than half of its depth",
                    x.join(", ")
                );
                problems.add(format!("{key}.round"), "", message, "take finer elements there, or remove the entry");
            }
        }
        placed.push(Placed { name: body.name.clone(), shape: Discretisation::Solid { mesh, law, traces }, first_node });
    }
    (placed, lines, section)
}

/// Elements hex20 that have neighbours in one direction at most: with reduced integration nothing beside them takes their modes without stiffness.
pub(crate) fn single_rows(mesh: &Mesh) -> Vec<u32> {
    let faces = CellKind::Hex20.faces();
    let mut outside: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for facet in mesh.boundary_facets() {
        if mesh.elements.kind(facet.element as usize) == CellKind::Hex20 {
            outside.entry(facet.element).or_default().push(usize::from(facet.local));
        }
    }
    let are_opposite = |a: usize, b: usize| !faces[a].nodes.iter().any(|node| faces[b].nodes.contains(node));
    let directions = |list: &[usize]| {
        let pairs = list.iter().enumerate().flat_map(|(k, &a)| list[k + 1..].iter().map(move |&b| (a, b)));
        pairs.filter(|&(a, b)| are_opposite(a, b)).count()
    };
    outside.into_iter().filter(|(_, list)| directions(list) >= 2).map(|(element, _)| element).collect()
}

/// Warns of them.
fn warn_of_single_rows(name: &str, mesh: &Mesh) -> Option<String> {
    let rows = single_rows(mesh);
    let first = rows.first()?;
    Some(format!(
        "body `{name}`: {} of {} elements are in a single row (the first is element {first}): hex20 with `integration = \"reduced\"` has zero-energy modes there, unless supports or other bodies prevent them, and the system is then singular. Use two elements through the thickness, or `integration = \"full\"`",
        rows.len(),
        mesh.elements.len()
    ))
}

/// Names of kinds of cells, for people.
fn names(kinds: &[CellKind]) -> String {
    kinds.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ")
}

/// How the elements of a body are integrated.
pub(super) fn options(body: &SceneBody) -> SolidOptions {
    SolidOptions {
        integration: match body.integration {
            Integration::Full => CellIntegration::Full,
            Integration::Reduced => CellIntegration::Reduced,
        },
        volumetric: match body.volumetric() {
            Volumetric::Displacement => SolidVolumetric::Displacement,
            Volumetric::Mixed => SolidVolumetric::Mixed,
        },
    }
}

/// The law of a material: of the catalogue, or of the program's own.
fn law(material: &Material, laws: &OwnLaws) -> Result<Arc<dyn HyperelasticLaw>, ParameterError> {
    match stoss_materials::entry(&material.law) {
        Some(entry) => Ok(material.inelasticity.history().of(entry.with(given(&material.parameters))?)?),
        None => laws.make(material),
    }
}

fn generate(generator: &Generator) -> Result<Mesh, MeshError> {
    match generator {
        Generator::Block(g) => {
            let (min, max) = g.bounds();
            Block { min, max, divisions: g.divisions, grading: g.grading }.generate()
        }
        Generator::HollowBall(g) => {
            HollowBall { inner_diameter: g.inner_diameter, outer_diameter: g.outer_diameter, divisions: g.divisions }
                .generate()
        }
        Generator::HollowTorus(g) => HollowTorus {
            ring_radius: g.ring_radius,
            tube_outer_radius: g.tube_outer_radius,
            tube_inner_radius: g.tube_inner_radius,
            divisions: g.divisions,
        }
        .generate(),
        Generator::Hexahedron(g) => {
            Hexahedron { corners: g.corners, divisions: g.divisions, grading: g.grading }.generate()
        }
        Generator::Indenter(g) => {
            Indenter { width: g.size, height: g.height, radius: g.radius, divisions: g.divisions, grading: g.grading }
                .generate()
        }
        Generator::Ball(g) => Ball {
            radius: g.radius,
            part: part(g.part),
            divisions: g.divisions,
            refinement: g.refinement.map(refinement),
        }
        .generate(),
        Generator::Cylinder(g) => Cylinder {
            radius: g.radius,
            length: g.length,
            part: part(g.part),
            divisions: g.divisions,
            refinement: g.refinement.map(refinement),
        }
        .generate(),
        Generator::Rectangle(g) => {
            Rectangle { min: g.min, max: g.max, divisions: g.divisions, grading: g.grading }.generate()
        }
        Generator::Disc(g) => Disc {
            radius: g.radius,
            part: part(g.part),
            divisions: g.divisions,
            refinement: g.refinement.map(refinement),
        }
        .generate(),
        Generator::LShape(g) => {
            LBlock { length: g.length, width: g.width, thickness: g.thickness, divisions: g.divisions }.generate()
        }
    }
}

fn part(part: ScenePortion) -> Portion {
    match part {
        ScenePortion::Full => Portion::Full,
        ScenePortion::Half => Portion::Half,
        ScenePortion::Quarter => Portion::Quarter,
        ScenePortion::Eighth => Portion::Eighth,
    }
}

fn refinement(zone: SceneRefinement) -> Refinement {
    Refinement { half_width: zone.half_width, elements: zone.elements }
}

/// A body's mesh in its place, with the scene's sets.
fn mesh(
    scene: &Scene,
    b: usize,
    mesh_files: &mut MeshFiles,
    section: &mut SectionSlice,
    notes: &mut Vec<String>,
    problems: &mut Problems<'_>,
) -> Option<Mesh> {
    let body = &scene.bodies[b];
    let key = format!("body[{b}]");
    let mut mesh = source_mesh(&body.mesh, &format!("{key}.mesh"), mesh_files, notes, problems)?;
    #[cfg(feature = "mesh-files")]
    if let MeshSource::File(source) = &body.mesh {
        // The import of decks writes layers as they are.
        let is_plane = mesh_files.is_plane(&source.file) || (scene.header.section.is_some() && mesh.is_layer());
        section::fits(scene, is_plane, &format!("{key}.mesh"), &source.file, problems)?;
    }
    if let Some(cell) = body.cell {
        let turned = match cell {
            Cell::Kind(kind) => mesh.with_cells(kind),
            Cell::Quadratic => mesh.quadratic(),
        };
        mesh = turned
            .map_err(|error| {
                let remedy = match &error {
                    MeshError::CurvedBoundary { .. } => {
                        "take more `divisions`, or a finer mesh, or `cell = \"hex20\"` for hexahedra, or leave `cell` out"
                    }
                    _ => "leave `cell` out, or choose one that the mesh's elements can become",
                };
                problems.add(format!("{key}.cell"), cell.name(), error.to_string(), remedy);
            })
            .ok()?;
    }
    place(&key, &body.rotation, body.position, problems, |rotation, by| mesh.transform(rotation, by))?;
    let mesh = section.slice(scene, &key, mesh, problems)?;
    let mut mesh = symmetry::cut(scene, &key, mesh, problems)?;
    if let Err(error) = mesh.check_allowing_coincident() {
        problems.add(format!("{key}.mesh"), "", error.to_string(), "correct the mesh");
        return None;
    }
    for (s, set) in scene.sets.iter().enumerate().filter(|(_, set)| set.body == body.name) {
        let Some(region) = region(&section::across(scene, set), mesh.bounding_box()) else { continue };
        if let Err(error) = mesh.add_region_sets(set.local_name(), &region) {
            set_refused(s, set, &error, &mesh.set_names(), problems);
        }
    }
    Some(mesh)
}

/// The mesh of a generator or a file, where that has it; `notes` get what the user should know about a file.
pub(super) fn source_mesh(
    source: &MeshSource,
    key: &str,
    mesh_files: &mut MeshFiles,
    notes: &mut Vec<String>,
    problems: &mut Problems<'_>,
) -> Option<Mesh> {
    match source {
        MeshSource::Generator(generator) => generate(generator)
            .map_err(|error| problems.add(key.to_owned(), "", error.to_string(), "correct the generator's parameters"))
            .ok(),
        MeshSource::File(source) => read(source, key, mesh_files, notes, problems),
    }
}

/// The region of a set in a part with this bounding box.
pub(super) fn region(set: &SetDefinition, (low, high): ([f64; 3], [f64; 3])) -> Option<Region> {
    match (&set.inside, &set.plane) {
        (Some(region), _) => Some(Region::Box { min: region.min, max: region.max }),
        (None, Some(plane)) => {
            // Without a tolerance: a millionth of the body's size.
            let size = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
            let tolerance = plane.tolerance.unwrap_or(1.0e-6 * size);
            Some(Region::Plane { point: plane.point, normal: plane.normal, tolerance })
        }
        (None, None) => None,
    }
}

/// Reports that a set cannot be made; `names` are the sets that there are.
pub(super) fn set_refused(
    s: usize,
    set: &SetDefinition,
    error: &MeshError,
    names: &[String],
    problems: &mut Problems<'_>,
) {
    let remedy = match error {
        MeshError::SetExists { .. } => format!("body `{}` has of its own: {}", set.body, names.join(", ")),
        _ => "move or enlarge the region; positions are those of the body in its place".to_owned(),
    };
    problems.add(format!("set[{s}]"), &set.name, error.to_string(), remedy);
}

/// Rotations one after the other, then the translation; `transform` does one of them.
pub(super) fn place(
    key: &str,
    rotations: &Rotations,
    position: [f64; 3],
    problems: &mut Problems<'_>,
    mut transform: impl FnMut(Option<&Rotation>, [f64; 3]) -> Result<(), MeshError>,
) -> Option<()> {
    let mut refused = |name: &str, error: MeshError| {
        problems.add(format!("{key}.{name}"), "", error.to_string(), "correct the placement");
    };
    for SceneRotation { axis, degrees, about } in rotations.as_slice() {
        let rotation = Rotation { axis: *axis, degrees: *degrees, about: *about };
        transform(Some(&rotation), [0.0; 3]).map_err(|error| refused("rotation", error)).ok()?;
    }
    transform(None, position).map_err(|error| refused("position", error)).ok()
}

#[cfg(feature = "mesh-files")]
fn read(
    source: &MeshFile,
    key: &str,
    mesh_files: &mut MeshFiles,
    notes: &mut Vec<String>,
    problems: &mut Problems<'_>,
) -> Option<Mesh> {
    let MeshFile { file, group, scale } = source;
    let contents = match mesh_files.contents(file) {
        Ok(contents) => contents,
        Err((message, remedy)) => {
            problems.add(format!("{key}.file"), file, message, remedy);
            return None;
        }
    };
    notes.extend(contents.notes().iter().cloned());
    let mut mesh = match contents.mesh(group.as_deref()) {
        Ok(mesh) => mesh,
        Err(error @ stoss_mesh_io::MeshIoError::NoGroup { .. }) => {
            let group = group.as_deref().unwrap_or_default();
            problems.add(format!("{key}.group"), group, error.to_string(), "name one of the groups of the file");
            return None;
        }
        Err(error) => {
            problems.add(format!("{key}.file"), file, error.to_string(), "correct the file or name another");
            return None;
        }
    };
    // Across a section there is nothing to scale.
    let axes = if contents.is_plane() { 2 } else { 3 };
    mesh.nodes.iter_mut().for_each(|x| x[..axes].iter_mut().for_each(|x| *x *= scale));
    if let Some(coincident) = mesh.coincident_nodes() {
        notes.push(format!(
            "{} nodes coincide with another one, in {} pieces: elements that do not share nodes are not joined",
            coincident.count,
            mesh.pieces()
        ));
    }
    Some(mesh)
}

#[cfg(not(feature = "mesh-files"))]
fn read(
    source: &MeshFile,
    key: &str,
    _: &mut MeshFiles,
    _: &mut Vec<String>,
    problems: &mut Problems<'_>,
) -> Option<Mesh> {
    let message = "this build of Stoss reads no mesh files";
    problems.add(format!("{key}.file"), &source.file, message, "build it with the cargo feature `mesh-files`");
    None
}
