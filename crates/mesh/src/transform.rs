//! Placement of a mesh: rotation, translation, general maps.

use crate::error::parameter;
use crate::{Mesh, MeshError};

/// A rotation about an axis through a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Direction of the axis, of any length but zero.
    pub axis: [f64; 3],
    /// Angle in degrees, positive by the right-hand rule.
    pub degrees: f64,
    /// A point of the axis.
    pub about: [f64; 3],
}

impl Rotation {
    /// The rotation matrix `R = cos 1 + sin [n x] + (1 - cos) n (x) n` (rows). Multiples of 90 degrees about a coordinate axis
    /// are free of rounding.
    ///
    /// # Errors
    /// [`MeshError::Parameter`]: an axis that is zero or not finite, an angle or a point that is not finite.
    pub fn matrix(&self) -> Result<[[f64; 3]; 3], MeshError> {
        let largest = self.axis.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        if !(self.axis.iter().all(|a| a.is_finite()) && largest > 0.0) {
            return Err(parameter("rotation axis", self.axis, "must be finite and not zero"));
        }
        if !self.degrees.is_finite() {
            return Err(parameter("rotation degrees", self.degrees, "must be finite"));
        }
        if !self.about.iter().all(|a| a.is_finite()) {
            return Err(parameter("rotation point", self.about, "must be finite"));
        }
        let scaled = self.axis.map(|a| a / largest);
        let length = scaled.iter().map(|a| a * a).sum::<f64>().sqrt();
        let n = scaled.map(|a| a / length);
        let (s, c) = sin_cos_degrees(self.degrees);
        let mut r: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| (1.0 - c) * n[i] * n[j]));
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            r[i][i] += c;
            r[j][k] -= s * n[i];
            r[k][j] += s * n[i];
        }
        Ok(r)
    }
}

impl Mesh {
    /// Rotates the mesh, then translates it; vectors of elements turn with it.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] if the rotation or the translation is bad; the mesh is then unchanged.
    pub fn transform(&mut self, rotation: Option<&Rotation>, translation: [f64; 3]) -> Result<(), MeshError> {
        place(&mut self.nodes, rotation, translation)?;
        if let Some(rotation) = rotation {
            let about_origin = Rotation { about: [0.0; 3], ..*rotation };
            for vectors in self.element_vectors.values_mut() {
                place(vectors, Some(&about_origin), [0.0; 3])?;
            }
        }
        Ok(())
    }

    /// The mesh with mapped coordinates; connectivity and sets stay.
    ///
    /// # Errors
    /// [`MeshError::NonFiniteNode`], [`MeshError::InvertedElement`] if the map is not finite or turns an element over.
    pub fn map(mut self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Result<Mesh, MeshError> {
        for x in &mut self.nodes {
            *x = map(*x);
        }
        self.check_geometry()?;
        Ok(self)
    }
}

/// Rotates points, then translates them.
///
/// # Errors
/// [`MeshError::Parameter`] if the rotation or the translation is bad; the points are then unchanged.
pub(crate) fn place(
    nodes: &mut [[f64; 3]],
    rotation: Option<&Rotation>,
    translation: [f64; 3],
) -> Result<(), MeshError> {
    if !translation.iter().all(|a| a.is_finite()) {
        return Err(parameter("position", translation, "must be finite"));
    }
    if let Some(rotation) = rotation {
        let (r, p) = (rotation.matrix()?, rotation.about);
        for x in nodes.iter_mut() {
            let d: [f64; 3] = std::array::from_fn(|i| x[i] - p[i]);
            *x = std::array::from_fn(|i| p[i] + (r[i][0] * d[0] + r[i][1] * d[1] + r[i][2] * d[2]));
        }
    }
    for x in nodes.iter_mut() {
        for i in 0..3 {
            x[i] += translation[i];
        }
    }
    Ok(())
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
pub(crate) fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    let quadrant = (turn / 90.0).floor();
    let (s, c) = (turn - 90.0 * quadrant).to_radians().sin_cos();
    match quadrant as u8 % 4 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}
