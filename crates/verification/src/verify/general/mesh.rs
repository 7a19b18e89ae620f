//! Hexahedra of bodies that no generator of the scene format makes: rings, tubes along curves, gears, grooves.

use std::f64::consts::PI;
use std::fmt::Write;

type Point = [f64; 3];

/// Hexahedra, numbered as the scene format reads them: the bottom counter-clockwise seen from the top, then the top.
#[derive(Clone, Debug, Default)]
pub struct Hexahedra {
    /// Nodes.
    pub nodes: Vec<Point>,
    /// Eight nodes an element.
    pub elements: Vec<[usize; 8]>,
}

impl Hexahedra {
    /// A grid of so many elements along three directions; `place` takes the node whose numbers along them are given. A closed grid has its last element along
    /// the first direction end where the first one begins.
    pub fn grid(n: [usize; 3], closed: bool, place: impl Fn([usize; 3]) -> Point) -> Self {
        let along = if closed { n[0] } else { n[0] + 1 };
        let number = |i: usize, j: usize, k: usize| i % along + along * (j + (n[1] + 1) * k);
        let mut mesh = Self::default();
        for k in 0..=n[2] {
            for j in 0..=n[1] {
                mesh.nodes.extend((0..along).map(|i| place([i, j, k])));
            }
        }
        for k in 0..n[2] {
            for j in 0..n[1] {
                for i in 0..n[0] {
                    let face =
                        |k: usize| [number(i, j, k), number(i + 1, j, k), number(i + 1, j + 1, k), number(i, j + 1, k)];
                    let ([a, b, c, d], [e, f, g, h]) = (face(k), face(k + 1));
                    mesh.elements.push([a, b, c, d, e, f, g, h]);
                }
            }
        }
        mesh
    }

    /// Both meshes in one, without common nodes.
    pub fn and(mut self, other: &Self) -> Self {
        let first = self.nodes.len();
        self.nodes.extend(&other.nodes);
        self.elements.extend(other.elements.iter().map(|element| element.map(|node| node + first)));
        self
    }

    /// An Abaqus file.
    pub fn text(&self) -> String {
        let mut text = String::from("*NODE\n");
        // cannot fail: writing to a String.
        for (k, [x, y, z]) in self.nodes.iter().enumerate() {
            let _ = writeln!(text, "{}, {x:?}, {y:?}, {z:?}", k + 1);
        }
        text.push_str("*ELEMENT, TYPE=C3D8\n");
        for (k, element) in self.elements.iter().enumerate() {
            let nodes: Vec<String> = element.iter().map(|node| (node + 1).to_string()).collect();
            let _ = writeln!(text, "{}, {}", k + 1, nodes.join(", "));
        }
        text
    }

    /// Volume by one point an element: enough for scales.
    pub fn volume(&self) -> f64 {
        let volume = |element: &[usize; 8]| {
            let x = element.map(|node| self.nodes[node]);
            let side = |plus: [usize; 4], minus: [usize; 4]| -> Point {
                let sum = |corners: [usize; 4], i: usize| corners.map(|c| x[c][i]).iter().sum::<f64>();
                std::array::from_fn(|i| 0.25 * (sum(plus, i) - sum(minus, i)))
            };
            let (a, b) = (side([1, 2, 5, 6], [0, 3, 4, 7]), side([2, 3, 6, 7], [0, 1, 4, 5]));
            dot(cross(a, b), side([4, 5, 6, 7], [0, 1, 2, 3]))
        };
        self.elements.iter().map(volume).sum()
    }
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Point, b: Point) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// Part `i` of `n`.
fn part(i: usize, n: usize) -> f64 {
    i as f64 / n as f64
}

/// A point of the square of edge 2 on the disc of radius 1.
fn disc(i: usize, j: usize, n: usize) -> [f64; 2] {
    let (a, b) = (2.0 * part(i, n) - 1.0, 2.0 * part(j, n) - 1.0);
    [a * (1.0 - 0.5 * b * b).sqrt(), b * (1.0 - 0.5 * a * a).sqrt()]
}

/// A band of radius 1 about the z-axis, `wall` thick and `width` wide; with a gap of so many degrees about the x-axis it is open.
pub fn band(around: usize, wall: f64, width: f64, gap: f64) -> Hexahedra {
    Hexahedra::grid([around, 1, 1], gap == 0.0, |[i, j, k]| {
        let angle = (0.5 * gap + part(i, around) * (360.0 - gap)).to_radians();
        let radius = 1.0 + wall * (0.5 - j as f64);
        [radius * angle.cos(), radius * angle.sin(), width * (k as f64 - 0.5)]
    })
}

