//! Scenes for unit tests.

/// The ball on the plate of the format's description.
pub(crate) fn dynamic() -> String {
    include_str!("../tests/data/dynamic.toml").to_owned()
}
