//! Velocities that impulses make, with all bilateral constraints: `M x = r + B^T lambda`, `B x = b` (theory/impacts#response).

use super::rows::Row;
use crate::StepError;
use crate::assembly::System;
use crate::mass_solve::MassSolver;
use crate::masses::Masses;
use std::sync::Arc;
use stoss_linalg::{AutoSolver, LinearSolver, MatrixKind, NONE, SparsityPattern};

/// Compliance of the rows, scaled to a compliance of one each, that keeps the matrix regular where rows are redundant. It is in the factors only: iterations with the true residual take
/// it out again, each all but this part over the smallest compliance of independent rows.
const COMPLIANCE: f64 = 1e-8;

/// Part of the largest mass on the diagonal of a component without mass, in the factors only.
const MISSING_MASS: f64 = 1e-8;

/// Solutions with the true residual at most.
const MAX_SOLUTIONS: usize = 6;

/// Violation of a row, beside the velocity along it, that is round-off.
const ROUND_OFF: f64 = 1e-15;

/// The factors of `[M  -B^T; -B  -c]` and the rows `B`. Kept from one impact to the next: as long as the rows are the same (bodies without joints have none) so are the factors.
#[derive(Debug, Default)]
pub(super) struct Response {
    /// Made with the first matrix.
    solver: Option<Box<dyn LinearSolver>>,
    /// Products with the inverse mass in place of factors on several ranks, where there are no rows: no rank has the whole mass.
    products: Option<MassSolver>,
    /// The pattern of the bodies that `pattern` was made from, and the columns of the rows.
    base: Option<Arc<SparsityPattern>>,
    columns: Vec<u32>,
    pattern: Option<Arc<SparsityPattern>>,
    /// Where the entries of the mass go.
    mass_at: Vec<u32>,
    values: Vec<f64>,
    is_factorised: bool,
    rows: Vec<Row>,
    /// What each row is multiplied by, so that `B M^-1 B^T` has ones on its diagonal if the mass is lumped.
    scales: Vec<f64>,
    /// Whether one solution is exact.
    is_plain: bool,
    right: Vec<f64>,
    solution: Vec<f64>,
}

impl Response {
    /// Takes the rows of the bilateral constraints and factorises, if anything is different from the last time.
    pub fn prepare(&mut self, system: &System, rows: Vec<Row>) -> Result<(), StepError> {
        let numbering = &system.matrix.numbering;
        let free = numbering.free.len();
        let equation = |component: u32| numbering.equation[component as usize];
        let own = |row: &Row| -> Vec<(u32, f64)> {
            let entries = row.entries.iter().map(|&(c, g)| (equation(c), g));
            entries.filter(|(equation, _)| *equation != NONE).collect()
        };
        let mut columns = Vec::new();
        for (k, row) in rows.iter().enumerate() {
            columns.push(NONE);
            columns.extend(own(row).iter().flat_map(|&(equation, _)| [equation, (free + k) as u32]));
        }
        let shares = &system.shares;
        self.products = None;
        if shares.is_shared() && rows.is_empty() {
            self.products = Some(MassSolver::new(&system.inertia.masses, &numbering.free, numbering.equation.len()));
            self.rows = rows;
            return Ok(());
        }
        let is_base = self.base.as_ref().is_some_and(|base| Arc::ptr_eq(base, &system.matrix.fixed.pattern));
        if !is_base || columns != self.columns {
            self.set_pattern(system, &rows, &own)?;
            self.columns = columns;
        }
        let Some(pattern) = &self.pattern else { return Ok(()) };
        let mut values = vec![0.0; pattern.nnz()];
        self.mass_at.iter().zip(&system.matrix.fixed.mass).for_each(|(&at, &mass)| values[at as usize] += mass);
        let place = |row: usize, column: usize| pattern.position(row as u32, column as u32);
        let mut diagonal: Vec<f64> = (0..free).map(|i| place(i, i).map_or(0.0, |at| values[at])).collect();
        shares.sum_all(&mut diagonal);
        // What is no mass one rank adds.
        let adds = shares.is_first();
        let missing = MISSING_MASS * diagonal.iter().copied().fold(0.0, f64::max);
        let masses: Vec<f64> = diagonal.iter().map(|&m| if m > 0.0 { m } else { missing }).collect();
        for (i, _) in diagonal.iter().enumerate().filter(|(_, m)| adds && **m <= 0.0) {
            if let Some(at) = place(i, i) {
                values[at] += missing;
            }
        }
        self.is_plain = rows.is_empty() && diagonal.iter().all(|&m| m > 0.0);
        self.scales.clear();
        for (k, row) in rows.iter().enumerate() {
            let own = own(row);
            let square: f64 = own.iter().map(|&(i, g)| g * g / masses[i as usize]).sum();
            let scale = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
            for &(i, g) in own.iter().filter(|_| adds) {
                for at in [place(i as usize, free + k), place(free + k, i as usize)].into_iter().flatten() {
                    values[at] -= scale * g;
                }
            }
            if let Some(at) = place(free + k, free + k).filter(|_| adds) {
                values[at] -= if scale > 0.0 { COMPLIANCE } else { 1.0 };
            }
            self.scales.push(scale);
        }
        self.rows = rows;
        if shares.any(!self.is_factorised || values != self.values) {
            let solver = self.solver.get_or_insert_with(|| shares.gathered(Box::new(AutoSolver::new())));
            solver.forget();
            let kind = if self.rows.is_empty() { MatrixKind::SymmetricPositiveDefinite } else { MatrixKind::Symmetric };
            self.is_factorised = false;
            solver.analyse(pattern, kind)?;
            solver.factorise(&values)?;
            (self.values, self.is_factorised) = (values, true);
        }
        self.right.resize(pattern.n(), 0.0);
        self.solution.resize(pattern.n(), 0.0);
        Ok(())
    }

