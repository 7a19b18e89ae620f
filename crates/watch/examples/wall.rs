//! A cube is thrown at a wall, by hand and without contact: what the watch says of a miss, of a cube that ends in the wall, and of one that
//! is on the other side at the next look. Depths are judged by the lengths of edges: a part of an edge is doubtful, more is wrong.
//!
//! `cargo run --example wall -p stoss-watch`

use std::error::Error;
use stoss_mesh::{Elements, Mesh, generate::Block};
use stoss_watch::{FindingKind, Judge, Limits, Severity, Watch, WatchBody, WatchModel, WatchShape};

fn main() -> Result<(), Box<dyn Error>> {
    let wall = Block::new([0.0, -2.0, -2.0], [0.6, 2.0, 2.0], [2, 8, 8]).generate()?;
    let cube = Block::new([-0.2; 3], [0.2; 3], [2, 2, 2]).generate()?;
    let first = wall.nodes.len() as u32;
    let body = |name: &str, mesh: &Mesh, first: u32| {
        let mut elements = Elements::new();
        elements.extend(&mesh.elements, |node| node + first);
        let nodes = first..first + mesh.nodes.len() as u32;
        WatchBody { name: name.into(), nodes, shape: WatchShape::Solid(elements) }
    };
    // Positions of both bodies, the centre of the cube at a place.
    let at = |centre: [f64; 3]| -> Vec<f64> {
        let cube = cube.nodes.iter().flat_map(|x| (0..3).map(|i| x[i] + centre[i]));
        wall.nodes.iter().flatten().copied().chain(cube).collect()
    };
    let start = [-1.0, 0.1, 0.2];
    for (what, places, level, kind) in [
        ("past the wall", [[-0.7, 1.5, 0.2], [-0.5, 3.0, 0.2]], Severity::Sound, None),
        ("a little into it", [[-0.5, 0.1, 0.2], [-0.1, 0.1, 0.2]], Severity::Doubtful, Some(FindingKind::Penetration)),
        ("deep into it", [[-0.5, 0.1, 0.2], [0.1, 0.1, 0.2]], Severity::Wrong, Some(FindingKind::Penetration)),
        ("through it", [[-0.5, 0.1, 0.2], [1.2, 0.1, 0.2]], Severity::Wrong, Some(FindingKind::Tunnelling)),
    ] {
        let bodies = vec![body("wall", &wall, 0), body("cube", &cube, first)];
        let mut judge = Judge::new(bodies.iter().map(|b| (b.name.clone(), b.nodes.clone())), vec![], Limits::default());
        let mut watch = Watch::new(WatchModel { bodies, reference: at(start), ties: Vec::new() })?;
        let mut before = at(start);
        for (step, place) in (1..).zip(places) {
            let now = at(place);
            let (seen, solids) = (watch.geometry(&now, Some(&before)), watch.solids(&now));
            judge.observe(step, 0.1 * step as f64, &seen, &solids);
            before = now;
        }
        let verdict = judge.verdict();
        println!("{what}: {verdict}");
        assert_eq!(verdict.level, level);
        assert_eq!(verdict.reasons.first().map(|finding| finding.kind), kind);
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
