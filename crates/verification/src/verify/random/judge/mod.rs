//! Whether a run is right, by what is known of its scene, and without the watch and the contact search.
//!
//! It reads what any user gets: frames, tables, probes. Momenta and energy are integrated over the bodies of the frames, forces of loads follow from the
//! scene, and depths are found by brute force. Each criterion has a figure, a value up to which a run is right, and one above which it is wrong: such a run must
//! not be called sound. In between nothing is said.

mod books;
mod cell;
mod depth;
mod equilibrium;
mod extremes;
mod model;
mod motion;
mod vector;

use super::scene::Case;
use crate::table::Table;
use crate::verify::Run;
use crate::verify::check::number;
use crate::verify::numbers::larger;
use crate::workspace::Outcome;
use model::Model;

/// Depth of the deepest point over the way of a tool: in the mean over the contact it is a third or less, which is the relative error of the force.
const SUNK: [f64; 2] = [0.03, 0.2];

/// What the judge says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Answer {
    /// All that is known holds.
    Right,
    /// Something lies between right and wrong, or nothing is known.
    Unknown,
    /// The run must not be called sound.
    Wrong,
}

/// A figure with its bounds.
#[derive(Clone, Debug)]
pub struct Criterion {
    /// What was measured.
    pub name: &'static str,
    /// The figure.
    pub figure: f64,
    /// Up to this it is right.
    pub right: f64,
    /// Above this it is wrong.
    pub wrong: f64,
    /// Place or thing that the figure is of.
    pub place: String,
    /// Whether the scheme promises it: what breaks it is a failure of the program, whatever the verdict.
    pub is_promise: bool,
}

/// All criteria of a run.
#[derive(Clone, Debug, Default)]
pub struct Judgement {
    /// Criteria in the order in which they were measured.
    pub criteria: Vec<Criterion>,
    /// Largest depth of a node in another body, in edges.
    pub depth: f64,
}

/// What all criteria need.
struct Evidence<'a> {
    case: &'a Case,
    model: Model,
    balance: Table,
    probes: Option<Table>,
}

impl Criterion {
    /// A figure with its bounds.
    pub fn new(name: &'static str, figure: f64, [right, wrong]: [f64; 2]) -> Self {
        Self { name, figure, right, wrong, place: String::new(), is_promise: false }
    }

    /// Adds where.
    fn at(self, place: impl Into<String>) -> Self {
        Self { place: place.into(), ..self }
    }

    /// Marks the criterion as one that the scheme promises.
    fn promised(self) -> Self {
        Self { is_promise: true, ..self }
    }

    /// What it says alone. A figure that is no number is wrong.
    pub fn answer(&self) -> Answer {
        match self.figure {
            figure if figure <= self.right => Answer::Right,
            figure if figure <= self.wrong => Answer::Unknown,
            _ => Answer::Wrong,
        }
    }

    /// The criterion in one line.
    pub fn text(&self) -> String {
        let place = if self.place.is_empty() { String::new() } else { format!(" ({})", self.place) };
        format!("{} {}{place}", self.name, number(self.figure))
    }
}

impl Judgement {
    /// The worst of all criteria.
    pub fn answer(&self) -> Answer {
        self.criteria.iter().map(Criterion::answer).max().unwrap_or(Answer::Unknown)
    }

    /// The criteria that are wrong.
    pub fn faults(&self) -> impl Iterator<Item = &Criterion> {
        self.criteria.iter().filter(|criterion| criterion.answer() == Answer::Wrong)
    }

    /// A promise of the scheme that is broken.
    pub fn broken(&self) -> Option<&Criterion> {
        self.faults().find(|criterion| criterion.is_promise)
    }

    /// Why it is not right, in one line.
    pub fn text(&self) -> String {
        let answer = self.answer();
        let all = self.criteria.iter().filter(|criterion| criterion.answer() == answer && answer != Answer::Right);
        all.map(Criterion::text).collect::<Vec<_>>().join(", ")
    }
}

