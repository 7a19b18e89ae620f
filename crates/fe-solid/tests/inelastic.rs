//! Elements whose law has a state: patch test, free flight, tangents, states from step to step (theory/inelastic).
use crate::common::*;
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::{ForceRule, MassKind, SolidBody, SolidStep, TangentTarget};
use stoss_materials::{Fibres, Hardening, Hencky, Inelastic, Moduli, Mullins, NeoHooke, Overstress, Plasticity};
use stoss_mesh::Mesh;
use stoss_reference_element::{CellKind, Integration};

const BULK: f64 = 164_206.0;
const MU: f64 = 80_193.8;

fn metal(hardening: Hardening, kinematic: f64, overstress: Option<Overstress>) -> Arc<dyn HyperelasticLaw> {
    let law = Hencky::new(BULK - 2.0 / 3.0 * MU, MU).unwrap();
    Arc::new(Inelastic::plastic(law, Plasticity { hardening, kinematic, overstress }).unwrap())
}

fn voce() -> Hardening {
    Hardening::Voce { s0: 450.0, h: 129.24, saturation: 715.0, rate: 16.93 }
}

fn rubber(bulk: f64) -> Arc<dyn HyperelasticLaw> {
    let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(bulk, MU).unwrap());
    Arc::new(Inelastic::viscous(&law, &[(0.4, 1e-6), (0.2, 1e-4), (0.1, 1e-9)], Moduli::Instantaneous).unwrap())
}

/// Two families in a relaxing matrix.
fn fibres() -> Arc<dyn HyperelasticLaw> {
    let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(BULK, MU).unwrap());
    let fibres = Fibres { stiffness: 0.3 * MU, exponent: 2.0, dispersion: 0.1 };
    let relaxing = Inelastic::viscous(&law, &[(0.4, 1e-6)], Moduli::Instantaneous).unwrap();
    Arc::new(relaxing.with_fibres(fibres, &[[1.0, 0.2, 0.0], [0.0, 1.0, -1.0]]).unwrap())
}

/// Every kind of history.
fn materials() -> Vec<(&'static str, Arc<dyn HyperelasticLaw>)> {
    let overstress = Some(Overstress { stress: 200.0, rate: 1e4, exponent: 0.3 });
    let softening: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(BULK, MU).unwrap());
    let softening = Inelastic::softening(&softening, Mullins { r: 1.5, m: 0.002 * MU, beta: 0.1 }).unwrap();
    vec![
        ("voce", metal(voce(), 0.0, None)),
        ("voce and kinematic", metal(voce(), 2000.0, None)),
        ("overstress", metal(Hardening::linear(450.0, 129.24), 500.0, overstress)),
        ("maxwell", rubber(BULK)),
        ("softening", Arc::new(softening)),
        ("fibres", fibres()),
    ]
}

/// Cells, divisions, whether with averages.
const FORMS: [(CellKind, [usize; 3], Integration, bool); 9] = [
    (CellKind::Hex8, [2, 1, 1], Integration::Full, true),
    (CellKind::Hex8, [2, 1, 1], Integration::Full, false),
    (CellKind::Tet4, [2, 1, 1], Integration::Full, true),
    (CellKind::Wedge6, [2, 1, 1], Integration::Full, false),
    (CellKind::Hex20, [1, 1, 1], Integration::Full, true),
    (CellKind::Hex20, [1, 1, 1], Integration::Reduced, true),
    (CellKind::Hex27, [1, 1, 1], Integration::Full, true),
    (CellKind::Tet10, [1, 1, 1], Integration::Full, true),
    (CellKind::Wedge15, [1, 1, 1], Integration::Full, true),
];

fn made(mesh: &Mesh, law: &Arc<dyn HyperelasticLaw>, integration: Integration, mixed: bool) -> SolidBody {
    if mixed { mixed_body(mesh, law, integration) } else { body_with(mesh, law, integration) }
}

fn states(body: &SolidBody) -> Vec<f64> {
    body.states().flatten().copied().collect()
}

