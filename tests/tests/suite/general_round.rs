//! Surfaces of linear cells that the scene calls round: contact sees the cylinder or the sphere.

use crate::general_contact::{MATERIAL, cube, head, try_build};
use crate::support::simulation;

/// A cylinder of radius 0.5 about an oblique axis, and its axis.
fn cylinder(round: &str) -> (String, [[f64; 3]; 2]) {
    let text = format!(
        "[[body]]\nname = \"c\"\nmesh = {{ generator = \"cylinder\", radius = 0.5, length = 1, divisions = [2, 2, 1, 2] }}\n\
         rotation = {{ axis = [1, 1, 0], degrees = 90 }}\nposition = [3, -2, 1]\n{MATERIAL}\n{round}\n"
    );
    // y turned by a quarter about (1, 1, 0)/sqrt 2.
    (text, [[3.0, -2.0, 1.0], [0.5, 0.5, 0.5f64.sqrt()]])
}

const ROUND: &str = "round = [{ set = \"outer\", surface = \"cylinder\" }]";

/// Vertices of the finer facets lie on the cylinder, wherever it is; those of end faces lie inside of it.
#[test]
fn vertices_lie_on_the_cylinder() {
    let (text, [origin, axis]) = cylinder(ROUND);
    let other = cube("a", [9.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 1);
    let built = try_build(&(head("energy-momentum", 0.1, 1.0) + &text + &other)).unwrap();
    let model = built.simulation.model();
    let radius = |node: u32| {
        let x: [f64; 3] = std::array::from_fn(|i| model.reference[3 * node as usize + i] - origin[i]);
        let along: f64 = x.iter().zip(axis).map(|(x, a)| x * a).sum();
        x.iter().zip(axis).map(|(x, a)| (x - along * a).powi(2)).sum::<f64>().sqrt()
    };
    let radii: Vec<f64> = model.traces.keys().map(|&node| radius(node)).collect();
    // 16 sides along the rim, each with two points, at three places along the axis; facets on the cylinder have nothing inside, those of the end faces at it a middle.
    let on = radii.iter().filter(|r| (*r - 0.5).abs() < 1e-12).count();
    assert!(on > 0 && on % 6 == 0, "{on} of {radii:?}");
    assert!(radii.iter().all(|r| *r < 0.5 + 1e-12), "{radii:?}");
}

#[test]
fn what_is_not_round_is_refused() {
    for (round, expected) in [
        ("round = [{ set = \"outer\", surface = \"sphere\" }]", "off the sphere that fits best"),
        ("round = [{ set = \"front\", surface = \"cylinder\" }]", "round[0].set"),
        ("round = [{ set = \"nowhere\", surface = \"cylinder\" }]", "body[0].round[0].set = nowhere"),
        ("cell = \"quadratic\"\nround = [{ set = \"outer\", surface = \"cylinder\" }]", "curved already"),
    ] {
        let (text, _) = cylinder(round);
        let other = cube("a", [9.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 1);
        let message = try_build(&(head("energy-momentum", 0.1, 1.0) + &text + &other)).unwrap_err();
        assert!(message.contains(expected), "{round}: {message}");
    }
}

/// Mortar contact has flat facets, and says so.
#[test]
fn round_surfaces_that_no_contact_knows_are_told() {
    let (text, _) = cylinder(ROUND);
    let other = cube("a", [9.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 1);
    let scene = head("energy-momentum", 0.1, 1.0).replace("[general_contact]", "") + &text + &other;
    for (contact, expected) in [
        ("[[contact]]\nmethod = \"mortar\"\nslave = \"c.outer\"\nmaster = \"a.boundary\"\n", true),
        ("[[contact]]\nmethod = \"nts\"\nslave = \"c.outer\"\nmaster = \"a.boundary\"\n", false),
    ] {
        let warnings = try_build(&(scene.clone() + contact)).unwrap().warnings;
        assert_eq!(warnings.iter().any(|w| w.contains("`round` of body c has no effect")), expected, "{warnings:?}");
    }
}

/// Points beside the elements are linear in the nodes: energy and momenta are exact in an impact as with any others.
#[test]
fn round_surfaces_conserve() {
    let ball = format!(
        "[[body]]\nname = \"b\"\nmesh = {{ generator = \"ball\", radius = 0.5, divisions = [2, 2, 2] }}\nposition = [0.1, 0.05, 1.02]\nvelocity = [0.1, 0, -0.2]\n{MATERIAL}\n\
         round = [{{ set = \"outer\", surface = \"sphere\" }}]\n"
    );
    let block = cube("a", [0.0; 3], [0.0, 0.0, 1.0], 10.0, [0.0; 3], 2);
    let mut run = simulation(&(head("energy-momentum", 0.02, 0.5) + &ball + &block));
    let start = *run.balance();
    let size = start.linear_momentum.iter().map(|p| p * p).sum::<f64>().sqrt();
    let mut touched = 0;
    while !run.finished() {
        let record = run.advance().unwrap_or_else(|e| panic!("{e}"));
        touched += usize::from(!record.contact.as_ref().unwrap().bodies.is_empty());
        assert!((record.balance.total() / start.total() - 1.0).abs() < 1e-9, "{:?}", record.balance);
        for i in 0..3 {
            assert!((record.balance.linear_momentum[i] - start.linear_momentum[i]).abs() < 1e-11 * size);
            assert!((record.balance.angular_momentum[i] - start.angular_momentum[i]).abs() < 1e-10 * size);
        }
    }
    assert!(touched > 5, "{touched}");
}
