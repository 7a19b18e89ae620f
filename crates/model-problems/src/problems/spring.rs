//! Nonlinear springs (theory/integrators#spring; thesis (6.1)-(6.45)).

use crate::ModelProblem;
use nalgebra::DMatrix;
use stoss_integrators::State;

/// A spring between two points: `V = c L^2/8 (nu^2 - 1)^2` with `nu^2 = |r|^2/L^2`. The invariant `e = (nu^2 - 1)/2` makes it quadratic, hence
/// its discrete gradient is `c (e_n + e_np1)/2 r_mid` without a quotient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spring {
    pub stiffness: f64,
    pub length: f64,
}

/// A vector in space.
pub(super) type Vector = [f64; 3];

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn mean(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
}

impl Spring {
    fn strain(&self, r: Vector) -> f64 {
        0.5 * (dot(r, r) / (self.length * self.length) - 1.0)
    }
    pub fn potential(&self, r: Vector) -> f64 {
        let e = self.strain(r);
        0.5 * self.stiffness * self.length * self.length * e * e
    }
    pub fn force(&self, r: Vector) -> Vector {
        let f = self.stiffness * self.strain(r);
        r.map(|x| f * x)
    }
    /// `K = c e 1 + c/L^2 r (x) r`.
    pub fn stiffness(&self, r: Vector) -> [Vector; 3] {
        let f = self.stiffness * self.strain(r);
        let c = self.stiffness / (self.length * self.length);
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { f } else { 0.0 } + c * r[i] * r[j]))
    }
    pub fn discrete_force(&self, r_n: Vector, r_1: Vector) -> Vector {
        let f = self.stiffness * 0.5 * (self.strain(r_n) + self.strain(r_1));
        mean(r_n, r_1).map(|x| f * x)
    }
    /// theory/integrators#eq-spring-ems: `c/2 e_mid 1 + c/(2 L^2) r_mid (x) r_np1`.
    pub fn discrete_stiffness(&self, r_n: Vector, r_1: Vector) -> [Vector; 3] {
        let f = 0.5 * self.stiffness * 0.5 * (self.strain(r_n) + self.strain(r_1));
        let c = 0.5 * self.stiffness / (self.length * self.length);
        let mid = mean(r_n, r_1);
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { f } else { 0.0 } + c * mid[i] * r_1[j]))
    }
}

pub(super) fn node(q: &[f64], k: usize) -> Vector {
    [q[3 * k], q[3 * k + 1], q[3 * k + 2]]
}

fn between(q: &[f64]) -> Vector {
    let (a, b) = (node(q, 0), node(q, 1));
    std::array::from_fn(|i| b[i] - a[i])
}

/// Adds a block of a 3 x 3 matrix.
pub(super) fn add_block(k: [Vector; 3], factor: f64, row: usize, column: usize, out: &mut DMatrix<f64>) {
    for i in 0..3 {
        for j in 0..3 {
            out[(3 * row + i, 3 * column + j)] += factor * k[i][j];
        }
    }
}

/// A mass at the end of a spring whose other end is fixed at the origin (theory/integrators#spring).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringPendulum {
    /// Stiffness `c`, a force over a length.
    pub stiffness: f64,
    /// Length without force.
    pub length: f64,
    /// Mass.
    pub mass: f64,
    /// Initial position.
    pub position: [f64; 3],
    /// Initial momentum.
    pub momentum: [f64; 3],
}

impl SpringPendulum {
    /// `L = 1`, `m = 1`, start at `0.8 (1, 0, 1)/sqrt 2` with the momentum `(0, -12.5, 0)`: the data of theory/integrators#spring for a stiffness.
    pub fn with_stiffness(stiffness: f64) -> Self {
        let x = 0.8 / 2.0_f64.sqrt();
        Self { stiffness, length: 1.0, mass: 1.0, position: [x, 0.0, x], momentum: [0.0, -12.5, 0.0] }
    }
    /// `c = 10^3`.
    pub fn soft() -> Self {
        Self::with_stiffness(1e3)
    }
    /// `c = 10^6`.
    pub fn stiff() -> Self {
        Self::with_stiffness(1e6)
    }
    fn spring(&self) -> Spring {
        Spring { stiffness: self.stiffness, length: self.length }
    }
}

impl ModelProblem for SpringPendulum {
    fn name(&self) -> &str {
        "spring pendulum"
    }
    fn dimension(&self) -> usize {
        3
    }
    fn mass(&self) -> DMatrix<f64> {
        DMatrix::from_diagonal_element(3, 3, self.mass)
    }
    fn initial_state(&self) -> State {
        State::new(self.position.to_vec(), self.momentum.map(|p| p / self.mass).to_vec())
    }
    fn potential(&self, q: &[f64]) -> f64 {
        self.spring().potential(node(q, 0))
    }
    fn add_force(&self, q: &[f64], out: &mut [f64]) {
        let f = self.spring().force(node(q, 0));
        out.iter_mut().zip(f).for_each(|(out, f)| *out += f);
    }
    fn add_stiffness(&self, q: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        add_block(self.spring().stiffness(node(q, 0)), factor, 0, 0, out);
    }
    fn add_discrete_force(&self, q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        let f = self.spring().discrete_force(node(q_n, 0), node(q_np1, 0));
        out.iter_mut().zip(f).for_each(|(out, f)| *out += f);
    }
    fn add_discrete_stiffness(&self, q_n: &[f64], q_np1: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        add_block(self.spring().discrete_stiffness(node(q_n, 0), node(q_np1, 0)), factor, 0, 0, out);
    }
    fn spatial_nodes(&self) -> usize {
        1
    }
}

