//! Segments of facet pairs against another way of clipping, degenerate pairs, coverage of surfaces, derivatives.

use std::f64::consts::PI;

use stoss_contact::{ContactSurface, FacetNodes};
use stoss_reference_cases::facets::{Quad, RandomQuad, SQUARE, common_area, flat, reversed};
use stoss_segmentation::{
    GapRange, LOCAL, MasterFacet, Segment, SlaveFrame, check_coverage, segment_facet, segment_pair,
};
use stoss_tensor::Vector3;

use super::check::{Bound, Check};
use super::report::Section;
use super::states::Random;
use super::{Bench, Findings, Suite};
use crate::gallery::{self, Interface};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Pairs, degenerate pairs, surfaces, derivatives.
pub struct Segmentation;

/// Relative error of an area.
const AREA: f64 = 1e-10;
/// Parametric area of a facet (of 4) that is lost or covered twice.
const COVERAGE: f64 = 1e-12;
/// Error of a derivative of differences of fourth order, over the third power of the largest derivative.
const DERIVATIVE: f64 = 1e-7;
/// Corners of facets with so large derivatives are at edges that are nearly parallel: differences say nothing there.
const PARALLEL: f64 = 30.0;

impl Suite for Segmentation {
    fn name(&self) -> &'static str {
        "segmentation"
    }

    fn about(&self) -> &'static str {
        "Common areas of facet pairs against clipping by slabs, degenerate pairs, coverage of random surfaces, derivatives of the segments."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        let full = if bench.quick { 1 } else { 100 };
        pairs(&mut findings, 10_000 * full)?;
        degenerate(&mut findings, 200 * full)?;
        coverage(&mut findings, 300 * full)?;
        derivatives(&mut findings, 300 * full.min(20))?;
        findings.sections.push(pictures()?);
        Ok(findings)
    }
}

fn vector(random: &mut Random, size: f64) -> Vector3 {
    Vector3::from_fn(|_, _| random.between(-size, size))
}

/// A random facet; with `lattice` half of them on a lattice.
fn quad(random: &mut Random, warp: f64, lattice: bool) -> Quad {
    let snap = lattice && random.between(0.0, 1.0) < 0.5;
    let facet = RandomQuad {
        moves: std::array::from_fn(|_| vector(random, warp)),
        tilt: vector(random, RandomQuad::TILT),
        shift: vector(random, RandomQuad::SHIFT),
        scale: random.between(RandomQuad::SCALE[0], RandomQuad::SCALE[1]),
        snap,
    };
    facet.place()
}

fn segments(frame: &SlaveFrame, master: &Quad) -> Outcome<Vec<Segment>> {
    let mut out = Vec::new();
    segment_pair(frame, 0, &(*master).into(), &mut out)?;
    Ok(out)
}

fn area(segments: &[Segment]) -> f64 {
    segments.iter().map(Segment::image_area).sum()
}

fn row(scene: &str, quantity: &str, measured: f64, bound: f64) -> Check {
    Check::new(scene, quantity, measured, Bound::AtMost(bound))
}

/// Largest error of the area relative to the slave's, number of pairs compared, and of those that overlap.
fn against_slabs(mut pair: impl FnMut() -> (Quad, Quad), count: u32) -> Outcome<(f64, u32, u32)> {
    let (mut worst, mut compared, mut overlapping) = (0.0_f64, 0, 0);
    for _ in 0..count {
        let (slave, master) = pair();
        let (Ok(frame), Some((expected, whole))) = (SlaveFrame::new(slave), common_area(&slave, &master)) else {
            continue;
        };
        let error = (area(&segments(&frame, &master)?) - expected).abs() / whole.max(expected);
        worst = if error.is_nan() { f64::NAN } else { worst.max(error) };
        compared += 1;
        overlapping += u32::from(expected > 0.0);
    }
    Ok((worst, compared, overlapping))
}

fn pairs(findings: &mut Findings, count: u32) -> Outcome<()> {
    let mut random = Random(11);
    let pair = || {
        let (slave, master) = (quad(&mut random, 0.8, true), quad(&mut random, 0.8, true));
        (slave, if random.between(0.0, 1.0) < 0.5 { master } else { reversed(master) })
    };
    let (worst, compared, overlapping) = against_slabs(pair, count)?;
    let note = format!("{compared} of {count} pairs have simple images, {overlapping} of them overlap");
    findings.checks.push(row("random pairs", "common area, relative error", worst, AREA).noted(note));
    Ok(())
}

