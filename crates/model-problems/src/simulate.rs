//! The loop over steps, for any problem and any scheme.

use crate::dense::Dense;
use crate::{ModelError, ModelProblem};
use nalgebra::DVector;
use stoss_integrators::{Buffers, EndPoint, Scheme, Step, evaluate, finish, start};
use stoss_newton::{NewtonFailure, NewtonOptions, NewtonProblem, ResidualNorms, solve};

/// Coordinates above this value count as unbounded.
const UNBOUNDED: f64 = 1e8;
/// Largest number of changes of the active set in a step.
const MAX_SET_CHANGES: usize = 20;

/// State and balance after a step.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Number of the step; 0 is the start.
    pub step: u64,
    /// Time.
    pub time: f64,
    /// Positions (augmented coordinates last).
    pub q: &'a [f64],
    /// Velocities.
    pub v: &'a [f64],
    /// Multipliers.
    pub multipliers: &'a [f64],
    /// Kinetic and potential energy.
    pub kinetic: f64,
    /// Potential energy.
    pub potential: f64,
    /// Linear momentum (zero without points in space).
    pub linear_momentum: [f64; 3],
    /// Angular momentum about the origin.
    pub angular_momentum: [f64; 3],
    /// Largest violation `|Phi|` of bilateral constraints, `max(-Phi, 0)` of unilateral ones.
    pub violation: f64,
}

impl Sample<'_> {
    /// Kinetic and potential energy together.
    pub fn energy(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// Numerical effort of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Steps done.
    pub steps: u64,
    /// Evaluations of the forces.
    pub evaluations: u64,
    /// Linear systems solved.
    pub solves: u64,
    /// Number of steps in which Newton failed from the last positions and was restarted from the predictor. (From the last positions, because stiff
    /// problems at large steps have several solutions, and that start finds the smallest step.)
    pub restarts: u64,
}

/// Iterate of a step, see [`EndPoint`].
struct Motion {
    q: Vec<f64>,
    increment: Vec<f64>,
}

impl Motion {
    fn end_point(&self) -> EndPoint<'_> {
        EndPoint { q: &self.q, increment: &self.increment }
    }

    fn rest(&mut self, q_n: &[f64]) {
        self.q.copy_from_slice(q_n);
        self.increment.fill(0.0);
    }

    fn predict(&mut self, scheme: &dyn Scheme, step: &Step<'_>) {
        scheme.predict(step.state_n, step.dt, &mut self.increment);
        for ((q, increment), q_n) in self.q.iter_mut().zip(&self.increment).zip(&step.state_n.q) {
            *q = q_n + increment;
        }
    }
}

struct StepProblem<'a, 'p> {
    system: &'a mut Dense<'p>,
    step: Step<'a>,
    buffers: &'a mut Buffers,
    end: &'a mut Motion,
    base: (Vec<f64>, Vec<f64>),
    residual: DVector<f64>,
    increment: DVector<f64>,
    solves: u64,
}

impl StepProblem<'_, '_> {
    fn evaluate(&mut self, tangent: bool) -> Result<ResidualNorms, ModelError> {
        evaluate(self.system, &self.step, self.end.end_point(), tangent, self.buffers)?;
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let b = &self.buffers;
        // The inertia of the whole position, not of the step, is what round-off is relative to.
        let rule = &self.step.rule;
        let inertia = rule.inertia.increment * self.system.mass.amax() * norm(&self.end.q);
        let scale = (rule.force.weight * norm(&b.force)).max(norm(&b.constraint)).max(inertia);
        let n = b.residual.len();
        self.residual.rows_mut(0, n).copy_from_slice(&b.residual);
        self.residual.rows_mut(n, self.system.rows.len()).copy_from_slice(&self.system.rows);
        let rows = self.system.rows.iter().zip(&self.system.active).filter(|(_, active)| **active);
        let violation = rows.map(|(row, _)| row.abs()).fold(0.0, f64::max);
        Ok(ResidualNorms { residual: norm(&b.residual).max(scale * violation), scale })
    }
}

impl NewtonProblem for StepProblem<'_, '_> {
    type Error = ModelError;

    fn assemble(&mut self) -> Result<ResidualNorms, ModelError> {
        self.evaluate(true)
    }

    fn solve(&mut self) -> Result<f64, ModelError> {
        let solution = self.system.tangent.clone().lu().solve(&self.residual).ok_or(ModelError::SingularTangent)?;
        self.increment = -solution;
        self.base = (self.end.increment.clone(), self.system.multipliers.clone());
        self.solves += 1;
        Ok(self.increment.rows(0, self.end.q.len()).norm())
    }

    fn update(&mut self, factor: f64) -> Result<(), ModelError> {
        let n = self.end.q.len();
        for (i, q_n) in self.step.state_n.q.iter().enumerate() {
            self.end.increment[i] = self.base.0[i] + factor * self.increment[i];
            self.end.q[i] = q_n + self.end.increment[i];
        }
        for (k, p) in self.system.multipliers.iter_mut().enumerate() {
            *p = self.base.1[k] + factor * self.increment[n + k];
        }
        Ok(())
    }

