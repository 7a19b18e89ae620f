//! Mass: element blocks, momenta, kinetic energy (formulation §3.3, §3.5). Not a global matrix.

use crate::{
    TangentTarget,
    kernel::{ElementIntegration, GAUSS_POINTS, NODES, UNKNOWNS},
};
use std::sync::Arc;
use stoss_reference_element::{hex8, quadrature::GAUSS_HEX_2};

/// How the mass is distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum MassKind {
    /// `M_IJ = int rho_0 N_I N_J dV`, exact for parallelepipeds.
    #[default]
    Consistent,
    /// Row sums of the consistent mass on the diagonal, `int rho_0 N_I dV`. Keeps total mass and centre, not the
    /// rotary inertia.
    Lumped,
}

#[derive(Clone, Debug)]
enum Blocks {
    Consistent(Vec<[[f64; NODES]; NODES]>),
    Lumped(Vec<[f64; NODES]>),
}

/// The mass of a body: one scalar 8x8 block (or diagonal) an element, acting alike on each component.
#[derive(Clone, Debug)]
pub struct MassMatrix {
    connectivity: Arc<[[u32; NODES]]>,
    blocks: Blocks,
}

impl MassMatrix {
    pub(crate) fn new(
        connectivity: Arc<[[u32; NODES]]>,
        integration: &[ElementIntegration],
        density: f64,
        kind: MassKind,
    ) -> Self {
        let shapes: [[f64; NODES]; GAUSS_POINTS] = std::array::from_fn(|g| hex8::shape(GAUSS_HEX_2[g].0));
        let consistent = integration.iter().map(|element| {
            let mut block = [[0.0; NODES]; NODES];
            for (shape, weight) in shapes.iter().zip(element.weights) {
                for i in 0..NODES {
                    for j in 0..NODES {
                        block[i][j] += density * weight * (shape[i] * shape[j]);
                    }
                }
            }
            block
        });
        let blocks = match kind {
            MassKind::Consistent => Blocks::Consistent(consistent.collect()),
            MassKind::Lumped => Blocks::Lumped(consistent.map(|block| block.map(|row| row.iter().sum())).collect()),
        };
        Self { connectivity, blocks }
    }

    /// Which kind it is.
    pub fn kind(&self) -> MassKind {
        match self.blocks {
            Blocks::Consistent(_) => MassKind::Consistent,
            Blocks::Lumped(_) => MassKind::Lumped,
        }
    }

    /// Calls `entry(node, other, mass)` with global nodes, elements in order.
    fn for_each(&self, mut entry: impl FnMut(usize, usize, f64)) {
        match &self.blocks {
            Blocks::Consistent(blocks) => {
                for (nodes, block) in self.connectivity.iter().zip(blocks) {
                    for (&node, row) in nodes.iter().zip(block) {
                        for (&other, &m) in nodes.iter().zip(row) {
                            entry(node as usize, other as usize, m);
                        }
                    }
                }
            }
            Blocks::Lumped(blocks) => {
                for (nodes, diagonal) in self.connectivity.iter().zip(blocks) {
                    for (&node, &m) in nodes.iter().zip(diagonal) {
                        entry(node as usize, node as usize, m);
                    }
                }
            }
        }
    }

    /// `out += factor M x` for vectors of the model.
    pub fn multiply_add(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        match &self.blocks {
            Blocks::Consistent(blocks) => {
                for (nodes, block) in self.connectivity.iter().zip(blocks) {
                    let local = nodes.map(|node| {
                        let at = 3 * node as usize;
                        [x[at], x[at + 1], x[at + 2]]
                    });
                    for (&node, row) in nodes.iter().zip(block) {
                        let mut sum = [0.0; 3];
                        for (m, v) in row.iter().zip(&local) {
                            for i in 0..3 {
                                sum[i] += m * v[i];
                            }
                        }
                        let at = 3 * node as usize;
                        for i in 0..3 {
                            out[at + i] += factor * sum[i];
                        }
                    }
                }
            }
            Blocks::Lumped(_) => self.for_each(|node, _, m| {
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
    pub fn add_blocks_to_tangent(&self, matrix: &[[f64; 3]; 3], target: TangentTarget<'_>) {
        let mut local = [0.0; UNKNOWNS * UNKNOWNS];
        for element in 0..self.connectivity.len() {
            let mut put = |node: usize, other: usize, m: f64| {
                for (i, row) in matrix.iter().enumerate() {
                    for (j, a) in row.iter().enumerate() {
                        local[(3 * node + i) * UNKNOWNS + 3 * other + j] = target.factor * a * m;
                    }
                }
            };
            match &self.blocks {
                Blocks::Consistent(blocks) => {
                    for (node, row) in blocks[element].iter().enumerate() {
                        for (other, &m) in row.iter().enumerate() {
                            put(node, other, m);
                        }
                    }
                }
                Blocks::Lumped(blocks) => {
                    for (node, &m) in blocks[element].iter().enumerate() {
                        put(node, node, m);
                    }
                }
            }
            target.map.add(target.first_stencil + element, &local, target.values);
        }
    }

    /// Global numbers of the nodes that have mass, ascending by element and with repetitions.
    pub fn nodes(&self) -> impl Iterator<Item = u32> {
        self.connectivity.iter().flatten().copied()
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
        match &self.blocks {
            Blocks::Consistent(blocks) => size_of_val(blocks.as_slice()),
            Blocks::Lumped(blocks) => size_of_val(blocks.as_slice()),
        }
    }
}
