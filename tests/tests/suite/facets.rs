//! Whole runs in which the contact surfaces of blocks are quadrilaterals, triangles, or both: the same nodes, other facets.

use crate::support::drift;
use std::sync::Arc;
use stoss::contact::SearchOptions;
use stoss::contact_mortar::tie::{MeshTie, TieOptions};
use stoss::contact_mortar::{MortarContact, MortarOptions, MultiplierSpace};
use stoss::contact_nts::{NodeToSurface, NodeToSurfaceOptions};
use stoss::continuum::HyperelasticLaw;
use stoss::fe_solid::{MassKind, SolidBody};
use stoss::integrators::EnergyMomentum;
use stoss::linalg::AutoSolver;
use stoss::materials::NeoHooke;
use stoss::mesh::Mesh as Solid;
use stoss::mesh::generate::Block;
use stoss::newton::NewtonOptions;
use stoss::solver::{
    Body, CouplingTerm, InsideOutTreatment, Model, Prescription, Settings, Simulation, StepControl, StepRecord, Table,
};
use stoss::term::Term;
use stoss_reference_cases::patch::unevenness;
use stoss_testkit::meshes::Mesh;

const YOUNG: f64 = 1000.0;

/// Two blocks, the first one below.
struct Blocks {
    model: Model,
    meshes: [Solid; 2],
}

impl Blocks {
    /// Corners and divisions of both; density 1 and these velocities, or statics.
    fn new(blocks: [([f64; 3], [f64; 3], [usize; 3]); 2], velocities: Option<[[f64; 3]; 2]>) -> Self {
        let meshes = blocks.map(|(min, max, n)| Block::new(min, max, n).generate().unwrap());
        let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::from_young_poisson(YOUNG, 0.3).unwrap());
        let mut model = Model::default();
        for (k, mesh) in meshes.iter().enumerate() {
            let first = (model.reference.len() / 3) as u32;
            model.bodies.push(Body {
                solid: SolidBody::new(["lower", "upper"][k], mesh, first, law.clone()).unwrap(),
                nodes: first..first + mesh.nodes.len() as u32,
                density: velocities.map(|_| 1.0),
                mass_kind: MassKind::Consistent,
                massless: None,
                damping: Default::default(),
            });
            model.reference.extend(mesh.nodes.iter().flatten());
            model.velocity.extend(mesh.nodes.iter().flat_map(|_| velocities.map_or([0.0; 3], |v| v[k])));
        }
        Self { model, meshes }
    }

    fn facets(&self, block: usize, set: &str) -> Vec<[u32; 4]> {
        let first = self.model.bodies[block].nodes.start;
        self.meshes[block]
            .facets_of(set)
            .unwrap()
            .iter()
            .map(|f| [0, 1, 2, 3].map(|k: usize| f.nodes[k] + first))
            .collect()
    }

    /// The lower block's top and the upper one's bottom, slave first.
    fn surfaces(&self, upper_is_slave: bool) -> [Vec<[u32; 4]>; 2] {
        let [lower, upper] = [self.facets(0, "top"), self.facets(1, "bottom")];
        if upper_is_slave { [upper, lower] } else { [lower, upper] }
    }

    /// Moves a component of a side from zero to `end` at time 1.
    fn prescribe(&mut self, block: usize, set: &str, component: u8, end: f64) {
        let first = self.model.bodies[block].nodes.start;
        let nodes = self.meshes[block].nodes_of(set).unwrap().iter().map(|n| n + first).collect();
        let displacement = Table::from_rows(&[vec![0.0, 0.0], vec![1.0, end]], 1).unwrap();
        self.model.prescriptions.push(Prescription {
            name: "support".into(),
            directions: Vec::new(),
            nodes,
            components: vec![component],
            displacement,
            rotation: None,
            ramp_until: None,
        });
    }

    fn simulation(mut self, term: Box<dyn Term>, step: f64, end: f64) -> Simulation {
        let complementarity = YOUNG / term.length_scale();
        self.model.contacts.push(CouplingTerm {
            name: "contact".into(),
            term,
            acts: true,
            complementarity,
            restitution: None,
        });
        let is_dynamic = self.model.bodies[0].density.is_some();
        let settings = Settings {
            control: StepControl { step, end, max_cuts: 0, grow_after: 1, automatic: None },
            scheme: if is_dynamic { Some(Box::new(EnergyMomentum)) } else { None },
            newton: NewtonOptions { relative_tolerance: 1e-10, ..NewtonOptions::default() },
            inside_out: InsideOutTreatment::Refuse,
            max_plastic_increment: None,
            solver: Box::new(AutoSolver::new()),
        };
        Simulation::new(self.model, settings).unwrap()
    }
}

