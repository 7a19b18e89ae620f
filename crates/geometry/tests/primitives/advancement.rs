//! Collision detection against exact arithmetic: no contact before the end of the safe part, and no distance below what is kept.
//!
//! Contacts happen where a polynomial of the time vanishes: the volume of the four points; if that is zero at all times, the areas that a vertex spans with an edge; if
//! a pair is collinear at all times, differences of coordinates. All places where one may vanish are isolated on intervals of length `2^-48` by exact subdivision in the Bernstein
//! basis (tangential zeros included), and the exact distance there is compared with what is kept.

use crate::primitives::exact::{self, Fraction, Point};
use fastrand::Rng;
use nalgebra::Vector3;
use num_bigint::{BigInt, Sign};
use stoss_geometry::{PairKind, closest, combine, safe_fraction};

type Points = [Vector3<f64>; 4];

/// Depth of subdivision: intervals of length `2^-DEPTH`.
const DEPTH: usize = 48;

/// The distance kept, `1/8` of the start, and what round-off may take of it in the comparison: nothing.
const KEEP: f64 = 0.125;

/// Bernstein coefficients on `[0, 1]`, up to a common positive factor, of a polynomial in powers of `t`.
fn bernstein(c: &[BigInt]) -> Vec<BigInt> {
    match c {
        [a, b] => vec![a.clone(), a + b],
        [a, b, c] => vec![a * 2, a * 2 + b, (a + b + c) * 2],
        [a, b, c, d] => vec![a * 3, a * 3 + b, a * 3 + b * 2 + c, (a + b + c + d) * 3],
        _ => unreachable!("degree one to three"),
    }
}

/// Left ends, in units of `2^-DEPTH`, of the intervals on which the coefficients do not exclude a zero.
fn isolate(coefficients: Vec<BigInt>, found: &mut Vec<BigInt>) {
    let mut waiting = vec![(coefficients, BigInt::ZERO, 0usize)];
    while let Some((b, place, depth)) = waiting.pop() {
        if b.iter().all(|b| b.sign() == Sign::Plus) || b.iter().all(|b| b.sign() == Sign::Minus) {
            continue;
        }
        if depth == DEPTH {
            found.push(place);
            continue;
        }
        // De Casteljau with sums in place of means: level k carries a factor 2^k.
        let degree = b.len() - 1;
        let (mut left, mut right) = (vec![&b[0] << degree], vec![&b[degree] << degree]);
        let mut level = b;
        for k in 1..=degree {
            level = level.windows(2).map(|w| &w[0] + &w[1]).collect();
            left.push(&level[0] << (degree - k));
            right.push(&level[level.len() - 1] << (degree - k));
        }
        right.reverse();
        let place: BigInt = place << 1;
        waiting.push((left, place.clone(), depth + 1));
        waiting.push((right, place + 1, depth + 1));
    }
}

/// A point that moves: `x + t d`.
type Moving = [Point; 2];

fn difference(a: &Moving, b: &Moving) -> Moving {
    [exact::sub(&a[0], &b[0]), exact::sub(&a[1], &b[1])]
}

/// Coefficients of the cross product of two moving vectors.
fn cross(a: &Moving, b: &Moving) -> [Point; 3] {
    let (p, q) = (exact::cross(&a[0], &b[1]), exact::cross(&a[1], &b[0]));
    [exact::cross(&a[0], &b[0]), std::array::from_fn(|k| &p[k] + &q[k]), exact::cross(&a[1], &b[1])]
}

fn is_zero(polynomial: &[BigInt]) -> bool {
    polynomial.iter().all(|c| c.sign() == Sign::NoSign)
}

