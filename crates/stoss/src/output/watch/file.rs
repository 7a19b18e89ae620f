//! What a run leaves for `stoss judge`, and the judgement of stored results.

use super::model::watched;
use crate::left_out;
use crate::output::{OutputError, frames};
use serde::{Deserialize, Serialize};
use std::path::Path;
use stoss_mesh::Elements;
use stoss_mesh_io::VtuData;
use stoss_watch::{
    BalanceState, BalanceWatch, Finding, Judge, KeptGaps, Limits, TiedPair, Verdict, Watch, WatchBody, WatchModel,
    WatchShape,
};

/// Name of the file that says what the frames do not.
const FILE: &str = "watch.json";

/// What `stoss judge` needs to know beside the frames.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct WatchFile {
    limits: Limits,
    bodies: Vec<NamedBody>,
    ties: Vec<Tied>,
    /// Pairs of bodies between which a contact is named.
    contacts: Vec<[usize; 2]>,
    /// Gaps that contacts keep.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    kept: Vec<KeptGaps>,
    /// The balance as it was at the beginning; none in statics.
    balance: Option<BalanceWatch>,
    /// The finding that the scene lacks something of its deck.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    left_out: Option<Finding>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct NamedBody {
    name: String,
    first_node: u32,
    nodes: u32,
    #[serde(alias = "hexahedra")]
    elements: usize,
    /// Facets of the surface of a rigid body, which has no elements.
    #[serde(default)]
    facets: usize,
    /// Whether that surface encloses no volume.
    #[serde(default)]
    is_open: bool,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Tied {
    bodies: [usize; 2],
    nodes: Vec<u32>,
}

impl WatchFile {
    /// The file of what is watched.
    pub fn new(
        model: &WatchModel,
        limits: Limits,
        (contacts, kept): (Vec<[usize; 2]>, Vec<KeptGaps>),
        balance: Option<BalanceWatch>,
        left_out: Option<Finding>,
    ) -> Self {
        let bodies = model.bodies.iter().map(|body| {
            let (elements, facets, is_open) = match &body.shape {
                WatchShape::Solid(elements) => (elements.len(), 0, false),
                WatchShape::Surface { facets, is_closed } => (0, facets.len(), !is_closed),
            };
            NamedBody {
                name: body.name.clone(),
                first_node: body.nodes.start,
                nodes: body.nodes.len() as u32,
                elements,
                facets,
                is_open,
            }
        });
        let ties = model.ties.iter().map(|tie| Tied { bodies: tie.bodies, nodes: tie.nodes.clone() });
        Self { bodies: bodies.collect(), ties: ties.collect(), limits, contacts, kept, balance, left_out }
    }

    /// Writes it into a folder of results.
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let path = folder.join(FILE);
        let text = serde_json::to_string(self)
            .map_err(|e| OutputError::Damaged { path: path.clone(), reason: e.to_string() })?;
        std::fs::write(&path, text + "\n").map_err(OutputError::io(&path))
    }

    /// Name of a body.
    pub fn name(&self, body: usize) -> &str {
        &self.bodies[body].name
    }

    fn judge(&self) -> Judge {
        let nodes = |body: &NamedBody| body.first_node..body.first_node + body.nodes;
        let bodies = self.bodies.iter().map(|body| (body.name.clone(), nodes(body)));
        Judge::new(bodies, self.contacts.clone(), self.limits)
    }

    /// Whether a frame has the cells of these bodies.
    fn fits(&self, data: &VtuData) -> bool {
        let elements: usize = self.bodies.iter().map(|body| body.elements).sum();
        let facets: usize = self.bodies.iter().map(|body| body.facets).sum();
        (data.elements.len(), data.facets.len()) == (elements, facets)
    }

    /// The bodies of a frame, whose elements, and then facets, stand body after body.
    fn model(&self, reference: Vec<f64>, data: &VtuData) -> WatchModel {
        let (mut cells, mut facets) = (data.elements.cells(), data.facets.iter());
        let bodies = self.bodies.iter().map(|body| WatchBody {
            name: body.name.clone(),
            nodes: body.first_node..body.first_node + body.nodes,
            shape: if body.facets > 0 {
                let facets = facets.by_ref().take(body.facets).map(|face| watched(&face.linear())).collect();
                WatchShape::Surface { facets, is_closed: !body.is_open }
            } else {
                let mut elements = Elements::new();
                cells.by_ref().take(body.elements).for_each(|(kind, nodes)| elements.push(kind, nodes));
                WatchShape::Solid(elements)
            },
        });
        let bodies = bodies.collect();
        let ties = self.ties.iter().map(|tie| TiedPair { nodes: tie.nodes.clone(), bodies: tie.bodies });
        WatchModel { bodies, reference, ties: ties.collect() }
    }
}

