//! What a scene says of general contact and what becomes of it: nothing is ignored in silence.

use super::general_contact::try_build;
use crate::support::{problem_keys, simulation};

const EM: &str = "kind = \"dynamic\"\n[time]\nend = 1.0\nstep = 0.02\nintegrator = { scheme = \"energy-momentum\" }\n";
const STATICS: &str = "kind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.5\n";

fn block(name: &str, min: [f64; 3], max: [f64; 3]) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {min:?}, max = {max:?}, divisions = [2, 2, 2] }}\n\
         material = {{ law = \"neo-hooke\", young = 100.0, poisson = 0.3 }}\ndensity = 1.0\n"
    )
}

fn scene(time: &str, bodies: &str) -> String {
    format!("[scene]\ntitle = \"table\"\n{time}{bodies}")
}

fn refused(text: &str) -> String {
    try_build(text).err().unwrap_or_else(|| panic!("not refused:\n{text}"))
}

/// Two cubes with a gap of 0.2.
fn apart() -> String {
    block("a", [0.0; 3], [1.0; 3]) + &block("b", [0.0, 0.0, 1.2], [1.0, 1.0, 2.2]) + "velocity = [0, 0, -0.5]\n"
}

#[test]
fn what_contradicts_itself_is_refused() {
    for (table, expected) in [
        (
            "pairs = [{ between = [\"a\", \"b\"], friction = 0.1 }, { between = [\"b\", \"a\"], friction = 0.5 }]",
            "general_contact.pairs[1].between = b, a: is the pair of general_contact.pairs[0]; keep one of the two",
        ),
        (
            "exclude = [\"b\"]\npairs = [{ between = [\"a\", \"b\"], friction = 0.1 }]",
            "`b` takes no part in general contact",
        ),
        (
            "include = [\"b\"]\npairs = [{ between = [\"b\", \"a\"], friction = 0.1 }]",
            "`a` takes no part in general contact",
        ),
        ("self = false\npairs = [{ between = [\"a\", \"a\"], friction = 0.1 }]", "or set `self = true`"),
        ("thickness = 1e-9", "is less than 1e-4 of the shortest edge, 5.000e-1"),
        ("thickness = 1e-300", "choose at least 5.000e-5; if it is left out it is 2.000e-2"),
    ] {
        let message = refused(&scene(EM, &(apart() + &format!("[general_contact]\n{table}\n"))));
        assert!(message.contains(expected), "{table}: {message}");
    }
    let named = "[general_contact]\n[[contact]]\nname = \"general\"\nmethod = \"nts\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n";
    assert_eq!(problem_keys(&scene(EM, &(apart() + named))), ["contact[0].name"]);
    let alone = try_build(&scene(EM, &(apart() + "[general_contact]\ninclude = [\"b\"]\nself = false\n"))).unwrap();
    assert!(alone.warnings.iter().any(|w| w.contains("no two bodies can come into contact")), "{:?}", alone.warnings);
    let both = try_build(&scene(EM, &(apart() + "[general_contact]\nself = false\nthickness = 5e-5\n"))).unwrap();
    assert!(both.warnings.is_empty(), "{:?}", both.warnings);
}

#[test]
fn a_body_inside_another_is_refused_whatever_is_paired() {
    let nested = block("a", [0.0; 3], [1.0; 3]) + &block("b", [0.25; 3], [0.7; 3]);
    for more in [
        "[general_contact]\nexclude = [\"a.back\"]\n",
        "[general_contact]\n[[contact]]\nmethod = \"nts\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n",
    ] {
        let message = refused(&scene(EM, &format!("{nested}{more}")));
        assert!(message.contains("one of `a` and `b` lies inside the other"), "{message}");
    }
    let beside = nested
        .replace("min = [0.25, 0.25, 0.25], max = [0.7, 0.7, 0.7]", "min = [1.25, 0.25, 0.25], max = [1.7, 0.7, 0.7]");
    assert!(try_build(&scene(EM, &format!("{beside}[general_contact]\nexclude = [\"a.back\"]\n"))).is_ok());
}

/// Surfaces in common planes: no edge goes through a facet, and yet the bodies do not only touch.
#[test]
fn bodies_in_each_other_are_not_called_touching() {
    let low = block("a", [0.0; 3], [1.0; 3]);
    let floor = block("a", [-0.5; 3], [0.5; 3])
        + "[[rigid]]\nname = \"b\"\nshape = { kind = \"plane\", size = [3, 3] }\nfixed = true\n";
    let high = low.clone() + &block("b", [0.0, 0.0, 0.5], [1.0, 1.0, 1.5]);
    let contact = "[[contact]]\nmethod = \"nts\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n[general_contact]\n";
    for text in [scene(EM, &floor), scene(EM, &(high.clone() + contact))] {
        let message = refused(&text);
        assert!(message.contains("`a` and `b` overlap at the start, near"), "{message}");
    }
    let message = refused(&scene(EM, &(high + "[general_contact]\ninitial = \"separate\"\n")));
    assert!(message.contains("no motion of `a` by 2.500e-1 and of `b` by 2.500e-1, a quarter"), "{message}");
}

