//! Mass: element blocks, momenta, kinetic energy (theory/elements#mass, theory/integrators#eq-balance). Not a global matrix.

use crate::{
    TangentTarget,
    element::natural_gradients,
    element_block::InvertedCell,
    kernel::{self, Gradients, NodalVectors},
    own::Own,
};
use std::collections::BTreeMap;
use std::sync::Arc;
use stoss_mesh::{CellBlock, Elements};
use stoss_reference_element::{CellKind, QuadratureRule};

/// Distribution of the mass over the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum MassKind {
    /// `M_IJ = int rho_0 N_I N_J dV`, exact for parallelepipeds, and for tetrahedra and wedges with straight edges.
    #[default]
    Consistent,
    /// A positive diagonal with the mass of each element. Of linear cells the row sums of the consistent mass, `int rho_0 N_I dV`, which keep the
    /// centre of mass too. Of quadratic cells, some of whose row sums are negative, the diagonal of the consistent mass scaled to the element's mass:
    /// `m M_II / sum_J M_JJ` (E. Hinton, T. Rock, O. C. Zienkiewicz, Earthquake Eng. Struct. Dyn. 4, 1976). Neither keeps the rotary inertia.
    Lumped,
}

/// Calls a generic function or method with the number of nodes of a kind.
macro_rules! with_nodes {
    ($kind:expr, $n:ident => $call:expr) => {
        match $kind {
            CellKind::Hex8 => with_nodes!(8, $n, $call),
            CellKind::Hex20 => with_nodes!(20, $n, $call),
            CellKind::Hex27 => with_nodes!(27, $n, $call),
            CellKind::Tet4 => with_nodes!(4, $n, $call),
            CellKind::Tet10 => with_nodes!(10, $n, $call),
            CellKind::Wedge6 => with_nodes!(6, $n, $call),
            CellKind::Wedge15 => with_nodes!(15, $n, $call),
        }
    };
    ($count:literal, $n:ident, $call:expr) => {{
        const $n: usize = $count;
        $call
    }};
}

/// The mass of the elements of a block: `[element][I][J]` or `[element][I]`.
#[derive(Clone, Debug)]
struct MassBlock {
    kind: CellKind,
    /// Number of the stencil of its first element in the body.
    first_stencil: usize,
    values: Vec<f64>,
}

/// The mass of a body: one scalar square block (or diagonal) an element, acting alike on each component. Of a body that is shared out among ranks it is that of the elements of
/// one rank: the products, diagonals, momenta, energies and totals of all ranks add up to those of the body.
#[derive(Clone, Debug)]
pub struct MassMatrix {
    elements: Arc<Elements>,
    kind: MassKind,
    /// One for each block of the elements. Those of elements with nodes that have no mass are zero.
    blocks: Vec<MassBlock>,
    /// The mass of these elements: global nodes `i <= j` and the entry.
    pairs: Vec<([u32; 2], f64)>,
    /// Stencil of the first pair among those of the body.
    first_pair: usize,
}

/// Quadrature rule of the mass of one kind: gradients in natural coordinates at its points, and the shape functions.
struct MassQuadrature<const N: usize> {
    rule: QuadratureRule,
    gradients: Vec<Gradients<N>>,
    shapes: Vec<[f64; N]>,
}

impl<const N: usize> MassQuadrature<N> {
    fn new(kind: CellKind) -> Self {
        let rule = kind.table().mass;
        let shape = |xi| {
            let shape = (kind.table().shape)(xi);
            std::array::from_fn(|node| shape[node])
        };
        Self {
            rule,
            gradients: rule.iter().map(|(xi, _)| natural_gradients(kind, *xi)).collect(),
            shapes: rule.iter().map(|(xi, _)| shape(*xi)).collect(),
        }
    }

    /// Weight times `det dX/dxi` at each point.
    fn volumes(&self, x: &NodalVectors<N>) -> impl Iterator<Item = f64> {
        let determinants = self.gradients.iter().map(|g| kernel::determinant(&kernel::deformation_gradient(x, g)));
        self.rule.iter().zip(determinants).map(|((_, weight), determinant)| weight * determinant)
    }
}

