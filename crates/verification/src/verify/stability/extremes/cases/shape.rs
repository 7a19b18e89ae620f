//! Distorted and flat elements.

use super::super::case::{CONTACT, Case, FREE, Oracle, Touch};
use super::super::scene::{Block, Matter, Scene};
use super::solids::{bending, stretched};

/// Half of the thickness of a flat element; its other edges are 0.5.
const FLAT: f64 = 0.005;

/// A cube of eight hexahedra as an Abaqus file: the middle node is moved, and so are the middles of the faces, within their
/// planes. Every element is distorted, the sides stay flat.
fn distorted_cube() -> String {
    let mut text = String::from("*NODE\n");
    let number = |i: usize, j: usize, k: usize| 1 + i + 3 * (j + 3 * k);
    for k in 0..3 {
        for j in 0..3 {
            for i in 0..3 {
                let inner = [i == 1, j == 1, k == 1];
                let count = inner.iter().filter(|inner| **inner).count();
                // By how much a node moves along the axes along which it is in the middle.
                let moved = [0.15, -0.12, 0.1].map(|by| if count >= 2 { by } else { 0.0 });
                let x: Vec<f64> = [i, j, k]
                    .iter()
                    .zip(inner.iter().zip(moved))
                    .map(|(at, (inner, by))| 0.5 * *at as f64 + if *inner { by } else { 0.0 })
                    .collect();
                text += &format!("{}, {}, {}, {}\n", number(i, j, k), x[0], x[1], x[2]);
            }
        }
    }
    text += "*ELEMENT, TYPE=C3D8\n";
    for (element, corner) in (0..8).map(|e| (e, [e % 2, e / 2 % 2, e / 4])) {
        let [i, j, k] = corner;
        let ring = |k: usize| [number(i, j, k), number(i + 1, j, k), number(i + 1, j + 1, k), number(i, j + 1, k)];
        let nodes: Vec<String> = ring(k).iter().chain(&ring(k + 1)).map(usize::to_string).collect();
        text += &format!("{}, {}\n", element + 1, nodes.join(", "));
    }
    text
}

fn distorted(poisson: f64, stretch: f64) -> Case {
    let matter = Matter::new(1e3, 1.0).poisson(poisson);
    let mut scene = Scene::new(None, 0.1, 10, 10).body("b", "{ file = \"distorted-cube.inp\" }", matter, "");
    let sides = [("left", 0, 0), ("right", 0, 1), ("front", 1, 0), ("bottom", 2, 0), ("top", 2, 1)];
    for (name, axis, at) in sides {
        let (mut point, mut normal) = ([0.0; 3], [0.0; 3]);
        (point[axis], normal[axis]) = (f64::from(at), 1.0);
        scene = scene.also(&format!(
            "\n[[set]]\nname = \"b.{name}\"\nbody = \"b\"\nplane = {{ point = {point:?}, normal = {normal:?} }}\n"
        ));
    }
    let case = stretched("distorted elements", scene, matter, stretch);
    let combination = format!("{} with nu {poisson}", case.combination);
    Case { files: vec![("distorted-cube.inp".into(), distorted_cube())], ..case.named(combination) }
}

/// A flat plate that spins about an oblique axis and stretches.
fn flight(scheme: &'static str) -> Case {
    let block = Block { min: [-1.0, -1.0, -2.0 * FLAT], max: [1.0, 1.0, 2.0 * FLAT], divisions: [2, 2, 2] };
    let motion = "angular_velocity = [3.0, 4.0, 10.0]\n\
                  velocity_gradient = [[5.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]\n";
    let scene = Scene::new(Some(scheme), 0.01, 30, 10).moving("b", block, Matter::new(2250.0, 0.1), motion, 15.0);
    Case::new("flight of flat elements", Some(scheme), scene, Oracle::Conservation)
}

/// A flat plate falls on another one.
fn contact(combination: (&'static str, &'static str)) -> Case {
    let matter = Matter::new(1e3, 1.0);
    let lower = Block { min: [-1.0, -1.0, -2.0 * FLAT], max: [1.0, 1.0, 0.0], divisions: [4, 4, 2] };
    let upper = Block { min: [-0.6, -0.6, 0.002], max: [0.6, 0.6, 0.002 + 2.0 * FLAT], divisions: [3, 3, 2] };
    let scene = Scene::new(Some(combination.0), 5e-4, 40, 10)
        .block("lower", lower, matter, [0.0; 3])
        .block("upper", upper, matter, [0.1, 0.03, -1.0])
        .contact("upper.bottom", "lower.top", combination.1);
    Case::contact("contact of flat elements", combination, scene, Touch::UPPER)
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for poisson in [0.3, 0.49999] {
        cases.extend([0.5, 2.0].map(|stretch| distorted(poisson, stretch)));
    }
    let matter = Matter::new(1e3, 1.0);
    for stretch in [0.5, 2.0] {
        // Sides of length 1 as the closed form has it; two hundred layers.
        let block = Block { min: [0.0; 3], max: [1.0; 3], divisions: [1, 1, 100] };
        let scene = Scene::new(None, 0.1, 10, 10).block("b", block, matter, [0.0; 3]);
        cases.push(stretched("tension of flat elements", scene, matter, stretch));
    }
    cases.push(bending("bending of long elements", 0.3, 100.0, [1, 1, 1]));
    cases.extend(FREE.map(flight));
    cases.extend(CONTACT.map(contact));
    cases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distorted_cube_is_filled() {
        let text = distorted_cube();
        let rows = |from: &str| -> Vec<Vec<f64>> {
            let (_, rest) = text.split_once(from).unwrap();
            let rows = rest.lines().skip(1).take_while(|line| !line.starts_with('*'));
            rows.map(|row| row.split(", ").map(|entry| entry.parse().unwrap()).collect()).collect()
        };
        let (nodes, elements) = (rows("*NODE"), rows("*ELEMENT"));
        assert_eq!((nodes.len(), elements.len()), (27, 8));
        // Node 14 is the middle; nodes 2 and 5 are the middles of an edge and of the bottom.
        assert_eq!(nodes[13][1..], [0.65, 0.38, 0.6]);
        assert_eq!(nodes[1][1..], [0.5, 0.0, 0.0]);
        assert_eq!(nodes[4][1..], [0.65, 0.38, 0.0]);
        assert_eq!(elements[7][1..], [14.0, 15.0, 18.0, 17.0, 23.0, 24.0, 27.0, 26.0]);
    }
}
