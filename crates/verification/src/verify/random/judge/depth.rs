//! How deep bodies are inside each other, by brute force: every node, and points on every edge, of each body against every element of each other body.

use super::model::{Frame, Kind, Model, Part};
use super::vector::{add, cross, dot, minus, norm, scaled};

/// Points of an edge between its ends, as parts of its length.
const ALONG: [f64; 3] = [0.25, 0.5, 0.75];

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    low: [f64; 3],
    high: [f64; 3],
}

/// The deepest point of one kind.
#[derive(Clone, Debug, Default)]
pub struct Deepest {
    /// Distance to the surface that it passed.
    pub depth: f64,
    /// Depth over the mean edge of the facet there.
    pub relative: f64,
    /// What is in what, and when.
    pub place: String,
}

impl Extent {
    /// Around points.
    pub fn of(points: impl Iterator<Item = [f64; 3]>) -> Self {
        let start = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        points.fold(start, |all, p| Self {
            low: std::array::from_fn(|i| all.low[i].min(p[i])),
            high: std::array::from_fn(|i| all.high[i].max(p[i])),
        })
    }

    fn has(&self, p: [f64; 3]) -> bool {
        (0..3).all(|i| self.low[i] <= p[i] && p[i] <= self.high[i])
    }

    /// Largest distance along an axis by which two boxes are apart; negative if they overlap.
    pub fn apart(&self, other: &Self) -> f64 {
        (0..3).map(|i| (self.low[i] - other.high[i]).max(other.low[i] - self.high[i])).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The deepest node and the deepest point of an edge of a state, of all pairs that `counts` names.
pub fn deepest(model: &Model, frame: &Frame, counts: impl Fn(&Part, &Part) -> bool) -> [Deepest; 2] {
    let x = &frame.x;
    let mut worst = [Deepest::default(), Deepest::default()];
    let around = |part: &Part| Extent::of(part.surface.iter().map(|&n| x[n]));
    let boxes: Vec<Extent> = model.parts.iter().map(around).collect();
    for (b, into) in model.parts.iter().enumerate() {
        let elements: Vec<(Extent, Vec<[f64; 3]>)> = into
            .elements
            .iter()
            .map(|(_, nodes)| (Extent::of(nodes.iter().map(|&n| x[n])), nodes.iter().map(|&n| x[n]).collect()))
            .collect();
        let is_inside = |p: [f64; 3]| match into.kind {
            Kind::Solid => elements
                .iter()
                .zip(&into.elements)
                .any(|((extent, places), (cell, _))| extent.has(p) && model.cells[*cell].contains(places, p)),
            Kind::Rigid => into.facets.iter().all(|facet| behind(facet, x, p) > 0.0),
            Kind::Plane => into.facets.iter().any(|facet| behind(facet, x, p) > 0.0 && is_opposite(facet, x, p)),
        };
        for (a, part) in model.parts.iter().enumerate() {
            if a == b || !counts(part, into) || (into.kind != Kind::Plane && boxes[a].apart(&boxes[b]) > 0.0) {
                continue;
            }
            let mut look = |kind: usize, p: [f64; 3], own: f64, what: &dyn Fn() -> String| {
                if into.kind != Kind::Plane && !boxes[b].has(p) || !is_inside(p) {
                    return;
                }
                let near = into.facets.iter().map(|facet| (distance(facet, x, p), facet));
                let Some((depth, facet)) = near.min_by(|one, two| one.0.total_cmp(&two.0)) else { return };
                let edge = match into.kind {
                    Kind::Solid => Model::edge(facet, x),
                    _ => Model::edge(facet, x).min(own),
                };
                if depth / edge > worst[kind].relative {
                    worst[kind] = Deepest { depth, relative: depth / edge, place: what() };
                }
            };
            for facet in &part.facets {
                let own = Model::edge(facet, x);
                for (k, &n) in facet.iter().enumerate() {
                    look(0, x[n], own, &|| format!("step {}: node of {} in {}", frame.step, part.name, into.name));
                    let next = x[facet[(k + 1) % facet.len()]];
                    for s in ALONG {
                        let p = add(scaled(1.0 - s, x[n]), scaled(s, next));
                        look(1, p, own, &|| format!("step {}: edge of {} in {}", frame.step, part.name, into.name));
                    }
                }
            }
        }
    }
    worst
}

/// Distance of a point behind the plane of a facet.
fn behind(facet: &[usize], x: &[[f64; 3]], p: [f64; 3]) -> f64 {
    let last = facet[facet.len() - 1];
    let normal = cross(minus(x[facet[1]], x[facet[0]]), minus(x[last], x[facet[0]]));
    -dot(normal, minus(p, x[facet[0]])) / norm(normal)
}

/// Whether a point is above or below a flat, convex facet, and not beside it.
fn is_opposite(facet: &[usize], x: &[[f64; 3]], p: [f64; 3]) -> bool {
    let n = facet.len();
    let normal = cross(minus(x[facet[1]], x[facet[0]]), minus(x[facet[n - 1]], x[facet[0]]));
    (0..n).all(|k| {
        let (a, b) = (x[facet[k]], x[facet[(k + 1) % n]]);
        dot(cross(normal, minus(b, a)), minus(p, a)) > 0.0
    })
}

/// Distance of a point to a facet: to its triangles about its centre if it has four corners.
pub fn distance(facet: &[usize], x: &[[f64; 3]], p: [f64; 3]) -> f64 {
    let corners: Vec<[f64; 3]> = facet.iter().map(|&n| x[n]).collect();
    match corners[..] {
        [a, b, c] => norm(minus(p, nearest([a, b, c], p))),
        _ => {
            let n = corners.len();
            let centre = scaled(1.0 / n as f64, corners.iter().fold([0.0; 3], |sum, c| add(sum, *c)));
            let of = |k: usize| norm(minus(p, nearest([corners[k], corners[(k + 1) % n], centre], p)));
            (0..n).map(of).fold(f64::INFINITY, f64::min)
        }
    }
}

/// The point of a triangle that is nearest to `p`: the foot of the perpendicular if it is inside, else the nearest point of an edge.
fn nearest(corners: [[f64; 3]; 3], p: [f64; 3]) -> [f64; 3] {
    let normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
    let size = dot(normal, normal);
    if size > 0.0 {
        let foot = minus(p, scaled(dot(minus(p, corners[0]), normal) / size, normal));
        let is_inside = (0..3).all(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            dot(cross(minus(b, a), minus(foot, a)), normal) >= 0.0
        });
        if is_inside {
            return foot;
        }
    }
    let on_edge = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let along = minus(b, a);
        let length = dot(along, along);
        let s = if length > 0.0 { (dot(minus(p, a), along) / length).clamp(0.0, 1.0) } else { 0.0 };
        add(a, scaled(s, along))
    };
    let all = (0..3).map(on_edge);
    all.min_by(|a, b| norm(minus(p, *a)).total_cmp(&norm(minus(p, *b)))).unwrap_or(p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::random::judge::cell::Cell;
    use stoss_reference_element::CellKind;

    #[test]
    fn distances_to_a_square_are_those_of_face_edge_and_corner() {
        let x = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let facet = [0, 1, 2, 3];
        for (p, far) in [([0.3, 0.4, -0.2], 0.2), ([0.5, 2.0, 0.0], 1.0), ([4.0, 5.0, 0.0], 5.0)] {
            assert!((distance(&facet, &x, p) - far).abs() < 1e-14);
        }
        assert!((behind(&facet, &x, [0.3, 0.4, -0.2]) - 0.2).abs() < 1e-14);
        assert!(is_opposite(&facet, &x, [0.3, 0.4, -0.2]) && !is_opposite(&facet, &x, [1.1, 0.4, -0.2]));
    }

    /// Two unit cubes, one shifted so that a corner of each is inside the other by 0.1, 0.2 and 0.3.
    #[test]
    fn a_corner_is_as_deep_as_the_nearest_face() {
        let cube = CellKind::Hex8.table();
        let unit: Vec<[f64; 3]> = cube.nodes.iter().map(|n| n.map(|x| 0.5 * (x + 1.0))).collect();
        let shifted = unit.iter().map(|p| add(*p, [0.9, 0.8, 0.7]));
        let x: Vec<[f64; 3]> = unit.iter().copied().chain(shifted).collect();
        let part = |name: &str, first: usize| Part {
            name: name.into(),
            kind: Kind::Solid,
            density: None,
            driven: false,
            elements: vec![(0, (first..first + 8).collect())],
            facets: cube.faces.iter().map(|f| f.nodes.iter().map(|&n| first + n as usize).collect()).collect(),
            surface: (first..first + 8).collect(),
            is_straight: true,
        };
        let model = Model {
            cells: vec![Cell::new(CellKind::Hex8)],
            parts: vec![part("a", 0), part("b", 8)],
            reference: x.clone(),
            frames: Vec::new(),
        };
        let frame = Frame { step: 3, x, v: Vec::new() };
        let [node, edge] = deepest(&model, &frame, |_, _| true);
        assert!((node.depth - 0.1).abs() < 1e-12 && (node.relative - 0.1).abs() < 1e-12);
        assert!(node.place.starts_with("step 3: node of ") && edge.depth <= 0.1);
        assert_eq!(deepest(&model, &frame, |_, _| false)[0].depth, 0.0);
    }
}
