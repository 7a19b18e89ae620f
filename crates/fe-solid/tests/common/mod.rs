//! Bodies, random configurations and dense assembly for the tests of this crate.
#![allow(dead_code, reason = "each test binary uses a part")]

use std::collections::BTreeMap;
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::{ForceRule, SolidBody, SolidError, SolidOptions, SolidStep, TangentTarget, Volumetric, Workspace};
use stoss_linalg::{ScatterMap, SparsityPattern};
use stoss_materials::{MooneyRivlin, NeoHooke, Ogden, SaintVenantKirchhoff};
use stoss_mesh::{Elements, Mesh, generate::Block};
use stoss_reference_element::{CellKind, Family, Integration};

/// A small generator (splitmix64), so that a test's state follows from one seed.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        2.0 * ((z >> 11) as f64 / (1u64 << 53) as f64) - 1.0
    }

    /// `x + amplitude * (-1..1)` in each component.
    pub fn perturbed(&mut self, x: &[f64], amplitude: f64) -> Vec<f64> {
        x.iter().map(|x| x + amplitude * self.next()).collect()
    }

    /// A rotation matrix (from a random unit quaternion).
    pub fn rotation(&mut self) -> [[f64; 3]; 3] {
        let q = [self.next(), self.next(), self.next(), self.next() + 1.5];
        let n = q.iter().map(|a| a * a).sum::<f64>().sqrt();
        let [x, y, z, w] = q.map(|a| a / n);
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    }
}

/// A block of unit elements whose nodes are moved at random.
pub fn distorted_block(divisions: [usize; 3], amplitude: f64, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut mesh = Block::new([0.0; 3], divisions.map(|n| n as f64), divisions).generate().unwrap();
    for x in &mut mesh.nodes {
        for x in x {
            *x += amplitude * random.next();
        }
    }
    mesh
}

pub fn positions(mesh: &Mesh) -> Vec<f64> {
    mesh.nodes.iter().flatten().copied().collect()
}

pub fn map_positions(q: &[f64], map: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    q.chunks_exact(3).flat_map(|x| map([x[0], x[1], x[2]])).collect()
}

pub fn body(mesh: &Mesh, law: &Arc<dyn HyperelasticLaw>) -> SolidBody {
    SolidBody::new("body", mesh, 0, law.clone()).unwrap()
}

pub fn force(body: &SolidBody, step: SolidStep<'_>) -> Result<Vec<f64>, SolidError> {
    let mut force = vec![0.0; step.q_np1.len()];
    body.assemble(step, 1.0, &mut force, None, &mut Workspace::default())?;
    Ok(force)
}

/// Pattern and scatter map of a body all of whose components are unknowns.
pub fn pattern(body: &SolidBody, unknowns: usize) -> (SparsityPattern, ScatterMap) {
    let stencils: Vec<Vec<u32>> =
        body.stencils().map(|nodes| nodes.iter().flat_map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect()).collect();
    let iter = || stencils.iter().map(Vec::as_slice);
    let pattern = SparsityPattern::from_stencils(unknowns, iter()).unwrap();
    let map = ScatterMap::new(&pattern, iter()).unwrap();
    (pattern, map)
}

/// Force, and tangent as rows.
pub fn force_and_tangent(body: &SolidBody, step: SolidStep<'_>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = step.q_np1.len();
    let (pattern, map) = pattern(body, n);
    let mut values = vec![0.0; pattern.nnz()];
    let mut force = vec![0.0; n];
    let target = TangentTarget { map: &map, first_stencil: 0, factor: 1.0, values: &mut values };
    body.assemble(step, 1.0, &mut force, Some(target), &mut Workspace::default()).unwrap();
    (force, dense(&pattern, &values))
}

pub fn dense(pattern: &SparsityPattern, values: &[f64]) -> Vec<Vec<f64>> {
    let mut rows = vec![vec![0.0; pattern.n()]; pattern.n()];
    for column in 0..pattern.n() {
        for (row, k) in pattern.column(column).iter().zip(pattern.column_range(column)) {
            rows[*row as usize][column] = values[k];
        }
    }
    rows
}

