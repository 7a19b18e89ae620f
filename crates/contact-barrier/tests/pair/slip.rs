//! Friction: both momenta, work and loss, rigid motions, Coulomb's bound, and tangents against central differences.

use super::*;
use stoss_contact::friction::{Coefficient, FrictionLaw, Sliding};
use stoss_contact_barrier::{PairFriction, Presliding, StepForce};

const SLIP_SCALE: f64 = 0.05;
const MU: f64 = 0.4;
const CREEP: Presliding = Presliding::Creep { slip_scale: SLIP_SCALE };
const LAW: PairFriction<'static> =
    PairFriction { law: &Constant(MU), area: 0.5, step_size: 0.1, slid: 0.3, stick: CREEP };

/// Coulomb's law.
#[derive(Debug)]
struct Constant(f64);

impl FrictionLaw for Constant {
    fn name(&self) -> &str {
        "constant"
    }
    fn coefficient(&self, _at: &Sliding) -> Coefficient {
        Coefficient { value: self.0, ..Coefficient::default() }
    }
}

/// A coefficient of at most [`MU`] that falls with the pressure and with the speed of slip; without stick it begins at zero.
#[derive(Debug)]
struct Falling {
    sticks: bool,
}

impl FrictionLaw for Falling {
    fn name(&self) -> &str {
        "falling"
    }
    fn coefficient(&self, at: &Sliding) -> Coefficient {
        let (v, rate) = (at.slip / at.step_size, 1.0 / at.step_size);
        let (by_pressure, falls) = (MU / (1.0 + at.pressure), 1.0 / (1.0 + at.pressure));
        let (of_speed, slope) = match self.sticks {
            true => ((1.0 + v).recip(), -(1.0 + v).powi(-2)),
            false => (v / (1.0 + v * v), (1.0 - v * v) / (1.0 + v * v).powi(2)),
        };
        Coefficient {
            value: by_pressure * of_speed,
            d_pressure: -by_pressure * falls * of_speed,
            d_slip: by_pressure * slope * rate,
        }
    }
    fn sticks(&self) -> bool {
        self.sticks
    }
}

/// A constant coefficient, one that depends on pressure and speed, and a law without stick.
const LAWS: [PairFriction<'static>; 3] = [
    LAW,
    PairFriction { law: &Falling { sticks: true }, ..LAW },
    PairFriction { law: &Falling { sticks: false }, stick: Presliding::Never, ..LAW },
];
const TOUCHING: [PairKind; 2] = [PairKind::VertexTriangle, PairKind::EdgeEdge];

/// A pair of the size 1 with a distance of one to a thousandth of the layer at the start, and its motion. One in four is nearly or exactly degenerate: parallel edges, a triangle close to a line.
fn pressed(random: &mut Rng, kind: PairKind) -> (Points, Points) {
    loop {
        let mut x: Points = std::array::from_fn(|_| vector(random));
        if random.usize(..4) == 0 {
            let off = vector(random) * [0.0, 1e-12, 1e-8, 1e-4, 1e-2][random.usize(..5)];
            x[3] = match kind {
                PairKind::EdgeEdge => x[2] + (x[1] - x[0]) * (2.0 * random.f64() - 1.0) + off,
                _ => x[1] + (x[2] - x[1]) * (4.0 * random.f64() - 2.0) + off,
            };
        }
        let pair = closest(kind, &x);
        let r = stoss_geometry::combine(&pair.weights, &x);
        let distance = LAYER.thickness() * 10f64.powf(-3.0 * random.f64());
        if r.norm() < 1e-3 {
            continue;
        }
        // Along the shortest way the closest points stay.
        let shift = r * (distance / r.norm() - 1.0);
        (0..kind.first_count()).for_each(|i| x[i] += shift);
        let motion = 10f64.powf(-3.0 * random.f64());
        let end = x.map(|x| x + vector(random) * motion);
        if closest(kind, &end).distance_squared > 1e-8 {
            return (x, end);
        }
    }
}

fn start(kind: PairKind, damping: f64, x_n: &Points) -> PairStart {
    PairStart::new(term(kind), LAYER.damped(damping), x_n)
}

