//! A part that remembers: an elastic spring in series with a slider, between a mass and the ground. It is begun, worked out, committed, saved and loaded as contact is, and what the slider takes is in
//! the books and in the balance.

use std::ops::Range;
use stoss_integrators::EnergyMomentum;
use stoss_linalg::AutoSolver;
use stoss_newton::NewtonOptions;
use stoss_solver::{InsideOutTreatment, Model, Release, Settings, Simulation, StepControl};
use stoss_term::{At, Fault, ForceRule, Local, StepContext, Term, Undefined, Vectors, Work};

const STIFFNESS: f64 = 30.0;
/// Elongation at which it slides.
const LIMIT: f64 = 0.1;

#[derive(Debug)]
struct Mass;

impl Term for Mass {
    fn name(&self) -> &str {
        "mass"
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for Mass {
    fn own_vectors(&self) -> Range<u32> {
        0..1
    }
    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        visit(0, 0, 2.0);
    }
}

/// Along x. The force of a step is the mean of those at both ends, so that its work is what is stored and what the slider takes, exactly.
#[derive(Debug, Default)]
struct Slider {
    /// Elongation of the spring at the end of the last accepted step.
    elastic: f64,
    /// What `begin` was told.
    begun: Option<(ForceRule, f64)>,
}

impl Slider {
    /// Elongation at the end, and the way of the slider.
    fn end(&self, at: &At<'_>) -> (f64, f64) {
        let trial = self.elastic + at.q_np1[0] - at.q_n[0];
        let elastic = trial.clamp(-LIMIT, LIMIT);
        (elastic, trial - elastic)
    }
}

impl Term for Slider {
    fn name(&self) -> &str {
        "slider"
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn force_scale(&self) -> f64 {
        STIFFNESS
    }
    fn conserves_linear_momentum(&self) -> bool {
        false
    }
    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        self.begun = Some((step.force, step.dt));
        Ok(())
    }
    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        visit(&[0], &[]);
    }
    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.force() else { return Ok(()) };
        // At the start of a run nothing has begun, and no time passes.
        if at.dt > 0.0 && self.begun != Some((rule, at.dt)) {
            let reason = format!("begun with {:?}, assembled with {rule:?} {}", self.begun, at.dt);
            return Err(Undefined { term: self.name().into(), reason }.into());
        }
        let (end, slid) = self.end(at);
        let mut local = Local::default();
        local.begin(&[0], want_tangent);
        local.residual[0] = 0.5 * STIFFNESS * (self.elastic + end);
        if want_tangent && slid == 0.0 {
            local.tangent[0] = 0.5 * STIFFNESS;
        }
        visit(&local);
        Ok(())
    }
    fn energy(&self, _q: &[f64]) -> Result<f64, Fault> {
        Ok(0.5 * STIFFNESS * self.elastic * self.elastic)
    }
    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        let (end, slid) = self.end(at);
        let dissipated = 0.5 * STIFFNESS * (self.elastic + end) * slid;
        Ok(Work { stored: 0.5 * STIFFNESS * end * end, dissipated, ..Work::default() })
    }
    fn commit(&mut self, at: &At<'_>) {
        self.elastic = self.end(at).0;
    }
    fn save_history(&self) -> Vec<u8> {
        self.elastic.to_le_bytes().to_vec()
    }
    fn load_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let wrong = || Undefined { term: "slider".into(), reason: format!("{} bytes in place of 8", bytes.len()) };
        self.elastic = f64::from_le_bytes(bytes.try_into().map_err(|_| wrong())?);
        Ok(())
    }
}

/// A constant force along x that drives, as a motor does.
#[derive(Debug)]
struct Drive;

const DRIVE: f64 = 3.0;

