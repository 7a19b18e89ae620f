//! Reads the material of a body.

use super::catalogue;
use super::inelastic;
use super::node::Node;
use crate::Material;
use crate::material::Inelasticity;

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
    let Some(entry) = stoss_materials::entry(&law) else {
        let parameters = catalogue::parameters(&table);
        table.finish();
        return Some(Material { law, inelasticity: Inelasticity::default(), parameters: parameters? });
    };
    let inelasticity = inelastic::inelasticity(&table);
    let parameters = catalogue::of_row(&table, entry);
    table.finish();
    let (inelasticity, parameters) = (inelasticity?, parameters?);
    match inelasticity.check(entry, &parameters) {
        Ok(()) => Some(Material { law, inelasticity, parameters }),
        Err(refusal) => table.fail(refusal.parameter, refusal.message, refusal.remedy),
    }
}
