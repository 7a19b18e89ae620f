//! Scenes from a generator: a seed gives a scene, always the same.
//!
//! Of the families `impact` and `press`: two to four bodies above each other, turned and shifted at random, fly into each other, or a block is pressed into
//! another. The others are in [`families`]. At most [`NODES`] nodes and [`STEPS`] steps.

use fastrand::Rng;
use stoss_integrators::Claims;
use toml::{Table, Value};

use super::families::{self, Draft, Family};
use super::known::{Known, STEPS, uniform};
use crate::workspace::Outcome;

/// Largest number of nodes of a scene.
const NODES: usize = 300;

/// Families with how many of a hundred scenes belong to each, and whether elements are quadratic.
const FAMILIES: [(&str, usize, Family, bool); 14] = [
    ("", 20, named, false),
    ("flight", 6, families::flight, false),
    ("flat", 14, families::flat, false),
    ("edge", 8, families::edge, false),
    ("tool", 10, families::tool, false),
    ("loads", 10, families::loads, false),
    ("joints", 10, families::joints, false),
    ("general", 5, families::general, false),
    ("rest", 5, families::rest, false),
    ("tie", 4, families::tie, false),
    ("quadratic", 3, families::tool, true),
    ("quadratic", 2, families::loads, true),
    ("quadratic", 2, families::flat, true),
    ("quadratic", 1, families::rest, true),
];

/// Mixed into the seed that chooses the family, so that a scene of `impact` or `press` is the one that its seed always gave.
const FAMILY: u64 = 0x5eed;

/// Time-stepping schemes; `None` is quasi-static.
const SCHEMES: [Option<&str>; 4] = [Some("energy-momentum"), Some("midpoint"), Some("backward-euler"), None];

/// A scene and what it is counted under.
#[derive(Clone, Debug)]
pub struct Case {
    /// The seed that gives it.
    pub seed: u64,
    /// The kind of scene.
    pub family: String,
    /// Scheme, or "quasi-static".
    pub scheme: String,
    /// Contact method of all named pairs, "general" if none is named, "tie", or "-" without contact.
    pub method: String,
    /// The scene.
    pub scene: Table,
    /// What must come out.
    pub known: Known,
}

/// What a body is made of before it is placed.
struct Shape {
    mesh: Table,
    nodes: usize,
    /// Half of its height when it is not turned, and the radius of a ball around it.
    half_height: f64,
    radius: f64,
    /// Mean edge length of its surface.
    edge: f64,
    /// Sets for a contact above and below.
    above: &'static str,
    below: &'static str,
}

impl Case {
    /// The scene of a seed.
    pub fn new(seed: u64) -> Outcome<Self> {
        let all: usize = FAMILIES.iter().map(|(_, share, ..)| share).sum();
        let mut place = Rng::with_seed(seed ^ FAMILY).usize(..all);
        let mut chosen = FAMILIES[0];
        for family in FAMILIES {
            chosen = family;
            if place < family.1 {
                break;
            }
            place -= family.1;
        }
        let (family, _, make, is_quadratic) = chosen;
        // Seeds in a row give unlike scenes: the generator mixes them.
        let Draft { text, scheme, method, known } = make(&mut Rng::with_seed(seed), is_quadratic);
        let family = match family {
            "" if scheme == "quasi-static" => "press",
            "" => "impact",
            family => family,
        };
        let mut scene: Table = text.parse().map_err(|error| format!("seed {seed}: {error}\n{text}"))?;
        observe(&mut scene);
        Ok(Self { seed, family: family.into(), scheme, method, scene, known })
    }

    /// Whether it is a sequence of equilibria.
    pub fn is_static(&self) -> bool {
        self.scheme == "quasi-static"
    }

    /// What its scheme conserves; nothing of statics.
    pub fn claims(&self) -> Option<Claims> {
        Some(stoss_integrators::scheme(&self.scheme).ok()?.claims())
    }
}

