//! What an input file says beside the mesh.

use proptest::prelude::*;
use stoss_mesh_io::MeshIoError;
use stoss_mesh_io::deck::{
    ChangeKind, Deck, DeckPlace, Elastic, Following, Friction, LoadKind, Prescribed, Procedure, Target, Times,
    read_deck, read_deck_from_bytes,
};

const MESH: &str = "\
*HEADING
 punch on a block
 second line
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=Block
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=Foot
1, 2, 3, 4
";

const MODEL: &str = "\
*MATERIAL, NAME=Steel
*DENSITY
7.8E-9,
*ELASTIC, TYPE=ISO
210000., 0.3, 20.
190000., 0.3, 400.
*PLASTIC
300., 0.
350., 0.02
*Expansion
1.2e-5
*Material, name=\"My rubber\"
*Hyperelastic, Mooney-Rivlin
0.8, 0.2, 1D-3
*DENSITY
1e-9
*SOLID SECTION, ELSET=Block, MATERIAL=Steel, ORIENTATION=O
*AMPLITUDE, NAME=ramp, TIME=TOTAL TIME
0., 0., 0.5, 1.,
1., 1.
*SURFACE INTERACTION, NAME=dry
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1e5, , 2.
*FRICTION
0.3, 5e4
*CONTACT PAIR, INTERACTION=dry, TYPE=SURFACE TO SURFACE, ADJUST=0.01
Slave, Master
*TIE, NAME=glue, POSITION TOLERANCE=0.1, ADJUST=NO
A, B
*INITIAL CONDITIONS, TYPE=VELOCITY
Block-1.7, 3, -2.5
*INITIAL CONDITIONS, TYPE=TEMPERATURE
Foot, 20.
*BOUNDARY
Foot, ENCASTRE
4, 2, 3, 0.5
Foot, 11, 11, 300.
8, 11
*EQUATION
2
1,1,1.,2,1,-1.
";

const STEPS: &str = "\
*STEP, NLGEOM, INC=50, NAME=press
*STATIC, DIRECT
0.1, 1., , 0.2
*BOUNDARY, AMPLITUDE=ramp, TYPE=VELOCITY
7, XSYMM
7, 3, , -4
*CLOAD, AMPLITUDE=ramp
5, 2, -10.
Foot, 4, 1.
*DLOAD
Block, P2, 3.5
Block, GRAV, 9810., 0., 0., -1.
, CENTRIF, 100., 1., 2., 3., 0., 0., 1.
1, BY, 2.
Block, P2NU, 1.
*DSLOAD
Top, P, 7.
Top, TRVEC, 1., 1., 0., 0.
*NODE PRINT, NSET=Foot
U
*END STEP
*STEP
*DYNAMIC, ALPHA=-0.05
1e-3, 2.
*BOUNDARY, OP=NEW
*CLOAD, OP=MOD
6, 1, 2.
*ENDSTEP
*STEP, PERTURBATION
*FREQUENCY
10
*END STEP
";

fn read(text: &str) -> Result<Deck, MeshIoError> {
    read_deck_from_bytes("part.inp", text.as_bytes(), &mut |_| Err(std::io::ErrorKind::NotFound.into()))
}

fn set(name: &str) -> Target {
    Target::Set(name.to_owned())
}

