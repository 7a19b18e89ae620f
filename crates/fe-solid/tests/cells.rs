//! What holds for every cell with each of its rules: derivatives, identities of a step, patch test, masses, recovery, points, threads.
use crate::common::*;
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_fe_solid::*;
use stoss_materials::NeoHooke;
use stoss_mesh::{BOUNDARY, Mesh};
use stoss_reference_element::{CellKind, Family, Integration};

const F: [[f64; 3]; 3] = [[1.15, 0.1, -0.05], [0.02, 0.9, 0.08], [0.1, -0.03, 1.05]];

fn affine(x: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| 0.3 + F[i][0] * x[0] + F[i][1] * x[1] + F[i][2] * x[2])
}

/// How far nodes may be moved without turning a cell inside out.
fn amplitude(kind: CellKind) -> f64 {
    match kind {
        CellKind::Hex8 | CellKind::Wedge6 | CellKind::Tet4 => 0.1,
        CellKind::Hex27 | CellKind::Hex20 | CellKind::Wedge15 => 0.03,
        CellKind::Tet10 => 0.02,
    }
}

fn one_cube(kind: CellKind, seed: u64) -> Mesh {
    cells(&[kind], [1, 1, 1], 0.1, 0.5 * amplitude(kind), seed)
}

#[test]
fn force_is_the_gradient_of_the_energy() {
    for (kind, integration) in CellKind::with_rules() {
        let mesh = one_cube(kind, 3);
        let q = Random(4).perturbed(&positions(&mesh), amplitude(kind));
        for law in laws() {
            let body = body_with(&mesh, &law, integration);
            let f = force(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT }).unwrap();
            for j in (0..q.len()).step_by(5) {
                let expected = derivative(&q, j, 1e-3, |q| vec![body.strain_energy(q).unwrap()])[0];
                assert!((f[j] - expected).abs() < 1e-7 * max_abs(&f), "{kind} {integration:?} {}", law.name());
            }
        }
    }
}

#[test]
fn tangents_match_differences_of_the_force() {
    for (kind, integration) in CellKind::with_rules() {
        let mesh = one_cube(kind, 5);
        let mut random = Random(6);
        let q_n = random.perturbed(&positions(&mesh), amplitude(kind));
        let q_np1 = random.perturbed(&q_n, amplitude(kind));
        for law in laws() {
            let mut body = body_with(&mesh, &law, integration);
            check_tangents(&mut body, &q_n, &q_np1, 1e-14, &format!("{kind} {integration:?} {}", law.name()));
        }
    }
}

#[test]
fn a_step_does_the_work_of_the_energy_and_keeps_the_momenta() {
    for (kind, integration) in CellKind::with_rules() {
        for seed in 0..4 {
            let mesh = one_cube(kind, seed);
            let mut random = Random(!seed);
            let q_n = random.perturbed(&positions(&mesh), amplitude(kind));
            let q_np1 = random.perturbed(&q_n, amplitude(kind));
            let mid: Vec<f64> = q_n.iter().zip(&q_np1).map(|(a, b)| 0.5 * (a + b)).collect();
            let increment: Vec<f64> = q_np1.iter().zip(&q_n).map(|(a, b)| a - b).collect();
            for law in laws() {
                let mut body = body_with(&mesh, &law, integration);
                body.begin_step(&q_n, ForceRule::DiscreteGradient, 1.0).unwrap();
                let step = SolidStep { q_n: &q_n, q_np1: &q_np1, rule: ForceRule::DiscreteGradient };
                let f = force(&body, step).unwrap();
                let (v_n, v_np1) = (body.strain_energy(&q_n).unwrap(), body.strain_energy(&q_np1).unwrap());
                let place = format!("{kind} {integration:?} {}", law.name());
                assert!((dot(&f, &increment) - (v_np1 - v_n)).abs() < 1e-13 * v_n.max(v_np1), "{place}");
                let total: f64 = f.iter().map(|f| f.abs()).sum();
                let (sum, moment) = resultant_and_moment(&mid, &f);
                assert!(max_abs(&sum).max(max_abs(&moment)) < 1e-14 * total, "{place}");
            }
        }
    }
}

