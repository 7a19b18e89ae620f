//! Viscous stabilisation of statics, which vanishes with the end of a stage.

use crate::Model;
use crate::shares::Shares;
use std::ops::Range;
use stoss_fe_solid::{MassKind, MassMatrix};

/// How large the stabilisation of a static stage is: nodes of bodies resist motion with `c r M_1 (q_np1 - q_n) / h`, where `M_1` is the lumped mass of unit density and `r`
/// falls linearly from 1 at the start of the stage to 0 at its end. The last equilibrium is therefore free of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stabilise {
    /// `c` of all bodies, a force per volume and velocity.
    Coefficient(f64),
    /// `c` of each body such that a bar of its Young's modulus `E` and its longest side `L` that is stretched steadily over the stage, of length `T`, loses this part of its strain
    /// energy: `c = 3 fraction E T / L^2`.
    Fraction(f64),
}

/// The stabilisation of the present stage.
#[derive(Debug)]
pub(crate) struct Stabilisation {
    /// `c M_1` of each body, of this rank's elements.
    masses: Vec<MassMatrix>,
    /// `r` of the step.
    pub ramp: f64,
}

impl Stabilisation {
    /// The stabilisation of a stage of this length, a time.
    pub fn new(model: &Model, how: Stabilise, length: f64) -> Self {
        let mass = |body: &crate::Body| {
            let coefficient = match how {
                Stabilise::Coefficient(c) => c,
                Stabilise::Fraction(fraction) => {
                    let side = longest_side(&model.reference, body.nodes.clone());
                    let young = body.solid.law().small_strain_moduli().young_modulus();
                    3.0 * fraction * young * length / (side * side)
                }
            };
            body.solid.mass(coefficient, MassKind::Lumped)
        };
        Self { masses: model.bodies.iter().map(mass).collect(), ramp: 1.0 }
    }

    /// `sum factor c M_1 x`.
    pub fn sum(&self, shares: &Shares, of: &[(f64, &[f64])]) -> Vec<f64> {
        let mut sum = vec![0.0; of.first().map_or(0, |(_, x)| x.len())];
        shares.add_sum(&mut sum, |sum| {
            for mass in &self.masses {
                of.iter().for_each(|(factor, x)| mass.multiply_add(*factor, x, sum));
            }
        });
        sum
    }

    /// `c M_1` of each body, of this rank's elements.
    pub fn masses(&self) -> &[MassMatrix] {
        &self.masses
    }
}

/// Longest side of the box around a body's nodes.
fn longest_side(reference: &[f64], nodes: Range<u32>) -> f64 {
    let side = |i: usize| {
        let along = nodes.clone().map(|node| reference[3 * node as usize + i]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    (0..3).map(side).fold(0.0, f64::max)
}
