//! Forces of the damping of bodies in a step, and of the stabilisation of statics.

use crate::assembly::System;
use crate::matrix::Fixed;
use crate::system::FeSystem;
use crate::{Damping, Model, StepError};
use std::sync::Arc;
use stoss_fe_solid::{TangentTarget, ViscousRate};
use stoss_integrators::DampingTangent;
use stoss_linalg::vector;
use stoss_term::Fault;

impl System {
    /// Whether the present stage has inertia; without, nothing has a rate and bodies are not damped.
    pub fn set_has_rates(&mut self, has_rates: bool, model: &Model) {
        self.present.has_rates = has_rates;
        self.present.has_damping = has_rates && model.bodies.iter().any(|body| body.damping.acts());
    }

    /// What dampers of bodies took out of a step of this size: their power at the velocity of the scheme, over the step. It is a sum of squares.
    pub fn damped(&self, dt: f64) -> f64 {
        if !(self.present.has_damping && self.present.has_rates) {
            return 0.0;
        }
        let of = |own: &std::ops::Range<usize>| {
            vector::dot(&self.buffers.damping[own.clone()], &self.buffers.rate[own.clone()])
        };
        // Round-off of a rigid motion has any sign.
        (dt * self.own.iter().map(of).sum::<f64>()).max(0.0)
    }

    /// Sets the part of the stabilisation that acts at the end of a step; without a rest nothing of it is evaluated.
    pub fn set_ramp(&mut self, ramp: f64) {
        if let Some(stabilisation) = &mut self.present.stabilisation {
            stabilisation.ramp = ramp;
            self.present.has_damping = ramp > 0.0;
        }
    }

    /// Energy whose gradient the forces of the stabilisation are in a static step of this `increment`.
    pub fn stabilisation_energy(&self, increment: &[f64], dt: f64) -> f64 {
        let Some(of) = self.present.stabilisation.as_ref().filter(|_| self.present.has_damping) else { return 0.0 };
        vector::dot(&of.sum(&self.shares, &[(0.5 * of.ramp / dt, increment)]), increment)
    }

    /// Work that stabilisation took in a static step with this `increment`, by the trapezium rule as that of loads is measured: before the step, where `ramp_n` of it acted, the
    /// velocities were `v_n`.
    pub fn stabilised(&self, ramp_n: f64, v_n: &[f64], increment: &[f64], dt: f64) -> f64 {
        let Some(of) = &self.present.stabilisation else { return 0.0 };
        vector::dot(&of.sum(&self.shares, &[(0.5 * ramp_n, v_n), (0.5 * of.ramp / dt, increment)]), increment)
    }

    /// Sum of the magnitudes of the components of the forces of stabilisation at the end of a static step with this `increment`; nothing without a stabilisation.
    pub fn stabilising(&self, increment: &[f64], dt: f64) -> Option<f64> {
        let of = self.present.stabilisation.as_ref()?;
        Some(of.sum(&self.shares, &[(of.ramp / dt, increment)]).iter().map(|f| f.abs()).sum())
    }
}

impl FeSystem<'_> {
    /// Forces of the damping of bodies, or in statics of their stabilisation, at `q` with the velocities `v`.
    pub(crate) fn add_body_damping(
        &mut self,
        q: &[f64],
        v: &[f64],
        tangent: Option<DampingTangent>,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        let shares = Arc::clone(&self.system.shares);
        let added = shares.add_sum(out, |out| self.add_own_damping(q, v, tangent, out));
        Ok(shares.agree(added)?)
    }

    /// Adds the damping of this rank's elements.
    fn add_own_damping(
        &mut self,
        q: &[f64],
        v: &[f64],
        tangent: Option<DampingTangent>,
        out: &mut [f64],
    ) -> Result<(), Fault> {
        let System { matrix, inertia, present, .. } = &mut *self.system;
        let Fixed { map, values, forces, .. } = &mut matrix.fixed;
        if let Some(stabilisation) = present.stabilisation.as_ref().filter(|_| !present.has_rates) {
            for (mass, stencils) in stabilisation.masses().iter().zip(&*forces) {
                let first_stencil = stencils.start;
                mass.multiply_add(stabilisation.ramp, v, out);
                if let Some(DampingTangent { weight, rate, .. }) = tangent {
                    let target = TangentTarget { map, first_stencil, factor: stabilisation.ramp, values };
                    mass.add_to_tangent(weight * rate, target);
                }
            }
            return Ok(());
        }
        for (b, body) in self.model.bodies.iter().enumerate() {
            let Damping { mass, stiffness } = body.damping;
            let first_stencil = forces[b].start;
            if mass > 0.0
                && let Some(matrix) = inertia.masses.bodies.get(b)
            {
                matrix.multiply_add(mass, v, out);
                if let Some(DampingTangent { weight, rate, .. }) = tangent {
                    let target = TangentTarget { map, first_stencil, factor: mass, values };
                    matrix.add_to_tangent(weight * rate, target);
                }
            }
            if stiffness > 0.0 {
                let slopes = tangent.map_or([0.0; 2], |at| [at.position, at.rate]);
                let target =
                    tangent.map(|at| TangentTarget { map, first_stencil, factor: at.weight, values: &mut *values });
                let rate = ViscousRate { q, v, factor: stiffness, slopes };
                body.solid.add_viscous_force(rate, out, target)?;
            }
        }
        Ok(())
    }
}
