//! Frames: a point and three directions on each side of a joint.

use crate::{Embedded, RigidBody};

/// A point and three directions that are orthonormal in the reference configuration: a joint fixes one frame to another.
///
/// Of a rigid body they are given by [`RigidBody::frame`]; of a node of a beam they are the position and the directors over their length; on the ground they are
/// constants. The first direction is the axis of the joints that have one.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFrame {
    /// The point, a length.
    pub point: Embedded,
    /// The directions, without unit.
    pub axes: [Embedded; 3],
}

impl JointFrame {
    /// A frame that does not move.
    pub fn ground(point: [f64; 3], axes: [[f64; 3]; 3]) -> Self {
        Self { point: Embedded::ground(point), axes: axes.map(Embedded::ground) }
    }
}

impl RigidBody {
    /// The frame of the body that is at `point` with the directions `axes` (one a row) in the reference configuration.
    pub fn frame(&self, point: [f64; 3], axes: [[f64; 3]; 3]) -> JointFrame {
        JointFrame { point: self.point(point), axes: axes.map(|axis| self.direction(axis)) }
    }
}

/// Three orthonormal directions, right-handed, of which the first is along `axis`; `None` if that has no direction.
pub fn axes_along(axis: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    let first = nalgebra::Vector3::from(axis).try_normalize(f64::MIN_POSITIVE)?;
    let mut smallest = nalgebra::Vector3::zeros();
    smallest[first.iamin()] = 1.0;
    let second = first.cross(&smallest).normalize();
    let third = first.cross(&second);
    Some([first, second, third].map(|a| [a.x, a.y, a.z]))
}
