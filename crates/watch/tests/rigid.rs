//! Surfaces of rigid bodies: planted errors are found, sound states raise no alarm, whatever the frame of reference and whatever the facets.

use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{PI, TAU};
use stoss_watch::{
    FindingKind, Judge, Limits, Severity, Verdict, Watch, WatchBody, WatchFacet, WatchModel, WatchShape,
};

/// How a surface is divided.
#[derive(Clone, Copy, Debug)]
enum Facets {
    Triangles,
    Quadrilaterals,
}

const BOTH: [Facets; 2] = [Facets::Triangles, Facets::Quadrilaterals];

/// Points, and what they make, by numbers of its own.
#[derive(Clone)]
struct Thing {
    points: Vec<Vector3<f64>>,
    shape: WatchShape,
}

impl Thing {
    fn surface(points: Vec<Vector3<f64>>, quads: &[[u32; 4]], facets: Facets, is_closed: bool) -> Self {
        let divide = |&[a, b, c, d]: &[u32; 4]| match facets {
            // Poles of a ball are quadrilaterals with two equal corners.
            _ if a == b => vec![WatchFacet::Triangle([b, c, d])],
            _ if c == d => vec![WatchFacet::Triangle([a, b, c])],
            Facets::Triangles => vec![WatchFacet::Triangle([a, b, c]), WatchFacet::Triangle([a, c, d])],
            Facets::Quadrilaterals => vec![WatchFacet::Quadrilateral([a, b, c, d])],
        };
        Self { points, shape: WatchShape::Surface { facets: quads.iter().flat_map(divide).collect(), is_closed } }
    }

    fn corners(min: [f64; 3], max: [f64; 3]) -> Vec<Vector3<f64>> {
        let at = |bits: [usize; 3]| Vector3::from_fn(|i, _| if bits[i] == 1 { max[i] } else { min[i] });
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]].map(at).to_vec()
    }

    /// A rigid box, six sides.
    fn brick(min: [f64; 3], max: [f64; 3], facets: Facets) -> Self {
        let quads = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        Self::surface(Self::corners(min, max), &quads, facets, true)
    }

    /// One hexahedron.
    fn element(min: [f64; 3], max: [f64; 3]) -> Self {
        let hexahedra = vec![[0, 1, 2, 3, 4, 5, 6, 7]];
        Self { points: Self::corners(min, max), shape: WatchShape::Solid(hexahedra.into()) }
    }

    /// A ball about the origin: points between the poles in rings, then the poles.
    fn ball(radius: f64, n: u32, facets: Facets) -> Self {
        let mut points: Vec<Vector3<f64>> = Vec::new();
        for i in 1..n {
            for j in 0..2 * n {
                let (theta, phi) = (PI * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(2 * n));
                points.push(radius * Vector3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()));
            }
        }
        let (north, south) = (points.len() as u32, points.len() as u32 + 1);
        points.extend([Vector3::z() * radius, -Vector3::z() * radius]);
        let node = |i: u32, j: u32| match i {
            0 => north,
            i if i == n => south,
            i => (i - 1) * 2 * n + j % (2 * n),
        };
        let quad = |i: u32, j: u32| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        let mut quads: Vec<[u32; 4]> =
            (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j))).map(|(i, j)| quad(i, j)).collect();
        for quad in &mut quads {
            // The pole twice, at places that `surface` knows.
            if quad[0] == quad[3] || quad[1] == quad[2] {
                *quad = [quad[3], quad[0], quad[1], quad[2]];
            }
        }
        Self::surface(points, &quads, facets, true)
    }

    /// A plane at z = 0 about the origin, its front upwards.
    fn plane(half: f64, n: u32, facets: Facets) -> Self {
        let at = |k: u32| half * (2.0 * f64::from(k) / f64::from(n) - 1.0);
        let points = (0..=n).flat_map(|j| (0..=n).map(move |i| Vector3::new(at(i), at(j), 0.0))).collect();
        let node = |i: u32, j: u32| j * (n + 1) + i;
        let quad = |i: u32, j: u32| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        let quads: Vec<[u32; 4]> = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).map(|(i, j)| quad(i, j)).collect();
        Self::surface(points, &quads, facets, false)
    }

    fn moved(&self, shift: [f64; 3]) -> Self {
        Self { points: self.points.iter().map(|x| x + Vector3::from(shift)).collect(), shape: self.shape.clone() }
    }

    fn turned(&self, axis: [f64; 3], angle: f64) -> Self {
        let turn = Rotation3::new(Vector3::from(axis).normalize() * angle);
        Self { points: self.points.iter().map(|x| turn * x).collect(), shape: self.shape.clone() }
    }

    /// What it makes, with other numbers of its points.
    fn numbered(&self, first: u32) -> WatchShape {
        let facet = |facet: &WatchFacet| match facet {
            WatchFacet::Triangle(corners) => WatchFacet::Triangle(corners.map(|k| k + first)),
            WatchFacet::Quadrilateral(corners) => WatchFacet::Quadrilateral(corners.map(|k| k + first)),
        };
        match &self.shape {
            WatchShape::Solid(list) => {
                let mut moved = stoss_mesh::Elements::new();
                moved.extend(list, |k| k + first);
                WatchShape::Solid(moved)
            }
            WatchShape::Surface { facets, is_closed } => {
                WatchShape::Surface { facets: facets.iter().map(facet).collect(), is_closed: *is_closed }
            }
        }
    }
}

