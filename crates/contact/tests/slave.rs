//! The choice of the slave, and how deep a round master sinks in between its nodes.

use stoss_contact::{Candidate, FacetNodes, KeptOut, Sinking, SlaveReason, arch, are_curved_alike, choose_slave};
use stoss_reference_element::{FaceKind, FaceNodes, FacePiece};

/// Strips of quadrilaterals along x, of the width 1, with their nodes in one array.
#[derive(Default)]
struct Strips {
    reference: Vec<f64>,
}

impl Strips {
    /// `n` facets between nodes at `x` and the height `z`; `up` is the side of their normal.
    fn strip(&mut self, n: u32, up: bool, place: impl Fn(f64) -> [f64; 2]) -> Vec<FacetNodes> {
        let first = self.reference.len() as u32 / 3;
        for k in 0..=n {
            let [x, z] = place(f64::from(k) / f64::from(n));
            [0.0, 1.0].iter().for_each(|&y| self.reference.extend([x, y, z]));
        }
        let corners = if up { [0, 2, 3, 1] } else { [0, 1, 3, 2] };
        (0..n).map(|k| FacetNodes::from(corners.map(|i| first + 2 * k + i))).collect()
    }

    /// A part of a cylinder of this radius on both sides of its top at z = 0, 0.8 radians wide.
    fn ridge(&mut self, n: u32, radius: f64) -> Vec<FacetNodes> {
        self.strip(n, true, |s| {
            let angle = 0.8 * (s - 0.5);
            [radius * angle.sin(), radius * (angle.cos() - 1.0)]
        })
    }

    fn flat(&mut self, n: u32, up: bool) -> Vec<FacetNodes> {
        self.strip(n, up, |s| [s - 0.5, 0.0])
    }
}

fn pieces(facets: &[FacetNodes]) -> Vec<FacePiece> {
    facets.iter().flat_map(|facet| FacePiece::of_face(FaceNodes::from(*facet), None)).collect()
}

/// `kappa h^2 / 12` (theory/mortar#slave): of a cylinder between the nodes of a flat slave.
#[test]
fn a_ridge_sinks_in_between_the_nodes_of_a_plane() {
    let mut strips = Strips::default();
    let (ridge, flat) = (strips.ridge(32, 2.0), strips.flat(4, false));
    let [ridge, flat] = [&ridge, &flat].map(|facets| pieces(facets));
    let sinking = Sinking::of(&flat, &ridge, &strips.reference);
    assert!((sinking.radius - 2.0).abs() < 1e-3 && (sinking.length - 0.25).abs() < 1e-12, "{sinking:?}");
    assert!((sinking.depth - 0.25 * 0.25 / 24.0).abs() < 1e-5, "{sinking:?}");
    // Nothing sinks in between the nodes of the ridge, for the plane is not round.
    assert_eq!(Sinking::of(&ridge, &flat, &strips.reference).depth, 0.0);
    // A hundredth of a facet is not worth a word.
    assert_eq!(sinking.by(KeptOut::Nodes), None);
    let deep = Sinking { depth: 0.1, length: 1.0, radius: 1.0 };
    assert_eq!(
        [KeptOut::Nodes, KeptOut::Means, KeptOut::DualMeans].map(|of| deep.by(of).unwrap()),
        [0.15000000000000002, 0.1, 0.05]
    );
}

#[test]
fn the_slave_follows_from_what_the_sides_are() {
    let mut strips = Strips::default();
    let (ridge, coarse, fine) = (strips.ridge(4, 0.5), strips.flat(2, false), strips.flat(5, false));
    let all = [&ridge, &coarse, &fine].map(|facets| pieces(facets));
    let side = |facets, pieces, is_prescribed, young| Candidate { facets, pieces, is_prescribed, young };
    let [round, coarse, fine] = [(&ridge, &all[0]), (&coarse, &all[1]), (&fine, &all[2])]
        .map(|(facets, pieces)| side(&facets[..], &pieces[..], false, 100.0));
    let choose = |a, b| choose_slave(&[a, b], &strips.reference);
    let line = Candidate { facets: &[], pieces: &[], ..fine };
    assert_eq!(choose(fine, line), (1, SlaveReason::IsLine));
    let prescribed = Candidate { is_prescribed: true, ..fine };
    assert_eq!(choose(prescribed, coarse), (1, SlaveReason::OtherIsPrescribed));
    let rigid = Candidate { young: f64::INFINITY, ..fine };
    assert_eq!(choose(rigid, coarse), (1, SlaveReason::OtherIsRigid));
    // Also of a prescribed one that is rigid.
    assert_eq!(choose(Candidate { is_prescribed: true, ..rigid }, coarse), (1, SlaveReason::OtherIsPrescribed));
    match choose(coarse, round) {
        (1, SlaveReason::SinksLess([least, most])) => assert!(least == 0.0 && most > 0.02, "{least} {most}"),
        other => panic!("{other:?}"),
    }
    assert_eq!(choose(coarse, fine), (1, SlaveReason::Finer));
    assert_eq!(choose(coarse, Candidate { young: 1.0, ..coarse }), (1, SlaveReason::Softer));
    assert_eq!(choose(coarse, coarse), (0, SlaveReason::Alike));
}

#[test]
fn a_shaft_and_its_hole_are_curved_alike_and_quadratic_faces_have_arches() {
    let mut strips = Strips::default();
    let shaft = strips.ridge(12, 1.0);
    let hole: Vec<FacetNodes> = strips.strip(9, false, |s| {
        let angle = 0.8 * (s - 0.5);
        [angle.sin(), angle.cos() - 1.0]
    });
    let flat = strips.flat(3, false);
    let [shaft, hole, flat] = [&shaft, &hole, &flat].map(|facets| pieces(facets));
    assert!(are_curved_alike([&shaft, &hole], &strips.reference));
    assert!(!are_curved_alike([&shaft, &flat], &strips.reference));
    assert_eq!(arch(&shaft, &strips.reference), 0.0);
    // One face over an angle of 0.6: 1 - cos 0.3.
    let at = |angle: f64, y: f64| [angle.sin(), y, angle.cos()];
    let places = [
        at(-0.3, 0.0),
        at(0.3, 0.0),
        at(0.3, 1.0),
        at(-0.3, 1.0),
        at(0.0, 0.0),
        at(0.3, 0.5),
        at(0.0, 1.0),
        at(-0.3, 0.5),
    ];
    let face = FaceNodes::from_fn(FaceKind::Quad8, |k| k as u32);
    let pieces: Vec<FacePiece> = FacePiece::of_face(face, None).collect();
    assert!((arch(&pieces, &places.concat()) - (1.0 - 0.3_f64.cos())).abs() < 1e-15);
}
