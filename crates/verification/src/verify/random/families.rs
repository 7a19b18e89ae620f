//! Families of small scenes with rigid bodies, joints, ties, loads and general contact.
//!
//! Each is a few bodies along the axes of space, so that much of what must come out is known; see [`Known`].

use std::fmt::Write;

use fastrand::Rng;

use super::known::{Known, STEPS, uniform};

/// A scene as text, with what is known of it.
#[derive(Clone, Debug, Default)]
pub struct Draft {
    /// The scene.
    pub text: String,
    /// Scheme, or "quasi-static".
    pub scheme: String,
    /// Contact method; "general" if nothing is named, "-" without contact.
    pub method: String,
    /// What must come out.
    pub known: Known,
}

/// Makes a scene of a family, with quadratic elements if asked for.
pub type Family = fn(&mut Rng, bool) -> Draft;

/// Schemes that take contact.
const COLLIDING: [&str; 8] = [
    "energy-momentum",
    "energy-momentum",
    "energy-momentum",
    "energy-momentum",
    "midpoint",
    "backward-euler",
    "newmark",
    "generalised-alpha",
];

/// All schemes.
const ALL: [&str; 10] = [
    "energy-momentum",
    "energy-momentum",
    "midpoint",
    "variational-midpoint",
    "trapezoidal",
    "generalised-alpha",
    "hht",
    "newmark",
    "backward-euler",
    "forward-euler",
];

/// Quadratic cells.
const QUADRATIC: [&str; 4] = ["hex20", "hex27", "tet10", "wedge15"];

/// Cells.
const CELLS: [&str; 7] = ["hex8", "hex8", "hex8", "tet4", "wedge6", "hex20", "tet10"];

fn one_of<'a>(rng: &mut Rng, all: &[&'a str]) -> &'a str {
    all[rng.usize(..all.len())]
}

/// True in so many of a hundred cases.
fn often(rng: &mut Rng, percent: u32) -> bool {
    rng.u32(..100) < percent
}

fn cell(rng: &mut Rng, quadratic: bool) -> &'static str {
    if quadratic { one_of(rng, &QUADRATIC) } else { one_of(rng, &CELLS) }
}

/// Whether the mesh of a block is its own mirror image.
fn is_mirrored(cell: &str) -> bool {
    cell.starts_with("hex")
}

/// Round-off, a gap or an overlap.
fn round_off(rng: &mut Rng) -> f64 {
    [0.0, 1e-16, -1e-16, 1e-14, -1e-14, 1e-12, -1e-12][rng.usize(..7)]
}

impl Draft {
    fn dynamic(scheme: &str, step: f64, steps: u32) -> Self {
        let end = step * f64::from(steps);
        let text = format!(
            "[scene]\ntitle = \"Random\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = {step:?}\n\
             integrator = {{ scheme = \"{scheme}\" }}\n"
        );
        Self { text, scheme: scheme.into(), method: "-".into(), known: Known::default() }
    }

    fn statics(steps: u32, keys: &str) -> Self {
        let step = 1.0 / f64::from(steps);
        let text = format!(
            "[scene]\ntitle = \"Random\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = {step:?}\n{keys}\n"
        );
        Self { text, scheme: "quasi-static".into(), method: "-".into(), known: Known::default() }
    }

