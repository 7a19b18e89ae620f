//! The battery of the linear cells and facets with arrays of their own: partition of unity, Kronecker property, reproduction of linear
//! fields, gradients against differences; exactness of the quadrature rules. That of all cells as data is in `cells.rs`.

use proptest::prelude::*;
use stoss_reference_element::{FacetKind, Nodal, hex8, quad4, quadrature, tri3};

/// Shape functions of a cell with points of any dimension.
struct Cell<const D: usize, const N: usize> {
    vertices: [[f64; D]; N],
    shape: fn([f64; D]) -> [f64; N],
    gradient: fn([f64; D]) -> [[f64; D]; N],
}

const HEX8: Cell<3, 8> = Cell { vertices: hex8::VERTICES, shape: hex8::shape, gradient: hex8::shape_gradient };
const QUAD4: Cell<2, 4> = Cell { vertices: quad4::VERTICES, shape: quad4::shape, gradient: quad4::shape_gradient };
const TRI3: Cell<2, 3> = Cell { vertices: tri3::VERTICES, shape: tri3::shape, gradient: |_| tri3::shape_gradient() };

impl<const D: usize, const N: usize> Cell<D, N> {
    fn kronecker(&self) {
        for (i, &v) in self.vertices.iter().enumerate() {
            for (j, n) in (self.shape)(v).into_iter().enumerate() {
                assert_eq!(n, f64::from(u8::from(i == j)), "N_{j} at vertex {i}");
            }
        }
    }

