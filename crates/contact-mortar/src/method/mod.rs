//! Mortar contact as a contact method.
//!
//! What the traits of a method ask for is in its children: integrals that follow the iterate in `integrate`, equations in `assembly`, force and row of a slot in `normal`,
//! friction in `friction`, which rows are closed in `active_set`, what goes from step to step in `history`, reports in `report`, passages through the master in `tunnelling`.

mod active_set;
mod assembly;
mod friction;
mod history;
mod integrate;
mod normal;
mod prescribed;
mod report;
mod tunnelling;

use crate::factors::Factors;
use crate::friction::SurfaceFriction;
use crate::options::{Integrals, MortarOptions, NEARNESS};
use crate::rows::{Row, rows};
use crate::secant::Secant;
use crate::sharp_edges::{has_sharp_edges, smooth_parts, unit_normals};
use crate::slot::Slot;
use crate::state::{Integrated, StepState, Surfaces};
use crate::surfaces::{CheckExtent, SurfaceCoverage, SurfaceSegmentation, thickness};
use crate::weights::Integration;
use crate::{Faces, MortarError};
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashMap};
use stoss_contact::{ContactError, ContactSurface, SurfaceTree, position};
use stoss_reference_element::FacePiece;
use stoss_segmentation::FacetSegmentation;
use stoss_term::{GradientRule, HeldNodes, ReferenceGap, Share, StepContext};

/// Penetration at which points take no part any more, in lengths of slave facets, where a surface has sharp edges or both sides of its body: beyond that other sides
/// are.
const DEEPEST: f64 = 1.0;
/// A row of which less than this part of the reference area is opposite the master carries no multiplier in the step: the pressure would be a force divided by next
/// to nothing.
const CARRIED: f64 = 0.02;
/// Part of the reference area that is opposite the master below which a row has no mean gap.
const COVERED: f64 = 1e-8;
/// A gap of more than this part of a facet is closed and not held: it would be felt in the depth.
const LARGEST_HELD: f64 = 0.1;
/// A penetration at the start of a step that is less than this, in lengths of facets, is what the iteration left.
const NO_PENETRATION: f64 = 1e-11;
/// A node is free along its normal if the part of the normal in free components is longer than this; it would have to slide ten times the gap to close it.
const FREE_ALONG_NORMAL: f64 = 0.1;

/// Slave surface against master surface with one pressure (traction) for each side of a slave node and weighted gaps (theory/mortar#eq-gap) whose integrals move:
/// the weighted gap `Phi_A(q)` is a function of the positions alone, see theory/mortar#gap.
///
/// The constraint of a closed row is `Phi_A(q_np1) = 0`, or a distance that is kept times the covered area, under every rule. Under [`GradientRule::EndPoint`] the force is `p grad Phi_A(q_np1)`, under
/// [`GradientRule::Midpoint`] and [`GradientRule::DiscreteGradient`] the discrete gradient about the middle of the step: it has neither resultant nor moment about `q_m`, for
/// any gap, and its work is the change of the weighted gap, counted from the distance at the middle (theory/mortar#distance). So the energy changes by what closing gaps cost, and by nothing else.
///
/// A row of which less than a fiftieth is opposite the master at the start of a step carries no multiplier in it.
///
/// What a step decides ([`StepContext`], anew at each `begin`):
/// * with rates a penetration that a node has at its start is kept, for to push it out would give energy; in statics gaps are closed;
/// * under [`GradientRule::EndPoint`] the force of dynamics is the gradient of the weighted gap, which does no work on a closed row. Statics has the gradient at fixed weights: where facets are large against
///   the depth the other one has limit points, at which nodes slide out of the overlap instead of carrying;
/// * whether near points at sharp edges count more than far ones ([`crate::Factors::nearness`]): in statics;
/// * crosspoints: slave nodes whose motion along their normal is given by something else that acts at present ([`stoss_term::HeldNodes::given`]), on facets that have other nodes too, have no multiplier. Their functions go to
///   the other nodes of the facet: beside a finer master they would be harmless, beside a coarser one there would be more pressures than motions. A surface that is given as a whole (a rigid tool)
///   keeps its multipliers.
#[derive(Clone, Debug)]
pub struct MortarContact {
    name: String,
    share: Share,
    /// Rows of this share.
    own: Vec<bool>,
    pub(crate) surfaces: Surfaces,
    /// Tree over the master.
    tree: SurfaceTree,
    pub(crate) options: MortarOptions,
    pub(crate) rule: GradientRule,
    step_size: f64,
    /// Whether the step has inertia.
    has_rates: bool,
    /// Whether statics weighs near points more: a surface has sharp edges, and no factors were given.
    weighs_near_points: bool,
    /// Stress per length, see [`MortarContact::with_stiffness`].
    pub(crate) stiffness: f64,
    /// Distances that rows keep by themselves.
    pub(crate) reference_gap: ReferenceGap,
    /// Steps that each row has been closed without a break; history.
    pub(crate) closed_steps: Vec<u32>,
    pub(crate) step: StepState,
    /// Integrals at the end of the step, and at its middle where the rule asks for it. With frozen integrals both have the weights of the step.
    pub(crate) end: Integrated,
    pub(crate) middle: Integrated,
    pub(crate) friction: Option<SurfaceFriction>,
    /// What second derivatives of the weights add to the tangent, one a row.
    secants: Vec<Secant>,
}

