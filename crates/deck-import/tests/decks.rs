//! Scenes from decks: what maps, what is left out, and decks that are broken.

use std::io::ErrorKind;

use stoss_deck_import::{FileNames, Import, ImportError, Severity, import};
use stoss_mesh_io::MeshIoError;
use stoss_mesh_io::deck::read_deck_from_bytes;

#[path = "decks/joined.rs"]
mod joined;

const PRESS: &str = include_str!("data/press.inp");
const BAR: &str = include_str!("data/bar.inp");
const LEFT_OUT: &str = include_str!("data/left-out.inp");
const JUMP: &str = include_str!("data/jump.inp");

fn try_to(text: &str) -> Result<Import, String> {
    let deck = read_deck_from_bytes("part.inp", text.as_bytes(), &mut |_| Err(ErrorKind::NotFound.into()));
    let deck = deck.map_err(|error| error.to_string())?;
    let names = FileNames { deck: "part.inp".to_owned(), mesh: "part.mesh.inp".to_owned() };
    import(&deck, &names).map_err(|error| error.to_string())
}

fn imported(text: &str) -> Import {
    try_to(text).unwrap_or_else(|error| panic!("{error}"))
}

/// The tables of a kind in a scene.
fn tables(import: &Import, kind: &str) -> Vec<toml::Table> {
    let scene: toml::Table = import.scene.parse().unwrap_or_else(|error| panic!("{error}\n{}", import.scene));
    let list = scene.get(kind).and_then(toml::Value::as_array).cloned().unwrap_or_default();
    list.iter().map(|table| table.as_table().unwrap().clone()).collect()
}

fn strings(tables: &[toml::Table], key: &str) -> Vec<String> {
    tables.iter().filter_map(|table| table.get(key)?.as_str().map(str::to_owned)).collect()
}

fn entry<'a>(import: &'a Import, what: &str) -> &'a stoss_deck_import::LeftOut {
    let found = import.left_out.iter().find(|entry| entry.what.starts_with(what));
    found.unwrap_or_else(|| panic!("no {what} in {:#?}", import.left_out))
}

/// A cube of one C3D8 with sets for its corners, its sides and itself.
const CUBE: &str = "*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=Cube
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=Base
1, 2, 3, 4
*NSET, NSET=Left
1, 4, 5, 8
*NSET, NSET=Top
5, 6, 7, 8
*SURFACE, NAME=Lid
Cube, S2
*MATERIAL, NAME=steel
*ELASTIC
100.0, 0.3
*DENSITY
2.0
*SOLID SECTION, ELSET=Cube, MATERIAL=steel
";

fn cube(rest: &str) -> Import {
    imported(&format!("{CUBE}{rest}"))
}

#[test]
fn a_contact_with_friction_and_an_amplitude() {
    let import = imported(PRESS);
    assert_eq!(strings(&tables(&import, "body"), "name"), ["lower", "upper"]);
    let [contact] = tables(&import, "contact").try_into().unwrap();
    assert_eq!(contact["slave"].as_str(), Some("upper.slave"));
    assert_eq!(contact["master"].as_str(), Some("lower.master"));
    assert_eq!(contact["friction"]["mu"].as_float(), Some(0.3));
    let [load] = tables(&import, "load").try_into().unwrap();
    // No NLGEOM: a dead pressure, 8 times the amplitude.
    assert_eq!(load["pressure"].to_string(), "{ table = [[0.0, 0.0], [0.5, 1.6], [1.0, 8.0]] }");
    let scene: toml::Table = import.scene.parse().unwrap();
    assert_eq!(scene["time"]["step"].as_float(), Some(0.5));
    assert_eq!(scene["scene"]["title"].as_str(), Some("Two blocks, pressed"));
    // Faces P2 have no name in the deck.
    let mesh = import.mesh.expect("a mesh with a new set");
    assert_eq!(mesh.facet_sets["pressed"].len(), 9);
}

#[test]
fn materials_of_one_mesh_are_tied_and_steps_are_stages() {
    let import = imported(BAR);
    assert_eq!(strings(&tables(&import, "body"), "name"), ["soft", "hard"]);
    let [tie] = tables(&import, "tie").try_into().unwrap();
    assert!(tie["slave"].as_str().unwrap().starts_with("hard."), "{tie}");
    let mesh = import.mesh.as_ref().unwrap();
    for set in [tie["slave"].as_str().unwrap(), tie["master"].as_str().unwrap()] {
        let (_, set) = set.split_once('.').unwrap();
        let facets = &mesh.facet_sets[set];
        assert_eq!(facets.len(), 4);
        assert!(facets.iter().flat_map(|f| f.nodes.iter()).all(|&n| mesh.nodes[n as usize][0] == 1.0));
    }
    // Only what OP=NEW does not name again ends.
    let stages = tables(&import, "stage");
    assert_eq!(strings(&stages, "name"), ["pull", "release"]);
    assert!(!stages[0].contains_key("off"));
    let off = stages[1]["off"].as_array().unwrap();
    let ended: Vec<toml::Table> =
        tables(&import, "prescribe").into_iter().filter(|table| table.get("name") == Some(&off[0])).collect();
    assert_eq!((off.len(), strings(&ended, "set")), (1, vec!["hard.right".to_owned()]));
    assert_eq!(ended[0]["displacement"].to_string(), "{ table = [[0.0, 0.0], [1.0, 0.004]] }");
    let loads = tables(&import, "load");
    assert_eq!(strings(&loads, "set"), ["hard.corners", "hard.edges", "hard.middle"]);
    let force = "{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [3.0, 0.1125, 0.0, 0.0]] }";
    assert_eq!(loads[1]["force"].to_string(), force);
}

