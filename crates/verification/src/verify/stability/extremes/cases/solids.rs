//! Nearly incompressible bodies and follower pressures.

use super::super::case::{Case, FREE, Oracle, Word};
use super::super::evidence::Evidence;
use super::super::scene::{Block, Matter, Scene};
use super::closed_forms::{hydrostatic_neo_hooke, hydrostatic_saint_venant_kirchhoff, uniaxial};
use crate::workspace::Outcome;

/// Forces to the tolerance of Newton's method, displacements alike: bodies of size 1.
pub const STATIC: f64 = 1e-9;

/// Part of the deflection that may be missing on a mesh with two elements through the thickness.
const BENDING: f64 = 0.15;

/// A unit cube.
pub const CUBE: Block = Block { min: [0.0; 3], max: [1.0; 3], divisions: [2, 2, 2] };

/// Smooth supports of a cube on three sides.
pub fn supported(scene: Scene) -> Scene {
    scene.fixed("b.left", &["x"]).fixed("b.front", &["y"]).fixed("b.bottom", &["z"])
}

/// Stretches a supported cube of a mesh with sides 1 to `stretch` along z.
pub fn stretched(family: &str, scene: Scene, matter: Matter, stretch: f64) -> Case {
    let scene = supported(scene).pulled("b.top", "z", stretch - 1.0).probe("f", "b.top", "reaction").probe(
        "x",
        "b.right",
        "displacement",
    );
    let (lateral, stress) = uniaxial(&matter, stretch);
    let error = move |evidence: &Evidence| -> Outcome<f64> {
        let force = (evidence.probe("f.z")? / stress - 1.0).abs();
        Ok(force.max((evidence.probe("x.x")? - (lateral - 1.0)).abs()))
    };
    let about = "force (relative) and lateral displacement against the homogeneous solution";
    let oracle = Oracle::Closed { about, error: Box::new(error), bound: STATIC, otherwise: Word::Drifts };
    Case::new(family, None, scene, oracle).named(format!("quasi-static to {stretch}"))
}

/// A cantilever under a small load at its end, against Euler and Bernoulli's deflection.
pub fn bending(family: &str, poisson: f64, length: f64, divisions: [u32; 3]) -> Case {
    let matter = Matter::new(1e3, 1.0).poisson(poisson);
    let block = Block { min: [0.0; 3], max: [length, 1.0, 1.0], divisions };
    let deflection = 1e-4 * length;
    let force = deflection * 3.0 * matter.young / 12.0 / length.powi(3);
    let scene = Scene::new(None, 1.0, 1, 10)
        .block("b", block, matter, [0.0; 3])
        .fixed("b.left", &["x", "y", "z"])
        .also(&format!("\n[[load]]\nset = \"b.right\"\ntraction = [0.0, 0.0, {force:?}]\n"))
        .probe("tip", "b.right", "displacement");
    let error = move |evidence: &Evidence| -> Outcome<f64> { Ok((1.0 - evidence.probe("tip.z")? / deflection).abs()) };
    let about = "missing part of the deflection of a slender beam";
    let oracle = Oracle::Closed { about, error: Box::new(error), bound: BENDING, otherwise: Word::Locks };
    Case::new(family, None, scene, oracle)
}

/// A cube under a pressure on all its sides.
fn squeezed(law: &'static str) -> Case {
    let matter = Matter { law, ..Matter::new(1e3, 1.0) };
    let pressure = 5e3;
    let mut scene = supported(Scene::new(None, 0.05, 20, 6).block("b", CUBE, matter, [0.0; 3]));
    for side in ["left", "right", "front", "back", "bottom", "top"] {
        scene = scene.follower(&format!("b.{side}"), pressure);
    }
    let scene = scene.probe("x", "b.right", "displacement");
    let stretch = match law {
        "neo-hooke" => hydrostatic_neo_hooke(&matter, pressure),
        _ => hydrostatic_saint_venant_kirchhoff(&matter, pressure),
    };
    let error = move |evidence: &Evidence| -> Outcome<f64> { Ok((evidence.probe("x.x")? - (stretch - 1.0)).abs()) };
    let about = "displacement against the hydrostatic solution";
    let oracle = Oracle::Closed { about, error: Box::new(error), bound: STATIC, otherwise: Word::Drifts };
    Case::new("hydrostatic follower pressure", None, scene, oracle).named(format!("quasi-static {law}"))
}

/// Presses the top of a block that is held at its bottom through it: the law softens in compression, there is no solution.
fn inverted(scheme: Option<&'static str>) -> Case {
    let matter = Matter { law: "saint-venant-kirchhoff", ..Matter::new(1e3, 1.0) };
    let scene = Scene::new(scheme, 0.05, 20, 6)
        .block("b", CUBE, matter, [0.0; 3])
        .fixed("b.bottom", &["x", "y", "z"])
        .follower("b.top", 5e3);
    let case = Case::new("inverting follower pressure", scheme, scene, Oracle::Fails);
    Case { free: false, ..case }
}

/// A bar that spins and stretches without changing its volume, at first.
fn flight(poisson: f64, scheme: &'static str) -> Case {
    let block = Block { min: [-0.5, -0.5, -1.0], max: [0.5, 0.5, 1.0], divisions: [2, 2, 4] };
    let motion = "velocity = [1.0, 2.0, 0.5]\nangular_velocity = [3.0, 1.0, 2.5]\n\
                  velocity_gradient = [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 2.0]]\n";
    let matter = Matter::new(2250.0, 0.1).poisson(poisson);
    let scene = Scene::new(Some(scheme), 0.01, 30, 10).moving("b", block, matter, motion, 5.0);
    Case::new(format!("flight, nu {poisson}"), Some(scheme), scene, Oracle::Conservation)
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for poisson in [0.499, 0.49999] {
        for stretch in [0.5, 2.0] {
            let matter = Matter::new(1e3, 1.0).poisson(poisson);
            let scene = Scene::new(None, 0.1, 10, 10).block("b", CUBE, matter, [0.0; 3]);
            cases.push(stretched(&format!("tension, nu {poisson}"), scene, matter, stretch));
        }
        cases.extend(FREE.map(|scheme| flight(poisson, scheme)));
    }
    cases.push(bending("bending, nu 0.3", 0.3, 10.0, [20, 2, 2]));
    cases.push(bending("bending, nu 0.49999", 0.49999, 10.0, [20, 2, 2]));
    cases.extend(["neo-hooke", "saint-venant-kirchhoff"].map(squeezed));
    cases.push(inverted(None));
    cases.extend(FREE.map(|scheme| inverted(Some(scheme))));
    cases
}