#[test]
fn what_a_deck_says_is_kept() {
    let deck = read(&format!("{MESH}{MODEL}{STEPS}")).unwrap();
    assert_eq!(deck.contents.mesh(None).unwrap().elements.len(), 1);
    assert_eq!(deck.title.as_deref(), Some("punch on a block"));

    let [steel, rubber] = deck.materials.as_slice() else { panic!("{:?}", deck.materials) };
    assert_eq!((steel.name.as_str(), steel.density), ("Steel", Some(7.8e-9)));
    assert_eq!(steel.plastic, [[0.0, 300.0], [0.02, 350.0]]);
    assert_eq!(steel.elastic, Some(Elastic { modulus: 210_000.0, ratio: 0.3 }));
    assert_eq!((rubber.name.as_str(), rubber.density, rubber.elastic), ("My rubber", Some(1e-9), None));
    let law = rubber.hyperelastic.as_ref().unwrap();
    assert_eq!((law.law.as_str(), law.terms, law.coefficients.as_slice()), ("MOONEY-RIVLIN", 1, &[0.8, 0.2, 1e-3][..]));
    let section = &deck.sections[0];
    assert_eq!((section.elements.as_str(), section.material.as_str()), ("Block", "Steel"));
    let amplitude = &deck.amplitudes[0];
    assert!(amplitude.is_total_time && amplitude.name == "ramp");
    assert_eq!(amplitude.points, [[0.0, 0.0], [0.5, 1.0], [1.0, 1.0]]);

    let dry = &deck.interactions[0];
    assert_eq!(dry.friction, Some(Friction { coefficient: 0.3, stick_slope: Some(5e4) }));
    let behavior = dry.behavior.as_ref().unwrap();
    assert_eq!((behavior.law.as_str(), behavior.values.as_slice()), ("LINEAR", &[vec![1e5, 2.0]][..]));
    let pair = &deck.pairs[0];
    assert_eq!(
        (pair.slave.as_str(), pair.master.as_str(), pair.interaction.as_deref()),
        ("Slave", "Master", Some("dry"))
    );
    assert_eq!((pair.kind.as_deref(), pair.adjust.as_deref()), (Some("SURFACE TO SURFACE"), Some("0.01")));
    let tie = &deck.ties[0];
    assert_eq!((tie.name.as_deref(), tie.slave.as_str(), tie.master.as_str()), (Some("glue"), "A", "B"));
    assert_eq!((tie.tolerance, tie.adjusts), (Some(0.1), false));

    let velocity = &deck.velocities[0];
    assert_eq!((velocity.component, velocity.value), (2, -2.5));
    assert_eq!(velocity.nodes, Target::Number { number: 7, instance: Some("Block-1".to_owned()) });
    let supports: Vec<_> = deck.supports.iter().map(|s| (s.nodes.clone(), s.freedoms, s.value)).collect();
    let four = Target::Number { number: 4, instance: None };
    assert_eq!(supports, [(set("Foot"), [true; 6], 0.0), (four, only(&[1, 2]), 0.5)]);
    // places
    assert_eq!(steel.place, DeckPlace { file: 0, line: 17 });
    assert_eq!(deck.place_name(deck.supports[1].place), "part.inp:52");
    assert_eq!(deck.files().len(), 1);
}

#[test]
fn steps_are_kept() {
    let deck = read(&format!("{MESH}{MODEL}{STEPS}")).unwrap();
    let [press, swing, modes] = deck.steps.as_slice() else { panic!("{:?}", deck.steps) };
    assert_eq!((press.name.as_deref(), press.is_nonlinear, press.increments), (Some("press"), true, Some(50)));
    let times = Times { initial: Some(0.1), period: Some(1.0), smallest: None, largest: Some(0.2), is_fixed: true };
    assert_eq!(press.procedure, Some(Procedure::Static(times)));
    let supports: Vec<_> = press.supports.iter().map(|s| (s.freedoms, s.value, s.prescribed)).collect();
    let velocity = Prescribed::Velocity;
    assert_eq!(supports, [(only(&[0, 4, 5]), 0.0, velocity), (only(&[2]), -4.0, velocity)]);
    assert!(press.supports.iter().all(|s| s.amplitude.as_deref() == Some("ramp")));
    let forces: Vec<_> = press.forces.iter().map(|force| force.freedom).collect();
    assert_eq!((forces, press.forces[0].value), (vec![1, 3], -10.0));
    let loads: Vec<_> = press.loads.iter().map(|load| (load.elements.clone(), load.kind)).collect();
    assert_eq!(
        loads,
        [
            (set("Block"), LoadKind::Pressure { face: 1, value: 3.5 }),
            (set("Block"), LoadKind::Gravity { magnitude: 9810.0, direction: [0.0, 0.0, -1.0] }),
            (Target::All, LoadKind::Centrifugal { squared: 100.0, point: [1.0, 2.0, 3.0], axis: [0.0, 0.0, 1.0] }),
            (Target::Number { number: 1, instance: None }, LoadKind::Body { component: 1, value: 2.0 }),
        ]
    );
    assert_eq!((press.pressures.len(), press.pressures[0].surface.as_str(), press.pressures[0].value), (1, "Top", 7.0));
    assert!(!press.op_new.supports);

    let times = Times { initial: Some(1e-3), period: Some(2.0), ..Times::default() };
    assert_eq!(swing.procedure, Some(Procedure::Dynamic { times, alpha: Some(-0.05), is_explicit: false }));
    assert!(swing.op_new.supports && !swing.op_new.forces && !swing.is_nonlinear && swing.supports.is_empty());
    assert_eq!(swing.forces.len(), 1);
    assert!(modes.is_perturbation);
    assert_eq!(modes.procedure, Some(Procedure::Other("FREQUENCY".to_owned())));
}

