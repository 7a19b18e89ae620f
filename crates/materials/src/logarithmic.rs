//! Logarithmic strain behind a reference map: `E = 1/2 ln(G C G)`, its deviator, and how stresses and moduli in terms of it are those in terms of `C`
//! (theory/inelastic#strain). Not the laws.

use stoss_continuum::volume::logarithm_divided_difference;
use stoss_continuum::{ConstitutiveError, SymmetricTensor2, Tensor2, Tensor4};
use stoss_tensor::{INDEX_PAIRS, SpectralDecomposition, spectral_decomposition};

/// Place of `[row][column]` among the six components.
const AT: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// The deviator.
pub(crate) fn deviator(a: &SymmetricTensor2) -> SymmetricTensor2 {
    *a + SymmetricTensor2::IDENTITY * (-a.trace() / 3.0)
}

/// The tensor with these eigenvalues in place of its own.
pub(crate) fn with_values(form: &SpectralDecomposition, values: [f64; 3]) -> SymmetricTensor2 {
    let v = &form.vectors;
    SymmetricTensor2(INDEX_PAIRS.map(|(i, j)| (0..3).map(|k| values[k] * v[k][i] * v[k][j]).sum()))
}

/// A function of a symmetric tensor.
pub(crate) fn function(a: &SymmetricTensor2, f: impl Fn(f64) -> f64) -> SymmetricTensor2 {
    let form = spectral_decomposition(a);
    with_values(&form, form.values.map(f))
}

/// `b a b` of symmetric tensors.
pub(crate) fn congruence(b: &SymmetricTensor2, a: &SymmetricTensor2) -> SymmetricTensor2 {
    let b = b.to_matrix();
    SymmetricTensor2::from_matrix(&(b * a.to_matrix() * b))
}

/// `ln[x, y, z]`, the second divided difference of the logarithm, to round-off for equal arguments too.
fn second_difference(x: f64, y: f64, z: f64) -> f64 {
    let (low, high) = (x.min(y).min(z), x.max(y).max(z));
    let middle = x.max(y).min(x.min(y).max(z));
    if high - low > 0.05 * high {
        let (upper, lower) =
            (logarithm_divided_difference(high, middle).0, logarithm_divided_difference(low, middle).0);
        return (upper - lower) / (high - low);
    }
    // Taylor's series about the mean; the complete homogeneous polynomials of the relative deviations, whose sum is zero.
    let mean = (x + y + z) / 3.0;
    let (a, b, c) = ((x - mean) / mean, (y - mean) / mean, (z - mean) / mean);
    let (e2, e3) = (a * b + b * c + c * a, a * b * c);
    let mut polynomials = [0.0; 11];
    polynomials[0] = 1.0;
    for k in 2..11 {
        polynomials[k] = -e2 * polynomials[k - 2] + if k >= 3 { e3 * polynomials[k - 3] } else { 0.0 };
    }
    let mut sum = 0.0;
    for k in (2..13_u32).rev() {
        let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
        sum += sign / f64::from(k) * polynomials[k as usize - 2];
    }
    sum / (mean * mean)
}

/// Moduli `a 1 + b 1 (x) 1 + c n (x) n` (`1` of fourth order the symmetric one) of a stress by the logarithmic strain, in the frame of the strain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogModuli {
    pub unit: f64,
    pub sphere: f64,
    pub along: f64,
    pub direction: SymmetricTensor2,
}

impl LogModuli {
    /// `2 m` times the projection on deviators.
    pub fn shear(two_m: f64) -> Self {
        Self { unit: two_m, sphere: -two_m / 3.0, along: 0.0, direction: SymmetricTensor2::ZERO }
    }
}

/// `A = G C G` in spectral form.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogStrain {
    /// Eigenvalues of `A`, ascending.
    values: [f64; 3],
    /// Eigenvectors of `A` as columns.
    frame: Tensor2,
    /// `Q = G N`.
    push: Tensor2,
    /// Eigenvalues of `E`.
    logs: [f64; 3],
}

impl LogStrain {
    /// The logarithmic strain of a right Cauchy-Green tensor `c` and a map; without a map `G = 1`.
    pub fn new(map: Option<&SymmetricTensor2>, c: &SymmetricTensor2) -> Result<Self, ConstitutiveError> {
        if !c.is_finite() {
            return Err(ConstitutiveError::NonFinite);
        }
        let a = map.map_or(*c, |map| congruence(map, c));
        let form = spectral_decomposition(&a);
        if form.values[0] <= 0.0 || form.values[0].is_nan() {
            return Err(ConstitutiveError::NonPositiveJacobian { det_c: form.values.iter().product() });
        }
        let frame = Tensor2::from_columns(&form.vectors);
        let push = map.map_or(frame, |map| map.to_matrix() * frame);
        Ok(Self { values: form.values, frame, push, logs: form.values.map(|x| 0.5 * x.ln()) })
    }

    /// `ln J = tr E`, if `det G = 1`.
    pub fn trace(&self) -> f64 {
        self.logs.iter().sum()
    }

    /// `dev E` in the frame of `A`.
    pub fn deviator(&self) -> SymmetricTensor2 {
        let mean = self.trace() / 3.0;
        let [x, y, z] = self.logs.map(|l| l - mean);
        SymmetricTensor2([x, y, z, 0.0, 0.0, 0.0])
    }

    /// Components in the frame of `A`.
    pub fn turned(&self, a: &SymmetricTensor2) -> SymmetricTensor2 {
        SymmetricTensor2::from_matrix(&(self.frame.transpose() * a.to_matrix() * self.frame))
    }

