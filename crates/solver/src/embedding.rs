//! Embedded nodes: nodes without equations, whose positions are linear combinations of those of other nodes.

use std::ops::Range;

/// The mark of a node that is not embedded.
const NONE: u32 = u32::MAX;

/// Nodes whose positions are `x_a = sum_j w_aj q_j` with constant weights and other nodes as carriers: the surface of a rigid body, for instance.
///
/// Contact and loads act on them like on other nodes. Their positions and velocities follow the carriers; forces and tangents are transferred to the carriers with the same
/// weights, so that work and moments are the same.
///
/// A surface may have many more nodes than a step uses: what is done in each iteration passes over the nodes that contact uses, and over those whose carriers moved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Embedding {
    /// Place in `starts` of each node of the model, [`NONE`] of those that are not embedded.
    index: Vec<u32>,
    nodes: Vec<u32>,
    starts: Vec<u32>,
    terms: Vec<(u32, f64)>,
    groups: Vec<Group>,
}

/// Embedded nodes in a row that have their first carrier in common: a surface, mostly.
#[derive(Clone, Debug, PartialEq)]
struct Group {
    carriers: Vec<u32>,
    /// Places in `starts`.
    members: Range<usize>,
}

/// What the carriers had when their nodes followed them last.
#[derive(Clone, Debug, Default)]
pub(crate) struct Followed(Vec<f64>);

impl Embedding {
    /// Adds a node with its carriers and their weights; carriers are not embedded themselves, and each is given once.
    pub fn add(&mut self, node: u32, carriers: &[(u32, f64)]) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        let k = self.nodes.len();
        let size = self.index.len().max(node as usize + 1);
        self.index.resize(size, NONE);
        self.index[node as usize] = k as u32;
        self.nodes.push(node);
        self.terms.extend_from_slice(carriers);
        self.starts.push(self.terms.len() as u32);
        let first = carriers.first().map(|c| c.0);
        match self.groups.last_mut().filter(|group| group.carriers.first().copied() == first) {
            Some(group) => {
                group.members.end = k + 1;
                for &(carrier, _) in carriers {
                    if !group.carriers.contains(&carrier) {
                        group.carriers.push(carrier);
                    }
                }
            }
            None => {
                self.groups.push(Group { carriers: carriers.iter().map(|c| c.0).collect(), members: k..k + 1 });
            }
        }
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The embedded nodes.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Carriers and weights of a node, if it is embedded.
    pub fn carriers(&self, node: u32) -> Option<&[(u32, f64)]> {
        self.place(node).map(|k| self.carriers_of(k))
    }

    fn place(&self, node: u32) -> Option<usize> {
        self.index.get(node as usize).filter(|&&k| k != NONE).map(|&k| k as usize)
    }