/// Reference positions of the nodes of an element; its numbers count from `offset`.
fn places<const N: usize>(nodes: &[u32; N], reference: &[[f64; 3]], offset: u32) -> NodalVectors<N> {
    std::array::from_fn(|i| std::array::from_fn(|node| reference[(nodes[node] - offset) as usize][i]))
}

/// `det dX/dxi` is positive at the points of the mass of every element.
pub(crate) fn check(cells: &CellBlock, reference: &[[f64; 3]]) -> Result<(), InvertedCell> {
    fn check<const N: usize>(cells: &CellBlock, reference: &[[f64; 3]]) -> Result<(), InvertedCell> {
        let points = MassQuadrature::<N>::new(cells.kind());
        for (element, nodes) in cells.nodes().as_chunks::<N>().0.iter().enumerate() {
            for (gauss_point, volume) in points.volumes(&places(nodes, reference, 0)).enumerate() {
                let determinant = volume / points.rule[gauss_point].1;
                if !(determinant > 0.0 && determinant.is_finite()) {
                    return Err(InvertedCell { element, gauss_point, determinant });
                }
            }
        }
        Ok(())
    }
    with_nodes!(cells.kind(), N => check::<N>(cells, reference))
}

/// Calls with the nodes of every element and `int N_I dV`.
pub(crate) fn for_each_nodal_volume(
    elements: &Elements,
    reference: &[[f64; 3]],
    offset: u32,
    mut call: impl FnMut(u32, f64),
) {
    fn of_block<const N: usize>(
        cells: &CellBlock,
        reference: &[[f64; 3]],
        offset: u32,
        call: &mut impl FnMut(u32, f64),
    ) {
        let points = MassQuadrature::<N>::new(cells.kind());
        for nodes in cells.nodes().as_chunks::<N>().0 {
            let mut volumes = [0.0; N];
            for (shape, volume) in points.shapes.iter().zip(points.volumes(&places(nodes, reference, offset))) {
                for node in 0..N {
                    volumes[node] += shape[node] * volume;
                }
            }
            nodes.iter().zip(volumes).for_each(|(&node, volume)| call(node, volume));
        }
    }
    for cells in elements.blocks() {
        with_nodes!(cells.kind(), N => of_block::<N>(cells, reference, offset, &mut call));
    }
}

/// The mass of an element, of a lumped one a diagonal.
fn element_mass<const N: usize>(
    points: &MassQuadrature<N>,
    kind: (CellKind, MassKind),
    density: f64,
    x: &NodalVectors<N>,
) -> [[f64; N]; N] {
    let mut block = [[0.0; N]; N];
    for (shape, weight) in points.shapes.iter().zip(points.volumes(x)) {
        for i in 0..N {
            for j in 0..N {
                block[i][j] += density * weight * (shape[i] * shape[j]);
            }
        }
    }
    let sum = |i: usize| block[i].iter().sum::<f64>();
    let diagonal: [f64; N] = match kind {
        (_, MassKind::Consistent) => return block,
        (cell, MassKind::Lumped) if !cell.is_quadratic() => std::array::from_fn(sum),
        (_, MassKind::Lumped) => {
            let total: f64 = (0..N).map(sum).sum();
            let trace: f64 = (0..N).map(|i| block[i][i]).sum();
            std::array::from_fn(|i| total * block[i][i] / trace)
        }
    };
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { diagonal[i] } else { 0.0 }))
}

/// Nodes without mass of their own, which move with others in the kinetic energy.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Carried {
    /// The nodes that carry each of them, and their parts; global numbers.
    pub weights: BTreeMap<u32, Vec<(u32, f64)>>,
    /// Factors of the densities of the elements; empty where all are one.
    pub densities: Vec<f64>,
}

