//! `0 <= j`, `W j + b >= 0`, `j . (W j + b) = 0` for a symmetric, positive semidefinite `W`: the minimum of `1/2 j . W j + b . j` over `j >= 0`.
//!
//! The method is that of Lawson and Hanson (*Solving Least Squares Problems*, 1974, chapter 23): impulses of a set are those that make their rates zero; what comes out negative
//! leaves the set at the first zero on the way, and what still approaches joins it. All that approach join at once, as the closed set of a step does, and one at a time as soon as that
//! lowers the minimum no more, which is certain to end. `W` is singular where more points touch than bodies have motions: the rates are unique, the impulses need not be.

/// Rates below this part of the largest one count as zero.
const ROUND_OFF: f64 = 1e-12;

/// Part of the mean of the diagonal that makes a singular block regular. What it takes of a rate is given back by a second solution with what is left.
const SHIFT: f64 = 1e-12;

/// Products of the iteration for an operator, after which it is taken as it is.
const MAX_PRODUCTS: usize = 400;

/// A symmetric, positive semidefinite matrix between slots.
pub(super) trait Compliance {
    /// Why a product failed.
    type Error;
    /// Number of slots.
    fn len(&self) -> usize;
    /// `W j`.
    fn multiply(&mut self, j: &[f64], out: &mut [f64]) -> Result<(), Self::Error>;
    /// Impulses of the slots in `of`, the others being zero, for which `(W z + b)` is zero there.
    fn stop(&mut self, of: &[usize], b: &[f64]) -> Result<Vec<f64>, Self::Error>;
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `W` with all entries, row by row.
#[derive(Debug, Default)]
pub(super) struct DenseCompliance {
    size: usize,
    entries: Vec<f64>,
}

impl DenseCompliance {
    /// The compliance from the columns, one after the other, of a matrix that is symmetric but for round-off.
    pub fn new(size: usize, columns: Vec<f64>) -> Self {
        let mut entries = columns;
        for i in 0..size {
            for k in 0..i {
                let mean = 0.5 * (entries[i * size + k] + entries[k * size + i]);
                (entries[i * size + k], entries[k * size + i]) = (mean, mean);
            }
        }
        Self { size, entries }
    }

    /// `W_ik`.
    pub fn entry(&self, i: usize, k: usize) -> f64 {
        self.entries[i * self.size + k]
    }

    /// Row `i` of `W j`.
    pub fn product(&self, i: usize, j: &[f64]) -> f64 {
        dot(self.row(i), j)
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.entries[i * self.size..(i + 1) * self.size]
    }

    /// The Cholesky factor of a block, made regular.
    fn factor(&self, of: &[usize]) -> Vec<f64> {
        let n = of.len();
        let mean = of.iter().map(|&i| self.row(i)[i]).sum::<f64>() / n.max(1) as f64;
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            for k in 0..=i {
                let mut sum = self.row(of[i])[of[k]] + if i == k { SHIFT * mean } else { 0.0 };
                for s in 0..k {
                    sum -= l[i * n + s] * l[k * n + s];
                }
                l[i * n + k] = if i == k { sum.max(0.01 * SHIFT * mean).sqrt() } else { sum / l[k * n + k] };
            }
        }
        l
    }
}

fn solve_with_factor(l: &[f64], x: &mut [f64]) {
    let n = x.len();
    for i in 0..n {
        for k in 0..i {
            x[i] -= l[i * n + k] * x[k];
        }
        x[i] /= l[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= l[k * n + i] * x[k];
        }
        x[i] /= l[i * n + i];
    }
}

impl Compliance for DenseCompliance {
    type Error = std::convert::Infallible;

    fn len(&self) -> usize {
        self.size
    }

    fn multiply(&mut self, j: &[f64], out: &mut [f64]) -> Result<(), Self::Error> {
        out.iter_mut().enumerate().for_each(|(i, out)| *out = dot(self.row(i), j));
        Ok(())
    }

    fn stop(&mut self, of: &[usize], b: &[f64]) -> Result<Vec<f64>, Self::Error> {
        let l = self.factor(of);
        let mut z: Vec<f64> = of.iter().map(|&i| -b[i]).collect();
        solve_with_factor(&l, &mut z);
        let mut rest: Vec<f64> =
            (of.iter()).map(|&i| -b[i] - of.iter().zip(&z).map(|(&k, z)| self.row(i)[k] * z).sum::<f64>()).collect();
        solve_with_factor(&l, &mut rest);
        z.iter_mut().zip(rest).for_each(|(z, rest)| *z += rest);
        Ok(z)
    }
}

/// `W` by its products alone, for many slots, with an estimate of its diagonal.
pub(super) struct OperatorCompliance<F> {
    product: F,
    diagonal: Vec<f64>,
}

