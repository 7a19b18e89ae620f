//! The frame of a slave node, and the components of its gap vector along it.
//!
//! Everything is a function of nine numbers `z = (b_1, b_2, g)` that are linear in the positions:
//! `Phi_1 = b_1 . g`, `Phi_2 = b_2 . g`, `Phi_3 = (b_1 x b_2) . g`.

use super::rows::ConstraintRow;
use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};
use stoss_contact::{ContactSurface, position};
use stoss_term::GradientRule;

type Vector9 = SVector<f64, 9>;
type Matrix9 = SMatrix<f64, 9, 9>;

/// The nine numbers `z` at one configuration: `b_1`, `b_2` (no unit, about unit length in the reference), `g` [volume].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrameAndGap {
    pub b: [Vector3<f64>; 2],
    pub g: Vector3<f64>,
}

/// Coefficients of the nine numbers.
#[derive(Clone, Debug)]
pub(super) struct NodeFrame {
    /// Node, coefficients in `b_1`, `b_2`, and in each component of `g`. The slave node first.
    pub entries: Vec<(u32, [f64; 2], [f64; 3])>,
}

/// The three constraints: values, gradients of the rule, and the derivative of `sum lambda_a gradient_a`.
pub(super) struct Response {
    /// Values at the end of the step.
    pub values: [f64; 3],
    /// Gradients at the end of the step.
    pub end: [Vector9; 3],
    /// Gradients of the rule.
    pub rule: [Vector9; 3],
    /// Derivative with respect to the nine numbers `z` at the end of the step; not symmetric for the energy-momentum rule.
    pub derivative: Matrix9,
}

impl NodeFrame {
    /// Frame of local node `local` of the slave at reference positions `q`. `T_1`, `T_2` are orthonormal and normal
    /// to the node's normal; `b_a` is the mean over the facets around of `F T_a`, `F` the facet's surface gradient
    /// there.
    pub fn new(slave: &ContactSurface, local: usize, row: &ConstraintRow, q: &[f64]) -> Self {
        let mut entries: Vec<(u32, [f64; 2], [f64; 3])> =
            row.entries.iter().map(|e| (e.node, [0.0; 2], e.coefficients)).collect();
        let normal = slave.node_normal(local, q);
        let axis = Vector3::ith(normal.iamin(), 1.0);
        let t1 = (axis - normal * normal.dot(&axis)).normalize();
        let directions = [t1, normal.cross(&t1)];
        let facets = slave.facets_around(local);
        for &facet in facets {
            let nodes = slave.facets()[facet as usize];
            let corners = slave.patch(facet, q).corners;
            let locals = slave.local_facets()[facet as usize];
            let Some(corner) = locals.iter().position(|&n| n as usize == local) else { continue };
            let kind = corners.kind();
            let gradient = kind.shape_gradient(kind.vertices()[corner]);
            let tangents: [Vector3<f64>; 2] =
                std::array::from_fn(|a| corners.iter().zip(gradient).map(|(x, g)| x * g[a]).sum());
            let metric = Matrix2::from_fn(|a, b| tangents[a].dot(&tangents[b]));
            // The surface was checked: tangents at its corners are independent.
            let inverse = metric.try_inverse().unwrap_or_else(Matrix2::zeros) / facets.len() as f64;
            for (a, direction) in directions.iter().enumerate() {
                let c = inverse * Vector2::new(tangents[0].dot(direction), tangents[1].dot(direction));
                for j in 0..nodes.len() {
                    let beta = c[0] * gradient[j][0] + c[1] * gradient[j][1];
                    match entries.iter_mut().find(|e| e.0 == nodes[j]) {
                        Some(entry) => entry.1[a] += beta,
                        None => {
                            let mut coefficients = [0.0; 2];
                            coefficients[a] = beta;
                            entries.push((nodes[j], coefficients, [0.0; 3]));
                        }
                    }
                }
            }
        }
        Self { entries }
    }

