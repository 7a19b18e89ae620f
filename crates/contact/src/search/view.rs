//! Queries of the search at given positions.

use super::{Feature, MasterPoint, MasterSearch, Pairing};
use nalgebra::Vector3;
use stoss_geometry::{ClosestPoint, PatchFeature};

/// Longest walk from facet to facet; a longer slide is left to the tree.
const MAX_WALK: usize = 256;

/// Cosine below which two places of the surface are sheets that face away from each other: 120 degrees leave every edge of a
/// body with a dihedral angle above 60 degrees to the plain closest point.
const OPPOSITE_COSINE: f64 = -0.5;

/// Closest point of one facet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub facet: u32,
    pub closest: ClosestPoint,
}

impl Foot {
    pub fn new(facet: u32, closest: ClosestPoint) -> Self {
        Self { facet, closest }
    }
}

/// Whether `own`, where the node came from, is penetrated and `global` is the far side of the same thin body.
fn other_sheet(own: &MasterPoint, global: &MasterPoint) -> bool {
    own.pairing.is_some()
        && own.gap < 0.0
        && matches!(own.feature, Feature::Face { .. })
        && (global.pairing.is_none() || own.normal.dot(&global.normal) < OPPOSITE_COSINE)
}

/// Queries at given positions; see [`MasterSearch::at`]. Cheap to make, copies nothing, allocates nothing.
#[derive(Clone, Copy, Debug)]
pub struct SearchView<'a> {
    pub(super) search: &'a MasterSearch,
    pub(super) q: &'a [f64],
    /// Mean displacement since the tree was refitted.
    shift: Vector3<f64>,
    /// Distance from its place shifted by the mean that no node exceeds.
    excess: f64,
}

impl<'a> SearchView<'a> {
    pub(super) fn new(search: &'a MasterSearch, q: &'a [f64]) -> Self {
        let (shift, excess) = search.tree.motion(&search.surface, q);
        Self { search, q, shift, excess }
    }

    /// The signed closest point of the whole master surface.
    ///
    /// `slave_normal` (unit, outwards of the slave) restricts the partners to facets that oppose it
    /// ([`super::SearchOptions::opposing_cosine`]); facets that do not are treated as if the surface ended there.
    pub fn closest(&self, x: &Vector3<f64>, slave_normal: Option<&Vector3<f64>>) -> MasterPoint {
        match self.global_foot(x, slave_normal) {
            Some(foot) => self.limited(self.resolve(x, &foot, slave_normal)),
            None => MasterPoint::NONE,
        }
    }

    /// The partner of a slave node that was paired with facet `hint` before.
    ///
    /// The facet is kept while the normal projection stays on it, or leaves it by no more than the hysteresis. Otherwise the facets
    /// are walked from `hint` towards the point. The tree's answer is taken unless it lies on the opposite sheet of a thin body (its
    /// normal is turned by more than 120 degrees from the walk's) and the point has penetrated the sheet that it came from,
    /// no deeper than the depth limit. Without a hint, and with a facet number that does not exist, this is [`SearchView::closest`].
    ///
    /// [`MasterPoint::gap`] and `feature` are those of the closest point whenever that is on the same sheet as the kept facet.
    pub fn pair(&self, x: &Vector3<f64>, hint: Option<u32>, slave_normal: Option<&Vector3<f64>>) -> MasterPoint {
        let global = self.closest(x, slave_normal);
        let Some(hint) = hint.filter(|&f| (f as usize) < self.search.surface.facets().len()) else {
            return global;
        };
        let options = &self.search.options;
        // The largest difference between the gap of a kept facet and the true gap.
        let slack = 0.1 * options.hysteresis * self.search.surface.length_scale();

        let patch = self.patch(hint);
        let start = patch.closest_point(x);
        let kept = patch.project(x, start.xi);
        let outside = patch.kind().excess(kept.xi);
        let keeps = kept.converged && outside <= options.hysteresis && (global.gap - kept.gap).abs() <= slack;
        if keeps && self.opposes(hint, &kept.normal, slave_normal) {
            let pairing = Pairing { facet: hint, xi: kept.xi, gap: kept.gap, normal: kept.normal };
            return MasterPoint { pairing: Some(pairing), ..global };
        }

        let local = self.limited(self.resolve(x, &self.walk(x, Foot::new(hint, start)), slave_normal));
        let accepted = local.pairing.is_some_and(|p| self.opposes(p.facet, &p.normal, slave_normal));
        if accepted && other_sheet(&local, &global) { local } else { global }
    }

