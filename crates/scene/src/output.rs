//! `[output]`: frames, their fields, and checkpoints.

use crate::names::named;
use crate::read::{Node, Table, Value};
use crate::world::{World, time_in_run};
use crate::{Field, Kind};
use stoss_scene_derive::table;

named! {
    /// File format of the frames of a run.
    #[derive(Default)]
    FrameFormat {
        /// A VTU file for each frame, and a PVD collection of them.
        #[default]
        Vtu = "vtu",
        /// All frames in one VTKHDF file.
        Vtkhdf = "vtkhdf",
    }
}

/// Steps with a frame, beside the last one.
#[derive(Clone, Debug, PartialEq)]
pub enum Frames {
    /// Every so many steps, step 0 included.
    Every(u32),
    /// The first at or after every multiple of a time.
    Interval(f64),
    /// The first at or after each of these times.
    Times(Vec<f64>),
    /// No other.
    Last,
}

/// `[output]`: fields and times of the frames, and checkpoints.
///
/// One of `every`, `interval`, `times` and `last_only` says which steps have a frame; step sizes do not depend on it. The last step always has one.
///
/// ```toml
/// [output]
/// times = [0.1, 0.25]
/// fields = ["displacement", "principal_stresses"]
/// ```
#[table(context(World<'_>), check = one_way)]
pub struct Output {
    /// Number of steps from one frame to the next, at least 1. The tables have a row for each step.
    #[key(default = Self::DEFAULT_EVERY)]
    pub every: u32,
    /// A frame at the first step that ends at or after each multiple of this time, instead of `every`; positive.
    #[key(dimension = Time, positive)]
    pub interval: Option<f64>,
    /// A frame at the first step that ends at or after each of these times, instead of `every`; 0 is the initial state.
    #[key(dimension = Time, with = times)]
    pub times: Option<Vec<f64>>,
    /// `true`: no frame but that of the last step, instead of `every`. `false` if left out.
    #[key(default, skip)]
    pub last_only: bool,
    /// File format of the frames: `vtu` if left out, or `vtkhdf`.
    #[key(default, skip)]
    pub format: FrameFormat,
    /// Fields in the frames; if left out all that apply, except those that must be named.
    #[key(with = fields)]
    pub fields: Option<Vec<Field>>,
    /// Number of steps from one checkpoint to the next, at least 1.
    #[key(default = Self::DEFAULT_CHECKPOINT_EVERY)]
    pub checkpoint_every: u32,
}

impl Output {
    /// A frame at every step.
    pub const DEFAULT_EVERY: u32 = 1;
    /// A killed run repeats at most nine steps.
    pub const DEFAULT_CHECKPOINT_EVERY: u32 = 10;

    /// Which steps have a frame.
    pub fn frames(&self) -> Frames {
        match (self.interval, &self.times) {
            _ if self.last_only => Frames::Last,
            (Some(interval), _) => Frames::Interval(interval),
            (None, Some(times)) => Frames::Times(times.clone()),
            (None, None) => Frames::Every(self.every),
        }
    }
}

fn times(node: &Node<'_>, world: &World<'_>, _: &OutputKeys) -> Option<Vec<f64>> {
    let times = node.list(|n| time_in_run(n, world))?;
    if times.is_empty() {
        return node.fail("has no time", "name times, or write last_only = true instead");
    }
    Some(times)
}

fn one_way(_: &OutputKeys, table: &Table<'_>, _: &World<'_>) -> Option<()> {
    let mut ways = ["every", "interval", "times", "last_only"].into_iter().filter(|&key| table.has(key));
    match (ways.next(), ways.next()) {
        (Some(first), Some(second)) => table.fail(
            second,
            format!("cannot be combined with `{first}`"),
            "keep one of `every`, `interval`, `times` and `last_only`",
        ),
        _ => Some(()),
    }
}

fn fields(node: &Node<'_>, world: &World<'_>, _: &OutputKeys) -> Option<Vec<Field>> {
    let fields = node.list(|n| {
        let field = Field::read(n, world)?;
        if field == Field::Velocity && world.kind == Some(Kind::QuasiStatic) {
            return n.fail("does not exist in a quasi-static scene", "remove it");
        }
        let of_contact = matches!(field, Field::ContactPressure | Field::ContactMultiplier | Field::Gap);
        if of_contact && !(world.has_contact || world.has_general_contact) {
            let remedy = "remove it, or add a [[contact]] or [general_contact]";
            return n.fail("needs contact, and the scene has none", remedy);
        }
        if field == Field::Reaction && !world.has_prescribed {
            return n.fail("needs prescribed motion, and the scene has none", "remove it or add a [[prescribe]]");
        }
        Some(field)
    })?;
    if let Some(i) = (1..fields.len()).find(|&i| fields[..i].contains(&fields[i])) {
        return node.fail(format!("names `{}` twice", fields[i]), "name every field at most once");
    }
    Some(fields)
}
