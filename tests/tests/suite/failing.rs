//! Scenes that stop or come out wrong are diagnosed rightly: cause, place, and a remedy, which is applied where it is a change of the scene.

use std::path::Path;
use stoss::diagnosis::{Cause, Change, Confidence, Diagnosis, LikelyCause};
use stoss::output::{Outcome, Summary};
use stoss::run::{Event, RunError, RunOptions, check_scene, diagnose_scene, run_scene};
use stoss::watch::Severity;

pub(crate) fn text_of(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("failing").join(format!("{name}.toml"));
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// What a run leaves.
pub(crate) struct Left {
    pub(crate) result: Result<Summary, RunError>,
    pub(crate) diagnosis: Option<Diagnosis>,
}

pub(crate) fn run(text: &str) -> Left {
    run_until(text, None)
}

/// [`run`] up to a time.
pub(crate) fn run_until(text: &str, until: Option<f64>) -> Left {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    let options = RunOptions { out: folder.path().join("out"), until, ..RunOptions::default() };
    let mut told = None;
    let result = run_scene(&scene, &options, &mut |event| {
        if let Event::Diagnosis(diagnosis) = event {
            told = Some(diagnosis.clone());
        }
    });
    // What the folder keeps is what was told.
    assert_eq!(Diagnosis::read(&options.out).unwrap(), told);
    Left { result, diagnosis: told }
}

/// A scene that runs to its end, with a verdict that is sound.
pub(crate) fn comes_out_well(text: &str) {
    let summary = run(text).result.unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!((summary.outcome, summary.verdict.level), (Outcome::Completed, Severity::Sound), "{}", summary.verdict);
}

/// The first finding of a scene that stops or comes out wrong.
pub(crate) fn diagnosed(name: &str) -> (LikelyCause, Diagnosis) {
    diagnosis_of(name, &run(&text_of(name)))
}

/// The first finding of a run that is over.
fn diagnosis_of(name: &str, Left { result, diagnosis }: &Left) -> (LikelyCause, Diagnosis) {
    let bad = match result {
        Err(RunError::Simulation { .. }) => true,
        Ok(summary) => summary.verdict.level == Severity::Wrong,
        Err(other) => panic!("{name}: {other}"),
    };
    assert!(bad, "{name} came out well");
    let diagnosis = diagnosis.clone().unwrap_or_else(|| panic!("{name}: no diagnosis"));
    let lines = diagnosis.to_string().lines().count();
    assert!((4..=12).contains(&lines), "{name}: {diagnosis}");
    (diagnosis.findings[0].clone(), diagnosis)
}

pub(crate) fn is_cause(finding: &LikelyCause, cause: Cause) {
    assert_eq!((finding.cause, finding.confidence), (cause, Confidence::High), "{finding:#?}");
    assert!(
        !finding.remedies.is_empty() && !finding.evidence.is_empty() && !finding.place.text.is_empty(),
        "{finding:#?}"
    );
}

/// A key path such as `body[0].material.mu`.
fn set(table: &mut toml::Table, key: &str, value: toml::Value) {
    let (first, rest) = key.split_once('.').map_or((key, None), |(first, rest)| (first, Some(rest)));
    let (name, index) = match first.split_once('[') {
        Some((name, index)) => (name, index.trim_end_matches(']').parse::<usize>().ok()),
        None => (first, None),
    };
    let Some(rest) = rest else {
        table.insert(name.to_owned(), value);
        return;
    };
    let entry = table.entry(name).or_insert_with(|| toml::Value::Table(toml::Table::new()));
    let inner = match index {
        Some(index) => &mut entry.as_array_mut().unwrap()[index],
        None => entry,
    };
    set(inner.as_table_mut().unwrap(), rest, value);
}

/// The scene with the changes of the first remedy.
fn mended(text: &str, finding: &LikelyCause, remedy: usize) -> String {
    let mut table: toml::Table = text.parse().unwrap();
    let mut added = String::new();
    let changes = &finding.remedies[remedy].changes;
    assert!(!changes.is_empty(), "{finding:#?}");
    for change in changes {
        match change {
            Change::Set { key, value } => {
                let parsed: toml::Table = format!("value = {value}").parse().unwrap();
                set(&mut table, key, parsed["value"].clone());
            }
            Change::Add { toml } => added += &format!("\n{toml}"),
        }
    }
    toml::to_string(&table).unwrap() + &added
}

/// The scene with the changes of a remedy runs to its end, and nothing certain is said about it.
pub(crate) fn is_mended(name: &str, finding: &LikelyCause, remedy: usize) {
    let text = mended(&text_of(name), finding, remedy);
    let Left { result, diagnosis } = run(&text);
    let summary = result.unwrap_or_else(|e| panic!("{name}: {e}\n{text}"));
    assert_eq!(summary.outcome, Outcome::Completed, "{name}: {}", summary.verdict);
    assert_ne!(summary.verdict.level, Severity::Wrong, "{name}: {}", summary.verdict);
    let causes = diagnosis.map(|d| d.findings).unwrap_or_default();
    assert!(causes.iter().all(|other| other.confidence != Confidence::High), "{name}: {causes:#?}");
}

/// An impact with Newmark's method: the watch and the diagnosis name the gain of energy, also where the run stops because of what the energy did, and the energy-momentum scheme mends it.
#[test]
fn a_scheme_that_gains_energy() {
    let left = run(&text_of("scheme-gains-energy"));
    let (finding, diagnosis) = diagnosis_of("scheme-gains-energy", &left);
    is_cause(&finding, Cause::SchemeGainsEnergy);
    assert!(finding.sentence.contains("`newmark`") && finding.sentence.contains("impacts"), "{diagnosis}");
    is_mended("scheme-gains-energy", &finding, 0);
    // What stopped the run has its verdict with it.
    if let Err(RunError::Simulation { verdict, .. }) = left.result {
        assert_eq!(verdict.level, Severity::Wrong, "{verdict}");
    }
}

#[test]
fn a_body_without_support() {
    let (finding, _) = diagnosed("no-support");
    is_cause(&finding, Cause::NoSupport);
    assert_eq!(finding.place.body.as_deref(), Some("block"));
    assert!(finding.place.node.is_some() && finding.place.position.is_some());
    assert!(finding.sentence.contains("free to slide along y and z and to turn about x"), "{}", finding.sentence);
    is_mended("no-support", &finding, 0);
    is_mended("no-support", &finding, 1);
}

/// A body that contact has to hold once it is closed is stabilised until then; what contact without friction never holds is prescribed, and nothing else.
#[test]
fn a_body_that_only_contact_can_hold() {
    let touching = text_of("touching");
    let gap = touching.replace("min = [0, 0, 0], max = [1, 1, 1]", "min = [0, 0, 0.05], max = [1, 1, 1.05]");
    assert_ne!(touching, gap);
    let friction = format!("{gap}friction = {{ law = \"coulomb\", mu = 0.3 }}\n");
    let stage = "[[stage]]\nname = \"press\"\nkind = \"quasi-static\"\nuntil = 1.0\n[[contact]]";
    let staged = friction.replacen("[[contact]]", stage, 1);
    // Friction holds what comes down.
    for text in [&friction, &staged] {
        let summary = run(text).result.unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!((summary.outcome, summary.verdict.level), (Outcome::Completed, Severity::Sound));
    }
    for (text, key, more) in [(&touching, "time.stabilise", true), (&gap, "time.stabilise", true)] {
        let Left { result, diagnosis } = run(text);
        assert!(matches!(result, Err(RunError::Simulation { .. })), "{text}");
        let finding = diagnosis.unwrap().findings[0].clone();
        is_cause(&finding, Cause::NoSupport);
        let [Change::Set { key: found, .. }, rest @ ..] = &finding.remedies[0].changes[..] else {
            panic!("{finding:#?}")
        };
        assert_eq!(found, key);
        match rest {
            [] => assert!(!more, "{finding:#?}"),
            [Change::Add { toml }] => assert!(more && toml.contains("[\"x\", \"y\"]"), "{toml}"),
            _ => panic!("{finding:#?}"),
        }
        let Left { result, .. } = run(&mended(text, &finding, 0));
        let summary = result.unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(
            (summary.outcome, summary.verdict.level),
            (Outcome::Completed, Severity::Sound),
            "{}",
            summary.verdict
        );
    }
}

/// Springs of a support hold their directions only, and dashpots nothing.
#[test]
fn supports_that_leave_motions_free() {
    let text = r#"
[scene]
title = "a foundation that holds one direction"
kind = "quasi-static"
[time]
end = 1.0
step = 1.0
max_cuts = 1
[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
material = { law = "neo-hooke", young = 1e6, poisson = 0.3 }
[[support]]
set = "block.bottom"
stiffness = [0.0, 0.0, 1e5]
damping = [10.0, 10.0, 10.0]
[[load]]
set = "block.top"
total_force = [0.0, 0.0, -10.0]
"#;
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    let plan = check_scene(&scene).unwrap().to_string();
    assert!(plan.contains("3 of 6 rigid motions are free"), "{plan}");
    let Left { result, diagnosis } = run(text);
    assert!(matches!(result, Err(RunError::Simulation { .. })));
    let finding = diagnosis.unwrap().findings[0].clone();
    is_cause(&finding, Cause::NoSupport);
    assert!(finding.sentence.contains("free to slide along x and y and to turn about z"), "{}", finding.sentence);
    let Left { result, diagnosis } = run(&text.replace("[0.0, 0.0, 1e5]", "[1e3, 1e3, 1e5]"));
    assert_eq!((result.unwrap().verdict.level, diagnosis), (Severity::Sound, None));
}

#[test]
fn a_free_rotation() {
    let (finding, _) = diagnosed("free-rotation");
    is_cause(&finding, Cause::FreeRotation);
    assert_eq!(finding.place.body.as_deref(), Some("flap"));
    assert!(finding.sentence.contains("free to turn about y through (0.0000, "), "{}", finding.sentence);
    // What turns most is the far end, across the plate.
    let [Change::Add { toml }] = &finding.remedies[0].changes[..] else { panic!("{finding:#?}") };
    assert!(toml.contains("flap.right") && toml.contains("[\"z\"]"), "{toml}");
    is_mended("free-rotation", &finding, 0);
}

/// A rigid body on a hinge, in statics.
#[test]
fn a_free_rotation_of_a_joint() {
    let text = r#"
[scene]
title = "a pendulum without weight"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
max_cuts = 1
[[rigid]]
name = "crank"
mass = 1.0
euler = [0.1, 0.1, 0.1]
centre = [0.0, 0.5, 0.0]
[[joint]]
name = "bearing"
kind = "hinge"
between = ["ground", "crank"]
at = [0, 0, 0]
axis = [0, 0, 1]
[[load]]
set = "crank.all"
force = [1.0, 0.0, 0.0]
"#;
    let Left { result, diagnosis } = run(text);
    assert!(matches!(result, Err(RunError::Simulation { .. })));
    let finding = diagnosis.unwrap().findings[0].clone();
    assert_eq!((finding.cause, finding.place.body.as_deref()), (Cause::FreeRotation, Some("crank")), "{finding:#?}");
    assert!(finding.sentence.contains("free to turn about z through (0.0000, 0.0000, 0.0000)"), "{}", finding.sentence);
}

#[test]
fn a_density_that_is_a_thousand_times_too_large() {
    // The run is sound: nothing moves. It is reported all the same.
    let Left { result, diagnosis } = run(&text_of("density"));
    assert_eq!(result.unwrap().verdict.level, Severity::Sound);
    let finding = diagnosis.unwrap().findings[0].clone();
    is_cause(&finding, Cause::Density);
    assert_eq!(finding.place.body.as_deref(), Some("plate"));
    assert!(finding.sentence.contains("7.85e-6") && finding.evidence[1].contains("steel"), "{finding:#?}");
    let right = [Change::Set { key: "body[0].density".into(), value: "7.85e-9".into() }];
    assert_eq!(finding.remedies[0].changes, right);
    is_mended("density", &finding, 0);
    // Without units it is only likely.
    let Left { diagnosis, .. } = run(&text_of("density").replace("units = \"mm-t-s\"", ""));
    let finding = diagnosis.unwrap().findings[0].clone();
    assert_eq!((finding.cause, finding.confidence), (Cause::Density, Confidence::Medium), "{finding:#?}");
    assert_eq!(finding.remedies[0].changes, right);
    // Before the run it is reported once, with units and without.
    for units in ["units = \"mm-t-s\"", ""] {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.toml");
        std::fs::write(&scene, text_of("density").replace("units = \"mm-t-s\"", units)).unwrap();
        let plan = check_scene(&scene).unwrap().to_string();
        assert_eq!(plan.lines().filter(|line| line.contains("the density")).count(), 1, "{plan}");
    }
}

/// Kilograms per cubic metre among newtons and millimetres: nothing moves in the time of the run. With the weight of the earth the body is crushed.
#[test]
fn a_density_in_si_units_among_millimetres() {
    let text = text_of("density").replace("7.85e-6", "7850.0");
    let of = |text: &str| run(text).diagnosis.map(|diagnosis| diagnosis.findings[0].clone());
    let finding = of(&text).unwrap();
    is_cause(&finding, Cause::Density);
    assert!(finding.sentence.contains("the density 7850 of"), "{}", finding.sentence);
    let weight = "[gravity]\nacceleration = [0.0, 0.0, -9810.0]\n[[body]]";
    let heavy = text.replacen("[[body]]", weight, 1).replace("units = \"mm-t-s\"", "");
    is_cause(&of(&heavy).unwrap(), Cause::Density);
    // Steel in mm, t, s, and in m, kg, s, with its weight: nothing to say.
    assert_eq!(of(&text_of("density").replace("7.85e-6", "7.85e-9").replacen("[[body]]", weight, 1)), None);
    let metres = heavy.replace("210000.0", "2.1e11").replace("9810", "9.81");
    assert_eq!(of(&metres), None);
}

/// Steel in units that few use, told or not, is correct.
#[test]
fn right_data_in_rare_units_are_no_mistake() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    for (units, young, density) in [
        ("mm-kg-s", "2.1e8", "7.85e-6"),
        ("um-kg-s", "2.1e5", "7.85e-15"),
        ("cm-g-us", "2.1", "7.85"),
        ("in-lbf-s", "3.0e7", "7.35e-4"),
    ] {
        let text = text_of("density").replace("210000.0", young).replace("7.85e-6", density);
        for line in [format!("units = \"{units}\""), String::new()] {
            std::fs::write(&scene, text.replace("units = \"mm-t-s\"", &line)).unwrap();
            let found = diagnose_scene(&scene, &RunOptions::default()).unwrap().findings;
            assert_eq!(found, [], "{units} {line}");
        }
    }
    // A number that is right in other units is wrong in these.
    let text = text_of("density").replace("mm-t-s", "mm-kg-s").replace("210000.0", "2.1e8");
    std::fs::write(&scene, text.replace("7.85e-6", "7.85e-9")).unwrap();
    let found = diagnose_scene(&scene, &RunOptions::default()).unwrap().findings;
    assert_eq!(found[0].cause, Cause::Density, "{found:#?}");
}

/// What the error says, and what the diagnosis says: of one cause.
fn of_error(text: &str) -> (String, LikelyCause) {
    let Left { result, diagnosis } = run(text);
    let error = result.unwrap_err().to_string();
    (error, diagnosis.unwrap().findings[0].clone())
}

#[test]
fn a_load_that_is_there_at_once() {
    let (finding, _) = diagnosed("load-at-once");
    is_cause(&finding, Cause::LoadAtOnce);
    let value = "{ table = [[0.0, 0.0], [1.0, 200.0]] }".to_owned();
    assert_eq!(finding.remedies[0].changes, [Change::Set { key: "load[0].pressure".into(), value }]);
    let (error, _) = of_error(&text_of("load-at-once"));
    assert!(
        error.contains("load[0] pressure is applied in full at the start") && error.contains("begins with zero"),
        "{error}"
    );
    // From zero it runs, with the cuts that the scene allows, or with smaller steps.
    let Left { result, .. } = run(&mended(&text_of("load-at-once"), &finding, 0));
    assert_eq!(result.unwrap().outcome, Outcome::Completed);
}

#[test]
fn reduced_elements_in_a_single_row() {
    let (finding, _) = diagnosed("single-row");
    is_cause(&finding, Cause::ZeroEnergyModes);
    assert_eq!(finding.place.body.as_deref(), Some("beam"));
    let (error, _) = of_error(&text_of("single-row"));
    assert!(error.contains("single row of elements"), "{error}");
    is_mended("single-row", &finding, 0);
}

#[test]
fn pressures_in_the_middle_of_faces() {
    comes_out_well(&text_of("redundant-pressures"));
    // Also where nothing but contact carries the upper block: the pressure is what is not determined, and not the motion.
    let free = text_of("redundant-pressures").replace(
        "components = [\"x\", \"y\", \"z\"]\ndisplacement = { table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -0.05]] }",
        "components = [\"x\", \"y\"]\nfixed = true",
    ) + "\n[[load]]\nset = \"upper.top\"\npressure = { table = [[0.0, 0.0], [1.0, 10.0]] }\n";
    comes_out_well(&free);
}

/// Support and contact share a force, and which part each has is not determined; the motion is.
#[test]
fn a_support_on_the_slave_of_a_contact() {
    let text = text_of("held-twice");
    for method in ["nts", "mortar"] {
        for normal in ["[0, \"-sin(pi / 6)\", \"cos(pi / 6)\"]", "[0, \"-sin(pi / 6) + 1e-3\", \"cos(pi / 6)\"]"] {
            let text = text.replace("\"nts\"", &format!("\"{method}\"")).replacen(
                "[0, \"-sin(pi / 6)\", \"cos(pi / 6)\"]",
                normal,
                1,
            );
            comes_out_well(&text);
        }
    }
    // Without the support the contact holds it.
    let without = text.replace("set = \"upper.bottom\"\nnormal", "set = \"upper.back\"\nnormal").replacen(
        "[0, \"-sin(pi / 6)\", \"cos(pi / 6)\"]",
        "[0, \"cos(pi / 6)\", \"sin(pi / 6)\"]",
        1,
    );
    assert_eq!(run(&without).result.unwrap().outcome, Outcome::Completed);
}

#[test]
fn surfaces_that_face_away() {
    let (finding, _) = diagnosed("facing-away");
    is_cause(&finding, Cause::SurfacesFaceAway);
    assert_eq!(finding.place.pair.as_deref(), Some("impact"));
    let key = |key: &str, value: &str| Change::Set { key: key.into(), value: format!("\"{value}\"") };
    let wanted = [key("contact[0].slave", "upper.bottom"), key("contact[0].master", "lower.top")];
    assert_eq!(finding.remedies[0].changes, wanted);
    is_mended("facing-away", &finding, 0);
}

#[test]
fn a_step_that_is_too_large() {
    let (finding, diagnosis) = diagnosed("step-too-large");
    is_cause(&finding, Cause::StepTooLarge);
    assert_eq!(finding.place.body.as_deref(), Some("bar"));
    assert!(!diagnosis.attempts.is_empty() && diagnosis.attempts[0].residuals.len() > 1, "{diagnosis:#?}");
    is_mended("step-too-large", &finding, 0);
    is_mended("step-too-large", &finding, 1);
}

/// A pressure of five times the modulus. No smaller step than the smallest that failed is offered as a remedy, here and where nothing is known.
#[test]
fn a_load_that_is_too_large() {
    let (finding, _) = diagnosed("load-too-large");
    is_cause(&finding, Cause::LoadTooLarge);
    assert_eq!(finding.place.body.as_deref(), Some("block"));
    assert!(finding.sentence.contains("5.0 times"), "{}", finding.sentence);
    // What is not of the order of the modulus is not too large.
    let small = text_of("load-too-large").replace("5000.0", "5.0");
    let Left { result, diagnosis } = run(&small);
    assert_eq!((result.unwrap().verdict.level, diagnosis), (Severity::Sound, None));
}

/// A cantilever that is bent over itself: a load of a hundredth of the modulus is not seen to be too large. It grows from zero, before the end of the smallest step: a load that is
/// applied in full at the start is a cause of its own.
#[test]
fn where_nothing_is_known_no_step_is_offered_that_failed_already() {
    let bent =
        text_of("load-too-large").replace("pressure = 5000.0", "pressure = { table = [[0.0, 0.0], [1e-3, 250.0]] }");
    let of = |text: &str| {
        let Left { result, diagnosis } = run(text);
        assert!(matches!(result, Err(RunError::Simulation { .. })));
        diagnosis.unwrap()
    };
    let is_step = |change: &Change| matches!(change, Change::Set { key, .. } if key == "time.step");
    for (cuts, offered) in [("max_cuts = 3", false), ("max_cuts = 0", true)] {
        let diagnosis = of(&bent.replace("max_cuts = 3", cuts));
        let finding = &diagnosis.findings[0];
        assert_eq!((finding.cause, finding.confidence), (Cause::Unknown, Confidence::Low), "{finding:#?}");
        assert_eq!(finding.remedies.iter().flat_map(|r| &r.changes).any(is_step), offered, "{finding:#?}");
        assert!(diagnosis.to_string().starts_with("diagnosis: the cause is not known\n"), "{diagnosis}");
    }
}

/// A run that ended, of which no cause is known, has its verdict and no diagnosis.
#[test]
fn a_doubtful_run_without_a_known_cause_has_no_diagnosis() {
    let pressed = text_of("touching").replace("[gravity]\nacceleration = [0.0, 0.0, -9.81]\n", "")
        + "enforcement = { penalty = 1e7 }\n[[prescribe]]\nname = \"press\"\nset = \"block.top\"\ncomponents = [\"x\", \"y\", \"z\"]\n\
           displacement = { table = [[0, 0, 0, 0], [1, 0, 0, -0.1]] }\n[watch]\nlimit = 0.02\n";
    let Left { result, diagnosis } = run(&pressed);
    let summary = result.unwrap();
    assert_ne!(summary.verdict.level, Severity::Sound);
    assert_eq!((summary.outcome, diagnosis), (Outcome::Completed, None), "{}", summary.verdict);
}

#[test]
fn an_overlap_at_the_start() {
    let (finding, _) = diagnosed("overlap");
    is_cause(&finding, Cause::OverlapAtStart);
    assert_eq!(finding.place.pair.as_deref(), Some("impact"));
    assert!(finding.place.position.is_some());
    is_mended("overlap", &finding, 0);
}

/// Refused before it runs: by its key, with cause and remedy. What is a little below one half is reported if it does not come out well.
#[test]
fn an_incompressible_body() {
    let Err(RunError::Scene(errors)) = run(&text_of("incompressible")).result else { panic!("it was not refused") };
    let [problem] = errors.problems() else { panic!("{errors}") };
    assert_eq!((problem.key.as_str(), problem.line), ("body[0].material.poisson", 13));
    assert!(problem.message.contains("incompressible") && problem.remedy.contains("0.49"), "{problem}");
    let nearly = text_of("incompressible").replace("poisson = 0.5", "poisson = 0.4999");
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, &nearly).unwrap();
    let found = diagnose_scene(&scene, &RunOptions::default()).unwrap().findings;
    assert!(found.iter().any(|finding| finding.cause == Cause::Incompressible), "{found:#?}");
    let finding = found.iter().find(|finding| finding.cause == Cause::Incompressible).unwrap();
    std::fs::write(&scene, mended(&nearly, finding, 0)).unwrap();
    assert!(diagnose_scene(&scene, &RunOptions::default()).unwrap().findings.is_empty());
}

