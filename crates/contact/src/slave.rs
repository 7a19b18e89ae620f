//! Which of two surfaces becomes the slave, and how deep a curved master sinks in between its nodes (theory/mortar#slave).

use crate::shape::{Curvature, Vector, curvature, dot, facet_area_vector, facets, finer_side, place, unit};
use std::fmt;
use stoss_reference_element::{FacePiece, FacetNodes};

/// Depths of less than this part of a facet are not worth a word.
const WORTH: f64 = 0.03;
/// Depths that differ by less than this part are alike.
const ALIKE: f64 = 0.05;

/// Mean length of facets in their planes along a direction.
fn length(facets: &[FacetNodes], along: Vector, reference: &[f64]) -> f64 {
    let of = |facet: &FacetNodes| {
        let normal = unit(facet_area_vector(facet, reference));
        let across = dot(along, normal);
        let along = unit(std::array::from_fn(|i| along[i] - across * normal[i]));
        let places = facet.iter().map(|&node| dot(place(node, reference), along));
        let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        high - low
    };
    facets.iter().map(of).sum::<f64>() / facets.len().max(1) as f64
}

/// Part of the slave that is kept out of the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptOut {
    /// Nodes: between them the master comes in by the whole height of its arch.
    Nodes,
    /// Weighted means around the nodes of the slave.
    Means,
    /// Weighted means with dual multipliers, which reach half as far.
    DualMeans,
}

/// A slave on its master.
#[derive(Clone, Copy, Debug)]
pub struct Sinking {
    /// `kappa h^2 / 12`: by so much the mean over a slave facet is off, a length.
    pub depth: f64,
    /// Length of slave facets along the curvature.
    pub length: f64,
    /// Radius of the master, a length.
    pub radius: f64,
}

impl Sinking {
    /// The sinking if a side is the slave of the other. `reference`: positions, `3 * nodes` lengths.
    pub fn of(slave: &[FacePiece], master: &[FacePiece], reference: &[f64]) -> Self {
        let [slave, master] = [slave, master].map(facets);
        let Curvature { round, along, .. } = curvature(&master, &slave, reference);
        // A slave that is hollow where the master is round lies on it.
        let curvature = (round + curvature(&slave, &master, reference).hollow).max(0.0);
        let length = length(&slave, along, reference);
        Self { depth: curvature * length * length / 12.0, length, radius: 1.0 / curvature }
    }

    /// Which of two sides is the better slave, if that makes a difference.
    pub fn better(sides: &[Self; 2]) -> Option<usize> {
        let [a, b] = sides;
        let worth = a.depth > WORTH * a.length || b.depth > WORTH * b.length;
        let differ = (a.depth - b.depth).abs() > ALIKE * a.depth.max(b.depth);
        (worth && differ).then_some(usize::from(b.depth < a.depth))
    }

    /// Depth to which the master may sink in (a length), if that is not small against a facet.
    pub fn by(&self, kept_out: KeptOut) -> Option<f64> {
        let part: f64 = match kept_out {
            KeptOut::Nodes => 1.5,
            KeptOut::Means => 1.0,
            KeptOut::DualMeans => 0.5,
        };
        (part.min(1.0) * self.depth > WORTH * self.length).then_some(part * self.depth)
    }
}

/// One of two surfaces of which the slave is to be chosen.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'a> {
    /// Linear facets; none of a beam or string.
    pub facets: &'a [FacetNodes],
    /// The pieces of the faces.
    pub pieces: &'a [FacePiece],
    /// Whether all components of all nodes are prescribed where the contact first acts.
    pub is_prescribed: bool,
    /// Young's modulus of its body at small strains; infinite if it is rigid.
    pub young: f64,
}

/// Why a side is the slave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SlaveReason {
    /// The side is a line.
    IsLine,
    /// The motion of the other side is prescribed.
    OtherIsPrescribed,
    /// The other side is rigid.
    OtherIsRigid,
    /// The other side sinks in less between its nodes: by these two depths, the chosen one first, lengths.
    SinksLess([f64; 2]),
    /// The facets of the side are smaller.
    Finer,
    /// The body of the side is softer.
    Softer,
    /// The sides differ in nothing: the first one is the slave.
    Alike,
}

impl fmt::Display for SlaveReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IsLine => f.write_str("it has no facets"),
            Self::OtherIsPrescribed => f.write_str("the other one is prescribed"),
            Self::OtherIsRigid => f.write_str("the other one is rigid"),
            Self::SinksLess([least, most]) => {
                write!(f, "the other one sinks in by {least:.3}, where it would by {most:.3}")
            }
            Self::Finer => f.write_str("finer"),
            Self::Softer => f.write_str("softer"),
            Self::Alike => f.write_str("both are alike"),
        }
    }
}

/// Which of two sides becomes the slave, and why: a beam or string, one whose motion is not prescribed where the contact first acts, the one that is not rigid, the one between whose nodes the other
/// sinks in less, the finer one by the mean area of its facets, the softer one by Young's modulus. `reference`: positions, `3 * nodes` lengths.
pub fn choose_slave(sides: &[Candidate<'_>; 2], reference: &[f64]) -> (usize, SlaveReason) {
    let [a, b] = sides;
    if let Some(line) = sides.iter().position(|side| side.facets.is_empty()) {
        return (line, SlaveReason::IsLine);
    }
    if a.is_prescribed != b.is_prescribed {
        return (usize::from(a.is_prescribed), SlaveReason::OtherIsPrescribed);
    }
    if a.young.is_infinite() != b.young.is_infinite() {
        return (usize::from(a.young.is_infinite()), SlaveReason::OtherIsRigid);
    }
    let sinks = [Sinking::of(a.pieces, b.pieces, reference), Sinking::of(b.pieces, a.pieces, reference)];
    if let Some(better) = Sinking::better(&sinks) {
        return (better, SlaveReason::SinksLess([better, 1 - better].map(|k| sinks[k].depth)));
    }
    if let Some(finer) = finer_side([a.facets, b.facets], reference) {
        return (finer, SlaveReason::Finer);
    }
    match a.young.total_cmp(&b.young) {
        std::cmp::Ordering::Less => (0, SlaveReason::Softer),
        std::cmp::Ordering::Greater => (1, SlaveReason::Softer),
        std::cmp::Ordering::Equal => (0, SlaveReason::Alike),
    }
}
