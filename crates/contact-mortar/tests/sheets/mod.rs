//! Two sheets with a random warp, and what the tests of contact need of them.
#![allow(dead_code, reason = "each test uses a part")]

use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use stoss_contact_mortar::segmentation::Provenance;
use stoss_contact_mortar::{Factors, MortarContact, MortarOptions, MultiplierSpace};
use stoss_reference_element::{FaceKind, FaceNodes, FacePiece};
use stoss_term::{At, GradientRule, Local, StepConfiguration, StepContext, Term};
use stoss_testkit::meshes::Mesh;

pub const SLAVE: usize = 9;
pub const NODES: usize = 25;

/// A sheet of `n x n` facets over `[0, size]^2`, numbered from `first`; `up`: normals along +z.
pub fn sheet(n: usize, first: u32, up: bool) -> Vec<[u32; 4]> {
    let at = |i: usize, j: usize| first + (j * (n + 1) + i) as u32;
    let facets = (0..n * n).map(|f| (f % n, f / n)).map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if up { [a, b, c, d] } else { [a, d, c, b] }
    });
    facets.collect()
}

/// Slave: two by two facets on top of a master of three by three, turned, shifted so that they overlap in part only.
pub fn base() -> Vec<f64> {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.3);
    let mut q = Vec::new();
    for k in 0..SLAVE {
        let x = turn * Vector3::new((k % 3) as f64 * 0.9, (k / 3) as f64 * 0.8, 0.0) + Vector3::new(0.55, 0.37, 1.05);
        q.extend(x.iter());
    }
    for k in 0..16 {
        q.extend([(k % 4) as f64 * 0.7, (k / 4) as f64 * 0.72, 1.0]);
    }
    q
}

pub fn moved(d: &[f64]) -> Vec<f64> {
    base().iter().zip(d).map(|(x, d)| x + d).collect()
}

/// What a sheet is made of. Of a quadratic one two by two facets are faces, the others are quadrilaterals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetKind {
    Quads,
    Triangles,
    Mixed,
    Tri6,
    Quad8,
    Quad9,
}

impl SheetKind {
    pub const ALL: [Self; 6] = [Self::Quads, Self::Triangles, Self::Mixed, Self::Tri6, Self::Quad8, Self::Quad9];

    /// All pairs of surfaces.
    pub fn pairs() -> impl Iterator<Item = [Self; 2]> {
        Self::ALL.into_iter().flat_map(|slave| Self::ALL.map(|master| [slave, master]))
    }

    /// Facets of the slave (`side` 0) or of the master.
    pub fn pieces(self, side: usize) -> Vec<FacePiece> {
        let (n, first, up) = [(2, 0, false), (3, SLAVE as u32, true)][side];
        let quads = sheet(n, first, up);
        let linear = |mesh: Mesh| mesh.of(&quads).into_iter().map(FacePiece::from).collect();
        let (kind, faces): (FaceKind, &[&[[usize; 2]]]) = match self {
            Self::Quads => return linear(Mesh::Quads),
            Self::Triangles => return linear(Mesh::Triangles),
            Self::Mixed => return linear(Mesh::Mixed),
            Self::Tri6 => (
                FaceKind::Tri6,
                &[&[[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]], &[[0, 0], [2, 2], [0, 2], [1, 1], [1, 2], [0, 1]]],
            ),
            Self::Quad8 => (FaceKind::Quad8, &[&GRID]),
            Self::Quad9 => (FaceKind::Quad9, &[&GRID]),
        };
        let at = |[i, j]: [usize; 2]| first + if up { j * (n + 1) + i } else { i * (n + 1) + j } as u32;
        let face =
            |places: &&[[usize; 2]]| FacePiece::of_face(FaceNodes::from_fn(kind, |k| at(places[k])), Some(at([1, 1])));
        let rest = (0..n * n).filter(|f| f % n > 1 || f / n > 1).map(|f| FacePiece::from(quads[f]));
        faces.iter().flat_map(face).chain(rest).collect()
    }
}

const GRID: [[usize; 2]; 9] = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]];

/// Surfaces of both sides.
pub fn surfaces() -> impl Strategy<Value = [SheetKind; 2]> {
    prop::sample::select(SheetKind::pairs().collect::<Vec<_>>())
}

pub fn method([slave, master]: [SheetKind; 2], options: MortarOptions) -> MortarContact {
    MortarContact::new("test", &slave.pieces(0), &master.pieces(1), &base(), options).unwrap()
}

pub fn options(dual: bool) -> MortarOptions {
    MortarOptions {
        space: if dual { MultiplierSpace::Centred } else { MultiplierSpace::Standard },
        ..MortarOptions::default()
    }
}

/// Factors of the gap: none, those of smooth surfaces, those of surfaces with sharp edges.
pub fn factors(kind: usize) -> Factors {
    match kind {
        0 => Factors::NONE,
        1 => Factors { facing: true, deepest: f64::INFINITY, nearness: 0.0 },
        _ => Factors { facing: true, deepest: 0.4, nearness: 12.0 },
    }
}

