//! What joins nodes: equations, couplings, pretension, springs, reference nodes; contacts that steps change.

use super::{CUBE, PRESS, cube, entry, imported, strings, tables};
use stoss_deck_import::Severity;

/// A reference node of an equation is a point that is fixed where nothing acts; the load on it is a load of the point.
#[test]
fn equations_with_a_reference_node() {
    let import = cube(
        "*NODE\n20, 5, 5, 5\n*NSET, NSET=Ref\n20\n*EQUATION\n2\nTop, 3, 1.0, Ref, 1, -2.0\n*BOUNDARY\nBase, 1, 3\n\
         *STEP\n*STATIC\n*CLOAD\nRef, 1, 3.0\n*END STEP\n",
    );
    let [mass] = tables(&import, "mass").try_into().unwrap();
    assert_eq!((mass["name"].as_str(), mass["at"].to_string()), (Some("node-20"), "[5.0, 5.0, 5.0]".to_owned()));
    let equations = tables(&import, "equation");
    assert_eq!(equations.len(), 4);
    let mesh = import.mesh.as_ref().unwrap();
    for (k, equation) in equations.iter().enumerate() {
        let [own, of_point] = equation["terms"].as_array().unwrap().as_slice() else { panic!("{equation}") };
        let set = own["set"].as_str().unwrap().strip_prefix("Cube.").unwrap();
        assert_eq!((&mesh.node_sets[set], own["component"].as_str()), (&vec![4 + k as u32], Some("z")));
        assert_eq!(of_point.to_string(), "{ component = \"x\", factor = -2.0, set = \"node-20.all\" }");
    }
    let fixed =
        tables(&import, "prescribe").into_iter().find(|table| table["set"].as_str() == Some("node-20.all")).unwrap();
    assert_eq!((fixed["components"].to_string(), fixed["fixed"].as_bool()), ("[\"y\", \"z\"]".to_owned(), Some(true)));
    let [load] = tables(&import, "load").try_into().unwrap();
    assert_eq!(
        (load["set"].as_str(), import.left_out.iter().any(|entry| entry.severity == Severity::Missing)),
        (Some("node-20.all"), false)
    );
}

/// Couplings become rigid bodies without mass; supports of their displacements are equations, of their rotations joints to the ground.
#[test]
fn couplings_with_supports_and_moments() {
    let import = cube(
        "*NODE\n20, 0.5, 0.5, 2\n21, 0, 0, 0\n*COUPLING, REF NODE=20, SURFACE=Lid, CONSTRAINT NAME=c\n*DISTRIBUTING\n1, 6\n\
         *RIGID BODY, NSET=Base, REF NODE=22, ROT NODE=21\n*NODE\n22, 0, 0, 0\n*BOUNDARY\n22, 1, 3\n21, 1, 2\n\
         *STEP, NLGEOM\n*STATIC\n*BOUNDARY\n21, 3, 3, 0.5\n*CLOAD\n20, 6, 4.0\n20, 2, 1.0\n*END STEP\n",
    );
    assert_eq!(strings(&tables(&import, "rigid"), "name"), ["node-20", "node-22"]);
    let couplings = tables(&import, "coupling");
    assert_eq!(strings(&couplings, "kind"), ["distributing", "kinematic"]);
    assert_eq!(strings(&couplings, "set"), ["Cube.Lid", "Cube.coupled"]);
    let equations = tables(&import, "equation");
    let terms: Vec<String> = equations.iter().map(|table| table["terms"].to_string()).collect();
    let term = |axis: &str| format!("[{{ component = \"{axis}\", set = \"node-22.all\" }}]");
    assert_eq!(terms, ["x", "y", "z"].map(term));
    let [joint] = tables(&import, "joint").try_into().unwrap();
    assert_eq!((joint["kind"].as_str(), joint["axis"].to_string()), (Some("parallel"), "[0.0, 0.0, 1.0]".to_owned()));
    let degrees = joint["motor"]["angle"]["table"][1][1].as_float().unwrap();
    assert!((degrees - 0.5_f64.to_degrees()).abs() < 1e-12);
    let loads = tables(&import, "load");
    assert_eq!(strings(&loads, "set"), ["node-20.all", "node-20.all"]);
    assert_eq!(loads[0]["force"]["table"][1].to_string(), "[1.0, 0.0, 1.0, 0.0]");
    assert_eq!(loads[1]["moment"]["table"][1].to_string(), "[1.0, 0.0, 0.0, 4.0]");
    assert!(import.left_out.iter().all(|entry| entry.severity != Severity::Missing), "{:#?}", import.left_out);
    // What cannot be coupled is told.
    let other =
        cube("*NODE\n20, 0, 0, 2\n*COUPLING, REF NODE=20, SURFACE=Lid\n*KINEMATIC\n3\n*STEP\n*STATIC\n*END STEP\n");
    assert_eq!(entry(&other, "*COUPLING").severity, Severity::Missing);
}

