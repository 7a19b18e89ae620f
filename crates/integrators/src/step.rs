//! One step, for any scheme and any system.

use crate::{
    Combination, ConstraintTerm, DampingTangent, ForceRule, SecondOrderSystem, State, StepConfiguration, StepRule,
};
use std::ops::Range;

/// A step of a scheme that is being solved: its begin, its size and the equations for that size.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// State at the beginning.
    pub state_n: &'a State,
    /// Size of the step.
    pub dt: f64,
    /// Equations of the scheme for that size.
    pub rule: StepRule,
}

/// The end of a step: positions and increment. `q_np1 - q_n` has the round-off of the positions, which velocities and inertia
/// would divide by the step size.
/// Iterations therefore update the increment, `q_np1 = q_n + increment`, and everything that is divided by the step size is computed from it.
#[derive(Clone, Copy, Debug)]
pub struct EndPoint<'a> {
    /// `q_np1`.
    pub q: &'a [f64],
    /// `q_np1 - q_n`.
    pub increment: &'a [f64],
}

impl<'a> Step<'a> {
    fn configuration<'q>(&self, q_np1: &'q [f64]) -> StepConfiguration<'q>
    where
        'a: 'q,
    {
        StepConfiguration { time: self.state_n.time, dt: self.dt, q_n: &self.state_n.q, q_np1 }
    }

    /// Configuration `q_n + theta increment` at which damping forces are evaluated, and the velocity there. Schemes that carry an acceleration use their own velocity
    /// at the time of the equilibrium; all others use the mean velocity `increment / dt` at the midpoint, so that force times velocity is exactly the mean
    /// power of the step.
    fn rate(&self) -> (f64, Combination) {
        let StepRule { force, velocity, acceleration, .. } = &self.rule;
        if acceleration.is_none() {
            return (0.5, Combination::new(1.0 / self.dt, 0.0));
        }
        let theta = force.rule.load_fraction() * force.weight;
        let Combination { increment, velocity, acceleration } = *velocity;
        let rate = Combination {
            increment: theta * increment,
            velocity: theta * velocity + (1.0 - theta),
            acceleration: theta * acceleration,
        };
        (theta, rate)
    }

    /// A combination of increment and state, for the coordinates `own` of `out`.
    fn combine(&self, c: Combination, increment: &[f64], own: &[Range<usize>], out: &mut [f64]) {
        let State { v, a, .. } = self.state_n;
        for own in own {
            let (out, increment) = (&mut out[own.clone()], &increment[own.clone()]);
            for ((out, increment), v0) in out.iter_mut().zip(increment).zip(&v[own.clone()]) {
                *out = c.increment * increment + c.velocity * v0;
            }
            if c.acceleration != 0.0 {
                for (out, a0) in out.iter_mut().zip(&a[own.clone()]) {
                    *out += c.acceleration * a0;
                }
            }
        }
    }
}

/// Vectors of a step, allocated once; empty if a run does not need them.
#[derive(Clone, Debug, Default)]
pub struct Buffers {
    /// `R`, without the constraint rows.
    pub residual: Vec<f64>,
    /// `F_rule`, not weighted.
    pub force: Vec<f64>,
    /// `G_rule^T p`, not weighted.
    pub constraint: Vec<f64>,
    /// `M a_alg`.
    pub inertia: Vec<f64>,
    /// Damping forces, not weighted; empty without damping.
    pub damping: Vec<f64>,
    /// Velocity at which the damping forces are evaluated.
    pub rate: Vec<f64>,
    /// Positions at which dampers act.
    damped_at: Vec<f64>,
    scratch: Vec<f64>,
    /// Coordinates that the residual is formed at.
    own: Vec<Range<usize>>,
}

impl Buffers {
    /// Buffers for a system with that many coordinates.
    pub fn new(dimension: usize, inertia: bool, constraints: bool) -> Self {
        Self::with_own(dimension, std::iter::once(0..dimension).collect(), inertia, constraints)
    }

