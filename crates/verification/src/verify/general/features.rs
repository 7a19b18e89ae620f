//! Six impacts in which one kind of feature meets another: an edge an edge, a corner a face, a face a face; three bodies; a body itself; with friction.
//!
//! Speed of waves about 1, closing speed 0.2. The promise: energy and momenta to round-off across every change of features.

use super::judge::judge_closely;
use super::mesh::band;
use super::scene::{Body, Scene};
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;
use std::f64::consts::SQRT_2;

/// Change of the energy over the largest kinetic energy: a hundredth of the bound of all other scenes.
const CLOSE: f64 = 1e-11;

const THICKNESS: &str = "thickness = 0.02";

/// Measures all pairs of features.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let steps: &[f64] = if bench.quick { &[0.1] } else { &[0.1, 0.05, 0.025] };
    for &step in steps {
        for (name, scene) in [
            ("edge on edge", edge_on_edge(step, THICKNESS)),
            ("corner on face", corner_on_face(step)),
            ("face on face, offset", face_on_face(step)),
            ("three spinning cubes", three(step)),
            ("open ring", open_ring(step)),
            ("spinning cube on slab, friction 0.3", on_slab(step)),
        ] {
            judge_closely(bench, findings, &format!("{name}, step {step}"), &scene, CLOSE)?;
        }
    }
    Ok(())
}

/// Two cubes whose edges cross at right angles.
pub fn edge_on_edge(step: f64, contact: &str) -> Scene {
    apart_edges(step, contact, 0.03)
}

/// Two cubes whose edges cross at right angles, `gap` apart.
pub fn apart_edges(step: f64, contact: &str, gap: f64) -> Scene {
    let upper = Body::cube("upper").turned([0.0, 1.0, 0.0], 45.0).at([0.013, 0.02, SQRT_2 + gap]);
    let lower = Body::cube("lower").turned([1.0, 0.0, 0.0], 45.0).velocity([0.0, 0.0, 0.1]);
    Scene::dynamic(step, 4.0)
        .watched(1)
        .body(upper.velocity([0.0, 0.0, -0.1]).spin([0.0, 0.0, 0.02]))
        .body(lower)
        .general(contact)
}

/// A cube that stands on its corner above the face of another one.
fn corner_on_face(step: f64) -> Scene {
    let diagonal = 3.0_f64.sqrt();
    let upper = Body::cube("upper").turned([1.0, -1.0, 0.0], SQRT_2.atan().to_degrees());
    let upper = upper.at([0.11, 0.07, 0.5 + 0.5 * diagonal + 0.03]).velocity([0.0, 0.0, -0.1]);
    let lower = Body::cube("lower").velocity([0.0, 0.0, 0.1]);
    Scene::dynamic(step, 5.0).watched(1).body(upper).body(lower).general(THICKNESS)
}

fn face_on_face(step: f64) -> Scene {
    let upper = Body::cube("upper").at([0.31, 0.22, 1.03]).velocity([0.0, 0.0, -0.1]);
    let lower = Body::cube("lower").velocity([0.0, 0.0, 0.1]);
    Scene::dynamic(step, 4.0).watched(1).body(upper).body(lower).general(THICKNESS)
}

fn three(step: f64) -> Scene {
    let a = Body::cube("a").turned([1.0, 2.0, 0.0], 0.4_f64.to_degrees());
    let b = Body::cube("b").turned([0.0, 1.0, 1.0], 0.7_f64.to_degrees()).at([1.52, 0.1, 0.1]);
    let c = Body::cube("c").turned([1.0, 0.0, 1.0], 1.1_f64.to_degrees()).at([0.72, 0.05, 1.5]);
    Scene::dynamic(step, 5.0)
        .watched(1)
        .body(a.velocity([0.1, 0.0, 0.05]).spin([0.0, 0.1, 0.0]))
        .body(b.velocity([-0.1, 0.0, 0.05]).spin([0.0, 0.0, 0.1]))
        .body(c.velocity([0.0, 0.0, -0.15]).spin([0.1, 0.0, 0.0]))
        .general(THICKNESS)
}

/// A ring with a gap of 20 degrees, whose ends are thrown together and sideways.
fn open_ring(step: f64) -> Scene {
    let ring = Body::hexahedra("ring", "open-ring", &band(16, 0.3, 0.4, 20.0));
    let gradient = [[0.0, 0.0, 0.0], [0.0, -0.3, 0.0], [0.0, 0.06, 0.0]];
    let ring = ring.gradient(gradient).spin([0.0, 0.0, 0.05]);
    Scene::dynamic(step, 6.0).watched(1).body(ring).general(THICKNESS)
}

fn on_slab(step: f64) -> Scene {
    let cube = Body::cube("cube").turned([1.0, 1.0, 0.0], 0.15_f64.to_degrees()).at([-0.2, 0.03, 0.91]);
    Scene::dynamic(step, 5.0)
        .watched(1)
        .body(cube.velocity([0.1, 0.0, -0.1]).spin([0.0, 0.2, 0.1]))
        .body(Body::block("slab", [2.0, 2.0, 0.5], [3, 3, 1]))
        .general("thickness = 0.02\nfriction = 0.3\nslip_velocity = 1e-3")
}