impl Term for Drive {
    fn name(&self) -> &str {
        "drive"
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn force_scale(&self) -> f64 {
        DRIVE
    }
    fn conserves_linear_momentum(&self) -> bool {
        false
    }
    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        visit(&[0], &[]);
    }
    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        if at.rule.force().is_some() {
            let mut local = Local::default();
            local.begin(&[0], want_tangent);
            local.residual[0] = -DRIVE;
            visit(&local);
        }
        Ok(())
    }
    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        Ok(Work { driven: DRIVE * (at.q_np1[0] - at.q_n[0]), ..Work::default() })
    }
}

fn start() -> Simulation {
    with(Box::new(Slider::default()))
}

fn with(part: Box<dyn Term>) -> Simulation {
    let parts: Vec<Box<dyn Term>> = vec![Box::new(Mass), part];
    let model = Model { reference: vec![0.0; 3], velocity: vec![1.0, 0.2, 0.0], parts, ..Model::default() };
    let settings = Settings {
        control: StepControl { step: 0.01, end: 2.0, max_cuts: 0, grow_after: 4, automatic: None },
        scheme: Some(Box::new(EnergyMomentum)),
        newton: NewtonOptions { relative_tolerance: 1e-12, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    Simulation::new(model, settings).unwrap()
}

#[test]
fn a_part_with_a_history_is_told_what_contact_is_told() {
    let mut run = start();
    let total = run.balance().total();
    let (mut dissipated, mut middle) = (0.0, None);
    while !run.finished() {
        let record = run.advance().unwrap();
        let posting = record.books.parts[1];
        dissipated += posting.dissipated;
        assert!(posting.remainder.abs() < 1e-13, "{posting:?}");
        assert!((record.balance.total() - total).abs() < 1e-12, "{:?}", record.balance);
        if record.step == 100 {
            middle = Some(run.checkpoint("t", Default::default()));
        }
    }
    // It slides until the rest swings: what is left of the motion along x is at most what the spring can store, and what its force makes of the velocity in the step in which the sliding ends.
    let along = |run: &Simulation| run.state().v[0].powi(2) + run.balance().strain;
    assert!(dissipated > 0.5 && (run.balance().dissipation - dissipated).abs() < 1e-13);
    let of_a_step = (STIFFNESS * LIMIT * 0.01).powi(2) / (2.0 * 2.0);
    assert!(along(&run) < 0.5 * STIFFNESS * LIMIT * LIMIT + of_a_step, "{}", along(&run));
    let mut resumed = start();
    resumed.restore(middle.unwrap(), "t").unwrap();
    while !resumed.finished() {
        resumed.advance().unwrap();
    }
    assert_eq!(run.state().q, resumed.state().q);
    assert_eq!(run.balance(), resumed.balance());
}

#[test]
fn what_is_released_is_told_nothing_and_keeps_its_history() {
    let mut run = start();
    (0..50).for_each(|_| drop(run.advance().unwrap()));
    let history = |run: &Simulation| run.model().parts[1].save_history();
    let before = history(&run);
    run.release(Release::Part(1), None).unwrap();
    (0..10).for_each(|_| drop(run.advance().unwrap()));
    assert_eq!(history(&run), before);
    let v = run.state().v.clone();
    run.advance().unwrap();
    assert_eq!(run.state().v, v);
}

/// The work of a force that drives comes from outside: the way of a mass of 2 from the velocity 1 is `t + F t^2 / 4`, which the scheme meets exactly.
#[test]
fn what_a_part_drives_is_supplied() {
    let mut run = with(Box::new(Drive));
    let total = run.balance().total();
    let mut supplied = 0.0;
    while !run.finished() {
        let record = run.advance().unwrap();
        let posting = record.books.parts[1];
        supplied += posting.supplied;
        assert!(posting.remainder.abs() < 1e-12, "{posting:?}");
        assert!((record.balance.total() - total).abs() < 1e-12 * record.balance.largest_energy, "{:?}", record.balance);
    }
    let end = 2.0;
    let work = DRIVE * (end + DRIVE * end * end / 4.0);
    assert!((supplied / work - 1.0).abs() < 1e-12, "{supplied} {work}");
    assert!((run.balance().external_work / work - 1.0).abs() < 1e-12, "{:?}", run.balance());
}
