//! What a run left of its bodies: places and velocities of nodes in every frame, elements, facets and densities, and integrals over them.

use toml::{Table, Value};

use super::cell::Cell;
use super::vector::{add, cross, dot, minus, norm, scaled};
use crate::verify::Run;
use crate::vtu;
use crate::workspace::Outcome;
use stoss_reference_element::CellKind;

/// Relative spread of the Jacobian determinant up to which a cell counts as a parallelepiped.
const STRAIGHT: f64 = 1e-9;

/// What a part is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Elements.
    Solid,
    /// A closed surface, convex.
    Rigid,
    /// An open, flat surface.
    Plane,
}

/// A part of the scene as the judge sees it: elements, facets and motion.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name of the part.
    pub name: String,
    /// What it is made of.
    pub kind: Kind,
    /// Mass per volume; of a part whose mass is given otherwise none.
    pub density: Option<f64>,
    /// Whether all of its motion is given.
    pub driven: bool,
    /// Elements of the part, as places in [`Model::cells`] with nodes. A rigid box is one hexahedron.
    pub elements: Vec<(usize, Vec<usize>)>,
    /// Facets of its surface of three or four corners, turning outwards.
    pub facets: Vec<Vec<usize>>,
    /// Nodes of the surface.
    pub surface: Vec<usize>,
    /// Whether integrals over its elements are exact.
    pub is_straight: bool,
}

/// A state.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Number of the step.
    pub step: usize,
    /// Places of all nodes.
    pub x: Vec<[f64; 3]>,
    /// Velocities, in dynamic scenes.
    pub v: Vec<[f64; 3]>,
}

/// Bodies and states of a run.
#[derive(Debug)]
pub struct Model {
    /// Kinds of cells.
    pub cells: Vec<Cell>,
    /// Bodies, then rigid bodies, as in the scene.
    pub parts: Vec<Part>,
    /// Reference places.
    pub reference: Vec<[f64; 3]>,
    /// Frames in order.
    pub frames: Vec<Frame>,
}

/// Integrals over a body.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Mass.
    pub mass: f64,
    /// Mass times place of the centre.
    pub moment: [f64; 3],
    /// Linear momentum.
    pub linear: [f64; 3],
    /// Angular momentum about the origin.
    pub angular: [f64; 3],
    /// Kinetic energy.
    pub kinetic: f64,
}

impl Model {
    /// Reads all frames of a run.
    pub fn read(scene: &Table, run: &Run) -> Outcome<Self> {
        let mut model = Self { cells: Vec::new(), parts: Vec::new(), reference: Vec::new(), frames: Vec::new() };
        for path in run.frames()? {
            let digits = path.file_stem().and_then(|stem| stem.to_str()?.strip_prefix("frame_"));
            let step = digits.ok_or("a frame without a number")?.parse()?;
            let grid = vtu::load(&path)?;
            if model.frames.is_empty() {
                model.reference.clone_from(&grid.points);
                model.take_parts(scene, &grid)?;
            }
            let rows = |name: &str| -> Option<Vec<[f64; 3]>> {
                let array = grid.point_data.get(name)?;
                Some((0..grid.points.len()).map(|k| std::array::from_fn(|i| array.row(k)[i])).collect())
            };
            let u = rows("displacement").ok_or("a frame without displacements")?;
            let x = grid.points.iter().zip(&u).map(|(x, u)| add(*x, *u)).collect();
            model.frames.push(Frame { step, x, v: rows("velocity").unwrap_or_default() });
        }
        Ok(model)
    }

