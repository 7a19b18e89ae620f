//! Intersection of two convex polygons in the plane with exact decisions.
//!
//! The master polygon is taken as shifted by the infinitesimal vector `(e, e^2)`: no corner is on a line, no edges
//! overlap. Signs that exact arithmetic finds to be zero are those of the shifted polygon. The vertices' coordinates
//! are those of the polygons as they are.
//!
//! Where both polygons have a side in the same plane of symmetry, both surfaces go on behind it: there the slave's side is the boundary, and the master's sides across the plane are
//! taken as far as that, a little less or more than to their corners.

use crate::pieces::ConvexPolygon;
use crate::plane::{cross, orient, sub};
use stoss_reference_element::MAX_NODES;

/// Vertex of the intersection: indices are sides and corners of the pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ClipVertex {
    Slave(usize),
    Master(usize),
    Crossing { slave: usize, master: usize },
}

struct Signs {
    /// Whether master corner `j` is on the inner side of slave side `i`.
    master_in: [[bool; MAX_NODES]; MAX_NODES],
    /// Whether slave corner `i` is on the inner side of master side `j`.
    slave_in: [[bool; MAX_NODES]; MAX_NODES],
}

/// Whether `p + shift` is left of the line `a` to `b`.
fn is_left(a: [f64; 2], b: [f64; 2], p: [f64; 2], shift_sign: f64) -> bool {
    let o = orient(a, b, p);
    if o != 0.0 {
        return o > 0.0;
    }
    let d = sub(b, a);
    // (b - a) x (e, e^2) = d_x e^2 - d_y e.
    let s = if d[1] != 0.0 { -d[1] } else { d[0] };
    s * shift_sign > 0.0
}

impl Signs {
    fn new(s: &ConvexPolygon, m: &ConvexPolygon) -> Self {
        let none = [[false; MAX_NODES]; MAX_NODES];
        let ends = reached(s, m);
        let mut signs = Self { master_in: none, slave_in: none };
        for i in 0..s.count {
            for j in 0..m.count {
                let (s_next, m_next) = (s.points[(i + 1) % s.count], m.points[(j + 1) % m.count]);
                let beyond = s.planes_of_side(i) & m.planes[j] != 0;
                let behind = m.planes_of_side(j) & s.planes[i] != 0;
                signs.master_in[i][j] = !beyond && is_left(s.points[i], s_next, ends[j], 1.0);
                signs.slave_in[j][i] = behind || is_left(m.points[j], m_next, s.points[i], -1.0);
            }
        }
        signs
    }

    fn crosses(&self, s: &ConvexPolygon, m: &ConvexPolygon, i: usize, j: usize) -> bool {
        self.master_in[i][j] != self.master_in[i][(j + 1) % m.count]
            && self.slave_in[j][i] != self.slave_in[j][(i + 1) % s.count]
    }
}

/// Corners of the master as far as they count: one in a plane in which the slave has a side is where its side across the plane, prolonged, meets the slave's. Neighbours over that side find the same
/// point to the last bit.
fn reached(s: &ConvexPolygon, m: &ConvexPolygon) -> [[f64; 2]; MAX_NODES] {
    let mut ends = m.points;
    for j in 0..m.count {
        let Some(i) = (0..s.count).find(|&i| s.planes_of_side(i) & m.planes[j] != 0) else { continue };
        let plane = s.planes_of_side(i) & m.planes[j];
        let (before, after) = ((j + m.count - 1) % m.count, (j + 1) % m.count);
        let inner = if m.planes[before] & plane == 0 { before } else { after };
        if m.planes[inner] & plane != 0 {
            continue;
        }
        let (a, b) = (m.points[inner], m.points[j]);
        let (along, side) = (sub(b, a), sub(s.points[(i + 1) % s.count], s.points[i]));
        let slope = cross(along, side);
        if slope != 0.0 {
            let part = cross(sub(s.points[i], a), side) / slope;
            ends[j] = [a[0] + part * along[0], a[1] + part * along[1]];
        }
    }
    ends
}