    fn add(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    /// A block between two corners.
    fn block(&mut self, name: &str, low: [f64; 3], size: [f64; 3], divisions: [usize; 3], material: &str, rest: &str) {
        let high: [f64; 3] = std::array::from_fn(|i| low[i] + size[i]);
        self.add(&format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {low:?}, max = {high:?}, divisions = {divisions:?} }}\n\
             material = {material}\n{rest}"
        ));
    }

    fn rigid(&mut self, name: &str, shape: &str, position: [f64; 3], rest: &str) {
        self.add(&format!("[[rigid]]\nname = \"{name}\"\nshape = {shape}\nposition = {position:?}\n{rest}"));
    }

    /// A floor whose upper side is z = 0; `hold` says how it is held.
    fn floor(&mut self, rng: &mut Rng, width: f64, hold: &str) -> &'static str {
        if rng.bool() {
            let divisions = [rng.usize(1..=3), rng.usize(1..=3)];
            let shape = format!("{{ kind = \"plane\", size = [{width:?}, {width:?}], divisions = {divisions:?} }}");
            self.rigid("floor", &shape, [0.0; 3], hold);
            "floor.all"
        } else {
            let shape = format!("{{ kind = \"box\", size = [{width:?}, {width:?}, {:?}] }}", 0.2 * width);
            self.rigid("floor", &shape, [0.0, 0.0, -0.1 * width], hold);
            "floor.top"
        }
    }

    /// Named contact, with slave and master exchanged in so many of a hundred cases.
    fn contact(&mut self, rng: &mut Rng, exchanged: u32, method: &str, pair: [&str; 2], mu: Option<f64>, rest: &str) {
        let [slave, master] = if often(rng, exchanged) { [pair[1], pair[0]] } else { pair };
        let friction = mu.map(|mu| format!("friction = {{ law = \"coulomb\", mu = {mu:?} }}\n")).unwrap_or_default();
        self.add(&format!(
            "[[contact]]\nmethod = \"{method}\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{friction}{rest}"
        ));
        self.method = method.into();
    }

    fn general(&mut self, mu: Option<f64>, rest: &str) {
        let friction = mu.map(|mu| format!("friction = {mu:?}\n")).unwrap_or_default();
        self.add(&format!("[general_contact]\n{friction}{rest}"));
        self.method = "general".into();
    }

    fn fixed(&mut self, set: &str, components: &[&str]) {
        self.add(&format!("[[prescribe]]\nset = \"{set}\"\ncomponents = {components:?}\nfixed = true"));
    }

    fn gravity(&mut self, g: f64) {
        self.add(&format!("[gravity]\nacceleration = [0.0, 0.0, {:?}]", -g));
    }
}

fn material(rng: &mut Rng, young: f64) -> String {
    let law = one_of(rng, &["neo-hooke", "neo-hooke", "saint-venant-kirchhoff"]);
    format!("{{ law = \"{law}\", young = {young:?}, poisson = {:?} }}", uniform(rng, 0.0, 0.4))
}

fn sizes(rng: &mut Rng, low: f64, high: f64) -> [f64; 3] {
    [0; 3].map(|_| uniform(rng, low, high))
}

fn divisions(rng: &mut Rng, quadratic: bool) -> [usize; 3] {
    [0; 3].map(|_| if quadratic { 1 } else { rng.usize(1..=2) })
}

fn friction(rng: &mut Rng, percent: u32) -> Option<f64> {
    often(rng, percent).then(|| uniform(rng, 0.05, 0.6))
}

/// Degrees about an axis, and the third row of the matrix.
fn rotation(rng: &mut Rng) -> (String, [f64; 3]) {
    let (axis, degrees) = match rng.usize(..3) {
        0 => ([0.0, 1.0, 0.0], 45.0),
        1 => ([0.0, 1.0, 0.0], uniform(rng, 1.0, 89.0)),
        _ => ([0; 3].map(|_| uniform(rng, 0.1, 1.0)), uniform(rng, 5.0, 85.0)),
    };
    let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    let n = axis.map(|a| a / length);
    let (s, c) = f64::to_radians(degrees).sin_cos();
    let skew = [-n[1], n[0], 0.0];
    let row = std::array::from_fn(|i| f64::from(u8::from(i == 2)) * c + (1.0 - c) * n[2] * n[i] + s * skew[i]);
    (format!("rotation = {{ axis = {axis:?}, degrees = {degrees:?} }}"), row)
}

/// A turned body that flies, with every scheme.
pub fn flight(rng: &mut Rng, quadratic: bool) -> Draft {
    let scheme = one_of(rng, &ALL);
    let cell = cell(rng, quadratic);
    let (young, density) = (10.0_f64.powf(uniform(rng, 1.0, 5.0)), uniform(rng, 0.5, 5.0));
    let size = sizes(rng, 0.5, 1.5);
    let divisions = divisions(rng, quadratic);
    let wave = (young / density).sqrt();
    let edge = (0..3).map(|i| size[i] / divisions[i] as f64).fold(f64::INFINITY, f64::min);
    // An explicit scheme has to resolve the waves.
    let reach = if scheme == "forward-euler" { 0.01 } else { 10.0_f64.powf(uniform(rng, -1.5, 0.5)) };
    let mut draft = Draft::dynamic(scheme, reach * edge / wave, rng.u32(10..=20));
    let (turn, _) = rotation(rng);
    let speed = wave * 10.0_f64.powf(uniform(rng, -3.0, -1.3));
    let [v, w] = [0; 2].map(|_| [0; 3].map(|_| speed * uniform(rng, -1.0, 1.0)));
    let rest =
        format!("cell = \"{cell}\"\ndensity = {density:?}\n{turn}\nvelocity = {v:?}\nangular_velocity = {w:?}\n");
    let law = material(rng, young);
    draft.block("b0", size.map(|s| -0.5 * s), size, divisions, &law, &rest);
    if often(rng, 20) {
        draft.gravity(speed * wave / edge * 0.1);
    }
    draft
}

