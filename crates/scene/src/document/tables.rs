//! Reads the whole document, table after table.

use super::parameters;
use crate::event::{have_own_schemes, stages};
use crate::general::Clock;
use crate::general_contact::is_default;
use crate::read::{Table, Value, is_name};
use crate::sets::Sets;
use crate::source::Source;
use crate::world::{Action, GRAVITY, KnownPart, Setting, Unique, World, raw};
use crate::{
    Beam, Body, Contact, Edges, ElasticString, Equation, Event, GROUND, GeneralContact, Header, Joint, JointKind, Kind,
    LeftOut, Load, OwnNames, PartKind, PointMass, Prescribe, Rigid, Scene, SetCoupling, SetDefinition, Spring, Stage,
    Support, Tie, Time, equation, probe, rigid,
};
use std::collections::{BTreeMap, BTreeSet};
use stoss_multibody::JointEntry;
use toml::de::DeValue;

type Tables<'a> = Vec<Option<Table<'a>>>;

pub(crate) fn document(root: &Table<'_>, own_laws: &OwnNames<'_>) -> Option<Scene> {
    let header = root.required("scene", "[scene]", |n| Header::read(n, &()));
    // The kind is needed even if the rest is bad.
    let kind = root.get("scene").and_then(|node| node.raw_table()).and_then(|table| raw(&table, "kind"));
    let kind = kind.and_then(|kind| Kind::from_name(&kind));
    let stage_tables = root.tables("stage");
    let clock = Clock { kind, own_schemes: have_own_schemes(&stage_tables) };
    let time = root.required("time", "[time]", |n| Time::read(n, &clock));
    let solver = root.default("solver", crate::Solver::default(), |n| Value::read(n, &()));
    let gravity = root.optional("gravity", |n| Value::read(n, &()));
    let has_gravity = root.has("gravity");

    let contact_tables = root.tables("contact");
    let tie_tables = root.tables("tie");
    let joint_tables = root.tables("joint");
    let spring_tables = root.tables("spring");
    let coupling_tables = root.tables("coupling");
    let equation_tables = root.tables("equation");
    let support_tables = root.tables("support");
    let prescribe_tables = root.tables("prescribe");
    let load_tables = root.tables("load");
    let event_tables = root.tables("event");

    let setting = Setting { kind, gravity: has_gravity, is_held: false, own_materials: &own_laws.materials };
    let held = held(&prescribe_tables, &event_tables, &stage_tables);
    let moved = equation::moved(&equation_tables, &coupling_tables, &prescribe_tables);
    let parts = Parts::read(root, setting, [&held, &moved]);
    let owners = parts.known.iter().map(|part| (part.name.clone(), part.has_no_sets().then(|| part.kind.noun())));
    let sets = Sets::new(root, owners.collect(), parts.complete);
    let mut world = World {
        kind,
        end: time.as_ref().map(|time| time.end),
        has_elastic_support: !support_tables.is_empty(),
        has_prescribed: !prescribe_tables.is_empty()
            || parts.known.iter().any(|part| part.fixed)
            || header.as_ref().is_some_and(|header| !header.symmetry.is_empty()),
        parts: parts.known,
        parts_complete: parts.complete,
        joints: Vec::new(),
        equations: Vec::new(),
        actions: Vec::new(),
        actions_complete: true,
        probes: Vec::new(),
        probes_complete: true,
        has_contact: !contact_tables.is_empty(),
        has_general_contact: false,
        has_tie: !tie_tables.is_empty(),
        own_friction: &own_laws.friction,
        sets,
    };
    world.sets.read();
    let named_sets = world.sets.texts();

    let mut unique = Unique::new("set");
    let mut regions = Vec::new();
    for table in root.tables("set") {
        let set = table.as_ref().and_then(|table| SetDefinition::from_table(table, &world));
        unique.check(table.as_ref(), "name", set.as_ref().map(|set| set.name.as_str()));
        regions.push(set);
    }

    // Names of what can be released or switched off; contacts and ties have rules of their own.
    let mut actions = Unique::new("name");
    let mut unique = Unique::new("contact");
    let mut contacts = Vec::new();
    for table in &contact_tables {
        let contact = table.as_ref().and_then(|table| Contact::from_table(table, &world));
        let label = contact.as_ref().map(|contact| contact.label());
        label_unique(&mut unique, table.as_ref(), label.as_deref());
        enter(&mut world, table.as_ref(), label, Action::Contact, &mut actions);
        contacts.push(contact);
    }

    let mut unique = Unique::new("tie");
    let mut ties = Vec::new();
    for table in &tie_tables {
        let tie = table.as_ref().and_then(|table| Tie::from_table(table, &world));
        let label = tie.as_ref().map(|tie| tie.label());
        label_unique(&mut unique, table.as_ref(), label.as_deref());
        enter(&mut world, table.as_ref(), label, Action::Tie, &mut Unique::new("tie"));
        ties.push(tie);
    }

    for (tables, action) in [
        (&joint_tables, Action::Joint),
        (&spring_tables, Action::Spring),
        (&equation_tables, Action::Equation),
        (&prescribe_tables, Action::Prescribe),
        (&load_tables, Action::Load),
    ] {
        for table in tables {
            let name = table.as_ref().and_then(|table| raw(table, "name"));
            world.actions_complete &= actions.check(table.as_ref(), "name", name.as_deref());
            match (name, table) {
                (Some(name), Some(table)) => {
                    world.actions_complete &= is_name(&name) && name != GRAVITY;
                    if action == Action::Joint {
                        world.joints.push((name.clone(), joint_kind(table)));
                    }
                    if action == Action::Equation {
                        world.equations.push(name.clone());
                    }
                    world.actions.push((name, action));
                }
                // A name that may be left out hides nothing unless it is there and no string.
                (None, Some(table)) if !table.has("name") && matches!(action, Action::Prescribe | Action::Load) => {}
                _ => world.actions_complete = false,
            }
        }
    }
    let joints: Vec<_> = joint_tables.iter().map(|table| Joint::from_table(table.as_ref()?, &world)).collect();
    let springs: Vec<_> = spring_tables.iter().map(|table| Spring::from_table(table.as_ref()?, &world)).collect();

    let equations: Vec<_> = equation_tables.iter().map(|table| Equation::from_table(table.as_ref()?, &world)).collect();
    let mut unique = Unique::new("coupling");
    let mut couplings = Vec::new();
    for table in &coupling_tables {
        let coupling = table.as_ref().and_then(|table| SetCoupling::from_table(table, &world));
        unique.check(table.as_ref(), "name", coupling.as_ref().map(|coupling| coupling.name.as_str()));
        couplings.push(coupling);
    }

    let mut unique_rigid = Unique::new("prescribed rigid body");
    let mut prescriptions = Vec::new();
    for table in &prescribe_tables {
        let prescribe = table.as_ref().and_then(|table| Prescribe::from_table(table, &world));
        // A name may be misspelt.
        world.actions_complete &= table.as_ref().is_none_or(|table| !table.has_unknown_key());
        if let Some(prescribe) = &prescribe {
            unique_rigid.check(table.as_ref(), "rigid", prescribe.rigid.as_deref());
        }
        prescriptions.push(prescribe);
    }

    let loads: Vec<_> = load_tables.iter().map(|table| Load::from_table(table.as_ref()?, &world)).collect();
    world.actions_complete &= !load_tables.iter().flatten().any(Table::has_unknown_key);

    let supports: Vec<_> = support_tables.iter().map(|table| Support::from_table(table.as_ref()?, &world)).collect();

    let mut unique = Unique::new("stage");
    let stages = stages(&stage_tables, &world, time.as_ref(), has_gravity);
    for (table, stage) in stage_tables.iter().zip(&stages) {
        unique.check(table.as_ref(), "name", stage.as_ref().map(|stage| stage.name.as_str()));
    }

    // A component of a set may have several prescriptions if no stage has two of them.
    let in_time: Vec<Option<&Stage>> =
        if stages.is_empty() { vec![None] } else { stages.iter().flatten().map(Some).collect() };
    for stage in in_time {
        let mut unique = Unique::new("prescribed component");
        let mut differ = true;
        for (table, prescribe) in prescribe_tables.iter().zip(&prescriptions) {
            let Some((prescribe, set)) = prescribe.as_ref().and_then(|p| Some((p, p.set.as_ref()?))) else { continue };
            let off = stage.zip(prescribe.name.as_ref()).is_some_and(|(stage, name)| stage.off.contains(name));
            for component in prescribe.components.iter().filter(|_| !off) {
                differ &= unique.check(table.as_ref(), "components", Some(&format!("{component} of {set}")));
            }
        }
        if !differ {
            break;
        }
    }

    let general_contact = root.optional("general_contact", |n| GeneralContact::read(n, &world));
    let schemes = time.iter().filter_map(|time| time.integrator.as_ref());
    let schemes = schemes.chain(stages.iter().flatten().filter_map(|stage| stage.integrator.as_ref()));
    let surfaces = world.parts.iter().filter(|part| part.has_surface).count();
    let deformable = world.parts.iter().filter(|part| part.kind == PartKind::Body).count();
    let section = header.as_ref().and_then(|header| header.section);
    world.has_general_contact = match &general_contact {
        _ if section.is_some() => false,
        None => true,
        Some(Some(table)) => table.enabled,
        Some(None) => {
            contacts.iter().flatten().any(|contact| contact.edges == Edges::General)
                || is_default(world.has_contact, surfaces, deformable, schemes)
        }
    };

    let mut unique = Unique::new("probe");
    let mut probes = Vec::new();
    for table in root.tables("probe") {
        let (probe, name) = table.as_ref().map_or((None, None), |table| probe::probe(table, &world));
        unique.check(table.as_ref(), "name", name.as_ref().map(|(name, _)| name.as_str()));
        world.probes_complete &= name.is_some();
        world.probes.extend(name);
        probes.push(probe);
    }

    let mut unique = Unique::new("event");
    let mut events = Vec::new();
    for table in &event_tables {
        let event = table.as_ref().and_then(|table| Event::from_table(table, &world));
        unique.check(table.as_ref(), "name", event.as_ref().map(|event| event.name.as_str()));
        events.push(event);
    }
    let output = root.default("output", crate::Output::default(), |n| Value::read(n, &world));
    let watch = root.default("watch", crate::Watch::default(), |n| Value::read(n, &()));
    let expect = root.optional("expect", |n| Value::read(n, &world));
    let left_out: Vec<_> =
        root.tables("left_out").iter().map(|table| LeftOut::from_table(table.as_ref()?, &())).collect();
    let parameters = root.default("parameters", BTreeMap::new(), parameters::values);
    let sweep = root.optional("sweep", |n| Value::read(n, &()));
    root.finish();
    if let Some(header) = &header {
        let scene = super::section::Content {
            bodies: &parts.bodies,
            held: &held,
            loads: &loads,
            prescriptions: &prescriptions,
        };
        super::section::check(root, header, gravity.as_ref().and_then(Option::as_ref), &scene)?;
    }

    Some(Scene {
        parameters: parameters?,
        sweep: sweep?,
        header: header?,
        time: time?,
        solver: solver?,
        gravity: gravity?,
        bodies: all(parts.bodies)?,
        rigids: all(parts.rigids)?,
        beams: all(parts.beams)?,
        strings: all(parts.strings)?,
        masses: all(parts.masses)?,
        sets: all(regions)?,
        named_sets: named_sets?,
        contacts: all(contacts)?,
        general_contact: general_contact?,
        ties: all(ties)?,
        joints: all(joints)?,
        couplings: all(couplings)?,
        equations: all(equations)?,
        springs: all(springs)?,
        prescriptions: all(prescriptions)?,
        loads: all(loads)?,
        supports: all(supports)?,
        events: all(events)?,
        stages: all(stages)?,
        probes: all(probes)?,
        output: output?,
        watch: watch?,
        expect: expect?,
        left_out: all(left_out)?,
        source: Source::of_expressions(world.sets.into_list()),
    })
}

