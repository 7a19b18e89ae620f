//! Slave nodes exactly on vertices, edges and diagonals of the master's facets.

use super::super::case::{CONTACT, Case, Touch, UPPER};
use super::super::geometry::Side;
use super::super::scene::{Block, Matter, Scene};

/// Master with facets of edge 0.5 and a node in its middle.
const LOWER: Block = Block { min: [-1.0, -1.0, -1.0], max: [1.0, 1.0, 0.0], divisions: [4, 4, 2] };

/// Angle between a cube's edge and its diagonal, in degrees: `atan(sqrt 2)`.
const DIAGONAL: f64 = 54.735_610_317_245_35;

const STEP: f64 = 0.004;

fn lower(scheme: &str) -> Scene {
    Scene::new(Some(scheme), STEP, 40, 10).block("lower", LOWER, Matter::new(1e3, 1.0), [0.0; 3])
}

/// A cube falls flat: of its nine slave nodes four are on vertices of the master, four on edges, and one on the diagonals of a facet;
/// with a velocity along the diagonal they all leave them at once.
fn flat(family: &str, combination: (&'static str, &'static str), velocity: [f64; 3]) -> Case {
    let upper = Block { min: [0.0, 0.0, 0.01], max: [0.5, 0.5, 0.51], divisions: [2, 2, 2] };
    let scene = lower(combination.0).block("upper", upper, Matter::new(1e3, 1.0), velocity).contact(
        "upper.bottom",
        "lower.top",
        combination.1,
    );
    Case::contact(family, combination, scene, Touch::UPPER)
}

/// A cube that stands on its vertex falls on a point of the master and slides along x.
fn pointed(family: &str, combination: (&'static str, &'static str), at: [f64; 2]) -> Case {
    let edge = 0.5;
    let height = 0.01 + edge * 0.75_f64.sqrt();
    let motion = format!(
        "rotation = [{{ axis = [0, 0, 1], degrees = 45 }}, {{ axis = [1, 0, 0], degrees = {DIAGONAL:?} }}]\n\
         position = [{:?}, {:?}, {height:?}]\nvelocity = [0.1, 0.0, -1.0]\n",
        at[0], at[1]
    );
    let mesh = format!("{{ generator = \"block\", size = [{edge}, {edge}, {edge}], divisions = [2, 2, 2] }}");
    let scene = lower(combination.0)
        .body("upper", &mesh, Matter::new(1e3, 1.0), &motion)
        .scales(edge.powi(3), 1.0, 1.0)
        .also("\n[[set]]\nname = \"upper.skin\"\nbody = \"upper\"\nbox = { min = [-9, -9, -9], max = [9, 9, 9] }\n")
        .contact("upper.skin", "lower.top", combination.1);
    Case::contact(family, combination, scene, Touch { slave: UPPER, side: Side::All })
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for combination in CONTACT {
        cases.push(flat("vertex, edges and diagonal at once", combination, [0.0, 0.0, -1.0]));
        cases.push(flat("sliding along the diagonals", combination, [1.0, 1.0, -1.0]));
        cases.push(pointed("cube's vertex on a vertex", combination, [0.0, 0.0]));
        cases.push(pointed("cube's vertex on an edge", combination, [0.25, 0.0]));
        cases.push(pointed("cube's vertex on a diagonal", combination, [0.15, 0.15]));
    }
    cases
}
