//! A hundred static scenes from easy to nasty: 300 to 2700 unknowns, all settings but the steps at their defaults.
//!
//! They are what static contact meets: blocks of meshes that do not match, pressed and slid, with either side as slave; stiff on soft; deep ironing; a wedge that
//! spreads two blocks; a seal in a groove; a snap-fit; interference and taper fits; stacks; quadratic faces; rigid tools; sticking pads; a slave that is
//! prescribed as a whole and finer than its master; edges first; a rim that is passed and passed back; a pushed block; torsion; a reversal on
//! a slope; two masters with a seam; a strip bent over a roll.

use super::scene::{Elastic, Scene};

const SOFT: Elastic = (1000.0, 0.3);
const LOWER: ([f64; 3], [f64; 3]) = ([0.0; 3], [2.0, 2.0, 1.0]);
const UPPER: ([f64; 3], [f64; 3]) = ([0.4, 0.5, 1.0], [1.4, 1.5, 2.0]);

/// Scenes of all families.
pub fn scenes() -> Vec<Scene> {
    let mut all = Vec::new();
    two_blocks(&mut all);
    ironing(&mut all);
    hertz(&mut all);
    wedges(&mut all);
    seals(&mut all);
    snaps(&mut all);
    press_fits(&mut all);
    stacks(&mut all);
    quadratic(&mut all);
    tools(&mut all);
    undetermined(&mut all);
    tilted(&mut all);
    rims(&mut all);
    pushed(&mut all);
    turned(&mut all);
    slopes(&mut all);
    seams(&mut all);
    strips(&mut all);
    all
}

/// Slave and master: `[the first, the second]` if the letter is that of the first.
fn sides<'a>(letter: &str, first: &str, pair: [&'a str; 2]) -> [&'a str; 2] {
    if letter == first { pair } else { [pair[1], pair[0]] }
}

struct Two<'a> {
    method: &'a str,
    mu: f64,
    fine: &'a str,
    slave: &'a str,
    depth: f64,
    slide: f64,
    young: [f64; 2],
}

/// A block is pressed into a wider one in three steps and slid in eight.
fn two(name: String, of: &Two<'_>) -> Scene {
    let (upper, lower) = if of.fine == "u" { ([5, 5, 3], [4, 4, 2]) } else { ([3, 3, 2], [7, 7, 3]) };
    let [slave, master] = sides(of.slave, "u", ["upper.bottom", "lower.top"]);
    let [of_upper, of_lower] = of.young;
    Scene::new(name, 11)
        .block("lower", LOWER.0, LOWER.1, lower, (of_lower, 0.3))
        .block("upper", UPPER.0, UPPER.1, upper, (of_upper, 0.3))
        .contact(of.method, slave, master, of.mu)
        .fixed("lower.bottom", "xyz")
        .moved("upper.top", "xyz", &[[0.0; 4], [3.0, 0.0, 0.0, -of.depth], [11.0, of.slide, 0.0, -of.depth]])
}

fn two_blocks(all: &mut Vec<Scene>) {
    let plain = |method, mu, fine, slave| Two { method, mu, fine, slave, depth: 0.15, slide: 0.4, young: [1000.0; 2] };
    for (method, frictions) in [("mortar", &[0.0, 0.3, 1.0][..]), ("nts", &[0.0, 0.3])] {
        for &mu in frictions {
            for (fine, slave) in [("u", "u"), ("u", "l"), ("l", "u"), ("l", "l")] {
                let name = format!("two-{method}-mu{mu}-fine_{fine}-slave_{slave}");
                all.push(two(name, &plain(method, mu, fine, slave)));
            }
        }
    }
    for slave in ["u", "l"] {
        all.push(two(format!("two-cat-mu0.3-fine_u-slave_{slave}"), &plain("cat", 0.3, "u", slave)));
    }
    for method in ["mortar", "nts"] {
        for mu in [0.0, 0.4] {
            for slave in ["u", "l"] {
                let of = Two { depth: 0.3, slide: 0.5, young: [1e6, 1e3], ..plain(method, mu, "u", slave) };
                let scene = two(format!("stiff-{method}-mu{mu}-slave_{slave}"), &of);
                all.push(if (method, slave) == ("mortar", "u") { scene.quick() } else { scene });
            }
        }
    }
}

