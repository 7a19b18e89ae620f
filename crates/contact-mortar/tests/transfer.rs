//! Transfer of fields, multiplier spaces, coverage of surfaces, derivatives of the integrals.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use proptest::prelude::*;
use stoss_contact::ContactSurface;
use stoss_contact_mortar::segmentation::{GapRange, LOCAL, MASTER, SlaveFrame, segment_facet, segment_pair};
use stoss_contact_mortar::*;
use stoss_reference_element::{MAX_NODES, Nodal};
use stoss_testkit::meshes::{Mesh, meshes};

/// Slave grid `n x n` over `[-1, 1]^2`, outward normal up, and master grid `m x m` over `[-r, r]^2` above it, outward
/// normal down.
struct Pair {
    slave: ContactSurface,
    master: ContactSurface,
    q: Vec<f64>,
}

fn grid(n: usize, r: f64, first: u32, up: bool) -> (Vec<[u32; 4]>, Vec<Vector3<f64>>) {
    let h = 2.0 * r / n as f64;
    let mut x = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            x.push(Vector3::new(-r + i as f64 * h, -r + j as f64 * h, 0.0));
        }
    }
    let mut facets = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let k = first + (j * (n + 1) + i) as u32;
            let row = n as u32 + 1;
            facets.push(if up { [k, k + 1, k + row + 1, k + row] } else { [k, k + row, k + row + 1, k + 1] });
        }
    }
    (facets, x)
}

/// `place(side, node, x)` moves the nodes; side 0 is the slave.
fn pair(n: usize, m: usize, r: f64, place: impl FnMut(usize, usize, Vector3<f64>) -> Vector3<f64>) -> Pair {
    pair_of(Mesh::PAIRS[0], n, m, r, place)
}

fn pair_of(
    meshes: [Mesh; 2],
    n: usize,
    m: usize,
    r: f64,
    mut place: impl FnMut(usize, usize, Vector3<f64>) -> Vector3<f64>,
) -> Pair {
    let (sf, sx) = grid(n, 1.0, 0, true);
    let (mf, mx) = grid(m, r, sx.len() as u32, false);
    let moved: Vec<_> = [sx, mx]
        .into_iter()
        .enumerate()
        .flat_map(|(side, x)| x.into_iter().enumerate().map(|(k, x)| (side, k, x)).collect::<Vec<_>>())
        .map(|(side, k, x)| place(side, k, x))
        .collect();
    let q: Vec<f64> = moved.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
    Pair {
        slave: ContactSurface::new("slave", &meshes[0].of(&sf), &q).unwrap(),
        master: ContactSurface::new("master", &meshes[1].of(&mf), &q).unwrap(),
        q,
    }
}

impl Pair {
    fn matrices(&self, space: MultiplierSpace) -> MortarMatrices {
        let s = segment_surfaces(&self.slave, &self.master, &self.q, GapRange::ALL).unwrap();
        MortarMatrices::assemble(&self.slave, &self.master, [&Faces::default(); 2], &self.q, &s, space)
    }

    /// `D^-1 M` applied to the nodal values of a field; slave nodes without support are left out (their row is the
    /// identity).
    fn transfer(&self, m: &MortarMatrices, field: impl Fn(Vector3<f64>) -> f64) -> (DVector<f64>, DVector<f64>) {
        let at = |node: u32| {
            let k = 3 * node as usize;
            field(Vector3::new(self.q[k], self.q[k + 1], self.q[k + 2]))
        };
        let n = m.slave.len();
        let mut d = DMatrix::zeros(n, n);
        let mut f = DVector::zeros(n);
        let expected = DVector::from_iterator(n, self.slave.nodes().iter().map(|&k| at(k)));
        for a in 0..n {
            if m.weights[a] == 0.0 {
                d[(a, a)] = 1.0;
                f[a] = expected[a];
            }
            for &(j, v) in &m.slave[a] {
                d[(a, j as usize)] += v;
            }
            for &(k, v) in &m.master[a] {
                f[a] += v * at(self.master.nodes()[k as usize]);
            }
        }
        (d.lu().solve(&f).unwrap(), expected)
    }
}

