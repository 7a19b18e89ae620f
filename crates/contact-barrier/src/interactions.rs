//! Which facets act on each other, and how.

use std::collections::BTreeSet;
use std::sync::Arc;
use stoss_contact::friction::FrictionLaw;

/// How the facets of two classes act on each other.
#[derive(Clone, Debug)]
pub struct Interaction {
    /// Modulus of the layer, a pressure: Young's moduli of the sides in series, for instance.
    pub modulus: f64,
    /// Law of friction, if there is any.
    pub friction: Option<Arc<dyn FrictionLaw>>,
}

/// Modulus of the layer between two rigid bodies, in weights of the lighter one over the smallest side of the box around it: at rest the layer keeps 0.93 of its thickness.
const WEIGHTS: f64 = 100.0;

impl Interaction {
    /// Modulus of the layer between two bodies with these Young's moduli (infinite if rigid): `stiffness` times that of both in series. Infinite between rigid bodies.
    pub fn modulus_of_layer(stiffness: f64, [a, b]: [f64; 2]) -> f64 {
        stiffness / (1.0 / a + 1.0 / b)
    }

    /// Modulus of the layer between two rigid bodies, of the `weight` of the lighter one (a force) and the smallest side of the box around it (an `area`).
    pub fn modulus_by_weight(weight: f64, area: f64) -> f64 {
        WEIGHTS * weight / area
    }
}

/// A table of all pairs of classes. A class is a body, or a part of a body's surface that is treated differently; facets of the same class may act on each other, too.
#[derive(Clone, Debug, Default)]
pub struct Interactions {
    bodies: Vec<u32>,
    stiffness: Vec<f64>,
    table: Vec<Option<Interaction>>,
}

impl Interactions {
    /// A table without interactions, between classes that belong to these bodies, each given with its Young's modulus: infinite if it is rigid.
    pub fn none(classes: &[(u32, f64)]) -> Self {
        let (bodies, stiffness): (Vec<u32>, Vec<f64>) = classes.iter().copied().unzip();
        Self { table: vec![None; bodies.len() * bodies.len()], bodies, stiffness }
    }

    /// Lets two classes act on each other; `None`: not.
    pub fn set(&mut self, a: u32, b: u32, interaction: Option<Interaction>) {
        let n = self.bodies.len();
        self.table[a as usize * n + b as usize] = interaction.clone();
        self.table[b as usize * n + a as usize] = interaction;
    }

    /// Excludes contact between two bodies.
    pub fn exclude(&mut self, [a, b]: [u32; 2]) {
        let n = self.bodies.len();
        for (k, entry) in self.table.iter_mut().enumerate() {
            let pair = [self.bodies[k / n], self.bodies[k % n]];
            if pair == [a, b] || pair == [b, a] {
                *entry = None;
            }
        }
    }

    /// Multiplies the modulus of all layers between two bodies.
    pub fn scale_modulus(&mut self, [a, b]: [u32; 2], factor: f64) {
        let n = self.bodies.len();
        for (k, entry) in self.table.iter_mut().enumerate() {
            let pair = [self.bodies[k / n], self.bodies[k % n]];
            if let Some(interaction) = entry.as_mut().filter(|_| pair == [a, b] || pair == [b, a]) {
                interaction.modulus *= factor;
            }
        }
    }

    /// Whether any surfaces of two bodies act on each other.
    pub fn acts_between(&self, [a, b]: [u32; 2]) -> bool {
        let n = self.bodies.len();
        (0..n * n).any(|k| self.table[k].is_some() && [self.bodies[k / n], self.bodies[k % n]] == [a, b])
    }

    /// What acts between two classes.
    pub fn between(&self, a: u32, b: u32) -> Option<&Interaction> {
        self.table[a as usize * self.bodies.len() + b as usize].as_ref()
    }

    /// The interactions between different bodies alone: none acts on itself.
    pub(crate) fn between_bodies(&self) -> Self {
        let (mut all, n) = (self.clone(), self.bodies.len());
        for (k, entry) in all.table.iter_mut().enumerate() {
            if self.bodies[k / n] == self.bodies[k % n] {
                *entry = None;
            }
        }
        all
    }

    /// Pairs of different bodies of which all surfaces act on each other, the smaller number first, ascending.
    pub fn body_pairs(&self) -> Vec<[u32; 2]> {
        let n = self.bodies.len();
        let pair = |k: usize| [self.bodies[k / n], self.bodies[k % n]];
        let of = |acts: bool| -> BTreeSet<[u32; 2]> {
            (0..n * n).filter(|&k| self.table[k].is_some() == acts).map(pair).filter(|[a, b]| a < b).collect()
        };
        of(true).difference(&of(false)).copied().collect()
    }

    /// Body of a class.
    pub fn body(&self, class: u32) -> u32 {
        self.bodies[class as usize]
    }

    /// Share of the surface of `point`'s class that is summed against facets of the other that are as large: one half if both are as stiff, because the other is summed too; more of the softer one, which takes the
    /// shape of the stiffer one; one against rigid bodies. What larger, smaller and rougher facets have is in [`Skin::point_weight`](crate::Skin::point_weight).
    pub fn share(&self, point: u32, facet: u32) -> f64 {
        let [own, other] = [point, facet].map(|class| self.stiffness[class as usize]);
        if own == other { 0.5 } else { 1.0 / (1.0 + own / other) }
    }

    /// Whether no classes act on each other.
    pub fn is_empty(&self) -> bool {
        self.table.iter().all(Option::is_none)
    }

    /// Whether any two different bodies act on each other.
    pub fn acts_between_bodies(&self) -> bool {
        let n = self.bodies.len();
        (0..n * n).any(|k| self.table[k].is_some() && self.bodies[k / n] != self.bodies[k % n])
    }

    /// Whether anything has friction.
    pub fn has_friction(&self) -> bool {
        self.table.iter().flatten().any(|interaction| interaction.friction.is_some())
    }
}
