//! `cargo xtask schema`: the committed schema of the scene format.

use crate::program::Program;
use crate::workspace::{Outcome, Workspace, read, write};

/// Where the schema is committed.
const FILE: &str = "docs/scene.schema.json";

/// Writes the schema, or compares it; false if it differs.
pub fn command(workspace: &Workspace, check: bool) -> Outcome<bool> {
    let text = Program::build(workspace)?.schema()?;
    let value: serde_json::Value =
        serde_json::from_str(&text).map_err(|error| format!("`stoss schema` prints no JSON: {error}"))?;
    if !value.is_object() {
        return Err("`stoss schema` prints no JSON object".into());
    }
    let text = format!("{}\n", text.trim_end());
    if !check {
        write(&workspace.path(FILE), &text)?;
        println!("schema: wrote {FILE}");
        return Ok(true);
    }
    let committed = read(&workspace.path(FILE))?;
    let difference = first_difference(&committed, &text);
    match difference {
        None => println!("schema: {FILE} is what `stoss schema` prints"),
        Some(line) => println!("schema: {FILE}:{line} differs from `stoss schema`; run `cargo xtask schema`"),
    }
    Ok(difference.is_none())
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
