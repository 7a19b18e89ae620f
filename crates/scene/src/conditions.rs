//! Sets, contact, prescribed displacements, loads, and functions of time.

use crate::Friction;
use crate::coupling::Coupling;
use crate::names::named;
use crate::tie::Multipliers;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// Contact methods.
    ContactMethod {
        /// Node-to-surface: every slave node against the master's facets. The form follows the scheme: with `energy-momentum`
        /// the energy-momentum element (theory/node-to-surface#element), otherwise the direct one (theory/node-to-surface#residual).
        Nts = "nts",
        /// Node-to-surface by coordinate augmentation (theory/coordinate-augmentation): the foot's coordinates are unknowns of each contact. Statics, backward Euler,
        /// generalised-alpha, midpoint; with `energy-momentum` the solids conserve energy, the contact is that of the midpoint rule.
        Cat = "cat",
        /// Mortar: weighted gaps and pressures on the overlap of the facets (theory/mortar#eq-gap), whose integrals move with the positions.
        Mortar = "mortar",
    }
}

named! {
    /// What keeps the two bodies of a contact apart where the method does not see them: edges on edges, beyond rims, sides that are not named.
    #[derive(Default)]
    Edges {
        /// Nothing: the method acts alone.
        #[default]
        Method = "method",
        /// General contact, of surfaces half a thickness inside the bodies, so that it has nothing to do as long as the method keeps the gaps.
        General = "general",
    }
}

named! {
    /// How much of the system of coordinate augmentation is eliminated (theory/coordinate-augmentation#full). The result is the same.
    Reduction {
        /// Nothing: pressure, two coordinates and two multipliers for each slave node.
        None = "none",
        /// The multipliers.
        First = "first",
        /// Multipliers and coordinates: the size of the direct form.
        Second = "second",
    }
}

named! {
    /// Gauss points of the triangles that mortar integrals are made of.
    Quadrature {
        /// 4 points, degree 3, one weight negative.
        FourPoint = "four-point",
        /// 7 points, degree 5.
        SevenPoint = "seven-point",
        /// 12 points, degree 6.
        TwelvePoint = "twelve-point",
    }
}

named! {
    /// What becomes of the energy that gaps cost when they close in a step of mortar contact.
    Closing {
        /// It is lost, as in the impact of two parts that move on together.
        Keep = "keep",
        /// It goes back into the velocities at the end of the step, by an impulse of the contact forces that leaves both momenta as they are.
        Restore = "restore",
    }
}

named! {
    /// Which integrals the weighted gaps of mortar contact have.
    Integrals {
        /// Those of the present positions: the weighted gap is a function of the positions alone.
        Moving = "moving",
        /// Those of the expected middle of the step, held in the step, as in the thesis: for comparison. With schemes that take contact forces at the
        /// middle of the step. Sliding over facets gains or loses energy by it.
        Frozen = "frozen",
    }
}

named! {
    /// What an active constraint asks for (theory/constraints#eq-modified).
    Constraint {
        /// Zero gap at the end of a step. Energy changes in a step in which a node closes.
        Standard = "standard",
        /// The gap keeps its value in the step: conserves energy, while nodes float at the gap that they had. Frictionless
        /// dynamics only.
        Modified = "modified",
    }
}

/// How the normal part of a contact is enforced. Stiffnesses are tractions per length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Enforcement {
    /// Exactly, the pressures being unknowns.
    #[default]
    Multiplier,
    /// By springs of this stiffness against penetration.
    Penalty(
        /// Stiffness, positive.
        f64,
    ),
    /// Exactly, by an augmented Lagrangian: further solutions a step, fewer for a larger stiffness.
    Augmented(
        /// Stiffness, positive. It decides on the number of solutions, not on the result.
        f64,
    ),
}

impl Enforcement {
    /// Names of the variants.
    pub const NAMES: &'static [&'static str] = &["multiplier", "penalty", "augmented"];

    pub(crate) fn is_multiplier(&self) -> bool {
        *self == Self::Multiplier
    }
}

named! {
    /// Cartesian component.
    Component {
        /// First.
        X = "x",
        /// Second.
        Y = "y",
        /// Third.
        Z = "z",
    }
}

impl Component {
    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// `[[set]]`: nodes, facets and elements of a body, or of a rigid body with a surface, inside a box or on a plane, in the placed reference configuration.
/// Exactly one of `box` and `plane`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SetDefinition {
    /// `body.name`, unique.
    pub name: String,
    /// Name of the body.
    pub body: String,
    /// An axis-parallel box, its boundary included.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub inside: Option<BoxRegion>,
    /// A plane with a tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneRegion>,
}