/// Newton's method with a line search on the slope `R . x`, for the free components of `q`.
fn newton(
    q: &mut [f64],
    free: &[usize],
    tolerance: f64,
    residual: &dyn Fn(&[f64]) -> Vec<f64>,
    tangent: &dyn Fn(&[f64]) -> Vec<Vec<f64>>,
) -> usize {
    for iteration in 0..40 {
        let r = residual(q);
        let r: Vec<f64> = free.iter().map(|&c| r[c]).collect();
        if max_abs(&r) < tolerance {
            return iteration;
        }
        let k = tangent(q);
        let matrix: Vec<Vec<f64>> = free.iter().map(|&a| free.iter().map(|&b| k[a][b]).collect()).collect();
        let x = solve(matrix, r.iter().map(|r| -r).collect());
        let at = |s: f64| {
            let mut q = q.to_vec();
            free.iter().zip(&x).for_each(|(&c, x)| q[c] += s * x);
            q
        };
        let slope = |s: f64| {
            let r = residual(&at(s));
            free.iter().zip(&x).map(|(&c, x)| r[c] * x).sum::<f64>()
        };
        let start = dot(&r, &x);
        let (mut low, mut high) = ((0.0, start), (1.0, slope(1.0)));
        let mut s = 1.0;
        if high.1.abs() > 0.8 * start.abs() {
            for _ in 0..8 {
                let part = (low.1 / (low.1 - high.1)).clamp(0.1, 0.9);
                s = low.0 + part * (high.0 - low.0);
                let g = slope(s);
                if g.abs() <= 0.8 * start.abs() {
                    break;
                }
                if g * start > 0.0 { low = (s, g) } else { high = (s, g) }
            }
        }
        q.copy_from_slice(&at(s));
    }
    panic!("no convergence: {:e}", max_abs(&residual(q)));
}

