//! Surfaces of linear cells that the scene calls round: facets of their own for contact, with vertices on the cylinder or sphere (theory/barrier#round).

use super::{Problems, general_contact};
use crate::scene::{RoundShape, RoundSurface, Scene, split_set};
use std::collections::{BTreeMap, BTreeSet};
use stoss_mesh::{Facet, Mesh};
use stoss_reference_element::FacetNodes;
use stoss_tensor::Vector3;
use stoss_tensor::nalgebra::{Matrix4, Matrix5, Vector4, Vector5};

/// Pieces of a side that lies along the curvature: the facets are a ninth as far from the surface as before.
const PIECES: usize = 3;

/// Height of the arch over a side, in parts of the side, from which on it spans more than 60 degrees: `tan(15 degrees) / 2`.
const WIDEST: f64 = 0.134;

/// Nodes are on the surface if they are nearer to it than this part of the largest height of a side's arch.
const ON: f64 = 0.05;

/// A side is straight if the surface is no farther from its middle than this part of its length.
const STRAIGHT: f64 = 1e-6;

/// Iterations of the fit; a few are usual.
const ITERATIONS: usize = 50;

/// How far beyond an element its vertices may lie, in natural coordinates: half of its depth.
pub(super) const BEYOND: f64 = 1.0;

/// A cylinder or a sphere in the reference.
#[derive(Clone, Copy, Debug)]
enum Round {
    Cylinder { origin: Vector3, axis: Vector3, radius: f64 },
    Sphere { centre: Vector3, radius: f64 },
}

impl Round {
    /// The point of the surface nearest to `x`.
    fn nearest(&self, x: &Vector3) -> Vector3 {
        match *self {
            Self::Cylinder { origin, axis, radius } => {
                let along = axis * (x - origin).dot(&axis);
                let across = x - origin - along;
                origin + along + across * (radius / across.norm())
            }
            Self::Sphere { centre, radius } => centre + (x - centre) * (radius / (x - centre).norm()),
        }
    }

    fn distance(&self, x: &Vector3) -> f64 {
        (x - self.nearest(x)).norm()
    }

    /// The sphere through points, in the sense of least squares of `|x|^2 - 2 c . x - d`.
    fn sphere(points: &[Vector3]) -> Option<Self> {
        let mean = points.iter().sum::<Vector3>() / points.len() as f64;
        let (mut a, mut b) = (Matrix4::zeros(), Vector4::zeros());
        for x in points {
            let x = x - mean;
            let row = Vector4::new(2.0 * x[0], 2.0 * x[1], 2.0 * x[2], 1.0);
            a += row * row.transpose();
            b += row * x.norm_squared();
        }
        let s = a.try_inverse()? * b;
        let centre = Vector3::new(s[0], s[1], s[2]);
        let radius = (s[3] + centre.norm_squared()).sqrt();
        (radius > 0.0 && radius.is_finite()).then_some(Self::Sphere { centre: centre + mean, radius })
    }

    /// The cylinder through points: the axis first from the normals of facets (weighted by areas), which are perpendicular to it, then by Gauss-Newton on the distances.
    fn cylinder(points: &[Vector3], normals: &[Vector3]) -> Option<Self> {
        let mean = points.iter().sum::<Vector3>() / points.len() as f64;
        let spread = normals.iter().map(|n| n * n.transpose() / n.norm()).sum::<stoss_tensor::nalgebra::Matrix3<f64>>();
        let eigen = spread.symmetric_eigen();
        let mut axis: Vector3 = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
        let frame = |axis: &Vector3| {
            let u = axis.cross(&if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() }).normalize();
            [u, axis.cross(&u)]
        };
        // A circle in the plane across the axis.
        let [u, v] = frame(&axis);
        let (mut a, mut b) = (stoss_tensor::nalgebra::Matrix3::zeros(), Vector3::zeros());
        for x in points {
            let x = x - mean;
            let (p, q) = (x.dot(&u), x.dot(&v));
            let row = Vector3::new(2.0 * p, 2.0 * q, 1.0);
            a += row * row.transpose();
            b += row * (p * p + q * q);
        }
        let s = a.try_inverse()? * b;
        let mut origin = u * s[0] + v * s[1];
        let mut radius = (s[2] + s[0] * s[0] + s[1] * s[1]).sqrt();
        for _ in 0..ITERATIONS {
            let [u, v] = frame(&axis);
            let (mut a, mut b) = (Matrix5::zeros(), Vector5::zeros());
            for x in points {
                let x = x - mean - origin;
                let along = x.dot(&axis);
                let across = x - axis * along;
                let r = across.norm();
                let e = across / r;
                // Of the distance by the origin and the axis, each along u and v, and by the radius.
                let row = Vector5::new(-e.dot(&u), -e.dot(&v), -along * e.dot(&u), -along * e.dot(&v), -1.0);
                a += row * row.transpose();
                b -= row * (r - radius);
            }
            let s = a.try_inverse()? * b;
            origin += u * s[0] + v * s[1];
            axis = (axis + u * s[2] + v * s[3]).normalize();
            radius += s[4];
            if s.norm() <= 1e-14 * radius {
                break;
            }
        }
        (radius > 0.0 && radius.is_finite()).then_some(Self::Cylinder { origin: origin + mean, axis, radius })
    }
}

