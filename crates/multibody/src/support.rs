//! Springs and dashpots between nodes and the ground, for surfaces on a foundation.

use crate::error::{PartDataError, not_negative};
use stoss_term::{At, Fault, ForceRule, Local, Rule, Term, Work};

/// The axes of space.
pub const AXES_OF_SPACE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// What of a body is supported together: a node, or the nodes of a facet, whose displacement is interpolated between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Supported {
    /// Vectors of the nodes, each once.
    pub vectors: Vec<u32>,
    /// `X_I`, where the springs have no force.
    pub at: Vec<[f64; 3]>,
    /// `A_IJ`, row-major, symmetric and positive: `int N_I N_J dA` of a facet, and stiffnesses are then for a unit of area; 1 of a node.
    pub shares: Vec<f64>,
}

/// Springs and dashpots along three axes that are fixed in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foundation {
    /// `a_i`, orthonormal.
    pub axes: [[f64; 3]; 3],
    /// `k_i`, a force per length along each axis, for a share of one.
    pub stiffness: [f64; 3],
    /// `d_i`, a force per velocity along each axis, for a share of one.
    pub damping: [f64; 3],
}

/// An elastic support: springs and dashpots from nodes or facets to fixed points of the ground.
///
/// With `u_iI = a_i . (x_I - X_I)` of the nodes the energy (theory/multibody#eq-foundation) is `V = 1/2 sum_i k_i sum_IJ A_IJ u_iI u_iJ`, whose discrete gradient is that at the mean of both ends. The dashpots
/// have the force `d_i sum_J A_IJ (u_iJ,n+1 - u_iJ,n) / dt` whatever the rule, and take `d_i sum_IJ A_IJ du_iI du_iJ / dt` out of a step. Axes do not act on each other.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticSupport {
    name: String,
    items: Vec<Supported>,
    foundation: Foundation,
    length: f64,
}

impl Supported {
    /// A node with one spring along each axis.
    pub fn node(vector: u32, at: [f64; 3]) -> Self {
        Self { vectors: vec![vector], at: vec![at], shares: vec![1.0] }
    }

    /// Component along `axis` of what each node has.
    fn along<'a>(&'a self, axis: [f64; 3], x: impl Fn(usize, usize) -> f64 + 'a) -> impl Iterator<Item = f64> + 'a {
        (0..self.vectors.len()).map(move |n| (0..3).map(|k| axis[k] * x(n, k)).sum())
    }

    /// Place of a component of a node in arrays of the model.
    fn place(&self, node: usize, k: usize) -> usize {
        3 * self.vectors[node] as usize + k
    }

    /// `u_i`, how far the springs are stretched.
    fn stretch(&self, axis: [f64; 3], q: &[f64]) -> Vec<f64> {
        self.along(axis, |n, k| q[self.place(n, k)] - self.at[n][k]).collect()
    }

    /// The motion in a step.
    fn motion(&self, axis: [f64; 3], at: &At<'_>) -> Vec<f64> {
        self.along(axis, |n, k| at.q_np1[self.place(n, k)] - at.q_n[self.place(n, k)]).collect()
    }

    /// `sum_J A_IJ u_J`.
    fn shared(&self, node: usize, u: &[f64]) -> f64 {
        let count = self.vectors.len();
        self.shares[count * node..count * (node + 1)].iter().zip(u).map(|(share, u)| share * u).sum()
    }

    /// `sum_IJ A_IJ u_I u_J`.
    fn square(&self, u: &[f64]) -> f64 {
        u.iter().enumerate().map(|(node, value)| value * self.shared(node, u)).sum()
    }
}

impl ElasticSupport {
    /// A support of nodes or facets of a body with the size `length`.
    ///
    /// # Errors
    /// [`PartDataError::Number`].
    ///
    /// # Panics
    /// If an item has not as many places as vectors, and shares for all pairs of them; this is a programming error.
    pub fn new(name: &str, items: Vec<Supported>, foundation: Foundation, length: f64) -> Result<Self, PartDataError> {
        for (k, d) in foundation.stiffness.into_iter().zip(foundation.damping) {
            not_negative("stiffness of a support", k)?;
            not_negative("damping of a support", d)?;
        }
        let fits = |item: &Supported| item.at.len() == item.vectors.len() && item.shares.len() == item.at.len().pow(2);
        assert!(items.iter().all(fits), "places and shares of supported nodes");
        Ok(Self { name: name.to_owned(), items, foundation, length })
    }

    /// Vectors that are supported.
    pub fn items(&self) -> &[Supported] {
        &self.items
    }
}

