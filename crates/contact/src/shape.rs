//! Shapes of two surfaces in the reference: areas, curvatures, which way they face.

use std::collections::HashMap;
use stoss_reference_element::{FacePiece, FacetNodes};

/// Edges of more than this angle, in radians, are sharp and no curvature.
const SHARP: f64 = 0.61;
/// Facets of the master count that are not farther from the slave than the nearest one and so many facets.
const NEAR: f64 = 2.0;
/// Pairs of facets beyond which all of them count.
const MANY: usize = 50_000_000;
/// Curvatures that cancel but for this part are those of surfaces that lie on each other.
const MOSTLY: f64 = 0.2;

pub(crate) type Vector = [f64; 3];

fn less(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| if length > 0.0 { x / length } else { 0.0 })
}

pub(crate) fn place(node: u32, reference: &[f64]) -> Vector {
    std::array::from_fn(|i| reference[3 * node as usize + i])
}

fn centre(facet: &FacetNodes, reference: &[f64]) -> Vector {
    let sum = facet.iter().fold([0.0; 3], |sum, &node| {
        let x = place(node, reference);
        std::array::from_fn(|i| sum[i] + x[i])
    });
    sum.map(|x| x / facet.len() as f64)
}

/// Curvatures of a surface near another one, one over a length.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Curvature {
    /// Curvature of the roundest place, not negative, and its direction.
    pub round: f64,
    pub along: Vector,
    /// Curvature of the most hollow place, not positive.
    pub hollow: f64,
}

