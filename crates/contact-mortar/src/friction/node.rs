//! Friction of one slot: traction, force, tangent.
//!
//! The traction of a node has two components in an orthonormal frame of its tangent plane. The normal is the mean of those of all its facets, on both
//! sides of a sharp edge; the tangents turn with the slave's material (`frames`). Components are the history: the traction turns with the material.

use super::frames::{Coordinates, MaterialFrames};
use super::slip::{Facet, SlipMeasure, normal_part, tangents};
use crate::slot::{GapWeights, Slot};
use crate::surfaces::diagonals;
use nalgebra::Vector3;
use stoss_contact::dual::{Dual, Scalar, V3, dot};
use stoss_contact::friction::{Friction, FrictionPoint, FrictionStep};
use stoss_contact::position;
use stoss_term::{GradientRule, Local, StepConfiguration};

/// Arguments of a facet, in components.
const FACET: usize = 12;

/// Scratch of an evaluation; one entry a facet.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    arguments: Vec<Facet<f64>>,
    start: Vec<[V3<f64>; 3]>,
    /// Coordinates of the diagonals.
    material: Vec<Coordinates>,
    /// Derivatives of the arguments with respect to the positions at the end, facet by facet, row-major.
    motion: Vec<f64>,
    /// Derivative of the traction.
    traction: Vec<f64>,
    product: Vec<f64>,
}

/// What the friction of a node depends on beside positions.
pub(crate) struct NodeFriction<'a> {
    pub friction: &'a Friction,
    pub measure: SlipMeasure,
    /// What the frame of the node follows.
    pub frames: &'a MaterialFrames,
    /// Local number of the node.
    pub local: usize,
    /// The slot as it was at the start of the step.
    pub start: &'a Slot,
    /// Covered area that slips are divided by where integrals do not follow the end: constant in the step, as the energy of springs wants it.
    pub area: f64,
    /// Components of the traction there.
    pub history: [f64; 2],
    /// What the multipliers of [`stoss_contact::friction::Stick::Multiplier`] add to it.
    pub multiplier: [f64; 2],
    /// Compliance of the stick, in multiples of one over the stiffness.
    pub compliance: f64,
    /// Area of the node, for the rows of the multipliers.
    pub weight: f64,
    pub slid: f64,
    pub step_size: f64,
    pub pressure: f64,
    /// Linearised as if the node stuck.
    pub reversed: bool,
    /// [`crate::rows::Row::across`]: with the facets behind the planes neither normal nor slip has these components.
    pub across: [bool; 3],
}

/// What became of a node in the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrictionState {
    pub step: FrictionStep,
    /// Slip in the frame of the node, a length.
    pub slip: [f64; 2],
    /// Way of the master's surface beside its mesh, in the same frame.
    pub way: [f64; 2],
    /// `(history - traction) / stiffness`, a length: zero where a multiplier has converged.
    mismatch: [f64; 2],
    /// Traction in the equations.
    traction: V3<f64>,
    /// Which the equations are linearised on if it is not `step`, and what that adds to the traction.
    branch: Option<(FrictionStep, V3<f64>)>,
}

/// What the traction of a node depends on, in components: direction of the normal, two sums of diagonals, weighted slip.
const NODE: usize = 12;

/// Derivatives of a node's traction (of those inside the dual numbers) and of the mismatch of its multipliers.
struct ByNode {
    traction: V3<Dual<NODE>>,
    of_pressure: V3<f64>,
    of_multipliers: [V3<f64>; 2],
    mismatch: [Dual<NODE>; 2],
    mismatch_of_pressure: [f64; 2],
    mismatch_of_multipliers: [[f64; 2]; 2],
    /// Derivatives of the traction, then of the mismatch, by the support that slip is divided by.
    of_support: [f64; 5],
}

/// Frame of a node and its slip there, from normal direction, sums of diagonals and weighted slip.
struct Node<T> {
    tangents: [V3<T>; 2],
    slip: [T; 2],
}

