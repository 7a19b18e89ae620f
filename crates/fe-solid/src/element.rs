//! The stress rules at the Gauss points of one element. Not the arithmetic ([`crate::kernel`]), not the loop over elements.

use crate::{
    ForceRule, TimeLevel,
    kernel::{self, ElementIntegration, Gradients, LocalTangent, Matrix3, NodalVectors, TangentFactors},
    laws::Laws,
};
use stoss_continuum::{ConstitutiveError, SymmetricTensor2};
use stoss_reference_element::CellKind;

/// An element's values from a vector of the model (length checked before).
#[inline]
pub(crate) fn gather<const N: usize>(nodes: &[u32; N], x: &[f64]) -> NodalVectors<N> {
    let mut local = [[0.0; N]; 3];
    for (node, &global) in nodes.iter().enumerate() {
        let at = 3 * global as usize;
        let value = &x[at..at + 3];
        for i in 0..3 {
            local[i][node] = value[i];
        }
    }
    local
}

/// Gradients of the shape functions in natural coordinates.
pub(crate) fn natural_gradients<const N: usize>(kind: CellKind, xi: [f64; 3]) -> Gradients<N> {
    let gradient = (kind.table().shape_gradient)(xi);
    std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]))
}

/// What the energy-momentum stress keeps of `q_n` at a Gauss point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaussPointHistory {
    pub right_cauchy_green: SymmetricTensor2,
    pub energy: f64,
}

/// Why an element has no value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Failure {
    pub gauss_point: usize,
    pub kind: FailureKind,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum FailureKind {
    Inverted { determinant: f64, level: TimeLevel },
    Constitutive(ConstitutiveError),
    Collapsed { dilatation: f64, level: TimeLevel },
}

impl FailureKind {
    pub(crate) fn at(self, gauss_point: usize) -> Failure {
        Failure { gauss_point, kind: self }
    }
}

impl From<ConstitutiveError> for FailureKind {
    fn from(error: ConstitutiveError) -> Self {
        Self::Constitutive(error)
    }
}

/// `det F > 0` or the reason. Checked on `F` itself: `det C` is positive for an inverted element too.
#[inline]
fn check_orientation(f: &Matrix3, level: TimeLevel) -> Result<(), FailureKind> {
    let determinant = kernel::determinant(f);
    if determinant > 0.0 { Ok(()) } else { Err(FailureKind::Inverted { determinant, level }) }
}

/// `F` (checked) and `C` of an element's configuration at a Gauss point.
#[inline]
pub(crate) fn strain<const N: usize, const G: usize>(
    q: &NodalVectors<N>,
    integration: &ElementIntegration<N, G>,
    gauss_point: usize,
    level: TimeLevel,
) -> Result<(Matrix3, SymmetricTensor2), Failure> {
    let f = kernel::deformation_gradient(q, &integration.gradients[gauss_point]);
    check_orientation(&f, level).map_err(|kind| kind.at(gauss_point))?;
    Ok((f, SymmetricTensor2::from_components(kernel::right_cauchy_green(&f))))
}

/// `C_n` and `W_n` at every Gauss point.
pub(crate) fn history<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    q: &NodalVectors<N>,
) -> Result<[GaussPointHistory; G], Failure> {
    let mut out = [GaussPointHistory { right_cauchy_green: SymmetricTensor2::IDENTITY, energy: 0.0 }; G];
    for (g, slot) in out.iter_mut().enumerate() {
        let (_, c) = strain(q, integration, g, TimeLevel::Start)?;
        let energy = laws.at(g).energy(&c).map_err(|e| FailureKind::from(e).at(g))?;
        *slot = GaussPointHistory { right_cauchy_green: c, energy };
    }
    Ok(out)
}

/// `int W dV`.
pub(crate) fn energy<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    q: &NodalVectors<N>,
) -> Result<f64, Failure> {
    let mut total = 0.0;
    for g in 0..G {
        let (_, c) = strain(q, integration, g, TimeLevel::End)?;
        total += integration.weights[g] * laws.at(g).energy(&c).map_err(|e| FailureKind::from(e).at(g))?;
    }
    Ok(total)
}

/// The configurations of one element in a step.
#[derive(Clone, Copy)]
pub(crate) struct ElementStep<'a, const N: usize, const G: usize> {
    pub rule: ForceRule,
    /// Anything if the rule does not read it; likewise `q_np1`.
    pub q_n: &'a NodalVectors<N>,
    pub q_np1: &'a NodalVectors<N>,
    /// Present for the energy-momentum rule.
    pub history: Option<&'a [GaussPointHistory; G]>,
}

