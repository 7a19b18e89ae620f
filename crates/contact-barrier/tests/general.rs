//! The sum over a skin: work, momenta, tangents, uniform pressure, motions that are stopped.

use fastrand::Rng;
use nalgebra::Vector3;
use std::sync::Arc;
use stoss_contact::friction::{Coulomb, FrictionLaw};
use stoss_contact_barrier::{
    GeneralContact, GeneralOptions, Interaction, Interactions, Skin, SkinFacet, check_initial, mitre,
};
use stoss_geometry::{PairKind, closest};
use stoss_reference_element::FacetNodes;
use stoss_term::check::sharing;
use stoss_term::{At, GradientRule, Local, Potential, StepConfiguration, StepContext, Term, Work};

const MODULUS: f64 = 3.0;

/// Facets of a block with so many cells a side, outward, and positions of its nodes; numbers of nodes begin at `first`.
fn block(first: u32, min: [f64; 3], max: [f64; 3], n: u32, class: u32) -> (Vec<SkinFacet>, Vec<f64>) {
    let node = |i: [u32; 3]| first + i[0] + (n + 1) * (i[1] + (n + 1) * i[2]);
    let mut positions = Vec::new();
    for k in 0..=n {
        for j in 0..=n {
            for i in 0..=n {
                let at = [i, j, k];
                positions.extend((0..3).map(|d| min[d] + (max[d] - min[d]) * f64::from(at[d]) / f64::from(n)));
            }
        }
    }
    let mut facets = Vec::new();
    for axis in 0..3 {
        for side in [0, n] {
            for a in 0..n {
                for b in 0..n {
                    let at = |da: u32, db: u32| {
                        let mut i = [0; 3];
                        (i[axis], i[(axis + 1) % 3], i[(axis + 2) % 3]) = (side, a + da, b + db);
                        node(i)
                    };
                    let mut corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                    if side == 0 {
                        corners.reverse();
                    }
                    facets.push(SkinFacet { nodes: FacetNodes::from(corners), class });
                }
            }
        }
    }
    (facets, positions)
}

struct Scene {
    contact: GeneralContact,
    reference: Vec<f64>,
    /// Nodes of the body above.
    upper: std::ops::Range<usize>,
}

impl Scene {
    /// A step by which the upper body comes down out of reach to `q`, where contacts are in their layers then.
    fn enter(&mut self, rule: GradientRule, q: &[f64]) {
        enter(&mut self.contact, &self.upper, rule, q);
    }
}

fn enter(contact: &mut GeneralContact, upper: &std::ops::Range<usize>, rule: GradientRule, q: &[f64]) {
    let lifted: Vec<f64> =
        q.iter().enumerate().map(|(k, x)| if k % 3 == 2 && upper.contains(&(k / 3)) { x + 0.15 } else { *x }).collect();
    match rule {
        GradientRule::EndPoint => contact.begin(&StepContext::quasi_static(&lifted, 1.0)).unwrap(),
        _ => begin(contact, rule, &lifted, q),
    }
    contact.renew(&At::end(q, &[], &[]), true).unwrap();
    contact.commit(&At::end(q, &[], &[]));
}

fn rules(mu: f64) -> Interactions {
    let law = || -> Arc<dyn FrictionLaw> { Arc::new(Coulomb::new(mu).unwrap()) };
    let mut rules = Interactions::none(&[(0, 1.0), (1, 1.0)]);
    for (a, b) in [(0, 0), (0, 1), (1, 1)] {
        rules.set(a, b, Some(Interaction { modulus: MODULUS, friction: (mu > 0.0).then(law) }));
    }
    rules
}

/// Two blocks above each other with a gap, `shift` sideways.
fn two(n: [u32; 2], gap: f64, shift: [f64; 2], thickness: f64, damping: f64, friction: f64) -> Scene {
    two_with(n, gap, shift, GeneralOptions { thickness, damping, slip_velocity: None }, friction)
}

fn two_with(n: [u32; 2], gap: f64, shift: [f64; 2], options: GeneralOptions, friction: f64) -> Scene {
    let (mut facets, mut reference) = block(0, [-0.5, -0.5, -1.0], [0.5, 0.5, 0.0], n[0], 0);
    let first = reference.len() as u32 / 3;
    let [x, y] = shift;
    let (more, positions) = block(first, [x - 0.5, y - 0.5, gap], [x + 0.5, y + 0.5, 1.0 + gap], n[1], 1);
    facets.extend(more);
    reference.extend(positions);
    let skin = Skin::new(facets, &reference, &|_| None);
    let upper = first as usize..reference.len() / 3;
    Scene { contact: GeneralContact::new("general", skin, rules(friction), options).unwrap(), reference, upper }
}

