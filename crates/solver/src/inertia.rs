//! The inertia of a model.

use crate::Model;
use crate::mass_solve::MassSolver;
use crate::masses::{Masses, PartMass};
use crate::shares::Shares;
use std::sync::Arc;

/// Masses, and what is solved with them.
#[derive(Debug)]
pub(crate) struct Inertia {
    pub masses: Masses,
    /// Made when a scheme first asks for it.
    pub solver: Option<MassSolver>,
    /// Whether masses were made, if only of what cannot move at present.
    pub exists: bool,
    /// Smallest mass of a part, zero if none has any.
    pub smallest: f64,
}

impl Inertia {
    /// The inertia of a model, of bodies that have densities; empty unless it `exists`.
    pub fn new(model: &Model, exists: bool, shares: &Arc<Shares>) -> Self {
        let mut masses = Masses { shares: Arc::clone(shares), ..Masses::default() };
        if exists {
            masses.bodies = model.bodies.iter().filter_map(|body| Some(body.mass(body.density?))).collect();
            masses.parts = model.parts.iter().map(|part| PartMass::new(&**part)).collect();
        }
        let positions = model.parts.iter().zip(&masses.parts).flat_map(|(part, mass)| {
            mass.entries.iter().filter(|&&(i, j, m)| i == j && m > 0.0 && !part.is_direction(i)).map(|&(_, _, m)| m)
        });
        let smallest = positions.fold(f64::INFINITY, f64::min);
        Self { solver: None, exists, smallest: if smallest.is_finite() { smallest } else { 0.0 }, masses }
    }
}

/// Sizes of a model against which forces and energies are judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scales {
    /// Sum of nodal masses times an edge length.
    pub mass_length: f64,
    /// Sum of shear modulus times squared edge length of the bodies, and of the force scales of the parts.
    pub force: f64,
    /// Sum of shear modulus times volume of the bodies, and of force scale times length of the parts: the energy of a strain of one.
    pub energy: f64,
}

impl Scales {
    pub fn new(model: &Model, masses: &Masses) -> Self {
        let mut scales = Self { mass_length: 0.0, force: 0.0, energy: 0.0 };
        for (b, body) in model.bodies.iter().enumerate() {
            let h = body.solid.characteristic_length();
            let shear = body.solid.law().small_strain_moduli().shear;
            scales.force += shear * h * h;
            scales.energy += shear * body.solid.element_count() as f64 * h * h * h;
            if let Some(mass) = masses.bodies.get(b) {
                scales.mass_length += masses.shares.sum(mass.total()) / (body.nodes.len().max(1) as f64) * h;
            }
        }
        for (part, mass) in model.parts.iter().zip(&masses.parts) {
            let total: f64 = mass.entries.iter().map(|&(i, j, m)| if i == j { m } else { 2.0 * m }).sum();
            scales.mass_length += total / part.own_vectors().len().max(1) as f64 * part.length_scale();
        }
        scales.force += model.parts.iter().map(|part| part.force_scale()).sum::<f64>();
        scales.energy += model.parts.iter().map(|part| part.force_scale() * part.length_scale()).sum::<f64>();
        scales
    }
}
