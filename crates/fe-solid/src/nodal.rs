//! Linear tetrahedra whose change of volume is averaged at the nodes (theory/elements#eq-nodal-average, Bonet and Burton). Not other cells: those average within an element, see `mixed`.
//!
//! A node `I` has the dilatation `theta_I = sum_e w_e J_e / (4 V_I)` of the tetrahedra around it, `V_I = sum_e w_e / 4`, and the energy `V_I U(theta_I)`. So
//! the forces of an element depend on all elements around its nodes, and the tangent has a stencil for each node beside those of the elements.

use crate::{
    ForceRule, SolidStep, StepEnd, TimeLevel,
    assembly::{self, AssemblyTarget, ElementEvaluator},
    block::Block,
    element::{self, Failure, FailureKind, gather},
    element_block::{ElementBlock, ElementFailure, Material, PointStrain},
    kernel::{self, LocalTangent, Matrix3, NodalVectors, PointBuffers, TangentFactors, TangentPoint},
    scratch::Scratch,
    viscous::Viscosity,
};
use rayon::prelude::*;
use stoss_continuum::{
    SymmetricTensor2, VolumetricEnergy,
    volume::{discrete_jacobian_gradient, discrete_jacobian_gradient_tangent, pressure_stress},
};
use stoss_reference_element::QuadratureRule;

/// NodalElements that a thread takes at once.
const CHUNK: usize = 64;

/// The tetrahedra around each node of a block.
#[derive(Clone, Debug)]
struct Patches {
    /// Where the nodes of each element are in the lists below.
    places: Vec<[u32; 4]>,
    /// `V_I`.
    volumes: Vec<f64>,
    /// NodalElements around each node, ascending: where they start, and the list.
    starts: Vec<usize>,
    elements: Vec<u32>,
    /// Global nodes of these elements, ascending: where they start, and the list.
    stencil_starts: Vec<usize>,
    stencils: Vec<u32>,
}

impl Patches {
    fn new(nodes: &[[u32; 4]], offset: u32, volume: impl Fn(usize) -> f64) -> Self {
        let mut numbers: Vec<u32> = nodes.iter().flatten().copied().collect();
        numbers.sort_unstable();
        numbers.dedup();
        let places: Vec<[u32; 4]> =
            nodes.iter().map(|e| e.map(|n| numbers.partition_point(|&number| number < n) as u32)).collect();
        let mut around = vec![Vec::new(); numbers.len()];
        for (element, places) in places.iter().enumerate() {
            places.iter().for_each(|&place| around[place as usize].push(element as u32));
        }
        let (mut starts, mut stencil_starts) = (vec![0], vec![0]);
        let (mut elements, mut stencils, mut volumes) = (Vec::new(), Vec::new(), Vec::new());
        for around in &around {
            volumes.push(around.iter().map(|&e| volume(e as usize) / 4.0).sum());
            elements.extend_from_slice(around);
            starts.push(elements.len());
            let mut stencil: Vec<u32> = around.iter().flat_map(|&e| nodes[e as usize]).map(|n| n + offset).collect();
            stencil.sort_unstable();
            stencil.dedup();
            stencils.extend(stencil);
            stencil_starts.push(stencils.len());
        }
        Self { places, volumes, starts, elements, stencil_starts, stencils }
    }

    fn len(&self) -> usize {
        self.volumes.len()
    }

    fn around(&self, place: usize) -> &[u32] {
        &self.elements[self.starts[place]..self.starts[place + 1]]
    }

    fn stencil(&self, place: usize) -> &[u32] {
        &self.stencils[self.stencil_starts[place]..self.stencil_starts[place + 1]]
    }
}

/// Tetrahedra with their averages.
#[derive(Clone, Debug)]
pub(crate) struct NodalTetrahedra {
    block: Block<4, 1>,
    patches: Patches,
    /// `J_n` of each element; empty unless the rule of the step is energy-momentum.
    jacobians: Vec<f64>,
}

impl NodalTetrahedra {
    /// `offset`: global number of the mesh's first node.
    pub fn new(block: Block<4, 1>, nodes: &[u32], offset: u32) -> Self {
        let patches = Patches::new(nodes.as_chunks().0, offset, |element| block.element_volume(element));
        Self { block, patches, jacobians: Vec::new() }
    }

