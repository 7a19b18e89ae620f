//! Every law of the catalogue, and a user's own, through the battery; derivatives against dual numbers.

use num_dual::DualNum;
use stoss_continuum::wide::{LANES, SymmetricTensors, Tensors4};
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, SmallStrainModuli, Strains, SymmetricTensor2, Tensor4, Wanted,
};
use stoss_materials::{
    FirstInvariant, Hencky, LAWS, MaterialError, MooneyRivlin, NeoHooke, Ogden, SaintVenantKirchhoff,
};
use stoss_testkit::laws::{EnergyOracle, against_dual_numbers, battery, invariants};

const YOUNG: f64 = 2250.0;
const POISSON: f64 = 0.3;

fn lame() -> (f64, f64) {
    (YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)), YOUNG / (2.0 * (1.0 + POISSON)))
}

/// The ball of theory/examples#ball-plate.
fn ogden() -> Ogden {
    Ogden::new(&[6300.0, 12.0, -100.0], &[1.3, 5.0, -2.0], 2000.0, 9.0).unwrap()
}

/// Every law of the catalogue, with Young's modulus and Poisson's ratio of its parameters (theory/kinematics#moduli), in the digits there, where it has them. Those of Yeoh and
/// Gent have `mu = 1`; of Arruda and Boyce's `mu` is the series `1 + 3/(5 L^2) + 99/(175 L^4) + 513/(875 L^6) + 42039/(67375 L^8)` with `L = 4`.
fn catalogue() -> Vec<(Box<dyn HyperelasticLaw>, [f64; 2])> {
    let steel = [2250.0, 0.3];
    vec![
        (Box::new(SaintVenantKirchhoff::new(1298.0769, 865.3846).unwrap()), steel),
        (Box::new(NeoHooke::new(1298.0769, 865.3846).unwrap()), steel),
        (Box::new(Hencky::new(1298.0769, 865.3846).unwrap()), steel),
        (Box::new(MooneyRivlin::new(176_051.0, 4332.63, 2.0e6).unwrap()), [1.05257e6, 0.4588]),
        (Box::new(ogden()), [7437.65, -0.1198]),
        (Box::new(FirstInvariant::yeoh([0.5, -0.005, 0.0002], 2.0).unwrap()), [2.571429, 0.28571]),
        (Box::new(FirstInvariant::gent(1.0, 1000.0, 2.0).unwrap()), [2.571429, 0.28571]),
        (Box::new(FirstInvariant::arruda_boyce(1.0, 4.0, 2.0).unwrap()), [2.658791, 0.27843]),
    ]
}

struct SvkEnergy;
impl EnergyOracle for SvkEnergy {
    fn energy<D: DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
        let (lambda, mu) = lame();
        let e: [D; 6] = std::array::from_fn(|i| if i < 3 { (c[i] - 1.0) * 0.5 } else { c[i] * 0.5 });
        let trace = e[0] + e[1] + e[2];
        let square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]) * 2.0;
        trace * trace * (0.5 * lambda) + square * mu
    }
}

/// `lambda` and `mu`.
struct NeoHookeEnergy(f64, f64);
impl EnergyOracle for NeoHookeEnergy {
    fn energy<D: DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
        let &Self(lambda, mu) = self;
        let log_j = invariants::det(c).ln() * 0.5;
        (invariants::trace(c) - 3.0) * (0.5 * mu) + log_j * log_j * (0.5 * lambda) - log_j * mu
    }
}

/// `lambda` and `mu`: `mu E:E + lambda/2 (tr E)^2` with `E = ln(C)/2`.
struct HenckyEnergy(f64, f64);
impl EnergyOracle for HenckyEnergy {
    fn energy<D: DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
        let &Self(lambda, mu) = self;
        let log_j = invariants::det(c).ln() * 0.5;
        invariants::trace_of_squared_logarithm(c) * (0.25 * mu) + log_j * log_j * (0.5 * lambda)
    }
}

struct MooneyRivlinEnergy;
impl EnergyOracle for MooneyRivlinEnergy {
    fn energy<D: DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
        let (c1, c2, c3) = (176_051.0, 4332.63, 2.0e6);
        let j = invariants::det(c).sqrt();
        (invariants::trace(c) - 3.0) * c1 + (invariants::second(c) - 3.0) * c2 + (j - 1.0) * (j - 1.0) * c3
            - j.ln() * (2.0 * (c1 + 2.0 * c2))
    }
}

