//! Rigid bodies as tools on deformable ones, through scenes.

use super::noted;
use super::scene::{probe, run};
use crate::verify::check::Bound;
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;

/// All cases.
pub fn measure(_bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    incline(findings)
}

/// A block on a rigid plane that is inclined by 0.95 and 1.05 of the angle of friction (as gravity that is tilted): it sticks, and it slides with `g (sin a - mu cos a)`.
fn incline(findings: &mut Findings) -> Outcome<()> {
    let case = "block on a rigid plane";
    let mu = 0.3_f64;
    for (method, friction) in [
        ("mortar", "friction = { law = \"coulomb\", mu = 0.3 }"),
        ("nts", "friction = { law = \"coulomb\", mu = 0.3 }"),
    ] {
        for share in [0.95, 1.05] {
            let angle = (share * mu).atan();
            let (s, c) = angle.sin_cos();
            let text = format!(
                "[scene]\ntitle = \"incline\"\nkind = \"dynamic\"\n[time]\nend = 4.0\nstep = 0.01\nintegrator = {{ scheme = \"backward-euler\" }}\n\
                 [gravity]\nacceleration = [{:?}, 0.0, {:?}]\n\
                 [[rigid]]\nname = \"plane\"\nshape = {{ kind = \"plane\", size = [12.0, 4.0], divisions = [6, 2] }}\nposition = [3.0, 0.5, 0.0]\nfixed = true\n\
                 [[body]]\nname = \"block\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 0.5], divisions = [2, 2, 1] }}\n\
                 material = {{ law = \"neo-hooke\", young = 1e5, poisson = 0.3 }}\ndensity = 1.0\n\
                 [[contact]]\nmethod = \"{method}\"\nslave = \"block.bottom\"\nmaster = \"plane.all\"\n{friction}\n\
                 [[probe]]\nname = \"v\"\nset = \"block.bottom\"\nquantity = \"velocity\"\n",
                10.0 * s,
                -10.0 * c
            );
            let (mut early, mut late, mut creep) = (f64::NAN, f64::NAN, 0.0_f64);
            run(&text.parse()?, "incline", |simulation, probes, record| {
                let v = probe(probes, "v", simulation)[0];
                if (record.time - 2.0).abs() < 1e-6 {
                    early = v;
                }
                if record.time > 2.0 - 1e-6 {
                    creep = creep.max(v.abs());
                }
                late = v;
            })?;
            let case = format!("{case}, {method}");
            if share < 1.0 {
                noted(
                    findings,
                    &case,
                    "0.95 of the angle: largest speed from t = 2",
                    creep,
                    Bound::AtMost(1e-9),
                    "sticks",
                );
            } else {
                let exact = 10.0 * (s - mu * c);
                let note = format!("g (sin a - mu cos a) = {exact:.4}; from t = 2 to 4");
                noted(
                    findings,
                    &case,
                    "1.05 of the angle: acceleration over the closed form, less one",
                    ((late - early) / 2.0 / exact - 1.0).abs(),
                    Bound::AtMost(1e-2),
                    note,
                );
            }
        }
    }
    Ok(())
}