impl Carried {
    /// Adds `factor T^T M T` of an element to the entries `i <= j`.
    fn add(&self, nodes: &[u32], mass: &[f64], factor: f64, pairs: &mut BTreeMap<[u32; 2], f64>) {
        for (a, row) in nodes.iter().zip(mass.chunks_exact(nodes.len())) {
            for (b, m) in nodes.iter().zip(row).filter(|(_, m)| **m != 0.0) {
                let own = [[(*a, 1.0)], [(*b, 1.0)]];
                for &(i, part_i) in self.weights.get(a).map_or(&own[0][..], Vec::as_slice) {
                    for &(j, part_j) in self.weights.get(b).map_or(&own[1][..], Vec::as_slice) {
                        if i <= j {
                            *pairs.entry([i, j]).or_default() += factor * part_i * m * part_j;
                        }
                    }
                }
            }
        }
    }
}

/// Calls with the nodes of each element and its mass, a square row by row.
pub(crate) fn for_each_element(
    elements: &Elements,
    (reference, offset): (&[[f64; 3]], u32),
    kind: MassKind,
    density: f64,
    mut call: impl FnMut(&[u32], &[f64]),
) {
    fn of_block<const N: usize>(
        cells: &CellBlock,
        (reference, offset): (&[[f64; 3]], u32),
        kind: MassKind,
        density: f64,
        call: &mut impl FnMut(&[u32], &[f64]),
    ) {
        let points = MassQuadrature::<N>::new(cells.kind());
        for nodes in cells.nodes().as_chunks::<N>().0 {
            let x = places(nodes, reference, offset);
            call(nodes, element_mass(&points, (cells.kind(), kind), density, &x).as_flattened());
        }
    }
    for cells in elements.blocks() {
        with_nodes!(cells.kind(), N => of_block::<N>(cells, (reference, offset), kind, density, &mut call));
    }
}

impl MassBlock {
    fn consistent<const N: usize>(&self) -> &[[[f64; N]; N]] {
        self.values.as_chunks().0.as_chunks().0
    }

    /// `out += factor M x` with a consistent mass.
    // Not inlined: the code of one kind of cells is slower amid that of the others.
    #[inline(never)]
    fn multiply_add<const N: usize>(&self, nodes: &[[u32; N]], factor: f64, x: &[f64], out: &mut [f64]) {
        for (nodes, block) in nodes.iter().zip(self.consistent::<N>()) {
            let local = nodes.map(|node| {
                let at = 3 * node as usize;
                [x[at], x[at + 1], x[at + 2]]
            });
            for node in 0..N {
                let mut sum = [0.0; 3];
                for other in 0..N {
                    for i in 0..3 {
                        sum[i] += block[node][other] * local[other][i];
                    }
                }
                let at = 3 * nodes[node] as usize;
                let out = &mut out[at..at + 3];
                for i in 0..3 {
                    out[i] += factor * sum[i];
                }
            }
        }
    }

    /// Adds `target.factor M_IJ A` of each element to the global values.
    fn add_to_tangent<const N: usize>(&self, mass: MassKind, matrix: &[[f64; 3]; 3], target: &mut TangentTarget<'_>) {
        let mut local = [[[[0.0; 3]; N]; 3]; N];
        let mut add = |element: usize, mass: &dyn Fn(usize, usize) -> Option<f64>| {
            for node in 0..N {
                for other in 0..N {
                    let Some(m) = mass(node, other) else { continue };
                    for (i, row) in matrix.iter().enumerate() {
                        for (j, a) in row.iter().enumerate() {
                            local[node][i][other][j] = target.factor * a * m;
                        }
                    }
                }
            }
            target.map.add(target.first_stencil + self.first_stencil + element, kernel::flat(&local), target.values);
        };
        match mass {
            MassKind::Consistent => {
                for (element, block) in self.consistent::<N>().iter().enumerate() {
                    add(element, &|node, other| Some(block[node][other]));
                }
            }
            MassKind::Lumped => {
                for (element, diagonal) in self.values.as_chunks::<N>().0.iter().enumerate() {
                    add(element, &|node, other| (node == other).then_some(diagonal[node]));
                }
            }
        }
    }
}

