//! Mass, centre of mass and Euler tensor.

use std::f64::consts::PI;

use stoss_reference_element::{CellKind, Family, QuadratureRule, quadrature};

use super::SurfaceMesh;
use super::revolution::tip_radius;
use crate::generate::validate;
use crate::vector::det;
use crate::{Mesh, MeshError};

/// Points of degree 5 in all cells.
fn rule(kind: CellKind) -> QuadratureRule {
    match kind.table().family {
        Family::Hexahedron => &quadrature::GAUSS_HEX_3,
        Family::Tetrahedron => &quadrature::TET_14,
        Family::Wedge => &quadrature::WEDGE_21,
    }
}

/// Inertia of a rigid body with constant density `rho`, in the axes in which its shape is given:
///
/// `m = int rho dV`, `c = 1/m int rho x dV`, `E = int rho (x - c) (x - c)^T dV`.
///
/// The Euler tensor `E` has the same content as the tensor of inertia `I = tr(E) 1 - E` about the centre of mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// Mass `m` (mass).
    pub mass: f64,
    /// Centre of mass `c` (length).
    pub centre: [f64; 3],
    /// Euler tensor `E` about the centre of mass, symmetric (mass times squared length).
    pub euler: [[f64; 3]; 3],
}

impl MassProperties {
    /// Mass properties of the inside of a closed surface. A quadrilateral is taken as four triangles with the mean of its nodes as
    /// their common corner: the volume is that below the bilinear facet, and nothing depends on where the numbering of
    /// a facet starts. Exact for this polyhedron.
    ///
    /// By the divergence theorem the polyhedron is the sum of the tetrahedra `(o, a, b, c)` over the triangles, with
    /// signed volumes `V = det[a b c] / 6` relative to any origin `o`, here the mean of the nodes. With `s = a + b + c`
    ///
    /// `int x dV = V s / 4`, `int x x^T dV = V / 20 (s s^T + a a^T + b b^T + c c^T)`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (density), [`MeshError::NoFacets`], [`MeshError::FacetNodeOutOfRange`],
    /// [`MeshError::OpenSurface`], [`MeshError::Volume`] (a surface that is turned inside out, coordinates that are not
    /// finite).
    pub fn of_surface(surface: &SurfaceMesh, density: f64) -> Result<MassProperties, MeshError> {
        validate::positive("density", density)?;
        surface.moments()?.properties(density)
    }

    /// Mass properties of a mesh. `det J x x^T` has degree 4 in each natural coordinate of a trilinear hexahedron, so that the Gauss rule of 3 x 3 x 3
    /// points is exact for it; the quadrature rules of the other cells are exact for straight edges.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] (density), [`MeshError::NoElements`], [`MeshError::NodeOutOfRange`], [`MeshError::Volume`].
    pub fn of_mesh(mesh: &Mesh, density: f64) -> Result<MassProperties, MeshError> {
        validate::positive("density", density)?;
        if mesh.elements.is_empty() {
            return Err(MeshError::NoElements);
        }
        mesh.check_node_numbers()?;
        let mut moments = Moments::about(mean(&mesh.nodes));
        for element in 0..mesh.elements.len() as u32 {
            let x = mesh.element_coordinates(element).map(|p| moments.relative(p));
            for &(xi, weight) in rule(x.kind()) {
                moments.add_point(x.at(xi), weight * det(&x.jacobian(xi)));
            }
        }
        moments.properties(density)
    }

    /// Mass properties of a ball about the origin: `V = 4/3 pi r^3`, `E = m r^2 / 5 1`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`], [`MeshError::Volume`].
    pub fn of_sphere(radius: f64, density: f64) -> Result<MassProperties, MeshError> {
        validate::positive("radius", radius)?;
        let r = radius;
        closed_form(4.0 / 3.0 * PI * r * r * r, 0.0, [r * r / 5.0; 3], density)
    }

    /// Mass properties of a box about the origin: `V = a b c`, `E = m / 12 diag(a^2, b^2, c^2)`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`], [`MeshError::Volume`].
    pub fn of_cuboid(size: [f64; 3], density: f64) -> Result<MassProperties, MeshError> {
        for i in 0..3 {
            validate::positive(["size x", "size y", "size z"][i], size[i])?;
        }
        closed_form(size.iter().product(), 0.0, size.map(|a| a * a / 12.0), density)
    }

    /// Mass properties of a cylinder about the z-axis with its centre at the origin: `V = pi r^2 l`,
    /// `E = m diag(r^2 / 4, r^2 / 4, l^2 / 12)`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`], [`MeshError::Volume`].
    pub fn of_cylinder(radius: f64, length: f64, density: f64) -> Result<MassProperties, MeshError> {
        validate::positive("radius", radius)?;
        validate::positive("length", length)?;
        let (r, l) = (radius, length);
        closed_form(PI * r * r * l, 0.0, [r * r / 4.0, r * r / 4.0, l * l / 12.0], density)
    }

    /// Mass properties of a cone in place of [`super::Cone`], from its tip (radius `t`, 0 if it is sharp) at `z = 0` to its base
    /// (radius `R`) at `z = h`. With the radius `t + (R - t) z / h` at `z`, and `A = R^2 + R t + t^2`:
    ///
    /// * `V = pi h A / 3`, `c_z = h (3 R^2 + 2 R t + t^2) / (4 A)`,
    /// * `E_xx = E_yy = rho pi h (R^4 + R^3 t + R^2 t^2 + R t^3 + t^4) / 20`,
    /// * `E_zz = 3 m h^2 (R^4 + 4 R^3 t + 10 R^2 t^2 + 4 R t^3 + t^4) / (80 A^2)`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`], [`MeshError::Volume`].
    pub fn of_cone(radius: f64, height: f64, tip: f64, density: f64) -> Result<MassProperties, MeshError> {
        validate::positive("radius", radius)?;
        validate::positive("height", height)?;
        tip_radius(tip, radius)?;
        // With q = t / R nothing is lost for large and small radii.
        let (r, h, q) = (radius, height, tip / radius);
        let area = 1.0 + q + q * q;
        let centre = h * (3.0 + 2.0 * q + q * q) / (4.0 * area);
        let across = 3.0 * r * r * (1.0 + q + q * q + q * q * q + q * q * q * q) / (20.0 * area);
        let along =
            3.0 * h * h * (1.0 + 4.0 * q + 10.0 * q * q + 4.0 * q * q * q + q * q * q * q) / (80.0 * area * area);
        closed_form(PI * r * r * h * area / 3.0, centre, [across, across, along], density)
    }

