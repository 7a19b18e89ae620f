//! Equilibria of one body, assembled from the crates without the facade: what closed forms are held against.

use std::sync::Arc;

use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::{
    ForceRule, SolidBody, SolidOptions, SolidStep, TangentTarget, Workspace, add_follower_pressure, follower_pressure,
};
use stoss_linalg::{AutoSolver, LinearSolver, MatrixKind, NONE, ScatterMap, SparsityPattern};
use stoss_mesh::Mesh;
use stoss_reference_element::FaceNodes;
use stoss_tensor::nalgebra::DMatrix;

use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Newton's iterations of one increment.
const ITERATIONS: u32 = 20;
/// A correction below this part of the body's size ends the iteration: what is left is its square. Residuals are no measure near incompressibility, where
/// their round-off is that of the bulk modulus.
const TOLERANCE: f64 = 1e-8;

/// One body, some of whose components are held, under nodal forces and a follower pressure.
pub struct Equilibrium {
    pub body: SolidBody,
    pub mesh: Mesh,
    /// Equation of each component, [`NONE`] of one that is held.
    equations: Vec<u32>,
    /// Facets under the follower pressure.
    pressed: Vec<FaceNodes>,
    pattern: Arc<SparsityPattern>,
    elements: ScatterMap,
    facets: ScatterMap,
    /// Largest extent of the body.
    size: f64,
}

/// What acts on the body.
#[derive(Clone, Copy)]
pub struct Load<'a> {
    /// Forces at all nodes; empty: none.
    pub forces: &'a [f64],
    /// Follower pressure, positive when it presses.
    pub pressure: f64,
}

impl Equilibrium {
    /// `held` says of a reference position which components do not follow from equilibrium.
    pub fn new(
        mesh: Mesh,
        law: Arc<dyn HyperelasticLaw>,
        options: SolidOptions,
        held: impl Fn([f64; 3]) -> [bool; 3],
        pressed: Vec<FaceNodes>,
    ) -> Outcome<Self> {
        let body = SolidBody::with_options("body", &mesh, 0, law, options)?;
        let mut unknowns = 0;
        let equations: Vec<u32> = mesh
            .nodes
            .iter()
            .flat_map(|x| held(*x))
            .map(|held| {
                if held {
                    return NONE;
                }
                unknowns += 1;
                unknowns - 1
            })
            .collect();
        let of = |nodes: &[u32]| -> Vec<u32> {
            nodes.iter().flat_map(|n| (0..3).map(move |i| 3 * *n as usize + i)).map(|c| equations[c]).collect()
        };
        let elements: Vec<Vec<u32>> = body.stencils().map(of).collect();
        let facets: Vec<Vec<u32>> = pressed.iter().map(|nodes| of(nodes)).collect();
        let all = elements.iter().chain(&facets).map(Vec::as_slice);
        let pattern = SparsityPattern::from_stencils(unknowns as usize, all)?;
        let elements = ScatterMap::new(&pattern, elements.iter().map(Vec::as_slice))?;
        let facets = ScatterMap::new(&pattern, facets.iter().map(Vec::as_slice))?;
        let (low, high) = mesh.bounding_box();
        let size = (0..3).map(|i| high[i] - low[i]).fold(0.0, larger);
        Ok(Self { size, body, mesh, equations, pressed, pattern: Arc::new(pattern), elements, facets })
    }

    /// Positions of the reference configuration.
    pub fn reference(&self) -> Vec<f64> {
        self.mesh.nodes.iter().flatten().copied().collect()
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.pattern.n()
    }

    /// Forces of the body at these positions, and the tangent if asked for.
    pub fn internal_force(&self, q: &[f64], tangent: Option<&mut [f64]>) -> Outcome<Vec<f64>> {
        self.internal_force_after(None, q, tangent)
    }

    /// Forces of the body as [`Self::internal_force`], for an iterate that followed `before`.
    fn internal_force_after(
        &self,
        before: Option<&[f64]>,
        q: &[f64],
        tangent: Option<&mut [f64]>,
    ) -> Outcome<Vec<f64>> {
        let mut force = vec![0.0; q.len()];
        let step = SolidStep { q_n: q, q_np1: q, rule: ForceRule::END_POINT };
        let target = tangent.map(|values| TangentTarget { map: &self.elements, first_stencil: 0, factor: 1.0, values });
        self.body.assemble_after(before, step, 1.0, &mut force, target, &mut Workspace::default())?;
        Ok(force)
    }

