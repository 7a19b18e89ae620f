//! The table `[general_contact]`.

#[cfg(feature = "schema")]
use crate::Dimension;
#[cfg(feature = "schema")]
use crate::catalogue;
use crate::names::named;
use crate::read::{Node, Table, Value, is_name};
use crate::world::{World, part_name, surface_reference};
use crate::{Friction, Integrator};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
#[cfg(feature = "schema")]
use std::borrow::Cow;
#[cfg(feature = "schema")]
use stoss_contact::friction::LAWS;
use stoss_scene_derive::table;

named! {
    /// Treatment of bodies that penetrate each other at the start: `refuse` if left out.
    #[derive(Default)]
    Initial {
        /// The scene is refused with an error.
        #[default]
        Refuse = "refuse",
        /// Bodies that are free to move are moved apart before the start, without stress.
        Separate = "separate",
    }
}

/// `[general_contact]`: contact of all surfaces with each other by a barrier, without slave and master. It is on by default where several parts have surfaces, no `[[contact]]` is defined, and
/// the scheme supports it. Pairs of facets that belong to a `[[contact]]` or a `[[tie]]`, and pairs of parts that are connected by a joint, are excluded.
#[table(context(World<'_>), check = general_contact)]
pub struct GeneralContact {
    /// `false` switches general contact off; `true` if left out.
    #[key(default = true, skip)]
    pub enabled: bool,
    /// Thickness of the contact layer on the surfaces (a length): contact forces begin at this distance. By default 0.04 of the shortest edge of the facets that face another surface within two of their edges at the
    /// start, and of the facets beside them (of all facets if there are none), but not above 0.16 of the shortest edge of all, nor above half of the smallest distance between two parts of the surface of a body that are not neighbours.
    #[key(dimension = Length, auto, positive)]
    pub thickness: Option<f64>,
    /// Modulus of the contact layer as a multiple of Young's moduli of the bodies of a pair in series, 1/(1/E + 1/E'), positive.
    #[key(default = 1.0, dimension = Number, positive)]
    pub stiffness: f64,
    /// Modulus of the contact layer (a stress), positive, between two rigid bodies that have none in `pairs`. By default a hundred times the weight of the lighter body over the smallest side of the box around it; without gravity such bodies pass through each other.
    #[key(dimension = Stress, positive)]
    pub modulus: Option<f64>,
    /// Friction of all pairs of bodies that are not in `pairs`: a coefficient, not negative, or a law, `{ law = "static-dynamic", mu_static = 0.5, mu_dynamic = 0.3, speed = 0.1 }`; frictionless if left out.
    #[key(default, dimension = Number)]
    pub friction: GeneralFriction,
    /// Slip speed (length per time) in dynamics below which friction falls to zero, positive: bodies creep instead of sticking. If left out they stick, like a spring of the shear stiffness of a skin of the thickness of the layer.
    #[key(dimension = Velocity, positive)]
    pub slip_velocity: Option<f64>,
    /// Relaxation time of viscous damping in the contact layer, not negative. Its dissipation is part of the balance of energy.
    #[key(default, dimension = Time, not_negative)]
    pub damping: f64,
    /// `true`: self-contact of each body is included.
    #[key(name = "self", default = true)]
    pub with_itself: bool,
    /// Treatment of bodies that penetrate each other at the start: `refuse` if left out.
    #[key(default)]
    pub initial: Initial,
    /// Surfaces that take part: names of parts, and sets of them (`part.set`); all bodies if left out.
    #[key(default, skip, by = surface)]
    pub include: Vec<String>,
    /// Surfaces that do not take part, also where `include` names them: names of parts, and sets of them.
    #[key(default, skip, by = surface)]
    pub exclude: Vec<String>,
    /// Pairs of bodies with their own friction or modulus.
    #[key(default, skip)]
    pub pairs: Vec<GeneralPair>,
}

/// A pair of bodies in `[general_contact]` with its own parameters.
#[table(context(World<'_>))]
pub struct GeneralPair {
    /// Names of the two parts, which may be the same.
    #[key(example = "[\"block\", \"plate\"]", by = part_name)]
    pub between: [String; 2],
    /// Friction as in `[general_contact]`; that of `[general_contact]` if left out.
    #[key(dimension = Number)]
    pub friction: Option<GeneralFriction>,
    /// Modulus of the contact layer (a stress), positive; it follows from `stiffness` if left out, of two rigid bodies it is the `modulus` of `[general_contact]`.
    #[key(dimension = Stress, positive)]
    pub modulus: Option<f64>,
}

/// Friction of general contact.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum GeneralFriction {
    /// Coefficient of Coulomb's law, not negative.
    Coefficient(f64),
    /// A law with its parameters, without keys of stick and slip.
    Law(Friction),
}

impl Default for GeneralFriction {
    fn default() -> Self {
        Self::Coefficient(0.0)
    }
}

impl GeneralFriction {
    /// The law with its parameters; none if there is no friction.
    pub fn law(&self) -> Option<Friction> {
        match self {
            Self::Coefficient(mu) => (*mu > 0.0).then(|| Friction::coulomb(*mu)),
            Self::Law(law) => Some(law.clone()),
        }
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for GeneralFriction {
    fn schema_name() -> Cow<'static, str> {
        "GeneralFriction".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let number = json_schema!({ "description": "Coefficient of friction, not negative.", "type": "number", "format": "double", "x-dimension": Dimension::Number });
        let laws = LAWS.iter().map(|entry| catalogue::schema(&entry.law, serde_json::Map::new()));
        let ways: Vec<serde_json::Value> = std::iter::once(number.into()).chain(laws).collect();
        json_schema!({ "description": "A coefficient of friction, or a friction law with its parameters.", "oneOf": ways })
    }
}

/// Whether a scene that does not mention general contact has it: no pair is named, several parts have surfaces, some of them deformable, and all schemes carry it.
pub(crate) fn is_default<'a>(
    names_pairs: bool,
    surfaces: usize,
    deformable: usize,
    mut schemes: impl Iterator<Item = &'a Integrator>,
) -> bool {
    !names_pairs && surfaces > 1 && deformable > 0 && schemes.all(Integrator::carries_general_contact)
}

/// Keys of contacts whose gaps are rows of the system.
const OF_PAIRS: [&str; 3] = ["overlap", "interference", "closing_friction"];

fn general_contact(_: &GeneralContactKeys, table: &Table<'_>, _: &World<'_>) -> Option<()> {
    let mut fits = Some(());
    for key in OF_PAIRS.into_iter().filter(|&key| table.has(key)) {
        fits = table.fail(
            key,
            "is not for general contact: its layer has no row that could keep a gap, and a layer of another thickness would be another stiffness",
            "name the pair of surfaces in a [[contact]], which has this key",
        );
    }
    fits
}

impl Value<World<'_>> for GeneralFriction {
    fn read(node: &Node<'_>, world: &World<'_>) -> Option<Self> {
        if !node.is_table() {
            return node.not_negative().map(Self::Coefficient);
        }
        let law = Friction::of(node, None, world)?;
        if let Some(key) = law.given.key().or(law.slip.map(|_| "slip")) {
            return node.fail(
                format!("has `{key}`, which is not for general contact: bodies stick there like springs of the shear stiffness of the layer, or creep below `slip_velocity`"),
                "remove it",
            );
        }
        Some(Self::Law(law))
    }
}

/// A part, or facets of one.
fn surface(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    match node.string_value() {
        Some(text) if is_name(text) => part_name(node, world),
        _ => surface_reference(node, world),
    }
}
