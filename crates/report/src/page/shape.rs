//! What is drawn of a model: outer facets, lines and points of each body, with the nodes that they need and no others.

use serde::Serialize;
use stoss_reference_element::Family;

use crate::paint::boundary;
use crate::vtu::{Grid, chosen};

/// A body and where its cells are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Name of the body.
    pub name: String,
    /// First facet and number of facets.
    pub facets: [usize; 2],
    /// First segment and number of segments.
    pub segments: [usize; 2],
    /// First point and number of points.
    pub points: [usize; 2],
    /// First element and number of elements.
    pub elements: [usize; 2],
    /// The smallest point of the frames that it uses: nodes are counted from there.
    pub first: usize,
    /// Whether it is deformable.
    pub is_solid: bool,
}

/// Cells of all bodies, body after body. Nodes are numbered again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Connectivity {
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Point of the frames that each node is.
    pub nodes: Vec<usize>,
    /// Corners of facets; of a triangle the last two are the same.
    pub facets: Vec<[u32; 4]>,
    /// Sides of each facet that are edges of elements, from the corner `k` to the next: bit `k`.
    pub sides: Vec<u32>,
    /// Ends of the segments of lines.
    pub segments: Vec<[u32; 2]>,
    /// Single points.
    pub points: Vec<u32>,
    /// Corners of elements as of a hexahedron, in which those of other kinds coincide: what is inside of bodies, unless it is left out.
    pub elements: Vec<[u32; 8]>,
    /// Numbers of cells of the frame, which no other frame may differ in.
    cells: [usize; 4],
    /// Number of points of the frame.
    count: usize,
}

/// Gives numbers to points in the order in which they are asked for.
struct Numbering {
    number: Vec<u32>,
    nodes: Vec<usize>,
}

impl Numbering {
    fn of(&mut self, point: usize) -> u32 {
        if self.number[point] == u32::MAX {
            self.number[point] = self.nodes.len() as u32;
            self.nodes.push(point);
        }
        self.number[point]
    }
}

fn mask(sides: [bool; 4]) -> u32 {
    sides.iter().enumerate().map(|(k, &side)| u32::from(side) << k).sum()
}

/// Corners of an element at the corners of a hexahedron.
fn hexahedron(family: Family) -> [usize; 8] {
    match family {
        Family::Hexahedron => [0, 1, 2, 3, 4, 5, 6, 7],
        Family::Wedge => [0, 1, 2, 2, 3, 4, 5, 5],
        Family::Tetrahedron => [0, 1, 2, 2, 3, 3, 3, 3],
    }
}

/// Numbers of cells of a frame.
fn cells(grid: &Grid) -> [usize; 4] {
    [grid.elements.len(), grid.facets.len(), grid.lines.len(), grid.vertices.len()]
}