    /// Buffers for a system of which only the coordinates `own` have equations. The others are not changed, in the states neither: the caller updates
    /// them. They have no mass and no force, and constraint forces on them (`constraint`) are not in the residual.
    pub fn with_own(dimension: usize, own: Vec<Range<usize>>, inertia: bool, constraints: bool) -> Self {
        let vector = |wanted| vec![0.0; if wanted { dimension } else { 0 }];
        Self {
            residual: vector(true),
            force: vector(true),
            constraint: vector(constraints),
            inertia: vector(inertia),
            scratch: vector(inertia),
            own,
            ..Self::default()
        }
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        let all = [&self.residual, &self.force, &self.constraint, &self.inertia, &self.scratch];
        let damping = [&self.damping, &self.rate, &self.damped_at];
        all.into_iter().chain(damping).map(|v| 8 * v.capacity()).sum()
    }
}

fn damping_weight<S: SecondOrderSystem>(system: &S, rule: &StepRule) -> f64 {
    if system.has_damping() { rule.damping_weight() } else { 0.0 }
}

/// Damping forces of a step into `damping`, and their velocity; with `tangent` also that factor times their derivative.
fn damp<S: SecondOrderSystem>(
    system: &mut S,
    step: &Step<'_>,
    increment: &[f64],
    tangent: Option<f64>,
    buffers: &mut Buffers,
) -> Result<(), S::Error> {
    let Buffers { damping, rate, damped_at, own, .. } = buffers;
    for buffer in [&mut *damping, &mut *rate, &mut *damped_at] {
        buffer.resize(system.dimension(), 0.0);
    }
    let (theta, velocity) = step.rate();
    step.combine(velocity, increment, own, rate);
    for own in &*own {
        let positions = step.state_n.q[own.clone()].iter().zip(&increment[own.clone()]);
        for (at, (q, increment)) in damped_at[own.clone()].iter_mut().zip(positions) {
            *at = q + theta * increment;
        }
    }
    clear(own, damping);
    let tangent = tangent.map(|weight| DampingTangent { weight, position: theta, rate: velocity.increment });
    system.add_damping(damped_at, rate, tangent, damping)
}

/// `out += factor x` for the coordinates `own`; nothing if `x` is empty.
fn add(factor: f64, x: &[f64], own: &[Range<usize>], out: &mut [f64]) {
    for own in own.iter().filter(|_| !x.is_empty()) {
        for (out, x) in out[own.clone()].iter_mut().zip(&x[own.clone()]) {
            *out += factor * x;
        }
    }
}

fn clear(own: &[Range<usize>], out: &mut [f64]) {
    if !out.is_empty() {
        own.iter().for_each(|own| out[own.clone()].fill(0.0));
    }
}

/// Residual of the step at `end` into `buffers.residual`, its terms into the other buffers; with `tangent` the system's tangent too.
///
/// # Errors
/// The errors of the system; the buffers are then undefined.
pub fn evaluate<S: SecondOrderSystem>(
    system: &mut S,
    step: &Step<'_>,
    end: EndPoint<'_>,
    tangent: bool,
    buffers: &mut Buffers,
) -> Result<(), S::Error> {
    let rule = &step.rule;
    if tangent {
        system.start_tangent(rule.inertia.increment);
    }
    let damping_weight = damping_weight(system, rule);
    if damping_weight != 0.0 {
        damp(system, step, end.increment, tangent.then_some(damping_weight), buffers)?;
    }
    let Buffers { force, inertia, scratch, own, .. } = &mut *buffers;
    clear(own, force);
    if rule.force.weight != 0.0 {
        let tangent = tangent.then_some(rule.force.weight);
        system.add_force(step.configuration(end.q), rule.force.rule, tangent, force)?;
    }
    if rule.has_inertia() {
        step.combine(rule.inertia, end.increment, own, scratch);
        clear(own, inertia);
        system.add_mass_product(1.0, scratch, inertia);
    }
    evaluate_constraints(system, step, end.q, tangent, buffers)
}

