//! Equations between displacements, and nodes coupled to rigid bodies, against closed forms.
use std::f64::consts::PI;
use std::path::Path;
use stoss::build::Built;

const MATERIAL: &str = "material = { law = \"neo-hooke\", young = 260.0, poisson = 0.3 }";
/// Shear modulus of [`MATERIAL`].
const SHEAR: f64 = 100.0;
const STATIC: &str = "[scene]\ntitle = \"t\"\nkind = \"quasi-static\"\n[solver]\nrelative_tolerance = 1e-12\n[time]\nend = 1.0\nstep = 0.25\n";

fn build(scene: &str) -> Result<Built, String> {
    let scene = stoss::scene::parse(scene, "scene.toml").map_err(|error| error.to_string())?;
    stoss::build::build(&scene, Path::new(".")).map_err(|error| error.to_string())
}

fn run(scene: &str) -> Built {
    let mut built = build(scene).unwrap_or_else(|error| panic!("{error}\n{scene}"));
    while !built.simulation.finished() {
        built.simulation.advance().unwrap_or_else(|error| panic!("{error}\n{scene}"));
    }
    built
}

fn probe(built: &Built, name: &str) -> [f64; 3] {
    built.probes.iter().find(|probe| probe.name == name).unwrap().value(&built.simulation)
}

/// Equations between opposite faces of a cell; `shear` is the difference of the displacements along x of top and bottom.
fn periodic(shear: &str) -> String {
    let mut text = String::new();
    for (a, b) in [("right", "left"), ("back", "front"), ("top", "bottom")] {
        for component in ["x", "y", "z"] {
            let value = if (a, component) == ("top", "x") { shear } else { "0.0" };
            text += &format!(
                "[[equation]]\nname = \"{a}-{component}\"\nvalue = {value}\nterms = [{{ set = \"cell.{a}\", component = \"{component}\" }}, {{ set = \"cell.{b}\", component = \"{component}\", factor = -1.0 }}]\n"
            );
        }
    }
    text
}

fn cell(shear: &str) -> String {
    format!(
        "{STATIC}[[body]]\nname = \"cell\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1.2, 0.8, 0.5], divisions = [3, 2, 2] }}\n{MATERIAL}\n\
         [[set]]\nname = \"cell.corner\"\nbody = \"cell\"\nbox = {{ min = [-0.1, -0.1, -0.1], max = [0.1, 0.1, 0.1] }}\n\
         [[prescribe]]\nset = \"cell.corner\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n{}\
         [[probe]]\nname = \"force\"\nquantity = \"equation_force\"\nequation = \"top-x\"\n",
        periodic(shear)
    )
}

/// A homogeneous cell under periodic conditions, many of which follow from others, is sheared uniformly: `P_xz = mu gamma` of neo-Hooke, and the work of the equations is the energy.
#[test]
fn periodic_cell_under_shear() {
    let built = run(&cell("{ table = [[0.0, 0.0], [1.0, 0.2]] }"));
    let simulation = &built.simulation;
    let gamma = 0.2 / 0.5;
    for (x, q) in simulation.model().reference.chunks_exact(3).zip(simulation.state().q.chunks_exact(3)) {
        let off = [q[0] - x[0] - gamma * x[2], q[1] - x[1], q[2] - x[2]];
        assert!(off.iter().all(|off| off.abs() < 1e-11), "{x:?}: {off:?}");
    }
    let [force, ..] = probe(&built, "force");
    assert!((force / (SHEAR * gamma * 1.2 * 0.8) - 1.0).abs() < 1e-9, "{force}");
    let balance = simulation.balance();
    let energy = 0.5 * SHEAR * gamma * gamma * 1.2 * 0.8 * 0.5;
    assert!(
        (balance.strain / energy - 1.0).abs() < 1e-10 && (balance.external_work / energy - 1.0).abs() < 1e-8,
        "{balance:?}"
    );
    assert!(
        built.warnings.iter().any(|w| w.contains("equation right-x") || w.contains("follow")),
        "{:?}",
        built.warnings
    );
}

