//! Reads the parameters of a row of a catalogue.

use super::node::Node;
use super::table::Table;
use crate::{Parameter, given};
use std::collections::BTreeMap;
use stoss_registry::{Row, Values};
use toml::de::DeValue;

/// The parameters of a row, if it makes something of them.
pub(crate) fn of_row<T>(table: &Table<'_>, entry: &Row<T>) -> Option<BTreeMap<String, Parameter>> {
    let read = |n: &Node<'_>, values: Values| match values {
        Values::Any => n.number(),
        Values::Positive => n.positive(),
        Values::NotNegative => n.not_negative(),
        Values::NotZero => n.not_zero(),
        Values::Poisson => poisson(n),
    };
    let way = match entry.way(|name| table.has(name)) {
        Ok(way) => way,
        Err(refusal) => {
            // What is there is looked at all the same.
            entry.parameters().filter(|p| table.has(p.name)).for_each(|p| {
                table.optional(p.name, |n| read(n, p.values));
            });
            return table.fail(refusal.parameter, refusal.message, refusal.remedy);
        }
    };
    let others = entry.ways.iter().enumerate().filter(|(other, _)| *other != way).flat_map(|(_, way)| way.iter());
    others.for_each(|parameter| {
        table.get(parameter.name);
    });
    let values: Vec<_> = entry.ways[way]
        .iter()
        .map(|parameter| {
            let example = format!("{} = {}", parameter.name, parameter.example);
            let value = table.required(parameter.name, &example, |n| {
                if !parameter.is_list() {
                    return read(n, parameter.values).map(Parameter::Number);
                }
                let list = n.list(|n| read(n, parameter.values))?;
                if list.is_empty() {
                    return n.fail("must have one term or more", format!("write for instance {}", parameter.example));
                }
                Some(Parameter::List(list))
            });
            Some((parameter.name.to_owned(), value?))
        })
        .collect();
    let parameters: BTreeMap<String, Parameter> = values.into_iter().collect::<Option<_>>()?;
    if let Err(refusal) = entry.with(given(&parameters)) {
        return table.fail(refusal.parameter, refusal.message, refusal.remedy);
    }
    Some(parameters)
}

/// The keys that nobody asked for, numbers and lists of numbers; which there are is the business of a law that is not in the catalogue.
pub(crate) fn parameters(table: &Table<'_>) -> Option<BTreeMap<String, Parameter>> {
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
pub(crate) fn poisson(node: &Node<'_>) -> Option<f64> {
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
