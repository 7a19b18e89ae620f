//! An L-shaped block.

use super::{finish, grid, grid::Grid, validate};
use crate::error::parameter;
use crate::{Mesh, MeshError};

/// An L-shaped block in the x-y plane, its outer corner at the origin, both arms of the same width:
///
/// ```text
///  y
///  |__           end-y
///  |  |
///  |  | notch
///  |  |____
///  |_______|__x  end-x
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LBlock {
    /// Outer lengths of the arms along x and y (lengths), each larger than the width.
    pub length: [f64; 2],
    /// Width of both arms in the plane (length).
    pub width: f64,
    /// Thickness along z (length), from `z = 0`.
    pub thickness: f64,
    /// Numbers of elements: along the x-arm beyond the corner, along the y-arm beyond the corner, across the width,
    /// through the thickness.
    pub divisions: [usize; 4],
}

impl LBlock {
    /// The mesh. Facet sets `left` (x = 0), `front` (y = 0), `bottom`, `top`, `end-x`, `end-y`, and `notch` (the two
    /// re-entrant faces); element sets `corner`, `arm-x`, `arm-y` (arms without the corner).
    ///
    /// # Errors
    /// [`MeshError::Parameter`], [`MeshError::TooLarge`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        validate::positive("width", self.width)?;
        validate::positive("thickness", self.thickness)?;
        for l in self.length {
            validate::positive("length", l)?;
            if l <= self.width {
                return Err(parameter("length", self.length, format!("must exceed the width {}", self.width)));
            }
        }
        let [ax, ay, across, through] = self.divisions;
        validate::divisions(&self.divisions, &[1; 4], 1)?;
        let nx = ax.saturating_add(across);
        let ny = ay.saturating_add(across);
        validate::divisions(&[nx, ny, through], &[1; 3], 1)?;

        let along = |length: f64, n: usize| {
            move |i: usize| {
                if i <= across {
                    grid::between(0.0, self.width, i as f64 / across as f64)
                } else {
                    grid::between(self.width, length, (i - across) as f64 / n as f64)
                }
            }
        };
        let (x, y) = (along(self.length[0], ax), along(self.length[1], ay));
        let z = |k: usize| grid::between(0.0, self.thickness, k as f64 / through as f64);
        let (mut mesh, cells) = Grid { divisions: [nx, ny, through] }
            .mesh(|c| c[0] < across || c[1] < across, |p| [x(p[0]), y(p[1]), z(p[2])]);

        grid::add_facets(&mut mesh, &cells, "left", grid::LEFT, |c| c[0] == 0);
        grid::add_facets(&mut mesh, &cells, "front", grid::FRONT, |c| c[1] == 0);
        grid::add_facets(&mut mesh, &cells, "bottom", grid::BOTTOM, |c| c[2] == 0);
        grid::add_facets(&mut mesh, &cells, "top", grid::TOP, |c| c[2] == through - 1);
        grid::add_facets(&mut mesh, &cells, "end-x", grid::RIGHT, |c| c[0] == nx - 1);
        grid::add_facets(&mut mesh, &cells, "end-y", grid::BACK, |c| c[1] == ny - 1);
        grid::add_facets(&mut mesh, &cells, "notch", grid::RIGHT, |c| c[0] == across - 1 && c[1] >= across);
        grid::add_facets(&mut mesh, &cells, "notch", grid::BACK, |c| c[1] == across - 1 && c[0] >= across);
        for (name, right, back) in [("corner", false, false), ("arm-x", true, false), ("arm-y", false, true)] {
            let set = (0..cells.len() as u32)
                .filter(|&e| {
                    let c = cells[e as usize];
                    (c[0] >= across) == right && (c[1] >= across) == back
                })
                .collect();
            mesh.element_sets.insert(name.to_owned(), set);
        }
        finish(mesh)
    }
}