/// Residual and tangent of a step, dense.
fn assemble(contact: &mut GeneralContact, rule: GradientRule, q_n: &[f64], q: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    contact.renew(&At::end(q, &[], &[]), true).unwrap();
    let n = q.len();
    let (mut residual, mut tangent) = (vec![0.0; n], vec![vec![0.0; n]; n]);
    let mut stencils = Vec::new();
    contact.stencils(&[], &mut |nodes, _| stencils.push(nodes.to_vec()));
    let mut next = 0;
    let step = StepConfiguration { q_n, q_np1: q, rule };
    contact
        .assemble(&step.at(&[], &[]), true, &mut |local: &Local| {
            assert_eq!(local.nodes, stencils[next]);
            next += 1;
            let global: Vec<usize> =
                local.nodes.iter().flat_map(|&node| (0..3).map(move |c| 3 * node as usize + c)).collect();
            for (r, &row) in global.iter().enumerate() {
                residual[row] += local.residual[r];
                for (c, &column) in global.iter().enumerate() {
                    tangent[row][column] += local.tangent[r * global.len() + c];
                }
            }
        })
        .unwrap();
    assert_eq!(next, stencils.len());
    (residual, tangent)
}

fn begin(contact: &mut GeneralContact, rule: GradientRule, q_n: &[f64], q: &[f64]) {
    let step_size = 0.5;
    let velocity: Vec<f64> = q.iter().zip(q_n).map(|(q, q_n)| (q - q_n) / step_size).collect();
    contact.begin(&StepContext { v_n: &velocity, ..StepContext::new(q_n, rule, step_size) }).unwrap();
}

fn noise(random: &mut Rng, q: &[f64], size: f64) -> Vec<f64> {
    q.iter().map(|x| x + size * (2.0 * random.f64() - 1.0)).collect()
}

fn vector(v: &[f64], node: usize) -> Vector3<f64> {
    Vector3::from_column_slice(&v[3 * node..3 * node + 3])
}

#[test]
fn work_is_the_change_of_energy_less_what_is_lost_and_momenta_stay() {
    let mut random = Rng::with_seed(3);
    for case in 0..60 {
        let (damping, friction) = ([0.0, 0.3][case % 2], [0.0, 0.4][case / 2 % 2]);
        let shift = [random.f64() * 0.9, random.f64() * 0.4];
        let slip_velocity = [None, Some(0.05)][case / 4 % 2];
        let options = GeneralOptions { thickness: 0.08, damping, slip_velocity };
        let mut scene = two_with([2, 3], 0.04, shift, options, friction);
        let size = [1e-3, 1e-2, 1.5e-2][case % 3];
        let (q_n, q) = (noise(&mut random, &scene.reference, size), noise(&mut random, &scene.reference, size));
        scene.enter(GradientRule::DiscreteGradient, &q_n);
        let contact = &mut scene.contact;
        let Work { stored: before, friction_stored: springs, .. } = contact.work(&At::end(&q_n, &[], &[])).unwrap();
        begin(contact, GradientRule::DiscreteGradient, &q_n, &q);
        let (residual, _) = assemble(contact, GradientRule::DiscreteGradient, &q_n, &q);
        let work = contact.work(&At::end(&q, &[], &[])).unwrap();
        let of_layer = work.stored - work.friction_stored;
        assert!((of_layer - contact.energy(&q).unwrap()).abs() <= 1e-13 * work.stored);
        assert!((before - springs - contact.energy(&q_n).unwrap()).abs() <= 1e-13 * before);
        assert_eq!(springs > 0.0 && work.friction_stored > 0.0, friction > 0.0 && slip_velocity.is_none());
        assert!(before > 0.0 && work.stored > 0.0 && work.dissipated >= 0.0);
        // What creeps only loses; a spring may give back.
        match slip_velocity {
            Some(_) => assert_eq!(work.friction_work > 0.0, friction > 0.0),
            None => assert_eq!(work.friction_work != 0.0, friction > 0.0),
        }
        let done: f64 = residual.iter().zip(&q).zip(&q_n).map(|((g, q), q_n)| g * (q - q_n)).sum();
        let scale: f64 = residual.iter().zip(&q).zip(&q_n).map(|((g, q), q_n)| (g * (q - q_n)).abs()).sum();
        let balance = done - (work.stored - before) - work.dissipated;
        assert!(balance.abs() <= 1e-12 * (scale + before + work.stored), "{case}: {balance:e}");
        let (mut force, mut moment, mut terms) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        for node in 0..q.len() / 3 {
            let (g, middle) = (vector(&residual, node), (vector(&q, node) + vector(&q_n, node)) * 0.5);
            force += g;
            moment += middle.cross(&g);
            terms += g.norm();
        }
        assert!(force.norm() <= 1e-13 * terms && moment.norm() <= 1e-12 * terms, "{case}: {force} {moment}");
    }
}