impl<F> OperatorCompliance<F> {
    /// `product(j, out)` sets `out = W j`; the diagonal need only be of the right size.
    pub fn new(diagonal: Vec<f64>, product: F) -> Self {
        Self { product, diagonal }
    }
}

impl<E, F: FnMut(&[f64], &mut [f64]) -> Result<(), E>> Compliance for OperatorCompliance<F> {
    type Error = E;

    fn len(&self) -> usize {
        self.diagonal.len()
    }

    fn multiply(&mut self, j: &[f64], out: &mut [f64]) -> Result<(), E> {
        (self.product)(j, out)
    }

    /// Impulses by conjugate gradients with the diagonal as preconditioner.
    fn stop(&mut self, of: &[usize], b: &[f64]) -> Result<Vec<f64>, E> {
        let n = of.len();
        let (mut z, mut rest) = (vec![0.0; n], of.iter().map(|&i| -b[i]).collect::<Vec<f64>>());
        let mut direction = vec![0.0; n];
        let (mut all, mut image) = (vec![0.0; self.len()], vec![0.0; self.len()]);
        let scale = dot(&rest, &rest).sqrt();
        let mut previous = 1.0;
        for _ in 0..MAX_PRODUCTS.min(4 * n + 10) {
            if dot(&rest, &rest).sqrt() <= 0.1 * ROUND_OFF * scale {
                break;
            }
            let energy: f64 = of.iter().zip(&rest).map(|(&i, r)| r * r / self.diagonal[i]).sum();
            for (k, &i) in of.iter().enumerate() {
                direction[k] = rest[k] / self.diagonal[i] + energy / previous * direction[k];
                all[i] = direction[k];
            }
            previous = energy;
            (self.product)(&all, &mut image)?;
            let length = energy / of.iter().zip(&direction).map(|(&i, d)| d * image[i]).sum::<f64>();
            if !length.is_finite() || length <= 0.0 {
                break;
            }
            for (k, &i) in of.iter().enumerate() {
                z[k] += length * direction[k];
                rest[k] -= length * image[i];
            }
        }
        Ok(z)
    }
}

/// The impulses of the slots in `of`; those of the others are zero, and their rates are not asked for. `b` has the rates without impulses.
pub(super) fn complementary<W: Compliance>(w: &mut W, b: &[f64], of: &[usize]) -> Result<Vec<f64>, W::Error> {
    let m = w.len();
    let (mut j, mut rate) = (vec![0.0; m], b.to_vec());
    let scale = of.iter().map(|&i| b[i].abs()).fold(0.0, f64::max);
    let mut passive: Vec<usize> = Vec::new();
    let (mut least, mut one_by_one) = (0.0, false);
    for _ in 0..10 * m + 20 {
        let is_in = |passive: &[usize], i: usize| passive.contains(&i);
        let approaching = of.iter().copied().filter(|&i| rate[i] < -ROUND_OFF * scale && !is_in(&passive, i));
        if one_by_one {
            let Some(next) = approaching.min_by(|&a, &b| rate[a].total_cmp(&rate[b])) else { break };
            passive.push(next);
        } else {
            let before = passive.len();
            let joining: Vec<usize> = approaching.collect();
            passive.extend(joining);
            if passive.len() == before {
                break;
            }
        }
        while !passive.is_empty() {
            let z = w.stop(&passive, b)?;
            if z.iter().all(|&z| z > 0.0) {
                j.fill(0.0);
                passive.iter().zip(&z).for_each(|(&i, &z)| j[i] = z);
                break;
            }
            let falling = || passive.iter().zip(&z).filter(|(_, z)| **z <= 0.0);
            let way = |(&i, &z): (&usize, &f64)| if j[i] > 0.0 { j[i] / (j[i] - z) } else { 0.0 };
            let part = falling().map(way).fold(1.0, f64::min);
            let leaving: Vec<usize> = falling().filter(|&pair| way(pair) <= part).map(|(&i, _)| i).collect();
            passive.iter().zip(&z).for_each(|(&i, &z)| j[i] += part * (z - j[i]));
            leaving.iter().for_each(|&i| j[i] = 0.0);
            passive.retain(|i| !leaving.contains(i));
        }
        w.multiply(&j, &mut rate)?;
        let energy = 0.5 * dot(&rate, &j) + dot(b, &j);
        rate.iter_mut().zip(b).for_each(|(rate, b)| *rate += b);
        if energy >= least - 1e-14 * f64::abs(least) {
            if one_by_one {
                break;
            }
            one_by_one = true;
        }
        least = f64::min(least, energy);
    }
    Ok(j)
}
