//! What goes through a surface in one step is found, not lost.

use crate::method::MortarContact;
use crate::state::Surfaces;
use crate::surfaces::area_vector;
use nalgebra::Vector3;
use stoss_contact::{ContactError, FacetNodes, position};
use stoss_reference_element::Nodal;

impl MortarContact {
    /// Fails if a part of the slave that lay before the master has gone deeper than where contact takes notice: the step was too long.
    pub(crate) fn check_passage(&self) -> Result<(), ContactError> {
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
                    return Err(ContactError::Passed { facet: f as u32, before, after: deepest });
                }
            }
        }
        Ok(())
    }
}
