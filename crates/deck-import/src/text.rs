//! Values and words as text.

use stoss_mesh_io::deck::Target;

/// A finite number in TOML, with all its digits.
pub(crate) fn number(value: f64) -> String {
    // Zero has no sign here.
    if value == 0.0 { "0.0".to_owned() } else { format!("{value:?}") }
}

/// A number of things.
pub(crate) fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

/// A list of numbers.
pub(crate) fn list(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().copied().map(number).collect();
    format!("[{}]", values.join(", "))
}

pub(crate) fn vector(values: [f64; 3]) -> String {
    list(&values)
}

/// A string in TOML.
pub(crate) fn string(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// A line of a comment: control characters would end it, or be an error.
pub(crate) fn comment(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// What a line of the deck names, for people.
pub(crate) fn text(target: &Target) -> String {
    match target {
        Target::All => "the model".to_owned(),
        Target::Set(name) => name.clone(),
        Target::Number { number, instance: None } => format!("number {number}"),
        Target::Number { number, instance: Some(instance) } => format!("number {number} of {instance}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_the_deck_cannot_break_the_scene() {
        assert_eq!(comment("a\nb\u{1b}"), "a b ");
        for text in ["plain", "it's \"quoted\"", "back\\slash", "tab\tand\u{7f}", "ünïcode"] {
            let table: toml::Table = format!("a = {}", string(text)).parse().unwrap();
            assert_eq!(table["a"].as_str(), Some(text));
        }
        assert_eq!(
            (number(-0.0), number(1e-20), number(2.0)),
            ("0.0".to_owned(), "1e-20".to_owned(), "2.0".to_owned())
        );
    }
}
