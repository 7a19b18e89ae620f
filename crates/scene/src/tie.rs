//! Mesh ties.

use crate::names::named;
use crate::read::{Node, Table};
use crate::world::{World, surface_reference};
use crate::{PartKind, split_set};
use stoss_scene_derive::table;

named! {
    /// Form of the constraints of a tie (theory/mortar#eq-tie).
    TieForm {
        /// Cartesian components of the gap vectors: linear constraints, objective under rotations only if the
        /// interface is closed.
        Constant = "constant",
        /// Components of the gap vectors in a frame that moves with the slave surface: objective under rotations with any
        /// gap; a gap that is kept rotates with the bodies.
        FrameInvariant = "frame-invariant",
    }
}

named! {
    /// Treatment of an initial gap between the surfaces.
    Interface {
        /// The slave nodes of the interface are moved onto the master before the run, without stress.
        Move = "move",
        /// The initial gap is kept.
        Keep = "keep",
        /// The first step closes the gap, which strains the bodies.
        Close = "close",
    }
}

named! {
    /// Shape functions of the multipliers of a mortar method.
    Multipliers {
        /// Standard: the shape functions of the slave surface.
        Standard = "standard",
        /// Dual: functions that are biorthogonal to the shape functions; the mortar matrix of the slave is diagonal.
        Dual = "dual",
        /// Dual functions that act inside the overlap where a facet is partly opposite the master; for contact.
        Centred = "centred",
    }
}

/// `[[tie]]`: mesh tie of two surfaces, whose meshes need not match, for the whole run (mortar method).
#[table(context(World<'_>), check_all = tie)]
pub struct Tie {
    /// Unique name; `slave+master` if left out.
    #[key(name)]
    pub name: Option<String>,
    /// Slave surface, `body.set`, whose nodes have the multipliers, except in prescribed components.
    #[key(example = "\"cap.bottom\"", by = surface_reference)]
    pub slave: String,
    /// Master surface, `body.set`; it has no node in common with the slave surface.
    #[key(example = "\"post.top\"", by = surface_reference)]
    pub master: String,
    /// Form of the constraints: `constant` or `frame-invariant`.
    #[key(default = TieForm::Constant)]
    pub form: TieForm,
    /// Treatment of an initial gap: `move`, `keep` or `close`.
    #[key(default = Interface::Move)]
    pub interface: Interface,
    /// Shape functions of the multipliers: `standard` or `dual`.
    #[key(default = Multipliers::Standard, read = tie_multipliers)]
    pub multipliers: Multipliers,
    /// Largest distance (length) at which facets are tied, positive; the larger of the mean edge lengths of the two surfaces if left out.
    #[key(dimension = Length, positive)]
    pub reach: Option<f64>,
}

impl Tie {
    /// The given name, or `slave+master`.
    pub fn label(&self) -> String {
        self.name.clone().unwrap_or_else(|| format!("{}+{}", self.slave, self.master))
    }
}

fn tie_multipliers(node: &Node<'_>) -> Option<Multipliers> {
    node.choice(&["standard", "dual"], |name| Multipliers::from_name(name).filter(|m| *m != Multipliers::Centred))
}

fn tie(tie: &Tie, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    if tie.slave == tie.master {
        return table.fail("master", "is the slave surface itself", "choose the surface that it is tied to");
    }
    let is_rigid = |set: &str| {
        split_set(set).and_then(|(part, _)| world.part(part)).is_some_and(|part| part.kind == PartKind::Rigid)
    };
    if is_rigid(&tie.slave) && is_rigid(&tie.master) {
        let message = "belongs to a rigid body, as the slave does";
        return table.fail("master", message, "join them by a [[joint]], kind = \"weld\"");
    }
    Some(())
}
