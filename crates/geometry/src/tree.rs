//! A bounding-volume tree over boxes, at rest or in motion.
//!
//! Built once by splitting at the median, so that its depth is bounded by the logarithm of the number of boxes; when the boxes
//! move, [`BoundingVolumeTree::refit`] keeps the structure and renews the volumes. Structure and order of visits depend on
//! nothing but the boxes: equal input gives equal visits on every machine.
//!
//! It is not a spatial hash and does not rebalance: after a large rearrangement, build a new one.

use crate::{Aabb, BoundingVolume};
use nalgebra::Vector3;

/// Largest number of boxes in a leaf. Leaves of two to four are equally fast here; one doubles the memory.
const LEAF_SIZE: usize = 4;

/// Bound of the depth: `2^32` boxes halve into leaves in at most 32 splits, and a traversal keeps one waiting node a level.
const STACK: usize = 40;

#[derive(Clone, Copy, Debug)]
struct Node<V> {
    volume: V,
    /// Leaf: first position in `order`. Inner node: index of the second child; the first follows the node itself.
    start: u32,
    /// Number of boxes of a leaf, zero for an inner node.
    count: u32,
}

/// A bounding-volume tree over boxes, built once by splitting at the median; item `i` is box `i`.
///
/// Structure and order of visits depend on nothing but the boxes. Queries and refits do not allocate. After a large
/// rearrangement of the boxes build a new tree: a refit does not rebalance.
#[derive(Clone, Debug)]
pub struct BoundingVolumeTree<V = Aabb> {
    nodes: Vec<Node<V>>,
    order: Vec<u32>,
    boxes: Vec<V>,
}

impl<V> Default for BoundingVolumeTree<V> {
    fn default() -> Self {
        Self { nodes: Vec::new(), order: Vec::new(), boxes: Vec::new() }
    }
}

