//! Bounds of `det J` in whole elements.

use proptest::prelude::*;
use stoss_mesh::{ElementPoint, Elements, Mesh, MeshError, Validity};
use stoss_reference_element::{CellKind, Family, quadrature};

/// A sequence of numbers in `[-1, 1)`, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> [f64; 3] {
        [self.next(), self.next(), self.next()]
    }

    /// A point of a cell.
    fn point(&mut self, family: Family) -> [f64; 3] {
        loop {
            let xi = self.vector();
            if family.excess(xi) <= 0.0 {
                return xi;
            }
        }
    }
}

/// A mesh of one cell.
fn cell(kind: CellKind, places: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Mesh {
    let nodes: Vec<[f64; 3]> = kind.table().nodes.iter().enumerate().map(|(n, &xi)| places(n, xi)).collect();
    let numbers = (0..nodes.len() as u32).collect();
    Mesh { nodes, elements: Elements::of_kind(kind, numbers), ..Mesh::default() }
}

fn validity(mesh: &Mesh) -> Validity {
    mesh.element_coordinates(0).validity()
}

fn det(m: [[f64; 3]; 3]) -> f64 {
    let [a, b, c] = m;
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// `det J` over its mean in the linear cell, by an integral over that.
fn relative(mesh: &Mesh, points: impl IntoIterator<Item = [f64; 3]>) -> Vec<f64> {
    let x = mesh.element_coordinates(0);
    let linear = x.kind().table().linear;
    let corners = Mesh {
        nodes: x[..linear.node_count()].to_vec(),
        elements: Elements::of_kind(linear, (0..linear.node_count() as u32).collect()),
        ..Mesh::default()
    };
    let unit = corners.quality().volume / linear.table().family.volume();
    points.into_iter().map(|xi| det(x.jacobian(xi)) / unit).collect()
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Nothing is below the bound, and the least value is one of the cell; affine images have one everywhere.
    #[test]
    fn nothing_is_below_the_bound(seed in 1u64.., amount in 0.0..0.5f64) {
        let mut random = Random(seed | 1);
        for kind in CellKind::ALL {
            let shift: Vec<[f64; 3]> = (0..kind.node_count()).map(|_| random.vector().map(|x| amount * x)).collect();
            let mesh = cell(kind, |n, xi| [0, 1, 2].map(|i| 2.0 * xi[i] + 0.5 * shift[n][i]));
            let found = validity(&mesh);
            let family = kind.table().family;
            let points: Vec<[f64; 3]> = (0..1000).map(|_| random.point(family)).collect();
            let values = relative(&mesh, points.iter().copied().chain(kind.table().nodes.iter().copied()));
            prop_assert!(found.bound <= least(&values) + 1e-12, "{kind}: {found:?}, {}", least(&values));
            prop_assert!((relative(&mesh, [found.at])[0] - found.least).abs() < 1e-12);
            prop_assert!(found.bound <= found.least + 1e-12);
        }
    }

    #[test]
    fn affine_images_have_one(seed in 1u64..) {
        let mut random = Random(seed | 1);
        for kind in CellKind::ALL {
            let [a, b, c] = [random.vector(), random.vector(), random.vector()];
            if det([a, b, c]) < 0.3 {
                continue;
            }
            let mesh = cell(kind, |_, xi| [0, 1, 2].map(|i| a[i] * xi[0] + b[i] * xi[1] + c[i] * xi[2]));
            let found = validity(&mesh);
            prop_assert!((found.bound - 1.0).abs() < 1e-12 && (found.least - 1.0).abs() < 1e-12, "{kind}: {found:?}");
            prop_assert!((mesh.quality().min_validity - 1.0).abs() < 1e-12);
        }
    }
}

/// A unit tetrahedron with straight edges whose middle nodes were moved.
fn curved_tetrahedron(random: &mut Random, amount: f64) -> Mesh {
    let shift: Vec<[f64; 3]> = (0..6).map(|_| random.vector().map(|x| amount * x)).collect();
    cell(CellKind::Tet10, |n, xi| match n.checked_sub(4) {
        Some(edge) => [0, 1, 2].map(|i| xi[i] + shift[edge][i]),
        None => xi,
    })
}

/// The smallest of the 20 coefficients of a tet10 from the Jacobians at its corners: `det J_a`, `cof J_a : J_b / 3`, `(J_a x J_b) : J_c / 6`.
fn smallest_in_closed_form(mesh: &Mesh) -> f64 {
    let x = mesh.element_coordinates(0);
    let j: Vec<[[f64; 3]; 3]> = CellKind::Tet4.table().nodes.iter().map(|&xi| x.jacobian(xi)).collect();
    // `det` of all ways to take rows from three matrices is the polar form times six.
    let polar = |a: usize, b: usize, c: usize| {
        let orders = [[a, b, c], [b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]];
        orders.iter().map(|&[a, b, c]| det([j[a][0], j[b][1], j[c][2]])).sum::<f64>() / 6.0
    };
    let mut list = Vec::new();
    for a in 0..4 {
        for b in a..4 {
            list.extend((b..4).map(|c| polar(a, b, c)));
        }
    }
    assert_eq!(list.len(), 20);
    least(&list)
}

/// Of 300 tetrahedra whose middle nodes are off at random: how many are valid at 455 points, are accepted, are positive at 4 Gauss points and at the corners.
#[test]
fn tetrahedra_are_accepted_as_far_as_they_are_valid() {
    let mut grid = Vec::new();
    for i in 0..=12 {
        for j in 0..=12 - i {
            grid.extend((0..=12 - i - j).map(|k| [i, j, k].map(|n: i32| f64::from(n) / 12.0)));
        }
    }
    assert_eq!(grid.len(), 455);
    let mut random = Random(20_261_125);
    for (amount, valid, accepted, gauss) in [
        (0.05, 1.0, 1.0, 1.0),
        (0.10, 0.97, 0.97, 1.0),
        (0.15, 0.76, 0.75, 0.98),
        (0.20, 0.47, 0.42, 0.91),
        (0.30, 0.13, 0.08, 0.67),
    ] {
        let mut counts = [0; 4];
        for _ in 0..300 {
            let mesh = curved_tetrahedron(&mut random, amount);
            let found = validity(&mesh);
            let positive = |points: &[[f64; 3]]| least(&relative(&mesh, points.iter().copied())) > 0.0;
            let is_valid = positive(&grid);
            let rule: Vec<[f64; 3]> = quadrature::TET_4.iter().map(|(xi, _)| *xi).collect();
            let closed = smallest_in_closed_form(&mesh);
            if closed >= 0.1 {
                assert!((found.bound - closed).abs() < 1e-12, "{} {closed}", found.bound);
            } else {
                // A subdivision makes it sharper.
                assert!(found.bound >= closed - 1e-12);
            }
            assert!(
                is_valid || found.bound.is_nan() || found.bound <= 0.0,
                "an invalid tetrahedron has the bound {}",
                found.bound
            );
            counts[0] += i32::from(is_valid);
            counts[1] += i32::from(closed > 0.0);
            counts[2] += i32::from(positive(&rule));
            counts[3] += i32::from(positive(&kind_corners()));
            // The mesh is refused where a value is not positive, and only there.
            let refused = matches!(mesh.check(), Err(MeshError::InvertedElement { .. }));
            assert_eq!(refused, found.is_inverted() || !positive(CellKind::Tet10.table().nodes));
            assert!(!refused || !is_valid || found.is_inverted());
        }
        let parts = counts.map(|count| f64::from(count) / 300.0);
        println!("{amount}: {parts:?}");
        // Three standard deviations of a sample of 300.
        let near = |found: f64, expected: f64| {
            (found - expected).abs() < 0.02 + 3.0 * (expected * (1.0 - expected) / 300.0).sqrt()
        };
        assert!(near(parts[0], valid) && near(parts[1], accepted) && near(parts[2], gauss), "{amount}: {parts:?}");
    }
}

fn kind_corners() -> Vec<[f64; 3]> {
    CellKind::Tet4.table().nodes.to_vec()
}

/// The quarter point: with a middle node at a quarter of its edge `det J` vanishes at the corner next to it, and the bound says so.
#[test]
fn at_corners_the_bound_is_the_value() {
    for kind in [CellKind::Tet10, CellKind::Hex20, CellKind::Hex27, CellKind::Wedge15] {
        let edge = kind.table().edges[0];
        let [from, to] = [edge[0], edge[1]].map(|n| kind.table().nodes[usize::from(n)]);
        for part in [0.5, 0.4, 0.35, 0.3, 0.25] {
            let mesh = cell(kind, |n, xi| match n == usize::from(edge[2]) {
                true => [0, 1, 2].map(|i| (1.0 - part) * from[i] + part * to[i]),
                false => xi,
            });
            // The tangent at the corner is `4 x_middle - 3 x_from - x_to`, over twice the edge.
            let expected = 4.0 * part - 1.0;
            let found = validity(&mesh);
            assert!((found.bound - expected).abs() < 1e-12, "{kind} {part}: {found:?}");
            assert_eq!(mesh.check().is_err(), part == 0.25, "{kind} {part}");
        }
    }
}

/// Elements that are positive at Gauss points and nodes, but not everywhere, are refused, and the error names a place where they are not.
#[test]
fn what_nodes_and_gauss_points_do_not_see_is_refused() {
    let mut random = Random(7);
    for kind in [CellKind::Hex20, CellKind::Hex27, CellKind::Wedge15] {
        let mut found = 0;
        for _ in 0..4000 {
            let shift: Vec<[f64; 3]> = (0..kind.node_count()).map(|_| random.vector().map(|x| 0.35 * x)).collect();
            let corners = kind.table().corners;
            let mesh = cell(kind, |n, xi| if n < corners { xi } else { [0, 1, 2].map(|i| xi[i] + shift[n][i]) });
            if let Err(MeshError::InvertedElement { point: ElementPoint::Natural(xi), jacobian, .. }) = mesh.check() {
                assert!(jacobian <= 0.0 && det(mesh.element_coordinates(0).jacobian(xi)) == jacobian);
                assert_eq!(mesh.quality().inverted_elements, 1);
                found += 1;
            }
        }
        assert!(found > 0, "{kind}");
    }
}

/// A warning counts the elements and names the worst one; a linear hexahedron that is flat at a corner is accepted with it.
#[test]
fn poor_elements_are_reported() {
    let mut mesh = cell(CellKind::Hex8, |_, xi| xi);
    assert_eq!(mesh.quality().warning(), None);
    mesh.nodes[6] = [0.0, 0.0, 1.0];
    let quality = mesh.quality();
    assert!(mesh.check().is_ok());
    assert!(quality.min_validity.abs() < 1e-12 && quality.poor_elements == 1);
    let text = quality.warning().unwrap();
    assert!(text.starts_with("1 element has") && text.contains("the smallest is that of element 0"), "{text}");
}
