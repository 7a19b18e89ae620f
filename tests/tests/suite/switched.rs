//! What is off changes nothing, and what comes later changes nothing of what was before: no bit of positions, velocities, forces and balance, whatever the contact.

use proptest::prelude::*;
use std::fmt::Write as _;
use stoss::build::build;
use stoss::solver::Simulation;

/// How two blocks are connected.
const METHODS: [&str; 8] =
    ["nts", "nts, penalty", "cat", "mortar", "mortar, dual", "tie", "tie, frame-invariant", "general"];

/// Schemes, and statics.
const SCHEMES: [&str; 4] = ["", "energy-momentum", "backward-euler", "midpoint"];

/// What may be in a scene beside the blocks and their connection: a support and a sliding support, a load, another contact. All of them are off in the first stage.
const EXTRAS: &str = r#"
[[prescribe]]
name = "hold"
set = "up.left"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
name = "slide"
set = "low.right"
normal = [1, 0, 1]
fixed = true
[[load]]
name = "push"
set = "up.right"
traction = [-2, 1, 0]
[[load]]
name = "blow"
set = "up.front"
follower_pressure = 3
[[contact]]
name = "side"
method = "nts"
slave = "up.right"
master = "low.front"
"#;
const OFF: &str = r#"off = ["hold", "slide", "push", "blow", "side"]"#;

#[derive(Clone, Debug)]
struct Case {
    method: usize,
    scheme: usize,
    /// Friction: none, exact stick, springs.
    friction: usize,
    divisions: [usize; 2],
    at: [f64; 2],
    way: f64,
}

/// What follows the first stage.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Later {
    Nothing,
    Statics,
    Dynamics,
}

impl Case {
    fn is_static(&self) -> bool {
        SCHEMES[self.scheme].is_empty()
    }

    fn connection(&self) -> String {
        let friction = match (METHODS[self.method], self.friction) {
            (_, 0) => "",
            ("general", _) => "friction = 0.2\n",
            (_, 1) => "friction = { law = \"coulomb\", mu = 0.3 }\n",
            _ => "friction = { law = \"coulomb\", mu = 0.3, stick = \"penalty\" }\n",
        };
        let pair = |keys: &str| {
            format!("[[contact]]\nname = \"pair\"\nslave = \"up.bottom\"\nmaster = \"low.top\"\n{keys}\n{friction}")
        };
        let tie = |form: &str| format!("[[tie]]\nslave = \"up.bottom\"\nmaster = \"low.top\"\nform = \"{form}\"\n");
        match METHODS[self.method] {
            "nts" => pair("method = \"nts\""),
            "nts, penalty" => pair("method = \"nts\"\nenforcement = { penalty = 5e3 }"),
            "cat" => pair("method = \"cat\""),
            "mortar" => pair("method = \"mortar\"\nmultipliers = \"standard\""),
            "mortar, dual" => pair("method = \"mortar\"\nmultipliers = \"dual\""),
            "tie" => tie("constant"),
            "tie, frame-invariant" => tie("frame-invariant"),
            _ => format!("[general_contact]\n{friction}"),
        }
    }

