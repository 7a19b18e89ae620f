//! The stress rules at the Gauss points of one element. Not the arithmetic ([`crate::kernel`]), not the loop over elements.

use crate::{
    ForceRule, TimeLevel,
    kernel::{self, ElementIntegration, Gradients, LocalTangent, Matrix3, NodalVectors, TangentFactors, TangentPoint},
    laws::{Laws, PointError},
};
use stoss_continuum::{ConstitutiveError, SymmetricTensor2, Tensor4};
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

impl From<PointError> for Failure {
    fn from((gauss_point, error): PointError) -> Self {
        FailureKind::from(error).at(gauss_point)
    }
}

impl From<ConstitutiveError> for FailureKind {
    fn from(error: ConstitutiveError) -> Self {
        Self::Constitutive(error)
    }
}

/// `det F > 0` or the reason. Checked on `F` itself: `det C` is positive for an inverted element too.
#[inline(always)]
fn check_orientation(f: &Matrix3, level: TimeLevel) -> Result<(), FailureKind> {
    let determinant = kernel::determinant(f);
    if determinant > 0.0 { Ok(()) } else { Err(FailureKind::Inverted { determinant, level }) }
}

/// `F` (checked) and `C` of an element's configuration at a Gauss point.
#[inline(always)]
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

/// Gauss points whose laws are evaluated together.
const TOGETHER: usize = 4;

/// What is done with some Gauss points at once: `L` of them from `first` on.
trait Points {
    fn of<const L: usize>(&mut self, first: usize) -> Result<(), Failure>;
}

/// All of `count` Gauss points in their order, as many together as there are.
#[inline(always)]
fn in_order(count: usize, points: &mut impl Points) -> Result<(), Failure> {
    let whole = count - count % TOGETHER;
    for first in (0..whole).step_by(TOGETHER) {
        points.of::<TOGETHER>(first)?;
    }
    (whole..count).try_for_each(|g| points.of::<1>(g))
}

/// `F` (checked) and `C` at some Gauss points.
#[inline(always)]
fn strains<const N: usize, const G: usize, const L: usize>(
    q: &NodalVectors<N>,
    integration: &ElementIntegration<N, G>,
    first: usize,
    level: TimeLevel,
) -> Result<([Matrix3; L], [SymmetricTensor2; L]), Failure> {
    let (mut f, mut c) = ([[[0.0; 3]; 3]; L], [SymmetricTensor2::ZERO; L]);
    for l in 0..L {
        (f[l], c[l]) = strain(q, integration, first + l, level)?;
    }
    Ok((f, c))
}

/// `C_n` and `W_n` at every Gauss point.
pub(crate) fn history<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    q: &NodalVectors<N>,
) -> Result<[GaussPointHistory; G], Failure> {
    struct Start<'a, const N: usize, const G: usize> {
        laws: Laws<'a>,
        integration: &'a ElementIntegration<N, G>,
        q: &'a NodalVectors<N>,
        out: [GaussPointHistory; G],
    }
    impl<const N: usize, const G: usize> Points for Start<'_, N, G> {
        #[inline(always)]
        fn of<const L: usize>(&mut self, first: usize) -> Result<(), Failure> {
            let (_, c) = strains::<N, G, L>(self.q, self.integration, first, TimeLevel::Start)?;
            let mut energies = [0.0; L];
            self.laws.energies(first, &c, &mut energies)?;
            for l in 0..L {
                self.out[first + l] = GaussPointHistory { right_cauchy_green: c[l], energy: energies[l] };
            }
            Ok(())
        }
    }
    let nothing = GaussPointHistory { right_cauchy_green: SymmetricTensor2::IDENTITY, energy: 0.0 };
    let mut start = Start { laws, integration, q, out: [nothing; G] };
    in_order(G, &mut start)?;
    Ok(start.out)
}

