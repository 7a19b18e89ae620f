//! Malformed scenes: every one gives exactly the problem that it has, at the line of the mistake, with a message and a remedy.

#[path = "malformed/inelastic.rs"]
mod inelastic;
#[path = "malformed/multibody.rs"]
mod multibody;
#[path = "malformed/remedies.rs"]
mod remedies;

use stoss_scene::parse;

const DYNAMIC: &str = include_str!("data/dynamic.toml");
const STATIC: &str = include_str!("data/quasi-static.toml");

/// A mistake: `from` in the base scene is replaced by `to`; the problem is in the line that contains `at` and names `key`.
pub struct Case {
    base: &'static str,
    /// The contact of the base scene is mortar contact.
    mortar: bool,
    from: &'static str,
    to: &'static str,
    at: &'static str,
    key: &'static str,
}

const fn dynamic(from: &'static str, to: &'static str, at: &'static str, key: &'static str) -> Case {
    Case { base: DYNAMIC, mortar: false, from, to, at, key }
}

/// A mistake in a mortar contact.
const fn mortar(from: &'static str, to: &'static str, at: &'static str, key: &'static str) -> Case {
    Case { base: DYNAMIC, mortar: true, from, to, at, key }
}

const fn quasi(from: &'static str, to: &'static str, at: &'static str, key: &'static str) -> Case {
    Case { base: STATIC, mortar: false, from, to, at, key }
}

/// A mistake in the rotation of the static scene.
const fn turn(from: &'static str, to: &'static str, key: &'static str) -> Case {
    Case { base: STATIC, mortar: false, from, to, at: "rotation = {", key }
}

const TURN: &str =
    "rotation = { axis = [0, 0, 1], about = [0, 0, 2], degrees = { table = [[0.0, 0.0], [1.0, 720.0]] } }";
const VELOCITY: &str = "velocity = [0.0, 1.0, -1.0]";
const BALL: &str =
    "mesh = { generator = \"hollow-ball\", inner_diameter = 0.8, outer_diameter = 1.0, divisions = [6, 2] }";
const BLOCK: &str = "min = [0, 0, 0], max = [1, 1, 1], divisions = [4, 4, 4], grading = [1, 1, 2]";
const TABLE: &str = "{ table = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0]] }";
const MIDDLE: &str = "plane = { point = [0, 0, 0], normal = [1, 0, 0], tolerance = 1e-3 }";