/// A solid torus about the z-axis with `cells` elements across its tube.
pub fn torus(ring: f64, tube: f64, around: usize, cells: usize) -> Hexahedra {
    Hexahedra::grid([around, cells, cells], true, |[i, j, k]| {
        let angle = 2.0 * PI * part(i, around);
        let [x, y] = disc(j, k, cells);
        let radius = ring - tube * x;
        [radius * angle.cos(), radius * angle.sin(), tube * y]
    })
}

/// A tube of two elements across along the closed curve, which is given by its parameter from 0 to 1; its section is carried along without twist, and the angle that is
/// missing at the end is spread over the whole length.
pub fn tube(curve: impl Fn(f64) -> Point, radius: f64, along: usize) -> Hexahedra {
    let points: Vec<Point> = (0..along).map(|i| curve(part(i, along))).collect();
    let tangent = |i: usize| {
        let (before, after) = (points[(i + along - 1) % along], points[(i + 1) % along]);
        unit(std::array::from_fn(|k| after[k] - before[k]))
    };
    let across = |vector: Point, tangent: Point| {
        let along = dot(vector, tangent);
        unit(std::array::from_fn(|k| vector[k] - along * tangent[k]))
    };
    let mut first = vec![across([0.3, 0.2, 1.0], tangent(0))];
    for i in 1..=along {
        first.push(across(first[i - 1], tangent(i % along)));
    }
    let missing = {
        let [x, y] = [first[0], cross(tangent(0), first[0])].map(|axis| dot(first[along], axis));
        y.atan2(x)
    };
    Hexahedra::grid([along, 2, 2], true, |[i, j, k]| {
        let (s, c) = (-missing * part(i, along)).sin_cos();
        let (u, v) = (first[i], cross(tangent(i), first[i]));
        let [x, y] = disc(j, k, 2);
        std::array::from_fn(|d| points[i][d] + radius * ((x * c - y * s) * u[d] + (x * s + y * c) * v[d]))
    })
}

/// The trefoil on a torus of radii 1 and 0.45.
pub fn trefoil(part: f64) -> Point {
    let angle = 2.0 * PI * part;
    let radius = 1.0 + 0.45 * (3.0 * angle).cos();
    [radius * (2.0 * angle).cos(), radius * (2.0 * angle).sin(), 0.45 * (3.0 * angle).sin()]
}

/// A ring with a groove around it, `half` wide to either side of the radius 1 and from z = 0.2 down to -0.25; the walls are 0.2 thick, the floor 0.3.
pub fn groove(half: f64, around: usize) -> Hexahedra {
    let outline =
        |half: f64, floor: f64| [[1.0 - half, 0.2], [1.0 - half, floor], [1.0 + half, floor], [1.0 + half, 0.2]];
    let (inside, outside) = (outline(half, -0.25), outline(half + 0.2, -0.55));
    Hexahedra::grid([around, 3, 1], true, |[i, j, k]| {
        let angle = 2.0 * PI * part(i, around);
        let [radius, z] = if k == 0 { inside[j] } else { outside[j] };
        [radius * angle.cos(), radius * angle.sin(), z]
    })
}

/// A gear: so many teeth, radii of the bore, the roots and the tips. Flanks are straight. A tooth points along x.
pub fn gear(teeth: usize, [bore, root, tip]: [f64; 3], width: f64) -> Hexahedra {
    // Parts of a pitch: the gap, a flank, the tip, the other flank.
    const PARTS: [f64; 4] = [0.3, 0.2, 0.3, 0.2];
    let pitch = 2.0 * PI / teeth as f64;
    Hexahedra::grid([4 * teeth, 2, 1], true, |[i, j, k]| {
        let (tooth, place) = (i / 4, i % 4);
        let angle = pitch * (tooth as f64 + PARTS[..place].iter().sum::<f64>() - 0.65);
        // From the outside to the bore, so that elements have the right orientation.
        let radius = match j {
            0 if place < 2 => root,
            0 => tip,
            1 => bore + 0.6 * (root - bore),
            _ => bore,
        };
        [radius * angle.cos(), radius * angle.sin(), width * (k as f64 - 0.5)]
    })
}

