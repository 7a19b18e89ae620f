//! `run.json`: what the other files do not say of a run and what people want to read beside its results.

use super::{Drawing, OutputError};
use crate::build::Probe;
use crate::scene::{Dimension, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use stoss_solver::Model;

/// Names, plan and scene of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Names of solids, surfaces, lines and points, by the number that the cell field `body` of the frames has.
    pub bodies: Vec<String>,
    /// Lines of the plan that `stoss check` prints.
    pub plan: Vec<String>,
    /// File of the scene as it was named.
    pub file: String,
    /// Text of the scene.
    pub scene: String,
    /// What the bodies are sections of, if they are: they are seen along z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<String>,
    /// Labels of the units, if the scene says what its numbers are measured in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<UnitLabels>,
}

/// The labels of a system of units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UnitLabels {
    /// Name of the system, for instance `mm-t-s`.
    pub system: String,
    /// Labels by what a number measures: `length`, `stress` and the others of [`Dimension`].
    pub labels: BTreeMap<String, String>,
    /// Labels of the columns of `probes.csv`.
    pub probes: BTreeMap<String, String>,
}

impl UnitLabels {
    /// Labels of a scene and its probes; nothing if the scene names no units.
    pub fn new(scene: &Scene, probes: &[Probe]) -> Option<Self> {
        let units = scene.header.units?;
        let dimensions = Dimension::NAMES.iter().filter_map(|name| Dimension::from_name(name));
        let labels = dimensions.map(|dimension| (dimension.name().to_owned(), units.label(dimension))).collect();
        // The number of a node has none.
        let columns = probes.iter().flat_map(|probe| {
            let label = units.label(probe.quantity.dimension());
            let columns = probe.columns().into_iter().filter(|column| !column.ends_with(".node"));
            columns.map(move |column| (column, label.clone()))
        });
        Some(Self { system: units.name().to_owned(), labels, probes: columns.collect() })
    }
}

impl Description {
    /// The description of a model and what is drawn beside its solids.
    pub fn new(model: &Model, drawing: &Drawing) -> Self {
        let solids = model.bodies.iter().map(|body| body.solid.name().to_owned());
        let surfaces = drawing.surfaces.iter().map(|surface| surface.name.clone());
        let lines = drawing.lines.iter().map(|line| line.name.clone());
        let points = drawing.points.iter().map(|point| point.name.clone());
        Self { bodies: solids.chain(surfaces).chain(lines).chain(points).collect(), ..Self::default() }
    }

    /// Writes it into a folder of results.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let path = folder.join("run.json");
        let text = serde_json::to_string_pretty(self)
            .map_err(|e| OutputError::Damaged { path: path.clone(), reason: e.to_string() })?;
        std::fs::write(&path, text + "\n").map_err(OutputError::io(&path))
    }
}
