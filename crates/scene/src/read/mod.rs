//! Reads a scene from the document tree and collects all problems on the way.
//!
//! Not serde: it would stop at the first problem. What is read here and what the types' `Deserialize` accepts is held together by
//! a round trip in the tests.

mod body;
mod conditions;
mod friction;
mod general;
mod material;
mod mesh;
mod node;
mod results;
mod table;
mod tie;

use crate::source::Source;
use crate::{Kind, OwnNames, Problem, Quantity, Scene, SceneErrors};
use node::{Node, Report, known};
use std::cell::RefCell;
use std::collections::BTreeMap;
use table::Table;
use toml::de::{DeTable, DeValue};

/// What later parts of a scene must know about earlier ones, bad or not.
struct World<'a> {
    kind: Option<Kind>,
    end: Option<f64>,
    bodies: Vec<String>,
    /// False if a body's name could not be read: then an unknown body may be that one.
    bodies_complete: bool,
    probes: Vec<(String, Option<Quantity>)>,
    probes_complete: bool,
    has_contact: bool,
    has_tie: bool,
    has_support: bool,
    /// Names of laws of friction beside the catalogue.
    own_friction: &'a [&'a str],
}

impl World<'_> {
    /// Reports a body that does not exist.
    fn check_body(&self, node: &Node<'_>, name: &str) -> Option<()> {
        if !self.bodies_complete || self.bodies.iter().any(|body| body == name) {
            return Some(());
        }
        node.fail(format!("there is no body `{name}`"), known(name, self.bodies.iter().map(String::as_str)))
    }
}

pub(crate) fn scene(text: &str, file: &str, own_laws: &OwnNames<'_>) -> Result<Scene, SceneErrors> {
    let mut source = Source::new(text, file);
    let (document, errors) = DeTable::parse_recoverable(text);
    let syntax: Vec<Problem> = errors.iter().map(|error| syntax_problem(&source, error)).collect();
    if let Some(errors) = SceneErrors::new(syntax, text) {
        return Err(errors);
    }
    source.index(document.get_ref());
    let report = Report { source: &source, problems: RefCell::default() };
    let root = DeValue::Table(document.into_inner());
    let node = Node { report: &report, value: &root, span: 0..0, key: String::new() };
    let scene = node.table().and_then(|table| read(&table, own_laws));
    let problems = report.problems.into_inner();
    match (SceneErrors::new(problems, text), scene) {
        (None, Some(scene)) => Ok(Scene { source, ..scene }),
        (Some(errors), _) => Err(errors),
        (None, None) => {
            // Every reader that returns nothing has reported why; should one forget, the scene must still not pass.
            let problem = Problem::new(
                file,
                source.location(0..0),
                String::new(),
                "",
                "the scene could not be read".into(),
                "please report this scene as an error of the program".into(),
            );
            Err(SceneErrors::one(problem, text))
        }
    }
}

fn syntax_problem(source: &Source, error: &toml::de::Error) -> Problem {
    let message = error.message().split_whitespace().collect::<Vec<_>>().join(" ");
    let remedy = if message.contains("duplicate key") {
        "remove or rename one of the two"
    } else {
        "correct the TOML syntax here; strings need quotes, lists brackets, inline tables braces"
    };
    let location = source.location(error.span().unwrap_or(0..0));
    let message = if message.is_empty() { "is not valid TOML".to_owned() } else { message };
    Problem::new(&source.file, location, String::new(), "", message, remedy.to_owned())
}

