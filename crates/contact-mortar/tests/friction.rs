//! Friction of the contact method at random configurations: tangents, momenta, objectivity, energies, history.

use crate::sheets;

use crate::sheets::{
    NODES, SLAVE, SheetKind, assemble, base, factors, method, moved, options, pressures, resultants, surfaces, warp,
};
use nalgebra::{Rotation3, Unit, Vector3};
use proptest::prelude::*;
use std::sync::Arc;
use stoss_contact::friction::{Coulomb, Friction, FrictionLaw, Regularised, StaticDynamic, Stick, SurfaceVelocity};
use stoss_contact::{ContactError, position};
use stoss_contact_mortar::segmentation::GapRange;
use stoss_contact_mortar::{
    FaceBlock, Faces, Integrals, MortarContact, MortarOptions, MultiplierBasis, MultiplierSpace, SlipMeasure,
    facet_integrals, segment_surfaces,
};
use stoss_term::{At, Fault, GradientRule, Local, Share, StepConfiguration, StepContext, Term, Unilateral};

const RULES: [GradientRule; 3] = [GradientRule::EndPoint, GradientRule::Midpoint, GradientRule::DiscreteGradient];
const PENALTY: f64 = 40.0;

fn coulomb(mu: f64) -> Arc<dyn FrictionLaw> {
    Arc::new(Coulomb::new(mu).unwrap())
}

fn law(kind: usize) -> Arc<dyn FrictionLaw> {
    match kind {
        0 => coulomb(0.05),
        1 => coulomb(1e6),
        2 => Arc::new(StaticDynamic::new(0.06, 0.04, 0.5).unwrap()),
        _ => Arc::new(Regularised::new(0.3, 1.0).unwrap()),
    }
}

fn with(surfaces: [SheetKind; 2], law: Arc<dyn FrictionLaw>, dual: bool, measure: SlipMeasure) -> MortarContact {
    with_stick(surfaces, law, Stick::Penalty, dual, measure)
}

fn with_stick(
    surfaces: [SheetKind; 2],
    law: Arc<dyn FrictionLaw>,
    stick: Stick,
    dual: bool,
    measure: SlipMeasure,
) -> MortarContact {
    let friction = Friction::new(law, PENALTY, stick).unwrap();
    method(surfaces, options(dual)).with_friction(friction, measure).unwrap()
}

/// A master surface that moves along itself, across the surface too, and faster and faster.
fn belt(moves: bool) -> SurfaceVelocity {
    let rows = if moves { vec![(0.0, [0.7, -0.4, 0.3]), (1.0, [1.9, 0.2, -0.5])] } else { Vec::new() };
    SurfaceVelocity::new(rows)
}

fn plus(q: &[f64], factor: f64, d: &[f64]) -> Vec<f64> {
    q.iter().zip(d).map(|(x, d)| x + factor * d).collect()
}

fn lifted(d: &[f64], lift: f64) -> Vec<f64> {
    let mut q = moved(d);
    (0..SLAVE).for_each(|k| q[3 * k + 2] += lift);
    q
}

fn measure(objective: bool) -> SlipMeasure {
    if objective { SlipMeasure::Objective } else { SlipMeasure::Direct }
}

fn set(p: &[f64]) -> Vec<bool> {
    p.iter().map(|p| *p != 0.0).collect()
}

fn begin(method: &mut MortarContact, rule: GradientRule, q_n: &[f64]) {
    let rates = rule != GradientRule::EndPoint;
    method.begin(&StepContext { reach: 0.5, rates, ..StepContext::new(q_n, rule, 0.1) }).unwrap();
}

/// Does a whole step with given positions and pressures.
fn go(method: &mut MortarContact, rule: GradientRule, q_n: &[f64], q: &[f64], p: &[f64]) {
    begin(method, rule, q_n);
    method.renew(&At::end(q, &[], &set(p)), false).unwrap();
    method.commit(&At::end(q, p, &set(p)));
}

