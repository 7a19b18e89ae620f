//! Sets, contact, prescribed displacements, loads, and functions of time.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::Friction;
use crate::contact_method::ContactMethod;
use crate::coupling::Coupling;
use crate::names::named;
use crate::tie::Multipliers;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// Treatment of contact that the method does not detect: edge against edge, beyond the rim of a surface, on sides that are not part of slave or master.
    #[derive(Default)]
    Edges {
        /// None: only the method of the contact acts.
        #[default]
        Method = "method",
        /// General contact between surfaces half a thickness inside the bodies, so that it does not act while the method keeps the gaps.
        General = "general",
    }
}

named! {
    /// Unknowns of coordinate augmentation that are eliminated (theory/coordinate-augmentation#full). The result does not depend on it.
    Reduction {
        /// None: pressure, two convective coordinates and two multipliers remain for each slave node.
        None = "none",
        /// The multipliers are eliminated.
        First = "first",
        /// Multipliers and coordinates are eliminated: the system has the size of the direct form.
        Second = "second",
    }
}

named! {
    /// Gauss rule for the triangles of the mortar integrals.
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
    /// Velocities after a step in which gaps closed.
    Closing {
        /// Those after an impact, by the law of impact with `restitution` (theory/impacts): they do not depend on where in the step a gap closes.
        Impact = "impact",
        /// Those of the step: what closing gaps cost or give depends on where in the step they close.
        Keep = "keep",
    }
}

named! {
    /// Gap of a contact in the step in which it closes, with `closing = "impact"`.
    #[derive(Default)]
    GapAtClosing {
        /// Held if a side is a deformable body through which a wave passes no more than 12 elements in a step, else closed.
        #[default]
        Auto = "auto",
        /// Closed by the end of the step: exact for rigid bodies. In a mesh the node is dragged over the gap against its neighbours.
        Close = "close",
        /// Held where it is at the start of the step, at most the way of one step, and settled after `settle` steps.
        Hold = "hold",
    }
}

named! {
    /// Mass of a contact surface.
    #[derive(Default)]
    SurfaceMass {
        /// That of the elements: nodes that close lose their kinetic energy.
        #[default]
        Consistent = "consistent",
        /// None: in the kinetic energy the nodes of the surface move with those behind them, and nothing is lost when they close (theory/impacts#massless). Densities of the body's elements are changed a
        /// little, so that its mass, centre and inertia are exact.
        None = "none",
    }
}

named! {
    /// Configuration of the mortar integrals in the weighted gaps.
    Integrals {
        /// Integrals at the current positions: the weighted gap is a function of the positions alone.
        Moving = "moving",
        /// Integrals at the predicted middle of the step, constant during the step, as in the thesis: for comparison, with schemes that take contact forces at the
        /// middle of the step. Sliding over facets then gains or loses energy.
        Frozen = "frozen",
    }
}

named! {
    /// Constraint of a closed contact (theory/constraints#eq-modified).
    Constraint {
        /// The gap is zero at the end of a step. Energy is lost or gained in a step in which a node closes.
        Standard = "standard",
        /// The gap keeps the value that it has at the start of the step: conserves energy, but nodes keep the gap, or penetration, with which they closed. Frictionless
        /// dynamics only.
        Modified = "modified",
    }
}

named! {
    /// What becomes of an overlap of the surfaces where their contact begins to act.
    OverlapAtStart {
        /// It is closed in the first step.
        Sudden = "sudden",
        /// It is closed in proportion to time, until the end of the stage in which the contact begins to act. In statics.
        Ramp = "ramp",
        /// It stays, without stress: surfaces that overlap count as just touching. For small sliding, because every slave node keeps the overlap that it had.
        Keep = "keep",
    }
}

named! {
    /// Friction in the steps in which an overlap or an interference closes.
    ClosingFriction {
        /// As ever.
        Full = "full",
        /// Its bound grows from zero in proportion to time; with `overlap = "ramp"` or an `interference` that is a table.
        Grows = "grows",
        /// None: what closes ends without tangential tractions, as parts do that shrink onto each other.
        None = "none",
    }
}

/// Enforcement of the normal constraint. Stiffnesses are pressures per length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Enforcement {
    /// Exactly, by Lagrange multipliers: the pressures are unknowns.
    #[default]
    Multiplier,
    /// Penalty method: springs of this stiffness against penetration.
    Penalty(
        /// Stiffness, positive.
        #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::StressPerLength)))]
        f64,
    ),
    /// Exactly, by an augmented Lagrangian: several solutions in each step, fewer with a larger stiffness.
    Augmented(
        /// Stiffness, positive. It affects the number of solutions, not the result.
        #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::StressPerLength)))]
        f64,
    ),
}

