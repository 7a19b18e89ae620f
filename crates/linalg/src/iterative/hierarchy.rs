//! Smoothed aggregation: levels made of each other, and the V cycle over them.

use super::aggregates::{Graph, NONE, aggregate};
use super::bsr::{Block, Bsr, product};
use super::inverse::inverse_diagonal;
use super::modes::{MODES, smoothed, tentative};
use super::real::Real;
use super::refusal::Refusal;
use super::smoother::{Smoother, largest_eigenvalue};
use crate::vector::norm_inf;
use crate::{LinearSolver, MatrixKind, MultifrontalSolver, SparsityPattern};
use std::sync::Arc;

/// Degree of Chebyshev's polynomial before and after the correction by the coarser level.
const DEGREE: usize = 3;

/// Degree of Chebyshev's polynomial without coarser levels.
const DEGREE_OF_ONE_LEVEL: usize = 4;

/// Damping of the step of Jacobi's method that smooths the prolongator, over the largest eigenvalue.
const PROLONGATOR_DAMPING: f64 = 4.0 / 3.0;

/// A level with at most so many equations is factorised.
const COARSEST: usize = 400;

/// A level that does not get coarser is factorised if it has no more equations than this.
const LARGEST_COARSEST: usize = 4000;

/// A level has at most one equation for so many of the finer one.
const COARSENING: usize = 4;

/// A matrix with its smoother, right-hand side and solution; all in a unit in which the matrix has entries around 1, so that single precision neither overflows nor vanishes.
#[derive(Debug)]
struct Smoothed<T, const B: usize> {
    a: Bsr<T, B, B>,
    smoother: Smoother<T, B>,
    b: Vec<T>,
    x: Vec<T>,
}

impl<T: Real, const B: usize> Smoothed<T, B> {
    fn new(a: Bsr<T, B, B>, inverse: Vec<Block<T, B, B>>, largest: f64, degree: usize) -> Self {
        let n = B * a.rows();
        let smoother = Smoother::new(&a, inverse, largest, degree);
        Self { a, smoother, b: vec![T::default(); n], x: vec![T::default(); n] }
    }

    /// Smooths the solution of this level, see [`Smoother::smooth`].
    fn smooth(&mut self, from_zero: bool, residual: Option<&mut [T]>) {
        self.smoother.smooth(&self.a, &self.b, &mut self.x, from_zero, residual);
    }

    fn memory_bytes(&self) -> usize {
        self.a.memory_bytes() + self.smoother.memory_bytes() + 2 * size_of::<T>() * self.x.capacity()
    }
}

/// A power of two near the largest diagonal entry, 1 if all vanish.
fn unit_of<const B: usize>(a: &Bsr<f64, B, B>) -> f64 {
    let of_row =
        |i: usize| a.position(i, i).map_or(0.0, |at| (0..B).map(|d| a.blocks[at][d][d].abs()).fold(0.0, f64::max));
    let largest = (0..a.rows()).map(of_row).fold(0.0, f64::max);
    if largest > 0.0 && largest.is_finite() { largest.log2().round().exp2() } else { 1.0 }
}

/// Inverse blocks of a matrix, of this matrix divided by `unit`.
fn rounded<T: Real, const B: usize>(inverse: &[Block<f64, B, B>], unit: f64) -> Vec<Block<T, B, B>> {
    inverse.iter().map(|block| block.map(|row| row.map(|v| T::rounded(unit * v)))).collect()
}

/// The preconditioner of a level alone; for matrices that mass dominates.
#[derive(Debug)]
pub(crate) struct OneLevel<T> {
    level: Smoothed<T, 3>,
    unit: f64,
}

impl<T: Real> OneLevel<T> {
    pub fn new(a: &Bsr<f64, 3, 3>) -> Self {
        let unit = unit_of(a);
        let (a, inverse) = (a.rounded(1.0 / unit), rounded(&inverse_diagonal(a), unit));
        let largest = largest_eigenvalue(&a, &inverse);
        Self { level: Smoothed::new(a, inverse, largest, DEGREE_OF_ONE_LEVEL), unit }
    }

    /// `z = M r`.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        between_precisions(&mut self.level, self.unit, r, z, |level| level.smooth(true, None));
    }

    pub fn memory_bytes(&self) -> usize {
        self.level.memory_bytes()
    }
}

/// Brings `r` to the size 1 and to the precision of the level, and the solution back.
fn between_precisions<L, T: Real>(level: &mut L, unit: f64, r: &[f64], z: &mut [f64], run: impl FnOnce(&mut L))
where
    L: AsMut<Smoothed<T, 3>>,
{
    let size = norm_inf(r);
    if size == 0.0 {
        z.fill(0.0);
        return;
    }
    let scale = 1.0 / size;
    level.as_mut().b.iter_mut().zip(r).for_each(|(b, r)| *b = T::rounded(r * scale));
    run(level);
    let back = size / unit;
    z.iter_mut().zip(&level.as_mut().x).for_each(|(z, x)| *z = x.wide() * back);
}

