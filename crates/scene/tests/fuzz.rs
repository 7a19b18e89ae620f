//! Whatever the text is: a scene or a list of problems with places inside the text, never a panic.

use proptest::prelude::*;
use stoss_scene::parse;

const SCENES: [&str; 3] =
    [include_str!("data/dynamic.toml"), include_str!("data/quasi-static.toml"), include_str!("data/multibody.toml")];

/// Pieces that are likely to hurt.
const PIECES: [&str; 22] = [
    "",
    "[",
    "]",
    "{",
    "}",
    "[[",
    "=",
    ".",
    ",",
    "\"",
    "\n",
    "nan",
    "-inf",
    "-1",
    "1e999",
    "99999999999999999999999",
    "[]",
    "{}",
    "true",
    "\u{e4}\u{1F600}",
    "1979-05-27",
    "\0",
];

fn check(text: &str) -> Result<(), TestCaseError> {
    if let Err(errors) = parse(text, "x.toml") {
        prop_assert!(!errors.problems().is_empty());
        for problem in errors.problems() {
            prop_assert!(text.get(problem.span.clone()).is_some(), "span of {}", problem);
            prop_assert!(problem.line >= 1 && problem.line <= 1 + text.matches('\n').count());
            prop_assert!(!problem.message.is_empty() && !problem.remedy.is_empty());
        }
    }
    Ok(())
}

fn boundary(text: &str, fraction: f64) -> usize {
    let mut index = ((text.len() as f64) * fraction) as usize;
    while !text.is_char_boundary(index) {
        index -= 1;
    }
    index
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn truncated_scenes(which in 0..SCENES.len(), cut in 0.0..1.0f64) {
        let text = SCENES[which];
        check(&text[..boundary(text, cut)])?;
    }

    #[test]
    fn scenes_with_pieces_replaced(
        which in 0..SCENES.len(),
        edits in proptest::collection::vec((0.0..1.0f64, 0..12usize, 0..PIECES.len()), 1..5),
    ) {
        let mut text = SCENES[which].to_owned();
        for (place, length, piece) in edits {
            let start = boundary(&text, place);
            let mut end = (start + length).min(text.len());
            while !text.is_char_boundary(end) {
                end -= 1;
            }
            text.replace_range(start..end.max(start), PIECES[piece]);
        }
        check(&text)?;
    }

    /// Valid TOML with wrong meaning: the value of a random key becomes something else.
    #[test]
    fn scenes_with_values_replaced(which in 0..SCENES.len(), line in 0..300usize, piece in 0..PIECES.len()) {
        let mut lines: Vec<String> = SCENES[which].lines().map(str::to_owned).collect();
        let index = line % lines.len();
        if let Some(equals) = lines[index].find('=') {
            lines[index].truncate(equals + 1);
            lines[index].push_str(PIECES[piece]);
        }
        check(&lines.join("\n"))?;
    }

    #[test]
    fn lines_in_any_order(which in 0..SCENES.len(), seed in proptest::collection::vec(any::<u16>(), 350)) {
        let mut lines: Vec<(u16, &str)> = seed.into_iter().zip(SCENES[which].lines()).collect();
        lines.sort_by_key(|&(key, _)| key);
        let lines: Vec<&str> = lines.into_iter().map(|(_, line)| line).collect();
        check(&lines.join("\n"))?;
    }

    #[test]
    fn any_text(text in "\\PC*") {
        check(&text)?;
    }
}