#[test]
fn what_is_left_out_is_told_with_its_line() {
    let import = imported(LEFT_OUT);
    let line = |text: &str| 1 + LEFT_OUT.lines().position(|line| line.starts_with(text)).unwrap();
    for (what, text) in [
        ("1 element S4", "*ELEMENT, TYPE=S4"),
        ("*PLASTIC", "*PLASTIC"),
        ("*EXPANSION", "*EXPANSION"),
        ("all lines of *ELASTIC", "*ELASTIC"),
        ("*SPRING", "*SPRING"),
        ("1 element SPRINGA", "*ELEMENT, TYPE=SPRINGA"),
        ("*DAMPING of material", "*MATERIAL"),
        ("*EQUATION", "*EQUATION"),
        ("*FREQUENCY", "*FREQUENCY"),
        ("*CLOAD", "ref, 3"),
        ("*BOUNDARY", "turned, 1"),
    ] {
        assert_eq!(entry(&import, what).place, format!("part.inp:{}", line(text)), "{what}");
    }
    assert!(entry(&import, "gravity").consequence.contains("*DENSITY"));
    // All of it stands in the scene, too, the worst first.
    let entries = tables(&import, "left_out");
    let words = |key: &str| strings(&entries, key);
    assert_eq!(words("line"), import.left_out.iter().map(|entry| entry.place.clone()).collect::<Vec<_>>());
    assert_eq!(words("keyword"), import.left_out.iter().map(|entry| entry.what.clone()).collect::<Vec<_>>());
    assert_eq!(words("text"), import.left_out.iter().map(|entry| entry.text()).collect::<Vec<_>>());
    assert_eq!(words("severity"), import.left_out.iter().map(|entry| entry.severity.name()).collect::<Vec<_>>());
    assert!(import.left_out.is_sorted_by_key(|entry| entry.severity));
    for (what, severity) in [
        ("1 element S4", Severity::Missing),
        ("*SPRING", Severity::Missing),
        ("*EQUATION", Severity::Missing),
        ("*CLOAD", Severity::Missing),
        ("gravity", Severity::Missing),
        ("*PLASTIC", Severity::Changed),
        ("all lines of *ELASTIC", Severity::Changed),
        ("*FREQUENCY", Severity::Note),
        ("*EXPANSION", Severity::Note),
    ] {
        assert_eq!(entry(&import, what).severity, severity, "{what}");
    }
    // A request of output changes nothing.
    assert!(import.left_out.iter().all(|entry| !entry.what.contains("FILE")), "{:#?}", import.left_out);
    // One of the two turned nodes lies on the line of the cylindrical axes and has no radial direction; the shell's nodes have only what they have of the solid.
    assert!(
        import.left_out.iter().any(|entry| entry.consequence.contains("on 1 node whose *TRANSFORM gives no such axes"))
    );
    assert_eq!(strings(&tables(&import, "prescribe"), "set"), ["block.base", "block.support"]);
}

#[test]
fn a_deck_whose_sets_suffice_is_the_mesh() {
    let import = cube("*BOUNDARY\nbase, 1, 3\n*STEP\n*STATIC\n*DSLOAD\nLID, P, 2.0\n*END STEP\n");
    assert!(import.mesh.is_none());
    let body = &tables(&import, "body")[0];
    assert_eq!(body["mesh"].to_string(), "{ file = \"part.inp\" }");
    // Names compare without regard to case, and have the spelling of the mesh.
    assert_eq!(strings(&tables(&import, "prescribe"), "set"), ["Cube.Base"]);
    assert_eq!(strings(&tables(&import, "load"), "set"), ["Cube.Lid"]);
    assert!(import.scene.contains("pressure = { table = [[0.0, 0.0], [1.0, 2.0]] }"), "{}", import.scene);
    // With NLGEOM the pressure follows the surface.
    let import = cube("*STEP, NLGEOM\n*STATIC\n*DSLOAD\nLid, P, 2.0\n*END STEP\n");
    assert!(import.scene.contains("follower_pressure = "), "{}", import.scene);
}

/// Sets that overlap, and values that a later line changes for some nodes.
#[test]
fn the_last_line_counts_for_each_node() {
    let import =
        cube("*BOUNDARY\nBase, 3\nLeft, 3\n*STEP\n*STATIC\n*BOUNDARY\n6, 3, 3, 0.5\n6, 3, 3, 0.25\n*END STEP\n");
    let all = tables(&import, "prescribe");
    assert_eq!(strings(&all, "set"), ["Cube.Base", "Cube.Left", "Cube.support"]);
    assert_eq!(import.mesh.as_ref().unwrap().node_sets["support"], [5]);
    assert_eq!(all[2]["displacement"].to_string(), "{ table = [[0.0, 0.0], [1.0, 0.25]] }");
    // A value for one node of a set: the others keep the set's.
    let import = cube("*BOUNDARY\nBase, 3\n1, 3, 3, 0.5\n*STEP\n*STATIC\n*END STEP\n");
    let mesh = import.mesh.as_ref().unwrap();
    let own: Vec<(String, &Vec<u32>)> = strings(&tables(&import, "prescribe"), "set")
        .into_iter()
        .map(|set| (set.clone(), &mesh.node_sets[set.strip_prefix("Cube.").unwrap()]))
        .collect();
    assert_eq!(own.iter().map(|(_, nodes)| nodes.as_slice()).collect::<Vec<_>>(), [[1, 2, 3].as_slice(), &[0]]);
}

