//! Edges of a surface: is it closed?

use super::SurfaceMesh;

impl SurfaceMesh {
    /// The edges that do not belong to exactly two facets which pass them in opposite directions, by their nodes,
    /// smaller number first; sorted.
    pub fn open_edges(&self) -> Vec<[u32; 2]> {
        // An edge as (smaller node, larger node, passed from the smaller to the larger).
        let mut passed: Vec<([u32; 2], bool)> = Vec::with_capacity(4 * self.facets.len());
        for facet in &self.facets {
            for edge in 0..facet.kind().edge_count() {
                let [a, b] = facet.kind().side(edge).map(|k| facet[k]);
                passed.push(([a.min(b), a.max(b)], a < b));
            }
        }
        passed.sort_unstable();
        passed
            .chunk_by(|one, other| one.0 == other.0)
            .filter(|group| !matches!(group, [(_, false), (_, true)]))
            .map(|group| group[0].0)
            .collect()
    }

    /// True if the surface has facets and each edge belongs to exactly two of them, which pass it in opposite directions.
    pub fn is_closed(&self) -> bool {
        !self.facets.is_empty() && self.open_edges().is_empty()
    }
}