/// A block that is pressed on another one and drawn over it.
fn drawn(friction: &str, general: &str) -> String {
    scene(
        STATICS,
        &(block("a", [0.0; 3], [2.0, 2.0, 1.0])
            + &block("b", [0.3, 0.3, 1.0], [1.7, 1.7, 2.0])
            + "[[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
               [[prescribe]]\nset = \"b.top\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = { table = [[0, 0, 0, 0], [1, 0.6, 0, -0.1]] }\n\
               [[contact]]\nmethod = \"nts\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nedges = \"general\"\n"
            + friction
            + general),
    )
}

#[test]
fn edges_of_a_contact_have_its_friction() {
    let coefficient = |friction: &str, general: &str| {
        let built = try_build(&drawn(friction, general)).unwrap_or_else(|e| panic!("{e}"));
        let plan = built.contacts.iter().find(|plan| plan.name == "general").unwrap();
        (plan.friction.as_ref().map(|friction| friction.to_string()), built.warnings)
    };
    let coulomb = "friction = { law = \"coulomb\", mu = 0.5 }\n";
    let (plan, warnings) = coefficient(coulomb, "");
    assert!(plan.as_deref().is_some_and(|plan| plan.contains("mu of a and b = 0.5")), "{plan:?}");
    assert!(warnings.is_empty(), "{warnings:?}");
    // The bodies' own coefficient in the table comes first.
    let pairs = "[general_contact]\npairs = [{ between = [\"a\", \"b\"], friction = 0.1 }]\n";
    assert!(coefficient(coulomb, pairs).0.is_some_and(|plan| plan.contains("mu of a and b = 0.1")));
    assert_eq!(coefficient("", "").0, None);
    let falling = "friction = { law = \"static-dynamic\", mu_static = 0.5, mu_dynamic = 0.3, speed = 1.0 }\n";
    let (plan, warnings) = coefficient(falling, "");
    let said = "static-dynamic (mu_dynamic of a and b = 0.3, mu_static of a and b = 0.5, speed of a and b = 1";
    assert!(plan.as_deref().is_some_and(|plan| plan.contains(said)), "{plan:?}");
    assert!(warnings.is_empty(), "{warnings:?}");
    let plan = coefficient(falling, pairs).0.unwrap();
    assert!(plan.contains("coulomb (mu of a and b = 0.1)") && !plan.contains("static"), "{plan}");
    // Drawn force over pressing force.
    let ratio = |friction: &str, edges: &str| {
        let text = drawn(friction, "[[probe]]\nname = \"f\"\nset = \"b.top\"\nquantity = \"reaction\"\n");
        let text = text.replace("edges = \"general\"\n", edges).replace("step = 0.5", "step = 0.1");
        let mut simulation = simulation(&text);
        while !simulation.finished() {
            simulation.advance().unwrap_or_else(|e| panic!("{e}"));
        }
        let top = try_build(&text).unwrap().probes[0].value(&simulation);
        top[0] / -top[2]
    };
    let edges = "edges = \"general\"\n";
    let (shared, alone, without) = (ratio(coulomb, edges), ratio(coulomb, ""), ratio("", edges));
    assert!((shared / alone - 1.0).abs() < 0.1 && without.abs() < 0.1 * alone, "{shared} {alone} {without}");
}

#[test]
fn schemes_that_gain_energy_in_impacts_have_no_general_contact() {
    for scheme in ["newmark", "wbz"] {
        let text = scene(&EM.replace("energy-momentum", scheme), &apart());
        let built = try_build(&text).unwrap_or_else(|e| panic!("{e}"));
        assert!(built.contacts.is_empty(), "{scheme}");
        assert!(built.warnings.iter().any(|w| w.contains("`a` and `b` have no contact")), "{:?}", built.warnings);
        assert_eq!(problem_keys(&(text + "[general_contact]\n")), ["time.integrator.scheme"]);
    }
    for scheme in ["energy-momentum", "backward-euler"] {
        let mut simulation = simulation(&scene(&EM.replace("energy-momentum", scheme), &apart()));
        let start = simulation.balance().total();
        let mut touched = 0;
        while !simulation.finished() {
            let record = simulation.advance().unwrap_or_else(|e| panic!("{e}"));
            touched += usize::from(record.contact.unwrap().bodies.iter().any(|pair| pair.active > 0));
            let change = record.balance.total() / start - 1.0;
            let allowed = if scheme == "backward-euler" { -1.0..1e-12 } else { -1e-12..1e-12 };
            assert!(allowed.contains(&change), "{scheme}: {change:e}");
        }
        assert!(touched > 3, "{scheme}");
    }
}