/// What is not kept is reported, with its line, and equal things in a row once.
#[test]
fn what_is_left_out_is_told() {
    let deck = read(&format!("{MESH}{MODEL}{STEPS}")).unwrap();
    let found: Vec<(String, usize, bool)> =
        deck.left_out.iter().map(|l| (l.what.clone(), l.place.line, l.changes_results)).collect();
    let expected = [
        ("all lines of *ELASTIC but the first", 20, true),
        ("*EXPANSION", 26, true),
        ("parameter ORIENTATION of *SOLID SECTION", 33, true),
        ("*INITIAL CONDITIONS, TYPE=TEMPERATURE", 48, true),
        ("degree of freedom 11 of *BOUNDARY", 53, true),
        ("load P2NU of *DLOAD", 72, true),
        ("load TRVEC of *DSLOAD", 75, true),
        ("*NODE PRINT", 76, false),
        ("*FREQUENCY", 87, true),
    ];
    let expected: Vec<(String, usize, bool)> =
        expected.map(|(what, line, real)| (what.to_owned(), line, real)).to_vec();
    assert_eq!(found, expected);

    for (text, what) in [
        ("*BOUNDARY, SUBMODEL\n1, 1\n", "*BOUNDARY with the parameter SUBMODEL"),
        ("*BOUNDARY, TYPE=MAGIC\n1, 1\n", "*BOUNDARY, TYPE=MAGIC"),
        ("*CLOAD\n1, 1, 2.\n", "*CLOAD outside of a step"),
        ("*STATIC\n", "*STATIC outside of a step"),
        ("*TIE, CYCLIC SYMMETRY, NAME=t\na, b\n", "*TIE with the parameter CYCLICSYMMETRY"),
        ("*AMPLITUDE, NAME=a, DEFINITION=PERIODIC\n1,2\n", "*AMPLITUDE, DEFINITION=PERIODIC"),
        ("*AMPLITUDE, NAME=a, USER\n", "*AMPLITUDE with the parameter USER"),
        ("*MATERIAL, NAME=m\n*ELASTIC, TYPE=ORTHO\n1,2,3,4,5,6,7,8,\n9\n", "*ELASTIC, TYPE=ORTHO"),
        ("*DENSITY\n1.\n", "*DENSITY"),
        ("*MATERIAL, NAME=m\n*HYPERELASTIC, TEST DATA INPUT\n", "*HYPERELASTIC, TEST DATA INPUT"),
        ("*SURFACE INTERACTION, NAME=i\n*FRICTION, TAUMAX=3.\n0.1\n", "parameter TAUMAX of *FRICTION"),
        ("*SUBMODEL, INPUT=none.frd\n1\n", "*SUBMODEL"),
        ("*BOUNDARY\n1, 0, 0, 5.\n", "degree of freedom 0 of *BOUNDARY"),
        ("*NONSENSE\n1\n", "*NONSENSE"),
    ] {
        let deck = read(&format!("{MESH}{text}")).unwrap();
        let found: Vec<&str> = deck.left_out.iter().map(|l| l.what.as_str()).collect();
        assert_eq!(found, [what]);
    }
}

#[test]
fn forms_of_contact_and_materials() {
    let text = "*SURFACE INTERACTION, NAME=i\n*FRICTION, ROUGH\n*SURFACE BEHAVIOR\n*CONTACT PAIR, SMALL SLIDING\nself\n\
                *MATERIAL, NAME=m\n*USER DEFINED\n*HYPERELASTIC, OGDEN, N=2\n1,2,3,4,0,0\n*HYPERELASTIC, N=2\n1,2\n";
    let deck = read(&format!("{MESH}{text}")).unwrap();
    let interaction = &deck.interactions[0];
    assert_eq!(interaction.friction, Some(Friction { coefficient: f64::INFINITY, stick_slope: None }));
    assert_eq!(interaction.behavior.as_ref().map(|b| b.law.as_str()), Some("HARD"));
    let pair = &deck.pairs[0];
    assert!(pair.is_small_sliding && pair.slave == "self" && pair.master == "self" && pair.interaction.is_none());
    // a keyword that is not known may be one of the material: what follows still belongs to it
    let law = deck.materials[0].hyperelastic.as_ref().unwrap();
    assert_eq!((law.law.as_str(), law.terms, law.coefficients.len()), ("POLYNOMIAL", 2, 2));
}

