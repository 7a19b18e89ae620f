//! Coordinates from the fuzzer's bytes.

use nalgebra::Vector3;

/// Takes numbers from bytes, zeros once they are used up.
pub struct Numbers<'a> {
    bytes: &'a [u8],
    finest: i32,
}

impl<'a> Numbers<'a> {
    /// Numbers that differ by no less than `2^-finest`.
    pub fn new(bytes: &'a [u8], finest: i32) -> Self {
        Self { bytes, finest }
    }

    fn byte(&mut self) -> u8 {
        let (first, rest) = self.bytes.split_first().unwrap_or((&0, &[]));
        self.bytes = rest;
        *first
    }

    /// In [-2, 2]: two bytes are a multiple of 1/64 plus a power of two or nothing, so that equal, nearly equal and different numbers are all one
    /// mutation away.
    pub fn coordinate(&mut self) -> f64 {
        let (coarse, fine) = (self.byte() as i8, self.byte());
        let offset = match fine {
            0 => 0.0,
            _ => 0.5_f64.powi(i32::from(fine >> 2).min(self.finest)) * if fine & 2 == 0 { 1.0 } else { -1.0 },
        };
        (f64::from(coarse) / 64.0 + offset * f64::from(fine & 1)).clamp(-2.0, 2.0)
    }

    pub fn point(&mut self) -> Vector3<f64> {
        Vector3::new(self.coordinate(), self.coordinate(), self.coordinate())
    }

    pub fn quad(&mut self) -> [Vector3<f64>; 4] {
        std::array::from_fn(|_| self.point())
    }
}
