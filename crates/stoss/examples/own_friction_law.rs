//! Laws of friction of one's own, used from a scene: Coulomb's bound with a limit of the shear, and viscous friction, which cannot stick.
//!
//! Shown: the trait `FrictionLaw`, constructors that read the parameters of a scene, a run with each law.
//! Checked: derivatives of the traction against differences, the speed of a braked block against closed forms.
//!
//! `cargo run --example own_friction_law -p stoss`; docs/how-to-add/friction-law.md explains it.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use stoss::build::{FrictionLawResult, LawParameters, OwnLaws, ParameterError, build_with};
use stoss::contact::friction::{FrictionInput, FrictionLaw, FrictionOutput, return_to_bound};
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
    fn traction(&self, input: &FrictionInput) -> FrictionOutput {
        let coulomb = self.mu * input.pressure.max(0.0);
        let slope = if input.pressure > 0.0 && coulomb < self.strength { self.mu } else { 0.0 };
        return_to_bound(input.trial, coulomb.min(self.strength), slope, [0.0; 2])
    }
}

/// Traction proportional to the velocity of the slip; the factor is a stress over a velocity.
#[derive(Debug)]
pub struct Viscous(f64);

impl FrictionLaw for Viscous {
    fn name(&self) -> &str {
        "viscous"
    }
    fn traction(&self, input: &FrictionInput) -> FrictionOutput {
        let c = if input.pressure > 0.0 { self.0 / input.step_size } else { 0.0 };
        let (traction, d_slip) = (input.slip.map(|s| c * s), [[c, 0.0], [0.0, c]]);
        FrictionOutput { traction, d_slip, ..FrictionOutput::default() }
    }
    fn is_elastic(&self) -> bool {
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
    let laws = laws();
    let scene = parse_with(&SLIDING.replace(FRICTION, friction), "sliding.toml", &laws.names())?;
    let mut simulation = build_with(&scene, Path::new("."), &laws)?.simulation;
    while !simulation.finished() {
        simulation.advance()?;
    }
    Ok(simulation.body_balance(1).linear_momentum[0] / 0.5)
}

/// Largest difference between the derivatives of a traction and its central differences at an input.
fn derivatives(law: &dyn FrictionLaw, input: &FrictionInput) -> f64 {
    let found = law.traction(input);
    let mut worst = 0.0_f64;
    for k in 0..5 {
        let at = |h: f64| {
            let mut input = *input;
            *[&mut input.pressure].into_iter().chain(&mut input.trial).chain(&mut input.slip).nth(k).unwrap() += h;
            law.traction(&input).traction
        };
        let (h, derivative) = (1e-6, |i: usize| match k {
            0 => found.d_pressure[i],
            1 | 2 => found.d_trial[i][k - 1],
            _ => found.d_slip[i][k - 3],
        });
        let (plus, minus) = (at(h), at(-h));
        (0..2).for_each(|i| worst = worst.max(((plus[i] - minus[i]) / (2.0 * h) - derivative(i)).abs()));
    }
    worst
}

/// Prints and checks.
pub fn main() -> Result<(), Box<dyn Error>> {
    let laws: [&dyn FrictionLaw; 2] = [&ShearLimited { mu: 0.3, strength: 0.4 }, &Viscous(0.5)];
    for law in laws {
        for pressure in [0.5, 5.0] {
            let input = FrictionInput { pressure, trial: [0.5, -0.2], slip: [0.02, -0.01], step_size: 0.01, slid: 0.0 };
            let worst = derivatives(law, &input);
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
