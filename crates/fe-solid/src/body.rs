//! A body of hexahedra with one law. Not its mesh (only connectivity and reference integrals are kept), not its unknowns.

use crate::{
    MassKind, MassMatrix, SolidError, SolidStep, StressRule,
    assembly::{self, ElementEvaluator, TangentTarget, Workspace},
    element::{self, ElementStep, Failure, FailureKind, GaussPointHistory},
    kernel::{self, ElementIntegration, GAUSS_POINTS, Gradients, LocalTangent, NODES, NodalVectors, TangentFactors},
};
use rayon::prelude::*;
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_mesh::Mesh;
use stoss_reference_element::{hex8, quadrature::GAUSS_HEX_2};

/// Elements that one thread takes at once in sums over the body; fixed, because it fixes the order of the sum.
const CHUNK: usize = 64;

/// Energy, force and tangent of a body of hex8 elements.
#[derive(Clone, Debug)]
pub struct SolidBody {
    name: String,
    law: Arc<dyn HyperelasticLaw>,
    node_offset: u32,
    node_count: usize,
    /// Global nodes.
    connectivity: Arc<[[u32; NODES]]>,
    integration: Vec<ElementIntegration>,
    /// `C_n`, `W_n`; empty unless the rule of the step is energy-momentum.
    history: Vec<[GaussPointHistory; GAUSS_POINTS]>,
}