const CASES: &[Case] = &[
    // TOML itself
    dynamic("title = \"Hollow", "title = Hollow", "title = Hollow", ""),
    dynamic("density = 10.0", "density = 10.0\ndensity = 11.0", "density = 11.0", ""),
    dynamic("step = 0.01", "step = ", "step = ", ""),
    dynamic("kind = \"dynamic\"", "kind = \"dynamic", "kind = \"dynamic", ""),
    // centrifugal loads
    quasi("traction = [0, 0, 1.5]", "angular_velocity = 3\naxis = [0, 0, 1]", "set = \"block.left\"", "load[0].set"),
    quasi(
        "set = \"block.left\"\ntraction = [0, 0, 1.5]",
        "body = \"block\"\nangular_velocity = 3",
        "[[load]]",
        "load[0].axis",
    ),
    quasi(
        "set = \"block.left\"\ntraction = [0, 0, 1.5]",
        "body = \"block\"\nangular_velocity = 3\naxis = [0, 0, 0]",
        "axis = [0, 0, 0]",
        "load[0].axis",
    ),
    quasi(
        "set = \"block.left\"\ntraction = [0, 0, 1.5]",
        "body = \"block\"\nangular_velocity = [0, 0, 3]\naxis = [0, 0, 1]",
        "angular",
        "load[0].angular_velocity",
    ),
    quasi("traction = [0, 0, 1.5]", "traction = [0, 0, 1.5]\naxis = [0, 0, 1]", "axis = [0, 0, 1]\n\n", "load[0].axis"),
    quasi(
        "traction = [0, 0, 1.5]",
        "traction = [0, 0, 1.5]\nabout = [0, 0, 1]",
        "about = [0, 0, 1]\n\n",
        "load[0].about",
    ),
    // [time] of statics
    dynamic("max_cuts = 8", "automatic = { initial = 0.001 }", "automatic", "time.automatic"),
    dynamic("max_cuts = 8", "stabilise = { fraction = 1e-4 }", "stabilise", "time.stabilise"),
    quasi("step = 0.1\n", "step = 0.1\nautomatic = true\n", "automatic", "time.automatic"),
    quasi("step = 0.1\n", "step = 0.1\nautomatic = {}\n", "automatic", "time.automatic.initial"),
    quasi("step = 0.1\n", "step = 0.1\nautomatic = { initial = 0.2 }\n", "automatic", "time.automatic.initial"),
    quasi("step = 0.1\n", "step = 0.1\nautomatic = { initial = 1e-12 }\n", "automatic", "time.automatic.initial"),
    quasi(
        "step = 0.1\n",
        "step = 0.1\nautomatic = { initial = 0.01, smallest = 0.02 }\n",
        "automatic",
        "time.automatic.smallest",
    ),
    quasi("step = 0.1\n", "step = 0.1\nautomatic = { initial = 0.01, easy = 0 }\n", "automatic", "time.automatic.easy"),
    quasi(
        "step = 0.1\n",
        "step = 0.1\nautomatic = { initial = 0.01, after = 0 }\n",
        "automatic",
        "time.automatic.after",
    ),
    quasi("step = 0.1\n", "step = 0.1\nautomatic = { initial = 0.01, hard = 5 }\n", "automatic", "time.automatic.hard"),
    quasi(
        "step = 0.1\n",
        "step = 0.1\nautomatic = { initial = 0.01, largest = 1 }\n",
        "automatic",
        "time.automatic.largest",
    ),
    quasi("step = 0.1\n", "step = 0.1\nautomatic = { initial = 0.01 }\nmax_cuts = 3\n", "max_cuts", "time.max_cuts"),
    quasi(
        "step = 0.1\n",
        "step = 0.1\nautomatic = { initial = 0.01 }\ngrow_after = 3\n",
        "grow_after",
        "time.grow_after",
    ),
    quasi("step = 0.1\n", "step = 0.1\nstabilise = true\n", "stabilise", "time.stabilise"),
    quasi("step = 0.1\n", "step = 0.1\nstabilise = {}\n", "stabilise", "time.stabilise.fraction"),
    quasi("step = 0.1\n", "step = 0.1\nstabilise = { fraction = 2 }\n", "stabilise", "time.stabilise.fraction"),
    quasi("step = 0.1\n", "step = 0.1\nstabilise = { coefficient = 0 }\n", "stabilise", "time.stabilise.coefficient"),
    quasi(
        "step = 0.1\n",
        "step = 0.1\nstabilise = { fraction = 1e-4, coefficient = 1 }\n",
        "stabilise",
        "time.stabilise.coefficient",
    ),
    // [scene]
    dynamic("[scene]\ntitle = \"Hollow ball on plate\"\nkind = \"dynamic\"\n", "scene = 1", "scene = 1", "scene"),
    dynamic("kind = \"dynamic\"", "kind = \"dynamics\"", "dynamics", "scene.kind"),
    dynamic("title = \"Hollow ball on plate\"", "", "[scene]", "scene.title"),
    dynamic("\"Hollow ball on plate\"", "\"  \"", "title", "scene.title"),
    dynamic("\"Hollow ball on plate\"", "7", "title", "scene.title"),
    dynamic("[scene]\n", "[scene]\nauthor = \"x\"\n", "author", "scene.author"),
    dynamic("[output]", "[outputs]", "[outputs]", "outputs"),
    dynamic("[scene]\n", "[scene]\nformat = 99\n", "format", "scene.format"),
    dynamic("[scene]\n", "[scene]\nformat = 0\n", "format", "scene.format"),
    dynamic("[scene]\n", "[scene]\nformat = \"new\"\n", "format", "scene.format"),
    dynamic("[scene]\n", "[scene]\nunits = \"mm-kg-min\"\n", "units", "scene.units"),
    dynamic("[scene]\n", "[scene]\nunits = 1\n", "units", "scene.units"),
    // what was once
    dynamic("method = \"nts\"", "method = \"nts\"\nnormals = \"averaged\"", "normals", "contact[0].normals"),
    dynamic("method = \"nts\"", "method = \"nts\"\nsmoothing = 0.1", "smoothing", "contact[0].smoothing"),
    // [time]
    dynamic("step = 0.01", "step = 0.0", "step = 0.0", "time.step"),
    dynamic("step = 0.01", "step = -0.01", "step = -", "time.step"),
    dynamic("step = 0.01", "step = nan", "step = nan", "time.step"),
    dynamic("step = 0.01", "step = \"slow\"", "step = \"", "time.step"),
    dynamic("step = 0.01", "step = 2", "step = 2", "time.step"),
    dynamic("step = 0.01", "step = 1e-12", "step = 1e-12", "time.step"),
    dynamic("step = 0.01\n", "", "[time]", "time.step"),
    dynamic("end = 1.0", "end = inf", "end = inf", "time.end"),
    dynamic("end = 1.0", "end = 1e999", "end = 1e999", "time.end"),
    dynamic("\"energy-momentum\"", "\"leapfrog\"", "leapfrog", "time.integrator.scheme"),
    dynamic("integrator = { scheme = \"energy-momentum\" }", "", "[time]", "time.integrator"),
    dynamic("{ scheme = \"energy-momentum\" }", "{}", "integrator = {}", "time.integrator.scheme"),
    dynamic("{ scheme = \"energy-momentum\" }", "\"midpoint\"", "integrator = \"", "time.integrator"),
    dynamic("max_cuts = 8", "max_cuts = 31", "max_cuts = 31", "time.max_cuts"),
    dynamic("max_cuts = 8", "max_cuts = 1.5", "max_cuts = 1.5", "time.max_cuts"),
    dynamic("max_cuts = 8", "grow_after = 0", "grow_after", "time.grow_after"),
    dynamic("max_cuts = 8", "max_cut = 8", "max_cut = 8", "time.max_cut"),
    quasi("step = 0.1", "step = 0.1\nintegrator = { scheme = \"midpoint\" }", "midpoint", "time.integrator"),
    // [solver]
    dynamic("relative_tolerance = 1e-9", "relative_tolerance = 2", "relative_tolerance", "solver.relative_tolerance"),
    dynamic("max_iterations = 20", "max_iterations = 0", "max_iterations", "solver.max_iterations"),
    dynamic("max_iterations = 20", "polish = 0", "polish", "solver.polish"),
    dynamic("max_iterations = 20", "linear = \"magic\"", "magic", "solver.linear"),
    dynamic("max_iterations = 20", "petsc = \"cholesky\"", "cholesky", "solver.petsc"),
    dynamic("max_iterations = 20", "linear = \"faer\"\npetsc = \"direct\"", "petsc", "solver.petsc"),
    dynamic("max_iterations = 20", "absolute_tolerance = -1", "absolute_tolerance", "solver.absolute_tolerance"),
    // [watch]
    dynamic("[time]", "[watch]\nevery = 0\n\n[time]", "every = 0", "watch.every"),
    dynamic("[time]", "[watch]\nlimit = -0.1\n\n[time]", "limit = -0.1", "watch.limit"),
    dynamic("[time]", "[watch]\non_fault = \"halt\"\n\n[time]", "halt", "watch.on_fault"),
    dynamic("[time]", "[watch]\ndepth = 1\n\n[time]", "depth = 1", "watch.depth"),
    // [[body]]
    dynamic("name = \"ball\"\n", "name = \"ball.x\"\n", "ball.x", "body[0].name"),
    dynamic("name = \"plate\"\n", "name = \"\"\n", "name = \"\"", "body[1].name"),
    quasi("\"ring\"", "\"block\"", "\"block\"\nmesh = { generator = \"hollow-torus", "body[1].name"),
    dynamic("density = 10.0", "density = -1.0", "density = -1.0", "body[0].density"),
    dynamic("density = 10.0", "density = 0", "density = 0", "body[0].density"),
    dynamic("density = 10.0\n", "", "[[body]]", "body[0].density"),
    dynamic("density = 10.0", "desnity = 1\ndensity = 10.0", "desnity", "body[0].desnity"),
    dynamic("density = 10.0", "density = 10.0\nmass = \"heavy\"", "heavy", "body[0].mass"),
    dynamic(VELOCITY, "velocity = [0.0, 1.0]", "velocity", "body[0].velocity"),
    dynamic(VELOCITY, "damping = 0.1", "damping", "body[0].damping"),
    dynamic(VELOCITY, "damping = {}", "damping", "body[0].damping"),
    dynamic(VELOCITY, "damping = { mass = 0, stiffness = 0.0 }", "damping", "body[0].damping"),
    dynamic(VELOCITY, "damping = { mass = -0.1 }", "damping", "body[0].damping.mass"),
    dynamic(VELOCITY, "damping = { stiffness = -1e-3 }", "damping", "body[0].damping.stiffness"),
    dynamic(VELOCITY, "damping = { alpha = 0.1, mass = 1 }", "damping", "body[0].damping.alpha"),
    quasi(
        "[[body]]\nname = \"brick\"\n",
        "[[body]]\nname = \"brick\"\ndamping = { mass = 0.1 }\n",
        "damping",
        "body[4].damping",
    ),
    quasi(
        "[[body]]\nname = \"brick\"\n",
        "[[support]]\nset = \"brick.all\"\nper = \"node\"\ndamping = [1, 0, 0]\n[[body]]\nname = \"brick\"\n",
        "damping",
        "support[0].damping",
    ),
    dynamic(VELOCITY, "velocity = [0.0, \"fast\", 0]", "velocity", "body[0].velocity[1]"),
    dynamic(VELOCITY, "velocity = 3", "velocity", "body[0].velocity"),
    dynamic(VELOCITY, "velocity_gradient = [[1, 0, 0], [0, 1, 0]]", "velocity", "body[0].velocity_gradient"),
    dynamic("degrees = 0", "degrees = nan", "nan", "body[0].rotation.degrees"),
    dynamic("axis = [0, 0, 1], degrees = 0", "axis = [0, 0, 0], degrees = 0", "degrees = 0", "body[0].rotation.axis"),
    dynamic("[1, 0, 0], degrees = 180", "[1, 0, 0]", "about = [0, 0, 0.5]", "body[1].rotation[1].degrees"),
    quasi("name = \"block\"", "name = \"block\"\nvelocity = [0, 0, 1]", "velocity", "body[0].velocity"),
    // meshes
    dynamic(BALL, "mesh = { generator = \"sphere\" }", "sphere", "body[0].mesh.generator"),
    dynamic(BALL, "mesh = { generator = \"block\", file = \"a.msh\" }", "a.msh", "body[0].mesh.generator"),
    dynamic(BALL, "mesh = { inner_diameter = 1 }", "mesh = { inner", "body[0].mesh.generator"),
    dynamic(BALL, "mesh = \"a.msh\"", "a.msh", "body[0].mesh"),
    dynamic(BALL, "mesh = { file = \"a.stl\" }", "a.stl", "body[0].mesh.file"),
    dynamic(BALL, "mesh = { file = \"a.msh\", group = 3 }", "3 }", "body[0].mesh.group"),
    dynamic(BALL, "mesh = { file = \"a.msh\", scale = 0 }", "0 }", "body[0].mesh.scale"),
    dynamic(BALL, "mesh = { file = \"a.msh\", scale = \"mm\" }", "\"mm\"", "body[0].mesh.scale"),
    dynamic(BALL, "mesh = { file = \"a.msh\", groups = \"b\" }", "groups", "body[0].mesh.groups"),
    dynamic(BALL, "", "[[body]]", "body[0].mesh"),
    dynamic("inner_diameter = 0.8", "inner_diameter = 1.8", "1.8", "body[0].mesh.inner_diameter"),
    dynamic("outer_diameter = 1.0", "outer_diameter = -1.0", "-1.0, div", "body[0].mesh.outer_diameter"),
    dynamic("divisions = [6, 2]", "divisions = [0, 2]", "[0, 2]", "body[0].mesh.divisions[0]"),
    dynamic("divisions = [6, 2]", "divisions = [6, 2.5]", "2.5]", "body[0].mesh.divisions[1]"),
    dynamic("divisions = [6, 2]", "divisions = [60000, 2]", "60000", "body[0].mesh.divisions"),
    dynamic("divisions = [6, 2]", "divisions = [6, 2, 2]", "6, 2, 2", "body[0].mesh.divisions"),
    dynamic("divisions = [6, 2]", "divisions = [6, 2], layers = 2", "layers", "body[0].mesh.layers"),
    quasi(BLOCK, "size = [1, 0, 1], divisions = [1, 1, 1]", "size", "body[0].mesh.size[1]"),
    quasi(BLOCK, "min = [0, 0, 0], divisions = [1, 1, 1]", "min", "body[0].mesh.max"),
    quasi(BLOCK, "max = [0, 0, 0], divisions = [1, 1, 1]", "max", "body[0].mesh.min"),
    quasi(BLOCK, "divisions = [1, 1, 1]", "generator", "body[0].mesh.size"),
    quasi("max = [1, 1, 1]", "max = [1, 0, 1]", "max", "body[0].mesh.max"),
    quasi("max = [1, 1, 1]", "max = [1, 1, 1], size = [1, 1, 1]", "max", "body[0].mesh.size"),
    quasi("grading = [1, 1, 2]", "grading = [1, -1, 2]", "grading", "body[0].mesh.grading[1]"),
    quasi("divisions = [4, 4, 4]", "divisions = [4, 4, 1]", "grading", "body[0].mesh.grading"),
    quasi("tube_inner_radius = 7.5", "tube_inner_radius = 12.5", "12.5", "body[1].mesh.tube_inner_radius"),
    quasi("ring_radius = 38", "ring_radius = 10", "ring_radius = 10", "body[1].mesh.tube_outer_radius"),
    quasi("divisions = [8, 4, 1]", "divisions = [8, 2, 1]", "8, 2, 1", "body[1].mesh.divisions"),
    quasi("radius = 2,", "radius = 1,", "radius = 1,", "body[2].mesh.radius"),
    quasi("height = 1.5", "height = 0.5", "height = 0.5", "body[2].mesh.height"),
    quasi("length = [4, 3]", "length = [4, 1]", "length = [4, 1]", "body[3].mesh.length"),
    quasi(", [0, 1, 1]]", "]", "corners", "body[4].mesh.corners"),
    quasi("part = \"quarter\"", "part = \"third\"", "third", "body[5].mesh.part"),
    quasi("radius = 1, part", "radius = -1, part", "quarter", "body[5].mesh.radius"),
    quasi("half_width = 0.1", "half_width = 0.8", "0.8", "body[5].mesh.refinement.half_width"),
    quasi("half_width = 0.1", "half_width = 0.0", "quarter", "body[5].mesh.refinement.half_width"),
    quasi("half_width = 0.1", "width = 1, half_width = 0.1", "quarter", "body[5].mesh.refinement.width"),
    quasi(", elements = 4 }", " }", "quarter", "body[5].mesh.refinement.elements"),
    quasi(", elements = 4 }", ", elements = 8 }", "quarter", "body[5].mesh.refinement.elements"),
    quasi("divisions = [8, 3, 6]", "divisions = [8, 0, 6]", "quarter", "body[5].mesh.divisions[1]"),
    quasi("divisions = [8, 3, 6]", "divisions = [8000, 8000, 6]", "quarter", "body[5].mesh.divisions"),
    quasi("length = 0.5", "length = 0", "cylinder", "body[6].mesh.length"),
    quasi("length = 0.5", "length = 0.5, part = \"eighth\"", "cylinder", "body[6].mesh.part"),
    quasi("length = 0.5", "length = 0.5, refinement = 3", "cylinder", "body[6].mesh.refinement"),
    // materials
    dynamic("law = \"ogden\"", "law = \"hooke\"", "hooke", "body[0].material.law"),
    dynamic("law = \"ogden\", ", "", "mu = [", "body[0].material.law"),
    dynamic("kappa = 2000.0", "kappa = -2000.0", "kappa", "body[0].material.kappa"),
    dynamic("kappa = 2000.0", "kapa = 1, kappa = 2000.0", "kapa", "body[0].material.kapa"),
    dynamic("beta = 9.0", "beta = 0", "beta", "body[0].material.beta"),
    dynamic("alpha = [1.3, 5.0, -2.0]", "alpha = [1.3, 5.0]", "alpha", "body[0].material.alpha"),
    dynamic("alpha = [1.3, 5.0, -2.0]", "alpha = [1.3, 0, -2.0]", "alpha", "body[0].material.alpha[1]"),
    dynamic("mu = [6300.0, 12.0, -100.0]", "mu = [-6300.0, 12.0, -100.0]", "-6300", "body[0].material.mu"),
    dynamic("mu = [6300.0, 12.0, -100.0]", "mu = []", "mu = []", "body[0].material.mu"),
    dynamic("young = 2250, poisson = 0.3", "young = 2250", "young", "body[1].material.poisson"),
    dynamic("young = 2250, poisson = 0.3", "mu = 3.0", "mu = 3.0", "body[1].material.lambda"),
    dynamic("young = 2250, poisson = 0.3", "young = 1, mu = 1", "young", "body[1].material.mu"),
    dynamic("young = 2250, poisson = 0.3", "lambda = -7, mu = 1", "lambda", "body[1].material.lambda"),
    dynamic("poisson = 0.3", "poisson = 0.5", "poisson", "body[1].material.poisson"),
    dynamic("young = 2250", "young = -2250", "young", "body[1].material.young"),
    dynamic("young = 2250, poisson = 0.3", "", "neo-hooke", "body[1].material.young"),
    quasi("c1 = 176051.0", "c1 = -176051.0", "c1", "body[0].material.c1"),
    quasi("c = 2.0e6", "c = -2.0e6", "c1", "body[0].material.c"),
    quasi("c = 2.0e6", "d = 2.0e6, c = 2.0e6", "c1", "body[0].material.d"),
    // [[set]]
    dynamic("name = \"plate.rim\"", "name = \"rim\"", "\"rim\"", "set[0].name"),
    dynamic("name = \"plate.rim\"", "name = \"ball.rim\"", "ball.rim", "set[0].name"),
    dynamic("name = \"plate.middle\"", "name = \"plate.rim\"\n#second", "plate.rim\"\n#second", "set[1].name"),
    dynamic("body = \"plate\"\nbox", "body = \"plat\"\nbox", "\"plat\"", "set[0].body"),
    dynamic(MIDDLE, "", "[[set]]\nname = \"plate.middle", "set[1].box"),
    dynamic(MIDDLE, "box = { min = [0, 0, 0], max = [0, 0, -1] }", "[0, 0, -1]", "set[1].box.max"),
    dynamic("normal = [1, 0, 0]", "normal = [0, 0, 0]", "normal", "set[1].plane.normal"),
    dynamic("tolerance = 1e-3", "tolerance = -1e-3", "normal", "set[1].plane.tolerance"),
    dynamic("plane = {", "box = { min = [0, 0, 0], max = [1, 1, 1] }\nplane = {", "plane = {", "set[1].plane"),
    // [[contact]]
    dynamic("method = \"nts\"", "method = \"penalty\"", "penalty", "contact[0].method"),
    dynamic("method = \"nts\"", "method = \"cat\"\nreduction = \"third\"", "third", "contact[0].reduction"),
    dynamic("method = \"nts\"", "method = \"nts\"\nreduction = \"first\"", "reduction", "contact[0].reduction"),
    dynamic("method = \"nts\"", "method = \"cat\"\ndrop_gap_term = 1", "drop_gap_term", "contact[0].drop_gap_term"),
    dynamic("master = \"plate.top\"", "master = \"ball.inner\"", "ball.inner", "contact[0].master"),
    dynamic("master = \"plate.top\"", "master = \"plte.top\"", "plte.top", "contact[0].master"),
    dynamic("slave = \"ball.outer\"", "slave = \"outer\"", "slave = \"outer\"", "contact[0].slave"),
    dynamic("slave = \"ball.outer\"\n", "", "[[contact]]", "contact[0].slave"),
    dynamic("slave = \"ball.outer\"", "between = [\"ball.outer\", \"plate.top\"]", "master", "contact[0].master"),
    dynamic(
        "slave = \"ball.outer\"\nmaster = \"plate.top\"",
        "between = [\"ball.outer\"]",
        "[\"ball.outer\"]",
        "contact[0].between",
    ),
    dynamic("constraint = \"modified\"", "closing = \"restore\"", "closing", "contact[0].closing"),
    dynamic("constraint = \"modified\"", "gap = \"close\"\nsettle = 7", "settle", "contact[0].settle"),
    dynamic("constraint = \"modified\"", "constraint = \"one-sided\"", "one-sided", "contact[0].constraint"),
    dynamic("constraint = \"modified\"", "constraint = \"soft\"", "soft", "contact[0].constraint"),
    dynamic("constraint = \"modified\"", "enforcement = 1e5", "enforcement", "contact[0].enforcement"),
    dynamic("constraint = \"modified\"", "enforcement = \"penalty\"", "enforcement", "contact[0].enforcement"),
    dynamic("constraint = \"modified\"", "enforcement = \"multiplyer\"", "enforcement", "contact[0].enforcement"),
    dynamic("constraint = \"modified\"", "enforcement = {}", "enforcement", "contact[0].enforcement.penalty"),
    dynamic(
        "constraint = \"modified\"",
        "enforcement = { penalty = 0 }",
        "enforcement",
        "contact[0].enforcement.penalty",
    ),
    dynamic(
        "constraint = \"modified\"",
        "enforcement = { penalty = 1, augmented = 1 }",
        "enforcement",
        "contact[0].enforcement.augmented",
    ),
    dynamic(
        "constraint = \"modified\"",
        "constraint = \"modified\"\nenforcement = { penalty = 1 }",
        "enforcement",
        "contact[0].enforcement",
    ),
    dynamic(
        "method = \"nts\"",
        "method = \"cat\"\nenforcement = { penalty = 1 }",
        "enforcement",
        "contact[0].enforcement",
    ),
    dynamic("constraint = \"modified\"", "multipliers = \"dual\"", "dual", "contact[0].multipliers"),
    dynamic("constraint = \"modified\"", "smoothing = 0.1", "smoothing", "contact[0].smoothing"),
    dynamic("constraint = \"modified\"", "normals = \"facet\"", "facet", "contact[0].normals"),
    dynamic("constraint = \"modified\"", "integrals = \"frozen\"", "frozen", "contact[0].integrals"),
    dynamic("constraint = \"modified\"", "nearness = 12", "nearness", "contact[0].nearness"),
    mortar("constraint = \"modified\"", "smoothing = 0.1", "smoothing", "contact[0].smoothing"),
    mortar("constraint = \"modified\"", "multipliers = \"single\"", "single", "contact[0].multipliers"),
    mortar("constraint = \"modified\"", "quadrature = 7", "quadrature", "contact[0].quadrature"),
    mortar("constraint = \"modified\"", "normals = \"none\"", "none", "contact[0].normals"),
    mortar("constraint = \"modified\"", "integrals = \"held\"", "held", "contact[0].integrals"),
    mortar(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = 0.3, slip = \"yang\" }",
        "friction",
        "contact[0].friction.slip",
    ),
    mortar("constraint = \"modified\"", "constraint = \"modified\"", "modified", "contact[0].constraint"),
    mortar(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = 0.3, stick = \"augmented\" }",
        "friction",
        "contact[0].friction.stick",
    ),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = 0.3, slip = \"direct\" }",
        "slip",
        "contact[0].friction.slip",
    ),
    dynamic("constraint = \"modified\"", "friction = 0.3", "friction", "contact[0].friction"),
    dynamic(
        "method = \"nts\"",
        "method = \"cat\"
drop_gap_slope = true",
        "drop_gap_slope",
        "contact[0].drop_gap_slope",
    ),
    dynamic("constraint = \"modified\"", "friction = { mu = 0.3 }", "friction", "contact[0].friction.law"),
    dynamic("constraint = \"modified\"", "friction = { law = \"coulom\" }", "friction", "contact[0].friction.law"),
    dynamic("constraint = \"modified\"", "friction = { law = \"coulomb\" }", "friction", "contact[0].friction.mu"),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = -0.3 }",
        "friction",
        "contact[0].friction.mu",
    ),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = 0.3, penalty = 0 }",
        "friction",
        "contact[0].friction.penalty",
    ),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = 0.3, stick = \"multiplier\", penalty = 1e4 }",
        "friction",
        "contact[0].friction.penalty",
    ),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = 0.3, midpoint = \"b\" }",
        "friction",
        "contact[0].friction.midpoint",
    ),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = 0.3, stick = \"glue\" }",
        "friction",
        "contact[0].friction.stick",
    ),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"coulomb\", mu = 0.3, speed = 1 }",
        "friction",
        "contact[0].friction.speed",
    ),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"static-dynamic\", mu_static = 0.1, mu_dynamic = 0.2, speed = 1 }",
        "friction",
        "contact[0].friction.mu_static",
    ),
    dynamic(
        "constraint = \"modified\"",
        "friction = { law = \"regularised\", mu = 0.1, speed = 0 }",
        "friction",
        "contact[0].friction.speed",
    ),
    dynamic(
        "constraint = \"modified\"",
        "constraint = \"modified\"\nfriction = { law = \"coulomb\", mu = 0.1 }",
        "friction",
        "contact[0].friction",
    ),
    dynamic("[[contact]]", "[contact]", "[contact]", "contact"),
    quasi(
        "[[prescribe]]\nset = \"block.bottom\"",
        "[[contact]]\nmethod = \"nts\"\nslave = \"tool.bottom\"\nmaster = \"block.top\"\nconstraint = \"modified\"\n[[prescribe]]\nset = \"block.bottom\"",
        "modified",
        "contact[0].constraint",
    ),
    // [[prescribe]] and tables
    dynamic(TABLE, "{ table = [] }", "table = []", "prescribe[0].displacement.table"),
    dynamic(TABLE, "{ values = [[0, 0, 0]], table = [[0, 0, 0]] }", "values", "prescribe[0].displacement.values"),
    dynamic(TABLE, "{ table = [[0.0, 0.0, 0.0], [1.0, 0.1]] }", "[1.0, 0.1]", "prescribe[0].displacement.table[1]"),
    dynamic(TABLE, "{ table = [[1, 0, 0], [0, 0, 0]] }", "[[1, 0, 0]", "prescribe[0].displacement.table[1]"),
    dynamic(TABLE, "{ table = [[0, 0, 0], [0, 1, 0]] }", "[0, 1, 0]", "prescribe[0].displacement.table[1]"),
    dynamic(TABLE, "{ table = [[0, 0, nan]] }", "nan", "prescribe[0].displacement.table[0][2]"),
    dynamic(TABLE, "[0.1]", "[0.1]", "prescribe[0].displacement"),
    dynamic(TABLE, "0.1", "displacement = 0.1", "prescribe[0].displacement"),
    dynamic(TABLE, "\"fixed\"", "\"fixed\"", "prescribe[0].displacement"),
    dynamic(
        "displacement = { table = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0]] }\n",
        "",
        "[[prescribe]]",
        "prescribe[0].displacement",
    ),
    dynamic("fixed = true", "fixed = true\ndisplacement = 0.1", "fixed", "prescribe[1].fixed"),
    dynamic("fixed = true", "fixed = 1", "fixed = 1", "prescribe[1].fixed"),
    dynamic("[\"x\", \"z\"]", "[\"x\", \"w\"]", "\"w\"", "prescribe[0].components[1]"),
    dynamic("[\"y\"]", "[]", "components = []", "prescribe[1].components"),
    dynamic("[\"y\"]", "[\"y\", \"y\"]", "\"y\", \"y\"", "prescribe[1].components"),
    dynamic("[\"y\"]", "[\"z\"]", "[\"z\"]", "prescribe[1].components"),
    dynamic("fixed = true", "fixed = true\nramp_until = 0", "ramp_until = 0", "prescribe[1].ramp_until"),
    dynamic("fixed = true", "fixed = true\nramp_until = nan", "ramp_until = nan", "prescribe[1].ramp_until"),
    dynamic(
        "components = [\"y\"]",
        "normal = [1, 1, 0]\nramp_until = 1.0",
        "ramp_until = 1.0",
        "prescribe[1].ramp_until",
    ),
    quasi("translation = [0, 0, -0.1]", "ramp_until = 1.0", "ramp_until = 1.0", "prescribe[2].ramp_until"),
    // rotations
    turn("axis = [0, 0, 1]", "axis = [0, 0, 0]", "prescribe[2].rotation.axis"),
    turn("axis = [0, 0, 1], ", "", "prescribe[2].rotation.axis"),
    turn("axis = [0, 0, 1]", "axis = \"z\"", "prescribe[2].rotation.axis"),
    turn("about = [0, 0, 2]", "about = [0, nan, 2]", "prescribe[2].rotation.about[1]"),
    turn("about = [0, 0, 2]", "point = [0, 0, 2]", "prescribe[2].rotation.point"),
    turn(", degrees = { table = [[0.0, 0.0], [1.0, 720.0]] }", "", "prescribe[2].rotation.degrees"),
    turn("{ table = [[0.0, 0.0], [1.0, 720.0]] }", "[0, 90]", "prescribe[2].rotation.degrees"),
    turn("[1.0, 720.0]", "[1.0, 720.0, 1.0]", "prescribe[2].rotation.degrees.table[1]"),
    quasi(TURN, "rotation = 90", "rotation = 90", "prescribe[2].rotation"),
    quasi(TURN, "components = [\"x\"]\nfixed = true", "translation", "prescribe[2].translation"),
    quasi("translation = [0, 0, -0.1]", "translation = -0.1", "translation", "prescribe[2].translation"),
    quasi(
        "translation = [0, 0, -0.1]",
        "components = [\"z\"]",
        "components = [\"z\"]\n\n[[load",
        "prescribe[2].components",
    ),
    quasi("translation = [0, 0, -0.1]", "displacement = [0, 0, 1]", "displacement = [0", "prescribe[2].displacement"),
    quasi("translation = [0, 0, -0.1]", "fixed = true", "fixed = true\n\n[[load", "prescribe[2].fixed"),
    // [[load]]
    dynamic("pressure = { table = [[0.0, 0.0], [1.0, 100.0]] }", "", "[[load]]", "load[0].pressure"),
    dynamic(
        "pressure = { table = [[0.0, 0.0], [1.0, 100.0]] }",
        "pressure = 1\nforce = [0, 0, 1]",
        "force = ",
        "load[0].force",
    ),
    dynamic("set = \"plate.bottom\"\n", "", "[[load]]", "load[0].set"),
    dynamic("set = \"plate.bottom\"\n", "body = \"plate\"\n", "\"plate\"\npressure", "load[0].body"),
    dynamic("body_force = [0, 0, -98.1]", "body_force = -98.1", "-98.1", "load[1].body_force"),
    dynamic(
        "body = \"ball\"\nbody_force",
        "set = \"ball.all\"\nbody = \"ball\"\nbody_force",
        "body = \"ball\"",
        "load[1].body",
    ),
    quasi(
        "follower_pressure = 2.5",
        "follower_pressure = true",
        "true\n\n[[load]]\nset = \"block.front\"",
        "load[1].follower_pressure",
    ),
    quasi("follower_pressure = 2.5", "follower_pressure = 2.5\nfolow = 1", "folow", "load[1].folow"),
    // [[probe]]
    dynamic("quantity = \"displacement\"", "quantity = \"displacment\"", "displacment", "probe[0].quantity"),
    dynamic("name = \"corner\"", "name = \"tip\"\n#second", "tip\"\n#second", "probe[1].name"),
    dynamic("body = \"plate\"\npoint", "point", "[[probe]]\nname = \"corner", "probe[1].body"),
    dynamic("point = [1.25, 1.25, 0.25]", "point = [1.25, 1.25]", "point = [1.25", "probe[1].point"),
    dynamic("point = [1.25, 1.25, 0.25]", "", "[[probe]]\nname = \"corner", "probe[1].point"),
    dynamic(
        "quantity = \"energy\"",
        "set = \"ball.outer\"\nquantity = \"energy\"",
        "set = \"ball.outer\"\nquantity = \"energy",
        "probe[2].set",
    ),
    quasi("quantity = \"reaction\"", "quantity = \"velocity\"", "velocity", "probe[0].quantity"),
    quasi("quantity = \"reaction\"", "quantity = \"contact_force\"", "contact_force", "probe[0].quantity"),
    // [output]
    dynamic("every = 2", "every = 0", "every = 0", "output.every"),
    dynamic("every = 2", "every = -1", "every = -1", "output.every"),
    dynamic("\"von_mises\"", "\"mises\"", "\"mises\"", "output.fields[1]"),
    dynamic("\"von_mises\"", "\"displacement\"", "fields", "output.fields"),
    dynamic("\"von_mises\"", "\"strain\"", "\"strain\"", "output.fields[1]"),
    dynamic("every = 2", "interval = 0", "interval", "output.interval"),
    dynamic("every = 2", "times = []", "times", "output.times"),
    dynamic("every = 2", "times = [0.1, 1.5]", "times", "output.times[1]"),
    dynamic("every = 2", "every = 2\nformat = \"vtk\"", "\"vtk\"", "output.format"),
    dynamic("every = 2", "last_only = 1", "last_only", "output.last_only"),
    dynamic("every = 2", "every = 2\ntimes = [0.1]", "times", "output.times"),
    dynamic("every = 2", "interval = 0.1\nlast_only = true", "last_only", "output.last_only"),
    // [expect]
    dynamic("outcome = \"completed\"", "outcome = \"fine\"", "fine", "expect.outcome"),
    dynamic("linear_momentum_drift = 1e-10", "linear_momentum_drift = 0", "_drift", "expect.linear_momentum_drift"),
    dynamic("max_cuts = 0\nlinear", "max_cuts = \"none\"\nlinear", "none", "expect.max_cuts"),
    dynamic("from = 0.02", "from = 0.2", "from = 0.2", "expect.first_contact.to"),
    dynamic("name = \"tip\"\ntime", "name = \"tpi\"\ntime", "tpi", "expect.probe[0].name"),
    dynamic("time = 0.5", "time = 1.5", "time = 1.5", "expect.probe[0].time"),
    dynamic("component = \"z\"\n", "", "[[expect.probe]]", "expect.probe[0].component"),
    dynamic("tolerance = 0.5", "tolerance = 0", "tolerance = 0\n", "expect.probe[0].tolerance"),
    // expressions over sets
    quasi("\"block.bottom\"", "\"block.bottom & x >\"", "x >", "prescribe[0].set"),
    quasi("\"block.bottom\"", "\"block.bottom & ring.all\"", "ring.all", "prescribe[0].set"),
    quasi("\"block.bottom\"", "\"blok.all & x > 0\"", "blok", "prescribe[0].set"),
    quasi("\"block.bottom\"", "\"x > 0\"", "x > 0", "prescribe[0].set"),
    quasi("[time]", "[sets]\nx = \"block.top\"\n[time]", "x = ", "sets.x"),
    quasi("[time]", "[sets]\nleft = \"block.top & w > 0\"\n[time]", "w > 0", "sets.left"),
    quasi("[time]", "[sets]\nleft = 1\n[time]", "left", "sets.left"),
    quasi("max_newton_mean = 6", "energy_drift = 1e-9", "energy_drift", "expect.energy_drift"),
    quasi("max_newton_mean = 6", "contact_at_end = false", "contact_at_end", "expect.contact_at_end"),
    quasi("severity = \"note\"", "severity = \"remark\"", "remark", "left_out[1].severity"),
    quasi("severity = \"missing\"\n", "", "[[left_out]]", "left_out[0].severity"),
    quasi("keyword = \"*CONTROLS\"\n", "", "[[left_out]]\nseverity = \"note\"", "left_out[1].keyword"),
    quasi("line = \"part.inp:12\"", "line = 12", "line = 12", "left_out[0].line"),
    quasi("text = \"Stoss has tolerances of its own\"", "text = \" \"", "text = \" \"", "left_out[1].text"),
    quasi("text = \"Stoss has tolerances of its own\"", "text = \"x\"\nplace = \"a\"", "place = ", "left_out[1].place"),
];