#[test]
fn tangents_are_derivatives() {
    let mut random = Rng::with_seed(4);
    for (rule, friction, slip_velocity) in [
        (GradientRule::DiscreteGradient, 0.0, None),
        (GradientRule::DiscreteGradient, 0.3, None),
        (GradientRule::DiscreteGradient, 0.3, Some(0.05)),
        (GradientRule::EndPoint, 0.0, None),
        (GradientRule::EndPoint, 0.3, None),
        (GradientRule::EndPoint, 0.3, Some(0.05)),
    ] {
        let options = GeneralOptions { thickness: 0.1, damping: 0.1, slip_velocity };
        let mut scene = two_with([1, 1], 0.05, [0.13, 0.21], options, friction);
        let (q_n, q) = (noise(&mut random, &scene.reference, 0.01), noise(&mut random, &scene.reference, 0.01));
        scene.enter(rule, &q_n);
        let contact = &mut scene.contact;
        begin(contact, rule, &q_n, &q);
        let (_, tangent) = assemble(contact, rule, &q_n, &q);
        let scale = tangent.iter().flatten().fold(0.0_f64, |m, t| m.max(t.abs()));
        assert!(scale > 0.0);
        let (mut worst, step) = (0.0_f64, 1e-7);
        for column in 0..q.len() {
            let mut moved = |s: f64| {
                let mut x = q.clone();
                x[column] += s;
                assemble(contact, rule, &q_n, &x).0
            };
            let (ahead, behind) = (moved(step), moved(-step));
            for row in 0..q.len() {
                let difference = (ahead[row] - behind[row]) / (2.0 * step);
                worst = worst.max((difference - tangent[row][column]).abs() / scale);
            }
        }
        assert!(worst < 2e-5, "{rule:?} friction {friction}: {worst:e}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut scene = two([5, 7], 0.05, [0.13, 0.21], 0.1, 0.1, 0.3);
    let q = noise(&mut Rng::with_seed(8), &scene.reference, 0.01);
    scene.enter(GradientRule::DiscreteGradient, &q);
    let contact = &mut scene.contact;
    begin(contact, GradientRule::DiscreteGradient, &q, &scene.reference);
    let mut on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| assemble(contact, GradientRule::DiscreteGradient, &q, &scene.reference))
    };
    let alone = on(1);
    assert!(alone.0.iter().any(|r| *r != 0.0));
    assert!(alone == on(2) && alone == on(3));
}

#[test]
fn contributions_are_dealt_out_among_ranks() {
    let mut random = Rng::with_seed(9);
    for rule in [GradientRule::DiscreteGradient, GradientRule::EndPoint] {
        let mut scene = two([2, 3], 0.05, [0.13, 0.21], 0.1, 0.1, 0.3);
        let (q_n, q) = (noise(&mut random, &scene.reference, 0.01), noise(&mut random, &scene.reference, 0.01));
        scene.enter(rule, &q_n);
        let contact = &mut scene.contact;
        begin(contact, rule, &q_n, &q);
        for ranks in [1, 2, 3, 7] {
            let at = StepConfiguration { q_n: &q_n, q_np1: &q, rule }.at(&[], &[]);
            let found = sharing(contact, &at, ranks).unwrap();
            assert!(found.is_whole && found.counts.iter().sum::<usize>() > 20, "{ranks}: {found:?}");
            assert!(ranks > 2 || found.counts.iter().all(|&count| count > 0), "{ranks}: {found:?}");
        }
    }
}

