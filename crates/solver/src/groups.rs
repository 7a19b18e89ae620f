//! Which equations a factorisation keeps together.

use crate::Model;
use crate::contributions::Contributions;

/// Labels of the vectors that a linear solver keeps together: of those that parts own their cluster, else the vector itself.
#[derive(Debug)]
pub(crate) struct Groups {
    /// Clusters of the vectors that parts own, from the first of them on.
    clusters: Vec<u32>,
    first: u32,
}

impl Groups {
    pub fn new(model: &Model) -> Self {
        let first = model.parts.iter().map(|part| part.own_vectors().start).min().unwrap_or(u32::MAX);
        let last = model.parts.iter().map(|part| part.own_vectors().end).max().unwrap_or(0);
        let mut clusters: Vec<u32> = (first.min(last)..last).collect();
        for part in &model.parts {
            for vector in part.own_vectors() {
                clusters[(vector - first) as usize] = part.cluster(vector);
            }
        }
        Self { clusters, first }
    }

    pub fn label(&self, node: u32) -> u32 {
        node.checked_sub(self.first).and_then(|k| self.clusters.get(k as usize)).copied().unwrap_or(node)
    }

    /// Puts clusters together that joints connect, as long as one has more multipliers than unknowns: a crank between two joints has not enough freedom for its own constraints and those of both,
    /// and no order of elimination would find pivots for them in it. Solids are left alone: there the values decide which node a multiplier is eliminated with.
    ///
    /// `labels` of all equations, those of multipliers from `free` on.
    pub fn relieve(&self, labels: &mut [u32], free: usize, contributions: &Contributions) {
        let place = |label: u32| label.checked_sub(self.first).map(|k| k as usize).filter(|&k| k < self.clusters.len());
        let mut sets = Sets { parent: (0..self.clusters.len()).collect(), missing: vec![0; self.clusters.len()] };
        for (equation, &label) in labels.iter().enumerate() {
            if let Some(k) = place(label) {
                sets.missing[k] += if equation < free { -1 } else { 1 };
            }
        }
        if sets.missing.iter().all(|&missing| missing <= 0) {
            return;
        }
        let joints: Vec<Vec<usize>> = contributions
            .iter()
            .map(|(_, nodes, _)| nodes.iter().filter_map(|&node| place(self.label(node))).collect())
            .collect();
        while joints.iter().any(|joint: &Vec<usize>| sets.join_if_one_is_short(joint)) {}
        for label in labels {
            if let Some(k) = place(*label) {
                *label = self.first + sets.root(k) as u32;
            }
        }
    }
}

/// Clusters put together.
struct Sets {
    parent: Vec<usize>,
    /// Multipliers that have no unknown of their own, of the first cluster of a set; negative where unknowns are left.
    missing: Vec<i64>,
}

impl Sets {
    fn root(&self, mut k: usize) -> usize {
        while self.parent[k] != k {
            k = self.parent[k];
        }
        k
    }

    /// Joins the first two sets of a list of which one has more multipliers than unknowns. Whether there are any.
    fn join_if_one_is_short(&mut self, clusters: &[usize]) -> bool {
        let Some(first) = clusters.first().map(|&k| self.root(k)) else { return false };
        let Some(other) = clusters.iter().map(|&k| self.root(k)).find(|&k| k != first) else { return false };
        if self.missing[first] <= 0 && self.missing[other] <= 0 {
            return false;
        }
        let (to, from) = (first.min(other), first.max(other));
        self.parent[from] = to;
        self.missing[to] += self.missing[from];
        true
    }
}
