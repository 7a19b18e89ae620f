//! Parameters of a row, and values that are given for them.

use std::fmt;

/// What a parameter is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A stress.
    Stress,
    /// A length per time.
    Velocity,
    /// A pure number.
    Number,
}

/// Values that a parameter may have by itself; all are finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Any.
    Any,
    /// Number above zero.
    Positive,
    /// Zero and above.
    NotNegative,
    /// Any but zero.
    NotZero,
    /// Poisson's ratio: above -1 and below 1/2.
    Poisson,
}

impl Values {
    /// Whether a number is among them.
    pub fn contain(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::NotZero => value != 0.0,
                Self::Poisson => value > -1.0 && value < 0.5,
            }
    }
}

/// A parameter of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name in scenes.
    pub name: &'static str,
    /// Meaning, a sentence.
    pub about: &'static str,
    /// Unit.
    pub unit: Unit,
    /// Values of it, or of each number of a list.
    pub values: Values,
    /// A value that it may have; a list, if the parameter is one or more numbers.
    pub example: Given<'static>,
}

impl Parameter {
    /// Whether it is a list of numbers, of one or more.
    pub fn is_list(&self) -> bool {
        matches!(self.example, Given::List(_))
    }
}

/// A parameter that is a number.
pub const fn number(name: &'static str, about: &'static str, unit: Unit, values: Values, example: f64) -> Parameter {
    Parameter { name, about, unit, values, example: Given::Number(example) }
}

/// A parameter that is a list of numbers.
pub const fn list(
    name: &'static str,
    about: &'static str,
    unit: Unit,
    values: Values,
    example: &'static [f64],
) -> Parameter {
    Parameter { name, about, unit, values, example: Given::List(example) }
}

/// A value that is given for a parameter. Shown as a scene has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given<'a> {
    /// A number.
    Number(f64),
    /// A list of numbers.
    List(&'a [f64]),
}

impl Given<'_> {
    /// Numbers of the value, one or more.
    pub fn list(&self) -> &[f64] {
        match self {
            Self::Number(value) => std::slice::from_ref(value),
            Self::List(values) => values,
        }
    }

    /// The number, or the first one of a list; NaN of an empty list, which no parameter has.
    pub fn number(&self) -> f64 {
        self.list().first().copied().unwrap_or(f64::NAN)
    }
}

impl fmt::Display for Given<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value:?}"),
            Self::List(values) => write!(f, "{values:?}"),
        }
    }
}
