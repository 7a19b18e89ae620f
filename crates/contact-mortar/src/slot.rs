//! The weighted gap of one row as a function of the positions: value, gradient, second derivative (theory/mortar#gap).
//!
//! `Phi = n . g` with the gap vector `g = sum_k w_k x_k` and the normal `n = c / |c|`, `c = -sum_f d1_f x d2_f` over the diagonals ([`stoss_reference_element::FacetKind::diagonals`]) of the facets of the row. The
//! weights move with the positions.

use crate::Faces;
use crate::positions::Positions;
use crate::rows::Row;
use crate::surfaces::{area_vector, diagonals};
use crate::weights::FacetWeights;
use nalgebra::{Matrix3, Matrix3xX, Vector3};
use stoss_contact::ContactSurface;
use stoss_reference_element::Nodal;

/// Weights of nodes in a gap vector.
#[derive(Clone, Debug, Default)]
pub(crate) struct GapWeights {
    /// The slave facet, the first of those that make the normal.
    pub facet: u32,
    /// Corners of the facets that make the normal, as positions in [`Slot::nodes`].
    pub corners: Vec<Nodal<usize>>,
    /// Nodes that the slave's positions are made of, as positions in [`Slot::nodes`]; a node may come more than once.
    slave_nodes: Vec<usize>,
    /// One weight a node, an area.
    pub weights: Vec<f64>,
    /// `d weights / d x`, row-major, one column a component; empty if the weights are fixed.
    pub derivative: Vec<f64>,
    /// [`Row::across`] of the normal that the facets make together.
    across: [bool; 3],
}

impl GapWeights {
    /// What is left of a direction beside the mirror images of the facets.
    fn within(&self, mut direction: Vector3<f64>) -> Vector3<f64> {
        (0..3).filter(|&i| self.across[i]).for_each(|i| direction[i] = 0.0);
        direction
    }
}

/// The weighted gap of one row at one configuration.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slot {
    /// Global nodes. Within a step nodes are only added.
    pub nodes: Vec<u32>,
    /// `int phi_A dA` over what counts as opposite; zero if the node has no partner.
    pub support: f64,
    /// `int phi_A dA` without the factors of the gap.
    pub opposite: f64,
    /// Weights of the nodes that are not negative and fade as a node leaves, an area each.
    pub positive: Vec<f64>,
    /// All facets together, with one normal.
    pub whole: GapWeights,
    /// One group a facet, for friction and [`Slot::by_facet`]; empty if not asked for.
    facets: Vec<GapWeights>,
    /// Whether each facet has its own normal, as on quadratic faces (theory/mortar#faces).
    by_facet: bool,
}

/// Value and derivatives of a weighted gap, by the components of [`Slot::nodes`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Evaluation {
    /// A volume.
    pub value: f64,
    pub gradient: Vec<f64>,
    /// [`Slot::support`], an area, and its gradient; empty if the weights are fixed.
    pub support: f64,
    pub support_gradient: Vec<f64>,
    /// The gradient at fixed weights, see [`Want::FixedWeights`].
    pub at_fixed_weights: Vec<f64>,
    /// Second derivative, see [`Want`], row-major; empty if not asked for.
    pub hessian: Vec<f64>,
}

impl Evaluation {
    /// The weighted gap beyond a distance, `int phi (gamma - distance) dA`, with its gradient; from what is the one beyond `from`.
    pub fn beyond(&mut self, distance: f64, from: f64) {
        let more = distance - from;
        self.value -= more * self.support;
        self.gradient.iter_mut().zip(&self.support_gradient).for_each(|(g, s)| *g -= more * s);
    }
}

/// What an evaluation of a weighted gap is to give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Want {
    /// Value and gradient.
    Gradient,
    /// The second derivative but for that of the weights, too.
    Hessian,
    /// The gradient at fixed weights, too.
    GradientAtFixedWeights,
    /// The gradient at fixed weights and its derivative, too.
    FixedWeights,
}

