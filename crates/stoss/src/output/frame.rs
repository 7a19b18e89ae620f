//! Frames: reference positions, displacement, velocity, stress, strain, reactions, and what contact has at the slave nodes.
//!
//! Points are all vectors of the model but directions, in their order. Cells are the elements of the solids, then the facets of rigid bodies, then the
//! lines of beams and strings, then single points; the cell field `body` counts the solids and goes on with surfaces, lines and points in this order.

use super::means::Means;
use super::{Drawing, OutputError};
use crate::points::Points;
use crate::scene::Field as SceneField;
use std::path::Path;
use stoss_fe_solid::{NodalSums, SolidBody, SolidError};
use stoss_mesh::Elements;
use stoss_mesh_io::{Field, PvdWriter, VtuFrame, write_vtu};
use stoss_reference_element::FaceNodes;
use stoss_solver::{Model, Simulation, StepError};

/// Which fields a frame has; those of every day if the scene names none.
pub(crate) fn wanted(fields: Option<&[SceneField]>, field: SceneField) -> bool {
    fields.map_or(field.is_default(), |list| list.contains(&field))
}

const CONTACT_FIELDS: [SceneField; 6] = [
    SceneField::ContactPressure,
    SceneField::ContactMultiplier,
    SceneField::Gap,
    SceneField::ContactStatus,
    SceneField::FrictionTraction,
    SceneField::Slip,
];

/// What contact has at the nodes, zero away from slave nodes and from what general contact acts on; empty in scenes without contact, the last two without friction, the last one without friction of pairs.
#[derive(Default)]
struct ContactFields {
    pressure: Vec<f64>,
    /// The pressures of the equations, of which `pressure` may be a mean.
    multiplier: Vec<f64>,
    /// Gap at the nodes, not a number at nodes without a partner.
    gap: Vec<f64>,
    status: Vec<f64>,
    friction: Vec<f64>,
    slip: Vec<f64>,
}

impl ContactFields {
    fn of(simulation: &Simulation, means: &Means) -> Result<Self, OutputError> {
        let model = simulation.model();
        let nodes = model.node_count();
        if !model.has_contact_pairs() {
            return Ok(Self::default());
        }
        let zeros = || vec![0.0; nodes];
        let mut fields = Self {
            pressure: zeros(),
            multiplier: zeros(),
            gap: vec![f64::NAN; nodes],
            status: zeros(),
            friction: zeros(),
            slip: zeros(),
        };
        let (mut has_friction, mut has_slip) = (false, false);
        for (c, pair) in model.contacts.iter().enumerate() {
            has_friction |= pair.term.has_friction();
            if pair.unilateral().is_none() {
                continue;
            }
            has_slip |= pair.term.has_friction();
            let (reports, pressures) = (simulation.contact_report(c)?, &simulation.mean_pressures()[c]);
            let size = |v: [f64; 2]| v[0].hypot(v[1]);
            let active = &simulation.active()[c];
            let traction = |slot: usize| {
                let of_active = reports[slot].friction.filter(|_| active[slot]);
                of_active.map_or(0.0, |friction| size(friction.traction))
            };
            for (slot, report) in reports.iter().enumerate() {
                let node = report.node as usize;
                fields.pressure[node] += report.shown(slot, |slot| pressures[slot]);
                fields.multiplier[node] += pressures[slot] * report.per_current_area;
                fields.friction[node] += report.shown(slot, traction);
                if let Some(g) = report.gap {
                    // The first comparison is with no number.
                    fields.gap[node] = fields.gap[node].min(g);
                }
                if !active[slot] {
                    continue;
                }
                let sticks = report.friction.is_some_and(|friction| friction.sticks);
                fields.status[node] = fields.status[node].max(if sticks { 1.0 } else { 2.0 });
                if let Some(friction) = report.friction {
                    fields.slip[node] = fields.slip[node].max(size(friction.slip));
                }
            }
        }
        for (node, pressure, friction, distance) in means.nodes() {
            let node = node as usize;
            fields.pressure[node] += pressure;
            fields.multiplier[node] += pressure;
            fields.friction[node] += friction;
            fields.gap[node] = distance.map_or(fields.gap[node], |distance| fields.gap[node].min(distance));
            if pressure != 0.0 {
                fields.status[node] = 2.0;
            }
        }
        // A node has what it has in contacts that look at faces, and what its vertex has in those that look at the trace.
        for (&vertex, shown) in &model.traces {
            let (vertex, Some(node)) = (vertex as usize, shown.map(|node| node as usize)) else { continue };
            fields.pressure[node] += fields.pressure[vertex];
            fields.multiplier[node] += fields.multiplier[vertex];
            fields.friction[node] += fields.friction[vertex];
            fields.gap[node] = fields.gap[node].min(fields.gap[vertex]);
            fields.status[node] = fields.status[node].max(fields.status[vertex]);
            fields.slip[node] = fields.slip[node].max(fields.slip[vertex]);
        }
        if !has_friction {
            fields.friction.clear();
        }
        if !has_slip {
            fields.slip.clear();
        }
        Ok(fields)
    }
}

