//! `stoss fit`: parameters of laws from measured curves.

use crate::terminal::{say, tell};
use std::path::PathBuf;
use std::process::ExitCode;
use stoss_material_fit::{Curves, Family, Fit, FitError, Mode, fit, nominal_stress};

/// What `stoss fit` is asked for.
#[derive(clap::Args)]
pub struct Asked {
    /// A table (CSV) with the columns test (uniaxial, equibiaxial or planar), stretch or strain, and stress (force over area at rest).
    tests: PathBuf,
    /// A law; may be given several times [default: all that can be fitted].
    #[arg(long, value_name = "LAW", value_parser = clap::builder::PossibleValuesParser::new(Family::NAMES))]
    law: Vec<String>,
    /// Terms of the law ogden.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=3))]
    terms: u8,
    /// Poisson's ratio, from which the volumetric part follows.
    #[arg(long, value_name = "NU", default_value_t = 0.4995)]
    poisson: f64,
    /// Write measured and fitted stresses of the best law into this file.
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
}

/// Carries out `stoss fit`.
pub fn run(asked: &Asked) -> ExitCode {
    let name = asked.tests.display();
    let table = match std::fs::read_to_string(&asked.tests) {
        Ok(table) => table,
        Err(error) => {
            say!("error: {name}: {error}");
            return ExitCode::from(1);
        }
    };
    let (curves, mut fits, left_out) = match Curves::read(&table).and_then(|curves| fit_all(curves, asked)) {
        Ok(all) => all,
        Err(error) => {
            say!("error: {name}: {error}");
            return ExitCode::from(2);
        }
    };
    for error in left_out {
        say!("note: {error}");
    }
    fits.sort_by(|a, b| a.deviation().total_cmp(&b.deviation()));
    let Some(best) = fits.first() else { return ExitCode::from(2) };
    for text in warnings(&curves, best) {
        say!("warning: {text}");
    }
    if let Some(path) = &asked.output
        && let Err(error) = std::fs::write(path, points(&curves, best))
    {
        say!("error: {}: {error}", path.display());
        return ExitCode::from(1);
    }
    tell(&format!("{}\n\n{}\n\n{}", overview(&curves), comparison(&fits), material(best)))
}

/// Every law that was asked for, and why some of them have no parameters; if none has, that is the error.
fn fit_all(curves: Curves, asked: &Asked) -> Result<(Curves, Vec<Fit>, Vec<FitError>), FitError> {
    let laws = Family::NAMES.iter().filter(|name| asked.law.is_empty() || asked.law.iter().any(|law| law == *name));
    let families = laws.filter_map(|law| Family::of(law, usize::from(asked.terms)));
    let (mut fits, mut errors) = (Vec::new(), Vec::new());
    for family in families {
        match fit(&curves, &family, asked.poisson) {
            Ok(found) => fits.push(found),
            Err(error) => errors.push(error),
        }
    }
    match errors.first() {
        Some(error) if fits.is_empty() => Err(error.clone()),
        _ => Ok((curves, fits, errors)),
    }
}

/// Least and largest stretch of a curve, 1 included.
fn measured(curves: &Curves, mode: Mode) -> Option<[f64; 2]> {
    let curve = curves.all.iter().find(|curve| curve.mode == mode)?;
    let range = |[low, high]: [f64; 2], point: &[f64; 2]| [low.min(point[0]), high.max(point[0])];
    Some(curve.points.iter().fold([1.0, 1.0], range))
}

fn overview(curves: &Curves) -> String {
    let of = |mode: Mode| {
        let [low, high] = measured(curves, mode)?;
        let count = curves.all.iter().find(|curve| curve.mode == mode)?.points.len();
        Some(format!("{} {count} points, stretches {low:.3} to {high:.3}", mode.name()))
    };
    format!("measured: {}", Mode::ALL.into_iter().filter_map(of).collect::<Vec<_>>().join("; "))
}

