//! What is run, and what its result is held against.

use stoss_integrators::Claims;

use super::evidence::Evidence;
use super::geometry::Side;
use super::scene::Scene;
use crate::workspace::Outcome;

/// Body numbers of the contact scenes.
pub const LOWER: usize = 0;
/// See [`LOWER`].
pub const UPPER: usize = 1;

/// Schemes that carry contact, each with its constraint form.
pub const CONTACT: [(&str, &str); 7] = [
    ("energy-momentum", "standard"),
    ("energy-momentum", "modified"),
    ("midpoint", "standard"),
    ("generalised-alpha", "standard"),
    ("backward-euler", "standard"),
    ("trapezoidal", "standard"),
    ("variational-midpoint", "standard"),
];

/// Schemes of the free flights.
pub const FREE: [&str; 6] =
    ["energy-momentum", "midpoint", "generalised-alpha", "backward-euler", "trapezoidal", "variational-midpoint"];

/// Figure of a finished run against a closed form: its error.
pub type Error = Box<dyn Fn(&Evidence) -> Outcome<f64>>;

/// What a run is held against, beyond what holds for all of them.
pub enum Oracle {
    /// Conservation only.
    Conservation,
    /// A closed form; what the error is, and its bound.
    Closed {
        /// What the error is the error of, and why this bound.
        about: &'static str,
        /// The error.
        error: Error,
        /// Its bound.
        bound: f64,
        /// What it is called if the bound does not hold.
        otherwise: Word,
    },
    /// Conservation; the last displacements are kept for [`Oracle::Same`].
    Base,
    /// The last displacements are those of a base, times a length; nothing else is compared.
    Same {
        /// Combination of the base.
        base: String,
        /// Unit of length.
        length: f64,
        /// Largest relative difference.
        bound: f64,
    },
    /// There is no solution: the run must end with a named error.
    Fails,
}

impl Oracle {
    /// True if the run has to end with an error and did, or has not to and did not.
    pub fn allows_the_end_of(&self, evidence: &Evidence) -> bool {
        !matches!(self, Self::Fails) || evidence.error.is_some()
    }
}

/// One word for what became of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// Within the bound.
    Right,
    /// Loses energy: the largest part of what was there at the start.
    Dissipates,
    /// Gains energy: the largest gain over what was there at the start.
    GainsEnergy,
    /// Angular momentum, or the motion itself, goes astray.
    Drifts,
    /// A slave node is inside the master: how deep in its element, 1 in the middle.
    Penetrates,
    /// Too stiff: the part of the deflection that is missing.
    Locks,
    /// Exit code 3, the error is named, all completed steps are kept and stand up to the checks: their number.
    NamedError,
    /// Anything that must not be.
    Wrong,
}

impl Word {
    /// As it is written in the report and in the document.
    pub fn text(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Dissipates => "dissipates",
            Self::GainsEnergy => "gains energy",
            Self::Drifts => "drifts",
            Self::Penetrates => "penetrates",
            Self::Locks => "locks",
            Self::NamedError => "named error",
            Self::Wrong => "WRONG",
        }
    }
}

/// Slave nodes and master body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Body of the slave.
    pub slave: usize,
    /// Which of its nodes.
    pub side: Side,
}

impl Touch {
    /// The upper body's bottom is the slave.
    pub const UPPER: Self = Self { slave: UPPER, side: Side::Bottom };
    /// The lower body's top is the slave.
    pub const LOWER: Self = Self { slave: LOWER, side: Side::Top };
}

/// In place of a constraint for mortar contact, which has one only.
pub const TRUE_GAP: &str = "true gap";

/// One combination.
pub struct Case {
    /// The extreme, as the document names it.
    pub family: String,
    /// What is combined with it.
    pub combination: String,
    /// Scheme; `None`: quasi-static.
    pub scheme: Option<&'static str>,
    /// True with the modified constraint.
    pub modified: bool,
    /// True with mortar contact: it takes energy and never gives any.
    pub true_gap: bool,
    /// The scene.
    pub scene: Scene,
    /// Files that the scene refers to.
    pub files: Vec<(String, String)>,
    /// Contact, if there is any.
    pub touch: Option<Touch>,
    /// Neither supports nor loads: momenta and energy are constant.
    pub free: bool,
    /// The integrals of the contact change from step to step (mortar): the energy is not kept while bodies touch.
    pub renews_integrals: bool,
    /// What energies are measured against; the energy at the start if not given.
    pub energy: Option<f64>,
    /// See [`Oracle`].
    pub oracle: Oracle,
}

impl Case {
    /// A free flight, or a quasi-static run without a scheme.
    pub fn new(family: impl Into<String>, scheme: Option<&'static str>, scene: Scene, oracle: Oracle) -> Self {
        Self {
            family: family.into(),
            combination: scheme.unwrap_or("quasi-static").to_owned(),
            scheme,
            modified: false,
            true_gap: false,
            scene,
            files: Vec::new(),
            touch: None,
            free: scheme.is_some(),
            renews_integrals: false,
            energy: None,
            oracle,
        }
    }

    /// A dynamic scene with contact.
    pub fn contact(
        family: impl Into<String>,
        (scheme, constraint): (&'static str, &'static str),
        scene: Scene,
        touch: Touch,
    ) -> Self {
        let combination = if matches!(constraint, "standard" | TRUE_GAP) {
            scheme.to_owned()
        } else {
            format!("{scheme} {constraint}")
        };
        let case = Self::new(family, Some(scheme), scene, Oracle::Conservation);
        let (modified, true_gap) = (constraint == "modified", constraint == TRUE_GAP);
        Self { combination, modified, true_gap, touch: Some(touch), ..case }
    }

    /// With another name of the combination.
    pub fn named(self, combination: impl Into<String>) -> Self {
        Self { combination: combination.into(), ..self }
    }

    /// With another oracle.
    pub fn against(self, oracle: Oracle) -> Self {
        Self { oracle, ..self }
    }

    /// What the scheme promises.
    pub fn claims(&self) -> Option<Claims> {
        self.scheme.and_then(|name| stoss_integrators::scheme(name).ok()).map(|scheme| scheme.claims())
    }

    /// Name of the run's folder.
    pub fn slug(&self) -> String {
        let name = format!("{} {}", self.family, self.combination).to_lowercase();
        let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join("-")
    }
}
