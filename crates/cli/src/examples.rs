//! Scenes that come with the program: `stoss examples`, `stoss init`.

use crate::job::quoted;
use crate::terminal::{say, tell};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Which scene `stoss init` takes if none is named.
const FIRST: &str = "two-blocks";

macro_rules! scenes {
    ($($name:literal),+ $(,)?) => {
        [$(($name, include_str!(concat!("../../../scenes/", $name, ".toml")))),+]
    };
}

/// Names and texts. None of them needs another file.
const SCENES: [(&str, &str); 13] = scenes![
    "two-blocks",
    "two-blocks-friction",
    "two-blocks-mortar",
    "ball-plate",
    "flight",
    "hertz-ball",
    "incline",
    "ironing-mortar",
    "press",
    "rigid-punch",
    "slide",
    "tied-cantilever",
    "trebuchet",
];

fn text_of(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// Title of a scene, from its text.
fn title(text: &str) -> &str {
    text.lines().find_map(|line| line.strip_prefix("title = ")).unwrap_or_default().trim_matches('"')
}

fn unknown(name: &str) -> ExitCode {
    let names: Vec<&str> = SCENES.iter().map(|(name, _)| *name).collect();
    say!("error: there is no example `{name}`; choose one of {}", names.join(", "));
    ExitCode::from(2)
}

/// Lists the examples, or prints one.
pub fn examples(name: Option<&str>) -> ExitCode {
    match name {
        Some(name) => text_of(name).map_or_else(|| unknown(name), |text| tell(text.trim_end())),
        None => {
            let lines: Vec<String> = SCENES.iter().map(|(name, text)| format!("{name:20}  {}", title(text))).collect();
            tell(&lines.join("\n"))
        }
    }
}

/// Writes a new scene: that of an example. An existing file stays.
pub fn init(name: &Path, from: Option<&str>) -> ExitCode {
    let from = from.unwrap_or(FIRST);
    let Some(text) = text_of(from) else { return unknown(from) };
    let path = if name.extension().is_some_and(|extension| extension == "toml") {
        name.to_path_buf()
    } else {
        PathBuf::from(format!("{}.toml", name.display()))
    };
    let written = OpenOptions::new().write(true).create_new(true).open(&path);
    if let Err(error) = written.and_then(|mut file| file.write_all(text.as_bytes())) {
        let remedy = if error.kind() == ErrorKind::AlreadyExists { "; choose another name" } else { "" };
        say!("error: {}: {error}{remedy}", path.display());
        return ExitCode::from(1);
    }
    let word = quoted(&path.display().to_string());
    tell(&format!("written: {word}, from the example {from}\nnext: stoss check {word}\n      stoss run {word}"))
}

#[cfg(test)]
mod tests {
    use super::{FIRST, SCENES, text_of, title};

    #[test]
    fn examples_are_scenes_with_titles_and_without_other_files() {
        for (name, text) in SCENES {
            let scene = stoss::scene::parse(text, name).unwrap_or_else(|errors| panic!("{errors}"));
            assert_eq!(title(text), scene.header.title, "{name}");
            assert!(!text.contains("file = "), "{name}");
        }
        assert!(text_of(FIRST).is_some());
    }
}
