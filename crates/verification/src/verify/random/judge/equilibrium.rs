//! Statics: forces and moments of supports, loads and contact are in equilibrium, for every part and for all together.

use toml::Value;

use super::extremes::worst;
use super::model::{Frame, Model, Part};
use super::motion::{gravity, mirror, stillness};
use super::vector::{add, cross, minus, norm, scaled};
use super::{Criterion, Evidence};
use crate::verify::numbers::{larger, largest};

/// What a converged step leaves, over the largest force of the run.
const CONVERGED: [f64; 2] = [1e-6, 1e-4];

/// What `stabilise` may carry before the end, over the largest force of the run.
const CARRIED: [f64; 2] = [0.01, 0.5];

/// Force along a flat tool without friction, over that on it.
const SIDEWAYS: [f64; 2] = [1e-6, 1e-3];

/// Strain that is round-off.
const ROUND_OFF: f64 = 1e-12;

/// A force and its moment about the origin.
#[derive(Clone, Copy, Debug, Default)]
struct Action {
    force: [f64; 3],
    moment: [f64; 3],
}

impl Action {
    fn at(force: [f64; 3], x: [f64; 3]) -> Self {
        Self { force, moment: cross(x, force) }
    }

    fn plus(self, other: Self) -> Self {
        Self { force: add(self.force, other.force), moment: add(self.moment, other.moment) }
    }
}

/// Adds what is to be said.
pub fn judge(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    let known = &evidence.case.known;
    if known.rest {
        stillness(evidence, all);
        return;
    }
    mirror(evidence, all);
    balance(evidence, all);
    let tool = |probe: &str| evidence.probe(&format!("{probe}-tool"));
    if let (true, Some(forces)) = (known.flat && !evidence.has("friction"), tool("c")) {
        let scale = largest(forces.iter().map(|&f| norm(f)));
        if scale > 0.0 {
            let (row, worst) = worst(forces.iter().map(|f| f[0].hypot(f[1]) / scale));
            all.push(
                Criterion::new("push along a flat tool without friction", worst, SIDEWAYS).at(format!("step {row}")),
            );
        }
    }
    if let (Some(value), Some([.., last])) = (known.force, tool("r").as_deref()) {
        // The layer of general contact is a part of an edge.
        let bounds = if evidence.case.method == "general" { [0.03, 0.15] } else { [1e-4, 0.02] };
        let off = (last[2].abs() / value - 1.0).abs();
        let done = evidence.column("time").last().is_some_and(|&time| time > 1.0 - 1e-9);
        if done {
            all.push(Criterion::new("force of a uniform compression", off, bounds));
        }
    }
}

fn balance(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    let model = &evidence.model;
    let time = evidence.column("time");
    let has_stabilisation = evidence.has("stabilise");
    let (mut scale, mut reach) = (0.0, 0.0);
    // What is left over in each frame, of all parts together and of the worst part.
    let mut rows: Vec<(f64, Action, f64)> = Vec::new();
    for frame in model.frames.iter().filter(|frame| frame.step > 0) {
        let Some(&t) = time.get(frame.step) else { continue };
        reach = larger(reach, largest(frame.x.iter().map(|&x| norm(x))));
        let (mut sum, mut of_part) = (Action::default(), 0.0);
        for part in &model.parts {
            let row = |probe: &str| {
                let rows = evidence.probe(&format!("{probe}-{}", part.name));
                rows.and_then(|rows| rows.get(frame.step).copied()).unwrap_or_default()
            };
            let held = Action { force: row("r"), moment: row("m") };
            let mut outer = held;
            let mut size = norm(held.force);
            for action in loads(evidence, part, frame, t) {
                outer = outer.plus(action);
                size = larger(size, norm(action.force));
            }
            let contact = row("c");
            size = larger(size, norm(contact));
            scale = larger(scale, size);
            sum = sum.plus(outer);
            if !evidence.case.scene.contains_key("tie") {
                of_part = larger(of_part, norm(add(outer.force, contact)));
            }
        }
        rows.push((t, sum, of_part));
    }
    let Some(&(end, sum, of_part)) = rows.last() else { return };
    // Forces of strains of this size are round-off.
    let bodies = evidence.case.scene.get("body").and_then(Value::as_array).into_iter().flatten();
    let young = largest(bodies.filter_map(|body| body.get("material")?.get("young")?.as_float()));
    if scale <= ROUND_OFF * young * reach * reach {
        return;
    }
    let left = |sum: Action| larger(norm(sum.force), norm(sum.moment) / reach) / scale;
    let is_done = end > 1.0 - 1e-9;
    if is_done || !has_stabilisation {
        all.push(Criterion::new("reactions and loads", left(sum), CONVERGED).at("end"));
        all.push(Criterion::new("forces on a part", of_part / scale, CONVERGED).at("end"));
    }
    let bounds = if has_stabilisation { CARRIED } else { CONVERGED };
    let name = if has_stabilisation { "force that `stabilise` carries" } else { "reactions and loads" };
    let (row, worst) = worst(rows.iter().map(|(_, sum, _)| left(*sum)));
    all.push(Criterion::new(name, worst, bounds).at(format!("step {}", row + 1)));
}

