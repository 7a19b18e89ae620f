//! Friction of one slot: slip, frames, force, tangent (theory/friction#nts).
//!
//! The force is `-A tau_a D^a` with the *full* variation `D^a` of the convective coordinates, at `q_np1` (rule `EndPoint`) or `q_mid`
//! with its own projection (`Midpoint`, `DiscreteGradient`). It has no resultant and no moment about that configuration, whatever
//! gap and traction are.
//!
//! The law works with two components in an orthonormal frame `e_1 ~ a_1`, `e_2 = n x e_1` at the foot:
//!
//! * the *slip* is `x(xi_np1) - x(xi_n)`, both material points of the master in the configuration of the force, the second one on the facet of
//!   `n` (theory/friction#eq-feet). One formula on a facet and over edges, thus no jump at an edge; on a flat facet it is `a_a dxi^a`, otherwise
//!   that to second order. Under `DiscreteGradient` it is `a_a D^a . (q_np1 - q_n)` instead: exactly what the force works on, zero in
//!   every rigid motion of the whole, equal to the other to third order;
//! * the *history* is carried as components in the frame of the old foot on the old facet, which moves with the material, and from there turned
//!   into the new tangent plane by the smallest rotation (theory/friction#eq-transport). Lengths do not change, so no stored energy
//!   is lost over an edge.

use crate::crossing::{MAX_NODES, component as at, spread};
use crate::dual::{Dual, Scalar};
use crate::kinematics::{Gap, LOCAL, LocalMatrix};
use nalgebra::Vector3;
use stoss_contact::dual::{V3, cross, dot, unit};
use stoss_contact::friction::{Friction, FrictionPoint, FrictionStep, PointIteration, stick_compliance};
use stoss_geometry::Patch;
use stoss_reference_element::Nodal;
use stoss_term::{GradientRule, SlotFriction, StepContext};

/// Two tangent planes with `1 + n . m` below this are folded upon each other: no rotation from one to the other is the smallest. The
/// traction is dropped then.
const FOLDED: f64 = 1.0e-3;

/// Friction of a whole surface.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceFriction {
    pub friction: Friction,
    /// Rule of the step that began last.
    pub rule: GradientRule,
    pub step_size: f64,
    pub points: Vec<PointHistory>,
    /// Compliance of the stick of each point, in multiples of one over the stiffness.
    pub compliance: Vec<f64>,
    /// Whether all points have one, whatever else acts on them.
    pub is_compliant: bool,
}

impl SurfaceFriction {
    pub fn new(friction: Friction, slots: usize) -> Self {
        let (points, compliance) = (vec![PointHistory::default(); slots], vec![0.0; slots]);
        let (rule, step_size) = (GradientRule::EndPoint, 0.0);
        Self { friction, rule, step_size, points, compliance, is_compliant: false }
    }

    /// Begins a step of the points of these nodes.
    pub fn begin(&mut self, nodes: &[u32], step: &StepContext<'_>) {
        (self.rule, self.step_size) = (step.rule, step.dt);
        self.friction.begin(step);
        for (compliance, &node) in self.compliance.iter_mut().zip(nodes) {
            *compliance = stick_compliance(self.is_compliant || step.held.may_hold(node));
        }
    }
}

/// History of one slot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PointHistory {
    /// Traction at the end of the last accepted step, in the frame of the facet that it ended on.
    pub committed: [f64; 2],
    /// Path slid in this contact.
    pub slid: f64,
    /// Foot at `n` on the facet that the slot starts from.
    pub foot: [f64; 2],
    /// Traction in the frame there.
    pub start: [f64; 2],
    /// What the multipliers of [`stoss_contact::friction::Stick::Multiplier`] add to it.
    pub multiplier: [f64; 2],
    /// Iteration of the friction of this step.
    pub iteration: PointIteration,
    /// What the last accepted step came to.
    pub last: Option<SlotFriction>,
}

/// `e_1`, `e_2`, `n` of two tangents.
fn frame<T: Scalar>(tangents: [V3<T>; 2]) -> [V3<T>; 3] {
    let e_1 = unit(tangents[0]);
    let n = unit(cross(&tangents[0], &tangents[1]));
    [e_1, cross(&n, &e_1), n]
}

