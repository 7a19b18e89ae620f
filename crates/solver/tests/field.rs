//! A term with unknowns that are no positions: temperatures along a chain of masses, springs and dashpots. What the dashpots dissipate heats their ends, heat flows along the chain, and warm dashpots resist
//! less. The solver knows vectors with one component, and nothing of temperatures.

use std::ops::Range;
use stoss_integrators::EnergyMomentum;
use stoss_linalg::AutoSolver;
use stoss_newton::NewtonOptions;
use stoss_solver::{InsideOutTreatment, Model, Settings, Simulation, StepControl};
use stoss_term::{At, Fault, ForceRule, Local, Term, Vectors, Work, check};

/// Point masses, the first vectors of the model.
#[derive(Debug)]
struct Masses(Vec<f64>);

impl Term for Masses {
    fn name(&self) -> &str {
        "masses"
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for Masses {
    fn own_vectors(&self) -> Range<u32> {
        0..self.0.len() as u32
    }
    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        (0..).zip(&self.0).for_each(|(vector, &mass)| visit(vector, vector, mass));
    }
}

/// Links between each of `count` masses and the next. A temperature is a number; times `heat` it is an energy, as a length times a force is.
#[derive(Clone, Debug)]
struct WarmChain {
    count: u32,
    /// Stiffness, a force over a length, and length of a link.
    stiffness: f64,
    length: f64,
    /// Viscosity at the temperature zero, a force over a velocity, and by how much of itself one over it grows with the temperature.
    viscosity: f64,
    thinning: f64,
    /// Energy of a link over its temperature, and heat that flows over time and difference of temperatures.
    heat: f64,
    conductance: f64,
}

/// The arm of a link, its end less its beginning.
fn arm(q: &[f64], link: u32) -> [f64; 3] {
    let a = 3 * link as usize;
    std::array::from_fn(|i| q[a + 3 + i] - q[a + i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

impl WarmChain {
    fn temperatures(&self, q: &[f64], link: u32) -> [f64; 2] {
        [0, 1].map(|end| q[3 * (self.count + link + end) as usize])
    }

    /// `V'` of `V = k / (8 L^2) (s - L^2)^2` with the squared length `s`, and `V''`.
    fn slope(&self, s: f64) -> [f64; 2] {
        let stiffness = self.stiffness / (4.0 * self.length * self.length);
        [stiffness * (s - self.length * self.length), stiffness]
    }

    fn strain_energy(&self, q: &[f64], link: u32) -> f64 {
        let excess = dot(arm(q, link), arm(q, link)) - self.length * self.length;
        self.stiffness / (8.0 * self.length * self.length) * excess * excess
    }

    fn add_link(&self, at: &At<'_>, rule: ForceRule, link: u32, local: &mut Local, want_tangent: bool) {
        let (r_0, r_1, dt) = (arm(at.q_n, link), arm(at.q_np1, link), at.dt);
        let ([a_0, b_0], [a_1, b_1]) = (self.temperatures(at.q_n, link), self.temperatures(at.q_np1, link));
        let mid: [f64; 3] = std::array::from_fn(|i| 0.5 * (r_0[i] + r_1[i]));
        // Where the spring is taken, its squared length, and their derivatives by the arm at the end.
        let (r, part, s, ds) = match rule {
            ForceRule::DiscreteGradient => (mid, 0.5, 0.5 * (dot(r_0, r_0) + dot(r_1, r_1)), r_1),
            ForceRule::Configuration { theta } => {
                let r: [f64; 3] = std::array::from_fn(|i| (1.0 - theta) * r_0[i] + theta * r_1[i]);
                (r, theta, dot(r, r), r.map(|r| 2.0 * theta * r))
            }
        };
        let [v, dv] = self.slope(s);
        let mean = 0.25 * (a_0 + b_0 + a_1 + b_1);
        let thin = 1.0 + self.thinning * mean;
        let c = if at.rates { self.viscosity / thin } else { 0.0 };
        let dc = -0.25 * c * self.thinning / thin;
        // Elongation in the step and what it dissipates.
        let x = (dot(r_1, r_1) - dot(r_0, r_0)) / (2.0 * self.length);
        let dissipated = c * x * x / dt;
        let pull = c * x / (dt * self.length);
        let flow = 0.5 * dt * self.conductance * (a_0 + a_1 - b_0 - b_1);
        for i in 0..3 {
            let f = 2.0 * v * r[i] + pull * mid[i];
            (local.residual[i], local.residual[3 + i]) = (-f, f);
        }
        local.residual[6] = 0.5 * (self.heat * (a_1 - a_0) - dissipated) + flow;
        local.residual[9] = 0.5 * (self.heat * (b_1 - b_0) - dissipated) - flow;
        if !want_tangent {
            return;
        }
        let mut add = |row: usize, column: usize, value: f64| local.tangent[12 * row + column] += value;
        for (row, sign) in [(0, -1.0), (3, 1.0)] {
            for i in 0..3 {
                for (column, other) in [(0, -1.0), (3, 1.0)] {
                    for j in 0..3 {
                        let unit = if i == j { 2.0 * v * part + 0.5 * pull } else { 0.0 };
                        let viscous = c / (dt * self.length * self.length) * mid[i] * r_1[j];
                        add(row + i, column + j, sign * other * (unit + 2.0 * dv * r[i] * ds[j] + viscous));
                    }
                }
                [6, 9].iter().for_each(|&column| add(row + i, column, sign * dc * x / (dt * self.length) * mid[i]));
            }
        }
        for (row, sign) in [(6, 1.0), (9, -1.0)] {
            for (column, other) in [(0, -1.0), (3, 1.0)] {
                (0..3).for_each(|j| add(row, column + j, -other * c * x / (dt * self.length) * r_1[j]));
            }
            let conducts = 0.5 * dt * self.conductance * sign;
            for (column, other) in [(6, 1.0), (9, -1.0)] {
                let own = if row == column { 0.5 * self.heat } else { 0.0 };
                add(row, column, own + other * conducts - 0.5 * dc * x * x / dt);
            }
        }
    }
}

impl Term for WarmChain {
    fn name(&self) -> &str {
        "chain"
    }
    fn length_scale(&self) -> f64 {
        self.length
    }
    fn force_scale(&self) -> f64 {
        self.stiffness * self.length
    }
    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let n = self.count;
        (0..n - 1).for_each(|link| visit(&[link, link + 1, n + link, n + link + 1], &[]));
    }
    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.force() else { return Ok(()) };
        let (mut local, n) = (Local::default(), self.count);
        for link in 0..n - 1 {
            local.begin(&[link, link + 1, n + link, n + link + 1], want_tangent);
            self.add_link(at, rule, link, &mut local, want_tangent);
            visit(&local);
        }
        Ok(())
    }
    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        let of = |link: u32| {
            let [a, b] = self.temperatures(q, link);
            self.strain_energy(q, link) + 0.5 * self.heat * (a + b)
        };
        Ok((0..self.count - 1).map(of).sum())
    }
    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        // What the dashpots dissipate is stored as heat.
        Ok(Work { stored: self.energy(at.q_np1)?, ..Work::default() })
    }
    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for WarmChain {
    fn own_vectors(&self) -> Range<u32> {
        self.count..2 * self.count
    }
    fn width(&self) -> usize {
        1
    }
    fn is_direction(&self, _vector: u32) -> bool {
        true
    }
}

fn chain(count: u32) -> WarmChain {
    WarmChain { count, stiffness: 40.0, length: 1.0, viscosity: 0.8, thinning: 0.3, heat: 2.0, conductance: 0.7 }
}

fn run(chain: &WarmChain, temperatures: &[f64], speed: f64, step: f64, end: f64) -> Simulation {
    let n = chain.count as usize;
    let reference: Vec<f64> = (0..n)
        .flat_map(|k| [k as f64, 0.0, 0.1 * speed * (k % 2) as f64])
        .chain(temperatures.iter().flat_map(|t| [*t, 0.0, 0.0]))
        .collect();
    let mut velocity = vec![0.0; reference.len()];
    for k in 0..n {
        velocity[3 * k] = speed * (1.9 * k as f64).sin();
        velocity[3 * k + 1] = 0.4 * speed * k as f64;
    }
    let masses = Masses((0..n).map(|k| 1.0 + 0.2 * k as f64).collect());
    let parts: Vec<Box<dyn Term>> = vec![Box::new(masses), Box::new(chain.clone())];
    let settings = Settings {
        control: StepControl { step, end, max_cuts: 0, grow_after: 4, automatic: None },
        scheme: Some(Box::new(EnergyMomentum)),
        newton: NewtonOptions { relative_tolerance: 1e-11, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    Simulation::new(Model { reference, velocity, parts, ..Model::default() }, settings).unwrap()
}

fn temperatures(run: &Simulation, count: usize) -> Vec<f64> {
    run.state().q[3 * count..].iter().step_by(3).copied().collect()
}

#[test]
fn the_tangent_is_the_derivative() {
    let mut chain = chain(3);
    let q_n: Vec<f64> = (0..18).map(|k| [0.5 * f64::from(k), 0.3, 0.1 * f64::from(k % 4)][k as usize % 3]).collect();
    let q: Vec<f64> = q_n.iter().enumerate().map(|(k, q)| q + 0.1 * (1.3 * k as f64).sin()).collect();
    for rule in [ForceRule::DiscreteGradient, ForceRule::END_POINT, ForceRule::MIDPOINT] {
        let at = At::force([&q_n, &q], rule, 0.05);
        for seed in 0..3 {
            let direction = check::direction(&chain, 6, seed, 1.0, 1.0);
            let found = check::derivative(&mut chain, &at, &direction, 1e-5).unwrap();
            assert!(found.deviation < 1e-8, "{rule:?} {found:?}");
        }
        let found = check::promises(&mut chain, &at, &|vector| vector >= 3).unwrap();
        assert!(found.is_pure && found.has_order && found.resultant < 1e-14, "{found:?}");
    }
}

#[test]
fn dissipated_energy_becomes_heat() {
    let count = 5;
    let mut run = run(&chain(count as u32), &[0.0; 5], 1.0, 0.02, 4.0);
    let plan = run.plan();
    // Three components of each position and one of each temperature.
    assert_eq!(plan.free_components, 4 * count);
    let (first, mut checkpoint) = (*run.balance(), None);
    let mut remainder = 0.0_f64;
    while !run.finished() {
        let record = run.advance().unwrap();
        let now = record.balance;
        assert!((now.total() / first.total() - 1.0).abs() < 1e-12, "{now:?}");
        for i in 0..3 {
            assert!((now.linear_momentum[i] - first.linear_momentum[i]).abs() < 1e-11, "{now:?}");
            assert!((now.angular_momentum[i] - first.angular_momentum[i]).abs() < 1e-11, "{now:?}");
        }
        remainder = remainder.max(record.books.parts[1].remainder.abs());
        if record.step == 100 {
            checkpoint = Some(run.checkpoint("t", Default::default()));
        }
    }
    assert!(remainder < 1e-12 * first.total(), "{remainder}");
    let warm = temperatures(&run, count);
    let heat = 2.0 * (0.5 * (warm[0] + warm[4]) + warm[1] + warm[2] + warm[3]);
    let lost = first.total() - run.balance().kinetic - (run.balance().strain - heat);
    assert!(heat > 0.1 * first.total() && (heat / lost - 1.0).abs() < 1e-11, "{heat} {lost}");
    assert!(warm.iter().all(|t| *t > 0.0), "{warm:?}");
    // The field is a part of the state.
    let mut resumed = self::run(&chain(count as u32), &[0.0; 5], 1.0, 0.02, 4.0);
    resumed.restore(checkpoint.unwrap(), "t").unwrap();
    while !resumed.finished() {
        resumed.advance().unwrap();
    }
    assert_eq!(run.state().q, resumed.state().q);
}

/// Two ends of half the heat capacity each: the difference of their temperatures obeys `D' = -4 h / C D`, and the midpoint rule multiplies it by a rational number a step.
#[test]
fn heat_alone_diffuses() {
    let (chain, step) = (chain(2), 0.05);
    let mut run = run(&chain, &[3.0, 1.0], 0.0, step, 1.0);
    // At rest at its length: no force.
    let z = 4.0 * chain.conductance / chain.heat * step;
    let mut expected = 2.0;
    while !run.finished() {
        run.advance().unwrap();
        expected *= (1.0 - 0.5 * z) / (1.0 + 0.5 * z);
        let [a, b] = [0, 1].map(|end| temperatures(&run, 2)[end]);
        assert!((a + b - 4.0).abs() < 1e-12 && (a - b - expected).abs() < 1e-10 * expected.abs().max(1.0), "{a} {b}");
    }
}
