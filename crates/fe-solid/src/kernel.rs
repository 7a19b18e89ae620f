//! The arithmetic of one element over plain arrays: gradients, deformation gradient, force, two-point moduli, tangent.
//!
//! Not here: laws, rules of schemes, errors, meshes. Everything is a free function over arrays that are contiguous for each element
//! and component-major (`[component][node]`), so that the innermost loops run over the nodes. The numbers of nodes `N` and of Gauss points
//! `G` are constants of the types: every cell has its own code. The types of hex8 are the default.
//!
//! # How the tangent is formed
//! Instead of `B_I^T D B_J` (theory/kinematics#eq-b, theory/kinematics#eq-tangent) the moduli are pushed once a Gauss point to the two-point form
//! ```text
//! P_iAjB = F^l_iK A_KALB F^r_jL + s S_AB delta_ij
//! ```
//! (`F^l`, `F^r`: left and right deformation gradient, `A` the moduli as a 6x6 matrix, `s` the weight of the geometric
//! term). Then `K_iI,jJ = sum_gp w G_AI P_iAjB G_BJ` with `G_AI = dN_I/dX_A`, which is a product of an `N x 3G` and a
//! `3G x N` matrix for each pair `(i, j)`: the sum over Gauss points and `A` is the inner dimension. That takes about half
//! of the multiplications of the `B` form. If `F^l = F^r` and `A` is symmetric, three of the nine pairs are mirrored.
//!
//! # Vectors
//! What is long runs with the widest vectors that the processor has, found at run time ([`wide`]), over nodes or over Gauss points side by side. No sum is reordered for it and nothing
//! is contracted to a fused multiply-add, so that the bits are the same on every processor. Code of that kind has no closures: they are compiled on their own, for the least of all processors.

use crate::matrices::Matrices;
use stoss_continuum::wide::{self, LANES, Number, Operation, Several, Simd, SymmetricTensors, Tensors4, Wide};
use stoss_continuum::{INDEX_PAIRS, SymmetricTensor2, Tensor4};

pub use crate::matrices::Matrix3;

/// A vector at each node, component-major: `x[i][I]`.
pub type NodalVectors<const N: usize = 8> = [[f64; N]; 3];
/// `dN_I/dX_A` as `[A][I]`.
pub type Gradients<const N: usize = 8> = [[f64; N]; 3];
/// Local tangent, `[I][i][J][j]`: row-major with the unknowns `3 I + i`.
pub type LocalTangent<const N: usize = 8> = [[[[f64; 3]; N]; 3]; N];

/// Place of `[row][column]` of a symmetric tensor among its six components, which are in the order 11, 22, 33, 12, 23, 13 (theory/kinematics#components).
pub use stoss_continuum::components::COMPONENT_OF;

/// What the integrals over one element need of its reference geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementIntegration<const N: usize = 8, const G: usize = 8> {
    /// Gradients of the shape functions at each Gauss point.
    pub gradients: [Gradients<N>; G],
    /// Gauss weight times `det dX/dxi` (a volume).
    pub weights: [f64; G],
}

/// A local tangent as a list, row by row.
#[inline]
pub fn flat<const N: usize>(tangent: &LocalTangent<N>) -> &[f64] {
    tangent.as_flattened().as_flattened().as_flattened()
}