/// Evaluates as [`evaluate`] at the same `end`, after nothing has changed but multipliers and which constraints act: all other terms, and their tangent if it
/// is wanted, are those of the last evaluation.
///
/// # Errors
/// The errors of [`evaluate`].
pub fn evaluate_constraints<S: SecondOrderSystem>(
    system: &mut S,
    step: &Step<'_>,
    q_np1: &[f64],
    tangent: bool,
    buffers: &mut Buffers,
) -> Result<(), S::Error> {
    let rule = &step.rule;
    let damping_weight = damping_weight(system, rule);
    let Buffers { residual, force, constraint, inertia, damping, own, .. } = buffers;
    clear(own, residual);
    if damping_weight != 0.0 {
        add(damping_weight, damping, own, residual);
    }
    if rule.force.weight != 0.0 {
        add(rule.force.weight, force, own, residual);
    }
    if rule.has_inertia() {
        add(1.0, inertia, own, residual);
    }
    if let Some(history) = rule.history {
        // Empty if there is nothing to remember.
        if !step.state_n.history.is_empty() {
            add(history.weight, &step.state_n.history, own, residual);
        }
    }
    if system.has_constraints() {
        clear(own, constraint);
        let ConstraintTerm { rule, weight } = rule.constraint;
        system.add_constraint_force(step.configuration(q_np1), rule, weight, tangent, constraint)?;
        add(-weight, constraint, own, residual);
    }
    Ok(())
}

/// Velocity, acceleration and history at `n+1` from the converged `q_np1` and its `increment` ([`EndPoint`]), whose [`evaluate`] was the last one with these buffers.
/// `next.q` holds `q_np1`; on entry `next.v` holds the prescribed velocities, for schemes that update momenta.
/// Returns the reaction impulse over `dt` that the update of momenta leaves at prescribed coordinates, to be added to the residual there (in
/// `buffers.inertia`, which is overwritten): true if there is one.
///
/// # Errors
/// The errors of the system.
pub fn finish<S: SecondOrderSystem>(
    system: &mut S,
    step: &Step<'_>,
    increment: &[f64],
    buffers: &mut Buffers,
    next: &mut State,
) -> Result<bool, S::Error> {
    let rule = &step.rule;
    let damps = rule.impulse.is_some() && system.has_damping();
    if damps && rule.damping_weight() == 0.0 {
        damp(system, step, increment, None, buffers)?;
    }
    let Buffers { force, constraint, inertia, damping, scratch, own, .. } = buffers;
    next.time = step.state_n.time + step.dt;
    if let Some(impulse) = rule.impulse {
        if rule.force.weight == 0.0 {
            clear(own, force);
            system.add_force(step.configuration(&next.q), rule.force.rule, None, force)?;
        }
        step.combine(rule.velocity, increment, own, scratch);
        // The momenta that the velocities must have; then the residual of that at prescribed coordinates.
        clear(own, inertia);
        system.add_mass_product(1.0, scratch, inertia);
        add(impulse, force, own, inertia);
        if damps {
            add(impulse, damping, own, inertia);
        }
        system.solve_mass(inertia, &mut next.v)?;
        for value in own.iter().flat_map(|own| own.clone()) {
            inertia[value] = -inertia[value] / step.dt;
        }
        system.add_mass_product(1.0 / step.dt, &next.v, inertia);
    } else {
        step.combine(rule.velocity, increment, own, &mut next.v);
    }
    if let Some(acceleration) = rule.acceleration {
        next.a.resize(next.q.len(), 0.0);
        step.combine(acceleration, increment, own, &mut next.a);
    }
    if let Some(history) = rule.history.filter(|history| history.is_needed(system.has_constraints())) {
        next.history.clear();
        next.history.resize(next.q.len(), 0.0);
        if history.force {
            add(1.0, force, own, &mut next.history);
        }
        if history.constraint && system.has_constraints() {
            add(-1.0, constraint, own, &mut next.history);
        }
    }
    Ok(rule.impulse.is_some())
}

