//! Mesh tying: two surfaces that stay together for good (theory/mortar#tying).
//!
//! The surfaces are segmented once, in the reference configuration; the integrals are constants of the run. Every
//! slave node `A` has a gap vector
//!
//! `g_A = sum_J D_AJ q_J - sum_K M_AK q_K` (a volume)
//!
//! and a vector of multipliers, the traction that the master exerts on the slave. They are slots that are always
//! active ([`stoss_term::Term`]), up to three a node.
//!
//! # Forms
//! * [`TieForm::Constant`] (thesis (4.97)): `g_A = c_A` in Cartesian components. The gradient is constant: under
//!   every scheme the tie does no work and has no resultant. The moment of its forces is `sum g_A x lambda_A`: zero
//!   for a closed interface; a kept offset keeps its direction in space, so a rotation of the whole strains the bodies.
//! * [`TieForm::FrameInvariant`] (after thesis (4.98)): `Phi_Aa = b_Aa . g_A = c_Aa` with the base vectors of a
//!   frame at the slave node, `b_A1`, `b_A2` tangents of the slave's surface, `b_A3 = b_A1 x b_A2`. With the
//!   variation of the base vectors forces have neither resultant nor moment for any gap, and an offset turns with
//!   the bodies.
//!
//! Thesis (4.98) takes components along the base vectors of every segment and adds them up over the segments, which
//! needs facets whose local axes agree, and parallelograms for the patch test. Here the frame belongs to the node
//! (choice): the mean over the facets around it of the images of two fixed reference directions, linear in the
//! positions and without regard to the facets' numbering. Both forms are then the same equations wherever `g_A = 0`
//! is asked for.
//!
//! # Supports and crosspoints
//! A component of a slave node that is fixed from elsewhere (prescribed, or tied already) has no multiplier: its
//! function goes to the neighbours in equal parts, so that the functions of what is left still add up to one and
//! uniform stress passes. A node with a fixed component has the spatial axes as its frame. A slave node whose
//! support is covered by less than `1e-8` has no multiplier either.

mod fit;
mod frame;
mod method;
mod rows;
mod stages;

use crate::{CheckExtent, Faces, MortarError, MortarMatrices, MultiplierSpace, SurfaceCoverage, segment_surfaces};
use frame::NodeFrame;
use rows::{ConstraintRow, constraint_rows};
use stages::Stages;
use stoss_contact::ContactSurface;
use stoss_reference_element::FacePiece;
use stoss_segmentation::GapRange;

/// Which components of the gap vector are constrained.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TieForm {
    /// Cartesian components (thesis (4.97)).
    #[default]
    Constant,
    /// Components along a frame that moves with the slave surface (after thesis (4.98)).
    FrameInvariant,
}

/// What happens to an interface whose surfaces do not fit in the reference configuration, for instance two polyhedra
/// of the same cylinder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interface {
    /// The slave nodes of the interface are moved before the run so that the gap vectors vanish: no initial stress.
    #[default]
    Move,
    /// The gap vectors keep their initial values: no initial stress, meshes as they are.
    Keep,
    /// The gap vectors are closed by the first step, which strains the bodies.
    Close,
}

/// Options of a tie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TieOptions {
    /// Form of the constraint.
    pub form: TieForm,
    /// Functions of the multipliers.
    pub space: MultiplierSpace,
    /// Treatment of an initial gap.
    pub interface: Interface,
    /// Largest distance at which facets are tied; by default the longer of the two surfaces' mean edges.
    pub reach: Option<f64>,
}

/// Passes in which slave nodes are moved; each is followed by integrals of the new positions. The motion of a pass is
/// smaller than that of the one before by about the offset over an edge length.
const PASSES: usize = 4;

/// Offsets below this share of an edge length are round-off: nothing is moved, and the target of the constraint is
/// zero.
const CLOSED: f64 = 1e-12;

/// Two tied surfaces.
#[derive(Clone, Debug)]
pub struct MeshTie {
    name: String,
    nodes: Vec<TiedNode>,
    /// Ascending by node and component.
    slots: Vec<Slot>,
    form: TieForm,
    /// Whether the gap vectors are to vanish.
    closed: bool,
    /// Surfaces and rows that differ from stage to stage, if what is prescribed does.
    stages: Option<Box<Stages>>,
    /// Global nodes of both surfaces.
    surfaces: Vec<u32>,
    length_scale: f64,
    moved: Vec<(u32, [f64; 3])>,
    largest_gap: f64,
    covered: f64,
    area: f64,
}

