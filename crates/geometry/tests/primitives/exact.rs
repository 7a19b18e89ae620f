//! Oracle in exact arithmetic: coordinates as integers times a power of two, squared distances as fractions of integers.

use nalgebra::Vector3;
use num_bigint::{BigInt, Sign};

pub type Point = [BigInt; 3];

/// A fraction with a positive denominator.
#[derive(Clone, Debug)]
pub struct Fraction {
    pub numerator: BigInt,
    pub denominator: BigInt,
}

impl Fraction {
    pub fn is_less(&self, other: &Self) -> bool {
        &self.numerator * &other.denominator < &other.numerator * &self.denominator
    }

    /// The fraction times `2^exponent`, rounded. It must not be negative.
    pub fn to_f64(&self, exponent: i64) -> f64 {
        if self.numerator.sign() == Sign::NoSign {
            return 0.0;
        }
        let shift = 100 - (self.numerator.bits() as i64 - self.denominator.bits() as i64);
        let quotient = if shift >= 0 {
            (&self.numerator << shift) / &self.denominator
        } else {
            &self.numerator / (&self.denominator << -shift)
        };
        let power = exponent - shift;
        let half = power / 2;
        u128::try_from(&quotient).unwrap() as f64 * 2f64.powi(half as i32) * 2f64.powi((power - half) as i32)
    }
}

/// Mantissa and exponent, `x = m 2^e`.
fn decompose(x: f64) -> (i64, i64) {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i64, (bits & ((1 << 52) - 1)) as i64);
    let (m, e) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    (if x < 0.0 { -m } else { m }, e)
}

/// Integers and the exponent that they have in common: the numbers are `integer 2^exponent`.
pub fn integers(numbers: &[f64]) -> (Vec<BigInt>, i64) {
    let parts: Vec<(i64, i64)> = numbers.iter().map(|&x| decompose(x)).collect();
    let exponent = parts.iter().filter(|(m, _)| *m != 0).map(|(_, e)| *e).min().unwrap_or(0);
    let integer = |&(m, e): &(i64, i64)| if m == 0 { BigInt::ZERO } else { BigInt::from(m) << (e - exponent) };
    (parts.iter().map(integer).collect(), exponent)
}

/// Points as integers with a common exponent.
pub fn points(points: &[Vector3<f64>]) -> (Vec<Point>, i64) {
    let numbers: Vec<f64> = points.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
    let (integers, exponent) = integers(&numbers);
    (integers.chunks(3).map(|c| [c[0].clone(), c[1].clone(), c[2].clone()]).collect(), exponent)
}

pub fn sub(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

pub fn dot(a: &Point, b: &Point) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub fn cross(a: &Point, b: &Point) -> Point {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

fn whole(numerator: BigInt) -> Fraction {
    Fraction { numerator, denominator: BigInt::from(1) }
}

fn is_positive(x: &BigInt) -> bool {
    x.sign() == Sign::Plus
}

fn smallest(candidates: impl IntoIterator<Item = Fraction>) -> Fraction {
    candidates.into_iter().reduce(|a, b| if b.is_less(&a) { b } else { a }).unwrap()
}

/// Squared distance of a point from a closed edge.
pub fn vertex_edge(p: &Point, a: &Point, b: &Point) -> Fraction {
    let (w, e) = (sub(p, a), sub(b, a));
    let (along, squared) = (dot(&w, &e), dot(&e, &e));
    if !is_positive(&along) {
        return whole(dot(&w, &w));
    }
    if along >= squared {
        let w = sub(p, b);
        return whole(dot(&w, &w));
    }
    let c = cross(&w, &e);
    Fraction { numerator: dot(&c, &c), denominator: squared }
}

/// Squared distance of a point from a closed triangle.
pub fn vertex_triangle(p: &Point, t: [&Point; 3]) -> Fraction {
    let n = cross(&sub(t[1], t[0]), &sub(t[2], t[0]));
    let inside = (0..3).all(|k| {
        let inward = cross(&n, &sub(t[(k + 1) % 3], t[k]));
        is_positive(&dot(&inward, &sub(p, t[k])))
    });
    if inside {
        let height = dot(&n, &sub(p, t[0]));
        return Fraction { numerator: &height * &height, denominator: dot(&n, &n) };
    }
    smallest((0..3).map(|k| vertex_edge(p, t[k], t[(k + 1) % 3])))
}

/// Squared distance of two closed edges.
pub fn edge_edge(a: [&Point; 2], b: [&Point; 2]) -> Fraction {
    let (u, v, w) = (sub(a[1], a[0]), sub(b[1], b[0]), sub(b[0], a[0]));
    let n = cross(&u, &v);
    let squared = dot(&n, &n);
    let (s, t) = (dot(&cross(&w, &v), &n), dot(&cross(&w, &u), &n));
    if is_positive(&s) && s < squared && is_positive(&t) && t < squared {
        let height = dot(&n, &w);
        return Fraction { numerator: &height * &height, denominator: squared };
    }
    smallest([
        vertex_edge(a[0], b[0], b[1]),
        vertex_edge(a[1], b[0], b[1]),
        vertex_edge(b[0], a[0], a[1]),
        vertex_edge(b[1], a[0], a[1]),
    ])
}
