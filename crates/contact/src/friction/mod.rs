//! Friction of one contact point: laws and their time stepping (theory/friction).
//!
//! * [`FrictionLaw`]: the coefficient from pressure, slip, step size and path. The catalogue: [`Coulomb`],
//!   [`StaticDynamic`], [`Regularised`], in the rows [`LAWS`]. A law of one's own implements the trait and needs nothing else;
//! * [`Friction`]: a law with its tangential stiffness, the way stick is enforced and the time stepping; [`Friction::step`] does the
//!   step of one point and says what was stored and what was dissipated;
//! * [`SurfaceVelocity`]: of a master surface that moves along itself;
//! * [`PointIteration`]: what the iterations of a step need to know of a point: reversals of its slip.
//!
//! Vectors have two components in an orthonormal frame of the tangent plane. Tractions point *along the slip of the slave relative
//! to the master*; the traction on the slave is the opposite. Not here: slip and its frame (a contact method's).
//!
//! To add a law: a file beside `coulomb.rs`, a `pub use` here, a row in `registry.rs`; the tests run over the rows.

mod belt;
mod coulomb;
mod defaults;
mod iteration;
mod law;
mod registry;
mod regularised;
mod smooth;
mod static_dynamic;
mod step;

pub use belt::SurfaceVelocity;
pub use coulomb::Coulomb;
pub use iteration::PointIteration;
pub use law::{Coefficient, FrictionLaw, Sliding};
pub use registry::{FrictionEntry, LAWS, entry};
pub use regularised::Regularised;
pub use static_dynamic::StaticDynamic;
pub use step::{Friction, FrictionPoint, FrictionStep, STICK_COMPLIANCE, Stick, stick_compliance};

use crate::ContactError;

/// A parameter in a half-open or open range.
fn check(parameter: &'static str, value: f64, allowed: bool, range: &'static str) -> Result<f64, ContactError> {
    if allowed && value.is_finite() { Ok(value) } else { Err(ContactError::Friction { parameter, value, range }) }
}
