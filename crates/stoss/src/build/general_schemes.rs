//! Whether schemes carry general contact, and warnings where bodies have no contact at all.

use super::{Placed, Problems, general_contact};
use crate::scene::{Integrator, Scene, split_set};
use std::collections::{BTreeMap, BTreeSet};
use stoss_integrators::{SCHEMES, SchemeEntry};
use stoss_mesh::BOUNDARY;

/// Refuses schemes, of the scene and of its stages, that do not carry general contact, and warns where several bodies have none.
pub(super) fn check(scene: &Scene, placed: &[Placed], problems: &mut Problems<'_>, warnings: &mut Vec<String>) {
    let of_stages = scene.stages.iter().enumerate();
    let of_stages =
        of_stages.filter_map(|(s, stage)| Some((format!("stage[{s}].integrator.scheme"), stage.integrator.as_ref()?)));
    let own = scene.time.integrator.iter().map(|integrator| ("time.integrator.scheme".to_owned(), integrator));
    let mut unable = own.chain(of_stages).filter(|(_, integrator)| !integrator.carries_general_contact());
    if general_contact(scene).is_some() {
        for (key, Integrator { scheme, .. }) in unable {
            let message = "does not support general contact: contact forces from the middle or the start of a step do not keep surfaces apart";
            problems.add(key, scheme, message, format!("choose one of {}, or name pairs with [[contact]]", able()));
        }
    } else if scene.contacts.is_empty() && scene.general_contact.as_ref().is_none_or(|table| table.enabled) {
        let Some([a, b]) = free_pair(scene, placed) else { return };
        let reason = match unable.next() {
            Some((_, Integrator { scheme, .. })) => {
                format!("`{scheme}` does not support general contact; choose one of {}", able())
            }
            None => "this build of Stoss has no general contact; build it with the cargo feature `general`".to_owned(),
        };
        warnings.push(format!(
            "`{a}` and `{b}` have no contact and pass through each other: no [[contact]] names them, and {reason}, name pairs, or set `[general_contact] enabled = false` if this is meant"
        ));
    }
}

/// Schemes that carry general contact.
fn able() -> String {
    let able = |entry: &&SchemeEntry| entry.with([]).is_ok_and(|scheme| scheme.rule(1.0).carries_barriers());
    SCHEMES.iter().filter(able).map(|entry| entry.name).collect::<Vec<_>>().join(", ")
}

/// Two parts with surfaces, one of them deformable, that nothing connects.
fn free_pair<'a>(scene: &Scene, placed: &'a [Placed]) -> Option<[&'a str; 2]> {
    let ties = scene.ties.iter().map(|tie| sorted([owner(&tie.slave), owner(&tie.master)]));
    let connected = connected(scene).into_iter().filter(|(_, bond)| *bond != Bond::Ends).map(|(pair, _)| pair);
    let connected: BTreeSet<[&str; 2]> = connected.chain(ties).collect();
    let has_surface = |part: &&Placed| part.facets_of(BOUNDARY).is_ok_and(|facets| !facets.is_empty());
    let parts: Vec<&Placed> = placed.iter().filter(has_surface).collect();
    parts.iter().enumerate().find_map(|(k, a)| {
        let is_free = |b: &&&Placed| {
            (a.mesh().is_some() || b.mesh().is_some()) && !connected.contains(&sorted([&a.name, &b.name]))
        };
        parts[k + 1..].iter().find(is_free).map(|b| [&a.name[..], &b.name[..]])
    })
}

/// Bond of two parts by joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Bond {
    /// Joints all of which are released by an event, or switched off in a stage.
    Ends,
    /// The halves of a bolt.
    Bolt,
    /// Joints for the whole run.
    Lasts,
}

/// Pairs of parts that joints connect, in alphabetic order.
pub(super) fn connected(scene: &Scene) -> BTreeMap<[&str; 2], Bond> {
    let mut pairs = BTreeMap::new();
    for joint in &scene.joints {
        let is_released = scene.events.iter().any(|event| event.release == joint.name);
        let bond = match &joint.pretension {
            Some(_) => Bond::Bolt,
            None if is_released || scene.stages.iter().any(|stage| stage.off.contains(&joint.name)) => Bond::Ends,
            None => Bond::Lasts,
        };
        let known = pairs.entry(sorted(joint.between.each_ref().map(|side| owner(side)))).or_insert(bond);
        *known = bond.max(*known);
    }
    pairs
}

/// Whether general contact keeps two parts apart.
#[cfg(any(test, feature = "output"))]
pub(crate) fn keeps_apart(scene: &Scene, [a, b]: [&str; 2]) -> bool {
    let Some(table) = general_contact(scene) else { return false };
    let takes_part = |part: &str| {
        let is_included = table.include.is_empty() || table.include.iter().any(|set| owner(set) == part);
        is_included && !table.exclude.iter().any(|set| set == part)
    };
    let is_named = table.pairs.iter().any(|pair| sorted([&pair.between[0], &pair.between[1]]) == sorted([a, b]));
    let is_connected = || connected(scene).get(&sorted([a, b])).is_some_and(|bond| *bond != Bond::Ends);
    takes_part(a) && takes_part(b) && (is_named || !is_connected())
}

/// Two names in alphabetic order.
pub(super) fn sorted([a, b]: [&str; 2]) -> [&str; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// The part of a set, or the name itself.
pub(super) fn owner(set: &str) -> &str {
    split_set(set).map_or(set, |(part, _)| part)
}

#[cfg(feature = "general")]
#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;

    #[test]
    fn who_is_kept_apart() {
        let body = |name: &str| {
            format!(
                "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }}\n\
                 material = {{ law = \"neo-hooke\", young = 1, poisson = 0.3 }}\n"
            )
        };
        let head = "[scene]\ntitle = \"t\"\nkind = \"quasi-static\"\n[time]\nend = 1\nstep = 1\n";
        let between = |more: &str| {
            let text = format!("{head}{}{}{more}", body("a"), body("b"));
            let scene = parse(&text, "t.toml").unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(keeps_apart(&scene, ["a", "b"]), keeps_apart(&scene, ["b", "a"]));
            keeps_apart(&scene, ["a", "b"])
        };
        let joint = "[[joint]]\nname = \"j\"\nkind = \"ball\"\nbetween = [\"a.all\", \"b.all\"]\nat = [0, 0, 0]\n";
        for (more, acts) in [
            ("", true),
            ("[general_contact]\nenabled = false\n", false),
            ("[general_contact]\nexclude = [\"b\"]\n", false),
            ("[general_contact]\nexclude = [\"b.top\"]\n", true),
            ("[general_contact]\ninclude = [\"a\"]\n", false),
            ("[general_contact]\ninclude = [\"a\", \"b.top\"]\n", true),
            (joint, false),
            (&format!("{joint}[[event]]\nname = \"e\"\nrelease = \"j\"\ntime = 0.5\n"), true),
        ] {
            assert_eq!(between(more), acts, "{more}");
        }
        assert!(between(&format!("{joint}[general_contact]\npairs = [{{ between = [\"b\", \"a\"] }}]\n")));
    }
}
