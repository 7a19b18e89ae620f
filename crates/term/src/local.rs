//! What a term adds to the equations: one dense contribution.

/// A further unknown of a slot, beside its pressure. Each active slot of a method has the same list of them, see
/// [`crate::Term::auxiliaries`]. What is measured in coordinates and multipliers is the method's; scaled to the units below
/// the rows can be judged together with the others, and the matrix keeps its balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Auxiliary {
    /// A global unknown, a length or a traction. Its row is a force, and counts as one of the forces that have to balance.
    Balance,
    /// A global unknown, a length or a traction. Its row is a weight (area) times a length, and counts as a constraint.
    Constraint,
    /// Eliminated in the linear equations of each iteration, but a part of the iterate: the contribution has neither row nor column of it, and
    /// [`crate::Term::recover`] gives its increment.
    Condensed,
}

impl Auxiliary {
    /// Number of those that have an equation.
    pub fn equations(list: &[Self]) -> usize {
        list.iter().filter(|&&kind| kind != Self::Condensed).count()
    }
}

/// The first two of the `count` auxiliaries of a slot, zero where there are none: multipliers of the friction.
pub fn multipliers_of(slot: usize, count: usize, auxiliaries: &[f64]) -> [f64; 2] {
    let own = auxiliaries.get(slot * count..slot * count + count).unwrap_or_default();
    [0, 1].map(|k| own.get(k).copied().unwrap_or(0.0))
}

/// One dense contribution: unknowns are the three components of each of `nodes`, then one pressure for each of `slots`, then
/// `auxiliaries` further ones for each of `slots`, slot by slot.
///
/// `residual` has [`Self::dim`] entries, `tangent` is row-major `dim() x dim()`:
/// `d residual / d (q_np1 of nodes, p of slots)`.
#[derive(Clone, Debug, Default)]
pub struct Local {
    /// Numbers of nodes, or of other vectors, each at most once.
    pub nodes: Vec<u32>,
    /// Constraint slots, each at most once.
    pub slots: Vec<u32>,
    /// Whether another rank evaluates it: here it has nodes and slots, and no values. See [`crate::Term::set_share`].
    pub is_elsewhere: bool,
    /// Residual: minus the force, which is `dV/dq` of an energy and theory/node-to-surface#eq-residual of a contact; then `-A g` of the slots.
    pub residual: Vec<f64>,
    /// Row-major tangent; empty or stale if the tangent was not asked for.
    pub tangent: Vec<f64>,
    /// Further unknowns of each slot that have an equation, zero for most methods.
    pub auxiliaries: usize,
    /// Largest violation of equations that were condensed, relative (a length to a length); zero without such.
    pub violation: f64,
    /// What the linear equations take in addition to `residual`, one entry a row, or empty: the difference between the
    /// branch that they are linearised on and the one that the iterate is on, or the start of multipliers that are not determined. It is no part of the norm, so that it cannot change a solution.
    pub shift: Vec<f64>,
}

impl Local {
    /// Number of local unknowns.
    pub fn dim(&self) -> usize {
        3 * self.nodes.len() + self.slots.len() * (1 + self.auxiliaries)
    }
    /// Begins a contribution to these nodes, without slots.
    pub fn begin(&mut self, nodes: &[u32], want_tangent: bool) {
        self.nodes.clear();
        self.nodes.extend_from_slice(nodes);
        self.slots.clear();
        self.reset(want_tangent);
    }
    /// Leaves the present `nodes` and `slots` without values: another rank evaluates them.
    pub fn set_elsewhere(&mut self) {
        self.is_elsewhere = true;
        self.violation = 0.0;
        [&mut self.shift, &mut self.residual, &mut self.tangent].into_iter().for_each(Vec::clear);
    }
    /// Sizes and clears the arrays for the present `nodes` and `slots`.
    pub fn reset(&mut self, want_tangent: bool) {
        let n = self.dim();
        self.is_elsewhere = false;
        self.violation = 0.0;
        self.shift.clear();
        self.residual.clear();
        self.residual.resize(n, 0.0);
        if want_tangent {
            self.tangent.clear();
            self.tangent.resize(n * n, 0.0);
        }
    }
}
