//! The tree of fronts: which groups are eliminated together, and in which order. On the graph of groups, without values and
//! without storage.
//!
//! Elimination tree and column counts after Liu (SIAM J. Matrix Anal. Appl. 11, 1990); a child is merged with its parent when that
//! costs few zeros, as in Ashcraft and Grimes (ACM Trans. Math. Softw. 15, 1989).

use super::ordering::Graph;
use crate::NONE;

/// `(w, z)`: a merged front of up to `w` eliminated equations may consist of zeros by the share `z`. Measured with
/// `benches/multifrontal.rs`: less merging makes small fronts that the dense kernels are bad at, more makes zeros.
const MERGE: [(usize, f64); 4] = [(12, 1.0), (32, 0.5), (96, 0.15), (usize::MAX, 0.03)];

/// One front of the tree; the tree is numbered so that children come before their parent and a subtree is contiguous.
#[derive(Debug, Clone, Default)]
pub(super) struct Node {
    /// Groups eliminated in this front, in order.
    pub groups: Vec<u32>,
    /// Groups of the remaining rows, in the order of their elimination.
    pub rows: Vec<u32>,
    /// The parent, [`NONE`] for a root.
    pub parent: u32,
    /// Number of equations of `groups` and of `rows`.
    pub eliminated: usize,
    pub remaining: usize,
}

/// The fronts for an elimination order of a graph whose vertex `g` has `weights[g]` equations.
pub(super) fn fronts(graph: &Graph, weights: &[usize], order: &[u32]) -> Vec<Node> {
    let n = graph.len();
    let mut rank = vec![0u32; n];
    order.iter().enumerate().for_each(|(k, &g)| rank[g as usize] = k as u32);
    let parent = elimination_tree(graph, order, &rank);
    // The same tree with children right before their parents, so that columns of equal structure are adjacent.
    let order: Vec<u32> = postorder(&parent).into_iter().map(|k| order[k as usize]).collect();
    order.iter().enumerate().for_each(|(k, &g)| rank[g as usize] = k as u32);
    let parent = elimination_tree(graph, &order, &rank);
    let counts = column_counts(graph, weights, &order, &rank, &parent);
    let merged = merge(weights, &order, &parent, &counts);
    number(graph, weights, &order, merged)
}

/// Vertices of a forest (parents have larger numbers) with children, in increasing order, right before their parent.
fn postorder(parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    // Linked lists of children; entry `n` is that of the roots.
    let (mut head, mut next) = (vec![NONE; n + 1], vec![NONE; n]);
    for k in (0..n).rev() {
        let p = if parent[k] == NONE { n } else { parent[k] as usize };
        next[k] = head[p];
        head[p] = k as u32;
    }
    let mut order = Vec::with_capacity(n);
    let mut stack = vec![n as u32];
    while let Some(&k) = stack.last() {
        let child = head[k as usize];
        if child == NONE {
            stack.pop();
            if (k as usize) < n {
                order.push(k);
            }
        } else {
            head[k as usize] = next[child as usize];
            stack.push(child);
        }
    }
    order
}

/// Parents by rank.
fn elimination_tree(graph: &Graph, order: &[u32], rank: &[u32]) -> Vec<u32> {
    let n = order.len();
    let mut parent = vec![NONE; n];
    let mut ancestor = vec![NONE; n];
    for k in 0..n as u32 {
        for &h in graph.neighbours(order[k as usize] as usize) {
            let mut i = rank[h as usize];
            while i < k {
                let next = ancestor[i as usize];
                ancestor[i as usize] = k;
                if next == NONE {
                    parent[i as usize] = k;
                    break;
                }
                i = next;
            }
        }
    }
    parent
}

/// Equations below each column of the factor, by rank.
fn column_counts(graph: &Graph, weights: &[usize], order: &[u32], rank: &[u32], parent: &[u32]) -> Vec<usize> {
    let n = order.len();
    let mut counts = vec![0; n];
    let mut mark = vec![NONE; n];
    for k in 0..n as u32 {
        let g = order[k as usize] as usize;
        mark[k as usize] = k;
        for &h in graph.neighbours(g) {
            let mut i = rank[h as usize];
            while i < k && mark[i as usize] != k {
                mark[i as usize] = k;
                counts[i as usize] += weights[g];
                i = parent[i as usize];
            }
        }
    }
    counts
}