/// A component of the multiplier of a slave node.
#[derive(Clone, Copy, Debug)]
struct Slot {
    node: u32,
    component: u8,
    /// [`ConstraintRow::weight`].
    weight: f64,
}

/// A slave node with multipliers.
#[derive(Clone, Debug)]
struct TiedNode {
    row: ConstraintRow,
    /// `None`: spatial axes.
    frame: Option<NodeFrame>,
    /// Values that the constraints keep [volume].
    target: [f64; 3],
    slots: Vec<u32>,
}

impl MeshTie {
    /// Ties two surfaces (facets in global node numbers, outward numbering) with the reference positions of all
    /// nodes. Of facets that are pieces of quadratic faces gap vectors are those of the faces; a corner that is no node of its face has to be fixed.
    ///
    /// `is_fixed` tells of a component (`3 * node + i`) whether its motion is given by something else, in all steps alike ([`MeshTie::in_stages`] otherwise). With
    /// [`Interface::Move`] the positions in [`MeshTie::moved`] have to replace those of the reference before the
    /// bodies are integrated.
    ///
    /// # Errors
    /// [`MortarError::Surface`], [`MortarError::Segmentation`], [`MortarError::Range`], [`MortarError::Coverage`],
    /// [`MortarError::Apart`] if nothing lies opposite, [`MortarError::AllFixed`] if no multiplier is left,
    /// [`MortarError::Fit`] if no motion of the slave nodes closes the interface.
    pub fn new<S: Copy + Into<FacePiece>, M: Copy + Into<FacePiece>>(
        name: &str,
        slave: &[S],
        master: &[M],
        reference: &[f64],
        is_fixed: impl Fn(usize) -> bool,
        options: TieOptions,
    ) -> Result<Self, MortarError> {
        let (tie, ..) = Self::made(name, slave, master, reference, [&is_fixed, &is_fixed], options)?;
        Ok(tie)
    }

    /// A tie as of [`Self::new`] where a component may be prescribed in some stages of a run and free in others: `is_fixed` tells whether it is given at the
    /// start, and `is_always_fixed` whether it is by something that is no prescription, or by one that never ends. Every step says what is prescribed in it
    /// ([`stoss_term::StepContext::held`]), and slots of components that are prescribed do not act.
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub fn in_stages<S: Copy + Into<FacePiece>, M: Copy + Into<FacePiece>>(
        name: &str,
        slave: &[S],
        master: &[M],
        reference: &[f64],
        is_fixed: impl Fn(usize) -> bool,
        is_always_fixed: impl Fn(usize) -> bool,
        options: TieOptions,
    ) -> Result<Self, MortarError> {
        let fixed: [&dyn Fn(usize) -> bool; 2] = [&is_fixed, &is_always_fixed];
        let (mut tie, surfaces, matrices, q) = Self::made(name, slave, master, reference, fixed, options)?;
        tie.stages = Some(Box::new(Stages::new(surfaces, matrices, q, fixed)));
        Ok(tie)
    }