impl<T> AsMut<Self> for Smoothed<T, 3> {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

impl<T> AsMut<Smoothed<T, 3>> for Hierarchy<T> {
    fn as_mut(&mut self) -> &mut Smoothed<T, 3> {
        &mut self.fine.own
    }
}

/// A level with the way to the next one.
#[derive(Debug)]
struct Level<T, const B: usize> {
    own: Smoothed<T, B>,
    prolongation: Bsr<T, B, MODES>,
    restriction: Bsr<T, MODES, B>,
    r: Vec<T>,
}

/// What the next level is made of.
struct Coarse {
    a: Bsr<f64, MODES, MODES>,
    modes: Vec<Block<f64, MODES, MODES>>,
    labels: Vec<u32>,
}

impl<T: Real, const B: usize> Level<T, B> {
    /// `None` if the next level would not be much coarser.
    fn new(a: &Bsr<f64, B, B>, modes: &[Block<f64, B, MODES>], labels: &[u32], unit: f64) -> Option<(Self, Coarse)> {
        let skip: Vec<bool> = modes.iter().map(|m| m.as_flattened().iter().all(|v| *v == 0.0)).collect();
        let (of, count) = aggregate(&Graph::within(a, labels), &skip);
        if count == 0 || COARSENING * MODES * count > B * a.rows() {
            return None;
        }
        let inverse = inverse_diagonal(a);
        let own_inverse = rounded(&inverse, unit);
        // The rounded matrix is made again: the products below need much memory.
        let largest = largest_eigenvalue(&a.rounded(1.0 / unit), &own_inverse);
        let (p0, modes) = tentative(modes, &of, count);
        let p = smoothed(a, &inverse, &p0, PROLONGATOR_DAMPING / largest);
        drop(p0);
        let transposed = p.transposed();
        let mut coarse = product(&transposed, &product(a, &p));
        fill_empty_diagonal(&mut coarse);
        let mut coarse_labels = vec![0; count];
        for (&aggregate, &label) in of.iter().zip(labels).filter(|(aggregate, _)| **aggregate != NONE) {
            coarse_labels[aggregate as usize] = label;
        }
        let level = Self {
            own: Smoothed::new(a.rounded(1.0 / unit), own_inverse, largest, DEGREE),
            prolongation: p.rounded(1.0),
            restriction: transposed.rounded(1.0),
            r: vec![T::default(); B * a.rows()],
        };
        Some((level, Coarse { a: coarse, modes, labels: coarse_labels }))
    }

    /// Smooths from zero and restricts the residual.
    fn descend(&mut self, coarser: &mut [T]) {
        self.own.smooth(true, Some(&mut self.r));
        self.restriction.multiply(&self.r, coarser);
    }

    /// Adds the correction and smooths.
    fn ascend(&mut self, coarser: &[T]) {
        self.prolongation.add_product(coarser, &mut self.own.x);
        self.own.smooth(false, None);
    }

    fn memory_bytes(&self) -> usize {
        self.own.memory_bytes()
            + self.prolongation.memory_bytes()
            + self.restriction.memory_bytes()
            + size_of::<T>() * self.r.capacity()
    }
}

/// Gives the columns of modes that an aggregate does not have a diagonal entry of the size of the others.
fn fill_empty_diagonal(a: &mut Bsr<f64, MODES, MODES>) {
    for i in 0..a.rows() {
        let Some(at) = a.position(i, i) else { continue };
        let block = &mut a.blocks[at];
        let largest = (0..MODES).map(|d| block[d][d].abs()).fold(0.0, f64::max);
        for d in (0..MODES).filter(|&d| block[d] == [0.0; MODES] || block[d][d] == 0.0).collect::<Vec<_>>() {
            block[d][d] = if largest > 0.0 { largest } else { 1.0 };
        }
    }
}

/// The hierarchy. Set-up is in `f64`, the cycle in `T`.
#[derive(Debug)]
pub(crate) struct Hierarchy<T> {
    fine: Level<T, 3>,
    coarser: Vec<Level<T, MODES>>,
    direct: MultifrontalSolver,
    coarsest: Vec<f64>,
    rounded: Vec<T>,
    unit: f64,
    is_indefinite: bool,
}

impl<T: Real> Hierarchy<T> {
    /// The hierarchy of a matrix (`kind`: whether it is symmetric), its rigid modes, and the body of each node.
    ///
    /// # Errors
    /// [`Refusal::NoCoarsening`], [`Refusal::Coarsest`].
    pub fn new(
        a: &Bsr<f64, 3, 3>,
        modes: &[Block<f64, 3, MODES>],
        labels: &[u32],
        kind: MatrixKind,
    ) -> Result<Self, Refusal> {
        let unit = unit_of(a);
        let Some((fine, mut next)) = Level::new(a, modes, labels, unit) else {
            return Err(Refusal::NoCoarsening { equations: 3 * a.rows() });
        };
        let mut coarser = Vec::new();
        loop {
            let n = MODES * next.a.rows();
            if n <= COARSEST {
                break;
            }
            match Level::new(&next.a, &next.modes, &next.labels, unit) {
                Some((level, coarse)) => {
                    coarser.push(level);
                    next = coarse;
                }
                None if n <= LARGEST_COARSEST => break,
                None => return Err(Refusal::NoCoarsening { equations: n }),
            }
        }
        let mut direct = MultifrontalSolver::new();
        factorise(&mut direct, &next.a, kind).map_err(|error| Refusal::Coarsest(error.to_string()))?;
        let is_indefinite = kind != MatrixKind::General && direct.negative_eigenvalues().is_some_and(|count| count > 0);
        let n = MODES * next.a.rows();
        let (coarsest, rounded) = (vec![0.0; n], vec![T::default(); n]);
        Ok(Self { fine, coarser, direct, coarsest, rounded, unit, is_indefinite })
    }