/// A stiff cube goes 0.7 of its height deep into a slab, and along it.
fn ironing(all: &mut Vec<Scene>) {
    for mu in [0.0, 0.2, 0.5] {
        for slave in ["indenter", "slab"] {
            let [slave_side, master] = sides(slave, "indenter", ["indenter.bottom", "slab.top"]);
            let path = [[0.0; 4], [7.0, 0.0, 0.0, -0.7], [21.25, 2.85, 0.0, -0.7]];
            all.push(
                Scene::with_steps(format!("iron-mu{mu}-{slave}"), 21.25, 1.0)
                    .also("\n[solver]\nrelative_tolerance = 1e-8\n")
                    .block("slab", [0.0; 3], [9.0, 4.0, 3.0], [20, 5, 3], (1.0, 0.3))
                    .block("indenter", [1.5, 1.5, 3.0], [2.5, 2.5, 4.0], [4, 4, 4], (1000.0, 0.3))
                    .contact("mortar", slave_side, master, mu)
                    .fixed("slab.bottom", "xyz")
                    .moved("indenter.top", "xyz", &path),
            );
        }
    }
}

fn hertz(all: &mut Vec<Scene>) {
    let ball = "generator = \"ball\", radius = 1.0, part = \"quarter\", divisions = [4, 4, 4]";
    for (name, method, mu, slave) in [
        ("hertz-mortar-mu0", "mortar", 0.0, "ball"),
        ("hertz-mortar-mu0.3", "mortar", 0.3, "ball"),
        ("hertz-nts-mu0.3", "nts", 0.3, "ball"),
        ("hertz-mortar-mu0.3-swap", "mortar", 0.3, "slab"),
    ] {
        let [slave, master] = sides(slave, "ball", ["ball.outer", "slab.top"]);
        all.push(
            Scene::new(name, 8)
                .body("ball", ball, SOFT, "")
                .block("slab", [0.0, -1.2, -2.0], [1.2, 1.2, -1.0], [6, 10, 4], SOFT)
                .contact(method, slave, master, mu)
                .fixed("slab.bottom", "xyz")
                .fixed("ball.left", "x")
                .fixed("slab.left", "x")
                .moved("ball.top", "yz", &[[0.0; 3], [4.0, 0.0, -0.2], [8.0, 0.2, -0.2]]),
        );
    }
}

/// A wedge goes between two blocks, and out again.
fn wedges(all: &mut Vec<Scene>) {
    for (method, mu, slave) in
        [("mortar", 0.0, "w"), ("mortar", 0.3, "w"), ("nts", 0.3, "w"), ("mortar", 0.3, "b"), ("mortar", 0.8, "w")]
    {
        let pairs = [["wedge.right", "right.left"], ["wedge.left", "left.right"]].map(|pair| sides(slave, "w", pair));
        let mut scene = Scene::new(format!("wedge-{method}-mu{mu}-slave_{slave}"), 10)
            .frustum(
                "wedge",
                [[-0.15, 0.0, 0.0], [0.15, 1.0, 0.0]],
                [[-0.5, 0.0, 1.0], [0.5, 1.0, 1.0]],
                [3, 3, 4],
                (5000.0, 0.3),
            )
            .frustum(
                "right",
                [[0.15, -0.1, 0.0], [1.2, 1.1, 0.0]],
                [[0.5, -0.1, 1.0], [1.2, 1.1, 1.0]],
                [3, 4, 5],
                SOFT,
            )
            .frustum(
                "left",
                [[-1.2, -0.1, 0.0], [-0.15, 1.1, 0.0]],
                [[-1.2, -0.1, 1.0], [-0.5, 1.1, 1.0]],
                [3, 4, 5],
                SOFT,
            );
        for [slave, master] in pairs {
            scene = scene.contact(method, slave, master, mu);
        }
        all.push(scene.fixed("right.right", "xyz").fixed("left.left", "xyz").moved(
            "wedge.top",
            "xyz",
            &[[0.0; 4], [6.0, 0.0, 0.0, -0.3], [10.0, 0.0, 0.0, 0.1]],
        ));
    }
}

