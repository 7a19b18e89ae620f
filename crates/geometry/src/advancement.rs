//! How far a pair of primitives may move without coming into contact: continuous collision detection by conservative advancement.
//!
//! All points move along straight lines, `x_i(t) = x_i + t d_i`, `t` from 0 to 1. [`safe_fraction`] finds the largest `t` up to which the distance is *proved* to stay above
//! a part of the distance at the start.
//!
//! **Proof.** For any vector `n(t)` the distance at `t` is at least `min_ij n(t) . (x_i - x_j)(t) / |n(t)|`, `i` over the points of the first primitive and `j` over those of the second: `n` is the normal of a slab that
//! separates them. Closest points only *propose* `n`; what is proved of a slab holds whatever they are. Two sorts of slabs are tried from each `t`:
//!
//! * a fixed normal `n = r / |r|` between the closest points: each `n . (x_i - x_j)` is linear in `t`, so the time at which the slab is as thin as the limit has a closed form. Motions towards each other, and motions along each other, are done in one go;
//! * a normal that follows the closest features: the normal of a moving triangle, of two moving edges, or across a moving edge; a polynomial of degree two at most. `n . (x_i - x_j) - limit |n|` is bounded from below by
//!   coefficients in the Bernstein basis. Thus two bodies that turn together need no more evaluations than two at rest, which with fixed normals alone would go on in steps of distance over length.
//!
//! From there the closest points are looked for again. Every bound has room for the round-off of its evaluation. No roots are looked for, so none can be missed.
//!
//! **What it is not.** The result is not the time of contact: it is smaller, also where no contact follows but the distance falls below the limit. Pairs whose distance at the start is round-off, or zero, have no safe fraction: 0.

use crate::{PairFeature, PairKind, closest, combine};
use nalgebra::Vector3;

/// Evaluations of closest points after which the time reached so far is the answer. Random motions take 2 to 4 on average, also those of three times the size of the pair at a millionth of it as the distance.
const EVALUATIONS: usize = 48;

/// The advance ends where the distance exceeds the limit by this part of the limit: what is left is not worth an evaluation.
const CLOSE_ENOUGH: f64 = 1e-3;

/// Halvings of the time for which a normal that follows the features is tried.
const HALVINGS: usize = 16;

/// Round-off of a slab's thickness, relative to the sum of the lengths that enter it: about 20 roundings of half an epsilon, times three.
const ROUND_OFF: f64 = 32.0 * f64::EPSILON;

/// A part of the step, at most 1, on which the distance of a pair provably stays above `keep` times the distance at its start.
///
/// `x` are the points of the pair as [`PairKind`] orders them, `increment` their motion over the step; lengths in the same unit. `keep` is between 0 and 1, 0.1 for instance. The distance
/// that is kept is the true one of the given numbers, with all round-off accounted for. So the fraction is smaller than the time of the first contact, and 1 is exact: no contact in the step.
/// 0 means that the pair touches at the start, or that its distance there is as small as the round-off of its own size and motion.
///
/// ```
/// use nalgebra::Vector3;
/// use stoss_geometry::{PairKind, safe_fraction};
/// let x = [Vector3::new(0.2, 0.2, 1.0), Vector3::zeros(), Vector3::x(), Vector3::y()];
/// let mut increment = [Vector3::zeros(); 4];
/// increment[0] = -2.0 * Vector3::z();
/// let fraction = safe_fraction(PairKind::VertexTriangle, &x, &increment, 0.1);
/// assert!((fraction - 0.45).abs() < 1e-12);
/// ```
pub fn safe_fraction(kind: PairKind, x: &[Vector3<f64>; 4], increment: &[Vector3<f64>; 4], keep: f64) -> f64 {
    Advance::new(kind, x, increment).run(keep).0
}

/// Points and motions relative to the first point of the pair.
struct Advance {
    kind: PairKind,
    position: [Vector3<f64>; 4],
    increment: [Vector3<f64>; 4],
    /// Bound of the round-off of a slab's thickness, for a normal of length one.
    round_off: f64,
}

