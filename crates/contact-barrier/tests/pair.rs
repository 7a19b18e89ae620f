//! Identities of the force of a pair over all kinds, features and changes of features, and its tangents against central differences.

use fastrand::Rng;
use nalgebra::{Rotation3, Vector3};
use stoss_contact_barrier::{EdgeMollifier, Layer, PairStart, PairTerm, Tangent};
use stoss_geometry::{PairFeature, PairKind, closest};

mod slip;

type Points = [Vector3<f64>; 4];

const KINDS: [PairKind; 4] =
    [PairKind::VertexTriangle, PairKind::EdgeEdge, PairKind::VertexEdge, PairKind::VertexVertex];
const LAYER: Layer = Layer::new(2.0, 1.0);
const WEIGHT: f64 = 0.7;
const THRESHOLD: f64 = 0.3;

fn term(kind: PairKind) -> PairTerm {
    let mollifier = (kind == PairKind::EdgeEdge).then(|| EdgeMollifier::new(THRESHOLD));
    PairTerm { kind, weight: WEIGHT, mollifier }
}

fn vector(random: &mut Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| 2.0 * random.f64() - 1.0)
}

/// Two states of a pair, nearer than the layer at one of them at least, and farther than a hundredth of it. Edges are nearly parallel in a third of the cases.
fn states(random: &mut Rng, kind: PairKind) -> (Points, Points) {
    loop {
        let size = [0.3, 1.0][random.usize(..2)];
        let mut start: Points = std::array::from_fn(|_| vector(random) * size);
        if kind == PairKind::EdgeEdge && random.usize(..3) == 0 {
            start[3] = start[2] + (start[1] - start[0]) * (2.0 * random.f64() - 1.0) + vector(random) * 0.05;
        }
        let motion = [1e-9, 1e-6, 1e-3, 1e-2, 0.1, 1.0][random.usize(..6)];
        let end = start.map(|x| x + vector(random) * motion);
        let [d_n, d] = [&start, &end].map(|x| closest(kind, x).distance_squared.sqrt());
        if d_n.min(d) > 1e-2 && d_n.min(d) < LAYER.thickness() {
            return (start, end);
        }
    }
}

fn largest(v: &Points) -> f64 {
    v.iter().map(|v| v.norm()).fold(0.0, f64::max)
}

#[test]
fn work_is_the_change_of_energy_and_momenta_stay() {
    let mut random = Rng::with_seed(1);
    let (mut changes, mut features) = ([0; 4], std::collections::HashSet::new());
    for k in 0..40_000 {
        let kind = KINDS[k % 4];
        let (x_n, x) = states(&mut random, kind);
        let start = PairStart::new(term(kind), LAYER, &x_n);
        let force = start.force(&x, None);
        let end = closest(kind, &x);
        changes[k % 4] += usize::from(end.feature() != start.closest().feature());
        features.insert(format!("{:?} {:?}", kind, end.feature()));
        let scale = largest(&force.gradient);
        // What round-off of the squared distances (times the length of the pair) makes of the energies, and what it makes of the work.
        let [psi, slope, _] =
            LAYER.evaluate(start.closest().distance_squared.min(end.distance_squared)).map(|v| WEIGHT * v.abs());
        let tolerance = 1e-14 * (start.energy() + force.energy + slope) + 1e-15 * scale;
        let work: f64 = (0..4).map(|i| force.gradient[i].dot(&(x[i] - x_n[i]))).sum();
        let change = force.energy - start.energy();
        assert!((work - change).abs() <= tolerance, "{kind:?} {work:e} {change:e} {x_n:?} {x:?}");
        let resultant: Vector3<f64> = force.gradient.iter().sum();
        assert!(resultant.norm() <= 1e-14 * scale, "{kind:?}");
        let moment: Vector3<f64> = (0..4).map(|i| ((x[i] + x_n[i]) * 0.5).cross(&force.gradient[i])).sum();
        let lengths =
            [&x_n, &x].map(|x| (x[1] - x[0]).norm() * (x[3] - x[2]).norm()).into_iter().fold(0.0, f64::max).powi(2);
        // The gradient of the factor of nearly parallel edges is a difference of longer vectors.
        let cancelled = if kind == PairKind::EdgeEdge { 4e-15 * psi / THRESHOLD * lengths } else { 0.0 };
        assert!(moment.norm() <= 2e-14 * scale + cancelled, "{kind:?} {} {scale} {x_n:?} {x:?}", moment.norm());
        // The other way round in time: the same forces.
        let back = PairStart::new(term(kind), LAYER, &x).force(&x_n, None);
        let difference: Points = std::array::from_fn(|i| back.gradient[i] - force.gradient[i]);
        assert!(largest(&difference) <= 1e-9 * scale, "{kind:?} {} {scale}", largest(&difference));
        assert!((back.energy - start.energy()).abs() <= tolerance);
    }
    assert!(changes[0] > 500 && changes[1] > 500 && changes[2] > 200, "{changes:?}");
    // Vertex and triangle: 1 inside, 3 edges, 3 corners; two edges: 1, 4, 4; vertex and edge: 1, 2; two vertices.
    assert_eq!(features.len(), 7 + 9 + 3 + 1, "{features:?}");
}