const SPACES: [MultiplierSpace; 2] = [MultiplierSpace::Standard, MultiplierSpace::Dual];

fn moves() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec(prop::array::uniform3(-0.2f64..0.2), 130)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn constants_pass_between_curved_surfaces(
        meshes in meshes(), n in 1usize..6, m in 1usize..6, d in moves(), shift in -1.0f64..1.0, r in 0.6f64..1.5,
    ) {
        let curved = |r: f64, shift: f64| {
            pair_of(meshes, n, m, r, |side, k, x| {
                let h = if side == 0 { 2.0 / n as f64 } else { 2.0 * r / m as f64 };
                let d = Vector3::from(d[k + 36 * side]) * h;
                let shift = if side == 1 { Vector3::new(shift, 0.0, 0.05) } else { Vector3::zeros() };
                x + d + Vector3::new(0.0, 0.0, 0.1 * x.x * x.x) + shift
            })
        };
        // All of the slave lies opposite.
        let covered = curved(3.2, 0.0);
        for space in SPACES {
            let (got, expected) = covered.transfer(&covered.matrices(space), |_| 1.0);
            prop_assert!((got - expected).amax() < 1e-12, "{space:?}");
        }
        // Partly covered in general.
        let p = curved(r, shift);
        let [standard, dual] = SPACES.map(|space| p.matrices(space));
        for matrices in [&standard, &dual] {
            prop_assert!(matrices.imbalance() < 1e-13, "{}", matrices.imbalance());
        }
        // Diagonal entries are the row sums of the other side: that they are right as well is another matter. Both spaces have the integrals of the shape
        // functions as their weights, the dual one to round-off times the inverse of the smallest eigenvalue that it allows, 1e-7.
        let largest = standard.weights.iter().fold(f64::MIN_POSITIVE, |m: f64, w| m.max(*w));
        let apart = standard.weights.iter().zip(&dual.weights).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        prop_assert!(apart < 2e-9 * largest, "{}", apart / largest);
        let s = segment_surfaces(&p.slave, &p.master, &p.q, GapRange::ALL).unwrap();
        for extent in [CheckExtent::Near, CheckExtent::Everything] {
            let report = s.check(&p.master, &p.q, extent).unwrap();
            prop_assert!(report.faults.is_empty(), "{report:?}");
        }
    }

    #[test]
    fn linear_fields_pass_between_flat_surfaces(
        meshes in meshes(), n in 1usize..6, m in 1usize..6, d in moves(), c in prop::array::uniform3(-1.0f64..1.0),
        turn in prop::array::uniform3(-2.0f64..2.0),
    ) {
        let turn = Rotation3::from_scaled_axis(Vector3::from(turn));
        let p = pair_of(meshes, n, m, 1.0, |side, k, x| {
            let h = 2.0 / if side == 0 { n } else { m } as f64;
            let mut d = Vector3::from(d[k + 36 * side]) * h;
            d.z = 0.0;
            // The rims agree; every node moves along its own rim.
            if x.x.abs() > 0.999 { d.x = 0.0 }
            if x.y.abs() > 0.999 { d.y = 0.0 }
            turn * (x + d)
        });
        let slope = Vector3::from(c);
        for space in SPACES {
            let matrices = p.matrices(space);
            // Dual functions are only as biorthogonal as the rule integrates the mass matrix that they are made
            // from: that is the same one.
            let (got, expected) = p.transfer(&matrices, |x| 0.3 + slope.dot(&x));
            let largest = expected.amax().max(f64::MIN_POSITIVE);
            prop_assert!((got - expected).amax() < 1e-11 * largest, "{space:?}");
        }
    }

    #[test]
    fn dual_functions_are_biorthogonal_on_partly_covered_facets(
        meshes in meshes(), d in prop::collection::vec(prop::array::uniform2(-0.3f64..0.3), 4),
        shift in prop::array::uniform2(-1.5f64..1.5),
    ) {
        let p = pair_of(meshes, 1, 1, 1.0, |side, k, x| {
            if side == 0 { x + Vector3::new(d[k][0], d[k][1], 0.0) } else { x + Vector3::new(shift[0], shift[1], 0.1) }
        });
        let s = segment_surfaces(&p.slave, &p.master, &p.q, GapRange::ALL).unwrap();
        let found = &s.facets[0];
        let corners = |f| p.master.patch(f, &p.q).corners;
        let integrals = facet_integrals(found, corners, None, &Faces::default(), &Factors::NONE);
        let basis = MultiplierBasis::new(MultiplierSpace::Dual, &integrals);
        let block = basis.slave_block(&integrals);
        let mut direct = [[0.0; MAX_NODES]; MAX_NODES];
        for segment in &found.segments {
            for_each_point(segment, &found.frame, &corners(segment.master_facet), |g| {
                for (row, phi) in direct.iter_mut().zip(basis.values(&g.slave_shape)) {
                    for (entry, n) in row.iter_mut().zip(g.slave_shape) {
                        *entry += g.weight * phi * n;
                    }
                }
            });
        }
        if !basis.lumped {
            let nodes = integrals.kind.node_count();
            for a in 0..nodes {
                for j in 0..nodes {
                    let size = integrals.shape[a].max(integrals.shape[j]);
                    let block = |a: usize, j: usize| block.at(a, j);
                    prop_assert!((direct[a][j] - block(a, j)).abs() < 1e-7 * size);
                    prop_assert!(a == j || block(a, j) == 0.0);
                }
                prop_assert!((block.at(a, a) - integrals.shape[a]).abs() < 1e-7 * integrals.shape[a]);
            }
        }
        prop_assert!(!basis.lumped || integrals.covered < 0.05, "{}", integrals.covered);
    }

    #[test]
    fn derivatives_of_the_integrals(
        meshes in meshes(), d in prop::collection::vec(prop::array::uniform3(-0.3f64..0.3), 8), angle in 0.1f64..0.7,
        whole in any::<bool>(),
    ) {
        check_derivatives(meshes, &d, angle, whole)?;
    }
}