impl Enforcement {
    /// Names of the variants.
    pub const NAMES: &'static [&'static str] = &["multiplier", "penalty", "augmented"];

    /// Name of the enforcement.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Multiplier => Self::NAMES[0],
            Self::Penalty(_) => Self::NAMES[1],
            Self::Augmented(_) => Self::NAMES[2],
        }
    }

    pub(crate) fn is_multiplier(&self) -> bool {
        *self == Self::Multiplier
    }
}

named! {
    /// Cartesian component.
    Component {
        /// Along x.
        X = "x",
        /// Along y.
        Y = "y",
        /// Along z.
        Z = "z",
    }
}

impl Component {
    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// `[[set]]`: nodes, facets and elements of a body, or of a rigid body with a surface, inside a box or on a plane, in the reference configuration after placement.
/// Exactly one of `box` and `plane`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SetDefinition {
    /// Name of the set, written `body.name`; unique.
    pub name: String,
    /// Name of the body, or of the rigid body with a surface.
    pub body: String,
    /// An axis-parallel box that contains the set, its boundary included.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub inside: Option<BoxRegion>,
    /// A plane on which the set lies, within a tolerance.
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
    /// Smallest coordinates (a length each); `-inf` is allowed.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub min: [f64; 3],
    /// Largest coordinates (a length each), not below `min`; `inf` is allowed.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub max: [f64; 3],
}

/// A plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PlaneRegion {
    /// A point on the plane.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub point: [f64; 3],
    /// Normal of the plane, of any length but zero.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub normal: [f64; 3],
    /// Largest distance of a node from the plane (length), positive; a millionth of the size of the body if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub tolerance: Option<f64>,
}

/// `[[contact]]`: unilateral contact, with or without friction, of a slave surface with a master surface, of deformable or rigid bodies.
///
/// With `nts` the slave may also be a set of a beam or string (`rope.all`): its nodes are in contact from any side, and pressures are forces per length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Unique name; `slave/master`, or the two surfaces of `between`, if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Contact discretisation.
    pub method: ContactMethod,
    /// Slave surface, `body.set`; with `nts` also a set of a beam or string.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slave: Option<String>,
    /// Master surface, `body.set`, of another body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub master: Option<String>,
    /// Two surfaces of different bodies, instead of `slave` and `master`. The slave is then the beam or string, otherwise the surface whose motion is not prescribed as a whole, otherwise the one that is not rigid,
    /// otherwise the one between whose nodes the other one, if it is round, sinks in less, otherwise the one with the finer mesh, otherwise the softer one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub between: Option<[String; 2]>,
    /// Constraint of a closed contact, for `nts` and `cat`; `standard` if left out. With `mortar` the
    /// weighted gap of a closed node is always zero at the end of a step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constraint: Option<Constraint>,
    /// Enforcement of the normal constraint: `"multiplier"`, `{ penalty = stiffness }` or `{ augmented = stiffness }`, with the stiffness in pressure per length. `"multiplier"` if left out.
    #[serde(default, skip_serializing_if = "Enforcement::is_multiplier")]
    pub enforcement: Enforcement,
    /// Unknowns that are eliminated, for `cat` only; `second` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduction: Option<Reduction>,
    /// `true`: omits the derivative of the gap with respect to the convective coordinates from their equilibrium equation, as in (5.117) of the thesis. At the midpoint this is a
    /// slightly different scheme; momenta are still exact. For `cat` only; `false` if left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drop_gap_term: bool,
    /// `true`: omits the same derivative from the tangent only, as in (4.70) of the thesis. The result is the
    /// same. For `cat` with `reduction = "second"` only; `false` if left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drop_gap_slope: bool,
    /// Shape functions of the pressures, for `mortar` only; `standard` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multipliers: Option<Multipliers>,
    /// Gauss rule of the mortar integrals, for `mortar` only; `seven-point` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quadrature: Option<Quadrature>,
    /// Configuration of the mortar integrals, for `mortar` only; `moving` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integrals: Option<Integrals>,
    /// Velocities after a step in which gaps closed: by the law of `impact`, or `keep`. If left out `impact` for `nts` and `mortar` by multipliers, `keep` for `cat`, penalties, the modified constraint,
    /// frozen integrals, and friction with a deformable body. Schemes other than `energy-momentum`, midpoint, trapezoidal and backward Euler keep the velocities of the step anyway.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closing: Option<Closing>,
    /// Coefficient of restitution of the law of impact, from 0 (plastic) to 1. If left out the larger one of the two rigid bodies, and 0 if they have none. With a deformable body it says only what becomes of
    /// the energy of the nodes at the surface: 0 is right there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub restitution: Option<f64>,
    /// Gap in the step in which a contact closes, for the law of impact: `auto`, `close` or `hold`; `auto` if left out.
    #[serde(default, skip_serializing_if = "GapAtClosing::is_auto")]
    pub gap: GapAtClosing,
    /// Steps without a break after which a gap that was held comes down. 500 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle: Option<u32>,
    /// Mass of the slave surface, or of the master surface if the slave is rigid, of a deformable body: `consistent` or `none`; `consistent` if left out. `none` is for `nts` and `mortar` in
    /// dynamics with `energy-momentum`, `midpoint` and `backward-euler`. The contact has no law of impact then, and gaps are closed or held as with it.
    #[serde(default, skip_serializing_if = "SurfaceMass::is_consistent")]
    pub surface_mass: SurfaceMass,
    /// Weighting of near points over far points in the weighted gap at sharp edges, not negative, times one over the length of a slave facet; for `mortar` only.
    /// With 0 the gap is a plain mean, and edges penetrate
    /// by a quarter of a facet; with 12 by half of that. If left out 12 in statics and 0 in dynamics, where steps may fail with larger values if edges of both surfaces
    /// coincide.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub nearness: Option<f64>,
    /// Treatment of contact that the method does not detect, such as edge against edge: `method` (none) or `general`, which switches `[general_contact]` on for the two bodies. `method` if left out.
    #[serde(default, skip_serializing_if = "Edges::is_method")]
    pub edges: Edges,
    /// What becomes of an overlap of the surfaces at the start of the run, or of the stage in which the contact begins to act: `sudden`, `ramp` or `keep`. If left out it is closed in the first step, in
    /// statics over the stage where that step fails.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overlap: Option<OverlapAtStart>,
    /// Interference (a length, not negative): the surfaces are to stand apart by so much more than they do, as in a press fit of parts that fit exactly. A value, or a table of time.
    /// In statics; in dynamic stages that follow it has to stay constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub interference: Option<Series>,
    /// Friction in the steps in which an overlap or an interference closes: `full`, `grows` or `none`; `full` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closing_friction: Option<ClosingFriction>,
    /// Friction law with its parameters; frictionless if left out. Not with `constraint = "modified"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<Friction>,
    /// Velocity with which the master's surface moves along itself while its mesh stays: of a belt, fixed in space, three values or a table of them in time. Only its part along the surface has an effect. For `nts` and
    /// `mortar` with friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Velocity)))]
    pub surface_velocity: Option<Series>,
}