/// Polynomials of which at least one vanishes at the first contact.
fn contact_polynomials(kind: PairKind, x: &[Moving]) -> Vec<Vec<BigInt>> {
    let [e, f, g] = [1, 2, 3].map(|k| difference(&x[k], &x[0]));
    let n = cross(&e, &f);
    let mut volume = vec![BigInt::ZERO; 4];
    for (k, n) in n.iter().enumerate() {
        volume[k] += exact::dot(n, &g[0]);
        volume[k + 1] += exact::dot(n, &g[1]);
    }
    if !is_zero(&volume) {
        return vec![volume];
    }
    // Coplanar at all times: a corner meets an edge, or, where these are collinear at all times, its ends.
    let (vertex_edges, corners): (&[[usize; 3]], &[[usize; 2]]) = match kind {
        PairKind::VertexTriangle => (&[[0, 1, 2], [0, 2, 3], [0, 3, 1]], &[[0, 1], [0, 2], [0, 3]]),
        _ => (&[[0, 2, 3], [1, 2, 3], [2, 0, 1], [3, 0, 1]], &[[0, 2], [0, 3], [1, 2], [1, 3]]),
    };
    let areas = vertex_edges.iter().flat_map(|&[p, a, b]| {
        let n = cross(&difference(&x[p], &x[a]), &difference(&x[b], &x[a]));
        (0..3).map(move |k| n.iter().map(|n| n[k].clone()).collect())
    });
    let gaps = corners.iter().flat_map(|&[a, b]| {
        let d = difference(&x[a], &x[b]);
        (0..3).map(move |k| d.iter().map(|d| d[k].clone()).collect())
    });
    areas.chain(gaps).filter(|p: &Vec<BigInt>| !is_zero(p)).collect()
}

/// Squared distance at `t = place 2^-DEPTH`, in units of the points'.
fn distance_at(kind: PairKind, x: &[Moving], place: &BigInt) -> Fraction {
    let at = |x: &Moving| std::array::from_fn(|k| (&x[0][k] << DEPTH) + &x[1][k] * place);
    let p: Vec<Point> = x.iter().map(at).collect();
    let Fraction { numerator, denominator } = match kind {
        PairKind::VertexTriangle => exact::vertex_triangle(&p[0], [&p[1], &p[2], &p[3]]),
        _ => exact::edge_edge([&p[0], &p[1]], [&p[2], &p[3]]),
    };
    Fraction { numerator, denominator: denominator << (2 * DEPTH) }
}

fn place_of(t: f64) -> BigInt {
    // Times below 2^-DEPTH are rounded down, which is on the safe side of a test that must not accept too much.
    let (integer, exponent) = exact::integers(&[t]);
    let shift = DEPTH as i64 + exponent;
    if shift >= 0 { &integer[0] << shift } else { &integer[0] >> -shift }
}

#[derive(Default, Debug)]
struct Count {
    contacts: usize,
    contacts_seen: usize,
    free: usize,
    refused: usize,
    below_half: usize,
}