    fn carriers_of(&self, k: usize) -> &[(u32, f64)] {
        &self.terms[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// Whether a node is embedded.
    pub(crate) fn has(&self, node: u32) -> bool {
        self.place(node).is_some()
    }

    /// Components of nodes that are not embedded, of so many, in ascending runs.
    pub(crate) fn own(&self, components: usize) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        let rest = 3 * self.index.len()..components.max(3 * self.index.len());
        let single = (0..self.index.len()).filter(|&n| self.index[n] == NONE).map(|n| 3 * n..3 * n + 3);
        for run in single.chain([rest]).filter(|run| !run.is_empty()) {
            match runs.last_mut().filter(|last| last.end == run.start) {
                Some(last) => last.end = run.end,
                None => runs.push(run),
            }
        }
        runs
    }

    /// Computes the embedded nodes of a vector of the model (positions, increments, velocities) from their carriers; an empty vector is left as it is.
    pub fn follow(&self, x: &mut [f64]) {
        if x.is_empty() {
            return;
        }
        self.follow_places(0..self.nodes.len(), x);
    }

    fn follow_places(&self, places: Range<usize>, x: &mut [f64]) {
        for k in places {
            let node = self.nodes[k];
            let mut sum = [0.0; 3];
            for &(carrier, weight) in self.carriers_of(k) {
                let first = 3 * carrier as usize;
                for (s, x) in sum.iter_mut().zip(&x[first..first + 3]) {
                    *s += weight * x;
                }
            }
            x[3 * node as usize..3 * node as usize + 3].copy_from_slice(&sum);
        }
    }

    /// What the carriers have in a vector that the embedded nodes have followed.
    pub(crate) fn followed(&self, x: &[f64]) -> Followed {
        let carriers = self.groups.iter().flat_map(|group| &group.carriers);
        Followed(carriers.flat_map(|&c| &x[3 * c as usize..3 * c as usize + 3]).copied().collect())
    }

    /// [`Self::follow`] of the surfaces whose carriers have something else than they had.
    pub(crate) fn follow_changes(&self, x: &mut [f64], followed: &mut Followed) {
        let mut seen = followed.0.chunks_exact_mut(3);
        for group in &self.groups {
            let mut changed = false;
            for &carrier in &group.carriers {
                let (Some(seen), first) = (seen.next(), 3 * carrier as usize) else { return self.follow(x) };
                let now = &x[first..first + 3];
                changed |= seen.iter().zip(now).any(|(a, b)| a.to_bits() != b.to_bits());
                seen.copy_from_slice(now);
            }
            if changed {
                self.follow_places(group.members.clone(), x);
            }
        }
    }

    /// Moves forces on embedded nodes to their carriers.
    pub(crate) fn pull_back(&self, force: &mut [f64]) {
        self.pull_back_of(&self.nodes, force);
    }

    /// [`Self::pull_back`] if no others than these embedded nodes have forces.
    pub(crate) fn pull_back_of(&self, nodes: &[u32], force: &mut [f64]) {
        for &node in nodes {
            let at = 3 * node as usize;
            let f = [force[at], force[at + 1], force[at + 2]];
            if f == [0.0; 3] {
                continue;
            }
            force[at..at + 3].fill(0.0);
            for &(carrier, weight) in self.carriers(node).unwrap_or_default() {
                let first = 3 * carrier as usize;
                force[first..first + 3].iter_mut().zip(f).for_each(|(c, f)| *c += weight * f);
            }
        }
    }

    /// The largest length of the vectors (velocities) of all nodes.
    pub(crate) fn largest_of(&self, own: &[Range<usize>], x: &[f64]) -> f64 {
        let length = |v: &[f64]| v[0].hypot(v[1]).hypot(v[2]);
        let mut largest = own.iter().flat_map(|own| x[own.clone()].chunks_exact(3)).map(length).fold(0.0, f64::max);
        for group in &self.groups {
            let at = |node: u32| &x[3 * node as usize..3 * node as usize + 3];
            if group.carriers.iter().any(|&carrier| at(carrier) != [0.0; 3]) {
                // The root only of those that may be the largest.
                let square = |v: &[f64]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
                let nodes = || self.nodes[group.members.clone()].iter().map(|&node| at(node));
                let nearly = (1.0 - 1e-12) * nodes().map(square).fold(0.0, f64::max);
                largest = nodes().filter(|v| square(v) >= nearly).map(length).fold(largest, f64::max);
            }
        }
        largest
    }

    /// The nodes that have the equations of a list of nodes: carriers in place of the embedded ones, each once.
    pub(crate) fn expand(&self, nodes: &[u32], out: &mut Vec<u32>) {
        out.clear();
        let mut add = |node: u32| {
            if !out.contains(&node) {
                out.push(node);
            }
        };
        for &node in nodes {
            match self.carriers(node) {
                Some(carriers) => carriers.iter().for_each(|&(carrier, _)| add(carrier)),
                None => add(node),
            }
        }
    }

    /// True if one of the nodes is embedded.
    pub(crate) fn touches(&self, nodes: &[u32]) -> bool {
        !self.is_empty() && nodes.iter().any(|&node| self.has(node))
    }

    /// True if all of the nodes are embedded.
    pub(crate) fn has_all(&self, nodes: &[u32]) -> bool {
        nodes.iter().all(|&node| self.has(node))
    }

    /// A local matrix over the components of `nodes` and `rest` further unknowns as one over those of `expanded` ([`Self::expand`]) and the same
    /// further ones: `T^T K T`, row-major.
    pub(crate) fn transform(&self, nodes: &[u32], expanded: &[u32], rest: usize, k: &[f64], work: &mut Transform) {
        work.terms.clear();
        work.starts.clear();
        work.starts.push(0);
        let place = |carrier: u32| expanded.iter().position(|&n| n == carrier).unwrap_or(0);
        for &node in nodes {
            match self.carriers(node) {
                Some(carriers) => work.terms.extend(carriers.iter().map(|&(c, w)| (place(c), w))),
                None => work.terms.push((place(node), 1.0)),
            }
            work.starts.push(work.terms.len());
        }
        let (old, new) = (3 * nodes.len() + rest, 3 * expanded.len() + rest);
        work.half.clear();
        work.half.resize(old * new, 0.0);
        // Columns first, then rows.
        for (row, out) in k.chunks_exact(old).zip(work.half.chunks_exact_mut(new)) {
            for (a, range) in work.starts.windows(2).enumerate() {
                for &(place, weight) in &work.terms[range[0]..range[1]] {
                    for i in 0..3 {
                        out[3 * place + i] += weight * row[3 * a + i];
                    }
                }
            }
            out[3 * expanded.len()..].copy_from_slice(&row[3 * nodes.len()..]);
        }
        work.matrix.clear();
        work.matrix.resize(new * new, 0.0);
        for (a, range) in work.starts.windows(2).enumerate() {
            for &(place, weight) in &work.terms[range[0]..range[1]] {
                for i in 0..3 {
                    let from = &work.half[(3 * a + i) * new..(3 * a + i + 1) * new];
                    let to = &mut work.matrix[(3 * place + i) * new..(3 * place + i + 1) * new];
                    to.iter_mut().zip(from).for_each(|(t, f)| *t += weight * f);
                }
            }
        }
        let (from, to) = (3 * nodes.len() * new, 3 * expanded.len() * new);
        work.matrix[to..].copy_from_slice(&work.half[from..]);
    }
}

/// Work space and result of [`Embedding::transform`].
#[derive(Debug, Default)]
pub(crate) struct Transform {
    starts: Vec<usize>,
    terms: Vec<(usize, f64)>,
    half: Vec<f64>,
    /// Row-major.
    pub matrix: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Force and tangent of `1/2 |x_a - x_b|^2 p` on embedded nodes are those of the same function of the carriers: differences of the energy say so.
    #[test]
    fn forces_and_tangents_reach_the_carriers() {
        let mut embedding = Embedding::default();
        embedding.add(3, &[(0, 1.0), (1, 0.5), (2, -0.25)]);
        let mut q: Vec<f64> = (0..12).map(|i| 0.3 * f64::from(i).sin() + 0.1).collect();
        embedding.follow(&mut q);
        let energy = |q: &[f64]| {
            let mut q = q.to_vec();
            embedding.follow(&mut q);
            (0..3).map(|i| 0.5 * (q[9 + i] - q[3 + i]).powi(2)).sum::<f64>()
        };
        let mut force = vec![0.0; 12];
        for i in 0..3 {
            force[9 + i] = q[9 + i] - q[3 + i];
            force[3 + i] = -force[9 + i];
        }
        embedding.pull_back(&mut force);
        let h = 1e-4;
        let mut at = |c: usize, d: usize| {
            let mut shifted = |a: f64, b: f64| {
                q[c] += a;
                q[d] += b;
                let e = energy(&q);
                q[c] -= a;
                q[d] -= b;
                e
            };
            let gradient = (shifted(h, 0.0) - shifted(-h, 0.0)) / (2.0 * h);
            let second = (shifted(h, h) - shifted(h, -h) - shifted(-h, h) + shifted(-h, -h)) / (4.0 * h * h);
            (gradient, second)
        };
        let nodes = [3, 1];
        let mut expanded = Vec::new();
        embedding.expand(&nodes, &mut expanded);
        assert_eq!(expanded, [0, 1, 2]);
        let mut k = vec![0.0; 49];
        for i in 0..3 {
            k[7 * i + i] = 1.0;
            k[7 * (3 + i) + 3 + i] = 1.0;
            k[7 * i + 3 + i] = -1.0;
            k[7 * (3 + i) + i] = -1.0;
        }
        k[48] = 7.0;
        k[6] = 2.0;
        let mut work = Transform::default();
        embedding.transform(&nodes, &expanded, 1, &k, &mut work);
        for c in 0..9 {
            assert!((at(c, c).0 - force[c]).abs() < 1e-9);
            for d in (0..9).filter(|&d| d != c) {
                assert!((at(c, d).1 - work.matrix[10 * c + d]).abs() < 1e-6, "{c} {d}");
            }
        }
        assert_eq!((work.matrix[99], work.matrix[9], work.matrix[39]), (7.0, 2.0, 1.0));
    }

