//! How deep a curved master sinks in between the nodes of its slave, which decides on the slave where a scene leaves it open (theory/mortar#slave).

use super::pair::area_vector;
use crate::scene::Multipliers;
use std::collections::HashMap;
use stoss_reference_element::{FacePiece, FacetNodes};

/// Edges of more than this angle, in radians, are sharp and no curvature.
const SHARP: f64 = 0.61;
/// Facets of the master count that are not farther from the slave than the nearest one and so many facets.
const NEAR: f64 = 2.0;
/// Pairs of facets beyond which all of them count.
const MANY: usize = 50_000_000;
/// Depths of less than this part of a facet are not worth a word.
const WORTH: f64 = 0.03;
/// Curvatures that cancel but for this part are those of surfaces that lie on each other.
const MOSTLY: f64 = 0.2;
/// Depths that differ by less than this part are alike.
const ALIKE: f64 = 0.05;

type Vector = [f64; 3];

fn less(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| if length > 0.0 { x / length } else { 0.0 })
}

fn place(node: u32, reference: &[f64]) -> Vector {
    std::array::from_fn(|i| reference[3 * node as usize + i])
}

fn centre(facet: &FacetNodes, reference: &[f64]) -> Vector {
    let sum = facet.iter().fold([0.0; 3], |sum, &node| {
        let x = place(node, reference);
        std::array::from_fn(|i| sum[i] + x[i])
    });
    sum.map(|x| x / facet.len() as f64)
}

/// Curvatures of a surface near another one.
#[derive(Clone, Copy, Debug, Default)]
struct Curvature {
    /// Of the roundest place, not negative, and its direction.
    round: f64,
    along: Vector,
    /// Of the most hollow place, not positive.
    hollow: f64,
}

fn curvature(facets: &[FacetNodes], other: &[FacetNodes], reference: &[f64]) -> Curvature {
    let centres: Vec<Vector> = facets.iter().map(|facet| centre(facet, reference)).collect();
    let near = near(&centres, facets, other, reference);
    let mut edges: HashMap<[u32; 2], usize> = HashMap::new();
    let mut found = Curvature::default();
    for (f, facet) in facets.iter().enumerate().filter(|(f, _)| near[*f]) {
        for k in 0..facet.len() {
            let (a, b) = (facet[k], facet[(k + 1) % facet.len()]);
            let Some(g) = edges.insert([a.min(b), a.max(b)], f) else { continue };
            let [n, m] = [f, g].map(|f| unit(area_vector(&facets[f], reference)));
            let along = less(centres[g], centres[f]);
            let distance = dot(along, along).sqrt();
            let turn = less(m, n);
            let angle = 2.0 * (0.5 * dot(turn, turn).sqrt()).min(1.0).asin();
            if angle < SHARP && distance > 0.0 {
                let value = angle.copysign(dot(turn, along)) / distance;
                found.hollow = found.hollow.min(value);
                if value > found.round {
                    (found.round, found.along) = (value, unit(along));
                }
            }
        }
    }
    found
}

/// Which facets are near another surface.
fn near(centres: &[Vector], facets: &[FacetNodes], other: &[FacetNodes], reference: &[f64]) -> Vec<bool> {
    if facets.len().saturating_mul(other.len()) > MANY {
        return vec![true; facets.len()];
    }
    let others: Vec<Vector> = other.iter().map(|facet| centre(facet, reference)).collect();
    let size = |all: &[FacetNodes]| {
        let areas = all.iter().map(|facet| area_vector(facet, reference)).map(|a| 0.5 * dot(a, a).sqrt());
        (areas.sum::<f64>() / all.len().max(1) as f64).sqrt()
    };
    let nearest =
        |x: &Vector| others.iter().map(|y| dot(less(*x, *y), less(*x, *y))).fold(f64::INFINITY, f64::min).sqrt();
    let distances: Vec<f64> = centres.iter().map(nearest).collect();
    let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let most = least + NEAR * (size(facets) + size(other));
    distances.iter().map(|distance| *distance <= most).collect()
}

/// The facets on the nodes of faces.
fn facets(pieces: &[FacePiece]) -> Vec<FacetNodes> {
    pieces.iter().map(FacePiece::facet).collect()
}