/// What holds for any friction in any step, with the positions that the moment is about.
fn check(kind: PairKind, force: &StepForce, x_n: &Points, x: &Points, about: &Points) {
    let friction = &force.friction;
    let g = &friction.gradient;
    let scale = largest(g);
    assert!(scale.is_finite());
    let resultant: Vector3<f64> = g.iter().sum();
    assert!(resultant.norm() <= 1e-15 * scale, "{kind:?} {:e} {scale:e}", resultant.norm());
    let center = about.iter().sum::<Vector3<f64>>() / 4.0;
    let moment: Vector3<f64> = (0..4).map(|i| (about[i] - center).cross(&g[i])).sum();
    let size = (0..4).map(|i| (about[i] - center).norm()).fold(0.0, f64::max);
    // The moment to be carried is of this length; near a degenerate pair it loses the digits of the sine at which friction fades.
    let carried = 4.0 * friction.tangential_force.max(MU * friction.normal_force) * size;
    let lost = if sine(kind, about) > 0.1 { 1e-14 } else { 1e-12 };
    assert!(moment.norm() <= 1e-14 * scale * size + lost * carried, "{kind:?} {:e} {scale} {about:?}", moment.norm());
    let (mut work, mut terms) = (0.0, 0.0);
    for i in 0..4 {
        work += g[i].dot(&(x[i] - x_n[i]));
        terms += g[i].norm() * (x[i] - x_n[i]).norm();
    }
    assert!((work - friction.work).abs() <= 1e-13 * terms, "{kind:?} {work:e} {:e} {terms:e}", friction.work);
    // Of friction that creeps, which stores nothing.
    assert!(friction.work >= 0.0 || friction.stored > 0.0);
    assert!(friction.tangential_force <= MU * friction.normal_force * (1.0 + 1e-14));
    let on_first: Vector3<f64> = g[..kind.first_count()].iter().sum();
    assert!((on_first.norm() - friction.tangential_force).abs() <= 1e-13 * scale);
}

/// How far from degenerate the primitives of a pair are.
fn sine(kind: PairKind, x: &Points) -> f64 {
    let (u, v) = match kind {
        PairKind::EdgeEdge => (x[1] - x[0], x[3] - x[2]),
        _ => (x[2] - x[1], x[3] - x[1]),
    };
    u.cross(&v).norm() / (u.norm() * v.norm())
}

#[test]
fn friction_takes_energy_and_keeps_both_momenta() {
    let mut random = Rng::with_seed(11);
    let (mut acting, mut full, mut features) = (0, 0, std::collections::HashSet::new());
    for k in 0..40_000 {
        let kind = TOUCHING[k % 2];
        let (x_n, x) = pressed(&mut random, kind);
        let damping = if random.bool() { 0.0 } else { 0.1 };
        let start = start(kind, damping, &x_n);
        let law = LAWS[random.usize(..3)];
        let force = start.step(&x, Some(&law), None);
        assert_eq!(force.barrier, start.force(&x, None));
        let middle: Points = std::array::from_fn(|i| (x_n[i] + x[i]) * 0.5);
        check(kind, &force, &x_n, &x, &middle);
        // The normal force is the force on the first primitive, damped as it is (the gradient of the factor of parallel edges has no resultant there); friction is across it.
        let first = kind.first_count();
        let [normal, friction]: [Vector3<f64>; 2] =
            [&force.barrier.gradient, &force.friction.gradient].map(|g| g[..first].iter().sum());
        let size = largest(&force.barrier.gradient).max(normal.norm());
        assert!((normal.norm() - force.friction.normal_force).abs() <= 1e-13 * size, "{kind:?}");
        // What is left of the motion along the normal, where the slip is small against it.
        let motion = (0..4).map(|i| (x[i] - x_n[i]).norm()).fold(0.0, f64::max);
        let left = normal.norm() * motion / force.friction.slip.max(SLIP_SCALE);
        assert!(normal.dot(&friction).abs() <= 1e-13 * size * (largest(&force.friction.gradient) + left), "{kind:?}");
        check(kind, &term(kind).at_end(&LAYER, &x_n, &x, Some(&law), None), &x_n, &x, &x);
        acting += usize::from(force.friction.work > 0.0);
        full += usize::from(force.friction.slip > SLIP_SCALE);
        features.insert(format!("{:?} {:?}", kind, closest(kind, &x).feature()));
    }
    assert!(acting > 30_000 && full > 10_000, "{acting} {full}");
    assert_eq!(features.len(), 7 + 9, "{features:?}");
}

