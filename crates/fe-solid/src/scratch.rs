//! Room for the averages at nodes, kept from call to call.

use stoss_term::Local;

/// Room for what a step needs of all elements and nodes.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// Jacobians of each element.
    pub jacobians: Vec<f64>,
    pub pressures: Vec<f64>,
    /// Pressure of each node, and its derivative.
    pub nodal: Vec<(f64, f64)>,
    /// The contribution of a node, and the two vectors that its tangent is the product of.
    pub local: Local,
    pub works: Vec<[f64; 3]>,
    pub changes: Vec<[f64; 3]>,
}

impl Scratch {
    pub fn memory_bytes(&self) -> usize {
        (self.jacobians.capacity() + self.pressures.capacity() + self.local.tangent.capacity()) * size_of::<f64>()
            + self.nodal.capacity() * size_of::<(f64, f64)>()
            + (self.works.capacity() + self.changes.capacity()) * size_of::<[f64; 3]>()
    }
}
