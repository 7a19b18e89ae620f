//! Which length of the directors makes the best matrix: condition numbers of the linear equations of a clamped beam, rigidity included.

use nalgebra::DMatrix;
use stoss_multibody::{Beam, BeamAxis, Section, SectionMaterial};
use stoss_term::{At, ForceRule, GradientRule, StepConfiguration, Term, Vectors};

/// Condition number (2-norm) of `[K + M / dt^2, s G^T; s G, 0]` in the reference configuration, first node clamped, `s = EA / h` so that multipliers are lengths.
fn condition(beam: &Beam, inertia: f64) -> f64 {
    let q: Vec<f64> = beam.reference().iter().flatten().copied().collect();
    let set = beam.constraints_except(&[0]);
    let n = q.len() - 12;
    let mut matrix = DMatrix::<f64>::zeros(n + set.slot_count(), n + set.slot_count());
    let rows_of = |vectors: &[u32]| -> Vec<usize> {
        vectors.iter().flat_map(|&v| (0..3).map(move |d| 3 * v as usize + d)).collect()
    };
    let mut add = |rows: &[usize], factor: f64, tangent: &[f64]| {
        for (i, &r) in rows.iter().enumerate().filter(|(_, r)| **r >= 12) {
            for (j, &c) in rows.iter().enumerate().filter(|(_, c)| **c >= 12) {
                matrix[(r - 12, c - 12)] += factor * tangent[i * rows.len() + j];
            }
        }
    };
    let step = At { rates: false, ..At::force([&q, &q], ForceRule::END_POINT, 1.0) };
    beam.assemble(&step, true, &mut |local| add(&rows_of(&local.nodes), 1.0, &local.tangent)).unwrap();
    beam.mass(&mut |i, j, m| {
        for d in 0..3 {
            let [i, j] = [i, j].map(|v| 3 * v as usize + d);
            if i == j {
                add(&[i], inertia, &[m]);
            } else {
                add(&[i, j], inertia, &[0.0, m, m, 0.0]);
            }
        }
    });
    let scale = beam.section().axial / beam.length_scale();
    let step = StepConfiguration { q_n: &q, q_np1: &q, rule: GradientRule::EndPoint };
    let (zero, active) = (vec![0.0; set.slot_count()], vec![true; set.slot_count()]);
    set.assemble(&step.at(&zero, &active), true, &mut |local| {
        let mut rows = rows_of(&local.nodes);
        rows.extend(local.slots.iter().map(|&s| q.len() + s as usize));
        add(&rows, scale, &local.tangent);
    })
    .unwrap();
    let singular = matrix.singular_values();
    singular.max() / singular.min()
}

#[test]
fn length_of_directors_by_condition() {
    for slenderness in [2.0, 20.0, 200.0] {
        // Elements of length 1 with two node distances; the radius of gyration from the slenderness of an element.
        let radius = 1.0 / slenderness;
        let side = radius * 12.0_f64.sqrt();
        let material = SectionMaterial { young: 1.0, poisson: 0.3, density: 1.0 };
        let section = Section::rectangle([side, side], material, 5.0 / 6.0, None).unwrap();
        let axis = BeamAxis::straight([0.0; 3], [4.0, 0.0, 0.0], [0.0, 0.0, 1.0], 4, 2).unwrap();
        for inertia in [0.0, 4.0 * 400.0] {
            let lengths = [radius, 3.0 * radius, 0.1, 0.25, 0.5, 1.0, 2.0];
            let row: Vec<f64> = lengths
                .iter()
                .map(|&l| condition(&Beam::with_director_length("beam", 0, axis.clone(), section, l).unwrap(), inertia))
                .collect();
            let text: Vec<String> = row.iter().map(|c| format!("{c:.1e}")).collect();
            let chosen = condition(&Beam::new("beam", 0, axis.clone(), section).unwrap(), inertia);
            let best = row.iter().copied().fold(f64::INFINITY, f64::min);
            if inertia == 0.0 {
                assert!(chosen < 2.0 * best);
            }
            println!("h/r = {slenderness}, inertia {inertia}: l = r, 3 r, h/10, h/4, h/2, h, 2 h: {}", text.join(" "));
        }
    }
}