impl Connectivity {
    /// The shape of a frame, perhaps with what is inside of bodies; bodies beyond the names are called by their numbers.
    pub fn new(grid: &Grid, names: &[String], has_inside: bool) -> Self {
        let cells = cells(grid);
        let total = cells.iter().sum::<usize>();
        let numbers = grid.cell_data.get("body").filter(|array| array.values.len() == total);
        let body_of = |cell: usize| numbers.map_or(0, |numbers| numbers.values[cell].clamp(0.0, 1e6) as usize);
        // Cells of a body stand in a row, so that a body is a run of equal numbers in each kind of cell.
        let offsets = [0, cells[0], cells[0] + cells[1], cells[0] + cells[1] + cells[2]];
        let count = (0..total).map(|cell| body_of(cell) + 1).max().unwrap_or(0);
        let of = |kind: usize, body: usize| (0..cells[kind]).filter(move |&k| body_of(offsets[kind] + k) == body);
        let mut numbering = Numbering { number: vec![u32::MAX; grid.points.len()], nodes: Vec::new() };
        let mut shape = Self { cells, count: grid.points.len(), ..Self::default() };
        for body in 0..count.min(total) {
            let starts = shape.lengths();
            let elements = chosen(&grid.elements, of(0, body));
            let facets: Vec<&[u32]> = of(1, body).map(|k| &*grid.facets[k]).collect();
            let lines: Vec<&[u32]> = of(2, body).map(|k| grid.lines[k].as_slice()).collect();
            let points: Vec<u32> = of(3, body).map(|k| grid.vertices[k]).collect();
            let others = facets.iter().chain(&lines).copied().flatten().chain(&points);
            let Some(&first) = elements.iter().flatten().chain(others).min() else { continue };
            let first = first as usize;
            let faces = boundary(&elements);
            shape.facets.extend(faces.iter().map(|face| face.points.map(|point| numbering.of(point))));
            shape.sides.extend(faces.iter().map(|face| mask(face.edges)));
            let corner = |facet: &[u32], k: usize| facet[k.min(facet.len() - 1)] as usize;
            shape.facets.extend(
                facets.iter().map(|facet| [0, 1, 2, 3].map(|k| corner(facet, k)).map(|point| numbering.of(point))),
            );
            shape.sides.resize(shape.facets.len(), mask([true; 4]));
            for line in lines {
                shape
                    .segments
                    .extend(line.windows(2).map(|ends| [ends[0], ends[1]].map(|end| numbering.of(end as usize))));
            }
            shape.points.extend(points.iter().map(|&point| numbering.of(point as usize)));
            for k in 0..if has_inside { elements.len() } else { 0 } {
                let corners = hexahedron(elements.kind(k).table().family);
                shape.elements.push(corners.map(|corner| numbering.of(elements[k][corner] as usize)));
            }
            let ends = shape.lengths();
            let [facets, segments, points, inside] = [0, 1, 2, 3].map(|k| [starts[k], ends[k] - starts[k]]);
            let name = names.get(body).cloned().unwrap_or_else(|| format!("body {body}"));
            let is_solid = !elements.is_empty();
            shape.bodies.push(Body { name, facets, segments, points, elements: inside, first, is_solid });
        }
        shape.nodes = numbering.nodes;
        shape
    }

    /// Numbers of facets, segments, points and elements.
    fn lengths(&self) -> [usize; 4] {
        [self.facets.len(), self.segments.len(), self.points.len(), self.elements.len()]
    }

    /// Whether a frame has the same cells.
    pub fn fits(&self, grid: &Grid) -> bool {
        self.cells == cells(grid) && self.count == grid.points.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vtu::Array;
    use crate::vtu::tests::cube;

    #[test]
    fn bodies_have_their_cells_and_inner_nodes_are_left_out() {
        let mut grid = cube(&[0.0; 8]);
        // Three points of no cell, a triangle, a line of two segments and a single point.
        grid.points.extend([[9.0; 3]; 7]);
        grid.facets = vec![[11, 12, 13].into()];
        grid.lines = vec![vec![12, 13, 14]];
        grid.vertices = vec![14];
        grid.cell_data.insert("body".into(), Array { components: 1, values: vec![0.0, 1.0, 2.0, 3.0] });
        let shape = Connectivity::new(&grid, &["cube".into(), "plate".into(), "rope".into()], true);
        let names: Vec<&str> = shape.bodies.iter().map(|body| body.name.as_str()).collect();
        assert_eq!(names, ["cube", "plate", "rope", "body 3"]);
        assert_eq!(shape.bodies.iter().map(|body| body.facets).collect::<Vec<_>>(), [[0, 6], [6, 1], [7, 0], [7, 0]]);
        assert_eq!(shape.bodies.iter().map(|body| body.segments[1]).collect::<Vec<_>>(), [0, 0, 2, 0]);
        assert_eq!(shape.bodies.iter().map(|body| body.first).collect::<Vec<_>>(), [0, 11, 12, 14]);
        assert_eq!(shape.bodies.iter().map(|body| body.elements).collect::<Vec<_>>(), [[0, 1], [1, 0], [1, 0], [1, 0]]);
        assert_eq!(shape.elements[0].map(|node| shape.nodes[node as usize]), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert!(Connectivity::new(&grid, &[], false).elements.is_empty());
        assert_eq!(shape.sides, [15; 7]);
        assert_eq!(shape.nodes.len(), 8 + 4);
        let at = |node: u32| shape.nodes[node as usize];
        assert_eq!(shape.facets[6].map(at), [11, 12, 13, 13]);
        assert_eq!(shape.segments.iter().map(|ends| ends.map(at)).collect::<Vec<_>>(), [[12, 13], [13, 14]]);
        assert_eq!(shape.points.iter().map(|&node| at(node)).collect::<Vec<_>>(), [14]);
        assert!(shape.fits(&grid));
        grid.vertices.push(3);
        assert!(!shape.fits(&grid));
    }
}
