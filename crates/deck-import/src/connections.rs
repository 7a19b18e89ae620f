//! `*SPRING`, `*DASHPOT` and `*MASS` to `[[spring]]`, `[[support]]` and `[[mass]]`.

use std::collections::BTreeSet;

use stoss_mesh_io::deck::{Connection, ConnectionSection};

use crate::context::Context;
use crate::references::{End, Role};
use crate::severity::Severity;
use crate::text::{number, string, vector};

/// Adds all springs, dashpots and masses.
pub(crate) fn connections(context: &mut Context<'_>) {
    let deck = context.deck;
    let mut handled = BTreeSet::new();
    for section in &deck.sections_of_connections {
        let is_own = |c: &&Connection| c.set.as_ref().is_some_and(|set| set.eq_ignore_ascii_case(&section.elements));
        let own: Vec<&Connection> = deck.connections.iter().filter(is_own).collect();
        let mut left_out = own.is_empty();
        for connection in own {
            handled.insert(connection.kind.clone());
            left_out |= context.connection(connection, section).is_none();
        }
        if left_out {
            let consequence = "some of its elements are not in the scene";
            let remedy = "see [[spring]], [[support]] and [[mass]]";
            context.list.add(Severity::Missing, section.place, section.keyword, consequence, remedy);
        }
    }
    // The reference nodes of *DISTRIBUTING COUPLING, and beams that are nothing but a pretension, were told with them.
    let pretensions: BTreeSet<u64> = deck.pretensions.iter().filter_map(|item| item.element).collect();
    let is_cut = |c: &&Connection| matches!(c.kind.as_str(), "B31" | "T3D2");
    if deck.connections.iter().filter(is_cut).all(|c| pretensions.contains(&c.number)) {
        handled.extend(["B31".to_owned(), "T3D2".to_owned()]);
    }
    handled.insert("DCOUP3D".to_owned());
    context.list.handled_elements = handled;
}

impl Context<'_> {
    /// Maps a connection of a section; `None` if it does not map.
    fn connection(&mut self, item: &Connection, section: &ConnectionSection) -> Option<()> {
        let ends: Vec<End> =
            item.nodes.iter().map(|&node| self.references.end(node, self.bodies)).collect::<Option<_>>()?;
        match (item.kind.as_str(), &ends[..]) {
            ("SPRINGA", &[a, b]) => self.spring([a, b], section.value, 0.0),
            ("DASHPOTA", &[a, b]) => self.spring([a, b], 0.0, section.value),
            ("SPRING1", &[a]) => self.ground(a, section, "stiffness"),
            ("DASHPOT1", &[a]) => self.ground(a, section, "damping"),
            ("MASS", &[a]) => self.mass(a, section.value),
            _ => None,
        }
    }

    /// Along the line between the nodes.
    fn spring(&mut self, ends: [End; 2], stiffness: f64, damping: f64) -> Option<()> {
        let places = ends.map(|end| self.references.place(end));
        if places[0] == places[1] {
            return None;
        }
        let sides = ends.map(|end| string(&self.side_of(end)));
        let at = places.map(vector).join(", ");
        let mut keys = format!("between = [{}]\nat = [{at}]\nstiffness = {}\n", sides.join(", "), number(stiffness));
        if damping != 0.0 {
            keys += &format!("damping = {}\n", number(damping));
        }
        self.scene.spring(&keys);
        Some(())
    }

    /// Adds a support between a degree of freedom of a node and the ground.
    fn ground(&mut self, end: End, section: &ConnectionSection, key: &str) -> Option<()> {
        let (End::Solid(_, node), &[freedom @ 0..3]) = (end, &section.freedoms[..]) else { return None };
        if self.axes.has(node) {
            return None;
        }
        let set = string(&self.set_of(end));
        let mut values = [0.0; 3];
        values[freedom] = section.value;
        self.scene.support(&format!("set = {set}\nper = \"node\"\n{key} = {}\n", vector(values)));
        Some(())
    }

    fn mass(&mut self, end: End, mass: f64) -> Option<()> {
        if mass == 0.0 {
            return Some(());
        }
        match end {
            End::Reference(r) if self.references.all[r].role == Role::Point => {
                self.references.all[r].mass += mass;
                self.references.all[r].is_used = [true; 3];
            }
            End::Reference(_) => return None,
            End::Solid(..) => {
                let at = self.references.place(end);
                let side = string(&self.set_of(end));
                let name = self.references.make_mass("mass", at, mass);
                self.scene.joint("ball", &format!("between = [{side}, {}]\nat = {}\n", string(&name), vector(at)), &[]);
            }
        }
        Some(())
    }
}
