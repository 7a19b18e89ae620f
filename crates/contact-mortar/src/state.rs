//! What mortar contact holds: surfaces, built once; what is constant in a step; slots at one configuration.

use crate::candidates::Candidates;
use crate::local::FacetMatrix;
use crate::positions::Positions;
use crate::rows::Row;
use crate::slot::Slot;
use crate::weights::{FacetWeights, Integration, Without};
use crate::{Faces, MortarError};
use nalgebra::Vector3;
use std::collections::HashMap;
use stoss_contact::{ContactError, ContactSurface, in_order};
use stoss_reference_element::MAX_NODES;
use stoss_segmentation::{FacetSegmentation, GapRange, Segment};

/// Surfaces and rows, which are built once.
#[derive(Clone, Debug)]
pub(crate) struct Surfaces {
    pub slave: ContactSurface,
    pub master: ContactSurface,
    /// Quadratic faces that facets of slave and master are pieces of.
    pub faces: [Faces; 2],
    /// The rows of the constraints.
    pub rows: Vec<Row>,
    /// Smooth part of the master that each of its facets belongs to, and how many there are.
    pub smooth_parts: Vec<usize>,
    pub smooth_part_count: usize,
    /// Unit normals of the slave facets in the reference configuration.
    pub normals: Vec<Vector3<f64>>,
    /// Planes of symmetry that nodes (global numbers) lie in, a bit each; those that lie in none are left out.
    pub planes: HashMap<u32, u8>,
    /// Slave nodes without a multiplier, by local number.
    pub without: Vec<bool>,
    pub integration: Integration,
}

/// State of the method that is constant in a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepState {
    pub candidates: Candidates,
    /// The nodes that the step looks at.
    pub nodes: Vec<u32>,
    pub range: Option<GapRange>,
    /// Positions at the start.
    pub q_n: Vec<f64>,
    /// Slots there.
    pub start: Vec<Slot>,
    /// Weighted gap of each row there; `None` without a partner.
    pub gap: Vec<Option<f64>>,
    /// The gradient there of the weighted gap beyond `distance`, of the rows that needed it.
    pub gradient: Vec<Vec<f64>>,
    /// Distance that a closed row keeps. Of a row that is open at the start of the step it is the one that it would keep if it closed.
    pub reference: Vec<f64>,
    /// Distance beyond which the gap is counted in the force of a row: the one where the force is taken.
    pub distance: Vec<f64>,
    /// Change of the reference in the step of rows that are held and come down, not positive.
    pub settling: Vec<f64>,
    /// Rows that may carry a multiplier.
    pub carried: Vec<bool>,
    /// Corners of the slave facets that hand their functions over.
    pub without: Vec<Without>,
}

/// Slots at one configuration.
#[derive(Clone, Debug, Default)]
pub(crate) struct Integrated {
    /// Positions of the nodes that the step looks at ([`StepState::nodes`]); empty before the first evaluation.
    pub at: Vec<f64>,
    pub segments: Vec<Option<FacetSegmentation>>,
    pub slots: Vec<Slot>,
    /// Moments ([`FacetWeights::moments`]) of each slave facet against each smooth part of the master; empty if the slave has no quadratic faces.
    pub moments: Vec<Option<FacetMatrix>>,
    /// Rows whose derivatives are there.
    pub derivatives: Vec<bool>,
}

impl StepState {
    /// Weighted gap of a row at the start beyond the distance that its force counts from.
    pub fn start_beyond(&self, row: usize) -> f64 {
        self.gap[row].map_or(0.0, |gap| gap - self.distance[row] * self.start[row].support)
    }

    /// Notes the positions that integrals belong to.
    pub fn note(&self, q: &[f64], at: &mut Vec<f64>) {
        at.clear();
        at.extend(self.nodes.iter().flat_map(|&node| &q[3 * node as usize..3 * node as usize + 3]));
    }

    /// Whether integrals of those positions are those at `q`.
    pub fn is_at(&self, q: &[f64], at: &[f64]) -> bool {
        let q = |node: u32| &q[3 * node as usize..3 * node as usize + 3];
        !at.is_empty() && self.nodes.iter().zip(at.chunks_exact(3)).all(|(&node, at)| q(node) == at)
    }
}

/// Integrals that are asked of a slave facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Need {
    Nothing,
    Value,
    Derivative,
}

pub(crate) fn segmentation_error(error: &MortarError) -> ContactError {
    ContactError::Segmentation { reason: error.to_string() }
}