/// Adds frames of every step and the probes that the judge reads: of each part the force of what holds or drives it (`r-NAME`) with its moment (`m-NAME`), and the
/// force of contact in statics (`c-NAME`); of each joint its force (`f-NAME`). What was there before is replaced.
pub fn observe(scene: &mut Table) {
    let list = |key: &str| scene.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    let text = |table: &Value, key: &str| table.get(key).and_then(Value::as_str).unwrap_or_default().to_owned();
    let is_static = scene["scene"].get("kind").and_then(Value::as_str) == Some("quasi-static");
    let mut probes = Vec::new();
    let mut probe = |letter: &str, name: &str, quantity: &str, key: &str, of: String| {
        let mut table = Table::new();
        table.insert("name".into(), format!("{letter}-{name}").into());
        table.insert("quantity".into(), quantity.into());
        table.insert(key.into(), of.into());
        probes.push(table);
    };
    let held = list("prescribe");
    let is_held = |name: &str| {
        let set = format!("{name}.");
        held.iter().any(|p| text(p, "rigid") == name || text(p, "set").starts_with(&set))
    };
    let has_contact = scene.contains_key("contact") || scene.contains_key("general_contact");
    for (key, is_rigid) in [("body", false), ("rigid", true)] {
        for part in list(key) {
            let name = text(&part, "name");
            let (key, of) = if is_rigid { ("body", name.clone()) } else { ("set", format!("{name}.all")) };
            if is_held(&name) || part.get("fixed").is_some() {
                probe("r", &name, "reaction", key, of.clone());
                probe("m", &name, "reaction_moment", key, of.clone());
            }
            if is_static && has_contact {
                probe("c", &name, "contact_force", key, of);
            }
        }
    }
    for joint in list("joint") {
        let name = text(&joint, "name");
        probe("f", &name, "joint_force", "joint", name.clone());
    }
    match probes.is_empty() {
        true => scene.remove("probe"),
        false => scene.insert("probe".into(), tables(probes)),
    };
    let mut output = Table::new();
    output.insert("fields".into(), words(if is_static { &["displacement"] } else { &["displacement", "velocity"] }));
    output.insert("checkpoint_every".into(), 1000.into());
    scene.insert("output".into(), output.into());
}

/// Bodies that fly into each other, or a block that is pressed into another, with named contact.
fn named(rng: &mut Rng, _: bool) -> Draft {
    let scheme = SCHEMES[rng.usize(..SCHEMES.len())];
    let method = ["nts", "mortar", "cat"][[0, 0, 1, 1, 2][rng.usize(..5)]];
    let (scene, travel) = match scheme {
        Some(scheme) => (impact(rng, scheme, method), None),
        None => press(rng, method),
    };
    Draft {
        text: scene.to_string(),
        scheme: scheme.unwrap_or("quasi-static").to_owned(),
        method: method.to_owned(),
        known: Known { travel, ..Known::default() },
    }
}

