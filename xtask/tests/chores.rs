//! The chores that need no build pass on this repository.

use std::collections::BTreeSet;
use std::process::Command;

fn passes(chore: &str) {
    let output = Command::new(env!("CARGO_BIN_EXE_xtask")).arg(chore).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    assert!(output.status.success(), "xtask {chore}: {}", String::from_utf8_lossy(&text));
}

#[test]
fn layers_are_as_listed() {
    passes("layers");
}

#[test]
fn habits_are_kept() {
    passes("tidy");
}

/// The features that packages have in the programs are those that they have in the tests: else `cargo run` and `cargo test` each build all that is above them.
#[test]
fn programs_and_tests_build_the_same_packages() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let packages = |edges: &str| -> BTreeSet<String> {
        let mut command = Command::new(&cargo);
        command.args(["tree", "--workspace", "--edges", edges, "--prefix", "none", "--format", "{p} {f}"]);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines().map(|line| line.trim_end_matches("(*)").trim_end().to_owned()).collect()
    };
    let (programs, tests) = (packages("normal,build"), packages("normal,build,dev"));
    assert!(programs.len() > 100, "{programs:?}");
    let others: Vec<_> = programs.difference(&tests).collect();
    assert!(others.is_empty(), "name the features of the tests in tests/Cargo.toml: {others:?}");
}
