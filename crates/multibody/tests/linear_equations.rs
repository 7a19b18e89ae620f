//! Linear equations between points: forces, work, momenta, closed forms.

use crate::common::{ABOUT_Z, add_body, add_constraint, finish, rod, run, run_with};
use stoss_multibody::{
    Embedded, Equations, LinearEquationError, LinearEquations, LinearTerms, PiecewiseLinear, PointMass, Spring,
    SpringData, analyse,
};
use stoss_solver::{Load, LoadKind, Model, Prescription, Table};
use stoss_term::{At, Bilateral, GradientRule, StepConfiguration, StepContext, Term, check};

const X: [f64; 3] = [1.0, 0.0, 0.0];

fn constant(value: f64) -> PiecewiseLinear {
    PiecewiseLinear(vec![(0.0, value)])
}

/// A mass on the x axis that moves along it, with a spring to the ground beside it.
fn mass_with_spring(model: &mut Model, x: f64, mass: f64, stiffness: f64) -> Embedded {
    let first = model.node_count() as u32;
    let own = PointMass::new("mass", first, mass, 1.0).unwrap();
    model.reference.extend([x, 0.0, 0.0]);
    model.velocity.extend([0.0; 3]);
    let point = own.position();
    model.parts.push(Box::new(own));
    let data = SpringData { stiffness, damping: 0.0, rest_length: 1.0, tension_only: false };
    let ground = Embedded::ground([x + 1.0, 0.0, 0.0]);
    model.parts.push(Box::new(Spring::new("spring", [point.clone(), ground], data).unwrap()));
    point
}

fn equation(terms: &[(&Embedded, f64)], value: PiecewiseLinear, model: &Model) -> LinearEquations {
    let terms: LinearTerms = terms.iter().map(|(point, f)| ((*point).clone(), X.map(|x| f * x))).collect();
    LinearEquations::new("equation", 1.0, &[terms], value, &model.reference).unwrap()
}

fn pull(model: &mut Model, mass: usize, force: f64) {
    let kind = LoadKind::Dead { patterns: vec![vec![(3 * mass as u32, force)]] };
    model.loads.push(Load { name: "pull".into(), kind, magnitude: Table::constant(&[1.0]) });
}

/// `u_1 = 2 u_2`: a pull at the second mass is shared as `4 k_1 : k_2`, and the forces of the equation on the masses are as 1 to -2.
#[test]
fn statics_of_a_lever() {
    let mut model = Model::default();
    let points = [(0.0, 3.0), (5.0, 7.0)].map(|(x, k)| mass_with_spring(&mut model, x, 1.0, k));
    let own = equation(&[(&points[0], 1.0), (&points[1], -2.0)], constant(0.0), &model);
    let place = add_constraint(&mut model, "lever", own);
    pull(&mut model, 1, 0.4);
    model.velocity.clear();
    model.prescriptions.push(Prescription {
        name: "along x".into(),
        nodes: vec![0, 1],
        directions: Vec::new(),
        components: vec![1, 2],
        displacement: Table::constant(&[0.0; 2]),
        rotation: None,
        ramp_until: None,
    });
    let mut simulation = run_with(model, 1.0, 1.0, None);
    finish(&mut simulation);
    let q = &simulation.state().q;
    let (u1, u2) = (q[0], q[3] - 5.0);
    let expected = 0.4 / (4.0 * 3.0 + 7.0);
    assert!((u2 - expected).abs() < 1e-13 && (u1 - 2.0 * expected).abs() < 1e-13, "{u1} {u2}");
    let multiplier = simulation.pressures()[place][0];
    assert!((multiplier - 3.0 * u1).abs() < 1e-12, "{multiplier}");
    assert!((0.4 - 2.0 * multiplier - 7.0 * u2).abs() < 1e-12);
}

/// With `u_1 = 2 u_2` two masses swing with `omega^2 = (4 k_1 + k_2) / (4 m_1 + m_2)`; the midpoint rule turns the phase by `2 atan(omega dt / 2)` a step.
#[test]
fn two_masses_swing_as_one() {
    let mut model = Model::default();
    let points = [(0.0, 0.5, 3.0), (5.0, 1.5, 7.0)].map(|(x, m, k)| mass_with_spring(&mut model, x, m, k));
    let own = equation(&[(&points[0], 1.0), (&points[1], -2.0)], constant(0.0), &model);
    add_constraint(&mut model, "lever", own);
    model.velocity[0] = 0.2;
    model.velocity[3] = 0.1;
    let mut simulation = run(model, 0.05, 5.0);
    let first = *simulation.balance();
    finish(&mut simulation);
    let omega = (19.0_f64 / 3.5).sqrt();
    let phase = 100.0 * 2.0 * (0.5 * omega * 0.05).atan();
    let q = &simulation.state().q;
    assert!((q[0] - 0.2 / omega * phase.sin()).abs() < 1e-12, "{} {}", q[0], 0.2 / omega * phase.sin());
    assert!((q[0] - 2.0 * (q[3] - 5.0)).abs() < 1e-13);
    let last = *simulation.balance();
    assert!((last.total() - first.total()).abs() < 1e-14 && last.external_work == 0.0);
}