impl Evidence<'_> {
    /// Three columns of `probes.csv`.
    fn probe(&self, name: &str) -> Option<Vec<[f64; 3]>> {
        let columns = ["x", "y", "z"].map(|axis| format!("{name}.{axis}"));
        let columns: [&str; 3] = std::array::from_fn(|i| columns[i].as_str());
        self.probes.as_ref()?.vectors(columns).ok()
    }

    /// A column of `balance.csv`; zeros if the scene does not have it.
    fn column(&self, name: &str) -> Vec<f64> {
        self.balance.column(name).map_or_else(|_| vec![0.0; self.balance.rows()], <[f64]>::to_vec)
    }

    /// Whether any table of the scene has this key, at any level.
    fn has(&self, key: &str) -> bool {
        let mut rest: Vec<&toml::Value> = self.case.scene.values().collect();
        if self.case.scene.contains_key(key) {
            return true;
        }
        while let Some(value) = rest.pop() {
            match value {
                toml::Value::Table(table) if table.contains_key(key) => return true,
                toml::Value::Table(table) => rest.extend(table.values()),
                toml::Value::Array(values) => rest.extend(values),
                _ => {}
            }
        }
        false
    }
}

/// Whether a figure is worse than the worst so far; what is no number is worse than any other, and stays the worst.
fn is_worse(figure: f64, worst: f64) -> bool {
    !worst.is_nan() && (figure.is_nan() || figure > worst)
}

/// Judges a run.
pub fn judge(case: &Case, run: &Run) -> Outcome<Judgement> {
    let evidence = Evidence {
        case,
        model: Model::read(&case.scene, run)?,
        balance: run.table("balance.csv")?,
        probes: run.table("probes.csv").ok(),
    };
    let mut judgement = Judgement::default();
    let all = &mut judgement.criteria;
    if case.is_static() {
        equilibrium::judge(&evidence, all);
    } else {
        books::judge(&evidence, all);
        motion::judge(&evidence, all);
    }
    let (nodes, edges) = shapes(&evidence, all);
    judgement.depth = nodes;
    if let Some(travel) = case.known.travel {
        // A tool that sinks in by a tenth of its way has not done that part of it.
        let sunk = edges.0 / travel;
        all.push(Criterion::new("depth over the way of the tool", sunk, SUNK).at(edges.1));
    }
    Ok(judgement)
}

/// Elements and depths; the largest depth of a node in edges, and the largest depth of all with its place.
fn shapes(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) -> (f64, (f64, String)) {
    let model = &evidence.model;
    let scene = &evidence.case.scene;
    let list = |key: &str| scene.get(key).and_then(toml::Value::as_array).cloned().unwrap_or_default();
    // Parts that a tie or a joint connects overlap around it.
    let part_of = |value: Option<&toml::Value>| {
        value.and_then(toml::Value::as_str).and_then(|set| set.split('.').next()).unwrap_or_default().to_owned()
    };
    let mut joined: Vec<[String; 2]> = Vec::new();
    for tie in list("tie") {
        joined.push([part_of(tie.get("slave")), part_of(tie.get("master"))]);
    }
    // Boxes on a slider, or in a plane, may move through each other: no contact keeps them apart.
    let slides = |kind: &str| matches!(kind, "slider" | "cylindrical" | "planar");
    for joint in list("joint").iter().filter(|j| !j.get("kind").and_then(toml::Value::as_str).is_some_and(slides)) {
        let sides = joint.get("between").and_then(toml::Value::as_array).cloned().unwrap_or_default();
        joined.push([part_of(sides.first()), part_of(sides.get(1))]);
    }
    let counts = |a: &model::Part, b: &model::Part| {
        let named = |pair: &[String; 2]| pair.contains(&a.name) && pair.contains(&b.name);
        !(a.driven && b.driven || joined.iter().any(named))
    };
    let has_contact = !scene.contains_key("joint");
    // The skins of bodies that touch at the start overlap by up to a thickness, 0.04 of an edge, times the root of two at edges.
    let skin = if evidence.case.method == "general" { 0.057 } else { 0.0 };
    let mut worst = [depth::Deepest::default(), depth::Deepest::default()];
    let mut smallest = (f64::INFINITY, String::new());
    for frame in &model.frames {
        for (worst, found) in worst.iter_mut().zip(depth::deepest(model, frame, counts)) {
            if found.relative > worst.relative {
                *worst = found;
            }
        }
        for part in model.parts.iter().filter(|part| part.kind == model::Kind::Solid) {
            for (cell, nodes) in &part.elements {
                let pick = |x: &[[f64; 3]]| nodes.iter().map(|&n| x[n]).collect::<Vec<_>>();
                let [low, _] = model.cells[*cell].determinants(&pick(&frame.x));
                let [own, _] = model.cells[*cell].determinants(&pick(&model.reference));
                let part_left = low / own;
                if is_worse(-part_left, -smallest.0) {
                    smallest = (part_left, format!("step {}: {}", frame.step, part.name));
                }
            }
        }
    }
    let [node, edge] = worst;
    let bounds = [0.04 + skin, if has_contact { 0.06 + skin } else { f64::INFINITY }];
    all.push(Criterion::new("depth of a node, edges", node.relative, bounds).at(&node.place));
    all.push(Criterion::new("depth of an edge, edges", edge.relative, bounds).at(&edge.place));
    if smallest.0.is_finite() || smallest.0.is_nan() {
        // Inside out at a point where forces or masses are taken, or at a corner.
        let lost = 1.0 - smallest.0;
        all.push(Criterion::new("volume that an element loses at a point", lost, [0.9, 1.0]).at(smallest.1));
    }
    let deepest = if larger(node.depth, edge.depth) == node.depth { node.clone() } else { edge };
    (node.relative, (deepest.depth, deepest.place))
}

