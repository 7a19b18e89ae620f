//! Beams, strings and point masses.

use super::Parts;
use super::extent::extent;
use crate::build::placed::{Discretisation, Placed};
use crate::build::{DrawnLine, DrawnPoint, Problems};
use crate::scene::{Beam as SceneBeam, Mass, Scene, Section as SceneSection, SectionShape};
use crate::solver::Model;
use std::collections::BTreeMap;
use stoss_multibody::{
    Area, Beam, BeamAxis, ElasticString, PartDataError, PointMass, Section, SectionMaterial, StringMaterial,
    axes_along, tributary_lengths,
};

/// Adds beams, strings and point masses to the model; those with problems are left out.
pub(super) fn lines(scene: &Scene, model: &mut Model, parts: &mut Parts, problems: &mut Problems<'_>) {
    for (b, item) in scene.beams.iter().enumerate() {
        let first = model.node_count() as u32;
        match beam(item, first) {
            Ok(beam) => {
                add_vectors(scene, model, &beam.reference(), || {
                    beam.rigid_velocity(item.velocity, item.angular_velocity, item.velocity_about)
                });
                let nodes = (0..beam.node_count()).map(|node| beam.node_vectors(node)[0]).collect();
                parts.drawing.lines.push(DrawnLine { name: item.name.clone(), nodes });
                let positions = beam.axis().positions().to_vec();
                parts.lines.push(format!(
                    "beam {}: {} elements of order {}, length {:.6e}, EA {:.3e}, EI {:.3e}, mass per length {:.3e}",
                    item.name,
                    beam.axis().elements(),
                    beam.axis().order(),
                    beam.length(),
                    beam.section().axial,
                    beam.section().bending[0],
                    beam.section().mass,
                ));
                let lengths = tributary_lengths(&positions, beam.axis().order()).unwrap_or_default();
                parts.placed.push(nodes_of(&item.name, positions, lengths, Beam::VECTORS, first));
                model.parts.push(Box::new(beam.clone()));
                parts.beams.push(beam);
            }
            Err(error) => problems.add(format!("beam[{b}]"), &item.name, error.to_string(), "correct the beam's data"),
        }
    }
    for (s, item) in scene.strings.iter().enumerate() {
        let first = model.node_count() as u32;
        match string(item, first) {
            Ok(string) => {
                add_vectors(scene, model, string.reference(), || vec![item.velocity; string.node_count()]);
                let nodes = (0..string.node_count()).map(|node| string.node_vector(node)).collect();
                parts.drawing.lines.push(DrawnLine { name: item.name.clone(), nodes });
                parts.lines.push(format!(
                    "string {}: {} nodes of order {}, natural length {:.6e}, EA {:.3e}",
                    item.name,
                    string.node_count(),
                    string.order(),
                    string.natural_length(),
                    item.axial_stiffness(),
                ));
                let positions = string.reference().to_vec();
                let lengths = tributary_lengths(&positions, string.order()).unwrap_or_default();
                parts.placed.push(nodes_of(&item.name, positions, lengths, 1, first));
                model.parts.push(Box::new(string.clone()));
                parts.strings.push(string);
            }
            Err(error) => {
                problems.add(format!("string[{s}]"), &item.name, error.to_string(), "correct the string's data")
            }
        }
    }
    for (m, item) in scene.masses.iter().enumerate() {
        let vector = model.node_count() as u32;
        // A point has no size of its own: that of the system decides what a small motion is.
        let size = extent(scene, &model.reference).max(f64::MIN_POSITIVE.sqrt());
        match PointMass::new(&item.name, vector, item.mass, size) {
            Ok(mass) => {
                add_vectors(scene, model, &[item.at], || vec![item.velocity]);
                parts.drawing.points.push(DrawnPoint { name: item.name.clone(), node: vector });
                parts.lines.push(format!("point {}: mass {:.6e}", item.name, item.mass));
                let sets = BTreeMap::from([("all".to_owned(), vec![0])]);
                let shape = Discretisation::Nodes { positions: vec![item.at], stride: 1, sets, lengths: Vec::new() };
                parts.placed.push(Placed { name: item.name.clone(), shape, first_node: vector });
                model.parts.push(Box::new(mass.clone()));
                parts.masses.push(mass);
            }
            Err(error) => problems.add(format!("mass[{m}]"), &item.name, error.to_string(), "correct the mass"),
        }
    }
}

fn add_vectors(scene: &Scene, model: &mut Model, reference: &[[f64; 3]], velocity: impl FnOnce() -> Vec<[f64; 3]>) {
    model.reference.extend(reference.iter().flatten());
    if scene.is_dynamic() {
        model.velocity.extend(velocity().iter().flatten());
    }
}

/// The sets `start`, `end`, `all` of nodes in a row.
fn nodes_of(name: &str, positions: Vec<[f64; 3]>, lengths: Vec<f64>, stride: u32, first_node: u32) -> Placed {
    let last = positions.len() as u32 - 1;
    let sets = [("start", vec![0]), ("end", vec![last]), ("all", (0..=last).collect())];
    let sets = sets.into_iter().map(|(name, nodes)| (name.to_owned(), nodes)).collect();
    Placed { name: name.to_owned(), shape: Discretisation::Nodes { positions, stride, sets, lengths }, first_node }
}

