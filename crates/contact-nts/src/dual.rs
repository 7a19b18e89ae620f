//! Dual numbers over the positions of one contact element, or the five vectors that friction depends on.

use crate::kinematics::LOCAL;
pub(crate) use stoss_contact::dual::Scalar;

pub(crate) type Dual = stoss_contact::dual::Dual<LOCAL>;
