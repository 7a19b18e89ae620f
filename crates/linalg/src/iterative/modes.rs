//! Rigid motions at the nodes, and the prolongator that carries them to the aggregates.

use super::aggregates::NONE;
use super::bsr::{Block, Bsr, product};

/// Rigid motions.
pub(crate) const MODES: usize = 6;

/// What is left of a mode beyond the earlier ones, below which it depends on them in its aggregate.
const DEPENDENT: f64 = 1e-8;

/// Three translations and three rotations about the mean of the positions, divided by the radius of gyration, at each node; zero in components without equations.
pub(crate) fn rigid_modes(positions: &[[f64; 3]], free: &[[bool; 3]]) -> Vec<Block<f64, 3, MODES>> {
    let n = positions.len().max(1) as f64;
    let mean: [f64; 3] = std::array::from_fn(|d| positions.iter().map(|x| x[d]).sum::<f64>() / n);
    let square = |x: &[f64; 3]| (0..3).map(|d| (x[d] - mean[d]).powi(2)).sum::<f64>();
    let gyration = (positions.iter().map(square).sum::<f64>() / n).sqrt();
    let scale = if gyration > 0.0 { 1.0 / gyration } else { 0.0 };
    let of_node = |(x, free): (&[f64; 3], &[bool; 3])| {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|d| (x[d] - mean[d]) * scale);
        let rows = [[1.0, 0.0, 0.0, 0.0, z, -y], [0.0, 1.0, 0.0, -z, 0.0, x], [0.0, 0.0, 1.0, y, -x, 0.0]];
        std::array::from_fn(|d| if free[d] { rows[d] } else { [0.0; MODES] })
    };
    positions.iter().zip(free).map(of_node).collect()
}

/// The tentative prolongator and the modes of the aggregates: `P0` has in each aggregate an orthonormal basis of the modes there (Gram-Schmidt, twice), and `P0` times the modes of the
/// aggregates are the modes of the nodes. A mode that depends on earlier ones in its aggregate becomes a zero column.
pub(crate) fn tentative<const B: usize>(
    modes: &[Block<f64, B, MODES>],
    of: &[u32],
    count: usize,
) -> (Bsr<f64, B, MODES>, Vec<Block<f64, MODES, MODES>>) {
    let mut p = Bsr::empty(count);
    let mut starts = vec![0usize; count + 1];
    for (block, &aggregate) in modes.iter().zip(of) {
        if aggregate != NONE {
            starts[aggregate as usize + 1] += 1;
            p.indices.push(aggregate);
            p.blocks.push(*block);
        }
        p.starts.push(p.indices.len());
    }
    (0..count).for_each(|a| starts[a + 1] += starts[a]);
    let mut members = vec![0usize; p.blocks.len()];
    let mut next = starts.clone();
    for (k, &aggregate) in p.indices.iter().enumerate() {
        members[next[aggregate as usize]] = k;
        next[aggregate as usize] += 1;
    }
    let mut coarse = vec![[[0.0; MODES]; MODES]; count];
    let mut columns: [Vec<f64>; MODES] = Default::default();
    for (a, r) in coarse.iter_mut().enumerate() {
        let members = &members[starts[a]..starts[a + 1]];
        for (c, column) in columns.iter_mut().enumerate() {
            column.clear();
            column.extend(members.iter().flat_map(|&k| p.blocks[k].map(|row| row[c])));
        }
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        for c in 0..MODES {
            let (done, rest) = columns.split_at_mut(c);
            let column = &mut rest[0];
            let before = length(column);
            for _ in 0..2 {
                for (d, earlier) in done.iter().enumerate() {
                    let part: f64 = earlier.iter().zip(&*column).map(|(x, y)| x * y).sum();
                    r[d][c] += part;
                    column.iter_mut().zip(earlier).for_each(|(y, x)| *y -= part * x);
                }
            }
            let after = length(column);
            let factor = if after > DEPENDENT * before {
                r[c][c] = after;
                1.0 / after
            } else {
                0.0
            };
            column.iter_mut().for_each(|x| *x *= factor);
        }
        for (i, &k) in members.iter().enumerate() {
            p.blocks[k] = std::array::from_fn(|row| std::array::from_fn(|c| columns[c][B * i + row]));
        }
    }
    (p, coarse)
}

/// `(I - omega D^-1 A) P0`.
pub(crate) fn smoothed<const B: usize>(
    a: &Bsr<f64, B, B>,
    inverse: &[Block<f64, B, B>],
    tentative: &Bsr<f64, B, MODES>,
    omega: f64,
) -> Bsr<f64, B, MODES> {
    let mut p = product(a, tentative);
    for i in 0..p.rows() {
        for block in &mut p.blocks[p.starts[i]..p.starts[i + 1]] {
            let mut scaled = [[0.0; MODES]; B];
            for r in 0..B {
                for k in 0..B {
                    for c in 0..MODES {
                        scaled[r][c] -= omega * inverse[i][r][k] * block[k][c];
                    }
                }
            }
            *block = scaled;
        }
        for (j, own) in tentative.row(i) {
            // The diagonal of A is in its pattern.
            if let Some(at) = p.position(i, j) {
                let sum = p.blocks[at].as_flattened_mut().iter_mut();
                sum.zip(own.as_flattened()).for_each(|(sum, v)| *sum += v);
            }
        }
    }
    p
}
