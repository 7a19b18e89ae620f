//! Decks of plane elements: what they are sections of, and how their forces are counted.

use crate::left_out::List;
use crate::severity::Severity;
use stoss_mesh_io::Solids;
use stoss_mesh_io::deck::Deck;

/// What the plane elements of a deck are a section of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlaneSection {
    /// Value of `section` in a scene.
    pub name: &'static str,
    /// What a force of the deck is divided by: it acts around the whole circumference, or over the thickness of `*SOLID SECTION`.
    pub extent: f64,
}

/// The families of plane elements.
const FAMILIES: [(&str, &str); 3] = [("CAX", "axisymmetric"), ("CPE", "plane-strain"), ("CPS", "plane-stress")];

impl PlaneSection {
    /// The section of a deck of plane elements; nothing of solid ones. Several families or thicknesses in one deck are an entry.
    pub fn of(deck: &Deck, solids: &Solids, list: &mut List) -> Option<Self> {
        if !deck.contents.is_plane() {
            return None;
        }
        let has = |family: &str| solids.element_types.iter().any(|name| name.starts_with(family));
        let families: Vec<_> = FAMILIES.into_iter().filter(|(family, _)| has(family)).collect();
        let (family, name) = *families.first()?;
        let place = deck.sections.first()?.place;
        if families.len() > 1 {
            let text = format!("all plane elements are {family}: a scene is one kind of section");
            list.add(Severity::Missing, place, "*ELEMENT", text, "make scenes of their own");
        }
        let thicknesses: Vec<f64> = deck.sections.iter().map(|section| section.thickness.unwrap_or(1.0)).collect();
        let thickness = thicknesses[0];
        if name == "axisymmetric" {
            return Some(Self { name, extent: std::f64::consts::TAU });
        }
        if thicknesses.iter().any(|other| *other != thickness) {
            let text = format!("all sections have the thickness {thickness}");
            list.add(
                Severity::Missing,
                place,
                "*SOLID SECTION",
                text,
                "scale the moduli of the others by the quotient of the thicknesses",
            );
        }
        Some(Self { name, extent: thickness })
    }
}
