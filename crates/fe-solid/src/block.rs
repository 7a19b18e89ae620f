//! The elements of one kind in a body: their reference integrals, and the averages that are those of an element.

use crate::{
    ForceRule, SolidOptions, SolidStep, StepEnd, TimeLevel, Volumetric,
    assembly::{self, AssemblyTarget, ElementEvaluator},
    element::{self, ElementHistory, ElementStep, Failure, FailureKind, Geometry, gather, natural_gradients},
    element_block::{ElementBlock, ElementFailure, InvertedCell, Material, PointStrain},
    kernel::{self, ElementIntegration, Gradients, LocalTangent, NodalVectors, PointBuffers, TangentFactors},
    laws::Laws,
    mixed::{self, Averages, Basis, Mixed, MixedEnergy},
    reference::{ElementReference, Natural},
    viscous::{Viscosity, ViscousElements},
};
use rayon::prelude::*;
use stoss_continuum::{HyperelasticLaw, Loss, PointStep, StepStress};
use stoss_mesh::CellBlock;
use stoss_reference_element::{CellKind, QuadratureRule};

/// Elements that one thread takes at once in sums over the body; fixed, because it fixes the order of the sum.
const CHUNK: usize = 64;

/// How the change of volume is averaged.
#[derive(Clone, Debug)]
enum Projection<const G: usize> {
    /// No average.
    None,
    /// One value an element.
    Constant,
    /// A linear function of the natural coordinates; its basis in each element.
    Linear(Vec<Basis<G, 4>>),
}

/// Elements of `N` nodes with `G` Gauss points.
#[derive(Clone, Debug)]
pub(crate) struct Block<const N: usize, const G: usize> {
    rule: QuadratureRule,
    projection: Projection<G>,
    natural: Natural<N, G>,
    references: Vec<ElementReference<G>>,
    /// `C_n`, `W_n`; empty unless the rule of the step is energy-momentum.
    history: Vec<ElementHistory<G>>,
    /// `J_n`, likewise; empty if nothing is averaged.
    jacobians: Vec<[f64; G]>,
    /// Gradients in natural coordinates at the nodes.
    at_nodes: Vec<Gradients<N>>,
    /// States at the begin of the step and at its end; empty of elastic laws.
    states: Vec<f64>,
    next: Vec<f64>,
    /// Size and rule of the step that has begun; of use to laws with a state.
    dt: f64,
    stress: StepStress,
}

impl<const N: usize, const G: usize> Block<N, G> {
    /// The block of these cells, with the states of virgin points if `law` has states.
    pub fn new(
        cells: &CellBlock,
        reference: &[[f64; 3]],
        options: SolidOptions,
        law: &dyn HyperelasticLaw,
    ) -> Result<Self, InvertedCell> {
        let kind = cells.kind();
        let rule = options.rule(kind);
        let natural: [Gradients<N>; G] = std::array::from_fn(|g| natural_gradients(kind, rule[g].0));
        let weights: [f64; G] = std::array::from_fn(|g| rule[g].1);
        let elements = cells.nodes().as_chunks::<N>().0.iter().enumerate().map(|(element, nodes)| {
            let x = std::array::from_fn(|i| std::array::from_fn(|node| reference[nodes[node] as usize][i]));
            ElementReference::new(&x, &natural, &weights).map_err(|(gauss_point, determinant)| InvertedCell {
                element,
                gauss_point,
                determinant,
            })
        });
        let references: Vec<ElementReference<G>> = elements.collect::<Result<_, _>>()?;
        let projection = match (options.volumetric, kind) {
            // The averages of tet4 are those of nodes.
            (Volumetric::Displacement, _) | (Volumetric::Mixed, CellKind::Tet4) => Projection::None,
            (Volumetric::Mixed, CellKind::Hex27) => {
                let points = std::array::from_fn(|g| rule[g].0);
                Projection::Linear(references.iter().map(|e| mixed::linear(&e.weights, &points)).collect())
            }
            (Volumetric::Mixed, _) => Projection::Constant,
        };
        let mut states = Vec::new();
        if let Some(material) = law.history() {
            let len = material.state_len();
            states.resize(len * G * references.len(), 0.0);
            states.chunks_exact_mut(len.max(1)).for_each(|state| material.virgin(state));
        }
        Ok(Self {
            rule,
            projection,
            natural: Natural::new(natural),
            references,
            history: Vec::new(),
            jacobians: Vec::new(),
            at_nodes: kind.table().nodes.iter().map(|&xi| natural_gradients(kind, xi)).collect(),
            states,
            next: Vec::new(),
            dt: 0.0,
            stress: StepStress::Frozen,
        })
    }

