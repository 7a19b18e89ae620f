//! An elastic blunt tip that is pressed on a rigid wavy obstacle of up to 10^5 facets and drawn over it.

use super::noted;
use crate::verify::check::Bound;
use crate::verify::numbers::larger;
use crate::verify::run::Run;
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;
use std::f64::consts::PI;

/// Height and wave number of the waves `z = A sin(k x) cos(k y)`; the obstacle is a square with the edge length `SIZE`.
const WAVE: [f64; 2] = [0.05, PI];
const SIZE: f64 = 4.0;
/// Radius of the tip, friction coefficient, and way along x between the times 1 and 2.
const RADIUS: f64 = 0.8;
const FRICTION: f64 = 0.2;
const WAY: f64 = 0.5;
/// Time from which on all of the contact slides: at time 1 it sticks in parts.
const SLIDES: f64 = 1.45;
/// Elastic shift of the zone and skewness of the pressure, which the closed form of the rigid ball does not have.
const DIRECTION: f64 = 0.01;

/// Binary STL: 2 `n`^2 triangles whose corners are on the waves.
fn waves(n: usize) -> Vec<u8> {
    let at = |i: usize| SIZE * (i as f64 / n as f64 - 0.5);
    let height = |x: f64, y: f64| WAVE[0] * (WAVE[1] * x).sin() * (WAVE[1] * y).cos();
    let mut bytes = vec![0; 80];
    bytes.extend((2 * n * n).to_le_bytes().iter().take(4));
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        for corners in [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]] {
            // The normal, which follows from the corners.
            bytes.extend([0; 12]);
            for (x, y) in corners.map(|(a, b)| (at(i + a), at(j + b))) {
                bytes.extend([x, y, height(x, y)].iter().flat_map(|c| (*c as f32).to_le_bytes()));
            }
            bytes.extend([0; 2]);
        }
    }
    bytes
}

/// Slope of the waves where a ball with its axis at `x`, y = 0, touches them: `(c - x) / R = A k cos(k c)`, for a slope that is small as in the tip's mesh.
fn slope(x: f64) -> f64 {
    let (mut low, mut high) = (x - RADIUS, x + RADIUS);
    for _ in 0..80 {
        let c = 0.5 * (low + high);
        if (c - x) / RADIUS < WAVE[0] * WAVE[1] * (WAVE[1] * c).cos() { low = c } else { high = c }
    }
    (low - x) / RADIUS
}

/// Tip of 12 x 12 elements on an obstacle of 2 `n`^2 facets; the watch looks at each step.
fn scene(method: &str, file: &str) -> String {
    format!(
        r#"
        scene = {{ title = "Elastic tip drawn over a wavy obstacle", kind = "quasi-static" }}
        time = {{ end = 2.0, step = 0.05 }}
        watch = {{ every = 1 }}
        output = {{ every = 1000 }}
        rigid = [{{ name = "obstacle", surface = {{ file = "{file}" }}, fixed = true }}]
        contact = [{{ method = "{method}", slave = "tip.bottom", master = "obstacle.all", friction = {{ law = "coulomb", mu = {FRICTION:?} }} }}]
        probe = [
            {{ name = "contact", set = "tip.bottom", quantity = "contact_force" }},
            {{ name = "reaction", set = "tip.top", quantity = "reaction" }},
        ]
        [[body]]
        name = "tip"
        mesh = {{ generator = "indenter", size = [0.6, 0.6], height = 0.6, radius = {RADIUS:?}, divisions = [12, 12, 5] }}
        position = [0, 0, 0.01]
        material = {{ law = "neo-hooke", young = 100.0, poisson = 0.3 }}
        [[prescribe]]
        set = "tip.top"
        components = ["x", "y", "z"]
        displacement = {{ table = [[0.0, 0, 0, 0], [1.0, 0, 0, -0.06], [2.0, {WAY:?}, 0, 0.0]] }}
        "#
    )
}

