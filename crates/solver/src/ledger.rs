//! Momenta and energies.

use serde::{Deserialize, Serialize};

/// Balance at the end of a step. Angular momentum is about the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Linear momentum.
    pub linear_momentum: [f64; 3],
    /// Angular momentum about the origin.
    pub angular_momentum: [f64; 3],
    /// Kinetic energy.
    pub kinetic: f64,
    /// Strain energy.
    pub strain: f64,
    /// Potential of dead loads that act and are constant in time, zero in the reference configuration.
    pub potential: f64,
    /// Energy stored in contact (regularisations; zero for multipliers).
    pub contact: f64,
    /// Energy dissipated since the start, never less than a step before: by friction, dampers and the damping of bodies, and the kinetic energy that a change from dynamics to statics
    /// drops.
    pub dissipation: f64,
    /// The part of `dissipation` that the damping of bodies took ([`crate::Damping`]).
    pub damping: f64,
    /// Work done since the start by loads that vary in time and by prescribed motion, and what `potential`, `contact` and `kinetic` gain where loads and
    /// couplings are switched on or off and where a stage of dynamics gives velocities.
    pub external_work: f64,
    /// Work that stabilisation of static stages took since the start ([`crate::Stabilise`]), by the trapezium rule.
    pub stabilisation: f64,
    /// Work that friction and dampers between points have taken out of the bodies since the start, measured with their forces: `friction_stored + dissipation - damping`, but for round-off and
    /// what the iterations leave; between changes of stage, which may drop energy of either kind.
    pub friction_work: f64,
    /// The part of `contact` that is in the tangential springs of friction.
    pub friction_stored: f64,
    /// Work that the normal forces of contact have taken out of the bodies since the start and do not store, measured with forces and displacements: the
    /// loss of closing gaps, negative where contact gave energy. In dynamics; zero in statics.
    pub closing_loss: f64,
    /// The part of `closing_loss` that no gap cost which closed, since the start: what the forces did otherwise than the gaps tell. Zero where a method does not tell
    /// ([`stoss_contact::ContactWork::closing`]).
    pub contact_remainder: f64,
    /// What of `closing_loss` went back into velocities, since the start.
    pub restored: f64,
}

impl Balance {
    /// What an energy-conserving scheme keeps: kinetic + strain + potential + contact + dissipation + stabilisation - external work. A scheme that conserves
    /// energy keeps it but for `closing_loss - restored`.
    pub fn total(&self) -> f64 {
        self.kinetic + self.strain + self.potential + self.contact + self.dissipation + self.stabilisation
            - self.external_work
    }
}
