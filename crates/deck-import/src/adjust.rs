//! `ADJUST` of `*CONTACT PAIR`: slave nodes are moved onto the master surface before the first step, without strain.
//!
//! As the keyword means: a node moves along the normal of the master surface to its foot there. With a distance those nodes move whose gap is not larger, overlapping
//! ones included; with a set those of the set, however far. Of quadratic faces nodes on edges and in the middle move as corners do; the master surface is then the
//! linear pieces between its nodes.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;
use stoss_geometry::{Aabb, BoundingVolumeTree, Patch, PatchFeature};
use stoss_mesh::Facet;
use stoss_reference_element::FacetNodes;

/// Part of an edge by which a node may be beside the rim of the master surface and still be above it: coordinates of decks have few digits.
const BESIDE: f64 = 1e-3;
/// Part of an edge below which a gap is round-off.
const ROUND_OFF: f64 = 1e-12;

/// Which nodes are moved.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Which<'a> {
    /// Nodes whose gap is at most this distance, and those that overlap.
    Within(f64),
    /// Nodes of this sorted set.
    Of(&'a [u32]),
}

/// Nodes that were moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moved {
    pub count: usize,
    /// The farthest way, a length.
    pub farthest: f64,
    /// Nodes that are behind the master surface by more than the distance and an edge of it: they stay.
    pub too_deep: usize,
}

fn vector(x: [f64; 3]) -> Vector3<f64> {
    Vector3::from(x)
}

/// The master surface.
struct Surface {
    patches: Vec<Patch>,
    nodes: Vec<FacetNodes>,
    tree: BoundingVolumeTree,
    /// Edges that belong to one piece, by their sorted nodes, and their ends.
    rim: BTreeSet<[u32; 2]>,
    rim_nodes: BTreeSet<u32>,
}

/// The foot of a point on the surface.
struct Foot {
    point: Vector3<f64>,
    /// The mean normal of the pieces that meet there.
    normal: Vector3<f64>,
    /// Distance, positive in front of the surface.
    gap: f64,
    /// The longest edge of a piece there.
    edge: f64,
}

fn edge_of(piece: &FacetNodes, k: usize) -> [u32; 2] {
    let [a, b] = [piece[k], piece[piece.kind().next(k)]];
    [a.min(b), a.max(b)]
}

impl Surface {
    fn new(nodes: &[[f64; 3]], facets: &[Facet]) -> Self {
        let pieces: Vec<FacetNodes> = facets.iter().flat_map(|facet| facet.nodes.pieces()).collect();
        let patches: Vec<Patch> =
            pieces.iter().map(|piece| Patch::new(piece.map(|node| vector(nodes[node as usize])))).collect();
        let boxes: Vec<Aabb> = patches.iter().map(|patch| Aabb::from_points(patch.corners.iter())).collect();
        let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for piece in &pieces {
            (0..piece.len()).for_each(|k| *edges.entry(edge_of(piece, k)).or_default() += 1);
        }
        let rim: BTreeSet<[u32; 2]> =
            edges.into_iter().filter(|(_, count)| *count == 1).map(|(edge, _)| edge).collect();
        let rim_nodes = rim.iter().flatten().copied().collect();
        Self { tree: BoundingVolumeTree::build(&boxes), patches, nodes: pieces, rim, rim_nodes }
    }

    fn longest_edge(&self, piece: usize) -> f64 {
        let corners = &self.patches[piece].corners;
        (0..corners.len()).map(|k| (corners[corners.kind().next(k)] - corners[k]).norm()).fold(0.0, f64::max)
    }

    /// Whether a feature of a piece is on the rim of the surface.
    fn is_rim(&self, piece: usize, feature: PatchFeature) -> bool {
        match feature {
            PatchFeature::Interior => false,
            PatchFeature::Edge(k) => self.rim.contains(&edge_of(&self.nodes[piece], k)),
            PatchFeature::Vertex(k) => self.rim_nodes.contains(&self.nodes[piece][k]),
        }
    }