/// Entries `round` that no contact knows: mortar contact has flat facets.
pub(super) fn warnings(scene: &Scene) -> Vec<String> {
    if general_contact(scene).is_some() {
        return Vec::new();
    }
    let knows = |body: &str| {
        let others = scene.contacts.iter().filter(|contact| !contact.method.integrates);
        let mut surfaces = others.flat_map(|c| c.slave.iter().chain(&c.master).chain(c.between.iter().flatten()));
        surfaces.any(|surface| split_set(surface).is_some_and(|(of, _)| of == body))
    };
    let unknown = scene.bodies.iter().filter(|body| !body.round.is_empty() && !knows(&body.name));
    unknown
        .map(|body| format!("`round` of body {} has no effect: only general contact and `nts` know it; remove it, or use one of them", body.name))
        .collect()
}

/// A point between the corners of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Place {
    /// On the side between two nodes, the smaller number first, so many pieces from the first.
    Side([u32; 2], u8),
    /// Inside of a facet: element, number in it, and number there.
    Inside(u32, u8, u8),
}

/// Facets in place of those of the mesh, by element and number in it, and the points that they need beside nodes: these with the element that they go with and their places.
pub(crate) struct Finer {
    pub facets: BTreeMap<(u32, u8), Vec<Vec<Corner>>>,
    pub points: BTreeMap<Place, (u32, Vector3)>,
}

/// A corner of a finer facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Corner {
    Node(u32),
    Point(Place),
}

/// Fits the round surfaces of a body: finer facets in place of its linear ones on them, and beside them.
pub(super) fn finer_facets(key: &str, surfaces: &[RoundSurface], mesh: &Mesh, problems: &mut Problems<'_>) -> Finer {
    let at = |node: u32| Vector3::from(mesh.nodes[node as usize]);
    let mut sides: BTreeMap<[u32; 2], Round> = BTreeMap::new();
    let mut rounds: BTreeMap<(u32, u8), Round> = BTreeMap::new();
    for (k, RoundSurface { set, surface }) in surfaces.iter().enumerate() {
        let key = format!("{key}.round[{k}].set");
        let facets = match mesh.facets_of(set) {
            Ok(facets) => facets,
            Err(error) => {
                problems.add(key, set, error.to_string(), "name a set of facets of the mesh");
                continue;
            }
        };
        if facets.iter().any(|facet| facet.nodes.kind().is_quadratic()) {
            let message = "has quadratic facets, which are curved already";
            problems.add(key, set, message, "remove the entry: it is for linear elements");
            continue;
        }
        let nodes: BTreeSet<u32> = facets.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
        let points: Vec<Vector3> = nodes.iter().map(|&node| at(node)).collect();
        let normals: Vec<Vector3> = facets.iter().map(|facet| area_vector(facet, &at)).collect();
        let fitted = match surface {
            RoundShape::Cylinder => Round::cylinder(&points, &normals),
            RoundShape::Sphere => Round::sphere(&points),
        };
        let middle = |[a, b]: [u32; 2]| (at(a) + at(b)) * 0.5;
        let arch =
            |round: &Round| facets.iter().flat_map(sides_of).map(|s| round.distance(&middle(s))).fold(0.0, f64::max);
        let off = |round: &Round| points.iter().map(|x| round.distance(x)).fold(0.0, f64::max);
        let widest = |round: &Round| {
            let steep = |s: [u32; 2]| round.distance(&middle(s)) / (at(s[0]) - at(s[1])).norm();
            facets.iter().flat_map(sides_of).map(steep).fold(0.0, f64::max)
        };
        match fitted.map(|round| (round, arch(&round), off(&round))) {
            Some((round, arch, off)) if off <= ON * arch && widest(&round) > WIDEST => {
                let message = format!("has sides that span more than 60 degrees of the {surface} that fits best");
                problems.add(
                    key,
                    set,
                    message,
                    "use at least six elements around, or remove the entry: as many points lie on many surfaces",
                );
            }
            Some((round, arch, off)) if off <= ON * arch => {
                for facet in &facets {
                    if rounds.insert((facet.element, facet.local), round).is_some() {
                        let message = format!(
                            "has facet {} of element {}, which an entry before has, too",
                            facet.local, facet.element
                        );
                        problems.add(key, set, message, "name each facet once");
                        break;
                    }
                    for side in sides_of(facet) {
                        let length = (at(side[0]) - at(side[1])).norm();
                        if round.distance(&middle(side)) > STRAIGHT * length {
                            sides.entry(side).or_insert(round);
                        }
                    }
                }
            }
            Some((_, arch, off)) => {
                let message = format!(
                    "its nodes are up to {off:.2e} off the {surface} that fits best, whose sides have arches of {arch:.2e}"
                );
                problems.add(key, set, message, "name the facets of one round surface, or remove the entry");
            }
            None => {
                let message = format!("no {surface} fits its nodes");
                problems.add(key, set, message, "name the facets of one round surface, or remove the entry");
            }
        }
    }
    finer(mesh, &sides, &rounds)
}

