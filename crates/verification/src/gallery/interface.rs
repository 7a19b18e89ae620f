//! Two surfaces that face each other, and the segments between them seen from above.

use std::collections::BTreeSet;

use stoss_contact::ContactSurface;
use stoss_contact_mortar::segmentation::{FacetSegmentation, GapRange};
use stoss_contact_mortar::{CheckExtent, SurfaceCoverage, segment_surfaces};
use stoss_mesh::Elements;
use stoss_reference_element::CellKind;
use stoss_tensor::Vector3;

use crate::hexahedra;
use crate::plot::{self, Drawn, Labels, Series};
use crate::vtu::Grid;
use crate::workspace::Outcome;
use stoss_report::paint::boundary;

/// Master facets farther from the slave's box than this part of its size are not drawn.
const SURROUNDINGS: f64 = 0.35;

/// Where the two surfaces of an interface are in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sides {
    /// The bottom of the upper body, the slave, and the top of the lower one.
    Stacked,
    /// The part above of two bodies that meet on a sphere of this radius about the origin, the second body around the first one.
    Sphere(f64),
    /// The whole surfaces of both bodies, the first one the slave, as far as they are nearer than this.
    Hulls(f64),
}

/// A slave and a master surface with their nodes' positions.
pub struct Interface {
    /// The slave surface.
    pub slave: ContactSurface,
    /// The master surface.
    pub master: ContactSurface,
    /// Three numbers a node.
    pub q: Vec<f64>,
    /// Gaps at which facets are opposite each other.
    pub range: GapRange,
}

impl Interface {
    /// The interface of a frame with the sides in their places.
    pub fn new(frame: &Grid, sides: Sides) -> Outcome<Self> {
        match sides {
            Sides::Stacked => Self::stacked(frame),
            Sides::Sphere(radius) => Self::on_sphere(frame, radius),
            Sides::Hulls(gap) => {
                let range = GapRange { min: -gap, max: gap };
                let interface = Self::between(frame, &hull(frame, 0.0)?, &hull(frame, 1.0)?)?;
                Ok(Self { range, ..interface })
            }
        }
    }

    /// The interface of a frame with two blocks one above the other: the bottom of the upper one is the slave, the top of the lower one the master.
    fn stacked(frame: &Grid) -> Outcome<Self> {
        let bodies = bodies(frame)?;
        let bounds = |body: f64| {
            let cells = hexahedra(frame).into_iter().zip(bodies).filter(move |(_, b)| **b == body);
            let heights = cells.flat_map(|(cell, _)| cell.map(|node| frame.points[node][2]));
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)))
        };
        let (first, second) = (bounds(0.0), bounds(1.0));
        let upper = if first.1 > second.1 { 0.0 } else { 1.0 };
        // A facet of the bottom is on no top of another element, even if the bottom is curved.
        let layer = |body: f64, corners: [usize; 4]| -> Vec<[usize; 4]> {
            let cells = hexahedra(frame).into_iter().zip(bodies).filter(|(_, b)| **b == body);
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

    /// The interface of a frame with a ball in a shell: the upper part of the second body's facets near the sphere about the origin is the slave, all of the
    /// first body's the master.
    fn on_sphere(frame: &Grid, radius: f64) -> Outcome<Self> {
        /// Part of the radius that nodes may be off the sphere; part of it above which the slave's facets are.
        const NEAR: f64 = 0.08;
        const ABOVE: f64 = 0.35;
        let height = |node: usize| frame.points[node][2];
        let on = |facet: &[usize; 4]| {
            let distance = |node: usize| frame.points[node].iter().map(|x| x * x).sum::<f64>().sqrt() - radius;
            facet.iter().all(|&node| distance(node).abs() < NEAR * radius)
        };
        let [mut master, mut slave] = [hull(frame, 0.0)?, hull(frame, 1.0)?];
        master.retain(on);
        slave.retain(|facet| on(facet) && facet.iter().all(|&node| height(node) > ABOVE * radius));
        Self::between(frame, &slave, &master)
    }

    /// The interface between these facets, in the frame's positions.
    fn between(frame: &Grid, slave: &[[usize; 4]], master: &[[usize; 4]]) -> Outcome<Self> {
        let displacement = frame.point_data.get("displacement").ok_or("no displacement in the frame")?;
        let reference: Vec<f64> = frame.points.iter().flatten().copied().collect();
        let q = reference.iter().zip(&displacement.values).map(|(x, u)| x + u).collect();
        let numbers = |facets: &[[usize; 4]]| facets.iter().map(|f| f.map(|node| node as u32)).collect::<Vec<_>>();
        let slave = ContactSurface::new("slave", &numbers(slave), &reference)?;
        let master = ContactSurface::new("master", &numbers(master), &reference)?;
        Ok(Self { slave, master, q, range: GapRange::ALL })
    }

    /// Whether all facets are shown, from above; of whole surfaces only those that are opposite each other can be told apart.
    pub fn is_seen_from_above(&self) -> bool {
        self.range == GapRange::ALL
    }

    /// Whether the segments of every slave facet tile its overlap with the whole master.
    pub fn coverage(&self) -> Outcome<SurfaceCoverage> {
        let Self { slave, master, q, range } = self;
        Ok(segment_surfaces(slave, master, q, *range)?.check(master, q, CheckExtent::Everything)?)
    }
}

