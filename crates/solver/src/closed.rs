//! Entries on the diagonals of rows of slots: the compliance of closed ones (theory/constraints#compliance), and what stands in the rows of others.

use crate::assembly::System;
use crate::rows::{COMPLIANCE, ClosedDiagonal};
use crate::{Model, StepError};
use stoss_linalg::{LinalgError, NONE};
use stoss_term::Auxiliary;

impl System {
    /// Where the compliance of closed slots goes: of pressures, and of the multipliers of friction, which are the first two auxiliaries.
    pub fn set_closed_diagonal(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        self.closed_diagonal.clear();
        for ((equations, active), pair) in self.slot_equation.iter().zip(active).zip(&model.contacts) {
            // Between rigid bodies in statics there is no stiffness to measure it by.
            if pair.unilateral().is_none() || pair.complementarity <= 0.0 {
                continue;
            }
            let term = &pair.term;
            let of_friction = if term.has_friction() { 2 } else { 0 };
            let kinds = term.auxiliaries().iter().take(of_friction);
            let multipliers = kinds.filter(|kind| matches!(kind, Auxiliary::Constraint)).count() as u32;
            let slots = equations.iter().zip(active).enumerate();
            for (slot, (&first, _)) in slots.filter(|&(_, (&first, &active))| first != NONE && active) {
                let weight = term.slot_weight(slot);
                let softness = weight / pair.complementarity;
                for k in 0..=multipliers {
                    let equation = first + k;
                    let missing = LinalgError::EntryNotInPattern { stencil: 0, row: equation, column: equation };
                    let position = self.pattern.position(equation, equation).ok_or(missing)?;
                    let softness = if k == 0 { -softness } else { softness };
                    self.closed_diagonal.push(ClosedDiagonal { position: position as u32, softness, weight });
                }
            }
        }
        Ok(())
    }

    /// After a matrix that is singular: gives rows of closed slots a compliance from now on, and in the present matrix. False if they have one, or if there are none.
    pub fn soften_singular(&mut self) -> bool {
        if self.rows.compliance > 0.0 || self.closed_diagonal.is_empty() {
            return false;
        }
        self.rows.compliance = COMPLIANCE;
        self.soften_closed();
        true
    }

    /// Gives the rows of closed slots their compliance, in the tangent only: rows that depend on each other can be solved then, and the solution is the same.
    pub fn soften_closed(&mut self) {
        let compliance = self.rows.compliance;
        if compliance > 0.0 {
            for &ClosedDiagonal { position, softness, weight } in &self.closed_diagonal {
                // With inertia, that of a short step too, as soft as its rows are then.
                let softness = match self.has_rates {
                    true => softness.signum() * weight * weight / self.slot_stiffness,
                    false => softness,
                };
                self.values[position as usize] += compliance * softness;
            }
        }
    }

    /// Writes the rows of inactive slots, which say that a multiplier stays: a compliance on the diagonal that the slot would have if it were closed, so that the row has the units of
    /// a row that is. The factors of such a matrix may serve when the slot has closed ([`LinearSolver::solve_nearby`]), and the row counts then as others do.
    pub fn fill_inactive(&mut self) {
        if self.tangents == 0 {
            let diagonal = (0..self.numbering.free.len() as u32).filter_map(|i| self.solid_pattern.position(i, i));
            let largest = diagonal.map(|at| self.solid_values[at].abs()).fold(0.0, f64::max);
            self.slot_stiffness = if largest > 0.0 { largest } else { 1.0 };
        }
        for &(at, weight) in &self.inactive_diagonal {
            let stiffness = self.slot_stiffness;
            self.values[at as usize] =
                if weight > 0.0 && weight.is_finite() { weight * weight / stiffness } else { stiffness };
        }
    }
}
