//! Surfaces without mass of their own: whose velocities the kinetic energy takes from the nodes inside (theory/impacts#massless).

use crate::mass::{Carried, for_each_element};
use crate::{MassKind, MassMatrix, SolidBody};
use std::collections::{BTreeMap, BTreeSet};

/// Smallest factor of a density that is accepted: below, nodes inside move with other nodes as well, on which more of the mass is then.
const LEAST_DENSITY: f64 = 0.2;

/// Distances that differ by less than this part are the same.
const SAME_DISTANCE: f64 = 1e-6;

/// Pivot beside the largest one from which on an equation is dependent on others: of the moments, of the places of nodes that are to span space.
const DEPENDENT: f64 = 1e-11;
const FLAT: f64 = 1e-8;

/// What the moments may be off, beside the mass and the size of the body.
const EXACT: f64 = 1e-13;

/// The ten moments: mass, centre, second moments `xx yy zz xy yz zx`.
type Moments = [f64; 10];

/// Nodes of a body without mass of their own. In the kinetic energy each moves as given nodes with mass do, `v_b = sum_i c_bi v_i` with `sum_i c_bi = 1`, so that the mass is
/// `M' = sum_e (1 + s_e) T^T M_e T`. Mass, centre and second moments of the body are those that it has: either by changes `s_e` of the densities of its elements, or because the
/// weights keep linear functions.
#[derive(Clone, Debug, PartialEq)]
pub struct Massless {
    /// `c`, and `1 + s` of each element.
    carried: Carried,
    /// Elements one behind the other, from the surface on.
    layers: usize,
}

/// Why nodes cannot be without mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MasslessError {
    /// The nodes inside do not span space: the body is one linear element across, or has hardly a node that is not on the surface.
    #[error(
        "the nodes behind the surface do not span space, so that they cannot have the body's mass, centre and inertia"
    )]
    Flat,
}

impl Massless {
    /// Takes the mass of these nodes (global numbers) of a body that has a mass of this kind.
    ///
    /// # Errors
    /// [`MasslessError`].
    pub fn new(body: &SolidBody, kind: MassKind, nodes: impl IntoIterator<Item = u32>) -> Result<Self, MasslessError> {
        let nodes: BTreeSet<u32> = nodes.into_iter().collect();
        let mesh = Inside::new(body, &nodes);
        let layers = mesh.layers();
        let weights: Option<BTreeMap<_, _>> = nodes.iter().map(|&node| Some((node, mesh.nearest(node)?))).collect();
        let Some(weights) = weights else { return Err(MasslessError::Flat) };
        if let Some(densities) = corrected(body, kind, &weights) {
            return Ok(Self { carried: Carried { weights, densities }, layers });
        }
        let weights: Option<BTreeMap<_, _>> = nodes.iter().map(|&node| Some((node, mesh.affine(node)?))).collect();
        let carried = |weights| Carried { weights, densities: Vec::new() };
        weights.map(|weights| Self { carried: carried(weights), layers }).ok_or(MasslessError::Flat)
    }

    /// The mass of the body with this density, of the kind that the nodes were taken with.
    pub fn mass(&self, body: &SolidBody, density: f64, kind: MassKind) -> MassMatrix {
        body.mass_with(density, kind, &self.carried)
    }

    /// The nodes, in ascending order.
    pub fn nodes(&self) -> impl Iterator<Item = u32> {
        self.carried.weights.keys().copied()
    }

    /// Whether a node has none.
    pub fn contains(&self, node: u32) -> bool {
        self.carried.weights.contains_key(&node)
    }

    /// How many elements are one behind the other, from the surface on.
    pub fn layers(&self) -> usize {
        self.layers
    }

    /// The smallest factor of the density of an element; `None` where densities are those of the body, and the weights keep linear functions.
    pub fn least_density(&self) -> Option<f64> {
        self.carried.densities.iter().copied().reduce(f64::min)
    }
}

