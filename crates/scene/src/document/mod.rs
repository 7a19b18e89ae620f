//! Reads a scene from the document tree and collects all problems on the way.

mod parameters;
mod section;
mod tables;

use crate::read::{Node, Report};
use crate::source::Source;
use crate::{OwnNames, Problem, Scene, SceneErrors};
use std::cell::{Cell, RefCell};
use toml::de::{DeTable, DeValue};

pub(crate) fn scene(
    text: &str,
    file: &str,
    own_laws: &OwnNames<'_>,
    overrides: &[(String, String)],
) -> Result<Scene, SceneErrors> {
    let mut source = Source::new(text, file);
    let (document, errors) = DeTable::parse_recoverable(text);
    let syntax: Vec<Problem> = errors.iter().map(|error| syntax_problem(&source, error)).collect();
    if let Some(errors) = SceneErrors::new(syntax, text) {
        return Err(errors);
    }
    source.index(document.get_ref());
    let mut report = Report {
        source: &source,
        problems: RefCell::default(),
        parameters: Default::default(),
        evaluated: Cell::default(),
    };
    report.parameters = parameters::read(&report, document.get_ref(), overrides);
    let root = DeValue::Table(document.into_inner());
    let node = Node { report: &report, value: &root, span: 0..0, key: String::new() };
    let scene = node.table().and_then(|table| tables::document(&table, own_laws));
    let problems = report.problems.into_inner();
    match (SceneErrors::new(problems, text), scene) {
        (None, Some(scene)) => {
            source.expressions.clone_from(&scene.source.expressions);
            Ok(Scene { source, ..scene })
        }
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
