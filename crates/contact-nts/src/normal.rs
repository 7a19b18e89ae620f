//! The enforcement of the gaps of a surface.

use crate::options::{ConstraintForm, NodeToSurfaceOptions};
use stoss_contact::{ContactError, Enforcement};
use stoss_term::GradientRule;

/// Enforcement of a whole surface.
#[derive(Clone, Debug)]
pub(crate) struct NormalEnforcement {
    pub enforcement: Enforcement,
    /// Rule of the step that began last.
    pub rule: GradientRule,
}

impl NormalEnforcement {
    pub fn new(options: NodeToSurfaceOptions) -> Result<Self, ContactError> {
        let enforcement = options.enforcement.checked()?;
        if matches!(enforcement, Enforcement::Penalty(_)) && options.constraint == ConstraintForm::Modified {
            return Err(ContactError::PenaltyUnavailable);
        }
        Ok(Self { enforcement, rule: GradientRule::EndPoint })
    }
}
