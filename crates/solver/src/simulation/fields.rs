//! Fields of bodies at the last completed step: sums over their elements, on several ranks over those of all. Collective there.

use super::Simulation;
use crate::StepError;
use stoss_fe_solid::{MaterialPoint, NodalSums, OutputPlace, PointState, SolidBody, SolidError};
use stoss_term::Fault;

impl Simulation {
    /// Means at the nodes of a body of what `sums` gives, of [`SolidBody::nodal_cauchy_stress`] for instance.
    ///
    /// # Errors
    /// The errors of `sums`.
    pub fn at_nodes<const N: usize>(
        &self,
        body: usize,
        sums: impl FnOnce(&SolidBody, &[f64]) -> Result<NodalSums<N>, SolidError>,
    ) -> Result<Vec<[f64; N]>, StepError> {
        let sums = sums(&self.model.bodies[body].solid, &self.state.q);
        let mut sums = self.system.shares.agree(sums.map_err(Fault::from))?;
        self.system.shares.sum_all(sums.numbers_mut());
        Ok(sums.means())
    }

    /// State of a body at a point, see [`SolidBody::state_at`].
    ///
    /// # Errors
    /// The errors of [`SolidBody::state_at`].
    pub fn state_at(&self, body: usize, point: &MaterialPoint) -> Result<PointState, StepError> {
        let state = self.model.bodies[body].solid.state_at(point, &self.state.q);
        let mut state = self.system.shares.agree(state.map_err(Fault::from))?;
        // Zeros where the element is not.
        self.system.shares.sum_all(state.deformation_gradient.as_flattened_mut());
        self.system.shares.sum_all(&mut state.green_lagrange);
        self.system.shares.sum_all(&mut state.cauchy);
        Ok(state)
    }

    /// Output of a body's state at a point, see [`SolidBody::state_output_at`].
    ///
    /// # Errors
    /// The errors of [`SolidBody::state_output_at`].
    pub fn state_output_at(
        &self,
        body: usize,
        point: &MaterialPoint,
        place: OutputPlace,
    ) -> Result<Vec<f64>, StepError> {
        let values = self.model.bodies[body].solid.state_output_at(point, &self.state.q, place);
        let mut values = self.system.shares.agree(values.map_err(Fault::from))?;
        self.system.shares.sum_all(&mut values);
        Ok(values)
    }
}
