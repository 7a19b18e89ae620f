//! Rows of bodies that hand an impact on: Newton's cradle, rigid and elastic, and a row of dominoes.
//!
//! Dominoes that stand on their edges without slipping, have no friction between them and meet plastically lean on each other from then on, and the row has one degree of freedom: the tilt of the
//! foremost one. Between impacts its energy is constant, in an impact its momentum (J. M. J. van Leeuwen, *The domino effect*, American Journal of Physics 78, 2010).

use super::scene::{probe, run};
use super::{ENERGY, MOMENTUM, check};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::workspace::Outcome;
use std::fmt::Write as _;

/// Measures both cradles and the dominoes.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    rigid_cradle(findings)?;
    elastic_cradle(if quick { 10 } else { 20 }, findings)?;
    dominoes(if quick { 5 } else { 8 }, findings)
}

const FIVE: std::ops::Range<usize> = 0..5;

/// Runs a scene; the momenta of five bodies along x, beside that of the first one at the start, the largest change of the books beside the energy, and the rest of the energy.
fn handed_on(text: &str, name: &str, momentum: f64, energy: f64) -> Outcome<([f64; 5], f64, f64)> {
    let (mut last, mut worst) = ([0.0; 5], 0.0_f64);
    let simulation = run(&text.parse()?, name, |simulation, probes, record| {
        last = std::array::from_fn(|k| probe(probes, &format!("p{k}"), simulation)[0] / momentum);
        let books = record.balance.total() + record.balance.closing_loss + record.balance.impact_loss;
        worst = worst.max((books / energy - 1.0).abs());
    })?;
    Ok((last, worst, simulation.balance().total() / energy))
}

/// Five boxes that touch, elastic: the last one leaves with the speed of the first one, the others rest.
fn rigid_cradle(findings: &mut Findings) -> Outcome<()> {
    let mut text = "scene = { title = \"Newton's cradle\", kind = \"dynamic\" }\ntime = { end = 0.4, step = 0.01, integrator = { scheme = \"energy-momentum\" } }\n".to_owned();
    for k in FIVE {
        let (x, v) = if k == 0 { (-0.0537, 1.0) } else { (0.1 * k as f64, 0.0) };
        let _ = write!(
            text,
            "[[rigid]]\nname = \"b{k}\"\nshape = {{ kind = \"box\", size = [0.1, 0.1, 0.1] }}\nposition = [{x:?}, 0, 0]\ndensity = 1.0\nvelocity = [{v:?}, 0, 0]\n\
             [[probe]]\nname = \"p{k}\"\nquantity = \"linear_momentum\"\nbody = \"b{k}\"\n"
        );
    }
    for k in 0..4 {
        let _ = write!(
            text,
            "[[contact]]\nslave = \"b{}.left\"\nmaster = \"b{k}.right\"\nmethod = \"nts\"\nrestitution = 1.0\n",
            k + 1
        );
    }
    let (last, books, _) = handed_on(&text, "cradle", 1e-3, 0.5e-3)?;
    let off = FIVE.map(|k| (last[k] - if k == 4 { 1.0 } else { 0.0 }).abs()).fold(0.0, f64::max);
    let name = "cradle of five rigid boxes";
    check(findings, name, "velocities, against 0 0 0 0 1", off, Bound::AtMost(ENERGY));
    check(findings, name, "energy with its losses, change", books, Bound::AtMost(ENERGY));
    Ok(())
}