    fn take_parts(&mut self, scene: &Table, grid: &vtu::Grid) -> Outcome<()> {
        let body = grid.cell_data.get("body").ok_or("a frame without the field `body`")?;
        let of = |cell: usize| body.values[cell] as usize;
        let names = parts(scene);
        for (index, (table, is_rigid)) in names.iter().enumerate() {
            let elements: Vec<(CellKind, Vec<usize>)> = grid
                .elements
                .cells()
                .enumerate()
                .filter(|(k, _)| of(*k) == index)
                .map(|(_, (kind, nodes))| (kind, nodes.iter().map(|&n| n as usize).collect()))
                .collect();
            let first = grid.elements.len();
            let given: Vec<Vec<usize>> = grid
                .facets
                .iter()
                .enumerate()
                .filter(|(k, _)| of(first + k) == index)
                .map(|(_, nodes)| nodes.iter().map(|&n| n as usize).collect())
                .collect();
            let is_plane = table.get("shape").and_then(|s| s.get("kind")).and_then(Value::as_str) == Some("plane");
            let kind = match (is_rigid, is_plane) {
                (false, _) => Kind::Solid,
                (true, true) => Kind::Plane,
                (true, false) => Kind::Rigid,
            };
            let elements = match kind {
                Kind::Solid => elements,
                _ => hexahedron(&given).map(|nodes| (CellKind::Hex8, nodes)).into_iter().collect(),
            };
            let facets = if *is_rigid { given } else { boundary(&elements) };
            let mut surface: Vec<usize> = facets.iter().flatten().copied().collect();
            surface.sort_unstable();
            surface.dedup();
            let elements: Vec<(usize, Vec<usize>)> =
                elements.into_iter().map(|(kind, nodes)| (self.cell(kind), nodes)).collect();
            let places = |nodes: &[usize]| nodes.iter().map(|&n| self.reference[n]).collect::<Vec<_>>();
            let is_straight = elements.iter().all(|(cell, nodes)| {
                let [low, high] = self.cells[*cell].determinants(&places(nodes));
                high - low <= STRAIGHT * high
            });
            let name = table.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
            let driven = table.get("fixed").and_then(Value::as_bool) == Some(true) || is_driven(scene, &name);
            let density = table.get("density").and_then(Value::as_float);
            self.parts.push(Part { name, kind, density, driven, elements, facets, surface, is_straight });
        }
        Ok(())
    }

    fn cell(&mut self, kind: CellKind) -> usize {
        if let Some(place) = self.cells.iter().position(|cell| cell.kind == kind) {
            return place;
        }
        self.cells.push(Cell::new(kind));
        self.cells.len() - 1
    }

    /// The part of this name.
    pub fn part(&self, name: &str) -> Option<&Part> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// Integrals over a part in a frame, with this density; none of a part without elements.
    pub fn motion(&self, part: &Part, density: f64, frame: &Frame) -> Option<Motion> {
        if part.elements.is_empty() {
            return None;
        }
        let mut sum = Motion::default();
        for (cell, nodes) in &part.elements {
            let pick = |all: &[[f64; 3]]| nodes.iter().map(|&n| all[n]).collect::<Vec<_>>();
            let (reference, x) = (pick(&self.reference), pick(&frame.x));
            let v = if frame.v.is_empty() { vec![[0.0; 3]; nodes.len()] } else { pick(&frame.v) };
            self.cells[*cell].integrate(&reference, |shape, volume| {
                let at = |all: &[[f64; 3]]| -> [f64; 3] {
                    std::array::from_fn(|i| shape.iter().zip(all).map(|(n, x)| n * x[i]).sum())
                };
                let (m, x, v) = (density * volume, at(&x), at(&v));
                sum.mass += m;
                sum.moment = add(sum.moment, scaled(m, x));
                sum.linear = add(sum.linear, scaled(m, v));
                sum.angular = add(sum.angular, scaled(m, cross(x, v)));
                sum.kinetic += 0.5 * m * dot(v, v);
            });
        }
        Some(sum)
    }

    /// Mean length of the edges of a facet.
    pub fn edge(facet: &[usize], x: &[[f64; 3]]) -> f64 {
        let n = facet.len();
        (0..n).map(|k| norm(minus(x[facet[k]], x[facet[(k + 1) % n]]))).sum::<f64>() / n as f64
    }
}

/// Tables of the deformable bodies and of the rigid bodies of a scene, in the order of the frames.
pub fn parts(scene: &Table) -> Vec<(&Table, bool)> {
    let list = |key: &str| scene.get(key).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_table);
    list("body").map(|table| (table, false)).chain(list("rigid").map(|table| (table, true))).collect()
}

