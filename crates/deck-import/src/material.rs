//! Laws of materials.

use stoss_mesh_io::deck::{Hyperelastic, Material};

use crate::text::{list, number};

/// Volumetric exponent of the Ogden law: `kappa/4 (J^2 - 1 - 2 ln J)`.
const BETA: f64 = -2.0;
/// Poisson's ratio of a hyperelastic material without a volumetric parameter.
const RATIO: f64 = 0.475;

/// A law as the scene writes it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Law {
    /// Text of the law, as `{ law = "neo-hooke", young = 1.0, poisson = 0.3 }`.
    pub text: String,
    /// The law of the deck and that of the scene in one line, for the head of the scene.
    pub summary: String,
    /// What is not as in the deck, with what to do.
    pub notes: Vec<(String, String)>,
    /// Nearly: elements without an independent pressure lock.
    pub is_incompressible: bool,
}

/// The law of a material, or what it lacks. `mixed`: the elements have an independent pressure.
pub(crate) fn law(material: &Material, mixed: bool) -> Result<Law, String> {
    let mut law = elastic_or_plastic(material, mixed)?;
    with_history(material, &mut law)?;
    Ok(law)
}

/// Whether bodies of a material yield: a law of rubber does not.
pub(crate) fn yields(material: &Material) -> bool {
    !material.plastic.is_empty() && material.hyperelastic.is_none()
}

/// Whether a material relaxes or softens, unless it yields.
fn has_history(material: &Material) -> bool {
    material.prony.iter().any(|[share, ..]| *share != 0.0) || material.mullins.is_some()
}

/// Adds relaxation and softening.
fn with_history(material: &Material, law: &mut Law) -> Result<(), String> {
    let wrong = |what: String| Err(format!("material {} has {what}", material.name));
    let mut keys = String::new();
    let shares: f64 = material.prony.iter().map(|[share, ..]| share).sum();
    let relaxes = material.prony.iter().any(|[share, ..]| *share != 0.0);
    if let Some([share, _, time]) = material.prony.iter().find(|[share, _, time]| !(*share >= 0.0 && *time > 0.0)) {
        return wrong(format!(
            "*VISCOELASTIC with the share {share} and the time {time}: shares are not negative, times are positive"
        ));
    }
    if shares >= 1.0 {
        return wrong(format!(
            "*VISCOELASTIC whose shares of the shear modulus add up to {shares}, which must be below 1"
        ));
    }
    let yields = yields(material);
    for (is_there, name) in [(relaxes, "*VISCOELASTIC"), (material.mullins.is_some(), "*MULLINS EFFECT")] {
        if is_there && yields {
            let text = format!("{name} beside *PLASTIC is left out: a law that yields neither relaxes nor softens");
            law.notes.push((text, "for rubber leave *PLASTIC out".to_owned()));
        }
    }
    if yields {
        return Ok(());
    }
    if relaxes {
        let pairs =
            material.prony.iter().filter(|[share, ..]| *share != 0.0).map(|[share, _, time]| list(&[*share, *time]));
        let moduli = if material.is_instantaneous { "instantaneous" } else { "long-term" };
        keys += &format!(", prony = [{}], moduli = \"{moduli}\"", pairs.collect::<Vec<_>>().join(", "));
        law.summary += ", *VISCOELASTIC is `prony`";
        law.notes.push((
            "its branches are linear in the logarithmic strain: in the deck the stress of the law relaxes; the same at small strains, another model above some 50 %".to_owned(),
            String::new(),
        ));
    }
    if material.prony.iter().any(|[_, of_bulk, _]| *of_bulk != 0.0) {
        law.notes.push(("the bulk modulus does not relax".to_owned(), String::new()));
    }
    if let Some([r, m, beta]) = material.mullins {
        if !(r > 1.0 && m > 0.0 && beta >= 0.0) {
            return wrong(format!(
                "*MULLINS EFFECT with r = {r}, m = {m}, beta = {beta}: r must be above 1, m positive, beta not negative"
            ));
        }
        keys += &format!(", mullins = {{ r = {}, m = {}, beta = {} }}", number(r), number(m), number(beta));
        law.summary += ", *MULLINS EFFECT is `mullins`";
    }
    if keys.is_empty() {
        return Ok(());
    }
    law.text.truncate(law.text.len() - " }".len());
    law.text += &format!("{keys} }}");
    Ok(())
}