/// Bodies in free flight: an equation whose factors add up to zero keeps the linear momentum, and what drives it is all that the energy gets.
#[test]
fn driven_equation_between_rigid_bodies() {
    let mut model = Model::default();
    let spin = [0.4, -0.8, 1.1];
    let a = add_body(&mut model, "a", rod(1.5, [0.0; 3], 0.3), [0.1, 0.0, 0.2], spin);
    let b = add_body(&mut model, "b", rod(0.7, [1.0, 0.2, 0.1], 0.2), [0.1, 0.0, 0.2], spin);
    let (d, at) = ([0.6, 0.0, 0.8], [0.5, 0.4, 0.0]);
    let terms: LinearTerms = vec![(a.point(at), d), (b.point(at), d.map(|d| -d))];
    let value = PiecewiseLinear(vec![(0.0, 0.0), (0.5, 0.0), (1.5, 0.3)]);
    let own = LinearEquations::new("equation", 1.0, &[terms], value, &model.reference).unwrap();
    assert!(own.conserves_linear_momentum() && !own.conserves_angular_momentum() && own.moves());
    add_constraint(&mut model, "equation", own);
    let mut simulation = run(model, 0.02, 3.0);
    let first = *simulation.balance();
    finish(&mut simulation);
    let last = *simulation.balance();
    let drift = (0..3).map(|i| (last.linear_momentum[i] - first.linear_momentum[i]).abs()).fold(0.0, f64::max);
    assert!(drift < 1e-11, "{drift:e}");
    let error = last.total() - first.total();
    assert!(error.abs() < 1e-10 && last.external_work.abs() > 1e-3, "{error:e} {}", last.external_work);
    let q = &simulation.state().q;
    let along = |body: &stoss_multibody::RigidBody| {
        let frame = body.frame(at, ABOUT_Z).point.at(q);
        (0..3).map(|i| d[i] * frame[i]).sum::<f64>()
    };
    assert!((along(&a) - along(&b) - 0.3).abs() < 1e-10);
}

/// Tangents against differences, the resultant, and the work of the forces, which is the multiplier times the change of the right-hand side, under every rule.
#[test]
fn forces_are_those_of_the_multipliers() {
    let reference: Vec<f64> = (0..12).map(|k| (1.3 * k as f64).sin()).collect();
    let point = |vector: u32| Embedded::vector(vector);
    let middle = Embedded { terms: vec![(2, 0.25), (3, 0.75)], ..Embedded::default() };
    let balanced: LinearTerms = vec![(point(0), [0.3, -1.0, 20.0]), (middle, [-0.3, 1.0, -20.0])];
    let other: LinearTerms =
        vec![(point(1), [0.0, 2.0, 0.0]), (point(1), [0.0, 1.0, 0.0]), (point(0), [1.0, 0.0, 0.0])];
    for (equations, keeps) in [(vec![balanced.clone()], true), (vec![balanced, other], false)] {
        let value = PiecewiseLinear(vec![(0.0, 0.1), (1.0, 0.7)]);
        let mut term = LinearEquations::new("equations", 0.5, &equations, value, &reference).unwrap();
        assert_eq!(term.conserves_linear_momentum(), keeps);
        let (slots, multipliers) = (equations.len(), [0.7, -1.9]);
        let q_np1: Vec<f64> = reference.iter().enumerate().map(|(k, x)| x + 0.1 * (0.7 * k as f64).cos()).collect();
        for rule in [
            GradientRule::StartPoint,
            GradientRule::Midpoint,
            GradientRule::EndPoint,
            GradientRule::EndPointMean,
            GradientRule::DiscreteGradient,
        ] {
            term.begin(&StepContext::new(&reference, rule, 0.05)).unwrap();
            let step = StepConfiguration { q_n: &reference, q_np1: &q_np1, rule };
            let active = vec![true; slots];
            let at = step.at(&multipliers[..slots], &active);
            let along = check::direction(&term, 4, 3, 1.0, 1.0);
            let derivative = check::derivative(&mut term, &at, &along, 1e-3).unwrap();
            assert!(derivative.deviation < 1e-11, "{rule:?}: {derivative:?}");
            let promises = check::promises(&mut term, &at, &|_| false).unwrap();
            assert!(promises.is_pure && promises.has_order && promises.asymmetry == 0.0);
            assert_eq!(promises.resultant < 1e-14, keeps, "{rule:?}: {promises:?}");
            // `-lambda (phi_np1 - phi_n)` with `phi` less its right-hand side.
            let change = |k: usize| {
                let part = |(point, factor): &(Embedded, [f64; 3])| {
                    let (from, to) = (point.at(&reference), point.at(&q_np1));
                    (0..3).map(|i| factor[i] * (to[i] - from[i])).sum::<f64>()
                };
                equations[k].iter().map(part).sum::<f64>()
            };
            let work: f64 = (0..slots).map(|k| multipliers[k] * change(k)).sum();
            assert!((promises.work + work).abs() < 1e-13, "{rule:?}: {} {work}", promises.work);
        }
    }
}

