//! Contact between rigid bodies and solids: the surface of the rigid body is made of embedded nodes, of which no contact method knows.

use crate::support::drift;
use std::sync::Arc;
use stoss::contact_mortar::{MortarContact, MortarOptions};
use stoss::contact_nts::{ConstraintForm, NodeToSurface, NodeToSurfaceOptions};
use stoss::fe_solid::{MassKind, SolidBody};
use stoss::integrators::EnergyMomentum;
use stoss::linalg::AutoSolver;
use stoss::materials::NeoHooke;
use stoss::mesh::generate::Block;
use stoss::multibody::{RigidBody, RigidMass};
use stoss::newton::NewtonOptions;
use stoss::solver::{
    Balance, Body, CouplingTerm, InsideOutTreatment, Model, Settings, Simulation, StepControl, StepRecord,
};
use stoss::term::Term;

/// A solid block and a rigid one that falls on it, turning; the rigid one's surface is that of a mesh.
struct Impact {
    model: Model,
    solid: Vec<[u32; 4]>,
    rigid: Vec<[u32; 4]>,
}

impl Impact {
    fn new() -> Self {
        let block = Block::new([0.0, 0.0, 0.0], [2.0, 2.0, 1.0], [4, 4, 2]).generate().unwrap();
        let law = Arc::new(NeoHooke::from_young_poisson(1000.0, 0.3).unwrap());
        let mut model = Model::default();
        model.bodies.push(Body {
            solid: SolidBody::new("block", &block, 0, law).unwrap(),
            nodes: 0..block.nodes.len() as u32,
            density: Some(1.0),
            mass_kind: MassKind::Consistent,
            massless: None,
            damping: Default::default(),
        });
        model.reference.extend(block.nodes.iter().flatten());
        model.velocity.resize(model.reference.len(), 0.0);
        let solid = block.facets_of("top").unwrap().iter().map(|f| [0, 1, 2, 3].map(|k: usize| f.nodes[k])).collect();

        // A cuboid of 1 x 1 x 0.5 and density 2, whose Euler tensor is m l^2 / 12.
        let mass = RigidMass::new(
            1.0,
            [1.1, 0.95, 1.35],
            [1.0, 1.0, 0.25].map(|square| square / 12.0),
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        )
        .unwrap();
        let tool = RigidBody::new("tool", model.node_count() as u32, mass);
        model.reference.extend(tool.reference().iter().flatten());
        model.velocity.extend(tool.velocity([0.2, 0.1, -2.0], [0.1, -0.2, 0.5]).iter().flatten());
        model.contacts.push(CouplingTerm::new("rigidity", tool.constraints(), 1.0));
        let shape = Block::new([0.6, 0.45, 1.1], [1.6, 1.45, 1.6], [3, 3, 1]).generate().unwrap();
        let first = model.node_count() as u32;
        for (k, x) in shape.nodes.iter().enumerate() {
            model.reference.extend(x);
            model.velocity.extend([0.0; 3]);
            model.embedding.add(first + k as u32, &tool.point(*x).terms);
        }
        let rigid = shape
            .facets_of("bottom")
            .unwrap()
            .iter()
            .map(|f| [0, 1, 2, 3].map(|k: usize| f.nodes[k] + first))
            .collect();
        model.parts.push(Box::new(tool));
        Self { model, solid, rigid }
    }

    fn run(mut self, term: Box<dyn Term>) -> Vec<StepRecord> {
        let complementarity = 1000.0 / term.length_scale();
        self.model.contacts.push(CouplingTerm {
            name: "contact".into(),
            term,
            acts: true,
            complementarity,
            restitution: None,
        });
        let settings = Settings {
            control: StepControl { step: 5e-3, end: 0.4, max_cuts: 0, grow_after: 1, automatic: None },
            scheme: Some(Box::new(EnergyMomentum)),
            newton: NewtonOptions { relative_tolerance: 1e-10, ..NewtonOptions::default() },
            inside_out: InsideOutTreatment::Refuse,
            max_plastic_increment: None,
            solver: Box::new(AutoSolver::new()),
        };
        let mut simulation = Simulation::new(self.model, settings).unwrap();
        let mut records = vec![simulation.initial_record()];
        while !simulation.finished() {
            records.push(simulation.advance().unwrap());
        }
        records
    }
}

/// Momenta and the ledger at round-off, contact in some steps.
fn examine(what: &str, records: &[StepRecord]) {
    let touched = records.iter().filter(|r| r.contact.as_ref().is_some_and(|c| c.active > 0)).count();
    let iterations = records[1..].iter().map(|r| f64::from(r.iterations)).sum::<f64>() / (records.len() - 1) as f64;
    let of = |f: fn(&Balance) -> [f64; 3]| drift(&records.iter().map(|r| f(&r.balance)).collect::<Vec<_>>());
    let (linear, angular) = (of(|b| b.linear_momentum), of(|b| b.angular_momentum));
    let energy = of(|b| [b.total() + b.closing_loss + b.impact_loss, 0.0, 0.0]);
    println!("{what}: {touched} steps in contact, {iterations:.1} iterations, {linear:.1e} {angular:.1e} {energy:.1e}");
    assert!(touched > 4, "{what}: {touched}");
    assert!(linear < 1e-11 && angular < 1e-11, "{what}: {linear:e} {angular:e}");
    assert!(energy < 1e-10, "{what}: {energy:e}");
}

#[test]
fn a_rigid_block_falls_on_a_solid_one() {
    for rigid_is_slave in [true, false] {
        for form in [ConstraintForm::Standard, ConstraintForm::Modified] {
            let impact = Impact::new();
            let (slave, master) =
                if rigid_is_slave { (&impact.rigid, &impact.solid) } else { (&impact.solid, &impact.rigid) };
            let options = NodeToSurfaceOptions { constraint: form, ..NodeToSurfaceOptions::default() };
            let method = NodeToSurface::new("contact", slave, master, &impact.model.reference, options).unwrap();
            let records = impact.run(Box::new(method));
            examine(&format!("nts {form:?}, rigid slave {rigid_is_slave}"), &records);
        }
        let impact = Impact::new();
        let (slave, master) =
            if rigid_is_slave { (&impact.rigid, &impact.solid) } else { (&impact.solid, &impact.rigid) };
        let method =
            MortarContact::new("contact", slave, master, &impact.model.reference, MortarOptions::default()).unwrap();
        let records = impact.run(Box::new(method));
        examine(&format!("mortar, rigid slave {rigid_is_slave}"), &records);
    }
}