impl SolidBody {
    /// A body from its mesh in reference position. `node_offset`: global number of the mesh's first node. No mass is
    /// built here.
    ///
    /// # Errors
    /// [`SolidError::Empty`], [`SolidError::NoSuchNode`], [`SolidError::InvertedReference`].
    pub fn new(name: &str, mesh: &Mesh, node_offset: u32, law: Arc<dyn HyperelasticLaw>) -> Result<Self, SolidError> {
        let body = || name.to_string();
        let nodes = &mesh.nodes;
        if mesh.elements.is_empty() {
            return Err(SolidError::Empty { body: body() });
        }
        let natural: [Gradients; GAUSS_POINTS] = std::array::from_fn(|g| {
            let gradient = hex8::shape_gradient(GAUSS_HEX_2[g].0);
            std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]))
        });
        let gauss_weights = GAUSS_HEX_2.map(|(_, weight)| weight);
        let mut integration = Vec::with_capacity(mesh.elements.len());
        for (element, element_nodes) in mesh.elements.iter().enumerate() {
            let mut x: NodalVectors = [[0.0; NODES]; 3];
            for (local, &node) in element_nodes.iter().enumerate() {
                let Some(position) = nodes.get(node as usize) else {
                    return Err(SolidError::NoSuchNode { body: body(), element, node, count: nodes.len() });
                };
                for i in 0..3 {
                    x[i][local] = position[i];
                }
            }
            integration.push(kernel::integration(&x, &natural, &gauss_weights).map_err(
                |(gauss_point, determinant)| SolidError::InvertedReference {
                    body: body(),
                    element,
                    gauss_point,
                    determinant,
                },
            )?);
        }
        Ok(Self {
            name: name.to_string(),
            law,
            node_offset,
            node_count: nodes.len(),
            connectivity: mesh.elements.iter().map(|e| e.map(|node| node + node_offset)).collect(),
            integration,
            history: Vec::new(),
        })
    }

    /// Name for reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The law of all elements.
    pub fn law(&self) -> &dyn HyperelasticLaw {
        self.law.as_ref()
    }

    /// Global node numbers of each element, in the order of `hex8::VERTICES`.
    pub fn connectivity(&self) -> &[[u32; NODES]] {
        &self.connectivity
    }

    /// Global number of the body's first node.
    pub fn node_offset(&self) -> u32 {
        self.node_offset
    }

    /// Number of nodes of the body's mesh.
    pub fn node_count(&self) -> usize {
        self.node_count
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.connectivity.len()
    }

    /// Reference volume.
    pub fn volume(&self) -> f64 {
        self.integration.iter().flat_map(|e| e.weights).sum()
    }

    /// Edge of the cube that has the mean reference volume of an element: a length.
    pub fn characteristic_length(&self) -> f64 {
        (self.volume() / self.element_count() as f64).cbrt()
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.connectivity)
            + self.integration.capacity() * size_of::<ElementIntegration>()
            + self.history.capacity() * size_of::<[GaussPointHistory; GAUSS_POINTS]>()
    }

    /// Caches what depends on `q_n` only: `C_n` and `W_n` at every Gauss point for [`StressRule::EnergyMomentum`]. For
    /// other rules it does nothing.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`] (the cache is then empty), [`SolidError::Length`].
    pub fn begin_step(&mut self, q_n: &[f64], rule: StressRule) -> Result<(), SolidError> {
        if rule != StressRule::EnergyMomentum {
            return Ok(());
        }
        self.check_length("the positions q_n", q_n)?;
        let identity =
            GaussPointHistory { right_cauchy_green: stoss_continuum::SymmetricTensor2::identity(), energy: 0.0 };
        let mut history = std::mem::take(&mut self.history);
        history.resize(self.element_count(), [identity; GAUSS_POINTS]);
        let fill = |first: usize, slots: &mut [[GaussPointHistory; GAUSS_POINTS]]| {
            for (k, slot) in slots.iter_mut().enumerate() {
                let element = first + k;
                *slot = element::history(self.law(), &self.integration[element], &self.gather(element, q_n))
                    .map_err(|failure| (element, failure))?;
            }
            Ok(())
        };
        let result = if rayon::current_num_threads() == 1 {
            fill(0, &mut history)
        } else {
            // The first failure in element order, whichever thread was first in time.
            history
                .par_chunks_mut(CHUNK)
                .enumerate()
                .map(|(chunk, slots)| fill(CHUNK * chunk, slots).err())
                .reduce(|| None, |a, b| a.or(b))
                .map_or(Ok(()), Err)
        };
        result.map_err(|(element, failure)| self.error(element, failure))?;
        self.history = history;
        Ok(())
    }

    /// Adds `force_weight * F(q_n, q_np1)` to `force` (`3 * nodes` of the model) and, if a target is given,
    /// `target.factor * dF/dq_np1` to its values (formulation §3.3, §3.4). A target is left untouched under
    /// [`StressRule::Configuration`] with `theta = 0`, whose tangent is zero.
    ///
    /// In rayon's current pool, if it has more than one thread; the bits do not depend on their number. After the first
    /// call with a workspace nothing is allocated.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`], [`SolidError::StepNotBegun`],
    /// [`SolidError::Length`]. On an error the arrays hold a partial sum.
    pub fn assemble(
        &self,
        step: SolidStep<'_>,
        force_weight: f64,
        force: &mut [f64],
        tangent: Option<TangentTarget<'_>>,
        workspace: &mut Workspace,
    ) -> Result<(), SolidError> {
        self.check_length("the force", force)?;
        if step.rule.reads_end() {
            self.check_length("the positions q_np1", step.q_np1)?;
        }
        if step.rule.reads_start() {
            self.check_length("the positions q_n", step.q_n)?;
        }
        // A force that does not depend on q_np1 has no tangent: nothing is to be computed or added.
        let tangent = tangent.filter(|_| step.rule.reads_end());
        if step.rule == StressRule::EnergyMomentum && self.history.len() != self.element_count() {
            return Err(SolidError::StepNotBegun { body: self.name.clone() });
        }
        let evaluator = BodyStep { body: self, step, factor: tangent.as_ref().map_or(1.0, |t| t.factor) };
        assembly::assemble(&self.connectivity, &evaluator, force_weight, force, tangent, workspace)
            .map_err(|(element, failure)| self.error(element, failure))
    }

    /// `int W dV` over the reference volume.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`], [`SolidError::Length`].
    pub fn strain_energy(&self, q: &[f64]) -> Result<f64, SolidError> {
        self.check_length("the positions", q)?;
        let mut total = 0.0;
        for element in 0..self.element_count() {
            total += element::energy(self.law(), &self.integration[element], &self.gather(element, q))
                .map_err(|failure| self.error(element, failure))?;
        }
        Ok(total)
    }

    /// Elements that are turned inside out at a vertex (`det dx/dxi <= 0` there), which the integrals do not notice as long as
    /// `det F > 0` at the Gauss points. `None` if there are none.
    ///
    /// # Errors
    /// [`SolidError::Length`].
    pub fn inside_out(&self, q: &[f64]) -> Result<Option<InsideOut>, SolidError> {
        self.check_length("the positions", q)?;
        let natural: [Gradients; NODES] = std::array::from_fn(|vertex| {
            let gradient = hex8::shape_gradient(hex8::VERTICES[vertex]);
            std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]))
        });
        let mut found: Option<InsideOut> = None;
        for element in 0..self.element_count() {
            let x = self.gather(element, q);
            let volume: f64 = self.integration[element].weights.iter().sum();
            let mut worst = (0, f64::INFINITY);
            for (vertex, gradients) in natural.iter().enumerate() {
                let determinant = kernel::determinant(&kernel::deformation_gradient(&x, gradients));
                if determinant < worst.1 || determinant.is_nan() {
                    worst = (vertex, determinant);
                }
            }
            // Also a NaN is no volume.
            if worst.1 > 0.0 {
                continue;
            }
            let (vertex, relative_volume) = (worst.0, 8.0 * worst.1 / volume);
            let count = found.map_or(0, |f| f.count) + 1;
            found = match found {
                Some(f) if f.relative_volume <= relative_volume => Some(InsideOut { count, ..f }),
                _ => Some(InsideOut { count, element, vertex, relative_volume }),
            };
        }
        Ok(found)
    }

    /// The mass of the body for a reference density.
    pub fn mass(&self, density: f64, kind: MassKind) -> MassMatrix {
        MassMatrix::new(self.connectivity.clone(), &self.integration, density, kind)
    }

    /// Adds the nodal forces `int N_I b_0 dV` of a constant force per *reference volume* to `out` (`3 * nodes` of the
    /// model).
    ///
    /// # Errors
    /// [`SolidError::Length`].
    pub fn body_force(&self, force_per_volume: [f64; 3], out: &mut [f64]) -> Result<(), SolidError> {
        self.check_length("the nodal forces", out)?;
        let shapes = GAUSS_HEX_2.map(|(xi, _)| hex8::shape(xi));
        for (nodes, integration) in self.connectivity.iter().zip(&self.integration) {
            for (local, &node) in nodes.iter().enumerate() {
                let volume: f64 = shapes.iter().zip(integration.weights).map(|(n, w)| n[local] * w).sum();
                for i in 0..3 {
                    out[3 * node as usize + i] += volume * force_per_volume[i];
                }
            }
        }
        Ok(())
    }

    /// Reference integrals of an element.
    pub(crate) fn integration(&self, element: usize) -> &ElementIntegration {
        &self.integration[element]
    }

    /// An element's values from a vector of the model (length checked before).
    #[inline]
    pub(crate) fn gather(&self, element: usize, x: &[f64]) -> NodalVectors {
        let mut local = [[0.0; NODES]; 3];
        for (node, &global) in self.connectivity[element].iter().enumerate() {
            let at = 3 * global as usize;
            let value = &x[at..at + 3];
            for i in 0..3 {
                local[i][node] = value[i];
            }
        }
        local
    }

    /// Every node of the body is inside a vector of the model.
    pub(crate) fn check_length(&self, what: &'static str, x: &[f64]) -> Result<(), SolidError> {
        let expected = 3 * (self.node_offset as usize + self.node_count);
        if x.len() < expected {
            return Err(SolidError::Length { name: self.name.clone(), what, found: x.len(), expected });
        }
        Ok(())
    }

    pub(crate) fn error(&self, element: usize, failure: Failure) -> SolidError {
        let (body, gauss_point) = (self.name.clone(), failure.gauss_point);
        match failure.kind {
            FailureKind::Inverted { determinant, level } => {
                SolidError::InvertedElement { body, element, gauss_point, determinant, level }
            }
            FailureKind::Constitutive(source) => SolidError::Constitutive { body, element, gauss_point, source },
        }
    }
}

