//! Beams, strings and springs in motion: what the energy-momentum scheme keeps.

use crate::lines;

use std::f64::consts::PI;
use stoss_multibody::{
    Beam, BeamAxis, ElasticString, Embedded, PointMass, Section, SectionMaterial, Spring, SpringData, StringMaterial,
};
use stoss_reference_cases::multibody::elliptic::quarter_period;
use stoss_solver::{Model, Simulation};

/// Runs to the end; asserts that linear and angular momentum and energy stay, and returns the largest number of iterations of a step.
fn assert_free_flight(name: &str, mut run: Simulation, sizes: [f64; 3]) -> u32 {
    let first = *run.balance();
    let (mut most, mut strain) = (0, 0.0_f64);
    let mut drift = [0.0_f64; 3];
    while !run.finished() {
        let record = run.advance().unwrap();
        most = most.max(record.iterations);
        let now = *run.balance();
        strain = strain.max(now.strain);
        for i in 0..3 {
            drift[0] = drift[0].max((now.linear_momentum[i] - first.linear_momentum[i]).abs() / sizes[0]);
            drift[1] = drift[1].max((now.angular_momentum[i] - first.angular_momentum[i]).abs() / sizes[1]);
        }
        drift[2] = drift[2].max((now.total() - first.total()).abs() / sizes[2]);
    }
    println!(
        "{name}: {} steps, drift of momenta and energy {}, strain energy up to {strain:.2}, {most} iterations at most",
        run.step(),
        lines::brief(&drift)
    );
    assert!(drift.iter().all(|d| *d < 1e-10), "{drift:?}");
    // It bends and stretches, else there would be nothing to see.
    assert!(strain > 0.02 * sizes[2], "{strain}");
    most
}

/// A beam with a corner and one that is curved, thrown with a spin and a bending motion.
#[test]
fn free_flight_of_beams() {
    let material = SectionMaterial { young: 2e4, poisson: 0.3, density: 3.0 };
    let section = Section::rectangle([0.1, 0.2], material, 5.0 / 6.0, None).unwrap();
    let corner = [[0.0; 3], [1.0, 0.2, 0.0], [1.1, 1.3, 0.4]];
    for order in 1..=3 {
        let axes = [
            BeamAxis::polyline(&corner, [0.0, 0.0, 1.0], &[3, 3], order).unwrap(),
            BeamAxis::arc([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.3, 1.0], 2.0, 5, order).unwrap(),
        ];
        for axis in axes {
            let beam = Beam::new("beam", 0, axis, section).unwrap();
            let mut velocity = beam.rigid_velocity([0.3, -0.2, 1.0], [2.0, 4.0, -3.0], [0.5, 0.5, 0.0]);
            let n = beam.node_count();
            for (i, x) in beam.axis().positions().iter().enumerate() {
                let v = &mut velocity[4 * i];
                let t = i as f64 / (n - 1) as f64;
                v[2] += 3.0 * (PI * t).sin() * (1.0 + x[0] * x[0]);
                v[0] += (2.0 * PI * t).sin();
            }
            let mut model = Model::default();
            lines::beam(&mut model, beam, &[]);
            model.velocity = velocity.iter().flatten().copied().collect();
            let run = lines::simulation(model, true, 0.005, 1.0);
            let kinetic = run.balance().kinetic;
            let most = assert_free_flight(&format!("beam of order {order}"), run, [1.0, 1.0, kinetic]);
            assert!(most <= 9, "{most}");
        }
    }
}