    /// The tie, the surfaces and integrals that it was made from, and positions at which they fit.
    fn made<S: Copy + Into<FacePiece>, M: Copy + Into<FacePiece>>(
        name: &str,
        slave: &[S],
        master: &[M],
        reference: &[f64],
        [is_fixed, is_always_fixed]: [&dyn Fn(usize) -> bool; 2],
        options: TieOptions,
    ) -> Result<(Self, [ContactSurface; 2], MortarMatrices, Vec<f64>), MortarError> {
        let (slave, slave_faces) = Faces::surface("slave", slave, reference)?;
        let (master, master_faces) = Faces::surface("master", master, reference)?;
        let faces = [&slave_faces, &master_faces];
        slave.check_disjoint(&master)?;
        let length = slave.length_scale();
        let reach = options.reach.unwrap_or_else(|| length.max(master.length_scale()));
        let range = GapRange { min: -reach, max: reach };
        let mut q = reference.to_vec();
        let mut largest_gap = None;
        let mut moved = false;
        let mut pass = 0;
        let (rows, SurfaceCoverage { covered, area, .. }, matrices) = loop {
            let segments = segment_surfaces(&slave, &master, &q, range)?;
            let coverage = segments.check(&master, &q, CheckExtent::Near)?;
            if let Some(fault) = coverage.faults.first() {
                return Err(MortarError::Coverage { count: coverage.faults.len(), facet: fault.slave_facet });
            }
            let matrices = MortarMatrices::assemble(&slave, &master, faces, &q, &segments, options.space);
            if matrices.weights.iter().all(|w| *w <= 0.0) {
                return Err(MortarError::Apart { reach });
            }
            let rows = constraint_rows(&slave, &master, &matrices, is_fixed);
            if rows.is_empty() {
                return Err(MortarError::AllFixed);
            }
            let gap = rows.iter().map(|row| row.largest_gap(&q)).fold(0.0, f64::max);
            let first_gap = *largest_gap.get_or_insert(gap);
            if options.interface == Interface::Move && first_gap > CLOSED * length && pass < PASSES {
                fit::close(&rows, length, &mut q)?;
                slave_faces.follow(&mut q);
                moved = true;
                pass += 1;
                if pass == PASSES {
                    break (rows, coverage, matrices);
                }
            } else {
                break (rows, coverage, matrices);
            }
        };
        let largest_gap = largest_gap.unwrap_or(0.0);
        let closed = largest_gap <= CLOSED * length || options.interface != Interface::Keep;
        let mut tie = Self {
            name: name.to_owned(),
            nodes: Vec::new(),
            slots: Vec::new(),
            form: options.form,
            closed,
            stages: None,
            surfaces: slave.nodes().iter().chain(master.nodes()).copied().collect(),
            length_scale: length,
            moved: Vec::new(),
            largest_gap,
            covered,
            area,
        };
        if moved {
            let place = |node: u32| std::array::from_fn(|i| q[3 * node as usize + i]);
            tie.moved = rows.iter().map(|row| (row.node, place(row.node))).collect();
        }
        for row in &constraint_rows(&slave, &master, &matrices, is_always_fixed) {
            let components = (0..3).filter(|&c| row.kept[c]);
            tie.slots.extend(components.map(|c| Slot { node: row.node, component: c as u8, weight: row.weight }));
        }
        tie.arrange(rows, &slave, &q);
        Ok((tie, [slave, master], matrices, q))
    }

    /// Takes these rows, at positions in which the surfaces are as they are to stay.
    fn arrange(&mut self, rows: Vec<ConstraintRow>, slave: &ContactSurface, q: &[f64]) {
        let node = |row: ConstraintRow| {
            let wanted = self.form == TieForm::FrameInvariant && row.is_free;
            let frame = wanted.then(|| NodeFrame::new(slave, row.local_node, &row, q));
            let target = match &frame {
                _ if self.closed => [0.0; 3],
                Some(frame) => frame.values(&frame.at(q)),
                None => row.gap(q),
            };
            let place = |c: usize| self.slots.binary_search_by_key(&(row.node, c as u8), |s| (s.node, s.component));
            let slots = (0..3).filter(|&c| row.kept[c]).filter_map(|c| Some(place(c).ok()? as u32)).collect();
            TiedNode { row, frame, target, slots }
        };
        self.nodes = rows.into_iter().map(node).collect();
    }

    /// New reference positions of slave nodes; empty unless the interface had to be moved.
    pub fn moved(&self) -> &[(u32, [f64; 3])] {
        &self.moved
    }

    /// Largest gap vector of the meshes as they were given, divided by the integral of its multiplier function: a
    /// length.
    pub fn largest_initial_gap(&self) -> f64 {
        self.largest_gap
    }

    /// Area of the slave surface (its image in the segmentation planes) that is tied.
    pub fn tied_area(&self) -> f64 {
        self.covered
    }

    /// [`Self::tied_area`] over the area of the whole slave surface: below 1 where the slave overhangs or the surfaces lie farther apart than the reach.
    pub fn tied_share(&self) -> f64 {
        self.covered / self.area
    }

    /// Global slave nodes that have a multiplier, ascending.
    pub fn tied_nodes(&self) -> impl ExactSizeIterator<Item = u32> {
        self.nodes.iter().map(|n| n.row.node)
    }

    /// Traction that the master exerts on the slave at each of [`MeshTie::tied_nodes`] for the multipliers of all
    /// slots at positions `q`. Nodal values of `sum_A phi_A t_A`.
    pub fn tractions(&self, q: &[f64], multipliers: &[f64]) -> Vec<[f64; 3]> {
        self.nodes.iter().map(|node| node.traction(q, multipliers)).collect()
    }
}
