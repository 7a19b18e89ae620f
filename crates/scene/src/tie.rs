//! Mesh ties.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Tie {
    /// Unique name; `slave+master` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Slave surface, `body.set`, whose nodes have the multipliers, except in prescribed components.
    pub slave: String,
    /// Master surface, `body.set`; it has no node in common with the slave surface.
    pub master: String,
    /// Form of the constraints: `constant` or `frame-invariant`.
    #[serde(default = "Tie::default_form")]
    pub form: TieForm,
    /// Treatment of an initial gap: `move`, `keep` or `close`.
    #[serde(default = "Tie::default_interface")]
    pub interface: Interface,
    /// Shape functions of the multipliers: `standard` or `dual`.
    #[serde(default = "Tie::default_multipliers")]
    pub multipliers: Multipliers,
    /// Largest distance (length) at which facets are tied, positive; the larger of the mean edge lengths of the two surfaces if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Length)))]
    pub reach: Option<f64>,
}

impl Tie {
    pub(crate) fn default_form() -> TieForm {
        TieForm::Constant
    }
    pub(crate) fn default_interface() -> Interface {
        Interface::Move
    }
    pub(crate) fn default_multipliers() -> Multipliers {
        Multipliers::Standard
    }

    /// The given name, or `slave+master`.
    pub fn label(&self) -> String {
        self.name.clone().unwrap_or_else(|| format!("{}+{}", self.slave, self.master))
    }
}
