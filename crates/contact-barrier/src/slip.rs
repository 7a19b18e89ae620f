//! Friction of a pair: the slip of a step without its spin, and forces that keep both momenta.

use crate::Tangent;
use crate::sensitivity::Sensitivity;
use nalgebra::{Matrix3, Vector3};
use stoss_geometry::{PairKind, combine};

/// Coulomb's law, smooth around zero slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Coefficient of friction, not negative.
    pub coefficient: f64,
    /// Slip in a step, a positive length, from which on all of the friction acts: a small velocity times the size of the step.
    pub slip_scale: f64,
}

/// Friction of a pair in a step; `docs/theory/barrier.md` (17), (18).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionForce {
    /// To be added to a residual; the force on point `i` is `-gradient[i]`.
    pub gradient: [Vector3<f64>; 4],
    /// Energy that friction takes in the step, `sum gradient_i . dx_i >= 0`.
    pub dissipated: f64,
    /// Length of the slip in the step.
    pub slip: f64,
    /// Length of the normal force that the law sees: without the part from the gradient of the factor of nearly parallel edges.
    pub normal_force: f64,
    /// Length of the tangential force, at most the coefficient times the normal force.
    pub tangential_force: f64,
}

impl FrictionForce {
    /// No friction.
    pub(crate) const NONE: Self = Self {
        gradient: [Vector3::new(0.0, 0.0, 0.0); 4],
        dissipated: 0.0,
        slip: 0.0,
        normal_force: 0.0,
        tangential_force: 0.0,
    };
}

/// Squared sine of two edges below which their friction fades.
const FADE_EDGES: f64 = 1e-2;

/// Squared double area of a triangle, over the square of the sum of its squared edges, below which its friction fades: heights below a fiftieth of the edges.
const FADE_TRIANGLE: f64 = 1e-4;

/// A pair that is pressed together, with what friction needs of it.
pub(crate) struct Pressed {
    pub kind: PairKind,
    /// Normal force on the first primitive.
    pub normal: Vector3<f64>,
    /// Weights of the points between which it acts.
    pub weights: [f64; 4],
    /// Positions at which forces have no moment.
    pub x: [Vector3<f64>; 4],
    /// Motion in the step.
    pub dx: [Vector3<f64>; 4],
}

/// How all of this changes with the positions at the end.
pub(crate) struct Variation<'a> {
    pub along: &'a Sensitivity,
    /// Derivative of the weights by those of the end, and of the positions by those of the end.
    pub share: f64,
    /// `dN/dx_j`.
    pub normal: [Matrix3<f64>; 4],
}

