//! Segmentation of two contact surfaces.

use crate::MortarError;
use crate::positions::Positions;
use nalgebra::Vector3;
use stoss_contact::{ContactSurface, SurfaceTree};
use stoss_geometry::{Aabb, BoundingVolumeTree};
use stoss_reference_element::Nodal;
use stoss_segmentation::{FacetSegmentation, GapRange, MasterFacet, SlaveFrame, check_coverage, segment_facet};

/// Segments of all slave facets.
#[derive(Clone, Debug)]
pub struct SurfaceSegmentation {
    /// One entry a slave facet, in the surface's order.
    pub facets: Vec<FacetSegmentation>,
    /// Range of gaps that was asked for.
    pub range: GapRange,
}

/// Which part of the master a check of coverage looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckExtent {
    /// The facets found, two rings of their neighbours, and all facets that may lie opposite at all, looked for one by one and without the tree of the
    /// search.
    Near,
    /// The whole master surface, for every slave facet.
    Everything,
}

/// A slave facet whose segments do not tile its overlap with the master. Areas are measured in the segmentation plane.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageFault {
    /// Local number of the slave facet.
    pub slave_facet: u32,
    /// Uncovered area that lies opposite the master.
    pub uncovered_opposite: f64,
    /// Master facets that should cover it.
    pub master_facets: Vec<u32>,
    /// Area covered twice.
    pub double: f64,
    /// Interior edges that do not fit.
    pub open_edges: usize,
}

/// Coverage of the slave surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceCoverage {
    /// Area of the slave facets' images.
    pub area: f64,
    /// Area covered by segments.
    pub covered: f64,
    /// Largest part of a facet that lies opposite the master without a segment, or is covered twice: round-off if the invariant holds.
    pub worst: f64,
    /// Facets whose segments do not tile their overlap, ascending; empty if the invariant holds.
    pub faults: Vec<CoverageFault>,
}

/// Parametric tolerance of the invariant.
const TOLERANCE: f64 = 1e-12;

pub(crate) fn corners<'a>(surface: &ContactSurface, facet: u32, q: impl Into<Positions<'a>>) -> Nodal<Vector3<f64>> {
    q.into().corners(surface, facet)
}

/// The two vectors of [`stoss_reference_element::FacetKind::diagonals`].
pub(crate) fn diagonals(x: &Nodal<Vector3<f64>>) -> [Vector3<f64>; 2] {
    x.kind().diagonals().map(|d| x.iter().zip(d).map(|(x, c)| x * c).sum())
}

/// Twice the area of a facet along its normal.
pub(crate) fn area_vector(x: &Nodal<Vector3<f64>>) -> Vector3<f64> {
    let [d_1, d_2] = diagonals(x);
    d_1.cross(&d_2)
}

pub(crate) fn master_facet<'a>(master: &ContactSurface, id: u32, q: impl Into<Positions<'a>>) -> MasterFacet {
    MasterFacet { id, nodes: master.facets()[id as usize], corners: corners(master, id, q) }
}

/// Segments every slave facet against the master surface at positions `q` (`3 * nodes` entries, of both bodies).
///
/// `range` limits the gaps at which facets are opposite each other; [`GapRange::ALL`] is allowed.
///
/// # Errors
/// [`MortarError::Range`], [`MortarError::Segmentation`].
pub fn segment_surfaces(
    slave: &ContactSurface,
    master: &ContactSurface,
    q: &[f64],
    range: GapRange,
) -> Result<SurfaceSegmentation, MortarError> {
    if range.min.is_nan() || range.max.is_nan() || range.min > range.max {
        return Err(MortarError::Range { min: range.min, max: range.max });
    }
    let boxes: Vec<Aabb> =
        (0..master.facets().len() as u32).map(|f| Aabb::from_points(&corners(master, f, q))).collect();
    let tree = BoundingVolumeTree::build(&boxes);
    let bounds = tree.bounds();
    let mut found = Vec::new();
    let mut candidates = Vec::new();
    let mut facets = Vec::with_capacity(slave.facets().len());
    for facet in 0..slave.facets().len() as u32 {
        let at = |source| MortarError::Segmentation { facet, source };
        let x = corners(slave, facet, q);
        let normal = SlaveFrame::new(x).map_err(at)?.normal();
        found.clear();
        tree.query(&region(&x, normal, &bounds, range), |f| found.push(f as u32));
        found.sort_unstable();
        candidates.clear();
        candidates.extend(found.iter().map(|&f| master_facet(master, f, q)));
        facets.push(segment_facet(x, &candidates, range).map_err(at)?);
    }
    Ok(SurfaceSegmentation { facets, range })
}