/// The verdict on states of things; those of the first state are the reference.
fn judged(states: &[Vec<Thing>]) -> Verdict {
    let positions =
        |things: &[Thing]| things.iter().flat_map(|t| &t.points).flat_map(|x| [x.x, x.y, x.z]).collect::<Vec<f64>>();
    let (mut first, mut bodies) = (0, Vec::new());
    for (k, thing) in states[0].iter().enumerate() {
        let nodes = first..first + thing.points.len() as u32;
        bodies.push(WatchBody { name: format!("b{k}"), nodes: nodes.clone(), shape: thing.numbered(first) });
        first = nodes.end;
    }
    let names: Vec<_> = bodies.iter().map(|body| (body.name.clone(), body.nodes.clone())).collect();
    let mut judge = Judge::new(names, Vec::new(), Limits::default());
    let mut watch = Watch::new(WatchModel { bodies, reference: positions(&states[0]), ties: Vec::new() }).unwrap();
    let states: Vec<Vec<f64>> = states.iter().map(|things| positions(things)).collect();
    for (step, q) in states.iter().enumerate() {
        let previous = step.checked_sub(1).map(|k| states[k].as_slice());
        let seen = watch.geometry(q, previous);
        judge.observe(step as u64, 0.1 * step as f64, &seen, &watch.solids(q));
    }
    judge.verdict()
}

/// The verdict, which is the same in all frames of reference, and with the bodies in the other order.
fn verdict(states: &[Vec<Thing>]) -> Verdict {
    let first = judged(states);
    let map = |change: &dyn Fn(&Thing) -> Thing| {
        states.iter().map(|things| things.iter().map(change).collect()).collect::<Vec<Vec<Thing>>>()
    };
    let turned = judged(&map(&|thing| thing.turned([1.0, 2.0, 3.0], 0.7).moved([3.0, -1.0, 2.0])));
    assert_eq!(turned.level, first.level, "{first} against {turned}");
    let exchanged: Vec<Vec<Thing>> = states.iter().map(|things| things.iter().rev().cloned().collect()).collect();
    let other = judged(&exchanged);
    assert_eq!(other.level, first.level, "{first} against {other}");
    first
}

fn wrong(states: &[Vec<Thing>], kind: FindingKind, what: &str) {
    let verdict = verdict(states);
    let found = verdict.reasons.iter().any(|reason| reason.level == Severity::Wrong && reason.kind == kind);
    assert!(found, "{what}: {verdict}");
}

fn sound(states: &[Vec<Thing>], what: &str) {
    let verdict = verdict(states);
    assert_eq!(verdict.level, Severity::Sound, "{what}: {verdict}");
}

