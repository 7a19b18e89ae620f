//! A moment that is fixed in space, as forces on three directors.
//!
//! `f_k = w x D_k` with `A w = m`, `A = tr(G) I - G`, `G = sum_k D_k D_k^T`: the forces of least norm with `sum_k D_k x f_k = m`, in any configuration. Of orthogonal directors of length `l` they are
//! `m x D_k / (2 l^2)`, conjugate to the angular velocity `1/2 sum_k D_k x D_k' / l^2`; at the mean of two such configurations, where directors are shorter, they still have the moment `m`, so that angular
//! momentum changes by `m dt` exactly under rules of the midpoint. They have no potential; their work is `f . dq`.

type Vector = [f64; 3];

/// `det A` below this part of `tr(A)^3` says that the directors are on a line, as they are in the middle of half a turn.
const SINGULAR: f64 = 1e-9;

/// Forces on the three directors and, row-major, their derivatives with respect to the directors; `None` if the directors are on a line.
pub(crate) fn moment_forces(directors: &[Vector; 3], moment: Vector) -> Option<([f64; 9], [f64; 81])> {
    let mut a = [[0.0; 3]; 3];
    for d in directors {
        let square = dot(d, d);
        for i in 0..3 {
            a[i][i] += square;
            for j in 0..3 {
                a[i][j] -= d[i] * d[j];
            }
        }
    }
    let inverse = inverse(&a)?;
    let w = product(&inverse, &moment);
    let mut force = [0.0; 9];
    for (f, d) in force.chunks_exact_mut(3).zip(directors) {
        f.copy_from_slice(&cross(&w, d));
    }
    let mut derivative = [0.0; 81];
    for (j, d) in directors.iter().enumerate() {
        let along = dot(d, &w);
        for c in 0..3 {
            // dA w for a unit change of component c of D_j.
            let mut change: Vector = std::array::from_fn(|i| 2.0 * d[c] * w[i] - d[i] * w[c]);
            change[c] -= along;
            let turn = product(&inverse, &change).map(|w| -w);
            for (k, other) in directors.iter().enumerate() {
                let mut column = cross(&turn, other);
                if k == j {
                    let unit = std::array::from_fn(|i| if i == c { 1.0 } else { 0.0 });
                    column.iter_mut().zip(cross(&w, &unit)).for_each(|(f, g)| *f += g);
                }
                for (i, value) in column.into_iter().enumerate() {
                    derivative[(3 * k + i) * 9 + 3 * j + c] = value;
                }
            }
        }
    }
    Some((force, derivative))
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    crate::rotation::cross(*a, *b)
}

fn product(a: &[Vector; 3], x: &Vector) -> Vector {
    [dot(&a[0], x), dot(&a[1], x), dot(&a[2], x)]
}

/// Inverse of a symmetric matrix that is positive definite; `None` of one that is singular.
fn inverse(a: &[Vector; 3]) -> Option<[Vector; 3]> {
    // Columns of the adjoint, which is symmetric.
    let adjoint = [cross(&a[1], &a[2]), cross(&a[2], &a[0]), cross(&a[0], &a[1])];
    let determinant = dot(&a[0], &adjoint[0]);
    let trace = a[0][0] + a[1][1] + a[2][2];
    (determinant > SINGULAR * trace.powi(3)).then(|| adjoint.map(|row| row.map(|x| x / determinant)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn moment_of(directors: &[Vector; 3], force: &[f64; 9]) -> Vector {
        let mut sum = [0.0; 3];
        for (d, f) in directors.iter().zip(force.chunks_exact(3)) {
            sum.iter_mut().zip(cross(d, &[f[0], f[1], f[2]])).for_each(|(s, m)| *s += m);
        }
        sum
    }

    proptest! {
        /// The moment is exact for any directors, and derivatives are those of central differences.
        #[test]
        fn moment_and_derivatives(
            change in proptest::array::uniform9(-0.3..0.3_f64),
            m in proptest::array::uniform3(-2.0..2.0_f64),
        ) {
            let directors: [Vector; 3] =
                std::array::from_fn(|k| std::array::from_fn(|i| change[3 * k + i] + if i == k { 0.8 } else { 0.0 }));
            let (force, derivative) = moment_forces(&directors, m).unwrap();
            let found = moment_of(&directors, &force);
            prop_assert!((0..3).all(|i| (found[i] - m[i]).abs() < 1e-13));
            let h = 1e-6;
            for c in 0..9 {
                let at = |by: f64| {
                    let mut moved = directors;
                    moved[c / 3][c % 3] += by;
                    moment_forces(&moved, m).unwrap().0
                };
                let (ahead, behind) = (at(h), at(-h));
                for r in 0..9 {
                    prop_assert!(((ahead[r] - behind[r]) / (2.0 * h) - derivative[9 * r + c]).abs() < 1e-7);
                }
            }
        }
    }

    /// Forces `m x D_k / (2 l^2)` of orthogonal directors of length `l`; directors on a line have no moment about it.
    #[test]
    fn orthogonal_directors_and_a_line() {
        let directors = [[0.0, 0.5, 0.0], [0.0, 0.0, 0.5], [0.5, 0.0, 0.0]];
        let m = [1.0, -2.0, 3.0];
        let (force, _) = moment_forces(&directors, m).unwrap();
        for (d, f) in directors.iter().zip(force.chunks_exact(3)) {
            let expected = cross(&m, d).map(|x| x / 0.5);
            assert!((0..3).all(|i| (f[i] - expected[i]).abs() < 1e-14));
        }
        assert!(moment_forces(&[[0.0; 3], [0.0; 3], [0.5, 0.0, 0.0]], m).is_none());
    }
}