/// Completes an initial state: `M a_0 = -F(q_0) - D(q_0, v_0)` with the damping forces `D`, and `H_0 = F(q_0)`, for schemes that carry them. Multipliers are zero.
///
/// # Errors
/// The errors of the system.
pub fn start<S: SecondOrderSystem>(system: &mut S, rule: &StepRule, state: &mut State) -> Result<(), S::Error> {
    let n = state.q.len();
    let keeps_force = rule.history.is_some_and(|history| history.force);
    let mut force = vec![0.0; n];
    if rule.acceleration.is_some() || keeps_force {
        let at = StepConfiguration { time: state.time, dt: 0.0, q_n: &state.q, q_np1: &state.q };
        system.add_force(at, ForceRule::END_POINT, None, &mut force)?;
    }
    if rule.acceleration.is_some() {
        let mut rhs: Vec<f64> = force.iter().map(|f| -f).collect();
        if system.has_damping() {
            let mut damping = vec![0.0; n];
            system.add_damping(&state.q, &state.v, None, &mut damping)?;
            rhs.iter_mut().zip(damping).for_each(|(rhs, d)| *rhs -= d);
        }
        state.a.clear();
        state.a.resize(n, 0.0);
        system.solve_mass(&rhs, &mut state.a)?;
    }
    if rule.history.is_some_and(|history| history.is_needed(system.has_constraints())) {
        state.history = if keeps_force { force } else { vec![0.0; n] };
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SCHEMES;
    use std::convert::Infallible;

    /// A mass point without forces.
    struct Free;

    impl SecondOrderSystem for Free {
        type Error = Infallible;
        fn dimension(&self) -> usize {
            1
        }
        fn has_constraints(&self) -> bool {
            false
        }
        fn add_mass_product(&self, factor: f64, x: &[f64], out: &mut [f64]) {
            out[0] += 2.0 * factor * x[0];
        }
        fn solve_mass(&mut self, rhs: &[f64], x: &mut [f64]) -> Result<(), Infallible> {
            x[0] = rhs[0] / 2.0;
            Ok(())
        }
        fn start_tangent(&mut self, _factor: f64) {}
        fn add_force(
            &mut self,
            _step: StepConfiguration<'_>,
            _rule: ForceRule,
            _tangent: Option<f64>,
            _out: &mut [f64],
        ) -> Result<(), Infallible> {
            Ok(())
        }
    }

    /// Positions at 1e6, which are known to 1e-10, and their differences over the step size to 1e-5.
    #[test]
    fn far_from_the_origin_a_free_mass_keeps_its_velocity() {
        for row in SCHEMES {
            let (dt, scheme) = (1e-5, row.with([]).unwrap());
            let rule = scheme.rule(dt);
            let mut state = State::new(vec![1e6], vec![0.1]);
            start(&mut Free, &rule, &mut state).unwrap();
            let mut buffers = Buffers::new(1, true, false);
            for _ in 0..1000 {
                let step = Step { state_n: &state, dt, rule };
                let mut increment = vec![0.0];
                for _ in 0..2 {
                    let q = [state.q[0] + increment[0]];
                    let end = EndPoint { q: &q, increment: &increment };
                    evaluate(&mut Free, &step, end, false, &mut buffers).unwrap();
                    increment[0] -= buffers.residual[0] / (2.0 * rule.inertia.increment);
                }
                let mut next = State { q: vec![state.q[0] + increment[0]], ..state.clone() };
                finish(&mut Free, &step, &increment, &mut buffers, &mut next).unwrap();
                state = next;
            }
            let error = (state.v[0] / 0.1 - 1.0).abs();
            assert!(error < 1e-12, "{}: {error:e}", row.name);
        }
    }
}
