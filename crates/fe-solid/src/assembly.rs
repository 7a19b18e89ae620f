//! The loop over the elements of a block: threads, order, buffers. Not what becomes of their contributions.
//!
//! With one thread each element is computed and handed out at once. With more, a run of elements is computed into buffers
//! while the previous run is handed out by one thread. Either way that happens in element order, so sums have
//! the same bits for any number of threads.

use crate::{
    element::Failure,
    kernel::{LocalTangent, NodalVectors, PointBuffers, TangentFactors},
    scratch::Scratch,
};
use rayon::prelude::*;
use std::ops::Range;
use stoss_linalg::ScatterMap;
use stoss_term::Local;

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

/// Takes the contribution of a stencil of the body.
pub(crate) type Visit<'a> = dyn FnMut(usize, &Local) + Send + 'a;

/// What adds contributions to the arrays of a caller, `weight` times to the force.
pub(crate) fn adder<'a>(
    weight: f64,
    force: &'a mut [f64],
    mut target: Option<TangentTarget<'a>>,
) -> impl FnMut(usize, &Local) + Send + 'a {
    move |stencil, local| {
        for (&node, r) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
            let at = 3 * node as usize;
            force[at..at + 3].iter_mut().zip(r).for_each(|(force, r)| *force += weight * r);
        }
        if let Some(target) = &mut target {
            target.map.add(target.first_stencil + stencil, &local.tangent, target.values);
        }
    }
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

/// What a thread computes at once: a few elements, and room for the factors of a tangent, a list of numbers because
/// elements of different kinds use it one after the other.
#[derive(Debug, Default)]
struct Portion {
    locals: Vec<Local>,
    failures: Vec<Option<Failure>>,
    factors: Vec<f64>,
    buffers: PointBuffers,
}

impl Portion {
    fn memory_bytes(&self) -> usize {
        let floats = |local: &Local| local.residual.capacity() + local.tangent.capacity();
        let floats = self.factors.capacity() + self.locals.iter().map(floats).sum::<usize>();
        floats * size_of::<f64>()
            + self.locals.capacity() * size_of::<Local>()
            + self.failures.capacity() * size_of::<Option<Failure>>()
    }

    /// Room for elements of a kind; nothing is allocated if there is room.
    fn reserve<const N: usize, const G: usize>(&mut self, elements: usize, with_tangent: bool) {
        if self.locals.len() < elements {
            self.locals.resize_with(elements, Local::default);
            self.failures.resize(elements, None);
        }
        let factors = if with_tangent { 27 * G * N } else { 0 };
        if self.factors.len() < factors {
            self.factors.resize(factors, 0.0);
        }
    }
}

/// An element as a contribution, with a tangent if `tangent` has its factor; none is computed where that is zero.
fn evaluate<const N: usize, const G: usize>(
    evaluator: &impl ElementEvaluator<N, G>,
    (element, nodes): (usize, &[u32; N]),
    tangent: Option<f64>,
    local: &mut Local,
    factors: &mut [f64],
    buffers: &mut PointBuffers,
) -> Result<(), Failure> {
    local.nodes.clear();
    local.nodes.extend_from_slice(nodes);
    local.residual.resize(3 * N, 0.0);
    let mut force = [[0.0; N]; 3];
    let wanted = match tangent {
        None => None,
        Some(factor) => {
            local.tangent.resize(9 * N * N, 0.0);
            if factor == 0.0 {
                local.tangent.fill(0.0);
                None
            } else {
                let tangent = local.tangent.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0;
                let factors = factors.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0;
                Some((&mut tangent[0], &mut factors[0]))
            }
        }
    };
    evaluator.evaluate(element, &mut force, wanted, buffers)?;
    for (node, r) in local.residual.chunks_exact_mut(3).enumerate() {
        (r[0], r[1], r[2]) = (force[0][node], force[1][node], force[2][node]);
    }
    Ok(())
}

