//! Ties of nodes that are prescribed in some stages of a run and free in others.

use super::MeshTie;
use super::rows::constraint_rows;
use crate::MortarMatrices;
use stoss_contact::ContactSurface;
use stoss_term::HeldNodes;

/// What rows are made from, and what they were made for last.
#[derive(Clone, Debug)]
pub(super) struct Stages {
    slave: ContactSurface,
    master: ContactSurface,
    matrices: MortarMatrices,
    /// Positions in which the surfaces are as they are to stay.
    q: Vec<f64>,
    /// Whether the motion of each component of each slave node is always given, and whether it is at present.
    always: Vec<bool>,
    now: Vec<bool>,
}

impl Stages {
    pub fn new(
        [slave, master]: [ContactSurface; 2],
        matrices: MortarMatrices,
        q: Vec<f64>,
        [is_fixed, is_always_fixed]: [&dyn Fn(usize) -> bool; 2],
    ) -> Self {
        let of = |is_fixed: &dyn Fn(usize) -> bool| -> Vec<bool> {
            let components = slave.nodes().iter().flat_map(|&node| (0..3).map(move |i| 3 * node as usize + i));
            components.map(is_fixed).collect()
        };
        let (now, always) = (of(is_fixed), of(is_always_fixed));
        Self { slave, master, matrices, q, always, now }
    }
}

impl MeshTie {
    /// Takes the multipliers of components that are prescribed at present away, and gives the others theirs.
    pub(super) fn follow_support(&mut self, support: &HeldNodes) {
        let Some(mut stages) = self.stages.take() else { return };
        let Stages { slave, master, matrices, q, always, now } = &mut *stages;
        let given = slave.nodes().iter().flat_map(|&node| support.prescribed(node));
        let given: Vec<bool> = given.zip(&*always).map(|(given, always)| given || *always).collect();
        if given != *now {
            *now = given;
            // Local numbers of slave nodes are the places of their global ones, which ascend.
            let is_fixed = |c: usize| {
                let local = slave.nodes().binary_search(&((c / 3) as u32));
                local.is_ok_and(|local| now[3 * local + c % 3])
            };
            let rows = constraint_rows(slave, master, matrices, is_fixed);
            self.arrange(rows, slave, q);
        }
        self.stages = Some(stages);
    }
}
