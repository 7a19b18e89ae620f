//! Aggregates of nodes: greedy, in the order of the nodes, so that the same graph gives the same aggregates.

use super::bsr::Bsr;

/// The mark of a node without an aggregate: it is coupled with nothing, or has no mode.
pub(crate) const NONE: u32 = u32::MAX;

/// Which nodes are coupled, the diagonal left out.
pub(crate) struct Graph {
    starts: Vec<usize>,
    indices: Vec<u32>,
}

impl Graph {
    /// Couplings whose values are not all zero, between nodes of one label. (No threshold: aggregates of strong couplings alone were never better, on meshes stretched 1 to 20 and at
    /// a Poisson's ratio of 0.499, and what is left out may leave an indefinite matrix.)
    pub(crate) fn within<const B: usize>(a: &Bsr<f64, B, B>, labels: &[u32]) -> Self {
        let mut graph = Self { starts: vec![0], indices: Vec::new() };
        for i in 0..a.rows() {
            for (j, block) in a.row(i) {
                if j != i && labels[j] == labels[i] && block.as_flattened().iter().any(|v| *v != 0.0) {
                    graph.indices.push(j as u32);
                }
            }
            graph.starts.push(graph.indices.len());
        }
        graph
    }

    fn near<'a>(&'a self, i: usize, skip: &'a [bool]) -> impl Iterator<Item = usize> + 'a {
        self.indices[self.starts[i]..self.starts[i + 1]].iter().map(|&j| j as usize).filter(|&j| !skip[j])
    }
}

/// The aggregate of each node and how many there are; nodes to `skip` take no part.
pub(crate) fn aggregate(graph: &Graph, skip: &[bool]) -> (Vec<u32>, usize) {
    let n = skip.len();
    let mut of = vec![NONE; n];
    let mut count = 0u32;
    // Nodes whose whole neighbourhood is free, with it.
    for i in 0..n {
        let free = !skip[i]
            && of[i] == NONE
            && graph.near(i, skip).next().is_some()
            && graph.near(i, skip).all(|j| of[j] == NONE);
        if free {
            of[i] = count;
            graph.near(i, skip).for_each(|j| of[j] = count);
            count += 1;
        }
    }
    // The others join the one with which they have most couplings, among those of the first pass; the smallest number if there are several.
    let first = of.clone();
    let mut votes: Vec<(u32, u32)> = Vec::new();
    for i in (0..n).filter(|&i| !skip[i] && first[i] == NONE) {
        votes.clear();
        for aggregate in graph.near(i, skip).map(|j| first[j]).filter(|&aggregate| aggregate != NONE) {
            match votes.iter_mut().find(|vote| vote.0 == aggregate) {
                Some(vote) => vote.1 += 1,
                None => votes.push((aggregate, 1)),
            }
        }
        if let Some(&(aggregate, _)) = votes.iter().max_by(|x, y| x.1.cmp(&y.1).then(y.0.cmp(&x.0))) {
            of[i] = aggregate;
        }
    }
    // What is left makes its own.
    for i in 0..n {
        if skip[i] || of[i] != NONE {
            continue;
        }
        of[i] = count;
        for j in graph.near(i, skip) {
            if of[j] == NONE {
                of[j] = count;
            }
        }
        count += 1;
    }
    (of, count as usize)
}