impl MortarContact {
    /// The contact from facets (global nodes, numbered outward) and reference positions (`3 * nodes`). Of facets that are pieces of quadratic faces gaps are
    /// those of the faces.
    ///
    /// # Errors
    /// Empty or degenerate surfaces, shared nodes.
    pub fn new<S: Copy + Into<FacePiece>, M: Copy + Into<FacePiece>>(
        name: &str,
        slave_facets: &[S],
        master_facets: &[M],
        reference: &[f64],
        options: MortarOptions,
    ) -> Result<Self, ContactError> {
        let (slave, slave_faces) = Faces::surface("slave", slave_facets, reference)?;
        let (master, master_faces) = Faces::surface("master", master_facets, reference)?;
        let faces = [slave_faces, master_faces];
        slave.check_disjoint(&master)?;
        let [normals, master_normals] = [&slave, &master].map(|surface| unit_normals(surface, reference));
        let sharp = has_sharp_edges(&slave, &normals) || has_sharp_edges(&master, &master_normals);
        let thinner = thickness(&slave, reference).min(thickness(&master, reference));
        let h = slave.length_scale();
        let factors = Factors {
            facing: true,
            deepest: if sharp || thinner.is_finite() { thinner.min(DEEPEST * h) } else { f64::INFINITY },
            nearness: 0.0,
        };
        let integration = Integration { space: options.space, factors };
        let (smooth_parts, smooth_part_count) = smooth_parts(&master, &master_normals);
        let rows = rows(&slave, &normals, smooth_part_count);
        let without = vec![false; slave.nodes().len()];
        let secants = vec![Secant::default(); rows.len()];
        let closed_steps = vec![0; rows.len()];
        Ok(Self {
            reference_gap: ReferenceGap::default(),
            closed_steps,
            name: name.to_owned(),
            share: Share::default(),
            own: vec![true; rows.len()],
            tree: SurfaceTree::new(&master, reference)?,
            surfaces: Surfaces {
                slave,
                master,
                faces,
                rows,
                smooth_parts,
                smooth_part_count,
                normals,
                planes: HashMap::new(),
                without,
                integration,
            },
            rule: GradientRule::EndPoint,
            step_size: 0.0,
            has_rates: false,
            weighs_near_points: sharp,
            stiffness: 0.0,
            step: StepState { q_n: reference.to_vec(), ..StepState::default() },
            end: Integrated::default(),
            middle: Integrated::default(),
            friction: None,
            secants,
            options,
        })
    }

    /// What differs from step to step beside positions.
    fn take(&mut self, step: &StepContext<'_>) {
        (self.rule, self.step_size, self.has_rates) = (step.rule, step.dt, step.rates);
        if self.weighs_near_points {
            self.surfaces.integration.factors.nearness = if step.rates { 0.0 } else { NEARNESS / self.length() };
        }
        self.surfaces.without = self.crosspoints(step.held);
        self.begin_friction_step(step);
    }

    /// Slave nodes without a multiplier beside what else acts.
    fn crosspoints(&self, support: &HeldNodes) -> Vec<bool> {
        let slave = &self.surfaces.slave;
        let fixed: Vec<bool> =
            (slave.nodes().iter().enumerate()).map(|(a, &n)| self.is_held_along_normal(a, support.given(n))).collect();
        let mut without = vec![false; fixed.len()];
        for node in 0..fixed.len() {
            let mut beside = slave.facets_around(node).iter().flat_map(|&f| slave.local_facets()[f as usize]);
            without[node] = fixed[node] && beside.any(|other| !fixed[other as usize]);
        }
        // A facet must keep a function to hand the others to.
        for facet in slave.local_facets() {
            if facet.iter().all(|&n| without[n as usize]) {
                facet.iter().for_each(|&n| without[n as usize] = false);
            }
        }
        without
    }

    /// Takes the rows of a share. They are dealt out by places: the derivatives of integrals over a facet are needed by all its corners.
    fn take_share(&mut self, share: Share) -> Share {
        let Surfaces { slave, faces, rows, .. } = &self.surfaces;
        let first = |row: &Row| faces[0].nodes(slave, row.facets[0].0)[0];
        let mut begin: BTreeMap<u32, u64> = BTreeMap::new();
        rows.iter().for_each(|row| *begin.entry(first(row)).or_default() += 1);
        let share =
            share.by_place(begin.into_iter().map(|(node, rows)| (node, position(&self.step.q_n, node).into(), rows)));
        self.own = rows.iter().map(|row| share.has(&[first(row)])).collect();
        self.share = share.clone();
        share
    }

