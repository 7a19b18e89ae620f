//! Elements whose change of volume is averaged, for nearly incompressible solids (theory/elements#mixed). Not the laws' parts, not the loop over elements.
//!
//! The energy of an element is `sum_h w_h W(C_h) + sum_h w_h U(theta_h)`: `theta` is the best constant, or the best function that is linear in natural
//! coordinates, for the `J_h` of the Gauss points. With functions `psi_a` that are orthonormal with the weights `w_h` it is
//! `theta_h = sum_a psi_a(h) sum_g w_g psi_a(g) J_g`, and the pressure at a point is the same average of `U'(theta)`.

use crate::{
    ForceRule, TimeLevel,
    element::{self, ElementHistory, ElementStep, Failure, FailureKind, Geometry},
    kernel::{self, ElementIntegration, LocalTangent, Matrix3, NodalVectors, TangentFactors, TangentPoint},
    laws::Laws,
};
use stoss_continuum::{
    SymmetricTensor2, VolumetricEnergy,
    volume::{discrete_jacobian_gradient, discrete_jacobian_gradient_tangent, pressure_stress},
};

/// Values of the `A` orthonormal functions at the Gauss points.
pub(crate) type Basis<const G: usize, const A: usize> = [[f64; G]; A];

/// The basis of the constant.
pub(crate) fn constant<const G: usize>(weights: &[f64; G]) -> Basis<G, 1> {
    [[1.0 / weights.iter().sum::<f64>().sqrt(); G]]
}

/// The basis of the functions that are linear in natural coordinates; `points` are those of the Gauss points.
pub(crate) fn linear<const G: usize>(weights: &[f64; G], points: &[[f64; 3]; G]) -> Basis<G, 4> {
    let mut basis: Basis<G, 4> =
        std::array::from_fn(|a| std::array::from_fn(|g| if a == 0 { 1.0 } else { points[g][a - 1] }));
    // Gram and Schmidt; twice, so that the functions are orthogonal to round-off.
    for a in 0..4 {
        for _ in 0..2 {
            for b in 0..a {
                let product: f64 = (0..G).map(|g| weights[g] * basis[a][g] * basis[b][g]).sum();
                for g in 0..G {
                    basis[a][g] -= product * basis[b][g];
                }
            }
        }
        let norm = (0..G).map(|g| weights[g] * basis[a][g] * basis[a][g]).sum::<f64>().sqrt();
        basis[a].iter_mut().for_each(|value| *value /= norm);
    }
    basis
}

/// Both terms of the energy of a mixed body, as the elements see them.
#[derive(Clone, Copy)]
pub(crate) struct MixedEnergy<'a> {
    /// `W`.
    pub rest: Laws<'a>,
    /// `U`.
    pub volume: &'a dyn VolumetricEnergy,
}

/// One element with its averages.
#[derive(Clone, Copy)]
pub(crate) struct Mixed<'a, const N: usize, const G: usize, const A: usize> {
    pub parts: MixedEnergy<'a>,
    pub geometry: Geometry<'a, N, G>,
    /// Gradients at all points, of the same element.
    pub integration: &'a ElementIntegration<N, G>,
    pub basis: Basis<G, A>,
}

/// One element with the averages of its kind.
#[derive(Clone, Copy)]
pub(crate) enum Averages<'a, const N: usize, const G: usize> {
    Constant(Mixed<'a, N, G, 1>),
    Linear(Mixed<'a, N, G, 4>),
}

macro_rules! for_both {
    ($averages:expr, $mixed:ident => $call:expr) => {
        match $averages {
            Averages::Constant($mixed) => $call,
            Averages::Linear($mixed) => $call,
        }
    };
}

impl<const N: usize, const G: usize> Averages<'_, N, G> {
    pub fn state(&self, q: &NodalVectors<N>, level: TimeLevel) -> Result<State<G>, Failure> {
        for_both!(self, mixed => mixed.state(q, level))
    }

    pub fn pressure_and_energy(&self, state: &State<G>) -> ([f64; G], [f64; G]) {
        for_both!(self, mixed => mixed.pressure_and_energy(state))
    }

    pub fn energy(&self, q: &NodalVectors<N>) -> Result<f64, Failure> {
        for_both!(self, mixed => mixed.energy(q))
    }

    pub fn history(&self, q: &NodalVectors<N>) -> Result<(ElementHistory<G>, [f64; G]), Failure> {
        for_both!(self, mixed => mixed.history(q))
    }

    // Not inlined: an element without averages does not need its stack.
    #[inline(never)]
    pub fn force_and_tangent(
        &self,
        step: ElementStep<'_, N, G>,
        jacobians: Option<&[f64; G]>,
        before: Option<&NodalVectors<N>>,
        factor: f64,
        force: &mut NodalVectors<N>,
        tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    ) -> Result<(), Failure> {
        for_both!(self, mixed => mixed.force_and_tangent(step, jacobians, before, factor, force, tangent))
    }
}