/// A ring that touches along lines and is held by contact alone.
fn seals(all: &mut Vec<Scene>) {
    let ring = "generator = \"cylinder\", radius = 0.5, length = 0.2, part = \"full\", divisions = [3, 3, 3, 1]";
    let hard = (1e4, 0.3);
    for (name, method, mu, poisson, extra) in [
        ("oring-mortar-mu0.2", "mortar", 0.2, 0.45, ""),
        ("oring-nts-mu0.2", "nts", 0.2, 0.45, ""),
        ("oring-mortar-mu0.5-mixed", "mortar", 0.5, 0.495, "volumetric = \"mixed\""),
    ] {
        let mut scene = Scene::new(name, 15)
            .body("ring", ring, (10.0, poisson), extra)
            .block("lid", [-1.2, -0.05, 0.5], [1.2, 0.25, 0.7], [8, 1, 1], hard)
            .block("floor", [-1.2, -0.05, -0.7], [1.2, 0.25, -0.5], [8, 1, 1], hard)
            .block("wall", [0.55, -0.05, -0.5], [0.8, 0.25, 0.3], [1, 1, 5], hard);
        for master in ["lid.bottom", "floor.top", "wall.left"] {
            scene = scene.contact(method, "ring.outer", master, mu);
        }
        scene = scene.fixed("ring.all", "y").fixed("floor.all", "xyz").fixed("wall.all", "xyz").moved(
            "lid.all",
            "xyz",
            &[[0.0; 4], [10.0, 0.0, 0.0, -0.25], [15.0, 0.15, 0.0, -0.25]],
        );
        all.push(if method == "mortar" { scene.quick() } else { scene });
    }
}

/// A beam with a nose is pushed over a catch.
fn snaps(all: &mut Vec<Scene>) {
    for (method, mu) in [("mortar", 0.2), ("nts", 0.2), ("mortar", 0.0)] {
        all.push(
            Scene::new(format!("snap-{method}-mu{mu}"), 24)
                .block("beam", [0.0; 3], [3.0, 0.6, 0.2], [9, 2, 1], SOFT)
                .frustum(
                    "nose",
                    [[2.75, 0.0, -0.25], [2.85, 0.6, -0.25]],
                    [[2.5, 0.0, 0.0], [3.0, 0.6, 0.0]],
                    [2, 2, 2],
                    SOFT,
                )
                .also("\n[[tie]]\nslave = \"nose.top\"\nmaster = \"beam.bottom\"\n")
                .frustum(
                    "catch",
                    [[3.05, -0.1, -0.5], [3.65, 0.7, -0.5]],
                    [[3.3, -0.1, -0.05], [3.4, 0.7, -0.05]],
                    [2, 2, 3],
                    SOFT,
                )
                .contact(method, "nose.boundary", "catch.boundary", mu)
                .fixed("catch.bottom", "xyz")
                .moved("beam.left", "xyz", &[[0.0; 4], [24.0, 1.2, 0.0, 0.0]]),
        );
    }
}

