//! The stress of each scheme's rule at the Gauss points of one element. Not the arithmetic ([`crate::kernel`]), not the loop over elements.

use crate::{
    ForceRule, TimeLevel,
    kernel::{
        self, ElementIntegration, Gradients, LocalTangent, Matrix3, NodalVectors, PointBuffers, TangentFactors,
        TangentPoints, determinant, right_cauchy_green,
    },
    laws::{Laws, PointError},
    matrices::Matrices,
    reference::{ElementReference, Natural, several},
};
use stoss_continuum::wide::{self, LANES, Operation, Several, Simd, SymmetricTensors};
use stoss_continuum::{ConstitutiveError, StepStart, Strains, SymmetricTensor2, Wanted};
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

/// What the energy-momentum stress keeps of `q_n` at the Gauss points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElementHistory<const G: usize> {
    /// `C_n`, `[component][g]`.
    strains: [[f64; G]; 6],
    /// `W_n`.
    energies: [f64; G],
}

impl<const G: usize> ElementHistory<G> {
    /// A history of zeros, before a step has begun.
    pub const EMPTY: Self = Self { strains: [[0.0; G]; 6], energies: [0.0; G] };

    /// `C_n` at a Gauss point.
    pub fn right_cauchy_green(&self, gauss_point: usize) -> SymmetricTensor2 {
        SymmetricTensor2(self.strains.map(|of| of[gauss_point]))
    }

    /// `W_n` at a Gauss point.
    pub fn energy(&self, gauss_point: usize) -> f64 {
        self.energies[gauss_point]
    }

    /// `C_n` and `W_n` at the Gauss points from `first` on.
    #[inline(always)]
    fn several(&self, first: usize) -> (SymmetricTensors, Several) {
        let mut strains = SymmetricTensors::ZERO;
        for (out, of) in strains.0.iter_mut().zip(&self.strains) {
            *out = several(of, first);
        }
        (strains, several(&self.energies, first))
    }
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

/// Reference geometry of an element: its own, and what it shares.
#[derive(Clone, Copy)]
pub(crate) struct Geometry<'a, const N: usize, const G: usize> {
    pub reference: &'a ElementReference<G>,
    pub natural: &'a Natural<N, G>,
}

/// Whether a Jacobian is no positive number.
fn is_inverted(determinant: f64) -> bool {
    determinant <= 0.0 || determinant.is_nan()
}

/// What is done with some Gauss points side by side: `count` of them from `first` on.
trait Points {
    fn of<S: Simd>(&mut self, simd: S, first: usize, count: usize) -> Result<(), Failure>;
}

/// All of `count` Gauss points in their order.
#[inline(always)]
fn in_order<S: Simd>(simd: S, count: usize, points: &mut impl Points) -> Result<(), Failure> {
    // No closure, see `wide::Operation`.
    let mut first = 0;
    while first < count {
        points.of(simd, first, (count - first).min(LANES))?;
        first += LANES;
    }
    Ok(())
}

/// The loop of [`in_order`] with the processor's widest vectors.
struct InOrder<'a, P> {
    count: usize,
    points: &'a mut P,
}

impl<P: Points> Operation for InOrder<'_, P> {
    type Output = Result<(), Failure>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        in_order(simd, self.count, self.points)
    }
}

