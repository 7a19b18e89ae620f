//! Joints between frames: bilateral constraints, and springs, friction, motors and limits on the free coordinates.
//!
//! Force and tangent are in [`assemble`], the equations of each kind in [`kinds`].

mod assemble;
mod coordinate;
mod coordinate_forces;
mod history;
mod kinds;
mod options;

pub use coordinate::CoordinateKind;
pub use kinds::{Directions, JOINTS, JointEntry, JointKind};
pub use options::{
    CoordinateFriction, CoordinateOptions, CoordinateSpring, Drive, DriveFunction, PiecewiseLinear, Pretension,
};

use crate::JointFrame;
use crate::compliance::{Compliance, Weights};
use crate::constraint::gradient_fraction;
use crate::quadratic::{Evaluation, Quadratics, QuadraticsBuilder};
use coordinate_forces::{Coordinate, CoordinateHistory, CoordinateState, Slots};
use kinds::Function;
use stoss_term::{GradientRule, JointTorques};

/// The largest error of the frames in the reference configuration, relative to the length of the joint.
const TOLERANCE: f64 = 1e-8;

/// Why a joint cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointError {
    /// Both sides are the same frame.
    #[error("joint {joint}: both sides are the same frame")]
    SameSides {
        /// The joint.
        joint: String,
    },
    /// Both sides are fixed to the ground.
    #[error("joint {joint}: both sides are the ground")]
    Ground {
        /// The joint.
        joint: String,
    },
    /// The frames do not satisfy the equations of the joint in the reference configuration.
    #[error("joint {joint} ({kind}): {what} {distance:e} away from its required position or direction")]
    Misplaced {
        /// The joint.
        joint: String,
        /// Kind of the joint.
        kind: &'static str,
        /// Name of what is misplaced.
        what: &'static str,
        /// Distance from what is required: a length, or the difference of two directions.
        distance: f64,
    },
    /// A number is out of its range.
    #[error("joint {joint}: {what} cannot be {value}")]
    Value {
        /// The joint.
        joint: String,
        /// Name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// The kind has no such free coordinate.
    #[error("joint {joint}: a {kind} joint has no coordinate {coordinate} for springs, motors or friction")]
    NoCoordinate {
        /// The joint.
        joint: String,
        /// Kind of the joint.
        kind: &'static str,
        /// Which one, counted from 1.
        coordinate: usize,
    },
}

/// State of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct StepState {
    dt: f64,
    time_n: f64,
    time_np1: f64,
    has_rates: bool,
}

/// A joint: `kind.equations()` constraints, then for each coordinate a slot each for friction, motor, pretension and limits if there are such. Slots that are not active have neither
/// forces nor equations; with none active the joint is released, with all that acts on its coordinates.
///
/// Multipliers are forces. Those of friction, motor, pretension and limits act on a coordinate times the length of the joint if that is an angle: a torque is the multiplier times
/// that length.
#[derive(Clone, Debug)]
pub struct Joint {
    name: String,
    kind: JointKind,
    length: f64,
    coordinates: Vec<Coordinate>,
    weights: Weights,
    forms: [crate::Embedded; 10],
    /// Whether one side is the ground.
    grounded: bool,
    /// Equations, then the invariants of the coordinates.
    list: Vec<Function>,
    functions: Quadratics,
    /// Number of all slots.
    slots: usize,
    compliance: Compliance,
    step: StepState,
    /// Norm of the force between the points in the last accepted step.
    last_reaction: f64,
}

