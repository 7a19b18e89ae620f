//! Planted errors are found, sound states raise no alarm, whatever the frame of reference.

use nalgebra::{Rotation3, Vector3};
use std::f64::consts::TAU;
use stoss_watch::{FindingKind, Judge, Limits, Severity, TiedPair, Verdict, Watch, WatchBody, WatchModel, WatchShape};

/// A block of hexahedra whose points are mapped.
struct Block {
    divisions: [usize; 3],
    points: Vec<Vector3<f64>>,
}

impl Block {
    /// A block of the box from `min` to `max`.
    fn new(min: [f64; 3], max: [f64; 3], divisions: [usize; 3]) -> Self {
        Self::mapped(divisions, |u| Vector3::from_fn(|i, _| min[i] + u[i] * (max[i] - min[i])))
    }

    /// The image of the unit cube.
    fn mapped(divisions: [usize; 3], map: impl Fn([f64; 3]) -> Vector3<f64>) -> Self {
        let [a, b, c] = divisions;
        let mut points = Vec::new();
        for k in 0..=c {
            for j in 0..=b {
                for i in 0..=a {
                    points.push(map([i as f64 / a as f64, j as f64 / b as f64, k as f64 / c as f64]));
                }
            }
        }
        Self { divisions, points }
    }

    fn hexahedra(&self, first: u32) -> Vec<[u32; 8]> {
        let [a, b, c] = self.divisions.map(|n| n as u32);
        let node = |i: u32, j: u32, k: u32| first + (k * (b + 1) + j) * (a + 1) + i;
        let mut all = Vec::new();
        for k in 0..c {
            for j in 0..b {
                for i in 0..a {
                    let base = [(0, 0), (1, 0), (1, 1), (0, 1)];
                    let corner = |l: usize| node(i + base[l % 4].0, j + base[l % 4].1, k + (l / 4) as u32);
                    all.push(std::array::from_fn(corner));
                }
            }
        }
        all
    }

    fn moved(&self, shift: [f64; 3]) -> Self {
        let points = self.points.iter().map(|x| x + Vector3::from(shift)).collect();
        Self { divisions: self.divisions, points }
    }

    fn turned(&self, axis: [f64; 3], degrees: f64) -> Self {
        let turn = Rotation3::new(Vector3::from(axis).normalize() * (degrees / 360.0 * TAU));
        let centre = self.points.iter().sum::<Vector3<f64>>() / self.points.len() as f64;
        let points = self.points.iter().map(|x| centre + turn * (x - centre)).collect();
        Self { divisions: self.divisions, points }
    }
}

fn unit(n: usize) -> Block {
    Block::new([0.0; 3], [1.0; 3], [n; 3])
}

fn model(bodies: &[Block]) -> WatchModel {
    let mut first = 0;
    let mut list = Vec::new();
    for (k, body) in bodies.iter().enumerate() {
        let nodes = first..first + body.points.len() as u32;
        list.push(WatchBody {
            name: format!("b{k}"),
            nodes: nodes.clone(),
            shape: WatchShape::Solid(body.hexahedra(first).into()),
        });
        first = nodes.end;
    }
    WatchModel { bodies: list, reference: positions(bodies), ties: Vec::new() }
}

fn positions(bodies: &[Block]) -> Vec<f64> {
    bodies.iter().flat_map(|body| &body.points).flat_map(|x| [x.x, x.y, x.z]).collect()
}

fn judge(model: WatchModel, states: &[Vec<f64>]) -> Verdict {
    let mut judge =
        Judge::new(model.bodies.iter().map(|b| (b.name.clone(), b.nodes.clone())), Vec::new(), Limits::default());
    let mut watch = Watch::new(model).unwrap();
    for (step, q) in states.iter().enumerate() {
        let previous = step.checked_sub(1).map(|k| states[k].as_slice());
        let seen = watch.geometry(q, previous);
        judge.observe(step as u64, 0.1 * step as f64, &seen, &watch.solids(q));
    }
    judge.verdict()
}

