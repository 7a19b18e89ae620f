//! One slot's element: residual and tangent of the full augmented system, and their reductions (theory/coordinate-augmentation#full).

use super::Reduction;
use super::constraints::{Constraints, UNKNOWNS};
use crate::crossing::{MAX_NODES, component};
use crate::friction::{FrictionElement, FrictionState};
use crate::kinematics::{Gap, LOCAL, NODES};
use stoss_reference_element::Nodal;

/// Most unknowns: positions, pressure, two multipliers of the friction, two coordinates, two multipliers.
pub(crate) const MOST: usize = 3 * MAX_NODES + 7;

/// Solution of a 2x2 system; `None` if it is singular to working precision.
pub(crate) fn solve_2(m: [[f64; 2]; 2], rhs: [f64; 2]) -> Option<[f64; 2]> {
    let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let size = (m[0][0].abs() + m[0][1].abs()) * (m[1][1].abs() + m[1][0].abs());
    if det.abs() <= 1.0e-14 * size || det.is_nan() {
        return None;
    }
    Some([(m[1][1] * rhs[0] - m[0][1] * rhs[1]) / det, (m[0][0] * rhs[1] - m[1][0] * rhs[0]) / det])
}

/// A scalar of the friction with its derivatives.
#[derive(Clone, Debug)]
pub(crate) struct Sloped {
    pub value: f64,
    /// Derivatives with respect to the element's positions at `n+1`; then to the coordinates at `n+1`, the pressure, the multipliers of the friction.
    pub by_q: [f64; 3 * MAX_NODES],
    pub by_f: [f64; 2],
    pub by_pressure: f64,
    pub by_multiplier: [f64; 2],
}

impl Sloped {
    const ZERO: Self =
        Self { value: 0.0, by_q: [0.0; 3 * MAX_NODES], by_f: [0.0; 2], by_pressure: 0.0, by_multiplier: [0.0; 2] };
}

/// Friction of a slot.
#[derive(Clone, Debug)]
pub(crate) struct Traction {
    /// Covariant traction `tau_a`.
    pub tau: [Sloped; 2],
    /// What is zero at the right multipliers of the friction, a length; used if there are such.
    pub mismatch: [Sloped; 2],
    /// What the branch of the linearisation adds to `tau` and `mismatch`.
    pub shift: Option<[[f64; 2]; 2]>,
}

impl Traction {
    pub const NONE: Self = Self { tau: [Sloped::ZERO; 2], mismatch: [Sloped::ZERO; 2], shift: None };

    /// `end`: kinematics at the coordinates of `n+1`, `facet`: local numbers of that facet.
    pub fn new(element: &FrictionElement<'_>, end: &Gap, facet: &Nodal<usize>, want_tangent: bool) -> Self {
        let state: FrictionState = element.state();
        let mut out = Self { shift: element.shift(&state), ..Self::NONE };
        for k in 0..2 {
            (out.tau[k].value, out.mismatch[k].value) = (state.tau[k], state.mismatch[k]);
        }
        if !want_tangent {
            return out;
        }
        let slopes = element.slopes(&state);
        let factor = if element.at_end { 1.0 } else { 0.5 };
        let at = element.at.0;
        let old = element.history.foot;
        let start = element.start.kind();
        let (old_shape, old_gradient) = (start.shape(old), start.shape_gradient(start.clamp(old)));
        let tangents = element.patch(facet).tangents(end.xi);
        let all = out.tau.iter_mut().zip(&slopes.tau).chain(out.mismatch.iter_mut().zip(&slopes.mismatch));
        for (out, slope) in all {
            // Two tangents, two old tangents, slip.
            let d = |block: usize, i: usize| slope.by_arguments.partial[3 * block + i];
            for i in 0..3 {
                for (k, &node) in facet.iter().enumerate() {
                    let here = &mut out.by_q[3 * node + i];
                    *here += factor * (at.shape_gradient[k][0] * d(0, i) + at.shape_gradient[k][1] * d(1, i));
                    *here += factor * end.shape[k] * d(4, i);
                }
                for (k, &node) in element.start.iter().enumerate() {
                    let there = &mut out.by_q[3 * node + i];
                    *there += factor * (old_gradient[k][0] * d(2, i) + old_gradient[k][1] * d(3, i));
                    *there -= factor * old_shape[k] * d(4, i);
                }
                for be in 0..2 {
                    out.by_f[be] += factor * at.a_12[i] * d(1 - be, i) + tangents[be][i] * d(4, i);
                }
            }
            out.by_pressure = slope.by_pressure;
            out.by_multiplier = slope.by_multiplier;
        }
        out
    }
}