/// A rigid or an elastic body falls flat on a rigid floor that is fixed or comes up, or a ball falls on it.
pub fn flat(rng: &mut Rng, quadratic: bool) -> Draft {
    let method = one_of(rng, &["nts", "nts", "mortar", "mortar", "cat", "general", "general"]);
    let scheme = match method {
        "general" => one_of(rng, &["energy-momentum", "energy-momentum", "energy-momentum", "backward-euler"]),
        "cat" => one_of(rng, &["energy-momentum", "midpoint", "backward-euler", "generalised-alpha"]),
        _ => one_of(rng, &COLLIDING),
    };
    let is_rigid = !quadratic && often(rng, 40);
    let is_ball = !is_rigid && often(rng, 25);
    let size = if is_ball { [1.0; 3] } else { sizes(rng, 0.5, 1.2) };
    let young = 10.0_f64.powf(uniform(rng, 2.0, 5.0));
    let density = uniform(rng, 0.5, 5.0);
    let wave = (young / density).sqrt();
    let speed = if is_rigid { uniform(rng, 0.2, 2.0) } else { wave * 10.0_f64.powf(uniform(rng, -2.3, -1.0)) };
    let step = if is_rigid { 0.01 } else { size[2] / wave * uniform(rng, 0.05, 0.2) };
    let gap = if often(rng, 25) { round_off(rng) } else { speed * step * uniform(rng, 1.0, 9.0) };
    let steps = rng.u32(STEPS / 2..=STEPS);
    let is_straight = rng.bool();
    let mut side = || if is_straight { 0.0 } else { speed * uniform(rng, -0.5, 0.5) };
    let velocity = [side(), side(), -speed];
    let mut draft = Draft::dynamic(scheme, step, steps);
    let centre = [0.0, 0.0, gap + 0.5 * size[2]];
    let foot;
    if is_rigid {
        let shape = format!("{{ kind = \"box\", size = {size:?} }}");
        draft.rigid("b0", &shape, centre, &format!("density = {density:?}\nvelocity = {velocity:?}"));
        foot = "b0.bottom";
    } else {
        let cell = match is_ball {
            true if quadratic => one_of(rng, &["hex20", "hex27", "tet10"]),
            true => "hex8",
            false => cell(rng, quadratic),
        };
        let rest = format!("cell = \"{cell}\"\ndensity = {density:?}\nvelocity = {velocity:?}");
        let law = material(rng, young);
        if is_ball {
            let place =
                if is_straight { centre } else { [uniform(rng, -0.4, 0.4), uniform(rng, -0.4, 0.4), centre[2]] };
            draft.add(&format!(
                "[[body]]\nname = \"b0\"\nmesh = {{ generator = \"ball\", radius = 0.5, divisions = [1, 1, 1] }}\nposition = {place:?}\n\
                 material = {law}\n{rest}"
            ));
            foot = "b0.outer";
        } else {
            let low = [-0.5 * size[0], -0.5 * size[1], gap];
            draft.block("b0", low, size, divisions(rng, quadratic), &law, &rest);
            foot = "b0.bottom";
        }
        draft.known.mirrored = is_straight && is_mirrored(cell);
    }
    if is_rigid {
        draft.known.mirrored = is_straight;
    }
    let is_driven = often(rng, 15);
    let hold = if is_driven { "" } else { "fixed = true" };
    let floor = draft.floor(rng, 8.0, hold);
    if is_driven {
        let end = step * f64::from(steps);
        draft.add(&format!(
            "[[prescribe]]\nrigid = \"floor\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0.0, 0.0], [{end:?}, {:?}]] }}",
            0.5 * speed * end
        ));
    }
    let mu = friction(rng, 30);
    let is_heavy = often(rng, 30);
    // Without the law of impact a rigid body comes back with its speed.
    let mut restitution = 1.0;
    if method == "general" {
        let slip = mu.map(|_| format!("slip_velocity = {:?}\n", 0.01 * speed)).unwrap_or_default();
        let pairs = "pairs = [{ between = [\"b0\", \"floor\"], modulus = 1e3 }]\n".to_owned();
        draft.general(mu, &format!("{slip}{}", if is_rigid { pairs } else { String::new() }));
    } else {
        let conserves = scheme == "energy-momentum" && mu.is_none();
        let rest = match method {
            "nts" if conserves && often(rng, 20) => "constraint = \"modified\"",
            // The law is that of schemes with the mean velocity; the first is the default.
            "nts" | "mortar" if is_rigid && ["energy-momentum", "midpoint"].contains(&scheme) => {
                restitution = [0.0, 0.5, 1.0][steps as usize % 3];
                ["", "restitution = 0.5", "restitution = 1.0"][steps as usize % 3]
            }
            _ => "",
        };
        // A fixed rigid slave on a rigid master has no pressures.
        let exchanged = if is_rigid { 0 } else { 25 };
        draft.contact(rng, exchanged, method, [foot, floor], mu, rest);
    }
    if is_heavy {
        draft.gravity(0.2 * speed / (step * f64::from(steps)));
    }
    draft.known.flat = true;
    draft.known.rebound = (is_rigid && !is_heavy && !is_driven && mu.is_none()).then_some([speed, restitution * speed]);
    draft
}

