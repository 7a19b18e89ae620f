//! Node-to-surface contact as a contact method.
//!
//! What the traits of a method ask for is in its children: equations in `assembly`, which slots are closed in `active_set`, pairings in `pairing`, gap gradients in
//! `gradient`, enforcement in `normal`, friction in `friction`, what goes from step to step in `history`.

mod active_set;
mod assembly;
mod friction;
mod gradient;
mod history;
mod normal;
mod pairing;

use crate::friction::SurfaceFriction;
use crate::kinematics::Gap;
use crate::normal::NormalEnforcement;
use crate::options::{ConstraintForm, NodeToSurfaceOptions};
use crate::slave::Slave;
use crate::slot::Slot;
use stoss_contact::{ContactError, ContactLine, ContactSurface, FacetNodes, MasterSearch, position};
use stoss_geometry::Patch;
use stoss_term::{ReferenceGap, Share, SlotReport, Term};

/// Slave nodes against master facets, with or without friction, one pressure a slave node: traction on the node's reference area or, of a line, force per reference
/// length.
#[derive(Clone, Debug)]
pub struct NodeToSurface {
    name: String,
    pub(crate) share: Share,
    pub(crate) slave: Slave,
    pub(crate) search: MasterSearch,
    pub(crate) constraint: ConstraintForm,
    /// Steps after which a gap that was held settles; `None`: gaps are closed.
    hold: Option<u32>,
    /// Whether gaps that close in the present step are held.
    pub(crate) holds: bool,
    /// Whether a node that is left behind the surface stays there: with inertia to push it out is work that no force does. In statics no energy is at stake, and what overlaps is pushed out.
    pub(crate) leaves: bool,
    pub(crate) normal: NormalEnforcement,
    /// Gaps of slots, of the surface and of the facets' extensions, count from these.
    pub(crate) reference_gap: ReferenceGap,
    pub(crate) slots: Vec<Slot>,
    /// Positions at `n`, for pairing.
    pub(crate) q_n: Vec<f64>,
    /// A typical edge of the master.
    pub(crate) length: f64,
    pub(crate) friction: Option<SurfaceFriction>,
    /// Serves coordinate augmentation ([`crate::augmented`]): the coordinates at the midpoint are the mean of those at the ends.
    pub(crate) augmented: bool,
}

impl NodeToSurface {
    /// The contact from facets (global nodes, numbered outward) and reference positions (`3 * nodes`).
    ///
    /// # Errors
    /// Empty or degenerate surfaces, shared nodes, options out of range, a penalty with the modified constraint.
    pub fn new<S: Copy + Into<FacetNodes>, M: Copy + Into<FacetNodes>>(
        name: &str,
        slave_facets: &[S],
        master_facets: &[M],
        reference: &[f64],
        options: NodeToSurfaceOptions,
    ) -> Result<Self, ContactError> {
        let slave = Slave::Surface(Box::new(ContactSurface::new("slave", slave_facets, reference)?));
        Self::of(name, slave, master_facets, reference, options)
    }

    /// A contact as of [`Self::new`] with the nodes of a string or of a beam as the slave side. They may touch from any side.
    ///
    /// # Errors
    /// The errors of [`Self::new`] but for the slave's facets.
    pub fn of_line<M: Copy + Into<FacetNodes>>(
        name: &str,
        slave: ContactLine,
        master_facets: &[M],
        reference: &[f64],
        options: NodeToSurfaceOptions,
    ) -> Result<Self, ContactError> {
        Self::of(name, Slave::Line(slave), master_facets, reference, options)
    }

    fn of<M: Copy + Into<FacetNodes>>(
        name: &str,
        slave: Slave,
        master_facets: &[M],
        reference: &[f64],
        options: NodeToSurfaceOptions,
    ) -> Result<Self, ContactError> {
        let master = ContactSurface::new("master", master_facets, reference)?;
        slave.check_disjoint(&master)?;
        let length = master.length_scale();
        let slots = vec![Slot::FREE; slave.nodes().len()];
        Ok(Self {
            name: name.to_owned(),
            share: Share::default(),
            search: MasterSearch::new(master, reference, options.search)?,
            constraint: options.constraint,
            hold: options.hold,
            holds: false,
            leaves: true,
            normal: NormalEnforcement::new(options)?,
            reference_gap: ReferenceGap::default(),
            slots,
            q_n: Vec::new(),
            length,
            friction: None,
            augmented: false,
            slave,
        })
    }

    /// The contact with facets of the master's body beside the rims of the master ([`stoss_contact::beside_rims`]).
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub fn with_sides(mut self, sides: &[FacetNodes], reference: &[f64]) -> Result<Self, ContactError> {
        if !sides.is_empty() {
            let master = self.search.surface().with_sides(sides, reference)?;
            self.slave.check_disjoint(&master)?;
            self.search = MasterSearch::new(master, reference, *self.search.options())?;
        }
        Ok(self)
    }

    pub(crate) fn node(&self, slot: usize) -> u32 {
        self.slave.nodes()[slot]
    }

    pub(crate) fn patch(&self, facet: u32, q: &[f64]) -> Patch {
        self.search.surface().patch(facet, q)
    }

    /// Projection of a slot's node on an extended facet.
    pub(crate) fn gap(&self, slot: usize, facet: u32, q: &[f64]) -> Result<Gap, ContactError> {
        let node = self.node(slot);
        Gap::from_centre(&position(q, node), &self.patch(facet, q)).ok_or(ContactError::Projection { node, facet })
    }

    /// The gap to an extended facet beyond the reference gap of the slot.
    pub(crate) fn gap_beyond(&self, slot: usize, facet: u32, q: &[f64]) -> Result<f64, ContactError> {
        Ok(self.gap(slot, facet, q)?.gap - self.reference_gap.of(slot))
    }
}

impl NodeToSurface {
    pub(super) fn slot_reports(&self, q: &[f64]) -> Vec<SlotReport> {
        let view = self.search.at(q);
        let current = self.slave.weights_at(q);
        (0..self.slots.len())
            .map(|slot| {
                let point = self.closest(&view, slot, q);
                let reference_gap = self.reference_gap.of(slot);
                SlotReport {
                    node: self.node(slot),
                    weight: self.slot_weight(slot),
                    means: Vec::new(),
                    per_current_area: self.slot_weight(slot) / current[slot],
                    area: current[slot],
                    gap: point.pairing.map(|_| point.gap + reference_gap),
                    normal: point.normal.into(),
                    feature: point.feature.name(),
                    reference_gap: self.slots[slot].kept + reference_gap,
                    friction: self.last_friction(slot),
                }
            })
            .collect()
    }
}
