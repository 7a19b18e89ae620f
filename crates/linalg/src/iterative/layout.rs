//! Which equation is which component of which node, and the blocks of the matrix in this numbering.

use super::bsr::Bsr;
use crate::{EquationPlace, SparsityPattern};

/// Equations of nodes come first, three each, with or without an equation in the system; those of multipliers and all others follow.
#[derive(Debug, Default)]
pub(crate) struct Layout {
    /// Place of each equation among `3 * nodes + others`.
    pub place: Vec<u32>,
    pub positions: Vec<[f64; 3]>,
    /// Which components of a node have an equation.
    pub free: Vec<[bool; 3]>,
    /// Body of each node.
    pub labels: Vec<u32>,
    /// Slot of each other equation, by numbers from zero; `None` of one that is no multiplier.
    pub slots: Vec<Option<u32>>,
    /// Equation of each component, [`crate::NONE`] if it has none.
    pub equations: Vec<[u32; 3]>,
}

impl Layout {
    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.positions.len()
    }

    /// Length of vectors in this numbering.
    pub fn len(&self) -> usize {
        3 * self.nodes() + self.slots.len()
    }

    /// Sets the layout from the places of the equations. Whether anything but positions has changed.
    pub fn set(&mut self, equations: &mut dyn ExactSizeIterator<Item = EquationPlace>) -> bool {
        let before =
            (std::mem::take(&mut self.place), std::mem::take(&mut self.labels), std::mem::take(&mut self.slots));
        self.positions.clear();
        self.free.clear();
        self.equations.clear();
        let (mut last_node, mut last_slot, mut slots) = (None, None, 0);
        let mut others = Vec::new();
        for (equation, place) in equations.enumerate() {
            match place {
                EquationPlace::Node { body, node, component, position } => {
                    if last_node != Some(node) {
                        last_node = Some(node);
                        self.positions.push(position);
                        self.free.push([false; 3]);
                        self.labels.push(body);
                        self.equations.push([crate::NONE; 3]);
                    }
                    let (k, component) = (self.nodes() - 1, usize::from(component));
                    self.free[k][component] = true;
                    self.equations[k][component] = equation as u32;
                    self.place.push((3 * k + component) as u32);
                }
                EquationPlace::Multiplier { pair, slot } => {
                    if last_slot != Some((pair, slot)) {
                        last_slot = Some((pair, slot));
                        slots += 1;
                    }
                    others.push(equation);
                    self.slots.push(Some(slots - 1));
                    self.place.push(0);
                }
                EquationPlace::Other => {
                    others.push(equation);
                    self.slots.push(None);
                    self.place.push(0);
                }
            }
        }
        let first = 3 * self.nodes();
        others.iter().enumerate().for_each(|(k, &equation)| self.place[equation] = (first + k) as u32);
        before.0 != self.place || before.1 != self.labels || before.2 != self.slots
    }

    /// Writes a vector in this numbering; zero where there is no equation.
    pub fn gather(&self, v: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.resize(self.len(), 0.0);
        self.place.iter().zip(v).for_each(|(&place, v)| out[place as usize] = *v);
    }

    /// Back.
    pub fn scatter(&self, v: &[f64], out: &mut [f64]) {
        self.place.iter().zip(out).for_each(|(&place, out)| *out = v[place as usize]);
    }

    /// The blocks between nodes that the pattern has, without values. The pattern is symmetric: the rows of a node's columns are the columns of its rows.
    pub fn block_pattern(&self, pattern: &SparsityPattern) -> Bsr<f64, 3, 3> {
        let nodes = self.nodes();
        let mut k = Bsr::empty(nodes);
        let mut near: Vec<u32> = Vec::new();
        for (node, equations) in self.equations.iter().enumerate() {
            near.clear();
            near.push(node as u32);
            for &equation in equations.iter().filter(|&&equation| equation != crate::NONE) {
                for &row in pattern.column(equation as usize) {
                    let other = self.place[row as usize] / 3;
                    if (other as usize) < nodes && near.last() != Some(&other) {
                        near.push(other);
                    }
                }
            }
            near.sort_unstable();
            near.dedup();
            k.indices.extend_from_slice(&near);
            k.starts.push(k.indices.len());
        }
        k.blocks = vec![[[0.0; 3]; 3]; k.indices.len()];
        k
    }

    /// The slave node of each other equation, by the groups of the pattern; [`crate::NONE`] if it has none.
    pub fn slaves(&self, pattern: &SparsityPattern) -> Vec<u32> {
        let mut out = vec![crate::NONE; self.slots.len()];
        let Some(groups) = pattern.groups() else { return out };
        let first = 3 * self.nodes() as u32;
        let of_node =
            |(group, place): (&u32, &u32)| (*group != crate::NONE && *place < first).then(|| (*group, place / 3));
        let mut nodes: Vec<(u32, u32)> = groups.iter().zip(&self.place).filter_map(of_node).collect();
        nodes.sort_unstable();
        for (group, &place) in groups.iter().zip(&self.place).filter(|(_, place)| **place >= first) {
            if let Ok(at) = nodes.binary_search_by_key(group, |(group, _)| *group) {
                out[(place - first) as usize] = nodes[at].1;
            }
        }
        out
    }
}
