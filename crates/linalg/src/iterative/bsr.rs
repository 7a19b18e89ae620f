//! Sparse matrices of dense blocks, by rows. The sizes of a block are part of the type, so that kernels know them.

use super::real::Real;
use rayon::prelude::*;

/// Rows of blocks that one task computes.
pub(crate) const TASK_ROWS: usize = 512;

/// A dense block, by rows.
pub(crate) type Block<T, const R: usize, const C: usize> = [[T; C]; R];

/// A sparse matrix of blocks of `R` rows and `C` columns. The columns of a row increase strictly.
#[derive(Debug, Clone)]
pub(crate) struct Bsr<T, const R: usize, const C: usize> {
    /// Columns of blocks.
    pub columns: usize,
    /// Where the rows begin, one more than there are rows of blocks.
    pub starts: Vec<usize>,
    pub indices: Vec<u32>,
    pub blocks: Vec<Block<T, R, C>>,
}

impl<T: Real, const R: usize, const C: usize> Default for Bsr<T, R, C> {
    fn default() -> Self {
        Self::empty(0)
    }
}

/// Runs `task` with the widest vectors that the processor has. No sum is reordered for it and nothing is contracted: the bits are the same on every processor.
#[inline(always)]
pub(crate) fn with_wide_vectors(task: impl FnOnce()) {
    pulp::Arch::new().dispatch(task);
}

/// `task(i, y_i)` for each row of blocks, in tasks of fixed size.
fn for_rows<T: Real, const R: usize>(y: &mut [T], task: impl Fn(usize, &mut [T; R]) + Sync) {
    let each = |(k, rows): (usize, &mut [T])| {
        with_wide_vectors(
            #[inline(always)]
            || {
                for (i, row) in rows.as_chunks_mut().0.iter_mut().enumerate() {
                    task(k * TASK_ROWS + i, row);
                }
            },
        );
    };
    if rayon::current_num_threads() == 1 || y.len() <= 4 * R * TASK_ROWS {
        each((0, y));
    } else {
        y.par_chunks_mut(R * TASK_ROWS).enumerate().for_each(each);
    }
}

impl<T: Real, const R: usize, const C: usize> Bsr<T, R, C> {
    /// A matrix without rows.
    pub fn empty(columns: usize) -> Self {
        Self { columns, starts: vec![0], indices: Vec::new(), blocks: Vec::new() }
    }

    /// Rows of blocks.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Columns and blocks of a row.
    #[inline(always)]
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &Block<T, R, C>)> {
        let range = self.starts[i]..self.starts[i + 1];
        self.indices[range.clone()].iter().map(|&j| j as usize).zip(&self.blocks[range])
    }

    /// Row `i` of `A x`.
    #[inline(always)]
    pub fn row_product(&self, i: usize, x: &[[T; C]]) -> [T; R] {
        // A sum for each entry of a block: they are formed side by side.
        let mut sums = [[T::default(); C]; R];
        for (j, block) in self.row(i) {
            let x = [x[j]; R];
            let products = block.as_flattened().iter().zip(x.as_flattened());
            sums.as_flattened_mut().iter_mut().zip(products).for_each(|(sum, (entry, x))| *sum += *entry * *x);
        }
        sums.map(|sums| sums.into_iter().fold(T::default(), |a, b| a + b))
    }

    /// `task(i, range, columns, blocks)` for each row of blocks, `range` of the list of all.
    pub fn for_rows_of_blocks(
        &mut self,
        task: impl Fn(usize, std::ops::Range<usize>, &[u32], &mut [Block<T, R, C>]) + Sync,
    ) {
        let Self { starts, indices, blocks, .. } = self;
        let rows = starts.len() - 1;
        let (mut parts, mut rest) = (Vec::with_capacity(rows.div_ceil(TASK_ROWS)), &mut blocks[..]);
        for first in (0..rows).step_by(TASK_ROWS) {
            let last = rows.min(first + TASK_ROWS);
            let (part, behind) = rest.split_at_mut(starts[last] - starts[first]);
            parts.push((first..last, part));
            rest = behind;
        }
        parts.into_par_iter().for_each(|(rows, mut part)| {
            for i in rows {
                let range = starts[i]..starts[i + 1];
                let (row, behind) = std::mem::take(&mut part).split_at_mut(range.len());
                task(i, range.clone(), &indices[range], row);
                part = behind;
            }
        });
    }

    /// `y = A x`.
    pub fn multiply(&self, x: &[T], y: &mut [T]) {
        let x = x.as_chunks().0;
        for_rows(
            y,
            #[inline(always)]
            |i, y| *y = self.row_product(i, x),
        );
    }

    /// `y += A x`.
    pub fn add_product(&self, x: &[T], y: &mut [T]) {
        let x = x.as_chunks().0;
        for_rows(
            y,
            #[inline(always)]
            |i, y: &mut [T; R]| {
                let product = self.row_product(i, x);
                (0..R).for_each(|r| y[r] += product[r]);
            },
        );
    }

    /// `A^T`.
    pub fn transposed(&self) -> Bsr<T, C, R> {
        let mut starts = vec![0usize; self.columns + 1];
        self.indices.iter().for_each(|&j| starts[j as usize + 1] += 1);
        (0..self.columns).for_each(|j| starts[j + 1] += starts[j]);
        let mut next = starts.clone();
        let mut indices = vec![0u32; self.indices.len()];
        let mut blocks = vec![[[T::default(); R]; C]; self.blocks.len()];
        for i in 0..self.rows() {
            for (j, block) in self.row(i) {
                let at = next[j];
                next[j] += 1;
                indices[at] = i as u32;
                for (r, row) in block.iter().enumerate() {
                    for (c, &value) in row.iter().enumerate() {
                        blocks[at][c][r] = value;
                    }
                }
            }
        }
        Bsr { columns: self.rows(), starts, indices, blocks }
    }

    /// Times a factor, in another precision.
    pub fn rounded<U: Real>(&self, factor: f64) -> Bsr<U, R, C> {
        let round = |block: &Block<T, R, C>| block.map(|row| row.map(|v| U::rounded(factor * v.wide())));
        let blocks = self.blocks.iter().map(round).collect();
        Bsr { columns: self.columns, starts: self.starts.clone(), indices: self.indices.clone(), blocks }
    }

    /// Position of a block in the list; `None` where the pattern has none.
    pub fn position(&self, i: usize, j: usize) -> Option<usize> {
        let range = self.starts[i]..self.starts[i + 1];
        self.indices[range.clone()].binary_search(&(j as u32)).ok().map(|at| range.start + at)
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<usize>() * self.starts.capacity()
            + size_of::<u32>() * self.indices.capacity()
            + size_of::<Block<T, R, C>>() * self.blocks.capacity()
    }
}