/// The verdict on states of bodies, in frames that are turned and shifted: it must be the same in all of them.
fn verdict(states: &[Vec<Block>]) -> Verdict {
    let plain: Vec<Vec<f64>> = states.iter().map(|bodies| positions(bodies)).collect();
    let first = judge(model(&states[0]), &plain);
    for (axis, angle, shift) in [([1.0, 2.0, 3.0], 0.7, [3.0, -1.0, 2.0]), ([-0.3, 0.1, 1.0], 2.1, [0.0, 50.0, 0.0])] {
        let turn = Rotation3::new(Vector3::from(axis).normalize() * angle);
        let map = |q: &[f64]| -> Vec<f64> {
            let image = |x: &[f64]| <[f64; 3]>::from(turn * Vector3::from_column_slice(x) + Vector3::from(shift));
            q.chunks_exact(3).flat_map(image).collect()
        };
        let mut other = model(&states[0]);
        other.reference = map(&other.reference);
        let turned = judge(other, &plain.iter().map(|q| map(q)).collect::<Vec<_>>());
        assert_eq!(turned.level, first.level, "{first} against {turned}");
    }
    first
}

fn wrong(states: &[Vec<Block>], kind: FindingKind, what: &str) {
    let verdict = verdict(states);
    let found = verdict.reasons.iter().any(|reason| reason.level == Severity::Wrong && reason.kind == kind);
    assert!(found, "{what}: {verdict}");
}

/// A lower block, and what is in it.
fn overlaps() -> Vec<(String, Vec<Block>)> {
    let slab = || Block::new([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0], [4, 4, 1]);
    let mut all = Vec::new();
    for (n, depth) in [(1, 0.4), (2, 0.35), (3, 0.45)] {
        let cube = unit(n).moved([-0.45, -0.4, 0.0]);
        all.push((format!("face in face, {n}"), vec![slab(), cube.moved([0.0, 0.0, -depth])]));
        for degrees in [15.0, 30.0, 45.0, 60.0] {
            // The lowest point of the turned cube is at -depth.
            let lowered = |turned: Block| {
                let low = turned.points.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
                turned.moved([0.0, 0.0, -depth - low])
            };
            let edge = lowered(cube.turned([0.0, 1.0, 0.0], degrees));
            all.push((format!("edge in face, {n}, {degrees}"), vec![slab(), edge]));
            let corner = lowered(cube.turned([1.0, 0.7, 0.2], degrees));
            all.push((format!("corner in face, {n}, {degrees}"), vec![slab(), corner]));
        }
        // A post through the middle of a facet: no node of the slab is in it, none of it in the slab.
        let post = Block::new([-0.2, -0.7, -3.0], [0.2, -0.3, 2.0], [1, 1, n]);
        all.push((format!("post through the slab, {n}"), vec![slab(), post]));
    }
    // Two bars across each other, edge over edge: all nodes are outside.
    let bar = Block::new([-2.0, -0.5, -0.5], [2.0, 0.5, 0.5], [2, 1, 1]).turned([1.0, 0.0, 0.0], 45.0);
    for depth in [0.66, 0.7, 0.74] {
        let other = bar.turned([0.0, 0.0, 1.0], 90.0).moved([0.0, 0.0, 2.0_f64.sqrt() - depth]);
        all.push((format!("edge over edge, {depth}"), vec![Block { ..bar.moved([0.0; 3]) }, other]));
    }
    // A body in the inside of another, in a corner of it, and twice the same one.
    for n in [1, 2, 4] {
        let small = Block::new([-0.3, -0.3, -0.9], [0.1, 0.1, -0.35], [n; 3]);
        all.push((format!("swallowed, {n}"), vec![slab(), small]));
        all.push((format!("twice the same, {n}"), vec![unit(2), unit(2).moved([1e-3, 0.0, 0.0])]));
        let shifted = unit(n).moved([0.55, 0.35, 0.45]);
        all.push((format!("shifted into itself, {n}"), vec![unit(2), shifted]));
    }
    all
}

#[test]
fn overlaps_of_all_kinds_are_wrong_either_way_round() {
    let mut count = 0;
    for (what, bodies) in overlaps() {
        let [a, b]: [Block; 2] = bodies.try_into().ok().unwrap();
        let swapped = vec![b.moved([0.0; 3]), a.moved([0.0; 3])];
        wrong(&[vec![a, b]], FindingKind::Penetration, &what);
        wrong(&[swapped], FindingKind::Penetration, &format!("{what}, exchanged"));
        count += 2;
    }
    assert!(count >= 70, "{count}");
}