    /// Two surfaces on three carriers each, with nodes of solids before, between and behind them.
    fn two_surfaces() -> Embedding {
        let mut embedding = Embedding::default();
        for (first, carrier) in [(4, 1), (9, 12)] {
            for k in 0..3 {
                // A weight of zero is left out, as at a node in a plane of symmetry.
                let weights = [(carrier, 1.0), (carrier + 1, 0.5 * f64::from(k)), (carrier + 2, -0.3)];
                let carriers: Vec<(u32, f64)> = weights.into_iter().filter(|&(_, w)| w != 0.0).collect();
                embedding.add(first + k, &carriers);
            }
        }
        embedding
    }

    #[test]
    fn only_surfaces_whose_carriers_moved_follow() {
        let embedding = two_surfaces();
        assert_eq!(embedding.own(54), [0..12, 21..27, 36..54]);
        assert_eq!(Embedding::default().own(54), std::iter::once(0..54).collect::<Vec<_>>());
        let mut q: Vec<f64> = (0..54).map(|i| (0.7 * f64::from(i)).sin()).collect();
        embedding.follow(&mut q);
        let mut followed = embedding.followed(&q);
        // A mark on each surface shows whether it was renewed.
        for (moved, renewed) in [(0, [false, false]), (3 * 2 + 1, [true, false]), (3 * 14, [false, true])] {
            (q[12], q[27]) = (77.0, 77.0);
            q[moved] += 1e-3;
            embedding.follow_changes(&mut q, &mut followed);
            assert_eq!([q[12] != 77.0, q[27] != 77.0], renewed, "{moved}");
            embedding.follow(&mut q);
        }
        let mut never = Followed::default();
        q[12] = 77.0;
        embedding.follow_changes(&mut q, &mut never);
        assert!(q[12] != 77.0);
    }

    #[test]
    fn forces_on_some_nodes_go_the_same_way_as_all() {
        let embedding = two_surfaces();
        let mut all = vec![0.0; 54];
        (all[13], all[32], all[40]) = (1.5, -0.25, 3.0);
        let mut some = all.clone();
        embedding.pull_back(&mut all);
        embedding.pull_back_of(&[4, 10], &mut some);
        assert_eq!(all, some);
        assert!(all[13] == 0.0 && all[32] == 0.0 && all[40] != 0.0);
        let mut v = vec![0.0; 54];
        v[3 * 13] = -2.0;
        embedding.follow(&mut v);
        let expected = v.chunks_exact(3).map(|v| v[0].hypot(v[1]).hypot(v[2])).fold(0.0, f64::max);
        assert_eq!(embedding.largest_of(&embedding.own(54), &v), expected);
    }
}
