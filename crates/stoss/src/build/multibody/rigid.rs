//! Rigid bodies: surface, mass, place, motion.

use super::Parts;
use super::extent::extent;
use crate::build::body::{place, region, set_refused, source_mesh};
use crate::build::mesh_files::MeshFiles;
use crate::build::placed::{Discretisation, Placed};
use crate::build::{DrawnPoint, DrawnSurface, Problems};
use crate::scene::{Rigid, Rotation as SceneRotation, Scene, Shape as SceneShape, SurfaceFile};
use crate::solver::Model;
use std::collections::BTreeMap;
use stoss_mesh::surface::{Cone, Cuboid, Cylinder, Plane, RoundDivisions, Sphere};
use stoss_mesh::{MassProperties, Mesh, MeshError, Rotation, SurfaceMesh};
use stoss_multibody::{RigidBody, RigidMass};

/// Adds all rigid bodies to the model; those with problems are left out.
pub(super) fn rigids(
    scene: &Scene,
    model: &mut Model,
    mesh_files: &mut MeshFiles,
    parts: &mut Parts,
    problems: &mut Problems<'_>,
) {
    for (r, item) in scene.rigids.iter().enumerate() {
        let key = format!("rigid[{r}]");
        let mut notes = Vec::new();
        let Some(shape) = shape(scene, item, &key, mesh_files, &mut notes, problems) else { continue };
        let first = model.node_count() as u32;
        let length = extent(scene, &model.reference);
        let Some(body) = body(item, &key, shape.as_ref(), length, first, problems) else { continue };
        model.reference.extend(body.reference().iter().flatten());
        if scene.is_dynamic() {
            model.velocity.extend(body.velocity(item.velocity, item.angular_velocity).iter().flatten());
        }
        let placed = match shape {
            Some(Outline { surface, .. }) => {
                let first_node = model.node_count() as u32;
                for (k, x) in surface.nodes.iter().enumerate() {
                    model.reference.extend(x);
                    model.embedding.add(first_node + k as u32, &body.point(*x).terms);
                }
                if scene.is_dynamic() {
                    // They follow the body.
                    model.velocity.resize(model.reference.len(), 0.0);
                }
                parts.drawing.surfaces.push(DrawnSurface {
                    name: item.name.clone(),
                    nodes: first_node..model.node_count() as u32,
                    facets: surface.facets.iter().map(|facet| facet.map(|n| n + first_node)).collect(),
                    is_closed: surface.is_closed(),
                });
                Placed { name: item.name.clone(), shape: Discretisation::Surface(surface), first_node }
            }
            None => {
                parts.drawing.points.push(DrawnPoint { name: item.name.clone(), node: first });
                let sets = BTreeMap::from([("all".to_owned(), vec![0])]);
                let shape = Discretisation::Nodes {
                    positions: vec![body.reference()[0]],
                    stride: 1,
                    sets,
                    lengths: Vec::new(),
                };
                Placed { name: item.name.clone(), shape, first_node: first }
            }
        };
        parts.lines.push(line(item, &body, &placed));
        parts.lines.extend(notes.iter().map(|note| format!("{}: note: {note}", item.name)));
        parts.placed.push(placed);
        model.parts.push(Box::new(body.clone()));
        parts.rigids.push(body);
    }
}

/// The surface of a rigid body in its place, and the mesh that it bounds if there is one.
struct Outline {
    surface: SurfaceMesh,
    mesh: Option<Mesh>,
}

