//! The weighted gap of one slave node: weights gathered from the facets around it, force, tangent and constraint row.

use crate::kernel::Term;
use crate::opposite::Sides;
use crate::weights::FacetWeights;
use nalgebra::{Matrix3, Vector3};
use stoss_contact::{ContactRule, ContactSurface, LocalContribution, StepConfiguration};

/// Which normals a weighted gap is measured along.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalField {
    /// The mean of the normals of the facets around the slave node, weighted by their areas, on either side of a sharp edge (35 degrees in the reference
    /// configuration) for itself: a block in a corner has the normals of floor and wall up to its edge.
    #[default]
    Averaged,
    /// Each facet's own normal at its centre. The energy-momentum element always has this one.
    Facet,
}

/// A part of a weighted gap that has one normal.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    /// The slave facet, the first of those that make the normal.
    pub facet: u32,
    /// Corners of the facets that make the normal, as positions in [`Slot::nodes`].
    pub corners: Vec<[usize; 4]>,
    /// One weight a node, an area (or free of units with directors).
    pub weights: Vec<f64>,
    /// `d weights / d x`, row-major, one column a component; empty if frozen.
    pub derivative: Vec<f64>,
}

/// The weighted gap of one slave node.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slot {
    /// Global nodes, the slave node first. Within a step nodes are only added.
    pub nodes: Vec<u32>,
    /// `int phi_A dA` over the covered part; zero if the node has no partner.
    pub support: f64,
    /// What it could be at most in the reference configuration: the node's area on the facets that are opposite something and on those that go over into
    /// them smoothly. The side of a block is no part of what its lower edge could stand on.
    pub area: f64,
    groups: Vec<Group>,
    /// One group a facet with areas as weights, for friction; empty if `groups` are these, or there is no friction.
    facets: Vec<Group>,
}

/// Scratch of an evaluation.
#[derive(Debug, Default)]
pub(crate) struct Work {
    arguments: [Vec<Vector3<f64>>; 3],
    force: Term,
    other: Term,
    end: Term,
    /// Derivative of the arguments, row-major.
    motion: Vec<f64>,
    /// Tangent times that.
    product: Vec<f64>,
}

/// Coefficient of a corner in the two diagonals.
const DIAGONAL: [[f64; 4]; 2] = [[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]];

pub(crate) fn at(q: &[f64], node: u32) -> Vector3<f64> {
    let k = 3 * node as usize;
    Vector3::new(q[k], q[k + 1], q[k + 2])
}

