//! Springs and dashpots between nodes and the ground, for surfaces on a foundation.

use crate::error::{PartDataError, not_negative};
use std::ops::Range;
use stoss_part::{ForceRule, LocalForce, Part, PartError, PartStep};

/// The axes of space.
pub const AXES_OF_SPACE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Springs and dashpots of one node, along three axes that are fixed in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportedNode {
    /// Its vector.
    pub vector: u32,
    /// `X`, where the springs have no force.
    pub at: [f64; 3],
    /// `a_i`, orthonormal.
    pub axes: [[f64; 3]; 3],
    /// `k_i`, a force per length along each axis.
    pub stiffness: [f64; 3],
    /// `d_i`, a force per velocity along each axis.
    pub damping: [f64; 3],
}

/// An elastic support: springs and dashpots from nodes to fixed points of the ground.
///
/// With `u_i = a_i . (x - X)` of each node the energy is `V = 1/2 sum_i k_i u_i^2`, whose discrete gradient is `k_i (u_i,n + u_i,n+1) / 2`. The dashpots have the force
/// `d_i (u_i,n+1 - u_i,n) / dt` whatever the rule, and take `d_i (u_i,n+1 - u_i,n)^2 / dt` out of a step. Axes do not act on each other.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticSupport {
    name: String,
    nodes: Vec<SupportedNode>,
    length: f64,
}

impl SupportedNode {
    /// Components along the axes of `x - from`, where these have the node's vector.
    fn along(&self, x: &[f64], from: &[f64]) -> [f64; 3] {
        let first = 3 * self.vector as usize;
        self.axes.map(|axis| (0..3).map(|k| axis[k] * (x[first + k] - from[k])).sum())
    }

    /// `u_i`, how far the springs are stretched.
    fn stretch(&self, q: &[f64]) -> [f64; 3] {
        self.along(q, &self.at)
    }

    /// Components along the axes of the motion in a step.
    fn motion(&self, step: &PartStep<'_>) -> [f64; 3] {
        let first = 3 * self.vector as usize;
        self.along(step.q_np1, &step.q_n[first..first + 3])
    }
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
            let (old, new, motion) = (node.stretch(step.q_n), node.stretch(step.q_np1), node.motion(&step));
            for (i, axis) in node.axes.iter().enumerate() {
                let damper = if step.has_rates { node.damping[i] / step.dt } else { 0.0 };
                let between = (1.0 - theta) * old[i] + theta * new[i];
                let force = node.stiffness[i] * between + damper * motion[i];
                let slope = theta * node.stiffness[i] + damper;
                for k in 0..3 {
                    local.residual[k] += force * axis[k];
                    for l in (0..3).filter(|_| want_tangent) {
                        local.tangent[3 * k + l] += slope * axis[k] * axis[l];
                    }
                }
            }
            visit(&local);
        }
        Ok(())
    }

    fn energy(&self, q: &[f64]) -> Result<f64, PartError> {
        let energy = |node: &SupportedNode| -> f64 {
            node.stretch(q).iter().zip(node.stiffness).map(|(u, k)| 0.5 * k * u * u).sum()
        };
        Ok(self.nodes.iter().map(energy).sum())
    }

    fn dissipated(&self, step: PartStep<'_>) -> f64 {
        if !step.has_rates {
            return 0.0;
        }
        let loss = |node: &SupportedNode| -> f64 {
            node.motion(&step).iter().zip(node.damping).map(|(u, d)| d * u * u / step.dt).sum()
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
        let (stiffness, damping) = ([2.0, 0.0, 5.0], [0.3, 0.7, 0.0]);
        let node = |vector, at, axes| SupportedNode { vector, at, axes, stiffness, damping };
        let inclined = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];
        let nodes = vec![node(0, [0.1, 0.2, 0.3], AXES_OF_SPACE), node(2, [0.0; 3], inclined)];
        ElasticSupport::new("support", nodes, 1.0).unwrap()
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
        let stiffness = [0.0, -1.0, 0.0];
        let node = SupportedNode { vector: 0, at: [0.0; 3], axes: AXES_OF_SPACE, stiffness, damping: [0.0; 3] };
        assert!(ElasticSupport::new("x", vec![node], 1.0).is_err());
    }
}