/// Curvature between neighbours of facets that are near the other surface.
pub(crate) fn curvature(facets: &[FacetNodes], other: &[FacetNodes], reference: &[f64]) -> Curvature {
    let centres: Vec<Vector> = facets.iter().map(|facet| centre(facet, reference)).collect();
    let near = near(&centres, facets, other, reference);
    let mut edges: HashMap<[u32; 2], usize> = HashMap::new();
    let mut found = Curvature::default();
    for (f, facet) in facets.iter().enumerate().filter(|(f, _)| near[*f]) {
        for k in 0..facet.len() {
            let (a, b) = (facet[k], facet[(k + 1) % facet.len()]);
            let Some(g) = edges.insert([a.min(b), a.max(b)], f) else { continue };
            let [n, m] = [f, g].map(|f| unit(facet_area_vector(&facets[f], reference)));
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
        let areas = all.iter().map(|facet| facet_area_vector(facet, reference)).map(|a| 0.5 * dot(a, a).sqrt());
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
pub(crate) fn facets(pieces: &[FacePiece]) -> Vec<FacetNodes> {
    pieces.iter().map(FacePiece::facet).collect()
}

/// Whether two surfaces lie on each other as a shaft in its hole does: one is round where the other is hollow. `reference`: positions, `3 * nodes` lengths.
pub fn are_curved_alike([a, b]: [&[FacePiece]; 2], reference: &[f64]) -> bool {
    let [a, b] = [a, b].map(facets);
    let [first, second] = [curvature(&a, &b, reference), curvature(&b, &a, reference)];
    let alike = |round: f64, hollow: f64| (round + hollow).abs() < MOSTLY * round;
    alike(first.round, second.hollow) || alike(second.round, first.hollow)
}

/// The largest height of the arch of an edge of a quadratic face over its chord, a length; zero of linear faces. `reference`: positions, `3 * nodes` lengths.
pub fn arch(pieces: &[FacePiece], reference: &[f64]) -> f64 {
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

/// Sizes of facets that differ by less than this part are the same.
const SAME_SIZE: f64 = 0.05;

/// Which of two surfaces has the smaller facets, by their mean area; neither if they are alike. `reference`: positions, `3 * nodes` lengths.
pub fn finer_side(sides: [&[FacetNodes]; 2], reference: &[f64]) -> Option<usize> {
    let size = sides.map(|facets| {
        let areas = facets.iter().map(|facet| facet_area_vector(facet, reference));
        areas.map(|a| 0.5 * a.iter().map(|a| a * a).sum::<f64>().sqrt()).sum::<f64>() / facets.len() as f64
    });
    let differ = (size[0] - size[1]).abs() > SAME_SIZE * size[0].max(size[1]);
    differ.then_some(usize::from(size[1] < size[0]))
}

/// Twice the area vector of a facet, a length squared. `reference`: positions, `3 * nodes` lengths.
pub fn facet_area_vector(facet: &FacetNodes, reference: &[f64]) -> [f64; 3] {
    let x = facet.map(|node| -> [f64; 3] { std::array::from_fn(|i| reference[3 * node as usize + i]) });
    let diagonal = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| x[b][i] - x[a][i]) };
    // Of a triangle the second one is an edge: half of the cross product is the area all the same.
    let last = facet.len() - 1;
    let (a, b) = (diagonal(0, 2), diagonal(1, if last == 3 { 3 } else { 0 }));
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Cosine beyond a right angle from which on two facets see each other better than edge-on: 15 degrees.
const EDGE_ON: f64 = 0.25;

/// Whether a facet of the slave faces one of the master in the reference configuration, however far away. `reference`: positions, `3 * nodes` lengths.
pub fn face_each_other([slave, master]: [&[FacetNodes]; 2], reference: &[f64]) -> bool {
    let normals = |facets: &[FacetNodes]| -> Vec<[f64; 3]> {
        let normal = |facet: &FacetNodes| {
            let n = facet_area_vector(facet, reference);
            let length = n.iter().map(|n| n * n).sum::<f64>().sqrt();
            n.map(|n| if length > 0.0 { n / length } else { 0.0 })
        };
        facets.iter().map(normal).collect()
    };
    let (slave, master) = (normals(slave), normals(master));
    let sees = |n: &[f64; 3], m: &[f64; 3]| n.iter().zip(m).map(|(n, m)| n * m).sum::<f64>() < -EDGE_ON;
    slave.iter().any(|n| master.iter().any(|m| sees(n, m)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of `n` quadrilaterals of width 1 on a cylinder of the radius about y, over an angle up to 90 degrees on both sides of the top; `sign` is -1 for a hole.
    fn arc(radius: f64, n: u32, first: u32, sign: f64, reference: &mut Vec<f64>) -> Vec<FacetNodes> {
        for k in 0..=n {
            let angle = (f64::from(k) / f64::from(n) - 0.5) * 1.5;
            for y in [0.0, 1.0] {
                reference.extend([sign * radius * angle.sin(), y, radius * angle.cos()]);
            }
        }
        (0..n).map(|k| FacetNodes::from([0, 2, 3, 1].map(|i| first + 2 * k + i))).collect()
    }

    #[test]
    fn curvatures_of_a_shaft_and_its_hole() {
        let mut reference = Vec::new();
        let shaft = arc(2.0, 12, 0, 1.0, &mut reference);
        let hole = arc(2.0, 12, 26, -1.0, &mut reference);
        let of_shaft = curvature(&shaft, &hole, &reference);
        let of_hole = curvature(&hole, &shaft, &reference);
        // Chords between centres are shorter than the arc: 1/R up to the angle of a facet squared.
        assert!((of_shaft.round - 0.5).abs() < 0.01 && of_shaft.hollow == 0.0, "{of_shaft:?}");
        assert!((of_hole.hollow + 0.5).abs() < 0.01 && of_hole.round == 0.0, "{of_hole:?}");
        assert!(face_each_other([&shaft, &hole], &reference) && !face_each_other([&shaft, &shaft], &reference[..78]));
    }

    #[test]
    fn the_finer_of_two_and_areas() {
        let mut reference = Vec::new();
        let coarse = arc(1.0, 4, 0, 1.0, &mut reference);
        let fine = arc(1.0, 9, 10, 1.0, &mut reference);
        assert_eq!(finer_side([&coarse, &fine], &reference), Some(1));
        assert_eq!(finer_side([&fine, &fine], &reference), None);
        let square = FacetNodes::from([0, 1, 2, 3]);
        let triangle = FacetNodes::from([0, 1, 2]);
        let x = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 3.0, 0.0, 0.0, 3.0, 0.0];
        assert_eq!(facet_area_vector(&square, &x), [0.0, 0.0, 12.0]);
        assert_eq!(facet_area_vector(&triangle, &x), [0.0, 0.0, 6.0]);
    }
}
