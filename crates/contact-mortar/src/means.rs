//! The pressure that is shown at a slave node of quadratic faces: the mean of the tractions with the linear function of the face's corner (theory/mortar#shown).

use crate::local::FacetMatrix;
use crate::rows::Row;
use crate::state::Surfaces;
use std::collections::BTreeMap;
use stoss_reference_element::{FacePiece, MAX_NODES};

/// A point of a face is a corner if its linear function is this at least.
const AT_CORNER: f64 = 1.0 - 1e-12;
/// A mean over less than this part of the reference area of a row is none.
const SMALLEST: f64 = 1e-8;

type Means = Vec<(u32, f64)>;

/// The linear functions of the corners of the face at a corner of its piece.
fn linear(piece: &FacePiece, corner: usize) -> [f64; MAX_NODES] {
    piece.face().kind().linear().shape(piece.corners()[corner])
}

/// Adds the weights of rows to a mean.
fn add(to: &mut Means, row: u32, weight: f64) {
    match to.iter_mut().find(|(other, _)| *other == row) {
        Some((_, sum)) => *sum += weight,
        None => to.push((row, weight)),
    }
}

/// Rows and weights of the pressure to be shown for each row, empty where it is that of the row. `moments`: of each slave facet against each smooth part of the master `int phi_A N_J dA`.
pub(crate) fn means(surfaces: &Surfaces, moments: &[Option<FacetMatrix>]) -> Vec<Means> {
    let Surfaces { rows, faces, smooth_part_count: parts, .. } = surfaces;
    let pieces = faces[0].pieces();
    if moments.is_empty() {
        return Vec::new();
    }
    let mut of_corners = vec![[u32::MAX; MAX_NODES]; moments.len()];
    for (k, row) in rows.iter().enumerate() {
        row.facets.iter().for_each(|&(f, a)| of_corners[f as usize * parts + row.smooth_part][a] = k as u32);
    }
    let mut siblings: BTreeMap<&[u32], Vec<usize>> = BTreeMap::new();
    for (f, piece) in pieces.iter().enumerate() {
        siblings.entry(piece.face_nodes()).or_default().push(f);
    }
    let of_face = |f: u32| &siblings[pieces[f as usize].face_nodes()];
    // Means at corners of faces.
    let at_corner = |row: &Row| -> Means {
        let (mut sums, mut area) = (Means::new(), 0.0);
        for &(f, a) in &row.facets {
            let here = linear(&pieces[f as usize], a);
            let Some(corner) = here.iter().position(|h| *h > AT_CORNER) else { return Means::new() };
            for &s in of_face(f) {
                let place = s * parts + row.smooth_part;
                let Some(of_facet) = &moments[place] else { continue };
                let count = pieces[s].corners().len();
                for j in 0..count {
                    let h = linear(&pieces[s], j)[corner];
                    for i in 0..count {
                        let weight = h * of_facet[i][j];
                        area += weight;
                        if weight != 0.0 {
                            add(&mut sums, of_corners[place][i], weight);
                        }
                    }
                }
            }
        }
        if area <= SMALLEST * row.area {
            return Means::new();
        }
        sums.iter_mut().for_each(|(_, weight)| *weight /= area);
        sums
    };
    let corners: Vec<Means> = rows.iter().map(at_corner).collect();
    let between = |(k, row): (usize, &Row)| -> Means {
        let is_quadratic = |f: u32| pieces[f as usize].face().kind().is_quadratic();
        if !row.facets.iter().any(|&(f, _)| is_quadratic(f)) {
            return Means::new();
        }
        if !corners[k].is_empty() {
            return corners[k].clone();
        }
        let (mut sums, mut total) = (Means::new(), 0.0);
        for &(f, a) in &row.facets {
            let here = linear(&pieces[f as usize], a);
            for &s in of_face(f) {
                for j in 0..pieces[s].corners().len() {
                    let there = linear(&pieces[s], j);
                    let Some(corner) = there.iter().position(|h| *h > AT_CORNER) else { continue };
                    let of = of_corners[s * parts + row.smooth_part][j];
                    let Some(mean) = corners.get(of as usize).filter(|mean| !mean.is_empty()) else { continue };
                    mean.iter().for_each(|&(row, weight)| add(&mut sums, row, here[corner] * weight));
                    total += here[corner];
                }
            }
        }
        if total <= 0.0 {
            return Means::new();
        }
        sums.iter_mut().for_each(|(_, weight)| *weight /= total);
        sums
    };
    rows.iter().enumerate().map(between).collect()
}