#[test]
fn overlaps_with_closed_surfaces_are_wrong() {
    let block = || Thing::element([-0.5, -0.5, -1.0], [0.5, 0.5, 0.0]);
    for facets in BOTH {
        let ball = Thing::ball(0.4, 4, facets);
        for depth in [0.35, 0.5, 0.8, 0.9] {
            wrong(&[vec![ball.moved([0.1, -0.05, 0.4 - depth]), block()]], FindingKind::Penetration, "ball in block");
        }
        let brick = |half: f64| Thing::brick([-half, -half, -half], [half; 3], facets);
        for shift in [[0.0, 0.0, -0.1], [0.3, 0.3, 0.05], [0.45, 0.45, 0.0]] {
            wrong(&[vec![brick(0.4).moved(shift), block()]], FindingKind::Penetration, "brick in block");
        }
        // Large facets: depths are measured by the small body's edges.
        let small = Thing::ball(0.1, 4, facets);
        for depth in [0.1, 0.2, 1.0] {
            let what = format!("small ball in a large brick, {depth}");
            wrong(&[vec![small.moved([1.0, 2.0, 10.1 - depth]), brick(10.0)]], FindingKind::Penetration, &what);
        }
        // Rigid bodies in the same place.
        wrong(
            &[vec![brick(1.0), brick(1.0).moved([1e-3, 0.0, 0.0])]],
            FindingKind::Penetration,
            "twice the same brick",
        );
        wrong(&[vec![ball.clone(), ball.moved([0.0, 1e-3, 0.0])]], FindingKind::Penetration, "twice the same ball");
        // Two bars across each other, all corners outside.
        let bar = Thing::brick([-2.0, -0.5, -0.5], [2.0, 0.5, 0.5], facets);
        let other = bar.turned([0.0, 0.0, 1.0], 0.5 * PI).moved([0.013, 0.007, 0.4]);
        wrong(&[vec![bar, other]], FindingKind::Penetration, "bars across each other");
    }
}

#[test]
fn what_passes_through_a_surface_is_wrong() {
    let block = || Thing::element([-0.3, -0.4, 0.01], [0.7, 0.6, 1.01]);
    for facets in BOTH {
        for n in [1, 2, 7] {
            let plane = || Thing::plane(3.0, n, facets);
            for sideways in [0.0, 0.5] {
                let below = [sideways, 0.3 * sideways, -1.5];
                let what = format!("{facets:?}, {n}");
                let falls = [vec![plane(), block()], vec![plane(), block().moved(below)]];
                wrong(&falls, FindingKind::Tunnelling, &format!("block through a plane, {what}"));
                let rises = [vec![plane(), block()], vec![plane().moved([0.0, 0.0, 1.6]), block()]];
                wrong(&rises, FindingKind::Tunnelling, &format!("the plane moves, {what}"));
                let mut back = falls.to_vec();
                back.reverse();
                wrong(&back, FindingKind::Tunnelling, &format!("from behind, {what}"));
            }
        }
        // Through a plate.
        let plate = || Thing::brick([-3.0, -3.0, -0.1], [3.0, 3.0, 0.0], facets);
        let falls = [vec![plate(), block()], vec![plate(), block().moved([0.1, 0.2, -1.5])]];
        wrong(&falls, FindingKind::Tunnelling, "block through a plate");
        let ball = |z: f64| Thing::ball(0.2, 3, facets).moved([0.11, 0.07, z]);
        wrong(&[vec![plate(), ball(0.3)], vec![plate(), ball(-0.4)]], FindingKind::Tunnelling, "ball through a plate");
        wrong(&[vec![block(), ball(1.3)], vec![block(), ball(-0.4)]], FindingKind::Tunnelling, "ball through a block");
    }
}

/// Astride a plane a body is as deep in it as it reaches to the side where there is less of it.
#[test]
fn depth_in_an_open_surface_is_that_of_the_closed_form() {
    for facets in BOTH {
        for (depth, level) in
            [(0.01, Severity::Sound), (0.2, Severity::Doubtful), (0.4, Severity::Wrong), (0.7, Severity::Wrong)]
        {
            let block = Thing::element([-0.3, -0.4, -depth], [0.7, 0.6, 1.0 - depth]);
            let verdict = verdict(&[vec![Thing::plane(3.0, 5, facets), block]]);
            assert_eq!(verdict.level, level, "{depth}: {verdict}");
            let deepest = verdict.reasons.iter().filter(|r| r.bodies == Some([1, 0])).map(|r| r.figure).next();
            if level != Severity::Sound {
                // The edges of the block are 1, those of the plane 1.2.
                let expected = f64::min(depth, 1.0 - depth);
                assert!((deepest.unwrap() - expected).abs() < 1e-12, "{depth}: {deepest:?}");
            }
        }
        let ball = Thing::ball(0.5, 8, facets).moved([0.0, 0.0, 0.3]);
        wrong(&[vec![Thing::plane(3.0, 1, facets), ball]], FindingKind::Penetration, "ball astride a plane");
    }
}

