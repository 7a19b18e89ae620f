//! Points and directions that are carried by vectors of the system.

/// `u(q) = c + sum_k w_k q_k`: a point of a body (weights of positions add up to 1, `c` zero), a direction fixed to a body, or, without terms, a
/// point or direction of the ground.
///
/// A force on such a point acts on the vectors that carry it with the weights, `f_k = w_k f`: the work is the same, and so is the moment `sum q_k x f_k = u x f`
/// (theory/multibody#embedded).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Embedded {
    /// `c`.
    pub constant: [f64; 3],
    /// Global number of a vector and its weight, each vector once.
    pub terms: Vec<(u32, f64)>,
}

impl Embedded {
    /// A point or direction that does not move.
    pub fn ground(constant: [f64; 3]) -> Self {
        Self { constant, terms: Vec::new() }
    }

    /// A vector of the system itself, for instance a node of a solid.
    pub fn vector(vector: u32) -> Self {
        Self { constant: [0.0; 3], terms: vec![(vector, 1.0)] }
    }

    /// Value at a configuration (`3 * vectors` entries).
    pub fn at(&self, q: &[f64]) -> [f64; 3] {
        let mut u = self.constant;
        for &(vector, weight) in &self.terms {
            let first = 3 * vector as usize;
            for (u, q) in u.iter_mut().zip(&q[first..first + 3]) {
                *u += weight * q;
            }
        }
        u
    }

    /// `rates` at the same weights: the velocity of the point for `q = v`.
    pub fn rate(&self, v: &[f64]) -> [f64; 3] {
        let at = self.at(v);
        std::array::from_fn(|i| at[i] - self.constant[i])
    }

    /// `self + factor * other`, with each vector once and no weights of zero.
    #[must_use]
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let mut sum = self.clone();
        for (c, d) in sum.constant.iter_mut().zip(other.constant) {
            *c += factor * d;
        }
        for &(vector, weight) in &other.terms {
            match sum.terms.iter_mut().find(|(v, _)| *v == vector) {
                Some((_, w)) => *w += factor * weight,
                None => sum.terms.push((vector, factor * weight)),
            }
        }
        sum.terms.retain(|&(_, weight)| weight != 0.0);
        sum
    }
}
