//! What bodies have in dynamics only: initial velocities (`*INITIAL CONDITIONS, TYPE=VELOCITY`) and damping (`*DAMPING`).

use std::collections::BTreeMap;

use stoss_mesh_io::deck::Deck;

use crate::bodies::Bodies;
use crate::left_out::List;
use crate::sets::Lookup;
use crate::severity::Severity;
use crate::timeline::Timeline;

/// The initial velocity of each body; zero if it has none.
pub(crate) fn velocities(
    deck: &Deck,
    bodies: &Bodies,
    lookup: &Lookup<'_>,
    timeline: &Timeline,
    list: &mut List,
) -> Vec<[f64; 3]> {
    let mut all = vec![[0.0; 3]; bodies.all.len()];
    let Some(first) = deck.velocities.first() else { return all };
    if !timeline.is_dynamic() {
        list.add(
            Severity::Note,
            first.place,
            "*INITIAL CONDITIONS, TYPE=VELOCITY",
            "there is no dynamic step: bodies begin at rest",
            "",
        );
        return all;
    }
    let mut of_node: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for line in &deck.velocities {
        for node in lookup.nodes(&line.nodes).members {
            of_node.entry(node).or_default()[line.component] = line.value;
        }
    }
    for (velocity, body) in all.iter_mut().zip(&bodies.all) {
        let mut own = body.nodes.iter().map(|node| of_node.get(node).copied().unwrap_or_default());
        let Some(uniform) = own.next() else { continue };
        if own.all(|other| other == uniform) {
            *velocity = uniform;
        } else {
            list.add(
                Severity::Missing,
                first.place,
                "*INITIAL CONDITIONS, TYPE=VELOCITY",
                format!("velocities of body {} are not all the same: it begins at rest", body.name),
                "give it `velocity`, `angular_velocity` and `velocity_gradient`",
            );
        }
    }
    all
}

/// Takes damping away where it cannot act, with an entry.
pub(crate) fn damping(deck: &Deck, bodies: &mut Bodies, timeline: &Timeline, list: &mut List) {
    for body in &mut bodies.all {
        let Some(damping) = body.damping else { continue };
        let place =
            deck.materials.iter().find(|material| material.name == body.material).map(|material| material.place);
        let (severity, reason) = if !timeline.is_dynamic() {
            (Severity::Note, "there is no dynamic step: it has no effect")
        } else if damping.alpha < 0.0 || damping.beta < 0.0 {
            (Severity::Changed, "ALPHA or BETA is negative: the body is not damped")
        } else {
            continue;
        };
        body.damping = None;
        if let Some(place) = place {
            list.add(severity, place, format!("*DAMPING of material {}", body.material), reason, "");
        }
    }
}
