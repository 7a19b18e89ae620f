//! Every law of the catalogue with the parameters of the literature, and its energy written once more over complex
//! numbers.

use std::sync::Arc;

use stoss_continuum::{HyperelasticLaw, SymmetricTensor2};
use stoss_materials::{FirstInvariant, Hencky, MooneyRivlin, NeoHooke, Ogden, SaintVenantKirchhoff};
use stoss_numerical_derivative::{Analytic, AnalyticVector, Method, Scalar, Step, Workspace, jacobian};

use crate::workspace::Outcome;

/// A law by its parameters: the energies of theory/kinematics#laws, as they are printed there.
#[derive(Clone, Copy, Debug)]
pub enum Energy {
    /// `lambda`, `mu`.
    SaintVenantKirchhoff(f64, f64),
    /// `lambda`, `mu`.
    NeoHooke(f64, f64),
    /// `lambda`, `mu`.
    Hencky(f64, f64),
    /// `c1`, `c2`, `c`.
    MooneyRivlin(f64, f64, f64),
    /// `c1`, `c2`, `c3`, `kappa`.
    Yeoh([f64; 3], f64),
    /// `mu`, `limit`, `kappa`.
    Gent(f64, f64, f64),
    /// `mu`, `lock`, `kappa`.
    ArrudaBoyce(f64, f64, f64),
    /// `mu_P`, `alpha_P`, `kappa`, `beta`.
    Ogden([f64; 3], [f64; 3], f64, f64),
}

/// A law that is measured.
pub struct Sample {
    /// Energy of the law.
    pub energy: Energy,
    /// Young's modulus and Poisson's ratio of these parameters in the literature (theory/kinematics#moduli), with the
    /// digits there.
    pub literature: (f64, f64),
}

/// All laws that a scene can name.
pub const LAWS: [Sample; 8] = [
    Sample { energy: Energy::SaintVenantKirchhoff(1298.0769, 865.3846), literature: (2250.0, 0.3) },
    Sample { energy: Energy::NeoHooke(1298.0769, 865.3846), literature: (2250.0, 0.3) },
    Sample { energy: Energy::Hencky(1298.0769, 865.3846), literature: (2250.0, 0.3) },
    Sample { energy: Energy::MooneyRivlin(176_051.0, 4332.63, 2e6), literature: (1.05257e6, 0.4588) },
    // Of the moduli 2 c1 = 1 and 2; of Arruda and Boyce's the series 1 + 3/(5 L^2) + 99/(175 L^4) + 513/(875 L^6) + 42039/(67375 L^8).
    Sample { energy: Energy::Yeoh([0.5, -0.005, 0.0002], 2.0), literature: (2.571429, 0.28571) },
    Sample { energy: Energy::Gent(1.0, 1000.0, 2.0), literature: (2.571429, 0.28571) },
    Sample { energy: Energy::ArrudaBoyce(1.0, 4.0, 2.0), literature: (2.658791, 0.27843) },
    Sample {
        energy: Energy::Ogden([6300.0, 12.0, -100.0], [1.3, 5.0, -2.0], 2000.0, 9.0),
        literature: (7437.65, -0.1198),
    },
];

impl Energy {
    /// The law of the catalogue.
    pub fn law(&self) -> Outcome<Arc<dyn HyperelasticLaw>> {
        Ok(match self {
            Self::SaintVenantKirchhoff(lambda, mu) => Arc::new(SaintVenantKirchhoff::new(*lambda, *mu)?),
            Self::NeoHooke(lambda, mu) => Arc::new(NeoHooke::new(*lambda, *mu)?),
            Self::Hencky(lambda, mu) => Arc::new(Hencky::new(*lambda, *mu)?),
            Self::MooneyRivlin(c1, c2, c) => Arc::new(MooneyRivlin::new(*c1, *c2, *c)?),
            Self::Yeoh(c, kappa) => Arc::new(FirstInvariant::yeoh(*c, *kappa)?),
            Self::Gent(mu, limit, kappa) => Arc::new(FirstInvariant::gent(*mu, *limit, *kappa)?),
            Self::ArrudaBoyce(mu, lock, kappa) => Arc::new(FirstInvariant::arruda_boyce(*mu, *lock, *kappa)?),
            Self::Ogden(mu, alpha, kappa, beta) => Arc::new(Ogden::new(mu, alpha, *kappa, *beta)?),
        })
    }

    /// `2 dW/dC` by the complex step: exact but for round-off.
    pub fn stress(&self, c: &SymmetricTensor2) -> Outcome<SymmetricTensor2> {
        let (mut gradient, mut workspace) = ([0.0; 6], Workspace::default());
        jacobian(&mut Analytic(*self), &c.0, Method::ComplexStep, Step::default(), &mut workspace, &mut gradient)?;
        Ok(twice_by_tensor(&gradient))
    }
}

/// `2 dw/dC` from the derivatives by the six stored components: a shear component stands for two entries of the tensor.
pub fn twice_by_tensor(gradient: &[f64; 6]) -> SymmetricTensor2 {
    SymmetricTensor2(std::array::from_fn(|a| if a < 3 { 2.0 * gradient[a] } else { gradient[a] }))
}