    /// Sum of N is 1, sum of x_I N is x, sum of the gradients is 0, sum of x_I (x) grad N is 1.
    fn linear_fields(&self, xi: [f64; D]) {
        let (n, dn) = ((self.shape)(xi), (self.gradient)(xi));
        assert!((n.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        for d in 0..D {
            let x: f64 = (0..N).map(|i| n[i] * self.vertices[i][d]).sum();
            assert!((x - xi[d]).abs() < 1e-14);
            assert!((0..N).map(|i| dn[i][d]).sum::<f64>().abs() < 1e-14);
            for e in 0..D {
                let f: f64 = (0..N).map(|i| self.vertices[i][e] * dn[i][d]).sum();
                assert!((f - f64::from(u8::from(d == e))).abs() < 1e-14);
            }
        }
    }

    /// The functions are linear in each coordinate: a central difference over any step is exact but for rounding.
    fn gradient_is_the_difference(&self, xi: [f64; D]) {
        let dn = (self.gradient)(xi);
        for d in 0..D {
            let (mut a, mut b) = (xi, xi);
            a[d] -= 0.5;
            b[d] += 0.5;
            let (na, nb) = ((self.shape)(a), (self.shape)(b));
            for i in 0..N {
                assert!((nb[i] - na[i] - dn[i][d]).abs() < 1e-14, "dN_{i}/dxi_{d}");
            }
        }
    }
}

#[test]
fn kronecker_property() {
    HEX8.kronecker();
    QUAD4.kronecker();
    TRI3.kronecker();
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn hex8_battery(xi in prop::array::uniform3(-1.2..1.2f64)) {
        HEX8.linear_fields(xi);
        HEX8.gradient_is_the_difference(xi);
    }

    #[test]
    fn quad4_battery(xi in prop::array::uniform2(-1.2..1.2f64)) {
        QUAD4.linear_fields(xi);
        QUAD4.gradient_is_the_difference(xi);
    }

    #[test]
    fn tri3_battery(xi in prop::array::uniform2(-1.2..1.2f64)) {
        TRI3.linear_fields(xi);
        TRI3.gradient_is_the_difference(xi);
    }

    /// What a kind says of its edges, its domain and its diagonals fits its vertices.
    #[test]
    fn data_of_facets(xi in prop::array::uniform2(-2.0..2.0f64), s in -1.0..1.0f64, x in prop::array::uniform4(prop::array::uniform2(-1.0..1.0f64))) {
        for kind in FacetKind::ALL {
            let v = kind.vertices();
            prop_assert_eq!((v.len(), kind.edge_count()), (kind.node_count(), kind.node_count()));
            let inside = kind.clamp(xi);
            prop_assert!(kind.excess(inside) <= 0.0);
            prop_assert!(kind.excess(xi) > 0.0 || inside == xi);
            prop_assert!(kind.clamp(inside) == inside);
            let excess = (0..kind.edge_count()).map(|edge| kind.edge_excess(edge, xi)).fold(f64::NEG_INFINITY, f64::max);
            prop_assert!((excess - kind.excess(xi)).abs() < 1e-14);
            prop_assert!(kind.excess(kind.centre()) < -0.5);
            let (shape, gradient) = (kind.shape(xi), kind.shape_gradient(xi));
            prop_assert!(shape[kind.node_count()..].iter().chain(gradient[kind.node_count()..].iter().flatten()).all(|n| *n == 0.0));
            for edge in 0..kind.edge_count() {
                let [a, b] = kind.side(edge).map(|corner| v[corner]);
                prop_assert_eq!((kind.side(edge), kind.previous(kind.next(edge))), ([edge, kind.next(edge)], edge));
                let on = kind.on_edge(edge, s);
                let between: [f64; 2] = std::array::from_fn(|i| a[i] + 0.5 * (1.0 + s) * (b[i] - a[i]));
                prop_assert!((on[0] - between[0]).abs() + (on[1] - between[1]).abs() < 1e-15);
                prop_assert!(kind.edge_excess(edge, on) == 0.0 && (kind.along_edge(edge, on) - s).abs() < 1e-15);
                let inward = kind.inward(edge);
                let into: [f64; 2] = std::array::from_fn(|i| between[i] + 0.1 * (1.0 - s.abs()) * inward[i]);
                prop_assert!(kind.edge_excess(edge, into) < 0.0 && kind.excess(into) < 0.0);
            }
            for side in kind.sides() {
                prop_assert_eq!(kind.side_between(side[1], side[0]).map(|s| kind.side(s)), Some(*side));
            }
            // In the plane: twice the area of the polygon, and of its triangles.
            let [d, e] = kind.diagonals().map(|c| -> [f64; 2] { std::array::from_fn(|i| (0..4).map(|k| c[k] * x[k][i]).sum()) });
            let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
            let polygon: f64 = (0..kind.edge_count()).map(|k| cross(x[k], x[kind.next(k)])).sum();
            prop_assert!((cross(d, e) - polygon).abs() < 1e-14);
            let twice = |[a, b, c]: [usize; 3]| cross(x[a], x[b]) + cross(x[b], x[c]) + cross(x[c], x[a]);
            let triangles: f64 = kind.triangles().iter().map(|t| twice(*t)).sum();
            prop_assert!((triangles - polygon).abs() < 1e-14);
            for pieces in kind.pieces() {
                let pieces: f64 = pieces.iter().map(|t| twice(t.map(usize::from))).sum();
                prop_assert!((pieces - polygon).abs() < 1e-14);
            }
            // The rule: integrals of the shape functions in natural coordinates.
            for k in 0..kind.node_count() {
                let integral: f64 = kind.rule().iter().map(|(xi, w)| w * kind.shape(*xi)[k]).sum();
                prop_assert!((integral - kind.area() / kind.node_count() as f64).abs() < 1e-15);
            }
        }
        // Of a triangle the sum of the squares of its two vectors does not depend on the numbering.
        let sum = |order: [usize; 3]| -> f64 {
            let d = FacetKind::Tri3.diagonals();
            d.iter().map(|c| (0..3).map(|k| c[k] * x[order[k]][0]).sum::<f64>().powi(2)).sum()
        };
        prop_assert!((sum([0, 1, 2]) - sum([1, 2, 0])).abs() < 1e-14);
    }

    /// The mixed derivative is the difference of the gradient in the other direction.
    #[test]
    fn quad4_mixed_derivative(xi in prop::array::uniform2(-1.0..1.0f64)) {
        let a = quad4::shape_gradient([xi[0], xi[1] - 0.5]);
        let b = quad4::shape_gradient([xi[0], xi[1] + 0.5]);
        for (i, m) in quad4::mixed_derivative().into_iter().enumerate() {
            prop_assert!((b[i][0] - a[i][0] - m).abs() < 1e-15);
        }
    }
}

/// Integral of `x^degree` over [-1, 1].
fn monomial(degree: i32) -> f64 {
    if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 }
}

#[test]
fn product_rules_are_exact_to_degree_three_in_each_coordinate() {
    for i in 0..=4 {
        for j in 0..=3 {
            let quad: f64 = quadrature::GAUSS_QUAD_2.iter().map(|(x, w)| w * x[0].powi(i) * x[1].powi(j)).sum();
            let exact = monomial(i) * monomial(j);
            let wrong = i == 4 && j % 2 == 0;
            assert_eq!((quad - exact).abs() > 1e-2, wrong, "quad {i} {j}");
            for k in 0..=3 {
                let hex: f64 =
                    quadrature::GAUSS_HEX_2.iter().map(|(x, w)| w * x[0].powi(i) * x[1].powi(j) * x[2].powi(k)).sum();
                let exact = monomial(i) * monomial(j) * monomial(k);
                if i < 4 {
                    assert!((hex - exact).abs() < 1e-14, "hex {i} {j} {k}");
                }
            }
        }
    }
}

/// theory/elements#mass: the consistent mass of the reference cube, known in closed form: 8/27 (1/2)^(different coordinates).
#[test]
fn two_by_two_by_two_integrates_the_mass_of_a_cube() {
    for i in 0..8 {
        for j in 0..8 {
            let mass: f64 = quadrature::GAUSS_HEX_2
                .iter()
                .map(|&(xi, w)| {
                    let n = hex8::shape(xi);
                    w * n[i] * n[j]
                })
                .sum();
            let different = (0..3).filter(|&d| hex8::VERTICES[i][d] != hex8::VERTICES[j][d]).count() as i32;
            assert!((mass - 8.0 / 27.0 * 0.5f64.powi(different)).abs() < 1e-15);
        }
    }
}

#[test]
fn values_at_nodes_are_a_slice_of_as_many() {
    let triangle = Nodal::from([5, 7, 9]);
    assert_eq!((triangle.kind(), triangle.len(), &triangle[..]), (FacetKind::Tri3, 3, &[5, 7, 9][..]));
    assert_eq!(triangle.padded(), &[5, 7, 9, 5]);
    assert_eq!(triangle.map(|n| 2 * n), Nodal::from([10, 14, 18]));
    assert_eq!(triangle.into_iter().chain(Nodal::from([1, 2, 3, 4])).sum::<i32>(), 31);
}