/// Scratch of [`product`]: which place a column has in the present row.
struct Row<const R: usize, const C: usize> {
    place: Vec<u32>,
    columns: Vec<u32>,
    blocks: Vec<Block<f64, R, C>>,
    order: Vec<u32>,
}

impl<const R: usize, const C: usize> Row<R, C> {
    fn new(columns: usize) -> Self {
        Self { place: vec![u32::MAX; columns], columns: Vec::new(), blocks: Vec::new(), order: Vec::new() }
    }

    #[inline(always)]
    fn at(&mut self, column: u32) -> &mut Block<f64, R, C> {
        let place = &mut self.place[column as usize];
        if *place == u32::MAX {
            *place = self.columns.len() as u32;
            self.columns.push(column);
            self.blocks.push([[0.0; C]; R]);
        }
        &mut self.blocks[*place as usize]
    }

    #[inline(always)]
    /// Appends the row, in ascending order of the columns, and is empty again.
    fn finish(&mut self, out: &mut Bsr<f64, R, C>) {
        self.order.clear();
        self.order.extend(0..self.columns.len() as u32);
        self.order.sort_unstable_by_key(|&k| self.columns[k as usize]);
        out.indices.extend(self.order.iter().map(|&k| self.columns[k as usize]));
        out.blocks.extend(self.order.iter().map(|&k| self.blocks[k as usize]));
        out.starts.push(out.indices.len());
        self.columns.iter().for_each(|&column| self.place[column as usize] = u32::MAX);
        self.columns.clear();
        self.blocks.clear();
    }
}

/// The matrix whose rows `fill(i, row)` gives, each the work of one thread.
fn by_rows<const R: usize, const C: usize>(
    rows: usize,
    columns: usize,
    fill: impl Fn(usize, &mut Row<R, C>) + Sync,
) -> Bsr<f64, R, C> {
    let mut out = Bsr::empty(columns);
    if rayon::current_num_threads() == 1 || rows <= 4 * TASK_ROWS {
        let mut row = Row::new(columns);
        with_wide_vectors(
            #[inline(always)]
            || {
                for i in 0..rows {
                    fill(i, &mut row);
                    row.finish(&mut out);
                }
            },
        );
        return out;
    }
    // Not all at once: the parts are copied.
    let tasks = rows.div_ceil(TASK_ROWS);
    let at_once = 8 * rayon::current_num_threads();
    for first in (0..tasks).step_by(at_once) {
        let parts: Vec<Bsr<f64, R, C>> = (first..tasks.min(first + at_once))
            .into_par_iter()
            .map_init(
                || Row::new(columns),
                |row, task| {
                    let mut part = Bsr::empty(columns);
                    with_wide_vectors(
                        #[inline(always)]
                        || {
                            for i in task * TASK_ROWS..rows.min((task + 1) * TASK_ROWS) {
                                fill(i, row);
                                row.finish(&mut part);
                            }
                        },
                    );
                    part
                },
            )
            .collect();
        for part in parts {
            let before = out.indices.len();
            out.starts.extend(part.starts[1..].iter().map(|start| before + start));
            out.indices.extend_from_slice(&part.indices);
            out.blocks.extend_from_slice(&part.blocks);
        }
    }
    out
}

