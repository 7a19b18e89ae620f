//! Rows of catalogues: what can be chosen by a name, as data. A scene format, its schema, its reference and its messages follow from the rows.
//!
//! * [`Row`]: name, sentence, parameters, and what makes the thing of them; a catalogue is a `const` slice of rows, [`entry`] finds one;
//! * [`Parameter`]: name, meaning, [`Unit`], range ([`Values`]) and an example;
//! * [`Given`]: a value that is given for one; [`Refusal`]: why values are refused.
//!
//! Not here: any catalogue, files, and choices without parameters of their own.
//!
//! To add a catalogue: `pub const LAWS: &[Row<Arc<dyn Law>>]` where the trait's implementors are.
//!
#![doc = include_str!("../README.md")]

mod parameter;
mod row;

pub use parameter::{Given, Parameter, Unit, Values, list, number};
pub use row::{Refusal, Row, entry};
