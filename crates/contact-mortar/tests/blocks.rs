//! The whole surface of a block as the slave before a plate and a wall: one row for each side of a node.

use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use stoss_contact_mortar::{Factors, MortarContact, MortarOptions, MultiplierSpace};
use stoss_term::{At, GradientRule, StepConfiguration, StepContext, Term, Unilateral};
use stoss_testkit::meshes::{Mesh, meshes};

/// Faces of a cube whose corner `k` is at the bits of `k`, numbered outward; the first one is the lower.
const CUBE: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
const SLAVE: usize = 8;
/// Rows against one and against two smooth parts of the master.
const ROWS: usize = 24;

/// A unit cube with its lowest corner at `at`, over a plate of 4 by 4 in z = 0 with a wall at its end, x = 4.
fn positions(at: [f64; 3]) -> Vec<f64> {
    let corner = |k: usize| [at[0] + (k & 1) as f64, at[1] + (k >> 1 & 1) as f64, at[2] + (k >> 2) as f64];
    let mut q: Vec<f64> = (0..SLAVE).flat_map(corner).collect();
    q.extend([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].iter().flat_map(|[x, y]| [*x, *y, 0.0]));
    q.extend([4.0, 0.0, 4.0, 4.0, 4.0, 4.0]);
    q
}

fn method(meshes: [Mesh; 2], walls: bool, dual: bool, q: &[f64]) -> MortarContact {
    let space = if dual { MultiplierSpace::Dual } else { MultiplierSpace::Standard };
    let options = MortarOptions { space, ..MortarOptions::default() };
    let master = [[8, 9, 10, 11], [9, 12, 13, 10]];
    let master = if walls { &master[..] } else { &master[..1] };
    let method =
        MortarContact::new("test", &meshes[0].of(&CUBE), &meshes[1].of(master), &positions([1.0; 3]), options).unwrap();
    // The plain mean in statics too.
    let plain = method.factors();
    let mut method = method.with_factors(plain);
    method.begin(&StepContext { reach: 0.5, ..StepContext::quasi_static(q, 0.1) }).unwrap();
    method
}

/// Sum of what a pressure on the rows of these directions (into the slave) does to the slave.
fn force(method: &mut MortarContact, q: &[f64], pressure: f64, directions: &[[f64; 3]]) -> Vector3<f64> {
    let along = |normal: [f64; 3]| directions.iter().any(|d| (Vector3::from(*d) - Vector3::from(normal)).norm() < 1e-9);
    let active: Vec<bool> = method.report(q).unwrap().iter().map(|r| r.gap.is_some() && along(r.normal)).collect();
    let pressures: Vec<f64> = active.iter().map(|a| if *a { pressure } else { 0.0 }).collect();
    method.renew(&At::end(q, &pressures, &active), true).unwrap();
    let step = StepConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
    let mut force = Vector3::zeros();
    method
        .assemble(&step.at(&pressures, &active), false, &mut |local| {
            let slave = local.nodes.iter().zip(local.residual.chunks_exact(3)).filter(|(n, _)| **n < SLAVE as u32);
            slave.for_each(|(_, f)| force -= Vector3::new(f[0], f[1], f[2]));
        })
        .unwrap();
    force
}

proptest! {
    /// The lower face stands on the plate wholly, the sides count for nothing.
    #[test]
    fn a_whole_block_stands_on_its_lower_face_alone(meshes in meshes(), gap in -0.2f64..0.2, dual in any::<bool>()) {
        let q = positions([1.2, 1.3, gap]);
        let method = method(meshes, false, dual, &q);
        let mut gaps = [0.0; ROWS];
        method.complementarity_gaps(&q, &[true; ROWS], &mut gaps).unwrap();
        let lower: Vec<f64> = gaps.into_iter().filter(|g| g.is_finite()).collect();
        prop_assert!(lower.len() == 4 && lower.iter().all(|g| (g - gap).abs() < 1e-9), "{gaps:?}");
    }

    /// A block in a corner: under one pressure floor and wall each take the pressure times its area, the edge between them included.
    #[test]
    fn floor_and_wall_take_a_uniform_pressure_each_for_itself(meshes in meshes(), along in 0.1f64..2.9, pressure in 0.1f64..9.0, dual in any::<bool>()) {
        let q = positions([3.0, along, 0.0]);
        let mut method = method(meshes, true, dual, &q);
        let on = |method: &mut MortarContact, directions: &[[f64; 3]]| force(method, &q, pressure, directions);
        let (floor, wall) = (on(&mut method, &[[0.0, 0.0, 1.0]]), on(&mut method, &[[-1.0, 0.0, 0.0]]));
        prop_assert!((floor - Vector3::new(0.0, 0.0, pressure)).amax() < 1e-12 * pressure, "{floor}");
        prop_assert!((wall - Vector3::new(-pressure, 0.0, 0.0)).amax() < 1e-12 * pressure, "{wall}");
    }

    /// A wall beside the block has no part in what it stands on.
    #[test]
    fn a_wall_is_no_part_of_the_floor(meshes in meshes(), gap in -0.05f64..0.05, clearance in 0.1f64..2.0, dual in any::<bool>()) {
        let q = positions([3.0 - clearance, 1.4, gap]);
        let reports = method(meshes, true, dual, &q).report(&q).unwrap();
        for report in reports.iter().filter(|r| r.gap.is_some()) {
            let expected = if report.normal[2] > 0.5 { gap } else { clearance };
            prop_assert!(report.gap.is_some_and(|g| (g - expected).abs() < 1e-9), "{report:?}");
        }
    }

    /// However a side leans, its force on the plate is along the plate's normal: moving integrals see to it.
    #[test]
    fn the_force_of_an_edge_has_the_direction_of_the_plate(meshes in meshes(), angle in 0.02f64..0.7, turn in 0.0f64..1.5, dual in any::<bool>()) {
        let lean = Rotation3::from_euler_angles(0.0, 0.0, turn) * Rotation3::from_euler_angles(angle, 0.0, 0.0);
        let mut q = positions([1.5, 1.5, 0.0]);
        for x in q[..3 * SLAVE].chunks_exact_mut(3) {
            let y = lean * Vector3::new(x[0] - 2.0, x[1] - 2.0, x[2]) + Vector3::new(2.0, 2.0, 0.3);
            x.copy_from_slice(y.as_slice());
        }
        // No side may see the rim of the plate.
        for x in q[3 * SLAVE..3 * SLAVE + 12].chunks_exact_mut(3) {
            (0..2).for_each(|i| x[i] = 40.0 * (x[i] - 2.0));
        }
        let mut method = method(meshes, false, dual, &q).with_factors(Factors { nearness: 0.0, deepest: f64::INFINITY, ..Factors { facing: true, ..Factors::NONE } });
        method.begin(&StepContext { reach: 0.5, ..StepContext::new(&q, GradientRule::EndPoint, 0.0) }).unwrap();
        let directions: Vec<[f64; 3]> = method.report(&q).unwrap().iter().map(|r| r.normal).collect();
        let force = force(&mut method, &q, 1.0, &directions);
        prop_assert!(force.z > 0.1 && force.x.hypot(force.y) < 1e-8 * force.z, "{force}");
    }
}
