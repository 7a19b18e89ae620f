//! The step of one contact point by return mapping (theory/friction#step).

use super::belt::SurfaceVelocity;
use super::check;
use super::law::{Bound, FrictionLaw, Plane, Sliding, Traction, along_slip, return_to_bound};
use super::smooth::smoothed_return;
use crate::ContactError;
use std::sync::Arc;
use stoss_term::{SlotFriction, StepContext};

/// Enforcement of stick at a point of a slave: by a spring or multipliers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stick {
    /// A spring of the tangential stiffness between slave and master, which stores energy and lets a sticking point move by traction over
    /// stiffness, no farther: no creep.
    #[default]
    Penalty,
    /// Two multipliers a point, unknowns of the step beside its pressure: the traction `t` is that for which `t = return(t + stiffness slip)`, so
    /// that the slip of a sticking point is zero and the traction of a sliding one is the law's. Solved together with all other equations by one
    /// (semi-smooth) Newton method. The tangential stiffness weighs traction against slip in the decision between the two; no result depends on it.
    Multiplier,
}

/// Compliance of the stick of multipliers, in multiples of one over the tangential stiffness, where supports or other contacts may hold a
/// node already: rows that contradict nothing but repeat what others say would make the equations singular. It keeps the condition below that of
/// the rest; slips of such nodes are a hundred-millionth of those of springs.
pub const STICK_COMPLIANCE: f64 = 1.0e-8;

/// Compliance of the stick of a slave node, for [`Friction::share`] and [`Friction::stored_by`]: [`STICK_COMPLIANCE`] if something else may hold it, else none.
pub fn stick_compliance(may_be_held: bool) -> f64 {
    if may_be_held { STICK_COMPLIANCE } else { 0.0 }
}

/// Slip that an iteration leaves at a point that begins to slide, in parts of the slip of a spring with the present traction.
const RESIDUAL_SLIP: f64 = 1.0e-6;

/// Friction of a contact of slave and master: a law with all that its time stepping needs. General contact has one of its own, for a pair of primitives.
#[derive(Clone, Debug)]
pub struct Friction {
    law: Arc<dyn FrictionLaw>,
    penalty: f64,
    /// Mass per area of what sticks, and the stiffness that multipliers are weighed with in the present step.
    inertia: f64,
    stiffness: f64,
    /// The latter in a careful step, if it is another one than the penalty.
    careful_weight: Option<f64>,
    /// Stiffness in the present step of a spring in place of a multiplier.
    spring: f64,
    stick: Stick,
    /// Smoothing of the pressures; zero: the law as it is.
    smoothing: f64,
    /// Velocity of a master surface that moves along itself, and its way in the present step.
    belt: Option<SurfaceVelocity>,
    way: [f64; 3],
    /// Part of the pressure that the law gets in the present step.
    part: f64,
}

/// One point at the start of its step, and what the iteration says of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionPoint {
    /// Traction at the start, in the frame of the step. With [`Stick::Multiplier`] the multiplier.
    pub history: Plane,
    /// Slip in the step, a length.
    pub slip: Plane,
    /// Pressure of the step.
    pub pressure: f64,
    /// Size of the step.
    pub step_size: f64,
    /// Path slid before the step.
    pub slid: f64,
    /// The part of the slip that the compliance of a multiplier takes, for the dissipation only; zero without one.
    pub yielded: Plane,
}

/// A step of one point. Energies are per reference area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionStep {
    /// Traction in the equations, along the slip, and the history of the next step. Where it does not stick, this has the direction of the slip.
    pub force: Plane,
    /// True if nothing slides.
    pub sticks: bool,
    /// `d force_i / d history_j`.
    pub d_history: [Plane; 2],
    /// `d force_i / d slip_j`.
    pub d_slip: [Plane; 2],
    /// `d force / d pressure`.
    pub d_pressure: Plane,
    /// Energy in the tangential spring at the end.
    pub stored: f64,
    /// Work of the slip against the friction, `force . slip`.
    pub work: f64,
    /// Energy dissipated: the work less what springs took up, written so that round-off cannot make it negative. It is that of the part of the slip
    /// that springs do not take up, which is exactly zero where a point sticks. See [`Friction::step`].
    pub dissipated: f64,
    /// The part of the slip that the compliance of a multiplier takes, a length.
    pub yielded: Plane,
}