#[cfg(test)]
mod tests {
    use super::super::known::Known;
    use super::model::{Frame, Kind, Part};
    use super::*;
    use stoss_reference_element::CellKind;

    fn case(scheme: &str, text: &str) -> Case {
        let scene = text.parse().unwrap();
        let [family, scheme, method] = ["", scheme, "-"].map(str::to_owned);
        Case { seed: 0, family, scheme, method, scene, known: Known::default() }
    }

    /// Three frames of a unit cube about the origin that moves along x by so much in a step.
    fn cube(way: f64, v: Vec<[f64; 3]>) -> Model {
        let table = CellKind::Hex8.table();
        let reference: Vec<[f64; 3]> = table.nodes.iter().map(|n| n.map(|x| 0.5 * x)).collect();
        let frame = |step: usize| Frame {
            step,
            x: reference.iter().map(|x| [x[0] + way * step as f64, x[1], x[2]]).collect(),
            v: v.clone(),
        };
        let part = Part {
            name: "b0".into(),
            kind: Kind::Solid,
            density: Some(1.0),
            driven: false,
            elements: vec![(0, (0..8).collect())],
            facets: table.faces.iter().map(|f| f.nodes.iter().map(|&n| n as usize).collect()).collect(),
            surface: (0..8).collect(),
            is_straight: true,
        };
        let frames = (0..3).map(frame).collect();
        Model { cells: vec![cell::Cell::new(CellKind::Hex8)], parts: vec![part], reference, frames }
    }

    /// A cube of mass 1 that flies with the speed 2 for two steps of 0.5, with these rows of `balance.csv`.
    fn flight(scheme: &str, rows: &str) -> Judgement {
        let header = "step,time,dt,lx,ly,lz,jx,jy,jz,kinetic,strain,total,closing_loss";
        let case = case(scheme, "[[body]]\nname = \"b0\"\ndensity = 1.0\nvelocity = [2.0, 0.0, 0.0]");
        let model = cube(1.0, vec![[2.0, 0.0, 0.0]; 8]);
        let balance = Table::parse(&format!("{header}\n{rows}")).unwrap();
        let evidence = Evidence { case: &case, model, balance, probes: None };
        let mut judgement = Judgement::default();
        books::judge(&evidence, &mut judgement.criteria);
        motion::judge(&evidence, &mut judgement.criteria);
        shapes(&evidence, &mut judgement.criteria);
        judgement
    }

    #[test]
    fn a_flight_is_right_and_each_tampered_table_is_not() {
        let start = "0,0.0,0.0,2,0,0,0,0,0,2,0,2,0\n1,0.5,0.5,2,0,0,0,0,0,2,0,2,0\n";
        let with = |scheme: &str, last: &str| flight(scheme, &format!("{start}2,1.0,0.5,{last}\n"));
        let right = with("energy-momentum", "2,0,0,0,0,0,2,0,2,0");
        assert_eq!(right.answer(), Answer::Right, "{}", right.text());
        // Momentum, spin, kinetic energy that the frames do not have, energy, a loss to contact, and no number.
        for (last, name, is_promise) in [
            ("2.001,0,0,0,0,0,2,0,2,0", "linear momentum", true),
            ("2,0,0,0,0,0.001,2,0,2,0", "angular momentum", true),
            ("2,0,0,0,0,0,1.9,0.1,2,0", "balance.csv against the frames", false),
            ("2,0,0,0,0,0,2,0,2.001,0", "energy with its losses, change", true),
            ("2,0,0,0,0,0,2,0,1.9,0.1", "energy that contact took or gave", false),
            ("2,0,0,0,0,0,2,0,NaN,0", "energy with its losses, change", true),
        ] {
            let found = with("energy-momentum", last);
            assert_eq!(found.answer(), Answer::Wrong, "{last}");
            assert!(found.faults().any(|fault| fault.name == name), "{last}: {}", found.text());
            assert_eq!(found.broken().is_some(), is_promise, "{last}: {}", found.text());
        }
        // Backward Euler may lose energy, and may not gain it.
        assert_eq!(with("backward-euler", "2,0,0,0,0,0,2,0,1.0,0").answer(), Answer::Right);
        assert_eq!(with("backward-euler", "2,0,0,0,0,0,2,0,2.1,0").answer(), Answer::Wrong);
    }

