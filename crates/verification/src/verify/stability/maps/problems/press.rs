//! Statics: a block on a quarter of a larger one, the same pressure on all free faces. Both are compressed uniformly.

use super::super::case::{Deviation, Problem};
use super::super::text::{Block, PLAIN, Text, Units};
use super::YOUNG;

/// Parts of the pressure by which forces may be off: the tolerance of Newton's method, beside the largest forces of the stiffer body.
const FORCES: f64 = 1e-5;

/// The lower block is 2 x 2 x 1, the upper one 1 x 1 x `height`.
#[derive(Clone, Copy)]
pub struct Press {
    /// Moduli of the upper and the lower block, in parts of [`YOUNG`].
    pub stiffness: [f64; 2],
    /// Poisson's ratio; zero where the moduli differ, so that both are as wide.
    pub poisson: f64,
    /// Whether elements have the mixed form.
    pub is_mixed: bool,
    /// Height of the upper block.
    pub height: f64,
    /// Elements of the upper and the lower block.
    pub divisions: [[u32; 3]; 2],
    /// Whether the lower block is the slave.
    pub lower_is_slave: bool,
    /// Part of the displacement that the method may be off.
    pub tolerance: f64,
    /// Units.
    pub units: Units,
}

impl Default for Press {
    fn default() -> Self {
        Self {
            stiffness: [1.0; 2],
            poisson: 0.0,
            is_mixed: false,
            height: 1.0,
            divisions: [[3, 3, 2], [4, 4, 2]],
            lower_is_slave: false,
            tolerance: 0.02,
            units: PLAIN,
        }
    }
}

/// Stretch along the pressure `p` of a neo-Hooke body `W = mu/2 (tr C - 3 - 2 ln J) + lambda/2 (ln J)^2` that is free sideways:
/// `mu (b - 1/b) + lambda ln(a^2 b) / b = -p`, `mu (a - 1/a) + lambda ln(a^2 b) / a = 0`. The second one gives `ln J = mu (1 - a^2) / lambda`, and the difference of both
/// `mu (b^2 - a^2) = -p b`; `a` follows by bisection.
pub fn stretch(young: f64, poisson: f64, p: f64) -> f64 {
    let (mu, lambda) = (young / (2.0 * (1.0 + poisson)), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)));
    let along = |a: f64| -0.5 * p / mu + (0.25 * (p / mu).powi(2) + a * a).sqrt();
    let (mut low, mut high) = (1.0, 2.0_f64);
    for _ in 0..200 {
        let a = 0.5 * (low + high);
        if mu * (a * a - 1.0) + lambda * (a * a * along(a)).ln() < 0.0 { low = a } else { high = a }
    }
    along(low)
}

impl Press {
    /// The scene for a method.
    pub fn problem(self, method: &str) -> Problem {
        let Self { stiffness, poisson, height, divisions, tolerance, units, .. } = self;
        let more = if self.is_mixed { "volumetric = \"mixed\"\n" } else { "" };
        let block = |name, corners, k: usize| Block {
            name,
            corners,
            divisions: divisions[k],
            young: stiffness[k] * YOUNG,
            poisson,
            density: 0.0,
            more: more.into(),
        };
        let pressure = 0.01 * YOUNG * stiffness[0].min(stiffness[1]);
        let mut text = Text::statics(units, 0.5, 1.0)
            .block(&block("lower", [[0.0, 0.0, -1.0], [2.0, 2.0, 0.0]], 1))
            .block(&block("upper", [[0.0; 3], [1.0, 1.0, height]], 0))
            .set("lower", "beside", [[1.0, 0.0, 0.0], [2.0, 2.0, 0.0]])
            .set("lower", "behind", [[0.0, 1.0, 0.0], [1.0, 2.0, 0.0]]);
        for (set, component) in [("left", "x"), ("front", "y")] {
            for body in ["lower", "upper"] {
                text = text.fixed(&format!("{body}.{set}"), &[component]);
            }
        }
        text = text.fixed("lower.bottom", &["z"]);
        for set in ["upper.top", "lower.beside", "lower.behind"] {
            text = text.pressed(set, pressure, 1.0);
        }
        let edge = 1.0001 * units.length;
        // All of a tied slave has to lie opposite its master.
        let covered = format!("lower.top & x < {edge:?} & y < {edge:?}");
        let sides = match (self.lower_is_slave, method) {
            (false, _) => ["upper.bottom", "lower.top"],
            (true, "tie") => [covered.as_str(), "upper.bottom"],
            (true, _) => ["lower.top", "upper.bottom"],
        };
        let text = text
            .contact(method, sides, 0.0)
            .probe("top", "displacement", "set = \"upper.top\"")
            .probe("support", "reaction", "set = \"lower.bottom\"")
            .probe("force", "contact_force", "set = \"upper.bottom\"");
        let [upper, lower] = stiffness.map(|part| stretch(part * YOUNG, poisson, pressure) - 1.0);
        let (sinks, force) = ((height * upper + lower) * units.length, pressure * units.force());
        let oracle = Box::new(move |seen: &super::super::case::Seen| {
            Ok(vec![
                Deviation::of("displacement", seen.last("top.z")?, sinks, tolerance),
                Deviation::of("support", seen.last("support.z")?, 4.0 * force, FORCES),
                Deviation::of("contact force", seen.last("force.z")?.abs(), force, FORCES),
            ])
        });
        Problem { text, oracle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With a Poisson's ratio of zero `E/2 (b - 1/b) = -p`; of a small pressure Hooke's law; the incompressible body keeps its volume: `mu (b^2 - 1/b) = -p b`.
    #[test]
    fn stretches_are_those_of_limits() {
        let b = stretch(2.0, 0.0, 1.5);
        assert!((b - 1.0 / b + 1.5).abs() < 1e-12);
        assert!((stretch(3.0, 0.3, 3e-7) - 1.0 + 1e-7).abs() < 1e-12);
        let b = stretch(3.0, 0.499_999_999, 0.7);
        assert!((b * b - 1.0 / b + 0.7 * b).abs() < 1e-7);
    }
}