/// `mu`, `alpha`, `kappa`, `beta`.
struct OgdenEnergy<'a>(&'a [f64], &'a [f64], f64, f64);
impl EnergyOracle for OgdenEnergy<'_> {
    fn energy<D: DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
        let &Self(mu, alpha, kappa, beta) = self;
        let log_j = invariants::det(c).ln() * 0.5;
        let mut w = (log_j / beta + ((log_j * -beta).exp() - 1.0) / (beta * beta)) * kappa;
        // sum_A lambda_A^alpha = tr C^(alpha/2)
        let halves: Vec<f64> = alpha.iter().map(|alpha| 0.5 * alpha).collect();
        let traces = invariants::traces_of_powers(c, &halves);
        for ((mu, alpha), trace) in mu.iter().zip(alpha).zip(traces) {
            w += ((log_j * (-alpha / 3.0)).exp() * trace - 3.0) * (mu / alpha);
        }
        w
    }
}

#[test]
fn saint_venant_kirchhoff() {
    let law = SaintVenantKirchhoff::from_young_poisson(YOUNG, POISSON).unwrap();
    battery(&law, 1e-13);
    against_dual_numbers(&law, &SvkEnergy, 1e-12);
    // Energy of a body crushed to nothing is finite (theory/kinematics#compression).
    let (lambda, mu) = lame();
    let nearly_nothing = SymmetricTensor2::IDENTITY * 1e-9;
    let expected = 9.0 / 8.0 * lambda + 0.75 * mu;
    assert!((law.energy(&nearly_nothing).unwrap() / expected - 1.0).abs() < 1e-8);
}

#[test]
fn neo_hooke() {
    let law = NeoHooke::from_young_poisson(YOUNG, POISSON).unwrap();
    battery(&law, 1e-13);
    let (lambda, mu) = lame();
    against_dual_numbers(&law, &NeoHookeEnergy(lambda, mu), 1e-12);
}

#[test]
fn neo_hooke_nearly_incompressible_and_auxetic() {
    for poisson in [0.499_99, -0.9, 0.0] {
        let law = NeoHooke::from_young_poisson(YOUNG, poisson).unwrap();
        battery(&law, 1e-12);
        let lambda = YOUNG * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        against_dual_numbers(&law, &NeoHookeEnergy(lambda, YOUNG / (2.0 * (1.0 + poisson))), 1e-11);
    }
}

#[test]
fn hencky() {
    let law = Hencky::from_young_poisson(YOUNG, POISSON).unwrap();
    battery(&law, 1e-12);
    let (lambda, mu) = lame();
    against_dual_numbers(&law, &HenckyEnergy(lambda, mu), 1e-10);
}

#[test]
fn every_law_that_has_a_name_is_in_the_battery() {
    let tested: Vec<String> = catalogue().iter().map(|(law, _)| law.name().to_owned()).collect();
    for entry in LAWS {
        assert!(tested.iter().any(|name| name == entry.name), "{} is missing in `catalogue` here", entry.name);
        battery(&*entry.of_examples().unwrap(), 1e-11);
    }
}

#[test]
fn energies_grow_in_compression() {
    // Down to J = 0.2, where even the law of Saint Venant and Kirchhoff, which softens, has not turned yet.
    for (law, _) in catalogue() {
        let mut last = -1.0;
        for k in 0..=80 {
            let j = 1.0 - 0.01 * f64::from(k);
            let energy = law.energy(&(SymmetricTensor2::IDENTITY * j.powf(2.0 / 3.0))).unwrap();
            assert!(energy > last, "{}: {energy} at J = {j}", law.name());
            last = energy;
        }
    }
}

#[test]
fn energies_are_those_of_linear_elasticity_near_the_reference_state() {
    // W -> lambda/2 (tr E)^2 + mu E:E with a relative error of the order |E|, down to the smallest strains: an energy that is
    // summed from terms of order one has no correct digit at |E| = 1e-8.
    for (law, _) in catalogue() {
        let moduli = law.small_strain_moduli();
        for size in [1e-3, 1e-5, 1e-7] {
            let c = SymmetricTensor2::IDENTITY + SymmetricTensor2([0.7, -0.4, 0.5, 0.3, -0.8, 0.6]) * size;
            // The strain that the rounded C has.
            let e = (c - SymmetricTensor2::IDENTITY) * 0.5;
            let expected = 0.5 * moduli.lame_lambda() * e.trace().powi(2) + moduli.shear * e.double_contract(&e);
            let error = (law.energy(&c).unwrap() / expected - 1.0).abs();
            // Third-order terms; round-off 1e-16 |E| over |E|^2.
            let bound = 20.0 * size + 1e-15 / size;
            assert!(error < bound, "{}: relative error {error:e} at a strain of {size:e}", law.name());
            let expected = SymmetricTensor2::IDENTITY * (moduli.lame_lambda() * e.trace()) + e * (2.0 * moduli.shear);
            let error = (law.stress(&c).unwrap() - expected).norm() / expected.norm();
            assert!(error < bound, "{}: relative error {error:e} of the stress at a strain of {size:e}", law.name());
        }
    }
}

