//! Surfaces for the tests, and a distance that shares no code with the search.
#![allow(dead_code, missing_docs, reason = "each test binary uses a part")]

use nalgebra::Vector3;
use std::collections::HashMap;
use stoss_contact::{ContactSurface, FacetNodes, MasterSearch, SearchOptions};

pub type Facets = Vec<[u32; 4]>;

/// A sheet of `nx x ny` facets over the parameter square `[0, nx] x [0, ny]`, numbered counter-clockwise seen from where `map` puts the third axis.
pub fn sheet(nx: usize, ny: usize, map: impl Fn(f64, f64) -> [f64; 3]) -> (Facets, Vec<f64>) {
    let node = |i: usize, j: usize| (j * (nx + 1) + i) as u32;
    let q = (0..=ny).flat_map(|j| (0..=nx).map(move |i| (i, j))).flat_map(|(i, j)| map(i as f64, j as f64)).collect();
    let facets = (0..ny)
        .flat_map(|j| (0..nx).map(move |i| (i, j)))
        .map(|(i, j)| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)])
        .collect();
    (facets, q)
}

/// The boundary of a union of unit cubes `[i, i+1] x [j, j+1] x [k, k+1]`, outward numbered.
pub fn voxels(cubes: &[[i32; 3]]) -> (Facets, Vec<f64>) {
    let mut numbers: HashMap<[i32; 3], u32> = HashMap::new();
    let mut q = Vec::new();
    let mut facets = Vec::new();
    for c in cubes {
        for axis in 0..3 {
            for side in 0..2 {
                let mut other = *c;
                other[axis] += if side == 1 { 1 } else { -1 };
                if cubes.contains(&other) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let turn = if side == 1 { [(0, 0), (1, 0), (1, 1), (0, 1)] } else { [(0, 0), (0, 1), (1, 1), (1, 0)] };
                facets.push(turn.map(|(a, b)| {
                    let mut p = *c;
                    p[axis] += side;
                    p[u] += a;
                    p[v] += b;
                    *numbers.entry(p).or_insert_with(|| {
                        q.extend(p.map(f64::from));
                        (q.len() / 3 - 1) as u32
                    })
                }));
            }
        }
    }
    (facets, q)
}

pub fn block(nx: i32, ny: i32, nz: i32) -> Vec<[i32; 3]> {
    (0..nx).flat_map(|i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k]))).collect()
}

/// Signed distance to the boundary of a union of unit cubes: boxes and square plates in closed form.
pub fn voxel_distance(cubes: &[[i32; 3]], x: &Vector3<f64>) -> f64 {
    let mut distance = f64::INFINITY;
    let mut inside = false;
    for c in cubes {
        let min = Vector3::new(c[0], c[1], c[2]).map(f64::from);
        inside |= (0..3).all(|i| min[i] <= x[i] && x[i] < min[i] + 1.0);
        for axis in 0..3 {
            for side in 0..2 {
                let mut other = *c;
                other[axis] += if side == 1 { 1 } else { -1 };
                if !cubes.contains(&other) {
                    let mut low = min;
                    let mut high = min.add_scalar(1.0);
                    low[axis] = min[axis] + f64::from(side);
                    high[axis] = low[axis];
                    let nearest = Vector3::from_fn(|i, _| x[i].clamp(low[i], high[i]));
                    distance = distance.min((x - nearest).norm());
                }
            }
        }
    }
    if inside { -distance } else { distance }
}

/// Options without limits of reach and depth: the pure geometry.
pub fn unlimited() -> SearchOptions {
    SearchOptions { depth_limit: f64::INFINITY, ..SearchOptions::default() }
}

pub fn search<F: Copy + Into<FacetNodes>>(facets: &[F], q: &[f64], options: SearchOptions) -> MasterSearch {
    let surface = ContactSurface::new("master", facets, q).expect("a valid surface");
    MasterSearch::new(surface, q, options).expect("valid options")
}

/// Distance to a triangle, which is tested against exact arithmetic. A search over the parameters of a quadrilateral with a corner twice gets stuck near that
/// corner.
pub fn triangle_distance([a, b, c]: [Vector3<f64>; 3], x: &Vector3<f64>) -> f64 {
    stoss_geometry::closest(stoss_geometry::PairKind::VertexTriangle, &[*x, a, b, c]).distance_squared.sqrt()
}

/// Distance to a quadrilateral by dense sampling and a shrinking pattern search.
pub fn sampled_distance(corners: [Vector3<f64>; 4], x: &Vector3<f64>) -> f64 {
    let f = |s: f64, t: f64| {
        let p = (corners[0] * (1.0 - s) + corners[1] * s) * (1.0 - t) + (corners[3] * (1.0 - s) + corners[2] * s) * t;
        (x - p).norm()
    };
    const N: usize = 20;
    let grid = (0..=N).flat_map(|i| (0..=N).map(move |j| [i as f64 / N as f64, j as f64 / N as f64]));
    let mut samples: Vec<([f64; 2], f64)> = grid.map(|[s, t]| ([s, t], f(s, t))).collect();
    samples.sort_by(|a, b| a.1.total_cmp(&b.1));
    // More than one start: a warped patch can have two valleys of the distance.
    let mut best = f64::INFINITY;
    for &(mut at, mut value) in samples.iter().step_by(5).take(6) {
        let mut size = 1.0 / N as f64;
        while size > 1e-9 {
            let mut improved = false;
            for k in 0..8 {
                let angle = std::f64::consts::FRAC_PI_4 * f64::from(k);
                let trial = [at[0] + size * angle.cos(), at[1] + size * angle.sin()].map(|c| c.clamp(0.0, 1.0));
                let there = f(trial[0], trial[1]);
                if there < value {
                    (at, value, improved) = (trial, there, true);
                }
            }
            if !improved {
                size *= 0.5;
            }
        }
        best = best.min(value);
    }
    best
}
