//! Dynamics without contact: a bar that turns and is stretched, also one of two tied halves.

use super::super::case::{Deviation, Problem, Seen};
use super::super::text::{Block, PLAIN, Text, Units};
use super::{YOUNG, bar_speed};
use crate::verify::numbers::{distance, largest, norm};

/// Gain of energy, over the start, that schemes may have.
const GAIN: f64 = 0.01;

/// Loss of energy that schemes of the second order may have.
const LOSS: f64 = 0.3;

/// Change of angular momentum, over the start.
const TURN: f64 = 0.05;

/// A bar of `size` about the origin. Speeds are parts of that of waves in it.
#[derive(Clone, Copy)]
pub struct Flight {
    /// Modulus and density of the second half, in parts of those of the first, where they are tied.
    pub other: [f64; 2],
    /// Poisson's ratio.
    pub poisson: f64,
    /// Whether elements have the mixed form.
    pub is_mixed: bool,
    /// Step, in crossings of an element.
    pub crossings: f64,
    /// Number of steps.
    pub steps: u32,
    /// Edges.
    pub size: [f64; 3],
    /// Elements.
    pub divisions: [u32; 3],
    /// Elements of the second half.
    pub other_divisions: [u32; 3],
    /// Speed of its ends by the rotation.
    pub spin: f64,
    /// Units.
    pub units: Units,
}

impl Default for Flight {
    fn default() -> Self {
        Self {
            other: [1.0; 2],
            poisson: 0.3,
            is_mixed: false,
            crossings: 0.5,
            steps: 20,
            size: [2.0, 1.0, 1.0],
            divisions: [2, 1, 1],
            other_divisions: [1, 2, 2],
            spin: 0.02,
            units: PLAIN,
        }
    }
}

impl Flight {
    /// The scene for a scheme; with `is_tied` of two halves.
    pub fn problem(self, scheme: &str, is_tied: bool) -> Problem {
        let Self { size, divisions, units, .. } = self;
        let bar = bar_speed(YOUNG, 1.0);
        let wave = if is_tied { bar.max(bar_speed(YOUNG * self.other[0], self.other[1])) } else { bar };
        let element = (0..3).map(|i| size[i] / f64::from(divisions[i])).fold(f64::INFINITY, f64::min);
        let step = self.crossings * element / wave;
        let omega = 2.0 * self.spin * bar / (size[0] * units.time);
        let stretching = 0.02 * bar / (size[0] * units.time);
        let more = format!(
            "velocity = [{:?}, 0.0, 0.0]\nangular_velocity = [{:?}, {:?}, {omega:?}]\n\
             velocity_gradient = [[{stretching:?}, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]\n{}",
            0.01 * bar * units.velocity(),
            0.3 * omega,
            0.2 * omega,
            if self.is_mixed { "volumetric = \"mixed\"\n" } else { "" }
        );
        let half = size.map(|edge| 0.5 * edge);
        let body = |name, corners, divisions, [stiffness, density]: [f64; 2]| Block {
            name,
            corners,
            divisions,
            young: YOUNG * stiffness,
            poisson: self.poisson,
            density,
            more: more.clone(),
        };
        let text = Text::dynamics(units, scheme, step, f64::from(self.steps) * step);
        let [low, high] = [half.map(|x| -x), half];
        let text = if is_tied {
            let divisions = [divisions[0].div_ceil(2), divisions[1], divisions[2]];
            text.block(&body("a", [low, [0.0, half[1], half[2]]], divisions, [1.0; 2]))
                .block(&body("b", [[0.0, low[1], low[2]], high], self.other_divisions, self.other))
                .contact("tie", ["b.left", "a.right"], 0.0)
        } else {
            text.block(&body("a", [low, high], divisions, [1.0; 2]))
        };
        let text = text.probe("linear", "linear_momentum", "").probe("angular", "angular_momentum", "");
        let (keeps, damps) = (scheme == "energy-momentum", scheme == "backward-euler");
        let oracle = Box::new(move |seen: &Seen| {
            let change = |name: &str| -> crate::workspace::Outcome<f64> {
                let all = seen.vectors(name)?;
                let first = *all.first().ok_or("probes.csv has no row")?;
                Ok(largest(all.iter().map(|now| distance(*now, first))) / norm(first))
            };
            let [gain, loss] = seen.energy()?;
            let [gains, loses] = if keeps { [1e-7; 2] } else { [GAIN, LOSS] };
            let mut found = vec![
                Deviation::zero("linear momentum", change("linear")?, 1e-7),
                Deviation::zero("angular momentum", change("angular")?, if keeps { 1e-7 } else { TURN }),
                Deviation::zero("gain of energy", gain.max(0.0), gains),
            ];
            if !damps {
                found.push(Deviation::zero("loss of energy", loss.max(0.0), loses));
            }
            Ok(found)
        });
        Problem { text, oracle }
    }
}