/// The number of the body of each cell: solids, surfaces, lines, points.
fn bodies(model: &Model, drawing: &Drawing) -> Vec<f64> {
    let solids = model.bodies.iter().map(|body| body.solid.element_count());
    let surfaces = drawing.surfaces.iter().map(|surface| surface.facets.len());
    let single = std::iter::repeat_n(1, drawing.lines.len() + drawing.points.len());
    let counts = solids.chain(surfaces).chain(single);
    counts.enumerate().flat_map(|(k, count)| std::iter::repeat_n(k as f64, count)).collect()
}

/// What `nodal` finds at the nodes of solids; not a number elsewhere, which ParaView shows in a colour of its own and leaves out of
/// the range. Empty without solids.
fn of_solids<const N: usize>(
    simulation: &Simulation,
    nodal: impl Fn(&SolidBody, &[f64]) -> Result<NodalSums<N>, SolidError>,
) -> Result<Vec<[f64; N]>, OutputError> {
    at_bodies(simulation, |body| simulation.at_nodes(body, &nodal))
}

fn at_bodies<const N: usize>(
    simulation: &Simulation,
    of: impl Fn(usize) -> Result<Vec<[f64; N]>, StepError>,
) -> Result<Vec<[f64; N]>, OutputError> {
    let model = simulation.model();
    if model.bodies.is_empty() {
        return Ok(Vec::new());
    }
    let mut values = vec![[f64::NAN; N]; model.node_count()];
    for (number, body) in model.bodies.iter().enumerate() {
        let nodes = body.nodes.start as usize..body.nodes.end as usize;
        values[nodes].copy_from_slice(&of(number)?);
    }
    Ok(values)
}

/// Whether a body has the output of states that a field shows.
fn has_output(simulation: &Simulation, field: SceneField) -> bool {
    simulation.model().bodies.iter().any(|body| body.solid.state_output(field.name()).is_some())
}

/// An output of states at the nodes; zero of bodies without.
fn of_states<const N: usize>(simulation: &Simulation, field: SceneField) -> Result<Vec<[f64; N]>, OutputError> {
    at_bodies(simulation, |body| {
        let solid = &simulation.model().bodies[body].solid;
        match solid.state_output(field.name()) {
            Some(place) => simulation.at_nodes(body, |solid, q| solid.nodal_state_output(q, place)),
            None => Ok(vec![[0.0; N]; solid.node_count()]),
        }
    })
}

/// What is computed for a frame: nothing that it does not have.
#[derive(Default)]
struct SolidFields {
    stress: Vec<[f64; 6]>,
    von_mises: Vec<f64>,
    equivalent_plastic_strain: Vec<[f64; 1]>,
    plastic_strain: Vec<[f64; 6]>,
    back_stress: Vec<[f64; 6]>,
    yielding: Vec<[f64; 1]>,
    viscous_strain: Vec<[f64; 6]>,
    principal: Vec<[f64; 3]>,
    deformation_gradient: Vec<[f64; 9]>,
    green_lagrange: Vec<[f64; 6]>,
    logarithmic: Vec<[f64; 6]>,
}

