//! `cargo xtask same PROGRAM`: whether this program writes the same bytes as another one, scene by scene.
//!
//! A rearrangement of code is proven by it: what is only moved changes no bit of a result.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Instant;

use crate::program::Program;
use crate::workspace::{Outcome, Workspace, read};

/// Programs and scenes that are compared.
#[derive(Debug)]
pub struct Comparison {
    /// The other program `stoss`, mostly that of the commit before.
    pub other: PathBuf,
    /// Steps of the size that the scene gives; 0: to the scene's end.
    pub steps: u32,
    /// Files, folders, or names of shipped scenes; none: all shipped scenes.
    pub scenes: Vec<String>,
}

/// Runs every scene with both programs, one thread each; prints a line for each. False if a byte differs or one of the runs ends otherwise than the other.
pub fn command(workspace: &Workspace, comparison: &Comparison) -> Outcome<bool> {
    let other = std::path::absolute(&comparison.other)?;
    if !other.is_file() {
        return Err(format!("there is no program {}", other.display()).into());
    }
    let ours = Program::build(workspace)?;
    let folder = workspace.target()?.join("same");
    let scenes = scenes(workspace, &comparison.scenes)?;
    let mut differing = 0;
    for scene in &scenes {
        let name = scene.file_stem().unwrap_or_default().to_string_lossy();
        let until = until(&read(scene)?, comparison.steps)?;
        let sides = [(other.as_path(), "other"), (ours.executable(), "this")];
        let mut runs = Vec::with_capacity(sides.len());
        for (program, side) in sides {
            runs.push(run(workspace, program, scene, &folder.join(side), until)?);
        }
        let ratio = runs[1].seconds / runs[0].seconds.max(1e-3);
        let mut told = Vec::new();
        if runs[0].code != runs[1].code {
            told.push(format!("exit code {:?} in place of {:?}", runs[1].code, runs[0].code));
        }
        told.extend(differences(&folder.join("other"), &folder.join("this"))?);
        let words = if told.is_empty() { "same bits".to_owned() } else { told.join("; ") };
        println!("{name:36} {:7.1} s, {ratio:5.2} of the other's  {words}", runs[1].seconds);
        differing += usize::from(!told.is_empty());
    }
    println!("same: {} of {} scenes with the same bits", scenes.len() - differing, scenes.len());
    Ok(differing == 0)
}

/// End of a run.
struct Run {
    code: Option<i32>,
    seconds: f64,
}

fn run(workspace: &Workspace, program: &Path, scene: &Path, out: &Path, until: Option<f64>) -> Outcome<Run> {
    if out.exists() {
        fs::remove_dir_all(out)?;
    }
    let mut command = workspace.process(program);
    command.arg("run").arg(scene).args(["--quiet", "--no-report", "--threads", "1", "--out"]).arg(out);
    if let Some(until) = until {
        command.arg("--until").arg(until.to_string());
    }
    let start = Instant::now();
    let status = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    let status = status.map_err(|error| format!("{}: {error}", program.display()))?;
    Ok(Run { code: status.code(), seconds: start.elapsed().as_secs_f64() })
}

/// The scenes that are named, or all shipped ones, sorted.
fn scenes(workspace: &Workspace, named: &[String]) -> Outcome<Vec<PathBuf>> {
    let shipped = workspace.path("scenes");
    let mut scenes = Vec::new();
    for name in named {
        let path = std::path::absolute(name)?;
        let own = shipped.join(format!("{name}.toml"));
        match () {
            () if path.is_dir() => scenes.extend(scenes_in(&path)?),
            () if path.is_file() => scenes.push(path),
            () if own.is_file() => scenes.push(own),
            () => return Err(format!("{name} is neither a file, nor a folder, nor a scene in scenes/").into()),
        }
    }
    if named.is_empty() { scenes_in(&shipped) } else { Ok(scenes) }
}

fn scenes_in(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let mut scenes = files(folder)?;
    scenes.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    Ok(scenes)
}

/// Files of a folder, not of those below it, sorted.
fn files(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut files: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<Outcome<_>>()?;
    files.retain(|path| path.is_file());
    files.sort();
    Ok(files)
}

