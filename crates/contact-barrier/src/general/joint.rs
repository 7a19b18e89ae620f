//! The force of a contact: the sum of terms, each with one balanced pattern of weights over all points of the contact, and one friction with the pattern that the sum has; theory/barrier#patch, theory/barrier#joint-friction.

use crate::Layer;
use crate::layer::LayerStep;
use crate::pattern::{Along, Ends, Pattern};
use crate::sensitivity::Sensitivity;
use crate::slip::{PairFriction, Pressed, Slid, SlipLine, Variation, add_block};
use nalgebra::{Matrix3, Vector3};
use stoss_geometry::{ClosestPair, PairKind};

/// A term: its weight with the sign of the piece, and where it is nearest at the start and at the end, each over four of the points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    pub weight: f64,
    pub slots_n: [usize; 4],
    pub start: ClosestPair,
    pub slots: [usize; 4],
    pub end: ClosestPair,
}

/// What a contact does in a step, but for its gradients.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Energy at the end.
    pub energy: f64,
    /// What the damping takes.
    pub dissipated: f64,
    pub slid: Option<Slid>,
}

/// The law of friction and the places of the four points whose spin is no slip.
pub(super) type Law<'a> = (&'a PairFriction<'a>, (PairKind, [usize; 4]));

/// The points of a contact, each once and the point itself first, and what its force is made of. It is used for one contact after the other.
#[derive(Debug, Default)]
pub(super) struct Joint {
    pub points: Vec<u32>,
    pub terms: Vec<Term>,
    pub x_n: Vec<Vector3<f64>>,
    pub x: Vec<Vector3<f64>>,
    /// Gradients of the barrier and of friction, to be added to a residual, and the derivative of their sum: `3 i + k` is component `k` of point `i`.
    pub barrier: Vec<Vector3<f64>>,
    pub friction: Vec<Vector3<f64>>,
    pub tangent: Vec<f64>,
    /// Where forces act, and the motion in the step.
    acting: Vec<Vector3<f64>>,
    moved: Vec<Vector3<f64>>,
    c_n: Vec<f64>,
    c: Vec<f64>,
    /// Weights of the common pattern, and its normal force.
    weights: Vec<f64>,
    normal: Vector3<f64>,
    directions: Vec<[f64; 2]>,
    moves: Vec<[Vector3<f64>; 2]>,
    d_lambda: Vec<Vector3<f64>>,
    d_r: Vec<Matrix3<f64>>,
    /// Derivatives of the sum of the factors `beta`, of `beta c` (of the common weights in the end) and of the normal force.
    d_beta: Vec<Vector3<f64>>,
    d_c: Vec<Vector3<f64>>,
    d_normal: Vec<Matrix3<f64>>,
}

fn refill<T: Clone>(list: &mut Vec<T>, count: usize, value: T) {
    list.clear();
    list.resize(count, value);
}

impl Joint {
    /// The place of a point in the list; at its end, if it is not there.
    pub fn slot(&mut self, point: u32) -> usize {
        self.points.iter().position(|p| *p == point).unwrap_or_else(|| {
            self.points.push(point);
            self.points.len() - 1
        })
    }

    /// Positions of the points at the start and at the iterate.
    pub fn place(&mut self, x_n: &[Vector3<f64>], x: &[Vector3<f64>]) {
        let Self { points, x_n: of_n, x: of, .. } = self;
        for (list, x) in [(of_n, x_n), (of, x)] {
            list.clear();
            list.extend(points.iter().map(|&p| x[p as usize]));
        }
    }

