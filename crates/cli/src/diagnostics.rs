//! Problems of a scene, with the lines that they are about.

use crate::terminal::say;
use miette::{LabeledSpan, MietteDiagnostic, NamedSource, Report, Severity};
use std::path::Path;
use stoss::scene::SceneErrors;

/// Prints every problem: first one line with file, line, key and remedy (for editors and scripts), then the place in the scene.
pub fn print(path: &Path, errors: &SceneErrors) {
    let name = path.display().to_string();
    for problem in errors.problems() {
        say!("error: {problem}");
        let span = problem.span.start..problem.span.end.max(problem.span.start);
        let diagnostic = MietteDiagnostic::new(problem.message.clone())
            .with_severity(Severity::Error)
            .with_help(problem.remedy.clone())
            .with_label(LabeledSpan::at(span, problem.key.clone()));
        let report = Report::new(diagnostic).with_source_code(NamedSource::new(&name, errors.text().to_owned()));
        say!("{report:?}");
    }
    let count = errors.problems().len();
    say!("{count} {} in {name}", if count == 1 { "problem" } else { "problems" });
}
