//! Values of parameters and of expressions over them.

use crate::expression::{self, ExpressionError, Name};
use crate::spelling::known;
use std::collections::BTreeMap;

/// Parameters by name; `None` has a value that is wrong.
pub(crate) type Parameters = BTreeMap<String, Option<f64>>;

/// The table of the parameters.
pub(crate) const TABLE: &str = "parameters";

/// A problem of an expression, or nothing to say because it is said elsewhere.
pub(crate) type Complaint = Option<(String, String)>;

/// The value of an expression.
pub(crate) fn evaluate(text: &str, parameters: &Parameters) -> Result<f64, Complaint> {
    expression::evaluate(text, &|name| match parameters.get(name) {
        Some(Some(value)) => Name::Value(*value),
        Some(None) => Name::Wrong,
        None => Name::Unknown,
    })
    .map_err(|error| complaint(&error, parameters))
}

/// What to say of an expression that has no value.
pub(crate) fn complaint(error: &ExpressionError, parameters: &Parameters) -> Complaint {
    match error {
        ExpressionError::Reported => None,
        ExpressionError::UnknownName(name) => {
            let message = format!("must be a number or an expression, and `{name}` is not a parameter");
            let remedy = if parameters.is_empty() {
                format!("write a number, or add `[{TABLE}]` with `{name} = 1.0`")
            } else {
                known(name, parameters.keys().map(String::as_str))
            };
            Some((message, remedy))
        }
        ExpressionError::Wrong { message, at } => Some((
            format!("is not a valid expression: character {at}: {message}"),
            "write a number, or an expression such as \"2*radius + 1e-3\"".to_owned(),
        )),
    }
}
