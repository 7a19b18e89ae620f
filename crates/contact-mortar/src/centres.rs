//! Where the rows of dual functions have their centres on a facet that is partly opposite the master (theory/mortar#centres): the corners of the parallelogram
//! with the first and second moments of the opposite part, taken back into that part along the rays from its centroid. All but the ray's end is a smooth
//! function of the moments, and points never meet, however narrow the part is.

use crate::local::{NodeMatrix, NodeVector};
use nalgebra::{Matrix2, SMatrix, Vector2};
use stoss_reference_element::{FacetKind, MAX_NODES};

/// `int 1, y_1, y_2, y_1^2, y_2^2, y_1 y_2` over a part of the facet, in coordinates in which the whole facet has the centroid zero and the covariance one.
pub(crate) type Moments = SMatrix<f64, 6, 1>;
/// A derivative by the moments.
type ByMoments = SMatrix<f64, 1, 6>;

/// Coordinates `y = L (xi - centre)` of a kind of facets: `L`.
fn map(kind: FacetKind) -> Matrix2<f64> {
    let root = 3.0f64.sqrt();
    if kind.node_count() == 3 {
        Matrix2::new(3.0 + root, 3.0 - root, 3.0 - root, 3.0 + root)
    } else {
        Matrix2::new(root, 0.0, 0.0, root)
    }
}

/// `y` of a point.
pub(crate) fn image(kind: FacetKind, xi: [f64; 2]) -> Vector2<f64> {
    map(kind) * (Vector2::from(xi) - Vector2::from(kind.centre()))
}

/// `y` of a variation of a point.
pub(crate) fn image_of_variation(kind: FacetKind, xi: [f64; 2]) -> Vector2<f64> {
    map(kind) * Vector2::from(xi)
}

fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// What the edge from `p` to `q` of a polygon, counter-clockwise, adds to the moments.
pub(crate) fn edge_moments(p: Vector2<f64>, q: Vector2<f64>) -> Moments {
    let sum = p + q;
    let square = |a: f64, b: f64| (a * a + a * b + b * b) / 12.0;
    let mixed = (p.x * q.y + 2.0 * p.x * p.y + 2.0 * q.x * q.y + q.x * p.y) / 24.0;
    Moments::from([0.5, sum.x / 6.0, sum.y / 6.0, square(p.x, q.x), square(p.y, q.y), mixed]) * cross(p, q)
}

/// Variation of [`edge_moments`] when `p` and `q` move by `dp` and `dq`.
pub(crate) fn edge_variation(p: Vector2<f64>, q: Vector2<f64>, dp: Vector2<f64>, dq: Vector2<f64>) -> Moments {
    let (sum, moved) = (p + q, dp + dq);
    let square = |a: f64, b: f64| (a * a + a * b + b * b) / 12.0;
    let squares = |a: f64, b: f64, da: f64, db: f64| (da * (2.0 * a + b) + db * (a + 2.0 * b)) / 12.0;
    let mixed = (p.x * q.y + 2.0 * p.x * p.y + 2.0 * q.x * q.y + q.x * p.y) / 24.0;
    let mixing =
        (dp.x * (q.y + 2.0 * p.y) + dp.y * (2.0 * p.x + q.x) + dq.x * (2.0 * q.y + p.y) + dq.y * (p.x + 2.0 * q.x))
            / 24.0;
    let value = Moments::from([0.5, sum.x / 6.0, sum.y / 6.0, square(p.x, q.x), square(p.y, q.y), mixed]);
    let change =
        [0.0, moved.x / 6.0, moved.y / 6.0, squares(p.x, q.x, dp.x, dq.x), squares(p.y, q.y, dp.y, dq.y), mixing];
    value * (cross(dp, q) + cross(p, dq)) + Moments::from(change) * cross(p, q)
}

/// Moments of a polygon.
pub(crate) fn polygon_moments(polygon: &[Vector2<f64>]) -> Moments {
    let next = |k: usize| polygon[(k + 1) % polygon.len()];
    polygon.iter().enumerate().map(|(k, &p)| edge_moments(p, next(k))).sum()
}

/// Where a ray from the centroid leaves the opposite part: a point of an edge of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Exit {
    /// The segment.
    pub segment: usize,
    /// The vertex at which the edge begins.
    pub vertex: usize,
    /// Part of the edge before the point.
    pub part: f64,
    /// Part of the ray before it, below one.
    pub length: f64,
    /// How far the point moves along the ray, in parts of it, when the edge moves by one: a covector.
    pub normal: Vector2<f64>,
}

