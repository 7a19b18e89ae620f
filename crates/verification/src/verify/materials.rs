//! What every hyperelastic law promises (theory/kinematics#laws, theory/integrators#ems), measured on all of them.

use std::collections::BTreeSet;

use stoss_continuum::{
    HyperelasticLaw, SymmetricTensor2, Tensor2, Tensor4, cauchy_stress, energy_momentum_stress, green_lagrange,
};
use stoss_tensor::spectral_decomposition;

use super::check::{Bound, Check};
use super::derivatives::{self, Worst};
use super::laws::{Energy, LAWS};
use super::report::Section;
use super::states::Random;
use super::{Bench, Findings, Suite};
use crate::plot::{self, Labels, Series};
use crate::workspace::Outcome;

/// Energy, stress and tangent of every law of the catalogue.
pub struct Materials;

/// Random states of each kind.
const STATES: usize = 300;

/// Round-off of some operations.
const ROUND_OFF: f64 = 1e-14;

/// Round-off of hundreds of operations: rotations, complex derivatives of the energies.
const CONDITIONED: f64 = 1e-12;

/// Central differences reach 4e-11 for a well-scaled function; derivatives of higher order take the rest.
const DIFFERENCES: f64 = 1e-8;

impl Suite for Materials {
    fn name(&self) -> &'static str {
        "materials"
    }

    fn about(&self) -> &'static str {
        "Every law: rest state, stress and elasticity tensor against derivatives of the energy, isotropy and \
         objectivity, moduli, strong compression, equal stretches, and the balance of the discrete gradient."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        let mut measured = BTreeSet::new();
        for sample in &LAWS {
            let law = sample.energy.law()?;
            measured.insert(law.name().to_owned());
            let law = law.as_ref();
            rest(&mut findings, law)?;
            small_strains(&mut findings, law, sample.literature)?;
            derivatives_of(&mut findings, law, &sample.energy)?;
            invariance(&mut findings, law)?;
            compression(&mut findings, law)?;
            directionality(&mut findings, law)?;
        }
        let named = laws_of_the_schema(&bench.workspace.read("docs/scene.schema.json")?)?;
        let missing: Vec<&str> = named.difference(&measured).map(String::as_str).collect();
        let check = Check::new("all", "laws of scenes that are not measured", missing.len() as f64, Bound::AtMost(0.0));
        findings.checks.push(check.noted(format!("{} laws {}", named.len(), missing.join(", "))));
        findings.sections.push(figure()?);
        Ok(findings)
    }
}

/// Largest of the small-strain moduli: what energies and stresses are compared with.
fn modulus(law: &dyn HyperelasticLaw) -> f64 {
    law.small_strain_moduli().shear.max(law.small_strain_moduli().bulk)
}

/// Size to which an error of a stress is related: the change that a change of `C` by itself would make, at least. The
/// stress itself is no measure near the rest state, where it vanishes.
fn stress_scale(c: &SymmetricTensor2, stress: &SymmetricTensor2, elasticity: &Tensor4) -> f64 {
    stress.norm().max(elasticity.max_abs() * c.norm())
}

/// Energy, stress and tangent at `C = 1`.
fn rest(findings: &mut Findings, law: &dyn HyperelasticLaw) -> Outcome<()> {
    let identity = SymmetricTensor2::IDENTITY;
    let (stress, elasticity) = law.stress_and_elasticity(&identity)?;
    let moduli = law.small_strain_moduli();
    let mut expected = Tensor4::identity_dyad() * moduli.lame_lambda();
    expected.add_scaled(2.0 * moduli.shear, &Tensor4::symmetric_identity());
    let scale = expected.max_abs();
    expected.add_scaled(-1.0, &elasticity);
    let rows = [
        ("energy at rest", law.energy(&identity)?.abs() / modulus(law), ROUND_OFF),
        ("stress at rest", stress.norm() / modulus(law), ROUND_OFF),
        ("tangent at rest, from the moduli", expected.max_abs() / scale, 1e-12),
    ];
    findings
        .checks
        .extend(rows.map(|(quantity, value, bound)| Check::new(law.name(), quantity, value, Bound::AtMost(bound))));
    Ok(())
}

