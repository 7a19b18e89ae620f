//! A patch of triangles as the sum of its triangles less the edges between them, plus the vertices inside: the surface of a patch that turns inward; theory/barrier#pieces.

use super::begin::Onset;
use crate::proximity::Candidate;
use crate::{Layer, Skin};
use nalgebra::Vector3;
use stoss_geometry::{ClosestPair, PairKind, closest, combine};

/// Way along a surface, in gaps, up to which the pieces of a patch act one by one.
const SLIGHT_WAY: f64 = 0.5;

/// Height of the corner of a neighbour over its distance up to which a surface counts as flat.
const EVEN: f64 = 1e-12;

/// Relative difference between the sum of the pieces and the nearest one that is round-off.
const SAME: f64 = 1e-12;

/// Piece of the sum over a patch: a triangle, an edge that is taken off, or a vertex, and the point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Summand {
    pub kind: PairKind,
    pub points: [u32; 4],
    pub sign: f64,
    /// Facets of a candidate that it is part of.
    pub facets: [u32; 2],
    pub distance_squared: f64,
}

/// Pieces, and lists to find them.
#[derive(Debug, Default)]
pub(super) struct PieceList {
    pub list: Vec<Summand>,
    edges: Vec<([u32; 2], u32)>,
    vertices: Vec<(u32, u32)>,
}

/// The candidates of a point on a patch, and the thickness of its layer.
pub(super) struct Patch<'a> {
    pub skin: &'a Skin,
    pub candidates: &'a [Candidate],
    pub members: &'a [u32],
    pub thickness: f64,
}

