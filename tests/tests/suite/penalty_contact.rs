//! A contact method of one's own: blocks on a fixed plane by penalty, see docs/how-to-add/contact-method.md.

use std::sync::Arc;
use stoss::contact::{ContactError, ContactRule, ContactSurface, LocalContribution, Potential, StepConfiguration};
use stoss::fe_solid::{MassKind, SolidBody};
use stoss::integrators::EnergyMomentum;
use stoss::linalg::AutoSolver;
use stoss::materials::NeoHooke;
use stoss::mesh::generate::Block;
use stoss::newton::NewtonOptions;
use stoss::solver::{Body, ContactPair, Coupling, InsideOutRule, Model, Settings, Simulation, StepControl};

/// Nodes of a surface against the plane `z = 0` with the energy `V(g) = k A g^2 / 2` for a gap `g < 0`, `A` the reference area of the node.
#[derive(Debug)]
struct PenaltyPlane {
    surface: ContactSurface,
    /// Stress per length.
    stiffness: f64,
    /// Slave nodes that may come to the plane in the step.
    near: Vec<usize>,
}

impl PenaltyPlane {
    fn gap(&self, local: usize, q: &[f64]) -> f64 {
        q[3 * self.surface.nodes()[local] as usize + 2]
    }

    /// `k A min(g, 0)`, and its derivative.
    fn slope(&self, local: usize, gap: f64) -> (f64, f64) {
        let k = self.stiffness * self.surface.nodal_areas()[local];
        (k * gap.min(0.0), if gap < 0.0 { k } else { 0.0 })
    }

    /// Slope of the energy that makes the force of a step, and its derivative by the gap at its end.
    fn slope_of_step(&self, local: usize, rule: ContactRule, start: f64, end: f64) -> Result<(f64, f64), ContactError> {
        let (at_start, at_end) = (self.slope(local, start), self.slope(local, end));
        match rule {
            ContactRule::EndPoint => Ok(at_end),
            // (V(end) - V(start)) / (end - start): the work of the force is the change of the energy.
            ContactRule::EnergyMomentum if start.min(end) < 0.0 && start.max(end) > 0.0 => {
                let energy = |gap: f64| 0.5 * self.slope(local, gap).0 * gap;
                let secant = (energy(end) - energy(start)) / (end - start);
                Ok((secant, (at_end.0 - secant) / (end - start)))
            }
            ContactRule::EnergyMomentum => Ok((0.5 * (at_start.0 + at_end.0), 0.5 * at_end.1)),
            _ => Err(ContactError::Rule { method: "penalty plane", rule: format!("{rule:?}") }),
        }
    }
}

impl Potential for PenaltyPlane {
    fn name(&self) -> &str {
        "plane"
    }

    fn length_scale(&self) -> f64 {
        self.surface.length_scale()
    }

    /// The plane is held.
    fn conserves_angular_momentum(&self) -> bool {
        false
    }

    fn is_symmetric(&self, _rule: ContactRule) -> bool {
        true
    }

    fn begin_step(&mut self, q_n: &[f64], reach: f64) -> Result<(), ContactError> {
        self.near = (0..self.surface.nodes().len()).filter(|&local| self.gap(local, q_n) < reach).collect();
        Ok(())
    }

    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.near.iter().for_each(|&local| visit(&[self.surface.nodes()[local]]));
    }

    fn assemble(
        &self,
        step: StepConfiguration<'_>,
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        let mut local = LocalContribution::default();
        for &node in &self.near {
            let [start, end] = [step.q_n, step.q_np1].map(|q| self.gap(node, q));
            let (slope, derivative) = self.slope_of_step(node, step.rule, start, end)?;
            local.nodes.clear();
            local.nodes.push(self.surface.nodes()[node]);
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

    fn energy(&self, q: &[f64]) -> Result<f64, ContactError> {
        let energy = |local: usize| 0.5 * self.slope(local, self.gap(local, q)).0 * self.gap(local, q);
        Ok((0..self.surface.nodes().len()).map(energy).sum())
    }
}

/// A block that falls on the plane from this height, turned.
fn bounces(height: f64) {
    let mesh = Block::new([0.0; 3], [1.0; 3], [2, 2, 2]).generate().unwrap();
    let (c, s) = (0.3_f64.cos(), 0.3_f64.sin());
    let reference: Vec<f64> =
        mesh.nodes.iter().flat_map(|[x, y, z]| [c * x - s * z, *y, s * x + c * z + height]).collect();
    let turned =
        stoss::mesh::Mesh { nodes: reference.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect(), ..mesh.clone() };
    let facets: Vec<[u32; 4]> =
        mesh.facets_of("boundary").unwrap().iter().map(|facet| [0, 1, 2, 3].map(|k: usize| facet.nodes[k])).collect();
    let count = mesh.nodes.len();
    let plane = PenaltyPlane {
        surface: ContactSurface::new("block", &facets, &reference).unwrap(),
        stiffness: 1e4,
        near: Vec::new(),
    };
    let model = Model {
        velocity: [1.0, 0.5, -3.0].repeat(count),
        bodies: vec![Body {
            solid: SolidBody::new("block", &turned, 0, Arc::new(NeoHooke::from_young_poisson(1e3, 0.3).unwrap()))
                .unwrap(),
            nodes: 0..count as u32,
            density: Some(1.0),
            mass_kind: MassKind::Consistent,
            damping: Default::default(),
        }],
        contacts: vec![ContactPair {
            name: "plane".into(),
            method: Coupling::potential(plane),
            complementarity: 1.0,
            restores: false,
        }],
        reference,
        ..Model::default()
    };
    let settings = Settings {
        control: StepControl { step: 0.01, end: 0.6, max_cuts: 0, grow_after: 1, automatic: None },
        scheme: Some(Box::new(EnergyMomentum)),
        newton: NewtonOptions { relative_tolerance: 1e-11, ..NewtonOptions::default() },
        inside_out: InsideOutRule::Refuse,
        solver: Box::new(AutoSolver::new()),
    };
    let mut run = Simulation::new(model, settings).unwrap();
    let first = *run.balance();
    let mut stored = 0.0_f64;
    while !run.finished() {
        let now = run.advance().unwrap().balance;
        stored = stored.max(now.contact);
        assert!(
            (now.total() - first.total()).abs() < 1e-11 * first.total(),
            "energy {:e}",
            now.total() - first.total()
        );
        assert!(now.closing_loss.abs() < 1e-11 * first.total(), "closing {:e}", now.closing_loss);
        for i in 0..2 {
            assert!((now.linear_momentum[i] - first.linear_momentum[i]).abs() < 1e-11 * 3.0);
        }
    }
    assert!(stored > 0.01 * first.total(), "it never touched");
    assert!(run.balance().linear_momentum[2] > 0.0, "it has not come back");
}

#[test]
fn a_block_bounces_on_a_plane() {
    bounces(0.4);
}

/// The energy of the start counts, too.
#[test]
fn a_block_that_begins_in_the_plane_leaves_it() {
    bounces(-0.05);
}
