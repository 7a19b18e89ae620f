//! The battery: every scheme of the table does what it claims, and what it does not claim does not hold.

use stoss_integrators::{SCHEMES, Scheme, scheme};
use stoss_model_problems::{
    AugmentedSpringPendulum, ConstraintForm, MassPoint, ModelError, ModelProblem, Pendulum, SpringPair, SpringPendulum,
    StringPendulum, simulate,
};

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Largest drift of linear momentum, angular momentum and energy, relative to the start.
fn drift(problem: &dyn ModelProblem, scheme: &dyn Scheme, dt: f64, steps: u64) -> [f64; 3] {
    let mut first = None;
    let mut worst = [0.0_f64; 3];
    simulate(problem, scheme, dt, steps, |s| {
        let (l, j, h) = (s.linear_momentum, s.angular_momentum, s.energy());
        let (l0, j0, h0) = *first.get_or_insert((l, j, h));
        let difference = |a: [f64; 3], b: [f64; 3]| norm(std::array::from_fn(|i| a[i] - b[i])) / norm(b);
        let now = [difference(l, l0), difference(j, j0), (h / h0 - 1.0).abs()];
        worst = std::array::from_fn(|i| worst[i].max(now[i]));
    })
    .unwrap_or_else(|error| panic!("{}: {error}", scheme.name()));
    worst
}

#[test]
fn every_scheme_conserves_what_it_claims_and_nothing_else() {
    for entry in SCHEMES {
        let scheme = entry.with([]).unwrap();
        let [l, j, h] = drift(&SpringPair::default(), scheme.as_ref(), 0.002, 200);
        let claims = scheme.claims();
        for (what, value, claimed) in [
            ("linear momentum", l, claims.linear_momentum),
            ("angular momentum", j, claims.angular_momentum),
            ("energy", h, claims.energy),
        ] {
            if claimed {
                assert!(value < 1e-11, "{}: {what} drifts by {value:e}", entry.name);
            } else {
                assert!(value > 1e-6, "{}: {what} is conserved ({value:e}) although not claimed", entry.name);
            }
        }
    }
}

/// Position of the soft spring pendulum at T = 0.1.
fn position(scheme: &dyn Scheme, problem: &dyn ModelProblem, steps: u64) -> Vec<f64> {
    let mut last = Vec::new();
    simulate(problem, scheme, 0.1 / steps as f64, steps, |s| last = s.q[..problem.dimension()].to_vec())
        .unwrap_or_else(|error| panic!("{}: {error}", scheme.name()));
    last
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn every_scheme_has_its_order() {
    for problem in [&SpringPendulum::soft() as &dyn ModelProblem, &SpringPair::default(), &StringPendulum::new(3, 1e3)]
    {
        // Richardson's extrapolation of two fine runs of one scheme.
        let reference: Vec<f64> = {
            let scheme = scheme("midpoint").unwrap();
            let (coarse, fine) = (position(scheme.as_ref(), problem, 4000), position(scheme.as_ref(), problem, 8000));
            fine.iter().zip(&coarse).map(|(f, c)| f + (f - c) / 3.0).collect()
        };
        for entry in SCHEMES {
            let scheme = entry.with([]).unwrap();
            let claimed = scheme.claims().order;
            let (steps, tolerance) = if claimed == 1 { (4000, 0.05) } else { (400, 0.02) };
            let error = |n| distance(&position(scheme.as_ref(), problem, n), &reference);
            let order = (error(steps) / error(2 * steps)).log2();
            let difference = (order - f64::from(claimed)).abs();
            assert!(difference < tolerance, "{}, {}: order {order}, claimed {claimed}", problem.name(), entry.name);
        }
    }
}

/// Solved for the augmented coordinate and its multiplier, its equations are those of the discrete gradient (theory/integrators#eq-spring-augmented).
#[test]
fn an_augmented_coordinate_gives_the_discrete_gradient() {
    let scheme = scheme("energy-momentum").unwrap();
    let pendulum = SpringPendulum::soft();
    let direct = position(scheme.as_ref(), &pendulum, 100);
    let augmented = position(scheme.as_ref(), &AugmentedSpringPendulum(pendulum), 100);
    assert!(distance(&direct, &augmented[..3]) < 1e-11, "{direct:?} {augmented:?}");
}

#[test]
fn members_with_parameters_off_their_optimum_lose_an_order() {
    let problem = SpringPendulum::soft();
    let reference = position(scheme("energy-momentum").unwrap().as_ref(), &problem, 20000);
    for (name, parameter) in [("newmark", ("gamma", 0.7)), ("variational-midpoint", ("alpha", 0.3))] {
        let scheme = stoss_integrators::entry(name).unwrap().with([parameter]).unwrap();
        assert_eq!(scheme.claims().order, 1);
        let error = |n| distance(&position(scheme.as_ref(), &problem, n), &reference);
        let order = (error(2000) / error(4000)).log2();
        assert!((order - 1.0).abs() < 0.05, "{name}: order {order}");
    }
}

#[test]
fn schemes_that_carry_constraints_stay_on_the_manifold() {
    for entry in SCHEMES {
        let scheme = entry.with([]).unwrap();
        let mut worst = 0.0_f64;
        let result = simulate(&Pendulum::default(), scheme.as_ref(), 0.02, 500, |s| worst = worst.max(s.violation));
        if scheme.claims().constraints {
            result.unwrap_or_else(|error| panic!("{}: {error}", entry.name));
            assert!(worst < 1e-12, "{}: leaves the circle by {worst:e}", entry.name);
        } else {
            assert!(matches!(result, Err(ModelError::Constraints { .. })), "{}", entry.name);
        }
    }
}

#[test]
fn the_mass_point_loses_its_energy_with_the_standard_constraint_only() {
    // theory/constraints#mass-point: H from 159.65 to 49.05; the modified constraint keeps it.
    for name in ["midpoint", "energy-momentum"] {
        let scheme = scheme(name).unwrap();
        for (form, expected, tolerance) in
            [(ConstraintForm::Standard, 49.05, 5e-3), (ConstraintForm::Modified, 159.65, 1e-12 * 159.65)]
        {
            let (mut first, mut last, mut worst) = (f64::NAN, f64::NAN, 0.0_f64);
            simulate(&MassPoint::new(form), scheme.as_ref(), 0.05, 120, |s| {
                if s.step == 0 {
                    first = s.energy();
                }
                last = s.energy();
                worst = worst.max((last - 159.65).abs());
            })
            .unwrap();
            assert!((first - 159.65).abs() < 1e-12);
            assert!((last - expected).abs() < tolerance, "{name} {form:?}: {last}");
            if form == ConstraintForm::Modified {
                assert!(worst < tolerance, "{name}: {worst:e}");
            }
        }
    }
}
