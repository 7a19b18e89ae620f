//! Mesh ties.

use crate::names::named;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// Form of the constraints of a tie (theory/mortar#eq-tie).
    TieForm {
        /// Gap vectors in Cartesian components: linear constraints. Rotations of the whole do no work if the
        /// interface is closed.
        Constant = "constant",
        /// Gap vectors in a frame that moves with the slave surface: rotations of the whole do no work whatever the
        /// gap is, and an offset that is kept turns with the bodies.
        FrameInvariant = "frame-invariant",
    }
}

named! {
    /// What happens to surfaces that do not fit in the reference configuration.
    Interface {
        /// The slave nodes of the interface are moved before the run.
        Move = "move",
        /// The meshes stay as they are and the initial gap is kept.
        Keep = "keep",
        /// The first step closes the gap and strains the bodies.
        Close = "close",
    }
}

named! {
    /// Functions of the multipliers of a mortar method.
    Multipliers {
        /// The shape functions of the slave surface.
        Standard = "standard",
        /// Functions that are biorthogonal to them: the slave's mortar matrix is diagonal.
        Dual = "dual",
    }
}

/// `[[tie]]`: two surfaces with meshes that need not match stay together for the whole run (mortar method).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Tie {
    /// Unique name for reports; `slave+master` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Slave surface, `body.set`: it carries the multipliers. Components of its nodes that are prescribed have none.
    pub slave: String,
    /// Master surface, `body.set`; no node of it is on the slave surface.
    pub master: String,
    /// Form of the constraints.
    #[serde(default = "Tie::default_form")]
    pub form: TieForm,
    /// Treatment of an initial gap.
    #[serde(default = "Tie::default_interface")]
    pub interface: Interface,
    /// Functions of the multipliers.
    #[serde(default = "Tie::default_multipliers")]
    pub multipliers: Multipliers,
    /// Largest distance at which facets are tied, a length; by default the longer of the two surfaces' mean edges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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