impl Term for ElasticSupport {
    fn name(&self) -> &str {
        &self.name
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        self.items.iter().for_each(|item| visit(&item.vectors, &[]));
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.force() else { return Ok(()) };
        // Of a quadratic energy the gradient at the midpoint is the discrete one.
        let theta = match rule {
            ForceRule::Configuration { theta } => theta,
            ForceRule::DiscreteGradient => 0.5,
        };
        let Foundation { axes, stiffness, damping } = self.foundation;
        let mut local = Local::default();
        for item in &self.items {
            let count = item.vectors.len();
            local.nodes.clone_from(&item.vectors);
            local.reset(want_tangent);
            for (i, axis) in axes.into_iter().enumerate() {
                let damper = if at.rates { damping[i] / at.dt } else { 0.0 };
                let (old, new) = (item.stretch(axis, at.q_n), item.stretch(axis, at.q_np1));
                let motion = item.motion(axis, at);
                let between = |n: usize| (1.0 - theta) * old[n] + theta * new[n];
                let force: Vec<f64> = (0..count).map(|n| stiffness[i] * between(n) + damper * motion[n]).collect();
                let slope = theta * stiffness[i] + damper;
                for a in 0..count {
                    let force = item.shared(a, &force);
                    for k in 0..3 {
                        local.residual[3 * a + k] += force * axis[k];
                        for b in (0..count).filter(|_| want_tangent) {
                            let slope = slope * item.shares[count * a + b] * axis[k];
                            (0..3).for_each(|l| local.tangent[3 * count * (3 * a + k) + 3 * b + l] += slope * axis[l]);
                        }
                    }
                }
            }
            visit(&local);
        }
        Ok(())
    }

    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        let Foundation { axes, stiffness, .. } = self.foundation;
        let of_item = |item: &Supported| -> f64 {
            axes.iter().zip(stiffness).map(|(axis, k)| 0.5 * k * item.square(&item.stretch(*axis, q))).sum()
        };
        Ok(self.items.iter().map(of_item).sum())
    }

    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        let stored = self.energy(at.q_np1)?;
        let Foundation { axes, damping, .. } = self.foundation;
        let loss = |item: &Supported| -> f64 {
            axes.iter().zip(damping).map(|(axis, d)| d * item.square(&item.motion(*axis, at)) / at.dt).sum()
        };
        let dissipated = if at.rates { self.items.iter().map(loss).sum() } else { 0.0 };
        Ok(Work { stored, dissipated, ..Work::default() })
    }

    fn conserves_linear_momentum(&self) -> bool {
        false
    }

    fn conserves_angular_momentum(&self) -> bool {
        false
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn force_scale(&self) -> f64 {
        let largest = self.foundation.stiffness.into_iter().fold(0.0, f64::max);
        self.length * largest * self.items.iter().flat_map(|item| &item.shares).sum::<f64>()
    }

    fn is_symmetric(&self, _rule: Rule) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two nodes, and two that share an area.
    fn support() -> ElasticSupport {
        let inclined = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];
        let foundation = Foundation { axes: inclined, stiffness: [2.0, 0.0, 5.0], damping: [0.3, 0.7, 0.0] };
        let pair = Supported {
            vectors: vec![3, 1],
            at: vec![[0.0, 0.1, 0.0], [0.4, 0.0, 0.2]],
            shares: vec![2.0, -0.5, -0.5, 1.0],
        };
        let items = vec![Supported::node(0, [0.1, 0.2, 0.3]), Supported::node(2, [0.0; 3]), pair];
        ElasticSupport::new("support", items, foundation, 1.0).unwrap()
    }

    fn force(support: &ElasticSupport, at: At<'_>) -> (Vec<f64>, Vec<f64>) {
        let n = at.q_n.len();
        let (mut force, mut tangent) = (vec![0.0; n], vec![0.0; n * n]);
        let mut add = |local: &Local| {
            let place = |i: usize| 3 * local.nodes[i / 3] as usize + i % 3;
            for i in 0..local.dim() {
                force[place(i)] += local.residual[i];
                (0..local.dim()).for_each(|j| tangent[n * place(i) + place(j)] += local.tangent[local.dim() * i + j]);
            }
        };
        support.assemble(&at, true, &mut add).unwrap();
        (force, tangent)
    }

    /// The work of the forces is the change of energy and the loss, and the tangent is the derivative.
    #[test]
    fn work_is_energy_and_loss() {
        let support = support();
        let q_n = [0.3, -0.1, 0.5, 0.7, 0.1, -0.3, 0.2, 0.4, -0.6, 0.2, 0.0, 0.1];
        let q_np1 = [0.5, 0.3, 0.1, 0.2, -0.4, 0.6, -0.2, 0.1, 0.7, 0.5, -0.3, 0.2];
        let at = At::force([&q_n, &q_np1], ForceRule::DiscreteGradient, 0.05);
        let (f, tangent) = force(&support, at);
        let work: f64 = f.iter().zip(q_np1.iter().zip(&q_n)).map(|(f, (new, old))| f * (new - old)).sum();
        let change = support.energy(&q_np1).unwrap() - support.energy(&q_n).unwrap();
        assert!((work - change - support.work(&at).unwrap().dissipated).abs() < 1e-13, "{work}");
        for i in 0..12 {
            let mut moved = q_np1;
            moved[i] += 0.25;
            let (g, _) = force(&support, At { q_np1: &moved, ..at });
            for j in 0..12 {
                // The force is linear.
                let derivative = (g[j] - f[j]) / 0.25;
                assert!((derivative - tangent[12 * j + i]).abs() < 1e-12);
            }
        }
        let at_rest = At { rates: false, ..at };
        assert_eq!(support.work(&at_rest).unwrap().dissipated, 0.0);
    }

    #[test]
    fn negative_data_are_refused() {
        let foundation = Foundation { axes: AXES_OF_SPACE, stiffness: [0.0, -1.0, 0.0], damping: [0.0; 3] };
        assert!(ElasticSupport::new("x", vec![Supported::node(0, [0.0; 3])], foundation, 1.0).is_err());
    }
}