impl Advance {
    fn new(kind: PairKind, x: &[Vector3<f64>; 4], increment: &[Vector3<f64>; 4]) -> Self {
        let used = |v: &[Vector3<f64>; 4], i: usize| {
            if i < kind.point_count() { v[i] - v[0] } else { Vector3::zeros() }
        };
        let position = std::array::from_fn(|i| used(x, i));
        let increment = std::array::from_fn(|i| used(increment, i));
        let length = |v: &[Vector3<f64>; 4]| v.iter().map(Vector3::norm).sum::<f64>();
        let round_off = ROUND_OFF * (length(&position) + length(&increment));
        Self { kind, position, increment, round_off }
    }

    /// The safe fraction, and the number of times that closest points were looked for.
    fn run(&self, keep: f64) -> (f64, usize) {
        let mut t = 0.0;
        let mut limit = 0.0;
        for evaluation in 1..=EVALUATIONS {
            let x = std::array::from_fn(|i| self.position[i] + self.increment[i] * t);
            let pair = closest(self.kind, &x);
            let r = combine(&pair.weights, &x);
            let distance = r.norm();
            if evaluation == 1 {
                limit = keep * distance;
            }
            let is_far = distance - limit > self.round_off.max(CLOSE_ENOUGH * limit);
            // Not far: also where something is not a number.
            if !is_far {
                return (t, evaluation);
            }
            let rest = 1.0 - t;
            let direction = r / distance;
            let mut advance = self.along_fixed_normal(&x, &direction, limit);
            for feature in self.worth_following(pair.feature()).into_iter().flatten() {
                if advance < rest
                    && let Some(normal) = self.following_normal(&x, &direction, feature)
                {
                    // At small distances it has more digits than the direction.
                    advance = advance.max(self.along_fixed_normal(&x, &normal[0].normalize(), limit));
                    advance = advance.max(self.along_following_normal(&x, &normal, limit, rest, advance));
                }
            }
            if advance >= rest {
                return (1.0, evaluation);
            }
            if t + advance == t {
                return (t, evaluation);
            }
            t += advance;
        }
        (t, EVALUATIONS)
    }

    /// Time until the slab with a fixed normal of length one is as thin as the limit; infinite if never, zero if it is too thin already.
    fn along_fixed_normal(&self, x: &[Vector3<f64>; 4], normal: &Vector3<f64>, limit: f64) -> f64 {
        let mut time = f64::INFINITY;
        for (i, j) in self.corners() {
            let room = normal.dot(&(x[i] - x[j])) - limit - self.round_off;
            let speed = normal.dot(&(self.increment[j] - self.increment[i]));
            // `room` is not a number where there is no normal.
            if room <= 0.0 || room.is_nan() {
                return 0.0;
            }
            if speed > 0.0 {
                time = time.min(room / speed);
            }
        }
        time
    }

    /// A time up to `rest` for which the slab with a normal that follows the features is proved to be thicker than the limit; zero unless that is longer than `enough`.
    fn along_following_normal(
        &self,
        x: &[Vector3<f64>; 4],
        normal: &[Vector3<f64>; 3],
        limit: f64,
        rest: f64,
        enough: f64,
    ) -> f64 {
        // Corners on the same feature have the same polynomial: four at most.
        let mut thickness = [[0.0; 4]; 4];
        let mut count = 0;
        for (i, j) in self.corners() {
            let (s, v) = (x[i] - x[j], self.increment[i] - self.increment[j]);
            let [n_0, n_1, n_2] = normal;
            thickness[count] = [n_0.dot(&s), n_1.dot(&s) + n_0.dot(&v), n_2.dot(&s) + n_1.dot(&v), n_2.dot(&v)];
            count += 1;
        }
        let holds = |time| self.slab_holds(normal, &thickness[..count], limit, time);
        if holds(rest) {
            return rest;
        }
        // The start of the halvings: four times the root of the linear parts, beyond which there is little hope.
        let length = normal[0].norm();
        let slope = |c: &[f64; 4]| (limit * normal[1].norm() - c[1]) / (c[0] - limit * length);
        let steepest = thickness[..count].iter().map(slope).fold(0.0, f64::max);
        let mut time = (0.5 * rest).min(4.0 / steepest);
        let mut halvings = 0;
        while !holds(time) {
            time *= 0.5;
            halvings += 1;
            if time <= enough || halvings == HALVINGS {
                return 0.0;
            }
        }
        // Three bisections: the time is within an eighth of the longest that the bound admits.
        let mut step = 0.5 * time;
        for _ in 0..3 {
            if holds(time + step) {
                time += step;
            }
            step *= 0.5;
        }
        time
    }

