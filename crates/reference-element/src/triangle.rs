//! Gauss rules on the reference triangle `(0,0), (1,0), (0,1)`.
//!
//! The weights of each rule add up to `1/2`, the area of that triangle: an integral over a mapped triangle needs the
//! determinant of the map and no further factor (theory/segmentation#quadrature).

/// Shape functions of the three vertices at `eta`: `(1 - eta1 - eta2, eta1, eta2)`.
#[inline]
pub fn shape(eta: [f64; 2]) -> [f64; 3] {
    [1.0 - eta[0] - eta[1], eta[0], eta[1]]
}

/// A quadrature rule on the triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TriangleRule {
    /// 4 points, degree 3, one weight negative (thesis, Table 4.1 with its points corrected).
    FourPoint,
    /// 7 points, degree 5, all weights positive (Radon 1948).
    #[default]
    SevenPoint,
    /// 12 points, degree 6, all weights positive (Dunavant 1985).
    TwelvePoint,
}

impl TriangleRule {
    /// All rules, by rising degree.
    pub const ALL: [Self; 3] = [Self::FourPoint, Self::SevenPoint, Self::TwelvePoint];

    /// Points `(eta1, eta2)` and weights.
    pub const fn points(self) -> &'static [([f64; 2], f64)] {
        match self {
            Self::FourPoint => &FOUR,
            Self::SevenPoint => &SEVEN,
            Self::TwelvePoint => &TWELVE,
        }
    }

    /// Highest total degree of the polynomials that the rule integrates exactly.
    pub const fn degree(self) -> usize {
        match self {
            Self::FourPoint => 3,
            Self::SevenPoint => 5,
            Self::TwelvePoint => 6,
        }
    }
}

/// 3 points, degree 2, all weights positive (Strang and Fix 1973).
pub(crate) const THREE: [([f64; 2], f64); 3] =
    [([1.0 / 6.0, 1.0 / 6.0], 1.0 / 6.0), ([2.0 / 3.0, 1.0 / 6.0], 1.0 / 6.0), ([1.0 / 6.0, 2.0 / 3.0], 1.0 / 6.0)];

const FOUR: [([f64; 2], f64); 4] = [
    ([1.0 / 3.0, 1.0 / 3.0], -27.0 / 96.0),
    ([0.2, 0.2], 25.0 / 96.0),
    ([0.6, 0.2], 25.0 / 96.0),
    ([0.2, 0.6], 25.0 / 96.0),
];

const ROOT_15: f64 = 3.872_983_346_207_417;

pub(crate) const SEVEN: [([f64; 2], f64); 7] = {
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

const TWELVE: [([f64; 2], f64); 12] = {
    let (a, wa) = (0.249_286_745_170_910_42, 0.058_393_137_863_189_68);
    let (b, wb) = (0.063_089_014_491_502_23, 0.025_422_453_185_103_41);
    let (c, d, wc) = (0.053_145_049_844_816_95, 0.310_352_451_033_784_4, 0.041_425_537_809_186_79);
    let e = 1.0 - c - d;
    [
        ([a, a], wa),
        ([1.0 - 2.0 * a, a], wa),
        ([a, 1.0 - 2.0 * a], wa),
        ([b, b], wb),
        ([1.0 - 2.0 * b, b], wb),
        ([b, 1.0 - 2.0 * b], wb),
        ([c, d], wc),
        ([d, c], wc),
        ([c, e], wc),
        ([e, c], wc),
        ([d, e], wc),
        ([e, d], wc),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: usize) -> f64 {
        (1..=n).map(|k| k as f64).product()
    }

    fn error(rule: TriangleRule, degree: usize) -> f64 {
        (0..=degree)
            .map(|i| {
                let j = degree - i;
                let exact = factorial(i) * factorial(j) / factorial(i + j + 2);
                let sum: f64 = rule.points().iter().map(|(e, w)| w * e[0].powi(i as i32) * e[1].powi(j as i32)).sum();
                (sum - exact).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn rules_are_exact_to_their_degree_and_not_beyond() {
        for rule in TriangleRule::ALL {
            for degree in 0..=rule.degree() {
                assert!(error(rule, degree) < 1e-15, "{rule:?} {degree}");
            }
            assert!(error(rule, rule.degree() + 1) > 1e-6, "{rule:?}");
        }
    }

    #[test]
    fn shape_functions_add_up() {
        for (eta, _) in TriangleRule::TwelvePoint.points() {
            assert!((shape(*eta).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }
}