impl GapAtClosing {
    fn is_auto(&self) -> bool {
        *self == Self::Auto
    }
}

impl SurfaceMass {
    fn is_consistent(&self) -> bool {
        *self == Self::Consistent
    }
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
    /// A constant value.
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
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = "time, then as the key")))]
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

/// `[[prescribe]]`: prescribed displacement components of a set as functions of time, its displacement along a direction, or a rigid motion of the set. Exactly one of
/// `displacement`, `fixed = true` and `rotation`.
///
/// With `rigid` instead of `set` the whole motion of a rigid body is prescribed: without a `rotation` it does not rotate, and components that are not
/// named are fixed.
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
    /// Unique name, with which an `[[event]]` releases it and a `[[stage]]` switches it off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Set of nodes, `part.set`. Of a beam the positions of its nodes are prescribed, not its directors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// Name of a rigid body, instead of a set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rigid: Option<String>,
    /// Prescribed components `x`, `y`, `z`, each at most once. Not with a `rotation`, which prescribes all three, nor with a rigid body that is `fixed`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub components: Vec<Component>,
    /// Instead of `components`: a direction of any length but zero along which the displacement is prescribed, while the nodes slide freely in the plane normal to it. With
    /// `fixed = true` this is a symmetry plane, or a sliding support, in any direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub normal: Option<[f64; 3]>,
    /// Displacement from the reference position (a length each): one value for each component, or one value along `normal`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub displacement: Option<Series>,
    /// `true`: the displacement of the components, or along `normal`, is zero. `false` if left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fixed: bool,
    /// Rotation of the reference positions of the set, by any angle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<PrescribedRotation>,
    /// Translation after the rotation (three lengths); none if left out. With a `rotation` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub translation: Option<Series>,
    /// Where a stage switches it on, the nodes begin where they are then, and are where `displacement` says from this time on: the difference falls linearly, and stays
    /// if it is `inf`. If left out they are there at the end of the first step. Of sets, along components or a normal that is an axis of space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Time)))]
    pub ramp_until: Option<f64>,
}

