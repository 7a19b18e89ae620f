//! Plane sections and planes of symmetry against closed forms, and against the whole models that they stand for.

use crate::support::{drift, simulation, simulation_in};
use stoss::build::build;
use stoss::solver::Simulation;

const STEEL: &str = "material = { law = \"neo-hooke\", young = 2.0e5, poisson = 0.3 }";

fn head(section: &str) -> String {
    format!(
        "[scene]\ntitle = \"part\"\nkind = \"quasi-static\"\nsection = \"{section}\"\n[time]\nend = 1.0\nstep = 1.0\n"
    )
}

/// A rectangle of steel that does not move along y at its ends.
fn ring(name: &str, radii: [f64; 2], height: f64, divisions: [usize; 2], more: &str) -> String {
    let mut text = format!(
        "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"rectangle\", min = [{:?}, 0.0], max = [{:?}, {height:?}], divisions = {divisions:?} }}\n{STEEL}\n{more}\n",
        radii[0], radii[1]
    );
    for side in ["bottom", "top"] {
        text += &format!("[[prescribe]]\nset = \"{name}.{side}\"\ncomponents = [\"y\"]\nfixed = true\n");
    }
    text
}

/// The values of the probes at the end of a scene.
fn probes(text: &str) -> Vec<Vec<f64>> {
    let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    let mut built = build(&scene, std::path::Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    run(&mut built.simulation);
    built.probes.iter().map(|probe| probe.values(&built.simulation)).collect()
}

fn run(simulation: &mut Simulation) {
    while !simulation.finished() {
        simulation.advance().unwrap_or_else(|e| panic!("{e}"));
    }
}

fn near(value: f64, exact: f64, part: f64) {
    assert!((value / exact - 1.0).abs() < part, "{value} instead of {exact}");
}

fn probe(name: &str, place: &str, quantity: &str) -> String {
    format!("[[probe]]\nname = \"{name}\"\n{place}\nquantity = \"{quantity}\"\n")
}

/// Lame's tube in plane strain: radial displacement of the bore, `u = (1 + nu) p a^2 / (E (b^2 - a^2)) ((1 - 2 nu) a + b^2 / a)`; over a radian the axial force `2 nu p a^2 / (b^2 - a^2) int r dr`
/// and the energy `p u a h / 2`. Eight elements over the thickness; of quadratic ones three.
#[test]
fn a_tube_under_pressure() {
    let [a, b, h, p, young, nu] = [10.0_f64, 20.0, 5.0, 10.0, 2.0e5, 0.3];
    let u = (1.0 + nu) * p * a * a / (young * (b * b - a * a)) * ((1.0 - 2.0 * nu) * a + b * b / a);
    for (divisions, cell, part) in
        [([8, 4], "", 3e-3), ([3, 2], "cell = \"hex20\"", 1e-3), ([3, 2], "cell = \"hex27\"", 1e-3)]
    {
        let text = head("axisymmetric")
            + &ring("tube", [a, b], h, divisions, cell)
            + &format!("[[load]]\nset = \"tube.left\"\npressure = {p:?}\n")
            + &probe("bore", "set = \"tube.left\"", "displacement")
            + &probe("end", "set = \"tube.top\"", "reaction")
            + &probe("energy", "body = \"tube\"", "strain_energy");
        let values = probes(&text);
        near(values[0][0], u, part);
        near(values[1][1], 2.0 * nu * p * a * a / (b * b - a * a) * 0.5 * (b * b - a * a), 1e-3);
        // What holds the sides of the slice is no reaction.
        assert!(values[1][0].abs() < 1e-6 * values[1][1], "{}", values[1][0]);
        near(values[2][0], 0.5 * p * values[0][0] * a * h, 1e-3);
    }
}

/// A ring that is pressed onto another one of the same material, with meshes that do not match: `p = delta E / (2 b) (c^2 - b^2)(b^2 - a^2) / (b^2 (c^2 - a^2)) / (1 - nu^2)` in plane strain. The force of a
/// tie between rings without overlap passes the pressure of the bore to the outer one: they are Lame's tube.
#[test]
fn rings_that_are_pressed_together_or_tied() {
    let [a, b, c, delta] = [10.0_f64, 20.0, 30.0, 0.02];
    let modulus = 2.0e5 / (1.0 - 0.09);
    let p = delta * modulus / (2.0 * b) * (c * c - b * b) * (b * b - a * a) / (b * b * (c * c - a * a));
    for (inner, outer, cell, part) in [
        ([8, 5], [8, 7], "", 2e-3),
        ([3, 2], [3, 3], "cell = \"hex20\"", 1e-3),
        ([8, 5], [2, 4], "cell = \"hex27\"", 1e-3),
    ] {
        for method in ["mortar", "nts"] {
            // Node-to-surface contact sees quadratic faces in pieces, whose pressures are its own.
            if method == "nts" && !cell.is_empty() {
                continue;
            }
            let text = head("axisymmetric")
                + &ring("hub", [a, b + delta], 10.0, inner, cell)
                + &ring("ring", [b, c], 10.0, outer, cell)
                + &format!("[[contact]]\nmethod = \"{method}\"\nslave = \"ring.left\"\nmaster = \"hub.right\"\n")
                + &probe("force", "set = \"ring.left\"", "contact_force");
            near(probes(&text)[0][0], p * b * 10.0, part);
        }
    }
    let u = 1.3 * 10.0 * a * a / (2.0e5 * (c * c - a * a)) * (0.4 * a + c * c / a);
    let text = head("axisymmetric")
        + &ring("hub", [a, b], 10.0, [8, 5], "")
        + &ring("ring", [b, c], 10.0, [8, 7], "")
        + "[[tie]]\nslave = \"ring.left\"\nmaster = \"hub.right\"\n[[load]]\nset = \"hub.left\"\npressure = 10.0\n"
        + &probe("bore", "set = \"hub.left\"", "displacement");
    near(probes(&text)[0][0], u, 3e-3);
}

/// Uniaxial states: a solid cylinder with its axis, `sigma = E eps` of small strains, and a plate in plane strain, `E / (1 - nu^2)`, and in plane stress, `E`.
#[test]
fn uniaxial_states() {
    let block = |max: &str| {
        format!(
            "[[body]]\nname = \"b\"\nmesh = {{ generator = \"rectangle\", min = [0, 0], max = {max}, divisions = [5, 4] }}\n{STEEL}\n"
        ) + "[[prescribe]]\nset = \"b.bottom\"\ncomponents = [\"y\"]\nfixed = true\n"
            + "[[load]]\nset = \"b.top\"\ntotal_force = [0, 0.2, 0]\n"
    };
    let more = probe("end", "set = \"b.top\"", "displacement") + &probe("hold", "set = \"b.bottom\"", "reaction");
    let strain = 0.2 / 2.0e5 / 2.0 * 3.0;
    let values = probes(&(head("axisymmetric") + &block("[2.0, 3.0]") + &more));
    // The nodes on the axis hold their radius, a thirty-second of an element.
    near(values[0][1], strain, 1e-4);
    near(values[1][1], -0.2, 1e-9);
    let left = "[[prescribe]]\nset = \"b.left\"\ncomponents = [\"x\"]\nfixed = true\n";
    for (section, factor) in [("plane-strain", 1.0 - 0.09), ("plane-stress", 1.0)] {
        let values = probes(&(head(section) + &block("[2.0, 3.0]") + left + &more));
        near(values[0][1], strain * factor, 1e-5);
        near(values[1][1], -0.2, 1e-9);
    }
}

/// A node's force in quadratic cells is shared by its copies: the sum is the force, in each section.
#[test]
fn forces_on_nodes() {
    for (section, cell) in [("axisymmetric", "hex8"), ("axisymmetric", "hex20"), ("plane-stress", "hex27")] {
        let text = head(section)
            + &format!(
                "[[body]]\nname = \"b\"\nmesh = {{ generator = \"rectangle\", min = [1, 0], max = [2, 1], divisions = [2, 2] }}\ncell = \"{cell}\"\n{STEEL}\n"
            )
            + "[[set]]\nname = \"b.corner\"\nbody = \"b\"\nbox = { min = [1.9, 0.9, 0], max = [2.1, 1.1, 0] }\n"
            + "[[prescribe]]\nset = \"b.bottom\"\ncomponents = [\"x\", \"y\"]\nfixed = true\n[[load]]\nset = \"b.corner\"\nforce = [0, 3, 0]\n"
            + &probe("hold", "set = \"b.bottom\"", "reaction");
        near(probes(&text)[0][1], -3.0, 1e-9);
    }
}

/// A ball of rubber falls on a plate, in an axisymmetric section: the total energy of a radian is constant to round-off but for what closing gaps take.
#[test]
fn a_section_in_motion_keeps_its_energy() {
    let mut simulation = simulation(
        "[scene]\ntitle = \"fall\"\nkind = \"dynamic\"\nsection = \"axisymmetric\"\n[time]\nend = 0.2\nstep = 0.005\nintegrator = { scheme = \"energy-momentum\" }\n\
         [[body]]\nname = \"ball\"\nmesh = { generator = \"disc\", radius = 1.0, part = \"quarter\", divisions = [4, 4, 3] }\nposition = [0.0, 1.02, 0.0]\n\
         material = { law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }\ndensity = 1.0\nvelocity = [0.0, -2.0, 0.0]\n\
         [[body]]\nname = \"plate\"\nmesh = { generator = \"rectangle\", min = [0.0, -0.5], max = [1.5, 0.0], divisions = [6, 2] }\n\
         material = { law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }\ndensity = 1.0\n\
         [[prescribe]]\nset = \"plate.bottom\"\ncomponents = [\"x\", \"y\"]\nfixed = true\n\
         [[contact]]\nmethod = \"mortar\"\nslave = \"ball.outer\"\nmaster = \"plate.top\"\n",
    );
    let (mut energies, mut slowest) = (Vec::new(), f64::INFINITY);
    while !simulation.finished() {
        let record = simulation.advance().unwrap_or_else(|e| panic!("{e}"));
        let b = record.balance;
        slowest = slowest.min(b.kinetic);
        energies.push([b.total() + b.closing_loss + b.impact_loss, 0.0, 0.0]);
        assert!(record.contact.is_none_or(|contact| contact.min_gap > -1e-9));
    }
    assert!(slowest < 0.1 * energies[0][0], "it hits the plate: {slowest}");
    assert!(drift(&energies) < 1e-11, "{:e}", drift(&energies));
}

/// A ball that is pressed on a plate, an eighth of it and a quarter of the plate against a half of the ball and the plate.
#[test]
fn planes_of_symmetry_stand_for_the_other_side() {
    let model = |whole: bool, contact: &str| {
        let (symmetry, part, low, across) =
            if whole { ("", "half", -1.5, 6) } else { ("symmetry = [\"x\", \"y\"]\n", "eighth", 0.0, 3) };
        let text = format!(
            "[scene]\ntitle = \"ball\"\nkind = \"quasi-static\"\n{symmetry}[time]\nend = 1.0\nstep = 0.5\n\
             [[body]]\nname = \"ball\"\nmesh = {{ generator = \"ball\", radius = 1.0, part = \"{part}\", divisions = [3, 3, 2] }}\nposition = [0, 0, 1.05]\n{STEEL}\n\
             [[body]]\nname = \"plate\"\nmesh = {{ generator = \"block\", min = [{low:?}, {low:?}, -0.5], max = [1.5, 1.5, 0.0], divisions = [{across}, {across}, 2] }}\n{STEEL}\n\
             [[prescribe]]\nset = \"plate.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
             [[prescribe]]\nset = \"ball.top\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0, 0], [1, -0.2]] }}\n\
             [[prescribe]]\nset = \"ball.top\"\ncomponents = [\"x\", \"y\"]\nfixed = true\n{contact}{}",
            probe("force", "set = \"ball.top\"", "reaction")
        );
        probes(&text)[0][2]
    };
    let mortar = "[[contact]]\nmethod = \"mortar\"\nslave = \"ball.outer\"\nmaster = \"plate.top\"\n";
    let rough = format!("{mortar}friction = {{ law = \"coulomb\", mu = 0.3 }}\n");
    for (contact, part) in [(mortar, 1e-7), (&rough, 1e-4), ("[general_contact]\n", 3e-5)] {
        near(4.0 * model(false, contact), model(true, contact), part);
    }
}

/// Meshes of files: triangles and quadrilaterals of Gmsh, CAX8 of Abaqus.
#[test]
fn plane_meshes_of_files() {
    let folder = tempfile::tempdir().unwrap();
    let gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"bore\"\n1 2 \"ends\"\n2 3 \"part\"\n$EndPhysicalNames\n\
                $Nodes\n6\n1 10 0 0\n2 12 0 0\n3 14 0 0\n4 10 2 0\n5 12 2 0\n6 14 2 0\n$EndNodes\n\
                $Elements\n8\n1 1 2 1 1 1 4\n2 1 2 2 2 1 2\n3 1 2 2 2 2 3\n4 1 2 2 2 4 5\n5 1 2 2 2 5 6\n\
                6 3 2 3 1 1 2 5 4\n7 2 2 3 1 2 3 6\n8 2 2 3 1 2 6 5\n$EndElements\n";
    let abaqus = "*NODE\n1, 10, 0\n2, 14, 0\n3, 14, 2\n4, 10, 2\n5, 12, 0\n6, 14, 1\n7, 12, 2\n8, 10, 1\n*ELEMENT, TYPE=CAX8, ELSET=part\n1, 1, 2, 3, 4, 5, 6, 7, 8\n\
                  *SURFACE, NAME=bore\n1, S4\n*SURFACE, NAME=ends\n1, S1\n1, S3\n";
    std::fs::write(folder.path().join("part.msh"), gmsh).unwrap();
    std::fs::write(folder.path().join("part.inp"), abaqus).unwrap();
    let scene = |file: &str, section: &str| {
        head("axisymmetric").replace("section = \"axisymmetric\"\n", section)
            + &format!(
                "[[body]]\nname = \"tube\"\nmesh = {{ file = \"{file}\", group = \"part\", scale = 2.0 }}\nposition = [1, 0, 0]\n{STEEL}\n"
            )
            + "[[prescribe]]\nset = \"tube.ends\"\ncomponents = [\"y\"]\nfixed = true\n[[load]]\nset = \"tube.bore\"\npressure = 10.0\n"
    };
    let [a, b] = [21.0_f64, 29.0];
    let u = 1.3 * 10.0 * a * a / (2.0e5 * (b * b - a * a)) * (0.4 * a + b * b / a);
    for (file, part) in [("part.msh", 2e-2), ("part.inp", 2e-3)] {
        let mut simulation = simulation_in(&scene(file, "section = \"axisymmetric\"\n"), folder.path());
        let before = simulation.state().q.clone();
        run(&mut simulation);
        let bore = (0..before.len() / 3).filter(|&n| (before[3 * n] - a).abs() < 1e-9);
        let moved: Vec<f64> = bore.map(|n| simulation.state().q[3 * n] - before[3 * n]).collect();
        assert!(moved.len() >= 4);
        moved.iter().for_each(|&m| near(m, u, part));
        let text = scene(file, "");
        let refused = build(&stoss::scene::parse(&text, "test.toml").unwrap(), folder.path()).unwrap_err().to_string();
        assert!(refused.contains("plane elements only"), "{refused}");
    }
}

/// What a section has no place for is refused where it stands.
#[test]
fn what_a_section_cannot_have_is_refused() {
    let good = head("axisymmetric") + &ring("tube", [1.0, 2.0], 1.0, [1, 1], "");
    let block = good.replace(
        "\"rectangle\", min = [1.0, 0.0], max = [2.0, 1.0], divisions = [1, 1]",
        "\"block\", size = [1, 1, 1], divisions = [1, 1, 1]",
    );
    let cases = [
        (block, "body[0].mesh", "is a solid"),
        (good.replace("section = \"axisymmetric\"\n", ""), "body[0].mesh", "is plane"),
        (good.clone() + "[general_contact]\n", "general_contact", "has no place"),
        (good.clone() + "[[load]]\nset = \"tube.top\"\nmoment = [0, 0, 1]\n", "load[0].moment", "has no place"),
        (
            good.clone() + "[[rigid]]\nname = \"tool\"\nshape = { kind = \"box\", size = [1, 1, 1] }\n",
            "rigid[0].fixed",
            "prescribed",
        ),
        (good.replace("material", "position = [0, 0, 1]\nmaterial"), "body[0].position", "out of its plane"),
        (good.replace("material", "position = [-1.5, 0, 0]\nmaterial"), "body[0].mesh", "negative"),
        (
            good.replace("section", "symmetry = \"y\"\nsection")
                .replace("material", "position = [0, -0.5, 0]\nmaterial"),
            "body[0].mesh",
            "both sides",
        ),
        (good.replace("section", "symmetry = \"x\"\nsection"), "scene.symmetry", "no deformable body"),
        (good.clone() + "[gravity]\nacceleration = [0, 0, -9.81]\n", "gravity", "mirrored"),
        (good.clone() + "[[load]]\nset = \"tube.top\"\ntraction = [0, 0, 1]\n", "load[0].set", "out of the section"),
        (
            good.replace("components = [\"y\"]\nfixed = true", "components = [\"y\", \"z\"]\ndisplacement = [0, 0.1]"),
            "components",
            "along z",
        ),
        (
            good.clone()
                + "[[rigid]]\nname = \"tool\"\nshape = { kind = \"box\", size = [1, 1, 1] }\nposition = [0, 0, 2]\nfixed = true\n",
            "rigid[0].position",
            "miss it",
        ),
        (
            good.replace("section", "symmetry = \"y\"\nsection")
                + &ring("other", [1.0, 2.0], 1.0, [1, 1], "position = [0, -1, 0]"),
            "scene.symmetry",
            "two sides",
        ),
    ];
    for (text, key, message) in cases {
        let error = match stoss::scene::parse(&text, "test.toml") {
            Ok(scene) => build(&scene, std::path::Path::new(".")).map(|_| ()).unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        assert!(error.contains(key) && error.contains(message), "{key}, {message}: {error}");
    }
}

/// A section of a plate turns in its plane by a prescribed rotation, without strain.
#[test]
fn a_plate_turns_in_its_plane() {
    let text = head("plane-strain")
        + &format!(
            "[[body]]\nname = \"b\"\nmesh = {{ generator = \"rectangle\", min = [0, 0], max = [2, 1], divisions = [4, 2] }}\n{STEEL}\n"
        )
        + "[[prescribe]]\nset = \"b.left\"\nrotation = { axis = [0, 0, 1], degrees = 90 }\n"
        + &probe("end", "set = \"b.right\"", "position")
        + &probe("energy", "body = \"b\"", "strain_energy");
    let text =
        text.replace("step = 1.0", "step = 0.05").replace("degrees = 90", "degrees = { table = [[0, 0], [1, 90]] }");
    let values = probes(&text);
    assert!((values[0][0] + 0.5).abs() < 1e-9 && (values[0][1] - 2.0).abs() < 1e-9, "{:?}", values[0]);
    assert!(values[1][0].abs() < 1e-12, "{:?}", values[1]);
}

/// A body that flies through a plane of symmetry would meet its mirror image, and the verdict says so.
#[test]
fn a_body_that_passes_a_plane_of_symmetry_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("fly.toml");
    let text = format!(
        "[scene]\ntitle = \"fly\"\nkind = \"dynamic\"\nsymmetry = \"x\"\n[time]\nend = 1.0\nstep = 0.1\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
         [[body]]\nname = \"wall\"\nmesh = {{ generator = \"block\", min = [0, 0, 3], max = [1, 1, 4], divisions = [1, 1, 1] }}\n{STEEL}\ndensity = 1.0\n\
         [[body]]\nname = \"stone\"\nmesh = {{ generator = \"block\", min = [0.5, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }}\n{STEEL}\ndensity = 1.0\nvelocity = [-2, 0, 0]\n"
    );
    std::fs::write(&scene, text).unwrap();
    let options = stoss::run::RunOptions { out: folder.path().join("out"), ..Default::default() };
    let summary = stoss::run::run_scene(&scene, &options, &mut |_| {}).unwrap();
    let reason = &summary.verdict.reasons[0].sentence;
    assert!(reason.contains("`stone` has passed the plane of symmetry x = 0"), "{reason}");
}
