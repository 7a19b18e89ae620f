//! Reads the material of a body.

use super::node::Node;
use super::table::Table;
use crate::{ElasticModuli, Material, MooneyRivlin, Ogden, OwnMaterial, Parameter};
use std::collections::BTreeMap;
use toml::de::DeValue;

/// `own_laws`: names of the laws beside the catalogue.
pub(super) fn material(node: &Node<'_>, own_laws: &[&str]) -> Option<Material> {
    let table = node.table()?;
    let names: Vec<&str> = Material::NAMES.iter().chain(own_laws).copied().collect();
    let reader = table.required("law", "law = \"neo-hooke\"", |n| {
        n.choice(&names, |name| match name {
            "saint-venant-kirchhoff" => {
                Some((|t: &Table<'_>| moduli(t).map(Material::SaintVenantKirchhoff)) as fn(&Table<'_>) -> _)
            }
            "neo-hooke" => Some(|t: &Table<'_>| moduli(t).map(Material::NeoHooke)),
            "mooney-rivlin" => Some(mooney_rivlin),
            "ogden" => Some(ogden),
            name if own_laws.contains(&name) => Some(own),
            _ => None,
        })
    });
    // Without a law it is not known which other keys are right.
    let material = reader?(&table);
    table.finish();
    material
}

fn own(table: &Table<'_>) -> Option<Material> {
    let law = table.required("law", "law = \"mine\"", Node::name);
    let parameters = parameters(table);
    Some(Material::Own(OwnMaterial { law: law?, parameters: parameters? }))
}

/// The keys that nobody asked for, numbers and lists of numbers; which there are is the business of a law that is not in the catalogue.
pub(super) fn parameters(table: &Table<'_>) -> Option<BTreeMap<String, Parameter>> {
    let parameters: Vec<_> = table
        .rest()
        .map(|(key, node)| {
            let value = match node.value {
                DeValue::Array(_) => node.list(Node::number).map(Parameter::List),
                _ => node.number().map(Parameter::Number),
            };
            Some((key.to_owned(), value?))
        })
        .collect();
    parameters.into_iter().collect()
}

/// Poisson's ratio.
pub(super) fn poisson(node: &Node<'_>) -> Option<f64> {
    let value = node.number()?;
    if value == 0.5 {
        return node.fail(
            "must be below 0.5: that is an incompressible body, with an infinite bulk modulus and a pressure that is no function of the displacements",
            "use 0.49; of a body with `volumetric = \"mixed\"` up to 0.499999, without it elements lock from 0.495 on",
        );
    }
    if value <= -1.0 || value >= 0.5 {
        return node.fail(
            "must lie between -1 and 0.5, both excluded",
            "use for instance 0.3, 0.49 for rubber, or up to 0.499999 for a body with `volumetric = \"mixed\"`",
        );
    }
    Some(value)
}

fn moduli(table: &Table<'_>) -> Option<ElasticModuli> {
    let young = table.optional("young", Node::positive);
    let poisson = table.optional("poisson", poisson);
    let lambda = table.optional("lambda", Node::number);
    let mu = table.optional("mu", Node::positive);
    let [has_young, has_poisson, has_lambda, has_mu] = ["young", "poisson", "lambda", "mu"].map(|key| table.has(key));
    match (has_young || has_poisson, has_lambda || has_mu) {
        (true, true) => {
            let key = if has_lambda { "lambda" } else { "mu" };
            return table.fail(
                key,
                "cannot be combined with the other moduli",
                "give either `young` and `poisson`, or `lambda` and `mu`",
            );
        }
        (false, false) => return table.missing("young", "young = 2250.0, poisson = 0.3"),
        (true, false) if !has_young => return table.missing("young", "young = 2250.0"),
        (true, false) if !has_poisson => return table.missing("poisson", "poisson = 0.3"),
        (false, true) if !has_lambda => return table.missing("lambda", "lambda = 1298.0"),
        (false, true) if !has_mu => return table.missing("mu", "mu = 865.0"),
        _ => {}
    }
    let moduli = ElasticModuli { young: young?, poisson: poisson?, lambda: lambda?, mu: mu? };
    if let (Some(lambda), Some(mu)) = (moduli.lambda, moduli.mu)
        && lambda + 2.0 / 3.0 * mu <= 0.0
    {
        let bulk = lambda + 2.0 / 3.0 * mu;
        return table.fail(
            "lambda",
            format!("implies the bulk modulus lambda + 2/3 mu = {bulk}, which must be positive"),
            "increase lambda",
        );
    }
    Some(moduli)
}

fn mooney_rivlin(table: &Table<'_>) -> Option<Material> {
    let c1 = table.required("c1", "c1 = 176051.0", Node::number);
    let c2 = table.required("c2", "c2 = 4332.63", Node::number);
    let c = table.required("c", "c = 2.0e6", Node::number);
    let (c1, c2, c) = (c1?, c2?, c?);
    let shear = 2.0 * (c1 + c2);
    if shear <= 0.0 {
        return table.fail(
            "c1",
            format!("implies the shear modulus 2 (c1 + c2) = {shear}, which must be positive"),
            "increase c1 or c2",
        );
    }
    let bulk = 2.0 * c + 4.0 * c2 + 2.0 / 3.0 * shear;
    if bulk <= 0.0 {
        return table.fail(
            "c",
            format!("implies the bulk modulus 2 c + 4 c2 + 4/3 (c1 + c2) = {bulk}, which must be positive"),
            "increase c",
        );
    }
    Some(Material::MooneyRivlin(MooneyRivlin { c1, c2, c }))
}

fn ogden(table: &Table<'_>) -> Option<Material> {
    let mu = table.required("mu", "mu = [6300.0, 12.0, -100.0]", |n| {
        let mu = n.list(Node::number)?;
        if mu.is_empty() {
            return n.fail("must have one term or more", "write for instance [6300.0, 12.0, -100.0]");
        }
        Some(mu)
    });
    let alpha = table.required("alpha", "alpha = [1.3, 5.0, -2.0]", |n| n.list(Node::not_zero));
    let kappa = table.required("kappa", "kappa = 2000.0", Node::positive);
    let beta = table.required("beta", "beta = 9.0", Node::not_zero);
    let (mu, alpha) = (mu?, alpha?);
    if mu.len() != alpha.len() {
        return table.fail(
            "alpha",
            format!("has {} terms and `mu` has {}", alpha.len(), mu.len()),
            "give one exponent for each modulus",
        );
    }
    let shear = 0.5 * mu.iter().zip(&alpha).map(|(m, a)| m * a).sum::<f64>();
    if shear <= 0.0 {
        return table.fail(
            "mu",
            format!("implies the shear modulus 1/2 sum mu alpha = {shear}, which must be positive"),
            "correct the signs of mu and alpha",
        );
    }
    Some(Material::Ogden(Ogden { mu, alpha, kappa: kappa?, beta: beta? }))
}