fn all<T>(values: Vec<Option<T>>) -> Option<Vec<T>> {
    values.into_iter().collect()
}

/// Checks the label of a contact or tie.
fn label_unique(unique: &mut Unique, table: Option<&Table<'_>>, label: Option<&str>) {
    let key = if table.is_some_and(|table| table.has("name")) { "name" } else { "slave" };
    unique.check(table, key, label);
}

/// Makes the label of a contact or tie known; if that could not be read, its name.
fn enter(
    world: &mut World<'_>,
    table: Option<&Table<'_>>,
    label: Option<String>,
    action: Action,
    actions: &mut Unique,
) {
    let Some(table) = table else {
        world.actions_complete = false;
        return;
    };
    match label.or_else(|| raw(table, "name")) {
        Some(label) => {
            actions.enter(table, &label);
            world.actions.push((label, action));
        }
        None => world.actions_complete = false,
    }
}

/// The parts of the scene by kind.
struct Parts {
    bodies: Vec<Option<Body>>,
    rigids: Vec<Option<Rigid>>,
    beams: Vec<Option<Beam>>,
    strings: Vec<Option<ElasticString>>,
    masses: Vec<Option<PointMass>>,
    known: Vec<KnownPart>,
    /// False if a name could not be read, or is that of another part.
    complete: bool,
}

