//! What an equation belongs to, for solvers that need to know: not what it means.

/// What an equation of a system belongs to, and where that is: all that a solver by aggregation has to know beyond the matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EquationPlace {
    /// A component of the position of a node of an elastic body.
    Node {
        /// Number of the body. Nodes of different bodies are never put into the same aggregate, whatever couples them.
        body: u32,
        /// Number of the node; equations of one node are neighbours in the numbering.
        node: u32,
        /// 0, 1 or 2.
        component: u8,
        /// Present position of the node (a length); the origin does not matter.
        position: [f64; 3],
    },
    /// The multiplier of a constraint or one of its further unknowns.
    Multiplier {
        /// Number of the pair of surfaces, of the tie, of the joint.
        pair: u32,
        /// Number of the constraint in it; equations of one constraint are neighbours in the numbering.
        slot: u32,
    },
    /// Anything else: vectors of rigid bodies and of beams.
    Other,
}
