//! A row of nodes as the slave side of a contact: a string, the axis of a beam.

use crate::{ContactError, position};

/// Nodes in a row, each with the share of the reference length that belongs to it, so that a pressure is a force per length.
///
/// It has no outside: its nodes may touch from any side. It is no master, for it has no facets.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactLine {
    nodes: Vec<u32>,
    lengths: Vec<f64>,
    /// Reference distance of each node from the next one.
    spans: Vec<f64>,
}

impl ContactLine {
    /// The line from global nodes in their order along it, ascending, their tributary lengths (`int N_a ds` over the reference line, positive), and the
    /// reference coordinates of all nodes (`3 * nodes`).
    ///
    /// # Errors
    /// [`ContactError::EmptySurface`], [`ContactError::MissingNode`], [`ContactError::NotFinite`], [`ContactError::Line`] for lengths that are not positive, not as many
    /// as nodes, and for nodes that are not in order.
    pub fn new(nodes: &[u32], lengths: &[f64], reference: &[f64]) -> Result<Self, ContactError> {
        if nodes.is_empty() {
            return Err(ContactError::EmptySurface { side: "slave" });
        }
        let fault = |reason: String| Err(ContactError::Line { reason });
        if lengths.len() != nodes.len() {
            return fault(format!("{} lengths for {} nodes", lengths.len(), nodes.len()));
        }
        let count = reference.len() / 3;
        for (k, (&node, &length)) in nodes.iter().zip(lengths).enumerate() {
            if node as usize >= count {
                return Err(ContactError::MissingNode { facet: k as u32, node, count });
            }
            if !position(reference, node).iter().all(|c| c.is_finite()) {
                return Err(ContactError::NotFinite { node });
            }
            if !(length > 0.0 && length.is_finite()) {
                return fault(format!("node {node} has the length {length:e}"));
            }
        }
        if nodes.windows(2).any(|pair| pair[0] >= pair[1]) {
            return fault("its nodes are not in ascending order".to_owned());
        }
        let spans = spans(nodes, reference);
        if spans.contains(&0.0) {
            return fault("two nodes that follow each other are in one place".to_owned());
        }
        Ok(Self { nodes: nodes.to_vec(), lengths: lengths.to_vec(), spans })
    }

    /// Global numbers of the nodes, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Tributary length of each node in the reference configuration.
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Tributary length of each node at positions `q`: the reference length, stretched as the distances to the neighbours are.
    pub fn lengths_at(&self, q: &[f64]) -> Vec<f64> {
        let now = spans(&self.nodes, q);
        let around = |spans: &[f64], k: usize| spans[k.saturating_sub(1)..spans.len().min(k + 1)].iter().sum::<f64>();
        let stretched = self.lengths.iter().enumerate().map(|(k, length)| match around(&self.spans, k) {
            reference if reference > 0.0 => length * around(&now, k) / reference,
            _ => *length,
        });
        stretched.collect()
    }

    /// Mean tributary length.
    pub fn length_scale(&self) -> f64 {
        self.lengths.iter().sum::<f64>() / self.lengths.len() as f64
    }
}

fn spans(nodes: &[u32], q: &[f64]) -> Vec<f64> {
    nodes.windows(2).map(|pair| (position(q, pair[1]) - position(q, pair[0])).norm()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_follow_the_stretch_of_the_spans_beside_a_node() {
        let reference = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 9.0, 9.0, 9.0];
        let line = ContactLine::new(&[0, 1, 2], &[0.5, 1.5, 1.0], &reference).unwrap();
        assert_eq!((line.lengths_at(&reference), line.length_scale()), (vec![0.5, 1.5, 1.0], 1.0));
        // The second span is twice as long: the node in the middle has 5/3 of the sum of both.
        let stretched = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 0.0];
        assert_eq!(line.lengths_at(&stretched), [0.5, 2.5, 2.0]);
        assert_eq!(ContactLine::new(&[3], &[0.2], &reference).unwrap().lengths_at(&stretched), [0.2]);
    }

    #[test]
    fn lines_that_are_none_are_refused() {
        let reference = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let of = |nodes: &[u32], lengths: &[f64]| ContactLine::new(nodes, lengths, &reference).unwrap_err();
        assert!(matches!(of(&[], &[]), ContactError::EmptySurface { .. }));
        assert!(matches!(of(&[0, 7], &[1.0, 1.0]), ContactError::MissingNode { node: 7, .. }));
        for (nodes, lengths) in
            [(&[0, 1][..], &[1.0][..]), (&[0, 1], &[1.0, 0.0]), (&[1, 0], &[1.0, 1.0]), (&[1, 2], &[1.0, 1.0])]
        {
            assert!(matches!(of(nodes, lengths), ContactError::Line { .. }), "{nodes:?}");
        }
    }
}
