//! Sliding supports: nodes whose displacement is prescribed along a direction, while they slide freely in the plane normal to it. Also symmetry planes in any direction.

use crate::Table;
use stoss_term::{
    At, Bilateral, Fault, Hold, Local, Rule, SlotKind, StepContext, SupportedNode, Term, Undefined, Work,
};

/// Tolerance, as a part of the length scale, of the constraint of a slot without a multiplier.
const MISSED: f64 = 1.0e-6;

/// A sliding support of nodes along the unit vector `d`: `phi = d . (x - X) - u(t) = 0` for each node, with a multiplier that is the force of the ground
/// along `d`.
///
/// The equation is linear, its gradient `d` constant: it is the same under every rule of a scheme, and the work of the force in a step is
/// `lambda d . (x_np1 - x_n) = lambda (u_np1 - u_n)`, thus zero without prescribed motion. Sliding in the plane is free of forces.
#[derive(Clone, Debug, PartialEq)]
pub struct SlidingSupport {
    name: String,
    length: f64,
    direction: [f64; 3],
    /// Global number and `d . X` of each node.
    nodes: Vec<(u32, f64)>,
    displacement: Table,
    times: [f64; 2],
    has_rates: bool,
    is_side: bool,
    /// Forces at the end of the last accepted step, for the work of a motion in statics.
    forces: Vec<f64>,
}

impl SlidingSupport {
    /// A support of nodes with these numbers and `reference` positions (`3 * nodes` of the model), along a `direction` of any length, with the one column of
    /// `displacement` (a length) as a function of time; violations are measured relative to `length`. `None` if the direction is zero or not finite.
    pub fn new(
        name: &str,
        nodes: &[u32],
        direction: [f64; 3],
        displacement: Table,
        reference: &[f64],
        length: f64,
    ) -> Option<Self> {
        // By the largest entry first, so that the squares are finite and not zero.
        let largest = direction.iter().fold(0.0, |largest: f64, d| largest.max(d.abs()));
        if !direction.iter().all(|d| d.is_finite()) || largest == 0.0 || displacement.columns() != 1 {
            return None;
        }
        let direction = direction.map(|d| d / largest);
        let size = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
        let direction = direction.map(|d| d / size);
        let along = |node: u32| (0..3).map(|i| direction[i] * reference[3 * node as usize + i]).sum();
        Some(Self {
            name: name.to_owned(),
            length,
            direction,
            nodes: nodes.iter().map(|&node| (node, along(node))).collect(),
            displacement,
            times: [0.0; 2],
            has_rates: false,
            is_side: false,
            forces: vec![0.0; nodes.len()],
        })
    }

    /// The support as a side of a section, whose forces are no reactions.
    pub fn of_section(self) -> Self {
        Self { is_side: true, ..self }
    }

    /// Whether the prescribed displacement changes with time.
    pub fn moves(&self) -> bool {
        !self.displacement.is_constant()
    }
}