impl Prescribe {
    /// A set that is held, along no component yet.
    pub fn fixed(set: String) -> Self {
        Self {
            name: None,
            set: Some(set),
            rigid: None,
            components: Vec::new(),
            normal: None,
            displacement: None,
            fixed: true,
            rotation: None,
            translation: None,
            ramp_until: None,
        }
    }

    /// Whether it is along a `normal` that is not a coordinate axis.
    pub fn is_inclined(&self) -> bool {
        self.normal.is_some_and(|normal| normal.iter().filter(|&&n| n != 0.0).count() > 1)
    }

    /// The prescribed components: all three with a rotation, and of a rigid body that is fixed. They are the columns of [`Self::rows`]; the other
    /// components of a rigid body are fixed.
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

/// Rotation of a set about an axis that moves only with the translation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PrescribedRotation {
    /// Direction of the axis, of any length but zero.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub axis: [f64; 3],
    /// Angle from the reference position in degrees, positive by the right-hand rule; may exceed 360.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Angle)))]
    pub degrees: Series,
    /// A point on the axis; the origin if left out.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub about: [f64; 3],
}

named! {
    /// Kinds of loads.
    LoadKind {
        /// Dead pressure on facets: a force per reference area along the inward reference normal; one value.
        Pressure = "pressure",
        /// Dead traction on facets, per reference area; three values.
        Traction = "traction",
        /// Force per reference volume; three values.
        BodyForce = "body_force",
        /// Follower pressure on facets: a force per current area along the current inward normal; one value.
        FollowerPressure = "follower_pressure",
        /// Force on each node, or on the centre of mass of a rigid body; three values.
        Force = "force",
        /// Moment with a direction fixed in space, on a rigid body, a node of a beam, or a set of a deformable body as a whole; three values.
        Moment = "moment",
        /// Force per mass on a whole body; three values.
        Acceleration = "acceleration",
        /// Resultant force on a set of facets, distributed as a uniform traction over the reference area; three values.
        TotalForce = "total_force",
        /// Centrifugal force on a whole body in a rotating frame; one value, the angular velocity.
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

/// `[[load]]`: a load on a set, or a body force on a whole body. Exactly one kind of load in each table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Unique name, with which a `[[stage]]` switches it off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Set `body.set` of facets (`pressure`, `traction`, `follower_pressure`, `total_force`), nodes (`force`), or `body.all` (`body_force`). A `force` may also
    /// act on sets of beams and strings, and on `part.all` of a rigid body or point mass; a `moment` acts on `part.all` of a rigid body, on sets of beams, and on whole sets of deformable
    /// bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// Name of a body, instead of a set, for a `body_force`, an `acceleration` or an `angular_velocity` of the whole body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Dead pressure (force per reference area), positive in compression.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub pressure: Option<Series>,
    /// Dead traction (force per reference area), three values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub traction: Option<Series>,
    /// Dead body force (force per reference volume), three values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::ForcePerVolume)))]
    pub body_force: Option<Series>,
    /// Follower pressure (force per current area), positive in compression.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Stress)))]
    pub follower_pressure: Option<Series>,
    /// Dead force on each node of the set (three values); on a rigid body one force at its centre of mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Force)))]
    pub force: Option<Series>,
    /// Moment (three values) with a direction fixed in space, on a rigid body or on each node of a set of a beam; on a set of a deformable body one moment, transferred by the `coupling`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Moment)))]
    pub moment: Option<Series>,
    /// Coupling of a set of a deformable body to the point on which the moment acts; `distributing` if left out. With a `moment` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coupling: Option<Coupling>,
    /// Force per mass (three values) on a whole body with a density, as `[gravity]` is for all bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Acceleration)))]
    pub acceleration: Option<Series>,
    /// Resultant dead force (three values) on the set of facets: the uniform traction `total_force / area` on its reference area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Force)))]
    pub total_force: Option<Series>,
    /// Angular velocity (radians per time) of the rotating frame of reference about `axis`: the centrifugal force `density angular_velocity^2 r` at the current distance `r` from the axis,
    /// on a whole body with a density. Coriolis and Euler forces are not added.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::AngularVelocity)))]
    pub angular_velocity: Option<Series>,
    /// Direction of the axis, of any length but zero; required with an `angular_velocity`, not allowed otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Number)))]
    pub axis: Option<[f64; 3]>,
    /// A point on the axis; the origin if left out. With an `angular_velocity` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub about: Option<[f64; 3]>,
}

impl Load {
    /// Coupling of a set of a deformable body to the point of a moment, with its default.
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