/// What friction adds to the residual of the step that has begun.
fn friction_force(
    surfaces: [SheetKind; 2],
    method: &mut MortarContact,
    rule: GradientRule,
    q_n: &[f64],
    q: &[f64],
    p: &[f64],
    dual: bool,
) -> Vec<f64> {
    let mut plain = sheets::method(surfaces, options(dual)).with_factors(method.factors());
    begin(&mut plain, rule, q_n);
    let residual = |m: &mut MortarContact| {
        m.renew(&At::end(q, &[], &set(p)), true).unwrap();
        assemble(m, StepConfiguration { q_n, q_np1: q, rule }, p, &set(p)).residual
    };
    let without = residual(&mut plain);
    residual(method).iter().zip(without).map(|(a, b)| a - b).take(3 * NODES).collect()
}

/// Gap vector and covered area of a slave node at positions `q`, over the segments of the whole surfaces.
fn weighted_gap(
    method: &MortarContact,
    surfaces: [SheetKind; 2],
    q: &[f64],
    node: usize,
    dual: bool,
) -> (Vector3<f64>, f64) {
    let (slave, master) = (method.slave(), method.master());
    let space = if dual { MultiplierSpace::Centred } else { MultiplierSpace::Standard };
    let faces = [0, 1].map(|side| Faces::new(&surfaces[side].pieces(side)));
    let found = segment_surfaces(slave, master, q, GapRange::ALL).unwrap();
    let (mut gap, mut weight) = (Vector3::zeros(), 0.0);
    for &facet in slave.facets_around(node) {
        let corners = |f| master.patch(f, q).corners;
        let found = &found.facets[facet as usize];
        let integrals = facet_integrals(found, corners, faces[0].of(facet), &faces[1], &method.factors());
        let basis = MultiplierBasis::of_contact(space, &integrals, found, corners, &method.factors());
        let a = slave.local_facets()[facet as usize].iter().position(|&k| k as usize == node).unwrap();
        // Positions of the nodes of a facet's face.
        let nodes = |side: usize, facet: u32| match faces[side].of(facet) {
            Some(piece) => piece.face_nodes().to_vec(),
            None => [slave, master][side].facets()[facet as usize].to_vec(),
        };
        let add = |of: &FaceBlock, nodes: Vec<u32>| {
            nodes.iter().enumerate().map(|(k, &n)| position(q, n) * of.at(a, k)).sum::<Vector3<f64>>()
        };
        let d = basis.slave_block(&integrals);
        weight += d.sum_of_row(a);
        gap += add(&d, nodes(0, facet));
        for pair in &integrals.pairs {
            gap -= add(&basis.master_block(pair), nodes(1, pair.master_facet));
        }
    }
    (gap, weight)
}