impl Joint {
    /// Fixes `b` to `a`. `length` is a length of the joint: directions are measured times it, and violations against it. The frames are checked in the configuration
    /// `reference`.
    ///
    /// # Errors
    /// [`JointError`], with the distance if the points do not coincide or the axes are not parallel to `1e-8` of the length.
    pub fn new(
        name: &str,
        kind: JointKind,
        a: &JointFrame,
        b: &JointFrame,
        length: f64,
        reference: &[f64],
    ) -> Result<Self, JointError> {
        let joint = || name.to_owned();
        let positive = |what, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(JointError::Value { joint: joint(), what, value }),
        };
        positive("the length", length)?;
        if let JointKind::Distance { length } = kind {
            positive("the distance", length)?;
        }
        if a == b {
            return Err(JointError::SameSides { joint: joint() });
        }
        let forms = kinds::forms(a, b);
        let mut list = kind.functions(length);
        let mut coordinates = Vec::new();
        for (k, &of) in kind.coordinates().iter().enumerate() {
            let invariants = kind.invariants(k);
            coordinates.push(Coordinate {
                kind: of,
                first: list.len(),
                count: invariants.len(),
                length,
                options: CoordinateOptions::default(),
                slots: Slots::default(),
                state: CoordinateState::FIRST,
                history: CoordinateHistory::default(),
            });
            list.extend(invariants);
        }
        let mut builder = QuadraticsBuilder::new();
        let ids = forms.each_ref().map(|form| builder.form(form));
        for function in &list {
            let products: Vec<_> = function.products.iter().map(|&(f, u, v)| (f, ids[u], ids[v])).collect();
            builder.function(function.constant, &products);
        }
        let functions = builder.build();
        if functions.vectors().is_empty() {
            return Err(JointError::Ground { joint: joint() });
        }
        let made = Self {
            name: joint(),
            kind,
            length,
            grounded: [a, b].iter().any(|side| side.point.terms.is_empty()),
            coordinates,
            weights: Weights::default(),
            forms,
            list,
            functions,
            slots: kind.equations(),
            compliance: Compliance::default(),
            step: StepState::default(),
            last_reaction: 0.0,
        };
        made.check(reference)?;
        Ok(made)
    }

    fn check(&self, reference: &[f64]) -> Result<(), JointError> {
        let fault = |what, distance: f64| JointError::Misplaced {
            joint: self.name.clone(),
            kind: self.kind.name(),
            what,
            distance,
        };
        let at = |form: usize| self.forms[form].at(reference);
        for &k in self.kind.common_axes() {
            let (u, v) = (at(kinds::A[k]), at(kinds::B[k]));
            let apart = (0..3).map(|i| (u[i] - v[i]).powi(2)).sum::<f64>().sqrt();
            if apart > TOLERANCE || apart.is_nan() {
                return Err(fault("an axis of side b is", apart));
            }
        }
        let values = self.evaluate(reference).values;
        let points = self.kind.point_equations();
        let norm = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
        let (points, axes) = (norm(&values[..points]), norm(&values[points..self.kind.equations()]));
        if points > TOLERANCE * self.length || points.is_nan() {
            return Err(fault("the point of side b is", points));
        }
        if axes > TOLERANCE * self.length || axes.is_nan() {
            return Err(fault("an axis of side b is", axes / self.length));
        }
        Ok(())
    }

    fn evaluate(&self, q: &[f64]) -> Evaluation {
        let mut out = Evaluation::default();
        self.functions.evaluate(q, q, 1.0, false, &mut out);
        out
    }

    /// The joint with springs, friction, motor, pretension, limits on its first coordinate.
    ///
    /// # Errors
    /// The errors of [`Self::with_options_of`].
    pub fn with_options(self, options: CoordinateOptions) -> Result<Self, JointError> {
        self.with_options_of(0, options)
    }

    /// The joint with springs, friction, motor, pretension, limits on one of its coordinates, counted from 0 in the order of [`JointKind::coordinates`].
    ///
    /// # Errors
    /// [`JointError::NoCoordinate`] or [`JointError::Value`].
    pub fn with_options_of(mut self, coordinate: usize, options: CoordinateOptions) -> Result<Self, JointError> {
        if let Some((what, value)) = options.fault() {
            return Err(JointError::Value { joint: self.name, what, value });
        }
        match self.coordinates.get_mut(coordinate) {
            Some(of) => of.options = options,
            None if options.any() => {
                let (joint, kind) = (self.name, self.kind.name());
                return Err(JointError::NoCoordinate { joint, kind, coordinate: coordinate + 1 });
            }
            None => {}
        }
        let mut count = self.kind.equations();
        let mut next = |exists: bool| {
            let slot = count;
            count += usize::from(exists);
            exists.then_some(slot)
        };
        for of in &mut self.coordinates {
            let friction = next(of.options.friction.is_some());
            let motor = next(of.options.motor.is_some());
            let pretension = next(of.options.pretension.is_some());
            let limit = next(of.options.limits.is_some());
            of.slots = Slots { friction, motor, pretension, limit };
        }
        self.slots = count;
        Ok(self)
    }

    /// The joint with a mass and a stiffness that are typical of what it connects. They weigh slips against torques in decisions between stick and slip, open
    /// and closed; no result depends on them.
    #[must_use]
    pub fn with_weights(mut self, weights: Weights) -> Self {
        self.weights = weights;
        self
    }

    /// Makes its slots compliant in the tangent, for joints some of whose equations follow from others; `None` takes it back. See [`crate::analyse`].
    pub fn set_redundant(&mut self, weights: Option<Weights>) {
        self.compliance.set(weights);
    }

    /// Kind of the joint.
    pub fn kind(&self) -> JointKind {
        self.kind
    }

    /// The length of the joint.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Whether a slot is that of a motor.
    pub fn is_motor_slot(&self, slot: usize) -> bool {
        self.coordinates.iter().any(|c| c.slots.motor == Some(slot))
    }

    /// What multipliers of friction, motor and limits of a coordinate are multiplied by to be torques: the length of the joint for an angle, 1 for a displacement.
    pub fn scale(&self, coordinate: usize) -> f64 {
        self.coordinates.get(coordinate).map_or(1.0, Coordinate::scale)
    }

    /// Torques (or forces) along a coordinate that act on side b at the end of the last accepted step, which has led to `q`; `None` if there is no such coordinate.
    pub fn torques(&self, coordinate: usize, q: &[f64], multipliers: &[f64]) -> Option<JointTorques> {
        let c = self.coordinates.get(coordinate)?;
        Some(c.torques(c.value(&self.evaluate(q).values), multipliers))
    }

    /// Value of a coordinate at `q`, less than half a turn from that of the last accepted step (before the first step: from zero); `None` if there is no such.
    pub fn coordinate(&self, coordinate: usize, q: &[f64]) -> Option<f64> {
        Some(self.coordinates.get(coordinate)?.value(&self.evaluate(q).values))
    }

    /// Norm of the force between the points.
    fn reaction(&self, multipliers: &[f64]) -> f64 {
        multipliers[..self.kind.point_equations()].iter().map(|m| m * m).sum::<f64>().sqrt()
    }

    /// Force and moment about the point of side b that side a exerts on side b in a step, in the configuration of the rule. Of a beam the directors take the moment.
    pub fn force(&self, q_n: &[f64], q_np1: &[f64], rule: GradientRule, multipliers: &[f64]) -> ([f64; 3], [f64; 3]) {
        self.force_with(q_n, q_np1, rule, multipliers, &[])
    }

    /// [`Self::force`] with further torques on side b along the coordinates; none is zero.
    fn force_with(
        &self,
        q_n: &[f64],
        q_np1: &[f64],
        rule: GradientRule,
        multipliers: &[f64],
        further: &[f64],
    ) -> ([f64; 3], [f64; 3]) {
        let theta = gradient_fraction(rule);
        let q: Vec<f64> = q_n.iter().zip(q_np1).map(|(a, b)| (1.0 - theta) * a + theta * b).collect();
        let u = self.forms.each_ref().map(|form| form.at(&q));
        let mut weights: Vec<f64> = multipliers[..self.kind.equations()].to_vec();
        weights.extend(self.torque_weights(q_n, q_np1, rule, multipliers, further));
        let mut conjugate = [[0.0; 3]; 10];
        for (weight, function) in weights.iter().zip(&self.list) {
            for &(factor, a, b) in &function.products {
                for (form, other) in [(a, b), (b, a)] {
                    for i in 0..3 {
                        conjugate[form][i] += weight * factor * u[other][i];
                    }
                }
            }
        }
        let mut moment = [0.0; 3];
        for k in kinds::B {
            let (b, f) = (u[k], conjugate[k]);
            moment[0] += b[1] * f[2] - b[2] * f[1];
            moment[1] += b[2] * f[0] - b[0] * f[2];
            moment[2] += b[0] * f[1] - b[1] * f[0];
        }
        (conjugate[kinds::ARM], moment)
    }
}