/// `None` after a problem, `Some(None)` for a body without a surface.
fn shape(
    scene: &Scene,
    item: &Rigid,
    key: &str,
    mesh_files: &mut MeshFiles,
    notes: &mut Vec<String>,
    problems: &mut Problems<'_>,
) -> Option<Option<Outline>> {
    let refused = |name: &str, error: &MeshError, problems: &mut Problems<'_>| {
        problems.add(format!("{key}.{name}"), "", error.to_string(), "correct the surface of the body");
    };
    let (mut surface, mut mesh, name) = if let Some(shape) = &item.shape {
        let made = generate(shape).map_err(|error| refused("shape", &error, problems)).ok()?;
        (made, None, "shape")
    } else if let Some(source) = &item.mesh {
        let mesh = source_mesh(source, &format!("{key}.mesh"), mesh_files, notes, problems)?;
        let surface = SurfaceMesh::from_mesh(&mesh).map_err(|error| refused("mesh", &error, problems)).ok()?;
        (surface, Some(mesh), "mesh")
    } else if let Some(file) = &item.surface {
        (read_surface(file, key, mesh_files, problems)?, None, "surface")
    } else {
        return Some(None);
    };
    place(key, &item.rotation, item.position, problems, |rotation, by| surface.transform(rotation, by))?;
    if let Some(mesh) = &mut mesh {
        place(key, &item.rotation, item.position, problems, |rotation, by| mesh.transform(rotation, by))?;
        mesh.check_allowing_coincident().map_err(|error| refused(name, &error, problems)).ok()?;
    }
    surface.check().map_err(|error| refused(name, &error, problems)).ok()?;
    for (s, set) in scene.sets.iter().enumerate().filter(|(_, set)| set.body == item.name) {
        let Some(region) = region(set, surface.bounding_box()) else { continue };
        if let Err(error) = surface.add_region_set(set.local_name(), &region) {
            set_refused(s, set, &error, &surface.set_names(), problems);
        }
    }
    Some(Some(Outline { surface, mesh }))
}

fn generate(shape: &SceneShape) -> Result<SurfaceMesh, MeshError> {
    let round = |[around, along, radial]: [u32; 3]| RoundDivisions { around, along, radial };
    match shape {
        SceneShape::Sphere(s) => Sphere { radius: s.radius, divisions: s.divisions }.generate(),
        SceneShape::Box(s) => Cuboid { size: s.size, divisions: s.divisions }.generate(),
        SceneShape::Plane(s) => Plane { size: s.size, divisions: s.divisions }.generate(),
        SceneShape::Cylinder(s) => {
            Cylinder { radius: s.radius, length: s.length, divisions: round(s.divisions) }.generate()
        }
        SceneShape::Cone(s) => {
            let (divisions, tip_radius) = (round(s.divisions), s.tip_radius);
            Cone { radius: s.radius, height: s.height, tip_radius, divisions }.generate()
        }
    }
}

#[cfg(feature = "mesh-files")]
fn read_surface(
    file: &SurfaceFile,
    key: &str,
    mesh_files: &mut MeshFiles,
    problems: &mut Problems<'_>,
) -> Option<SurfaceMesh> {
    match mesh_files.surface(&file.file) {
        Ok(mut surface) => {
            surface.nodes.iter_mut().flatten().for_each(|x| *x *= file.scale);
            Some(surface)
        }
        Err((message, remedy)) => {
            problems.add(format!("{key}.surface.file"), &file.file, message, remedy);
            None
        }
    }
}

#[cfg(not(feature = "mesh-files"))]
fn read_surface(file: &SurfaceFile, key: &str, _: &mut MeshFiles, problems: &mut Problems<'_>) -> Option<SurfaceMesh> {
    let message = "this build of Stoss reads no files of surfaces";
    problems.add(format!("{key}.surface.file"), &file.file, message, "build it with the cargo feature `mesh-files`");
    None
}