/// A nearly incompressible body stops, and runs with averages of the change of volume as well as with a smaller bulk modulus.
#[test]
fn a_nearly_incompressible_body() {
    let (finding, _) = diagnosed("nearly-incompressible");
    assert_eq!((finding.cause, finding.confidence), (Cause::Incompressible, Confidence::Medium), "{finding:#?}");
    assert_eq!(finding.place.body.as_deref(), Some("rubber"));
    is_mended("nearly-incompressible", &finding, 0);
    is_mended("nearly-incompressible", &finding, 1);
}

/// A node of the slave at the rim of the master that opens and closes.
#[test]
fn contact_points_that_open_and_close() {
    let (finding, diagnosis) = diagnosed("contact-cycles");
    assert_eq!((finding.cause, finding.confidence), (Cause::OpenRim, Confidence::Medium), "{finding:#?}");
    assert_eq!((finding.place.pair.as_deref(), finding.place.body.as_deref()), (Some("press"), Some("slab")));
    assert!(finding.evidence[0].contains("edges of the rim"), "{finding:#?}");
    assert!(diagnosis.findings.iter().any(|other| other.cause == Cause::ContactCycles), "{diagnosis}");
    is_mended("contact-cycles", &finding, 0);
}

#[test]
fn friction_on_a_wedge() {
    let (finding, _) = diagnosed("wedge-friction");
    is_cause(&finding, Cause::FrictionLocks);
    assert_eq!(finding.place.pair.as_deref(), Some("flank"));
    assert_eq!(finding.place.body.as_deref(), Some("wedge"));
    // The flank is inclined by 10 degrees, tan 10 = 0.176; bodies that give way change that a little.
    let [Change::Set { key, value }] = &finding.remedies[0].changes[..] else { panic!("{finding:#?}") };
    let mu: f64 = value.parse().unwrap();
    assert!(key == "contact[0].friction.mu" && (0.12..0.176).contains(&mu), "{key} {value}");
    is_mended("wedge-friction", &finding, 0);
}

