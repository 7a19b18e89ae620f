//! The whole surface of a block, or a side of it, as the slave before a plate: what is opposite, and what a node could stand on.

use proptest::prelude::*;
use stoss_contact::{ContactMethod, ContactRule, StepConfiguration};
use stoss_contact_mortar::{MortarContact, MortarOptions, MultiplierSpace};

/// Faces of a cube whose corner `k` is at the bits of `k`, numbered outward; the first one is the lower.
const CUBE: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
const SLAVE: usize = 8;

/// A unit cube with its lowest corner at `at`, sheared by `lean` along x and y, over a plate of 4 by 4 in z = 0.
fn positions(at: [f64; 3], lean: [f64; 2]) -> Vec<f64> {
    let mut q = Vec::new();
    for k in 0..SLAVE {
        let up = (k >> 2) as f64;
        q.extend([at[0] + (k & 1) as f64 + lean[0] * up, at[1] + (k >> 1 & 1) as f64 + lean[1] * up, at[2] + up]);
    }
    q.extend([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].iter().flat_map(|[x, y]| [*x, *y, 0.0]));
    q
}

fn method(slave: &[[u32; 4]], dual: bool, rule: ContactRule) -> MortarContact {
    let space = if dual { MultiplierSpace::Dual } else { MultiplierSpace::Standard };
    let options = MortarOptions { space, ..MortarOptions::default() };
    let mut method =
        MortarContact::new("test", slave, &[[8, 9, 10, 11]], &positions([1.0; 3], [0.0; 2]), options).unwrap();
    method.set_rule(rule, 0.1);
    method
}

/// The cube with its lowest corner at `at`, the plate and a wall at its end, x = 4, all with one velocity: positions, and the method at the begin of a step.
fn in_corner(at: [f64; 3], velocity: [f64; 3], dual: bool, rule: ContactRule) -> (Vec<f64>, MortarContact) {
    let mut q = positions(at, [0.0; 2]);
    q.extend([4.0, 0.0, 4.0, 4.0, 4.0, 4.0]);
    let space = if dual { MultiplierSpace::Dual } else { MultiplierSpace::Standard };
    let options = MortarOptions { space, ..MortarOptions::default() };
    let mut method = MortarContact::new("test", &CUBE, &[[8, 9, 10, 11], [9, 12, 13, 10]], &q, options).unwrap();
    method.set_rule(rule, 0.1);
    method.set_velocity(&velocity.repeat(q.len() / 3));
    method.begin_step(&q, 0.5).unwrap();
    (q, method)
}

