//! What second derivatives of the weights add to the tangent of a row, learnt from the gradients of successive iterates (theory/mortar#secant): one symmetric
//! update a row (Powell 1970) of what is missing to the part of the second derivative that is computed, a partitioned quasi-Newton method (Griewank and Toint
//! 1982). It goes into the tangent alone: solutions, momenta and work do not depend on it.

use nalgebra::Vector3;

/// Relative motions below this, in lengths of facets, teach nothing: differences of gradients are round-off then.
const NO_MOTION: f64 = 1e-8;
/// Length of what is left of a unit rigid motion without those before it, below which it is none of its own: all nodes on a line, or one point.
const NO_MOTION_OF_ITS_OWN: f64 = 1e-6;

/// What is missing to the computed second derivative of one row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Secant {
    /// Global nodes.
    nodes: Vec<u32>,
    /// Symmetric, row-major, by the components of the nodes; without resultant and moment.
    missing: Vec<f64>,
    /// Positions of the last iterate in this step; empty before the first.
    at: Vec<f64>,
    /// The gradient there.
    gradient: Vec<f64>,
}

/// Rigid motions of some nodes, orthonormal.
struct RigidMotions(Vec<Vec<f64>>);

impl RigidMotions {
    fn new(at: &[f64]) -> Self {
        let points: Vec<Vector3<f64>> = at.chunks_exact(3).map(Vector3::from_column_slice).collect();
        let centre = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let motions = (0..6).map(|k| -> Vec<f64> {
            let of = |p: &Vector3<f64>| if k < 3 { axes[k] } else { axes[k - 3].cross(&(p - centre)) };
            points.iter().flat_map(|p| <[f64; 3]>::from(of(p))).collect()
        });
        let mut out = Self(Vec::with_capacity(6));
        for mut motion in motions {
            let before = norm(&motion);
            out.remove(&mut motion);
            let length = norm(&motion);
            if length > NO_MOTION_OF_ITS_OWN * before {
                motion.iter_mut().for_each(|m| *m /= length);
                // Once more, so that they are orthogonal to round-off.
                out.remove(&mut motion);
                out.0.push(motion);
            }
        }
        out
    }

    /// Takes the rigid motions out of `vector`.
    fn remove(&self, vector: &mut [f64]) {
        for motion in &self.0 {
            let part = dot(motion, vector);
            vector.iter_mut().zip(motion).for_each(|(v, m)| *v -= part * m);
        }
    }

