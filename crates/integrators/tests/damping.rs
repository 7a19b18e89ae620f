//! A damped oscillator `m x'' + c x' + k x = 0` under every scheme, against its closed form.

use std::convert::Infallible;
use stoss_integrators::{
    Buffers, DampingTangent, EndPoint, ForceRule, SCHEMES, Scheme, SecondOrderSystem, State, Step, StepConfiguration,
    evaluate, finish, start,
};

const MASS: f64 = 2.0;
const STIFFNESS: f64 = 18.0;
const DAMPING: f64 = 1.2;

#[derive(Default)]
struct Oscillator {
    tangent: f64,
}

impl SecondOrderSystem for Oscillator {
    type Error = Infallible;
    fn dimension(&self) -> usize {
        1
    }
    fn has_constraints(&self) -> bool {
        false
    }
    fn add_mass_product(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        out[0] += MASS * factor * x[0];
    }
    fn solve_mass(&mut self, rhs: &[f64], x: &mut [f64]) -> Result<(), Infallible> {
        x[0] = rhs[0] / MASS;
        Ok(())
    }
    fn start_tangent(&mut self, factor: f64) {
        self.tangent = factor * MASS;
    }
    fn add_force(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
        out: &mut [f64],
    ) -> Result<(), Infallible> {
        let theta = rule.load_fraction();
        out[0] += STIFFNESS * ((1.0 - theta) * step.q_n[0] + theta * step.q_np1[0]);
        self.tangent += tangent.map_or(0.0, |weight| weight * theta * STIFFNESS);
        Ok(())
    }
    fn has_damping(&self) -> bool {
        true
    }
    fn add_damping(
        &mut self,
        _q: &[f64],
        v: &[f64],
        tangent: Option<DampingTangent>,
        out: &mut [f64],
    ) -> Result<(), Infallible> {
        out[0] += DAMPING * v[0];
        self.tangent += tangent.map_or(0.0, |at| at.weight * at.rate * DAMPING);
        Ok(())
    }
}

/// The state after `steps` steps to `end`, from `x = 1`, `v = 0.5`, and the largest change of energy and loss together, with those of the start.
fn run(scheme: &dyn Scheme, end: f64, steps: usize) -> (State, f64) {
    let dt = end / steps as f64;
    let rule = scheme.rule(dt);
    let (mut system, mut state) = (Oscillator::default(), State::new(vec![1.0], vec![0.5]));
    start(&mut system, &rule, &mut state).unwrap();
    let mut buffers = Buffers::new(1, true, false);
    let energy = |s: &State| 0.5 * MASS * s.v[0] * s.v[0] + 0.5 * STIFFNESS * s.q[0] * s.q[0];
    let (first, mut lost, mut drift) = (energy(&state), 0.0, 0.0_f64);
    for _ in 0..steps {
        let step = Step { state_n: &state, dt, rule };
        let mut increment = vec![0.0];
        // Linear: one iteration, if the tangent is right; the second one shows that.
        for k in 0..2 {
            let q = [state.q[0] + increment[0]];
            evaluate(&mut system, &step, EndPoint { q: &q, increment: &increment }, true, &mut buffers).unwrap();
            let correction = -buffers.residual[0] / system.tangent;
            assert!(k == 0 || correction.abs() < 1e-13, "{}: the tangent is wrong: {correction:e}", scheme.name());
            increment[0] += correction;
        }
        let mut next = State { q: vec![state.q[0] + increment[0]], ..state.clone() };
        finish(&mut system, &step, &increment, &mut buffers, &mut next).unwrap();
        let loss = dt * buffers.rate[0] * buffers.damping[0];
        assert!(loss >= 0.0);
        lost += loss;
        state = next;
        drift = drift.max((energy(&state) + lost - first).abs());
    }
    (state, drift / first)
}

/// `x(t) = e^(-zeta w t) (x_0 cos w_d t + (v_0 + zeta w x_0)/w_d sin w_d t)`.
fn closed_form(t: f64) -> f64 {
    let w = (STIFFNESS / MASS).sqrt();
    let zeta = DAMPING / (2.0 * MASS * w);
    let damped = w * (1.0 - zeta * zeta).sqrt();
    let sine = (0.5 + zeta * w) / damped;
    (-zeta * w * t).exp() * ((damped * t).cos() + sine * (damped * t).sin())
}

#[test]
fn every_scheme_has_its_order_with_dampers() {
    for entry in SCHEMES {
        let scheme = entry.with([]).unwrap();
        let error = |steps| (run(&*scheme, 2.0, steps).0.q[0] - closed_form(2.0)).abs();
        let (coarse, fine) = (error(400), error(800));
        let order = (coarse / fine).log2();
        let claimed = f64::from(scheme.claims().order);
        assert!((order - claimed).abs() < 0.15, "{}: order {order:.2}, not {claimed}", entry.name);
    }
}

#[test]
fn what_dampers_take_is_what_the_oscillator_loses() {
    for entry in SCHEMES {
        let scheme = entry.with([]).unwrap();
        if scheme.claims().energy || ["midpoint", "trapezoidal"].contains(&entry.name) {
            let (_, drift) = run(&*scheme, 2.0, 50);
            assert!(drift < 1e-13, "{}: {drift:e}", entry.name);
        }
    }
}
