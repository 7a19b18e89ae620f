//! Momenta of a dynamic run and what is known of its motion.

use toml::Value;

use super::depth::Extent;
use super::extremes::worst;
use super::model::{Frame, Kind, Model, Part};
use super::vector::{add, cross, dot, minus, norm, scaled};
use super::{Criterion, Evidence, cell, is_worse};
use crate::verify::numbers::{larger, largest};

/// Drift of momenta that a scheme keeps, over their scale: some hundred tolerances of Newton's method.
const KEPT: [f64; 2] = [1e-8, 1e-8];

/// Impulse of supports and gravity against the change of momentum.
const IMPULSE: [f64; 2] = [1e-8, 1e-6];

/// Force along a flat floor without friction, over the force on it.
const SIDEWAYS: [f64; 2] = [1e-6, 1e-3];

/// Difference of a body from its mirror image, over the largest displacement.
const MIRRORED: [f64; 2] = [1e-6, 1e-2];

/// Rate of a length in a rigid body, over its largest speed.
const RATE: [f64; 2] = [0.05, 0.3];

/// Part of its own length that a body moves in a run, up to which its motion is round-off.
const SLOW: f64 = 1e-9;

/// Schemes whose forces of a step change the momentum by their size times the step.
const OF_THE_STEP: [&str; 3] = ["energy-momentum", "midpoint", "backward-euler"];

/// Adds what is to be said.
pub fn judge(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    if evidence.case.known.rest {
        stillness(evidence, all);
        return;
    }
    momenta(evidence, all);
    before_contact(evidence, all);
    rigidity(evidence, all);
    mirror(evidence, all);
    joints(evidence, all);
}

/// Constant acceleration of gravity.
pub fn gravity(evidence: &Evidence<'_>) -> [f64; 3] {
    let table = evidence.case.scene.get("gravity").and_then(|gravity| gravity.get("acceleration")?.as_array());
    let number = |i: usize| table.and_then(|a| a.get(i)?.as_float()).unwrap_or(0.0);
    std::array::from_fn(number)
}

/// Mass of all that is not driven, and whether it is exact.
fn mass(evidence: &Evidence<'_>) -> (f64, bool) {
    let model = &evidence.model;
    let (mut sum, mut is_exact) = (0.0, true);
    let Some(first) = model.frames.first() else { return (0.0, false) };
    for part in model.parts.iter().filter(|part| !part.driven) {
        match part.density.and_then(|density| model.motion(part, density, first)) {
            Some(motion) => (sum, is_exact) = (sum + motion.mass, is_exact && part.is_straight),
            None => is_exact = false,
        }
    }
    (sum, is_exact)
}

/// Kinetic energy of bodies that are at rest but for round-off.
pub fn at_rest(evidence: &Evidence<'_>) -> f64 {
    let reach = largest(evidence.model.reference.iter().map(|&x| norm(x)));
    let end = evidence.column("time").last().copied().unwrap_or(1.0);
    mass(evidence).0 * (SLOW * reach / end).powi(2)
}

