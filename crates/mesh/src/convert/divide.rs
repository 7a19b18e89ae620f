//! Hexahedra and wedges divided into wedges or tetrahedra without new nodes.

use std::collections::BTreeMap;

use stoss_reference_element::CellKind;

use super::{cannot, with_elements};
use crate::error::parameter;
use crate::{Elements, Facet, Mesh, MeshError};

/// The mesh with linear elements of this kind; `wanted` is what the caller asked for.
pub(super) fn divided(mesh: &Mesh, linear: CellKind, wanted: CellKind) -> Result<Mesh, MeshError> {
    let mut elements = Elements::new();
    let mut first_child = vec![0];
    let mut diagonals = BTreeMap::new();
    for (e, (kind, nodes)) in mesh.elements.cells().enumerate() {
        match (kind, linear) {
            _ if kind == linear || kind == wanted => elements.push(kind, nodes),
            (CellKind::Hex8 | CellKind::Wedge6, CellKind::Tet4) => {
                for tet in tetrahedra(kind, nodes) {
                    elements.push(CellKind::Tet4, &tet);
                }
            }
            (CellKind::Hex8, CellKind::Wedge6) => {
                for wedge in [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]] {
                    elements.push(CellKind::Wedge6, &wedge.map(|k| nodes[k]));
                }
                for local in 0..6 {
                    let diagonal = match local {
                        0 => Some([nodes[0], nodes[2]]),
                        1 => Some([nodes[4], nodes[6]]),
                        _ => None,
                    };
                    note(&mut diagonals, &Facet::of_element(e as u32, kind, nodes, local), diagonal, wanted)?;
                }
            }
            _ => return Err(cannot(e, kind, wanted)),
        }
        first_child.push(elements.len() as u32);
    }
    Ok(with_elements(mesh, elements, &first_child))
}

/// Tetrahedra from the smallest node to triangles of the faces that do not have it; a quadrilateral is divided by the diagonal of its smallest node. The
/// division of a face depends on its nodes' numbers alone, so that neighbours agree (J. Dompierre et al., 8th International Meshing Roundtable, 1999).
fn tetrahedra(kind: CellKind, nodes: &[u32]) -> Vec<[u32; 4]> {
    let apex = nodes.iter().copied().min().unwrap_or_default();
    let mut out = Vec::with_capacity(6);
    for local in 0..kind.faces().len() {
        let face = Facet::of_element(0, kind, nodes, local).nodes;
        if face.contains(&apex) {
            continue;
        }
        let smallest = (0..face.len()).min_by_key(|&k| face[k]).unwrap_or(0);
        let at = |k: usize| face[(smallest + k) % face.len()];
        for k in 1..face.len() - 1 {
            // The face is seen counter-clockwise from outside; the base of a tetrahedron from its fourth node.
            out.push([at(0), at(k + 1), at(k), apex]);
        }
    }
    out
}

/// Notes how a face is divided; an error if its other element divides it in another way.
fn note(
    diagonals: &mut BTreeMap<Vec<u32>, Option<[u32; 2]>>,
    facet: &Facet,
    diagonal: Option<[u32; 2]>,
    wanted: CellKind,
) -> Result<(), MeshError> {
    let mut key = facet.nodes.to_vec();
    key.sort_unstable();
    let diagonal = diagonal.map(|[a, b]| [a.min(b), a.max(b)]);
    match diagonals.insert(key, diagonal) {
        Some(other) if other != diagonal => Err(parameter(
            "cell",
            wanted.name(),
            format!(
                "hexahedra are cut into wedges along their third direction, which differs between element {} and a neighbour: use tetrahedra, or a \
                 mesh of layers",
                facet.element
            ),
        )),
        _ => Ok(()),
    }
}