#[test]
fn a_rigid_motion_has_no_slip() {
    let mut random = Rng::with_seed(12);
    for k in 0..10_000 {
        let kind = TOUCHING[k % 2];
        let (x_n, _) = pressed(&mut random, kind);
        let (turn, shift) = (Rotation3::new(vector(&mut random) * 1.5), vector(&mut random));
        let x = x_n.map(|x| turn * x + shift);
        let law = PairFriction { stick: Presliding::Creep { slip_scale: 1e-3 }, ..LAW };
        let friction = start(kind, 0.0, &x_n).step(&x, Some(&law), None).friction;
        let middle: Points = std::array::from_fn(|i| (x_n[i] + x[i]) * 0.5);
        let bound = if sine(kind, &middle) > 0.1 { 1e-13 } else { 1e-10 };
        assert!(friction.slip <= bound, "{kind:?} {:e} {x_n:?}", friction.slip);
        assert!(friction.work <= 1e-20 * friction.normal_force, "{:e}", friction.work);
        // At the end of a step: of second order in the angle.
        let small = Rotation3::new(vector(&mut random) * 1e-6);
        let x = x_n.map(|x| small * x + shift);
        let friction = term(kind).at_end(&LAYER, &x_n, &x, Some(&law), None).friction;
        assert!(friction.slip <= 1e-9, "{kind:?} {:e}", friction.slip);
    }
}

#[test]
fn a_vertex_that_slides_on_a_triangle() {
    // 0.1 along x at the height 0.5, over the inside: the normal force is that of the layer, the slip is the motion.
    let x_n = [[0.2, 0.3, 0.5], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from);
    let mut x = x_n;
    x[0].x += 0.1;
    let normal_force = WEIGHT * 2.0 * 1.5;
    for force in [
        start(PairKind::VertexTriangle, 0.0, &x_n).step(&x, Some(&LAW), None),
        term(PairKind::VertexTriangle).at_end(&LAYER, &x_n, &x, Some(&LAW), None),
    ] {
        let friction = force.friction;
        assert!((friction.normal_force - normal_force).abs() < 1e-14);
        assert!((friction.slip - 0.1).abs() < 1e-15);
        assert!((friction.tangential_force - 0.4 * normal_force).abs() < 1e-14);
        assert!((friction.work - 0.04 * normal_force).abs() < 1e-15);
        assert!((friction.gradient[0] - Vector3::x() * (0.4 * normal_force)).norm() < 1e-14);
    }
    // Half of the scale: three quarters of the friction.
    x[0].x = 0.2 + 0.5 * SLIP_SCALE;
    let friction = start(PairKind::VertexTriangle, 0.0, &x_n).step(&x, Some(&LAW), None).friction;
    assert!((friction.tangential_force - 0.75 * 0.4 * normal_force).abs() < 1e-13);
}

#[test]
fn where_there_is_no_friction() {
    let none = |friction: stoss_contact_barrier::FrictionForce| {
        friction.gradient == [Vector3::zeros(); 4] && friction.work == 0.0 && friction.tangential_force == 0.0
    };
    let mut random = Rng::with_seed(13);
    for k in 0..400 {
        let kind = KINDS[k % 4];
        let (x_n, x) = states(&mut random, kind);
        let pair = start(kind, 0.0, &x_n);
        // No coefficient; too few points.
        let law = if k % 4 < 2 { PairFriction { law: &Constant(0.0), ..LAW } } else { LAW };
        let (mut with, mut without) = ([[f64::NAN; 12]; 12], [[f64::NAN; 12]; 12]);
        let force = pair.step(&x, Some(&law), Some(&mut with));
        assert!(none(force.friction) && force.barrier == pair.force(&x, Some(&mut without)) && with == without);
        // All points of a triangle, or of an edge, in one place.
        let kind = TOUCHING[k % 2];
        let collapsed = |x: &Points| match kind {
            PairKind::EdgeEdge => [x[0], x[1], x[3], x[3]],
            _ => [x[0], x[3], x[3], x[3]],
        };
        let (x_n, x) = (collapsed(&x_n), collapsed(&x));
        let mut tangent = [[f64::NAN; 12]; 12];
        if closest(kind, &x_n).distance_squared > 1e-4 && closest(kind, &x).distance_squared > 1e-4 {
            assert!(none(start(kind, 0.0, &x_n).step(&x, Some(&LAW), Some(&mut tangent)).friction));
        }
    }
    // A damped layer that has let go in the step.
    let x_n = [Vector3::z() * 0.5, Vector3::zeros(), Vector3::x(), Vector3::y()];
    let x = [Vector3::new(0.1, 0.1, 0.9), Vector3::zeros(), Vector3::x(), Vector3::y()];
    let mut tangent = [[f64::NAN; 12]; 12];
    let force = start(PairKind::VertexTriangle, 30.0, &x_n).step(&x, Some(&LAW), Some(&mut tangent));
    assert!(none(force.friction) && force.barrier.dissipated > 0.0 && tangent == [[0.0; 12]; 12]);
}