fn momenta(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    let Some(claims) = evidence.case.claims() else { return };
    let vectors = |names| evidence.balance.vectors(names).unwrap_or_default();
    let (linear, angular) = (vectors(["lx", "ly", "lz"]), vectors(["jx", "jy", "jz"]));
    let (dt, time, kinetic) = (evidence.column("dt"), evidence.column("time"), evidence.column("kinetic"));
    let (mass, is_exact) = mass(evidence);
    let g = gravity(evidence);
    let fallen = mass * norm(g) * time.last().copied().unwrap_or(0.0);
    let scale = larger((2.0 * mass * largest(kinetic.iter().copied())).sqrt(), fallen);
    if scale <= (2.0 * mass * at_rest(evidence)).sqrt() || linear.is_empty() {
        return;
    }
    let holders = holders(evidence);
    let is_heavy = norm(g) > 0.0;
    let step = |row: usize| format!("step {row}");
    // Momentum that gravity and supports give, from the start to each row.
    let mut given = vec![[0.0; 3]; linear.len()];
    for k in 1..linear.len() {
        let forces = holders.iter().fold(scaled(mass, g), |sum, holder| add(sum, holder[k]));
        given[k] = add(given[k - 1], scaled(dt[k], forces));
    }
    let is_free = holders.is_empty();
    // Impulses that give energy back are no forces of a step.
    let is_of_step = OF_THE_STEP.contains(&evidence.case.scheme.as_str()) && !evidence.has("closing");
    let counts = if is_free { claims.linear_momentum } else { is_of_step };
    if counts && (is_exact || !is_heavy) {
        let off = (0..linear.len()).map(|k| norm(minus(minus(linear[k], linear[0]), given[k])) / scale);
        let (row, worst) = worst(off);
        let name = if is_free { "linear momentum" } else { "impulse of supports against momentum" };
        let criterion = Criterion::new(name, worst, if is_free { KEPT } else { IMPULSE }).at(step(row));
        all.push(if is_free { criterion.promised() } else { criterion });
    }
    if is_free && !is_heavy && claims.angular_momentum {
        let reach = largest(evidence.model.frames.iter().flat_map(|frame| &frame.x).map(|&x| norm(x)));
        let (row, worst) = worst(angular.iter().map(|&j| norm(minus(j, angular[0])) / (scale * reach)));
        all.push(Criterion::new("angular momentum", worst, KEPT).at(step(row)).promised());
    }
    let known = &evidence.case.known;
    let has_friction = evidence.has("friction");
    let pushed: Vec<f64> = (0..linear.len()).map(|k| linear[k][2] - linear[0][2] - mass * g[2] * time[k]).collect();
    let push = largest(pushed.iter().map(|p| p.abs()));
    if known.flat && !has_friction && push > 1e-6 * scale {
        let side = linear.iter().map(|l| (l[0] - linear[0][0]).hypot(l[1] - linear[0][1]) / push);
        let (row, worst) = worst(side);
        all.push(Criterion::new("push along a flat floor without friction", worst, SIDEWAYS).at(step(row)));
    }
    // A rigid body comes back with its restitution, or without a law of impact with its speed; anything else loses energy, which is to be told.
    if let (Some([speed, back]), true) = (known.rebound, claims.energy)
        && let [.., before, last] = pushed[..]
        && push > 1e-6 * scale
        && (last - before).abs() < 1e-9 * push
    {
        let came_back = linear[linear.len() - 1][2] / mass;
        all.push(Criterion::new("speed of the rebound", (came_back - back).abs() / speed, [0.003, 0.01]));
    }
}

/// Forces from outside that the program reports, in each row: of held parts, and of joints to the ground.
fn holders(evidence: &Evidence<'_>) -> Vec<Vec<[f64; 3]>> {
    let parts = evidence.model.parts.iter().filter_map(|part| evidence.probe(&format!("r-{}", part.name)));
    let joints = evidence.case.scene.get("joint").and_then(Value::as_array).into_iter().flatten();
    let grounded = joints.filter(|joint| {
        joint.get("between").and_then(|sides| sides.get(0)?.as_str()).is_some_and(|side| side == "ground")
    });
    let forces = grounded.filter_map(|joint| evidence.probe(&format!("f-{}", joint.get("name")?.as_str()?)));
    // The force of a joint is that on its first side, here the ground. There is none at the start.
    let on_bodies = forces.map(|rows| rows.into_iter().map(|f| scaled(-1.0, f)).collect());
    parts.chain(on_bodies).collect()
}