proptest! {
    /// The lower face stands on the plate wholly, the sides count for nothing: the constraint of an edge or a corner is not that of a node of which
    /// a part hangs over.
    #[test]
    fn a_whole_block_stands_on_its_lower_face_alone(gap in -0.1f64..0.2, lean in prop::array::uniform2(-0.2f64..0.2), dual in any::<bool>()) {
        let q = positions([1.2, 1.3, gap], lean);
        let mut gaps = [0.0; SLAVE];
        let mut whole = method(&CUBE, dual, ContactRule::EndPoint).with_softening(20.0, 0.0);
        whole.begin_step(&q, 0.5).unwrap();
        whole.complementarity_gaps(&q, &[true; SLAVE], &mut gaps).unwrap();
        prop_assert!(gaps[..4].iter().all(|g| (g - gap).abs() < 1e-13), "{gaps:?}");
        prop_assert!(gaps[4..].iter().all(|g| g.is_infinite()), "{gaps:?}");
        prop_assert!(whole.supports()[..4].iter().all(|s| (s - 0.25).abs() < 1e-13));
    }

    /// Of a block that stands on the plate beside a wall the lower nodes have the plate's gap: the wall is no part of it, however fast all move together.
    #[test]
    fn a_wall_beside_a_block_has_no_part_in_what_it_stands_on(
        gap in -0.05f64..0.05, clearance in 0.1f64..2.0, velocity in prop::array::uniform3(-10.0f64..10.0),
        dual in any::<bool>(), rule in 0..3_usize,
    ) {
        let rules = [ContactRule::EndPoint, ContactRule::Midpoint, ContactRule::EnergyMomentum];
        let (q, method) = in_corner([3.0 - clearance, 1.4, gap], velocity, dual, rules[rule]);
        let mut gaps = [0.0; SLAVE];
        method.complementarity_gaps(&q, &[true; SLAVE], &mut gaps).unwrap();
        prop_assert!(gaps[..4].iter().all(|g| (g - gap).abs() < 1e-12), "{gaps:?}");
        // The side before the wall, as high as the wall sees it.
        let left_out = method.verify().unwrap().left_out;
        prop_assert!((left_out - (1.0 + gap.min(0.0))).abs() < 1e-12, "{left_out}");
    }

    /// A block in a corner: under one pressure on floor and wall each takes the pressure times its area, the edge between them included.
    #[test]
    fn floor_and_wall_take_a_uniform_pressure_each_for_itself(along in 0.1f64..2.9, pressure in 0.1f64..9.0, dual in any::<bool>()) {
        let (q, method) = in_corner([3.0, along, 0.0], [0.0; 3], dual, ContactRule::EndPoint);
        // Nodes of the lower side and of that at the wall.
        let active = [0, 1, 2, 3, 4, 5, 6, 7].map(|k| k < 4 || k % 2 == 1);
        let pressures = active.map(|a| if a { pressure } else { 0.0 });
        let step = StepConfiguration { q_n: &q, q_np1: &q, rule: ContactRule::EndPoint };
        let mut force = [0.0; 3];
        method
            .assemble(step, &pressures, &active, false, &mut |local| {
                let slave = local.nodes.iter().zip(local.residual.chunks_exact(3)).filter(|(n, _)| **n < SLAVE as u32);
                slave.for_each(|(_, f)| (0..3).for_each(|i| force[i] += f[i]));
            })
            .unwrap();
        let expected = [pressure, 0.0, -pressure];
        let sign = force[0].signum();
        prop_assert!((0..3).all(|i| (sign * force[i] - expected[i]).abs() < 1e-12 * pressure), "{force:?}");
        prop_assert_eq!(method.verify().unwrap().left_out, 0.0);
    }

    /// A side that leans sees the plate edge-on and is opposite nothing, alone as beside the others; one that lies nearly flat is.
    #[test]
    fn a_side_is_opposite_nothing_until_it_lies_down(lean in 0.0f64..0.2, gap in 0.01f64..0.3, dual in any::<bool>()) {
        for rule in [ContactRule::EndPoint, ContactRule::Midpoint, ContactRule::EnergyMomentum] {
            let mut side = method(&CUBE[2..3], dual, rule);
            side.begin_step(&positions([1.0, 1.0, gap], [0.0, -lean]), 2.0).unwrap();
            prop_assert!(side.supports().iter().all(|s| *s == 0.0), "{rule:?}: {:?}", side.supports());
            side.begin_step(&positions([1.0, 2.5, gap], [0.0, -2.0]), 2.0).unwrap();
            prop_assert!(side.supports().iter().all(|s| *s > 0.0), "{rule:?}: {:?}", side.supports());
        }
    }

    /// Of a block whose corner is over the plate by little all four lower nodes have next to nothing. Those with the most keep their multipliers, and all of
    /// the area.
    #[test]
    fn a_sliver_of_a_facet_keeps_its_area(over in prop::array::uniform2(-4.0f64..-1.0), dual in any::<bool>()) {
        let over = over.map(|e| 10f64.powf(e));
        let q = positions([4.0 - over[0], 4.0 - over[1], 0.05], [0.0; 2]);
        for rule in [ContactRule::Midpoint, ContactRule::EnergyMomentum] {
            let mut method = method(&CUBE[..1], dual, rule);
            method.begin_step(&q, 0.5).unwrap();
            let supports = method.supports();
            let (sum, largest) = (supports.iter().sum::<f64>(), supports.iter().copied().fold(0.0, f64::max));
            prop_assert!((sum - over[0] * over[1]).abs() < 1e-12 * sum.sqrt(), "{supports:?}");
            prop_assert!(supports.iter().all(|s| *s == 0.0 || *s > 0.3 * largest), "{supports:?}");
            let reports = method.report(&q).unwrap();
            prop_assert!(reports.iter().all(|r| r.gap.is_none_or(|g| (g - 0.05).abs() < 1e-10)), "{reports:?}");
        }
    }

    /// Where integrals move, too, the node with the most has its constraint as it is, although less than half of it is covered: there is no other that could
    /// carry it.
    #[test]
    fn a_corner_is_carried_by_the_node_with_most_of_it(over in prop::array::uniform2(0.2f64..1.0), dual in any::<bool>()) {
        let q = positions([4.0 - over[0], 4.0 - over[1], 0.05], [0.0; 2]);
        let mut soft = method(&CUBE[..1], dual, ContactRule::EndPoint).with_softening(20.0, 0.1);
        soft.begin_step(&q, 0.5).unwrap();
        let mut gaps = [0.0; SLAVE];
        soft.complementarity_gaps(&q, &[true; SLAVE], &mut gaps).unwrap();
        let supports = soft.supports();
        let most = (0..4).max_by(|&a, &b| supports[a].total_cmp(&supports[b])).unwrap();
        prop_assert!((gaps[most] - 0.05).abs() < 1e-10, "{gaps:?} {supports:?}");
    }
}
