//! The table of all schemes by name.

use crate::{
    BackwardEuler, EnergyMomentum, ForwardEuler, GeneralisedAlpha, Midpoint, Scheme, Trapezoidal, VariationalMidpoint,
};

/// A parameter of a scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name in scenes.
    pub name: &'static str,
    /// Default value.
    pub default: f64,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Meaning, in a phrase.
    pub about: &'static str,
}

/// A row of the table of schemes.
#[derive(Clone, Copy, Debug)]
pub struct SchemeEntry {
    /// Name used in scenes.
    pub name: &'static str,
    /// The scheme in one sentence.
    pub about: &'static str,
    /// Parameters of the scheme.
    pub parameters: &'static [Parameter],
    /// Makes the scheme from one value for each parameter, each within its range.
    pub make: fn(&[f64]) -> Box<dyn Scheme>,
}

const SPECTRAL_RADIUS: Parameter = Parameter {
    name: "rho_inf",
    default: 0.7,
    range: (0.0, 1.0),
    about: "spectral radius at infinite frequency: 1 no damping, 0 most",
};

/// Every scheme of this crate.
pub const SCHEMES: &[SchemeEntry] = &[
    SchemeEntry {
        name: "energy-momentum",
        about: "Conserves energy, linear and angular momentum for every law and step size.",
        parameters: &[],
        make: |_| Box::new(EnergyMomentum),
    },
    SchemeEntry {
        name: "midpoint",
        about: "Implicit midpoint rule: conserves both momenta, but not the energy.",
        parameters: &[],
        make: |_| Box::new(Midpoint),
    },
    SchemeEntry {
        name: "variational-midpoint",
        about: "Generalised midpoint scheme of a discrete Lagrangian in position-momentum form: symplectic, conserves both \
                momenta, but not the energy.",
        parameters: &[Parameter {
            name: "alpha",
            default: 0.5,
            range: (0.0, 0.95),
            about: "position of the forces in the step, 0 start to 1 end; second order only for 1/2",
        }],
        make: |p| Box::new(VariationalMidpoint { alpha: p[0] }),
    },
    SchemeEntry {
        name: "trapezoidal",
        about: "Trapezoidal rule: second order, conserves linear momentum only.",
        parameters: &[],
        make: |_| Box::new(Trapezoidal),
    },
    SchemeEntry {
        name: "generalised-alpha",
        about: "Generalised-alpha method with controlled dissipation of high frequencies (Chung and Hulbert).",
        parameters: &[SPECTRAL_RADIUS],
        make: |p| Box::new(GeneralisedAlpha::chung_hulbert(p[0])),
    },
    SchemeEntry {
        name: "hht",
        about: "Generalised-alpha with inertia at the end point (Hilber, Hughes and Taylor).",
        parameters: &[Parameter { range: (0.5, 1.0), ..SPECTRAL_RADIUS }],
        make: |p| Box::new(GeneralisedAlpha::hht(p[0])),
    },
    SchemeEntry {
        name: "wbz",
        about: "Generalised-alpha with forces at the end point (Wood, Bossak and Zienkiewicz).",
        parameters: &[SPECTRAL_RADIUS],
        make: |p| Box::new(GeneralisedAlpha::wbz(p[0])),
    },
    SchemeEntry {
        name: "newmark",
        about: "Newmark's method: second order for gamma = 1/2.",
        parameters: &[
            Parameter {
                name: "beta",
                default: 0.25,
                range: (0.05, 1.0),
                about: "weight of the new acceleration in positions",
            },
            Parameter {
                name: "gamma",
                default: 0.5,
                range: (0.5, 1.0),
                about: "weight of the new acceleration in velocities; above 1/2 first order and dissipative",
            },
        ],
        make: |p| Box::new(GeneralisedAlpha::newmark(p[0], p[1])),
    },
    SchemeEntry {
        name: "backward-euler",
        about: "Backward Euler method: first order, dissipates, very robust.",
        parameters: &[],
        make: |_| Box::new(BackwardEuler),
    },
    SchemeEntry {
        name: "forward-euler",
        about: "Forward Euler method: explicit, first order, unstable for oscillations; without contact only.",
        parameters: &[],
        make: |_| Box::new(ForwardEuler),
    },
];

