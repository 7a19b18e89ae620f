//! Static equilibria that are unstable.

use crate::stages::{add_block, hold, settings};
use stoss_solver::{Model, Simulation, Table};

/// A clamped bar that is shortened: beyond the load of Euler it stays straight, because nothing pushes it aside, and is reported to be unstable there.
#[test]
fn a_bar_beyond_its_critical_load_is_unstable() {
    let mut model = Model::default();
    let mesh = add_block(&mut model, [0.0; 3], [2.0, 0.1, 0.05], [20, 1, 1]);
    hold(&mut model, mesh.nodes_of("left").unwrap().to_vec(), Table::constant(&[0.0; 3]));
    let shorter = Table::from_rows(&[vec![0.0; 4], vec![1.0, -0.02, 0.0, 0.0]], 3).unwrap();
    hold(&mut model, mesh.nodes_of("right").unwrap().to_vec(), shorter);
    let mut simulation = Simulation::new(model, settings(None, 0.05, 1.0)).unwrap();
    let mut first = None;
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        if record.unstable > 0 && first.is_none() {
            first = Some((record.time, record.unstable));
        }
        // Once unstable, always unstable.
        assert_eq!(record.unstable > 0, first.is_some(), "{}", record.time);
    }
    // Strain 4 pi^2 I / (A L^2) at the shorter side, more for a mesh of one element across, which is too stiff; a hundredth of it is a time of 1.
    let (time, directions) = first.unwrap();
    let euler = 4.0 * std::f64::consts::PI.powi(2) * 0.05_f64.powi(2) / 12.0 / 4.0 / 0.01;
    println!("{time} {euler}");
    assert_eq!(directions, 1);
    assert!(time > euler && time < 4.0 * euler, "{time} {euler}");
}
