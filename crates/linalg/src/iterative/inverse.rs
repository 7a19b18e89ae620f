//! Inverses of small dense matrices.

use super::bsr::{Block, Bsr};
use super::real::Real;

/// A pivot below this part of the largest entry is none.
const SMALLEST_PIVOT: f64 = 1e-14;

/// Inverse by Gauss and Jordan with exchanges of rows, in place; `n` rows, one after the other. An unknown without a pivot is left alone: the inverse has its unit vector.
pub(crate) fn invert(a: &mut [f64], n: usize) {
    let mut right: Vec<f64> = (0..n * n).map(|k| if k / n == k % n { 1.0 } else { 0.0 }).collect();
    let smallest = SMALLEST_PIVOT * a.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    for c in 0..n {
        let mut pivot = c;
        for i in c..n {
            if a[i * n + c].abs() > a[pivot * n + c].abs() {
                pivot = i;
            }
        }
        if a[pivot * n + c].abs() <= smallest {
            for j in 0..n {
                let unit = if j == c { 1.0 } else { 0.0 };
                (a[c * n + j], right[c * n + j]) = (unit, unit);
            }
            continue;
        }
        if pivot != c {
            for j in 0..n {
                a.swap(pivot * n + j, c * n + j);
                right.swap(pivot * n + j, c * n + j);
            }
        }
        let factor = 1.0 / a[c * n + c];
        for j in 0..n {
            a[c * n + j] *= factor;
            right[c * n + j] *= factor;
        }
        for i in 0..n {
            let factor = a[i * n + c];
            if i != c && factor != 0.0 {
                for j in 0..n {
                    a[i * n + j] -= factor * a[c * n + j];
                    right[i * n + j] -= factor * right[c * n + j];
                }
            }
        }
    }
    a.copy_from_slice(&right);
}

/// Inverses of the diagonal blocks.
pub(crate) fn inverse_diagonal<const B: usize>(a: &Bsr<f64, B, B>) -> Vec<Block<f64, B, B>> {
    let of_row = |i: usize| {
        let mut block = a.position(i, i).map_or([[0.0; B]; B], |at| a.blocks[at]);
        invert(block.as_flattened_mut(), B);
        block
    };
    (0..a.rows()).map(of_row).collect()
}

/// `D r`.
#[inline(always)]
pub(crate) fn times<T: Real, const B: usize>(block: &Block<T, B, B>, r: &[T; B]) -> [T; B] {
    let mut product = [T::default(); B];
    for i in 0..B {
        for j in 0..B {
            product[i] += block[i][j] * r[j];
        }
    }
    product
}

/// `z_i = factor D_i r_i` for each block.
pub(crate) fn apply_blocks<T: Real, const B: usize>(blocks: &[Block<T, B, B>], factor: T, r: &[T], z: &mut [T]) {
    let rows = r.as_chunks::<B>().0.iter().zip(z.as_chunks_mut::<B>().0);
    for (block, (r, z)) in blocks.iter().zip(rows) {
        *z = times(block, r).map(|v| factor * v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_the_unit_matrix() {
        let a: Vec<f64> = (0..36).map(|k| (k as f64 * 1.7).sin() + if k % 7 == 0 { 0.1 } else { 0.0 }).collect();
        let mut inverse = a.clone();
        invert(&mut inverse, 6);
        for i in 0..6 {
            for j in 0..6 {
                let sum: f64 = (0..6).map(|k| inverse[6 * i + k] * a[6 * k + j]).sum();
                assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j} {sum}");
            }
        }
        let mut swap = [0.0, 2.0, 4.0, 0.0];
        invert(&mut swap, 2);
        assert_eq!(swap, [0.0, 0.25, 0.5, 0.0]);
        let mut none = [0.0; 4];
        invert(&mut none, 2);
        assert_eq!(none, [1.0, 0.0, 0.0, 1.0]);
    }
}