/// Factors of the densities with which the moments are those of the body: one and the mean over the element of a quadratic function of the place. `None` if there are none that are large
/// enough.
fn corrected(body: &SolidBody, kind: MassKind, weights: &BTreeMap<u32, Vec<(u32, f64)>>) -> Option<Vec<f64>> {
    // Places in the box around the body, from -1 to 1.
    let [low, high] = [f64::min, f64::max].map(|which| {
        body.reference().0.iter().copied().reduce(|a, b| std::array::from_fn(|i| which(a[i], b[i]))).unwrap_or([0.0; 3])
    });
    let own = |node: u32| -> [f64; 3] {
        let x = body.reference_position(node);
        std::array::from_fn(|i| (2.0 * x[i] - low[i] - high[i]) / (high[i] - low[i]))
    };
    let moved = |node: u32| match weights.get(&node) {
        None => own(node),
        Some(list) => list.iter().fold([0.0; 3], |sum, &(carrier, c)| {
            let x = own(carrier);
            std::array::from_fn(|i| sum[i] + c * x[i])
        }),
    };
    let (mut target, mut functions): (Moments, Vec<Moments>) = ([0.0; 10], Vec::new());
    let mut of_elements: Vec<Moments> = Vec::new();
    for_each_element(body.elements(), body.reference(), kind, 1.0, |nodes, block| {
        let own = moments(nodes, block, own);
        target.iter_mut().zip(&own).for_each(|(sum, m)| *sum += m);
        functions.push(own.map(|m| m / own[0]));
        of_elements.push(moments(nodes, block, moved));
    });
    let mut matrix = [[0.0; 10]; 10];
    for (of, function) in of_elements.iter().zip(&functions) {
        for (row, m) in matrix.iter_mut().zip(of) {
            row.iter_mut().zip(function).for_each(|(entry, f)| *entry += m * f);
        }
    }
    let mut densities = vec![1.0; of_elements.len()];
    // The later passes take out round-off.
    for _ in 0..3 {
        let missing = missing(&target, &of_elements, &densities);
        let factors = solve(matrix, missing, DEPENDENT).0;
        for (density, function) in densities.iter_mut().zip(&functions) {
            *density += factors.iter().zip(function).map(|(f, m)| f * m).sum::<f64>();
        }
    }
    let off = missing(&target, &of_elements, &densities).iter().fold(0.0, |worst: f64, m| worst.max(m.abs()));
    let is_large = densities.iter().all(|&density| density >= LEAST_DENSITY);
    (is_large && off <= EXACT * target[0]).then_some(densities)
}

/// What the moments of elements with these densities lack.
fn missing(target: &Moments, of_elements: &[Moments], densities: &[f64]) -> Moments {
    let mut missing = *target;
    for (of, density) in of_elements.iter().zip(densities) {
        missing.iter_mut().zip(of).for_each(|(sum, m)| *sum -= density * m);
    }
    missing
}

/// The moments of an element's mass with its nodes in these places.
fn moments(nodes: &[u32], block: &[f64], place: impl Fn(u32) -> [f64; 3]) -> Moments {
    let places: Vec<[f64; 3]> = nodes.iter().map(|&node| place(node)).collect();
    let mut sum = [0.0; 10];
    for (x, row) in places.iter().zip(block.chunks_exact(nodes.len())) {
        for (y, m) in places.iter().zip(row) {
            let products = [x[0] * y[0], x[1] * y[1], x[2] * y[2], x[0] * y[1], x[1] * y[2], x[2] * y[0]];
            let all = [1.0, y[0], y[1], y[2]].into_iter().chain(products);
            sum.iter_mut().zip(all).for_each(|(sum, product)| *sum += m * product);
        }
    }
    sum
}

/// Solution of `a x = b` by elimination with full pivots, without the equations that depend on others, and the rank.
fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N], dependent: f64) -> ([f64; N], usize) {
    let (mut rows, mut columns): (Vec<usize>, Vec<usize>) = (Vec::with_capacity(N), Vec::with_capacity(N));
    let mut first = 0.0;
    for _ in 0..N {
        let rest = |taken: &[usize]| -> Vec<usize> { (0..N).filter(|i| !taken.contains(i)).collect() };
        let (rest_of_rows, rest_of_columns) = (rest(&rows), rest(&columns));
        let places = rest_of_rows.iter().flat_map(|&i| rest_of_columns.iter().map(move |&j| (i, j)));
        let larger = |best: (usize, usize), at: (usize, usize)| {
            if a[at.0][at.1].abs() > a[best.0][best.1].abs() { at } else { best }
        };
        let Some((row, column)) = places.reduce(larger) else { break };
        let pivot = a[row][column];
        first = f64::max(first, pivot.abs());
        if pivot.abs() <= dependent * first {
            break;
        }
        for &i in rest_of_rows.iter().filter(|&&i| i != row) {
            let factor = a[i][column] / pivot;
            for &j in &rest_of_columns {
                a[i][j] -= factor * a[row][j];
            }
            b[i] -= factor * b[row];
        }
        rows.push(row);
        columns.push(column);
    }
    let mut x = [0.0; N];
    for (k, (&row, &column)) in rows.iter().zip(&columns).enumerate().rev() {
        let known: f64 = columns[k + 1..].iter().map(|&j| a[row][j] * x[j]).sum();
        x[column] = (b[row] - known) / a[row][column];
    }
    (x, rows.len())
}

/// The mesh as seen from nodes without mass.
struct Inside<'a> {
    body: &'a SolidBody,
    massless: &'a BTreeSet<u32>,
    /// Elements of each node, by its number in the body.
    elements: Vec<Vec<u32>>,
    cells: Vec<&'a [u32]>,
}