#[test]
fn contradicting_equations_are_named() {
    let other = "[[equation]]\nname = \"other\"\nvalue = 0.1\nterms = [{ body = \"cell\", point = [0, 0, 0.5], component = \"y\", factor = 2.0 }, { set = \"cell.corner\", direction = [0, -3, 0], factor = 2.0 }]\n";
    let error = build(&format!("{}{other}", cell("0.0"))).unwrap_err();
    assert!(error.contains("equation[9]") && error.contains("contradicts the others"), "{error}");
    let unequal = "[[equation]]\nname = \"other\"\nterms = [{ set = \"cell.top\", component = \"y\" }, { set = \"cell.left\", component = \"y\" }]\n";
    let error = build(&format!("{}{unequal}", cell("0.0"))).unwrap_err();
    assert!(error.contains("equation[9].terms[1].set"), "{error}");
}

/// The mean displacement of a face as one term, a point of a rigid body as another.
#[test]
fn mean_of_a_face_and_a_point_of_a_rigid_body() {
    let built = run(&format!(
        "{STATIC}[[body]]\nname = \"bar\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [4, 1, 1], divisions = [4, 2, 2] }}\n\
         material = {{ law = \"saint-venant-kirchhoff\", young = 100.0, poisson = 0.0 }}\n\
         [[mass]]\nname = \"node\"\nat = [9, 0, 0]\nmass = 0.0\n\
         [[prescribe]]\nset = \"bar.left\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
         [[prescribe]]\nset = \"node.all\"\ncomponents = [\"y\", \"z\"]\nfixed = true\n\
         [[load]]\nset = \"node.all\"\nforce = {{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.001, 0.0, 0.0]] }}\n\
         [[equation]]\nname = \"pull\"\nterms = [{{ set = \"bar.right\", component = \"x\", mean = true }}, {{ set = \"node.all\", component = \"x\", factor = -0.5 }}]\n\
         [[probe]]\nname = \"u\"\nquantity = \"displacement\"\nset = \"bar.right\"\n\
         [[probe]]\nname = \"f\"\nquantity = \"equation_force\"\nequation = \"pull\"\n"
    ));
    // The force on the node is 0.5 of the multiplier, whose force on the face is uniform: P = 0.002 = S (1 + e), S = E (e + e^2/2).
    let (mut e, force) = (0.0_f64, 0.002);
    for _ in 0..50 {
        e = force / 100.0 / ((1.0 + 0.5 * e) * (1.0 + e));
    }
    let [u, ..] = probe(&built, "u");
    assert!((u / (4.0 * e) - 1.0).abs() < 1e-9, "{u} {}", 4.0 * e);
    let [f, ..] = probe(&built, "f");
    assert!((f - force).abs() < 1e-12, "{f}");
}

/// A hollow ball whose outside is fixed and whose inside is turned by a moment: `phi = M / (8 pi mu) (1/a^3 - 1/b^3)`. The tractions of the solution are those of a distributing coupling.
#[test]
fn moment_on_the_hole_of_a_ball() {
    let scene = |kind: &str| {
        format!(
            "{STATIC}[[body]]\nname = \"ball\"\ncell = \"quadratic\"\nmesh = {{ generator = \"hollow-ball\", inner_diameter = 1.0, outer_diameter = 2.0, divisions = [3, 3] }}\n{MATERIAL}\n\
             [[rigid]]\nname = \"hub\"\nposition = [0.3, 0.1, -0.2]\n[[coupling]]\nname = \"grip\"\nkind = \"{kind}\"\nset = \"ball.inner\"\nrigid = \"hub\"\n\
             [[prescribe]]\nset = \"ball.outer\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
             [[load]]\nset = \"hub.all\"\nmoment = {{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.01]] }}\n\
             [[probe]]\nname = \"u\"\nquantity = \"displacement\"\nbody = \"hub\"\npoint = [1.0, 0.0, 0.0]\n\
             [[probe]]\nname = \"m\"\nquantity = \"reaction_moment\"\nset = \"ball.outer\"\n"
        )
    };
    let expected = 0.01 / (8.0 * PI * SHEAR) * (8.0 - 1.0);
    for kind in ["kinematic", "distributing"] {
        let built = run(&scene(kind));
        let [x, y, z] = probe(&built, "u");
        assert!(
            (y / expected - 1.0).abs() < 5e-3 && x.abs() + z.abs() < 1e-2 * expected,
            "{kind}: {x} {y} {z}, {expected}"
        );
        let [.., moment] = probe(&built, "m");
        assert!((moment + 0.01).abs() < 1e-10, "{kind}: {moment}");
    }
}

