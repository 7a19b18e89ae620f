//! Gauss rules on the reference triangle `(0,0), (1,0), (0,1)`.
//!
//! The weights of each rule add up to `1/2`, the area of that triangle: an integral over a mapped triangle needs the
//! determinant of the map and no further factor (theory/segmentation#quadrature).

/// Shape functions of the three vertices at `eta`: `(1 - eta1 - eta2, eta1, eta2)`.
#[inline]
pub fn shape(eta: [f64; 2]) -> [f64; 3] {
    [1.0 - eta[0] - eta[1], eta[0], eta[1]]
}

/// 3 points, degree 2, all weights positive (Strang and Fix 1973).
pub(crate) const THREE: [([f64; 2], f64); 3] =
    [([1.0 / 6.0, 1.0 / 6.0], 1.0 / 6.0), ([2.0 / 3.0, 1.0 / 6.0], 1.0 / 6.0), ([1.0 / 6.0, 2.0 / 3.0], 1.0 / 6.0)];

const ROOT_15: f64 = 3.872_983_346_207_417;

/// 7 points `(eta1, eta2)` with weights, degree 5, all weights positive (Radon 1948).
pub const SEVEN: [([f64; 2], f64); 7] = {
    let (a, wa) = ((6.0 - ROOT_15) / 21.0, (155.0 - ROOT_15) / 2400.0);
    let (b, wb) = ((6.0 + ROOT_15) / 21.0, (155.0 + ROOT_15) / 2400.0);
    [
        ([1.0 / 3.0, 1.0 / 3.0], 9.0 / 80.0),
        ([a, a], wa),
        ([1.0 - 2.0 * a, a], wa),
        ([a, 1.0 - 2.0 * a], wa),
        ([b, b], wb),
        ([1.0 - 2.0 * b, b], wb),
        ([b, 1.0 - 2.0 * b], wb),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: usize) -> f64 {
        (1..=n).map(|k| k as f64).product()
    }

    fn error(rule: &[([f64; 2], f64)], degree: usize) -> f64 {
        (0..=degree)
            .map(|i| {
                let j = degree - i;
                let exact = factorial(i) * factorial(j) / factorial(i + j + 2);
                let sum: f64 = rule.iter().map(|(e, w)| w * e[0].powi(i as i32) * e[1].powi(j as i32)).sum();
                (sum - exact).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn rules_are_exact_to_their_degree_and_not_beyond() {
        for (rule, degree) in [(&THREE[..], 2), (&SEVEN[..], 5)] {
            assert!((0..=degree).all(|degree| error(rule, degree) < 1e-15), "{degree}");
            assert!(error(rule, degree + 1) > 1e-6, "{degree}");
        }
    }

    #[test]
    fn shape_functions_add_up() {
        for (eta, _) in SEVEN {
            assert!((shape(eta).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }
}