/// Number of the body of every element.
fn bodies(frame: &Grid) -> Outcome<&[f64]> {
    Ok(&frame.cell_data.get("body").ok_or("no numbers of bodies in the frame")?.values)
}

/// All facets of a body's surface.
fn hull(frame: &Grid, body: f64) -> Outcome<Vec<[usize; 4]>> {
    let cells = frame.elements.iter().zip(bodies(frame)?).filter(|(_, b)| **b == body);
    let mut elements = Elements::new();
    cells.for_each(|(cell, _)| elements.push(CellKind::Hex8, cell));
    Ok(boundary(&elements).iter().map(|piece| piece.points).collect())
}

/// A picture of both surfaces from the side of the slave and the triangles of the segments between them, on the slave: from above, or, of whole surfaces, along
/// the mean normal of the slave facets that are opposite the master, and of both only such facets. Nothing if no facet is.
pub fn segments(title: &str, interface: &Interface) -> Outcome<Option<String>> {
    let Interface { slave, master, q, range } = interface;
    let found = segment_surfaces(slave, master, q, *range)?.facets;
    let opposite: Vec<&FacetSegmentation> = found.iter().filter(|facet| !facet.segments.is_empty()).collect();
    if opposite.is_empty() {
        return Ok(None);
    }
    let from_above = interface.is_seen_from_above();
    let eye =
        if from_above { Vector3::z() } else { -opposite.iter().map(|facet| facet.frame.normal()).sum::<Vector3>() };
    let right = Vector3::y().cross(&eye).try_normalize(0.0).unwrap_or_else(Vector3::x);
    let up = eye.cross(&right).try_normalize(0.0).unwrap_or_else(Vector3::y);
    let project = |x: Vector3| [right.dot(&x), up.dot(&x)];
    let mut triangles: Vec<Vec<[f64; 2]>> = Vec::new();
    for facet in &opposite {
        for segment in &facet.segments {
            let place = |v: usize| {
                let weights = segment.slave_map.weights(segment.vertices()[v].slave);
                project(facet.frame.corners().iter().zip(weights).map(|(x, w)| x * w).sum())
            };
            triangles.extend(segment.triangles().map(|triangle| triangle.iter().map(|&v| place(v)).collect()));
        }
    }
    let outline = |x: &[Vector3]| x.iter().map(|x| project(*x)).collect::<Vec<_>>();
    let drawn = found.iter().filter(|facet| from_above || !facet.segments.is_empty());
    let slaves: Vec<_> = drawn.map(|facet| outline(facet.frame.corners())).collect();
    let opposed: BTreeSet<u32> = opposite.iter().flat_map(|facet| &facet.segments).map(|s| s.master_facet).collect();
    let seen = (0..master.facets().len() as u32).filter(|f| from_above || opposed.contains(f));
    let masters = near(seen.map(|f| outline(&master.patch(f, q).corners)).collect(), &slaves);
    let series = [
        outlines(&format!("{} triangles", triangles.len()), &triangles),
        outlines("master facets", &masters),
        outlines("slave facets", &slaves),
    ];
    let labels = if from_above { Labels { title, x: "x", y: "y" } } else { Labels { title, x: "across", y: "up" } };
    Ok(Some(plot::trajectory(labels, &series, Drawn::Lines)))
}

