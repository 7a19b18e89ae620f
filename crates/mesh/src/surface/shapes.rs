//! Plane, sphere and cuboid.

use std::collections::BTreeMap;

use super::SurfaceMesh;
use crate::MeshError;
use crate::generate::cube::{cube_surface, cubed_sphere};
use crate::generate::validate;

/// A rectangle in z = 0 with its centre at the origin and the normal +z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Size along x and y (lengths).
    pub size: [f64; 2],
    /// Numbers of facets along x and y.
    pub divisions: [u32; 2],
}

impl Plane {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (sizes, zero divisions), [`MeshError::TooLarge`].
    pub fn validate(&self) -> Result<(), MeshError> {
        validate::positive("size x", self.size[0])?;
        validate::positive("size y", self.size[1])?;
        validate::at_least("divisions x", self.divisions[0], 1)?;
        validate::at_least("divisions y", self.divisions[1], 1)?;
        let [nx, ny] = self.divisions.map(u128::from);
        validate::facet_count(&self.divisions, nx * ny)
    }

    /// The surface, of `nx ny` quadrilaterals.
    ///
    /// # Errors
    /// The errors of [`Plane::validate`], and [`MeshError::DegenerateFacet`] for facets that are slender beyond measure.
    pub fn generate(&self) -> Result<SurfaceMesh, MeshError> {
        self.validate()?;
        let [nx, ny] = self.divisions;
        let number = |i, j| j * (nx + 1) + i;
        let point = |(i, j)| [centred(self.size[0], i, nx), centred(self.size[1], j, ny), 0.0];
        let surface = SurfaceMesh {
            nodes: lattice(nx + 1, ny + 1).map(point).collect(),
            facets: lattice(nx, ny)
                .map(|(i, j)| [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)].into())
                .collect(),
            facet_sets: BTreeMap::new(),
        };
        surface.check()?;
        Ok(surface)
    }
}

/// A sphere about the origin as a cubed sphere: the six faces of a cube, divided evenly in angle and projected, so that
/// there are no poles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Radius (length).
    pub radius: f64,
    /// Number of facets along an edge of the cube's faces; four times as many go round the sphere.
    pub divisions: u32,
}

impl Sphere {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (radius, zero divisions), [`MeshError::TooLarge`].
    pub fn validate(&self) -> Result<(), MeshError> {
        validate::positive("radius", self.radius)?;
        validate::at_least("divisions", self.divisions, 1)?;
        let n = u128::from(self.divisions);
        validate::facet_count(&self.divisions, 6 * n * n)
    }

    /// The surface, of `6 n^2` quadrilaterals with `6 n^2 + 2` nodes.
    ///
    /// # Errors
    /// The errors of [`Sphere::validate`].
    pub fn generate(&self) -> Result<SurfaceMesh, MeshError> {
        self.validate()?;
        let (directions, quads) = cubed_sphere(self.divisions as usize);
        let surface = SurfaceMesh {
            nodes: directions.into_iter().map(|d| d.map(|c| self.radius * c)).collect(),
            facets: quads.into_iter().map(Into::into).collect(),
            facet_sets: BTreeMap::new(),
        };
        surface.check()?;
        Ok(surface)
    }
}

/// An axis-parallel box with its centre at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    /// Size along x, y, z (lengths).
    pub size: [f64; 3],
    /// Numbers of facets along x, y, z.
    pub divisions: [u32; 3],
}

impl Cuboid {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (sizes, zero divisions), [`MeshError::TooLarge`].
    pub fn validate(&self) -> Result<(), MeshError> {
        for i in 0..3 {
            validate::positive(["size x", "size y", "size z"][i], self.size[i])?;
            validate::at_least(["divisions x", "divisions y", "divisions z"][i], self.divisions[i], 1)?;
        }
        validate::facet_count(&self.divisions, self.face_counts().into_iter().map(|n| 2 * n).sum())
    }

    /// The surface, of `2 (nx ny + ny nz + nz nx)` quadrilaterals, with the sets of [`crate::generate::Block`].
    ///
    /// # Errors
    /// The errors of [`Cuboid::validate`], and [`MeshError::DegenerateFacet`] for facets that are slender beyond measure.
    pub fn generate(&self) -> Result<SurfaceMesh, MeshError> {
        self.validate()?;
        let n = self.divisions;
        let (points, quads) = cube_surface(n.map(|n| n as usize));
        let place = |p: [usize; 3]| std::array::from_fn(|i| centred(self.size[i], p[i] as u32, n[i]));
        let mut surface = SurfaceMesh {
            nodes: points.into_iter().map(place).collect(),
            facets: quads.into_iter().map(Into::into).collect(),
            facet_sets: BTreeMap::new(),
        };
        let mut first = 0;
        for (face, name) in ["left", "right", "front", "back", "bottom", "top"].into_iter().enumerate() {
            let next = first + self.face_counts()[face / 2] as u32;
            surface.facet_sets.insert(name.to_owned(), (first..next).collect());
            first = next;
        }
        surface.check()?;
        Ok(surface)
    }

    /// Numbers of facets of a face across x, y, z.
    fn face_counts(&self) -> [u128; 3] {
        let [nx, ny, nz] = self.divisions.map(u128::from);
        [ny * nz, nz * nx, nx * ny]
    }
}

/// Index pairs below `nx`, `ny`, the first index fastest.
fn lattice(nx: u32, ny: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j)))
}

/// Point `i` of `n + 1` from `-size / 2` to `size / 2`, symmetric to the last bit.
fn centred(size: f64, i: u32, n: u32) -> f64 {
    size * ((2 * i64::from(i) - i64::from(n)) as f64 / (2 * i64::from(n)) as f64)
}
