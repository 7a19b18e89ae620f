//! Friction of a pair: the slip of a step without its spin, and forces that keep both momenta.

use crate::pattern::sum;
use nalgebra::{Matrix3, Vector3};
use stoss_contact::friction::{Coefficient, FrictionLaw, Sliding};
use stoss_geometry::{PairKind, combine};

/// Friction of a pair of primitives in a step: a law, and what it has to know.
#[derive(Clone, Copy, Debug)]
pub struct PairFriction<'a> {
    /// The law.
    pub law: &'a dyn FrictionLaw,
    /// Area by which the layer of the pair is weighted, positive: the normal force over it is the pressure that the law sees.
    pub area: f64,
    /// Size of the step, a time.
    pub step_size: f64,
    /// Path that the pair has slid before the step.
    pub slid: f64,
    /// Friction before it slides.
    pub stick: Presliding,
}

/// The largest tangential force, and its derivatives by the normal force and by the length of the slip in the step.
#[derive(Clone, Copy)]
struct Limit {
    force: f64,
    by_normal: f64,
    by_slip: f64,
}

/// Friction of a pair of primitives before it slides: none, creep or a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presliding {
    /// The law does not stick ([`FrictionLaw::sticks`]): friction is a function of the slip of the step.
    Never,
    /// Friction that creeps: it grows smoothly with the slip of the step.
    Creep {
        /// Slip in a step, a positive length, from which on all of the friction acts: a small velocity times the size of the step.
        slip_scale: f64,
    },
    /// A spring across the pair that holds, and slides where its force reaches the limit. What it does not depend on is the number of steps.
    Spring {
        /// Force per length, positive.
        stiffness: f64,
        /// Vector by which the spring is stretched at the start of the step, a length; [`FrictionForce::stretch`] of the last one.
        stretch: Vector3<f64>,
    },
}

impl PairFriction<'_> {
    /// What the law admits at a positive normal force and a slip of this length in the step.
    fn limit(&self, normal_force: f64, slip: f64) -> Limit {
        let pressure = normal_force / self.area;
        let at = Sliding { pressure, slip, step_size: self.step_size, slid: self.slid };
        let Coefficient { value, d_pressure, d_slip } = self.law.coefficient(&at);
        Limit { force: value * normal_force, by_normal: value + pressure * d_pressure, by_slip: normal_force * d_slip }
    }

    /// The law at a slip of a length, with the stretch of a spring.
    fn secant(&self, limit: &Limit, length: f64) -> Secant {
        let slides = || Secant {
            per_slip: limit.force / length,
            change: -limit.force / (length * length * length),
            by_normal: limit.by_normal / length,
            by_step: limit.by_slip / length,
        };
        match self.stick {
            Presliding::Never if length * length < f64::MIN_POSITIVE => {
                Secant { per_slip: limit.by_slip, change: 0.0, by_normal: 0.0, by_step: 0.0 }
            }
            Presliding::Creep { slip_scale } if length < slip_scale => {
                let per_slip = (2.0 - length / slip_scale) / slip_scale;
                // Of no influence where there is no slip.
                let change = if length > 0.0 { -1.0 / (slip_scale * slip_scale * length) } else { 0.0 };
                Secant {
                    per_slip: per_slip * limit.force,
                    change: change * limit.force,
                    by_normal: per_slip * limit.by_normal,
                    by_step: per_slip * limit.by_slip,
                }
            }
            Presliding::Spring { stiffness, .. } if stiffness * length <= limit.force => {
                Secant { per_slip: stiffness, change: 0.0, by_normal: 0.0, by_step: 0.0 }
            }
            _ => slides(),
        }
    }
}

/// The law at a slip: `t = per_slip slip`, `dt = per_slip d(slip) + slip (change slip . d(slip) + by_normal d(normal force) + by_step d(length of the slip in the step))`.
struct Secant {
    per_slip: f64,
    change: f64,
    by_normal: f64,
    by_step: f64,
}

