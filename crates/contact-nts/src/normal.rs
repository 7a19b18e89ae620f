//! What the enforcement of the gaps of a surface keeps: multipliers of the augmented Lagrangian, their rounds.

use crate::options::{ConstraintForm, NodeToSurfaceOptions};
use stoss_contact::friction::Stiffening;
use stoss_contact::{ContactError, Enforcement};
use stoss_term::GradientRule;

/// Enforcement of a whole surface.
#[derive(Clone, Debug)]
pub(crate) struct NormalEnforcement {
    pub enforcement: Enforcement,
    /// Rule of the step that began last.
    pub rule: GradientRule,
    /// Multipliers of the augmented Lagrangian, one a slot; empty with another enforcement.
    pub multipliers: Vec<f64>,
    /// Multipliers at the start of the step.
    committed: Vec<f64>,
    pub rounds: u32,
    /// Stiffening by the largest gap of each round.
    pub stiffening: Stiffening,
}

impl NormalEnforcement {
    pub fn new(options: NodeToSurfaceOptions, slots: usize) -> Result<Self, ContactError> {
        let enforcement = options.enforcement.checked()?;
        if matches!(enforcement, Enforcement::Penalty(_)) && options.constraint == ConstraintForm::Modified {
            return Err(ContactError::PenaltyUnavailable);
        }
        let slots = if matches!(enforcement, Enforcement::Augmented(_)) { slots } else { 0 };
        let multipliers = vec![0.0; slots];
        let committed = multipliers.clone();
        let (rule, stiffening) = (GradientRule::EndPoint, Stiffening::default());
        Ok(Self { enforcement, rule, multipliers, committed, rounds: 0, stiffening })
    }

    pub fn begin(&mut self, rule: GradientRule) {
        self.rule = rule;
        self.multipliers.copy_from_slice(&self.committed);
        (self.rounds, self.stiffening) = (0, Stiffening::default());
    }

    /// The enforcement of the present round.
    pub fn present(&self) -> Enforcement {
        match self.enforcement {
            Enforcement::Augmented(stiffness) => Enforcement::Augmented(self.stiffening.factor() * stiffness),
            other => other,
        }
    }

    pub fn multiplier(&self, slot: usize) -> f64 {
        self.multipliers.get(slot).copied().unwrap_or(0.0)
    }

    /// The pressures of an accepted step are the multipliers that the next one starts from.
    pub fn commit(&mut self, pressures: &[f64], active: &[bool]) {
        for ((multiplier, &p), &active) in self.committed.iter_mut().zip(pressures).zip(active) {
            *multiplier = if active { p.max(0.0) } else { 0.0 };
        }
    }

    /// Bytes of a slot's history.
    pub fn bytes(&self) -> usize {
        if self.committed.is_empty() { 0 } else { 8 }
    }

    pub fn save(&self, out: &mut Vec<u8>) {
        out.extend(self.committed.iter().flat_map(|value| value.to_le_bytes()));
    }

    /// Reads multipliers from as many bytes as [`Self::save`] writes.
    pub fn load(&mut self, bytes: &[u8]) {
        for (value, chunk) in self.committed.iter_mut().zip(bytes.chunks_exact(8)) {
            *value = f64::from_le_bytes(std::array::from_fn(|k| chunk[k]));
        }
    }
}