/// Momentum of every body for itself, as long as boxes around all of them are apart by more than the layer of general contact.
fn before_contact(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    let model = &evidence.model;
    let scene = &evidence.case.scene;
    if model.parts.len() < 2 || ["tie", "joint", "load", "support"].iter().any(|key| scene.contains_key(*key)) {
        return;
    }
    // The modified constraint keeps gaps open.
    if evidence.has("constraint") {
        return;
    }
    let Some(first) = model.frames.first().filter(|frame| !frame.v.is_empty()) else { return };
    if !evidence.case.claims().is_some_and(|claims| claims.linear_momentum) {
        return;
    }
    let facets = model.parts.iter().flat_map(|part| &part.facets);
    let layer = 0.05 * facets.map(|facet| Model::edge(facet, &first.x)).fold(f64::INFINITY, f64::min);
    let margin = if evidence.case.method == "general" { layer } else { 1e-9 * layer };
    let are_apart = |frame: &Frame| {
        let boxes: Vec<Extent> =
            model.parts.iter().map(|part| Extent::of(part.surface.iter().map(|&n| frame.x[n]))).collect();
        (0..boxes.len()).all(|a| (0..a).all(|b| boxes[a].apart(&boxes[b]) > margin))
    };
    let time = evidence.column("time");
    let g = gravity(evidence);
    let mut found = (0.0, String::new());
    let mut has_any = false;
    let parts: Vec<&Part> =
        model.parts.iter().filter(|part| !part.driven && part.is_straight && !part.elements.is_empty()).collect();
    let own = |part: &Part, frame: &Frame| part.density.and_then(|density| model.motion(part, density, frame));
    for frame in model.frames.iter().take_while(|frame| are_apart(frame)).skip(1) {
        for part in &parts {
            let (Some(start), Some(now)) = (own(part, first), own(part, frame)) else { continue };
            has_any = true;
            let fallen = scaled(now.mass * time.get(frame.step).copied().unwrap_or(f64::NAN), g);
            let size = (2.0 * now.mass * start.kinetic.max(now.kinetic)).sqrt();
            let off = norm(minus(minus(now.linear, start.linear), fallen)) / size;
            if size > 0.0 && is_worse(off, found.0) {
                found = (off, format!("step {}: {}", frame.step, part.name));
            }
        }
    }
    if has_any {
        all.push(Criterion::new("momentum of a body before contact", found.0, IMPULSE).at(found.1));
    }
}

/// Distances within rigid bodies, and their rates: schemes satisfy the constraints for positions, and the rates as far as the step is small.
fn rigidity(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    let model = &evidence.model;
    let (mut length, mut rate) = ((0.0, String::new()), (0.0, String::new()));
    let mut has_any = false;
    let (mass, slow) = (mass(evidence).0, at_rest(evidence));
    for part in model.parts.iter().filter(|part| part.kind != Kind::Solid && !part.driven) {
        let all_speeds = model.frames.iter().flat_map(|frame| part.surface.iter().filter_map(|&n| frame.v.get(n)));
        let speed = largest(all_speeds.map(|&v| norm(v)));
        if 0.5 * mass * speed * speed <= slow {
            continue;
        }
        has_any = true;
        let n = part.surface.len();
        let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (part.surface[i], part.surface[j])));
        for (i, j) in pairs {
            let own = norm(minus(model.reference[i], model.reference[j]));
            for frame in model.frames.iter().filter(|frame| !frame.v.is_empty()) {
                let (x, v) = (minus(frame.x[i], frame.x[j]), minus(frame.v[i], frame.v[j]));
                let place = || format!("step {}: {}", frame.step, part.name);
                let off = (norm(x) / own - 1.0).abs();
                if is_worse(off, length.0) {
                    length = (off, place());
                }
                let off = dot(x, v).abs() / (own * speed);
                if is_worse(off, rate.0) {
                    rate = (off, place());
                }
            }
        }
    }
    if has_any {
        all.push(Criterion::new("change of a length in a rigid body", length.0, [1e-9, 1e-6]).at(length.1));
        all.push(Criterion::new("rate of a length in a rigid body, over the speed", rate.0, RATE).at(rate.1));
    }
}