impl<T: Scalar> Node<T> {
    fn new(
        [normal, weighted_slip]: [V3<T>; 2],
        across: [bool; 3],
        along: [V3<T>; 2],
        support: f64,
        way: V3<f64>,
    ) -> Self {
        let within = |v: V3<T>| std::array::from_fn(|i| if across[i] { T::constant(0.0) } else { v[i] });
        let [normal, weighted_slip] = [normal, weighted_slip].map(within);
        let tangents = tangents(normal, along);
        let way = way.map(T::constant);
        // A node that had no partner at the start of the step begins to slip with the next one.
        let inverse = if support > 0.0 { 1.0 / support } else { 0.0 };
        Self { tangents, slip: tangents.map(|e| dot(&e, &weighted_slip).scale(inverse) - dot(&e, &way)) }
    }

    fn vector(&self, components: [T; 2]) -> V3<T> {
        let [e_1, e_2] = self.tangents;
        std::array::from_fn(|i| components[0] * e_1[i] + components[1] * e_2[i])
    }
}

fn add(a: V3<f64>, b: V3<f64>) -> V3<f64> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Sums of the diagonals times their coordinates.
fn along(arguments: &[Facet<f64>], material: &[Coordinates]) -> [V3<f64>; 2] {
    [0, 1].map(|a| {
        let parts = arguments.iter().zip(material);
        parts.fold([0.0; 3], |sum, (x, c)| std::array::from_fn(|i| sum[i] + c[0][a] * x[1][i] + c[1][a] * x[2][i]))
    })
}

impl Slot {
    /// Gap vector and diagonals of a facet around the node; zero for a facet that was not there.
    fn facet(&self, group: Option<&GapWeights>, q: &[f64]) -> [V3<f64>; 3] {
        let Some(group) = group else { return [[0.0; 3]; 3] };
        let origin = position(q, self.nodes[0]);
        let relative = |k: usize| position(q, self.nodes[k]) - origin;
        let weights = group.weights.iter().enumerate().filter(|(_, w)| **w != 0.0);
        let gap: Vector3<f64> = weights.map(|(k, w)| relative(k) * *w).sum();
        let [d_1, d_2] = group.corners.first().map_or([Vector3::zeros(); 2], |c| diagonals(&c.map(relative)));
        [gap, d_1, d_2].map(Into::into)
    }
}