/// Number of pivots above `1e-9` of the largest, by elimination with complete pivoting.
fn rank(mut a: Vec<Vec<f64>>) -> usize {
    let n = a.len();
    let mut largest = 0.0;
    for k in 0..n {
        let place = |a: &[Vec<f64>]| {
            let all = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
            all.max_by(|&(i, j), &(r, s)| a[i][j].abs().total_cmp(&a[r][s].abs()))
        };
        let (i, j) = place(&a).unwrap();
        a.swap(k, i);
        a.iter_mut().for_each(|row| row.swap(k, j));
        largest = f64::max(largest, a[k][k].abs());
        if a[k][k].abs() < 1e-9 * largest {
            return k;
        }
        let (above, below) = a.split_at_mut(k + 1);
        for row in below {
            let l = row[k] / above[k][k];
            row.iter_mut().zip(&above[k]).skip(k).for_each(|(x, r)| *x -= l * r);
        }
    }
    n
}

/// Rigid motions have no stiffness, everything else has, but for six modes of hex20 with its smaller rule.
#[test]
fn the_stiffness_of_one_element_has_its_rank() {
    for (kind, integration) in CellKind::with_rules() {
        let cube = one_cube(kind, 21);
        let nodes: Vec<[f64; 3]> = cube.elements[0].iter().map(|&n| cube.nodes[n as usize]).collect();
        let mut mesh = Mesh { nodes, ..Mesh::default() };
        mesh.elements.push(kind, &(0..mesh.nodes.len() as u32).collect::<Vec<_>>());
        let (x, law) = (positions(&mesh), &laws()[1]);
        let missing = if (kind, integration) == (CellKind::Hex20, Integration::Reduced) { 12 } else { 6 };
        for body in [body_with(&mesh, law, integration), mixed_body(&mesh, law, integration)] {
            let (_, k) = force_and_tangent(&body, SolidStep { q_n: &x, q_np1: &x, rule: ForceRule::END_POINT });
            assert_eq!(rank(k), x.len() - missing, "{kind} {integration:?} {:?}", body.options());
        }
    }
}

/// Kinds that fill a block together, with the amplitude that their straight and curved edges may be moved by.
fn patches() -> Vec<(Vec<CellKind>, Integration, f64)> {
    let one = |(kind, integration): (CellKind, Integration)| {
        // The smaller rules are exact for straight edges only.
        (vec![kind], integration, if integration == Integration::Full { 0.5 * amplitude(kind) } else { 0.0 })
    };
    let mut out: Vec<_> = CellKind::with_rules().map(one).collect();
    out.push((vec![CellKind::Hex8, CellKind::Wedge6], Integration::Full, 0.05));
    out.push((vec![CellKind::Wedge15, CellKind::Hex20, CellKind::Hex20], Integration::Full, 0.02));
    out
}

