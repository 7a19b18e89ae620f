//! Surfaces of linear cells that are round: facets of their own for contact, with vertices on the cylinder or sphere (theory/barrier#round).

use std::collections::{BTreeMap, BTreeSet};
use stoss_geometry::Round;
use stoss_reference_element::FacetNodes;

type Vector3 = nalgebra::Vector3<f64>;

/// Pieces of a side that lies along the curvature: the facets are a ninth as far from the surface as before.
const PIECES: usize = 3;

/// Height of the arch over a side, in parts of the side, from which on it spans more than 60 degrees: `tan(15 degrees) / 2`.
const WIDEST: f64 = 0.134;

/// Nodes are on the surface if they are nearer to it than this part of the largest height of a side's arch.
const ON: f64 = 0.05;

/// A side is straight if the surface is no farther from its middle than this part of its length.
const STRAIGHT: f64 = 1e-6;

/// How far beyond an element its vertices may lie, in natural coordinates: half of its depth.
pub const BEYOND: f64 = 1.0;

/// A point between the corners of a facet, by which finer facets of a round surface share their vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum VertexKey {
    /// A point on the side between two nodes, the smaller number first, so many pieces from the first.
    Side([u32; 2], u8),
    /// A point inside of a facet: element, number in it, and number there.
    Inside(u32, u8, u8),
}

/// Facets in place of those of the mesh, by element and number in it, and the points that they need beside nodes: these with the element that they go with and their places.
#[derive(Debug, Default)]
pub struct Finer {
    /// The facets.
    pub facets: BTreeMap<(u32, u8), Vec<Vec<Corner>>>,
    /// The points.
    pub points: BTreeMap<VertexKey, (u32, Vector3)>,
}

/// A corner of a finer facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// A node.
    Node(u32),
    /// A point beside the nodes.
    Point(VertexKey),
}

/// A linear facet of the surface of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryFacet {
    /// Element, and number of the facet in it.
    pub number: (u32, u8),
    /// Nodes of the facet, outward.
    pub nodes: FacetNodes,
}

/// What a surface is fitted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundKind {
    /// A cylinder.
    Cylinder,
    /// A sphere.
    Sphere,
}

/// Why facets are not taken for a round surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RoundFault {
    /// Nodes that neither a cylinder nor a sphere fits.
    NoFit,
    /// Nodes are off the surface that fits best.
    Off {
        /// Largest distance of a node from it, a length.
        off: f64,
        /// The largest arch over a side, a length.
        arch: f64,
    },
    /// Sides span more than 60 degrees: as many points lie on many surfaces.
    TooCoarse,
    /// A facet belongs to two surfaces.
    Twice {
        /// Element of the facet, and number of the facet in it.
        facet: (u32, u8),
    },
}

/// The round surfaces of a body.
#[derive(Debug, Default)]
pub struct RoundSurfaces {
    /// Surfaces of sides along the curvature.
    sides: BTreeMap<[u32; 2], Round>,
    /// Surfaces of facets.
    rounds: BTreeMap<(u32, u8), Round>,
}

