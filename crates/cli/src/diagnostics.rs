//! Problems of a scene, with the lines that they are about.

use crate::terminal::say;
use std::path::Path;
use stoss::scene::SceneErrors;

/// Most characters of a line of the scene that are shown.
const WIDTH: usize = 100;

/// Characters that are shown before the place of a problem, if the line is longer.
const BEFORE: usize = 40;

/// Prints every problem once: one line with file, line, column, key, value and remedy (for editors and scripts), and below it the line of the scene.
pub fn print(path: &Path, errors: &SceneErrors) {
    for problem in errors.problems() {
        say!("error: {problem}");
        let length = errors.text().get(problem.span.clone()).map_or(1, |text| text.chars().count());
        if let Some(line) = errors.text().lines().nth(problem.line.saturating_sub(1)) {
            say!("{}", excerpt(line, problem.line, problem.column, length));
        }
    }
    let count = errors.problems().len();
    say!("{count} {} in {}", if count == 1 { "problem" } else { "problems" }, path.display());
}

/// A line of the scene with its number, and marks under `length` characters from a column (from 1) on.
fn excerpt(line: &str, number: usize, column: usize, length: usize) -> String {
    let characters: Vec<char> = line.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let at = column.saturating_sub(1).min(characters.len());
    let from = if characters.len() <= WIDTH { 0 } else { at.saturating_sub(BEFORE) };
    let to = characters.len().min(from + WIDTH);
    let shown: String = characters[from..to].iter().collect();
    let (left, right) = (if from > 0 { "..." } else { "" }, if to < characters.len() { "..." } else { "" });
    let marks = length.clamp(1, (to - at).max(1));
    let margin = " ".repeat(number.to_string().len());
    let space = " ".repeat(left.len() + at - from);
    format!("  {number} | {left}{shown}{right}\n  {margin} | {space}{}", "^".repeat(marks))
}

#[cfg(test)]
mod tests {
    use super::excerpt;

    #[test]
    fn the_place_is_marked() {
        assert_eq!(excerpt("step = -1", 12, 8, 2), "  12 | step = -1\n     |        ^^");
        assert_eq!(excerpt("", 1, 1, 0), "  1 | \n    | ^");
    }

    #[test]
    fn long_lines_are_cut() {
        let line = "x".repeat(100_000);
        for column in [1, 50_000, 100_000] {
            let text = excerpt(&line, 3, column, 100_000);
            assert!(text.len() < 300, "{text}");
            assert!(text.contains("...") && text.ends_with('^'));
        }
    }
}
