//! One facet against two: weighted gaps, and the nodal forces of a uniform pressure between meshes that do not match.
//!
//! Checked: where the gap is uniform, each weighted gap is the gap times the weight of its node; the forces on both sides are those of a
//! uniform pressure, for both spaces of multipliers (patch test).
//!
//! `cargo run --example patch -p stoss-contact-mortar`

use stoss_contact_mortar::{MortarContact, MortarOptions, MultiplierSpace};
use stoss_term::{At, GradientRule, StepConfiguration, StepContext, Term, Unilateral};

/// A square of the slave that looks down on two rectangles of the master, of widths 0.3 and 0.7, `gap` below.
fn positions(gap: f64) -> Vec<f64> {
    let slave = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(|[x, y]| [x, y, gap]);
    let master = [[0.0, 0.0], [0.3, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 1.0], [1.0, 1.0]].map(|[x, y]| [x, y, 0.0]);
    slave.into_iter().chain(master).flatten().collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (gap, pressure) = (-0.001, 12.0);
    // A quarter of each facet's area for each of its nodes.
    let of_master = [0.3, 1.0, 0.7, 0.3, 1.0, 0.7].map(|width| -0.25 * width * pressure);
    let expected: Vec<f64> = [0.25 * pressure; 4].into_iter().chain(of_master).collect();
    for space in [MultiplierSpace::Standard, MultiplierSpace::Dual] {
        let options = MortarOptions { space, ..MortarOptions::default() };
        let (slave, master) = ([[0u32, 1, 2, 3]], [[4u32, 5, 8, 7], [5, 6, 9, 8]]);
        let mut contact = MortarContact::new("patch", &slave, &master, &positions(0.1), options)?;
        let (q, active) = (positions(gap), [true; 4]);
        // In dynamics forces are gradients of the weighted gaps, in which weights move with the positions: a penetration shifts forces then.
        contact.begin(&StepContext { reach: 0.1, ..StepContext::quasi_static(&q, 1.0) })?;
        contact.renew(&At::end(&q, &[pressure; 4], &active), false)?;
        let mut gaps = [0.0; 4];
        contact.complementarity_gaps(&q, &active, &mut gaps)?;

        let (mut force, mut rows) = (vec![0.0; q.len()], [0.0; 4]);
        let step = StepConfiguration { q_n: &q, q_np1: &q, rule: GradientRule::EndPoint };
        contact.assemble(&step.at(&[pressure; 4], &active), false, &mut |local| {
            for (k, &node) in local.nodes.iter().enumerate() {
                // The residual holds minus the force.
                (0..3).for_each(|i| force[3 * node as usize + i] -= local.residual[3 * k + i]);
            }
            let first = 3 * local.nodes.len();
            local.slots.iter().enumerate().for_each(|(k, &slot)| rows[slot as usize] += local.residual[first + k]);
        })?;
        println!("{space:?}\nnode  force along z  uniform pressure  weighted gap");
        for (node, (force, expected)) in force.chunks_exact(3).zip(&expected).enumerate() {
            let weighted = rows.get(node).map_or(String::new(), |row| format!("{:14.3e}", -row));
            println!("{node:4} {:14.6} {expected:17.6} {weighted}", force[2]);
            assert!((force[2] - expected).abs() < 1e-12 && force[0].abs().max(force[1].abs()) < 1e-12);
        }
        for (slot, row) in rows.into_iter().enumerate() {
            assert!((row + contact.slot_weight(slot) * gap).abs() < 1e-15 && (gaps[slot] / gap - 1.0).abs() < 1e-12);
        }
        assert!(contact.verify(&q)?.defect < 1e-12);
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