impl SetDefinition {
    /// Name of the set within its body (`rim` of `plate.rim`).
    pub fn local_name(&self) -> &str {
        split_set(&self.name).map_or(&self.name, |(_, set)| set)
    }
}

/// Part and set of a reference `part.set`: what is before and after the first dot.
pub fn split_set(reference: &str) -> Option<(&str, &str)> {
    reference.split_once('.').filter(|(body, set)| !body.is_empty() && !set.is_empty())
}

/// An axis-parallel box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BoxRegion {
    /// Smallest coordinates; `-inf` is allowed.
    pub min: [f64; 3],
    /// Largest coordinates, not below `min`; `inf` is allowed.
    pub max: [f64; 3],
}

/// A plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PlaneRegion {
    /// A point of the plane.
    pub point: [f64; 3],
    /// Its normal, of any length but zero.
    pub normal: [f64; 3],
    /// Largest distance of a node from the plane; by default a millionth of the body's size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

/// `[[contact]]`: unilateral contact, with or without friction, of a slave surface with a master surface, of deformable or rigid bodies.
///
/// With `nts` the slave may also be a set of a beam or string (`rope.all`): its nodes touch, from any side, and pressures are forces per length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Unique name for reports; `slave/master`, or the two of `between`, if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Contact method.
    pub method: ContactMethod,
    /// Slave surface, `body.set`; with `nts` also a set of a beam or string.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slave: Option<String>,
    /// Master surface, `body.set`, of another body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub master: Option<String>,
    /// Instead of `slave` and `master`: two surfaces of different bodies. The slave is a beam or string, else the one that is not prescribed as a whole, else the finer one, else the
    /// softer one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub between: Option<[String; 2]>,
    /// What an active constraint asks for. For `nts` and `cat`; `standard` if left out. Mortar contact has one constraint: the
    /// weighted gap of a closed node is zero at the end of a step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constraint: Option<Constraint>,
    /// `"multiplier"`, `{ penalty = stiffness }` or `{ augmented = stiffness }`.
    #[serde(default, skip_serializing_if = "Enforcement::is_multiplier")]
    pub enforcement: Enforcement,
    /// Size of the system, for `cat` only; `second` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduction: Option<Reduction>,
    /// `true`, for `cat` only: leaves the derivative of the gap by the coordinates out of their balance, as in (5.117) of the thesis. At the midpoint a
    /// slightly different scheme; momenta are exact all the same.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drop_gap_term: bool,
    /// `true`, for the second reduction of `cat` only: leaves the same derivative out of the linear equations, as in (4.70) of the thesis. The result is the
    /// same.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drop_gap_slope: bool,
    /// Pressures of `mortar`; `standard` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multipliers: Option<Multipliers>,
    /// Gauss points of `mortar`; `seven-point` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quadrature: Option<Quadrature>,
    /// Integrals of `mortar`; `moving` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integrals: Option<Integrals>,
    /// Energy that closing gaps cost, in `mortar` with schemes that take contact forces at the middle of the step; `keep` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closing: Option<Closing>,
    /// Of `mortar`, where a surface has sharp edges: how much more points that are near count than points that are far, in one over the length of a slave facet.
    /// With 0 gaps are plain means, and edges sink
    /// in by a quarter of a facet, with 12 by half of that. If left out 12 in statics and 0 in dynamics, where steps may fail with more if edges of both surfaces lie on
    /// each other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nearness: Option<f64>,
    /// What the method does not see: `method` (nothing acts there) or `general`, which switches `[general_contact]` on for the two bodies as well.
    #[serde(default, skip_serializing_if = "Edges::is_method")]
    pub edges: Edges,
    /// Friction; none if left out. Not with the modified constraint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<Friction>,
}

impl Edges {
    fn is_method(&self) -> bool {
        *self == Self::Method
    }
}

impl Contact {
    /// Slave and master, or the two surfaces of `between` as they are given.
    pub fn surfaces(&self) -> [&str; 2] {
        match &self.between {
            Some([a, b]) => [a, b],
            None => [&self.slave, &self.master].map(|set| set.as_deref().unwrap_or_default()),
        }
    }

    /// Key of each of them.
    pub fn surface_keys(&self) -> [&'static str; 2] {
        if self.between.is_some() { ["between[0]", "between[1]"] } else { ["slave", "master"] }
    }

