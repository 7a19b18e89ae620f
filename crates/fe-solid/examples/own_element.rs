//! A solid element of one's own: the tetrahedron with a bubble at its centre (MINI), which Stoss does not have. Shown: a cell as data
//! (`CellTable`), and force and tangent of an element made of it, by the arithmetic of the solids (`stoss_fe_solid::kernel`).
//! Checked: shape functions; the tangent against differences; that the energy-momentum force does the work of the energy; that the bubble
//! has no force where the strain is uniform (patch test).
//!
//! `cargo run --example own_element -p stoss-fe-solid`; docs/how-to-add/element.md has the steps that put a table into Stoss.

use std::error::Error;
use stoss_continuum::{ConstitutiveError, HyperelasticLaw, SymmetricTensor2, energy_momentum_stress_and_tangent};
use stoss_fe_solid::kernel::{self, ElementIntegration, LocalTangent, NodalVectors, TangentFactors, TangentPoint};
use stoss_materials::NeoHooke;
use stoss_reference_element::quadrature::TET_14;
use stoss_reference_element::{
    CellKind, CellTable, Face, FaceKind, Family, Integration, ShapeFunctions, ShapeGradient,
};

const NODES: usize = 5;
const POINTS: usize = TET_14.len();

static TET5: CellTable = CellTable {
    name: "tet5",
    about: "Tetrahedra with a bubble.",
    family: Family::Tetrahedron,
    nodes: &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.25; 3]],
    corners: 4,
    edges: &[],
    faces: &[
        Face { kind: FaceKind::Tri3, nodes: &[0, 2, 1] },
        Face { kind: FaceKind::Tri3, nodes: &[0, 1, 3] },
        Face { kind: FaceKind::Tri3, nodes: &[1, 2, 3] },
        Face { kind: FaceKind::Tri3, nodes: &[2, 0, 3] },
    ],
    linear: CellKind::Tet4,
    rules: &[(Integration::Full, &TET_14)],
    mass: &TET_14,
    shape,
    shape_gradient,
    vtk: 10,
    gmsh: 4,
    from_gmsh: &[0, 1, 2, 3, 4],
    abaqus: &[],
    from_abaqus: &[0, 1, 2, 3, 4],
};

/// `L_a - 64 L_0 L_1 L_2 L_3` at the corners with the functions `L` of the linear tetrahedron, `256 L_0 L_1 L_2 L_3` at the centre.
fn shape(xi: [f64; 3]) -> ShapeFunctions {
    let mut n = (CellKind::Tet4.table().shape)(xi);
    let bubble: f64 = n[..4].iter().product();
    n[..4].iter_mut().for_each(|n| *n -= 64.0 * bubble);
    n[4] = 256.0 * bubble;
    n
}

fn shape_gradient(xi: [f64; 3]) -> ShapeGradient {
    let (l, mut dn) = ((CellKind::Tet4.table().shape)(xi), (CellKind::Tet4.table().shape_gradient)(xi));
    let without = |a: usize| (0..4).filter(|&b| b != a).map(|b| l[b]).product::<f64>();
    let bubble: [f64; 3] = std::array::from_fn(|d| (0..4).map(|a| without(a) * dn[a][d]).sum());
    dn[..4].iter_mut().for_each(|dn| *dn = std::array::from_fn(|d| dn[d] - 64.0 * bubble[d]));
    dn[4] = bubble.map(|b| 256.0 * b);
    dn
}

/// Gradients and weights of an element with the nodes `x`.
fn integration(x: &NodalVectors<NODES>) -> Result<ElementIntegration<NODES, POINTS>, (usize, f64)> {
    let rule = TET5.rules[0].1;
    let natural = std::array::from_fn(|g| {
        let gradient = (TET5.shape_gradient)(rule[g].0);
        std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]))
    });
    kernel::integration(x, &natural, &std::array::from_fn(|g| rule[g].1))
}

