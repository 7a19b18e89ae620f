//! A node that slides from facet to facet never loses contact, jumps, or is caught twice; rims, thin bodies, depth.

use crate::common::*;
use nalgebra::Vector3;
use stoss_contact::{MasterSearch, SearchOptions};

/// Slides along `path` with the hint of the step before; checks that there is always a partner, that the true gap changes no faster than
/// the position and that the gap to the kept facet stays within the promised slack of it. Returns the facets, each run once.
fn slide(search: &MasterSearch, q: &[f64], path: impl Iterator<Item = Vector3<f64>>) -> Vec<u32> {
    let view = search.at(q);
    let slack = 0.1 * search.options().hysteresis * search.surface().length_scale();
    let mut facets: Vec<u32> = Vec::new();
    let mut last: Option<(Vector3<f64>, f64)> = None;
    for x in path {
        let point = view.pair(&x, facets.last().copied(), None);
        let pairing = point.pairing.unwrap_or_else(|| panic!("lost at {x:?}: {point:?}"));
        if let Some((before, gap)) = last {
            assert!((point.gap - gap).abs() <= (x - before).norm() + 1e-13, "jump at {x:?}: {gap} {}", point.gap);
        }
        // A valley's edge is farther away than both planes; else pairing and truth agree.
        if point.feature.name() == "face" {
            assert!((pairing.gap - point.gap).abs() <= slack + 1e-13, "{point:?}");
        }
        if facets.last() != Some(&pairing.facet) {
            facets.push(pairing.facet);
        }
        last = Some((x, point.gap));
    }
    facets
}

fn assert_each_once(facets: &[u32]) {
    let mut sorted = facets.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), facets.len(), "a facet was entered twice: {facets:?}");
}

fn line(from: [f64; 3], to: [f64; 3], steps: u32) -> impl Iterator<Item = Vector3<f64>> {
    (0..=steps).map(move |i| Vector3::from(from).lerp(&Vector3::from(to), f64::from(i) / f64::from(steps)))
}

/// A roof or trough along y: height `slope * |x|`.
fn bent(slope: f64) -> (Facets, Vec<f64>) {
    sheet(10, 3, move |u, v| [u - 5.0, v - 1.5, slope * (u - 5.0).abs()])
}

#[test]
fn over_a_convex_ridge_and_through_a_concave_valley() {
    for slope in [-1.0, -0.1, 0.1, 1.0] {
        let (facets, q) = bent(slope);
        let search = search(&facets, &q, SearchOptions::default());
        for offset in [-0.05, -1e-9, 0.0, 1e-9, 0.05] {
            let path = (0..=900).map(|i| {
                let x = -4.5 + f64::from(i) * 0.01;
                Vector3::new(x, 0.2, slope * x.abs() + offset)
            });
            let visited = slide(&search, &q, path);
            assert_each_once(&visited);
            // Along the slope facets follow one another; a valley or ridge may end the neighbours' strips earlier, but
            // none is left out: they are ten in a row.
            assert_eq!(visited.len(), 10, "slope {slope}, offset {offset}: {visited:?}");
        }
    }
}

#[test]
fn a_node_on_an_edge_keeps_its_facet_in_spite_of_noise() {
    let (facets, q) = bent(-0.2);
    let search = search(&facets, &q, SearchOptions::default());
    for edge in [0.0, 1.0] {
        let path = (0..200).map(|i| {
            let noise = 1e-4 * (f64::from(i) * 12.9898).sin();
            Vector3::new(edge + noise, 0.2, -0.2 * edge)
        });
        assert_eq!(slide(&search, &q, path).len(), 1);
    }
}

#[test]
fn across_a_cube_s_edges_and_corner() {
    let cubes = block(3, 3, 3);
    let (facets, q) = voxels(&cubes);
    let search = search(&facets, &q, unlimited());
    for depth in [-0.2, -1e-6, 0.0, 1e-6, 0.2] {
        // The surface at distance `depth` around the corner (3,3,3): top, then the side x = 3; around edges the offset is rounded outside.
        let reach = 3.0 + depth;
        let path =
            line([0.5, 2.7, reach], [reach, 2.7, reach], 400).chain(line([reach, 2.7, reach], [reach, 2.7, 0.5], 400));
        let visited = slide(&search, &q, path);
        assert_each_once(&visited);
        assert_eq!(visited.len(), 6, "{depth}: {visited:?}");
        let diagonal =
            line([1.5, 1.45, reach], [reach, reach, reach], 400).chain(line([reach; 3], [reach, 1.5, 1.45], 400));
        assert_each_once(&slide(&search, &q, diagonal));
    }
}

#[test]
fn along_a_curved_surface() {
    // A wave of amplitude 0.4 over 20 facets, warped across.
    let height = |x: f64, y: f64| 0.4 * (0.7 * x).sin() + 0.1 * x * y / 20.0;
    let (facets, q) = sheet(20, 4, |u, v| [u, v, height(u, v)]);
    let search = search(&facets, &q, SearchOptions::default());
    for offset in [-0.1, 0.0, 0.1] {
        let path = (0..=1900).map(|i| {
            let (x, y) = (0.5 + 0.01 * f64::from(i), 1.3 + 0.001 * f64::from(i));
            Vector3::new(x, y, height(x, y) + offset)
        });
        let visited = slide(&search, &q, path);
        assert_each_once(&visited);
        assert!((20..=23).contains(&visited.len()), "{visited:?}");
    }
}