    /// The forces of the terms between both states, or, `at_end`, at the second one.
    pub fn act(&mut self, layer: &Layer, at_end: bool, friction: Option<Law<'_>>, wants_tangent: bool) -> Sums {
        let n = self.x.len();
        let share = if at_end { 1.0 } else { 0.5 };
        let varied = wants_tangent && friction.is_some();
        self.clear(at_end, wants_tangent, varied);
        let mut sums = Sums::default();
        let mut beta_sum = 0.0;
        let mut terms = std::mem::take(&mut self.terms);
        for term in &terms {
            let (d_n, d) = (term.start.distance_squared, term.end.distance_squared);
            let [psi, slope, curvature] = layer.evaluate(d);
            let of_layer = match at_end {
                true => LayerStep { b: slope, slope: curvature, dissipated: 0.0 },
                false => layer.step(d_n, d),
            };
            sums.energy += term.weight * psi;
            sums.dissipated += term.weight * of_layer.dissipated;
            if of_layer.b == 0.0 && of_layer.slope == 0.0 {
                continue;
            }
            beta_sum += self.add(term, &of_layer, at_end, wants_tangent, varied);
        }
        terms.clear();
        self.terms = terms;
        let Some((law, base)) = friction.filter(|_| beta_sum > 0.0) else { return sums };
        self.weights.iter_mut().for_each(|c| *c /= beta_sum);
        if varied {
            for i in 0..n {
                for j in 0..n {
                    let d = &mut self.d_c[i * n + j];
                    *d = (*d - self.d_beta[j] * self.weights[i]) / beta_sum;
                }
            }
        }
        let variation = Variation { share, weights: &self.d_c, normal: &self.d_normal };
        let pressed = Pressed { normal: self.normal, weights: &self.weights, x: &self.acting, dx: &self.moved, base };
        let tangent = varied.then_some((&variation, &mut self.tangent[..]));
        sums.slid = Some(pressed.friction(law, &mut self.friction, tangent));
        sums
    }

    /// Friction of the last [`Self::act`] along a motion of the points by `d`.
    pub fn along(&self, (law, base): Law<'_>, d: &[Vector3<f64>]) -> Option<SlipLine> {
        Pressed { normal: self.normal, weights: &self.weights, x: &self.acting, dx: &self.moved, base }.along(law, d)
    }

    fn clear(&mut self, at_end: bool, wants_tangent: bool, varied: bool) {
        let Self { x_n, x, acting, moved, .. } = self;
        let n = x.len();
        acting.clear();
        moved.clear();
        moved.extend(x.iter().zip(&*x_n).map(|(x, x_n)| x - x_n));
        match at_end {
            true => acting.extend_from_slice(x),
            false => acting.extend(x.iter().zip(&*x_n).map(|(x, x_n)| (x + x_n) * 0.5)),
        }
        let none = Vector3::zeros();
        refill(&mut self.barrier, n, none);
        refill(&mut self.friction, n, none);
        refill(&mut self.weights, n, 0.0);
        self.normal = none;
        if wants_tangent {
            refill(&mut self.tangent, 9 * n * n, 0.0);
            refill(&mut self.d_lambda, n, none);
            refill(&mut self.d_r, n, Matrix3::zeros());
        }
        if varied {
            refill(&mut self.d_beta, n, none);
            refill(&mut self.d_c, n * n, none);
            refill(&mut self.d_normal, n, Matrix3::zeros());
        }
    }