/// `int W dV`.
pub(crate) fn energy<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    q: &NodalVectors<N>,
) -> Result<f64, Failure> {
    struct Stored<'a, const N: usize, const G: usize> {
        laws: Laws<'a>,
        integration: &'a ElementIntegration<N, G>,
        q: &'a NodalVectors<N>,
        total: f64,
    }
    impl<const N: usize, const G: usize> Points for Stored<'_, N, G> {
        #[inline(always)]
        fn of<const L: usize>(&mut self, first: usize) -> Result<(), Failure> {
            let (_, c) = strains::<N, G, L>(self.q, self.integration, first, TimeLevel::End)?;
            let mut energies = [0.0; L];
            self.laws.energies(first, &c, &mut energies)?;
            for (l, energy) in energies.into_iter().enumerate() {
                self.total += self.integration.weights[first + l] * energy;
            }
            Ok(())
        }
    }
    let mut stored = Stored { laws, integration, q, total: 0.0 };
    in_order(G, &mut stored)?;
    Ok(stored.total)
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
/// under a rule that does not read `q_np1`). With the widest vectors of the processor, and the same bits with any: nothing is contracted, no sum is reordered.
pub(crate) fn force_and_tangent<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    step: ElementStep<'_, N, G>,
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
) -> Result<(), Failure> {
    pulp::Arch::new().dispatch(ForceAndTangent { laws, integration, step, factor, force, tangent })
}

/// The arguments of [`force_and_tangent`].
struct ForceAndTangent<'a, const N: usize, const G: usize> {
    laws: Laws<'a>,
    integration: &'a ElementIntegration<N, G>,
    step: ElementStep<'a, N, G>,
    factor: f64,
    force: &'a mut NodalVectors<N>,
    tangent: Option<(&'a mut LocalTangent<N>, &'a mut TangentFactors<N, G>)>,
}

impl<const N: usize, const G: usize> pulp::WithSimd for ForceAndTangent<'_, N, G> {
    type Output = Result<(), Failure>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let Self { laws, integration, step, factor, force, tangent } = self;
        by_rule(laws, integration, step, factor, force, tangent)
    }
}

#[inline(always)]
fn by_rule<const N: usize, const G: usize>(
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
#[inline(always)]
pub(crate) fn between<const N: usize>(a: &NodalVectors<N>, b: &NodalVectors<N>, theta: f64) -> NodalVectors<N> {
    let rest = 1.0 - theta;
    std::array::from_fn(|i| std::array::from_fn(|node| rest * a[i][node] + theta * b[i][node]))
}

/// Force and tangent of a stress that depends on the same configuration as `B` does (theory/kinematics#tangent).
#[inline(always)]
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
        return in_order(G, &mut OneConfiguration { laws, integration, q, level, force, factors: None });
    };
    in_order(G, &mut OneConfiguration { laws, integration, q, level, force, factors: Some(&mut *factors) })?;
    kernel::form_tangent(&integration.gradients, factors, true, factor, tangent);
    Ok(())
}

struct OneConfiguration<'a, 'b, const N: usize, const G: usize> {
    laws: Laws<'a>,
    integration: &'a ElementIntegration<N, G>,
    q: &'a NodalVectors<N>,
    level: TimeLevel,
    force: &'b mut NodalVectors<N>,
    factors: Option<&'b mut TangentFactors<N, G>>,
}

impl<const N: usize, const G: usize> Points for OneConfiguration<'_, '_, N, G> {
    #[inline(always)]
    fn of<const L: usize>(&mut self, first: usize) -> Result<(), Failure> {
        let Self { laws, integration, q, level, force, factors } = self;
        let (f, c) = strains::<N, G, L>(q, integration, first, *level)?;
        let Some(factors) = factors else {
            let mut stresses = [SymmetricTensor2::ZERO; L];
            laws.stresses(first, &c, &mut stresses)?;
            add_forces(&f, |l| stresses[l].0, integration, first, force);
            return Ok(());
        };
        let mut of_law = [NO_MODULI; L];
        laws.stresses_and_elasticities(first, &c, &mut of_law)?;
        add_forces(&f, |l| of_law[l].0.0, integration, first, force);
        let points = tangent_points((&f, &f), &of_law, 1.0, integration, first);
        kernel::write_factors(&points, &integration.gradients, first, true, factors);
        Ok(())
    }
}

/// Results of laws before they are asked.
const NO_MODULI: (SymmetricTensor2, Tensor4) = (SymmetricTensor2::ZERO, Tensor4::ZERO);