/// Loads, supports and gravity on a part, from the scene.
fn loads(evidence: &Evidence<'_>, part: &Part, frame: &Frame, time: f64) -> Vec<Action> {
    let model = &evidence.model;
    let scene = &evidence.case.scene;
    let list = |key: &str| scene.get(key).and_then(Value::as_array).into_iter().flatten();
    let mut actions = Vec::new();
    let g = gravity(evidence);
    if norm(g) > 0.0
        && let Some(density) = part.density
        && let Some(motion) = model.motion(part, density, frame)
    {
        actions.push(Action { force: scaled(motion.mass, g), moment: cross(motion.moment, g) });
    }
    for load in list("load") {
        let values = |key: &str| ramp(load.get(key)?, time);
        if load.get("body").and_then(Value::as_str) == Some(&part.name)
            && let Some(force) = values("body_force")
            && let Some(volume) = model.motion(part, 1.0, frame)
        {
            let force = vector(&force);
            actions.push(Action { force: scaled(volume.mass, force), moment: cross(volume.moment, force) });
        }
        let Some(top) = side(part, load.get("set")) else { continue };
        let mut area = 0.0;
        on_side(model, part, top, |_, _, part_of_area| area += part_of_area);
        let traction = match (values("pressure"), values("traction"), values("total_force")) {
            (Some(pressure), _, _) => [0.0, 0.0, if top { -pressure[0] } else { pressure[0] }],
            (_, Some(traction), _) => vector(&traction),
            (_, _, Some(force)) => scaled(1.0 / area, vector(&force)),
            _ => continue,
        };
        let mut sum = Action::default();
        on_side(model, part, top, |nodes, shape, area| {
            sum = sum.plus(Action::at(scaled(area, traction), mean(nodes, shape, &frame.x)));
        });
        actions.push(sum);
    }
    for support in list("support") {
        let Some(top) = side(part, support.get("set")) else { continue };
        let Some(stiffness) = support.get("stiffness").and_then(Value::as_array) else { continue };
        let k: [f64; 3] = std::array::from_fn(|i| stiffness.get(i).and_then(Value::as_float).unwrap_or(0.0));
        let mut sum = Action::default();
        on_side(model, part, top, |nodes, shape, area| {
            let x = mean(nodes, shape, &frame.x);
            let u = minus(x, mean(nodes, shape, &model.reference));
            sum = sum.plus(Action::at(std::array::from_fn(|i| -area * k[i] * u[i]), x));
        });
        actions.push(sum);
    }
    actions
}

/// The values of a table over time with rows at 0 and 1.
fn ramp(value: &Value, time: f64) -> Option<Vec<f64>> {
    let rows = value.get("table")?.as_array()?;
    let last = rows.last()?.as_array()?;
    last.iter().skip(1).map(|x| Some(time * x.as_float()?)).collect()
}

fn vector(values: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or(f64::NAN))
}

fn mean(nodes: &[usize], shape: &[f64], x: &[[f64; 3]]) -> [f64; 3] {
    nodes.iter().zip(shape).fold([0.0; 3], |sum, (&n, &weight)| add(sum, scaled(weight, x[n])))
}

/// Whether a set is the `top` or the `bottom` of a part.
fn side(part: &Part, set: Option<&Value>) -> Option<bool> {
    let (name, set) = set?.as_str()?.split_once('.')?;
    match set {
        "top" if name == part.name => Some(true),
        "bottom" if name == part.name => Some(false),
        _ => None,
    }
}

/// Calls `f` with nodes, shape functions and area of each point of the faces that are uppermost or lowest in the reference configuration.
fn on_side(model: &Model, part: &Part, top: bool, mut f: impl FnMut(&[usize], &[f64], f64)) {
    let heights = || part.surface.iter().map(|&n| model.reference[n][2]);
    let level = if top { heights().fold(f64::NEG_INFINITY, f64::max) } else { heights().fold(f64::INFINITY, f64::min) };
    let reach = largest(heights().map(f64::abs));
    for (cell, nodes) in &part.elements {
        let cell = &model.cells[*cell];
        let places: Vec<[f64; 3]> = nodes.iter().map(|&n| model.reference[n]).collect();
        for (k, face) in cell.kind.table().faces.iter().enumerate() {
            if face.nodes.iter().all(|&n| (places[n as usize][2] - level).abs() <= 1e-9 * reach) {
                cell.integrate_face(k, &places, |shape, area| f(nodes, shape, area));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_ramps_and_sets_are_sides() {
        let table: toml::Table = "a = { table = [[0.0, 0.0, 0.0], [1.0, 2.0, -4.0]] }".parse().unwrap();
        assert_eq!(ramp(&table["a"], 0.25), Some(vec![0.5, -1.0]));
        assert_eq!(vector(&[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        let sum = Action::at([0.0, 0.0, 2.0], [3.0, 0.0, 0.0]).plus(Action::at([0.0, 0.0, -2.0], [1.0, 0.0, 0.0]));
        assert_eq!((sum.force, sum.moment), ([0.0; 3], [0.0, -4.0, 0.0]));
    }
}
