//! Parallel projection on a picture plane.

/// Direction from which a scene is seen; z points up in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Degrees about z, from the x axis to the horizontal direction towards the eye.
    pub azimuth: f64,
    /// Degrees of the eye above the horizon.
    pub elevation: f64,
}

/// Right, up and towards the eye: an orthonormal, right-handed basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Unit vector to the right of the picture.
    pub right: [f64; 3],
    /// Unit vector to the top of the picture.
    pub up: [f64; 3],
    /// Unit vector towards the eye.
    pub eye: [f64; 3],
}

impl Camera {
    /// The basis of the picture.
    pub fn view(self) -> View {
        let (sa, ca) = self.azimuth.to_radians().sin_cos();
        let (se, ce) = self.elevation.to_radians().sin_cos();
        View { right: [-sa, ca, 0.0], up: [-se * ca, -se * sa, ce], eye: [ce * ca, ce * sa, se] }
    }
}

impl View {
    /// Right, up and nearness of a point.
    pub fn project(&self, point: [f64; 3]) -> [f64; 3] {
        [dot(self.right, point), dot(self.up, point), dot(self.eye, point)]
    }
}

/// Scalar product.
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_is_orthonormal_and_right_handed() {
        let view = Camera { azimuth: 37.0, elevation: 21.0 }.view();
        for vector in [view.right, view.up, view.eye] {
            assert!((dot(vector, vector) - 1.0).abs() < 1e-14);
        }
        let eye = cross(view.right, view.up);
        assert!((dot(eye, view.eye) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn from_the_front_x_is_right_and_z_is_up() {
        let view = Camera { azimuth: -90.0, elevation: 0.0 }.view();
        let [right, up, near] = view.project([1.0, -2.0, 3.0]);
        assert!((right - 1.0).abs() < 1e-14 && (up - 3.0).abs() < 1e-14 && (near - 2.0).abs() < 1e-14);
    }
}