/// A wedge between two jaws, both in contact: half the angle of the gap counts.
#[test]
fn friction_on_both_sides_of_a_wedge() {
    let half = text_of("wedge-friction");
    // The left side gets a jaw of its own, the mirror image of the right one.
    let jaw = r#"
[[body]]
name = "left"
mesh = { generator = "hexahedron", corners = [[-1, -0.1, -1.0], [-0.123673, -0.1, -1.0], [-0.123673, 1.1, -1.0], [-1, 1.1, -1.0], [-1, -0.1, 1.2], [-0.511592, -0.1, 1.2], [-0.511592, 1.1, 1.2], [-1, 1.1, 1.2]], divisions = [1, 1, 8] }
material = { law = "neo-hooke", young = 100000.0, poisson = 0.3 }
[[prescribe]]
set = "left.left"
components = ["x", "y", "z"]
fixed = true
[[contact]]
name = "left-flank"
method = "nts"
slave = "wedge.left"
master = "left.right"
friction = { law = "coulomb", mu = 1.5 }
"#;
    let corners = "[[0, 0, 0], [0.3, 0, 0], [0.3, 1, 0], [0, 1, 0], [0, 0, 1.0], [0.476327, 0, 1.0], [0.476327, 1, 1.0], [0, 1, 1.0]]";
    let both = "[[-0.3, 0, 0], [0.3, 0, 0], [0.3, 1, 0], [-0.3, 1, 0], [-0.476327, 0, 1.0], [0.476327, 0, 1.0], [0.476327, 1, 1.0], [-0.476327, 1, 1.0]]";
    let guide = "[[prescribe]]\nset = \"wedge.left\"\ncomponents = [\"x\"]\nfixed = true\n";
    assert!(half.contains(corners) && half.contains(guide));
    // It sticks, and is driven until it is crushed.
    let (drive, farther) = ("[1.0, -0.55]", "[1.0, -0.7]");
    assert!(half.contains(drive));
    let text = half.replace(corners, both).replace(guide, "").replace(drive, farther) + jaw;
    let Left { result, diagnosis } = run(&text);
    assert!(matches!(result, Err(RunError::Simulation { .. })));
    let finding = diagnosis.unwrap().findings[0].clone();
    assert_eq!(finding.cause, Cause::FrictionLocks, "{finding:#?}");
    let keys: Vec<&str> = finding.remedies[0]
        .changes
        .iter()
        .map(|change| match change {
            Change::Set { key, .. } => key.as_str(),
            Change::Add { toml } => panic!("{toml}"),
        })
        .collect();
    assert_eq!(keys, ["contact[0].friction.mu", "contact[1].friction.mu"]);
}