impl Parts {
    fn read(root: &Table<'_>, setting: Setting<'_>, [held, moved]: [&BTreeSet<String>; 2]) -> Self {
        let tables = [PartKind::Body, PartKind::Rigid, PartKind::Beam, PartKind::String, PartKind::Mass]
            .map(|kind| root.tables(kind.name()));
        let mut names = PartNames { unique: Unique::new("part"), known: Vec::new(), complete: true };
        if tables.iter().all(Vec::is_empty) {
            let _: Option<()> =
                root.missing("body", "[[body]]` or one of `[[rigid]]`, `[[beam]]`, `[[string]]`, `[[mass]]");
            names.complete = false;
        }
        let [body_tables, rigid_tables, beam_tables, string_tables, mass_tables] = tables;
        // A name that no rigid body has may be meant for any of them.
        let rigid_names: Vec<_> = rigid_tables.iter().flatten().filter_map(|table| raw(table, "name")).collect();
        let all = [&body_tables, &rigid_tables, &beam_tables, &string_tables, &mass_tables];
        let all_names: Vec<_> = all.into_iter().flatten().flatten().filter_map(|table| raw(table, "name")).collect();
        let misnamed =
            held.iter().any(|name| !rigid_names.contains(name)) || moved.iter().any(|name| !all_names.contains(name));
        let names_it = |name: String| held.contains(&name) || moved.contains(&name);
        let is_held = |table: &Table<'_>| misnamed || raw(table, "name").is_some_and(names_it);
        let bodies = names.read(&body_tables, PartKind::Body, |table| Body::from_table(table, &setting));
        let of_held = |table: &Table<'_>| Setting { is_held: is_held(table), ..setting };
        let rigids = names.read(&rigid_tables, PartKind::Rigid, |table| Rigid::from_table(table, &of_held(table)));
        let beams = names.read(&beam_tables, PartKind::Beam, |table| Beam::from_table(table, &setting));
        let strings = names.read(&string_tables, PartKind::String, |table| ElasticString::from_table(table, &setting));
        let masses = names.read(&mass_tables, PartKind::Mass, |table| PointMass::from_table(table, &of_held(table)));
        for string in strings.iter().flatten() {
            let corners = string.corners();
            names.set_ends(&string.name, corners.first().copied().zip(corners.last().copied()).map(<[_; 2]>::from));
        }
        for mass in masses.iter().flatten() {
            names.set_ends(&mass.name, Some([mass.at; 2]));
        }
        Self { bodies, rigids, beams, strings, masses, known: names.known, complete: names.complete }
    }
}

