//! Loads as functions of time.

use crate::Table;
use crate::moment::moment_forces;
use stoss_fe_solid::{MassMatrix, follower_pressure};
use stoss_reference_element::{FaceNodes, MAX_FACE_NODES};
use stoss_term::{At, Fault, Local, Rule, Term, Undefined};

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
        /// The mass of the body.
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

    /// Whether it depends on the configuration.
    pub fn follows(&self) -> bool {
        !matches!(self.kind, LoadKind::Dead { .. })
    }

    /// True if the load has a potential that does not change in time.
    pub fn is_conservative(&self) -> bool {
        !self.follows() && self.magnitude.is_constant()
    }

    /// Adds `factor` times its forces at an iterate to a vector of the model.
    pub(crate) fn add_force(&self, at: &At<'_>, factor: f64, out: &mut [f64]) -> Result<(), Fault> {
        self.assemble(at, false, &mut |local| {
            for (&node, r) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                let first = 3 * node as usize;
                out[first..first + 3].iter_mut().zip(r).for_each(|(sum, r)| *sum -= factor * r);
            }
        })
    }
}

/// A load has a force at a part of the step, `at.rule.force()` of it, and none between: its rule under discrete gradients is that of the midpoint.
impl Term for Load {
    fn name(&self) -> &str {
        &self.name
    }

    /// Length scale of one: a load has no length of its own.
    fn length_scale(&self) -> f64 {
        1.0
    }

    fn is_symmetric(&self, _rule: Rule) -> bool {
        matches!(self.kind, LoadKind::Dead { .. } | LoadKind::Centrifugal { .. })
    }

    fn conserves_linear_momentum(&self) -> bool {
        false
    }

    fn conserves_angular_momentum(&self) -> bool {
        false
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        match &self.kind {
            LoadKind::Dead { patterns } => {
                patterns.iter().flatten().for_each(|&(component, _)| visit(&[component / 3], &[]));
            }
            LoadKind::FollowerPressure { facets } => facets.iter().for_each(|facet| visit(facet, &[])),
            LoadKind::Moment { directors } => directors.iter().for_each(|three| visit(three, &[])),
            LoadKind::Centrifugal { mass, .. } => mass.visit(&mut |nodes, _| visit(nodes, &[])),
        }
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = at.rule.force() else { return Ok(()) };
        let theta = rule.load_fraction();
        let magnitude = |column: usize| self.magnitude.value(at.time + theta * at.dt, column);
        let mut local = Local::default();
        match &self.kind {
            LoadKind::Dead { patterns } => {
                for (column, pattern) in patterns.iter().enumerate() {
                    let magnitude = magnitude(column);
                    for &(component, unit) in pattern {
                        local.begin(&[component / 3], want_tangent);
                        local.residual[component as usize % 3] = -magnitude * unit;
                        visit(&local);
                    }
                }
            }
            LoadKind::Moment { directors } => {
                let moment = [0, 1, 2].map(magnitude);
                for three in directors {
                    let places = three.map(|vector| at.between(theta, vector));
                    let (force, derivative) = moment_forces(&places, moment).ok_or_else(|| Undefined {
                        term: self.name.clone(),
                        reason:
                            "the directors of a loaded part turn by nearly half a turn in one step; use smaller steps"
                                .to_owned(),
                    })?;
                    local.begin(three, want_tangent);
                    local.residual.iter_mut().zip(force).for_each(|(r, f)| *r = -f);
                    local.tangent.iter_mut().zip(derivative).for_each(|(t, d)| *t = -theta * d);
                    visit(&local);
                }
            }
            LoadKind::FollowerPressure { facets } => {
                let pressure = magnitude(0);
                for facet in facets {
                    let mut places = [[0.0; 3]; MAX_FACE_NODES];
                    places.iter_mut().zip(facet.iter()).for_each(|(x, &node)| *x = at.between(theta, node));
                    let load = follower_pressure(facet.kind(), &places[..facet.len()], pressure);
                    local.begin(facet, want_tangent);
                    local.residual.iter_mut().zip(load.force().as_flattened()).for_each(|(r, f)| *r = -f);
                    // d q_theta / d q_np1 = theta.
                    local.tangent.iter_mut().zip(load.tangent()).for_each(|(t, d)| *t = -theta * d);
                    visit(&local);
                }
            }
            LoadKind::Centrifugal { mass, axis, about } => {
                let square = magnitude(0).powi(2);
                let across: [[f64; 3]; 3] =
                    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) - axis[i] * axis[j]));
                mass.visit(&mut |nodes, masses| {
                    local.begin(nodes, want_tangent);
                    let (n, dim) = (nodes.len(), 3 * nodes.len());
                    for (b, &node) in nodes.iter().enumerate() {
                        let x = at.between(theta, node);
                        let arm = across.map(|row| (0..3).map(|i| row[i] * (x[i] - about[i])).sum::<f64>());
                        for (a, factor) in (0..n).map(|a| (a, -square * masses[n * a + b])) {
                            for i in 0..3 {
                                local.residual[3 * a + i] += factor * arm[i];
                                for j in (0..3).filter(|_| want_tangent) {
                                    local.tangent[dim * (3 * a + i) + 3 * b + j] = theta * factor * across[i][j];
                                }
                            }
                        }
                    }
                    visit(&local);
                });
            }
        }
        Ok(())
    }
}
