//! All laws by name, as data: parameters, ranges, and what makes the law. A scene format, its schema and its messages follow from the rows.

use crate::{FirstInvariant, Hencky, MaterialError, MooneyRivlin, NeoHooke, Ogden, SaintVenantKirchhoff};
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_registry::{Given, Parameter, Refusal, Row, Unit, Values, list};

/// A row of the catalogue.
pub type LawEntry = Row<Arc<dyn HyperelasticLaw>>;

/// The row of a law.
pub fn entry(name: &str) -> Option<&'static LawEntry> {
    stoss_registry::entry(LAWS, name)
}

const fn stress(name: &'static str, about: &'static str, values: Values, example: f64) -> Parameter {
    stoss_registry::number(name, about, Unit::Stress, values, example)
}

const fn number(name: &'static str, about: &'static str, values: Values, example: f64) -> Parameter {
    stoss_registry::number(name, about, Unit::Number, values, example)
}

/// Two elastic moduli.
const MODULI: &[&[Parameter]] = &[
    &[
        stress("young", "Young's modulus `E` (stress), positive; together with `poisson`.", Values::Positive, 2250.0),
        number("poisson", "Poisson's ratio, in (-1, 1/2); together with `young`.", Values::Poisson, 0.3),
    ],
    &[
        stress(
            "lambda",
            "First Lame parameter (stress), larger than `-2/3 mu`; together with `mu`.",
            Values::Any,
            1298.0,
        ),
        stress("mu", "Shear modulus (stress), positive; together with `lambda`.", Values::Positive, 865.0),
    ],
];