/// A rigid box falls on its edge or corner.
pub fn edge(rng: &mut Rng, _: bool) -> Draft {
    let method = one_of(rng, &["nts", "nts", "mortar", "general", "general"]);
    let scheme = match method {
        "general" => one_of(rng, &["energy-momentum", "energy-momentum", "backward-euler"]),
        _ => one_of(rng, &["energy-momentum", "energy-momentum", "midpoint", "backward-euler", "newmark"]),
    };
    let size = sizes(rng, 0.3, 0.9);
    let (turn, row) = rotation(rng);
    let half: f64 = (0..3).map(|i| 0.5 * size[i] * row[i].abs()).sum();
    let mut draft = Draft::dynamic(scheme, 0.01, STEPS);
    let velocity = [uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5), uniform(rng, -1.0, 0.0)];
    let rest = format!("{turn}\ndensity = {:?}\nvelocity = {velocity:?}", uniform(rng, 0.5, 5.0));
    draft.rigid("b0", &format!("{{ kind = \"box\", size = {size:?} }}"), [0.0, 0.0, half + 0.02], &rest);
    let floor = draft.floor(rng, 8.0, "fixed = true");
    let mu = friction(rng, 40);
    match method {
        "general" => {
            let slip = if mu.is_some() { "slip_velocity = 0.01\n" } else { "" };
            draft.general(mu, &format!("{slip}pairs = [{{ between = [\"b0\", \"floor\"], modulus = 1e4 }}]\n"));
        }
        _ => {
            draft.add(&format!(
                "[[contact]]\nmethod = \"{method}\"\nslave = \"b0.all\"\nmaster = \"{floor}\"\n{}",
                mu.map(|mu| format!("friction = {{ law = \"coulomb\", mu = {mu:?} }}")).unwrap_or_default()
            ));
            draft.method = method.into();
        }
    }
    draft.gravity(uniform(rng, 1.0, 10.0));
    draft.known.flat = true;
    draft
}