/// Forces of the contact on the tip at all steps.
fn forces(run: &Run, name: &str) -> Outcome<Vec<[f64; 3]>> {
    let table = run.table("probes.csv")?;
    let columns = ["x", "y", "z"].map(|c| table.column(&format!("{name}.{c}")));
    let [x, y, z] = columns.map(|column| column.map(<[f64]>::to_vec));
    Ok(x?.into_iter().zip(y?).zip(z?).map(|((x, y), z)| [x, y, z]).collect())
}

/// The full suite only: obstacles of 6272, 25088 and 100352 facets with mortar, the last one also with `nts`.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    if bench.quick {
        return Ok(());
    }
    for (method, divisions) in [("mortar", &[56, 112, 224][..]), ("nts", &[224])] {
        let case = format!("tip on an obstacle, {method}");
        let mut presses = Vec::new();
        for &n in divisions {
            let file = format!("waves-{n}.stl");
            let folder = bench.folder.join("scenes");
            std::fs::create_dir_all(&folder)?;
            std::fs::write(folder.join(&file), waves(n))?;
            let run = bench.run_variant(&format!("obstacle-{method}-{n}"), &scene(method, &file).parse()?)?;
            findings.checks.push(run.completed(0));
            let time = run.table("probes.csv")?.column("time")?.to_vec();
            let (contact, reaction) = (forces(&run, "contact")?, forces(&run, "reaction")?);
            let (mut balance, mut direction, mut count) = (0.0, 0.0, 0);
            let most = contact.iter().fold(0.0_f64, |most, f| most.max(f[2].abs()));
            for ((t, f), r) in time.iter().zip(&contact).zip(&reaction) {
                let apart = (0..3).fold(0.0_f64, |sum, i| sum + (f[i] + r[i]).powi(2)).sqrt();
                balance = larger(balance, apart / most);
                if *t > SLIDES {
                    let expected = (slope(WAY * (t - 1.0)).atan() + FRICTION.atan()).tan();
                    direction = larger(direction, (-f[0] / f[2] / expected - 1.0).abs());
                    count += 1;
                }
            }
            presses.extend(contact.last().map(|f| f[2]));
            if n == 224 {
                let mut row =
                    |quantity, value, bound, note: String| noted(findings, &case, quantity, value, bound, note);
                row(
                    "force of the contact and reaction, over the largest force",
                    balance,
                    Bound::AtMost(1e-9),
                    "100352 facets".into(),
                );
                let note = format!("tan(slope + atan mu), slope where a rigid ball touches the waves; {count} steps");
                row(
                    "resistance over pressing force, over the closed form, less one",
                    direction,
                    Bound::AtMost(DIRECTION),
                    note,
                );
                let verdict = run.verdict()?;
                let wrong = if verdict == "wrong" { 1.0 } else { 0.0 };
                row(
                    "wrong by the watch",
                    wrong,
                    Bound::Near { value: 0.0, tolerance: 0.0 },
                    format!("{verdict}: {}", run.reasons()),
                );
            }
        }
        if let [coarse, middle, fine] = presses[..] {
            let order = ((coarse - middle) / (middle - fine)).abs().log2();
            let note = format!("last force {coarse:.5}, {middle:.5}, {fine:.5}");
            noted(
                findings,
                &case,
                "order of the force in the obstacle's facets",
                order,
                Bound::AtLeast(super::ORDER),
                note,
            );
            let change = (middle / fine - 1.0).abs();
            noted(findings, &case, "force, 25088 facets less 100352, over it", change, Bound::AtMost(5e-3), "");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_a_crest_the_slope_is_zero_and_before_it_less_than_under_the_axis() {
        assert!(slope(0.5).abs() < 1e-12);
        let under = WAVE[0] * WAVE[1] * (WAVE[1] * 0.25).cos();
        assert!(slope(0.25) > 0.0 && slope(0.25) < under);
    }

    #[test]
    fn waves_are_a_binary_file_of_their_length() {
        assert_eq!(waves(3).len(), 84 + 50 * 18);
        assert_eq!(waves(3)[80..84], 18_u32.to_le_bytes());
    }
}
