//! The mortar method on warped facets, over edges, at corners, beyond the rim, and between meshes of very different size.

use super::super::case::{Case, Oracle, TRUE_GAP, Touch, UPPER, Word};
use super::super::evidence::Evidence;
use super::super::geometry::Side;
use super::super::scene::{Block, Matter, Scene};
use crate::workspace::Outcome;

/// Schemes; mortar contact has one constraint.
const SCHEMES: [(&str, &str); 3] =
    [("energy-momentum", TRUE_GAP), ("midpoint", TRUE_GAP), ("backward-euler", TRUE_GAP)];

const STEP: f64 = 0.004;
const SOFT: f64 = 1e3;

/// Everything on the skin of a body.
fn skin(body: &str) -> String {
    format!("\n[[set]]\nname = \"{body}.skin\"\nbody = \"{body}\"\nbox = {{ min = [-9, -9, -9], max = [9, 9, 9] }}\n")
}

/// A free impact; slave are these nodes of the upper body.
fn impact(family: &str, (scheme, constraint): (&'static str, &'static str), side: Side, scene: Scene) -> Case {
    let (slave, master) = if side == Side::All { ("upper.skin", "lower.skin") } else { ("upper.bottom", "lower.top") };
    let scene = scene.mortar(slave, master);
    let case = Case::contact(format!("mortar: {family}"), (scheme, constraint), scene, Touch { slave: UPPER, side });
    Case { renews_integrals: true, ..case }
}

/// Two twisted surfaces of one facet each, which fit, fall on each other turned by some degrees.
fn warped(combination: (&'static str, &'static str)) -> Case {
    let body = |z: [f64; 8]| {
        let corner = |k: usize| [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]][k % 4];
        let corners: Vec<[f64; 3]> = (0..8).map(|k| [corner(k)[0], corner(k)[1], z[k]]).collect();
        format!("{{ generator = \"hexahedron\", divisions = [1, 1, 2], corners = {corners:?} }}")
    };
    let t = 0.2;
    let lower = body([-1.0, -1.0, -1.0, -1.0, t, -t, t, -t]);
    let upper = body([t, -t, t, -t, 1.0, 1.0, 1.0, 1.0]);
    let motion = "rotation = [{ axis = [0, 0, 1], degrees = 20 }]\nposition = [0.05, 0.03, 0.1]\n\
                  velocity = [0.0, 0.0, -1.0]\n";
    let scene = Scene::new(Some(combination.0), STEP, 60, 10)
        .body("lower", &lower, Matter::new(SOFT, 1.0), "")
        .body("upper", &upper, Matter::new(SOFT, 1.0), motion)
        .scales(2.0, 1.0, 1.1);
    impact("warped facets", combination, Side::Bottom, scene)
}

/// A soft sheet falls on the edge of a block and folds over it.
fn folding(combination: (&'static str, &'static str)) -> Case {
    let edge = 0.5;
    let motion = "rotation = [{ axis = [0, 1, 0], degrees = 45 }]\n";
    let block = format!("{{ generator = \"block\", size = [{edge}, 1.0, {edge}], divisions = [2, 4, 2] }}");
    let height = edge * 0.5_f64.sqrt() + 0.02;
    let sheet = Block { min: [-0.75, -0.4, height], max: [0.75, 0.4, height + 0.1], divisions: [12, 2, 2] };
    let scene = Scene::new(Some(combination.0), STEP, 40, 10)
        .body("lower", &block, Matter::new(100.0 * SOFT, 100.0), motion)
        .scales(100.0 * edge * edge, 0.0, 0.6)
        .block("upper", sheet, Matter::new(SOFT, 1.0), [0.0, 0.0, -3.0])
        .also(&skin("lower"))
        .mortar("upper.bottom", "lower.skin");
    let touch = Touch { slave: UPPER, side: Side::Bottom };
    let case = Case::contact("mortar: sheet folds over an edge", combination, scene, touch);
    Case { renews_integrals: true, ..case }
}

/// Two cubes that stand on their vertices meet with these.
fn corners(combination: (&'static str, &'static str)) -> Case {
    // Angle between a cube's edge and its diagonal, in degrees: `atan(sqrt 2)`.
    let turn = "rotation = [{ axis = [0, 0, 1], degrees = 45 }, { axis = [1, 0, 0], degrees = 54.735610317245346 }]\n";
    let edge = 0.5;
    let cube = format!("{{ generator = \"block\", size = [{edge}, {edge}, {edge}], divisions = [2, 2, 2] }}");
    let height = 2.0 * edge * 0.75_f64.sqrt() + 0.01;
    let scene = Scene::new(Some(combination.0), STEP, 40, 10)
        .body("lower", &cube, Matter::new(SOFT, 1.0), turn)
        .body(
            "upper",
            &cube,
            Matter::new(SOFT, 1.0),
            &format!("{turn}position = [0.02, 0.01, {height:?}]\nvelocity = [0.0, 0.0, -1.0]\n"),
        )
        .scales(2.0 * edge.powi(3), 1.0, 1.4)
        .also(&skin("lower"))
        .also(&skin("upper"));
    impact("corner to corner", combination, Side::All, scene)
}

