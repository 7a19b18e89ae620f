//! Two bodies that act on each other: directions of forces, ways that drive them, arches of facets. Expected values are closed forms of planes and circles.

use nalgebra::{Rotation3, Vector3};
use std::f64::consts::FRAC_PI_2;
use stoss_watch::{Watch, WatchBody, WatchFacet, WatchModel, WatchShape};

type Points = Vec<[f64; 3]>;

/// A plane of `n` by `n` squares of the side `size` about the origin.
fn plane(n: u32, size: f64) -> (Points, Vec<WatchFacet>) {
    let at = |i: u32| size * (f64::from(i) - 0.5 * f64::from(n));
    let points = (0..=n).flat_map(|j| (0..=n).map(move |i| [at(i), at(j), 0.0])).collect();
    let quad = |i: u32, j: u32| {
        let k = j * (n + 1) + i;
        WatchFacet::Quadrilateral([k, k + 1, k + n + 2, k + n + 1])
    };
    (points, (0..n).flat_map(|j| (0..n).map(move |i| quad(i, j))).collect())
}

/// A box with these corners.
fn brick(min: [f64; 3], max: [f64; 3]) -> (Points, Vec<WatchFacet>) {
    let at = |k: usize| std::array::from_fn(|i| if k >> i & 1 == 1 { max[i] } else { min[i] });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    ((0..8).map(at).collect(), quads.map(WatchFacet::Quadrilateral).to_vec())
}

/// A quarter of the side of a cylinder about the z-axis with `n` facets; normals point outwards, or inwards of a hole.
fn quarter(radius: f64, n: u32, is_hole: bool, offset: f64) -> (Points, Vec<WatchFacet>) {
    let at = |k: u32, z: f64| {
        let angle = FRAC_PI_2 * f64::from(k) / f64::from(n);
        [radius * angle.cos() + offset, radius * angle.sin(), z]
    };
    let points = (0..=n).flat_map(|k| [at(k, 0.0), at(k, 1.0)]).collect();
    let quad = |k: u32| {
        let [a, b, c, d] = [2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1];
        WatchFacet::Quadrilateral(if is_hole { [d, c, b, a] } else { [a, b, c, d] })
    };
    (points, (0..n).map(quad).collect())
}

