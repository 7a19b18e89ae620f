//! What a frame shows beside the solids: surfaces of rigid bodies, lines of beams and strings, single points.

#[cfg(feature = "output")]
use crate::points::Points;
use std::ops::Range;
use stoss_reference_element::FacetNodes;

/// The surface of a rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnSurface {
    /// Name of the rigid body.
    pub name: String,
    /// Nodes of the surface, embedded in the body.
    pub nodes: Range<u32>,
    /// Facets, outward.
    pub facets: Vec<FacetNodes>,
    /// Whether it encloses a volume.
    pub is_closed: bool,
}

/// The axis of a beam, or a string.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnLine {
    /// Name of the beam or string.
    pub name: String,
    /// Nodes from one end to the other.
    pub nodes: Vec<u32>,
}

/// A point mass, or a rigid body without a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnPoint {
    /// Name of the part.
    pub name: String,
    /// Node of the point.
    pub node: u32,
}

/// What is drawn beside the solids, by global numbers of nodes; empty for a scene of solids alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// What is modelled of a scene of plane sections ([`super::Built::extent`]).
    pub extent: Option<f64>,
    /// Axes across planes of symmetry, and the side of each on which the bodies are.
    pub symmetry: Vec<(usize, f64)>,
    /// Surfaces.
    pub surfaces: Vec<DrawnSurface>,
    /// Lines.
    pub lines: Vec<DrawnLine>,
    /// Points.
    pub points: Vec<DrawnPoint>,
    /// The surroundings of joints: there the parts that they connect may overlap.
    pub joined: Vec<Joined>,
    /// Names of the bodies with surfaces that the scene calls round.
    pub round: Vec<String>,
}

/// Where a joint holds two parts together.
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    /// Names of the two parts.
    pub parts: [String; 2],
    /// Nodes of both surfaces around the joint.
    pub nodes: Vec<u32>,
}

#[cfg(feature = "output")]
impl Drawing {
    /// The drawing with places among the points for nodes.
    #[cfg(feature = "output")]
    pub(crate) fn of_points(&self, points: &Points) -> Self {
        let place = |node: u32| points.place(node);
        let surface = |surface: &DrawnSurface| {
            // The nodes of a surface are no directions: their places are in a row, too.
            let first = place(surface.nodes.start);
            DrawnSurface {
                nodes: first..first.saturating_add(surface.nodes.len() as u32),
                facets: surface.facets.iter().map(|facet| facet.map(place)).collect(),
                ..surface.clone()
            }
        };
        let line = |line: &DrawnLine| DrawnLine {
            nodes: line.nodes.iter().map(|&node| place(node)).collect(),
            ..line.clone()
        };
        let point = |point: &DrawnPoint| DrawnPoint { node: place(point.node), ..point.clone() };
        let joined = |joined: &Joined| Joined {
            parts: joined.parts.clone(),
            nodes: joined.nodes.iter().map(|&node| place(node)).collect(),
        };
        Self {
            extent: self.extent,
            symmetry: self.symmetry.clone(),
            surfaces: self.surfaces.iter().map(surface).collect(),
            lines: self.lines.iter().map(line).collect(),
            points: self.points.iter().map(point).collect(),
            joined: self.joined.iter().map(joined).collect(),
            round: self.round.clone(),
        }
    }
}