fn impact(rng: &mut Rng, scheme: &str, method: &str) -> Table {
    let count = [2, 2, 2, 3, 4][rng.usize(..5)];
    let young = 10.0_f64.powf(uniform(rng, 2.0, 5.0));
    let mut bodies = Vec::new();
    let mut shapes: Vec<Shape> = Vec::new();
    let (mut height, mut room, mut wave) = (0.0, NODES, f64::INFINITY);
    let touching = rng.usize(..4) == 0;
    let mut faces = Vec::new();
    for k in 0..count {
        let shape = shape(rng, room / (count - k), touching);
        room -= shape.nodes;
        // Six decades between the softest and the stiffest.
        let stiffness = young * 10.0_f64.powf(uniform(rng, -3.0, 3.0));
        let density = 10.0_f64.powf(uniform(rng, 0.0, 1.0));
        wave = wave.min((stiffness / density).sqrt());
        // A body that starts in touch lies flat.
        let turned = !touching && rng.bool();
        let half = if turned { shape.radius } else { shape.half_height };
        let gap = if touching { 0.0 } else { uniform(rng, 0.0, 0.1) };
        height += if k == 0 { 0.0 } else { half + gap };
        let mut shift = || if k == 0 { 0.0 } else { 0.6 * uniform(rng, -1.0, 1.0) * shape.radius };
        let position = [shift(), shift(), height];
        height += half;
        let mut body = Table::new();
        body.insert("name".into(), format!("b{k}").into());
        body.insert("mesh".into(), shape.mesh.clone().into());
        if turned {
            let axis = [0; 3].map(|_| uniform(rng, -1.0, 1.0) + 1e-3);
            let mut rotation = Table::new();
            rotation.insert("axis".into(), numbers(&axis));
            rotation.insert("degrees".into(), uniform(rng, 0.0, 90.0).into());
            body.insert("rotation".into(), rotation.into());
        }
        body.insert("position".into(), numbers(&position));
        body.insert("material".into(), material(rng, stiffness).into());
        body.insert("density".into(), density.into());
        faces.push(if turned { ["boundary", "boundary"] } else { [shape.below, shape.above] });
        bodies.push(body);
        shapes.push(shape);
    }
    // Up to a sixth of the slowest wave speed: two bodies that meet twice as fast crush the coarse elements of the softer one. The fastest body moves a
    // twentieth to a half of an edge in a step.
    let speed = wave * 10.0_f64.powf(uniform(rng, -2.0, -0.8));
    let edge = shapes.iter().map(|shape| shape.edge).fold(f64::INFINITY, f64::min);
    let step = edge / speed * 10.0_f64.powf(uniform(rng, -1.3, -0.3));
    let centre = 0.5 * (count as f64 - 1.0);
    for (k, body) in bodies.iter_mut().enumerate() {
        let towards = (centre - k as f64).signum() * if k as f64 == centre { 0.0 } else { speed };
        let mut velocity = [0.3 * speed * uniform(rng, -1.0, 1.0), 0.3 * speed * uniform(rng, -1.0, 1.0), towards];
        velocity[2] *= uniform(rng, 0.5, 1.0);
        body.insert("velocity".into(), numbers(&velocity));
    }
    let steps = rng.u32(STEPS / 2..=STEPS);
    let mut scene = header("dynamic", step, steps);
    if let Some(Value::Table(time)) = scene.get_mut("time") {
        let mut integrator = Table::new();
        integrator.insert("scheme".into(), scheme.into());
        time.insert("integrator".into(), integrator.into());
    }
    let pairs: Vec<[String; 2]> =
        (1..count).map(|k| [format!("b{k}.{}", faces[k][0]), format!("b{}.{}", k - 1, faces[k - 1][1])]).collect();
    scene.insert("contact".into(), contacts(rng, method, &pairs));
    scene.insert("body".into(), tables(bodies));
    scene
}