#[test]
fn mooney_rivlin() {
    let law = MooneyRivlin::new(176_051.0, 4332.63, 2.0e6).unwrap();
    battery(&law, 1e-13);
    against_dual_numbers(&law, &MooneyRivlinEnergy, 1e-12);
}

#[test]
fn ogden_of_three_terms() {
    battery(&ogden(), 1e-12);
    against_dual_numbers(&ogden(), &OgdenEnergy(&[6300.0, 12.0, -100.0], &[1.3, 5.0, -2.0], 2000.0, 9.0), 1e-10);
}

/// `f` by its number and the bulk modulus.
struct FirstInvariantEnergy(u32, f64);
impl EnergyOracle for FirstInvariantEnergy {
    fn energy<D: DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
        let log_j = invariants::det(c).ln() * 0.5;
        let y = (log_j * (-2.0 / 3.0)).exp() * invariants::trace(c);
        let x = y - 3.0;
        let of_shape = match self.0 {
            0 => x * 0.5 - x * x * 0.005 + x * x * x * 0.0002,
            1 => (-x / 300.0 + 1.0).ln() * (-0.5 * 300.0),
            _ => {
                let terms = [1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673_750.0];
                let mut sum = y * 0.0;
                for (i, c) in (1..).zip(terms) {
                    sum += (y.powi(i) - 3.0_f64.powi(i)) * (c / 4.0_f64.powi(2 * i - 2));
                }
                sum
            }
        };
        of_shape + log_j * log_j * (0.5 * self.1)
    }
}

#[test]
fn yeoh_gent_and_arruda_boyce() {
    for kappa in [2.0, 500.0] {
        let laws = [
            FirstInvariant::yeoh([0.5, -0.005, 0.0002], kappa).unwrap(),
            FirstInvariant::gent(1.0, 300.0, kappa).unwrap(),
            FirstInvariant::arruda_boyce(1.0, 4.0, kappa).unwrap(),
        ];
        for (k, law) in (0..).zip(&laws) {
            battery(law, 1e-12);
            against_dual_numbers(law, &FirstInvariantEnergy(k, kappa), 1e-10);
        }
    }
    // Up to its limit, and not beyond: x = l^2 + 2/l - 3 of an isochoric stretch l.
    let gent = FirstInvariant::gent(1.0, 10.0, 1.0).unwrap();
    let stretched = |l: f64| SymmetricTensor2([l * l, 1.0 / l, 1.0 / l, 0.0, 0.0, 0.0]);
    assert!(gent.energy(&stretched(3.5)).is_ok());
    assert_eq!(gent.energy(&stretched(3.6)).unwrap_err(), ConstitutiveError::NonFinite);
    for refused in [
        FirstInvariant::yeoh([-0.5, 0.0, 0.0], 1.0),
        FirstInvariant::gent(1.0, -1.0, 1.0),
        FirstInvariant::arruda_boyce(1.0, 1.0, 1.0),
        FirstInvariant::gent(1.0, 1.0, 0.0),
    ] {
        assert!(refused.is_err());
    }
}

#[test]
fn ogden_of_one_and_of_five_terms() {
    for (mu, alpha, kappa, beta) in [
        (&[-50.0][..], &[-2.7][..], 3.0e3, -2.0),
        (&[3.0, -7.0, 0.5, 20.0, 1.0][..], &[2.0, -0.3, 6.0, 0.01, -3.0][..], 1.0e4, 1.0),
    ] {
        let law = Ogden::new(mu, alpha, kappa, beta).unwrap();
        battery(&law, 1e-12);
        against_dual_numbers(&law, &OgdenEnergy(mu, alpha, kappa, beta), 1e-10);
    }
}

