//! Reads what a material has beside its elastic law.

use super::node::Node;
use super::table::Table;
use crate::material::Inelasticity;
use crate::{Fibres, Moduli, Mullins, Plasticity, Rate};

/// The keys of a material that give it a history; whether the law takes them is asked later.
pub(super) fn inelasticity(table: &Table<'_>) -> Option<Inelasticity> {
    let plasticity = table.optional("plasticity", plasticity);
    let prony = table.default("prony", Vec::new(), |n| n.list(|pair| pair.array(Node::positive)));
    let moduli = table.optional("moduli", |n| n.choice(Moduli::NAMES, Moduli::from_name));
    let mullins = table.optional("mullins", mullins);
    let fibres = table.optional("fibres", fibres);
    let (prony, moduli) = (prony?, moduli?);
    if moduli.is_some() && prony.is_empty() {
        return table.fail("moduli", "has no effect without `prony`", "remove it, or add prony = [[0.3, 0.01]]");
    }
    Some(Inelasticity { plasticity: plasticity?, prony, moduli, mullins: mullins?, fibres: fibres? })
}

fn plasticity(node: &Node<'_>) -> Option<Plasticity> {
    let table = node.table_like("{ yield_stress = 400.0, hardening_modulus = 100.0 }")?;
    let yield_stress = table.optional("yield_stress", Node::positive);
    let hardening = table.default("hardening", Vec::new(), |n| n.list(|pair| pair.array(Node::number)));
    let hardening_modulus = table.default("hardening_modulus", 0.0, Node::number);
    let saturation_stress = table.optional("saturation_stress", Node::positive);
    let saturation_rate = table.optional("saturation_rate", Node::positive);
    let kinematic_modulus = table.default("kinematic_modulus", 0.0, Node::not_negative);
    let rate = table.optional("rate", rate);
    table.finish();
    let found = Plasticity {
        yield_stress: yield_stress?,
        hardening: hardening?,
        hardening_modulus: hardening_modulus?,
        saturation_stress: saturation_stress?,
        saturation_rate: saturation_rate?,
        kinematic_modulus: kinematic_modulus?,
        rate: rate?,
    };
    match found.misfit() {
        Some([key, message, remedy]) => table.fail(key, message, remedy),
        None => Some(found),
    }
}

fn rate(node: &Node<'_>) -> Option<Rate> {
    let table = node.table_like("{ stress = 200.0, rate = 1e4, exponent = 0.3 }")?;
    let stress = table.required("stress", "stress = 200.0", Node::positive);
    let rate = table.required("rate", "rate = 1e4", Node::positive);
    let exponent = table.required("exponent", "exponent = 0.3", Node::positive);
    table.finish();
    Some(Rate { stress: stress?, rate: rate?, exponent: exponent? })
}

fn mullins(node: &Node<'_>) -> Option<Mullins> {
    let table = node.table_like("{ r = 1.5, m = 0.3 }")?;
    let r = table.required("r", "r = 1.5", Node::positive);
    let m = table.required("m", "m = 0.3", Node::positive);
    let beta = table.default("beta", 0.0, Node::not_negative);
    table.finish();
    Some(Mullins { r: r?, m: m?, beta: beta? })
}

fn fibres(node: &Node<'_>) -> Option<Fibres> {
    let table = node.table_like("{ k1 = 1.0, k2 = 10.0, direction = [1, 0, 0] }")?;
    let k1 = table.required("k1", "k1 = 1.0", Node::positive);
    let k2 = table.required("k2", "k2 = 10.0", Node::positive);
    let dispersion = table.default("dispersion", 0.0, |n| match n.number()? {
        value if (0.0..=1.0 / 3.0).contains(&value) => Some(value),
        _ => n.fail("must be from 0 to 1/3", "choose 0 for fibres that do not scatter"),
    });
    let direction = table.optional("direction", Node::direction);
    let field = table.default("field", Vec::new(), |n| n.list(Node::text));
    let axis = table.optional("axis", Node::direction);
    let point = table.optional("point", Node::vector);
    let angle = table.optional("angle", |n| match n.number()? {
        value if (0.0..=90.0).contains(&value) => Some(value),
        _ => n.fail("must be from 0 to 90 degrees", "0 is around the axis, 90 along it"),
    });
    table.finish();
    let found = Fibres {
        k1: k1?,
        k2: k2?,
        dispersion: dispersion?,
        direction: direction?,
        field: field?,
        axis: axis?,
        point: point?,
        angle: angle?,
    };
    match found.misfit() {
        Some([key, message, remedy]) => table.fail(key, message, remedy),
        None => Some(found),
    }
}
