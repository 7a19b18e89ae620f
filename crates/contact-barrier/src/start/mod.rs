//! The skin of general contact at the start: its thickness, and surfaces that go inside where bodies touch or nearly so (theory/barrier#touch).

mod below;
mod edges;
mod fault;
mod relations;
mod rigid;

pub use edges::{THICKNESS, layer_edge};
pub use fault::{StartError, StartFault};

use crate::{Facing, Interactions, Relation, Skin, SkinFacet, check_initial};
use below::{Given, NoRoom, facets_of, inset};
use edges::{edge_of, shortest_edge};
use relations::{depth, enclosed, inside, slight};
use rigid::AffineBasis;
use std::collections::{BTreeMap, BTreeSet};
use stoss_reference_element::FacetNodes;

/// Thinnest layer that is made, in parts of the shortest edge.
pub const THINNEST: f64 = 1e-4;

/// Distance in thicknesses below which bodies touch.
const TOUCH: f64 = 0.1;

/// Gap, in parts of the edge that the thickness follows from, below which surfaces that face each other go inside, so that forces begin where the bodies touch.
const CLEARANCE: f64 = 0.25;

/// Round-off of distances of inset surfaces, relative.
const ROUND_OFF: f64 = 1e-6;

/// Overlap up to which bodies touch, in parts of the largest coordinate: what seven digits in a file leave.
const DIGITS: f64 = 2e-6;

/// Overlap up to which bodies touch, in thicknesses; the smaller of this and [`DIGITS`] counts.
const SLIGHT: f64 = 0.01;

/// Rounds of measuring the overlap of bodies that touch, by the distance of their inset surfaces.
const ROUNDS: usize = 4;

/// Modulus of the layer between bodies of which one alone goes inside, in parts of that between two that share the inset: the layer is to give back what the inset takes (theory/barrier#modulus).
pub const ONE_SIDED: f64 = 0.5;

/// The bodies that a skin is of, by the numbers that [`Interactions::body`] gives.
pub trait Bodies {
    /// Number of all bodies.
    fn count(&self) -> u32;
    /// Whether it is rigid: it has no points below its surface but by four nodes of it.
    fn is_rigid(&self, body: u32) -> bool;
    /// Facets of its whole surface, outward, also those that take no part.
    fn surface(&self, body: u32) -> Vec<FacetNodes>;
    /// Nodes and weights, of sum one, of the material point of a deformable body at `x`; where no element holds it, of the element that it is least outside of, by `beyond` in natural coordinates at most.
    fn material_point(&self, body: u32, x: [f64; 3], beyond: f64) -> Option<Vec<(u32, f64)>>;
    /// Whether a node moves with others: a vertex of the trace of a face.
    fn is_carried(&self, node: u32) -> bool;
}

/// Two bodies nearer to each other than a thickness that is given: their surfaces go inside as if they touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearer {
    /// The bodies.
    pub bodies: [u32; 2],
    /// Distance of the bodies, a length.
    pub distance: f64,
    /// The middle between the closest points.
    pub place: [f64; 3],
}

/// A skin for the start, as [`start`] makes it.
#[derive(Debug)]
pub struct Start {
    /// The skin, inset where bodies touch.
    pub skin: Skin,
    /// Thickness of the layer, a length.
    pub thickness: f64,
    /// Pairs of bodies of which one alone goes inside, by all of the thickness: their layer is to have [`ONE_SIDED`] of the modulus.
    pub one_sided: Vec<[u32; 2]>,
    /// Pairs of bodies that are nearer to each other than a thickness that is given.
    pub nearer: Vec<Nearer>,
    /// Edge that the layer is thin for, a length.
    pub edge: f64,
}

/// Two bodies whose surfaces go inside.
struct Touch {
    bodies: [u32; 2],
    /// Part of the inset that each body takes; 0 of one without an inside.
    parts: [f64; 2],
    /// Triangles of each that go inside.
    triangles: [Vec<u32>; 2],
    /// Whether these are all of both bodies.
    is_everywhere: bool,
    /// Gap at the start, a length.
    gap: f64,
    /// Distance beyond the thickness by which the surfaces go inside, because the bodies overlap by what is left of digits.
    overlap: f64,
}