fn check(kind: PairKind, x: &Points, increment: &Points, count: &mut Count) {
    let case = || format!("{kind:?} {x:?} {increment:?}");
    let fraction = safe_fraction(kind, x, increment, KEEP);
    assert!((0.0..=1.0).contains(&fraction), "{fraction} {}", case());
    let (all, exponent) = exact::points(&[x.as_slice(), increment.as_slice()].concat());
    let moving: Vec<Moving> = (0..4).map(|i| [all[i].clone(), all[i + 4].clone()]).collect();
    let start = distance_at(kind, &moving, &BigInt::ZERO);
    if start.numerator.sign() == Sign::NoSign {
        assert_eq!(fraction, 0.0, "{}", case());
        count.refused += 1;
        return;
    }
    // The squared distance that is kept, KEEP^2 of the start. The program's own distance at the start is rounded, hence one part in 10^12.
    let kept = Fraction {
        numerator: &start.numerator * 999_999_999_999u64,
        denominator: &start.denominator * 64_000_000_000_000u64,
    };
    let end = place_of(fraction);
    // In an interval the points move by less than `resolution`.
    let path = increment.iter().map(|d| d.norm()).fold(0.0, f64::max);
    let resolution = 8.0 * path * 2f64.powi(-(DEPTH as i32));
    let mut places = Vec::new();
    contact_polynomials(kind, &moving).into_iter().for_each(|p| isolate(bernstein(&p), &mut places));
    let mut contact = false;
    for place in &places {
        let there = distance_at(kind, &moving, place);
        if *place <= end {
            assert!(!there.is_less(&kept), "contact missed: {fraction} {}", case());
            // What is kept is more than the motion within the interval: no contact in the whole of it.
            assert!(there.to_f64(2 * exponent).sqrt() > resolution, "undecided {}", case());
        }
        contact |= there.to_f64(2 * exponent).sqrt() <= resolution;
    }
    count.contacts_seen += usize::from(contact && fraction < 1.0);
    count.contacts += usize::from(contact);
    // The distance at the end of the safe part and on the way there.
    for k in 1..=8 {
        let place: BigInt = &end * k / 8;
        assert!(!distance_at(kind, &moving, &place).is_less(&kept), "{k} {fraction} {}", case());
    }
    if fraction == 1.0 {
        count.free += 1;
    } else {
        // As far as possible: a little later, or here, the distance is down at the limit.
        let at_end = distance_at(kind, &moving, &end).to_f64(2 * exponent).sqrt();
        let limit = KEEP * start.to_f64(2 * exponent).sqrt();
        let size = x.iter().chain(increment).map(|x| x.norm()).fold(0.0, f64::max);
        assert!(at_end <= 1.002 * limit + 1e-13 * size, "{at_end} {limit} {fraction} {}", case());
        count.below_half += usize::from(fraction < 0.5);
    }
}

const KINDS: [PairKind; 2] = [PairKind::VertexTriangle, PairKind::EdgeEdge];

fn vector(random: &mut Rng, size: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| size * (2.0 * random.f64() - 1.0))
}

fn points(random: &mut Rng, size: f64) -> Points {
    std::array::from_fn(|_| vector(random, size))
}

/// Points of a small lattice, so that coplanar, collinear, parallel and touching ones are frequent.
fn lattice(random: &mut Rng, range: i32) -> Points {
    std::array::from_fn(|_| Vector3::from_fn(|_, _| f64::from(random.i32(-range..=range))))
}

#[test]
fn random_motions() {
    let mut random = Rng::with_seed(1);
    let mut count = Count::default();
    for k in 0..4000 {
        let size = [0.1, 1.0, 3.0, 10.0][k / 2 % 4];
        check(KINDS[k % 2], &points(&mut random, 1.0), &points(&mut random, size), &mut count);
    }
    assert!(count.contacts > 200 && count.free > 2000 && count.below_half > 200, "{count:?}");
    assert_eq!(count.contacts, count.contacts_seen);
}

#[test]
fn lattice_motions() {
    let mut random = Rng::with_seed(2);
    let mut count = Count::default();
    for k in 0..2500 {
        check(KINDS[k % 2], &lattice(&mut random, 2), &lattice(&mut random, 2), &mut count);
    }
    assert!(count.contacts > 100 && count.free > 500 && count.refused > 50, "{count:?}");
    assert_eq!(count.contacts, count.contacts_seen);
}

#[test]
fn coplanar_and_collinear_motions() {
    let mut random = Rng::with_seed(3);
    let mut count = Count::default();
    for k in 0..1500 {
        let flat = |mut points: Points| {
            points.iter_mut().for_each(|p| p.z = 0.0);
            if k % 3 == 0 {
                points.iter_mut().for_each(|p| p.y = 0.0);
            }
            points
        };
        let (x, increment) = if k % 4 < 2 {
            (points(&mut random, 1.0), points(&mut random, 2.0))
        } else {
            (lattice(&mut random, 3), lattice(&mut random, 4))
        };
        check(KINDS[k % 2], &flat(x), &flat(increment), &mut count);
    }
    assert!(count.contacts > 200 && count.free > 200 && count.refused > 50, "{count:?}");
    assert_eq!(count.contacts, count.contacts_seen);
}

