//! Bodies whose elements are shared out among ranks: what the ranks give adds up to the whole.
use crate::common::*;
use proptest::prelude::*;
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::*;
use stoss_materials::{Fibres, Hardening, Hencky, Inelastic, Moduli, NeoHooke, Plasticity};
use stoss_mesh::Mesh;
use stoss_reference_element::{CellKind, Integration};
use stoss_term::{At, Term, bisect};

const DT: f64 = 0.01;

/// Round-off of sums of some thousand numbers in two orders: the root of their number.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

/// Cells, integration, whether with averages inside of elements.
const FORMS: [(&[CellKind], Integration, bool); 7] = [
    (&[CellKind::Hex8], Integration::Full, false),
    (&[CellKind::Hex8, CellKind::Wedge6], Integration::Full, true),
    (&[CellKind::Tet4], Integration::Full, false),
    (&[CellKind::Tet10], Integration::Reduced, true),
    (&[CellKind::Wedge15, CellKind::Hex20, CellKind::Hex20], Integration::Reduced, true),
    (&[CellKind::Hex27], Integration::Full, true),
    (&[CellKind::Wedge6, CellKind::Hex8, CellKind::Hex8], Integration::Reduced, false),
];

fn elastic() -> Arc<dyn HyperelasticLaw> {
    laws().swap_remove(1)
}

/// Laws with states: a metal that flows, and fibres in a matrix that relaxes.
fn plastic() -> Arc<dyn HyperelasticLaw> {
    let law = Hencky::new(1000.0, 600.0).unwrap();
    let flow = Plasticity { hardening: Hardening::linear(30.0, 20.0), kinematic: 5.0, overstress: None };
    Arc::new(Inelastic::plastic(law, flow).unwrap())
}

fn fibres() -> Arc<dyn HyperelasticLaw> {
    let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(1000.0, 600.0).unwrap());
    let relaxing = Inelastic::viscous(&law, &[(0.4, 0.02)], Moduli::Instantaneous).unwrap();
    let fibres = Fibres { stiffness: 200.0, exponent: 2.0, dispersion: 0.1 };
    Arc::new(relaxing.with_fibres(fibres, &[[1.0, 0.2, 0.0]]).unwrap())
}

struct Case {
    mesh: Mesh,
    whole: SolidBody,
    owner: Vec<u32>,
    shares: Vec<SolidBody>,
    x: Vec<f64>,
    q_n: Vec<f64>,
    q_np1: Vec<f64>,
}

/// What each rank has of a body.
fn shared(whole: &SolidBody, owner: &[u32], ranks: u32) -> Vec<SolidBody> {
    let share = |rank: u32| {
        let mut share = whole.clone();
        share.share(&owner.iter().map(|of| *of == rank).collect::<Vec<_>>()).unwrap();
        share
    };
    (0..ranks).map(share).collect()
}

impl Case {
    /// Elements go to ranks by chance, so that some may have none. Node numbers of the model begin before those of the body.
    fn new(form: usize, law: &Arc<dyn HyperelasticLaw>, ranks: u32, seed: u64) -> Self {
        const OFFSET: u32 = 3;
        let (kinds, integration, mixed) = FORMS[form];
        let mesh = cells(kinds, [2, 2, 1], 0.1, 0.0, seed);
        let volumetric = if mixed { Volumetric::Mixed } else { Volumetric::Displacement };
        let options = SolidOptions { integration, volumetric };
        let mut whole = SolidBody::with_options("body", &mesh, OFFSET, law.clone(), options).unwrap();
        let mut random = Random(seed);
        let directions = Vec::from_iter((0..3 * mesh.elements.len()).map(|_| random.next()));
        let _ = whole.set_state_of_elements("fibre_direction_1", &directions);
        let owner: Vec<u32> =
            mesh.elements.iter().map(|_| ((random.next() + 1.0) / 2.0 * f64::from(ranks)) as u32 % ranks).collect();
        let shares = shared(&whole, &owner, ranks);
        let mut x = vec![0.0; 3 * OFFSET as usize];
        x.extend(positions(&mesh));
        let q_n = random.perturbed(&x, 0.03);
        let q_np1 = random.perturbed(&q_n, 0.03);
        Self { mesh, whole, owner, shares, x, q_n, q_np1 }
    }