impl SolidFields {
    fn of(simulation: &Simulation, want: impl Fn(SceneField) -> bool) -> Result<Self, OutputError> {
        let mut fields = Self::default();
        let [von_mises, principal] = [SceneField::VonMises, SceneField::PrincipalStresses].map(&want);
        if want(SceneField::CauchyStress) || von_mises || principal {
            fields.stress = of_solids(simulation, SolidBody::nodal_cauchy_stress)?;
        }
        if von_mises {
            fields.von_mises = fields.stress.iter().map(stoss_fe_solid::von_mises).collect();
        }
        let of = |field: SceneField| want(field) && has_output(simulation, field);
        if of(SceneField::EquivalentPlasticStrain) {
            fields.equivalent_plastic_strain = of_states(simulation, SceneField::EquivalentPlasticStrain)?;
        }
        if of(SceneField::PlasticStrain) {
            fields.plastic_strain = of_states(simulation, SceneField::PlasticStrain)?;
        }
        if of(SceneField::BackStress) {
            fields.back_stress = of_states(simulation, SceneField::BackStress)?;
        }
        if of(SceneField::Yielding) {
            fields.yielding = of_states(simulation, SceneField::Yielding)?;
        }
        if of(SceneField::ViscousStrain) {
            fields.viscous_strain = of_states(simulation, SceneField::ViscousStrain)?;
        }
        if principal {
            fields.principal = fields.stress.iter().map(stoss_fe_solid::principal_stresses).collect();
        }
        if want(SceneField::DeformationGradient) {
            fields.deformation_gradient = of_solids(simulation, SolidBody::nodal_deformation_gradient)?;
        }
        if want(SceneField::GreenLagrangeStrain) {
            fields.green_lagrange = of_solids(simulation, SolidBody::nodal_green_lagrange_strain)?;
        }
        if want(SceneField::LogarithmicStrain) {
            fields.logarithmic = of_solids(simulation, SolidBody::nodal_logarithmic_strain)?;
        }
        Ok(fields)
    }
}

/// Writes one frame as a VTU file (atomically), into a folder that is made if it does not exist.
pub(super) fn store(path: &Path, frame: &VtuFrame) -> Result<(), OutputError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(OutputError::io(folder))?;
    Ok(write_vtu(path, frame)?)
}