/// Names of all parts.
struct PartNames {
    unique: Unique,
    known: Vec<KnownPart>,
    complete: bool,
}

impl PartNames {
    fn set_ends(&mut self, name: &str, ends: Option<[[f64; 3]; 2]>) {
        if let Some(part) = self.known.iter_mut().find(|part| part.name == name) {
            part.ends = ends;
        }
    }

    fn read<T>(
        &mut self,
        tables: &Tables<'_>,
        kind: PartKind,
        read: impl Fn(&Table<'_>) -> Option<T>,
    ) -> Vec<Option<T>> {
        let mut parts = Vec::new();
        for table in tables {
            let part = table.as_ref().and_then(&read);
            // The name is needed even if the rest is bad.
            let name =
                table.as_ref().and_then(|table| raw(table, "name")).filter(|name| is_name(name) && name != GROUND);
            self.complete &= self.unique.check(table.as_ref(), "name", name.as_deref());
            match (table, name) {
                (Some(table), Some(name)) => {
                    let has_surface = match kind {
                        PartKind::Body => true,
                        PartKind::Rigid => rigid::SURFACES.into_iter().any(|key| table.has(key)),
                        _ => false,
                    };
                    let fixed = kind == PartKind::Rigid
                        && table.get("fixed").is_some_and(|node| matches!(node.value, DeValue::Boolean(true)));
                    self.known.push(KnownPart { name, kind, has_surface, fixed, ends: None });
                }
                _ => self.complete = false,
            }
            parts.push(part);
        }
        parts
    }
}

/// Names of the rigid bodies whose motion is prescribed all the time: neither released by an event nor switched off in a stage.
fn held(prescriptions: &Tables<'_>, events: &Tables<'_>, stages: &Tables<'_>) -> BTreeSet<String> {
    let mut ending: BTreeSet<String> = events.iter().flatten().filter_map(|table| raw(table, "release")).collect();
    for node in stages.iter().flatten().filter_map(|table| table.get("off")) {
        if let DeValue::Array(names) = node.value {
            ending.extend(names.iter().filter_map(|name| match name.get_ref() {
                DeValue::String(name) => Some(name.to_string()),
                _ => None,
            }));
        }
    }
    prescriptions
        .iter()
        .flatten()
        .filter(|table| raw(table, "name").is_none_or(|name| !ending.contains(&name)))
        .filter_map(|table| raw(table, "rigid"))
        .collect()
}

/// The kind of a joint, if it can be read; nothing is reported.
fn joint_kind(table: &Table<'_>) -> Option<&'static JointEntry> {
    JointKind::from_name(&raw(table, "kind")?).map(|kind| kind.row())
}
