//! What is reported about the pairs of surfaces of a scene before it runs.

use crate::support::{simulation, two_blocks};

/// Two contacts in which each surface is the slave of the other: told where neither may be penetrated, and nothing where springs hold one of them.
#[test]
fn two_contacts_with_exchanged_surfaces_are_told() {
    let warnings = |contacts: &str| {
        let text = two_blocks("backward-euler", 0.01, 1.0, [0.0; 3], "method = \"nts\"");
        let scene = stoss::scene::parse(&format!("{text}\n{contacts}"), "test.toml").unwrap();
        stoss::build::build(&scene, std::path::Path::new(".")).unwrap().warnings
    };
    let other = "[[contact]]\nmethod = \"nts\"\nslave = \"lower.top\"\nmaster = \"upper.bottom\"\nname = \"other\"\n";
    let told = warnings(other);
    assert!(told.len() == 1 && told[0].starts_with("other is ") && told[0].contains("exchanged"), "{told:?}");
    let springs = format!("{other}enforcement = {{ penalty = 1e4 }}\n");
    assert_eq!(warnings(&springs), Vec::<String>::new());
}

/// Surfaces that look past each other are reported, whichever of them is the slave; those that touch are not.
#[test]
fn surfaces_that_do_not_face_each_other_are_told() {
    let warnings = |slave: &str, master: &str, method: &str| {
        let contact = format!("slave = \"{slave}\"\nmaster = \"{master}\"\nmethod = \"{method}\"");
        let scene = two_blocks("energy-momentum", 0.1, 1.0, [0.0; 3], "")
            .replace("slave = \"upper.bottom\"\nmaster = \"lower.top\"", &contact);
        let scene = stoss::scene::parse(&scene, "test.toml").unwrap();
        stoss::build::build(&scene, std::path::Path::new(".")).unwrap().warnings
    };
    for method in ["mortar", "nts"] {
        assert_eq!(warnings("upper.bottom", "lower.top", method), Vec::<String>::new());
        assert_eq!(warnings("upper.boundary", "lower.top", method), Vec::<String>::new());
        for (slave, master) in [("upper.left", "lower.top"), ("lower.top", "upper.left"), ("upper.top", "lower.top")] {
            let told = warnings(slave, master, method);
            let is_told = told.iter().any(|warning| warning.contains("no facet of the slave faces"));
            assert!(is_told, "{method}, {slave}, {master}: {told:?}");
        }
    }
}

/// `between` leaves the choice of the slave open: not the prescribed surface, else the finer one, else the softer one, else the first.
#[test]
fn the_slave_of_between_is_chosen() {
    let text = |divisions: [usize; 2], young: [f64; 2], held: &str| {
        let body = |k: usize| {
            format!(
                "[[body]]\nname = \"{}\"\nmesh = {{ generator = \"block\", min = [0, 0, {}], max = [1, 1, {}], divisions = [{n}, {n}, 1] }}\n\
                 material = {{ law = \"neo-hooke\", young = {:?}, poisson = 0.3 }}\ndensity = 1.0\n",
                ["a", "b"][k],
                [1.1, 0.0][k],
                [2.1, 1.0][k],
                young[k],
                n = divisions[k],
            )
        };
        format!(
            "[scene]\ntitle = \"choice\"\nkind = \"dynamic\"\n[time]\nend = 0.1\nstep = 0.1\nintegrator = {{ scheme = \"energy-momentum\" }}\n{}{}\
             [[contact]]\nmethod = \"mortar\"\nbetween = [\"a.bottom\", \"b.top\"]\n{held}",
            body(0),
            body(1)
        )
    };
    let held = "[[prescribe]]\nset = \"b.all\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n";
    for (text, expected) in [
        (text([2, 4], [1e3, 1e3], held), "a.bottom (the other one is prescribed)"),
        (text([2, 4], [1e3, 1e5], ""), "b.top (finer)"),
        (text([2, 2], [1e5, 1e3], ""), "b.top (softer)"),
        (text([2, 2], [1e3, 1e3], ""), "a.bottom (both are alike)"),
    ] {
        let scene = stoss::scene::parse(&text, "choice.toml").unwrap();
        let built = stoss::build::build(&scene, std::path::Path::new(".")).unwrap();
        assert_eq!(built.contacts[0].slave.as_deref(), Some(expected));
    }
}