fn degenerate(findings: &mut Findings, count: u32) -> Outcome<()> {
    let random = &mut Random(12);
    let mut identical = 0.0_f64;
    let mut shared = 0.0_f64;
    let mut behind = 0.0_f64;
    for _ in 0..count {
        let slave = quad(random, 0.3, false);
        let frame = SlaveFrame::new(slave)?;
        let whole = frame.image_area();
        identical = larger(identical, (area(&segments(&frame, &reversed(slave))?) / whole - 1.0).abs());
        behind = larger(behind, area(&segments(&frame, &slave)?) / whole);
        // The neighbours over an edge, in the plane of the facet, and over a corner: whatever they are, they have the edge or
        // the corner in common, exactly, and lie beyond.
        let flat_slave = slave.map(|x| x - frame.normal() * frame.normal().dot(&(x - slave[0])));
        let frame = SlaveFrame::new(flat_slave)?;
        for k in 0..4 {
            let [a, b, c] = [0, 1, 2].map(|i| flat_slave[(k + i) % 4]);
            let out = (b - a).cross(&frame.normal());
            let over_edge = [b, a, a + out, b + out];
            let past = (b - a) + (b - c);
            let over_corner = [b, b + (b - c), b + past, b + (b - a)];
            for master in [over_edge, over_corner].map(reversed) {
                if let Some((expected, _)) = common_area(&flat_slave, &master) {
                    let found = area(&segments(&frame, &master)?);
                    shared = larger(shared, (found - expected).abs() / whole);
                }
            }
        }
    }
    findings.checks.push(row("identical facets", "common area, relative error", identical, 1e-12));
    findings.checks.push(row("shared edges and corners", "error of the common area, by the slave's", shared, 1e-12));
    findings.checks.push(row("from behind", "common area, by the slave's", behind, 0.0));
    let frame = SlaveFrame::new(flat(SQUARE, 0.0))?;
    let mut sliver = 0.0_f64;
    for power in 1..=12 {
        let y = -1.0 + 10.0_f64.powi(-power);
        let master = reversed(flat([[-1.0, -1.0], [1.0, -1.0], [1.0, y], [-1.0, y]], 0.0));
        sliver = larger(sliver, (area(&segments(&frame, &master)?) - 2.0 * (y + 1.0)).abs());
    }
    let note = "widths 1e-1 to 1e-12 of a facet of side 2";
    findings.checks.push(row("slivers", "error of the common area", sliver, 1e-14).noted(note));
    // Corners moved over the diagonals: reflex images, split into triangles.
    let warped = || (quad(random, 1.5, false), reversed(quad(random, 1.5, false)));
    let (worst, compared, overlapping) = against_slabs(warped, 10 * count)?;
    let note = format!("{compared} pairs, {overlapping} of them overlap");
    findings.checks.push(row("warped and reflex facets", "common area, relative error", worst, AREA).noted(note));
    // Seen edge on, down to a hundred millionth of a right angle.
    let steep = || {
        let angle = 0.5 * PI * (1.0 - random.power_of_ten(-8.0, -1.0));
        let turn = |x: Vector3| {
            Vector3::new(x.x, x.y * angle.cos() - x.z * angle.sin(), x.y * angle.sin() + x.z * angle.cos())
        };
        let shift = vector(random, 0.5);
        (flat(SQUARE, 0.0), reversed(flat(SQUARE, 0.0)).map(|x| turn(x) + shift))
    };
    let (worst, compared, overlapping) = against_slabs(steep, 10 * count)?;
    let note = format!("{compared} pairs, {overlapping} of them overlap");
    findings.checks.push(row("steep facets", "error of the common area, by the slave's", worst, AREA).noted(note));
    Ok(())
}

/// Facets of `n x n` over the square of half side `r`; looking down unless `up`.
fn surface(n: u32, r: f64, up: bool, mut place: impl FnMut(f64, f64) -> Vector3) -> Vec<MasterFacet> {
    let h = 2.0 * r / f64::from(n);
    let mut nodes = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            nodes.push(place(f64::from(i) * h - r, f64::from(j) * h - r));
        }
    }
    let facets = (0..n * n).map(|id| {
        let k = id / n * (n + 1) + id % n;
        let ids = if up { [k, k + 1, k + n + 2, k + n + 1] } else { [k, k + n + 1, k + n + 2, k + 1] };
        MasterFacet { id, nodes: ids.into(), corners: ids.map(|k| nodes[k as usize]).into() }
    });
    facets.collect()
}