/// Whether a `[[prescribe]]` moves the whole of a rigid body.
fn is_driven(scene: &Table, name: &str) -> bool {
    let all = scene.get("prescribe").and_then(Value::as_array).into_iter().flatten();
    all.filter_map(|table| table.get("rigid")?.as_str()).any(|rigid| rigid == name)
}

/// Facets that belong to one element only, of quadratic faces in pieces on their nodes.
fn boundary(elements: &[(CellKind, Vec<usize>)]) -> Vec<Vec<usize>> {
    let mut all: Vec<(Vec<usize>, Vec<Vec<usize>>)> = Vec::new();
    for (kind, nodes) in elements {
        for face in kind.table().faces {
            let of = |k: usize| nodes[face.nodes[k] as usize];
            let count = face.kind.corner_count();
            let mut key: Vec<usize> = (0..count).map(of).collect();
            key.sort_unstable();
            all.push((
                key,
                pieces(face.nodes.len(), count).iter().map(|p| p.iter().map(|&k| of(k)).collect()).collect(),
            ));
        }
    }
    all.sort_by(|a, b| a.0.cmp(&b.0));
    let lone = |k: usize| (k == 0 || all[k - 1].0 != all[k].0) && (k + 1 == all.len() || all[k + 1].0 != all[k].0);
    (0..all.len()).filter(|&k| lone(k)).flat_map(|k| all[k].1.clone()).collect()
}

/// A face in flat pieces: a quadratic one by its corners, the middles of its edges and its centre if it has one.
fn pieces(nodes: usize, corners: usize) -> Vec<Vec<usize>> {
    match (nodes, corners) {
        (9, 4) => vec![vec![0, 4, 8, 7], vec![4, 1, 5, 8], vec![8, 5, 2, 6], vec![7, 8, 6, 3]],
        (8, 4) => vec![vec![0, 4, 7], vec![4, 1, 5], vec![5, 2, 6], vec![6, 3, 7], vec![4, 5, 6, 7]],
        (6, 3) => vec![vec![0, 3, 5], vec![3, 1, 4], vec![4, 2, 5], vec![3, 4, 5]],
        _ => vec![(0..corners).collect()],
    }
}

/// The hexahedron of six facets with four corners on eight nodes.
fn hexahedron(facets: &[Vec<usize>]) -> Option<Vec<usize>> {
    if facets.len() != 6 || facets.iter().any(|facet| facet.len() != 4) {
        return None;
    }
    let base = &facets[0];
    // The node beyond the base is the neighbour of a corner that the base does not have.
    let opposite = |corner: usize| {
        facets.iter().find_map(|facet| {
            let k = facet.iter().position(|&n| n == corner)?;
            [facet[(k + 1) % 4], facet[(k + 3) % 4]].into_iter().find(|n| !base.contains(n))
        })
    };
    // Seen from inside the base turns counter-clockwise.
    let bottom = [base[0], base[3], base[2], base[1]];
    let top = bottom.map(opposite);
    let mut nodes = bottom.to_vec();
    for node in top {
        nodes.push(node?);
    }
    Some(nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_elements_have_ten_facets_and_a_box_is_a_hexahedron() {
        let two = [(CellKind::Hex8, (0..8).collect()), (CellKind::Hex8, vec![4, 5, 6, 7, 8, 9, 10, 11])];
        assert_eq!(boundary(&two).len(), 10);
        let one = boundary(&two[..1]);
        let nodes = hexahedron(&one).unwrap();
        let places: Vec<[f64; 3]> = nodes.iter().map(|&n| CellKind::Hex8.table().nodes[n]).collect();
        let [low, high] = Cell::new(CellKind::Hex8).determinants(&places);
        assert!((low - 1.0).abs() < 1e-12 && (high - 1.0).abs() < 1e-12, "{low} {high}");
        assert_eq!(hexahedron(&one[..5]), None);
    }

    #[test]
    fn pieces_cover_a_quadratic_face() {
        for (nodes, corners) in [(4, 4), (8, 4), (9, 4), (3, 3), (6, 3)] {
            let all: std::collections::BTreeSet<usize> = pieces(nodes, corners).concat().into_iter().collect();
            assert_eq!(all.len(), nodes);
        }
    }
}
