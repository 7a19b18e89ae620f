//! Reading of values and tables of the document, with a problem for each that is wrong.
//!
//! Most tables are read by what the attribute `table` writes for their types; what is not a table, or has the keys of a catalogue, implements [`Value`] itself. Not serde, which would stop at the first problem.

mod node;
mod old;
mod table;
mod value;
mod values;

pub(crate) use node::{Node, Report, is_name, with_article};
pub(crate) use table::{Contradiction, Table};
pub(crate) use value::{Limit, Value, alone, among, beside, divisions};
pub(crate) use values::{Parameters, TABLE as PARAMETERS, complaint};
