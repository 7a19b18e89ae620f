//! The tutorials of `docs/tutorials`, executed from their own text.
//!
//! Every fenced block has a role, which the words behind the fence say; a block without one is an error, so that nothing is printed there that nobody has tried.
//!
//! | behind the fence | role |
//! |---|---|
//! | `LANGUAGE file=NAME` | the block is the file NAME, which is written again |
//! | `LANGUAGE append=NAME` | the block is added at the end of the file NAME |
//! | `LANGUAGE part-of=NAME` | the lines of the block stand together in the file NAME |
//! | `sh`, `sh exit=N` | every line is a command; all end with 0, the last one with N |
//! | `sh not-run` | commands that need what a reader may not have: not executed |
//! | `text`, `text tolerance=R zero=Z` | directly behind `sh`: what the commands print. R is the relative tolerance of numbers (1e-6), below Z numbers are equal (0) |
//!
//! In `text` a line `...` stands for any lines, `...` at the end of a line for its rest. Each tutorial has a folder of its own, with the files that are beside the tutorials (meshes and what they are made of),
//! next to which a folder `stoss` is the repository. A picture that the text shows must be made there by a command, as `figures/NAME`, and be committed as `docs/tutorials/figures/NAME`.
//! `STOSS_FIGURES=write` in the environment writes it there.

#![cfg(unix)]

mod comparison;
mod document;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use comparison::{Tolerance, compare};
use document::{Block, Document, Role};

/// Bytes that all pictures of the tutorials, and each other file beside them, may have.
const PICTURES: u64 = 500_000;
const FILE: u64 = 200_000;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("the crate lies in crates/cli").to_owned()
}

fn tutorials() -> PathBuf {
    repository().join("docs/tutorials")
}

/// Executes the text; the error names file and line.
fn execute(name: &str, text: &str, beside: &Path) -> Result<(), String> {
    let document = Document::parse(name, text)?;
    let temporary = tempfile::tempdir().map_err(|error| error.to_string())?;
    let folder = temporary.path().join("work");
    let programs = temporary.path().join("bin");
    for new in [&folder, &programs] {
        std::fs::create_dir(new).map_err(|error| format!("{}: {error}", new.display()))?;
    }
    link(Path::new(env!("CARGO_BIN_EXE_stoss")), &programs.join("stoss"))?;
    link(&repository(), &temporary.path().join("stoss"))?;
    for file in files(beside)?.iter().filter(|file| file.extension().is_none_or(|extension| extension != "md")) {
        let to = folder.join(file.file_name().expect("files have names"));
        std::fs::copy(file, &to).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    let mut reader = Reader { present: folder.clone(), programs };
    for block in &document.blocks {
        reader.take(block).map_err(|message| format!("{name}:{}: {message}", block.line))?;
    }
    for (line, picture) in &document.pictures {
        let made = folder.join(picture);
        if !made.is_file() {
            return Err(format!("{name}:{line}: no command of the text makes the picture {picture}"));
        }
        let committed = beside.join(picture);
        if std::env::var("STOSS_FIGURES").is_ok_and(|value| value == "write") {
            std::fs::copy(&made, &committed).map_err(|error| format!("{}: {error}", committed.display()))?;
        }
        if !committed.is_file() {
            return Err(format!("{name}:{line}: {} is missing; STOSS_FIGURES=write writes it", committed.display()));
        }
    }
    Ok(())
}

fn link(to: &Path, at: &Path) -> Result<(), String> {
    std::os::unix::fs::symlink(to, at).map_err(|error| format!("{}: {error}", at.display()))
}

/// Files of a folder, sorted; not those of folders in it.
fn files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut files: Vec<PathBuf> =
        entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).filter(|path| path.is_file()).collect();
    files.sort();
    Ok(files)
}

/// Does what the text says, block by block.
struct Reader {
    /// The folder in which the commands have left the reader.
    present: PathBuf,
    /// Holds the program `stoss`.
    programs: PathBuf,
}

impl Reader {
    fn take(&mut self, block: &Block) -> Result<(), String> {
        let problem = |file: &str, error: std::io::Error| format!("{file}: {error}");
        match &block.role {
            Role::File(file) => {
                let path = self.present.join(file);
                let folder = path.parent().expect("a file lies in a folder");
                std::fs::create_dir_all(folder).map_err(|error| problem(file, error))?;
                std::fs::write(&path, block.content()).map_err(|error| problem(file, error))
            }
            Role::Append(file) => {
                let path = self.present.join(file);
                let before = std::fs::read_to_string(&path).map_err(|error| problem(file, error))?;
                std::fs::write(&path, before + &block.content()).map_err(|error| problem(file, error))
            }
            Role::PartOf(file) => {
                let whole = std::fs::read_to_string(self.present.join(file)).map_err(|error| problem(file, error))?;
                let whole: Vec<&str> = whole.lines().collect();
                if whole.windows(block.lines.len()).any(|window| window.iter().eq(&block.lines)) {
                    Ok(())
                } else {
                    Err(format!("{file} does not have these lines"))
                }
            }
            Role::NotRun => Ok(()),
            Role::Run { exit, expected } => {
                let output = self.run(block, *exit)?;
                match expected {
                    Some((lines, tolerance)) => compare(lines, &output, *tolerance).map_err(|difference| {
                        format!("the output is not as printed:\n{difference}whole output:\n{output}")
                    }),
                    None => Ok(()),
                }
            }
        }
    }