fn press_fits(all: &mut Vec<Scene>) {
    let stiff = (2000.0, 0.3);
    let supported = |scene: Scene| scene.fixed("right.right", "xyz").fixed("left.left", "xyz");
    for (method, slave) in [("mortar", "p"), ("mortar", "b"), ("nts", "p")] {
        let mut scene = Scene::new(format!("interference-{method}-mu0.2-slave_{slave}"), 8)
            .block("pin", [-0.52, 0.0, 0.0], [0.52, 1.0, 1.5], [4, 3, 5], stiff)
            .block("right", [0.5, -0.1, 0.0], [1.3, 1.1, 1.0], [3, 4, 4], SOFT)
            .block("left", [-1.3, -0.1, 0.0], [-0.5, 1.1, 1.0], [3, 4, 4], SOFT);
        for pair in [["pin.right", "right.left"], ["pin.left", "left.right"]] {
            let [slave, master] = sides(slave, "p", pair);
            scene = scene.contact(method, slave, master, 0.2);
        }
        all.push(supported(scene).moved("pin.top", "xyz", &[[0.0; 4], [2.0, 0.0, 0.0, 0.0], [8.0, 0.0, 0.0, 0.3]]));
    }
    for method in ["mortar", "nts"] {
        let mut scene = Scene::new(format!("taper-{method}-mu0.3"), 12)
            .frustum(
                "pin",
                [[-0.45, 0.0, 0.0], [0.45, 1.0, 0.0]],
                [[-0.55, 0.0, 1.2], [0.55, 1.0, 1.2]],
                [4, 3, 5],
                stiff,
            )
            .block("right", [0.5, -0.1, -0.9], [1.3, 1.1, 0.2], [3, 4, 5], SOFT)
            .block("left", [-1.3, -0.1, -0.9], [-0.5, 1.1, 0.2], [3, 4, 5], SOFT);
        for [pin, block] in [["pin.right", "right.left"], ["pin.left", "left.right"]] {
            scene = scene.contact(method, block, pin, 0.3);
        }
        all.push(supported(scene).moved("pin.top", "xyz", &[[0.0; 4], [12.0, 0.0, 0.0, -0.75]]));
    }
}

fn stacks(all: &mut Vec<Scene>) {
    let meshes = [[3, 3, 2], [4, 4, 2], [2, 2, 2], [5, 5, 2]];
    let young = [1000.0, 300.0, 3000.0, 1000.0];
    let names = ["b0", "b1", "b2", "b3"];
    let tower = |mut scene: Scene, widths: &[f64]| {
        for (k, &w) in widths.iter().enumerate() {
            let z = 0.5 * k as f64;
            scene = scene.block(names[k], [-w, -w, z], [w, w, z + 0.5], meshes[k], (young[k], 0.3));
        }
        scene.fixed("b0.bottom", "xyz")
    };
    let between = |mut scene: Scene, method: &str, mu: f64, count: usize, is_down: bool| {
        for k in 1..count {
            let pair = [format!("{}.bottom", names[k]), format!("{}.top", names[k - 1])];
            let [slave, master] = if is_down { [&pair[0], &pair[1]] } else { [&pair[1], &pair[0]] };
            scene = scene.contact(method, slave, master, mu);
        }
        scene
    };
    for (name, method, is_down) in [
        ("stack-mortar-mu0.3-down", "mortar", true),
        ("stack-mortar-mu0.3-up", "mortar", false),
        ("stack-nts-mu0.3", "nts", true),
        ("stack-nts-mu0.3-up", "nts", false),
    ] {
        let scene = tower(Scene::new(name, 10), &[0.6, 0.5, 0.5, 0.4]);
        let path = [[0.0; 4], [4.0, 0.0, 0.0, -0.15], [10.0, 0.25, 0.05, -0.15]];
        all.push(between(scene, method, 0.3, 4, is_down).moved("b3.top", "xyz", &path));
    }
    for method in ["mortar", "nts"] {
        let scene = tower(Scene::new(format!("stackload-{method}-mu0.5"), 5), &[0.5; 3]);
        let load = [[0.0; 4], [3.0, 0.0, 0.0, -60.0], [5.0, 12.0, 0.0, -60.0]];
        all.push(between(scene, method, 0.5, 3, true).pulled("b2.top", &load));
    }
}