/// A block that is pressed on a plane and led along it is no wedge, whatever its friction: nothing keeps it from giving way.
#[test]
fn a_block_that_is_pushed_over_a_plane_is_no_wedge() {
    for mu in [0.4, 0.09] {
        let text = format!(
            r#"
[scene]
title = "push over a plane"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
max_cuts = 1
[[body]]
name = "floor"
mesh = {{ generator = "block", min = [0, 0, -1], max = [6, 1, 0], divisions = [12, 2, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0.5, 0, 0], max = [1.5, 1, 1], divisions = [2, 2, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[prescribe]]
set = "floor.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
name = "drive"
set = "block.top"
components = ["x", "y", "z"]
displacement = {{ table = [[0, 0, 0, 0], [1, 3.0, 0, -0.3]] }}
[[contact]]
name = "c"
method = "nts"
slave = "block.bottom"
master = "floor.top"
friction = {{ law = "coulomb", mu = {mu} }}
"#
        );
        let Left { result, diagnosis } = run(&text);
        let findings = diagnosis.map(|diagnosis| diagnosis.findings).unwrap_or_default();
        assert!(findings.iter().all(|finding| finding.cause != Cause::FrictionLocks), "{findings:#?}");
        assert!(matches!(result, Err(RunError::Simulation { .. })));
    }
}

#[test]
fn a_sliver() {
    let (finding, _) = diagnosed("sliver");
    is_cause(&finding, Cause::Sliver);
    assert_eq!((finding.place.body.as_deref(), finding.place.element), (Some("wedge"), Some(0)));
    // The corner in the middle of a straight edge.
    assert!(finding.place.position.is_some_and(|x| x[0] == 0.5005 && x[1] == 0.5), "{finding:#?}");
    // What the scene has already is not offered.
    let warns = |finding: &LikelyCause| finding.remedies.iter().any(|remedy| remedy.text.contains("inside_out"));
    assert!(warns(&finding));
    let text = text_of("sliver") + "\n[solver]\ninside_out = \"warn\"\n";
    let found = run(&text).diagnosis.map(|diagnosis| diagnosis.findings).unwrap_or_default();
    assert!(found.iter().all(|finding| !warns(finding)), "{found:#?}");
}

#[test]
fn a_missing_contact() {
    let (finding, _) = diagnosed("missing-contact");
    is_cause(&finding, Cause::MissingContact);
    let between = ["plate", "ball"];
    assert!(finding.place.body.as_deref().is_some_and(|body| between.contains(&body)), "{finding:#?}");
    assert!(between.iter().all(|name| finding.place.text.contains(name)));
    let [Change::Add { toml }] = &finding.remedies[0].changes[..] else { panic!("{finding:#?}") };
    assert!(toml.contains("plate.top") && toml.contains("ball.outer"), "{toml}");
    is_mended("missing-contact", &finding, 0);
    let change = Change::Set { key: "general_contact.enabled".into(), value: "true".into() };
    assert_eq!(finding.remedies[1].changes, [change]);
    is_mended("missing-contact", &finding, 1);
    // Where there is no such table it is proposed as a whole.
    let text = text_of("missing-contact").replace("[general_contact]\nenabled = false", "");
    let third = "[[body]]\nname = \"far\"\nmesh = { generator = \"block\", min = [8, 8, 8], max = [9, 9, 9], divisions = [1, 1, 1] }\n\
                 material = { law = \"neo-hooke\", young = 1.0e6, poisson = 0.3 }\ndensity = 1000.0\n\
                 [[contact]]\nmethod = \"nts\"\nslave = \"far.bottom\"\nmaster = \"plate.top\"\n";
    let finding = run(&(text + third)).diagnosis.unwrap().findings[0].clone();
    is_cause(&finding, Cause::MissingContact);
    let [Change::Add { toml }] = &finding.remedies[1].changes[..] else { panic!("{finding:#?}") };
    assert_eq!(toml, "[general_contact]\n");
}
