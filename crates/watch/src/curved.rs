//! Quadratic faces: what lies between the flat pieces that a surface is made of and the true face.

use nalgebra::Vector3;
use stoss_reference_element::{FaceKind, FaceNodes};

/// A quadratic face by places of its nodes in the points of a surface.
#[derive(Clone, Debug)]
pub(crate) struct CurvedFace {
    nodes: FaceNodes,
}

impl CurvedFace {
    /// The face with nodes in the numbers that `place` gives.
    pub fn new(nodes: &FaceNodes, place: impl Fn(u32) -> u32) -> Self {
        Self { nodes: nodes.map(place) }
    }

    /// Kind of the face.
    pub fn kind(&self) -> FaceKind {
        self.nodes.kind()
    }

    /// The point of the face at `xi`.
    pub fn point(&self, points: &[Vector3<f64>], xi: [f64; 2]) -> Vector3<f64> {
        let shape = self.kind().shape(xi);
        self.nodes.iter().zip(shape).map(|(&k, n)| points[k as usize] * n).sum()
    }

    fn tangents(&self, points: &[Vector3<f64>], xi: [f64; 2]) -> [Vector3<f64>; 2] {
        let gradient = self.kind().shape_gradient(xi);
        [0, 1].map(|a: usize| self.nodes.iter().zip(&gradient).map(|(&k, dn)| points[k as usize] * dn[a]).sum())
    }

    /// Height of `x` over the face (a length, positive outside of the body), along the normal at the nearest point of the face, which is sought from `start` (natural coordinates); nothing
    /// where the face has no normal.
    pub fn height(&self, points: &[Vector3<f64>], x: &Vector3<f64>, start: [f64; 2]) -> Option<f64> {
        /// Steps of Newton's method without the curvature: each leaves the distance over the radius of what was left.
        const STEPS: usize = 20;
        const SMALL: f64 = 1.0e-12;
        let mut xi = start;
        for _ in 0..STEPS {
            let [a, b] = self.tangents(points, xi);
            let apart = x - self.point(points, xi);
            let (aa, ab, bb) = (a.norm_squared(), a.dot(&b), b.norm_squared());
            let det = aa * bb - ab * ab;
            if det <= SMALL * aa * bb {
                return None;
            }
            let (ra, rb) = (a.dot(&apart), b.dot(&apart));
            let next = self.within([xi[0] + (bb * ra - ab * rb) / det, xi[1] + (aa * rb - ab * ra) / det]);
            let moved = (next[0] - xi[0]).abs().max((next[1] - xi[1]).abs());
            xi = next;
            if moved < SMALL {
                break;
            }
        }
        let [a, b] = self.tangents(points, xi);
        let normal = a.cross(&b).try_normalize(0.0)?;
        Some(normal.dot(&(x - self.point(points, xi))))
    }

    /// The point of the domain near natural coordinates.
    fn within(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        if self.kind().corner_count() == 4 {
            return [a.clamp(-1.0, 1.0), b.clamp(-1.0, 1.0)];
        }
        let (a, b) = (a.max(0.0), b.max(0.0));
        let beyond = (a + b).max(1.0);
        [a / beyond, b / beyond]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points beside a piece of a cylinder of quadratic faces: the height is the distance from it, to the fourth order of the angle of a face (the arch over the chord is 0.04 here).
    #[test]
    fn heights_over_a_cylinder_are_those_of_its_radius() {
        for kind in [FaceKind::Quad8, FaceKind::Quad9, FaceKind::Tri6] {
            let (radius, angle) = (2.0, 0.2);
            let on = |[a, b]: [f64; 2], r: f64| Vector3::new(r * (angle * a).cos(), r * (angle * a).sin(), b);
            let points: Vec<_> = kind.nodes().iter().map(|&xi| on(xi, radius)).collect();
            let face = CurvedFace::new(&FaceNodes::from_fn(kind, |k| k as u32), |k| k);
            for (xi, off) in [([0.3, 0.2], 0.1), ([0.5, 0.1], -0.2), ([0.1, 0.6], 1e-3), ([0.25, 0.25], 0.0)] {
                let height = face.height(&points, &on(xi, radius + off), [0.3, 0.3]).unwrap();
                assert!((height - off).abs() < 1e-4, "{kind:?} {xi:?}: {height} for {off}");
            }
        }
    }
}