/// A linear field has one stress, nothing is out of balance inside, and the forces on the boundary are those of the loads' formulas.
#[test]
fn patch_test() {
    for (kinds, integration, curved) in patches() {
        let mesh = cells(&kinds, [2, 2, 2], 0.15, curved, 7);
        let q = map_positions(&positions(&mesh), affine);
        let facets: Vec<_> = mesh.facets_of(BOUNDARY).unwrap().iter().map(|facet| facet.nodes).collect();
        for law in laws() {
            let body = body_with(&mesh, &law, integration);
            let states = body.gauss_point_state(&q).unwrap();
            assert_eq!(states.len(), mesh.elements.len());
            let cauchy = states[0][0].cauchy;
            let place = format!("{kinds:?} {integration:?} {}", law.name());
            for state in states.iter().flatten() {
                for (a, b) in state.cauchy.iter().zip(&cauchy) {
                    assert!((a - b).abs() < 1e-12 * max_abs(&cauchy), "{place}");
                }
            }
            let nodal = body.nodal_cauchy_stress(&q).unwrap().means();
            for (a, b) in nodal.iter().flat_map(|stress| stress.iter().zip(&cauchy)) {
                assert!((a - b).abs() < 1e-12 * max_abs(&cauchy), "{place}");
            }
            // int N_I n da of the deformed boundary, by the dead pressure on it.
            let mut areas = vec![0.0; q.len()];
            dead_pressure(&facets, &q, -1.0, &mut areas).unwrap();
            let f = force(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT }).unwrap();
            let [xx, yy, zz, xy, yz, xz] = cauchy;
            for (f, n) in f.chunks_exact(3).zip(areas.chunks_exact(3)) {
                for (f, row) in f.iter().zip([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) {
                    assert!((f - dot(&row, n)).abs() < 1e-12 * max_abs(&cauchy), "{place}: {f} {}", dot(&row, n));
                }
            }
            assert!((body.volume() - 8.0).abs() < 1.0, "{place}");
        }
    }
}

#[test]
fn closed_surfaces_enclose_the_volume_of_the_elements() {
    for (kinds, integration, curved) in patches() {
        let mesh = cells(&kinds, [2, 1, 2], 0.15, curved, 9);
        let (x, body) = (positions(&mesh), body_with(&mesh, &laws()[0], integration));
        let facets: Vec<_> = mesh.facets_of(BOUNDARY).unwrap().iter().map(|facet| facet.nodes).collect();
        let mut areas = vec![0.0; x.len()];
        dead_pressure(&facets, &x, -1.0, &mut areas).unwrap();
        // Divergence theorem: sum_I X_I . int N_I n dA = int X . n dA = 3 V.
        assert!((dot(&x, &areas) / 3.0 - body.volume()).abs() < 1e-13 * body.volume(), "{kinds:?} {integration:?}");
        let (sum, moment) = resultant_and_moment(&x, &areas);
        assert!(max_abs(&sum) < 1e-14 * 10.0 && max_abs(&moment) < 1e-13 * 10.0, "{kinds:?}");
    }
}