impl<'a> Inside<'a> {
    fn new(body: &'a SolidBody, massless: &'a BTreeSet<u32>) -> Self {
        let cells: Vec<&[u32]> = body.elements().iter().collect();
        let mut elements = vec![Vec::new(); body.node_count()];
        for (element, nodes) in cells.iter().enumerate() {
            nodes.iter().for_each(|node| elements[(node - body.node_offset()) as usize].push(element as u32));
        }
        Self { body, massless, elements, cells }
    }

    fn of_node(&self, node: u32) -> &[u32] {
        &self.elements[(node - self.body.node_offset()) as usize]
    }

    fn distance(&self, a: u32, b: u32) -> f64 {
        let [a, b] = [a, b].map(|node| self.body.reference_position(node));
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    }

    /// Calls with the nodes that have mass in wider and wider neighbourhoods of a node, ring by ring of elements, until it gives a result.
    fn search<R>(&self, node: u32, mut find: impl FnMut(&BTreeSet<u32>) -> Option<R>) -> Option<R> {
        let (mut near, mut seen) = (BTreeSet::from([node]), BTreeSet::new());
        let mut rim = vec![node];
        let mut inner = BTreeSet::new();
        while !rim.is_empty() {
            let mut next = Vec::new();
            for element in rim.iter().flat_map(|&node| self.of_node(node)) {
                if seen.insert(*element) {
                    next.extend(self.cells[*element as usize].iter().copied().filter(|&node| near.insert(node)));
                }
            }
            inner.extend(next.iter().copied().filter(|node| !self.massless.contains(node)));
            let found = find(&inner);
            if found.is_some() {
                return found;
            }
            rim = next;
        }
        None
    }

    /// The mean of the nearest nodes that have mass.
    fn nearest(&self, node: u32) -> Option<Vec<(u32, f64)>> {
        self.search(node, |inner| {
            let least = inner.iter().map(|&other| self.distance(node, other)).reduce(f64::min)?;
            let is_near = |other: &u32| self.distance(node, *other) <= (1.0 + SAME_DISTANCE) * least;
            let near: Vec<u32> = inner.iter().copied().filter(is_near).collect();
            let part = 1.0 / near.len() as f64;
            Some(near.into_iter().map(|other| (other, part)).collect())
        })
    }

    /// Weights that keep linear functions, of least squares with weights of the distance to the power -4, of the nodes with mass in the first neighbourhood that spans space.
    fn affine(&self, node: u32) -> Option<Vec<(u32, f64)>> {
        let centre = self.body.reference_position(node);
        self.search(node, |inner| {
            let least = inner.iter().map(|&other| self.distance(node, other)).reduce(f64::min)?;
            let far = inner.iter().map(|&other| self.distance(node, other)).fold(0.0, f64::max);
            let at = |other: u32| -> [f64; 4] {
                let x = self.body.reference_position(other);
                std::array::from_fn(|i| if i == 0 { 1.0 } else { (x[i - 1] - centre[i - 1]) / far })
            };
            let weight = |other: u32| (least / self.distance(node, other)).powi(4);
            let products = |weight: &dyn Fn(u32) -> f64| {
                let mut sum = [[0.0; 4]; 4];
                for &other in inner {
                    let (x, w) = (at(other), weight(other));
                    for (row, a) in sum.iter_mut().zip(x) {
                        row.iter_mut().zip(x).for_each(|(sum, b)| *sum += w * a * b);
                    }
                }
                sum
            };
            if solve(products(&|_| 1.0), [0.0; 4], FLAT).1 < 4 {
                return None;
            }
            let matrix = products(&weight);
            let mut factors = [0.0; 4];
            // The second pass takes out round-off.
            for _ in 0..2 {
                let have: [f64; 4] = std::array::from_fn(|i| matrix[i].iter().zip(&factors).map(|(m, f)| m * f).sum());
                let rest = std::array::from_fn(|i| f64::from(u8::from(i == 0)) - have[i]);
                factors.iter_mut().zip(solve(matrix, rest, DEPENDENT).0).for_each(|(sum, more)| *sum += more);
            }
            let part = |other: u32| weight(other) * factors.iter().zip(at(other)).map(|(f, x)| f * x).sum::<f64>();
            Some(inner.iter().map(|&other| (other, part(other))).collect())
        })
    }

    /// Elements one behind the other, from the nodes without mass to those that are farthest from them.
    fn layers(&self) -> usize {
        let mut seen = vec![false; self.cells.len()];
        let mut near: BTreeSet<u32> = self.massless.clone();
        let mut rim: Vec<u32> = near.iter().copied().collect();
        let mut layers = 0;
        while !rim.is_empty() {
            let mut next = Vec::new();
            let mut found = false;
            for &element in rim.iter().flat_map(|&node| self.of_node(node)) {
                if !std::mem::replace(&mut seen[element as usize], true) {
                    found = true;
                    next.extend(self.cells[element as usize].iter().copied().filter(|&node| near.insert(node)));
                }
            }
            layers += usize::from(found);
            rim = next;
        }
        layers
    }
}