/// `det` of a 3x3 matrix.
#[inline(always)]
pub fn determinant<T: Number>(m: &[[T; 3]; 3]) -> T {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

/// `cof M : D`, the derivative of the determinant of `m` along `d`.
pub(crate) fn determinant_change(m: &Matrix3, d: &Matrix3) -> f64 {
    determinant(&[d[0], m[1], m[2]]) + determinant(&[m[0], d[1], m[2]]) + determinant(&[m[0], m[1], d[2]])
}

/// Gradients of the shape functions and the volume weights of an element with reference positions `x`.
///
/// `natural[g][A][I]` is `dN_I/dxi_A` at Gauss point `g`, `gauss_weights` the weights of the quadrature rule.
///
/// # Errors
/// The first Gauss point with `det dX/dxi <= 0` (or not a number), and that determinant.
pub fn integration<const N: usize, const G: usize>(
    x: &NodalVectors<N>,
    natural: &[Gradients<N>; G],
    gauss_weights: &[f64; G],
) -> Result<ElementIntegration<N, G>, (usize, f64)> {
    let mut out = ElementIntegration { gradients: [[[0.0; N]; 3]; G], weights: [0.0; G] };
    for g in 0..G {
        let (inverse, weight) = inverse_jacobian(x, &natural[g], gauss_weights[g]).map_err(|det| (g, det))?;
        write_gradients(&inverse, &natural[g], &mut out.gradients[g]);
        out.weights[g] = weight;
    }
    Ok(out)
}

/// `dxi_A/dX_a`, `[A][a]`, and the volume of a Gauss point; its `det dX/dxi` if that is not positive.
pub(crate) fn inverse_jacobian<const N: usize>(
    x: &NodalVectors<N>,
    natural: &Gradients<N>,
    gauss_weight: f64,
) -> Result<(Matrix3, f64), f64> {
    // J_aA = dX_a/dxi_A
    let j = deformation_gradient(x, natural);
    let det = determinant(&j);
    // `!(det > 0)` also catches a NaN.
    if !(det > 0.0 && det.is_finite()) {
        return Err(det);
    }
    Ok((inverse(&j, det), gauss_weight * det))
}

/// `dN/dX_a = J^-T_aA dN/dxi_A`.
#[inline(always)]
pub(crate) fn write_gradients<const N: usize>(inverse: &Matrix3, natural: &Gradients<N>, out: &mut Gradients<N>) {
    for a in 0..3 {
        let factors = [inverse[0][a], inverse[1][a], inverse[2][a]];
        for node in 0..N {
            out[a][node] =
                factors[0] * natural[0][node] + factors[1] * natural[1][node] + factors[2] * natural[2][node];
        }
    }
}

/// Cofactors of a matrix: `det m m^-T`.
#[inline]
pub(crate) fn cofactor(m: &Matrix3) -> Matrix3 {
    std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
            m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
        })
    })
}

/// Inverse of a matrix with known determinant.
pub(crate) fn inverse(m: &Matrix3, det: f64) -> Matrix3 {
    let cofactors = cofactor(m);
    std::array::from_fn(|r| std::array::from_fn(|c| cofactors[c][r] / det))
}

/// `F_iA = sum_I q_iI dN_I/dX_A`.
#[inline(always)]
pub fn deformation_gradient<const N: usize>(positions: &NodalVectors<N>, gradients: &Gradients<N>) -> Matrix3 {
    let mut f = [[0.0; 3]; 3];
    for i in 0..3 {
        for a in 0..3 {
            // Four partial sums: short dependency chains, a fixed order.
            let (q, g) = (positions[i].as_chunks::<4>(), gradients[a].as_chunks::<4>());
            let mut sum = [0.0; 4];
            for (k, (q, g)) in q.0.iter().zip(g.0).enumerate() {
                for l in 0..4 {
                    sum[l] = if k == 0 { q[l] * g[l] } else { sum[l] + q[l] * g[l] };
                }
            }
            for (sum, (q, g)) in sum.iter_mut().zip(q.1.iter().zip(g.1)) {
                *sum += q * g;
            }
            f[i][a] = (sum[0] + sum[2]) + (sum[1] + sum[3]);
        }
    }
    f
}

/// `C = F^T F` in the order 11, 22, 33, 12, 23, 13 (plain, not doubled).
#[inline(always)]
pub fn right_cauchy_green<T: Number>(f: &[[T; 3]; 3]) -> [T; 6] {
    let mut c = [f[0][0]; 6];
    for (component, &(a, b)) in c.iter_mut().zip(&INDEX_PAIRS) {
        *component = f[0][a] * f[0][b] + f[1][a] * f[1][b] + f[2][a] * f[2][b];
    }
    c
}

/// Adds the forces of the stresses at `count` Gauss points, which act on `f`, as [`add_force`] does for one.
#[inline(always)]
pub(crate) fn add_forces<S: Simd, const N: usize>(
    simd: S,
    f: &Matrices,
    stress: &SymmetricTensors,
    gradients: &[Gradients<N>],
    weights: &Several,
    force: &mut NodalVectors<N>,
) {
    let mut p = Matrices::ZERO;
    for part in 0..wide::parts::<S>() {
        let (f, s, weight) = (f.load(simd, part), stress.load(simd, part), Wide::load(simd, weights, part));
        for i in 0..3 {
            for b in 0..3 {
                let mut sum = f[i][0] * s[COMPONENT_OF[0][b]];
                sum = sum + f[i][1] * s[COMPONENT_OF[1][b]];
                sum = sum + f[i][2] * s[COMPONENT_OF[2][b]];
                (weight * sum).store(&mut p.0[i][b], part);
            }
        }
    }
    for (l, gradients) in gradients.iter().enumerate() {
        add_stress(&p.get(l), gradients, force);
    }
}