#[test]
fn masses_of_cells_with_straight_edges() {
    // Of the mass: smallest and largest share of a node, row sums or Hinton, Rock and Zienkiewicz's.
    let shares = [
        (CellKind::Hex8, vec![(0, 0.125)]),
        (CellKind::Hex20, vec![(0, 7.0 / 248.0), (8, 16.0 / 248.0), (19, 16.0 / 248.0)]),
        (CellKind::Hex27, vec![(0, 1.0 / 216.0), (8, 4.0 / 216.0), (20, 16.0 / 216.0), (26, 64.0 / 216.0)]),
        (CellKind::Tet4, vec![(0, 0.25)]),
        (CellKind::Tet10, vec![(0, 1.0 / 36.0), (4, 4.0 / 27.0)]),
        (CellKind::Wedge6, vec![(0, 1.0 / 6.0)]),
        (CellKind::Wedge15, vec![(0, 1.0 / 34.0), (6, 8.0 / 102.0), (12, 12.0 / 102.0)]),
    ];
    for (kind, shares) in shares {
        let table = kind.table();
        // An affine image.
        let nodes: Vec<[f64; 3]> = table.nodes.iter().map(|&x| affine(x)).collect();
        let mesh = Mesh::new(nodes, vec![]).unwrap();
        let mut mesh = Mesh { ..mesh };
        mesh.elements.push(kind, &(0..table.nodes.len() as u32).collect::<Vec<_>>());
        let body = body(&mesh, &laws()[0]);
        let n = 3 * mesh.nodes.len();
        let density = 2.5;
        let mass = density * body.volume();
        let lumped = body.mass(density, MassKind::Lumped);
        let mut diagonal = vec![0.0; n];
        lumped.multiply_add(1.0, &vec![1.0; n], &mut diagonal);
        for (node, share) in shares {
            assert!(
                (diagonal[3 * node] - share * mass).abs() < 1e-12 * mass,
                "{kind} {node}: {}",
                diagonal[3 * node] / mass
            );
        }
        assert!(diagonal.iter().all(|&m| m > 0.0));
        assert!((lumped.total() - mass).abs() < 1e-13 * mass);

        // Momenta and energy of a spin: the integrals of an affine field, exact with the consistent mass.
        let consistent = body.mass(density, MassKind::Consistent);
        let (w, v0) = ([0.7, -1.3, 0.9], [0.3, 0.2, -0.5]);
        let v = map_positions(&positions(&mesh), |x| {
            std::array::from_fn(|i| v0[i] + w[(i + 1) % 3] * x[(i + 2) % 3] - w[(i + 2) % 3] * x[(i + 1) % 3])
        });
        // Moments of the reference cell: int 1, int xi_a, int xi_a xi_b, by the rule of another cell of the family.
        let rule = match table.family {
            Family::Hexahedron => CellKind::Hex27,
            Family::Tetrahedron => CellKind::Tet10,
            Family::Wedge => CellKind::Wedge15,
        };
        let rule = rule.table().mass;
        let volume: f64 = rule.iter().map(|(_, weight)| weight).sum();
        let mut energy = 0.0;
        let (mut linear, mut angular) = ([0.0; 3], [0.0; 3]);
        for (xi, weight) in rule {
            let x = affine(*xi);
            let v: [f64; 3] =
                std::array::from_fn(|i| v0[i] + w[(i + 1) % 3] * x[(i + 2) % 3] - w[(i + 2) % 3] * x[(i + 1) % 3]);
            let m = mass * weight / volume;
            energy += 0.5 * m * dot(&v, &v);
            for i in 0..3 {
                linear[i] += m * v[i];
                angular[i] += m * (x[(i + 1) % 3] * v[(i + 2) % 3] - x[(i + 2) % 3] * v[(i + 1) % 3]);
            }
        }
        assert!((consistent.kinetic_energy(&v) - energy).abs() < 1e-13 * energy, "{kind}");
        let (l, j) = (consistent.linear_momentum(&v), consistent.angular_momentum(&positions(&mesh), &v));
        for i in 0..3 {
            assert!((l[i] - linear[i]).abs() < 1e-13 * mass && (j[i] - angular[i]).abs() < 1e-12 * mass, "{kind}");
        }
        // The weight, against the row sums of the mass.
        let (mut weight, mut rows) = (vec![0.0; n], vec![0.0; n]);
        body.body_force([1.0, 1.0, 1.0], &mut weight).unwrap();
        consistent.multiply_add(1.0 / density, &vec![1.0; n], &mut rows);
        assert!(weight.iter().zip(&rows).all(|(a, b)| (a - b).abs() < 1e-14 * body.volume()), "{kind}");
    }
}

#[test]
fn lumped_masses_of_distorted_cells_are_positive_and_have_their_mass() {
    for (kinds, integration, curved) in patches() {
        let mesh = cells(&kinds, [2, 2, 1], 0.2, 1.5 * curved, 11);
        let body = body_with(&mesh, &laws()[0], integration);
        let n = 3 * mesh.nodes.len();
        let mut diagonal = vec![0.0; n];
        let lumped = body.mass(3.0, MassKind::Lumped);
        lumped.multiply_add(1.0, &vec![1.0; n], &mut diagonal);
        assert!(diagonal.iter().all(|&m| m > 0.0), "{kinds:?}");
        let consistent = body.mass(3.0, MassKind::Consistent);
        assert!((lumped.total() - consistent.total()).abs() < 1e-13 * consistent.total());
        // The entries in a global matrix are those of the products.
        let (pattern, map) = pattern(&body, n);
        for mass in [&lumped, &consistent] {
            let mut values = vec![0.0; pattern.nnz()];
            let target = TangentTarget { map: &map, first_stencil: 0, factor: 0.5, values: &mut values };
            mass.add_to_tangent(2.0, target);
            let x = Random(5).perturbed(&vec![0.0; n], 1.0);
            let mut expected = vec![0.0; n];
            mass.multiply_add(1.0, &x, &mut expected);
            for (row, expected) in dense(&pattern, &values).iter().zip(expected) {
                assert!((dot(row, &x) - expected).abs() < 1e-13, "{kinds:?}");
            }
        }
    }
}