/// Time of `steps` steps, if it is before the scene's end; stages whose step is longer have fewer.
fn until(scene: &str, steps: u32) -> Outcome<Option<f64>> {
    let scene: toml::Table = toml::from_str(scene)?;
    let number = |key: &str| {
        let value = scene.get("time")?.get(key)?;
        value.as_float().or_else(|| value.as_integer().map(|value| value as f64))
    };
    Ok(match (number("step"), number("end")) {
        (Some(step), Some(end)) if steps > 0 && step * f64::from(steps) < end => Some(step * f64::from(steps)),
        _ => None,
    })
}

/// What differs between two folders of results: tables that the other one has, and the last frame.
fn differences(other: &Path, this: &Path) -> Outcome<Vec<String>> {
    if !other.is_dir() || !this.is_dir() {
        let said = if other.is_dir() == this.is_dir() { "neither has results" } else { "only one has results" };
        return Ok(vec![said.to_owned()]);
    }
    let mut told = Vec::new();
    let tables = |folder: &Path| -> Outcome<Vec<PathBuf>> {
        let mut tables = files(folder)?;
        tables.retain(|path| path.extension().is_some_and(|extension| extension == "csv"));
        Ok(tables)
    };
    let names = |folder: &Path| -> Outcome<Vec<String>> {
        let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(tables(folder)?.iter().map(name).collect())
    };
    let (before, now) = (names(other)?, names(this)?);
    // A table that is new changes nothing that was there.
    told.extend(before.iter().filter(|name| !now.contains(name)).map(|name| format!("no {name}")));
    for path in tables(other)? {
        let name = path.file_name().unwrap_or_default();
        if this.join(name).is_file() {
            let (a, b) = (read(&path)?, read(&this.join(name))?);
            if a != b {
                told.push(format!("{} {}", name.to_string_lossy(), table_difference(&a, &b)));
            }
        }
    }
    let frames = |folder: &Path| files(&folder.join("frames")).unwrap_or_default();
    let last = |folder: &Path| -> Outcome<Option<(PathBuf, Vec<u8>)>> {
        let Some(path) = frames(folder).pop() else { return Ok(None) };
        let bytes = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Some((PathBuf::from(path.file_name().unwrap_or_default()), bytes)))
    };
    if last(other)? != last(this)? {
        told.push("last frame".to_owned());
    }
    Ok(told)
}

/// Row at which two tables part, and the largest difference of a column over its largest number.
fn table_difference(a: &str, b: &str) -> String {
    if a.lines().next() != b.lines().next() {
        return "has other columns".to_owned();
    }
    let rows = |text: &str| -> Vec<Vec<f64>> {
        let number = |cell: &str| cell.trim().parse().unwrap_or(f64::NAN);
        text.lines().skip(1).map(|line| line.split(',').map(number).collect()).collect()
    };
    let first = a.lines().zip(b.lines()).position(|(a, b)| a != b).map_or_else(
        || format!("has {} rows in place of {}", b.lines().count(), a.lines().count()),
        |line| format!("from row {line} on"),
    );
    let (a, b) = (rows(a), rows(b));
    let columns = a.iter().map(Vec::len).max().unwrap_or(0);
    let at = |row: &Vec<f64>, column: usize| row.get(column).copied().filter(|value| value.is_finite()).unwrap_or(0.0);
    let worst = (0..columns)
        .map(|column| {
            let scale = a.iter().fold(0.0_f64, |scale, row| scale.max(at(row, column).abs()));
            let off = a.iter().zip(&b).fold(0.0_f64, |off, (a, b)| off.max((at(a, column) - at(b, column)).abs()));
            if off == 0.0 { 0.0 } else { off / scale.max(f64::MIN_POSITIVE) }
        })
        .fold(0.0_f64, f64::max);
    format!("{first}, by {worst:.1e} of a column's largest number")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_that_differs_tells_where_and_by_how_much() {
        let a = "t,x\n0,1.0\n1,-4.0\n";
        let told = table_difference(a, "t,x\n0,1.0\n1,-4.4\n");
        assert!(told.starts_with("from row 2 on, by 1.0e-1"), "{told}");
        assert!(table_difference(a, "t,y\n").contains("columns"));
        assert!(table_difference(a, "t,x\n0,1.0\n").starts_with("has 2 rows in place of 3"));
    }

    #[test]
    fn a_run_is_cut_to_some_steps() {
        let scene = "[time]\nstep = 0.1\nend = 1.0";
        assert_eq!(until(scene, 3).unwrap(), Some(0.1 * 3.0));
        assert_eq!((until(scene, 0).unwrap(), until(scene, 30).unwrap()), (None, None));
        assert_eq!(until("[time]\nend = 1", 3).unwrap(), None);
    }
}
