//! Ogden, decoupled form (theory/kinematics#eq-ogden; thesis (3.113)-(3.118)).

use crate::error::{MaterialError, finite, stable};
use crate::state::{finite_energy, finite_pair, finite_stress};
use crate::volume::Power;
use std::sync::Arc;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, Strains, SymmetricTensor2, Tensor4, VolumetricSplit, Wanted,
};
use stoss_tensor::wide::{self, LANES, Operation, Simd};
use stoss_tensor::{SpectralDecomposition, spectral_decomposition, spectral_decompositions};

const NAME: &str = "ogden";

/// Relative distance of squared stretches up to which [`nearby_slope`] replaces the quotient of differences of the shear term. The
/// quotient loses `1e-16` over this distance; the other formula is exact at any distance but costs an exponential a term.
const NEARBY: f64 = 1.0e-3;

/// `W = sum_P mu_P/alpha_P (sum_A lbar_A^alpha_P - 3) + kappa (ln J / beta + (J^-beta - 1)/beta^2)` with the isochoric
/// principal stretches `lbar_A = J^(-1/3) lambda_A`; any number of terms.
///
/// Admissible for `J > 0`. Stress and tangent are exact to round-off for distinct, nearly equal and equal stretches.
#[derive(Clone, Debug, PartialEq)]
pub struct Ogden {
    terms: Vec<(f64, f64)>,
    kappa: f64,
    beta: f64,
}

/// What all three evaluations need: `J` and, for each term, the powers of the isochoric stretches.
struct State {
    squares: [f64; 3],
    vectors: [stoss_tensor::Vector3; 3],
    log_j: f64,
    /// Logarithms of the isochoric principal stretches.
    logs: [f64; 3],
}

impl State {
    fn new(c: &SymmetricTensor2) -> Result<Self, ConstitutiveError> {
        Self::of(c, spectral_decomposition(c))
    }

    fn of(c: &SymmetricTensor2, form: SpectralDecomposition) -> Result<Self, ConstitutiveError> {
        if !c.is_finite() {
            return Err(ConstitutiveError::NonFinite);
        }
        // The eigenvalues' product is the determinant without the cancellation of the expanded formula.
        if form.values[0] <= 0.0 {
            return Err(ConstitutiveError::NonPositiveJacobian { det_c: form.values.iter().product() });
        }
        let half_logs = form.values.map(|x| 0.5 * x.ln());
        let log_j = half_logs.iter().sum::<f64>();
        Ok(Self { squares: form.values, vectors: form.vectors, log_j, logs: half_logs.map(|x| x - log_j / 3.0) })
    }

    fn powers(&self, alpha: f64) -> [f64; 3] {
        self.logs.map(|l| (alpha * l).exp())
    }
}

impl Ogden {
    /// The law from the terms `mu_P` (a stress), `alpha_P`, the bulk modulus `kappa` (a stress) and `beta` (not zero).
    ///
    /// # Errors
    /// Lists of different lengths or empty, values that are not finite, `beta = 0`, an `alpha_P = 0`, bulk modulus `kappa` or shear modulus
    /// `sum mu_P alpha_P / 2` not positive.
    pub fn new(mu: &[f64], alpha: &[f64], kappa: f64, beta: f64) -> Result<Self, MaterialError> {
        if mu.len() != alpha.len() || mu.is_empty() {
            return Err(MaterialError::Lengths { law: NAME, mu: mu.len(), alpha: alpha.len() });
        }
        finite(NAME, &[("kappa", kappa), ("beta", beta)])?;
        for (&mu, &alpha) in mu.iter().zip(alpha) {
            finite(NAME, &[("mu", mu), ("alpha", alpha)])?;
            if alpha == 0.0 {
                return Err(MaterialError::OutOfRange {
                    law: NAME,
                    parameter: "alpha",
                    value: alpha,
                    range: "not zero",
                });
            }
        }
        if beta == 0.0 {
            return Err(MaterialError::OutOfRange { law: NAME, parameter: "beta", value: beta, range: "not zero" });
        }
        let law = Self { terms: mu.iter().copied().zip(alpha.iter().copied()).collect(), kappa, beta };
        stable(NAME, law.small_strain_moduli(), "shear = sum of mu alpha / 2, bulk = kappa")?;
        Ok(law)
    }

    /// `T_A = lambda_A dW_iso/dlambda_A`, deviatoric.
    fn principal(&self, state: &State) -> [f64; 3] {
        let mut t = [0.0; 3];
        for &(mu, alpha) in &self.terms {
            let p = state.powers(alpha);
            let mean = (p[0] + p[1] + p[2]) / 3.0;
            for a in 0..3 {
                t[a] += mu * (p[a] - mean);
            }
        }
        t
    }

    /// The energy.
    fn stored(&self, state: &State) -> f64 {
        let mut w = 0.0;
        for &(mu, alpha) in &self.terms {
            // exp(x) - 1 summed: no cancellation near the reference state.
            w += mu / alpha * state.logs.iter().map(|l| (alpha * l).exp_m1()).sum::<f64>();
        }
        w + self.stored_by_volume(state.log_j)
    }

