//! `cargo xtask dist`: the archive of a release, made from what is here and tried at once.

mod archive;
mod interfaces;
mod notices;
mod wheel;

use std::path::{Path, PathBuf};
use std::process::Command;

use sha2::{Digest, Sha256};

use crate::manifest;
use crate::workspace::{Outcome, Workspace, capture, read, show};
use archive::Entry;

/// A target whose C library may be linked statically: musl is under the MIT licence. A static glibc would put the LGPL's terms on the archive.
const STATIC: &str = "x86_64-unknown-linux-musl";

/// Shells, and the names under which they look for completions.
const COMPLETIONS: [(&str, &str); 5] = [
    ("bash", "stoss.bash"),
    ("zsh", "_stoss"),
    ("fish", "stoss.fish"),
    ("elvish", "stoss.elv"),
    ("powershell", "_stoss.ps1"),
];

/// What goes along from the root, and folders of which all goes along that git has.
const FILES: [&str; 7] =
    ["README.md", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "SECURITY.md", "LICENSE-MIT", "LICENSE-APACHE"];
const FOLDERS: [&str; 2] = ["docs/", "scenes/"];

/// Lists for those who change the sources.
const LEFT_OUT: &str = "docs/reuse/";

/// The scene that the unpacked program is tried with, and how far (its unit of time).
const TRIAL: (&str, &str) = ("two-blocks", "0.01");

/// Builds the program, writes archive and checksum into `dist` of cargo's target folder, and tries the archive.
pub fn command(workspace: &Workspace) -> Outcome<bool> {
    interfaces::check(workspace)?;
    let host = host(&capture(workspace.process("rustc").arg("-vV"))?)?;
    let target =
        if is_installed(workspace, STATIC)? && STATIC.starts_with(architecture(&host)) { STATIC } else { &host };
    let program = build(workspace, target)?;
    let name = format!("stoss-{}-{target}", version(workspace)?);
    let mut entries = files(workspace)?;
    entries.push(Entry::program("stoss", std::fs::read(&program)?));
    entries.extend(generated(workspace, &program)?);
    entries.push(Entry::file("THIRD-PARTY.txt", notices::text(workspace, target)?.into_bytes()));
    entries.sort_by(|a, b| a.path.cmp(&b.path));
    let bytes = archive::tar_gz(&name, &entries, time(workspace))?;
    let folder = workspace.target()?.join("dist");
    std::fs::create_dir_all(&folder)?;
    let file = format!("{name}.tar.gz");
    let path = folder.join(&file);
    std::fs::write(&path, &bytes).map_err(|error| format!("{}: {error}", path.display()))?;
    std::fs::write(folder.join(format!("{file}.sha256")), checksum_line(&bytes, &file))?;
    println!("dist: wrote {} ({} files, {} kB) and its .sha256", path.display(), entries.len(), bytes.len() / 1000);
    if !target.ends_with("musl") {
        println!(
            "dist: not static: it needs the C library of this system or a later one; `rustup target add {STATIC}` for a static program"
        );
    }
    try_it(&path, &name)?;
    check_version_of_package(workspace)?;
    wheel::build(workspace, &folder)?;
    Ok(true)
}

/// The program in the release profile without symbols; only the program itself is built again for that.
fn build(workspace: &Workspace, target: &str) -> Outcome<PathBuf> {
    let mut command = workspace.cargo();
    command.args(["build", "--release", "--quiet", "--locked", "-p", "stoss-cli"]);
    command.args(["--config", "profile.release.package.stoss-cli.strip=\"symbols\""]);
    let mut folder = workspace.target()?;
    if target == STATIC {
        command.args(["--target", target]);
        folder.push(target);
    }
    if !command.status()?.success() {
        return Err(format!("`{}` failed", show(&command)).into());
    }
    Ok(folder.join("release").join(format!("stoss{}", std::env::consts::EXE_SUFFIX)))
}

fn host(verbose: &str) -> Outcome<String> {
    let line = verbose.lines().find_map(|line| line.strip_prefix("host: "));
    line.map(str::to_owned).ok_or_else(|| "`rustc -vV` names no host".into())
}

fn architecture(target: &str) -> &str {
    target.split('-').next().unwrap_or(target)
}

fn is_installed(workspace: &Workspace, target: &str) -> Outcome<bool> {
    let root = capture(workspace.process("rustc").args(["--print", "sysroot"]))?;
    Ok(Path::new(root.trim()).join("lib/rustlib").join(target).join("lib").is_dir())
}

fn version(workspace: &Workspace) -> Outcome<String> {
    let root: toml::Table = workspace.read("Cargo.toml")?.parse()?;
    let package = manifest::table(&manifest::table(&root, "workspace"), "package");
    let version = package.get("version").and_then(|version| version.as_str());
    version.map(str::to_owned).ok_or_else(|| "Cargo.toml: no workspace.package.version".into())
}

/// The Python package is outside of the workspace, and so is its version.
fn check_version_of_package(workspace: &Workspace) -> Outcome<()> {
    let manifest: toml::Table = workspace.read("crates/python/Cargo.toml")?.parse()?;
    let own = manifest::table(&manifest, "package");
    let (own, all) = (own.get("version").and_then(|version| version.as_str()), version(workspace)?);
    match own == Some(all.as_str()) {
        true => Ok(()),
        false => Err(format!("crates/python/Cargo.toml: the version is not {all}, that of the workspace").into()),
    }
}