/// A rigid tool is pressed on a block, over all of it or with its rim on it, and may slide.
pub fn tool(rng: &mut Rng, quadratic: bool) -> Draft {
    let method = one_of(rng, &["nts", "mortar", "cat", "general"]);
    let young = 10.0_f64.powf(uniform(rng, 1.0, 6.0));
    let size = sizes(rng, 0.6, 1.4);
    let cell = cell(rng, quadratic);
    let gap = if rng.bool() { round_off(rng) } else { uniform(rng, 0.0, 0.05) * size[2] };
    let travel = size[2] * uniform(rng, 0.01, 0.15);
    let mu = friction(rng, 40);
    let mut draft = Draft::statics(rng.u32(4..=10), "");
    let is_plain = rng.bool();
    let law = match is_plain {
        true => format!("{{ law = \"saint-venant-kirchhoff\", young = {young:?}, poisson = 0.0 }}"),
        false => material(rng, young),
    };
    let low = [-0.5 * size[0], -0.5 * size[1], 0.0];
    draft.block("b0", low, size, divisions(rng, quadratic), &law, &format!("cell = \"{cell}\""));
    draft.fixed("b0.bottom", &["x", "y", "z"]);
    // A plane, or a box, that covers the block or a part of it.
    let covers = rng.bool();
    let shift = if covers { [0.0; 2] } else { [0; 2].map(|_| uniform(rng, -0.9, 0.9)) };
    let width = [2.0 * size[0], 2.0 * size[1]].map(|w| if covers { 2.0 * w } else { w });
    let place = [shift[0] * size[0], shift[1] * size[1], size[2] + gap];
    let foot = if rng.bool() {
        let shape = format!("{{ kind = \"plane\", size = {width:?} }}");
        draft.rigid("tool", &shape, place, "rotation = { axis = [1, 0, 0], degrees = 180 }");
        "tool.all"
    } else {
        let shape = format!("{{ kind = \"box\", size = [{:?}, {:?}, 0.5] }}", width[0], width[1]);
        draft.rigid("tool", &shape, [place[0], place[1], place[2] + 0.25], "");
        "tool.bottom"
    };
    let slide = if often(rng, 30) { 0.1 * uniform(rng, -1.0, 1.0) } else { 0.0 };
    let depth = gap + travel;
    draft.add(&format!(
        "[[prescribe]]\nrigid = \"tool\"\ncomponents = [\"x\", \"z\"]\n\
         displacement = {{ table = [[0.0, 0.0, 0.0], [1.0, {slide:?}, {:?}]] }}",
        -depth
    ));
    if method == "general" {
        draft.general(mu, "");
    } else {
        draft.contact(rng, 25, method, ["b0.top", foot], mu, "");
    }
    // The rim of a tool may be pushed sideways.
    draft.known.flat = covers;
    draft.known.travel = Some(travel);
    if is_plain && covers {
        let stretch = 1.0 - travel / size[2];
        draft.known.force = Some(0.5 * young * size[0] * size[1] * (stretch - stretch.powi(3)));
    }
    draft.known.mirrored = covers && slide == 0.0 && is_mirrored(cell);
    draft
}

/// Loads on one block, or on two blocks in contact; a gap is closed with `stabilise`.
pub fn loads(rng: &mut Rng, quadratic: bool) -> Draft {
    let method = one_of(rng, &["nts", "mortar", "cat", "general"]);
    let young = 10.0_f64.powf(uniform(rng, 2.0, 6.0));
    let is_pair = often(rng, 65);
    let gap = if rng.bool() { round_off(rng) } else { 10.0_f64.powf(uniform(rng, -5.0, -1.3)) };
    let is_loose = is_pair && (gap > 1e-9 || method == "general");
    let keys = match is_loose || often(rng, 10) {
        true => format!("stabilise = {{ fraction = {:?} }}", 10.0_f64.powf(uniform(rng, -5.0, -2.5))),
        false => String::new(),
    };
    let mut draft = Draft::statics(rng.u32(4..=10), &keys);
    let size = [sizes(rng, 1.0, 1.6), sizes(rng, 0.6, 1.0)];
    let count = if is_pair { 2 } else { 1 };
    let mut bottom = 0.0;
    for k in 0..count {
        let low = [-0.5 * size[k][0], -0.5 * size[k][1], bottom];
        let cell = cell(rng, quadratic);
        let ratio = 10.0_f64.powf(uniform(rng, -1.0, 1.0));
        let law = material(rng, young * ratio);
        let rest = format!("cell = \"{cell}\"\ndensity = 1.0");
        draft.block(&format!("b{k}"), low, size[k], divisions(rng, quadratic), &law, &rest);
        bottom += size[k][2] + gap;
    }
    let top = if is_pair { "b1" } else { "b0" };
    if often(rng, 25) {
        let per = 10.0 * young / size[0][2];
        draft.add(&format!("[[support]]\nset = \"b0.bottom\"\nstiffness = [{per:?}, {per:?}, {:?}]", 3.0 * per));
    } else {
        draft.fixed("b0.bottom", &["x", "y", "z"]);
    }
    if is_pair {
        draft.fixed("b1.top", &["x", "y"]);
    }
    // Up to a few per cent of Young's modulus of the softer block.
    let pressure = 0.1 * young * 10.0_f64.powf(uniform(rng, -3.0, -0.7));
    let area = size[count - 1][0] * size[count - 1][1];
    let ramp = |values: &[f64]| {
        let mut text = String::from("{ table = [[0.0");
        // cannot fail: writing to a String.
        values.iter().for_each(|_| text.push_str(", 0.0"));
        text.push_str("], [1.0");
        values.iter().for_each(|value| {
            let _ = write!(text, ", {value:?}");
        });
        text.push_str("]] }");
        text
    };
    let side = if is_pair { 0.0 } else { pressure * uniform(rng, -0.3, 0.3) };
    match rng.usize(..4) {
        0 => draft.add(&format!("[[load]]\nset = \"{top}.top\"\npressure = {}", ramp(&[pressure]))),
        1 => draft.add(&format!("[[load]]\nset = \"{top}.top\"\ntraction = {}", ramp(&[side, 0.0, -pressure]))),
        2 => {
            let force = [side * area, 0.0, -pressure * area];
            draft.add(&format!("[[load]]\nset = \"{top}.top\"\ntotal_force = {}", ramp(&force)));
        }
        _ => {
            let force = [0.0, side, -pressure / size[count - 1][2]];
            draft.add(&format!("[[load]]\nbody = \"{top}\"\nbody_force = {}", ramp(&force)));
        }
    }
    if often(rng, 30) {
        draft.gravity(0.3 * pressure);
    }
    let mu = friction(rng, 30);
    if is_pair && method == "general" {
        draft.general(mu, "");
    } else if is_pair {
        draft.contact(rng, 25, method, ["b1.bottom", "b0.top"], mu, "");
    }
    draft
}

