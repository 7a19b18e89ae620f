//! Bodies that overlap at the start: they are reported, refused, or moved apart.

use crate::general_contact::{MATERIAL, cube, head, try_build};
use crate::support::simulation;
use stoss::solver::Simulation;

fn ball(name: &str, at: [f64; 3], radius: f64) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"ball\", radius = {radius:?}, divisions = [2, 2, 2] }}\nposition = {at:?}\n{MATERIAL}\n"
    )
}

#[test]
fn the_depth_of_a_crossing_is_told() {
    let plain = |x: f64, y: f64, z: f64| {
        head("energy-momentum", 0.1, 1.0)
            + &cube("a", [0.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2)
            + &cube("b", [x, y, z], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2)
            + "[general_contact]\n"
    };
    let error = try_build(&plain(0.2, 0.1, 0.9)).unwrap_err();
    assert!(error.contains("1.000e-1 deep (the way out of `a` is along (0, 0, -1))"), "{error}");
    let error = try_build(&plain(-0.97, 0.2, 0.3)).unwrap_err();
    assert!(error.contains("3.000e-2 deep (the way out of `a` is along (1, 0, 0))"), "{error}");
    let small = cube("b", [0.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2).replace("0.5", "0.1");
    let text = head("energy-momentum", 0.1, 1.0) + &cube("a", [0.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2) + &small;
    let error = try_build(&(text + "[general_contact]\n")).unwrap_err();
    assert!(error.contains("lies inside"), "{error}");
}

/// Means of the places of the nodes of bodies with so many nodes.
fn places(simulation: &Simulation, nodes: &[usize]) -> Vec<[f64; 3]> {
    let q = &simulation.state().q;
    let mut first = 0;
    let mut list = Vec::new();
    for &n in nodes {
        list.push(std::array::from_fn(|i| (first..first + n).map(|k| q[3 * k + i]).sum::<f64>() / n as f64));
        first += n;
    }
    list
}

#[test]
fn bodies_that_lie_in_each_other_are_separated() {
    let contact = "[general_contact]\nthickness = 0.01\ninitial = \"separate\"\n";
    let upright = |name: &str, at: [f64; 3]| cube(name, at, [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2);
    let fixed = "[[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n";
    let gap = 0.0101;
    // Two free blocks share the way, and nothing acts; the first of three in a row is fixed.
    let text = head("energy-momentum", 0.1, 0.5) + &upright("a", [0.0; 3]) + &upright("b", [0.2, 0.1, 0.95]) + contact;
    let mut built = try_build(&text).unwrap();
    let [a, b] = places(&built.simulation, &[27, 27])[..] else { panic!() };
    let half = 0.5 * (0.05 + gap);
    assert!((a[2] + half).abs() < 1e-5 && (b[2] - 0.95 - half).abs() < 1e-5, "{a:?} {b:?}");
    assert!((b[0] - 0.2).abs() < 1e-12 && a[0].abs() < 1e-12);
    assert!(built.bodies.iter().any(|line| line.starts_with("b: moved by 3.005e-2")), "{:?}", built.bodies);
    assert!(built.simulation.balance().total().abs() < 1e-25);
    while !built.simulation.finished() {
        let record = built.simulation.advance().unwrap();
        assert!(record.balance.strain < 1e-25 && record.contact.unwrap().bodies.is_empty());
    }
    let row = upright("a", [0.0; 3]) + &upright("b", [0.0, 0.05, 0.97]) + &upright("c", [0.1, 0.0, 1.92]);
    let built = try_build(&(head("energy-momentum", 0.1, 1.0) + &row + fixed + contact)).unwrap();
    let [a, b, c] = places(&built.simulation, &[27, 27, 27])[..] else { panic!() };
    assert!(a.iter().all(|x| x.abs() < 1e-12));
    assert!((b[2] - 1.0 - gap).abs() < 1e-5 && (c[2] - 2.0 - 2.0 * gap).abs() < 2e-5, "{b:?} {c:?}");
    // A small ball in a block that stands: the ball goes.
    let text = head("energy-momentum", 0.1, 1.0) + &upright("a", [0.0; 3]) + &ball("s", [0.1, 0.07, 0.77], 0.3) + fixed;
    let built = try_build(&(text.clone() + contact)).unwrap();
    let nodes = built.simulation.model().node_count() - 27;
    let before = try_build(&(text.replace("0.77]", "0.9]") + contact)).unwrap();
    let [s, o] = [&built, &before].map(|built| places(&built.simulation, &[27, nodes])[1]);
    assert!((s[2] - o[2] + 0.9 - 0.8 - gap).abs() < 1e-4 && (s[0] - o[0]).hypot(s[1] - o[1]) < 1e-6, "{s:?} {o:?}");
}

#[test]
fn bodies_that_cannot_be_separated_are_refused() {
    let contact = "[general_contact]\ninitial = \"separate\"\n";
    let upright = |name: &str, at: [f64; 3]| cube(name, at, [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2);
    let fixed = |body: &str| {
        format!("[[prescribe]]\nset = \"{body}.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n")
    };
    let two = |z: f64| head("energy-momentum", 0.1, 1.0) + &upright("a", [0.0; 3]) + &upright("b", [0.0, 0.0, z]);
    let both = try_build(&(two(0.95) + &fixed("a") + &fixed("b") + contact)).unwrap_err();
    assert!(both.contains("neither may be moved") && both.contains("has prescribed motion"), "{both}");
    let deep = try_build(&(two(0.6) + &fixed("a") + contact)).unwrap_err();
    assert!(deep.contains("too deep"), "{deep}");
    // Between two fixed ones there is no room.
    let between = upright("c", [0.0, 0.0, 1.9]);
    let squeezed = try_build(&(two(0.95) + &between + &fixed("a") + &fixed("c") + contact)).unwrap_err();
    assert!(squeezed.contains("there is no room") && !squeezed.contains("deep"), "{squeezed}");
}

/// Two blocks of these cells and divisions, turned as one; the lower one ends at z = 0.5, the upper one begins at `z`.
fn stack(cell: &str, divisions: [[u32; 3]; 2], rotation: &str, z: f64) -> String {
    let block = |name: &str, z: [f64; 2], n: [u32; 3]| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [-0.5, -0.5, {:?}], max = [0.5, 0.5, {:?}], divisions = {n:?} }}\ncell = \"{cell}\"\n{rotation}\n{MATERIAL}\n",
            z[0], z[1]
        )
    };
    head("energy-momentum", 0.1, 0.2)
        + &block("a", [-0.5, 0.5], divisions[0])
        + &block("b", [z, 1.2], divisions[1])
        + "[general_contact]\n"
}

#[test]
fn blocks_of_all_cells_may_touch() {
    let turned = "rotation = { axis = [1, 2, 3], degrees = 37.3 }";
    for cell in ["hex8", "hex20", "hex27", "tet4", "tet10", "wedge6", "wedge15"] {
        for divisions in
            [[[2, 2, 2], [2, 2, 2]], [[2, 2, 2], [3, 3, 2]], [[3, 3, 1], [2, 2, 1]], [[1, 1, 1], [4, 3, 2]]]
        {
            for rotation in ["", turned] {
                let text = stack(cell, divisions, rotation, 0.5);
                let mut built = try_build(&text).unwrap_or_else(|e| panic!("{cell} {divisions:?} {rotation}: {e}"));
                let record = built.simulation.advance().unwrap();
                assert!(record.balance.strain < 1e-25, "{cell} {divisions:?} {rotation}: {}", record.balance.strain);
            }
        }
    }
    // What lies in another one is still refused, however little.
    let error = try_build(&stack("hex20", [[2, 2, 2], [3, 3, 2]], turned, 0.49999)).unwrap_err();
    assert!(error.contains("overlap"), "{error}");
}

/// Coordinates of seven or more digits leave bodies that touch a little apart or in each other: they touch all the same, and nothing acts.
#[test]
fn blocks_of_rounded_coordinates_may_touch() {
    let turned = "rotation = { axis = [1, 2, 3], degrees = 37.3 }";
    for off in [1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 1e-9, 1e-12, -1e-12, -1e-9, -1e-8, -3e-8, -1e-7, -3e-7, -1e-6] {
        for cell in ["hex8", "tet10"] {
            for divisions in [[[2, 2, 2], [2, 2, 2]], [[2, 2, 2], [3, 3, 2]]] {
                for rotation in ["", turned] {
                    let text = stack(cell, divisions, rotation, 0.5 + off);
                    let mut built =
                        try_build(&text).unwrap_or_else(|e| panic!("{off} {cell} {divisions:?} {rotation}: {e}"));
                    let record = built.simulation.advance().unwrap();
                    assert!(
                        record.balance.strain < 1e-25,
                        "{off} {cell} {divisions:?} {rotation}: {}",
                        record.balance.strain
                    );
                }
            }
        }
    }
}

/// Blocks that touch far from the origin, where coordinates have fewer digits behind the point.
#[test]
fn blocks_that_touch_may_lie_anywhere() {
    for at in [10.0, 1e3, 1e5] {
        for off in [0.0, 1e-9, -1e-9, 1e-7, -1e-7] {
            let text = stack("hex8", [[2, 2, 2], [3, 3, 2]], "", 0.5 + off);
            let text = text.replace("cell = ", &format!("position = [{at:?}, {:?}, {:?}]\ncell = ", -at, 0.7 * at));
            let mut built = try_build(&text).unwrap_or_else(|e| panic!("{at} {off}: {e}"));
            let record = built.simulation.advance().unwrap();
            // strains are known up to the round-off of the positions over an edge
            let round_off = 1e-25 + 2e-30 * at * at;
            assert!(record.balance.strain < round_off, "{at} {off}: {}", record.balance.strain);
        }
    }
}

/// Force of two blocks with meshes that do not match, one of which comes down by the gap and 0.03.
fn force_after_a_gap(gap: f64) -> f64 {
    let block = |name: &str, low: f64, divisions: u32| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [0, 0, {low:?}], max = [1, 1, {:?}], divisions = [{divisions}, {divisions}, 1] }}\n\
             material = {{ law = \"neo-hooke\", young = 1.0, poisson = 0.0 }}\n",
            low + 0.5
        )
    };
    let text = "[scene]\ntitle = \"gap\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.25\n".to_owned()
        + &block("a", 0.0, 3)
        + &block("b", 0.5 + gap, 2)
        + "[[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n"
        + &format!(
            "[[prescribe]]\nset = \"b.top\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = {{ table = [[0, 0, 0, 0], [1, 0, 0, {:?}]] }}\n",
            -0.03 - gap
        )
        + "[general_contact]\nself = false\n";
    let mut run = simulation(&text);
    let mut force = 0.0;
    while !run.finished() {
        let contact = run.advance().unwrap_or_else(|e| panic!("{gap}: {e}")).contact.unwrap();
        force = contact.bodies.first().map_or(0.0, |pair| pair.force[2]);
    }
    force.abs()
}