/// Moduli against the literature, and energy and stress against linear elasticity.
fn small_strains(findings: &mut Findings, law: &dyn HyperelasticLaw, (young, poisson): (f64, f64)) -> Outcome<()> {
    let moduli = law.small_strain_moduli();
    let error = (moduli.young_modulus() / young - 1.0).abs();
    let check = Check::new(law.name(), "Young's modulus, against the literature", error, Bound::AtMost(1e-5));
    findings.checks.push(check.noted(format!("{young} printed")));
    // Four digits are printed.
    let error = (moduli.poisson_ratio() - poisson).abs();
    let check = Check::new(law.name(), "Poisson's ratio, against the literature", error, Bound::AtMost(5e-5));
    findings.checks.push(check.noted(format!("{poisson} printed")));
    let mut random = Random(3);
    let (mut energy, mut stress) = (Worst::default(), Worst::default());
    for _ in 0..STATES {
        let c = SymmetricTensor2::IDENTITY + random.direction() * SMALL_STRAIN;
        let e = green_lagrange(&c);
        let expected = 0.5 * moduli.lame_lambda() * e.trace().powi(2) + moduli.shear * e.double_contract(&e);
        energy.see((law.energy(&c)? / expected - 1.0).abs(), String::new);
        let expected = SymmetricTensor2::IDENTITY * (moduli.lame_lambda() * e.trace()) + e * (2.0 * moduli.shear);
        stress.see((law.stress(&c)? - expected).norm() / expected.norm(), String::new);
    }
    // The next order is the strain times a number that grows with the exponents (beta = 9: about 10).
    let bound = 50.0 * SMALL_STRAIN;
    findings.checks.push(energy.check(law.name(), "energy at small strains, from linear elasticity", bound));
    findings.checks.push(stress.check(law.name(), "stress at small strains, from linear elasticity", bound));
    Ok(())
}

/// `|C - 1|` of a small strain.
const SMALL_STRAIN: f64 = 1e-6;

/// Stress and elasticity tensor against derivatives, for every kind of state.
fn derivatives_of(findings: &mut Findings, law: &dyn HyperelasticLaw, energy: &Energy) -> Outcome<()> {
    type Draw = fn(&mut Random) -> SymmetricTensor2;
    let kinds: [(&str, Draw); 4] = [
        ("stretches 0.6 to 1.7", Random::moderate),
        ("J = 0.2 to 0.3", Random::crushed),
        ("two equal stretches", |random| random.repeated(2)),
        ("three equal stretches", |random| random.repeated(3)),
    ];
    let mut symmetry = Worst::default();
    for (kind, draw) in kinds {
        let mut random = Random(4);
        let mut worst: [Worst; 3] = Default::default();
        for _ in 0..STATES {
            let c = draw(&mut random);
            let (stress, elasticity) = law.stress_and_elasticity(&c)?;
            let scale = stress_scale(&c, &stress, &elasticity);
            let state = || format!("C = {:.4?}", c.0);
            worst[0].see((stress - energy.stress(&c)?).norm() / scale, state);
            worst[1].see((stress - derivatives::stress_by_differences(law, &c)?).norm() / scale, state);
            worst[2].see_entry(&derivatives::elasticity(law, &c)?);
            let mut asymmetry = elasticity.major_transpose();
            asymmetry.add_scaled(-1.0, &elasticity);
            symmetry.see(asymmetry.max_abs() / elasticity.max_abs(), state);
        }
        let rows = [
            ("stress, complex step of the energy", CONDITIONED),
            ("stress, differences of the energy", DIFFERENCES),
            ("elasticity, differences of the stress", DIFFERENCES),
        ];
        for (worst, (quantity, bound)) in worst.iter().zip(rows) {
            findings.checks.push(worst.check(law.name(), &format!("{quantity}; {kind}"), bound));
        }
    }
    findings.checks.push(symmetry.check(law.name(), "major symmetry of the elasticity tensor", ROUND_OFF));
    Ok(())
}

