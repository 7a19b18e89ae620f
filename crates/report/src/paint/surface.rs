//! What a frame shows in its deformed place: outer surfaces, lines and points, with one number on every corner.

use std::collections::BTreeSet;

use stoss_mesh::{Elements, FacetIndex};
use stoss_reference_element::FaceKind;

use crate::vtu::{Array, Grid};

/// Corner places and values of a quadrilateral; the last two corners of a triangle are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// Corners, counter-clockwise from outside.
    pub corners: [[f64; 3]; 4],
    /// Value at each corner.
    pub values: [f64; 4],
    /// Which of its sides are drawn: not those between the pieces of one face.
    pub edges: [bool; 4],
    /// Whether it is a facet of a rigid body, which may be as large as the picture.
    pub is_rigid: bool,
    /// Whether it is seen from behind, too: its surface is open.
    pub has_back: bool,
}

/// A line from point to point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Points of the line.
    pub points: Vec<[f64; 3]>,
    /// Value at each point.
    pub values: Vec<f64>,
}

/// Faces, lines and points that are drawn of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Primitives {
    /// Faces that belong to one element only, in the order of the elements and quadratic ones in pieces, and facets.
    pub quads: Vec<Quad>,
    /// Lines.
    pub lines: Vec<Line>,
    /// Single points with their values.
    pub points: Vec<([f64; 3], f64)>,
}

impl Primitives {
    /// Takes the surface of a frame; the value is the array's entry, or its length if it is a vector.
    ///
    /// # Errors
    /// If there is no such array, with the names of those that there are.
    pub fn new(grid: &Grid, field: &str) -> Result<Self, String> {
        let array = grid.point_data.get(field).ok_or_else(|| {
            let known: Vec<&str> = grid.point_data.keys().map(String::as_str).collect();
            format!("no point array {field:?}; there are {known:?}")
        })?;
        let place = |point: usize| deformed(grid, point);
        let value = |point: usize| array.magnitude(point);
        let quad = |LinearFace { points, edges }: LinearFace| Quad {
            corners: points.map(place),
            values: points.map(value),
            edges,
            is_rigid: false,
            has_back: false,
        };
        let solids = boundary(&grid.elements).into_iter().map(quad);
        let open = open_bodies(grid);
        let facets = grid.facets.iter().enumerate().map(|(k, facet)| {
            let corner = |k: usize| facet[k.min(facet.len() - 1)] as usize;
            let has_back = open.contains(&body_of_facet(grid, k));
            let points = [0, 1, 2, 3].map(corner);
            Quad { is_rigid: true, has_back, ..quad(LinearFace { points, edges: [true; 4] }) }
        });
        let line = |line: &Vec<u32>| Line {
            points: line.iter().map(|&point| place(point as usize)).collect(),
            values: line.iter().map(|&point| value(point as usize)).collect(),
        };
        Ok(Self {
            quads: solids.chain(facets).collect(),
            lines: grid.lines.iter().map(line).collect(),
            points: grid.vertices.iter().map(|&point| (place(point as usize), value(point as usize))).collect(),
        })
    }

    /// Places of all corners and points.
    pub(crate) fn places(&self) -> impl Iterator<Item = [f64; 3]> {
        let quads = self.quads.iter().flat_map(|quad| quad.corners);
        let lines = self.lines.iter().flat_map(|line| line.points.iter().copied());
        quads.chain(lines).chain(self.points.iter().map(|(place, _)| *place))
    }

    /// Values at all corners and points.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> {
        let quads = self.quads.iter().flat_map(|quad| quad.values);
        let lines = self.lines.iter().flat_map(|line| line.values.iter().copied());
        quads.chain(lines).chain(self.points.iter().map(|(_, value)| *value))
    }
}

/// Number of the body of a facet; zero in frames that do not tell.
fn body_of_facet(grid: &Grid, facet: usize) -> u64 {
    let number = |bodies: &Array| bodies.values.get(grid.elements.len() + facet).map(|body| *body as u64);
    grid.cell_data.get("body").and_then(number).unwrap_or(0)
}

/// Bodies of facets that have an edge without a facet on its other side.
fn open_bodies(grid: &Grid) -> BTreeSet<u64> {
    let edges = grid.facets.iter().enumerate().flat_map(|(k, facet)| {
        let next = facet.iter().cycle().skip(1);
        facet.iter().zip(next).map(move |(&a, &b)| (body_of_facet(grid, k), a, b))
    });
    let edges: BTreeSet<(u64, u32, u32)> = edges.collect();
    edges.iter().filter(|&&(body, a, b)| !edges.contains(&(body, b, a))).map(|&(body, ..)| body).collect()
}

/// Place of a point: frames store reference coordinates and the displacement beside them.
pub(crate) fn deformed(grid: &Grid, point: usize) -> [f64; 3] {
    let reference = grid.points[point];
    match grid.point_data.get("displacement").map(|displacement| displacement.row(point)) {
        Some([x, y, z]) => [reference[0] + x, reference[1] + y, reference[2] + z],
        _ => reference,
    }
}

/// A linear piece of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinearFace {
    /// Corners of the piece; the last two of a triangle are the same.
    pub points: [usize; 4],
    /// Which of its sides, from each corner to the next, lie on edges of the face.
    pub edges: [bool; 4],
}