/// The watch on two surfaces, with positions that a function makes of the reference.
fn watch(things: [((Points, Vec<WatchFacet>), bool); 2], moved: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Watch {
    let (mut reference, mut q, mut bodies) = (Vec::new(), Vec::new(), Vec::new());
    for (b, ((points, facets), is_closed)) in things.into_iter().enumerate() {
        let first = (reference.len() / 3) as u32;
        let shifted = facets.iter().map(|facet| match *facet {
            WatchFacet::Quadrilateral(corners) => WatchFacet::Quadrilateral(corners.map(|c| c + first)),
            WatchFacet::Triangle(corners) => WatchFacet::Triangle(corners.map(|c| c + first)),
        });
        let shape = WatchShape::Surface { facets: shifted.collect(), is_closed };
        bodies.push(WatchBody { name: b.to_string(), nodes: first..first + points.len() as u32, shape });
        reference.extend(points.iter().flatten());
        q.extend(points.iter().flat_map(|&x| moved(b, x)));
    }
    let mut watch = Watch::new(WatchModel { bodies, reference, ties: Vec::new() }).unwrap();
    watch.geometry(&q, None);
    watch
}

fn size(x: [f64; 3]) -> f64 {
    Vector3::from(x).norm()
}

/// On a plane of many facets the part of the force along it is left, wherever the box stands and in whatever frame.
#[test]
fn a_plane_pushes_along_its_normal_only() {
    for (turn, shift) in [(0.0, [0.0; 2]), (0.7, [0.31, -0.12]), (2.0, [0.05, 0.4])] {
        let frame = Rotation3::from_euler_angles(0.3 * turn, turn, -turn);
        let place = |_: usize, x: [f64; 3]| (frame * Vector3::from(x)).into();
        let [u, v] = shift;
        let cube = brick([u - 0.3, v - 0.3, 1e-4], [u + 0.3, v + 0.3, 0.6]);
        let watch = watch([(cube, true), (plane(8, 0.25), false)], place);
        let force = |x: [f64; 3]| (frame * Vector3::from(x)).into();
        let beside = |x| watch.side_force([0, 1], force(x), None).unwrap().map(size);
        assert!(beside([0.0, 0.0, 5.0]).iter().all(|r| *r < 1e-12));
        // The box has side walls, whose corners push sideways; the plane has not.
        let [by_plane, by_box] = beside([0.3, 0.4, 5.0]);
        assert!((by_plane - 0.5).abs() < 1e-12 && by_box < 1e-12, "{by_plane} {by_box}");
        // The other way round it is the same.
        let [by_box, by_plane] = watch.side_force([1, 0], force([-0.3, -0.4, -5.0]), None).unwrap().map(size);
        assert!((by_plane - 0.5).abs() < 1e-12 && by_box < 1e-12);
    }
}

/// A ball of facets has all normals between theirs, and an open surface pushes outwards with its rim.
#[test]
fn curved_surfaces_and_rims_push_in_all_directions_between() {
    let block = || brick([2.0, 0.2, 0.2], [2.5, 0.5, 0.8]);
    let round = quarter(2.0, 12, false, 0.0);
    let watch_round = watch([(block(), true), (round, false)], |_, x| x);
    let angle = |degrees: f64| [degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0];
    let by_round = |degrees: f64| size(watch_round.side_force([0, 1], angle(degrees), None).unwrap()[0]);
    assert!(by_round(4.0) < 1e-12 && by_round(10.0) < 1e-12);
    assert!(by_round(60.0) > 0.3);
    // A box over the rim of a plane, at x = 1.
    let over = brick([0.9, -0.2, 1e-4], [1.4, 0.2, 0.5]);
    let watch_rim = watch([(over, true), (plane(8, 0.25), false)], |_, x| x);
    let by_plane = |force| size(watch_rim.side_force([0, 1], force, None).unwrap()[0]);
    assert!(by_plane([0.5, 0.0, 1.0]) < 1e-12);
    assert!((by_plane([-0.5, 0.0, 1.0]) - 0.5).abs() < 1e-12);
    assert!((by_plane([0.0, 0.5, 1.0]) - 0.5).abs() < 1e-12);
}

/// What is far from each other pushes in no known direction.
#[test]
fn nothing_is_said_of_bodies_that_only_edges_bring_together() {
    let high = brick([-0.3, -0.3, 0.2], [0.3, 0.3, 0.8]);
    let watch = watch([(high, true), (plane(8, 0.25), false)], |_, x| x);
    assert_eq!(watch.side_force([0, 1], [1.0, 0.0, 0.0], None), None);
}

/// A box that was 0.1 above a plane has been moved down by 0.13: it was driven into it by 0.03. Overlaps of the reference count with it, motions along the plane do not.
#[test]
fn the_way_that_drives_bodies_into_each_other() {
    let moved = |gap: f64, by: [f64; 3]| {
        let cube = brick([-0.3, -0.3, gap], [0.3, 0.3, gap + 0.6]);
        let mut watch = watch([(cube, true), (plane(3, 1.0), false)], |b, x| {
            if b == 0 { [x[0] + by[0], x[1] + by[1], x[2] + by[2]] } else { x }
        });
        watch.meeting([0, 1], [0.0, 0.0, 2.0], None, [false; 2], false).unwrap()
    };
    let drive = |gap, by| moved(gap, by).drive;
    assert!((drive(0.1, [0.0, 0.0, -0.13]) - 0.03).abs() < 1e-12);
    assert!((drive(0.1, [0.5, -0.2, -0.13]) - 0.03).abs() < 1e-12);
    let left = moved(0.1, [0.0, 0.0, -0.09]);
    assert!((left.apart - 0.01).abs() < 1e-12 && (left.drive + 0.01).abs() < 1e-12, "{left:?}");
    let [in_one, in_other] = [[0, 1], [1, 0]].map(|bodies| {
        let overlapping = [(brick([0.0; 3], [1.0; 3]), true), (brick([0.2, 0.2, 0.98], [0.8, 0.8, 1.5]), true)];
        watch(overlapping, |_, x| x).meeting(bodies, [0.0; 3], None, [false; 2], false).unwrap().drive
    });
    assert!((in_one - 0.02).abs() < 1e-12 && (in_other - 0.02).abs() < 1e-12, "{in_one} {in_other}");
}

/// Nodes in the middle of chords see them `R (1 - cos(a/2))` below the arc; nodes opposite nodes see nothing. Where a pin lies along a line the arc is no matter.
#[test]
fn arches_of_surfaces_that_are_curved_alike() {
    let chord = FRAC_PI_2 / 10.0;
    let arch = |pin: u32, offset: f64| {
        let things = [(quarter(2.0, pin, false, offset), false), (quarter(2.0, 10, true, 0.0), false)];
        watch(things, |_, x| x).meeting([0, 1], [-1.0, 0.0, 0.0], None, [false; 2], false).unwrap().arch
    };
    assert!(arch(10, 0.0) < 1e-12);
    // Twice as many facets: ten nodes of 21 in the middle of chords of the hole, the others at its nodes. Those over the two chords at the ends of the quarter, whose end has the normal of one facet
    // only, are too far away for their arches.
    let middle = 2.0 * (1.0 - (0.5 * chord).cos());
    let expected = middle * 8.0 / 19.0;
    let got = arch(20, 0.0);
    assert!((got / expected - 1.0).abs() < 0.01, "{got} {expected}");
    // Contact that knows the hole to be round sees a ninth of it; how far its facets may be off in the watch is told beside.
    let things = [(quarter(2.0, 20, false, 0.0), false), (quarter(2.0, 10, true, 0.0), false)];
    let known = watch(things, |_, x| x).meeting([0, 1], [-1.0, 0.0, 0.0], None, [false, true], false).unwrap();
    assert!(
        (known.arch * 9.0 / got - 1.0).abs() < 0.3 && (known.known_arches / middle - 1.0).abs() < 0.01,
        "{known:?}"
    );
    // A quarter of a pin that is smaller by a tenth touches along a line.
    let small = [(quarter(1.8, 20, false, 0.2), false), (quarter(2.0, 10, true, 0.0), false)];
    assert_eq!(watch(small, |_, x| x).meeting([0, 1], [-1.0, 0.0, 0.0], None, [false; 2], false).unwrap().arch, 0.0);
    // Nor is it where the other side is flat, though nodes of it are within the arches of coarse facets.
    let flat = [(brick([1.99, -0.6, 0.0], [2.5, 0.6, 1.0]), true), (quarter(2.0, 4, false, 0.0), false)];
    assert_eq!(watch(flat, |_, x| x).meeting([0, 1], [1.0, 0.0, 0.0], None, [false; 2], false).unwrap().arch, 0.0);
}
