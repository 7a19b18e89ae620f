//! Contact methods that are not built in.

use super::Problems;

/// Tells that the contact's method needs a cargo feature.
#[allow(dead_code, reason = "with all features every method is built in")]
pub(super) fn not_built_in(key: String, item: &crate::scene::Contact, problems: &mut Problems<'_>) {
    let name = item.method.name();
    let feature = if item.method == crate::scene::ContactMethod::Cat { "nts" } else { name };
    let message = format!("this build of Stoss has no contact method `{name}`");
    problems.add(format!("{key}.method"), name, message, format!("build it with the cargo feature `{feature}`"));
}

/// Stands for the contacts of a scene where no method is built in.
#[cfg(not(any(feature = "nts", feature = "mortar")))]
pub(super) fn contacts(
    scene: &crate::scene::Scene,
    _: &[super::Placed],
    _: &super::OwnLaws,
    _: &super::tie::Ties,
    _: &super::phase::Phases,
    _: &mut crate::solver::Model,
    problems: &mut Problems<'_>,
    _: &mut Vec<String>,
) -> Vec<super::ContactPlan> {
    for (c, item) in scene.contacts.iter().enumerate() {
        not_built_in(format!("contact[{c}]"), item, problems);
    }
    Vec::new()
}
