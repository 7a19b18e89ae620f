//! Pieces that the problems share: supports, and what frames hold.

use crate::verify::Run;
use crate::vtu::{Array, Grid};
use crate::workspace::Outcome;

/// Components of a set that are held at zero, such as `"x"` or `"x", "y"`.
pub fn fixed(set: &str, components: &str) -> String {
    format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [{components}]\nfixed = true\n")
}

/// The last frame of a run with the number of the body of each of its points.
pub struct End {
    /// Points, in the reference configuration, and fields.
    pub grid: Grid,
    /// Number of the body of each point, in the order of the scene.
    pub body: Vec<usize>,
}

impl End {
    /// Reads it.
    pub fn of(run: &Run) -> Outcome<Self> {
        let grid = run.last_frame()?;
        let mut body = vec![usize::MAX; grid.points.len()];
        let bodies = grid.cell_data.get("body").ok_or("no numbers of bodies in the frame")?;
        for (nodes, number) in grid.elements.iter().zip(&bodies.values) {
            nodes.iter().for_each(|node| body[*node as usize] = *number as usize);
        }
        Ok(Self { grid, body })
    }

    /// A field on the points.
    pub fn field(&self, name: &str) -> Outcome<&Array> {
        Ok(self.grid.point_data.get(name).ok_or_else(|| format!("no field {name} in the frame"))?)
    }

    /// Points of a body whose places satisfy a condition.
    pub fn points(&self, body: usize, is_there: impl Fn([f64; 3]) -> bool) -> Vec<usize> {
        (0..self.body.len()).filter(|&n| self.body[n] == body && is_there(self.grid.points[n])).collect()
    }

    /// Coordinate x after the motion, and a field, of points of a body whose places satisfy a condition, in the order of x.
    pub fn curve(&self, body: usize, field: &str, is_there: impl Fn([f64; 3]) -> bool) -> Outcome<Vec<(f64, f64)>> {
        let (values, displacement) = (self.field(field)?, self.field("displacement")?);
        let place = |n: usize| self.grid.points[n][0] + displacement.row(n)[0];
        let there = self.points(body, is_there).into_iter();
        let mut points: Vec<(f64, f64)> = there.map(|n| (place(n), values.values[n])).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(points)
    }
}

/// A value that grows in proportion to time from zero to this one at the time 1.
pub fn ramp(value: f64) -> String {
    format!("{{ table = [[0.0, 0.0], [1.0, {value:?}]] }}")
}

/// True if a coordinate is there up to round-off.
pub fn flat(x: f64, at: f64) -> bool {
    (x - at).abs() < 1e-9 * (1.0 + at.abs())
}

/// Points `(x, p)` of a piecewise linear pressure, outwards from x = 0: `int p x^power dx`.
pub fn moment(points: &[(f64, f64)], power: i32) -> f64 {
    // Exact for cubics and powers up to 4: three Gauss points a piece.
    const GAUSS: [(f64, f64); 3] =
        [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
    let piece = |[(x, p), (y, q)]: [(f64, f64); 2]| {
        GAUSS.iter().map(|(s, w)| w * (y - x) * (p + s * (q - p)) * (x + s * (y - x)).powi(power)).sum::<f64>()
    };
    points.windows(2).map(|pair| piece([pair[0], pair[1]])).sum()
}

/// A vector that grows in proportion to time from zero to this one at the time 1.
pub fn vector_ramp([x, y, z]: [f64; 3]) -> String {
    format!("{{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, {x:?}, {y:?}, {z:?}]] }}")
}
