//! Solid balls and cylinders, whole or cut along planes of symmetry, refined where they touch a plane below.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;

use super::{finish, grid, validate};
use crate::error::parameter;
use crate::{Mesh, MeshError};

/// Half of the edge of the cube or square in the middle, over the radius.
const CORE: f64 = 0.45;
/// Largest ratio of neighbouring elements beyond the refined zone.
const LARGEST_RATIO: f64 = 4.0;

/// Corners of a facet of the lattice, counter-clockwise.
const RING: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// Portion of a ball or cylinder that is meshed; not a part of a scene. The cut surfaces are planes of symmetry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Portion {
    /// Everything.
    Full,
    /// `z <= 0`.
    Half,
    /// `z <= 0`, `x >= 0`.
    Quarter,
    /// `z <= 0`, `x >= 0`, `y >= 0`; of a ball only.
    Eighth,
}

/// A finer mesh around the lowest (and, of a full body, the highest) point: `elements` of equal size over the distance `half_width` from
/// it along the surface, and an element of that size in depth; beyond, sizes grow in geometric progression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refinement {
    /// Half of the width of the uniform zone, along the surface (length).
    pub half_width: f64,
    /// Number of elements over this distance.
    pub elements: usize,
}

/// A solid ball about the origin: a cube in the middle and six blocks around it, divided evenly in angle, without degenerate elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Radius (length).
    pub radius: f64,
    /// Portion that is meshed.
    pub part: Portion,
    /// Numbers of elements of an eighth: across (along x and along y, from the axis to the edge of the cube), upwards (along z, the same), and from
    /// the cube to the surface.
    pub divisions: [usize; 3],
    /// A finer mesh at the lowest point.
    pub refinement: Option<Refinement>,
}

impl Ball {
    /// The mesh with facet set `outer`; of a part also `top` (z = 0), `left` (x = 0), `front` (y = 0), as far as it is cut there. Nodes on the planes
    /// of symmetry lie there exactly. With `divisions = [n, m, r]` an eighth has `n^2 m + (n^2 + 2 n m) r` elements.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (radius, zero divisions, a refinement that does not fit), [`MeshError::TooLarge`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        let [n, m, r] = self.divisions;
        validate::divisions(&self.divisions, &[1; 3], 1)?;
        validate::divisions(&[n, n.max(m), n.max(m), r.saturating_add(1)], &[1; 4], 24)?;
        let lines = Lines::new(self.radius, [n, m, r], self.refinement)?;
        let radius = self.radius;
        let mesh = lines.mesh([n, n, m], [true, true, true], |lattice, layer| {
            let g: [f64; 3] = [lines.across[lattice[0]], lines.across[lattice[1]], lines.up[lattice[2]]];
            let scale = radius / g.iter().map(|c| c * c).sum::<f64>().sqrt();
            lines.outwards(g, g.map(|c| scale * c), radius, layer)
        });
        let axes: &[usize] = match self.part {
            Portion::Full => &[2, 0, 1],
            Portion::Half => &[0, 1],
            Portion::Quarter => &[1],
            Portion::Eighth => &[],
        };
        cut(mesh, axes, |x, facet| {
            if on(facet, |n| x[n][2] == 0.0) {
                "top"
            } else if on(facet, |n| x[n][0] == 0.0) {
                "left"
            } else if on(facet, |n| x[n][1] == 0.0) {
                "front"
            } else {
                "outer"
            }
        })
    }
}

/// A solid cylinder about the y-axis, from `y = 0`: a square in the middle and four blocks around it, divided evenly in angle, without
/// degenerate elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Radius (length).
    pub radius: f64,
    /// Length along y (length).
    pub length: f64,
    /// Portion that is meshed.
    pub part: Portion,
    /// Numbers of elements of a quarter: across (along x, from the axis to the edge of the square), upwards (along z, the same), from the square to the
    /// surface, and along y.
    pub divisions: [usize; 4],
    /// A finer mesh at the lowest line.
    pub refinement: Option<Refinement>,
}

