//! Centrifugal loads.

use crate::assembly::System;
use crate::system::between;
use crate::{Load, LoadKind};
use stoss_fe_solid::TangentTarget;
use stoss_integrators::StepConfiguration;

impl System {
    /// Adds the force `w^2 M P (q - c)` of a centrifugal load to `follower`, at `q = (1 - theta) q_n + theta q_np1` and the time of that, and with `tangent` that times
    /// its derivative with respect to `q_np1` to the solids' values, as the residual has it. The force is linear in the positions: at the midpoint its work is exactly the change of
    /// the potential, and so is that of the mean of both ends.
    pub(crate) fn add_centrifugal(
        &mut self,
        load: &Load,
        step: StepConfiguration<'_>,
        theta: f64,
        tangent: Option<f64>,
    ) {
        let LoadKind::Centrifugal { body, mass, axis, about } = &load.kind else { return };
        let Self { solid_map: map, solid_values: values, first_stencil, follower, arms, .. } = self;
        let speed = load.magnitude.value(step.time + theta * step.dt, 0);
        let projector: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) - axis[i] * axis[j]));
        arms.resize(follower.len(), 0.0);
        for node in mass.nodes() {
            let arm = between(step, theta, node);
            let arm: [f64; 3] = std::array::from_fn(|i| arm[i] - about[i]);
            for (i, row) in projector.iter().enumerate() {
                arms[3 * node as usize + i] = row.iter().zip(&arm).map(|(p, a)| p * a).sum();
            }
        }
        mass.multiply_add(speed * speed, arms, follower);
        if let Some(weight) = tangent {
            let (first_stencil, factor) = (first_stencil[*body], -weight * theta * speed * speed);
            mass.add_blocks_to_tangent(&projector, TangentTarget { map, first_stencil, factor, values });
        }
    }
}
