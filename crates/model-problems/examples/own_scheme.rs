//! A time-stepping scheme of one's own: the theta method, which damps for theta > 1/2 and which is not in the catalogue.
//!
//! Shown: the trait `Scheme`, which is data; a problem of one's own, the trait `ModelProblem`; runs of `simulate`.
//! Checked: the energy of an oscillator against its closed form, the order, linear momentum of two masses on a nonlinear spring.
//! The same type drives finite elements: `Settings { scheme: Some(Box::new(Theta(0.6))), .. }` of `stoss-solver`.
//!
//! `cargo run --example own_scheme -p stoss-model-problems`; docs/how-to-add/integrator.md explains it.

use nalgebra::DMatrix;
use stoss_integrators::{
    Claims, Combination, ConstraintTerm, ForceRule, ForceTerm, GradientRule, Midpoint, Scheme, State, StepRule,
};
use stoss_model_problems::{ModelError, ModelProblem, SpringPair, SpringPendulum, simulate};

/// `M (v_np1 - v_n) / dt + F(q_theta) = 0`, `q_np1 - q_n = dt ((1 - theta) v_n + theta v_np1)`; theta in `[1/2, 1]`.
///
/// 1/2 is the midpoint rule, 1 backward Euler.
#[derive(Clone, Copy, Debug)]
struct Theta(f64);

impl Scheme for Theta {
    fn name(&self) -> &'static str {
        "theta"
    }
    fn claims(&self) -> Claims {
        let is_midpoint = self.0 == 0.5;
        Claims {
            order: if is_midpoint { 2 } else { 1 },
            linear_momentum: true,
            angular_momentum: is_midpoint,
            energy: false,
            constraints: true,
        }
    }
    fn rule(&self, dt: f64) -> StepRule {
        let theta = self.0;
        // v_np1 = ((q_np1 - q_n) / dt - (1 - theta) v_n) / theta
        StepRule {
            inertia: Combination::new(1.0 / (theta * dt * dt), -1.0 / (theta * dt)),
            force: ForceTerm { rule: ForceRule::Configuration { theta }, weight: 1.0 },
            constraint: ConstraintTerm { rule: GradientRule::EndPoint, weight: 1.0 },
            history: None,
            velocity: Combination::new(1.0 / (theta * dt), -(1.0 - theta) / theta),
            impulse: None,
            acceleration: None,
        }
    }
}

/// A unit mass on a linear spring of stiffness `w^2`, `V = w^2 q^2 / 2`.
#[derive(Debug)]
struct Oscillator {
    w: f64,
}

impl ModelProblem for Oscillator {
    fn name(&self) -> &str {
        "oscillator"
    }
    fn dimension(&self) -> usize {
        1
    }
    fn mass(&self) -> DMatrix<f64> {
        DMatrix::identity(1, 1)
    }
    fn initial_state(&self) -> State {
        State::new(vec![1.0], vec![0.5])
    }
    fn potential(&self, q: &[f64]) -> f64 {
        0.5 * self.w * self.w * q[0] * q[0]
    }
    fn add_force(&self, q: &[f64], out: &mut [f64]) {
        out[0] += self.w * self.w * q[0];
    }
    fn add_stiffness(&self, _q: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        out[(0, 0)] += factor * self.w * self.w;
    }
    fn add_discrete_force(&self, q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        out[0] += 0.5 * self.w * self.w * (q_n[0] + q_np1[0]);
    }
    fn add_discrete_stiffness(&self, _q_n: &[f64], _q_np1: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        out[(0, 0)] += 0.5 * factor * self.w * self.w;
    }
}

/// Energy at the end over that at the start.
fn energy_ratio(scheme: &dyn Scheme, dt: f64, steps: u64) -> Result<f64, ModelError> {
    let mut ends = [0.0; 2];
    simulate(&Oscillator { w: 3.0 }, scheme, dt, steps, |s| ends[usize::from(s.step > 0)] = s.energy())?;
    Ok(ends[1] / ends[0])
}

/// Position of the soft spring pendulum at t = 0.1.
fn position(scheme: &dyn Scheme, steps: u64) -> Result<Vec<f64>, ModelError> {
    let mut last = Vec::new();
    simulate(&SpringPendulum::soft(), scheme, 0.1 / steps as f64, steps, |s| last = s.q.to_vec())?;
    Ok(last)
}

fn order(scheme: &dyn Scheme) -> Result<f64, ModelError> {
    let [coarse, fine] = [position(&Midpoint, 4000)?, position(&Midpoint, 8000)?];
    let exact: Vec<f64> = fine.iter().zip(&coarse).map(|(f, c)| f + (f - c) / 3.0).collect();
    let error = |q: Vec<f64>| q.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    // Steps small enough for the order to show, and large enough for the error of the reference not to.
    let steps = if scheme.claims().order == 1 { 2000 } else { 400 };
    Ok((error(position(scheme, steps)?) / error(position(scheme, 2 * steps)?)).log2())
}

fn momentum_drift(scheme: &dyn Scheme) -> Result<f64, ModelError> {
    let (mut first, mut worst) = (None, 0.0_f64);
    simulate(&SpringPair::default(), scheme, 0.002, 200, |s| {
        let start: [f64; 3] = *first.get_or_insert(s.linear_momentum);
        let size = start.iter().map(|p| p * p).sum::<f64>().sqrt();
        (0..3).for_each(|i| worst = worst.max((s.linear_momentum[i] - start[i]).abs() / size));
    })?;
    Ok(worst)
}

fn main() -> Result<(), ModelError> {
    println!("theta   energy after 50 steps   closed form   order   drift of linear momentum");
    for theta in [0.5, 0.55, 0.7, 1.0] {
        let scheme = Theta(theta);
        // Both factors of the amplification have this modulus, squared, for z = w dt.
        let (dt, z) = (0.05, 3.0 * 0.05);
        let factor = (1.0 + ((1.0 - theta) * z).powi(2)) / (1.0 + (theta * z).powi(2));
        let (found, expected) = (energy_ratio(&scheme, dt, 50)?, factor.powi(50));
        let (order, drift) = (order(&scheme)?, momentum_drift(&scheme)?);
        println!("{theta:5.2} {found:23.12} {expected:13.6} {order:7.2} {drift:14.1e}");
        assert!((found / expected - 1.0).abs() < 1e-12);
        assert!((order - f64::from(scheme.claims().order)).abs() < 0.05);
        assert!(drift < 1e-11);
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), ModelError> {
    main()
}