/// Seconds since 1970 of the last commit, so that the same sources give the same archive; 0 without git.
fn time(workspace: &Workspace) -> u64 {
    let text = capture(workspace.process("git").args(["log", "-1", "--format=%ct"])).unwrap_or_default();
    text.trim().parse().unwrap_or(0)
}

fn files(workspace: &Workspace) -> Outcome<Vec<Entry>> {
    let mut entries = Vec::new();
    for path in workspace.files()? {
        let name = path.to_string_lossy().replace('\\', "/");
        let is_wanted = FOLDERS.iter().any(|folder| name.starts_with(folder)) && !name.starts_with(LEFT_OUT);
        if FILES.contains(&name.as_str()) || is_wanted {
            entries.push(Entry::file(&name, std::fs::read(workspace.path(&path))?));
        }
    }
    match FILES.iter().find(|file| !entries.iter().any(|entry| entry.path == **file)) {
        Some(missing) => Err(format!("{missing} is not there").into()),
        None => Ok(entries),
    }
}

/// Completions and manual pages, as the program itself writes them.
fn generated(workspace: &Workspace, program: &Path) -> Outcome<Vec<Entry>> {
    let mut entries = Vec::new();
    for (shell, name) in COMPLETIONS {
        let text = capture(workspace.process(program).args(["completions", shell]))?;
        entries.push(Entry::file(&format!("completions/{name}"), text.into_bytes()));
    }
    let pages = workspace.target()?.join("dist/man");
    if pages.exists() {
        std::fs::remove_dir_all(&pages)?;
    }
    capture(workspace.process(program).arg("man").arg("--out").arg(&pages))?;
    for page in std::fs::read_dir(&pages)? {
        let page = page?;
        let name = page.file_name().to_string_lossy().into_owned();
        entries.push(Entry::file(&format!("man/man1/{name}"), std::fs::read(page.path())?));
    }
    std::fs::remove_dir_all(&pages)?;
    Ok(entries)
}

/// A line of `sha256sum`.
fn checksum_line(bytes: &[u8], file: &str) -> String {
    let hex: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    format!("{hex}  {file}\n")
}

/// Unpacks the archive into an empty folder and runs a first scene there, with an empty environment.
fn try_it(archive: &Path, name: &str) -> Outcome<()> {
    let folder = std::env::temp_dir().join(format!("stoss-dist-{}", std::process::id()));
    std::fs::create_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let outcome = try_in(archive, &folder, name);
    std::fs::remove_dir_all(&folder)?;
    outcome
}

fn try_in(archive: &Path, folder: &Path, name: &str) -> Outcome<()> {
    capture(Command::new("tar").arg("-xzf").arg(archive).arg("-C").arg(folder))?;
    let root = folder.join(name);
    let run = |arguments: &[&str]| {
        let mut command = Command::new(root.join("stoss"));
        capture(command.current_dir(&root).env_clear().args(arguments))
    };
    let version = run(&["--version"])?;
    let (scene, until) = TRIAL;
    let file = format!("{scene}.toml");
    std::fs::write(root.join(&file), run(&["examples", scene])?)?;
    run(&["check", &file])?;
    run(&["run", &file, "--out", "first", "--until", until])?;
    for made in ["first/report.html", "first/summary.json", "completions/stoss.bash", "man/man1/stoss.1"] {
        if read(&root.join(made))?.is_empty() {
            return Err(format!("{made} of the unpacked archive is empty").into());
        }
    }
    println!("dist: unpacked into an empty folder, with an empty environment: {}, `{scene}` runs", version.trim());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_host_is_that_of_the_compiler() {
        let verbose = "rustc 1.95.0\nbinary: rustc\nhost: x86_64-unknown-linux-gnu\nrelease: 1.95.0\n";
        assert_eq!(host(verbose).unwrap(), "x86_64-unknown-linux-gnu");
        assert!(host("rustc 1.95.0\n").is_err());
        assert_eq!(architecture("aarch64-apple-darwin"), "aarch64");
    }

    /// The digest of "abc" is that of FIPS 180-4.
    #[test]
    fn the_checksum_is_a_line_of_sha256sum() {
        let digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(checksum_line(b"abc", "a.tar.gz"), format!("{digest}  a.tar.gz\n"));
    }

    #[test]
    fn the_python_package_has_the_version_of_all_crates() {
        check_version_of_package(&Workspace::find().unwrap()).unwrap();
    }

    #[test]
    fn what_goes_along_is_there() {
        let entries = files(&Workspace::find().unwrap()).unwrap();
        for expected in ["LICENSE-MIT", "docs/ARCHITECTURE.md", "scenes/two-blocks.toml"] {
            assert!(entries.iter().any(|entry| entry.path == expected), "{expected}");
        }
        let others = ["crates/", LEFT_OUT];
        assert!(entries.iter().all(|entry| others.iter().all(|folder| !entry.path.starts_with(folder))));
    }
}