    fn iterate_norm(&self) -> f64 {
        self.end.q.iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

fn options() -> NewtonOptions {
    // Stiff problems at large steps wander before they converge.
    NewtonOptions {
        relative_tolerance: 1e-14,
        polish: 2,
        max_iterations: 100,
        stagnation_iterations: 50,
        divergence_factor: 1e16,
        ..NewtonOptions::default()
    }
}

/// Runs `steps` steps of size `dt`; `observe` sees the start and every completed step.
///
/// # Errors
/// [`ModelError`]; the first failing step ends the run, for step sizes are what these problems are about.
pub fn simulate(
    problem: &dyn ModelProblem,
    scheme: &dyn Scheme,
    dt: f64,
    steps: u64,
    mut observe: impl FnMut(&Sample<'_>),
) -> Result<Effort, ModelError> {
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(ModelError::StepSize { dt });
    }
    let (n, m) = (problem.dimension(), problem.constraint_count());
    if m > 0 && !scheme.claims().constraints {
        return Err(ModelError::Constraints { scheme: scheme.name().into(), problem: problem.name().into() });
    }
    let rule = scheme.rule(dt);
    let mut system = Dense::new(problem);
    let mut buffers = Buffers::new(n, true, m > 0);
    let mut state = problem.initial_state();
    start(&mut system, &rule, &mut state)?;
    observe(&sample(&system, 0, &state));
    let mut effort = Effort::default();
    let mut next = state.clone();
    let mut end = Motion { q: vec![0.0; n], increment: vec![0.0; n] };
    for number in 1..=steps {
        let step = Step { state_n: &state, dt, rule };
        attempt(&mut system, scheme, step, &mut buffers, &mut end, number, &mut effort)?;
        next.q.copy_from_slice(&end.q);
        finish(&mut system, &step, &end.increment, &mut buffers, &mut next)?;
        // Counted, not summed up.
        next.time = number as f64 * dt;
        std::mem::swap(&mut state, &mut next);
        effort.steps = number;
        effort.evaluations = system.evaluations;
        let escaped =
            state.q.iter().chain(&state.v).any(|x| !x.is_finite()) || state.q.iter().any(|x| x.abs() > UNBOUNDED);
        if escaped {
            return Err(ModelError::Unbounded { step: number, time: state.time });
        }
        observe(&sample(&system, number, &state));
    }
    Ok(effort)
}

/// Solves a step for its end, active set included.
fn attempt(
    system: &mut Dense<'_>,
    scheme: &dyn Scheme,
    step: Step<'_>,
    buffers: &mut Buffers,
    end: &mut Motion,
    number: u64,
    effort: &mut Effort,
) -> Result<(), ModelError> {
    let time = step.state_n.time;
    for _ in 0..MAX_SET_CHANGES {
        let multipliers = system.multipliers.clone();
        end.rest(&step.state_n.q);
        let mut reason = newton(system, step, buffers, end, effort)?;
        if reason.is_some() {
            effort.restarts += 1;
            end.predict(scheme, &step);
            system.multipliers = multipliers;
            reason = newton(system, step, buffers, end, effort)?;
        }
        if let Some(reason) = reason {
            return Err(ModelError::Newton { step: number, time, reason });
        }
        if !system.problem.is_unilateral() || !change_active_set(system, &end.q) {
            return Ok(());
        }
    }
    Err(ModelError::ActiveSet { step: number, time })
}

/// Newton's method from `end`; the reason if it does not converge.
fn newton(
    system: &mut Dense<'_>,
    step: Step<'_>,
    buffers: &mut Buffers,
    end: &mut Motion,
    effort: &mut Effort,
) -> Result<Option<String>, ModelError> {
    let (n, m) = (end.q.len(), system.rows.len());
    let mut problem = StepProblem {
        system,
        step,
        buffers,
        end,
        base: (vec![0.0; n], vec![0.0; m]),
        residual: DVector::zeros(n + m),
        increment: DVector::zeros(n + m),
        solves: 0,
    };
    let result = solve(&mut problem, &options());
    effort.solves += problem.solves;
    match result {
        Ok(_) => Ok(None),
        Err(NewtonFailure::Problem { error, .. }) => Err(error),
        Err(NewtonFailure::NotConverged(report)) => Ok(Some(report.reason.to_string())),
    }
}

/// theory/constraints#eq-active-set: an active constraint opens when its multiplier pulls, an open one closes when it is violated.
fn change_active_set(system: &mut Dense<'_>, q: &[f64]) -> bool {
    let mut phi = vec![0.0; system.rows.len()];
    system.problem.constraints(q, &mut phi);
    let mut changed = false;
    for (k, phi) in phi.into_iter().enumerate() {
        let wanted = if system.active[k] { system.multipliers[k] >= 0.0 } else { phi < 0.0 };
        changed |= wanted != system.active[k];
        system.active[k] = wanted;
        if !wanted {
            system.multipliers[k] = 0.0;
        }
    }
    changed
}

fn sample<'a>(system: &'a Dense<'_>, step: u64, state: &'a stoss_integrators::State) -> Sample<'a> {
    use stoss_integrators::SecondOrderSystem;
    let (q, v) = (state.q.as_slice(), state.v.as_slice());
    let mut momenta = vec![0.0; q.len()];
    system.add_mass_product(1.0, v, &mut momenta);
    let kinetic = 0.5 * momenta.iter().zip(v).map(|(p, v)| p * v).sum::<f64>();
    let (mut linear_momentum, mut angular_momentum) = ([0.0; 3], [0.0; 3]);
    for (x, p) in q.chunks_exact(3).zip(momenta.chunks_exact(3)).take(system.problem.spatial_nodes()) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            linear_momentum[i] += p[i];
            angular_momentum[i] += x[j] * p[k] - x[k] * p[j];
        }
    }
    let mut phi = vec![0.0; system.rows.len()];
    system.problem.constraints(q, &mut phi);
    let unilateral = system.problem.is_unilateral();
    let violation = phi.iter().map(|&f| if unilateral { (-f).max(0.0) } else { f.abs() }).fold(0.0, f64::max);
    Sample {
        step,
        time: state.time,
        q,
        v,
        multipliers: &system.multipliers,
        kinetic,
        potential: system.problem.potential(q),
        linear_momentum,
        angular_momentum,
        violation,
    }
}
