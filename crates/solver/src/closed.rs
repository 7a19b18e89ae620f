//! Entries on the diagonals of rows of slots: the compliance of closed ones (theory/constraints#compliance), and what stands in the rows of others.

use crate::assembly::System;
use crate::matrix::{Matrix, Slots, diagonal_of};
use crate::rows::{COMPLIANCE, ClosedDiagonal};
use crate::{Model, StepError};
use stoss_linalg::{LinalgError, NONE};
use stoss_term::Auxiliary;

impl Matrix {
    /// Where the compliance of closed slots goes: of pressures, and of the multipliers of friction, which are the first two auxiliaries.
    pub fn set_closed_diagonal(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        let mut closed = std::mem::take(&mut self.slots.closed);
        closed.clear();
        let Slots { equation, .. } = &self.slots;
        let mut has_closed = false;
        for ((equations, active), pair) in equation.iter().zip(active).zip(&model.contacts) {
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
                has_closed = true;
                for k in (0..=multipliers).filter(|k| self.is_own((first + k) as usize)) {
                    let equation = first + k;
                    let missing = LinalgError::EntryNotInPattern { stencil: 0, row: equation, column: equation };
                    let position = self.pattern.position(equation, equation).ok_or(missing)?;
                    let softness = if k == 0 { -softness } else { softness };
                    closed.push(ClosedDiagonal { position: position as u32, softness, weight });
                }
            }
        }
        (self.slots.closed, self.slots.has_closed) = (closed, has_closed);
        Ok(())
    }

    /// Gives the rows of closed slots their compliance, in the tangent only: rows that depend on each other can be solved then, and the solution is the same.
    pub fn soften_closed(&mut self, compliance: f64, has_rates: bool) {
        if compliance > 0.0 {
            for &ClosedDiagonal { position, softness, weight } in &self.slots.closed {
                // With inertia, that of a short step too, as soft as its rows are then.
                let softness = match has_rates {
                    true => softness.signum() * weight * weight / self.slots.stiffness,
                    false => softness,
                };
                self.values[position as usize] += compliance * softness;
            }
        }
    }

    /// Writes the rows of inactive slots, which say that a multiplier stays: a compliance on the diagonal that the slot would have if it were closed, so that the row has the units of
    /// a row that is. The factors of such a matrix may serve when the slot has closed ([`stoss_linalg::LinearSolver::solve_nearby`]), and the row counts then as others do. The `first` time in a step
    /// stiffness is measured.
    pub fn fill_inactive(&mut self, first: bool) {
        let Self { fixed, slots, .. } = self;
        if first {
            let count = self.numbering.free.len();
            let diagonal = diagonal_of(&fixed.pattern, &fixed.values, count, &self.shares);
            let largest = diagonal.into_iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            slots.stiffness = if largest > 0.0 { largest } else { 1.0 };
        }
        let stiffness = slots.stiffness;
        for &(at, weight) in &slots.inactive {
            self.values[at as usize] =
                if weight > 0.0 && weight.is_finite() { weight * weight / stiffness } else { stiffness };
        }
    }
}

impl System {
    /// Gives rows of closed slots a compliance from now on, and in the present matrix, after a matrix that is singular. False if they have one, or if there are
    /// none.
    pub fn soften_singular(&mut self) -> bool {
        if self.rows.compliance > 0.0 || !self.matrix.slots.has_closed {
            return false;
        }
        self.rows.compliance = COMPLIANCE;
        self.matrix.soften_closed(COMPLIANCE, self.present.has_rates);
        true
    }
}
