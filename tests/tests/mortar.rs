//! Mortar contact: patch tests, convergence of Newton's method, conservation.

mod support;

use std::fmt::Write;
use stoss::solver::{Simulation, StepRecord};
use support::{drift, simulation};

const LAWS: [(&str, &str, f64); 4] = [
    ("svk", r#"law = "saint-venant-kirchhoff", young = 1000.0, poisson = 0.3"#, 100.0),
    ("neo-hooke", r#"law = "neo-hooke", young = 1000.0, poisson = 0.3"#, 200.0),
    ("mooney-rivlin", r#"law = "mooney-rivlin", c1 = 176051.0, c2 = 4332.63, c = 2.0e6"#, 1.0e5),
    (
        "ogden",
        r#"law = "ogden", mu = [6300.0, 12.0, -100.0], alpha = [1.3, 5.0, -2.0], kappa = 2000.0, beta = 9.0"#,
        500.0,
    ),
];

/// Blocks on each other; `z` of the interface is `1 + 0.3 slope x + 0.1 slope y`.
struct Patch<'a> {
    material: &'a str,
    pressure: f64,
    contact: &'a str,
    /// Side of the lower block; the upper one has side 1.
    lower: f64,
    divisions: [usize; 2],
    slope: f64,
    upper_is_slave: bool,
}

/// `int N dx` over `[0, end]` for the nodes of a line with `n` elements of length `h`.
fn hats(n: usize, h: f64, end: f64) -> Vec<f64> {
    let mut out = vec![0.0; n + 1];
    for e in 0..n {
        let t = ((end - e as f64 * h) / h).clamp(0.0, 1.0);
        out[e] += h * (t - 0.5 * t * t);
        out[e + 1] += h * 0.5 * t * t;
    }
    out
}

fn patch(p: &Patch<'_>) -> String {
    let (l, [nl, nu], slope, material) = (p.lower, p.divisions, p.slope, p.material);
    let z = |x: f64, y: f64| 1.0 + slope * (0.3 * x + 0.1 * y);
    let block = |side: f64, bottom: &dyn Fn(f64, f64) -> f64, top: &dyn Fn(f64, f64) -> f64| {
        let c = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
        let mut list: Vec<[f64; 3]> = c.iter().map(|&[x, y]| [x, y, bottom(x, y)]).collect();
        list.extend(c.iter().map(|&[x, y]| [x, y, top(x, y)]));
        format!("{list:?}")
    };
    let lower = block(l, &|_, _| 0.0, &z);
    let upper = block(1.0, &z, &|_, _| 2.0);
    let (slave, master) = if p.upper_is_slave { ("upper.bottom", "lower.top") } else { ("lower.top", "upper.bottom") };
    let mut text = format!(
        r#"
[scene]
title = "patch"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
[[body]]
name = "lower"
mesh = {{ generator = "hexahedron", corners = {lower}, divisions = [{nl}, {nl}, 2] }}
material = {{ {material} }}
[[body]]
name = "upper"
mesh = {{ generator = "hexahedron", corners = {upper}, divisions = [{nu}, {nu}, 2] }}
material = {{ {material} }}
[[contact]]
{contact}
slave = "{slave}"
master = "{master}"
[[prescribe]]
set = "lower.bottom"
components = ["z"]
fixed = true
"#,
        contact = p.contact
    );
    for body in ["lower", "upper"] {
        for (set, component) in [("left", "x"), ("front", "y")] {
            write!(text, "[[prescribe]]\nset = \"{body}.{set}\"\ncomponents = [\"{component}\"]\nfixed = true\n")
                .unwrap();
        }
    }
    let ramp = |value: f64| format!("{{ table = [[0.0, 0.0], [1.0, {value:?}]] }}");
    write!(text, "[[load]]\nset = \"upper.top\"\npressure = {}\n", ramp(p.pressure)).unwrap();
    if slope != 0.0 {
        // Hydrostatic: a frictionless inclined interface carries no shear.
        for set in ["lower.right", "lower.back", "upper.right", "upper.back"] {
            write!(text, "[[load]]\nset = \"{set}\"\npressure = {}\n", ramp(p.pressure)).unwrap();
        }
    } else if l > 1.0 {
        // The same pressure on the part of the lower block that the upper one leaves free, which ends within facets.
        let h = l / nl as f64;
        let (all, covered) = (hats(nl, h, l), hats(nl, h, 1.0));
        for i in 0..=nl {
            for j in 0..=nl {
                let force = -p.pressure * (all[i] * all[j] - covered[i] * covered[j]);
                if force.abs() < 1e-14 * p.pressure {
                    continue;
                }
                let (x, y) = (i as f64 * h, j as f64 * h);
                let (low, high) = ([x - 1e-3, y - 1e-3, 0.999], [x + 1e-3, y + 1e-3, 1.001]);
                write!(
                    text,
                    "[[set]]\nname = \"lower.n{i}-{j}\"\nbody = \"lower\"\nbox = {{ min = {low:?}, max = {high:?} }}\n\
                     [[load]]\nset = \"lower.n{i}-{j}\"\nforce = {{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, {force:?}]] }}\n"
                )
                .unwrap();
            }
        }
    }
    text
}

fn print_newton(record: &StepRecord) {
    let rows: Vec<String> = record
        .newton
        .iter()
        .map(|r| {
            format!("{:.1e}{}", r.residual, if r.changes > 0 { format!("({})", r.changes) } else { String::new() })
        })
        .collect();
    println!("step {} dt {}: {}", record.step, record.dt, rows.join(" "));
}

fn run(simulation: &mut Simulation) {
    while !simulation.finished() {
        print_newton(&simulation.advance().unwrap());
    }
}

/// Largest deviation of the Cauchy stress at any Gauss point from the mean, over the norm of the mean, and the mean.
fn unevenness(simulation: &Simulation) -> (f64, [f64; 6]) {
    let q = &simulation.state().q;
    let bodies = &simulation.model().bodies;
    let stresses: Vec<[f64; 6]> = bodies
        .iter()
        .flat_map(|b| b.solid.gauss_point_state(q).unwrap())
        .flat_map(|points| points.into_iter().map(|p| p.cauchy))
        .collect();
    let mean: [f64; 6] = std::array::from_fn(|i| stresses.iter().map(|s| s[i]).sum::<f64>() / stresses.len() as f64);
    let size = mean.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
    let worst = stresses.iter().flat_map(|s| (0..6).map(move |i| (s[i] - mean[i]).abs())).fold(0.0, f64::max);
    (worst / size, mean)
}

/// Position of the node that started at `x`.
fn position(simulation: &Simulation, x: [f64; 3]) -> [f64; 3] {
    let reference = &simulation.model().reference;
    let node = (0..reference.len() / 3).find(|n| (0..3).all(|i| (reference[3 * n + i] - x[i]).abs() < 1e-9)).unwrap();
    std::array::from_fn(|i| simulation.state().q[3 * node + i])
}

const STANDARD: &str = "method = \"mortar\"\nmultipliers = \"standard\"";
const DUAL: &str = "method = \"mortar\"\nmultipliers = \"dual\"";

/// Uniaxial (flat) or hydrostatic (inclined) compression at finite strains, for a patch.
fn check_patch(name: &str, p: &Patch<'_>) {
    let mut simulation = simulation(&patch(p));
    run(&mut simulation);
    let (uneven, mean) = unevenness(&simulation);
    let stretch = position(&simulation, [0.0, p.lower, 0.0])[1] / p.lower;
    println!("{name}: uneven by {uneven:.1e}, stress {:.6}, lateral stretch {stretch:.4}", mean[2]);
    assert!(uneven < 1e-10, "{name}: {uneven:e}");
    // The dead load on the deformed area.
    assert!((mean[2] * stretch * stretch + p.pressure).abs() < 1e-9 * p.pressure, "{name}: {mean:?}");
    let height = position(&simulation, [0.0, 0.0, 2.0])[2] / 2.0;
    assert!(height < 0.98, "{name}: no finite strain");
}

#[test]
fn patch_with_overhang_is_uniform_for_all_laws() {
    for (name, material, pressure) in LAWS {
        for upper_is_slave in [true, false] {
            for contact in [STANDARD, DUAL] {
                // Two and a half facets of the lower block lie below the upper one.
                let p =
                    Patch { material, pressure, contact, lower: 2.0, divisions: [5, 3], slope: 0.0, upper_is_slave };
                check_patch(&format!("{name} overhang, upper slave {upper_is_slave}, {contact:?}"), &p);
            }
        }
    }
}

#[test]
fn flat_and_inclined_patches_are_uniform() {
    for slope in [0.0, 1.0] {
        for upper_is_slave in [true, false] {
            for contact in [STANDARD, DUAL] {
                let (_, material, pressure) = LAWS[1];
                let p = Patch { material, pressure, contact, lower: 1.0, divisions: [4, 3], slope, upper_is_slave };
                check_patch(&format!("slope {slope}, upper slave {upper_is_slave}, {contact:?}"), &p);
            }
        }
    }
}

#[test]
fn node_to_surface_fails_the_patch() {
    // On the inclined interface it does not even converge at the pressure of the mortar test.
    for (lower, divisions, slope, pressure) in
        [(1.0, [4, 3], 0.0, 200.0), (1.0, [4, 3], 1.0, 20.0), (2.0, [5, 3], 0.0, 200.0)]
    {
        let material = LAWS[1].1;
        let contact = "method = \"nts\"";
        let p = Patch { material, pressure, contact, lower, divisions, slope, upper_is_slave: true };
        let mut simulation = simulation(&patch(&p));
        run(&mut simulation);
        let (uneven, _) = unevenness(&simulation);
        println!("nts, lower side {lower}, slope {slope}: stress uneven by {uneven:.2e}");
        assert!(uneven > 1e-2);
    }
}

fn scene_file(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name);
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn two_blocks_keep_momenta_and_energy() {
    let mut simulation = simulation(&scene_file("two-blocks-mortar.toml"));
    let mut records = vec![simulation.initial_record()];
    let (mut linear, mut angular) = (Vec::new(), Vec::new());
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        if record.contact.as_ref().is_some_and(|c| c.active > 0) && records.len() % 10 == 0 {
            print_newton(&record);
        }
        linear.push(record.balance.linear_momentum);
        angular.push(record.balance.angular_momentum);
        records.push(record);
    }
    let active: Vec<bool> = records.iter().map(|r| r.contact.as_ref().is_some_and(|c| c.active > 0)).collect();
    let first = active.iter().position(|a| *a).unwrap();
    let last = active.iter().rposition(|a| *a).unwrap();
    let energy: Vec<f64> = records.iter().map(|r| r.balance.total()).collect();
    let spread = |e: &[f64]| e.iter().map(|x| (x / e[0] - 1.0).abs()).fold(0.0, f64::max);
    println!(
        "contact from step {first} to {last} of {}; momenta {:.1e} {:.1e}; energy before {:.1e}, after {:.1e}, over the impact {:.3e}",
        records.len() - 1,
        drift(&linear),
        drift(&angular),
        spread(&energy[..first]),
        spread(&energy[last..]),
        energy[last] / energy[0] - 1.0,
    );
    assert!(first > 1 && last > first);
    assert!(drift(&linear) < 1e-11 && drift(&angular) < 1e-11);
    assert!(spread(&energy[..first]) < 1e-11);
    assert!(spread(&energy[last..]) < 1e-10);
    // The impact as a whole: what closing nodes lose and what new integrals change.
    assert!((energy[last] / energy[0] - 1.0).abs() < 2e-2);
}

/// The start of the ironing: pressing in and the first facets passed.
#[test]
fn ironing_converges_quadratically() {
    for contact in ["standard", "dual"] {
        let text = scene_file("ironing-mortar.toml")
            .replace("end = 20.0", "end = 4.0")
            .replace("method = \"mortar\"", &format!("method = \"mortar\"\nmultipliers = \"{contact}\""));
        let mut simulation = simulation(&text);
        let (mut iterations, mut steps) = (0, 0);
        while !simulation.finished() {
            let record = simulation.advance().unwrap();
            print_newton(&record);
            iterations += record.iterations;
            steps += 1;
        }
        println!(
            "{contact}: {steps} steps, {:.2} iterations a step, {} cuts",
            iterations as f64 / steps as f64,
            simulation.decisions().len()
        );
        assert!(f64::from(iterations) < 7.0 * steps as f64);
    }
}