    /// Tells the stress per length, Young's modulus over the length of a facet, that compliances are measured by. Without it there are none.
    #[must_use]
    pub fn with_stiffness(mut self, stiffness: f64) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Tells which planes of symmetry nodes (global numbers) lie in: the bodies go on behind them, mirrored. A bit for each plane, the first three for those across x, y, z, in which the normals of
    /// rows lie. Segments end at the sides of slave facets there, and not at those of master facets, which projection moves off the plane.
    #[must_use]
    pub fn with_symmetry(mut self, planes: impl IntoIterator<Item = (u32, u8)>) -> Self {
        self.surfaces.planes = planes.into_iter().collect();
        let nodes = self.surfaces.slave.nodes();
        for row in &mut self.surfaces.rows {
            let planes = self.surfaces.planes.get(&nodes[row.local]).copied().unwrap_or_default();
            row.across = [0, 1, 2].map(|axis| planes & (1 << axis) != 0);
        }
        self
    }

    /// Whether prescribed components leave a slave node (local number) no motion along its reference normal.
    pub fn is_held_along_normal(&self, local: usize, prescribed: [bool; 3]) -> bool {
        let sum = self.reference_normal(local);
        let free: f64 = (0..3).filter(|&i| !prescribed[i]).map(|i| sum[i] * sum[i]).sum();
        free.sqrt() <= FREE_ALONG_NORMAL * sum.norm()
    }

    /// The sum of the reference normals of the facets around a slave node.
    fn reference_normal(&self, local: usize) -> Vector3<f64> {
        let around = self.surfaces.slave.facets_around(local).iter();
        around.map(|&f| self.surfaces.normals[f as usize]).sum()
    }

    /// Whether a prescribed component takes a motion across the reference normal from a slave node (local number).
    pub fn is_held_across_normal(&self, local: usize, prescribed: [bool; 3]) -> bool {
        let n = self.reference_normal(local);
        (0..3).any(|i| prescribed[i] && n.norm_squared() - n[i] * n[i] > FREE_ALONG_NORMAL.powi(2) * n.norm_squared())
    }

    /// The slave surface.
    pub fn slave(&self) -> &ContactSurface {
        &self.surfaces.slave
    }

    /// The master surface.
    pub fn master(&self) -> &ContactSurface {
        &self.surfaces.master
    }

    /// Factors of the integrands of these surfaces.
    pub fn factors(&self) -> Factors {
        self.surfaces.integration.factors
    }

    /// The method with other factors of the integrand, for tests and comparisons; the same in statics and dynamics.
    #[must_use]
    pub fn with_factors(mut self, factors: Factors) -> Self {
        self.surfaces.integration.factors = factors;
        self.weighs_near_points = false;
        self
    }

    /// Segments at the end of the step, where integrals are there; `None` before the first step.
    pub fn segments(&self) -> Option<SurfaceSegmentation> {
        let range = self.step.range?;
        let facets: Option<Vec<FacetSegmentation>> = self.end.segments.iter().cloned().collect();
        facets.filter(|facets| !facets.is_empty()).map(|facets| SurfaceSegmentation { facets, range })
    }

    /// Covered part `int phi_A dA` of every slot, an area.
    pub fn supports(&self) -> Vec<f64> {
        self.end.slots.iter().map(|s| s.support).collect()
    }

    /// Coverage of the present segments, which are those at `q_np1`; `None` before the first step.
    ///
    /// # Errors
    /// Facets that cannot be segmented.
    pub fn coverage(&self, q_np1: &[f64]) -> Result<Option<SurfaceCoverage>, MortarError> {
        let present = self.segments();
        let check =
            |s: SurfaceSegmentation| s.check_with(&self.surfaces.master, Some(&self.tree), q_np1, CheckExtent::Near);
        present.map(check).transpose()
    }

    /// Whether forces are gradients at fixed weights.
    pub(crate) fn has_fixed_weights(&self) -> bool {
        self.rule == GradientRule::EndPoint && !self.has_rates
    }

    pub(crate) fn is_frozen(&self) -> bool {
        self.options.integrals == Integrals::Frozen
    }

    /// Whether forces are evaluated at the middle of the step.
    pub(crate) fn has_middle(&self) -> bool {
        match self.rule {
            GradientRule::StartPoint | GradientRule::EndPoint | GradientRule::EndPointMean => false,
            GradientRule::Midpoint | GradientRule::DiscreteGradient => true,
        }
    }

    /// Whether the tangent lacks second derivatives of the weights, as where forces are gradients of the weighted gap and integrals move.
    pub(crate) fn learns(&self) -> bool {
        !self.is_frozen() && (self.has_middle() || (self.rule == GradientRule::EndPoint && self.has_rates))
    }

    /// Slots whose weights friction has: those of the middle of the step, or of the end if the rule takes forces there.
    pub(crate) fn friction_slots(&self) -> &[Slot] {
        if self.has_middle() { &self.middle.slots } else { &self.end.slots }
    }

    pub(crate) fn length(&self) -> f64 {
        self.surfaces.slave.length_scale()
    }
}
