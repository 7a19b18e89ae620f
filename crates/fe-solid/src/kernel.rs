//! The arithmetic of one hex8 over plain arrays: gradients, deformation gradient, force, two-point moduli, tangent.
//!
//! Not here: laws, rules, errors, meshes. Everything is a free function over arrays that are contiguous for each element
//! and component-major (`[component][node]`), so that the innermost loops run over the eight nodes. Several elements
//! can be put side by side later without another layout.
//!
//! # How the tangent is formed
//! Instead of `B_I^T D B_J` (formulation (3.1), §3.3) the moduli are pushed once a Gauss point to the two-point form
//! ```text
//! P_iAjB = F^l_iK A_KALB F^r_jL + s S_AB delta_ij
//! ```
//! (`F^l`, `F^r`: left and right deformation gradient, `A` the moduli in Voigt form, `s` the weight of the geometric
//! term). Then `K_iI,jJ = sum_gp w G_AI P_iAjB G_BJ` with `G_AI = dN_I/dX_A`, which is a product of an 8 x 24 and a
//! 24 x 8 matrix for each pair `(i, j)`: the sum over Gauss points and `A` is the inner dimension. That takes about half
//! of the multiplications of the `B` form. If `F^l = F^r` and `A` is symmetric, three of the nine pairs are mirrored.

/// Nodes of a hex8.
pub const NODES: usize = 8;
/// Gauss points (2x2x2).
pub const GAUSS_POINTS: usize = 8;
/// Local unknowns, `3 * node + component`.
pub const UNKNOWNS: usize = 24;
/// A 3x3 matrix, `[row][column]`.
pub type Matrix3 = [[f64; 3]; 3];
/// A vector at each node, component-major: `x[i][I]`.
pub type NodalVectors = [[f64; NODES]; 3];
/// `dN_I/dX_A` as `[A][I]`.
pub type Gradients = [[f64; NODES]; 3];
/// Local tangent, row-major, `(3 I + i) * 24 + 3 J + j`.
pub type LocalTangent = [f64; UNKNOWNS * UNKNOWNS];

/// Voigt position of a pair of indices (11, 22, 33, 12, 23, 13).
pub const VOIGT: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// What the integrals over one element need of its reference geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementIntegration {
    /// Gradients of the shape functions at each Gauss point.
    pub gradients: [Gradients; GAUSS_POINTS],
    /// Gauss weight times `det dX/dxi` (a volume).
    pub weights: [f64; GAUSS_POINTS],
}

/// `det` of a 3x3 matrix.
pub fn determinant(m: &Matrix3) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