/// A body on a rigid box that it touches: their surfaces are inset, and forces count where the surface is.
#[test]
fn forces_count_on_the_surface_that_is_touched() {
    let text = scene(
        STATICS,
        &(block("s", [-0.37, -0.41, 0.0], [0.63, 0.59, 1.0])
            + "[[rigid]]\nname = \"d\"\nshape = { kind = \"box\", size = [2, 2, 1], divisions = [6, 6, 2] }\nposition = [0, 0, -0.5]\nfixed = true\n\
               [[prescribe]]\nset = \"s.top\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = { table = [[0, 0, 0, 0], [1, 0.01, 0, -0.02]] }\n\
               [general_contact]\nfriction = 0.3\n\
               [[probe]]\nname = \"reaction\"\nset = \"s.top\"\nquantity = \"reaction\"\n\
               [[probe]]\nname = \"moment\"\nset = \"s.top\"\nquantity = \"reaction_moment\"\n"
            + &["s.bottom", "s.top", "s.all", "d.top", "d.bottom", "d.boundary"]
                .map(|set| {
                    ["force", "moment"]
                        .map(|what| {
                            format!(
                                "[[probe]]\nname = \"{set}_{what}\"\nset = \"{set}\"\nquantity = \"contact_{what}\"\n"
                            )
                            .replace(&format!("name = \"{set}"), &format!("name = \"{}", set.replace('.', "_")))
                        })
                        .concat()
                })
                .concat()
            + "[[probe]]\nname = \"most\"\nset = \"d.bottom\"\nquantity = \"contact_force\"\nreduce = \"max\"\n\
               [[probe]]\nname = \"least\"\nset = \"d.top\"\nquantity = \"contact_force\"\ncomponent = \"z\"\nreduce = \"min\"\n"),
    );
    let probes = try_build(&text).unwrap_or_else(|e| panic!("{e}")).probes;
    let mut simulation = simulation(&text);
    while !simulation.finished() {
        simulation.advance().unwrap_or_else(|e| panic!("{e}"));
    }
    let value = |name: &str| probes.iter().find(|probe| probe.name == name).unwrap().value(&simulation);
    let (reaction, moment) = (value("reaction"), value("moment"));
    let size = reaction[2].abs();
    assert!(size > 1.0, "{size}");
    let same = |name: &str, expected: [f64; 3], allowed: f64| {
        let found = value(name);
        let error = (0..3).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(error < allowed * size, "{name}: {found:?} {expected:?}");
    };
    let minus = |x: [f64; 3]| x.map(|x| -x);
    for set in ["s_bottom", "s_all"] {
        same(&format!("{set}_force"), minus(reaction), 1e-8);
        same(&format!("{set}_moment"), minus(moment), 1e-8);
    }
    for set in ["d_top", "d_boundary"] {
        same(&format!("{set}_force"), reaction, 1e-8);
        same(&format!("{set}_moment"), moment, 1e-8);
    }
    for set in ["s_top", "d_bottom"] {
        same(&format!("{set}_force"), [0.0; 3], 1e-12);
        same(&format!("{set}_moment"), [0.0; 3], 1e-12);
    }
    assert!(value("most")[0] < 1e-12 * size);
    // The body presses down, nowhere up.
    assert!(value("least")[0] < -0.05 * size);
}

fn failure(text: &str) -> String {
    let mut simulation = simulation(text);
    while !simulation.finished() {
        if let Err(error) = simulation.advance() {
            return error.to_string();
        }
    }
    panic!("came to its end:\n{text}")
}