/// Bodies at rest that touch, or are apart, without loads and velocities, with every scheme.
pub fn rest(rng: &mut Rng, quadratic: bool) -> Draft {
    let method = one_of(rng, &["nts", "mortar", "cat", "general", "tie", "tie"]);
    let scheme = match method {
        "general" => one_of(rng, &["energy-momentum", "backward-euler", "quasi-static"]),
        "cat" => one_of(rng, &["energy-momentum", "midpoint", "backward-euler", "generalised-alpha", "quasi-static"]),
        "tie" => one_of(rng, &["energy-momentum", "midpoint", "backward-euler", "hht", "quasi-static"]),
        _ => one_of(rng, &["energy-momentum", "midpoint", "backward-euler", "newmark", "hht", "quasi-static"]),
    };
    let is_static = scheme == "quasi-static";
    let young = 10.0_f64.powf(uniform(rng, 0.0, 9.0));
    let mut draft = match is_static {
        true => Draft::statics(3, ""),
        false => Draft::dynamic(scheme, (1.0 / young).sqrt() * uniform(rng, 0.05, 1.0), 15),
    };
    let cells = [cell(rng, quadratic), cell(rng, quadratic)];
    if method == "tie" && quadratic {
        // Two shells of a ball, one around the other.
        for (k, [inner, outer]) in [[0.6, 1.0], [1.0, 1.4]].into_iter().enumerate() {
            let law = material(rng, young);
            draft.add(&format!(
                "[[body]]\nname = \"b{k}\"\nmesh = {{ generator = \"hollow-ball\", inner_diameter = {inner:?}, outer_diameter = {outer:?}, divisions = [{}, 1] }}\n\
                 material = {law}\ncell = \"{}\"\ndensity = 1.0",
                2, cells[k]
            ));
        }
        draft.add("[[tie]]\nslave = \"b1.inner\"\nmaster = \"b0.outer\"");
        if is_static {
            draft.fixed("b0.inner", &["x", "y", "z"]);
        }
        draft.method = "tie".into();
    } else {
        let size = [sizes(rng, 0.8, 1.2), sizes(rng, 0.5, 0.8)];
        let gap = if often(rng, 75) { round_off(rng) } else { uniform(rng, 0.001, 0.1) };
        let mut bottom = 0.0;
        for k in 0..2 {
            let low = [-0.5 * size[k][0], -0.5 * size[k][1], bottom];
            let rest = format!("cell = \"{}\"\ndensity = 1.0", cells[k]);
            let law = material(rng, young);
            draft.block(&format!("b{k}"), low, size[k], divisions(rng, quadratic), &law, &rest);
            bottom += size[k][2] + gap;
        }
        match method {
            "tie" => {
                draft.add("[[tie]]\nslave = \"b1.bottom\"\nmaster = \"b0.top\"");
                draft.method = "tie".into();
            }
            "general" => draft.general(None, ""),
            _ => draft.contact(rng, 25, method, ["b1.bottom", "b0.top"], None, ""),
        }
        if is_static {
            draft.fixed("b0.bottom", &["x", "y", "z"]);
            if method != "tie" {
                draft.fixed("b1.top", &["x", "y", "z"]);
            }
        }
    }
    draft.known.rest = true;
    draft
}

