//! One pair of facets: polygons with coordinates and origin of every vertex.

use crate::clip::{ClipVertex, clip, crossing};
use crate::frame::weighted;
use crate::map::{FacetMap, Images, inverse};
use crate::pieces::{Orientation, split};
use crate::plane::{cross, sub};
use crate::{SegmentationError, SlaveFrame};
use nalgebra::Vector3;
use stoss_reference_element::{FacetKind, Nodal};

/// Most vertices that a segment can have: two convex quadrilaterals meet in an octagon.
pub const MAX_VERTICES: usize = 8;

/// Origin of a vertex.
///
/// Edges of a facet and the diagonals along which one had to be split are numbered as in [`FacetKind::sides`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Provenance {
    /// A corner of the slave facet, projected on the master.
    Slave(u8),
    /// A corner of the master facet, projected on the slave.
    Master(u8),
    /// Intersection of the images of two edges.
    Intersection {
        /// Edge of the slave.
        slave_edge: u8,
        /// Edge of the master.
        master_edge: u8,
    },
    /// Boundary of a nearer facet of a folded master; its coordinates on the slave count as constant in derivatives.
    Cut,
}

/// A vertex of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Origin.
    pub provenance: Provenance,
    /// Convective coordinates on the slave.
    pub slave: [f64; 2],
    /// Convective coordinates on the master.
    pub master: [f64; 2],
    /// `(x2 - x1) . n0`, a length: positive if the facets are apart.
    pub gap: f64,
    /// Image in the segmentation plane, two lengths.
    pub image: [f64; 2],
}

/// Parametric area below which a polygon is round-off (the facet has [`FacetKind::area`]).
pub(crate) const SMALLEST_AREA: f64 = 5e-15;

const NO_VERTEX: Vertex =
    Vertex { provenance: Provenance::Slave(0), slave: [0.0; 2], master: [0.0; 2], gap: 0.0, image: [0.0; 2] };

/// A convex polygon in which a slave and a master facet lie opposite each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Number of the master facet, given by the caller.
    pub master_facet: u32,
    /// Map from the convective coordinates of the slave facet to its points.
    pub slave_map: FacetMap,
    /// Map from the convective coordinates of the master facet to its points.
    pub master_map: FacetMap,
    count: usize,
    vertices: [Vertex; MAX_VERTICES],
}

/// Projection of a slave point on the master, along the normal of the segmentation plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Convective coordinates on the master; may leave the facet by a little inside a segment of distorted facets.
    pub master: [f64; 2],
    /// `(x2 - x1) . n0`, a length.
    pub gap: f64,
}

impl Segment {
    /// The vertices, counter-clockwise seen against the slave's normal; 3 to 8.
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices[..self.count]
    }

    /// Fan of triangles from the first vertex: indices into [`Segment::vertices`].
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        (1..self.count - 1).map(|k| [0, k, k + 1])
    }

    /// A triangle of it.
    pub(crate) fn part(&self, triangle: &[Vertex; 3]) -> Self {
        let mut part = Self { count: 3, ..self.clone() };
        part.vertices[..3].copy_from_slice(triangle);
        part
    }

    /// Smallest and largest coordinates of the image.
    pub(crate) fn bounds(&self) -> [[f64; 2]; 2] {
        let mut range = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for v in self.vertices() {
            for k in 0..2 {
                range[0][k] = range[0][k].min(v.image[k]);
                range[1][k] = range[1][k].max(v.image[k]);
            }
        }
        range
    }

    /// Twice the signed area of a triangle in the slave's coordinates: `det d xi / d eta`.
    ///
    /// Negative only for slivers at edges that a distorted slave facet bends; then another segment has that much too
    /// much.
    pub fn triangle_determinant(&self, triangle: [usize; 3]) -> f64 {
        let [a, b, c] = triangle.map(|v| self.vertices[v].slave);
        cross(sub(b, a), sub(c, a))
    }

    /// Area in the slave's coordinates; the whole facet has [`FacetKind::area`].
    pub fn parametric_area(&self) -> f64 {
        0.5 * self.triangles().map(|t| self.triangle_determinant(t)).sum::<f64>()
    }

    /// Area of the image in the segmentation plane, an area.
    pub fn image_area(&self) -> f64 {
        let v = self.vertices();
        let twice = |t: [usize; 3]| cross(sub(v[t[1]].image, v[t[0]].image), sub(v[t[2]].image, v[t[0]].image));
        0.5 * self.triangles().map(twice).sum::<f64>()
    }

    /// Centroid in the slave's coordinates; the mean of the vertices if the area vanishes to round-off.
    pub fn centroid(&self) -> [f64; 2] {
        let v = self.vertices();
        let (mut area, mut moment) = (0.0, [0.0; 2]);
        for t in self.triangles() {
            let det = self.triangle_determinant(t);
            area += det;
            for (i, m) in moment.iter_mut().enumerate() {
                *m += det * t.iter().map(|&k| v[k].slave[i]).sum::<f64>() / 3.0;
            }
        }
        if area > 2.0 * SMALLEST_AREA {
            moment.map(|m| m / area)
        } else {
            std::array::from_fn(|i| v.iter().map(|x| x.slave[i]).sum::<f64>() / v.len() as f64)
        }
    }

    /// Triangles around the centroid, whose shape follows the polygon continuously when vertices appear and vanish: pairs of indices into
    /// [`Segment::vertices`], the third corner is [`Segment::centroid`].
    pub fn fan(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let count = self.count;
        (0..count).map(move |k| [k, (k + 1) % count])
    }

    /// Projects the slave's point at `slave` on the master facet along `n0`.
    pub fn project(&self, frame: &SlaveFrame, master: &Nodal<Vector3<f64>>, slave: [f64; 2]) -> Foot {
        self.project_on(frame, master, &master.map(|x| frame.image(&x)), slave)
    }

    /// [`Segment::project`] with the images of the master's corners, for many points of one segment.
    pub fn project_on(
        &self,
        frame: &SlaveFrame,
        master: &Nodal<Vector3<f64>>,
        images: &Nodal<[f64; 2]>,
        slave: [f64; 2],
    ) -> Foot {
        let x1 = weighted(&self.slave_map.weights(slave), frame.corners());
        let xi = inverse(self.master_map, images, frame.image(&x1));
        let x2 = weighted(&self.master_map.weights(xi), master);
        Foot { master: xi, gap: (x2 - x1).dot(&frame.normal()) }
    }
}

