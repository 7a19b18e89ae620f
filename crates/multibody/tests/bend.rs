//! The 45-degree bend: a curved cantilever in space, against the literature and against the equations of the rod integrated by themselves.

mod lines;

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use stoss_multibody::{Beam, BeamAxis, Section};
use stoss_solver::Model;

const RADIUS: f64 = 100.0;

/// Unknowns of the rod at a point: position, rotation (columns are directors), moment.
type Rod = (Vector3<f64>, Matrix3<f64>, Vector3<f64>);

/// Integrates `phi' = R (Gamma + e_3)`, `R' = R [K + K_0]`, `m' = -phi' x n` from the clamp with the moment `m` there and the constant force `n`, by the classical
/// method of Runge and Kutta.
fn integrate(section: &Section, n: Vector3<f64>, m: Vector3<f64>) -> Rod {
    let steps = 300;
    let h = RADIUS * PI / 4.0 / f64::from(steps);
    let [a, b, c, d, e, f] = section.stiffness();
    let (strain, curvature) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
    let rates = |(_, r, m): &Rod| -> Rod {
        let gamma = (r.transpose() * n).component_div(&strain) + Vector3::z();
        let k = (r.transpose() * m).component_div(&curvature) + Vector3::x() / RADIUS;
        let x = r * gamma;
        (x, r * k.cross_matrix(), -x.cross(&n))
    };
    let plus = |y: &Rod, f: f64, d: &Rod| (y.0 + f * d.0, y.1 + f * d.1, y.2 + f * d.2);
    // Tangent along y, d_1 the normal of the arc, along -z.
    let d1 = -Vector3::z();
    let start = Matrix3::from_columns(&[d1, Vector3::y().cross(&d1), Vector3::y()]);
    let mut y = (Vector3::zeros(), start, m);
    for _ in 0..steps {
        let k1 = rates(&y);
        let k2 = rates(&plus(&y, 0.5 * h, &k1));
        let k3 = rates(&plus(&y, 0.5 * h, &k2));
        let k4 = rates(&plus(&y, h, &k3));
        for (factor, k) in [(1.0, k1), (2.0, k2), (2.0, k3), (1.0, k4)] {
            y = plus(&y, factor * h / 6.0, &k);
        }
    }
    y
}

/// The tip, by shooting for no moment there, in ten steps of the load.
fn shoot(section: &Section, force: f64) -> [f64; 3] {
    let mut m = Vector3::zeros();
    let mut tip = Vector3::zeros();
    for step in 1..=10 {
        let n = Vector3::new(0.0, 0.0, force * f64::from(step) / 10.0);
        for _ in 0..30 {
            let (x, _, end) = integrate(section, n, m);
            tip = x;
            if end.norm() < 1e-10 * force * RADIUS {
                break;
            }
            let column = |k: usize| {
                let mut other = m;
                other[k] += 0.1;
                (integrate(section, n, other).2 - end) / 0.1
            };
            m -= Matrix3::from_columns(&[column(0), column(1), column(2)]).lu().solve(&end).unwrap();
        }
        assert!(integrate(section, n, m).2.norm() < 1e-8 * force * RADIUS);
    }
    [tip.x, tip.y, tip.z]
}

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
    let exact = shoot(&section, 600.0);
    println!("shooting: {exact:.5?}");
    let mut errors = Vec::new();
    for (elements, order) in [(4, 2), (8, 2), (16, 2), (4, 3), (8, 3), (16, 1), (32, 1)] {
        let (_, end) = tip_of(arc(elements, order), &format!("{elements} elements of order {order}"));
        errors.push(away(end, exact));
    }
    println!("errors {}", lines::brief(&errors));
    // Order 4 of elements of order 2 and 3, which have as many Gauss points, order 2 of those of order 1.
    for (coarse, fine, ratio) in [(0, 1, 0.1), (1, 2, 0.1), (3, 4, 0.1), (5, 6, 0.3)] {
        assert!(errors[fine] < ratio * errors[coarse], "{errors:?}");
    }
    assert!(errors[2] < 1e-3 && errors[4] < 2e-3, "{errors:?}");
}