    /// The nine numbers at positions `q`.
    pub fn at(&self, q: &[f64]) -> FrameAndGap {
        let mut z = FrameAndGap { b: [Vector3::zeros(); 2], g: Vector3::zeros() };
        for (node, beta, gamma) in &self.entries {
            let x = position(q, *node);
            z.b[0] += x * beta[0];
            z.b[1] += x * beta[1];
            z.g += x.component_mul(&Vector3::from(*gamma));
        }
        z
    }

    /// `Phi` [volume].
    pub fn values(&self, z: &FrameAndGap) -> [f64; 3] {
        values(z)
    }
}

fn values(z: &FrameAndGap) -> [f64; 3] {
    [z.b[0].dot(&z.g), z.b[1].dot(&z.g), z.b[0].cross(&z.b[1]).dot(&z.g)]
}

fn stack(b1: Vector3<f64>, b2: Vector3<f64>, g: Vector3<f64>) -> Vector9 {
    let mut v = Vector9::zeros();
    v.fixed_rows_mut::<3>(0).copy_from(&b1);
    v.fixed_rows_mut::<3>(3).copy_from(&b2);
    v.fixed_rows_mut::<3>(6).copy_from(&g);
    v
}

fn gradients(z: &FrameAndGap) -> [Vector9; 3] {
    let (o, [b1, b2], g) = (Vector3::zeros(), z.b, z.g);
    [stack(g, o, b1), stack(o, g, b2), stack(b2.cross(&g), g.cross(&b1), b1.cross(&b2))]
}

/// Adds `factor sum_a lambda_a Hessian_a`, of the third constraint at `z` and only if `third`.
fn add_hessians(z: &FrameAndGap, lambda: &[f64], factor: f64, third: bool, h: &mut Matrix9) {
    for i in 0..3 {
        for a in 0..2 {
            h[(3 * a + i, 6 + i)] += factor * lambda[a];
            h[(6 + i, 3 * a + i)] += factor * lambda[a];
        }
    }
    if third {
        // d(b2 x g) = -g x db2 + b2 x dg, and cyclic.
        let vectors = [z.b[0], z.b[1], z.g];
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let w = factor * lambda[2];
            let by_j = -vectors[k].cross_matrix() * w;
            let by_k = vectors[j].cross_matrix() * w;
            let mut block = h.fixed_view_mut::<3, 3>(3 * i, 3 * j);
            block += by_j;
            let mut block = h.fixed_view_mut::<3, 3>(3 * i, 3 * k);
            block += by_k;
        }
    }
}

fn between(z0: &FrameAndGap, z1: &FrameAndGap, theta: f64) -> FrameAndGap {
    let mix = |a: Vector3<f64>, b: Vector3<f64>| a * (1.0 - theta) + b * theta;
    FrameAndGap { b: [mix(z0.b[0], z1.b[0]), mix(z0.b[1], z1.b[1])], g: mix(z0.g, z1.g) }
}

/// Values and gradients for a step from `z0` to `z1`; `None` if the frame of the energy-momentum rule degenerates (a
/// rotation by half a turn in the step).
pub(super) fn response(
    z0: &FrameAndGap,
    z1: &FrameAndGap,
    lambda: &[f64],
    rule: GradientRule,
    tangent: bool,
) -> Option<Response> {
    let end = gradients(z1);
    let mut out = Response { values: values(z1), end, rule: end, derivative: Matrix9::zeros() };
    let h = &mut out.derivative;
    let at = match rule {
        GradientRule::StartPoint => 0.0,
        GradientRule::EndPoint => 1.0,
        GradientRule::EndPointMean | GradientRule::Midpoint | GradientRule::DiscreteGradient => 0.5,
    };
    let z = between(z0, z1, at);
    out.rule = gradients(&z);
    match rule {
        GradientRule::EndPointMean => {
            out.rule[2] = (gradients(z0)[2] + end[2]) * 0.5;
            if tangent {
                add_hessians(z1, lambda, 0.5, true, h);
            }
        }
        GradientRule::DiscreteGradient => {
            let director = Director::new(z0, z1, &z)?;
            out.rule[2] = director.gradient();
            if tangent {
                add_hessians(&z, lambda, 0.5, false, h);
                for k in 0..9 {
                    let column = director.derivative(z1, k) * lambda[2];
                    let mut target = h.column_mut(k);
                    target += column;
                }
            }
        }
        _ if tangent && at > 0.0 => add_hessians(&z, lambda, at, true, h),
        _ => {}
    }
    Some(out)
}

