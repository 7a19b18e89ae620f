//! The elements of one kind in a body: their reference integrals, and the averages that are those of an element.

use crate::{
    ForceRule, SolidOptions, SolidStep, TimeLevel, Volumetric,
    assembly::{self, AssemblyTarget, ElementEvaluator},
    element::{self, ElementStep, Failure, FailureKind, GaussPointHistory, gather, natural_gradients},
    element_block::{BlockError, ElementBlock, ElementFailure, Material, PointStrain},
    kernel::{self, ElementIntegration, Gradients, LocalTangent, NodalVectors, TangentFactors},
    mixed::{self, Averages, Basis, Mixed, Parts},
    viscous::{Viscosity, ViscousElements},
};
use rayon::prelude::*;
use stoss_continuum::SymmetricTensor2;
use stoss_mesh::CellBlock;
use stoss_reference_element::{CellKind, Rule};

/// Elements that one thread takes at once in sums over the body; fixed, because it fixes the order of the sum.
const CHUNK: usize = 64;

/// How the change of volume is averaged.
#[derive(Clone, Debug)]
enum Projection<const G: usize> {
    /// Not at all.
    None,
    /// One value an element.
    Constant,
    /// A linear function of the natural coordinates; its basis in each element.
    Linear(Vec<Basis<G, 4>>),
}

/// Elements of `N` nodes with `G` Gauss points.
#[derive(Clone, Debug)]
pub(crate) struct Block<const N: usize, const G: usize> {
    rule: Rule,
    projection: Projection<G>,
    integration: Vec<ElementIntegration<N, G>>,
    /// `C_n`, `W_n`; empty unless the rule of the step is energy-momentum.
    history: Vec<[GaussPointHistory; G]>,
    /// `J_n`, likewise; empty if nothing is averaged.
    jacobians: Vec<[f64; G]>,
    /// Gradients in natural coordinates at the nodes.
    at_nodes: Vec<Gradients<N>>,
}

impl<const N: usize, const G: usize> Block<N, G> {
    pub fn new(cells: &CellBlock, reference: &[[f64; 3]], options: SolidOptions) -> Result<Self, BlockError> {
        let kind = cells.kind();
        let rule = kind.rule(options.integration).ok_or(BlockError::NoRule)?;
        let natural: [Gradients<N>; G] = std::array::from_fn(|g| natural_gradients(kind, rule[g].0));
        let weights: [f64; G] = std::array::from_fn(|g| rule[g].1);
        let elements = cells.nodes().as_chunks::<N>().0.iter().enumerate().map(|(element, nodes)| {
            let x = std::array::from_fn(|i| std::array::from_fn(|node| reference[nodes[node] as usize][i]));
            kernel::integration(&x, &natural, &weights).map_err(|(gauss_point, determinant)| BlockError::Inverted {
                element,
                gauss_point,
                determinant,
            })
        });
        let integration: Vec<ElementIntegration<N, G>> = elements.collect::<Result<_, _>>()?;
        let projection = match (options.volumetric, kind) {
            // The averages of tet4 are those of nodes.
            (Volumetric::Displacement, _) | (Volumetric::Mixed, CellKind::Tet4) => Projection::None,
            (Volumetric::Mixed, CellKind::Hex27) => {
                let points = std::array::from_fn(|g| rule[g].0);
                Projection::Linear(integration.iter().map(|e| mixed::linear(&e.weights, &points)).collect())
            }
            (Volumetric::Mixed, _) => Projection::Constant,
        };
        Ok(Self {
            rule,
            projection,
            integration,
            history: Vec::new(),
            jacobians: Vec::new(),
            at_nodes: kind.table().nodes.iter().map(|&xi| natural_gradients(kind, xi)).collect(),
        })
    }

    /// An element's averages, if it has any.
    #[inline]
    fn averages<'a>(&'a self, material: Material<'a>, element: usize) -> Option<Averages<'a, N, G>> {
        let parts = |volume| Parts { rest: material.law, volume };
        let integration = &self.integration[element];
        Some(match &self.projection {
            Projection::None => return None,
            Projection::Constant => Averages::Constant(Mixed {
                parts: parts(material.volume?),
                integration,
                basis: mixed::constant(&integration.weights),
            }),
            Projection::Linear(bases) => {
                Averages::Linear(Mixed { parts: parts(material.volume?), integration, basis: bases[element] })
            }
        })
    }

