//! The page that says why a run stopped or came out wrong, from `diagnosis.json` and the last frame: one HTML file that needs neither a network
//! nor another file.
//!
//! Not here: finding causes (`stoss::diagnosis`).

use std::fmt::Write;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;

use crate::folder::Folder;
use crate::page::escaped;
use crate::paint::{Camera, Line, Shot, Style, draw};
use crate::picture::{CAMERA, coloured, rounded, time};
use crate::plot::{Labels, Series, logarithmic};
use crate::vtu::{Array, Grid};
use crate::{Outcome, read};

/// Name of the page in a folder of results.
pub const NAME: &str = crate::folder::DIAGNOSIS_PAGE;
/// Name of the file that it is made from.
const FILE: &str = crate::folder::DIAGNOSIS;

/// Cells around the place that its picture shows.
const NEAR: usize = 12;
/// Widths of the pictures in pixels.
const WIDE: f64 = 520.0;
const SMALL: f64 = 320.0;
/// Radius of the circle about the place, a part of what is shown, and its corners.
const RADIUS: f64 = 0.07;
const CORNERS: usize = 36;
/// Part of the direction from the middle of the model to the place in that of the eye.
const OUTWARD: f64 = 1.5;

const STYLE: &str = "body{font:16px/1.45 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}h1{font-size:1.4em}h2{font-size:1.1em;margin:1.6em 0 .3em}\
    .sure{color:#666;font-weight:normal}code{background:#f2f2f2;padding:0 .2em}figure{display:inline-block;margin:0 1em 0 0;vertical-align:top}\
    svg{max-width:100%;height:auto}dt{font-weight:bold}dd{margin:0 0 .5em 1.5em}li{margin:.2em 0}table{border-collapse:collapse}td,th{padding:.2em .8em .2em 0;text-align:left;vertical-align:top}";