    fn begin(&mut self, rule: ForceRule) {
        std::iter::once(&mut self.whole)
            .chain(&mut self.shares)
            .for_each(|body| body.begin_step(&self.q_n, rule, DT).unwrap());
    }

    fn end(&mut self) {
        std::iter::once(&mut self.whole).chain(&mut self.shares).for_each(|body| body.end_step(&self.q_np1).unwrap());
    }

    /// The sum of what the ranks give is what the whole body gives, to the round-off of sums: each list beside its largest number.
    fn adds_up(&self, what: &str, of: impl Fn(&SolidBody) -> Vec<Vec<f64>>) {
        let whole = of(&self.whole);
        let shares: Vec<_> = self.shares.iter().map(of).collect();
        for (k, whole) in whole.iter().enumerate() {
            let parts = |i: usize| shares.iter().map(move |share| share[k][i]);
            let scale = (0..whole.len()).map(|i| parts(i).map(f64::abs).sum()).fold(0.0, f64::max);
            for (i, whole) in whole.iter().enumerate() {
                let sum: f64 = parts(i).sum();
                assert!((sum - whole).abs() <= ROUND_OFF * scale, "{what}, {k}: {sum} {whole} of {scale}");
            }
        }
    }
}

/// Product, diagonal, momenta, energy and total of a mass.
fn of_mass(mass: &MassMatrix, q: &[f64], v: &[f64]) -> Vec<Vec<f64>> {
    let (mut product, mut diagonal) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    mass.multiply_add(0.7, v, &mut product);
    mass.add_diagonal(&mut diagonal);
    // Beside the momenta that they would have if nothing were opposed.
    let size = mass.total() * max_abs(v);
    let momenta = [(mass.linear_momentum(v), size), (mass.angular_momentum(q, v), size * max_abs(q))];
    let momenta = momenta.map(|(momentum, size)| [&momentum[..], &[size]].concat());
    let scalars = [vec![mass.kinetic_energy(v)], vec![mass.total()]];
    [product, diagonal].into_iter().chain(momenta).chain(scalars).collect()
}

/// Forces and tangents of the material and of viscous damping, masses.
fn of_body(body: &SolidBody, case: &Case, rule: ForceRule) -> Vec<Vec<f64>> {
    let Case { q_n, q_np1, .. } = case;
    let (force, tangent) = force_and_tangent(body, SolidStep { q_n, q_np1, rule });
    let v: Vec<f64> = q_np1.iter().zip(q_n).map(|(a, b)| (a - b) / DT).collect();
    let (mut viscous, (pattern, map)) = (vec![0.0; v.len()], pattern(body, v.len()));
    let mut values = vec![0.0; pattern.nnz()];
    let target = TangentTarget { map: &map, first_stencil: 0, factor: 0.5, values: &mut values };
    let rate = ViscousRate { q: q_np1, v: &v, factor: 0.02, slopes: [0.5, 1.0 / DT] };
    body.add_viscous_force(rate, &mut viscous, Some(target)).unwrap();
    let damping = dense(&pattern, &values);
    let masses = [MassKind::Consistent, MassKind::Lumped].map(|kind| of_mass(&body.mass(2.0, kind), q_np1, &v));
    let forces = [force, tangent.concat(), viscous, damping.concat()];
    forces.into_iter().chain(masses.into_iter().flatten()).collect()
}

