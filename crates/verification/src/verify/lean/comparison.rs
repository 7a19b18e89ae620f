//! Items that a scene asks for against those that its run has.

/// Nothing of a kernel is called.
pub const NONE: &str = "none";

/// An item by name with its value.
pub type Item = (&'static str, String);

/// Items that are there or not.
pub fn flags(flags: &[(&'static str, bool)]) -> Vec<Item> {
    flags.iter().map(|&(name, flag)| (name, if flag { String::new() } else { NONE.to_owned() })).collect()
}

/// A group of items compared: in words what there is, and every deviation.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Number of items compared.
    pub items: usize,
    /// What was found.
    pub words: String,
    /// Items that are there unasked, or asked for and not there.
    pub deviations: Vec<String>,
}

/// Compares item by item.
pub fn compare(asked: &[Item], found: &[Item]) -> Comparison {
    let mut words = Vec::new();
    let mut deviations = Vec::new();
    for ((name, asked), (_, found)) in asked.iter().zip(found) {
        if found != NONE {
            words.push(format!("{name} {found}").trim_end().to_owned());
        }
        match (asked.as_str(), found.as_str()) {
            _ if asked == found => {}
            (NONE, _) => deviations.push(format!("unused: {name} {found}").trim_end().to_owned()),
            (_, NONE) => deviations.push(format!("missing: {name} {asked}").trim_end().to_owned()),
            _ => deviations.push(format!("{name} {found} instead of {asked}")),
        }
    }
    Comparison { items: asked.len(), words: words.join(", "), deviations }
}