impl Cylinder {
    /// The mesh with facet sets `outer`, `front` (y = 0), `back` (y = length); of a part also `top` (z = 0) and `left` (x = 0), as far as it is cut
    /// there. With `divisions = [n, m, r, l]` a quarter has `(n m + (n + m) r) l` elements.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (lengths, zero divisions, an eighth, a refinement that does not fit), [`MeshError::TooLarge`].
    pub fn generate(&self) -> Result<Mesh, MeshError> {
        validate::positive("length", self.length)?;
        let [n, m, r, l] = self.divisions;
        validate::divisions(&self.divisions, &[1; 4], 1)?;
        validate::divisions(&[n.max(m), n.max(m), r.saturating_add(1), l], &[1; 4], 12)?;
        let axes: &[usize] = match self.part {
            Portion::Full => &[2, 0],
            Portion::Half => &[0],
            Portion::Quarter => &[],
            Portion::Eighth => return Err(parameter("part", self.part, "must be a full, half or quarter cylinder")),
        };
        let lines = Lines::new(self.radius, [n, m, r], self.refinement)?;
        let (radius, length) = (self.radius, self.length);
        let mesh = lines.mesh([n, l, m], [true, false, true], |lattice, layer| {
            let (x, z) = (lines.across[lattice[0]], lines.up[lattice[2]]);
            let scale = radius / x.hypot(z);
            let [x, _, z] = lines.outwards([x, 0.0, z], [scale * x, 0.0, scale * z], radius, layer);
            [x, grid::between(0.0, length, lattice[1] as f64 / l as f64), z]
        });
        cut(mesh, axes, |x, facet| {
            if on(facet, |n| x[n][1] == 0.0) {
                "front"
            } else if on(facet, |n| x[n][1] == length) {
                "back"
            } else if on(facet, |n| x[n][2] == 0.0) {
                "top"
            } else if on(facet, |n| x[n][0] == 0.0) {
                "left"
            } else {
                "outer"
            }
        })
    }
}

/// Grid lines of the piece with `x, y, z >= 0`: `tan` of the angles across and upwards, 0 to 1, and fractions from the core to the surface.
struct Lines {
    across: Vec<f64>,
    up: Vec<f64>,
    layers: Vec<f64>,
}

impl Lines {
    fn new(radius: f64, divisions: [usize; 3], refinement: Option<Refinement>) -> Result<Lines, MeshError> {
        validate::positive("radius", radius)?;
        let [n, m, r] = divisions;
        let (across, layers) = match refinement {
            None => (grid::positions(n, 1.0), grid::positions(r, 1.0)),
            Some(zone) => {
                validate::positive("half_width", zone.half_width)?;
                let arc = FRAC_PI_4 * radius;
                if zone.half_width >= arc {
                    return Err(parameter(
                        "half_width",
                        zone.half_width,
                        format!("must be below {arc}, an eighth of the circle"),
                    ));
                }
                if zone.elements == 0 || zone.elements >= n {
                    let remedy = format!("must be at least 1 and below the first of the divisions, {n}");
                    return Err(parameter("elements", zone.elements, remedy));
                }
                let size = zone.half_width / zone.elements as f64;
                let across = refined(n, zone.elements, size / arc)?;
                // From the surface inwards, then turned round.
                let depth = refined(r, 1, size / ((1.0 - CORE) * radius))?;
                (across, depth.iter().rev().map(|s| 1.0 - s).collect())
            }
        };
        let tangent = |s: &f64| if *s == 1.0 { 1.0 } else { (FRAC_PI_4 * s).tan() };
        let up = grid::positions(m, 1.0);
        Ok(Lines { across: across.iter().map(tangent).collect(), up: up.iter().map(tangent).collect(), layers })
    }

    /// The point of layer `layer` between the core's surface at `radius * CORE * g` and `surface`.
    fn outwards(&self, g: [f64; 3], surface: [f64; 3], radius: f64, layer: usize) -> [f64; 3] {
        let core = g.map(|c| radius * CORE * c);
        if layer == 0 {
            // Inside of the core there is no point of the surface.
            return core;
        }
        std::array::from_fn(|i| grid::between(core[i], surface[i], self.layers[layer]))
    }