    /// The given name, or both surfaces.
    pub fn label(&self) -> String {
        self.name.clone().unwrap_or_else(|| self.surfaces().join("/"))
    }
}

/// A function of time with one or more values: a constant, or `{ table = [[time, value, ...], ...] }`, linear in between and
/// constant before the first and after the last row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum Series {
    /// One constant value.
    Scalar(f64),
    /// Constant values.
    Vector(Vec<f64>),
    /// Rows of a table.
    Table(Table),
}

/// Rows `[time, value, ...]` with increasing times and equally many values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// The rows, at least one.
    pub table: Vec<Vec<f64>>,
}

impl Series {
    /// Rows `[time, value, ...]`; a constant is one row at time zero.
    pub fn rows(&self) -> Vec<Vec<f64>> {
        match self {
            Self::Scalar(value) => vec![vec![0.0, *value]],
            Self::Vector(values) => vec![std::iter::once(0.0).chain(values.iter().copied()).collect()],
            Self::Table(table) => table.table.clone(),
        }
    }

    /// Number of values.
    pub fn columns(&self) -> usize {
        match self {
            Self::Scalar(_) => 1,
            Self::Vector(values) => values.len(),
            Self::Table(table) => table.table.first().map_or(0, |row| row.len().saturating_sub(1)),
        }
    }
}

/// `[[prescribe]]`: displacement components of a set, given as functions of time, its displacement along a direction, or a rigid motion of the set. Exactly one of
/// `displacement`, `fixed = true` and `rotation`.
///
/// With `rigid` in place of `set` it is a rigid body that moves, all of it: where there is no `rotation` it does not turn, and components that are not
/// named do not move.
///
/// ```toml
/// [[prescribe]]
/// name = "stroke"
/// rigid = "punch"
/// components = ["z"]
/// displacement = { table = [[0.0, 0.0], [1.0, -0.1]] }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Prescribe {
    /// Unique name, by which an `[[event]]` releases it and a `[[stage]]` switches it off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Set of nodes, `part.set`; of a beam the places of its nodes are prescribed, not its directors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// Name of a rigid body, instead of a set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rigid: Option<String>,
    /// Components, each at most once. Not with a `rotation`, which prescribes all three, and not with a rigid body that is `fixed`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub components: Vec<Component>,
    /// Instead of `components`: a direction of any length but zero along which the nodes are held, or moved by `displacement`, while they slide freely across it. With
    /// `fixed = true` a plane of symmetry, or a sliding support, in any direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// Displacement from the reference position, one value a component, or the one along `normal`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Series>,
    /// `true`: the components, or the displacement along `normal`, are zero.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fixed: bool,
    /// Rotation of the set's reference positions, at any angle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<PrescribedRotation>,
    /// Translation that follows the rotation, three values; none if left out. With a `rotation` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translation: Option<Series>,
    /// Where a stage switches it on, the nodes begin where they are then, and are where `displacement` says from this time on: the difference falls linearly, and stays
    /// if it is `inf`. If left out they are there at the end of the first step. Of sets, along components or a normal that is an axis of space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ramp_until: Option<f64>,
}

impl Prescribe {
    /// Whether it is along a direction that is no axis of space.
    pub fn is_inclined(&self) -> bool {
        self.normal.is_some_and(|normal| normal.iter().filter(|&&n| n != 0.0).count() > 1)
    }

    /// The prescribed components: all three with a rotation, and of a rigid body that is fixed. They are the columns of [`Self::rows`]; the other
    /// components of a rigid body do not move.
    pub fn prescribed_components(&self) -> Vec<Component> {
        match &self.rotation {
            None if self.rigid.is_none() || !self.fixed => self.components.clone(),
            _ => vec![Component::X, Component::Y, Component::Z],
        }
    }

    /// Rows `[time, value, ...]` with one value a prescribed component, or one along the normal: of the displacement, or of the translation after a rotation.
    pub fn rows(&self) -> Vec<Vec<f64>> {
        match self.displacement.as_ref().or(self.translation.as_ref()) {
            Some(series) => series.rows(),
            None if self.normal.is_some() => vec![vec![0.0; 2]],
            None => vec![vec![0.0; 1 + self.prescribed_components().len()]],
        }
    }
}

/// Rotation of a set about an axis that is fixed in space but for the translation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PrescribedRotation {
    /// Direction of the axis, of any length but zero.
    pub axis: [f64; 3],
    /// Angle from the reference position in degrees, positive by the right-hand rule, one value; not limited to a turn.
    pub degrees: Series,
    /// A point of the axis; the origin if left out.
    #[serde(default)]
    pub about: [f64; 3],
}