/// A quadratic map has a linear F, which the recovery of quadratic cells with straight edges finds at every node. Each term of the map is small, so that F is
/// positive.
#[test]
fn recovery_of_a_linear_field_is_exact() {
    for (kind, integration) in CellKind::with_rules().filter(|(kind, _)| kind.is_quadratic()) {
        // Parallelepipeds: natural coordinates are linear in places.
        let mesh = cells(&[kind], [2, 1, 1], if kind == CellKind::Tet10 { 0.2 } else { 0.0 }, 0.0, 3);
        let map = |x: [f64; 3]| {
            [
                x[0] + 0.1 * x[0] * x[1] - 0.03 * x[2] * x[2],
                x[1] + 0.05 * x[0] * x[0],
                x[2] + 0.04 * x[1] * x[2] - 0.1 * x[0],
            ]
        };
        let gradient = |x: [f64; 3]| {
            [1.0 + 0.1 * x[1], 0.1 * x[0], -0.06 * x[2], 0.1 * x[0], 1.0, 0.0, -0.1, 0.04 * x[2], 1.0 + 0.04 * x[1]]
        };
        let body = body_with(&mesh, &laws()[0], integration);
        let found = body.nodal_deformation_gradient(&map_positions(&positions(&mesh), map)).unwrap().means();
        for (found, &x) in found.iter().zip(&mesh.nodes) {
            for (a, b) in found.iter().zip(gradient(x)) {
                assert!((a - b).abs() < 1e-13, "{kind} {integration:?}: {a} {b}");
            }
        }
    }
}

/// Points with known natural coordinates, and the deformation gradient there against differences of the interpolation.
#[test]
fn points_are_found_and_their_gradient_is_that_of_the_interpolation() {
    for (kind, integration) in CellKind::with_rules() {
        let mesh = one_cube(kind, 13);
        let table = kind.table();
        let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::from_young_poisson(1.0, 0.3).unwrap());
        let body = body_with(&mesh, &law, integration);
        let x = positions(&mesh);
        let q: Vec<f64> = x.iter().enumerate().map(|(i, x)| 1.1 * x + 0.02 * (i as f64).sin()).collect();
        for (element, nodes) in mesh.elements.iter().enumerate() {
            let interpolate = |values: &[f64], xi: [f64; 3]| -> [f64; 3] {
                let shape = (table.shape)(xi);
                std::array::from_fn(|i| nodes.iter().zip(shape).map(|(&k, n)| n * values[3 * k as usize + i]).sum())
            };
            let centre = table.family.centre();
            let inside =
                table.nodes.iter().map(|node| std::array::from_fn(|a| centre[a] + 0.7 * (node[a] - centre[a])));
            for natural in inside {
                let point = body.material_point(&x, interpolate(&x, natural)).unwrap();
                assert_eq!(point.element, element, "{kind}");
                assert!((0..3).all(|i| (point.natural[i] - natural[i]).abs() < 1e-9), "{kind} {point:?}");
                let state = body.state_at(&point, &q).unwrap();
                let h = 1e-5;
                for a in 0..3 {
                    // F (dX/dxi) = dq/dxi
                    let along = |values: &[f64]| -> [f64; 3] {
                        let at = |s: f64| {
                            interpolate(values, std::array::from_fn(|k| natural[k] + if k == a { s } else { 0.0 }))
                        };
                        let (plus, minus) = (at(h), at(-h));
                        std::array::from_fn(|i| (plus[i] - minus[i]) / (2.0 * h))
                    };
                    let (dx, dq) = (along(&x), along(&q));
                    for i in 0..3 {
                        assert!((dot(&state.deformation_gradient[i], &dx) - dq[i]).abs() < 1e-9, "{kind}");
                    }
                }
            }
        }
        for corner in 0..table.corners {
            let node = 3 * mesh.elements[0][corner] as usize;
            assert!(body.material_point(&x, [x[node], x[node + 1], x[node + 2]]).is_some(), "{kind} {corner}");
        }
        for outside in [[3.0, 0.5, 0.5], [-0.4, 0.1, 0.5], [0.5, 0.5, 1.3]] {
            assert_eq!(body.material_point(&x, outside), None, "{kind}");
        }
    }
}

