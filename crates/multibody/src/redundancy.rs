//! Which equations of joints follow from others, and which contradict them.
//!
//! The Jacobian of all bilateral equations with respect to the free components is brought to echelon form row by row, each row with its largest entry as the pivot (Golub and Van
//! Loan, *Matrix Computations*, section 3.4: column pivoting); rows are sparse, so bodies that are not connected do not see each other. A row of which nothing is left follows from
//! those before it. Its value at the configuration, less the same combination of theirs, must vanish then.

use crate::{ConstraintSet, Joint, LinearEquations};
use std::collections::BTreeMap;
use stoss_term::{Fault, GradientRule, StepConfiguration, Term};

/// A row counts as zero if its entries fell below this part of its largest entry before the elimination.
const TOLERANCE: f64 = 1e-8;

/// An equation contradicts others if the rest of its value exceeds this part of the length scale of its set.
const CONTRADICTION: f64 = 1e-6;

/// Constraints that hold as equations.
pub trait Equations: Term {
    /// Whether the slot is an equation between positions at all times: not that of friction or of a limit.
    fn is_equation(&self, slot: usize) -> bool;
    /// Whether it is the rigidity of a body: in a redundant system the other sets are reported, not these.
    fn is_rigidity(&self) -> bool {
        false
    }
    /// Whether the slot is an equation that depends on time.
    fn moves_by_itself(&self, _slot: usize) -> bool {
        false
    }
    /// Kind for messages, for instance "hinge".
    fn kind_name(&self) -> &str;
}

impl Equations for ConstraintSet {
    fn is_equation(&self, _slot: usize) -> bool {
        true
    }

    fn is_rigidity(&self) -> bool {
        ConstraintSet::is_rigidity(self)
    }

    fn kind_name(&self) -> &str {
        if ConstraintSet::is_rigidity(self) { "rigidity" } else { "coupling" }
    }
}

impl Equations for Joint {
    fn is_equation(&self, slot: usize) -> bool {
        slot < self.kind().equations() || self.is_motor_slot(slot)
    }

    fn moves_by_itself(&self, slot: usize) -> bool {
        self.is_motor_slot(slot)
    }

    fn kind_name(&self) -> &str {
        self.kind().name()
    }
}

impl Equations for LinearEquations {
    fn is_equation(&self, _slot: usize) -> bool {
        true
    }

    fn moves_by_itself(&self, _slot: usize) -> bool {
        self.moves()
    }

    fn kind_name(&self) -> &str {
        "equation"
    }
}

/// What [`analyse`] found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Redundancy {
    /// Number of equations.
    pub equations: usize,
    /// Number of independent equations.
    pub rank: usize,
    /// Set and slot of the redundant ones.
    pub redundant: Vec<(usize, usize)>,
    /// Sets without rigidity in parts of the system that are connected and have redundant equations: of these the multipliers are not determined, and all are to be made
    /// compliant ([`Joint::set_redundant`], [`ConstraintSet::set_redundant`], [`LinearEquations::set_redundant`]).
    pub involved: Vec<usize>,
    /// Messages, one for each set with redundant equations.
    pub messages: Vec<String>,
}

/// Why the redundancy of a system of equations cannot be resolved.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RedundancyError {
    /// An equation contradicts others.
    #[error("{kind} {name}: equation {equation} is redundant and contradicts the others, by {value:e}")]
    Contradiction {
        /// Name of the set.
        name: String,
        /// Kind of the set.
        kind: String,
        /// Slot of the set, from one.
        equation: usize,
        /// Rest of its value after elimination, a length.
        value: f64,
    },
    /// A set cannot be evaluated.
    #[error(transparent)]
    Evaluation(#[from] Fault),
}

#[derive(Debug)]
struct Row {
    set: usize,
    slot: usize,
    /// Component and entry, in the order of the components.
    entries: Vec<(u32, f64)>,
    value: f64,
    size: f64,
}