#[test]
fn a_damped_layer_takes_what_it_says() {
    let mut random = Rng::with_seed(5);
    let (mut taken, mut released) = (0, 0);
    for k in 0..40_000 {
        let kind = KINDS[k % 4];
        let (x_n, x) = states(&mut random, kind);
        let damping = [1e-3, 0.1, 1.0, 30.0][random.usize(..4)];
        let start = PairStart::new(term(kind), LAYER.damped(damping), &x_n);
        let (force, undamped) = (start.force(&x, None), PairStart::new(term(kind), LAYER, &x_n).force(&x, None));
        assert!(force.dissipated >= 0.0 && undamped.dissipated == 0.0 && force.energy == undamped.energy);
        let scale = largest(&force.gradient);
        let (d_n, d) = (start.closest().distance_squared, closest(kind, &x).distance_squared);
        let [psi, slope, _] = LAYER.evaluate(d_n.min(d)).map(|v| WEIGHT * v.abs());
        let terms: f64 = (0..4).map(|i| force.gradient[i].norm() * (x[i] - x_n[i]).norm()).sum();
        // As without damping: round-off of the squared distances, times the slope of the energy and of the loss.
        let curvature = WEIGHT * damping * LAYER.evaluate(d_n.min(d))[2] * (d - d_n).abs();
        let tolerance = 1e-14 * (start.energy() + force.energy + slope + curvature + terms) + 1e-15 * scale;
        let work: f64 = (0..4).map(|i| force.gradient[i].dot(&(x[i] - x_n[i]))).sum();
        let left = work - (force.energy - start.energy()) - force.dissipated;
        assert!(left.abs() <= tolerance, "{kind:?} {left:e} {tolerance:e} {damping} {x_n:?} {x:?}");
        let resultant: Vector3<f64> = force.gradient.iter().sum();
        assert!(resultant.norm() <= 1e-14 * scale, "{kind:?}");
        let moment: Vector3<f64> = (0..4).map(|i| ((x[i] + x_n[i]) * 0.5).cross(&force.gradient[i])).sum();
        let lengths =
            [&x_n, &x].map(|x| (x[1] - x[0]).norm() * (x[3] - x[2]).norm()).into_iter().fold(0.0, f64::max).powi(2);
        let cancelled = if kind == PairKind::EdgeEdge { 4e-15 * psi / THRESHOLD * lengths } else { 0.0 };
        assert!(moment.norm() <= 2e-14 * scale + cancelled, "{kind:?} {} {scale}", moment.norm());
        taken += usize::from(force.dissipated > 0.1 * (start.energy() + force.energy));
        // All of the energy is taken where the viscosity would pull.
        released += usize::from(kind == PairKind::VertexTriangle && scale == 0.0 && start.energy() > 0.0);
    }
    assert!(taken > 1000 && released > 100, "{taken} {released}");
}

