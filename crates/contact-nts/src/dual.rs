//! Forward-mode dual numbers with 15 partial derivatives (the positions of one contact element, or the five vectors that friction
//! depends on), and the scalar trait that lets one formula serve for values and for derivatives.

use crate::kinematics::LOCAL;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the elements need of a number.
pub(crate) trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    fn constant(value: f64) -> Self;
    fn value(self) -> f64;
    fn sqrt(self) -> Self;
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

/// A number with its derivatives with respect to 15 variables, mostly the local positions at `n+1`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual {
    pub value: f64,
    pub partial: [f64; LOCAL],
}

impl Dual {
    /// The local component `k`.
    pub fn variable(value: f64, k: usize) -> Self {
        let mut partial = [0.0; LOCAL];
        partial[k] = 1.0;
        Self { value, partial }
    }

    fn combine(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        Self { value, partial: std::array::from_fn(|k| a * self.partial[k] + b * other.partial[k]) }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, 1.0, 1.0)
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, 1.0, -1.0)
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}
impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.combine(other, value, 1.0 / other.value, -value / other.value)
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self.scale(-1.0)
    }
}

impl Scalar for Dual {
    fn constant(value: f64) -> Self {
        Self { value, partial: [0.0; LOCAL] }
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