#[test]
fn every_mistake_is_reported_once_at_its_place() {
    let mut failures = Vec::new();
    for case in CASES.iter().chain(multibody::CASES).chain(inelastic::CASES) {
        assert_eq!(case.base.matches(case.from).count().min(1), 1, "the base scene has no {:?}", case.from);
        let base = if case.mortar { case.base.replacen("\"nts\"", "\"mortar\"", 1) } else { case.base.to_owned() };
        let text = base.replacen(case.from, case.to, 1);
        let label = format!("{:?} -> {:?}", case.from, case.to);
        let Some(place) = text.find(case.at) else { panic!("{label}: no {:?}", case.at) };
        let line = 1 + text[..place].matches('\n').count();
        let Err(errors) = parse(&text, "x.toml") else {
            failures.push(format!("{label}: accepted"));
            continue;
        };
        for problem in errors.problems() {
            assert!(!problem.message.is_empty() && !problem.remedy.is_empty(), "{label}: {problem}");
            let start = text.get(problem.span.clone()).map(|_| problem.span.start);
            let start = start.unwrap_or_else(|| panic!("{label}: span of {problem}"));
            assert_eq!(problem.line, 1 + text[..start].matches('\n').count(), "{label}: {problem}");
        }
        let first = &errors.problems()[0];
        let syntax = case.key.is_empty();
        if first.line != line || first.key != case.key || (!syntax && errors.problems().len() != 1) {
            failures.push(format!("{label}: expected line {line}, {}; got\n{errors}", case.key));
        }
    }
    assert!(
        failures.is_empty(),
        "{} of {}:\n{}",
        failures.len(),
        CASES.len() + multibody::CASES.len() + inelastic::CASES.len(),
        failures.join("\n")
    );
}

