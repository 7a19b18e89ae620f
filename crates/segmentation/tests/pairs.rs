//! One pair of facets against an independent clipping of polygons, degenerate pairs, and derivatives against
//! differences.
//!
//! `STOSS_FUZZ_PAIRS=1000000` sets the number of random pairs.

use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use stoss_reference_cases::facets::{Quad, RandomQuad, SQUARE, common_area, flat, reversed};
use stoss_reference_element::{FacetKind, MAX_NODES, Nodal};
use stoss_segmentation::{LOCAL, MASTER, Provenance, Segment, SlaveFrame, segment_pair, segment_pair_within};

fn cases() -> u32 {
    std::env::var("STOSS_FUZZ_PAIRS").ok().and_then(|s| s.parse().ok()).unwrap_or(256)
}

type Facet = Nodal<Vector3<f64>>;

fn segments(s: impl Into<Facet>, m: impl Into<Facet>) -> (SlaveFrame, Vec<Segment>) {
    let (s, m) = (s.into(), m.into());
    segments_within(s, m, [s.map(|_| 0), m.map(|_| 0)])
}

/// Segments of two facets, with the planes of symmetry that the corners of both lie in.
fn segments_within(s: Facet, m: Facet, [slave, master]: [Nodal<u8>; 2]) -> (SlaveFrame, Vec<Segment>) {
    let frame = SlaveFrame::new(s).unwrap().with_planes(&slave);
    let mut out = Vec::new();
    segment_pair_within(&frame, 0, &m, &master, &mut out).unwrap();
    (frame, out)
}

fn image_area(s: &[Segment]) -> f64 {
    s.iter().map(Segment::image_area).sum()
}

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-size..size).prop_map(Vector3::from)
}

/// A square of size `scale`, its corners moved by up to `warp` of it, turned and shifted; with `lattice` half of
/// them on a lattice of 1/2, where corners and edges coincide.
fn quad(warp: f64, lattice: bool) -> impl Strategy<Value = Quad> {
    (
        prop::array::uniform4(vector(warp)),
        vector(RandomQuad::TILT),
        vector(RandomQuad::SHIFT),
        RandomQuad::SCALE[0]..RandomQuad::SCALE[1],
        any::<bool>(),
    )
        .prop_map(move |(moves, tilt, shift, scale, snap)| {
            RandomQuad { moves, tilt, shift, scale, snap: snap && lattice }.place()
        })
}

/// Random facets of any kind: a triangle has the first three corners.
fn facet(warp: f64, lattice: bool) -> impl Strategy<Value = Facet> {
    (quad(warp, lattice), prop::sample::select(&FacetKind::ALL[..]))
        .prop_map(|(quad, kind)| Nodal::from_fn(kind, |k| quad[k]))
}

/// Numbered the other way round.
fn turned(f: Facet) -> Facet {
    Nodal::from_fn(f.kind(), |k| f[(f.len() - k) % f.len()])
}

