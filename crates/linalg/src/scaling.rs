//! Equilibration by powers of two, which changes no bit of a mantissa. Not a pivoting strategy.

use crate::{MatrixKind, SparsityPattern};

/// `A_s = R A C` with diagonal `R`, `C` whose entries are powers of two.
///
/// In general first the largest entry of each row is brought to about 1, then the largest of each column: a saddle point with
/// stiffness `1e6` and constraint gradients of 1 becomes a matrix of entries around 1, so that the size of a pivot means
/// something. For a matrix announced as positive definite `R = C` brings the diagonal to about 1 and keeps the symmetry.
///
/// Stiffnesses and constraint gradients have different units, so that the larger of both says nothing by itself. Where the pattern tells multipliers from displacements
/// ([`SparsityPattern::first_multiplier`]), multipliers are first given the unit in which the largest gradient is [`GRADIENT`] of the largest stiffness: a matrix in
/// other units of length, mass and time has the same scaled entries, to the bit if the units differ by even powers of two.
#[derive(Debug, Default)]
pub struct Equilibration {
    rows: Vec<f64>,
    columns: Vec<f64>,
}

impl Equilibration {
    /// Computes the factors and writes the scaled values.
    ///
    /// # Errors
    /// The index of a row or column of zeros.
    pub fn compute(
        &mut self,
        pattern: &SparsityPattern,
        values: &[f64],
        kind: MatrixKind,
        scaled: &mut Vec<f64>,
    ) -> Result<(), usize> {
        let n = pattern.n();
        self.rows.clear();
        self.rows.resize(n, 0.0);
        self.columns.clear();
        scaled.clear();
        if kind == MatrixKind::SymmetricPositiveDefinite && self.set_from_diagonal(pattern, values) {
            for j in 0..n {
                let range = pattern.column_range(j);
                let c = self.columns[j];
                let rows = &pattern.row_indices()[range.clone()];
                scaled.extend((rows.iter().zip(&values[range])).map(|(&i, v)| v * self.rows[i as usize] * c));
            }
            return Ok(());
        }
        let unit = self.largest_of_rows(pattern, values)?;
        for (i, r) in self.rows.iter_mut().enumerate() {
            *r = power_of_two(-exponent(*r)) * unit(i);
        }
        for j in 0..n {
            let range = pattern.column_range(j);
            let rows = &pattern.row_indices()[range.clone()];
            let mut largest = 0.0f64;
            let start = scaled.len();
            for (&i, v) in rows.iter().zip(&values[range]) {
                let s = v * self.rows[i as usize];
                largest = largest.max(s.abs());
                scaled.push(s);
            }
            if largest == 0.0 {
                return Err(j);
            }
            let c = power_of_two(-exponent(largest * unit(j))) * unit(j);
            scaled[start..].iter_mut().for_each(|s| *s *= c);
            self.columns.push(c);
        }
        Ok(())
    }

    /// `R = C`, so that symmetric values stay symmetric. First each row is divided by the root of its largest entry, after Ruiz (Rutherford Appleton
    /// Laboratory, RAL-TR-2001-034), so that no entry exceeds about 1. Then the rows are lifted one after the other until one of their entries
    /// is about 1, which keeps the others below: two readings, where repeating the first step takes five and ends farther from 1.
    ///
    /// # Errors
    /// The index of a row or column of zeros.
    pub fn compute_symmetric(
        &mut self,
        pattern: &SparsityPattern,
        values: &[f64],
        scaled: &mut Vec<f64>,
    ) -> Result<(), usize> {
        let n = pattern.n();
        self.rows.clear();
        self.rows.resize(n, 0.0);
        // Values that are not symmetric after all may have a row of zeros without the column, or the other way round.
        let unit = self.largest_of_rows(pattern, values)?;
        for (i, r) in self.rows.iter_mut().enumerate() {
            *r = power_of_two((-exponent(*r)).div_euclid(2)) * unit(i);
        }
        for j in 0..n {
            let range = pattern.column_range(j);
            let (rows, column) = (&pattern.row_indices()[range.clone()], &values[range]);
            let below = rows.partition_point(|&i| (i as usize) < j);
            let largest = |rows: &[u32], column: &[f64]| {
                rows.iter().zip(column).fold(0.0f64, |largest, (&i, v)| largest.max(v.abs() * self.rows[i as usize]))
            };
            // The diagonal is always in the pattern; it feels the row's factor twice.
            let diagonal = column[below].abs() * self.rows[j] * self.rows[j];
            let others =
                largest(&rows[..below], &column[..below]).max(largest(&rows[below + 1..], &column[below + 1..]));
            let others = others * self.rows[j];
            if others == 0.0 && diagonal == 0.0 {
                return Err(j);
            }
            let lift = (-exponent(others)).min((-exponent(diagonal)).div_euclid(2));
            self.rows[j] *= power_of_two(lift);
        }
        scaled.clear();
        for j in 0..n {
            let range = pattern.column_range(j);
            let c = self.rows[j];
            let rows = &pattern.row_indices()[range.clone()];
            scaled.extend(rows.iter().zip(&values[range]).map(|(&i, v)| v * self.rows[i as usize] * c));
        }
        self.columns.clear();
        self.columns.extend_from_slice(&self.rows);
        Ok(())
    }

