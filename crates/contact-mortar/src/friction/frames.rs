//! Directions of the slave's material at its nodes, in which tractions of friction are remembered.
//!
//! The frame of a node is that of the reference configuration, turned by the rotation of the surface around the node: the rotation `R` of the polar
//! decomposition `R U` of the deformation that takes the reference diagonals of its facets to the present ones in the best way. A diagonal alone
//! would turn with a shear, too, and the mirror image of a deformation would not turn tractions by the mirror image.

use crate::surfaces::diagonals;
use nalgebra::{Matrix2, Vector2, Vector3};
use stoss_contact::ContactSurface;

/// A determinant below this part of the square of the trace is round-off.
const FLAT: f64 = 1e-12;

/// What the frames of the slave nodes follow.
#[derive(Clone, Debug)]
pub(crate) struct MaterialFrames {
    /// Two orthonormal tangent vectors of each slave node, by local number.
    tangents: Vec<[Vector3<f64>; 2]>,
    /// Reference diagonals of each slave facet.
    diagonals: Vec<[Vector3<f64>; 2]>,
}

/// Coordinates of the diagonals of a facet, `G^-1 D` each, with the reference diagonals `D` in the tangent plane of the node and `G = sum D D^T` over its
/// facets.
pub(crate) type Coordinates = [[f64; 2]; 2];

impl MaterialFrames {
    /// The frames from reference positions (`3 * nodes`).
    pub fn new(slave: &ContactSurface, reference: &[f64]) -> Self {
        let facets = 0..slave.facets().len() as u32;
        let diagonals: Vec<[Vector3<f64>; 2]> = facets.map(|f| diagonals(&slave.patch(f, reference).corners)).collect();
        let tangents = |local: usize| {
            let around = slave.facets_around(local);
            let area = |f: &u32| diagonals[*f as usize][1].cross(&diagonals[*f as usize][0]);
            let sum: Vector3<f64> = around.iter().map(area).sum();
            // Into the slave, as in `node`. The two sides of a fold have no mean.
            let size: f64 = around.iter().map(|f| area(f).norm()).sum();
            let normal = if sum.norm() > FLAT * size { sum } else { area(&around[0]) }.normalize();
            let [a, b] = diagonals[around[0] as usize].map(|d| d - normal * normal.dot(&d));
            let first = if a.norm() >= b.norm() { a } else { b }.normalize();
            [first, normal.cross(&first)]
        };
        Self { tangents: (0..slave.nodes().len()).map(tangents).collect(), diagonals }
    }

    /// Coordinates of the diagonals of each of these facets around slave node `local`.
    pub fn coordinates(&self, local: usize, facets: impl Iterator<Item = u32> + Clone, out: &mut Vec<Coordinates>) {
        let [e_1, e_2] = self.tangents[local];
        let plane = |d: &Vector3<f64>| Vector2::new(e_1.dot(d), e_2.dot(d));
        let diagonals = |f: u32| self.diagonals[f as usize].each_ref().map(plane);
        let g: Matrix2<f64> = facets.clone().flat_map(diagonals).map(|d| d * d.transpose()).sum();
        let trace = g.trace();
        // Facets that stand upright on the tangent plane, as at a fold, have one direction only.
        let inverse = match g.try_inverse() {
            Some(inverse) if g.determinant() > FLAT * trace * trace => inverse,
            _ => Matrix2::identity() / trace,
        };
        out.clear();
        out.extend(facets.map(|f| diagonals(f).map(|d| (inverse * d).into())));
    }
}

#[cfg(test)]
mod tests {
    use super::super::slip::tangents;
    use super::*;
    use nalgebra::{Matrix3, Rotation3};
    use proptest::prelude::*;
    use stoss_reference_element::Nodal;
    use stoss_testkit::meshes::{Mesh, mesh};

    /// Two by two quadrilaterals, none of them a parallelogram, in the plane `z = 0`, divided or not.
    fn patch(mesh: Mesh) -> (ContactSurface, Vec<f64>) {
        let rows = [[0.0, 0.1, -0.1], [1.0, 1.2, 0.8], [2.3, 1.9, 2.0]];
        let q = (0..9)
            .flat_map(|k| [rows[k / 3][k % 3] + 0.2, (k % 3) as f64 + 0.1 * (k / 3) as f64, 0.0])
            .collect::<Vec<f64>>();
        let facets = [[0, 3, 4, 1], [3, 6, 7, 4], [1, 4, 5, 2], [4, 7, 8, 5]];
        (ContactSurface::new("slave", &mesh.of(&facets), &q).unwrap(), q)
    }

    /// The frame of the node in the middle where positions are `q`.
    fn frame(frames: &MaterialFrames, surface: &ContactSurface, q: &[f64]) -> [Vector3<f64>; 2] {
        let local = surface.local_node(4).unwrap();
        let mut coordinates = Vec::new();
        frames.coordinates(local, surface.facets_around(local).iter().copied(), &mut coordinates);
        let mut along = [Vector3::zeros(); 2];
        let mut normal = Vector3::zeros();
        for (&f, c) in surface.facets_around(local).iter().zip(&coordinates) {
            let d = diagonals(&surface.patch(f, q).corners);
            normal += d[1].cross(&d[0]);
            for (a, along) in along.iter_mut().enumerate() {
                *along += d[0] * c[0][a] + d[1] * c[1][a];
            }
        }
        tangents::<f64>(normal.into(), along.map(Into::into)).map(Into::into)
    }

    proptest! {
        #[test]
        fn frames_turn_with_the_rotation_of_the_polar_decomposition(
            mesh in mesh(), u in prop::array::uniform3(-0.4f64..0.4), axis in prop::array::uniform3(-1.5f64..1.5),
        ) {
            let (surface, q) = patch(mesh);
            let frames = MaterialFrames::new(&surface, &q);
            // Symmetric in the plane, then any rotation.
            let stretch = Matrix3::new(1.0 + u[0], u[1], 0.0, u[1], 1.0 + u[2], 0.0, 0.0, 0.0, 1.0);
            prop_assume!(stretch.determinant() > 0.1);
            let turn = Rotation3::new(axis.into());
            let map = turn * stretch;
            let moved: Vec<f64> = q.chunks_exact(3).flat_map(|x| <[f64; 3]>::from(map * Vector3::from_column_slice(x))).collect();
            let before = frame(&frames, &surface, &q);
            let after = frame(&frames, &surface, &moved);
            for (a, b) in before.iter().zip(&after) {
                prop_assert!((turn * a - b).amax() < 1e-13, "{:?} {:?}", turn * a, b);
            }
            // Which way round its facets are numbered is nothing to the material.
            let turned: Vec<_> =
                surface.facets().iter().map(|f| Nodal::from_fn(f.kind(), |k| f[(k + 1) % f.len()])).collect();
            let other = ContactSurface::new("slave", &turned, &q).unwrap();
            let frames = MaterialFrames::new(&other, &q);
            let (before, after) = (frame(&frames, &other, &q), frame(&frames, &other, &moved));
            prop_assert!((turn * before[0] - after[0]).amax() < 1e-13);
        }
    }
}
