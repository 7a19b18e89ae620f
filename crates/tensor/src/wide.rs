//! Numbers of several points side by side, which the processor's widest vectors take at once; tensors made of them.
//!
//! Every point takes the same operations in the same order as it would alone, and nothing is contracted to a fused multiply-add: the bits are the same on every processor, and those of
//! plain numbers.

pub use crate::number::Number;
use crate::{SymmetricTensor2, Tensor4};
pub use pulp::Simd;
use std::ops::{Add, Div, Mul, Sub};

/// Points side by side.
pub const LANES: usize = 4;

/// A number of each point.
pub type Several = [f64; LANES];

/// A vector of as many numbers as `S` has: [`LANES`] of them, or a part of these.
#[derive(Clone, Copy, Debug)]
pub struct Wide<S: Simd> {
    simd: S,
    value: S::f64s,
}

/// Number of vectors of `S` that [`LANES`] numbers take.
#[inline(always)]
pub const fn parts<S: Simd>() -> usize {
    LANES / S::F64_LANES
}

impl<S: Simd> Wide<S> {
    /// A vector of numbers that all have this value.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// The first numbers of a list that is long enough.
    #[inline(always)]
    pub fn load_from(simd: S, from: &[f64]) -> Self {
        Self { simd, value: S::as_simd_f64s(from).0[0] }
    }

    /// The part `part` of some numbers.
    #[inline(always)]
    pub fn load(simd: S, from: &Several, part: usize) -> Self {
        Self { simd, value: S::as_simd_f64s(from).0[part] }
    }

    /// Writes the part `part` of some numbers.
    #[inline(always)]
    pub fn store(self, to: &mut Several, part: usize) {
        S::as_mut_simd_f64s(to).0[part] = self.value;
    }

    /// The numbers of `self` where `a > b`, zero elsewhere.
    #[inline(always)]
    pub fn where_greater(self, a: Self, b: Self) -> Self {
        let Self { simd, value } = self;
        let mask = simd.greater_than_f64s(a.value, b.value);
        Self { simd, value: simd.select_f64s(mask, value, simd.splat_f64s(0.0)) }
    }
}

impl<S: Simd> Number for Wide<S> {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self { value: self.simd.sqrt_f64s(self.value), ..self }
    }
    #[inline(always)]
    fn each_with(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        let (mut all, mut others) = ([0.0; LANES], [0.0; LANES]);
        self.store(&mut all, 0);
        other.store(&mut others, 0);
        for (value, other) in all.iter_mut().zip(others).take(S::F64_LANES) {
            *value = function(*value, other);
        }
        Self::load(self.simd, &all, 0)
    }
}

impl<S: Simd> Add for Wide<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.simd.add_f64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Sub for Wide<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.simd.sub_f64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Mul for Wide<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { value: self.simd.mul_f64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Mul<f64> for Wide<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * self.like(factor)
    }
}

impl<S: Simd> Div for Wide<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { value: self.simd.div_f64s(self.value, other.value), ..self }
    }
}

/// What is done with vectors of a width that is known at run time.
pub trait Operation {
    /// Result of the operation.
    type Output;
    /// Runs the operation. Must be inlined, as all that it calls: only then is it compiled for the processor's vectors. Closures cannot be made to be inlined.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Does something with the widest vectors that the processor has, up to [`LANES`] numbers.
#[inline(always)]
pub fn dispatch<O: Operation>(operation: O) -> O::Output {
    struct UpToLanes<O>(O);
    impl<O: Operation> pulp::WithSimd for UpToLanes<O> {
        type Output = O::Output;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> O::Output {
            if S::F64_LANES <= LANES { self.0.run(simd) } else { self.0.run(pulp::Scalar256b) }
        }
    }
    pulp::Arch::new().dispatch(UpToLanes(operation))
}

/// Symmetric tensors of [`LANES`] points, `[component][point]`; components as of [`SymmetricTensor2`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct SymmetricTensors(pub [Several; 6]);

impl SymmetricTensors {
    /// Zero at all points.
    pub const ZERO: Self = Self([[0.0; LANES]; 6]);

    /// Tensors of all points that are equal to this one.
    pub fn splat(a: &SymmetricTensor2) -> Self {
        Self(a.0.map(|x| [x; LANES]))
    }