/// Refuses Lame parameters without a positive bulk modulus.
fn bulk_of(way: usize, given: &[Given<'_>]) -> Result<[f64; 2], Refusal> {
    let [a, b] = [given[0].number(), given[1].number()];
    let bulk = a + 2.0 / 3.0 * b;
    if way == 1 && bulk <= 0.0 {
        let message = format!("implies the bulk modulus lambda + 2/3 mu = {bulk}, which must be positive");
        return Err(Refusal::new("lambda", message, "increase lambda"));
    }
    Ok([a, b])
}

/// A refusal of the law itself, of what the row should have refused.
fn by_law(parameter: &'static str) -> impl Fn(MaterialError) -> Refusal {
    move |error| {
        Refusal::new(
            parameter,
            error.to_string(),
            "choose parameters with positive shear and bulk moduli at small strains",
        )
    }
}

/// Every law of this crate.
pub const LAWS: &[LawEntry] = &[
    LawEntry {
        name: "saint-venant-kirchhoff",
        about: "Saint Venant-Kirchhoff law: `W = lambda/2 (tr E)^2 + mu E:E`. For small strains with large rotations; it softens in compression.",
        ways: MODULI,
        make: |way, given| {
            let [a, b] = bulk_of(way, given)?;
            let law =
                if way == 0 { SaintVenantKirchhoff::from_young_poisson(a, b) } else { SaintVenantKirchhoff::new(a, b) };
            Ok(Arc::new(law.map_err(by_law(MODULI[way][0].name))?))
        },
    },
    LawEntry {
        name: "neo-hooke",
        about: "Compressible neo-Hooke law: `W = mu/2 (I1 - 3) + lambda/2 (ln J)^2 - mu ln J`.",
        ways: MODULI,
        make: |way, given| {
            let [a, b] = bulk_of(way, given)?;
            let law = if way == 0 { NeoHooke::from_young_poisson(a, b) } else { NeoHooke::new(a, b) };
            Ok(Arc::new(law.map_err(by_law(MODULI[way][0].name))?))
        },
    },
    LawEntry {
        name: "hencky",
        about: "Hencky law, linear in the logarithmic strain `E = ln(C)/2`: `W = mu dev E : dev E + K/2 (ln J)^2`. The elastic part of metals, for moderate elastic strains.",
        ways: MODULI,
        make: |way, given| {
            let [a, b] = bulk_of(way, given)?;
            let law = if way == 0 { Hencky::from_young_poisson(a, b) } else { Hencky::new(a, b) };
            Ok(Arc::new(law.map_err(by_law(MODULI[way][0].name))?))
        },
    },
    LawEntry {
        name: "mooney-rivlin",
        about: "Compressible Mooney-Rivlin law: `W = c1 (I1 - 3) + c2 (I2 - 3) + c (J - 1)^2 - 2 (c1 + 2 c2) ln J`.",
        ways: &[&[
            stress("c1", "Factor of the first invariant (stress).", Values::Any, 176051.0),
            stress("c2", "Factor of the second invariant (stress).", Values::Any, 4332.63),
            stress("c", "Volumetric parameter (stress).", Values::Any, 2.0e6),
        ]],
        make: |_, given| {
            let [c1, c2, c] = [given[0].number(), given[1].number(), given[2].number()];
            let shear = 2.0 * (c1 + c2);
            if shear <= 0.0 {
                let message = format!("implies the shear modulus 2 (c1 + c2) = {shear}, which must be positive");
                return Err(Refusal::new("c1", message, "increase c1 or c2"));
            }
            let bulk = 2.0 * c + 4.0 * c2 + 2.0 / 3.0 * shear;
            if bulk <= 0.0 {
                let message =
                    format!("implies the bulk modulus 2 c + 4 c2 + 4/3 (c1 + c2) = {bulk}, which must be positive");
                return Err(Refusal::new("c", message, "increase c"));
            }
            Ok(Arc::new(MooneyRivlin::new(c1, c2, c).map_err(by_law("c1"))?))
        },
    },
    LawEntry {
        name: "yeoh",
        about: "Yeoh law of the isochoric first invariant, `x = J^(-2/3) I1 - 3`: `W = c1 x + c2 x^2 + c3 x^3 + kappa/2 (ln J)^2`. Shear modulus `2 c1`.",
        ways: &[&[
            stress("c1", "Factor of `x` (stress), positive.", Values::Positive, 0.5),
            stress("c2", "Factor of `x^2` (stress).", Values::Any, -0.005),
            stress("c3", "Factor of `x^3` (stress).", Values::Any, 0.0002),
            stress("kappa", "Bulk modulus (stress), positive.", Values::Positive, 100.0),
        ]],
        make: |_, given| {
            let [c1, c2, c3, kappa] = std::array::from_fn(|k| given[k].number());
            Ok(Arc::new(FirstInvariant::yeoh([c1, c2, c3], kappa).map_err(by_law("c1"))?))
        },
    },
    LawEntry {
        name: "gent",
        about: "Gent law, `x = J^(-2/3) I1 - 3` below a limit: `W = -mu/2 limit ln(1 - x/limit) + kappa/2 (ln J)^2`. Shear modulus `mu`.",
        ways: &[&[
            stress("mu", "Shear modulus (stress), positive.", Values::Positive, 1.0),
            number("limit", "Largest `x`, positive.", Values::Positive, 50.0),
            stress("kappa", "Bulk modulus (stress), positive.", Values::Positive, 100.0),
        ]],
        make: |_, given| {
            let [mu, limit, kappa] = std::array::from_fn(|k| given[k].number());
            Ok(Arc::new(FirstInvariant::gent(mu, limit, kappa).map_err(by_law("mu"))?))
        },
    },
    LawEntry {
        name: "arruda-boyce",
        about: "Arruda-Boyce law of eight chains by five terms of its series, `y = J^(-2/3) I1`: `W = mu sum_i C_i/lock^(2i-2) (y^i - 3^i) + kappa/2 (ln J)^2`.",
        ways: &[&[
            stress("mu", "Factor (stress), positive; the shear modulus for a large `lock`.", Values::Positive, 1.0),
            number("lock", "Locking stretch of the chains, above 1.", Values::Positive, 4.0),
            stress("kappa", "Bulk modulus (stress), positive.", Values::Positive, 100.0),
        ]],
        make: |_, given| {
            let [mu, lock, kappa] = std::array::from_fn(|k| given[k].number());
            Ok(Arc::new(FirstInvariant::arruda_boyce(mu, lock, kappa).map_err(by_law("lock"))?))
        },
    },
    LawEntry {
        name: "ogden",
        about: "Ogden law with the isochoric principal stretches `lbar_a`: `W = sum_p mu_p/alpha_p (sum_a lbar_a^alpha_p - 3) + kappa (ln(J)/beta + (J^-beta - 1)/beta^2)`. Shear modulus `1/2 sum_p mu_p alpha_p`.",
        ways: &[&[
            list(
                "mu",
                "Moduli of the terms (stress); one or more.",
                Unit::Stress,
                Values::Any,
                &[6300.0, 12.0, -100.0],
            ),
            list(
                "alpha",
                "Exponents of the terms, none zero; as many as `mu`.",
                Unit::Number,
                Values::NotZero,
                &[1.3, 5.0, -2.0],
            ),
            stress("kappa", "Bulk modulus (stress), positive.", Values::Positive, 2000.0),
            number("beta", "Exponent of the volumetric part, not zero.", Values::NotZero, 9.0),
        ]],
        make: |_, given| {
            let (mu, alpha) = (given[0].list(), given[1].list());
            if mu.len() != alpha.len() {
                let message = format!("has {} terms and `mu` has {}", alpha.len(), mu.len());
                return Err(Refusal::new("alpha", message, "give one exponent for each modulus"));
            }
            let shear = 0.5 * mu.iter().zip(alpha).map(|(m, a)| m * a).sum::<f64>();
            if shear <= 0.0 {
                let message = format!("implies the shear modulus 1/2 sum mu alpha = {shear}, which must be positive");
                return Err(Refusal::new("mu", message, "correct the signs of mu and alpha"));
            }
            Ok(Arc::new(Ogden::new(mu, alpha, given[2].number(), given[3].number()).map_err(by_law("mu"))?))
        },
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of every row are a law with positive moduli, by each way; without one of them, or with an unknown one, they are none.
    #[test]
    fn every_row_makes_a_law_of_its_examples() {
        for entry in LAWS {
            for (way, parameters) in entry.ways.iter().enumerate() {
                let given: Vec<(&str, Given<'_>)> = parameters.iter().map(|p| (p.name, p.example)).collect();
                let law = entry.with(given.clone()).unwrap_or_else(|e| panic!("{} {way}: {e}", entry.name));
                let moduli = law.small_strain_moduli();
                assert!(law.name() == entry.name && moduli.shear > 0.0 && moduli.bulk > 0.0, "{}", entry.name);
                for left_out in 0..given.len() {
                    let mut fewer = given.clone();
                    let (name, _) = fewer.remove(left_out);
                    assert_eq!(entry.with(fewer).unwrap_err().parameter, name);
                }
                let more = given.iter().copied().chain([("nothing", Given::Number(1.0))]);
                assert_eq!(entry.with(more).unwrap_err().parameter, "law");
            }
        }
    }

    #[test]
    fn moduli_of_two_ways_are_refused() {
        let row = entry("neo-hooke").unwrap();
        let [one, two] = [("young", Given::Number(1.0)), ("mu", Given::Number(1.0))];
        assert_eq!(row.with([one, two]).unwrap_err().parameter, "mu");
        assert_eq!(row.with([]).unwrap_err().parameter, "young");
        let negative = [("lambda", Given::Number(-7.0)), ("mu", Given::Number(1.0))];
        assert_eq!(row.with(negative).unwrap_err().parameter, "lambda");
        let young = [("young", Given::Number(2250.0)), ("poisson", Given::Number(0.3))];
        let moduli = row.with(young).unwrap().small_strain_moduli();
        // theory/kinematics#moduli: E = 2250, nu = 0.3.
        assert!((moduli.shear - 865.3846).abs() < 1e-4 && (moduli.bulk - 1875.0).abs() < 1e-9, "{moduli:?}");
    }
}