/// Adds the forces of the stresses at the Gauss points from `first` on, which act on `f`.
#[inline(always)]
fn add_forces<const N: usize, const G: usize, const L: usize>(
    f: &[Matrix3; L],
    stress: impl Fn(usize) -> [f64; 6],
    integration: &ElementIntegration<N, G>,
    first: usize,
    force: &mut NodalVectors<N>,
) {
    for l in 0..L {
        let (gradients, weight) = (&integration.gradients[first + l], integration.weights[first + l]);
        kernel::add_force(&f[l], &stress(l), gradients, weight, force);
    }
}

#[inline(always)]
fn tangent_points<'a, const N: usize, const G: usize, const L: usize>(
    (left, right): (&'a [Matrix3; L], &'a [Matrix3; L]),
    of_law: &'a [(SymmetricTensor2, Tensor4); L],
    geometric: f64,
    integration: &ElementIntegration<N, G>,
    first: usize,
) -> [TangentPoint<'a>; L] {
    std::array::from_fn(|l| {
        let (SymmetricTensor2(stress), Tensor4(moduli)) = &of_law[l];
        let weight = integration.weights[first + l];
        TangentPoint { left: &left[l], right: &right[l], moduli, stress, geometric, weight }
    })
}

/// Force and tangent with the energy-momentum stress (theory/integrators#eq-ems, theory/integrators#eq-ems-tangent).
#[inline(always)]
fn energy_momentum<const N: usize, const G: usize>(
    laws: Laws<'_>,
    integration: &ElementIntegration<N, G>,
    step: ElementStep<'_, N, G>,
    history: &[GaussPointHistory; G],
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
) -> Result<(), Failure> {
    let (q_mid, q_np1) = (&between(step.q_n, step.q_np1, 0.5), step.q_np1);
    let Some((tangent, factors)) = tangent else {
        return in_order(G, &mut EnergyMomentum { laws, integration, history, q_mid, q_np1, force, factors: None });
    };
    let written = Some(&mut *factors);
    in_order(G, &mut EnergyMomentum { laws, integration, history, q_mid, q_np1, force, factors: written })?;
    kernel::form_tangent(&integration.gradients, factors, false, factor, tangent);
    Ok(())
}

struct EnergyMomentum<'a, 'b, const N: usize, const G: usize> {
    laws: Laws<'a>,
    integration: &'a ElementIntegration<N, G>,
    history: &'a [GaussPointHistory; G],
    q_mid: &'a NodalVectors<N>,
    q_np1: &'a NodalVectors<N>,
    force: &'b mut NodalVectors<N>,
    factors: Option<&'b mut TangentFactors<N, G>>,
}

impl<const N: usize, const G: usize> Points for EnergyMomentum<'_, '_, N, G> {
    #[inline(always)]
    fn of<const L: usize>(&mut self, first: usize) -> Result<(), Failure> {
        let Self { laws, integration, history, q_mid, q_np1, force, factors } = self;
        let (f_np1, c_np1) = strains::<N, G, L>(q_np1, integration, first, TimeLevel::End)?;
        let mut f_mid = [[[0.0; 3]; 3]; L];
        for l in 0..L {
            f_mid[l] = kernel::deformation_gradient(q_mid, &integration.gradients[first + l]);
        }
        let (mut c_n, mut energy_n) = ([SymmetricTensor2::ZERO; L], [0.0; L]);
        for l in 0..L {
            (c_n[l], energy_n[l]) = (history[first + l].right_cauchy_green, history[first + l].energy);
        }
        let Some(factors) = factors else {
            let mut stresses = [SymmetricTensor2::ZERO; L];
            laws.energy_momentum_stresses(first, (&c_n, &energy_n), &c_np1, &mut stresses)?;
            add_forces(&f_mid, |l| stresses[l].0, integration, first, force);
            return Ok(());
        };
        let mut of_law = [NO_MODULI; L];
        laws.energy_momentum_stresses_and_tangents(first, (&c_n, &energy_n), &c_np1, &mut of_law)?;
        add_forces(&f_mid, |l| of_law[l].0.0, integration, first, force);
        let points = tangent_points((&f_mid, &f_np1), &of_law, 0.5, integration, first);
        kernel::write_factors(&points, &integration.gradients, first, false, factors);
        Ok(())
    }
}
