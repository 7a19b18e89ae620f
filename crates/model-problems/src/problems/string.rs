//! A string of finite elements that hangs from a fixed point (thesis figure 6.1, right).

use super::spring::{Spring, Vector, add_block, node};
use crate::ModelProblem;
use nalgebra::DMatrix;
use stoss_integrators::State;

/// Linear string elements with the potential of [`super::SpringPendulum`] per element: `V_e = c L h/8 (nu^2 - 1)^2`, `nu = |x_b - x_a|/h`, `h = L/elements`.
/// With one element it is the spring, with the consistent mass of a string.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StringPendulum {
    /// Number of elements.
    pub elements: usize,
    /// Stiffness `c` of the whole string, a force over a length.
    pub stiffness: f64,
    /// Length without force.
    pub length: f64,
    /// Mass of the string, evenly distributed.
    pub string_mass: f64,
    /// Mass at its end.
    pub end_mass: f64,
    /// Initial stretch.
    pub stretch: f64,
    /// Initial velocity of the end; linear along the string.
    pub velocity: [f64; 3],
}

impl StringPendulum {
    /// The data of the spring of theory/integrators#spring with so many elements, half of the mass in the string.
    pub fn new(elements: usize, stiffness: f64) -> Self {
        Self {
            elements: elements.max(1),
            stiffness,
            length: 1.0,
            string_mass: 0.5,
            end_mass: 0.5,
            stretch: 0.8,
            velocity: [0.0, -12.5, 0.0],
        }
    }

    fn spring(&self) -> Spring {
        // V_e = c_e h^2/8 (nu^2 - 1)^2 with c_e = c L/h.
        let h = self.length / self.elements as f64;
        Spring { stiffness: self.stiffness * self.elements as f64, length: h }
    }

    /// The way from the upper to the lower node of an element; the first hangs from the origin.
    fn edge(q: &[f64], element: usize) -> Vector {
        let b = node(q, element);
        if element == 0 {
            return b;
        }
        let a = node(q, element - 1);
        std::array::from_fn(|i| b[i] - a[i])
    }

    fn scatter(element: usize, f: Vector, out: &mut [f64]) {
        for i in 0..3 {
            out[3 * element + i] += f[i];
            if element > 0 {
                out[3 * (element - 1) + i] -= f[i];
            }
        }
    }

    fn scatter_block(element: usize, k: [Vector; 3], factor: f64, out: &mut DMatrix<f64>) {
        add_block(k, factor, element, element, out);
        if element > 0 {
            add_block(k, factor, element - 1, element - 1, out);
            add_block(k, -factor, element - 1, element, out);
            add_block(k, -factor, element, element - 1, out);
        }
    }
}

impl ModelProblem for StringPendulum {
    fn name(&self) -> &str {
        "string pendulum"
    }
    fn dimension(&self) -> usize {
        3 * self.elements
    }
    fn mass(&self) -> DMatrix<f64> {
        let n = self.dimension();
        let m = self.string_mass / self.elements as f64 / 6.0;
        let mut out = DMatrix::zeros(n, n);
        for e in 0..self.elements {
            for i in 0..3 {
                let b = 3 * e + i;
                out[(b, b)] += 2.0 * m;
                if e > 0 {
                    out[(b - 3, b - 3)] += 2.0 * m;
                    out[(b, b - 3)] += m;
                    out[(b - 3, b)] += m;
                }
            }
        }
        for i in n - 3..n {
            out[(i, i)] += self.end_mass;
        }
        out
    }
    fn initial_state(&self) -> State {
        let direction = [1.0 / 2.0_f64.sqrt(), 0.0, 1.0 / 2.0_f64.sqrt()];
        let (mut q, mut v) = (Vec::new(), Vec::new());
        for e in 1..=self.elements {
            let s = e as f64 / self.elements as f64;
            q.extend(direction.map(|d| self.stretch * self.length * s * d));
            v.extend(self.velocity.map(|v| s * v));
        }
        State::new(q, v)
    }
    fn potential(&self, q: &[f64]) -> f64 {
        (0..self.elements).map(|e| self.spring().potential(Self::edge(q, e))).sum()
    }
    fn add_force(&self, q: &[f64], out: &mut [f64]) {
        for e in 0..self.elements {
            Self::scatter(e, self.spring().force(Self::edge(q, e)), out);
        }
    }
    fn add_stiffness(&self, q: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        for e in 0..self.elements {
            Self::scatter_block(e, self.spring().stiffness(Self::edge(q, e)), factor, out);
        }
    }
    fn add_discrete_force(&self, q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        for e in 0..self.elements {
            Self::scatter(e, self.spring().discrete_force(Self::edge(q_n, e), Self::edge(q_np1, e)), out);
        }
    }
    fn add_discrete_stiffness(&self, q_n: &[f64], q_np1: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        for e in 0..self.elements {
            let k = self.spring().discrete_stiffness(Self::edge(q_n, e), Self::edge(q_np1, e));
            Self::scatter_block(e, k, factor, out);
        }
    }
    fn spatial_nodes(&self) -> usize {
        self.elements
    }
}