fn energies(body: &SolidBody, q: &[f64]) -> Vec<Vec<f64>> {
    let end = body.step_end(q).unwrap().unwrap_or_default();
    let losses = [end.stored, end.hardening, end.loss.plastic, end.loss.viscous, end.loss.softening];
    let energies = [body.strain_energy(q).unwrap(), body.potential(q).unwrap(), body.hardening_energy()];
    losses.into_iter().chain(energies).map(|energy| vec![energy]).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn shares_add_up_to_the_body(form in 0..FORMS.len(), law in 0usize..3, ranks in prop::sample::select(vec![1u32, 2, 3, 7]), seed: u64) {
        let law = [elastic, plastic, fibres][law]();
        let mut case = Case::new(form, &law, ranks, seed);
        for rule in [ForceRule::Configuration { theta: 0.4 }, ForceRule::DiscreteGradient] {
            case.begin(rule);
            case.adds_up("forces and masses", |body| of_body(body, &case, rule));
            case.adds_up("energies", |body| energies(body, &case.q_np1));
            let flow = |body: &SolidBody| body.step_end(&case.q_np1).unwrap().map_or(0.0, |end| end.flow);
            prop_assert_eq!(case.shares.iter().map(flow).fold(0.0, f64::max), flow(&case.whole));
        }
        case.end();
        let q = &case.q_np1;
        let mut stress = case.shares[0].nodal_cauchy_stress(q).unwrap();
        for share in &case.shares[1..] {
            let mut more = share.nodal_cauchy_stress(q).unwrap();
            stress.numbers_mut().iter_mut().zip(more.numbers_mut()).for_each(|(sum, part)| *sum += *part);
        }
        let (found, expected) = (stress.means(), case.whole.nodal_cauchy_stress(q).unwrap().means());
        let scale = max_abs(expected.as_flattened());
        for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
            prop_assert!((found - expected).abs() <= 1e-14 * scale, "{found} {expected}");
        }
        let place = case.whole.material_point(&case.x, case.whole.element_centres().last().unwrap()).unwrap();
        case.adds_up("probe", |body| {
            let state = body.state_at(&place, q).unwrap();
            vec![state.deformation_gradient.concat(), state.green_lagrange.into(), state.cauchy.into()]
        });
        if let Some(output) = case.whole.state_output("equivalent_plastic_strain") {
            case.adds_up("output", |body| {
                let at_nodes = body.nodal_state_output::<1>(q, output).unwrap().numbers_mut().to_vec();
                vec![body.state_output_at(&place, q, output).unwrap(), at_nodes]
            });
        }
        let points = |body: &SolidBody| body.gauss_point_state(q).unwrap();
        let (whole, mut parts) = (points(&case.whole), case.shares.iter().map(|share| points(share).into_iter()).collect::<Vec<_>>());
        for (element, owner) in whole.iter().zip(&case.owner) {
            let own = parts[*owner as usize].next();
            prop_assert_eq!(Some(element), own.as_ref());
        }
        for share in &case.shares {
            prop_assert!(share.is_shared() && !case.whole.is_shared());
            prop_assert_eq!(share.volume(), case.whole.volume());
            prop_assert_eq!(share.element_count(), case.whole.element_count());
            prop_assert_eq!(Term::force_scale(share), Term::force_scale(&case.whole));
            let loads = |body: &SolidBody| {
                let mut loads = vec![0.0; q.len()];
                body.body_force([1.0, 2.0, 3.0], &mut loads).unwrap();
                loads
            };
            prop_assert_eq!(loads(share), loads(&case.whole));
        }
    }
}

#[test]
fn one_rank_with_all_elements_has_the_bits_of_the_body() {
    for form in 0..FORMS.len() {
        for law in [elastic(), plastic(), fibres()] {
            let mut case = Case::new(form, &law, 1, 5);
            case.begin(ForceRule::DiscreteGradient);
            let [whole, share] = [&case.whole, &case.shares[0]].map(|body| {
                let mut all = of_body(body, &case, ForceRule::DiscreteGradient);
                all.extend(energies(body, &case.q_np1));
                all
            });
            assert_eq!(whole, share);
            case.end();
            let stress = |body: &SolidBody| body.nodal_cauchy_stress(&case.q_np1).unwrap().means();
            assert_eq!(stress(&case.whole), stress(&case.shares[0]));
        }
    }
}