impl<V: BoundingVolume> BoundingVolumeTree<V> {
    /// Builds a tree over `boxes`; item `i` is box `i`. No boxes give an empty tree.
    pub fn build(boxes: &[V]) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(boxes.len().max(1)),
            order: (0..boxes.len() as u32).collect(),
            boxes: boxes.to_vec(),
        };
        if !boxes.is_empty() {
            tree.split(0, boxes.len());
            tree.refit_volumes();
        }
        tree
    }

    /// Number of items.
    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Whether there are no items.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// Box of an item.
    pub fn item_box(&self, item: usize) -> &V {
        &self.boxes[item]
    }

    /// Box around all items.
    pub fn bounds(&self) -> V {
        self.nodes.first().map_or_else(V::empty, |n| n.volume)
    }

    fn split(&mut self, begin: usize, end: usize) {
        let here = self.nodes.len();
        self.nodes.push(Node { volume: V::empty(), start: begin as u32, count: (end - begin) as u32 });
        if end - begin <= LEAF_SIZE {
            return;
        }
        let boxes = &self.boxes;
        let items = &mut self.order[begin..end];
        let centres = items.iter().fold(Aabb::empty(), |b, &i| {
            let c = boxes[i as usize].centre();
            Aabb { min: b.min.inf(&c), max: b.max.sup(&c) }
        });
        let axis = (centres.max - centres.min).imax();
        let middle = items.len() / 2;
        // The item's number breaks ties, so that equal boxes are split the same way everywhere.
        items.select_nth_unstable_by(middle, |&i, &j| {
            let key = |k: u32| boxes[k as usize].centre()[axis];
            key(i).total_cmp(&key(j)).then(i.cmp(&j))
        });
        // The order inside a half is unspecified after the selection; sorting makes it a function of the input alone.
        items[..middle].sort_unstable();
        items[middle..].sort_unstable();
        self.split(begin, begin + middle);
        self.nodes[here].start = self.nodes.len() as u32;
        self.nodes[here].count = 0;
        self.split(begin + middle, end);
    }

    /// Renews all volumes after the boxes moved; `box_of(item)` gives the new box. No allocation.
    pub fn refit(&mut self, box_of: impl FnMut(usize) -> V) {
        let items = 0..self.boxes.len();
        for (slot, new) in self.boxes.iter_mut().zip(items.map(box_of)) {
            *slot = new;
        }
        self.refit_volumes();
    }

    fn refit_volumes(&mut self) {
        // Children come after their parent: backwards, both are up to date.
        for i in (0..self.nodes.len()).rev() {
            let Node { start, count, .. } = self.nodes[i];
            let start = start as usize;
            self.nodes[i].volume = if count == 0 {
                self.nodes[i + 1].volume.union(&self.nodes[start].volume)
            } else {
                self.order[start..start + count as usize]
                    .iter()
                    .fold(V::empty(), |b, &item| b.union(&self.boxes[item as usize]))
            };
        }
    }

    /// Visits every item whose box overlaps `region`, in a fixed order.
    pub fn query(&self, region: &V, mut visit: impl FnMut(usize)) {
        let mut stack = [0u32; STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let index = stack[waiting];
            let node = &self.nodes[index as usize];
            if !node.volume.overlaps(region) {
                continue;
            }
            if node.count == 0 {
                stack[waiting] = node.start;
                stack[waiting + 1] = index + 1;
                waiting += 2;
            } else {
                for &item in self.items(node) {
                    if self.boxes[item as usize].overlaps(region) {
                        visit(item as usize);
                    }
                }
            }
        }
    }

    /// Visits every pair of an item of this tree and an item of `other` whose boxes overlap, in a fixed order.
    pub fn pairs(&self, other: &Self, visit: &mut impl FnMut(usize, usize)) {
        if !self.is_empty() && !other.is_empty() {
            self.descend(0, other, 0, visit);
        }
    }

    /// Visits every item with itself, and every pair of two items whose boxes overlap once, in a fixed order.
    pub fn own_pairs(&self, visit: &mut impl FnMut(usize, usize)) {
        if !self.is_empty() {
            self.descend_within(0, visit);
        }
    }

    /// Items of a leaf.
    fn items(&self, node: &Node<V>) -> &[u32] {
        &self.order[node.start as usize..(node.start + node.count) as usize]
    }

    /// Children of a node; of a leaf the leaf.
    fn children(&self, i: usize) -> ([usize; 2], usize) {
        let node = &self.nodes[i];
        if node.count == 0 { ([i + 1, node.start as usize], 2) } else { ([i, i], 1) }
    }

    fn descend(&self, i: usize, other: &Self, j: usize, visit: &mut impl FnMut(usize, usize)) {
        let (a, b) = (&self.nodes[i], &other.nodes[j]);
        if !a.volume.overlaps(&b.volume) {
            return;
        }
        if a.count > 0 && b.count > 0 {
            for &k in self.items(a) {
                for &l in other.items(b) {
                    if self.boxes[k as usize].overlaps(&other.boxes[l as usize]) {
                        visit(k as usize, l as usize);
                    }
                }
            }
            return;
        }
        let ((first, m), (second, n)) = (self.children(i), other.children(j));
        for &k in &first[..m] {
            for &l in &second[..n] {
                self.descend(k, other, l, visit);
            }
        }
    }

    fn descend_within(&self, i: usize, visit: &mut impl FnMut(usize, usize)) {
        let node = &self.nodes[i];
        if node.count == 0 {
            let [first, second] = self.children(i).0;
            self.descend_within(first, visit);
            self.descend_within(second, visit);
            self.descend(first, self, second, visit);
            return;
        }
        let items = self.items(node);
        for (n, &k) in items.iter().enumerate() {
            visit(k as usize, k as usize);
            for &l in &items[n + 1..] {
                if self.boxes[k as usize].overlaps(&self.boxes[l as usize]) {
                    visit(k as usize, l as usize);
                }
            }
        }
    }
}

impl BoundingVolumeTree {
    /// Visits items near `x`, the nearest volumes first, and skips what cannot matter.
    ///
    /// `bound` is a distance. `visit(item, bound)` returns the new bound (a smaller one when the item turned out to be near, else the
    /// old one). An item is visited unless its box is farther away than the bound of that moment; items *at* the bound are
    /// visited, so that ties can be resolved. Returns the last bound.
    pub fn nearest(&self, x: &Vector3<f64>, mut bound: f64, mut visit: impl FnMut(usize, f64) -> f64) -> f64 {
        let mut stack = [(0u32, 0.0f64); STACK];
        let mut waiting = 0;
        if let Some(root) = self.nodes.first() {
            stack[0] = (0, root.volume.distance_squared(x));
            waiting = 1;
        }
        while waiting > 0 {
            waiting -= 1;
            let (index, distance_squared) = stack[waiting];
            if distance_squared > bound * bound {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count == 0 {
                let first = (index + 1, self.nodes[index as usize + 1].volume.distance_squared(x));
                let second = (node.start, self.nodes[node.start as usize].volume.distance_squared(x));
                let (near, far) = if second.1 < first.1 { (second, first) } else { (first, second) };
                stack[waiting] = far;
                stack[waiting + 1] = near;
                waiting += 2;
            } else {
                for &item in self.items(node) {
                    if self.boxes[item as usize].distance_squared(x) <= bound * bound {
                        bound = visit(item as usize, bound);
                    }
                }
            }
        }
        bound
    }
}
