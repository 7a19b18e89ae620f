//! The loop over the elements of a block: threads, order of addition, buffers. Not what is added.
//!
//! With one thread each element is computed and added at once. With more, a run of elements is computed into buffers
//! while the previous run is added by one thread. Either way the additions happen in element order, so the sums have
//! the same bits for any number of threads.

use crate::{
    element::Failure,
    kernel::{self, LocalTangent, NodalVectors, TangentFactors},
    scratch::Scratch,
};
use rayon::prelude::*;
use std::ops::Range;
use stoss_linalg::ScatterMap;

/// Portions of a run, for each thread.
const PORTIONS: usize = 4;

/// Elements of `n` nodes that a thread takes at once.
const fn grain(n: usize) -> usize {
    if n <= 10 { 8 } else { 2 }
}

/// Where a tangent goes: the global values, through a scatter map.
#[derive(Debug)]
pub struct TangentTarget<'a> {
    /// Positions of the local entries: a square of `3 n` rows for an element of `n` nodes, row-major.
    pub map: &'a ScatterMap,
    /// Stencil of this body's element 0; the others follow in order.
    pub first_stencil: usize,
    /// Scales what is added.
    pub factor: f64,
    /// Values of the global matrix.
    pub values: &'a mut [f64],
}

/// Buffers of [`crate::SolidBody::assemble`]. One for each body or one for all; empty at first.
#[derive(Debug, Default)]
pub struct Workspace {
    computing: Vec<Portion>,
    adding: Vec<Portion>,
    pub(crate) nodal: Scratch,
}

impl Workspace {
    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let portions = self.computing.iter().chain(&self.adding);
        (self.computing.capacity() + self.adding.capacity()) * size_of::<Portion>()
            + portions.map(Portion::memory_bytes).sum::<usize>()
            + self.nodal.memory_bytes()
    }
}

/// What a thread computes at once: the forces and tangents of a few elements, and room for the factors of a tangent. Lists of numbers, because
/// elements of different kinds use it one after the other.
#[derive(Debug, Default)]
struct Portion {
    forces: Vec<f64>,
    tangents: Vec<f64>,
    factors: Vec<f64>,
    failures: Vec<Option<Failure>>,
}

/// A portion for elements of one kind. Without tangents the last two are empty.
struct View<'a, const N: usize, const G: usize> {
    forces: &'a mut [NodalVectors<N>],
    failures: &'a mut [Option<Failure>],
    tangents: &'a mut [LocalTangent<N>],
    factors: &'a mut [TangentFactors<N, G>],
}

impl Portion {
    fn memory_bytes(&self) -> usize {
        (self.forces.capacity() + self.tangents.capacity() + self.factors.capacity()) * size_of::<f64>()
            + self.failures.capacity() * size_of::<Option<Failure>>()
    }

    /// Room for elements of a kind; nothing is lost, and nothing is allocated if there is room.
    fn reserve<const N: usize, const G: usize>(&mut self, elements: usize, with_tangent: bool) {
        let grow = |list: &mut Vec<f64>, length: usize| {
            if list.len() < length {
                list.resize(length, 0.0);
            }
        };
        grow(&mut self.forces, elements * 3 * N);
        if self.failures.len() < elements {
            self.failures.resize(elements, None);
        }
        if with_tangent {
            grow(&mut self.tangents, elements * 9 * N * N);
            grow(&mut self.factors, 27 * G * N);
        }
    }

    fn view<const N: usize, const G: usize>(&mut self) -> View<'_, N, G> {
        View {
            forces: self.forces.as_chunks_mut().0.as_chunks_mut().0,
            failures: &mut self.failures,
            tangents: self.tangents.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0,
            factors: self.factors.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0,
        }
    }
}

/// Computes one element's force and, with `Some`, tangent (both overwritten).
pub(crate) trait ElementEvaluator<const N: usize, const G: usize>: Sync {
    fn evaluate(
        &self,
        element: usize,
        force: &mut NodalVectors<N>,
        tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    ) -> Result<(), Failure>;
}

/// The elements of a block and where they go.
pub(crate) struct AssemblyTarget<'a, 'b> {
    /// Number of the block's first element in the body.
    pub first: usize,
    /// The iterate before, see [`crate::SolidBody::assemble_after`].
    pub before: Option<&'a [f64]>,
    pub force_weight: f64,
    pub force: &'a mut [f64],
    pub target: &'a mut Option<TangentTarget<'b>>,
    pub workspace: &'a mut Workspace,
}