/// The skin of facets at the positions `reference` (`3 * nodes`, lengths), inset where bodies touch or face each other with a small gap, and the thickness of its layer: `given`, a length, if that is there. `inner`: pairs of bodies
/// that go inside with all of their surfaces.
///
/// # Errors
/// [`StartError`] if bodies overlap, if a surface is too near to itself, or cannot go inside.
pub fn start(
    given: Option<f64>,
    bodies: &dyn Bodies,
    rules: &Interactions,
    reference: &[f64],
    facets: Vec<SkinFacet>,
    inner: &[[u32; 2]],
) -> Result<Start, StartError> {
    let is_rigid = |body: u32| bodies.is_rigid(body);
    let skin = Skin::new(facets.clone(), reference, &|_| None);
    let facing = Facing::new(&skin, rules, reference);
    let shortest = shortest_edge(&skin, rules, &is_rigid, reference, |_| true);
    let edge = edge_of(&skin, &facing, rules, &is_rigid, reference);
    let fault = |fault| StartError { fault, edge };
    let default = THICKNESS * edge;
    if let Some(thickness) = given.filter(|&thickness| thickness < THINNEST * shortest) {
        return Err(fault(StartFault::TooThin { thickness, shortest, default }));
    }
    let mut thickness = given.unwrap_or(default);
    let reach = thickness.max(CLEARANCE * edge);
    let look = check_initial(&skin, rules, reference, reach.max(2.0 * default));
    let largest = reference.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let small = (SLIGHT * thickness).min(DIGITS * largest);
    let is_slight = slight(&skin, rules, reference, small);
    let bodies_of = |facets: [u32; 2]| facets.map(|facet| rules.body(skin.facets()[facet as usize].class));
    let overlaps = |facets: [u32; 2]| !is_slight(bodies_of(facets));
    if let Some(&(facets, place)) = look.crossings.iter().find(|(facets, _)| overlaps(*facets)) {
        let [a, b] = bodies_of(facets);
        let count = look.crossings.len();
        return Err(fault(match a == b {
            true => StartFault::CrossesItself { body: a, place, count },
            false => StartFault::Cross { bodies: [a, b], place, count, depth: depth(&skin, rules, reference, [a, b]) },
        }));
    }
    if let Some((bodies, relation)) = inside(&skin, rules, reference, &is_slight) {
        return Err(fault(match depth(&skin, rules, reference, bodies) {
            Some(depth) if relation == Relation::Cross => StartFault::Overlap { bodies, depth },
            _ => StartFault::Inside { bodies },
        }));
    }
    if let Some(bodies) = enclosed(bodies, rules, reference) {
        return Err(fault(StartFault::Inside { bodies }));
    }
    let itself = look.nearest.iter().filter(|([a, b], _)| a == b);
    let itself = itself.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
    if let Some(([body, _], nearest)) = itself {
        if given.is_none() {
            thickness = thickness.min(0.5 * nearest.distance);
        }
        if nearest.distance <= thickness || thickness < THINNEST * shortest {
            return Err(fault(StartFault::NearItself {
                body: *body,
                distance: nearest.distance,
                place: nearest.place,
                may_be_thinner: nearest.distance > 2.0 * THINNEST * shortest,
            }));
        }
    }
    let between: Vec<_> = look.nearest.iter().filter(|([a, b], n)| a != b && n.distance < reach).collect();
    // Bodies without points below the surface.
    let mut bases: BTreeMap<u32, Option<AffineBasis>> = BTreeMap::new();
    let inner: BTreeSet<[u32; 2]> = inner.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    for &body in between.iter().flat_map(|(pair, _)| *pair).chain(inner.iter().flatten()) {
        if bodies.is_rigid(body) {
            let basis = || AffineBasis::of(&facets_of(&facets, rules, body), reference);
            bases.entry(body).or_insert_with(basis);
        }
    }
    let is_flat = |body: u32| bases.get(&body).is_some_and(Option::is_none);
    // Two that are near each other but do not touch get a thinner layer, which costs nothing but smaller steps at contact.
    if given.is_none() {
        let apart = between.iter().filter(|(pair, _)| pair.iter().all(|&body| is_flat(body)));
        let apart = apart.map(|(_, nearest)| nearest.distance).filter(|&d| d >= TOUCH * thickness);
        thickness = apart.fold(thickness, f64::min);
    }
    // Only a thickness that the scene gives is larger than the gap of bodies that are apart without a way around it.
    let inside_gap = |d: f64| given.is_some() && d < thickness && d >= TOUCH * thickness;
    let nearer = between.iter().filter(|(_, nearest)| inside_gap(nearest.distance));
    let nearer =
        nearer.map(|(pair, nearest)| Nearer { bodies: **pair, distance: nearest.distance, place: nearest.place });
    let nearer: Vec<Nearer> = nearer.collect();
    let directly = facing.find(|_| reach, small);
    let all_of = |body: u32| (0..skin.triangles().len() as u32).filter(|&t| facing.body(t) == body).collect();
    let mut touches: Vec<Touch> = Vec::new();
    for (pair, gap) in
        between.iter().map(|(pair, nearest)| (**pair, nearest.distance)).chain(inner.iter().map(|pair| (*pair, 0.0)))
    {
        let parts = match pair.map(is_flat) {
            [false, false] => [0.5, 0.5],
            // Opposite a flat one the other body goes all of the way.
            [true, false] => [0.0, 1.0],
            [false, true] => [1.0, 0.0],
            [true, true] if gap >= thickness => continue,
            [true, true] => {
                return Err(fault(StartFault::NoInside { bodies: pair, thickness }));
            }
        };
        let [a, b] = pair;
        let near = [[a, b], [b, a]].map(|pair| directly.get(&pair).map_or_else(Vec::new, |list| facing.whole(list)));
        // A corner or an edge.
        let is_everywhere = inner.contains(&pair) || near.iter().any(Vec::is_empty);
        if is_everywhere && gap >= thickness {
            continue;
        }
        let triangles = if is_everywhere { pair.map(all_of) } else { near };
        touches.push(Touch { bodies: pair, parts, triangles, is_everywhere, gap, overlap: 0.0 });
    }
    let mut rounds = 0;
    while !touches.is_empty() {
        let mut depths = vec![0.0_f64; skin.triangles().len()];
        for Touch { triangles, parts, overlap, .. } in &touches {
            for (list, part) in triangles.iter().zip(parts) {
                for &t in list {
                    depths[t as usize] = depths[t as usize].max(part * (thickness + overlap));
                }
            }
        }
        let places = match inset(&Given { bodies, rules, reference }, &skin, &facing, &bases, &depths) {
            Ok(places) => places,
            Err(NoRoom { body, node, depth, reason }) => {
                // Bodies that do not touch have no need of it; they get a thinner layer.
                let needless = |touch: &Touch| {
                    touch.bodies.contains(&body)
                        && (touch.gap >= thickness || given.is_none() && touch.gap >= TOUCH * thickness)
                };
                let gap =
                    touches.iter().filter(|touch| needless(touch)).map(|touch| touch.gap).fold(f64::INFINITY, f64::min);
                if gap.is_finite() {
                    touches.retain(|touch| !needless(touch));
                    thickness = thickness.min(gap);
                    continue;
                }
                if widen(&mut touches, |touch| touch.bodies.contains(&body), all_of) {
                    continue;
                }
                let place = std::array::from_fn(|i| reference[3 * node as usize + i]);
                // What does not touch goes inside because of the thickness that is given.
                let touches = touches.iter().any(|t| t.bodies.contains(&body) && t.gap < TOUCH * thickness);
                return Err(fault(StartFault::NoRoom { body, place, depth, reason, touches, thickness }));
            }
        };
        let skin = Skin::new(facets.clone(), reference, &|node| places.get(&node).cloned());
        let look = check_initial(&skin, rules, reference, thickness);
        let near = || {
            let between = look.nearest.iter().filter(|([a, b], _)| a != b);
            between.filter(|(_, nearest)| nearest.distance < (1.0 - ROUND_OFF) * thickness)
        };
        if near().next().is_none() {
            let one_sided = touches.iter().filter(|touch| touch.parts.contains(&0.0)).map(|touch| touch.bodies);
            return Ok(Start { skin, thickness, one_sided: one_sided.collect(), nearer, edge });
        }
        // What only touched is farther apart by now.
        let is_known = |pair: &[u32; 2]| touches.iter().any(|touch| touch.bodies == *pair);
        let too_near = near().find(|(pair, nearest)| thickness - nearest.distance > small || !is_known(pair));
        let Some(([a, b], nearest)) = too_near else {
            for (pair, nearest) in near() {
                let of_pair = touches.iter_mut().filter(|touch| touch.bodies == *pair);
                of_pair.for_each(|touch| touch.overlap += thickness - nearest.distance);
            }
            rounds += 1;
            if rounds == ROUNDS {
                return Err(fault(StartFault::NotKept { thickness }));
            }
            continue;
        };
        // Edges and corners that touch beside what faces the other body.
        if widen(&mut touches, |touch| touch.bodies == [*a, *b], all_of) {
            continue;
        }
        let distance = Some(nearest.distance).filter(|distance| *distance >= ROUND_OFF * thickness);
        return Err(fault(StartFault::InsetTooNear { bodies: [*a, *b], place: nearest.place, distance, thickness }));
    }
    Ok(Start { skin, thickness, one_sided: Vec::new(), nearer, edge })
}

/// Lets the pairs that are `meant` go inside with all of their surfaces; whether any did not so far.
fn widen(touches: &mut [Touch], meant: impl Fn(&Touch) -> bool, all_of: impl Fn(u32) -> Vec<u32>) -> bool {
    let mut changed = false;
    for touch in touches.iter_mut().filter(|touch| !touch.is_everywhere && meant(touch)) {
        touch.triangles = touch.bodies.map(&all_of);
        touch.is_everywhere = true;
        changed = true;
    }
    changed
}