/// A vertex or an edge that slides along a triangle or an edge at a small height, which it keeps, or leaves, or loses just at the end.
#[test]
fn sliding_and_touching_at_the_end() {
    let mut random = Rng::with_seed(4);
    let (mut count, mut slides) = (Count::default(), 0);
    for k in 0..1500 {
        let kind = KINDS[k % 2];
        let height = 2f64.powi(-random.i32(1..30));
        let mut x = lattice(&mut random, 3);
        let first = kind.first_count();
        x[..first].iter_mut().for_each(|p| p.z = height);
        x[first..].iter_mut().for_each(|p| p.z = 0.0);
        let mut increment = [Vector3::zeros(); 4];
        let slide = vector(&mut random, 4.0);
        // Down to touch at the end, exactly; not at all; to three quarters of the way; through.
        let fall = [1.0, 0.0, 0.75, 1.5][k / 2 % 4] * height;
        increment[..first].iter_mut().for_each(|d| *d = Vector3::new(slide.x, slide.y, -fall));
        check(kind, &x, &increment, &mut count);
        let fraction = safe_fraction(kind, &x, &increment, KEEP);
        // Above each other at the start, they keep a quarter of the height or all of it.
        if fall < 0.8 * height && closest(kind, &x).distance_squared.sqrt() == height {
            assert_eq!(fraction, 1.0);
            slides += 1;
        }
    }
    assert!(count.contacts > 50 && count.free > 500 && slides > 100, "{count:?} {slides}");
    assert_eq!(count.contacts, count.contacts_seen);
}

/// Small distances, and rotations of the whole by large angles (whose points move along chords), with and without a motion of their own.
#[test]
fn near_pairs_that_turn_together() {
    let mut random = Rng::with_seed(5);
    let mut count = Count::default();
    for k in 0..1500 {
        let kind = KINDS[k % 2];
        let gap = 10f64.powi(-random.i32(1..9));
        let mut x = points(&mut random, 1.0);
        let r = combine(&closest(kind, &x).weights, &x);
        x[..kind.first_count()].iter_mut().for_each(|p| *p += r * (gap / r.norm() - 1.0));
        let turn = nalgebra::Rotation3::new(vector(&mut random, 1.5));
        let own = [0.0, 1.0, 3.0][k / 2 % 3] * gap;
        let increment = x.map(|x| turn * x - x + vector(&mut random, own));
        check(kind, &x, &increment, &mut count);
    }
    assert!(count.contacts > 50 && count.free > 500, "{count:?}");
    assert_eq!(count.contacts, count.contacts_seen);
}

/// Primitives that share a point, or have all points in one, touch at the start.
#[test]
fn shared_points_have_no_safe_fraction() {
    let mut random = Rng::with_seed(6);
    for k in 0..200 {
        let kind = KINDS[k % 2];
        let (mut x, increment) = (points(&mut random, 1.0), points(&mut random, 1.0));
        x[3] = x[0];
        assert_eq!(safe_fraction(kind, &x, &increment, KEEP), 0.0);
        assert_eq!(safe_fraction(kind, &[x[0]; 4], &increment, KEEP), 0.0);
    }
}

/// A power of two as the unit changes nothing, however large.
#[test]
fn scales() {
    let mut random = Rng::with_seed(7);
    for k in 0..400 {
        let (x, increment) = (points(&mut random, 1.0), points(&mut random, 2.0));
        let fraction = safe_fraction(KINDS[k % 2], &x, &increment, KEEP);
        for unit in [2f64.powi(-300), 2f64.powi(160)] {
            assert_eq!(safe_fraction(KINDS[k % 2], &x.map(|x| x * unit), &increment.map(|d| d * unit), KEEP), fraction);
        }
    }
}