/// A point passes over a plane that is stretched in the step, by a way of up to twenty gaps: nothing acts along the plane, and the normal force is the divided difference in the gap.
#[test]
fn a_stretched_plane_has_no_force_along_it() {
    let plane = [[-9.0, -9.0], [9.0, -9.0], [0.0, 12.0]];
    for (way, gap, stretch) in [(0.02, 0.001, 1e-3), (0.02, 0.001, 1e-2), (0.001, 0.001, 1e-2), (0.02, 0.01, 0.1)] {
        let layer = Layer::new(1.0, 2.0 * gap);
        let at = |side: f64| {
            let corner = |k: usize| Vector3::new(plane[k][0] * (1.0 + 0.5 * side * stretch), plane[k][1], 0.0);
            [Vector3::new(0.5 * side * way, 0.0, gap * (1.0 + 0.01 * side)), corner(0), corner(1), corner(2)]
        };
        let (x_n, x) = (at(-1.0), at(1.0));
        let term = PairTerm { kind: PairKind::VertexTriangle, weight: WEIGHT, mollifier: None };
        let force = PairStart::new(term, layer, &x_n).force(&x, None).gradient[0];
        assert!(force.x.hypot(force.y) <= 1e-12 * force.z.abs(), "{way} {gap} {stretch}: {force}");
        let [psi_n, psi] = [&x_n, &x].map(|x| layer.evaluate(x[0].z * x[0].z)[0]);
        let normal = WEIGHT * (psi - psi_n) / (x[0].z - x_n[0].z);
        assert!((force.z - normal).abs() <= 1e-10 * normal.abs(), "{} {normal}", force.z);
    }
}

#[test]
fn no_motion_gives_the_gradient_at_the_state() {
    let mut random = Rng::with_seed(2);
    for k in 0..4000 {
        let kind = KINDS[k % 4];
        let (x, _) = states(&mut random, kind);
        let here = term(kind).at_state(&LAYER, &x, None);
        let force = PairStart::new(term(kind), LAYER, &x).force(&x, None);
        let difference: Points = std::array::from_fn(|i| here.gradient[i] - force.gradient[i]);
        assert!(largest(&difference) <= 1e-12 * largest(&here.gradient));
        assert_eq!(here.energy, force.energy);
    }
}

#[test]
fn forces_turn_with_the_frame() {
    let mut random = Rng::with_seed(3);
    for k in 0..2000 {
        let kind = KINDS[k % 4];
        let (x_n, x) = states(&mut random, kind);
        let (turn, shift) = (Rotation3::new(vector(&mut random) * 3.0), vector(&mut random));
        let moved = |x: &Points| x.map(|x| turn * x + shift);
        let force = PairStart::new(term(kind), LAYER, &x_n).force(&x, None);
        let other = PairStart::new(term(kind), LAYER, &moved(&x_n)).force(&moved(&x), None);
        let difference: Points = std::array::from_fn(|i| other.gradient[i] - turn * force.gradient[i]);
        assert!(largest(&difference) <= 1e-8 * largest(&force.gradient), "{kind:?} {}", largest(&difference));
    }
}

/// Whether nothing that has a kink changes within `s` of `x`: features, the edge of the layer, the edge of the range of parallel edges.
fn is_smooth(kind: PairKind, x: &Points, s: f64) -> bool {
    let kinks = |x: &Points| {
        let pair = closest(kind, x);
        let crossing = (x[1] - x[0]).cross(&(x[3] - x[2])).norm_squared();
        (pair.feature(), LAYER.is_inside(pair.distance_squared), kind == PairKind::EdgeEdge && crossing < THRESHOLD)
    };
    let here = kinks(x);
    (0..12).all(|j| [-3.0, 3.0].iter().all(|f| kinks(&moved(x, j, f * s)) == here))
}

fn moved(x: &Points, j: usize, s: f64) -> Points {
    let mut x = *x;
    x[j / 3][j % 3] += s;
    x
}

/// Central differences of the fourth order.
fn central(x: &Points, s: f64, gradient: impl Fn(&Points) -> Points) -> Tangent {
    let mut tangent = [[0.0; 12]; 12];
    for j in 0..12 {
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|part| gradient(&moved(x, j, part * s)));
        for i in 0..12 {
            let of = |g: &Points| g[i / 3][i % 3];
            tangent[i][j] = (8.0 * (of(&c) - of(&b)) - (of(&d) - of(&a))) / (12.0 * s);
        }
    }
    tangent
}

fn error(a: &Tangent, b: &Tangent) -> (f64, f64) {
    let all = || a.iter().flatten().zip(b.iter().flatten());
    (all().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max), all().map(|(_, b)| b.abs()).fold(0.0, f64::max))
}

