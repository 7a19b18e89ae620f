//! Forward-mode dual numbers with `N` partial derivatives (the positions of one contact element, or the vectors that friction depends on), and the
//! scalar trait that lets one formula serve for values and for derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the elements need of a number.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A number that depends on nothing.
    fn constant(value: f64) -> Self;
    /// The value without derivatives.
    fn value(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// `factor * self`.
    fn scale(self, factor: f64) -> Self;
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn scale(self, factor: f64) -> Self {
        factor * self
    }
}

/// A number with its derivatives with respect to `N` variables.
#[derive(Clone, Copy, Debug)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives.
    pub partial: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable `k < N`.
    pub fn variable(value: f64, k: usize) -> Self {
        let mut partial = [0.0; N];
        partial[k] = 1.0;
        Self { value, partial }
    }

    fn combine(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        Self { value, partial: std::array::from_fn(|k| a * self.partial[k] + b * other.partial[k]) }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, 1.0, 1.0)
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, 1.0, -1.0)
    }
}
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.combine(other, value, 1.0 / other.value, -value / other.value)
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.scale(-1.0)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    fn constant(value: f64) -> Self {
        Self { value, partial: [0.0; N] }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self { value: root, partial: self.partial.map(|p| 0.5 * p / root) }
    }
    fn scale(self, factor: f64) -> Self {
        Self { value: factor * self.value, partial: self.partial.map(|p| factor * p) }
    }
}

/// A vector.
pub type V3<T> = [T; 3];

/// `a . b`.
pub fn dot<T: Scalar>(a: &V3<T>, b: &V3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b`.
pub fn cross<T: Scalar>(a: &V3<T>, b: &V3<T>) -> V3<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a / |a|`; not a number for a vector without length.
pub fn unit<T: Scalar>(a: V3<T>) -> V3<T> {
    let inverse = T::constant(1.0) / dot(&a, &a).sqrt();
    a.map(|x| x * inverse)
}