pub fn max_abs(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `sum_I f_I` and `sum_I x_I x f_I`.
pub fn resultant_and_moment(x: &[f64], f: &[f64]) -> ([f64; 3], [f64; 3]) {
    let (mut sum, mut moment) = ([0.0; 3], [0.0; 3]);
    for (x, f) in x.chunks_exact(3).zip(f.chunks_exact(3)) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            sum[i] += f[i];
            moment[i] += x[j] * f[k] - x[k] * f[j];
        }
    }
    (sum, moment)
}

/// Fourth-order central difference of a vector function along component `j`.
pub fn derivative(x: &[f64], j: usize, h: f64, f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let at = |t: f64| {
        let mut x = x.to_vec();
        x[j] += t;
        f(&x)
    };
    let (a, b, c, d) = (at(h), at(-h), at(2.0 * h), at(-2.0 * h));
    (0..a.len()).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h)).collect()
}

/// The four laws at parameters of the literature's order of magnitude.
pub fn laws() -> Vec<Arc<dyn HyperelasticLaw>> {
    vec![
        Arc::new(SaintVenantKirchhoff::new(1298.0769, 865.3846).unwrap()),
        Arc::new(NeoHooke::new(1298.0769, 865.3846).unwrap()),
        Arc::new(MooneyRivlin::new(176051.0, 4332.63, 2.0e6).unwrap()),
        Arc::new(Ogden::new(&[6300.0, 12.0, -100.0], &[1.3, 5.0, -2.0], 2000.0, 9.0).unwrap()),
    ]
}

/// How the cells of a family fill a cube: corners as numbers whose bits are the coordinates.
fn in_a_cube(family: Family) -> &'static [&'static [usize]] {
    match family {
        Family::Hexahedron => &[&[0, 1, 3, 2, 4, 5, 7, 6]],
        Family::Wedge => &[&[0, 1, 3, 4, 5, 7], &[0, 3, 2, 4, 7, 6]],
        Family::Tetrahedron => {
            &[&[0, 1, 3, 7], &[0, 3, 2, 7], &[0, 2, 6, 7], &[0, 6, 4, 7], &[0, 4, 5, 7], &[0, 5, 1, 7]]
        }
    }
}

/// A block of unit cubes filled with cells of these kinds in turn. Corners are moved at random by up to `straight` (edges stay straight), then all nodes by
/// up to `curved`.
pub fn cells(kinds: &[CellKind], divisions: [usize; 3], straight: f64, curved: f64, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut shifts: BTreeMap<[i64; 3], [f64; 3]> = BTreeMap::new();
    let mut numbers: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let (mut nodes, mut elements) = (Vec::new(), Elements::new());
    let cubes = divisions.iter().product::<usize>();
    for cube in 0..cubes {
        let at = [cube % divisions[0], cube / divisions[0] % divisions[1], cube / divisions[0] / divisions[1]];
        let kind = kinds[cube % kinds.len()];
        let (table, linear) = (kind.table(), kind.table().linear.table());
        for corners in in_a_cube(table.family) {
            let corners: Vec<[f64; 3]> =
                corners.iter().map(|bits| std::array::from_fn(|i| (at[i] + (bits >> i & 1)) as f64)).collect();
            let mut shift = |x: &[f64; 3]| {
                *shifts.entry(x.map(|x| x as i64)).or_insert_with(|| std::array::from_fn(|_| straight * random.next()))
            };
            let moved: Vec<[f64; 3]> = corners
                .iter()
                .map(|x| {
                    let s = shift(x);
                    std::array::from_fn(|i| x[i] + s[i])
                })
                .collect();
            let element: Vec<u32> = table
                .nodes
                .iter()
                .map(|&xi| {
                    let shape = (linear.shape)(xi);
                    let place = |corners: &[[f64; 3]]| -> [f64; 3] {
                        std::array::from_fn(|i| corners.iter().zip(shape).map(|(x, n)| n * x[i]).sum())
                    };
                    let key = place(&corners).map(|x| (2.0 * x).round() as i64);
                    *numbers.entry(key).or_insert_with(|| {
                        nodes.push(place(&moved).map(|x| x + curved * random.next()));
                        nodes.len() as u32 - 1
                    })
                })
                .collect();
            elements.push(kind, &element);
        }
    }
    Mesh::new(nodes, elements).unwrap()
}