    /// A cube that is held at its bottom, with a force on its top: (0, 0, 0.5) x (1, 0, -2) is (0, 0.5, 0).
    #[test]
    fn reactions_hold_loads_and_their_moments() {
        let answer = |last: &str| {
            let case = case(
                "quasi-static",
                "[[body]]\nname = \"b0\"\nmaterial = { young = 100.0 }\n[[load]]\nset = \"b0.top\"\n\
                 total_force = { table = [[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, -2.0]] }",
            );
            let probes = format!(
                "step,time,r-b0.x,r-b0.y,r-b0.z,m-b0.x,m-b0.y,m-b0.z\n0,0,0,0,0,0,0,0\n1,0.5,-0.5,0,1,0,-0.25,0\n2,1,{last}\n"
            );
            let evidence = Evidence {
                case: &case,
                model: cube(0.0, Vec::new()),
                balance: Table::parse("step,time\n0,0\n1,0.5\n2,1\n").unwrap(),
                probes: Some(Table::parse(&probes).unwrap()),
            };
            let mut judgement = Judgement::default();
            equilibrium::judge(&evidence, &mut judgement.criteria);
            judgement.answer()
        };
        assert_eq!(answer("-1,0,2,0,-0.5,0"), Answer::Right);
        assert_eq!(answer("-1,0,1.99,0,-0.5,0"), Answer::Wrong);
        assert_eq!(answer("-1,0,2,0,-0.51,0"), Answer::Wrong);
        assert_eq!(answer("-1,0,NaN,0,-0.5,0"), Answer::Wrong);
    }

    /// A rigid cube that flies, and one whose upper nodes are faster than its lower ones.
    #[test]
    fn a_rigid_body_has_the_velocity_of_one() {
        let answer = |upper: f64| {
            let case = case("energy-momentum", "[[rigid]]\nname = \"b0\"\ndensity = 1.0");
            let v = (0..8).map(|node| [2.0, 0.0, if node < 4 { 0.0 } else { upper }]).collect();
            let mut model = cube(1.0, v);
            model.parts[0].kind = Kind::Rigid;
            let rows = "step,time,dt,lx,ly,lz,jx,jy,jz,kinetic\n0,0,0,2,0,0,0,0,0,2\n1,0.5,0.5,2,0,0,0,0,0,2\n2,1,0.5,2,0,0,0,0,0,2\n";
            let evidence = Evidence { case: &case, model, balance: Table::parse(rows).unwrap(), probes: None };
            let mut judgement = Judgement::default();
            motion::judge(&evidence, &mut judgement.criteria);
            judgement.answer()
        };
        assert_eq!([0.0, 0.2, 1.0].map(answer), [Answer::Right, Answer::Unknown, Answer::Wrong]);
    }

    #[test]
    fn the_worst_criterion_decides_and_no_number_is_wrong() {
        let of = |figures: &[f64]| Judgement {
            criteria: figures.iter().map(|&f| Criterion::new("a", f, [1.0, 2.0])).collect(),
            depth: 0.0,
        };
        let answers = [vec![], vec![1.0], vec![1.0, 1.5], vec![3.0, 1.5], vec![f64::NAN]].map(|f| of(&f).answer());
        assert_eq!(answers, [Answer::Unknown, Answer::Right, Answer::Unknown, Answer::Wrong, Answer::Wrong]);
        assert_eq!(of(&[1.5, 3.0]).text(), "a 3");
        assert_eq!(of(&[0.5]).text(), "");
        assert!(of(&[3.0]).broken().is_none());
    }
}
