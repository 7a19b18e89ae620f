//! Shapes with an axis of revolution: cylinder and cone.

use super::SurfaceMesh;
use crate::MeshError;
use crate::error::parameter;
use crate::generate::validate;
use crate::transform::sin_cos_degrees;

/// Numbers of facets of a shape with an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RoundDivisions {
    /// Facets around the axis, at least 3.
    pub around: u32,
    /// Facets along the side, from one end to the other.
    pub along: u32,
    /// Facets from the axis to the edge of a flat end; the innermost ones are triangles.
    pub radial: u32,
}

impl RoundDivisions {
    /// `ends` is the number of flat ends.
    fn validate(&self, ends: u128) -> Result<(), MeshError> {
        validate::at_least("divisions around", self.around, 3)?;
        validate::at_least("divisions along", self.along, 1)?;
        validate::at_least("divisions radial", self.radial, 1)?;
        let [around, along, radial] = [self.around, self.along, self.radial].map(u128::from);
        validate::facet_count(self, around * (along + ends * radial))
    }
}

/// A solid cylinder about the z-axis with its centre at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Radius (length).
    pub radius: f64,
    /// Length along z (length).
    pub length: f64,
    /// Numbers of facets.
    pub divisions: RoundDivisions,
}

impl Cylinder {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (lengths, divisions), [`MeshError::TooLarge`].
    pub fn validate(&self) -> Result<(), MeshError> {
        validate::positive("radius", self.radius)?;
        validate::positive("length", self.length)?;
        self.divisions.validate(2)
    }

    /// The surface, of `around (along + 2 radial)` facets, with the sets `side`, `bottom`, `top`.
    ///
    /// # Errors
    /// The errors of [`Cylinder::validate`], and [`MeshError::DegenerateFacet`] for facets that are slender beyond measure.
    pub fn generate(&self) -> Result<SurfaceMesh, MeshError> {
        self.validate()?;
        let (r, h) = (self.radius, 0.5 * self.length);
        let RoundDivisions { around, along, radial } = self.divisions;
        revolve(
            around,
            &[[0.0, -h], [r, -h], [r, h], [0.0, h]],
            &[("bottom", radial), ("side", along), ("top", radial)],
        )
    }
}

/// A solid cone about the z-axis, whole or cut off. The tip is in the origin and points to -z, the base is at `z = height`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Radius of the base (length).
    pub radius: f64,
    /// Distance of base and tip (length).
    pub height: f64,
    /// Radius of the flat end where the tip is cut off; 0 for a sharp tip (length).
    pub tip_radius: f64,
    /// Numbers of facets.
    pub divisions: RoundDivisions,
}

impl Cone {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (lengths, a tip not smaller than the base, divisions), [`MeshError::TooLarge`].
    pub fn validate(&self) -> Result<(), MeshError> {
        validate::positive("radius", self.radius)?;
        validate::positive("height", self.height)?;
        tip_radius(self.tip_radius, self.radius)?;
        self.divisions.validate(if self.tip_radius > 0.0 { 2 } else { 1 })
    }

    /// The surface with the sets `side`, `base`, and `tip` if it is flat. At a sharp tip the facets are triangles with
    /// one common node.
    ///
    /// # Errors
    /// The errors of [`Cone::validate`], and [`MeshError::DegenerateFacet`] for facets that are slender beyond measure.
    pub fn generate(&self) -> Result<SurfaceMesh, MeshError> {
        self.validate()?;
        let (r, t, h) = (self.radius, self.tip_radius, self.height);
        let RoundDivisions { around, along, radial } = self.divisions;
        let side = [("side", along), ("base", radial)];
        if t > 0.0 {
            let corners = [[0.0, 0.0], [t, 0.0], [r, h], [0.0, h]];
            revolve(around, &corners, &[("tip", radial), side[0], side[1]])
        } else {
            revolve(around, &[[0.0, 0.0], [r, h], [0.0, h]], &side)
        }
    }
}

/// The radius of a tip must be at least 0 and below the radius of the base.
pub(super) fn tip_radius(tip: f64, base: f64) -> Result<(), MeshError> {
    if (0.0..base).contains(&tip) {
        Ok(())
    } else {
        Err(parameter("tip_radius", tip, format!("must be at least 0 and below the radius {base}")))
    }
}

/// Turns a profile about the z-axis. Its `corners` are pairs (distance from the axis, z); the first and the last lie on
/// the axis and no other does. Section `s` between corners `s` and `s + 1` has a name and a number of facets. The
/// outside is on the right of the way along the profile, seen with the axis upwards and the profile on the right of it.
fn revolve(around: u32, corners: &[[f64; 2]], sections: &[(&str, u32)]) -> Result<SurfaceMesh, MeshError> {
    let mut surface = SurfaceMesh::default();
    let directions: Vec<(f64, f64)> =
        (0..around).map(|i| sin_cos_degrees(360.0 * f64::from(i) / f64::from(around))).collect();
    // First node of the circle below, or the node on the axis.
    let mut below = (0, corners[0][0] == 0.0);
    surface.nodes.push([0.0, 0.0, corners[0][1]]);
    for (&(name, count), ends) in sections.iter().zip(corners.windows(2)) {
        let first_facet = surface.facets.len() as u32;
        for step in 1..=count {
            let s = f64::from(step) / f64::from(count);
            let [r, z] = std::array::from_fn(|i| {
                if step == count { ends[1][i] } else { ends[0][i] + s * (ends[1][i] - ends[0][i]) }
            });
            let above = (surface.nodes.len() as u32, r == 0.0);
            if above.1 {
                surface.nodes.push([0.0, 0.0, z]);
            } else {
                surface.nodes.extend(directions.iter().map(|(sin, cos)| [r * cos, r * sin, z]));
            }
            for i in 0..around {
                let next = (i + 1) % around;
                let [a, b] =
                    [below, above].map(|(first, on_axis)| if on_axis { [first; 2] } else { [first + i, first + next] });
                surface.facets.push(match (below.1, above.1) {
                    (true, _) => [a[0], b[1], b[0]].into(),
                    (false, true) => [a[0], a[1], b[0]].into(),
                    (false, false) => [a[0], a[1], b[1], b[0]].into(),
                });
            }
            below = above;
        }
        surface.facet_sets.insert(name.to_owned(), (first_facet..surface.facets.len() as u32).collect());
    }
    surface.check()?;
    Ok(surface)
}