impl Patch<'_> {
    /// Adds the pieces that are in the layer at `x` to the list.
    pub fn add(&self, x: &[Vector3<f64>], pieces: &mut PieceList) {
        let PieceList { list, edges, vertices } = pieces;
        let square = self.thickness * self.thickness;
        let mut add = |kind: PairKind, points: [u32; 4], sign: f64, member: u32| {
            let distance_squared = closest(kind, &points.map(|p| x[p as usize])).distance_squared;
            if distance_squared < square {
                let facets = self.candidates[member as usize].facets;
                list.push(Summand { kind, points, sign, facets, distance_squared });
            }
        };
        edges.clear();
        vertices.clear();
        let mut point = 0;
        for &k in self.members {
            let [p, a, b, c] = self.candidates[k as usize].points;
            point = p;
            add(PairKind::VertexTriangle, [p, a, b, c], 1.0, k);
            edges.extend([[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], k)));
            vertices.extend([a, b, c].map(|v| (v, k)));
        }
        edges.sort_unstable();
        for two in edges.windows(2).filter(|two| two[0].0 == two[1].0) {
            let ([a, b], k) = two[0];
            add(PairKind::VertexEdge, [point, a, b, a], -1.0, k);
        }
        vertices.sort_unstable();
        for same in vertices.chunk_by(|a, b| a.0 == b.0) {
            let (v, k) = same[0];
            if same.len() as u32 == self.skin.fan(v) {
                add(PairKind::VertexVertex, [point, v, point, v], 1.0, k);
            }
        }
    }

    /// Whether the pieces at `x` are more than the nearest place; then they are left in the list.
    pub fn several(&self, x: &[Vector3<f64>], pieces: &mut PieceList) -> bool {
        pieces.list.clear();
        let square = self.thickness * self.thickness;
        let inside = |k: &&u32| {
            let c = &self.candidates[**k as usize];
            let x = c.of(x);
            c.may_meet(&x, &[Vector3::zeros(); 4], self.thickness) && closest(c.kind, &x).distance_squared < square
        };
        if self.members.len() < 2 || self.members.iter().filter(inside).take(2).count() < 2 {
            return false;
        }
        self.add(x, pieces);
        let triangles = pieces.list.iter().filter(|piece| piece.kind == PairKind::VertexTriangle);
        let least = triangles.fold(f64::INFINITY, |least, piece| least.min(piece.distance_squared));
        let layer = Layer::new(1.0, self.thickness);
        let sum: f64 = pieces.list.iter().map(|piece| piece.sign * layer.evaluate(piece.distance_squared)[0]).sum();
        let largest = layer.evaluate(least)[0];
        (sum - largest).abs() > SAME * largest
    }

    /// Whether it turns inward at an edge near its point, which moves along it by less than a part of its distance: then its pieces act one by one in all of the step, so that nothing changes when an iterate comes to
    /// where they differ from the nearest place.
    pub fn turns_inward(&self, onset: &Onset<'_>, begin: &Candidate, start: &ClosestPair) -> bool {
        let reach = 2.0 * onset.thickness;
        let square = reach * reach;
        if self.members.len() == 1 || start.distance_squared > square {
            return false;
        }
        let (x, y) = (begin.of(onset.x_n), begin.of(onset.predicted));
        let r = combine(&start.weights, &x);
        let moved = combine(&start.weights, &std::array::from_fn(|i| y[i] - x[i]));
        let across = moved - r * (r.dot(&moved) / r.norm_squared());
        if across.norm() > SLIGHT_WAY * r.norm().min(onset.thickness) {
            return false;
        }
        let is_near = |k: &u32| {
            let c = &self.candidates[*k as usize];
            closest(c.kind, &c.of(onset.x_n)).distance_squared < square
        };
        let at = |v: u32| onset.x_n[v as usize];
        let inward = |s: &[u32; 4], t: &[u32; 4]| {
            let common = s[1..].iter().filter(|v| t[1..].contains(v)).count();
            if common != 2 {
                return false;
            }
            let a = at(s[1]);
            let normal = (at(s[2]) - a).cross(&(at(s[3]) - a));
            let size = normal.norm();
            t[1..].iter().filter(|v| !s[1..].contains(v)).any(|&v| {
                let d = at(v) - a;
                normal.dot(&d) > EVEN * size * d.norm()
            })
        };
        let points = |k: u32| &self.candidates[k as usize].points;
        self.members.iter().enumerate().any(|(i, &k)| {
            self.members[..i].iter().any(|&l| inward(points(k), points(l)) && is_near(&k) && is_near(&l))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SkinFacet;
    use fastrand::Rng;
    use stoss_reference_element::FacetNodes;

    const N: u32 = 6;

    /// A square of random triangles over a grid, of the height `curve r^2` over its middle, and a triangle of another class with the first node.
    fn surface(rng: &mut Rng, curve: f64) -> (Skin, Vec<f64>) {
        let middle = 0.5 * f64::from(N);
        let height = |i: f64, j: f64| curve * ((i - middle).powi(2) + (j - middle).powi(2));
        let mut q = vec![0.0, 0.0, 9.0, 1.0, 0.0, 9.0, 0.0, 1.0, 9.0];
        let mut facets = vec![SkinFacet { nodes: FacetNodes::from([0, 1, 2]), class: 1 }];
        for j in 0..=N {
            for i in 0..=N {
                let [x, y] = [i, j].map(f64::from);
                q.extend([x, y, height(x, y)]);
            }
        }
        let mut add = |nodes: [u32; 3]| facets.push(SkinFacet { nodes: FacetNodes::from(nodes), class: 0 });
        for j in 0..N {
            for i in 0..N {
                let a = 3 + i + (N + 1) * j;
                let [a, b, c, d] = [a, a + 1, a + N + 2, a + N + 1];
                // Diagonals along which the surface turns as it does elsewhere.
                let falls = (f64::from(i) + 0.5 - middle) * (f64::from(j) + 0.5 - middle) < 0.0;
                if if curve == 0.0 { rng.bool() } else { falls == (curve < 0.0) } {
                    add([a, b, c]);
                    add([a, c, d]);
                } else {
                    add([a, b, d]);
                    add([b, c, d]);
                }
            }
        }
        (Skin::new(facets, &q, &|_| None), q)
    }

    /// Pieces are the nearest place on surfaces that are flat or turn outward; where they turn inward they are more, and their energy has no kink where two places are equally near.
    #[test]
    fn pieces_are_the_nearest_place_unless_the_surface_turns_inward() {
        let mut rng = Rng::with_seed(4);
        let thickness = 1.0;
        let layer = Layer::new(1.0, thickness);
        for curve in [0.0, -0.02, 0.02] {
            let (skin, q) = surface(&mut rng, curve);
            let mut x = Vec::new();
            skin.place(&q, &mut x);
            let candidate = |t: u32| {
                let [a, b, c] = skin.triangles()[t as usize];
                let kind = PairKind::VertexTriangle;
                Candidate {
                    facets: [0, t],
                    kind,
                    points: [0, a, b, c],
                    of: [t, t],
                    classes: [1, 0],
                    is_integration_point: false,
                }
            };
            let candidates: Vec<Candidate> = (1..skin.triangles().len() as u32).map(candidate).collect();
            let members: Vec<u32> = (0..candidates.len() as u32).collect();
            let patch = Patch { skin: &skin, candidates: &candidates, members: &members, thickness };
            let mut pieces = PieceList::default();
            let energy = |x: &[Vector3<f64>], pieces: &mut PieceList| {
                let more = patch.several(x, pieces);
                (
                    more,
                    pieces.list.iter().map(|piece| piece.sign * layer.evaluate(piece.distance_squared)[0]).sum::<f64>(),
                )
            };
            let mut more = 0;
            for _ in 0..400 {
                let [a, b] = [(); 2].map(|()| 2.0 + (f64::from(N) - 4.0) * rng.f64());
                let middle = 0.5 * f64::from(N);
                x[0] =
                    Vector3::new(a, b, curve * ((a - middle).powi(2) + (b - middle).powi(2)) + 0.2 + 0.5 * rng.f64());
                let (several, value) = energy(&x, &mut pieces);
                more += usize::from(several);
                assert!(!several || curve > 0.0, "{curve} {}", x[0]);
                // Slopes ahead and behind, by steps in which they change by the curvature alone.
                let step = 1e-5;
                let mut at = |s: f64| {
                    let mut y = x.clone();
                    y[0].x += s;
                    energy(&y, &mut pieces).1
                };
                let (ahead, behind) = (at(step) - value, value - at(-step));
                assert!(
                    value == 0.0 || (ahead - behind).abs() <= 1e-6 * step * 1e3,
                    "{curve} {} {ahead:e} {behind:e}",
                    x[0]
                );
            }
            assert_eq!(more > 10, curve > 0.0, "{curve}: {more}");
        }
    }
}