/// Friction of a pair in a step; theory/barrier#friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionForce {
    /// Gradient that is to be added to a residual; the force on point `i` is `-gradient[i]`.
    pub gradient: [Vector3<f64>; 4],
    /// Work that friction takes out of the points in the step, `sum gradient_i . dx_i`. If it creeps all of it is lost, and it is not negative.
    pub work: f64,
    /// Energy in the spring at the end of the step; zero if friction creeps.
    pub stored: f64,
    /// Vector by which the spring is stretched at the end of the step, a length; zero if friction creeps.
    pub stretch: Vector3<f64>,
    /// Length of the slip in the step, with the stretch of the spring at its start, as the law sees it: that of a pair that is nearly degenerate fades out.
    pub slip: f64,
    /// Path that the pair has slid at the end of the step: of the slip what a spring does not take up.
    pub slid: f64,
    /// Length of the normal force that the law sees: without the part from the gradient of the factor of nearly parallel edges.
    pub normal_force: f64,
    /// Length of the tangential force on the first primitive, at most what the law admits.
    pub tangential_force: f64,
}

impl FrictionForce {
    /// No friction.
    pub(crate) const NONE: Self = Self {
        gradient: [Vector3::new(0.0, 0.0, 0.0); 4],
        work: 0.0,
        stored: 0.0,
        stretch: Vector3::new(0.0, 0.0, 0.0),
        slip: 0.0,
        slid: 0.0,
        normal_force: 0.0,
        tangential_force: 0.0,
    };
}

/// Squared sine of two edges below which their friction fades, theory/barrier#eq-fade.
const FADE_EDGES: f64 = 1e-2;

/// Squared double area of a triangle, over the square of the sum of its squared edges, below which its friction fades: heights below a fiftieth of the edges.
const FADE_TRIANGLE: f64 = 1e-4;

/// Points that are pressed together, with what friction needs of them.
pub(crate) struct Pressed<'a> {
    /// Normal force on the first primitive.
    pub normal: Vector3<f64>,
    /// Weights of the points between which it acts, with the sum zero.
    pub weights: &'a [f64],
    /// Positions at which forces have no moment.
    pub x: &'a [Vector3<f64>],
    /// Motion in the step.
    pub dx: &'a [Vector3<f64>],
    /// Whose spin is not slip: primitives of a kind, and the places of their four points.
    pub base: (PairKind, [usize; 4]),
}

/// How all of this changes with the positions at the end.
pub(crate) struct Variation<'a> {
    /// Derivative of the positions by those of the end.
    pub share: f64,
    /// `dc_i/dx_j` at `i n + j` for `n` points.
    pub weights: &'a [Vector3<f64>],
    /// `dN/dx_j`.
    pub normal: &'a [Matrix3<f64>],
}

/// What friction does, but for its gradient.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Slid {
    pub work: f64,
    pub stored: f64,
    pub stretch: Vector3<f64>,
    pub slid: f64,
    slip: f64,
    normal_force: f64,
    tangential_force: f64,
}

impl Slid {
    /// The friction force of a pair with this gradient.
    pub fn of_pair(self, gradient: [Vector3<f64>; 4]) -> FrictionForce {
        let Self { work, stored, stretch, slid, slip, normal_force, tangential_force } = self;
        FrictionForce { gradient, work, stored, stretch, slid, slip, normal_force, tangential_force }
    }
}

/// Friction along a straight motion, with the normal force and the points of its start: the gradient of an energy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlipLine {
    slip: Vector3<f64>,
    /// Change of the slip by all of the motion.
    change: Vector3<f64>,
    /// What the law admits, and force over slip, at the start of the motion.
    limit: f64,
    per_slip: f64,
    stick: Presliding,
}

impl SlipLine {
    /// Energy, whose derivative by the slip the force of the law is, at a part of the motion.
    pub fn energy(&self, part: f64) -> f64 {
        let Self { slip, change, limit, per_slip, stick } = self;
        let length = (slip + change * part).norm();
        match *stick {
            Presliding::Never => 0.5 * per_slip * length * length,
            Presliding::Creep { slip_scale: scale } if length < scale => {
                let y = length / scale;
                limit * scale * y * y * (1.0 - y / 3.0)
            }
            Presliding::Creep { slip_scale } => limit * (length - slip_scale / 3.0),
            Presliding::Spring { stiffness, .. } if stiffness * length <= *limit => 0.5 * stiffness * length * length,
            Presliding::Spring { stiffness, .. } => limit * (length - 0.5 * limit / stiffness),
        }
    }
}

