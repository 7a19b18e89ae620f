//! Isotropic hardening: the yield stress as a function of the equivalent plastic strain.

use crate::MaterialError;
use crate::error::finite;

const NAME: &str = "plasticity";

/// `sigma_y(a)`, a Kirchhoff stress, of the equivalent plastic strain `a >= 0` (logarithmic).
#[derive(Clone, Debug, PartialEq)]
pub enum Hardening {
    /// `s0 + h a + (saturation - s0)(1 - exp(-rate a))` (Voce); linear for `saturation = s0`.
    Voce {
        /// Yield stress at the begin.
        s0: f64,
        /// Modulus of the linear part (stress).
        h: f64,
        /// The yield stress that the rest tends to.
        saturation: f64,
        /// Rate of the saturation over the equivalent plastic strain, a number.
        rate: f64,
    },
    /// Points `(a, stress)`, linear between them, constant behind the last one. The first has `a = 0`.
    Table(Vec<(f64, f64)>),
}

impl Hardening {
    /// `s0 + h a`.
    pub fn linear(s0: f64, h: f64) -> Self {
        Self::Voce { s0, h, saturation: s0, rate: 1.0 }
    }

    /// `sigma_y(0)`.
    pub fn initial(&self) -> f64 {
        match self {
            Self::Voce { s0, .. } => *s0,
            Self::Table(points) => points[0].1,
        }
    }

    /// `sigma_y(a)` and its slope.
    pub fn at(&self, a: f64) -> (f64, f64) {
        match self {
            Self::Voce { s0, h, saturation, rate } => {
                let e = (-rate * a).exp();
                (s0 + h * a + (saturation - s0) * (1.0 - e), h + (saturation - s0) * rate * e)
            }
            Self::Table(points) => {
                let k = points.partition_point(|point| point.0 <= a);
                if k == points.len() {
                    return (points[k - 1].1, 0.0);
                }
                // cannot fail: the first point is at zero, and `a` is not negative but for round-off of zero.
                let ((a0, s0), (a1, s1)) = (points[k.max(1) - 1], points[k.max(1)]);
                let slope = (s1 - s0) / (a1 - a0);
                (s0 + slope * (a - a0), slope)
            }
        }
    }

    /// `int_a^b (sigma_y - sigma_y(0))`, as a product and not as a difference of integrals from zero.
    pub fn stored(&self, a: f64, b: f64) -> f64 {
        match self {
            Self::Voce { s0, h, saturation, rate } => {
                let saturated = (b - a) + (-rate * a).exp() * (-rate * (b - a)).exp_m1() / rate;
                0.5 * h * (b - a) * (b + a) + (saturation - s0) * saturated
            }
            Self::Table(points) => {
                let (s0, mut sum, mut from) = (points[0].1, 0.0, a);
                while from < b {
                    let to = points.get(points.partition_point(|point| point.0 <= from)).map_or(b, |p| b.min(p.0));
                    sum += (to - from) * (self.at(0.5 * (from + to)).0 - s0);
                    from = to;
                }
                sum
            }
        }
    }

    /// The smallest slope.
    pub fn smallest_slope(&self) -> f64 {
        match self {
            Self::Voce { s0, h, saturation, rate } => h + ((saturation - s0) * rate).min(0.0),
            Self::Table(points) => {
                let slopes = points.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0));
                slopes.fold(0.0, f64::min)
            }
        }
    }

    /// Refuses what is no hardening.
    pub(crate) fn check(&self) -> Result<(), MaterialError> {
        let refuse = |parameter, value, range| Err(MaterialError::OutOfRange { law: NAME, parameter, value, range });
        match self {
            Self::Voce { s0, h, saturation, rate } => {
                let parameters = [
                    ("yield_stress", *s0),
                    ("hardening_modulus", *h),
                    ("saturation_stress", *saturation),
                    ("saturation_rate", *rate),
                ];
                finite(NAME, &parameters)?;
                if *s0 <= 0.0 {
                    return refuse("yield_stress", *s0, "positive");
                }
                // A yield stress that falls for ever is negative at some strain: softening is a table, whose last point holds on.
                if *h < 0.0 {
                    return refuse("hardening_modulus", *h, "not negative (softening is given by a table)");
                }
                if *saturation <= 0.0 {
                    return refuse("saturation_stress", *saturation, "positive");
                }
                if *rate <= 0.0 {
                    return refuse("saturation_rate", *rate, "positive");
                }
            }
            Self::Table(points) => {
                let Some(first) = points.first() else {
                    return refuse("hardening", 0.0, "a table of one point or more");
                };
                for point in points {
                    finite(NAME, &[("hardening", point.0), ("hardening", point.1)])?;
                    if point.1 <= 0.0 {
                        return refuse("hardening", point.1, "a table of positive yield stresses");
                    }
                }
                if first.0 != 0.0 {
                    return refuse("hardening", first.0, "a table whose first plastic strain is 0");
                }
                if let Some(pair) = points.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
                    return refuse("hardening", pair[1].0, "a table whose plastic strains grow");
                }
            }
        }
        Ok(())
    }
}
