//! Forces and tangents of all parts at random states: work, momenta, frames, derivatives.

use proptest::prelude::*;
use stoss_multibody::{
    Beam, BeamAxis, ElasticString, Embedded, PointMass, Section, SectionMaterial, Spring, SpringData, StringMaterial,
};
use stoss_term::{At, ForceRule, Term, Vectors};

const MATERIAL: SectionMaterial = SectionMaterial { young: 50.0, poisson: 0.3, density: 2.0 };

fn section() -> Section {
    Section::rectangle([0.4, 0.7], MATERIAL, 5.0 / 6.0, None).unwrap()
}

fn flat(vectors: &[[f64; 3]]) -> Vec<f64> {
    vectors.iter().flatten().copied().collect()
}

fn corner(order: usize) -> Beam {
    let points = [[0.0; 3], [1.0, 0.2, 0.0], [1.1, 1.3, 0.4]];
    let axis = BeamAxis::polyline(&points, [0.1, 0.2, 1.0], &[1, 2], order).unwrap();
    Beam::new("corner", 0, axis, section()).unwrap()
}

fn string(order: usize, tension_only: bool) -> ElasticString {
    let nodes = ElasticString::straight_nodes([0.0; 3], [2.0, 0.3, -0.4], 2, order).unwrap();
    let material = StringMaterial { stiffness: 3.0, mass: 1.4, lumped: false, tension_only };
    ElasticString::new("string", 0, order, nodes, material, 1.05).unwrap()
}

/// Each part with a reference configuration; the unit of its forces.
fn parts() -> Vec<(Box<dyn Term>, Vec<f64>, f64)> {
    let mut parts: Vec<(Box<dyn Term>, Vec<f64>, f64)> = Vec::new();
    for order in 1..=3 {
        let beam = corner(order);
        let reference = flat(&beam.reference());
        parts.push((Box::new(beam), reference, 50.0));
        for tension_only in [false, true] {
            let string = string(order, tension_only);
            let reference = flat(string.reference());
            parts.push((Box::new(string), reference, 3.0));
        }
    }
    let arm = Embedded { constant: [0.0; 3], terms: vec![(1, 1.0), (2, 0.3)] };
    for tension_only in [false, true] {
        let data = SpringData { stiffness: 2.0, rest_length: 1.0, tension_only, damping: 0.0 };
        let spring = Spring::new("spring", [Embedded::vector(0), arm.clone()], data).unwrap();
        parts.push((Box::new(spring), vec![0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.0, 0.4, 0.1], 2.0));
    }
    parts
}

fn assemble(part: &dyn Term, step: At<'_>) -> (Vec<f64>, Vec<Vec<f64>>) {
    gather(part, step, true)
}

/// Forces, and the tangent if it is asked for.
fn gather(part: &dyn Term, step: At<'_>, want_tangent: bool) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = step.q_n.len();
    let (mut force, mut tangent) = (vec![0.0; n], vec![vec![0.0; n]; if want_tangent { n } else { 0 }]);
    let mut stencils = Vec::new();
    part.stencils(&[], &mut |v, _| stencils.push(v.to_vec()));
    let mut k = 0;
    part.assemble(&step, want_tangent, &mut |local| {
        assert_eq!(local.nodes, stencils[k]);
        k += 1;
        let rows: Vec<usize> = local.nodes.iter().flat_map(|&v| (0..3).map(move |d| 3 * v as usize + d)).collect();
        for (i, &row) in rows.iter().enumerate() {
            force[row] += local.residual[i];
            for (j, &column) in rows.iter().enumerate().filter(|_| want_tangent) {
                tangent[row][column] += local.tangent[i * rows.len() + j];
            }
        }
    })
    .unwrap();
    assert_eq!(k, stencils.len());
    (force, tangent)
}

fn step<'a>(q_n: &'a [f64], q_np1: &'a [f64], rule: ForceRule) -> At<'a> {
    At::force([q_n, q_np1], rule, 0.1)
}