    /// The output of all commands of a block, both streams as they come.
    fn run(&mut self, block: &Block, exit: i32) -> Result<String, String> {
        let commands = block.commands();
        let mut all = String::new();
        for (number, (line, command)) in commands.iter().enumerate() {
            let (code, output) = self.command(command)?;
            all += &output;
            let expected = if number + 1 == commands.len() { exit } else { 0 };
            if code != Some(expected) {
                return Err(format!(
                    "line {line}: `{command}` ended with {code:?}, expected was {expected}; its output:\n{output}"
                ));
            }
        }
        Ok(all)
    }

    fn command(&mut self, command: &str) -> Result<(Option<i32>, String), String> {
        let place = self.programs.join("place");
        let path = std::env::var("PATH").unwrap_or_default();
        let output = Command::new("sh")
            .arg("-c")
            .arg(format!("exec 2>&1\ntrap 'pwd >\"$STOSS_PLACE\"' EXIT\n{command}\n"))
            .current_dir(&self.present)
            .env("PATH", format!("{}:{path}", self.programs.display()))
            .env("STOSS_PLACE", &place)
            // What the workspace was built from is enough, and what one run has built the next one need not build.
            .env("CARGO_NET_OFFLINE", "true")
            .env("CARGO_TARGET_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("tutorials"))
            .stdin(Stdio::null())
            .output()
            .map_err(|error| format!("sh: {error}"))?;
        let now = std::fs::read_to_string(&place).map_err(|error| format!("{}: {error}", place.display()))?;
        self.present = PathBuf::from(now.trim_end_matches('\n'));
        Ok((output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned()))
    }
}

/// Executes one of the tutorials.
fn tutorial(name: &str) {
    let beside = tutorials();
    let text = std::fs::read_to_string(beside.join(name)).expect("the tutorial is there");
    if let Err(message) = execute(&format!("docs/tutorials/{name}"), &text, &beside) {
        panic!("{message}");
    }
}

macro_rules! executed {
    ($($function:ident: $name:literal,)*) => {
        const EXECUTED: &[&str] = &[$($name),*];

        $(
            #[test]
            fn $function() {
                tutorial($name);
            }
        )*
    };
}

executed! {
    clip_that_yields: "clip-that-yields.md",
    drop_test: "drop-test.md",
    first_impact: "first-impact.md",
    press_with_friction: "press-with-friction.md",
    own_mesh: "own-mesh.md",
    sliding_contact: "sliding-contact.md",
    machine: "machine.md",
    one_crate: "one-crate.md",
}

#[test]
fn every_tutorial_is_executed_and_listed() {
    let folder = tutorials();
    let contents = std::fs::read_to_string(folder.join("README.md")).expect("the contents are there");
    for file in files(&folder).expect("the folder is readable") {
        let name = file.file_name().expect("files have names").to_string_lossy().into_owned();
        if name.ends_with(".md") && name != "README.md" {
            assert!(EXECUTED.contains(&name.as_str()), "{name} is not executed");
            assert!(contents.contains(&format!("({name})")), "{name} is not in the contents");
        }
    }
}

#[test]
fn files_beside_the_tutorials_are_small_and_shown() {
    let folder = tutorials();
    let size = |file: &PathBuf| file.metadata().expect("the file is there").len();
    for file in files(&folder).expect("the folder is readable") {
        assert!(size(&file) < FILE, "{} is larger than {FILE} bytes", file.display());
    }
    let pictures = files(&folder.join("figures")).expect("the folder is readable");
    assert!(pictures.iter().map(size).sum::<u64>() < PICTURES, "pictures are larger than {PICTURES} bytes together");
    let texts: String = EXECUTED
        .iter()
        .map(|name| std::fs::read_to_string(folder.join(name)).expect("the tutorial is there"))
        .collect();
    for picture in pictures {
        let name = picture.file_name().expect("files have names").to_string_lossy().into_owned();
        assert!(texts.contains(&format!("(figures/{name})")), "no tutorial shows {name}");
    }
}

/// A text whose command prints two lines.
const TEXT: &str = "# Title\n\n```toml file=a/b.txt\none 1.5\ntwo 2\n```\n\nProse.\n\n```sh\ncat a/b.txt\n```\n\n```text\none 1.5\ntwo 2\n```\n";

fn executed(text: &str) -> Result<(), String> {
    let beside = tempfile::tempdir().expect("there is room for temporary files");
    execute("t.md", text, beside.path())
}

fn refused(from: &str, to: &str) -> String {
    assert!(TEXT.contains(from), "no `{from}`");
    executed(&TEXT.replacen(from, to, 1)).expect_err("this text is wrong")
}

#[test]
fn a_text_that_is_right_passes() {
    executed(TEXT).expect("files, commands and output agree");
    executed(&TEXT.replace("```text\none 1.5", "```text\none 1.5000001"))
        .expect("the difference is below the tolerance");
    executed(&TEXT.replace("```text\none 1.5\n", "```text\n...\n")).expect("lines are skipped");
    executed(&TEXT.replace("```text\none 1.5", "```text\none ...")).expect("the rest of a line is skipped");
    executed(&TEXT.replace("```text\none 1.5", "```text tolerance=0.1\none 1.6"))
        .expect("the tolerance is that of the text");
}

#[test]
fn a_changed_number_fails_with_file_line_and_both_values() {
    let message = refused("```text\none 1.5", "```text\none 1.50001");
    for part in ["t.md:10", "line 15", "1.50001", "1.5\n"] {
        assert!(message.contains(part), "no `{part}` in:\n{message}");
    }
    refused("```text\none 1.5\ntwo 2", "```text\n...\ntwo 3");
    refused("```text\none 1.5", "```text tolerance=0.01\none 1.6");
    refused("```text\none 1.5", "```text\none -1.5");
}

#[test]
fn missing_and_additional_lines_fail() {
    let message = refused("two 2\n```\n\nProse", "```\n\nProse");
    assert!(message.contains("line 15") && message.contains("two 2"), "{message}");
    refused("```text\none 1.5\n", "```text\n");
    refused("```text\none 1.5\ntwo 2\n", "```text\none 1.5\n");
    refused("```text\none 1.5\ntwo", "```text\none 1.5\ntow");
}

#[test]
fn a_failing_command_fails_and_an_expected_exit_code_does_not() {
    let message = refused("cat a/b.txt", "cat a/b.txt\ncat missing.txt");
    for part in ["t.md:10", "line 12", "cat missing.txt", "Some(1)"] {
        assert!(message.contains(part), "no `{part}` in:\n{message}");
    }
    refused("cat a/b.txt", "false\ncat a/b.txt");
    refused("```sh\n", "```sh exit=3\n");
    executed("```sh exit=3\nexit 3\n```\n").expect("the exit code is the expected one");
    executed("```sh\nmkdir d\ncd d\n```\n```sh\ntest $(basename $(pwd)) = d\n```\n").expect("the folder is kept");
}

#[test]
fn blocks_without_a_role_and_pictures_that_nothing_makes_are_refused() {
    assert!(refused("```toml file=a/b.txt", "```toml").contains("t.md:3"));
    assert!(refused("cat a/b.txt\n```\n", "cat a/b.txt\n```\n\nWords between.\n").contains("t.md:16"));
    assert!(refused("```text\n", "```text tolerance=much\n").contains("tolerance=much"));
    assert!(refused("Prose.", "```toml part-of=a/b.txt\none 1.5\nthree\n```").contains("does not have these lines"));
    executed(&TEXT.replace("Prose.", "```toml part-of=a/b.txt\ntwo 2\n```")).expect("the lines are there");
    executed(&TEXT.replace("Prose.", "```toml append=a/b.txt\n```\n```toml append=a/b.txt\n```"))
        .expect("nothing is added");
    assert!(refused("Prose.", "```toml append=a/b.txt\nthree 3\n```").contains("three 3"));
    assert!(refused("Prose.", "![p](figures/p.svg)").contains("t.md:8"));
    assert!(refused("```text\none 1.5\ntwo 2\n```\n", "```text\none 1.5\n").contains("not closed"));
}

#[test]
fn comparison_knows_words_numbers_and_places() {
    let tolerance = Tolerance { relative: 1e-3, zero: 1e-9 };
    let same = |expected: &str, obtained: &str| {
        let lines: Vec<(usize, String)> =
            expected.lines().enumerate().map(|(number, line)| (number, line.to_owned())).collect();
        compare(&lines, obtained, tolerance).is_ok()
    };
    assert!(same("a  1.0 b", "a 1.0005   b\n"));
    assert!(!same("a 1.0 b", "a 1.002 b\n"));
    assert!(same("drift 1e-14", "drift -3.5e-16\n"));
    assert!(!same("drift 1e-14", "drift 1e-8\n"));
    assert!(!same("hex8", "hex20\n"), "digits in a word are letters");
    assert!(same("(x=-2.5e3,", "(x=-2500,\n"));
    assert!(!same("4 contacts", "5 contacts\n"));
    assert!(same("a\n...\nb 1\nc", "a\nb 1\nd\nb 1\nc\n"), "the lines behind a gap belong together");
    assert!(!same("a\n...", "b\na\n"));
    assert!(same("...", ""));
    assert!(same("", ""));
    assert!(!same("", "a\n"));
    assert!(!same("NaN", "1\n"));
}