/// Five equal elastic bars that touch, of `n` elements each, right ends without mass: the wave of the impact runs through the row, and the last bar leaves with all of it. What is missing is vibration of the mesh.
fn elastic_cradle(n: u32, findings: &mut Findings) -> Outcome<()> {
    let (speed, width) = (1e-3, 1.0 / f64::from(n));
    let step = 0.3 * width;
    let mut text = format!(
        "scene = {{ title = \"Newton's cradle of bars\", kind = \"dynamic\" }}\ntime = {{ end = 8.0, step = {step:?}, integrator = {{ scheme = \"energy-momentum\" }} }}\n"
    );
    for k in FIVE {
        let (x, v) = if k == 0 { (-2.4 * speed * step, speed) } else { (k as f64, 0.0) };
        let _ = write!(
            text,
            "[[body]]\nname = \"b{k}\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, {width:?}, {width:?}], divisions = [{n}, 1, 1] }}\nposition = [{x:?}, 0, 0]\n\
             material = {{ law = \"saint-venant-kirchhoff\", young = 1.0, poisson = 0.0 }}\ndensity = 1.0\nvelocity = [{v:?}, 0, 0]\n\
             [[probe]]\nname = \"p{k}\"\nquantity = \"linear_momentum\"\nbody = \"b{k}\"\n"
        );
    }
    for k in 0..4 {
        let _ = write!(
            text,
            "[[contact]]\nslave = \"b{k}.right\"\nmaster = \"b{}.left\"\nmethod = \"nts\"\nsurface_mass = \"none\"\n",
            k + 1
        );
    }
    let mass = width * width;
    let (last, books, rest) = handed_on(&text, "bars", mass * speed, 0.5 * mass * speed * speed)?;
    let name = format!("cradle of five elastic bars of {n} elements");
    check(findings, &name, "velocity of the last one (exact: 1)", last[4], Bound::Near { value: 1.0, tolerance: 0.03 });
    let others = last[..4].iter().fold(0.0_f64, |worst, v| worst.max(v.abs()));
    check(findings, &name, "largest velocity of the others (exact: 0)", others, Bound::AtMost(0.04));
    check(findings, &name, "momentum, change", (last.iter().sum::<f64>() - 1.0).abs(), Bound::AtMost(MOMENTUM));
    check(findings, &name, "energy with its losses, change", books, Bound::AtMost(ENERGY));
    check(findings, &name, "energy that is lost", (rest - 1.0).abs(), Bound::AtMost(1e-9));
    Ok(())
}

/// Height, thickness and gap of dominoes; gravity and the spin of the first one are one.
const HEIGHT: f64 = 1.0;
const THICKNESS: f64 = 0.15;
const GAP: f64 = 0.3;

/// A row of dominoes that lean on each other, by the tilt of the foremost one.
struct Row {
    leaning: usize,
}

impl Row {
    /// Tilt of a domino from that of the next one, on which its upper edge leans, and the rate of the one beside that of the other.
    fn behind(tilt: f64) -> [f64; 2] {
        let reach = ((GAP + THICKNESS) * tilt.cos() - THICKNESS) / HEIGHT;
        let slope = -(GAP + THICKNESS) * tilt.sin() / HEIGHT;
        [tilt + reach.asin(), 1.0 + slope / (1.0 - reach * reach).sqrt()]
    }

    /// Inertia for the rate of the foremost one, and potential; of unit mass each.
    fn inertia_and_potential(&self, tilt: f64) -> [f64; 2] {
        let square = HEIGHT * HEIGHT + THICKNESS * THICKNESS;
        let (mut at, mut rate, mut sums) = (tilt, 1.0, [0.0; 2]);
        for k in 0..=self.leaning {
            sums[0] += square / 3.0 * rate * rate;
            sums[1] += 0.5 * square.sqrt() * (at - THICKNESS.atan2(HEIGHT)).cos();
            if k < self.leaning {
                let [tilt, slope] = Self::behind(at);
                (at, rate) = (tilt, rate * slope);
            }
        }
        sums
    }