impl Pressed {
    /// The friction, and its tangent *added* to one that is there.
    pub fn friction(&self, law: &Friction, tangent: Option<(&Variation, &mut Tangent)>) -> FrictionForce {
        let (c, dx) = (&self.weights, &self.dx);
        let normal_force = self.normal.norm();
        let Some(spin) = Spin::new(self.kind, &self.x, dx) else { return FrictionForce::NONE };
        if normal_force == 0.0 || law.coefficient == 0.0 {
            return FrictionForce::NONE;
        }
        let n = self.normal / normal_force;
        let r = combine(c, &self.x);
        let moved = combine(c, dx);
        let omega = spin.total * spin.scale;
        let relative = moved * spin.fade - omega.cross(&r);
        let along_normal = n.dot(&relative);
        let slip = relative - n * along_normal;
        let length = slip.norm();
        let sticks = length < law.slip_scale;
        let per_slip =
            if sticks { (2.0 - length / law.slip_scale) / law.slip_scale } else { 1.0 / length } * law.coefficient;
        let t = slip * (per_slip * normal_force);
        let k = r.cross(&t);
        let on_edges = spin.couple(&k);
        let mut gradient = c.map(|c| t * (spin.fade * c));
        for (e, &[tail, head]) in spin.edges.iter().enumerate() {
            gradient[tail] += on_edges[e] * spin.scale;
            gradient[head] -= on_edges[e] * spin.scale;
        }
        if let Some((variation, tangent)) = tangent {
            let Variation { along, share, normal } = variation;
            let per_slip_slope = if sticks {
                // Of the slip's length, over that length; its product with the slip is zero at zero.
                if length > 0.0 { -law.coefficient / (law.slip_scale * law.slip_scale * length) } else { 0.0 }
            } else {
                -per_slip / (length * length)
            };
            for j in 0..4 {
                for l in 0..3 {
                    let axis = Vector3::ith(l, 1.0);
                    let dc: [f64; 4] = std::array::from_fn(|i| {
                        (0..along.count).map(|a| along.directions[a][i] * along.moves[a][j][l] * share).sum()
                    });
                    let dr = combine(&dc, &self.x) + axis * (share * c[j]);
                    let d_moved = combine(&dc, dx) + axis * c[j];
                    let change = spin.change(j, l, *share);
                    let d_omega = change.total * spin.scale + spin.total * change.scale;
                    let d_relative = d_moved * spin.fade + moved * change.fade - d_omega.cross(&r) - omega.cross(&dr);
                    let d_normal: Vector3<f64> = normal[j].column(l).into();
                    let d_normal_force = n.dot(&d_normal);
                    let dn = (d_normal - n * d_normal_force) / normal_force;
                    let d_slip = d_relative - n * (n.dot(&d_relative) + dn.dot(&relative)) - dn * along_normal;
                    let d_per_slip = per_slip_slope * slip.dot(&d_slip);
                    let dt = d_slip * (per_slip * normal_force)
                        + slip * (d_per_slip * normal_force + per_slip * d_normal_force);
                    let dk = dr.cross(&t) + r.cross(&dt);
                    let d_on_edges = spin.couple_change(&change, &k, &dk);
                    let mut column: [Vector3<f64>; 4] =
                        std::array::from_fn(|i| t * (change.fade * c[i] + spin.fade * dc[i]) + dt * (spin.fade * c[i]));
                    for (e, &[tail, head]) in spin.edges.iter().enumerate() {
                        let d = d_on_edges[e] * spin.scale + on_edges[e] * change.scale;
                        column[tail] += d;
                        column[head] -= d;
                    }
                    for i in 0..4 {
                        for m in 0..3 {
                            tangent[3 * i + m][3 * j + l] += column[i][m];
                        }
                    }
                }
            }
        }
        FrictionForce {
            gradient,
            dissipated: t.dot(&slip),
            slip: length,
            normal_force,
            tangential_force: spin.fade * per_slip * normal_force * length,
        }
    }
}

/// Spin of the primitives' own edges in a step, and, the other way round, forces on these edges with a given moment; `docs/theory/barrier.md` (15), (16).
struct Spin {
    /// Tails and heads.
    edges: &'static [[usize; 2]],
    /// Edges `v_e` and their change in the step.
    v: [Vector3<f64>; 3],
    dv: [Vector3<f64>; 3],
    /// `v_0 x v_1`: across both edges, or across the triangle.
    p: Vector3<f64>,
    /// `w_e`, in the plane of the edges.
    w: [Vector3<f64>; 3],
    /// `sum |v_e|^2`.
    lengths: f64,
    /// `sum v_e x dv_e`.
    moment: Vector3<f64>,
    /// `chi |p|^2` of the spin: `spin.scale` times this is `chi omega`.
    total: Vector3<f64>,
    /// `chi`, `chi / |p|^2`, and the `|p|^2` below which they fade.
    fade: f64,
    scale: f64,
    threshold: f64,
}

/// Derivatives of a [`Spin`] by one coordinate.
struct SpinChange {
    v: [Vector3<f64>; 3],
    p: Vector3<f64>,
    w: [Vector3<f64>; 3],
    lengths: f64,
    total: Vector3<f64>,
    fade: f64,
    scale: f64,
}

