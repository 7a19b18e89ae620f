//! What formulas are written for: numbers, and several side by side.

use std::ops::{Add, Div, Mul, Sub};

/// What formulas are written for: a number, or one of each of several points.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Mul<f64, Output = Self> + Div<Output = Self>
{
    /// A number with this value at all points.
    fn like(self, value: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// A function of each point's two numbers, one point after the other.
    fn each_with(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self;
    /// A function of each point's number, one after the other.
    #[inline(always)]
    fn each(self, function: impl Fn(f64) -> f64) -> Self {
        self.each_with(self, |x, _| function(x))
    }
}

impl Number for f64 {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn each_with(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        function(self, other)
    }
}
