//! Tangents of finite-element models with contact, as a Newton iteration meets them: deformed neo-Hooke hexahedra with inertia, and
//! three multipliers a slave node (sticking contact) that couple it with its neighbours and with the nearest nodes of the other body.

use super::{Random, pattern};
use std::sync::Arc;
use stoss_linalg::{ScatterMap, SparseMatrix};

type Point = [f64; 3];

#[derive(Default)]
struct Mesh {
    nodes: Vec<Point>,
    elements: Vec<[usize; 8]>,
    /// Young's modulus of each element.
    modulus: Vec<f64>,
}

/// Local coordinates of the nodes.
const CORNERS: [Point; 8] = [
    [-1., -1., -1.],
    [1., -1., -1.],
    [1., 1., -1.],
    [-1., 1., -1.],
    [-1., -1., 1.],
    [1., -1., 1.],
    [1., 1., 1.],
    [-1., 1., 1.],
];

impl Mesh {
    /// Hexahedra between `counts` cells of a grid whose nodes are `node(i, j, k)`; the first two directions may be closed.
    fn grid(
        &mut self,
        counts: [usize; 3],
        closed: bool,
        modulus: f64,
        point: impl Fn(usize, usize, usize) -> Point,
    ) -> usize {
        let first = self.nodes.len();
        let [a, b, c] = counts;
        let (na, nb) = if closed { (a, b) } else { (a + 1, b + 1) };
        let id = |i: usize, j: usize, k: usize| first + i % na + na * (j % nb + nb * k);
        for k in 0..=c {
            for j in 0..nb {
                self.nodes.extend((0..na).map(|i| point(i, j, k)));
            }
        }
        for k in 0..c {
            for j in 0..b {
                for i in 0..a {
                    let (p, q, r) = (i + 1, j + 1, k + 1);
                    let element =
                        [(i, j, k), (p, j, k), (p, q, k), (i, q, k), (i, j, r), (p, j, r), (p, q, r), (i, q, r)];
                    self.elements.push(element.map(|(i, j, k)| id(i, j, k)));
                    self.modulus.push(modulus);
                }
            }
        }
        first
    }
}

/// What is assembled.
#[derive(Clone, Copy)]
pub struct Setting {
    /// The columns of the multipliers and the contact stiffness differ from their rows.
    pub unsymmetric: bool,
    /// Young's modulus of the second body over that of the first.
    pub contrast: f64,
    /// Stiffness of a penalty on the constraints.
    pub penalty: f64,
    /// Density times two over the squared time step.
    pub inertia: f64,
}

impl Setting {
    /// A dynamic step, two equal bodies.
    pub fn new(unsymmetric: bool) -> Self {
        Self { unsymmetric, contrast: 1.0, penalty: 0.0, inertia: 2e3 }
    }
}

/// Two hollow tori, the second one tilted and shifted, of `around * tube * wall` hexahedra each. Slaves are the `slaves` outer
/// nodes of the second torus that are nearest to the first.
pub fn tori([around, tube, wall]: [usize; 3], slaves: usize, setting: Setting) -> (SparseMatrix, Vec<f64>) {
    let mut mesh = Mesh::default();
    let point = |i: usize, j: usize, k: usize| {
        let turn = std::f64::consts::TAU;
        let (p, q) = (turn * i as f64 / around as f64, turn * j as f64 / tube as f64);
        let r = 24.0 - 4.5 + 4.5 * k as f64 / wall as f64;
        [(76.0 + r * q.cos()) * p.cos(), (76.0 + r * q.cos()) * p.sin(), r * q.sin()]
    };
    let (s, c) = 0.6f64.sin_cos();
    let first = mesh.grid([around, tube, wall], true, 2250.0, point);
    let second = mesh.grid([around, tube, wall], true, 2250.0 * setting.contrast, |i, j, k| {
        let [x, y, z] = point(i, j, k);
        [60.0 + x, c * y - s * z, 48.0 + s * y + c * z]
    });
    let outer = |body: usize| (0..around * tube).map(move |i| body + wall * around * tube + i).collect::<Vec<_>>();
    let (masters, candidates) = (outer(first), outer(second));
    let gap = |&s: &usize| masters.iter().map(|&m| distance(&mesh, s, m)).fold(f64::INFINITY, f64::min);
    let mut sorted: Vec<(f64, usize)> = candidates.iter().map(|s| (gap(s), *s)).collect();
    sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let chosen: Vec<usize> = sorted.iter().take(slaves).map(|&(_, s)| s).collect();
    assemble(&mesh, &chosen, &candidates, &masters, setting, 100.0, 0.3)
}