/// Gradients of the shape functions and the volume weights of an element with reference positions `x`.
///
/// `natural[g][A][I]` is `dN_I/dxi_A` at Gauss point `g`, `gauss_weights` the weights of the rule.
///
/// # Errors
/// The first Gauss point with `det dX/dxi <= 0` (or not a number), and that determinant.
pub fn integration(
    x: &NodalVectors,
    natural: &[Gradients; GAUSS_POINTS],
    gauss_weights: &[f64; GAUSS_POINTS],
) -> Result<ElementIntegration, (usize, f64)> {
    let mut out = ElementIntegration { gradients: [[[0.0; NODES]; 3]; GAUSS_POINTS], weights: [0.0; GAUSS_POINTS] };
    for g in 0..GAUSS_POINTS {
        // J_aA = dX_a/dxi_A
        let j = deformation_gradient(x, &natural[g]);
        let det = determinant(&j);
        // `!(det > 0)` also catches a NaN.
        if !(det > 0.0 && det.is_finite()) {
            return Err((g, det));
        }
        let inverse = inverse(&j, det);
        for a in 0..3 {
            for node in 0..NODES {
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

/// Inverse of a matrix with known determinant.
pub(crate) fn inverse(m: &Matrix3, det: f64) -> Matrix3 {
    let cofactor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    std::array::from_fn(|r| std::array::from_fn(|c| cofactor(c, r) / det))
}

/// `F_iA = sum_I q_iI dN_I/dX_A`.
#[inline]
pub fn deformation_gradient(positions: &NodalVectors, gradients: &Gradients) -> Matrix3 {
    let mut f = [[0.0; 3]; 3];
    for i in 0..3 {
        for a in 0..3 {
            // Four partial sums: short dependency chains, a fixed order.
            let (q, g) = (&positions[i], &gradients[a]);
            let s0 = q[0] * g[0] + q[4] * g[4];
            let s1 = q[1] * g[1] + q[5] * g[5];
            let s2 = q[2] * g[2] + q[6] * g[6];
            let s3 = q[3] * g[3] + q[7] * g[7];
            f[i][a] = (s0 + s2) + (s1 + s3);
        }
    }
    f
}

/// `C = F^T F` in the order 11, 22, 33, 12, 23, 13 (plain, not doubled).
#[inline]
pub fn right_cauchy_green(f: &Matrix3) -> [f64; 6] {
    let dot = |a: usize, b: usize| f[0][a] * f[0][b] + f[1][a] * f[1][b] + f[2][a] * f[2][b];
    [dot(0, 0), dot(1, 1), dot(2, 2), dot(0, 1), dot(1, 2), dot(0, 2)]
}

/// Adds `w F S grad N_I` to the nodal forces: `F_iI += w F_iA S_AB G_BI`.
#[inline]
pub fn add_force(f: &Matrix3, stress: &[f64; 6], gradients: &Gradients, weight: f64, force: &mut NodalVectors) {
    for i in 0..3 {
        let mut p = [0.0; 3];
        for b in 0..3 {
            p[b] = weight
                * (f[i][0] * stress[VOIGT[0][b]] + f[i][1] * stress[VOIGT[1][b]] + f[i][2] * stress[VOIGT[2][b]]);
        }
        for node in 0..NODES {
            force[i][node] += p[0] * gradients[0][node] + p[1] * gradients[1][node] + p[2] * gradients[2][node];
        }
    }
}

/// `w P_iAjB G_BJ` for all Gauss points, `[3 i + j][3 g + A][J]`: the right factors of the tangent's products.
pub type TangentFactors = [[[f64; NODES]; 3 * GAUSS_POINTS]; 9];

/// One Gauss point's part of [`TangentFactors`] (module documentation). `moduli` are `A_v` (6x6, for strains with doubled
/// shears), `geometric` the factor of the geometric term. With `symmetric` only the pairs `i <= j` are written.
#[inline]
pub fn tangent_factors(
    left: &Matrix3,
    right: &Matrix3,
    moduli: &[[f64; 6]; 6],
    stress: &[f64; 6],
    geometric: f64,
    gradients: &Gradients,
    weight: f64,
    gauss_point: usize,
    symmetric: bool,
    factors: &mut TangentFactors,
) {
    // h[KA][j][B] = w A_KALB F^r_jL
    let mut h = [[[0.0; 3]; 3]; 6];
    for ka in 0..6 {
        let m = &moduli[ka];
        for j in 0..3 {
            for b in 0..3 {
                h[ka][j][b] = weight
                    * (m[VOIGT[0][b]] * right[j][0] + m[VOIGT[1][b]] * right[j][1] + m[VOIGT[2][b]] * right[j][2]);
            }
        }
    }
    let scale = geometric * weight;
    for i in 0..3 {
        for j in 0..3 {
            if symmetric && j < i {
                continue;
            }
            for a in 0..3 {
                let mut p = [0.0; 3];
                for b in 0..3 {
                    p[b] = left[i][0] * h[VOIGT[0][a]][j][b]
                        + left[i][1] * h[VOIGT[1][a]][j][b]
                        + left[i][2] * h[VOIGT[2][a]][j][b];
                    if i == j {
                        p[b] += scale * stress[VOIGT[a][b]];
                    }
                }
                let row = &mut factors[3 * i + j][3 * gauss_point + a];
                for node in 0..NODES {
                    row[node] = p[0] * gradients[0][node] + p[1] * gradients[1][node] + p[2] * gradients[2][node];
                }
            }
        }
    }
}

/// The products `K_iI,jJ = sum_k G_kI T_kJ` and their placement in the row-major local tangent, which is overwritten.
pub fn tangent_from_factors(
    gradients: &[Gradients; GAUSS_POINTS],
    factors: &TangentFactors,
    symmetric: bool,
    factor: f64,
    tangent: &mut LocalTangent,
) {
    let left: &[[f64; NODES]; 3 * GAUSS_POINTS] = flatten(gradients);
    for i in 0..3 {
        for j in 0..3 {
            if symmetric && j < i {
                continue;
            }
            for tile in 0..4 {
                // 4x4 tiles of the 8x8 block: the sums stay in registers.
                let (row, column) = (4 * (tile / 2), 4 * (tile % 2));
                if symmetric && i == j && column < row {
                    continue;
                }
                let mut sum = product_tile(left, &factors[3 * i + j], row, column);
                for r in &mut sum {
                    for s in r {
                        *s *= factor;
                    }
                }
                for r in 0..4 {
                    for c in 0..4 {
                        tangent[(3 * (row + r) + i) * UNKNOWNS + 3 * (column + c) + j] = sum[r][c];
                    }
                }
                if symmetric && (i != j || row != column) {
                    for c in 0..4 {
                        for r in 0..4 {
                            tangent[(3 * (column + c) + j) * UNKNOWNS + 3 * (row + r) + i] = sum[r][c];
                        }
                    }
                }
            }
        }
    }
}

/// Gradients of all Gauss points as one 24 x 8 array.
#[inline]
fn flatten(gradients: &[Gradients; GAUSS_POINTS]) -> &[[f64; NODES]; 3 * GAUSS_POINTS] {
    match gradients.as_flattened().try_into() {
        Ok(flat) => flat,
        Err(_) => unreachable!("8 times 3 rows are 24 rows"),
    }
}

/// `sum_k a[k][row + r] b[k][column + c]` for a 4x4 tile.
#[inline]
fn product_tile(
    a: &[[f64; NODES]; 3 * GAUSS_POINTS],
    b: &[[f64; NODES]; 3 * GAUSS_POINTS],
    row: usize,
    column: usize,
) -> [[f64; 4]; 4] {
    let mut sum = [[0.0; 4]; 4];
    for (a, b) in a.iter().zip(b) {
        let b: &[f64] = &b[column..column + 4];
        let a: &[f64] = &a[row..row + 4];
        for r in 0..4 {
            for c in 0..4 {
                sum[r][c] += a[r] * b[c];
            }
        }
    }
    sum
}