    fn stored_by_volume(&self, log_j: f64) -> f64 {
        let x = self.beta * log_j;
        self.kappa * (x + (-x).exp_m1()) / (self.beta * self.beta)
    }

    /// The energy and the `T_A` with one exponential for both: `T_A` as of [`Self::principal`] to round-off.
    fn stored_and_principal(&self, state: &State) -> (f64, [f64; 3]) {
        let (mut w, mut t) = (0.0, [0.0; 3]);
        for &(mu, alpha) in &self.terms {
            // Powers less one; that cancels in what is deviatoric.
            let p = state.logs.map(|l| (alpha * l).exp_m1());
            let sum = p[0] + p[1] + p[2];
            w += mu / alpha * sum;
            for a in 0..3 {
                t[a] += mu * (p[a] - sum / 3.0);
            }
        }
        (w, t)
    }

    /// `kappa/beta (1 - J^-beta)`.
    fn pressure(&self, log_j: f64) -> f64 {
        -self.kappa / self.beta * (-self.beta * log_j).exp_m1()
    }

    /// Spectral sum of the principal stresses; the volumetric part is spectral too (`C^-1` has the same eigenvectors).
    fn assemble(state: &State, principal: &[f64; 3], pressure: f64) -> SymmetricTensor2 {
        let mut stress = SymmetricTensor2::ZERO;
        for a in 0..3 {
            let n = &state.vectors[a];
            stress += outer(n) * ((principal[a] + pressure) / state.squares[a]);
        }
        stress
    }

    /// Writes what is wanted at a strain.
    fn write(
        &self,
        c: &SymmetricTensor2,
        form: SpectralDecomposition,
        point: usize,
        wanted: &mut Wanted<'_>,
    ) -> Result<(), ConstitutiveError> {
        let (state, Wanted { energies, stresses, moduli }) = (State::of(c, form)?, wanted);
        let (mut energy, mut stress) = (None, None);
        match (moduli, energies.is_some(), stresses.is_some()) {
            (None, true, true) => {
                let both = self.energy_and_stress_at(&state)?;
                (energy, stress) = (Some(both.0), Some(both.1));
            }
            (Some(moduli), of_energy, _) => {
                let (found, of_point) = self.stress_and_elasticity_at(&state)?;
                moduli.set(point, &of_point);
                stress = Some(found);
                if of_energy {
                    energy = Some(finite_energy(self.stored(&state))?);
                }
            }
            (None, true, false) => energy = Some(finite_energy(self.stored(&state))?),
            (None, false, true) => stress = Some(self.stress_at(&state)?),
            (None, false, false) => {}
        }
        if let (Some(energies), Some(energy)) = (energies, energy) {
            energies[point] = energy;
        }
        if let (Some(stresses), Some(stress)) = (stresses, &stress) {
            stresses.set(point, stress);
        }
        Ok(())
    }

    fn stress_at(&self, state: &State) -> Result<SymmetricTensor2, ConstitutiveError> {
        finite_stress(Self::assemble(state, &self.principal(state), self.pressure(state.log_j)))
    }

    fn energy_and_stress_at(&self, state: &State) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        let (energy, principal) = self.stored_and_principal(state);
        let stress = finite_stress(Self::assemble(state, &principal, self.pressure(state.log_j)))?;
        Ok((finite_energy(energy + self.stored_by_volume(state.log_j))?, stress))
    }

    fn stress_and_elasticity_at(&self, state: &State) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let (pressure, power) = (self.pressure(state.log_j), (-self.beta * state.log_j).exp());
        let x = state.squares;
        let pairs = [(0, 1), (1, 2), (0, 2)];
        let nearby = pairs.map(|(a, b)| x[b] - x[a] <= NEARBY * x[a]);
        // T_A as in `principal`, H_AB = lambda_B dT_A/dlambda_B, f_AB = lambda_B^-1 dS_A/dlambda_B.
        let mut t = [0.0; 3];
        let mut h = [[0.0; 3]; 3];
        // (T_B - T_A) / (x_B - x_A) of the pairs of nearly equal stretches (the means cancel).
        let mut slope = [0.0; 3];
        for &(mu, alpha) in &self.terms {
            let p = state.powers(alpha);
            let sum = p[0] + p[1] + p[2];
            for (k, &(a, b)) in pairs.iter().enumerate() {
                if nearby[k] {
                    slope[k] += mu * p[a] * nearby_slope(alpha, x[a], x[b]);
                }
            }
            for a in 0..3 {
                t[a] += mu * (p[a] - sum / 3.0);
                for b in 0..3 {
                    let diagonal = if a == b { p[a] } else { 0.0 };
                    h[a][b] += mu * alpha * (diagonal - (p[a] + p[b]) / 3.0 + sum / 9.0);
                }
            }
        }
        let mut f = [[0.0; 3]; 3];
        for a in 0..3 {
            for b in 0..3 {
                f[a][b] = h[a][b] / (x[a] * x[b]) - if a == b { 2.0 * t[a] / (x[a] * x[a]) } else { 0.0 };
            }
        }
        let projections = state.vectors.map(|n| outer(&n));
        let mut elasticity = Tensor4::ZERO;
        for a in 0..3 {
            let row = projections[0] * f[a][0] + projections[1] * f[a][1] + projections[2] * f[a][2];
            elasticity.add_dyad(1.0, &projections[a], &row);
        }
        for (k, &(a, b)) in pairs.iter().enumerate() {
            let gamma = if nearby[k] {
                // S = T/x: S_B - S_A = (T_B - T_A)/x_B - T_A (x_B - x_A)/(x_A x_B).
                slope[k] / x[b] - t[a] / (x[a] * x[b])
            } else {
                (t[b] / x[b] - t[a] / x[a]) / (x[b] - x[a])
            };
            // Both ordered pairs: gamma (N_ABAB + N_ABBA + N_BABA + N_BAAB) = 4 gamma sym(N_A N_B) (x) sym(N_A N_B).
            let m = mixed(&state.vectors[a], &state.vectors[b]);
            elasticity.add_dyad(4.0 * gamma, &m, &m);
        }
        let mut inverse = SymmetricTensor2::ZERO;
        for a in 0..3 {
            inverse += projections[a] * (1.0 / x[a]);
        }
        elasticity.add_scaled(2.0 * pressure, &Tensor4::inverse_derivative(&inverse));
        elasticity.add_dyad(self.kappa * power, &inverse, &inverse);
        finite_pair(Self::assemble(state, &t, pressure), elasticity)
    }
}

