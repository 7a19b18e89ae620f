//! Mass of a parallelepiped, momenta and kinetic energy of rigid motions, body force.
use crate::common::*;
use stoss_fe_solid::{MassKind, TangentTarget};
use stoss_mesh::{Mesh, generate::Block};
use stoss_reference_element::hex8;

const DENSITY: f64 = 7.5;

/// The cube `[-1,1]^3` mapped by `x -> A x`; its volume is `8 det A = 8 * 0.5`.
fn parallelepiped() -> Mesh {
    let a = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.25], [0.0, 0.0, 0.5]];
    let nodes = hex8::VERTICES.map(|x| std::array::from_fn(|i| a[i][0] * x[0] + a[i][1] * x[1] + a[i][2] * x[2]));
    Mesh::new(nodes.to_vec(), vec![[0, 1, 2, 3, 4, 5, 6, 7]]).unwrap()
}

#[test]
fn consistent_mass_of_a_parallelepiped_is_the_product_of_one_dimensional_ones() {
    let mesh = parallelepiped();
    let body = body(&mesh, &laws()[0]);
    let (pattern, map) = pattern(&body, 24);
    let mut values = vec![0.0; pattern.nnz()];
    body.mass(DENSITY, MassKind::Consistent)
        .add_to_tangent(2.0, TangentTarget { map: &map, first_stencil: 0, factor: 0.5, values: &mut values });
    let m = dense(&pattern, &values);
    for (i, a) in hex8::VERTICES.iter().enumerate() {
        for (j, b) in hex8::VERTICES.iter().enumerate() {
            // Along a line of unit length: 1/3 on the diagonal, 1/6 beside it.
            let lines: f64 = (0..3).map(|d| if a[d] == b[d] { 1.0 / 3.0 } else { 1.0 / 6.0 }).product();
            for r in 0..3 {
                for c in 0..3 {
                    let expected = if r == c { DENSITY * 4.0 * lines } else { 0.0 };
                    assert!((m[3 * i + r][3 * j + c] - expected).abs() < 1e-14 * DENSITY);
                }
            }
        }
    }
}

#[test]
fn lumped_mass_is_the_row_sum() {
    let mesh = distorted_block([2, 2, 1], 0.2, 3);
    let body = body(&mesh, &laws()[0]);
    let x = Random(1).perturbed(&vec![0.0; 3 * mesh.nodes.len()], 1.0);
    let (consistent, lumped) = (body.mass(DENSITY, MassKind::Consistent), body.mass(DENSITY, MassKind::Lumped));
    assert_eq!((consistent.kind(), lumped.kind()), (MassKind::Consistent, MassKind::Lumped));
    let mut row_sums = vec![0.0; x.len()];
    consistent.multiply_add(1.0, &vec![1.0; x.len()], &mut row_sums);
    let mut out = vec![1.0; x.len()];
    lumped.multiply_add(2.0, &x, &mut out);
    for c in 0..x.len() {
        assert!((out[c] - 1.0 - 2.0 * row_sums[c] * x[c]).abs() < 1e-13 * DENSITY);
    }
}

#[test]
fn rigid_motions_of_a_box_have_the_momenta_of_mechanics() {
    let size = [2.0, 1.0, 0.5];
    let mesh = Block::with_size(size, [3, 2, 2]).generate().unwrap();
    let (centre, v0, w) = ([0.3, -0.7, 1.1], [1.5, -0.2, 0.4], [0.7, -1.3, 0.9]);
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let q = map_positions(&positions(&mesh), |x| std::array::from_fn(|i| centre[i] + x[i]));
    let v = map_positions(&positions(&mesh), |x| {
        let spin = cross(w, x);
        std::array::from_fn(|i| v0[i] + spin[i])
    });
    let m = DENSITY * size.iter().product::<f64>();
    let inertia: [f64; 3] = std::array::from_fn(|i| m / 12.0 * (size[(i + 1) % 3].powi(2) + size[(i + 2) % 3].powi(2)));
    let mass = body(&mesh, &laws()[0]).mass(DENSITY, MassKind::Consistent);

    assert!((mass.total() - m).abs() < 1e-13 * m);
    let energy = 0.5 * m * dot(&v0, &v0) + 0.5 * (0..3).map(|i| inertia[i] * w[i] * w[i]).sum::<f64>();
    assert!((mass.kinetic_energy(&v) - energy).abs() < 1e-13 * energy);
    let (linear, angular) = (mass.linear_momentum(&v), mass.angular_momentum(&q, &v));
    let orbital = cross(centre, v0);
    for i in 0..3 {
        assert!((linear[i] - m * v0[i]).abs() < 1e-13 * m);
        assert!((angular[i] - (m * orbital[i] + inertia[i] * w[i])).abs() < 1e-13 * m);
    }

    // The lumped mass keeps the total and the linear momentum.
    let lumped = body(&mesh, &laws()[0]).mass(DENSITY, MassKind::Lumped);
    assert!((lumped.total() - m).abs() < 1e-13 * m);
    for i in 0..3 {
        assert!((lumped.linear_momentum(&v)[i] - m * v0[i]).abs() < 1e-13 * m);
    }
}

#[test]
fn kinetic_energy_is_half_v_m_v() {
    let mesh = distorted_block([2, 1, 2], 0.2, 9);
    let v = Random(2).perturbed(&vec![0.0; 3 * mesh.nodes.len()], 1.0);
    for kind in [MassKind::Consistent, MassKind::Lumped] {
        let mass = body(&mesh, &laws()[0]).mass(DENSITY, kind);
        let mut momentum = vec![0.0; v.len()];
        mass.multiply_add(1.0, &v, &mut momentum);
        assert!((mass.kinetic_energy(&v) - 0.5 * dot(&v, &momentum)).abs() < 1e-13 * DENSITY);
        let (sum, moment) = resultant_and_moment(&positions(&mesh), &momentum);
        for i in 0..3 {
            assert!((mass.linear_momentum(&v)[i] - sum[i]).abs() < 1e-12 * DENSITY);
            assert!((mass.angular_momentum(&positions(&mesh), &v)[i] - moment[i]).abs() < 1e-12 * DENSITY);
        }
    }
}

#[test]
fn body_force_has_the_resultant_and_the_moment_of_the_weight() {
    let mesh = parallelepiped();
    let q = map_positions(&positions(&mesh), |x| [x[0] + 3.0, x[1] - 2.0, x[2] + 5.0]);
    let b = [0.1, -9.0, 2.0];
    let mut f = vec![0.0; q.len()];
    let body = body(&mesh, &laws()[0]);
    body.body_force(b, &mut f).unwrap();
    let (sum, moment) = resultant_and_moment(&q, &f);
    let c = [3.0, -2.0, 5.0];
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        assert!((sum[i] - 4.0 * b[i]).abs() < 1e-13 * 40.0);
        assert!((moment[i] - 4.0 * (c[j] * b[k] - c[k] * b[j])).abs() < 1e-13 * 400.0);
    }
    assert!((body.volume() - 4.0).abs() < 1e-14);
    assert!((body.characteristic_length() - 4f64.cbrt()).abs() < 1e-14);
}