/// Centres of the rows of a facet, with derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Centres {
    /// The standard functions at the centres: row the centre, column the function.
    pub functions: NodeMatrix,
    /// Derivative of those by the moments.
    pub by_moments: [NodeMatrix; 6],
    /// Derivative of the rows by how far the points move along their rays.
    pub along_ray: NodeMatrix,
    /// Where rays leave, of centres at which they do.
    pub exits: [Option<Exit>; MAX_NODES],
}

impl Centres {
    /// The centres of a facet with the moments of its opposite part, and the polygons that this part is made of. `None` if that part has no width.
    pub fn new(kind: FacetKind, moments: &Moments, polygons: &[Vec<Vector2<f64>>]) -> Option<Self> {
        let area = moments[0];
        let centroid = Vector2::new(moments[1], moments[2]) / area;
        let means = moments / area;
        let covariance = [
            means[3] - centroid.x * centroid.x,
            means[4] - centroid.y * centroid.y,
            means[5] - centroid.x * centroid.y,
        ];
        // d means / d moments, then those of centroid and covariance.
        let by = |k: usize| {
            ByMoments::from_fn(|_, m| (f64::from(u8::from(m == k)) - if m == 0 { means[k] } else { 0.0 }) / area)
        };
        let [c_x, c_y] = [by(1), by(2)];
        let covariance_by = [
            by(3) - c_x * (2.0 * centroid.x),
            by(4) - c_y * (2.0 * centroid.y),
            by(5) - c_x * centroid.y - c_y * centroid.x,
        ];
        let (stretch, stretch_by) = root(kind, covariance, covariance_by)?;
        let back = map(kind).try_inverse()?;
        let mut out = Self {
            functions: NodeMatrix::identity(),
            by_moments: [NodeMatrix::zeros(); 6],
            along_ray: NodeMatrix::zeros(),
            exits: [None; MAX_NODES],
        };
        for (a, &corner) in kind.vertices().iter().enumerate() {
            let corner = image(kind, corner);
            // Symmetric 2 x 2 from its entries xx, yy, xy.
            let times =
                |s: [f64; 3]| Vector2::new(s[0] * corner.x + s[2] * corner.y, s[2] * corner.x + s[1] * corner.y);
            let ray = times(stretch);
            let ray_by: [Vector2<f64>; 6] = std::array::from_fn(|m| times(stretch_by.map(|s| s[m])));
            let centroid_by = |m: usize| Vector2::new(c_x[m], c_y[m]);
            let exit = leave(centroid, ray, polygons);
            let [length, slope] = exit.as_ref().map_or([1.0, 0.0], |exit| taken_back(exit.length));
            let point = centroid + ray * length;
            let xi = back * point + Vector2::from(kind.centre());
            let shape = kind.shape(xi.into());
            let gradient = kind.shape_gradient(xi.into()).map(|g| back.transpose() * Vector2::from(g));
            for j in 0..kind.node_count() {
                out.functions[(a, j)] = shape[j];
                for (m, by) in out.by_moments.iter_mut().enumerate() {
                    let mut moved = centroid_by(m) + ray_by[m] * length;
                    if let Some(exit) = &exit {
                        let at_exit = centroid_by(m) + ray_by[m] * exit.length;
                        moved -= ray * (slope * exit.normal.dot(&at_exit));
                    }
                    by[(a, j)] = gradient[j].dot(&moved);
                }
                if exit.is_some() {
                    out.along_ray[(a, j)] = slope * gradient[j].dot(&ray);
                }
            }
            out.exits[a] = exit;
        }
        Some(out)
    }

    /// Variation of the functions at the centres, for variations of the moments and of the points at which rays leave, along the rays.
    pub fn variation(&self, moments: &Moments, exits: &[f64; MAX_NODES]) -> NodeMatrix {
        let mut out = NodeMatrix::from_diagonal(&NodeVector::from(*exits)) * self.along_ray;
        self.by_moments.iter().zip(moments.iter()).for_each(|(by, d)| out += by * *d);
        out
    }
}