/// A body that a reference point turns by 90 degrees moves without strain; what holds it is at any place.
#[test]
fn turning_with_a_reference_point_is_free_of_strain() {
    for kind in ["kinematic", "distributing"] {
        let built = run(&format!(
            "{STATIC}[[body]]\nname = \"a\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 0.6, 0.4], divisions = [2, 2, 2] }}\n{MATERIAL}\n\
             [[rigid]]\nname = \"hub\"\nposition = [2.0, -1.0, 0.5]\n[[coupling]]\nname = \"grip\"\nkind = \"{kind}\"\nset = \"a.left\"\nrigid = \"hub\"\n\
             [[prescribe]]\nrigid = \"hub\"\nrotation = {{ axis = [1, 2, 2], degrees = {{ table = [[0.0, 0.0], [1.0, 90.0]] }}, about = [0.5, 0.0, 0.0] }}\n"
        ));
        let strain = built.simulation.balance().strain;
        assert!(strain.abs() < 1e-16, "{kind}: {strain:e}");
        // The largest corner is where the rotation takes it.
        let q = &built.simulation.state().q;
        let x = &built.simulation.model().reference;
        let (axis, about) = ([1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], [0.5, 0.0, 0.0]);
        let r: [f64; 3] = std::array::from_fn(|i| x[i] - about[i]);
        let along: f64 = (0..3).map(|i| axis[i] * r[i]).sum();
        for i in 0..3 {
            let cross = axis[(i + 1) % 3] * r[(i + 2) % 3] - axis[(i + 2) % 3] * r[(i + 1) % 3];
            assert!((q[i] - about[i] - cross - axis[i] * along).abs() < 1e-9, "{kind}");
        }
    }
}

/// In dynamics a reference point needs no mass: a bar with one at its end swings with the period that it has without it, and energy and linear momentum stay.
#[test]
fn a_reference_point_without_mass_in_dynamics() {
    let scene = |extra: &str| {
        format!(
            "[scene]\ntitle = \"t\"\nkind = \"dynamic\"\n[solver]\nrelative_tolerance = 1e-11\n[time]\nend = 1.0\nstep = 0.02\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
             [[body]]\nname = \"a\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 0.6, 0.4], divisions = [2, 1, 1] }}\n{MATERIAL}\ndensity = 2.0\n\
             velocity = [0.1, 0.2, 0.3]\nangular_velocity = [1.0, -2.0, 0.5]\n{extra}"
        )
    };
    let free = run(&scene(""));
    let hub = "[[rigid]]\nname = \"hub\"\nposition = [2.0, -1.0, 0.5]\nvelocity = [1.1, 1.7, -2.7]\nangular_velocity = [1.0, -2.0, 0.5]\n";
    let velocity = {
        // v + omega x (X - X_c), as the body has it.
        let built = build(&scene("")).unwrap();
        let model = built.simulation.model();
        let (x, v) = (&model.reference, &model.velocity);
        let (w, p) = ([1.0, -2.0, 0.5], [2.0, -1.0, 0.5]);
        let r: [f64; 3] = std::array::from_fn(|i| p[i] - x[i]);
        let turned: [f64; 3] =
            std::array::from_fn(|i| w[(i + 1) % 3] * r[(i + 2) % 3] - w[(i + 2) % 3] * r[(i + 1) % 3]);
        format!("velocity = {:?}", std::array::from_fn::<f64, 3, _>(|i| v[i] + turned[i]))
    };
    let hub = hub.replace("velocity = [1.1, 1.7, -2.7]", &velocity);
    let coupled = run(&scene(&format!(
        "{hub}[[coupling]]\nname = \"grip\"\nkind = \"distributing\"\nset = \"a.left\"\nrigid = \"hub\"\n"
    )));
    assert!(coupled.warnings.is_empty(), "{:?}", coupled.warnings);
    let count = free.simulation.model().reference.len();
    let [a, b] = [&free, &coupled].map(|built| &built.simulation.state().q[..count]);
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-9, "{off:e}");
    let [a, b] = [&free, &coupled].map(|built| built.simulation.balance().total());
    assert!((a - b).abs() < 1e-10, "{a} {b}");
}