/// Why a scheme cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SchemeError {
    /// A name that is not in the table.
    #[error("there is no scheme `{name}`")]
    Unknown {
        /// Name that was asked for.
        name: String,
    },
    /// The scheme has no such parameter.
    #[error("scheme `{scheme}` has no parameter `{name}`")]
    UnknownParameter {
        /// The scheme.
        scheme: &'static str,
        /// Name of the parameter given.
        name: String,
    },
    /// Out of range.
    #[error("`{name}` = {value} of scheme `{scheme}` is not in [{}, {}]", range.0, range.1)]
    OutOfRange {
        /// The scheme.
        scheme: &'static str,
        /// The parameter.
        name: &'static str,
        /// Value given.
        value: f64,
        /// Smallest and largest value.
        range: (f64, f64),
    },
}

/// The row of that name, if there is one.
pub fn entry(name: &str) -> Option<&'static SchemeEntry> {
    SCHEMES.iter().find(|entry| entry.name == name)
}

impl SchemeEntry {
    /// Makes the scheme with parameters given by name; those not given take their default.
    ///
    /// # Errors
    /// [`SchemeError::UnknownParameter`], [`SchemeError::OutOfRange`] (NaN included).
    pub fn with<'a>(&self, given: impl IntoIterator<Item = (&'a str, f64)>) -> Result<Box<dyn Scheme>, SchemeError> {
        let mut values: Vec<f64> = self.parameters.iter().map(|p| p.default).collect();
        for (name, value) in given {
            let Some(k) = self.parameters.iter().position(|p| p.name == name) else {
                return Err(SchemeError::UnknownParameter { scheme: self.name, name: name.to_owned() });
            };
            let Parameter { name, range, .. } = self.parameters[k];
            if !(value >= range.0 && value <= range.1) {
                return Err(SchemeError::OutOfRange { scheme: self.name, name, value, range });
            }
            values[k] = value;
        }
        Ok((self.make)(&values))
    }
}

/// The scheme of that name with its default parameters.
///
/// # Errors
/// [`SchemeError::Unknown`].
pub fn scheme(name: &str) -> Result<Box<dyn Scheme>, SchemeError> {
    entry(name).ok_or_else(|| SchemeError::Unknown { name: name.to_owned() })?.with([])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_make_schemes_of_their_name_and_check_parameters() {
        for row in SCHEMES {
            assert_eq!(row.with([]).unwrap().name(), row.name);
            assert!(row.with([("nonsense", 1.0)]).is_err());
            for parameter in row.parameters {
                let (low, high) = parameter.range;
                for good in [low, high, parameter.default] {
                    assert!(row.with([(parameter.name, good)]).is_ok());
                }
                for bad in [low - 0.01, high + 0.01, f64::NAN, f64::INFINITY] {
                    assert!(matches!(row.with([(parameter.name, bad)]), Err(SchemeError::OutOfRange { .. })));
                }
            }
        }
        assert!(matches!(scheme("leapfrog"), Err(SchemeError::Unknown { .. })));
    }

    #[test]
    fn a_scheme_with_history_takes_its_forces_at_the_end_point() {
        use crate::{ForceRule, GradientRule};
        for row in SCHEMES {
            let rule = row.with([]).unwrap().rule(0.1);
            if let Some(history) = rule.history {
                assert!(!history.force || rule.force.rule == ForceRule::END_POINT, "{}", row.name);
                assert!(!history.constraint || rule.constraint.rule == GradientRule::EndPoint, "{}", row.name);
            }
        }
    }
}
