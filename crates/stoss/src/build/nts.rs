//! Node-to-surface contact of a scene.

use super::Problems;
use super::contact::PairInput;
use super::friction::DEFAULT_TANGENTIAL_STIFFNESS;
use crate::scene::{Constraint, Enforcement as Enforced};
use crate::solver::{ContactPair, Model};
use stoss_contact::{ContactMethod, Enforcement};
use stoss_contact_nts::{ConstraintForm, CoordinateAugmented, NodeToSurface, NodeToSurfaceOptions};

/// Adds the contact to the model; reports what is wrong.
pub(super) fn contact(
    pair: &PairInput<'_>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) {
    let item = pair.item;
    let constraint = match item.constraint {
        Constraint::Standard => ConstraintForm::Standard,
        Constraint::Modified => ConstraintForm::Modified,
        // The reader refuses it; a scene that was made in memory comes here.
        Constraint::OneSided => {
            let message = "`one-sided` is for mortar contact only";
            return problems.add(format!("{}.constraint", pair.key), "", message, "use `standard` or `modified`");
        }
    };
    let enforcement = match item.enforcement {
        Enforced::Multiplier => Enforcement::Multiplier,
        Enforced::Penalty(stiffness) => Enforcement::Penalty(stiffness),
        Enforced::Augmented(stiffness) => Enforcement::Augmented(stiffness),
    };
    let options = NodeToSurfaceOptions { constraint, enforcement, ..NodeToSurfaceOptions::default() };
    let [slave, master] = pair.facets;
    let mut method = match NodeToSurface::new(&item.label(), slave, master, &model.reference, options) {
        Ok(method) => method,
        Err(error) => return pair.refused(&error, problems),
    };
    let complementarity = pair.prepare(&mut method, model, problems, warnings);
    if let Some(friction) = &item.friction {
        let stiffness = DEFAULT_TANGENTIAL_STIFFNESS * complementarity;
        let friction = super::friction::friction(pair.scene, &pair.key, friction, stiffness, problems);
        let Some(friction) = friction else { return };
        let friction = friction.with_inertia(pair.inertia(model, method.length_scale()));
        method = match method.with_friction(friction) {
            Ok(method) => method.with_compliant_stick(|node| pair.held.contains(&node)),
            Err(error) => {
                let key = format!("{}.friction", pair.key);
                return problems.add(key, "", error.to_string(), "use the standard constraint");
            }
        };
    }
    let method: Box<dyn ContactMethod> = match item.method {
        crate::scene::ContactMethod::Cat => {
            if let Some(scheme) = super::friction::scheme_elsewhere(pair.scene) {
                let message = format!("is not available with the scheme `{scheme}`");
                let key = format!("{}.method", pair.key);
                return problems.add(key, "cat", message, "use `midpoint` or `backward-euler`, or `nts`");
            }
            Box::new(CoordinateAugmented::new(method, augmentation(item)))
        }
        _ => Box::new(method),
    };
    model.contacts.push(ContactPair { name: item.label(), method, complementarity });
}

fn augmentation(item: &crate::scene::Contact) -> stoss_contact_nts::AugmentedOptions {
    use stoss_contact_nts::Reduction;
    let reduction = match item.reduction {
        Some(crate::scene::Reduction::None) => Reduction::None,
        Some(crate::scene::Reduction::First) => Reduction::First,
        Some(crate::scene::Reduction::Second) | None => Reduction::Second,
    };
    stoss_contact_nts::AugmentedOptions {
        reduction,
        drop_gap_term: item.drop_gap_term,
        drop_gap_slope: item.drop_gap_slope,
    }
}
