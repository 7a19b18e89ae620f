//! The mass of all bodies and parts: products, momenta, energy. Constant, and no global matrix.

use crate::shares::Shares;
use std::sync::Arc;
use stoss_fe_solid::MassMatrix;
use stoss_term::Term;

/// Mass of a part: scalar entries between vectors, acting alike on the three components.
#[derive(Debug)]
pub(crate) struct PartMass {
    /// Vectors `i <= j` and the entry.
    pub entries: Vec<(u32, u32, f64)>,
    /// First own vector, and of each whether it is a direction.
    first: u32,
    directions: Vec<bool>,
}

impl PartMass {
    pub fn new(part: &dyn Term) -> Self {
        let mut entries = Vec::new();
        part.mass(&mut |i, j, m| entries.push((i, j, m)));
        let own = part.own_vectors();
        Self { entries, first: own.start, directions: own.map(|v| part.is_direction(v)).collect() }
    }

    /// `entry(i, j, m)` of the whole symmetric matrix.
    fn for_each(&self, mut entry: impl FnMut(usize, usize, f64)) {
        for &(i, j, m) in &self.entries {
            entry(i as usize, j as usize, m);
            if i != j {
                entry(j as usize, i as usize, m);
            }
        }
    }

    fn is_direction(&self, vector: usize) -> bool {
        vector.checked_sub(self.first as usize).and_then(|k| self.directions.get(k)).copied().unwrap_or(false)
    }

    fn add_diagonal(&self, out: &mut [f64]) {
        for &(i, _, m) in self.entries.iter().filter(|(i, j, _)| i == j) {
            out[3 * i as usize..3 * i as usize + 3].iter_mut().for_each(|sum| *sum += m);
        }
    }

    fn multiply_add(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        self.for_each(|i, j, m| {
            for d in 0..3 {
                out[3 * i + d] += factor * m * x[3 * j + d];
            }
        });
    }

    pub fn kinetic_energy(&self, v: &[f64]) -> f64 {
        let mut twice = 0.0;
        self.for_each(|i, j, m| twice += m * (0..3).map(|d| v[3 * i + d] * v[3 * j + d]).sum::<f64>());
        0.5 * twice
    }

    /// Momentum of the translations: rows of positions only.
    pub fn linear_momentum(&self, v: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        self.for_each(|i, j, m| {
            if !self.is_direction(i) {
                sum.iter_mut().zip(&v[3 * j..3 * j + 3]).for_each(|(s, v)| *s += m * v);
            }
        });
        sum
    }

    /// `sum M_ij q_i x v_j`, about the origin, directions included.
    pub fn angular_momentum(&self, q: &[f64], v: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        self.for_each(|i, j, m| {
            let (q, v) = (&q[3 * i..3 * i + 3], &v[3 * j..3 * j + 3]);
            sum[0] += m * (q[1] * v[2] - q[2] * v[1]);
            sum[1] += m * (q[2] * v[0] - q[0] * v[2]);
            sum[2] += m * (q[0] * v[1] - q[1] * v[0]);
        });
        sum
    }
}

/// All masses of a model; both lists are empty in statics.
#[derive(Debug, Default)]
pub(crate) struct Masses {
    /// Shares of the ranks: masses of bodies are those of this rank's elements.
    pub shares: Arc<Shares>,
    /// Mass matrix of each body.
    pub bodies: Vec<MassMatrix>,
    /// Mass of each part.
    pub parts: Vec<PartMass>,
}

impl Masses {
    /// Entries of the masses of parts that go into this rank's part of a matrix.
    pub fn own_entries(&self) -> impl Iterator<Item = &(u32, u32, f64)> {
        self.parts.iter().flat_map(|mass| &mass.entries).filter(|(i, ..)| self.shares.has(*i))
    }

    /// `out += factor M x`.
    pub fn multiply_add(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        self.shares.add_sum(out, |out| self.bodies.iter().for_each(|mass| mass.multiply_add(factor, x, out)));
        self.parts.iter().for_each(|mass| mass.multiply_add(factor, x, out));
    }

    /// `1/2 v . M v`.
    pub fn kinetic_energy(&self, v: &[f64]) -> f64 {
        let bodies = self.shares.sum(self.bodies.iter().map(|mass| mass.kinetic_energy(v)).sum());
        // Without parts the bits are those of the bodies.
        self.parts.iter().fold(bodies, |sum, mass| sum + mass.kinetic_energy(v))
    }

    /// Kinetic energies of `count` groups of bodies and parts at the velocities `v`: of each body and of each part `groups` has its group. What has no such number is in none.
    pub fn kinetic_energies(&self, v: &[f64], groups: [&[u32]; 2], count: usize) -> Vec<f64> {
        let mut sums = vec![0.0; count];
        for (mass, &group) in self.bodies.iter().zip(groups[0]) {
            if let Some(sum) = sums.get_mut(group as usize) {
                *sum += mass.kinetic_energy(v);
            }
        }
        self.shares.sum_all(&mut sums);
        for (mass, &group) in self.parts.iter().zip(groups[1]) {
            if let Some(sum) = sums.get_mut(group as usize) {
                *sum += mass.kinetic_energy(v);
            }
        }
        sums
    }

    /// Linear momentum.
    pub fn linear_momentum(&self, v: &[f64]) -> [f64; 3] {
        let parts = self.parts.iter().map(|mass| mass.linear_momentum(v));
        self.sum_momenta(self.bodies.iter().map(|mass| mass.linear_momentum(v)), parts)
    }

    /// Angular momentum about the origin.
    pub fn angular_momentum(&self, q: &[f64], v: &[f64]) -> [f64; 3] {
        let parts = self.parts.iter().map(|mass| mass.angular_momentum(q, v));
        self.sum_momenta(self.bodies.iter().map(|mass| mass.angular_momentum(q, v)), parts)
    }

    fn sum_momenta(&self, bodies: impl Iterator<Item = [f64; 3]>, parts: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
        parts.fold(self.shares.sum3(sum(bodies)), |sum, v| std::array::from_fn(|i| sum[i] + v[i]))
    }

    /// The diagonal of the mass, as a vector of the model.
    pub fn diagonal(&self, components: usize) -> Vec<f64> {
        let mut diagonal = vec![0.0; components];
        self.shares.add_sum(&mut diagonal, |out| self.bodies.iter().for_each(|mass| mass.add_diagonal(out)));
        self.parts.iter().for_each(|mass| mass.add_diagonal(&mut diagonal));
        diagonal
    }

    /// Sum of all masses.
    pub fn total(&self, components: usize) -> f64 {
        let along_x: Vec<f64> = (0..components).map(|c| if c % 3 == 0 { 1.0 } else { 0.0 }).collect();
        // A direction gets a velocity here, too; its rows do not count, and its coupling with a position would be a moment, not a mass.
        let bodies = self.shares.sum(self.bodies.iter().map(|mass| mass.linear_momentum(&along_x)[0]).sum());
        let part = |mass: &PartMass| {
            let mut total = 0.0;
            mass.for_each(|i, j, m| {
                if !mass.is_direction(i) && !mass.is_direction(j) {
                    total += m;
                }
            });
            total
        };
        self.parts.iter().fold(bodies, |sum, mass| sum + part(mass))
    }
}

fn sum(vectors: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    vectors.fold([0.0; 3], |sum, v| std::array::from_fn(|i| sum[i] + v[i]))
}