    fn weight(&self, element: usize) -> f64 {
        self.block.weights(element)[0]
    }

    /// `det F` of every element, or the first that is not positive.
    fn determinants(
        &self,
        place: impl Fn(usize) -> NodalVectors<4> + Sync,
        level: TimeLevel,
        out: &mut Vec<f64>,
    ) -> Result<(), ElementFailure> {
        out.resize(self.patches.places.len(), 0.0);
        let fill = |(chunk, out): (usize, &mut [f64])| {
            for (k, j) in out.iter_mut().enumerate() {
                let element = CHUNK * chunk + k;
                let gradients = &self.block.integration(element).gradients[0];
                *j = kernel::determinant(&kernel::deformation_gradient(&place(element), gradients));
            }
        };
        if rayon::current_num_threads() == 1 {
            out.chunks_mut(CHUNK).enumerate().for_each(fill);
        } else {
            out.par_chunks_mut(CHUNK).enumerate().for_each(fill);
        }
        match out.iter().position(|j| *j <= 0.0 || j.is_nan()) {
            None => Ok(()),
            Some(element) => {
                let kind = FailureKind::Inverted { determinant: out[element], level };
                Err((element, Failure { gauss_point: 0, kind }))
            }
        }
    }

    /// `sum_I V_I U(theta_I)`.
    fn add_volumetric_energy(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        q: &[f64],
        total: &mut f64,
    ) -> Result<(), ElementFailure> {
        let nodes = nodes.as_chunks::<4>().0;
        let mut jacobians = Vec::new();
        self.determinants(|element| gather(&nodes[element], q), TimeLevel::End, &mut jacobians)?;
        for (node, volume) in self.patches.volumes.iter().enumerate() {
            *total += volume * material.volume().energy(self.dilatation(node, |e| jacobians[e]));
        }
        Ok(())
    }

    /// `theta_I`.
    fn dilatation(&self, node: usize, jacobian: impl Fn(usize) -> f64) -> f64 {
        let around = self.patches.around(node).iter().map(|&e| e as usize);
        around.map(|e| self.weight(e) * jacobian(e)).sum::<f64>() / (4.0 * self.patches.volumes[node])
    }

    /// Pressures of the nodes from their dilatations, then those of the elements, which are means.
    fn pressures(&self, scratch: &mut Scratch, of_node: impl Fn(usize, &[f64]) -> (f64, f64)) {
        scratch.nodal.clear();
        scratch.nodal.extend((0..self.patches.len()).map(|node| of_node(node, &scratch.jacobians)));
        scratch.pressures.clear();
        let of_element = |places: &[u32; 4]| places.iter().map(|&n| scratch.nodal[n as usize].0).sum::<f64>() / 4.0;
        scratch.pressures.extend(self.patches.places.iter().map(of_element));
    }

