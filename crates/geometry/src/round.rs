//! Cylinders and spheres through points.

use nalgebra::{Matrix3, Matrix4, Matrix5, Vector3, Vector4, Vector5};

/// Iterations of the fit; a few are usual.
const ITERATIONS: usize = 50;

/// A cylinder or a sphere.
#[derive(Clone, Copy, Debug)]
pub enum Round {
    /// The points at the distance `radius` from an axis.
    Cylinder {
        /// A point of the axis.
        origin: Vector3<f64>,
        /// Direction of the axis, a unit vector.
        axis: Vector3<f64>,
        /// Radius, a length.
        radius: f64,
    },
    /// The points at the distance `radius` from a centre.
    Sphere {
        /// The centre.
        centre: Vector3<f64>,
        /// A length.
        radius: f64,
    },
}

impl Round {
    /// The point of the surface nearest to `x`.
    pub fn nearest(&self, x: &Vector3<f64>) -> Vector3<f64> {
        match *self {
            Self::Cylinder { origin, axis, radius } => {
                let along = axis * (x - origin).dot(&axis);
                let across = x - origin - along;
                origin + along + across * (radius / across.norm())
            }
            Self::Sphere { centre, radius } => centre + (x - centre) * (radius / (x - centre).norm()),
        }
    }

    /// Distance of `x` from the surface, a length.
    pub fn distance(&self, x: &Vector3<f64>) -> f64 {
        (x - self.nearest(x)).norm()
    }

    /// The sphere through points, in the sense of least squares of `|x|^2 - 2 c . x - d`; `None` if they are in a plane.
    pub fn sphere(points: &[Vector3<f64>]) -> Option<Self> {
        let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        let (mut a, mut b) = (Matrix4::zeros(), Vector4::zeros());
        for x in points {
            let x = x - mean;
            let row = Vector4::new(2.0 * x[0], 2.0 * x[1], 2.0 * x[2], 1.0);
            a += row * row.transpose();
            b += row * x.norm_squared();
        }
        let s = a.try_inverse()? * b;
        let centre = Vector3::new(s[0], s[1], s[2]);
        let radius = (s[3] + centre.norm_squared()).sqrt();
        (radius > 0.0 && radius.is_finite()).then_some(Self::Sphere { centre: centre + mean, radius })
    }

    /// The cylinder through points: the axis first from the normals of facets (weighted by areas), which are perpendicular to it, then by Gauss-Newton on the distances; `None` if no circle fits the points across the axis.
    pub fn cylinder(points: &[Vector3<f64>], normals: &[Vector3<f64>]) -> Option<Self> {
        let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        let spread = normals.iter().map(|n| n * n.transpose() / n.norm()).sum::<Matrix3<f64>>();
        let eigen = spread.symmetric_eigen();
        let mut axis: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
        let frame = |axis: &Vector3<f64>| {
            let u = axis.cross(&if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() }).normalize();
            [u, axis.cross(&u)]
        };
        // A circle in the plane across the axis.
        let [u, v] = frame(&axis);
        let (mut a, mut b) = (Matrix3::zeros(), Vector3::zeros());
        for x in points {
            let x = x - mean;
            let (p, q) = (x.dot(&u), x.dot(&v));
            let row = Vector3::new(2.0 * p, 2.0 * q, 1.0);
            a += row * row.transpose();
            b += row * (p * p + q * q);
        }
        let s = a.try_inverse()? * b;
        let mut origin = u * s[0] + v * s[1];
        let mut radius = (s[2] + s[0] * s[0] + s[1] * s[1]).sqrt();
        for _ in 0..ITERATIONS {
            let [u, v] = frame(&axis);
            let (mut a, mut b) = (Matrix5::zeros(), Vector5::zeros());
            for x in points {
                let x = x - mean - origin;
                let along = x.dot(&axis);
                let across = x - axis * along;
                let r = across.norm();
                let e = across / r;
                // Of the distance by the origin and the axis, each along u and v, and by the radius.
                let row = Vector5::new(-e.dot(&u), -e.dot(&v), -along * e.dot(&u), -along * e.dot(&v), -1.0);
                a += row * row.transpose();
                b -= row * (r - radius);
            }
            let s = a.try_inverse()? * b;
            origin += u * s[0] + v * s[1];
            axis = (axis + u * s[2] + v * s[3]).normalize();
            radius += s[4];
            if s.norm() <= 1e-14 * radius {
                break;
            }
        }
        (radius > 0.0 && radius.is_finite()).then_some(Self::Cylinder { origin: origin + mean, axis, radius })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a quarter of a cylinder about a leaning axis, with their normals.
    fn quarter(radius: f64) -> ([Vector3<f64>; 2], Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
        let axis = Vector3::new(0.3, -0.2, 0.9).normalize();
        let origin = Vector3::new(1.0, 2.0, -1.0);
        let u = axis.cross(&Vector3::x()).normalize();
        let v = axis.cross(&u);
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        for k in 0..6 {
            let angle = 0.3 * f64::from(k);
            let normal = u * angle.cos() + v * angle.sin();
            for z in [0.0, 0.7, 1.9] {
                points.push(origin + axis * z + normal * radius);
                normals.push(normal * 0.2);
            }
        }
        ([origin, axis], points, normals)
    }

    #[test]
    fn a_cylinder_is_found_from_a_quarter_of_it() {
        let ([at, along], points, normals) = quarter(1.7);
        let Some(Round::Cylinder { origin, axis, radius }) = Round::cylinder(&points, &normals) else { panic!() };
        assert!((radius - 1.7).abs() < 1e-12 && axis.cross(&along).norm() < 1e-12);
        assert!((origin - at).cross(&along).norm() < 1e-12);
        let round = Round::Cylinder { origin, axis, radius };
        let x = at + along * 0.4 + (points[0] - at) * 2.0;
        let out = points[0] - at;
        assert!((round.distance(&x) - (2.0 * out.norm() - 1.7)).abs() < 1e-12);
        assert!(round.distance(&round.nearest(&x)) < 1e-14);
    }

    #[test]
    fn a_sphere_is_found_and_a_plane_is_none() {
        let (_, points, _) = quarter(1.0);
        let centre = Vector3::new(0.5, 0.1, -3.0);
        let on: Vec<Vector3<f64>> = points.iter().map(|x| centre + x.normalize() * 2.5).collect();
        let Some(Round::Sphere { centre: found, radius }) = Round::sphere(&on) else { panic!() };
        assert!((found - centre).norm() < 1e-11 && (radius - 2.5).abs() < 1e-11);
        let flat: Vec<Vector3<f64>> = (0..9).map(|k| Vector3::new(f64::from(k % 3), f64::from(k / 3), 0.0)).collect();
        assert!(Round::sphere(&flat).is_none());
    }
}