/// Along a motion, friction with the normal forces of its start is the gradient of an energy: at the start energy and friction change together by the work of the forces, and friction is convex.
#[test]
fn friction_along_a_motion_has_an_energy() {
    let mut random = Rng::with_seed(9);
    for case in 0..20 {
        let friction = [0.3, 1.0][case % 2];
        let mut scene = two([2, 3], 0.04, [random.f64() * 0.9, random.f64() * 0.4], 0.08, 0.0, friction);
        // From all in stick to all in slip.
        let size = [1e-4, 1e-3, 1e-2][case % 3];
        let (q_n, q) = (scene.reference.clone(), noise(&mut random, &scene.reference, size));
        scene.enter(GradientRule::EndPoint, &q_n);
        let contact = &mut scene.contact;
        contact.begin(&StepContext::quasi_static(&q_n, 1.0)).unwrap();
        let (residual, _) = assemble(contact, GradientRule::EndPoint, &q_n, &q);
        let increment = noise(&mut random, &vec![0.0; q.len()], size);
        contact.set_line(&increment);
        let step = 1e-4;
        let energy_at = |part: f64| {
            let x: Vec<f64> = q.iter().zip(&increment).map(|(q, d)| q + part * d).collect();
            contact.energy(&x).unwrap()
        };
        let by_barrier = (energy_at(step) - energy_at(-step)) / (2.0 * step);
        let line = |part: f64| contact.friction_along(part);
        let by_friction = (line(step) - line(-step)) / (2.0 * step);
        let done: f64 = residual.iter().zip(&increment).map(|(r, d)| r * d).sum();
        let scale: f64 = residual.iter().zip(&increment).map(|(r, d)| (r * d).abs()).sum();
        assert!((by_barrier + by_friction - done).abs() < 1e-5 * scale, "{case}: {by_barrier} {by_friction} {done}");
        assert!(by_friction.abs() > 1e-5 * scale, "{case}: {by_friction} of {scale}");
        let parts: Vec<f64> = (0..20).map(|k| line(0.1 * f64::from(k))).collect();
        assert!(parts.windows(3).all(|w| w[0] + w[2] >= 2.0 * w[1] * (1.0 - 1e-12)), "{case}");
    }
    let mut scene = two([1, 1], 0.05, [0.1, 0.2], 0.1, 0.0, 0.0);
    scene.contact.set_line(&scene.reference.clone());
    assert_eq!(scene.contact.friction_along(1.0), 0.0);
}

/// Matching meshes at half of the thickness: points of integration alone give the forces of a uniform pressure; with the guards they are larger by what
/// these add, the most at the corners.
#[test]
fn a_layer_between_matching_meshes_has_a_uniform_pressure() {
    for n in [2, 3] {
        let thickness = 0.02;
        let mut scene = two([n, n], 0.5 * thickness, [0.0; 2], thickness, 0.0, 0.0);
        let q = scene.reference.clone();
        scene.enter(GradientRule::EndPoint, &q);
        begin(&mut scene.contact, GradientRule::EndPoint, &q, &q);
        let (residual, _) = assemble(&mut scene.contact, GradientRule::EndPoint, &q, &q);
        // y = 1/2: kappa/2 (1 - y^2) / y^2.
        let pressure = MODULUS * 0.5 * 0.75 / 0.25;
        let skin = scene.contact.skin();
        let mut ratios = (f64::INFINITY, 0.0_f64);
        let top: Vec<usize> = (0..q.len() / 3).filter(|&node| q[3 * node + 2].abs() < 1e-12).collect();
        let lower = top.iter().filter(|&&node| node < (n as usize + 1).pow(3));
        let spacing = 1.0 / f64::from(n);
        for &node in lower {
            let half = |x: f64| if (x.abs() - 0.5).abs() < 1e-9 { 0.5 } else { 1.0 };
            let area = spacing * spacing * half(q[3 * node]) * half(q[3 * node + 1]);
            let ratio = residual[3 * node + 2] / (pressure * area);
            ratios = (ratios.0.min(ratio), ratios.1.max(ratio));
        }
        assert!(ratios.0 > 1.0 && ratios.1 < 1.55, "{n}: {ratios:?}");
        // Points of integration alone, by the distances and the derivative of the energy: exactly uniform.
        let x: Vec<Vector3<f64>> = (0..skin.point_count() as u32).map(|p| skin.at(p, &q)).collect();
        let layer = stoss_contact_barrier::Layer::new(MODULUS, thickness);
        let mut force = vec![0.0; q.len() / 3];
        for p in skin.vertex_count() as u32..skin.point_count() as u32 {
            // Three points in each triangle; those of side walls do not face the other body.
            let own = skin.triangles()[(p as usize - skin.vertex_count()) / 3].map(|v| x[v as usize]);
            if (own[1] - own[0]).cross(&(own[2] - own[0])).normalize().z.abs() < 0.5 {
                continue;
            }
            let pairs = skin.triangles().iter().enumerate().map(|(t, triangle)| {
                let points = [p, triangle[0], triangle[1], triangle[2]];
                (t as u32, points, closest(PairKind::VertexTriangle, &points.map(|p| x[p as usize])))
            });
            // One plane is one patch: the nearest of its triangles.
            let others =
                pairs.filter(|(t, _, pair)| !skin.is_adjacent(p, *t) && layer.is_inside(pair.distance_squared));
            let nearest = others.min_by(|a, b| a.2.distance_squared.total_cmp(&b.2.distance_squared));
            let Some((t, points, pair)) = nearest else { continue };
            let r: Vector3<f64> = points.iter().zip(pair.weights).map(|(&p, c)| x[p as usize] * c).sum();
            let [_, slope, _] = layer.evaluate(pair.distance_squared);
            let weight = skin.point_weight(p, t, [1, 2, 3].map(|i| -pair.weights[i]), 0.5, [0.0; 2]);
            for (&point, c) in points.iter().zip(pair.weights) {
                for &(node, w) in skin.terms(point) {
                    force[node as usize] += weight * slope * 2.0 * c * r[2] * w;
                }
            }
        }
        for &node in top.iter().filter(|&&node| node < (n as usize + 1).pow(3)) {
            let half = |x: f64| if (x.abs() - 0.5).abs() < 1e-9 { 0.5 } else { 1.0 };
            let area = spacing * spacing * half(q[3 * node]) * half(q[3 * node + 1]);
            assert!((force[node] / (pressure * area) - 1.0).abs() < 1e-12, "{n}: {}", force[node] / (pressure * area));
        }
    }
}