/// The layer takes nothing of a small gap: forces begin where the bodies touch, not a thickness before.
#[test]
fn forces_begin_where_bodies_touch() {
    let touching = force_after_a_gap(0.0);
    // A uniform strain of 0.03 but for what is left of the layer.
    assert!((touching / 0.0305 - 1.0).abs() < 0.03, "{touching}");
    for gap in [0.004, 0.012, 0.05] {
        let force = force_after_a_gap(gap);
        assert!((force / touching - 1.0).abs() < 1e-3, "{gap}: {force} {touching}");
    }
}

/// A block of 0.2 x 0.5 x 1 stands up to an angle of 11.31 degrees: its base keeps its width where its surface goes inside, whatever the thickness of the layer.
#[test]
fn a_base_keeps_its_width() {
    for thickness in [0.004, 0.016] {
        let text = format!(
            "[scene]\ntitle = \"base\"\nkind = \"dynamic\"\n[time]\nend = 2\nstep = 0.02\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
             [[body]]\nname = \"d\"\nmesh = {{ generator = \"block\", min = [-0.1, -0.25, 0], max = [0.1, 0.25, 1], divisions = [2, 2, 4] }}\n\
             material = {{ law = \"neo-hooke\", young = 10000.0, poisson = 0.3 }}\ndensity = 1.0\n\
             [[rigid]]\nname = \"floor\"\nshape = {{ kind = \"plane\", size = [6, 4] }}\nfixed = true\n\
             [gravity]\nacceleration = [\"sin(radians(DEGREES))\", 0, \"-cos(radians(DEGREES))\"]\n\
             [general_contact]\nfriction = 1.0\nthickness = {thickness:?}\n"
        );
        let highest = |degrees: f64| {
            let mut run = simulation(&text.replace("DEGREES", &format!("{degrees:?}")));
            while !run.finished() {
                run.advance().unwrap_or_else(|e| panic!("{degrees}: {e}"));
            }
            let q = &run.state().q;
            (0..q.len() / 3).map(|node| q[3 * node] - run.model().reference[3 * node]).fold(0.0, f64::max)
        };
        let [stands, falls] = [10.0, 11.8].map(highest);
        // A rigid block that turns about the edge of its base from rest: (0.00436/0.51) (cosh(2 * 1.213) - 1) = 0.040 after the time 2.
        assert!(stands < 0.02 && falls > 0.04, "{thickness}: {stands} {falls}");
    }
}
