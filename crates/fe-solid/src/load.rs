//! Consistent nodal forces of surface loads on facets of any kinds (theory/elements#loads), with the quadrature rule of the facet.
//!
//! Facets are global nodes, numbered so that `x_,xi x x_,eta` points out of the body. A surface may mix kinds. Functions add to the caller's
//! arrays; nothing is stored. Not here: load tables, and loads of constant direction on the *current* area
//! (theory/kinematics#limits). A new kind of load is a function that adds to `out` and, if it depends on the configuration, one that gives the
//! derivative.
//!
//! A load that follows the surface is evaluated by midpoint-type rules at `q_mid`; its tangent with respect to `q_np1`
//! is then half of the one given here.

use crate::SolidError;
use stoss_reference_element::{FaceGradient, FaceKind, FaceNodes, MAX_FACE_NODES};

/// A vector at each node of a facet, anything beyond its nodes.
type FacetVectors = [[f64; 3]; MAX_FACE_NODES];

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Tangents `x_,xi` and `x_,eta`.
fn tangents(places: &[[f64; 3]], gradient: &FaceGradient) -> [[f64; 3]; 2] {
    std::array::from_fn(|d| std::array::from_fn(|i| places.iter().zip(gradient).map(|(x, g)| x[i] * g[d]).sum()))
}

/// Positions of a facet's nodes, or an error if a node is beyond `positions`.
fn places(facet: &FaceNodes, positions: &[f64]) -> Result<FacetVectors, SolidError> {
    let mut out = [[0.0; 3]; MAX_FACE_NODES];
    for (x, &node) in out.iter_mut().zip(facet.iter()) {
        let at = 3 * node as usize;
        match positions.get(at..at + 3) {
            Some(p) => x.copy_from_slice(p),
            None => {
                return Err(SolidError::Length {
                    name: "surface load".into(),
                    what: "the positions",
                    found: positions.len(),
                    expected: at + 3,
                });
            }
        }
    }
    Ok(out)
}

/// What a facet has at its nodes.
struct Nodal {
    /// `int N_I dA`.
    areas: [f64; MAX_FACE_NODES],
    /// `int N_I x_,xi x x_,eta dxi deta`.
    vectors: FacetVectors,
    /// `int dA`.
    area: f64,
}

impl Nodal {
    fn new(kind: FaceKind, places: &[[f64; 3]]) -> Self {
        let mut out = Self { areas: [0.0; MAX_FACE_NODES], vectors: [[0.0; 3]; MAX_FACE_NODES], area: 0.0 };
        for &(xi, weight) in kind.rule() {
            let shape = kind.shape(xi);
            let [a1, a2] = tangents(places, &kind.shape_gradient(xi));
            let n = cross(a1, a2);
            let norm = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
            for node in 0..places.len() {
                out.areas[node] += weight * shape[node] * norm;
                for i in 0..3 {
                    out.vectors[node][i] += weight * shape[node] * n[i];
                }
            }
        }
        out.area = out.areas.iter().sum();
        out
    }

    /// Areas and area vectors at the nodes of facet number `index` of a surface, or why it has none.
    fn of_facet(index: usize, facet: &FaceNodes, positions: &[f64]) -> Result<Self, SolidError> {
        let nodal = Self::new(facet.kind(), &places(facet, positions)?[..facet.len()]);
        if nodal.area > 0.0 && nodal.area.is_finite() {
            Ok(nodal)
        } else {
            Err(SolidError::DegenerateFacet { facet: index, area: nodal.area })
        }
    }
}

/// Adds what `nodal` gives for each facet of the reference surface.
fn add_dead(
    facets: &[FaceNodes],
    reference: &[f64],
    out: &mut [f64],
    nodal: impl Fn(&Nodal) -> FacetVectors,
) -> Result<(), SolidError> {
    check_output(reference, out)?;
    for (index, facet) in facets.iter().enumerate() {
        add_follower_pressure(facet, &nodal(&Nodal::of_facet(index, facet, reference)?), out);
    }
    Ok(())
}

fn check_output(reference: &[f64], out: &[f64]) -> Result<(), SolidError> {
    if out.len() != reference.len() {
        return Err(SolidError::Length {
            name: "surface load".into(),
            what: "the nodal forces",
            found: out.len(),
            expected: reference.len(),
        });
    }
    Ok(())
}

/// Area of a surface at the given positions (model vector): a length squared.
///
/// # Errors
/// [`SolidError::Length`], [`SolidError::DegenerateFacet`].
pub fn surface_area(facets: &[FaceNodes], positions: &[f64]) -> Result<f64, SolidError> {
    let mut total = 0.0;
    for (index, facet) in facets.iter().enumerate() {
        total += Nodal::of_facet(index, facet, positions)?.area;
    }
    Ok(total)
}

/// The matrix `int N_I N_J dA` of a facet, row-major, an area each: what a foundation of a stiffness per area or a coating needs. Symmetric and positive definite; its entries add up to
/// the area.
///
/// # Errors
/// [`SolidError::Length`], [`SolidError::DegenerateFacet`] with the facet number 0.
pub fn area_matrix(facet: &FaceNodes, positions: &[f64]) -> Result<Vec<f64>, SolidError> {
    let (kind, count) = (facet.kind(), facet.len());
    let places = places(facet, positions)?;
    let mut matrix = vec![0.0; count * count];
    for &(xi, weight) in kind.rule() {
        let shape = kind.shape(xi);
        let [a1, a2] = tangents(&places[..count], &kind.shape_gradient(xi));
        let n = cross(a1, a2);
        let area = weight * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        for (i, row) in matrix.chunks_exact_mut(count).enumerate() {
            row.iter_mut().zip(shape).for_each(|(entry, n)| *entry += area * shape[i] * n);
        }
    }
    let area = matrix.iter().sum::<f64>();
    if area > 0.0 && area.is_finite() { Ok(matrix) } else { Err(SolidError::DegenerateFacet { facet: 0, area }) }
}