    /// The foot of a point that is not beside the surface.
    fn foot(&self, x: &Vector3<f64>) -> Option<Foot> {
        let mut best = f64::INFINITY;
        let mut found = Vec::new();
        self.tree.nearest(x, f64::INFINITY, |piece, bound| {
            let closest = self.patches[piece].closest_point(x);
            let distance = closest.distance_squared.sqrt();
            // Pieces that meet at the foot are all at this distance.
            let tolerance = ROUND_OFF * self.longest_edge(piece);
            if distance < best - tolerance {
                found.clear();
            }
            if distance <= best + tolerance {
                found.push((piece, closest));
            }
            best = best.min(distance);
            bound.min(distance + tolerance)
        });
        let (piece, closest) = *found.first()?;
        let normals = found.iter().map(|(piece, closest)| self.patches[*piece].frame(closest.xi).normal);
        let normal = normals.sum::<Vector3<f64>>().try_normalize(0.0)?;
        let way = x - closest.point;
        let along = way.dot(&normal);
        let edge = self.longest_edge(piece);
        let is_rim = found.iter().any(|(piece, closest)| self.is_rim(*piece, closest.feature));
        if is_rim && (way - normal * along).norm() > BESIDE * edge {
            return None;
        }
        let point = if is_rim { x - normal * along } else { closest.point };
        Some(Foot { point, normal, gap: (x - point).norm().copysign(along), edge })
    }
}

