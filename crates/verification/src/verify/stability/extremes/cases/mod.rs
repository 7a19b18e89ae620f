//! The cases, grouped by what is extreme about them.

mod closed_forms;
mod contrast;
mod features;
mod friction;
mod impact;
mod mortar;
mod shape;
mod solids;
mod spin;
mod steps;
mod units;

use super::case::Case;

/// Families of which quick mode runs the first combination.
const REPRESENTATIVE: &[&str] = &[
    "tension, nu 0.49999",
    "flight, nu 0.49999",
    "stiffness 1e6, soft slave",
    "density 1e6, light slave",
    "gap 1e-9",
    "gap 0",
    "impact at 1 wave speed",
    "impact at 10 wave speeds",
    "distorted elements",
    "contact of flat elements",
    "jump over gap and master",
    "vertex, edges and diagonal at once",
    "cube's vertex on an edge",
    "thesis' step times 1e-6",
    "inverting follower pressure",
    "friction, coefficient",
    "friction, stiffness",
    "slide over facets in a step",
    "mortar: slide over facets in a step",
    "stick and slip in turn at each step",
    "mortar: off an edge and back on",
    "mortar: corner to corner",
    "mortar: warped facets",
];

/// Every combination.
pub fn all() -> Vec<Case> {
    [
        solids::cases(),
        shape::cases(),
        spin::cases(),
        contrast::cases(),
        impact::cases(),
        features::cases(),
        units::cases(),
        steps::cases(),
        friction::cases(),
        mortar::cases(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The first combination of every representative family.
pub fn representative() -> Vec<Case> {
    let mut seen = Vec::new();
    let mut cases = all();
    cases.retain(|case| {
        let first = REPRESENTATIVE.contains(&case.family.as_str()) && !seen.contains(&case.family);
        seen.push(case.family.clone());
        first
    });
    cases
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn combinations_are_different_and_enough() {
        let cases = all();
        let slugs: BTreeSet<String> = cases.iter().map(Case::slug).collect();
        assert_eq!(slugs.len(), cases.len());
        assert!(cases.len() >= 80, "{}", cases.len());
        assert_eq!(representative().len(), REPRESENTATIVE.len());
        for case in &cases {
            assert!(!case.combination.contains([',', '|']), "the document separates by these: {}", case.combination);
            assert!(case.scene.text().parse::<toml::Table>().is_ok(), "{}", case.scene.text());
        }
    }
}
