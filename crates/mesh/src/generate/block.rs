//! Blocks: the box, the box with eight arbitrary corners, the box with a curved bottom.

use stoss_reference_element::hex8;

use super::{finish, grid, grid::Grid, validate};
use crate::error::parameter;
use crate::{Mesh, MeshError};

const UNIFORM: [f64; 3] = [1.0; 3];

/// An axis-parallel box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Smallest coordinates (length).
    pub min: [f64; 3],
    /// Largest coordinates (length).
    pub max: [f64; 3],
    /// Numbers of elements along x, y, z.
    pub divisions: [usize; 3],
    /// Size of the last element over that of the first along each axis; sizes in between in geometric progression.
    pub grading: [f64; 3],
}

impl Block {
    /// A uniform box between two corners.
    pub fn new(min: [f64; 3], max: [f64; 3], divisions: [usize; 3]) -> Block {
        Block { min, max, divisions, grading: UNIFORM }
    }

    /// A uniform box of this size with its centre at the origin.
    pub fn with_size(size: [f64; 3], divisions: [usize; 3]) -> Block {
        Block::new(size.map(|a| -0.5 * a), size.map(|a| 0.5 * a), divisions)
    }

    /// The mesh.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (`min >= max`, zero divisions, gradings that are not positive, anything not finite),
    /// [`MeshError::TooLarge`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        validate::finite("min", &self.min)?;
        validate::finite("max", &self.max)?;
        if let Some(i) = (0..3).find(|&i| self.min[i] >= self.max[i]) {
            let axis = ["x", "y", "z"][i];
            let size: [f64; 3] = std::array::from_fn(|i| self.max[i] - self.min[i]);
            return Err(parameter("size", size, format!("must be positive in {axis} (max - min)")));
        }
        let (a, b) = (self.min, self.max);
        structured(self.divisions, self.grading, |s| std::array::from_fn(|i| grid::between(a[i], b[i], s[i])))
    }
}

/// A block with eight arbitrary corners and trilinear coordinates in between, as the lower block of theory/examples#two-elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hexahedron {
    /// The corners in the order of `hex8`: bottom counter-clockwise seen from the top, then top.
    pub corners: [[f64; 3]; 8],
    /// Numbers of elements along the three natural directions.
    pub divisions: [usize; 3],
    /// Size of the last element over that of the first along each natural direction, as for [`Block::grading`].
    pub grading: [f64; 3],
}

impl Hexahedron {
    /// A hexahedron with uniform divisions.
    pub fn new(corners: [[f64; 3]; 8], divisions: [usize; 3]) -> Hexahedron {
        Hexahedron { corners, divisions, grading: UNIFORM }
    }

    /// The mesh; its sets are named after the natural directions: `left` is `xi = -1`, `top` is `zeta = +1`.
    ///
    /// # Errors
    /// The errors of [`Block::generate`], and [`MeshError::InvertedElement`] if the corners are not those of a convex
    /// hexahedron with positive orientation.
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        validate::finite("corners", self.corners.as_flattened())?;
        let x = self.corners;
        structured(self.divisions, self.grading, |s| {
            let n = hex8::shape(s.map(|s| 2.0 * s - 1.0));
            std::array::from_fn(|i| (0..8).map(|a| n[a] * x[a][i]).sum())
        })
    }
}

/// The indenter of theory/examples#rotating-indenter: a block whose bottom is part of a sphere of radius `R` that touches `z = 0` on the axis,
/// `z_b = R - sqrt(R^2 - x^2 - y^2)`, and whose top is plane; nodes lie on vertical lines, `z = z_b + (h - z_b) zeta`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Indenter {
    /// Size along x and y (lengths); the axis is in the middle.
    pub width: [f64; 2],
    /// Height `h` of the top over the lowest point (length).
    pub height: f64,
    /// Radius `R` of the bottom (length).
    pub radius: f64,
    /// Numbers of elements along x, y, z.
    pub divisions: [usize; 3],
    /// Size of the last element over that of the first along each axis, as for [`Block::grading`].
    pub grading: [f64; 3],
}

impl Indenter {
    /// The indenter of theory/examples#rotating-indenter: `[-1, 1]^2`, height 1.5, radius 2, 10 x 10 x 7 elements.
    pub fn literature() -> Indenter {
        Indenter { width: [2.0; 2], height: 1.5, radius: 2.0, divisions: [10, 10, 7], grading: UNIFORM }
    }

    /// The mesh.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (sizes, radius too small for the width, height below the rim), [`MeshError::TooLarge`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        validate::positive("width x", self.width[0])?;
        validate::positive("width y", self.width[1])?;
        validate::positive("height", self.height)?;
        validate::positive("radius", self.radius)?;
        let (h, r) = (self.height, self.radius);
        let half = self.width.map(|w| 0.5 * w);
        let bottom = |x: f64, y: f64| r - (r * r - x * x - y * y).sqrt();
        let corner = (half[0] * half[0] + half[1] * half[1]).sqrt();
        if r <= corner {
            return Err(parameter(
                "radius",
                r,
                format!("must exceed the distance {corner} of the corners from the axis"),
            ));
        }
        let rim = bottom(half[0], half[1]);
        if h <= rim {
            return Err(parameter("height", h, format!("must exceed the height {rim} of the bottom's corners")));
        }
        structured(self.divisions, self.grading, |s| {
            let x = grid::between(-half[0], half[0], s[0]);
            let y = grid::between(-half[1], half[1], s[1]);
            [x, y, grid::between(bottom(x, y), h, s[2])]
        })
    }
}

/// A full grid on the unit cube, graded, mapped by `place`, with the six named facet sets.
fn structured(
    divisions: [usize; 3],
    grading: [f64; 3],
    place: impl Fn([f64; 3]) -> [f64; 3],
) -> Result<Mesh, MeshError> {
    validate::divisions(&divisions, &[1; 3], 1)?;
    validate::grading(grading, divisions)?;
    let s: [Vec<f64>; 3] = std::array::from_fn(|i| grid::positions(divisions[i], grading[i]));
    let (mut mesh, cells) = Grid { divisions }.mesh(|_| true, |p| place(std::array::from_fn(|i| s[i][p[i]])));
    let [nx, ny, nz] = divisions;
    grid::add_facets(&mut mesh, &cells, "left", grid::LEFT, |c| c[0] == 0);
    grid::add_facets(&mut mesh, &cells, "right", grid::RIGHT, |c| c[0] == nx - 1);
    grid::add_facets(&mut mesh, &cells, "front", grid::FRONT, |c| c[1] == 0);
    grid::add_facets(&mut mesh, &cells, "back", grid::BACK, |c| c[1] == ny - 1);
    grid::add_facets(&mut mesh, &cells, "bottom", grid::BOTTOM, |c| c[2] == 0);
    grid::add_facets(&mut mesh, &cells, "top", grid::TOP, |c| c[2] == nz - 1);
    finish(mesh)
}