fn dot(a: Plane, b: Plane) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn size(a: Plane) -> f64 {
    a[0].hypot(a[1])
}

fn less(a: Plane, b: Plane) -> Plane {
    [a[0] - b[0], a[1] - b[1]]
}

fn apply(a: [Plane; 2], v: Plane) -> Plane {
    a.map(|row| dot(row, v))
}

/// `f a + g b`.
fn combine(f: f64, a: [Plane; 2], g: f64, b: [Plane; 2]) -> [Plane; 2] {
    std::array::from_fn(|i| std::array::from_fn(|j| f * a[i][j] + g * b[i][j]))
}

impl Friction {
    /// A law with a tangential stiffness (traction per length).
    ///
    /// # Errors
    /// [`ContactError::Friction`] if the stiffness is not positive.
    pub fn new(law: Arc<dyn FrictionLaw>, penalty: f64, stick: Stick) -> Result<Self, ContactError> {
        let penalty = check("penalty", penalty, penalty > 0.0, "positive")?;
        Ok(Self {
            law,
            penalty,
            inertia: 0.0,
            stiffness: penalty,
            careful_weight: None,
            spring: penalty,
            stick,
            smoothing: 0.0,
            belt: None,
            way: [0.0; 3],
            part: 1.0,
        })
    }

    /// Friction of bodies with inertia, of which the elements behind the surface have the mass `density` an area: in a small step `h` it is `density / h^2`
    /// that tells which slip goes with which traction. For multipliers; no result depends on it.
    #[must_use]
    pub fn with_inertia(mut self, density: f64) -> Self {
        self.inertia = if density > 0.0 && density.is_finite() { density } else { 0.0 };
        self
    }

    /// Friction with another stiffness, traction per length, that multipliers are weighed with in a careful step ([`StepContext::careful`]). No result depends on it,
    /// but Newton's method does: where it is stiffer than the bodies the slip of an iterate outweighs what the multiplier knew of the direction, and a point
    /// goes to and fro between stick and two directions of slip; where it is softer, more iterates are needed.
    #[must_use]
    pub fn with_careful_weight(mut self, stiffness: f64) -> Self {
        self.careful_weight = (stiffness > 0.0 && stiffness.is_finite()).then_some(stiffness);
        self
    }

    /// Friction on a master surface that moves along itself, beside its mesh. Its part along the normal of the surface has no effect.
    #[must_use]
    pub fn with_surface_velocity(mut self, belt: SurfaceVelocity) -> Self {
        self.belt = belt.moves().then_some(belt);
        self
    }

    /// The way of the master's surface beside its mesh in the present step, a length each: slips are less by its tangential part.
    pub fn surface_way(&self) -> [f64; 3] {
        self.way
    }

    /// Begins a step; without rates inertia resists nothing.
    pub fn begin(&mut self, step: &StepContext<'_>) {
        self.way = self.belt.as_ref().map_or([0.0; 3], |belt| belt.way(step.time, step.end));
        let inertia = if step.rates { self.inertia / (step.dt * step.dt) } else { 0.0 };
        let weighs = self.stick() == Stick::Multiplier && inertia.is_finite();
        self.spring = if weighs { self.penalty + inertia } else { self.penalty };
        (self.smoothing, self.part) = (0.0, 1.0);
        self.stiffness = self.careful_weight.filter(|_| weighs && step.careful).unwrap_or(self.spring);
    }