/// Components in `to` of a tangent vector with components in `from`, after the smallest rotation of one normal into the other.
fn transport<T: Scalar>(components: [T; 2], from: &[V3<T>; 3], to: &[V3<T>; 3]) -> Option<[T; 2]> {
    let one_plus = T::constant(1.0) + dot(&from[2], &to[2]);
    if one_plus.value() <= FOLDED || one_plus.value().is_nan() {
        return None;
    }
    let v: V3<T> = std::array::from_fn(|i| components[0] * from[0][i] + components[1] * from[1][i]);
    let tilt = dot(&to[2], &v) / one_plus;
    // e . to_n = 0 drops the part along the new normal.
    Some([to[0], to[1]].map(|e| dot(&e, &v) - tilt * dot(&e, &from[2])))
}

/// Frame of a facet at a foot, taken inside of the facet: far out on its extension it can be degenerate.
fn frame_of(patch: &Patch, foot: [f64; 2]) -> [V3<f64>; 3] {
    frame(patch.tangents(patch.kind().clamp(foot)).map(Into::into))
}

/// Carries components from a foot on a facet to one on another facet, in one configuration; zero if they are folded.
pub(crate) fn carry(components: [f64; 2], from: (&Patch, [f64; 2]), to: (&Patch, [f64; 2])) -> [f64; 2] {
    transport(components, &frame_of(from.0, from.1), &frame_of(to.0, to.1)).unwrap_or([0.0; 2])
}

/// How the slip of the step is measured.
pub(crate) enum Slip<'a> {
    /// Slip between material points: kinematics at `q_np1` and local node numbers of the end facet.
    Feet(&'a Gap, &'a Nodal<usize>),
    /// Slip conjugate to the force: `q_np1 - q_n` of the element.
    Work(&'a [f64]),
}

/// Friction of one element. Positions are those of the element's nodes, the slave first.
pub(crate) struct FrictionElement<'a> {
    pub friction: &'a Friction,
    /// The force is that of the end point, not of the midpoint.
    pub at_end: bool,
    /// Positions in the configuration of the force.
    pub q: &'a [f64],
    /// Kinematics there, and the local node numbers of the facet.
    pub at: (&'a Gap, &'a Nodal<usize>),
    /// Local node numbers of the facet at `n`.
    pub start: &'a Nodal<usize>,
    pub history: &'a PointHistory,
    /// Compliance of the stick by multipliers.
    pub compliance: f64,
    pub slip: Slip<'a>,
    pub pressure: f64,
    pub step_size: f64,
}

/// What became of a point.
pub(crate) struct FrictionState {
    pub step: FrictionStep,
    /// Which the equations are linearised on, if it is not `step`.
    pub branch: Option<FrictionStep>,
    /// `(history - traction) / stiffness`, a length: zero where a multiplier has converged.
    pub mismatch: [f64; 2],
    /// Slip in the frame of the foot.
    pub slip: [f64; 2],
    /// Way of the master's surface beside its mesh, in the same frame.
    pub way: [f64; 2],
    /// History in the frame of the foot.
    pub history: [f64; 2],
    /// End traction in the frame of the old foot.
    pub carried: [f64; 2],
    /// Covariant components of the traction in the equations.
    pub tau: [f64; 2],
}

/// Vectors that the traction is a function of: tangents at the foot, tangents at the old foot, slip.
struct Arguments<T>([V3<T>; 2], [V3<T>; 2], V3<T>);

/// Frames at the foot and the old foot, history and slip in the first.
struct Resolved<T> {
    foot: [V3<T>; 3],
    old: [V3<T>; 3],
    history: [T; 2],
    /// The history less the slip that a compliance allows, as a traction.
    trial: [T; 2],
    slip: [T; 2],
}

impl<T: Scalar> Arguments<T> {
    fn resolve(&self, point: &PointHistory, share: f64) -> Resolved<T> {
        let (foot, old) = (frame(self.0), frame(self.1));
        let carried = |share: f64| {
            let own = point.multiplier.map(|m| share * m);
            let start: [f64; 2] = std::array::from_fn(|i| point.start[i] + own[i]);
            // Between folded facets the old traction is dropped, and the multiplier is in the frame of the new foot.
            transport(start.map(T::constant), &old, &foot).unwrap_or(own.map(T::constant))
        };
        let history = carried(1.0);
        let trial = if share == 1.0 { history } else { carried(share) };
        let slip = [foot[0], foot[1]].map(|e| dot(&e, &self.2));
        Resolved { foot, old, history, trial, slip }
    }