/// Makes a frame and hands it to `store`.
pub(super) fn with(
    simulation: &Simulation,
    means: &Means,
    fields: Option<&[SceneField]>,
    drawing: &Drawing,
    store: impl FnOnce(&VtuFrame) -> Result<(), OutputError>,
) -> Result<(), OutputError> {
    let model = simulation.model();
    let state = simulation.state();
    let points = Points::of(model);
    let drawing = drawing.of_points(&points);
    let reference = points.of_all(&model.reference, 3);
    let mut elements = Elements::new();
    for body in &model.bodies {
        elements.extend(body.solid.elements(), |node| points.place(node));
    }
    let facets: Vec<FaceNodes> =
        drawing.surfaces.iter().flat_map(|surface| &surface.facets).map(|&facet| facet.into()).collect();
    let lines: Vec<Vec<u32>> = drawing.lines.iter().map(|line| line.nodes.clone()).collect();
    let vertices: Vec<u32> = drawing.points.iter().map(|point| point.node).collect();
    let bodies = bodies(model, &drawing);
    let displacement: Vec<f64> = state.q.iter().zip(&model.reference).map(|(q, x)| q - x).collect();
    let want = |field| wanted(fields, field);
    let solid = SolidFields::of(simulation, want)?;
    let contact = if CONTACT_FIELDS.into_iter().any(want) {
        ContactFields::of(simulation, means)?
    } else {
        ContactFields::default()
    };
    let mut reactions = simulation.reactions();
    if let Some(extent) = drawing.extent {
        reactions.to_mut().iter_mut().for_each(|force| *force /= extent);
    }
    let candidates: [(SceneField, &str, usize, &[f64]); 20] = [
        (SceneField::Displacement, "displacement", 3, &displacement),
        (SceneField::Velocity, "velocity", 3, &state.v),
        (SceneField::CauchyStress, "cauchy_stress", 6, solid.stress.as_flattened()),
        (SceneField::VonMises, "von_mises", 1, &solid.von_mises),
        (
            SceneField::EquivalentPlasticStrain,
            "equivalent_plastic_strain",
            1,
            solid.equivalent_plastic_strain.as_flattened(),
        ),
        (SceneField::PlasticStrain, "plastic_strain", 6, solid.plastic_strain.as_flattened()),
        (SceneField::BackStress, "back_stress", 6, solid.back_stress.as_flattened()),
        (SceneField::Yielding, "yielding", 1, solid.yielding.as_flattened()),
        (SceneField::ViscousStrain, "viscous_strain", 6, solid.viscous_strain.as_flattened()),
        (SceneField::PrincipalStresses, "principal_stresses", 3, solid.principal.as_flattened()),
        (SceneField::DeformationGradient, "deformation_gradient", 9, solid.deformation_gradient.as_flattened()),
        (SceneField::GreenLagrangeStrain, "green_lagrange_strain", 6, solid.green_lagrange.as_flattened()),
        (SceneField::LogarithmicStrain, "logarithmic_strain", 6, solid.logarithmic.as_flattened()),
        (SceneField::Reaction, "reaction", 3, &reactions),
        (SceneField::ContactPressure, "contact_pressure", 1, &contact.pressure),
        (SceneField::ContactMultiplier, "contact_multiplier", 1, &contact.multiplier),
        (SceneField::Gap, "gap", 1, &contact.gap),
        (SceneField::ContactStatus, "contact_status", 1, &contact.status),
        (SceneField::FrictionTraction, "friction_traction", 1, &contact.friction),
        (SceneField::Slip, "slip", 1, &contact.slip),
    ];
    let wanted = candidates.into_iter().filter(|(field, _, _, values)| want(*field) && !values.is_empty());
    let values: Vec<_> = wanted.map(|(_, name, n, values)| (name, n, points.of_all(values, n))).collect();
    let point_data = values.iter().map(|(name, n, values)| Field { name, components: *n, values }).collect();
    let frame = VtuFrame {
        // cannot fail: positions have three components.
        points: reference.as_chunks().0,
        elements: elements.blocks(),
        facets: &facets,
        lines: &lines,
        vertices: &vertices,
        point_data,
        cell_data: vec![Field { name: "body", components: 1, values: &bodies }],
        field_data: Vec::new(),
        time: Some(state.time),
    };
    store(&frame)
}

/// File name of the frame of a step.
pub(super) fn name(step: u64) -> String {
    format!("frame_{step:06}.vtu")
}

/// The step of a frame of this name; nothing for names that this program does not give, so that no file of the user's is ever touched.
pub(super) fn step_of(name: &str) -> Option<u64> {
    let step = name.strip_prefix("frame_")?.strip_suffix(".vtu")?;
    (step.len() >= 6 && step.bytes().all(|byte| byte.is_ascii_digit())).then(|| step.parse().ok())?
}

/// Writes the collection of all frames (atomically).
pub(crate) fn write_collection(path: &Path, entries: &[(f64, String)]) -> Result<(), OutputError> {
    Ok(PvdWriter::replace(path, entries)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_own_frames_are_recognised() {
        for step in [0, 123, 12_345_678] {
            assert_eq!(step_of(&name(step)), Some(step));
        }
        for other in ["frame_mine.vtu", "frame_.vtu", "frame_12.vtu", "frame_000001.vtu.bak", "Frame_000001.vtu"] {
            assert_eq!(step_of(other), None, "{other}");
        }
    }
}