    fn assemble_with(
        &self,
        material: Material<'_>,
        volume: &dyn VolumetricEnergy,
        nodes: &[[u32; 4]],
        step: SolidStep<'_>,
        to: AssemblyTarget<'_, '_>,
        scratch: &mut Scratch,
    ) -> Result<(), ElementFailure> {
        let AssemblyTarget { first, before, tangent, visit, workspace } = to;
        let end = |element: usize| gather(&nodes[element], step.q_np1);
        let (level, theta) = match step.rule {
            ForceRule::DiscreteGradient => (TimeLevel::End, 1.0),
            ForceRule::Configuration { theta } if !step.rule.reads_start() => (TimeLevel::End, theta),
            ForceRule::Configuration { theta } if !step.rule.reads_end() => (TimeLevel::Start, theta),
            ForceRule::Configuration { theta } => {
                self.determinants(end, TimeLevel::End, &mut scratch.jacobians)?;
                (TimeLevel::Intermediate, theta)
            }
        };
        let place = |element: usize| match level {
            TimeLevel::End => end(element),
            TimeLevel::Start => gather(&nodes[element], step.q_n),
            TimeLevel::Intermediate => element::between(&gather(&nodes[element], step.q_n), &end(element), theta),
        };
        self.determinants(place, level, &mut scratch.jacobians)?;
        let conserving = step.rule == ForceRule::DiscreteGradient;
        self.pressures(scratch, |node, jacobians| {
            let now = self.dilatation(node, |e| jacobians[e]);
            if conserving {
                volume.divided_difference(self.dilatation(node, |e| self.jacobians[e]), now)
            } else {
                volume.pressure(now)
            }
        });
        let mid = |element: usize| element::between(&gather(&nodes[element], step.q_n), &end(element), 0.5);
        let element = NodalElements {
            tetrahedra: self,
            material,
            place: &place,
            mid: &mid,
            rule: step.rule,
            conserving,
            jacobians: &scratch.jacobians,
            pressures: &scratch.pressures,
            factor: theta * tangent.unwrap_or(1.0),
        };
        assembly::assemble(nodes, &element, AssemblyTarget { first, before, tangent, visit: &mut *visit, workspace })?;
        let Scratch { nodal, local, works, changes, .. } = scratch;
        for node in 0..self.patches.len() {
            let stencil = self.patches.stencil(node);
            local.begin(stencil, false);
            if tangent.is_none() {
                visit(first + nodes.len() + node, local);
                continue;
            }
            for list in [&mut *works, &mut *changes] {
                list.clear();
                list.resize(stencil.len(), [0.0; 3]);
            }
            for &e in self.patches.around(node) {
                let e = e as usize;
                // V_I p' R_I (x) R_I with R_I = w / (4 V_I)
                let share = self.weight(e) / 4.0;
                let [work, change] = element.vectors(e);
                for (local, &global) in nodes[e].iter().enumerate() {
                    let at = stencil.partition_point(|&n| n < global);
                    for i in 0..3 {
                        works[at][i] += share * work[i][local];
                        changes[at][i] += share * change[i][local];
                    }
                }
            }
            let scale = element.factor * nodal[node].1 / self.patches.volumes[node];
            local.tangent.clear();
            for row in works.as_flattened() {
                local.tangent.extend(changes.as_flattened().iter().map(|column| scale * row * column));
            }
            visit(first + nodes.len() + node, local);
        }
        Ok(())
    }
}

/// The elements with known pressures, as their loop sees them.
struct NodalElements<'a, P, M> {
    tetrahedra: &'a NodalTetrahedra,
    material: Material<'a>,
    place: &'a P,
    mid: &'a M,
    rule: ForceRule,
    conserving: bool,
    jacobians: &'a [f64],
    pressures: &'a [f64],
    factor: f64,
}

impl<P: Fn(usize) -> NodalVectors<4> + Sync, M: Fn(usize) -> NodalVectors<4> + Sync> NodalElements<'_, P, M> {
    fn strain(&self, element: usize, x: &NodalVectors<4>) -> (Matrix3, SymmetricTensor2) {
        let gradients = &self.tetrahedra.block.integration(element).gradients[0];
        let f = kernel::deformation_gradient(x, gradients);
        (f, SymmetricTensor2::from_components(kernel::right_cauchy_green(&f)))
    }

    /// `2 F K grad N`, the force of a unit pressure a volume, and `cof F grad N`, the change of `J`.
    fn vectors(&self, element: usize) -> [NodalVectors<4>; 2] {
        let gradients = &self.tetrahedra.block.integration(element).gradients[0];
        let (f, c) = self.strain(element, &(self.place)(element));
        let j = self.jacobians[element];
        let mut change = [[0.0; 4]; 3];
        kernel::add_force(&f, &c.inverse_with_det(j).to_components(), gradients, 1.0, &mut change);
        if !self.conserving {
            return [change; 2];
        }
        let (f_mid, _) = self.strain(element, &(self.mid)(element));
        let c_n = &self.tetrahedra.block.history(element).right_cauchy_green(0);
        let k = discrete_jacobian_gradient(c_n, self.tetrahedra.jacobians[element], &c, j);
        let mut work = [[0.0; 4]; 3];
        kernel::add_force(&f_mid, &k.to_components(), gradients, 2.0, &mut work);
        [work, change]
    }
}

