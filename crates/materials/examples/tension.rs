//! A bar in tension, by every law of the catalogue: nominal stress over stretch, with sides that are free of stress.
//!
//! Checked: the stress is the slope of the energy along the way (differences), and the slope at rest is Young's modulus.
//!
//! `cargo run --example tension -p stoss-materials`

use std::error::Error;
use stoss_continuum::{ConstitutiveError, HyperelasticLaw, SymmetricTensor2};
use stoss_materials::{MooneyRivlin, NeoHooke, Ogden, SaintVenantKirchhoff};

/// Energy and nominal stress at a stretch: Newton's method with the law's own tangent finds the `C22 = C33` at which `S22 = 0`.
fn tension(law: &dyn HyperelasticLaw, stretch: f64) -> Result<(f64, f64), ConstitutiveError> {
    let mut side = 1.0 / stretch;
    loop {
        let c = SymmetricTensor2([stretch * stretch, side, side, 0.0, 0.0, 0.0]);
        let (stress, elasticity) = law.stress_and_elasticity(&c)?;
        // CC = 2 dS/dC, and C33 moves with C22.
        let correction = 2.0 * stress.0[1] / (elasticity.0[1][1] + elasticity.0[1][2]);
        if correction.abs() < 1e-13 {
            return Ok((law.energy(&c)?, stretch * stress.0[0]));
        }
        side -= correction;
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let (young, poisson) = (210.0, 0.3);
    let (shear, bulk) = (young / (2.0 * (1.0 + poisson)), young / (3.0 * (1.0 - 2.0 * poisson)));
    let laws: [&dyn HyperelasticLaw; 4] = [
        &SaintVenantKirchhoff::from_young_poisson(young, poisson)?,
        &NeoHooke::from_young_poisson(young, poisson)?,
        // Moduli at small strain: shear 2 (c1 + c2) and sum of mu alpha / 2, bulk 2 c + 4 c2 + 4/3 (c1 + c2) and kappa.
        &MooneyRivlin::new(0.4 * shear, 0.1 * shear, 0.5 * (bulk - 2.0 * shear / 3.0) - 0.2 * shear)?,
        &Ogden::new(&[2.0 * shear / 3.0], &[3.0], bulk, 9.0)?,
    ];
    println!("{:22} 0.8       0.9       1.1       1.2       1.5   nominal stress at these stretches", "law");
    for law in laws {
        print!("{:20}", law.name());
        for stretch in [0.8, 0.9, 1.1, 1.2, 1.5] {
            let (stress, h) = (tension(law, stretch)?.1, 1e-5);
            let slope = (tension(law, stretch + h)?.0 - tension(law, stretch - h)?.0) / (2.0 * h);
            assert!((slope - stress).abs() < 1e-7 * young, "{}: {slope} {stress}", law.name());
            print!("{stress:9.3} ");
        }
        println!();
        let slope = tension(law, 1.0 + 1e-6)?.1 / 1e-6;
        assert!((slope / young - 1.0).abs() < 1e-5, "{}: {slope}", law.name());
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
