//! What a shell and `man` know of the program: `stoss completions`, `stoss man`.

use crate::terminal::{say, tell};
use clap::Command;
use clap_complete::Shell;
use std::path::Path;
use std::process::ExitCode;

/// Prints the completions for a shell.
pub fn completions(shell: Shell, mut command: Command) -> ExitCode {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut command, "stoss", &mut text);
    tell(String::from_utf8_lossy(&text).trim_end())
}

/// Prints the manual page of the program, or writes those of the program and of its commands into a folder.
pub fn manual(folder: Option<&Path>, command: Command) -> ExitCode {
    let Some(folder) = folder else {
        let mut text = Vec::new();
        return match clap_mangen::Man::new(command).render(&mut text) {
            Ok(()) => tell(String::from_utf8_lossy(&text).trim_end()),
            Err(error) => fail(Path::new("stoss.1"), &error),
        };
    };
    let written = std::fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(command, folder));
    written.map_or_else(|error| fail(folder, &error), |()| ExitCode::SUCCESS)
}

fn fail(path: &Path, error: &std::io::Error) -> ExitCode {
    say!("error: {}: {error}", path.display());
    ExitCode::from(1)
}