#[test]
fn what_passes_through_a_body_is_wrong() {
    let plate = |thickness: f64| Block::new([-2.0, -2.0, -thickness], [2.0, 2.0, 0.0], [3, 3, 1]);
    let mut count = 0;
    for thickness in [0.01, 0.1, 0.5] {
        for (n, sideways) in [(1, 0.0), (2, 0.4), (3, -0.7)] {
            let cube = unit(n).moved([-0.4, -0.3, 0.2]);
            let below = cube.moved([sideways, 0.3 * sideways, -1.5 - thickness]);
            let what = format!("plate of {thickness}, {n}");
            let states = [vec![plate(thickness), cube.moved([0.0; 3])], vec![plate(thickness), below.moved([0.0; 3])]];
            wrong(&states, FindingKind::Tunnelling, &what);
            // The plate moves and the cube stands still.
            let up = [-sideways, -0.3 * sideways, 1.5 + thickness];
            let states = [vec![plate(thickness), cube.moved([0.0; 3])], vec![plate(thickness).moved(up), cube]];
            wrong(&states, FindingKind::Tunnelling, &format!("{what}, the plate moves"));
            count += 2;
        }
    }
    assert_eq!(count, 18);
}

/// The straight line from look to look cuts a bit off a sharp edge that a node went around. Deeper it is a passage, and so is one beside the rim of a plate as thin as that bit.
#[test]
fn a_node_may_go_around_a_sharp_edge() {
    // A sheared block with a sharp edge along y at x = z = 0.
    let blade = |height: f64| Block::mapped([1, 2, 1], move |[u, v, w]| Vector3::new(u + 1.2 * w, v, height * w));
    let plate = |height: f64| Block::new([0.0; 3], [1.0, 1.0, height], [1, 2, 1]);
    // A cube goes up that reaches so far beyond the edge, from below to above.
    let states = |body: &dyn Fn() -> Block, reach: f64| {
        let cube = |z: f64| unit(1).moved([reach - 1.0, 0.3, z]);
        [vec![body(), cube(-1.2)], vec![body(), cube(0.3)]]
    };
    for height in [0.8, 0.3] {
        for reach in [0.005, 0.02] {
            let found = verdict(&states(&|| blade(height), reach));
            assert_eq!(found.level, Severity::Sound, "{height}, {reach}: {found}");
            let thin = || plate(height * reach / 1.2);
            wrong(&states(&thin, reach), FindingKind::Tunnelling, &format!("plate, {height}, {reach}"));
        }
        for reach in [0.1, 0.2] {
            wrong(&states(&|| blade(height), reach), FindingKind::Tunnelling, &format!("{height}, {reach}"));
        }
    }
}

#[test]
fn a_body_in_itself_is_wrong() {
    for (n, depth) in [(8, 0.5), (10, 0.5), (12, 0.45), (16, 0.55)] {
        // A strip that is bent to a ring whose ends overlap by a part of their thickness.
        let ring = |overlap: f64| {
            Block::mapped([n, 1, 1], move |[u, v, w]| {
                let angle = u * TAU * (1.0 - 0.5 / n as f64);
                // The end is shifted outwards on to the beginning.
                let radius = 1.0 + 0.6 * w + 0.6 * u * (1.0 - overlap);
                let turn = angle + u * TAU * 1.5 / n as f64;
                Vector3::new(radius * turn.cos(), radius * turn.sin(), 0.5 * v)
            })
        };
        wrong(&[vec![ring(depth)]], FindingKind::Penetration, &format!("ring of {n}"));
        let open = verdict(&[vec![ring(-0.5)]]);
        assert_eq!(open.level, Severity::Sound, "{open}");
    }
}

#[test]
fn bad_elements_and_positions_are_found() {
    let bodies = [unit(2), unit(2).moved([3.0, 0.0, 0.0])];
    let start = positions(&bodies);
    let after = |change: &dyn Fn(&mut Vec<f64>)| {
        let mut q = start.clone();
        change(&mut q);
        judge(model(&bodies), &[start.clone(), q])
    };
    let has = |verdict: &Verdict, kind| verdict.reasons.iter().any(|r| r.kind == kind && r.level == Severity::Wrong);
    for component in 0..6 {
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(has(&after(&|q| q[31 * component + 5] = bad), FindingKind::NotFinite));
        }
        assert!(has(&after(&|q| q[3 * component] = 1e5), FindingKind::FarAway));
    }
    // The middle node of a block through its face.
    for axis in 0..3 {
        let verdict = after(&|q| q[3 * 13 + axis] = 1.6);
        assert!(has(&verdict, FindingKind::InvertedElement), "{verdict}");
    }
    // A corner pressed in: turned inside out there, not at the Gauss points.
    let poor = after(&|q| q[..3].fill(0.15));
    assert_eq!(poor.level, Severity::Sound, "{poor}");
    let poor = after(&|q| q[..3].fill(0.175));
    assert!(poor.reasons.iter().any(|r| r.kind == FindingKind::PoorElement), "{poor}");
}