/// Difference between the tangent times a direction and the residual's derivative along it, relative to the largest entry; `None` if the residual is
/// not smooth there: segments change their kind, or differences of fourth order with two steps do not agree, as at the kink between stick and slip.
fn directional_error(
    [method, plain]: [&mut MortarContact; 2],
    rule: GradientRule,
    q_n: &[f64],
    q: &[f64],
    p: &[f64],
    [v, w, y]: [&[f64]; 3],
    multipliers: &[f64],
) -> Option<f64> {
    let active = set(p);
    begin(method, rule, q_n);
    begin(plain, rule, q_n);
    // What friction adds: the normal part has a test of its own.
    let mut at = |s: f64| {
        let (x, p, m) = (plus(q, s, v), plus(p, s, w), plus(multipliers, s, y));
        let step = StepConfiguration { q_n, q_np1: &x, rule };
        method.renew(&At::end(&x, &[], &active).with_auxiliaries(&m), true).unwrap();
        plain.renew(&At::end(&x, &[], &active), true).unwrap();
        let mut all = sheets::assemble_with(method, step, &p, &m, &active);
        let without = assemble(plain, step, &p, &active);
        let (n, own) = (all.residual.len(), without.residual.len());
        for (row, r) in without.residual.iter().enumerate() {
            all.residual[row] -= r;
            let columns = all.tangent[row * n..][..own].iter_mut().zip(&without.tangent[row * own..]);
            columns.for_each(|(t, u)| *t -= u);
        }
        (all, sheets::kinds(method))
    };
    let exact = at(0.0);
    let h = 1e-4;
    let [e, f, a, b, c, d] = [0.5 * h, -0.5 * h, h, -h, 2.0 * h, -2.0 * h].map(&mut at);
    if [&a, &b, &c, &d, &e, &f].iter().any(|x| x.1 != exact.1) {
        return None;
    }
    let size = exact.0.tangent.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let direction: Vec<f64> = [v, w, y].concat();
    let n = direction.len();
    let mut worst = 0.0_f64;
    for row in 0..n {
        let [half, near, far] = [(&e, &f), (&a, &b), (&c, &d)].map(|(x, y)| x.0.residual[row] - y.0.residual[row]);
        let derivative = (8.0 * near - far) / (12.0 * h);
        // A kink between 0 and 2 h is in one of the two more than in the other.
        if (derivative - (8.0 * half - near) / (6.0 * h)).abs() > 2e-9 * size {
            return None;
        }
        let product: f64 = (0..n).map(|k| exact.0.tangent[row * n + k] * direction[k]).sum();
        worst = worst.max((derivative - product).abs());
    }
    (size > 0.0).then_some(worst / size)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Integrals move, tangents learn, and every rank follows the iterates by itself.
    #[test]
    fn contributions_are_dealt_out_among_ranks(
        surfaces in surfaces(), d in warp(), e in warp(), p in pressures(), rule in 0usize..3, exact: bool, rough: bool, rates: bool,
        ranks in prop::sample::select(vec![1u32, 2, 3, 7]),
    ) {
        let stick = if exact { Stick::Multiplier } else { Stick::Penalty };
        let rule = RULES[rule];
        let (q_n, active) = (moved(&d), set(&p));
        let whole = match rough {
            true => with_stick(surfaces, coulomb(0.3), stick, true, measure(true)),
            false => method(surfaces, options(true)),
        };
        let run = |share: Option<Share>| {
            let mut method = whole.clone();
            let taken = share.and_then(|share| method.set_share(share));
            go(&mut method, rule, &base(), &q_n, &p);
            method.begin(&StepContext { reach: 0.5, rates, ..StepContext::new(&q_n, rule, 0.1) }).unwrap();
            let (mut found, mut gaps) = (Vec::new(), vec![0.0; SLAVE]);
            for part in [0.1, 0.3, 0.2] {
                let q = plus(&q_n, part, &e);
                let at = StepConfiguration { q_n: &q_n, q_np1: &q, rule }.at(&p, &active);
                for want_tangent in [false, true] {
                    let changed = method.renew(&at, want_tangent).unwrap();
                    let mut of: Vec<Local> = Vec::new();
                    method.assemble(&at, want_tangent, &mut |local| of.push(local.clone())).unwrap();
                    method.complementarity_gaps(&q, &active, &mut gaps).unwrap();
                    found.push((changed, of, gaps.iter().map(|gap| gap.to_bits()).collect::<Vec<_>>()));
                }
                if part == 0.2 {
                    let work = method.work(&at).unwrap();
                    method.commit(&at);
                    return (taken, found, work, method.save_history());
                }
            }
            unreachable!("the last iterate was accepted")
        };
        let (_, expected, work, history) = run(None);
        let parts: Vec<_> = (0..ranks).map(|rank| run(Some(Share::new(ranks, rank)))).collect();
        for (k, (changed, locals, gaps)) in expected.iter().enumerate() {
            for (taken, found, ..) in &parts {
                prop_assert_eq!((changed, gaps, locals.len()), (&found[k].0, &found[k].2, found[k].1.len()));
                for (all, own) in locals.iter().zip(&found[k].1) {
                    prop_assert_eq!((&all.nodes, &all.slots, all.auxiliaries), (&own.nodes, &own.slots, own.auxiliaries));
                    prop_assert_eq!(own.is_elsewhere, !taken.as_ref().unwrap().has(&own.nodes));
                    if !own.is_elsewhere {
                        prop_assert_eq!((&all.residual, &all.shift), (&own.residual, &own.shift));
                        prop_assert!(k % 2 == 0 || all.tangent == own.tangent);
                    }
                }
            }
            for slot in 0..locals.len() {
                prop_assert_eq!(parts.iter().filter(|part| !part.1[k].1[slot].is_elsewhere).count(), 1);
            }
        }
        prop_assert!(parts.iter().all(|part| part.2 == work));
        let saved: Vec<Vec<u8>> = parts.into_iter().map(|part| part.3).collect();
        prop_assert_eq!(whole.join_histories(&saved).unwrap(), history);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn tangents_are_derivatives(
        surfaces in surfaces(), d in warp(), e in warp(), f in warp(), p in pressures(), dual: bool, rule in 0usize..3, objective: bool,
        kind in 0usize..4, exact: bool, moves: bool, m in prop::collection::vec(-0.05f64..0.05, 2 * SLAVE),
        v in warp(), w in prop::collection::vec(-0.1f64..0.1, SLAVE), before in prop_oneof![Just(0.6), Just(1.5)], mirrored: bool,
    ) {
        let rule = RULES[rule];
        let stick = if exact { Stick::Multiplier } else { Stick::Penalty };
        // With integrals that move the midpoint rules leave the derivatives of their weights out.
        let integrals = if rule == GradientRule::EndPoint { Integrals::Moving } else { Integrals::Frozen };
        let options = MortarOptions { integrals, ..options(dual) };
        let friction = Friction::new(law(kind), PENALTY, stick).unwrap().with_surface_velocity(belt(moves));
        let planes = (0..SLAVE as u32).map(|n| (n, if mirrored { u8::from(n % 3 == 0) + 2 * u8::from(n % 2 == 0) } else { 0 }));
        let mut plain = method(surfaces, options).with_symmetry(planes);
        let mut method = plain.clone().with_friction(friction, measure(objective)).unwrap();
        let (q_0, q_n) = (moved(&f), moved(&d));
        // Another pressure before.
        let p_0: Vec<f64> = p.iter().map(|p| before * p).collect();
        go(&mut method, rule, &q_0, &q_n, &p_0);
        let q = plus(&q_n, 0.3, &e);
        let w: Vec<f64> = w.iter().zip(&p).map(|(w, p)| if *p == 0.0 { 0.0 } else { *w }).collect();
        // A law without stick has no multipliers.
        let count = if method.auxiliaries().is_empty() { 0 } else { m.len() };
        let y: Vec<f64> = (0..count).map(|k| if p[k / 2] == 0.0 { 0.0 } else { 0.1 * (k as f64).sin() }).collect();
        let error = directional_error([&mut method, &mut plain], rule, &q_n, &q, &p, [&v, &w, &y], &m[..count]);
        prop_assume!(error.is_some());
        if let Some(error) = error {
            prop_assert!(error < 1e-8, "{rule:?} dual {dual} kind {kind}: {error:e}");
        }
    }

    #[test]
    fn forces_have_no_resultant_and_the_objective_ones_no_moment(
        surfaces in surfaces(), d in warp(), e in warp(), lift in -0.3f64..0.5, p in pressures(), dual: bool, rule in 0usize..3, objective: bool,
        kind in 0usize..4,
    ) {
        let rule = RULES[rule];
        let measure = measure(objective);
        let q_n = lifted(&d, lift);
        let q = plus(&q_n, 1.0, &e);
        let mut method = with(surfaces, law(kind), dual, measure);
        begin(&mut method, rule, &q_n);
        let r = friction_force(surfaces, &mut method, rule, &q_n, &q, &p, dual);
        let about = if rule == GradientRule::EndPoint { q.clone() } else { plus(&q_n, 0.5, &e) };
        let size = r.iter().map(|x| x.abs()).sum::<f64>().max(1.0);
        let (force, moment) = resultants(&r, &about);
        prop_assert!(force.amax() < 1e-11 * size, "{rule:?}: {force}");
        if measure == SlipMeasure::Objective {
            prop_assert!(moment.amax() < 1e-11 * size, "{rule:?}: {moment}");
        }
    }

    /// One node with the force of the thesis: the moment is that of the gap vector, whose integrals have the factors of the contact.
    #[test]
    fn the_moment_of_the_direct_force_is_that_of_the_gap(
        surfaces in surfaces(), d in warp(), e in warp(), lift in -0.3f64..0.5, node in 0usize..SLAVE, dual: bool, rule in 0usize..3,
        kind in 0usize..3,
    ) {
        let rule = RULES[rule];
        let q_n = lifted(&d, lift);
        let q = plus(&q_n, 1.0, &e);
        let mut p = [0.0; SLAVE];
        p[node] = 1.3;
        let mut method = with(surfaces, law(0), dual, SlipMeasure::Direct).with_factors(factors(kind));
        begin(&mut method, rule, &q_n);
        let r = friction_force(surfaces, &mut method, rule, &q_n, &q, &p, dual);
        let end = rule == GradientRule::EndPoint;
        // The integrals are those of the place of the force.
        let about = if end { q.clone() } else { plus(&q_n, 0.5, &e) };
        let (gap, weight) = weighted_gap(&method, surfaces, &about, node, dual);
        let on_slave: Vector3<f64> = r[..3 * SLAVE].chunks_exact(3).map(Vector3::from_column_slice).sum();
        let traction = if weight > 0.0 { on_slave / weight } else { Vector3::zeros() };
        let (_, moment) = resultants(&r, &about);
        prop_assert!((moment - gap.cross(&traction)).amax() < 1e-11, "{moment} {gap} {traction}");
        prop_assert!(on_slave.norm() < 0.05 * 1.3 * weight + 1e-11);
        prop_assert!(!end || (method.supports()[node] - weight).abs() < 1e-13);
    }

    #[test]
    fn a_rigid_motion_turns_the_traction(
        surfaces in surfaces(), d in warp(), e in warp(), p in pressures(), angle in -1.2f64..1.2, dual: bool, rule in 0usize..3,
    ) {
        let rule = RULES[rule];
        let (q_0, q_1) = (moved(&d), moved(&e));
        let turn = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::new(0.3, -0.5, 0.8)), angle);
        let rotated = |q: &[f64], shift: Vector3<f64>| -> Vec<f64> {
            q.chunks_exact(3).flat_map(|x| <[f64; 3]>::from(turn * Vector3::new(x[0], x[1], x[2]) + shift)).collect()
        };
        let mut method = with(surfaces, law(1), dual, SlipMeasure::Objective);
        go(&mut method, rule, &q_0, &q_1, &p);
        // A step at rest: the areas are those of `q_1` then.
        go(&mut method, rule, &q_1, &q_1, &p);
        begin(&mut method, rule, &q_1);
        let before = friction_force(surfaces, &mut method, rule, &q_1, &q_1, &p, dual);
        let at_rest = method.work(&At::end(&q_1, &p, &set(&p))).unwrap();
        prop_assert!(at_rest.dissipated.abs() < 1e-11 * (1.0 + at_rest.stored));
        let q_2 = rotated(&q_1, Vector3::new(1.0, 2.0, -0.5));
        method.renew(&At::end(&q_2, &[], &set(&p)), false).unwrap();
        let turned = method.work(&At::end(&q_2, &p, &set(&p))).unwrap();
        prop_assert!((turned.stored - at_rest.stored).abs() < 1e-11 * (1.0 + at_rest.stored));
        prop_assert!(turned.dissipated.abs() < 1e-11 * (1.0 + at_rest.stored));
        go(&mut method, rule, &q_1, &q_2, &p);
        begin(&mut method, rule, &q_2);
        let after = friction_force(surfaces, &mut method, rule, &q_2, &q_2, &p, dual);
        let size = before.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        for (a, b) in rotated(&before, Vector3::zeros()).iter().zip(&after) {
            prop_assert!((a - b).abs() < 1e-11 * size, "{rule:?}: {a} {b}");
        }
    }

    /// Over a walk with changing pressures: what the force works is stored or dissipated, and nothing comes back from what was dissipated.
    #[test]
    fn the_work_is_stored_or_dissipated(
        surfaces in surfaces(), walk in prop::collection::vec((warp(), pressures()), 4), dual: bool, energy_momentum: bool,
        mu in prop_oneof![Just(0.0), 0.05f64..3.0], objective: bool, moves: bool,
    ) {
        let rule = if energy_momentum { GradientRule::DiscreteGradient } else { GradientRule::Midpoint };
        let measure = measure(objective);
        let friction = Friction::new(coulomb(mu), PENALTY, Stick::Penalty).unwrap();
        let friction = friction.with_surface_velocity(belt(moves));
        let mut method = method(surfaces, options(dual)).with_friction(friction, measure).unwrap();
        let mut stored = 0.0;
        for pair in walk.windows(2) {
            let (q_n, q, p) = (moved(&pair[0].0), moved(&pair[1].0), &pair[1].1);
            begin(&mut method, rule, &q_n);
            let force = friction_force(surfaces, &mut method, rule, &q_n, &q, p, dual);
            let work: f64 = (0..3 * NODES).map(|k| force[k] * (q[k] - q_n[k])).sum();
            let energy = method.work(&At::end(&q, p, &set(p))).unwrap();
            let size = 1.0 + stored + energy.stored;
            // The dissipation of each point is the return map's, whatever slip it was given; the work is that of objective slip.
            prop_assert!(energy.dissipated > -1e-12 * size, "{energy:?}");
            if objective {
                prop_assert!((work + stored - energy.stored - energy.dissipated + energy.driven).abs() < 1e-12 * size, "{work} {stored} {energy:?}");
            }
            method.commit(&At::end(&q, p, &set(p)));
            stored = energy.stored;
        }
    }

    /// An attempt that fails leaves the report of the last step as it was.
    #[test]
    fn the_report_is_that_of_the_last_accepted_step(surfaces in surfaces(), d in warp(), e in warp(), f in warp(), p in pressures(), rule in 0usize..3) {
        let rule = RULES[rule];
        let mut method = with(surfaces, coulomb(0.5), false, SlipMeasure::Objective);
        let (q_0, q_1, q_2) = (moved(&d), moved(&e), moved(&f));
        go(&mut method, rule, &q_0, &q_1, &p);
        let friction = |m: &MortarContact| -> Vec<_> { m.report(&q_1).unwrap().iter().map(|slot| slot.friction).collect() };
        let accepted = friction(&method);
        prop_assert_eq!(accepted.iter().filter(|slot| slot.is_some()).count(), set(&p).iter().filter(|active| **active).count());
        begin(&mut method, rule, &q_1);
        method.renew(&At::end(&q_2, &[], &set(&p)), false).unwrap();
        prop_assert_eq!(friction(&method), accepted);
    }

    #[test]
    fn history_survives_a_checkpoint(surfaces in surfaces(), d in warp(), e in warp(), f in warp(), p in pressures(), rule in 0usize..3) {
        let rule = RULES[rule];
        let new = || with(surfaces, coulomb(0.5), false, SlipMeasure::Objective);
        let (q_0, q_1, q_2) = (moved(&d), moved(&e), moved(&f));
        let mut first = new();
        go(&mut first, rule, &q_0, &q_1, &p);
        let mut second = new();
        let bytes = first.save_history();
        second.load_history(&bytes).unwrap();
        prop_assert_eq!(&second.save_history(), &bytes);
        let force = |m: &mut MortarContact| {
            begin(m, rule, &q_1);
            friction_force(surfaces, m, rule, &q_1, &q_2, &p, false)
        };
        prop_assert_eq!(force(&mut first), force(&mut second));
        let short = second.load_history(&bytes[1..]);
        let is_refused = short.is_err_and(|e| matches!(e.cause(), Some(ContactError::History { .. })));
        prop_assert!(is_refused);
        // A node that opens forgets.
        let none = [0.0; SLAVE];
        go(&mut first, rule, &q_1, &q_2, &none);
        let mut other = new();
        go(&mut other, rule, &q_1, &q_2, &none);
        prop_assert_eq!(first.save_history(), other.save_history());
    }
}

#[test]
fn what_has_no_friction_is_refused() {
    let friction = || Friction::new(coulomb(0.3), PENALTY, Stick::Penalty).unwrap();
    let surfaces = [SheetKind::Triangles; 2];
    let refused = |error: Fault| matches!(error.cause(), Some(ContactError::FrictionUnavailable { .. }));
    let q = base();
    let mut objective = method(surfaces, options(false)).with_friction(friction(), SlipMeasure::Objective).unwrap();
    assert!(refused(
        objective
            .begin(&StepContext { reach: 0.5, ..StepContext::new(&q, GradientRule::EndPointMean, 0.1) })
            .unwrap_err()
    ));
}