/// A string that is thrown; it is slack here and there, so that the tension-only law passes its kink.
#[test]
fn free_flight_of_strings() {
    for order in 1..=3 {
        for tension_only in [false, true] {
            let nodes = ElasticString::straight_nodes([0.0; 3], [2.0, 0.0, 0.5], 6, order).unwrap();
            let material = StringMaterial { stiffness: 40.0, mass: 0.5, lumped: false, tension_only };
            let string = ElasticString::new("string", 0, order, nodes, material, 1.02).unwrap();
            let mut velocity = string.rigid_velocity([0.1, 0.2, 0.3], [1.0, 3.0, 2.0], [1.0, 0.0, 0.0]);
            let n = velocity.len();
            for (i, v) in velocity.iter_mut().enumerate() {
                let t = 2.0 * PI * i as f64 / (n - 1) as f64;
                v[1] += t.cos();
                v[0] += 2.0 * t.sin();
            }
            let mut model = Model::default();
            lines::vectors(&mut model, string.reference());
            model.velocity = velocity.iter().flatten().copied().collect();
            model.parts.push(Box::new(string.clone()));
            let mut slack = lines::simulation(clone_of(&model, &string), true, 0.004, 0.4);
            let run = lines::simulation(model, true, 0.004, 0.8);
            let energy = run.balance().total();
            let mut least = f64::INFINITY;
            while !slack.finished() {
                slack.advance().unwrap();
                least = string.tensions(&slack.state().q).into_iter().fold(least, f64::min);
            }
            // Points are shortened, where the law of tension only has no force.
            assert!(if tension_only { least == 0.0 } else { least < -1.0 }, "{least}");
            assert_free_flight(
                &format!("string of order {order}, tension only {tension_only}"),
                run,
                [1.0, 1.0, energy],
            );
        }
    }
}

/// A copy of the model.
fn clone_of(model: &Model, string: &ElasticString) -> Model {
    Model {
        reference: model.reference.clone(),
        velocity: model.velocity.clone(),
        parts: vec![Box::new(string.clone())],
        ..Model::default()
    }
}

/// A mass at the end of a light, stiff string: a pendulum with the period `4 K(sin^2(a/2)) sqrt(L / g)` for the amplitude `a`. The energy with that of the
/// weight stays, and so does the angular momentum about the vertical.
#[test]
fn string_pendulum() {
    let (length, gravity, amplitude) = (1.5, 9.81, 1.0_f64);
    let (s, c) = amplitude.sin_cos();
    let nodes = ElasticString::straight_nodes([0.0; 3], [length * s, 0.0, -length * c], 3, 2).unwrap();
    let material = StringMaterial { stiffness: 1e5, mass: 1e-4, lumped: false, tension_only: false };
    // Stretched as the weight does.
    let e = gravity * c / material.stiffness;
    let string = ElasticString::new("string", 0, 2, nodes, material, e + (1.0 + e * e).sqrt()).unwrap();
    let last = string.node_count() - 1;
    let bob = PointMass::new("bob", last as u32 + 1, 1.0, length).unwrap();
    let mut model = Model::default();
    lines::vectors(&mut model, string.reference());
    lines::vectors(&mut model, &[string.reference()[last]]);
    lines::fix(&mut model, &[0]);
    lines::constrain(&mut model, "hook", lines::joined("hook", &string.point(last), &bob.position()));
    model.parts.push(Box::new(string));
    model.parts.push(Box::new(bob));
    lines::gravity(&mut model, [0.0, 0.0, -gravity]);
    let period = 4.0 * quarter_period((0.5 * amplitude).sin().powi(2)) * (length / gravity).sqrt();
    let mut run = lines::simulation(model, true, period / 400.0, 1.3 * period);
    let first = run.balance().total();
    let (mut crossings, mut before) = (Vec::new(), (0.0, length * s));
    let mut most = 0;
    while !run.finished() {
        most = most.max(run.advance().unwrap().iterations);
        assert!((run.balance().total() - first).abs() < 1e-11 * gravity * length);
        assert!(run.balance().angular_momentum[2].abs() < 1e-12);
        let now = (run.state().time, run.state().q[3 * (last + 1)]);
        if before.1 * now.1 < 0.0 {
            crossings.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
        }
        before = now;
    }
    let measured = 2.0 * (crossings[1] - crossings[0]);
    println!("pendulum: period {measured:.6} of {period:.6}, {most} iterations at most");
    assert!((measured / period - 1.0).abs() < 1e-3, "{measured} {period}");
}

