//! Weights of one slave facet in the gap vectors of its nodes, with derivatives.

use crate::Faces;
use crate::centres::{Centres, Moments, edge_variation, image, image_of_variation, polygon_moments};
use crate::derivatives::{PairDerivatives, pair_derivatives};
use crate::faces::FaceBlock;
use crate::factors::{Facing, Factors};
use crate::integrals::{FacetIntegrals, PairIntegrals, facet_integrals};
use crate::local::{FacetMatrix, NodeMatrix, NodeVector, matrix, rows_of};
use crate::multiplier::{MultiplierBasis, MultiplierSpace, centres};
use nalgebra::{Vector2, Vector3};
use stoss_reference_element::{FacePiece, MAX_FACE_NODES, MAX_NODES, Nodal};
use stoss_segmentation::{FacetSegmentation, LOCAL, MASTER, Segment, SlaveFrame};

/// `g_A = sum_J D_AJ x1_J - sum_K M_AK x2_K` over one facet. Nodes are those of the slave's face, then those of the face of each master facet; corners are those of the
/// facet, then of each master facet. Of linear faces both are the same.
#[derive(Clone, Debug)]
pub(crate) struct FacetWeights {
    /// Master facets opposite, local numbers.
    pub masters: Vec<u32>,
    /// The first node of the slave's face, of the face of each master facet, and the number of all.
    nodes: Vec<usize>,
    /// The first corner of the slave facet, of each master facet, and the number of all.
    corners: Vec<usize>,
    /// Row `A`, then one weight a node.
    pub weights: Vec<f64>,
    /// `d weights / d x`: row `A`, node, component of the corners; empty if not asked for.
    pub derivative: Vec<f64>,
    /// The integrals of the standard functions; empty if `weights` are these but for the sign.
    pub standard: Vec<f64>,
    /// `int phi_A dA`, an area.
    pub support: [f64; MAX_NODES],
    /// `int phi_A dA` without the factors of the gap.
    pub opposite: [f64; MAX_NODES],
    /// `int phi_A N_J dA` with the functions of the facet, linear ones.
    pub moments: FacetMatrix,
}

/// Starts of runs of these lengths, and their sum.
fn starts(lengths: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut out = vec![0];
    out.extend(lengths.scan(0, |next, length| {
        *next += length;
        Some(*next)
    }));
    out
}

impl FacetWeights {
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        // cannot fail: the last entry is always there.
        self.nodes.last().copied().unwrap_or(0)
    }

    /// Number of corners.
    pub fn corner_count(&self) -> usize {
        // cannot fail, as above.
        self.corners.last().copied().unwrap_or(0)
    }
}

/// What facets are integrated with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integration {
    pub space: MultiplierSpace,
    pub factors: Factors,
}

/// Corners of a facet that hand their functions over; places where there is no corner do so.
pub(crate) type Without = [bool; MAX_NODES];

/// Functions of corners without a multiplier of their own are handed to the other corners in equal parts: the sum of all
/// functions stays one, so that constant pressures are still exact at crosspoints.
pub(crate) fn hand_over(without: Without) -> NodeMatrix {
    let keep = without.iter().filter(|&&w| !w).count();
    NodeMatrix::from_fn(|a, b| match (without[a], without[b]) {
        (true, _) => 0.0,
        (false, false) => f64::from(u8::from(a == b)),
        (false, true) => 1.0 / keep as f64,
    })
}

/// Faces behind both facets of a pair: the quadratic faces of slave and master.
struct Behind<'a> {
    slave: Option<&'a FacePiece>,
    master: &'a Faces,
}

