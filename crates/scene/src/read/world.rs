//! What the parts of a scene must know about each other, and the names in it.

use super::node::{Node, known};
use super::sets::Sets;
use super::table::Table;
use crate::{JointKind, Kind, PartKind, ProbeComponent, split_set};
use std::collections::BTreeMap;
use toml::de::DeValue;

/// What inertia and weight the scene asks of its parts.
#[derive(Clone, Copy)]
pub(super) struct Setting {
    pub(super) kind: Option<Kind>,
    pub(super) gravity: bool,
}

impl Setting {
    /// True if every part must have its mass.
    pub(super) fn needs_mass(self) -> bool {
        self.kind == Some(Kind::Dynamic) || (self.kind == Some(Kind::QuasiStatic) && self.gravity)
    }

    /// A density or mass: positive where there is inertia, else not negative.
    pub(super) fn mass_value(self, node: &Node<'_>) -> Option<f64> {
        if self.kind == Some(Kind::QuasiStatic) { node.not_negative() } else { node.positive() }
    }

    /// A density or mass that every part must have in dynamics, and in statics with gravity.
    pub(super) fn mass(self, table: &Table<'_>, key: &'static str, example: &str) -> Option<Option<f64>> {
        if self.needs_mass() && !table.has(key) {
            return self.missing_mass(table, key, example);
        }
        table.optional(key, |n| self.mass_value(n))
    }

    /// Reports that a density or mass is missing; always `None`.
    pub(super) fn missing_mass<T>(self, table: &Table<'_>, key: &'static str, example: &str) -> Option<T> {
        if self.kind == Some(Kind::QuasiStatic) {
            let remedy = format!("add it, for instance `{example}`, or 0 for a part without weight");
            return table.fail(key, "is missing: the scene has gravity", remedy);
        }
        table.missing(key, example)
    }

    /// Reports velocities in a quasi-static scene.
    pub(super) fn at_rest(self, table: &Table<'_>, keys: &[&'static str]) -> Option<()> {
        let mut at_rest = Some(());
        if self.kind == Some(Kind::QuasiStatic) {
            for key in keys.iter().copied().filter(|&key| table.has(key)) {
                at_rest = table.fail(
                    key,
                    "a quasi-static scene has no velocities",
                    "remove it, or set [scene] kind = \"dynamic\"",
                );
            }
        }
        at_rest
    }
}

/// A part, as far as references to it must know it.
pub(super) struct KnownPart {
    pub(super) name: String,
    pub(super) kind: PartKind,
    /// Whether a rigid body has a shape, mesh or surface.
    pub(super) has_surface: bool,
    /// Whether a rigid body does not move.
    pub(super) fixed: bool,
    /// Both ends of a string; twice the place of a point mass. `None` if they could not be read.
    pub(super) ends: Option<[[f64; 3]; 2]>,
}

impl KnownPart {
    /// True for what has one place only, the set `all`.
    pub(super) fn has_no_sets(&self) -> bool {
        self.sets().is_some_and(|sets| sets.len() == 1)
    }

    fn is_line(&self) -> bool {
        matches!(self.kind, PartKind::Beam | PartKind::String)
    }

    /// Names of its sets, if they are known before a mesh is read.
    fn sets(&self) -> Option<&'static [&'static str]> {
        match self.kind {
            PartKind::Beam | PartKind::String => Some(&["start", "end", "all"]),
            PartKind::Mass => Some(&["all"]),
            PartKind::Rigid if !self.has_surface => Some(&["all"]),
            _ => None,
        }
    }
}

/// A probe, and the components of its values if they could be read.
pub(super) type KnownProbe = (String, Option<&'static [ProbeComponent]>);

/// What has a name that `[[event]]` or `off` of `[[stage]]` may use.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    Joint,
    Spring,
    Equation,
    Contact,
    Tie,
    Prescribe,
    Load,
}

impl Action {
    pub(super) fn noun(self) -> &'static str {
        match self {
            Self::Joint => "a joint",
            Self::Spring => "a spring",
            Self::Equation => "an equation",
            Self::Contact => "a contact",
            Self::Tie => "a tie",
            Self::Prescribe => "a prescribed motion",
            Self::Load => "a load",
        }
    }
}

/// What later parts of a scene must know about earlier ones, bad or not.
pub(super) struct World<'a> {
    pub(super) kind: Option<Kind>,
    pub(super) end: Option<f64>,
    pub(super) parts: Vec<KnownPart>,
    /// False if a part's name could not be read, or is that of another one: then an unknown part may be that one.
    pub(super) parts_complete: bool,
    /// Joints and their kinds, if they could be read.
    pub(super) joints: Vec<(String, Option<JointKind>)>,
    /// Names of equations that could be read.
    pub(super) equations: Vec<String>,
    pub(super) actions: Vec<(String, Action)>,
    /// False if a name of those could not be read, or is that of another one.
    pub(super) actions_complete: bool,
    /// Probes and the components of their values, if those could be read.
    pub(super) probes: Vec<KnownProbe>,
    pub(super) probes_complete: bool,
    pub(super) has_contact: bool,
    pub(super) has_general_contact: bool,
    pub(super) has_tie: bool,
    /// Whether anything has a prescribed displacement.
    pub(super) has_prescribed: bool,
    /// Whether there is a `[[support]]`.
    pub(super) has_elastic_support: bool,
    pub(super) sets: Sets<'a>,
    /// Names of laws of friction beside the catalogue.
    pub(super) own_friction: &'a [&'a str],
}