#[test]
fn forces_of_one_step_add_up_and_those_of_a_later_one_replace_them() {
    let rest =
        "*STEP\n*STATIC\n*CLOAD\nTop, 3, 1.0\nTop, 3, 2.0\n*END STEP\n*STEP\n*STATIC\n*CLOAD\nTop, 3, 5.0\n*END STEP\n";
    let [load] = tables(&cube(rest), "load").try_into().unwrap();
    let force = "{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 3.0], [2.0, 0.0, 0.0, 5.0]] }";
    assert_eq!((load["set"].as_str(), load["force"].to_string()), (Some("Cube.Top"), force.to_owned()));
}

/// At the beginning of a dynamic step a load changes at once: it is one load for each part of the time, which acts in its steps only.
#[test]
fn loads_jump_at_the_beginning_of_dynamic_steps() {
    let off = |import: &Import| -> Vec<Vec<String>> {
        let names = |stage: &toml::Table| -> Option<Vec<String>> {
            Some(stage.get("off")?.as_array()?.iter().map(|name| name.as_str().unwrap().to_owned()).collect())
        };
        tables(import, "stage").iter().map(|stage| names(stage).unwrap_or_default()).collect()
    };
    let import = imported(JUMP);
    let loads = tables(&import, "load");
    assert_eq!(strings(&loads, "name"), ["load-1", "load-2"]);
    assert_eq!(strings(&loads, "set"), ["Cube.Top", "Cube.Top"]);
    assert_eq!(loads[0]["force"].to_string(), "{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.001]] }");
    assert_eq!(loads[1]["force"].to_string(), "[0.0, 0.0, 0.002]");
    // OP=NEW without a line: no load is left in the third step.
    assert_eq!(off(&import), [vec!["load-2"], vec!["load-1"], vec!["load-1", "load-2"]]);
    // Components that jump at different steps; pressures, gravity and the speed of a rotation jump, too.
    let dynamic = |lines: &str| format!("*STEP, NLGEOM\n*DYNAMIC, DIRECT\n0.125, 1.0\n{lines}*END STEP\n");
    let import = cube(&format!(
        "*STEP\n*STATIC\n*CLOAD\nTop, 1, 1.0\n*DSLOAD\nLid, P, 1.0\n*DLOAD\nCube, GRAV, 1.0, 0, 0, -1\nCube, CENTRIF, 4.0, 0, 0, 0, 0, 0, 1\n*END STEP\n{}{}",
        dynamic("*CLOAD\nTop, 1, 2.0\n*DSLOAD\nLid, P, 3.0\n"),
        dynamic("*CLOAD\nTop, 3, 5.0\n*DLOAD\nCube, GRAV, 2.0, 0, 0, -1\nCube, CENTRIF, 9.0, 0, 0, 0, 0, 0, 1\n")
    ));
    let loads = tables(&import, "load");
    let of = |key: &str| loads.iter().filter_map(|load| Some(load.get(key)?.to_string())).collect::<Vec<_>>();
    let table = "{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0]] }";
    assert_eq!(of("force"), [table, "[2.0, 0.0, 0.0]", "[2.0, 0.0, 5.0]"]);
    assert_eq!(of("follower_pressure"), ["{ table = [[0.0, 0.0], [1.0, 1.0]] }", "3.0"]);
    assert_eq!(of("acceleration"), ["{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -1.0]] }", "[0.0, 0.0, -2.0]"]);
    assert_eq!(of("angular_velocity").last().map(String::as_str), Some("3.0"));
    let stages = off(&import);
    let acts = |name: &str| stages.iter().map(|off| !off.iter().any(|other| other == name)).collect::<Vec<_>>();
    let active: Vec<Vec<bool>> = strings(&loads, "name").iter().map(|name| acts(name)).collect();
    let [first, second, third] = [0, 1, 2].map(|only| [0, 1, 2].map(|stage| stage == only).to_vec());
    let (later, earlier) = (vec![false, true, true], vec![true, true, false]);
    let expected = [&first, &second, &third, &first, &later, &earlier, &third, &earlier, &third];
    assert_eq!(active.iter().collect::<Vec<_>>(), expected, "{}", import.scene);
    // In a static step, also with AMPLITUDE=STEP, the change takes the first increment, at whose end CalculiX has its first state, too.
    let import = cube(
        "*STEP\n*STATIC\n*CLOAD\nTop, 3, 1.0\n*END STEP\n*STEP, AMPLITUDE=STEP\n*STATIC\n0.25, 1.0\n*CLOAD\nTop, 3, 2.0\n*END STEP\n",
    );
    let [load] = tables(&import, "load").try_into().unwrap();
    let force = "{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0], [1.25, 0.0, 0.0, 2.0]] }";
    assert_eq!(load["force"].to_string(), force);
}

/// An amplitude that jumps within a step: a table cannot, and the list says what it does.
#[test]
fn amplitudes_that_jump() {
    let import = cube(
        "*AMPLITUDE, NAME=A\n0, 0, 1, 0, 1, 1, 2, 1\n*STEP\n*DYNAMIC, DIRECT\n0.125, 2.0\n*CLOAD, AMPLITUDE=A\nTop, 3, 4.0\n*END STEP\n",
    );
    let [load] = tables(&import, "load").try_into().unwrap();
    assert_eq!(
        load["force"].to_string(),
        "{ table = [[0.0, 0.0, 0.0, 0.0], [0.875, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 4.0]] }"
    );
    assert!(entry(&import, "*AMPLITUDE, NAME=A").consequence.contains("jumps at the time 1.0"));
}

