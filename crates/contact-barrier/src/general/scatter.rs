//! Forces from the points of contacts to nodes in two stages: the vertices of some facets first, for all that acts between these, and then once to the nodes.

use super::joint::Joint;
use crate::Skin;
use stoss_term::Local;

/// Residual and tangent at the vertices of some facets.
#[derive(Debug, Default)]
pub(super) struct Scatter {
    vertices: Vec<u32>,
    residual: Vec<f64>,
    tangent: Vec<f64>,
    /// Rows of vertices, columns of nodes.
    half: Vec<f64>,
    /// Vertices of the points of a contact, by their first rows, with their shares, and where those of each point begin.
    corners: Vec<(usize, f64)>,
    starts: Vec<usize>,
    has_tangent: bool,
    is_empty: bool,
}

impl Scatter {
    /// Begins with nothing at the vertices of these facets.
    pub fn begin(&mut self, skin: &Skin, facets: &[u32], has_tangent: bool) {
        let Self { vertices, residual, tangent, .. } = self;
        vertices.clear();
        let triangles = facets.iter().flat_map(|&f| skin.triangles_of(f));
        vertices.extend(triangles.flat_map(|&t| skin.triangles()[t as usize]));
        vertices.sort_unstable();
        vertices.dedup();
        let m = 3 * vertices.len();
        residual.clear();
        residual.resize(m, 0.0);
        tangent.clear();
        tangent.resize(if has_tangent { m * m } else { 0 }, 0.0);
        (self.has_tangent, self.is_empty) = (has_tangent, true);
    }

    /// Adds the force of a contact.
    pub fn add(&mut self, skin: &Skin, joint: &Joint) {
        self.is_empty = false;
        let Self { vertices, residual, tangent, corners, starts, .. } = self;
        let (m, count) = (3 * vertices.len(), joint.points.len());
        corners.clear();
        starts.clear();
        starts.push(0);
        for &point in &joint.points {
            skin.corners_of(point, &mut |vertex, share| {
                // cannot fail: the points of a contact are points of its facets.
                corners.push((3 * vertices.binary_search(&vertex).unwrap_or_default(), share));
            });
            starts.push(corners.len());
        }
        for i in 0..count {
            let force = joint.barrier[i] + joint.friction[i];
            for &(row, w) in &corners[starts[i]..starts[i + 1]] {
                for c in 0..3 {
                    residual[row + c] += w * force[c];
                }
                if !self.has_tangent {
                    continue;
                }
                for j in 0..count {
                    for &(column, v) in &corners[starts[j]..starts[j + 1]] {
                        for c in 0..3 {
                            let entries = &mut tangent[(row + c) * m + column..][..3];
                            let block = &joint.tangent[(3 * i + c) * 3 * count + 3 * j..][..3];
                            entries.iter_mut().zip(block).for_each(|(t, b)| *t += w * v * b);
                        }
                    }
                }
            }
        }
    }

    /// Adds all of it to the nodes of a contribution, which are those of the facets.
    pub fn finish(&mut self, skin: &Skin, local: &mut Local) {
        if self.is_empty {
            return;
        }
        let Self { vertices, residual, tangent, half, .. } = self;
        let (m, n) = (3 * vertices.len(), local.dim());
        let Local { nodes, residual: to, tangent: to_tangent, .. } = local;
        // cannot fail: vertices are made of nodes of their facets.
        let place = |node: u32| 3 * nodes.binary_search(&node).unwrap_or_default();
        for (a, &vertex) in vertices.iter().enumerate() {
            for &(node, w) in skin.terms(vertex) {
                let at = place(node);
                (0..3).for_each(|c| to[at + c] += w * residual[3 * a + c]);
            }
        }
        if !self.has_tangent {
            return;
        }
        half.clear();
        half.resize(m * n, 0.0);
        for (a, &vertex) in vertices.iter().enumerate() {
            for &(node, w) in skin.terms(vertex) {
                let at = place(node);
                for row in 0..m {
                    let from = &tangent[row * m + 3 * a..][..3];
                    half[row * n + at..][..3].iter_mut().zip(from).for_each(|(h, k)| *h += w * k);
                }
            }
        }
        for (a, &vertex) in vertices.iter().enumerate() {
            for &(node, w) in skin.terms(vertex) {
                let at = place(node);
                for c in 0..3 {
                    let from = &half[(3 * a + c) * n..][..n];
                    to_tangent[(at + c) * n..][..n].iter_mut().zip(from).for_each(|(t, h)| *t += w * h);
                }
            }
        }
    }
}
