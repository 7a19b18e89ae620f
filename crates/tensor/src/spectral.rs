//! Eigenvalues and eigenvectors of symmetric tensors.

use crate::{SymmetricTensor2, Vector3, components::COMPONENT_OF};

/// Spectral decomposition `a = sum values[A] vectors[A] (x) vectors[A]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralDecomposition {
    /// Eigenvalues, ascending.
    pub values: [f64; 3],
    /// Orthonormal eigenvectors in the same order; any orthonormal set within an eigenspace.
    pub vectors: [Vector3; 3],
}

/// Spectral decomposition by cyclic Jacobi rotations: eigenvalues and the rebuilt tensor to round-off of the largest eigenvalue (4 and 7 units
/// at the worst of 10^6 random tensors), equal and nearly equal eigenvalues included (closed-form cubic roots lose half of the
/// digits there). NaN in gives NaN out.
pub fn spectral_decomposition(a: &SymmetricTensor2) -> SpectralDecomposition {
    let [xx, yy, zz, xy, yz, xz] = a.0;
    let mut m = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Convergence is quadratic; five to six sweeps reach round-off, the bound only stops NaN.
    for _ in 0..30 {
        let off = m[0][1].abs() + m[0][2].abs() + m[1][2].abs();
        if off == 0.0 || !off.is_finite() {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let small = f64::EPSILON * 1.0e-3 * (m[p][p].abs().min(m[q][q].abs()));
            if m[p][q].abs() <= small {
                m[p][q] = 0.0;
                m[q][p] = 0.0;
                continue;
            }
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            // An overflowing theta gives t = 0: the entry is then negligible anyway.
            let t = theta.signum() / (theta.abs() + (1.0 + theta * theta).sqrt());
            let c = 1.0 / (1.0 + t * t).sqrt();
            let s = t * c;
            // Rutishauser's form: adds small changes instead of multiplying by c, whose rounding would accumulate (three times the
            // error when all eigenvalues are nearly equal).
            let tau = s / (1.0 + c);
            let r = 3 - p - q;
            let apq = m[p][q];
            m[p][p] -= t * apq;
            m[q][q] += t * apq;
            m[p][q] = 0.0;
            m[q][p] = 0.0;
            let (arp, arq) = (m[r][p], m[r][q]);
            m[r][p] = arp - s * (arq + tau * arp);
            m[r][q] = arq + s * (arp - tau * arq);
            m[p][r] = m[r][p];
            m[q][r] = m[r][q];
            for row in &mut v {
                let (vp, vq) = (row[p], row[q]);
                row[p] = vp - s * (vq + tau * vp);
                row[q] = vq + s * (vp - tau * vq);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| m[i][i].total_cmp(&m[j][j]));
    SpectralDecomposition {
        values: order.map(|i| m[i][i]),
        vectors: order.map(|i| Vector3::new(v[0][i], v[1][i], v[2][i])),
    }
}

/// [`spectral_decomposition`] of several tensors side by side, with the same bits: each waits for its quotients and roots, and they wait together.
#[inline(always)]
pub fn spectral_decompositions<const L: usize>(tensors: &[SymmetricTensor2; L]) -> [SpectralDecomposition; L] {
    // Entries, and rows of vectors, of all tensors: `[row][column][tensor]`.
    let (mut m, mut v) = ([[[0.0; L]; 3]; 3], [[[0.0; L]; 3]; 3]);
    for i in 0..3 {
        v[i][i] = [1.0; L];
        for j in 0..3 {
            for l in 0..L {
                m[i][j][l] = tensors[l].0[COMPONENT_OF[i][j]];
            }
        }
    }
    // Convergence is quadratic; five to six sweeps reach round-off, the bound only stops NaN.
    for _ in 0..30 {
        let (mut is_live, mut is_any_live) = ([false; L], false);
        for l in 0..L {
            let off = m[0][1][l].abs() + m[0][2][l].abs() + m[1][2][l].abs();
            is_live[l] = off != 0.0 && off.is_finite();
            is_any_live |= is_live[l];
        }
        if !is_any_live {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut m, &mut v, (p, q), &is_live);
        }
    }
    std::array::from_fn(|l| {
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| m[i][i][l].total_cmp(&m[j][j][l]));
        SpectralDecomposition {
            values: order.map(|i| m[i][i][l]),
            vectors: order.map(|i| Vector3::new(v[0][i][l], v[1][i][l], v[2][i][l])),
        }
    })
}

