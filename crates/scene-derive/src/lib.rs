//! The attribute macro [`macro@table`] of the scene format: a key is a field, and its reader and its schema follow.
//!
#![doc = include_str!("../README.md")]

mod options;
mod structure;
mod variants;

use proc_macro::TokenStream;
use syn::{Data, DeriveInput, parse_macro_input};

/// A table of a scene from a struct, or from an enumeration of structs that a key tells apart.
///
/// The type gets `Clone`, `Debug`, `PartialEq`, `Serialize`, with the feature `schema` also `JsonSchema`, and `crate::read::Value`: reading it from a table of
/// the document reports every problem with file, line, key, value and remedy, unknown keys among them. A struct whose keys may all be left out also gets `Default`: every key left out.
///
/// # Options of the type: `#[table(...)]`
/// | option | meaning |
/// |---|---|
/// | `example = "{ axis = [0, 0, 1] }"` | what is shown if the value is not a table |
/// | `context(World<'_>)` | what readers and checks are given beside the document; any type if left out |
/// | `check = path` | `fn(&Keys, &Table, &context) -> Option<()>`, after all keys were read: contradictions between keys. `Keys` is the struct of the same fields, each an `Option` that is `None` where the key is wrong or missing |
/// | `check_all = path` | `fn(&Self, &Table, &context) -> Option<()>`, if all keys are right |
/// | `tag = "kind"` | of an enumeration: key of the name of the variant |
///
/// # Options of a field: `#[key(...)]`
/// A field of type `Option` may be left out, a field with a default too, and every other one is required.
///
/// | option | meaning |
/// |---|---|
/// | `name = "self"` | the key, if it is not the name of the field |
/// | `default`, `default = value` | value if the key is left out: that of the type, or this one |
/// | `tables` | the elements are tables of their own, `[[key]]`; none if left out |
/// | `auto` | the word `"auto"` says the same as leaving the key out |
/// | `skip` | a default value is not written, and the schema does not show it |
/// | `example = "1.0"` | value in the remedy for a key that is missing; a required key has one |
/// | `dimension = Length` | physical dimension: a variant of `Dimension`, a list of them, or words |
/// | `positive`, `not_negative`, `name`, `direction`, ... | a reader of `Node` for the value, or for the numbers of an array |
/// | `range = 1..=3` | smallest and largest value of a whole number |
/// | `read = path` | `fn(&Node) -> Option<T>`: a reader of its own |
/// | `by = path` | `fn(&Node, &context) -> Option<T>`: a reader of its own for the value, or for each element of an array or a list |
/// | `with = path` | `fn(&Node, &context, &Keys) -> Option<T>`: a reader of its own, which sees the keys that were read before |
#[proc_macro_attribute]
pub fn table(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let arguments = parse_macro_input!(arguments with options::parse);
    let input = parse_macro_input!(item as DeriveInput);
    let code = match &input.data {
        Data::Struct(_) => structure::expand(&arguments, input),
        Data::Enum(_) => variants::expand(&arguments, input),
        Data::Union(_) => Err(syn::Error::new_spanned(&input.ident, "a table is a struct or an enumeration")),
    };
    code.unwrap_or_else(|error| error.into_compile_error()).into()
}
