//! Mortar contact of a scene.

use super::Problems;
use super::contact::PairInput;
use crate::scene::{Constraint, Multipliers, Normals, Quadrature as Points};
use crate::solver::{ContactPair, Model};
use std::collections::BTreeMap;
use stoss_contact_mortar::{
    MortarContact, MortarOptions, MultiplierSpace, NormalField, Quadrature, TriangleRule, WeightedConstraint,
};

/// Adds the contact to the model; reports what is wrong.
pub(super) fn contact(
    pair: &PairInput<'_>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) {
    let item = pair.item;
    let rule = match item.quadrature {
        Some(Points::FourPoint) => TriangleRule::FourPoint,
        Some(Points::TwelvePoint) => TriangleRule::TwelvePoint,
        Some(Points::SevenPoint) | None => TriangleRule::SevenPoint,
    };
    let options = MortarOptions {
        space: match item.multipliers {
            Some(Multipliers::Dual) => MultiplierSpace::Dual,
            Some(Multipliers::Standard) | None => MultiplierSpace::Standard,
        },
        quadrature: Quadrature { rule, ..Quadrature::default() },
        normals: match item.normals {
            Some(Normals::Facet) => NormalField::Facet,
            Some(Normals::Averaged) | None => NormalField::Averaged,
        },
        constraint: match item.constraint {
            Constraint::Standard => WeightedConstraint::Standard,
            Constraint::Modified => WeightedConstraint::Modified,
        },
    };
    let [slave, master] = pair.facets;
    let mut fixed: BTreeMap<u32, [bool; 3]> = BTreeMap::new();
    for prescription in &model.prescriptions {
        for &node in &prescription.nodes {
            let components = fixed.entry(node).or_default();
            prescription.components.iter().for_each(|&c| components[c as usize] = true);
        }
    }
    match MortarContact::new(&item.label(), slave, master, &model.reference, options) {
        Ok(method) => {
            let mut method = method.with_crosspoints(|n| fixed.get(&n).is_some_and(|c| c.iter().all(|f| *f)));
            let complementarity = pair.prepare(&mut method, model, problems, warnings);
            model.contacts.push(ContactPair { name: item.label(), method: Box::new(method), complementarity });
        }
        Err(error) => pair.refused(&error, problems),
    }
}
