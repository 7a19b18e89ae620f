//! Tangential rows of closed slots with friction between rigid bodies, and what the step did along them.

use super::Closed;
use super::rows::Row;
use crate::StepError;
use crate::iterate::Iterate;
use crate::simulation::Simulation;
use stoss_integrators::StepRule;
use stoss_term::StepConfiguration;

/// Friction of a closed slot.
#[derive(Clone, Debug)]
pub(super) struct Sliding {
    /// Place of the slot among the closed slots.
    pub slot: usize,
    /// Rates of sliding along two directions, with the weight of the row of its gap.
    pub rows: [Row; 2],
    /// Bound of the tangential impulse over the normal one.
    pub coefficient: f64,
    /// Impulses along the rows that the step has put in.
    pub impulses: [f64; 2],
    /// Rates of the rows at which the slave goes along with a surface of the master that moves beside its mesh.
    pub carried: [f64; 2],
}

impl Sliding {
    /// Rates of sliding at the velocities `v`: on a surface that moves beside its mesh they are zero where the slave goes along with it.
    pub fn rates(&self, v: &[f64]) -> [f64; 2] {
        [0, 1].map(|i| self.rows[i].dot(v) - self.carried[i])
    }
}

/// Two directions normal to a unit vector and to each other.
fn tangents(n: [f64; 3]) -> [[f64; 3]; 2] {
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let least = (0..3).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).unwrap_or(0);
    let side = cross(n, std::array::from_fn(|i| if i == least { 1.0 } else { 0.0 }));
    let size = side.iter().map(|x| x * x).sum::<f64>().sqrt();
    let first = side.map(|x| x / size);
    [first, cross(n, first)]
}

impl Simulation {
    /// Friction of the closed slots between rigid bodies. That of meshes stays the one of the step.
    pub(super) fn sliding(
        &self,
        iterate: &Iterate,
        closed: &Closed,
        rule: &StepRule,
        dt: f64,
        q: &[f64],
    ) -> Result<Vec<Sliding>, StepError> {
        let configuration = StepConfiguration { q_n: &self.state.q, q_np1: q, rule: rule.constraint.rule };
        let mut sliding = Vec::new();
        for (c, pair) in self.model.contacts.iter().enumerate() {
            let Some(method) = pair.unilateral().filter(|_| pair.term.has_friction()) else { continue };
            let own: Vec<usize> =
                (0..closed.rows.len()).filter(|&k| closed.slots[k].0 == c && !closed.is_deformable[k]).collect();
            if own.is_empty() {
                continue;
            }
            let way = method.surface_way();
            let mut is_slave = vec![false; self.model.node_count()];
            pair.term.report(q)?.iter().for_each(|report| is_slave[report.node as usize] = true);
            let (pressures, auxiliaries, active) = (&iterate.pressures[c], &iterate.auxiliaries[c], &iterate.active[c]);
            let mut forces = vec![[0.0; 3]; active.len()];
            self.system.shares.visit_all(
                c,
                &*pair.term,
                &configuration.at(pressures, active).with_auxiliaries(auxiliaries),
                &mut |local| {
                    let [slot] = local.slots[..] else { return };
                    let of_slaves = local.nodes.iter().zip(local.residual.chunks_exact(3));
                    for (_, residual) in of_slaves.filter(|(node, _)| is_slave[**node as usize]) {
                        (0..3).for_each(|i| forces[slot as usize][i] -= residual[i]);
                    }
                },
            )?;
            let carrying: Vec<bool> =
                (0..active.len()).map(|slot| own.iter().any(|&k| closed.slots[k].1 == slot)).collect();
            method.constraint_gradients(q, &carrying, &mut |slot, nodes, gradient| {
                let mut normal = [0.0; 3];
                let of_nodes = || nodes.iter().zip(gradient.chunks_exact(3));
                for (_, g) in of_nodes().filter(|(node, _)| is_slave[**node as usize]) {
                    (0..3).for_each(|i| normal[i] += g[i]);
                }
                let weight = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
                let Some(&k) = own.iter().find(|&&k| closed.slots[k].1 == slot) else { return };
                if weight == 0.0 {
                    return;
                }
                let n = normal.map(|x| x / weight);
                let directions = tangents(n);
                let rows = directions.map(|t| {
                    let along = of_nodes().flat_map(|(_, g)| {
                        let part: f64 = (0..3).map(|i| g[i] * n[i]).sum();
                        t.map(|t| part * t)
                    });
                    Row::new(&self.model.embedding, nodes, &along.collect::<Vec<f64>>(), 1.0)
                });
                let carried = directions.map(|t| weight / dt * (0..3).map(|i| t[i] * way[i]).sum::<f64>());
                let slip = [0, 1].map(|i| dt * (rows[i].dot(&self.state.v) - carried[i]) / weight);
                let Some(coefficient) = method.friction_coefficient(slot, pressures[slot], slip) else { return };
                let time = rule.constraint.weight * dt;
                let impulses = directions.map(|t| time / weight * (0..3).map(|i| forces[slot][i] * t[i]).sum::<f64>());
                sliding.push(Sliding { slot: k, rows, coefficient, impulses, carried });
            })?;
        }
        Ok(sliding)
    }
}