/// Isotropy `W(Q C Q^T) = W(C)`, `S(Q C Q^T) = Q S Q^T`; objectivity for `F -> Q F`: energy and `S` stay, the
/// Cauchy stress turns with the body.
fn invariance(findings: &mut Findings, law: &dyn HyperelasticLaw) -> Outcome<()> {
    let mut random = Random(5);
    let (mut isotropy, mut objectivity) = (Worst::default(), Worst::default());
    for _ in 0..STATES {
        let (c, q) = (random.moderate(), random.rotation());
        let (stress, elasticity) = law.stress_and_elasticity(&c)?;
        let (w, scale) = (law.energy(&c)?, stress_scale(&c, &stress, &elasticity));
        let energy_error = |other: f64| (other - w).abs() / w.abs().max(scale);
        let turned = c.rotated(&q);
        isotropy.see(energy_error(law.energy(&turned)?), || "energy".into());
        isotropy.see((law.stress(&turned)? - stress.rotated(&q)).norm() / scale, || "stress".into());
        let f = random.rotation() * right_stretch(&c);
        let turned_f = q * f;
        let turned_c = SymmetricTensor2::right_cauchy_green(&turned_f);
        let turned_stress = law.stress(&turned_c)?;
        objectivity.see(energy_error(law.energy(&turned_c)?), || "energy".into());
        objectivity.see((turned_stress - stress).norm() / scale, || "second Piola-Kirchhoff stress".into());
        let sigma = cauchy_stress(&f, &stress);
        let error = (cauchy_stress(&turned_f, &turned_stress) - sigma.rotated(&q)).norm();
        let size = scale * f.norm_squared() / f.determinant();
        objectivity.see(error / size, || "Cauchy stress".into());
    }
    findings.checks.push(isotropy.check(law.name(), "isotropy", CONDITIONED));
    findings.checks.push(objectivity.check(law.name(), "objectivity", CONDITIONED));
    Ok(())
}

/// `U` with `U^2 = C`.
fn right_stretch(c: &SymmetricTensor2) -> Tensor2 {
    let form = spectral_decomposition(c);
    (0..3).fold(Tensor2::zeros(), |u, a| u + form.vectors[a] * form.vectors[a].transpose() * form.values[a].sqrt())
}

/// Uniform compression from `J = 1` to 0.2: the energy grows, errors are none, `J = 0` is refused.
fn compression(findings: &mut Findings, law: &dyn HyperelasticLaw) -> Outcome<()> {
    let path = compressed(law)?;
    // An energy that is no number does not grow.
    let decreases = path.windows(2).filter(|pair| pair[1].1 <= pair[0].1 || pair[1].1.is_nan()).count() as f64;
    let last = path.last().map_or(f64::NAN, |point| point.1);
    let check = Check::new(law.name(), "steps to J = 0.2 without growth of the energy", decreases, Bound::AtMost(0.0));
    findings.checks.push(check.noted(format!("W at J = 0.2: {last:.3} times the bulk modulus")));
    let flat = [SymmetricTensor2([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]), SymmetricTensor2::ZERO];
    let accepted = flat.iter().filter(|c| law.energy(c).is_ok() || law.stress(c).is_ok()).count() as f64;
    findings.checks.push(Check::new(law.name(), "states with J = 0 that are accepted", accepted, Bound::AtMost(0.0)));
    Ok(())
}

/// `J` and the energy over the bulk modulus, from 1 down to 0.2.
fn compressed(law: &dyn HyperelasticLaw) -> Outcome<Vec<(f64, f64)>> {
    let at = |k: i32| {
        let j = 1.0 - 0.01 * f64::from(k);
        let c = SymmetricTensor2::IDENTITY * j.powf(2.0 / 3.0);
        Ok((j, law.energy(&c)? / law.small_strain_moduli().bulk))
    };
    (0..=80).map(at).collect()
}