#[test]
fn dynamics_with_velocity_gravity_and_rotation() {
    let rest = "*INITIAL CONDITIONS, TYPE=VELOCITY\nBase, 1, 3.0\nTop, 1, 3.0\n*STEP, NLGEOM\n*DYNAMIC, ALPHA=0.0\n0.01, 0.5\n*DLOAD\n\
                Cube, GRAV, 9.81, 0, 0, -2\nCube, CENTRIF, 16.0, 1, 0, 0, 0, 0, 1\n1, BX, 0.5\n*END STEP\n";
    let import = cube(rest);
    let scene: toml::Table = import.scene.parse().unwrap();
    assert_eq!(scene["scene"]["kind"].as_str(), Some("dynamic"));
    assert_eq!(scene["time"]["integrator"].to_string(), "{ rho_inf = 1.0, scheme = \"hht\" }");
    assert_eq!((scene["time"]["end"].as_float(), scene["time"]["step"].as_float()), (Some(0.5), Some(0.01)));
    let body = &tables(&import, "body")[0];
    assert_eq!(body["velocity"].to_string(), "[3.0, 0.0, 0.0]");
    assert_eq!(body["density"].as_float(), Some(2.0));
    let loads = tables(&import, "load");
    // There at once; the direction has any length.
    assert_eq!(loads[0]["acceleration"].to_string(), "[0.0, 0.0, -9.81]");
    assert_eq!(loads[1]["body_force"].to_string(), "[0.5, 0.0, 0.0]");
    assert_eq!(
        (loads[2]["angular_velocity"].as_float(), loads[2]["about"].to_string()),
        (Some(4.0), "[1.0, 0.0, 0.0]".to_owned())
    );
    // A velocity of some nodes is none of the body.
    let part = cube("*INITIAL CONDITIONS, TYPE=VELOCITY\nBase, 1, 3.0\n*STEP\n*DYNAMIC\n0.01, 0.5\n*END STEP\n");
    assert!(!tables(&part, "body")[0].contains_key("velocity"));
    assert!(entry(&part, "*INITIAL CONDITIONS").consequence.contains("not all the same"));
}

#[test]
fn variants_of_elements_have_their_rules() {
    let import = cube("*STEP\n*STATIC\n*END STEP\n").scene;
    assert!(!import.contains("integration") && !import.contains("\nvolumetric"), "{import}");
    let hybrid = imported(&CUBE.replace("C3D8,", "C3D8H,"));
    assert!(hybrid.scene.contains("volumetric = \"mixed\"\nmaterial = { law = \"neo-hooke\""), "{}", hybrid.scene);
    // A tetrahedron with midside nodes: what is said fits a quadratic element with an independent pressure.
    let tet = "*NODE\n1,0,0,0\n2,2,0,0\n3,0,2,0\n4,0,0,2\n5,1,0,0\n6,1,1,0\n7,0,1,0\n8,0,0,1\n9,1,0,1\n10,0,1,1\n\
               *ELEMENT,TYPE=C3D10MH,ELSET=E\n1,1,2,3,4,5,6,7,8,9,10\n*MATERIAL,NAME=rubber\n*ELASTIC\n1.,0.49\n*SOLID SECTION,ELSET=E,MATERIAL=rubber\n";
    let tet = imported(tet);
    assert!(tet.scene.contains("volumetric = \"mixed\"\nmaterial = { law = \"neo-hooke\""), "{}", tet.scene);
    let said: Vec<String> =
        tet.left_out.iter().map(ToString::to_string).filter(|text| text.contains("C3D10MH")).collect();
    assert!(said.len() == 2 && said[0].contains("it is the standard tet10 here"), "{said:?}");
    assert!(said[1].contains("one value an element, where Abaqus has a linear pressure"), "{said:?}");
    assert!(!said.concat().contains("cell = \"quadratic\""), "{said:?}");
    let locked = imported(&CUBE.replace("C3D8,", "C3D8IH,")).left_out;
    let said: Vec<&str> =
        locked.iter().filter(|e| e.consequence.contains("C3D8IH")).map(|e| e.remedy.as_str()).collect();
    assert_eq!(said, ["for bending add `cell = \"quadratic\"` to the body", ""]);
    let reduced = imported(&CUBE.replace("C3D8,", "C3D8R,"));
    assert!(entry(&reduced, "material steel").consequence.contains("fully integrated"));
    let rubber = CUBE.replace("*ELASTIC\n100.0, 0.3", "*HYPERELASTIC, MOONEY-RIVLIN\n3.0, 0.5, 0.01");
    let rubber = imported(&rubber).scene;
    assert!(rubber.contains("mu = [6.0, -1.0], alpha = [2.0, -2.0], kappa = 200.0"), "{rubber}");
}

