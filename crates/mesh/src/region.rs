//! Sets from regions of space.

use crate::error::parameter;
use crate::{Facet, Mesh, MeshError, SetKind};

/// A region of space from which sets follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    /// An axis-parallel box, its boundary included.
    Box {
        /// Smallest coordinates.
        min: [f64; 3],
        /// Largest coordinates.
        max: [f64; 3],
    },
    /// A layer of thickness `2 tolerance` about a plane.
    Plane {
        /// A point of the plane.
        point: [f64; 3],
        /// Normal of the plane, of any length but zero.
        normal: [f64; 3],
        /// Largest distance of a node from the plane (length).
        tolerance: f64,
    },
}

impl Region {
    /// True if the point lies in the region.
    pub fn contains(&self, x: [f64; 3]) -> bool {
        match self {
            Region::Box { min, max } => (0..3).all(|i| min[i] <= x[i] && x[i] <= max[i]),
            Region::Plane { point, normal, tolerance } => {
                let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
                let distance = (0..3).map(|i| (x[i] - point[i]) * normal[i]).sum::<f64>() / length;
                distance.abs() <= *tolerance
            }
        }
    }

    /// Checks the region's numbers. A box may have infinite bounds.
    ///
    /// # Errors
    /// [`MeshError::Parameter`]: NaN, `min > max`, a zero normal, a negative tolerance.
    pub fn validate(&self) -> Result<(), MeshError> {
        match self {
            Region::Box { min, max } => {
                if min.iter().chain(max).any(|x| x.is_nan()) {
                    return Err(parameter("box", (min, max), "coordinates must be numbers"));
                }
                if let Some(i) = (0..3).find(|&i| min[i] > max[i]) {
                    let axis = ["x", "y", "z"][i];
                    return Err(parameter("box", (min, max), format!("min must not exceed max in {axis}")));
                }
            }
            Region::Plane { point, normal, tolerance } => {
                if !point.iter().all(|x| x.is_finite()) {
                    return Err(parameter("plane point", point, "coordinates must be finite"));
                }
                let square: f64 = normal.iter().map(|n| n * n).sum();
                if !(square.is_normal() && square > 0.0) {
                    return Err(parameter("plane normal", normal, "must be finite and not zero"));
                }
                if !(tolerance.is_finite() && *tolerance >= 0.0) {
                    return Err(parameter("plane tolerance", tolerance, "must be finite and not negative"));
                }
            }
        }
        Ok(())
    }
}

impl std::fmt::Display for Region {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Region::Box { min, max } => write!(f, "the box {min:?} to {max:?}"),
            Region::Plane { point, normal, tolerance } => {
                write!(f, "the plane through {point:?} with normal {normal:?} within {tolerance}")
            }
        }
    }
}

/// A region and the name of a set of what is in it.
fn check_new_set(name: &str, region: &Region, exists: bool) -> Result<(), MeshError> {
    region.validate()?;
    if name.trim().is_empty() {
        return Err(parameter("set name", name, "must not be empty"));
    }
    if exists { Err(MeshError::SetExists { name: name.to_owned() }) } else { Ok(()) }
}

/// The error for a set without members.
fn empty(name: &str, kind: SetKind, region: &Region, (min, max): ([f64; 3], [f64; 3])) -> MeshError {
    MeshError::EmptySet { name: name.to_owned(), kind, region: region.to_string().into(), min, max }
}

impl crate::SurfaceMesh {
    /// Adds the set of the facets all of whose nodes are in a region.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] if the region or the name is bad, [`MeshError::SetExists`],
    /// [`MeshError::EmptySet`] if no facet lies in the region.
    pub fn add_region_set(&mut self, name: &str, region: &Region) -> Result<(), MeshError> {
        check_new_set(name, region, self.set_names().iter().any(|set| set == name))?;
        let inside = |f: &u32| self.facet_coordinates(*f).iter().all(|&x| region.contains(x));
        let facets: Vec<u32> = (0..self.facets.len() as u32).filter(inside).collect();
        if facets.is_empty() {
            return Err(empty(name, SetKind::Facets, region, self.bounding_box()));
        }
        self.facet_sets.insert(name.to_owned(), facets);
        Ok(())
    }
}

impl Mesh {
    /// The nodes in a region, sorted.
    pub fn nodes_in(&self, region: &Region) -> Vec<u32> {
        (0..self.nodes.len() as u32).filter(|&n| region.contains(self.nodes[n as usize])).collect()
    }

    /// The boundary facets all of whose nodes are in a region, sorted.
    pub fn facets_in(&self, region: &Region) -> Vec<Facet> {
        let inside = self.inside(region);
        let mut facets = self.boundary_facets();
        facets.retain(|f| f.nodes.iter().all(|&n| inside[n as usize]));
        facets
    }

    /// The elements all of whose nodes are in a region, sorted.
    pub fn elements_in(&self, region: &Region) -> Vec<u32> {
        let inside = self.inside(region);
        let all_inside = |&e: &u32| self.elements[e as usize].iter().all(|&n| inside[n as usize]);
        (0..self.elements.len() as u32).filter(all_inside).collect()
    }

    /// Adds the sets of a region under one name: its nodes, its boundary facets and its elements, each unless empty.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] if the region or the name is bad, [`MeshError::SetExists`],
    /// [`MeshError::EmptySet`] if no node lies in the region.
    pub fn add_region_sets(&mut self, name: &str, region: &Region) -> Result<(), MeshError> {
        check_new_set(name, region, self.has_set(name))?;
        let nodes = self.nodes_in(region);
        if nodes.is_empty() {
            return Err(empty(name, SetKind::Nodes, region, self.bounding_box()));
        }
        let (facets, elements) = (self.facets_in(region), self.elements_in(region));
        self.node_sets.insert(name.to_owned(), nodes);
        if !facets.is_empty() {
            self.facet_sets.insert(name.to_owned(), facets);
        }
        if !elements.is_empty() {
            self.element_sets.insert(name.to_owned(), elements);
        }
        Ok(())
    }

    fn inside(&self, region: &Region) -> Vec<bool> {
        self.nodes.iter().map(|&x| region.contains(x)).collect()
    }
}
