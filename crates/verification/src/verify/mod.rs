//! `cargo xtask verify`: measures, on runs of the program and on the crates themselves, and compares the results with
//! bounds.
//!
//! A suite is a [`Suite`] in its own file and a row in [`SUITES`]; `docs/how-to-add/verify-suite.md` has the recipe.

mod balance;
mod check;
mod conservation;
mod conserved;
mod curve;
mod elements;
mod facade;
mod figures;
mod friction;
mod general;
mod launch;
mod lean;
mod models;
mod mortar;
mod multibody;
mod newton;
mod numbers;
mod origin;
mod patch;
mod quadratic;
mod random;
mod report;
mod run;
mod scenes;
mod side_by_side;
mod stability;
mod statics;
mod tangents;
mod work_precision;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::program::{Ending, Program};
use crate::workspace::{Outcome, Workspace, write};
use check::Check;
pub use random::Range as RandomRange;
use report::ReportSection;
pub use run::Run;
use side_by_side::side_by_side;

/// Where everything goes, below the target folder.
const FOLDER: &str = "verify";

/// Number of steps of a shipped scene in quick mode.
const QUICK_STEPS: f64 = 60.0;

/// Scenes whose steps take a second, with the number of them in quick mode: what is checked there holds for each step by itself.
const QUICK_STEPS_OF: [(&str, f64); 2] = [("taylor-bar", 20.0), ("plastic-impact", 30.0)];

/// A group of checks.
pub trait Suite: Sync {
    /// Name on the command line.
    fn name(&self) -> &'static str;
    /// One sentence for the report.
    fn about(&self) -> &'static str;
    /// Runs what it needs and measures.
    fn measure(&self, bench: &Bench) -> Outcome<Findings>;
}

/// Every suite, in the order of the report. The long ones are at the end: they are begun first.
const SUITES: &[&dyn Suite] = &[
    &tangents::Tangents,
    &conservation::Conservation,
    &patch::Patch,
    &elements::Elements,
    &friction::FrictionSuite,
    &general::General,
    &mortar::Mortar,
    &multibody::Multibody,
    &work_precision::WorkPrecision,
    &stability::Stability,
    &statics::Statics,
    &lean::Lean,
    &random::Random,
    &scenes::Scenes,
];

/// What a suite found.
#[derive(Debug, Default)]
pub struct Findings {
    /// Rows of the table.
    pub checks: Vec<Check>,
    /// Figures and tables of the report.
    pub sections: Vec<ReportSection>,
    /// Runs whose figures are shown, once for all suites.
    runs: Vec<Run>,
}

/// Runs scenes for the suites, each at most once; the program is built for the first of them.
#[derive(Debug)]
pub struct Bench {
    /// The repository.
    pub workspace: Workspace,
    /// True if long scenes are shortened.
    pub quick: bool,
    /// Which random scenes the suite `random` runs.
    pub random: random::Range,
    /// Problems of the suite `work-precision`; all if none is named.
    pub problems: Vec<String>,
    folder: PathBuf,
    program: Mutex<Option<Program>>,
    runs: Mutex<BTreeMap<String, Arc<Mutex<Option<Run>>>>>,
    /// Seconds of every run of the program, and its name.
    durations: Mutex<Vec<(f64, String)>>,
}