impl RoundSurfaces {
    /// Fits one by its facets; `at`: places of nodes, lengths.
    ///
    /// # Errors
    /// [`RoundFault`]: nothing is added, but for facets before one that is named twice.
    pub fn add(
        &mut self,
        facets: &[BoundaryFacet],
        kind: RoundKind,
        at: &dyn Fn(u32) -> Vector3,
    ) -> Result<(), RoundFault> {
        let nodes: BTreeSet<u32> = facets.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
        let points: Vec<Vector3> = nodes.iter().map(|&node| at(node)).collect();
        let normals: Vec<Vector3> = facets.iter().map(|facet| area_vector(facet, at)).collect();
        let fitted = match kind {
            RoundKind::Cylinder => Round::cylinder(&points, &normals),
            RoundKind::Sphere => Round::sphere(&points),
        };
        let round = fitted.ok_or(RoundFault::NoFit)?;
        let middle = |[a, b]: [u32; 2]| (at(a) + at(b)) * 0.5;
        let arch = facets.iter().flat_map(sides_of).map(|s| round.distance(&middle(s))).fold(0.0, f64::max);
        let off = points.iter().map(|x| round.distance(x)).fold(0.0, f64::max);
        if off > ON * arch {
            return Err(RoundFault::Off { off, arch });
        }
        let steep = |s: [u32; 2]| round.distance(&middle(s)) / (at(s[0]) - at(s[1])).norm();
        if facets.iter().flat_map(sides_of).map(steep).fold(0.0, f64::max) > WIDEST {
            return Err(RoundFault::TooCoarse);
        }
        for facet in facets {
            if self.rounds.insert(facet.number, round).is_some() {
                return Err(RoundFault::Twice { facet: facet.number });
            }
            for side in sides_of(facet) {
                let length = (at(side[0]) - at(side[1])).norm();
                if round.distance(&middle(side)) > STRAIGHT * length {
                    self.sides.entry(side).or_insert(round);
                }
            }
        }
        Ok(())
    }

    /// Facets with sides in pieces, for the linear ones of the whole `boundary`. Quadrilaterals whose opposite sides have as many pieces are grids; others, and facets beside, are triangles about a point in the middle.
    pub fn finer(&self, boundary: impl IntoIterator<Item = BoundaryFacet>, at: &dyn Fn(u32) -> Vector3) -> Finer {
        let Self { sides, rounds } = self;
        let mut finer = Finer::default();
        for facet in boundary {
            let split: Vec<bool> = sides_of(&facet).map(|side| sides.contains_key(&side)).collect();
            if !split.contains(&true) {
                continue;
            }
            let nodes: Vec<u32> = facet.nodes.iter().copied().collect();
            let number = facet.number;
            let mut point = |place: VertexKey, x: Vector3| {
                finer.points.entry(place).or_insert((number.0, x));
                Corner::Point(place)
            };
            // Along a side from its first corner.
            let mut on_side = |from: u32, to: u32, piece: usize| {
                if piece == 0 {
                    return Corner::Node(from);
                }
                let (side, k) = if from < to { ([from, to], piece) } else { ([to, from], PIECES - piece) };
                let part = k as f64 / PIECES as f64;
                let x = at(side[0]) * (1.0 - part) + at(side[1]) * part;
                let x = sides.get(&side).map_or(x, |round| round.nearest(&x));
                point(VertexKey::Side(side, k as u8), x)
            };
            let chains: Vec<Vec<Corner>> = (0..nodes.len())
                .map(|k| {
                    let count = if split[k] { PIECES } else { 1 };
                    (0..count).map(|piece| on_side(nodes[k], nodes[(k + 1) % nodes.len()], piece)).collect()
                })
                .collect();
            let onto = |x: Vector3| rounds.get(&number).map_or(x, |round| round.nearest(&x));
            let is_grid = nodes.len() == 4 && split[0] == split[2] && split[1] == split[3];
            let list = if is_grid && rounds.contains_key(&number) {
                let (m, n) = (chains[0].len(), chains[1].len());
                let corners: Vec<Vector3> = nodes.iter().map(|&node| at(node)).collect();
                let mut corner = |i: usize, j: usize| -> Corner {
                    match (i, j) {
                        (i, 0) if i < m => chains[0][i],
                        (i, j) if i == m && j < n => chains[1][j],
                        (i, j) if j == n && i > 0 => chains[2][m - i],
                        (0, j) => chains[3][n - j],
                        (i, j) => {
                            let (s, t) = (i as f64 / m as f64, j as f64 / n as f64);
                            let x = (corners[0] * (1.0 - s) + corners[1] * s) * (1.0 - t)
                                + (corners[3] * (1.0 - s) + corners[2] * s) * t;
                            point(VertexKey::Inside(number.0, number.1, (j * (PIECES + 1) + i) as u8), onto(x))
                        }
                    }
                };
                (0..m)
                    .flat_map(|i| (0..n).map(move |j| [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]))
                    .map(|cell| cell.map(|[i, j]| corner(i, j)).to_vec())
                    .collect()
            } else {
                let middle = onto(nodes.iter().map(|&node| at(node)).sum::<Vector3>() / nodes.len() as f64);
                let middle = point(VertexKey::Inside(number.0, number.1, 0), middle);
                let around: Vec<Corner> = chains.concat();
                (0..around.len()).map(|k| vec![around[k], around[(k + 1) % around.len()], middle]).collect()
            };
            finer.facets.insert(number, list);
        }
        finer
    }
}