    /// Whether the matrix of the coarsest level, a restriction of the whole symmetric one to some of its motions, has a negative eigenvalue: then the whole one has.
    pub fn is_indefinite(&self) -> bool {
        self.is_indefinite
    }

    /// The prolongation of the finest level, and entries of the matrices of all levels but the coarsest over those of the finest.
    #[cfg(test)]
    pub fn prolongation_and_complexity(&self) -> (&Bsr<T, 3, MODES>, f64) {
        let coarser: usize = self.coarser.iter().map(|level| 36 * level.own.a.blocks.len()).sum();
        (&self.fine.prolongation, 1.0 + coarser as f64 / (9 * self.fine.own.a.blocks.len()) as f64)
    }

    /// `z = M r`: one V cycle.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let unit = self.unit;
        between_precisions(self, unit, r, z, Self::cycle);
    }

    fn cycle(&mut self) {
        let Self { fine, coarser, direct, coarsest, rounded, unit, .. } = self;
        match coarser.first_mut() {
            Some(next) => fine.descend(&mut next.own.b),
            None => fine.descend(rounded),
        }
        for k in 0..coarser.len() {
            let (level, rest) = coarser[k..].split_at_mut(1);
            match rest.first_mut() {
                Some(next) => level[0].descend(&mut next.own.b),
                None => level[0].descend(rounded),
            }
        }
        coarsest.iter_mut().zip(&*rounded).for_each(|(c, r)| *c = r.wide());
        direct.substitute(coarsest);
        rounded.iter_mut().zip(&*coarsest).for_each(|(r, c)| *r = T::rounded(c * *unit));
        for k in (0..coarser.len()).rev() {
            let (level, rest) = coarser[k..].split_at_mut(1);
            match rest.first() {
                Some(next) => level[0].ascend(&next.own.x),
                None => level[0].ascend(rounded),
            }
        }
        match coarser.first() {
            Some(next) => fine.ascend(&next.own.x),
            None => fine.ascend(rounded),
        }
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.fine.memory_bytes()
            + self.coarser.iter().map(Level::memory_bytes).sum::<usize>()
            + self.direct.memory_bytes()
            + size_of::<f64>() * self.coarsest.capacity()
            + size_of::<T>() * self.rounded.capacity()
    }
}

/// Factorises the matrix of the coarsest level. A motion that nothing holds shows here: rigid modes are in the range of the prolongation.
fn factorise(
    direct: &mut MultifrontalSolver,
    a: &Bsr<f64, MODES, MODES>,
    kind: MatrixKind,
) -> Result<(), crate::LinalgError> {
    let equations = |i: usize| (0..MODES).map(move |d| (MODES * i + d) as u32);
    let stencils: Vec<Vec<u32>> = (0..a.rows())
        .flat_map(|i| {
            a.row(i).filter(move |&(j, _)| j <= i).map(move |(j, _)| equations(i).chain(equations(j)).collect())
        })
        .collect();
    let n = MODES * a.rows();
    let pattern = SparsityPattern::from_stencils(n, stencils.iter().map(Vec::as_slice))?;
    let pattern = Arc::new(pattern.with_groups((0..n).map(|k| (k / MODES) as u32).collect())?);
    // The rows of the transpose are the columns.
    let columns = a.transposed();
    let mut values = Vec::with_capacity(pattern.nnz());
    for j in 0..columns.rows() {
        for c in 0..MODES {
            values.extend(columns.row(j).flat_map(|(_, block)| block[c]));
        }
    }
    direct.analyse(&pattern, kind)?;
    direct.factorise(&values)
}