impl Pressed<'_> {
    /// The spin of the base that positions and motions of all points give.
    fn spin(&self, motion: &[Vector3<f64>]) -> Option<Spin> {
        let (kind, base) = self.base;
        Spin::new(kind, &base.map(|i| self.x[i]), &base.map(|i| motion[i]))
    }

    /// What becomes of the friction along a motion of the points by `d`.
    pub fn along(&self, law: &PairFriction<'_>, d: &[Vector3<f64>]) -> Option<SlipLine> {
        let normal_force = self.normal.norm();
        if normal_force == 0.0 {
            return None;
        }
        let (n, r) = (self.normal / normal_force, sum(self.weights, self.x));
        let across = |v: Vector3<f64>| v - n * n.dot(&v);
        let slip = |motion: &[Vector3<f64>]| {
            let spin = self.spin(motion)?;
            let omega = spin.total * spin.scale;
            Some((sum(self.weights, motion) * spin.fade - omega.cross(&r), omega))
        };
        let ((slip, omega), (change, _)) = (slip(self.dx)?, slip(d)?);
        let limit = law.limit(normal_force, across(slip).norm());
        let slip = across(slip + Turned::new(&law.stick, &omega).stretch);
        let per_slip = law.secant(&limit, slip.norm()).per_slip;
        Some(SlipLine { slip, change: across(change), limit: limit.force, per_slip, stick: law.stick })
    }

    /// The friction; its gradient goes to `gradient`, and its tangent (`3 n` rows) is *added* to one that is there.
    pub fn friction(
        &self,
        law: &PairFriction<'_>,
        gradient: &mut [Vector3<f64>],
        tangent: Option<(&Variation<'_>, &mut [f64])>,
    ) -> Slid {
        let (c, x, count) = (self.weights, self.x, self.x.len());
        gradient.fill(Vector3::zeros());
        let normal_force = self.normal.norm();
        let none = Slid { normal_force, ..Slid::default() };
        if normal_force == 0.0 {
            return none;
        }
        let Some(spin) = self.spin(self.dx) else { return none };
        let (fade, base) = (spin.fade, self.base.1);
        let n = self.normal / normal_force;
        let (r, moved) = (sum(c, x), sum(c, self.dx));
        let omega = spin.total * spin.scale;
        let turned = Turned::new(&law.stick, &omega);
        let of_step = moved * fade - omega.cross(&r);
        let relative = of_step + turned.stretch;
        let along_normal = n.dot(&relative);
        let slip = relative - n * along_normal;
        let length = slip.norm();
        let slip_of_step = of_step - n * n.dot(&of_step);
        let limit = law.limit(normal_force, slip_of_step.norm());
        let Secant { per_slip, change, by_normal: rate, by_step } = law.secant(&limit, length);
        let t = slip * per_slip;
        let k = r.cross(&t);
        let couple = spin.couple(&k).map(|f| f * spin.scale);
        gradient.iter_mut().zip(c).for_each(|(g, c)| *g = t * (fade * c));
        for (place, &i) in base.iter().enumerate() {
            gradient[i] -= couple[0] * spin.signs[0][place] + couple[1] * spin.signs[1][place];
        }
        if let Some((Variation { share, weights, normal }, tangent)) = tangent {
            let by_slip = Matrix3::identity() * per_slip + slip * slip.transpose() * change;
            let across = Matrix3::identity() - n * n.transpose();
            let by_relative = by_slip * across;
            let turn = (Matrix3::identity() * along_normal + n * relative.transpose()) * across;
            let by_normal = slip * n.transpose() * rate - by_slip * turn / normal_force;
            let by_edge = spin.by_edges(&k, *share);
            let couple_by_k = spin.couple_by_moment();
            let (r_cross, omega_cross, t_cross) = (r.cross_matrix(), omega.cross_matrix(), t.cross_matrix());
            let relative_by_edge: [Matrix3<f64>; 2] = std::array::from_fn(|e| {
                moved * by_edge[e].fade.transpose() + (r_cross + turned.by_omega) * by_edge[e].omega
            });
            let along_step = slip_of_step.try_normalize(0.0).filter(|_| by_step != 0.0);
            for j in 0..count {
                let mut dr = Matrix3::identity() * (share * c[j]);
                let mut d_moved = Matrix3::identity() * c[j];
                for i in 1..count {
                    let by = weights[i * count + j].transpose();
                    dr += (x[i] - x[0]) * by;
                    d_moved += (self.dx[i] - self.dx[0]) * by;
                }
                // Part of the point in the edges of the base.
                let part = base.iter().position(|&i| i == j).map(|place| [0, 1].map(|e| spin.signs[e][place]));
                let mut d_relative = d_moved * fade - omega_cross * dr;
                let mut d_fade = Vector3::zeros();
                for (e, sign) in part.into_iter().flatten().enumerate() {
                    d_relative += relative_by_edge[e] * sign;
                    d_fade += by_edge[e].fade * sign;
                }
                let mut dt = by_relative * d_relative + by_normal * normal[j];
                if let Some(along) = &along_step {
                    let mut d_of_step = d_relative;
                    for (e, sign) in part.into_iter().flatten().enumerate() {
                        d_of_step -= turned.by_omega * by_edge[e].omega * sign;
                    }
                    let turns = n.dot(&of_step) / normal_force;
                    let d_length = along.transpose() * (d_of_step - normal[j] * turns);
                    dt += slip * by_step * d_length;
                }
                let dk = r_cross * dt - t_cross * dr;
                let d_force = dt * fade + t * d_fade.transpose();
                for i in 0..count {
                    let block = d_force * c[i] + t * (weights[i * count + j] * fade).transpose();
                    add_block(tangent, count, [i, j], &block);
                }
                let d_couple: [Matrix3<f64>; 2] = std::array::from_fn(|f| {
                    let by_edges = part.into_iter().flatten().enumerate();
                    by_edges.fold(couple_by_k[f] * dk, |sum, (e, sign)| sum + by_edge[e].couple[f] * sign)
                });
                for (place, &i) in base.iter().enumerate() {
                    let block = d_couple[0] * -spin.signs[0][place] - d_couple[1] * spin.signs[1][place];
                    add_block(tangent, count, [i, j], &block);
                }
            }
        }
        let (stretch, stored) = match law.stick {
            Presliding::Never | Presliding::Creep { .. } => (Vector3::zeros(), 0.0),
            Presliding::Spring { stiffness, .. } => (t / stiffness, 0.5 * t.norm_squared() / stiffness),
        };
        let slid = match law.stick {
            Presliding::Spring { stiffness, .. } => (length - limit.force / stiffness).max(0.0),
            Presliding::Never | Presliding::Creep { .. } => length,
        };
        Slid {
            slid: law.slid + slid,
            work: t.dot(&slip_of_step),
            stored,
            stretch,
            slip: length,
            normal_force,
            tangential_force: fade * per_slip * length,
        }
    }
}