/// Where the material yields, fully integrated elements average the change of volume, as CalculiX does in C3D8; C3D20R follows plastic flow as it is.
#[test]
fn elements_that_yield_average_the_change_of_volume() {
    let yields = |deck: &str| imported(&deck.replacen("*ELASTIC", "*PLASTIC\n250.0, 0.0\n300.0, 0.1\n*ELASTIC", 1));
    // A law of rubber does not yield, and says so.
    let rubber =
        yields(&CUBE.replace("*ELASTIC\n100.0, 0.3", "*ELASTIC\n100.0, 0.3\n*HYPERELASTIC, NEO HOOKE\n3.0, 0.01"));
    assert!(!rubber.scene.contains("plasticity = "), "{}", rubber.scene);
    assert!(rubber.left_out.iter().any(|e| e.consequence.contains("does not yield")), "{:#?}", rubber.left_out);
    // One that is nearly incompressible is mixed already.
    let stiff = yields(&CUBE.replace("100.0, 0.3", "100.0, 0.499"));
    assert!(stiff.left_out.iter().all(|e| !e.remedy.contains("neo-hooke")), "{:#?}", stiff.left_out);
    let linear = yields(CUBE);
    assert!(linear.scene.contains("plasticity") && !linear.scene.contains("volumetric"), "{}", linear.scene);
    let averages =
        |import: &Import| import.left_out.iter().any(|entry| entry.to_string().contains("averages the change"));
    assert!(averages(&imported(CUBE)) && !averages(&linear), "{:#?}", linear.left_out);
    // Corners, and midpoints of the edges in the order of the format.
    let corners = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]];
    let edges = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
    let middle = |[a, b]: [usize; 2]| std::array::from_fn(|i| (corners[a][i] + corners[b][i]) / 2);
    let nodes: Vec<[i32; 3]> = corners.into_iter().chain(edges.map(middle)).collect();
    let lines: String = nodes.iter().enumerate().map(|(n, [x, y, z])| format!("{},{x},{y},{z}\n", n + 1)).collect();
    let all: Vec<String> = (1..=20).map(|n| n.to_string()).collect();
    let quadratic = format!(
        "*NODE\n{lines}*ELEMENT,TYPE=C3D20R,ELSET=E\n1,{}\n{}\n*MATERIAL,NAME=steel\n*ELASTIC\n2.1e5,0.3\n*SOLID SECTION,ELSET=E,MATERIAL=steel\n",
        all[..10].join(",") + ",",
        all[10..].join(",")
    );
    let reduced = yields(&quadratic);
    let expected = "integration = \"reduced\"\nvolumetric = \"displacement\"\n";
    assert!(reduced.scene.contains(expected), "{}", reduced.scene);
    assert!(!imported(&quadratic).scene.contains("volumetric"));
    assert!(!yields(&quadratic.replace("C3D20R", "C3D20")).scene.contains("volumetric"));
}

/// Relaxation and softening of a material, and what of them is not read.
#[test]
fn materials_relax_and_soften() {
    let of = |lines: &str| imported(&CUBE.replace("100.0, 0.3\n", &format!("100.0, 0.3\n{lines}")));
    let import = of("*VISCOELASTIC, TIME=PRONY\n0.3, 0.0, 0.1\n0.2, 0.0, 10.0\n*MULLINS EFFECT\n1.5, 0.3, 0.1\n");
    let keys = "prony = [[0.3, 0.1], [0.2, 10.0]], moduli = \"long-term\", mullins = { r = 1.5, m = 0.3, beta = 0.1 }";
    assert!(import.scene.contains("law = \"neo-hooke\"") && import.scene.contains(keys), "{}", import.scene);
    let import = of("*VISCOELASTIC, FREQUENCY=PRONY\n0.3, 0.0, 0.1\n");
    assert!(!import.scene.contains("prony = "), "{}", import.scene);
    assert!(entry(&import, "*VISCOELASTIC").consequence.contains("only TIME=PRONY"));
}

/// Sections of a part belong to its instances; a set of the same name in another part is another one.
#[test]
fn parts_and_instances() {
    let mesh = CUBE.split("*MATERIAL").next().unwrap();
    let part = |name: &str, material: &str| {
        format!("*PART, NAME={name}\n{mesh}*SOLID SECTION, ELSET=Cube, MATERIAL={material}\n*END PART\n")
    };
    let instance =
        |name: &str, part: &str, x: f64| format!("*INSTANCE, NAME={name}, PART={part}\n{x}, 0, 0\n*END INSTANCE\n");
    let text = format!(
        "*HEADING\n{}{}*ASSEMBLY, NAME=A\n{}{}{}*END ASSEMBLY\n*MATERIAL, NAME=m1\n*ELASTIC\n1.0, 0.1\n*MATERIAL, NAME=m2\n*ELASTIC\n2.0, 0.1\n\
         *CONTACT PAIR\nI1.Lid, I3.Lid\n*BOUNDARY\nI1.Base, 1, 3\nI2.2, 1\n*STEP\n*STATIC\n*END STEP\n",
        part("P1", "m1"),
        part("P2", "m2"),
        instance("I1", "P1", 0.0),
        instance("I2", "P1", 5.0),
        instance("I3", "P2", 10.0),
    );
    let import = imported(&text);
    let bodies = tables(&import, "body");
    let young: Vec<f64> = bodies.iter().map(|body| body["material"]["young"].as_float().unwrap()).collect();
    assert_eq!(young, [1.0, 1.0, 2.0], "{}", import.scene);
    let mesh = import.mesh.as_ref().unwrap();
    let lone = &mesh.node_sets["support"];
    assert_eq!(lone.iter().map(|&n| mesh.nodes[n as usize]).collect::<Vec<_>>(), [[6.0, 0.0, 0.0]]);
    let contact = &tables(&import, "contact")[0];
    assert!(contact["slave"].as_str().unwrap().ends_with(".I1.Lid"), "{contact}");
}