/// Rows of a stored `balance.csv`: step, time and what the watch looks at.
fn stored_balance(folder: &Path) -> Result<Vec<(u64, f64, BalanceState)>, OutputError> {
    let path = folder.join("balance.csv");
    let text = std::fs::read_to_string(&path).map_err(OutputError::io(&path))?;
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let mut rows = Vec::new();
    for (number, line) in lines.enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        let value =
            |name: &str| -> Option<f64> { cells.get(heads.iter().position(|head| *head == name)?)?.parse().ok() };
        let three = |names: [&str; 3]| -> Option<[f64; 3]> {
            let [x, y, z] = names.map(value);
            Some([x?, y?, z?])
        };
        let row = || {
            let state = BalanceState {
                linear: three(["lx", "ly", "lz"])?,
                angular: three(["jx", "jy", "jz"])?,
                energy: value("kinetic")? + value("strain")?,
                total: value("total")?,
                // A scene without contact has no such column.
                closing_loss: value("closing_loss").unwrap_or(0.0),
                impact_loss: value("impact_loss").unwrap_or(0.0),
                impact_deformable: value("impact_deformable").unwrap_or(0.0),
                impact_capped: value("impact_capped").unwrap_or(0.0),
                // Nor has one whose bodies lose nothing these.
                damping: ["damping", "plastic_loss", "viscous_loss", "softening_loss"]
                    .map(|column| value(column).unwrap_or(0.0))
                    .iter()
                    .sum(),
            };
            Some((value("step")? as u64, value("time")?, state))
        };
        let reason = || format!("line {} has no number where one is expected", number + 2);
        rows.push(row().ok_or_else(|| OutputError::Unreadable { path: path.clone(), reason: reason() })?);
    }
    Ok(rows)
}

/// Verdict on the balance and on the stored frames of a run. Between frames that are several steps apart a body may pass through another unseen.
///
/// # Errors
/// [`OutputError`] if files are missing, cannot be read or do not fit each other.
pub fn judge_folder(folder: &Path) -> Result<Verdict, OutputError> {
    let path = folder.join(FILE);
    let damaged = |path: &Path, reason: String| OutputError::Unreadable { path: path.to_path_buf(), reason };
    let text = std::fs::read_to_string(&path).map_err(OutputError::io(&path))?;
    let file: WatchFile = serde_json::from_str(&text).map_err(|e| damaged(&path, e.to_string()))?;
    let mut judge = file.judge();
    let mut watch: Option<Watch> = None;
    let mut previous: Option<Vec<f64>> = None;
    for stored in frames::stored(folder)? {
        let (step, path, data) = (stored.step, stored.file(), stored.read()?);
        let displacement = data.point_data.get("displacement").filter(|field| field.components == 3);
        let Some(displacement) = displacement else {
            let reason = "it has no field `displacement`: run again with it in [output] fields".into();
            return Err(damaged(path, reason));
        };
        let reference: Vec<f64> = data.points.iter().flatten().copied().collect();
        if displacement.values.len() != reference.len() || !file.fits(&data) {
            return Err(damaged(path, format!("its sizes do not fit {FILE}")));
        }
        let q: Vec<f64> = reference.iter().zip(&displacement.values).map(|(x, u)| x + u).collect();
        let watch = match &mut watch {
            Some(watch) => watch,
            none => none.insert(Watch::new(file.model(reference, &data))?),
        };
        let time = data.time.unwrap_or(f64::NAN);
        let seen = watch.geometry(&q, previous.as_deref()).beyond(&file.kept, time);
        judge.observe(step, time, &seen, &watch.solids(&q));
        previous = Some(q);
    }
    if let Some(mut balance) = file.balance {
        for (step, time, state) in stored_balance(folder)? {
            for finding in balance.observe(step, time, &state) {
                judge.add(finding);
            }
        }
        judge.add_all(balance.standing(None));
    }
    if watch.is_none() {
        return Err(damaged(folder, "there are no frames".into()));
    }
    Ok(left_out::with(judge.verdict(), file.left_out.as_ref()))
}
