//! `[[body]]`: mesh, placement, material, density, initial velocity.

use crate::names::named;
use crate::read::{Node, Table, Value};
use crate::world::Setting;
use crate::{Material, MeshSource, OneOrMany};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
#[cfg(feature = "schema")]
use std::borrow::Cow;
use stoss_reference_element::CellKind;
use stoss_scene_derive::table;

named! {
    /// Mass matrix of a body.
    Mass {
        /// Consistent mass matrix `M_IJ = int rho N_I N_J dV`.
        Consistent = "consistent",
        /// Diagonal mass matrix: row sums of the consistent one, or its diagonal scaled to the mass of each element (HRZ) where row sums are negative (hex20, tet10, wedge15).
        Lumped = "lumped",
    }
}

/// Element type into which a mesh can be converted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
pub enum Cell {
    /// A kind of the table of cells.
    Kind(CellKind),
    /// The quadratic element of the shape of each linear one.
    Quadratic,
}

impl Cell {
    const ALL_QUADRATIC: &str = "quadratic";

    /// Names of all kinds of cells.
    pub fn names() -> impl Iterator<Item = &'static str> {
        CellKind::ALL.into_iter().map(CellKind::name).chain([Self::ALL_QUADRATIC])
    }

    /// The cell kind of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        if name == Self::ALL_QUADRATIC { Some(Self::Quadratic) } else { CellKind::from_name(name).map(Self::Kind) }
    }

    /// Name of the cell kind in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kind(kind) => kind.name(),
            Self::Quadratic => Self::ALL_QUADRATIC,
        }
    }
}

impl From<Cell> for String {
    fn from(cell: Cell) -> Self {
        cell.name().to_owned()
    }
}