#[test]
fn tangents_with_friction_are_derivatives() {
    let mut random = Rng::with_seed(14);
    let s = 1e-6;
    let (mut checked, mut full, mut faded, mut worst) = (std::collections::HashMap::new(), 0, 0, 0.0f64);
    for k in 0..40_000 {
        let kind = TOUCHING[k % 2];
        let (x_n, x) = pressed(&mut random, kind);
        let [from, end] = [&x_n, &x].map(|x| closest(kind, x));
        let motion = (0..4).map(|i| (x[i] - x_n[i]).norm()).fold(0.0, f64::max);
        let shift = (0..4).map(|i| (end.weights[i] - from.weights[i]).abs()).fold(0.0, f64::max);
        if end.distance_squared.min(from.distance_squared) < 0.01
            || !is_smooth(kind, &x, s)
            || near_degenerate(kind, &x)
            || shift > 0.0 && shift < 1e-7
        {
            continue;
        }
        let law = &LAWS[k / 2 % 3];
        let pair = start(kind, if random.bool() { 0.0 } else { 0.1 }, &x_n);
        // Friction alone: a difference of the tangents.
        let friction_tangent = |step: &dyn Fn(Option<&PairFriction<'_>>, &mut Tangent)| {
            let (mut with, mut without) = ([[f64::NAN; 12]; 12], [[f64::NAN; 12]; 12]);
            step(Some(law), &mut with);
            step(None, &mut without);
            let size = without.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
            for i in 0..12 {
                (0..12).for_each(|j| with[i][j] -= without[i][j]);
            }
            (with, size)
        };
        let here = pair.step(&x, Some(law), None);
        // The slip and the normal force are large against the step of the differences, and nothing lets go.
        let lets_go = |x: &Points| largest(&pair.force(x, None).gradient) == 0.0;
        if here.friction.normal_force < 1e-3
            || here.friction.slip < 100.0 * s
            || (0..12).any(|j| lets_go(&moved(&x, j, 2.0 * s)) || lets_go(&moved(&x, j, -2.0 * s)))
        {
            continue;
        }
        let (tangent, size) = friction_tangent(&|law, t| _ = pair.step(&x, law, Some(t)));
        let (difference, scale) = error(&tangent, &central(&x, s, |x| pair.step(x, Some(law), None).friction.gradient));
        assert!(
            difference <= 1e-5 * scale + 1e-12 * size + 1e-7,
            "{kind:?} {motion} {difference:e} {scale:e} {size:e} {x_n:?} {x:?}"
        );
        worst = worst.max(difference / scale);
        if LAYER.is_inside(end.distance_squared) {
            let at_end = |x: &Points| term(kind).at_end(&LAYER, &x_n, x, Some(law), None).friction.gradient;
            let (tangent, size) = friction_tangent(&|law, t| _ = term(kind).at_end(&LAYER, &x_n, &x, law, Some(t)));
            let (difference, scale) = error(&tangent, &central(&x, s, at_end));
            assert!(
                difference <= 1e-5 * scale + 1e-12 * size + 1e-7,
                "end {kind:?} {motion} {difference:e} {scale:e} {size:e} {x_n:?} {x:?}"
            );
            worst = worst.max(difference / scale);
        }
        *checked.entry(format!("{:?} {:?}", kind, end.feature())).or_insert(0) += 1;
        full += usize::from(here.friction.slip > SLIP_SCALE);
        let middle: Points = std::array::from_fn(|i| (x_n[i] + x[i]) * 0.5);
        faded += usize::from(sine(kind, &middle) < if kind == PairKind::EdgeEdge { 0.1 } else { 0.02 });
    }
    println!("worst {worst:e}, {checked:?}, full {full}, faded {faded}");
    assert!(checked.len() == 16 && checked.values().all(|&n| n > 10), "{checked:?}");
    assert!(full > 1000 && faded > 20, "{full} {faded}");
}

