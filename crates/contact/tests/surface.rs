//! Adjacency, nodal areas, errors of contact surfaces.

use crate::common::*;
use nalgebra::Vector3;
use proptest::prelude::*;
use stoss_contact::{ContactError, ContactSurface, FacetKind, FacetNodes, MasterSearch, SearchOptions};
use stoss_testkit::meshes::{Mesh, mesh};

fn surface<F: Copy + Into<FacetNodes>>(facets: &[F], q: &[f64]) -> ContactSurface {
    ContactSurface::new("slave", facets, q).expect("a valid surface")
}

#[test]
fn adjacency_of_a_closed_surface() {
    let (quads, q) = voxels(&block(3, 2, 2));
    for mesh in Mesh::ALL {
        let facets = mesh.of(&quads);
        let s = surface(&facets, &q);
        assert_eq!(s.boundary_edge_count(), 0);
        assert!(s.non_manifold_edges().is_empty());
        // Euler: V - E + F = 2, and every edge belongs to two facets.
        let edges = facets.iter().map(|f| f.len()).sum::<usize>() / 2;
        assert_eq!(s.nodes().len() + s.facets().len(), edges + 2);
        for (f, corners) in facets.iter().enumerate() {
            let ends = |facet: &FacetNodes, edge: usize| [facet[edge], facet[(edge + 1) % facet.len()]];
            assert_eq!(s.neighbours(f as u32).count(), corners.len());
            for k in 0..corners.len() {
                let g = s.neighbour(f as u32, k).expect("closed");
                let other = facets[g as usize];
                let [a, b] = ends(corners, k);
                let back = (0..other.len()).find(|&l| ends(&other, l) == [b, a]).expect("the edge from the other side");
                assert_eq!(s.neighbour(g, back), Some(f as u32));
            }
        }
        for (i, node) in s.nodes().iter().enumerate() {
            assert_eq!(s.local_node(*node), Some(i));
            let around: Vec<u32> = (0..facets.len() as u32).filter(|&f| facets[f as usize].contains(node)).collect();
            assert_eq!(s.facets_around(i), around);
        }
        assert_eq!(s.local_node(9999), None);
    }
}

#[test]
fn areas_of_plane_facets_are_exact() {
    // A box of 12 by 6 by 6: 2 (72 + 36 + 72).
    let (facets, mut q) = voxels(&block(4, 2, 3));
    q.chunks_exact_mut(3).for_each(|p| {
        p[0] *= 3.0;
        p[1] *= 3.0;
        p[2] *= 2.0;
    });
    for mesh in Mesh::ALL {
        let s = surface(&mesh.of(&facets), &q);
        assert!((s.area() - 360.0).abs() < 1e-11);
    }
    // One node of a flat interior: a quarter of each of four facets of 3 by 3.
    let (facets, q) = sheet(2, 2, |u, v| [3.0 * u, 3.0 * v, 1.0]);
    let s = surface(&facets, &q);
    let areas: Vec<f64> = [1.0, 2.0, 1.0, 2.0, 4.0, 2.0, 1.0, 2.0, 1.0].map(|n| n * 2.25).to_vec();
    assert!(s.nodal_areas().iter().zip(&areas).all(|(a, b)| (a - b).abs() < 1e-14));
    assert!((s.length_scale() - 3.0).abs() < 1e-14);
    assert_eq!(s.boundary_edge_count(), 8);
    // A triangle gives each of its corners a third of its area, 1.5.
    let triangles = [[0, 1, 3], [1, 4, 3]].map(FacetNodes::from);
    let mixed: Vec<FacetNodes> = triangles.into_iter().chain(facets[1..].iter().map(|&f| f.into())).collect();
    assert_eq!(mixed[0].kind(), FacetKind::Tri3);
    let s = surface(&mixed, &q);
    let areas = [1.5, 5.25, 2.25, 5.25, 8.25, 4.5, 2.25, 4.5, 2.25];
    assert!(s.nodal_areas().iter().zip(&areas).all(|(a, b)| (a - b).abs() < 1e-14), "{:?}", s.nodal_areas());
    assert_eq!((s.nodal_areas_at(&q), s.boundary_edge_count()), (s.nodal_areas().to_vec(), 8));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn areas_of_warped_sheets_agree_with_fine_triangles(heights in proptest::collection::vec(-0.3..0.3f64, 16)) {
        let (facets, q) = sheet(3, 3, |u, v| [u + 0.1 * v, v, heights[v as usize * 4 + u as usize]]);
        let s = surface(&facets, &q);
        let n = 24;
        let mut area = 0.0;
        for f in 0..facets.len() as u32 {
            let patch = s.patch(f, &q);
            let p = |i: i32, j: i32| patch.point([2.0 * f64::from(i) / f64::from(n) - 1.0, 2.0 * f64::from(j) / f64::from(n) - 1.0]);
            for i in 0..n {
                for j in 0..n {
                    let (a, b, c, d) = (p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1));
                    area += 0.5 * (c - a).cross(&(d - b)).norm();
                }
            }
        }
        prop_assert!((s.area() - area).abs() < 2e-3 * area, "{} {}", s.area(), area);
        prop_assert!(s.nodal_areas().iter().all(|a| *a > 0.0));
    }

    /// Weights of the node normals are angles: a cube's corner has the diagonal whatever the subdivision of its faces.
    #[test]
    fn node_normals_do_not_depend_on_the_subdivision(mesh in mesh(), n in 1i32..4) {
        let (facets, q) = voxels(&block(n, n, n));
        let s = surface(&mesh.of(&facets), &q);
        for (i, &node) in s.nodes().iter().enumerate() {
            let p = Vector3::from_column_slice(&q[3 * node as usize..3 * node as usize + 3]);
            let outwards = p.map(|c| if c == 0.0 { -1.0 } else if c == f64::from(n) { 1.0 } else { 0.0 });
            prop_assert!((s.node_normal(i, &q) - outwards.normalize()).norm() < 1e-14);
        }
    }
}

