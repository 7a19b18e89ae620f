//! `cargo xtask schema`: the committed schema of the scene format, and the reference of its keys.

use crate::program::Program;
use crate::reference::{Sample, page};
use crate::workspace::{Outcome, Workspace, read, write};

/// Where the schema is committed.
const FILE: &str = "docs/scene.schema.json";

/// Where the reference is committed.
const REFERENCE: &str = "docs/guide/reference.md";

/// Writes the schema and the reference, or compares them; false if one differs.
pub fn command(workspace: &Workspace, check: bool) -> Outcome<bool> {
    let text = Program::build(workspace)?.schema()?;
    let value: serde_json::Value =
        serde_json::from_str(&text).map_err(|error| format!("`stoss schema` prints no JSON: {error}"))?;
    if !value.is_object() {
        return Err("`stoss schema` prints no JSON object".into());
    }
    let text = format!("{}\n", text.trim_end());
    let reference = page(&value, &samples(workspace)?)?;
    let mut same = true;
    for (file, text) in [(FILE, text), (REFERENCE, reference)] {
        if !check {
            write(&workspace.path(file), &text)?;
            println!("schema: wrote {file}");
            continue;
        }
        match first_difference(&read(&workspace.path(file))?, &text) {
            None => println!("schema: {file} is up to date"),
            Some(line) => {
                println!("schema: {file}:{line} differs from `stoss schema`; run `cargo xtask schema`");
                same = false;
            }
        }
    }
    Ok(same)
}

/// The shipped scenes, by name.
fn samples(workspace: &Workspace) -> Outcome<Vec<Sample>> {
    let folder = workspace.path("scenes");
    let entries = std::fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut samples = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| format!("{}: {error}", folder.display()))?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            samples.push(Sample { name, text: read(&path)? });
        }
    }
    samples.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(samples)
}

/// Number of the first line that differs, from 1.
fn first_difference(a: &str, b: &str) -> Option<usize> {
    if a == b {
        return None;
    }
    let same = a.lines().zip(b.lines()).take_while(|(a, b)| a == b).count();
    Some(same + 1)
}

#[cfg(test)]
mod tests {
    use super::first_difference;

    #[test]
    fn the_first_differing_line_is_named() {
        assert_eq!(first_difference("a\nb\n", "a\nb\n"), None);
        assert_eq!(first_difference("a\nb\n", "a\nc\n"), Some(2));
        assert_eq!(first_difference("a\n", "a\nb\n"), Some(2));
    }
}