    /// Time until the foremost domino reaches the next one, and its rate there: quadrature of the energy.
    fn fall(&self, rate: f64) -> [f64; 2] {
        let end = (GAP / HEIGHT).asin();
        let [inertia, potential] = self.inertia_and_potential(0.0);
        let energy = 0.5 * inertia * rate * rate + potential;
        let at = |tilt: f64| {
            let [inertia, potential] = self.inertia_and_potential(tilt);
            (2.0 * (energy - potential) / inertia).sqrt()
        };
        // Simpson's rule.
        let n = 2000;
        let weight = |k: usize| if k == 0 || k == n { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
        let sum: f64 = (0..=n).map(|k| weight(k) / at(end * k as f64 / n as f64)).sum();
        [end / (3.0 * n as f64) * sum, at(end)]
    }

    /// Times at which the dominoes of a row of `count` meet.
    fn times(count: usize) -> Vec<f64> {
        let (mut time, mut rate, mut times) = (0.0, 1.0, Vec::new());
        for leaning in 0..count - 1 {
            let row = Self { leaning };
            let [lasts, end] = row.fall(rate);
            time += lasts;
            times.push(time);
            // The next one begins to turn with them.
            let [inertia, _] = row.inertia_and_potential((GAP / HEIGHT).asin());
            let ratio = 1.0 / Self::behind(0.0)[1];
            let own = (HEIGHT * HEIGHT + THICKNESS * THICKNESS) / 3.0;
            rate = ratio * end * inertia / (inertia + own * ratio * ratio);
        }
        times
    }
}

fn dominoes(count: usize, findings: &mut Findings) -> Outcome<()> {
    let expected = Row::times(count);
    let mut errors = Vec::new();
    let name = format!("row of {count} dominoes");
    for step in [0.01, 0.005] {
        let end = expected[count - 2] + 0.1;
        let mut text = format!(
            "scene = {{ title = \"Dominoes\", kind = \"dynamic\" }}\ntime = {{ end = {end:?}, step = {step:?}, integrator = {{ scheme = \"energy-momentum\" }} }}\n\
             gravity = {{ acceleration = [0, 0, -1] }}\n[[rigid]]\nname = \"floor\"\nshape = {{ kind = \"plane\", size = [30, 10] }}\nfixed = true\n"
        );
        for k in 0..count {
            // It turns about its lower edge.
            let spin = if k == 0 { 1.0 } else { 0.0 };
            let _ = write!(
                text,
                "[[rigid]]\nname = \"d{k}\"\nshape = {{ kind = \"box\", size = [{THICKNESS:?}, 0.5, {HEIGHT:?}] }}\nposition = [{:?}, 0, {:?}]\ndensity = 1.0\n\
                 angular_velocity = [0, {spin:?}, 0]\nvelocity = [{:?}, 0, {:?}]\n[[probe]]\nname = \"p{k}\"\nquantity = \"angular_velocity\"\nbody = \"d{k}\"\n\
                 [[contact]]\nslave = \"d{k}.bottom\"\nmaster = \"floor.all\"\nmethod = \"nts\"\nfriction = {{ law = \"coulomb\", mu = 3.0 }}\n",
                k as f64 * (GAP + THICKNESS),
                0.5 * HEIGHT,
                0.5 * HEIGHT * spin,
                0.5 * THICKNESS * spin
            );
        }
        for k in 0..count - 1 {
            let _ =
                write!(text, "[[contact]]\nslave = \"d{k}.right\"\nmaster = \"d{}.left\"\nmethod = \"nts\"\n", k + 1);
        }
        let mut times = vec![f64::NAN; count - 1];
        let (mut first, mut books) = (None, 0.0_f64);
        run(&text.parse()?, "dominoes", |simulation, probes, record| {
            let now = record.balance.total() + record.balance.closing_loss + record.balance.impact_loss;
            books = books.max((now - *first.get_or_insert(now)).abs() / simulation.balance().largest_energy);
            for (k, time) in times.iter_mut().enumerate().filter(|(_, time)| time.is_nan()) {
                if probe(probes, &format!("p{}", k + 1), simulation)[1] > 0.05 {
                    // It was hit in the step.
                    *time = record.time - 0.5 * record.dt;
                }
            }
        })?;
        let in_order = times.windows(2).filter(|pair| pair[0] < pair[1]).count() as f64;
        check(
            findings,
            &name,
            format!("step {step}: they fall in order, pairs"),
            in_order,
            Bound::Near { value: (count - 2) as f64, tolerance: 0.0 },
        );
        errors.push(times.iter().zip(&expected).map(|(t, e)| (t - e).abs()).fold(0.0, f64::max));
        check(findings, &name, format!("step {step}: energy with its losses, change"), books, Bound::AtMost(ENERGY));
    }
    let what = "times of the impacts against the row with one degree of freedom, error";
    check(findings, &name, format!("step 0.01: {what}"), errors[0], Bound::AtMost(0.01));
    check(findings, &name, format!("step 0.005: {what}"), errors[1], Bound::AtMost(0.005));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rate by differences; far along the row the times between impacts fall towards a limit.
    #[test]
    fn a_row_of_dominoes() {
        let d = 1e-5;
        let slope = (Row::behind(0.2 + d)[0] - Row::behind(0.2 - d)[0]) / (2.0 * d);
        assert!((slope - Row::behind(0.2)[1]).abs() < 1e-8);
        let times = Row::times(30);
        let speeds: Vec<f64> = times.windows(2).map(|pair| (GAP + THICKNESS) / (pair[1] - pair[0])).collect();
        let last = &speeds[speeds.len() - 2..];
        assert!((last[1] - last[0]).abs() < 1e-3 && last[1] > speeds[0], "{speeds:?}");
    }
}
