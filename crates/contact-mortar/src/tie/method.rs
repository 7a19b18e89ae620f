//! The tie as a contact discretisation whose slots do not open by themselves.

use super::frame::{FrameAndGap, response};
use super::{MeshTie, Slot, TiedNode};
use nalgebra::Vector3;
use stoss_contact::ContactError;
use stoss_term::{
    At, Bilateral, Fault, GradientRule, Hold, Local, Rule, SlotReport, StepConfiguration, StepContext, Term,
};

impl TiedNode {
    pub(super) fn traction(&self, q: &[f64], multipliers: &[f64]) -> [f64; 3] {
        let lambda = self.multipliers(multipliers);
        match &self.frame {
            None => lambda,
            Some(frame) => {
                let FrameAndGap { b: [b1, b2], .. } = frame.at(q);
                (b1 * lambda[0] + b2 * lambda[1] + b1.cross(&b2) * lambda[2]).into()
            }
        }
    }

    /// Multipliers by component, zero where there is none.
    fn multipliers(&self, all: &[f64]) -> [f64; 3] {
        let mut slots = self.slots.iter();
        std::array::from_fn(|i| if self.row.kept[i] { slots.next().map_or(0.0, |&s| all[s as usize]) } else { 0.0 })
    }

    /// Contributions of a node with spatial axes: one for each of its entries, so that the matrix couples no nodes. The
    /// first has the whole value of the constraints.
    fn assemble_constant(
        &self,
        q_np1: &[f64],
        multipliers: &[f64],
        want_tangent: bool,
        local: &mut Local,
        visit: &mut (dyn FnMut(&Local) + Send),
    ) {
        let lambda = self.multipliers(multipliers);
        local.slots.clone_from(&self.slots);
        let gap = self.row.gap(q_np1);
        for (k, entry) in self.row.entries.iter().enumerate() {
            local.nodes.clear();
            local.nodes.push(entry.node);
            local.reset(want_tangent);
            let dim = local.dim();
            let mut slot = 3;
            for i in 0..3 {
                local.residual[i] = -entry.coefficients[i] * lambda[i];
                if !self.row.kept[i] {
                    continue;
                }
                if k == 0 {
                    local.residual[slot] = self.target[i] - gap[i];
                }
                if want_tangent {
                    local.tangent[i * dim + slot] = -entry.coefficients[i];
                    local.tangent[slot * dim + i] = -entry.coefficients[i];
                }
                slot += 1;
            }
            visit(local);
        }
    }
}

impl MeshTie {
    /// Nodes that are not released; the slots of a node go together.
    fn holding<'a>(&'a self, active: &'a [bool]) -> impl Iterator<Item = &'a TiedNode> {
        self.nodes.iter().filter(|node| node.slots.iter().any(|&slot| active[slot as usize]))
    }

    /// Nodes and slots of the contributions, in their order.
    fn for_each_stencil(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let mut nodes = Vec::new();
        for node in self.holding(active) {
            match &node.frame {
                None => node.row.entries.iter().for_each(|entry| visit(&[entry.node], &node.slots)),
                Some(frame) => {
                    nodes.clear();
                    nodes.extend(frame.entries.iter().map(|e| e.0));
                    visit(&nodes, &node.slots);
                }
            }
        }
    }
}

impl Bilateral for MeshTie {
    fn holds_surfaces_together(&self) -> bool {
        true
    }
}

impl Term for MeshTie {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.length_scale
    }

    /// Constraints along spatial axes do not turn with the bodies.
    fn conserves_angular_momentum(&self) -> bool {
        self.nodes.iter().all(|node| node.frame.is_some())
    }

    fn slot_count(&self) -> usize {
        self.slots.len()
    }

    fn slot_weight(&self, slot: usize) -> f64 {
        self.slots[slot].weight
    }

    /// Whether the tangent is symmetric: with spatial axes constraints are linear, whatever the rule.
    fn is_symmetric(&self, rule: Rule) -> bool {
        rule == Rule::Constraint(GradientRule::EndPoint) || self.nodes.iter().all(|node| node.frame.is_none())
    }

    /// Where the rows are others, slots that have none do not act: stencils leave them out.
    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        self.follow_support(step.held);
        Ok(())
    }

    fn holds(&self, visit: &mut dyn FnMut(u32, Hold)) {
        self.surfaces.iter().for_each(|&node| visit(node, Hold::Surface));
        self.tied_nodes().for_each(|node| visit(node, Hold::Wholly));
    }

    fn stencils(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        self.for_each_stencil(active, visit);
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(step) = StepConfiguration::of(at) else { return Ok(()) };
        let At { multipliers: pressures, active, .. } = *at;
        let mut local = Local::default();
        for node in self.holding(active) {
            let Some(frame) = &node.frame else {
                node.assemble_constant(step.q_np1, pressures, want_tangent, &mut local, visit);
                continue;
            };
            let lambda = node.multipliers(pressures);
            let (z0, z1) = (frame.at(step.q_n), frame.at(step.q_np1));
            let Some(r) = response(&z0, &z1, &lambda, step.rule, want_tangent) else {
                return Err(ContactError::Frame { node: node.row.node }.into());
            };
            local.nodes.clear();
            local.nodes.extend(frame.entries.iter().map(|e| e.0));
            local.slots.clone_from(&node.slots);
            local.reset(want_tangent);
            let (dim, first) = (local.dim(), 3 * local.nodes.len());
            let force = r.rule[0] * lambda[0] + r.rule[1] * lambda[1] + r.rule[2] * lambda[2];
            for a in 0..3 {
                local.residual[first + a] = node.target[a] - r.values[a];
            }
            for (j, (_, beta, gamma)) in frame.entries.iter().enumerate() {
                for i in 0..3 {
                    // Rows of the nine numbers that depend on this component.
                    let by = [(i, beta[0]), (3 + i, beta[1]), (6 + i, gamma[i])];
                    let row = 3 * j + i;
                    local.residual[row] = -by.iter().map(|&(k, c)| c * force[k]).sum::<f64>();
                    if !want_tangent {
                        continue;
                    }
                    for a in 0..3 {
                        local.tangent[row * dim + first + a] = -by.iter().map(|&(k, c)| c * r.rule[a][k]).sum::<f64>();
                        local.tangent[(first + a) * dim + row] = -by.iter().map(|&(k, c)| c * r.end[a][k]).sum::<f64>();
                    }
                    let h: [f64; 9] =
                        std::array::from_fn(|l| by.iter().map(|&(k, c)| c * r.derivative[(k, l)]).sum::<f64>());
                    for (m, (_, beta, gamma)) in frame.entries.iter().enumerate() {
                        for n in 0..3 {
                            local.tangent[row * dim + 3 * m + n] =
                                -(h[n] * beta[0] + h[3 + n] * beta[1] + h[6 + n] * gamma[n]);
                        }
                    }
                }
            }
            visit(&local);
        }
        Ok(())
    }

    fn report(&self, _: &[f64]) -> Result<Vec<SlotReport>, Fault> {
        let report = |&Slot { node, component, weight }: &Slot| {
            let normal = Vector3::ith(usize::from(component), 1.0).into();
            SlotReport {
                node,
                weight,
                means: Vec::new(),
                per_current_area: 1.0,
                area: weight,
                gap: None,
                normal,
                feature: "tied",
                reference_gap: 0.0,
                friction: None,
            }
        };
        Ok(self.slots.iter().map(report).collect())
    }

    fn bilateral(&self) -> Option<&dyn Bilateral> {
        Some(self)
    }
}
