//! Closest points of a master surface: signed gap, geometric case, pairing facet.
//!
//! [`MasterSearch`] owns the tree; [`MasterSearch::update`] refits it once a step. [`MasterSearch::at`] gives a [`SearchView`] for *any*
//! positions (the iterates of the step, or a configuration to report on); two queries answer for a point:
//!
//! * [`SearchView::closest`] knows no history: the signed distance to the whole surface;
//! * [`SearchView::pair`] prefers the facet that the node had before, with a hysteresis at edges.
//!
//! # The gap is one function of position
//! Its magnitude is the distance to the closest point of the *whole* surface, over faces, edges and vertices alike; its sign comes from the
//! normal in a face and from the angle-weighted pseudo-normal on an edge or a vertex (Baerentzen and Aanaes 2005), which gives the
//! right side at convex and concave places. The signed distance is continuous (Lipschitz with constant 1), so a node that slides over a
//! ridge, through a valley or round a corner cannot lose contact, jump, or be caught twice.
//!
//! # Rims
//! Where an open surface ends there is no contact: a point whose closest point is on a rim and whose normal projection lies beyond the rim
//! has no partner ([`MasterPoint::pairing`] is `None`). A small overhang is tolerated, so that a node exactly on a rim keeps contact.
//!
//! # What it is not
//! It computes no derivatives: a contact method takes [`Pairing::facet`] and [`Pairing::xi`] and works on the extended patch. Self-contact
//! is not covered.

mod resolve;
mod view;

pub use view::SearchView;

use crate::{ContactError, ContactSurface, SurfaceTree};
use nalgebra::Vector3;

/// Where on the master surface the closest point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feature {
    /// The interior of a facet, at convective coordinates inside of it.
    Face {
        /// Index of the facet.
        facet: u32,
        /// Coordinates of the closest point.
        xi: [f64; 2],
    },
    /// An edge.
    Edge {
        /// The facet that has the edge and its neighbour; `None` on a rim.
        facets: (u32, Option<u32>),
        /// Coordinates on the first facet.
        xi: [f64; 2],
    },
    /// A node of the surface.
    Vertex {
        /// Global node.
        node: u32,
        /// Whether the node lies on a rim.
        rim: bool,
    },
    /// No feature within reach.
    None,
}

impl Feature {
    /// "face", "edge", "vertex" or "none".
    pub fn name(&self) -> &'static str {
        match self {
            Self::Face { .. } => "face",
            Self::Edge { .. } => "edge",
            Self::Vertex { .. } => "vertex",
            Self::None => "none",
        }
    }
}

/// The facet on which a contact method places a constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pairing {
    /// Index of the master facet.
    pub facet: u32,
    /// Foot of the normal on the *extended* patch of the facet: outside the facet if the closest point is on an edge or vertex.
    pub xi: [f64; 2],
    /// Gap to the extended patch, `(x - x(xi)) . n`.
    pub gap: f64,
    /// Unit normal of the extended patch.
    pub normal: Vector3<f64>,
}

/// Answer of the search for one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterPoint {
    /// The geometric case.
    pub feature: Feature,
    /// Signed gap, positive outside; `f64::INFINITY` exactly if `pairing` is `None`.
    pub gap: f64,
    /// Unit normal, master to slave: the face normal, or the direction from the closest point (outwards); zero without a feature.
    pub normal: Vector3<f64>,
    /// The closest point; not meaningful without a feature.
    pub point: Vector3<f64>,
    /// Where to place the constraint. `None`: nothing within reach, too deep, or beyond a rim.
    pub pairing: Option<Pairing>,
}

impl MasterPoint {
    /// A point without a partner.
    pub const NONE: Self = Self {
        feature: Feature::None,
        gap: f64::INFINITY,
        normal: Vector3::new(0.0, 0.0, 0.0),
        point: Vector3::new(0.0, 0.0, 0.0),
        pairing: None,
    };

    /// Whether the closest point is on a rim and the point lies beyond it.
    pub fn beyond_rim(&self) -> bool {
        let rim = matches!(self.feature, Feature::Edge { facets: (_, None), .. } | Feature::Vertex { rim: true, .. });
        rim && self.pairing.is_none()
    }
}