#[test]
fn names_that_a_scene_cannot_have() {
    let deck = CUBE.replace("Base", "the 'base'").replace("Cube", "1st cube");
    let import = imported(&format!("{deck}*BOUNDARY\nthe 'base', 1\nTop, 2\n*STEP\n*STATIC\n*END STEP\n"));
    assert_eq!(strings(&tables(&import, "body"), "name"), ["body-1st-cube"]);
    assert_eq!(strings(&tables(&import, "prescribe"), "set"), ["body-1st-cube.support", "body-1st-cube.Top"]);
    let quoted = imported(&format!("{}*BOUNDARY\nthe base, 1\n", CUBE.replace("Base", "the base")));
    assert_eq!(strings(&tables(&quoted, "prescribe"), "set"), ["Cube.'the base'"]);
}

#[test]
fn decks_without_a_body_or_a_mesh_are_refused() {
    let error = try_to(&CUBE.replace("*ELASTIC\n100.0, 0.3\n", "*CONDUCTIVITY\n1.0\n")).unwrap_err();
    assert!(error.contains("no element has an elastic material") && error.contains("part.inp:20"), "{error}");
    let error = try_to(CUBE.split("*SOLID").next().unwrap()).unwrap_err();
    assert!(error.contains("SOLID SECTION"), "{error}");
    let error = try_to(&CUBE.replace("100.0, 0.3", "steel, 0.3")).unwrap_err();
    assert!(error.contains("part.inp:22") && error.contains("steel"), "{error}");
    let error =
        try_to(&CUBE.replace("5, 0, 0, 1\n", "5, 0, 0, -1\n").replace("6, 1, 0, 1", "6, 1, 0, -1")).unwrap_err();
    assert!(error.contains("det J") || error.contains("inverted"), "{error}");
    let error = try_to("*HEADING\nnothing\n*NODE\n1, 0, 0, 0\n").unwrap_err();
    assert!(error.contains("part.inp"), "{error}");
    let deck = read_deck_from_bytes("part.inp", b"*NODE\n1, 0, 0, 0\n", &mut |_| Err(ErrorKind::NotFound.into()));
    let names = FileNames { deck: String::new(), mesh: String::new() };
    assert!(matches!(import(&deck.unwrap(), &names), Err(ImportError::Mesh(MeshIoError::NoElements { .. }))));
}

/// Whatever is cut off or changed: a scene that is TOML, or an error that names the file.
#[test]
fn broken_decks_never_panic() {
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    for deck in [PRESS, BAR, LEFT_OUT, JUMP] {
        let broken = |text: &str| match try_to(text) {
            Ok(import) => drop(import.scene.parse::<toml::Table>().unwrap_or_else(|e| panic!("{e}\n{}", import.scene))),
            Err(error) => assert!(error.contains("part.inp"), "{error}"),
        };
        (0..deck.len()).step_by(7).for_each(|end| broken(&deck[..end]));
        for _ in 0..400 {
            let mut bytes = deck.as_bytes().to_vec();
            for _ in 0..3 {
                let at = random() % bytes.len();
                bytes[at] = b"*,=0123456789.-eE\n \"'ABC"[random() % 24];
            }
            broken(&String::from_utf8(bytes).unwrap());
        }
        // A line less.
        let lines: Vec<&str> = deck.lines().collect();
        for left in 0..lines.len() {
            let rest: Vec<&str> = lines.iter().enumerate().filter(|(i, _)| *i != left).map(|(_, line)| *line).collect();
            broken(&rest.join("\n"));
        }
    }
}

/// Two C3D20R on each other, of two materials: both bodies have the reduced rule, a tie joins them.
#[test]
fn quadratic_bodies_of_two_materials() {
    let mut nodes: Vec<[u32; 3]> = Vec::new();
    let mut number = |at: [u32; 3]| {
        let found = nodes.iter().position(|&node| node == at);
        1 + found.unwrap_or_else(|| {
            nodes.push(at);
            nodes.len() - 1
        })
    };
    let square = [[0, 0], [2, 0], [2, 2], [0, 2]];
    let sides = [[1, 0], [2, 1], [1, 2], [0, 1]];
    let mut elements = String::new();
    for (e, low) in [0, 2].into_iter().enumerate() {
        let rings = [(square, low), (square, low + 2), (sides, low), (sides, low + 2), (square, low + 1)];
        let all = rings.iter().flat_map(|(ring, z)| ring.map(|[x, y]| [x, y, *z]));
        let numbers: Vec<String> = all.map(|at| number(at).to_string()).collect();
        elements += &format!("*ELEMENT, TYPE=C3D20R, ELSET=E{e}\n{}, {}\n", e + 1, numbers.join(", "));
    }
    let lines: Vec<String> =
        nodes.iter().enumerate().map(|(n, [x, y, z])| format!("{}, {x}, {y}, {z}\n", n + 1)).collect();
    let material =
        |e: u32| format!("*MATERIAL, NAME=M{e}\n*ELASTIC\n{e}0.0, 0.1\n*SOLID SECTION, ELSET=E{e}, MATERIAL=M{e}\n");
    let text = format!("*NODE\n{}{elements}{}{}", lines.concat(), material(0).replace("00.0", "50.0"), material(1));
    let import = imported(&text);
    assert_eq!(strings(&tables(&import, "body"), "integration"), ["reduced", "reduced"]);
    let [tie] = tables(&import, "tie").try_into().unwrap();
    assert!(tie.get("slave").is_some() && tie.get("master").is_some(), "{tie:?}");
}

