//! Layers: the cells that stand on a face, for sections of plates and of bodies of revolution.

use crate::{CellKind, FaceKind};

impl FaceKind {
    /// The cell of one layer on the face, `zeta` from -1 to 1 across it: its faces are the face at -1, that at 1, then those on the edges in order.
    pub fn layer(self) -> CellKind {
        match self {
            Self::Tri3 => CellKind::Wedge6,
            Self::Quad4 => CellKind::Hex8,
            Self::Tri6 => CellKind::Wedge15,
            Self::Quad8 => CellKind::Hex20,
            Self::Quad9 => CellKind::Hex27,
        }
    }

    /// Node of the face that each node of [`FaceKind::layer`] is above, and its `zeta`: -1, 0 or 1.
    pub fn layer_nodes(self) -> impl Iterator<Item = (usize, f64)> {
        self.layer().table().nodes.iter().map(move |&[x, y, zeta]| {
            // cannot fail, as the test says: a layer has no node beside those of its face.
            (self.nodes().iter().position(|&node| node == [x, y]).unwrap_or_default(), zeta)
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::FaceKind;

    #[test]
    fn a_layer_has_the_nodes_of_its_face_and_a_face_on_each_edge() {
        for kind in FaceKind::ALL {
            let cell = kind.layer();
            let nodes: Vec<(usize, f64)> = kind.layer_nodes().collect();
            for (&(node, zeta), at) in nodes.iter().zip(cell.table().nodes) {
                assert_eq!([kind.nodes()[node][0], kind.nodes()[node][1], zeta], *at, "{kind:?}");
            }
            for (f, face) in cell.faces().iter().enumerate() {
                let all = |zeta: f64| face.nodes.iter().all(|&n| nodes[usize::from(n)].1 == zeta);
                match f {
                    0 => assert!(all(-1.0), "{kind:?}"),
                    1 => assert!(all(1.0), "{kind:?}"),
                    _ => {
                        let edge = [f - 2, (f - 1) % kind.corner_count()];
                        let corners = &face.nodes[..face.kind.corner_count()];
                        assert!(corners.iter().all(|&n| edge.contains(&nodes[usize::from(n)].0)), "{kind:?} {f}");
                    }
                }
            }
        }
    }
}
