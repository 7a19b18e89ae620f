//! The hollow torus.

use super::{finish, grid, validate};
use crate::error::parameter;
use crate::transform::sin_cos_degrees;
use crate::{Mesh, MeshError};

/// A hollow torus about the z-axis with its centre at the origin (theory/examples#tori): the point at ring angle `phi`, tube angle
/// `theta` and tube radius `r` is `((R + r cos theta) cos phi, (R + r cos theta) sin phi, r sin theta)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HollowTorus {
    /// Radius `R` of the circle through the middle of the tube (length).
    pub ring_radius: f64,
    /// Outer radius of the tube (length), smaller than the ring's radius.
    pub tube_outer_radius: f64,
    /// Inner radius of the tube (length).
    pub tube_inner_radius: f64,
    /// Numbers of elements along the ring, around the tube, and through the wall.
    pub divisions: [usize; 3],
}

impl HollowTorus {
    /// The mesh with facet sets `outer` and `inner`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (radii, inner not smaller than outer, tube not smaller than ring, fewer than 3 elements around),
    /// [`MeshError::TooLarge`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        let (ring, outer, inner) = (self.ring_radius, self.tube_outer_radius, self.tube_inner_radius);
        validate::positive("ring_radius", ring)?;
        validate::positive("tube_outer_radius", outer)?;
        validate::positive("tube_inner_radius", inner)?;
        if inner >= outer {
            return Err(parameter(
                "tube_inner_radius",
                inner,
                format!("must be smaller than tube_outer_radius = {outer}"),
            ));
        }
        if outer >= ring {
            return Err(parameter("tube_outer_radius", outer, format!("must be smaller than ring_radius = {ring}")));
        }
        validate::divisions(&self.divisions, &[3, 3, 1], 1)?;
        let [nr, nt, nw] = self.divisions;
        let angle = |i: usize, n: usize| sin_cos_degrees(360.0 * i as f64 / n as f64);
        let number = |i: usize, j: usize, k: usize| ((k * nt + j % nt) * nr + i % nr) as u32;

        let mut mesh = Mesh::default();
        for k in 0..=nw {
            let r = grid::between(inner, outer, k as f64 / nw as f64);
            for j in 0..nt {
                let (st, ct) = angle(j, nt);
                for i in 0..nr {
                    let (sp, cp) = angle(i, nr);
                    mesh.nodes.push([(ring + r * ct) * cp, (ring + r * ct) * sp, r * st]);
                }
            }
        }
        // ring direction x tube direction points out of the tube: (xi, eta, zeta) = (ring, tube, wall)
        for k in 0..nw {
            for j in 0..nt {
                for i in 0..nr {
                    mesh.elements.push_hex8([
                        number(i, j, k),
                        number(i + 1, j, k),
                        number(i + 1, j + 1, k),
                        number(i, j + 1, k),
                        number(i, j, k + 1),
                        number(i + 1, j, k + 1),
                        number(i + 1, j + 1, k + 1),
                        number(i, j + 1, k + 1),
                    ]);
                }
            }
        }
        let (layer, last) = ((nr * nt) as u32, (nr * nt * nw) as u32);
        let inner = (0..layer).map(|e| mesh.facet(e, grid::BOTTOM)).collect();
        let outer = (last - layer..last).map(|e| mesh.facet(e, grid::TOP)).collect();
        mesh.facet_sets.insert("inner".into(), inner);
        mesh.facet_sets.insert("outer".into(), outer);
        finish(mesh)
    }
}
