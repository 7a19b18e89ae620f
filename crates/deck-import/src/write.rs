//! The tables of the scene.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use stoss_mesh_io::deck::Deck;

use crate::bodies::{Bodies, Body};
use crate::history::{History, between_jumps};
use crate::section::PlaneSection;
use crate::set_names::Source;
use crate::text::{comment, count, list, number, string, vector};
use crate::timeline::Timeline;
use crate::{FileNames, LeftOut};

/// A function of time without jumps, with one column for each history: a number or list if it is constant, else a table.
pub(crate) fn series(columns: &[&History]) -> String {
    if columns.iter().all(|column| column.rows.len() <= 1) {
        let values: Vec<f64> = columns.iter().map(|column| column.at(0.0)).collect();
        return if let [value] = values.as_slice() { number(*value) } else { list(&values) };
    }
    let mut times: Vec<f64> = columns.iter().flat_map(|column| column.rows.iter().map(|row| row[0])).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let row = |&time: &f64| {
        let values: Vec<f64> = std::iter::once(time).chain(columns.iter().map(|column| column.at(time))).collect();
        list(&values)
    };
    let rows: Vec<String> = times.iter().map(row).collect();
    format!("{{ table = [{}] }}", rows.join(", "))
}

/// The tables of the scene that refer to sets, as text.
#[derive(Debug, Default)]
pub(crate) struct Tables {
    /// What plane elements are a section of.
    section: Option<&'static str>,
    /// Points and rigid bodies.
    parts: Vec<String>,
    /// Couplings, equations, joints, springs, supports.
    joined: Vec<String>,
    /// Number of each kind of these.
    numbers: BTreeMap<&'static str, usize>,
    ties: Vec<String>,
    contacts: Vec<String>,
    prescriptions: Vec<String>,
    loads: Vec<String>,
    /// Names of prescriptions and loads that act in some stages only, and whether they do in each.
    active: Vec<(String, Vec<bool>)>,
}

impl Tables {
    /// Tables without entries, for a scene of this section.
    pub fn of_section(section: Option<PlaneSection>) -> Self {
        Self { section: section.map(|section| section.name), ..Self::default() }
    }

    pub fn tie(&mut self, slave: &str, master: &str, keys: &[String]) {
        self.ties.push(pair("tie", &[], slave, master, keys));
    }

    /// A contact that acts in some stages only gets a name.
    pub fn contact(&mut self, slave: &str, master: &str, keys: &[String], active: &[bool]) {
        let name = self.name_of("contact", self.contacts.len(), active);
        let mut first = vec!["method = \"mortar\""];
        first.extend(name.lines());
        self.contacts.push(pair("contact", &first, slave, master, keys));
    }

    /// A table of a point or rigid body.
    pub fn part(&mut self, table: &str) {
        self.parts.push(table.to_owned());
    }

    /// The next number of a kind of table.
    fn next(&mut self, kind: &'static str) -> usize {
        let number = self.numbers.entry(kind).or_default();
        *number += 1;
        *number
    }

    /// A table with a name; of one that does not act in all stages it is noted.
    fn named(&mut self, table: &'static str, keys: &str, active: &[bool]) {
        let name = format!("{table}-{}", self.next(table));
        self.joined.push(format!("[[{table}]]\nname = {}\n{keys}", string(&name)));
        if active.contains(&false) {
            self.active.push((name, active.to_vec()));
        }
    }

    pub fn coupling(&mut self, kind: &str, set: &str, rigid: &str) {
        let keys = format!("kind = \"{kind}\"\nset = {}\nrigid = {}\n", string(set), string(rigid));
        self.named("coupling", &keys, &[]);
    }

    /// An equation of these terms, with a value over time.
    pub fn equation(&mut self, terms: &[String], value: Option<&History>, active: &[bool]) {
        let value = value.filter(|value| !value.is_zero());
        let value = value.map_or_else(String::new, |value| format!("value = {}\n", series(&[value])));
        self.named("equation", &format!("terms = [{}]\n{value}", terms.join(", ")), active);
    }

    pub fn joint(&mut self, kind: &str, keys: &str, active: &[bool]) {
        self.named("joint", &format!("kind = \"{kind}\"\n{keys}"), active);
    }

    pub fn spring(&mut self, keys: &str) {
        self.named("spring", keys, &[]);
    }

    pub fn support(&mut self, keys: &str) {
        self.next("support");
        self.joined.push(format!("[[support]]\n{keys}"));
    }

    /// A prescription that acts in some stages only gets a name.
    pub fn prescribe(&mut self, set: &str, along: &str, value: &str, active: &[bool], ramp_until: Option<f64>) {
        let name = self.name_of("support", self.prescriptions.len(), active);
        let mut table = format!("[[prescribe]]\n{name}");
        let _ = writeln!(table, "set = {}\n{along}\n{value}", string(set));
        if let Some(until) = ramp_until {
            let until = if until.is_finite() { number(until) } else { "inf".to_owned() };
            let _ = writeln!(table, "ramp_until = {until}");
        }
        self.prescriptions.push(table);
    }

