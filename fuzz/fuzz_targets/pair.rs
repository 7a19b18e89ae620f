//! Two facets of any shape against the clipping by slabs: the same area, every vertex on both facets.

#![no_main]

mod input;

use input::Numbers;
use libfuzzer_sys::fuzz_target;
use nalgebra::Vector3;
use stoss_reference_cases::facets::common_area;
use stoss_segmentation::{SlaveFrame, segment_pair};

fuzz_target!(|data: &[u8]| {
    let mut numbers = Numbers::new(data, 63);
    let (slave, master) = (numbers.quad(), numbers.quad());
    let Ok(frame) = SlaveFrame::new(slave) else { return };
    let mut segments = Vec::new();
    segment_pair(&frame, 0, &master.into(), &mut segments).expect("all coordinates are finite");
    let area: f64 = segments.iter().map(|s| s.image_area()).sum();
    // Of images with next to no area, or edge, or a corner that is nearly flat, the coordinates' round-off is left.
    let normal = frame.normal();
    let size = slave.iter().chain(&master).map(|x| x.norm()).fold(0.0, f64::max);
    let corner =
        |x: &[Vector3<f64>; 4], k: usize| (x[(k + 1) % 4] - x[k]).cross(&(x[(k + 3) % 4] - x[k])).dot(&normal).abs();
    let least = (0..4).map(|k| corner(&slave, k).min(corner(&master, k))).fold(size * size, f64::min);
    if let Some((expected, whole)) = common_area(&slave, &master).filter(|(_, whole)| whole.is_finite()) {
        let tolerance = 1e-10 * whole.max(expected) + 1e-15 * size.powi(4) / least.min(whole);
        // Not `<=`: the tolerance of facets without a corner is infinite, or no number.
        assert!(!((area - expected).abs() > tolerance), "{area} {expected} {whole}");
    }
    for v in segments.iter().flat_map(|s| s.vertices()) {
        assert!(v.slave.iter().chain(&v.master).all(|x| (-1.0..=1.0).contains(x)), "{v:?}");
        assert!(v.gap.is_finite() && v.image.iter().all(|x| x.is_finite()), "{v:?}");
    }
});