/// A bolt of two elements is cut between them: its nodes there are twice in the mesh, and every pair has three equations.
#[test]
fn a_pretension_cuts_the_mesh() {
    let import = cube(
        "*NODE\n9, 0, 0, 2\n10, 1, 0, 2\n11, 1, 1, 2\n12, 0, 1, 2\n20, 0, 0, 0\n*ELEMENT, TYPE=C3D8, ELSET=Cube\n2, 5, 6, 7, 8, 9, 10, 11, 12\n\
         *SURFACE, NAME=Cut\n1, S2\n*PRE-TENSION SECTION, SURFACE=Cut, NODE=20\n0, 0, -1\n*BOUNDARY\nBase, 1, 3\n9, 1, 3\n10, 1, 3\n11, 1, 3\n12, 1, 3\n\
         *STEP\n*STATIC\n*CLOAD\n20, 1, 3.0\n*END STEP\n",
    );
    assert_eq!(strings(&tables(&import, "body"), "name").len(), 2);
    let mesh = import.mesh.as_ref().unwrap();
    let middle: Vec<u32> = (0..mesh.nodes.len() as u32).filter(|&n| mesh.nodes[n as usize][2] == 1.0).collect();
    assert_eq!((middle.len(), mesh.nodes.len()), (8, 16));
    let equations = tables(&import, "equation");
    assert_eq!(equations.len(), 12);
    let along: Vec<String> = equations
        .iter()
        .filter_map(|table| table["terms"].as_array().filter(|t| t.len() == 3))
        .map(|t| t[0].to_string() + &t[2].to_string())
        .collect();
    assert_eq!(along.len(), 4);
    // The copy is on the side of the second element, and the given normal points the other way.
    let copied = |text: &str| text.contains("direction = [0.0, 0.0, -1.0]") && text.contains("set = \"node-20.all\"");
    assert!(along.iter().all(|text| copied(text)), "{along:?}");
    assert_eq!(entry(&import, "*PRE-TENSION SECTION").severity, Severity::Note);
}