fn quadratic(all: &mut Vec<Scene>) {
    for cell in ["tet10", "hex20"] {
        for (method, mu) in [("mortar", 0.3), ("nts", 0.3), ("mortar", 0.0)] {
            let extra = format!("cell = \"{cell}\"");
            all.push(
                Scene::new(format!("{cell}-{method}-mu{mu}"), 9)
                    .block_with("lower", (LOWER.0, LOWER.1, [3, 3, 2]), SOFT, &extra)
                    .block_with("upper", (UPPER.0, [1.4, 1.5, 1.7], [2, 2, 1]), SOFT, &extra)
                    .contact(method, "upper.bottom", "lower.top", mu)
                    .fixed("lower.bottom", "xyz")
                    .moved("upper.top", "xyz", &[[0.0; 4], [3.0, 0.0, 0.0, -0.12], [9.0, 0.3, 0.0, -0.12]]),
            );
        }
    }
}

fn tools(all: &mut Vec<Scene>) {
    let sphere = "kind = \"sphere\", radius = 0.7, divisions = 8";
    let cuboid = "kind = \"box\", size = [0.8, 0.8, 0.5]";
    for (name, method, mu, shape, z) in [
        ("tool-sphere-mortar-mu0.2", "mortar", 0.2, sphere, 0.7),
        ("tool-sphere-nts-mu0.2", "nts", 0.2, sphere, 0.7),
        ("tool-sphere-mortar-mu0.6", "mortar", 0.6, sphere, 0.7),
        ("tool-box-mortar-mu0.2", "mortar", 0.2, cuboid, 0.25),
        ("tool-box-nts-mu0.2", "nts", 0.2, cuboid, 0.25),
    ] {
        all.push(
            Scene::new(name, 14)
                .block("block", [-1.0; 3], [1.5, 1.0, 0.0], [8, 6, 4], SOFT)
                .tool(shape, [0.0, 0.0, z], &[[0.0; 4], [6.0, 0.0, 0.0, -0.2], [14.0, 0.5, 0.0, -0.2]])
                .contact(method, "block.top", "tool.all", mu)
                .fixed("block.bottom", "xyz"),
        );
    }
    for (name, method, mu) in
        [("pad-mortar-mu0.4", "mortar", 0.4), ("pad-nts-mu0.4", "nts", 0.4), ("pad-mortar-mu1", "mortar", 1.0)]
    {
        all.push(
            Scene::new(name, 10)
                .block("pad", [0.0; 3], [1.0, 1.0, 0.6], [5, 5, 4], (10.0, 0.45))
                .tool("kind = \"box\", size = [3.0, 3.0, 0.4]", [0.5, 0.5, 0.8], &[[0.0; 4], [10.0, 0.0, 0.0, -0.24]])
                .contact(method, "pad.top", "tool.all", mu)
                .fixed("pad.bottom", "xyz"),
        );
    }
}

/// All slave nodes are prescribed, and there are more of them than motions of the master.
fn undetermined(all: &mut Vec<Scene>) {
    for (method, mu) in [("mortar", 0.4), ("nts", 0.4), ("mortar", 0.0)] {
        let scene = Scene::new(format!("undetermined-{method}-mu{mu}"), 8)
            .block("lower", LOWER.0, LOWER.1, [3, 3, 2], (100.0, 0.3))
            .block("upper", [0.5, 0.5, 1.0], [1.5, 1.5, 1.3], [6, 6, 1], SOFT)
            .contact(method, "upper.bottom", "lower.top", mu)
            .fixed("lower.bottom", "xyz")
            .moved("upper.all", "xyz", &[[0.0; 4], [3.0, 0.0, 0.0, -0.1], [8.0, 0.3, 0.0, -0.1]]);
        // With friction the tractions of nodes that are all prescribed along the surface are not determined, and how a run goes on is a matter of round-off.
        all.push(if (method, mu) == ("mortar", 0.0) { scene.quick() } else { scene });
    }
}

