//! A scene in other units: every number times the factor of its dimension, which the schema of scenes tells (`x-dimension`).

use serde_json::Value as Schema;
use std::path::Path;
use stoss::scene::Dimension;
use toml::Value;

/// What one unit of length, mass and time becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    pub length: f64,
    pub mass: f64,
    pub time: f64,
}

impl Units {
    /// The units that scenes are written in.
    pub const SAME: Self = Self { length: 1.0, mass: 1.0, time: 1.0 };

    /// Factor on a number.
    pub fn factor(&self, dimension: Dimension) -> f64 {
        let [length, mass, time] = dimension.exponents();
        self.length.powi(length) * self.mass.powi(mass) * self.time.powi(time)
    }
}

/// The scene in other units. Every number has to be written as a number.
pub fn in_units(text: &str, units: Units) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scene.schema.json");
    let schema: Schema = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut scene = Value::Table(toml::from_str(text).unwrap());
    let scaling = Scaling { schema: &schema, units };
    scaling.visit(&mut scene, &schema, None, &Place::default());
    toml::to_string(&scene).unwrap()
}

/// What decides between two dimensions of a number.
#[derive(Clone, Copy, Default)]
struct Place {
    /// Whether it is of a joint that turns.
    turns: bool,
    /// Whether it is of a support per node, not per area.
    per_node: bool,
}

struct Scaling<'a> {
    schema: &'a Schema,
    units: Units,
}

impl<'a> Scaling<'a> {
    /// A schema without references, and its alternatives.
    fn alternatives(&self, schema: &'a Schema) -> Vec<&'a Schema> {
        let schema = match schema["$ref"].as_str() {
            Some(name) => &self.schema["$defs"][name.trim_start_matches("#/$defs/")],
            None => schema,
        };
        let lists = ["anyOf", "oneOf"].iter().filter_map(|key| schema[*key].as_array()).flatten();
        let inner = lists.flat_map(|alternative| self.alternatives(alternative));
        std::iter::once(schema).chain(inner).collect()
    }

    fn fits(&self, value: &Value, schema: &'a Schema) -> bool {
        self.alternatives(schema).iter().any(|schema| {
            let is = |name: &str| match &schema["type"] {
                Schema::String(one) => one == name,
                Schema::Array(several) => several.iter().any(|one| one == name),
                _ => false,
            };
            match value {
                Value::Table(table) => {
                    is("object") && table.iter().all(|(key, value)| self.fits(value, &schema["properties"][key]))
                }
                Value::Array(list) => is("array") && list.iter().all(|value| self.fits(value, &schema["items"])),
                Value::String(text) => schema["const"].as_str().map_or(is("string"), |word| word == text),
                Value::Boolean(_) => is("boolean"),
                _ => is("number") || is("integer"),
            }
        })
    }

    fn dimension(&self, of: &Schema, place: &Place) -> Option<Dimension> {
        let name = match of {
            Schema::Array(two) => {
                let per_area = two[0].as_str().is_some_and(|name| name.contains("length³"));
                &two[usize::from(if per_area { place.per_node } else { !place.turns })]
            }
            one => one,
        };
        name.as_str().and_then(Dimension::from_name)
    }

    /// `above` is the dimension of the table or list that the value is in.
    fn visit(&self, value: &mut Value, schema: &'a Schema, above: Option<Dimension>, place: &Place) {
        let dimension = self.dimension(&schema["x-dimension"], place).or(above);
        let times = |value: &mut Value, dimension: Dimension| {
            let number = value.as_float().or(value.as_integer().map(|n| n as f64)).unwrap();
            *value = Value::Float(number * self.units.factor(dimension));
        };
        let alternatives = self.alternatives(schema);
        let chosen = alternatives.iter().copied().filter(|schema| !schema["type"].is_null());
        match value {
            Value::Table(table) => {
                let properties = alternatives.iter().map(|schema| &schema["properties"]).find(|properties| {
                    table.iter().all(|(key, value)| !properties[key].is_null() && self.fits(value, &properties[key]))
                });
                let properties = properties.unwrap_or_else(|| panic!("no schema for {table:?}"));
                let mut place = *place;
                if let Some(kind) = table.get("kind").and_then(Value::as_str) {
                    place.turns = ["hinge", "cylindrical", "universal", "ball"].contains(&kind);
                }
                place.per_node |= table.get("per").and_then(Value::as_str) == Some("node");
                for (key, value) in table {
                    let property = &properties[key];
                    match (key.as_str(), value) {
                        ("table", Value::Array(rows)) => {
                            for row in rows {
                                for (column, value) in row.as_array_mut().unwrap().iter_mut().enumerate() {
                                    times(value, if column == 0 { Dimension::Time } else { dimension.unwrap() });
                                }
                            }
                        }
                        (_, value) => self.visit(value, property, dimension, &place),
                    }
                }
            }
            Value::Array(list) => {
                let items = chosen
                    .map(|schema| &schema["items"])
                    .find(|items| !items.is_null() && list.iter().all(|value| self.fits(value, items)));
                let items = items.unwrap_or_else(|| panic!("no schema for {list:?}"));
                list.iter_mut().for_each(|value| self.visit(value, items, dimension, place));
            }
            Value::Float(_) | Value::Integer(_) if alternatives.iter().any(|schema| schema["format"] == "double") => {
                times(value, dimension.unwrap_or_else(|| panic!("no dimension for {value}")));
            }
            _ => {}
        }
    }
}
