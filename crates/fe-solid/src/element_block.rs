//! What a body asks of a block of elements of one kind. The numbers of nodes and points are constants inside of a block and unknown outside of [`ElementBlock`],
//! which is called once a block.

use crate::{
    ForceRule, SolidStep, StepEnd,
    assembly::AssemblyTarget,
    element::{Failure, FailureKind},
    kernel::Matrix3,
    laws::PointLaw,
    viscous::Viscosity,
};
use stoss_continuum::{HyperelasticLaw, SymmetricTensor2, VolumetricEnergy};
use stoss_reference_element::QuadratureRule;

/// An element of the block and what is wrong with it.
pub(crate) type ElementFailure = (usize, Failure);

/// Why a block cannot be made: `det dX/dxi` of an element at a Gauss point.
pub(crate) struct InvertedCell {
    pub element: usize,
    pub gauss_point: usize,
    pub determinant: f64,
}

/// The law of a body: `W(C)` and, in a mixed body, `U` of the averaged change of volume.
#[derive(Clone, Copy)]
pub(crate) struct Material<'a> {
    pub law: &'a dyn HyperelasticLaw,
    pub volume: Option<&'a dyn VolumetricEnergy>,
}

impl<'a> Material<'a> {
    /// Volumetric part of the law of a mixed body.
    pub fn volume(&self) -> &'a dyn VolumetricEnergy {
        match self.volume {
            Some(volume) => volume,
            None => unreachable!("a mixed body has both parts of its law"),
        }
    }
}

/// Strain and place of a Gauss point.
pub(crate) struct PointStrain<'a> {
    pub gauss_point: usize,
    pub deformation_gradient: Matrix3,
    pub right_cauchy_green: SymmetricTensor2,
    /// The law of the accepted state, and the state.
    pub law: PointLaw<'a>,
    pub state: &'a [f64],
    /// The state before the last step; the state itself if there was none.
    pub before: &'a [f64],
    pub volume: f64,
    /// Averaged pressure, positive in tension, and `U`; zero if nothing is averaged.
    pub pressure: f64,
    pub volumetric_energy: f64,
}

/// What a body asks of a block. `nodes` are the global nodes of all its elements; elements are counted in the block.
pub(crate) trait ElementBlock: std::fmt::Debug + Send + Sync {
    fn boxed(&self) -> Box<dyn ElementBlock>;
    fn rule(&self) -> QuadratureRule;
    fn memory_bytes(&self) -> usize;
    /// Adds the volumes of all Gauss points, one after the other.
    fn add_volume(&self, total: &mut f64);
    fn element_volume(&self, element: usize) -> f64;
    /// Keeps `C_n`, `w_n(C_n)` and what averages need of `q_n`, and the size of the step.
    fn begin_step(
        &mut self,
        material: Material<'_>,
        nodes: &[u32],
        q_n: &[f64],
        rule: ForceRule,
        dt: f64,
    ) -> Result<(), ElementFailure>;
    /// Forgets what [`ElementBlock::begin_step`] kept.
    fn end_step(&mut self);
    fn has_begun(&self) -> bool;
    /// Stencils of the tangent beside those of the elements.
    fn stencil_count(&self) -> usize {
        0
    }
    /// Global nodes of such a stencil.
    fn stencil(&self, _k: usize) -> &[u32] {
        &[]
    }
    fn assemble(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        step: SolidStep<'_>,
        to: AssemblyTarget<'_, '_>,
    ) -> Result<(), ElementFailure>;
    fn add_viscous_force(
        &self,
        nodes: &[u32],
        viscosity: Viscosity<'_>,
        to: AssemblyTarget<'_, '_>,
    ) -> Result<(), ElementFailure>;
    /// Adds the energies of all elements, one after the other: of the accepted states, or those of a step.
    fn add_energy(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        q: &[f64],
        rule: Option<ForceRule>,
        total: &mut f64,
    ) -> Result<(), ElementFailure>;
    /// The strains at the Gauss points of an element.
    fn visit_points(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        element: usize,
        q: &[f64],
        visit: &mut dyn FnMut(PointStrain<'_>) -> Result<(), FailureKind>,
    ) -> Result<(), Failure>;
    /// States of the Gauss points, `[element][point][number]`; empty of elastic laws.
    fn states(&self) -> &[f64];
    fn states_mut(&mut self) -> &mut [f64];
    /// Adds what the states at the end of the step store and what was lost in it, one element after the other.
    fn add_step_end(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        q_np1: &[f64],
        total: &mut StepEnd,
    ) -> Result<(), ElementFailure>;
    /// The states at the end of the step become those at the begin of the next one.
    fn commit(&mut self, material: Material<'_>, nodes: &[u32], q_np1: &[f64]) -> Result<(), ElementFailure>;
    /// Adds what hardening has stored.
    fn add_hardening_energy(&self, material: Material<'_>, total: &mut f64);
    /// The node of an element with the smallest `det dx/dxi`, and that determinant (the last one that is not a number, if there is one).
    fn worst_node(&self, nodes: &[u32], element: usize, q: &[f64]) -> (usize, f64);
}