fn tilted(all: &mut Vec<Scene>) {
    let (sin, cos) = 8.0_f64.to_radians().sin_cos();
    let place =
        format!("rotation = [{{ axis = [0, 1, 0], degrees = 8 }}]\nposition = [0.0, 0.0, {:?}]", 0.5 * (cos + sin));
    let cube = "generator = \"block\", size = [1.0, 1.0, 1.0], divisions = [3, 3, 3]";
    for method in ["mortar", "nts"] {
        for slave in ["c", "s"] {
            let [slave_side, master] = sides(slave, "c", ["cube.boundary", "slab.top"]);
            all.push(
                Scene::new(format!("tilted8-{method}-mu0.3-slave_{slave}"), 10)
                    .block("slab", [-1.2, -1.2, -1.0], [1.2, 1.2, 0.0], [6, 6, 3], SOFT)
                    .body("cube", cube, (3000.0, 0.3), &place)
                    .contact(method, slave_side, master, 0.3)
                    .fixed("slab.bottom", "xyz")
                    .moved("cube.top", "xyz", &[[0.0; 4], [6.0, 0.0, 0.0, -0.25], [10.0, 0.2, 0.0, -0.25]]),
            );
        }
    }
}

/// Adds scenes of a block that goes over the rim of the other block, and back.
fn rims(all: &mut Vec<Scene>) {
    for (method, mu, slave) in [
        ("mortar", 0.0, "u"),
        ("mortar", 0.3, "u"),
        ("mortar", 0.3, "l"),
        ("nts", 0.3, "u"),
        ("nts", 0.3, "l"),
        ("nts", 0.0, "l"),
    ] {
        let [slave_side, master] = sides(slave, "u", ["upper.bottom", "lower.top"]);
        let path = [[0.0; 4], [3.0, 0.0, 0.0, -0.06], [11.0, 0.6, 0.0, -0.06], [16.0, 0.2, 0.0, -0.06]];
        all.push(
            Scene::new(format!("rim-{method}-mu{mu}-slave_{slave}"), 16)
                .block("lower", [0.0; 3], [1.0, 1.0, 0.7], [4, 3, 2], SOFT)
                .block("upper", [0.1, 0.1, 0.7], [0.9, 0.9, 1.2], [3, 4, 2], SOFT)
                .contact(method, slave_side, master, mu)
                .fixed("lower.bottom", "xyz")
                .moved("upper.top", "xyz", &path),
        );
    }
}

/// A loaded block is pushed along a floor; at a large coefficient its heel lifts off.
fn pushed(all: &mut Vec<Scene>) {
    for (method, mu) in [("mortar", 0.3), ("nts", 0.3), ("mortar", 0.9)] {
        all.push(
            Scene::new(format!("push-{method}-mu{mu}"), 10)
                .block("floor", [-1.0, -0.3, -0.5], [2.0, 1.3, 0.0], [6, 4, 2], (2000.0, 0.3))
                .block("block", [0.0; 3], [1.0, 1.0, 1.0], [4, 4, 4], (500.0, 0.3))
                .contact(method, "block.bottom", "floor.top", mu)
                .fixed("floor.bottom", "xyz")
                .pulled("block.top", &[[0.0; 4], [2.0, 0.0, 0.0, -20.0], [10.0, 0.0, 0.0, -20.0]])
                .moved("block.left", "x", &[[0.0; 2], [2.0, 0.0], [10.0, 0.12]]),
        );
    }
}

fn turned(all: &mut Vec<Scene>) {
    let tool = "generator = \"indenter\", size = [2.0, 2.0], height = 1.2, radius = 2.5, divisions = [6, 6, 4]";
    let turn = "\n[[prescribe]]\nset = \"indenter.top\"\nrotation = { axis = [0.0, 0.0, 1.0], degrees = { table = [[8.0, 0.0], [16.0, 35.0]] } }\n\
                translation = { table = [[0.0, 0.0, 0.0, 0.0], [8.0, 0.0, 0.0, -0.4]] }\n";
    for (method, mu) in [("mortar", 1.0), ("nts", 0.5)] {
        all.push(
            Scene::new(format!("torsion-{method}-mu{mu}"), 16)
                .body("indenter", tool, (1.0, 0.3), "")
                .block("block", [-1.6, -1.6, -1.5], [1.6, 1.6, 0.0], [5, 5, 4], (1.0, 0.3))
                .contact(method, "indenter.bottom", "block.top", mu)
                .fixed("block.bottom", "xyz")
                .also(turn),
        );
    }
}

