//! The loop over the elements of a body: threads, order of addition, buffers. Not what is added.
//!
//! With one thread each element is computed and added at once. With more, a run of elements is computed into buffers
//! while the previous run is added by one thread. Either way the additions happen in element order, so the sums have
//! the same bits for any number of threads.

use crate::{
    element::Failure,
    kernel::{LocalTangent, NODES, NodalVectors, TangentFactors, UNKNOWNS},
};
use rayon::prelude::*;
use std::ops::Range;
use stoss_linalg::ScatterMap;

/// Elements of a run, for each thread.
const RUN: usize = 32;
/// Elements that a thread takes at once.
const GRAIN: usize = 8;

/// Where a tangent goes: the global values, through a scatter map.
#[derive(Debug)]
pub struct TangentTarget<'a> {
    /// Positions of the local entries; 24 x 24 for each element, row-major.
    pub map: &'a ScatterMap,
    /// Stencil of this body's element 0; the others follow in order.
    pub first_stencil: usize,
    /// Scales what is added.
    pub factor: f64,
    /// Values of the global matrix.
    pub values: &'a mut [f64],
}

/// Buffers of [`crate::SolidBody::assemble`]. One for each body or one for all; empty until more than one thread is used.
#[derive(Debug, Default)]
pub struct Workspace {
    computing: Vec<ElementBuffer>,
    adding: Vec<ElementBuffer>,
}

impl Workspace {
    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        (self.computing.capacity() + self.adding.capacity()) * size_of::<ElementBuffer>()
    }
}

#[derive(Clone, Debug)]
struct ElementBuffer {
    force: NodalVectors,
    tangent: LocalTangent,
    failure: Option<Failure>,
}

const EMPTY_FORCE: NodalVectors = [[0.0; NODES]; 3];
const EMPTY_TANGENT: LocalTangent = [0.0; UNKNOWNS * UNKNOWNS];
const EMPTY_FACTORS: TangentFactors = [[[0.0; NODES]; 3 * crate::kernel::GAUSS_POINTS]; 9];

/// Computes one element's force and, with `Some`, tangent (both overwritten).
pub(crate) trait ElementEvaluator: Sync {
    fn evaluate(
        &self,
        element: usize,
        force: &mut NodalVectors,
        tangent: Option<(&mut LocalTangent, &mut TangentFactors)>,
    ) -> Result<(), Failure>;
}

/// Adds one element to the global arrays.
fn add(
    nodes: &[u32; NODES],
    element: usize,
    local: (&NodalVectors, &LocalTangent),
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
    if let Some(target) = target {
        target.map.add(target.first_stencil + element, local.1, target.values);
    }
}

/// Evaluates and adds all elements. On failure returns the first failing element in element order; the global arrays
/// then hold a partial sum.
pub(crate) fn assemble(
    connectivity: &[[u32; NODES]],
    evaluator: &impl ElementEvaluator,
    force_weight: f64,
    force: &mut [f64],
    mut target: Option<TangentTarget<'_>>,
    workspace: &mut Workspace,
) -> Result<(), (usize, Failure)> {
    let threads = rayon::current_num_threads();
    if threads == 1 || connectivity.len() <= GRAIN {
        let (mut local_force, mut tangent, mut factors) = (EMPTY_FORCE, EMPTY_TANGENT, EMPTY_FACTORS);
        for (element, nodes) in connectivity.iter().enumerate() {
            let wanted = target.is_some().then_some((&mut tangent, &mut factors));
            evaluator.evaluate(element, &mut local_force, wanted).map_err(|failure| (element, failure))?;
            add(nodes, element, (&local_force, &tangent), force_weight, force, &mut target);
        }
        return Ok(());
    }

    let run = (RUN * threads).min(connectivity.len());
    let Workspace { computing, adding } = workspace;
    for buffers in [&mut *computing, &mut *adding] {
        if buffers.len() < run {
            buffers.resize(run, ElementBuffer { force: EMPTY_FORCE, tangent: EMPTY_TANGENT, failure: None });
        }
    }
    let want_tangent = target.is_some();
    let compute = |first: usize, buffers: &mut [ElementBuffer]| {
        buffers.par_chunks_mut(GRAIN).enumerate().for_each(|(chunk, buffers)| {
            let mut factors = EMPTY_FACTORS;
            for (k, buffer) in buffers.iter_mut().enumerate() {
                let wanted = want_tangent.then_some((&mut buffer.tangent, &mut factors));
                let result = evaluator.evaluate(first + GRAIN * chunk + k, &mut buffer.force, wanted);
                buffer.failure = result.err();
            }
        });
    };
    let mut add_run = |elements: Range<usize>, buffers: &[ElementBuffer]| {
        for (element, buffer) in elements.zip(buffers) {
            if let Some(failure) = buffer.failure {
                return Err((element, failure));
            }
            let local = (&buffer.force, &buffer.tangent);
            add(&connectivity[element], element, local, force_weight, force, &mut target);
        }
        Ok(())
    };
    // Elements whose results are in `adding`.
    let mut previous = 0..0;
    for first in (0..connectivity.len()).step_by(run) {
        let current = first..(first + run).min(connectivity.len());
        let ((), added) = rayon::join(
            || compute(current.start, &mut computing[..current.len()]),
            || add_run(previous.clone(), adding),
        );
        added?;
        std::mem::swap(computing, adding);
        previous = current;
    }
    add_run(previous, adding)
}