#[test]
fn masses_with_nodes_that_others_carry_add_up() {
    let mut case = Case::new(0, &elastic(), 3, 11);
    case.mesh = cells(&[CellKind::Hex8], [2, 2, 6], 0.05, 0.0, 11);
    case.whole = body(&case.mesh, &elastic());
    let centres: Vec<[f64; 3]> = case.whole.element_centres().collect();
    case.shares = shared(&case.whole, &bisect(&centres, &[1; 24], 3), 3);
    case.q_n = positions(&case.mesh);
    let mut random = Random(12);
    let v = random.perturbed(&vec![0.0; case.q_n.len()], 1.0);
    for kind in [MassKind::Consistent, MassKind::Lumped] {
        let top = (0..case.mesh.nodes.len() as u32).filter(|node| case.mesh.nodes[*node as usize][2] > 5.5);
        let massless = Massless::new(&case.whole, kind, top.clone()).unwrap();
        assert_eq!(Massless::new(&case.shares[1], kind, top).unwrap(), massless);
        assert!(massless.least_density().is_some(), "elements differ");
        case.adds_up("mass", |body| of_mass(&massless.mass(body, 2.0, kind), &case.q_n, &v));
        case.adds_up("rows of the matrix", |body| {
            let mass = massless.mass(body, 2.0, kind);
            let components = |nodes: &[u32]| nodes.iter().flat_map(|n| 3 * n..3 * n + 3).collect::<Vec<_>>();
            let stencils: Vec<Vec<u32>> = body.stencils().chain(mass.stencils()).map(components).collect();
            let iter = || stencils.iter().map(Vec::as_slice);
            let pattern = stoss_linalg::SparsityPattern::from_stencils(v.len(), iter()).unwrap();
            let map = stoss_linalg::ScatterMap::new(&pattern, iter()).unwrap();
            let mut values = vec![0.0; pattern.nnz()];
            mass.add_to_tangent(1.5, TangentTarget { map: &map, first_stencil: 0, factor: 2.0, values: &mut values });
            dense(&pattern, &values)
        });
    }
}

#[test]
fn messages_name_elements_of_the_body() {
    let mesh = cells(&[CellKind::Hex8], [4, 1, 1], 0.0, 0.0, 1);
    let whole = body(&mesh, &elastic());
    let x = positions(&mesh);
    let mut share = whole.clone();
    share.share(&[false, true, false, true]).unwrap();
    // Element 3 is turned inside out.
    let mirrored = map_positions(&x, |x| if x[0] > 3.5 { [2.5, x[1], x[2]] } else { x });
    share.begin_step(&x, ForceRule::DiscreteGradient, DT).unwrap();
    let step = SolidStep { q_n: &x, q_np1: &mirrored, rule: ForceRule::DiscreteGradient };
    assert_eq!(
        force(&share, step),
        force(
            &{
                let mut whole = whole.clone();
                whole.begin_step(&x, ForceRule::DiscreteGradient, DT).unwrap();
                whole
            },
            step
        )
    );
    assert!(matches!(force(&share, step), Err(SolidError::InvertedElement { element: 3, .. })));
    assert!(matches!(share.strain_energy(&mirrored), Err(SolidError::InvertedElement { element: 3, .. })));
    assert!(matches!(share.nodal_cauchy_stress(&mirrored), Err(SolidError::InvertedElement { element: 3, .. })));
    let begun = share.begin_step(&mirrored, ForceRule::DiscreteGradient, DT);
    assert!(matches!(begun, Err(SolidError::InvertedElement { element: 3, level: TimeLevel::Start, .. })));
    // Elements 1 and 3 are turned over, 3 more than 1.
    let turned = map_positions(&x, |x| match x[0].round() as i32 {
        2 => [0.9, x[1], x[2]],
        4 => [2.0, x[1], x[2]],
        _ => x,
    });
    let mut other = whole.clone();
    other.share(&[true, false, true, false]).unwrap();
    let found = [&whole, &share, &other].map(|body| body.inside_out(&turned).unwrap());
    assert_eq!(found[1].map(|found| (found.count, found.element)), Some((2, 3)));
    assert_eq!(found[2], None);
    other.share(&[false; 4]).unwrap();
    let mut third = whole.clone();
    third.share(&[false, false, false, true]).unwrap();
    share.share(&[false, true, false, false]).unwrap();
    let [one, three] = [&share, &third].map(|body| body.inside_out(&turned).unwrap().unwrap());
    assert_eq!((Some(one.and(&three)), Some(three.and(&one))), (found[0], found[0]));
    assert_eq!(other.strain_energy(&turned), Ok(0.0));
}

