//! `[[contact]]`: slave and master, and how their contact is enforced.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::chosen::of_which;
use crate::contact_method::{ContactMethod, METHODS, MethodEntry};
use crate::names::named;
use crate::read::{Contradiction, Node, Table, Value, with_article};
use crate::spelling::known;
use crate::tie::Multipliers;
use crate::world::{World, contact_reference, is_line};
use crate::{Friction, Kind, Series, split_set};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;
use stoss_scene_derive::table;
use toml::de::DeValue;

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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
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
}

impl Enforcement {
    /// Names of the variants.
    pub const NAMES: &'static [&'static str] = &["multiplier", "penalty"];

    /// Name of the enforcement.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Multiplier => Self::NAMES[0],
            Self::Penalty(_) => Self::NAMES[1],
        }
    }

    pub(crate) fn is_multiplier(&self) -> bool {
        *self == Self::Multiplier
    }
}

/// `[[contact]]`: unilateral contact, with or without friction, of a slave surface with a master surface, of deformable or rigid bodies.
///
/// With `nts` the slave may also be a set of a beam or string (`rope.all`): its nodes are in contact from any side, and pressures are forces per length.
#[table(context(World<'_>), check = contact)]
#[cfg_attr(feature = "schema", schemars(transform = keys_of_methods))]
pub struct Contact {
    /// Unique name; `slave/master`, or the two surfaces of `between`, if left out.
    #[key(name)]
    pub name: Option<String>,
    /// Contact discretisation.
    #[key(example = "\"nts\"")]
    pub method: ContactMethod,
    /// Slave surface, `body.set`; with `nts` also a set of a beam or string.
    #[key(with = |node, world, keys| side(node, world, keys.method))]
    pub slave: Option<String>,
    /// Master surface, `body.set`, of another body.
    #[key(with = |node, world, keys| master(node, world, keys.method))]
    pub master: Option<String>,
    /// Two surfaces of different bodies, instead of `slave` and `master`. The slave is then the beam or string, otherwise the surface whose motion is not prescribed as a whole, otherwise the one that is not rigid,
    /// otherwise the one between whose nodes the other one, if it is round, sinks in less, otherwise the one with the finer mesh, otherwise the softer one.
    #[key(with = |node, world, keys| node.array(|node| side(node, world, keys.method)))]
    pub between: Option<[String; 2]>,
    /// Constraint of a closed contact, for `nts` and `cat`; `standard` if left out. With `mortar` the
    /// weighted gap of a closed node is always zero at the end of a step.
    pub constraint: Option<Constraint>,
    /// Enforcement of the normal constraint: `"multiplier"` or `{ penalty = stiffness }`, with the stiffness in pressure per length. `"multiplier"` if left out.
    #[key(default, skip)]
    pub enforcement: Enforcement,
    /// Unknowns that are eliminated, for `cat` only; `second` if left out.
    pub reduction: Option<Reduction>,
    /// Shape functions of the pressures, for `mortar` only; `standard` if left out.
    pub multipliers: Option<Multipliers>,
    /// Configuration of the mortar integrals, for `mortar` only; `moving` if left out.
    pub integrals: Option<Integrals>,
    /// Velocities after a step in which gaps closed: by the law of `impact`, or `keep`. If left out `impact` for `nts` and `mortar` by multipliers, `keep` for `cat`, penalties, the modified constraint,
    /// frozen integrals, and friction with a deformable body. Schemes other than `energy-momentum`, midpoint, trapezoidal and backward Euler keep the velocities of the step anyway.
    pub closing: Option<Closing>,
    /// Coefficient of restitution of the law of impact, from 0 (plastic) to 1. If left out the larger one of the two rigid bodies, and 0 if they have none. With a deformable body it says only what becomes of
    /// the energy of the nodes at the surface: 0 is right there.
    #[key(dimension = Number, restitution)]
    pub restitution: Option<f64>,
    /// Gap in the step in which a contact closes, for the law of impact: `auto`, `close` or `hold`; `auto` if left out.
    #[key(default, skip)]
    pub gap: GapAtClosing,
    /// Steps without a break after which a gap that was held comes down. 500 if left out.
    pub settle: Option<u32>,
    /// Mass of the slave surface, or of the master surface if the slave is rigid, of a deformable body: `consistent` or `none`; `consistent` if left out. `none` is for `nts` and `mortar` in
    /// dynamics with `energy-momentum`, `midpoint` and `backward-euler`. The contact has no law of impact then, and gaps are closed or held as with it.
    #[key(default, skip)]
    pub surface_mass: SurfaceMass,
    /// Treatment of contact that the method does not detect, such as edge against edge: `method` (none) or `general`, which switches `[general_contact]` on for the two bodies. `method` if left out.
    #[key(default, skip)]
    pub edges: Edges,
    /// What becomes of an overlap of the surfaces at the start of the run, or of the stage in which the contact begins to act: `sudden`, `ramp` or `keep`. If left out it is closed in the first step, in
    /// statics over the stage where that step fails.
    pub overlap: Option<OverlapAtStart>,
    /// Interference (a length, not negative): the surfaces are to stand apart by so much more than they do, as in a press fit of parts that fit exactly. A value, or a table of time.
    /// In statics; in dynamic stages that follow it has to stay constant.
    #[key(dimension = Length, read = interference)]
    pub interference: Option<Series>,
    /// Friction in the steps in which an overlap or an interference closes: `full`, `grows` or `none`; `full` if left out.
    pub closing_friction: Option<ClosingFriction>,
    /// Friction law with its parameters; frictionless if left out. Not with `constraint = "modified"`.
    #[key(with = |node, world, keys| Friction::of(node, keys.method, world))]
    pub friction: Option<Friction>,
    /// Velocity with which the master's surface moves along itself while its mesh stays: of a belt, fixed in space, three values or a table of them in time. Only its part along the surface has an effect. For `nts` and
    /// `mortar` with friction.
    #[key(dimension = Velocity, read = |node| Series::of(node, 3))]
    pub surface_velocity: Option<Series>,
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

impl<C> Value<C> for Enforcement {
    fn read(node: &Node<'_>, _: &C) -> Option<Self> {
        let example = "write \"multiplier\" or { penalty = 1e5 }";
        match node.value {
            DeValue::Table(_) => {
                let table = node.table()?;
                let penalty = table.required("penalty", "penalty = 1e5", Node::positive);
                table.finish();
                penalty.map(Self::Penalty)
            }
            DeValue::String(_) => match node.text()?.as_str() {
                "multiplier" => Some(Self::Multiplier),
                "penalty" => node.fail("needs a stiffness, a traction per length", example),
                other => node.fail("is not known", known(other, Self::NAMES.iter().copied())),
            },
            _ => {
                node.fail(format!("must be a word or a table, found {}", with_article(node.value.type_str())), example)
            }
        }
    }
}

/// A side of a contact by a method, if that is known.
fn side(node: &Node<'_>, world: &World<'_>, method: Option<ContactMethod>) -> Option<String> {
    let reference = contact_reference(node, world)?;
    match method {
        Some(method) if !method.takes_lines && is_line(&reference, world) => node.fail(
            format!("`{method}` is for surfaces, and a beam or string has no facets"),
            format!("set `method` to one of {}", of_which::<MethodEntry>(|method| method.takes_lines)),
        ),
        _ => Some(reference),
    }
}

fn master(node: &Node<'_>, world: &World<'_>, method: Option<ContactMethod>) -> Option<String> {
    let reference = side(node, world, method)?;
    if is_line(&reference, world) {
        let message = "a beam or string has no facets and can only be the slave, and two of them have no contact";
        return node.fail(message, "choose a surface as the master");
    }
    Some(reference)
}

fn interference(node: &Node<'_>) -> Option<Series> {
    let given = Series::of(node, 1)?;
    if given.rows().iter().any(|row| row[1] < 0.0) {
        return node
            .fail("is negative: surfaces cannot be pushed together", "give a clearance by the places of the bodies");
    }
    Some(given)
}

fn contact(keys: &ContactKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    let sides = sides(keys, table, world);
    let of_method = of_method(keys.method, table);
    let fits = table.refuse(&contradictions(keys, table, world));
    sides.and(of_method).and(fits)
}

/// Reports keys that not every method has.
fn of_method(method: Option<ContactMethod>, table: &Table<'_>) -> Option<()> {
    let method = method?;
    let mut fits = Some(());
    let all = METHODS.iter().flat_map(|method| method.keys);
    let of_some = all.filter(|key| !method.has(key) && table.has(key) && table.asks(key));
    for &key in std::collections::BTreeSet::from_iter(of_some) {
        fits = table.fail(key, method.lacks(key), "remove it, or choose another `method`");
    }
    fits
}

/// Refuses keys that a method does not have in the schema, too.
#[cfg(feature = "schema")]
fn keys_of_methods(schema: &mut schemars::Schema) {
    let keys = schema.get("properties").and_then(serde_json::Value::as_object).cloned().unwrap_or_default();
    let all = METHODS.iter().flat_map(|method| method.keys).filter(|key| keys.contains_key(**key));
    let refused = METHODS.iter().map(|method| {
        let without = all.clone().filter(|key| !method.has(key)).map(|key| ((*key).to_owned(), false.into()));
        let without: serde_json::Map<_, serde_json::Value> = without.collect();
        serde_json::json!({ "if": { "properties": { "method": { "const": method.name } } }, "then": { "properties": without } })
    });
    schema.insert("allOf".to_owned(), refused.collect());
}

/// Reports sides that are missing, given twice, or not two bodies.
fn sides(keys: &ContactKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    let mut named = Some(());
    for (key, example) in [("slave", "slave = \"ball.outer\""), ("master", "master = \"plate.top\"")] {
        match (table.has("between"), table.has(key)) {
            (true, true) => {
                let message = "is not needed: `between` determines slave and master";
                named = table.fail(key, message, "remove one of the two keys");
            }
            (false, false) => named = table.missing(key, example),
            _ => {}
        }
    }
    let between = keys.between.as_ref().and_then(Option::as_ref);
    let given = [&keys.slave, &keys.master].map(|side| side.as_ref().and_then(Option::as_ref));
    let both = between.map(|[a, b]| (a, b)).or(given[0].zip(given[1]));
    if let Some((a, b)) = both
        && let (Some((a, _)), Some((b, _))) = (split_set(a), split_set(b))
        && a == b
    {
        return table.fail(
            if between.is_some() { "between" } else { "master" },
            format!("slave and master belong to the same body `{a}`"),
            "choose the surface of another body; contact of a body with itself is part of [general_contact]",
        );
    }
    if between.is_some_and(|sides| sides.iter().all(|side| is_line(side, world))) {
        return table.fail("between", "both are beams or strings, which have no facets", "name a surface on one side");
    }
    named
}

/// What keys say against each other; of each key the first one counts.
fn contradictions(keys: &ContactKeys, table: &Table<'_>, world: &World<'_>) -> Vec<Contradiction> {
    const REMOVE: &str = "remove it";
    let is_static = world.kind == Some(Kind::QuasiStatic);
    let given = |key| table.has(key);
    let modified = keys.constraint == Some(Some(Constraint::Modified));
    let is_penalty = matches!(keys.enforcement, Some(Enforcement::Penalty(_)));
    let is_multiplier = keys.enforcement.is_none_or(|enforcement| enforcement.is_multiplier());
    let frozen = keys.integrals == Some(Some(Integrals::Frozen));
    let massless = keys.surface_mass == Some(SurfaceMass::None);
    let no_friction = keys.friction == Some(None);
    let method = keys.method;
    let without_impact = method.is_some_and(|method| !method.has_impact);
    let has_enforcement =
        |method: ContactMethod| keys.enforcement.is_none_or(|e| method.enforcements.contains(&e.name()));
    let keeps = modified
        || is_penalty
        || frozen
        || keys.closing == Some(Some(Closing::Keep)) && !massless
        || without_impact && keys.closing == Some(None);
    let in_time = matches!(keys.overlap, Some(Some(OverlapAtStart::Ramp)))
        || keys.interference.iter().flatten().any(|series| series.rows().len() > 1);
    let grows = keys.closing_friction == Some(Some(ClosingFriction::Grows));
    let general = keys.edges == Some(Edges::General);
    let sides =
        [&keys.slave, &keys.master].into_iter().flatten().flatten().chain(keys.between.iter().flatten().flatten());
    let has_line = sides.into_iter().any(|set| is_line(set, world));
    let mut list = vec![
        ("constraint", modified && is_static, "is for dynamic scenes only", "use \"standard\", which closes the gap"),
        (
            "enforcement",
            !is_multiplier && !method.is_none_or(has_enforcement),
            "is not for this method, which has pressures as multipliers",
            REMOVE,
        ),
        (
            "enforcement",
            is_penalty && modified,
            "a penalty needs the standard constraint",
            "remove `constraint`, or set it to \"standard\"",
        ),
        ("friction", modified, "cannot be combined with the modified constraint", "set `constraint` to \"standard\""),
        (
            "surface_velocity",
            no_friction,
            "has no effect without friction",
            "give the contact a `friction`, or remove it",
        ),
        (
            "surface_velocity",
            given("between"),
            "needs to be told which surface moves: it is that of the master",
            "write `slave` and `master` instead of `between`",
        ),
        ("surface_mass", massless && is_static, "is for dynamic scenes only", REMOVE),
        (
            "surface_mass",
            massless && given("between"),
            "needs to be told which surface has no mass: it is that of the slave, if it is deformable",
            "write `slave` and `master` instead of `between`",
        ),
    ];
    let impact = keys.closing == Some(Some(Closing::Impact));
    list.extend([
        ("closing", impact && massless, "is not for a surface without mass, which has no impact", REMOVE),
        (
            "closing",
            impact && (modified || is_penalty || frozen),
            "is for exact contact: not for a penalty, the modified constraint, or frozen integrals",
            REMOVE,
        ),
    ]);
    for key in ["restitution", "gap", "settle"] {
        let message = "is a number of the law of impact, and this contact keeps the velocities of the step";
        list.extend([(key, is_static, "is for dynamic scenes only", REMOVE), (key, keeps, message, REMOVE)]);
    }
    list.extend([
        ("restitution", massless, "is a number of the law of impact, and a surface without mass has no impact", REMOVE),
        ("gap", keys.gap == Some(GapAtClosing::Hold) && without_impact, "is not for a method that closes gaps", REMOVE),
        (
            "settle",
            keys.gap == Some(GapAtClosing::Close),
            "says how a gap that is held comes down, and `gap = \"close\"` holds none",
            "remove one of them",
        ),
    ]);
    for key in ["overlap", "interference"] {
        list.extend([
            (key, modified, "cannot be combined with the modified constraint, which keeps what gap there is", REMOVE),
            (key, frozen, "cannot be combined with frozen integrals, which have no gap of the end of a step", REMOVE),
        ]);
    }
    list.extend([
        ("closing_friction", no_friction, "says when friction acts, and this contact has none", REMOVE),
        (
            "closing_friction",
            grows && !in_time,
            "is in proportion to time, and what closes does so in the first step",
            "write overlap = \"ramp\", or the interference as a table",
        ),
        ("edges", general && has_line, "needs facets on both sides: beams and strings have none", REMOVE),
        (
            "edges",
            general && given("surface_velocity"),
            "is not for a contact with `surface_velocity`: general contact takes surfaces as their nodes move",
            "remove one of the two",
        ),
    ]);
    list
}