/// Adds the block of two of `count` points to a matrix of three rows for each.
pub(crate) fn add_block(matrix: &mut [f64], count: usize, [i, j]: [usize; 2], block: &Matrix3<f64>) {
    for k in 0..3 {
        let row = &mut matrix[(3 * i + k) * 3 * count + 3 * j..][..3];
        row.iter_mut().enumerate().for_each(|(l, entry)| *entry += block[(k, l)]);
    }
}

/// The stretch at the start of the step, turned with the pair, and its derivative by the spin: `(e + omega x e)/sqrt(1 + omega . omega)`, never longer than `e`.
struct Turned {
    stretch: Vector3<f64>,
    by_omega: Matrix3<f64>,
}

impl Turned {
    fn new(stick: &Presliding, omega: &Vector3<f64>) -> Self {
        match stick {
            Presliding::Never | Presliding::Creep { .. } => {
                Self { stretch: Vector3::zeros(), by_omega: Matrix3::zeros() }
            }
            Presliding::Spring { stretch: e, .. } => {
                let scale = 1.0 / (1.0 + omega.norm_squared()).sqrt();
                let stretch = (e + omega.cross(e)) * scale;
                Self { stretch, by_omega: -(e.cross_matrix() + stretch * omega.transpose() * scale) * scale }
            }
        }
    }
}

