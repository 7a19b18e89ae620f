//! The battery of all cells and faces: Kronecker property, completeness, gradients against differences, faces that are outward and close the cell
//! and have its shape functions, rules to their degree, rank of the stiffness, permutations.

use proptest::prelude::*;
use std::collections::BTreeMap;
use stoss_reference_element::{CellKind, FaceKind, Family, Integration, QuadratureRule, hex8, quadrature};

/// Monomials of total degree up to 1 or 2.
fn monomials(quadratic: bool, x: [f64; 3]) -> Vec<f64> {
    let [x, y, z] = x;
    let mut out = vec![1.0, x, y, z];
    if quadratic {
        out.extend([x * x, y * y, z * z, x * y, y * z, x * z]);
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn cells_are_complete_and_their_gradients_are_differences(xi in prop::array::uniform3(-1.1..1.1f64)) {
        for kind in CellKind::ALL {
            let table = kind.table();
            let (n, dn) = ((table.shape)(xi), (table.shape_gradient)(xi));
            prop_assert!(n[kind.node_count()..].iter().all(|n| *n == 0.0));
            let exact = monomials(kind.is_quadratic(), xi);
            let mut sum = vec![0.0; exact.len()];
            for (node, n) in table.nodes.iter().zip(n) {
                for (s, m) in sum.iter_mut().zip(monomials(kind.is_quadratic(), *node)) {
                    *s += n * m;
                }
            }
            for (s, m) in sum.iter().zip(exact) {
                prop_assert!((s - m).abs() < 1e-13, "{kind}");
            }
            // Degree 2 at most in each coordinate: a central difference over any step is exact.
            for d in 0..3 {
                let at = |s: f64| (table.shape)(std::array::from_fn(|k| xi[k] + if k == d { s } else { 0.0 }));
                let (plus, minus) = (at(0.5), at(-0.5));
                for i in 0..dn.len() {
                    prop_assert!((plus[i] - minus[i] - dn[i][d]).abs() < 1e-13, "{kind}: dN_{i}/dxi_{d}");
                }
            }
        }
        for kind in FaceKind::ALL {
            let xi = [xi[0], xi[1]];
            let (n, dn) = (kind.shape(xi), kind.shape_gradient(xi));
            prop_assert!(n[kind.node_count()..].iter().all(|n| *n == 0.0));
            let flat = |x: [f64; 2]| monomials(kind.is_quadratic(), [x[0], x[1], 0.0]);
            for (m, exact) in flat(xi).into_iter().enumerate() {
                let sum: f64 = kind.nodes().iter().zip(n).map(|(node, n)| n * flat(*node)[m]).sum();
                prop_assert!((sum - exact).abs() < 1e-13, "{kind}");
            }
            for d in 0..2 {
                let at = |s: f64| kind.shape(std::array::from_fn(|k| xi[k] + if k == d { s } else { 0.0 }));
                let (plus, minus) = (at(0.5), at(-0.5));
                for i in 0..dn.len() {
                    prop_assert!((plus[i] - minus[i] - dn[i][d]).abs() < 1e-13, "{kind}: dN_{i}/dxi_{d}");
                }
            }
        }
    }

    /// On a face the functions of the cell's other nodes vanish, those of its own nodes are the face's.
    #[test]
    fn faces_have_the_functions_of_the_cell(xi in prop::array::uniform2(0.0..1.0f64)) {
        for kind in CellKind::ALL {
            let table = kind.table();
            for face in table.faces {
                prop_assert_eq!(face.nodes.len(), face.kind.node_count());
                let n2 = face.kind.shape(xi);
                let point: [f64; 3] = std::array::from_fn(|d| {
                    face.nodes.iter().zip(n2).map(|(&i, n)| n * table.nodes[usize::from(i)][d]).sum()
                });
                prop_assert!(table.family.excess(point).abs() < 1e-14 || table.family.excess(point) > 0.0);
                let n3 = (table.shape)(point);
                for i in 0..kind.node_count() {
                    let expected = face.nodes.iter().position(|&n| usize::from(n) == i).map_or(0.0, |k| n2[k]);
                    prop_assert!((n3[i] - expected).abs() < 1e-14, "{kind}");
                }
            }
        }
    }
}

#[test]
fn functions_are_one_at_their_own_node() {
    for kind in CellKind::ALL {
        let table = kind.table();
        for (i, &node) in table.nodes.iter().enumerate() {
            for (j, n) in (table.shape)(node).into_iter().enumerate() {
                assert!((n - f64::from(u8::from(i == j))).abs() < 1e-15, "{kind}: N_{j} at node {i}");
            }
        }
        for &[a, b, middle] in table.edges {
            for d in 0..3 {
                let of = |n: u8| table.nodes[usize::from(n)][d];
                assert_eq!(of(middle), 0.5 * (of(a) + of(b)));
            }
        }
        assert!(table.edges.is_empty() || table.edges.iter().map(|e| [e[0], e[1]]).eq(kind.edges().iter().copied()));
        assert_eq!(CellKind::from_name(kind.name()), Some(kind));
    }
    for kind in FaceKind::ALL {
        for (i, &node) in kind.nodes().iter().enumerate() {
            for (j, n) in kind.shape(node).into_iter().enumerate() {
                assert_eq!(n, f64::from(u8::from(i == j)), "{kind}: N_{j} at node {i}");
            }
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `int x . n dA` over all faces is three times the volume; each edge is passed once in each direction of the pieces too.
#[test]
fn faces_are_outward_and_close_the_cell() {
    for kind in CellKind::ALL {
        let table = kind.table();
        let place = |i: u8| table.nodes[usize::from(i)];
        let mut volume = 0.0;
        let mut edges: BTreeMap<(u8, u8), i32> = BTreeMap::new();
        let mut pass = |polygon: &[u8]| {
            for k in 0..polygon.len() {
                let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        };
        for face in table.faces {
            for &(xi, w) in face.kind.rule() {
                let (n, dn) = (face.kind.shape(xi), face.kind.shape_gradient(xi));
                let sum = |weight: &dyn Fn(usize) -> f64| -> [f64; 3] {
                    std::array::from_fn(|d| (0..face.nodes.len()).map(|k| weight(k) * place(face.nodes[k])[d]).sum())
                };
                let normal = cross(sum(&|k| dn[k][0]), sum(&|k| dn[k][1]));
                volume += w * (0..3).map(|d| sum(&|k| n[k])[d] * normal[d]).sum::<f64>() / 3.0;
            }
            let of = |local: &[u8]| -> Vec<u8> { local.iter().map(|&k| face.nodes[usize::from(k)]).collect() };
            for piece in face.kind.pieces() {
                pass(&of(piece));
            }
            let area = |polygon: &[u8]| -> f64 {
                let x: Vec<_> = of(polygon).into_iter().map(place).collect();
                let minus = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|d| a[d] - b[d]) };
                let n = x[1..].windows(2).fold([0.0; 3], |sum, p| {
                    let c = cross(minus(p[0], x[0]), minus(p[1], x[0]));
                    std::array::from_fn(|d| sum[d] + 0.5 * c[d])
                });
                n.iter().map(|c| c * c).sum::<f64>().sqrt()
            };
            let pieces = face.kind.pieces().iter().map(|p| area(p)).sum::<f64>();
            let corners: Vec<u8> = (0..face.kind.corner_count() as u8).collect();
            assert!((pieces - area(&corners)).abs() < 1e-14);
        }
        assert!((volume - table.family.volume()).abs() < 1e-14, "{kind}: {volume}");
        let six = table.family.tetrahedra().iter().map(|t| {
            let [o, a, b, c] = t.map(|k| table.nodes[k]);
            let [a, b, c] = [a, b, c].map(|x| -> [f64; 3] { std::array::from_fn(|d| x[d] - o[d]) });
            let n = cross(a, b);
            let volume = (0..3).map(|d| n[d] * c[d]).sum::<f64>();
            assert!(volume > 0.0, "{kind}");
            volume
        });
        assert!((six.sum::<f64>() / 6.0 - table.family.volume()).abs() < 1e-14, "{kind}");
        assert!(edges.values().all(|&sum| sum == 0), "{kind}");
        let centre = (table.shape)(table.family.centre());
        let mean = |d: usize| (0..kind.node_count()).map(|i| centre[i] * table.nodes[i][d]).sum::<f64>();
        assert!((0..3).all(|d| (mean(d) - table.family.centre()[d]).abs() < 1e-15));
        assert!(table.family.excess(table.family.centre()) < -0.45);
    }
}

fn factorial(n: i32) -> f64 {
    (1..=n).map(f64::from).product()
}

/// Integral of `x^i y^j z^k` over the cell in natural coordinates.
fn exact(family: Family, [i, j, k]: [i32; 3]) -> f64 {
    let line = |n: i32| if n % 2 == 0 { 2.0 / f64::from(n + 1) } else { 0.0 };
    match family {
        Family::Hexahedron => line(i) * line(j) * line(k),
        Family::Tetrahedron => factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3),
        Family::Wedge => factorial(i) * factorial(j) / factorial(i + j + 2) * line(k),
    }
}

/// Largest error of a rule over the monomials of a total degree.
fn error(family: Family, rule: QuadratureRule, degree: i32) -> f64 {
    let mut worst = 0.0f64;
    for i in 0..=degree {
        for j in 0..=degree - i {
            let powers = [i, j, degree - i - j];
            let sum: f64 = rule.iter().map(|(x, w)| w * (0..3).map(|d| x[d].powi(powers[d])).product::<f64>()).sum();
            worst = worst.max((sum - exact(family, powers)).abs());
        }
    }
    worst
}

#[test]
fn rules_are_exact_to_their_degree_and_not_beyond() {
    let rules: [(Family, QuadratureRule, i32); 8] = [
        (Family::Hexahedron, &quadrature::GAUSS_HEX_2, 3),
        (Family::Hexahedron, &quadrature::GAUSS_HEX_3, 5),
        (Family::Tetrahedron, &quadrature::TET_1, 1),
        (Family::Tetrahedron, &quadrature::TET_4, 2),
        (Family::Tetrahedron, &quadrature::TET_8, 3),
        (Family::Tetrahedron, &quadrature::TET_14, 5),
        (Family::Wedge, &quadrature::WEDGE_6, 2),
        (Family::Wedge, &quadrature::WEDGE_21, 5),
    ];
    for (family, rule, degree) in rules {
        assert!(rule.iter().all(|(x, w)| *w > 0.0 && family.excess(*x) < 1e-15), "{family:?}");
        for d in 0..=degree {
            assert!(error(family, rule, d) < 1e-14, "{family:?}, {} points, degree {d}", rule.len());
        }
        assert!(error(family, rule, degree + 1) > 1e-6, "{family:?}, {} points", rule.len());
    }
}

/// The gradients at the points of a rule span all modes but the six rigid ones; of hex20 with 8 points six more have no stiffness.
#[test]
fn rank_of_the_stiffness() {
    for kind in CellKind::ALL {
        for &(integration, rule) in kind.table().rules {
            let n = kind.node_count();
            let mut rows: Vec<Vec<f64>> = Vec::new();
            for (xi, _) in rule {
                let dn = (kind.table().shape_gradient)(*xi);
                for (a, b) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)] {
                    let mut row = vec![0.0; 3 * n];
                    for i in 0..n {
                        row[3 * i + a] += dn[i][b];
                        row[3 * i + b] += dn[i][a];
                    }
                    rows.push(row);
                }
            }
            let rank = rank(rows);
            let expected = match (kind, integration) {
                (CellKind::Hex20, Integration::Reduced) => 48,
                _ => 3 * n - 6,
            };
            assert_eq!(rank, expected, "{kind}, {integration:?}");
        }
    }
}