fn sides_of(facet: &Facet) -> impl Iterator<Item = [u32; 2]> + use<> {
    let nodes: Vec<u32> = facet.nodes.iter().copied().collect();
    let n = nodes.len();
    (0..n).map(move |k| [nodes[k], nodes[(k + 1) % n]]).map(|[a, b]| [a.min(b), a.max(b)])
}

/// Area times normal, outward.
fn area_vector(facet: &Facet, at: &impl Fn(u32) -> Vector3) -> Vector3 {
    let x: Vec<Vector3> = facet.nodes.iter().map(|&node| at(node)).collect();
    let fan = x.windows(2).skip(1).map(|pair| (pair[0] - x[0]).cross(&(pair[1] - x[0])));
    fan.sum::<Vector3>() * 0.5
}

/// Facets with sides in pieces. Quadrilaterals whose opposite sides have as many pieces are grids; others, and facets beside, are triangles about a point in the middle.
fn finer(mesh: &Mesh, sides: &BTreeMap<[u32; 2], Round>, rounds: &BTreeMap<(u32, u8), Round>) -> Finer {
    let at = |node: u32| Vector3::from(mesh.nodes[node as usize]);
    let mut finer = Finer { facets: BTreeMap::new(), points: BTreeMap::new() };
    for facet in mesh.boundary_facets() {
        let split: Vec<bool> = sides_of(&facet).map(|side| sides.contains_key(&side)).collect();
        if !split.contains(&true) || facet.nodes.kind().is_quadratic() {
            continue;
        }
        let nodes: Vec<u32> = facet.nodes.iter().copied().collect();
        let number = (facet.element, facet.local);
        let mut point = |place: Place, x: Vector3| {
            finer.points.entry(place).or_insert((facet.element, x));
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
            point(Place::Side(side, k as u8), x)
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
                        point(Place::Inside(facet.element, facet.local, (j * (PIECES + 1) + i) as u8), onto(x))
                    }
                }
            };
            (0..m)
                .flat_map(|i| (0..n).map(move |j| [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]))
                .map(|cell| cell.map(|[i, j]| corner(i, j)).to_vec())
                .collect()
        } else {
            let middle = onto(nodes.iter().map(|&node| at(node)).sum::<Vector3>() / nodes.len() as f64);
            let middle = point(Place::Inside(facet.element, facet.local, 0), middle);
            let around: Vec<Corner> = chains.concat();
            (0..around.len()).map(|k| vec![around[k], around[(k + 1) % around.len()], middle]).collect()
        };
        finer.facets.insert(number, list);
    }
    finer
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
