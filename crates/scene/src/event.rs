//! `[[event]]` and `[[stage]]`: changes in the course of a run.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::{Automatic, Integrator, Kind, ProbeComponent, Stabilise};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[[event]]`: the release of a joint, a spring or a prescribed motion, at a time or once a probe passes a value. Exactly one of `time` and `when`.
///
/// ```toml
/// [[event]]
/// name = "snap"
/// release = "hook"
/// when = { probe = "pull", component = "z", above = 100.0 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Unique name, for reports.
    pub name: String,
    /// Name of the `[[joint]]`, `[[spring]]` or `[[prescribe]]` that is released by the event.
    pub release: String,
    /// Time of the event, positive and at most the end of the run; a step ends there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Time)))]
    pub time: Option<f64>,
    /// Condition on a probe: the event takes place at the end of the first step in which it is true.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<EventCondition>,
}

/// Condition on the value of a probe; exactly one of `above` and `below`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct EventCondition {
    /// Name of the probe.
    pub probe: String,
    /// Component of a quantity with several values; not for a quantity with one value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub component: Option<ProbeComponent>,
    /// True if the value is larger than this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = "as the probe")))]
    pub above: Option<f64>,
    /// True if the value is smaller than this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = "as the probe")))]
    pub below: Option<f64>,
}

/// `[[stage]]`: a part of the run with its own kind of analysis, step size and active conditions. Without stages the run is one stage of the kind of the scene.
///
/// ```toml
/// [[stage]]
/// name = "hang"
/// kind = "quasi-static"
/// until = 1.0
/// step = 0.1
///
/// [[stage]]
/// name = "swing"
/// kind = "dynamic"
/// until = 5.0
/// off = ["rope-end"]
/// ```
///
/// The stages follow each other; the last one ends with `[time] end`. A scene with a dynamic stage is of `kind = "dynamic"`. Initial velocities are those
/// at the start of the first dynamic stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Unique name, for reports.
    pub name: String,
    /// Quasi-static or dynamic. Probes of velocities show the motion of the last step over its time in a quasi-static stage.
    pub kind: Kind,
    /// Time at which the stage ends, later than the end of the stage before.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Time)))]
    pub until: f64,
    /// Nominal step size; `[time] step` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Time)))]
    pub step: Option<f64>,
    /// Automatic choice of the increments of a quasi-static stage, of which `step` is the largest; off if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub automatic: Option<Automatic>,
    /// Viscous stabilisation of a quasi-static stage, which vanishes at its end; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stabilise: Option<Stabilise>,
    /// Time-stepping scheme of a dynamic stage; `[time] integrator` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integrator: Option<Integrator>,
    /// Names of joints, springs, contacts, prescribed motions and loads that are switched off in this stage; `gravity` switches gravity off.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub off: Vec<String>,
}