    /// The tangent without loads as rows of a dense matrix over the unknowns.
    pub fn dense_tangent(&self, q: &[f64]) -> Outcome<DMatrix<f64>> {
        let mut values = vec![0.0; self.pattern.nnz()];
        self.internal_force(q, Some(&mut values))?;
        let n = self.unknowns();
        let mut dense = DMatrix::zeros(n, n);
        for column in 0..n {
            for (row, k) in self.pattern.column(column).iter().zip(self.pattern.column_range(column)) {
                dense[(*row as usize, column)] = values[k];
            }
        }
        Ok(dense)
    }

    /// Moves the free components of `q` into equilibrium; the number of linear solves, or `None` if the iteration does not end.
    pub fn solve(&self, q: &mut [f64], load: Load<'_>) -> Outcome<Option<u32>> {
        let mut solver = AutoSolver::new();
        let kind = if load.pressure == 0.0 { MatrixKind::Symmetric } else { MatrixKind::General };
        solver.analyse(&self.pattern, kind)?;
        let n = self.unknowns();
        let (mut values, mut right, mut step) = (vec![0.0; self.pattern.nnz()], vec![0.0; n], vec![0.0; n]);
        let mut before = q.to_vec();
        for iteration in 0..ITERATIONS {
            values.fill(0.0);
            // The start of an increment is no linear solution.
            let after = (iteration > 0).then_some(&before[..]);
            let Ok(internal) = self.internal_force_after(after, q, Some(&mut values)) else { return Ok(None) };
            before.copy_from_slice(q);
            let mut external = if load.forces.is_empty() { vec![0.0; q.len()] } else { load.forces.to_vec() };
            if load.pressure != 0.0 {
                for (k, facet) in self.pressed.iter().enumerate() {
                    let places: Vec<[f64; 3]> =
                        facet.iter().map(|n| std::array::from_fn(|i| q[3 * *n as usize + i])).collect();
                    let mut pressure = follower_pressure(facet.kind(), &places, load.pressure);
                    add_follower_pressure(facet, pressure.force(), &mut external);
                    pressure.tangent_mut().iter_mut().for_each(|k| *k = -*k);
                    self.facets.add(k, pressure.tangent(), &mut values);
                }
            }
            for (c, &equation) in self.equations.iter().enumerate() {
                if equation != NONE {
                    right[equation as usize] = external[c] - internal[c];
                }
            }
            if solver.factorise(&values).is_err() || solver.solve(&right, &mut step).is_err() {
                return Ok(None);
            }
            for (c, &equation) in self.equations.iter().enumerate() {
                if equation != NONE {
                    q[c] += step[equation as usize];
                }
            }
            if step.iter().all(|s| s.abs() <= TOLERANCE * self.size) {
                return Ok(Some(iteration + 1));
            }
        }
        Ok(None)
    }

    /// Drives `q` from the reference configuration along a path: `place` gives a held component at a node `X` for a share between 0 and 1 of the way, `load` is
    /// in the same share. Increments that do not end are halved. The share that was reached.
    pub fn follow(
        &self,
        q: &mut Vec<f64>,
        load: Load<'_>,
        increment: f64,
        place: impl Fn([f64; 3], f64) -> [f64; 3],
    ) -> Outcome<f64> {
        let (mut done, mut size) = (0.0, increment);
        while done < 1.0 - 1e-12 && size > 1e-3 {
            let next = f64::min(done + size, 1.0);
            let mut trial = q.clone();
            for (node, x) in self.mesh.nodes.iter().enumerate() {
                let (before, after) = (place(*x, done), place(*x, next));
                // Free nodes begin where the motion of the held ones would take them.
                for i in 0..3 {
                    let c = 3 * node + i;
                    trial[c] = if self.equations[c] == NONE { after[i] } else { trial[c] + after[i] - before[i] };
                }
            }
            let forces: Vec<f64> = load.forces.iter().map(|f| next * f).collect();
            let now = Load { forces: &forces, pressure: next * load.pressure };
            if self.solve(&mut trial, now)?.is_some() {
                (*q, done) = (trial, next);
            } else {
                size *= 0.5;
            }
        }
        Ok(done)
    }
}