impl NodeFriction<'_> {
    /// Evaluates the step of a slot with a partner; `None` if the node has no tangent plane.
    pub fn state(&self, slot: &Slot, step: StepConfiguration<'_>, work: &mut Scratch) -> Option<FrictionState> {
        let at_end = step.rule == GradientRule::EndPoint;
        let Scratch { arguments, start, material, .. } = work;
        arguments.clear();
        start.clear();
        self.frames.coordinates(self.local, slot.facets().iter().map(|group| group.facet), material);
        let (mut normal, mut slip) = ([0.0; 3], [0.0; 3]);
        for group in slot.facets() {
            // Weights of the start have the same nodes in front. Those of the end are there also for a node that had no partner at the start.
            let old = self.old(group);
            let at_n = slot.facet(if at_end { Some(group) } else { old }, step.q_n);
            let end = slot.facet(Some(group), step.q_np1);
            let x = if at_end {
                [end[0], end[1], end[2], at_n[0]]
            } else {
                let mean = |k: usize| std::array::from_fn(|i| 0.5 * (at_n[k][i] + end[k][i]));
                [mean(0), mean(1), mean(2), [0.0; 3]]
            };
            normal = add(normal, normal_part(&x));
            if self.has_slip(at_end) {
                slip = add(slip, self.measure.slip(at_end, &x, &at_n));
            }
            arguments.push(x);
            start.push(at_n);
        }
        let way = self.way(at_end);
        let along = along(arguments, material);
        let node = Node::new([normal, slip], self.across, along, self.support(slot, at_end), way);
        let size: f64 = arguments.iter().map(|x| (dot(&x[1], &x[1]) * dot(&x[2], &x[2])).sqrt()).sum();
        let regular = dot(&normal, &normal).sqrt() > 1e-12 * size && node.slip.iter().all(|s| s.is_finite());
        if !regular {
            return None;
        }
        let Self { history, multiplier, pressure, step_size, slid, .. } = *self;
        let trial = [0, 1].map(|i| history[i] + self.friction.share(self.compliance) * multiplier[i]);
        let yielded = [0, 1].map(|i| (history[i] + multiplier[i] - trial[i]) / self.friction.stiffness());
        let point = FrictionPoint { history: trial, slip: node.slip, pressure, step_size, slid, yielded };
        let done = self.friction.step(&point);
        let branch = self.reversed.then(|| {
            let branch = self.friction.sticking_step(&point);
            (branch, node.vector([0, 1].map(|i| branch.force[i] - done.force[i])))
        });
        // Nothing is known of the slip of a node without a partner at the start: it has the traction of the start, which is zero.
        let settled = if self.has_slip(at_end) { done.force } else { [0.0; 2] };
        let mismatch = [0, 1].map(|i| (history[i] + multiplier[i] - settled[i]) / self.friction.stiffness());
        let way = node.tangents.map(|e| dot(&e, &way));
        Some(FrictionState { step: done, slip: node.slip, way, mismatch, traction: node.vector(done.force), branch })
    }

    /// Weights of the same facet at the start of the step.
    fn old(&self, group: &GapWeights) -> Option<&GapWeights> {
        self.start.facets().iter().find(|old| old.facet == group.facet)
    }

    /// Covered area that a weighted slip is divided by.
    fn support(&self, slot: &Slot, at_end: bool) -> f64 {
        if at_end { slot.support } else { self.area }
    }

    /// Whether the slip of the step can be measured: with the weights of the start the node must have had a partner.
    fn has_slip(&self, at_end: bool) -> bool {
        at_end || self.area > 0.0
    }

    /// Way of the master's surface beside its mesh in the step, where slip can be measured.
    fn way(&self, at_end: bool) -> V3<f64> {
        if self.has_slip(at_end) { self.friction.surface_way() } else { [0.0; 3] }
    }

    /// Adds force and tangent of a slot; false if the node has no tangent plane.
    pub fn contribute(
        &self,
        slot: &Slot,
        step: StepConfiguration<'_>,
        want_tangent: bool,
        work: &mut Scratch,
        out: &mut Local,
    ) -> bool {
        let Some(state) = self.state(slot, step, work) else { return false };
        for (group, x) in slot.facets().iter().zip(&work.arguments) {
            let force = self.measure.force(&[x[0], x[1], x[2]], state.traction);
            Slot::for_each_coefficient(group, |a, k, c| {
                for i in 0..3 {
                    out.residual[3 * k + i] += c * force[a][i];
                }
            });
        }
        // Rows of the multipliers, if there are such.
        let first = 3 * slot.nodes.len() + out.slots.len();
        for k in 0..out.auxiliaries {
            out.residual[first + k] += self.weight * state.mismatch[k];
        }
        if let Some((branch, shift)) = &state.branch {
            out.shift.resize(out.dim(), 0.0);
            for k in (0..out.auxiliaries).filter(|_| self.has_slip(step.rule == GradientRule::EndPoint)) {
                let more = branch.force[k] - state.step.force[k];
                out.shift[first + k] -= self.weight * more / self.friction.stiffness();
            }
            for (group, x) in slot.facets().iter().zip(&work.arguments) {
                let force = self.measure.force(&[x[0], x[1], x[2]], *shift);
                Slot::for_each_coefficient(group, |a, k, c| {
                    for i in 0..3 {
                        out.shift[3 * k + i] += c * force[a][i];
                    }
                });
            }
        }
        if want_tangent {
            self.add_tangent(slot, step, &state, work, out);
        }
        true
    }

    /// Traction and mismatch with their derivatives; `support`: what slip is divided by.
    fn by_node(&self, work: &Scratch, state: &FrictionState, at_end: bool, support: f64) -> ByNode {
        let (mut normal, mut slip) = ([0.0; 3], [0.0; 3]);
        for (x, start) in work.arguments.iter().zip(&work.start) {
            normal = add(normal, normal_part(x));
            slip = add(slip, self.measure.slip(at_end, x, start));
        }
        let [a, b] = along(&work.arguments, &work.material);
        let variable = |v: V3<f64>, first: usize| std::array::from_fn(|i| Dual::variable(v[i], first + i));
        let node = Node::<Dual<NODE>>::new(
            [variable(normal, 0), variable(slip, 9)],
            self.across,
            [variable(a, 3), variable(b, 6)],
            support,
            self.way(at_end),
        );
        let step = state.branch.as_ref().map_or(&state.step, |(branch, _)| branch);
        let components: [Dual<NODE>; 2] = std::array::from_fn(|i| {
            let [a, b] = step.d_slip[i];
            let partial = std::array::from_fn(|k| a * node.slip[0].partial[k] + b * node.slip[1].partial[k]);
            Dual { value: state.step.force[i], partial }
        });
        let [e_1, e_2] = node.tangents.map(|e| e.map(|x| x.value));
        let vector = |[d_1, d_2]: [f64; 2]| -> V3<f64> { std::array::from_fn(|i| d_1 * e_1[i] + d_2 * e_2[i]) };
        let share = self.friction.share(self.compliance);
        let column = |k: usize| [share * step.d_history[0][k], share * step.d_history[1][k]];
        let per = 1.0 / self.friction.stiffness();
        let of_force = if self.has_slip(at_end) { -per } else { 0.0 };
        let traction = node.vector(components);
        let mismatch = components.map(|c| c.scale(of_force));
        // The slip is inverse to the support.
        let inverse = if support > 0.0 { 1.0 / support } else { 0.0 };
        let by_support = |x: &Dual<NODE>| -inverse * (0..3).map(|i| x.partial[9 + i] * slip[i]).sum::<f64>();
        let [a, b, c] = &traction;
        ByNode {
            of_support: [a, b, c, &mismatch[0], &mismatch[1]].map(by_support),
            traction,
            of_pressure: vector(step.d_pressure),
            of_multipliers: [0, 1].map(|k| vector(column(k))),
            mismatch,
            mismatch_of_pressure: step.d_pressure.map(|d| of_force * d),
            mismatch_of_multipliers: [0, 1]
                .map(|i| [0, 1].map(|k| if i == k { per } else { 0.0 } + of_force * share * step.d_history[i][k])),
        }
    }

    fn add_tangent(
        &self,
        slot: &Slot,
        step: StepConfiguration<'_>,
        state: &FrictionState,
        work: &mut Scratch,
        out: &mut Local,
    ) {
        let at_end = step.rule == GradientRule::EndPoint;
        let n = 3 * slot.nodes.len();
        // Of the row of a force: coordinates and the pressure.
        let (dim, stride) = (n + 1, out.dim());
        let of = self.by_node(work, state, at_end, self.support(slot, at_end));
        let multipliers = out.auxiliaries.min(2);
        // Where their rows and columns begin.
        let first = n + out.slots.len();
        let rows = 3 + multipliers;
        let [a, b, c] = of.traction;
        let by_node = [a, b, c, of.mismatch[0], of.mismatch[1]];
        let Scratch { arguments, start, material, motion, traction, product } = work;
        motion.clear();
        motion.resize(FACET * n * arguments.len(), 0.0);
        traction.clear();
        traction.resize(rows * n, 0.0);
        for (f, ((x, start), material)) in arguments.iter().zip(start.iter()).zip(material.iter()).enumerate() {
            let motion = &mut motion[FACET * n * f..][..FACET * n];
            self.move_arguments(slot, f, step, motion);
            // The traction by the facet's arguments.
            let x: Facet<Dual<FACET>> =
                std::array::from_fn(|a| std::array::from_fn(|i| Dual::variable(x[a][i], 3 * a + i)));
            let (normal, slip) = (normal_part(&x), self.measure.slip(at_end, &x, start));
            for (row, by_node) in traction.chunks_exact_mut(n).zip(&by_node[..rows]) {
                for (k, from) in motion.chunks_exact(n).enumerate() {
                    let coordinates = (k / 3).checked_sub(1).and_then(|diagonal| material.get(diagonal));
                    let mut d = coordinates
                        .map_or(0.0, |[a, b]| by_node.partial[3 + k % 3] * a + by_node.partial[6 + k % 3] * b);
                    for i in 0..3 {
                        d += by_node.partial[i] * normal[i].partial[k] + by_node.partial[9 + i] * slip[i].partial[k];
                    }
                    if d != 0.0 {
                        row.iter_mut().zip(from).for_each(|(t, m)| *t += d * m);
                    }
                }
            }
        }
        if at_end {
            slot.for_each_support_derivative(|column, d| {
                traction.chunks_exact_mut(n).zip(&of.of_support).for_each(|(row, t)| row[column] += t * d);
            });
        }
        let (traction, mismatch) = traction.split_at(3 * n);
        for k in 0..multipliers {
            let to = &mut out.tangent[(first + k) * stride..][..stride];
            to[..n].iter_mut().zip(&mismatch[k * n..]).for_each(|(t, m)| *t += self.weight * m);
            to[n] += self.weight * of.mismatch_of_pressure[k];
            for m in 0..2 {
                to[first + m] += self.weight * of.mismatch_of_multipliers[k][m];
            }
        }
        let width = dim + multipliers;
        for (f, (group, x)) in slot.facets().iter().zip(arguments.iter()).enumerate() {
            let motion = &motion[FACET * n * f..][..FACET * n];
            let v = |v: V3<f64>, first: usize| -> V3<Dual<FACET>> {
                std::array::from_fn(|i| Dual::variable(v[i], first + i))
            };
            let force = self.measure.force(&[v(x[0], 0), v(x[1], 3), v(x[2], 6)], v(state.traction, 9));
            product.clear();
            product.resize(9 * width, 0.0);
            for (to, force) in product.chunks_exact_mut(width).zip(force.iter().flatten()) {
                let (by_x, by_traction) = force.partial.split_at(9);
                let rows = motion.chunks_exact(n).zip(by_x).chain(traction.chunks_exact(n).zip(by_traction));
                for (from, &d) in rows.filter(|(_, d)| **d != 0.0) {
                    to.iter_mut().zip(from).for_each(|(t, m)| *t += d * m);
                }
                let by_traction = [by_traction[0], by_traction[1], by_traction[2]];
                to[n] = dot(&by_traction, &of.of_pressure);
                for m in 0..multipliers {
                    to[dim + m] = dot(&by_traction, &of.of_multipliers[m]);
                }
            }
            Slot::for_each_coefficient(group, |a, k, c| {
                for i in 0..3 {
                    let row = &product[(3 * a + i) * width..][..width];
                    let to = &mut out.tangent[(3 * k + i) * stride..][..stride];
                    to[..dim].iter_mut().zip(row).for_each(|(t, p)| *t += c * p);
                    to[first..].iter_mut().zip(&row[dim..]).for_each(|(t, p)| *t += c * p);
                }
            });
            if at_end {
                for (k, row) in group.derivative.chunks_exact(n).enumerate() {
                    for i in 0..3 {
                        let on_gap = force[0][i].value;
                        let to = &mut out.tangent[(3 * k + i) * stride..][..n];
                        to.iter_mut().zip(row).for_each(|(t, d)| *t += on_gap * d);
                    }
                }
            }
        }
    }

    /// Derivatives of the arguments of facet `f`.
    fn move_arguments(&self, slot: &Slot, f: usize, step: StepConfiguration<'_>, motion: &mut [f64]) {
        let n = 3 * slot.nodes.len();
        let group = &slot.facets()[f];
        let at_end = step.rule == GradientRule::EndPoint;
        let factor = if at_end { 1.0 } else { 0.5 };
        Slot::for_each_coefficient(group, |a, k, c| {
            for i in 0..3 {
                motion[(3 * a + i) * n + 3 * k + i] += factor * c;
            }
        });
        if !at_end {
            return;
        }
        // Of the weights, in the gap vector at the end and in that at the start.
        let [origin, origin_n] = [step.q_np1, step.q_n].map(|q| position(q, slot.nodes[0]));
        for (k, row) in group.derivative.chunks_exact(n).enumerate() {
            let (x, x_n) = (position(step.q_np1, slot.nodes[k]) - origin, position(step.q_n, slot.nodes[k]) - origin_n);
            for (column, d) in row.iter().enumerate().filter(|(_, d)| **d != 0.0) {
                for i in 0..3 {
                    motion[i * n + column] += x[i] * d;
                    if at_end {
                        motion[(9 + i) * n + column] += x_n[i] * d;
                    }
                }
            }
        }
        if at_end {
            return;
        }
        for (k, w) in self.old(group).into_iter().flat_map(|old| &old.weights).enumerate() {
            for i in 0..3 {
                motion[(9 + i) * n + 3 * k + i] += w;
            }
        }
    }
}