/// Adds `P grad N_I` to the nodal forces.
#[inline(always)]
fn add_stress<const N: usize>(p: &Matrix3, gradients: &Gradients<N>, force: &mut NodalVectors<N>) {
    for i in 0..3 {
        for node in 0..N {
            force[i][node] +=
                p[i][0] * gradients[0][node] + p[i][1] * gradients[1][node] + p[i][2] * gradients[2][node];
        }
    }
}

/// Adds `w F S grad N_I` to the nodal forces: `F_iI += w F_iA S_AB G_BI`.
#[inline(always)]
pub fn add_force<const N: usize>(
    f: &Matrix3,
    stress: &[f64; 6],
    gradients: &Gradients<N>,
    weight: f64,
    force: &mut NodalVectors<N>,
) {
    let mut p = [[0.0; 3]; 3];
    for i in 0..3 {
        for b in 0..3 {
            p[i][b] = weight
                * (f[i][0] * stress[COMPONENT_OF[0][b]]
                    + f[i][1] * stress[COMPONENT_OF[1][b]]
                    + f[i][2] * stress[COMPONENT_OF[2][b]]);
        }
    }
    add_stress(&p, gradients, force);
}

/// `w P_iAjB G_BJ` for all Gauss points, `[3 i + j][g][A][J]`: the right factors of the tangent's products.
pub type TangentFactors<const N: usize = 8, const G: usize = 8> = [[[[f64; N]; 3]; G]; 9];

/// What a Gauss point adds to the tangent: the two-point moduli are made of it (module documentation).
#[derive(Clone, Copy, Debug)]
pub struct TangentPoint<'a> {
    /// `F^l`.
    pub left: &'a Matrix3,
    /// `F^r`.
    pub right: &'a Matrix3,
    /// `A_v`: 6x6, for strains with doubled shears.
    pub moduli: &'a [[f64; 6]; 6],
    /// `S`.
    pub stress: &'a [f64; 6],
    /// Factor of the geometric term.
    pub geometric: f64,
    /// Volume of the point.
    pub weight: f64,
}

/// The parts of the Gauss points from `first` on in [`TangentFactors`], side by side. With `symmetric` only the pairs `i <= j` are written.
pub fn tangent_factors<const N: usize, const G: usize, const L: usize>(
    points: &[TangentPoint<'_>; L],
    gradients: &[Gradients<N>; G],
    first: usize,
    symmetric: bool,
    factors: &mut TangentFactors<N, G>,
) {
    wide::dispatch(WriteFactors { points, gradients, first, symmetric, factors });
}

/// The arguments of [`tangent_factors`].
struct WriteFactors<'a, const N: usize, const G: usize, const L: usize> {
    points: &'a [TangentPoint<'a>; L],
    gradients: &'a [Gradients<N>; G],
    first: usize,
    symmetric: bool,
    factors: &'a mut TangentFactors<N, G>,
}

impl<const N: usize, const G: usize, const L: usize> Operation for WriteFactors<'_, N, G, L> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { points, gradients, first, symmetric, factors } = self;
        for (k, points) in points.chunks(LANES).enumerate() {
            let (mut left, mut right) = (Matrices::ZERO, Matrices::ZERO);
            let PointBuffers { mut moduli, mut two_point } = PointBuffers::default();
            let mut stress = SymmetricTensors::ZERO;
            let (mut weights, mut scales) = ([0.0; LANES], [0.0; LANES]);
            for (l, point) in points.iter().enumerate() {
                left.set(l, point.left);
                right.set(l, point.right);
                moduli.set(l, &Tensor4(*point.moduli));
                stress.set(l, &SymmetricTensor2(*point.stress));
                (weights[l], scales[l]) = (point.weight, point.geometric * point.weight);
            }
            let (left, right, moduli, stress) = (&left, &right, &moduli, &stress);
            let of = TangentPoints { left, right, moduli, stress, weights: &weights, scales: &scales };
            write_factors(simd, &of, points.len(), gradients, first + LANES * k, symmetric, &mut two_point, factors);
        }
    }
}

/// `w P_iAjB` of several points, `[3 i + j][A][B][point]`; of no use where `j < i` if it is symmetric.
pub(crate) type TwoPointModuli = [[[Several; 3]; 3]; 9];

