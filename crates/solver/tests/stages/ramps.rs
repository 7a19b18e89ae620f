//! Prescriptions that begin where their nodes are, and loads that are applied in full at the start.

use crate::stages::{hanging, later, run, settings, stage};
use stoss_integrators::EnergyMomentum;
use stoss_solver::{FirstStage, Prescription, Simulation, Switches, Table};

/// A prescription that the second stage switches on begins where the nodes hang, is linear in time up to the end of its ramp and there where its table says; with an infinite
/// ramp it keeps its distance from the table. A run that is resumed on the way has the same bits.
#[test]
fn what_is_switched_on_begins_where_the_nodes_are() {
    for until in [2.0, f64::INFINITY] {
        let start = || {
            let mut model = hanging();
            let bottom: Vec<u32> = {
                let lowest = model.reference.chunks(3).map(|x| x[2]).fold(f64::INFINITY, f64::min);
                (0..model.node_count() as u32).filter(|n| model.reference[3 * *n as usize + 2] == lowest).collect()
            };
            model.prescriptions.push(Prescription {
                name: "lift".into(),
                nodes: bottom.clone(),
                directions: Vec::new(),
                components: vec![2],
                displacement: Table::from_rows(&[vec![1.0, 0.1], vec![3.0, 0.3]], 1).unwrap(),
                rotation: None,
                ramp_until: Some(until),
            });
            let off = Switches { prescriptions: vec![1], ..Switches::default() };
            (Simulation::staged(model, settings(None, 1.0, 1.0), later(off)).unwrap(), bottom)
        };
        let lift = || stage(None, 0.25, 3.0, Switches::default());
        let (mut simulation, bottom) = start();
        run(&mut simulation);
        let hung = simulation.state().q.clone();
        simulation.begin_stage(lift()).unwrap();
        assert_eq!(simulation.state().q, hung);
        let mut read = None;
        while !simulation.finished() {
            simulation.advance().unwrap();
            let (time, q) = (simulation.state().time, &simulation.state().q);
            if time == 1.5 {
                read = Some(simulation.checkpoint("tag", Default::default()));
            }
            for &node in &bottom {
                let k = 3 * node as usize + 2;
                let table = simulation.model().reference[k] + 0.1 * time;
                let beyond = hung[k] - (simulation.model().reference[k] + 0.1);
                let left = if until.is_finite() { (2.0 - time).max(0.0) } else { 1.0 };
                assert!((q[k] - (table + left * beyond)).abs() < 1e-14, "{time} {} {}", q[k], table + left * beyond);
            }
        }
        let (mut resumed, _) = start();
        resumed.restore_in(lift(), read.unwrap(), "tag").unwrap();
        run(&mut resumed);
        assert_eq!(resumed.state(), simulation.state());
        assert_eq!(resumed.balance(), simulation.balance());
    }
}

/// In dynamics the support moves with the slope of its table and of its ramp.
#[test]
fn a_ramp_has_a_velocity() {
    let mut model = hanging();
    model.prescriptions.push(Prescription {
        name: "stop".into(),
        nodes: vec![0],
        directions: Vec::new(),
        components: vec![0],
        displacement: Table::constant(&[0.01]),
        rotation: None,
        ramp_until: Some(1.5),
    });
    let off = Switches { prescriptions: vec![1], ..Switches::default() };
    let mut simulation = Simulation::staged(model, settings(None, 1.0, 1.0), later(off)).unwrap();
    run(&mut simulation);
    let from = simulation.state().q[0] - simulation.model().reference[0];
    simulation.begin_stage(stage(Some(Box::new(EnergyMomentum)), 0.05, 2.0, Switches::default())).unwrap();
    let speed = (0.01 - from) / 0.5;
    while !simulation.finished() {
        let wanted = if simulation.state().time < 1.5 - 1e-9 { speed } else { 0.0 };
        assert!(
            (simulation.state().v[0] - wanted).abs() < 1e-12,
            "{} {}",
            simulation.state().time,
            simulation.state().v[0]
        );
        simulation.advance().unwrap();
    }
    assert!((simulation.state().q[0] - simulation.model().reference[0] - 0.01).abs() < 1e-15);
}

/// A load that is applied in full at the start is named where a step fails at every size; a table from zero is not.
#[test]
fn loads_that_are_there_at_once_are_named() {
    let fails = |magnitude: Table| {
        let mut model = hanging();
        model.loads[0].magnitude = magnitude;
        let mut simulation = Simulation::staged(model, settings(None, 1.0, 1.0), FirstStage::default()).unwrap();
        let error = simulation.advance().unwrap_err().to_string();
        (error, simulation.loads_at_once().to_vec())
    };
    let (error, loads) = fails(Table::constant(&[-1e9]));
    assert!(error.contains("gravity is applied in full at the start") && error.contains("begins with zero"), "{error}");
    assert_eq!(loads, [0]);
    let (error, loads) = fails(Table::from_rows(&[vec![0.0, 0.0], vec![1.0, -1e9]], 1).unwrap());
    assert!(!error.contains("at once") && loads.is_empty(), "{error}");
}
