//! A square over a grid of facets that is turned against it: the pieces of the square that lie opposite each facet.
//!
//! Checked: the areas of the pieces add up to that of the square wherever it is covered; of two equal squares that are turned by 45 degrees
//! the overlap is an octagon of area `8 (sqrt 2 - 1)`; the crate's own check of the coverage agrees.
//!
//! `cargo run --example overlap -p stoss-segmentation`

use nalgebra::{Rotation3, Vector3};
use stoss_segmentation::{GapRange, MasterFacet, Segment, SegmentationError, check_coverage, segment_facet};

/// `n x n` facets over `[-size, size]^2`, turned about z, at the height 0.1, looking down.
fn grid(n: usize, size: f64, angle: f64) -> Vec<MasterFacet> {
    let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    let place = |node: usize| {
        let [x, y] = [node % (n + 1), node / (n + 1)].map(|k| size * (2.0 * k as f64 / n as f64 - 1.0));
        rotation * Vector3::new(x, y, 0.1)
    };
    let facet = |k: usize| {
        let first = k / n * (n + 1) + k % n;
        let nodes = [first, first + n + 1, first + n + 2, first + 1];
        MasterFacet { id: k as u32, nodes: nodes.map(|k| k as u32).into(), corners: nodes.map(place).into() }
    };
    (0..n * n).map(facet).collect()
}

fn main() -> Result<(), SegmentationError> {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vector3::new(x, y, 0.0));
    println!("facets  turned by  pieces  vertices  triangles  area      closed form");
    let octagon = 8.0 * (2.0_f64.sqrt() - 1.0);
    for (n, size, degrees, expected) in
        [(3, 1.5, 0.0, 4.0), (3, 1.5, 20.0, 4.0), (7, 2.0, 33.0, 4.0), (1, 1.0, 45.0, octagon), (4, 1.0, 45.0, octagon)]
    {
        let master = grid(n, size, f64::to_radians(degrees));
        let found = segment_facet(square, &master, GapRange::ALL)?;
        let area: f64 = found.segments.iter().map(Segment::image_area).sum();
        let vertices: usize = found.segments.iter().map(|segment| segment.vertices().len()).sum();
        let triangles: usize = found.segments.iter().map(|segment| segment.triangles().count()).sum();
        let pieces = found.segments.len();
        println!("{:6} {degrees:10} {pieces:7} {vertices:9} {triangles:10}  {area:.6} {expected:12.6}", n * n);
        assert!((area - expected).abs() < 1e-13, "{area}");
        // Every vertex knows its place on both facets and the gap between them.
        assert!(found.segments.iter().flat_map(Segment::vertices).all(|vertex| (vertex.gap - 0.1).abs() < 1e-14));
        assert!(check_coverage(&found, &master, GapRange::ALL)?.is_tiling(1e-13));
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), SegmentationError> {
    main()
}