/// Forces per volume along two axes act together; gravity without a direction is listed; times of an amplitude must not fall.
#[test]
fn loads_on_elements_do_not_replace_those_along_other_axes() {
    let deck = |loads: [&str; 2], amplitude: &str| {
        format!(
            "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=E\n1,1,2,3,4\n{amplitude}\
             *MATERIAL,NAME=M\n*ELASTIC\n1000.,0.3\n*DENSITY\n1.\n*SOLID SECTION,ELSET=E,MATERIAL=M\n*BOUNDARY\n1,1,3\n\
             *STEP\n*STATIC\n0.5,1.\n*DLOAD\n{}\n*END STEP\n*STEP\n*STATIC\n0.5,1.\n*DLOAD\n{}\n*END STEP\n",
            loads[0], loads[1]
        )
    };
    let import = imported(&deck(["E,BX,2.", "E,BY,3."], ""));
    let loads = tables(&import, "load");
    let last = |loads: &[toml::Table], key: &str| -> Vec<f64> {
        let rows = loads.iter().find_map(|load| load.get(key)?.get("table")?.as_array()).unwrap();
        rows.last().unwrap().as_array().unwrap()[1..].iter().map(|value| value.as_float().unwrap()).collect()
    };
    assert_eq!(last(&loads, "body_force"), [2.0, 3.0, 0.0]);
    // Gravity is one vector, which the next one replaces.
    let import = imported(&deck(["E,GRAV,2.,1,0,0", "E,GRAV,3.,0,1,0"], ""));
    assert_eq!(last(&tables(&import, "load"), "acceleration"), [0.0, 3.0, 0.0]);
    let import = imported(&deck(["E,GRAV,2.", "E,BX,1."], ""));
    assert!(entry(&import, "*DLOAD").consequence.contains("no direction"));
    let falls = try_to(&deck(["E,BX,2.", "E,BY,3."], "*AMPLITUDE,NAME=A\n0.,0.,0.5,1.,0.3,0.\n")).unwrap_err();
    assert!(falls.contains("part.inp:8") && falls.contains("times that do not decrease"), "{falls}");
}

fn floats(value: &toml::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_float().unwrap()).collect()
}

/// Components along axes of their own are prescribed along normals, forces are vectors. What is held in all directions needs no axes.
#[test]
fn supports_and_forces_in_rectangular_axes() {
    let import = cube(
        "*TRANSFORM, NSET=Top\n0.6, 0.8, 0, -0.8, 0.6, 0\n*BOUNDARY\nBase, 1, 3\nTop, 1\nTop, 3\n\
         *STEP\n*STATIC\n*BOUNDARY\nTop, 2, 2, 0.1\n*END STEP\n",
    );
    assert!(import.left_out.iter().all(|entry| !entry.what.contains("TRANSFORM")), "{:#?}", import.left_out);
    let all = tables(&import, "prescribe");
    assert_eq!(strings(&all, "set"), ["Cube.Base", "Cube.Top", "Cube.Top", "Cube.Top"]);
    assert!(all[0].contains_key("components") && !all[0].contains_key("normal"));
    let normals: Vec<Vec<f64>> = all[1..].iter().map(|table| floats(&table["normal"])).collect();
    for (normal, wanted) in normals.iter().zip([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]]) {
        assert!(normal.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-15), "{normals:?}");
    }
    assert_eq!(all[1]["fixed"].as_bool(), Some(true));
    assert_eq!(all[2]["displacement"].to_string(), "{ table = [[0.0, 0.0], [1.0, 0.1]] }");
    let import =
        cube("*TRANSFORM, NSET=Top, TYPE=R\n0, 1, 0, -1, 0, 0\n*STEP\n*STATIC\n*CLOAD\nTop, 1, 2.0\n*END STEP\n");
    let [load] = tables(&import, "load").try_into().unwrap();
    assert_eq!(load["force"].to_string(), "{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 2.0, 0.0]] }");
    let whole = cube(
        "*TRANSFORM, NSET=Top\n0.6, 0.8, 0, -0.8, 0.6, 0\n*BOUNDARY\nTop, 1, 2\nTop, 3\n*STEP\n*STATIC\n*END STEP\n",
    );
    let [held] = tables(&whole, "prescribe").try_into().unwrap();
    assert_eq!(held["components"].to_string(), "[\"x\", \"y\", \"z\"]");
}

/// About the axis of the cube: each corner has its own radius, all of them the same axis.
#[test]
fn supports_in_cylindrical_axes() {
    let import = cube(
        "*TRANSFORM, NSET=Top, TYPE=C\n0.5, 0.5, 0, 0.5, 0.5, 1\n*BOUNDARY\nTop, 1\nTop, 3\n*STEP\n*STATIC\n*END STEP\n",
    );
    let all = tables(&import, "prescribe");
    let r = 0.5_f64.sqrt();
    let mesh = import.mesh.as_ref().unwrap();
    assert_eq!(all.len(), 4 + 1);
    for table in &all[..4] {
        let (set, normal) = (table["set"].as_str().unwrap().strip_prefix("Cube.").unwrap(), floats(&table["normal"]));
        let [node] = mesh.node_sets[set][..] else { panic!("{set}") };
        let x = mesh.nodes[node as usize];
        let wanted = [(x[0] - 0.5) * 2.0 * r, (x[1] - 0.5) * 2.0 * r, 0.0];
        assert!(normal.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-15), "{x:?} {normal:?}");
    }
    assert_eq!((all[4]["set"].as_str(), floats(&all[4]["normal"])), (Some("Cube.Top"), vec![0.0, 0.0, 1.0]));
    for (text, wanted) in
        [("TYPE=C\n1, 1, 1, 1, 1, 1", "must not be the same"), ("TYPE=R\n1, 0, 0, 2, 0, 0", "one line with the origin")]
    {
        let error = try_to(&format!("{CUBE}*TRANSFORM, NSET=Top, {text}\n")).unwrap_err();
        assert!(error.contains(wanted) && error.contains("part.inp:27"), "{error}");
    }
}