/// Where nothing acts nothing moves.
pub fn stillness(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    let model = &evidence.model;
    let reach = largest(model.reference.iter().map(|&x| norm(x)));
    let frames = model.frames.iter().skip(1);
    let moved = frames.map(|frame| largest(frame.x.iter().zip(&model.reference).map(|(x, r)| norm(minus(*x, *r)))));
    let (row, worst) = worst(moved.map(|moved| moved / reach));
    all.push(Criterion::new("motion without a cause", worst, [1e-7, 1e-5]).at(format!("step {}", row + 1)));
}

/// Bodies whose scene is its own mirror image stay so, in the planes x = 0 and y = 0.
pub fn mirror(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    if !evidence.case.known.mirrored {
        return;
    }
    let model = &evidence.model;
    let Some(part) = model.parts.iter().find(|part| !part.driven) else { return };
    let nodes: Vec<usize> = match part.kind {
        Kind::Solid => part.elements.iter().flat_map(|(_, nodes)| nodes).copied().collect(),
        _ => part.surface.clone(),
    };
    let reach = largest(nodes.iter().map(|&n| norm(model.reference[n])));
    let way = |frame: &Frame| largest(nodes.iter().map(|&n| norm(minus(frame.x[n], model.reference[n]))));
    let moved: Vec<f64> = model.frames.iter().map(way).collect();
    let mut found = (0.0, String::new());
    for axis in 0..2 {
        let image = |mut x: [f64; 3]| {
            x[axis] = -x[axis];
            x
        };
        let partner = |n: usize| {
            let wanted = image(model.reference[n]);
            nodes.iter().copied().find(|&m| norm(minus(model.reference[m], wanted)) < 1e-9 * reach)
        };
        for &n in &nodes {
            let Some(m) = partner(n) else { return };
            let mut scale = 0.0;
            for (frame, moved) in model.frames.iter().zip(&moved) {
                scale = larger(scale, *moved);
                let off = norm(minus(frame.x[m], image(frame.x[n])));
                if off > 1e-12 * reach && is_worse(off / scale, found.0) {
                    found = (off / scale, format!("step {}", frame.step));
                }
            }
        }
    }
    all.push(Criterion::new("difference from the mirror image", found.0, MIRRORED).at(found.1));
}

/// A rigid box in a frame: gradient of its motion and place of the reference origin.
fn pose(part: &Part, model: &Model, frame: &Frame) -> Option<([[f64; 3]; 3], [f64; 3])> {
    let (_, nodes) = part.elements.first()?;
    let edges = |x: &[[f64; 3]]| [1, 3, 4].map(|k| minus(x[nodes[k]], x[nodes[0]]));
    let (from, to) = (edges(&model.reference), edges(&frame.x));
    // Row i of the gradient solves `from . row = to_i`.
    let mut gradient = [[0.0; 3]; 3];
    for i in 0..3 {
        gradient[i] = cell::solve(from, [to[0][i], to[1][i], to[2][i]])?;
    }
    let start = model.reference[nodes[0]];
    Some((gradient, minus(frame.x[nodes[0]], turned(gradient, start))))
}