/// [`SpringPendulum`] with the augmented coordinate `w = |q|^2/L^2` (theory/integrators#eq-spring-augmented; thesis (6.40)): no mass, `V = c L^2/8 (w - 1)^2`, and the constraint
/// `Phi = w - |q|^2/L^2 = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AugmentedSpringPendulum(pub SpringPendulum);

impl ModelProblem for AugmentedSpringPendulum {
    fn name(&self) -> &str {
        "spring pendulum, augmented"
    }
    fn dimension(&self) -> usize {
        4
    }
    fn mass(&self) -> DMatrix<f64> {
        let m = self.0.mass;
        DMatrix::from_diagonal(&nalgebra::DVector::from_vec(vec![m, m, m, 0.0]))
    }
    fn initial_state(&self) -> State {
        let mut state = self.0.initial_state();
        let (q, v) = (node(&state.q, 0), node(&state.v, 0));
        let squared = self.0.length * self.0.length;
        state.q.push(dot(q, q) / squared);
        state.v.push(2.0 * dot(q, v) / squared);
        state
    }
    fn potential(&self, q: &[f64]) -> f64 {
        self.0.stiffness * self.0.length.powi(2) / 8.0 * (q[3] - 1.0).powi(2)
    }
    fn add_force(&self, q: &[f64], out: &mut [f64]) {
        out[3] += 0.25 * self.0.stiffness * self.0.length.powi(2) * (q[3] - 1.0);
    }
    fn add_stiffness(&self, _q: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        out[(3, 3)] += factor * 0.25 * self.0.stiffness * self.0.length.powi(2);
    }
    fn add_discrete_force(&self, q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        out[3] += 0.25 * self.0.stiffness * self.0.length.powi(2) * (0.5 * (q_n[3] + q_np1[3]) - 1.0);
    }
    fn add_discrete_stiffness(&self, _q_n: &[f64], q_np1: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        self.add_stiffness(q_np1, 0.5 * factor, out);
    }
    fn constraint_count(&self) -> usize {
        1
    }
    fn constraints(&self, q: &[f64], out: &mut [f64]) {
        out[0] = q[3] - dot(node(q, 0), node(q, 0)) / self.0.length.powi(2);
    }
    fn jacobian(&self, q: &[f64], out: &mut DMatrix<f64>) {
        for i in 0..3 {
            out[(0, i)] = -2.0 * q[i] / self.0.length.powi(2);
        }
        out[(0, 3)] = 1.0;
    }
    fn add_constraint_hessian(&self, p: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        for i in 0..3 {
            out[(i, i)] -= factor * p[0] * 2.0 / self.0.length.powi(2);
        }
    }
    fn spatial_nodes(&self) -> usize {
        1
    }
}

/// Two masses joined by a spring, free in space: a system with both momenta and energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringPair {
    /// Stiffness `c` of the spring of unit length.
    pub stiffness: f64,
    /// The two masses.
    pub masses: [f64; 2],
}

impl Default for SpringPair {
    fn default() -> Self {
        Self { stiffness: 1e3, masses: [1.0, 2.0] }
    }
}

impl SpringPair {
    fn spring(&self) -> Spring {
        Spring { stiffness: self.stiffness, length: 1.0 }
    }
}

fn add_pair(f: Vector, out: &mut [f64]) {
    for i in 0..3 {
        out[i] -= f[i];
        out[3 + i] += f[i];
    }
}

fn add_pair_block(k: [Vector; 3], factor: f64, out: &mut DMatrix<f64>) {
    for (row, column, sign) in [(0, 0, 1.0), (1, 1, 1.0), (0, 1, -1.0), (1, 0, -1.0)] {
        add_block(k, sign * factor, row, column, out);
    }
}

impl ModelProblem for SpringPair {
    fn name(&self) -> &str {
        "spring pair"
    }
    fn dimension(&self) -> usize {
        6
    }
    fn mass(&self) -> DMatrix<f64> {
        DMatrix::from_fn(6, 6, |i, j| if i == j { self.masses[i / 3] } else { 0.0 })
    }
    fn initial_state(&self) -> State {
        let x = 0.8 / 2.0_f64.sqrt();
        State::new(vec![0.0, 0.0, 0.0, x, 0.1, x], vec![0.3, 1.0, -0.2, 0.0, -9.0, 0.4])
    }
    fn potential(&self, q: &[f64]) -> f64 {
        self.spring().potential(between(q))
    }
    fn add_force(&self, q: &[f64], out: &mut [f64]) {
        add_pair(self.spring().force(between(q)), out);
    }
    fn add_stiffness(&self, q: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        add_pair_block(self.spring().stiffness(between(q)), factor, out);
    }
    fn add_discrete_force(&self, q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        add_pair(self.spring().discrete_force(between(q_n), between(q_np1)), out);
    }
    fn add_discrete_stiffness(&self, q_n: &[f64], q_np1: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        add_pair_block(self.spring().discrete_stiffness(between(q_n), between(q_np1)), factor, out);
    }
    fn spatial_nodes(&self) -> usize {
        2
    }
}
