//! The barrier between a vertex and a triangle: energy and force over the distance, and the force of a step between two distances.
//!
//! Checked: the force is the slope of the energy (differences); the force of a step does exactly the work of the energy, however large the
//! step is, and has no resultant; there is none beyond the layer.
//!
//! `cargo run --example vertex_triangle -p stoss-contact-barrier`

use nalgebra::Vector3;
use stoss_contact_barrier::{Layer, PairStart, PairTerm};
use stoss_geometry::PairKind;

const THICKNESS: f64 = 0.1;

/// The vertex, then the triangle.
fn points(height: f64) -> [Vector3<f64>; 4] {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from);
    [Vector3::new(0.2, 0.3, height), corners[0], corners[1], corners[2]]
}

fn main() {
    let layer = Layer::new(1000.0, THICKNESS);
    // The weight is the area of the surface that the vertex stands for.
    let term = PairTerm { kind: PairKind::VertexTriangle, weight: 0.01, mollifier: None };
    println!("distance   energy      force on the vertex   force of the step from the layer's rim");
    for distance in [0.12, 0.099, 0.07, 0.04, 0.01, 0.001] {
        let at = |height: f64| term.at_state(&layer, &points(height), None);
        let (now, h) = (at(distance), 1e-6 * distance);
        let force = -now.gradient[0].z;
        let slope = (at(distance + h).energy - at(distance - h).energy) / (2.0 * h);
        assert!((force + slope).abs() <= 1e-6 * force, "{force} {slope}");

        let start = PairStart::new(term, layer, &points(THICKNESS));
        let step = start.force(&points(distance), None);
        let of_step = -step.gradient[0].z;
        println!("{distance:8} {:11.4e} {force:21.4e} {of_step:24.4e}", now.energy);
        let work = of_step * (distance - THICKNESS);
        assert!((work + step.energy - start.energy()).abs() <= 1e-12 * step.energy);
        assert!(step.gradient.iter().sum::<Vector3<f64>>().norm() <= 1e-14 * of_step);
        assert_eq!(force > 0.0, distance < THICKNESS);
    }
}

#[test]
fn the_checks_hold() {
    main();
}
