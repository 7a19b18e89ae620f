//! Replacement of [`super::contact`] where no contact method is built in.

/// Reports each contact.
pub(super) fn contacts(
    scene: &crate::scene::Scene,
    _: &[super::Placed],
    _: &super::OwnLaws,
    _: &super::tie::Ties,
    _: &super::phase::Phases,
    _: &mut crate::solver::Model,
    problems: &mut super::Problems<'_>,
    _: &mut Vec<String>,
) -> Vec<super::ContactPlan> {
    for (c, item) in scene.contacts.iter().enumerate() {
        let message = format!("this build of Stoss has no contact method `{}`", item.method);
        let remedy = "build it with the cargo features `nts` and `mortar`";
        problems.add(format!("contact[{c}].method"), item.method.name, message, remedy);
    }
    Vec::new()
}