/// Adds one element to the global arrays.
fn add<const N: usize>(
    nodes: &[u32; N],
    element: usize,
    local: (&NodalVectors<N>, Option<&LocalTangent<N>>),
    force_weight: f64,
    force: &mut [f64],
    target: &mut Option<TangentTarget<'_>>,
) {
    for (node, &global) in nodes.iter().enumerate() {
        let at = 3 * global as usize;
        let out = &mut force[at..at + 3];
        for i in 0..3 {
            out[i] += force_weight * local.0[i][node];
        }
    }
    if let (Some(target), Some(tangent)) = (target, local.1) {
        target.map.add(target.first_stencil + element, kernel::flat(tangent), target.values);
    }
}

/// Evaluates and adds all elements of a block. On failure returns the first failing element in element order; the global arrays
/// then hold a partial sum.
pub(crate) fn assemble<const N: usize, const G: usize>(
    nodes: &[[u32; N]],
    evaluator: &impl ElementEvaluator<N, G>,
    to: AssemblyTarget<'_, '_>,
) -> Result<(), (usize, Failure)> {
    let AssemblyTarget {
        first: number,
        before: _,
        force_weight,
        force,
        target,
        workspace: Workspace { computing, adding, .. },
    } = to;
    let threads = rayon::current_num_threads();
    let (grain, want_tangent) = (grain(N), target.is_some());
    if threads == 1 || nodes.len() <= grain {
        if computing.is_empty() {
            computing.push(Portion::default());
        }
        computing[0].reserve::<N, G>(1, want_tangent);
        let View { forces, tangents, factors, .. } = computing[0].view::<N, G>();
        let local_force = &mut forces[0];
        for (element, nodes) in nodes.iter().enumerate() {
            let wanted = if want_tangent { Some((&mut tangents[0], &mut factors[0])) } else { None };
            evaluator.evaluate(element, local_force, wanted).map_err(|failure| (element, failure))?;
            let local = (&*local_force, tangents.first());
            add(nodes, number + element, local, force_weight, force, target);
        }
        return Ok(());
    }

    let portions = (PORTIONS * threads).min(nodes.len().div_ceil(grain));
    for buffers in [&mut *computing, &mut *adding] {
        if buffers.len() < portions {
            buffers.resize_with(portions, Portion::default);
        }
        buffers.iter_mut().for_each(|portion| portion.reserve::<N, G>(grain, want_tangent));
    }
    let compute = |elements: Range<usize>, buffers: &mut [Portion]| {
        buffers.par_iter_mut().enumerate().for_each(|(k, portion)| {
            let View { forces, failures, tangents, factors } = portion.view::<N, G>();
            let from = elements.start + grain * k;
            for (k, element) in (from..(from + grain).min(elements.end)).enumerate() {
                let wanted = if want_tangent { Some((&mut tangents[k], &mut factors[0])) } else { None };
                failures[k] = evaluator.evaluate(element, &mut forces[k], wanted).err();
            }
        });
    };
    let mut add_run = |elements: Range<usize>, buffers: &mut [Portion]| {
        for (k, portion) in buffers.iter_mut().enumerate() {
            let View { forces, failures, tangents, .. } = portion.view::<N, G>();
            let from = elements.start + grain * k;
            for (k, element) in (from..(from + grain).min(elements.end)).enumerate() {
                if let Some(failure) = failures[k] {
                    return Err((element, failure));
                }
                add(&nodes[element], number + element, (&forces[k], tangents.get(k)), force_weight, force, target);
            }
        }
        Ok(())
    };
    // Elements whose results are in `adding`.
    let mut previous = 0..0;
    for first in (0..nodes.len()).step_by(portions * grain) {
        let current = first..(first + portions * grain).min(nodes.len());
        let ((), added) = rayon::join(
            || compute(current.clone(), &mut computing[..current.len().div_ceil(grain)]),
            || add_run(previous.clone(), &mut adding[..previous.len().div_ceil(grain)]),
        );
        added?;
        std::mem::swap(computing, adding);
        previous = current;
    }
    add_run(previous.clone(), &mut adding[..previous.len().div_ceil(grain)])
}