#[test]
fn failures_say_what_is_in_the_way() {
    let whole = |name: &str, to: &str| {
        format!(
            "[[prescribe]]\nset = \"{name}.all\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = {{ table = [[0, 0, 0, 0], {to}] }}\n"
        )
    };
    let pushed = scene(
        &EM.replace("0.02\n", "0.1\nmax_cuts = 2\n"),
        &(block("a", [0.0; 3], [1.0; 3])
            + &block("b", [0.0, 0.0, 1.1], [1.0, 1.0, 2.1])
            + &whole("a", "[1, 1, 0, 0]")
            + &whole("b", "[1, 0, 0, -0.6]")),
    );
    let message = failure(&pushed);
    assert!(
        message
            .contains("prescribed motion is blocked by surfaces that would pass through each other, nearest at node"),
        "{message}"
    );
    assert!(message.contains("of body a at") && message.contains("of body b at"), "{message}");
    assert!(message.contains("the motion of all surfaces there is prescribed"), "{message}");
    // Contact alone holds it down, and it only touches: it comes to its end; pulled up it does not.
    let loose = scene(
        STATICS,
        &(block("s", [-0.5, -0.5, 0.0], [0.5, 0.5, 0.2])
            + "[[rigid]]\nname = \"floor\"\nshape = { kind = \"plane\", size = [2, 2] }\nfixed = true\n\
               [[load]]\nname = \"p\"\nset = \"s.top\"\npressure = { table = [[0, 0], [1, 1]] }\n\
               [[prescribe]]\nset = \"s.left\"\ncomponents = [\"x\"]\nfixed = true\n[[prescribe]]\nset = \"s.front\"\ncomponents = [\"y\"]\nfixed = true\n[general_contact]\n"),
    );
    let message = failure(&loose.replace("[1, 1]", "[1, -1]"));
    assert!(message.contains("singular") && message.contains("`stabilise`"), "{message}");
    let warnings = try_build(&loose).unwrap().warnings;
    assert!(
        warnings
            .iter()
            .any(|w| w.contains("only general contact can prevent 1 of 6 rigid motions") && w.contains("`stabilise`")),
        "{warnings:?}"
    );
    let held = loose.replace("step = 0.5\n", "step = 0.5\nstabilise = { fraction = 0.01 }\n");
    assert!(try_build(&held).unwrap().warnings.is_empty());
}

/// Two plates that run into each other much too fast for the step.
#[test]
fn steps_that_are_much_too_long_end_soon() {
    let plate = |name: &str, z: f64, speed: f64| {
        block(name, [-1.0, -1.0, z], [1.0, 1.0, z + 0.1]).replace("[2, 2, 2]", "[8, 8, 1]").replace("100.0", "10.0")
            + &format!("velocity = [{}, 0, {speed:?}]\n", if speed < 0.0 { 0.3 } else { 0.0 })
    };
    let text = scene(
        &EM.replace("1.0\nstep = 0.02\n", "20.0\nstep = 5\nmax_cuts = 0\n"),
        &(plate("p", 0.0, 5.0) + &plate("q", 0.5, -5.0)),
    );
    let message = failure(&text);
    // Whichever comes first: too many pairs to look at, or an iteration that ends where bodies pass each other or are crushed.
    let told = [
        "moved past so many facets",
        "move by much more than the thickness of the layer",
        "deform too much for one step",
    ];
    assert!(told.iter().any(|part| message.contains(part)), "{message}");
}

/// Two rigid bodies need no modulus where gravity gives one, or where the table has one for all.
#[test]
fn rigid_pairs_have_a_modulus() {
    let rigid = |name: &str, z: f64, more: &str| {
        format!(
            "[[rigid]]\nname = \"{name}\"\nshape = {{ kind = \"box\", size = [1, 1, 0.5], divisions = [2, 2, 1] }}\nposition = [4, 0, {z:?}]\n{more}\n"
        )
    };
    let both =
        block("a", [0.0; 3], [1.0; 3]) + &rigid("floor", 0.0, "fixed = true") + &rigid("r", 0.55, "density = 2.0");
    let gravity = "[gravity]\nacceleration = [0, 0, -10]\n";
    let pass = |more: &str| {
        let built = try_build(&scene(EM, &(both.clone() + more))).unwrap();
        built
            .warnings
            .iter()
            .any(|w| w.contains("`floor` and `r` pass through each other") && w.contains("modulus = 1e6 (a pressure)"))
    };
    assert!(pass("[general_contact]\n"));
    assert!(!pass(&(gravity.to_owned() + "[general_contact]\n")));
    assert!(!pass("[general_contact]\nmodulus = 1e4\n"));
    // It rests on the floor: the layer keeps 0.93 of its thickness, of which the gap is a part more than the start's.
    let text = scene(&EM.replace("0.02", "0.01"), &(both.clone() + gravity + "[general_contact]\nthickness = 0.02\n"));
    let mut run = simulation(&text);
    let mut least = f64::INFINITY;
    while !run.finished() {
        let record = run.advance().unwrap_or_else(|e| panic!("{e}"));
        least = record.contact.unwrap().bodies.iter().map(|pair| pair.distance).fold(least, f64::min);
    }
    assert!(least > 0.0 && least < 0.02, "{least}");
}