    /// Smooths the kink between stick and slip until the next step begins, or takes the law as it is again: `pressure` is the smoothing of pressures (theory/constraints#smoothed), of which
    /// the law makes a traction. It is for iterates on the way; what a step dissipates is not that of a smoothed one.
    pub fn smooth(&mut self, pressure: f64) {
        self.smoothing = pressure;
    }

    /// Lets the law have a part of the pressure until the next step begins: the bound of a law that is proportional to the pressure is multiplied by it.
    pub fn weaken(&mut self, part: f64) {
        self.part = part;
    }

    /// The bound at the part of the pressure that counts.
    fn bound(&self, pressure: f64, slip: Plane, [slid, step_size]: [f64; 2]) -> Bound {
        let bound =
            Bound::of(&*self.law, &Sliding { pressure: self.part * pressure, slip: size(slip), step_size, slid });
        Bound { d_pressure: self.part * bound.d_pressure, ..bound }
    }

    /// What multiplies slips in the present step, traction per length.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// The share of a multiplier in its own trial if it has a compliance.
    pub fn share(&self, compliance: f64) -> f64 {
        1.0 - compliance * self.stiffness / self.penalty
    }

    /// The law.
    pub fn law(&self) -> &dyn FrictionLaw {
        &*self.law
    }
    /// Bound of the traction over the pressure where a point slides by `slip` in a step of the size `step_size`, after a path `slid`.
    pub fn coefficient(&self, pressure: f64, slip: Plane, of_path: [f64; 2]) -> f64 {
        self.bound(pressure, slip, of_path).traction / pressure
    }
    /// What a step came to, for reports. `start` is the traction that it began with, `pressure` and `slid` are those of the step.
    pub fn slot_friction(
        &self,
        step: &FrictionStep,
        start: Plane,
        slip: Plane,
        [pressure, slid, step_size]: [f64; 3],
    ) -> SlotFriction {
        let bound = self.bound(pressure, slip, [slid, step_size]).traction;
        // A midpoint variant takes a mean of two tractions, of which the first had another pressure.
        // What springs and the compliance of a multiplier take up of the slip is elastic, and comes back.
        let elastic = |i: usize| match self.stick() {
            Stick::Penalty if self.law.sticks() => (step.force[i] - start[i]) / self.stiffness,
            // No spring: a law without stick.
            Stick::Penalty => 0.0,
            Stick::Multiplier => step.yielded[i],
        };
        let slip = std::array::from_fn(|i| slip[i] - elastic(i));
        SlotFriction { traction: step.force, slip, bound, sticks: step.sticks }
    }
    /// Tangential stiffness, traction per length.
    pub fn penalty(&self) -> f64 {
        self.penalty
    }
    /// How stick is enforced; a law without stick has nothing to enforce.
    pub fn stick(&self) -> Stick {
        if self.law.sticks() { self.stick } else { Stick::Penalty }
    }

    /// The compliance with which a multiplier is a spring: of the penalty, and of the inertia of the present step.
    pub fn spring_compliance(&self) -> f64 {
        self.penalty / self.spring
    }

    /// Energy in the tangential spring of a multiplier with a compliance (see [`STICK_COMPLIANCE`]), per area.
    pub fn stored_by(&self, compliance: f64, traction: [f64; 2]) -> f64 {
        match self.stick() {
            Stick::Multiplier => 0.5 * compliance * dot(traction, traction) / self.penalty,
            _ => 0.0,
        }
    }

    /// Energy in the tangential spring at a traction, per area; zero without one.
    pub fn stored(&self, traction: [f64; 2]) -> f64 {
        match (self.stick, self.law.sticks()) {
            (Stick::Penalty, true) => 0.5 * dot(traction, traction) / self.penalty,
            _ => 0.0,
        }
    }