impl MassMatrix {
    pub(crate) fn new(
        own: &Own,
        (reference, offset): (&[[f64; 3]], u32),
        (density, kind): (f64, MassKind),
        first_stencils: impl Iterator<Item = usize>,
        carried: Option<(&Carried, usize)>,
    ) -> Self {
        let elements = Arc::clone(&own.elements);
        let block = |(cells, first_stencil): (&CellBlock, usize)| MassBlock {
            kind: cells.kind(),
            first_stencil,
            values: Vec::new(),
        };
        let mut blocks: Vec<MassBlock> = elements.blocks().iter().zip(first_stencils).map(block).collect();
        let mut pairs = BTreeMap::new();
        let (mut element, mut block) = (0, 0);
        for_each_element(&elements, (reference, offset), kind, density, |nodes, mass| {
            while element == elements.blocks()[block].first() as usize + elements.blocks()[block].len() {
                block += 1;
            }
            let mut factor = 1.0;
            if let Some((carried, _)) = carried {
                factor = carried.densities.get(own.number(element)).copied().unwrap_or(1.0);
                if nodes.iter().any(|node| carried.weights.contains_key(node)) {
                    carried.add(nodes, mass, factor, &mut pairs);
                    factor = 0.0;
                }
            }
            let values = &mut blocks[block].values;
            match kind {
                MassKind::Consistent => values.extend(mass.iter().map(|m| factor * m)),
                MassKind::Lumped => values.extend(mass.iter().step_by(nodes.len() + 1).map(|m| factor * m)),
            }
            element += 1;
        });
        let first_pair = carried.map_or(0, |(_, stencils)| stencils);
        Self { elements, kind, blocks, pairs: pairs.into_iter().collect(), first_pair }
    }

    /// Nodes of the stencils that the mass needs behind those of the body: pairs of nodes, or one, that carry nodes without mass.
    pub fn stencils(&self) -> impl Iterator<Item = &[u32]> {
        self.pairs.iter().map(|(nodes, _)| if nodes[0] == nodes[1] { &nodes[..1] } else { &nodes[..] })
    }

    /// Which kind it is.
    pub fn kind(&self) -> MassKind {
        self.kind
    }

    /// Calls `entry(node, other, mass)` with global nodes, elements in order.
    fn for_each(&self, mut entry: impl FnMut(usize, usize, f64)) {
        for (cells, block) in self.elements.blocks().iter().zip(&self.blocks) {
            let n = block.kind.node_count();
            match self.kind {
                MassKind::Consistent => {
                    for (nodes, block) in cells.iter().zip(block.values.chunks_exact(n * n)) {
                        for (&node, row) in nodes.iter().zip(block.chunks_exact(n)) {
                            for (&other, &m) in nodes.iter().zip(row) {
                                entry(node as usize, other as usize, m);
                            }
                        }
                    }
                }
                MassKind::Lumped => {
                    for (&node, &m) in cells.nodes().iter().zip(&block.values) {
                        entry(node as usize, node as usize, m);
                    }
                }
            }
        }
        self.for_each_pair(entry);
    }

    /// Visits the blocks of the mass: nodes, and a mass for each two of them, row-major. Elements in order (of a lumped mass node by node), then what nodes without mass hand to others.
    pub fn visit(&self, visit: &mut dyn FnMut(&[u32], &[f64])) {
        for (cells, block) in self.elements.blocks().iter().zip(&self.blocks) {
            let n = block.kind.node_count();
            match self.kind {
                MassKind::Consistent => {
                    cells.iter().zip(block.values.chunks_exact(n * n)).for_each(|(nodes, block)| visit(nodes, block));
                }
                MassKind::Lumped => {
                    let nodes = cells.nodes().iter().zip(&block.values);
                    nodes.for_each(|(&node, &m)| visit(&[node], &[m]));
                }
            }
        }
        for &([i, j], m) in &self.pairs {
            if i == j { visit(&[i], &[m]) } else { visit(&[i, j], &[0.0, m, m, 0.0]) }
        }
    }

    /// Visits the entries between nodes that carry others.
    fn for_each_pair(&self, mut entry: impl FnMut(usize, usize, f64)) {
        for &([i, j], m) in &self.pairs {
            entry(i as usize, j as usize, m);
            if i != j {
                entry(j as usize, i as usize, m);
            }
        }
    }

    /// Adds the diagonal `M_II`, positive at all nodes with mass, to each component of a vector of the model.
    pub fn add_diagonal(&self, out: &mut [f64]) {
        self.for_each(|node, other, m| {
            if node == other {
                out[3 * node..3 * node + 3].iter_mut().for_each(|sum| *sum += m);
            }
        });
    }

