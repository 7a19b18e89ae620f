//! The two blocks of the thesis (theory/examples#two-elements) with a step of a millionth and of ten times its 0.1.

use super::super::case::{CONTACT, Case, Touch};
use super::super::scene::{Block, Matter, Scene};

/// The lower block of the thesis: its upper side is a general quadrilateral.
const LOWER: &str = "{ generator = \"hexahedron\", divisions = [1, 1, 1], corners = [\
    [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.2, 1.0, 0.0], [-1.5, 1.5, 0.0], \
    [-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.2, 1.0, 1.0], [-1.5, 1.5, 1.0]] }";

/// Step of the thesis.
const STEP: f64 = 0.1;

fn case(family: &str, combination: (&'static str, &'static str), factor: f64, gap: f64) -> Case {
    // Lamé's constants 1298.1 and 865.3846.
    let matter = Matter::new(2250.0, 1000.0);
    let upper = Block { min: [-0.5, -1.0, 1.0 + gap], max: [0.5, 0.0, 2.0 + gap], divisions: [1, 1, 1] };
    let scene = Scene::new(Some(combination.0), factor * STEP, 20, 10)
        .body("lower", LOWER, matter, "")
        // Half of the cross product of its diagonals (2.2, 2) and (-2.5, 2.5), times the density.
        .scales(5.25e3, 0.0, 2.0)
        .block("upper", upper, matter, [0.0, 0.1, -0.04])
        .contact("upper.bottom", "lower.top", combination.1);
    Case::contact(family, combination, scene, Touch::UPPER)
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let tiny = CONTACT.map(|combination| case("thesis' step times 1e-6", combination, 1e-6, 1e-8));
    let large = CONTACT.map(|combination| case("thesis' step times 10", combination, 10.0, 0.1));
    tiny.into_iter().chain(large).collect()
}