impl Term for SlidingSupport {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length
    }

    fn conserves_linear_momentum(&self) -> bool {
        false
    }

    fn conserves_angular_momentum(&self) -> bool {
        false
    }

    fn slot_count(&self) -> usize {
        self.nodes.len()
    }

    fn slot_weight(&self, _slot: usize) -> f64 {
        1.0
    }

    fn is_symmetric(&self, _rule: Rule) -> bool {
        true
    }

    fn holds(&self, visit: &mut dyn FnMut(u32, Hold)) {
        self.nodes.iter().for_each(|&(node, _)| visit(node, Hold::Partly));
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        (self.times, self.has_rates) = ([step.time, step.end], step.rates);
        Ok(())
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        for (slot, (node, _)) in self.nodes.iter().enumerate().filter(|&(slot, _)| active[slot]) {
            visit(&[*node], &[slot as u32]);
        }
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        if at.rule.constraint().is_none() {
            return Ok(());
        }
        let At { multipliers, active, .. } = *at;
        let moved = self.displacement.value(self.times[1], 0);
        let mut local = Local::default();
        for (slot, &(node, reference)) in self.nodes.iter().enumerate().filter(|&(slot, _)| active[slot]) {
            local.nodes.clear();
            local.nodes.push(node);
            local.slots.clear();
            local.slots.push(slot as u32);
            local.reset(want_tangent);
            let place: f64 = (0..3).map(|i| self.direction[i] * at.q_np1[3 * node as usize + i]).sum();
            local.residual[3] = reference + moved - place;
            for (i, d) in self.direction.into_iter().enumerate() {
                local.residual[i] = -multipliers[slot] * d;
                if want_tangent {
                    local.tangent[4 * i + 3] = -d;
                    local.tangent[12 + i] = -d;
                }
            }
            visit(&local);
        }
        Ok(())
    }

    fn work(&self, at: &At<'_>) -> Result<Work, Fault> {
        let At { multipliers, active, .. } = *at;
        let [from, to] = self.times.map(|time| self.displacement.value(time, 0));
        // Forces of statics are those of the end of a step: their work is that of the trapezium rule.
        let force = |(slot, last): (usize, &f64)| match (active[slot], self.has_rates) {
            (false, _) => 0.0,
            (true, true) => multipliers[slot],
            (true, false) => 0.5 * (multipliers[slot] + last),
        };
        let force: f64 = self.forces.iter().enumerate().map(force).sum();
        Ok(Work { driven: force * (to - from), ..Work::default() })
    }

    fn commit(&mut self, at: &At<'_>) {
        let At { multipliers, active, .. } = *at;
        for ((force, multiplier), active) in self.forces.iter_mut().zip(multipliers).zip(active) {
            *force = if *active { *multiplier } else { 0.0 };
        }
    }

    fn save_history(&self) -> Vec<u8> {
        self.forces.iter().flat_map(|force| force.to_le_bytes()).collect()
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let (numbers, rest) = bytes.as_chunks::<8>();
        if numbers.len() != self.forces.len() || !rest.is_empty() {
            let reason = format!("its history has {} bytes for {} nodes", bytes.len(), self.nodes.len());
            return Err(Fault::other(Undefined { term: self.name.clone(), reason }));
        }
        self.forces = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        Ok(())
    }

    fn bilateral(&self) -> Option<&dyn Bilateral> {
        Some(self)
    }
}

impl Bilateral for SlidingSupport {
    fn slot_kind(&self, _slot: usize) -> SlotKind {
        if self.moves() { SlotKind::Driven } else { SlotKind::Equation }
    }

    fn verify_inactive(&self, q_np1: &[f64], active: &[bool]) -> Result<(), Fault> {
        for (slot, _) in active.iter().enumerate().filter(|(_, active)| !**active) {
            let Some(held) = self.supported_node(slot, self.times[1]) else { continue };
            let missed = (held.place - along(&held, q_np1)).abs();
            if missed.is_nan() || missed > MISSED * self.length {
                let reason = format!(
                    "node {} is {missed:.2e} away from its prescribed position along the normal, because other prescribed motions of the node contradict it; remove one of them, or let them agree",
                    held.node
                );
                return Err(Fault::other(Undefined { term: self.name.clone(), reason }));
            }
        }
        Ok(())
    }

    fn supported_node(&self, slot: usize, time: f64) -> Option<SupportedNode> {
        let &(node, reference) = self.nodes.get(slot)?;
        Some(SupportedNode {
            node,
            direction: self.direction,
            place: reference + self.displacement.value(time, 0),
            rate: self.displacement.slope(time, 0),
            is_side: self.is_side,
        })
    }
}