impl Slot {
    /// Gathers the weights of the facets around local slave node `local`. `sides` are those of the slave; `old` are nodes to keep in
    /// front.
    pub fn gather(
        local: usize,
        surfaces: [&ContactSurface; 2],
        sides: &Sides,
        facets: &[Option<FacetWeights>],
        normals: NormalField,
        old: &[u32],
    ) -> Self {
        let [slave, master] = surfaces;
        let mut slot = Self {
            nodes: old.to_vec(),
            support: 0.0,
            area: slave.nodal_areas()[local],
            groups: Vec::new(),
            facets: Vec::new(),
        };
        if slot.nodes.is_empty() {
            slot.nodes.push(slave.nodes()[local]);
        }
        let around = slave.facets_around(local);
        let corner_of = |f: u32| slave.local_facets()[f as usize].iter().position(|&n| n as usize == local);
        // What lies beyond a sharp edge and is opposite nothing has no part in the normal, nor in the area.
        let side_of = |f: u32| corner_of(f).map(|a| sides.of(f, a));
        let takes_part = |f: u32| around.iter().any(|&e| facets[e as usize].is_some() && side_of(e) == side_of(f));
        let mut area = 0.0;
        for (&f, a) in around.iter().filter_map(|f| Some((f, corner_of(*f)?))) {
            if let Some(w) = &facets[f as usize] {
                slot.support += w.support[a];
            }
            if takes_part(f) {
                let part = facets[f as usize].as_ref().map_or(1.0, |w| w.part);
                area += part * slave.corner_areas()[f as usize][a];
            }
        }
        if area > 0.0 {
            slot.area = area;
        }
        if slot.support < 1e-8 * slot.area {
            slot.support = 0.0;
            return slot;
        }
        // Nodes first, so that all arrays have their final size.
        let mut maps: Vec<Vec<usize>> = Vec::new();
        for &f in around {
            let weights = facets[f as usize].as_ref();
            let opposite = weights.into_iter().flat_map(|w| &w.masters).map(|&m| master.facets()[m as usize]);
            let mut map = Vec::new();
            for node in std::iter::once(slave.facets()[f as usize]).chain(opposite).flatten() {
                let k = slot.nodes.iter().position(|&n| n == node).unwrap_or_else(|| {
                    slot.nodes.push(node);
                    slot.nodes.len() - 1
                });
                map.push(k);
            }
            maps.push(map);
        }
        let columns = 3 * slot.nodes.len();
        for (i, &f) in around.iter().enumerate().filter(|(_, f)| takes_part(**f)) {
            let corners = std::array::from_fn(|k| maps[i][k]);
            let has_it = |group: &Group| normals == NormalField::Averaged && side_of(group.facet) == side_of(f);
            let at = slot.groups.iter().position(has_it).unwrap_or_else(|| {
                slot.groups.push(Group { facet: f, weights: vec![0.0; slot.nodes.len()], ..Group::default() });
                slot.groups.len() - 1
            });
            let group = &mut slot.groups[at];
            group.corners.push(corners);
            let (Some(w), Some(a)) = (&facets[f as usize], corner_of(f)) else { continue };
            let count = w.node_count();
            for (k, &to) in maps[i].iter().enumerate() {
                group.weights[to] += w.weights[a * count + k];
            }
            if w.derivative.is_empty() {
                continue;
            }
            group.derivative.resize(slot.nodes.len() * columns, 0.0);
            for (k, &row) in maps[i].iter().enumerate() {
                let from = &w.derivative[(a * count + k) * 3 * count..][..3 * count];
                for (l, &column) in maps[i].iter().enumerate() {
                    for c in 0..3 {
                        group.derivative[row * columns + 3 * column + c] += from[3 * l + c];
                    }
                }
            }
        }
        slot
    }

    /// The same with weights of friction, `areas` of the same segments as `facets` of [`Self::gather`].
    pub fn with_facets(
        mut self,
        local: usize,
        surfaces: [&ContactSurface; 2],
        sides: &Sides,
        areas: &[Option<FacetWeights>],
    ) -> Self {
        // The same segments have the same nodes.
        self.facets = Self::gather(local, surfaces, sides, areas, NormalField::Facet, &self.nodes).groups;
        self
    }

    /// One group a slave facet with areas as weights, none without a partner.
    pub fn facets(&self) -> &[Group] {
        if self.facets.is_empty() { &self.groups } else { &self.facets }
    }

    fn arguments(&self, group: &Group, q: &[f64], out: &mut Vec<Vector3<f64>>) {
        out.clear();
        // The weights add up to zero: positions relative to the slave node lose no digits.
        let origin = at(q, self.nodes[0]);
        let position = |k: usize| at(q, self.nodes[k]) - origin;
        out.push(group.weights.iter().enumerate().filter(|(_, w)| **w != 0.0).map(|(k, w)| position(k) * *w).sum());
        for c in &group.corners {
            out.push(position(c[2]) - position(c[0]));
            out.push(position(c[3]) - position(c[1]));
        }
    }

    /// The weighted gap at `q`, a volume; `None` without a partner or normal.
    pub fn gap(&self, q: &[f64], directors: bool, work: &mut Work) -> Option<f64> {
        if self.support <= 0.0 {
            return None;
        }
        let mut sum = 0.0;
        for group in &self.groups {
            let mut arguments = std::mem::take(&mut work.arguments[0]);
            self.arguments(group, q, &mut arguments);
            let there = if directors {
                work.end.director_gap(&arguments);
                true
            } else {
                work.end.normal_gap(&arguments, false)
            };
            work.arguments[0] = arguments;
            if !there {
                return None;
            }
            sum += work.end.value;
        }
        Some(sum)
    }

