//! The balance of momenta and energies.

use serde::{Deserialize, Serialize};

/// Balance at the end of a step. Angular momentum is about the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Linear momentum (mass times velocity).
    pub linear_momentum: [f64; 3],
    /// Angular momentum about the origin.
    pub angular_momentum: [f64; 3],
    /// Kinetic energy.
    pub kinetic: f64,
    /// Strain energy.
    pub strain: f64,
    /// Potential of the active dead loads that are constant in time; zero in the reference configuration.
    pub potential: f64,
    /// Energy stored in contact (regularisations; zero for multipliers).
    pub contact: f64,
    /// Energy dissipated since the start, non-decreasing: by friction, dampers, the damping and the materials of bodies, and what is dropped when a static stage
    /// follows a dynamic one: the kinetic energy, and what the first step gives up on the way to equilibrium.
    pub dissipation: f64,
    /// The part of `dissipation` that the damping of bodies ([`crate::Damping`]) took.
    pub damping: f64,
    /// The part of `dissipation` that plastic flow took.
    pub plastic_loss: f64,
    /// The part of `dissipation` that viscous flow of materials took.
    pub viscous_loss: f64,
    /// The part of `dissipation` that softening of materials took.
    pub softening_loss: f64,
    /// The part of `strain` that hardening has stored. With `plastic_loss` it is the plastic work.
    pub hardening: f64,
    /// External work since the start: of loads that vary in time and of prescribed motion, and the jumps of `potential`, `contact` and `kinetic` where loads and
    /// couplings are switched on or off and where a dynamic stage sets velocities.
    pub external_work: f64,
    /// Work dissipated by the stabilisation of static stages since the start ([`crate::Stabilise`]), by the trapezium rule.
    pub stabilisation: f64,
    /// Work that friction and dampers between points have taken from the bodies since the start, computed from their forces: equal to `friction_stored + dissipation` less [`Self::dissipated_in_bodies`], except for round-off and
    /// the residual of the iterations; a change of stage may drop energy of either kind.
    pub friction_work: f64,
    /// The part of `contact` that is stored in the tangential springs of friction.
    pub friction_stored: f64,
    /// Work that the normal contact forces and the limits of joints have taken from the bodies since the start and do not store, computed from forces and displacements: the
    /// loss at closing gaps, negative where contact added energy. Zero in statics.
    pub closing_loss: f64,
    /// The part of `closing_loss` that is not explained by closing gaps, since the start. Zero for methods that do not report the loss of closing gaps
    /// ([`stoss_term::Work::closing`]).
    pub contact_remainder: f64,
    /// Energy that impacts have taken by the law of impact since the start: what closing gaps cost where the law does not act is in `closing_loss`.
    pub impact_loss: f64,
    /// The part of it at contacts of a deformable body. It is the energy of the nodes that meet a surface, a number of the mesh.
    pub impact_deformable: f64,
    /// Slots that closed under the law of impact since the start.
    pub impacts: u64,
    /// Energy that the law of impact would have added, and was kept from adding, since the start. It is zero but where a step does not resolve an impact.
    pub impact_capped: f64,
    /// Largest kinetic and strain energy together since the start, beside which errors are judged.
    pub largest_energy: f64,
}

impl Balance {
    /// The part of `dissipation` in bodies: by their damping and their materials.
    pub fn dissipated_in_bodies(&self) -> f64 {
        self.damping + self.plastic_loss + self.viscous_loss + self.softening_loss
    }

    /// The total energy: kinetic + strain + potential + contact + dissipation + stabilisation - external work. A scheme that conserves
    /// energy keeps the sum of it, `closing_loss` and `impact_loss` constant.
    pub fn total(&self) -> f64 {
        self.kinetic + self.strain + self.potential + self.contact + self.dissipation + self.stabilisation
            - self.external_work
    }
}
