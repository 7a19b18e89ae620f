//! Functions of invariants, with the gradients that the schemes ask for.

/// A function `W(phi)` of some invariants, smooth where it is evaluated.
pub trait Response: Send + Sync + std::fmt::Debug {
    /// Value at `phi`.
    fn value(&self, phi: &[f64]) -> f64;

    /// `gradient_k = dW/dphi_k` and, row-major, `second_kl = d2W/dphi_k dphi_l`; both come with zeros.
    fn derivatives(&self, phi: &[f64], gradient: &mut [f64], second: &mut [f64]);

    /// A discrete gradient, `gradient . (phi_np1 - phi_n) = W(phi_np1) - W(phi_n)`, and, row-major, its derivatives with respect to `phi_np1`; both come with
    /// zeros.
    fn discrete_gradient(&self, phi_n: &[f64], phi_np1: &[f64], gradient: &mut [f64], derivative: &mut [f64]);
}

/// `W = 1/2 sum c_k (phi_k - phi_k0)^2`: elastic energy that is quadratic in its strains. The discrete gradient is the mean of the gradients.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadraticEnergy {
    /// `c_k`.
    pub stiffness: Vec<f64>,
    /// `phi_k0`.
    pub rest: Vec<f64>,
}

impl Response for QuadraticEnergy {
    fn value(&self, phi: &[f64]) -> f64 {
        let terms = phi.iter().zip(&self.rest).zip(&self.stiffness);
        terms.map(|((p, r), c)| 0.5 * c * (p - r) * (p - r)).sum()
    }

    fn derivatives(&self, phi: &[f64], gradient: &mut [f64], second: &mut [f64]) {
        for k in 0..phi.len() {
            gradient[k] = self.stiffness[k] * (phi[k] - self.rest[k]);
            second[k * phi.len() + k] = self.stiffness[k];
        }
    }

    fn discrete_gradient(&self, phi_n: &[f64], phi_np1: &[f64], gradient: &mut [f64], derivative: &mut [f64]) {
        for k in 0..phi_n.len() {
            gradient[k] = self.stiffness[k] * (0.5 * (phi_n[k] + phi_np1[k]) - self.rest[k]);
            derivative[k * phi_n.len() + k] = 0.5 * self.stiffness[k];
        }
    }
}
