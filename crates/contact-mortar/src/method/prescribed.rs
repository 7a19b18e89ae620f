//! What prescribed motions leave of a pair of surfaces.

use super::MortarContact;

impl MortarContact {
    /// Whether the motion of the whole slave surface along its normals is prescribed: where it has more nodes than the master beside it the pressures are not determined then. `prescribed`: components of a node.
    pub fn is_slave_held_along_normals(&self, prescribed: impl Fn(u32) -> [bool; 3]) -> bool {
        let mut slave_nodes = self.slave().nodes().iter().enumerate();
        slave_nodes.all(|(a, &n)| self.is_held_along_normal(a, prescribed(n)))
    }

    /// Whether one component along the surface is prescribed on all of the slave but not on all of the master: where the slave sticks and is finer there are more tractions than motions of the master then. `prescribed`: components of a
    /// node.
    pub fn is_slave_dragged(&self, prescribed: impl Fn(u32) -> [bool; 3]) -> bool {
        (0..3).any(|i| {
            let alone = |n: u32| std::array::from_fn(|k| k == i && prescribed(n)[k]);
            let mut slave_nodes = self.slave().nodes().iter().enumerate();
            slave_nodes.all(|(a, &n)| self.is_held_across_normal(a, alone(n)))
                && self.master().nodes().iter().any(|&n| !alone(n)[i])
        })
    }
}
