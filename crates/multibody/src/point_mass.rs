//! Point masses, and points without mass.

use crate::Embedded;
use crate::error::{PartDataError, not_negative, positive};
use std::ops::Range;
use stoss_term::{Rule, Term, Vectors};

/// A mass at one vector, its position. Without mass it moves only as what is joined to it says, for instance [`crate::LinearEquations`].
#[derive(Clone, Debug, PartialEq)]
pub struct PointMass {
    name: String,
    vector: u32,
    mass: f64,
    length: f64,
}

impl PointMass {
    /// A point mass with the number of its vector and a length of the system that it is part of, against which its motion is judged.
    ///
    /// # Errors
    /// [`PartDataError::Number`].
    pub fn new(name: &str, vector: u32, mass: f64, length: f64) -> Result<Self, PartDataError> {
        not_negative("mass of a point", mass)?;
        positive("length scale of a point mass", length)?;
        Ok(Self { name: name.to_owned(), vector, mass, length })
    }

    /// Position of the mass, as a vector of the system.
    pub fn position(&self) -> Embedded {
        Embedded::vector(self.vector)
    }
}

impl Term for PointMass {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn is_symmetric(&self, _rule: Rule) -> bool {
        true
    }

    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for PointMass {
    fn own_vectors(&self) -> Range<u32> {
        self.vector..self.vector + 1
    }

    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        if self.mass > 0.0 {
            visit(self.vector, self.vector, self.mass);
        }
    }
}