fn between(kind: FacetKind, corners: [u8; 2], fraction: f64) -> [f64; 2] {
    let [a, b] = corners.map(|k| kind.vertices()[k as usize]);
    std::array::from_fn(|i| a[i] + fraction * (b[i] - a[i]))
}

/// Segments the slave facet of `frame` against one master facet (corners counter-clockwise seen from outside of the
/// master) and appends the segments to `out`: none if the images do not overlap or the master is seen from behind,
/// one for images that are convex, at most four. Segments whose image has no area to round-off are left out: nothing
/// larger than `1e-15` of the slave's image.
///
/// # Errors
/// [`SegmentationError::NotFinite`].
pub fn segment_pair(
    frame: &SlaveFrame,
    master_facet: u32,
    master: &Nodal<Vector3<f64>>,
    out: &mut Vec<Segment>,
) -> Result<(), SegmentationError> {
    segment_pair_within(frame, master_facet, master, &master.map(|_| 0), out)
}

/// Overlap of two facets as of [`segment_pair`], for surfaces that end at planes of symmetry and go on behind them: `planes` are those that the master's
/// corners lie in, a bit each, as in [`SlaveFrame::with_planes`]. A slave's side in such a plane bounds the segment in place of the master's.
///
/// # Errors
/// The errors of [`segment_pair`].
pub fn segment_pair_within(
    frame: &SlaveFrame,
    master_facet: u32,
    master: &Nodal<Vector3<f64>>,
    planes: &Nodal<u8>,
    out: &mut Vec<Segment>,
) -> Result<(), SegmentationError> {
    if !master.iter().all(|x| x.iter().all(|c| c.is_finite())) {
        return Err(SegmentationError::NotFinite { side: "master" });
    }
    let images = master.map(|x| frame.image(&x));
    // Apart to one side: nothing to do, and the usual case.
    for i in 0..2 {
        let range =
            |p: &Images| p.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x[i]), b.max(x[i])));
        let ((s0, s1), (m0, m1)) = (range(&frame.images), range(&images));
        if s1 < m0 || m1 < s0 {
            return Ok(());
        }
    }
    // The master looks the other way: its corners run clockwise in the plane.
    let (mut master_pieces, _) = split(&images, Orientation::Backward);
    master_pieces.iter_mut().flatten().for_each(|piece| piece.set_planes(*planes.padded()));
    let (slave_kind, master_kind) = (frame.kind(), master.kind());
    for s in frame.pieces.iter().flatten() {
        for m in master_pieces.iter().flatten() {
            let mut clipped = [ClipVertex::Slave(0); MAX_VERTICES];
            let count = clip(s, m, &mut clipped);
            if count < 3 {
                continue;
            }
            let mut segment = Segment {
                master_facet,
                slave_map: s.map,
                master_map: m.map,
                count,
                vertices: [NO_VERTEX; MAX_VERTICES],
            };
            for (vertex, source) in segment.vertices.iter_mut().zip(&clipped[..count]) {
                let (provenance, slave, master_xi) = match *source {
                    ClipVertex::Slave(i) => {
                        let k = s.corners[i];
                        // A point that is known to lie in the closed facet: round-off may not take it out.
                        let xi = inverse(m.map, &images, s.points[i]);
                        let xi = if s.planes[i] == 0 { master_kind.clamp(xi) } else { xi };
                        (Provenance::Slave(k), slave_kind.vertices()[k as usize], xi)
                    }
                    ClipVertex::Master(j) => {
                        let k = m.corners[j];
                        let xi = slave_kind.clamp(inverse(s.map, &frame.images, m.points[j]));
                        (Provenance::Master(k), xi, master_kind.vertices()[k as usize])
                    }
                    ClipVertex::Crossing { slave: i, master: j } => {
                        let c = crossing(s, i, m, j);
                        (
                            Provenance::Intersection { slave_edge: s.edge(i), master_edge: m.edge(j) },
                            between(slave_kind, c.slave_corners, c.slave_fraction),
                            between(master_kind, c.master_corners, c.master_fraction),
                        )
                    }
                };
                let x1 = weighted(&s.map.weights(slave), frame.corners());
                let x2 = weighted(&m.map.weights(master_xi), master);
                *vertex = Vertex {
                    provenance,
                    slave,
                    master: master_xi,
                    gap: (x2 - x1).dot(&frame.normal()),
                    image: frame.image(&x1),
                };
            }
            if segment.image_area() > 1e-15 * frame.image_area() {
                out.push(segment);
            }
        }
    }
    Ok(())
}
