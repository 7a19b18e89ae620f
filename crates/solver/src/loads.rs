//! Loads as functions of time.

use crate::Table;
use stoss_fe_solid::MassMatrix;
use stoss_reference_element::FaceNodes;

/// A load: nodal patterns of unit magnitude times a function of time, or a load that depends on the configuration: a follower pressure, a moment, a centrifugal force.
#[derive(Clone, Debug)]
pub struct Load {
    /// Name for reports.
    pub name: String,
    /// Kind of the load, and where it acts.
    pub kind: LoadKind,
    /// Magnitude; one column for each pattern of a dead load, one column (a pressure) for a follower pressure, three for a moment.
    pub magnitude: Table,
}

/// Kinds of loads.
#[derive(Clone, Debug)]
pub enum LoadKind {
    /// Constant direction and reference area or volume: nodal force = sum over columns of magnitude * pattern. Each
    /// pattern is a list of (component `3*node + i`, force a unit of magnitude).
    Dead {
        /// One pattern a column of the table.
        patterns: Vec<Vec<(u32, f64)>>,
    },
    /// Pressure normal to the current surface, positive inwards (theory/elements#loads).
    FollowerPressure {
        /// Facets, global nodes, numbered outward.
        facets: Vec<FaceNodes>,
    },
    /// A moment fixed in space on each of some sets of three directors, as forces on them: those of least norm with this moment, `m x D_k / (2 l^2)` for orthogonal directors of length `l`
    /// (theory/multibody#moments). Its work is that of `f . dq`; it has no potential.
    Moment {
        /// Global numbers of the directors.
        directors: Vec<[u32; 3]>,
    },
    /// Centrifugal force `w^2 M P (q - c)` on a body in a frame that rotates with the angular velocity `w` (the magnitude) about an axis through `c`, with `P = I - n n^T`. Its
    /// potential is `-w^2/2 (q - c) . M P (q - c)`; Coriolis and Euler forces are not included.
    Centrifugal {
        /// Number of the body.
        body: usize,
        /// Its mass.
        mass: MassMatrix,
        /// Unit vector `n` of the axis.
        axis: [f64; 3],
        /// A point `c` of the axis.
        about: [f64; 3],
    },
}

impl Load {
    /// Whether the load may have a resultant along x, y and z.
    pub fn directions(&self) -> [bool; 3] {
        let patterns = match &self.kind {
            LoadKind::Dead { patterns } => patterns,
            LoadKind::FollowerPressure { .. } => return [true; 3],
            LoadKind::Moment { .. } => return [false; 3],
            LoadKind::Centrifugal { axis, .. } => return axis.map(|n| n.abs() < 1.0),
        };
        let mut directions = [false; 3];
        for (column, pattern) in patterns.iter().enumerate() {
            if self.magnitude.is_zero(column) {
                continue;
            }
            for &(component, unit) in pattern {
                directions[component as usize % 3] |= unit != 0.0;
            }
        }
        directions
    }

    /// Stencils that it has in the pattern beside those of the elements.
    pub(crate) fn stencils(&self) -> usize {
        match &self.kind {
            LoadKind::Dead { .. } | LoadKind::Centrifugal { .. } => 0,
            LoadKind::FollowerPressure { facets } => facets.len(),
            LoadKind::Moment { directors } => directors.len(),
        }
    }

    /// Whether it depends on the configuration.
    pub fn follows(&self) -> bool {
        !matches!(self.kind, LoadKind::Dead { .. })
    }

    /// Whether its derivative with respect to the positions is symmetric.
    pub(crate) fn is_symmetric(&self) -> bool {
        matches!(self.kind, LoadKind::Dead { .. } | LoadKind::Centrifugal { .. })
    }

    /// True if the load has a potential that does not change in time.
    pub fn is_conservative(&self) -> bool {
        !self.follows() && self.magnitude.is_constant()
    }

    /// Adds `factor` times the nodal forces of a dead load at a time; others add nothing here.
    pub(crate) fn add_dead(&self, time: f64, factor: f64, force: &mut [f64]) {
        if let LoadKind::Dead { patterns } = &self.kind {
            for (column, pattern) in patterns.iter().enumerate() {
                let magnitude = factor * self.magnitude.value(time, column);
                if magnitude != 0.0 {
                    for &(component, unit) in pattern {
                        force[component as usize] += magnitude * unit;
                    }
                }
            }
        }
    }
}