    /// The scene whose first stage is that of the case.
    fn scene(&self, has_extras: bool, later: Later) -> String {
        let [n, m] = self.divisions;
        let [x, y] = self.at;
        let is_dynamic = !self.is_static() || later == Later::Dynamics;
        let is_tied = METHODS[self.method].starts_with("tie");
        let gap = match METHODS[self.method] {
            "general" => 0.02,
            _ if self.is_static() || is_tied => 0.0,
            _ => 0.01,
        };
        let (end, step) = if self.is_static() { (1.0, 0.5) } else { (0.04, 0.01) };
        let kind = |of: bool| if of { "dynamic" } else { "quasi-static" };
        let scheme = if self.is_static() { "energy-momentum" } else { SCHEMES[self.scheme] };
        let run_end = if later == Later::Nothing { end } else { end + step };
        let mut text = format!("[scene]\ntitle = \"switched\"\nkind = \"{}\"\n", kind(is_dynamic));
        let integrator = if is_dynamic { format!("integrator = {{ scheme = \"{scheme}\" }}\n") } else { String::new() };
        let off = if has_extras { OFF } else { "" };
        let velocity = if is_dynamic { "velocity = [0.3, 0.1, -1]\n" } else { "" };
        let top = 1.6 + gap;
        let _ = write!(
            text,
            "[time]\nend = {run_end:?}\nstep = {step:?}\n{integrator}\
             [[stage]]\nname = \"first\"\nkind = \"{}\"\nuntil = {end:?}\n{off}\n",
            kind(!self.is_static())
        );
        if later != Later::Nothing {
            // The face that was pressed is let go.
            let let_go = if self.is_static() { "off = [\"press\"]" } else { "" };
            let kind = kind(later == Later::Dynamics);
            let scheme = if later == Later::Dynamics { "integrator = { scheme = \"energy-momentum\" }\n" } else { "" };
            let _ = write!(
                text,
                "[[stage]]\nname = \"second\"\nkind = \"{kind}\"\nuntil = {run_end:?}\n{let_go}\n{scheme}"
            );
        }
        let material = "material = { law = \"neo-hooke\", young = 1000, poisson = 0.3 }\ndensity = 1\n";
        let _ = write!(
            text,
            "[[body]]\nname = \"low\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [2, 2, 1], divisions = [{n}, {n}, 1] }}\n{material}\
             [[body]]\nname = \"up\"\nmesh = {{ generator = \"block\", min = [{x:?}, {y:?}, {:?}], max = [{:?}, {:?}, {top:?}], divisions = [{m}, {m}, 1] }}\n\
             {material}{velocity}[[prescribe]]\nset = \"low.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n",
            1.0 + gap,
            x + 1.0,
            y + 1.0
        );
        if self.is_static() {
            let _ = write!(
                text,
                "[[prescribe]]\nname = \"press\"\nset = \"up.top\"\ncomponents = [\"x\", \"y\", \"z\"]\n\
                 displacement = {{ table = [[0, 0, 0, 0], [1, {:?}, 0, {:?}]] }}\n",
                self.way,
                -0.05 - gap
            );
        }
        text += &self.connection();
        if METHODS[self.method] != "general" {
            text += "[general_contact]\nenabled = false\n";
        }
        if has_extras && METHODS[self.method] == "general" {
            // Surfaces of a named contact are none of general contact's.
            text += EXTRAS.split("[[contact]]").next().unwrap_or_default();
            return text.replace(", \"side\"]", "]");
        }
        if has_extras {
            text += EXTRAS;
        }
        text
    }
}

/// All that a step comes to, of the contacts that are in every scene, with all digits.
fn state(simulation: &Simulation) -> String {
    let bits = |values: &[f64]| -> Vec<u64> { values.iter().map(|v| v.to_bits()).collect() };
    let state = simulation.state();
    let mut text = format!("{:?}\n{:?}\n{:?}\n", simulation.balance(), bits(&state.q), bits(&state.v));
    let known = |name: &str| name == "pair" || name == "general contact" || name.contains('+');
    for (c, pair) in simulation.model().contacts.iter().enumerate().filter(|(_, pair)| known(&pair.name)) {
        let _ = writeln!(text, "{}: {:?} {:?}", pair.name, bits(&simulation.pressures()[c]), simulation.active()[c]);
        let _ = writeln!(text, "{:?}", simulation.contact_report(c));
    }
    text
}

/// States of the first stage, the last of which may say why it ended early.
fn first_stage(text: &str) -> Vec<String> {
    let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}\n{text}"));
    let mut simulation = build(&scene, std::path::Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}")).simulation;
    let mut states = vec![state(&simulation)];
    while !simulation.finished() {
        match simulation.advance() {
            Ok(_) => states.push(state(&simulation)),
            Err(error) => {
                states.push(error.to_string());
                break;
            }
        }
    }
    states
}

fn case() -> impl Strategy<Value = Case> {
    let divisions = [1usize..4, 1usize..4];
    let at = [0.1f64..0.9, 0.1f64..0.9];
    (0..METHODS.len(), 0..SCHEMES.len(), 0usize..3, divisions, at, 0.0f64..0.03).prop_map(
        |(method, scheme, friction, divisions, at, way)| Case { method, scheme, friction, divisions, at, way },
    )
}

