//! A contact method of one's own: a block on a fixed plane by penalty. Shown: the trait `Term` with the ability `Potential`, for forces that act in the place of constraints; a model made by hand, and its run. Checked: energy and horizontal momentum of a block that bounces under the
//! energy-momentum scheme, from above and from inside the plane.
//!
//! `cargo run --example own_contact -p stoss-solver`; docs/how-to-add/contact-method.md explains it.

use std::error::Error;
use std::sync::Arc;
use stoss_contact::{ContactError, ContactSurface};
use stoss_fe_solid::{MassKind, SolidBody};
use stoss_integrators::EnergyMomentum;
use stoss_linalg::AutoSolver;
use stoss_materials::NeoHooke;
use stoss_mesh::{Rotation, generate::Block};
use stoss_newton::NewtonOptions;
use stoss_solver::{Body, CouplingTerm, InsideOutTreatment, Model, Settings, Simulation, StepControl};
use stoss_term::{At, Fault, GradientRule, Local, Potential, StepContext, Term};

/// Nodes of a surface against the plane `z = 0` with the energy `V(g) = k A g^2 / 2` for a gap `g < 0`, `A` the reference area of the node.
#[derive(Debug)]
struct PenaltyPlane {
    surface: ContactSurface,
    /// `k`, a stress over a length.
    stiffness: f64,
    /// Slave nodes that may come to the plane in the step.
    near: Vec<usize>,
}

impl PenaltyPlane {
    fn gap(&self, local: usize, q: &[f64]) -> f64 {
        q[3 * self.surface.nodes()[local] as usize + 2]
    }
    /// `k A` of a slave node, a force over a length.
    fn spring(&self, local: usize) -> f64 {
        self.stiffness * self.surface.nodal_areas()[local]
    }
    /// Slope of the energy that makes the force of a step, and its derivative by the gap at its end.
    fn slope(&self, local: usize, rule: GradientRule, start: f64, end: f64) -> Result<(f64, f64), ContactError> {
        let (half, sum) = (0.5 * self.spring(local), start.min(0.0) + end.min(0.0));
        let closed = f64::from(u8::from(end < 0.0));
        match rule {
            GradientRule::EndPoint => Ok((2.0 * half * end.min(0.0), 2.0 * half * closed)),
            GradientRule::DiscreteGradient if (start < 0.0) == (end < 0.0) => Ok((half * sum, half * closed)),
            // (V(end) - V(start)) / (end - start): the work of the force is the change of the energy.
            GradientRule::DiscreteGradient => {
                let ratio = (end.min(0.0) - start.min(0.0)) / (end - start);
                Ok((half * sum * ratio, half * (closed * ratio + sum * (closed - ratio) / (end - start))))
            }
            _ => Err(ContactError::RuleUnavailable { method: "penalty plane", rule: format!("{rule:?}") }),
        }
    }
}

impl Term for PenaltyPlane {
    fn name(&self) -> &str {
        "plane"
    }
    fn length_scale(&self) -> f64 {
        self.surface.length_scale()
    }
    fn conserves_angular_momentum(&self) -> bool {
        false
    }
    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        self.near = (0..self.surface.nodes().len()).filter(|&local| self.gap(local, step.q_n) < step.reach).collect();
        Ok(())
    }
    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        self.near.iter().for_each(|&local| visit(&[self.surface.nodes()[local]], &[]));
    }
    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.constraint() else { return Ok(()) };
        let mut local = Local::default();
        for &node in &self.near {
            let [start, end] = [at.q_n, at.q_np1].map(|q| self.gap(node, q));
            let (slope, derivative) = self.slope(node, rule, start, end)?;
            local.nodes = vec![self.surface.nodes()[node]];
            local.reset(want_tangent);
            // The residual is minus the force; x and y stay free.
            local.residual[2] = slope;
            if want_tangent {
                local.tangent[8] = derivative;
            }
            visit(&local);
        }
        Ok(())
    }
    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        let energy = |local: usize| 0.5 * self.spring(local) * self.gap(local, q).min(0.0).powi(2);
        Ok((0..self.surface.nodes().len()).map(energy).sum())
    }
    fn potential(&self) -> Option<&dyn Potential> {
        Some(self)
    }
    fn potential_mut(&mut self) -> Option<&mut dyn Potential> {
        Some(self)
    }
}

impl Potential for PenaltyPlane {}

/// A block that is turned and falls on the plane, its lowest corner at this height; it may begin in the plane.
fn block(height: f64) -> Result<Model, Box<dyn Error>> {
    let mut mesh = Block::new([0.0; 3], [1.0; 3], [2, 2, 2]).generate()?;
    let turn = Rotation { axis: [0.0, -1.0, 0.0], degrees: 0.3_f64.to_degrees(), about: [0.0; 3] };
    mesh.transform(Some(&turn), [0.0, 0.0, height])?;
    let reference: Vec<f64> = mesh.nodes.iter().flatten().copied().collect();
    let facets: Vec<_> = mesh.facets_of("boundary")?.iter().map(|facet| facet.nodes.linear()).collect();
    let surface = ContactSurface::new("block", &facets, &reference)?;
    let plane = PenaltyPlane { surface, stiffness: 1e4, near: Vec::new() };
    let (nodes, density) = (0..mesh.nodes.len() as u32, Some(1.0));
    let solid = SolidBody::new("block", &mesh, 0, Arc::new(NeoHooke::from_young_poisson(1e3, 0.3)?))?;
    let body =
        Body { solid, nodes, density, mass_kind: MassKind::Consistent, damping: Default::default(), massless: None };
    Ok(Model {
        velocity: [1.0, 0.5, -3.0].repeat(mesh.nodes.len()),
        bodies: vec![body],
        contacts: vec![CouplingTerm::new("plane", plane, 1.0)],
        reference,
        ..Model::default()
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("height   stored at most   momentum along z: start, end   drift of energy");
    for height in [0.4, -0.05] {
        let settings = Settings {
            control: StepControl { step: 0.01, end: 0.6, max_cuts: 0, grow_after: 1, automatic: None },
            scheme: Some(Box::new(EnergyMomentum)),
            newton: NewtonOptions { relative_tolerance: 1e-11, ..NewtonOptions::default() },
            inside_out: InsideOutTreatment::Refuse,
            max_plastic_increment: None,
            solver: Box::new(AutoSolver::new()),
        };
        let mut run = Simulation::new(block(height)?, settings)?;
        let first = *run.balance();
        let (mut stored, mut drift) = (0.0_f64, 0.0_f64);
        while !run.finished() {
            let now = run.advance()?.balance;
            stored = stored.max(now.contact);
            drift = drift.max((now.total() - first.total()).abs() / first.total());
            assert!(drift < 1e-11 && now.closing_loss.abs() < 1e-11 * first.total(), "{drift:e} {now:?}");
            let change = |i: usize| (now.linear_momentum[i] - first.linear_momentum[i]).abs();
            assert!(change(0).max(change(1)) < 1e-11 * 3.0, "{now:?}");
        }
        let (start, end) = (first.linear_momentum[2], run.balance().linear_momentum[2]);
        println!("{height:6.2} {stored:16.4} {start:24.3} {end:7.3} {drift:17.1e}");
        assert!(stored > 0.01 * first.total() && end > 0.0, "it has not touched, or not come back");
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