fn coverage(findings: &mut Findings, count: u32) -> Outcome<()> {
    let random = &mut Random(13);
    let (mut uncovered, mut double, mut open, mut kept) = (0.0_f64, 0.0_f64, 0, 0);
    for k in 0..count {
        let slave: Quad = std::array::from_fn(|k| Vector3::new(SQUARE[k][0], SQUARE[k][1], 0.0) + vector(random, 0.4));
        let n = 1 + k % 12;
        let h = 6.0 / f64::from(n);
        let facets = surface(n, 3.0, false, |x, y| {
            // Nodes move by less than half a facet, so that the surface does not fold; its rim stays.
            let d = vector(random, 0.25 * h);
            let inside = if x.abs().max(y.abs()) > 2.99 { 0.0 } else { 1.0 };
            Vector3::new(x + inside * d.x, y + inside * d.y, 0.2 + 0.4 * d.z)
        });
        let found = segment_facet(slave, &facets, GapRange::ALL)?;
        let normal = found.frame.normal();
        // Only surfaces that the slave sees nowhere from behind, and whose rim it does not see.
        let seen = |f: &MasterFacet| {
            let c = f.corners;
            (0..4).all(|k| (c[(k + 1) % 4] - c[k]).cross(&(c[(k + 3) % 4] - c[k])).dot(&normal) < 0.0)
        };
        let rim = facets.iter().flat_map(|f| f.corners).filter(|x| x.x.abs().max(x.y.abs()) > 2.99);
        let reach = rim.map(|x| found.frame.image(&x)).map(|p| p[0].hypot(p[1])).fold(f64::INFINITY, f64::min);
        if !facets.iter().all(seen) || reach < 2.1 {
            continue;
        }
        let report = check_coverage(&found, &facets, GapRange::ALL)?;
        uncovered = larger(uncovered, larger(report.uncovered.abs(), report.uncovered_opposite()));
        double = larger(double, report.double);
        open += report.open_edges.len();
        kept += 1;
    }
    let scene = "facet before a random surface";
    let note = format!("{kept} surfaces of 1 to 144 facets; the slave facet has the area 4");
    findings.checks.push(row(scene, "area not covered", uncovered, COVERAGE).noted(note));
    findings.checks.push(row(scene, "area covered twice", double, COVERAGE));
    findings.checks.push(row(scene, "edges between segments that do not fit", open as f64, 0.0));
    findings.checks.push(Check::new(scene, "surfaces", f64::from(kept), Bound::AtLeast(f64::from(count) / 4.0)));
    Ok(())
}

fn derivatives(findings: &mut Findings, count: u32) -> Outcome<()> {
    let random = &mut Random(14);
    let (mut worst, mut compared) = (0.0_f64, 0);
    for _ in 0..count {
        let (slave, master) = (quad(random, 0.25, false), reversed(quad(random, 0.25, false)));
        let (error, number) = derivative_error(&slave, &master)?;
        worst = larger(worst, error);
        compared += number;
    }
    let note = format!("{compared} derivatives; over the third power of the vertex's largest");
    let name = "coordinates of vertices by nodes";
    findings.checks.push(row(name, "error against differences of fourth order", worst, DERIVATIVE).noted(note));
    findings.checks.push(Check::new(name, "derivatives", compared as f64, Bound::AtLeast(100.0 * f64::from(count))));
    Ok(())
}

fn derivative_error(slave: &Quad, master: &Quad) -> Outcome<(f64, usize)> {
    const H: f64 = 1e-4;
    let frame = SlaveFrame::new(*slave)?;
    let (mut worst, mut compared) = (0.0_f64, 0);
    for segment in &segments(&frame, master)? {
        let exact = segment.vertex_derivatives(&frame, &(*master).into());
        for k in 0..LOCAL {
            let moved = |d: f64| -> Outcome<Option<Vec<[f64; 4]>>> {
                let (mut s, mut m) = (*slave, *master);
                if k < 12 {
                    s[k / 3][k % 3] += d
                } else {
                    m[k / 3 - 4][k % 3] += d
                }
                let found = segments(&SlaveFrame::new(s)?, &m)?;
                // Another polygon has other vertices, and there is no derivative.
                let same = found.into_iter().find(|a| {
                    let mut pairs = a.vertices().iter().zip(segment.vertices());
                    (a.slave_map, a.master_map, a.vertices().len())
                        == (segment.slave_map, segment.master_map, segment.vertices().len())
                        && pairs.all(|(x, y)| x.provenance == y.provenance)
                });
                Ok(same
                    .map(|a| a.vertices().iter().map(|v| [v.slave[0], v.slave[1], v.master[0], v.master[1]]).collect()))
            };
            let [Some(a), Some(b), Some(c), Some(d)] = [moved(-2.0 * H)?, moved(-H)?, moved(H)?, moved(2.0 * H)?]
            else {
                continue;
            };
            for v in 0..a.len() {
                let rows = || exact[v].slave.iter().chain(&exact[v].master);
                let size = rows().flatten().fold(1.0_f64, |m, x| m.max(x.abs()));
                if size > PARALLEL {
                    continue;
                }
                for (i, exact) in rows().enumerate() {
                    let slope = (8.0 * (c[v][i] - b[v][i]) - (d[v][i] - a[v][i])) / (12.0 * H);
                    worst = larger(worst, (exact[k] - slope).abs() / size.powi(3));
                    compared += 1;
                }
            }
        }
    }
    Ok((worst, compared))
}

