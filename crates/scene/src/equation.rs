//! `[[equation]]`: linear equations between displacements, multi-point constraints.

use crate::read::{Node, Table, Value};
use crate::world::{World, action_name, part_name, raw, set_reference};
use crate::{Component, Series, split_set};
use std::collections::BTreeSet;
use stoss_scene_derive::table;
use toml::de::DeValue;

/// `[[equation]]`: a linear equation between displacements, `sum factor * displacement = value`, at all times. If sets of several nodes are among its terms there is an equation for each node: nodes of
/// different sets belong together that are at the same place relative to the centre of their set.
///
/// ```toml
/// [[equation]]
/// name = "lever"
/// terms = [
///   { set = "left.end", component = "x" },
///   { set = "right.end", component = "x", factor = -2.0 },
/// ]
/// ```
#[table(context(World<'_>))]
pub struct Equation {
    /// Name, unique as that of a joint.
    #[key(example = "\"lever\"", read = action_name)]
    pub name: String,
    /// The terms of the sum, at least one.
    #[key(
        example = "[{ set = \"cell.right\", component = \"x\" }, { set = \"cell.left\", component = \"x\", factor = -1.0 }]",
        with = terms
    )]
    pub terms: Vec<EquationTerm>,
    /// Value of the sum (length, times the factors), a constant or a table over time; 0 if left out.
    #[key(default = Series::Scalar(0.0), dimension = Length, read = |node| Series::of(node, 1))]
    pub value: Series,
}

impl Equation {
    /// Whether its value changes with time.
    pub fn moves(&self) -> bool {
        self.value.rows().windows(2).any(|pair| pair[0].get(1) != pair[1].get(1))
    }
}

/// A term of an equation: factor times displacement of nodes along a direction.
#[table(example = "{ set = \"cell.right\", component = \"x\" }", context(World<'_>), check = term)]
pub struct EquationTerm {
    /// Set of nodes, `part.set`; of a rigid body without a surface, and of a point mass, `part.all` is its point. This or `body` and `point`.
    #[key(by = set_reference)]
    pub set: Option<String>,
    /// Name of a part, with `point`.
    #[key(by = part_name)]
    pub body: Option<String>,
    /// A point in the reference configuration after placement (three lengths): the nearest node of `body`, of a rigid body the point itself.
    #[key(dimension = Length)]
    pub point: Option<[f64; 3]>,
    /// Component of the displacement; this or `direction`.
    pub component: Option<Component>,
    /// Direction of the displacement, of any length: its component along the unit vector is taken.
    #[key(dimension = Number, direction)]
    pub direction: Option<[f64; 3]>,
    /// Factor, not zero; 1 if left out.
    #[key(default = 1.0, dimension = Number, not_zero)]
    pub factor: f64,
    /// `true`: the mean displacement of the nodes of the set, by area where it has facets, is one term. `false` if left out.
    #[key(default, skip)]
    pub mean: bool,
}

impl EquationTerm {
    /// Factors of the three components.
    pub fn factors(&self) -> [f64; 3] {
        let direction = match (self.direction, self.component) {
            (Some(d), _) => {
                let largest = d.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
                let d = d.map(|x| x / largest);
                let size = d.iter().map(|x| x * x).sum::<f64>().sqrt();
                d.map(|x| x / size)
            }
            (None, Some(component)) => std::array::from_fn(|i| f64::from(u8::from(i == component.index()))),
            (None, None) => [0.0; 3],
        };
        direction.map(|d| self.factor * d)
    }
}

fn terms(node: &Node<'_>, world: &World<'_>, _: &EquationKeys) -> Option<Vec<EquationTerm>> {
    let terms = node.list(|n| EquationTerm::read(n, world))?;
    if terms.is_empty() {
        return node.fail("has no term", "write for instance terms = [{ set = \"cell.right\", component = \"x\" }]");
    }
    Some(terms)
}

fn term(_: &EquationTermKeys, table: &Table<'_>, _: &World<'_>) -> Option<()> {
    let place = match ["set", "body", "point"].map(|key| table.has(key)) {
        [true, false, false] | [false, true, true] => Some(()),
        [true, true, _] => table.fail("body", "the set names its body already", "remove it"),
        [true, false, true] => table.fail("point", "a term has either a set or a point", "remove one of them"),
        [false, true, false] => table.missing("point", "point = [0.0, 0.0, 0.0]"),
        [false, false, true] => table.missing("body", "body = \"plate\""),
        [false, false, false] => table.missing("set", "set = \"cell.right\""),
    };
    let along = match (table.has("component"), table.has("direction")) {
        (true, true) => table.fail("direction", "`component` is given too", "remove one of them"),
        (false, false) => table.missing("component", "component = \"x\""),
        _ => Some(()),
    };
    if table.has("mean") && table.has("point") {
        return table.fail("mean", "is for sets, and the term has a point", "remove it");
    }
    place.and(along)
}

/// Names of the parts that equations, couplings and prescribed motions of sets move, which therefore need no mass.
pub(crate) fn moved(
    equations: &[Option<Table<'_>>],
    couplings: &[Option<Table<'_>>],
    prescriptions: &[Option<Table<'_>>],
) -> BTreeSet<String> {
    let mut names: BTreeSet<String> = couplings.iter().flatten().filter_map(|table| raw(table, "rigid")).collect();
    let sets = prescriptions.iter().flatten().filter_map(|table| raw(table, "set"));
    names.extend(sets.filter_map(|set| split_set(&set).map(|(part, _)| part.to_owned())));
    for terms in equations.iter().flatten().filter_map(|table| table.get("terms")) {
        let DeValue::Array(terms) = terms.value else { continue };
        for term in terms {
            let DeValue::Table(term) = term.get_ref() else { continue };
            let of = |key: &str| match term.get(key).map(|value| value.get_ref()) {
                Some(DeValue::String(text)) => Some(text.to_string()),
                _ => None,
            };
            names.extend(of("body"));
            names.extend(of("set").and_then(|set| split_set(&set).map(|(part, _)| part.to_owned())));
        }
    }
    names
}
