//! Rows of constraints with the equations of the model: gradients on embedded nodes are handed to their carriers.

use crate::Embedding;

/// A row over the components of the model, each once, in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Row {
    /// Component (`3 * node + i`) and entry.
    pub entries: Vec<(u32, f64)>,
    /// Component and entry of the nodes that the constraint knows, if some of them are carried by others; else empty.
    of_nodes: Vec<(u32, f64)>,
}

impl Row {
    /// `factor` times a gradient: three entries for each of `nodes`.
    pub fn new(embedding: &Embedding, nodes: &[u32], gradient: &[f64], factor: f64) -> Self {
        let mut entries: Vec<(u32, f64)> = Vec::with_capacity(gradient.len());
        let mut of_nodes = Vec::new();
        if nodes.iter().any(|&node| embedding.carriers(node).is_some()) {
            let components = nodes.iter().flat_map(|&node| (0..3).map(move |i| 3 * node + i));
            of_nodes = components.zip(gradient).map(|(component, g)| (component, factor * g)).collect();
        }
        for (&node, g) in nodes.iter().zip(gradient.chunks_exact(3)) {
            let own = [(node, 1.0)];
            for &(carrier, weight) in embedding.carriers(node).unwrap_or(&own) {
                let of = g.iter().enumerate().filter(|(_, g)| **g != 0.0);
                entries.extend(of.map(|(i, g)| (3 * carrier + i as u32, factor * weight * g)));
            }
        }
        entries.sort_by_key(|entry| entry.0);
        entries.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        Self { entries, of_nodes }
    }

    /// Product of the row with a vector of the model.
    pub fn dot(&self, x: &[f64]) -> f64 {
        self.entries.iter().map(|&(c, g)| g * x[c as usize]).sum()
    }

    /// `out += factor` times the row.
    pub fn add_to(&self, factor: f64, out: &mut [f64]) {
        self.entries.iter().for_each(|&(c, g)| out[c as usize] += factor * g);
    }

    /// `out += factor` times the gradient at the nodes that the constraint knows.
    pub fn add_to_nodes(&self, factor: f64, out: &mut [f64]) {
        let entries = if self.of_nodes.is_empty() { &self.entries } else { &self.of_nodes };
        entries.iter().for_each(|&(c, g)| out[c as usize] += factor * g);
    }

    /// Components of the nodes that the constraint knows.
    pub fn components(&self) -> impl Iterator<Item = u32> + '_ {
        let entries = if self.of_nodes.is_empty() { &self.entries } else { &self.of_nodes };
        entries.iter().map(|entry| entry.0)
    }

    /// Euclidean norm of the row.
    pub fn norm(&self) -> f64 {
        self.entries.iter().map(|(_, g)| g * g).sum::<f64>().sqrt()
    }

    pub fn is_zero(&self) -> bool {
        self.entries.iter().all(|entry| entry.1 == 0.0)
    }
}