    /// Rate of the weighted gap vector for nodal velocities `v` (`3 * nodes`), a volume a time; zero without a partner.
    pub fn rate(&self, v: &[f64]) -> Vector3<f64> {
        let of_group = |group: &Group| -> Vector3<f64> {
            group.weights.iter().zip(&self.nodes).map(|(&w, &node)| at(v, node) * w).sum()
        };
        self.groups.iter().map(of_group).sum()
    }

    /// Visits (component of the nodes, derivative of the support), if there are derivatives; a component may come more than once.
    pub fn for_each_support_derivative(&self, mut visit: impl FnMut(usize, f64)) {
        let columns = 3 * self.nodes.len();
        for group in self.groups.iter().filter(|group| !group.derivative.is_empty()) {
            let mut rows: Vec<usize> = group.corners.iter().flatten().copied().collect();
            rows.sort_unstable();
            rows.dedup();
            // The weights of the slave's nodes add up to the support.
            for k in rows {
                for (column, &d) in group.derivative[k * columns..][..columns].iter().enumerate() {
                    visit(column, d);
                }
            }
        }
    }

    /// Unit normal at `q` from master to slave, zero if there is none.
    pub fn normal(&self, q: &[f64]) -> [f64; 3] {
        let mut c = Vector3::zeros();
        for corners in self.groups.iter().flat_map(|g| &g.corners) {
            let x = corners.map(|k| at(q, self.nodes[k]));
            c -= (x[2] - x[0]).cross(&(x[3] - x[1]));
        }
        c.try_normalize(0.0).unwrap_or_default().into()
    }

    /// Adds `-p grad Phi` and the row `-(Phi - reference)` with their tangent to `out`, which has this slot's nodes. Returns
    /// false if a normal vanishes.
    pub fn contribute(
        &self,
        step: StepConfiguration<'_>,
        pressure: f64,
        reference: f64,
        want_tangent: bool,
        work: &mut Work,
        out: &mut LocalContribution,
    ) -> bool {
        let n = 3 * self.nodes.len();
        out.residual[n] += reference;
        self.groups.iter().all(|group| {
            let there = self.evaluate(group, step, want_tangent, work);
            if there {
                self.add(group, step.q_np1, pressure, want_tangent, work, out);
            }
            there
        })
    }

    /// Force term with its derivative by the arguments at the end in `work.force`, the constraint in `work.end`.
    fn evaluate(&self, group: &Group, step: StepConfiguration<'_>, want_tangent: bool, work: &mut Work) -> bool {
        let [at_n, end, middle] = &mut work.arguments;
        self.arguments(group, step.q_np1, end);
        if step.rule != ContactRule::EndPoint {
            self.arguments(group, step.q_n, at_n);
        }
        let (force, other) = (&mut work.force, &mut work.other);
        match step.rule {
            ContactRule::EndPoint => {
                if !force.normal_gap(end, want_tangent) {
                    return false;
                }
                work.end.clone_from(force);
                return true;
            }
            ContactRule::EnergyMomentum => {
                work.end.director_gap(end);
                return force.director_discrete(at_n, end, want_tangent);
            }
            ContactRule::Midpoint => {
                middle.clear();
                middle.extend(at_n.iter().zip(end.iter()).map(|(a, b)| 0.5 * (a + b)));
                if !force.normal_gap(middle, want_tangent) {
                    return false;
                }
                force.tangent.iter_mut().for_each(|t| *t *= 0.5);
            }
            ContactRule::EndPointMean => {
                if !other.normal_gap(at_n, false) || !force.normal_gap(end, want_tangent) {
                    return false;
                }
                force.gradient.iter_mut().zip(&other.gradient).for_each(|(g, o)| *g = 0.5 * (*g + o));
                force.tangent.iter_mut().for_each(|t| *t *= 0.5);
            }
            // The gradient at the start is constant: its tangent is zero.
            _ => {
                if !force.normal_gap(at_n, false) {
                    return false;
                }
            }
        }
        work.end.normal_gap(end, false)
    }

