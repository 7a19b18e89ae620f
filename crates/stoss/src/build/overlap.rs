//! Whether bodies, or points, lie in a mesh.

use std::collections::HashMap;
use stoss_mesh::Mesh;

/// Finds elements of a mesh by place: a grid whose cells are as large as the largest element.
pub(super) struct Locator<'a> {
    mesh: &'a Mesh,
    size: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl<'a> Locator<'a> {
    pub fn new(mesh: &'a Mesh) -> Self {
        let boxes: Vec<[[f64; 3]; 2]> = (0..mesh.elements.len() as u32).map(|e| bounds(mesh, e)).collect();
        let size = boxes.iter().flat_map(|[low, high]| (0..3).map(|i| high[i] - low[i])).fold(0.0, f64::max);
        let mut locator = Self { mesh, size, cells: HashMap::new() };
        for (element, [low, high]) in boxes.iter().enumerate() {
            let (first, last) = (locator.cell(low), locator.cell(high));
            for x in first[0]..=last[0] {
                for y in first[1]..=last[1] {
                    for z in first[2]..=last[2] {
                        locator.cells.entry([x, y, z]).or_default().push(element as u32);
                    }
                }
            }
        }
        locator
    }

    fn cell(&self, x: &[f64; 3]) -> [i64; 3] {
        x.map(|c| (c / self.size).floor() as i64)
    }

    pub fn contains(&self, x: &[f64; 3]) -> bool {
        let candidates = self.cells.get(&self.cell(x)).map_or(&[][..], Vec::as_slice);
        candidates.iter().any(|&element| {
            let corners = self.mesh.element_coordinates(element);
            let tetrahedra = corners.kind().table().family.tetrahedra();
            tetrahedra.iter().any(|tetrahedron| is_inside(x, tetrahedron.map(|k| corners[k])))
        })
    }

    /// Number of elements of another mesh whose centre lies in this one.
    #[cfg(any(feature = "nts", feature = "mortar"))]
    pub fn centres_of(&self, other: &Mesh) -> usize {
        let centre = |element: u32| {
            let corners = other.element_coordinates(element);
            std::array::from_fn(|i| corners.iter().map(|x| x[i]).sum::<f64>() / corners.len() as f64)
        };
        (0..other.elements.len() as u32).filter(|&element| self.contains(&centre(element))).count()
    }
}

fn bounds(mesh: &Mesh, element: u32) -> [[f64; 3]; 2] {
    let corners = mesh.element_coordinates(element);
    corners.iter().fold([corners[0]; 2], |[low, high], x| {
        [std::array::from_fn(|i| low[i].min(x[i])), std::array::from_fn(|i| high[i].max(x[i]))]
    })
}

/// Six times the volume of a tetrahedron, positive if `b`, `c`, `d` turn counter-clockwise seen against `a`'s side.
fn volume([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    let [u, v, w] = [b, c, d].map(|x| [x[0] - a[0], x[1] - a[1], x[2] - a[2]]);
    u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])
}

/// The boundary, up to round-off, included.
fn is_inside(x: &[f64; 3], corners: [[f64; 3]; 4]) -> bool {
    let whole = volume(corners);
    (0..4).all(|k| {
        let mut part = corners;
        part[k] = *x;
        volume(part) * whole.signum() >= -1.0e-12 * whole.abs()
    })
}

#[cfg(any(feature = "nts", feature = "mortar"))]
#[cfg(test)]
mod tests {
    use super::*;
    use stoss_mesh::Rotation;
    use stoss_mesh::generate::Block;

    fn block(min: [f64; 3], max: [f64; 3], divisions: [usize; 3]) -> Mesh {
        let divisions = divisions.map(|n| n as _);
        Block { min, max, divisions, grading: [1.0; 3] }.generate().unwrap()
    }

    #[test]
    fn centres_of_a_block_in_a_turned_block() {
        // The square |x| + |y| <= 1 holds those of the 4 x 4 centres at +-0.25, +-0.75 that are at most 1 from the middle.
        let mut diamond = block([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0], [3, 3, 2]);
        diamond.transform(Some(&Rotation { axis: [0.0, 0.0, 1.0], degrees: 45.0, about: [0.0; 3] }), [0.0; 3]).unwrap();
        for x in &mut diamond.nodes {
            // Half the diagonal of the block is the square root of two.
            (x[0], x[1]) = (x[0] * (1.01 / 2f64.sqrt()), x[1] * (1.01 / 2f64.sqrt()));
        }
        let grid = block([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [4, 4, 2]);
        let expected = [-0.75, -0.25, 0.25, 0.75f64]
            .iter()
            .flat_map(|x: &f64| [-0.75, -0.25, 0.25, 0.75f64].map(|y| x.abs() + y.abs() <= 1.0))
            .filter(|inside| *inside)
            .count();
        assert_eq!(expected, 12);
        assert_eq!(Locator::new(&diamond).centres_of(&grid), expected);
        assert_eq!(Locator::new(&block([2.0; 3], [3.0; 3], [1; 3])).centres_of(&grid), 0);
    }

    #[test]
    fn a_mesh_contains_its_own_centres() {
        let mesh = block([0.0; 3], [1.0, 2.0, 3.0], [3, 2, 4]);
        assert_eq!(Locator::new(&mesh).centres_of(&mesh), 24);
    }
}
