//! `[[body]]`: mesh, placement, material, density, initial velocity.

use crate::names::named;
use crate::{Material, MeshSource};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// Mass matrix of a body.
    Mass {
        /// `M_IJ = int rho N_I N_J dV`.
        Consistent = "consistent",
        /// On the diagonal: row sums of the consistent mass, or its diagonal scaled to the mass of each element where row sums are negative (hex20, tet10, wedge15).
        Lumped = "lumped",
    }
}

named! {
    /// Elements that a mesh is turned into.
    Cell {
        /// Linear hexahedra.
        Hex8 = "hex8",
        /// Quadratic hexahedra with nodes on the edges.
        Hex20 = "hex20",
        /// Quadratic hexahedra with nodes on edges, faces and in the middle.
        Hex27 = "hex27",
        /// Linear tetrahedra; too stiff in bending and where the material is nearly incompressible.
        Tet4 = "tet4",
        /// Quadratic tetrahedra.
        Tet10 = "tet10",
        /// Linear wedges.
        Wedge6 = "wedge6",
        /// Quadratic wedges.
        Wedge15 = "wedge15",
        /// Quadratic elements on the corners of the linear ones: hex20, tet10, wedge15.
        Quadratic = "quadratic",
    }
}

named! {
    /// Points at which stress and stiffness of an element are taken.
    Integration {
        /// As many as each element needs.
        Full = "full",
        /// Fewer: 8 of hex20, which then bends without locking and has modes without stiffness; 4 of tet10, which do not see its corners.
        Reduced = "reduced",
    }
}

named! {
    /// How the volume change of an element is interpolated.
    Volumetric {
        /// By the displacements at every point.
        Displacement = "displacement",
        /// By means over each element (linear over a hex27), so that nearly incompressible materials do not lock.
        Mixed = "mixed",
    }
}

/// A deformable body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Unique name: letters, digits, `-` and `_`. Sets of the body are called `body.set`.
    pub name: String,
    /// Generator or file of the mesh.
    pub mesh: MeshSource,
    /// Translation of the mesh, after the rotation (length).
    #[serde(default)]
    pub position: [f64; 3],
    /// Rotation of the mesh, or a list of rotations that are done one after the other.
    #[serde(default, skip_serializing_if = "Rotations::is_empty")]
    pub rotation: Rotations,
    /// Elements that the mesh is turned into: hexahedra into any, wedges into tetrahedra, linear elements into quadratic ones. Boundaries that are curved stay so.
    /// The mesh's own if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell: Option<Cell>,
    /// Points at which stress and stiffness are taken: `full` if left out.
    #[serde(default = "Body::default_integration", skip_serializing_if = "Body::is_full")]
    pub integration: Integration,
    /// Interpolation of the volume change: `displacement` if left out; `mixed` for nearly incompressible materials.
    #[serde(default = "Body::default_volumetric", skip_serializing_if = "Body::is_displacement")]
    pub volumetric: Volumetric,
    /// Hyperelastic law and its parameters.
    pub material: Material,
    /// Mass per reference volume, positive. Required in dynamic scenes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Consistent or lumped mass.
    #[serde(default = "Body::default_mass")]
    pub mass: Mass,
    /// Mass- and stiffness-proportional damping; none if left out. Dynamic scenes only; it acts in dynamic stages.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<Damping>,
    /// Initial velocity `v0` of `v(X) = v0 + omega x (X - c) + G (X - c)`, with `X` the placed reference position.
    /// Dynamic scenes only.
    #[serde(default, skip_serializing_if = "is_default")]
    pub velocity: [f64; 3],
    /// Initial angular velocity `omega` (1/time).
    #[serde(default, skip_serializing_if = "is_default")]
    pub angular_velocity: [f64; 3],
    /// Initial velocity gradient `G`, three rows (1/time).
    #[serde(default, skip_serializing_if = "is_default")]
    pub velocity_gradient: [[f64; 3]; 3],
    /// Point `c` about which `angular_velocity` and `velocity_gradient` act.
    #[serde(default, skip_serializing_if = "is_default")]
    pub velocity_about: [f64; 3],
}

/// Damping of a body (Rayleigh): for small strains the force `(mass M + stiffness K) v`. A mode with the angular frequency `w` has the damping ratio
/// `mass / (2 w) + stiffness w / 2`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Damping {
    /// Factor of the mass, not negative (1/time). It slows rigid motions too.
    #[serde(default)]
    pub mass: f64,
    /// Factor of the stiffness at small strains, not negative (time): a viscous stress in the material frame, which leaves rigid motions and both momenta alone.
    #[serde(default)]
    pub stiffness: f64,
}

/// A scene is written without velocities that are zero, for a quasi-static one must not have the keys.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Body {
    fn default_mass() -> Mass {
        Mass::Consistent
    }

    fn default_integration() -> Integration {
        Integration::Full
    }

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
    fn is_full(integration: &Integration) -> bool {
        *integration == Integration::Full
    }

    fn default_volumetric() -> Volumetric {
        Volumetric::Displacement
    }

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
    fn is_displacement(volumetric: &Volumetric) -> bool {
        *volumetric == Volumetric::Displacement
    }

    /// Initial velocity of the material point with the placed reference position `x`:
    /// `v0 + omega x (x - c) + G (x - c)`.
    pub fn initial_velocity(&self, x: [f64; 3]) -> [f64; 3] {
        let r: [f64; 3] = std::array::from_fn(|i| x[i] - self.velocity_about[i]);
        let w = self.angular_velocity;
        let spin = [w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]];
        std::array::from_fn(|i| {
            let g = self.velocity_gradient[i];
            self.velocity[i] + spin[i] + g[0] * r[0] + g[1] * r[1] + g[2] * r[2]
        })
    }
}

/// A rotation of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// Direction of the axis, of any length but zero.
    pub axis: [f64; 3],
    /// Angle in degrees, positive by the right-hand rule.
    pub degrees: f64,
    /// A point of the axis; the origin of the mesh's own coordinates if left out.
    #[serde(default)]
    pub about: [f64; 3],
}

/// One rotation or a list of them; see [`Rotations::as_slice`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum Rotations {
    /// A single rotation.
    One(Rotation),
    /// Rotations in the order in which they are done.
    Many(Vec<Rotation>),
}

impl Default for Rotations {
    fn default() -> Self {
        Self::Many(Vec::new())
    }
}

impl Rotations {
    /// The rotations in the order in which they are done.
    pub fn as_slice(&self) -> &[Rotation] {
        match self {
            Self::One(rotation) => std::slice::from_ref(rotation),
            Self::Many(rotations) => rotations,
        }
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.as_slice().is_empty()
    }
}

#[cfg(test)]
mod tests {
    use crate::parse;

    #[test]
    fn velocity_field_of_a_spinning_stretching_body() {
        // v = omega x X + 20 z e_z with omega = (30, 0, 10), evaluated by hand at X = (1, 2, 3)
        let text = crate::samples::dynamic().replace(
            "velocity = [0.0, 1.0, -1.0]",
            "angular_velocity = [30, 0, 10]\nvelocity_gradient = [[0, 0, 0], [0, 0, 0], [0, 0, 20]]",
        );
        let scene = parse(&text, "x.toml").unwrap();
        let v = scene.bodies[0].initial_velocity([1.0, 2.0, 3.0]);
        assert_eq!(v, [-20.0, 10.0 - 90.0, 60.0 + 60.0]);
    }
}