impl Integration {
    /// Weights of a facet. Faces: that which the slave facet is a piece of, if it is quadratic, and those of the master. `without`: corners that have no multiplier.
    pub fn facet_weights(
        &self,
        found: &FacetSegmentation,
        corners: impl Fn(u32) -> Nodal<Vector3<f64>>,
        slave_face: Option<&FacePiece>,
        master_faces: &Faces,
        without: Without,
        want_derivative: bool,
    ) -> FacetWeights {
        let give = hand_over(without);
        let integrals = facet_integrals(found, &corners, slave_face, master_faces, &self.factors);
        let centres = centres(self.space, found, &corners, &self.factors);
        let basis = MultiplierBasis::with_centres(self.space, &integrals, centres.as_ref());
        let own = integrals.kind.node_count();
        let of_pairs = || integrals.pairs.iter();
        let node_count = |pair: &PairIntegrals| {
            master_faces.of(pair.master_facet).map_or(pair.master_kind.node_count(), |face| face.face_nodes().len())
        };
        let slave_nodes = slave_face.map_or(own, |face| face.face_nodes().len());
        let nodes = starts(std::iter::once(slave_nodes).chain(of_pairs().map(node_count)));
        let corner_counts = of_pairs().map(|pair| pair.master_kind.node_count());
        let first_corners = starts(std::iter::once(own).chain(corner_counts));
        let count = nodes[nodes.len() - 1];
        let rows = |slave: FaceBlock, master: &dyn Fn(&PairIntegrals) -> FaceBlock, sign: f64| {
            let mut out = vec![0.0; own * count];
            for (p, ends) in nodes.windows(2).enumerate() {
                let (block, sign) = if p == 0 { (slave, 1.0) } else { (master(&integrals.pairs[p - 1]), sign) };
                let block = block.after(&give);
                for a in 0..own {
                    for (k, node) in (ends[0]..ends[1]).enumerate() {
                        out[a * count + node] = sign * block.at(a, k);
                    }
                }
            }
            out
        };
        let slave = basis.slave_block(&integrals);
        let weights = rows(slave, &|pair| basis.master_block(pair), -1.0);
        let standard = if basis.is_diagonal() {
            rows(FaceBlock::of(&integrals.mass, integrals.face.as_ref()), &PairIntegrals::block, 1.0)
        } else {
            Vec::new()
        };
        let mut out = FacetWeights {
            masters: of_pairs().map(|p| p.master_facet).collect(),
            nodes,
            corners: first_corners,
            weights,
            derivative: Vec::new(),
            standard,
            support: (give * slave.row_sums()).into(),
            opposite: (give * NodeVector::from(integrals.opposite)).into(),
            moments: rows_of(&(give * matrix(&basis.coefficients) * matrix(&integrals.mass))),
        };
        if want_derivative {
            let behind = Behind { slave: slave_face, master: master_faces };
            let centres = centres.filter(|_| !basis.lumped);
            self.derivatives(found, corners, &behind, &integrals, (&basis, centres.as_ref()), &give, &mut out);
        }
        out
    }

    fn derivatives(
        &self,
        found: &FacetSegmentation,
        corners: impl Fn(u32) -> Nodal<Vector3<f64>>,
        behind: &Behind<'_>,
        integrals: &FacetIntegrals,
        (basis, centres): (&MultiplierBasis, Option<&Centres>),
        give: &NodeMatrix,
        out: &mut FacetWeights,
    ) {
        let (own, count) = (integrals.kind.node_count(), out.node_count());
        let columns = 3 * out.corner_count();
        out.derivative = vec![0.0; own * count * columns];
        let mut pairs = vec![PairDerivatives::ZERO; integrals.pairs.len()];
        let mut moving: Vec<[CentreVariation; LOCAL]> = match centres {
            Some(_) => vec![[CentreVariation::ZERO; LOCAL]; integrals.pairs.len()],
            None => Vec::new(),
        };
        let mut at = 0;
        for (s, segment) in found.segments.iter().enumerate() {
            // Segments of a pair are next to each other, as in `facet_integrals`.
            while out.masters[at] != segment.master_facet {
                at += 1;
            }
            let master = corners(segment.master_facet);
            let faces = [behind.slave, behind.master.of(segment.master_facet)];
            pair_derivatives(segment, &found.frame, &master, faces, &self.factors, &mut pairs[at]);
            if let Some(centres) = centres {
                let facing = self.factors.facing_of(&found.frame, &master, true);
                CentreVariation::add(centres, (s, segment), &found.frame, &master, &facing, &mut moving[at]);
            }
        }
        let c = matrix(&basis.coefficients);
        let couplings: Vec<FaceBlock> = integrals.pairs.iter().map(PairIntegrals::block).collect();
        let on_face = integrals.face.as_ref().map(|face| FaceBlock::of(&integrals.mass, Some(face)));
        let FacetWeights { nodes, corners, derivative, .. } = out;
        let facets = corners.windows(2).enumerate();
        let places = facets.flat_map(|(facet, ends)| (3 * ends[0]..3 * ends[1]).enumerate().map(move |k| (facet, k)));
        for (facet, (place, column)) in places {
            // The column of each pair that this one is: slave columns are in all pairs, a master's in its own.
            let (range, local) = if facet == 0 { (0..pairs.len(), place) } else { (facet - 1..facet, MASTER + place) };
            let (mut shape, mut mass) = ([0.0; MAX_NODES], [[0.0; MAX_NODES]; MAX_NODES]);
            let mut face_mass = [[0.0; MAX_FACE_NODES]; MAX_NODES];
            for pair in &pairs[range.clone()] {
                for i in 0..MAX_NODES {
                    shape[i] += pair.shape[i][local];
                    for j in 0..MAX_NODES {
                        mass[i][j] += pair.mass[i][j][local];
                    }
                    for of in pair.faces[0].iter() {
                        face_mass[i].iter_mut().zip(&of[i]).for_each(|(sum, of)| *sum += of[local]);
                    }
                }
            }
            let at_centres = centres.map(|centres| {
                let sum =
                    moving[range.clone()].iter().map(|of| of[local]).fold(CentreVariation::ZERO, |a, b| a.plus(&b));
                centres.variation(&sum.moments, &sum.exits)
            });
            let dc = basis.variation(&shape, &mass, at_centres.as_ref());
            let slave = if let Some(on_face) = &on_face {
                on_face.after(&dc).plus(&FaceBlock::of(&mass, Some(&face_mass)).after(&c))
            } else if basis.is_diagonal() {
                let total = dc * NodeVector::from(integrals.shape) + c * NodeVector::from(shape);
                FaceBlock::Linear(basis.slave_variation(&total, at_centres.as_ref()))
            } else {
                FaceBlock::Linear(matrix(&mass))
            };
            let mut put = |facet: usize, block: &FaceBlock, sign: f64| {
                let (start, end) = (nodes[facet], nodes[facet + 1]);
                let at = |a: usize, k: usize| (a * count + start + k) * columns + column;
                block.after(give).add_to([own, end - start], sign, at, derivative);
            };
            put(0, &slave, 1.0);
            for (p, coupling) in couplings.iter().enumerate() {
                let moves = range.contains(&p);
                if !basis.is_diagonal() && !moves {
                    continue;
                }
                let mut block = coupling.after(&dc);
                if moves {
                    block = block.plus(&pairs[p].coupling_by(local).after(&c));
                }
                put(1 + p, &block, -1.0);
            }
            // Weights add up to zero. Where edges of both sides all but lie on each other their crossing moves fast along them, and what is left of the sum would be felt as a force.
            for a in 0..own {
                let at = |k: usize| (a * count + k) * columns + column;
                let sum: f64 = (0..count).map(|k| derivative[at(k)]).sum();
                let larger = |l: usize, k: usize| if derivative[at(k)].abs() > derivative[at(l)].abs() { k } else { l };
                let largest = (nodes[1]..count).reduce(larger).unwrap_or(0);
                derivative[at(largest)] -= sum;
            }
        }
    }
}