    /// One load, or one for each part of the time between jumps, which acts in the stages of that part. On a `set` or a `body` with its name; `more`: further lines.
    pub fn load(
        &mut self,
        timeline: &Timeline,
        (key, on): (&str, &str),
        kind: &str,
        functions: &[&History],
        more: &str,
    ) {
        for (active, own) in between_jumps(functions, timeline) {
            if own.iter().all(History::is_zero) {
                continue;
            }
            let name = self.name_of("load", self.loads.len(), &active);
            let value = series(&own.iter().collect::<Vec<_>>());
            self.loads.push(format!("[[load]]\n{name}{key} = {}\n{kind} = {value}\n{more}", string(on)));
        }
    }

    /// The line with the name of the next thing of a kind; none if it acts in all stages.
    fn name_of(&mut self, kind: &str, count: usize, active: &[bool]) -> String {
        if !active.contains(&false) {
            return String::new();
        }
        let name = format!("{kind}-{}", count + 1);
        let line = format!("name = {}\n", string(&name));
        self.active.push((name, active.to_vec()));
        line
    }

    /// Lines that say what was mapped.
    pub fn mapped(&self, bodies: &Bodies, timeline: &Timeline) -> Vec<String> {
        let elements: usize = bodies.all.iter().map(|body| body.elements.len()).sum();
        let mut lines = vec![format!(
            "{} with {}",
            count(bodies.all.len(), "body", "bodies"),
            count(elements, "element", "elements")
        )];
        let laws: BTreeSet<String> =
            bodies.all.iter().map(|body| format!("material {}: {}", body.material, body.law.summary)).collect();
        lines.extend(laws);
        let dynamic = timeline.stages.iter().filter(|stage| stage.is_dynamic).count();
        let kinds = match (timeline.stages.len() - dynamic, dynamic) {
            (n, 0) => format!("{n} static"),
            (0, n) => format!("{n} dynamic"),
            (n, m) => format!("{n} static, {m} dynamic"),
        };
        lines.push(format!(
            "{} ({kinds}), to the time {}",
            count(timeline.stages.len(), "step", "steps"),
            number(timeline.end())
        ));
        let number = |kind: &str| self.numbers.get(kind).copied().unwrap_or(0);
        let tables = [
            (number("coupling"), "coupling", "couplings"),
            (number("equation"), "equation", "equations"),
            (number("joint"), "joint", "joints"),
            (number("spring"), "spring", "springs"),
            (number("support"), "elastic support", "elastic supports"),
            (self.prescriptions.len(), "prescribed motion", "prescribed motions"),
            (self.loads.len(), "load", "loads"),
            (self.contacts.len(), "contact", "contacts"),
            (self.ties.len(), "tie", "ties"),
        ];
        lines.extend(tables.iter().filter(|(n, ..)| *n > 0).map(|(n, one, many)| count(*n, one, many)));
        lines
    }
}

fn pair(table: &str, first: &[&str], slave: &str, master: &str, keys: &[String]) -> String {
    let mut text = format!("[[{table}]]\n");
    let own = [format!("slave = {}", string(slave)), format!("master = {}", string(master))];
    let lines = first.iter().map(|line| (*line).to_owned()).chain(own).chain(keys.iter().cloned());
    lines.for_each(|line| {
        let _ = writeln!(text, "{line}");
    });
    text
}

fn body(body: &Body, source: &Source, velocity: [f64; 3], is_dynamic: bool) -> String {
    let mut text = format!("[[body]]\nname = {}\n", string(&body.name));
    let group = source.group.as_ref().map_or(String::new(), |group| format!(", group = {}", string(group)));
    let _ = writeln!(text, "mesh = {{ file = {}{group} }}", string(&source.file));
    if body.is_reduced {
        text.push_str("integration = \"reduced\"\n");
    }
    if let Some(volumetric) = body.volumetric {
        let _ = writeln!(text, "volumetric = {}", string(volumetric));
    }
    let _ = writeln!(text, "material = {}", body.law.text);
    if let Some(density) = body.density {
        let _ = writeln!(text, "density = {}", number(density));
    }
    if let Some(damping) = body.damping.filter(|_| is_dynamic) {
        let keys =
            [("mass", damping.alpha), ("stiffness", damping.beta)].into_iter().filter(|(_, value)| *value != 0.0);
        let keys: Vec<String> = keys.map(|(key, value)| format!("{key} = {}", number(value))).collect();
        let _ = writeln!(text, "damping = {{ {} }}", keys.join(", "));
    }
    if is_dynamic && velocity != [0.0; 3] {
        let _ = writeln!(text, "velocity = {}", vector(velocity));
    }
    text
}