impl<const N: usize, const G: usize> Geometry<'_, N, G> {
    /// `F` (checked) and `C` at a Gauss point. `det F` itself is checked: `det C` is positive for an inverted element too.
    pub fn strain(
        &self,
        q: &NodalVectors<N>,
        gauss_point: usize,
        level: TimeLevel,
    ) -> Result<(Matrix3, SymmetricTensor2), Failure> {
        let f = self.reference.deformation_gradient(self.natural, q, gauss_point);
        let determinant = determinant(&f);
        if is_inverted(determinant) {
            return Err(FailureKind::Inverted { determinant, level }.at(gauss_point));
        }
        Ok((f, SymmetricTensor2(right_cauchy_green(&f))))
    }

    /// `F` (checked) and `C` at every Gauss point.
    pub fn all_strains(
        &self,
        q: &NodalVectors<N>,
        level: TimeLevel,
    ) -> Result<([Matrix3; G], [SymmetricTensor2; G]), Failure> {
        struct All<'a, const N: usize, const G: usize> {
            geometry: Geometry<'a, N, G>,
            q: &'a NodalVectors<N>,
            level: TimeLevel,
            out: ([Matrix3; G], [SymmetricTensor2; G]),
        }
        impl<const N: usize, const G: usize> Points for All<'_, N, G> {
            #[inline(always)]
            fn of<S: Simd>(&mut self, simd: S, first: usize, count: usize) -> Result<(), Failure> {
                let (f, c) = self.geometry.strains(simd, self.q, (first, count), self.level)?;
                for l in 0..count {
                    (self.out.0[first + l], self.out.1[first + l]) = (f.get(l), c.get(l));
                }
                Ok(())
            }
        }
        let out = ([[[0.0; 3]; 3]; G], [SymmetricTensor2::ZERO; G]);
        let mut all = All { geometry: *self, q, level, out };
        wide::dispatch(InOrder { count: G, points: &mut all })?;
        Ok(all.out)
    }

    #[inline(always)]
    fn deformation_gradients<S: Simd>(&self, simd: S, q: &NodalVectors<N>, first: usize) -> Matrices {
        let mut f = Matrices::ZERO;
        self.reference.deformation_gradients(simd, self.natural, q, first, &mut f);
        f
    }

    /// `F` (checked) and `C` at some Gauss points.
    #[inline(always)]
    fn strains<S: Simd>(
        &self,
        simd: S,
        q: &NodalVectors<N>,
        (first, count): (usize, usize),
        level: TimeLevel,
    ) -> Result<(Matrices, SymmetricTensors), Failure> {
        let f = self.deformation_gradients(simd, q, first);
        let (mut c, mut determinants) = (SymmetricTensors::ZERO, [0.0; LANES]);
        for part in 0..wide::parts::<S>() {
            let f = f.load(simd, part);
            determinant(&f).store(&mut determinants, part);
            c.store(&right_cauchy_green(&f), part);
        }
        match determinants[..count].iter().position(|&determinant| is_inverted(determinant)) {
            None => Ok((f, c)),
            Some(l) => Err(FailureKind::Inverted { determinant: determinants[l], level }.at(first + l)),
        }
    }
}

/// `C_n` and `W_n` at every Gauss point.
pub(crate) fn history<const N: usize, const G: usize>(
    laws: Laws<'_>,
    geometry: Geometry<'_, N, G>,
    q: &NodalVectors<N>,
) -> Result<ElementHistory<G>, Failure> {
    struct Start<'a, const N: usize, const G: usize> {
        laws: Laws<'a>,
        geometry: Geometry<'a, N, G>,
        q: &'a NodalVectors<N>,
        out: ElementHistory<G>,
    }
    impl<const N: usize, const G: usize> Points for Start<'_, N, G> {
        #[inline(always)]
        fn of<S: Simd>(&mut self, simd: S, first: usize, count: usize) -> Result<(), Failure> {
            let (_, c) = self.geometry.strains(simd, self.q, (first, count), TimeLevel::Start)?;
            let mut energies = [0.0; LANES];
            let wanted = Wanted { energies: Some(&mut energies), ..Wanted::default() };
            self.laws.evaluate(first, &Strains { all: &c, count }, wanted)?;
            for l in 0..count {
                self.out.energies[first + l] = energies[l];
                for (out, c) in self.out.strains.iter_mut().zip(&c.0) {
                    out[first + l] = c[l];
                }
            }
            Ok(())
        }
    }
    let mut start = Start { laws, geometry, q, out: ElementHistory::EMPTY };
    wide::dispatch(InOrder { count: G, points: &mut start })?;
    Ok(start.out)
}

/// `int W dV`.
pub(crate) fn energy<const N: usize, const G: usize>(
    laws: Laws<'_>,
    geometry: Geometry<'_, N, G>,
    q: &NodalVectors<N>,
) -> Result<f64, Failure> {
    struct Stored<'a, const N: usize, const G: usize> {
        laws: Laws<'a>,
        geometry: Geometry<'a, N, G>,
        q: &'a NodalVectors<N>,
        total: f64,
    }
    impl<const N: usize, const G: usize> Points for Stored<'_, N, G> {
        #[inline(always)]
        fn of<S: Simd>(&mut self, simd: S, first: usize, count: usize) -> Result<(), Failure> {
            let (_, c) = self.geometry.strains(simd, self.q, (first, count), TimeLevel::End)?;
            let mut energies = [0.0; LANES];
            let wanted = Wanted { energies: Some(&mut energies), ..Wanted::default() };
            self.laws.evaluate(first, &Strains { all: &c, count }, wanted)?;
            for (l, energy) in energies[..count].iter().enumerate() {
                self.total += self.geometry.reference.weights[first + l] * energy;
            }
            Ok(())
        }
    }
    let mut stored = Stored { laws, geometry, q, total: 0.0 };
    wide::dispatch(InOrder { count: G, points: &mut stored })?;
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
    pub history: Option<&'a ElementHistory<G>>,
}