/// Tolerances of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchOptions {
    /// How far beyond a rim contact is kept, in halves of an edge as `FacetKind::excess` counts (theory/node-to-surface#search). Zero would lose a node that sits
    /// on the rim to round-off.
    pub overhang: f64,
    /// How far beyond an edge [`SearchView::pair`] keeps the facet that a node had, in halves of an edge. Without it a node on an edge
    /// changes its facet with every iterate. The gap to the kept facet may differ from the true gap by a tenth of this times the
    /// length scale.
    pub hysteresis: f64,
    /// Penetrations deeper than this are not captured, in multiples of the master's length scale; may be infinite.
    pub depth_limit: f64,
    /// Largest cosine `n_facet . n_slave` of a partner, with a slave normal given: the far side of a thin body is none.
    pub opposing_cosine: f64,
    /// Largest cosine of facets beside the rims of the surface ([`crate::beside_rims`]): a slave that is flush with such a side, as a block on another one of
    /// its size, has nothing to do with it.
    pub cosine_beside: f64,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self { overhang: 1e-2, hysteresis: 1e-2, depth_limit: 1.0, opposing_cosine: 0.2, cosine_beside: -0.05 }
    }
}

impl SearchOptions {
    fn validate(&self) -> Result<(), ContactError> {
        let check = |option, value: f64, ok: bool, range| match ok {
            true => Ok(()),
            false => Err(ContactError::OptionOutOfRange { option, value, range }),
        };
        let small = |v: f64| (0.0..=0.5).contains(&v);
        check("overhang", self.overhang, small(self.overhang), "between 0 and 0.5")?;
        check("hysteresis", self.hysteresis, small(self.hysteresis), "between 0 and 0.5")?;
        check("depth_limit", self.depth_limit, self.depth_limit > 0.0, "positive")?;
        let cosine = self.opposing_cosine;
        check("opposing_cosine", cosine, (-1.0..=1.0).contains(&cosine), "between -1 and 1")?;
        let beside = self.cosine_beside;
        check("cosine_beside", beside, (-1.0..=1.0).contains(&beside), "between -1 and 1")
    }
}

/// Search structure over a master surface.
#[derive(Clone, Debug)]
pub struct MasterSearch {
    surface: ContactSurface,
    options: SearchOptions,
    tree: SurfaceTree,
    reach: f64,
    takes_sides: bool,
}

impl MasterSearch {
    /// Builds the tree at positions `q` (`3 * nodes` entries, all nodes of the model). The reach is infinite until
    /// [`MasterSearch::update`].
    ///
    /// # Errors
    /// [`ContactError::OptionOutOfRange`] if an option is out of its range, [`ContactError::MissingNode`] if `q` is too short.
    pub fn new(surface: ContactSurface, q: &[f64], options: SearchOptions) -> Result<Self, ContactError> {
        options.validate()?;
        let tree = SurfaceTree::new(&surface, q)?;
        Ok(Self { surface, options, tree, reach: f64::INFINITY, takes_sides: true })
    }

    /// Refits the tree to positions `q`. Points with a gap larger than `reach` get no partner. No allocation.
    pub fn update(&mut self, q: &[f64], reach: f64) {
        self.reach = reach;
        self.tree.update(&self.surface, q);
    }

    /// Tells what carries the nodes of the surface, see [`ContactSurface::set_carriers`]; comes before [`MasterSearch::update`].
    pub fn set_carriers<'a>(&mut self, of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {
        self.surface.set_carriers(of);
        if self.surface.carriers().is_some() {
            self.tree.forget();
        }
    }

    /// Whether facets beside rims ([`ContactSurface::is_beside`]) are partners; they are unless this says otherwise.
    pub fn take_sides(&mut self, takes_sides: bool) {
        self.takes_sides = takes_sides;
    }

    /// The master surface.
    pub fn surface(&self) -> &ContactSurface {
        &self.surface
    }

    /// The options.
    pub fn options(&self) -> &SearchOptions {
        &self.options
    }

    /// The present reach, a length.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Largest penetration that is captured, a length.
    pub fn depth_limit(&self) -> f64 {
        self.options.depth_limit * self.surface.length_scale()
    }

    /// A view for queries at positions `q`, which need not be those of the last [`MasterSearch::update`]: the queries allow for what the
    /// nodes moved since (a common translation costs nothing). Takes one pass over the surface's nodes, or none if it has carriers.
    pub fn at<'a>(&'a self, q: &'a [f64]) -> SearchView<'a> {
        SearchView::new(self, q)
    }
}