#[test]
fn errors_name_the_line() {
    for (text, line, message) in [
        ("*MATERIAL\n", 17, "needs the parameter NAME"),
        ("*MATERIAL, NAME=m\n*ELASTIC\n", 18, "needs a data line"),
        ("*MATERIAL, NAME=m\n*ELASTIC\nhard\n", 19, "\"hard\": expected Young's modulus, a finite number"),
        ("*MATERIAL, NAME=m\n*DENSITY\n,\n", 19, "expected a mass per volume"),
        ("*SOLID SECTION, ELSET=e\n", 17, "needs the parameter MATERIAL"),
        ("*AMPLITUDE, NAME=a\n0,1,2\n", 17, "pairs of a time and a value"),
        ("*CONTACT PAIR\n,b\n", 18, "a slave surface"),
        ("*TIE, NAME=a\nb\n", 18, "a master surface"),
        ("*TIE, NAME=a, POSITION TOLERANCE=x\na,b\n", 17, "a number for POSITIONTOLERANCE"),
        ("*INITIAL CONDITIONS\n", 17, "needs the parameter TYPE"),
        ("*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 1\n", 18, "expected a velocity"),
        ("*BOUNDARY\n1\n", 18, "a degree of freedom"),
        ("*BOUNDARY\n1, x\n", 18, "\"x\": expected a degree of freedom"),
        ("*BOUNDARY\n1, 3, 1\n", 18, "below the first"),
        ("*STEP, INC=many\n", 17, "a number for INC"),
        ("*STEP\n*STATIC\nnan, 1\n", 19, "\"nan\""),
        ("*STEP\n*CLOAD\n1, 1\n", 19, "expected a force"),
        ("*STEP\n*DLOAD\n1, GRAV\n", 19, "expected an acceleration"),
        ("*STEP\n*DSLOAD\n, P, 1\n", 19, "expected a surface"),
    ] {
        let error = read(&format!("{MESH}{text}")).unwrap_err().to_string();
        assert!(error.starts_with(&format!("part.inp:{line}: ")) && error.contains(message), "{error}\nfor {message}");
    }
}

