//! The element for a step in which the slave node goes from one facet to another.
//!
//! The 17 invariants of [`crate::invariants`] belong to one facet. Between two facets the force is
//!
//! `G = N_b(q_mid) + theta w`, `w = sum_k (l_k,np1^2 - l_k,n^2) grad(l_k^2)(q_mid)`,
//! `theta = (g_np1 - g_n - N_b . dq) / sum_k (l_k,np1^2 - l_k,n^2)^2`
//!
//! with the direct gap gradient `N_b` on that of the two facets which the midpoint is nearer to and the squared distances `l_k^2` between the
//! slave node and every master node of these facets. Distances are quadratic in the positions, so `w . dq` is the sum of squares in the
//! denominator and `G . dq = g_np1 - g_n`, with each gap on its own facet; both terms are gradients of invariants at the midpoint, so
//! that linear and angular momentum are exact. `theta w` tilts the normal in the direction of the slip by the secant slope of the
//! surface between the two points, and vanishes where the two facets are coplanar. Our extension: the thesis keeps the facet.
//!
//! The midpoint rule takes the same element. Without `theta` a node that runs from a floor on a wall would be lifted by a pressure along the floor's
//! normal, with work that no force does.

use crate::kinematics::{Gap, LOCAL, Local, NODES};
use stoss_reference_element::Nodal;

/// Most nodes of the element: the slave node and two disjoint facets, at `n` and at `n+1`.
pub const MAX_NODES: usize = 1 + 2 * stoss_reference_element::MAX_NODES;

/// Sum of squares (relative to the fourth power of the length) below which the correction is left out: nothing moves.
const SMALLEST_CHANGE: f64 = 1.0e-14;

/// Input: node 0 is the slave node, then the distinct master nodes; `3 * nodes` positions at both ends.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<'a> {
    /// Positions at `n`.
    pub q_n: &'a [f64],
    /// Positions at `n+1`.
    pub q_np1: &'a [f64],
    /// Gap at `n` on its facet.
    pub gap_n: f64,
    /// Kinematics at `n+1` on the facet reached, and the local node numbers of that facet.
    pub end: (&'a Gap, &'a Nodal<usize>),
    /// Kinematics at the midpoint on its facet, and the local node numbers of that facet.
    pub mid: (&'a Gap, &'a Nodal<usize>),
    /// A typical master edge.
    pub length: f64,
}

/// Node of the element for each of the local nodes of a facet's [`Gap`].
pub(crate) fn spread(facet: &Nodal<usize>) -> [usize; NODES] {
    std::array::from_fn(|k| if k == 0 { 0 } else { facet.padded()[k - 1] })
}

/// Component of the element for a component of a [`Gap`].
pub(crate) fn component(nodes: &[usize; NODES], k: usize) -> usize {
    3 * nodes[k / 3] + k % 3
}

/// The local vector of a facet from the blocks of the element's nodes.
pub(crate) fn local_of(facet: &Nodal<usize>, block: impl Fn(usize) -> [f64; 3]) -> Local {
    let mut out = [0.0; LOCAL];
    for (to, node) in out.chunks_exact_mut(3).zip(spread(facet)) {
        to.copy_from_slice(&block(node));
    }
    out
}

impl Crossing<'_> {
    fn node(q: &[f64], k: usize) -> [f64; 3] {
        [q[3 * k], q[3 * k + 1], q[3 * k + 2]]
    }

    /// `G` (`3 * nodes`) and, if `tangent` is not empty, `dG/dq_np1` row by row (`(3 * nodes)^2`). Both are overwritten.
    pub fn evaluate(&self, gradient: &mut [f64], tangent: &mut [f64]) {
        let n = self.q_n.len();
        let nodes = n / 3;
        gradient.fill(0.0);
        tangent.fill(0.0);
        let mid_nodes = spread(self.mid.1);
        for (block, &node) in mid_nodes.iter().enumerate() {
            for i in 0..3 {
                gradient[3 * node + i] += self.mid.0.gradient[3 * block + i];
            }
        }
        // N_b . dq and (1/2) H_b dq are needed for theta and its derivative.
        let hessian = self.mid.0.hessian();
        let dq = |k: usize| self.q_np1[k] - self.q_n[k];
        if !tangent.is_empty() {
            for i in 0..LOCAL {
                for j in 0..LOCAL {
                    tangent[component(&mid_nodes, i) * n + component(&mid_nodes, j)] += 0.5 * hessian[i][j];
                }
            }
        }
        // Squared distances: change, gradient at the midpoint (2 r on the slave, -2 r on the master) and at the end.
        let mut change = [0.0; MAX_NODES];
        let mut r_mid = [[0.0; 3]; MAX_NODES];
        let mut r_end = [[0.0; 3]; MAX_NODES];
        let mut square = 0.0;
        for k in 1..nodes {
            let (s_n, m_n) = (Self::node(self.q_n, 0), Self::node(self.q_n, k));
            let (s_1, m_1) = (Self::node(self.q_np1, 0), Self::node(self.q_np1, k));
            for i in 0..3 {
                let (r_0, r_1) = (s_n[i] - m_n[i], s_1[i] - m_1[i]);
                r_mid[k][i] = 0.5 * (r_0 + r_1);
                r_end[k][i] = r_1;
                change[k] += (r_1 - r_0) * (r_1 + r_0);
            }
            square += change[k] * change[k];
        }
        if square <= SMALLEST_CHANGE * self.length.powi(4) {
            return;
        }
        let mut work = 0.0;
        for k in 0..n {
            work += gradient[k] * dq(k);
        }
        let theta = (self.end.0.gap - self.gap_n - work) / square;
        let mut w = [0.0; 3 * MAX_NODES];
        for k in 1..nodes {
            for i in 0..3 {
                w[i] += 2.0 * change[k] * r_mid[k][i];
                w[3 * k + i] -= 2.0 * change[k] * r_mid[k][i];
            }
        }
        if !tangent.is_empty() {
            // d theta = (N_c - N_b - H_b dq / 2 - theta d(square)) / square.
            let mut slope = [0.0; 3 * MAX_NODES];
            let end_nodes = spread(self.end.1);
            for k in 0..LOCAL {
                slope[component(&end_nodes, k)] += self.end.0.gradient[k];
                let mut sum = self.mid.0.gradient[k];
                for j in 0..LOCAL {
                    sum += 0.5 * hessian[k][j] * dq(component(&mid_nodes, j));
                }
                slope[component(&mid_nodes, k)] -= sum;
            }
            for k in 1..nodes {
                for i in 0..3 {
                    let d = 4.0 * change[k] * r_end[k][i];
                    slope[i] -= theta * d;
                    slope[3 * k + i] += theta * d;
                }
            }
            for i in 0..n {
                for j in 0..n {
                    tangent[i * n + j] += w[i] * slope[j] / square;
                }
            }
            // theta dw: products of the distances' gradients, and their constant second derivatives.
            for k in 1..nodes {
                for (block_i, sign_i) in [(0, 1.0), (k, -1.0)] {
                    for (block_j, sign_j) in [(0, 1.0), (k, -1.0)] {
                        let sign = theta * sign_i * sign_j;
                        for i in 0..3 {
                            for j in 0..3 {
                                let second = if i == j { change[k] } else { 0.0 };
                                tangent[(3 * block_i + i) * n + 3 * block_j + j] +=
                                    sign * (4.0 * r_mid[k][i] * r_end[k][j] + second);
                            }
                        }
                    }
                }
            }
        }
        for (g, w) in gradient.iter_mut().zip(&w) {
            *g += theta * w;
        }
    }
}