impl<C> Value<C> for Cell {
    fn read(node: &Node<'_>, _: &C) -> Option<Self> {
        node.choice(&Self::names().collect::<Vec<_>>(), Self::from_name)
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Cell {
    fn schema_name() -> Cow<'static, str> {
        "Cell".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let row =
            |name: &str, about: &str| serde_json::json!({ "type": "string", "const": name, "description": about });
        let linear = CellKind::ALL.into_iter().filter(|kind| !kind.is_quadratic());
        let quadratic: Vec<&str> = linear.map(|kind| kind.quadratic().name()).collect();
        let about = format!("The quadratic element of the shape of each linear one: {}.", quadratic.join(", "));
        let kinds = CellKind::ALL.into_iter().map(|kind| row(kind.name(), kind.table().about));
        let all: Vec<_> = kinds.chain([row(Self::ALL_QUADRATIC, &about)]).collect();
        json_schema!({ "description": "Element types into which a mesh can be converted.", "oneOf": all })
    }
}

named! {
    /// Integration rule for stress and stiffness.
    Integration {
        /// Full integration: enough Gauss points for the stiffness of each element.
        Full = "full",
        /// Reduced integration: 8 points of hex20, which then does not lock in bending but has zero-energy modes; 4 points of tet10, none of them near its corners.
        Reduced = "reduced",
    }
}

named! {
    /// Interpolation of the volume change in an element.
    Volumetric {
        /// From the displacements at every Gauss point.
        Displacement = "displacement",
        /// Mixed form: means over each element (linear over a hex27), so that nearly incompressible materials do not lock.
        Mixed = "mixed",
    }
}

named! {
    /// Shape of a round surface.
    RoundShape {
        /// A circular cylinder.
        Cylinder = "cylinder",
        /// A sphere.
        Sphere = "sphere",
    }
}

/// A surface of linear elements whose nodes lie on a cylinder or a sphere.
#[table(example = "{ set = \"outer\", surface = \"cylinder\" }")]
pub struct RoundSurface {
    /// Set of facets of the body, without the name of the body.
    #[key(example = "\"outer\"")]
    pub set: String,
    /// What its nodes lie on; where, follows from them.
    #[key(example = "\"cylinder\"")]
    pub surface: RoundShape,
}

/// `[[body]]`: a deformable body.
#[table(context(Setting<'_>), check = body)]
pub struct Body {
    /// Name, unique among all parts: letters, digits, `-` and `_`. Sets of the body are written `name.set`.
    #[key(example = "\"ball\"", name)]
    pub name: String,
    /// Mesh: a generator with its parameters, or a file.
    #[key(example = "{ generator = \"block\", size = [1, 1, 1], divisions = [4, 4, 4] }")]
    pub mesh: MeshSource,
    /// Translation of the mesh, after the rotation (a length each).
    #[key(default, dimension = Length)]
    pub position: [f64; 3],
    /// Rotation of the mesh, or a list of rotations that are applied one after the other; none if left out.
    #[key(default, skip)]
    pub rotation: Rotations,
    /// Element type to which the mesh is converted: hexahedra to any type, wedges to tetrahedra, linear elements to quadratic ones. Curved boundaries stay curved.
    /// If left out the elements of the mesh are used.
    pub cell: Option<Cell>,
    /// Surfaces of linear elements that are round: general contact and node-to-surface contact then see their true positions, and not the flat facets, which are a part of a clearance or a press fit off.
    #[key(default, skip)]
    pub round: Vec<RoundSurface>,
    /// Integration rule for stress and stiffness: `full` if left out.
    #[key(default = Integration::Full, skip)]
    pub integration: Integration,
    /// Interpolation of the volume change: `mixed` for nearly incompressible materials and for such that yield; if left out `mixed` of a material with `plasticity`, else `displacement`.
    pub volumetric: Option<Volumetric>,
    /// Hyperelastic law with its parameters.
    #[key(example = "{ law = \"neo-hooke\", young = 2250.0, poisson = 0.3 }")]
    pub material: Material,
    /// Density: mass per reference volume, positive. Required in dynamic scenes, and with gravity.
    #[key(dimension = Density, by = |node, setting| setting.mass_value(node))]
    pub density: Option<f64>,
    /// Mass matrix: `consistent` if left out, or `lumped`.
    #[key(default = Mass::Consistent)]
    pub mass: Mass,
    /// Mass- and stiffness-proportional (Rayleigh) damping; none if left out. Dynamic scenes only; it acts in dynamic stages.
    pub damping: Option<Damping>,
    /// Initial velocity `v0` (length per time) in `v(X) = v0 + omega x (X - c) + G (X - c)`, where `X` is the reference position after placement.
    /// Zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = Velocity)]
    pub velocity: [f64; 3],
    /// Initial angular velocity `omega` (radians per time); zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = AngularVelocity)]
    pub angular_velocity: [f64; 3],
    /// Initial velocity gradient `G`, three rows (1/time); zero if left out. Dynamic scenes only.
    #[key(default, skip, dimension = Rate)]
    pub velocity_gradient: [[f64; 3]; 3],
    /// Point `c` about which `angular_velocity` and `velocity_gradient` act; the origin if left out.
    #[key(default, skip, dimension = Length)]
    pub velocity_about: [f64; 3],
}

/// Damping of a body (Rayleigh): for small strains the force `(mass M + stiffness K) v`. A mode with the angular frequency `w` has the damping ratio
/// `mass / (2 w) + stiffness w / 2`.
#[table(example = "{ mass = 0.1, stiffness = 1e-4 }", check_all = damping)]
#[derive(Copy)]
pub struct Damping {
    /// Factor of the mass matrix, not negative (1/time); 0 if left out. It also damps rigid motions.
    #[key(default, dimension = Rate, not_negative)]
    pub mass: f64,
    /// Factor of the stiffness at small strains, not negative (a time); 0 if left out. It is a viscous stress in the material frame and changes neither rigid motions nor momenta.
    #[key(default, dimension = Time, not_negative)]
    pub stiffness: f64,
}

impl Body {
    /// Interpolation of the volume change. Plastic flow keeps the volume, so that displacement elements lock in it whatever Poisson's ratio is.
    pub fn volumetric(&self) -> Volumetric {
        let yields = self.material.inelasticity.plasticity.is_some();
        self.volumetric.unwrap_or(if yields { Volumetric::Mixed } else { Volumetric::Displacement })
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

/// A rotation of a mesh about an axis.
#[table]
#[derive(Copy)]
pub struct Rotation {
    /// Direction of the axis, of any length but zero.
    #[key(dimension = Number, example = "[0, 0, 1]", direction)]
    pub axis: [f64; 3],
    /// Angle in degrees, positive by the right-hand rule.
    #[key(dimension = Angle, example = "90")]
    pub degrees: f64,
    /// A point on the axis; the origin of the coordinates of the mesh if left out.
    #[key(default, dimension = Length)]
    pub about: [f64; 3],
}

/// Rotations in the order in which they are applied.
pub type Rotations = OneOrMany<Rotation>;

/// Keys that have a meaning only with inertia.
const MOTION: [&str; 5] = ["velocity", "angular_velocity", "velocity_gradient", "velocity_about", "damping"];

fn body(_: &BodyKeys, table: &Table<'_>, setting: &Setting<'_>) -> Option<()> {
    let mass = setting.demand_mass(table, "density", "density = 10.0");
    setting.at_rest(table, &MOTION)?;
    mass
}

fn damping<C>(damping: &Damping, table: &Table<'_>, _: &C) -> Option<()> {
    if *damping == Damping::default() {
        let remedy = "write { mass = 0.1, stiffness = 1e-4 } or one of them, or remove it";
        return table.node.fail("has only factors of zero", remedy);
    }
    Some(())
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