impl PairDerivatives {
    /// Derivative of the coupling by one component.
    fn coupling_by(&self, k: usize) -> FaceBlock {
        match &self.faces[1] {
            Some(face) => FaceBlock::quadratic(|i, j| face[i][j][k]),
            None => FaceBlock::Linear(NodeMatrix::from_fn(|i, j| self.coupling[i][j][k])),
        }
    }
}

/// How what the centres of a facet are made of varies with one component of a pair.
#[derive(Clone, Copy)]
struct CentreVariation {
    moments: Moments,
    /// How far points at which rays leave move along them, in parts of the ray.
    exits: [f64; MAX_NODES],
}

impl CentreVariation {
    const ZERO: Self = Self { moments: Moments::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), exits: [0.0; MAX_NODES] };

    fn plus(&self, other: &Self) -> Self {
        Self { moments: self.moments + other.moments, exits: std::array::from_fn(|k| self.exits[k] + other.exits[k]) }
    }

    /// Adds the part of a segment, by the components of its pair.
    fn add(
        centres: &Centres,
        (number, segment): (usize, &Segment),
        frame: &SlaveFrame,
        master: &Nodal<Vector3<f64>>,
        facing: &Facing,
        out: &mut [Self; LOCAL],
    ) {
        let vertices = segment.vertices();
        let points: Vec<Vector2<f64>> = vertices.iter().map(|v| image(frame.kind(), v.slave)).collect();
        let moments = polygon_moments(&points);
        let moved = segment.vertex_derivatives(frame, master);
        for (column, out) in out.iter_mut().enumerate() {
            let of =
                |k: usize| image_of_variation(frame.kind(), [moved[k].slave[0][column], moved[k].slave[1][column]]);
            out.moments += moments * facing.derivative[column];
            for (k, &p) in points.iter().enumerate() {
                let next = (k + 1) % points.len();
                let (dp, dq) = (of(k), of(next));
                out.moments += edge_variation(p, points[next], dp, dq) * facing.value;
                for (exit, a) in centres.exits.iter().zip(&mut out.exits) {
                    if let Some(exit) = exit.filter(|exit| (exit.segment, exit.vertex) == (number, k)) {
                        *a += exit.normal.dot(&(dp * (1.0 - exit.part) + dq * exit.part));
                    }
                }
            }
        }
    }
}
