//! Springs and dashpots between nodes and the ground, for surfaces on a foundation.

use crate::error::{PartDataError, not_negative};
use std::ops::Range;
use stoss_part::{ForceRule, LocalForce, Part, PartError, PartStep};

/// Springs and dashpots of one node, along the axes of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportedNode {
    /// Its vector.
    pub vector: u32,
    /// `X`, where the springs have no force.
    pub at: [f64; 3],
    /// `k_i`, a force per length for each component.
    pub stiffness: [f64; 3],
    /// `d_i`, a force per velocity for each component.
    pub damping: [f64; 3],
}

/// An elastic support: springs and dashpots from nodes to fixed points of the ground.
///
/// With `u = x - X` of each node the energy is `V = 1/2 sum_i k_i u_i^2`, whose discrete gradient is `k_i (u_i,n + u_i,n+1) / 2`. The dashpots have the force
/// `d_i (u_i,n+1 - u_i,n) / dt` whatever the rule, and take `d_i (u_i,n+1 - u_i,n)^2 / dt` out of a step. Components do not act on each other.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticSupport {
    name: String,
    nodes: Vec<SupportedNode>,
    length: f64,
}

impl ElasticSupport {
    /// Of nodes of a body with the size `length`.
    ///
    /// # Errors
    /// [`PartDataError::Number`].
    pub fn new(name: &str, nodes: Vec<SupportedNode>, length: f64) -> Result<Self, PartDataError> {
        for node in &nodes {
            for (k, d) in node.stiffness.into_iter().zip(node.damping) {
                not_negative("stiffness of a support", k)?;
                not_negative("damping of a support", d)?;
            }
        }
        Ok(Self { name: name.to_owned(), nodes, length })
    }

    /// The nodes with their springs and dashpots.
    pub fn nodes(&self) -> &[SupportedNode] {
        &self.nodes
    }
}

impl Part for ElasticSupport {
    fn name(&self) -> &str {
        &self.name
    }

    fn own_vectors(&self) -> Range<u32> {
        0..0
    }

    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.nodes.iter().for_each(|node| visit(&[node.vector]));
    }

    fn assemble(
        &self,
        step: PartStep<'_>,
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalForce),
    ) -> Result<(), PartError> {
        // Of a quadratic energy the gradient at the midpoint is the discrete one.
        let theta = match step.rule {
            ForceRule::Configuration { theta } => theta,
            _ => 0.5,
        };
        let mut local = LocalForce::default();
        for node in &self.nodes {
            local.vectors.clear();
            local.vectors.push(node.vector);
            local.reset(want_tangent);
            for i in 0..3 {
                let at = 3 * node.vector as usize + i;
                let (old, new) = (step.q_n[at], step.q_np1[at]);
                let damper = if step.has_rates { node.damping[i] / step.dt } else { 0.0 };
                let between = (1.0 - theta) * (old - node.at[i]) + theta * (new - node.at[i]);
                local.residual[i] = node.stiffness[i] * between + damper * (new - old);
                if want_tangent {
                    local.tangent[4 * i] = theta * node.stiffness[i] + damper;
                }
            }
            visit(&local);
        }
        Ok(())
    }

    fn energy(&self, q: &[f64]) -> Result<f64, PartError> {
        let energy = |node: &SupportedNode| -> f64 {
            (0..3).map(|i| 0.5 * node.stiffness[i] * (q[3 * node.vector as usize + i] - node.at[i]).powi(2)).sum()
        };
        Ok(self.nodes.iter().map(energy).sum())
    }

    fn dissipated(&self, step: PartStep<'_>) -> f64 {
        if !step.has_rates {
            return 0.0;
        }
        let loss = |node: &SupportedNode| -> f64 {
            let first = 3 * node.vector as usize;
            (0..3).map(|i| node.damping[i] * (step.q_np1[first + i] - step.q_n[first + i]).powi(2) / step.dt).sum()
        };
        self.nodes.iter().map(loss).sum()
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
        let largest = |node: &SupportedNode| node.stiffness.into_iter().fold(0.0, f64::max);
        self.length * self.nodes.iter().map(largest).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn support() -> ElasticSupport {
        let node = |vector, at| SupportedNode { vector, at, stiffness: [2.0, 0.0, 5.0], damping: [0.3, 0.7, 0.0] };
        ElasticSupport::new("support", vec![node(0, [0.1, 0.2, 0.3]), node(2, [0.0; 3])], 1.0).unwrap()
    }

    fn force(support: &ElasticSupport, step: PartStep<'_>) -> (Vec<f64>, Vec<[f64; 9]>) {
        let (mut force, mut tangents) = (vec![0.0; step.q_n.len()], Vec::new());
        let add = |local: &LocalForce| {
            let first = 3 * local.vectors[0] as usize;
            (0..3).for_each(|i| force[first + i] += local.residual[i]);
            tangents.push(std::array::from_fn(|i| local.tangent[i]));
        };
        let mut add = add;
        support.assemble(step, true, &mut add).unwrap();
        (force, tangents)
    }

    /// The work of the forces is the change of energy and the loss, and the tangent is the derivative.
    #[test]
    fn work_is_energy_and_loss() {
        let support = support();
        let q_n = [0.3, -0.1, 0.5, 9.0, 9.0, 9.0, 0.2, 0.4, -0.6];
        let q_np1 = [0.5, 0.3, 0.1, 9.0, 9.0, 9.0, -0.2, 0.1, 0.7];
        let step = PartStep { q_n: &q_n, q_np1: &q_np1, rule: ForceRule::DiscreteGradient, dt: 0.05, has_rates: true };
        let (f, tangents) = force(&support, step);
        let work: f64 = f.iter().zip(q_np1.iter().zip(&q_n)).map(|(f, (new, old))| f * (new - old)).sum();
        let change = support.energy(&q_np1).unwrap() - support.energy(&q_n).unwrap();
        assert!((work - change - support.dissipated(step)).abs() < 1e-14, "{work}");
        assert_eq!(&f[3..6], &[0.0; 3]);
        for (place, vector) in [(0, 0), (1, 2)] {
            for i in 0..3 {
                let mut moved = q_np1;
                moved[3 * vector + i] += 0.25;
                let (g, _) = force(&support, PartStep { q_np1: &moved, ..step });
                for j in 0..3 {
                    // The force is linear.
                    let derivative = (g[3 * vector + j] - f[3 * vector + j]) / 0.25;
                    assert!((derivative - tangents[place][3 * j + i]).abs() < 1e-12);
                }
            }
        }
        let at_rest = PartStep { has_rates: false, ..step };
        assert_eq!(support.dissipated(at_rest), 0.0);
    }

    #[test]
    fn negative_data_are_refused() {
        let node = SupportedNode { vector: 0, at: [0.0; 3], stiffness: [0.0, -1.0, 0.0], damping: [0.0; 3] };
        assert!(ElasticSupport::new("x", vec![node], 1.0).is_err());
    }
}