/// Spin of the primitives' own edges in a step, and, the other way round, forces on these edges with a given moment; theory/barrier#eq-spin to theory/barrier#eq-fade.
struct Spin {
    /// Signs of the points in the two edges `a`, `b`: those of a pair of edges, or two of the triangle (the third one is `-a - b`).
    signs: [[f64; 4]; 2],
    edges: [Vector3<f64>; 2],
    /// Changes of the edges in the step.
    moved: [Vector3<f64>; 2],
    /// What the edges count: `A = own a + other b`, `B = own b + other a`.
    own: f64,
    other: f64,
    arms: [Vector3<f64>; 2],
    /// `a x b`.
    p: Vector3<f64>,
    /// Sum of the squared edges, `a . A + b . B`.
    lengths: f64,
    /// `omega = scale total` is the spin times `fade`, where `scale = fade / |p|^2`.
    total: Vector3<f64>,
    scale: f64,
    fade: f64,
    /// `|p|^2` below which they fade.
    threshold: f64,
}

/// Derivatives by one edge, which takes its motion along.
struct ByEdge {
    omega: Matrix3<f64>,
    fade: Vector3<f64>,
    /// Derivatives of the forces on both edges, at a fixed moment.
    couple: [Matrix3<f64>; 2],
}

impl Spin {
    /// `None` for primitives that have no spin, and for those of no size.
    fn new(kind: PairKind, x: &[Vector3<f64>; 4], dx: &[Vector3<f64>; 4]) -> Option<Self> {
        let (signs, own, other) = match kind {
            PairKind::VertexTriangle => ([[0.0, -1.0, 1.0, 0.0], [0.0, 0.0, -1.0, 1.0]], 2.0, 1.0),
            PairKind::EdgeEdge => ([[-1.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 1.0]], 1.0, 0.0),
            PairKind::VertexEdge | PairKind::VertexVertex => return None,
        };
        let edges = signs.map(|s| combine(&s, x));
        let moved = signs.map(|s| combine(&s, dx));
        let [a, b] = edges;
        let arms = [a * own + b * other, b * own + a * other];
        let lengths = a.dot(&arms[0]) + b.dot(&arms[1]);
        let threshold = match kind {
            PairKind::EdgeEdge => FADE_EDGES * a.norm_squared() * b.norm_squared(),
            _ => FADE_TRIANGLE * lengths * lengths,
        };
        if threshold == 0.0 {
            return None;
        }
        let p = a.cross(&b);
        let squared = p.norm_squared();
        let z = squared / threshold;
        let (fade, scale) = if z < 1.0 { (z * (2.0 - z), (2.0 - z) / threshold) } else { (1.0, 1.0 / squared) };
        let moment = arms[0].cross(&moved[0]) + arms[1].cross(&moved[1]);
        let total = a * p.dot(&moved[1]) - b * p.dot(&moved[0]) + p * (p.dot(&moment) / lengths);
        Some(Self { signs, edges, moved, own, other, arms, p, lengths, total, scale, fade, threshold })
    }

    /// Forces on the two edges, to be times `scale`, with the moment `|p|^2 k`.
    fn couple(&self, k: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let Self { edges: [a, b], p, .. } = self;
        let turning = p.dot(k) / self.lengths;
        [p.cross(&self.arms[0]) * turning - p * b.dot(k), p.cross(&self.arms[1]) * turning + p * a.dot(k)]
    }

    /// Derivative of these forces, times `scale`, with respect to the moment.
    fn couple_by_moment(&self) -> [Matrix3<f64>; 2] {
        let Self { edges: [a, b], p, .. } = self;
        let turning = p.transpose() / self.lengths;
        [
            (p.cross(&self.arms[0]) * turning - p * b.transpose()) * self.scale,
            (p.cross(&self.arms[1]) * turning + p * a.transpose()) * self.scale,
        ]
    }

