//! Sections as slices: one layer of elements of a plate or of a body of revolution, with planes of symmetry on both sides.

use crate::error::parameter;
use crate::mesh::BOUNDARY;
use crate::{Facet, Mesh, MeshError};
use std::collections::BTreeMap;

/// Nodes on the side of a slice at negative z.
pub const LOW: &str = "section-low";
/// Nodes in the middle of a slice of quadratic elements.
pub const MIDDLE: &str = "section-middle";
/// Nodes on the side at positive z.
pub const HIGH: &str = "section-high";
/// Nodes on the axis of a sector.
pub const AXIS: &str = "section-axis";

/// Distance from the axis at which nodes on the axis of a sector are put, in parts of the smallest radius of other nodes of their elements, which so keep all of their corners.
const CORE: f64 = 1.0 / 32.0;
/// Radius up to which a node is on the axis, in parts of the largest one.
const ON_AXIS: f64 = 1e-9;

/// What a layer becomes a slice of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slice {
    /// A plate of this thickness (length).
    Plate(f64),
    /// A sector of this angle (radians, below pi) of a body of revolution about y, with x as radius in its middle: nodes lie at `(x, y, +-x tan(angle/2))`.
    Sector(f64),
}

impl Slice {
    /// Extent across the section: of a plate its thickness, of a sector `2 tan(angle/2)`, its width over the radius x. Forces and the like over it are those of a unit of thickness,
    /// or of a radian: `int f x dx dy` of whatever does not change around.
    pub fn extent(self) -> f64 {
        match self {
            Self::Plate(thickness) => thickness,
            Self::Sector(angle) => 2.0 * (0.5 * angle).tan(),
        }
    }
}

impl Mesh {
    /// Whether the mesh is a layer from z = -1 to z = 1, with nodes on its sides and in the middle alone.
    pub fn is_layer(&self) -> bool {
        let all = |at: &[f64]| self.nodes.iter().all(|x| at.contains(&x[2]));
        !self.nodes.is_empty() && all(&[-1.0, 0.0, 1.0]) && !all(&[0.0, 1.0]) && !all(&[-1.0, 0.0])
    }

    /// The slice of a layer from z = -1 to z = 1, with the node sets [`LOW`], [`MIDDLE`], [`HIGH`], [`AXIS`], as far as there are such nodes. The set of the boundary is that of the section.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] of a sector with nodes at negative radii; [`MeshError::InvertedElement`], [`MeshError::NonFiniteNode`] of a bad layer.
    pub fn slice(mut self, slice: Slice) -> Result<Mesh, MeshError> {
        // Middles of edges may be off by round-off.
        self.nodes.iter_mut().for_each(|x| x[2] = x[2].round());
        let z = |n: u32| self.nodes[n as usize][2];
        let is_side =
            |facet: &Facet| z(facet.nodes[0]) != 0.0 && facet.nodes.iter().all(|&n| z(n) == z(facet.nodes[0]));
        let outside: Vec<_> = self.boundary_facets().into_iter().filter(|facet| !is_side(facet)).collect();
        let largest = self.nodes.iter().fold(0.0_f64, |largest, x| largest.max(x[0]));
        let cores = self.cores(ON_AXIS * largest);
        let mut sets: [(&str, Vec<u32>); 4] = [LOW, MIDDLE, HIGH, AXIS].map(|name| (name, Vec::new()));
        for (n, x) in self.nodes.iter_mut().enumerate() {
            sets[(x[2] + 1.0) as usize].1.push(n as u32);
            match slice {
                Slice::Plate(thickness) => x[2] *= 0.5 * thickness,
                Slice::Sector(_) if x[0] < -ON_AXIS * largest => {
                    return Err(parameter("x", x[0], "must not be negative: it is the radius, and y is the axis"));
                }
                Slice::Sector(_) => {
                    if let Some(core) = cores.get(&(n as u32)) {
                        sets[3].1.push(n as u32);
                        x[0] = *core;
                    }
                    x[2] *= 0.5 * slice.extent() * x[0];
                }
            }
        }
        self.facet_sets.insert(BOUNDARY.to_owned(), outside);
        for (name, nodes) in sets.into_iter().filter(|(_, nodes)| !nodes.is_empty()) {
            self.node_sets.insert(name.to_owned(), nodes);
        }
        self.check_geometry()?;
        Ok(self)
    }