    /// The core of `divisions` cells and the layers on its outer sides along the axes that `round` names, reflected to `z <= 0`.
    fn mesh(&self, divisions: [usize; 3], round: [bool; 3], place: impl Fn([usize; 3], usize) -> [f64; 3]) -> Mesh {
        let mut mesh = Mesh::default();
        let mut numbers: HashMap<([usize; 3], usize), u32> = HashMap::new();
        let mut number = |mesh: &mut Mesh, lattice: [usize; 3], layer: usize| {
            *numbers.entry((lattice, layer)).or_insert_with(|| {
                mesh.nodes.push(place(lattice, layer));
                mesh.nodes.len() as u32 - 1
            })
        };
        let [nx, ny, nz] = divisions;
        for (k, j, i) in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i)))) {
            let nodes = std::array::from_fn(|a| {
                let [di, dj] = RING[a % 4];
                number(&mut mesh, [i + di, j + dj, k + a / 4], 0)
            });
            mesh.elements.push_hex8(nodes);
        }
        for axis in (0..3).filter(|&axis| round[axis]) {
            // u, v, axis are right-handed, and the layers go outwards along the axis.
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for layer in 0..self.layers.len() - 1 {
                for (j, i) in (0..divisions[v]).flat_map(|j| (0..divisions[u]).map(move |i| (j, i))) {
                    let nodes = std::array::from_fn(|a| {
                        let [di, dj] = RING[a % 4];
                        let mut lattice = [0; 3];
                        (lattice[axis], lattice[u], lattice[v]) = (divisions[axis], i + di, j + dj);
                        number(&mut mesh, lattice, layer + a / 4)
                    });
                    mesh.elements.push_hex8(nodes);
                }
            }
        }
        for x in &mut mesh.nodes {
            x[2] = 0.0 - x[2];
        }
        mesh.elements = mesh.elements.iter().map(|nodes| reflected(nodes, |n| n)).collect();
        mesh
    }
}

/// Positions `0 = s_0 < ... < s_n = 1`: `uniform` elements of size `size`, then a geometric progression that starts with the next of them.
fn refined(n: usize, uniform: usize, size: f64) -> Result<Vec<f64>, MeshError> {
    let rest = n.saturating_sub(uniform);
    let width = uniform as f64 * size;
    let sum = |ratio: f64| (1..=rest).map(|i| size * ratio.powi(i as i32)).sum::<f64>();
    let too_far = width >= 1.0 || sum(LARGEST_RATIO) < 1.0 - width;
    if too_far {
        let remedy = format!(
            "leave {rest} elements beyond the refined zone, too few to reach the other end: use more divisions"
        );
        return Err(parameter("divisions", n, remedy));
    }
    let (mut low, mut high) = (0.0_f64, LARGEST_RATIO);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if sum(middle) < 1.0 - width { low = middle } else { high = middle }
    }
    let ratio = 0.5 * (low + high);
    let mut s: Vec<f64> = (0..=uniform).map(|i| i as f64 * size).collect();
    for i in 1..=rest {
        s.push(s[s.len() - 1] + size * ratio.powi(i as i32));
    }
    s[n] = 1.0;
    Ok(s)
}

/// The images of the nodes of a reflected hexahedron in the order that makes it positive.
fn reflected(nodes: &[u32], image: impl Fn(u32) -> u32) -> [u32; 8] {
    [1, 0, 3, 2, 5, 4, 7, 6].map(|i| image(nodes[i]))
}

fn on(facet: &[u32], is: impl Fn(usize) -> bool) -> bool {
    facet.iter().all(|&n| is(n as usize))
}

/// The mesh with its reflections in the coordinate planes with these normals, its boundary named by `name`.
fn cut(mut mesh: Mesh, axes: &[usize], name: impl Fn(&[[f64; 3]], &[u32]) -> &'static str) -> Result<Mesh, MeshError> {
    for &axis in axes {
        let image: Vec<u32> = (0..mesh.nodes.len())
            .map(|n| {
                let mut x = mesh.nodes[n];
                if x[axis] == 0.0 {
                    return n as u32;
                }
                x[axis] = -x[axis];
                mesh.nodes.push(x);
                mesh.nodes.len() as u32 - 1
            })
            .collect();
        let images: Vec<[u32; 8]> = mesh.elements.iter().map(|e| reflected(e, |n| image[n as usize])).collect();
        images.into_iter().for_each(|nodes| mesh.elements.push_hex8(nodes));
    }
    for facet in mesh.boundary_facets() {
        let set = name(&mesh.nodes, &facet.nodes);
        mesh.facet_sets.entry(set.to_owned()).or_default().push(facet);
    }
    finish(mesh)
}