#[test]
fn motions_are_stopped_before_surfaces_meet() {
    let mut random = Rng::with_seed(5);
    let mut stopped = 0;
    for case in 0..24 {
        let mut scene = two([2, 2], 0.05, [random.f64() * 1.2, random.f64()], 0.02, 0.0, 0.0);
        let mut q = noise(&mut random, &scene.reference, 0.005);
        begin(&mut scene.contact, GradientRule::DiscreteGradient, &q.clone(), &q);
        for _ in 0..5 {
            let size = [0.02, 0.1, 0.3][case % 3];
            let direction: Vec<f64> = q.iter().map(|_| size * (2.0 * random.f64() - 1.0)).collect();
            let part = scene.contact.longest_step(&q, &direction);
            assert!(part > 0.0 && part <= 1.0);
            stopped += usize::from(part < 1.0);
            q.iter_mut().zip(&direction).for_each(|(q, d)| *q += part * d);
            let look = check_initial(scene.contact.skin(), &rules(0.0), &q, 0.05);
            assert!(look.crossings.is_empty(), "{case}: {:?}", look.crossings.first());
            assert!(look.nearest.values().all(|nearest| nearest.distance > 0.0));
        }
    }
    assert!(stopped > 40, "{stopped}");
}

/// What acted at the iterate that was seen last is told of, with the same numbers, after a motion far away has made other pairs candidates: reports of a motion that is blocked are asked for then.
#[test]
fn what_acts_outlives_a_renewal_of_candidates() {
    let mut random = Rng::with_seed(12);
    for case in 0..40 {
        let (rule, friction) =
            ([GradientRule::DiscreteGradient, GradientRule::EndPoint][case % 2], [0.0, 0.3][case / 2 % 2]);
        let mut scene =
            two([1 + case as u32 % 3, 2], 0.05, [0.7 * random.f64(), 0.7 * random.f64()], 0.08, 0.1, friction);
        let q = noise(&mut random, &scene.reference, 0.01);
        let reference = scene.reference.clone();
        scene.enter(rule, &reference);
        let contact = &mut scene.contact;
        begin(contact, rule, &reference, &q);
        contact.renew(&At::end(&q, &[], &[]), true).unwrap();
        let reports = |contact: &GeneralContact| {
            let pressures: Vec<(u32, f64, [f64; 3])> =
                contact.surface_nodes(&q).iter().map(|node| (node.node, node.pressure, node.friction)).collect();
            // Nodes without pressure may have something near, or not.
            let pressures: Vec<_> = pressures.into_iter().filter(|(_, pressure, _)| *pressure != 0.0).collect();
            let work = contact.work(&At::end(&q, &[], &[])).unwrap();
            (
                contact.body_pairs(),
                contact.surface_forces(),
                pressures,
                [work.stored, work.dissipated, work.friction_work],
            )
        };
        let before = reports(contact);
        assert!(contact.acts() && before.0[0].active > 0, "{case}");
        // All of the upper body goes away, or the nodes in all directions.
        let size = [0.3, 3.0, 30.0][case % 3];
        let lower = 3 * (q.len() / 3 - 27);
        let wild = noise(&mut random, &vec![0.0; q.len()], size);
        let far: Vec<f64> = (0..q.len())
            .map(|k| {
                if case % 4 == 0 {
                    wild[k]
                } else if k < lower {
                    0.0
                } else {
                    size
                }
            })
            .collect();
        contact.longest_step(&q, &far);
        assert_eq!(reports(contact), before, "{case}");
    }
}