/// `A B`.
pub(crate) fn product<const R: usize, const K: usize, const C: usize>(
    a: &Bsr<f64, R, K>,
    b: &Bsr<f64, K, C>,
) -> Bsr<f64, R, C> {
    by_rows(
        a.rows(),
        b.columns,
        #[inline(always)]
        |i, row| {
            for (j, left) in a.row(i) {
                for (column, right) in b.row(j) {
                    let sum = row.at(column as u32);
                    for r in 0..R {
                        for k in 0..K {
                            for c in 0..C {
                                sum[r][c] += left[r][k] * right[k][c];
                            }
                        }
                    }
                }
            }
        },
    )
}

/// `A` and further blocks: `more(i, add)` calls `add(column, block)` for those of row `i`.
pub(crate) fn sum_with(
    a: &Bsr<f64, 3, 3>,
    more: impl Fn(usize, &mut dyn FnMut(u32, &Block<f64, 3, 3>)) + Sync,
) -> Bsr<f64, 3, 3> {
    by_rows(
        a.rows(),
        a.columns,
        #[inline(always)]
        |i, row| {
            for (column, block) in a.row(i) {
                *row.at(column as u32) = *block;
            }
            more(i, &mut |column, block| {
                let sum = row.at(column);
                for r in 0..3 {
                    for c in 0..3 {
                        sum[r][c] += block[r][c];
                    }
                }
            });
        },
    )
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The dense matrix by rows, `R * rows` times `C * columns` entries.
    pub(crate) fn dense<T: Real, const R: usize, const C: usize>(a: &Bsr<T, R, C>) -> Vec<Vec<f64>> {
        let mut out = vec![vec![0.0; C * a.columns]; R * a.rows()];
        for i in 0..a.rows() {
            for (j, block) in a.row(i) {
                for r in 0..R {
                    for c in 0..C {
                        out[R * i + r][C * j + c] += block[r][c].wide();
                    }
                }
            }
        }
        out
    }

    pub(crate) fn dense_product(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let entry = |row: &Vec<f64>, c: usize| (0..b.len()).map(|k| row[k] * b[k][c]).sum();
        a.iter().map(|row| (0..b[0].len()).map(|c| entry(row, c)).collect()).collect()
    }

    pub(crate) fn difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
        assert_eq!((a.len(), a[0].len()), (b.len(), b[0].len()));
        a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    }

    /// Pseudo-random blocks; about `share` of the places.
    fn random<const R: usize, const C: usize>(rows: usize, columns: usize, share: f64, seed: usize) -> Bsr<f64, R, C> {
        let value = |k: usize| ((k * 7919 + seed) as f64 * 0.61).sin();
        let mut a = Bsr::empty(columns);
        for i in 0..rows {
            for j in 0..columns {
                if value(i * columns + j).abs() < share {
                    a.indices.push(j as u32);
                    a.blocks.push(std::array::from_fn(|r| std::array::from_fn(|c| value(i + 17 * j + 5 * r + 3 * c))));
                }
            }
            a.starts.push(a.indices.len());
        }
        a
    }

    #[test]
    fn products_and_transposes_are_those_of_dense_matrices() {
        let (a, b) = (random::<3, 6>(7, 5, 0.5, 1), random::<6, 3>(5, 4, 0.6, 2));
        assert!(difference(&dense(&product(&a, &b)), &dense_product(&dense(&a), &dense(&b))) < 1e-14);
        let transposed: Vec<Vec<f64>> = (0..30).map(|c| dense(&a).iter().map(|row| row[c]).collect()).collect();
        assert_eq!(dense(&a.transposed()), transposed);
        let x: Vec<f64> = (0..30).map(|i| (i as f64).cos()).collect();
        let exact = dense_product(&dense(&a), &x.iter().map(|x| vec![*x]).collect::<Vec<_>>());
        let (mut y, mut z) = (vec![0.0; 21], vec![1.0; 21]);
        a.multiply(&x, &mut y);
        a.add_product(&x, &mut z);
        for i in 0..21 {
            assert!((y[i] - exact[i][0]).abs() < 1e-14 && (z[i] - 1.0 - y[i]).abs() < 1e-14);
        }
    }

    #[test]
    fn threads_leave_the_bits_of_products() {
        let mut a = Bsr::<f64, 3, 3>::empty(9000);
        for i in 0..9000usize {
            for j in [i.saturating_sub(77), i] {
                if a.indices.len() == a.starts[i] || a.indices.last() != Some(&(j as u32)) {
                    a.indices.push(j as u32);
                    a.blocks.push(std::array::from_fn(|r| {
                        std::array::from_fn(|c| ((i * j + 3 * r + c) as f64 * 0.17).sin())
                    }));
                }
            }
            a.starts.push(a.indices.len());
        }
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| product(&a, &a))
        };
        let (one, three) = (run(1), run(3));
        assert_eq!((one.starts, one.indices, one.blocks), (three.starts, three.indices, three.blocks));
    }
}