/// The facet as a quadrilateral: a triangle gets a corner in the middle of its last edge.
fn as_quad(f: &Facet) -> Quad {
    std::array::from_fn(|k| f.get(k).copied().unwrap_or((f[0] + f[2]) * 0.5))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    /// Two facets with a side each in the plane x = 0, one above the other, whose normals are tilted out of it: up to there the segment is bounded by the side of the slave, whether projection moves that of
    /// the master to this side of it or to the other.
    #[test]
    fn at_a_plane_of_symmetry_the_slave_ends(
        tilts in prop::array::uniform2(-0.3f64..0.3), gap in -0.3f64..0.3, lengths in prop::array::uniform2(0.5f64..2.0), shift in -0.4f64..0.4, warp in prop::array::uniform8(-0.05f64..0.05),
    ) {
        let facet = |length: f64, tilt: f64, height: f64, y: f64, warp: &[f64]| -> Facet {
            let at = |x: f64, side: f64, w: f64| Vector3::new(x, y + side + w, height + tilt * x);
            Nodal::from([at(0.0, -1.0, warp[0]), at(length, -1.0, warp[1]), at(length, 1.0, warp[2]), at(0.0, 1.0, warp[3])])
        };
        let s = facet(lengths[0], tilts[0], 0.0, 0.0, &warp[..4]);
        let m = turned(facet(lengths[1], tilts[1], gap, shift, &warp[4..]));
        let in_plane = |f: &Facet| f.map(|x| u8::from(x.x == 0.0));
        let planes = [in_plane(&s), in_plane(&m)];
        let (_, found) = segments_within(s, m, planes);
        let at_plane = |v: &&stoss_segmentation::Vertex| v.slave[0] == -1.0;
        prop_assert_eq!(found.iter().flat_map(Segment::vertices).filter(at_plane).count(), 2);
        check_derivatives_within(&s, &m, planes)?;
    }

    /// A facet is opposite the whole of its own back, and nothing of itself.
    #[test]
    fn a_facet_and_itself(s in facet(0.3, false)) {
        prop_assume!(SlaveFrame::new(s).is_ok());
        let (frame, whole) = segments(s, turned(s));
        prop_assert!((image_area(&whole) / frame.image_area() - 1.0).abs() < 1e-12);
        prop_assert_eq!(image_area(&segments(s, s).1), 0.0);
    }

    /// The neighbours over an edge, in the plane of the facet, and over a corner: they have the edge or the corner in common, exactly, and lie beyond.
    #[test]
    fn neighbours_share_no_area(s in quad(0.3, false), k in 0usize..4) {
        let normal = SlaveFrame::new(s).unwrap().normal();
        let s = s.map(|x| x - normal * normal.dot(&(x - s[0])));
        let frame = SlaveFrame::new(s).unwrap();
        let [a, b, c] = [0, 1, 2].map(|i| s[(k + i) % 4]);
        let out = (b - a).cross(&frame.normal());
        for m in [[b, a, a + out, b + out], [b, b + (b - c), b + (b - a) + (b - c), b + (b - a)]].map(reversed) {
            if let Some((area, _)) = common_area(&s, &m) {
                prop_assert!((image_area(&segments(s, m).1) - area).abs() < 1e-12 * frame.image_area());
            }
        }
    }

    /// Seen edge on, down to a hundred millionth of a right angle.
    #[test]
    fn area_of_a_steep_facet(power in -8.0f64..-1.0, shift in vector(0.5)) {
        let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2 * (1.0 - 10f64.powf(power)));
        let (s, m) = (flat(SQUARE, 0.0), reversed(flat(SQUARE, 0.0)).map(|x| turn * x + shift));
        if let Some((area, whole)) = common_area(&s, &m) {
            prop_assert!((image_area(&segments(s, m).1) - area).abs() <= 1e-10 * whole.max(area));
        }
    }

    #[test]
    fn area_is_that_of_the_polygons(
        s in facet(0.8, true), m in facet(0.8, true), warped in [facet(1.5, false), facet(1.5, false)], reflex: bool, back in any::<bool>(),
    ) {
        // Corners moved over the diagonals: reflex images, split into triangles.
        let [s, m] = if reflex { warped } else { [s, m] };
        let m = if back { m } else { turned(m) };
        let Ok(frame) = SlaveFrame::new(s) else { return Ok(()) };
        let mut out = Vec::new();
        segment_pair(&frame, 0, &m, &mut out).unwrap();
        if let Some((area, whole)) = common_area(&as_quad(&s), &as_quad(&m)) {
            prop_assert!((image_area(&out) - area).abs() <= 1e-10 * whole.max(area), "{} {area}", image_area(&out));
        }
        for segment in &out {
            prop_assert!(segment.vertices().len() >= 3);
            for v in segment.vertices() {
                prop_assert!(s.kind().excess(v.slave) <= 0.0 && m.kind().excess(v.master) <= 0.0);
                // The point of the slave lies under the point of the master.
                let x1 = at(segment.slave_map.weights(v.slave), &s);
                let x2 = at(segment.master_map.weights(v.master), &m);
                let r = x2 - x1 - frame.normal() * v.gap;
                let size = m.iter().chain(&s).map(|x| x.norm()).fold(0.0, f64::max);
                prop_assert!(r.norm() < 1e-9 * size, "{:?} {r:?}", v.provenance);
            }
        }
    }

}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases().min(20_000)))]

    #[test]
    fn derivatives_are_those_of_differences(s in facet(0.25, false), m in facet(0.25, false)) {
        if SlaveFrame::new(s).is_ok() {
            check_derivatives(&s, &turned(m))?;
        }
    }
}

fn at(w: [f64; MAX_NODES], x: &Facet) -> Vector3<f64> {
    x.iter().zip(w).map(|(x, w)| x * w).sum()
}

fn check_derivatives(s: &Facet, m: &Facet) -> Result<(), TestCaseError> {
    check_derivatives_within(s, m, [s.map(|_| 0), m.map(|_| 0)])
}