fn outer(n: &stoss_tensor::Vector3) -> SymmetricTensor2 {
    SymmetricTensor2(stoss_tensor::INDEX_PAIRS.map(|(i, j)| n[i] * n[j]))
}

/// Symmetrised `a (x) b`.
fn mixed(a: &stoss_tensor::Vector3, b: &stoss_tensor::Vector3) -> SymmetricTensor2 {
    SymmetricTensor2(stoss_tensor::INDEX_PAIRS.map(|(i, j)| 0.5 * (a[i] * b[j] + a[j] * b[i])))
}

/// The pair of principal directions `a`, `b` of nearly equal stretches: `(lbar_B^alpha / lbar_A^alpha - 1) / (x_B - x_A)` with the
/// squared stretches `x`.
///
/// `ln(lbar_B / lbar_A) = ln(1 + (x_B - x_A)/x_A)/2`, so that `exp_m1` and `ln_1p` give the divided difference to
/// round-off down to the limit `alpha / (2 x_A)`. Equation: theory/kinematics#eq-ogden-equal.
fn nearby_slope(alpha: f64, x_a: f64, x_b: f64) -> f64 {
    let gap = x_b - x_a;
    if gap == 0.0 { 0.5 * alpha / x_a } else { (0.5 * alpha * (gap / x_a).ln_1p()).exp_m1() / gap }
}

/// Spectral decompositions of several strains at once, by the widest vectors of the processor.
struct Decomposition<'a>(&'a [SymmetricTensor2; LANES]);

impl Operation for Decomposition<'_> {
    type Output = [SpectralDecomposition; LANES];
    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Self::Output {
        spectral_decompositions(self.0)
    }
}

impl HyperelasticLaw for Ogden {
    fn name(&self) -> &str {
        NAME
    }

    fn energy(&self, right_cauchy_green: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        finite_energy(self.stored(&State::new(right_cauchy_green)?))
    }

    fn stress(&self, right_cauchy_green: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        self.stress_at(&State::new(right_cauchy_green)?)
    }

    fn energy_and_stress(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        self.energy_and_stress_at(&State::new(right_cauchy_green)?)
    }

    fn stress_and_elasticity(
        &self,
        right_cauchy_green: &SymmetricTensor2,
    ) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        self.stress_and_elasticity_at(&State::new(right_cauchy_green)?)
    }

    /// Strains are decomposed side by side.
    fn evaluate(&self, strains: &Strains<'_>, mut wanted: Wanted<'_>) -> Result<(), (usize, ConstitutiveError)> {
        if strains.count < LANES {
            return strains.one_by_one(self, wanted);
        }
        let all: [SymmetricTensor2; LANES] = std::array::from_fn(|point| strains.all.get(point));
        let forms = wide::dispatch(Decomposition(&all));
        for (point, (c, form)) in all.iter().zip(forms).enumerate() {
            self.write(c, form, point, &mut wanted).map_err(|error| (point, error))?;
        }
        Ok(())
    }

    fn volumetric(&self) -> Option<VolumetricSplit> {
        Some(VolumetricSplit {
            rest: Arc::new(Self { kappa: 0.0, ..self.clone() }),
            volume: Arc::new(Power { kappa: self.kappa, beta: self.beta }),
        })
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli {
            shear: 0.5 * self.terms.iter().map(|(mu, alpha)| mu * alpha).sum::<f64>(),
            bulk: self.kappa,
        }
    }
}