/// Energy-momentum force of a step from `q_n` to `q_np1`, its derivative by `q_np1`, and the change of the energy.
fn element(
    law: &dyn HyperelasticLaw,
    at: &ElementIntegration<NODES, POINTS>,
    [q_n, q_np1]: [&NodalVectors<NODES>; 2],
) -> Result<(NodalVectors<NODES>, LocalTangent<NODES>, f64), ConstitutiveError> {
    let (mut force, mut change) = ([[0.0; NODES]; 3], 0.0);
    let mut factors: TangentFactors<NODES, POINTS> = [[[[0.0; NODES]; 3]; POINTS]; 9];
    for (g, (gradients, &weight)) in at.gradients.iter().zip(&at.weights).enumerate() {
        let [f_n, f_np1] = [q_n, q_np1].map(|q| kernel::deformation_gradient(q, gradients));
        let mid = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (f_n[i][j] + f_np1[i][j])));
        let [c_n, c_np1] = [f_n, f_np1].map(|f| SymmetricTensor2(kernel::right_cauchy_green(&f)));
        let (s, a) = energy_momentum_stress_and_tangent(law, &c_n, law.energy(&c_n)?, &c_np1)?;
        kernel::add_force(&mid, &s.0, gradients, weight, &mut force);
        // The middle moves by half of what the end does.
        let (left, right, moduli, stress) = (&mid, &f_np1, &a.0, &s.0);
        let point = TangentPoint { left, right, moduli, stress, geometric: 0.5, weight };
        kernel::tangent_factors(&[point], &at.gradients, g, false, &mut factors);
        change += weight * (law.energy(&c_np1)? - law.energy(&c_n)?);
    }
    let mut tangent = [[[[0.0; 3]; NODES]; 3]; NODES];
    kernel::tangent_from_factors(&at.gradients, &factors, false, 1.0, &mut tangent);
    Ok((force, tangent, change))
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |worst, x| worst.max(x.abs()))
}

/// Errors of the shape functions (Kronecker property, sum 1) and of their gradients (differences).
fn shape_errors() -> [f64; 2] {
    let (xi, h) = ([0.2, 0.3, 0.1], 1e-5);
    let kronecker = |i: usize, j: usize| (TET5.shape)(TET5.nodes[i])[j] - f64::from(u8::from(i == j));
    let nodes = largest((0..NODES * NODES).map(|k| kronecker(k / NODES, k % NODES)));
    let difference = |i: usize, d: usize| {
        let at = |s: f64| (TET5.shape)(std::array::from_fn(|k| xi[k] + if k == d { s } else { 0.0 }))[i];
        (at(h) - at(-h)) / (2.0 * h) - (TET5.shape_gradient)(xi)[i][d]
    };
    let nodes = nodes.max(((TET5.shape)(xi).iter().sum::<f64>() - 1.0).abs());
    [nodes, largest((0..3 * NODES).map(|k| difference(k / 3, k % 3)))]
}

fn main() -> Result<(), Box<dyn Error>> {
    let law = NeoHooke::from_young_poisson(100.0, 0.3)?;
    // Corners and their centre; then two states, in which the bubble is not at the centre.
    let x: NodalVectors<NODES> = [[0.0, 1.2, 0.1, 0.3, 0.4], [0.0, 0.1, 0.9, 0.2, 0.3], [0.0, 0.0, 0.2, 1.4, 0.4]];
    let at = integration(&x).map_err(|(point, det)| format!("det {det} at {point}"))?;
    let state = |s: f64| std::array::from_fn(|i| x[i].map(|x| x + 0.05 * (s + 3.0 * i as f64 + 7.0 * x).sin()));
    let (q_n, q_np1) = (state(0.0), state(1.0));
    let (force, tangent, change) = element(&law, &at, [&q_n, &q_np1])?;
    let (h, mut tangent_error) = (1e-6, 0.0_f64);
    for column in 0..3 * NODES {
        let moved = |h: f64| {
            let mut q = q_np1;
            q[column % 3][column / 3] += h;
            element(&law, &at, [&q_n, &q]).map(|made| made.0)
        };
        let (plus, minus) = (moved(h)?, moved(-h)?);
        let error = |i: usize, k: usize| (plus[i][k] - minus[i][k]) / (2.0 * h) - tangent[k][i][column / 3][column % 3];
        tangent_error = tangent_error.max(largest((0..3 * NODES).map(|row| error(row % 3, row / 3))));
    }
    let work: f64 = (0..3 * NODES).map(|k| (k % 3, k / 3)).map(|(i, k)| force[i][k] * (q_np1[i][k] - q_n[i][k])).sum();
    let sheared = [std::array::from_fn(|k| 1.1 * x[0][k] + 0.2 * x[1][k]), x[1], x[2]];
    let uniform = element(&law, &at, [&x, &sheared])?.0;
    let bubble = largest((0..3).map(|i| uniform[i][4])) / largest(uniform.into_iter().flatten());
    for (what, error, bound) in [
        ("shape functions", shape_errors()[0], 1e-14),
        ("gradients of the shape functions", shape_errors()[1], 1e-8),
        ("tangent against differences", tangent_error, 1e-6),
        ("work of the force over change of energy, minus 1", (work / change - 1.0).abs(), 1e-12),
        ("force of the bubble in uniform strain", bubble, 1e-12),
    ] {
        println!("{what:50} {error:.1e}");
        assert!(error < bound, "{what}: {error:e}");
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
