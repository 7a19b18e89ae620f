//! Pictures drawn from the frames and tables of a run, as small SVG texts, for the report and for `cargo xtask gallery`.
//!
//! To add one, add a row to `PICTURES`.

mod interface;
mod pictures;

use std::path::{Path, PathBuf};

use crate::plot::{self, Labels, Series};
use crate::program::Program;
use crate::table::Table;
use crate::vtu::{self, Grid};
use crate::workspace::{Outcome, Workspace, read, write};
pub use interface::{Interface, Sides, segments};
use pictures::{PICTURES, STILLS};
pub use pictures::{Picture, of};
use stoss_report::paint::{Camera, Primitives, Shot, Style, columns, draw};

/// Widest snapshot of a single row, and widest row, in pixels.
const SHOT: f64 = 300.0;
const ROW: f64 = 1260.0;

/// Draws all pictures of `docs/gallery`, or that of one scene.
pub fn command(workspace: &Workspace, scene: Option<&str>) -> Outcome<bool> {
    let shipped = || PICTURES.iter().filter_map(|picture| Some((picture, picture.gallery?)));
    let chosen: Vec<(&Picture, &[&str])> =
        shipped().filter(|(picture, _)| scene.is_none_or(|scene| scene == picture.scene)).collect();
    let stills: Vec<_> = STILLS.iter().filter(|still| scene.is_none_or(|scene| scene == still.scene)).collect();
    if chosen.is_empty() && stills.is_empty() {
        let known = shipped().map(|(picture, _)| picture.scene).chain(STILLS.iter().map(|still| still.scene));
        let known: Vec<&str> = known.collect();
        return Err(format!("no picture {scene:?}; there are {known:?}").into());
    }
    let program = Program::build(workspace)?;
    for (picture, compare) in chosen {
        let folder = run(workspace, &program, picture.scene, None)?;
        save(workspace, picture.scene, &snapshots(picture, picture.fields[0], &folder)?)?;
        if !compare.is_empty() {
            let mut runs = vec![(picture.scene, folder)];
            for other in compare {
                runs.push((other, run(workspace, &program, other, None)?));
            }
            save(workspace, &format!("{}-energy", picture.scene), &energies(&runs)?)?;
        }
    }
    for still in stills {
        let folder = run(workspace, &program, still.scene, Some(still.until))?;
        let file = format!("docs/gallery/{}.png", still.scene);
        program.picture(&folder, &workspace.path(&file), still.options)?;
        println!("gallery: wrote {file}");
    }
    Ok(true)
}

/// A picture of one frame for a report, coloured by the first array that is there.
pub fn last_frame(grid: &Grid) -> Outcome<String> {
    let field = ["von_mises", "velocity", "displacement"].into_iter().find(|name| grid.point_data.contains_key(*name));
    let field = field.ok_or("the frame has nothing to colour it by")?;
    let shot = Shot { caption: String::new(), surface: Primitives::new(grid, field)? };
    let style = Style { title: "last frame", label: &field.replace('_', " "), width: 300.0, range: None };
    Ok(draw(&[shot], Camera { azimuth: -58.0, elevation: 24.0 }, &style))
}

/// Runs a shipped scene, to a time or to its end, and returns its output folder.
fn run(workspace: &Workspace, program: &Program, scene: &str, until: Option<f64>) -> Outcome<PathBuf> {
    let folder = workspace.target()?.join("gallery").join(scene);
    let ending = program.run(&workspace.path(format!("scenes/{scene}.toml")), &folder, until)?;
    if ending.code != Some(0) {
        return Err(
            format!("{scene} ended with {:?}; see {}", ending.code, folder.with_extension("log").display()).into()
        );
    }
    println!("gallery: ran {scene} in {:.1} s", ending.seconds);
    Ok(folder)
}

fn save(workspace: &Workspace, name: &str, svg: &str) -> Outcome<()> {
    let file = format!("docs/gallery/{name}.svg");
    write(&workspace.path(&file), svg)?;
    println!("gallery: wrote {file} ({} kB)", svg.len().div_ceil(1000));
    Ok(())
}

/// A row of snapshots of a run, coloured by one of the picture's fields.
pub fn snapshots(picture: &Picture, field: &str, folder: &Path) -> Outcome<String> {
    let frames = vtu::collection(&read(&folder.join("frames.pvd"))?)?;
    let mut shots: Vec<Shot> = Vec::new();
    for (time, file) in chosen(&frames, picture.times) {
        let surface = Primitives::new(&vtu::load(&folder.join(file))?, field)?;
        shots.push(Shot { caption: format!("t = {time:.2}"), surface });
    }
    let columns = columns(shots.len());
    let width = if columns < shots.len() { ROW / columns as f64 } else { SHOT };
    let style = Style { title: picture.title, label: &field.replace('_', " "), width, range: None };
    Ok(draw(&shots, picture.camera, &style))
}

/// The frame nearest to each time, each once; times beyond the last frame, by more than frames are apart, are left out.
fn chosen<'a>(frames: &'a [(f64, String)], times: &[f64]) -> Vec<&'a (f64, String)> {
    let last = frames.last().map_or(0.0, |(time, _)| *time);
    let apart = frames.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(0.0, f64::max);
    let mut chosen: Vec<&(f64, String)> = Vec::new();
    for wanted in times.iter().filter(|time| **time < last + apart) {
        let nearest = frames.iter().min_by(|a, b| (a.0 - wanted).abs().total_cmp(&(b.0 - wanted).abs()));
        if let Some(frame) = nearest.filter(|frame| chosen.last().is_none_or(|last| last.0 < frame.0)) {
            chosen.push(frame);
        }
    }
    chosen
}

/// The segments between two bodies at the picture's times, as far as the run has come and the bodies are near each other.
pub fn interfaces(picture: &Picture, folder: &Path) -> Outcome<Vec<String>> {
    let frames = vtu::collection(&read(&folder.join("frames.pvd"))?)?;
    let mut drawn = Vec::new();
    for (time, file) in chosen(&frames, picture.segments) {
        let interface = Interface::new(&vtu::load(&folder.join(file))?, picture.sides)?;
        let from = if interface.is_seen_from_above() { "from above" } else { "along the normal" };
        drawn.extend(segments(&format!("Segments {from}, t = {time:.2}"), &interface)?);
    }
    Ok(drawn)
}

/// Total energy over time, relative to its value at the start.
fn energies(runs: &[(&str, PathBuf)]) -> Outcome<String> {
    let mut series = Vec::new();
    for (name, folder) in runs {
        let balance = Table::read(&folder.join("balance.csv"))?;
        let total = balance.column("total")?;
        let start = total.first().copied().unwrap_or(1.0);
        series.push(Series::new(name, balance.column("time")?, total.iter().map(|energy| energy / start)));
    }
    Ok(plot::linear(Labels { title: "Total energy over its value at the start", x: "time", y: "" }, &series))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_chosen_by_time_and_once() {
        let frames: Vec<(f64, String)> = (0..=3).map(|k| (f64::from(k), format!("{k}"))).collect();
        let names = |times: &[f64]| chosen(&frames, times).iter().map(|f| f.1.clone()).collect::<String>();
        assert_eq!(names(&[0.0, 1.2, 2.9]), "013");
        assert_eq!(names(&[0.0, 0.2, 2.6, 3.4, 9.0]), "03");
        assert_eq!(chosen(&[], &[1.0]).len(), 0);
    }
}