#[test]
fn slides_of_many_facets_in_one_step() {
    let (facets, q) = sheet(120, 3, |u, v| [u, v, 0.2 * (0.3 * u).sin()]);
    let search = search(&facets, &q, SearchOptions::default());
    let view = search.at(&q);
    for count in [1u32, 10, 100] {
        let u = 1.5 + f64::from(count);
        let x = Vector3::new(u, 1.5, 0.2 * (0.3 * u).sin() - 0.05);
        let facet = |u: f64| 120 + u as u32;
        let point = view.pair(&x, Some(facet(1.5)), None);
        // The hint is history, not truth: the answer is that of the search without it.
        assert_eq!(point, view.closest(&x, None));
        assert_eq!(point.pairing.map(|p| p.facet), Some(facet(u)), "{count}");
    }
    // A hint from another surface is no hint.
    let x = Vector3::new(60.5, 1.5, 0.0);
    assert_eq!(view.pair(&x, Some(99_999), None), view.closest(&x, None));
}

#[test]
fn contact_ends_at_the_rim_of_an_open_surface() {
    let (facets, q) = sheet(4, 4, |u, v| [u, v, 0.0]);
    let mut search = search(&facets, &q, SearchOptions::default());
    let half_edge = 0.5;
    let overhang = search.options().overhang * half_edge;
    for (x, gap) in [(4.0, Some(-0.1)), (4.0 + 0.9 * overhang, Some(-0.1)), (4.0 + 1.1 * overhang, None), (4.5, None)] {
        let point = search.at(&q).closest(&Vector3::new(x, 1.3, -0.1), None);
        assert_eq!(point.gap, gap.unwrap_or(f64::INFINITY), "{x}");
        assert_eq!((point.pairing.is_none(), point.beyond_rim()), (gap.is_none(), gap.is_none()), "{x}");
        assert_eq!(point.feature.name(), "edge");
    }
    // The rim's corner, exactly, and just off it.
    for (d, paired) in [(0.0, true), (0.9 * overhang, true), (0.1, false)] {
        let point = search.at(&q).closest(&Vector3::new(4.0 + d, 4.0 + d, -1e-3), None);
        assert_eq!((point.feature.name(), point.pairing.is_some()), ("vertex", paired));
    }
    // Reach.
    search.update(&q, 0.3);
    assert!(search.at(&q).closest(&Vector3::new(2.2, 2.2, 0.29), None).pairing.is_some());
    assert_eq!(search.at(&q).closest(&Vector3::new(2.2, 2.2, 0.31), None).pairing, None);
}

#[test]
fn deep_points_are_not_captured() {
    let cubes = block(6, 6, 6);
    let (facets, q) = voxels(&cubes);
    let search = search(&facets, &q, SearchOptions { depth_limit: 0.5, ..SearchOptions::default() });
    let at = |z: f64, hint| search.at(&q).pair(&Vector3::new(3.2, 3.3, z), hint, None);
    let top = at(5.6, None).pairing.map(|p| p.facet);
    assert!(top.is_some());
    assert_eq!(at(5.51, top).gap, 5.51 - 6.0);
    assert_eq!(at(5.49, top).pairing, None);
    assert_eq!(at(5.49, None).gap, f64::INFINITY);
    assert_eq!(at(5.49, None).feature.name(), "face");
}

#[test]
fn the_far_side_of_a_thin_plate_does_not_capture() {
    // 8 x 8 x 1, squeezed to a thickness of 0.1.
    let thickness = 0.1;
    let (facets, mut q) = voxels(&block(8, 8, 1));
    q.iter_mut().skip(2).step_by(3).for_each(|z| *z *= thickness);
    let search = search(&facets, &q, SearchOptions::default());
    let view = search.at(&q);
    let top = view.closest(&Vector3::new(4.3, 4.4, 0.2), None).pairing.map(|p| p.facet);
    let down = -Vector3::z();
    for x in [4.3, 5.6, 1.2] {
        let deep = Vector3::new(x, 4.4, 0.02);
        // Without history and normal the bottom is nearest, and that is what the plain search says.
        assert!((view.closest(&deep, None).gap + 0.02).abs() < 1e-15);
        for point in [view.pair(&deep, top, None), view.closest(&deep, Some(&down)), view.pair(&deep, top, Some(&down))]
        {
            assert!((point.gap + 0.08).abs() < 1e-15, "{point:?}");
            assert_eq!(point.normal, Vector3::z());
        }
        // Through the plate in one step: the history still knows the side.
        let below = Vector3::new(x, 4.4, -0.05);
        assert!((view.pair(&below, top, None).gap + 0.15).abs() < 1e-15);
    }
    // Beside the plate there is no contact with its top.
    assert!(view.pair(&Vector3::new(8.05, 4.4, 0.05), top, Some(&down)).gap > 0.0);
}