/// Discrete gradient of `Phi_3` (theory/mortar#eq-director): the director `d = b_1 x b_2` counts as a vector
/// of its own with the constraints `d . b_1 = d . b_2 = 0` and `(d . d - (b_1 . b_1) (b_2 . b_2) + (b_1 . b_2)^2) /
/// 2 = 0`, all of them at most quadratic in scalar products; `d` and their multipliers `mu` are eliminated.
struct Director {
    b: [Vector3<f64>; 2],
    d: Vector3<f64>,
    /// Means over both ends of `b_1 . b_1`, `b_2 . b_2`, `b_1 . b_2`.
    m: [f64; 3],
    inverse: Matrix3<f64>,
    mu: Vector3<f64>,
}

impl Director {
    fn new(z0: &FrameAndGap, z1: &FrameAndGap, mid: &FrameAndGap) -> Option<Self> {
        let d = (z0.b[0].cross(&z0.b[1]) + z1.b[0].cross(&z1.b[1])) * 0.5;
        let mean = |i: usize, j: usize| 0.5 * (z0.b[i].dot(&z0.b[j]) + z1.b[i].dot(&z1.b[j]));
        let b = mid.b;
        let m = [mean(0, 0), mean(1, 1), mean(0, 1)];
        // The force on the director vanishes: g + mu_1 b_1 + mu_2 b_2 + mu_3 d = 0.
        let basis = Matrix3::from_columns(&[b[0], b[1], d]);
        if basis.determinant().abs() <= 1e-8 * m[0] * m[1] {
            return None;
        }
        let inverse = basis.try_inverse()?;
        Some(Self { b, d, m, inverse, mu: -(inverse * mid.g) })
    }

    fn gradient(&self) -> Vector9 {
        let ([b1, b2], d, mu, m) = (self.b, self.d, self.mu, self.m);
        stack(d * mu[0] + (b2 * m[2] - b1 * m[1]) * mu[2], d * mu[1] + (b1 * m[2] - b2 * m[0]) * mu[2], d)
    }

    /// Derivative with respect to component `k` of the nine numbers at the end.
    fn derivative(&self, z1: &FrameAndGap, k: usize) -> Vector9 {
        let unit = Vector3::ith(k % 3, 1.0);
        let zero = Vector3::zeros();
        let db = [if k / 3 == 0 { unit } else { zero }, if k / 3 == 1 { unit } else { zero }];
        let dg = if k / 3 == 2 { unit * 0.5 } else { zero };
        let dd = (db[0].cross(&z1.b[1]) + z1.b[0].cross(&db[1])) * 0.5;
        let dm = [z1.b[0].dot(&db[0]), z1.b[1].dot(&db[1]), 0.5 * (z1.b[0].dot(&db[1]) + z1.b[1].dot(&db[0]))];
        let db = db.map(|v| v * 0.5);
        let ([b1, b2], d, mu, m) = (self.b, self.d, self.mu, self.m);
        let dmu = -(self.inverse * (dg + db[0] * mu[0] + db[1] * mu[1] + dd * mu[2]));
        stack(
            dd * mu[0]
                + d * dmu[0]
                + (b2 * m[2] - b1 * m[1]) * dmu[2]
                + (db[1] * m[2] + b2 * dm[2] - db[0] * m[1] - b1 * dm[1]) * mu[2],
            dd * mu[1]
                + d * dmu[1]
                + (b1 * m[2] - b2 * m[0]) * dmu[2]
                + (db[0] * m[2] + b1 * dm[2] - db[1] * m[0] - b2 * dm[0]) * mu[2],
            dd,
        )
    }
}
