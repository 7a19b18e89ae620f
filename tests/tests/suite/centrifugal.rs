//! Centrifugal loads against closed forms.

use crate::support::simulation;
use stoss::solver::Simulation;

fn scene(kind: &str, time: &str, rest: &str) -> String {
    format!("[scene]\ntitle = \"turning\"\nkind = \"{kind}\"\n[time]\n{time}\n{rest}")
}

/// A bar of the length 2 along x that is held at the axis.
fn bar(young: f64, law: &str, divisions: usize, load: &str) -> String {
    format!(
        r#"
[[body]]
name = "bar"
mesh = {{ generator = "block", min = [0, 0, 0], max = [2, 0.2, 0.2], divisions = [{divisions}, 1, 1] }}
material = {{ law = "{law}", young = {young:?}, poisson = 0.0 }}
density = 3.0
[[prescribe]]
set = "bar.left"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "bar.all"
components = ["y", "z"]
fixed = true
{load}
"#
    )
}

fn run(simulation: &mut Simulation) {
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
}

/// `sigma(r) = rho w^2 (L^2 - r^2) / 2`, thus `u(r) = rho w^2 (L^2 r - r^3 / 3) / (2 E)`: linear elements meet the displacements of their nodes.
#[test]
fn a_turning_bar_has_the_stress_of_the_textbooks() {
    let (young, density, length, speed) = (1000.0, 3.0, 2.0_f64, 0.01);
    let load = "[[load]]\nbody = \"bar\"\nangular_velocity = 0.01\naxis = [0, 0, 5]\nabout = [0, 0, 7]";
    let mut simulation =
        simulation(&scene("quasi-static", "end = 1.0\nstep = 1.0", &bar(young, "saint-venant-kirchhoff", 5, load)));
    run(&mut simulation);
    let (x, q) = (&simulation.model().reference, &simulation.state().q);
    let largest = density * speed * speed * length.powi(3) / (3.0 * young);
    let mut support = 0.0;
    for c in (0..x.len()).step_by(3) {
        let r = x[c];
        let expected = density * speed * speed / (2.0 * young) * (length * length * r - r.powi(3) / 3.0);
        // The load at the present radius and finite strains are smaller by the strain, 6e-7.
        assert!((q[c] - r - expected).abs() < 2e-6 * largest, "u({r}) = {:e}, {expected:e}", q[c] - r);
        support += simulation.reactions()[c];
    }
    let root = 0.5 * density * speed * speed * length * length * 0.04;
    assert!((support / -root - 1.0).abs() < 2e-6, "{support:e} {root:e}");
}

/// The resultant on a body that hardly deforms is `w^2 m P (x_c - c)`, whatever the axis.
#[test]
fn the_resultant_of_any_axis() {
    let rest = r#"
[[body]]
name = "block"
mesh = { generator = "block", min = [1, 2, 3], max = [2, 4, 4], divisions = [1, 2, 1] }
material = { law = "neo-hooke", young = 1e9, poisson = 0.3 }
density = 3.0
mass = "MASS"
[[prescribe]]
set = "block.left"
components = ["x", "y", "z"]
fixed = true
[[load]]
body = "block"
angular_velocity = { table = [[0, 0], [1, -4]] }
axis = [1, 2, -2]
about = [0.5, 0.0, 1.0]
"#;
    for mass in ["consistent", "lumped"] {
        let text = scene("quasi-static", "end = 1.0\nstep = 0.5", &rest.replace("MASS", mass));
        let mut simulation = simulation(&text);
        run(&mut simulation);
        let arm = [1.0, 3.0, 2.5];
        let axis = [1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0];
        let along: f64 = arm.iter().zip(axis).map(|(a, n)| a * n).sum();
        for i in 0..3 {
            let force: f64 = simulation.reactions().iter().skip(i).step_by(3).sum();
            let expected = -16.0 * 6.0 * (arm[i] - along * axis[i]);
            assert!((force - expected).abs() < 1e-5 * 300.0, "{mass} {i}: {force} {expected}");
        }
    }
}

/// The load grows with the radius: Newton needs its derivative to converge quadratically. And the exact solution of `E u'' + rho w^2 (X + u) = 0` for a law with `P = E u'` is
/// `u = sin(k X) / (k cos(k L)) - X`, `k^2 = rho w^2 / E`; for small `k L` the law does not matter and the softening is a part `(k L)^2 2/5` of the end's displacement.
#[test]
fn the_spin_softens_and_newton_knows() {
    let displacement = |speed: f64| {
        let load = format!("[[load]]\nbody = \"bar\"\nangular_velocity = {speed:?}\naxis = [0, 0, 1]");
        let time = "end = 1.0\nstep = 1.0";
        let mut simulation = simulation(&scene("quasi-static", time, &bar(1000.0, "neo-hooke", 40, &load)));
        let record = simulation.advance().unwrap();
        let residuals: Vec<f64> = record.newton.iter().map(|row| row.residual).collect();
        let end = (0..simulation.model().reference.len()).step_by(3).find(|&c| simulation.model().reference[c] == 2.0);
        (simulation.state().q[end.unwrap()] - 2.0, residuals)
    };
    let (_, residuals) = displacement(8.0);
    let quadratic =
        residuals.windows(2).filter(|r| r[0] < 1e-1 && r[0] > 1e-6).all(|r| r[1] < 3.0 * r[0] * r[0].sqrt());
    assert!(residuals.len() <= 8 && quadratic, "{residuals:?}");
    // Neo-Hooke with nu = 0: P = E/2 (a - 1/a) = E (e - e^2/2), e = a - 1. To second order in s = (k L)^2, with x = X/L:
    // e_1 = s (1 - x^2)/2, and e_2 = s^2 (5/24 - x^2/4 + x^4/24) from the load plus e_1^2/2 from the law; the end moves by L s/3 + L s^2 (2/15 + 1/15).
    let s: f64 = 3.0 * 1.0 * 4.0 / 1000.0;
    let (end, _) = displacement(1.0);
    let second = (end / 2.0 - s / 3.0) / (s * s);
    assert!((second - 0.2).abs() < 0.01, "{second}");
}

#[test]
fn energy_in_dynamics_is_kept_with_the_work_of_the_load() {
    let rest = r#"
[[body]]
name = "block"
mesh = { generator = "block", min = [1, 0, 0], max = [2, 0.5, 0.5], divisions = [3, 1, 1] }
material = { law = "mooney-rivlin", c1 = 300.0, c2 = 150.0, c = 1000.0 }
density = 1.0
velocity = [1.0, 3.0, -2.0]
[[prescribe]]
set = "block.left"
components = ["x", "y", "z"]
fixed = true
[[load]]
body = "block"
angular_velocity = 15.0
axis = [0.1, 0.3, 1.0]
about = [0.2, 0.0, 0.0]
"#;
    let time = "end = 0.3\nstep = 0.005\nmax_cuts = 0\nintegrator = { scheme = \"energy-momentum\" }";
    let mut simulation = simulation(&scene("dynamic", time, rest));
    let first = simulation.balance().total();
    let mut worst = 0.0_f64;
    while !simulation.finished() {
        let balance = simulation.advance().unwrap().balance;
        worst = worst.max((balance.total() - first).abs() / balance.strain.max(first));
    }
    assert!(worst < 1e-11, "{worst:e}");
    assert!(simulation.balance().external_work > 1.0);
}