/// A spring of any stretch across the normal, and one of a stiffness at which about half of the pairs slide.
fn spring(random: &mut Rng, kind: PairKind, x_n: &Points, law: PairFriction<'static>) -> PairFriction<'static> {
    let pair = closest(kind, x_n);
    let n = stoss_geometry::combine(&pair.weights, x_n).normalize();
    let e = vector(random) * 10f64.powf(-4.0 * random.f64());
    PairFriction {
        stick: Presliding::Spring { stiffness: 10f64.powf(3.0 * random.f64()), stretch: e - n * n.dot(&e) },
        ..law
    }
}

#[test]
fn a_spring_gives_back_what_it_has_and_takes_the_rest() {
    let mut random = Rng::with_seed(15);
    let (mut sticking, mut sliding, mut given) = (0, 0, 0);
    for k in 0..40_000 {
        let kind = TOUCHING[k % 2];
        let (x_n, x) = pressed(&mut random, kind);
        let law = spring(&mut random, kind, &x_n, LAW);
        let Presliding::Spring { stiffness, stretch } = law.stick else { unreachable!() };
        let middle: Points = std::array::from_fn(|i| (x_n[i] + x[i]) * 0.5);
        for (force, about) in [
            (start(kind, 0.0, &x_n).step(&x, Some(&law), None), middle),
            (term(kind).at_end(&LAYER, &x_n, &x, Some(&law), None), x),
        ] {
            check(kind, &force, &x_n, &x, &about);
            let friction = force.friction;
            let before = 0.5 * stiffness * stretch.norm_squared();
            assert!(
                (friction.stored - 0.5 * stiffness * friction.stretch.norm_squared()).abs() <= 1e-14 * friction.stored
            );
            // A pair that opens loses its spring.
            let lost = friction.work + before - friction.stored;
            assert!(
                lost >= -1e-13 * (friction.work.abs() + before),
                "{kind:?} {lost:e} {:e} {before:e}",
                friction.work
            );
            if friction.tangential_force == 0.0 {
                continue;
            }
            let limit = MU * friction.normal_force;
            let slides = stiffness * friction.slip > limit;
            // What is carried over is what was felt.
            let felt = if slides { limit } else { stiffness * friction.slip };
            assert!((stiffness * friction.stretch.norm() - felt).abs() <= 1e-13 * felt, "{kind:?}");
            sliding += usize::from(slides);
            sticking += usize::from(!slides);
            given += usize::from(friction.work < 0.0);
        }
    }
    assert!(sticking > 10_000 && sliding > 10_000 && given > 1000, "{sticking} {sliding} {given}");
}

#[test]
fn tangents_with_springs_are_derivatives() {
    let mut random = Rng::with_seed(16);
    let s = 1e-6;
    let (mut checked, mut sliding, mut worst) = (std::collections::HashMap::new(), 0, 0.0f64);
    for k in 0..40_000 {
        let kind = TOUCHING[k % 2];
        let (x_n, x) = pressed(&mut random, kind);
        let end = closest(kind, &x);
        if end.distance_squared < 0.01
            || !LAYER.is_inside(end.distance_squared)
            || !is_smooth(kind, &x, s)
            || near_degenerate(kind, &x)
        {
            continue;
        }
        let law = spring(&mut random, kind, &x_n, LAWS[k / 2 % 2]);
        let at_end = |x: &Points| term(kind).at_end(&LAYER, &x_n, x, Some(&law), None).friction;
        let here = at_end(&x);
        // The slip and the normal force are large against the step of the differences, and none of its states is across the kink.
        let slides = |x: &Points| {
            let friction = at_end(x);
            friction.stretch.norm() < (1.0 - 1e-9) * friction.slip
        };
        let changes = (0..12).any(|j| [2.0 * s, -2.0 * s].iter().any(|h| slides(&moved(&x, j, *h)) != slides(&x)));
        if here.normal_force < 1e-3 || here.slip < 100.0 * s || changes {
            continue;
        }
        let (mut with, mut without) = ([[f64::NAN; 12]; 12], [[f64::NAN; 12]; 12]);
        term(kind).at_end(&LAYER, &x_n, &x, Some(&law), Some(&mut with));
        term(kind).at_end(&LAYER, &x_n, &x, None, Some(&mut without));
        let size = without.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        for i in 0..12 {
            (0..12).for_each(|j| with[i][j] -= without[i][j]);
        }
        let (difference, scale) = error(&with, &central(&x, s, |x| at_end(x).gradient));
        assert!(
            difference <= 1e-5 * scale + 1e-12 * size + 1e-7,
            "{kind:?} {difference:e} {scale:e} {size:e} {law:?} {x_n:?} {x:?}"
        );
        worst = worst.max(difference / scale);
        *checked.entry(format!("{:?} {:?}", kind, end.feature())).or_insert(0) += 1;
        sliding += usize::from(slides(&x));
    }
    println!("worst {worst:e}, {checked:?}, sliding {sliding}");
    assert!(checked.len() == 16 && checked.values().all(|&n| n > 10), "{checked:?}");
    assert!(sliding > 1000 && checked.values().sum::<usize>() > sliding + 1000, "{sliding}");
}

/// A way of a tenth in one step and in many: the same force and the same stretch. Back by less than twice the stretch the spring does work.
#[test]
fn a_spring_does_not_ask_for_the_number_of_steps() {
    let at = |x: f64| [[x, 0.3, 0.5], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from);
    let along = |ways: &[f64], parts: u32| {
        let (mut x, mut stretch, mut all) = (0.2, Vector3::zeros(), Vec::new());
        for way in ways {
            for _ in 0..parts {
                let law = PairFriction { stick: Presliding::Spring { stiffness: 100.0, stretch }, ..LAW };
                let next = x + way / f64::from(parts);
                let force = term(PairKind::VertexTriangle).at_end(&LAYER, &at(x), &at(next), Some(&law), None);
                (x, stretch) = (next, force.friction.stretch);
                all.push(force.friction);
            }
        }
        *all.last().unwrap()
    };
    let normal_force = WEIGHT * 2.0 * 1.5;
    let limit = 0.4 * normal_force / 100.0;
    for (ways, stretch) in [
        (&[0.1][..], limit),
        (&[0.5 * limit], 0.5 * limit),
        (&[0.1, -0.5 * limit], 0.5 * limit),
        (&[0.1, -0.1], -limit),
    ] {
        for parts in [1, 7, 1000] {
            let friction = along(ways, parts);
            assert!((friction.stretch.x - stretch).abs() < 1e-12, "{ways:?} {parts}: {} {stretch}", friction.stretch.x);
            assert!((friction.gradient[0].x - 100.0 * stretch).abs() < 1e-10);
        }
    }
}

/// The stretch turns with the pair, up to the square of the angle of a step, and never grows.
#[test]
fn a_spring_turns_with_its_pair() {
    let mut random = Rng::with_seed(17);
    for k in 0..2000 {
        let kind = TOUCHING[k % 2];
        let (x_n, _) = pressed(&mut random, kind);
        if sine(kind, &x_n) < 0.1 || !LAYER.is_inside(closest(kind, &x_n).distance_squared) {
            continue;
        }
        let law = spring(&mut random, kind, &x_n, LAW);
        let Presliding::Spring { stretch, .. } = law.stick else { unreachable!() };
        let law = PairFriction { stick: Presliding::Spring { stiffness: 1e-6, stretch }, ..LAW };
        let mut axis = vector(&mut random);
        axis *= 1e-3 / axis.norm();
        let turn = Rotation3::new(axis);
        let x = x_n.map(|x| turn * x);
        let friction = term(kind).at_end(&LAYER, &x_n, &x, Some(&law), None).friction;
        let gap = closest(kind, &x_n).distance_squared.sqrt();
        if friction.normal_force > 1e-3 {
            let missed = (friction.stretch - turn * stretch).norm();
            assert!(missed <= 1e-5 * (stretch.norm() + gap), "{kind:?} {missed:e} {:e} {gap:e}", stretch.norm());
        }
    }
}