impl World<'_> {
    /// The part of that name, if it is known.
    pub(super) fn part(&self, name: &str) -> Option<&KnownPart> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// The part of that name; reports a part that does not exist. `Some(None)` if it may be one whose name could not be read.
    pub(super) fn find(&self, node: &Node<'_>, name: &str) -> Option<Option<&KnownPart>> {
        match self.part(name) {
            None if self.parts_complete => node.fail(
                format!("there is no part `{name}`"),
                known(name, self.parts.iter().map(|part| part.name.as_str())),
            ),
            part => Some(part),
        }
    }
}

/// The name of a part of this scene.
pub(super) fn part_name(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    world.find(node, &name)?;
    Some(name)
}

/// The name of a part with a mesh: a deformable body or, if `rigid`, a rigid one with a surface.
pub(super) fn meshed_part(node: &Node<'_>, world: &World<'_>, rigid: bool) -> Option<String> {
    let name = node.text()?;
    match world.find(node, &name)? {
        Some(part) if part.kind != PartKind::Body && !(rigid && part.has_surface) => {
            let wanted = if rigid { "a body with a mesh or surface" } else { "a deformable body" };
            node.fail(format!("is {}, not {wanted}", part.kind.noun()), format!("name {wanted}"))
        }
        _ => Some(name),
    }
}

/// A reference `part.set` to a set of a part of this scene, or an expression over its sets.
pub(super) fn set_reference(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let text = world.sets.reference(node)?;
    let Some((part, set)) = split_set(&text) else {
        return node.fail("is not of the form `body.set`", "name body and set, for instance \"plate.top\"");
    };
    if let Some(part) = world.find(node, part)?
        && let Some(sets) = part.sets()
        && !sets.contains(&set)
        && !world.sets.contains(&part.name, set)
    {
        let what = part.kind.noun();
        return node.fail(format!("{what} has no set `{set}`"), known(set, sets.iter().copied()));
    }
    Some(text)
}

/// A reference `part.set` to a set of a deformable body or of a rigid one with a surface.
pub(super) fn surface_reference(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    with_surface(node, world, set_reference(node, world)?)
}

fn with_surface(node: &Node<'_>, world: &World<'_>, text: String) -> Option<String> {
    if let Some(part) = split_set(&text).and_then(|(part, _)| world.part(part))
        && !part.has_surface
    {
        let message = format!("`{}` is {} without a surface", part.name, part.kind.noun());
        return node.fail(message, "name a set of a body, or of a rigid body with a shape, mesh or surface");
    }
    Some(text)
}

/// A reference `part.set` to a side of a contact: a surface, or the nodes of a beam or string (`is_line`).
pub(super) fn contact_reference(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let text = set_reference(node, world)?;
    if is_line(&text, world) { Some(text) } else { with_surface(node, world, text) }
}

/// Whether a reference is to a beam or a string.
pub(super) fn is_line(reference: &str, world: &World<'_>) -> bool {
    split_set(reference).and_then(|(part, _)| world.part(part)).is_some_and(KnownPart::is_line)
}

/// A name that `[[event]]` and `[[stage]]` may use.
pub(super) fn action_name(node: &Node<'_>) -> Option<String> {
    let name = node.name()?;
    if name == GRAVITY {
        return node.fail("is reserved for gravity in `off` of [[stage]]", "choose another name");
    }
    Some(name)
}

/// What gravity is called where a stage switches it off.
pub(super) const GRAVITY: &str = "gravity";

/// The string of a key, if it is one; nothing is reported.
pub(super) fn raw(table: &Table<'_>, key: &'static str) -> Option<String> {
    match table.get(key)?.value {
        DeValue::String(text) => Some(text.to_string()),
        _ => None,
    }
}

/// Reports names that appear twice.
pub(super) struct Unique {
    what: &'static str,
    /// Key of the first of each name.
    seen: BTreeMap<String, String>,
}

impl Unique {
    pub(super) fn new(what: &'static str) -> Self {
        Self { what, seen: BTreeMap::new() }
    }

    /// Enters a name without a report.
    pub(super) fn enter(&mut self, table: &Table<'_>, name: &str) {
        self.seen.entry(name.to_owned()).or_insert_with(|| table.node.key.clone());
    }

    /// False if the name was there before, which is reported.
    pub(super) fn check(&mut self, table: Option<&Table<'_>>, key: &'static str, name: Option<&str>) -> bool {
        let (Some(table), Some(name)) = (table, name) else { return true };
        if let Some(first) = self.seen.get(name) {
            let _: Option<()> = table.fail(
                key,
                format!("{} `{name}` appears twice, first in `{first}`", self.what),
                "use every one at most once",
            );
            return false;
        }
        self.seen.insert(name.to_owned(), table.node.key.clone());
        true
    }
}