/// A front before its numbering.
struct Merged {
    /// Ranks of the groups, increasing.
    ranks: Vec<u32>,
    /// Index of the parent, [`NONE`] for a root.
    parent: u32,
    eliminated: usize,
    remaining: usize,
}

/// Columns of equal structure, then children with their parents.
fn merge(weights: &[usize], order: &[u32], parent: &[u32], counts: &[usize]) -> Vec<Merged> {
    let n = order.len();
    let weight = |k: usize| weights[order[k] as usize];
    // Chains of columns of equal structure; `front[k]` is the chain of column `k`.
    let mut front = vec![0u32; n];
    let mut list: Vec<Merged> = Vec::new();
    for k in 0..n {
        let joins = k > 0 && parent[k - 1] == k as u32 && counts[k - 1] == counts[k] + weight(k);
        match list.last_mut() {
            Some(last) if joins => {
                last.ranks.push(k as u32);
                last.eliminated += weight(k);
                last.remaining = counts[k];
                last.parent = parent[k];
            }
            _ => list.push(Merged {
                ranks: vec![k as u32],
                parent: parent[k],
                eliminated: weight(k),
                remaining: counts[k],
            }),
        }
        front[k] = list.len() as u32 - 1;
    }
    for f in &mut list {
        if f.parent != NONE {
            f.parent = front[f.parent as usize];
        }
    }
    // Children come before parents, so that a parent has its final children when its own turn comes.
    let mut zeros = vec![0.0; list.len()];
    let mut into: Vec<u32> = (0..list.len() as u32).collect();
    for c in 0..list.len() {
        if list[c].parent == NONE {
            continue;
        }
        let p = list[c].parent as usize;
        let (w, wc) = (list[p].eliminated + list[c].eliminated, list[c].eliminated as f64);
        let height = list[p].eliminated + list[p].remaining;
        let z = zeros[c] + zeros[p] + wc * (height - list[c].remaining) as f64;
        let entries = 0.5 * (w * (w + 1)) as f64 + (w * list[p].remaining) as f64;
        if MERGE.iter().any(|&(limit, share)| w <= limit && z <= share * entries) {
            zeros[p] = z;
            list[p].eliminated = w;
            let ranks = std::mem::take(&mut list[c].ranks);
            list[p].ranks.extend(ranks);
            into[c] = p as u32;
        }
    }
    // A merged front's parent may itself have been merged later: parents have larger indices, so go down from the top.
    for c in (0..list.len()).rev() {
        into[c] = if into[c] == c as u32 { into[c] } else { into[into[c] as usize] };
    }
    let mut place = vec![NONE; list.len()];
    let mut next = 0;
    for c in 0..list.len() {
        if into[c] == c as u32 {
            place[c] = next;
            next += 1;
        }
    }
    let mut merged = Vec::with_capacity(next as usize);
    for (c, mut f) in list.into_iter().enumerate() {
        if into[c] == c as u32 {
            f.ranks.sort_unstable();
            f.parent = if f.parent == NONE { NONE } else { place[into[f.parent as usize] as usize] };
            merged.push(f);
        }
    }
    merged
}

