//! Expressions over sets through scenes: nodes and facets are those that a search over all of them finds.

use std::path::Path;
use stoss::build::{ProbeTarget, build};
use stoss::solver::LoadKind;

/// A unit cube of 4 x 4 x 4 elements with a rigid ball and a beam beside it.
fn scene(rest: &str) -> String {
    format!(
        r#"
[parameters]
half = 0.5
[scene]
title = "cube"
kind = "quasi-static"
[time]
end = 1.0
step = 1.0
[[body]]
name = "cube"
mesh = {{ generator = "block", size = [1, 1, 1], divisions = [4, 4, 4] }}
position = [0.5, 0.5, 0.5]
material = {{ law = "neo-hooke", young = 1.0, poisson = 0.3 }}
[[rigid]]
name = "ball"
fixed = true
position = [0, 0, 5]
shape = {{ kind = "sphere", radius = 1.0, divisions = 4 }}
[[prescribe]]
set = "cube.bottom"
components = ["x", "y", "z"]
fixed = true
{rest}
"#
    )
}

fn built(rest: &str) -> Result<stoss::build::Built, String> {
    let scene = stoss::scene::parse(&scene(rest), "test.toml").map_err(|errors| errors.to_string())?;
    build(&scene, Path::new(".")).map_err(|errors| errors.to_string())
}

/// Places of the nodes of an expression.
fn places(expression: &str, sets: &str) -> Vec<[f64; 3]> {
    let rest = format!("[[probe]]\nname = \"p\"\nquantity = \"position\"\nset = {expression:?}\n{sets}");
    let built = built(&rest).unwrap_or_else(|errors| panic!("{errors}"));
    let ProbeTarget::Nodes(nodes) = &built.probes[0].target else { panic!("no nodes") };
    let x = &built.simulation.model().reference;
    nodes.iter().map(|&n| std::array::from_fn(|i| x[3 * n as usize + i])).collect()
}

/// Middles of the facets of an expression.
fn middles(expression: &str) -> Vec<[f64; 3]> {
    let rest = format!("[[load]]\nfollower_pressure = 1.0\nset = {expression:?}\n");
    let built = built(&rest).unwrap_or_else(|errors| panic!("{errors}"));
    let model = built.simulation.model();
    let LoadKind::FollowerPressure { facets } = &model.loads[0].kind else { panic!("no pressure") };
    let x = |n: u32, i: usize| model.reference[3 * n as usize + i];
    facets.iter().map(|f| std::array::from_fn(|i| f.iter().map(|&n| x(n, i)).sum::<f64>() / 4.0)).collect()
}

/// Corners of the grid of quarters at which a condition holds.
fn grid(holds: impl Fn([f64; 3]) -> bool) -> usize {
    let quarter = |i: usize| i as f64 / 4.0;
    (0..125).filter(|&i| holds([quarter(i % 5), quarter(i / 5 % 5), quarter(i / 25)])).count()
}