/// A line for each law: deviations and stable ranges.
fn comparison(fits: &[Fit]) -> String {
    let mut text = String::from(
        "law            deviation  of each test                                  stable stretches: uniaxial, equibiaxial, planar",
    );
    for fit in fits {
        let each: Vec<String> =
            fit.deviations.iter().map(|(mode, d)| format!("{} {:.1} %", mode.name(), 100.0 * d)).collect();
        let stable: Vec<String> =
            Mode::ALL.map(|mode| fit.stable(mode)).map(|[a, b]| format!("{a:.2} to {b:.2}")).to_vec();
        let deviation = format!("{:.2} %", 100.0 * fit.deviation());
        text += &format!("\n{:14} {deviation:9}  {:45} {}", fit.name, each.join(", "), stable.join(", "));
    }
    text + "\nDeviations are root mean squares over the largest stress of the test. Stable: stresses rise with strains in every direction (Drucker), asked for from 0.1 to 10."
}

/// Six digits.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded:?}")
}

/// The best law as scenes write it.
fn material(fit: &Fit) -> String {
    let list = |values: &[f64]| values.iter().copied().map(digits).collect::<Vec<_>>().join(", ");
    let is_list = |name: &str| fit.name == "ogden" && (name == "mu" || name == "alpha");
    let value = |(name, values): &(&'static str, Vec<f64>)| {
        if is_list(name) { format!("{name} = [{}]", list(values)) } else { format!("{name} = {}", list(values)) }
    };
    let parameters: Vec<String> = fit.parameters.iter().map(value).collect();
    format!("material = {{ law = \"{}\", {} }}    # stresses in the unit of the table", fit.name, parameters.join(", "))
}

/// What to know about the best law.
fn warnings(curves: &Curves, fit: &Fit) -> Vec<String> {
    let mut out = Vec::new();
    for mode in Mode::ALL {
        let ([low, high], name) = (fit.stable(mode), mode.name());
        match measured(curves, mode) {
            Some([from, to]) if from < low || to > high => out.push(format!(
                "{} is unstable in the {name} test beyond stretches of {low:.2} to {high:.2}, within the measured {from:.2} to {to:.2}: a body may find no equilibrium there; take a law with fewer \
                 parameters, or see whether all tests are of one material",
                fit.name
            )),
            None => out.push(format!("no {name} test: what {} says of such strains is a guess", fit.name)),
            Some(_) => {}
        }
    }
    out
}

/// Measured and fitted stresses.
fn points(curves: &Curves, fit: &Fit) -> String {
    let mut text = String::from("test,stretch,stress,fitted\n");
    for curve in &curves.all {
        for &[stretch, stress] in &curve.points {
            let fitted = nominal_stress(&*fit.law, curve.mode, stretch).unwrap_or(f64::NAN);
            text += &format!("{},{stretch:e},{stress:e},{fitted:e}\n", curve.mode.name());
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "test,stretch,stress\nuniaxial,1.1,0.274\nuniaxial,1.5,1.056\nuniaxial,2.0,1.75\n";

    #[test]
    fn a_material_is_one_of_a_scene() {
        let curves = Curves::read(TABLE).unwrap();
        for law in Family::NAMES {
            let found = fit(&curves, &Family::of(law, 1).unwrap(), 0.49).unwrap();
            let text = material(&found);
            let table: toml::Table = toml::from_str(text.split('#').next().unwrap()).unwrap();
            assert_eq!(table["material"]["law"].as_str(), Some(law));
            let names = |table: &toml::Value| table.as_table().unwrap().keys().cloned().collect::<Vec<_>>();
            assert!(found.parameters.iter().all(|(name, _)| names(&table["material"]).contains(&(*name).to_owned())));
        }
    }

    #[test]
    fn tests_that_were_not_made_are_named() {
        let curves = Curves::read(TABLE).unwrap();
        let found = fit(&curves, &Family::of("neo-hooke", 1).unwrap(), 0.49).unwrap();
        let text = warnings(&curves, &found);
        assert!(text.len() == 2 && text[0].contains("equibiaxial") && text[1].contains("planar"), "{text:?}");
        assert!(points(&curves, &found).lines().count() == 4 && overview(&curves).contains("uniaxial 3 points"));
    }
}