fn elastic_or_plastic(material: &Material, mixed: bool) -> Result<Law, String> {
    if let Some(hyperelastic) = &material.hyperelastic {
        let mut law = match (hyperelastic.law.replace(' ', "").as_str(), hyperelastic.terms) {
            ("YEOH", _) | ("REDUCEDPOLYNOMIAL", 3) => of_first_invariant(hyperelastic, "yeoh", &["c1", "c2", "c3"]),
            ("ARRUDA-BOYCE", _) => of_first_invariant(hyperelastic, "arruda-boyce", &["mu", "lock"]),
            _ => ogden(hyperelastic),
        }?;
        if !material.plastic.is_empty() {
            law.notes.push((
                "*PLASTIC beside *HYPERELASTIC is left out: the body does not yield".to_owned(),
                "for a metal give *ELASTIC in place of *HYPERELASTIC".to_owned(),
            ));
        }
        return Ok(law);
    }
    let Some(elastic) = material.elastic else {
        return Err(format!("material {} has no isotropic *ELASTIC and no *HYPERELASTIC", material.name));
    };
    let (young, poisson) = (elastic.modulus, elastic.ratio);
    if poisson == 0.5 {
        return Err(format!(
            "material {} has nu = 0.5, which no element of Stoss can have: write nu = 0.4999 with hybrid elements (such as C3D8H), which become `volumetric = \"mixed\"` and take nu up to 0.499999",
            material.name
        ));
    }
    if !(young > 0.0 && poisson > -1.0 && poisson < 0.5) {
        return Err(format!(
            "material {} has E = {young} and nu = {poisson}: E must be positive, nu between -1 and 0.5",
            material.name
        ));
    }
    let is_incompressible = poisson > 0.45;
    if !material.plastic.is_empty() {
        return plastic(material, [young, poisson], is_incompressible);
    }
    let (name, notes) = if mixed || has_history(material) {
        let lacks = if mixed { "has no mixed form" } else { "neither relaxes nor softens" };
        let note =
            format!("the law is neo-hooke, with the same moduli at small strains: saint-venant-kirchhoff {lacks}");
        ("neo-hooke", vec![(note, String::new())])
    } else {
        ("saint-venant-kirchhoff", Vec::new())
    };
    let text = format!("{{ law = \"{name}\", young = {}, poisson = {} }}", number(young), number(poisson));
    Ok(Law { text, summary: format!("*ELASTIC is {name}"), notes, is_incompressible })
}

/// Isotropic or linear kinematic hardening behind Hencky's law.
fn plastic(material: &Material, [young, poisson]: [f64; 2], is_incompressible: bool) -> Result<Law, String> {
    let wrong = |what: String| Err(format!("material {} has *PLASTIC {what}", material.name));
    let points = &material.plastic;
    if let Some([_, stress]) = points.iter().find(|[_, stress]| !(*stress > 0.0 && stress.is_finite())) {
        return wrong(format!("with the yield stress {stress}, which must be positive"));
    }
    if let Some([a, b]) = points.windows(2).map(|pair| [pair[0], pair[1]]).find(|[a, b]| b[0] <= a[0] || b[0].is_nan())
    {
        return wrong(format!("whose plastic strains do not grow: {} behind {}", b[0], a[0]));
    }
    let mut notes = vec![(
        "yield stresses are those of the Kirchhoff stress, in the deck of the true stress: they differ by the change of volume, some thousandths"
            .to_owned(),
        String::new(),
    )];
    let first = points.first().map_or(0.0, |first| first[0]);
    let mut all = points.clone();
    if first < 0.0 {
        return wrong(format!("with the plastic strain {first}, which must not be negative"));
    }
    if first > 0.0 && all.len() > 1 {
        all.insert(0, [0.0, all[0][1]]);
        notes.push((
            format!("its first plastic strain is {first} and not 0: up to there the yield stress is the first one"),
            "check the table: is the elastic strain in it?".to_owned(),
        ));
    }
    let yields = match all[..] {
        [[_, stress]] => format!("yield_stress = {}", number(stress)),
        [[_, stress], .., [strain, last]] if material.is_kinematic => {
            let slope = (last - stress) / strain;
            if first > 0.0 || slope < 0.0 {
                return wrong("with kinematic hardening that does not begin at 0 or falls".to_owned());
            }
            notes.push((
                "its kinematic hardening goes on with the same slope behind its second point".to_owned(),
                String::new(),
            ));
            format!("yield_stress = {}, kinematic_modulus = {}", number(stress), number(slope))
        }
        ref points => format!("hardening = [{}]", points.iter().map(|p| list(p)).collect::<Vec<_>>().join(", ")),
    };
    let (young, poisson) = (number(young), number(poisson));
    Ok(Law {
        text: format!("{{ law = \"hencky\", young = {young}, poisson = {poisson}, plasticity = {{ {yields} }} }}"),
        summary: "*PLASTIC is hencky with `plasticity`".to_owned(),
        notes,
        is_incompressible,
    })
}

