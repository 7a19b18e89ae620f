//! Why runs of the maps end with an error, or with the verdict wrong. `docs/guide/limits.md` says the same with the region.

use super::cell::Record;

/// See the page.
const PULLED: &str = "a flat block that is pulled and that only general contact carries, where no node lies above an edge of the other mesh: the cause is not found; name the contact";

/// Map (empty: any), a part of the axis, what the error or the findings contain, and the explanation.
const REASONS: [(&str, &str, &str, &str); 9] = [
    (
        "general",
        "overlap",
        "overlap at the start",
        "refused from a millionth of the size on: `initial = \"separate\"`, or a named contact",
    ),
    (
        "",
        "statics: overlap",
        "penetration",
        "bodies that begin half an edge inside each other are reported, whatever comes of them",
    ),
    (
        "",
        "impact: overlap",
        "",
        "an overlap of a tenth of an edge and more that is closed in one step of dynamics gives energy: close it in a static stage",
    ),
    (
        "general",
        "statics: stiffer",
        "singular",
        "a stiffness ratio above 1e6 under loads alone: the layer is too soft beside the stiff body before surfaces are pressed",
    ),
    ("general", "statics: friction", "singular", PULLED),
    ("general", "statics: units", "singular", PULLED),
    (
        "",
        "flight: step",
        "",
        "a scheme that does not keep the energy, ten crossings of an element a step and more: `energy-momentum`",
    ),
    (
        "",
        "flight: Poisson's ratio",
        "energy-gain",
        "changes of volume that the step does not resolve: `energy-momentum`",
    ),
    (
        "cells",
        "slenderness",
        "singular",
        "the matrix has a condition above 1e13: eight quadratic elements over 1000 heights; take beams, or more elements along",
    ),
];

/// The explanation of a run that ended with an error, or with the verdict wrong.
pub fn of(record: &Record) -> Option<&'static str> {
    let [map, axis, _] = &record.key;
    let fits = |(of_map, of_axis, sign, _): &&(&str, &str, &str, &str)| {
        (of_map.is_empty() || of_map == map)
            && axis.contains(of_axis)
            && (record.error.contains(sign) || record.findings.contains(sign))
    };
    REASONS.iter().find(fits).map(|(.., why)| *why)
}
