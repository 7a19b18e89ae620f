//! What terms are told when a step begins.

use stoss_integrators::{ForceRule, GradientRule};

/// What a constraint does to a node that it joins, as far as others have to know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// The node is on one of its surfaces. Where surfaces of two constraints meet, one may say again what the other says.
    Surface,
    /// Some of the node's motion is given.
    Partly,
    /// The node's motion follows from that of others: a multiplier of its own would say nothing new.
    Wholly,
}

/// What is known of the motion of nodes without asking the equations: by the prescriptions, ties and contacts that act at present. [`HeldNodes::default`] knows nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HeldNodes {
    /// Whether each component is prescribed.
    prescribed: Vec<bool>,
    /// Whether each node is held wholly; then, in part; then, on a surface.
    wholly: Vec<bool>,
    partly: Vec<bool>,
    on_surface: Vec<bool>,
}

impl HeldNodes {
    /// So many nodes, all of them free.
    pub fn new(nodes: usize) -> Self {
        let free = vec![false; nodes];
        Self { prescribed: vec![false; 3 * nodes], wholly: free.clone(), partly: free.clone(), on_surface: free }
    }

    /// A component of a node is prescribed.
    pub fn prescribe(&mut self, node: u32, component: usize) {
        self.prescribed[3 * node as usize + component] = true;
    }

    /// A constraint that acts holds a node. To be told once for each of its nodes.
    pub fn hold(&mut self, node: u32, how: Hold) {
        let node = node as usize;
        match how {
            Hold::Wholly => self.wholly[node] = true,
            Hold::Partly => self.partly[node] = true,
            Hold::Surface if self.on_surface[node] => self.partly[node] = true,
            Hold::Surface => self.on_surface[node] = true,
        }
    }

    /// Which components of a node are prescribed.
    pub fn prescribed(&self, node: u32) -> [bool; 3] {
        std::array::from_fn(|i| self.prescribed.get(3 * node as usize + i).copied().unwrap_or_default())
    }

    /// Which components of a node are given by something else: prescribed, or all of them if its motion follows from that of others.
    pub fn given(&self, node: u32) -> [bool; 3] {
        if of(&self.wholly, node) { [true; 3] } else { self.prescribed(node) }
    }

    /// Whether something else may determine the motion of a node, or a part of it: a prescription, a support, another contact or tie.
    pub fn may_hold(&self, node: u32) -> bool {
        of(&self.partly, node) || self.prescribed(node).contains(&true)
    }
}

fn of(flags: &[bool], node: u32) -> bool {
    flags.get(node as usize).copied().unwrap_or_default()
}

/// A step as it begins: what is known before any iterate. Positions and velocities have `3 * nodes` entries, node-major.
#[derive(Clone, Copy, Debug)]
pub struct StepContext<'a> {
    /// Positions at the start, a length each.
    pub q_n: &'a [f64],
    /// Velocities there, for methods that look ahead; empty if there is nothing to look ahead to.
    pub v_n: &'a [f64],
    /// Time at the start.
    pub time: f64,
    /// Time at the end.
    pub end: f64,
    /// Size of the step, a time: zero where nothing moves.
    pub dt: f64,
    /// Where the gradients of constraints are taken.
    pub rule: GradientRule,
    /// Where forces are taken.
    pub force: ForceRule,
    /// Whether there is inertia. In statics nothing is viscous, and no energy is at stake.
    pub rates: bool,
    /// Whether the usual iterations of this step failed: weights that only steer them, and that no result depends on, are chosen with care.
    pub careful: bool,
    /// Whether what closes leaves nothing in the velocities that belongs to the step, which a law of impact takes out or surfaces without mass do not have: a gap that closes may then be held where
    /// it is.
    pub impacts: bool,
    /// Largest distance that two surfaces are expected to approach each other: what is farther away needs no partner.
    pub reach: f64,
    /// What acts on nodes beside the one that is told.
    pub held: &'a HeldNodes,
}

/// Nodes that nothing holds.
static FREE: HeldNodes =
    HeldNodes { prescribed: Vec::new(), wholly: Vec::new(), partly: Vec::new(), on_surface: Vec::new() };

impl<'a> StepContext<'a> {
    /// A step with inertia from `q_n`, from the time zero on, of nodes that nothing else holds, with nothing in reach that does not touch, no velocities to look ahead with, and forces at the end. Other values
    /// go before: `StepContext { reach: 0.1, ..StepContext::new(q_n, rule, dt) }`.
    pub fn new(q_n: &'a [f64], rule: GradientRule, dt: f64) -> Self {
        Self {
            q_n,
            v_n: &[],
            time: 0.0,
            end: dt,
            dt,
            rule,
            force: ForceRule::END_POINT,
            rates: true,
            careful: false,
            impacts: false,
            reach: 0.0,
            held: &FREE,
        }
    }

    /// A step of statics: as [`Self::new`], without inertia, at the end point.
    pub fn quasi_static(q_n: &'a [f64], dt: f64) -> Self {
        Self { rates: false, ..Self::new(q_n, GradientRule::EndPoint, dt) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_on_two_surfaces_may_be_held() {
        let mut held = HeldNodes::new(4);
        held.prescribe(3, 1);
        [(0, Hold::Surface), (1, Hold::Surface), (1, Hold::Surface), (2, Hold::Wholly)]
            .into_iter()
            .for_each(|(node, how)| held.hold(node, how));
        assert_eq!([0, 1, 2, 3].map(|node| held.may_hold(node)), [false, true, false, true]);
        assert_eq!(held.given(2), [true; 3]);
        assert_eq!((held.given(3), held.prescribed(3)), ([false, true, false], [false, true, false]));
        // Of nodes beyond those that it was made for nothing is known.
        assert!(!HeldNodes::default().may_hold(7) && HeldNodes::default().given(7) == [false; 3]);
    }
}
