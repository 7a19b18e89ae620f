//! A body of finite elements with one law. Not its mesh (only nodes and reference integrals are kept), not its unknowns.

use crate::{
    ForceRule, MassKind, MassMatrix, SolidError, SolidOptions, SolidStep, ViscousRate, Volumetric,
    assembly::{AssemblyTarget, TangentTarget, Visit, Workspace, adder},
    blocks,
    element::{Failure, FailureKind},
    element_block::{ElementBlock, ElementFailure, InvertedCell, Material},
    mass::{self, Carried},
    own::Own,
    viscous::Viscosity,
};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use stoss_continuum::{HyperelasticLaw, VolumetricSplit};
use stoss_mesh::{CellBlock, Elements, Mesh};
use stoss_reference_element::{CellKind, Integration};

/// Energy, force and tangent of a body of elements of any kinds.
#[derive(Debug)]
pub struct SolidBody {
    name: String,
    law: Arc<dyn HyperelasticLaw>,
    node_offset: u32,
    /// Reference positions of the body's nodes.
    reference: Arc<[[f64; 3]]>,
    /// Elements of the body, with global nodes.
    elements: Arc<Elements>,
    /// Elements that are evaluated here: all, or the share of a rank.
    own: Own,
    /// One for each block of the own elements, made when they are needed first: after the elements were shared out.
    blocks: OnceLock<Vec<Box<dyn ElementBlock>>>,
    /// Reference volume of all elements.
    volume: f64,
    options: SolidOptions,
    /// The parts of the law, in a mixed body.
    split: Option<VolumetricSplit>,
    /// Workspace of callers who bring none.
    workspace: Mutex<Workspace>,
}

impl Clone for SolidBody {
    fn clone(&self) -> Self {
        Self {
            name: self.name.clone(),
            law: self.law.clone(),
            node_offset: self.node_offset,
            reference: self.reference.clone(),
            elements: self.elements.clone(),
            own: self.own.clone(),
            blocks: match self.blocks.get() {
                None => OnceLock::new(),
                Some(blocks) => blocks.iter().map(|block| block.boxed()).collect::<Vec<_>>().into(),
            },
            volume: self.volume,
            options: self.options,
            split: self.split.clone(),
            workspace: Mutex::default(),
        }
    }
}

impl SolidBody {
    /// A body from its mesh in reference position, with the default options. `node_offset`: global number of the mesh's first node. No mass is
    /// built here.
    ///
    /// # Errors
    /// [`SolidError::Empty`], [`SolidError::NoSuchNode`], [`SolidError::InvertedReference`].
    pub fn new(name: &str, mesh: &Mesh, node_offset: u32, law: Arc<dyn HyperelasticLaw>) -> Result<Self, SolidError> {
        Self::with_options(name, mesh, node_offset, law, SolidOptions::default())
    }

