//! Beams and strings at rest, against closed forms and the literature.

use crate::lines;

use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use stoss_multibody::{Beam, BeamAxis, ElasticString, Section, SectionMaterial, StringMaterial};
use stoss_reference_cases::multibody::lines::{buckling_load, cantilever, catenary as catenary_of, euler_load};
use stoss_solver::Model;
use stoss_term::{At, Fault, ForceRule, GradientRule, Local, StepConfiguration, Term};

fn straight(length: f64, elements: usize, order: usize, section: Section) -> Beam {
    let axis = BeamAxis::straight([0.0; 3], [length, 0.0, 0.0], [0.0, 1.0, 0.0], elements, order).unwrap();
    Beam::new("beam", 0, axis, section).unwrap()
}

/// Timoshenko's cantilever, `w = F L^3 / (3 EI) + F L / (k G A)`, with a small force in each of both directions of the section. With reduced integration an
/// element of order 1 has the error `F L h^2 / (12 EI)` of the piecewise constant curvature, those of higher order have the cubic line exactly.
#[test]
fn deflection_of_a_cantilever() {
    let material = SectionMaterial { young: 1000.0, poisson: 0.3, density: 0.0 };
    let section = Section::rectangle([0.3, 0.5], material, 5.0 / 6.0, None).unwrap();
    let (length, force) = (2.0_f64, 1e-6);
    for direction in [0, 1] {
        // Along d_1 = y the beam bends about d_2.
        let bending = section.bending[1 - direction];
        let exact = cantilever(force, length, bending, section.shear[direction]);
        for order in 1..=3 {
            let mut errors = Vec::new();
            for elements in [2, 4, 8] {
                let beam = straight(length, elements, order, section);
                let tip = beam.node_vectors(beam.node_count() - 1)[0];
                let mut model = Model::default();
                lines::beam(&mut model, beam, &[0]);
                let mut push = [0.0; 3];
                push[1 + direction] = force;
                lines::ramp(&mut model, tip, push);
                let mut run = lines::simulation(model, false, 1.0, 1.0);
                run.advance().unwrap();
                errors.push(lines::place(&run.state().q, tip)[1 + direction] / exact - 1.0);
            }
            println!("order {order}, along d_{}: relative errors {}", direction + 1, lines::brief(&errors));
            if order == 1 {
                let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
                assert!(orders.iter().all(|o| (o - 2.0).abs() < 0.05), "{orders:?}");
            } else {
                assert!(errors.iter().all(|e| e.abs() < 1e-8), "{errors:?}");
            }
        }
    }
}

/// A moment `m` about a fixed axis on the section of a node. Turning the section by `dtheta` does the work `m . dtheta` with `dtheta = 1/2 sum d_k x dd_k`, thus
/// the forces `m x D_k / (2 l^2)` on the directors.
#[derive(Debug)]
struct Couple {
    directors: [u32; 3],
    length: f64,
    axis: [f64; 3],
    magnitude: Arc<AtomicU64>,
}

impl Term for Couple {
    fn name(&self) -> &str {
        "couple"
    }
    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        visit(&self.directors, &[]);
    }
    fn assemble(&self, step: &At<'_>, want: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = step.rule.force() else { return Ok(()) };
        assert_eq!(rule, ForceRule::END_POINT);
        let mut local = Local { nodes: self.directors.to_vec(), ..Local::default() };
        local.reset(want);
        let m = f64::from_bits(self.magnitude.load(Ordering::Relaxed)) / (2.0 * self.length * self.length);
        let [x, y, z] = self.axis.map(|a| -m * a);
        let matrix = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        for (k, &vector) in self.directors.iter().enumerate() {
            let d = lines::place(step.q_np1, vector);
            for i in 0..3 {
                for j in 0..3 {
                    local.residual[3 * k + i] += matrix[i][j] * d[j];
                    if want {
                        local.tangent[(3 * k + i) * 9 + 3 * k + j] = matrix[i][j];
                    }
                }
            }
        }
        visit(&local);
        Ok(())
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
}