/// Moves nodes of the slave facets onto the master facets; `nodes` are the coordinates of the mesh. Nodes that belong to both surfaces, that are beside the master
/// surface, or whose facets face away from it, stay.
pub(crate) fn adjust(nodes: &mut [[f64; 3]], slave: &[Facet], master: &[Facet], which: Which<'_>) -> Moved {
    let surface = Surface::new(nodes, master);
    let of_master: BTreeSet<u32> = master.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
    // Of each slave node the sum of the normals of its pieces.
    let mut normals: BTreeMap<u32, Vector3<f64>> = BTreeMap::new();
    for facet in slave {
        for piece in facet.nodes.pieces() {
            let patch = Patch::new(piece.map(|node| vector(nodes[node as usize])));
            let area = patch.area_vector(patch.kind().centre());
            facet.nodes.iter().for_each(|&node| *normals.entry(node).or_default() += area);
        }
    }
    let mut moved = Moved::default();
    let mut places = Vec::new();
    for (node, own_normal) in normals {
        let is_meant = match which {
            Which::Within(_) => true,
            Which::Of(set) => set.binary_search(&node).is_ok(),
        };
        if !is_meant || of_master.contains(&node) {
            continue;
        }
        let Some(foot) = surface.foot(&vector(nodes[node as usize])) else { continue };
        if own_normal.dot(&foot.normal) >= 0.0 || foot.gap.abs() <= ROUND_OFF * foot.edge {
            continue;
        }
        if let Which::Within(distance) = which {
            if foot.gap > distance {
                continue;
            }
            // Farther behind it is the other side of a body.
            if -foot.gap > distance.max(foot.edge) {
                moved.too_deep += 1;
                continue;
            }
        }
        moved.count += 1;
        moved.farthest = moved.farthest.max(foot.gap.abs());
        places.push((node, foot.point));
    }
    for (node, place) in places {
        nodes[node as usize] = place.into();
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_mesh::{Elements, Mesh};
    use stoss_reference_element::CellKind;

    /// A plate of two by two hexahedra under z = 0, and the facets of its top; above it a cube of one hexahedron whose bottom has these heights.
    fn touching(bottom: [f64; 4], shift: f64) -> (Mesh, Vec<Facet>, Vec<Facet>) {
        let mut nodes: Vec<[f64; 3]> = Vec::new();
        for z in [-1.0, 0.0] {
            nodes.extend((0..9).map(|n| [f64::from(n % 3), f64::from(n / 3), z]));
        }
        let mut elements = Elements::new();
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let a = i + 3 * j;
            let ring = [a, a + 1, a + 4, a + 3];
            elements.push(CellKind::Hex8, &[ring.map(|n| n as u32), ring.map(|n| n as u32 + 9)].concat());
        }
        let corners = [[0.4, 0.4], [1.6, 0.4], [1.6, 1.6], [0.4, 1.6]];
        let first = nodes.len() as u32;
        for (xy, z) in corners.iter().zip(bottom) {
            nodes.push([xy[0] + shift, xy[1], z]);
        }
        nodes.extend(corners.iter().map(|xy| [xy[0] + shift, xy[1], 2.0]));
        elements.push(CellKind::Hex8, &(first..first + 8).collect::<Vec<_>>());
        let mesh = Mesh { nodes, elements, ..Mesh::default() };
        let at = |element: u32, z: &dyn Fn(f64) -> bool| {
            let facets = (0..6).map(|local| mesh.facet(element, local));
            facets.filter(|facet| facet.nodes.iter().all(|&n| z(mesh.nodes[n as usize][2]))).collect::<Vec<_>>()
        };
        let master = (0..4).flat_map(|e| at(e, &|z| z == 0.0)).collect();
        let slave = at(4, &|z| z < 1.0);
        (mesh, slave, master)
    }

    fn heights(mesh: &Mesh) -> Vec<f64> {
        mesh.nodes[18..22].iter().map(|x| x[2]).collect()
    }

    /// Gaps up to the distance and overlaps are closed; what is farther away stays. The other coordinates do not change.
    #[test]
    fn nodes_within_the_distance_move_along_the_normal() {
        let (mut mesh, slave, master) = touching([0.05, -0.04, 0.2, 0.0], 0.0);
        let before = mesh.clone();
        let moved = adjust(&mut mesh.nodes, &slave, &master, Which::Within(0.1));
        assert_eq!((moved.count, moved.too_deep), (2, 0));
        assert!((moved.farthest - 0.05).abs() < 1e-15);
        assert_eq!(heights(&mesh), [0.0, 0.0, 0.2, 0.0]);
        for (a, b) in mesh.nodes.iter().zip(&before.nodes) {
            assert_eq!(a[..2], b[..2]);
        }
        // Zero is for overlapping nodes only.
        let (mut mesh, slave, master) = touching([0.05, -0.04, 0.2, 0.0], 0.0);
        assert_eq!(adjust(&mut mesh.nodes, &slave, &master, Which::Within(0.0)).count, 1);
        assert_eq!(heights(&mesh), [0.05, 0.0, 0.2, 0.0]);
    }

    #[test]
    fn a_set_is_moved_however_far() {
        let (mut mesh, slave, master) = touching([0.05, -0.04, 0.2, 0.1], 0.0);
        let moved = adjust(&mut mesh.nodes, &slave, &master, Which::Of(&[2, 18, 20]));
        assert_eq!((moved.count, heights(&mesh)), (2, vec![0.0, -0.04, 0.0, 0.1]));
    }

    /// Nodes beside the rim, which have no foot along the normal.
    #[test]
    fn nodes_beside_the_master_surface_stay() {
        let (mut mesh, slave, master) = touching([0.05; 4], 1.0);
        adjust(&mut mesh.nodes, &slave, &master, Which::Within(0.5));
        assert_eq!(heights(&mesh), [0.0, 0.05, 0.05, 0.0]);
    }

    /// A node on the rim, but for the digits of a file.
    #[test]
    fn nodes_on_the_rim_move() {
        let (mut mesh, slave, master) = touching([0.05; 4], 0.4 + 1e-7);
        adjust(&mut mesh.nodes, &slave, &master, Which::Within(0.5));
        assert_eq!(heights(&mesh), [0.0; 4]);
        assert!((mesh.nodes[19][0] - (2.0 + 1e-7)).abs() < 1e-15);
    }

    /// Where the surfaces are the two sides of a body nothing is moved through it.
    #[test]
    fn what_is_far_behind_or_faces_away_stays() {
        let (mut mesh, slave, master) = touching([-1.7, 0.05, 0.05, 0.05], 0.0);
        let moved = adjust(&mut mesh.nodes, &slave, &master, Which::Within(0.1));
        assert_eq!((moved.count, moved.too_deep), (3, 1));
        let (mut mesh, slave, master) = touching([0.05; 4], 0.0);
        let turned: Vec<Facet> =
            (0..6).map(|local| mesh.facet(4, local)).filter(|f| f.nodes.iter().all(|&n| n >= 22)).collect();
        assert_eq!((slave.len(), turned.len()), (1, 1));
        assert_eq!(adjust(&mut mesh.nodes, &turned, &master, Which::Within(5.0)).count, 0);
    }

    /// An inclined master surface: nodes move along its normal, to z = x/2.
    #[test]
    fn inclined_surfaces() {
        let (mut mesh, slave, master) = touching([0.9; 4], 0.0);
        let incline = |x: [f64; 3]| [x[0], x[1], x[2] + 0.5 * x[0]];
        mesh.nodes[..18].iter_mut().for_each(|x| *x = incline(*x));
        let before = mesh.nodes.clone();
        adjust(&mut mesh.nodes, &slave, &master, Which::Within(10.0));
        for (x, old) in mesh.nodes.iter().zip(&before).take(22).skip(18) {
            // Distance of (x, z) from z = x/2 over sqrt(1 + 1/4), along (-1/2, 1).
            let gap = (old[2] - 0.5 * old[0]) / 1.25_f64.sqrt();
            let unit = 1.0 / 1.25_f64.sqrt();
            assert!(
                (x[0] - (old[0] + 0.5 * unit * gap)).abs() < 1e-12 && (x[2] - (old[2] - unit * gap)).abs() < 1e-12,
                "{x:?}"
            );
            assert!((x[2] - 0.5 * x[0]).abs() < 1e-12);
        }
    }
}