    /// Adds the force of a term; returns its part in the sum of the factors `beta = -2 w b`.
    fn add(&mut self, term: &Term, layer: &LayerStep, at_end: bool, wants_tangent: bool, varied: bool) -> f64 {
        let n = self.x.len();
        let Self { x_n, x, c_n, c, .. } = self;
        refill(c_n, n, 0.0);
        refill(c, n, 0.0);
        for i in 0..4 {
            c_n[term.slots_n[i]] += term.start.weights[i];
            c[term.slots[i]] += term.end.weights[i];
        }
        let distances = term.start.distance_squared + term.end.distance_squared;
        let ends = Ends { c_n, c, x_n, x, distances };
        let pattern = if at_end { Pattern::at_end(&ends) } else { Pattern::between(&ends) };
        let factor = 2.0 * term.weight * layer.b;
        for i in 0..n {
            let weight = pattern.weight(&ends, i);
            self.barrier[i] += pattern.r * (factor * weight);
            self.weights[i] -= factor * weight;
        }
        self.normal -= pattern.r * factor;
        if !wants_tangent {
            return -factor;
        }
        let of_end = Sensitivity::new(&term.end, &term.slots.map(|i| x[i]), &pattern.r_end);
        refill(&mut self.directions, n, [0.0; 2]);
        refill(&mut self.moves, n, [Vector3::zeros(); 2]);
        for a in 0..of_end.count {
            for (k, &slot) in term.slots.iter().enumerate() {
                self.directions[slot][a] += of_end.directions[a][k];
                self.moves[slot][a] += of_end.moves[a][k];
            }
        }
        let along = Along { directions: &self.directions, moves: &self.moves };
        pattern.differentiate(&ends, &along, &mut self.d_lambda, &mut self.d_r);
        for j in 0..n {
            let by_b = pattern.r_end * (4.0 * term.weight * layer.slope * ends.c[j]);
            for i in 0..n {
                let weight = pattern.weight(&ends, i);
                let dc = pattern.weight_gradient(&ends, &along, &self.d_lambda, i, j);
                let block = pattern.r * (by_b * weight + dc * factor).transpose() + self.d_r[j] * (factor * weight);
                add_block(&mut self.tangent, n, [i, j], &block);
                if varied {
                    self.d_c[i * n + j] -= dc * factor + by_b * weight;
                }
            }
            if varied {
                self.d_beta[j] -= by_b;
                self.d_normal[j] -= self.d_r[j] * factor + pattern.r * by_b.transpose();
            }
        }
        -factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Presliding;
    use fastrand::Rng;
    use stoss_contact::friction::Coulomb;
    use stoss_geometry::closest;

    /// A point and a fan of four triangles.
    const FAN: [[usize; 4]; 4] = [[0, 1, 2, 3], [0, 2, 3, 4], [0, 3, 4, 5], [0, 4, 5, 6]];

    fn vector(rng: &mut Rng) -> Vector3<f64> {
        Vector3::from_fn(|_, _| rng.f64() - 0.5)
    }

    fn nearest(x: &[Vector3<f64>], triangles: &[[usize; 4]]) -> ([usize; 4], ClosestPair) {
        let all = triangles.iter().map(|t| (*t, closest(PairKind::VertexTriangle, &t.map(|i| x[i]))));
        all.min_by(|a, b| a.1.distance_squared.total_cmp(&b.1.distance_squared)).unwrap()
    }

    /// One term over the fan, or two of its triangles less the edge between them.
    fn terms(x_n: &[Vector3<f64>], x: &[Vector3<f64>], by_pieces: bool) -> Vec<Term> {
        if !by_pieces {
            let ((slots_n, start), (slots, end)) = (nearest(x_n, &FAN), nearest(x, &FAN));
            return vec![Term { weight: 1.0, slots_n, start, slots, end }];
        }
        let of = |kind: PairKind, slots: [usize; 4], weight: f64| {
            let [start, end] = [x_n, x].map(|x| closest(kind, &slots.map(|i| x[i])));
            Term { weight, slots_n: slots, start, slots, end }
        };
        vec![
            of(PairKind::VertexTriangle, FAN[0], 1.0),
            of(PairKind::VertexTriangle, FAN[1], 1.0),
            of(PairKind::VertexEdge, [0, 2, 3, 2], -1.0),
        ]
    }

    fn sums(g: &[Vector3<f64>], x: &[Vector3<f64>], y: &[Vector3<f64>]) -> [f64; 3] {
        let force: Vector3<f64> = g.iter().sum();
        let moment: Vector3<f64> = (0..g.len()).map(|i| ((x[i] + y[i]) * 0.5).cross(&g[i])).sum();
        let work: f64 = (0..g.len()).map(|i| g[i].dot(&(y[i] - x[i]))).sum();
        [work, force.norm(), moment.norm()]
    }

    /// Random steps over a fan of triangles: the work is the change of the energy, the work of friction is its loss, neither has a resultant nor a moment, and the tangent is the derivative.
    #[test]
    fn patches_conserve() {
        let mut rng = Rng::with_seed(7);
        let law = Coulomb::new(0.4).unwrap();
        let stick = Presliding::Creep { slip_scale: 0.3 };
        let friction = PairFriction { law: &law, area: 1.0, step_size: 1.0, slid: 0.0, stick };
        let layer = Layer::new(1.0, 2.0);
        let psi = |d: f64| layer.evaluate(d)[0];
        let mut worst = [0.0_f64; 8];
        let (mut changed, mut kinks, mut entries, mut slid) = (0, 0, 0, 0.0_f64);
        let mut joint = Joint::default();
        for case in 0..20_000 {
            let size = 10f64.powf(-5.0 + 6.0 * f64::from(case) / 20_000.0);
            let x_n: Vec<Vector3<f64>> = (0..7).map(|_| vector(&mut rng)).collect();
            let x: Vec<Vector3<f64>> = x_n.iter().map(|p| p + vector(&mut rng) * size).collect();
            let by_pieces = case % 2 == 1;
            let base = (PairKind::VertexTriangle, nearest(&x_n, &FAN).0);
            let all = terms(&x_n, &x, by_pieces);
            changed += usize::from(all[0].slots != all[0].slots_n);
            let change: f64 =
                all.iter().map(|t| t.weight * (psi(t.end.distance_squared) - psi(t.start.distance_squared))).sum();
            let scale =
                all.iter().map(|t| psi(t.end.distance_squared).max(psi(t.start.distance_squared))).fold(1e-3, f64::max);
            let mut act = |x: &[Vector3<f64>], terms: Vec<Term>, at_end: bool, wants: bool| {
                (joint.terms, joint.x_n, joint.x) = (terms, x_n.clone(), x.to_vec());
                let of = joint.act(&layer, at_end, Some((&friction, base)), wants);
                (of, joint.barrier.clone(), joint.friction.clone(), joint.tangent.clone())
            };
            let (of, barrier, by_friction, _) = act(&x, all.clone(), false, false);
            let largest = barrier.iter().map(Vector3::norm).fold(1e-3, f64::max);
            let [work, resultant, moment] = sums(&barrier, &x_n, &x);
            worst[0] = worst[0].max((work - change).abs() / scale.max(largest * size.max(1e-2)));
            worst[1] = worst[1].max(resultant / largest);
            worst[2] = worst[2].max(moment / largest);
            if let Some(of) = of.slid {
                let [work, resultant, moment] = sums(&by_friction, &x_n, &x);
                worst[3] = worst[3].max((work - of.work).abs() / largest);
                worst[4] = worst[4].max(resultant / largest);
                worst[5] = worst[5].max(moment / largest);
                assert!(of.work >= -1e-12 * largest, "{case}");
                slid = slid.max(of.work / largest);
            }
            // The tangent by differences, away from kinks.
            let is_apart = all.iter().all(|t| t.end.distance_squared > 0.01 && t.start.distance_squared > 0.01);
            if (case / 2) % 40 != 0 || !is_apart || size > 3.0 {
                continue;
            }
            let step = 1e-6;
            for (which, at_end) in [(6, false), (7, true)] {
                let tangent = act(&x, all.clone(), at_end, true).3;
                let most = tangent.iter().fold(1e-3_f64, |most, v| most.max(v.abs()));
                for column in 0..21 {
                    let mut at = |sign: f64| {
                        let mut y = x.clone();
                        y[column / 3][column % 3] += sign * step;
                        let terms = terms(&x_n, &y, by_pieces);
                        let is_same = terms.iter().zip(&all).all(|(t, u)| {
                            t.slots == u.slots && (0..4).all(|i| (t.end.weights[i] == 0.0) == (u.end.weights[i] == 0.0))
                        });
                        let (_, barrier, friction, _) = act(&y, terms, at_end, false);
                        is_same.then(|| barrier.iter().zip(&friction).map(|(a, b)| a + b).collect::<Vec<_>>())
                    };
                    let (Some(ahead), Some(behind)) = (at(1.0), at(-1.0)) else { continue };
                    for row in 0..21 {
                        let difference = (ahead[row / 3][row % 3] - behind[row / 3][row % 3]) / (2.0 * step);
                        let error = (tangent[row * 21 + column] - difference).abs() / most;
                        entries += 1;
                        if error > 1e-5 {
                            kinks += 1;
                        } else {
                            worst[which] = worst[which].max(error);
                        }
                    }
                }
            }
        }
        println!("{changed} to another triangle; {worst:?}; {kinks} of {entries} entries at kinks; {slid}");
        assert!(changed > 1000 && slid > 0.01 && entries > 100_000);
        // Work and resultant of both, moments by lengths of up to ten.
        assert!(worst[0] < 1e-12 && worst[3] < 1e-13, "{worst:?}");
        assert!(worst[1] < 1e-13 && worst[4] < 1e-13 && worst[2] < 1e-12 && worst[5] < 1e-12, "{worst:?}");
        assert!(kinks * 1000 < entries, "{kinks} of {entries}");
    }

    /// A flat surface of squares, each cut along one of its diagonals.
    fn flat(rng: &mut Rng, n: usize) -> (Vec<Vector3<f64>>, Vec<[usize; 4]>) {
        let mut x = vec![Vector3::zeros()];
        x.extend((0..=n).flat_map(|j| (0..=n).map(move |i| Vector3::new(i as f64, j as f64, 0.0))));
        let mut triangles = Vec::new();
        for j in 0..n {
            for i in 0..n {
                let a = 1 + i + (n + 1) * j;
                let [a, b, c, d] = [a, a + 1, a + n + 2, a + n + 1];
                triangles.extend(if rng.bool() { [[0, a, b, c], [0, a, c, d]] } else { [[0, a, b, d], [0, b, c, d]] });
            }
        }
        (x, triangles)
    }

    /// Over a flat surface there is no force along it, whatever the way in the step, however many edges are passed, also where the surface is stretched; the normal force is the divided difference in the gap.
    #[test]
    fn a_flat_surface_does_not_push_along_itself() {
        let mut rng = Rng::with_seed(2);
        let n = 8;
        let (surface, triangles) = flat(&mut rng, n);
        let layer = Layer::new(1.0, 1.0);
        let psi = |d: f64| layer.evaluate(d)[0];
        let (mut joint, mut changed, mut worst) = (Joint::default(), 0, [0.0_f64; 2]);
        for case in 0..3000 {
            let inside = |rng: &mut Rng| 0.5 + (n as f64 - 1.0) * rng.f64();
            let start = Vector3::new(inside(&mut rng), inside(&mut rng), 0.05 + 0.85 * rng.f64());
            let way = 10f64.powf(-3.0 + 3.3 * rng.f64());
            let moved = Vector3::new((rng.f64() - 0.5) * way, (rng.f64() - 0.5) * way, 0.08 * (rng.f64() - 0.5));
            let end = Vector3::new(
                (start.x + moved.x).clamp(0.0, n as f64),
                (start.y + moved.y).clamp(0.0, n as f64),
                start.z + moved.z,
            );
            let (mut x_n, mut x) = (surface.clone(), surface.clone());
            (x_n[0], x[0]) = (start, end);
            if case % 2 == 1 {
                // The same stretch in all directions: what lies in one direction goes on to do so.
                x[1..].iter_mut().for_each(|p| *p *= 1.02);
            }
            let ((slots_n, from), (slots, to)) = (nearest(&x_n, &triangles), nearest(&x, &triangles));
            changed += usize::from(slots != slots_n);
            joint.terms = vec![Term { weight: 1.0, slots_n, start: from, slots, end: to }];
            (joint.x_n, joint.x) = (x_n, x);
            joint.act(&layer, false, None, false);
            let g = joint.barrier[0];
            let gaps = [start.z, joint.x[0].z];
            let exact = (psi(gaps[1] * gaps[1]) - psi(gaps[0] * gaps[0])) / (gaps[1] - gaps[0]);
            worst[0] = worst[0].max(g.xy().norm() / g.z.abs());
            worst[1] = worst[1].max((g.z / exact - 1.0).abs());
        }
        println!("{changed} to another triangle: {worst:?}");
        assert!(changed > 500 && worst[0] < 1e-12 && worst[1] < 1e-9, "{worst:?}");
    }
}
