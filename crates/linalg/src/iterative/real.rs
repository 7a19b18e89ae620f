//! The two precisions of a hierarchy.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A floating-point number. Products and sums are rounded one by one, on every machine alike: no fused operation is used.
pub(crate) trait Real:
    Copy
    + Default
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// Rounded to this precision.
    fn rounded(x: f64) -> Self;
    /// Exact.
    fn wide(self) -> f64;
}

impl Real for f64 {
    #[inline(always)]
    fn rounded(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
}

impl Real for f32 {
    #[inline(always)]
    fn rounded(x: f64) -> Self {
        x as f32
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        f64::from(self)
    }
}