/// In the plane: the forces `p (w_e . k)` on edges have the moment `|p|^2 k` for any `k` in that plane.
fn levers(count: usize, v: &[Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    if count == 2 {
        [-v[1], v[0], Vector3::zeros()]
    } else {
        [(v[2] - v[1]) / 3.0, (v[0] - v[2]) / 3.0, (v[1] - v[0]) / 3.0]
    }
}

impl Spin {
    /// `None` for primitives that have no spin, and for those of no size.
    fn new(kind: PairKind, x: &[Vector3<f64>; 4], dx: &[Vector3<f64>; 4]) -> Option<Self> {
        let edges: &[[usize; 2]] = match kind {
            PairKind::VertexTriangle => &[[1, 2], [2, 3], [3, 1]],
            PairKind::EdgeEdge => &[[0, 1], [2, 3]],
            PairKind::VertexEdge | PairKind::VertexVertex => return None,
        };
        let (mut v, mut dv) = ([Vector3::zeros(); 3], [Vector3::zeros(); 3]);
        for (e, &[tail, head]) in edges.iter().enumerate() {
            (v[e], dv[e]) = (x[head] - x[tail], dx[head] - dx[tail]);
        }
        let lengths: f64 = v.iter().map(|v| v.norm_squared()).sum();
        let threshold = if edges.len() == 2 {
            FADE_EDGES * v[0].norm_squared() * v[1].norm_squared()
        } else {
            FADE_TRIANGLE * lengths * lengths
        };
        if threshold == 0.0 {
            return None;
        }
        let p = v[0].cross(&v[1]);
        let w = levers(edges.len(), &v);
        let squared = p.norm_squared();
        let z = squared / threshold;
        let scale = if z < 1.0 { (2.0 - z) / threshold } else { 1.0 / squared };
        let fade = if z < 1.0 { z * (2.0 - z) } else { 1.0 };
        let moment: Vector3<f64> = (0..3).map(|e| v[e].cross(&dv[e])).sum();
        let in_plane: Vector3<f64> = (0..3).map(|e| w[e] * p.dot(&dv[e])).sum();
        let total = in_plane + p * (p.dot(&moment) / lengths);
        Some(Self { edges, v, dv, p, w, lengths, moment, total, fade, scale, threshold })
    }

    /// Forces on the heads of the edges, minus which on their tails, whose moment is `-|p|^2 k`, so that `k` is balanced.
    fn couple(&self, k: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let turning = self.p.dot(k) / self.lengths;
        std::array::from_fn(|e| self.p * self.w[e].dot(k) + self.p.cross(&self.v[e]) * turning)
    }

    /// The derivatives by component `l` of point `j` at the end, of which the positions move by `share`.
    fn change(&self, j: usize, l: usize, share: f64) -> SpinChange {
        let Self { v, dv, p, w, lengths, moment, .. } = self;
        let mut motion = [Vector3::zeros(); 3];
        for (e, &[tail, head]) in self.edges.iter().enumerate() {
            motion[e][l] = f64::from(u8::from(head == j)) - f64::from(u8::from(tail == j));
        }
        let change = motion.map(|m| m * share);
        let d_p = change[0].cross(&v[1]) + v[0].cross(&change[1]);
        let d_w = levers(self.edges.len(), &change);
        let d_lengths = 2.0 * (0..3).map(|e| v[e].dot(&change[e])).sum::<f64>();
        let d_squared = 2.0 * p.dot(&d_p);
        let d_moment: Vector3<f64> = (0..3).map(|e| change[e].cross(&dv[e]) + v[e].cross(&motion[e])).sum();
        let turning = p.dot(moment) / lengths;
        let d_turning = (d_p.dot(moment) + p.dot(&d_moment) - turning * d_lengths) / lengths;
        let in_plane: Vector3<f64> =
            (0..3).map(|e| d_w[e] * p.dot(&dv[e]) + w[e] * (d_p.dot(&dv[e]) + p.dot(&motion[e]))).sum();
        let squared = p.norm_squared();
        let (fade, scale) = if squared < self.threshold {
            let d_threshold = if self.edges.len() == 2 {
                2.0 * FADE_EDGES
                    * (v[0].dot(&change[0]) * v[1].norm_squared() + v[1].dot(&change[1]) * v[0].norm_squared())
            } else {
                2.0 * FADE_TRIANGLE * lengths * d_lengths
            };
            let z = squared / self.threshold;
            let dz = (d_squared - z * d_threshold) / self.threshold;
            (2.0 * (1.0 - z) * dz, (-dz - (2.0 - z) * d_threshold / self.threshold) / self.threshold)
        } else {
            (0.0, -d_squared / (squared * squared))
        };
        let total = in_plane + d_p * turning + p * d_turning;
        SpinChange { v: change, p: d_p, w: d_w, lengths: d_lengths, total, fade, scale }
    }

    /// The derivative of [`Spin::couple`] with `dk` that of `k`.
    fn couple_change(&self, change: &SpinChange, k: &Vector3<f64>, dk: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let Self { v, p, w, lengths, .. } = self;
        let turning = p.dot(k) / lengths;
        let d_turning = (change.p.dot(k) + p.dot(dk) - turning * change.lengths) / lengths;
        std::array::from_fn(|e| {
            change.p * w[e].dot(k)
                + p * (change.w[e].dot(k) + w[e].dot(dk))
                + (change.p.cross(&v[e]) + p.cross(&change.v[e])) * turning
                + p.cross(&v[e]) * d_turning
        })
    }
}
