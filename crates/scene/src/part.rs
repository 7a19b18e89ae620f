//! Parts: everything that moves and has a name.

use crate::Scene;
use crate::names::named;

named! {
    /// Kinds of parts. All parts of a scene share one name space.
    PartKind {
        /// `[[body]]`, with sets of its mesh.
        Body = "body",
        /// `[[rigid]]`, with sets of its surface; without a surface only `all`.
        Rigid = "rigid",
        /// `[[beam]]`, with the sets `start`, `end`, `all`.
        Beam = "beam",
        /// `[[string]]`, with the sets `start`, `end`, `all`.
        String = "string",
        /// `[[mass]]`, with the set `all`.
        Mass = "mass",
    }
}

impl PartKind {
    /// What messages call it.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Body => "a deformable body",
            Self::Rigid => "a rigid body",
            Self::Beam => "a beam",
            Self::String => "a string",
            Self::Mass => "a point mass",
        }
    }
}

impl Scene {
    /// Kind of a part and its position in the list of its kind.
    pub fn part(&self, name: &str) -> Option<(PartKind, usize)> {
        let bodies = self.bodies.iter().position(|part| part.name == name).map(|i| (PartKind::Body, i));
        bodies
            .or_else(|| self.rigids.iter().position(|part| part.name == name).map(|i| (PartKind::Rigid, i)))
            .or_else(|| self.beams.iter().position(|part| part.name == name).map(|i| (PartKind::Beam, i)))
            .or_else(|| self.strings.iter().position(|part| part.name == name).map(|i| (PartKind::String, i)))
            .or_else(|| self.masses.iter().position(|part| part.name == name).map(|i| (PartKind::Mass, i)))
    }

    /// Position of a joint in [`Scene::joints`].
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }
}

/// Part and set of a reference `part.set`: what is before and after the first dot.
pub fn split_set(reference: &str) -> Option<(&str, &str)> {
    reference.split_once('.').filter(|(body, set)| !body.is_empty() && !set.is_empty())
}