#[test]
fn ogden_contains_two_closed_forms() {
    // One term with alpha = 2 is the isochoric neo-Hooke law mu/2 (J^(-2/3) I1 - 3), whose derivatives dual numbers give exactly.
    struct Isochoric;
    impl EnergyOracle for Isochoric {
        fn energy<D: DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
            let j = invariants::det(c).sqrt();
            let log_j = j.ln();
            (j.powf(-2.0 / 3.0) * invariants::trace(c) - 3.0) * 400.0
                + (log_j / 9.0 + (j.powf(-9.0) - 1.0) / 81.0) * 2000.0
        }
    }
    let law = Ogden::new(&[800.0], &[2.0], 2000.0, 9.0).unwrap();
    battery(&law, 1e-12);
    against_dual_numbers(&law, &Isochoric, 1e-11);
    // alpha = -2 is mu/2 (J^(2/3) tr C^-1 - 3) = mu/2 (J^(-4/3) I2 - 3), with a minus from mu/alpha.
    struct Second;
    impl EnergyOracle for Second {
        fn energy<D: DualNum<Primitive = f64> + Copy>(&self, c: [D; 6]) -> D {
            let j = invariants::det(c).sqrt();
            let log_j = j.ln();
            (j.powf(-4.0 / 3.0) * invariants::second(c) - 3.0) * 300.0
                + (log_j / -3.0 + (j.powf(3.0) - 1.0) / 9.0) * 2000.0
        }
    }
    let law = Ogden::new(&[-600.0], &[-2.0], 2000.0, -3.0).unwrap();
    against_dual_numbers(&law, &Second, 1e-11);
}

#[test]
fn moduli_of_the_examples() {
    // theory/kinematics#moduli.
    let close = |value: f64, expected: f64, digits: f64| {
        assert!((value / expected - 1.0).abs() < digits, "{value} against {expected}");
    };
    for (law, [young, poisson]) in catalogue() {
        let m = law.small_strain_moduli();
        close(m.young_modulus(), young, 1e-5);
        assert!((m.poisson_ratio() - poisson).abs() < 5e-5, "{}: {}", law.name(), m.poisson_ratio());
    }
    let m = NeoHooke::from_young_poisson(2250.0, 0.3).unwrap().small_strain_moduli();
    close(m.shear, 865.384_615_4, 1e-9);
    close(m.bulk, 1875.0, 1e-12);
    let m = MooneyRivlin::new(176_051.0, 4332.63, 2.0e6).unwrap().small_strain_moduli();
    close(m.shear, 360_767.26, 1e-7);
    close(m.bulk, 4.257_84e6, 1e-5);
    let m = Ogden::new(&[6.3e5, 1.2e3, -1.0e4], &[1.3, 5.0, -2.0], 2.0e5, 9.0).unwrap().small_strain_moduli();
    close(m.shear, 422_500.0, 1e-12);
    close(m.young_modulus(), 743_765.0, 1e-5);
    close(m.poisson_ratio(), -0.1198, 1e-3);
    close(ogden().small_strain_moduli().shear, 4225.0, 1e-12);
}

#[test]
fn parameters_that_are_no_material() {
    assert!(matches!(NeoHooke::new(f64::NAN, 1.0), Err(MaterialError::NotFinite { parameter: "lambda", .. })));
    assert!(matches!(NeoHooke::new(1.0, -1.0), Err(MaterialError::UnstableModuli { .. })));
    assert!(matches!(
        NeoHooke::from_young_poisson(1.0, 0.5),
        Err(MaterialError::OutOfRange { parameter: "poisson", .. })
    ));
    assert!(matches!(
        SaintVenantKirchhoff::from_young_poisson(-1.0, 0.2),
        Err(MaterialError::OutOfRange { parameter: "young", .. })
    ));
    assert!(matches!(MooneyRivlin::new(-2.0, 1.0, 5.0), Err(MaterialError::UnstableModuli { .. })));
    assert!(matches!(Ogden::new(&[1.0], &[], 1.0, 1.0), Err(MaterialError::Lengths { mu: 1, alpha: 0, .. })));
    assert!(matches!(Ogden::new(&[1.0], &[2.0], 1.0, 0.0), Err(MaterialError::OutOfRange { parameter: "beta", .. })));
    assert!(matches!(Ogden::new(&[1.0], &[0.0], 1.0, 1.0), Err(MaterialError::OutOfRange { parameter: "alpha", .. })));
    for (kappa, beta) in [(0.0, 9.0), (-1.0, 9.0)] {
        assert!(matches!(Ogden::new(&[1.0], &[2.0], kappa, beta), Err(MaterialError::UnstableModuli { .. })));
    }
    for at in 0..3 {
        let mut values = [1.0; 3];
        values[at] = f64::INFINITY;
        let error = MooneyRivlin::new(values[0], values[1], values[2]).unwrap_err();
        assert!(matches!(error, MaterialError::NotFinite { parameter, .. } if parameter == ["c1", "c2", "c"][at]));
    }
    let text = Ogden::new(&[-6300.0], &[1.3], 2000.0, 9.0).unwrap_err().to_string();
    assert!(text.contains("-4095") && text.contains("positive"), "{text}");
}