/// Room for what is computed at points side by side, kept from element to element: clearing it would take time.
#[derive(Debug)]
pub(crate) struct PointBuffers {
    pub moduli: Tensors4,
    pub two_point: TwoPointModuli,
}

impl Default for PointBuffers {
    fn default() -> Self {
        Self { moduli: Tensors4::ZERO, two_point: [[[[0.0; LANES]; 3]; 3]; 9] }
    }
}

/// [`TangentPoint`]s side by side.
pub(crate) struct TangentPoints<'a> {
    pub left: &'a Matrices,
    pub right: &'a Matrices,
    pub moduli: &'a Tensors4,
    pub stress: &'a SymmetricTensors,
    pub weights: &'a Several,
    /// Factors of the geometric term, times the weights.
    pub scales: &'a Several,
}

/// [`tangent_factors`] of `count` points for those who run with wide vectors already.
#[inline(always)]
pub(crate) fn write_factors<S: Simd, const N: usize, const G: usize>(
    simd: S,
    points: &TangentPoints<'_>,
    count: usize,
    gradients: &[Gradients<N>; G],
    first: usize,
    symmetric: bool,
    two_point: &mut TwoPointModuli,
    factors: &mut TangentFactors<N, G>,
) {
    for part in 0..wide::parts::<S>() {
        two_point_moduli(simd, points, part, symmetric, two_point);
    }
    for lane in 0..count {
        write_rows(two_point, lane, &gradients[first + lane], first + lane, symmetric, factors);
    }
}

/// All points take the same operations in the same order.
#[inline(always)]
fn two_point_moduli<S: Simd>(simd: S, of: &TangentPoints<'_>, part: usize, symmetric: bool, out: &mut TwoPointModuli) {
    let weight = Wide::load(simd, of.weights, part);
    for j in 0..3 {
        // w F^r_jL
        let mut right = [weight; 3];
        for (l, right) in right.iter_mut().enumerate() {
            *right = *right * Wide::load(simd, &of.right.0[j][l], part);
        }
        // h[KA][B] = w A_KALB F^r_jL
        let mut h = [[weight; 3]; 6];
        for (h, moduli) in h.iter_mut().zip(&of.moduli.0) {
            for (b, h) in h.iter_mut().enumerate() {
                *h = Wide::load(simd, &moduli[COMPONENT_OF[0][b]], part) * right[0];
                *h = *h + Wide::load(simd, &moduli[COMPONENT_OF[1][b]], part) * right[1];
                *h = *h + Wide::load(simd, &moduli[COMPONENT_OF[2][b]], part) * right[2];
            }
        }
        for i in 0..3 {
            if symmetric && i > j {
                continue;
            }
            let mut left = right;
            for (k, left) in left.iter_mut().enumerate() {
                *left = Wide::load(simd, &of.left.0[i][k], part);
            }
            for a in 0..3 {
                for b in 0..3 {
                    let mut p = left[0] * h[COMPONENT_OF[0][a]][b];
                    p = p + left[1] * h[COMPONENT_OF[1][a]][b];
                    p = p + left[2] * h[COMPONENT_OF[2][a]][b];
                    if i == j {
                        let stress = Wide::load(simd, &of.stress.0[COMPONENT_OF[a][b]], part);
                        p = p + Wide::load(simd, of.scales, part) * stress;
                    }
                    p.store(&mut out[3 * i + j][a][b], part);
                }
            }
        }
    }
}

/// The rows `w P_iAjB G_BJ` of a point.
#[inline(always)]
fn write_rows<const N: usize, const G: usize>(
    moduli: &TwoPointModuli,
    lane: usize,
    gradients: &Gradients<N>,
    gauss_point: usize,
    symmetric: bool,
    factors: &mut TangentFactors<N, G>,
) {
    for i in 0..3 {
        for j in 0..3 {
            if symmetric && j < i {
                continue;
            }
            for a in 0..3 {
                let p = &moduli[3 * i + j][a];
                let p = [p[0][lane], p[1][lane], p[2][lane]];
                let row = &mut factors[3 * i + j][gauss_point][a];
                for node in 0..N {
                    row[node] = p[0] * gradients[0][node] + p[1] * gradients[1][node] + p[2] * gradients[2][node];
                }
            }
        }
    }
}

/// The products `K_iI,jJ = sum_k G_kI T_kJ` and their placement in the local tangent, which is overwritten.
pub fn tangent_from_factors<const N: usize, const G: usize>(
    gradients: &[Gradients<N>; G],
    factors: &TangentFactors<N, G>,
    symmetric: bool,
    factor: f64,
    tangent: &mut LocalTangent<N>,
) {
    wide::dispatch(FormTangent { gradients, factors, symmetric, factor, tangent });
}