/// What the equations of a slot are made of.
pub(crate) struct Equations<'a> {
    /// Constraints at the configuration of the forces, and whether that is the end point.
    pub force: &'a Constraints,
    /// Nodes of the element for the local nodes of the constraints.
    pub nodes: [usize; NODES],
    pub at_end: bool,
    /// Constraints at `n+1`.
    pub end: &'a Constraints,
    pub traction: &'a Traction,
    pub pressure: f64,
    /// Gap that the constraint keeps.
    pub reference: f64,
    pub weight: f64,
    /// Length with which coordinates and multipliers are scaled.
    pub length: f64,
    /// Position components of the element.
    pub n: usize,
    /// Multipliers of the friction, 0 or 2.
    pub frictional: usize,
    pub reduction: Reduction,
}

/// Residual and row-major tangent with `n + 5` unknowns (positions, pressure, coordinates, multipliers) and two more after the pressure, the
/// multipliers of the friction, if there are such.
pub(crate) struct Dense {
    pub residual: [f64; MOST],
    pub tangent: Vec<f64>,
}

impl Equations<'_> {
    /// Multipliers `lambda_A` for which the coordinates' row vanishes, theory/coordinate-augmentation#eq-first.
    pub fn multipliers(&self) -> Option<[f64; 2]> {
        let b = self.force.gap_by_coordinates();
        solve_2(self.force.foot_by_coordinates(), [0, 1].map(|k| b[k] * self.pressure - self.traction.tau[k].value))
    }

    /// The full system at given multipliers; the tangent is overwritten if wanted.
    pub fn full(&self, lambda: [f64; 2], want_tangent: bool, out: &mut Dense) {
        let Self { force, nodes, end, traction, pressure, weight, n, frictional, .. } = *self;
        let dim = self.dim();
        let first = self.coordinates();
        // Rows and columns are divided by these.
        let scale = |k: usize| if k >= first { self.length } else { 1.0 };
        let slot = |u: usize| if u < LOCAL { component(&nodes, u) } else { first + (u - LOCAL) };
        out.residual[..dim].fill(0.0);
        for u in 0..UNKNOWNS {
            let tau = if u < LOCAL { 0.0 } else { traction.tau[u - LOCAL].value };
            out.residual[slot(u)] += weight
                * (tau + lambda[0] * force.foot_gradient[0][u] + lambda[1] * force.foot_gradient[1][u]
                    - pressure * force.gap_gradient[u])
                / scale(slot(u));
        }
        out.residual[n] = -weight * (end.gap - self.reference);
        for al in 0..2 {
            out.residual[first + 2 + al] = weight * end.foot[al] / self.length;
        }
        for k in 0..frictional {
            out.residual[n + 1 + k] = weight * traction.mismatch[k].value;
        }
        if !want_tangent {
            return;
        }
        out.tangent.clear();
        out.tangent.resize(dim * dim, 0.0);
        let factor = if self.at_end { 1.0 } else { 0.5 };
        let mut add =
            |i: usize, j: usize, value: f64| out.tangent[i * dim + j] += weight * value / (scale(i) * scale(j));
        let hessian = force.hessian(lambda, pressure);
        for u in 0..UNKNOWNS {
            for v in 0..UNKNOWNS {
                add(slot(u), slot(v), factor * hessian[u][v]);
            }
            add(slot(u), n, -force.gap_gradient[u]);
            add(n, slot(u), -end.gap_gradient[u]);
            for al in 0..2 {
                add(slot(u), first + 2 + al, force.foot_gradient[al][u]);
                add(first + 2 + al, slot(u), end.foot_gradient[al][u]);
            }
        }
        let of_friction = traction.mismatch.iter().take(frictional).enumerate().map(|(k, m)| (n + 1 + k, m));
        for (row, slope) in of_friction.chain([(first, &traction.tau[0]), (first + 1, &traction.tau[1])]) {
            for j in 0..n {
                add(row, j, slope.by_q[j]);
            }
            add(row, n, slope.by_pressure);
            for be in 0..2 {
                add(row, first + be, slope.by_f[be]);
            }
            for k in 0..frictional {
                add(row, n + 1 + k, slope.by_multiplier[k]);
            }
        }
    }

    /// Number of the first coordinate.
    fn coordinates(&self) -> usize {
        self.n + 1 + self.frictional
    }

    /// Number of all unknowns.
    pub fn dim(&self) -> usize {
        self.coordinates() + 4
    }

    /// The system of a reduction: `out` is compressed to its unknowns. `None` if the elimination is singular (a focal point).
    pub fn reduced(&self, lambda: [f64; 2], want_tangent: bool, out: &mut Dense) -> Option<()> {
        let (dim, f) = (self.dim(), self.coordinates());
        match self.reduction {
            Reduction::None => {
                self.full(lambda, want_tangent, out);
            }
            Reduction::First => {
                self.full(self.multipliers()?, want_tangent, out);
                if want_tangent {
                    out.eliminate(dim, f, f + 2)?;
                }
                // Rows of the foot constraint take the place of the rows of the coordinates.
                out.move_rows(dim, want_tangent);
            }
            Reduction::Second => {
                // The tangent is a part of the residual: R_q + K_qf s.
                self.full(self.multipliers()?, true, out);
                out.eliminate(dim, f, f + 2)?;
                out.eliminate(dim, f + 2, f)?;
            }
        }
        Some(())
    }
}

