//! What contacts, supports and loads need of the deck, and where they write.

use stoss_mesh_io::deck::{Deck, DeckPlace, Target};

use crate::axes::LocalAxes;
use crate::bodies::Bodies;
use crate::history::amplitude;
use crate::left_out::List;
use crate::references::References;
use crate::section::PlaneSection;
use crate::set_names::SetNames;
use crate::sets::{Lookup, Selection};
use crate::severity::Severity;
use crate::timeline::Timeline;
use crate::write::Tables;

/// The deck as it was understood so far, and the scene that is made.
pub(crate) struct Context<'a> {
    pub deck: &'a Deck,
    pub bodies: &'a Bodies,
    pub lookup: &'a Lookup<'a>,
    pub timeline: &'a Timeline,
    pub section: Option<PlaneSection>,
    pub axes: &'a LocalAxes,
    pub references: References,
    pub sets: SetNames<'a>,
    pub scene: Tables,
    pub list: List,
}

impl Context<'_> {
    /// Number of the nodes that a line of the deck names which belong to no body; `found` are those that belong to an element.
    pub fn nodes_outside(&self, found: &Selection<u32>, target: &Target) -> usize {
        let all = if let Target::Set(name) = target { self.lookup.node_set_size(name) } else { found.members.len() };
        let own = found.members.iter().filter(|node| self.bodies.owner(**node).is_some()).count();
        all.saturating_sub(own + self.references.of(target).len())
    }

    /// The number of the amplitude of a line, none if the line names none. Nothing, with an entry, if it names one that was not read.
    pub fn amplitude(
        &mut self,
        name: Option<&String>,
        keyword: &str,
        place: DeckPlace,
        consequence: &str,
    ) -> Option<Option<usize>> {
        let Some(name) = name else { return Some(None) };
        let found = amplitude(self.deck, name);
        if found.is_none() {
            let consequence = format!("there is no amplitude {name} that can be read: {consequence}");
            self.list.add(Severity::Missing, place, keyword, consequence, "define it by a table of times and values");
        }
        found.map(Some)
    }
}