/// Children first, in the order that needs the least memory (Liu, ACM Trans. Math. Softw. 12, 1986), and the rows of each front.
fn number(graph: &Graph, weights: &[usize], order: &[u32], merged: Vec<Merged>) -> Vec<Node> {
    let count = merged.len();
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); count + 1];
    for (c, f) in merged.iter().enumerate() {
        children[if f.parent == NONE { count } else { f.parent as usize }].push(c as u32);
    }
    let mut need = vec![0usize; count];
    let update = |c: u32| merged[c as usize].remaining * merged[c as usize].remaining;
    for f in 0..count {
        children[f].sort_by_key(|&c| (std::cmp::Reverse(need[c as usize] - update(c)), c));
        let mut held = 0;
        for &c in &children[f] {
            need[f] = need[f].max(held + need[c as usize]);
            held += update(c);
        }
        need[f] = need[f].max(held + update(f as u32));
    }
    let mut postorder = Vec::with_capacity(count);
    let mut stack: Vec<(u32, usize)> = vec![(count as u32, 0)];
    while let Some((f, next)) = stack.pop() {
        if let Some(&c) = children[f as usize].get(next) {
            stack.push((f, next + 1));
            stack.push((c, 0));
        } else if (f as usize) < count {
            postorder.push(f);
        }
    }
    let mut new_index = vec![0u32; count];
    postorder.iter().enumerate().for_each(|(k, &f)| new_index[f as usize] = k as u32);
    let mut nodes: Vec<Node> = Vec::with_capacity(count);
    // Final rank of each group, and the children's rows.
    let mut final_rank = vec![0u32; order.len()];
    let mut next = 0;
    for &f in &postorder {
        for &k in &merged[f as usize].ranks {
            final_rank[order[k as usize] as usize] = next;
            next += 1;
        }
    }
    let mut mark = vec![NONE; order.len()];
    for (k, &f) in postorder.iter().enumerate() {
        let m = &merged[f as usize];
        let groups: Vec<u32> = m.ranks.iter().map(|&k| order[k as usize]).collect();
        groups.iter().for_each(|&g| mark[g as usize] = k as u32);
        let last = final_rank[groups[groups.len() - 1] as usize];
        let mut rows = Vec::new();
        let mut add = |g: u32| {
            if final_rank[g as usize] > last && mark[g as usize] != k as u32 {
                mark[g as usize] = k as u32;
                rows.push(g);
            }
        };
        groups.iter().flat_map(|&g| graph.neighbours(g as usize)).for_each(|&h| add(h as u32));
        for &c in &children[f as usize] {
            nodes[new_index[c as usize] as usize].rows.iter().for_each(|&g| add(g));
        }
        rows.sort_unstable_by_key(|&g| final_rank[g as usize]);
        let size = |list: &[u32]| list.iter().map(|&g| weights[g as usize]).sum();
        nodes.push(Node {
            eliminated: size(&groups),
            remaining: size(&rows),
            groups,
            rows,
            parent: if m.parent == NONE { NONE } else { new_index[m.parent as usize] },
        });
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Structure of the factor by elimination on sets: `below[k]` are the ranks coupled with rank `k` when it is eliminated.
    fn eliminate(graph: &Graph, order: &[u32]) -> Vec<Vec<bool>> {
        let n = order.len();
        let mut full = vec![vec![false; n]; n];
        for i in 0..n {
            for j in 0..n {
                full[i][j] = graph.neighbours(order[i] as usize).contains(&(order[j] as i32));
            }
        }
        for k in 0..n {
            for i in k + 1..n {
                for j in k + 1..n {
                    full[i][j] |= full[i][k] && full[k][j];
                }
            }
        }
        full
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

        /// Every front holds all rows that elimination couples with its columns, in the tree's own order; each group is
        /// eliminated once; children precede parents, which hold their rows.
        #[test]
        fn fronts_hold_the_fill(edges in proptest::collection::vec((0usize..24, 0usize..24), 0..60), n in 1usize..24) {
            let mut full = vec![vec![false; n]; n];
            for (i, j) in edges {
                if i != j && i < n && j < n {
                    (full[i][j], full[j][i]) = (true, true);
                }
            }
            let (mut starts, mut neighbours) = (vec![0], Vec::new());
            for row in &full {
                neighbours.extend((0..n as i32).filter(|&j| row[j as usize]));
                starts.push(neighbours.len() as i32);
            }
            let graph = Graph { starts, neighbours };
            let weights: Vec<usize> = (0..n).map(|i| 1 + i % 4).collect();
            let order: Vec<u32> = (0..n as u32).rev().collect();
            let nodes = fronts(&graph, &weights, &order);
            let final_order: Vec<u32> = nodes.iter().flat_map(|f| f.groups.iter().copied()).collect();
            let mut sorted = final_order.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (0..n as u32).collect::<Vec<_>>());
            let filled = eliminate(&graph, &final_order);
            let rank = |g: u32| final_order.iter().position(|&h| h == g).unwrap();
            for (k, f) in nodes.iter().enumerate() {
                let all: Vec<usize> = f.groups.iter().chain(&f.rows).map(|&g| rank(g)).collect();
                prop_assert!(all.windows(2).all(|p| p[0] < p[1]));
                for &g in &f.groups {
                    for i in rank(g) + 1..n {
                        prop_assert!(!filled[i][rank(g)] || all.contains(&i));
                    }
                }
                if f.parent == NONE {
                    prop_assert!(f.rows.is_empty());
                } else {
                    let p = &nodes[f.parent as usize];
                    prop_assert!(f.parent as usize > k);
                    prop_assert!(f.rows.iter().all(|g| p.groups.contains(g) || p.rows.contains(g)));
                }
            }
        }
    }
}
