//! A slave facet against a sheet of three by three facets that is crumpled at will: nothing that lies opposite is left out, nothing is covered twice.

#![no_main]

mod input;

use input::Numbers;
use libfuzzer_sys::fuzz_target;
use stoss_segmentation::{GapRange, MasterFacet, SlaveFrame, check_coverage, segment_facet};

/// Nodes differ by a thousandth of a facet or not at all. Where a folded sheet is nearly edge-on and nearly on edges of the slave at once, closer than that,
/// areas are covered twice by up to the differences of the nodes.
const FINEST: i32 = 10;

fuzz_target!(|data: &[u8]| {
    let mut numbers = Numbers::new(data, FINEST);
    let slave = numbers.quad();
    let nodes: Vec<_> = (0..16).map(|_| numbers.point()).collect();
    let facet = |f: usize| {
        let k = f % 3 + 4 * (f / 3);
        let ids = [k, k + 4, k + 5, k + 1];
        MasterFacet { id: f as u32, nodes: ids.map(|k| k as u32).into(), corners: ids.map(|k| nodes[k]).into() }
    };
    let sheet: Vec<MasterFacet> = (0..9).map(facet).collect();
    if SlaveFrame::new(slave).is_err() {
        return;
    }
    let found = segment_facet(slave, &sheet, GapRange::ALL).expect("the slave has a normal");
    let report = check_coverage(&found, &sheet, GapRange::ALL).expect("the slave has a normal");
    // Of a slave with next to no area the coordinates' round-off is left.
    let size = slave.iter().chain(&nodes).map(|x| x.norm()).fold(0.0, f64::max);
    let tolerance = 1e-12 + 1e-14 * size * size / found.frame.image_area();
    // A slave that is split lies over itself in part: there the same points are covered by both pieces.
    assert!(report.missing.is_empty(), "{report:?}");
    assert!(found.frame.is_split() || report.double <= tolerance, "{report:?}");
    let image: f64 = found.segments.iter().map(|s| s.image_area()).sum();
    assert!(found.frame.is_split() || image <= found.frame.image_area() * (1.0 + tolerance), "{image}");
});