/// Smallest and largest coordinates.
fn bounds<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> [[f64; 2]; 2] {
    points.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
    })
}

/// The polygons that lie in the surroundings of `centre` in part.
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
    use crate::vtu::Array;

    /// The eight corners of a unit cube in VTK's order.
    const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];

    fn grid(points: &[[f64; 3]], hexahedra: &[[usize; 8]]) -> Grid {
        let elements = hexahedra.iter().map(|nodes| nodes.map(|node| node as u32)).collect();
        Grid { points: points.to_vec(), elements, ..Grid::default() }
    }

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
            let mut frame = grid(&points, &cells);
            frame.cell_data.insert("body".into(), Array { components: 1, values: vec![0.0, 1.0] });
            let shift = |p: &[f64; 3]| [if p[2] > 1.1 { 0.5 } else { 0.0 }, 0.0, 0.0];
            let moved = points.iter().flat_map(shift).collect();
            frame.point_data.insert("displacement".into(), Array { components: 3, values: moved });
            let interface = Interface::new(&frame, Sides::Stacked).unwrap();
            let coverage = interface.coverage().unwrap();
            assert!(coverage.faults.is_empty());
            assert!((coverage.area - 1.0).abs() < 1e-14 && (coverage.covered - 0.5).abs() < 1e-14);
            let drawn = segments("t", &interface).unwrap().unwrap();
            assert!(drawn.contains("master facets") && !drawn.contains("NaN"));
        }
    }

    /// Two unit cubes, side by side with a gap of a tenth and shifted by half an edge: of their whole surfaces the two sides between them are left.
    #[test]
    fn hulls_are_drawn_where_they_are_near() {
        let other = CUBE.map(|[x, y, z]| [x + 1.1, y, z + 0.5]);
        let points: Vec<[f64; 3]> = [CUBE, other].into_iter().flatten().collect();
        let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [8, 9, 10, 11, 12, 13, 14, 15]];
        let mut frame = grid(&points, &cells);
        frame.cell_data.insert("body".into(), Array { components: 1, values: vec![0.0, 1.0] });
        frame.point_data.insert("displacement".into(), Array { components: 3, values: vec![0.0; 48] });
        let near = Interface::new(&frame, Sides::Hulls(0.2)).unwrap();
        assert_eq!((near.slave.facets().len(), near.master.facets().len()), (6, 6));
        let coverage = near.coverage().unwrap();
        assert!(coverage.faults.is_empty() && (coverage.covered - 0.5).abs() < 1e-14, "{coverage:?}");
        assert!(segments("t", &near).unwrap().unwrap().contains("2 triangles"));
        let apart = Interface::new(&frame, Sides::Hulls(0.05)).unwrap();
        assert!(segments("t", &apart).unwrap().is_none());
    }

    /// A cube with its corners on the sphere, and a block on its top.
    #[test]
    fn the_interface_on_a_sphere_is_the_part_above() {
        let inner = CUBE.map(|x| x.map(|x| 2.0 * x - 1.0));
        let outer = CUBE.map(|[x, y, z]| [2.0 * x - 1.0, 2.0 * y - 1.0, 1.0 + z]);
        let points: Vec<[f64; 3]> = [inner, outer].into_iter().flatten().collect();
        let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [8, 9, 10, 11, 12, 13, 14, 15]];
        let mut frame = grid(&points, &cells);
        frame.cell_data.insert("body".into(), Array { components: 1, values: vec![0.0, 1.0] });
        frame.point_data.insert("displacement".into(), Array { components: 3, values: vec![0.0; 48] });
        let interface = Interface::new(&frame, Sides::Sphere(3.0_f64.sqrt())).unwrap();
        assert_eq!((interface.slave.facets().len(), interface.master.facets().len()), (1, 6));
        let coverage = interface.coverage().unwrap();
        assert!(coverage.faults.is_empty() && (coverage.covered - 4.0).abs() < 1e-14, "{coverage:?}");
    }
}