#[test]
fn a_corner_that_is_pushed_through_its_element_is_found() {
    for (kind, integration) in CellKind::with_rules().filter(|(kind, _)| !matches!(kind, CellKind::Tet4)) {
        let mesh = cells(&[kind], [1, 1, 1], 0.0, 0.0, 0);
        let body = body_with(&mesh, &laws()[1], integration);
        let x = positions(&mesh);
        assert_eq!(body.inside_out(&x).unwrap(), None);
        let (corner, mut q) = (mesh.elements[0][0] as usize, x.clone());
        let centre = mesh.elements[0][..kind.table().corners].iter().fold([0.0; 3], |sum, &n| {
            std::array::from_fn(|i| sum[i] + x[3 * n as usize + i] / kind.table().corners as f64)
        });
        // Quadratic cells: a third of the way already turns the corner, its edges' middles stay.
        let way = if kind.is_quadratic() { 0.45 } else { 0.9 };
        for i in 0..3 {
            q[3 * corner + i] += way * (centre[i] - q[3 * corner + i]);
        }
        let found = body.inside_out(&q).unwrap().expect("a corner is turned");
        assert!(found.count >= 1 && found.relative_volume < 0.0, "{kind} {found:?}");
        assert_eq!(mesh.elements[found.element][found.node] as usize, corner, "{kind} {found:?}");
    }
}

#[test]
fn tet10_sees_its_corners_with_the_full_rule_only() {
    let mesh = cells(&[CellKind::Tet10], [1, 1, 1], 0.0, 0.0, 0);
    let x = positions(&mesh);
    let mut q = x.clone();
    // A corner more than a third of the way to the other end of an edge whose middle stays: det F < 0 there.
    let [a, b] = [0, 1].map(|k| 3 * mesh.elements[0][k] as usize);
    for i in 0..3 {
        q[a + i] += 0.35 * (x[b + i] - x[a + i]);
    }
    let step = SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT };
    let full = body_with(&mesh, &laws()[1], Integration::Full);
    assert!(matches!(force(&full, step), Err(SolidError::InvertedElement { gauss_point: 0, .. })));
    assert!(full.inside_out(&q).unwrap().is_some());
    let reduced = body_with(&mesh, &laws()[1], Integration::Reduced);
    assert!(force(&reduced, step).is_ok());
    assert!(reduced.inside_out(&q).unwrap().is_some());
}