#[test]
fn what_follows_and_what_contradicts_is_found() {
    let mut model = Model::default();
    let p = [0.0, 3.0, 6.0].map(|x| mass_with_spring(&mut model, x, 1.0, 1.0));
    let of = |a: usize, b: usize, value: f64| equation(&[(&p[a], 5.0), (&p[b], -5.0)], constant(value), &model);
    let all = [of(0, 1, 0.0), of(1, 2, 0.0), of(0, 2, 0.0)];
    let sets: Vec<&dyn Equations> = all.iter().map(|set| set as &dyn Equations).collect();
    let found = analyse(&sets, &model.reference, |_| true).unwrap();
    assert_eq!((found.rank, found.redundant, found.involved), (2, vec![(2, 0)], vec![0, 1, 2]));
    let other = of(0, 2, 0.1);
    let error = analyse(&[sets[0], sets[1], &other], &model.reference, |_| true).unwrap_err().to_string();
    assert!(error.starts_with("equation equation: equation 1 is redundant and contradicts the others"), "{error}");
    // Without free components there is nothing to solve for; whether it holds is checked at the end of a step.
    let q = &model.reference;
    assert!(analyse(&[&other], q, |_| false).is_err());
    let mut still = of(0, 2, 0.1);
    still.begin(&StepContext::new(q, GradientRule::EndPoint, 0.1)).unwrap();
    assert!(still.verify_inactive(q, &[false]).unwrap_err().to_string().contains("contradict"));
    assert!(all[2].verify_inactive(q, &[false]).is_ok());
}

#[test]
fn bad_factors_have_errors() {
    let reference = [0.0; 6];
    let make = |terms: LinearTerms| LinearEquations::new("e", 1.0, &[terms], constant(0.0), &reference);
    let point = Embedded::vector(1);
    let cancels = make(vec![(point.clone(), X), (point.clone(), X.map(|x| -x))]);
    assert!(matches!(cancels, Err(LinearEquationError::NoFactor { number: 1, .. })), "{cancels:?}");
    let ground = make(vec![(Embedded::ground([1.0; 3]), X)]);
    assert!(matches!(ground, Err(LinearEquationError::NoFactor { .. })));
    let bad = make(vec![(point, [f64::NAN, 0.0, 0.0])]);
    assert!(matches!(bad, Err(LinearEquationError::Factor { .. })));
}

/// The work of a driven equation in statics is that of the trapezium rule; a checkpoint knows the last force.
#[test]
fn history_of_a_driven_equation() {
    let terms: LinearTerms = vec![(Embedded::vector(0), X)];
    let value = PiecewiseLinear(vec![(0.0, 0.0), (1.0, 2.0)]);
    let mut term = LinearEquations::new("e", 1.0, &[terms], value, &[0.0; 3]).unwrap();
    let q = [0.5, 0.0, 0.0];
    let step = |time: f64| StepContext {
        time,
        end: time + 0.25,
        rates: false,
        ..StepContext::new(&q, GradientRule::EndPoint, 0.25)
    };
    term.begin(&step(0.0)).unwrap();
    term.commit(&At::end(&q, &[3.0], &[true]));
    let mut other = term.clone();
    other.load_history(&term.save_history()).unwrap();
    assert!(other.load_history(&[0; 7]).is_err());
    other.begin(&step(0.25)).unwrap();
    let work = other.work(&At::end(&q, &[5.0], &[true])).unwrap();
    assert!((work.driven - 0.5 * (3.0 + 5.0) * 0.5).abs() < 1e-15, "{work:?}");
}