const RULES: [ForceRule; 4] =
    [ForceRule::START, ForceRule::MIDPOINT, ForceRule::END_POINT, ForceRule::DiscreteGradient];

fn disturbed(reference: &[f64], by: &[f64]) -> Vec<f64> {
    reference.iter().zip(by.iter().cycle()).map(|(x, d)| x + d).collect()
}

fn cross(a: &[f64], b: &[f64]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn disturbance(size: f64) -> impl Strategy<Value = Vec<f64>> {
    // A prime number of entries, so that they meet the components in all orders.
    proptest::collection::vec(-size..size, 127)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// `force . dq = dV` under the discrete gradient, for changes of any size.
    #[test]
    fn work_of_discrete_gradients(a in disturbance(0.25), b in disturbance(0.25), exponent in -12.0..0.0_f64) {
        for (part, reference, unit) in parts() {
            let q_n = disturbed(&reference, &a);
            let change: Vec<f64> = b.iter().map(|b| b * 10f64.powf(exponent)).collect();
            let q_np1 = disturbed(&q_n, &change);
            let (force, _) = assemble(&*part, step(&q_n, &q_np1, ForceRule::DiscreteGradient));
            let work: f64 = force.iter().zip(q_n.iter().zip(&q_np1)).map(|(f, (a, b))| f * (b - a)).sum();
            let change = part.energy(&q_np1).unwrap() - part.energy(&q_n).unwrap();
            prop_assert!((work - change).abs() < 1e-13 * unit * 20.0, "{}: {work} {change}", part.name());
        }
    }

    /// Tangents of all rules against central differences.
    #[test]
    fn tangents(a in disturbance(0.2), b in disturbance(0.2)) {
        for (part, reference, unit) in parts() {
            let (q_n, q_np1) = (disturbed(&reference, &a), disturbed(&reference, &b));
            for rule in RULES {
                let (force, tangent) = assemble(&*part, step(&q_n, &q_np1, rule));
                // Strings that are nearly shortened to nothing are stiff.
                let size = tangent.iter().flatten().fold(unit, |m, k| m.max(k.abs()));
                for column in 0..q_n.len() {
                    let differences = |h: f64| {
                        let at = |x: f64| {
                            let mut q = q_np1.clone();
                            q[column] += x;
                            gather(&*part, step(&q_n, &q, rule), false).0
                        };
                        let [up, down, up_2, down_2] = [h, -h, 2.0 * h, -2.0 * h].map(at);
                        // A law of tension only may have its kink on one side of the state, within the step of the difference.
                        move |row: usize, here: f64| {
                            [
                                (up[row] - down[row]) / (2.0 * h),
                                (4.0 * up[row] - 3.0 * here - up_2[row]) / (2.0 * h),
                                (3.0 * here - 4.0 * down[row] + down_2[row]) / (2.0 * h),
                            ]
                        }
                    };
                    let (long, short) = (differences(1e-5), std::cell::OnceCell::new());
                    for row in 0..q_n.len() {
                        let found = tangent[row][column];
                        let fits = |numeric: [f64; 3]| numeric.iter().any(|x| (x - found).abs() < 1e-6 * size);
                        // Two points of a string may have kinks on both sides: a hundred times nearer there is none.
                        let fits_nearby = || fits(short.get_or_init(|| differences(1e-7))(row, force[row]));
                        prop_assert!(
                            fits(long(row, force[row])) || fits_nearby(),
                            "{} {rule:?} {row} {column}: {:?} {found}",
                            part.name(),
                            long(row, force[row]),
                        );
                        if rule != ForceRule::DiscreteGradient {
                            prop_assert!((tangent[row][column] - tangent[column][row]).abs() < 1e-14 * size);
                        }
                    }
                }
            }
        }
    }

    /// No resultant on positions and no moment about `q_mid`, directions included.
    #[test]
    fn forces_are_in_balance(a in disturbance(0.25), b in disturbance(0.25)) {
        for (part, reference, unit) in parts() {
            let (q_n, q_np1) = (disturbed(&reference, &a), disturbed(&reference, &b));
            for rule in [ForceRule::MIDPOINT, ForceRule::DiscreteGradient] {
                let (force, _) = assemble(&*part, step(&q_n, &q_np1, rule));
                let (mut sum, mut moment) = ([0.0; 3], [0.0; 3]);
                for (v, f) in force.chunks(3).enumerate() {
                    let mid: Vec<f64> = (0..3).map(|d| 0.5 * (q_n[3 * v + d] + q_np1[3 * v + d])).collect();
                    let m = cross(&mid, f);
                    for d in 0..3 {
                        moment[d] += m[d];
                        // The ends of the spring are (0) and (1) + 0.3 (2): its vector 2 is a direction.
                        let is_direction = part.is_direction(v as u32) || part.name() == "spring" && v == 2;
                        if !is_direction {
                            sum[d] += f[d];
                        }
                    }
                }
                for d in 0..3 {
                    prop_assert!(sum[d].abs() < 1e-13 * unit * 20.0 && moment[d].abs() < 1e-13 * unit * 40.0, "{} {sum:?} {moment:?}", part.name());
                }
            }
        }
    }

    /// Strains, thus energies, are the same in every frame.
    #[test]
    fn frame_indifference(a in disturbance(0.25), turn in disturbance(2.0)) {
        let rotation = nalgebra::Rotation3::new(nalgebra::Vector3::new(turn[0], turn[1], turn[2]));
        let beam = corner(2);
        let moved = |q: &[f64], direction: &dyn Fn(usize) -> bool| -> Vec<f64> {
            q.chunks(3).enumerate().flat_map(|(v, x)| {
                let y = rotation * nalgebra::Vector3::new(x[0], x[1], x[2]);
                let shift = if direction(v) { 0.0 } else { 1.0 };
                [y.x + shift * turn[3], y.y + shift * turn[4], y.z + shift * turn[5]]
            }).collect()
        };
        let q = disturbed(&flat(&beam.reference()), &a);
        let here = beam.section_forces(&q);
        let there = beam.section_forces(&moved(&q, &|v| beam.is_direction(v as u32)));
        for (x, y) in here.iter().zip(&there) {
            for k in 0..3 {
                prop_assert!((x.force[k] - y.force[k]).abs() < 1e-12 * 50.0 && (x.moment[k] - y.moment[k]).abs() < 1e-12 * 50.0);
            }
        }
        // A section turns with its frame.
        let turned = beam.rotation(1, &moved(&flat(&beam.reference()), &|v| beam.is_direction(v as u32)));
        for i in 0..3 {
            for j in 0..3 {
                prop_assert!((turned[i][j] - rotation[(i, j)]).abs() < 1e-13);
            }
        }
        let string = string(3, false);
        let q = disturbed(&flat(string.reference()), &a);
        let there = string.tensions(&moved(&q, &|_| false));
        for (x, y) in string.tensions(&q).iter().zip(&there) {
            prop_assert!((x - y).abs() < 1e-12);
        }
    }

    /// The solution knows nothing of the length of the directors: forces on positions are the same.
    #[test]
    fn length_of_directors_is_a_unit(a in disturbance(0.2), ratio in 0.05..20.0_f64) {
        let one = corner(2);
        let l = one.director_length();
        let other = Beam::with_director_length("other", 0, one.axis().clone(), section(), ratio * l).unwrap();
        let q = disturbed(&flat(&one.reference()), &a);
        let scaled: Vec<f64> = q.iter().enumerate().map(|(i, x)| if one.is_direction(i as u32 / 3) { ratio * x } else { *x }).collect();
        let (f, _) = assemble(&one, step(&q, &q, ForceRule::END_POINT));
        let (g, _) = assemble(&other, step(&scaled, &scaled, ForceRule::END_POINT));
        for i in 0..f.len() {
            let factor = if one.is_direction(i as u32 / 3) { ratio } else { 1.0 };
            prop_assert!((f[i] - factor * g[i]).abs() < 1e-11 * 50.0);
        }
    }

    /// The damper takes `d (l_1 - l_0)^2 / dt` out of a step, under every rule, without resultant.
    #[test]
    fn loss_of_dampers(a in disturbance(0.4), b in disturbance(0.4)) {
        let data = SpringData { damping: 0.7, ..SpringData::default() };
        let damper = Spring::new("damper", [Embedded::vector(0), Embedded::vector(1)], data).unwrap();
        let reference = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let (q_n, q_np1) = (disturbed(&reference, &a), disturbed(&reference, &b));
        let change = damper.length(&q_np1) - damper.length(&q_n);
        for rule in RULES {
            let now = step(&q_n, &q_np1, rule);
            let (force, tangent) = assemble(&damper, now);
            let work: f64 = force.iter().zip(q_n.iter().zip(&q_np1)).map(|(f, (a, b))| f * (b - a)).sum();
            let loss = 0.7 * change * change / 0.1;
            prop_assert!((work - loss).abs() < 1e-13 * 10.0 && (damper.work(&now).unwrap().dissipated - loss).abs() < 1e-13 * 10.0);
            for column in 0..6 {
                let at = |h: f64| {
                    let mut q = q_np1.clone();
                    q[column] += h;
                    assemble(&damper, step(&q_n, &q, rule)).0
                };
                let (up, down) = (at(1e-5), at(-1e-5));
                for row in 0..6 {
                    prop_assert!(((up[row] - down[row]) / 2e-5 - tangent[row][column]).abs() < 1e-6 * 10.0);
                }
            }
        }
        let without = At { rates: false, ..step(&q_n, &q_np1, ForceRule::DiscreteGradient) };
        prop_assert!(assemble(&damper, without).0.iter().all(|f| *f == 0.0) && damper.work(&without).unwrap().dissipated == 0.0);
    }
}

/// Total mass, and the Euler tensor of a straight beam about its centre: `m L^2 / 12` along the axis, `rho I_k L` across.
#[test]
fn masses() {
    for order in 1..=3 {
        let axis = BeamAxis::straight([1.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 1.0, 0.0], 4, order).unwrap();
        let beam = Beam::new("beam", 0, axis, section()).unwrap();
        let q = beam.reference();
        let mut euler = [[0.0; 3]; 3];
        let mut total = 0.0;
        beam.mass(&mut |i, j, m| {
            let (a, b) = (q[i as usize], q[j as usize]);
            let arm = |v: u32, x: [f64; 3]| if beam.is_direction(v) { x } else { [x[0] - 2.5, x[1], x[2]] };
            let (a, b) = (arm(i, a), arm(j, b));
            let twice = if i == j { 1.0 } else { 2.0 };
            for r in 0..3 {
                for c in 0..3 {
                    euler[r][c] += 0.5 * twice * m * (a[r] * b[c] + a[c] * b[r]);
                }
            }
            if !beam.is_direction(i) {
                total += twice * m;
            }
        });
        let mass = 2.0 * 0.28 * 3.0;
        assert!((total - mass).abs() < 1e-14 * 10.0);
        // d_1 = y has side 0.4, d_2 = d_3 x d_1 = z side 0.7.
        let exact = [mass * 9.0 / 12.0, mass * 0.16 / 12.0, mass * 0.49 / 12.0];
        for r in 0..3 {
            for c in 0..3 {
                assert!((euler[r][c] - if r == c { exact[r] } else { 0.0 }).abs() < 1e-13, "{order} {euler:?}");
            }
        }
        let weight = sum_of_weights(&string(order, true));
        let string = string(order, true);
        // Natural length is the initial one over the stretch 1.05.
        let length = (4.0_f64 + 0.09 + 0.16).sqrt() / 1.05;
        assert!((string.natural_length() - length).abs() < 1e-14);
        assert!((weight + 9.81 * 1.4 * length).abs() < 1e-12);
    }
    let point = PointMass::new("point", 0, 2.5, 1.0).unwrap();
    assert!((sum_of_weights(&point) + 9.81 * 2.5).abs() < 1e-14);
    assert!(PointMass::new("point", 0, -1.0, 1.0).is_err());
}

fn sum_of_weights(part: &dyn Term) -> f64 {
    let mut sum = 0.0;
    part.weight([0.0, 0.0, -9.81], &mut |_, f| sum += f[2]);
    sum
}

/// The mass at a corner is that of both pieces, each about its own axis.
#[test]
fn mass_of_a_corner() {
    let material = SectionMaterial { density: 2.0, ..MATERIAL };
    let section = Section::rectangle([0.4, 0.7], material, 1.0, None).unwrap();
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]];
    let axis = BeamAxis::polyline(&points, [0.0, 0.0, 1.0], &[1, 1], 1).unwrap();
    let beam = Beam::new("corner", 0, axis, section).unwrap();
    let q = beam.reference();
    let mut spread = [0.0; 3];
    beam.mass(&mut |i, j, m| {
        if beam.is_direction(i) {
            let twice = if i == j { 1.0 } else { 2.0 };
            (0..3).for_each(|d| spread[d] += twice * m * q[i as usize][d] * q[j as usize][d]);
        }
    });
    // d_1 = z everywhere; d_2 = d_3 x d_1 = -y in the first piece (length 1), x in the second (length 2).
    let [first, second] = section.rotary;
    for (found, exact) in spread.iter().zip([2.0 * second, second, 3.0 * first]) {
        assert!((found - exact).abs() < 1e-14, "{spread:?}");
    }
}