/// What acts at an iterate, and its energy, does not depend on the way on which the iteration came there, as which contacts begin is decided by the start of the step. Nor do forces at the end of the step; those
/// between two states do a little where contacts come into the layer: the place that was nearest before is one of the candidates.
#[test]
fn forces_do_not_depend_on_the_way_of_the_iteration() {
    let mut random = Rng::with_seed(6);
    for case in 0..20 {
        let thickness = 0.06;
        let (rule, friction) =
            ([GradientRule::DiscreteGradient, GradientRule::EndPoint][case % 2], [0.0, 0.3][case / 2 % 2]);
        let shift = [0.6 * random.f64(), 0.7 * random.f64()];
        let mut scenes = [(); 2].map(|()| two([2, 3], 0.05, shift, thickness, 0.0, friction));
        let q_n = noise(&mut random, &scenes[0].reference, 0.01);
        let far = random.f64() * 0.3;
        let q: Vec<f64> = (0..q_n.len()).map(|k| q_n[k] + if k % 3 == 0 && k >= 81 { far } else { 0.0 }).collect();
        let forces = [0, 1].map(|way| {
            let scene = &mut scenes[way];
            scene.enter(rule, &q_n);
            begin(&mut scene.contact, rule, &q_n, &q);
            if way == 1 {
                // Above it and beside it, there and back.
                for (size, axis) in [(0.3, 2), (0.2, 1), (0.1, 0)] {
                    let aside: Vec<f64> = (0..q.len())
                        .map(|k| if k % 3 == axis && k >= 81 { size } else { 0.002 * (random.f64() - 0.5) })
                        .collect();
                    let part = scene.contact.longest_step(&q_n, &aside);
                    let there: Vec<f64> = q_n.iter().zip(&aside).map(|(q, d)| q + part * d).collect();
                    scene.contact.renew(&At::end(&there, &[], &[]), true).unwrap();
                }
            }
            let forces = assemble(&mut scene.contact, rule, &q_n, &q).0;
            (forces, scene.contact.work(&At::end(&q, &[], &[])).unwrap().stored, scene.contact.body_pairs()[0].active)
        });
        let [(first, energy, count), (second, other_energy, other_count)] = forces;
        let largest = first.iter().fold(0.0_f64, |largest, f| largest.max(f.abs()));
        let apart = first.iter().zip(&second).fold(0.0_f64, |most, (f, g)| most.max((f - g).abs()));
        assert!(
            (energy - other_energy).abs() <= 1e-12 * energy && count == other_count,
            "{case} {energy:e} {other_energy:e} {count} {other_count}"
        );
        let bound = if rule == GradientRule::EndPoint { 1e-12 } else { 0.05 };
        assert!(largest > 0.0 && apart <= bound * largest, "{case}: {apart:e} of {largest:e}");
    }
}

/// Contacts in their layers are in checkpoints: a contact that goes on from one has the same bits. Without them there is no force, as what is found in the layer begins there.
#[test]
fn what_is_in_the_layer_goes_on_from_a_checkpoint() {
    let mut random = Rng::with_seed(8);
    for case in 0..8 {
        let (rule, friction) =
            ([GradientRule::DiscreteGradient, GradientRule::EndPoint][case % 2], [0.0, 0.3][case / 2 % 2]);
        let shift = [0.5 * random.f64(), 0.5 * random.f64()];
        let mut scenes = [(); 3].map(|()| two([2, 3], 0.05, shift, 0.08, 0.1, friction));
        let (q_n, q) = (noise(&mut random, &scenes[0].reference, 0.01), noise(&mut random, &scenes[0].reference, 0.01));
        scenes[0].enter(rule, &q_n);
        let history = scenes[0].contact.save_history();
        scenes[1].contact.load_history(&history).unwrap();
        assert_eq!(scenes[1].contact.save_history(), history);
        let [first, second, without] = &mut scenes;
        let of = |scene: &mut Scene| {
            begin(&mut scene.contact, rule, &q_n, &q);
            assemble(&mut scene.contact, rule, &q_n, &q)
        };
        let (first, second) = (of(first), of(second));
        assert!(first == second && first.0.iter().any(|force| *force != 0.0), "{case}");
        begin(&mut without.contact, rule, &q_n, &q_n);
        without.contact.renew(&At::end(&q_n, &[], &[]), true).unwrap();
        // The second power of round-off at the edge of the layer.
        assert!(without.contact.energy(&q_n).unwrap() < 1e-30, "{case}");
        // A contact that is switched on again begins with nothing.
        without.enter(rule, &q_n);
        without.contact.load_history(&[]).unwrap();
        assert!(without.contact.energy(&q_n).unwrap() == 0.0 && !without.contact.acts(), "{case}");
        for cut in [1, 7, history.len() - 1] {
            assert!(without.contact.load_history(&history[..cut]).is_err(), "{case} {cut}");
        }
    }
}