#[test]
fn all_problems_are_reported_at_once_in_the_order_of_the_file() {
    let text = DYNAMIC
        .replace("step = 0.01", "step = -1")
        .replace("density = 10.0", "density = nan")
        .replace("kappa = 2000.0", "kapa = 2000.0")
        .replace("master = \"plate.top\"", "master = \"table.top\"")
        .replace("quantity = \"energy\"", "quantity = \"heat\"")
        .replace("tolerance = 0.5", "");
    let errors = parse(&text, "x.toml").unwrap_err();
    let keys: Vec<&str> = errors.problems().iter().map(|problem| problem.key.as_str()).collect();
    assert_eq!(
        keys,
        [
            "time.step",
            // not also that `kappa` is missing
            "body[0].material.kapa",
            "body[0].density",
            "contact[0].master",
            "probe[2].quantity",
            "expect.probe[0].tolerance",
        ]
    );
    let printed = errors.to_string();
    assert_eq!(printed.lines().count(), keys.len());
    assert!(printed.lines().all(|line| line.starts_with("x.toml:")));
}

/// The key that is meant is not reported as missing too, and what has no name because of it is not reported as unknown.
#[test]
fn a_misspelt_key_is_one_problem() {
    for (from, to, key) in [
        ("density = 10.0", "desnity = 10.0", "body[0].desnity"),
        ("poisson = 0.3", "poison = 0.3", "body[1].material.poison"),
        ("master = \"plate.top\"", "mastre = \"plate.top\"", "contact[0].mastre"),
        ("step = 0.01", "setp = 0.01", "time.setp"),
    ] {
        let errors = parse(&DYNAMIC.replacen(from, to, 1), "x.toml").unwrap_err();
        let [problem] = errors.problems() else { panic!("{to}: {errors}") };
        assert!(problem.key == key && problem.message.contains("unknown key"), "{errors}");
    }
    let stages = "[[stage]]\nname = \"one\"\nkind = \"quasi-static\"\nuntil = 1.0\noff = [\"hold\", \"push\"]\n";
    let body = "[[body]]\nname = \"block\"\nmesh = { generator = \"block\", size = [1, 1, 1], divisions = [1, 1, 1] }\nmaterial = { law = \"neo-hooke\", young = 1, poisson = 0.3 }\n";
    let text = |prescribe: &str, load: &str| {
        format!(
            "[scene]\ntitle = \"t\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n{body}{stages}\
             [[prescribe]]\n{prescribe} = \"hold\"\nset = \"block.left\"\ncomponents = [\"x\"]\nfixed = true\n\
             [[load]]\n{load} = \"push\"\nset = \"block.right\"\npressure = 1.0\n"
        )
    };
    parse(&text("name", "name"), "x.toml").unwrap_or_else(|errors| panic!("{errors}"));
    for (prescribe, load, key) in [("nmae", "name", "prescribe[0].nmae"), ("name", "nmae", "load[0].nmae")] {
        let errors = parse(&text(prescribe, load), "x.toml").unwrap_err();
        let keys: Vec<&str> = errors.problems().iter().map(|problem| problem.key.as_str()).collect();
        assert_eq!(keys, [key], "{errors}");
    }
}