/// Two masses, a spring and a damper: energy and what the damper takes are constant, momenta exact.
#[test]
fn damped_oscillator() {
    let data = SpringData { stiffness: 30.0, rest_length: 1.0, tension_only: false, damping: 0.8 };
    let spring = Spring::new("spring", [Embedded::vector(0), Embedded::vector(1)], data).unwrap();
    let mut model = Model::default();
    lines::vectors(&mut model, &[[0.0; 3], [1.3, 0.0, 0.0]]);
    model.velocity = vec![0.1, -1.0, 0.0, 0.0, 1.0, 0.5];
    for (vector, mass) in [(0, 1.0), (1, 2.0)] {
        model.parts.push(Box::new(PointMass::new("mass", vector, mass, 1.0).unwrap()));
    }
    model.parts.push(Box::new(spring));
    let mut run = lines::simulation(model, true, 0.02, 4.0);
    let first = *run.balance();
    while !run.finished() {
        run.advance().unwrap();
    }
    let last = *run.balance();
    for i in 0..3 {
        assert!((last.linear_momentum[i] - first.linear_momentum[i]).abs() < 1e-12);
        assert!((last.angular_momentum[i] - first.angular_momentum[i]).abs() < 1e-12);
    }
    // The total counts what was dissipated.
    assert!((last.total() - first.total()).abs() < 1e-12 && last.dissipation > 0.3, "{last:?}");
}

/// First bending vibration of a slender cantilever, about each axis of its section: started with the velocity of its mode, the tip is back after half of the period
/// `2 pi L^2 sqrt(rho A / EI) / 1.8751^2` (Euler and Bernoulli).
#[test]
fn first_vibration_of_a_cantilever() {
    let material = SectionMaterial { young: 1e6, poisson: 0.3, density: 2.0 };
    let section = Section::rectangle([0.02, 0.01], material, 5.0 / 6.0, None).unwrap();
    let (length, lambda) = (2.0, 1.875_104_068_711_961);
    for (k, sideways) in [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().enumerate() {
        let axis = BeamAxis::straight([0.0; 3], [length, 0.0, 0.0], [0.0, 1.0, 0.0], 8, 2).unwrap();
        let beam = Beam::new("beam", 0, axis, section).unwrap();
        let b = lambda / length;
        let sigma = (lambda.cosh() + lambda.cos()) / (lambda.sinh() + lambda.sin());
        let mode = |x: f64| (b * x).cosh() - (b * x).cos() - sigma * ((b * x).sinh() - (b * x).sin());
        let slope = |x: f64| b * ((b * x).sinh() + (b * x).sin() - sigma * ((b * x).cosh() - (b * x).cos()));
        let mut velocity = Vec::new();
        for x in beam.axis().positions() {
            // Sections turn about x cross sideways.
            let turn = 1e-4 * slope(x[0]);
            let l = beam.director_length();
            let mut of_node = [[0.0; 3]; 4];
            of_node[0] = sideways.map(|s| 1e-4 * mode(x[0]) * s);
            of_node[1 + k] = [-l * turn, 0.0, 0.0];
            of_node[3] = sideways.map(|s| l * turn * s);
            velocity.extend(of_node.iter().flatten());
        }
        let tip = beam.node_vectors(beam.node_count() - 1)[0];
        let mut model = Model::default();
        lines::beam(&mut model, beam, &[0]);
        model.velocity = velocity;
        let omega = lambda * lambda / (length * length) * (section.bending[1 - k] / section.mass).sqrt();
        let half = PI / omega;
        let mut run = lines::simulation(model, true, half / 100.0, 1.1 * half);
        let mut before = (0.0, 0.0);
        let mut crossing = None;
        while !run.finished() {
            run.advance().unwrap();
            let now = (run.state().time, lines::place(&run.state().q, tip)[1 + k]);
            if before.1 > 0.0 && now.1 <= 0.0 {
                crossing = Some(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
            }
            before = now;
        }
        let error = crossing.unwrap() / half - 1.0;
        println!("vibration along d_{}: error of the period {error:.1e}", k + 1);
        assert!(error.abs() < 1e-3, "{error}");
    }
}