/// A moment `2 pi EI / L` rolls a cantilever up to a full circle: its end comes back to its beginning, and the moment is the same everywhere.
#[test]
fn roll_up() {
    let section =
        Section { axial: 1e4, shear: [5e3; 2], bending: [2.0, 2.0], torsion: 1.5, mass: 0.0, rotary: [0.0; 2] };
    let length = 10.0;
    let moment = 2.0 * PI * section.bending[0] / length;
    for (order, counts, bound, least) in [(1, [40, 80], 0.03, 1.9), (2, [10, 20], 1e-3, 3.8), (3, [8, 16], 1e-4, 3.8)] {
        let (mut gaps, mut moments) = (Vec::new(), Vec::new());
        for elements in counts {
            let beam = straight(length, elements, order, section);
            let last = beam.node_count() - 1;
            let [tip, a, b, c] = beam.node_vectors(last);
            let l = beam.director_length();
            let magnitude = Arc::new(AtomicU64::new(0));
            let couple =
                Couple { directors: [a, b, c], length: l, axis: [0.0, 0.0, 1.0], magnitude: Arc::clone(&magnitude) };
            let mut model = Model::default();
            lines::beam(&mut model, beam.clone(), &[0]);
            model.parts.push(Box::new(couple));
            let steps = 20;
            let mut run = lines::simulation(model, false, 1.0, f64::from(steps));
            let mut iterations = Vec::new();
            for step in 1..=steps {
                let m = moment * f64::from(step) / f64::from(steps);
                magnitude.store(m.to_bits(), Ordering::Relaxed);
                let record = run.advance().unwrap();
                iterations.push(record.iterations);
                if step == steps && elements == counts[0] {
                    // The stiffness against stretching makes the increments go up and down in pairs: quadratic over two iterations.
                    let increments = lines::newton("roll-up, last step", &record);
                    for w in increments.windows(3).filter(|w| w[0] < 1e-3 * length) {
                        assert!(w[2] < 100.0 * w[0] * w[0]);
                    }
                }
            }
            let q = &run.state().q;
            let x = lines::place(q, tip);
            gaps.push((x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt() / length);
            println!(
                "order {order}, {elements} elements: gap/L {:.2e}, iterations {iterations:?}",
                gaps[gaps.len() - 1]
            );
            // d_1 = y, d_2 = z: bending about z is about d_2. The moment is the applied one at every Gauss point, but for directors that are shorter between
            // nodes: elements of order 1 have the strain sin(a) / h for an angle of a, thus the moment M / cos(a).
            let worst = beam.section_forces(q).iter().map(|r| (r.moment[1] / moment - 1.0).abs()).fold(0.0, f64::max);
            println!("order {order}, {elements} elements: error of the moment {worst:.1e}");
            moments.push(worst);
        }
        assert!(gaps[1] < bound && f64::log2(gaps[0] / gaps[1]) > least, "{gaps:?}");
        assert!(moments[1] < 0.02 && moments[1] < 0.3 * moments[0], "{moments:?}");
    }
}

/// The load at which a clamped column with a free end bends away: the compressed state is found by the solver, and the determinant of its linear equations,
/// multipliers included, changes its sign. With `Gamma_3 = -P/EA` before buckling the rod theory has `P (1 + P/kGA - P/EA) = pi^2 EI / (4 L^2)`.
#[test]
fn buckling_of_a_column() {
    let section =
        Section { axial: 300.0, shear: [100.0; 2], bending: [2.0, 5.0], torsion: 3.0, mass: 0.0, rotary: [0.0; 2] };
    let length = 3.0;
    let euler = euler_load(length, section.bending[0]);
    let exact = buckling_load(length, section.bending[0], section.axial, section.shear[1]);
    for (order, counts, bound) in [(1, [16, 32], 2e-3), (2, [4, 8], 2e-5), (3, [2, 4], 2e-5)] {
        let errors = counts.map(|elements| {
            let stable = |load: f64| {
                let beam = straight(length, elements, order, section);
                let last = beam.node_count() - 1;
                let set = beam.constraints_except(&[0]);
                let mut model = Model::default();
                lines::beam(&mut model, beam.clone(), &[0]);
                lines::ramp(&mut model, beam.node_vectors(last)[0], [-load, 0.0, 0.0]);
                let mut run = lines::simulation(model, false, 1.0, 1.0);
                run.advance().unwrap();
                determinant_sign(&beam, &set, &run.state().q, &run.pressures()[0])
            };
            let (mut low, mut high) = (0.5 * exact, 1.5 * exact);
            let first = stable(low);
            assert_ne!(first, stable(high));
            for _ in 0..24 {
                let middle = 0.5 * (low + high);
                if stable(middle) == first { low = middle } else { high = middle }
            }
            low / exact - 1.0
        });
        println!(
            "order {order}, {counts:?} elements: errors {} (Euler {:.1e})",
            lines::brief(&errors),
            euler / exact - 1.0
        );
        assert!(errors[1].abs() < bound && errors[1].abs() < 0.3 * errors[0].abs());
    }
}

/// Sign of the determinant of `[K G^T; G 0]` without the first node.
fn determinant_sign(beam: &Beam, set: &impl Term, q: &[f64], multipliers: &[f64]) -> bool {
    let n = q.len() - 12;
    let size = n + multipliers.len();
    let mut matrix = DMatrix::<f64>::zeros(size, size);
    let mut add = |rows: &[usize], tangent: &[f64]| {
        for (i, &r) in rows.iter().enumerate().filter(|(_, r)| **r >= 12) {
            for (j, &c) in rows.iter().enumerate().filter(|(_, c)| **c >= 12) {
                matrix[(r - 12, c - 12)] += tangent[i * rows.len() + j];
            }
        }
    };
    let components = |vectors: &[u32]| -> Vec<usize> {
        vectors.iter().flat_map(|&v| (0..3).map(move |d| 3 * v as usize + d)).collect()
    };
    let step = At { rates: false, ..At::force([q, q], ForceRule::END_POINT, 1.0) };
    beam.assemble(&step, true, &mut |local| add(&components(&local.nodes), &local.tangent)).unwrap();
    let step = StepConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
    let active = vec![true; multipliers.len()];
    set.assemble(&step.at(multipliers, &active), true, &mut |local| {
        let mut rows = components(&local.nodes);
        rows.extend(local.slots.iter().map(|&s| q.len() + s as usize));
        add(&rows, &local.tangent);
    })
    .unwrap();
    let lu = matrix.lu();
    let negative = lu.u().diagonal().iter().filter(|d| **d < 0.0).count();
    (negative % 2 == 0) == (lu.p().determinant::<f64>() > 0.0)
}

/// Elastic catenary of a string of natural length `L` and weight `w` a length under the horizontal force `H`: the tension is `T(s) = sqrt(H^2 + w^2 s^2)` from the
/// lowest point, the stretch `nu = T/EA + sqrt(1 + (T/EA)^2)`, span and sag are the integrals of `nu H / T` and `nu w s / T`. Between supports with
/// this span the string must hang by this sag.
#[test]
fn catenary() {
    let (length, weight, horizontal) = (3.0, 2.0, 1.5);
    for stiffness in [20.0, 1e5] {
        let (span, sag) = catenary_of(length, weight, horizontal, stiffness);
        if stiffness == 1e5 {
            let a = horizontal / weight;
            let rigid = [2.0 * a * (0.5 * length / a).asinh(), (a * a + 0.25 * length * length).sqrt() - a];
            assert!((span / rigid[0] - 1.0).abs() < 1e-4 && (sag / rigid[1] - 1.0).abs() < 1e-4);
        }
        for (order, counts, least) in [(1, [16, 32], 1.9), (2, [8, 16], 3.8), (3, [4, 8], 3.8)] {
            let mut errors = Vec::new();
            for elements in counts {
                // From a parabola with the sag, stretched or shortened to the natural length.
                let n = order * elements;
                let node = |i: usize| {
                    let t = 2.0 * i as f64 / n as f64 - 1.0;
                    [0.5 * span * t, 0.0, 0.9 * sag * (t * t - 1.0)]
                };
                let nodes: Vec<[f64; 3]> = (0..=n).map(node).collect();
                let material = StringMaterial { stiffness, mass: 1.0, lumped: false, tension_only: false };
                let make = |stretch| ElasticString::new("string", 0, order, nodes.clone(), material, stretch).unwrap();
                let string = make(make(1.0).natural_length() / length);
                assert!((string.natural_length() / length - 1.0).abs() < 1e-13);
                let mut model = Model::default();
                lines::vectors(&mut model, string.reference());
                lines::fix(&mut model, &[0, n as u32]);
                let middle = string.node_vector(n / 2);
                model.parts.push(Box::new(string.clone()));
                lines::gravity(&mut model, [0.0, 0.0, -weight]);
                let mut run = lines::simulation(model, false, 1.0, 1.0);
                let record = run.advance().unwrap();
                let increments = lines::newton(&format!("catenary {stiffness} {order}"), &record);
                if stiffness < 1e3 {
                    lines::assert_quadratic(&increments, length);
                }
                errors.push((lines::place(&run.state().q, middle)[2] / -sag - 1.0).abs());
                let tensions = string.tensions(&run.state().q);
                let least = tensions.iter().copied().fold(f64::INFINITY, f64::min);
                assert!((least / horizontal - 1.0).abs() < 0.05, "{least}");
            }
            println!("catenary, EA {stiffness}, order {order}: errors of the sag {}", lines::brief(&errors));
            let least = if stiffness < 1e3 { least } else { 1.51 };
            assert!(errors[1] < 2e-3 && f64::log2(errors[0] / errors[1]) > least, "{errors:?}");
        }
    }
}

/// The rotation of a section follows a prescribed turn of the other end: torsion, `GJ theta / L`.
#[test]
fn torsion() {
    let section =
        Section { axial: 1e3, shear: [4e2; 2], bending: [3.0, 4.0], torsion: 2.0, mass: 0.0, rotary: [0.0; 2] };
    let beam = straight(4.0, 8, 2, section);
    let last = beam.node_count() - 1;
    let [_, a, b, c] = beam.node_vectors(last);
    let magnitude = Arc::new(AtomicU64::new(0.4_f64.to_bits()));
    let couple = Couple { directors: [a, b, c], length: beam.director_length(), axis: [1.0, 0.0, 0.0], magnitude };
    let mut model = Model::default();
    lines::beam(&mut model, beam.clone(), &[0]);
    model.parts.push(Box::new(couple));
    let mut run = lines::simulation(model, false, 1.0, 1.0);
    run.advance().unwrap();
    let r = beam.rotation(last, &run.state().q);
    let angle = DVector::from_vec(vec![r[1][1] + r[2][2], r[2][1] - r[1][2]]);
    let angle = angle[1].atan2(angle[0]);
    println!("torsion: {angle} for {}", 0.4 * 4.0 / 2.0);
    assert!((angle / 0.8 - 1.0).abs() < 1e-4, "{angle}");
}
