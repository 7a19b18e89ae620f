//! Velocities after an impact: those of the step with the impulses of the law in the place of its own, and the energy of each group of slots (theory/impacts#law).

use super::complementarity::{DenseCompliance, OperatorCompliance};
use super::friction::{Cone, with_friction};
use super::groups::{Group, Groups};
use super::law::{EnergyOnLine, Impulses, Rates, impulses};
use super::response::Response;
use super::rows::Row;
use super::sliding::Sliding;
use super::{Closed, RIGID_AT_REST};
use crate::StepError;
use crate::masses::Masses;
use stoss_linalg::NONE;

/// Up to so many slots of a group `W` is computed by its columns, each of which takes a solution; the iteration for more of them takes about as many.
const DENSE_SLOTS: usize = 96;

/// Number of equations up to which a solution costs less than the rest, and the number of slots up to which `W` is then computed by its columns.
const FEW_EQUATIONS: usize = 2000;
const DENSE_SLOTS_OF_FEW: usize = 600;

/// Velocities with the impulses of the rows that made them from those of the step.
#[derive(Clone, Debug)]
pub(super) struct Velocities {
    pub v: Vec<f64>,
    pub slots: Vec<f64>,
    /// Two for each slot with friction.
    pub sliding: Vec<f64>,
    pub held: Vec<f64>,
}

/// Velocities of a group between two states: `from + part (to - from)`.
#[derive(Clone, Copy, Debug)]
struct Mix<'a> {
    from: &'a Velocities,
    to: &'a Velocities,
    part: f64,
}

impl<'a> Mix<'a> {
    fn only(of: &'a Velocities) -> Self {
        Self { from: of, to: of, part: 0.0 }
    }
}

/// A step in which something closed, in the groups on which the law acts.
#[derive(Debug)]
pub(super) struct Event<'a> {
    pub closed: &'a Closed,
    pub sliding: &'a [Sliding],
    pub groups: &'a Groups,
    /// Whether the rate of a bilateral row is prescribed.
    pub is_driven: &'a [bool],
    /// Velocities at the start of the step, and at its end without the law.
    pub v_n: &'a [f64],
    pub v_1: &'a [f64],
    pub masses: &'a Masses,
    /// Components with an equation.
    pub free: &'a [u32],
}

/// Energies of the groups without the work of supports and drives.
#[derive(Debug)]
pub(super) struct Targets {
    /// What the law may leave.
    pub energies: Vec<f64>,
    /// Energy beside these that is round-off.
    pub round_off: Vec<f64>,
}

/// The law on the velocities of an event.
#[derive(Debug)]
pub(super) struct Law<'a> {
    event: &'a Event<'a>,
    response: &'a mut Response,
    /// Kinetic energies and rates of the step.
    first: Vec<f64>,
    rates_1: Vec<f64>,
    sliding_1: Vec<[f64; 2]>,
    held_1: Vec<f64>,
    /// Rates of the slots before.
    before: Vec<f64>,
    of_step: Velocities,
    /// The end of the step without the impulses of the closed slots, on the bilateral constraints.
    free_end: Velocities,
}

