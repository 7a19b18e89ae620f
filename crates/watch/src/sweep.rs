//! What passed through a body between two states: nodes that move along straight lines, against triangles whose corners do.

use crate::predicates::nearest_point;
use crate::surface::Surface;
use nalgebra::Vector3;
use stoss_geometry::{Aabb, BoundingVolumeTree};

/// Entry and exit count as a passage through a plate, however thin, where the cosine between the normals of the two faces is below this.
const OPPOSITE: f64 = -0.3;

/// A passage at least this deep, in edge lengths, counts whatever the normals of its faces.
const DEEP: f64 = 0.3;

/// A passage nearer to the surface than this part of its length, or of an edge, only grazes the body. So does one, not so deep, through two facets that meet, however sharp the
/// edge between them, if it is nearer to where they meet than this part of an edge: the node went around, and the straight line from check to check cuts the edge off.
const GRAZING: f64 = 0.05;

/// Subdivisions of a step in which the sign of the distance to a moving plane is checked; roots are bisected.
const SAMPLES: usize = 8;

/// Boxes of the triangles of a surface over a step.
#[derive(Debug)]
pub(crate) struct SweptBoxes {
    tree: BoundingVolumeTree,
    /// Triangle of each box.
    triangles: Vec<u32>,
    pub bounds: Aabb,
}

/// A node that entered a body and left it within a step, as a place in `nodes`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    pub node: u32,
    pub position: Vector3<f64>,
}

impl SweptBoxes {
    /// The sweep of a surface whose points were at `before`; of a rigid one as far as it reaches into one of the `regions`, in which the others move.
    pub fn new(surface: &Surface, before: &[Vector3<f64>], regions: &[Aabb]) -> Self {
        let swept = |t: usize| {
            let corners = surface.corners(t).map(|k| k as usize);
            Aabb::from_points(corners.map(|k| &surface.points[k]))
                .union(&Aabb::from_points(corners.map(|k| &before[k])))
        };
        // Beside the ways of the points there is room for `is_near`, which asks for no more than a part of an edge of theirs.
        let regions = regions.iter().map(|region| region.inflated(GRAZING * (region.max - region.min).norm()));
        let regions: Vec<Aabb> = regions.collect();
        let all = (0..surface.triangle_count()).map(|t| (t as u32, swept(t)));
        let near = all.filter(|(_, swept)| !surface.is_rigid || regions.iter().any(|region| region.overlaps(swept)));
        let (triangles, boxes): (Vec<u32>, Vec<Aabb>) = near.unzip();
        let tree = BoundingVolumeTree::build(&boxes);
        Self { bounds: tree.bounds(), tree, triangles }
    }

    /// Visits the triangles whose boxes overlap a region.
    fn query(&self, region: &Aabb, mut visit: impl FnMut(usize)) {
        self.tree.query(region, |k| visit(self.triangles[k] as usize));
    }

    /// Whether the surface is nearer than `distance` to a point at a time in the step.
    fn is_near(
        &self,
        surface: &Surface,
        before: &[Vector3<f64>],
        time: f64,
        point: &Vector3<f64>,
        distance: f64,
    ) -> bool {
        let reach = Vector3::repeat(distance);
        let region = Aabb::from_points([&(point - reach), &(point + reach)]);
        let mut is_near = false;
        self.query(&region, |t| {
            let at = |k: u32| before[k as usize] + (surface.points[k as usize] - before[k as usize]) * time;
            is_near |= {
                let [a, b, c] = surface.corners(t).map(at);
                (point - nearest_point(point, [&a, &b, &c])).norm() < distance
            };
        });
        is_near
    }
}