/// Vertices of the intersection, counter-clockwise; returns how many there are (0, or 3 to 8).
pub(crate) fn clip(s: &ConvexPolygon, m: &ConvexPolygon, out: &mut [ClipVertex; 8]) -> usize {
    let signs = Signs::new(s, m);
    let slave_inside = |i: usize| (0..m.count).all(|j| signs.slave_in[j][i]);
    let master_inside = |j: usize| (0..s.count).all(|i| signs.master_in[i][j]);
    let crossing = |i: usize, j: usize| signs.crosses(s, m, i, j);
    let on_slave = |i: usize, not: usize| (0..m.count).find(|&j| j != not && crossing(i, j));
    let on_master = |j: usize, not: usize| (0..s.count).find(|&i| i != not && crossing(i, j));
    const NO: usize = usize::MAX;

    let start = (0..s.count).find(|&i| slave_inside(i)).map(ClipVertex::Slave).or_else(|| {
        (0..s.count)
            .find_map(|i| on_slave(i, NO).map(|master| ClipVertex::Crossing { slave: i, master }))
            .or_else(|| (0..m.count).find(|&j| master_inside(j)).map(ClipVertex::Master))
    });
    let Some(start) = start else { return 0 };

    let along_slave = |i: usize, not: usize| match on_slave(i, not) {
        Some(master) => ClipVertex::Crossing { slave: i, master },
        None => ClipVertex::Slave((i + 1) % s.count),
    };
    let along_master = |j: usize, not: usize| match on_master(j, not) {
        Some(slave) => ClipVertex::Crossing { slave, master: j },
        None => ClipVertex::Master((j + 1) % m.count),
    };
    let mut vertex = start;
    let mut count = 0;
    while count < out.len() {
        out[count] = vertex;
        count += 1;
        vertex = match vertex {
            ClipVertex::Slave(i) => along_slave(i, NO),
            ClipVertex::Master(j) => along_master(j, NO),
            // The slave's side leaves the master here: the master's side enters the slave.
            ClipVertex::Crossing { slave, master } if signs.slave_in[master][slave] => along_master(master, slave),
            ClipVertex::Crossing { slave, master } => along_slave(slave, master),
        };
        if vertex == start {
            return count;
        }
    }
    // Where planes of symmetry meet at a small angle, projection may move a side beyond the line in which they meet.
    let planes = s.planes.iter().chain(&m.planes).fold(0, |all, planes| all | planes);
    debug_assert!(planes != 0, "the intersection of convex polygons has at most eight vertices");
    0
}

/// Fractions along the slave's side and along the master's side at which they cross, from the side's first corner.
///
/// Computed from the end points in lexicographic order: the neighbour over either side gets the same point to the
/// last bit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Corners of the slave facet, in the order in which the fraction counts.
    pub slave_corners: [u8; 2],
    pub slave_fraction: f64,
    pub master_corners: [u8; 2],
    pub master_fraction: f64,
}

fn ordered(piece: &ConvexPolygon, side: usize) -> ([u8; 2], [[f64; 2]; 2]) {
    let next = (side + 1) % piece.count;
    let (a, b) = (piece.points[side], piece.points[next]);
    let corners = [piece.corners[side], piece.corners[next]];
    if a[0] < b[0] || (a[0] == b[0] && a[1] <= b[1]) { (corners, [a, b]) } else { ([corners[1], corners[0]], [b, a]) }
}

fn fraction_of(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (d, r) = (sub(b, a), sub(p, a));
    (r[0] * d[0] + r[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])
}

pub(crate) fn crossing(s: &ConvexPolygon, slave: usize, m: &ConvexPolygon, master: usize) -> Crossing {
    let (slave_corners, [a, b]) = ordered(s, slave);
    let (master_corners, [c, d]) = ordered(m, master);
    let (from, to) = (orient(c, d, a), orient(c, d, b));
    // The sides cross, or touch: both are zero only if they lie on one line.
    let raw = if from == to { 0.5 } else { from / (from - to) };
    // Nearly parallel sides: round-off may put the point beyond the other side's ends.
    let (u, v) = (fraction_of(c, a, b), fraction_of(d, a, b));
    let s_fraction = if cross(sub(b, a), sub(d, c)).abs() < 1e-8 * norm(sub(b, a)) * norm(sub(d, c)) {
        raw.max(u.min(v)).min(u.max(v)).clamp(0.0, 1.0)
    } else {
        raw.clamp(0.0, 1.0)
    };
    let p = std::array::from_fn(|i| a[i] + s_fraction * (b[i] - a[i]));
    let master_fraction = fraction_of(p, c, d);
    // At a plane of symmetry the side goes on behind its corner.
    let goes_on = m.planes[master] | m.planes[(master + 1) % m.count] != 0;
    let master_fraction = if goes_on { master_fraction } else { master_fraction.clamp(0.0, 1.0) };
    Crossing { slave_corners, slave_fraction: s_fraction, master_corners, master_fraction }
}

fn norm(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}