    /// `L_ij = ln[x_i, x_j]` in the order of the components.
    fn slopes(&self) -> [f64; 6] {
        INDEX_PAIRS.map(|(i, j)| {
            if i == j { 1.0 / self.values[i] } else { logarithm_divided_difference(self.values[i], self.values[j]).0 }
        })
    }

    /// Components `q a q^T` of a symmetric `a`, as a matrix for its plain components.
    fn transformation(&self) -> [[f64; 6]; 6] {
        let q = &self.push;
        INDEX_PAIRS.map(|(a, b)| {
            INDEX_PAIRS.map(
                |(i, j)| {
                    if i == j { q[(a, i)] * q[(b, i)] } else { q[(a, i)] * q[(b, j)] + q[(a, j)] * q[(b, i)] }
                },
            )
        })
    }

    /// Adds the second Piola-Kirchhoff stress that belongs to `t = dw/dE`, given in the frame of `A`.
    pub fn add_stress(&self, t: &SymmetricTensor2, stress: &mut SymmetricTensor2) {
        self.pull(t, &self.slopes(), &self.transformation(), stress);
    }

    fn pull(&self, t: &SymmetricTensor2, slopes: &[f64; 6], turn: &[[f64; 6]; 6], stress: &mut SymmetricTensor2) {
        for k in 0..6 {
            stress.0[k] += (0..6).map(|m| turn[k][m] * t.0[m] * slopes[m]).sum::<f64>();
        }
    }

    /// [`Self::add_stress`], and the moduli `2 dS/dC` for `dt/dE` (theory/inelastic#eq-moduli).
    pub fn add_moduli(
        &self,
        t: &SymmetricTensor2,
        of: &LogModuli,
        stress: &mut SymmetricTensor2,
        moduli: &mut Tensor4,
    ) {
        let (slopes, turn) = (self.slopes(), self.transformation());
        self.pull(t, &slopes, &turn, stress);
        let n = &of.direction.0;
        let mut m = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..6 {
                let unit = match (i == j, i < 3) {
                    (true, true) => of.unit,
                    (true, false) => 0.5 * of.unit,
                    _ => 0.0,
                };
                let sphere = if i < 3 && j < 3 { of.sphere } else { 0.0 };
                m[i][j] = slopes[i] * slopes[j] * (unit + sphere + of.along * n[i] * n[j]);
            }
        }
        // The second derivative of the logarithm: ten different values.
        let x = &self.values;
        let mut second = [[[0.0; 3]; 3]; 3];
        for i in 0..3 {
            for j in i..3 {
                for k in j..3 {
                    let value = second_difference(x[i], x[j], x[k]);
                    for (a, b, c) in [(i, j, k), (i, k, j), (j, i, k), (j, k, i), (k, i, j), (k, j, i)] {
                        second[a][b][c] = value;
                    }
                }
            }
        }
        let half = |p: usize, q: usize| if p == q { 1.0 } else { 0.5 };
        for i in 0..3 {
            for j in 0..3 {
                let twice = 2.0 * t.0[AT[i][j]];
                for k in 0..3 {
                    let value = twice * second[i][k][j] * half(i, k) * half(k, j);
                    m[AT[i][k]][AT[k][j]] += value;
                    m[AT[k][j]][AT[i][k]] += value;
                }
            }
        }
        let mut left = [[0.0; 6]; 6];
        for i in 0..6 {
            for k in 0..6 {
                let factor = turn[i][k];
                for j in 0..6 {
                    left[i][j] += factor * m[k][j];
                }
            }
        }
        for i in 0..6 {
            for j in 0..6 {
                moduli.0[i][j] += (0..6).map(|k| left[i][k] * turn[j][k]).sum::<f64>();
            }
        }
    }
}

/// A reference map and the rotation that the frame of its strain made.
pub(crate) struct Moved {
    pub map: SymmetricTensor2,
    pub rotation: Tensor2,
}

/// The map behind which the strain `C` is `end`, where it was `trial` behind `map` (theory/inelastic#eq-map): `G P` with the symmetric `P`,
/// `1/2 ln(P A P) = end`, made symmetric by a rotation, which is the plastic spin. `coaxial`: `end` has the eigenvectors of `trial`.
///
/// The strain behind the new map is `end` but for the rotation, so that stored energy is continuous.
pub(crate) fn moved(
    map: &SymmetricTensor2,
    c: &SymmetricTensor2,
    trial: &SymmetricTensor2,
    end: &SymmetricTensor2,
    coaxial: bool,
) -> Moved {
    let p = if coaxial {
        function(&(*end - *trial), f64::exp)
    } else {
        let form = spectral_decomposition(&congruence(map, c));
        let root = with_values(&form, form.values.map(f64::sqrt));
        let inverse = with_values(&form, form.values.map(|x| 1.0 / x.sqrt()));
        let target = function(end, |x| (2.0 * x).exp());
        congruence(&inverse, &function(&congruence(&root, &target), f64::sqrt))
    };
    let gp = map.to_matrix() * p.to_matrix();
    let form = spectral_decomposition(&SymmetricTensor2::from_matrix(&(gp * gp.transpose())));
    let inverse = with_values(&form, form.values.map(|x| 1.0 / x.sqrt()));
    Moved { map: with_values(&form, form.values.map(f64::sqrt)), rotation: inverse.to_matrix() * gp }
}

/// `E` behind a map, in reference axes.
pub(crate) fn strain_behind(
    map: &SymmetricTensor2,
    c: &SymmetricTensor2,
) -> Result<SymmetricTensor2, ConstitutiveError> {
    let form = spectral_decomposition(&congruence(map, c));
    if form.values[0] <= 0.0 || form.values[0].is_nan() {
        return Err(ConstitutiveError::NonPositiveJacobian { det_c: form.values.iter().product() });
    }
    Ok(with_values(&form, form.values.map(|x| 0.5 * x.ln())))
}
