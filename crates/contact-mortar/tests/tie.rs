//! Mesh ties: tangents, resultant and moment of the forces, work, invariance, supports, moved interfaces.

use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use stoss_contact::FacetNodes;
use stoss_contact_mortar::tie::{Interface, MeshTie, TieForm, TieOptions};
use stoss_contact_mortar::{MortarError, MultiplierSpace};
use stoss_term::{GradientRule, Rule, StepConfiguration, Term};
use stoss_testkit::meshes::{Mesh, meshes};

/// Facets of an `n x n` grid over `[-1, 1]^2`; seen from `up`, outward.
fn grid(n: usize, first: u32, up: bool, place: impl Fn(f64, f64) -> [f64; 3]) -> (Vec<[u32; 4]>, Vec<f64>) {
    let mut x = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            x.extend(place(2.0 * i as f64 / n as f64 - 1.0, 2.0 * j as f64 / n as f64 - 1.0));
        }
    }
    let mut facets = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let (k, row) = (first + (j * (n + 1) + i) as u32, n as u32 + 1);
            facets.push(if up { [k, k + 1, k + row + 1, k + row] } else { [k, k + row, k + row + 1, k + 1] });
        }
    }
    (facets, x)
}

struct Pair {
    slave: Vec<FacetNodes>,
    master: Vec<FacetNodes>,
    x: Vec<f64>,
}

/// Slave `n x n` below, master `m x m` above.
fn pair(meshes: [Mesh; 2], n: usize, m: usize, place: impl Fn(f64, f64) -> [f64; 3]) -> Pair {
    let (slave, mut x) = grid(n, 0, true, &place);
    let (master, above) = grid(m, (x.len() / 3) as u32, false, &place);
    x.extend(above);
    Pair { slave: meshes[0].of(&slave), master: meshes[1].of(&master), x }
}

fn flat(x: f64, y: f64) -> [f64; 3] {
    [x, y, 0.0]
}

/// Part of a cylinder: the two polyhedra do not fit.
fn cylinder(x: f64, y: f64) -> [f64; 3] {
    [2.0 * (0.5 * x).sin(), y, 2.0 * (0.5 * x).cos()]
}

impl Pair {
    fn tie(&self, options: TieOptions) -> MeshTie {
        MeshTie::new("tie", &self.slave, &self.master, &self.x, |_| false, options).unwrap()
    }
}

const FORMS: [TieForm; 2] = [TieForm::Constant, TieForm::FrameInvariant];
const SPACES: [MultiplierSpace; 2] = [MultiplierSpace::Standard, MultiplierSpace::Dual];
/// Nodal forces, constraint rows `-Phi`, and the dense tangent, all as the solver adds them up.
struct Assembled {
    residual: Vec<f64>,
    tangent: Vec<f64>,
}

fn assemble(tie: &MeshTie, step: StepConfiguration<'_>, lambda: &[f64]) -> Assembled {
    let (n, slots) = (step.q_n.len(), tie.slot_count());
    let dim = n + slots;
    let mut out = Assembled { residual: vec![0.0; dim], tangent: vec![0.0; dim * dim] };
    let mut visited = Vec::new();
    tie.assemble(&step.at(lambda, &vec![true; slots]), true, &mut |local| {
        let at: Vec<usize> = local
            .nodes
            .iter()
            .flat_map(|&node| (0..3).map(move |i| 3 * node as usize + i))
            .chain(local.slots.iter().map(|&s| n + s as usize))
            .collect();
        for (i, &row) in at.iter().enumerate() {
            out.residual[row] += local.residual[i];
            for (j, &column) in at.iter().enumerate() {
                out.tangent[row * dim + column] += local.tangent[i * at.len() + j];
            }
        }
        visited.push((local.nodes.clone(), local.slots.clone()));
    })
    .unwrap();
    let mut stencils = Vec::new();
    tie.stencils(&vec![true; slots], &mut |nodes, slots| stencils.push((nodes.to_vec(), slots.to_vec())));
    assert_eq!(stencils, visited, "the pattern is that of the contributions");
    out
}

