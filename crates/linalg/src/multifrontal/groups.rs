//! Groups of equations that are ordered as one: the displacements of a node, then the multipliers of which it is the slave.
//! Not an ordering.

use super::ordering::Graph;
use crate::{NONE, SparsityPattern};

/// Largest number of multipliers without a label that join the group of a neighbour: a node has no more than three
/// components to be constrained.
const MULTIPLIERS_A_GROUP: u8 = 3;

/// A multiplier that acts on its own group with less than this share of its largest entry does so by round-off.
const ROUND_OFF: f64 = 1e-10;

/// Which equations form a group. Groups are numbered by their first equation.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Groups {
    /// Group of each equation.
    pub of: Vec<u32>,
    /// The members of group `g` are `members[starts[g]..starts[g + 1]]`, in the order of elimination.
    pub starts: Vec<u32>,
    pub members: Vec<u32>,
}

impl Groups {
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    pub fn members(&self, g: usize) -> &[u32] {
        &self.members[self.starts[g] as usize..self.starts[g + 1] as usize]
    }

    /// The groups from labels of any values. Members that are `late` are eliminated after the others of their group.
    fn from_labels(mut labels: Vec<u32>, late: &[bool]) -> Self {
        let largest = labels.iter().max().map_or(0, |&l| l as usize);
        let mut number = vec![NONE; largest + 1];
        let mut count = 0;
        for label in &mut labels {
            let slot = &mut number[*label as usize];
            if *slot == NONE {
                *slot = count;
                count += 1;
            }
            *label = *slot;
        }
        let mut starts = vec![0u32; count as usize + 1];
        labels.iter().for_each(|&g| starts[g as usize + 1] += 1);
        for g in 0..count as usize {
            starts[g + 1] += starts[g];
        }
        let mut next = starts.clone();
        let mut members = vec![0; labels.len()];
        for pass in [false, true] {
            for (equation, &g) in labels.iter().enumerate() {
                if late.get(equation).copied().unwrap_or(false) == pass {
                    members[next[g as usize] as usize] = equation as u32;
                    next[g as usize] += 1;
                }
            }
        }
        Self { of: labels, starts, members }
    }

    /// The graph of the groups: an edge where equations of two groups are coupled.
    pub fn graph(&self, pattern: &SparsityPattern) -> Graph {
        let count = self.len();
        let mut mark = vec![NONE; count];
        let (mut starts, mut neighbours) = (vec![0i32], Vec::new());
        for g in 0..count {
            mark[g] = g as u32;
            let begin = neighbours.len();
            for &equation in self.members(g) {
                for &row in pattern.column(equation as usize) {
                    let h = self.of[row as usize] as usize;
                    if mark[h] != g as u32 {
                        mark[h] = g as u32;
                        neighbours.push(h as i32);
                    }
                }
            }
            neighbours[begin..].sort_unstable();
            starts.push(neighbours.len() as i32);
        }
        Graph { starts, neighbours }
    }
}

/// Groups given by the pattern, and the equations that are attached to them by the values.
#[derive(Debug, Default)]
pub(super) struct KnownGroups {
    labels: Vec<u32>,
    /// The labels are the pattern's own.
    given: bool,
    /// Loose equations with an equation of the group that they join, [`NONE`] for a group of their own. A function of pattern and values
    /// of the last [`KnownGroups::attach`] alone: what was seen before must not show in the bits.
    attached: Vec<(u32, u32)>,
    present: Vec<(u32, u32)>,
    /// Number of loose equations that joined each label.
    guests: Vec<u8>,
    is_loose: Vec<bool>,
}

impl KnownGroups {
    /// The groups that the pattern names, or else equations with identical columns, which are the components of a node.
    pub fn new(pattern: &SparsityPattern) -> Self {
        let n = pattern.n();
        let mut known = Self { guests: vec![0; n + 1], is_loose: vec![false; n], ..Self::default() };
        if let Some(labels) = pattern.groups() {
            let mut distinct: Vec<u32> = labels.iter().copied().filter(|&l| l != NONE).collect();
            distinct.sort_unstable();
            distinct.dedup();
            let rank = |l: &u32| if *l == NONE { NONE } else { distinct.partition_point(|d| d < l) as u32 };
            known.labels = labels.iter().map(rank).collect();
            known.given = true;
            return known;
        }
        known.labels = (0..n as u32).collect();
        // Equations with equal columns are each other's neighbours, and the diagonal is always there.
        for j in 0..n {
            let column = pattern.column(j);
            let twin = column.iter().map(|&i| i as usize).take_while(|&i| i < j).find(|&i| {
                known.labels[i] == i as u32
                    && pattern.column_range(i).len() == column.len()
                    && pattern.column(i) == column
            });
            if let Some(i) = twin {
                known.labels[j] = i as u32;
            }
        }
        known
    }

    /// Every equation has a label of the pattern.
    pub fn complete(&self) -> bool {
        self.given && self.labels.iter().all(|&l| l != NONE)
    }

    /// Finds the loose equations and their hosts; true if that changed the groups.
    ///
    /// An equation is loose if it has no label, or has a zero on the diagonal and nothing to do with its group (without given labels:
    /// if it has a zero on the diagonal). It joins its strongest neighbour that is not loose itself.
    pub fn attach(&mut self, pattern: &SparsityPattern, values: &[f64]) -> bool {
        let n = pattern.n();
        for j in 0..n {
            self.is_loose[j] = self.labels[j] == NONE
                || (diagonal(pattern, values, j) == 0.0 && !(self.given && self.belongs(pattern, values, j)));
        }
        self.guests.fill(0);
        self.present.clear();
        for j in (0..n).filter(|&j| self.is_loose[j]) {
            let (labels, is_loose, guests) = (&self.labels, &self.is_loose, &mut self.guests);
            let allowed = |i: usize| !is_loose[i] && guests[labels[i] as usize] < MULTIPLIERS_A_GROUP;
            let host = strongest(pattern, values, j, allowed);
            if let Some(i) = host {
                guests[labels[i] as usize] += 1;
            }
            self.present.push((j as u32, host.map_or(NONE, |i| i as u32)));
        }
        let changed = self.present != self.attached;
        std::mem::swap(&mut self.present, &mut self.attached);
        changed
    }