/// Curved and cornered axes are free of stress, and stay so in rigid motion.
#[test]
fn initial_shapes_are_free_of_stress() {
    for order in 1..=3 {
        let arc = BeamAxis::arc([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 1.2, 3, order).unwrap();
        let end = arc.positions()[3 * order];
        assert!((end[0] - 1.2_f64.cos()).abs() < 1e-15 && (end[1] - 1.2_f64.sin()).abs() < 1e-15);
        let tangent = arc.triads()[3 * order][2];
        assert!((tangent[0] + 1.2_f64.sin()).abs() < 1e-15 && (tangent[1] - 1.2_f64.cos()).abs() < 1e-15);
        let beam = Beam::new("arc", 0, arc, section()).unwrap();
        for beam in [beam, corner(order)] {
            let q = flat(&beam.reference());
            assert_eq!(beam.energy(&q).unwrap(), 0.0);
            assert!(assemble(&beam, step(&q, &q, ForceRule::END_POINT)).0.iter().all(|f| *f == 0.0));
        }
    }
}

/// The lever of the thesis (appendix E): 1.15 m at 20 degrees in ten quadratic elements; its hinge is its node 16, the counterweight hangs at node 20.
#[test]
fn nodes_of_the_lever() {
    let (s, c) = 20.0_f64.to_radians().sin_cos();
    let (e, end) = ([0.0745, 0.0, 0.335], [0.0745 + 1.15 * c, 0.0, 0.335 + 1.15 * s]);
    let axis = BeamAxis::straight(e, end, [0.0, 1.0, 0.0], 10, 2).unwrap();
    let lever = Beam::new("lever", 0, axis, section()).unwrap();
    assert_eq!((lever.node_count(), lever.node_vectors(20)), (21, [80, 81, 82, 83]));
    assert!((lever.length() - 1.15).abs() < 1e-14);
    let (hinge, hook) = ([0.885, 0.0, 0.63], [1.1011, 0.0, 0.7087]);
    assert_eq!([lever.nearest_node(hinge), lever.nearest_node(hook), lever.nearest_node(e)], [15, 19, 0]);
    let q = flat(&lever.reference());
    for (node, x) in [(15, hinge), (19, hook)] {
        let near = lever.axis().positions()[node];
        assert!((0..3).all(|i| (near[i] - x[i]).abs() < 1e-4));
        // A point of the section is where it was, and so are directions.
        let (at, direction) = (lever.point(node, x).at(&q), lever.direction(node, [0.3, -0.2, 0.5]).at(&q));
        assert!((0..3).all(|i| (at[i] - x[i]).abs() < 1e-15 && (direction[i] - [0.3, -0.2, 0.5][i]).abs() < 1e-15));
    }
    // d_1 = e_y, d_3 along the lever, d_2 = d_3 x d_1.
    for (k, d) in [[0.0, 1.0, 0.0], [-s, 0.0, c], [c, 0.0, s]].iter().enumerate() {
        let found = lever.director(15, k).at(&q);
        assert!((0..3).all(|i| (found[i] - d[i]).abs() < 1e-15));
    }
}

/// What has no energy is an error, what has no force is none.
#[test]
fn no_length() {
    let string = string(1, false);
    let q = vec![1.0; 9];
    assert!(string.energy(&q).is_err());
    assert!(string.assemble(&step(&q, &q, ForceRule::DiscreteGradient), true, &mut |_| {}).is_err());
    let ends = [Embedded::vector(0), Embedded::ground([1.0; 3])];
    let of = |data| Spring::new("spring", ends.clone(), data).unwrap();
    let q = [1.0; 3];
    let now = step(&q, &q, ForceRule::DiscreteGradient);
    let stiff = SpringData { stiffness: 2.0, rest_length: 0.5, ..SpringData::default() };
    assert!(of(stiff).assemble(&now, true, &mut |_| {}).is_err());
    for data in [SpringData { tension_only: true, ..stiff }, SpringData { rest_length: 0.0, damping: 1.0, ..stiff }] {
        let (force, tangent) = assemble(&of(data), now);
        assert!(force.iter().all(|f| *f == 0.0) && tangent.iter().flatten().all(|k| k.is_finite()));
    }
    // From nothing to a length the mean force has a direction.
    let away = [2.0, 1.0, 1.0];
    let (force, _) = assemble(&of(stiff), step(&q, &away, ForceRule::DiscreteGradient));
    assert!((force[0] - (of(stiff).energy(&away).unwrap() - of(stiff).energy(&q).unwrap())).abs() < 1e-15);
}

/// Data that make no part.
#[test]
fn errors() {
    let up = [0.0, 0.0, 1.0];
    let end = [1.0, 0.0, 0.0];
    assert!(BeamAxis::straight([0.0; 3], end, up, 0, 2).is_err());
    assert!(BeamAxis::straight([0.0; 3], end, up, 2, 4).is_err());
    assert!(BeamAxis::straight([0.0; 3], end, up, 2, 0).is_err());
    assert!(BeamAxis::straight([0.0; 3], end, end, 2, 2).is_err());
    assert!(BeamAxis::straight(end, end, up, 2, 2).is_err());
    assert!(BeamAxis::straight([0.0; 3], [f64::NAN; 3], up, 2, 2).is_err());
    assert!(BeamAxis::arc([0.0; 3], up, up, 1.0, 2, 2).is_err());
    assert!(BeamAxis::polyline(&[[0.0; 3], end, up], up, &[1], 2).is_err());
    let triad = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let left = [triad[1], triad[0], triad[2]];
    assert!(BeamAxis::new(1, vec![[0.0; 3], up], vec![triad; 2]).is_ok());
    assert!(BeamAxis::new(1, vec![[0.0; 3], up], vec![left; 2]).is_err());
    assert!(BeamAxis::new(1, vec![[0.0; 3], up], vec![triad]).is_err());
    // The middle node beyond the end: the element is folded.
    assert!(BeamAxis::new(2, vec![[0.0; 3], [0.0, 0.0, 2.0], up], vec![triad; 3]).is_err());
    let material = StringMaterial { stiffness: 1.0, mass: 1.0, lumped: false, tension_only: false };
    assert!(ElasticString::new("s", 0, 1, vec![[0.0; 3], [0.0; 3]], material, 1.0).is_err());
    assert!(ElasticString::new("s", 0, 1, vec![[0.0; 3], up], material, 0.0).is_err());
    assert!(
        Spring::new(
            "s",
            [Embedded::ground(up), Embedded::vector(0)],
            SpringData { damping: -1.0, ..SpringData::default() }
        )
        .is_err()
    );
}