/// A law that a user wrote outside of the catalogue: Blatz-Ko like, `W = mu/2 (I1 - 3 + 2/beta (J^-beta - 1))`.
#[derive(Debug)]
struct UsersLaw {
    mu: f64,
    beta: f64,
}

impl HyperelasticLaw for UsersLaw {
    fn name(&self) -> &str {
        "blatz-ko"
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        let det_c = c.det();
        if det_c <= 0.0 {
            return Err(ConstitutiveError::NonPositiveJacobian { det_c });
        }
        let w = 0.5 * self.mu * (c.trace() - 3.0 + 2.0 / self.beta * (det_c.powf(-0.5 * self.beta) - 1.0));
        if w.is_finite() { Ok(w) } else { Err(ConstitutiveError::NonFinite) }
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        Ok(self.stress_and_elasticity(c)?.0)
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        self.energy(c)?;
        let power = c.det().powf(-0.5 * self.beta);
        let inverse = c.inverse();
        let mut elasticity = Tensor4::inverse_derivative(&inverse) * (-2.0 * self.mu * power);
        elasticity.add_dyad(self.mu * self.beta * power, &inverse, &inverse);
        let stress = (SymmetricTensor2::IDENTITY - inverse * power) * self.mu;
        let finite = stress.is_finite() && elasticity.is_finite();
        if finite { Ok((stress, elasticity)) } else { Err(ConstitutiveError::NonFinite) }
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(self.mu * self.beta, self.mu)
    }
}

#[test]
fn a_law_of_the_users_own() {
    battery(&UsersLaw { mu: 80.0, beta: 1.5 }, 1e-13);
}

/// Four strains, one of which may be far from the others.
fn four() -> SymmetricTensors {
    let mut all = SymmetricTensors::splat(&SymmetricTensor2::IDENTITY);
    all.set(1, &SymmetricTensor2([1.21, 0.9, 1.1, 0.1, -0.05, 0.02]));
    all.set(2, &SymmetricTensor2([1.0 + 1e-9, 1.0, 1.0, 1e-10, 0.0, 0.0]));
    all.set(3, &SymmetricTensor2([2.5, 0.4, 1.4, -0.3, 0.2, 0.1]));
    all
}

#[test]
fn several_strains_or_one() {
    let all = four();
    for (law, _) in catalogue() {
        for count in 1..=LANES {
            let strains = Strains { all: &all, count };
            let (mut energies, mut stresses, mut moduli) = ([0.0; LANES], SymmetricTensors::ZERO, Tensors4::ZERO);
            law.evaluate(&strains, Wanted { energies: Some(&mut energies), ..Wanted::default() }).unwrap();
            let wanted = Wanted { stresses: Some(&mut stresses), moduli: Some(&mut moduli), ..Wanted::default() };
            law.evaluate(&strains, wanted).unwrap();
            let (mut more_energies, mut more_stresses) = ([0.0; LANES], SymmetricTensors::ZERO);
            let wanted =
                Wanted { energies: Some(&mut more_energies), stresses: Some(&mut more_stresses), moduli: None };
            law.evaluate(&strains, wanted).unwrap();
            for point in 0..count {
                let c = all.get(point);
                assert_eq!(energies[point], law.energy(&c).unwrap(), "{} {point}", law.name());
                let (stress, elasticity) = law.stress_and_elasticity(&c).unwrap();
                assert_eq!(stresses.get(point), stress, "{} {point}", law.name());
                assert_eq!(moduli.get(point), elasticity, "{} {point}", law.name());
                let both = law.energy_and_stress(&c).unwrap();
                assert_eq!((more_energies[point], more_stresses.get(point)), both, "{} {point}", law.name());
            }
        }
    }
}

#[test]
fn the_first_bad_strain_of_several_is_named() {
    let law = NeoHooke::from_young_poisson(YOUNG, POISSON).unwrap();
    let mut all = four();
    all.set(2, &SymmetricTensor2([1.0, 1.0, -2.0, 0.0, 0.0, 0.0]));
    all.set(3, &SymmetricTensor2([f64::NAN; 6]));
    let ask = |count: usize| {
        let mut stresses = SymmetricTensors::ZERO;
        let wanted = Wanted { stresses: Some(&mut stresses), ..Wanted::default() };
        law.evaluate(&Strains { all: &all, count }, wanted).map(|()| stresses.get(1))
    };
    assert_eq!(ask(4), Err((2, ConstitutiveError::NonPositiveJacobian { det_c: -2.0 })));
    // What is of no point may be anything.
    assert_eq!(ask(2), Ok(law.stress(&all.get(1)).unwrap()));
}
