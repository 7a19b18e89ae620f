//! Where the repository is, and running commands in it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

pub use stoss_report::{Outcome, read};

/// The repository.
#[derive(Clone, Debug)]
pub struct Workspace {
    /// The folder that holds `layers.toml`.
    pub root: PathBuf,
    /// The program `stoss` that is already built; if none, it is built in the release profile where it is needed.
    pub program: Option<PathBuf>,
}

impl Workspace {
    /// Looks upwards from this crate's manifest (set by `cargo run`), then from the current folder.
    pub fn find() -> Outcome<Self> {
        let starts = [std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from), std::env::current_dir().ok()];
        starts
            .iter()
            .flatten()
            .flat_map(|start| start.ancestors())
            .find(|folder| folder.join("layers.toml").is_file())
            .map(|root| Self { root: root.to_path_buf(), program: None })
            .ok_or_else(|| "no layers.toml in this folder or above it".into())
    }

    /// A path inside the repository.
    pub fn path(&self, relative: impl AsRef<Path>) -> PathBuf {
        self.root.join(relative)
    }

    /// The text of a file inside the repository.
    pub fn read(&self, relative: impl AsRef<Path>) -> Outcome<String> {
        read(&self.path(relative))
    }

    /// A command that runs in the root.
    pub fn process(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        command
    }

    /// `cargo` in the root, without the variables that the outer `cargo run` sets for its child.
    pub fn cargo(&self) -> Command {
        let mut command = self.process(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        for (name, _) in std::env::vars_os() {
            if name.to_str().is_some_and(|name| name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_")) {
                command.env_remove(name);
            }
        }
        command
    }

    /// Folder of build products, as cargo sees it.
    pub fn target(&self) -> Outcome<PathBuf> {
        let text = capture(self.cargo().args(["metadata", "--no-deps", "--format-version", "1"]))?;
        let metadata: serde_json::Value = serde_json::from_str(&text)?;
        match metadata["target_directory"].as_str() {
            Some(folder) => Ok(PathBuf::from(folder)),
            None => Err("cargo metadata names no target_directory".into()),
        }
    }

    /// All files that git tracks or would track (ignored ones left out), relative to the root, sorted.
    pub fn files(&self) -> Outcome<Vec<PathBuf>> {
        let text = capture(self.process("git").args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"]))?;
        let mut files: Vec<PathBuf> = text.split('\0').filter(|name| !name.is_empty()).map(PathBuf::from).collect();
        files.retain(|file| self.path(file).is_file());
        files.sort();
        files.dedup();
        Ok(files)
    }

    /// The shipped scenes, relative to the root, sorted.
    pub fn scenes(&self) -> Outcome<Vec<PathBuf>> {
        let mut files = self.files()?;
        files.retain(|file| {
            file.parent() == Some(Path::new("scenes")) && file.extension().is_some_and(|kind| kind == "toml")
        });
        Ok(files)
    }
}

/// Writes a file and the folders above it; the error names it.
pub fn write(path: &Path, text: &str) -> Outcome<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(path, text))
        .map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Runs a command and returns its standard output; its standard error becomes the error.
pub fn capture(command: &mut Command) -> Outcome<String> {
    let output = command.output().map_err(|error| format!("{}: {error}", show(command)))?;
    if !output.status.success() {
        let stderr = String::from_utf8_lossy(&output.stderr);
        return Err(format!("`{}` ended with {}\n{}", show(command), output.status, stderr.trim_end()).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// The command line, for messages.
pub fn show(command: &Command) -> String {
    std::iter::once(command.get_program())
        .chain(command.get_args())
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}