#[test]
fn sound_states_raise_no_alarm() {
    let mut states: Vec<Vec<Vec<Block>>> = Vec::new();
    // Stacks at gap zero, tiny gaps and overlaps of round-off, matching and not.
    for (n, m) in [(1, 1), (2, 2), (2, 3), (3, 2), (4, 1)] {
        for gap in [0.0, 1e-15, -1e-15, 1e-6, 1e-2] {
            for shift in [0.0, 0.25, 0.5] {
                states.push(vec![vec![unit(n), unit(m).moved([shift, 0.3 * shift, 1.0 + gap])]]);
            }
        }
    }
    // Side by side, edge at edge, corner at corner.
    for shift in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, -1.0, 0.3], [-1.0, 0.5, -1.0]] {
        states.push(vec![vec![unit(2), unit(2).moved(shift)]]);
        states.push(vec![vec![unit(1), unit(3).moved(shift)]]);
    }
    // A ball in a bowl, and one in a closed shell.
    for n in [4, 6] {
        let shell = |r0: f64, r1: f64, low: f64| {
            Block::mapped([n, n, 1], move |[u, v, w]| {
                let (phi, theta) = (0.9 * u * TAU, low + v * 1.2);
                let r = r0 + (r1 - r0) * w;
                Vector3::new(r * theta.cos() * phi.cos(), r * theta.cos() * phi.sin(), r * theta.sin())
            })
        };
        states.push(vec![vec![
            shell(1.0, 1.2, -1.3),
            Block::new([-0.25; 3], [0.25; 3], [2; 3]).turned([1.0, 1.0, 0.0], 20.0),
        ]]);
        states.push(vec![vec![shell(1.0, 1.2, -1.3), shell(0.3, 0.5, -1.3)]]);
    }
    // Bodies that pass each other at a small distance, fast, and bodies that fly together.
    for speed in [0.5, 2.0, 10.0] {
        for gap in [1e-9, 1e-3] {
            let fixed = || unit(2);
            let flying = |t: f64| unit(3).moved([-3.0 + speed * t, 0.2, 1.0 + gap]);
            states.push((0..4).map(|k| vec![fixed(), flying(f64::from(k))]).collect());
            let both = |t: f64| [speed * t, -speed * t, 0.5 * speed * t];
            let pair = |t: f64| vec![unit(2).moved(both(t)), unit(2).moved([0.0, 0.0, 1.0 + gap]).moved(both(t))];
            states.push((0..4).map(|k| pair(f64::from(k))).collect());
        }
    }
    // Sheared and bent bodies.
    for shear in [0.3, 0.8, 1.2] {
        let sheared = Block::mapped([2, 2, 3], |[u, v, w]| Vector3::new(u + shear * w, v, w));
        states.push(vec![vec![sheared, unit(2).moved([0.0, 0.0, -1.0])]]);
    }
    assert!(states.len() >= 100, "{}", states.len());
    for (k, state) in states.iter().enumerate() {
        let found = verdict(state);
        assert_eq!(found.level, Severity::Sound, "state {k}: {found}");
    }
}

#[test]
fn tied_surfaces_may_overlap() {
    let bodies = [unit(2), unit(2).moved([0.0, 0.0, 0.6])];
    let q = positions(&bodies);
    assert_eq!(judge(model(&bodies), std::slice::from_ref(&q)).level, Severity::Wrong);
    let at = |z: f64, nodes: std::ops::Range<u32>| {
        let q = &q;
        nodes.filter(move |&n| (q[3 * n as usize + 2] - z).abs() < 1e-12)
    };
    let tied: Vec<u32> = at(1.0, 0..27).chain(at(0.6, 27..54)).chain(at(0.5, 0..27)).chain(at(1.1, 27..54)).collect();
    let model = WatchModel { ties: vec![TiedPair { nodes: tied, bodies: [0, 1] }], ..model(&bodies) };
    let verdict = judge(model, &[q]);
    assert_eq!(verdict.level, Severity::Sound, "{verdict}");
}

#[test]
fn depth_and_place_are_those_of_the_closed_form() {
    let bodies = [Block::new([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0], [4, 4, 2]), unit(1).moved([-0.4, -0.4, -0.25])];
    let mut watch = Watch::new(model(&bodies)).unwrap();
    let seen = watch.geometry(&positions(&bodies), None);
    let deepest = seen.deepest().unwrap();
    assert!((deepest.depth - 0.25).abs() < 1e-14 && (deepest.relative - 0.25).abs() < 1e-14, "{deepest:?}");
    // Four corners of the cube, and the middle node of the slab's top.
    assert_eq!(seen.nodes_inside, 5);
}
