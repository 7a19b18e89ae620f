//! The arithmetic of one element over plain arrays: gradients, deformation gradient, force, two-point moduli, tangent.
//!
//! Not here: laws, rules, errors, meshes. Everything is a free function over arrays that are contiguous for each element
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
//! What is long runs with the widest vectors that the processor has, found at run time (`pulp`), over nodes or over Gauss points side by side. No sum is reordered for it and nothing
//! is contracted to a fused multiply-add, so that the bits are the same on every processor.

/// A 3x3 matrix, `[row][column]`.
pub type Matrix3 = [[f64; 3]; 3];
/// A vector at each node, component-major: `x[i][I]`.
pub type NodalVectors<const N: usize = 8> = [[f64; N]; 3];
/// `dN_I/dX_A` as `[A][I]`.
pub type Gradients<const N: usize = 8> = [[f64; N]; 3];
/// Local tangent, `[I][i][J][j]`: row-major with the unknowns `3 I + i`.
pub type LocalTangent<const N: usize = 8> = [[[[f64; 3]; N]; 3]; N];

/// Place of `[row][column]` of a symmetric tensor among its six components, which are in the order 11, 22, 33, 12, 23, 13 (theory/kinematics#components).
pub const COMPONENT_OF: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

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
pub fn determinant(m: &Matrix3) -> f64 {
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
/// `natural[g][A][I]` is `dN_I/dxi_A` at Gauss point `g`, `gauss_weights` the weights of the rule.
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
        // J_aA = dX_a/dxi_A
        let j = deformation_gradient(x, &natural[g]);
        let det = determinant(&j);
        // `!(det > 0)` also catches a NaN.
        if !(det > 0.0 && det.is_finite()) {
            return Err((g, det));
        }
        let inverse = inverse(&j, det);
        for a in 0..3 {
            for node in 0..N {
                // dN/dX_a = J^-T_aA dN/dxi_A
                out.gradients[g][a][node] = inverse[0][a] * natural[g][0][node]
                    + inverse[1][a] * natural[g][1][node]
                    + inverse[2][a] * natural[g][2][node];
            }
        }
        out.weights[g] = gauss_weights[g] * det;
    }
    Ok(out)
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
pub fn right_cauchy_green(f: &Matrix3) -> [f64; 6] {
    let dot = |a: usize, b: usize| f[0][a] * f[0][b] + f[1][a] * f[1][b] + f[2][a] * f[2][b];
    [dot(0, 0), dot(1, 1), dot(2, 2), dot(0, 1), dot(1, 2), dot(0, 2)]
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
    for i in 0..3 {
        let mut p = [0.0; 3];
        for b in 0..3 {
            p[b] = weight
                * (f[i][0] * stress[COMPONENT_OF[0][b]]
                    + f[i][1] * stress[COMPONENT_OF[1][b]]
                    + f[i][2] * stress[COMPONENT_OF[2][b]]);
        }
        for node in 0..N {
            force[i][node] += p[0] * gradients[0][node] + p[1] * gradients[1][node] + p[2] * gradients[2][node];
        }
    }
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
    pulp::Arch::new().dispatch(WriteFactors { points, gradients, first, symmetric, factors });
}

/// The arguments of [`tangent_factors`].
struct WriteFactors<'a, const N: usize, const G: usize, const L: usize> {
    points: &'a [TangentPoint<'a>; L],
    gradients: &'a [Gradients<N>; G],
    first: usize,
    symmetric: bool,
    factors: &'a mut TangentFactors<N, G>,
}

impl<const N: usize, const G: usize, const L: usize> pulp::WithSimd for WriteFactors<'_, N, G, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { points, gradients, first, symmetric, factors } = self;
        write_factors(points, gradients, first, symmetric, factors);
    }
}

/// `w P_iAjB` of several points, `[3 i + j][A][B][point]`; with `symmetric` zero where `j < i`.
type TwoPointModuli<const L: usize> = [[[[f64; L]; 3]; 3]; 9];

