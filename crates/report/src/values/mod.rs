//! Values of a frame's fields along a line and on a plane section, as tables with comma-separated values.
//!
//! Between nodes values are those of the shape functions of the element that holds the point; of fields of contact, which lives on the linear facets of a face's
//! trace (theory/elements#contact), those of functions that are linear on these. Surfaces, lines and single points of a frame have no inside, and no values here.

mod locate;
mod section;

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use stoss_mesh::{Elements, FacetIndex};
use stoss_reference_element::{Face, FaceShape};

use crate::Outcome;
use crate::folder::Folder;
use crate::page::endings;
use crate::picture::{Unfit, Which, number};
use crate::vtu::{Array, Grid};
use locate::{Held, Locator};

const DISPLACEMENT: &str = "displacement";

/// Fields of surfaces: between a surface and what is inside of it they mean nothing.
const CONTACT: [&str; 6] =
    ["contact_pressure", "contact_multiplier", "gap", "contact_status", "friction_traction", "slip"];
/// A field of whole numbers: its value is that of the nearest node.
const STATUS: &str = "contact_status";
/// Weight of the nodes beyond a facet, up to which a point is on the facet.
const ON: f64 = 1.0e-6;

/// Whether a table has columns of contact fields, which are empty at points inside.
pub fn has_contact(table: &str) -> bool {
    let mut names = table.lines().next().unwrap_or_default().split(',');
    names.any(|name| {
        CONTACT
            .iter()
            .any(|field| name.strip_prefix(field).is_some_and(|rest| rest.is_empty() || rest.starts_with('_')))
    })
}

/// Facets that only one element has, as element and number in it.
fn boundary(elements: &Elements) -> BTreeSet<(u32, u8)> {
    FacetIndex::new(elements).boundary().iter().map(|facet| (facet.element, facet.local)).collect()
}

/// Points of the model at which values are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SamplePoints {
    /// Points of equal distances from one end to the other, both included.
    Line {
        /// The ends.
        ends: [[f64; 3]; 2],
        /// Number of points, two at least.
        points: usize,
    },
    /// Points of a square grid on a plane, as far as they are in a body.
    Plane {
        /// A point of the plane and of the grid.
        point: [f64; 3],
        /// Normal of the plane, of any length.
        normal: [f64; 3],
        /// Distance of the points; without it a fiftieth of the longer side of what the plane cuts.
        spacing: Option<f64>,
    },
}

/// Configuration in which points are meant and positions told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Configuration {
    /// The deformed configuration.
    #[default]
    Current,
    /// The configuration of the frames' points.
    Reference,
}

/// Options of a table of values: what is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The frame.
    pub frame: Which,
    /// Place where values are taken.
    pub place: SamplePoints,
    /// Arrays of the frame; all if there is none.
    pub fields: Vec<String>,
    /// Configuration of points and positions.
    pub configuration: Configuration,
}

/// The table: a line of names, then a line for every point and body that holds it. A point in several bodies has a row for each; within a body the first
/// cell counts. Of a line, a point in no body has a row with `inside` 0, whose body and values are empty; of a plane it has none. Values that are not
/// numbers are empty.
///
/// # Errors
/// [`Unfit`] for an option that does not fit; else what is wrong with the folder or the frame, with its name.
pub fn values(path: &Path, options: &Options) -> Outcome<String> {
    let folder = Folder::open(path)?;
    let unfit = |text: String| Unfit(format!("{}: {text}", path.display()));
    if folder.frames.is_empty() {
        let notes: String = folder.notes.iter().map(|note| format!("; {note}")).collect();
        return Err(format!("{}: no frames to take values from{notes}", path.display()).into());
    }
    let frame = number(&folder, options.frame).map_err(unfit)?;
    let grid = folder.grid(frame)?;
    Ok(table(&grid, &folder.bodies, options).map_err(unfit)?)
}

