//! Stiffness-proportional damping of a body: a viscous stress in the material frame (Kelvin-Voigt).
//!
//! With the factor `b` (a time) and the law's moduli `C_0` at the reference, `S_v = b C_0 : E'` acts beside the elastic second Piola-Kirchhoff stress,
//! `E' = sym(F^T F')`. For small strains that is the force `b K_0 v` of the textbooks (T. J. R. Hughes, The Finite Element Method, 1987, section 7.2). It depends on positions and
//! velocities at one instant; at the midpoint of a step with the velocity `(q_np1 - q_n) / h` the rate is exactly `(E_np1 - E_n) / h`: rigid rotations of any size have
//! no force, the power is `sum w E' : b C_0 : E' >= 0`, and with `F S_v` the resultant and the moment about the positions are zero.

use crate::{
    assembly::ElementEvaluator,
    element::{Failure, gather},
    kernel::{self, COMPONENT_OF, LocalTangent, Matrix3, NodalVectors, PointBuffers, TangentFactors, TangentPoint},
    reference::{ElementReference, Natural},
};

/// Where and how fast the viscous stress acts. Vectors of the model, node-major, `3 * nodes` entries.
#[derive(Clone, Copy, Debug)]
pub struct ViscousRate<'a> {
    /// Positions, a length.
    pub q: &'a [f64],
    /// Velocities.
    pub v: &'a [f64],
    /// `b`, a time.
    pub factor: f64,
    /// Derivatives of `q` and `v` with respect to the unknown positions, for the tangent: a number and one over a time.
    pub slopes: [f64; 2],
}

/// The law of the viscous stress and the motion it acts on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viscosity<'a> {
    pub rate: ViscousRate<'a>,
    /// `b` times Lamé's constants.
    pub moduli: [f64; 2],
    /// Factor of the tangent.
    pub factor: f64,
}

/// Elements under their viscous stress, as the loop over them sees it.
pub(crate) struct ViscousElements<'a, const N: usize, const G: usize> {
    pub references: &'a [ElementReference<G>],
    pub natural: &'a Natural<N, G>,
    pub nodes: &'a [[u32; N]],
    pub viscosity: Viscosity<'a>,
}

impl<const N: usize, const G: usize> ElementEvaluator<N, G> for ViscousElements<'_, N, G> {
    fn evaluate(
        &self,
        element: usize,
        force: &mut NodalVectors<N>,
        tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
        _: &mut PointBuffers,
    ) -> Result<(), Failure> {
        let Viscosity { rate, moduli: [lambda, shear], factor } = self.viscosity;
        let integration = &self.references[element].integration(&self.natural.gradients);
        let nodes = &self.nodes[element];
        let (q, v) = (gather(nodes, rate.q), gather(nodes, rate.v));
        let mut tangent = tangent;
        *force = [[0.0; N]; 3];
        for g in 0..G {
            let (gradients, weight) = (&integration.gradients[g], integration.weights[g]);
            let f = kernel::deformation_gradient(&q, gradients);
            let l = kernel::deformation_gradient(&v, gradients);
            let stress = stress(strain_rate(&f, &l), lambda, shear);
            kernel::add_force(&f, &stress, gradients, weight, force);
            if let Some((_, factors)) = &mut tangent {
                // dE' = sym((dv F + dq F')^T dF)
                let [dq, dv] = rate.slopes;
                let right: Matrix3 = std::array::from_fn(|i| std::array::from_fn(|a| dv * f[i][a] + dq * l[i][a]));
                let moduli = isotropic(lambda, shear);
                let (right, moduli, stress) = (&right, &moduli, &stress);
                let point = TangentPoint { left: &f, right, moduli, stress, geometric: dq, weight };
                kernel::tangent_factors(&[point], &integration.gradients, g, false, factors);
            }
        }
        if let Some((tangent, factors)) = tangent {
            kernel::tangent_from_factors(&integration.gradients, factors, false, factor, tangent);
        }
        Ok(())
    }
}

/// `sym(F^T F')` in the order 11, 22, 33, 12, 23, 13, plain.
fn strain_rate(f: &Matrix3, l: &Matrix3) -> [f64; 6] {
    let dot = |a: usize, b: usize| (0..3).map(|i| f[i][a] * l[i][b]).sum::<f64>();
    let mut rate = [0.0; 6];
    for a in 0..3 {
        for b in a..3 {
            rate[COMPONENT_OF[a][b]] = 0.5 * (dot(a, b) + dot(b, a));
        }
    }
    rate
}

/// `lambda tr(E) I + 2 mu E`.
fn stress(e: [f64; 6], lambda: f64, shear: f64) -> [f64; 6] {
    let pressure = lambda * (e[0] + e[1] + e[2]);
    std::array::from_fn(|k| 2.0 * shear * e[k] + if k < 3 { pressure } else { 0.0 })
}

/// Moduli for strains with doubled shears.
fn isotropic(lambda: f64, shear: f64) -> [[f64; 6]; 6] {
    let mut moduli = [[0.0; 6]; 6];
    for (i, row) in moduli.iter_mut().enumerate() {
        if i < 3 {
            row[..3].fill(lambda);
            row[i] += 2.0 * shear;
        } else {
            row[i] = shear;
        }
    }
    moduli
}
