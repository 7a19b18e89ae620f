//! The hollow ball.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;

use super::{finish, grid, validate};
use crate::error::parameter;
use crate::{Mesh, MeshError};

/// A spherical shell about the origin, meshed as a cubed sphere: the faces of a cube, divided evenly in angle
/// (`tan` mapping) and projected onto concentric spheres (formulation §13.1).
///
/// `divisions = [n, layers]` gives `6 n^2 layers` elements and `(6 n^2 + 2)(layers + 1)` nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HollowBall {
    /// Diameter of the hole (length).
    pub inner_diameter: f64,
    /// Outer diameter (length).
    pub outer_diameter: f64,
    /// Numbers of elements along an edge of the cube's faces, and through the wall.
    pub divisions: [usize; 2],
}

impl HollowBall {
    /// The mesh with facet sets `outer` and `inner`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (diameters, inner not smaller than outer, zero divisions), [`MeshError::TooLarge`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        validate::positive("inner_diameter", self.inner_diameter)?;
        validate::positive("outer_diameter", self.outer_diameter)?;
        if self.inner_diameter >= self.outer_diameter {
            let remedy = format!("must be smaller than outer_diameter = {}", self.outer_diameter);
            return Err(parameter("inner_diameter", self.inner_diameter, remedy));
        }
        let [n, layers] = self.divisions;
        validate::divisions(&[n, n, layers], &[1; 3], 6)?;

        let (directions, quads) = cubed_sphere(n);
        let count = directions.len();
        let mut mesh = Mesh::default();
        for l in 0..=layers {
            let radius = 0.5 * grid::between(self.inner_diameter, self.outer_diameter, l as f64 / layers as f64);
            mesh.nodes.extend(directions.iter().map(|d| d.map(|c| radius * c)));
        }
        for l in 0..layers {
            let (below, above) = ((l * count) as u32, ((l + 1) * count) as u32);
            for q in &quads {
                mesh.elements.push(std::array::from_fn(|i| if i < 4 { below + q[i] } else { above + q[i - 4] }));
            }
        }
        let (first, last) = (quads.len() as u32, mesh.elements.len() as u32);
        let inner = (0..first).map(|e| mesh.facet(e, grid::BOTTOM)).collect();
        let outer = (last - first..last).map(|e| mesh.facet(e, grid::TOP)).collect();
        mesh.facet_sets.insert("inner".into(), inner);
        mesh.facet_sets.insert("outer".into(), outer);
        finish(mesh)
    }
}

/// Unit directions and outward quadrilaterals of the cubed sphere with `n x n` quadrilaterals a face.
fn cubed_sphere(n: usize) -> (Vec<[f64; 3]>, Vec<[u32; 4]>) {
    // tan(pi/4 (2 i / n - 1)), exactly antisymmetric and exactly 1 at the ends, so that faces meet
    let tangent = |i: usize| -> f64 {
        let twice = 2 * i as i64 - n as i64;
        let value = if twice.unsigned_abs() as usize == n {
            1.0
        } else {
            (FRAC_PI_4 * twice.unsigned_abs() as f64 / n as f64).tan()
        };
        if twice < 0 { -value } else { value }
    };
    let mut numbers: HashMap<[usize; 3], u32> = HashMap::with_capacity(6 * n * n + 2);
    let mut directions = Vec::with_capacity(6 * n * n + 2);
    let mut quads = Vec::with_capacity(6 * n * n);
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, n] {
            for j in 0..n {
                for i in 0..n {
                    // u, v, axis are right-handed: counter-clockwise seen from outside on the positive side
                    let mut ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
                    if side == 0 {
                        ring.reverse();
                    }
                    quads.push(ring.map(|[di, dj]| {
                        let mut point = [0; 3];
                        (point[axis], point[u], point[v]) = (side, i + di, j + dj);
                        *numbers.entry(point).or_insert_with(|| {
                            let t = point.map(tangent);
                            let length = t.iter().map(|c| c * c).sum::<f64>().sqrt();
                            directions.push(t.map(|c| c / length));
                            directions.len() as u32 - 1
                        })
                    }));
                }
            }
        }
    }
    (directions, quads)
}
