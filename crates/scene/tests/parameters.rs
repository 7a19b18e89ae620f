//! `[parameters]`, expressions in place of numbers, `--set`, `[sweep]`.

use stoss_scene::{MeshSource, OwnNames, Scene, SceneErrors, parse, parse_set};

const BASE: &str = r#"
[parameters]
radius = 0.5
size = "2*radius"
count = 4
speed = -1e-3

[scene]
title = "block"
kind = "dynamic"

[time]
end = "10*size"
step = "size / 100"
integrator = { scheme = "energy-momentum" }

[[body]]
name = "block"
mesh = { generator = "block", size = ["size", 1.0, "size^2"], divisions = ["count", "count/2", 1] }
material = { law = "neo-hooke", young = "1e3*(1 + radius)", poisson = 0.3 }
density = "max(radius, 2)"
velocity = [0.0, 0.0, "1e3*speed"]

[[prescribe]]
set = "block.bottom"
components = ["x"]
displacement = { table = [[0.0, 0.0], ["size", "radius/10"]] }

[sweep]
grid = { radius = [0.5, "radius/2"], speed = { from = -1.0, to = 0.0, count = 3 } }
extremes = ["balance.total"]
"#;

fn changed(from: &str, to: &str) -> String {
    assert!(BASE.contains(from), "the base scene has no `{from}`");
    BASE.replacen(from, to, 1)
}

fn set(assignments: &[(&str, &str)]) -> Result<Scene, SceneErrors> {
    let assignments: Vec<_> = assignments.iter().map(|&(name, value)| (name.to_owned(), value.to_owned())).collect();
    parse_set(BASE, "x.toml", &OwnNames::default(), &assignments)
}

/// End, step, first size of the block, density.
fn figures(scene: &Scene) -> [f64; 4] {
    let MeshSource::Generator(generator) = &scene.bodies[0].mesh else { panic!("a generator") };
    let size = serde_json::to_value(generator).unwrap()["size"][0].as_f64().unwrap();
    [scene.time.end, scene.time.step, size, scene.bodies[0].density.unwrap()]
}

#[test]
fn expressions_are_evaluated_where_numbers_stand() {
    let scene = parse(BASE, "x.toml").unwrap();
    assert_eq!(figures(&scene), [10.0, 0.01, 1.0, 2.0]);
    assert_eq!(scene.parameters["size"], 1.0);
    let mesh = serde_json::to_value(&scene.bodies[0].mesh).unwrap();
    assert_eq!(mesh["divisions"], serde_json::json!([4, 2, 1]));
    assert_eq!(scene.bodies[0].velocity, [0.0, 0.0, -1.0]);
    let table = serde_json::to_value(&scene.prescriptions[0].displacement).unwrap();
    assert_eq!(table["table"][1], serde_json::json!([1.0, 0.05]));
}

/// What depends on a parameter follows it.
#[test]
fn set_changes_a_parameter_and_what_depends_on_it() {
    assert_eq!(figures(&set(&[("radius", "3")]).unwrap()), [60.0, 0.06, 6.0, 3.0]);
    assert_eq!(figures(&set(&[("radius", "count/2")]).unwrap()), [40.0, 0.04, 4.0, 2.0]);
    let errors = set(&[("radius", "3"), ("radius", "count/2")]).unwrap_err();
    let problem = &errors.problems()[0];
    assert!(problem.message.contains("--set radius=3") && problem.message.contains("twice"), "{problem}");
    let errors = set(&[("raduis", "3")]).unwrap_err();
    let problem = &errors.problems()[0];
    assert_eq!((problem.line, problem.key.as_str()), (2, "parameters.raduis"));
    assert!(problem.message.contains("--set raduis=3") && problem.remedy.contains("radius"), "{problem}");
    let errors = set(&[("radius", "3*"), ("count", "8")]).unwrap_err();
    assert_eq!(errors.problems().len(), 1, "what depends on it is not reported again: {errors}");
    assert!(errors.to_string().contains("--set radius=3*"), "{errors}");
}