/// Of a block the solution costs the same for each node, and the rest is that of the points.
#[test]
fn elements_cost_by_points_nodes_and_law() {
    let cost = |kind: CellKind, law: Arc<dyn HyperelasticLaw>| {
        let body = body_with(&cells(&[kind], [4, 4, 4], 0.0, 0.0, 1), &law, Integration::Full);
        let costs = body.element_costs();
        let mut share = body.clone();
        share.share(&vec![false; costs.len()]).unwrap();
        assert_eq!(share.element_costs(), costs);
        (costs.iter().sum::<u64>() as f64, body.node_count() as f64, costs.len() as f64)
    };
    let (hex8, nodes, elements) = cost(CellKind::Hex8, elastic());
    assert!((hex8 / (27e3 * nodes + 8.0 * (240.0 + 128.0) * elements) - 1.0).abs() < 1e-3, "{hex8}");
    let (plastic, ..) = cost(CellKind::Hex8, plastic());
    assert!((plastic - hex8 - 8.0 * 1900.0 * elements).abs() < 1e-6 * hex8, "{plastic}");
    let (hex27, nodes, elements) = cost(CellKind::Hex27, elastic());
    assert!((hex27 / (27e3 * nodes + 27.0 * (240.0 + 1458.0) * elements) - 1.0).abs() < 1e-3, "{hex27}");
}

#[test]
fn shares_that_cannot_be_are_refused() {
    let mesh = cells(&[CellKind::Tet4], [1, 1, 1], 0.0, 0.0, 1);
    let mut mixed = mixed_body(&mesh, &elastic(), Integration::Full);
    assert!(mixed.is_indivisible() && !body(&mesh, &elastic()).is_indivisible());
    let error = mixed.share(&[true, false, true, true, true, true]).unwrap_err();
    assert!(matches!(error, SolidError::Indivisible { .. }) && !mixed.is_shared());
    let (x, mut none) = (positions(&mesh), mixed.clone());
    none.share(&[false; 6]).unwrap();
    mixed.share(&[true; 6]).unwrap();
    assert_eq!((none.strain_energy(&x), none.stencils().count()), (Ok(0.0), 0));
    assert_eq!(mixed.stencils().count(), 6 + mesh.nodes.len());
    // Data can be made again, states cannot.
    none.share(&[true; 6]).unwrap();
    assert_eq!(none.stencils().count(), mixed.stencils().count());
    let mut yielding = body(&mesh, &plastic());
    yielding.share(&[true, true, false, false, true, true]).unwrap();
    yielding.share(&[false, true, false, false, true, false]).unwrap();
    let error = yielding.share(&[false, true, true, false, true, false]).unwrap_err();
    assert!(matches!(error, SolidError::OnOtherRank { element: 2, .. }) && yielding.has_element(1));
    assert!(matches!(none.share(&[true; 5]), Err(SolidError::Length { found: 5, expected: 6, .. })));
}