/// A slave facet swept along its normal through the range, no farther than the master's bounds reach.
pub(crate) fn region(x: &Nodal<Vector3<f64>>, normal: Vector3<f64>, bounds: &Aabb, range: GapRange) -> Aabb {
    let own = Aabb::from_points(x);
    let far = (bounds.max - bounds.min).norm() + (bounds.max - own.min).norm() + (own.max - bounds.min).norm();
    let (low, high) = (range.min.clamp(-far, far), range.max.clamp(-far, far));
    let size = x.iter().map(|c| c.amax()).fold(0.0, f64::max);
    let [low, high] = [low, high].map(|far| x.map(|x| x + normal * far));
    let [low, high] = [Aabb::from_points(&low), Aabb::from_points(&high)];
    Aabb::from_points(&[low.min, low.max, high.min, high.max]).inflated(1e-12 * (far + size))
}

/// The least distance from the middle of a facet, against its normal, to a facet of the same surface that looks the other way: how thin the body is
/// where both of its sides belong to the surface. Infinity if they do so nowhere. A length.
pub(crate) fn thickness(surface: &ContactSurface, q: &[f64]) -> f64 {
    let facets: Vec<Nodal<Vector3<f64>>> = (0..surface.facets().len() as u32).map(|f| corners(surface, f, q)).collect();
    let normals: Vec<Vector3<f64>> = facets.iter().map(area_vector).collect();
    let boxes: Vec<Aabb> = facets.iter().map(|x| Aabb::from_points(&x[..])).collect();
    let tree = BoundingVolumeTree::build(&boxes);
    let bounds = tree.bounds();
    let extent = (bounds.max - bounds.min).norm();
    let mut least = f64::INFINITY;
    for (x, normal) in facets.iter().zip(&normals) {
        let Some(inward) = (-normal).try_normalize(0.0) else { continue };
        let middle = x.iter().sum::<Vector3<f64>>() / x.len() as f64;
        let end = middle + inward * extent.min(least);
        tree.query(&Aabb::from_points(&[middle, end]).inflated(1e-12 * extent), |other| {
            if normals[other].dot(&inward) > 0.0 {
                let y = &facets[other];
                for [a, b, c] in y.kind().triangles().iter().map(|t| t.map(|k| y[k])) {
                    least =
                        distance_along(middle, inward, a, b, c).filter(|d| *d > 0.0).map_or(least, |d| least.min(d));
                }
            }
        });
    }
    least
}

/// Where a line meets a triangle, after Moeller and Trumbore (Journal of Graphics Tools 2, 1997).
fn distance_along(
    from: Vector3<f64>,
    along: Vector3<f64>,
    a: Vector3<f64>,
    b: Vector3<f64>,
    c: Vector3<f64>,
) -> Option<f64> {
    let (u, v, s) = (b - a, c - a, from - a);
    let (p, q) = (along.cross(&v), s.cross(&u));
    let determinant = u.dot(&p);
    let (xi, eta) = (s.dot(&p) / determinant, along.dot(&q) / determinant);
    // A line in the triangle's plane gives a NaN or an infinity.
    (xi >= 0.0 && eta >= 0.0 && xi + eta <= 1.0).then(|| v.dot(&q) / determinant)
}

impl SurfaceSegmentation {
    /// Checks the invariant of coverage at the positions `q` of the segmentation.
    ///
    /// # Errors
    /// [`MortarError::Segmentation`].
    pub fn check(
        &self,
        master: &ContactSurface,
        q: &[f64],
        extent: CheckExtent,
    ) -> Result<SurfaceCoverage, MortarError> {
        self.check_with(master, None, q, extent)
    }