/// A roller of the radius 5 on a bar whose facets are 2.5 long: as a master it sinks in by `h^2 / 12 R` (theory/mortar#slave); as the slave it does not, whatever its facets.
#[test]
fn the_slave_is_the_side_that_a_round_one_sinks_into_least() {
    let text = |contact: &str, around: [u32; 2]| {
        format!(
            "[scene]\ntitle = \"roller\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n\
             [[body]]\nname = \"bar\"\nmesh = {{ generator = \"block\", min = [-10, 0, -2], max = [10, 5, 0], divisions = [8, 2, 1] }}\n\
             material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             [[body]]\nname = \"roller\"\nposition = [0.0, 0.0, 5.0]\n\
             mesh = {{ generator = \"cylinder\", radius = 5.0, length = 5.0, divisions = [{}, {}, 2, 2] }}\n\
             material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             [[prescribe]]\nset = \"bar.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
             [[contact]]\nmethod = \"mortar\"\n{contact}",
            around[0], around[1]
        )
    };
    let build = |contact: &str, around| {
        let scene = stoss::scene::parse(&text(contact, around), "roller.toml").unwrap_or_else(|e| panic!("{e}"));
        stoss::build::build(&scene, std::path::Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
    };
    let sinks = |built: &stoss::build::Built| -> Option<String> {
        built.warnings.iter().find(|warning| warning.contains("sink in")).cloned()
    };
    let depth = 2.5 * 2.5 / 12.0 / 5.0;
    let named = build("slave = \"bar.top\"\nmaster = \"roller.outer\"\n", [8, 8]);
    let told = sinks(&named).unwrap();
    assert!(told.contains(&format!("by {depth:.3}; exchange slave and master, or refine")), "{told}");
    assert!(sinks(&build("slave = \"roller.outer\"\nmaster = \"bar.top\"\n", [8, 8])).is_none());
    // With facets that are longer than those of the bar, too.
    for around in [[8, 8], [2, 1]] {
        let chosen = build("between = [\"bar.top\", \"roller.outer\"]\n", around);
        let slave = chosen.contacts[0].slave.clone().unwrap();
        assert!(slave.starts_with("roller.outer (the other one sinks in by 0.000, where it would by 0.1"), "{slave}");
        assert!(sinks(&chosen).is_none());
    }
    // Half of it with dual functions, which is not worth a word.
    assert!(
        sinks(&build("multipliers = \"dual\"\nslave = \"bar.top\"\nmaster = \"roller.outer\"\n", [8, 8])).is_none()
    );
}

/// A block falls on another one, in statics it is pressed on it. The interface is named as two pairs that share the nodes between them, as surfaces from a drawing do: their pressures are determined only
/// together, and the motion is that of one pair. (With mortar only where the interface stays flat: of a shared node each pair has a row of its own part of the gap, where one pair has one of the sum.)
#[test]
fn two_pairs_that_share_nodes_are_one() {
    let scene = |method: &str, kind: &str, pairs: &[&str]| {
        let is_static = kind == "quasi-static";
        let body = |name: &str, z: f64, velocity: f64| {
            let motion =
                if is_static { String::new() } else { format!("density = 1.0\nvelocity = [0, 0, {velocity:?}]\n") };
            format!(
                "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [-1, -1, {z:?}], max = [1, 1, {:?}], divisions = [2, 2, 1] }}\n\
                 material = {{ law = \"neo-hooke\", young = 1200.0, poisson = 0.3 }}\n{motion}",
                z + 1.0
            )
        };
        let time = match is_static {
            true => "end = 1.0\nstep = 0.5\n",
            false => "end = 0.3\nstep = 0.01\nintegrator = { scheme = \"energy-momentum\" }\n",
        };
        let held = match is_static {
            true => {
                [("low.bottom", "z"), ("low.left", "x"), ("low.front", "y"), ("up.left", "x"), ("up.front", "y")]
                    .map(|(set, axis)| {
                        format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{axis}\"]\nfixed = true\n")
                    })
                    .concat()
                    + "[[load]]\nset = \"up.top\"\npressure = 12.0\n"
            }
            false => String::new(),
        };
        let gap = if is_static { 1.0 } else { 1.05 };
        let pairs: String = pairs
            .iter()
            .map(|slave| format!("[[contact]]\nmethod = \"{method}\"\nslave = \"{slave}\"\nmaster = \"low.top\"\n"))
            .collect();
        format!("[scene]\ntitle = \"shared\"\nkind = \"{kind}\"\n[time]\n{time}")
            + &body("low", 0.0, 0.0)
            + &body("up", gap, -0.5)
            + &held
            + &pairs
    };
    for method in ["nts", "mortar"] {
        for kind in ["quasi-static", "dynamic"] {
            let ends = [&["up.bottom"][..], &["up.bottom & y <= 0", "up.bottom & y >= 0"]].map(|pairs| {
                let mut run = simulation(&scene(method, kind, pairs));
                while !run.finished() {
                    let record = run.advance().unwrap_or_else(|e| panic!("{method} {kind}: {e}"));
                    assert!(record.dt > 0.009, "{method} {kind}: a cut");
                }
                run.state().q.clone()
            });
            let off = ends[0].iter().zip(&ends[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{method} {kind}: {off:e}");
        }
    }
}