/// Two blocks of `n * n * n/2` hexahedra, the second one on top and shifted sideways; its lower face is the slave.
pub fn block_pair(n: usize, setting: Setting) -> (SparseMatrix, Vec<f64>) {
    let mut mesh = Mesh::default();
    let (half, face) = (n / 2, (n + 1) * (n + 1));
    mesh.grid([n, n, half], false, 2250.0, |i, j, k| [i as f64, j as f64, k as f64]);
    let second = mesh.grid([n, n, half], false, 2250.0 * setting.contrast, |i, j, k| {
        [0.37 + i as f64, 0.37 + j as f64, (half + k) as f64]
    });
    let slaves: Vec<usize> = (0..face).map(|i| second + i).collect();
    let masters: Vec<usize> = (0..face).map(|i| half * face + i).collect();
    assemble(&mesh, &slaves, &slaves, &masters, setting, n as f64, 1.0)
}

fn distance(mesh: &Mesh, a: usize, b: usize) -> f64 {
    let (p, q) = (mesh.nodes[a], mesh.nodes[b]);
    (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt()
}

/// The `count` nodes of the list that are nearest to `node`, the nearest first.
fn nearest(mesh: &Mesh, list: &[usize], node: usize, count: usize) -> Vec<(f64, usize)> {
    let mut sorted: Vec<(f64, usize)> = list.iter().map(|&m| (distance(mesh, m, node), m)).collect();
    sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
    sorted.truncate(count);
    sorted
}

fn assemble(
    mesh: &Mesh,
    slaves: &[usize],
    slave_surface: &[usize],
    masters: &[usize],
    setting: Setting,
    length: f64,
    amplitude: f64,
) -> (SparseMatrix, Vec<f64>) {
    let mut random = Random(88_172_645_463_325_252);
    let deformed: Vec<Point> = (mesh.nodes.iter())
        .map(|p| {
            let q = p.map(|x| x / length);
            let bend = [
                0.10 * q[2] * q[2] + 0.05 * (3.0 * q[1]).sin(),
                0.08 * q[0] * q[2],
                -0.06 * q[2] + 0.03 * (2.0 * q[0]).cos(),
            ];
            [0, 1, 2].map(|i| p[i] + amplitude * (length * bend[i] + 2e-3 * random.value()))
        })
        .collect();
    let equations = |node: usize| (0..3).map(move |i| (3 * node + i) as u32);
    let displacements = 3 * mesh.nodes.len();
    let mut groups: Vec<u32> = (0..displacements as u32).map(|e| e / 3).collect();
    let mut stencils: Vec<Vec<u32>> =
        mesh.elements.iter().map(|element| element.iter().flat_map(|&a| equations(a)).collect()).collect();
    // Nodes of each contact element with their weights: the slave's side sums to 1, the master's to -1.
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    for (l, &slave) in slaves.iter().enumerate() {
        let own = nearest(mesh, slave_surface, slave, 9);
        let other = nearest(mesh, masters, slave, 12);
        let sum: f64 = other.iter().map(|(d, _)| 1.0 / (d * d + 0.1)).sum();
        let mut row: Vec<(usize, f64)> =
            own.iter().enumerate().map(|(k, &(_, a))| (a, if k == 0 { 0.5 } else { 0.5 / 8.0 })).collect();
        row.extend(other.iter().map(|&(d, a)| (a, -1.0 / (d * d + 0.1) / sum)));
        let mut stencil: Vec<u32> = row.iter().flat_map(|&(a, _)| equations(a)).collect();
        stencil.extend((0..3).map(|i| (displacements + 3 * l + i) as u32));
        groups.extend([slave as u32; 3]);
        stencils.push(stencil);
        rows.push(row);
    }
    let n = groups.len();
    let pattern = Arc::new((*pattern(n, &stencils)).clone().with_groups(groups).unwrap());
    let map = ScatterMap::new(&pattern, stencils.iter().map(Vec::as_slice)).unwrap();
    let mut matrix = SparseMatrix::zeros(pattern);
    for (e, element) in mesh.elements.iter().enumerate() {
        let (reference, present) = (element.map(|a| mesh.nodes[a]), element.map(|a| deformed[a]));
        map.add(e, &hexahedron(&reference, &present, mesh.modulus[e], setting.inertia), &mut matrix.values);
    }
    for (l, row) in rows.iter().enumerate() {
        let (count, size) = (3 * row.len(), 3 * row.len() + 3);
        let mut local = vec![0.0; size * size];
        for p in 0..count {
            let weight = |p: usize| row[p / 3].1;
            for q in 0..count {
                // Contact stiffness, and the penalty on the constraint of the component.
                if q <= p {
                    let v = 50.0 * 0.5 * random.value() / row.len() as f64;
                    let w = 50.0 * 0.5 * random.value() / row.len() as f64;
                    local[p * size + q] += v;
                    if q < p {
                        local[q * size + p] += if setting.unsymmetric { w } else { v };
                    }
                }
                if p % 3 == q % 3 {
                    local[p * size + q] += setting.penalty * weight(p) * weight(q);
                }
            }
            let multiplier = count + p % 3;
            local[multiplier * size + p] = weight(p);
            local[p * size + multiplier] =
                weight(p) * if setting.unsymmetric { 0.5 * (1.0 + 0.1 * random.value()) } else { 1.0 };
        }
        map.add(mesh.elements.len() + l, &local, &mut matrix.values);
    }
    let rhs = (0..n).map(|_| random.value()).collect();
    (matrix, rhs)
}

/// Tangent of `W = mu/2 (I_1 - 3 - 2 ln J) + lambda/2 (ln J)^2` with a mass matrix of density `inertia`, row-major.
fn hexahedron(reference: &[Point; 8], present: &[Point; 8], modulus: f64, inertia: f64) -> Vec<f64> {
    let (mu, lambda) = (modulus / 2.6, modulus * 0.3 / (1.3 * 0.4));
    let mut k = vec![0.0; 576];
    for gauss in CORNERS {
        let x = gauss.map(|x| x / 3f64.sqrt());
        let factors = CORNERS.map(|c| [0, 1, 2].map(|i| 1.0 + c[i] * x[i]));
        let shape = factors.map(|[p, q, r]| p * q * r / 8.0);
        let slope: [Point; 8] = std::array::from_fn(|a| {
            let ([p, q, r], c) = (factors[a], CORNERS[a]);
            [c[0] * q * r / 8.0, p * c[1] * r / 8.0, p * q * c[2] / 8.0]
        });
        let (inverse, volume) = invert(&gradient(reference, &slope));
        let material = slope.map(|s| push(&s, &inverse));
        let (inverse, jacobian) = invert(&gradient(present, &material));
        let spatial = material.map(|s| push(&s, &inverse));
        let geometric = mu - lambda * jacobian.ln();
        assert!(volume > 0.0 && jacobian > 0.0, "an element is inverted");
        for a in 0..8 {
            for b in 0..8 {
                let dot: f64 = (0..3).map(|i| material[a][i] * material[b][i]).sum();
                let diagonal = volume * (mu * dot + inertia * shape[a] * shape[b]);
                for i in 0..3 {
                    k[24 * (3 * a + i) + 3 * b + i] += diagonal;
                    for j in 0..3 {
                        k[24 * (3 * a + i) + 3 * b + j] += volume
                            * (geometric * spatial[a][j] * spatial[b][i] + lambda * spatial[a][i] * spatial[b][j]);
                    }
                }
            }
        }
    }
    k
}

/// `sum_a x_a (x) slope_a`.
fn gradient(x: &[Point; 8], slope: &[Point; 8]) -> [Point; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..8).map(|a| x[a][i] * slope[a][j]).sum()))
}

/// `slope^T inverse`.
fn push(slope: &Point, inverse: &[Point; 3]) -> Point {
    std::array::from_fn(|j| (0..3).map(|i| slope[i] * inverse[i][j]).sum())
}

/// Inverse and determinant.
fn invert(m: &[Point; 3]) -> ([Point; 3], f64) {
    let minor = |a: usize, b: usize, p: usize, q: usize| m[a][p] * m[b][q] - m[a][q] * m[b][p];
    let next = |i: usize| ((i + 1) % 3, (i + 2) % 3);
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(1, 2, next(j).0, next(j).1)).sum();
    let inverse = std::array::from_fn(|i| {
        std::array::from_fn(|j| minor(next(j).0, next(j).1, next(i).0, next(i).1) / determinant)
    });
    (inverse, determinant)
}
