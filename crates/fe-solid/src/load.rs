//! Consistent nodal forces of surface loads on quad4 facets (formulation §3.3 (a) and (c)); 2x2 Gauss points.
//!
//! Facets are four global nodes, numbered so that `x_,xi x x_,eta` points out of the body. Functions add to the caller's
//! arrays; nothing is stored. Not here: load tables, and loads of constant direction on the *current* area
//! (§3.3 (b)). A new kind of load is a function that adds to `out` and, if it depends on the configuration, one that gives the 12x12
//! derivative.
//!
//! A load that follows the surface is evaluated by midpoint-type rules at `q_mid`; its tangent with respect to `q_np1`
//! is then half of the one given here.

use crate::SolidError;
use stoss_reference_element::{quad4, quadrature::GAUSS_QUAD_2};

/// A vector at each corner of a facet.
pub type FacetVectors = [[f64; 3]; 4];
/// Derivative of [`FacetVectors`] by the corners' positions: row `3 I + i`, column `3 J + j`.
pub type FacetTangent = [[f64; 12]; 12];

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Tangents `x_,xi` and `x_,eta`.
fn tangents(corners: &FacetVectors, gradient: &[[f64; 2]; 4]) -> [[f64; 3]; 2] {
    std::array::from_fn(|d| std::array::from_fn(|i| (0..4).map(|node| corners[node][i] * gradient[node][d]).sum()))
}

/// Positions of a facet's corners, or an error if a node is beyond `positions`.
fn corners(facet: &[u32; 4], positions: &[f64]) -> Result<FacetVectors, SolidError> {
    let mut out = [[0.0; 3]; 4];
    for (x, &node) in out.iter_mut().zip(facet) {
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

/// `int N_I dA` and `int N_I x_,xi x x_,eta dxi deta` of one facet.
fn nodal_areas(corners: &FacetVectors) -> ([f64; 4], FacetVectors) {
    let (mut area, mut vector) = ([0.0; 4], [[0.0; 3]; 4]);
    for (xi, weight) in GAUSS_QUAD_2 {
        let shape = quad4::shape(xi);
        let [a1, a2] = tangents(corners, &quad4::shape_gradient(xi));
        let n = cross(a1, a2);
        let norm = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        for node in 0..4 {
            area[node] += weight * shape[node] * norm;
            for i in 0..3 {
                vector[node][i] += weight * shape[node] * n[i];
            }
        }
    }
    (area, vector)
}

/// Adds what `nodal` gives for each facet of the reference surface.
fn add_dead(
    facets: &[[u32; 4]],
    reference: &[f64],
    out: &mut [f64],
    nodal: impl Fn(&[f64; 4], &FacetVectors) -> FacetVectors,
) -> Result<(), SolidError> {
    check_output(reference, out)?;
    for (index, facet) in facets.iter().enumerate() {
        let (areas, vectors) = nodal_areas(&corners(facet, reference)?);
        let area: f64 = areas.iter().sum();
        if !(area > 0.0 && area.is_finite()) {
            return Err(SolidError::DegenerateFacet { facet: index, area });
        }
        add_follower_pressure(facet, &nodal(&areas, &vectors), out);
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
pub fn surface_area(facets: &[[u32; 4]], positions: &[f64]) -> Result<f64, SolidError> {
    let mut total = 0.0;
    for (index, facet) in facets.iter().enumerate() {
        let area: f64 = nodal_areas(&corners(facet, positions)?).0.iter().sum();
        if !(area > 0.0 && area.is_finite()) {
            return Err(SolidError::DegenerateFacet { facet: index, area });
        }
        total += area;
    }
    Ok(total)
}

/// Adds the nodal forces `int N_I T dA` of a dead traction `T` (force per *reference* area), §3.3 (a).
///
/// `reference`: reference positions of the model; `out`: forces of the model.
///
/// # Errors
/// [`SolidError::Length`], [`SolidError::DegenerateFacet`].
pub fn dead_traction(
    facets: &[[u32; 4]],
    reference: &[f64],
    traction: [f64; 3],
    out: &mut [f64],
) -> Result<(), SolidError> {
    add_dead(facets, reference, out, |areas, _| areas.map(|area| traction.map(|t| area * t)))
}

/// Adds the nodal forces `-int N_I p N dA` of a dead pressure along the *reference* normal, positive towards the body.
///
/// # Errors
/// [`SolidError::Length`], [`SolidError::DegenerateFacet`].
pub fn dead_pressure(facets: &[[u32; 4]], reference: &[f64], pressure: f64, out: &mut [f64]) -> Result<(), SolidError> {
    add_dead(facets, reference, out, |_, vectors| vectors.map(|v| v.map(|x| -pressure * x)))
}

/// Nodal forces of a follower pressure on one facet at the current corners, and their derivative by the corners
/// (unsymmetric in general), §3.3 (c):
/// `f_I = -p int N_I (x_,xi x x_,eta)`, `df_I/dx_J = -p int N_I (N_J,eta [x_,xi] - N_J,xi [x_,eta])`, `[a] b = a x b`.
///
/// Positive pressure pushes against the outward normal. The 2x2 rule is exact here.
pub fn follower_pressure(corners: &FacetVectors, pressure: f64) -> (FacetVectors, FacetTangent) {
    let mut force = [[0.0; 3]; 4];
    let mut tangent = [[0.0; 12]; 12];
    for (xi, weight) in GAUSS_QUAD_2 {
        let shape = quad4::shape(xi);
        let gradient = quad4::shape_gradient(xi);
        let [a1, a2] = tangents(corners, &gradient);
        let n = cross(a1, a2);
        for node in 0..4 {
            let scale = -pressure * weight * shape[node];
            for i in 0..3 {
                force[node][i] += scale * n[i];
            }
            for other in 0..4 {
                // The axial vector of the (skew) block.
                let w: [f64; 3] =
                    std::array::from_fn(|i| scale * (gradient[other][1] * a1[i] - gradient[other][0] * a2[i]));
                let (r, c) = (3 * node, 3 * other);
                tangent[r][c + 1] -= w[2];
                tangent[r][c + 2] += w[1];
                tangent[r + 1][c] += w[2];
                tangent[r + 1][c + 2] -= w[0];
                tangent[r + 2][c] -= w[1];
                tangent[r + 2][c + 1] += w[0];
            }
        }
    }
    (force, tangent)
}

/// Adds the corner forces of one facet to the forces of the model. The facet's nodes must be inside `out`.
pub fn add_follower_pressure(facet: &[u32; 4], force: &FacetVectors, out: &mut [f64]) {
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