/// Elements of a body that are turned inside out at a vertex, see [`SolidBody::inside_out`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InsideOut {
    /// Number of such elements.
    pub count: usize,
    /// The worst one, in the body.
    pub element: usize,
    /// Its worst vertex, in the order of `hex8::VERTICES`.
    pub vertex: usize,
    /// `8 det dx/dxi` there over the element's reference volume: 1 for an undeformed parallelepiped, not positive here.
    pub relative_volume: f64,
}

/// A body in a step, as the loop over elements sees it.
struct BodyStep<'a> {
    body: &'a SolidBody,
    step: SolidStep<'a>,
    factor: f64,
}

impl ElementEvaluator for BodyStep<'_> {
    fn evaluate(
        &self,
        element: usize,
        force: &mut NodalVectors,
        tangent: Option<(&mut LocalTangent, &mut TangentFactors)>,
    ) -> Result<(), Failure> {
        let Self { body, step, factor } = self;
        let (rule, at) = (step.rule, |q| body.gather(element, q));
        let q_np1 = at(if rule.reads_end() { step.q_np1 } else { step.q_n });
        let q_n = if rule.reads_start() && rule.reads_end() { at(step.q_n) } else { q_np1 };
        let history = body.history.get(element).filter(|_| rule == StressRule::EnergyMomentum);
        let step = ElementStep { rule, q_n: &q_n, q_np1: &q_np1, history };
        element::force_and_tangent(body.law(), body.integration(element), step, *factor, force, tangent)
    }
}