    /// What the points of an element are in a step by `rule`, or as they are.
    #[inline]
    pub(crate) fn laws<'a>(&'a self, material: Material<'a>, element: usize, rule: Option<ForceRule>) -> Laws<'a> {
        match material.law.history() {
            None => Laws::elastic(material.law),
            Some(history) => {
                let len = G * history.state_len();
                Laws::of_step(history, &self.states[element * len..(element + 1) * len], self.dt, rule)
            }
        }
    }

    /// An element's averages, if it has any.
    #[inline]
    fn averages<'a>(
        &'a self,
        material: Material<'a>,
        element: usize,
        laws: Laws<'a>,
        integration: &'a ElementIntegration<N, G>,
    ) -> Option<Averages<'a, N, G>> {
        let geometry = self.geometry(element);
        let parts = |volume| MixedEnergy { rest: laws, volume };
        Some(match &self.projection {
            Projection::None => return None,
            Projection::Constant => Averages::Constant(Mixed {
                parts: parts(material.volume?),
                geometry,
                integration,
                basis: mixed::constant(&integration.weights),
            }),
            Projection::Linear(bases) => {
                let parts = parts(material.volume?);
                Averages::Linear(Mixed { parts, geometry, integration, basis: bases[element] })
            }
        })
    }

    /// Energy of an element whose points are these.
    fn energy<'a>(
        &'a self,
        material: Material<'a>,
        element: usize,
        laws: Laws<'a>,
        q: &NodalVectors<N>,
    ) -> Result<f64, Failure> {
        if !self.is_averaged() {
            return element::energy(laws, self.geometry(element), q);
        }
        match self.averages(material, element, laws, &self.integration(element)) {
            None => element::energy(laws, self.geometry(element), q),
            Some(averages) => averages.energy(q),
        }
    }

    /// Writes the states of an element's points at the end of the step, and says what was lost.
    fn next_states(
        &self,
        history: &dyn stoss_continuum::Material,
        element: usize,
        q_np1: &NodalVectors<N>,
        next: &mut [f64],
    ) -> Result<Loss, Failure> {
        let (len, mut loss) = (history.state_len(), Loss::default());
        for g in 0..G {
            let first = (element * G + g) * len;
            let (_, c_np1) = self.geometry(element).strain(q_np1, g, TimeLevel::End)?;
            let at = PointStep { state: &self.states[first..first + len], dt: self.dt, stress: self.stress };
            let c_n = &self.history[element].right_cauchy_green(g);
            let of_point = history
                .commit(&at, c_n, &c_np1, &mut next[g * len..(g + 1) * len])
                .map_err(|error| FailureKind::from(error).at(g))?;
            loss.add(self.references[element].weights[g], &of_point);
        }
        Ok(loss)
    }

    /// What a step did to an element; `next` is room for the states of its points.
    fn element_end(
        &self,
        material: Material<'_>,
        history: &dyn stoss_continuum::Material,
        element: usize,
        q_np1: &NodalVectors<N>,
        next: &mut [f64],
    ) -> Result<StepEnd, Failure> {
        let loss = self.next_states(history, element, q_np1, next)?;
        let stored = self.energy(material, element, Laws::of_step(history, next, 0.0, None), q_np1)?;
        let weights = self.references[element].weights.iter();
        let states = next.chunks_exact(history.state_len().max(1));
        let hardening = states.zip(weights).map(|(state, weight)| weight * history.hardening_energy(state)).sum();
        let len = history.state_len();
        let before = &self.states[element * G * len..(element + 1) * G * len];
        let points = before.chunks_exact(len.max(1)).zip(next.chunks_exact(len.max(1)));
        let flow = points.map(|(before, next)| history.flow(before, next)).fold(0.0, f64::max);
        Ok(StepEnd { stored, hardening, loss, flow })
    }

    /// State of a point before the last step, which is `state` if there was none.
    fn state_before<'a>(&'a self, element: usize, gauss_point: usize, state: &'a [f64]) -> &'a [f64] {
        let first = (element * G + gauss_point) * state.len();
        self.next.get(first..first + state.len()).unwrap_or(state)
    }

    /// What [`ElementBlock::begin_step`] kept of an element.
    #[inline]
    pub(crate) fn history(&self, element: usize) -> &ElementHistory<G> {
        &self.history[element]
    }

    /// Reference integrals of an element.
    #[inline]
    pub(crate) fn integration(&self, element: usize) -> ElementIntegration<N, G> {
        self.references[element].integration(&self.natural.gradients)
    }

    /// The volumes of an element's Gauss points.
    #[inline]
    pub(crate) fn weights(&self, element: usize) -> &[f64; G] {
        &self.references[element].weights
    }

    #[inline]
    fn geometry(&self, element: usize) -> Geometry<'_, N, G> {
        Geometry { reference: &self.references[element], natural: &self.natural }
    }

    fn is_averaged(&self) -> bool {
        !matches!(self.projection, Projection::None)
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

    fn rule(&self) -> QuadratureRule {
        self.rule
    }

    fn memory_bytes(&self) -> usize {
        self.references.capacity() * size_of::<ElementReference<G>>()
            + self.history.capacity() * size_of::<ElementHistory<G>>()
            + self.jacobians.capacity() * size_of::<[f64; G]>()
            + match &self.projection {
                Projection::None | Projection::Constant => 0,
                Projection::Linear(bases) => bases.capacity() * size_of::<Basis<G, 4>>(),
            }
            + self.at_nodes.capacity() * size_of::<Gradients<N>>()
            + (self.states.capacity() + self.next.capacity()) * size_of::<f64>()
    }

    fn add_volume(&self, total: &mut f64) {
        for weight in self.references.iter().flat_map(|element| element.weights) {
            *total += weight;
        }
    }

    fn element_volume(&self, element: usize) -> f64 {
        self.references[element].weights.iter().sum()
    }

    fn begin_step(
        &mut self,
        material: Material<'_>,
        nodes: &[u32],
        q_n: &[f64],
        rule: ForceRule,
        dt: f64,
    ) -> Result<(), ElementFailure> {
        let nodes = elements::<N>(nodes);
        self.dt = dt;
        self.stress = match rule {
            ForceRule::DiscreteGradient => StepStress::DiscreteGradient,
            ForceRule::Configuration { .. } => StepStress::End,
        };
        let (mut history, mut jacobians) = (std::mem::take(&mut self.history), std::mem::take(&mut self.jacobians));
        history.resize(nodes.len(), ElementHistory::EMPTY);
        let averaged = self.is_averaged();
        jacobians.resize(if averaged { nodes.len() } else { 0 }, [0.0; G]);
        let one = |element: usize, slot: &mut ElementHistory<G>, jacobians: Option<&mut [f64; G]>| {
            let q = gather(&nodes[element], q_n);
            let laws = self.laws(material, element, Some(rule));
            let found = match jacobians {
                None => element::history(laws, self.geometry(element), &q).map(|found| *slot = found),
                Some(jacobians) => match self.averages(material, element, laws, &self.integration(element)) {
                    None => Ok(()),
                    Some(averages) => averages.history(&q).map(|found| (*slot, *jacobians) = found),
                },
            };
            found.map_err(|failure| (element, failure))
        };
        // Chunks of the same elements in both; those of the second are empty if nothing is averaged.
        let fill = |first: usize, slots: &mut [ElementHistory<G>], jacobians: &mut [[f64; G]]| {
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
        self.history.len() == self.references.len()
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
        assembly::assemble(
            nodes,
            &ViscousElements { references: &self.references, natural: &self.natural, nodes, viscosity },
            to,
        )
    }

    fn add_energy(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        q: &[f64],
        rule: Option<ForceRule>,
        total: &mut f64,
    ) -> Result<(), ElementFailure> {
        let nodes = elements::<N>(nodes);
        let of_element = |element: usize| {
            let laws = self.laws(material, element, rule);
            self.energy(material, element, laws, &gather(&nodes[element], q)).map_err(|failure| (element, failure))
        };
        let add = |energy| -> Result<(), ElementFailure> {
            *total += energy?;
            Ok(())
        };
        if rayon::current_num_threads() == 1 {
            (0..nodes.len()).map(of_element).try_for_each(add)
        } else {
            let all: Vec<_> = (0..nodes.len()).into_par_iter().with_min_len(CHUNK).map(of_element).collect();
            all.into_iter().try_for_each(add)
        }
    }

    fn visit_points(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        element: usize,
        q: &[f64],
        visit: &mut dyn FnMut(PointStrain<'_>) -> Result<(), FailureKind>,
    ) -> Result<(), Failure> {
        let q = gather(&elements::<N>(nodes)[element], q);
        let integration = &self.integration(element);
        let laws = self.laws(material, element, None);
        let averaged = match self.averages(material, element, laws, integration) {
            None => None,
            Some(averages) => Some(averages.pressure_and_energy(&averages.state(&q, TimeLevel::End)?)),
        };
        for gauss_point in 0..G {
            let (deformation_gradient, right_cauchy_green) =
                self.geometry(element).strain(&q, gauss_point, TimeLevel::End)?;
            let point = PointStrain {
                gauss_point,
                deformation_gradient,
                right_cauchy_green,
                law: laws.at(gauss_point),
                state: laws.state(gauss_point),
                before: self.state_before(element, gauss_point, laws.state(gauss_point)),
                volume: integration.weights[gauss_point],
                pressure: averaged.map_or(0.0, |(pressure, _)| pressure[gauss_point]),
                volumetric_energy: averaged.map_or(0.0, |(_, energy)| energy[gauss_point]),
            };
            visit(point).map_err(|kind| Failure { gauss_point, kind })?;
        }
        Ok(())
    }

    fn states(&self) -> &[f64] {
        &self.states
    }

    fn states_mut(&mut self) -> &mut [f64] {
        // They are of no step.
        self.next.clear();
        &mut self.states
    }

    fn add_step_end(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        q_np1: &[f64],
        total: &mut StepEnd,
    ) -> Result<(), ElementFailure> {
        let Some(history) = material.law.history() else { return Ok(()) };
        let nodes = elements::<N>(nodes);
        let of_chunk = |chunk: usize| {
            let mut next = vec![0.0; G * history.state_len()];
            let elements = CHUNK * chunk..(CHUNK * (chunk + 1)).min(nodes.len());
            let ends = elements.map(|element| {
                let q = gather(&nodes[element], q_np1);
                self.element_end(material, history, element, &q, &mut next).map_err(|failure| (element, failure))
            });
            ends.collect::<Result<Vec<StepEnd>, _>>()
        };
        let chunks = nodes.len().div_ceil(CHUNK);
        // The first failure in element order, whichever thread was first in time.
        let ends: Vec<_> = if rayon::current_num_threads() == 1 {
            (0..chunks).map(of_chunk).collect()
        } else {
            (0..chunks).into_par_iter().map(of_chunk).collect()
        };
        for chunk in ends {
            chunk?.iter().for_each(|end| total.add(end));
        }
        Ok(())
    }

    fn commit(&mut self, material: Material<'_>, nodes: &[u32], q_np1: &[f64]) -> Result<(), ElementFailure> {
        let Some(history) = material.law.history() else { return Ok(()) };
        let nodes = elements::<N>(nodes);
        let mut next = std::mem::take(&mut self.next);
        next.resize(self.states.len(), 0.0);
        let of_element = (G * history.state_len()).max(1);
        let fill = |(chunk, next): (usize, &mut [f64])| -> Option<ElementFailure> {
            for (k, next) in next.chunks_exact_mut(of_element).enumerate() {
                let element = CHUNK * chunk + k;
                if let Err(failure) = self.next_states(history, element, &gather(&nodes[element], q_np1), next) {
                    return Some((element, failure));
                }
            }
            None
        };
        let failure = if rayon::current_num_threads() == 1 {
            next.chunks_mut(CHUNK * of_element).enumerate().find_map(fill)
        } else {
            next.par_chunks_mut(CHUNK * of_element).enumerate().map(fill).reduce(|| None, |a, b| a.or(b))
        };
        self.next = next;
        match failure {
            None => std::mem::swap(&mut self.states, &mut self.next),
            Some(failure) => return Err(failure),
        }
        Ok(())
    }

    fn add_hardening_energy(&self, material: Material<'_>, total: &mut f64) {
        let Some(history) = material.law.history() else { return };
        let weights = self.references.iter().flat_map(|element| element.weights);
        for (state, weight) in self.states.chunks_exact(history.state_len().max(1)).zip(weights) {
            *total += weight * history.hardening_energy(state);
        }
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
        buffers: &mut PointBuffers,
    ) -> Result<(), Failure> {
        let Self { block, material, nodes, step, before, factor } = self;
        let (rule, at) = (step.rule, |q| gather(&nodes[element], q));
        let q_np1 = at(if rule.reads_end() { step.q_np1 } else { step.q_n });
        let q_n = if rule.reads_start() && rule.reads_end() { at(step.q_n) } else { q_np1 };
        let history = block.history.get(element).filter(|_| rule == ForceRule::DiscreteGradient);
        let step = ElementStep { rule, q_n: &q_n, q_np1: &q_np1, history };
        let laws = block.laws(*material, element, Some(rule));
        if !block.is_averaged() {
            return element::force_and_tangent(laws, block.geometry(element), step, *factor, force, tangent, buffers);
        }
        match block.averages(*material, element, laws, &block.integration(element)) {
            None => element::force_and_tangent(laws, block.geometry(element), step, *factor, force, tangent, buffers),
            Some(averages) => {
                let before = before.map(|before| gather(&nodes[element], before));
                averages.force_and_tangent(step, block.jacobians.get(element), before.as_ref(), *factor, force, tangent)
            }
        }
    }
}