impl<P: Fn(usize) -> NodalVectors<4> + Sync, M: Fn(usize) -> NodalVectors<4> + Sync> ElementEvaluator<4, 1>
    for NodalElements<'_, P, M>
{
    fn evaluate(
        &self,
        element: usize,
        force: &mut NodalVectors<4>,
        tangent: Option<(&mut LocalTangent<4>, &mut TangentFactors<4, 1>)>,
        _: &mut PointBuffers,
    ) -> Result<(), Failure> {
        let integration = &self.tetrahedra.block.integration(element);
        let (gradients, weight) = (&integration.gradients[0], integration.weights[0]);
        let (f, c) = self.strain(element, &(self.place)(element));
        let (j, p) = (self.jacobians[element], self.pressures[element]);
        let law = self.tetrahedra.block.laws(self.material, element, Some(self.rule)).at(0);
        let failure = |error| FailureKind::Constitutive(error).at(0);
        *force = [[0.0; 4]; 3];
        let history = self.conserving.then(|| {
            let history = self.tetrahedra.block.history(element);
            (history.right_cauchy_green(0), history.energy(0))
        });
        let j_n = self.tetrahedra.jacobians.get(element).copied().unwrap_or(j);
        // Left factor of the stress, and the discrete gradient of `J` or nothing.
        let (left, k) = match history {
            None => (f, None),
            Some((c_n, _)) => {
                let k = discrete_jacobian_gradient(&c_n, j_n, &c, j);
                (self.strain(element, &(self.mid)(element)).0, Some(k))
            }
        };
        let Some((tangent, factors)) = tangent else {
            let stress = match (history, k) {
                (Some((c_n, energy)), Some(k)) => {
                    k * (2.0 * p) + stoss_continuum::energy_momentum_stress(&*law, &c_n, energy, &c).map_err(failure)?
                }
                _ => law.stress(&c).map_err(failure)? + pressure_stress(p, &c, j).0,
            };
            kernel::add_force(&left, &stress.to_components(), gradients, weight, force);
            return Ok(());
        };
        let (stress, moduli) = match (history, k) {
            (Some((c_n, energy)), Some(k)) => {
                let (rest, mut moduli) =
                    stoss_continuum::energy_momentum_stress_and_tangent(&*law, &c_n, energy, &c).map_err(failure)?;
                moduli.add_scaled(2.0 * p, &discrete_jacobian_gradient_tangent(&c_n, j_n, &c, j, &k));
                (rest + k * (2.0 * p), moduli)
            }
            _ => {
                let (rest, moduli) = law.stress_and_elasticity(&c).map_err(failure)?;
                let (of_pressure, of_pressure_moduli) = pressure_stress(p, &c, j);
                (rest + of_pressure, moduli + of_pressure_moduli)
            }
        };
        let stress = stress.to_components();
        kernel::add_force(&left, &stress, gradients, weight, force);
        let (geometric, symmetric) = if self.conserving { (0.5, false) } else { (1.0, true) };
        let (left, moduli, stress) = (&left, &moduli.0, &stress);
        let point = TangentPoint { left, right: &f, moduli, stress, geometric, weight };
        kernel::tangent_factors(&[point], &integration.gradients, 0, symmetric, factors);
        kernel::tangent_from_factors(&integration.gradients, factors, symmetric, self.factor, tangent);
        Ok(())
    }
}

impl ElementBlock for NodalTetrahedra {
    fn boxed(&self) -> Box<dyn ElementBlock> {
        Box::new(self.clone())
    }

    fn rule(&self) -> QuadratureRule {
        self.block.rule()
    }

    fn memory_bytes(&self) -> usize {
        let Patches { places, volumes, starts, elements, stencil_starts, stencils } = &self.patches;
        self.block.memory_bytes()
            + size_of_val(places.as_slice())
            + size_of_val(volumes.as_slice())
            + size_of_val(starts.as_slice())
            + size_of_val(elements.as_slice())
            + size_of_val(stencil_starts.as_slice())
            + size_of_val(stencils.as_slice())
            + self.jacobians.capacity() * size_of::<f64>()
    }

    fn add_volume(&self, total: &mut f64) {
        self.block.add_volume(total);
    }

    fn element_volume(&self, element: usize) -> f64 {
        self.block.element_volume(element)
    }