/// [`tangent_factors`] for those who run with wide vectors already.
#[inline(always)]
pub(crate) fn write_factors<const N: usize, const G: usize, const L: usize>(
    points: &[TangentPoint<'_>; L],
    gradients: &[Gradients<N>; G],
    first: usize,
    symmetric: bool,
    factors: &mut TangentFactors<N, G>,
) {
    let moduli = two_point_moduli(&SideBySide::new(points), symmetric);
    for lane in 0..L {
        write_rows(&moduli, lane, &gradients[first + lane], first + lane, symmetric, factors);
    }
}

/// Points side by side, `[component][point]`.
struct SideBySide<const L: usize> {
    left: [[[f64; L]; 3]; 3],
    right: [[[f64; L]; 3]; 3],
    moduli: [[[f64; L]; 6]; 6],
    stress: [[f64; L]; 6],
    weight: [f64; L],
    /// Of the geometric term.
    scale: [f64; L],
}

impl<const L: usize> SideBySide<L> {
    /// Not inlined: what follows then finds the points of a component beside each other in memory, where the compiler sees that they fit into vectors.
    #[inline(never)]
    fn new(points: &[TangentPoint<'_>; L]) -> Self {
        let mut all = Self {
            left: [[[0.0; L]; 3]; 3],
            right: [[[0.0; L]; 3]; 3],
            moduli: [[[0.0; L]; 6]; 6],
            stress: [[0.0; L]; 6],
            weight: [0.0; L],
            scale: [0.0; L],
        };
        for (l, point) in points.iter().enumerate() {
            for i in 0..3 {
                for a in 0..3 {
                    all.left[i][a][l] = point.left[i][a];
                    all.right[i][a][l] = point.right[i][a];
                }
            }
            for v in 0..6 {
                all.stress[v][l] = point.stress[v];
                for w in 0..6 {
                    all.moduli[v][w][l] = point.moduli[v][w];
                }
            }
            all.weight[l] = point.weight;
            all.scale[l] = point.geometric * point.weight;
        }
        all
    }
}

/// All points take the same operations in the same order.
#[inline(always)]
fn two_point_moduli<const L: usize>(of: &SideBySide<L>, symmetric: bool) -> TwoPointModuli<L> {
    // h[KA][j][B] = w A_KALB F^r_jL
    let mut h = [[[[0.0; L]; 3]; 3]; 6];
    for ka in 0..6 {
        for j in 0..3 {
            for b in 0..3 {
                let m = &of.moduli[ka];
                let (first, second, third) = (&m[COMPONENT_OF[0][b]], &m[COMPONENT_OF[1][b]], &m[COMPONENT_OF[2][b]]);
                let right = &of.right[j];
                for l in 0..L {
                    h[ka][j][b][l] =
                        of.weight[l] * (first[l] * right[0][l] + second[l] * right[1][l] + third[l] * right[2][l]);
                }
            }
        }
    }
    let mut p = [[[[0.0; L]; 3]; 3]; 9];
    for i in 0..3 {
        for j in 0..3 {
            if symmetric && j < i {
                continue;
            }
            for a in 0..3 {
                for b in 0..3 {
                    let (first, second) = (&h[COMPONENT_OF[0][a]][j][b], &h[COMPONENT_OF[1][a]][j][b]);
                    let third = &h[COMPONENT_OF[2][a]][j][b];
                    let (left, p) = (&of.left[i], &mut p[3 * i + j][a][b]);
                    for l in 0..L {
                        p[l] = left[0][l] * first[l] + left[1][l] * second[l] + left[2][l] * third[l];
                    }
                    if i == j {
                        let stress = &of.stress[COMPONENT_OF[a][b]];
                        for l in 0..L {
                            p[l] += of.scale[l] * stress[l];
                        }
                    }
                }
            }
        }
    }
    p
}

/// The rows `w P_iAjB G_BJ` of a point.
#[inline(always)]
fn write_rows<const N: usize, const G: usize, const L: usize>(
    moduli: &TwoPointModuli<L>,
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
    pulp::Arch::new().dispatch(FormTangent { gradients, factors, symmetric, factor, tangent });
}

/// The arguments of [`tangent_from_factors`].
struct FormTangent<'a, const N: usize, const G: usize> {
    gradients: &'a [Gradients<N>; G],
    factors: &'a TangentFactors<N, G>,
    symmetric: bool,
    factor: f64,
    tangent: &'a mut LocalTangent<N>,
}

impl<const N: usize, const G: usize> pulp::WithSimd for FormTangent<'_, N, G> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { gradients, factors, symmetric, factor, tangent } = self;
        form_tangent(gradients, factors, symmetric, factor, tangent);
    }
}