/// The rotation that takes the entry `(p, q)` away; where that is negligible it is set to zero.
#[inline(always)]
fn rotate<const L: usize>(
    m: &mut [[[f64; L]; 3]; 3],
    v: &mut [[[f64; L]; 3]; 3],
    (p, q): (usize, usize),
    is_live: &[bool; L],
) {
    let r = 3 - p - q;
    let (mut rotates, mut any_rotates) = ([false; L], false);
    for l in 0..L {
        let small = f64::EPSILON * 1.0e-3 * (m[p][p][l].abs().min(m[q][q][l].abs()));
        rotates[l] = is_live[l] & (m[p][q][l].abs() > small);
        let left = if is_live[l] & !rotates[l] { 0.0 } else { m[p][q][l] };
        (m[p][q][l], m[q][p][l]) = (left, left);
        any_rotates |= rotates[l];
    }
    if !any_rotates {
        return;
    }
    let (mut s, mut t, mut tau) = ([0.0; L], [0.0; L], [0.0; L]);
    for l in 0..L {
        let (app, aqq, apq) = (m[p][p][l], m[q][q][l], m[p][q][l]);
        let theta = (aqq - app) / (2.0 * apq);
        // An overflowing theta gives t = 0: the entry is then negligible anyway.
        t[l] = theta.signum() / (theta.abs() + (1.0 + theta * theta).sqrt());
        let c = 1.0 / (1.0 + t[l] * t[l]).sqrt();
        s[l] = t[l] * c;
        // Rutishauser's form: adds small changes instead of multiplying by c, whose rounding would accumulate (three times the
        // error when all eigenvalues are nearly equal).
        tau[l] = s[l] / (1.0 + c);
    }
    for l in 0..L {
        let apq = m[p][q][l];
        let (arp, arq) = (m[r][p][l], m[r][q][l]);
        let choose = |turned: f64, old: f64| if rotates[l] { turned } else { old };
        m[p][p][l] = choose(m[p][p][l] - t[l] * apq, m[p][p][l]);
        m[q][q][l] = choose(m[q][q][l] + t[l] * apq, m[q][q][l]);
        m[r][p][l] = choose(arp - s[l] * (arq + tau[l] * arp), arp);
        m[r][q][l] = choose(arq + s[l] * (arp - tau[l] * arq), arq);
        m[p][r][l] = m[r][p][l];
        m[q][r][l] = m[r][q][l];
        let left = choose(0.0, apq);
        (m[p][q][l], m[q][p][l]) = (left, left);
        for row in &mut *v {
            let (vp, vq) = (row[p][l], row[q][l]);
            row[p][l] = choose(vp - s[l] * (vq + tau[l] * vp), vp);
            row[q][l] = choose(vq + s[l] * (vp - tau[l] * vq), vq);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tensor2;
    use proptest::prelude::*;

    fn rotation(a: [f64; 3]) -> Tensor2 {
        nalgebra::Rotation3::from_euler_angles(a[0], a[1], a[2]).into_inner()
    }

    fn check(values: [f64; 3], angles: [f64; 3]) -> Result<(), TestCaseError> {
        let q = rotation(angles);
        let a = SymmetricTensor2::from_matrix(&(q * Tensor2::from_diagonal(&values.into()) * q.transpose()));
        let s = spectral_decomposition(&a);
        let scale = values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut sorted = values;
        sorted.sort_by(f64::total_cmp);
        let mut rebuilt = Tensor2::zeros();
        for i in 0..3 {
            prop_assert!((s.values[i] - sorted[i]).abs() <= 8.0 * f64::EPSILON * scale);
            rebuilt += s.values[i] * s.vectors[i] * s.vectors[i].transpose();
            for j in 0..3 {
                let delta = if i == j { 1.0 } else { 0.0 };
                prop_assert!((s.vectors[i].dot(&s.vectors[j]) - delta).abs() < 1e-14);
            }
        }
        prop_assert!((rebuilt - a.to_matrix()).norm() < 16.0 * f64::EPSILON * scale);
        Ok(())
    }

    proptest! {
        #[test]
        fn random(values in proptest::array::uniform3(0.01..9.0_f64), angles in proptest::array::uniform3(-3.0..3.0_f64)) {
            check(values, angles)?;
        }

        #[test]
        fn nearly_equal(value in 0.1..4.0_f64, power in 1..16_i32, which in 0..3_usize, angles in proptest::array::uniform3(-3.0..3.0_f64)) {
            let mut values = [value; 3];
            values[which] += 10.0_f64.powi(-power);
            check(values, angles)?;
        }
    }

    proptest! {
        #[test]
        fn side_by_side_or_alone(many in proptest::array::uniform4(proptest::array::uniform6(-2.0..2.0_f64)), which in 0..4_usize) {
            // One of them is done at once.
            let mut many = many.map(SymmetricTensor2);
            many[which] = SymmetricTensor2([1.0, 2.0, 0.5, 0.0, 0.0, 0.0]);
            let alone = many.map(|a| spectral_decomposition(&a));
            prop_assert_eq!(spectral_decompositions(&many), alone);
        }
    }

    #[test]
    fn a_nan_among_others() {
        let good = SymmetricTensor2([1.0, 2.0, 0.5, 0.3, 0.2, -0.1]);
        let [first, second] = spectral_decompositions(&[SymmetricTensor2([f64::NAN; 6]), good]);
        assert!(first.values[0].is_nan());
        assert_eq!(second, spectral_decomposition(&good));
    }

    #[test]
    fn any_magnitude() {
        for scale in [1e-150, 1e-30, 1.0, 1e30, 1e150] {
            check([scale, 2.0 * scale, 2.0 * scale], [0.3, -1.2, 2.0]).unwrap();
            check([-scale, 1e-9 * scale, 3.0 * scale], [1.3, 0.2, -2.0]).unwrap();
        }
    }

    #[test]
    fn diagonal_and_zero_tensors() {
        let s = spectral_decomposition(&SymmetricTensor2([3.0, 1.0, 2.0, 0.0, 0.0, 0.0]));
        assert_eq!(s.values, [1.0, 2.0, 3.0]);
        assert_eq!(s.vectors, [Vector3::y(), Vector3::z(), Vector3::x()]);
        assert_eq!(spectral_decomposition(&SymmetricTensor2::ZERO).values, [0.0; 3]);
        assert_eq!(spectral_decomposition(&SymmetricTensor2([0.0, 0.0, 0.0, 1.0, 0.0, 0.0])).values, [-1.0, 0.0, 1.0]);
    }

    #[test]
    fn nan_does_not_hang() {
        assert!(spectral_decomposition(&SymmetricTensor2([f64::NAN; 6])).values[0].is_nan());
    }
}