fn sides_of(facet: &BoundaryFacet) -> impl Iterator<Item = [u32; 2]> + use<> {
    let nodes: Vec<u32> = facet.nodes.iter().copied().collect();
    let n = nodes.len();
    (0..n).map(move |k| [nodes[k], nodes[(k + 1) % n]]).map(|[a, b]| [a.min(b), a.max(b)])
}

/// Area times normal, outward.
fn area_vector(facet: &BoundaryFacet, at: &dyn Fn(u32) -> Vector3) -> Vector3 {
    let x: Vec<Vector3> = facet.nodes.iter().map(|&node| at(node)).collect();
    let fan = x.windows(2).skip(1).map(|pair| (pair[0] - x[0]).cross(&(pair[1] - x[0])));
    fan.sum::<Vector3>() * 0.5
}

impl Finer {
    /// A finer facet in global node numbers.
    pub fn nodes(corners: &[Corner], number: impl Fn(&Corner) -> u32) -> FacetNodes {
        match *corners {
            [a, b, c] => FacetNodes::from([a, b, c].map(|corner| number(&corner))),
            // cannot fail: finer facets have three or four corners.
            _ => FacetNodes::from(std::array::from_fn::<u32, 4, _>(|k| number(&corners[k]))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The round side of a cylinder of `n` faces around, radius 1, between z = 0 and 1.
    fn drum(n: u32) -> (Vec<BoundaryFacet>, Vec<Vector3>) {
        let at = |k: u32, z: f64| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n);
            Vector3::new(angle.cos(), angle.sin(), z)
        };
        let places = (0..n).flat_map(|k| [at(k, 0.0), at(k, 1.0)]).collect();
        let facet = |k: u32| {
            let next = (k + 1) % n;
            BoundaryFacet { number: (k, 2), nodes: FacetNodes::from([2 * k, 2 * next, 2 * next + 1, 2 * k + 1]) }
        };
        ((0..n).map(facet).collect(), places)
    }

    #[test]
    fn vertices_of_a_drum_are_on_its_cylinder() {
        let (facets, places) = drum(8);
        let at = |node: u32| places[node as usize];
        let mut round = RoundSurfaces::default();
        round.add(&facets, RoundKind::Cylinder, &at).unwrap();
        let finer = round.finer(facets.iter().copied(), &at);
        assert_eq!(finer.facets.len(), 8);
        // Sides along the axis are straight: three pieces around, one along.
        assert!(finer.facets.values().all(|list| list.len() == PIECES));
        assert_eq!(finer.points.len(), 8 * 2 * (PIECES - 1));
        assert!(finer.points.values().all(|(_, x)| (x.xy().norm() - 1.0).abs() < 1e-12));
        assert_eq!(round.add(&facets, RoundKind::Cylinder, &at), Err(RoundFault::Twice { facet: (0, 2) }));
    }

    #[test]
    fn what_is_not_round_is_refused() {
        let (facets, mut places) = drum(4);
        let mut round = RoundSurfaces::default();
        assert_eq!(round.add(&facets, RoundKind::Cylinder, &|n| places[n as usize]), Err(RoundFault::TooCoarse));
        let (facets, other) = drum(9);
        places = other;
        places[3] *= 1.2;
        let refused = round.add(&facets, RoundKind::Cylinder, &|n| places[n as usize]);
        assert!(matches!(refused, Err(RoundFault::Off { .. })), "{refused:?}");
        assert!(round.finer(facets, &|n| places[n as usize]).facets.is_empty());
    }
}