#[test]
fn defects_are_named() {
    let (facets, q) = sheet(2, 1, |u, v| [u, v, 0.0]);
    let build = |facets: &[[u32; 4]], q: &[f64]| ContactSurface::new("master", facets, q);
    assert_eq!(build(&[], &q), Err(ContactError::EmptySurface { side: "master" }));
    assert_eq!(build(&[[0, 1, 77, 3]], &q), Err(ContactError::MissingNode { facet: 0, node: 77, count: 6 }));
    let mut bad = q.clone();
    bad[4] = f64::NAN;
    assert_eq!(build(&facets, &bad), Err(ContactError::NotFinite { node: 1 }));
    // Collapsed, folded over, and without area.
    for f in [[0, 1, 4, 4], [0, 1, 3, 4], [0, 1, 2, 1]] {
        assert!(matches!(build(&[facets[1], f], &q), Err(ContactError::DegenerateFacet { facet: 1, .. })), "{f:?}");
    }

    let a = surface(&facets[..1], &q);
    let b = surface(&facets[1..], &q);
    assert_eq!(a.check_disjoint(&b), Err(ContactError::SharedNode { node: 1 }));
    let (_, mut far) = sheet(2, 1, |u, v| [u, v, 5.0]);
    let mut both = q.clone();
    both.append(&mut far);
    assert_eq!(a.check_disjoint(&surface(&[[6, 7, 10, 9]], &both)), Ok(()));
}

#[test]
fn non_manifold_edges_are_reported_and_end_the_surface() {
    // Two cubes that share only an edge: four facets meet there.
    let (facets, q) = voxels(&[[0, 0, 0], [1, 1, 0]]);
    let s = surface(&facets, &q);
    assert_eq!(s.non_manifold_edges().len(), 1);
    assert_eq!(s.non_manifold_edges()[0].facets.len(), 4);
    assert_eq!(s.boundary_edge_count(), 4);
    // Orientations that disagree.
    let (mut facets, q) = sheet(2, 1, |u, v| [u, v, 0.0]);
    facets[1].reverse();
    let s = surface(&facets, &q);
    assert_eq!(s.non_manifold_edges()[0].nodes, [1, 4]);
    assert_eq!(s.neighbour(0, 1), None);
}

#[test]
fn options_are_validated() {
    let (facets, q) = sheet(1, 1, |u, v| [u, v, 0.0]);
    let s = surface(&facets, &q);
    let good = SearchOptions::default();
    for (name, options) in [
        ("overhang", SearchOptions { overhang: -1.0, ..good }),
        ("hysteresis", SearchOptions { hysteresis: f64::NAN, ..good }),
        ("depth_limit", SearchOptions { depth_limit: 0.0, ..good }),
        ("opposing_cosine", SearchOptions { opposing_cosine: 2.0, ..good }),
    ] {
        let error = MasterSearch::new(s.clone(), &q, options).expect_err(name);
        assert!(matches!(error, ContactError::OptionOutOfRange { option, .. } if option == name), "{error}");
    }
    assert!(matches!(MasterSearch::new(s, &q[..6], good), Err(ContactError::MissingNode { .. })));
}
