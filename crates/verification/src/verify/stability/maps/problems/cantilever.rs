//! Statics: a cantilever of square section under a force at its tip, with one element across.

use super::super::case::{Deviation, Problem, Seen};
use super::super::text::{Block, PLAIN, Text};
use super::YOUNG;

/// Part of the deflection that eight elements may be off.
const TOLERANCE: f64 = 0.15;

/// A cantilever of height and width 1 of cells with the keys `cell`, by a small deflection: `P L^3 / (3 E I) + P L / (k G A)`, `k = 5/6`, after Timoshenko.
pub fn problem(cell: &str, length: f64, poisson: f64) -> Problem {
    let (inertia, shear) = (1.0 / 12.0, 5.0 / 6.0 * YOUNG / (2.0 * (1.0 + poisson)));
    let force = 0.001 * length * 3.0 * YOUNG * inertia / length.powi(3);
    let expected = force * length.powi(3) / (3.0 * YOUNG * inertia) + force * length / shear;
    let block = Block {
        name: "bar",
        corners: [[0.0; 3], [length, 1.0, 1.0]],
        divisions: [8, 1, 1],
        young: YOUNG,
        poisson,
        density: 0.0,
        more: cell.into(),
    };
    let text = Text::statics(PLAIN, 1.0, 1.0)
        .block(&block)
        .fixed("bar.left", &["x"])
        .fixed("bar.left & y < 0.1 & z < 0.1", &["y", "z"])
        .fixed("bar.left & y < 0.1 & z > 0.9", &["y"])
        .table(&format!(
            "[[load]]\nset = \"bar.right\"\ntraction = {{ table = [[0, 0, 0, 0], [1, 0, 0, {:?}]] }}",
            -force
        ))
        .probe("tip", "displacement", "set = \"bar.right\"")
        .probe("root", "displacement", "set = \"bar.left\"");
    let oracle = Box::new(move |seen: &Seen| {
        let deflection = seen.last("root.z")? - seen.last("tip.z")?;
        Ok(vec![Deviation::of("deflection", deflection, expected, TOLERANCE)])
    });
    Problem { text, oracle }
}