/// `S_alg : dC/2 = W_np1 - W_n` (theory/integrators#eq-ems) for increments of every size.
fn directionality(findings: &mut Findings, law: &dyn HyperelasticLaw) -> Outcome<()> {
    let mut random = Random(6);
    let mut worst = Worst::default();
    for _ in 0..5 * STATES {
        let (c_n, c_np1) = random.step(-10.0, 0.0);
        let delta = c_np1 - c_n;
        let (energy_n, energy_np1) = (law.energy(&c_n)?, law.energy(&c_np1)?);
        let stress = energy_momentum_stress(law, &c_n, energy_n, &c_np1)?;
        let work = 0.5 * stress.double_contract(&delta);
        let scale = energy_n.abs() + energy_np1.abs() + modulus(law);
        worst.see((work - (energy_np1 - energy_n)).abs() / scale, || format!("|dC| = {:.1e}", delta.norm()));
    }
    findings.checks.push(worst.check(law.name(), "energy balance of the discrete gradient", ROUND_OFF));
    Ok(())
}

/// Energy under uniform compression.
fn figure() -> Outcome<Section> {
    let mut series = Vec::new();
    for sample in &LAWS {
        let law = sample.energy.law()?;
        let (j, energy): (Vec<f64>, Vec<f64>) = compressed(law.as_ref())?.into_iter().unzip();
        series.push(Series::new(law.name(), &j, energy));
    }
    let labels = Labels { title: "uniform compression", x: "J", y: "energy / bulk modulus" };
    let figures = vec![plot::logarithmic(labels, &series, 1e-5)];
    Ok(Section { title: "Energies down to J = 0.2".into(), reading: "Energy under uniform compression. It should grow without end as J falls; the Saint Venant-Kirchhoff law does not, and softens.".into(), figures, tables: Vec::new() })
}

/// Names of the laws that a scene can have.
fn laws_of_the_schema(text: &str) -> Outcome<BTreeSet<String>> {
    let schema: serde_json::Value = serde_json::from_str(text)?;
    let material = &schema["$defs"]["Material"];
    // `anyOf`: the last variant is a law of the user's own, whose name is free.
    let variants = [&material["oneOf"], &material["anyOf"]].into_iter().find_map(serde_json::Value::as_array);
    let variants = variants.ok_or("the schema has no materials")?;
    let name = |variant: &serde_json::Value| variant["properties"]["law"]["const"].as_str().map(str::to_owned);
    let names: BTreeSet<String> = variants.iter().filter_map(name).collect();
    if names.is_empty() { Err("no material of the schema has a law".into()) } else { Ok(names) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_right_stretch_is_the_root() {
        let c = SymmetricTensor2([1.3, 0.9, 1.1, 0.2, -0.1, 0.3]);
        let u = right_stretch(&c);
        assert!((u * u - c.to_matrix()).norm() < 1e-14 && (u - u.transpose()).norm() < 1e-15);
    }

    #[test]
    fn laws_are_read_from_the_schema() {
        let schema = |body: &str| format!("{{\"$defs\": {{\"Material\": {{\"oneOf\": [{body}]}}}}}}");
        let law = |name: &str| format!("{{\"properties\": {{\"law\": {{\"const\": \"{name}\"}}}}}}");
        let names = laws_of_the_schema(&schema(&format!("{}, {}", law("a"), law("b")))).unwrap();
        assert!(names.into_iter().eq(["a", "b"]));
        assert!(laws_of_the_schema(&schema("")).is_err() && laws_of_the_schema(&schema("{}")).is_err());
        assert!(laws_of_the_schema("{}").is_err());
    }

    #[test]
    fn compression_is_measured_in_bulk_moduli() {
        // Saint Venant-Kirchhoff: W = 9/2 K e^2 with E = e 1, e = (J^(2/3) - 1)/2.
        let path = compressed(LAWS[0].energy.law().unwrap().as_ref()).unwrap();
        assert_eq!(path.len(), 81);
        let (j, energy) = path[80];
        let e = 0.5 * (0.2_f64.powf(2.0 / 3.0) - 1.0);
        assert!((j - 0.2).abs() < 1e-12 && (energy - 4.5 * e * e).abs() < 1e-12);
    }
}