impl Default for Dense {
    fn default() -> Self {
        Self { residual: [0.0; MOST], tangent: Vec::new() }
    }
}

impl Dense {
    /// Eliminates two unknowns (`columns` and the next) by two equations (`rows` and the next) from all others.
    fn eliminate(&mut self, dim: usize, rows: usize, columns: usize) -> Option<()> {
        let k = |i: usize, j: usize| i * dim + j;
        let block = [0, 1].map(|a| [0, 1].map(|b| self.tangent[k(rows + a, columns + b)]));
        for i in (0..dim).filter(|&i| i != rows && i != rows + 1) {
            // Factors x with x . block = (row i at the columns).
            let transposed = [[block[0][0], block[1][0]], [block[0][1], block[1][1]]];
            let at = [self.tangent[k(i, columns)], self.tangent[k(i, columns + 1)]];
            if at == [0.0; 2] {
                continue;
            }
            let x = solve_2(transposed, at)?;
            for j in 0..dim {
                self.tangent[k(i, j)] -= x[0] * self.tangent[k(rows, j)] + x[1] * self.tangent[k(rows + 1, j)];
            }
            self.residual[i] -= x[0] * self.residual[rows] + x[1] * self.residual[rows + 1];
        }
        Some(())
    }

    /// Puts the last two rows in place of the two before them.
    fn move_rows(&mut self, dim: usize, tangent: bool) {
        self.residual.copy_within(dim - 2..dim, dim - 4);
        if tangent {
            self.tangent.copy_within((dim - 2) * dim..dim * dim, (dim - 4) * dim);
        }
    }
}