fn beam(item: &SceneBeam, first: u32) -> Result<Beam, PartDataError> {
    let (elements, order) = (item.elements as usize, item.order as usize);
    let axis = match &item.arc {
        Some(arc) => {
            let axis = BeamAxis::arc(arc.centre, arc.start, arc.axis, arc.degrees.to_radians(), elements, order)?;
            match item.up {
                Some(up) => BeamAxis::new(order, axis.positions().to_vec(), upright(axis.triads(), up))?,
                None => axis,
            }
        }
        None => {
            let counts = shares(&item.points, elements);
            // Where the section is the same in all directions any will do.
            let any = || axes_along(tangent(&item.points)).map_or([1.0, 0.0, 0.0], |axes| axes[1]);
            BeamAxis::polyline(&item.points, item.up.unwrap_or_else(any), &counts, order)?
        }
    };
    Beam::new(&item.name, first, axis, section(item)?)
}

/// Triads with the same normals and `d_1` along the part of `up` across them, which the scene has found not to vanish.
fn upright(triads: &[[[f64; 3]; 3]], up: [f64; 3]) -> Vec<[[f64; 3]; 3]> {
    let turned = |&[.., d3]: &[[f64; 3]; 3]| {
        let along: f64 = (0..3).map(|i| up[i] * d3[i]).sum();
        let across: [f64; 3] = std::array::from_fn(|i| up[i] - along * d3[i]);
        let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
        let d1 = across.map(|x| x / length);
        let d2 = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            d3[j] * d1[k] - d3[k] * d1[j]
        });
        [d1, d2, d3]
    };
    triads.iter().map(turned).collect()
}

/// Direction of the first piece.
fn tangent(points: &[[f64; 3]]) -> [f64; 3] {
    match points {
        [a, b, ..] => std::array::from_fn(|i| b[i] - a[i]),
        _ => [0.0; 3],
    }
}

/// The elements of each piece of a polyline: at least one, the rest by length.
fn shares(points: &[[f64; 3]], elements: usize) -> Vec<usize> {
    let length = |ends: &[[f64; 3]]| (0..3).map(|i| (ends[1][i] - ends[0][i]).powi(2)).sum::<f64>().sqrt();
    let lengths: Vec<f64> = points.windows(2).map(length).collect();
    let mut counts = vec![1; lengths.len()];
    for _ in lengths.len()..elements {
        // The piece whose elements are longest gets one more.
        let longest = (0..counts.len()).max_by(|&a, &b| {
            let size = |k: usize| lengths[k] / counts[k] as f64;
            // Of equals the first.
            size(a).total_cmp(&size(b)).then(b.cmp(&a))
        });
        if let Some(k) = longest {
            counts[k] += 1;
        }
    }
    counts
}

fn section(item: &SceneBeam) -> Result<Section, PartDataError> {
    let shape = match &item.section {
        SceneSection::Stiffness(s) => {
            let section = Section {
                axial: s.axial,
                shear: s.shear,
                bending: s.bending,
                torsion: s.torsion,
                mass: s.mass.unwrap_or(0.0),
                rotary: s.rotary.unwrap_or([0.0; 2]),
            };
            return section.check().map(|()| section);
        }
        SceneSection::Shape(shape) => shape,
    };
    let area = match shape {
        SectionShape::Rectangle(r) => Area::rectangle(r.size),
        SectionShape::Circle(c) => Area::circle(c.radius),
        SectionShape::Tube(t) => Area::tube(t.radius - t.thickness, t.radius),
    };
    let material = SectionMaterial {
        young: item.young.unwrap_or_default(),
        poisson: item.poisson.unwrap_or(SceneBeam::DEFAULT_POISSON),
        density: item.density.unwrap_or(0.0),
    };
    Section::new(area, material, item.shear_factor.unwrap_or(SceneBeam::DEFAULT_SHEAR_FACTOR), item.torsion_constant)
}

fn string(item: &crate::scene::ElasticString, first: u32) -> Result<ElasticString, PartDataError> {
    let corners = item.corners();
    let (order, counts) = (item.order as usize, shares(&corners, item.elements as usize));
    let mut nodes: Vec<[f64; 3]> = Vec::new();
    for (ends, count) in corners.windows(2).zip(counts) {
        let piece = ElasticString::straight_nodes(ends[0], ends[1], count, order)?;
        nodes.extend(&piece[usize::from(!nodes.is_empty())..]);
    }
    let present: f64 =
        corners.windows(2).map(|e| (0..3).map(|i| (e[1][i] - e[0][i]).powi(2)).sum::<f64>().sqrt()).sum();
    let material = StringMaterial {
        stiffness: item.axial_stiffness(),
        mass: item.mass_per_length().unwrap_or(0.0),
        lumped: item.mass_matrix == Mass::Lumped,
        tension_only: item.tension_only,
    };
    ElasticString::new(&item.name, first, order, nodes, material, present / item.natural_length())
}