#[test]
fn nodes_are_those_at_which_the_expression_holds() {
    type Condition = fn([f64; 3]) -> bool;
    let cases: [(&str, Condition); 9] = [
        ("cube.top & x > 0.2", |[x, _, z]| z == 1.0 && x > 0.2),
        // On the limit: positions come from additions and are equal to a millionth of the size.
        ("cube.all & x >= half & y < 0.25", |[x, y, _]| x >= 0.5 && y < 0.25),
        ("cube.top | cube.bottom - cube.left", |[x, _, z]| z == 1.0 || (z == 0.0 && x != 0.0)),
        ("!cube.boundary", |p| p.iter().all(|&c| 0.0 < c && c < 1.0)),
        ("cube.all & hypot(x - 0.5, y - 0.5) = 0.5", |[x, y, _]| (x - 0.5).hypot(y - 0.5) == 0.5),
        ("cube.all & 0.25 <= z <= 0.5", |[_, _, z]| (0.25..=0.5).contains(&z)),
        ("cube.all & x + y + z = 3*half", |[x, y, z]| x + y + z == 1.5),
        ("normal(cube, 0, 0, 1, 10)", |[_, _, z]| z == 1.0),
        ("normal(cube, 1, 1, 0, 60)", |[x, y, _]| x == 1.0 || y == 1.0),
    ];
    for (expression, holds) in cases {
        let found = places(expression, "");
        let wrong: Vec<_> = found.iter().filter(|p| !holds(p.map(|c| (4.0 * c).round() / 4.0))).collect();
        assert!(wrong.is_empty(), "{expression}: {wrong:?}");
        assert_eq!(found.len(), grid(holds), "{expression}");
    }
    assert_eq!(places("nearest(cube, 0.3, 0.2, 5)", ""), [[0.25, 0.25, 1.0]]);
    assert_eq!(places("nearest(cube.left & z < 0.1, 0.3, 0.4, 5)", ""), [[0.0, 0.5, 0.0]]);
    let sets = "[sets]\nedge = \"upper & cube.left\"\nupper = \"cube.top | cube.all & z = 0.75\"\n";
    assert_eq!(places("edge - y > 0.1", sets), [[0.0, 0.0, 0.75], [0.0, 0.0, 1.0]]);
}

#[test]
fn facets_are_those_at_all_of_whose_nodes_it_holds() {
    // Half of the top, without the row that the limit cuts.
    assert_eq!(middles("cube.top & x > 0.3").len(), 8);
    assert_eq!(middles("cube.all & x > 0.3 & z = 1").len(), 8);
    // A set of facets holds for its own ones only: the corner facets of the sides touch neither top nor bottom with all nodes.
    assert_eq!(middles("cube.top | cube.left").len(), 32);
    assert!(middles("cube.top - cube.left").iter().all(|p| (p[2] - 1.0).abs() < 1e-12));
    assert_eq!(middles("!cube.top").len(), 80);
    let right = middles("normal(cube, 1, 0, 0, 45) & y < 0.6");
    assert!(right.len() == 8 && right.iter().all(|p| (p[0] - 1.0).abs() < 1e-12 && p[1] < 0.5));
}

#[test]
fn surfaces_of_rigid_bodies_have_expressions() {
    let contact = |set: &str| format!("[[contact]]\nmethod = \"nts\"\nslave = \"cube.top\"\nmaster = {set:?}\n");
    for master in ["ball.all & z < 5", "normal(ball, 0, 0, -1, 80)"] {
        built(&contact(master)).unwrap_or_else(|errors| panic!("{errors}"));
    }
    let errors = built(&contact("ball.all & z < 3")).unwrap_err();
    assert!(errors.contains("`z < 3` holds at no node of `ball`"), "{errors}");
}

#[test]
fn mistakes_say_which_part_is_to_blame() {
    let probe = |set: &str| format!("[[probe]]\nname = \"p\"\nquantity = \"position\"\nset = {set:?}\n");
    let load = |set: &str| format!("[[load]]\npressure = 1.0\nset = {set:?}\n");
    for (rest, expected) in [
        (probe("cube.top & x > 2"), "is empty: `x > 2` holds at no node of `cube`"),
        (probe("cube.top & cube.bottom"), "`cube.top` (25) and `cube.bottom` (25) have no node in common"),
        (probe("cube.tpo & x > 0"), "did you mean `top`?"),
        (load("cube.all & x = half"), "a surface is needed"),
        (load("nearest(cube, 0, 0, 0)"), "a surface is needed"),
        ("[sets]\ntop = \"cube.all & z = 1\"\n".into(), "has a set `top` of its own"),
    ] {
        let errors = built(&rest).unwrap_err();
        assert!(
            errors.contains(expected) && errors.starts_with("test.toml:") && errors.lines().count() == 1,
            "{errors}"
        );
    }
}