#[test]
fn sound_states_raise_no_alarm() {
    let block = |low: f64| Thing::element([-0.3, -0.4, low], [0.7, 0.6, low + 1.0]);
    for facets in BOTH {
        for n in [1, 4] {
            let plane = || Thing::plane(3.0, n, facets);
            for gap in [0.0, 1e-15, -1e-15, 1e-6, -1e-6, 0.1, -2.0] {
                sound(&[vec![plane(), block(gap)]], &format!("block on a plane, {gap}"));
                sound(&[vec![plane(), Thing::ball(0.5, 4, facets).moved([0.1, 0.2, 0.5 + gap])]], "ball on a plane");
            }
            for gap in [0.0, 1e-15, -1e-15, -1e-3] {
                // It leaves the plane, comes back, and slides.
                let path = [[0.0, 0.0, 0.0], [0.3, 0.0, 2.0], [0.6, 0.0, 0.0], [1.9, 0.5, 0.0], [-1.0, -1.0, 0.0]];
                let states = path.map(|shift| vec![plane(), block(gap).moved(shift)]);
                sound(&states, &format!("bouncing block, {gap}"));
            }
            // Past the rim, above and below.
            let beside = |z: f64| vec![plane(), block(z).moved([3.5, 0.0, 0.0])];
            sound(&[beside(1.0), beside(-0.5), beside(-3.0)], "past the rim of a plane");
        }
        let brick = Thing::brick([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0], facets);
        for gap in [0.0, 1e-15, -1e-15, 1e-6, 0.3] {
            sound(&[vec![brick.clone(), block(gap)]], &format!("block on a brick, {gap}"));
            sound(&[vec![brick.clone(), Thing::ball(0.5, 6, facets).moved([0.0, 0.0, 0.5 + gap])]], "ball on a brick");
            sound(&[vec![block(gap), brick.moved([0.0, 0.0, 0.0])]], "brick under a block");
        }
        for speed in [1.0, 5.0] {
            let flies = |t: f64| vec![brick.clone(), block(1e-3).moved([-6.0 + speed * t, 0.0, 0.0])];
            sound(&[flies(0.0), flies(1.0), flies(2.0)], "a block flies over a brick");
        }
        // A ball in a hollow one, whose inner surface looks inwards.
        let [outer, inner] = [Thing::ball(2.0, 8, facets), Thing::ball(1.5, 8, facets)];
        let count = outer.points.len() as u32;
        let reversed = inner.numbered(count);
        let (WatchShape::Surface { facets: mut all, .. }, WatchShape::Surface { facets: within, .. }) =
            (outer.shape.clone(), reversed)
        else {
            unreachable!("a ball is a surface");
        };
        all.extend(within.into_iter().map(|facet| match facet {
            WatchFacet::Triangle([a, b, c]) => WatchFacet::Triangle([a, c, b]),
            WatchFacet::Quadrilateral([a, b, c, d]) => WatchFacet::Quadrilateral([a, d, c, b]),
        }));
        let points = [outer.points, inner.points].concat();
        let shell = Thing { points, shape: WatchShape::Surface { facets: all, is_closed: true } };
        let ball = Thing::ball(0.5, 4, facets);
        sound(
            &[vec![shell.clone(), ball.clone()], vec![shell.clone(), ball.moved([0.6, 0.2, 0.0])]],
            "ball in a shell",
        );
        wrong(&[vec![shell, ball.moved([1.3, 0.0, 0.0])]], FindingKind::Penetration, "ball in the wall of a shell");
    }
}

/// Nodes that belong to no body are named by their numbers.
#[test]
fn a_point_of_no_body_that_is_no_number_is_found() {
    let brick = Thing::brick([0.0; 3], [1.0; 3], Facets::Triangles);
    let bodies = vec![WatchBody { name: "brick".into(), nodes: 1..9, shape: brick.numbered(1) }];
    let mut reference: Vec<f64> = vec![0.0; 3];
    reference.extend(brick.points.iter().flat_map(|x| [x.x, x.y, x.z]));
    let mut judge = Judge::new([("brick".to_owned(), 1..9)], Vec::new(), Limits::default());
    let mut watch = Watch::new(WatchModel { bodies, reference: reference.clone(), ties: Vec::new() }).unwrap();
    reference[1] = f64::NAN;
    let seen = watch.geometry(&reference, None);
    judge.observe(1, 0.5, &seen, &watch.solids(&reference));
    assert!(judge.verdict().to_string().contains("the position of node 0 of the model is not a finite number"));
}
