//! A term of one's own: two point masses with charges. Shown: the traits `Term`, for forces with an energy, and `Vectors`, for vectors with a mass; a model of this term alone,
//! and its run. Checked: tangents against differences; work of the discrete gradient; energy, momenta and the place after one period of an elliptic orbit.
//!
//! `cargo run --example own_term -p stoss-solver`; docs/how-to-add/term.md explains it.

use std::error::Error;
use std::ops::Range;
use stoss_integrators::EnergyMomentum;
use stoss_linalg::AutoSolver;
use stoss_newton::NewtonOptions;
use stoss_solver::{InsideOutTreatment, Model, Settings, Simulation, StepControl};
use stoss_term::{At, Fault, ForceRule, Local, Term, Undefined, Vectors};

/// Point masses `a` and `b` with the energy `V = c / l` at the distance `l = |b - a|`; `c` is a force times length^2, negative for charges that attract each other.
#[derive(Clone, Debug)]
struct Charges {
    /// Number of the vector `a`; `b` is the next.
    first: u32,
    masses: [f64; 2],
    /// `c`.
    strength: f64,
}

/// `b - a` and its length.
fn arm(charges: &Charges, q: &[f64]) -> Result<([f64; 3], f64), Undefined> {
    let a = 3 * charges.first as usize;
    let r: [f64; 3] = std::array::from_fn(|i| q[a + 3 + i] - q[a + i]);
    let length = r[0].hypot(r[1]).hypot(r[2]);
    if length > 0.0 {
        Ok((r, length))
    } else {
        Err(Undefined {
            term: charges.name().into(),
            reason: "the charges are at the same place: the energy is infinite".into(),
        })
    }
}

impl Charges {
    /// Force on `b` as a gradient, `s d`, and its derivative by the arm at the end of the step, `s theta I + d (x) ds`: `s`, `d`, `theta`, `ds`.
    fn force(&self, at: &At<'_>, rule: ForceRule) -> Result<(f64, [f64; 3], f64, [f64; 3]), Undefined> {
        let c = self.strength;
        match rule {
            ForceRule::Configuration { theta } => {
                let between = |(a, b): (&f64, &f64)| (1.0 - theta) * a + theta * b;
                let q: Vec<f64> = at.q_n.iter().zip(at.q_np1).map(between).collect();
                let (r, l) = arm(self, &q)?;
                Ok((-c / l.powi(3), r, theta, r.map(|r| theta * 3.0 * c * r / l.powi(5))))
            }
            // With s = (V_1 - V_0) / (l_1^2 - l_0^2) and d = r_0 + r_1 the work s d . (r_1 - r_0) is the change of the energy. The quotient is written without the differences.
            ForceRule::DiscreteGradient => {
                let ((r_0, l_0), (r_1, l_1)) = (arm(self, at.q_n)?, arm(self, at.q_np1)?);
                let sum = l_0 + l_1;
                let slope = c * (l_0 + 2.0 * l_1) / (l_0 * (l_1 * sum).powi(2));
                let d = std::array::from_fn(|i| r_0[i] + r_1[i]);
                Ok((-c / (l_0 * l_1 * sum), d, 1.0, r_1.map(|r| slope * r / l_1)))
            }
        }
    }
}

impl Term for Charges {
    fn name(&self) -> &str {
        "charges"
    }
    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        visit(&[self.first, self.first + 1], &[]);
    }
    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.force() else { return Ok(()) };
        let (s, d, theta, ds) = self.force(at, rule)?;
        let mut local = Local { nodes: self.own_vectors().collect(), ..Local::default() };
        local.reset(want_tangent);
        // The arm is b - a: the same with the sign of each end.
        let ends = [(0, -1.0), (3, 1.0)];
        for (row, sign) in ends {
            for i in 0..3 {
                local.residual[row + i] = sign * s * d[i];
                for (column, other) in ends.into_iter().filter(|_| want_tangent) {
                    for j in 0..3 {
                        let unit = if i == j { s * theta } else { 0.0 };
                        local.tangent[6 * (row + i) + column + j] = sign * other * (unit + d[i] * ds[j]);
                    }
                }
            }
        }
        visit(&local);
        Ok(())
    }
    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        Ok(self.strength / arm(self, q)?.1)
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn force_scale(&self) -> f64 {
        self.strength.abs()
    }
    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for Charges {
    fn own_vectors(&self) -> Range<u32> {
        self.first..self.first + 2
    }
    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        for (vector, mass) in self.own_vectors().zip(self.masses) {
            visit(vector, vector, mass);
        }
    }
}

fn largest(differences: impl IntoIterator<Item = f64>) -> f64 {
    differences.into_iter().fold(0.0, |worst, d| worst.max(d.abs()))
}