#[test]
fn a_sweep_has_its_cases() {
    let sweep = parse(BASE, "x.toml").unwrap().sweep.unwrap();
    assert_eq!((sweep.count(), sweep.parameters()), (6, vec!["radius", "speed"]));
    assert_eq!((sweep.all()[4]["radius"], sweep.all()[4]["speed"]), (0.25, -0.5));
    let listed = changed(
        "grid = { radius = [0.5, \"radius/2\"], speed = { from = -1.0, to = 0.0, count = 3 } }",
        "cases = [{ radius = 1 }, { radius = 2, speed = -2.0 }]",
    );
    let sweep = parse(&listed, "x.toml").unwrap().sweep.unwrap();
    assert_eq!((sweep.count(), sweep.all()[0].len(), sweep.all()[1]["speed"]), (2, 1, -2.0));
}

/// Replaced text, its replacement, text in the line of the only problem, key, and what message or remedy say.
const MISTAKES: [(&str, &str, &str, &str, &str); 24] = [
    ("\"10*size\"", "\"10*sise\"", "10*sise", "time.end", "`size`"),
    ("\"10*size\"", "\"10*\"", "end = ", "time.end", "character 4"),
    ("\"10*size\"", "\"-size\"", "-size", "time.end", "is -1, must be positive"),
    ("\"count/2\"", "\"count/3\"", "divisions", "body[0].mesh.divisions[1]", "must be a whole number"),
    ("\"count/2\"", "\"count*0\"", "divisions", "body[0].mesh.divisions[1]", "is 0, must be"),
    ("\"size / 100\"", "\"size / 0\"", "step = ", "time.step", "finite"),
    ("\"radius/10\"", "\"radius/\"", "table = ", "prescribe[0].displacement.table[1][1]", "ends too early"),
    ("\"2*radius\"", "\"2*size\"", "size = ", "parameters.size", "cycle"),
    ("\"2*radius\"", "true", "size = ", "parameters.size", "number"),
    ("\"2*radius\"", "\"radius(2)\"", "size = ", "parameters.size", "operator is missing"),
    ("\"2*radius\"", "nan", "size = ", "parameters.size", "NaN"),
    ("count = 4\n", "count = 4\nmin = 1\n", "min = 1", "parameters.min", "name of a parameter"),
    ("count = 4\n", "count = 4\n\"a-b\" = 1\n", "a-b", "parameters.a-b", "name of a parameter"),
    ("radius = [0.5,", "raduis = [0.5,", "grid", "sweep.grid.raduis", "`radius`"),
    ("[0.5, \"radius/2\"]", "[]", "grid", "sweep.grid.radius", "no value"),
    ("[0.5, \"radius/2\"]", "0.5", "grid", "sweep.grid.radius", "[0.0, 0.1, 0.2]"),
    ("count = 3", "count = 1", "grid", "sweep.grid.speed.count", "from 2"),
    ("count = 3", "count = 99999", "[sweep]", "sweep", "199998 cases"),
    (", count = 3", "", "grid", "sweep.grid.speed.count", "missing"),
    ("[sweep]\n", "[sweep]\ncases = [{ radius = 1 }]\n", "cases", "sweep.cases", "one of the two"),
    ("grid = {", "gird = {", "gird", "sweep.gird", "did you mean `grid`"),
    ("\"balance.total\"", "\"balances.total\"", "extremes", "sweep.extremes[0]", "balance"),
    ("\"balance.total\"", "\"total\"", "extremes", "sweep.extremes[0]", "TABLE.COLUMN"),
    ("extremes", "extremas", "extremas", "sweep.extremas", "extremes"),
];

#[test]
fn mistakes_are_reported_at_their_place() {
    for (from, to, at, key, says) in MISTAKES {
        let text = changed(from, to);
        let errors = parse(&text, "x.toml").expect_err(to);
        let problem = errors.problems().iter().find(|problem| problem.key == key);
        let problem = problem.unwrap_or_else(|| panic!("{from} -> {to}: {errors}"));
        assert!(errors.problems().len() == 1, "{from} -> {to}: {errors}");
        assert!(text.lines().nth(problem.line - 1).unwrap().contains(at), "{from} -> {to}: {problem}");
        assert!(problem.to_string().contains(says) && problem.remedy.len() > 5, "{from} -> {to}: {problem}");
    }
}

/// A chain of any length is refused, not followed until the stack ends.
#[test]
fn long_chains_are_refused() {
    let chain: String = (0..5_000).map(|k| format!("p{k} = \"p{}\"\n", k + 1)).collect();
    let text = changed("[parameters]\n", &format!("[parameters]\n{chain}p5000 = 1\n"));
    let errors = parse(&text, "x.toml").unwrap_err();
    assert!(errors.to_string().contains("a chain of more than 100"), "{}", errors.problems()[0]);
}