/// Ranks the equations of all sets in the configuration `q`; `is_free` tells of a component (`3 * vector + i`) whether it can move. Sets come in the order of their precedence: rigidity first, so that
/// joints are named.
///
/// # Errors
/// [`RedundancyError::Contradiction`] for equations that follow from others and whose value does not: motors that disagree, a loop that does not close.
pub fn analyse(
    sets: &[&dyn Equations],
    q: &[f64],
    is_free: impl Fn(u32) -> bool + Sync,
) -> Result<Redundancy, RedundancyError> {
    let mut connected = Connected::default();
    let mut rows = Vec::new();
    for (set, constraint) in sets.iter().enumerate() {
        collect(set, *constraint, q, &is_free, &mut rows, &mut connected)?;
    }
    let mut found = Redundancy { equations: rows.len(), ..Redundancy::default() };
    // Rows in echelon form by the component of their pivot.
    let mut pivots: BTreeMap<u32, Row> = BTreeMap::new();
    let mut order: BTreeMap<u32, usize> = BTreeMap::new();
    let mut work = vec![0.0; q.len()];
    let mut loose = Vec::new();
    for row in rows {
        let (set, slot, has_free) = (row.set, row.slot, !row.entries.is_empty());
        match eliminate(row, &pivots, &order, &mut work) {
            (row, Some(pivot)) => {
                order.insert(pivot, order.len());
                pivots.insert(pivot, row);
                found.rank += 1;
            }
            (row, None) => {
                if row.value.abs() > CONTRADICTION * sets[set].length_scale() * sets[set].slot_weight(slot) {
                    return Err(RedundancyError::Contradiction {
                        name: sets[set].name().to_owned(),
                        kind: sets[set].kind_name().to_owned(),
                        equation: slot + 1,
                        value: row.value,
                    });
                }
                // Between components that cannot move there is nothing to solve for, and nothing that follows from others.
                if has_free {
                    found.redundant.push((set, slot));
                    loose.push(set);
                }
            }
        }
    }
    let groups: Vec<usize> = loose.iter().filter_map(|&set| connected.group_of(set)).collect();
    found.involved = (0..sets.len())
        .filter(|&set| !sets[set].is_rigidity())
        .filter(|&set| loose.contains(&set) || connected.group_of(set).is_some_and(|group| groups.contains(&group)))
        .collect();
    loose.dedup();
    for set in loose {
        let count = found.redundant.iter().filter(|(s, _)| *s == set).count();
        let all = (0..sets[set].slot_count()).filter(|&slot| sets[set].is_equation(slot)).count();
        let (kind, name) = (sets[set].kind_name(), sets[set].name());
        let verb = if count == 1 { "follows" } else { "follow" };
        found.messages.push(format!("{kind} {name}: {count} of its {all} equations {verb} from others"));
    }
    Ok(found)
}

/// Largest speed at which velocities `v` violate the equations of a set at `q`, a length over time; those of motors, which move by themselves, are left out.
///
/// # Errors
/// If the set cannot be evaluated.
pub fn velocity_violation(set: &dyn Equations, q: &[f64], v: &[f64]) -> Result<f64, Fault> {
    let slots = set.slot_count();
    let (multipliers, active) = (vec![0.0; slots], (0..slots).map(|s| set.is_equation(s)).collect::<Vec<_>>());
    let step = StepConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
    let mut largest = 0.0_f64;
    set.assemble(&step.at(&multipliers, &active), true, &mut |local| {
        let (n, dim) = (3 * local.nodes.len(), local.dim());
        for (k, _) in local.slots.iter().enumerate().filter(|(_, slot)| !set.moves_by_itself(**slot as usize)) {
            let row = &local.tangent[(n + k) * dim..(n + k) * dim + n];
            let rate: f64 = row.iter().enumerate().map(|(i, g)| g * v[3 * local.nodes[i / 3] as usize + i % 3]).sum();
            largest = largest.max(rate.abs());
        }
    })?;
    Ok(largest)
}