/// Stretch of a facet to a covariance (entries 11, 22, 12), and its derivative: along the coordinates of a quadrilateral, as its functions are products of those; the symmetric square root for a triangle.
fn root(kind: FacetKind, [s_11, s_22, s_12]: [f64; 3], by: [ByMoments; 3]) -> Option<([f64; 3], [ByMoments; 3])> {
    if kind.node_count() != 3 {
        let (a, b) = (s_11.sqrt(), s_22.sqrt());
        let is_wide = a > 0.0 && b > 0.0;
        return is_wide.then(|| ([a, b, 0.0], [by[0] * (0.5 / a), by[1] * (0.5 / b), ByMoments::zeros()]));
    }
    // S = (Sigma + t) / tau, t = sqrt(det Sigma), tau = sqrt(tr Sigma + 2 t)
    let t = (s_11 * s_22 - s_12 * s_12).sqrt();
    if t.is_nan() || t <= 0.0 {
        return None;
    }
    let tau = (s_11 + s_22 + 2.0 * t).sqrt();
    let dt = (by[0] * s_22 + by[1] * s_11 - by[2] * (2.0 * s_12)) * (0.5 / t);
    let dtau = (by[0] + by[1] + dt * 2.0) * (0.5 / tau);
    let s = [(s_11 + t) / tau, (s_22 + t) / tau, s_12 / tau];
    let d = [
        (by[0] + dt) / tau - dtau * (s[0] / tau),
        (by[1] + dt) / tau - dtau * (s[1] / tau),
        by[2] / tau - dtau * (s[2] / tau),
    ];
    Some((s, d))
}

/// Excess of a ray over the opposite part, in parts of what lies inside, up to which it is taken back by less than all of the excess, so that there is no kink where rays begin to leave.
const SOFT: f64 = 0.1;

/// How much of a ray is taken that leaves at `exit`, and the derivative of that: `1 / (1 + s^2 / (s + SOFT))` of the excess `s = 1 / exit - 1`.
fn taken_back(exit: f64) -> [f64; 2] {
    let excess = 1.0 / exit - 1.0;
    let soft = excess + SOFT;
    let length = 1.0 / (1.0 + excess * excess / soft);
    let slope = excess * (excess + 2.0 * SOFT) / (soft * soft);
    [length, slope * (length / exit).powi(2)]
}

/// Where the ray from `start` leaves the polygons last, if that is before its end.
fn leave(start: Vector2<f64>, ray: Vector2<f64>, polygons: &[Vec<Vector2<f64>>]) -> Option<Exit> {
    let mut last: Option<Exit> = None;
    for (segment, polygon) in polygons.iter().enumerate() {
        for (vertex, &p) in polygon.iter().enumerate() {
            let edge = polygon[(vertex + 1) % polygon.len()] - p;
            let rate = cross(ray, edge);
            // Outward only: the polygon is to the left of its edges.
            if rate <= 0.0 {
                continue;
            }
            let length = cross(p - start, edge) / rate;
            let part = cross(p - start, ray) / rate;
            if length > 0.0
                && (-ON_EDGE..=1.0 + ON_EDGE).contains(&part)
                && last.is_none_or(|last| length > last.length)
            {
                let normal = Vector2::new(edge.y, -edge.x) / rate;
                last = Some(Exit { segment, vertex, part, length, normal });
            }
        }
    }
    last.filter(|exit| exit.length < 1.0)
}