    fn set_pattern(
        &mut self,
        system: &System,
        rows: &[Row],
        own: &dyn Fn(&Row) -> Vec<(u32, f64)>,
    ) -> Result<(), StepError> {
        let free = system.matrix.free();
        let base = &system.matrix.fixed.pattern;
        self.is_factorised = false;
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for (k, row) in rows.iter().enumerate() {
            let multiplier = (free + k) as u32;
            pairs.push([multiplier; 2]);
            pairs.extend(own(row).iter().map(|&(equation, _)| [equation, multiplier]));
        }
        // Diagonals of components without elements, which have neither mass nor stiffness.
        let diagonal: Vec<[u32; 1]> = (0..free as u32).map(|i| [i]).collect();
        let stencils = system
            .matrix
            .fixed
            .stencils
            .iter()
            .chain(pairs.iter().map(|pair| &pair[usize::from(pair[0] == pair[1])..]));
        let pattern =
            SparsityPattern::from_stencils(free + rows.len(), stencils.chain(diagonal.iter().map(|i| &i[..])))?;
        let mut groups = base.groups().map(<[u32]>::to_vec).unwrap_or_else(|| (0..free as u32).collect());
        let group_of = |row: &Row| own(row).first().map_or(NONE, |&(equation, _)| groups[equation as usize]);
        let of_rows: Vec<u32> = rows.iter().map(group_of).collect();
        groups.extend(of_rows);
        let pattern = Arc::new(pattern.with_groups(groups)?.with_first_multiplier(free));
        self.mass_at.clear();
        for column in 0..free {
            for &row in base.column(column) {
                let at = pattern.position(row, column as u32);
                self.mass_at.push(at.map_or(NONE, |at| at as u32));
            }
        }
        self.base = Some(Arc::clone(base));
        self.pattern = Some(pattern);
        Ok(())
    }

    /// The rows.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Velocities (components of the model, zero where there is no equation) under the impulses `force`, with the rates `rate` of the rows; also the impulses of the rows.
    pub fn velocities(
        &mut self,
        (masses, free): (&Masses, &[u32]),
        force: &[f64],
        rate: Option<&[f64]>,
    ) -> Result<(Vec<f64>, Vec<f64>), StepError> {
        if let Some(products) = &mut self.products {
            let mut x = vec![0.0; force.len()];
            products.solve(masses, force, &mut x)?;
            return Ok((x, Vec::new()));
        }
        let (n, m) = (free.len(), self.rows.len());
        let (mut x, mut multipliers) = (vec![0.0; force.len()], vec![0.0; m]);
        let mut rest = force.to_vec();
        for pass in 0..MAX_SOLUTIONS {
            // Scaled violations of the rows.
            let mut worst = 0.0_f64;
            for (k, row) in self.rows.iter().enumerate() {
                let missed = row.dot(&x) - rate.map_or(0.0, |rate| rate[k]);
                self.right[n + k] = self.scales[k] * missed;
                worst = worst.max(self.right[n + k].abs());
            }
            if pass > 0 {
                rest.copy_from_slice(force);
                let mut momentum = vec![0.0; force.len()];
                masses.multiply_add(1.0, &x, &mut momentum);
                let size = free.iter().map(|&c| momentum[c as usize] * x[c as usize]).sum::<f64>().abs().sqrt();
                if worst <= ROUND_OFF * size && pass > 1 {
                    break;
                }
                rest.iter_mut().zip(&momentum).for_each(|(rest, m)| *rest -= m);
                self.rows.iter().zip(&multipliers).for_each(|(row, &lambda)| row.add_to(lambda, &mut rest));
            }
            self.right[..n].iter_mut().zip(free).for_each(|(right, &c)| *right = rest[c as usize]);
            let Some(solver) = &mut self.solver else { break };
            solver.solve(&self.right, &mut self.solution)?;
            free.iter().zip(&self.solution).for_each(|(&c, dx)| x[c as usize] += dx);
            let changes = self.solution[n..].iter().zip(&self.scales);
            multipliers.iter_mut().zip(changes).for_each(|(lambda, (change, scale))| *lambda += scale * change);
            if self.is_plain {
                break;
            }
        }
        Ok((x, multipliers))
    }
}