/// Internal force (overwritten) and, if wanted, `factor` times its derivative by `q_np1` (overwritten; not asked for
/// under a rule that does not read `q_np1`). With the widest vectors of the processor, and the same bits with any: nothing is contracted, no sum is reordered.
pub(crate) fn force_and_tangent<const N: usize, const G: usize>(
    laws: Laws<'_>,
    geometry: Geometry<'_, N, G>,
    step: ElementStep<'_, N, G>,
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    buffers: &mut PointBuffers,
) -> Result<(), Failure> {
    wide::dispatch(ForceAndTangent { laws, geometry, step, factor, force, tangent, buffers })
}

/// The arguments of [`force_and_tangent`].
struct ForceAndTangent<'a, const N: usize, const G: usize> {
    laws: Laws<'a>,
    geometry: Geometry<'a, N, G>,
    step: ElementStep<'a, N, G>,
    factor: f64,
    force: &'a mut NodalVectors<N>,
    tangent: Option<(&'a mut LocalTangent<N>, &'a mut TangentFactors<N, G>)>,
    buffers: &'a mut PointBuffers,
}

impl<const N: usize, const G: usize> Operation for ForceAndTangent<'_, N, G> {
    type Output = Result<(), Failure>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self { laws, geometry, step, factor, force, tangent, buffers } = self;
        let ElementIntegration { gradients, .. } = &geometry.reference.integration(&geometry.natural.gradients);
        by_rule(simd, Element { laws, geometry, gradients }, step, factor, force, tangent, buffers)
    }
}

/// An element, and the gradients of its shape functions at the Gauss points.
#[derive(Clone, Copy)]
struct Element<'a, const N: usize, const G: usize> {
    laws: Laws<'a>,
    geometry: Geometry<'a, N, G>,
    gradients: &'a [Gradients<N>; G],
}

#[inline(always)]
fn by_rule<S: Simd, const N: usize, const G: usize>(
    simd: S,
    element: Element<'_, N, G>,
    step: ElementStep<'_, N, G>,
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    buffers: &mut PointBuffers,
) -> Result<(), Failure> {
    *force = [[0.0; N]; 3];
    match (step.rule, step.history) {
        (ForceRule::DiscreteGradient, Some(history)) => {
            energy_momentum(simd, element, step, history, factor, force, tangent, buffers)
        }
        // The body hands over the history whenever the rule is energy-momentum.
        (ForceRule::DiscreteGradient, None) => unreachable!("energy-momentum rule without history"),
        (ForceRule::Configuration { theta }, _) => {
            let (q, level, factor, tangent) = if !step.rule.reads_start() {
                (*step.q_np1, TimeLevel::End, factor, tangent)
            } else if !step.rule.reads_end() {
                (*step.q_n, TimeLevel::Start, 0.0, None)
            } else {
                in_order(simd, G, &mut Orientation { geometry: element.geometry, q: step.q_np1 })?;
                // d q_{n+theta} / d q_np1 = theta
                (between(step.q_n, step.q_np1, theta), TimeLevel::Intermediate, theta * factor, tangent)
            };
            one_configuration(simd, element, &q, level, factor, force, tangent, buffers)
        }
    }
}

/// The check that no point is inverted at the end of the step.
struct Orientation<'a, const N: usize, const G: usize> {
    geometry: Geometry<'a, N, G>,
    q: &'a NodalVectors<N>,
}