/// `2 / D1`, or what CalculiX takes where there is none.
fn bulk_modulus(d: Option<f64>, shear: f64, notes: &mut Vec<(String, String)>) -> f64 {
    match d {
        Some(d) if d > 0.0 => 2.0 / d,
        _ => {
            notes.push((
                format!("it has no volumetric parameter D1: the bulk modulus is that of Poisson's ratio {RATIO}, as in CalculiX"),
                "change `kappa` of the material if another one is meant".to_owned(),
            ));
            2.0 * shear * (1.0 + RATIO) / (3.0 * (1.0 - 2.0 * RATIO))
        }
    }
}

/// A law of the scene with the same isochoric energy in the same coefficients, which the volumetric parameter D1 follows.
fn of_first_invariant(given: &Hyperelastic, name: &str, keys: &[&str]) -> Result<Law, String> {
    let c = &given.coefficients;
    let Some(values) = c.get(..keys.len()) else {
        return Err(format!("*HYPERELASTIC, {} needs more numbers", given.law));
    };
    let mut notes = Vec::new();
    // Of Arruda and Boyce's law nearly, for chains that lock late.
    let shear = if name == "yeoh" { 2.0 * values[0] } else { values[0] };
    let kappa = bulk_modulus(c.get(keys.len()).copied(), shear, &mut notes);
    if name == "yeoh" && c[keys.len().min(c.len())..].iter().skip(1).any(|d| *d != 0.0) {
        notes.push(("of the volumetric parameters only D1 is used".to_owned(), String::new()));
    }
    notes.push((
        "the volumetric energy is kappa/2 (ln J)^2: the same bulk modulus at small strains".to_owned(),
        String::new(),
    ));
    let parameters: Vec<String> =
        keys.iter().zip(values).map(|(key, value)| format!("{key} = {}", number(*value))).collect();
    let text = format!("{{ law = \"{name}\", {}, kappa = {} }}", parameters.join(", "), number(kappa));
    let summary = format!("*HYPERELASTIC, {} is {name} with the same isochoric energy", given.law);
    Ok(Law { text, summary, notes, is_incompressible: kappa > 10.0 * shear })
}