/// A lock whose holder may have panicked: what it guards is whole at any time.
fn hold<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Bench {
    /// Builds nothing yet: a suite that runs no scene needs no program.
    pub fn new(workspace: &Workspace, quick: bool) -> Outcome<Self> {
        let folder = workspace.target()?.join(FOLDER);
        Ok(Self {
            workspace: workspace.clone(),
            quick,
            random: random::Range::default(),
            problems: Vec::new(),
            folder,
            program: Mutex::default(),
            runs: Mutex::default(),
            durations: Mutex::default(),
        })
    }

    /// Runs a shipped scene (path from the root); in quick mode no more than [`QUICK_STEPS`] steps of it after its first contact, or those of [`QUICK_STEPS_OF`].
    pub fn run_shipped(&self, scene: &Path) -> Outcome<Run> {
        let name = scene.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let steps = QUICK_STEPS_OF.iter().find(|(scene, _)| *scene == name).map_or(QUICK_STEPS, |(_, steps)| *steps);
        let until = if self.quick { quick_end(&self.scene(&name)?, steps) } else { None };
        self.run(scene, until)
    }

    /// True if this problem of the suite `work-precision` is to be run.
    pub fn is_asked(&self, problem: &str) -> bool {
        self.problems.is_empty() || self.problems.iter().any(|name| name == problem)
    }

    /// The program, built when it is first needed.
    fn program(&self) -> Outcome<Program> {
        let mut program = hold(&self.program);
        if program.is_none() {
            *program = Some(Program::build(&self.workspace)?);
        }
        program.clone().ok_or_else(|| "no program".into())
    }

    fn run(&self, scene: &Path, until: Option<f64>) -> Outcome<Run> {
        let name = scene.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        // Two threads that want the same run: the second one waits for it.
        let place = Arc::clone(hold(&self.runs).entry(name.clone()).or_default());
        let mut place = hold(&place);
        if let Some(run) = place.as_ref().filter(|run| run.until == until) {
            return Ok(run.clone());
        }
        let folder = self.folder.join("runs").join(&name);
        let ending = self.program()?.run(scene, &folder, until)?;
        println!("verify: ran {name} in {:.1} s", ending.seconds);
        self.count(&name, ending);
        let run = Run { name, folder, ending, until };
        *place = Some(run.clone());
        Ok(run)
    }

    /// Runs a scene made from a shipped one.
    pub fn run_variant(&self, name: &str, scene: &toml::Table) -> Outcome<Run> {
        let path = self.folder.join("scenes").join(format!("{name}.toml"));
        write(&path, &toml::to_string(scene)?)?;
        self.run(&path, None)
    }

    /// Asks for the figures of a run; they come once, in the first suite that asks.
    pub fn show(&self, run: &Run, findings: &mut Findings) {
        findings.runs.push(run.clone());
    }

    /// Figures of a run.
    fn figures(&self, run: &Run) -> Outcome<ReportSection> {
        let shipped = self.workspace.read(format!("scenes/{}.toml", run.name)).ok();
        figures::section(run, shipped.map(|text| header(&text)).unwrap_or_default())
    }

    /// A shipped scene as data.
    pub fn scene(&self, name: &str) -> Outcome<toml::Table> {
        let file = format!("scenes/{name}.toml");
        self.workspace.read(&file)?.parse().map_err(|error| format!("{file}: {error}").into())
    }

    /// Keeps how long a run took.
    fn count(&self, name: &str, ending: Ending) {
        hold(&self.durations).push((ending.seconds, name.to_owned()));
    }
}

/// What a shipped scene says of itself: the first paragraph of its header, and what it expects, with its source.
fn header(scene: &str) -> String {
    let lines: Vec<&str> = scene.lines().map_while(|line| line.strip_prefix('#')).map(str::trim).collect();
    let words = |lines: &[&str]| lines.join(" ");
    let first = lines.iter().position(|line| line.is_empty()).unwrap_or(lines.len());
    let expected = lines.iter().position(|line| line.starts_with("Expect:")).unwrap_or(lines.len());
    let end = lines[expected..].iter().position(|line| line.is_empty()).map_or(lines.len(), |end| expected + end);
    format!("{} {}", words(&lines[..first]), words(&lines[expected..end])).trim().to_owned()
}

/// The time at which quick mode stops a scene; `None` if it is short anyway.
fn quick_end(scene: &toml::Table, steps: f64) -> Option<f64> {
    let time = scene.get("time")?;
    let number = |key: &str| time.get(key).and_then(|value| value.as_float().or(value.as_integer().map(|n| n as f64)));
    let (end, step) = (number("end")?, number("step")?);
    // What is to be seen in contact needs contact.
    let contact = scene.get("expect").and_then(|expect| expect.get("first_contact")?.get("to")?.as_float());
    // Rounded, so that the table and the command line show a short number.
    let shortened = ((contact.unwrap_or(0.0) + steps * step) * 1e9).round() / 1e9;
    (shortened < end).then_some(shortened)
}

/// What is run.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Names of suites; all if none is given.
    pub suites: Vec<String>,
    /// True if long scenes are shortened.
    pub quick: bool,
    /// Which random scenes the suite `random` runs.
    pub random: random::Range,
    /// Problems of the suite `work-precision`; all if none is given.
    pub problems: Vec<String>,
}