/// A block is pressed down into another one that stands on the ground; and its way beyond the gap.
fn press(rng: &mut Rng, method: &str) -> (Table, Option<f64>) {
    let young = 10.0_f64.powf(uniform(rng, 2.0, 8.0));
    let gap = if rng.bool() { 0.0 } else { uniform(rng, 0.0, 0.05) };
    let mut bodies = Vec::new();
    let mut heights = [0.0; 2];
    for k in 0..2 {
        let divisions = [0; 3].map(|_| rng.usize(1..=3) + 1 - k);
        let size = [0; 3].map(|_| uniform(rng, 0.5, 1.5) * if k == 0 { 1.5 } else { 1.0 });
        heights[k] = size[2];
        let shift = if k == 0 { [0.0; 2] } else { [0; 2].map(|_| 0.4 * uniform(rng, -1.0, 1.0)) };
        let bottom = if k == 0 { 0.0 } else { heights[0] + gap };
        let mut mesh = Table::new();
        mesh.insert("generator".into(), "block".into());
        mesh.insert("min".into(), numbers(&[shift[0] - 0.5 * size[0], shift[1] - 0.5 * size[1], bottom]));
        mesh.insert("max".into(), numbers(&[shift[0] + 0.5 * size[0], shift[1] + 0.5 * size[1], bottom + size[2]]));
        mesh.insert("divisions".into(), counts(&divisions));
        let stiffness = young * 10.0_f64.powf(uniform(rng, -3.0, 3.0));
        let mut body = Table::new();
        body.insert("name".into(), format!("b{k}").into());
        body.insert("mesh".into(), mesh.into());
        body.insert("material".into(), material(rng, stiffness).into());
        bodies.push(body);
    }
    let steps = rng.u32(5..=STEPS / 3);
    let step = 1.0 / f64::from(steps);
    let depth = gap + heights[1].min(heights[0]) * uniform(rng, 0.02, 0.25);
    let slide = if rng.bool() { 0.3 * uniform(rng, -1.0, 1.0) } else { 0.0 };
    let mut scene = header("quasi-static", step, steps);
    let mut fixed = Table::new();
    fixed.insert("set".into(), "b0.bottom".into());
    fixed.insert("components".into(), words(&["x", "y", "z"]));
    fixed.insert("fixed".into(), true.into());
    let mut moved = Table::new();
    moved.insert("set".into(), "b1.top".into());
    moved.insert("components".into(), words(&["x", "y", "z"]));
    let rows = [numbers(&[0.0; 4]), numbers(&[1.0, slide, 0.0, -depth])];
    let mut table = Table::new();
    table.insert("table".into(), Value::Array(rows.to_vec()));
    moved.insert("displacement".into(), table.into());
    scene.insert("prescribe".into(), tables(vec![fixed, moved]));
    let pair = if rng.bool() { ["b1.bottom", "b0.top"] } else { ["b0.top", "b1.bottom"] };
    scene.insert("contact".into(), contacts(rng, method, &[pair.map(str::to_owned)]));
    scene.insert("body".into(), tables(bodies));
    (scene, Some(depth - gap))
}

/// A shape of at most so many nodes; a block if it has to lie flat or if there is little room.
fn shape(rng: &mut Rng, nodes: usize, flat: bool) -> Shape {
    let mut mesh = Table::new();
    let kind = if flat || nodes < 75 { 0 } else { rng.usize(..4) };
    match kind {
        1 => {
            mesh.insert("generator".into(), "ball".into());
            mesh.insert("radius".into(), 0.5.into());
            mesh.insert("divisions".into(), counts(&[1, 1, 1]));
            Shape { mesh, nodes: 53, half_height: 0.5, radius: 0.5, edge: 0.4, above: "outer", below: "outer" }
        }
        2 => {
            mesh.insert("generator".into(), "cylinder".into());
            mesh.insert("radius".into(), 0.5.into());
            mesh.insert("length".into(), 1.0.into());
            mesh.insert("divisions".into(), counts(&[1, 1, 1, 2]));
            Shape { mesh, nodes: 51, half_height: 0.5, radius: 1.2, edge: 0.4, above: "outer", below: "outer" }
        }
        3 => {
            mesh.insert("generator".into(), "hollow-torus".into());
            mesh.insert("ring_radius".into(), 0.6.into());
            mesh.insert("tube_outer_radius".into(), 0.25.into());
            mesh.insert("tube_inner_radius".into(), 0.1.into());
            mesh.insert("divisions".into(), counts(&[8, 4, 1]));
            Shape { mesh, nodes: 64, half_height: 0.25, radius: 0.85, edge: 0.4, above: "outer", below: "outer" }
        }
        _ => {
            let most = ((nodes as f64).cbrt() as usize).saturating_sub(1).clamp(1, 3);
            let divisions = [0; 3].map(|_| rng.usize(1..=most));
            let size = [0; 3].map(|_| uniform(rng, 0.4, 1.4));
            mesh.insert("generator".into(), "block".into());
            mesh.insert("size".into(), numbers(&size));
            mesh.insert("divisions".into(), counts(&divisions));
            let radius = 0.5 * size.iter().map(|s| s * s).sum::<f64>().sqrt();
            let edge = (0..3).map(|i| size[i] / divisions[i] as f64).fold(f64::INFINITY, f64::min);
            let nodes = divisions.iter().map(|n| n + 1).product();
            Shape { mesh, nodes, half_height: 0.5 * size[2], radius, edge, above: "top", below: "bottom" }
        }
    }
}