/// Blocks that touch: with vertices a half of the thickness inside there is neither force nor energy at the start.
#[test]
fn inset_surfaces_that_touch_have_no_force() {
    let thickness = 0.02;
    let scene = two([2, 3], 0.0, [0.3, 0.1], thickness, 0.0, 0.0);
    let corners = [[-0.5, -0.5, -1.0, 0.5, 0.5, 0.0], [-0.2, -0.4, 0.0, 0.8, 0.6, 1.0]];
    let reference = &scene.reference;
    let body = |node: u32| usize::from(node >= 27);
    // Places inside are affine in four nodes of a block: those at a corner and at the ends of its edges.
    let place = |node: u32| {
        let x = vector(reference, node as usize);
        let c = corners[body(node)];
        let mut normals = Vec::new();
        for d in 0..3 {
            for (side, sign) in [(c[d], -1.0), (c[d + 3], 1.0)] {
                if (x[d] - side).abs() < 1e-12 {
                    let mut n = Vector3::zeros();
                    n[d] = sign;
                    normals.push((n, 0.5 * thickness));
                }
            }
        }
        if normals.is_empty() {
            return None;
        }
        let at = x - mitre(&normals).unwrap();
        let (first, n) = if body(node) == 0 { (0, 2) } else { (27, 3) };
        let ends = [n, (n + 1) * n, (n + 1) * (n + 1) * n];
        let part: [f64; 3] = std::array::from_fn(|d| (at[d] - c[d]) / (c[d + 3] - c[d]));
        let mut terms = vec![(first, 1.0 - part.iter().sum::<f64>())];
        terms.extend((0..3).map(|d| (first + ends[d], part[d])));
        Some(terms)
    };
    let skin = Skin::new(scene.contact.skin().facets().to_vec(), reference, &place);
    let look = check_initial(&skin, &rules(0.0), reference, 2.0 * thickness);
    assert!((look.nearest[&[0, 1]].distance - thickness).abs() < 1e-12, "{:?}", look.nearest);
    let options = GeneralOptions { thickness: thickness * (1.0 - 1e-12), damping: 0.0, slip_velocity: None };
    let mut contact = GeneralContact::new("general", skin, rules(0.0), options).unwrap();
    contact.begin(&StepContext::quasi_static(reference, 1.0)).unwrap();
    contact.renew(&At::end(reference, &[], &[]), true).unwrap();
    assert!(!contact.acts() && contact.energy(reference).unwrap() == 0.0);
}

/// A small block over the middle of one side of a large one that is a single facet, a little off its diagonals.
fn on_large(n: u32, size: f64, gap: f64, thickness: f64) -> Scene {
    let (mut facets, mut reference) = block(0, [-0.37, -0.41, gap], [0.63, 0.59, 1.0 + gap], n, 0);
    let first = reference.len() as u32 / 3;
    let half = 0.5 * size;
    let (more, positions) = block(first, [-half, -half, -1.0], [half, half, 0.0], 1, 1);
    facets.extend(more);
    reference.extend(positions);
    let skin = Skin::new(facets, &reference, &|_| None);
    let options = GeneralOptions { thickness, damping: 0.0, slip_velocity: None };
    let upper = 0..first as usize;
    Scene { contact: GeneralContact::new("general", skin, rules(0.3), options).unwrap(), reference, upper }
}

/// Half of the thickness: kappa/2 (1 - y^2) / y^2.
const AT_HALF: f64 = MODULUS * 0.5 * 0.75 / 0.25;

/// Guards and points of integration of facets much larger than what they touch count no more than those of the small side: the pressure under a small block does not depend on the size of the facet that it lies on.
#[test]
fn a_large_facet_presses_like_a_small_one() {
    let (n, thickness) = (4, 0.01);
    for size in [2.0, 40.0, 1000.0] {
        let Scene { mut contact, reference: q, upper } = on_large(n, size, 0.5 * thickness, thickness);
        enter(&mut contact, &upper, GradientRule::EndPoint, &q);
        begin(&mut contact, GradientRule::EndPoint, &q, &q);
        let (residual, _) = assemble(&mut contact, GradientRule::EndPoint, &q, &q);
        let (mut sum, mut ratios) = (0.0, (f64::INFINITY, 0.0_f64));
        let (spacing, lowest) = (1.0 / f64::from(n), 0.5 * thickness);
        for node in (0..(n as usize + 1).pow(3)).filter(|&node| (q[3 * node + 2] - lowest).abs() < 1e-12) {
            let half = |x: f64, low: f64| if [low, low + 1.0].iter().any(|b| (x - b).abs() < 1e-9) { 0.5 } else { 1.0 };
            let area = spacing * spacing * half(q[3 * node], -0.37) * half(q[3 * node + 1], -0.41);
            let ratio = -residual[3 * node + 2] / (AT_HALF * area);
            ratios = (ratios.0.min(ratio), ratios.1.max(ratio));
            sum += ratio * area;
        }
        println!("{size}: {sum} {ratios:?}");
        // Points next to the diagonals act on both triangles there; nodes at corners have sides.
        assert!((sum - 1.0).abs() < 0.1, "{size}: {sum}");
        assert!(ratios.0 > 0.95 && ratios.1 < 1.6, "{size}: {ratios:?}");
        let [pair] = contact.body_pairs()[..] else { panic!("one pair") };
        assert!((pair.area - 1.0).abs() < 0.05, "{size}: {}", pair.area);
    }
}

