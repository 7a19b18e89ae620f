//! Why there is no skin at the start.

use crate::Separation;
use std::fmt;

/// Why there is no skin. Places are points in space, all else lengths.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum StartFault {
    /// The thickness is less than [`crate::THINNEST`] of the shortest edge: no step size is small enough for so thin a layer.
    TooThin {
        /// Thickness given, a length.
        thickness: f64,
        /// The shortest edge.
        shortest: f64,
        /// Thickness without the option, a length.
        default: f64,
    },
    /// The surface of a body crosses itself.
    CrossesItself {
        /// The body.
        body: u32,
        /// Near this point.
        place: [f64; 3],
        /// Pairs of facets that cross.
        count: usize,
    },
    /// Facets of two bodies cross.
    Cross {
        /// The bodies.
        bodies: [u32; 2],
        /// Near this point.
        place: [f64; 3],
        /// Pairs of facets that cross.
        count: usize,
        /// The shortest way out for the first one.
        depth: Option<Separation>,
    },
    /// Two bodies overlap although no edge goes through a facet.
    Overlap {
        /// The bodies.
        bodies: [u32; 2],
        /// The shortest way out for the first one.
        depth: Separation,
    },
    /// One body lies wholly inside the other.
    Inside {
        /// The bodies.
        bodies: [u32; 2],
    },
    /// Parts of a surface that are not adjacent are nearer to each other than the layer is thick.
    NearItself {
        /// The body.
        body: u32,
        /// Distance of the parts, a length.
        distance: f64,
        /// Near this point.
        place: [f64; 3],
        /// Whether a thinner layer is possible.
        may_be_thinner: bool,
    },
    /// Two rigid bodies touch, and neither has an inside.
    NoInside {
        /// The bodies.
        bodies: [u32; 2],
        /// Thickness of the layer.
        thickness: f64,
    },
    /// A surface cannot go inside.
    NoRoom {
        /// The body.
        body: u32,
        /// Point where it has no room.
        place: [f64; 3],
        /// Depth that it would have to go inside, a length.
        depth: f64,
        /// Why.
        reason: &'static str,
        /// Whether it touches another body; otherwise it is nearer than the thickness that is given.
        touches: bool,
        /// Thickness of the layer.
        thickness: f64,
    },
    /// Inset surfaces of bodies that touch do not keep the thickness.
    NotKept {
        /// Thickness of the layer.
        thickness: f64,
    },
    /// Inset surfaces of two bodies that touch are nearer than the thickness; at no distance the bodies overlap.
    InsetTooNear {
        /// The bodies.
        bodies: [u32; 2],
        /// Near this point.
        place: [f64; 3],
        /// How near; `None`: they overlap.
        distance: Option<f64>,
        /// Thickness of the layer.
        thickness: f64,
    },
}

/// [`StartFault`], with the edge that the layer is thin for, a length: places are told with its digits.
#[derive(Clone, Debug, PartialEq)]
pub struct StartError {
    /// Fault of the skin.
    pub fault: StartFault,
    /// The edge.
    pub edge: f64,
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "there is no skin at the start: {:?}", self.fault)
    }
}

impl std::error::Error for StartError {}