    /// What [`ElementBlock::begin_step`] kept of an element.
    #[inline]
    pub(crate) fn history(&self, element: usize) -> &[GaussPointHistory; G] {
        &self.history[element]
    }

    /// Reference integrals of an element.
    #[inline]
    pub(crate) fn integration(&self, element: usize) -> &ElementIntegration<N, G> {
        &self.integration[element]
    }
}

/// The nodes of each element.
fn elements<const N: usize>(nodes: &[u32]) -> &[[u32; N]] {
    nodes.as_chunks().0
}

impl<const N: usize, const G: usize> ElementBlock for Block<N, G> {
    fn boxed(&self) -> Box<dyn ElementBlock> {
        Box::new(self.clone())
    }

    fn rule(&self) -> Rule {
        self.rule
    }

    fn memory_bytes(&self) -> usize {
        self.integration.capacity() * size_of::<ElementIntegration<N, G>>()
            + self.history.capacity() * size_of::<[GaussPointHistory; G]>()
            + self.jacobians.capacity() * size_of::<[f64; G]>()
            + match &self.projection {
                Projection::None | Projection::Constant => 0,
                Projection::Linear(bases) => bases.capacity() * size_of::<Basis<G, 4>>(),
            }
            + self.at_nodes.capacity() * size_of::<Gradients<N>>()
    }

    fn add_volume(&self, total: &mut f64) {
        for weight in self.integration.iter().flat_map(|element| element.weights) {
            *total += weight;
        }
    }

    fn element_volume(&self, element: usize) -> f64 {
        self.integration[element].weights.iter().sum()
    }

    fn begin_step(&mut self, material: Material<'_>, nodes: &[u32], q_n: &[f64]) -> Result<(), ElementFailure> {
        let nodes = elements::<N>(nodes);
        let identity = GaussPointHistory { right_cauchy_green: SymmetricTensor2::IDENTITY, energy: 0.0 };
        let (mut history, mut jacobians) = (std::mem::take(&mut self.history), std::mem::take(&mut self.jacobians));
        history.resize(nodes.len(), [identity; G]);
        let averaged = !matches!(self.projection, Projection::None);
        jacobians.resize(if averaged { nodes.len() } else { 0 }, [0.0; G]);
        let one = |element: usize, slot: &mut [GaussPointHistory; G], jacobians: Option<&mut [f64; G]>| {
            let q = gather(&nodes[element], q_n);
            let found = match (self.averages(material, element), jacobians) {
                (Some(averages), Some(jacobians)) => averages.history(&q).map(|found| (*slot, *jacobians) = found),
                _ => element::history(material.law, &self.integration[element], &q).map(|found| *slot = found),
            };
            found.map_err(|failure| (element, failure))
        };
        // Chunks of the same elements in both; those of the second are empty if nothing is averaged.
        let fill = |first: usize, slots: &mut [[GaussPointHistory; G]], jacobians: &mut [[f64; G]]| {
            let mut jacobians = jacobians.iter_mut();
            slots.iter_mut().enumerate().try_for_each(|(k, slot)| one(first + k, slot, jacobians.next()))
        };
        let result = if rayon::current_num_threads() == 1 {
            fill(0, &mut history, &mut jacobians)
        } else {
            // The first failure in element order, whichever thread was first in time.
            if averaged {
                history
                    .par_chunks_mut(CHUNK)
                    .zip(jacobians.par_chunks_mut(CHUNK))
                    .enumerate()
                    .map(|(chunk, (slots, jacobians))| fill(CHUNK * chunk, slots, jacobians).err())
                    .reduce(|| None, |a, b| a.or(b))
            } else {
                history
                    .par_chunks_mut(CHUNK)
                    .enumerate()
                    .map(|(chunk, slots)| fill(CHUNK * chunk, slots, &mut []).err())
                    .reduce(|| None, |a, b| a.or(b))
            }
            .map_or(Ok(()), Err)
        };
        result?;
        (self.history, self.jacobians) = (history, jacobians);
        Ok(())
    }

    fn end_step(&mut self) {
        self.history.clear();
        self.jacobians.clear();
    }

    fn has_begun(&self) -> bool {
        self.history.len() == self.integration.len()
    }