/// The rigid body with its mass. `length` is one that is typical of the scene, for a body without a surface.
fn body(
    item: &Rigid,
    key: &str,
    outline: Option<&Outline>,
    length: f64,
    first: u32,
    problems: &mut Problems<'_>,
) -> Option<RigidBody> {
    let middle = outline.map_or(item.position, |outline| {
        let (low, high) = outline.surface.bounding_box();
        std::array::from_fn(|i| 0.5 * (low[i] + high[i]))
    });
    let size = outline.map_or(length, |outline| {
        let (low, high) = outline.surface.bounding_box();
        0.5 * (0..3).map(|i| (high[i] - low[i]).powi(2)).sum::<f64>().sqrt()
    });
    let given = match (item.density, item.mass) {
        (Some(density), _) if density > 0.0 => {
            let outline = outline?;
            let properties = properties(item, outline, density);
            let remedy = "correct the surface, or give `mass` and `inertia` instead of `density`";
            let properties = properties
                .map_err(|error| problems.add(format!("{key}.density"), density, error.to_string(), remedy))
                .ok()?;
            RigidMass::of_tensor(properties.mass, properties.centre, properties.euler)
        }
        (_, Some(mass)) if mass > 0.0 => {
            let centre = item.centre.unwrap_or(middle);
            // Statics have no rotary inertia: then any will do.
            let euler = item.principal_euler().unwrap_or([mass * size * size / 5.0; 3]);
            let axes = match item.axes {
                Some(axes) => axes,
                None => turned(item, UNIT)
                    .map_err(|error| {
                        problems.add(format!("{key}.rotation"), "", error.to_string(), "correct the placement");
                    })
                    .ok()?,
            };
            RigidMass::new(mass, centre, euler, axes)
        }
        _ => {
            let made = RigidBody::massless(&item.name, first, item.centre.unwrap_or(middle), UNIT, size);
            return made
                .map_err(|error| {
                    problems.add(key.to_owned(), &item.name, error.to_string(), "correct the body's place")
                })
                .ok();
        }
    };
    match given {
        Ok(mass) => Some(RigidBody::new(&item.name, first, mass)),
        Err(error) => {
            problems.add(key.to_owned(), &item.name, error.to_string(), "correct mass or inertia of the body");
            None
        }
    }
}

/// Directions of the body's own coordinates in its place.
fn turned(item: &Rigid, mut axes: [[f64; 3]; 3]) -> Result<[[f64; 3]; 3], MeshError> {
    for SceneRotation { axis, degrees, about } in item.rotation.as_slice() {
        let r = Rotation { axis: *axis, degrees: *degrees, about: *about }.matrix()?;
        let turn = |v: [f64; 3]| std::array::from_fn(|i| r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2]);
        axes = axes.map(turn);
    }
    Ok(axes)
}

const UNIT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Mass, centre and Euler tensor in the body's place: of a shape in closed form, of a mesh by its elements, of a surface by its inside.
fn properties(item: &Rigid, outline: &Outline, density: f64) -> Result<MassProperties, MeshError> {
    let own = match &item.shape {
        Some(SceneShape::Sphere(s)) => MassProperties::of_sphere(s.radius, density)?,
        Some(SceneShape::Box(s)) => MassProperties::of_cuboid(s.size, density)?,
        Some(SceneShape::Cylinder(s)) => MassProperties::of_cylinder(s.radius, s.length, density)?,
        Some(SceneShape::Cone(s)) => MassProperties::of_cone(s.radius, s.height, s.tip_radius, density)?,
        Some(SceneShape::Plane(_)) | None => {
            return match &outline.mesh {
                Some(mesh) => MassProperties::of_mesh(mesh, density),
                None => MassProperties::of_surface(&outline.surface, density),
            };
        }
    };
    let mut properties = own;
    for SceneRotation { axis, degrees, about } in item.rotation.as_slice() {
        let r = Rotation { axis: *axis, degrees: *degrees, about: *about }.matrix()?;
        let arm: [f64; 3] = std::array::from_fn(|i| properties.centre[i] - about[i]);
        let row = |i: usize, v: [f64; 3]| r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2];
        properties.centre = std::array::from_fn(|i| about[i] + row(i, arm));
        let e = properties.euler;
        let turned: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|k| (0..3).map(|j| r[i][j] * e[j][k]).sum()));
        properties.euler = std::array::from_fn(|i| std::array::from_fn(|k| row(k, turned[i])));
    }
    for (c, by) in properties.centre.iter_mut().zip(item.position) {
        *c += by;
    }
    Ok(properties)
}

/// What `check` says of the body.
fn line(item: &Rigid, body: &RigidBody, placed: &Placed) -> String {
    let facets = placed.facets_of("all").map_or(0, |facets| facets.len());
    let mass = body.mass();
    let [x, y, z] = mass.centre;
    let weight = match mass.mass {
        0.0 => "no mass".to_owned(),
        m => {
            format!("mass {m:.6e}, centre of mass ({x:.4}, {y:.4}, {z:.4}), Euler tensor {:.3e}", mass.euler[0])
                + &format!(", {:.3e}, {:.3e}", mass.euler[1], mass.euler[2])
        }
    };
    format!("rigid {}: {facets} facets, {weight}", item.name)
}
