//! Reads the material of a body.

use super::catalogue;
use super::node::Node;
use crate::Material;

/// `own_laws`: names of the laws beside the catalogue.
pub(super) fn material(node: &Node<'_>, own_laws: &[&str]) -> Option<Material> {
    let table = node.table()?;
    let mut names: Vec<&str> = Material::names().collect();
    names.extend_from_slice(own_laws);
    let law = table.required("law", "law = \"neo-hooke\"", |n| {
        n.choice(&names, |name| names.contains(&name).then(|| name.to_owned()))
    });
    // Without a law it is not known which other keys are right.
    let law = law?;
    let parameters = match stoss_materials::entry(&law) {
        Some(entry) => catalogue::of_row(&table, entry),
        None => catalogue::parameters(&table),
    };
    table.finish();
    Some(Material { law, parameters: parameters? })
}