    /// Derivatives with respect to the edges at the end of the step, of which the positions move by `share` and the motion as a whole.
    fn by_edges(&self, k: &Vector3<f64>, share: f64) -> [ByEdge; 2] {
        let Self { edges: [a, b], moved: [da, db], arms, p, lengths, .. } = self;
        let (squared, couple) = (p.norm_squared(), self.couple(k));
        let moment = arms[0].cross(da) + arms[1].cross(db);
        let (turning, turning_k) = (p.dot(&moment) / lengths, p.dot(k) / lengths);
        let p_cross = p.cross_matrix();
        std::array::from_fn(|e| {
            // Of p, transposed: p changes by share (change x b), or by share (a x change).
            let by_p = if e == 0 { b.cross_matrix() } else { -a.cross_matrix() } * share;
            let p_by = -by_p;
            let (in_a, in_b) = if e == 0 { (self.own, self.other) } else { (self.other, self.own) };
            let moment_by = arms[e].cross_matrix() - (da * in_a + db * in_b).cross_matrix() * share;
            let by_lengths = arms[e] * (2.0 * share);
            let by_turning = (by_p * moment + moment_by.tr_mul(p) - by_lengths * turning) / *lengths;
            let by_turning_k = (by_p * k - by_lengths * turning_k) / *lengths;
            let (mut along_a, mut along_b) = (by_p * da, by_p * db);
            let mut total = p_by * turning + p * by_turning.transpose();
            // Forces without scale on the edges a and b.
            let mut forces = [p_by * -b.dot(k), p_by * a.dot(k)];
            if e == 0 {
                along_a += p;
                total += Matrix3::identity() * (share * p.dot(db));
                forces[1] += p * (k * share).transpose();
            } else {
                along_b += p;
                total -= Matrix3::identity() * (share * p.dot(da));
                forces[0] -= p * (k * share).transpose();
            }
            total += a * along_b.transpose() - b * along_a.transpose();
            for (f, part) in [in_a, in_b].into_iter().enumerate() {
                forces[f] += (p_cross * (share * part) - arms[f].cross_matrix() * p_by) * turning_k;
                forces[f] += p.cross(&arms[f]) * by_turning_k.transpose();
            }
            let by_squared = by_p * p * 2.0;
            let (fade, scale) = if squared < self.threshold {
                // Two edges (that have no part in each other): threshold ~ |a|^2 |b|^2; triangle: ~ lengths^2.
                let by_threshold = if self.other == 0.0 {
                    self.edges[e] * (2.0 * share / self.edges[e].norm_squared())
                } else {
                    by_lengths * (2.0 / lengths)
                };
                let z = squared / self.threshold;
                let dz = by_squared / self.threshold - by_threshold * z;
                (dz * (2.0 * (1.0 - z)), -(dz + by_threshold * (2.0 - z)) / self.threshold)
            } else {
                (Vector3::zeros(), by_squared * (-1.0 / (squared * squared)))
            };
            ByEdge {
                omega: total * self.scale + self.total * scale.transpose(),
                fade,
                couple: std::array::from_fn(|f| forces[f] * self.scale + couple[f] * scale.transpose()),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points() -> impl Strategy<Value = [Vector3<f64>; 4]> {
        proptest::array::uniform4(proptest::array::uniform3(-1.0..1.0f64).prop_map(Vector3::from))
    }

    proptest! {
        #[test]
        fn the_closed_form_is_the_spin_of_least_squares(x in points(), dx in points(), k in points()) {
            for (kind, edges) in [(PairKind::VertexTriangle, &[[1, 2], [2, 3], [3, 1]][..]), (PairKind::EdgeEdge, &[[0, 1], [2, 3]])] {
                let (mut y, mut moment) = (Matrix3::zeros(), Vector3::zeros());
                for &[tail, head] in edges {
                    let (v, dv) = (x[head] - x[tail], dx[head] - dx[tail]);
                    y += Matrix3::identity() * v.norm_squared() - v * v.transpose();
                    moment += v.cross(&dv);
                }
                let spin = Spin::new(kind, &x, &dx).unwrap();
                prop_assume!(y.determinant() > 1e-3 * y.norm().powi(3));
                let omega = y.try_inverse().unwrap() * moment * spin.fade;
                prop_assert!((spin.total * spin.scale - omega).norm() <= 1e-10 * (omega.norm() + moment.norm()));
                // The forces on the edges have the moment that they are to have, whatever the fade.
                let forces = spin.couple(&k[0]).map(|f| f * spin.scale);
                let force_at = |i: usize| forces[0] * spin.signs[0][i] + forces[1] * spin.signs[1][i];
                let moment: Vector3<f64> = (0..4).map(|i| x[i].cross(&force_at(i))).sum();
                prop_assert!((moment - k[0] * spin.fade).norm() <= 1e-12 * k[0].norm());
            }
        }
    }
}