/// Where the nodes and corners of a facet and of the master facets opposite are in [`Slot::nodes`], in the order of [`FacetWeights`].
#[derive(Debug, Default)]
struct Map {
    nodes: Vec<usize>,
    corners: Vec<usize>,
    /// Number of nodes that are of the slave.
    slave_nodes: usize,
}

/// Part of the reference area by which the corners of a row's facets take part in [`Slot::positive`], covered or not: they turn the normal.
const CORNER_WEIGHT: f64 = 1e-3;

/// The direction of a vector, if it has one.
fn unit(c: Vector3<f64>) -> Option<Vector3<f64>> {
    c.try_normalize(0.0).filter(|n| n.iter().all(|n| n.is_finite()))
}

impl Slot {
    /// Gathers the weights of the facets of a row. `old` are nodes to keep in front.
    pub fn gather<'w>(
        row: &Row,
        surfaces: [&ContactSurface; 2],
        [slave_faces, master_faces]: [&Faces; 2],
        facets: &dyn Fn(u32) -> Option<&'w FacetWeights>,
        old: &[u32],
        with_facets: bool,
    ) -> Self {
        let [slave, master] = surfaces;
        let by_facet = !(slave_faces.are_linear() && master_faces.are_linear());
        let with_facets = with_facets || by_facet;
        let mut slot = Self { nodes: old.to_vec(), by_facet, ..Self::default() };
        // Nodes first, so that all arrays have their final size.
        let mut maps: Vec<Map> = Vec::new();
        for &(f, a) in &row.facets {
            let weights = facets(f);
            if let Some(w) = weights {
                slot.support += w.support[a];
                slot.opposite += w.opposite[a];
            }
            let mut map = Map::default();
            slot.add(slave_faces.nodes(slave, f), &slave.facets()[f as usize], &mut map);
            map.slave_nodes = map.nodes.len();
            for &m in weights.into_iter().flat_map(|w| &w.masters) {
                slot.add(master_faces.nodes(master, m), &master.facets()[m as usize], &mut map);
            }
            maps.push(map);
        }
        let nodes = slot.nodes.len();
        slot.positive = vec![0.0; nodes];
        let weights = vec![0.0; nodes];
        slot.whole = GapWeights { facet: row.facets[0].0, weights, across: row.across, ..GapWeights::default() };
        for (&(f, a), map) in row.facets.iter().zip(&maps) {
            let corners = Nodal::from_fn(slave.facets()[f as usize].kind(), |k| map.corners[k]);
            slot.whole.corners.push(corners);
            slot.whole.slave_nodes.extend(&map.nodes[..map.slave_nodes]);
            let mut own = GapWeights { facet: f, corners: vec![corners], ..GapWeights::default() };
            if with_facets {
                own.weights = vec![0.0; nodes];
            }
            let share = CORNER_WEIGHT * row.area / (corners.len() * maps.len()) as f64;
            corners.iter().for_each(|&k| slot.positive[k] += share);
            if let Some(w) = facets(f) {
                let count = w.node_count();
                for (k, &to) in map.nodes.iter().enumerate() {
                    let weight = w.weights[a * count + k];
                    slot.whole.weights[to] += weight;
                    slot.positive[to] += w.standard.get(a * count + k).map_or(weight.abs(), |s| s.abs());
                    if with_facets {
                        own.weights[to] += weight;
                    }
                }
                if !w.derivative.is_empty() {
                    for group in [Some(&mut slot.whole), with_facets.then_some(&mut own)].into_iter().flatten() {
                        group.add_derivative(w, a, map, nodes);
                    }
                }
            }
            if with_facets {
                slot.facets.push(own);
            }
        }
        slot
    }

    /// Adds the nodes and the corners of a facet, and notes where they are.
    fn add(&mut self, nodes: &[u32], corners: &[u32], map: &mut Map) {
        for (from, to) in [(nodes, &mut map.nodes), (corners, &mut map.corners)] {
            to.extend(from.iter().map(|&node| {
                self.nodes.iter().position(|&n| n == node).unwrap_or_else(|| {
                    self.nodes.push(node);
                    self.nodes.len() - 1
                })
            }));
        }
    }

    /// Adds nodes without weights to the stencil.
    pub fn widen(&mut self, nodes: &[u32]) {
        let before = self.nodes.len();
        for node in nodes {
            if !self.nodes.contains(node) {
                self.nodes.push(*node);
            }
        }
        let (old, new) = (3 * before, 3 * self.nodes.len());
        if old == new {
            return;
        }
        self.positive.resize(new / 3, 0.0);
        for group in std::iter::once(&mut self.whole).chain(&mut self.facets) {
            if !group.weights.is_empty() {
                group.weights.resize(new / 3, 0.0);
            }
            if !group.derivative.is_empty() {
                let mut wide = vec![0.0; new / 3 * new];
                for (to, from) in wide.chunks_exact_mut(new).zip(group.derivative.chunks_exact(old)) {
                    to[..old].copy_from_slice(from);
                }
                group.derivative = wide;
            }
        }
    }

    /// One group a slave facet.
    pub fn facets(&self) -> &[GapWeights] {
        &self.facets
    }

    /// Facets that have a normal together.
    fn groups(&self) -> &[GapWeights] {
        if self.by_facet { &self.facets } else { std::slice::from_ref(&self.whole) }
    }

    /// Gap vector, `c`, and the position that gap vectors are counted from: the weights add up to zero, so that it loses no digits.
    fn vectors(&self, group: &GapWeights, q: Positions<'_>) -> (Vector3<f64>, Vector3<f64>, Vector3<f64>) {
        let origin = q.of(self.nodes[0]);
        let weights = group.weights.iter().zip(&self.nodes).filter(|(w, _)| **w != 0.0);
        let gap = weights.map(|(w, &node)| (q.of(node) - origin) * *w).sum();
        let mut c = Vector3::zeros();
        for corners in &group.corners {
            c -= area_vector(&corners.map(|k| q.of(self.nodes[k])));
        }
        (gap, group.within(c), origin)
    }

    /// Unit normal at `q` from master to slave, zero if there is none.
    pub fn normal<'a>(&self, q: impl Into<Positions<'a>>) -> Vector3<f64> {
        self.vectors(&self.whole, q.into()).1.try_normalize(0.0).unwrap_or_default()
    }

    /// The weighted gap at `q`, a volume; `None` if the normals of the facets cancel.
    pub fn gap<'a>(&self, q: impl Into<Positions<'a>>) -> Option<f64> {
        let q = q.into();
        let gap_of = |group| {
            let (gap, c, _) = self.vectors(group, q);
            unit(c).map(|normal| normal.dot(&gap))
        };
        self.groups().iter().map(gap_of).sum()
    }

    /// Value, gradient and, if asked for, second derivative at `q`; `None` if the normals of the facets cancel. Arrays have the size of `nodes`
    /// nodes, at least those of the slot.
    pub fn evaluate<'a>(&self, q: impl Into<Positions<'a>>, nodes: usize, want: Want) -> Option<Evaluation> {
        let q = q.into();
        let columns = 3 * nodes;
        let mut out = Evaluation { gradient: vec![0.0; columns], support: self.support, ..Evaluation::default() };
        if !self.whole.derivative.is_empty() {
            out.support_gradient = vec![0.0; columns];
            self.for_each_support_derivative(|column, d| out.support_gradient[column] += d);
        }
        if matches!(want, Want::Hessian | Want::FixedWeights) {
            out.hessian = vec![0.0; columns * columns];
        }
        if matches!(want, Want::GradientAtFixedWeights | Want::FixedWeights) {
            out.at_fixed_weights = vec![0.0; columns];
        }
        for group in self.groups() {
            self.add_group(group, q, columns, want, &mut out)?;
        }
        Some(out)
    }

    /// Adds the part of facets with one normal; `None` if their normals cancel.
    fn add_group(
        &self,
        group: &GapWeights,
        q: Positions<'_>,
        columns: usize,
        want: Want,
        out: &mut Evaluation,
    ) -> Option<()> {
        let (gap, c, origin) = self.vectors(group, q);
        let length = c.norm();
        let n = unit(c)?;
        let value = n.dot(&gap);
        out.value += value;
        // d Phi = n . dg + b . dc
        let b = group.within(gap - n * value) / length;
        let own = 3 * self.nodes.len();
        let mut by_gap = self.by_gap_at_fixed_weights(group);
        if !group.derivative.is_empty() {
            for (row, &node) in group.derivative.chunks_exact(own).zip(&self.nodes) {
                let x = q.of(node) - origin;
                for (mut column, d) in by_gap.column_iter_mut().zip(row).filter(|(_, d)| **d != 0.0) {
                    column += x * *d;
                }
            }
        }
        let mut by_c = Matrix3xX::zeros(own);
        for corners in &group.corners {
            let [d_1, d_2] = diagonals(&corners.map(|k| q.of(self.nodes[k])));
            let turned = [d_2.cross_matrix(), -d_1.cross_matrix()];
            for (row, m) in corners.kind().diagonals().iter().zip(&turned) {
                for (&k, &sign) in corners.iter().zip(row).filter(|(_, c)| **c != 0.0) {
                    let mut block = by_c.fixed_columns_mut::<3>(3 * k);
                    block += m * sign;
                }
            }
        }
        (0..3).filter(|&i| group.across[i]).for_each(|i| by_c.row_mut(i).fill(0.0));
        for (k, g) in out.gradient[..own].iter_mut().enumerate() {
            *g += n.dot(&by_gap.column(k)) + b.dot(&by_c.column(k));
        }
        match want {
            Want::Gradient => {}
            Want::Hessian => {
                self.add_hessian(group, [n, b], value, length, [&by_gap, &by_gap, &by_c], columns, &mut out.hessian);
                self.add_motion_of_weights(group, n, true, columns, &mut out.hessian);
            }
            Want::GradientAtFixedWeights | Want::FixedWeights => {
                let held = self.by_gap_at_fixed_weights(group);
                for (k, g) in out.at_fixed_weights[..own].iter_mut().enumerate() {
                    *g += n.dot(&held.column(k)) + b.dot(&by_c.column(k));
                }
                if want == Want::FixedWeights {
                    self.add_hessian(group, [n, b], value, length, [&held, &by_gap, &by_c], columns, &mut out.hessian);
                    self.add_motion_of_weights(group, n, false, columns, &mut out.hessian);
                }
            }
        }
        Some(())
    }

    /// Derivative of the gap vector at fixed weights.
    fn by_gap_at_fixed_weights(&self, group: &GapWeights) -> Matrix3xX<f64> {
        let mut out = Matrix3xX::zeros(3 * self.nodes.len());
        for (k, &w) in group.weights.iter().enumerate() {
            (0..3).for_each(|i| out[(i, 3 * k + i)] += w);
        }
        out
    }

    /// Adds the derivative of `left^T n + C^T b`: `left` is the derivative of the gap vector in the force, at fixed weights or not.
    fn add_hessian(
        &self,
        group: &GapWeights,
        [n, b]: [Vector3<f64>; 2],
        value: f64,
        length: f64,
        [left, by_gap, by_c]: [&Matrix3xX<f64>; 3],
        columns: usize,
        out: &mut [f64],
    ) {
        let own = by_gap.ncols();
        let project = Matrix3::identity() - n * n.transpose();
        let mixed = project / length;
        let twice = -(project * (value / length) + n * b.transpose() + b * n.transpose()) / length;
        // left^T (mixed C) + C^T (mixed G + twice C), with G, C the derivatives of g and c.
        let of_gap = mixed * by_c;
        let of_c = mixed * by_gap + twice * by_c;
        for i in 0..own {
            let (g, c) = (left.column(i), by_c.column(i));
            let has_c = c.iter().any(|c| *c != 0.0);
            if !has_c && g.iter().all(|g| *g == 0.0) {
                continue;
            }
            let row = &mut out[i * columns..][..own];
            for (j, h) in row.iter_mut().enumerate() {
                let mut sum = g.dot(&of_gap.column(j));
                if has_c {
                    sum += c.dot(&of_c.column(j));
                }
                *h += sum;
            }
        }
        // b . d2c
        let turn = b.cross_matrix();
        for corners in &group.corners {
            let [by_1, by_2] = corners.kind().diagonals();
            for (&k, &f) in corners.iter().zip(&by_1).filter(|(_, f)| **f != 0.0) {
                for (&l, &g) in corners.iter().zip(&by_2).filter(|(_, g)| **g != 0.0) {
                    for i in 0..3 {
                        for j in 0..3 {
                            let value = f * g * turn[(i, j)];
                            out[(3 * k + i) * columns + 3 * l + j] += value;
                            out[(3 * l + j) * columns + 3 * k + i] += value;
                        }
                    }
                }
            }
        }
    }

    /// Adds `n . dw_k` to the rows of the nodes, if `both` to their columns, too.
    fn add_motion_of_weights(&self, group: &GapWeights, n: Vector3<f64>, both: bool, columns: usize, out: &mut [f64]) {
        let own = 3 * self.nodes.len();
        for (k, row) in group.derivative.chunks_exact(own).enumerate() {
            for (j, &d) in row.iter().enumerate().filter(|(_, d)| **d != 0.0) {
                for i in 0..3 {
                    out[(3 * k + i) * columns + j] += n[i] * d;
                    if both {
                        out[j * columns + 3 * k + i] += n[i] * d;
                    }
                }
            }
        }
    }

    /// Visits (component of the nodes, derivative of the support), if there are derivatives; a component may come more than once.
    pub fn for_each_support_derivative(&self, mut visit: impl FnMut(usize, f64)) {
        if self.whole.derivative.is_empty() {
            return;
        }
        let columns = 3 * self.nodes.len();
        let mut rows = self.whole.slave_nodes.clone();
        rows.sort_unstable();
        rows.dedup();
        // The weights of the slave's nodes add up to the support.
        for k in rows {
            for (column, &d) in self.whole.derivative[k * columns..][..columns].iter().enumerate() {
                visit(column, d);
            }
        }
    }

    /// Visits (argument, node, coefficient) of all coefficients of a group that are not zero: argument 0 is its gap vector, then come two diagonals a facet.
    pub fn for_each_coefficient(group: &GapWeights, mut visit: impl FnMut(usize, usize, f64)) {
        for (k, &w) in group.weights.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            visit(0, k, w);
        }
        for (f, corners) in group.corners.iter().enumerate() {
            for (d, row) in corners.kind().diagonals().iter().enumerate() {
                for (&k, &c) in corners.iter().zip(row).filter(|(_, c)| **c != 0.0) {
                    visit(1 + 2 * f + d, k, c);
                }
            }
        }
    }
}

impl GapWeights {
    fn add_derivative(&mut self, w: &FacetWeights, corner: usize, map: &Map, nodes: usize) {
        let (count, from_columns, columns) = (w.node_count(), 3 * w.corner_count(), 3 * nodes);
        self.derivative.resize(nodes * columns, 0.0);
        for (k, &row) in map.nodes.iter().enumerate() {
            let from = &w.derivative[(corner * count + k) * from_columns..][..from_columns];
            for (l, &column) in map.corners.iter().enumerate() {
                for c in 0..3 {
                    self.derivative[row * columns + 3 * column + c] += from[3 * l + c];
                }
            }
        }
    }
}