fn read(root: &Table<'_>, own_laws: &OwnNames<'_>) -> Option<Scene> {
    let (header, kind) = match root.required("scene", "[scene]", Node::table) {
        Some(table) => general::header(&table),
        None => (None, None),
    };
    let time = root.required("time", "[time]", Node::table).and_then(|table| general::time(&table, kind));
    let solver = root.default("solver", crate::Solver::default(), general::solver);

    let mut bodies = Vec::new();
    let mut names = Vec::new();
    let mut unique = Unique::new("body");
    let body_tables = root.tables("body");
    if body_tables.is_empty() {
        let _: Option<()> = root.missing("body", "[[body]]");
    }
    let mut bodies_complete = !body_tables.is_empty();
    for table in &body_tables {
        let (body, name) = table.as_ref().map_or((None, None), |table| body::body(table, kind, &own_laws.materials));
        unique.check(table.as_ref(), "name", name.as_deref());
        bodies_complete &= name.is_some();
        names.extend(name);
        bodies.push(body);
    }

    let contact_tables = root.tables("contact");
    let tie_tables = root.tables("tie");
    let prescribe_tables = root.tables("prescribe");
    let mut world = World {
        kind,
        end: time.as_ref().map(|time| time.end),
        bodies: names,
        bodies_complete,
        probes: Vec::new(),
        probes_complete: true,
        has_contact: !contact_tables.is_empty(),
        has_tie: !tie_tables.is_empty(),
        has_support: !prescribe_tables.is_empty(),
        own_friction: &own_laws.friction,
    };

    let mut unique = Unique::new("set");
    let mut sets = Vec::new();
    for table in root.tables("set") {
        let set = table.as_ref().and_then(|table| conditions::set(table, &world));
        unique.check(table.as_ref(), "name", set.as_ref().map(|set| set.name.as_str()));
        sets.push(set);
    }

    let mut unique = Unique::new("contact");
    let mut contacts = Vec::new();
    for table in contact_tables {
        let contact = table.as_ref().and_then(|table| conditions::contact(table, &world));
        let key = if table.as_ref().is_some_and(|table| table.has("name")) { "name" } else { "slave" };
        unique.check(table.as_ref(), key, contact.as_ref().map(|contact| contact.label()).as_deref());
        contacts.push(contact);
    }

    let mut unique = Unique::new("tie");
    let mut ties = Vec::new();
    for table in tie_tables {
        let tie = table.as_ref().and_then(|table| tie::tie(table, &world));
        let key = if table.as_ref().is_some_and(|table| table.has("name")) { "name" } else { "slave" };
        unique.check(table.as_ref(), key, tie.as_ref().map(|tie| tie.label()).as_deref());
        ties.push(tie);
    }

    let mut unique = Unique::new("prescribed component");
    let mut prescriptions = Vec::new();
    for table in prescribe_tables {
        let prescribe = table.as_ref().and_then(|table| conditions::prescribe(table, &world));
        if let Some(prescribe) = &prescribe {
            for component in &prescribe.components {
                unique.check(table.as_ref(), "components", Some(&format!("{} of {}", component, prescribe.set)));
            }
        }
        prescriptions.push(prescribe);
    }

    let loads: Vec<_> = root.tables("load").iter().map(|table| conditions::load(table.as_ref()?, &world)).collect();

    let mut unique = Unique::new("probe");
    let mut probes = Vec::new();
    for table in root.tables("probe") {
        let (probe, name) = table.as_ref().map_or((None, None), |table| results::probe(table, &world));
        unique.check(table.as_ref(), "name", name.as_ref().map(|(name, _)| name.as_str()));
        world.probes_complete &= name.is_some();
        world.probes.extend(name);
        probes.push(probe);
    }

    let output = root.default("output", crate::Output::default(), |n| results::output(n, &world));
    let watch = root.default("watch", crate::Watch::default(), results::watch);
    let expect = root.optional("expect", |n| results::expect(n, &world));
    root.finish();

    Some(Scene {
        header: header?,
        time: time?,
        solver: solver?,
        bodies: all(bodies)?,
        sets: all(sets)?,
        contacts: all(contacts)?,
        ties: all(ties)?,
        prescriptions: all(prescriptions)?,
        loads: all(loads)?,
        probes: all(probes)?,
        output: output?,
        watch: watch?,
        expect: expect?,
        source: Source::default(),
    })
}

fn all<T>(values: Vec<Option<T>>) -> Option<Vec<T>> {
    values.into_iter().collect()
}

/// Reports names that appear twice.
struct Unique {
    what: &'static str,
    /// Key of the first of each name.
    seen: BTreeMap<String, String>,
}

impl Unique {
    fn new(what: &'static str) -> Self {
        Self { what, seen: BTreeMap::new() }
    }

    fn check(&mut self, table: Option<&Table<'_>>, key: &'static str, name: Option<&str>) {
        let (Some(table), Some(name)) = (table, name) else { return };
        match self.seen.get(name) {
            Some(first) => {
                let _: Option<()> = table.fail(
                    key,
                    format!("{} `{name}` appears twice, first in `{first}`", self.what),
                    "use every one at most once",
                );
            }
            None => {
                self.seen.insert(name.to_owned(), table.node.key.clone());
            }
        }
    }
}