    /// The tensor of a point.
    #[inline(always)]
    pub fn get(&self, point: usize) -> SymmetricTensor2 {
        let mut out = SymmetricTensor2::ZERO;
        for (out, all) in out.0.iter_mut().zip(&self.0) {
            *out = all[point];
        }
        out
    }

    /// Replaces the tensor of a point.
    #[inline(always)]
    pub fn set(&mut self, point: usize, a: &SymmetricTensor2) {
        for (all, a) in self.0.iter_mut().zip(&a.0) {
            all[point] = *a;
        }
    }

    /// A part of the points.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, part: usize) -> [Wide<S>; 6] {
        let mut out = [Wide::splat(simd, 0.0); 6];
        for (out, all) in out.iter_mut().zip(&self.0) {
            *out = Wide::load(simd, all, part);
        }
        out
    }

    /// Replaces a part of the points.
    #[inline(always)]
    pub fn store<S: Simd>(&mut self, a: &[Wide<S>; 6], part: usize) {
        for (all, a) in self.0.iter_mut().zip(a) {
            a.store(all, part);
        }
    }
}

/// Fourth-order tensors of [`LANES`] points, `[row][column][point]`; components as of [`Tensor4`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Tensors4(pub [[Several; 6]; 6]);

impl Tensors4 {
    /// Zero at all points.
    pub const ZERO: Self = Self([[[0.0; LANES]; 6]; 6]);

    /// The tensor of a point.
    pub fn get(&self, point: usize) -> Tensor4 {
        Tensor4(self.0.map(|row| row.map(|all| all[point])))
    }

    /// Replaces the tensor of a point.
    #[inline(always)]
    pub fn set(&mut self, point: usize, a: &Tensor4) {
        for (all, a) in self.0.as_flattened_mut().iter_mut().zip(a.0.as_flattened()) {
            all[point] = *a;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components;
    use proptest::prelude::*;

    /// Inverse, double contraction with `b`, a logarithm, and `1` where the determinant is above one.
    struct Formulas<'a> {
        a: &'a SymmetricTensors,
        b: &'a SymmetricTensors,
        out: &'a mut (SymmetricTensors, [Several; 3]),
    }

    fn formulas<T: Number>(a: [T; 6], b: [T; 6]) -> ([T; 6], T, T) {
        let det = components::determinant(a);
        (components::inverse(a, det), components::double_contraction(&a, &b), (det * det + det.like(1.0)).each(f64::ln))
    }

    impl Operation for Formulas<'_> {
        type Output = ();
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            for part in 0..parts::<S>() {
                let (a, b) = (self.a.load(simd, part), self.b.load(simd, part));
                let (inverse, contraction, log) = formulas(a, b);
                self.out.0.store(&inverse, part);
                contraction.store(&mut self.out.1[0], part);
                log.store(&mut self.out.1[1], part);
                let one = log.like(1.0);
                one.where_greater(components::determinant(a), one).store(&mut self.out.1[2], part);
            }
        }
    }

    proptest! {
        #[test]
        fn side_by_side_or_alone(a in proptest::array::uniform4(proptest::array::uniform6(-2.0..2.0_f64)), b in proptest::array::uniform4(proptest::array::uniform6(-2.0..2.0_f64))) {
            let lanes = |all: &[[f64; 6]; 4]| {
                let mut out = SymmetricTensors::ZERO;
                all.iter().enumerate().for_each(|(l, a)| out.set(l, &SymmetricTensor2(*a)));
                out
            };
            let run = |scalar: bool| {
                let mut out = (SymmetricTensors::ZERO, [[0.0; LANES]; 3]);
                let (a, b) = (lanes(&a), lanes(&b));
                let operation = Formulas { a: &a, b: &b, out: &mut out };
                if scalar { operation.run(pulp::Scalar) } else { dispatch(operation) }
                out
            };
            prop_assert_eq!(run(true), run(false));
            let (inverses, numbers) = run(false);
            for l in 0..LANES {
                let (inverse, contraction, log) = formulas(a[l], b[l]);
                prop_assert_eq!(inverses.get(l).0, inverse);
                prop_assert_eq!([numbers[0][l], numbers[1][l]], [contraction, log]);
                prop_assert_eq!(numbers[2][l], f64::from(u8::from(components::determinant(a[l]) > 1.0)));
            }
        }
    }
}
