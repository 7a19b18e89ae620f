//! The 45-degree bend: a curved cantilever in space, against the literature and against the equations of the rod.

use crate::lines;

use std::f64::consts::PI;
use stoss_multibody::{Beam, BeamAxis, Section};
use stoss_reference_cases::multibody::bend::CurvedCantilever;
use stoss_solver::Model;

const RADIUS: f64 = 100.0;

/// The 45-degree bend of Bathe and Bolourchi (Int. J. Numer. Meth. Engng 14 (1979) 961): a cantilever of radius 100 with a unit square as section, `E = 1e7`, no
/// lateral contraction, and a force of 600 out of its plane. The tip comes to (15.9, 47.2, 53.4) there, to (15.79, 47.23, 53.37) in Simo and Vu-Quoc
/// (Comput. Meth. Appl. Mech. Engng 58 (1986) 79), under 300 to (22.5, 59.2, 39.5) and (22.33, 58.84, 40.08); both have eight straight elements.
#[test]
fn bend_of_bathe_and_bolourchi() {
    let section = Section {
        axial: 1e7,
        shear: [1e7 / 2.0 * 5.0 / 6.0; 2],
        bending: [1e7 / 12.0; 2],
        torsion: 1e7 / 12.0,
        mass: 0.0,
        rotary: [0.0; 2],
    };
    // From (0, 0, 0) along y, curving towards x.
    let (centre, normal, angle) = ([RADIUS, 0.0, 0.0], [0.0, 0.0, -1.0], PI / 4.0);
    let arc = |elements, order| BeamAxis::arc(centre, [0.0; 3], normal, angle, elements, order).unwrap();
    let chords = || {
        let points: Vec<[f64; 3]> = arc(8, 1).positions().to_vec();
        BeamAxis::polyline(&points, [0.0, 0.0, 1.0], &[1; 8], 2).unwrap()
    };
    let tip_of = |axis: BeamAxis, name: &str| {
        let beam = Beam::new("bend", 0, axis, section).unwrap();
        let tip = beam.node_vectors(beam.node_count() - 1)[0];
        let mut model = Model::default();
        lines::beam(&mut model, beam, &[0]);
        lines::ramp(&mut model, tip, [0.0, 0.0, 600.0]);
        let mut run = lines::simulation(model, false, 0.125, 1.0);
        let mut half = [0.0; 3];
        while !run.finished() {
            let record = run.advance().unwrap();
            if record.step == 4 {
                half = lines::place(&run.state().q, tip);
            }
            if run.finished() {
                lines::assert_quadratic(&lines::newton(name, &record), 100.0);
            }
        }
        let end = lines::place(&run.state().q, tip);
        println!("{name}: half load {half:.3?}, full load {end:.5?}");
        (half, end)
    };
    let away = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    // The literature, and its eight straight elements.
    for (axis, name) in [(chords(), "8 straight elements of order 2"), (arc(8, 2), "8 elements of order 2")] {
        let (half, end) = tip_of(axis, name);
        assert!(away(end, [15.9, 47.2, 53.4]) < 0.5 && away(end, [15.79, 47.23, 53.37]) < 0.4, "{end:?}");
        assert!(away(half, [22.33, 58.84, 40.08]) < 0.5, "{half:?}");
    }
    let rod = CurvedCantilever { stiffness: section.stiffness(), radius: RADIUS, angle: PI / 4.0 };
    let exact = rod.tip(600.0).unwrap();
    println!("shooting: {exact:.5?}");
    let mut errors = Vec::new();
    for (elements, order) in [(4, 2), (8, 2), (16, 2), (4, 3), (8, 3), (16, 1), (32, 1)] {
        let (_, end) = tip_of(arc(elements, order), &format!("{elements} elements of order {order}"));
        errors.push(away(end, exact));
    }
    println!("errors {}", lines::brief(&errors));
    // Order 4 of elements of order 2 and 3, which have as many Gauss points, order 2 of those of order 1.
    for (coarse, fine, ratio) in [(0, 1, 0.0717), (1, 2, 0.1), (3, 4, 0.1), (5, 6, 0.3)] {
        assert!(errors[fine] < ratio * errors[coarse], "{errors:?}");
    }
    assert!(errors[2] < 1e-3 && errors[4] < 2e-3, "{errors:?}");
}