impl AnalyticVector for Energy {
    /// `W(C)` of the six stored components.
    fn at<S: Scalar>(&self, c: &[S], value: &mut [S]) {
        let [xx, yy, zz, xy, yz, xz] = std::array::from_fn(|a| c[a]);
        let trace = xx + yy + zz;
        let second = xx * yy + yy * zz + xx * zz - xy * xy - yz * yz - xz * xz;
        let det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        let log_j = det.ln() * 0.5;
        let first = (log_j * (-2.0 / 3.0)).exp() * trace;
        let of_volume = |kappa: f64| log_j * log_j * (0.5 * kappa);
        value[0] = match *self {
            Self::SaintVenantKirchhoff(lambda, mu) => {
                let trace_e = (trace - 3.0) * 0.5;
                // E:E = (tr C^2 - 2 tr C + 3)/4.
                let square = (trace * trace - second * 2.0 - trace * 2.0 + 3.0) * 0.25;
                trace_e * trace_e * (0.5 * lambda) + square * mu
            }
            Self::NeoHooke(lambda, mu) => (trace - 3.0) * (0.5 * mu) + log_j * log_j * (0.5 * lambda) - log_j * mu,
            Self::Hencky(lambda, mu) => {
                // E = ln(C)/2: mu E:E + lambda/2 (tr E)^2.
                trace_of_squared_logarithm(&[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) * (0.25 * mu)
                    + log_j * log_j * (0.5 * lambda)
            }
            Self::MooneyRivlin(c1, c2, c) => {
                let volume = det.sqrt() - 1.0;
                (trace - 3.0) * c1 + (second - 3.0) * c2 + volume * volume * c - log_j * (2.0 * (c1 + 2.0 * c2))
            }
            Self::Yeoh([c1, c2, c3], kappa) => {
                let x = first - 3.0;
                x * c1 + x * x * c2 + x * x * x * c3 + of_volume(kappa)
            }
            Self::Gent(mu, limit, kappa) => {
                ((first - 3.0) * (-1.0 / limit) + 1.0).ln() * (-0.5 * mu * limit) + of_volume(kappa)
            }
            Self::ArrudaBoyce(mu, lock, kappa) => {
                let terms = [1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673_750.0];
                let (mut power, mut three, mut scale, mut sum) = (first, 3.0, mu, of_volume(kappa));
                for term in terms {
                    sum += (power - three) * (term * scale);
                    (power, three, scale) = (power * first, three * 3.0, scale / (lock * lock));
                }
                sum
            }
            Self::Ogden(mu, alpha, kappa, beta) => {
                let volumetric = log_j / beta + ((log_j * -beta).exp() - 1.0) / (beta * beta);
                let traces = traces_of_powers(&[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], alpha.map(|a| 0.5 * a));
                let mut sum = volumetric * kappa;
                for (trace, (mu, alpha)) in traces.into_iter().zip(mu.into_iter().zip(alpha)) {
                    // lambda_A^alpha summed is tr C^(alpha/2).
                    sum += ((log_j * (-alpha / 3.0)).exp() * trace - 3.0) * (mu / alpha);
                }
                sum
            }
        };
    }
}

type Matrix<S> = [[S; 3]; 3];

fn matrix<S>(entry: impl Fn(usize, usize) -> S) -> Matrix<S> {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn product<S: Scalar>(a: &Matrix<S>, b: &Matrix<S>) -> Matrix<S> {
    matrix(|i, j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
}

fn inverse<S: Scalar>(a: &Matrix<S>) -> Matrix<S> {
    let cofactor = |i: usize, j: usize| {
        let (p, q, r, s) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        a[p][r] * a[q][s] - a[p][s] * a[q][r]
    };
    let det = a[0][0] * cofactor(0, 0) + a[0][1] * cofactor(0, 1) + a[0][2] * cofactor(0, 2);
    matrix(|i, j| cofactor(j, i) / det)
}

/// Square roots that are taken of a tensor: they bring eigenvalues between 0.02 and 10 to `|X| < 0.07`, where 14 terms reach 1e-17.
const ROOTS: usize = 6;
const TERMS: u32 = 14;

fn unit<S: Scalar>(i: usize, j: usize) -> S {
    S::from(if i == j { 1.0 } else { 0.0 })
}

/// `X` with `1 + X = C^(2^-ROOTS)`, by square roots (Denman and Beavers).
fn root_less_one<S: Scalar>(c: &Matrix<S>) -> Matrix<S> {
    let mut root = *c;
    for _ in 0..ROOTS {
        let (mut y, mut z) = (root, matrix(unit::<S>));
        // Quadratic convergence; that of the imaginary part is one iteration late.
        for _ in 0..10 {
            let (y_inverse, z_inverse) = (inverse(&y), inverse(&z));
            (y, z) =
                (matrix(|i, j| (y[i][j] + z_inverse[i][j]) * 0.5), matrix(|i, j| (z[i][j] + y_inverse[i][j]) * 0.5));
        }
        root = y;
    }
    matrix(|i, j| root[i][j] - unit::<S>(i, j))
}

/// `tr (ln C)^2` without eigenvalues: `ln C = 2^k ln(1 + X)`.
fn trace_of_squared_logarithm<S: Scalar>(c: &Matrix<S>) -> S {
    let x = root_less_one(c);
    // ln(1 + X) = X (1 - X (1/2 - X (1/3 - ...)))
    let mut sum = matrix(|i, j| unit::<S>(i, j) * (1.0 / f64::from(TERMS)));
    for n in (1..TERMS).rev() {
        let next = product(&x, &sum);
        sum = matrix(|i, j| unit::<S>(i, j) * (1.0 / f64::from(n)) - next[i][j]);
    }
    let log = product(&x, &sum);
    let square = product(&log, &log);
    let scale = f64::from(1_u32 << ROOTS);
    (square[0][0] + square[1][1] + square[2][2]) * (scale * scale)
}

/// `tr C^e` for real exponents without eigenvalues, which have no derivative where they meet:
/// `C^e = ((1 + X)^e)^(2^k)`, `(1 + X)^e` by its binomial series.
fn traces_of_powers<S: Scalar>(c: &Matrix<S>, exponents: [f64; 3]) -> [S; 3] {
    let x = root_less_one(c);
    exponents.map(|exponent| {
        let mut power = matrix(unit::<S>);
        for n in (1..=TERMS).rev() {
            let next = product(&x, &power);
            let factor = (exponent - f64::from(n) + 1.0) / f64::from(n);
            power = matrix(|i, j| unit::<S>(i, j) + next[i][j] * factor);
        }
        for _ in 0..ROOTS {
            power = product(&power, &power);
        }
        power[0][0] + power[1][1] + power[2][2]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(energy: Energy, c: [f64; 6]) -> f64 {
        let mut value = [0.0];
        energy.at(&c, &mut value);
        value[0]
    }

    #[test]
    fn energies_of_a_uniform_dilation() {
        // C = 4 1: J = 8, E = 3/2 1, I1 = 12, I2 = 48; isochoric stretches are 1.
        let c = [4.0, 4.0, 4.0, 0.0, 0.0, 0.0];
        let log = 8.0_f64.ln();
        let expected = [
            (Energy::SaintVenantKirchhoff(2.0, 3.0), 4.5 * 4.5 + 3.0 * 6.75),
            (Energy::NeoHooke(2.0, 3.0), 1.5 * 9.0 + log * log - 3.0 * log),
            (Energy::Hencky(2.0, 3.0), log * log + 3.0 * 3.0 * (log / 3.0) * (log / 3.0)),
            // Of a dilation only the volume counts.
            (Energy::Yeoh([1.0, 2.0, 3.0], 2.0), log * log),
            (Energy::Gent(1.0, 10.0, 2.0), log * log),
            (Energy::ArrudaBoyce(1.0, 4.0, 2.0), log * log),
            (Energy::MooneyRivlin(2.0, 3.0, 0.5), 18.0 + 3.0 * 45.0 + 0.5 * 49.0 - 16.0 * log),
            (Energy::Ogden([1.0, 2.0, -3.0], [1.3, 5.0, -2.0], 2.0, -1.0), 2.0 * (-log + 7.0)),
        ];
        for (energy, expected) in expected {
            assert!((value(energy, c) - expected).abs() < 1e-12 * expected, "{energy:?}: {}", value(energy, c));
        }
    }

    #[test]
    fn traces_of_powers_of_known_matrices() {
        let c = matrix(|i, j| if i == j { [0.25, 4.0, 1.0][i] } else { 0.0 });
        let traces = traces_of_powers(&c, [0.5, 2.0, -1.0]);
        for (trace, expected) in traces.into_iter().zip([3.5, 17.0625, 5.25]) {
            assert!((trace / expected - 1.0).abs() < 1e-13, "{trace}");
        }
        // With shear: tr A^2 = A : A, whatever the eigenvalues.
        let c = [[2.0, 0.5, 0.1], [0.5, 1.0, -0.2], [0.1, -0.2, 0.8]];
        let square: f64 = c.as_flattened().iter().map(|x| x * x).sum();
        assert!((traces_of_powers(&c, [2.0, 1.0, 1.0])[0] / square - 1.0).abs() < 1e-13);
    }

    #[test]
    fn the_stress_doubles_the_derivatives_by_normal_components_only() {
        // W = lambda/8 (tr C - 3)^2 + ...: with mu -> 0 the stress is lambda/2 (tr C - 3) 1.
        let stress = Energy::SaintVenantKirchhoff(2.0, 0.0).stress(&SymmetricTensor2([2.0, 1.0, 1.0, 0.3, 0.0, 0.0]));
        let expected = SymmetricTensor2([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        assert!((stress.unwrap() - expected).norm() < 1e-14);
        // S = 2 mu E.
        let stress = Energy::SaintVenantKirchhoff(0.0, 2.0).stress(&SymmetricTensor2([1.0, 1.0, 1.0, 0.3, 0.0, 0.0]));
        assert!((stress.unwrap() - SymmetricTensor2([0.0, 0.0, 0.0, 0.6, 0.0, 0.0])).norm() < 1e-14);
    }
}