/// Computes one element's force and, with `Some`, tangent (both overwritten).
pub(crate) trait ElementEvaluator<const N: usize, const G: usize>: Sync {
    fn evaluate(
        &self,
        element: usize,
        force: &mut NodalVectors<N>,
        tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
        buffers: &mut PointBuffers,
    ) -> Result<(), Failure>;
}

/// How the elements of a block are evaluated, and where they go.
pub(crate) struct AssemblyTarget<'a, 'b> {
    /// Number of the block's first stencil in the body.
    pub first: usize,
    /// The iterate before, see [`crate::SolidBody::assemble_after`].
    pub before: Option<&'a [f64]>,
    /// Factor of the tangent, if it is wanted.
    pub tangent: Option<f64>,
    pub visit: &'a mut Visit<'b>,
    pub workspace: &'a mut Workspace,
}

/// Evaluates all elements of a block and hands them out in their order. On failure returns the first failing element in this order.
pub(crate) fn assemble<const N: usize, const G: usize>(
    nodes: &[[u32; N]],
    evaluator: &impl ElementEvaluator<N, G>,
    to: AssemblyTarget<'_, '_>,
) -> Result<(), (usize, Failure)> {
    let AssemblyTarget { first: number, before: _, tangent, visit, workspace: Workspace { computing, adding, .. } } =
        to;
    let threads = rayon::current_num_threads();
    let grain = grain(N);
    if threads == 1 || nodes.len() <= grain {
        if computing.is_empty() {
            computing.push(Portion::default());
        }
        computing[0].reserve::<N, G>(1, tangent.is_some());
        let Portion { locals, factors, buffers, .. } = &mut computing[0];
        let local = &mut locals[0];
        for (element, nodes) in nodes.iter().enumerate() {
            let done = evaluate(evaluator, (element, nodes), tangent, local, factors, buffers);
            done.map_err(|failure| (element, failure))?;
            visit(number + element, local);
        }
        return Ok(());
    }

    let portions = (PORTIONS * threads).min(nodes.len().div_ceil(grain));
    for buffers in [&mut *computing, &mut *adding] {
        if buffers.len() < portions {
            buffers.resize_with(portions, Portion::default);
        }
        buffers.iter_mut().for_each(|portion| portion.reserve::<N, G>(grain, tangent.is_some()));
    }
    let compute = |elements: Range<usize>, buffers: &mut [Portion]| {
        buffers.par_iter_mut().enumerate().for_each(|(k, Portion { locals, failures, factors, buffers })| {
            let from = elements.start + grain * k;
            for (k, element) in (from..(from + grain).min(elements.end)).enumerate() {
                let (numbered, local) = ((element, &nodes[element]), &mut locals[k]);
                failures[k] = evaluate(evaluator, numbered, tangent, local, factors, buffers).err();
            }
        });
    };
    let mut hand_out = |elements: Range<usize>, buffers: &mut [Portion]| {
        for (k, Portion { locals, failures, .. }) in buffers.iter_mut().enumerate() {
            let from = elements.start + grain * k;
            for (k, element) in (from..(from + grain).min(elements.end)).enumerate() {
                if let Some(failure) = failures[k] {
                    return Err((element, failure));
                }
                visit(number + element, &locals[k]);
            }
        }
        Ok(())
    };
    // Elements whose results are in `adding`.
    let mut previous = 0..0;
    for first in (0..nodes.len()).step_by(portions * grain) {
        let current = first..(first + portions * grain).min(nodes.len());
        let ((), handed) = rayon::join(
            || compute(current.clone(), &mut computing[..current.len().div_ceil(grain)]),
            || hand_out(previous.clone(), &mut adding[..previous.len().div_ceil(grain)]),
        );
        handed?;
        std::mem::swap(computing, adding);
        previous = current;
    }
    hand_out(previous.clone(), &mut adding[..previous.len().div_ceil(grain)])
}