/// Internal force (overwritten) and, if wanted, `factor` times its derivative by `q_np1` (overwritten; not asked for
/// under a rule that does not read `q_np1`).
pub(crate) fn force_and_tangent<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    step: ElementStep<'_, N, G>,
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
) -> Result<(), Failure> {
    *force = [[0.0; N]; 3];
    match (step.rule, step.history) {
        (ForceRule::DiscreteGradient, Some(history)) => {
            energy_momentum(laws, integration, step, history, factor, force, tangent)
        }
        // The body hands over the history whenever the rule is energy-momentum.
        (ForceRule::DiscreteGradient, None) => unreachable!("energy-momentum rule without history"),
        (ForceRule::Configuration { theta }, _) => {
            if !step.rule.reads_start() {
                return one_configuration(laws, integration, step.q_np1, TimeLevel::End, factor, force, tangent);
            }
            if !step.rule.reads_end() {
                return one_configuration(laws, integration, step.q_n, TimeLevel::Start, 0.0, force, None);
            }
            for g in 0..G {
                let f = kernel::deformation_gradient(step.q_np1, &integration.gradients[g]);
                check_orientation(&f, TimeLevel::End).map_err(|kind| kind.at(g))?;
            }
            let q = between(step.q_n, step.q_np1, theta);
            // d q_{n+theta} / d q_np1 = theta
            one_configuration(laws, integration, &q, TimeLevel::Intermediate, theta * factor, force, tangent)
        }
    }
}

/// `(1 - theta) a + theta b`.
#[inline]
pub(crate) fn between<const N: usize>(a: &NodalVectors<N>, b: &NodalVectors<N>, theta: f64) -> NodalVectors<N> {
    let rest = 1.0 - theta;
    std::array::from_fn(|i| std::array::from_fn(|node| rest * a[i][node] + theta * b[i][node]))
}

/// Force and tangent of a stress that depends on the same configuration as `B` does (theory/kinematics#tangent).
fn one_configuration<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    q: &NodalVectors<N>,
    level: TimeLevel,
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
) -> Result<(), Failure> {
    let Some((tangent, factors)) = tangent else {
        for g in 0..G {
            let (f, c) = strain(q, integration, g, level)?;
            let stress = laws.at(g).stress(&c).map_err(|e| FailureKind::from(e).at(g))?;
            kernel::add_force(&f, &stress.to_components(), &integration.gradients[g], integration.weights[g], force);
        }
        return Ok(());
    };
    for g in 0..G {
        let (f, c) = strain(q, integration, g, level)?;
        let (stress, moduli) = laws.at(g).stress_and_elasticity(&c).map_err(|e| FailureKind::from(e).at(g))?;
        let stress = stress.to_components();
        let (gradients, weight) = (&integration.gradients[g], integration.weights[g]);
        kernel::add_force(&f, &stress, gradients, weight, force);
        kernel::tangent_factors(&f, &f, &moduli.0, &stress, 1.0, gradients, weight, g, true, factors);
    }
    kernel::tangent_from_factors(&integration.gradients, factors, true, factor, tangent);
    Ok(())
}

/// Force and tangent with the energy-momentum stress (theory/integrators#eq-ems, theory/integrators#eq-ems-tangent).
fn energy_momentum<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    step: ElementStep<'_, N, G>,
    history: &[GaussPointHistory; G],
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
) -> Result<(), Failure> {
    let q_mid = between(step.q_n, step.q_np1, 0.5);
    let mut tangent = tangent;
    for g in 0..G {
        let (gradients, weight) = (&integration.gradients[g], integration.weights[g]);
        let (f_np1, c_np1) = strain(step.q_np1, integration, g, TimeLevel::End)?;
        let f_mid = kernel::deformation_gradient(&q_mid, gradients);
        let GaussPointHistory { right_cauchy_green: c_n, energy } = &history[g];
        match &mut tangent {
            None => {
                let stress = stoss_continuum::energy_momentum_stress(&*laws.at(g), c_n, *energy, &c_np1)
                    .map_err(|e| FailureKind::from(e).at(g))?;
                kernel::add_force(&f_mid, &stress.to_components(), gradients, weight, force);
            }
            Some((_, factors)) => {
                let (stress, moduli) =
                    stoss_continuum::energy_momentum_stress_and_tangent(&*laws.at(g), c_n, *energy, &c_np1)
                        .map_err(|e| FailureKind::from(e).at(g))?;
                let stress = stress.to_components();
                kernel::add_force(&f_mid, &stress, gradients, weight, force);
                kernel::tangent_factors(&f_mid, &f_np1, &moduli.0, &stress, 0.5, gradients, weight, g, false, factors);
            }
        }
    }
    if let Some((tangent, factors)) = tangent {
        kernel::tangent_from_factors(&integration.gradients, factors, false, factor, tangent);
    }
    Ok(())
}
