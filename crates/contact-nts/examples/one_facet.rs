//! Gap and force of one node and one facet, in a step of the energy-momentum scheme in which both move and the facet deforms.
//!
//! Checked: the forces have neither resultant nor moment about the middle of the step, and their work is pressure times area times change of
//! the gap; so energy and momenta of the bodies are exact.
//!
//! `cargo run --example one_facet -p stoss-contact-nts`

use stoss_contact_nts::{ConstraintForm, NodeToSurface, NodeToSurfaceOptions};
use stoss_term::{Fault, GradientRule, StepConfiguration, StepContext, Term, Unilateral};

/// Four nodes of the master, whose facet looks up, and four of a small facet of the slave above it, of which the first is watched.
fn positions(slave: [f64; 3], lift: f64) -> Vec<f64> {
    let master = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.1, 1.0, lift], [0.0, 1.0, 0.0]];
    let corners = [[0.0, 0.0, 0.0], [0.0, 0.2, 0.2], [0.2, 0.2, 0.2], [0.2, 0.0, 0.2]];
    let slave = corners.map(|d| std::array::from_fn(|i| slave[i] + d[i]));
    master.into_iter().chain(slave).flatten().collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let reference = positions([0.4, 0.3, 0.2], 0.0);
    // The row of a step is -A (g_np1 - g_n).
    let options = NodeToSurfaceOptions { constraint: ConstraintForm::Modified, ..NodeToSurfaceOptions::default() };
    let mut contact = NodeToSurface::new("pair", &[[4u32, 5, 6, 7]], &[[0u32, 1, 2, 3]], &reference, options)?;
    let (rule, pressure) = (GradientRule::DiscreteGradient, 20.0);
    let (pressures, active) = ([pressure, 0.0, 0.0, 0.0], [true, false, false, false]);
    println!("gap before, after      force on the node                     resultant  moment   work / (p A dg) - 1");
    let q_n = positions([0.4, 0.3, 0.02], 0.0);
    for (slave, lift) in [([0.4, 0.3, 0.01], 0.0), ([0.5, 0.5, 0.03], 0.2), ([0.7, 0.2, -0.02], -0.2)] {
        let q_np1 = positions(slave, lift);
        contact.begin(&StepContext { reach: 1.0, ..StepContext::new(&q_n, rule, 0.1) })?;
        contact.repair(&q_np1, &active)?;
        let gap = |q: &[f64]| -> Result<f64, Fault> { Ok(contact.report(q)?[0].gap.unwrap_or(f64::NAN)) };
        let gaps = [gap(&q_n)?, gap(&q_np1)?];
        let (mut force, mut row) = (vec![0.0; q_n.len()], 0.0);
        let step = StepConfiguration { q_n: &q_n, q_np1: &q_np1, rule };
        contact.assemble(&step.at(&pressures, &active), false, &mut |local| {
            for (k, &node) in local.nodes.iter().enumerate() {
                // The residual holds minus the force.
                (0..3).for_each(|i| force[3 * node as usize + i] -= local.residual[3 * k + i]);
            }
            row += local.residual[3 * local.nodes.len()];
        })?;
        let (mut resultant, mut moment, mut work) = ([0.0; 3], [0.0; 3], 0.0);
        for (c, f) in force.iter().enumerate() {
            let (node, i) = (c / 3, c % 3);
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let mid = |i: usize| 0.5 * (q_n[3 * node + i] + q_np1[3 * node + i]);
            resultant[i] += f;
            moment[k] -= mid(j) * f;
            moment[j] += mid(k) * f;
            work += f * (q_np1[c] - q_n[c]);
        }
        let [resultant, moment] = [resultant, moment].map(|v| v.iter().fold(0.0, |m: f64, x| m.max(x.abs())));
        let expected = -pressure * row;
        let area = contact.slot_weight(0);
        let error = (work / expected - 1.0).abs();
        println!(
            "{:8.5} {:8.5}   ({:10.6}, {:10.6}, {:10.6})   {resultant:8.1e} {moment:8.1e} {error:8.1e}",
            gaps[0], gaps[1], force[12], force[13], force[14]
        );
        assert!((row + area * (gaps[1] - gaps[0])).abs() < 1e-14);
        assert!(resultant < 1e-14 && moment < 1e-14 && error < 1e-12);
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