/// The arguments of [`tangent_from_factors`].
struct FormTangent<'a, const N: usize, const G: usize> {
    gradients: &'a [Gradients<N>; G],
    factors: &'a TangentFactors<N, G>,
    symmetric: bool,
    factor: f64,
    tangent: &'a mut LocalTangent<N>,
}

impl<const N: usize, const G: usize> Operation for FormTangent<'_, N, G> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { gradients, factors, symmetric, factor, tangent } = self;
        form_tangent(simd, gradients, factors, symmetric, factor, tangent);
    }
}

/// [`tangent_from_factors`] for those who run with wide vectors already.
#[inline(always)]
pub(crate) fn form_tangent<S: Simd, const N: usize, const G: usize>(
    simd: S,
    gradients: &[Gradients<N>; G],
    factors: &TangentFactors<N, G>,
    symmetric: bool,
    factor: f64,
    tangent: &mut LocalTangent<N>,
) {
    const { assert!(N >= LANES) };
    for i in 0..3 {
        let mut products = Products { gradients, factors, i, factor, tangent };
        // Tiles of a few rows and as many columns as a vector is long; the last ones overlap those before. As many rows as leave the sums in registers.
        for column in (0..N).step_by(S::F64_LANES) {
            let column = column.min(N - S::F64_LANES);
            for row in (0..N).step_by(LANES) {
                let row = row.min(N - LANES);
                // What is below the diagonal is mirrored.
                let below = symmetric && column + S::F64_LANES <= row;
                match if symmetric { i + usize::from(below) } else { 0 } {
                    0 => {
                        products.tile::<S, 3, 2>(simd, row, column);
                        products.tile::<S, 3, 2>(simd, row + 2, column);
                    }
                    1 => products.tile::<S, 2, 4>(simd, row, column),
                    2 => products.tile::<S, 1, 4>(simd, row, column),
                    _ => {}
                }
            }
        }
    }
    if symmetric {
        mirror(tangent);
    }
}

/// What the pairs `i < j` are, and of the pairs `i = j` what is above the diagonal, on the other side of it.
#[inline(always)]
fn mirror<const N: usize>(tangent: &mut LocalTangent<N>) {
    for row in 0..N {
        for i in 0..3 {
            for column in 0..N {
                for j in i..3 {
                    if j > i || column > row {
                        tangent[column][j][row][i] = tangent[row][i][column][j];
                    }
                }
            }
        }
    }
}

/// The rows `(I, i)` of the tangent while they are formed.
struct Products<'a, const N: usize, const G: usize> {
    gradients: &'a [Gradients<N>; G],
    factors: &'a TangentFactors<N, G>,
    i: usize,
    factor: f64,
    tangent: &'a mut LocalTangent<N>,
}

impl<const N: usize, const G: usize> Products<'_, N, G> {
    /// `R` nodes from `row`, a vector of nodes from `column`, the last `J` components.
    #[inline(always)]
    fn tile<S: Simd, const J: usize, const R: usize>(&mut self, simd: S, row: usize, column: usize) {
        let Self { gradients, factors, i, factor, ref mut tangent } = *self;
        assert!(row + R <= N && column + S::F64_LANES <= N);
        let left = gradients.as_flattened();
        let mut sum = [[Wide::splat(simd, 0.0); J]; R];
        for k in 0..3 * G {
            let mut right = [Wide::splat(simd, 0.0); J];
            for (j, right) in right.iter_mut().enumerate() {
                let all = &factors[3 * i + (3 - J) + j].as_flattened()[k];
                *right = Wide::load_from(simd, &all[column..column + S::F64_LANES]);
            }
            let left = &left[k][row..row + R];
            for (sum, &left) in sum.iter_mut().zip(left) {
                let left = Wide::splat(simd, left);
                for j in 0..J {
                    sum[j] = sum[j] + left * right[j];
                }
            }
        }
        for r in 0..R {
            let mut lanes = [[0.0; LANES]; J];
            for j in 0..J {
                (sum[r][j] * factor).store(&mut lanes[j], 0);
            }
            let row = &mut tangent[row + r][i][column..column + S::F64_LANES];
            for (c, entry) in row.iter_mut().enumerate() {
                for j in 0..J {
                    entry[3 - J + j] = lanes[j][c];
                }
            }
        }
    }
}