    /// Visits (argument, node, coefficient) of all coefficients that are not zero.
    pub fn for_each_coefficient(group: &Group, mut visit: impl FnMut(usize, usize, f64)) {
        for (k, &w) in group.weights.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            visit(0, k, w);
        }
        for (f, corners) in group.corners.iter().enumerate() {
            for (d, row) in DIAGONAL.iter().enumerate() {
                for (&k, &c) in corners.iter().zip(row).filter(|(_, c)| **c != 0.0) {
                    visit(1 + 2 * f + d, k, c);
                }
            }
        }
    }

    fn add(&self, group: &Group, q: &[f64], p: f64, want_tangent: bool, work: &mut Work, out: &mut LocalContribution) {
        let n = 3 * self.nodes.len();
        let dim = out.dim();
        let Work { force, end, motion, product, .. } = work;
        out.residual[n] -= end.value;
        Self::for_each_coefficient(group, |a, k, c| {
            for i in 0..3 {
                let g = c * force.gradient[a][i];
                out.residual[3 * k + i] -= p * g;
                if want_tangent {
                    out.tangent[(3 * k + i) * dim + n] -= g;
                }
            }
        });
        if !want_tangent {
            return;
        }
        let count = 1 + 2 * group.corners.len();
        motion.clear();
        motion.resize(3 * count * n, 0.0);
        Self::for_each_coefficient(group, |a, k, c| {
            for i in 0..3 {
                motion[(3 * a + i) * n + 3 * k + i] += c;
            }
        });
        let origin = at(q, self.nodes[0]);
        let moving = !group.derivative.is_empty();
        if moving {
            for (k, row) in group.derivative.chunks_exact(n).enumerate() {
                let x = at(q, self.nodes[k]) - origin;
                for (column, d) in row.iter().enumerate() {
                    for i in 0..3 {
                        motion[i * n + column] += x[i] * d;
                    }
                }
            }
        }
        for a in 0..count {
            for i in 0..3 {
                let g = end.gradient[a][i];
                let row = &motion[(3 * a + i) * n..][..n];
                out.tangent[n * dim..n * dim + n].iter_mut().zip(row).for_each(|(t, m)| *t -= g * m);
            }
        }
        product.clear();
        product.resize(3 * count * n, 0.0);
        if force.tangent.iter().any(|t| *t != Matrix3::zeros()) {
            for a in 0..count {
                for b in 0..count {
                    let block = &force.tangent[a * count + b];
                    for i in 0..3 {
                        for j in 0..3 {
                            let h = block[(i, j)];
                            if h != 0.0 {
                                let row = &motion[(3 * b + j) * n..][..n];
                                let to = &mut product[(3 * a + i) * n..][..n];
                                to.iter_mut().zip(row).for_each(|(t, m)| *t += h * m);
                            }
                        }
                    }
                }
            }
        }
        Self::for_each_coefficient(group, |a, k, c| {
            for i in 0..3 {
                let row = &product[(3 * a + i) * n..][..n];
                let to = &mut out.tangent[(3 * k + i) * dim..][..n];
                to.iter_mut().zip(row).for_each(|(t, m)| *t -= p * c * m);
            }
        });
        if moving {
            for (k, row) in group.derivative.chunks_exact(n).enumerate() {
                for i in 0..3 {
                    let g = p * force.gradient[0][i];
                    let to = &mut out.tangent[(3 * k + i) * dim..][..n];
                    to.iter_mut().zip(row).for_each(|(t, d)| *t -= g * d);
                }
            }
        }
    }
}