/// Steps and data in files of their own; lines are those of these files.
#[test]
fn included_files() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("main.inp", &format!("{MESH}*AMPLITUDE, NAME=a, INPUT=table.txt\n*INCLUDE, INPUT=steps.inp\n"));
    write("table.txt", "0, 0\n1, 1\n");
    write("steps.inp", STEPS);
    let deck = read_deck(folder.path().join("main.inp")).unwrap();
    assert_eq!(deck.amplitudes[0].points, [[0.0, 0.0], [1.0, 1.0]]);
    assert_eq!((deck.steps.len(), deck.steps[0].place), (3, DeckPlace { file: 2, line: 1 }));
    assert!(deck.place_name(deck.steps[1].forces[0].place).ends_with("steps.inp:27"));
    assert_eq!(deck.files().len(), 3);
    write("table.txt", "0, 0\n1, one\n");
    let error = read_deck(folder.path().join("main.inp")).unwrap_err().to_string();
    assert!(error.contains("table.txt:2: \"one\""), "{error}");
    assert!(matches!(read_deck(folder.path().join("none.inp")), Err(MeshIoError::Io { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]
    /// Whatever is exchanged, a deck is read or an error names the file.
    #[test]
    fn damaged_decks_are_no_reason_to_panic(
        list in prop::collection::vec((0_usize..10_000, 0_usize..20, prop::sample::select(vec![
            "", "0", "-1", "18446744073709551615", "1e999", "nan", "x", "*", "=", "\"", "P9", "ä", "*STEP", "*MATERIAL, NAME=m", "*END STEP",
        ])), 1..6),
    ) {
        let mut lines: Vec<String> = format!("{MESH}{MODEL}{STEPS}").lines().map(str::to_owned).collect();
        for (place, field, value) in list {
            let count = lines.len();
            let line = &mut lines[place % count];
            let mut fields: Vec<&str> = line.split(',').collect();
            let count = fields.len();
            fields[field % count] = value;
            *line = fields.join(",");
        }
        match read(&lines.join("\n")) {
            Ok(deck) => prop_assert!(deck.left_out.iter().all(|l| l.place.line > 0)),
            Err(error) => prop_assert!(error.to_string().starts_with("part.inp"), "{}", error),
        }
    }
}

/// Degrees of freedom by their numbers.
fn only(freedoms: &[usize]) -> [bool; 6] {
    std::array::from_fn(|i| freedoms.contains(&i))
}

/// What joins nodes, and what steps change.
#[test]
fn connections_and_changes_are_kept() {
    let deck = read(&format!(
        "{MESH}*EQUATION\n3\n1, 1, 1.0, Foot, 2, -2.0\n7, 6, 0.5\n*MPC\nBEAM, 1, 2\n3\n*COUPLING, REF NODE=5, SURFACE=Top, CONSTRAINT NAME=c\n\
         *KINEMATIC\n1, 3\n*RIGID BODY, NSET=Foot, REF NODE=7, ROT NODE=8\n*ELEMENT, TYPE=SPRINGA, ELSET=rods\n91, 1, 7\n\
         *SPRING, ELSET=rods\n\n100.0\n*PRE-TENSION SECTION, SURFACE=Top, NODE=7\n0, 0, 2\n\
         *SURFACE INTERACTION, NAME=dry\n*FRICTION\n0.3\n*AMPLITUDE, NAME=a\n0.0, 0.0, 1.0, 2.0\n\
         *STEP\n*STATIC\n*CHANGE FRICTION, INTERACTION=dry\n*FRICTION\n0.5\n*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nA, B\n\
         *CLOAD, AMPLITUDE=a, TIME DELAY=0.5\n1, 4, 3.0\n*END STEP\n"
    ))
    .unwrap();
    let number = |number| Target::Number { number, instance: None };
    let [equation] = deck.equations.as_slice() else { panic!("{:?}", deck.equations) };
    let terms: Vec<_> = equation.terms.iter().map(|t| (t.nodes.clone(), t.freedom, t.factor)).collect();
    assert_eq!(terms, [(number(1), 0, 1.0), (set("Foot"), 1, -2.0), (number(7), 5, 0.5)]);
    assert_eq!(
        (deck.multi_points[0].kind.as_str(), deck.multi_points[0].nodes.as_slice()),
        ("BEAM", [1, 2, 3].as_slice())
    );
    let [coupling, rigid] = deck.couplings.as_slice() else { panic!("{:?}", deck.couplings) };
    assert_eq!(
        (coupling.node.clone(), coupling.following, coupling.freedoms),
        (number(5), Some(Following::Kinematic), only(&[0, 1, 2]))
    );
    assert_eq!(
        (rigid.node.clone(), rigid.rotations.clone(), rigid.following),
        (number(7), Some(number(8)), Some(Following::Kinematic))
    );
    assert_eq!(
        (deck.connections[0].kind.as_str(), deck.connections[0].nodes.as_slice()),
        ("SPRINGA", [1, 7].as_slice())
    );
    assert_eq!((deck.sections_of_connections[0].value, deck.pretensions[0].normal), (100.0, Some([0.0, 0.0, 2.0])));
    let step = &deck.steps[0];
    let kinds: Vec<_> = step.changes.iter().map(|change| change.kind.clone()).collect();
    let friction = Friction { coefficient: 0.5, stick_slope: None };
    let removed = ChangeKind::Contact { slave: "A".to_owned(), master: "B".to_owned(), acts: false };
    assert_eq!(kinds, [ChangeKind::Friction("dry".to_owned(), friction), removed]);
    assert_eq!(deck.interactions[0].friction.unwrap().coefficient, 0.3);
    assert_eq!((step.forces[0].freedom, step.forces[0].amplitude.as_deref()), (3, Some("a later by 0.5")));
    assert_eq!(deck.amplitudes[1].points, [[0.5, 0.0], [1.5, 2.0]]);
    // Nothing of it is left out.
    assert!(deck.left_out.iter().all(|left| !left.changes_results), "{:?}", deck.left_out);
    for bad in [
        "*EQUATION\n2\n1, 1, 1.0\n",
        "*EQUATION\n1\n1, 7, 1.0\n",
        "*MPC\n1, 2\n",
        "*COUPLING, SURFACE=Top\n",
        "*RIGID BODY, REF NODE=7\n",
        "*SPRING, ELSET=rods\n",
    ] {
        assert!(read(&format!("{MESH}{bad}")).is_err(), "{bad}");
    }
}