/// Pieces of the faces that only one element has.
pub fn boundary(elements: &Elements) -> Vec<LinearFace> {
    let mut all = Vec::new();
    for face in FacetIndex::new(elements).boundary() {
        let kind = face.nodes.kind();
        for piece in kind.pieces() {
            let corners = [0, 1, 2, 3].map(|k: usize| piece[k.min(piece.len() - 1)]);
            let edges = [0, 1, 2, 3].map(|k: usize| is_on_edge(kind, corners[k], corners[(k + 1) % 4]));
            all.push(LinearFace { points: corners.map(|k| face.nodes[usize::from(k)] as usize), edges });
        }
    }
    all
}

/// Whether two nodes of a face are ends of an edge, or an end and the node in its middle.
fn is_on_edge(kind: FaceKind, one: u8, other: u8) -> bool {
    let corners = kind.corner_count() as u8;
    (0..corners).any(|k| {
        let next = (k + 1) % corners;
        let edge = if kind.is_quadratic() { [k, corners + k, next] } else { [k, k, next] };
        one != other && edge.contains(&one) && edge.contains(&other)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::camera::{cross, dot};
    use crate::vtu::tests::{CUBE, cube as grid};
    use std::collections::BTreeMap;
    use stoss_reference_element::{CellKind, FaceNodes};

    fn cube() -> Grid {
        grid(&[1.0; 8])
    }

    /// Divergence theorem: a closed surface with outward normals encloses a positive volume.
    fn volume(surface: &Primitives) -> f64 {
        let triangle = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| dot(a, cross(b, c)) / 6.0;
        let quads = surface.quads.iter().map(|quad| quad.corners);
        quads.map(|[a, b, c, d]| triangle(a, b, c) + triangle(a, c, d)).sum()
    }

    #[test]
    fn the_surface_of_a_cube_points_outwards() {
        let surface = Primitives::new(&cube(), "speed").unwrap();
        assert_eq!(surface.quads.len(), 6);
        assert!((volume(&surface) - 1.0).abs() < 1e-14);
        assert!(Primitives::new(&cube(), "colour").unwrap_err().contains("speed"));
    }

    #[test]
    fn inner_faces_are_left_out() {
        let cells = vec![[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]];
        assert_eq!(boundary(&cells.into()).len(), 10);
        let tet10 = Elements::of_kind(CellKind::Tet10, (0..10).collect());
        assert_eq!(boundary(&tet10).len(), 16);
    }

    /// Every edge of a cell is two sides of pieces of each of its two faces, from a corner to the node in the middle; no other side is drawn.
    #[test]
    fn sides_within_a_face_are_no_edges() {
        for (kind, edges) in [
            (CellKind::Hex8, 12),
            (CellKind::Wedge6, 9),
            (CellKind::Tet10, 2 * 6),
            (CellKind::Hex20, 2 * 12),
            (CellKind::Hex27, 2 * 12),
            (CellKind::Wedge15, 2 * 9),
        ] {
            let nodes = kind.node_count() as u32;
            let mut sides: BTreeMap<[usize; 2], usize> = BTreeMap::new();
            for piece in boundary(&Elements::of_kind(kind, (0..nodes).collect())) {
                for k in (0..4).filter(|&k| piece.edges[k]) {
                    let (a, b) = (piece.points[k], piece.points[(k + 1) % 4]);
                    *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
                }
            }
            assert_eq!(sides.len(), edges, "{kind}");
            assert!(sides.values().all(|&count| count == 2), "{kind}: {sides:?}");
            let is_corner = |node: usize| node < kind.table().linear.node_count();
            assert!(sides.keys().all(|[a, b]| is_corner(*a) && (is_corner(*b) != kind.is_quadratic())), "{kind}");
        }
    }

    #[test]
    fn the_displacement_is_added() {
        let mut grid = cube();
        let stretch = CUBE.iter().flat_map(|point| [point[0], 0.0, 0.0]).collect();
        grid.point_data.insert("displacement".into(), Array { components: 3, values: stretch });
        assert!((volume(&Primitives::new(&grid, "speed").unwrap()) - 2.0).abs() < 1e-14);
    }

    /// The sides of the cube as facets, one of them as two triangles, and then without that side.
    #[test]
    fn facets_point_outwards_and_open_surfaces_have_a_back() {
        let faces = boundary(&cube().elements);
        let mut grid = Grid { elements: Elements::new(), ..cube() };
        let facet = |face: &LinearFace| FaceNodes::from(face.points.map(|point| point as u32));
        grid.facets = faces[..5].iter().map(facet).collect();
        let [a, b, c, d] = faces[5].points.map(|point| point as u32);
        grid.facets.extend([FaceNodes::from([a, b, c]), [a, c, d].into()]);
        let closed = Primitives::new(&grid, "speed").unwrap();
        assert!((volume(&closed) - 1.0).abs() < 1e-14);
        assert!(closed.quads.len() == 7 && closed.quads.iter().all(|quad| quad.is_rigid && !quad.has_back));
        grid.facets.truncate(5);
        assert!(Primitives::new(&grid, "speed").unwrap().quads.iter().all(|quad| quad.has_back));
        // Two bodies, the first of them open.
        grid.facets.extend(faces.iter().map(facet));
        let values = (0..11).map(|k| if k < 5 { 0.0 } else { 1.0 }).collect();
        grid.cell_data.insert("body".into(), Array { components: 1, values });
        let backs: Vec<bool> =
            Primitives::new(&grid, "speed").unwrap().quads.iter().map(|quad| quad.has_back).collect();
        assert_eq!(backs, [[true; 5].as_slice(), &[false; 6]].concat());
    }
}