    /// Whether the multiplier `j` acts on a member of its group at all. The caller knows the structure, so that the values are not asked which
    /// member of a contact element is the strongest one: on a stiff body next to a soft one the equilibrated entries of the slave are the smaller
    /// ones by the root of the ratio of stiffnesses and more, and another group would spoil the order.
    fn belongs(&self, pattern: &SparsityPattern, values: &[f64], j: usize) -> bool {
        let range = pattern.column_range(j);
        let (mut own, mut largest) = (0.0f64, 0.0f64);
        for (&i, v) in pattern.row_indices()[range.clone()].iter().zip(&values[range]) {
            largest = largest.max(v.abs());
            if self.labels[i as usize] == self.labels[j] {
                own = own.max(v.abs());
            }
        }
        own > ROUND_OFF * largest
    }

    /// All groups: the labels, and what the last [`KnownGroups::attach`] found.
    pub fn groups(&self) -> Groups {
        let n = self.labels.len();
        let mut labels = self.labels.clone();
        let mut late = vec![false; n];
        for &(j, host) in &self.attached {
            late[j as usize] = true;
            // Labels are below `n`.
            labels[j as usize] = if host == NONE { n as u32 + j } else { self.labels[host as usize] };
        }
        Groups::from_labels(labels, &late)
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<u32>() * self.labels.capacity()
            + size_of::<u8>() * (self.guests.capacity() + self.is_loose.capacity())
    }
}

/// The diagonal is always in the pattern.
fn diagonal(pattern: &SparsityPattern, values: &[f64], j: usize) -> f64 {
    values[pattern.column(j).partition_point(|&i| (i as usize) < j) + pattern.column_range(j).start]
}

/// The row of the largest entry of column `j` among rows for which `allowed` holds, the diagonal excluded; the first of equal ones.
fn strongest(pattern: &SparsityPattern, values: &[f64], j: usize, allowed: impl Fn(usize) -> bool) -> Option<usize> {
    let range = pattern.column_range(j);
    let mut best: Option<(usize, f64)> = None;
    for (&i, v) in pattern.row_indices()[range.clone()].iter().zip(&values[range]) {
        let i = i as usize;
        if i != j && *v != 0.0 && best.is_none_or(|(_, b)| v.abs() > b) && allowed(i) {
            best = Some((i, v.abs()));
        }
    }
    best.map(|(i, _)| i)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two nodes of three components, coupled; a multiplier (equation 6) that is stronger on node 1; one (7) coupled with nothing
    /// but the other multiplier.
    fn system() -> (SparsityPattern, Vec<f64>) {
        let stencils: [&[u32]; 4] = [&[0, 1, 2, 3, 4, 5], &[3, 4, 5], &[2, 5, 6], &[6, 7]];
        let pattern = SparsityPattern::from_stencils(8, stencils.into_iter()).unwrap();
        let mut values = vec![1.0; pattern.nnz()];
        for (i, j, v) in [(6, 6, 0.0), (7, 7, 0.0), (2, 6, -0.5), (5, 6, 0.7)] {
            values[pattern.position(i, j).unwrap()] = v;
        }
        (pattern, values)
    }

    #[test]
    fn found_from_the_pattern() {
        let (pattern, values) = system();
        let mut known = KnownGroups::new(&pattern);
        assert!(!known.complete());
        assert!(known.attach(&pattern, &values));
        assert!(!known.attach(&pattern, &values));
        let groups = known.groups();
        // Equations 2 and 5 have the same couplings.
        assert_eq!(groups.of, [0, 0, 1, 0, 0, 1, 1, 2]);
        assert_eq!(groups.members(1), [2, 5, 6]);
        let graph = groups.graph(&pattern);
        assert_eq!(graph.neighbours(0), [1]);
        assert_eq!(graph.neighbours(1), [0, 2]);
        assert_eq!(graph.neighbours(2), [1]);
    }

    #[test]
    fn given_and_completed() {
        let (pattern, values) = system();
        let pattern = pattern.with_groups(vec![9, 9, 9, 4, 4, 4, NONE, NONE]).unwrap();
        let mut known = KnownGroups::new(&pattern);
        assert!(!known.complete());
        known.attach(&pattern, &values);
        let groups = known.groups();
        assert_eq!(groups.of, [0, 0, 0, 1, 1, 1, 1, 2]);
        assert_eq!(groups.members(1), [3, 4, 5, 6]);
    }

    /// Equation 6 acts on 2 and 5 only: it does not belong to equations 0 and 1.
    #[test]
    fn a_wrong_label_is_noticed() {
        let (pattern, mut values) = system();
        let pattern = pattern.with_groups(vec![0, 0, 1, 2, 2, 3, 0, 4]).unwrap();
        values[pattern.position(7, 7).unwrap()] = 1.0;
        let mut known = KnownGroups::new(&pattern);
        assert!(known.complete());
        assert_eq!(known.groups().of, [0, 0, 1, 2, 2, 3, 0, 4]);
        assert!(known.attach(&pattern, &values));
        // Its strongest neighbour is 7.
        assert_eq!(known.groups().of, [0, 0, 1, 2, 2, 3, 4, 4]);
        assert_eq!(known.groups().members(4), [7, 6]);
    }
}