    /// [`Self::check`]. A tree of a surface that moves as a whole tells, box by box, which facets are far from all slave facets.
    pub(crate) fn check_with(
        &self,
        master: &ContactSurface,
        tree: Option<&SurfaceTree>,
        q: &[f64],
        extent: CheckExtent,
    ) -> Result<SurfaceCoverage, MortarError> {
        let mut out = SurfaceCoverage { area: 0.0, covered: 0.0, worst: 0.0, faults: Vec::new() };
        let mut ids: Vec<u32> = Vec::new();
        let everything: Vec<MasterFacet> = match extent {
            CheckExtent::Near => Vec::new(),
            CheckExtent::Everything => (0..master.facets().len() as u32).map(|f| master_facet(master, f, q)).collect(),
        };
        let with_box = |f: u32| (f, Aabb::from_points(&corners(master, f, q)));
        let (boxes, bounds): (Vec<(u32, Aabb)>, Aabb) = match (extent, tree.filter(|_| master.carriers().is_some())) {
            (CheckExtent::Near, None) => {
                let boxes: Vec<_> = (0..master.facets().len() as u32).map(with_box).collect();
                let bounds = boxes.iter().fold(Aabb::empty(), |all, (_, b)| all.union(b));
                (boxes, bounds)
            }
            (CheckExtent::Near, Some(tree)) => {
                let (shift, excess) = tree.motion(master, q);
                let moved = |b: &Aabb, by: Vector3<f64>| Aabb { min: b.min + by, max: b.max + by }.inflated(excess);
                let bounds = moved(&tree.tree().bounds(), shift);
                let regions =
                    self.facets.iter().map(|f| region(f.frame.corners(), f.frame.normal(), &bounds, self.range));
                let then = moved(&regions.fold(Aabb::empty(), |all, b| all.union(&b)), -shift);
                let near = (0..tree.tree().len()).filter(|&f| tree.tree().item_box(f).overlaps(&then));
                (near.map(|f| with_box(f as u32)).collect(), bounds)
            }
            (CheckExtent::Everything, _) => (Vec::new(), Aabb::empty()),
        };
        let mut near: Vec<MasterFacet> = Vec::new();
        for (slave_facet, found) in self.facets.iter().enumerate() {
            let surface = if extent == CheckExtent::Everything {
                &everything
            } else {
                ids.clear();
                ids.extend(found.segments.iter().map(|s| s.master_facet).chain(found.hidden.iter().map(|h| h.id)));
                for _ in 0..2 {
                    for i in 0..ids.len() {
                        ids.extend(master.neighbours(ids[i]));
                    }
                    ids.sort_unstable();
                    ids.dedup();
                }
                let opposite = region(found.frame.corners(), found.frame.normal(), &bounds, self.range);
                ids.extend(boxes.iter().filter(|(_, b)| b.overlaps(&opposite)).map(|(f, _)| *f));
                ids.sort_unstable();
                ids.dedup();
                near.clear();
                near.extend(ids.iter().map(|&f| master_facet(master, f, q)));
                &near
            };
            let facet = slave_facet as u32;
            let report = check_coverage(found, surface, self.range)
                .map_err(|source| MortarError::Segmentation { facet, source })?;
            let whole = found.frame.kind().area();
            let scale = found.frame.image_area() / whole;
            let too_much = if report.cut { 0.0 } else { -report.uncovered };
            out.worst = out.worst.max(report.uncovered_opposite().max(report.double).max(too_much) / whole);
            out.area += found.frame.image_area();
            out.covered += found.segments.iter().map(|s| s.image_area()).sum::<f64>();
            if !report.is_tiling(TOLERANCE) {
                out.faults.push(CoverageFault {
                    slave_facet: facet,
                    uncovered_opposite: scale * report.uncovered_opposite(),
                    master_facets: report.missing.iter().map(|m| m.0).collect(),
                    double: scale * report.double.max(-report.uncovered),
                    open_edges: report.open_edges.len(),
                });
            }
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_testkit::meshes::Mesh;

    /// A box of 3 x 2 x 0.5; without its lower face only the sides face each other.
    #[test]
    fn a_box_is_as_thick_as_its_shortest_edge() {
        let corner = |k: usize| [3.0 * (k & 1) as f64, 2.0 * (k >> 1 & 1) as f64, 0.5 * (k >> 2) as f64];
        let q: Vec<f64> = (0..8).flat_map(corner).collect();
        let top = [4, 5, 7, 6];
        let sides = [[0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        let all: Vec<[u32; 4]> = [[0, 2, 3, 1], top].into_iter().chain(sides).collect();
        for mesh in Mesh::ALL {
            let of = |quads: &[[u32; 4]]| thickness(&ContactSurface::new("slave", &mesh.of(quads), &q).unwrap(), &q);
            assert!((of(&all) - 0.5).abs() < 1e-15);
            assert!((of(&all[1..]) - 2.0).abs() < 1e-15);
            assert_eq!(of(&[top]), f64::INFINITY);
        }
    }
}
