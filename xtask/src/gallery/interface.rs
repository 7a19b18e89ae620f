//! Two surfaces that face each other, and the segments between them seen from above.

use std::collections::BTreeSet;

use stoss_contact::ContactSurface;
use stoss_contact_mortar::segmentation::GapRange;
use stoss_contact_mortar::{CheckExtent, SurfaceCoverage, segment_surfaces};
use stoss_tensor::Vector3;

use super::surface::boundary;
use crate::plot::{self, Drawn, Labels, Series};
use crate::vtu::Grid;
use crate::workspace::Outcome;

/// Master facets farther from the slave's box than this part of its size are not drawn.
const SURROUNDINGS: f64 = 0.35;

/// A slave and a master surface with their nodes' positions.
pub struct Interface {
    pub slave: ContactSurface,
    pub master: ContactSurface,
    /// Three numbers a node.
    pub q: Vec<f64>,
}

impl Interface {
    /// Of a frame with two blocks one above the other: the bottom of the upper one is the slave, the top of the lower one the master.
    pub fn new(frame: &Grid) -> Outcome<Self> {
        let bodies = frame.cell_data.get("body").ok_or("no numbers of bodies in the frame")?;
        let bounds = |body: f64| {
            let cells = frame.hexahedra.iter().zip(&bodies.values).filter(move |(_, b)| **b == body);
            let heights = cells.flat_map(|(cell, _)| cell.iter().map(|&node| frame.points[node][2]));
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)))
        };
        let (first, second) = (bounds(0.0), bounds(1.0));
        let upper = if first.1 > second.1 { 0.0 } else { 1.0 };
        // A facet of the bottom is on no top of another element, even if the bottom is curved.
        let layer = |body: f64, corners: [usize; 4]| -> Vec<[usize; 4]> {
            let cells = frame.hexahedra.iter().zip(&bodies.values).filter(|(_, b)| **b == body);
            cells.map(|(cell, _)| corners.map(|k| cell[k])).collect()
        };
        let sorted = |mut facet: [usize; 4]| {
            facet.sort_unstable();
            facet
        };
        let free = |body: f64, corners: [usize; 4], opposite: [usize; 4]| -> Vec<[usize; 4]> {
            let inside: BTreeSet<[usize; 4]> = layer(body, opposite).into_iter().map(sorted).collect();
            layer(body, corners).into_iter().filter(|facet| !inside.contains(&sorted(*facet))).collect()
        };
        const BOTTOM: [usize; 4] = [0, 3, 2, 1];
        const TOP: [usize; 4] = [4, 5, 6, 7];
        Self::between(frame, &free(upper, BOTTOM, TOP), &free(1.0 - upper, TOP, BOTTOM))
    }

    /// Of a frame with a ball in a shell: the upper part of the second body's facets near the sphere about the origin is the slave, all of the first
    /// body's the master.
    pub fn on_sphere(frame: &Grid, radius: f64) -> Outcome<Self> {
        /// Part of the radius that nodes may be off the sphere; part of it above which the slave's facets are.
        const NEAR: f64 = 0.08;
        const ABOVE: f64 = 0.35;
        let bodies = frame.cell_data.get("body").ok_or("no numbers of bodies in the frame")?;
        let height = |node: usize| frame.points[node][2];
        let on = |facet: &[usize; 4]| {
            let distance = |node: usize| frame.points[node].iter().map(|x| x * x).sum::<f64>().sqrt() - radius;
            facet.iter().all(|&node| distance(node).abs() < NEAR * radius)
        };
        let of = |body: f64| -> Vec<[usize; 4]> {
            let cells = frame.hexahedra.iter().zip(&bodies.values).filter(|(_, b)| **b == body);
            let cells: Vec<[usize; 8]> = cells.map(|(cell, _)| *cell).collect();
            boundary(&cells).into_iter().filter(on).collect()
        };
        let mut slave = of(1.0);
        slave.retain(|facet| facet.iter().all(|&node| height(node) > ABOVE * radius));
        Self::between(frame, &slave, &of(0.0))
    }

    /// In the frame's positions.
    fn between(frame: &Grid, slave: &[[usize; 4]], master: &[[usize; 4]]) -> Outcome<Self> {
        let displacement = frame.point_data.get("displacement").ok_or("no displacement in the frame")?;
        let reference: Vec<f64> = frame.points.iter().flatten().copied().collect();
        let q = reference.iter().zip(&displacement.values).map(|(x, u)| x + u).collect();
        let numbers = |facets: &[[usize; 4]]| facets.iter().map(|f| f.map(|node| node as u32)).collect::<Vec<_>>();
        let slave = ContactSurface::new("slave", &numbers(slave), &reference)?;
        Ok(Self { slave, master: ContactSurface::new("master", &numbers(master), &reference)?, q })
    }

    /// Whether the segments of every slave facet tile its overlap with the whole master.
    pub fn coverage(&self) -> Outcome<SurfaceCoverage> {
        let Self { slave, master, q } = self;
        Ok(segment_surfaces(slave, master, q, GapRange::ALL)?.check(master, q, CheckExtent::Everything)?)
    }
}

