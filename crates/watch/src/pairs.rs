//! One body inside another: nodes, centres of faces and of the elements behind them, and edges of which only the middle is inside.

use crate::predicates::{Intersection, intersect};
use crate::surface::Surface;
use nalgebra::Vector3;
use stoss_geometry::Aabb;

/// Depths below this part of an edge are round-off of surfaces that touch.
pub(crate) const TOUCHING: f64 = 1.0e-9;

/// A point of one body inside another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inside {
    /// The node nearest to it on its own surface, as a place in `points` (a node or the centre of a face).
    pub point: u32,
    pub position: Vector3<f64>,
    pub depth: f64,
    /// Depth over the edge length of the facet that is nearest.
    pub relative: f64,
}

/// What was found of one body in another.
#[derive(Clone, Debug, Default)]
pub(crate) struct Overlap {
    pub deepest: Option<Inside>,
    pub nodes: usize,
    /// Edges that run through the other body between two nodes outside, or through an open surface.
    pub edges: usize,
}

impl Overlap {
    fn add(&mut self, inside: Inside) {
        if self.deepest.is_none_or(|worst| inside.relative > worst.relative) {
            self.deepest = Some(inside);
        }
    }
}

/// What of `body` is inside `other`; points for which `exempt` holds are left out, and edges with such an end.
pub(crate) fn overlap(
    body: &Surface,
    other: &Surface,
    exempt: impl Fn(u32) -> bool,
    inside: &mut Vec<bool>,
) -> Overlap {
    let mut found = Overlap::default();
    if !body.bounds.overlaps(&other.bounds) {
        return found;
    }
    inside.clear();
    inside.resize(body.points.len(), false);
    let measure = |point: u32, position: Vector3<f64>| {
        let (depth, triangle) = other.nearest(&position);
        let depth = other.height_over_face(&position, triangle).map_or(depth, |height| (-height).max(0.0));
        Inside { point, position, depth, relative: depth / other.depth_unit(triangle, body, point) }
    };
    let near = body.is_rigid.then(|| body.within(&other.bounds));
    let mut check = |k: usize| {
        let x = &body.points[k];
        if exempt(k as u32) || !other.contains(x) {
            return;
        }
        let here = measure(k as u32, *x);
        if here.relative > TOUCHING {
            inside[k] = true;
            found.nodes += usize::from(k < body.nodes.len());
            found.add(here);
        }
    };
    match &near {
        Some((points, _)) => points.iter().for_each(|&k| check(k as usize)),
        None => (0..body.points.len()).for_each(check),
    }
    // Of bodies in the same place all nodes are near the surface of the other, but the insides are not.
    for (core, facet) in body.cores() {
        let point = body.nodes.len() as u32 + facet;
        if !exempt(point) && other.contains(core) {
            found.add(measure(point, *core));
        }
    }
    let (mut crossings, mut through_open) = (Vec::new(), Vec::new());
    for &[a, b] in near.as_ref().map_or(&body.edges, |(_, edges)| edges) {
        if inside[a as usize] || inside[b as usize] || exempt(a) || exempt(b) {
            continue;
        }
        let (x, y) = (&body.points[a as usize], &body.points[b as usize]);
        let region = Aabb::from_points([x, y]);
        if !region.overlaps(&other.bounds) {
            continue;
        }
        crossings.clear();
        other.tree.query(&region, |t| {
            let triangle = other.triangle(t);
            if let Intersection::Through(_) = intersect(x, y, triangle) {
                let normal = (triangle[1] - triangle[0]).cross(&(triangle[2] - triangle[0]));
                let (from, to) = ((x - triangle[0]).dot(&normal), (y - triangle[0]).dot(&normal));
                crossings.push(from / (from - to));
            }
        });
        if !other.is_closed {
            let reaches = |end: u32, x: &Vector3<f64>| measure(end, *x).relative > TOUCHING;
            if !crossings.is_empty() && reaches(a, x) && reaches(b, y) {
                found.edges += 1;
                through_open.push([a, b]);
            }
            continue;
        }
        crossings.sort_unstable_by(f64::total_cmp);
        let mut through = false;
        for pair in crossings.windows(2) {
            let t = 0.5 * (pair[0] + pair[1]);
            let middle = body.on_edge([a, b], t);
            if other.contains(&middle) {
                let here = measure(if t < 0.5 { a } else { b }, middle);
                if here.relative > TOUCHING {
                    through = true;
                    found.add(here);
                }
            }
        }
        found.edges += usize::from(through);
    }
    if !other.is_closed && found.edges > 0 {
        found.deepest = penetration_of_open_surface(body, other, exempt, &through_open);
    }
    found
}

