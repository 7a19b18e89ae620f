//! The outer surface of a frame in its deformed place, with one number on every corner.

use std::collections::BTreeMap;

use crate::vtu::Grid;

/// Faces of a hexahedron in VTK's numbering, seen counter-clockwise from outside.
const FACES: [[usize; 4]; 6] = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// Corner places and values of a quadrilateral.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// Corners, counter-clockwise from outside.
    pub corners: [[f64; 3]; 4],
    /// Value at each corner.
    pub values: [f64; 4],
}

/// All faces that belong to one hexahedron only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// The faces in the order of the hexahedra.
    pub quads: Vec<Quad>,
}

impl Surface {
    /// Takes the surface of a frame; the value is the array's entry, or its length if it is a vector.
    pub fn new(grid: &Grid, field: &str) -> Result<Self, String> {
        let array = grid.point_data.get(field).ok_or_else(|| {
            let known: Vec<&str> = grid.point_data.keys().map(String::as_str).collect();
            format!("no point array {field:?}; there are {known:?}")
        })?;
        let place = |point: usize| deformed(grid, point);
        let quads = boundary(&grid.hexahedra)
            .into_iter()
            .map(|face| Quad { corners: face.map(place), values: face.map(|point| array.magnitude(point)) });
        Ok(Self { quads: quads.collect() })
    }
}

/// Place of a point: frames store reference coordinates and the displacement beside them.
fn deformed(grid: &Grid, point: usize) -> [f64; 3] {
    let reference = grid.points[point];
    match grid.point_data.get("displacement").map(|displacement| displacement.row(point)) {
        Some([x, y, z]) => [reference[0] + x, reference[1] + y, reference[2] + z],
        _ => reference,
    }
}

/// Faces that occur once.
pub fn boundary(hexahedra: &[[usize; 8]]) -> Vec<[usize; 4]> {
    let faces: Vec<[usize; 4]> =
        hexahedra.iter().flat_map(|cell| FACES.map(|face| face.map(|corner| cell[corner]))).collect();
    let key = |face: &[usize; 4]| {
        let mut key = *face;
        key.sort_unstable();
        key
    };
    let mut count = BTreeMap::new();
    for face in &faces {
        *count.entry(key(face)).or_insert(0) += 1;
    }
    faces.into_iter().filter(|face| count[&key(face)] == 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::camera::{cross, dot};
    use crate::vtu::tests::CUBE;
    use crate::vtu::{self, Array};

    fn cube() -> Grid {
        vtu::parse(&vtu::tests::write(&CUBE, &[[0, 1, 2, 3, 4, 5, 6, 7]], &[1.0; 8], true)).unwrap()
    }

    /// Divergence theorem: a closed surface with outward normals encloses a positive volume.
    fn volume(surface: &Surface) -> f64 {
        let triangle = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| dot(a, cross(b, c)) / 6.0;
        let quads = surface.quads.iter().map(|quad| quad.corners);
        quads.map(|[a, b, c, d]| triangle(a, b, c) + triangle(a, c, d)).sum()
    }

    #[test]
    fn the_surface_of_a_cube_points_outwards() {
        let surface = Surface::new(&cube(), "speed").unwrap();
        assert_eq!(surface.quads.len(), 6);
        assert!((volume(&surface) - 1.0).abs() < 1e-14);
        assert!(Surface::new(&cube(), "colour").unwrap_err().contains("speed"));
    }

    #[test]
    fn inner_faces_are_left_out() {
        let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]];
        assert_eq!(boundary(&cells).len(), 10);
    }

    #[test]
    fn the_displacement_is_added() {
        let mut grid = cube();
        let stretch = CUBE.iter().flat_map(|point| [point[0], 0.0, 0.0]).collect();
        grid.point_data.insert("displacement".into(), Array { components: 3, values: stretch });
        assert!((volume(&Surface::new(&grid, "speed").unwrap()) - 2.0).abs() < 1e-14);
    }
}