    /// Covariant components of a traction.
    fn covariant(&self, foot: &[V3<T>; 3], traction: [T; 2]) -> [T; 2] {
        self.0.map(|a| traction[0] * dot(&foot[0], &a) + traction[1] * dot(&foot[1], &a))
    }
}

/// Derivatives of a scalar of a slot.
pub(crate) struct Slope {
    /// Derivatives with respect to the 15 components of [`Arguments`].
    pub by_arguments: Dual,
    pub by_pressure: f64,
    pub by_multiplier: [f64; 2],
}

/// What the equations need of the derivatives of the friction.
pub(crate) struct Slopes {
    pub tau: [Slope; 2],
    pub mismatch: [Slope; 2],
}

impl FrictionElement<'_> {
    fn factor(&self) -> f64 {
        if self.at_end { 1.0 } else { 0.5 }
    }

    pub fn patch(&self, facet: &Nodal<usize>) -> Patch {
        Patch::new(facet.map(|k| Vector3::new(self.q[3 * k], self.q[3 * k + 1], self.q[3 * k + 2])))
    }

    /// `D^a . dq` for an increment of the element's positions.
    fn contract(&self, increment: &[f64]) -> [f64; 2] {
        let gap = self.at.0;
        let blocks = spread(self.at.1);
        std::array::from_fn(|al| (0..LOCAL).map(|k| gap.xi_gradient[al][k] * increment[at(&blocks, k)]).sum())
    }

    fn arguments(&self) -> Arguments<f64> {
        let tangents = self.at.0.tangents.map(Into::into);
        let start = self.patch(self.start);
        let old = start.tangents(start.kind().clamp(self.history.foot)).map(Into::into);
        let slip = match self.slip {
            Slip::Feet(end, facet) => self.patch(facet).point(end.xi) - start.point(self.history.foot),
            Slip::Work(increment) => {
                let [s_1, s_2] = self.contract(increment);
                self.at.0.tangents[0] * s_1 + self.at.0.tangents[1] * s_2
            }
        };
        let way = self.friction.surface_way();
        Arguments(tangents, old, std::array::from_fn(|i| slip[i] - way[i]))
    }

    fn point(&self, resolved: &Resolved<f64>) -> FrictionPoint {
        let Resolved { history, trial, slip, .. } = *resolved;
        let slid = self.history.slid;
        let (pressure, step_size) = (self.pressure, self.step_size);
        let yielded = [0, 1].map(|i| (history[i] - trial[i]) / self.friction.stiffness());
        FrictionPoint { history: trial, slip, pressure, step_size, slid, yielded }
    }

    fn mismatch(&self, history: [f64; 2], step: &FrictionStep) -> [f64; 2] {
        std::array::from_fn(|i| (history[i] - step.force[i]) / self.friction.stiffness())
    }

    /// Traction, slip, energies.
    pub fn state(&self) -> FrictionState {
        let arguments = self.arguments();
        let resolved = arguments.resolve(self.history, self.friction.share(self.compliance));
        let point = self.point(&resolved);
        let Resolved { foot, old, history, slip, .. } = resolved;
        let step = self.friction.step(&point);
        let branch = self.history.iteration.is_reversed().then(|| self.friction.sticking_step(&point));
        let carried = transport(step.force, &foot, &old).unwrap_or([0.0; 2]);
        let mismatch = self.mismatch(history, &step);
        let way = [foot[0], foot[1]].map(|e| dot(&e, &self.friction.surface_way()));
        let tau = arguments.covariant(&foot, step.force);
        FrictionState { tau, step, branch, mismatch, slip, way, history, carried }
    }

    /// Adds `weight * tau_a D^a` to `residual`.
    pub fn add_residual(&self, weight: f64, tau: [f64; 2], residual: &mut [f64]) {
        let blocks = spread(self.at.1);
        let d = &self.at.0.xi_gradient;
        for k in 0..LOCAL {
            residual[at(&blocks, k)] += weight * (tau[0] * d[0][k] + tau[1] * d[1][k]);
        }
    }

    /// What the branch of the linearisation adds to the covariant traction, and to the mismatch.
    pub fn shift(&self, state: &FrictionState) -> Option<[[f64; 2]; 2]> {
        let branch = state.branch.as_ref()?;
        let difference = std::array::from_fn(|i| branch.force[i] - state.step.force[i]);
        let arguments = self.arguments();
        let mismatch = difference.map(|d| -d / self.friction.stiffness());
        Some([arguments.covariant(&frame(arguments.0), difference), mismatch])
    }

    /// Adds `weight` times the derivative of `tau_a D^a` to the first rows of a row-major matrix, and that of the mismatch to the two rows after that of
    /// the pressure if there are `columns` for multipliers. Columns are the positions at `n+1`, the pressure, then the multipliers.
    pub fn add_tangent(&self, weight: f64, state: &FrictionState, columns: usize, matrix: &mut [f64]) {
        let n = self.q.len();
        let gap = self.at.0;
        let blocks = spread(self.at.1);
        let second = gap.xi_hessian();
        // The law at the level of its 15 arguments.
        let slopes = self.slopes(state);
        let arguments = self.argument_slopes(&second);
        let by_position = |dual: &Dual| {
            let mut out = [0.0; 3 * MAX_NODES];
            for (partial, row) in dual.partial.iter().zip(&arguments) {
                for (d, s) in out[..n].iter_mut().zip(row) {
                    *d += partial * s;
                }
            }
            out
        };
        let d_tau = [0, 1].map(|al| by_position(&slopes.tau[al].by_arguments));
        let has_multipliers = columns == n + 3;
        let factor = self.factor();
        for i in 0..LOCAL {
            let row = &mut matrix[at(&blocks, i) * columns..][..columns];
            for al in 0..2 {
                let d = weight * gap.xi_gradient[al][i];
                for (entry, d_tau) in row[..n].iter_mut().zip(&d_tau[al]) {
                    *entry += d * d_tau;
                }
                row[n] += d * slopes.tau[al].by_pressure;
                if has_multipliers {
                    for k in 0..2 {
                        row[n + 1 + k] += d * slopes.tau[al].by_multiplier[k];
                    }
                }
                for j in 0..LOCAL {
                    row[at(&blocks, j)] += weight * factor * state.tau[al] * second[al][i][j];
                }
            }
        }
        if has_multipliers {
            for (i, slope) in slopes.mismatch.iter().enumerate() {
                let row = &mut matrix[(n + 1 + i) * columns..][..columns];
                for (entry, d) in row[..n].iter_mut().zip(&by_position(&slope.by_arguments)) {
                    *entry += weight * d;
                }
                row[n] += weight * slope.by_pressure;
                for k in 0..2 {
                    row[n + 1 + k] += weight * slope.by_multiplier[k];
                }
            }
        }
    }

    /// Derivatives of the covariant traction and of the mismatch.
    pub fn slopes(&self, state: &FrictionState) -> Slopes {
        let values = self.arguments();
        let variable =
            |first: usize, v: V3<f64>| -> V3<Dual> { std::array::from_fn(|i| Dual::variable(v[i], first + i)) };
        let arguments = Arguments(
            [variable(0, values.0[0]), variable(3, values.0[1])],
            [variable(6, values.1[0]), variable(9, values.1[1])],
            variable(12, values.2),
        );
        let resolved = arguments.resolve(self.history, self.friction.share(self.compliance));
        let step = state.branch.as_ref().unwrap_or(&state.step);
        let traction: [Dual; 2] = std::array::from_fn(|i| {
            let mut sum = Dual::constant(0.0);
            for j in 0..2 {
                sum = sum + resolved.trial[j].scale(step.d_history[i][j]) + resolved.slip[j].scale(step.d_slip[i][j]);
            }
            Dual { value: state.step.force[i], partial: sum.partial }
        });
        // Of the history by the multipliers: they turn with it.
        let old = resolved.old.map(|e| e.map(|x| x.value));
        let foot = resolved.foot.map(|e| e.map(|x| x.value));
        let turned = [[1.0, 0.0], [0.0, 1.0]].map(|unit| transport(unit, &old, &foot).unwrap_or(unit));
        let force_by_multiplier = step.d_history.map(|by_history| {
            turned.map(|t| self.friction.share(self.compliance) * (by_history[0] * t[0] + by_history[1] * t[1]))
        });
        let tau = arguments.covariant(&resolved.foot, traction);
        let tau = std::array::from_fn(|al| {
            let along = [0, 1].map(|k| dot(&foot[k], &values.0[al]));
            Slope {
                by_arguments: tau[al],
                by_pressure: along[0] * step.d_pressure[0] + along[1] * step.d_pressure[1],
                by_multiplier: [0, 1]
                    .map(|m| along[0] * force_by_multiplier[0][m] + along[1] * force_by_multiplier[1][m]),
            }
        });
        let per = 1.0 / self.friction.stiffness();
        let mismatch = std::array::from_fn(|i| {
            // In stick the history cancels: compliance and slip are left.
            let (history, force): (&Dual, &Dual) = (&resolved.history[i], &traction[i]);
            let partial = std::array::from_fn(|k| per * (history.partial[k] - force.partial[k]));
            Slope {
                by_arguments: Dual { value: state.mismatch[i], partial },
                by_pressure: -per * step.d_pressure[i],
                by_multiplier: [0, 1].map(|m| per * (turned[m][i] - force_by_multiplier[i][m])),
            }
        });
        Slopes { tau, mismatch }
    }

    /// Derivatives of the 15 arguments with respect to the element's positions at `n+1`.
    fn argument_slopes(&self, second: &[LocalMatrix; 2]) -> [[f64; 3 * MAX_NODES]; 15] {
        let mut out = [[0.0; 3 * MAX_NODES]; 15];
        let factor = self.factor();
        let gap = self.at.0;
        let blocks = spread(self.at.1);
        for al in 0..2 {
            for i in 0..3 {
                let row = &mut out[3 * al + i];
                for (node, shape) in self.at.1.iter().zip(&gap.shape_gradient) {
                    row[3 * node + i] += factor * shape[al];
                }
                // The foot moves: a_a,b dxi^b, and only a_12 is not zero.
                for k in 0..LOCAL {
                    row[at(&blocks, k)] += factor * gap.a_12[i] * gap.xi_gradient[1 - al][k];
                }
            }
        }
        let start = self.start.kind();
        let old = start.shape_gradient(start.clamp(self.history.foot));
        for al in 0..2 {
            for i in 0..3 {
                for (node, shape) in self.start.iter().zip(&old) {
                    out[6 + 3 * al + i][3 * node + i] += factor * shape[al];
                }
            }
        }
        match self.slip {
            Slip::Feet(end, facet) => {
                let tangents = self.patch(facet).tangents(end.xi);
                let end_blocks = spread(facet);
                let old = start.shape(self.history.foot);
                for i in 0..3 {
                    let row = &mut out[12 + i];
                    for (node, shape) in facet.iter().zip(&end.shape) {
                        row[3 * node + i] += factor * shape;
                    }
                    for (node, shape) in self.start.iter().zip(&old) {
                        row[3 * node + i] -= factor * shape;
                    }
                    for k in 0..LOCAL {
                        row[at(&end_blocks, k)] +=
                            tangents[0][i] * end.xi_gradient[0][k] + tangents[1][i] * end.xi_gradient[1][k];
                    }
                }
            }
            Slip::Work(increment) => {
                let s = self.contract(increment);
                for i in 0..3 {
                    let mut row = [0.0; 3 * MAX_NODES];
                    for al in 0..2 {
                        for (r, da) in row.iter_mut().zip(&out[3 * al + i]) {
                            *r += s[al] * da;
                        }
                        for k in 0..LOCAL {
                            let turn: f64 = (0..LOCAL).map(|l| second[al][k][l] * increment[at(&blocks, l)]).sum();
                            row[at(&blocks, k)] += gap.tangents[al][i] * (gap.xi_gradient[al][k] + factor * turn);
                        }
                    }
                    out[12 + i] = row;
                }
            }
        }
        out
    }
}