fn turned(gradient: [[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    gradient.map(|row| dot(row, x))
}

/// What joints keep together, between rigid boxes and the ground.
fn joints(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    let model = &evidence.model;
    let scene = &evidence.case.scene;
    let list: Vec<&toml::Table> =
        scene.get("joint").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_table).collect();
    if list.is_empty() {
        return;
    }
    let numbers = |value: Option<&Value>| -> Option<[f64; 3]> {
        let array = value?.as_array()?;
        Some(std::array::from_fn(|i| array.get(i).and_then(Value::as_float).unwrap_or(f64::NAN)))
    };
    let size = largest(model.reference.iter().map(|&x| norm(x)));
    let time = evidence.column("time");
    let (mut apart, mut off) = ((0.0, String::new()), (0.0, String::new()));
    for joint in list {
        let text = |key: &str| joint.get(key).and_then(Value::as_str).unwrap_or_default();
        let side = |k: usize| joint.get("between").and_then(|sides| sides.get(k)?.as_str()).unwrap_or_default();
        let (kind, Some(at)) = (text("kind"), numbers(joint.get("at"))) else { continue };
        let axis = numbers(joint.get("axis"));
        for frame in &model.frames {
            let of = |name: &str| match name {
                "ground" => Some(([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3])),
                name => pose(model.part(name)?, model, frame),
            };
            let (Some((first, a)), Some((second, b))) = (of(side(0)), of(side(1))) else { continue };
            let between = minus(add(turned(second, at), b), add(turned(first, at), a));
            let n = axis.map(|axis| turned(first, scaled(1.0 / norm(axis), axis)));
            let along = n.map_or(0.0, |n| dot(n, between));
            let gap = match kind {
                "slider" | "cylindrical" => norm(minus(between, scaled(along, n.unwrap_or_default()))),
                "planar" => along.abs(),
                _ => norm(between),
            };
            let tilt = match (kind, axis) {
                ("weld" | "slider", _) => largest((0..3).map(|i| norm(minus(first[i], second[i])))),
                ("hinge" | "cylindrical" | "planar", Some(axis)) => {
                    norm(cross(turned(first, axis), turned(second, axis))) / dot(axis, axis)
                }
                _ => 0.0,
            };
            let worse = larger(gap / size, tilt);
            if is_worse(worse, apart.0) {
                apart = (worse, format!("step {}: {} {}", frame.step, kind, text("name")));
            }
            let (Some(n), Some(axis)) = (n, axis) else { continue };
            let coordinate = match kind {
                "slider" => along,
                _ => angle(first, second, n, axis),
            };
            let limits = joint.get("limits").and_then(Value::as_array);
            let limit = |k: usize| limits.and_then(|l| l.get(k)?.as_float());
            let rows = joint.get("motor").and_then(|motor| motor.as_table()?.values().next()?.get("table")?.as_array());
            let most = rows.and_then(|rows| rows.last()?.get(1)?.as_float());
            let beyond = match (limit(0), limit(1), most) {
                (Some(low), Some(high), _) => (low - coordinate).max(coordinate - high).max(0.0) / (high - low),
                (_, _, Some(most)) => {
                    (coordinate - most * time.get(frame.step).copied().unwrap_or(f64::NAN).min(1.0)).abs() / most.abs()
                }
                _ => continue,
            };
            if is_worse(beyond, off.0) {
                off = (beyond, format!("step {}: {} {}", frame.step, kind, text("name")));
            }
        }
    }
    all.push(Criterion::new("gap or tilt of a joint", apart.0, [1e-7, 1e-5]).at(apart.1));
    all.push(Criterion::new("coordinate of a joint off its motor or limit", off.0, [1e-4, 1e-2]).at(off.1));
}

/// Angle in degrees by which the second side has turned relative to the first one about an axis, `n` in space.
fn angle(first: [[f64; 3]; 3], second: [[f64; 3]; 3], n: [f64; 3], axis: [f64; 3]) -> f64 {
    let smallest = (0..3).min_by(|&i, &j| axis[i].abs().total_cmp(&axis[j].abs())).unwrap_or(0);
    let side = cross(axis, std::array::from_fn(|i| f64::from(u8::from(i == smallest))));
    let (a, b) = (turned(first, side), turned(second, side));
    dot(n, cross(a, b)).atan2(dot(a, b)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_is_positive_by_the_right_hand_rule() {
        let turn = |degrees: f64| {
            let (s, c) = degrees.to_radians().sin_cos();
            [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
        };
        let z = [0.0, 0.0, 1.0];
        for degrees in [-100.0, -1.0, 0.0, 30.0, 170.0] {
            assert!((angle(turn(20.0), turn(20.0 + degrees), z, z) - degrees).abs() < 1e-10);
        }
    }
}