/// Runs the selected suites; false if a check falls short.
pub fn command(workspace: &Workspace, selection: Selection) -> Outcome<bool> {
    let Selection { suites: names, quick, random, problems } = selection;
    work_precision::is_known(&problems)?;
    let known: Vec<&str> = SUITES.iter().map(|suite| suite.name()).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(format!("no suite {name:?}; there are {}", known.join(", ")).into());
    }
    let bench = Bench { random, problems, ..Bench::new(workspace, quick)? };
    let is_chosen = |suite: &&&dyn Suite| names.is_empty() || names.iter().any(|name| name == suite.name());
    let chosen: Vec<&dyn Suite> = SUITES.iter().filter(is_chosen).copied().collect();
    // The times of a whole report are measured alone.
    let threads = if quick { std::thread::available_parallelism().map_or(1, usize::from) } else { 1 };
    let measure = |suite: &&'static dyn Suite| {
        let start = Instant::now();
        // A suite that cannot measure falls short; the others still run.
        let findings = suite.measure(&bench).unwrap_or_else(|error| {
            let failed = Check::new(suite.name(), "could be measured", f64::NAN, check::Bound::AtLeast(1.0));
            Findings { checks: vec![failed.noted(error.to_string())], ..Findings::default() }
        });
        println!("verify: suite {} in {:.1} s", suite.name(), start.elapsed().as_secs_f64());
        (*suite, findings)
    };
    let mut results = side_by_side(&chosen, threads, measure);
    draw(&bench, threads, &mut results);
    print!("{}", report::text(&results));
    let html = bench.folder.join("report.html");
    let origin = origin::Origin::find(workspace);
    write(&html, &report::html(&results, quick, &origin))?;
    write(&bench.folder.join("report.json"), &report::json(&results, quick, &origin)?)?;
    let checks: Vec<&Check> = results.iter().flat_map(|(_, findings)| &findings.checks).collect();
    let short = checks.iter().filter(|check| !check.holds()).count();
    let mut runs = std::mem::take(&mut *hold(&bench.durations));
    runs.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("\nten slowest of {} runs of the program:", runs.len());
    runs.iter().take(10).for_each(|(seconds, name)| println!("{seconds:.1} s  {name}"));
    println!(
        "verify: {} checks, {short} fall short, {:.1} s of runs; report in {}",
        checks.len(),
        runs.iter().map(|(seconds, _)| seconds).sum::<f64>(),
        html.display()
    );
    Ok(short == 0 && !checks.is_empty())
}

/// Adds the figures of the runs that the suites ask for.
fn draw(bench: &Bench, threads: usize, results: &mut [(&'static dyn Suite, Findings)]) {
    let mut drawn = BTreeSet::new();
    let asked = results
        .iter_mut()
        .enumerate()
        .flat_map(|(k, (_, found))| std::mem::take(&mut found.runs).into_iter().map(move |run| (k, run)));
    let asked: Vec<(usize, Run)> = asked.filter(|(_, run)| drawn.insert(run.name.clone())).collect();
    let sections = side_by_side(&asked, threads, |(_, run)| bench.figures(run).map_err(|error| error.to_string()));
    for ((k, run), section) in asked.iter().zip(sections) {
        let findings = &mut results[*k].1;
        match section {
            Ok(section) => findings.sections.push(section),
            Err(error) => {
                let failed = Check::new(&run.name, "could be drawn", f64::NAN, check::Bound::AtLeast(1.0));
                findings.checks.push(failed.noted(error));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_long_scenes_are_shortened() {
        let end = |text: &str| quick_end(&text.parse().unwrap(), 60.0);
        assert_eq!(end("[time]\nend = 1.0\nstep = 0.01"), Some(0.6));
        assert_eq!(end("[time]\nend = 1\nstep = 0.5"), None);
        let contact = "[expect]\nfirst_contact = { from = 0.1, to = 0.2 }";
        assert_eq!(end(&format!("[time]\nend = 1.0\nstep = 0.01\n{contact}")), Some(0.8));
        assert_eq!(end(&format!("[time]\nend = 0.7\nstep = 0.01\n{contact}")), None);
        assert_eq!(end("[scene]\ntitle = \"a\""), None);
    }

    #[test]
    fn a_scene_says_what_to_expect() {
        let text = "# A ball falls.\n#\n#   o\n#\n# Run: x\n# Expect:  it stops,\n#          late.\n# Source:  A. N.\n\n[scene]";
        assert_eq!(header(text), "A ball falls. Expect:  it stops, late. Source:  A. N.");
        assert_eq!(header("[scene]"), "");
    }

    #[test]
    fn suites_have_different_names() {
        let names: BTreeSet<&str> = SUITES.iter().map(|suite| suite.name()).collect();
        assert_eq!(names.len(), SUITES.len());
    }
}