fn run(mut simulation: Simulation) -> (Simulation, Vec<StepRecord>) {
    let mut records = vec![simulation.initial_record()];
    while !simulation.finished() {
        records.push(simulation.advance().unwrap());
    }
    (simulation, records)
}

fn mortar([slave, master]: &[Vec<[u32; 4]>; 2], meshes: [Mesh; 2], q: &[f64], options: MortarOptions) -> MortarContact {
    MortarContact::new("contact", &meshes[0].of(slave), &meshes[1].of(master), q, options).unwrap()
}

/// Largest deviation of the stress at any Gauss point of the upper block from the mean, over the norm of the mean.
fn uneven(simulation: &Simulation) -> f64 {
    let q = &simulation.state().q;
    let points = simulation.model().bodies[1..].iter().flat_map(|b| b.solid.gauss_point_state(q).unwrap());
    let stresses: Vec<[f64; 6]> = points.flatten().map(|p| p.cauchy).collect();
    unevenness(&stresses).0
}

/// A block on a rigid plate, pressed by a fifth: uniaxial stress, whatever facets the plate has and whichever of both is the slave. Facets of the block are its
/// elements' own: nodal forces of a uniform pressure on triangles are not those of one on the quadrilaterals that bound a hexahedron.
#[test]
fn patches_on_all_facets_are_uniform() {
    for (mesh, upper_is_slave) in Mesh::ALL.into_iter().flat_map(|m| [(m, true), (m, false)]) {
        for space in [MultiplierSpace::Standard, MultiplierSpace::Dual, MultiplierSpace::Centred] {
            let plate = ([-0.5, -0.5, 0.0], [2.6, 2.6, 1.0], [2, 2, 1]);
            let mut blocks = Blocks::new([plate, ([0.0, 0.0, 1.0], [2.0, 2.0, 2.0], [3, 4, 2])], None);
            (0..3).for_each(|component| {
                blocks.prescribe(0, "bottom", component, 0.0);
                blocks.prescribe(0, "top", component, 0.0);
            });
            blocks.prescribe(1, "left", 0, 0.0);
            blocks.prescribe(1, "front", 1, 0.0);
            blocks.prescribe(1, "top", 2, -0.2);
            let options = MortarOptions { space, ..MortarOptions::default() };
            let meshes = if upper_is_slave { [Mesh::Quads, mesh] } else { [mesh, Mesh::Quads] };
            let q = blocks.model.reference.clone();
            let method = mortar(&blocks.surfaces(upper_is_slave), meshes, &q, options);
            let (simulation, _) = run(blocks.simulation(Box::new(method), 0.5, 1.0));
            let uneven = uneven(&simulation);
            println!("{meshes:?} {space:?}: uneven by {uneven:.1e}");
            assert!(uneven < 1e-10, "{meshes:?} {space:?}: {uneven:e}");
        }
    }
}

