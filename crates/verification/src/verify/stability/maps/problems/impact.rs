//! Dynamics: a cube falls off centre on a flat block, both fly freely.

use super::super::case::{Deviation, Problem, Seen};
use super::super::text::{Block, PLAIN, Text, Units};
use super::{YOUNG, bar_speed};
use crate::verify::numbers::largest;

/// What momenta and energy may be off, where they are exact but for Newton's tolerance.
const EXACT: f64 = 1e-7;

/// Crossings of the body that decides by which an impact has stopped the approach.
const STOPPED: f64 = 3.0;

/// The upper body, 1 x 1 x `height`, falls with the speed `speed` on one of 2 x 2 x 1.
#[derive(Clone, Copy)]
pub struct Impact {
    /// Moduli of the upper and the lower body, in parts of [`YOUNG`].
    pub stiffness: [f64; 2],
    /// Densities of both.
    pub density: [f64; 2],
    /// Poisson's ratio.
    pub poisson: f64,
    /// Speed of the upper body, in parts of that of waves in a bar.
    pub speed: f64,
    /// Distance at the start, negative for an overlap; none: the way of a fifth of a step.
    pub gap: Option<f64>,
    /// Step, in crossings of an element of the softer or lighter body.
    pub crossings: f64,
    /// Steps after the gap has closed.
    pub steps: u32,
    /// Height of the upper body.
    pub height: f64,
    /// Elements of the upper and the lower body.
    pub divisions: [[u32; 3]; 2],
    /// Whether the lower body is the slave.
    pub lower_is_slave: bool,
    /// Units.
    pub units: Units,
}

impl Default for Impact {
    fn default() -> Self {
        Self {
            stiffness: [1.0; 2],
            density: [1.0; 2],
            poisson: 0.3,
            speed: 0.03,
            gap: None,
            crossings: 0.25,
            steps: 30,
            height: 1.0,
            divisions: [[2, 2, 2], [2, 2, 1]],
            lower_is_slave: false,
            units: PLAIN,
        }
    }
}

impl Impact {
    /// Speed of waves in the body that decides how long the impact lasts (the softer one, else the lighter one), its height, and that of its elements.
    fn decides(&self) -> [f64; 3] {
        let [upper, lower] = [0, 1].map(|k| bar_speed(self.stiffness[k] * YOUNG, self.density[k]));
        let is_upper = match self.density[0] == self.density[1] {
            true => self.stiffness[0] <= self.stiffness[1],
            false => self.density[0] <= self.density[1],
        };
        if is_upper {
            [upper, self.height, self.height / f64::from(self.divisions[0][2])]
        } else {
            [lower, 1.0, 1.0 / f64::from(self.divisions[1][2])]
        }
    }

    /// The scene for a method with the energy-momentum scheme.
    pub fn problem(self, method: &str) -> Problem {
        let Self { stiffness, density, height, divisions, units, .. } = self;
        let [wave, crossed, element] = self.decides();
        let speed = self.speed * bar_speed(YOUNG, 1.0);
        let step = self.crossings * element / wave;
        let gap = self.gap.unwrap_or(0.2 * speed * step);
        let falls = gap.max(0.0) / speed;
        let end = (f64::from(self.steps) + (falls / step).floor()) * step;
        let body = |name, corners, k: usize, more: String| Block {
            name,
            corners,
            divisions: divisions[k],
            young: stiffness[k] * YOUNG,
            poisson: self.poisson,
            density: density[k],
            more,
        };
        let velocity = format!("velocity = [0.0, 0.0, {:?}]\n", -speed * units.velocity());
        let sides = ["upper.bottom", "lower.top"];
        let text = Text::dynamics(units, "energy-momentum", step, end)
            .block(&body("lower", [[-0.5, -0.5, -1.0], [1.5, 1.5, 0.0]], 1, String::new()))
            .block(&body("upper", [[0.1, 0.05, gap], [1.1, 1.05, gap + height]], 0, velocity))
            .contact(method, if self.lower_is_slave { [sides[1], sides[0]] } else { sides }, 0.0)
            .probe("upper", "linear_momentum", "body = \"upper\"")
            .probe("lower", "linear_momentum", "body = \"lower\"")
            .probe("bottom", "position", "set = \"upper.bottom\"")
            .probe("top", "position", "set = \"lower.top\"");
        let masses = [height * density[0] * units.mass, 4.0 * density[1] * units.mass];
        let lasts = end - falls > STOPPED * crossed / wave;
        let oracle =
            Box::new(move |seen: &Seen| deviations(seen, masses, speed * units.velocity(), units.length, lasts));
        Problem { text, oracle }
    }
}

/// Both momenta stay together what they were, and have no more energy than there was; contact exchanges between half of what stops the approach and all that an elastic impact does; the bodies
/// stay on their sides.
fn deviations(
    seen: &Seen,
    masses: [f64; 2],
    speed: f64,
    unit: f64,
    lasts: bool,
) -> crate::workspace::Outcome<Vec<Deviation>> {
    let (upper, lower) = (seen.vectors("upper")?, seen.vectors("lower")?);
    let start = masses[0] * speed;
    let sum = |i: usize, k: usize| upper[k][i] + lower[k][i] + if i == 2 { start } else { 0.0 };
    let change = largest((0..upper.len()).flat_map(|k| (0..3).map(move |i| sum(i, k).abs()))) / start;
    let rigid = |k: usize| upper[k][2].powi(2) / (2.0 * masses[0]) + lower[k][2].powi(2) / (2.0 * masses[1]);
    let most = largest((0..upper.len()).map(rigid)) / (0.5 * start * speed);
    let exchanged = upper.last().map_or(f64::NAN, |last| last[2] + start);
    let stops = exchanged / (masses[0] * masses[1] / (masses[0] + masses[1]) * speed);
    let (bottom, top) = (seen.probes.column("bottom.z")?, seen.probes.column("top.z")?);
    let depth = largest(bottom.iter().zip(top).map(|(bottom, top)| (top - bottom).max(0.0) / unit));
    let [gain, _] = seen.energy()?;
    let outside = if stops > 2.0 || stops.is_nan() {
        stops - 2.0
    } else if lasts {
        (0.5 - stops).max(0.0)
    } else {
        0.0
    };
    Ok(vec![
        Deviation::zero("momentum", change, EXACT),
        Deviation::zero("gain of energy", gain.max(0.0), EXACT),
        Deviation::zero("energy of the motion", (most - 1.0).max(0.0), EXACT),
        Deviation::zero("impulse", outside, 1e-6),
        Deviation::zero("depth", depth, 0.1),
    ])
}