fn header(kind: &str, step: f64, steps: u32) -> Table {
    let mut scene = Table::new();
    let mut head = Table::new();
    head.insert("title".into(), "Random".into());
    head.insert("kind".into(), kind.into());
    scene.insert("scene".into(), head.into());
    let mut time = Table::new();
    time.insert("end".into(), (step * f64::from(steps)).into());
    time.insert("step".into(), step.into());
    scene.insert("time".into(), time.into());
    scene
}

fn material(rng: &mut Rng, young: f64) -> Table {
    let mut material = Table::new();
    let law = ["neo-hooke", "neo-hooke", "saint-venant-kirchhoff"][rng.usize(..3)];
    material.insert("law".into(), law.into());
    material.insert("young".into(), young.into());
    material.insert("poisson".into(), uniform(rng, 0.0, 0.45).into());
    material
}

fn contacts(rng: &mut Rng, method: &str, pairs: &[[String; 2]]) -> Value {
    let mu = if rng.usize(..5) < 3 { None } else { Some(uniform(rng, 0.05, 0.8)) };
    let contact = |[slave, master]: &[String; 2]| {
        let mut contact = Table::new();
        contact.insert("method".into(), method.into());
        contact.insert("slave".into(), slave.clone().into());
        contact.insert("master".into(), master.clone().into());
        if let Some(mu) = mu {
            let mut friction = Table::new();
            friction.insert("law".into(), "coulomb".into());
            friction.insert("mu".into(), mu.into());
            contact.insert("friction".into(), friction.into());
        }
        contact
    };
    tables(pairs.iter().map(contact).collect())
}

fn numbers(values: &[f64]) -> Value {
    Value::Array(values.iter().map(|&x| x.into()).collect())
}

fn counts(values: &[usize]) -> Value {
    Value::Array(values.iter().map(|&n| (n as i64).into()).collect())
}

fn words(values: &[&str]) -> Value {
    Value::Array(values.iter().map(|&word| word.into()).collect())
}

fn tables(tables: Vec<Table>) -> Value {
    Value::Array(tables.into_iter().map(Value::Table).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_the_same_scene_and_another_one_another() {
        for seed in 0..50 {
            assert_eq!(Case::new(seed).unwrap().scene, Case::new(seed).unwrap().scene);
            assert_ne!(Case::new(seed).unwrap().scene, Case::new(seed + 50).unwrap().scene);
        }
    }

    #[test]
    fn all_families_occur_and_all_scenes_are_read() {
        let mut found = std::collections::BTreeSet::new();
        for seed in 0..300 {
            let case = Case::new(seed).unwrap();
            let text = toml::to_string(&case.scene).unwrap();
            stoss_scene::parse(&text, "random").unwrap_or_else(|error| panic!("seed {seed}: {error}\n{text}"));
            found.insert(case.family);
        }
        let wanted = [
            "edge",
            "flat",
            "flight",
            "general",
            "impact",
            "joints",
            "loads",
            "press",
            "quadratic",
            "rest",
            "tie",
            "tool",
        ];
        assert_eq!(found.into_iter().collect::<Vec<_>>(), wanted);
    }
}