    fn assemble(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        step: SolidStep<'_>,
        to: AssemblyTarget<'_, '_>,
    ) -> Result<(), ElementFailure> {
        let nodes = elements(nodes);
        let factor = to.tangent.unwrap_or(1.0);
        let before = to.before;
        assembly::assemble(nodes, &BlockStep { block: self, material, nodes, step, before, factor }, to)
    }

    fn add_viscous_force(
        &self,
        nodes: &[u32],
        viscosity: Viscosity<'_>,
        to: AssemblyTarget<'_, '_>,
    ) -> Result<(), ElementFailure> {
        let nodes = elements(nodes);
        assembly::assemble(nodes, &ViscousElements { integration: &self.integration, nodes, viscosity }, to)
    }

    fn add_energy(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        q: &[f64],
        total: &mut f64,
    ) -> Result<(), ElementFailure> {
        for (element, nodes) in elements::<N>(nodes).iter().enumerate() {
            let q = gather(nodes, q);
            let energy = match self.averages(material, element) {
                None => element::energy(material.law, &self.integration[element], &q),
                Some(averages) => averages.energy(&q),
            };
            *total += energy.map_err(|failure| (element, failure))?;
        }
        Ok(())
    }

    fn visit_points(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        element: usize,
        q: &[f64],
        visit: &mut dyn FnMut(PointStrain) -> Result<(), FailureKind>,
    ) -> Result<(), Failure> {
        let q = gather(&elements::<N>(nodes)[element], q);
        let integration = &self.integration[element];
        let averaged = match self.averages(material, element) {
            None => None,
            Some(averages) => Some(averages.pressure_and_energy(&averages.state(&q, TimeLevel::End)?)),
        };
        for gauss_point in 0..G {
            let (deformation_gradient, right_cauchy_green) =
                element::strain(&q, integration, gauss_point, TimeLevel::End)?;
            let point = PointStrain {
                gauss_point,
                deformation_gradient,
                right_cauchy_green,
                volume: integration.weights[gauss_point],
                pressure: averaged.map_or(0.0, |(pressure, _)| pressure[gauss_point]),
                volumetric_energy: averaged.map_or(0.0, |(_, energy)| energy[gauss_point]),
            };
            visit(point).map_err(|kind| Failure { gauss_point, kind })?;
        }
        Ok(())
    }

    fn worst_node(&self, nodes: &[u32], element: usize, q: &[f64]) -> (usize, f64) {
        let x = gather(&elements::<N>(nodes)[element], q);
        let mut worst = (0, f64::INFINITY);
        for (node, gradients) in self.at_nodes.iter().enumerate() {
            let determinant = kernel::determinant(&kernel::deformation_gradient(&x, gradients));
            if determinant < worst.1 || determinant.is_nan() {
                worst = (node, determinant);
            }
        }
        worst
    }
}

/// A block in a step, as the loop over elements sees it.
struct BlockStep<'a, const N: usize, const G: usize> {
    block: &'a Block<N, G>,
    material: Material<'a>,
    nodes: &'a [[u32; N]],
    step: SolidStep<'a>,
    /// The iterate before.
    before: Option<&'a [f64]>,
    factor: f64,
}

impl<const N: usize, const G: usize> ElementEvaluator<N, G> for BlockStep<'_, N, G> {
    fn evaluate(
        &self,
        element: usize,
        force: &mut NodalVectors<N>,
        tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    ) -> Result<(), Failure> {
        let Self { block, material, nodes, step, before, factor } = self;
        let (rule, at) = (step.rule, |q| gather(&nodes[element], q));
        let q_np1 = at(if rule.reads_end() { step.q_np1 } else { step.q_n });
        let q_n = if rule.reads_start() && rule.reads_end() { at(step.q_n) } else { q_np1 };
        let history = block.history.get(element).filter(|_| rule == ForceRule::DiscreteGradient);
        let step = ElementStep { rule, q_n: &q_n, q_np1: &q_np1, history };
        match block.averages(*material, element) {
            None => element::force_and_tangent(material.law, block.integration(element), step, *factor, force, tangent),
            Some(averages) => {
                let before = before.map(|before| gather(&nodes[element], before));
                averages.force_and_tangent(step, block.jacobians.get(element), before.as_ref(), *factor, force, tangent)
            }
        }
    }
}