#[test]
fn springs_dashpots_and_masses() {
    let import = cube(
        "*NODE\n20, 0, 0, 3\n*ELEMENT, TYPE=SPRINGA, ELSET=rods\n91, 5, 20\n*SPRING, ELSET=rods\n\n100.0\n*ELEMENT, TYPE=DASHPOTA, ELSET=pots\n92, 5, 20\n\
         *DASHPOT, ELSET=pots\n\n2.0\n*ELEMENT, TYPE=SPRING1, ELSET=feet\n93, 6\n*SPRING, ELSET=feet\n2\n7.0\n*ELEMENT, TYPE=MASS, ELSET=load\n94, 7\n\
         *MASS, ELSET=load\n0.5\n*BOUNDARY\nBase, 1, 3\n20, 1, 3\n*STEP\n*DYNAMIC\n0.1, 1.0\n*END STEP\n",
    );
    let springs = tables(&import, "spring");
    assert_eq!(springs.iter().map(|s| s["stiffness"].as_float()).collect::<Vec<_>>(), [Some(100.0), Some(0.0)]);
    assert_eq!(springs[1]["damping"].as_float(), Some(2.0));
    assert!(springs[0]["between"][1].as_str() == Some("node-20"));
    let [support] = tables(&import, "support").try_into().unwrap();
    assert_eq!(support["stiffness"].to_string(), "[0.0, 7.0, 0.0]");
    let masses = tables(&import, "mass");
    assert_eq!(strings(&masses, "name"), ["node-20", "mass"]);
    assert_eq!((masses[1]["mass"].as_float(), masses[1]["at"].to_string()), (Some(0.5), "[1.0, 1.0, 1.0]".to_owned()));
    assert_eq!(strings(&tables(&import, "joint"), "kind"), ["ball"]);
    assert!(import.left_out.iter().all(|entry| entry.severity != Severity::Missing), "{:#?}", import.left_out);
}

/// A pair with another friction in a later step is two contacts that take turns; one that is removed ends.
#[test]
fn contacts_that_steps_change() {
    let changed = PRESS.replace(
        "*END STEP",
        "*END STEP\n*STEP\n*STATIC\n*CHANGE FRICTION, INTERACTION=dry\n*FRICTION\n0.5, 2000.0\n*END STEP\n*STEP\n*STATIC\n*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nslave, master\n*END STEP",
    );
    let import = imported(&changed);
    let contacts = tables(&import, "contact");
    let mu: Vec<_> = contacts.iter().map(|contact| contact["friction"]["mu"].as_float()).collect();
    assert_eq!(
        (mu, strings(&contacts, "name")),
        (vec![Some(0.3), Some(0.5)], vec!["contact-1".to_owned(), "contact-2".to_owned()])
    );
    // The stick slope of CalculiX; without one stick is exact.
    let stick: Vec<_> =
        contacts.iter().map(|contact| contact["friction"].get("penalty").and_then(toml::Value::as_float)).collect();
    assert_eq!(stick, [None, Some(2000.0)]);
    let off: Vec<String> = tables(&import, "stage").iter().map(|stage| stage["off"].to_string()).collect();
    assert_eq!(off, ["[\"contact-2\"]", "[\"contact-1\"]", "[\"contact-1\", \"contact-2\"]"]);
}

/// Reference points of an assembly have numbers that nodes of parts may have too; lines name them by sets.
#[test]
fn reference_points_of_an_assembly() {
    let part = CUBE.split("*MATERIAL").next().unwrap();
    let materials = &CUBE[part.len()..CUBE.find("*SOLID SECTION").unwrap()];
    let deck = format!(
        "*PART, NAME=P\n{part}*SOLID SECTION, ELSET=Cube, MATERIAL=steel\n*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n\
         *NODE\n1, 0.5, 0.5, 3\n*NSET, NSET=RP\n1,\n*COUPLING, CONSTRAINT NAME=c, REF NODE=RP, SURFACE=Lid\n*KINEMATIC\n*END ASSEMBLY\n{materials}\
         *BOUNDARY\nBase, 1, 3\n*STEP\n*STATIC\n*CLOAD\nRP, 3, 2.0\n*END STEP\n"
    );
    let import = imported(&deck);
    let [rigid] = tables(&import, "rigid").try_into().unwrap();
    assert_eq!((rigid["name"].as_str(), rigid["position"].to_string()), (Some("node-1"), "[0.5, 0.5, 3.0]".to_owned()));
    let [load] = tables(&import, "load").try_into().unwrap();
    assert_eq!(load["set"].as_str(), Some("node-1.all"));
    assert!(import.left_out.iter().all(|entry| entry.severity != Severity::Missing), "{:#?}", import.left_out);
}