/// Two surfaces from above and the segments between them.
fn picture(title: &str, slave: &[MasterFacet], master: &[MasterFacet]) -> Outcome<String> {
    let count = |f: &[MasterFacet]| f.iter().flat_map(|f| f.nodes).max().map_or(0, |n| n + 1);
    let first = count(slave);
    let mut q = vec![0.0; 3 * (first + count(master)) as usize];
    let mut place = |list: &[MasterFacet], first: u32| -> Vec<FacetNodes> {
        for (node, x) in list.iter().flat_map(|f| f.nodes.into_iter().zip(f.corners)) {
            let k = 3 * (first + node) as usize;
            q[k..k + 3].copy_from_slice(&[x.x, x.y, x.z]);
        }
        list.iter().map(|f| f.nodes.map(|n| n + first)).collect()
    };
    let facets = [place(slave, 0), place(master, first)];
    let [slave, master] =
        [ContactSurface::new("slave", &facets[0], &q)?, ContactSurface::new("master", &facets[1], &q)?];
    let interface = Interface { slave, master, q, range: GapRange::ALL };
    let faults = interface.coverage()?.faults.len();
    if faults > 0 {
        return Err(format!("{faults} facets of the picture are not covered").into());
    }
    Ok(gallery::segments(title, &interface)?.ok_or("no facet of the picture faces another")?)
}

fn pictures() -> Outcome<Section> {
    let turned = |x: f64, y: f64, z: f64| {
        let (s, c) = 0.35_f64.sin_cos();
        Vector3::new(c * x - s * y, s * x + c * y, z)
    };
    let slave = surface(3, 1.0, true, |x, y| Vector3::new(x, y, 0.0));
    let master = surface(5, 1.6, false, |x, y| turned(x, y, 0.05));
    let plane = picture("Plane surfaces, turned against each other", &slave, &master)?;
    // A cap in a bowl, with uneven facets.
    let slave = surface(3, 1.0, true, |x, y| Vector3::new(x + 0.15 * y, y - 0.1 * x * x, 0.25 * (x * x + y * y)));
    let master = surface(4, 1.9, false, |x, y| {
        let (x, y) = (x + 0.12 * (3.0 * y).sin(), y + 0.1 * (2.0 * x).cos());
        turned(x, y, 0.25 * (x * x + y * y) + 0.1)
    });
    let curved = picture("Curved surfaces with uneven facets, from above", &slave, &master)?;
    Ok(Section { title: "Segmentation".into(), reading: "The facets of the slave (theory/segmentation), cut by those of the master that they face, and the triangles over which the mortar integrals are taken. Right if the triangles cover each facet once, without gap or overlap.".into(), figures: vec![plane, curved], tables: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_have_their_area_and_their_side() {
        for (up, sign) in [(true, 1.0), (false, -1.0)] {
            let facets = surface(3, 1.5, up, |x, y| Vector3::new(x, y, 0.0));
            let area: f64 = facets.iter().map(|f| SlaveFrame::new(f.corners).unwrap().image_area()).sum();
            assert!((area - 9.0).abs() < 1e-13);
            assert_eq!(SlaveFrame::new(facets[4].corners).unwrap().normal().z, sign);
        }
    }

    #[test]
    fn the_derivative_of_a_shifted_square_is_found() {
        let slave = flat(SQUARE, 0.0);
        let master = reversed(flat(SQUARE.map(|p| [p[0] + 0.5, p[1] + 0.25]), 0.1));
        let (error, compared) = derivative_error(&slave, &master).unwrap();
        assert!(error < 1e-9 && compared > 100, "{error:e} {compared}");
    }
}