/// Rank by elimination with full pivots.
fn rank(mut rows: Vec<Vec<f64>>) -> usize {
    let mut rank = 0;
    while rank < rows.len() {
        let pivot = (rank..rows.len())
            .flat_map(|r| (0..rows[r].len()).map(move |c| (r, c)))
            .max_by(|a, b| rows[a.0][a.1].abs().total_cmp(&rows[b.0][b.1].abs()));
        let Some((r, c)) = pivot.filter(|&(r, c)| rows[r][c].abs() > 1e-10) else { break };
        rows.swap(rank, r);
        let (upper, lower) = rows.split_at_mut(rank + 1);
        for row in lower {
            let factor = row[c] / upper[rank][c];
            for (x, p) in row.iter_mut().zip(&upper[rank]) {
                *x -= factor * p;
            }
        }
        rank += 1;
    }
    rank
}

#[test]
fn permutations_are_permutations() {
    for kind in CellKind::ALL {
        for order in [kind.table().from_gmsh, kind.table().from_abaqus] {
            let mut sorted = order.to_vec();
            sorted.sort_unstable();
            assert!(sorted.into_iter().map(usize::from).eq(0..kind.node_count()), "{kind}");
        }
    }
}

/// The cell as data and the module with arrays of its own size are one.
#[test]
fn hex8_has_the_functions_of_its_module() {
    let xi = [0.3, -0.7, 0.1];
    assert_eq!((CellKind::Hex8.table().shape)(xi)[..8], hex8::shape(xi));
    assert_eq!((CellKind::Hex8.table().shape_gradient)(xi)[..8], hex8::shape_gradient(xi));
}