#[test]
fn missing_parts_of_an_empty_scene() {
    for text in ["", "# nothing\n"] {
        let errors = parse(text, "empty.toml").unwrap_err();
        let keys: Vec<&str> = errors.problems().iter().map(|problem| problem.key.as_str()).collect();
        assert_eq!(keys, ["body", "scene", "time"], "{errors}");
        assert!(errors.problems().iter().all(|problem| problem.line == 1));
    }
}

#[test]
fn one_part_of_any_kind_is_a_scene() {
    let head = "[scene]\ntitle = \"x\"\nkind = \"quasi-static\"\n[time]\nend = 1\nstep = 1\n";
    for part in [
        "[[rigid]]\nname = \"a\"",
        "[[beam]]\nname = \"a\"\npoints = [[0, 0, 0], [1, 0, 0]]\nelements = 1\nyoung = 1\nsection = { shape = \"circle\", radius = 1 }",
        "[[string]]\nname = \"a\"\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nelements = 1\naxial = 1",
        "[[mass]]\nname = \"a\"\nat = [0, 0, 0]\nmass = 1",
    ] {
        let scene = parse(&format!("{head}{part}\n"), "x.toml").unwrap_or_else(|errors| panic!("{errors}"));
        assert!(scene.part("a").is_some() && scene.bodies.is_empty());
    }
}

#[test]
fn a_key_with_two_mistakes_is_reported_once() {
    for (base, from, to, key) in [
        (DYNAMIC, "constraint = \"modified\"", "constraint = \"modified\"\nrestitution = 2", "contact[0].restitution"),
        (DYNAMIC, "slave = \"ball.outer\"", "between = [\"ball.outer\", \"plate.top\"]\nslave = 1", "contact[0].slave"),
        // A key of friction is no key of a contact, whatever the method.
        (DYNAMIC, "constraint = \"modified\"", "slip = \"direct\"", "contact[0].slip"),
    ] {
        assert!(base.contains(from), "{from}");
        let errors = parse(&base.replacen(from, to, 1), "x.toml").unwrap_err();
        let found = errors.problems().iter().filter(|problem| problem.key == key).count();
        assert_eq!(found, 1, "{to}: {errors}");
    }
    let slip = parse(&DYNAMIC.replacen("constraint = \"modified\"", "slip = \"direct\"", 1), "x.toml").unwrap_err();
    assert_eq!(slip.problems()[0].message, "is an unknown key");
}