/// Derivatives of all integrals of one pair of facets against differences, where the segments keep their kind.
fn check_derivatives(meshes: [Mesh; 2], d: &[[f64; 3]], angle: f64, whole: bool) -> Result<(), TestCaseError> {
    let factors = if whole { Factors::NONE } else { Factors { facing: true, deepest: 0.6, nearness: 6.0 } };
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    let c = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let x: Vec<Vector3<f64>> = (0..8)
        .map(|k| {
            let order = [0, 1, 2, 3, 0, 3, 2, 1][k];
            let x = Vector3::new(c[order][0], c[order][1], if k < 4 { 0.0 } else { 0.2 });
            (if k < 4 { x } else { turn * x }) + Vector3::from(d[k])
        })
        .collect();
    // A triangle has the first three of the four.
    let corners = |side: usize, x: &[Vector3<f64>]| -> Nodal<Vector3<f64>> {
        let x: [Vector3<f64>; 4] = std::array::from_fn(|k| x[4 * side + k]);
        if meshes[side] == Mesh::Triangles { [x[0], x[1], x[2]].into() } else { x.into() }
    };
    let integrate = |x: &[Vector3<f64>]| {
        let (s, m) = (corners(0, x), corners(1, x));
        let facet = segmentation::MasterFacet { id: 0, nodes: Nodal::from_fn(m.kind(), |k| k as u32), corners: m };
        let found = segment_facet(s, &[facet], GapRange::ALL).unwrap();
        let kinds: Vec<_> = found.segments.iter().flat_map(|s| s.vertices().iter().map(|v| v.provenance)).collect();
        (facet_integrals(&found, |_| m, None, &Faces::default(), &factors), kinds)
    };
    let (base, kinds) = integrate(&x);
    let (s, m) = (corners(0, &x), corners(1, &x));
    let frame = SlaveFrame::new(s).unwrap();
    let mut segments = Vec::new();
    segment_pair(&frame, 0, &m, &mut segments).unwrap();
    let mut exact = PairDerivatives::ZERO;
    for segment in &segments {
        pair_derivatives(segment, &frame, &m, [None; 2], &factors, &mut exact);
    }
    let basis = MultiplierBasis::new(MultiplierSpace::Dual, &base);
    // Where edges cross at small angles derivatives change within 1e-4 of an edge: of fourth order, the difference does not see it.
    let h = 5e-7;
    for k in 0..LOCAL {
        let moved = [1.0, -1.0, 2.0, -2.0].map(|d| {
            let mut y = x.clone();
            y[k / 3][k % 3] += d * h;
            integrate(&y)
        });
        if kinds.is_empty() || moved.iter().any(|(_, moved)| *moved != kinds) {
            continue;
        }
        let difference = |of: &dyn Fn(&FacetIntegrals) -> f64| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|at| of(&moved[at].0));
            (8.0 * (a - b) - (c - d)) / (12.0 * h)
        };
        let close = |d: f64, of: &dyn Fn(&FacetIntegrals) -> f64| (d - difference(of)).abs() < 2e-7 * (1.0 + d.abs());
        for i in 0..4 {
            prop_assert!(close(exact.shape[i][k], &|of| of.shape[i]), "{i} {k}");
            for j in 0..4 {
                prop_assert!(close(exact.mass[i][j][k], &|of| of.mass[i][j]), "{i} {j} {k}");
                prop_assert!(close(exact.coupling[i][j][k], &|of| of.pairs[0].coupling[i][j]), "{i} {j} {k}");
            }
        }
        // Coefficients of the dual functions.
        if base.covered > 0.3 {
            let dc = basis.coefficient_variation(&exact.shape.map(|s| s[k]), &exact.mass.map(|r| r.map(|e| e[k])));
            for i in 0..4 {
                for j in 0..4 {
                    let size = dc[i][j].abs().max(basis.coefficients[i][j].abs());
                    let difference =
                        difference(&|of| MultiplierBasis::new(MultiplierSpace::Dual, of).coefficients[i][j]);
                    prop_assert!((dc[i][j] - difference).abs() < 1e-5 * (1.0 + size) * (1.0 + size));
                }
            }
        }
    }
    Ok(())
}