    /// Puts the largest entry of each row into `rows`, multipliers in their new unit, and gives the factors of unknowns that belong to it.
    ///
    /// # Errors
    /// The index of a row of zeros.
    fn largest_of_rows(
        &mut self,
        pattern: &SparsityPattern,
        values: &[f64],
    ) -> Result<impl Fn(usize) -> f64 + use<>, usize> {
        let first = pattern.first_multiplier();
        let factor = unit_of_multipliers(pattern, values);
        let unit = move |i: usize| if i < first { 1.0 } else { factor };
        for j in 0..pattern.n() {
            let range = pattern.column_range(j);
            for (&i, v) in pattern.row_indices()[range.clone()].iter().zip(&values[range]) {
                let i = i as usize;
                self.rows[i] = self.rows[i].max(v.abs() * unit(j) * unit(i));
            }
        }
        match self.rows.iter().position(|&m| m == 0.0) {
            Some(row) => Err(row),
            None => Ok(unit),
        }
    }

    /// `R = C` from the diagonal; false if an entry of it is not positive.
    fn set_from_diagonal(&mut self, pattern: &SparsityPattern, values: &[f64]) -> bool {
        for j in 0..pattern.n() {
            let range = pattern.column_range(j);
            // The diagonal is always in the pattern.
            let k = pattern.column(j).partition_point(|&i| (i as usize) < j) + range.start;
            if values[k] <= 0.0 {
                return false;
            }
            self.rows[j] = power_of_two(-exponent(values[k]).div_euclid(2));
        }
        self.columns.extend_from_slice(&self.rows);
        true
    }

    /// `v <- R v`.
    pub fn scale_rhs(&self, v: &mut [f64]) {
        v.iter_mut().zip(&self.rows).for_each(|(v, r)| *v *= r);
    }

    /// `v <- C v`.
    pub fn scale_solution(&self, v: &mut [f64]) {
        v.iter_mut().zip(&self.columns).for_each(|(v, c)| *v *= c);
    }

    /// `max_j |x_j / c_j|`: the largest unknown of the equilibrated system.
    pub fn largest_scaled_unknown(&self, x: &[f64]) -> f64 {
        let scaled = x.iter().zip(&self.columns).map(|(x, c)| (x / c).abs());
        scaled.fold(0.0, f64::max)
    }

    /// The size of the largest possible term of row `i` of `A x`, in the original units; the equilibrated row's largest entry
    /// is about 1.
    pub fn row_size(&self, i: usize, largest_scaled_unknown: f64) -> f64 {
        largest_scaled_unknown / self.rows[i]
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<f64>() * (self.rows.capacity() + self.columns.capacity())
    }
}

/// Part of the largest stiffness that the largest constraint gradient is made: large enough for rows that have no stiffness, as of rigid bodies in statics, and small enough that a body that is softer
/// by a thousand is still measured by its own stiffness.
const GRADIENT: i64 = -12;

/// The power of two by which multipliers, and their rows, are multiplied for that; 1 if there are no multipliers, or no stiffness beside them.
fn unit_of_multipliers(pattern: &SparsityPattern, values: &[f64]) -> f64 {
    let first = pattern.first_multiplier();
    if first == pattern.n() {
        return 1.0;
    }
    let (mut stiffness, mut gradient) = (0f64, 0f64);
    for j in 0..pattern.n() {
        let range = pattern.column_range(j);
        for (&i, v) in pattern.row_indices()[range.clone()].iter().zip(&values[range]) {
            let largest = match ((i as usize) < first, j < first) {
                (true, true) => &mut stiffness,
                (false, false) => continue,
                _ => &mut gradient,
            };
            *largest = largest.max(v.abs());
        }
    }
    let known = stiffness > 0.0 && gradient > 0.0;
    if known { power_of_two((exponent(stiffness) - exponent(gradient) + GRADIENT).clamp(-1000, 1000)) } else { 1.0 }
}

/// The `e` with `2^e <= x < 2^(e+1)`, for positive normal `x`; clamped so that `2^-e` is a normal number too.
fn exponent(x: f64) -> i64 {
    (((x.to_bits() >> 52) & 0x7ff) as i64 - 1023).clamp(-1000, 1000)
}

