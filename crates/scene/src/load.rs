//! `[[load]]`: pressures, tractions, forces, moments.

use crate::coupling::Coupling;
use crate::names::named;
use crate::read::Table;
use crate::spelling::known;
use crate::world::{KnownPart, World, action_name, meshed_part, set_reference};
use crate::{PartKind, Series, split_set};
use stoss_scene_derive::table;

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
#[table(context(World<'_>), check = load)]
pub struct Load {
    /// Unique name, with which a `[[stage]]` switches it off.
    #[key(read = action_name)]
    pub name: Option<String>,
    /// Set `body.set` of facets (`pressure`, `traction`, `follower_pressure`, `total_force`), nodes (`force`), or `body.all` (`body_force`). A `force` may also
    /// act on sets of beams and strings, and on `part.all` of a rigid body or point mass; a `moment` acts on `part.all` of a rigid body, on sets of beams, and on whole sets of deformable
    /// bodies.
    #[key(by = set_reference)]
    pub set: Option<String>,
    /// Name of a body, instead of a set, for a `body_force`, an `acceleration` or an `angular_velocity` of the whole body.
    #[key(by = |node, world| meshed_part(node, world, false))]
    pub body: Option<String>,
    /// Dead pressure (force per reference area), positive in compression.
    #[key(dimension = Stress, read = |node| Series::of(node, 1))]
    pub pressure: Option<Series>,
    /// Dead traction (force per reference area), three values.
    #[key(dimension = Stress, read = |node| Series::of(node, 3))]
    pub traction: Option<Series>,
    /// Dead body force (force per reference volume), three values.
    #[key(dimension = ForcePerVolume, read = |node| Series::of(node, 3))]
    pub body_force: Option<Series>,
    /// Follower pressure (force per current area), positive in compression.
    #[key(dimension = Stress, read = |node| Series::of(node, 1))]
    pub follower_pressure: Option<Series>,
    /// Dead force on each node of the set (three values); on a rigid body one force at its centre of mass.
    #[key(dimension = Force, read = |node| Series::of(node, 3))]
    pub force: Option<Series>,
    /// Moment (three values) with a direction fixed in space, on a rigid body or on each node of a set of a beam; on a set of a deformable body one moment, transferred by the `coupling`.
    #[key(dimension = Moment, read = |node| Series::of(node, 3))]
    pub moment: Option<Series>,
    /// Coupling of a set of a deformable body to the point on which the moment acts; `distributing` if left out. With a `moment` only.
    pub coupling: Option<Coupling>,
    /// Force per mass (three values) on a whole body with a density, as `[gravity]` is for all bodies.
    #[key(dimension = Acceleration, read = |node| Series::of(node, 3))]
    pub acceleration: Option<Series>,
    /// Resultant dead force (three values) on the set of facets: the uniform traction `total_force / area` on its reference area.
    #[key(dimension = Force, read = |node| Series::of(node, 3))]
    pub total_force: Option<Series>,
    /// Angular velocity (radians per time) of the rotating frame of reference about `axis`: the centrifugal force `density angular_velocity^2 r` at the current distance `r` from the axis,
    /// on a whole body with a density. Coriolis and Euler forces are not added.
    #[key(dimension = AngularVelocity, read = |node| Series::of(node, 1))]
    pub angular_velocity: Option<Series>,
    /// Direction of the axis, of any length but zero; required with an `angular_velocity`, not allowed otherwise.
    #[key(dimension = Number, direction)]
    pub axis: Option<[f64; 3]>,
    /// A point on the axis; the origin if left out. With an `angular_velocity` only.
    #[key(dimension = Length)]
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

fn load(keys: &LoadKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    let turns = table.has("angular_velocity");
    let mut axis = Some(());
    for key in ["axis", "about"].into_iter().filter(|&key| !turns && table.has(key)) {
        axis = table.fail(key, "is for an `angular_velocity`", "remove it");
    }
    if turns && !table.has("axis") {
        axis = table.missing("axis", "axis = [0, 0, 1]");
    }
    let given: Vec<&'static str> = LoadKind::NAMES.iter().copied().filter(|key| table.has(key)).collect();
    let one_kind = match given.as_slice() {
        [_] => Some(()),
        [] => {
            let list = known("", LoadKind::NAMES.iter().copied());
            let remedy = format!("add `pressure = 1.0` or another kind; {list}");
            table.fail("pressure", "a load needs one kind of load", remedy)
        }
        [first, second, ..] => {
            table.fail(second, format!("`{first}` is given too"), "write a [[load]] of its own for each kind")
        }
    };
    let set = keys.set.as_ref().and_then(Option::as_deref).and_then(split_set);
    let part = set.and_then(|(part, set)| Some((world.part(part)?, set)));
    let fits = part.map_or(Some(()), |(part, set)| fits(table, part, set));
    let whole = ["acceleration", "angular_velocity"].into_iter().find(|key| table.has(key));
    let target = match (table.has("set"), table.has("body"), whole) {
        (true, true, _) => table.fail("body", "a load has either a set or a body", "remove one of them"),
        (false, false, _) => table.missing("set", "set = \"plate.bottom\""),
        (true, false, Some(kind)) => {
            let message = format!("an `{kind}` acts on a whole body");
            table.fail("set", message, "write `body` with the name of a body instead")
        }
        (false, true, None) if !table.has("body_force") => table.fail(
            "body",
            "only a `body_force`, an `acceleration` or an `angular_velocity` acts on a whole body",
            "name a set, for instance `set = \"plate.bottom\"`",
        ),
        _ => Some(()),
    };
    if table.has("coupling") && !table.has(LoadKind::Moment.name()) {
        return table.fail("coupling", "is for moments on sets of deformable bodies", "remove it");
    }
    axis.and(one_kind).and(fits).and(target)
}

/// Reports a load that the part of its set cannot carry: pressures, tractions and body forces act on deformable bodies, forces and moments also on other parts.
fn fits(table: &Table<'_>, part: &KnownPart, set: &str) -> Option<()> {
    let (name, noun) = (&part.name, part.kind.noun());
    let is_body = part.kind == PartKind::Body;
    let everywhere = [LoadKind::Force, LoadKind::Moment].map(LoadKind::name);
    let of_bodies = LoadKind::NAMES.iter().find(|&&key| table.has(key) && !everywhere.contains(&key));
    let has_moment = table.has(LoadKind::Moment.name());
    let fits = match of_bodies {
        Some(kind) if !is_body => {
            let message = format!("`{name}` is {noun}: a `{kind}` acts on deformable bodies");
            table.fail("set", message, "write `force`, or [gravity] for weight")
        }
        _ if part.kind == PartKind::Rigid && set != "all" => table.fail(
            "set",
            format!("`{name}` is {noun}, on which forces and moments act as a whole"),
            format!("write \"{name}.all\"; a force acts at its centre of mass"),
        ),
        _ if has_moment && matches!(part.kind, PartKind::Mass | PartKind::String) => table.fail(
            "set",
            format!("`{name}` is {noun}, which has no orientation for a moment"),
            "name a rigid body, a beam or a deformable body",
        ),
        _ => Some(()),
    };
    if table.has("coupling") && has_moment && !is_body {
        let message = format!("is for sets of deformable bodies, and the load acts on {noun}");
        return table.fail("coupling", message, "remove it");
    }
    fits
}
