//! The errors of this crate.

/// What to do about [`MeshError::NonConformingFacet`].
pub const NON_CONFORMING_REMEDY: &str = "mesh both parts so that neighbours have all nodes of their common facet, or make them two bodies and join these by [[tie]]";

/// What a named set holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SetKind {
    /// Nodes.
    Nodes,
    /// Facets of elements.
    Facets,
    /// Elements.
    Elements,
}

impl std::fmt::Display for SetKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            SetKind::Nodes => "nodes",
            SetKind::Facets => "facets",
            SetKind::Elements => "elements",
        })
    }
}

/// A point of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ElementPoint {
    /// A Gauss point of its stiffness.
    Gauss(usize),
    /// A node, counted in the element.
    Node(usize),
    /// Natural coordinates.
    Natural([f64; 3]),
}

impl std::fmt::Display for ElementPoint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ElementPoint::Gauss(point) => write!(f, "Gauss point {point}"),
            ElementPoint::Node(node) => write!(f, "its node {node}"),
            ElementPoint::Natural([x, y, z]) => write!(f, "natural coordinates ({x}, {y}, {z})"),
        }
    }
}

/// Why a mesh cannot be made or used. Node and element numbers count from 0 in the order of the mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A parameter of a generator, a region or a placement is out of its admissible range.
    #[error("{parameter} = {value}: {remedy}")]
    Parameter {
        /// The parameter's name.
        parameter: &'static str,
        /// The value given.
        value: String,
        /// Remedy: what is admissible.
        remedy: String,
    },
    /// A mesh with this number of elements is refused.
    #[error("divisions {divisions} give more than {limit} elements: use fewer divisions")]
    TooLarge {
        /// The divisions given.
        divisions: String,
        /// The largest number of elements.
        limit: usize,
    },
    /// A set of a name that does not exist.
    #[error("no set named \"{name}\"; the mesh has: {}", available.join(", "))]
    UnknownSet {
        /// The name asked for.
        name: String,
        /// All names that exist.
        available: Vec<String>,
    },
    /// The set exists but holds something from which the things wanted do not follow.
    #[error("set \"{name}\" has {has}, but {wanted} are needed here: name a set of {wanted}")]
    WrongSetKind {
        /// The name asked for.
        name: String,
        /// What the set has.
        has: SetKind,
        /// Kind that is needed.
        wanted: SetKind,
    },
    /// A set of this name exists already.
    #[error("a set named \"{name}\" exists already: choose another name")]
    SetExists {
        /// The name.
        name: String,
    },
    /// A set whose region has nothing of the mesh in it.
    #[error(
        "set \"{name}\" is empty: no {kind} lie in {region}; the mesh is in {:?} to {:?}: move the region or enlarge it", bounds[0], bounds[1]
    )]
    EmptySet {
        /// The name.
        name: String,
        /// What is looked for: nodes, or facets all of whose nodes lie in the region.
        kind: SetKind,
        /// The region in words.
        region: String,
        /// Smallest and largest coordinates of the mesh.
        bounds: Box<[[f64; 3]; 2]>,
    },
    /// The mesh has no element.
    #[error("the mesh has no element")]
    NoElements,
    /// An element refers to a node that does not exist.
    #[error("element {element} refers to node {node}, but the mesh has {count} nodes")]
    NodeOutOfRange {
        /// The element.
        element: u32,
        /// The node.
        node: u32,
        /// Number of nodes.
        count: usize,
    },
    /// A set refers to something that does not exist.
    #[error("set \"{name}\" refers to {kind} number {index}, but the mesh has only {count}")]
    SetOutOfRange {
        /// The set.
        name: String,
        /// Kind of its members.
        kind: SetKind,
        /// The bad number.
        index: u32,
        /// Number of things of that kind in the mesh.
        count: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("node {node} is at {coordinates:?}: coordinates must be finite")]
    NonFiniteNode {
        /// The node.
        node: u32,
        /// Coordinates of the node.
        coordinates: [f64; 3],
    },
    /// An element uses a node twice.
    #[error(
        "element {element} with nodes {nodes:?} uses node {node} twice: collapsed elements are not supported, all nodes must differ"
    )]
    RepeatedNode {
        /// The element.
        element: u32,
        /// Nodes of the element.
        nodes: Vec<u32>,
        /// The node that occurs twice.
        node: u32,
    },
    /// The Jacobian determinant of an element is not positive at a Gauss point, or at another point of a quadratic element.
    #[error(
        "element {element} with nodes {nodes:?} has det J = {jacobian:e} at {point}: it is inverted or degenerate; \
         check the order of its nodes (bottom counter-clockwise seen from the top, then top) and that nodes on edges lie near their middles"
    )]
    InvertedElement {
        /// The element.
        element: u32,
        /// Nodes of the element.
        nodes: Vec<u32>,
        /// Place where the element is inverted.
        point: ElementPoint,
        /// `det J` there (a volume per reference volume).
        jacobian: f64,
    },
    /// Linear elements that are valid, and one of them is not once its edges follow the curved boundary.
    #[error(
        "as {kind}, element {element} is turned inside out (det J = {jacobian:.1e}) where its edges follow the curved boundary: the mesh is too coarse for the curvature there, refine it{}",
        sharp_edges(*.sharp)
    )]
    CurvedBoundary {
        /// What elements were to become.
        kind: stoss_reference_element::CellKind,
        /// The element, among the new ones.
        element: u32,
        /// `det J` at a point of it (a volume per reference volume).
        jacobian: f64,
        /// Number of edges of the boundary that are taken for sharp, although they may belong to a coarse mesh of a smooth surface.
        sharp: usize,
    },
    /// Nodes that belong to no element.
    #[error("{count} nodes belong to no element, the first is node {first} at {coordinates:?}: remove them")]
    UnusedNodes {
        /// Number of such nodes.
        count: usize,
        /// The first of them.
        first: u32,
        /// Position of the first.
        coordinates: [f64; 3],
    },
    /// Two nodes at the same place.
    #[error(
        "nodes {first} and {second} are both at {coordinates:?} (distance {distance:e}): merge coincident nodes, or make two bodies"
    )]
    DuplicateNodes {
        /// The first node.
        first: u32,
        /// The second node.
        second: u32,
        /// Position of the first node.
        coordinates: [f64; 3],
        /// Distance of both nodes, a length.
        distance: f64,
    },
    /// The surface has no facet.
    #[error("the surface has no facet")]
    NoFacets,
    /// A facet of a surface refers to a node that does not exist.
    #[error("facet {facet} refers to node {node}, but the surface has {count} nodes")]
    FacetNodeOutOfRange {
        /// The facet.
        facet: u32,
        /// The node.
        node: u32,
        /// Number of nodes.
        count: usize,
    },
    /// A facet of a surface without area, with an edge of length zero, or folded.
    #[error(
        "facet {facet} with nodes {nodes:?} has no area, an edge of length zero or a fold: remove it, or give it nodes in order around it"
    )]
    DegenerateFacet {
        /// The facet.
        facet: u32,
        /// Nodes of the facet.
        nodes: Vec<u32>,
    },
    /// A surface that does not enclose a volume.
    #[error(
        "the surface is not closed: {count} edges do not belong to exactly two facets with opposite orientation, the first is between \
         nodes {} and {}: close the surface, or give mass properties in another way", first[0], first[1]
    )]
    OpenSurface {
        /// Number of these edges.
        count: usize,
        /// Nodes of the first.
        first: [u32; 2],
    },
    /// The volume is not positive, or the moments of volume are too large or too small for floating-point numbers.
    #[error(
        "the volume is {volume:e}: it must be positive, and its moments positive and finite; if normals point inwards, reverse the order of the nodes of all facets"
    )]
    Volume {
        /// The volume (length to the third power).
        volume: f64,
    },
    /// Elements that share the corners of a facet but not the nodes on its edges.
    #[error(
        "elements {elements:?} ({kinds}) share the corners of the facet with nodes {nodes:?} but not its other nodes: use linear elements on both \
         sides, or quadratic ones on both"
    )]
    NonMatchingFacet {
        /// The elements.
        elements: [u32; 2],
        /// Kinds of the elements.
        kinds: String,
        /// The facet's nodes in the first.
        nodes: Vec<u32>,
    },
    /// A facet of one element on facets of others that do not have the same nodes: a quadrilateral on triangles, a large one on small ones,
    /// a quadratic one on linear ones.
    #[error(
        "elements {elements:?} ({kinds}) lie on each other at the facet of the first around {centre:?}, but do not share this facet ({count} such facets): \
         displacements are not continuous there; {NON_CONFORMING_REMEDY}"
    )]
    NonConformingFacet {
        /// The element of the facet and one of those on it.
        elements: [u32; 2],
        /// Kinds of the elements.
        kinds: String,
        /// Mean of the corners of the facet.
        centre: [f64; 3],
        /// Number of facets that others lie on.
        count: usize,
    },
    /// Elements that overlap: a facet shared by more than two, or by two on the same side of it.
    #[error("elements {elements:?} lie on the same side of the facet with nodes {nodes:?}: they overlap, remove one")]
    OverlappingElements {
        /// The elements.
        elements: [u32; 2],
        /// The facet's nodes.
        nodes: Vec<u32>,
    },
}

/// Angle of two facets, in degrees, from which on conversion takes their edge as sharp.
const SHARP_DEGREES: f64 = 34.4;

/// Edges that stay sharp although they may belong to a smooth surface, as the end of a sentence.
fn sharp_edges(sharp: usize) -> String {
    if sharp == 0 {
        return String::new();
    }
    let angle = SHARP_DEGREES;
    format!("; {sharp} edges at which facets meet by {angle:.0} to 60 degrees are taken for sharp ones")
}

/// Shorthand for [`MeshError::Parameter`].
pub(crate) fn parameter<T: std::fmt::Debug>(parameter: &'static str, value: T, remedy: impl Into<String>) -> MeshError {
    MeshError::Parameter { parameter, value: format!("{value:?}"), remedy: remedy.into() }
}