/// What rays miss edges by in round-off, in parts of the edge.
const ON_EDGE: f64 = 1e-10;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn kinds() -> [FacetKind; 2] {
        [FacetKind::Quad4, FacetKind::Tri3]
    }

    /// The part of a facet on one side of a line, counter-clockwise, in images.
    fn cut(kind: FacetKind, normal: Vector2<f64>, offset: f64) -> Vec<Vector2<f64>> {
        let corners: Vec<Vector2<f64>> = kind.vertices().iter().map(|&xi| image(kind, xi)).collect();
        let side = |p: &Vector2<f64>| normal.dot(p) - offset;
        let mut out = Vec::new();
        for (k, p) in corners.iter().enumerate() {
            let q = corners[(k + 1) % corners.len()];
            if side(p) >= 0.0 {
                out.push(*p);
            }
            if side(p) * side(&q) < 0.0 {
                out.push(p + (q - p) * (side(p) / (side(p) - side(&q))));
            }
        }
        out
    }

    /// Positions of the centres in images: the shape functions at them times the corners.
    fn points(kind: FacetKind, centres: &Centres) -> Vec<Vector2<f64>> {
        let corners = kind.vertices().iter().map(|&xi| image(kind, xi));
        (0..kind.node_count())
            .map(|a| corners.clone().enumerate().map(|(j, x)| x * centres.functions[(a, j)]).sum())
            .collect()
    }

    #[test]
    fn centres_of_a_whole_facet_are_its_corners_and_of_a_strip_those_of_the_strip() {
        for kind in kinds() {
            let corners: Vec<Vector2<f64>> = kind.vertices().iter().map(|&xi| image(kind, xi)).collect();
            let moments = polygon_moments(&corners);
            let centres = Centres::new(kind, &moments, &[corners]).unwrap();
            assert!((centres.functions - NodeMatrix::identity()).amax() < 1e-12, "{}", centres.functions);
        }
        let kind = FacetKind::Quad4;
        for width in [1e-4, 0.1, 0.7] {
            let strip: Vec<Vector2<f64>> =
                [[-1.0, -1.0], [-1.0 + width, -1.0], [-1.0 + width, 1.0], [-1.0, 1.0]].map(|xi| image(kind, xi)).into();
            let centres = Centres::new(kind, &polygon_moments(&strip), std::slice::from_ref(&strip)).unwrap();
            for (point, corner) in points(kind, &centres).iter().zip(&strip) {
                assert!((point - corner).norm() < 1e-7, "{width}: {point} {corner}");
            }
        }
    }

    const BESIDE: f64 = 0.0491 * 2.0 * std::f64::consts::SQRT_2;

    proptest! {
        /// No centre lies beside the covered part by more than what [`taken_back`] leaves of a ray, at most 0.0491 (excess 0.20) of the distance of a corner from the centroid, the root of 8; and no two come together: the functions are told apart
        /// as the part is wide.
        #[test]
        fn centres_lie_in_the_covered_part(angle in 0.0f64..6.2, offset in -1.5f64..1.2, triangle in any::<bool>()) {
            let kind = kinds()[usize::from(triangle)];
            let normal = Vector2::new(angle.cos(), angle.sin());
            let part = cut(kind, normal, offset);
            prop_assume!(part.len() > 2);
            let moments = polygon_moments(&part);
            prop_assume!(moments[0] > 1e-4);
            let centres = Centres::new(kind, &moments, &[part]).unwrap();
            for point in points(kind, &centres) {
                prop_assert!(normal.dot(&point) > offset - BESIDE, "{} {}", normal.dot(&point), offset);
            }
            let shares = centres.functions.transpose().try_inverse();
            prop_assert!(shares.is_some_and(|inverse| inverse.amax() * moments[0] < 100.0), "{:?}", shares);
        }

        /// Derivatives against differences, where the same rays leave through the same edges.
        #[test]
        fn the_functions_at_the_centres_have_their_derivatives(
            angle in 0.0f64..6.2, offset in -1.0f64..0.8, triangle in any::<bool>(),
            motion in prop::collection::vec(-1.0f64..1.0, 10),
        ) {
            let kind = kinds()[usize::from(triangle)];
            let part = cut(kind, Vector2::new(angle.cos(), angle.sin()), offset);
            prop_assume!(part.len() > 2 && polygon_moments(&part)[0] > 0.3);
            let motion: Vec<Vector2<f64>> = motion.chunks_exact(2).map(|d| Vector2::new(d[0], d[1])).collect();
            let at = |h: f64| {
                let moved: Vec<Vector2<f64>> = part.iter().zip(&motion).map(|(p, d)| p + d * h).collect();
                Centres::new(kind, &polygon_moments(&moved), &[moved]).unwrap()
            };
            let h = 1e-6;
            let (here, plus, minus) = (at(0.0), at(h), at(-h));
            let edges = |c: &Centres| c.exits.map(|exit| exit.map(|exit| exit.vertex));
            prop_assume!(edges(&plus) == edges(&here) && edges(&minus) == edges(&here));
            let mut moments = Moments::zeros();
            let mut exits = [0.0; MAX_NODES];
            for (k, &p) in part.iter().enumerate() {
                let next = (k + 1) % part.len();
                moments += edge_variation(p, part[next], motion[k], motion[next]);
                for (exit, a) in here.exits.iter().zip(&mut exits) {
                    if let Some(exit) = exit.filter(|exit| exit.vertex == k) {
                        *a += exit.normal.dot(&(motion[k] * (1.0 - exit.part) + motion[next] * exit.part));
                    }
                }
            }
            let exact = here.variation(&moments, &exits);
            let difference = (plus.functions - minus.functions) / (2.0 * h);
            prop_assert!((exact - difference).amax() < 1e-6 * (1.0 + exact.amax()), "{exact} {difference}");
        }
    }
}