/// In which directions facets differ by 20, and whether there is friction.
#[derive(Clone, Copy)]
enum Contrast {
    /// Along x.
    One,
    /// Along x and y: one facet against 400 or more.
    Both,
    /// Along x and y, with friction.
    Friction,
}

/// A block falls on a plate, whose facets are shorter or longer by 20.
fn contrast(combination: (&'static str, &'static str), finer: bool, contrast: Contrast) -> Case {
    let (width, divisions) = match (contrast, finer) {
        (Contrast::One, true) => ([0.2, 0.1], [[48, 1, 2], [2, 1, 2]]),
        (Contrast::One, false) => ([0.2, 0.1], [[2, 1, 2], [40, 1, 2]]),
        (_, true) => ([1.2, 1.0], [[24, 24, 1], [1, 1, 1]]),
        (_, false) => ([1.2, 1.0], [[1, 1, 1], [20, 20, 1]]),
    };
    let [lower, upper] = width.map(|w| w / 2.0);
    let plate = Block { min: [-0.6, -lower, -0.5], max: [0.6, lower, 0.0], divisions: divisions[0] };
    let block = Block { min: [-0.5, -upper, 0.01], max: [0.5, upper, 0.51], divisions: divisions[1] };
    let scene = Scene::new(Some(combination.0), STEP, 30, 10)
        .block("lower", plate, Matter::new(SOFT, 1.0), [0.0; 3])
        .block("upper", block, Matter::new(SOFT, 1.0), [0.1, 0.05, -1.0]);
    let size = if finer { "finer" } else { "coarser" };
    let ways = match contrast {
        Contrast::One => "",
        Contrast::Both => " both ways",
        Contrast::Friction => " both ways, friction",
    };
    let family = format!("master {size} by 20{ways}");
    let mut case = impact(&family, combination, Side::Bottom, scene);
    if let Contrast::Friction = contrast {
        // A key of the contact, which is the last thing in the scene.
        case.scene = case.scene.also("friction = { law = \"coulomb\", mu = 0.3 }\n");
    }
    case
}

/// A block is pressed on a slab, pushed over its edge until it hangs in the air, and back: without friction the force is
/// the one that was there before.
fn off_and_on(upper_is_slave: bool) -> Case {
    let lower = Block { min: [-1.0, -0.5, -0.5], max: [0.5, 0.5, 0.0], divisions: [6, 4, 2] };
    let upper = Block { min: [-0.3, -0.25, 0.0], max: [0.2, 0.25, 0.5], divisions: [3, 3, 2] };
    let (slave, master, touch) = if upper_is_slave {
        ("upper.bottom", "lower.top", Touch::UPPER)
    } else {
        ("lower.top", "upper.bottom", Touch::LOWER)
    };
    let path = "[[0.0, 0.0, 0.0, 0.0], [0.2, 0.0, 0.0, -0.05], [0.6, 1.0, 0.0, -0.05], [1.0, 0.0, 0.0, -0.05]]";
    let scene = Scene::new(None, 0.02, 50, 10)
        .block("lower", lower, Matter::new(SOFT, 1.0), [0.0; 3])
        .block("upper", upper, Matter::new(10.0 * SOFT, 1.0), [0.0; 3])
        .mortar(slave, master)
        .fixed("lower.bottom", &["x", "y", "z"])
        .also(&format!(
            "\n[[prescribe]]\nset = \"upper.top\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = {{ table = {path} }}\n"
        ))
        .probe("f", "upper.top", "reaction");
    let error = |evidence: &Evidence| -> Outcome<f64> {
        let table = evidence.run.table("probes.csv")?;
        let (time, force) = (table.column("time")?, table.column("f.z")?);
        let at = |t: f64| time.iter().position(|x| (x - t).abs() < 1e-9).map(|k| force[k]).ok_or("no such time");
        let (before, middle, after) = (at(0.2)?, at(0.6)?, at(1.0)?);
        Ok((after / before - 1.0).abs().max((middle / before).abs()))
    };
    let about = "force after the way out and back against that before, and the force in the air, relative";
    let oracle = Oracle::Closed { about, error: Box::new(error), bound: 1e-6, otherwise: Word::Drifts };
    let case = Case::new("mortar: off an edge and back on", None, scene, oracle);
    Case { touch: Some(touch), ..case.named(if upper_is_slave { "block is slave" } else { "slab is slave" }) }
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let mut cases = vec![off_and_on(true), off_and_on(false)];
    for combination in SCHEMES {
        cases.push(warped(combination));
        cases.push(folding(combination));
        cases.push(corners(combination));
        for finer in [true, false] {
            cases.push(contrast(combination, finer, Contrast::One));
            cases.push(contrast(combination, finer, Contrast::Both));
            // Friction is for constraints that close gaps.
            if combination.1 != "modified" {
                cases.push(contrast(combination, finer, Contrast::Friction));
            }
        }
    }
    cases
}