/// Adds the nodal forces `int N_I T dA` of a dead traction `T` (force per *reference* area), theory/elements#loads.
///
/// `reference`: reference positions of the model; `out`: forces of the model.
///
/// # Errors
/// [`SolidError::Length`], [`SolidError::DegenerateFacet`].
pub fn dead_traction(
    facets: &[FaceNodes],
    reference: &[f64],
    traction: [f64; 3],
    out: &mut [f64],
) -> Result<(), SolidError> {
    add_dead(facets, reference, out, |nodal| nodal.areas.map(|area| traction.map(|t| area * t)))
}

/// Adds the nodal forces `-int N_I p N dA` of a dead pressure along the *reference* normal, positive towards the body.
///
/// # Errors
/// [`SolidError::Length`], [`SolidError::DegenerateFacet`].
pub fn dead_pressure(
    facets: &[FaceNodes],
    reference: &[f64],
    pressure: f64,
    out: &mut [f64],
) -> Result<(), SolidError> {
    add_dead(facets, reference, out, |nodal| nodal.vectors.map(|v| v.map(|x| -pressure * x)))
}

/// Nodal forces of a follower pressure on one facet and their derivative, see [`follower_pressure`].
#[derive(Clone, Copy, Debug)]
pub struct FollowerPressure {
    nodes: usize,
    force: FacetVectors,
    /// Row-major, as many rows as three times the nodes.
    tangent: [f64; 9 * MAX_FACE_NODES * MAX_FACE_NODES],
}

impl FollowerPressure {
    /// The force at each node.
    pub fn force(&self) -> &[[f64; 3]] {
        &self.force[..self.nodes]
    }

    /// Derivative by the nodes' positions: `9 n^2` numbers, row by row; row `3 I + i`, column `3 J + j`.
    pub fn tangent(&self) -> &[f64] {
        &self.tangent[..9 * self.nodes * self.nodes]
    }

    /// Derivative by the nodes' positions, to be scaled.
    pub fn tangent_mut(&mut self) -> &mut [f64] {
        &mut self.tangent[..9 * self.nodes * self.nodes]
    }
}

/// Nodal forces of a follower pressure on one facet at the current positions of its nodes (as many as the kind has), and their derivative
/// (unsymmetric in general), theory/elements#loads:
/// `f_I = -p int N_I (x_,xi x x_,eta)`, `df_I/dx_J = -p int N_I (N_J,eta [x_,xi] - N_J,xi [x_,eta])`, `[a] b = a x b`.
///
/// Positive pressure pushes against the outward normal. The quadrature rule of the facet is exact here for linear facets, for triangles with straight edges
/// and for parallelograms; on others the derivative is that of the force as computed.
///
/// # Panics
/// If the number of positions is not that of the kind; this is a programming error.
pub fn follower_pressure(kind: FaceKind, places: &[[f64; 3]], pressure: f64) -> FollowerPressure {
    let nodes = kind.node_count();
    assert_eq!(places.len(), nodes, "positions of {kind}");
    let mut out = FollowerPressure {
        nodes,
        force: [[0.0; 3]; MAX_FACE_NODES],
        tangent: [0.0; 9 * MAX_FACE_NODES * MAX_FACE_NODES],
    };
    let row = 3 * nodes;
    for &(xi, weight) in kind.rule() {
        let shape = kind.shape(xi);
        let gradient = kind.shape_gradient(xi);
        let [a1, a2] = tangents(places, &gradient);
        let n = cross(a1, a2);
        for node in 0..nodes {
            let scale = -pressure * weight * shape[node];
            for i in 0..3 {
                out.force[node][i] += scale * n[i];
            }
            for other in 0..nodes {
                // The axial vector of the (skew) block.
                let w: [f64; 3] =
                    std::array::from_fn(|i| scale * (gradient[other][1] * a1[i] - gradient[other][0] * a2[i]));
                let at = 3 * node * row + 3 * other;
                out.tangent[at + 1] -= w[2];
                out.tangent[at + 2] += w[1];
                out.tangent[at + row] += w[2];
                out.tangent[at + row + 2] -= w[0];
                out.tangent[at + 2 * row] -= w[1];
                out.tangent[at + 2 * row + 1] += w[0];
            }
        }
    }
    out
}

/// Adds the nodal forces of one facet to the forces of the model. The facet's nodes must be inside `out`.
pub fn add_follower_pressure(facet: &FaceNodes, force: &[[f64; 3]], out: &mut [f64]) {
    for (&node, f) in facet.iter().zip(force) {
        let at = 3 * node as usize;
        for (o, f) in out[at..at + 3].iter_mut().zip(f) {
            *o += f;
        }
    }
}

/// Work `f . (q_np1 - q_n)` of nodal forces that are constant over an increment (an energy). Exact for dead loads. For a
/// follower pressure taken at `q_mid` it differs from the enclosed volume's `p dV` by a term of third order.
pub fn external_work(force: &[f64], q_n: &[f64], q_np1: &[f64]) -> f64 {
    debug_assert!(force.len() == q_n.len() && q_n.len() == q_np1.len());
    force.iter().zip(q_n).zip(q_np1).map(|((f, a), b)| f * (b - a)).sum()
}
