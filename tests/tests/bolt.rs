//! Pretension of a bolt through a scene, against rods in series, and over a restart.
use std::collections::BTreeMap;
use std::path::Path;
use stoss::build::{Built, build};
use stoss::solver::Checkpoint;

const SCENE: &str = include_str!("../../scenes/bolt.toml");

fn built() -> Built {
    let scene = stoss::scene::parse(SCENE, "bolt.toml").unwrap_or_else(|e| panic!("{e}"));
    build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn look() {
    let Built { mut simulation, schedule, probes, .. } = built();
    let mut s=None;
    loop {
        if simulation.finished() && !schedule.advance(&mut simulation).unwrap() { break; }
        let r = simulation.advance().unwrap();
        let v: Vec<f64> = probes.iter().map(|p| {let v = p.value(&simulation); if p.quantity.columns()==1 {v[0]} else {v[2]}}).collect();
        let b = simulation.balance();
        if simulation.state().time>4.0+1e-9 && s.is_none(){s=Some(b.total())}
        println!("{} {:?} it {} tot {:e} ext {:e} dev {:e} act {:?}", simulation.state().time, v, r.iterations, b.total(), b.external_work, b.total()-s.unwrap_or(0.0), r.contact.map(|c|c.active));
    }
}
