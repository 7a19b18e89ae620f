//! Nested dissection of a graph. The only place where the ordering library (feral-metis, multilevel bisection in pure Rust)
//! appears.

use crate::LinalgError;

/// An undirected graph: the neighbours of vertex `v` are `neighbours[starts[v]..starts[v + 1]]`, increasing, without `v` itself.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Graph {
    pub starts: Vec<i32>,
    pub neighbours: Vec<i32>,
}

impl Graph {
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    pub fn neighbours(&self, v: usize) -> &[i32] {
        &self.neighbours[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

/// An elimination order of small fill: entry `k` is the vertex eliminated as the `k`-th. A function of the graph alone (fixed seed).
///
/// # Errors
/// [`LinalgError::Backend`] if the library refuses or returns no permutation.
pub(super) fn nested_dissection(graph: &Graph) -> Result<Vec<u32>, LinalgError> {
    let n = graph.len();
    let failed = |message: String| LinalgError::Backend { operation: "nested dissection", message };
    let pattern = feral_metis::CscPattern::new(n, &graph.starts, &graph.neighbours)
        .ok_or_else(|| failed("malformed graph".into()))?;
    let order = feral_metis::metis_order(&pattern).map_err(|e| failed(format!("{e:?}")))?;
    let mut seen = vec![false; n];
    for &v in &order {
        match usize::try_from(v).ok().and_then(|v| seen.get_mut(v)) {
            Some(seen) if !*seen => *seen = true,
            _ => return Err(failed("not a permutation".into())),
        }
    }
    if order.len() != n {
        return Err(failed("not a permutation".into()));
    }
    Ok(order.into_iter().map(|v| v as u32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_is_permuted() {
        let m = 40;
        let (mut starts, mut neighbours) = (vec![0], Vec::new());
        for v in 0..m * m {
            let (i, j) = (v % m, v / m);
            for (p, q) in [(i, j - 1), (i - 1, j), (i + 1, j), (i, j + 1)] {
                if (0..m).contains(&p) && (0..m).contains(&q) {
                    neighbours.push(p + m * q);
                }
            }
            starts.push(neighbours.len() as i32);
        }
        let graph = Graph { starts, neighbours };
        let order = nested_dissection(&graph).unwrap();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(k, &v)| v as usize == k));
        assert_eq!(order, nested_dissection(&graph).unwrap());
    }

    #[test]
    fn no_vertices_and_no_edges() {
        assert_eq!(nested_dissection(&Graph { starts: vec![0], neighbours: vec![] }).unwrap(), Vec::<u32>::new());
        let mut order = nested_dissection(&Graph { starts: vec![0; 4], neighbours: vec![] }).unwrap();
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2]);
    }
}
