//! The laws of friction by name, as data: reader, schema, reference and messages of scenes follow from the rows.

use super::{Coulomb, FrictionLaw, Regularised, StaticDynamic};
use crate::ContactError;
use std::sync::Arc;
use stoss_registry::{Parameter, Refusal, Row, Unit, Values, number};

/// A row of the catalogue.
#[derive(Debug)]
pub struct FrictionEntry {
    /// The law and its parameters.
    pub law: Row<Arc<dyn FrictionLaw>>,
    /// The parameter that is the largest traction over pressure, if one is.
    pub coefficient: Option<&'static str>,
}

impl FrictionEntry {
    /// Whether the law has stick, and with it a tangential stiffness ([`FrictionLaw::sticks`]).
    pub fn sticks(&self) -> bool {
        self.law.of_examples().is_ok_and(|law| law.sticks())
    }
}

/// The row of a law.
pub fn entry(name: &str) -> Option<&'static FrictionEntry> {
    LAWS.iter().find(|entry| entry.law.name == name)
}

const MU: Parameter = number("mu", "Coefficient of friction, not negative.", Unit::Number, Values::NotNegative, 0.3);

/// A refusal of the law itself.
fn by_law(error: ContactError) -> Refusal {
    match error {
        ContactError::Friction { parameter, value, range } => {
            Refusal::new(parameter, format!("must be {range}, but is {value}"), "correct the parameter")
        }
        error => Refusal::new("law", error.to_string(), "correct the parameters"),
    }
}

/// Every law of this crate.
pub const LAWS: &[FrictionEntry] = &[
    FrictionEntry {
        law: Row {
            name: "coulomb",
            about: "Coulomb friction: the tangential traction does not exceed `mu` times the pressure.",
            ways: &[&[MU]],
            make: |_, given| Ok(Arc::new(Coulomb::new(given[0].number()).map_err(by_law)?)),
        },
        coefficient: Some("mu"),
    },
    FrictionEntry {
        law: Row {
            name: "static-dynamic",
            about: "Coulomb friction with a coefficient that decreases with the slip speed `v`, `mu_dynamic + (mu_static - mu_dynamic) exp(-(v / speed)^2)`.",
            ways: &[&[
                number(
                    "mu_static",
                    "Static coefficient of friction, not below `mu_dynamic`.",
                    Unit::Number,
                    Values::NotNegative,
                    0.5,
                ),
                number(
                    "mu_dynamic",
                    "Dynamic coefficient of friction, for fast slip; not negative.",
                    Unit::Number,
                    Values::NotNegative,
                    0.3,
                ),
                number(
                    "speed",
                    "Slip speed of the transition (length per time), positive.",
                    Unit::Velocity,
                    Values::Positive,
                    0.5,
                ),
            ]],
            make: |_, given| {
                let [mu_static, mu_dynamic, speed] = [given[0].number(), given[1].number(), given[2].number()];
                if mu_static < mu_dynamic {
                    let message = format!("is below `mu_dynamic` = {mu_dynamic}");
                    return Err(Refusal::new("mu_static", message, "let the coefficient at rest be the larger one"));
                }
                Ok(Arc::new(StaticDynamic::new(mu_static, mu_dynamic, speed).map_err(by_law)?))
            },
        },
        coefficient: Some("mu_static"),
    },
    FrictionEntry {
        law: Row {
            name: "regularised",
            about: "Regularised Coulomb friction without stick: traction `mu p v / sqrt(v^2 + speed^2)`.",
            ways: &[&[
                MU,
                number(
                    "speed",
                    "Slip speed below which friction is viscous (length per time), positive.",
                    Unit::Velocity,
                    Values::Positive,
                    0.2,
                ),
            ]],
            make: |_, given| Ok(Arc::new(Regularised::new(given[0].number(), given[1].number()).map_err(by_law)?)),
        },
        coefficient: Some("mu"),
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::Sliding;

    /// The examples of a row are a law of its name; its coefficient bounds traction over pressure at all speeds, and is reached at one.
    #[test]
    fn every_row_makes_a_law_of_its_examples() {
        for entry in LAWS {
            let row = &entry.law;
            let law = row.of_examples().unwrap();
            assert_eq!((law.name(), law.sticks()), (row.name, entry.sticks()));
            for left_out in row.parameters() {
                let fewer = row.parameters().filter(|p| p.name != left_out.name).map(|p| (p.name, p.example));
                assert_eq!(row.with(fewer).unwrap_err().parameter, left_out.name);
            }
            let Some(name) = entry.coefficient else { continue };
            let largest = row.parameters().find(|p| p.name == name).unwrap().example.number();
            let reached = [0.0, 1e-3, 0.1, 1.0, 1e100]
                .map(|speed| law.coefficient(&Sliding::steady(speed)).value)
                .into_iter()
                .fold(0.0, f64::max);
            assert_eq!(reached, largest, "{}", row.name);
        }
    }

    #[test]
    fn a_static_coefficient_below_the_dynamic_one_is_refused() {
        let row = &entry("static-dynamic").unwrap().law;
        let given = [("mu_static", 0.2), ("mu_dynamic", 0.3), ("speed", 1.0)];
        let refused = row.with(given.map(|(name, value)| (name, stoss_registry::Given::Number(value))));
        assert_eq!(refused.unwrap_err().parameter, "mu_static");
    }

    /// `mu_d + (mu_s - mu_d) exp(-(v / v_c)^2)`, and `mu v / sqrt(v^2 + v_0^2)` (theory/friction).
    #[test]
    fn coefficients_of_steady_slip() {
        let at = |law: &str, speed| {
            entry(law).unwrap().law.of_examples().unwrap().coefficient(&Sliding::steady(speed)).value
        };
        assert_eq!((at("coulomb", 0.0), at("coulomb", 3.0)), (0.3, 0.3));
        assert!((at("static-dynamic", 0.5) - (0.3 + 0.2 / 1f64.exp())).abs() < 1e-15);
        assert!((at("regularised", 0.2) - 0.3 / 2f64.sqrt()).abs() < 1e-15);
    }
}
