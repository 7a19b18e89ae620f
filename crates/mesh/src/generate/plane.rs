//! Plane meshes for sections, as layers from z = -1 to z = 1 that [`Mesh::slice`](crate::Mesh::slice) makes slices of.

use super::{Block, Cylinder, Portion, Refinement};
use crate::{Mesh, MeshError};

/// An axis-parallel rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Smallest coordinates (length).
    pub min: [f64; 2],
    /// Largest coordinates (length).
    pub max: [f64; 2],
    /// Numbers of elements along x, y.
    pub divisions: [usize; 2],
    /// Size of the last element over that of the first along each axis, as for [`Block::grading`].
    pub grading: [f64; 2],
}

impl Rectangle {
    /// The layer, with facet sets `left`, `right` (x), `bottom`, `top` (y).
    ///
    /// # Errors
    /// The errors of [`Block::generate`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        let Self { min: [x, y], max: [xx, yy], divisions: [n, m], grading: [g, h] } = *self;
        let block = Block { min: [x, y, -1.0], max: [xx, yy, 1.0], divisions: [n, m, 1], grading: [g, h, 1.0] };
        let mut mesh = block.generate()?;
        let sides = ["front", "back"].map(|name| mesh.facet_sets.remove(name).unwrap_or_default());
        mesh.facet_sets.extend(["bottom".to_owned(), "top".to_owned()].into_iter().zip(sides));
        Ok(mesh)
    }
}

/// A disc about the origin, or a part of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Radius (length).
    pub radius: f64,
    /// Full, half (y <= 0) or quarter (also x >= 0).
    pub part: Portion,
    /// Numbers of elements of a quarter: along x, along y, from the square in the middle to the rim.
    pub divisions: [usize; 3],
    /// Finer at the lowest point.
    pub refinement: Option<Refinement>,
}

impl Disc {
    /// The layer, with the facet set `outer`; of a part also `top` (y = 0) and `left` (x = 0).
    ///
    /// # Errors
    /// The errors of [`Cylinder::generate`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        let Self { radius, part, divisions: [n, m, r], refinement } = *self;
        let cylinder = Cylinder { radius, length: 2.0, part, divisions: [n, m, r, 1], refinement };
        let mut mesh = cylinder.generate()?.map(|[x, y, z]| [x, z, 1.0 - y])?;
        mesh.facet_sets.retain(|name, _| !matches!(name.as_str(), "front" | "back"));
        Ok(mesh)
    }
}