/// Two thirds of a block over a plate with a mesh that does not match: pressures at its rim and its corners are those of the middle, as sides of the block that stand on the plate are not in contact.
#[test]
fn pressures_at_a_rim_are_those_of_the_middle() {
    let thickness = 0.01;
    for (n, m, part) in [(4, 8, 1.0), (4, 5, 1.0), (3, 8, 0.7)] {
        let (mut facets, mut q) = block(0, [-0.37, -0.41, 0.5 * thickness], [0.63, 0.59, 1.0], n, 0);
        let first = q.len() as u32 / 3;
        let (more, positions) = block(first, [-1.0, -1.0, -1.0], [1.0 * part, 1.0, 0.0], m, 1);
        facets.extend(more);
        q.extend(positions);
        let skin = Skin::new(facets, &q, &|_| None);
        let options = GeneralOptions { thickness, damping: 0.0, slip_velocity: None };
        let mut contact = GeneralContact::new("general", skin, rules(0.0), options).unwrap();
        enter(&mut contact, &(0..first as usize), GradientRule::EndPoint, &q);
        begin(&mut contact, GradientRule::EndPoint, &q, &q);
        contact.renew(&At::end(&q, &[], &[]), true).unwrap();
        let nodes = contact.surface_nodes(&q);
        let lower = nodes.iter().filter(|node| (q[3 * node.node as usize + 2] - 0.5 * thickness).abs() < 1e-12);
        let mut count = 0;
        for node in lower {
            let at = vector(&q, node.node as usize);
            let ratio = node.pressure / AT_HALF;
            // Points are near the nodes of both: what of the plate's cells is below the rim counts by their corners, so a node at a corner of the block has more or less than its share.
            assert!(ratio > 0.75 && ratio < 2.2, "{n} {m}: {ratio} at {at}");
            count += 1;
        }
        assert_eq!(count, (n + 1) * (n + 1), "{n} {m}");
    }
}

/// Without inertia a block that is dragged by the same way in more steps has the same friction; it is Coulomb's, and what it stores and what is lost are its work.
#[test]
fn static_friction_does_not_depend_on_the_number_of_steps() {
    let thickness = 0.02;
    for steps in [1, 40, 800] {
        let Scene { mut contact, reference, upper } = on_large(2, 8.0, 0.9 * thickness, thickness);
        enter(&mut contact, &upper, GradientRule::EndPoint, &reference);
        let mut q_n = reference.clone();
        let (mut lost, mut worked, mut stored) = (0.0, 0.0, 0.0);
        let mut forces = Vector3::zeros();
        let way = 0.3 * thickness;
        for _ in 0..steps {
            let q: Vec<f64> = (0..q_n.len())
                .map(|k| q_n[k] + if k < 81 && k % 3 == 0 { way / f64::from(steps) } else { 0.0 })
                .collect();
            // An attempt that is given up leaves nothing behind.
            contact.begin(&StepContext::quasi_static(&q_n, 1.0)).unwrap();
            let far: Vec<f64> =
                q_n.iter().enumerate().map(|(k, x)| if k < 81 && k % 3 == 1 { x + 0.1 } else { *x }).collect();
            contact.renew(&At::end(&far, &[], &[]), true).unwrap();
            contact.begin(&StepContext::quasi_static(&q_n, 1.0)).unwrap();
            contact.renew(&At::end(&q, &[], &[]), true).unwrap();
            let work = contact.work(&At::end(&q, &[], &[])).unwrap();
            lost += work.dissipated;
            worked += work.friction_work;
            stored = work.friction_stored;
            assert!(work.dissipated >= -1e-15 && work.stored > stored, "{work:?}");
            contact.commit(&At::end(&q, &[], &[]));
            let [pair] = contact.body_pairs()[..] else { panic!("one pair") };
            forces = Vector3::from(pair.force);
            // Goes on from a checkpoint with the same bits.
            let history = contact.save_history();
            contact.load_history(&history).unwrap();
            assert_eq!(contact.save_history(), history);
            q_n = q;
        }
        let ratio = -forces.x / forces.z;
        // All slide but the pairs of edges along the motion, which have faded, and a few of no pressure.
        assert!((ratio - 0.3).abs() < 0.005, "{steps}: {ratio}");
        assert!((worked - stored - lost).abs() <= 1e-12 * worked && stored > 0.0, "{steps}: {worked} {stored} {lost}");
        assert!(contact.load_history(&[0; 48]).is_err() && contact.load_history(&[9; 49]).is_err());
    }
}
