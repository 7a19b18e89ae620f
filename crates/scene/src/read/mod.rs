//! Reading of values and tables of the document, with a problem for each that is wrong.
//!
//! The tables themselves are read by what the attribute `table` writes for their types. Not serde, which would stop at the first problem.

mod node;
mod old;
mod table;
mod value;
mod values;

pub(crate) use node::{Node, Report, is_name};
pub(crate) use table::{Contradiction, Table};
pub(crate) use value::{Limit, Value, alone, among, beside, divisions};
pub(crate) use values::{Parameters, TABLE as PARAMETERS, complaint};