/// Whether two surfaces lie on each other as a shaft in its hole does: one is round where the other is hollow.
pub(super) fn are_curved_alike([a, b]: [&[FacePiece]; 2], reference: &[f64]) -> bool {
    let [a, b] = [a, b].map(facets);
    let [first, second] = [curvature(&a, &b, reference), curvature(&b, &a, reference)];
    let alike = |round: f64, hollow: f64| (round + hollow).abs() < MOSTLY * round;
    alike(first.round, second.hollow) || alike(second.round, first.hollow)
}

/// The largest height of the arch of an edge of a quadratic face over its chord, a length; zero of linear faces.
pub(super) fn arch(pieces: &[FacePiece], reference: &[f64]) -> f64 {
    let of = |piece: &FacePiece| {
        let (face, corners) = (piece.face(), piece.face().corners().len());
        // Middles of edges come after the corners, in the order of the edges.
        let heights = (0..face.len().saturating_sub(corners).min(corners)).map(|k| {
            let [a, b, middle] =
                [face[k], face[(k + 1) % corners], face[corners + k]].map(|node| place(node, reference));
            let height: Vector = std::array::from_fn(|i| middle[i] - 0.5 * (a[i] + b[i]));
            dot(height, height).sqrt()
        });
        heights.fold(0.0, f64::max)
    };
    pieces.iter().map(of).fold(0.0, f64::max)
}

/// Mean length of facets in their planes along a direction.
fn length(facets: &[FacetNodes], along: Vector, reference: &[f64]) -> f64 {
    let of = |facet: &FacetNodes| {
        let normal = unit(area_vector(facet, reference));
        let across = dot(along, normal);
        let along = unit(std::array::from_fn(|i| along[i] - across * normal[i]));
        let places = facet.iter().map(|&node| dot(place(node, reference), along));
        let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        high - low
    };
    facets.iter().map(of).sum::<f64>() / facets.len().max(1) as f64
}

/// A slave on its master.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sinking {
    /// `kappa h^2 / 12`: by so much the mean over a slave facet is off, a length.
    pub depth: f64,
    /// Length of slave facets along the curvature, and the radius of the master.
    pub length: f64,
    pub radius: f64,
}

impl Sinking {
    /// If a side is the slave of the other.
    pub fn of(slave: &[FacePiece], master: &[FacePiece], reference: &[f64]) -> Self {
        let [slave, master] = [slave, master].map(facets);
        let Curvature { round, along, .. } = curvature(&master, &slave, reference);
        // A slave that is hollow where the master is round lies on it.
        let curvature = (round + curvature(&slave, &master, reference).hollow).max(0.0);
        let length = length(&slave, along, reference);
        Self { depth: curvature * length * length / 12.0, length, radius: 1.0 / curvature }
    }

    /// Which of two sides is the better slave, if that makes a difference.
    pub fn better(sides: &[Self; 2]) -> Option<usize> {
        let [a, b] = sides;
        let worth = a.depth > WORTH * a.length || b.depth > WORTH * b.length;
        let differ = (a.depth - b.depth).abs() > ALIKE * a.depth.max(b.depth);
        (worth && differ).then_some(usize::from(b.depth < a.depth))
    }

    /// What is doubtful about it, as a sentence without its subject; `exchanged` is what it would be with slave and master exchanged, if that is possible.
    pub fn warning(&self, item: &crate::scene::Contact, exchanged: Option<Self>) -> Option<String> {
        let is_mortar = item.method.integrates;
        let is_dual = item.multipliers.is_some_and(|multipliers| multipliers != Multipliers::Standard);
        // Nodes alone are kept out: between them the master comes in by the whole height of its arch.
        let part: f64 = match (is_mortar, is_dual) {
            (false, _) => 1.5,
            (true, false) => 1.0,
            (true, true) => 0.5,
        };
        if part.min(1.0) * self.depth <= WORTH * self.length {
            return None;
        }
        let mut remedies = Vec::new();
        if exchanged.is_some_and(|exchanged| exchanged.depth < 0.5 * self.depth) {
            remedies.push("exchange slave and master");
        }
        remedies.push("refine the slave");
        if is_mortar && !is_dual {
            remedies.push("take `multipliers = \"dual\"`, with which it is half of it");
        }
        Some(format!(
            "slave facets of {:.3} against a radius of {:.3}: the master may sink in between them by {:.3}; {}",
            self.length,
            self.radius,
            part * self.depth,
            remedies.join(", or ")
        ))
    }
}