    /// The tensor of inertia about the centre of mass, `I = tr(E) 1 - E` (mass times squared length).
    pub fn inertia(&self) -> [[f64; 3]; 3] {
        let e = &self.euler;
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            // The diagonal as a sum of the other two entries, without cancellation.
            std::array::from_fn(|l| if l == i { e[j][j] + e[k][k] } else { -e[i][l] })
        })
    }
}

impl SurfaceMesh {
    /// The volume that the closed surface encloses (length to the third power), negative if its normals point inwards: then
    /// [`SurfaceMesh::flipped`] puts it right. Facets that are not plane count as in [`MassProperties::of_surface`].
    ///
    /// # Errors
    /// [`MeshError::NoFacets`], [`MeshError::FacetNodeOutOfRange`], [`MeshError::OpenSurface`].
    pub fn volume(&self) -> Result<f64, MeshError> {
        Ok(self.moments()?.volume)
    }

    fn moments(&self) -> Result<Moments, MeshError> {
        if self.facets.is_empty() {
            return Err(MeshError::NoFacets);
        }
        self.check_node_numbers()?;
        let open = self.open_edges();
        if let Some(&first) = open.first() {
            return Err(MeshError::OpenSurface { count: open.len(), first });
        }
        let mut moments = Moments::about(mean(&self.nodes));
        for facet in 0..self.facets.len() as u32 {
            let x = self.facet_coordinates(facet).map(|p| moments.relative(p));
            if let [a, b, c] = x[..] {
                moments.add_triangle([a, b, c]);
            } else {
                let centre = mean(&x);
                for k in 0..x.len() {
                    moments.add_triangle([x[k], x[x.kind().next(k)], centre]);
                }
            }
        }
        Ok(moments)
    }
}

/// Moments of volume about a point: `int dV`, `int x dV`, `int x x^T dV`, with `x` relative to it.
struct Moments {
    origin: [f64; 3],
    volume: f64,
    first: [f64; 3],
    second: [[f64; 3]; 3],
}

impl Moments {
    fn about(origin: [f64; 3]) -> Moments {
        Moments { origin, volume: 0.0, first: [0.0; 3], second: [[0.0; 3]; 3] }
    }

    fn relative(&self, x: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| x[i] - self.origin[i])
    }

    /// A point with a volume.
    fn add_point(&mut self, x: [f64; 3], volume: f64) {
        self.volume += volume;
        for i in 0..3 {
            self.first[i] += volume * x[i];
            for j in 0..3 {
                self.second[i][j] += volume * x[i] * x[j];
            }
        }
    }

    /// The tetrahedron between the origin and a triangle.
    fn add_triangle(&mut self, x: [[f64; 3]; 3]) {
        let volume = det(&x) / 6.0;
        let sum: [f64; 3] = std::array::from_fn(|i| x[0][i] + x[1][i] + x[2][i]);
        self.volume += volume;
        for i in 0..3 {
            self.first[i] += volume * sum[i] / 4.0;
            for j in 0..3 {
                let corners: f64 = x.iter().map(|p| p[i] * p[j]).sum();
                self.second[i][j] += volume * (sum[i] * sum[j] + corners) / 20.0;
            }
        }
    }

    fn properties(&self, density: f64) -> Result<MassProperties, MeshError> {
        let v = self.volume;
        let c = self.first.map(|s| s / v);
        let euler = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let (i, j) = (i.min(j), i.max(j));
                density * (self.second[i][j] - v * c[i] * c[j])
            })
        });
        let centre = std::array::from_fn(|i| self.origin[i] + c[i]);
        checked(v, MassProperties { mass: density * v, centre, euler })
    }
}

/// A shape with the z-axis as its axis: volume, height of the centre, and the Euler tensor over the mass.
fn closed_form(volume: f64, centre: f64, euler: [f64; 3], density: f64) -> Result<MassProperties, MeshError> {
    validate::positive("density", density)?;
    let mass = density * volume;
    let euler = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { mass * euler[i] } else { 0.0 }));
    checked(volume, MassProperties { mass, centre: [0.0, 0.0, centre], euler })
}

/// Positive volume, mass and diagonal of the Euler tensor, everything finite.
fn checked(volume: f64, properties: MassProperties) -> Result<MassProperties, MeshError> {
    let MassProperties { mass, centre, euler } = &properties;
    let positive = [volume, *mass, euler[0][0], euler[1][1], euler[2][2]].iter().all(|&a| a > 0.0);
    let finite =
        volume.is_finite() && mass.is_finite() && centre.iter().chain(euler.as_flattened()).all(|a| a.is_finite());
    if positive && finite { Ok(properties) } else { Err(MeshError::Volume { volume }) }
}

/// Mean of points; zero without any.
fn mean(points: &[[f64; 3]]) -> [f64; 3] {
    let scale = 1.0 / points.len().max(1) as f64;
    points.iter().fold([0.0; 3], |s, x| std::array::from_fn(|i| s[i] + scale * x[i]))
}