/// `d . x`.
pub(crate) fn along(held: &SupportedNode, x: &[f64]) -> f64 {
    (0..3).map(|i| held.direction[i] * x[3 * held.node as usize + i]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_term::{GradientRule, StepConfiguration};

    const REFERENCE: [f64; 6] = [0.1, 0.2, 0.3, 1.0, -2.0, 0.5];

    fn support() -> SlidingSupport {
        let table = Table::from_rows(&[vec![0.0, 0.0], vec![2.0, 0.4]], 1).unwrap();
        SlidingSupport::new("cut", &[1, 0], [3.0, 0.0, -4.0], table, &REFERENCE, 1.0).unwrap()
    }

    fn dynamics(dt: f64) -> StepContext<'static> {
        StepContext::new(&REFERENCE, GradientRule::DiscreteGradient, dt)
    }

    fn contributions(support: &SlidingSupport, q: &[f64], multipliers: &[f64]) -> Vec<Local> {
        let mut list = Vec::new();
        let step = StepConfiguration { q_n: &REFERENCE, q_np1: q, rule: GradientRule::DiscreteGradient };
        support.assemble(&step.at(multipliers, &[true; 2]), true, &mut |local| list.push(local.clone())).unwrap();
        list
    }

    /// The tangent is the difference of residuals, which are linear.
    #[test]
    fn the_tangent_is_the_derivative() {
        let mut support = support();
        support.begin(&StepContext { time: 0.5, ..dynamics(1.0) }).unwrap();
        let (q, p) = ([0.3, 0.1, -0.2, 1.4, 0.3, 0.9], [0.7, -1.2]);
        let here = contributions(&support, &q, &p);
        for (k, local) in here.iter().enumerate() {
            for column in 0..4 {
                let (mut q, mut p) = (q, p);
                match column {
                    3 => p[k] += 0.5,
                    i => q[3 * local.nodes[0] as usize + i] += 0.5,
                }
                let moved = &contributions(&support, &q, &p)[k];
                for row in 0..4 {
                    let derivative = (moved.residual[row] - local.residual[row]) / 0.5;
                    assert!((derivative - local.tangent[4 * row + column]).abs() < 1e-14);
                }
            }
        }
    }

    /// A node at its place has no row, forces are along the direction, and their work is that of the motion.
    #[test]
    fn work_is_that_of_the_motion() {
        let mut support = support();
        support.begin(&dynamics(1.0)).unwrap();
        let d = [0.6, 0.0, -0.8];
        let u = 0.2;
        let q: Vec<f64> =
            REFERENCE.iter().enumerate().map(|(c, x)| x + u * d[c % 3] + [0.8, 5.0, 0.6][c % 3]).collect();
        let p = [3.0, -1.0];
        let mut work = 0.0;
        for local in contributions(&support, &q, &p) {
            assert!(local.residual[3].abs() < 1e-15, "{:?}", local.residual);
            let first = 3 * local.nodes[0] as usize;
            work -= (0..3).map(|i| local.residual[i] * (q[first + i] - REFERENCE[first + i])).sum::<f64>();
        }
        let told = support.work(&At::end(&q, &p, &[true; 2])).unwrap().driven;
        assert!((told - 2.0 * u).abs() < 1e-15 && (work - told).abs() < 1e-14, "{told} {work}");
        assert!(support.moves());
        // In statics by the mean of the forces.
        support.begin(&StepContext { rates: false, ..dynamics(1.0) }).unwrap();
        support.commit(&At::end(&q, &[1.0, 1.0], &[true, false]));
        let saved = support.save_history();
        let mut other = self::support();
        other.load_history(&saved).unwrap();
        other.begin(&StepContext { rates: false, ..dynamics(1.0) }).unwrap();
        assert!((other.work(&At::end(&q, &p, &[true; 2])).unwrap().driven - 0.5 * (4.0 - 1.0) * u).abs() < 1e-15);
        assert!(other.load_history(&saved[1..]).is_err());
    }

    #[test]
    fn directions_of_any_length_but_zero() {
        let make = |d| SlidingSupport::new("a", &[0], d, Table::constant(&[0.0]), &REFERENCE, 1.0);
        assert_eq!(make([0.0; 3]), None);
        assert_eq!(make([f64::NAN, 1.0, 0.0]), None);
        assert_eq!(make([1.0, f64::INFINITY, 0.0]), None);
        for size in [1e-300, 1.0, 1e300] {
            let held = make([3.0 * size, 4.0 * size, 0.0]).unwrap().supported_node(0, 0.0).unwrap();
            assert!((held.direction[0] - 0.6).abs() < 1e-15 && (held.direction[1] - 0.8).abs() < 1e-15);
        }
    }
}