#[test]
fn elements_are_numbered_in_the_order_of_the_mesh_and_named_in_errors() {
    let mesh = cells(&[CellKind::Hex8, CellKind::Wedge6], [4, 1, 1], 0.0, 0.0, 0);
    assert_eq!((mesh.elements.len(), mesh.elements.blocks().len()), (6, 4));
    let body = SolidBody::new("body", &mesh, 7, laws()[1].clone()).unwrap();
    assert_eq!((body.element_count(), body.node_offset(), body.node_count()), (6, 7, mesh.nodes.len()));
    for element in 0..6 {
        assert!(
            body.elements()[element].iter().eq(mesh.elements[element].iter().map(|n| n + 7).collect::<Vec<_>>().iter())
        );
    }
    // The last cube (elements 4 and 5) is stretched over itself.
    let mut q = vec![0.0; 21];
    q.extend(positions(&mesh));
    for x in q[21..].chunks_exact_mut(3).filter(|x| x[0] > 3.5) {
        x[0] = 2.5;
    }
    let rule = ForceRule::END_POINT;
    let found = force(&body, SolidStep { q_n: &q, q_np1: &q, rule });
    assert!(matches!(found, Err(SolidError::InvertedElement { element: 4, gauss_point: 0, .. })), "{found:?}");
    assert!(matches!(body.strain_energy(&q), Err(SolidError::InvertedElement { element: 4, .. })));
    assert_eq!(body.inside_out(&q).unwrap().map(|found| found.count), Some(2));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for kinds in [vec![CellKind::Hex8, CellKind::Hex8, CellKind::Wedge6], vec![CellKind::Hex27], vec![CellKind::Tet10]]
    {
        let mesh = cells(&kinds, [4, 3, 3], 0.1, 0.02, 1);
        let mut random = Random(2);
        let q_n = random.perturbed(&positions(&mesh), 0.02);
        let q_np1 = random.perturbed(&q_n, 0.02);
        let mut body = body(&mesh, &laws()[1]);
        let (pattern, map) = pattern(&body, q_n.len());
        let rate = ViscousRate { q: &q_n, v: &q_np1, factor: 0.1, slopes: [0.5, 2.0] };
        for rule in [ForceRule::END_POINT, ForceRule::DiscreteGradient] {
            let mut results = Vec::new();
            for threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut workspace = Workspace::default();
                pool.install(|| {
                    body.begin_step(&q_n, rule, 1.0).unwrap();
                    for _ in 0..2 {
                        let (mut force, mut values) = (vec![0.0; q_n.len()], vec![0.0; pattern.nnz()]);
                        let target = TangentTarget { map: &map, first_stencil: 0, factor: 0.7, values: &mut values };
                        let step = SolidStep { q_n: &q_n, q_np1: &q_np1, rule };
                        body.assemble(step, 1.3, &mut force, Some(target), &mut workspace).unwrap();
                        let target = TangentTarget { map: &map, first_stencil: 0, factor: 0.7, values: &mut values };
                        body.add_viscous_force(rate, &mut force, Some(target)).unwrap();
                        let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
                        results.push((bits(&force), bits(&values)));
                    }
                });
            }
            assert!(results.windows(2).all(|pair| pair[0] == pair[1]), "{kinds:?} {rule:?}");
        }
    }
}

#[test]
fn viscous_forces_of_all_cells() {
    for (kind, integration) in CellKind::with_rules() {
        let mesh = one_cube(kind, 17);
        let mut random = Random(18);
        let q_n = random.perturbed(&positions(&mesh), amplitude(kind));
        let q = random.perturbed(&q_n, amplitude(kind));
        let body = body_with(&mesh, &laws()[1], integration);
        let (pattern, map) = pattern(&body, q.len());
        let at = |q: &[f64], values: Option<&mut [f64]>| {
            let v: Vec<f64> = q.iter().zip(&q_n).map(|(a, b)| 4.0 * (a - b)).collect();
            let rate = ViscousRate { q, v: &v, factor: 0.3, slopes: [1.0, 4.0] };
            let target = values.map(|values| TangentTarget { map: &map, first_stencil: 0, factor: 1.0, values });
            let mut force = vec![0.0; q.len()];
            body.add_viscous_force(rate, &mut force, target).unwrap();
            assert!(dot(&force, &v) > 0.0);
            force
        };
        let mut values = vec![0.0; pattern.nnz()];
        at(&q, Some(&mut values));
        let tangent = dense(&pattern, &values);
        let scale = tangent.iter().map(|row| max_abs(row)).fold(0.0, f64::max);
        for j in (0..q.len()).step_by(7) {
            let column = derivative(&q, j, 1e-3, |q| at(q, None));
            assert!((0..q.len()).all(|i| (tangent[i][j] - column[i]).abs() < 1e-10 * scale), "{kind} {integration:?}");
        }
    }
}