/// Integrals of the piecewise linear functions of the trace, handed on to the nodes, are those of the face's functions; vertices keep linear functions, and those on
/// edges depend on the edge alone.
#[test]
fn the_trace_has_the_forces_of_the_face() {
    for kind in FaceKind::ALL {
        let trace = kind.trace();
        let place = |v: usize| -> [f64; 2] {
            std::array::from_fn(|d| trace.vertices[v].iter().map(|&(n, w)| w * kind.nodes()[usize::from(n)][d]).sum())
        };
        let mut found = vec![0.0; kind.node_count()];
        let mut area = 0.0;
        for facet in trace.facets {
            // Parallelograms and triangles: each vertex has an equal part.
            let x: Vec<[f64; 2]> = facet.iter().map(|&v| place(usize::from(v))).collect();
            let of = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
            let part = 0.5 * (0..x.len()).map(|k| of(x[k], x[(k + 1) % x.len()])).sum::<f64>();
            assert!(part > 0.0);
            area += part;
            for &v in *facet {
                for &(n, w) in trace.vertices[usize::from(v)] {
                    found[usize::from(n)] += w * part / facet.len() as f64;
                }
            }
        }
        let exact = |n: usize| kind.rule().iter().map(|(xi, w)| w * kind.shape(*xi)[n]).sum::<f64>();
        assert!((area - kind.linear().area()).abs() < 1e-15);
        assert!(found.iter().enumerate().all(|(n, f)| (f - exact(n)).abs() < 1e-15), "{kind}: {found:?}");
        for (v, terms) in trace.vertices.iter().enumerate() {
            assert!((terms.iter().map(|t| t.1).sum::<f64>() - 1.0).abs() < 1e-15);
            let at = if v < kind.node_count() { kind.nodes()[v] } else { [0.0; 2] };
            assert!((0..2).all(|d| (place(v)[d] - at[d]).abs() < 1e-15), "{kind}: {v}");
            if v < kind.corner_count() {
                assert_eq!(terms, &[(v as u8, 1.0)]);
            } else if v < 2 * kind.corner_count() {
                let a = (v - kind.corner_count()) as u8;
                let b = (a + 1) % kind.corner_count() as u8;
                assert_eq!(terms, &[(v as u8, 4.0 / 3.0), (a, -1.0 / 6.0), (b, -1.0 / 6.0)]);
            }
        }
    }
}