    /// Does a step: a return over the whole of it, whose traction is force and history under every rule (theory/friction#midpoint).
    ///
    /// With `w = work`, `s` the stored energies: `w = s_np1 - s_n + dissipated`, and `dissipated >= 0` for every law that keeps
    /// what [`FrictionLaw`] asks for, from any traction at the start. An exact stick stores nothing: a point that sticks dissipates nothing, because its
    /// slip is zero by definition, one that slides `w`, or `|w|` where the slip is what an iteration leaves. Where it left a slip in stick, or a
    /// traction along the slip, `w` and the energies of the bodies tell. The spring of a multiplier's compliance, [`Friction::stored_by`], is loaded as
    /// backward Euler does, which takes what it would store at the increment of the multiplier.
    pub fn step(&self, point: &FrictionPoint) -> FrictionStep {
        self.step_with(point, false)
    }

    /// The step as if the point stuck, whatever traction that takes: the linear branch that Newton's method may have to look along. Of a law without stick the
    /// branch is its tangent at rest: a smooth law turns its traction within a slip that may be far smaller than that of an iterate.
    pub fn sticking_step(&self, point: &FrictionPoint) -> FrictionStep {
        self.step_with(point, true)
    }

    fn step_with(&self, point: &FrictionPoint, stuck: bool) -> FrictionStep {
        let of_path = [point.slid, point.step_size];
        let bound_at = |slip| self.bound(point.pressure, slip, of_path);
        let sticks = self.law.sticks();
        // Of a law that is proportional to the pressure the smoothing is so too, whatever its coefficient.
        let smoothing = match self.smoothing > 0.0 && sticks {
            true => self.bound(self.smoothing, [0.0; 2], of_path).traction,
            false => 0.0,
        };
        let bound = bound_at(point.slip);
        let law = |trial| match sticks {
            true => return_to_bound(trial, &bound, point.slip),
            false => along_slip(&bound, point.slip),
        };
        let returned = |trial| match (stuck, sticks) {
            _ if smoothing > 0.0 => smoothed_return(trial, &bound, point.slip, smoothing),
            (false, _) => law(trial),
            (true, true) => {
                let d_trial = [[1.0, 0.0], [0.0, 1.0]];
                Traction { traction: trial, sticks: true, d_trial, ..Traction::default() }
            }
            (true, false) => {
                let rest = along_slip(&bound_at([0.0; 2]), [0.0; 2]);
                Traction { traction: apply(rest.d_slip, point.slip), ..rest }
            }
        };
        let penalty = self.stiffness;
        let is_exact = self.stick != Stick::Penalty;
        let h = point.history;
        let tried = std::array::from_fn(|i| h[i] + penalty * point.slip[i]);
        let end = returned(tried);
        let jump = less(end.traction, h);
        // `dissipated` of springs: `work + s_n - s_np1` in terms of the slip `(trial - returned) / stiffness` that they do not take up.
        let out = FrictionStep {
            dissipated: (dot(end.traction, less(tried, end.traction)) + 0.5 * dot(jump, jump)) / penalty,
            force: end.traction,
            sticks: end.sticks,
            d_history: end.d_trial,
            d_slip: combine(penalty, end.d_trial, 1.0, end.d_slip),
            d_pressure: end.d_pressure,
            ..FrictionStep::default()
        };
        let work = dot(out.force, point.slip);
        let dissipated = match (sticks, is_exact) {
            (false, _) => work,
            (true, true) if out.sticks => 0.0,
            (true, true) => {
                let slid = less(point.slip, point.yielded);
                let power = dot(out.force, slid);
                // A traction along a slip of any size is no friction, and shows.
                let is_left = penalty * dot(slid, slid).sqrt() <= RESIDUAL_SLIP * dot(out.force, out.force).sqrt();
                if is_left { power.abs() } else { power }
            }
            (true, false) => out.dissipated,
        };
        FrictionStep { stored: self.stored(out.force), work, dissipated, yielded: point.yielded, ..out }
    }
}