/// Strains, averages and pressures at the Gauss points.
pub(crate) struct State<const G: usize> {
    pub deformation_gradients: [Matrix3; G],
    pub right_cauchy_green: [SymmetricTensor2; G],
    pub jacobians: [f64; G],
    pub dilatations: [f64; G],
}

impl<const N: usize, const G: usize, const A: usize> Mixed<'_, N, G, A> {
    /// The best function of the basis for values at the Gauss points.
    fn average(&self, values: &[f64; G]) -> [f64; G] {
        let mut out = [0.0; G];
        for psi in &self.basis {
            let coefficient: f64 = (0..G).map(|g| self.integration.weights[g] * psi[g] * values[g]).sum();
            for g in 0..G {
                out[g] += coefficient * psi[g];
            }
        }
        out
    }

    /// A function of the dilatations at the points; once, if they are all the same.
    fn at_points(value: impl Fn(usize) -> (f64, f64)) -> ([f64; G], [f64; G]) {
        let (mut first, mut second) = ([0.0; G], [0.0; G]);
        for g in 0..G {
            if A == 1 && g > 0 {
                (first[g], second[g]) = (first[0], second[0]);
            } else {
                (first[g], second[g]) = value(g);
            }
        }
        (first, second)
    }

    /// The state at a configuration, `det F` and the averages checked.
    pub fn state(&self, q: &NodalVectors<N>, level: TimeLevel) -> Result<State<G>, Failure> {
        let (deformation_gradients, right_cauchy_green) = self.geometry.all_strains(q, level)?;
        let jacobians = deformation_gradients.map(|f| kernel::determinant(&f));
        let dilatations = self.average(&jacobians);
        let out = State { deformation_gradients, right_cauchy_green, jacobians, dilatations };
        for (gauss_point, &dilatation) in out.dilatations.iter().enumerate() {
            if dilatation <= 0.0 || dilatation.is_nan() {
                return Err(Failure { gauss_point, kind: FailureKind::Collapsed { dilatation, level } });
            }
        }
        Ok(out)
    }

    /// Averaged pressure at the Gauss points, and the energy `U` there.
    pub fn pressure_and_energy(&self, state: &State<G>) -> ([f64; G], [f64; G]) {
        let volume = self.parts.volume;
        let (pressure, energy) =
            Self::at_points(|g| (volume.pressure(state.dilatations[g]).0, volume.energy(state.dilatations[g])));
        (self.average(&pressure), energy)
    }

    /// `sum w (W + U)`.
    pub fn energy(&self, q: &NodalVectors<N>) -> Result<f64, Failure> {
        let state = self.state(q, TimeLevel::End)?;
        let (_, of_volume) = self.pressure_and_energy(&state);
        let mut total = 0.0;
        for g in 0..G {
            let rest =
                self.parts.rest.at(g).energy(&state.right_cauchy_green[g]).map_err(|e| FailureKind::from(e).at(g))?;
            total += self.integration.weights[g] * (rest + of_volume[g]);
        }
        Ok(total)
    }

    /// `C_n`, `W_n` and `J_n` at every Gauss point.
    pub fn history(&self, q: &NodalVectors<N>) -> Result<(ElementHistory<G>, [f64; G]), Failure> {
        let state = self.state(q, TimeLevel::Start)?;
        let history = element::history(self.parts.rest, self.geometry, q)?;
        Ok((history, state.jacobians))
    }

    /// Internal force and, if wanted, `factor` times its derivative by `q_np1` (both overwritten). `jacobians`: `J_n`, read by the energy-momentum rule.
    pub fn force_and_tangent(
        &self,
        step: ElementStep<'_, N, G>,
        jacobians: Option<&[f64; G]>,
        before: Option<&NodalVectors<N>>,
        factor: f64,
        force: &mut NodalVectors<N>,
        tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    ) -> Result<(), Failure> {
        *force = [[0.0; N]; 3];
        match (step.rule, step.history, jacobians) {
            (ForceRule::DiscreteGradient, Some(history), Some(jacobians)) => {
                self.energy_momentum(step, history, jacobians, before, factor, force, tangent)
            }
            // The body hands over the history whenever the rule is energy-momentum.
            (ForceRule::DiscreteGradient, ..) => unreachable!("energy-momentum rule without history"),
            (ForceRule::Configuration { theta }, ..) => {
                if !step.rule.reads_start() {
                    return self.one_configuration(step.q_np1, TimeLevel::End, before, factor, force, tangent);
                }
                if !step.rule.reads_end() {
                    return self.one_configuration(step.q_n, TimeLevel::Start, None, 0.0, force, None);
                }
                self.state(step.q_np1, TimeLevel::End)?;
                let q = element::between(step.q_n, step.q_np1, theta);
                let before = before.map(|before| element::between(step.q_n, before, theta));
                self.one_configuration(&q, TimeLevel::Intermediate, before.as_ref(), theta * factor, force, tangent)
            }
        }
    }

    /// Stress and `B` at one configuration: `S = S_W + p J C^-1` with the averaged pressure.
    fn one_configuration(
        &self,
        q: &NodalVectors<N>,
        level: TimeLevel,
        before: Option<&NodalVectors<N>>,
        factor: f64,
        force: &mut NodalVectors<N>,
        mut tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    ) -> Result<(), Failure> {
        let state = self.state(q, level)?;
        let (pressure, slope) = Self::at_points(|g| self.parts.volume.pressure(state.dilatations[g]));
        let pressure = self.average(&pressure);
        let continued = match before {
            Some(before) if tangent.is_some() => self
                .continued(&state, before, |g, dilatations| self.parts.volume.pressure(dilatations[g]))
                .unwrap_or(pressure),
            _ => pressure,
        };
        let mut changes = [[[0.0; N]; 3]; A];
        for g in 0..G {
            let (f, c, j) = (&state.deformation_gradients[g], &state.right_cauchy_green[g], state.jacobians[g]);
            let (gradients, weight) = (&self.integration.gradients[g], self.integration.weights[g]);
            let (of_pressure, of_pressure_moduli) = pressure_stress(pressure[g], c, j);
            let Some((_, factors)) = &mut tangent else {
                let rest = self.parts.rest.at(g).stress(c).map_err(|e| FailureKind::from(e).at(g))?;
                kernel::add_force(f, &(rest + of_pressure).to_components(), gradients, weight, force);
                continue;
            };
            let (rest, moduli) =
                self.parts.rest.at(g).stress_and_elasticity(c).map_err(|e| FailureKind::from(e).at(g))?;
            kernel::add_force(f, &(rest + of_pressure).to_components(), gradients, weight, force);
            let (of_pressure, of_pressure_moduli) = match before {
                None => (of_pressure, of_pressure_moduli),
                Some(_) => pressure_stress(continued[g], c, j),
            };
            let stress = (rest + of_pressure).to_components();
            let moduli = moduli + of_pressure_moduli;
            let (moduli, stress) = (&moduli.0, &stress);
            let point = TangentPoint { left: f, right: f, moduli, stress, geometric: 1.0, weight };
            kernel::tangent_factors(&[point], &self.integration.gradients, g, true, factors);
            self.add_change_of_volume(g, f, c, j, &mut changes);
        }
        if let Some((tangent, factors)) = tangent {
            kernel::tangent_from_factors(&self.integration.gradients, factors, true, factor, tangent);
            self.add_pressure_changes(&changes, &changes, &slope, factor, tangent);
        }
        Ok(())
    }

    /// The energy-momentum stress: `S = S_W + 2 p K` with the discrete gradients of `W`, `U` and `J`.
    fn energy_momentum(
        &self,
        step: ElementStep<'_, N, G>,
        history: &ElementHistory<G>,
        jacobians: &[f64; G],
        before: Option<&NodalVectors<N>>,
        factor: f64,
        force: &mut NodalVectors<N>,
        mut tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    ) -> Result<(), Failure> {
        let state = self.state(step.q_np1, TimeLevel::End)?;
        let start = self.average(jacobians);
        let (pressure, slope) =
            Self::at_points(|g| self.parts.volume.divided_difference(start[g], state.dilatations[g]));
        let pressure = self.average(&pressure);
        let continued = match before {
            Some(before) if tangent.is_some() => self
                .continued(&state, before, |g, dilatations| {
                    self.parts.volume.divided_difference(start[g], dilatations[g])
                })
                .unwrap_or(pressure),
            _ => pressure,
        };
        let q_mid = element::between(step.q_n, step.q_np1, 0.5);
        let (mut works, mut changes) = ([[[0.0; N]; 3]; A], [[[0.0; N]; 3]; A]);
        for g in 0..G {
            let (f, c, j) = (&state.deformation_gradients[g], &state.right_cauchy_green[g], state.jacobians[g]);
            let (gradients, weight) = (&self.integration.gradients[g], self.integration.weights[g]);
            let (c_n, energy) = (&history.right_cauchy_green(g), history.energy(g));
            let f_mid = self.geometry.reference.deformation_gradient(self.geometry.natural, &q_mid, g);
            let k = discrete_jacobian_gradient(c_n, jacobians[g], c, j);
            let of_pressure = k * (2.0 * pressure[g]);
            let Some((_, factors)) = &mut tangent else {
                let rest = stoss_continuum::energy_momentum_stress(&*self.parts.rest.at(g), c_n, energy, c)
                    .map_err(|e| FailureKind::from(e).at(g))?;
                kernel::add_force(&f_mid, &(rest + of_pressure).to_components(), gradients, weight, force);
                continue;
            };
            let (rest, mut moduli) =
                stoss_continuum::energy_momentum_stress_and_tangent(&*self.parts.rest.at(g), c_n, energy, c)
                    .map_err(|e| FailureKind::from(e).at(g))?;
            kernel::add_force(&f_mid, &(rest + of_pressure).to_components(), gradients, weight, force);
            let stress = (rest + k * (2.0 * continued[g])).to_components();
            moduli.add_scaled(2.0 * continued[g], &discrete_jacobian_gradient_tangent(c_n, jacobians[g], c, j, &k));
            let (moduli, stress) = (&moduli.0, &stress);
            let point = TangentPoint { left: &f_mid, right: f, moduli, stress, geometric: 0.5, weight };
            kernel::tangent_factors(&[point], &self.integration.gradients, g, false, factors);
            for (psi, work) in self.basis.iter().zip(&mut works) {
                kernel::add_force(&f_mid, &k.to_components(), gradients, 2.0 * weight * psi[g], work);
            }
            self.add_change_of_volume(g, f, c, j, &mut changes);
        }
        if let Some((tangent, factors)) = tangent {
            kernel::tangent_from_factors(&self.integration.gradients, factors, false, factor, tangent);
            self.add_pressure_changes(&works, &changes, &slope, factor, tangent);
        }
        Ok(())
    }

    /// The pressures at the Gauss points that a linear step from the iterate `before` led to: `p + p' dtheta`, all three at `before`, with the linear change
    /// `cof F : dF` of the volume. With these in place of the pressures the tangent is that of Newton's method for displacements *and* pressures, from which the
    /// latter were eliminated; the force is the same. `pressure` is a pressure and its derivative at a point for given dilatations. `None` if `before` has no state.
    fn continued(
        &self,
        state: &State<G>,
        before: &NodalVectors<N>,
        pressure: impl Fn(usize, &[f64; G]) -> (f64, f64),
    ) -> Option<[f64; G]> {
        let from = self.state(before, TimeLevel::End).ok()?;
        let mut linear = [0.0; G];
        for (g, linear) in linear.iter_mut().enumerate() {
            let (f0, f1) = (&from.deformation_gradients[g], &state.deformation_gradients[g]);
            let difference: Matrix3 = std::array::from_fn(|i| std::array::from_fn(|j| f1[i][j] - f0[i][j]));
            *linear = kernel::determinant_change(f0, &difference);
        }
        let change = self.average(&linear);
        let (value, slope) = Self::at_points(|g| pressure(g, &from.dilatations));
        // Of a constant the values at the points are the same; of a linear function each point has its own.
        Some(self.average(&std::array::from_fn(|g| value[g] + slope[g] * change[g])))
    }

    /// Adds a point's part of the derivatives of `sum_h w_h psi_a J_h` by the nodes: `cof F grad N = F (J C^-1) grad N`.
    #[inline]
    fn add_change_of_volume(
        &self,
        g: usize,
        f: &Matrix3,
        c: &SymmetricTensor2,
        j: f64,
        changes: &mut [NodalVectors<N>; A],
    ) {
        let inverse = (c.inverse_with_det(j)).to_components();
        for (psi, change) in self.basis.iter().zip(changes) {
            let weight = self.integration.weights[g] * psi[g];
            kernel::add_force(f, &inverse, &self.integration.gradients[g], weight, change);
        }
    }

    /// Adds `factor sum_ab D_ab works_a (x) changes_b` to the tangent, `D_ab = sum_h w_h p'_h psi_a psi_b`: what the change of the pressures does.
    fn add_pressure_changes(
        &self,
        works: &[NodalVectors<N>; A],
        changes: &[NodalVectors<N>; A],
        slope: &[f64; G],
        factor: f64,
        tangent: &mut LocalTangent<N>,
    ) {
        for a in 0..A {
            let mut right: NodalVectors<N> = [[0.0; N]; 3];
            for b in 0..A {
                let d: f64 = (0..G)
                    .map(|g| self.integration.weights[g] * slope[g] * self.basis[a][g] * self.basis[b][g])
                    .sum::<f64>()
                    * factor;
                for i in 0..3 {
                    for node in 0..N {
                        right[i][node] += d * changes[b][i][node];
                    }
                }
            }
            for node in 0..N {
                for i in 0..3 {
                    let work = works[a][i][node];
                    let row = &mut tangent[node][i];
                    for other in 0..N {
                        for j in 0..3 {
                            row[other][j] += work * right[j][other];
                        }
                    }
                }
            }
        }
    }
}