    /// Takes them out of the rows and the columns of a symmetric matrix.
    fn remove_from(&self, matrix: &mut [f64], n: usize) {
        matrix.chunks_exact_mut(n).for_each(|row| self.remove(row));
        for motion in &self.0 {
            let mut part = vec![0.0; n];
            for (row, m) in matrix.chunks_exact(n).zip(motion) {
                part.iter_mut().zip(row).for_each(|(sum, value)| *sum += m * value);
            }
            for (row, m) in matrix.chunks_exact_mut(n).zip(motion) {
                row.iter_mut().zip(&part).for_each(|(value, part)| *value -= m * part);
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

impl Secant {
    /// Begins a step: what was learnt stays, the last iterate does not.
    pub fn begin(&mut self) {
        self.at.clear();
        self.gradient.clear();
    }

    /// Whether an iterate of this step is known, so that the next one teaches something.
    pub fn has_last(&self) -> bool {
        !self.at.is_empty()
    }

    /// Whether nothing was learnt.
    pub fn is_empty(&self) -> bool {
        self.missing.is_empty()
    }

    /// Learns from the gradient at the positions `at` of `nodes`; `hessian` is the computed second derivative there, row-major (it may be empty without [`Self::has_last`]), `edge` the length of a facet.
    pub fn learn(&mut self, nodes: &[u32], at: Vec<f64>, gradient: Vec<f64>, hessian: &[f64], edge: f64) {
        let n = at.len();
        self.take(nodes);
        let rigid = RigidMotions::new(&at);
        if !self.missing.is_empty() {
            rigid.remove_from(&mut self.missing, n);
        }
        if self.at.len() == n {
            let motion: Vec<f64> = at.iter().zip(&self.at).map(|(x, old)| x - old).collect();
            let mut relative = motion.clone();
            rigid.remove(&mut relative);
            let square = dot(&relative, &relative);
            if square > (NO_MOTION * edge).powi(2) {
                if self.missing.is_empty() {
                    self.missing = vec![0.0; n * n];
                }
                let known = hessian.chunks_exact(n).zip(self.missing.chunks_exact(n));
                let mut rest: Vec<f64> = known
                    .zip(gradient.iter().zip(&self.gradient))
                    .map(|((h, u), (new, old))| new - old - dot(h, &motion) - dot(u, &motion))
                    .collect();
                rigid.remove(&mut rest);
                let along = dot(&rest, &relative) / square;
                for ((row, r), s) in self.missing.chunks_exact_mut(n).zip(&rest).zip(&relative) {
                    for ((value, other_r), other_s) in row.iter_mut().zip(&rest).zip(&relative) {
                        *value += (r * other_s + s * (other_r - along * other_s)) / square;
                    }
                }
            }
        }
        // To the last digit, for only one half is saved.
        for i in 1..if self.missing.is_empty() { 0 } else { n } {
            for j in 0..i {
                self.missing[i * n + j] = self.missing[j * n + i];
            }
        }
        (self.at, self.gradient) = (at, gradient);
    }

    /// Adds what was learnt to a second derivative of the same nodes.
    pub fn add_to(&self, nodes: &[u32], hessian: &mut [f64]) {
        if self.nodes == nodes {
            hessian.iter_mut().zip(&self.missing).for_each(|(h, m)| *h += m);
        }
    }

    /// Arranges what was learnt by these nodes: those that have come had no part, those that have gone have none any more.
    fn take(&mut self, nodes: &[u32]) {
        if self.nodes == nodes {
            return;
        }
        let (before, n) = (3 * self.nodes.len(), 3 * nodes.len());
        if !self.missing.is_empty() {
            let old: Vec<Option<usize>> =
                nodes.iter().map(|node| self.nodes.iter().position(|old| old == node)).collect();
            let mut missing = vec![0.0; n * n];
            for (i, from) in old.iter().enumerate().filter_map(|(i, from)| Some((i, (*from)?))) {
                for (j, to) in old.iter().enumerate().filter_map(|(j, to)| Some((j, (*to)?))) {
                    for c in 0..3 {
                        let source = (3 * from + c) * before + 3 * to;
                        missing[(3 * i + c) * n + 3 * j..][..3].copy_from_slice(&self.missing[source..][..3]);
                    }
                }
            }
            self.missing = missing;
        }
        self.nodes = nodes.to_vec();
        self.begin();
    }

    /// Bytes of what was learnt: the number of nodes, the nodes, the upper triangle.
    pub fn save(&self, out: &mut Vec<u8>) {
        let n = 3 * self.nodes.len();
        out.extend((self.nodes.len() as u32).to_le_bytes());
        out.extend(self.nodes.iter().flat_map(|node| node.to_le_bytes()));
        let upper = (0..n).flat_map(|i| &self.missing[i * n + i..(i + 1) * n]);
        out.extend(upper.flat_map(|value| value.to_le_bytes()));
    }

    /// The secant from the bytes of [`Secant::save`] at the front of `bytes`, which are taken away; `None` if there are too few.
    pub fn load(bytes: &mut &[u8]) -> Option<Self> {
        let mut word = || -> Option<u32> {
            let (word, rest) = bytes.split_first_chunk()?;
            *bytes = rest;
            Some(u32::from_le_bytes(*word))
        };
        let count = word()?;
        let nodes = (0..count).map(|_| word()).collect::<Option<Vec<u32>>>()?;
        let n = 3 * nodes.len();
        let mut missing = vec![0.0; n * n];
        for i in 0..n {
            for j in i..n {
                let (value, rest) = bytes.split_first_chunk()?;
                *bytes = rest;
                let value = f64::from_le_bytes(*value);
                (missing[i * n + j], missing[j * n + i]) = (value, value);
            }
        }
        Some(Self { nodes, missing, ..Self::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The secant equation in what is no rigid motion, symmetry, no resultant and no moment, and the same after saving.
        #[test]
        fn what_is_learnt_has_neither_resultant_nor_moment(
            x in prop::collection::vec(-1.0f64..1.0, 21), u in prop::collection::vec(-0.1f64..0.1, 21),
            g in prop::collection::vec(-1.0f64..1.0, 42), h in prop::collection::vec(-1.0f64..1.0, 441),
        ) {
            let nodes: Vec<u32> = (3..10).collect();
            let h: Vec<f64> = (0..441).map(|k| h[k] + h[(k % 21) * 21 + k / 21]).collect();
            let end: Vec<f64> = x.iter().zip(&u).map(|(x, u)| x + u).collect();
            let mut secant = Secant::default();
            secant.learn(&nodes, x.clone(), g[..21].to_vec(), &h, 1.0);
            prop_assert!(secant.is_empty());
            secant.learn(&nodes, end.clone(), g[21..].to_vec(), &h, 1.0);
            let rigid = RigidMotions::new(&end);
            prop_assert_eq!(rigid.0.len(), 6);
            for (i, row) in secant.missing.chunks_exact(21).enumerate() {
                (0..21).for_each(|j| assert_eq!(row[j], secant.missing[j * 21 + i]));
                for motion in &rigid.0 {
                    prop_assert!(dot(motion, row).abs() < 1e-12 * norm(&secant.missing));
                }
            }
            let mut rest: Vec<f64> = (0..21)
                .map(|i| g[21 + i] - g[i] - dot(&h[21 * i..][..21], &u) - dot(&secant.missing[21 * i..][..21], &u))
                .collect();
            rigid.remove(&mut rest);
            prop_assert!(norm(&rest) < 1e-10 * norm(&secant.missing), "{:?}", rest);
            let mut bytes = Vec::new();
            secant.save(&mut bytes);
            let mut left = &bytes[..];
            let loaded = Secant::load(&mut left);
            prop_assert!(left.is_empty());
            prop_assert_eq!(Secant::load(&mut &bytes[..bytes.len() - 1]), None);
            let Some(loaded) = loaded else { return Err(TestCaseError::fail("not loaded")) };
            secant.begin();
            prop_assert_eq!(&loaded, &secant);
        }
    }

    /// A node that comes has no part, one that goes takes its part with it.
    #[test]
    fn nodes_come_and_go() {
        let mut secant = Secant { nodes: vec![4, 7], missing: (0..36).map(f64::from).collect(), ..Secant::default() };
        secant.take(&[9, 7]);
        for i in 0..6 {
            for j in 0..6 {
                let expected = if i >= 3 && j >= 3 { f64::from(6 * i + j) } else { 0.0 };
                assert_eq!(secant.missing[(6 * i + j) as usize], expected);
            }
        }
    }
}