/// Both surfaces from above and the triangles of the segments between them, on the slave.
pub fn segments(title: &str, interface: &Interface) -> Outcome<String> {
    let Interface { slave, master, q } = interface;
    let corners = |s: &ContactSurface| -> Vec<Vec<[f64; 2]>> {
        let facets = 0..s.facets().len() as u32;
        facets.map(|f| s.patch(f, q).corners.iter().map(|x| [x.x, x.y]).collect()).collect()
    };
    let mut triangles: Vec<Vec<[f64; 2]>> = Vec::new();
    for facet in &segment_surfaces(slave, master, q, GapRange::ALL)?.facets {
        for segment in &facet.segments {
            let place = |v: usize| {
                let weights = segment.slave_map.weights(segment.vertices()[v].slave);
                let x = facet.frame.corners().iter().zip(weights).map(|(x, w)| x * w).sum::<Vector3>();
                [x.x, x.y]
            };
            triangles.extend(segment.triangles().map(|triangle| triangle.iter().map(|&v| place(v)).collect()));
        }
    }
    let slaves = corners(slave);
    let masters = near(corners(master), &slaves);
    let series = [
        outlines(&format!("{} triangles", triangles.len()), &triangles),
        outlines("master facets", &masters),
        outlines("slave facets", &slaves),
    ];
    Ok(plot::trajectory(Labels { title, x: "x", y: "y" }, &series, Drawn::Lines))
}

/// Smallest and largest coordinates.
fn bounds<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> [[f64; 2]; 2] {
    points.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
    })
}

/// Those that lie in the surroundings of `centre` in part.
fn near(polygons: Vec<Vec<[f64; 2]>>, centre: &[Vec<[f64; 2]>]) -> Vec<Vec<[f64; 2]>> {
    let [low, high] = bounds(centre.iter().flatten());
    let meets = |polygon: &Vec<[f64; 2]>| {
        let [from, to] = bounds(polygon.iter());
        (0..2).all(|i| {
            let margin = SURROUNDINGS * (high[i] - low[i]);
            from[i] <= high[i] + margin && to[i] >= low[i] - margin
        })
    };
    polygons.into_iter().filter(meets).collect()
}

/// Closed lines, one after another with gaps, as one series.
fn outlines(name: &str, polygons: &[Vec<[f64; 2]>]) -> Series {
    let mut points = Vec::new();
    for polygon in polygons {
        points.extend(polygon.iter().chain(polygon.first()).map(|p| (p[0], p[1])));
        points.push((f64::NAN, f64::NAN));
    }
    Series { name: name.to_owned(), points }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vtu::{self, Array, tests::CUBE};

    #[test]
    fn outlines_are_closed_and_apart() {
        let series = outlines("a", &[vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]);
        assert_eq!((series.points[0], series.points[3], series.points.len()), ((0.0, 0.0), (0.0, 0.0), 5));
        assert!(series.points[4].0.is_nan());
    }

    #[test]
    fn distant_polygons_are_left_out() {
        let square = |x: f64| vec![[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]];
        let left = near(vec![square(-2.0), square(-1.2), square(0.5), square(1.3), square(1.4)], &[square(0.0)]);
        assert_eq!(left, [square(-1.2), square(0.5), square(1.3)]);
    }

    /// A unit cube on another one whose top it meets shifted by half an edge: half of the facet is covered.
    #[test]
    fn the_interface_is_between_the_upper_and_the_lower_body() {
        let lower = CUBE;
        let upper = CUBE.map(|[x, y, z]| [x, y, z + 1.25]);
        for order in [[lower, upper], [upper, lower]] {
            let points: Vec<[f64; 3]> = order.into_iter().flatten().collect();
            let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [8, 9, 10, 11, 12, 13, 14, 15]];
            let mut frame = vtu::parse(&vtu::tests::write(&points, &cells, &[0.0; 16], true)).unwrap();
            frame.cell_data.insert("body".into(), Array { components: 1, values: vec![0.0, 1.0] });
            let shift = |p: &[f64; 3]| [if p[2] > 1.1 { 0.5 } else { 0.0 }, 0.0, 0.0];
            let moved = points.iter().flat_map(shift).collect();
            frame.point_data.insert("displacement".into(), Array { components: 3, values: moved });
            let interface = Interface::new(&frame).unwrap();
            let coverage = interface.coverage().unwrap();
            assert!(coverage.faults.is_empty());
            assert!((coverage.area - 1.0).abs() < 1e-14 && (coverage.covered - 0.5).abs() < 1e-14);
            let drawn = segments("t", &interface).unwrap();
            assert!(drawn.contains("master facets") && !drawn.contains("NaN"));
        }
    }

    /// A cube with its corners on the sphere, and a block on its top.
    #[test]
    fn the_interface_on_a_sphere_is_the_part_above() {
        let inner = CUBE.map(|x| x.map(|x| 2.0 * x - 1.0));
        let outer = CUBE.map(|[x, y, z]| [2.0 * x - 1.0, 2.0 * y - 1.0, 1.0 + z]);
        let points: Vec<[f64; 3]> = [inner, outer].into_iter().flatten().collect();
        let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [8, 9, 10, 11, 12, 13, 14, 15]];
        let mut frame = vtu::parse(&vtu::tests::write(&points, &cells, &[0.0; 16], true)).unwrap();
        frame.cell_data.insert("body".into(), Array { components: 1, values: vec![0.0, 1.0] });
        frame.point_data.insert("displacement".into(), Array { components: 3, values: vec![0.0; 48] });
        let interface = Interface::on_sphere(&frame, 3.0_f64.sqrt()).unwrap();
        assert_eq!((interface.slave.facets().len(), interface.master.facets().len()), (1, 6));
        let coverage = interface.coverage().unwrap();
        assert!(coverage.faults.is_empty() && (coverage.covered - 4.0).abs() < 1e-14, "{coverage:?}");
    }
}
