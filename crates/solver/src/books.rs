//! The books of a step: what each thing that makes forces stores, dissipates and supplies, and what is left over.

use std::ops::Range;
use stoss_integrators::StepRule;
use stoss_term::MaterialWork;

/// Energy of a body, a part, a load or a coupling in a step. What its forces take from the motion, `W = f . (q_np1 - q_n)` with the internal forces `f` that the equations of the step
/// have of it, goes into what it stores, what it dissipates, less what it supplies; the rest is the remainder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Posting {
    /// Energy that is stored at the end of the step.
    pub stored: f64,
    /// Energy that was dissipated in the step.
    pub dissipated: f64,
    /// Energy that came from outside in the step: work of loads, supports, motors, belts.
    pub supplied: f64,
    /// `W - (change of stored + dissipated - supplied)`: what got lost in the step, or was made if it is negative. NaN where it is not measured: in statics, whose forces are those of the end of the step,
    /// and with schemes that carry forces of the last end point.
    pub remainder: f64,
    /// What of `stored` and `dissipated` a material with history has; zero of all but bodies.
    pub material: MaterialWork,
}

/// All postings of a step. The sum of all remainders is what the total energy and the loss of impacts lack together ([`crate::Balance::total`]), but for what the iterations leave of the equations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Books {
    /// Strain energy and damping, a body each.
    pub bodies: Vec<Posting>,
    /// A part each.
    pub parts: Vec<Posting>,
    /// A load each; also of one that has a potential the work is supplied.
    pub loads: Vec<Posting>,
    /// A coupling each, in the order of [`crate::Model::contacts`]. The remainder of a contact is what closing gaps cost.
    pub couplings: Vec<Posting>,
    /// Kinetic energy; the remainder is what the scheme loses.
    pub inertia: Posting,
    /// Supports that move.
    pub supports: Posting,
    /// Stabilisation of statics.
    pub stabilisation: Posting,
}

impl Posting {
    /// Adds a later step: what is stored then, and sums of the rest. A remainder that is not measured counts as none.
    fn add(&mut self, step: &Self) {
        self.stored = step.stored;
        self.dissipated += step.dissipated;
        self.supplied += step.supplied;
        let hardening = step.material.hardening;
        self.material += step.material;
        self.material.hardening = hardening;
        self.remainder += if step.remainder.is_nan() { 0.0 } else { step.remainder };
    }
}

impl Books {
    /// Adds the books of a later step: what is stored then, and sums of the rest. Remainders that are not measured count as none.
    pub fn add(&mut self, step: &Self) {
        let lists = [
            (&mut self.bodies, &step.bodies),
            (&mut self.parts, &step.parts),
            (&mut self.loads, &step.loads),
            (&mut self.couplings, &step.couplings),
        ];
        for (sums, list) in lists {
            sums.resize(list.len(), Posting::default());
            sums.iter_mut().zip(list).for_each(|(sum, posting)| sum.add(posting));
        }
        self.inertia.add(&step.inertia);
        self.supports.add(&step.supports);
        self.stabilisation.add(&step.stabilisation);
    }

    /// Every posting.
    pub fn iter(&self) -> impl Iterator<Item = &Posting> {
        let lists = [&self.bodies, &self.parts, &self.loads, &self.couplings];
        lists.into_iter().flatten().chain([&self.inertia, &self.supports, &self.stabilisation])
    }
}

/// Work of forces in the step that was evaluated last, before the weights of the scheme.
#[derive(Clone, Debug, Default)]
pub(crate) struct Works {
    /// Work of bodies, then of parts.
    pub forces: Vec<f64>,
    pub couplings: Vec<f64>,
}

impl Works {
    pub fn new(forces: usize, couplings: usize) -> Self {
        Self { forces: vec![0.0; forces], couplings: vec![0.0; couplings] }
    }
}

/// `r . (q_np1 - q_n)` of three rows a node.
pub(crate) fn work_at(nodes: &[u32], residual: &[f64], q_n: &[f64], q_np1: &[f64]) -> f64 {
    let mut work = 0.0;
    for (&node, r) in nodes.iter().zip(residual.chunks_exact(3)) {
        let first = 3 * node as usize;
        for (d, r) in r.iter().enumerate() {
            work += r * (q_np1[first + d] - q_n[first + d]);
        }
    }
    work
}

/// `f . (q_np1 - q_n)` of some components.
pub(crate) fn work_of(force: &[f64], components: Range<usize>, q_n: &[f64], q_np1: &[f64]) -> f64 {
    let moved = q_np1[components.clone()].iter().zip(&q_n[components.clone()]);
    force[components].iter().zip(moved).map(|(f, (end, start))| f * (end - start)).sum()
}

/// Whether the remainders of a step of this rule are measured: its forces must be those of one evaluation.
pub(crate) fn is_measured(rule: &StepRule) -> bool {
    rule.has_inertia() && rule.history.is_none() && rule.force.weight == 1.0 && rule.constraint.weight == 1.0
}