/// Laws whose isochoric part is a sum of powers of the isochoric stretches are the Ogden law.
fn ogden(given: &Hyperelastic) -> Result<Law, String> {
    let c = &given.coefficients;
    let at = |index: usize| c.get(index).copied();
    let need = |index: usize| at(index).ok_or_else(|| format!("*HYPERELASTIC, {} needs more numbers", given.law));
    let mut notes = Vec::new();
    let law = given.law.replace(' ', "");
    // Coefficients and exponents of the scene's law, and the first volumetric parameter D1.
    let (mu, alpha, d) = match (law.as_str(), given.terms) {
        ("NEOHOOKE", _) | ("REDUCEDPOLYNOMIAL", 1) => (vec![2.0 * need(0)?], vec![2.0], at(1)),
        ("MOONEY-RIVLIN", _) | ("POLYNOMIAL", 1) => (vec![2.0 * need(0)?, -2.0 * need(1)?], vec![2.0, -2.0], at(2)),
        ("OGDEN", n @ 1..=6) => {
            let mut mu = Vec::new();
            let mut alpha = Vec::new();
            for term in 0..n {
                let (m, a) = (need(2 * term)?, need(2 * term + 1)?);
                if a == 0.0 {
                    return Err(format!("*HYPERELASTIC, OGDEN: the exponent {} is zero", term + 1));
                }
                mu.push(2.0 * m / a);
                alpha.push(a);
            }
            if n > 1 && (1..n).any(|term| at(2 * n + term).is_some_and(|d| d != 0.0)) {
                notes.push(("of the volumetric parameters only D1 is used".to_owned(), String::new()));
            }
            (mu, alpha, at(2 * n))
        }
        _ => {
            return Err(format!(
                "*HYPERELASTIC, {} with {} terms does not map: fit an Ogden law to the same tests",
                given.law, given.terms
            ));
        }
    };
    let shear = 0.5 * mu.iter().zip(&alpha).map(|(mu, alpha)| mu * alpha).sum::<f64>();
    if !(shear > 0.0 && shear.is_finite()) {
        return Err(format!(
            "*HYPERELASTIC, {}: the shear modulus at small strains is {shear}, not positive",
            given.law
        ));
    }
    let kappa = bulk_modulus(d, shear, &mut notes);
    notes.push((
        "the volumetric energy is kappa/4 (J^2 - 1 - 2 ln J) in place of (J - 1)^2/D1: the same bulk modulus at small strains".to_owned(),
        String::new(),
    ));
    let text = format!(
        "{{ law = \"ogden\", mu = {}, alpha = {}, kappa = {}, beta = {} }}",
        list(&mu),
        list(&alpha),
        number(kappa),
        number(BETA)
    );
    let summary = format!("*HYPERELASTIC, {} is ogden with the same isochoric energy", given.law);
    Ok(Law { text, summary, notes, is_incompressible: kappa > 10.0 * shear })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_mesh_io::deck::{DeckPlace, Elastic};

    fn material(elastic: Option<(f64, f64)>, hyperelastic: Option<(&str, usize, &[f64])>) -> Material {
        Material {
            name: "m".to_owned(),
            density: None,
            elastic: elastic.map(|(modulus, ratio)| Elastic { modulus, ratio }),
            hyperelastic: hyperelastic.map(|(law, terms, coefficients)| Hyperelastic {
                law: law.to_owned(),
                terms,
                coefficients: coefficients.to_vec(),
            }),
            plastic: Vec::new(),
            is_kinematic: false,
            prony: Vec::new(),
            is_instantaneous: false,
            mullins: None,
            damping: None,
            place: DeckPlace { file: 0, line: 1 },
        }
    }

    #[test]
    fn elasticity_is_saint_venant_kirchhoff_or_mixed_neo_hooke() {
        let steel = material(Some((2.1e5, 0.3)), None);
        let svk = "{ law = \"saint-venant-kirchhoff\", young = 210000.0, poisson = 0.3 }";
        assert_eq!(law(&steel, false).unwrap().text, svk);
        let mixed = law(&steel, true).unwrap();
        assert!(mixed.text.contains("neo-hooke") && mixed.notes.len() == 1, "{mixed:?}");
        let incompressible = law(&material(Some((1.0, 0.5)), None), true).unwrap_err();
        assert!(incompressible.contains("write nu = 0.4999"), "{incompressible}");
        for bad in [(0.0, 0.3), (1.0, 0.5), (1.0, -1.0), (-1.0, 0.0), (f64::NAN, 0.3)] {
            assert!(law(&material(Some(bad), None), false).is_err(), "{bad:?}");
        }
        assert!(law(&material(None, None), false).unwrap_err().contains("no isotropic"));
    }

    #[test]
    fn relaxation_and_softening_are_keys_of_the_law() {
        let mut rubber = material(None, Some(("NEO HOOKE", 1, &[1.0, 0.01])));
        rubber.prony = vec![[0.3, 0.0, 0.1], [0.2, 0.1, 10.0]];
        rubber.mullins = Some([1.5, 0.3, 0.1]);
        let soft = law(&rubber, true).unwrap();
        let keys =
            "prony = [[0.3, 0.1], [0.2, 10.0]], moduli = \"long-term\", mullins = { r = 1.5, m = 0.3, beta = 0.1 } }";
        assert!(soft.text.starts_with("{ law = \"ogden\"") && soft.text.ends_with(keys), "{}", soft.text);
        assert!(soft.notes.iter().any(|(note, _)| note.contains("bulk modulus does not relax")), "{:?}", soft.notes);
        rubber.is_instantaneous = true;
        assert!(law(&rubber, true).unwrap().text.contains("moduli = \"instantaneous\""));
        let mut steel = material(Some((2.1e5, 0.3)), None);
        steel.prony = vec![[0.3, 0.0, 0.1]];
        let relaxing =
            "{ law = \"neo-hooke\", young = 210000.0, poisson = 0.3, prony = [[0.3, 0.1]], moduli = \"long-term\" }";
        assert_eq!(law(&steel, false).unwrap().text, relaxing);
        steel.plastic = vec![[0.0, 250.0]];
        let yields = law(&steel, false).unwrap();
        assert!(
            !yields.text.contains("prony") && yields.notes.iter().any(|(note, _)| note.contains("neither relaxes"))
        );
        for wrong in [vec![[0.6, 0.0, 1.0], [0.4, 0.0, 2.0]], vec![[-0.1, 0.0, 1.0]], vec![[0.1, 0.0, 0.0]]] {
            rubber.prony = wrong;
            assert!(law(&rubber, true).unwrap_err().contains("*VISCOELASTIC"));
        }
    }

    #[test]
    fn isotropic_hardening_is_plasticity_behind_hencky_s_law() {
        let mut steel = material(Some((2.1e5, 0.3)), None);
        steel.plastic = vec![[0.0, 250.0]];
        let perfect = law(&steel, false).unwrap();
        let expected = "{ law = \"hencky\", young = 210000.0, poisson = 0.3, plasticity = { yield_stress = 250.0 } }";
        assert_eq!(perfect.text, expected);
        steel.plastic.push([0.1, 300.0]);
        let hardening = "plasticity = { hardening = [[0.0, 250.0], [0.1, 300.0]] }";
        assert!(law(&steel, true).unwrap().text.contains(hardening));
        // Linear kinematic hardening: the slope between the two points.
        steel.is_kinematic = true;
        let kinematic = law(&steel, false).unwrap();
        assert!(kinematic.text.contains("yield_stress = 250.0, kinematic_modulus = 500.0"), "{}", kinematic.text);
        steel.plastic[1][1] = 200.0;
        assert!(law(&steel, false).unwrap_err().contains("falls"));
    }

    /// What a scene would refuse is a message of the import, and a table that begins late has its first stress before.
    #[test]
    fn tables_of_plasticity_that_scenes_refuse() {
        let mut steel = material(Some((2.1e5, 0.3)), None);
        steel.plastic = vec![[0.002, 250.0], [0.1, 300.0]];
        let late = law(&steel, false).unwrap();
        assert!(late.text.contains("hardening = [[0.0, 250.0], [0.002, 250.0], [0.1, 300.0]]"), "{}", late.text);
        assert!(late.notes.iter().any(|(note, _)| note.contains("0.002 and not 0")), "{:?}", late.notes);
        for (points, part) in [
            (vec![[0.0, -1.0]], "must be positive"),
            (vec![[0.0, 250.0], [0.0, 260.0]], "do not grow"),
            (vec![[-0.1, 250.0], [0.1, 260.0]], "not be negative"),
        ] {
            steel.plastic = points;
            let message = law(&steel, false).unwrap_err();
            assert!(message.contains(part), "{message}");
        }
    }

    /// Shear and bulk modulus at small strains, read from the text: `mu = sum mu_p alpha_p / 2`, `kappa`.
    #[test]
    fn hyperelastic_laws_keep_their_moduli() {
        let of = |name: &str, terms, c: &[f64]| law(&material(None, Some((name, terms, c))), false);
        let neo = of("NEOHOOKE", 1, &[3.0, 0.01]).unwrap();
        assert!(neo.text.contains("mu = [6.0], alpha = [2.0], kappa = 200.0"), "{}", neo.text);
        assert!(neo.is_incompressible);
        let mooney = of("MOONEY-RIVLIN", 1, &[3.0, 0.5, 1.0]).unwrap();
        // The shear modulus is 2 (C10 + C01) = 7 = (6 * 2 + -1 * -2) / 2.
        assert!(mooney.text.contains("mu = [6.0, -1.0], alpha = [2.0, -2.0], kappa = 2.0"), "{}", mooney.text);
        // Abaqus: the shear modulus is the sum of mu_i = 5; here 2 mu_i / alpha_i.
        let two = of("OGDEN", 2, &[4.0, 2.0, 1.0, -4.0, 0.5, 0.0]).unwrap();
        assert!(two.text.contains("mu = [4.0, -0.5], alpha = [2.0, -4.0], kappa = 4.0"), "{}", two.text);
        let free = of("NEOHOOKE", 1, &[1.0]).unwrap();
        // 2 mu (1 + nu) / (3 (1 - 2 nu)) with mu = 2.
        assert!(
            free.text.contains(&format!("kappa = {}", number(2.0 * 2.0 * 1.475 / (3.0 * (1.0 - 0.95))))),
            "{}",
            free.text
        );
        let yeoh = of("YEOH", 3, &[1.0, -0.1, 0.1, 0.5]).unwrap().text;
        assert_eq!(yeoh, "{ law = \"yeoh\", c1 = 1.0, c2 = -0.1, c3 = 0.1, kappa = 4.0 }");
        let chains = of("ARRUDA-BOYCE", 1, &[1.0, 3.0, 0.1]).unwrap().text;
        assert_eq!(chains, "{ law = \"arruda-boyce\", mu = 1.0, lock = 3.0, kappa = 20.0 }");
        assert!(of("YEOH", 3, &[1.0]).is_err());
        assert!(of("OGDEN", 1, &[1.0]).is_err());
        assert!(of("OGDEN", 1, &[1.0, 0.0]).is_err());
        assert!(of("OGDEN", 0, &[]).is_err());
        assert!(of("NEOHOOKE", 1, &[-1.0, 0.1]).is_err());
    }
}