/// Nodes of `body`, at `before` until now, that passed through `other`, or from one side of an open surface to the other; not those for which `exempt` holds.
pub(crate) fn passages(
    (body, before): (&Surface, &[Vector3<f64>]),
    (other, other_before, sweep): (&Surface, &[Vector3<f64>], &SweptBoxes),
    exempt: impl Fn(u32) -> bool,
) -> Vec<Passage> {
    let mut found = Vec::new();
    let mut crossings: Vec<Crossing> = Vec::new();
    for k in 0..body.nodes.len() {
        let (x0, x1) = (&before[k], &body.points[k]);
        let region = Aabb::from_points([x0, x1]);
        if exempt(k as u32) || !region.overlaps(&sweep.bounds) {
            continue;
        }
        crossings.clear();
        sweep.query(&region, |t| {
            let corners = other.corners(t).map(|k| k as usize);
            let moving = corners.map(|k| (&other_before[k], &other.points[k]));
            crossings.extend(crossing(x0, x1, moving, (t, other.depth_unit(t, body, k as u32))));
        });
        if crossings.len() < 2 && other.is_closed {
            continue;
        }
        crossings.sort_unstable_by(|a, b| a.time.total_cmp(&b.time));
        if let Some(passage) = crossings.first().zip(crossings.last()).filter(|_| !other.is_closed) {
            if is_through(passage) {
                found.push(Passage { node: k as u32, position: x0 + (x1 - x0) * passage.0.time });
            }
            continue;
        }
        let entry = crossings.iter().find(|crossing| crossing.inwards);
        let exit = crossings.iter().rfind(|crossing| !crossing.inwards);
        let (Some(entry), Some(exit)) = (entry, exit) else { continue };
        if exit.time <= entry.time || other.contains(x1) {
            continue;
        }
        // Way through the body, from face to face.
        let way = (exit.relative * (exit.time - entry.time)).dot(&exit.normal).abs();
        let middle = 0.5 * (entry.time + exit.time);
        let at_middle = x0 + (x1 - x0) * middle;
        let free = GRAZING * way.min(exit.edge);
        let cuts_edge_off = || {
            let common = other.nearest_common([entry.triangle, exit.triangle], &at_middle, |k| {
                other_before[k] + (other.points[k] - other_before[k]) * middle
            });
            common.is_some_and(|distance| distance < GRAZING * exit.edge)
        };
        let through = way > DEEP * exit.edge || entry.normal.dot(&exit.normal) < OPPOSITE && !cuts_edge_off();
        if through && !sweep.is_near(other, other_before, middle, &at_middle, free) {
            found.push(Passage { node: k as u32, position: x0 + (x1 - x0) * entry.time });
        }
    }
    found
}

/// Whether a point that met an open surface first and last so has passed it: to the other side, and deep. Who comes from behind has to have been deep there,
/// too: a node in contact may be a little behind the surface before it leaves it.
fn is_through((first, last): (&Crossing, &Crossing)) -> bool {
    let way = |crossing: &Crossing, time: f64| (crossing.relative * time).dot(&crossing.normal).abs();
    let after = way(last, 1.0 - last.time) > DEEP * last.edge;
    first.inwards == last.inwards && after && (first.inwards || way(first, first.time) > DEEP * first.edge)
}

/// Where a moving point meets a moving triangle.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    triangle: usize,
    /// Part of the step before the crossing, 0 to 1.
    time: f64,
    inwards: bool,
    /// Normal of the triangle at that time, a unit vector.
    normal: Vector3<f64>,
    /// Edge length of the facet.
    edge: f64,
    /// Motion of the point in the step, as seen from the triangle.
    relative: Vector3<f64>,
}

fn crossing(
    x0: &Vector3<f64>,
    x1: &Vector3<f64>,
    moving: [(&Vector3<f64>, &Vector3<f64>); 3],
    (triangle, edge): (usize, f64),
) -> Option<Crossing> {
    let at = |t: f64| {
        let p = x0 + (x1 - x0) * t;
        let [a, b, c] = moving.map(|(before, now)| before + (now - before) * t);
        (p, a, b, c)
    };
    let height = |t: f64| {
        let (p, a, b, c) = at(t);
        (b - a).cross(&(c - a)).dot(&(p - a))
    };
    let mut previous = height(0.0);
    for k in 0..SAMPLES {
        let (mut low, mut high) = (k as f64 / SAMPLES as f64, (k + 1) as f64 / SAMPLES as f64);
        let now = height(high);
        let start = std::mem::replace(&mut previous, now);
        if (start > 0.0) == (now > 0.0) {
            continue;
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if (height(middle) > 0.0) == (start > 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (p, a, b, c) = at(high);
        let normal = (b - a).cross(&(c - a));
        let square = normal.norm_squared();
        let beside = |u: &Vector3<f64>, v: &Vector3<f64>| (v - u).cross(&(p - u)).dot(&normal) >= -1e-9 * square;
        if square > 0.0 && beside(&a, &b) && beside(&b, &c) && beside(&c, &a) {
            let carried = moving.iter().map(|(before, now)| *now - *before).sum::<Vector3<f64>>() / 3.0;
            let relative = x1 - x0 - carried;
            let (inwards, normal) = (start > 0.0, normal / square.sqrt());
            return Some(Crossing { triangle, time: high, inwards, normal, edge, relative });
        }
    }
    None
}
