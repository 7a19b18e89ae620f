//! Mortar contact of blocks that tip, with the sides in the surfaces: over the rim of a slab, and dropped onto their edge. Backward Euler takes energy; the closing
//! of an edge that has sunk in between nodes may give some, but the block is not thrown out.

use crate::support::simulation;
use stoss::solver::DecisionKind;

/// Energies (kinetic, strain, of position) after every step.
fn energies(scene: &str) -> Vec<f64> {
    let mut s = simulation(scene);
    let mut energies = Vec::new();
    while !s.finished() {
        let record = s.advance().unwrap();
        let balance = &record.balance;
        energies.push(balance.total() - balance.external_work);
    }
    energies
}

fn block(
    name: &str,
    min: [f64; 3],
    max: [f64; 3],
    divisions: [u32; 3],
    young: f64,
    density: f64,
    more: &str,
) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {min:?}, max = {max:?}, divisions = {divisions:?} }}\n\
         material = {{ law = \"neo-hooke\", young = {young:?}, poisson = 0.3 }}\ndensity = {density:?}\n{more}"
    )
}

fn scene(end: f64, bodies: [String; 2], weight: f64, surfaces: &str) -> String {
    format!(
        "[scene]\ntitle = \"edge\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = 0.01\nintegrator = {{ scheme = \"backward-euler\" }}\n{}{}\
         [[load]]\nbody = \"upper\"\nbody_force = [0.0, 0.0, {:?}]\n\
         [[prescribe]]\nset = \"lower.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
         [[contact]]\nmethod = \"mortar\"\n{surfaces}\n",
        bodies[0], bodies[1], -weight
    )
}

/// The rear of the block sees the far side of the slab through the slab's inside as soon as its lower edge sinks in by little; it was taken for a contact 0.5
/// deep, and the block thrown out with seven times its energy.
#[test]
fn a_block_that_tips_over_a_rim_is_not_thrown_out() {
    for (slave, master) in [("upper", "lower"), ("lower", "upper")] {
        let bodies = [
            block("lower", [0.0; 3], [2.0, 2.0, 1.0], [4, 4, 2], 1e6, 1000.0, ""),
            block("upper", [0.8, 0.55, 1.0], [1.7, 1.45, 1.9], [2, 2, 2], 1e6, 1000.0, "velocity = [1.0, 0.0, 0.0]\n"),
        ];
        let surfaces = format!("slave = \"{slave}.boundary\"\nmaster = \"{master}.boundary\"");
        let energies = energies(&scene(1.6, bodies, 9810.0, &surfaces));
        let most = energies.iter().copied().fold(0.0, f64::max) / energies[0];
        println!("{slave} is slave: {} steps, at most {most} of the first energy", energies.len() - 1);
        assert!(most < 1.3, "{most}");
    }
}

/// A cube falls onto its edge, tilted by 12 degrees and more: its sides face the plate by little and by much, and the force must be that of both.
#[test]
fn a_cube_that_falls_on_its_edge_is_not_thrown_out() {
    for degrees in [12.0, 16.0, 20.0, 25.0, 30.0, 40.0, 50.0] {
        let turned = format!(
            "rotation = {{ axis = [0, 1, 0], degrees = -{degrees:?}, about = [0, 0, 0] }}\nposition = [-0.3, 0, 0.02]\nvelocity = [0, 0, -1]\n"
        );
        let bodies = [
            block("lower", [-1.5, -1.0, -1.0], [1.5, 1.0, 0.0], [6, 2, 2], 1e4, 10.0, ""),
            block("upper", [0.0, -0.35, 0.0], [1.0, 0.35, 1.0], [2, 2, 2], 1e4, 10.0, &turned),
        ];
        let surfaces = "slave = \"upper.boundary\"\nmaster = \"lower.top\"";
        let energies = energies(&scene(0.6, bodies, 50.0, surfaces));
        let most = energies.iter().copied().fold(0.0, f64::max) / energies[0];
        println!("{degrees} degrees: {} steps, at most {most} of the first energy", energies.len() - 1);
        assert!(most < 1.15, "{most}");
    }
}

/// A block that falls on the rim of a slab and leans over it, the slab with dual multipliers: no scheme gains energy.
#[test]
fn a_block_on_a_rim_gains_nothing() {
    for scheme in ["backward-euler", "energy-momentum"] {
        let bodies = [
            block("lower", [0.0; 3], [2.0, 2.0, 1.0], [4, 3, 2], 1000.0, 1.0, ""),
            block(
                "upper",
                [-0.159, 0.523, 1.02],
                [0.741, 1.323, 1.7],
                [3, 3, 2],
                1000.0,
                1.0,
                "rotation = [{ axis = [0, 0, 1], degrees = 31.23 }]\nvelocity = [0.27, 0.19, -2.0]\n",
            ),
        ];
        let mut s = simulation(&format!(
            "[scene]\ntitle = \"rim\"\nkind = \"dynamic\"\n[time]\nend = 0.3\nstep = 0.01\nintegrator = {{ scheme = \"{scheme}\" }}\n{}{}\
             [[contact]]\nmethod = \"mortar\"\nmultipliers = \"dual\"\nslave = \"lower.top\"\nmaster = \"upper.bottom\"\n",
            bodies[0], bodies[1]
        ));
        let mut most = 0.0_f64;
        let first = s.balance().total();
        while !s.finished() {
            most = most.max(s.advance().unwrap().balance.total() / first);
        }
        let told = s.decisions().iter().filter(|d| d.kind == DecisionKind::Warning).count();
        assert!(told == 0 && most < 1.0 + 1e-9, "{scheme}: {told} warnings, {most}");
    }
}