    /// Features whose normals are tried: the closest ones, and, near a change of features, the insides of the primitives and the edges at a closest corner.
    fn worth_following(&self, closest: PairFeature) -> [Option<PairFeature>; 4] {
        let inside = match self.kind {
            PairKind::VertexTriangle => Some(PairFeature::VertexTriangle),
            PairKind::EdgeEdge => Some(PairFeature::EdgeEdge),
            PairKind::VertexEdge => Some(PairFeature::VertexEdge(0, [1, 2])),
            PairKind::VertexVertex => None,
        };
        match closest {
            PairFeature::VertexTriangle | PairFeature::EdgeEdge => [inside, None, None, None],
            PairFeature::VertexEdge(..) => [Some(closest), inside, None, None],
            PairFeature::VertexVertex([a, b]) => match self.kind {
                PairKind::VertexTriangle => {
                    let edge = |k| Some(PairFeature::VertexEdge(0, [b, k]));
                    [inside, edge(b % 3 + 1), edge((b + 1) % 3 + 1), None]
                }
                PairKind::EdgeEdge => {
                    [inside, Some(PairFeature::VertexEdge(a, [2, 3])), Some(PairFeature::VertexEdge(b, [0, 1])), None]
                }
                PairKind::VertexEdge | PairKind::VertexVertex => [inside, None, None, None],
            },
        }
    }

    /// Coefficients `n_0, n_1, n_2` of a normal `n_0 + t n_1 + t^2 n_2` that stays across the closest features and points like `direction`, that between the closest points, at `t = 0`; none for two corners.
    fn following_normal(
        &self,
        x: &[Vector3<f64>; 4],
        direction: &Vector3<f64>,
        feature: PairFeature,
    ) -> Option<[Vector3<f64>; 3]> {
        // Scaled to a length of one, so that the normal's own squares neither overflow nor underflow.
        let edge = |[a, b]: [usize; 2]| {
            let e = x[b] - x[a];
            let scale = 1.0 / e.norm();
            (e * scale, (self.increment[b] - self.increment[a]) * scale)
        };
        let ((p, dp), (q, dq)) = match feature {
            PairFeature::VertexVertex(_) => return None,
            // The second factor is fixed: across the edge and across the direction between the closest points.
            PairFeature::VertexEdge(_, e) => (edge(e), (direction.cross(&edge(e).0), Vector3::zeros())),
            PairFeature::VertexTriangle => (edge([1, 2]), edge([1, 3])),
            PairFeature::EdgeEdge => (edge([0, 1]), edge([2, 3])),
        };
        let normal = [p.cross(&q), dp.cross(&q) + p.cross(&dq), dp.cross(&dq)];
        let sign = if normal[0].dot(direction) < 0.0 { -1.0 } else { 1.0 };
        Some(normal.map(|n| n * sign))
    }

    /// Whether all polynomials `thickness` exceed `limit |n|` from 0 to `time`, by their coefficients in the Bernstein basis of degree three.
    fn slab_holds(&self, normal: &[Vector3<f64>; 3], thickness: &[[f64; 4]], limit: f64, time: f64) -> bool {
        let [n_0, n_1, n_2] = [normal[0], normal[1] * time, normal[2] * (time * time)];
        // |n| is at most the polynomial whose coefficients are the lengths of those of n; raised to degree three.
        let (a, b, c) = (n_0.norm(), (n_0 + n_1 * 0.5).norm(), (n_0 + n_1 + n_2).norm());
        let lengths = [a, (a + 2.0 * b) / 3.0, (2.0 * b + c) / 3.0, c];
        let round_off = self.round_off * (a + n_1.norm() + n_2.norm());
        thickness.iter().all(|[c_0, c_1, c_2, c_3]| {
            let (c_1, c_2, c_3) = (c_1 * time, c_2 * time * time, c_3 * time * time * time);
            let coefficients = [*c_0, c_0 + c_1 / 3.0, c_0 + (2.0 * c_1 + c_2) / 3.0, c_0 + c_1 + c_2 + c_3];
            coefficients.iter().zip(&lengths).all(|(c, n)| c - limit * n > round_off)
        })
    }