impl Surfaces {
    /// Segments and slots at `q`, which is not noted. `old`: slots whose nodes stay in front. Rows on facets that were not asked for are empty.
    pub fn integrate(
        &self,
        candidates: &Candidates,
        q: Positions<'_>,
        needs: &[Need],
        without: &[Without],
        old: &[Slot],
        with_facets: bool,
    ) -> Result<Integrated, ContactError> {
        let Self { slave, master, rows, faces: [slave_faces, master_faces], .. } = self;
        let mut segments: Vec<Option<FacetSegmentation>> = vec![None; needs.len()];
        let mut facets: Vec<Option<FacetWeights>> = vec![None; needs.len() * self.smooth_part_count];
        let asked: Vec<usize> = (0..needs.len()).filter(|&f| needs[f] != Need::Nothing).collect();
        let compute = |&f: &usize, (segments, facets): &mut (Option<FacetSegmentation>, Vec<Option<FacetWeights>>)| {
            let found = candidates
                .segment(slave, master, f as u32, &self.planes, q)
                .map_err(|error| segmentation_error(&error))?;
            facets.extend((0..self.smooth_part_count).map(|part| {
                let is_of_part = |segment: &&Segment| self.smooth_parts[segment.master_facet as usize] == part;
                let own: Vec<Segment> = found.segments.iter().filter(is_of_part).cloned().collect();
                let corners = |m| q.corners(master, m);
                (!own.is_empty()).then(|| {
                    let found = FacetSegmentation { frame: found.frame.clone(), segments: own, hidden: Vec::new() };
                    let without = without[f * self.smooth_part_count + part];
                    let face = slave_faces.of(f as u32);
                    let want_derivative = needs[f] == Need::Derivative;
                    self.integration.facet_weights(&found, corners, face, master_faces, without, want_derivative)
                })
            }));
            *segments = Some(found);
            Ok(())
        };
        in_order(&asked, compute, |&f, (of_facet, parts)| {
            segments[f] = of_facet.take();
            let first = f * self.smooth_part_count;
            facets[first..first + self.smooth_part_count].swap_with_slice(parts);
            parts.clear();
        })?;
        let moments = match slave_faces.are_linear() {
            true => Vec::new(),
            false => facets.iter().map(|facet| facet.as_ref().map(|facet| facet.moments)).collect(),
        };
        let wanted = |row: &Row| row.facets.iter().all(|&(f, _)| needs[f as usize] != Need::Nothing);
        let derived = |row: &Row| row.facets.iter().all(|&(f, _)| needs[f as usize] == Need::Derivative);
        let kept = |k: usize| old.get(k).map_or(&[][..], |slot: &Slot| &slot.nodes);
        let mut slots = vec![Slot::default(); rows.len()];
        let wanted: Vec<usize> = (0..rows.len()).filter(|&k| wanted(&rows[k])).collect();
        let gather = |&k: &usize, slot: &mut Slot| {
            let row = &rows[k];
            let of = |f: u32| facets[f as usize * self.smooth_part_count + row.smooth_part].as_ref();
            *slot = Slot::gather(row, [slave, master], [slave_faces, master_faces], &of, kept(k), with_facets);
            Ok::<_, ContactError>(())
        };
        in_order(&wanted, gather, |&k, slot| slots[k] = std::mem::take(slot))?;
        Ok(Integrated { at: Vec::new(), moments, segments, slots, derivatives: rows.iter().map(derived).collect() })
    }

    /// Corners of each slave facet, against each smooth part of the master, that hand their functions over: those of crosspoints, and of rows that carry nothing in the step, unless nobody is left.
    pub fn handing_over(&self, carried: Option<&[bool]>) -> Vec<Without> {
        let facets = self.slave.local_facets().iter().map(|nodes| -> Without {
            std::array::from_fn(|k| nodes.get(k).is_none_or(|&n| self.without[n as usize]))
        });
        let crosspoints: Vec<Without> = facets.flat_map(|f| std::iter::repeat_n(f, self.smooth_part_count)).collect();
        let Some(carried) = carried else { return crosspoints };
        let mut out = crosspoints.clone();
        for (row, _) in self.rows.iter().zip(carried).filter(|(_, carried)| !**carried) {
            let place = |f: u32| f as usize * self.smooth_part_count + row.smooth_part;
            row.facets.iter().for_each(|&(f, corner)| out[place(f)][corner] = true);
        }
        for (out, crosspoints) in out.iter_mut().zip(&crosspoints).filter(|(out, _)| **out == [true; MAX_NODES]) {
            *out = *crosspoints;
        }
        out
    }

    /// Needs of the facets around rows: derivatives around those that are chosen, values around the others.
    pub fn needs_among(&self, rows: &[bool], chosen: &[bool]) -> Vec<Need> {
        let mut needs = self.needs(Need::Nothing, chosen);
        for (row, _) in self.rows.iter().zip(rows).filter(|(_, of)| **of) {
            row.facets.iter().for_each(|&(f, _)| needs[f as usize] = needs[f as usize].max(Need::Value));
        }
        needs
    }

    /// Needs of the facets: `least` of all, derivatives of those around rows that are chosen.
    pub fn needs(&self, least: Need, chosen: &[bool]) -> Vec<Need> {
        let mut needs = vec![least; self.slave.facets().len()];
        for (row, _) in self.rows.iter().zip(chosen).filter(|(_, chosen)| **chosen) {
            row.facets.iter().for_each(|&(f, _)| needs[f as usize] = Need::Derivative);
        }
        needs
    }
}
