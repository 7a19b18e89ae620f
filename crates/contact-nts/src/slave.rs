//! The slave side: the nodes of a surface, or of a line.

use nalgebra::Vector3;
use stoss_contact::{ContactError, ContactLine, ContactSurface};

/// What the slave nodes belong to.
#[derive(Clone, Debug)]
pub(crate) enum Slave {
    Surface(Box<ContactSurface>),
    Line(ContactLine),
}

impl Slave {
    /// Global numbers, ascending: the slots in their order.
    pub fn nodes(&self) -> &[u32] {
        match self {
            Self::Surface(surface) => surface.nodes(),
            Self::Line(line) => line.nodes(),
        }
    }

    /// Reference area of each node; of a line its length.
    pub fn weights(&self) -> &[f64] {
        match self {
            Self::Surface(surface) => surface.nodal_areas(),
            Self::Line(line) => line.lengths(),
        }
    }

    /// [`Self::weights`] at positions `q`.
    pub fn weights_at(&self, q: &[f64]) -> Vec<f64> {
        match self {
            Self::Surface(surface) => surface.nodal_areas_at(q),
            Self::Line(line) => line.lengths_at(q),
        }
    }

    /// Outward unit normal at a node; a line has no outside.
    pub fn normal(&self, slot: usize, q: &[f64]) -> Option<Vector3<f64>> {
        match self {
            Self::Surface(surface) => Some(surface.node_normal(slot, q)),
            Self::Line(_) => None,
        }
    }

    pub fn length_scale(&self) -> f64 {
        match self {
            Self::Surface(surface) => surface.length_scale(),
            Self::Line(line) => line.length_scale(),
        }
    }

    /// Checks that the master has none of the nodes.
    pub fn check_disjoint(&self, master: &ContactSurface) -> Result<(), ContactError> {
        match self {
            Self::Surface(surface) => surface.check_disjoint(master),
            Self::Line(line) => match line.nodes().iter().find(|&&node| master.local_node(node).is_some()) {
                Some(&node) => Err(ContactError::SharedNode { node }),
                None => Ok(()),
            },
        }
    }
}
