//! The rows of the constraints: one for each side of a slave node against each smooth part of the master.

use crate::sharp_edges::is_sharp;
use nalgebra::Vector3;
use stoss_contact::ContactSurface;

/// A constraint that a slave node may have against one smooth part of the master: the node's shape function on the facets of one of its sides. Facets are on one side of a node if edges at the node that
/// are not sharp lead from one to the other, so that a node of a smooth surface has one row, and one at an edge of a block two.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    /// Local number of the node.
    pub local: usize,
    /// Smooth part of the master.
    pub smooth_part: usize,
    /// Facets of the side, ascending, and which of their corners the node is.
    pub facets: Vec<(u32, usize)>,
    /// Reference area.
    pub area: f64,
    /// Whether the node has other rows.
    pub shared: bool,
    /// Components across planes of symmetry that the node lies in: with the facets behind the planes its normal has none.
    pub across: [bool; 3],
}

/// Rows of all slave nodes against a master of so many smooth parts, in the order of the nodes.
pub(crate) fn rows(surface: &ContactSurface, normals: &[Vector3<f64>], smooth_parts: usize) -> Vec<Row> {
    let facets = surface.local_facets();
    let mut rows = Vec::new();
    for local in 0..surface.nodes().len() {
        let corner = |facet: u32| facets[facet as usize].iter().position(|&n| n as usize == local);
        let around = surface.facets_around(local);
        let mut left: Vec<u32> = around.to_vec();
        let first_row = rows.len();
        while let Some(&first) = left.first() {
            left.retain(|&f| f != first);
            let (mut side, mut next) = (vec![first], 0);
            while let Some(&f) = side.get(next) {
                next += 1;
                let Some(a) = corner(f) else { continue };
                let before = facets[f as usize].kind().previous(a);
                for e in [a, before].into_iter().filter_map(|edge| surface.neighbour(f, edge)) {
                    if left.contains(&e) && !is_sharp(normals, e as usize, f as usize) {
                        left.retain(|&f| f != e);
                        side.push(e);
                    }
                }
            }
            side.sort_unstable();
            let facets: Vec<(u32, usize)> = side.into_iter().filter_map(|f| Some((f, corner(f)?))).collect();
            let area: f64 = facets.iter().map(|&(f, a)| surface.corner_areas()[f as usize][a]).sum();
            rows.extend((0..smooth_parts).map(|smooth_part| Row {
                local,
                smooth_part,
                facets: facets.clone(),
                area,
                shared: false,
                across: [false; 3],
            }));
        }
        let shared = rows.len() - first_row > 1;
        rows[first_row..].iter_mut().for_each(|row| row.shared = shared);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sharp_edges::{smooth_parts, unit_normals};
    use stoss_testkit::meshes::Mesh;

    #[test]
    fn a_corner_of_a_box_has_three_rows() {
        let corner = |k: usize| [(k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2 & 1) as f64];
        let q: Vec<f64> = (0..8).flat_map(corner).collect();
        let facets = [[4, 5, 7, 6], [0, 2, 3, 1], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        for mesh in Mesh::ALL {
            let surface = ContactSurface::new("slave", &mesh.of(&facets), &q).unwrap();
            let rows = rows(&surface, &unit_normals(&surface, &q), 1);
            assert_eq!(rows.len(), 24);
            // A corner of a divided face has one triangle, or both.
            let areas: &[f64] = match mesh {
                Mesh::Quads => &[0.25],
                Mesh::Triangles => &[1.0 / 6.0, 1.0 / 3.0],
                Mesh::Mixed => &[0.25, 1.0 / 6.0, 1.0 / 3.0],
            };
            let area = |a: f64| areas.iter().any(|b| (a - b).abs() < 1e-15);
            assert!(rows.iter().all(|row| row.shared && area(row.area)), "{mesh:?}");
            assert!((rows.iter().map(|row| row.area).sum::<f64>() - 6.0).abs() < 1e-14);
            assert_eq!(smooth_parts(&surface, &unit_normals(&surface, &q)).1, 6);
        }
        let top = ContactSurface::new("slave", &facets[..1], &q).unwrap();
        assert!(rows(&top, &unit_normals(&top, &q), 1).iter().all(|row| !row.shared));
    }
}