/// Largest error of the tangent against differences, and of the work of the force against the change of the energy.
fn errors(rule: ForceRule) -> Result<[f64; 2], Fault> {
    let charges = Charges { first: 0, masses: [1.0; 2], strength: 1.7 };
    let (q_n, q) = ([0.1, -0.2, 0.3, 1.0, 0.4, -0.5], [0.3, -0.1, 0.2, 0.8, 0.9, -0.3]);
    let at = |q_np1: &[f64]| -> Result<Local, Fault> {
        let mut made = Local::default();
        charges.assemble(&At::force([&q_n, q_np1], rule, 1.0), true, &mut |local| made = local.clone())?;
        Ok(made)
    };
    let (made, h, mut worst) = (at(&q)?, 1e-6, 0.0_f64);
    for column in 0..6 {
        let moved = |h: f64| {
            let mut q = q;
            q[column] += h;
            at(&q)
        };
        let (plus, minus) = (moved(h)?.residual, moved(-h)?.residual);
        let row = |i: usize| (plus[i] - minus[i]) / (2.0 * h) - made.tangent[6 * i + column];
        worst = worst.max(largest((0..6).map(row)));
    }
    let work: f64 = (0..6).map(|i| made.residual[i] * (q[i] - q_n[i])).sum();
    Ok([worst, work - (charges.energy(&q)? - charges.energy(&q_n)?)])
}

/// Two charges that attract each other, in an orbit with this eccentricity about their centre of mass, which moves.
struct Orbit {
    charges: Charges,
    /// Places and velocities of both, where they are nearest to each other.
    start: [Vec<f64>; 2],
    period: f64,
    drift: [f64; 3],
}

fn orbit(eccentricity: f64) -> Orbit {
    let (masses, strength, axis) = ([2.0, 0.5], -3.0_f64, 1.2_f64);
    let total: f64 = masses.iter().sum();
    let reduced = masses[0] * masses[1] / total;
    let (nearest, pull) = (axis * (1.0 - eccentricity), -strength / reduced);
    let speed = (pull * (1.0 + eccentricity) / nearest).sqrt();
    let drift = [0.2, -0.1, 0.3];
    // Shares of the arm and of its velocity, with the centre of mass at the origin.
    let shares = [-masses[1] / total, masses[0] / total];
    let places = shares.iter().flat_map(|share| [share * nearest, 0.0, 0.0]).collect();
    let velocities = shares.iter().flat_map(|share| [drift[0], drift[1] + share * speed, drift[2]]).collect();
    let period = std::f64::consts::TAU * (axis.powi(3) / pull).sqrt();
    Orbit { charges: Charges { first: 0, masses, strength }, start: [places, velocities], period, drift }
}

/// Distance of a charge from its place after one period (closed form: that at the start, moved with the centre of mass).
fn miss(orbit: &Orbit, steps: u32) -> Result<f64, Box<dyn Error>> {
    let [reference, velocity] = orbit.start.clone();
    let model = Model { reference, velocity, parts: vec![Box::new(orbit.charges.clone())], ..Model::default() };
    let step = orbit.period / f64::from(steps);
    let settings = Settings {
        control: StepControl { step, end: orbit.period, max_cuts: 0, grow_after: 4, automatic: None },
        scheme: Some(Box::new(EnergyMomentum)),
        newton: NewtonOptions { relative_tolerance: 1e-11, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    let mut run = Simulation::new(model, settings)?;
    let first = *run.balance();
    while !run.finished() {
        let now = run.advance()?.balance;
        let change = |a: [f64; 3], b: [f64; 3]| largest((0..3).map(|i| a[i] - b[i]));
        assert!((now.total() - first.total()).abs() < 1e-11 * first.total().abs(), "{now:?}");
        assert!(change(now.linear_momentum, first.linear_momentum) < 1e-11, "{now:?}");
        assert!(change(now.angular_momentum, first.angular_momentum) < 1e-11, "{now:?}");
    }
    let q = &run.state().q;
    Ok(largest((0..6).map(|i| q[i] - orbit.start[0][i] - orbit.period * orbit.drift[i % 3])))
}

fn main() -> Result<(), Box<dyn Error>> {
    for rule in [ForceRule::END_POINT, ForceRule::MIDPOINT, ForceRule::DiscreteGradient] {
        let [tangent, work] = errors(rule)?;
        println!(
            "{rule:?}: tangent against differences {tangent:.1e}, work against the change of the energy {work:.1e}"
        );
        assert!(tangent < 1e-8);
        assert!(rule != ForceRule::DiscreteGradient || work.abs() < 1e-14);
    }
    let orbit = orbit(0.5);
    let mut last = None;
    println!("steps   error after one period   ratio to the one before");
    for steps in [200, 400, 800] {
        let miss = miss(&orbit, steps)?;
        // Second order: a quarter with half the step size.
        let ratio = last.map_or(4.0, |last: f64| last / miss);
        println!("{steps:5} {miss:24.3e} {ratio:25.2}");
        assert!((3.7..4.3).contains(&ratio));
        last = Some(miss);
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
