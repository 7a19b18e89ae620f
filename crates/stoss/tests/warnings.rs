//! What `stoss check` warns of in meshes and contacts, what a singular system is reported to be, and that an error is reported without others that follow from it.
use std::path::Path;

fn build(scene: &str) -> stoss::build::Built {
    let scene = stoss::scene::parse(scene, "scene.toml").unwrap_or_else(|error| panic!("{error}"));
    stoss::build::build(&scene, Path::new(".")).unwrap_or_else(|error| panic!("{error}"))
}

fn bar(divisions: [usize; 3], integration: &str) -> String {
    format!(
        "[scene]\ntitle = \"bar\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\nmax_cuts = 0\n[[body]]\nname = \"a\"\n\
         mesh = {{ generator = \"block\", min = [0, 0, 0], max = [10, 1, 1], divisions = {divisions:?} }}\n\
         cell = \"hex20\"\nintegration = \"{integration}\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
         [[prescribe]]\nset = \"a.left\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n[[load]]\nset = \"a.right\"\ntraction = [0, 0, 0.01]\n"
    )
}

/// A clamped single row of hex20 with reduced integration is singular; `check` warns, and the failure says why. Two rows, or full integration, are neither.
#[test]
fn a_single_row_of_reduced_hex20_is_reported() {
    let mut built = build(&bar([4, 1, 1], "reduced"));
    assert!(built.warnings.iter().any(|w| w.contains("4 of 4 elements are in a single row")), "{:?}", built.warnings);
    let error = built.simulation.advance().unwrap_err().to_string();
    assert!(error.contains("singular") && error.contains("use two elements through the thickness"), "{error}");
    for (divisions, integration) in [([4, 2, 1], "reduced"), ([4, 1, 1], "full")] {
        let mut built = build(&bar(divisions, integration));
        assert!(!built.warnings.iter().any(|w| w.contains("single row")), "{:?}", built.warnings);
        built.simulation.advance().unwrap();
    }
}

fn blocks(cell: &str, method: &str, divisions: [usize; 2]) -> String {
    let block = |name: &str, low: f64, high: f64, n: usize| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [0, 0, {low:?}], max = [1, 1, {high:?}], divisions = [{n}, {n}, 1] }}\n\
             cell = \"{cell}\"\nmaterial = {{ law = \"neo-hooke\", young = 100.0, poisson = 0.0 }}\n\
             [[prescribe]]\nset = \"{name}.left\"\ncomponents = [\"x\"]\nfixed = true\n[[prescribe]]\nset = \"{name}.front\"\ncomponents = [\"y\"]\nfixed = true\n"
        )
    };
    let [lower, upper] = divisions;
    format!(
        "[scene]\ntitle = \"pair\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n{}{}\
         [[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"z\"]\nfixed = true\n[[load]]\nset = \"b.top\"\npressure = 1.0\n\
         [[contact]]\nmethod = \"{method}\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n",
        block("a", 0.0, 0.5, lower),
        block("b", 0.5, 1.0, upper)
    )
}

/// Node-to-surface contact of quadratic faces is warned of, and is as wrong as the warning says.
#[test]
fn nodes_on_quadratic_faces_are_reported() {
    let has = |built: &stoss::build::Built| built.warnings.iter().any(|w| w.contains("tens of per cent"));
    let mut built = build(&blocks("hex27", "nts", [3, 2]));
    assert!(has(&built));
    built.simulation.advance().unwrap();
    let worst = built.simulation.pressures()[0].iter().map(|p| (p - 1.0).abs()).fold(0.0, f64::max);
    assert!((0.1..0.5).contains(&worst), "{worst}");
    assert!(!has(&build(&blocks("hex8", "nts", [3, 2]))));
    #[cfg(feature = "mortar")]
    assert!(!has(&build(&blocks("hex27", "mortar", [3, 2]))));
    let redundant = build(&blocks("hex20", "nts", [2, 2]));
    assert!(redundant.warnings.iter().any(|w| w.contains("redundant")), "{:?}", redundant.warnings);
}

/// A ramp that ends after the run leaves the nodes on the way.
#[test]
fn a_ramp_that_ends_after_the_run_is_warned_of() {
    let scene = |until: f64| {
        bar([2, 2, 2], "full")
            + &format!(
                "[[prescribe]]\nname = \"later\"\nset = \"a.right\"\ncomponents = [\"x\"]\ndisplacement = 0.1\nramp_until = {until:?}\n\
                 [[stage]]\nname = \"one\"\nkind = \"quasi-static\"\nstep = 0.5\nuntil = 0.5\noff = [\"later\"]\n\
                 [[stage]]\nname = \"two\"\nkind = \"quasi-static\"\nstep = 0.5\nuntil = 1.0\n"
            )
    };
    let has = |until: f64| build(&scene(until)).warnings.iter().any(|w| w.contains("the ramp ends at t ="));
    assert!(has(1.5) && !has(1.0) && !has(f64::INFINITY));
}

/// A set that does not exist is the only problem: what a stage switches off, or an event releases, is not reported as unknown because of it.
#[test]
fn names_are_not_reported_because_of_another_error() {
    let more = "[[stage]]\nname = \"one\"\nkind = \"quasi-static\"\nstep = 0.5\nuntil = 0.5\n[[stage]]\nname = \"two\"\nkind = \"quasi-static\"\nstep = 0.5\nuntil = 1.0\noff = [\"hold\"]\n\
                [[event]]\nname = \"snap\"\nrelease = \"hold\"\ntime = 0.25\n";
    let named = bar([4, 2, 1], "full").replacen("[[prescribe]]", "[[prescribe]]\nname = \"hold\"", 1) + more;
    build(&named);
    let scene = stoss::scene::parse(&named.replacen("a.left", "a.lefft", 1), "scene.toml").unwrap();
    let errors = stoss::build::build(&scene, Path::new(".")).unwrap_err();
    let keys: Vec<&str> = errors.problems().iter().map(|problem| problem.key.as_str()).collect();
    assert_eq!(keys, ["prescribe[0].set"], "{errors}");
}