    /// A body as of [`Self::new`], with options.
    ///
    /// # Errors
    /// The errors of [`Self::new`]; [`SolidError::NoVolumetricPart`].
    pub fn with_options(
        name: &str,
        mesh: &Mesh,
        node_offset: u32,
        law: Arc<dyn HyperelasticLaw>,
        options: SolidOptions,
    ) -> Result<Self, SolidError> {
        let body = || name.to_string();
        if mesh.elements.is_empty() {
            return Err(SolidError::Empty { body: body() });
        }
        let split = match options.volumetric {
            Volumetric::Displacement => None,
            Volumetric::Mixed => Some(
                law.volumetric()
                    .ok_or_else(|| SolidError::NoVolumetricPart { body: body(), law: law.name().to_string() })?,
            ),
        };
        let count = mesh.nodes.len();
        for (element, nodes) in mesh.elements.iter().enumerate() {
            if let Some(&node) = nodes.iter().find(|&&node| node as usize >= count) {
                return Err(SolidError::NoSuchNode { body: body(), element, node, count });
            }
        }
        let (mut volume, seen) = (0.0, material(&law, &split).law);
        for cells in mesh.elements.blocks() {
            let checked = blocks::check(cells, &mesh.nodes, options, seen, &mut volume);
            // Where the quadrature of the mass has points of its own.
            let checked = checked.and_then(|()| mass::check(cells, &mesh.nodes));
            checked.map_err(|InvertedCell { element, gauss_point, determinant }| {
                let element = cells.first() as usize + element;
                SolidError::InvertedReference { body: body(), element, gauss_point, determinant }
            })?;
        }
        let mut elements = Elements::new();
        elements.extend(&mesh.elements, |node| node + node_offset);
        let elements = Arc::new(elements);
        Ok(Self {
            name: name.to_string(),
            law,
            node_offset,
            reference: mesh.nodes.as_slice().into(),
            own: Own::all(&elements),
            elements,
            blocks: OnceLock::new(),
            volume,
            options,
            split,
            workspace: Mutex::default(),
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

    /// What the elements see of the law.
    pub(crate) fn material(&self) -> Material<'_> {
        material(&self.law, &self.split)
    }

    /// What the body was made with.
    pub fn options(&self) -> SolidOptions {
        self.options
    }

    /// Whether elements have modes without stiffness of their own, which their neighbours have to take: hex20 with reduced integration.
    pub fn has_own_modes(&self) -> bool {
        self.options.integration == Integration::Reduced && self.elements.kinds().contains(&CellKind::Hex20)
    }

    /// All elements of the body, of whatever rank, with global node numbers.
    pub fn elements(&self) -> &Elements {
        &self.elements
    }

    /// Global nodes of each stencil of the tangent, block by block: those of the elements in their order, then those of nodes with averages of their own, which
    /// mixed tet4 have. Of a share those of its elements.
    pub fn stencils(&self) -> impl Iterator<Item = &[u32]> + Clone {
        self.with_averages().flat_map(|(cells, block)| {
            let more = block.into_iter().flat_map(|block| (0..block.stencil_count()).map(move |k| block.stencil(k)));
            cells.iter().chain(more)
        })
    }

    /// The own elements, with their blocks if some of these have averages across elements.
    fn with_averages(&self) -> impl Iterator<Item = (&CellBlock, Option<&dyn ElementBlock>)> + Clone {
        let blocks = if self.is_indivisible() { self.blocks() } else { &[] };
        let blocks = blocks.iter().map(|block| Some(block.as_ref())).chain(std::iter::repeat(None));
        self.own.elements.blocks().iter().zip(blocks)
    }

    /// Number of the first stencil of each block.
    pub(crate) fn first_stencils(&self) -> impl Iterator<Item = usize> {
        let counts = self.with_averages();
        let counts = counts.map(|(cells, block)| cells.len() + block.map_or(0, |block| block.stencil_count()));
        counts.scan(0, |next, count| Some(std::mem::replace(next, *next + count)))
    }

    /// Global number of the body's first node.
    pub fn node_offset(&self) -> u32 {
        self.node_offset
    }

    /// Number of nodes of the body's mesh.
    pub fn node_count(&self) -> usize {
        self.reference.len()
    }

    /// Number of all elements of the body, of whatever rank.
    pub fn element_count(&self) -> usize {
        self.elements.len()
    }

    /// Reference volume, of a share that of the whole body.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Edge of the cube that has the mean reference volume of an element: a length, of a share that of the whole body.
    pub fn characteristic_length(&self) -> f64 {
        (self.volume() / self.element_count() as f64).cbrt()
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let numbers: usize = self.elements.blocks().iter().map(|cells| size_of_val(cells.nodes())).sum();
        let blocks: usize = self.blocks.get().into_iter().flatten().map(|block| block.memory_bytes()).sum();
        numbers + self.own.memory_bytes() + size_of_val(&*self.reference) + blocks
    }

    /// Caches what depends on `q_n` only: `C_n` and `W_n` at every Gauss point for [`ForceRule::DiscreteGradient`]; for
    /// other rules only of a law with a state. `dt`: size of the step, which such a law needs to flow in; a step that is tried once more with another size begins once more.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::CollapsedElement`], [`SolidError::Constitutive`] (the cache is then empty), [`SolidError::Length`].
    pub fn begin_step(&mut self, q_n: &[f64], rule: ForceRule, dt: f64) -> Result<(), SolidError> {
        if rule != ForceRule::DiscreteGradient && !self.has_history() {
            return Ok(());
        }
        self.check_length("the positions q_n", q_n)?;
        let (material, mut blocks) = self.blocks_with_material();
        let failed = blocks.find_map(|(cells, block)| {
            let begun = block.begin_step(material, cells.nodes(), q_n, rule, dt);
            begun.err().map(|(element, failure)| (cells.first() as usize + element, failure))
        });
        drop(blocks);
        let Some((own, failure)) = failed else { return Ok(()) };
        self.blocks_mut().iter_mut().for_each(|block| block.end_step());
        Err(self.error(self.own.number(own), failure))
    }

    /// Adds `force_weight * F(q_n, q_np1)` to `force` (`3 * nodes` of the model) and, if a target is given,
    /// `target.factor * dF/dq_np1` to its values (theory/kinematics#force, theory/integrators#eq-ems-stiffness). A target is left untouched under
    /// [`ForceRule::Configuration`] with `theta = 0`, whose tangent is zero.
    ///
    /// The target's stencils are [`Self::stencils`]. Of a share it is the part of its elements, and the sum over all ranks is that of the body. In rayon's current
    /// pool, if it has more than one thread; the bits do not depend on their number. After the first call with a workspace (the first with a tangent, if there are some)
    /// nothing is allocated.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::CollapsedElement`], [`SolidError::Constitutive`], [`SolidError::StepNotBegun`],
    /// [`SolidError::Length`]. On an error the arrays hold a partial sum.
    pub fn assemble(
        &self,
        step: SolidStep<'_>,
        force_weight: f64,
        force: &mut [f64],
        tangent: Option<TangentTarget<'_>>,
        workspace: &mut Workspace,
    ) -> Result<(), SolidError> {
        self.assemble_after(None, step, force_weight, force, tangent, workspace)
    }

    /// Adds force and tangent as [`Self::assemble`], for the tangent of an iterate that followed `before` by a linear solution. In a mixed body the stress that
    /// stiffens the tangent then has the pressures of that linear solution, not those of the volumes at `q_np1`: Newton's method for displacements and
    /// pressures, from which the pressures were eliminated (theory/elements#mixed-iteration). Near incompressibility it converges from much farther away,
    /// because the volumes that a large rotation of an iterate makes are not multiplied by the bulk modulus. The force does not depend on `before`, and the
    /// tangent is the derivative of the force where the iteration ends.
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    pub fn assemble_after(
        &self,
        before: Option<&[f64]>,
        step: SolidStep<'_>,
        force_weight: f64,
        force: &mut [f64],
        tangent: Option<TangentTarget<'_>>,
        workspace: &mut Workspace,
    ) -> Result<(), SolidError> {
        self.check_length("the force", force)?;
        // A force that does not depend on q_np1 has no tangent: nothing is to be computed or added.
        let target = tangent.filter(|_| step.rule.reads_end());
        let factor = target.as_ref().map(|target| target.factor);
        self.visit(before, step, factor, workspace, &mut adder(force_weight, force, target))
    }

    /// Hands out every contribution in the order of [`Self::stencils`], with its number, and with a tangent if `tangent` has its factor: what [`Self::assemble_after`] adds.
    pub(crate) fn visit(
        &self,
        before: Option<&[f64]>,
        step: SolidStep<'_>,
        tangent: Option<f64>,
        workspace: &mut Workspace,
        visit: &mut Visit<'_>,
    ) -> Result<(), SolidError> {
        if let Some(before) = before {
            self.check_length("the positions before", before)?;
        }
        if step.rule.reads_end() {
            self.check_length("the positions q_np1", step.q_np1)?;
        }
        if step.rule.reads_start() {
            self.check_length("the positions q_n", step.q_n)?;
        }
        if step.rule == ForceRule::DiscreteGradient && !self.has_begun() {
            return Err(SolidError::StepNotBegun { body: self.name.clone() });
        }
        let mut first = self.first_stencils();
        self.for_each_block(|block, cells| {
            let first = first.next().unwrap_or_default();
            let to = AssemblyTarget { first, before, tangent, visit: &mut *visit, workspace };
            block.assemble(self.material(), cells.nodes(), step, to)
        })
    }

    /// Calls with the body's own buffers.
    pub(crate) fn with_workspace<T>(&self, call: impl FnOnce(&mut Workspace) -> T) -> T {
        call(&mut self.workspace.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Adds the nodal forces of `S_v = b C_0 : E'` to `force` and, if a target is given, `target.factor` times their derivative with respect to the
    /// unknown positions to its values. The isotropic part of `C_0` counts, that of [`stoss_continuum::HyperelasticLaw::small_strain_moduli`]; in a mixed body that of
    /// the law without its energy of the change of volume, which would lock. Shares, threads and allocation
    /// are as in [`SolidBody::assemble`].
    ///
    /// # Errors
    /// [`SolidError::Length`].
    pub fn add_viscous_force(
        &self,
        rate: ViscousRate<'_>,
        force: &mut [f64],
        tangent: Option<TangentTarget<'_>>,
    ) -> Result<(), SolidError> {
        self.check_length("the force", force)?;
        self.check_length("the positions", rate.q)?;
        self.check_length("the velocities", rate.v)?;
        let moduli = self.material().law.small_strain_moduli();
        let viscosity = Viscosity {
            rate,
            moduli: [rate.factor * moduli.lame_lambda(), rate.factor * moduli.shear],
            factor: tangent.as_ref().map_or(1.0, |target| target.factor),
        };
        let factor = tangent.as_ref().map(|target| target.factor);
        let (mut first, mut add) = (self.first_stencils(), adder(1.0, force, tangent));
        self.with_workspace(|workspace| {
            self.for_each_block(|block, cells| {
                let first = first.next().unwrap_or_default();
                let to = AssemblyTarget { first, before: None, tangent: factor, visit: &mut add, workspace };
                block.add_viscous_force(cells.nodes(), viscosity, to)
            })
        })
    }

    pub(crate) fn blocks(&self) -> &[Box<dyn ElementBlock>] {
        self.blocks.get_or_init(|| self.make_blocks())
    }

    pub(crate) fn blocks_mut(&mut self) -> &mut [Box<dyn ElementBlock>] {
        self.blocks();
        self.blocks.get_mut().map_or(&mut [], Vec::as_mut_slice)
    }

    fn make_blocks(&self) -> Vec<Box<dyn ElementBlock>> {
        let mut cells = Elements::new();
        cells.extend(&self.own.elements, |node| node - self.node_offset);
        let of = |cells| blocks::of_cells(cells, &self.reference, self.options, self.material().law, self.node_offset);
        let made: Result<_, _> = cells.blocks().iter().map(of).collect();
        made.unwrap_or_else(|InvertedCell { .. }| unreachable!("the cells were checked when the body was made"))
    }

    pub(crate) fn own(&self) -> &Own {
        &self.own
    }

    /// Takes other elements, with virgin states.
    pub(crate) fn set_own(&mut self, own: Own) {
        (self.own, self.blocks) = (own, OnceLock::new());
    }

    /// Whether there are data of elements already.
    pub(crate) fn has_blocks(&self) -> bool {
        self.blocks.get().is_some()
    }

    /// Whether a step has begun.
    pub(crate) fn has_begun(&self) -> bool {
        self.blocks().iter().all(|block| block.has_begun())
    }

    /// Each block with its elements, to change its states, and what elements see of the law.
    pub(crate) fn blocks_with_material(
        &mut self,
    ) -> (Material<'_>, impl Iterator<Item = (&CellBlock, &mut Box<dyn ElementBlock>)>) {
        self.blocks();
        let blocks = self.blocks.get_mut().into_iter().flatten();
        (material(&self.law, &self.split), self.own.elements.blocks().iter().zip(blocks))
    }

    /// Calls with each block and its elements.
    pub(crate) fn for_each_block(
        &self,
        mut call: impl FnMut(&dyn ElementBlock, &CellBlock) -> Result<(), ElementFailure>,
    ) -> Result<(), SolidError> {
        for (cells, block) in self.own.elements.blocks().iter().zip(self.blocks()) {
            call(block.as_ref(), cells)
                .map_err(|(element, failure)| self.error(self.own.number(cells.first() as usize + element), failure))?;
        }
        Ok(())
    }

    /// `int W dV` over the reference volume; in a mixed body that of the averaged energy. Of a law with a state the energy that the accepted states store at `q`,
    /// elastically and by hardening. Of a share that of its elements; the sum over all ranks is that of the body.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::CollapsedElement`], [`SolidError::Constitutive`], [`SolidError::Length`].
    pub fn strain_energy(&self, q: &[f64]) -> Result<f64, SolidError> {
        self.energy(q, None)
    }

    /// The energy whose gradient is the force of a step by [`ForceRule::END_POINT`], for iterates: that of deformation, and of a law with a state the work of the
    /// step that has begun, but for a constant. Of a share as [`Self::strain_energy`].
    ///
    /// # Errors
    /// The errors of [`Self::strain_energy`].
    pub fn potential(&self, q: &[f64]) -> Result<f64, SolidError> {
        self.energy(q, Some(ForceRule::END_POINT))
    }

    fn energy(&self, q: &[f64], rule: Option<ForceRule>) -> Result<f64, SolidError> {
        self.check_length("the positions", q)?;
        let mut total = 0.0;
        self.for_each_block(|block, cells| block.add_energy(self.material(), cells.nodes(), q, rule, &mut total))?;
        Ok(total)
    }

    /// Elements that are turned inside out at a node (`det dx/dxi <= 0` there), which the integrals do not notice as long as
    /// `det F > 0` at the Gauss points. `None` if there are none. Of a share among its elements: [`InsideOut::and`] makes that of the body of those of all ranks.
    ///
    /// # Errors
    /// [`SolidError::Length`].
    pub fn inside_out(&self, q: &[f64]) -> Result<Option<InsideOut>, SolidError> {
        self.check_length("the positions", q)?;
        let mut found: Option<InsideOut> = None;
        for (cells, block) in self.own.elements.blocks().iter().zip(self.blocks()) {
            let natural = cells.kind().table().family.volume();
            for local in 0..cells.len() {
                let (node, determinant) = block.worst_node(cells.nodes(), local, q);
                // Also a NaN is no volume.
                if determinant > 0.0 {
                    continue;
                }
                let element = self.own.number(cells.first() as usize + local);
                let relative_volume = natural * determinant / block.element_volume(local);
                let one = InsideOut { count: 1, element, node, relative_volume };
                found = Some(found.map_or(one, |found| found.and(&one)));
            }
        }
        Ok(found)
    }

    /// The mass of the body for a reference density. Of a share that of its elements, whose products, momenta and energies add up to those of the body over all ranks.
    pub fn mass(&self, density: f64, kind: MassKind) -> MassMatrix {
        self.mass_of((density, kind), None)
    }

    /// The mass of the body with nodes that others carry.
    pub(crate) fn mass_with(&self, density: f64, kind: MassKind, carried: &Carried) -> MassMatrix {
        self.mass_of((density, kind), Some((carried, self.stencils().count())))
    }

    fn mass_of(&self, of: (f64, MassKind), carried: Option<(&Carried, usize)>) -> MassMatrix {
        MassMatrix::new(&self.own, self.reference(), of, self.first_stencils(), carried)
    }

    /// Reference positions of the nodes, and the number of the first one.
    pub(crate) fn reference(&self) -> (&[[f64; 3]], u32) {
        (&self.reference, self.node_offset)
    }

    /// The reference position of a node, by its global number.
    pub(crate) fn reference_position(&self, node: u32) -> [f64; 3] {
        self.reference[(node - self.node_offset) as usize]
    }

    /// Adds the nodal forces `int N_I b_0 dV` of a constant force per *reference volume* to `out` (`3 * nodes` of the
    /// model). Of a share those of the whole body.
    ///
    /// # Errors
    /// [`SolidError::Length`].
    pub fn body_force(&self, force_per_volume: [f64; 3], out: &mut [f64]) -> Result<(), SolidError> {
        self.check_length("the nodal forces", out)?;
        mass::for_each_nodal_volume(&self.elements, &self.reference, self.node_offset, |node, volume| {
            for i in 0..3 {
                out[3 * node as usize + i] += volume * force_per_volume[i];
            }
        });
        Ok(())
    }

    /// The cells and the block of an element, and its number in there; nothing if another rank has it.
    pub(crate) fn locate(&self, element: usize) -> Option<(&CellBlock, &dyn ElementBlock, usize)> {
        let (blocks, own) = (self.own.elements.blocks(), self.own.place(element)?);
        let at = blocks.partition_point(|cells| cells.first() as usize <= own) - 1;
        Some((&blocks[at], self.blocks()[at].as_ref(), own - blocks[at].first() as usize))
    }

    /// Every node of the body is inside a vector of the model.
    pub(crate) fn check_length(&self, what: &'static str, x: &[f64]) -> Result<(), SolidError> {
        let expected = 3 * (self.node_offset as usize + self.node_count());
        if x.len() < expected {
            return Err(SolidError::Length { name: self.name.clone(), what, found: x.len(), expected });
        }
        Ok(())
    }

    /// The failure of an element, by its number in the body.
    pub(crate) fn error(&self, element: usize, failure: Failure) -> SolidError {
        let (body, gauss_point) = (self.name.clone(), failure.gauss_point);
        match failure.kind {
            FailureKind::Inverted { determinant, level } => {
                SolidError::InvertedElement { body, element, gauss_point, determinant, level }
            }
            FailureKind::Collapsed { dilatation, level } => {
                SolidError::CollapsedElement { body, element, gauss_point, dilatation, level }
            }
            FailureKind::Constitutive(source) => SolidError::Constitutive { body, element, gauss_point, source },
        }
    }
}

fn material<'a>(law: &'a Arc<dyn HyperelasticLaw>, split: &'a Option<VolumetricSplit>) -> Material<'a> {
    match split {
        None => Material { law: law.as_ref(), volume: None },
        Some(split) => Material { law: split.rest.as_ref(), volume: Some(split.volume.as_ref()) },
    }
}

/// Elements of a body that are turned inside out at a node, see [`SolidBody::inside_out`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InsideOut {
    /// Number of such elements.
    pub count: usize,
    /// The worst one, in the body.
    pub element: usize,
    /// The worst node of this element, in the order of its kind.
    pub node: usize,
    /// `det dx/dxi` there over its mean in the element's reference volume: 1 for an undeformed parallelepiped or a tetrahedron with straight edges, not positive here.
    pub relative_volume: f64,
}

impl InsideOut {
    /// The elements of two shares of a body: their number, and the worst; of equal ones the first element.
    pub fn and(&self, other: &Self) -> Self {
        let rank = |of: &Self| (of.relative_volume, of.element);
        let worst = if rank(self) < rank(other) { self } else { other };
        Self { count: self.count + other.count, ..*worst }
    }
}