/// Rows of a set: gradients at `q`, values.
fn collect(
    set: usize,
    constraint: &dyn Equations,
    q: &[f64],
    is_free: &(impl Fn(u32) -> bool + Sync),
    rows: &mut Vec<Row>,
    connected: &mut Connected,
) -> Result<(), Fault> {
    let slots = constraint.slot_count();
    let (multipliers, active) = (vec![0.0; slots], (0..slots).map(|s| constraint.is_equation(s)).collect::<Vec<_>>());
    let step = StepConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
    constraint.assemble(&step.at(&multipliers, &active), true, &mut |local| {
        let (n, dim) = (3 * local.nodes.len(), local.dim());
        let component = |i: usize| 3 * local.nodes[i / 3] + (i % 3) as u32;
        connected.join(set, (0..n).map(component).filter(|&c| is_free(c)).map(|c| c / 3));
        for (k, &slot) in local.slots.iter().enumerate() {
            let row = &local.tangent[(n + k) * dim..(n + k) * dim + n];
            let mut entries: Vec<(u32, f64)> =
                row.iter().enumerate().filter(|(_, e)| **e != 0.0).map(|(i, &e)| (component(i), e)).collect();
            let size = entries.iter().fold(0.0, |m: f64, (_, e)| m.max(e.abs()));
            entries.retain(|&(c, _)| is_free(c));
            entries.sort_by_key(|&(c, _)| c);
            rows.push(Row { set, slot: slot as usize, entries, value: local.residual[n + k], size });
        }
    })
}

/// The row less what pivots have of it, and the component of its own pivot.
fn eliminate(
    mut row: Row,
    pivots: &BTreeMap<u32, Row>,
    order: &BTreeMap<u32, usize>,
    work: &mut [f64],
) -> (Row, Option<u32>) {
    // Components by the order in which they became pivots, those still to be eliminated; others in `touched`.
    let mut queue: BTreeMap<usize, u32> = BTreeMap::new();
    let mut touched: Vec<u32> = Vec::new();
    let touch = |component: u32, touched: &mut Vec<u32>, queue: &mut BTreeMap<usize, u32>| match order.get(&component) {
        Some(&at) => {
            queue.insert(at, component);
        }
        None => touched.push(component),
    };
    for &(component, entry) in &row.entries {
        work[component as usize] = entry;
        touch(component, &mut touched, &mut queue);
    }
    while let Some((_, component)) = queue.pop_first() {
        let entry = std::mem::take(&mut work[component as usize]);
        let Some(pivot) = pivots.get(&component).filter(|_| entry != 0.0) else { continue };
        let Some(&(_, own)) = pivot.entries.iter().find(|(c, _)| *c == component) else { continue };
        let factor = entry / own;
        row.value -= factor * pivot.value;
        for &(other, e) in pivot.entries.iter().filter(|(c, _)| *c != component) {
            if work[other as usize] == 0.0 {
                touch(other, &mut touched, &mut queue);
            }
            work[other as usize] -= factor * e;
        }
    }
    touched.sort_unstable();
    touched.dedup();
    let smallest = TOLERANCE * row.size;
    let mut largest: Option<(u32, f64)> = None;
    row.entries.clear();
    for component in touched {
        let entry = std::mem::take(&mut work[component as usize]);
        // Round-off would fill the rows.
        if entry.abs() <= 1e-4 * smallest {
            continue;
        }
        row.entries.push((component, entry));
        if entry.abs() > largest.map_or(smallest, |(_, e)| e) {
            largest = Some((component, entry.abs()));
        }
    }
    (row, largest.map(|(component, _)| component))
}

/// Sets that share a vector, directly or by way of others.
#[derive(Debug, Default)]
struct Connected {
    parent: BTreeMap<u32, u32>,
    of: BTreeMap<usize, u32>,
}

impl Connected {
    fn root(&self, mut vector: u32) -> u32 {
        while let Some(&parent) = self.parent.get(&vector) {
            if parent == vector {
                break;
            }
            vector = parent;
        }
        vector
    }

    fn join(&mut self, set: usize, vectors: impl Iterator<Item = u32>) {
        for vector in vectors {
            self.parent.entry(vector).or_insert(vector);
            let own = self.root(vector);
            let first = *self.of.entry(set).or_insert(own);
            let root = self.root(first);
            let (low, high) = (own.min(root), own.max(root));
            self.parent.insert(high, low);
        }
    }

    fn group_of(&self, set: usize) -> Option<usize> {
        self.of.get(&set).map(|&vector| self.root(vector) as usize)
    }
}
