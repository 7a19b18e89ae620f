//! Laws of friction of one's own, used from a scene: Coulomb's bound with a limit of the shear, and viscous friction, which cannot stick.
//!
//! Shown: the trait `FrictionLaw`, constructors that read the parameters of a scene, a run with each law.
//! Checked: derivatives of the coefficient against differences, the speed of a braked block against closed forms.
//!
//! `cargo run --example own_friction_law -p stoss`; docs/how-to-add/friction-law.md explains it.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use stoss::build::{FrictionLawResult, LawParameters, OwnLaws, ParameterError, build_with};
use stoss::contact::friction::{Coefficient, FrictionLaw, Sliding};
use stoss::scene::parse_with;

/// Shear-limited friction, `|tau| <= min(mu p, strength)` (Tresca's bound over Coulomb's).
#[derive(Debug)]
pub struct ShearLimited {
    mu: f64,
    strength: f64,
}

impl FrictionLaw for ShearLimited {
    fn name(&self) -> &str {
        "shear-limited"
    }
    fn coefficient(&self, at: &Sliding) -> Coefficient {
        if self.mu * at.pressure < self.strength {
            return Coefficient { value: self.mu, ..Coefficient::default() };
        }
        let value = self.strength / at.pressure;
        Coefficient { value, d_pressure: -value / at.pressure, d_slip: 0.0 }
    }
}

/// Traction proportional to the velocity of the slip; the factor is a stress over a velocity.
#[derive(Debug)]
pub struct Viscous(f64);

impl FrictionLaw for Viscous {
    fn name(&self) -> &str {
        "viscous"
    }
    fn coefficient(&self, at: &Sliding) -> Coefficient {
        let slope = self.0 / (at.step_size * at.pressure);
        Coefficient { value: slope * at.slip, d_pressure: -slope * at.slip / at.pressure, d_slip: slope }
    }
    fn sticks(&self) -> bool {
        false
    }
}

/// The law from `friction = { law = "shear-limited", mu = .., strength = .. }`.
pub fn shear_limited(parameters: &LawParameters<'_>) -> FrictionLawResult {
    let (mu, strength) = (parameters.number("mu")?, parameters.number_or("strength", f64::INFINITY)?);
    if mu < 0.0 {
        return Err(ParameterError::new("mu", "must not be negative", "enlarge mu").into());
    }
    Ok(Arc::new(ShearLimited { mu, strength }))
}

/// The names that scenes may use.
pub fn laws() -> OwnLaws {
    let viscous = |parameters: &LawParameters<'_>| -> FrictionLawResult {
        Ok(Arc::new(Viscous(parameters.number("viscosity")?)))
    };
    let laws = OwnLaws::default().with_friction("shear-limited", shear_limited);
    laws.and_then(|laws| laws.with_friction("viscous", viscous)).expect("the catalogue has no law of these names")
}

/// A block that slides on a level plate with the velocity 2: mass 1/2 on an area of 1, weight 5.
pub const SLIDING: &str = include_str!("own_friction_law.toml");

/// The entry of [`SLIDING`] that names the law.
pub const FRICTION: &str = "{ law = \"shear-limited\", mu = 0.3, strength = 0.4 }";

/// Speed of the block at the end of [`SLIDING`], with the given entry for the law.
pub fn final_speed(friction: &str) -> Result<f64, Box<dyn Error>> {
    speed_of(&SLIDING.replace(FRICTION, friction))
}

/// Speed of the body 1 of a scene of the mass 1/2 at the end.
pub fn speed_of(scene: &str) -> Result<f64, Box<dyn Error>> {
    let laws = laws();
    let scene = parse_with(scene, "sliding.toml", &laws.names())?;
    let mut simulation = build_with(&scene, Path::new("."), &laws)?.simulation;
    while !simulation.finished() {
        simulation.advance()?;
    }
    Ok(simulation.body_balance(1).linear_momentum[0] / 0.5)
}

/// Largest difference between the derivatives of a coefficient and its central differences.
fn derivatives(law: &dyn FrictionLaw, at: &Sliding) -> f64 {
    let (found, h) = (law.coefficient(at), 1e-6);
    let slope = |change: &dyn Fn(f64) -> Sliding| {
        (law.coefficient(&change(h)).value - law.coefficient(&change(-h)).value) / (2.0 * h)
    };
    let by_pressure = slope(&|h| Sliding { pressure: at.pressure + h, ..*at });
    let by_slip = slope(&|h| Sliding { slip: at.slip + h, ..*at });
    (by_pressure - found.d_pressure).abs().max((by_slip - found.d_slip).abs())
}

/// Prints and checks.
pub fn main() -> Result<(), Box<dyn Error>> {
    let laws: [&dyn FrictionLaw; 2] = [&ShearLimited { mu: 0.3, strength: 0.4 }, &Viscous(0.5)];
    for law in laws {
        for pressure in [0.5, 5.0] {
            let worst = derivatives(law, &Sliding { pressure, slip: 0.02, step_size: 0.01, slid: 0.0 });
            println!("{}, pressure {pressure}: derivatives against differences {worst:.1e}", law.name());
            assert!(worst < 1e-8, "{worst:e}");
        }
    }
    // Half a unit of time: the bound takes 0.4 x 0.5 off the momentum of a mass of 1/2; each step of backward Euler
    // with the viscous law divides the velocity by 1 + c h A / m = 1.01.
    println!("law             final speed   closed form");
    for (name, friction, expected) in [
        ("shear-limited", FRICTION, 2.0 - 0.4 * 0.5 / 0.5),
        ("viscous", "{ law = \"viscous\", viscosity = 0.5 }", 2.0 * 1.01_f64.powi(-50)),
    ] {
        let speed = final_speed(friction)?;
        println!("{name:14} {speed:12.5} {expected:13.5}");
        assert!((speed / expected - 1.0).abs() < 1e-3, "{speed} {expected}");
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