#[test]
fn derivatives_where_edges_cross_at_a_small_angle() {
    let d = [
        [-0.04769916487498542, 0.0, -0.29476244203808816],
        [-0.14259819006347063, 0.013450239877030383, 0.23042826949825881],
        [0.006630192993567974, 0.264020595751431, 0.06837924390674234],
        [-0.12051762239547406, 0.275817139454748, 0.13976847263545775],
        [0.0; 3],
        [0.0; 3],
        [0.20024491899486244, 0.22119359048014683, 0.11175647237456644],
        [-0.28182149152419494, 0.058362023851022043, -0.1621825433062771],
    ];
    check_derivatives([Mesh::Quads; 2], &d, 0.19438048400434121, true).unwrap();
}

#[test]
fn row_sums_of_a_covered_flat_surface_are_nodal_areas() {
    for (meshes, space) in Mesh::PAIRS.into_iter().flat_map(|m| SPACES.map(|s| (m, s))) {
        let p = pair_of(meshes, 3, 5, 1.3, |side, _, x| x + Vector3::new(0.0, 0.0, 0.1 * side as f64));
        let m = p.matrices(space);
        for (w, a) in m.weights.iter().zip(p.slave.nodal_areas()) {
            assert!((w - a).abs() < 1e-14);
        }
    }
}

#[test]
fn a_constant_pressure_loads_the_master_as_it_should() {
    // Heart of the patch test: sum_A M_AK = int N_K dA, with the surfaces sheared and inclined.
    let turn = Rotation3::from_euler_angles(0.4, -0.2, 1.1);
    for (meshes, space) in Mesh::PAIRS.into_iter().flat_map(|m| SPACES.map(|s| (m, s))) {
        let sheared = |x: Vector3<f64>| turn * Vector3::new(60.0 * (x.x + 0.2 * x.y), 60.0 * x.y, 0.0);
        let p = pair_of(meshes, 3, 4, 1.0, |_, _, x| sheared(x));
        let m = p.matrices(space);
        let mut loads = vec![0.0; p.master.nodes().len()];
        for &(k, v) in m.master.iter().flatten() {
            loads[k as usize] += v;
        }
        for (load, area) in loads.iter().zip(p.master.nodal_areas()) {
            assert!((load - area).abs() < 1e-10 * area, "{space:?} {load} {area}");
        }
    }
}

