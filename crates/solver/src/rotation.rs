//! Rotation about a fixed axis as a function of time.

use crate::Table;

/// Rotation by an angle that depends on time about an axis through a point.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisRotation {
    axis: [f64; 3],
    about: [f64; 3],
    degrees: Table,
}

impl AxisRotation {
    /// Whether the rotation leaves this component of every point as it is: the axis lies along it.
    pub fn keeps(&self, component: u8) -> bool {
        (0..3).all(|i| i == usize::from(component) || self.axis[i] == 0.0)
    }

    /// Rotation about the direction `axis` (any length but zero) through the point `about` (a length each); `degrees` has one column, positive by the
    /// right-hand rule. Nothing if the axis is zero, a number is not finite or the table has not one column.
    pub fn new(axis: [f64; 3], about: [f64; 3], degrees: Table) -> Option<Self> {
        let largest = axis.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let finite = axis.iter().chain(&about).all(|x| x.is_finite());
        if !finite || largest == 0.0 || degrees.columns() != 1 {
            return None;
        }
        let scaled = axis.map(|a| a / largest);
        let length = scaled.iter().map(|a| a * a).sum::<f64>().sqrt();
        Some(Self { axis: scaled.map(|a| a / length), about, degrees })
    }

    /// The angle as a function of time.
    pub(crate) fn degrees(&self) -> &Table {
        &self.degrees
    }

    /// The angle as a function of time, to be changed.
    pub(crate) fn degrees_mut(&mut self) -> &mut Table {
        &mut self.degrees
    }

    /// The rotation by the same angle about the parallel axis through the origin.
    pub(crate) fn about_origin(&self) -> Self {
        Self { about: [0.0; 3], ..self.clone() }
    }

    /// `(R - 1) (X - c) = sin n x d + (1 - cos) n x (n x d)` with `d = X - c`. `1 - cos` is taken as `2 sin^2` of half the angle, so that
    /// small angles lose no digits.
    pub(crate) fn displacement(&self, reference: [f64; 3], time: f64) -> [f64; 3] {
        let (first, second) = self.products(reference);
        let angle = self.degrees.value(time, 0).to_radians();
        let (s, h) = (angle.sin(), (0.5 * angle).sin());
        std::array::from_fn(|i| s * first[i] + 2.0 * h * h * second[i])
    }

    /// `angle' n x R d = angle' (cos n x d + sin n x (n x d))`, just after a time.
    pub(crate) fn velocity(&self, reference: [f64; 3], time: f64) -> [f64; 3] {
        let (first, second) = self.products(reference);
        let (s, c) = self.degrees.value(time, 0).to_radians().sin_cos();
        let rate = self.degrees.slope(time, 0).to_radians();
        std::array::from_fn(|i| rate * (c * first[i] + s * second[i]))
    }

    /// `n x d` and `n x (n x d)`.
    fn products(&self, reference: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let d = std::array::from_fn(|i| reference[i] - self.about[i]);
        let first = cross(self.axis, d);
        (first, cross(self.axis, first))
    }
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[[f64; 2]]) -> Table {
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
        Table::from_rows(&rows, 1).unwrap()
    }

    fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) {
        assert!((0..3).all(|i| (a[i] - b[i]).abs() <= tolerance), "{a:?} {b:?}");
    }

    /// A third of a turn about the diagonal exchanges the axes; a quarter about z through (1, 0, 0) takes (2, 0, 5) to (1, 1, 5).
    #[test]
    fn turns_worked_out_by_hand() {
        let third = AxisRotation::new([2.0; 3], [0.0; 3], Table::constant(&[120.0])).unwrap();
        close(third.displacement([1.0, 0.0, 0.0], 0.0), [-1.0, 1.0, 0.0], 1e-15);
        let quarter = AxisRotation::new([0.0, 0.0, 3.0], [1.0, 0.0, 0.0], table(&[[0.0, 0.0], [1.0, 90.0]])).unwrap();
        close(quarter.displacement([2.0, 0.0, 5.0], 1.0), [-1.0, 1.0, 0.0], 1e-15);
        // At t = 0 the point moves along y with pi/2 a unit of time.
        close(quarter.velocity([2.0, 0.0, 5.0], 0.0), [0.0, std::f64::consts::FRAC_PI_2, 0.0], 1e-15);
        close(quarter.velocity([2.0, 0.0, 5.0], 2.0), [0.0; 3], 0.0);
        assert!(AxisRotation::new([0.0; 3], [0.0; 3], Table::constant(&[1.0])).is_none());
        assert!(AxisRotation::new([1.0, 0.0, 0.0], [0.0; 3], Table::constant(&[1.0, 2.0])).is_none());
    }

    /// Distances from the axis stay, for any angle; the velocity is the derivative of the position.
    #[test]
    fn rigid_and_differentiable() {
        let (axis, about, x) = ([0.3, -1.1, 0.7], [0.2, 0.4, -0.9], [1.3, -0.8, 2.1]);
        let rotation = AxisRotation::new(axis, about, table(&[[0.0, -400.0], [10.0, 900.0]])).unwrap();
        let arm = |u: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| x[i] + u[i] - about[i]) };
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let d = arm([0.0; 3]);
        for k in 0..50 {
            let t = 0.19 * f64::from(k);
            let u = rotation.displacement(x, t);
            assert!((dot(arm(u), arm(u)) - dot(d, d)).abs() < 1e-14 * dot(d, d));
            assert!(dot(u, axis).abs() < 1e-14);
            let h = 1e-5;
            let (up, um) = (rotation.displacement(x, t + h), rotation.displacement(x, t - h));
            if t > h {
                let slope = std::array::from_fn(|i| (up[i] - um[i]) / (2.0 * h));
                close(rotation.velocity(x, t), slope, 1e-8);
            }
        }
    }
}