/// Two tied blocks fly, or are loaded.
pub fn tie(rng: &mut Rng, quadratic: bool) -> Draft {
    let scheme = one_of(rng, &["energy-momentum", "energy-momentum", "midpoint", "backward-euler", "quasi-static"]);
    let is_static = scheme == "quasi-static";
    let young = 10.0_f64.powf(uniform(rng, 2.0, 5.0));
    let wave = young.sqrt();
    let mut draft = match is_static {
        true => Draft::statics(rng.u32(3..=6), ""),
        false => Draft::dynamic(scheme, uniform(rng, 0.05, 0.5) / wave, rng.u32(10..=25)),
    };
    let size = [sizes(rng, 0.8, 1.2), sizes(rng, 0.5, 0.8)];
    let speed = wave * 10.0_f64.powf(uniform(rng, -2.5, -1.2));
    let [v, w] = [0; 2].map(|_| [0; 3].map(|_| speed * uniform(rng, -1.0, 1.0)));
    let motion = match is_static {
        true => String::new(),
        false => format!("velocity = {v:?}\nangular_velocity = {w:?}\n"),
    };
    let mut bottom = 0.0;
    for k in 0..2 {
        let low = [-0.5 * size[k][0], -0.5 * size[k][1], bottom];
        let rest = format!("cell = \"{}\"\ndensity = 1.0\n{motion}", cell(rng, quadratic));
        let ratio = 10.0_f64.powf(uniform(rng, -1.0, 1.0));
        let law = material(rng, young * ratio);
        draft.block(&format!("b{k}"), low, size[k], divisions(rng, quadratic), &law, &rest);
        bottom += size[k][2];
    }
    let form = one_of(rng, &["constant", "frame-invariant"]);
    draft.add(&format!("[[tie]]\nslave = \"b1.bottom\"\nmaster = \"b0.top\"\nform = \"{form}\""));
    draft.method = "tie".into();
    if is_static {
        draft.fixed("b0.bottom", &["x", "y", "z"]);
        let force = [0; 3].map(|_| 0.01 * young * uniform(rng, -1.0, 1.0) * size[1][0] * size[1][1]);
        draft.add(&format!(
            "[[load]]\nset = \"b1.top\"\ntotal_force = {{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, {:?}, {:?}, {:?}]] }}",
            force[0], force[1], force[2]
        ));
    }
    draft
}