named! {
    /// Kinds of loads.
    LoadKind {
        /// Dead pressure on facets, per reference area against the outward reference normal; one value.
        Pressure = "pressure",
        /// Dead traction on facets, per reference area; three values.
        Traction = "traction",
        /// Force per reference volume; three values.
        BodyForce = "body_force",
        /// Pressure against the current outward normal, per current area; one value.
        FollowerPressure = "follower_pressure",
        /// Force on each node; on the centre of mass of a rigid body; three values.
        Force = "force",
        /// Moment fixed in space on a rigid body, a node of a beam, or a set of a deformable body as a whole; three values.
        Moment = "moment",
        /// Acceleration of a whole body, a force per mass; three values.
        Acceleration = "acceleration",
        /// Force on a set of facets altogether, distributed over its nodes by their parts of the reference area; three values.
        TotalForce = "total_force",
        /// Centrifugal force of a whole body in a frame that turns about an axis; one value, the angular velocity.
        Centrifugal = "angular_velocity",
    }
}

impl LoadKind {
    /// Number of values: 1 for pressures, 3 for vectors.
    pub fn columns(self) -> usize {
        match self {
            Self::Pressure | Self::FollowerPressure | Self::Centrifugal => 1,
            Self::Traction | Self::BodyForce | Self::Force | Self::Moment | Self::Acceleration | Self::TotalForce => 3,
        }
    }
}

/// `[[load]]`: a load on a set, or a body force on a whole body. Exactly one of the kinds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Unique name, by which a `[[stage]]` switches it off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Set of facets (`pressure`, `traction`, `follower_pressure`, `total_force`), elements (`body_force`) or nodes (`force`), `body.set`. A `force` may also
    /// act on sets of beams and strings, and on `part.all` of a rigid body or point mass, a `moment` on `part.all` of a rigid body, on sets of beams, and on sets of deformable bodies
    /// as wholes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// Name of a body, instead of a set, for a `body_force`, an `acceleration` or an `angular_velocity` of all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Dead pressure (force per reference area), positive when it presses on the body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<Series>,
    /// Dead traction (force per reference area).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub traction: Option<Series>,
    /// Force per reference volume; gravity is density times its acceleration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body_force: Option<Series>,
    /// Pressure that follows the surface (force per current area), positive when it presses on the body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub follower_pressure: Option<Series>,
    /// Force on each node of the set; on a rigid body once, at its centre of mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<Series>,
    /// Moment whose direction is fixed in space, on a rigid body or on each node of a set of a beam; on a set of a deformable body once, as `coupling` says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moment: Option<Series>,
    /// How a set of a deformable body follows the point that the moment acts on; `distributing` if left out. With a `moment` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coupling: Option<Coupling>,
    /// Force per mass on a whole body with a density: what `[gravity]` is for all of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<Series>,
    /// Dead force on the whole set of facets: the traction `total_force / area` of the reference configuration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub total_force: Option<Series>,
    /// Angular velocity (1/time) of a frame in which the body is seen, about `axis`: the centrifugal force `density angular_velocity^2 r` at the present distance `r` from the axis,
    /// on a whole body with a density. Neither the force of Coriolis nor that of a changing angular velocity is added.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angular_velocity: Option<Series>,
    /// Direction of the axis, of any length but zero; with an `angular_velocity` only, and needed there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
    /// A point of the axis; the origin if left out. With an `angular_velocity` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<[f64; 3]>,
}

impl Load {
    /// How a set of a deformable body follows the point of a moment.
    pub fn coupling(&self) -> Coupling {
        self.coupling.unwrap_or(Coupling::Distributing)
    }

    /// Kind and value; `None` only in a load that was not read by [`crate::parse`].
    pub fn kind(&self) -> Option<(LoadKind, &Series)> {
        [
            (LoadKind::Pressure, &self.pressure),
            (LoadKind::Traction, &self.traction),
            (LoadKind::BodyForce, &self.body_force),
            (LoadKind::FollowerPressure, &self.follower_pressure),
            (LoadKind::Force, &self.force),
            (LoadKind::Moment, &self.moment),
            (LoadKind::Acceleration, &self.acceleration),
            (LoadKind::TotalForce, &self.total_force),
            (LoadKind::Centrifugal, &self.angular_velocity),
        ]
        .into_iter()
        .find_map(|(kind, series)| series.as_ref().map(|series| (kind, series)))
    }
}