#[test]
fn tangents_are_derivatives_in_the_middle_of_flow() {
    for (name, law) in materials() {
        for (kind, divisions, integration, mixed) in FORMS {
            let mesh = cells(&[kind], divisions, 0.05, 0.0, 5);
            let mut body = made(&mesh, &law, integration, mixed);
            let q = positions(&mesh);
            let mut random = Random(17);
            let stretched =
                |s: f64| map_positions(&q, |x| [x[0] * (1.0 + s) + 0.5 * s * x[1], x[1] - 0.4 * s * x[0], x[2]]);
            let (q_n, q_np1) = (stretched(0.03), random.perturbed(&stretched(0.05), 0.004));
            // One step into flow, then the next one.
            body.begin_step(&q, ForceRule::END_POINT, 1e-6).unwrap();
            body.end_step(&q_n).unwrap();
            for rule in [ForceRule::Configuration { theta: 0.5 }, ForceRule::END_POINT, ForceRule::DiscreteGradient] {
                body.begin_step(&q_n, rule, 1e-6).unwrap();
                let at = |q: &[f64]| force(&body, SolidStep { q_n: &q_n, q_np1: q, rule }).unwrap();
                let (f, tangent) = force_and_tangent(&body, SolidStep { q_n: &q_n, q_np1: &q_np1, rule });
                assert!(f.iter().zip(at(&q_np1)).all(|(a, b)| (a - b).abs() < 1e-12 * max_abs(&f)), "{name} {kind}");
                let scale = tangent.iter().map(|row| max_abs(row)).fold(0.0, f64::max);
                for j in (0..q_np1.len()).step_by(5) {
                    let column = derivative(&q_np1, j, 2e-6, at);
                    for i in 0..q_np1.len() {
                        let error = (tangent[i][j] - column[i]).abs() / scale;
                        assert!(error < 2e-6, "{name} {kind} mixed {mixed} {rule:?} ({i},{j}): {error:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn uniform_flow_is_found_by_a_distorted_mesh() {
    // 2 x 2 x 2 cubes, what is inside moved; the boundary goes to F X in four steps. Value of a: an independent prototype.
    const F: [[f64; 3]; 3] = [[1.05, 0.12, -0.03], [0.02, 0.96, 0.06], [0.0, 0.05, 0.98]];
    let law = metal(voce(), 2000.0, None);
    for (kind, integration, mixed) in [
        (CellKind::Hex8, Integration::Full, true),
        (CellKind::Hex8, Integration::Full, false),
        (CellKind::Tet4, Integration::Full, true),
        (CellKind::Tet4, Integration::Full, false),
        (CellKind::Wedge6, Integration::Full, false),
    ] {
        let mut mesh = cells(&[kind], [2, 2, 2], 0.0, 0.0, 1);
        let on_boundary: Vec<bool> = mesh.nodes.iter().map(|x| x.iter().any(|x| *x == 0.0 || *x == 2.0)).collect();
        let mut random = Random(3);
        for (x, _) in mesh.nodes.iter_mut().zip(&on_boundary).filter(|(_, outside)| !**outside) {
            *x = std::array::from_fn(|i| x[i] + 0.3 * random.next());
        }
        let x = positions(&mesh);
        let free: Vec<usize> = (0..x.len()).filter(|c| !on_boundary[c / 3]).collect();
        let mut body = made(&mesh, &law, integration, mixed);
        let mut q = x.clone();
        for step in 1..=4 {
            let s = f64::from(step) / 4.0;
            let exact = map_positions(&x, |x| {
                std::array::from_fn(|i| x[i] + s * ((0..3).map(|j| F[i][j] * x[j]).sum::<f64>() - x[i]))
            });
            let q_n = q.clone();
            body.begin_step(&q_n, ForceRule::END_POINT, 1.0).unwrap();
            (0..q.len()).filter(|c| on_boundary[c / 3]).for_each(|c| q[c] = exact[c]);
            let step = |q: &[f64]| {
                let q = q.to_vec();
                force_and_tangent(&body, SolidStep { q_n: &q_n, q_np1: &q, rule: ForceRule::END_POINT })
            };
            newton(&mut q, &free, 1e-9, &|q| step(q).0, &|q| step(q).1);
            let off = q.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12, "{kind}: off by {off:e}");
            body.end_step(&q).unwrap();
        }
        for state in states(&body).chunks(13) {
            assert!((state[6] - 0.115_776_615_210).abs() < 1e-11, "{kind}: {}", state[6]);
        }
        let place = body.state_output("equivalent_plastic_strain").unwrap();
        let nodal = body.nodal_state_output::<1>(&q, place).unwrap().means();
        assert!(nodal.iter().all(|a| (a[0] - 0.115_776_615_210).abs() < 1e-11));
    }
}

/// A bar that spins, stretches and twists without loads: `[lost, energy + lost, momenta]`, relative to the begin.
fn flight(body: &mut SolidBody, q: &[f64], dt: f64, steps: usize) -> [f64; 3] {
    let n = q.len();
    let centre = [1.0, 0.5, 0.5];
    let mut q = q.to_vec();
    let mut v = map_positions(&q, |x| {
        let [x, y, z] = std::array::from_fn(|i| x[i] - centre[i]);
        let w = 6e4;
        [-w * y + w * x + 1e4, w * x - 0.7 * w * x * z + 2e4, 0.7 * w * x * y - 3e4]
    });
    let mass = body.mass(7.8e-9, MassKind::Consistent);
    let (pattern, map) = pattern(body, n);
    let mut values = vec![0.0; pattern.nnz()];
    mass.add_to_tangent(1.0, TangentTarget { map: &map, first_stencil: 0, factor: 1.0, values: &mut values });
    let m = dense(&pattern, &values);
    let free: Vec<usize> = (0..n).collect();
    let energy = mass.kinetic_energy(&v) + body.strain_energy(&q).unwrap();
    let (linear, angular) = (mass.linear_momentum(&v), mass.angular_momentum(&q, &v));
    let (mut lost, mut gap, mut momenta) = (0.0, 0.0_f64, 0.0_f64);
    let size = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    for _ in 0..steps {
        body.begin_step(&q, ForceRule::DiscreteGradient, dt).unwrap();
        let q_n = q.clone();
        let mut end: Vec<f64> = q.iter().zip(&v).map(|(q, v)| q + dt * v).collect();
        let step = |q: &[f64]| {
            let (mut f, mut k) =
                force_and_tangent(body, SolidStep { q_n: &q_n, q_np1: q, rule: ForceRule::DiscreteGradient });
            let change: Vec<f64> = (0..n).map(|i| q[i] - q_n[i] - dt * v[i]).collect();
            for i in 0..n {
                f[i] += 2.0 / (dt * dt) * dot(&m[i], &change);
                k[i].iter_mut().zip(&m[i]).for_each(|(k, m)| *k += 2.0 / (dt * dt) * m);
            }
            (f, k)
        };
        newton(&mut end, &free, 1e-15 * body.law().small_strain_moduli().bulk, &|q| step(q).0, &|q| step(q).1);
        v = (0..n).map(|i| 2.0 * (end[i] - q[i]) / dt - v[i]).collect();
        q = end;
        let done = body.step_end(&q).unwrap().unwrap();
        body.end_step(&q).unwrap();
        assert!((body.strain_energy(&q).unwrap() - done.stored).abs() <= 1e-14 * energy);
        assert!(done.loss.total() >= -1e-15 * energy);
        lost += done.loss.total();
        gap = gap.max((mass.kinetic_energy(&v) + done.stored + lost - energy).abs() / energy);
        let (l, j) = (mass.linear_momentum(&v), mass.angular_momentum(&q, &v));
        for i in 0..3 {
            momenta = momenta.max((l[i] - linear[i]).abs() / size(&linear));
            momenta = momenta.max((j[i] - angular[i]).abs() / size(&angular));
        }
    }
    [lost / energy, gap, momenta]
}

#[test]
fn free_flight_keeps_energy_less_losses_and_momenta() {
    for (name, law) in materials() {
        for (kind, divisions, integration, mixed) in FORMS {
            // Displacement elements and kinds that have been seen with one law need no other.
            if name != "voce" && !matches!(kind, CellKind::Hex8 | CellKind::Tet4) {
                continue;
            }
            let mesh = cells(&[kind], divisions, 0.0, 0.0, 0);
            let mut body = made(&mesh, &law, integration, mixed);
            let [lost, gap, momenta] = flight(&mut body, &positions(&mesh), 2e-7, 12);
            assert!(gap < 1e-12 && momenta < 1e-12, "{name} {kind} {mixed}: {gap:e} {momenta:e}");
            assert!(lost > if name == "softening" { 1e-4 } else { 0.02 } && lost < 1.0, "{name} {kind}: lost {lost}");
        }
    }
}

#[test]
fn nearly_incompressible_bars_keep_their_balance() {
    let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(1e4 * MU, MU).unwrap());
    let law: Arc<dyn HyperelasticLaw> =
        Arc::new(Inelastic::viscous(&law, &[(0.4, 1e-6), (0.2, 1e-4)], Moduli::LongTerm).unwrap());
    for (kind, divisions) in [(CellKind::Hex8, [2, 1, 1]), (CellKind::Hex27, [1, 1, 1])] {
        let mesh = cells(&[kind], divisions, 0.0, 0.0, 0);
        // Without a change of volume at the begin the energy of which would be all.
        let mut body = mixed_body(&mesh, &law, Integration::Full);
        let [lost, gap, momenta] = flight(&mut body, &positions(&mesh), 1e-7, 10);
        assert!(lost > 1e-3 && gap < 1e-11 && momenta < 1e-11, "{kind}: lost {lost}, {gap:e} {momenta:e}");
    }
}

#[test]
fn states_are_those_of_accepted_steps() {
    let law = metal(voce(), 2000.0, None);
    let mesh = cells(&[CellKind::Hex8, CellKind::Wedge6], [2, 2, 1], 0.05, 0.0, 9);
    let mut body = body_with(&mesh, &law, Integration::Full);
    let x = positions(&mesh);
    let q = map_positions(&x, |x| [x[0] * 1.04, x[1] * 0.98, x[2] * 0.98 + 0.02 * x[0]]);
    assert!(body.step_end(&q).is_err(), "no step has begun");
    let virgin = states(&body);
    body.begin_step(&x, ForceRule::END_POINT, 1.0).unwrap();
    let end = body.step_end(&q).unwrap().unwrap();
    // A step that is left behind changes nothing.
    assert_eq!(states(&body), virgin);
    body.begin_step(&x, ForceRule::END_POINT, 0.5).unwrap();
    assert_eq!(body.step_end(&q).unwrap().unwrap(), end, "rate-independent, and the same begin");
    body.end_step(&q).unwrap();
    assert!(end.loss.plastic > 0.0 && end.hardening > 0.0 && end.hardening < end.stored);
    assert!((body.hardening_energy() / end.hardening - 1.0).abs() < 1e-14);
    let saved = states(&body);
    // Whatever the number of threads.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let mut other = body_with(&mesh, &law, Integration::Full);
    let in_pool = pool.install(|| {
        other.begin_step(&x, ForceRule::END_POINT, 1.0).unwrap();
        let end = other.step_end(&q).unwrap().unwrap();
        other.end_step(&q).unwrap();
        end
    });
    assert_eq!((in_pool, states(&other)), (end, saved.clone()));
    // Taken again, the states have the same forces, which are those of the state without flow.
    let mut again = body_with(&mesh, &law, Integration::Full);
    again.set_states(&saved).unwrap();
    let rule = ForceRule::Configuration { theta: 0.0 };
    let step = SolidStep { q_n: &q, q_np1: &q, rule };
    assert_eq!(force(&again, step).unwrap(), force(&body, step).unwrap());
    assert!(again.set_states(&states(&body_with(&mesh, &rubber(BULK), Integration::Full))).is_err());
    // Von Mises at the points: the yield stress over J, but for the back stress.
    let stresses: Vec<f64> =
        body.gauss_point_state(&q).unwrap().iter().flatten().map(|p| stoss_fe_solid::von_mises(&p.cauchy)).collect();
    assert!(stresses.iter().all(|s| *s > 430.0 && *s < 800.0), "{stresses:?}");
    // An elastic law has nothing of it.
    let elastic = body_with(&mesh, &laws()[1], Integration::Full);
    assert_eq!((elastic.step_end(&q), states(&elastic).len()), (Ok(None), 0));
}

/// An element that is stretched, sheared and bent along a path that never repeats, for 10^4 steps: the work of its forces is stored or lost, and no map loses its determinant.
#[test]
fn ten_thousand_steps_of_an_element_do_not_drift() {
    for (name, law) in materials() {
        let mesh = cells(&[CellKind::Hex8], [1, 1, 1], 0.0, 0.0, 0);
        let mut body = made(&mesh, &law, Integration::Full, true);
        let x = positions(&mesh);
        let at = |step: u32| {
            let t = 0.37 * f64::from(step);
            let (a, g) = (0.03 * t.sin(), 0.05 * (1.3 * t).cos() - 0.05);
            map_positions(&x, |x| {
                [x[0] * (1.0 + a) + g * x[1], x[1] * (1.0 - 0.4 * a) + 0.1 * g * x[0] * x[2], x[2] + 0.2 * a * x[0]]
            })
        };
        let mut q_n = at(0);
        body.begin_step(&q_n, ForceRule::DiscreteGradient, 1e-6).unwrap();
        let first = body.strain_energy(&q_n).unwrap();
        let (mut work, mut lost, mut worst) = (0.0, 0.0, 0.0_f64);
        for step in 1..=10_000 {
            let q_np1 = at(step);
            body.begin_step(&q_n, ForceRule::DiscreteGradient, 1e-6).unwrap();
            let f = force(&body, SolidStep { q_n: &q_n, q_np1: &q_np1, rule: ForceRule::DiscreteGradient }).unwrap();
            work += (0..f.len()).map(|i| f[i] * (q_np1[i] - q_n[i])).sum::<f64>();
            let end = body.step_end(&q_np1).unwrap().unwrap();
            body.end_step(&q_np1).unwrap();
            lost += end.loss.total();
            worst = worst.max((work - lost - (end.stored - first)).abs());
            q_n = q_np1;
        }
        // Beside what was lost, or beside the energy of such strains.
        assert!(worst < 1e-12 * lost.max(0.0025 * MU), "{name}: {worst:e} of {lost}");
        let len: usize = body.state_entries().iter().map(|entry| entry.len).sum();
        for state in states(&body).chunks(len) {
            let mut at = 0;
            for entry in body.state_entries() {
                if entry.name.contains("map") {
                    let det = stoss_continuum::SymmetricTensor2(std::array::from_fn(|i| state[at + i])).det();
                    assert!((det - 1.0).abs() < 1e-11, "{name}: {}: det G - 1 = {:e}", entry.name, det - 1.0);
                }
                at += entry.len;
            }
        }
    }
}