/// A chain of rigid boxes, free or on the ground, with joints of any kind.
pub fn joints(rng: &mut Rng, _: bool) -> Draft {
    let scheme = one_of(
        rng,
        &[
            "energy-momentum",
            "energy-momentum",
            "energy-momentum",
            "midpoint",
            "backward-euler",
            "generalised-alpha",
            "trapezoidal",
        ],
    );
    let mut draft = Draft::dynamic(scheme, uniform(rng, 0.003, 0.02), STEPS);
    let count = rng.usize(1..=3);
    let is_held = count == 1 || rng.bool();
    let [v, w] = match is_held {
        true => [[0.0; 3]; 2],
        false => [0; 2].map(|_| [0; 3].map(|_| uniform(rng, -2.0, 2.0))),
    };
    let length = uniform(rng, 0.5, 1.0);
    for k in 0..count {
        let size = [length, uniform(rng, 0.1, 0.3), uniform(rng, 0.1, 0.3)];
        let centre = [length * (k as f64 + 0.5), 0.0, 0.0];
        let velocity = [v[0], v[1] + w[2] * centre[0], v[2] - w[1] * centre[0]];
        let rest = format!("density = {:?}\nvelocity = {velocity:?}\nangular_velocity = {w:?}", uniform(rng, 0.5, 5.0));
        draft.rigid(&format!("b{k}"), &format!("{{ kind = \"box\", size = {size:?} }}"), centre, &rest);
    }
    for k in usize::from(!is_held)..count {
        let before = if k == 0 { "ground".to_owned() } else { format!("b{}", k - 1) };
        let at = [length * k as f64, 0.0, 0.0];
        let kind =
            one_of(rng, &["hinge", "hinge", "hinge", "ball", "slider", "cylindrical", "universal", "weld", "planar"]);
        let axis = [[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]][rng.usize(..4)];
        let mut joint =
            format!("[[joint]]\nname = \"j{k}\"\nkind = \"{kind}\"\nbetween = [\"{before}\", \"b{k}\"]\nat = {at:?}\n");
        // cannot fail: writing to a String.
        let _ = match kind {
            "universal" => writeln!(joint, "axes = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]"),
            "ball" | "weld" => Ok(()),
            _ => writeln!(joint, "axis = {axis:?}"),
        };
        let is_angle = matches!(kind, "hinge" | "cylindrical");
        let does_move = is_angle || kind == "slider";
        let most = if is_angle { uniform(rng, 5.0, 40.0) } else { uniform(rng, 0.02, 0.2) };
        let _ = match rng.usize(..6) {
            0 | 1 if does_move => writeln!(joint, "limits = [{:?}, {most:?}]", -most),
            2 if does_move && is_held => {
                let key = if is_angle { "angle" } else { "displacement" };
                writeln!(joint, "motor = {{ {key} = {{ table = [[0.0, 0.0], [1.0, {most:?}]] }} }}")
            }
            3 if does_move => {
                let stiffness = uniform(rng, 1.0, 100.0);
                writeln!(joint, "spring = {{ stiffness = {stiffness:?} }}")
            }
            4 if does_move => writeln!(joint, "friction = {{ viscous = {:?} }}", uniform(rng, 0.01, 0.5)),
            _ => Ok(()),
        };
        draft.add(&joint);
    }
    if is_held || often(rng, 30) {
        draft.gravity(uniform(rng, 1.0, 10.0));
    }
    draft
}

/// Turned blocks of several stiffnesses fly into each other, nothing named.
pub fn general(rng: &mut Rng, quadratic: bool) -> Draft {
    let scheme = one_of(rng, &["energy-momentum", "energy-momentum", "energy-momentum", "backward-euler"]);
    let count = [2, 2, 3][rng.usize(..3)];
    let mu = friction(rng, 40);
    let young = 10.0_f64.powf(uniform(rng, 1.0, 4.0));
    let speed = young.sqrt() * 10.0_f64.powf(uniform(rng, -2.0, -1.0));
    let has_rigid = often(rng, 30);
    let mut bodies = Draft::default();
    let (mut place, mut shortest) = (0.0, f64::INFINITY);
    for k in 0..count {
        let size = sizes(rng, 0.5, 1.0);
        let parts = divisions(rng, quadratic);
        let edge = (0..3).map(|i| size[i] / parts[i] as f64).fold(f64::INFINITY, f64::min);
        shortest = f64::min(shortest, edge);
        let radius = 0.5 * size.iter().map(|s| s * s).sum::<f64>().sqrt();
        place += if k == 0 { 0.0 } else { radius + 0.05 };
        let towards = 0.5 * (count as f64 - 1.0) - k as f64;
        let velocity = [speed * uniform(rng, -0.2, 0.2), speed * uniform(rng, -0.2, 0.2), speed * towards];
        let centre = [uniform(rng, -0.15, 0.15), uniform(rng, -0.15, 0.15), place];
        let (turn, _) = rotation(rng);
        let rest = format!("{turn}\ndensity = 1.0\nvelocity = {velocity:?}");
        if k == 0 && has_rigid {
            bodies.rigid("b0", &format!("{{ kind = \"box\", size = {size:?} }}"), centre, &rest);
        } else {
            let ratio = 10.0_f64.powf(uniform(rng, 0.0, 1.0));
            let law = material(rng, young * ratio);
            bodies.add(&format!(
                "[[body]]\nname = \"b{k}\"\nmesh = {{ generator = \"block\", size = {size:?}, divisions = {parts:?} }}\nposition = {centre:?}\n\
                 material = {law}\ncell = \"{}\"\n{rest}",
                cell(rng, quadratic)
            ));
        }
        place += radius;
    }
    // A step moves bodies by two thicknesses or so.
    let mut draft = Draft::dynamic(scheme, 0.04 * shortest / speed * uniform(rng, 0.5, 3.0), STEPS);
    draft.add(&bodies.text);
    draft.general(mu, "");
    draft
}
