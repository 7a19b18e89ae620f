//! Equations of the free displacement components.

use crate::switches::Acting;
use crate::{Embedding, Model};
use stoss_linalg::NONE;

/// Which component of which node has which equation. Prescribed components and components of nodes that belong to no element
/// have none.
#[derive(Clone, Debug)]
pub(crate) struct Numbering {
    /// Equation of each component, `NONE` if it has none; `3 * nodes` entries.
    pub equation: Vec<u32>,
    /// Component of each equation.
    pub free: Vec<u32>,
}

impl Numbering {
    /// The numbering of the components of elements and of what parts own, without those that are prescribed at present.
    pub fn of(model: &Model, acting: &Acting) -> Self {
        let mut blocked = vec![true; model.reference.len()];
        for body in &model.bodies {
            for &node in body.solid.elements().iter().flatten() {
                blocked[3 * node as usize..3 * node as usize + 3].fill(false);
            }
        }
        for part in &model.parts {
            for vector in part.own_vectors() {
                blocked[3 * vector as usize..][..part.width()].fill(false);
            }
        }
        for (prescription, _) in model.prescriptions.iter().zip(&acting.prescriptions).filter(|(_, acts)| **acts) {
            for &node in &prescription.nodes {
                for &component in &prescription.components {
                    blocked[3 * node as usize + component as usize] = true;
                }
            }
        }
        Self::new(blocked.len(), |c| blocked[c])
    }

    pub fn new(components: usize, prescribed: impl Fn(usize) -> bool) -> Self {
        let mut equation = vec![NONE; components];
        let mut free = Vec::with_capacity(components);
        for (component, slot) in equation.iter_mut().enumerate() {
            if !prescribed(component) {
                *slot = free.len() as u32;
                free.push(component as u32);
            }
        }
        Self { equation, free }
    }

    /// Label of the node of each equation: the groups that the linear solver keeps together.
    pub fn groups(&self, label: impl Fn(u32) -> u32) -> Vec<u32> {
        self.free.iter().map(|&component| label(component / 3)).collect()
    }

    /// Whether a component of a node is free, of an embedded node whether one of its carriers' is.
    pub fn moves(&self, embedding: &Embedding, node: u32) -> bool {
        let free = |node: u32| (0..3).any(|i| self.equation[3 * node as usize + i] != NONE);
        embedding.carriers(node).map_or_else(|| free(node), |carriers| carriers.iter().any(|&(c, _)| free(c)))
    }

    /// Whether some components of a node have equations and others have none.
    pub fn is_held_in_part(&self, node: u32) -> bool {
        let free = (0..3).filter(|i| self.equation[3 * node as usize + i] != NONE).count();
        free == 1 || free == 2
    }

    /// Appends the equations of the three components of each node.
    pub fn node_equations(&self, nodes: &[u32], out: &mut Vec<u32>) {
        for &node in nodes {
            out.extend_from_slice(&self.equation[3 * node as usize..3 * node as usize + 3]);
        }
    }
}