#[test]
fn tangents_are_derivatives() {
    let mut random = Rng::with_seed(4);
    let s = 1e-6;
    let mut checked = std::collections::HashMap::new();
    let mut changed = 0;
    for k in 0..12_000 {
        let kind = KINDS[k % 4];
        let (x_n, x) = states(&mut random, kind);
        let [start, end] = [&x_n, &x].map(|x| closest(kind, x));
        // Central differences need distances and angles that are large against their step.
        if end.distance_squared.min(start.distance_squared) < 0.01
            || !is_smooth(kind, &x, s)
            || near_degenerate(kind, &x)
        {
            continue;
        }
        // Between equal patterns the balance has the scale of the motion.
        let motion = (0..4).map(|i| (x[i] - x_n[i]).norm()).fold(0.0, f64::max);
        let shift = (0..4).map(|i| (end.weights[i] - start.weights[i]).abs()).fold(0.0, f64::max);
        if motion < 1e-3 && motion > 1e-8 || motion >= 1e-3 && shift > 0.0 && shift < 1e-7 {
            continue;
        }
        // Every other time with a viscous layer, away from the state where it ceases to push.
        let layer = LAYER.damped(if k % 8 < 4 { 0.0 } else { 10f64.powf(2.0 * random.f64() - 1.5) });
        let pair = PairStart::new(term(kind), layer, &x_n);
        let pushes = |x: &Points| largest(&pair.force(x, None).gradient) > 0.0;
        if (0..12).any(|j| pushes(&moved(&x, j, 2.0 * s)) != pushes(&moved(&x, j, -2.0 * s))) {
            continue;
        }
        let mut tangent = [[f64::NAN; 12]; 12];
        let force = pair.force(&x, Some(&mut tangent));
        assert_eq!(force, pair.force(&x, None));
        let (difference, scale) = error(&tangent, &central(&x, s, |x| pair.force(x, None).gradient));
        if motion >= 1e-3 {
            assert!(difference <= 1e-5 * scale + 1e-8, "{kind:?} {motion} {difference:e} {scale:e} {x_n:?} {x:?}");
            changed += usize::from(start.feature() != end.feature());
        }
        // At one state: the second derivative, symmetric.
        let here = term(kind).at_state(&LAYER, &x, Some(&mut tangent));
        let (difference, scale) = error(&tangent, &central(&x, s, |x| term(kind).at_state(&LAYER, x, None).gradient));
        assert!(difference <= 1e-6 * scale + 1e-8, "{kind:?} {difference:e} {scale:e} {x:?}");
        for i in 0..12 {
            for j in 0..12 {
                assert!((tangent[i][j] - tangent[j][i]).abs() <= 1e-12 * scale);
            }
            let energy = |x: &Points| term(kind).at_state(&LAYER, x, None).energy;
            let slope = (energy(&moved(&x, i, s)) - energy(&moved(&x, i, -s))) / (2.0 * s);
            assert!(
                (slope - here.gradient[i / 3][i % 3]).abs() <= 1e-7 * (largest(&here.gradient) + here.energy) + 1e-9
            );
        }
        *checked.entry(format!("{:?} {:?}", kind, end.feature())).or_insert(0) += 1;
    }
    assert!(changed > 300, "{changed}");
    assert!(checked.len() == 20 && checked.values().all(|&n| n > 10), "{checked:?}");
}

/// Whether free directions are short or nearly parallel, so that closest points move much faster than the pair.
fn near_degenerate(kind: PairKind, x: &Points) -> bool {
    let pair = closest(kind, x);
    let along: Vec<Vector3<f64>> =
        pair.free_directions().as_slice().iter().map(|b| stoss_geometry::combine(b, x)).collect();
    let short = along.iter().any(|t| t.norm() < 0.1);
    let parallel = matches!(pair.feature(), PairFeature::VertexTriangle | PairFeature::EdgeEdge)
        && along[0].cross(&along[1]).norm() < 0.1 * along[0].norm() * along[1].norm();
    short || parallel
}

#[test]
fn nothing_acts_outside_of_the_layer() {
    let x = [Vector3::z() * 1.5, Vector3::zeros(), Vector3::x(), Vector3::y()];
    for kind in [PairKind::VertexTriangle, PairKind::VertexEdge, PairKind::VertexVertex] {
        let mut tangent = [[f64::NAN; 12]; 12];
        let force = PairStart::new(term(kind), LAYER, &x).force(&x, Some(&mut tangent));
        assert!(force.energy == 0.0 && force.gradient == [Vector3::zeros(); 4] && tangent == [[0.0; 12]; 12]);
        // A pair that leaves the layer in the step pushes, and gives its energy up.
        let near = x.map(|x| x * 0.5);
        let start = PairStart::new(term(kind), LAYER, &near);
        let leaving = start.force(&x, None);
        assert!(leaving.energy == 0.0 && leaving.gradient[0].z < 0.0 && start.energy() > 0.0);
    }
}
