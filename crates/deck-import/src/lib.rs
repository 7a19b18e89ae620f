//! Scenes from Abaqus and CalculiX decks.
//!
//! [`import`] turns a [`Deck`] into the text of a scene (TOML), as far as the deck maps, and a list of everything that it leaves out: keyword, place, what
//! that changes and what to do. Nothing is left out without an entry. `docs/guide/meshes.md` has the table of keywords.
//!
//! | module | is |
//! |---|---|
//! | `sets` | names and numbers of the deck, looked up in the mesh |
//! | `bodies` | sections to bodies: one for each material and connected piece |
//! | `section` | plane elements |
//! | `material` | laws |
//! | `timeline`, `history` | steps to stages; what several steps say of one degree of freedom to one function of time |
//! | `axes` | those of `*TRANSFORM` at each node |
//! | `records` | which lines of the deck act on which node, facet or element |
//! | `set_names` | names of sets for these nodes and facets, new sets where the deck has none |
//! | `dynamics` | initial velocities and damping |
//! | `context` | what the next three share |
//! | `supports`, `loads`, `contacts` | the tables of the scene |
//! | `references` | nodes of no element: points and rigid bodies |
//! | `couplings`, `equations`, `connections` | what joins nodes to them and to each other |
//! | `cut` | bolts that are cut at a section of pretension |
//! | `reference_loads` | supports and loads of reference nodes |
//! | `left_out` | the list |
//! | `keywords` | what it means that a keyword is not read |
//! | `adjust` | nodes moved onto the master surface |
//! | `write`, `text` | the scene; TOML |
//!
//! # What it is not
//! No file is written and no scene is checked here: that is for the program, which has the scene's reader.
//!
#![doc = include_str!("../README.md")]

mod adjust;
mod axes;
mod bodies;
mod connections;
mod contacts;
mod context;
mod couplings;
mod cut;
mod dynamics;
mod equations;
mod history;
mod keywords;
mod left_out;
mod loads;
mod material;
mod records;
mod reference_loads;
mod references;
mod section;
mod set_names;
mod sets;
mod severity;
mod supports;
mod text;
mod timeline;
mod write;

pub use left_out::LeftOut;
pub use severity::Severity;

use stoss_mesh::Mesh;
use stoss_mesh_io::MeshIoError;
use stoss_mesh_io::deck::Deck;

/// The names of the files in the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileNames {
    /// The deck, relative to the folder of the scene.
    pub deck: String,
    /// The mesh that is written beside the scene if the sets of the deck do not suffice.
    pub mesh: String,
}

/// A scene made from a deck.
#[derive(Clone, Debug)]
pub struct Import {
    /// The scene (TOML), with what was mapped in comments at its head, and what was left out in tables `[[left_out]]`.
    pub scene: String,
    /// The mesh to be written under [`FileNames::mesh`]: that of the deck, with the sets that the deck has no name for, and with the nodes that `ADJUST` moves in
    /// their new places. None if the scene refers to the deck itself.
    pub mesh: Option<Mesh>,
    /// Things that were mapped, one line each.
    pub mapped: Vec<String>,
    /// What was left out, the worst first, then in the order of the deck; first what concerns no line of it.
    pub left_out: Vec<LeftOut>,
}

/// Why there is no scene.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The mesh cannot be used.
    #[error(transparent)]
    Mesh(#[from] MeshIoError),
    /// A deck of which no element has a material that maps.
    #[error("{file}: no element has an elastic material, so there is no body: {reasons}")]
    NoBody {
        /// The deck.
        file: String,
        /// What the sections and materials lack, with lines, and what to do.
        reasons: String,
    },
}

/// Makes a scene of a deck.
///
/// # Errors
/// [`ImportError`].
pub fn import(deck: &Deck, names: &FileNames) -> Result<Import, ImportError> {
    let mut solids = deck.contents.solids()?;
    // Elements of different kinds beside each other may become bodies that a tie joins; within a body the check of the scene reports them.
    match deck.contents.check_solids() {
        Err(MeshIoError::NonConformingFacet { .. }) => {}
        checked => checked?,
    }
    let mut list = left_out::List::new(deck);
    let cuts = cut::cuts(deck, &mut solids, &mut list);
    let solids = solids;
    let lookup = sets::Lookup::new(&deck.contents, &solids);
    let mut bodies = bodies::bodies(deck, &solids, &lookup, &mut list)?;
    let timeline = timeline::Timeline::new(deck, &mut list);
    let section = section::PlaneSection::of(deck, &solids, &mut list);
    dynamics::damping(deck, &mut bodies, &timeline, &mut list);
    let velocities = dynamics::velocities(deck, &bodies, &lookup, &timeline, &mut list);
    let mut context = context::Context {
        deck,
        bodies: &bodies,
        lookup: &lookup,
        timeline: &timeline,
        section,
        axes: &axes::LocalAxes::new(deck, &lookup, &solids.mesh.nodes),
        references: references::References::new(deck, &solids, &bodies),
        sets: set_names::SetNames::new(deck, &solids, &bodies, names, !cuts.is_empty()),
        scene: write::Tables::of_section(section),
        list,
    };
    if context.section.is_none() {
        couplings::couplings(&mut context);
    } else {
        couplings::left_out_of_sections(&mut context);
    }
    equations::equations(&mut context, &cuts);
    if context.section.is_none() {
        connections::connections(&mut context);
    }
    contacts::ties(&mut context);
    contacts::pairs(&mut context);
    supports::supports(&mut context);
    loads::loads(&mut context);
    reference_loads::reference_loads(&mut context);
    let context::Context { sets, scene, list, .. } = context;
    let (sources, mesh) = sets.finish();
    let left_out = list.finish(deck);
    let mapped = scene.mapped(&bodies, &timeline);
    let text = write::scene(deck, names, &bodies, &sources, &velocities, &timeline, &scene, &mapped, &left_out);
    Ok(Import { scene: text, mesh, mapped, left_out })
}
