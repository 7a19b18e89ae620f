//! How far slave facets will slide until the middle of the step.

use crate::method::MortarContact;
use crate::slot::at;
use crate::weights::Measure;
use nalgebra::Vector3;
use stoss_contact::ContactError;

/// Half slides below this part of a facet's length change nothing that matters.
const NOTHING: f64 = 1e-6;

impl MortarContact {
    /// Half the slide of each slave facet in the step if the relative velocity of slave and master at `q_n` lasts, in the plane of the facet, a
    /// length. The velocity is the mean over the nodes of the facet of what their weighted gaps change by; a facet that is opposite nothing takes that of
    /// the nearest one that is. Empty if nothing slides, or if integrals follow the iterate.
    pub(crate) fn half_slides(&self, q_n: &[f64]) -> Result<Vec<Vector3<f64>>, ContactError> {
        if self.moves_integrals() || self.velocity.len() != q_n.len() || self.velocity.iter().all(|v| *v == 0.0) {
            return Ok(Vec::new());
        }
        let present = self.integrate(q_n, &[], &[], &[], Measure::Area)?;
        let rates: Vec<Vector3<f64>> = present.slots.iter().map(|slot| slot.rate(&self.velocity)).collect();
        let facets = self.slave.local_facets();
        let mut slides: Vec<Option<Vector3<f64>>> = facets
            .iter()
            .map(|nodes| {
                let support: f64 = nodes.iter().map(|&n| present.slots[n as usize].support).sum();
                let rate: Vector3<f64> = nodes.iter().map(|&n| rates[n as usize]).sum();
                (support > 0.0).then(|| rate * (0.5 * self.step_size / support))
            })
            .collect();
        // Outward from the facets that have a partner, ring by ring.
        let mut reached: Vec<u32> = (0..facets.len() as u32).filter(|&f| slides[f as usize].is_some()).collect();
        let mut next = 0;
        while let Some(&facet) = reached.get(next) {
            next += 1;
            for other in (0..4).filter_map(|edge| self.slave.neighbour(facet, edge)) {
                if slides[other as usize].is_none() {
                    slides[other as usize] = slides[facet as usize];
                    reached.push(other);
                }
            }
        }
        let in_plane = |(slide, nodes): (&Option<Vector3<f64>>, &[u32; 4])| {
            let x = nodes.map(|n| at(q_n, n));
            let normal = (x[2] - x[0]).cross(&(x[3] - x[1])).try_normalize(0.0).unwrap_or_default();
            let slide = slide.unwrap_or_default();
            slide - normal * normal.dot(&slide)
        };
        let slides: Vec<Vector3<f64>> = slides.iter().zip(self.slave.facets()).map(in_plane).collect();
        let least = NOTHING * self.slave.length_scale();
        Ok(if slides.iter().any(|s| s.norm() > least) { slides } else { Vec::new() })
    }
}