    /// `out += factor M x` for vectors of the model.
    pub fn multiply_add(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        let mut add = |node: usize, other: usize, m: f64| {
            for d in 0..3 {
                out[3 * node + d] += factor * m * x[3 * other + d];
            }
        };
        if self.kind == MassKind::Lumped {
            self.for_each(add);
            return;
        }
        self.for_each_pair(&mut add);
        for (cells, block) in self.elements.blocks().iter().zip(&self.blocks) {
            let nodes = cells.nodes();
            with_nodes!(block.kind, N => block.multiply_add::<N>(nodes.as_chunks().0, factor, x, out));
        }
    }

    /// Adds `factor * target.factor * M` to the global values; same stencils as the body's tangent, and behind them [`Self::stencils`].
    pub fn add_to_tangent(&self, factor: f64, target: TangentTarget<'_>) {
        self.add_blocks_to_tangent(&[[factor, 0.0, 0.0], [0.0, factor, 0.0], [0.0, 0.0, factor]], target);
    }

    /// Adds `target.factor * M_IJ A` with a matrix `A` between the components to the global values; same stencils as the body's tangent.
    fn add_blocks_to_tangent(&self, matrix: &[[f64; 3]; 3], mut target: TangentTarget<'_>) {
        for block in &self.blocks {
            with_nodes!(block.kind, N => block.add_to_tangent::<N>(self.kind, matrix, &mut target));
        }
        for (k, &([i, j], m)) in self.pairs.iter().enumerate() {
            let stencil = target.first_stencil + self.first_pair + k;
            let entry = |row: usize, column: usize| target.factor * m * matrix[row][column];
            if i == j {
                let local: [[f64; 3]; 3] = std::array::from_fn(|r| std::array::from_fn(|c| entry(r, c)));
                target.map.add(stencil, local.as_flattened(), target.values);
            } else {
                let local: [[f64; 6]; 6] = std::array::from_fn(|r| {
                    std::array::from_fn(|c| if (r < 3) == (c < 3) { 0.0 } else { entry(r % 3, c % 3) })
                });
                target.map.add(stencil, local.as_flattened(), target.values);
            }
        }
    }

    /// Global numbers of the nodes of the elements, ascending by element and with repetitions.
    pub fn nodes(&self) -> impl Iterator<Item = u32> {
        self.elements.iter().flatten().copied()
    }

    /// Total mass.
    pub fn total(&self) -> f64 {
        let mut total = 0.0;
        self.for_each(|_, _, m| total += m);
        total
    }

    /// `1/2 v . M v`.
    pub fn kinetic_energy(&self, v: &[f64]) -> f64 {
        let mut twice = 0.0;
        self.for_each(|node, other, m| {
            let (a, b) = (3 * node, 3 * other);
            twice += m * (v[a] * v[b] + v[a + 1] * v[b + 1] + v[a + 2] * v[b + 2]);
        });
        0.5 * twice
    }

    /// `L = sum M_IJ v_J`.
    pub fn linear_momentum(&self, v: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        self.for_each(|_, other, m| {
            for i in 0..3 {
                sum[i] += m * v[3 * other + i];
            }
        });
        sum
    }

    /// `J = sum M_IJ q_I x v_J`, about the origin.
    pub fn angular_momentum(&self, q: &[f64], v: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        self.for_each(|node, other, m| {
            let (q, v) = (&q[3 * node..3 * node + 3], &v[3 * other..3 * other + 3]);
            sum[0] += m * (q[1] * v[2] - q[2] * v[1]);
            sum[1] += m * (q[2] * v[0] - q[0] * v[2]);
            sum[2] += m * (q[0] * v[1] - q[1] * v[0]);
        });
        sum
    }

    /// Heap memory in bytes, without the connectivity that it shares with the body.
    pub fn memory_bytes(&self) -> usize {
        let blocks: usize = self.blocks.iter().map(|block| size_of_val(block.values.as_slice())).sum();
        blocks + size_of_val(self.pairs.as_slice())
    }
}