fn values(tie: &MeshTie, q: &[f64]) -> Vec<f64> {
    let step = StepConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
    let a = assemble(tie, step, &vec![0.0; tie.slot_count()]);
    a.residual[q.len()..].iter().map(|r| -r).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn at(q: &[f64], node: usize) -> Vector3<f64> {
    Vector3::new(q[3 * node], q[3 * node + 1], q[3 * node + 2])
}

fn moment(q: &[f64], f: &[f64]) -> Vector3<f64> {
    (0..q.len() / 3).map(|k| at(q, k).cross(&at(f, k))).sum()
}

fn turned(q: &[f64], rotation: &Rotation3<f64>, shift: Vector3<f64>) -> Vec<f64> {
    (0..q.len() / 3).flat_map(|k| <[f64; 3]>::from(rotation * at(q, k) + shift)).collect()
}

fn shaken(x: &[f64], by: &[f64], size: f64) -> Vec<f64> {
    x.iter().zip(by.iter().cycle()).map(|(x, d)| x + size * d).collect()
}

fn numbers() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0f64..1.0, 83)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn tangents_are_the_derivatives(
        meshes in meshes(), d in numbers(), e in numbers(), l in numbers(), n in 1usize..3, m in 1usize..3, space in 0usize..2,
    ) {
        let p = pair(meshes, n, m, cylinder);
        for form in FORMS {
            let options = TieOptions { form, space: SPACES[space], interface: Interface::Keep, ..Default::default() };
            let tie = p.tie(options);
            let (q_n, q_np1) = (shaken(&p.x, &d, 0.2), shaken(&p.x, &e, 0.2));
            let lambda: Vec<f64> = l.iter().cycle().take(tie.slot_count()).copied().collect();
            for rule in GradientRule::ALL {
                let exact = assemble(&tie, StepConfiguration { q_n: &q_n, q_np1: &q_np1, rule }, &lambda);
                let dim = q_n.len() + lambda.len();
                prop_assert!(tie.is_symmetric(Rule::Constraint(rule)) || rule != GradientRule::EndPoint);
                if tie.is_symmetric(Rule::Constraint(rule)) {
                    let k = &exact.tangent;
                    let asymmetry = (0..dim * dim).fold(0f64, |m, e| m.max((k[e] - k[e % dim * dim + e / dim]).abs()));
                    prop_assert!(asymmetry <= 1e-13 * norm(k), "{form:?} {rule:?}: {asymmetry:e}");
                }
                let residual_at = |column: usize, h: f64| {
                    let (mut q, mut p) = (q_np1.clone(), lambda.clone());
                    if column < q.len() { q[column] += h } else { p[column - q_n.len()] += h }
                    assemble(&tie, StepConfiguration { q_n: &q_n, q_np1: &q, rule }, &p).residual
                };
                let h = 1e-4;
                let scale = norm(&exact.tangent) / (dim as f64).sqrt();
                // A column of each kind of unknown, others with other cases.
                for column in [d.len() * n % q_n.len(), 3 * (n + 1) * (n + 1) + m, q_n.len() + (n + m) % lambda.len(), 1] {
                    // Of fourth order: what is left is round-off.
                    let (a, b, c, e) =
                        (residual_at(column, h), residual_at(column, -h), residual_at(column, 2.0 * h), residual_at(column, -2.0 * h));
                    for row in 0..dim {
                        let numerical = (8.0 * (a[row] - b[row]) - (c[row] - e[row])) / (12.0 * h);
                        let error = (numerical - exact.tangent[row * dim + column]).abs();
                        prop_assert!(error < 1e-9 * scale, "{form:?} {rule:?} ({row}, {column}): {error:e} of {scale:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn forces_have_no_resultant_and_in_the_invariant_form_no_moment(meshes in meshes(), d in numbers(), e in numbers(), l in numbers()) {
        let p = pair(meshes, 3, 2, cylinder);
        let (q_n, q_np1) = (shaken(&p.x, &d, 0.2), shaken(&p.x, &e, 0.2));
        let mid: Vec<f64> = q_n.iter().zip(&q_np1).map(|(a, b)| 0.5 * (a + b)).collect();
        for form in FORMS {
            for space in SPACES {
                let tie = p.tie(TieOptions { form, space, interface: Interface::Keep, ..Default::default() });
                let lambda: Vec<f64> = l.iter().cycle().take(tie.slot_count()).copied().collect();
                for (rule, about) in [
                    (GradientRule::StartPoint, &q_n),
                    (GradientRule::EndPoint, &q_np1),
                    (GradientRule::Midpoint, &mid),
                    (GradientRule::DiscreteGradient, &mid),
                ] {
                    let a = assemble(&tie, StepConfiguration { q_n: &q_n, q_np1: &q_np1, rule }, &lambda);
                    let force = &a.residual[..q_n.len()];
                    let resultant: Vector3<f64> = (0..q_n.len() / 3).map(|k| at(force, k)).sum();
                    let scale = norm(force);
                    prop_assert!(resultant.norm() < 1e-12 * scale, "{form:?} {rule:?} {:e}", resultant.norm());
                    let defect = moment(about, force);
                    if form == TieForm::FrameInvariant {
                        prop_assert!(defect.norm() < 1e-12 * scale, "{rule:?} {:e}", defect.norm());
                    } else {
                        // The known defect: sum of gap vector x traction, less the target in the row.
                        let zero = vec![0.0; lambda.len()];
                        let step = StepConfiguration { q_n: about, q_np1: about, rule: GradientRule::EndPoint };
                        let closing = p.tie(TieOptions { form, space, interface: Interface::Close, ..Default::default() });
                        let rows = assemble(&closing, step, &zero).residual;
                        let known: Vector3<f64> = (0..lambda.len() / 3)
                            .map(|s| at(&rows[q_n.len()..], s).cross(&at(&lambda, s)))
                            .sum();
                        prop_assert!((defect - known).norm() < 1e-12 * scale, "{:e}", (defect - known).norm());
                    }
                }
            }
        }
    }

    #[test]
    fn released_slots_contribute_nothing(meshes in meshes(), d in numbers(), l in numbers(), keep in 0u32..7) {
        let p = pair(meshes, 2, 3, cylinder);
        let q = shaken(&p.x, &d, 0.3);
        for form in FORMS {
            let tie = p.tie(TieOptions { form, interface: Interface::Keep, ..Default::default() });
            let lambda: Vec<f64> = l.iter().cycle().take(tie.slot_count()).copied().collect();
            let step = StepConfiguration { q_n: &p.x, q_np1: &q, rule: GradientRule::DiscreteGradient };
            let of_node: Vec<u32> = tie.report(&q).unwrap().iter().map(|slot| slot.node).collect();
            let active: Vec<bool> = of_node.iter().map(|node| node % 7 == keep).collect();
            let mut all = Vec::new();
            tie.assemble(&step.at(&lambda, &vec![true; active.len()]), true, &mut |local| all.push(format!("{local:?}"))).unwrap();
            let (mut kept, mut stencils, mut expected) = (Vec::new(), 0, 0);
            tie.assemble(&step.at(&lambda, &active), true, &mut |local| {
                assert!(local.slots.iter().all(|&slot| active[slot as usize]));
                kept.push(format!("{local:?}"));
            }).unwrap();
            tie.stencils(&active, &mut |_, slots| stencils += usize::from(slots.iter().all(|&slot| active[slot as usize])));
            tie.stencils(&vec![true; active.len()], &mut |_, slots| expected += usize::from(active[slots[0] as usize]));
            prop_assert_eq!((kept.len(), stencils), (expected, expected));
            prop_assert!(kept.iter().all(|local| all.contains(local)));
        }
    }

    #[test]
    fn discrete_gradients_do_exact_work(meshes in meshes(), d in numbers(), e in numbers(), l in numbers()) {
        let p = pair(meshes, 2, 3, cylinder);
        let (q_n, q_np1) = (shaken(&p.x, &d, 0.3), shaken(&p.x, &e, 0.3));
        for form in FORMS {
            let tie = p.tie(TieOptions { form, interface: Interface::Keep, ..Default::default() });
            let lambda: Vec<f64> = l.iter().cycle().take(tie.slot_count()).copied().collect();
            let step = StepConfiguration { q_n: &q_n, q_np1: &q_np1, rule: GradientRule::DiscreteGradient };
            let a = assemble(&tie, step, &lambda);
            let work: f64 = (0..q_n.len()).map(|k| -a.residual[k] * (q_np1[k] - q_n[k])).sum();
            let (before, after) = (values(&tie, &q_n), values(&tie, &q_np1));
            let change: f64 = (0..lambda.len()).map(|s| lambda[s] * (after[s] - before[s])).sum();
            let scale = norm(&lambda) * (norm(&before) + norm(&after)) + norm(&a.residual[..q_n.len()]);
            prop_assert!((work - change).abs() < 1e-12 * scale, "{form:?}: {work} {change}");
        }
    }

    #[test]
    fn a_kept_offset_turns_with_the_bodies_in_the_invariant_form(
        meshes in meshes(), axis in prop::array::uniform3(-1.0f64..1.0), angle in 0.1f64..3.0, shift in prop::array::uniform3(-5.0f64..5.0),
    ) {
        prop_assume!(norm(&axis) > 0.1);
        let p = pair(meshes, 3, 2, cylinder);
        let rotation = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(Vector3::from(axis)), angle);
        let q = turned(&p.x, &rotation, Vector3::from(shift));
        let of = |form| p.tie(TieOptions { form, interface: Interface::Keep, ..Default::default() });
        let tie = of(TieForm::FrameInvariant);
        let offset = tie.largest_initial_gap();
        prop_assert!(offset > 0.01, "the polyhedra do not fit: {offset}");
        prop_assert!(norm(&values(&tie, &q)) < 1e-13);
        // The constant form resists: its values are those of the offset's rotation.
        prop_assert!(norm(&values(&of(TieForm::Constant), &q)) > 1e-3 * offset * angle.sin().abs());
        // Moved, the gap is zero and both forms turn freely.
        for form in FORMS {
            let tie = p.tie(TieOptions { form, ..Default::default() });
            let mut x = p.x.clone();
            for (node, place) in tie.moved() {
                x[3 * *node as usize..3 * *node as usize + 3].copy_from_slice(place);
            }
            prop_assert!(norm(&values(&tie, &x)) < 1e-13);
            prop_assert!(norm(&values(&tie, &turned(&x, &rotation, Vector3::from(shift)))) < 1e-12);
        }
    }
}

/// `int N_J dA` of every node of parallelograms and triangles.
fn tributary(facets: &[FacetNodes], x: &[f64]) -> Vec<f64> {
    let mut areas = vec![0.0; x.len() / 3];
    for facet in facets {
        let [o, a, b] = [0, 1, facet.len() - 1].map(|k| at(x, facet[k] as usize));
        let share = if facet.len() == 3 { 1.0 / 6.0 } else { 0.25 };
        facet.iter().for_each(|&n| areas[n as usize] += share * (a - o).cross(&(b - o)).norm());
    }
    areas
}

#[test]
fn uniform_tractions_are_in_the_space_with_supports_too() {
    // Components x of one edge are prescribed, and one whole corner. The rest of the slave must feel a uniform traction,
    // and the master all of it, as if nothing were prescribed.
    let (n, m) = (4, 3);
    let fixed = |c: usize| (c.is_multiple_of(3) && (c / 3) <= n) || c / 3 == (n + 1) * (n + 1) - 1;
    for (meshes, space) in Mesh::PAIRS.into_iter().flat_map(|m| SPACES.map(|s| (m, s))) {
        let p = pair(meshes, n, m, flat);
        let areas = [tributary(&p.slave, &p.x), tributary(&p.master, &p.x)];
        for form in FORMS {
            let options = TieOptions { form, space, ..Default::default() };
            let tie = MeshTie::new("tie", &p.slave, &p.master, &p.x, fixed, options).unwrap();
            assert!(tie.moved().is_empty());
            let count = (n + 1) * (n + 1);
            assert_eq!(tie.slot_count(), 3 * count - (n + 1) - 3);
            assert_eq!(tie.tied_nodes().len(), count - 1);
            // Multipliers whose traction is (0.3, -0.2, 0.7): with spatial axes they are the components, otherwise those
            // along the frame, whose first axis is any: read the map off the tractions.
            let t = [0.3, -0.2, 0.7];
            let mut lambda = vec![0.0; tie.slot_count()];
            let unit: Vec<Vec<[f64; 3]>> = (0..lambda.len())
                .map(|s| {
                    let mut l = lambda.clone();
                    l[s] = 1.0;
                    tie.tractions(&p.x, &l)
                })
                .collect();
            for (s, unit) in unit.iter().enumerate() {
                // Frames are orthonormal in a plane reference.
                let axis = unit.iter().find(|a| norm(&a[..]) > 0.5).unwrap();
                assert!((norm(axis) - 1.0).abs() < 1e-13);
                lambda[s] = (0..3).map(|i| axis[i] * t[i]).sum();
            }
            let step = StepConfiguration { q_n: &p.x, q_np1: &p.x, rule: GradientRule::EndPoint };
            let a = assemble(&tie, step, &lambda);
            for (sign, areas) in [1.0, -1.0].into_iter().zip(&areas) {
                for (node, area) in areas.iter().enumerate().filter(|(_, area)| **area > 0.0) {
                    for c in 0..3 {
                        let (expected, found) = (sign * t[c] * area, -a.residual[3 * node + c]);
                        assert!((found - expected).abs() < 1e-14, "{space:?} {form:?} {node} {c}: {found} {expected}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_moved_interface_closes_and_the_motion_falls_with_the_mesh() {
    let mut last = f64::INFINITY;
    for (meshes, k) in Mesh::PAIRS.into_iter().flat_map(|m| [1, 2, 4].map(|k| (m, k))) {
        if k == 1 {
            last = f64::INFINITY;
        }
        for space in SPACES {
            let p = pair(meshes, 3 * k, 2 * k, cylinder);
            let tie = p.tie(TieOptions { space, ..Default::default() });
            assert_eq!(tie.moved().len(), (3 * k + 1) * (3 * k + 1));
            let mut farthest = 0.0_f64;
            for (node, x) in tie.moved() {
                farthest = farthest.max((Vector3::from(*x) - at(&p.x, *node as usize)).norm());
            }
            // The sagitta of a master facet is h^2 / 8 r with h = 2 / (2 k), r = 2, and the slave's is less.
            let sagitta = 1.0 / (16.0 * (k * k) as f64);
            assert!(farthest > 0.2 * sagitta && farthest < 3.0 * sagitta, "{farthest} {sagitta}");
            if space == MultiplierSpace::Standard {
                assert!(farthest < 0.4 * last);
                last = farthest;
            }
        }
    }
}

#[test]
fn what_cannot_be_tied_is_named() {
    let p = pair(Mesh::PAIRS[3], 2, 3, flat);
    let all = MeshTie::new("tie", &p.slave, &p.master, &p.x, |c| c < 27, TieOptions::default());
    assert!(matches!(all, Err(MortarError::AllFixed)));
    let mut far = p.x.clone();
    far[27..].iter_mut().skip(2).step_by(3).for_each(|z| *z = 3.0);
    let apart = MeshTie::new("tie", &p.slave, &p.master, &far, |_| false, TieOptions::default());
    assert!(matches!(apart, Err(MortarError::Apart { .. })));
    let reached = TieOptions { reach: Some(4.0), interface: Interface::Keep, ..TieOptions::default() };
    let tie = MeshTie::new("tie", &p.slave, &p.master, &far, |_| false, reached).unwrap();
    assert!((tie.largest_initial_gap() - 3.0).abs() < 1e-12 && (tie.tied_area() - 4.0).abs() < 1e-12);
    assert!((tie.tied_share() - 1.0).abs() < 1e-12);
    let shared = MeshTie::new("tie", &p.slave, &p.slave, &p.x, |_| false, TieOptions::default());
    assert!(matches!(shared, Err(MortarError::Surface(_))));
}