/// A pressed slider goes up a slope of one in ten and turns round.
fn slopes(all: &mut Vec<Scene>) {
    // So that the load stands on the slope.
    let pressure = 500.0 / 1.01_f64.sqrt();
    for method in ["cat", "nts"] {
        let text = Scene::with_steps(format!("slope-{method}"), 3.1, 0.02)
            .frustum("wedge", [[0.0, 0.0, -1.0], [8.0, 2.0, -1.0]], [[0.0; 3], [8.0, 2.0, 0.8]], [8, 3, 1], (1e5, 0.0))
            .frustum(
                "slider",
                [[1.0, 0.5, 0.1], [3.0, 1.5, 0.3]],
                [[1.0, 0.5, 1.1], [3.0, 1.5, 1.3]],
                [3, 2, 2],
                (1e5, 0.0),
            )
            .contact(method, "slider.bottom", "wedge.top", 0.3)
            .fixed("wedge.all", "xyz")
            .fixed("slider.all", "y")
            .moved("slider.left", "x", &[[0.0; 2], [0.1, 0.0], [1.1, 0.5], [3.1, -0.5]])
            .pulled("slider.top", &[[0.0; 4], [0.1, 0.0, 0.0, -pressure]])
            .law("saint-venant-kirchhoff");
        all.push(if method == "cat" { text.quick() } else { text });
    }
}

/// One slave on two masters.
fn seams(all: &mut Vec<Scene>) {
    for method in ["mortar", "nts"] {
        all.push(
            Scene::new(format!("seam-{method}-mu0.3"), 8)
                .block("a", [-1.0, 0.0, 0.0], [0.0, 1.0, 0.6], [3, 3, 2], SOFT)
                .block("b", [0.0; 3], [1.0, 1.0, 0.6], [4, 4, 2], (500.0, 0.3))
                .block("u", [-0.5, 0.1, 0.6], [0.5, 0.9, 1.1], [5, 3, 2], SOFT)
                .contact(method, "u.bottom", "a.top", 0.3)
                .contact(method, "u.bottom", "b.top", 0.3)
                .fixed("a.bottom", "xyz")
                .fixed("b.bottom", "xyz")
                .moved("u.top", "xyz", &[[0.0; 4], [3.0, 0.0, 0.0, -0.08], [8.0, 0.3, 0.0, -0.08]]),
        );
    }
}

fn strips(all: &mut Vec<Scene>) {
    let roll = "generator = \"cylinder\", radius = 0.5, length = 0.4, part = \"full\", divisions = [3, 3, 3, 1]";
    let middle = "\n[[set]]\nname = \"strip.mid\"\nbody = \"strip\"\nbox = { min = [-0.01, -1.0, 0.59], max = [0.01, 1.0, 0.61] }\n";
    for method in ["mortar", "nts"] {
        all.push(
            Scene::new(format!("strip-{method}-mu0.2"), 12)
                .block("strip", [-2.0, 0.0, 0.5], [2.0, 0.4, 0.6], [16, 1, 1], SOFT)
                .body("roll", roll, (1e4, 0.3), "")
                .contact(method, "strip.bottom", "roll.outer", 0.2)
                .fixed("roll.all", "xyz")
                .fixed("strip.all", "y")
                .moved("strip.left", "z", &[[0.0; 2], [12.0, -0.8]])
                .moved("strip.right", "z", &[[0.0; 2], [12.0, -0.8]])
                .fixed("strip.mid", "x")
                .also(middle),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_a_hundred_scenes_that_can_be_built() {
        let all = scenes();
        assert_eq!(all.len(), 100);
        let mut names: Vec<&str> = all.iter().map(|scene| scene.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 100);
        assert!(all.iter().filter(|scene| scene.quick).count() >= 5);
        for scene in &all {
            stoss::scene::parse(scene.text(), &scene.name).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        }
    }
}
