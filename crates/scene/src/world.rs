//! What the parts of a scene must know about each other, and the names in it.

use crate::read::{Node, Table};
use crate::sets::Sets;
use crate::spelling::known;
use crate::{Kind, PartKind, ProbeComponent, split_set};
use std::collections::BTreeMap;
use stoss_multibody::JointEntry;
use toml::de::DeValue;

/// What a part must know of the scene.
#[derive(Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub(crate) kind: Option<Kind>,
    pub(crate) gravity: bool,
    /// Whether something else says how the part moves, so that it needs no mass.
    pub(crate) is_held: bool,
    /// Names of hyperelastic laws beside the catalogue.
    pub(crate) own_materials: &'a [&'a str],
}

impl Setting<'_> {
    /// True if every part must have its mass.
    pub(crate) fn needs_mass(self) -> bool {
        self.kind == Some(Kind::Dynamic) || (self.kind == Some(Kind::QuasiStatic) && self.gravity)
    }

    /// A density or mass: positive where there is inertia, else not negative.
    pub(crate) fn mass_value(self, node: &Node<'_>) -> Option<f64> {
        if self.kind == Some(Kind::QuasiStatic) { node.not_negative() } else { node.positive() }
    }

    /// Reports a density or mass that is missing: every part must have one in dynamics, and in statics with gravity.
    pub(crate) fn demand_mass(self, table: &Table<'_>, key: &'static str, example: &str) -> Option<()> {
        if self.needs_mass() && !table.has(key) { self.missing_mass(table, key, example) } else { Some(()) }
    }

    /// Reports that a density or mass is missing; always `None`.
    pub(crate) fn missing_mass<T>(self, table: &Table<'_>, key: &'static str, example: &str) -> Option<T> {
        if self.kind == Some(Kind::QuasiStatic) {
            let remedy = format!("add it, for instance `{example}`, or 0 for a part without weight");
            return table.fail(key, "is missing: the scene has gravity", remedy);
        }
        table.missing(key, example)
    }

    /// Reports velocities in a quasi-static scene.
    pub(crate) fn at_rest(self, table: &Table<'_>, keys: &[&'static str]) -> Option<()> {
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
pub(crate) struct KnownPart {
    pub(crate) name: String,
    pub(crate) kind: PartKind,
    /// Whether a rigid body has a shape, mesh or surface.
    pub(crate) has_surface: bool,
    /// Whether a rigid body does not move.
    pub(crate) fixed: bool,
    /// Both ends of a string; twice the place of a point mass. `None` if they could not be read.
    pub(crate) ends: Option<[[f64; 3]; 2]>,
}

impl KnownPart {
    /// True for what has one place only, the set `all`.
    pub(crate) fn has_no_sets(&self) -> bool {
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
pub(crate) type KnownProbe = (String, Option<&'static [ProbeComponent]>);

/// What has a name that `[[event]]` or `off` of `[[stage]]` may use.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Action {
    Joint,
    Spring,
    Equation,
    Contact,
    Tie,
    Prescribe,
    Load,
}

impl Action {
    pub(crate) fn noun(self) -> &'static str {
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
pub(crate) struct World<'a> {
    pub(crate) kind: Option<Kind>,
    pub(crate) end: Option<f64>,
    pub(crate) parts: Vec<KnownPart>,
    /// False if a part's name could not be read, or is that of another one: then an unknown part may be that one.
    pub(crate) parts_complete: bool,
    /// Joints and their kinds, if they could be read.
    pub(crate) joints: Vec<(String, Option<&'static JointEntry>)>,
    /// Names of equations that could be read.
    pub(crate) equations: Vec<String>,
    pub(crate) actions: Vec<(String, Action)>,
    /// False if a name of those could not be read, or is that of another one.
    pub(crate) actions_complete: bool,
    /// Probes and the components of their values, if those could be read.
    pub(crate) probes: Vec<KnownProbe>,
    pub(crate) probes_complete: bool,
    pub(crate) has_contact: bool,
    pub(crate) has_general_contact: bool,
    pub(crate) has_tie: bool,
    /// Whether anything has a prescribed displacement.
    pub(crate) has_prescribed: bool,
    /// Whether there is a `[[support]]`.
    pub(crate) has_elastic_support: bool,
    pub(crate) sets: Sets<'a>,
    /// Names of laws of friction beside the catalogue.
    pub(crate) own_friction: &'a [&'a str],
}

impl World<'_> {
    /// The part of that name, if it is known.
    pub(crate) fn part(&self, name: &str) -> Option<&KnownPart> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// Components of the values of a probe, if they are known.
    pub(crate) fn components(&self, probe: Option<&str>) -> Option<&'static [ProbeComponent]> {
        self.probes.iter().find(|(name, _)| Some(name.as_str()) == probe)?.1
    }

    /// The part of that name; reports a part that does not exist. `Some(None)` if it may be one whose name could not be read.
    pub(crate) fn find(&self, node: &Node<'_>, name: &str) -> Option<Option<&KnownPart>> {
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
pub(crate) fn part_name(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let name = node.text()?;
    world.find(node, &name)?;
    Some(name)
}

/// The name of a part with a mesh: a deformable body or, if `rigid`, a rigid one with a surface.
pub(crate) fn meshed_part(node: &Node<'_>, world: &World<'_>, rigid: bool) -> Option<String> {
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
pub(crate) fn set_reference(node: &Node<'_>, world: &World<'_>) -> Option<String> {
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
pub(crate) fn surface_reference(node: &Node<'_>, world: &World<'_>) -> Option<String> {
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
pub(crate) fn contact_reference(node: &Node<'_>, world: &World<'_>) -> Option<String> {
    let text = set_reference(node, world)?;
    if is_line(&text, world) { Some(text) } else { with_surface(node, world, text) }
}

/// Whether a reference is to a beam or a string.
pub(crate) fn is_line(reference: &str, world: &World<'_>) -> bool {
    split_set(reference).and_then(|(part, _)| world.part(part)).is_some_and(KnownPart::is_line)
}

/// A name that `[[event]]` and `[[stage]]` may use.
pub(crate) fn action_name(node: &Node<'_>) -> Option<String> {
    let name = node.name()?;
    if name == GRAVITY {
        return node.fail("is reserved for gravity in `off` of [[stage]]", "choose another name");
    }
    Some(name)
}

/// What gravity is called where a stage switches it off.
pub(crate) const GRAVITY: &str = "gravity";

/// The string of a key, if it is one; nothing is reported.
pub(crate) fn raw(table: &Table<'_>, key: &'static str) -> Option<String> {
    match table.get(key)?.value {
        DeValue::String(text) => Some(text.to_string()),
        _ => None,
    }
}

/// Reports names that appear twice.
pub(crate) struct Unique {
    what: &'static str,
    /// Key of the first of each name.
    seen: BTreeMap<String, String>,
}

impl Unique {
    pub(crate) fn new(what: &'static str) -> Self {
        Self { what, seen: BTreeMap::new() }
    }

    /// Enters a name without a report.
    pub(crate) fn enter(&mut self, table: &Table<'_>, name: &str) {
        self.seen.entry(name.to_owned()).or_insert_with(|| table.node.key.clone());
    }

    /// False if the name was there before, which is reported.
    pub(crate) fn check(&mut self, table: Option<&Table<'_>>, key: &'static str, name: Option<&str>) -> bool {
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

/// A time from the start to the end of the run.
pub(crate) fn time_in_run(node: &Node<'_>, world: &World<'_>) -> Option<f64> {
    let time = node.not_negative()?;
    match world.end.filter(|&end| time > end) {
        Some(end) => node.fail(format!("is after the end of the run, {end}"), "choose a time in the run"),
        None => Some(time),
    }
}

/// A time after the start, up to the end of the run.
pub(crate) fn before_end(node: &Node<'_>, world: &World<'_>) -> Option<f64> {
    let time = node.positive()?;
    match world.end {
        Some(end) if time > end => node.fail(format!("is after the end of the run, {end}"), "choose a time in the run"),
        _ => Some(time),
    }
}