/// Residual and tangent in all coordinates and pressures, then all auxiliaries.
pub struct Global {
    pub residual: Vec<f64>,
    pub tangent: Vec<f64>,
}

pub const ALL: usize = 3 * NODES + SLAVE;

pub fn assemble(method: &MortarContact, step: StepConfiguration<'_>, p: &[f64], active: &[bool]) -> Global {
    assemble_with(method, step, p, &[], active)
}

pub fn assemble_with(
    method: &MortarContact,
    step: StepConfiguration<'_>,
    p: &[f64],
    auxiliaries: &[f64],
    active: &[bool],
) -> Global {
    gather(method, &step.at(p, active).with_auxiliaries(auxiliaries), true)
}

/// Residual alone, at what the method followed without derivatives.
pub fn residual_of(method: &MortarContact, step: StepConfiguration<'_>, p: &[f64], active: &[bool]) -> Vec<f64> {
    gather(method, &step.at(p, active), false).residual
}

fn gather(method: &MortarContact, at: &At<'_>, want_tangent: bool) -> Global {
    let n = ALL + at.auxiliaries.len();
    let mut out = Global { residual: vec![0.0; n], tangent: vec![0.0; if want_tangent { n * n } else { 0 }] };
    method
        .assemble(at, want_tangent, &mut |local: &Local| {
            let mut index: Vec<usize> =
                local.nodes.iter().flat_map(|&n| (0..3).map(move |i| 3 * n as usize + i)).collect();
            index.extend(local.slots.iter().map(|&s| 3 * NODES + s as usize));
            let further = local.auxiliaries;
            index.extend(local.slots.iter().flat_map(|&s| (0..further).map(move |k| ALL + further * s as usize + k)));
            for (i, &row) in index.iter().enumerate() {
                out.residual[row] += local.residual[i];
                if !want_tangent {
                    continue;
                }
                for (j, &column) in index.iter().enumerate() {
                    out.tangent[row * n + column] += local.tangent[i * local.dim() + j];
                }
            }
        })
        .unwrap();
    out
}

pub fn kinds(method: &MortarContact) -> Vec<(u32, Provenance)> {
    let facets = &method.segments().unwrap().facets;
    let segments = facets.iter().flat_map(|f| &f.segments);
    segments.flat_map(|s| s.vertices().iter().map(|v| (s.master_facet, v.provenance))).collect()
}

/// Largest errors of the tangent against central differences, relative to its largest entry: of the constraint rows and of the forces. `None` if the segments
/// change their kind within the differences, or nothing is active.
pub fn tangent_errors(
    method: &mut MortarContact,
    rule: GradientRule,
    q_n: &[f64],
    q: &[f64],
    p: &[f64],
) -> Option<[f64; 2]> {
    let h = 1e-6;
    let active: Vec<bool> = p.iter().map(|p| *p != 0.0).collect();
    let rates = rule != GradientRule::EndPoint;
    method.begin(&StepContext { reach: 0.1, rates, ..StepContext::new(q_n, rule, 0.1) }).unwrap();
    method.renew(&At::end(q, &[], &active), true).unwrap();
    let (exact, kind) = (assemble(method, StepConfiguration { q_n, q_np1: q, rule }, p, &active), kinds(method));
    let mut at = |x: &[f64], p: &[f64]| {
        method.renew(&At::end(x, &[], &active), false).unwrap();
        (residual_of(method, StepConfiguration { q_n, q_np1: x, rule }, p, &active), kinds(method))
    };
    let size = exact.tangent.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let mut worst = [0.0_f64; 2];
    for column in 0..ALL {
        let ends = [1.0, -1.0].map(|sign| {
            let (mut x, mut p) = (q.to_vec(), p.to_vec());
            if column < 3 * NODES {
                x[column] += sign * h;
            } else if active[column - 3 * NODES] {
                p[column - 3 * NODES] += sign * h;
            }
            at(&x, &p)
        });
        if ends.iter().any(|e| e.1 != kind) {
            return None;
        }
        for row in 0..ALL {
            let difference = (ends[0].0[row] - ends[1].0[row]) / (2.0 * h);
            let which = usize::from(row < 3 * NODES && column < 3 * NODES);
            worst[which] = worst[which].max((difference - exact.tangent[row * ALL + column]).abs());
        }
    }
    (size > 0.0).then_some(worst.map(|w| w / size))
}

/// Resultant and moment about `x` of the forces in a residual.
pub fn resultants(residual: &[f64], x: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
    let v = |a: &[f64], k: usize| Vector3::new(a[3 * k], a[3 * k + 1], a[3 * k + 2]);
    let force = (0..NODES).map(|k| v(residual, k)).sum();
    let moment = (0..NODES).map(|k| v(x, k).cross(&v(residual, k))).sum();
    (force, moment)
}

pub fn warp() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-0.12f64..0.12, 3 * NODES)
}

pub fn pressures() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![1 => Just(0.0), 3 => 0.3f64..2.0], SLAVE)
}