    /// Nearest foot over all facets that oppose the slave normal, within reach.
    fn global_foot(&self, x: &Vector3<f64>, slave_normal: Option<&Vector3<f64>>) -> Option<Foot> {
        let radius = self.search.reach.max(self.search.depth_limit());
        let mut best: Option<Foot> = None;
        // The relative margin keeps ties in spite of the rounding of the boxes' distances.
        let bound = |distance: f64| distance * (1.0 + 1e-12) + self.excess;
        self.search.tree.tree().nearest(&(x - self.shift), bound(radius), |facet, limit| {
            let facet = facet as u32;
            let patch = self.patch(facet);
            let closest = patch.closest_point(x);
            let smaller = match &best {
                // Of equal ones the first facet, whatever the order of the visits.
                Some(b) => {
                    let (new, old) = (closest.distance_squared, b.closest.distance_squared);
                    new < old || (new == old && facet < b.facet)
                }
                None => closest.distance_squared <= radius * radius,
            };
            if smaller && self.opposes(facet, &patch.normal(closest.xi), slave_normal) {
                best = Some(Foot::new(facet, closest));
                return limit.min(bound(closest.distance_squared.sqrt()));
            }
            limit
        });
        best
    }

    /// Walks from facet to facet, always to the nearest one around the present foot.
    fn walk(&self, x: &Vector3<f64>, start: Foot) -> Foot {
        let surface = &self.search.surface;
        let mut foot = start;
        for _ in 0..MAX_WALK {
            let here = foot;
            let mut consider = |facet: u32| {
                if surface.is_beside(facet) && !self.search.takes_sides {
                    return;
                }
                let closest = self.patch(facet).closest_point(x);
                // The margin prevents walking in circles among facets that share the closest point.
                if closest.distance_squared < foot.closest.distance_squared * (1.0 - 1e-13) {
                    foot = Foot::new(facet, closest);
                }
            };
            match here.closest.feature {
                PatchFeature::Interior => break,
                PatchFeature::Edge(k) => surface.neighbour(here.facet, k).into_iter().for_each(&mut consider),
                PatchFeature::Vertex(k) => {
                    let node = surface.local_facets()[here.facet as usize][k] as usize;
                    surface.facets_around(node).iter().copied().for_each(&mut consider);
                }
            }
            if foot.facet == here.facet {
                break;
            }
        }
        foot
    }

    /// Drops partners that are out of reach or too deep.
    fn limited(&self, point: MasterPoint) -> MasterPoint {
        if point.gap > self.search.reach {
            return if point.pairing.is_some() { MasterPoint::NONE } else { point };
        }
        if point.gap < -self.search.depth_limit() {
            return MasterPoint { gap: f64::INFINITY, pairing: None, ..point };
        }
        point
    }

    pub(super) fn patch(&self, facet: u32) -> stoss_geometry::Patch {
        self.search.surface.patch(facet, self.q)
    }

    pub(super) fn opposes(&self, facet: u32, normal: &Vector3<f64>, slave_normal: Option<&Vector3<f64>>) -> bool {
        let options = &self.search.options;
        let is_beside = self.search.surface.is_beside(facet);
        if is_beside && !self.search.takes_sides {
            return false;
        }
        let cosine = if is_beside { options.cosine_beside } else { options.opposing_cosine };
        slave_normal.is_none_or(|n| normal.dot(n) < cosine)
    }
}
