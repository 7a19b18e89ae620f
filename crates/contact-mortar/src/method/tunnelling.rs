//! Slave facets that pass through the master in one step.

use super::MortarContact;
use crate::state::Surfaces;
use crate::surfaces::area_vector;
use nalgebra::Vector3;
use stoss_contact::{ContactError, FacetNodes, position};
use stoss_reference_element::Nodal;

impl MortarContact {
    /// Fails if a part of the slave that was in front of the master is now deeper behind it than contact reaches: the step was too long.
    ///
    /// # Errors
    /// [`ContactError::Tunnelled`].
    pub(crate) fn check_tunnelling(&self) -> Result<(), ContactError> {
        let depth = self.factors().fading_depth();
        if !depth.is_finite() {
            return Ok(());
        }
        let Surfaces { slave, master, .. } = &self.surfaces;
        let corner = |q: &[f64], nodes: FacetNodes| nodes.map(|n| position(q, n));
        let point = |x: &Nodal<Vector3<f64>>, xi: [f64; 2]| -> Vector3<f64> {
            x.kind().shape(xi).iter().zip(x).map(|(n, x)| x * *n).sum()
        };
        for (f, found) in self.end.segments.iter().enumerate() {
            let Some(found) = found else { continue };
            for segment in &found.segments {
                let v = segment.vertices();
                let deepest = v.iter().map(|v| v.gap).sum::<f64>() / v.len() as f64;
                if deepest > -depth {
                    continue;
                }
                let facets = [slave.facets()[f], master.facets()[segment.master_facet as usize]];
                let [x, y] = facets.map(|nodes| corner(&self.step.q_n, nodes));
                let normal = area_vector(&x).normalize();
                let before: f64 =
                    v.iter().map(|v| (point(&y, v.master) - point(&x, v.slave)).dot(&normal)).sum::<f64>()
                        / v.len() as f64;
                if before >= 0.0 {
                    return Err(ContactError::Tunnelled { facet: f as u32, before, after: deepest });
                }
            }
        }
        Ok(())
    }
}