/// `2^e` for `|e| <= 1000`.
fn power_of_two(e: i64) -> f64 {
    f64::from_bits(((1023 + e) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_bracket_one() {
        for x in [1.0, 1.5, 2.0, 3e-9, 7e200, 0.999, 1e-300] {
            let p = power_of_two(-exponent(x));
            assert!((1.0..2.0).contains(&(x * p)), "{x}");
            assert_eq!(p.to_bits() << 12, 0, "a power of two has an empty mantissa");
        }
    }

    /// Symmetric saddle points whose entries differ by thirty orders of magnitude.
    #[test]
    fn symmetric_scaling_brings_rows_to_one_and_keeps_symmetry() {
        let n = 12;
        let all: Vec<u32> = (0..n).collect();
        let pattern = SparsityPattern::from_stencils(n as usize, std::iter::once(&all[..])).unwrap();
        let mut strategy = proptest::test_runner::TestRunner::deterministic();
        let exponents = proptest::collection::vec(-15i32..15, 144);
        strategy
            .run(&exponents, |exponents| {
                let n = n as usize;
                let entry = |i: usize, j: usize| {
                    let (i, j) = (i.min(j), i.max(j));
                    // The last three equations have no diagonal block, and some entries are missing.
                    let absent = i >= n - 3 || (i != j && exponents[i + n * j] % 3 == 0 && i > 0);
                    if absent { 0.0 } else { 1.5 * 10f64.powi(exponents[i * n + j]) }
                };
                let values: Vec<f64> = (0..n * n).map(|k| entry(k % n, k / n)).collect();
                let (mut e, mut scaled) = (Equilibration::default(), Vec::new());
                e.compute_symmetric(&pattern, &values, &mut scaled).unwrap();
                for j in 0..n {
                    let largest = (0..n).fold(0f64, |m, i| m.max(scaled[n * j + i].abs()));
                    proptest::prop_assert!((0.5..4.0).contains(&largest), "row {j}: {largest}");
                    for i in 0..n {
                        proptest::prop_assert_eq!(scaled[n * j + i].to_bits(), scaled[n * i + j].to_bits());
                    }
                }
                Ok(())
            })
            .unwrap();
    }

    #[test]
    fn general_scaling_brings_rows_and_columns_to_one() {
        let all: Vec<u32> = (0..4).collect();
        let pattern = SparsityPattern::from_stencils(4, std::iter::once(&all[..])).unwrap();
        let values: Vec<f64> =
            (0..16).map(|k| 10f64.powi((k * 7) % 17 - 8) * if k % 3 == 0 { -1.5 } else { 2.5 }).collect();
        let (mut e, mut scaled) = (Equilibration::default(), Vec::new());
        e.compute(&pattern, &values, MatrixKind::General, &mut scaled).unwrap();
        for k in 0..4 {
            let column = scaled[4 * k..4 * k + 4].iter().fold(0f64, |m, v| m.max(v.abs()));
            let row = (0..4).fold(0f64, |m, j| m.max(scaled[4 * j + k].abs()));
            assert!((1.0..2.0).contains(&column), "column {k}: {column}");
            assert!((0.5..2.0).contains(&row), "row {k}: {row}");
        }
    }

    /// Ten displacements, four multipliers of which one acts on others only, entries of thirty orders of magnitude: in other units of forces, and of multipliers with their rows, the scaled matrix
    /// is the same to the bit.
    #[test]
    fn saddle_points_in_other_units_have_the_same_scaled_entries() {
        let (n, first) = (14, 10);
        let all: Vec<u32> = (0..n as u32).collect();
        let pattern =
            SparsityPattern::from_stencils(n, std::iter::once(&all[..])).unwrap().with_first_multiplier(first);
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        let exponents = proptest::collection::vec(-8i32..8, n * n);
        let units = (-15i32..15, -15i32..15);
        runner
            .run(&(exponents, units), |(exponents, (multipliers, forces))| {
                let entry = |i: usize, j: usize| {
                    let (i, j) = (i.min(j), i.max(j));
                    let absent = (j >= first && i >= first) && (i != j || i % 2 == 0) && (i, j) != (12, 13);
                    let absent = absent || j == 13 && i != 12 || (i != j && exponents[i + n * j] % 3 == 0);
                    if absent { 0.0 } else { 1.5 * 10f64.powi(exponents[i * n + j]) }
                };
                // Even powers of two, as the roots of the symmetric scaling need them.
                let unit = |k: usize| if k < first { 1.0 } else { 4f64.powi(multipliers) };
                let stiffness = 4f64.powi(forces);
                let base: Vec<f64> = (0..n * n).map(|k| entry(k % n, k / n)).collect();
                let other: Vec<f64> = (0..n * n).map(|k| stiffness * base[k] * unit(k % n) * unit(k / n)).collect();
                let scale = |values: &[f64], symmetric: bool| {
                    let (mut e, mut scaled) = (Equilibration::default(), Vec::new());
                    let made = if symmetric {
                        e.compute_symmetric(&pattern, values, &mut scaled)
                    } else {
                        e.compute(&pattern, values, MatrixKind::General, &mut scaled)
                    };
                    made.map(|()| scaled.iter().map(|v| v.to_bits()).collect::<Vec<_>>())
                };
                for symmetric in [false, true] {
                    proptest::prop_assert_eq!(scale(&base, symmetric), scale(&other, symmetric), "{}", symmetric);
                }
                Ok(())
            })
            .unwrap();
    }
}
