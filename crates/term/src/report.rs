//! What terms report at the end of a step.

/// What a slot did at the end of a step, for output (signs: theory/node-to-surface#eq-gap).
#[derive(Clone, Debug, PartialEq)]
pub struct SlotReport {
    /// Global slave node.
    pub node: u32,
    /// Reference area of the slave node.
    pub weight: f64,
    /// Factor by which the slot's pressure becomes a force per area of the given configuration: 1 where it is one already, reference area over
    /// current area where it is one per reference area.
    pub per_current_area: f64,
    /// Area over which the pressure acts in the given configuration: the node's share of the current slave surface, with mortar contact of what of it lies
    /// opposite the master; zero if nothing does.
    pub area: f64,
    /// True gap at the given configuration; `None` if no master is within reach.
    pub gap: Option<f64>,
    /// Unit normal, master to slave (zero if there is none).
    pub normal: [f64; 3],
    /// Which geometric case the projection was ("face", "edge", "vertex", "none").
    pub feature: &'static str,
    /// Gap that a closed slot keeps: zero, but for constraints that keep a gap, and `gap` itself where the constraint gives way.
    pub reference_gap: f64,
    /// Friction in the last accepted step of this session; `None` without friction and for open slots.
    pub friction: Option<SlotFriction>,
    /// Slots and weights, which add up to one, whose mean is shown as the pressure at the node; empty: that of the slot itself.
    pub means: Vec<(u32, f64)>,
}

impl SlotReport {
    /// The value to be shown at the node per current area, of values of the equations (pressures, sizes of tractions) by slots. `slot` is its own.
    pub fn shown(&self, slot: usize, of: impl Fn(usize) -> f64) -> f64 {
        let value = match self.means.as_slice() {
            [] => of(slot),
            means => means.iter().map(|&(slot, weight)| weight * of(slot as usize)).sum(),
        };
        value * self.per_current_area
    }
}

/// Friction of a slot in an accepted step, in components of an orthonormal frame of the tangent plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlotFriction {
    /// Traction in the equations, along the slip.
    pub traction: [f64; 2],
    /// Slip of the slave in the step that springs do not take up, a length.
    pub slip: [f64; 2],
    /// Largest traction that the law admits.
    pub bound: f64,
    /// True if nothing slides.
    pub sticks: bool,
}

/// What a joint does at the end of a step, for output.
#[derive(Clone, Debug, PartialEq)]
pub struct JointReport {
    /// Force of the first side on the second.
    pub force: [f64; 3],
    /// Moment of the first side on the second about the joint's point on the second.
    pub moment: [f64; 3],
    /// Vector from the joint's point on the first side to that on the second.
    pub arm: [f64; 3],
    /// Angles and displacements that the joint leaves free and that can be measured.
    pub coordinates: Vec<JointCoordinate>,
}

/// A coordinate of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointCoordinate {
    /// Angle (radians, followed over turns) or displacement.
    pub value: f64,
    /// Whether it is an angle.
    pub is_angle: bool,
    /// What acts along the coordinate.
    pub torques: JointTorques,
}

/// Torques (along an angle) or forces (along a displacement) that act on the second side of a joint along its coordinate; zero without such a thing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointTorques {
    /// Torque or force of Coulomb friction.
    pub friction: f64,
    /// Torque or force of viscous friction, in the last step.
    pub viscous: f64,
    /// Torque or force of the spring, at the end of the step.
    pub spring: f64,
    /// Torque or force of the motor or the pretension.
    pub motor: f64,
    /// Torque or force of the limits.
    pub limit: f64,
}

/// A node whose motion along a direction a sliding support prescribes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportedNode {
    /// Global number of the node.
    pub node: u32,
    /// The direction, of length one.
    pub direction: [f64; 3],
    /// What `direction . x` of its position has to be, a length.
    pub place: f64,
    /// Rate of `place` just after the time, a length per time.
    pub rate: f64,
    /// Whether it is a side of a section: what lies behind is modelled no less than the node, and the force is no reaction.
    pub is_side: bool,
}

/// How the surfaces of a discretisation are covered by what it integrates over.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Defect of the invariant, round-off: of mortar contact the largest part of a slave facet that lies opposite the master and has no
    /// segment, or has two.
    pub defect: f64,
}

/// Energies of a term in a step, as far as they are its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// Energy stored at the end of the step.
    pub stored: f64,
    /// Energy dissipated in the step.
    pub dissipated: f64,
    /// The part of `stored` that is in tangential springs.
    pub friction_stored: f64,
    /// Work of the slip against the friction in the step, what friction takes out of the bodies. It is measured with force and slip: what it differs from
    /// the change of `friction_stored` and `dissipated` is what the iteration left.
    pub friction_work: f64,
    /// The part of `dissipated` that viscous normal forces took.
    pub damped: f64,
    /// What closing gaps cost in the step by the constraints themselves, `sum p (Phi(q_n) - Phi(q_np1))` over the closed slots: what the normal forces take from
    /// the bodies if they do the work of the gaps. `None` if the method does not tell.
    pub closing: Option<f64>,
    /// Work done in the step by constraints that depend on time: drives.
    pub driven: f64,
    /// What of `stored` and `dissipated` a material with history has.
    pub material: MaterialWork,
}

/// Energies of a material with history in a step: parts of what it stores and dissipates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaterialWork {
    /// Stored by hardening at the end of the step.
    pub hardening: f64,
    /// Dissipated in the step by plastic flow.
    pub plastic: f64,
    /// Dissipated in the step by viscous flow.
    pub viscous: f64,
    /// Dissipated in the step by softening.
    pub softening: f64,
    /// Largest increment of the equivalent plastic strain of a point in the step, a number and no energy: of a sum the largest of all.
    pub flow: f64,
}

impl std::ops::AddAssign for MaterialWork {
    fn add_assign(&mut self, other: Self) {
        self.hardening += other.hardening;
        self.plastic += other.plastic;
        self.viscous += other.viscous;
        self.softening += other.softening;
        self.flow = self.flow.max(other.flow);
    }
}

impl Default for Work {
    fn default() -> Self {
        Self {
            stored: 0.0,
            dissipated: 0.0,
            friction_stored: 0.0,
            friction_work: 0.0,
            damped: 0.0,
            closing: Some(0.0),
            driven: 0.0,
            material: MaterialWork::default(),
        }
    }
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.stored += other.stored;
        self.dissipated += other.dissipated;
        self.friction_stored += other.friction_stored;
        self.friction_work += other.friction_work;
        self.damped += other.damped;
        self.driven += other.driven;
        self.material += other.material;
        self.closing = self.closing.zip(other.closing).map(|(a, b)| a + b);
    }
}