/// A wedge with the apex down, cut off there: half of its width is `least` at z = 0 and grows by `slope`.
pub fn wedge(least: f64, slope: f64) -> Hexahedra {
    Hexahedra::grid([2, 2, 2], false, |[i, j, k]| {
        let (x, y, z) = (part(i, 2), part(j, 2), part(k, 2));
        [(2.0 * x - 1.0) * (least + slope * z), 0.6 * (y - 0.5), z]
    })
}

/// Triangles of a flat box of the size 3 x 3 x 0.3 with its top at z = 0, on which there is a row of slivers of this height. An STL file.
pub fn slab_with_slivers(height: f64) -> String {
    let (x, y) = ([-1.5, -0.5, 0.2, 1.5], [-1.5, 0.0, height, 1.5]);
    let mut text = String::from("solid slab\n");
    let mut quadrilateral = |[p, q, r, s]: [Point; 4]| {
        for corners in [[p, q, r], [p, r, s]] {
            text.push_str("facet normal 0 0 0\nouter loop\n");
            for [x, y, z] in corners {
                // cannot fail: writing to a String.
                let _ = writeln!(text, "vertex {x:?} {y:?} {z:?}");
            }
            text.push_str("endloop\nendfacet\n");
        }
    };
    let low = -0.3;
    for i in 0..3 {
        for j in 0..3 {
            let [a, b, c, d] = [[x[i], y[j]], [x[i + 1], y[j]], [x[i + 1], y[j + 1]], [x[i], y[j + 1]]];
            let at = |[x, y]: [f64; 2], z: f64| [x, y, z];
            quadrilateral([at(a, 0.0), at(b, 0.0), at(c, 0.0), at(d, 0.0)]);
            quadrilateral([at(a, low), at(d, low), at(c, low), at(b, low)]);
        }
        let (p, q) = (x[i], x[i + 1]);
        quadrilateral([[q, -1.5, 0.0], [p, -1.5, 0.0], [p, -1.5, low], [q, -1.5, low]]);
        quadrilateral([[p, 1.5, 0.0], [q, 1.5, 0.0], [q, 1.5, low], [p, 1.5, low]]);
        let (p, q) = (y[i], y[i + 1]);
        quadrilateral([[-1.5, p, 0.0], [-1.5, q, 0.0], [-1.5, q, low], [-1.5, p, low]]);
        quadrilateral([[1.5, q, 0.0], [1.5, p, 0.0], [1.5, p, low], [1.5, q, low]]);
    }
    text.push_str("endsolid slab\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_elements_are_the_right_way_round() {
        let knot = tube(trefoil, 0.2, 48);
        let meshes = [
            (band(24, 0.12, 0.4, 0.0), 2.0 * PI * 0.12 * 0.4, 0.05),
            (band(16, 0.3, 0.4, 20.0), 2.0 * PI * 0.3 * 0.4 * 340.0 / 360.0, 0.05),
            (torus(0.7, 0.2, 24, 2), 2.0 * PI * 0.7 * PI * 0.04, 0.2),
            (groove(0.26, 24), 2.0 * PI * (0.4 * 0.75 + 0.52 * 0.3), 0.05),
            (gear(8, [0.3, 0.62, 0.92], 0.3), 0.3 * PI * (0.75 * 0.75 - 0.09), 0.15),
            (wedge(0.1, 0.5), 0.6 * (0.2 + 0.5), 1e-12),
        ];
        for (mesh, volume, tolerance) in meshes.iter().chain([&(knot, 2.0 * PI * 2.4 * PI * 0.04, 0.3)]) {
            for element in &mesh.elements {
                let one = Hexahedra { nodes: mesh.nodes.clone(), elements: vec![*element] };
                assert!(one.volume() > 0.0);
            }
            assert!((mesh.volume() / volume - 1.0).abs() < *tolerance, "{} {volume}", mesh.volume());
        }
    }

    #[test]
    fn files_name_nodes_from_one_and_two_meshes_share_none() {
        let cube = Hexahedra::grid([1, 1, 1], false, |i| i.map(|i| i as f64));
        let two = cube.clone().and(&cube);
        assert_eq!((two.nodes.len(), two.elements[1][0]), (16, 8));
        let text = cube.text();
        assert!(text.starts_with("*NODE\n1, 0.0, 0.0, 0.0\n2, 1.0, 0.0, 0.0\n"));
        assert!(text.ends_with("1, 1, 2, 4, 3, 5, 6, 8, 7\n"));
        assert_eq!(cube.volume(), 1.0);
        assert_eq!(slab_with_slivers(1e-3).matches("facet normal").count(), 60);
    }
}