/// [`tangent_from_factors`] for those who run with wide vectors already.
#[inline(always)]
pub(crate) fn form_tangent<const N: usize, const G: usize>(
    gradients: &[Gradients<N>; G],
    factors: &TangentFactors<N, G>,
    symmetric: bool,
    factor: f64,
    tangent: &mut LocalTangent<N>,
) {
    for i in 0..3 {
        for j in 0..3 {
            if symmetric && j < i {
                continue;
            }
            let mut products = Products { gradients, factors, pair: (i, j), symmetric, factor, tangent };
            // Tiles of 4 x 8 and 4 x 4 nodes: the sums stay in registers. Then what is left on the rim.
            let (tiles, whole) = (N / 4, N - N % 4);
            for along in 0..tiles {
                let row = 4 * along;
                // What is below the diagonal is mirrored.
                let mut column = if symmetric && i == j { row } else { 0 };
                while column + 8 <= whole {
                    products.tile::<4, 8>(row, column);
                    column += 8;
                }
                if column < whole {
                    products.tile::<4, 4>(row, column);
                }
            }
            for along in 0..tiles {
                match N % 4 {
                    1 => products.rim::<1>(4 * along, whole),
                    2 => products.rim::<2>(4 * along, whole),
                    3 => products.rim::<3>(4 * along, whole),
                    _ => {}
                }
            }
            match N % 4 {
                1 => products.tile::<1, 1>(whole, whole),
                2 => products.tile::<2, 2>(whole, whole),
                3 => products.tile::<3, 3>(whole, whole),
                _ => {}
            }
        }
    }
}

/// The block `(i, j)` of the tangent while it is formed.
struct Products<'a, const N: usize, const G: usize> {
    gradients: &'a [Gradients<N>; G],
    factors: &'a TangentFactors<N, G>,
    pair: (usize, usize),
    symmetric: bool,
    factor: f64,
    tangent: &'a mut LocalTangent<N>,
}

impl<const N: usize, const G: usize> Products<'_, N, G> {
    #[inline(always)]
    fn rim<const R: usize>(&mut self, along: usize, whole: usize) {
        self.tile::<4, R>(along, whole);
        self.tile::<R, 4>(whole, along);
    }

    /// `R x C` nodes from `row` and `column`.
    #[inline(always)]
    fn tile<const R: usize, const C: usize>(&mut self, row: usize, column: usize) {
        let Self { gradients, factors, pair: (i, j), symmetric, factor, ref mut tangent } = *self;
        // Below the diagonal: mirrored.
        if symmetric && i == j && column < row {
            return;
        }
        let (left, right) = (gradients.as_flattened(), factors[3 * i + j].as_flattened());
        let mut sum = product_tile::<N, R, C>(left, right, row, column);
        for r in &mut sum {
            for s in r {
                *s *= factor;
            }
        }
        for r in 0..R {
            for c in 0..C {
                tangent[row + r][i][column + c][j] = sum[r][c];
            }
        }
        if symmetric {
            // Around the diagonal of a diagonal block both are there already.
            let from = if i == j && row == column { R.min(C) } else { 0 };
            for c in from..C {
                for r in 0..R {
                    tangent[column + c][j][row + r][i] = sum[r][c];
                }
            }
        }
    }
}

/// `sum_k a[k][row + r] b[k][column + c]`.
#[inline(always)]
fn product_tile<const N: usize, const R: usize, const C: usize>(
    a: &[[f64; N]],
    b: &[[f64; N]],
    row: usize,
    column: usize,
) -> [[f64; C]; R] {
    assert!(row + R <= N && column + C <= N);
    let mut sum = [[0.0; C]; R];
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (&a[row..row + R], &b[column..column + C]);
        for r in 0..R {
            for c in 0..C {
                sum[r][c] += a[r] * b[c];
            }
        }
    }
    sum
}