/// `[time]`, and `[[stage]]`s if there are several.
fn time(timeline: &Timeline, scene: &Tables) -> (String, String) {
    let stages = &timeline.stages;
    let step = stages.iter().map(|stage| stage.step_size).fold(f64::INFINITY, f64::min);
    let mut time = format!("[time]\nend = {}\nstep = {}\n", number(timeline.end()), number(step));
    if let Some(integrator) = stages.iter().find_map(|stage| stage.integrator.as_ref()) {
        let _ = writeln!(time, "integrator = {integrator}");
    }
    if let Some(cuts) = stages.iter().filter_map(|stage| stage.cuts).max() {
        let _ = writeln!(time, "max_cuts = {cuts}");
    }
    if let [stage] = stages.as_slice() {
        if let Some(automatic) = &stage.automatic {
            let _ = writeln!(time, "automatic = {automatic}");
        }
        return (time, String::new());
    }
    let mut text = String::new();
    for (s, stage) in stages.iter().enumerate() {
        let kind = if stage.is_dynamic { "dynamic" } else { "quasi-static" };
        let _ = writeln!(
            text,
            "[[stage]]\nname = {}\nkind = \"{kind}\"\nuntil = {}\nstep = {}",
            string(&stage.name),
            number(stage.end),
            number(stage.step_size)
        );
        if let Some(integrator) = &stage.integrator {
            let _ = writeln!(text, "integrator = {integrator}");
        }
        if let Some(automatic) = &stage.automatic {
            let _ = writeln!(text, "automatic = {automatic}");
        }
        let off: Vec<String> =
            scene.active.iter().filter(|(_, active)| !active[s]).map(|(name, _)| string(name)).collect();
        if !off.is_empty() {
            let _ = writeln!(text, "off = [{}]", off.join(", "));
        }
        text.push('\n');
    }
    (time, text)
}

/// The whole scene.
pub(crate) fn scene(
    deck: &Deck,
    names: &FileNames,
    bodies: &Bodies,
    sources: &[Source],
    velocities: &[[f64; 3]],
    timeline: &Timeline,
    tables: &Tables,
    mapped: &[String],
    left_out: &[LeftOut],
) -> String {
    let mut text = format!("# Written by `stoss import` from {}.\n#\n# Mapped:\n", comment(&names.deck));
    mapped.iter().for_each(|line| {
        let _ = writeln!(text, "#   {}", comment(line));
    });
    text.push_str(match left_out {
        [] => "# Nothing was left out.\n",
        _ => "#\n# What the deck has and this scene has not is in the tables [[left_out]]. `stoss check` and `stoss run` repeat it. While something is \"missing\"\n# (a load, a support, a constraint, a contact, a part) the verdict of a run is at best doubtful: add it, then remove its entry.\n",
    });
    left_out.iter().for_each(|entry| {
        let _ = write!(text, "\n{}", entry.table());
    });
    let title = deck.title.as_deref().map(str::trim).filter(|title| !title.is_empty()).unwrap_or(&names.deck);
    let kind = if timeline.is_dynamic() { "dynamic" } else { "quasi-static" };
    let section = tables.section.map_or(String::new(), |name| format!("section = \"{name}\"\n"));
    let _ = write!(text, "\n[scene]\ntitle = {}\nkind = \"{kind}\"\n{section}\n", string(&comment(title)));
    let (time, stages) = time(timeline, tables);
    let _ = writeln!(text, "{time}");
    for ((own, source), velocity) in bodies.all.iter().zip(sources).zip(velocities) {
        let _ = writeln!(text, "{}", body(own, source, *velocity, timeline.is_dynamic()));
    }
    for table in &tables.parts {
        let _ = writeln!(text, "{table}");
    }
    if bodies.all.len() > 1 && tables.contacts.is_empty() && tables.section.is_none() {
        text.push_str("# The deck names no contact.\n[general_contact]\nenabled = false\n\n");
    }
    for table in
        [&tables.joined, &tables.contacts, &tables.ties, &tables.prescriptions, &tables.loads].into_iter().flatten()
    {
        let _ = writeln!(text, "{table}");
    }
    text.push_str(&stages);
    let mut text = text.trim_end().to_owned();
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_of_time() {
        let constant = |value| History { active: vec![true], rows: vec![[0.0, value]], ramp_until: None };
        let ramp = History { rows: vec![[0.0, 0.0], [1.0, 2.0]], ..constant(0.0) };
        let late = History { rows: vec![[0.5, 0.0], [1.5, 1.0]], ..constant(0.0) };
        assert_eq!(series(&[&constant(3.0)]), "3.0");
        assert_eq!(series(&[&constant(3.0), &constant(1e-20)]), "[3.0, 1e-20]");
        assert_eq!(
            series(&[&ramp, &late]),
            "{ table = [[0.0, 0.0, 0.0], [0.5, 1.0, 0.0], [1.0, 2.0, 0.5], [1.5, 2.0, 1.0]] }"
        );
    }
}