fn table(grid: &Grid, bodies: &[String], options: &Options) -> Result<String, String> {
    let fields = chosen(grid, &options.fields)?;
    let places = places(grid, options.configuration)?;
    let locator = Locator::new(&grid.elements, &places);
    let boundary =
        if fields.iter().any(|(name, _)| CONTACT.contains(name)) { boundary(&grid.elements) } else { BTreeSet::new() };
    let mut out = String::new();
    let mut rows = Rows {
        grid,
        bodies,
        fields: &fields,
        locator: &locator,
        boundary: &boundary,
        found: Vec::new(),
        out: &mut out,
    };
    match options.place {
        SamplePoints::Line { ends: [from, to], points } => {
            let way: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
            let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !(length.is_normal() && points >= 2) {
                return Err("--line: give two different points of finite numbers, and at least 2 as --points".into());
            }
            rows.header(&["distance"]);
            for k in 0..points {
                let part = k as f64 / (points - 1) as f64;
                let x = std::array::from_fn(|i| if k + 1 == points { to[i] } else { from[i] + part * way[i] });
                rows.of(&[part * length], x, true);
            }
        }
        SamplePoints::Plane { point, normal, spacing } => {
            let section = section::PlaneGrid::new(&grid.elements, &places, point, normal, spacing)?;
            rows.header(&["u", "v"]);
            section.points().for_each(|([u, v], x)| rows.of(&[u, v], x, false));
            if rows.out.lines().nth(1).is_none() {
                return Err("--plane: no point of the grid is in a body; choose a smaller --spacing".into());
            }
        }
    }
    Ok(out)
}

/// The arrays of these names, all without names.
fn chosen<'a>(grid: &'a Grid, names: &[String]) -> Result<Vec<(&'a str, &'a Array)>, String> {
    if grid.elements.is_empty() {
        return Err("the frame has no deformable bodies, and only these have values inside".into());
    }
    if names.is_empty() {
        return Ok(grid.point_data.iter().map(|(name, array)| (name.as_str(), array)).collect());
    }
    let one = |name: &String| {
        let known = || grid.point_data.keys().cloned().collect::<Vec<_>>().join(", ");
        let found = grid.point_data.get_key_value(name).map(|(name, array)| (name.as_str(), array));
        found.ok_or_else(|| format!("--field {name}: there is no such array in the frame; there are {}", known()))
    };
    names.iter().map(one).collect()
}

/// Places of the points.
fn places(grid: &Grid, configuration: Configuration) -> Result<Vec<[f64; 3]>, String> {
    let displacement = grid.point_data.get(DISPLACEMENT).filter(|array| array.components == 3);
    match (configuration, displacement) {
        (Configuration::Reference, _) => Ok(grid.points.clone()),
        (Configuration::Current, Some(array)) => {
            let moved = |(k, x): (usize, &[f64; 3])| std::array::from_fn(|i| x[i] + array.row(k)[i]);
            Ok(grid.points.iter().enumerate().map(moved).collect())
        }
        (Configuration::Current, None) => {
            Err("the frame has no displacement, so that current positions are not known: \
                                               choose --configuration reference"
                .into())
        }
    }
}

/// Names of the components of an array.
fn components(name: &str, count: usize) -> Vec<String> {
    match count {
        1 => vec![name.to_owned()],
        _ => endings(name, count).into_iter().map(|ending| format!("{name}_{ending}")).collect(),
    }
}

/// Writes the rows.
struct Rows<'a> {
    grid: &'a Grid,
    bodies: &'a [String],
    fields: &'a [(&'a str, &'a Array)],
    locator: &'a Locator<'a>,
    boundary: &'a BTreeSet<(u32, u8)>,
    found: Vec<Held>,
    out: &'a mut String,
}