impl<const N: usize, const G: usize> Points for Orientation<'_, N, G> {
    #[inline(always)]
    fn of<S: Simd>(&mut self, simd: S, first: usize, count: usize) -> Result<(), Failure> {
        self.geometry.strains(simd, self.q, (first, count), TimeLevel::End).map(|_| ())
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
fn one_configuration<S: Simd, const N: usize, const G: usize>(
    simd: S,
    element: Element<'_, N, G>,
    q: &NodalVectors<N>,
    level: TimeLevel,
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    buffers: &mut PointBuffers,
) -> Result<(), Failure> {
    let Some((tangent, factors)) = tangent else {
        return in_order(simd, G, &mut OneConfiguration { element, q, level, force, factors: None, buffers });
    };
    in_order(simd, G, &mut OneConfiguration { element, q, level, force, factors: Some(&mut *factors), buffers })?;
    kernel::form_tangent(simd, element.gradients, factors, true, factor, tangent);
    Ok(())
}

struct OneConfiguration<'a, 'b, const N: usize, const G: usize> {
    element: Element<'a, N, G>,
    q: &'a NodalVectors<N>,
    level: TimeLevel,
    force: &'b mut NodalVectors<N>,
    factors: Option<&'b mut TangentFactors<N, G>>,
    buffers: &'b mut PointBuffers,
}

impl<const N: usize, const G: usize> Points for OneConfiguration<'_, '_, N, G> {
    #[inline(always)]
    fn of<S: Simd>(&mut self, simd: S, first: usize, count: usize) -> Result<(), Failure> {
        let Self { element: Element { laws, geometry, gradients }, q, level, force, factors, buffers } = self;
        let (f, c) = geometry.strains(simd, q, (first, count), *level)?;
        let strains = Strains { all: &c, count };
        let mut stress = SymmetricTensors::ZERO;
        let PointBuffers { moduli, two_point } = &mut **buffers;
        let wanted = factors.is_some().then_some(&mut *moduli);
        laws.evaluate(first, &strains, Wanted { energies: None, stresses: Some(&mut stress), moduli: wanted })?;
        let weights = several(&geometry.reference.weights, first);
        kernel::add_forces(simd, &f, &stress, &gradients[first..first + count], &weights, force);
        if let Some(factors) = factors {
            let (left, right, moduli, stress, weights) = (&f, &f, &*moduli, &stress, &weights);
            let points = TangentPoints { left, right, moduli, stress, weights, scales: weights };
            kernel::write_factors(simd, &points, count, gradients, first, true, two_point, factors);
        }
        Ok(())
    }
}

/// Force and tangent with the energy-momentum stress (theory/integrators#eq-ems, theory/integrators#eq-ems-tangent).
#[inline(always)]
fn energy_momentum<S: Simd, const N: usize, const G: usize>(
    simd: S,
    element: Element<'_, N, G>,
    step: ElementStep<'_, N, G>,
    history: &ElementHistory<G>,
    factor: f64,
    force: &mut NodalVectors<N>,
    tangent: Option<(&mut LocalTangent<N>, &mut TangentFactors<N, G>)>,
    buffers: &mut PointBuffers,
) -> Result<(), Failure> {
    let (q_mid, q_np1) = (&between(step.q_n, step.q_np1, 0.5), step.q_np1);
    let Some((tangent, factors)) = tangent else {
        return in_order(
            simd,
            G,
            &mut EnergyMomentum { element, history, q_mid, q_np1, force, factors: None, buffers },
        );
    };
    let written = Some(&mut *factors);
    in_order(simd, G, &mut EnergyMomentum { element, history, q_mid, q_np1, force, factors: written, buffers })?;
    kernel::form_tangent(simd, element.gradients, factors, false, factor, tangent);
    Ok(())
}

struct EnergyMomentum<'a, 'b, const N: usize, const G: usize> {
    element: Element<'a, N, G>,
    history: &'a ElementHistory<G>,
    q_mid: &'a NodalVectors<N>,
    q_np1: &'a NodalVectors<N>,
    force: &'b mut NodalVectors<N>,
    factors: Option<&'b mut TangentFactors<N, G>>,
    buffers: &'b mut PointBuffers,
}

impl<const N: usize, const G: usize> Points for EnergyMomentum<'_, '_, N, G> {
    #[inline(always)]
    fn of<S: Simd>(&mut self, simd: S, first: usize, count: usize) -> Result<(), Failure> {
        let Self { element: Element { laws, geometry, gradients }, history, q_mid, q_np1, force, factors, buffers } =
            self;
        let (f_np1, c_np1) = geometry.strains(simd, q_np1, (first, count), TimeLevel::End)?;
        let f_mid = geometry.deformation_gradients(simd, q_mid, first);
        let (strains, energies) = history.several(first);
        let start = StepStart { strains: &strains, energies: &energies };
        let mut stress = SymmetricTensors::ZERO;
        let PointBuffers { moduli, two_point } = &mut **buffers;
        let wanted = factors.is_some().then_some(&mut *moduli);
        laws.energy_momentum(simd, first, start, &Strains { all: &c_np1, count }, &mut stress, wanted)?;
        let weights = several(&geometry.reference.weights, first);
        kernel::add_forces(simd, &f_mid, &stress, &gradients[first..first + count], &weights, force);
        if let Some(factors) = factors {
            let scales = weights.map(|weight| 0.5 * weight);
            let (left, right, moduli, stress) = (&f_mid, &f_np1, &*moduli, &stress);
            let points = TangentPoints { left, right, moduli, stress, weights: &weights, scales: &scales };
            kernel::write_factors(simd, &points, count, gradients, first, false, two_point, factors);
        }
        Ok(())
    }
}