/// A displacement that begins in the second step has a name, is off in the first and ramps from where the nodes are; `FIXED` keeps them there.
#[test]
fn displacements_of_later_steps() {
    let steps = |second: &str| {
        format!(
            "*BOUNDARY\nBase, 1, 3\n*STEP\n*STATIC\n*CLOAD\nTop, 3, 1.0\n*END STEP\n*STEP\n*STATIC\n1., 2.\n{second}*END STEP\n"
        )
    };
    let of = |second: &str| {
        let import = cube(&steps(second));
        let late = tables(&import, "prescribe")[1].clone();
        let off = tables(&import, "stage")[0]["off"].as_array().unwrap().clone();
        assert_eq!(off, [late["name"].clone()]);
        late
    };
    let late = of("*BOUNDARY\nTop, 3, 3, 0.5\n");
    assert_eq!((late["displacement"].as_float(), late["ramp_until"].as_float()), (Some(0.5), Some(3.0)));
    let late = of("*BOUNDARY\nTop, 1, 3\n");
    assert_eq!((late["fixed"].as_bool(), late["ramp_until"].as_float()), (Some(true), Some(3.0)));
    for held in ["*BOUNDARY, FIXED\nTop, 1, 3\n", "*BOUNDARY, TYPE=VELOCITY\nTop, 1, 3\n"] {
        let late = of(held);
        assert_eq!((late["fixed"].as_bool(), late["ramp_until"].as_float()), (Some(true), Some(f64::INFINITY)));
    }
    let late = of("*BOUNDARY, TYPE=VELOCITY\nTop, 3, 3, 0.25\n");
    assert_eq!(late["displacement"].to_string(), "{ table = [[1.0, 0.0], [3.0, 0.5]] }");
    assert_eq!(late["ramp_until"].as_float(), Some(f64::INFINITY));
    // From the first step on a displacement begins with zero, and goes on from its value.
    let import = cube(
        "*STEP\n*STATIC\n*BOUNDARY\nTop, 3, 3, 0.5\n*END STEP\n*STEP\n*STATIC\n*BOUNDARY\nTop, 3, 3, 0.75\n*END STEP\n",
    );
    let [only] = tables(&import, "prescribe").try_into().unwrap();
    assert_eq!(only["displacement"].to_string(), "{ table = [[0.0, 0.0], [1.0, 0.5], [2.0, 0.75]] }");
    assert!(!only.contains_key("ramp_until"));
    // Along an inclined axis there is no ramp, and that is reported.
    let import =
        cube(&format!("*TRANSFORM, NSET=Top\n0.6, 0.8, 0, -0.8, 0.6, 0\n{}", steps("*BOUNDARY\nTop, 1, 1, 0.5\n")));
    assert!(!tables(&import, "prescribe")[1].contains_key("ramp_until"));
    assert!(entry(&import, "*BOUNDARY").consequence.contains("does not begin where the nodes are"));
}

#[test]
fn increments_and_damping_of_dynamics() {
    let damped = CUBE.replace("*DENSITY", "*DAMPING, ALPHA=0.5, BETA=1e-4\n*DENSITY");
    let of = |step: &str| imported(&format!("{damped}*STEP, NLGEOM\n{step}\n*END STEP\n"));
    let import = of("*DYNAMIC, DIRECT\n0.01, 0.5");
    assert_eq!(tables(&import, "body")[0]["damping"].to_string(), "{ mass = 0.5, stiffness = 0.0001 }");
    let time = |import: &Import| import.scene.parse::<toml::Table>().unwrap()["time"].clone();
    assert_eq!(time(&import)["step"].as_float(), Some(0.01));
    assert!(import.left_out.iter().all(|entry| entry.what != "*DYNAMIC"), "{:#?}", import.left_out);
    // The run of the deck would grow to the largest increment; the first one is in reach by halving.
    let import = of("*DYNAMIC\n1e-6, 0.5, 1e-8, 0.02");
    assert_eq!((time(&import)["step"].as_float(), time(&import)["max_cuts"].as_integer()), (Some(0.02), Some(15)));
    assert!(entry(&import, "*DYNAMIC").consequence.contains("all are 0.02, the largest increment of the deck"));
    let import = of("*DYNAMIC\n0.01, 0.5");
    assert_eq!(time(&import)["step"].as_float(), Some(0.01));
    assert!(entry(&import, "*DYNAMIC").consequence.contains("the first increment of the deck"));
    let still = of("*STATIC");
    assert!(!tables(&still, "body")[0].contains_key("damping"));
    assert!(entry(&still, "*DAMPING of material steel").consequence.contains("no dynamic step"));
}