/// Whether the program has the combination.
fn exists(case: &Case) -> bool {
    let scheme = SCHEMES[case.scheme];
    METHODS[case.method] != "general" || scheme != "midpoint"
}

fn check(case: &Case) {
    let expected = first_stage(&case.scene(false, Later::Nothing));
    for (has_extras, later) in [
        (true, Later::Nothing),
        (false, Later::Statics),
        (false, Later::Dynamics),
        (true, Later::Statics),
        (true, Later::Dynamics),
    ] {
        let found = first_stage(&case.scene(has_extras, later));
        assert_eq!(expected.len(), found.len(), "{case:?}, extras {has_extras}, later {later:?}: {:?}", found.last());
        for (step, (expected, found)) in expected.iter().zip(&found).enumerate() {
            for (line, (expected, found)) in expected.lines().zip(found.lines()).enumerate() {
                assert_eq!(
                    expected, found,
                    "{} {:?}, step {step}, line {line}: {case:?}, extras {has_extras}, later {later:?}",
                    METHODS[case.method], SCHEMES[case.scheme]
                );
            }
        }
    }
}

/// Every method in statics and with every scheme.
#[test]
fn what_is_off_or_comes_later_changes_no_bit_of_any_method() {
    for (method, scheme) in (0..METHODS.len()).flat_map(|m| (0..SCHEMES.len()).map(move |s| (m, s))) {
        let (friction, way) = ((method + scheme) % 3, 0.02);
        let case = Case { method, scheme, friction, divisions: [3, 2], at: [0.4, 0.55], way };
        if exists(&case) {
            check(&case);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn what_is_off_or_comes_later_changes_no_bit(case in case()) {
        prop_assume!(exists(&case));
        check(&case);
    }
}

/// A bar that is let go under a load, and comes to equilibrium in statics: what it gives up there is dissipated like its kinetic energy, and `total` stays. `[time]` has no scheme, because the
/// dynamic stage has its own.
#[test]
fn the_total_energy_stays_where_statics_follow_a_motion() {
    for plasticity in ["", ", plasticity = { yield_stress = 10.0, hardening_modulus = 100.0 }"] {
        let text = format!(
            "[scene]\ntitle = \"rest\"\nkind = \"dynamic\"\n[time]\nend = 0.2\nstep = 0.01\n\
             [[body]]\nname = \"b\"\nmesh = {{ generator = \"block\", size = [1, 1, 1], divisions = [2, 1, 1] }}\n\
             material = {{ law = \"hencky\", young = 1000.0, poisson = 0.3{plasticity} }}\ndensity = 10.0\n\
             velocity_gradient = [[1, 0, 0], [0, 0, 0], [0, 0, 0]]\n\
             [[prescribe]]\nset = \"b.left\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
             [[load]]\nset = \"b.right\"\ntotal_force = [10.0, 0.0, 0.0]\n\
             [[stage]]\nname = \"move\"\nkind = \"dynamic\"\nuntil = 0.1\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
             [[stage]]\nname = \"rest\"\nkind = \"quasi-static\"\nuntil = 0.2\nstep = 0.05\n"
        );
        let built = build(&stoss::scene::parse(&text, "rest.toml").unwrap(), std::path::Path::new(".")).unwrap();
        let (mut run, schedule) = (built.simulation, built.schedule);
        let start = run.balance().total();
        let (mut before, mut steps) = (0.0, 0);
        while !run.finished() || schedule.advance(&mut run).unwrap() {
            steps += 1;
            let balance = run.advance().unwrap().balance;
            assert!((balance.total() / start - 1.0).abs() < 1e-12, "{balance:?}");
            assert!(balance.dissipation >= before - 1e-14 * start, "{balance:?}");
            before = balance.dissipation;
        }
        // Without plasticity it is the energy of the vibration about the equilibrium.
        assert!(before > 0.5 * start && steps == 12, "{before} {start} {steps}");
    }
}
