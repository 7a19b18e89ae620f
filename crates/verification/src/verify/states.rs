//! Random states of strain from a fixed seed, so that every run measures the same.

use stoss_continuum::{SymmetricTensor2, Tensor2};
use stoss_tensor::{Vector3, nalgebra, spectral_decomposition};

/// A small generator of random numbers (splitmix64).
pub struct Random(pub u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// `10^power` with a uniform power.
    pub fn power_of_ten(&mut self, low: f64, high: f64) -> f64 {
        10.0_f64.powf(self.between(low, high))
    }

    /// A rotation, from a quaternion with random components.
    pub fn rotation(&mut self) -> Tensor2 {
        let [x, y, z] = std::array::from_fn(|_| self.between(-1.0, 1.0));
        let quaternion = nalgebra::Quaternion::new(self.between(0.1, 1.0), x, y, z);
        nalgebra::UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix().into_inner()
    }

    /// A symmetric tensor of norm one.
    pub fn direction(&mut self) -> SymmetricTensor2 {
        let mut direction = SymmetricTensor2(std::array::from_fn(|_| self.between(-1.0, 1.0)));
        direction.0[0] += 0.1;
        direction * (1.0 / direction.norm())
    }

    /// `C` with these principal stretches and random axes.
    pub fn with_stretches(&mut self, stretches: [f64; 3]) -> SymmetricTensor2 {
        let squares = Vector3::from_fn(|i, _| stretches[i] * stretches[i]);
        let q = self.rotation();
        SymmetricTensor2::from_matrix(&(q * Tensor2::from_diagonal(&squares) * q.transpose()))
    }

    /// `C` with stretches between 0.6 and 1.7.
    pub fn moderate(&mut self) -> SymmetricTensor2 {
        let stretches = std::array::from_fn(|_| self.between(0.6, 1.7));
        self.with_stretches(stretches)
    }

    /// `C` with `J` between 0.2 and 0.3.
    pub fn crushed(&mut self) -> SymmetricTensor2 {
        let shape: [f64; 3] = std::array::from_fn(|_| self.between(0.7, 1.3));
        let factor = (self.between(0.2, 0.3) / shape.iter().product::<f64>()).cbrt();
        self.with_stretches(shape.map(|stretch| factor * stretch))
    }

    /// `C` with `equal` (two or three) stretches that are equal, exactly or but for a gap of 1e-15 to 1e-2.
    pub fn repeated(&mut self, equal: usize) -> SymmetricTensor2 {
        let (a, b) = (self.between(0.5, 1.6), self.between(0.5, 1.6));
        let gap = if self.between(0.0, 1.0) < 0.3 { 0.0 } else { self.power_of_ten(-15.0, -2.0) };
        self.with_stretches([a, a * (1.0 + gap), if equal == 3 { a * (1.0 - 0.5 * gap) } else { b }])
    }

    /// A state and another one in a random direction, at a distance of `10^low` to `10^high` times the smallest
    /// eigenvalue (at most 0).
    pub fn step(&mut self, low: f64, high: f64) -> (SymmetricTensor2, SymmetricTensor2) {
        let start = self.moderate();
        let size = 0.9 * self.power_of_ten(low, high) * smallest_eigenvalue(&start);
        (start, start + self.direction() * size)
    }
}

/// Smallest squared principal stretch.
pub fn smallest_eigenvalue(c: &SymmetricTensor2) -> f64 {
    spectral_decomposition(c).values[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_what_they_are_called() {
        let mut random = Random(1);
        for _ in 0..200 {
            let q = random.rotation();
            assert!((q * q.transpose() - Tensor2::identity()).norm() < 1e-14 && q.determinant() > 0.0);
            let stretches = |c: &SymmetricTensor2| spectral_decomposition(c).values.map(f64::sqrt);
            assert!(stretches(&random.moderate()).iter().all(|s| (0.599..1.701).contains(s)));
            assert!((0.199..0.301).contains(&random.crushed().det().sqrt()));
            let [a, b, c] = stretches(&random.repeated(2));
            assert!((b - a).min(c - b) < 0.02);
            let [a, _, c] = stretches(&random.repeated(3));
            assert!(c - a < 0.03);
            let (start, end) = random.step(-3.0, 0.0);
            assert!(smallest_eigenvalue(&end) > 0.0 && start != end);
        }
    }

    #[test]
    fn the_seed_fixes_the_numbers() {
        let draw = |seed| std::array::from_fn::<_, 4, _>(|_| Random(seed).between(0.0, 1.0).to_bits());
        assert_eq!(draw(7), draw(7));
        assert_ne!(draw(7), draw(8));
        // First output of splitmix64 for the seed 0, from its publication.
        assert_eq!(Random(0).bits(), 0xe220_a839_7b1d_cdaf);
    }
}