#[test]
fn integrals_do_not_change_in_rigid_motion() {
    for meshes in Mesh::PAIRS {
        let p = pair_of(meshes, 1, 1, 1.0, |side, k, x| {
            x + Vector3::new(0.1 * k as f64, 0.07 * side as f64, 0.2 + 0.05 * x.x * x.y)
        });
        let (s, m) = (p.slave.patch(0, &p.q).corners, p.master.patch(0, &p.q).corners);
        let frame = SlaveFrame::new(s).unwrap();
        let mut segments = Vec::new();
        segment_pair(&frame, 0, &m, &mut segments).unwrap();
        let mut d = PairDerivatives::ZERO;
        pair_derivatives(&segments[0], &frame, &m, [None; 2], &Factors::NONE, &mut d);
        for axis in 0..3 {
            let unit = Vector3::ith(axis, 1.0);
            for motion in [|u: &Vector3<f64>, _: &Vector3<f64>| *u, |u: &Vector3<f64>, x: &Vector3<f64>| u.cross(x)] {
                let v: [Nodal<Vector3<f64>>; 2] = [s, m].map(|x| x.map(|x| motion(&unit, &x)));
                let v = |k: usize| v[k / MASTER].padded()[k % MASTER / 3][k % 3];
                for row in d.coupling.iter().chain(&d.mass).flatten().chain(&d.shape) {
                    let rate: f64 = (0..LOCAL).map(|k| row[k] * v(k)).sum();
                    assert!(rate.abs() < 1e-13, "{rate}");
                }
            }
        }
    }
}

/// The check does not believe the search: a facet of which all segments were lost is found, whatever its neighbours have.
#[test]
fn a_facet_without_segments_is_noticed() {
    let p = pair(3, 4, 1.0, |side, _, x| x + Vector3::new(0.0, 0.0, 0.1 * side as f64));
    let whole = segment_surfaces(&p.slave, &p.master, &p.q, GapRange { min: -1.0, max: 1.0 }).unwrap();
    for facet in 0..9 {
        let mut lost = whole.clone();
        lost.facets[facet].segments.clear();
        for extent in [CheckExtent::Near, CheckExtent::Everything] {
            assert!(whole.check(&p.master, &p.q, extent).unwrap().faults.is_empty());
            let report = lost.check(&p.master, &p.q, extent).unwrap();
            assert_eq!(report.faults.len(), 1);
            assert!(report.faults[0].slave_facet == facet as u32 && (report.worst - 1.0).abs() < 1e-12, "{report:?}");
        }
    }
}

#[test]
fn master_finer_by_20_and_coarser_by_20() {
    for (k, (n, m, r)) in [(2, 40, 1.0), (40, 2, 1.0), (3, 1, 20.0)].into_iter().cycle().take(15).enumerate() {
        let p = pair_of(Mesh::PAIRS[k / 3], n, m, r, |side, _, x| {
            x + Vector3::new(0.0, 0.0, 0.05 * side as f64 + 0.02 * (x.x * x.x).min(1.0))
        });
        let s = segment_surfaces(&p.slave, &p.master, &p.q, GapRange { min: -1.0, max: 1.0 }).unwrap();
        let report = s.check(&p.master, &p.q, CheckExtent::Near).unwrap();
        assert!(report.faults.is_empty());
        if r > 1.0 {
            assert!((report.covered / report.area - 1.0).abs() < 1e-12);
        }
        assert!(p.matrices(MultiplierSpace::Dual).imbalance() < 1e-13);
    }
}

#[test]
fn the_gap_range_limits_what_counts() {
    let p = pair(2, 2, 1.0, |side, _, x| x + Vector3::new(0.0, 0.0, 0.5 * side as f64));
    for (max, some) in [(0.4, false), (0.6, true)] {
        let s = segment_surfaces(&p.slave, &p.master, &p.q, GapRange { min: -0.1, max }).unwrap();
        assert_eq!(s.facets.iter().any(|f| !f.segments.is_empty()), some);
    }
    let nan = GapRange { min: f64::NAN, max: 1.0 };
    assert!(matches!(segment_surfaces(&p.slave, &p.master, &p.q, nan), Err(MortarError::Range { .. })));
}
