//! The chores that need no build pass on this repository.

use std::process::Command;

#[test]
fn layers_public_items_and_habits_are_as_listed() {
    for chore in ["layers", "api", "tidy"] {
        let output = Command::new(env!("CARGO_BIN_EXE_xtask")).arg(chore).output().unwrap();
        let text = [output.stdout, output.stderr].concat();
        assert!(output.status.success(), "xtask {chore}: {}", String::from_utf8_lossy(&text));
    }
}
