//! Keys that not every contact method has.

use super::node::Node;
use crate::chosen::of_which;
use crate::{ContactMethod, MethodEntry};

/// Reports a key that the contact's method does not have.
pub(super) fn of_method(node: &Node<'_>, key: &str, method: Option<ContactMethod>) -> Option<()> {
    match method {
        Some(method) if !method.has(key) => {
            let methods = of_which::<MethodEntry>(|method| method.has(key));
            node.fail(
                format!("is for contact by {methods}, not by `{method}`"),
                "remove it, or choose another `method`",
            )
        }
        _ => Some(()),
    }
}