/// Two blocks in one another's way, tied: they swing and turn as one.
#[test]
fn ties_of_all_facets_keep_the_ledger() {
    for (k, meshes) in Mesh::PAIRS.into_iter().enumerate() {
        let lower = ([0.0, 0.0, 0.0], [2.0, 2.0, 1.0], [3, 2, 1]);
        let upper = ([0.0, 0.0, 1.0], [2.0, 2.0, 2.0], [2, 3, 1]);
        let blocks = Blocks::new([lower, upper], Some([[0.0; 3], [3.0, 1.0, 2.0]]));
        let [slave, master] = blocks.surfaces(k % 2 == 0);
        let space = if k % 2 == 0 { MultiplierSpace::Standard } else { MultiplierSpace::Dual };
        let (q, options) = (blocks.model.reference.clone(), TieOptions { space, ..TieOptions::default() });
        let tie = MeshTie::new("tie", &meshes[0].of(&slave), &meshes[1].of(&master), &q, |_| false, options).unwrap();
        assert!((tie.tied_share() - 1.0).abs() < 1e-12);
        let (_, records) = run(blocks.simulation(Box::new(tie), 5e-3, 0.2));
        check_ledger(&format!("tie {meshes:?} {space:?}"), &records);
    }
}

/// A block that hits another one askew and slides on it.
fn impact() -> Blocks {
    Blocks::new(
        [([0.0, 0.0, 0.0], [2.0, 2.0, 1.0], [3, 3, 1]), ([0.25, 0.3, 1.05], [1.25, 1.3, 2.05], [2, 2, 1])],
        Some([[0.0; 3], [2.0, 1.0, -3.0]]),
    )
}

/// Momenta to round-off; energy but for the loss of closing gaps, and there was contact.
fn check_ledger(name: &str, records: &[StepRecord]) {
    let linear: Vec<[f64; 3]> = records.iter().map(|r| r.balance.linear_momentum).collect();
    let angular: Vec<[f64; 3]> = records.iter().map(|r| r.balance.angular_momentum).collect();
    let energies: Vec<f64> = records.iter().map(|r| r.balance.total() + r.balance.closing_loss).collect();
    let off = energies.iter().map(|e| (e / energies[0] - 1.0).abs()).fold(0.0, f64::max);
    let strain = records.iter().map(|r| r.balance.strain).fold(0.0, f64::max);
    let (p, l) = (drift(&linear), drift(&angular));
    println!("{name}: momenta {p:.1e} {l:.1e}, energy {off:.1e}, strain {:.2}", strain / energies[0]);
    assert!(p < 1e-12 && l < 1e-12, "{name}: {p:e} {l:e}");
    assert!(off < 1e-9, "{name}: {off:e}");
    assert!(strain > 0.05 * energies[0], "{name}: no impact");
}

#[test]
fn mortar_impacts_of_all_facets_keep_the_ledger() {
    for (k, meshes) in Mesh::PAIRS.into_iter().enumerate() {
        let blocks = impact();
        let space = match k % 3 {
            0 => MultiplierSpace::Standard,
            1 => MultiplierSpace::Dual,
            _ => MultiplierSpace::Centred,
        };
        let options = MortarOptions { space, ..MortarOptions::default() };
        let method = mortar(&blocks.surfaces(k < 3), meshes, &blocks.model.reference, options);
        let (_, records) = run(blocks.simulation(Box::new(method), 2e-3, 0.1));
        check_ledger(&format!("mortar {meshes:?} {space:?}"), &records);
    }
}

#[test]
fn node_to_surface_impacts_of_all_facets_keep_the_ledger() {
    for meshes in Mesh::PAIRS {
        let blocks = impact();
        let [slave, master] = blocks.surfaces(true);
        let options = NodeToSurfaceOptions { search: SearchOptions::default(), ..NodeToSurfaceOptions::default() };
        let q = &blocks.model.reference;
        let method = NodeToSurface::new("contact", &meshes[0].of(&slave), &meshes[1].of(&master), q, options).unwrap();
        let (_, records) = run(blocks.simulation(Box::new(method), 2e-3, 0.1));
        check_ledger(&format!("nts {meshes:?}"), &records);
    }
}