pub fn body_with(mesh: &Mesh, law: &Arc<dyn HyperelasticLaw>, integration: Integration) -> SolidBody {
    let options = SolidOptions { integration, volumetric: Volumetric::Displacement };
    SolidBody::with_options("body", mesh, 0, law.clone(), options).unwrap()
}

/// A body with averages of the change of volume.
pub fn mixed_body(mesh: &Mesh, law: &Arc<dyn HyperelasticLaw>, integration: Integration) -> SolidBody {
    let options = SolidOptions { integration, volumetric: Volumetric::Mixed };
    SolidBody::with_options("body", mesh, 0, law.clone(), options).unwrap()
}

/// Laws of unit shear modulus with this ratio of bulk to shear modulus, about.
pub fn stiff_laws(ratio: f64) -> Vec<Arc<dyn HyperelasticLaw>> {
    vec![
        Arc::new(NeoHooke::new(ratio, 1.0).unwrap()),
        Arc::new(MooneyRivlin::new(0.4, 0.1, 0.5 * ratio).unwrap()),
        Arc::new(Ogden::new(&[0.63, 0.0012, -0.01], &[1.3, 5.0, -2.0], ratio, 9.0).unwrap()),
    ]
}

/// Solves a dense system by elimination with pivoting.
pub fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        let (above, below) = a.split_at_mut(k + 1);
        let row = &above[k][k..];
        for (i, other) in below.iter_mut().enumerate() {
            let l = other[k] / row[0];
            if l != 0.0 {
                other[k..].iter_mut().zip(row).for_each(|(x, r)| *x -= l * r);
                b[k + 1 + i] -= l * b[k];
            }
        }
    }
    for k in (0..n).rev() {
        b[k] = (b[k] - dot(&a[k][k + 1..], &b[k + 1..])) / a[k][k];
    }
    b
}

/// Forces with and without a tangent are the same, the tangent is the difference of the force, and but for the conserving step it is symmetric up to `symmetric` of its size.
pub fn check_tangents(body: &mut SolidBody, q_n: &[f64], q_np1: &[f64], symmetric: f64, place: &str) {
    for rule in [ForceRule::Configuration { theta: 0.3 }, ForceRule::END_POINT, ForceRule::DiscreteGradient] {
        body.begin_step(q_n, rule, 1.0).unwrap();
        let at = |q: &[f64]| force(body, SolidStep { q_n, q_np1: q, rule }).unwrap();
        let (with_tangent, tangent) = force_and_tangent(body, SolidStep { q_n, q_np1, rule });
        let alone = at(q_np1);
        assert!(with_tangent.iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-13 * max_abs(&alone)));
        let scale = tangent.iter().map(|row| max_abs(row)).fold(0.0, f64::max);
        for j in (0..q_np1.len()).step_by(2) {
            let column = derivative(q_np1, j, 2e-4, at);
            for i in 0..q_np1.len() {
                let difference = (tangent[i][j] - column[i]).abs();
                assert!(difference < 1e-8 * scale, "{place} {rule:?} ({i},{j}): {difference:e} of {scale:e}");
                if rule != ForceRule::DiscreteGradient {
                    assert!((tangent[i][j] - tangent[j][i]).abs() < symmetric * scale, "{place} {rule:?} ({i},{j})");
                }
            }
        }
    }
}
