//! The contact methods as rows of what builds them; what a scene can say of each is in the rows of the same names of `stoss_scene::METHODS`.

use super::pair::PairInput;
use super::{ContactPlan, Problems};
use crate::scene::ContactMethod;
use crate::solver::Model;

/// Adds the contact to the model; reports what is wrong and warns.
type Build = fn(&PairInput<'_>, &mut Model, &mut Problems<'_>, &mut Vec<String>) -> Option<ContactPlan>;

/// A row: a method with its cargo feature.
struct Builder {
    name: &'static str,
    feature: &'static str,
    /// Function that builds the contact; none where the feature is not built in.
    build: Option<Build>,
}

const BUILDERS: &[Builder] = &[
    Builder {
        name: "nts",
        feature: "nts",
        #[cfg(feature = "nts")]
        build: Some(super::nts::contact),
        #[cfg(not(feature = "nts"))]
        build: None,
    },
    Builder {
        name: "cat",
        feature: "nts",
        #[cfg(feature = "nts")]
        build: Some(super::nts::augmented),
        #[cfg(not(feature = "nts"))]
        build: None,
    },
    Builder {
        name: "mortar",
        feature: "mortar",
        #[cfg(feature = "mortar")]
        build: Some(super::mortar::contact),
        #[cfg(not(feature = "mortar"))]
        build: None,
    },
];

/// What builds a method; reports, at this key of the contact, one that is not built in.
pub(super) fn builder(method: ContactMethod, key: &str, problems: &mut Problems<'_>) -> Option<Build> {
    let row = BUILDERS.iter().find(|row| row.name == method.name);
    if let Some(build) = row.and_then(|row| row.build) {
        return Some(build);
    }
    let message = format!("this build of Stoss has no contact method `{method}`");
    let feature = row.map_or(method.name, |row| row.feature);
    problems.add(format!("{key}.method"), method.name, message, format!("build it with the cargo feature `{feature}`"));
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_scene_can_choose_can_be_built() {
        let names: Vec<&str> = BUILDERS.iter().map(|row| row.name).collect();
        assert_eq!(names, ContactMethod::names());
    }
}
