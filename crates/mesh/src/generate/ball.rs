//! The hollow ball.

use super::cube::cubed_sphere;
use super::{finish, grid, validate};
use crate::error::parameter;
use crate::{Mesh, MeshError};

/// A spherical shell about the origin, meshed as a cubed sphere: the faces of a cube, divided evenly in angle
/// (`tan` mapping) and projected onto concentric spheres (theory/examples#ball-plate).
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
                mesh.elements.push_hex8(std::array::from_fn(|i| if i < 4 { below + q[i] } else { above + q[i - 4] }));
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