/// What `diagnosis.json` has; keys that are missing are empty.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Diagnosis {
    title: String,
    what: String,
    step: u64,
    time: f64,
    place: Place,
    findings: Vec<Finding>,
    attempts: Vec<Attempt>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Place {
    text: String,
    position: Option<[f64; 3]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Finding {
    cause: String,
    confidence: String,
    place: Place,
    sentence: String,
    evidence: Vec<String>,
    remedies: Vec<Remedy>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Remedy {
    text: String,
    changes: Vec<Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Attempt {
    dt: f64,
    reason: String,
    residuals: Vec<f64>,
    changing: Vec<(String, u32)>,
}

/// Writes the page of a folder of results; nothing if the folder has no diagnosis.
///
/// # Errors
/// What is wrong with the file, and what the system says about writing.
pub fn write(folder: &Path) -> Outcome<Option<PathBuf>> {
    let file = folder.join(FILE);
    if !file.is_file() {
        return Ok(None);
    }
    let diagnosis: Diagnosis =
        serde_json::from_str(&read(&file)?).map_err(|error| format!("{}: {error}", file.display()))?;
    let (path, scratch) = (folder.join(NAME), folder.join(".diagnosis.html.part"));
    std::fs::write(&scratch, text(&diagnosis, folder)).map_err(|error| format!("{}: {error}", scratch.display()))?;
    std::fs::rename(&scratch, &path).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(Some(path))
}

fn text(diagnosis: &Diagnosis, folder: &Path) -> String {
    let Diagnosis { title, what, step, time, place, findings, attempts } = diagnosis;
    let folder = Folder::open(folder).ok();
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"generator\" content=\"Stoss\">\n<title>{title}: diagnosis</title>\
         <style>{STYLE}</style></head><body>\n<h1>{title}: diagnosis</h1>\n<dl>\n",
        title = escaped(title),
    );
    // Writing to a String does not fail.
    let first = findings.first();
    let shown = first.map_or(place, |first| &first.place);
    if !shown.text.is_empty() {
        let _ = writeln!(out, "<dt>Where</dt><dd>{}</dd>", marked(&shown.text));
    }
    if !what.is_empty() {
        let _ = writeln!(out, "<dt>What happened</dt><dd>{}</dd>", marked(what));
    }
    let _ =
        writeln!(out, "<dt>Last completed step</dt><dd>step {step}, t = {}</dd>\n</dl>", at(folder.as_ref(), *time));
    let position = shown.position.or(place.position);
    if let Some(pictures) = folder.zip(position).and_then(|(folder, x)| pictures(&folder, x, &shown.text)) {
        out += &pictures;
    }
    for (k, finding) in findings.iter().enumerate() {
        out += &of_finding(k, finding);
    }
    out += &of_attempts(attempts);
    out += "<p>All results are in this folder. <a href=\"report.html\">report.html</a> shows the whole run, if that page was written.</p>\n</body></html>\n";
    out
}

/// A time, with its unit if the run has units.
fn at(folder: Option<&Folder>, value: f64) -> String {
    folder.map_or_else(|| rounded(value).to_string(), |folder| time(folder, value))
}

fn of_finding(number: usize, finding: &Finding) -> String {
    let Finding { cause, confidence, place, sentence, evidence, remedies } = finding;
    let mut out = String::new();
    let sure = match confidence.as_str() {
        "high" => "almost certain",
        "medium" => "likely",
        _ => "possible",
    };
    let heading = if number == 0 { "Cause" } else { "Another possible cause" };
    let title = match cause.as_str() {
        "unknown" => "The cause is not known".to_owned(),
        _ => format!("{heading}: {} <span class=\"sure\">({sure})</span>", escaped(&cause.replace('-', " "))),
    };
    let _ = writeln!(out, "<h2>{title}</h2>\n<p>{}.</p>", marked(sentence));
    if number > 0 {
        let _ = writeln!(out, "<p>Where: {}</p>", marked(&place.text));
    }
    let list = |items: &mut dyn Iterator<Item = String>, kind: &str| {
        let items: String = items.map(|item| format!("<li>{item}</li>\n")).collect();
        if items.is_empty() { items } else { format!("<{kind}>\n{items}</{kind}>\n") }
    };
    out += &list(&mut evidence.iter().map(|item| marked(item)), "ul");
    let remedy = |remedy: &Remedy| {
        let added = remedy.changes.iter().filter_map(|change| change.get("toml")?.as_str());
        let added: String = added.map(|toml| format!("<pre><code>{}</code></pre>", escaped(toml))).collect();
        marked(&remedy.text) + &added
    };
    if !remedies.is_empty() {
        out += "<p>Try:</p>\n";
    }
    out += &list(&mut remedies.iter().map(remedy), "ol");
    out
}

fn of_attempts(attempts: &[Attempt]) -> String {
    if attempts.is_empty() {
        return String::new();
    }
    let name = |k: usize, attempt: &Attempt| format!("{}: step size {:.3e}", k + 1, attempt.dt);
    let series: Vec<Series> = attempts
        .iter()
        .enumerate()
        .filter(|(_, attempt)| !attempt.residuals.is_empty())
        .map(|(k, attempt)| {
            let x: Vec<f64> = (0..attempt.residuals.len()).map(|i| i as f64).collect();
            Series::new(&name(k, attempt), &x, attempt.residuals.iter().copied())
        })
        .collect();
    let mut out = "<h2>The last attempts</h2>\n".to_owned();
    if series.iter().any(|series| series.points.len() > 1) {
        let labels = Labels { title: "Residuals", x: "iteration", y: "relative residual" };
        out += &logarithmic(labels, &series, 1e-16);
    }
    out +=
        "<table>\n<tr><th>step size</th><th>why it failed</th><th>contact points that changed their status</th></tr>\n";
    for attempt in attempts {
        let changing: Vec<String> =
            attempt.changing.iter().take(3).map(|(slot, n)| format!("{slot}: {n} times")).collect();
        let _ = writeln!(
            out,
            "<tr><td>{:.3e}</td><td>{}</td><td>{}</td></tr>",
            attempt.dt,
            marked(&attempt.reason),
            marked(&changing.join("; "))
        );
    }
    out + "</table>\n"
}

/// Text in which `code` is marked.
fn marked(text: &str) -> String {
    let mut out = String::new();
    for (k, piece) in escaped(text).split('`').enumerate() {
        out += &if k % 2 == 1 { format!("<code>{piece}</code>") } else { piece.to_owned() };
    }
    out
}

/// The place in the last frame, near and from afar; nothing if the frame cannot be drawn.
fn pictures(folder: &Folder, place: [f64; 3], text: &str) -> Option<String> {
    let number = folder.frames.len().checked_sub(1)?;
    let grid = folder.grid(number).ok()?;
    let camera = camera(&grid, place);
    let near = svg(folder, &around(&grid, place), place, camera, "detail", WIDE)?;
    let far = svg(folder, &grid, place, camera, "whole model", SMALL)?;
    let time = at(Some(folder), folder.frames[number].time);
    Some(format!(
        "<figure>{near}</figure><figure>{far}</figure>\n<p>The last frame, t = {time}. The circle marks the place: {}. Left: the elements nearby; right: the whole model.</p>\n",
        marked(text)
    ))
}

fn svg(folder: &Folder, grid: &Grid, place: [f64; 3], camera: Camera, caption: &str, width: f64) -> Option<String> {
    let (mut surface, label) = coloured(folder, grid, None, 1.0).ok()?;
    if surface.quads.is_empty() && surface.lines.is_empty() && surface.points.is_empty() {
        return None;
    }
    let places = || surface.places();
    if !places().flatten().chain(place).all(f64::is_finite) {
        return None;
    }
    // A circle, moved towards the eye so that nothing covers it: in a parallel projection its place in the picture is the same. The lowest value has the lightest colour.
    let far = places().map(|x| distance(x, place)).fold(0.0, f64::max);
    let view = camera.view();
    let corner = |k: usize| -> [f64; 3] {
        let (sine, cosine) = (k as f64 * std::f64::consts::TAU / CORNERS as f64).sin_cos();
        let radius = RADIUS * far;
        std::array::from_fn(|i| {
            place[i] + 2.0 * far * view.eye[i] + radius * (cosine * view.right[i] + sine * view.up[i])
        })
    };
    let least = surface.values().filter(|value| value.is_finite()).fold(f64::INFINITY, f64::min);
    let values = vec![if least.is_finite() { least } else { 0.0 }; CORNERS + 1];
    surface.lines.push(Line { points: (0..=CORNERS).map(corner).collect(), values });
    let style = Style { title: "", label: &label, width, range: None };
    Some(draw(&[Shot { caption: caption.to_owned(), surface }], camera, &style))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Camera by which the place is seen: as in other pictures, turned to the side of the model on which it is.
fn camera(grid: &Grid, place: [f64; 3]) -> Camera {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in 0..grid.points.len() {
        let x = crate::paint::deformed(grid, point);
        for i in 0..3 {
            (low[i], high[i]) = (low[i].min(x[i]), high[i].max(x[i]));
        }
    }
    let size = distance(low, high);
    let eye = CAMERA.view().eye;
    let outward = |i: usize| if size > 0.0 { (place[i] - 0.5 * (low[i] + high[i])) / size } else { 0.0 };
    let [x, y, z]: [f64; 3] = std::array::from_fn(|i| eye[i] + OUTWARD * outward(i));
    let flat = x.hypot(y);
    if !flat.is_normal() || !z.is_finite() {
        return CAMERA;
    }
    Camera { azimuth: y.atan2(x).to_degrees(), elevation: z.atan2(flat).to_degrees() }
}

/// The cells around a place: those that are not farther than the nearest [`NEAR`] ones.
fn around(grid: &Grid, place: [f64; 3]) -> Grid {
    let middle = |points: &[u32]| -> f64 {
        let count = points.len().max(1) as f64;
        let corners = points.iter().map(|&point| crate::paint::deformed(grid, point as usize));
        let sum = corners.fold([0.0; 3], |sum, x| std::array::from_fn(|i| sum[i] + x[i]));
        distance(sum.map(|x| x / count), place)
    };
    let elements: Vec<f64> = grid.elements.iter().map(middle).collect();
    let facets: Vec<f64> = grid.facets.iter().map(|cell| middle(cell)).collect();
    let mut all: Vec<f64> = elements.iter().chain(&facets).copied().collect();
    if all.len() <= NEAR {
        return grid.clone();
    }
    all.sort_by(f64::total_cmp);
    let reach = all[NEAR - 1] * (1.0 + 1e-9);
    let body = grid.cell_data.get("body").map(|array| array.values.as_slice()).unwrap_or_default();
    let mut bodies = Vec::new();
    let mut keep = |cell: usize, far: f64| {
        let is_near = far <= reach;
        if is_near {
            bodies.push(body.get(cell).copied().unwrap_or(0.0));
        }
        is_near
    };
    let elements_near = crate::vtu::chosen(&grid.elements, (0..elements.len()).filter(|&k| keep(k, elements[k])));
    let first = elements.len();
    let facets_near: Vec<_> =
        (0..facets.len()).filter(|&k| keep(first + k, facets[k])).map(|k| grid.facets[k]).collect();
    Grid {
        points: grid.points.clone(),
        elements: elements_near,
        facets: facets_near,
        point_data: grid.point_data.clone(),
        cell_data: [("body".to_owned(), Array { components: 1, values: bodies })].into(),
        ..Grid::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_a_diagnosis_has_no_page() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(write(folder.path()).unwrap(), None);
        std::fs::write(folder.path().join(FILE), "[1]").unwrap();
        assert!(write(folder.path()).unwrap_err().to_string().contains(FILE));
    }

    #[test]
    fn the_page_names_cause_place_and_remedies_and_needs_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let json = r#"{"title": "a < b", "what": "step 1 failed", "step": 3, "time": 0.5, "place": {"text": "node 4 of `block`"},
            "findings": [{"cause": "no-support", "confidence": "high", "place": {"text": "node 4 of `block`"}, "sentence": "`block` is free",
                "evidence": ["singular"], "remedies": [{"text": "add it", "changes": [{"kind": "add", "toml": "[[prescribe]]\nset = \"a\""}]}]}],
            "attempts": [{"dt": 0.1, "reason": "no", "residuals": [1.0, 0.1, 0.01], "changing": [["node 1", 4]]}]}"#;
        std::fs::write(folder.path().join(FILE), json).unwrap();
        let page = read(&write(folder.path()).unwrap().unwrap()).unwrap();
        for part in [
            "a &lt; b",
            "node 4 of <code>block</code>",
            "no support",
            "almost certain",
            "[[prescribe]]",
            "<svg",
            "node 1: 4 times",
        ] {
            assert!(page.contains(part), "{part}: {page}");
        }
        assert!(
            !page.contains("http:") && !page.contains("https:")
                || page.matches("http").count() == page.matches("http://www.w3.org").count()
        );
        assert!(!page.contains("src=") && !page.contains("NaN"));
    }

    /// A row of cubes, of which those around the place are left, with all points.
    #[test]
    fn the_picture_shows_what_is_near() {
        let count = 100;
        let corner = |i: usize, y: f64, z: f64| [i as f64, y, z];
        let points = (0..=count)
            .flat_map(|i| [corner(i, 0.0, 0.0), corner(i, 1.0, 0.0), corner(i, 0.0, 1.0), corner(i, 1.0, 1.0)]);
        let cube = |i: usize| [0, 4, 5, 1, 2, 6, 7, 3].map(|k| (4 * i + k) as u32);
        let grid = Grid { points: points.collect(), elements: (0..count).map(cube).collect(), ..Grid::default() };
        let near = around(&grid, [0.5, 0.5, 0.5]);
        assert_eq!(near.elements, (0..NEAR).map(cube).collect());
        assert_eq!(around(&near, [0.5; 3]).elements.len(), NEAR);
    }
}
