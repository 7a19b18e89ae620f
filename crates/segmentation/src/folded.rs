//! A master that covers a part of the slave more than once, folded or in several sheets: each point of the slave belongs to the nearer facet.

use crate::frame::weighted;
use crate::map::inverse;
use crate::overlap::{common_area, sides};
use crate::plane::{cross, sub};
use crate::{FacetSegmentation, HiddenFacet, MasterFacet, Provenance, Segment, SlaveFrame, Vertex};

/// Common area, as a part of the image of the slave, below which it is round-off.
const ROUND_OFF: f64 = 1e-13;

/// A corner of a polygon in the plane: a vertex of a segment, or a new point.
#[derive(Clone, Copy)]
struct Corner {
    image: [f64; 2],
    vertex: Option<Vertex>,
}

/// Parts of a convex polygon on both sides of the line through `a` and `b`: left, right.
fn cut(polygon: &[Corner], a: [f64; 2], b: [f64; 2]) -> [Vec<Corner>; 2] {
    let side = |c: &Corner| cross(sub(b, a), sub(c.image, a));
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for (k, corner) in polygon.iter().enumerate() {
        let next = &polygon[(k + 1) % polygon.len()];
        let (s, t) = (side(corner), side(next));
        if s >= 0.0 {
            left.push(*corner);
        }
        if s <= 0.0 {
            right.push(*corner);
        }
        if s > 0.0 && t < 0.0 || s < 0.0 && t > 0.0 {
            let f = s / (s - t);
            let image = std::array::from_fn(|i| corner.image[i] + f * (next.image[i] - corner.image[i]));
            let new = Corner { image, vertex: None };
            left.push(new);
            right.push(new);
        }
    }
    [left, right]
}

fn area(polygon: &[Corner]) -> f64 {
    let twice = |k: usize| cross(sub(polygon[k].image, polygon[0].image), sub(polygon[k + 1].image, polygon[0].image));
    (1..polygon.len().saturating_sub(1)).map(|k| 0.5 * twice(k)).sum()
}

/// The parts of `segment` outside of `winner`, as triangles.
fn difference(segment: &Segment, winner: &Segment, frame: &SlaveFrame, master: &MasterFacet, out: &mut Vec<Segment>) {
    let tiny = 0.01 * ROUND_OFF * frame.image_area();
    let images = master.corners.map(|x| frame.image(&x));
    let resolve = |corner: &Corner| {
        corner.vertex.unwrap_or_else(|| {
            let slave = frame.kind().clamp(inverse(segment.slave_map, &frame.images, corner.image));
            let xi = master.corners.kind().clamp(inverse(segment.master_map, &images, corner.image));
            let x1 = weighted(&segment.slave_map.weights(slave), frame.corners());
            let x2 = weighted(&segment.master_map.weights(xi), &master.corners);
            let gap = (x2 - x1).dot(&frame.normal());
            Vertex { provenance: Provenance::Cut, slave, master: xi, gap, image: corner.image }
        })
    };
    let mut rest: Vec<Corner> =
        segment.vertices().iter().map(|v| Corner { image: v.image, vertex: Some(*v) }).collect();
    for [from, to] in sides(winner) {
        let [left, right] = cut(&rest, from, to);
        if area(&right) > tiny {
            for k in 1..right.len() - 1 {
                let triangle = [right[0], right[k], right[k + 1]];
                if area(&triangle) > 0.01 * tiny {
                    out.push(segment.part(&triangle.map(|c| resolve(&c))));
                }
            }
        }
        rest = left;
        if area(&rest) <= tiny {
            return;
        }
    }
}

fn distance(segment: &Segment) -> f64 {
    let v = segment.vertices();
    (v.iter().map(|v| v.gap).sum::<f64>() / v.len() as f64).abs()
}

/// Removes from each segment the part that a nearer one covers.
pub(crate) fn remove_hidden_parts(found: &mut FacetSegmentation, candidates: &[MasterFacet]) {
    let tolerance = ROUND_OFF * found.frame.image_area();
    let boxes: Vec<[[f64; 2]; 2]> = found.segments.iter().map(Segment::bounds).collect();
    let meet = |i: usize, j: usize| {
        let (a, b): (&[[f64; 2]; 2], &[[f64; 2]; 2]) = (&boxes[i], &boxes[j]);
        (0..2).all(|k| a[0][k] < b[1][k] && b[0][k] < a[1][k])
            && common_area(&found.segments[i], &found.segments[j]) > tolerance
    };
    let count = found.segments.len();
    if !(0..count).any(|i| (0..i).any(|j| meet(i, j))) {
        return;
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| distance(&found.segments[a]).total_cmp(&distance(&found.segments[b])).then(a.cmp(&b)));
    let mut kept: Vec<(usize, Segment)> = Vec::new();
    for (nearer, &k) in order.iter().enumerate() {
        let segment = found.segments[k].clone();
        let Some(master) = candidates.iter().find(|c| c.id == segment.master_facet) else { continue };
        let whole = segment.parametric_area();
        let mut parts = vec![segment];
        // All of the nearer ones, not what was left of them: the union is the same, and the parts of parts would be ever more.
        for winner in order[..nearer].iter().filter(|&&j| meet(k, j)).map(|&j| &found.segments[j]) {
            let mut left = Vec::new();
            for part in parts {
                if common_area(&part, winner) > 0.1 * tolerance {
                    difference(&part, winner, &found.frame, master, &mut left);
                } else {
                    left.push(part);
                }
            }
            parts = left;
        }
        if parts.is_empty() {
            found.hidden.push(HiddenFacet { id: master.id, parametric_area: whole });
        }
        kept.extend(parts.into_iter().map(|part| (k, part)));
    }
    kept.sort_by_key(|(k, _)| *k);
    found.segments = kept.into_iter().map(|(_, segment)| segment).collect();
    // A facet that keeps a part is not hidden.
    let segments = &found.segments;
    found.hidden.retain(|hidden| segments.iter().all(|s| s.master_facet != hidden.id));
}
