//! Statics: two blocks of equal modulus between fixed planes, with a gap that the upper plane closes, or an overlap.

use super::super::case::{Deviation, Problem, Seen};
use super::super::text::{Block, PLAIN, Text};
use super::YOUNG;

/// Part of the force that the method may be off.
const TOLERANCE: f64 = 0.05;

/// Overlap, in parts of the height of both, that general contact takes for surfaces which touch: what coordinates of a file leave.
const ROUNDED: f64 = 2e-6;

/// The scene for a method: a block 1 x 1 x 1 on a quarter of one of 2 x 2 x 1, whose faces have a distance `gap` (negative: they overlap). The top is pushed down by `push`.
pub fn problem(method: &str, gap: f64, push: f64) -> Problem {
    // Both blocks, together 2 high, are pressed to `2 - drive`; a Poisson's ratio of zero.
    let drive = push - gap;
    let stretch = 0.5 * (2.0 - drive);
    let pressure = 0.5 * YOUNG * (1.0 / stretch - stretch);
    let block = |name, corners, divisions| Block {
        name,
        corners,
        divisions,
        young: YOUNG,
        poisson: 0.0,
        density: 0.0,
        more: String::new(),
    };
    let mut text = Text::statics(PLAIN, 0.25, 1.0)
        .block(&block("lower", [[0.0, 0.0, -1.0], [2.0, 2.0, 0.0]], [4, 4, 2]))
        .block(&block("upper", [[0.0, 0.0, gap], [1.0, 1.0, 1.0 + gap]], [2, 2, 2]))
        .set("lower", "beside", [[1.0, 0.0, 0.0], [2.0, 2.0, 0.0]])
        .set("lower", "behind", [[0.0, 1.0, 0.0], [1.0, 2.0, 0.0]]);
    for set in ["lower.left", "upper.left"] {
        text = text.fixed(set, &["x"]);
    }
    for set in ["lower.front", "upper.front"] {
        text = text.fixed(set, &["y"]);
    }
    text = text.fixed("lower.bottom", &["z"]).table(&format!(
        "[[prescribe]]\nset = \"upper.top\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0, 0], [1, {:?}]] }}",
        -push
    ));
    for set in ["lower.beside", "lower.behind"] {
        text = text.pressed(set, pressure, 1.0);
    }
    let text = text.contact(method, ["upper.bottom", "lower.top"], 0.0).probe(
        "force",
        "contact_force",
        "set = \"upper.bottom\"",
    );
    let rounded = if method == "general" { ROUNDED * YOUNG } else { 0.0 };
    let oracle = Box::new(move |seen: &Seen| {
        let off = (seen.last("force.z")? - pressure).abs() - rounded;
        // Without a drive there is no force to measure by: that of a millionth of the height.
        Ok(vec![Deviation::zero("force", off.max(0.0) / pressure.max(1e-6 * YOUNG), TOLERANCE)])
    });
    Problem { text, oracle }
}