    /// Nodes with radii up to this one, and the radii that they get.
    fn cores(&self, on_axis: f64) -> BTreeMap<u32, f64> {
        let radius = |n: u32| self.nodes[n as usize][0];
        let mut cores = BTreeMap::new();
        for nodes in self.elements.iter() {
            let off = nodes.iter().map(|&n| radius(n)).filter(|&x| x > on_axis).fold(f64::INFINITY, f64::min);
            for &n in nodes.iter().filter(|&&n| radius(n) <= on_axis && off.is_finite()) {
                let core: &mut f64 = cores.entry(n).or_insert(f64::INFINITY);
                *core = core.min(CORE * off);
            }
        }
        cores
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Disc, Portion, Rectangle};

    fn volume(mesh: &Mesh) -> f64 {
        mesh.elements
            .cells()
            .map(|(kind, nodes)| {
                let rule = kind.table().mass;
                let x: Vec<[f64; 3]> = nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
                let jacobian = |xi: [f64; 3]| {
                    let gradient = (kind.table().shape_gradient)(xi);
                    let j: [[f64; 3]; 3] = std::array::from_fn(|i| {
                        std::array::from_fn(|k| x.iter().zip(&gradient).map(|(x, g)| x[i] * g[k]).sum())
                    });
                    j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1])
                        - j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0])
                        + j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0])
                };
                rule.iter().map(|(xi, weight)| weight * jacobian(*xi)).sum::<f64>()
            })
            .sum()
    }

    /// Guldin: the volume of a radian is area times the radius of its centre, whatever the angle and the cells.
    #[test]
    fn a_radian_has_the_area_times_the_radius_of_its_centre() {
        let ring = Rectangle { min: [2.0, -1.0], max: [5.0, 1.0], divisions: [3, 2], grading: [2.0, 1.0] };
        for angle in [0.01, 0.03, 0.5] {
            let slice = Slice::Sector(angle);
            for quadratic in [false, true] {
                let layer = ring.generate().unwrap();
                let layer = if quadratic { layer.quadratic().unwrap() } else { layer };
                let mesh = layer.slice(slice).unwrap();
                assert!((volume(&mesh) / slice.extent() - 6.0 * 3.5).abs() < 1e-12);
                assert_eq!(mesh.node_sets.contains_key(MIDDLE), quadratic);
                assert_eq!(mesh.facets_of(BOUNDARY).unwrap().len(), 10);
                assert!(!mesh.node_sets.contains_key(AXIS));
            }
        }
    }

    #[test]
    fn nodes_on_the_axis_are_a_set_of_their_own() {
        let disc = Disc { radius: 2.0, part: Portion::Quarter, divisions: [3; 3], refinement: None };
        let layer = disc.generate().unwrap();
        let mesh = layer.clone().slice(Slice::Sector(0.03)).unwrap();
        // A quarter of a ball; its chords lie inside.
        let exact = 8.0 / 3.0;
        let part = volume(&mesh) / Slice::Sector(0.03).extent() / exact;
        assert!(part < 1.0 && part > 0.98, "{part}");
        assert_eq!(mesh.node_sets[AXIS].len(), 2 * 7);
        let plate = layer.slice(Slice::Plate(0.25)).unwrap();
        assert!((volume(&plate) / 0.25 / std::f64::consts::PI - 1.0).abs() < 0.02);
        let outside = disc.generate().unwrap().map(|[x, y, z]| [x - 1.0, y, z]).unwrap();
        assert!(matches!(outside.slice(Slice::Sector(0.03)), Err(MeshError::Parameter { parameter: "x", .. })));
    }
}