impl Rows<'_> {
    fn header(&mut self, first: &[&str]) {
        let fields = self.fields.iter().flat_map(|(name, array)| components(name, array.components));
        let names = first.iter().chain(&["x", "y", "z", "inside", "body"]).map(|name| (*name).to_owned());
        self.out.push_str(&names.chain(fields).collect::<Vec<_>>().join(","));
        self.out.push('\n');
    }

    /// The rows of a point at `x`, and one that says that it is in no body if `always`.
    fn of(&mut self, first: &[f64], x: [f64; 3], always: bool) {
        let mut found = std::mem::take(&mut self.found);
        self.locator.find(x, &mut found);
        let mut told: Vec<usize> = Vec::new();
        for held in &found {
            let body = self.body(held.cell);
            if told.contains(&body) {
                continue;
            }
            told.push(body);
            self.position(first, x);
            let name = self.bodies.get(body).cloned().unwrap_or_else(|| format!("body {body}"));
            let _ = write!(self.out, "1,{name}"); // cannot fail: a text grows.
            let nodes = &self.grid.elements[held.cell];
            let facet = self.facet(held);
            for (name, array) in self.fields {
                for k in 0..array.components {
                    let value: f64 = match facet {
                        _ if !CONTACT.contains(name) => {
                            nodes.iter().zip(&held.weights).map(|(&n, w)| w * array.row(n as usize)[k]).sum()
                        }
                        None => f64::NAN,
                        Some((facet, weights)) => {
                            let at = |n: u8| array.row(nodes[usize::from(n)] as usize)[k];
                            let weighted = || facet.nodes.iter().zip(weights);
                            if *name == STATUS {
                                let nearest = weighted().max_by(|(_, a), (_, b)| a.total_cmp(b));
                                nearest.map_or(f64::NAN, |(&n, _)| at(n))
                            } else {
                                // A node without a weight may be without a value, too.
                                weighted().filter(|(_, w)| *w > ON).map(|(&n, w)| w * at(n)).sum()
                            }
                        }
                    };
                    self.out.push(',');
                    if value.is_finite() {
                        let _ = write!(self.out, "{value:e}"); // cannot fail: as above.
                    }
                }
            }
            self.out.push('\n');
        }
        if found.is_empty() && always {
            self.position(first, x);
            self.out.push_str("0,");
            let empty = self.fields.iter().map(|(_, array)| array.components).sum();
            self.out.extend(std::iter::repeat_n(',', empty));
            self.out.push('\n');
        }
        self.found = found;
    }

    /// The face on the surface of its body on which a point of an element is, with the weights of the face's nodes there.
    fn facet(&self, held: &Held) -> Option<(&'static Face, FaceShape)> {
        let kind = self.grid.elements.kind(held.cell);
        let faces = kind.faces();
        let is_on = |local: usize| {
            let of_others = (0..held.weights.len()).filter(|&k| !faces[local].nodes.contains(&(k as u8)));
            let beyond: f64 = of_others.map(|k| held.weights[k].abs()).sum();
            beyond <= ON && self.boundary.contains(&(held.cell as u32, local as u8))
        };
        let face = &faces[(0..faces.len()).find(|&local| is_on(local))?];
        // In natural coordinates faces are plane, and the linear functions of the cell are those of the face on it.
        let corners = (kind.table().linear.table().shape)(held.xi);
        let mut xi = [0.0; 2];
        for (&n, vertex) in face.nodes.iter().zip(face.kind.linear().vertices()) {
            (0..2).for_each(|d| xi[d] += corners[usize::from(n)] * vertex[d]);
        }
        Some((face, face.kind.piecewise_shape(xi)))
    }

    fn position(&mut self, first: &[f64], x: [f64; 3]) {
        for value in first.iter().chain(&x) {
            let _ = write!(self.out, "{value:e},"); // cannot fail: a text grows.
        }
    }

    fn body(&self, cell: usize) -> usize {
        let number = self.grid.cell_data.get("body").and_then(|array| array.values.get(cell));
        number.map_or(0, |number| number.clamp(0.0, 1e6) as usize)
    }
}
