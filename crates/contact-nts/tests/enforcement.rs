//! The normal part by penalty: pressure, work, release, history.

use crate::common::*;
use proptest::prelude::*;
use stoss_contact::{ContactError, Enforcement, SearchOptions};
use stoss_contact_nts::{ConstraintForm, NodeToSurface, NodeToSurfaceOptions};
use stoss_term::{At, GradientRule, StepContext, Term, Unilateral};

const FACETS: u32 = 4;
const FLAT: [f64; FACETS as usize + 1] = [0.0; FACETS as usize + 1];
const SLAVE: usize = 2 * (FACETS as usize + 1);
const STIFFNESS: f64 = 30.0;

fn at(x: f64, z: f64) -> Vec<f64> {
    positions(&FLAT, [x, 0.3, z])
}

fn spring() -> NodeToSurface {
    enforced(FACETS, Enforcement::Penalty(STIFFNESS))
}

/// Row of the pressure divided by minus the area.
fn row(m: &NodeToSurface, q_n: &[f64], q: &[f64], p: f64, rule: GradientRule) -> f64 {
    let residual = assembled(m, q_n, q, p, rule, false).0;
    -residual[residual.len() - 1] / m.slot_weight(0)
}

/// Pressure that solves the row, which is linear in it with the slope `1 / STIFFNESS`.
fn pressure(m: &NodeToSurface, q_n: &[f64], q: &[f64], rule: GradientRule) -> f64 {
    -STIFFNESS * row(m, q_n, q, 0.0, rule)
}

fn stored(m: &NodeToSurface, q: &[f64], active: &[bool]) -> f64 {
    m.work(&At::end(q, &[0.0; 4], active)).unwrap().stored
}

#[test]
fn a_spring_has_the_pressure_of_its_depth() {
    let mut m = spring();
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&at(0.4, 0.05), GradientRule::EndPoint, 0.1) }).unwrap();
    m.repair(&at(0.4, -0.02), &ACTIVE).unwrap();
    assert!((pressure(&m, &at(0.4, 0.05), &at(0.4, -0.02), GradientRule::EndPoint) - 0.6).abs() < 1e-13);
    // Closing in a midpoint scheme: energy STIFFNESS 0.02^2 / 2 over the way 0.07.
    for rule in [GradientRule::Midpoint, GradientRule::DiscreteGradient] {
        let mean = STIFFNESS * 0.5 * 0.02 * 0.02 / 0.07;
        assert!((pressure(&m, &at(0.4, 0.05), &at(0.4, -0.02), rule) - mean).abs() < 1e-13);
    }
    let energy = m.slot_weight(0) * 0.5 * STIFFNESS * 0.02 * 0.02;
    assert!((stored(&m, &at(0.4, -0.02), &ACTIVE) - energy).abs() < 1e-15 && stored(&m, &at(0.4, -0.02), &OPEN) == 0.0);
    // It goes on with its depth in the next step.
    m.commit(&At::end(&at(0.4, -0.02), &[0.6, 0.0, 0.0, 0.0], &ACTIVE));
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&at(0.4, -0.02), GradientRule::DiscreteGradient, 0.1) })
        .unwrap();
    assert!((pressure(&m, &at(0.4, -0.02), &at(0.4, -0.04), GradientRule::DiscreteGradient) - 0.9).abs() < 1e-13);
    // Out again: it stays closed for this step, which has the rest of the spring's force, and opens in the next one.
    assert_eq!(gap(&m, &at(0.4, 0.01), &ACTIVE), 0.0);
    m.commit(&At::end(&at(0.4, 0.01), &[0.1, 0.0, 0.0, 0.0], &ACTIVE));
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&at(0.4, 0.01), GradientRule::DiscreteGradient, 0.1) })
        .unwrap();
    assert!((gap(&m, &at(0.4, 0.02), &ACTIVE) - 0.02).abs() < 1e-13);
    assert!((gap(&m, &at(0.4, -0.02), &OPEN) + 0.02).abs() < 1e-13, "closes at zero, not at the old depth");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// With the energy-momentum element the contact forces do exactly the work of the spring, on warped facets, over edges, in closing and
    /// in opening steps.
    #[test]
    fn the_work_of_the_spring_is_exact(
        noise in proptest::collection::vec(-0.05..0.05_f64, 3 * SLAVE),
        moved in proptest::collection::vec(-0.03..0.03_f64, 3 * SLAVE),
        heights in (0.15..0.3_f64, -0.3..-0.1_f64, -0.3..0.3_f64),
        slide in prop_oneof![-0.1..0.1_f64, 0.9..1.1_f64],
    ) {
        let mut path = [at(0.5, heights.0), at(0.45, heights.1), at(0.45 + slide, heights.2)];
        for k in 0..3 * SLAVE {
            for (step, q) in path.iter_mut().enumerate() {
                q[k] += noise[k] + step as f64 * moved[k];
            }
        }
        let mut m = spring();
        let mut before = 0.0;
        for pair in path.windows(2) {
            m.begin(&StepContext { reach: 2.0, ..StepContext::new(&pair[0], GradientRule::DiscreteGradient, 0.1) }).unwrap();
            m.repair(&pair[1], &ACTIVE).unwrap();
            let p = pressure(&m, &pair[0], &pair[1], GradientRule::DiscreteGradient);
            let residual = assembled(&m, &pair[0], &pair[1], p, GradientRule::DiscreteGradient, false).0;
            let work: f64 = residual.iter().zip(pair[1].iter().zip(&pair[0])).map(|(r, (b, a))| r * (b - a)).sum();
            let after = stored(&m, &pair[1], &ACTIVE);
            prop_assert!((work - (after - before)).abs() < 1e-13, "{work:e} {:e}", after - before);
            prop_assert!(p >= -1e-13);
            before = after;
            m.commit(&At::end(&pair[1], &[p, 0.0, 0.0, 0.0], &ACTIVE));
        }
    }
}

#[test]
fn what_is_not_available_says_so() {
    let options = NodeToSurfaceOptions {
        constraint: ConstraintForm::Modified,
        enforcement: Enforcement::Penalty(1.0),
        search: SearchOptions::default(),
        ..NodeToSurfaceOptions::default()
    };
    let reference = at(0.4, 0.5);
    let new = |options| NodeToSurface::new("test", &[[10, 11, 12, 13]], &[[0, 2, 3, 1]], &reference, options);
    assert_eq!(new(options).unwrap_err(), ContactError::PenaltyUnavailable);
    let options = NodeToSurfaceOptions { enforcement: Enforcement::Penalty(-1.0), ..NodeToSurfaceOptions::default() };
    assert_eq!(new(options).unwrap_err().to_string(), "the normal stiffness must be positive, but is -1");
}
