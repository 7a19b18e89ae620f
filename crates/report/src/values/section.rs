//! The points of a square grid on a plane through elements.

use nalgebra::Vector3;
use stoss_mesh::Elements;

/// Points of the grid in the longer direction, unless a spacing is given.
const FINENESS: f64 = 50.0;
/// Most points of a grid.
const MOST: f64 = 2e7;

/// A square grid on a plane, as large as what the plane cuts.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneGrid {
    point: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    spacing: f64,
    /// First and last number of the points along each axis; `point` has number 0.
    range: [[i64; 2]; 2],
}

impl PlaneGrid {
    /// `u` is the first of the axes x, y, z, projected on the plane, which the normal does not nearly have; `v` is across, so that `u`, `v` and the
    /// normal are right-handed.
    pub fn new(
        elements: &Elements,
        places: &[[f64; 3]],
        point: [f64; 3],
        normal: [f64; 3],
        spacing: Option<f64>,
    ) -> Result<Self, String> {
        let (point, normal) = (Vector3::from(point), Vector3::from(normal));
        let length = normal.norm();
        if !(length.is_normal() && point.iter().all(|x| x.is_finite())) {
            return Err("--plane: give a point and a normal of finite numbers, the normal not zero".into());
        }
        let normal = normal / length;
        let across = |axis: usize| (normal[axis].abs() < 0.9).then(|| Vector3::ith(axis, 1.0));
        // One of two axes at right angles is away from the normal by 45 degrees at least.
        let axis = across(0).or_else(|| across(1)).unwrap_or_else(Vector3::z);
        let u = (axis - normal * normal.dot(&axis)).normalize();
        let axes = [u, normal.cross(&u)];
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for nodes in elements.iter() {
            let corners = || nodes.iter().map(|&node| Vector3::from(places[node as usize]) - point);
            let heights = || corners().map(|x| normal.dot(&x));
            let touches = heights().any(|h| h >= 0.0) && heights().any(|h| h <= 0.0);
            for x in corners().filter(|_| touches) {
                for k in 0..2 {
                    let along = axes[k].dot(&x);
                    (low[k], high[k]) = (low[k].min(along), high[k].max(along));
                }
            }
        }
        let longer = (high[0] - low[0]).max(high[1] - low[1]);
        if !(longer.is_finite() && longer > 0.0) {
            return Err("--plane: the plane cuts no deformable body".into());
        }
        let spacing = spacing.unwrap_or(longer / FINENESS);
        if !(spacing.is_normal() && spacing > 0.0) {
            return Err(format!("--spacing {spacing}: give a positive number"));
        }
        // The plane may lie in faces, whose ends are rounded.
        let ends = [0, 1].map(|k| [(low[k] / spacing - 1e-6).ceil(), (high[k] / spacing + 1e-6).floor()]);
        let count = ends.iter().map(|[first, last]| (last - first + 1.0).max(0.0)).product::<f64>();
        if count > MOST || ends.as_flattened().iter().any(|end| end.abs() > MOST) {
            return Err(format!("--spacing {spacing}: gives {count:.1e} points on a plane; choose a larger one"));
        }
        Ok(Self { point, axes, spacing, range: ends.map(|ends| ends.map(|end| end as i64)) })
    }

    /// Coordinates in the plane and positions of the points, along `u` first.
    pub fn points(&self) -> impl Iterator<Item = ([f64; 2], [f64; 3])> + '_ {
        let [columns, rows] = self.range.map(|[first, last]| first..=last);
        rows.flat_map(move |j| columns.clone().map(move |i| [i, j])).map(|numbers| {
            let [u, v] = numbers.map(|number| number as f64 * self.spacing);
            ([u, v], (self.point + self.axes[0] * u + self.axes[1] * v).into())
        })
    }
}
