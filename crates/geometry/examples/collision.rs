//! A point flies through a surface of triangles in one step: candidates from a tree over the motion, then the part of the step that is safe.
//!
//! Checked: the tree finds what looking at all triangles finds; each advance keeps a tenth of the distance or a little more, so that the point
//! comes as near as one likes to the place of the hit, which is known, and never behind it.
//!
//! `cargo run --example collision -p stoss-geometry`

use nalgebra::Vector3;
use stoss_geometry::{BoundingVolume, BoundingVolumeTree, MovingBox, PairKind, closest, safe_fraction};

/// Part of the distance that an advance keeps.
const KEEP: f64 = 0.1;

fn main() {
    // A level surface of 2 x 20 x 20 triangles at z = 0, at rest.
    let n = 20;
    let place = |i: usize, j: usize| Vector3::new(i as f64, j as f64, 0.0) / n as f64;
    let mut triangles = Vec::new();
    for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
        let [a, b, c, d] = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let at_rest = |x: &Vector3<f64>| MovingBox::new(x, &Vector3::zeros(), 0.0);
    let boxes: Vec<MovingBox> =
        triangles.iter().map(|t| t.iter().map(at_rest).fold(MovingBox::empty(), |a, b| a.union(&b))).collect();
    let tree = BoundingVolumeTree::build(&boxes);

    let (mut x, mut motion) = (Vector3::new(0.31, 0.42, 0.3), Vector3::new(0.2, 0.1, -0.9));
    let hit = x + motion / 3.0;
    let mut before = x.z;
    println!("advance  candidates  distance      from the place of the hit");
    for advance in 0..6 {
        let fraction = |k: usize| {
            let [a, b, c] = triangles[k];
            let still = Vector3::zeros();
            safe_fraction(PairKind::VertexTriangle, &[x, a, b, c], &[motion, still, still, still], KEEP)
        };
        let (mut candidates, mut safe) = (0, 1.0_f64);
        tree.query(&MovingBox::new(&x, &motion, 0.0), |k| {
            candidates += 1;
            safe = safe.min(fraction(k));
        });
        assert_eq!(safe, (0..triangles.len()).map(fraction).fold(1.0, f64::min));
        x += safe * motion;
        motion *= 1.0 - safe;
        let distance =
            |t: &[Vector3<f64>; 3]| closest(PairKind::VertexTriangle, &[x, t[0], t[1], t[2]]).distance_squared.sqrt();
        let distance = triangles.iter().map(distance).fold(f64::INFINITY, f64::min);
        println!("{advance:7} {candidates:11} {distance:13.3e} {:13.3e}", (x - hit).norm());
        assert!(distance >= KEEP * before && distance < 1.1 * KEEP * before, "{distance} {before}");
        before = distance;
    }
}

#[test]
fn the_checks_hold() {
    main();
}