fn check_derivatives_within(s: &Facet, m: &Facet, planes: [Nodal<u8>; 2]) -> Result<(), TestCaseError> {
    let (frame, base) = segments_within(*s, *m, planes);
    // Of fourth order: where edges are nearly parallel derivatives change quickly.
    let h = 1e-5;
    let slope = |v: [f64; 4]| (8.0 * (v[0] - v[1]) - (v[2] - v[3])) / (12.0 * h);
    for segment in &base {
        let derivative = segment.vertex_derivatives(&frame, m);
        let centre = segment.centroid();
        let foot = segment.project(&frame, m, centre);
        let fixed = segment.project_derivative(&frame, m, centre, &foot, &[[0.0; LOCAL]; 2]);
        for k in 0..LOCAL {
            let moved = |d: f64| {
                let nudged = |x: &Facet, k: usize| {
                    Nodal::from_fn(x.kind(), |i| if i == k / 3 { x[i] + Vector3::ith(k % 3, d) } else { x[i] })
                };
                let (s, m) = if k < MASTER { (nudged(s, k), *m) } else { (*s, nudged(m, k - MASTER)) };
                (segments_within(s, m, planes), s, m)
            };
            let moved = [h, -h, 2.0 * h, -2.0 * h].map(moved);
            // Same polygons, or the set of vertices changes here and there is no derivative.
            let same = |a: &Segment| {
                a.slave_map == segment.slave_map
                    && a.master_map == segment.master_map
                    && a.vertices().len() == segment.vertices().len()
                    && a.vertices().iter().zip(segment.vertices()).all(|(x, y)| x.provenance == y.provenance)
            };
            let found = moved.each_ref().map(|((_, segments), _, _)| segments.iter().find(|a| same(a)));
            let [Some(a), Some(b), Some(c), Some(d)] = found else { continue };
            let found = [a, b, c, d];
            for i in 0..segment.vertices().len() {
                for c in 0..2 {
                    let size = derivative[i].slave[c]
                        .iter()
                        .chain(&derivative[i].master[c])
                        .fold(1.0, |a: f64, b| a.max(b.abs()));
                    let slopes = [
                        slope(found.map(|a| a.vertices()[i].slave[c])),
                        slope(found.map(|a| a.vertices()[i].master[c])),
                    ];
                    for (exact, difference) in
                        [derivative[i].slave[c][k], derivative[i].master[c][k]].into_iter().zip(slopes)
                    {
                        // Curvature grows with the cube of the derivative where edges are nearly parallel.
                        prop_assert!(
                            size > 100.0 || (exact - difference).abs() < 1e-7 * size.powi(3),
                            "{i} {k} {exact} {difference} {size}"
                        );
                    }
                }
            }
            let feet: [_; 4] = std::array::from_fn(|s| found[s].project(&moved[s].0.0, &moved[s].2, centre));
            for c in 0..2 {
                let size: f64 = fixed[c].iter().fold(1.0, |a: f64, b| a.max(b.abs()));
                let difference = slope(feet.map(|foot| foot.master[c]));
                prop_assert!((fixed[c][k] - difference).abs() < 1e-7 * size.powi(3));
            }
        }
    }
    Ok(())
}

#[test]
fn identical_facets_give_the_whole_facet() {
    let s = flat(SQUARE, 0.0);
    let (_, out) = segments(s, reversed(s));
    assert_eq!(out.len(), 1);
    assert!((out[0].parametric_area() - 4.0).abs() < 1e-14);
    assert!((image_area(&out) - 4.0).abs() < 1e-14);
}

#[test]
fn seen_from_behind_gives_nothing() {
    let s = flat(SQUARE, 0.0);
    assert!(segments(s, flat(SQUARE, 0.2)).1.is_empty());
    let upright = flat(SQUARE, 0.0).map(|x| Vector3::new(x.x, 0.0, x.y));
    assert!(segments(s, upright).1.is_empty());
    assert!(segments(s, reversed(upright)).1.is_empty());
}

#[test]
fn shared_edges_and_vertices_give_no_area() {
    let s = flat(SQUARE, 0.0);
    for shift in [[2.0, 0.0], [0.0, -2.0], [2.0, 2.0], [-2.0, 2.0], [2.0, 1.0]] {
        let m = reversed(s.map(|x| x + Vector3::new(shift[0], shift[1], 0.0)));
        assert_eq!(image_area(&segments(s, m).1), 0.0);
    }
}

#[test]
fn octagon_of_a_turned_square() {
    let s = flat(SQUARE, 0.0);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_4);
    let (_, out) = segments(s, reversed(s.map(|x| turn * x)));
    assert_eq!(out[0].vertices().len(), 8);
    assert!(out[0].vertices().iter().all(|v| matches!(v.provenance, Provenance::Intersection { .. })));
    // Regular octagon of inradius 1: 8 tan(pi / 8).
    assert!((image_area(&out) - 8.0 * (std::f64::consts::PI / 8.0).tan()).abs() < 1e-14);
}