/// The point of a body with edges through an open surface that is farthest from it on the side where the body reaches less far. Points whose nearest point is
/// on the rim are beside the surface; of an edge that goes through it between such ends what lies before and behind is sought in parts.
fn penetration_of_open_surface(
    body: &Surface,
    other: &Surface,
    exempt: impl Fn(u32) -> bool,
    through: &[[u32; 2]],
) -> Option<Inside> {
    /// Parts of an edge.
    const PARTS: u32 = 16;
    let mut farthest: [Option<Inside>; 2] = [None, None];
    let mut add = |point: u32, position: Vector3<f64>| {
        let (depth, triangle) = other.nearest(&position);
        if depth <= 0.0 || other.is_beside(&position, triangle) {
            return;
        }
        let [a, b, c] = other.triangle(triangle);
        let height = (b - a).cross(&(c - a)).dot(&(position - a));
        let here = Inside { point, position, depth, relative: depth / other.depth_unit(triangle, body, point) };
        let side = &mut farthest[usize::from(height < 0.0)];
        if side.is_none_or(|worst| here.depth > worst.depth) {
            *side = Some(here);
        }
    };
    for (k, position) in body.points.iter().enumerate().filter(|&(k, _)| !exempt(k as u32)) {
        add(k as u32, *position);
    }
    for &[a, b] in through {
        let (x, y) = (&body.points[a as usize], &body.points[b as usize]);
        for part in 1..PARTS {
            let end = if 2 * part <= PARTS { a } else { b };
            add(end, x + (y - x) * (f64::from(part) / f64::from(PARTS)));
        }
    }
    let [Some(before), Some(behind)] = farthest else { return None };
    Some(if before.depth < behind.depth { before } else { behind })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_mesh::Mesh;
    use stoss_mesh::generate::Block;
    use stoss_reference_element::CellKind;

    /// A quarter of a tube with `n` elements around.
    fn tube(inner: f64, outer: f64, n: usize, kind: CellKind) -> (Surface, Vec<f64>) {
        let mut mesh: Mesh = Block::with_size([1.0; 3], [1, n, 1]).generate().unwrap();
        for x in &mut mesh.nodes {
            let (radius, angle) = (inner + (outer - inner) * (x[0] + 0.5), 0.5 * std::f64::consts::PI * (x[1] + 0.5));
            *x = [radius * angle.cos(), radius * angle.sin(), x[2]];
        }
        let mesh = mesh.with_cells(kind).unwrap();
        let q = mesh.nodes.concat();
        let mut surface = Surface::of_elements(&mesh.elements);
        surface.place(&q, true);
        (surface, q)
    }

    /// Tubes that fit exactly, with different numbers of elements around: linear ones overlap by the height of the arches, quadratic ones by what their faces differ from the circle.
    #[test]
    fn tubes_of_quadratic_cells_that_fit_do_not_overlap() {
        for (kind, least, most) in [
            (CellKind::Hex8, 1e-2, 1e-1),
            (CellKind::Hex20, 0.0, 1e-4),
            (CellKind::Hex27, 0.0, 1e-4),
            (CellKind::Tet10, 0.0, 1e-4),
        ] {
            let ((shaft, _), (hub, _)) = (tube(12.0, 18.0, 11, kind), tube(18.0, 26.0, 9, kind));
            for (body, other) in [(&shaft, &hub), (&hub, &shaft)] {
                let found = overlap(body, other, |_| false, &mut Vec::new());
                let depth = found.deepest.map_or(0.0, |deepest| deepest.depth);
                assert!((least..most).contains(&depth), "{kind}: {depth:e} at {:?}", found.deepest);
            }
        }
    }
}
