//! Where the equations of the global system are, for linear solvers that iterate.

use crate::assembly::System;
use crate::matrix::Matrix;
use crate::{Body, Model};
use stoss_linalg::{EquationPlace, NONE};

impl System {
    /// Tells the linear solver where the equations of the present pattern are, with the nodes at `q`.
    pub fn place_equations(&mut self, model: &Model, q: &[f64]) {
        let Self { matrix: Matrix { numbering, pattern, slots, .. }, solver, .. } = self;
        let free = numbering.free.len();
        let mut multipliers = vec![EquationPlace::Other; pattern.n() - free];
        for (pair, (equations, &width)) in slots.equation.iter().zip(&slots.width).enumerate() {
            for (slot, &first) in equations.iter().enumerate().filter(|(_, first)| **first != NONE) {
                let place = EquationPlace::Multiplier { pair: pair as u32, slot: slot as u32 };
                multipliers[first as usize - free..][..width as usize].fill(place);
            }
        }
        let place = |equation: usize| {
            let Some(&component) = numbering.free.get(equation) else { return multipliers[equation - free] };
            let (node, first) = (component / 3, 3 * (component as usize / 3));
            // Bodies have their nodes one after the other, parts come after them.
            let body = model.bodies.partition_point(|body| body.nodes.end <= node);
            match model.bodies.get(body).filter(|body| body.nodes.contains(&node)) {
                Some(_) => EquationPlace::Node {
                    body: body as u32,
                    node,
                    component: (component % 3) as u8,
                    position: [q[first], q[first + 1], q[first + 2]],
                },
                None => EquationPlace::Other,
            }
        };
        solver.place(&mut (0..pattern.n()).map(place));
        self.spread_equations();
    }

    /// Tells the linear solver on which ranks the rows of the present pattern are.
    pub fn spread_equations(&mut self) {
        if self.shares.is_shared() {
            self.solver.spread(&mut self.matrix.owners());
        }
    }

    /// Free components of nodes of bodies.
    pub fn elastic_components(&self, model: &Model) -> usize {
        let is_free = |component: &u32| self.matrix.numbering.equation[*component as usize] != NONE;
        let of_body = |body: &Body| (3 * body.nodes.start..3 * body.nodes.end).filter(is_free).count();
        model.bodies.iter().map(of_body).sum()
    }
}
