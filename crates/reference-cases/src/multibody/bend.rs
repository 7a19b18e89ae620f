//! A curved cantilever in space: the equations of the rod, integrated by themselves.

use nalgebra::{Matrix3, Vector3};

/// Part of a circle in the plane of x and y from the origin along y, curving towards x, clamped there.
#[derive(Clone, Copy, Debug)]
pub struct CurvedCantilever {
    /// Stiffness against shear along the first and second direction of the section and tension, against bending about them and torsion. The first direction is `-z`.
    pub stiffness: [f64; 6],
    /// Radius.
    pub radius: f64,
    /// Angle, radians.
    pub angle: f64,
}

/// Position, rotation (columns are directors), moment.
type Rod = (Vector3<f64>, Matrix3<f64>, Vector3<f64>);

impl CurvedCantilever {
    /// Integrates `phi' = R (Gamma + e_3)`, `R' = R [K + K_0]`, `m' = -phi' x n` from the clamp with the moment `m` there and the constant force `n`.
    fn integrate(&self, n: Vector3<f64>, m: Vector3<f64>) -> Rod {
        let steps = 300;
        let h = self.radius * self.angle / f64::from(steps);
        let [a, b, c, d, e, f] = self.stiffness;
        let (strain, curvature) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
        let rates = |(_, r, m): &Rod| -> Rod {
            let gamma = (r.transpose() * n).component_div(&strain) + Vector3::z();
            let k = (r.transpose() * m).component_div(&curvature) + Vector3::x() / self.radius;
            let x = r * gamma;
            (x, r * k.cross_matrix(), -x.cross(&n))
        };
        let plus = |y: &Rod, f: f64, d: &Rod| (y.0 + f * d.0, y.1 + f * d.1, y.2 + f * d.2);
        let d1 = -Vector3::z();
        let start = Matrix3::from_columns(&[d1, Vector3::y().cross(&d1), Vector3::y()]);
        let mut y = (Vector3::zeros(), start, m);
        for _ in 0..steps {
            let k1 = rates(&y);
            let k2 = rates(&plus(&y, 0.5 * h, &k1));
            let k3 = rates(&plus(&y, 0.5 * h, &k2));
            let k4 = rates(&plus(&y, h, &k3));
            for (factor, k) in [(1.0, k1), (2.0, k2), (2.0, k3), (1.0, k4)] {
                y = plus(&y, factor * h / 6.0, &k);
            }
        }
        y
    }

    /// The tip under a force along z there, by shooting for no moment, in ten steps of the load; `None` if that does not converge.
    pub fn tip(&self, force: f64) -> Option<[f64; 3]> {
        let size = force.abs() * self.radius;
        let mut m = Vector3::zeros();
        let mut tip = Vector3::zeros();
        for step in 1..=10 {
            let n = Vector3::new(0.0, 0.0, force * f64::from(step) / 10.0);
            let mut left = f64::INFINITY;
            for _ in 0..30 {
                let (x, _, end) = self.integrate(n, m);
                (tip, left) = (x, end.norm());
                if left < 1e-10 * size {
                    break;
                }
                let shift = 1e-6 * size;
                let column = |k: usize| {
                    let mut other = m;
                    other[k] += shift;
                    (self.integrate(n, other).2 - end) / shift
                };
                m -= Matrix3::from_columns(&[column(0), column(1), column(2)]).lu().solve(&end)?;
            }
            if left > 1e-8 * size {
                return None;
            }
        }
        Some([tip.x, tip.y, tip.z])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small force on an arc: by Castigliano with `dF/dtheta`, bending `F R sin(a - t)` and torque `F R (1 - cos(a - t))`, shear `F`.
    #[test]
    fn small_force() {
        let arc = CurvedCantilever { stiffness: [3e3, 3e3, 1e4, 50.0, 40.0, 20.0], radius: 2.0, angle: 0.9 };
        let f = 1e-5;
        let tip = arc.tip(f).unwrap();
        let n = 1000;
        let h = arc.angle / f64::from(n);
        let sum: f64 = (0..n)
            .map(|i| {
                let t = h * (f64::from(i) + 0.5);
                (arc.radius * t.sin()).powi(2) / 40.0 + (arc.radius * (1.0 - t.cos())).powi(2) / 20.0 + 1.0 / 3e3
            })
            .sum();
        let expected = f * arc.radius * h * sum;
        assert!((tip[2] / expected - 1.0).abs() < 1e-6, "{} {expected}", tip[2]);
    }
}
