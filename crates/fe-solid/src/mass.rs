//! Mass: element blocks, momenta, kinetic energy (theory/elements#mass, theory/integrators#eq-balance). Not a global matrix.

use crate::{
    TangentTarget,
    element::natural_gradients,
    element_block::BlockError,
    kernel::{self, Gradients, NodalVectors},
};
use std::sync::Arc;
use stoss_mesh::{CellBlock, Elements};
use stoss_reference_element::{CellKind, Rule};

/// How the mass is distributed.
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
    values: Vec<f64>,
}

/// The mass of a body: one scalar square block (or diagonal) an element, acting alike on each component.
#[derive(Clone, Debug)]
pub struct MassMatrix {
    elements: Arc<Elements>,
    kind: MassKind,
    /// One for each block of the elements.
    blocks: Vec<MassBlock>,
}

/// The rule of the mass of one kind: gradients in natural coordinates at its points, and the shape functions.
struct MassRule<const N: usize> {
    rule: Rule,
    gradients: Vec<Gradients<N>>,
    shapes: Vec<[f64; N]>,
}

impl<const N: usize> MassRule<N> {
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
pub(crate) fn check(cells: &CellBlock, reference: &[[f64; 3]]) -> Result<(), BlockError> {
    fn check<const N: usize>(cells: &CellBlock, reference: &[[f64; 3]]) -> Result<(), BlockError> {
        let points = MassRule::<N>::new(cells.kind());
        for (element, nodes) in cells.nodes().as_chunks::<N>().0.iter().enumerate() {
            for (gauss_point, volume) in points.volumes(&places(nodes, reference, 0)).enumerate() {
                let determinant = volume / points.rule[gauss_point].1;
                if !(determinant > 0.0 && determinant.is_finite()) {
                    return Err(BlockError::Inverted { element, gauss_point, determinant });
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
        let points = MassRule::<N>::new(cells.kind());
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

impl MassBlock {
    fn new(cells: &CellBlock, reference: &[[f64; 3]], offset: u32, density: f64, kind: MassKind) -> Self {
        fn values<const N: usize>(
            cells: &CellBlock,
            reference: &[[f64; 3]],
            offset: u32,
            density: f64,
            kind: MassKind,
        ) -> Vec<f64> {
            let points = MassRule::<N>::new(cells.kind());
            let mut out = Vec::with_capacity(cells.len() * if kind == MassKind::Consistent { N * N } else { N });
            for nodes in cells.nodes().as_chunks::<N>().0 {
                let mut block = [[0.0; N]; N];
                for (shape, weight) in points.shapes.iter().zip(points.volumes(&places(nodes, reference, offset))) {
                    for i in 0..N {
                        for j in 0..N {
                            block[i][j] += density * weight * (shape[i] * shape[j]);
                        }
                    }
                }
                let sum = |i: usize| block[i].iter().sum::<f64>();
                match kind {
                    MassKind::Consistent => out.extend_from_slice(block.as_flattened()),
                    MassKind::Lumped if !cells.kind().is_quadratic() => out.extend((0..N).map(sum)),
                    MassKind::Lumped => {
                        let total: f64 = (0..N).map(sum).sum();
                        let trace: f64 = (0..N).map(|i| block[i][i]).sum();
                        out.extend((0..N).map(|i| total * block[i][i] / trace));
                    }
                }
            }
            out
        }
        let values = with_nodes!(cells.kind(), N => values::<N>(cells, reference, offset, density, kind));
        Self { kind: cells.kind(), values }
    }

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
    fn add_to_tangent<const N: usize>(
        &self,
        mass: MassKind,
        first: usize,
        matrix: &[[f64; 3]; 3],
        target: &mut TangentTarget<'_>,
    ) {
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
            target.map.add(target.first_stencil + first + element, kernel::flat(&local), target.values);
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
        elements: Arc<Elements>,
        reference: &[[f64; 3]],
        offset: u32,
        density: f64,
        kind: MassKind,
    ) -> Self {
        let blocks =
            elements.blocks().iter().map(|cells| MassBlock::new(cells, reference, offset, density, kind)).collect();
        Self { elements, kind, blocks }
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
        match self.kind {
            MassKind::Consistent => {
                for (cells, block) in self.elements.blocks().iter().zip(&self.blocks) {
                    let nodes = cells.nodes();
                    with_nodes!(block.kind, N => block.multiply_add::<N>(nodes.as_chunks().0, factor, x, out));
                }
            }
            MassKind::Lumped => self.for_each(|node, _, m| {
                for c in 3 * node..3 * node + 3 {
                    out[c] += factor * m * x[c];
                }
            }),
        }
    }

    /// Adds `factor * target.factor * M` to the global values; same stencils as the body's tangent.
    pub fn add_to_tangent(&self, factor: f64, target: TangentTarget<'_>) {
        self.add_blocks_to_tangent(&[[factor, 0.0, 0.0], [0.0, factor, 0.0], [0.0, 0.0, factor]], target);
    }

    /// Adds `target.factor * M_IJ A` with a matrix `A` between the components to the global values; same stencils as the body's tangent.
    pub fn add_blocks_to_tangent(&self, matrix: &[[f64; 3]; 3], mut target: TangentTarget<'_>) {
        for (cells, block) in self.elements.blocks().iter().zip(&self.blocks) {
            let first = cells.first() as usize;
            with_nodes!(block.kind, N => block.add_to_tangent::<N>(self.kind, first, matrix, &mut target));
        }
    }

    /// Global numbers of the nodes that have mass, ascending by element and with repetitions.
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
        self.blocks.iter().map(|block| size_of_val(block.values.as_slice())).sum()
    }
}