/// Data of elements are not made before they are needed.
#[test]
fn a_share_has_the_memory_of_its_elements() {
    let mesh = cells(&[CellKind::Hex8], [4, 4, 4], 0.0, 0.0, 1);
    let (x, mut whole) = (positions(&mesh), body(&mesh, &elastic()));
    let without = whole.memory_bytes();
    let mut share = whole.clone();
    share.share(&Vec::from_iter((0..64).map(|element| element < 16))).unwrap();
    let shared = share.memory_bytes();
    for body in [&mut whole, &mut share] {
        body.begin_step(&x, ForceRule::DiscreteGradient, DT).unwrap();
    }
    // Eight points with an inverse of the Jacobian matrix, a weight, a strain and an energy each; gradients at nodes once.
    let of_elements = [(&whole, without), (&share, shared)].map(|(body, before)| body.memory_bytes() - before);
    let once = 4 * of_elements[1] - of_elements[0];
    assert!(once > 0 && once % 3 == 0, "{of_elements:?}");
    assert_eq!(of_elements[0] - once / 3, 64 * 8 * 17 * size_of::<f64>());
}

/// Half of the steps on `from` ranks and half on `to` ranks: the bytes are those of one rank.
#[test]
fn histories_are_merged_and_divided() {
    for (law, ranks) in [(plastic(), [3, 2]), (fibres(), [7, 1]), (elastic(), [2, 2])] {
        let mut case = Case::new(6, &law, ranks[0], 3);
        case.begin(ForceRule::DiscreteGradient);
        case.end();
        let parts: Vec<Vec<u8>> = case.shares.iter().map(Term::save_history).collect();
        let merged = case.whole.merge_history(&parts, &case.owner).unwrap();
        assert_eq!(merged, case.whole.save_history());
        assert_eq!(merged.is_empty(), !case.whole.has_history());
        let mut other = Case::new(6, &law, ranks[1], 3);
        other.owner.reverse();
        for mut share in shared(&case.whole, &other.owner, ranks[1]) {
            let saved = share.save_history();
            let virgin = SolidBody::new("body", &case.mesh, 3, law.clone()).unwrap();
            share.set_states(&virgin.states().flatten().copied().collect::<Vec<_>>()).unwrap();
            assert!(!case.whole.has_history() || saved.is_empty() || share.save_history() != saved);
            share.load_history(&merged).unwrap();
            assert_eq!(share.save_history(), saved);
        }
        if case.whole.has_history() {
            assert!(case.shares[0].load_history(&merged[8..]).is_err());
            assert!(case.whole.merge_history(&parts[1..], &case.owner).is_err());
            assert!(case.whole.merge_history(&parts, &case.owner[1..]).is_err());
        }
    }
}

/// What a solver asks of a body as a term.
#[test]
fn a_share_as_a_term() {
    let mut case = Case::new(0, &plastic(), 3, 8);
    let rule = ForceRule::DiscreteGradient;
    case.begin(rule);
    let at = At::force([&case.q_n, &case.q_np1], rule, DT);
    case.adds_up("force", |body| {
        let mut force = vec![0.0; case.x.len()];
        let mut stencils = Vec::new();
        Term::stencils(body, &[], &mut |nodes, _| stencils.push(nodes.to_vec()));
        let mut next = stencils.iter();
        Term::assemble(body, &at, false, &mut |local| {
            assert_eq!(next.next(), Some(&local.nodes));
            for (&node, r) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
                (0..3).for_each(|i| force[3 * node as usize + i] += r[i]);
            }
        })
        .unwrap();
        assert_eq!(next.next(), None);
        vec![force]
    });
    case.adds_up("work", |body| {
        let work = Term::work(body, &at).unwrap();
        let energies = [Term::energy(body, &case.q_np1).unwrap(), Term::merit(body, &at).unwrap()];
        [work.stored, work.dissipated].into_iter().chain(energies).map(|energy| vec![energy]).collect()
    });
}
