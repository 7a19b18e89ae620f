//! `cargo xtask gallery`: pictures drawn from the frames and tables of a run, as small SVG files.
//!
//! To add one, add a row to [`PICTURES`].

mod camera;
mod colour;
mod picture;
mod surface;

use std::path::{Path, PathBuf};

use crate::plot::{self, Labels, Series};
use crate::program::Program;
use crate::table::Table;
use crate::vtu::{self, Grid};
use crate::workspace::{Outcome, Workspace, read, write};
use camera::Camera;
use picture::{Shot, Style};
use surface::Surface;

/// A row of snapshots of one scene.
struct Picture {
    /// Name of the scene, and of the picture.
    scene: &'static str,
    /// Array that gives the colour; of vectors the length.
    field: &'static str,
    /// What the colour bar says.
    label: &'static str,
    /// Title above the snapshots.
    title: &'static str,
    /// Times of the snapshots; the nearest frames are taken.
    times: &'static [f64],
    /// Where it is seen from.
    camera: Camera,
    /// Scenes with the same data and another scheme, to compare the energies with; no such chart if there is none.
    compare: &'static [&'static str],
}

/// All pictures.
const PICTURES: &[Picture] = &[Picture {
    scene: "ball-plate",
    field: "von_mises",
    label: "von Mises stress",
    title: "Hollow ball on plate",
    times: &[0.0, 0.16, 0.3, 0.6],
    camera: Camera { azimuth: -58.0, elevation: 24.0 },
    compare: &["ball-plate-modified", "ball-plate-midpoint"],
}];

/// Draws all pictures, or that of one scene.
pub fn command(workspace: &Workspace, scene: Option<&str>) -> Outcome<bool> {
    let chosen: Vec<&Picture> =
        PICTURES.iter().filter(|picture| scene.is_none_or(|scene| scene == picture.scene)).collect();
    if chosen.is_empty() {
        let known: Vec<&str> = PICTURES.iter().map(|picture| picture.scene).collect();
        return Err(format!("no picture {scene:?}; there are {known:?}").into());
    }
    let program = Program::build(workspace)?;
    for picture in chosen {
        let folder = run(workspace, &program, picture.scene)?;
        save(workspace, picture.scene, &snapshots(picture, &folder)?)?;
        if !picture.compare.is_empty() {
            let mut runs = vec![(picture.scene, folder)];
            for other in picture.compare {
                runs.push((other, run(workspace, &program, other)?));
            }
            save(workspace, &format!("{}-energy", picture.scene), &energies(&runs)?)?;
        }
    }
    Ok(true)
}

/// A picture of one frame for a report, coloured by the first array that is there.
pub fn last_frame(grid: &Grid) -> Outcome<String> {
    let field = ["von_mises", "velocity", "displacement"].into_iter().find(|name| grid.point_data.contains_key(*name));
    let field = field.ok_or("the frame has nothing to colour it by")?;
    let shot = Shot { caption: String::new(), surface: Surface::new(grid, field)? };
    let style = Style { title: "last frame", label: &field.replace('_', " "), width: 300.0 };
    Ok(picture::draw(&[shot], Camera { azimuth: -58.0, elevation: 24.0 }, &style))
}

/// Runs a shipped scene and returns its output folder.
fn run(workspace: &Workspace, program: &Program, scene: &str) -> Outcome<PathBuf> {
    let folder = workspace.target()?.join("gallery").join(scene);
    let ending = program.run(&workspace.path(format!("scenes/{scene}.toml")), &folder, None)?;
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

fn snapshots(picture: &Picture, folder: &Path) -> Outcome<String> {
    let frames = vtu::collection(&read(&folder.join("frames.pvd"))?)?;
    let mut shots = Vec::new();
    for wanted in picture.times {
        let nearest = frames.iter().min_by(|a, b| (a.0 - wanted).abs().total_cmp(&(b.0 - wanted).abs()));
        let (time, file) = nearest.ok_or("frames.pvd names no frame")?;
        let surface = Surface::new(&vtu::load(&folder.join(file))?, picture.field)?;
        shots.push(Shot { caption: format!("t = {time:.2}"), surface });
    }
    let style = Style { title: picture.title, label: picture.label, width: 300.0 };
    Ok(picture::draw(&shots, picture.camera, &style))
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