    /// All pairs of a point of the first primitive and one of the second.
    fn corners(&self) -> impl Iterator<Item = (usize, usize)> {
        let (first, all) = (self.kind.first_count(), self.kind.point_count());
        (0..first).flat_map(move |i| (first..all).map(move |j| (i, j)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Rotation3};

    fn vector(random: &mut fastrand::Rng) -> Vector3<f64> {
        Vector3::from_fn(|_, _| 2.0 * random.f64() - 1.0)
    }

    /// Pairs at a distance `gap` whose motion is arbitrary, a rotation, affine, or a rotation of one primitive only, of amount `size`.
    fn pair_and_motion(
        random: &mut fastrand::Rng,
        kind: PairKind,
        size: f64,
        gap: f64,
        motion: usize,
    ) -> ([Vector3<f64>; 4], [Vector3<f64>; 4]) {
        let mut x: [Vector3<f64>; 4] = std::array::from_fn(|_| vector(random));
        let r = combine(&closest(kind, &x).weights, &x);
        for point in &mut x[..kind.first_count()] {
            *point += r * (gap / r.norm() - 1.0);
        }
        let spin = vector(random) * size;
        let affine = Matrix3::from_columns(&[vector(random), vector(random), vector(random)]) * size;
        let increment = match motion {
            0 => std::array::from_fn(|_| vector(random) * size),
            1 => x.map(|x| Rotation3::new(spin) * x - x),
            2 => x.map(|x| affine * x),
            _ => std::array::from_fn(|i| {
                if i < kind.first_count() { vector(random) * gap } else { spin.cross(&(x[i] - x[0])) }
            }),
        };
        (x, increment)
    }

    #[test]
    fn few_evaluations_reach_the_end_or_the_limit() {
        const COUNT: usize = 100;
        let mut random = fastrand::Rng::with_seed(7);
        for kind in [PairKind::VertexTriangle, PairKind::EdgeEdge, PairKind::VertexEdge, PairKind::VertexVertex] {
            for (size, gap) in
                [(0.01, 1e-3), (0.1, 1e-1), (0.1, 1e-4), (1.0, 1e-2), (1.0, 1e-6), (3.0, 1e-1), (3.0, 1e-6)]
            {
                for motion in 0..4 {
                    let mut evaluations = 0;
                    for _ in 0..COUNT {
                        let (x, increment) = pair_and_motion(&mut random, kind, size, gap, motion);
                        let (t, count) = Advance::new(kind, &x, &increment).run(0.1);
                        evaluations += count;
                        assert!(count <= 24, "{kind:?} {count} {x:?} {increment:?}");
                        let y = std::array::from_fn(|i| x[i] + increment[i] * t);
                        let distance = closest(kind, &y).distance_squared.sqrt();
                        assert!(
                            t == 1.0 || distance < 0.1 * gap * 1.0011,
                            "{kind:?} {t} {distance} {x:?} {increment:?}"
                        );
                    }
                    assert!(evaluations < 4 * COUNT, "{kind:?} size {size} gap {gap} motion {motion}: {evaluations}");
                }
            }
        }
    }

    #[test]
    fn no_motion_and_no_distance() {
        let x = [Vector3::z(), Vector3::zeros(), Vector3::x(), Vector3::y()];
        let still = [Vector3::zeros(); 4];
        let shift = [Vector3::new(0.3, -4.0, 1e3); 4];
        for kind in [PairKind::VertexTriangle, PairKind::EdgeEdge, PairKind::VertexEdge, PairKind::VertexVertex] {
            assert_eq!(Advance::new(kind, &x, &still).run(0.1), (1.0, 1));
            assert_eq!(Advance::new(kind, &x, &shift).run(0.1), (1.0, 1));
            assert_eq!(safe_fraction(kind, &[Vector3::x(); 4], &x, 0.1), 0.0);
        }
    }
}