/// Functions on the facets of the trace: one at a node, linear along half an edge, never negative, and exact for linear functions.
#[test]
fn piecewise_functions_are_linear_and_not_negative() {
    for kind in FaceKind::ALL {
        let (nodes, corners) = (kind.nodes(), kind.corner_count());
        for (n, &x) in nodes.iter().enumerate() {
            let shape = kind.piecewise_shape(x);
            assert!(shape.iter().enumerate().all(|(k, w)| (w - f64::from(u8::from(k == n))).abs() < 1e-15), "{kind}");
        }
        // an edge is shared with other faces: functions of its own nodes alone
        for a in 0..corners {
            let b = (a + 1) % corners;
            let ends = if kind.is_quadratic() { vec![(a, corners + a), (corners + a, b)] } else { vec![(a, b)] };
            for (p, q) in ends {
                let at = std::array::from_fn(|d| 0.3 * nodes[p][d] + 0.7 * nodes[q][d]);
                let shape = kind.piecewise_shape(at);
                assert!((shape[p] - 0.3).abs() < 1e-15 && (shape[q] - 0.7).abs() < 1e-15, "{kind}: {shape:?}");
            }
        }
        for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (f64::from(i) / 20.0, f64::from(j) / 20.0))) {
            let xi = if corners == 3 { [i, (1.0 - i) * j] } else { [2.0 * i - 1.0, 2.0 * j - 1.0] };
            let shape = kind.piecewise_shape(xi);
            assert!(shape.iter().all(|w| *w > -1e-15) && (shape.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            let at: [f64; 2] = std::array::from_fn(|d| nodes.iter().zip(shape).map(|(x, w)| w * x[d]).sum());
            assert!((0..2).all(|d| (at[d] - xi[d]).abs() < 1e-14), "{kind} at {xi:?}: {at:?}");
        }
    }
}

#[test]
fn every_cell_has_a_quadratic_one_on_its_corners() {
    for kind in CellKind::ALL {
        let quadratic = kind.quadratic();
        assert!(quadratic.is_quadratic() && quadratic.table().linear == kind.table().linear, "{kind}");
        let middles = if kind.is_quadratic() { kind.table().edges.len() } else { kind.edges().len() };
        assert_eq!(quadratic.table().edges.len(), middles, "{kind}");
    }
    assert_eq!([CellKind::Hex8, CellKind::Hex27].map(CellKind::quadratic), [CellKind::Hex20, CellKind::Hex27]);
}