#[test]
fn gap_is_positive_apart_and_negative_in_penetration() {
    let s = flat(SQUARE, 0.0);
    for (z, sign) in [(0.3, 1.0), (-0.3, -1.0)] {
        for segment in segments(s, reversed(flat(SQUARE, z))).1 {
            assert!(segment.vertices().iter().all(|v| (v.gap - sign * 0.3).abs() < 1e-15));
        }
    }
}

#[test]
fn strongly_warped_and_folded_facets_are_split() {
    // Corner 2 pulled over the diagonal: the image is reflex, two triangles.
    let s = flat([[-1.0, -1.0], [1.0, -1.0], [-0.5, -0.5], [-1.0, 1.0]], 0.0);
    let (frame, out) = segments(s, reversed(flat(SQUARE.map(|p| [3.0 * p[0], 3.0 * p[1]]), 0.1)));
    assert!(frame.is_split());
    assert_eq!(out.len(), 2);
    let parametric: f64 = out.iter().map(Segment::parametric_area).sum();
    assert!((parametric - 4.0).abs() < 1e-14);
    assert!((image_area(&out) - frame.image_area()).abs() < 1e-14);
}

#[test]
fn a_facet_that_touches_itself_counts_its_visible_part_once() {
    // A triangle of area 1/8 with a side that runs out and back; whether it crosses itself is left to round-off.
    for bend in [-1e-15, 0.0, 1e-15] {
        let m = flat([[0.0, -0.5], [0.0, 0.5], [0.5, 0.5], [bend, 0.0]], 0.0);
        assert!((image_area(&segments(flat(SQUARE, 0.0), m).1) - 0.125).abs() < 1e-14);
    }
}

#[test]
fn slivers_are_kept() {
    let s = flat(SQUARE, 0.0);
    for width in (1..=12).map(|power| 10f64.powi(-power)) {
        let m = reversed(flat([[-1.0, -1.0], [1.0, -1.0], [1.0, -1.0 + width], [-1.0, -1.0 + width]], 0.0));
        let area = 2.0 * ((-1.0 + width) + 1.0);
        assert!((image_area(&segments(s, m).1) - area).abs() < 1e-15);
    }
}

/// Found by fuzzing: corners of the facets lie on a line, and a coordinate of a vertex was 0/0.
#[test]
fn vertices_on_facets_without_area_are_numbers() {
    let s = [
        [0.0, 1.34375, 0.0],
        [0.0, 0.0, 5.820766091346741e-11],
        [-1.6718749999417923, 0.015625, 0.0],
        [0.0, -1.7763568394002505e-15, 0.0],
    ];
    let m = [[0.0, 0.0, 0.0], [0.0, -0.953125, 0.0], [0.0, 0.515625, 0.0], [-0.984375, 0.765625, 0.0]];
    let (_, out) = segments(s.map(Vector3::from), m.map(Vector3::from));
    let vertices = out.iter().flat_map(Segment::vertices);
    assert!(vertices.flat_map(|v| v.slave.into_iter().chain(v.master)).all(f64::is_finite));
}

#[test]
fn two_triangles_make_the_square_and_six_corners_at_most() {
    let square = flat(SQUARE, 0.0);
    let half = |a: usize, b: usize, c: usize| Facet::from([square[a], square[b], square[c]]);
    let parts = [half(0, 1, 2), half(2, 3, 0)];
    for part in parts {
        let (frame, out) = segments(part, reversed(square));
        assert!(!frame.is_split() && (frame.image_area() - 2.0).abs() < 1e-15);
        assert!((image_area(&out) - 2.0).abs() < 1e-15 && (out[0].parametric_area() - 0.5).abs() < 1e-15);
        for (other, expected) in parts.iter().zip([part == parts[0], part == parts[1]]) {
            let area = image_area(&segments(part, turned(*other)).1);
            assert!((area - if expected { 2.0 } else { 0.0 }).abs() < 1e-15);
        }
    }
    // A star of two regular triangles.
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / 6.0;
        Vector3::new(angle.cos(), angle.sin(), 0.0)
    };
    let (_, out) = segments([corner(0), corner(2), corner(4)], [corner(1), corner(5), corner(3)]);
    assert_eq!(out[0].vertices().len(), 6);
    assert!((image_area(&out) - 0.5 * 3.0_f64.sqrt()).abs() < 1e-15);
}

#[test]
fn bad_input_is_an_error() {
    let point = [Vector3::zeros(); 4];
    assert!(SlaveFrame::new([Vector3::zeros(), Vector3::x(), Vector3::x() * 2.0]).is_err());
    assert!(SlaveFrame::new(point).is_err());
    let frame = SlaveFrame::new(flat(SQUARE, 0.0)).unwrap();
    let nan = flat([[f64::NAN, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 0.0);
    assert!(segment_pair(&frame, 0, &nan.into(), &mut Vec::new()).is_err());
}