fn of_rows(rows: &[Row], v: &[f64]) -> Vec<f64> {
    rows.iter().map(|row| row.dot(v)).collect()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

impl<'a> Law<'a> {
    pub fn new(event: &'a Event<'a>, response: &'a mut Response) -> Result<Self, StepError> {
        let Event { closed, sliding, groups, v_1, .. } = *event;
        let held_1 = of_rows(response.rows(), v_1);
        let m = closed.rows.len();
        let of_step = Velocities {
            v: v_1.to_vec(),
            slots: vec![0.0; m],
            sliding: vec![0.0; 2 * sliding.len()],
            held: vec![0.0; held_1.len()],
        };
        let mut law = Self {
            first: groups.kinetic_energies(event.masses, v_1),
            rates_1: of_rows(&closed.rows, v_1),
            sliding_1: sliding.iter().map(|of| of.rates(v_1)).collect(),
            before: of_rows(&closed.rows, event.v_n),
            free_end: of_step.clone(),
            event,
            response,
            held_1,
            of_step,
        };
        let of_friction = sliding.iter().flat_map(|of| of.impulses);
        let without: Vec<f64> = closed.impulses.iter().copied().chain(of_friction).map(|j| -j).collect();
        let rates = law.held_1.iter().zip(event.is_driven).zip(&groups.of_held);
        let to_constraints: Vec<f64> =
            rates.map(|((rate, driven), &group)| if *driven || group == NONE { 0.0 } else { -rate }).collect();
        let (change, held) = law.solve(&law.force(&without), Some(&to_constraints))?;
        law.free_end =
            Velocities { v: sum(v_1, &change), slots: without[..m].to_vec(), sliding: without[m..].to_vec(), held };
        Ok(law)
    }

    /// Rates of the slots at the start of the step.
    pub fn before(&self) -> &[f64] {
        &self.before
    }

    /// Velocities without the impulses of the closed slots.
    pub fn free_end(&self) -> &Velocities {
        &self.free_end
    }

    /// Kinetic energies of the groups at the end of the step, without the law.
    pub fn first(&self) -> &[f64] {
        &self.first
    }

    fn solve(&mut self, force: &[f64], rate: Option<&[f64]>) -> Result<(Vec<f64>, Vec<f64>), StepError> {
        self.response.velocities((self.event.masses, self.event.free), force, rate)
    }

    /// The rows of slots, then those of their friction.
    fn rows(&self) -> impl Iterator<Item = &'a Row> + use<'a> {
        let Event { closed, sliding, .. } = *self.event;
        closed.rows.iter().chain(sliding.iter().flat_map(|of| &of.rows))
    }

    /// The force of impulses of the slots, and of their friction if there are so many.
    fn force(&self, j: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; self.event.v_1.len()];
        self.rows().zip(j).for_each(|(row, &j)| row.add_to(j, &mut force));
        force
    }

    /// The end of the step with impulses of the slots, and of their friction if there are so many.
    fn with(&mut self, j: &[f64]) -> Result<Velocities, StepError> {
        let (change, held) = self.solve(&self.force(j), None)?;
        let (m, free_end) = (self.before.len(), &self.free_end);
        Ok(Velocities {
            v: sum(&free_end.v, &change),
            slots: sum(&free_end.slots, &j[..m]),
            sliding: match j.len() > m {
                true => sum(&free_end.sliding, &j[m..]),
                false => free_end.sliding.clone(),
            },
            held: sum(&free_end.held, &held),
        })
    }

    /// Columns of `W` between some rows of each group, of all groups at once: what acts in one of them moves nothing in the others.
    fn columns(&mut self, own: &[Vec<usize>]) -> Result<Vec<DenseCompliance>, StepError> {
        let rows: Vec<&Row> = self.rows().collect();
        let mut columns: Vec<Vec<f64>> = own.iter().map(|own| Vec::with_capacity(own.len() * own.len())).collect();
        for k in 0..own.iter().map(Vec::len).max().unwrap_or(0) {
            let mut force = vec![0.0; self.event.v_1.len()];
            own.iter().filter_map(|own| own.get(k)).for_each(|&row| rows[row].add_to(1.0, &mut force));
            let (velocity, _) = self.solve(&force, None)?;
            for (own, columns) in own.iter().zip(&mut columns).filter(|(own, _)| k < own.len()) {
                columns.extend(own.iter().map(|&row| rows[row].dot(&velocity)));
            }
        }
        Ok(own.iter().zip(columns).map(|(own, columns)| DenseCompliance::new(own.len(), columns)).collect())
    }

    /// The impulses of each group without friction.
    fn impulses(&mut self) -> Result<Vec<Impulses>, StepError> {
        let Event { closed, groups, free, .. } = *self.event;
        let is_dense = |group: &Group| {
            let m = group.slots.len();
            m <= DENSE_SLOTS || m <= DENSE_SLOTS_OF_FEW && free.len() <= FEW_EQUATIONS
        };
        let dense = groups.groups.iter().map(|group| if is_dense(group) { group.slots.clone() } else { Vec::new() });
        let dense: Vec<Vec<usize>> = dense.collect();
        let all_free = of_rows(&closed.rows, &self.free_end.v);
        let mut found = Vec::with_capacity(groups.groups.len());
        for (group, mut w) in groups.groups.iter().zip(self.columns(&dense)?) {
            let of = |values: &[f64]| -> Vec<f64> { group.slots.iter().map(|&k| values[k]).collect() };
            // In a step without an impact only what alternates is taken out.
            let restitution = if group.is_new { of(&closed.restitution) } else { vec![0.0; group.slots.len()] };
            let (before, free, least) = (of(&self.before), of(&all_free), of(&closed.settling));
            let rates = Rates { before: &before, free: &free, least: &least, restitution: &restitution };
            found.push(if is_dense(group) {
                let Ok(found) = impulses(&mut w, &rates);
                found
            } else {
                self.impulses_by_products(group, &rates)?
            });
        }
        Ok(found)
    }

    fn impulses_by_products(&mut self, group: &Group, rates: &Rates<'_>) -> Result<Impulses, StepError> {
        let Event { closed, masses, v_1, .. } = *self.event;
        let mass = masses.diagonal(v_1.len());
        let own = |&k: &usize| -> f64 {
            let terms = closed.rows[k].entries.iter().map(|&(c, g)| (mass[c as usize], g * g));
            terms.filter(|(mass, _)| *mass > 0.0).map(|(mass, square)| square / mass).sum()
        };
        let diagonal = group.slots.iter().map(own).collect();
        let mut w = OperatorCompliance::new(diagonal, |j: &[f64], out: &mut [f64]| -> Result<(), StepError> {
            let mut force = vec![0.0; v_1.len()];
            group.slots.iter().zip(j).for_each(|(&k, &j)| closed.rows[k].add_to(j, &mut force));
            let (velocity, _) = self.solve(&force, None)?;
            out.iter_mut().zip(&group.slots).for_each(|(out, &k)| *out = closed.rows[k].dot(&velocity));
            Ok(())
        });
        impulses(&mut w, rates)
    }

    /// Energies of the groups without the work of supports and drives: that of the step, and the work of the impulses since.
    pub fn energies(&self, of: &Velocities) -> Vec<f64> {
        let Event { closed, sliding, groups, is_driven, .. } = *self.event;
        let mut by_sliding = vec![0.0; groups.groups.len()];
        for (k, (own, first)) in sliding.iter().zip(&self.sliding_1).enumerate() {
            let now = own.rates(&of.v);
            let sum = &mut by_sliding[groups.of_slots[own.slot] as usize];
            (0..2).for_each(|i| *sum += of.sliding[2 * k + i] * (first[i] + now[i]));
        }
        let energy = |((group, first), by_sliding): ((&Group, &f64), f64)| {
            let by_slot = |&k: &usize| of.slots[k] * (self.rates_1[k] + closed.rows[k].dot(&of.v));
            let by_slots: f64 = group.slots.iter().map(by_slot).sum();
            let by_row = |&k: &usize| of.held[k] * (self.held_1[k] + self.response.rows()[k].dot(&of.v));
            let by_held: f64 = group.held.iter().filter(|k| !is_driven[**k]).map(by_row).sum();
            first + 0.5 * (by_slots + by_sliding + by_held)
        };
        groups.groups.iter().zip(&self.first).zip(by_sliding).map(energy).collect()
    }

    /// Kinetic energies of the groups with the difference of two velocities.
    fn differences(&self, from: &Velocities, to: &Velocities) -> Vec<f64> {
        let change: Vec<f64> = to.v.iter().zip(&from.v).map(|(to, from)| to - from).collect();
        self.event.groups.kinetic_energies(self.event.masses, &change)
    }

    /// Energies of the groups on the lines between two states.
    fn lines(&self, from: &Velocities, to: &Velocities) -> Vec<EnergyOnLine> {
        let ends = self.energies(from).into_iter().zip(self.energies(to));
        let all = ends.zip(self.differences(from, to));
        all.map(|((start, end), curvature)| EnergyOnLine { start, end, curvature }).collect()
    }

    /// The state with that of each group; what is in no group has that of the step.
    fn mixed(&self, of: &[Mix<'_>]) -> Velocities {
        let Event { sliding, groups, .. } = *self.event;
        let mix = |values: fn(&Velocities) -> &Vec<f64>, group_of: &dyn Fn(usize) -> u32| -> Vec<f64> {
            let own = values(&self.of_step).iter().enumerate();
            own.map(|(k, &of_step)| match of.get(group_of(k) as usize) {
                Some(mix) => values(mix.from)[k] + mix.part * (values(mix.to)[k] - values(mix.from)[k]),
                None => of_step,
            })
            .collect()
        };
        Velocities {
            v: mix(|of| &of.v, &|c| groups.of_component(c)),
            slots: mix(|of| &of.slots, &|k| groups.of_slots[k]),
            sliding: mix(|of| &of.sliding, &|k| groups.of_slots[sliding[k / 2].slot]),
            held: mix(|of| &of.held, &|k| groups.of_held[k]),
        }
    }

    /// The velocities without friction, and the energy of each group that the law would have added.
    pub fn without_friction(&mut self, targets: &Targets) -> Result<(Velocities, Vec<f64>), StepError> {
        let groups = self.event.groups;
        let found = self.impulses()?;
        let all_of = |of: fn(&Impulses) -> &Vec<f64>| -> Vec<f64> {
            let mut all = vec![0.0; self.before.len()];
            for (group, found) in groups.groups.iter().zip(&found) {
                group.slots.iter().zip(of(found)).for_each(|(&k, &j)| all[k] = j);
            }
            all
        };
        let (plastic, elastic) = (all_of(|found| &found.plastic), all_of(|found| &found.all));
        let is_plastic = elastic == plastic;
        let plastic = self.with(&plastic)?;
        let elastic = if is_plastic { plastic.clone() } else { self.with(&elastic)? };
        let of_plastic = self.energies(&plastic);
        let from_step = self.differences(&self.of_step, &plastic);
        let lines = if is_plastic { Vec::new() } else { self.lines(&plastic, &elastic) };
        let mut excess = vec![0.0; found.len()];
        let choose = |g: usize| {
            let target = targets.energies[g];
            if of_plastic[g] > target + targets.round_off[g] {
                // The law may not add energy: as far from the velocities of the step as there is energy.
                excess[g] = of_plastic[g] - target;
                let line = EnergyOnLine { start: self.first[g], end: of_plastic[g], curvature: from_step[g] };
                let part = line.reaches(target).filter(|s| (0.0..=1.0).contains(s)).unwrap_or(line.lowest());
                return Mix { from: &self.of_step, to: &plastic, part };
            }
            if found[g].all == found[g].plastic {
                return Mix::only(&plastic);
            }
            let line = lines[g];
            let part = match found[g].uniform {
                Some(e) => line.reaches(of_plastic[g] + e * e * (target - of_plastic[g])).unwrap_or(1.0),
                None if line.end > target => line.reaches(target).unwrap_or(line.lowest()).min(1.0),
                None => 1.0,
            };
            Mix { from: &plastic, to: &elastic, part }
        };
        let of_groups: Vec<Mix<'_>> = (0..found.len()).map(choose).collect();
        let last = self.mixed(&of_groups);
        Ok((last, excess))
    }

    /// The velocities with friction: normal rates of `last`, which the law without friction gives, are those of the law with it, and impulses of both are found together.
    pub fn with_friction(
        &mut self,
        last: Velocities,
        targets: &Targets,
        excess: &mut [f64],
    ) -> Result<Velocities, StepError> {
        let Event { closed, sliding, groups, .. } = *self.event;
        if sliding.is_empty() {
            return Ok(last);
        }
        let cones = self.cones()?;
        let start = sum(&last.slots, &closed.impulses);
        let rates = of_rows(&closed.rows, &last.v);
        let mut least = closed.settling.clone();
        for group in &groups.groups {
            let largest = group.slots.iter().map(|&k| start[k]).fold(0.0, f64::max);
            let presses = group.slots.iter().filter(|k| start[**k] > RIGID_AT_REST * largest);
            presses.for_each(|&k| least[k] = rates[k]);
        }
        let found = self.in_cones(&cones, &least, &start)?;
        let energies = self.energies(&found);
        let has_friction: Vec<bool> = cones.iter().map(|of| !of.sliding.is_empty()).collect();
        let exceeds = |energies: &[f64], g: usize| energies[g] > targets.energies[g] + targets.round_off[g];
        let mut of_groups: Vec<Mix<'_>> =
            has_friction.iter().map(|has| Mix::only(if *has { &found } else { &last })).collect();
        let adding: Vec<usize> = (0..of_groups.len()).filter(|&g| has_friction[g] && exceeds(&energies, g)).collect();
        if adding.is_empty() {
            return Ok(self.mixed(&of_groups));
        }
        // Newton's restitution at single slots can add energy: as far from the result without it as there is some.
        let plastic = self.in_cones(&cones, &closed.settling, &start)?;
        let of_plastic = self.energies(&plastic);
        let (to_found, from_step) = (self.lines(&plastic, &found), self.lines(&self.of_step, &plastic));
        for g in adding {
            let target = targets.energies[g];
            let reaches = |line: &EnergyOnLine| line.reaches(target).filter(|s| (0.0..=1.0).contains(s));
            of_groups[g] = if exceeds(&of_plastic, g) {
                excess[g] += of_plastic[g] - target;
                let part = reaches(&from_step[g]).unwrap_or(from_step[g].lowest());
                Mix { from: &self.of_step, to: &plastic, part }
            } else {
                Mix { from: &plastic, to: &found, part: reaches(&to_found[g]).unwrap_or(0.0) }
            };
        }
        Ok(self.mixed(&of_groups))
    }

    /// Slots and friction of each group that has some.
    fn cones(&mut self) -> Result<Vec<OfGroup>, StepError> {
        let Event { closed, sliding, groups, .. } = *self.event;
        let m = closed.rows.len();
        let mut rows: Vec<Vec<usize>> = groups.groups.iter().map(|group| group.slots.clone()).collect();
        let mut coefficients = vec![Vec::new(); rows.len()];
        for (k, of) in sliding.iter().enumerate() {
            let group = groups.of_slots[of.slot] as usize;
            // Places of slots among those of the group, in front of friction.
            if let Ok(place) = groups.groups[group].slots.binary_search(&of.slot) {
                coefficients[group].push((place, of.coefficient));
                rows[group].extend([m + 2 * k, m + 2 * k + 1]);
            }
        }
        rows.iter_mut().zip(&coefficients).filter(|(_, of)| of.is_empty()).for_each(|(rows, _)| rows.clear());
        let compliances = self.columns(&rows)?;
        let all = rows.into_iter().zip(compliances).zip(coefficients);
        Ok(all.map(|((rows, compliance), sliding)| OfGroup { rows, compliance, sliding }).collect())
    }

    /// The velocities with friction in the groups that have some, and at least the rates `least` of the slots; `start` has impulses of the slots to start from.
    fn in_cones(&mut self, cones: &[OfGroup], least: &[f64], start: &[f64]) -> Result<Velocities, StepError> {
        let Event { closed, sliding, .. } = *self.event;
        let mut free = of_rows(&closed.rows, &self.free_end.v);
        free.extend(sliding.iter().flat_map(|of| of.rates(&self.free_end.v)));
        let mut j = vec![0.0; free.len()];
        for of in cones.iter().filter(|of| !of.sliding.is_empty()) {
            let slots = &of.rows[..of.rows.len() - 2 * of.sliding.len()];
            let least: Vec<f64> = slots.iter().map(|&k| least[k]).collect();
            let own_free: Vec<f64> = of.rows.iter().map(|&k| free[k]).collect();
            let cone = Cone { least: &least, free: &own_free, sliding: &of.sliding };
            let start: Vec<f64> = of.rows.iter().map(|&k| start.get(k).copied().unwrap_or(0.0)).collect();
            let found = with_friction(&of.compliance, &cone, &start);
            of.rows.iter().zip(found).for_each(|(&k, found)| j[k] = found);
        }
        self.with(&j)
    }
}

/// Rows of slots and of their friction in a group, and what the cones of friction need of them.
#[derive(Debug)]
struct OfGroup {
    rows: Vec<usize>,
    compliance: DenseCompliance,
    /// Places of slots, and coefficients of friction.
    sliding: Vec<(usize, f64)>,
}