    fn begin_step(
        &mut self,
        material: Material<'_>,
        nodes: &[u32],
        q_n: &[f64],
        rule: ForceRule,
        dt: f64,
    ) -> Result<(), ElementFailure> {
        self.block.begin_step(material, nodes, q_n, rule, dt)?;
        let nodes = nodes.as_chunks::<4>().0;
        let mut jacobians = std::mem::take(&mut self.jacobians);
        self.determinants(|element| gather(&nodes[element], q_n), TimeLevel::Start, &mut jacobians)?;
        self.jacobians = jacobians;
        Ok(())
    }

    fn end_step(&mut self) {
        self.block.end_step();
        self.jacobians.clear();
    }

    fn has_begun(&self) -> bool {
        self.block.has_begun()
    }

    fn stencil_count(&self) -> usize {
        self.patches.len()
    }

    fn stencil(&self, k: usize) -> &[u32] {
        self.patches.stencil(k)
    }

    fn assemble(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        step: SolidStep<'_>,
        to: AssemblyTarget<'_, '_>,
    ) -> Result<(), ElementFailure> {
        let AssemblyTarget { first, before, tangent, visit, workspace } = to;
        let mut scratch = std::mem::take(&mut workspace.nodal);
        let to = AssemblyTarget { first, before, tangent, visit, workspace: &mut *workspace };
        let volume = material.volume();
        let result = self.assemble_with(material, volume, nodes.as_chunks().0, step, to, &mut scratch);
        workspace.nodal = scratch;
        result
    }

    fn add_viscous_force(
        &self,
        nodes: &[u32],
        viscosity: Viscosity<'_>,
        to: AssemblyTarget<'_, '_>,
    ) -> Result<(), ElementFailure> {
        self.block.add_viscous_force(nodes, viscosity, to)
    }

    fn add_energy(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        q: &[f64],
        rule: Option<ForceRule>,
        total: &mut f64,
    ) -> Result<(), ElementFailure> {
        self.block.add_energy(material, nodes, q, rule, total)?;
        self.add_volumetric_energy(material, nodes, q, total)
    }

    fn visit_points(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        element: usize,
        q: &[f64],
        visit: &mut dyn FnMut(PointStrain<'_>) -> Result<(), FailureKind>,
    ) -> Result<(), Failure> {
        let all = nodes.as_chunks::<4>().0;
        let jacobian = |e: usize| {
            let gradients = &self.block.integration(e).gradients[0];
            kernel::determinant(&kernel::deformation_gradient(&gather(&all[e], q), gradients))
        };
        let (mut pressure, mut energy) = (0.0, 0.0);
        for &node in &self.patches.places[element] {
            let dilatation = self.dilatation(node as usize, jacobian);
            if dilatation <= 0.0 || dilatation.is_nan() {
                return Err(FailureKind::Collapsed { dilatation, level: TimeLevel::End }.at(0));
            }
            pressure += material.volume().pressure(dilatation).0 / 4.0;
            energy += material.volume().energy(dilatation) / 4.0;
        }
        self.block.visit_points(material, nodes, element, q, &mut |point| {
            visit(PointStrain { pressure, volumetric_energy: energy, ..point })
        })
    }

    fn states(&self) -> &[f64] {
        self.block.states()
    }

    fn states_mut(&mut self) -> &mut [f64] {
        self.block.states_mut()
    }

    fn add_step_end(
        &self,
        material: Material<'_>,
        nodes: &[u32],
        q_np1: &[f64],
        total: &mut StepEnd,
    ) -> Result<(), ElementFailure> {
        self.block.add_step_end(material, nodes, q_np1, total)?;
        self.add_volumetric_energy(material, nodes, q_np1, &mut total.stored)
    }

    fn commit(&mut self, material: Material<'_>, nodes: &[u32], q_np1: &[f64]) -> Result<(), ElementFailure> {
        self.block.commit(material, nodes, q_np1)
    }

    fn add_hardening_energy(&self, material: Material<'_>, total: &mut f64) {
        self.block.add_hardening_energy(material, total);
    }

    fn worst_node(&self, nodes: &[u32], element: usize, q: &[f64]) -> (usize, f64) {
        self.block.worst_node(nodes, element, q)
    }
}
