//! The skin of general contact: its thickness, and surfaces that go inside where bodies touch or nearly so (theory/barrier#touch).

use super::interacting::{THICKNESS, layer_edge, point, shortest_edge};
use super::rigid_inset::{Frame, fits};
use super::round::BEYOND;
use super::separate;
use super::{Placed, Problems};
use crate::scene::GeneralContact as Table;
use crate::solver::Model;
use std::collections::{BTreeMap, BTreeSet};
use stoss_contact_barrier::{Facing, Interactions, Relation, Skin, SkinFacet, check_initial, mitre};

/// Thinnest layer that is made, in parts of the shortest edge.
const THINNEST: f64 = 1e-4;

/// Distance in thicknesses below which bodies touch.
const TOUCH: f64 = 0.1;

/// Gap, in parts of the edge that the thickness follows from, below which surfaces that face each other go inside, so that forces begin where the bodies touch.
const CLEARANCE: f64 = 0.25;

/// Of distances of inset surfaces, relative.
const ROUND_OFF: f64 = 1e-6;

/// Overlap up to which bodies touch, in parts of the largest coordinate: what seven digits in a file leave.
const DIGITS: f64 = 2e-6;

/// The same in thicknesses; the smaller one counts.
const SLIGHT: f64 = 0.01;

/// Rounds of measuring the overlap of bodies that touch, by the distance of their inset surfaces.
const ROUNDS: usize = 4;

/// How far, in natural coordinates, a node of a curved element may lie outside of the element that it goes with at the rim of what goes inside: it goes along a chord of the side.
const BESIDE: f64 = 0.05;

/// What helps bodies that overlap.
const PART: &str = "move one of them, set `initial = \"separate\"`, or leave one of them out by `exclude`";

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

/// What a node that cannot go inside needs.
struct NoRoom {
    body: u32,
    node: u32,
    depth: f64,
    reason: &'static str,
}

/// What the skin is made for.
pub(super) struct Bodies<'a> {
    pub placed: &'a [Placed],
    pub model: &'a Model,
    pub rules: &'a Interactions,
}

impl Bodies<'_> {
    fn name(&self, body: u32) -> &str {
        &self.placed[body as usize].name
    }

    fn is_rigid(&self, body: u32) -> bool {
        self.placed[body as usize].mesh().is_none()
    }
}

/// What [`skin`] makes.
pub(super) struct Made {
    pub skin: Skin,
    /// Of the layer, a length.
    pub thickness: f64,
    /// Pairs of bodies of which one alone goes inside, by all of the thickness.
    pub one_sided: Vec<[u32; 2]>,
}

/// The skin, inset where bodies touch or face each other with a small gap, and the thickness of its layer. `inner`: pairs of bodies that go inside with all of their surfaces.
pub(super) fn skin(
    table: &Table,
    bodies: &Bodies<'_>,
    facets: Vec<SkinFacet>,
    inner: impl Iterator<Item = [u32; 2]>,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<Made> {
    let &Bodies { placed, model, rules } = bodies;
    let name = |body: u32| bodies.name(body);
    let mut refuse = |message: String, remedy: String| problems.add("general_contact".into(), "", message, remedy);
    let skin = Skin::new(facets.clone(), &model.reference, &|_| None);
    let facing = Facing::new(&skin, rules, &model.reference);
    let shortest = shortest_edge(&skin, rules, placed, &model.reference, |_| true);
    let edge = layer_edge(&skin, &facing, rules, placed, &model.reference);
    let default = THICKNESS * edge;
    if let Some(thickness) = table.thickness.filter(|&thickness| thickness < THINNEST * shortest) {
        let message = format!(
            "is less than {THINNEST:e} of the shortest edge, {shortest:.3e}: no step size is small enough for so thin a layer"
        );
        let remedy = format!("choose at least {:.3e}; if it is left out it is {default:.3e}", THINNEST * shortest);
        problems.add("general_contact.thickness".into(), format!("{thickness:e}"), message, remedy);
        return None;
    }
    let mut thickness = table.thickness.unwrap_or(default);
    let reach = thickness.max(CLEARANCE * edge);
    let look = check_initial(&skin, rules, &model.reference, reach.max(2.0 * default));
    let largest = model.reference.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let slight = (SLIGHT * thickness).min(DIGITS * largest);
    let is_slight = separate::slight(&skin, rules, model, slight);
    let bodies_of = |facets: [u32; 2]| facets.map(|facet| rules.body(skin.facets()[facet as usize].class));
    let overlaps = |facets: [u32; 2]| !is_slight(bodies_of(facets));
    if let Some(&(facets, place)) = look.crossings.iter().find(|(facets, _)| overlaps(*facets)) {
        let [a, b] = bodies_of(facets);
        let (what, deep, remedy) = if a == b {
            let what = format!("the surface of `{}` intersects itself", name(a));
            (what, None, "correct the mesh, or set `self = false`")
        } else {
            let what = format!("`{}` and `{}` overlap", name(a), name(b));
            (what, separate::depth(&skin, rules, model, placed, [a, b]), PART)
        };
        let deep = deep.map_or(String::new(), |deep| format!(", {deep}"));
        let (place, count) = (point(place, edge), look.crossings.len());
        refuse(format!("{what} at the start, near {place}{deep}; {count} pairs of facets cross"), remedy.into());
        return None;
    }
    if let Some(([a, b], relation)) = separate::inside(&skin, rules, model, &is_slight) {
        let (message, remedy) = match separate::depth(&skin, rules, model, placed, [a, b]) {
            Some(deep) if relation == Relation::Cross => {
                (format!("`{}` and `{}` overlap at the start, {deep}", name(a), name(b)), PART)
            }
            _ => {
                let message = format!("one of `{}` and `{}` lies inside the other at the start", name(a), name(b));
                (message, "move one of them, or leave one of them out by `exclude`")
            }
        };
        refuse(message, remedy.into());
        return None;
    }
    if let Some([a, b]) = separate::enclosed(placed, rules, model) {
        let message = format!("one of `{}` and `{}` lies inside the other at the start", name(a), name(b));
        refuse(message, "move one of them, or leave one of them out by `exclude`".into());
        return None;
    }
    let itself = look.nearest.iter().filter(|([a, b], _)| a == b);
    let itself = itself.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
    if let Some(([body, _], nearest)) = itself {
        if table.thickness.is_none() {
            thickness = thickness.min(0.5 * nearest.distance);
        }
        if nearest.distance <= thickness || thickness < THINNEST * shortest {
            let message = format!(
                "two parts of the surface of `{}` that are not adjacent are only {:.3e} apart near {}, so that the contact layer{} would act there all the time",
                name(*body),
                nearest.distance,
                point(nearest.place, edge),
                table.thickness.map_or(String::new(), |given| format!(" of the given thickness {given:.3e}"))
            );
            let remedy = if nearest.distance > 2.0 * THINNEST * shortest {
                match table.thickness {
                    Some(_) => {
                        "make `thickness` smaller than that distance, or leave it out: it then follows from it; or set `self = false`"
                    }
                    None => "correct the mesh there, or set `self = false`",
                }
            } else {
                "correct the mesh there, or set `self = false`: no layer is thin enough, as between the faces of a closed crack"
            };
            refuse(message, remedy.into());
            return None;
        }
    }
    let between: Vec<_> = look.nearest.iter().filter(|([a, b], n)| a != b && n.distance < reach).collect();
    // Bodies without points below the surface.
    let mut frames: BTreeMap<u32, Option<Frame>> = BTreeMap::new();
    let inner: BTreeSet<[u32; 2]> = inner.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    for &body in between.iter().flat_map(|(pair, _)| *pair).chain(inner.iter().flatten()) {
        if bodies.is_rigid(body) {
            let frame = || Frame::of(&facets_of(&facets, rules, body), &model.reference);
            frames.entry(body).or_insert_with(frame);
        }
    }
    let is_flat = |body: u32| frames.get(&body).is_some_and(Option::is_none);
    // Two that are near each other but do not touch get a thinner layer, which costs nothing but smaller steps at contact.
    if table.thickness.is_none() {
        let apart = between.iter().filter(|(pair, _)| pair.iter().all(|&body| is_flat(body)));
        let apart = apart.map(|(_, nearest)| nearest.distance).filter(|&d| d >= TOUCH * thickness);
        thickness = apart.fold(thickness, f64::min);
    }
    // Only a thickness that the scene gives is larger than the gap of bodies that are apart without a way around it.
    let inside_gap = |d: f64| table.thickness.is_some() && d < thickness && d >= TOUCH * thickness;
    for ([a, b], nearest) in between.iter().filter(|(_, nearest)| inside_gap(nearest.distance)) {
        warnings.push(format!(
            "general_contact: `{}` and `{}` start {:.3e} apart near {}, less than the thickness {thickness:.3e}: their surfaces are inset as if they touched, forces begin \
             where the bodies touch, and the bodies may overlap by up to the thickness; make `thickness` smaller than the gap, or leave it out",
            name(*a),
            name(*b),
            nearest.distance,
            point(nearest.place, edge)
        ));
    }
    let directly = facing.find(|_| reach, slight);
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
                let message = format!(
                    "the rigid bodies `{}` and `{}` touch at the start, and neither surface can be inset: both are flat or not closed",
                    name(pair[0]),
                    name(pair[1]),
                );
                refuse(message, format!("leave a gap of {thickness:.3e} between them"));
                return None;
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
        let places = match inset(bodies, &skin, &facing, &frames, &depths) {
            Ok(places) => places,
            Err(NoRoom { body, node, depth, reason }) => {
                // Bodies that do not touch have no need of it; they get a thinner layer.
                let needless = |touch: &Touch| {
                    touch.bodies.contains(&body)
                        && (touch.gap >= thickness || table.thickness.is_none() && touch.gap >= TOUCH * thickness)
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
                let at = std::array::from_fn(|i| model.reference[3 * node as usize + i]);
                // What does not touch goes inside because of the thickness that is given.
                let touching = touches.iter().any(|t| t.bodies.contains(&body) && t.gap < TOUCH * thickness);
                let why = match touching {
                    true => "touches another body at the start".to_owned(),
                    false => format!("is nearer to another body than the given thickness {thickness:.3e}"),
                };
                let message = format!(
                    "`{}` {why}, and its surface cannot be inset by {depth:.3e} near {}: {reason}",
                    name(body),
                    point(at, edge)
                );
                let remedy = format!(
                    "leave a gap of {thickness:.3e}, make `thickness` smaller, or leave the body out by `exclude`"
                );
                refuse(message, remedy);
                return None;
            }
        };
        let skin = Skin::new(facets.clone(), &model.reference, &|node| places.get(&node).cloned());
        let look = check_initial(&skin, rules, &model.reference, thickness);
        let near = || {
            let between = look.nearest.iter().filter(|([a, b], _)| a != b);
            between.filter(|(_, nearest)| nearest.distance < (1.0 - ROUND_OFF) * thickness)
        };
        if near().next().is_none() {
            let one_sided = touches.iter().filter(|touch| touch.parts.contains(&0.0)).map(|touch| touch.bodies);
            return Some(Made { skin, thickness, one_sided: one_sided.collect() });
        }
        // What only touched is farther apart by now.
        let is_known = |pair: &[u32; 2]| touches.iter().any(|touch| touch.bodies == *pair);
        let too_near = near().find(|(pair, nearest)| thickness - nearest.distance > slight || !is_known(pair));
        let Some(([a, b], nearest)) = too_near else {
            for (pair, nearest) in near() {
                let of_pair = touches.iter_mut().filter(|touch| touch.bodies == *pair);
                of_pair.for_each(|touch| touch.overlap += thickness - nearest.distance);
            }
            rounds += 1;
            if rounds == ROUNDS {
                let message = format!("inset surfaces of bodies that touch do not keep the thickness {thickness:.3e}");
                refuse(message, "leave a gap between the bodies".into());
                return None;
            }
            continue;
        };
        // Edges and corners that touch beside what faces the other body.
        if widen(&mut touches, |touch| touch.bodies == [*a, *b], all_of) {
            continue;
        }
        if nearest.distance < ROUND_OFF * thickness {
            let message =
                format!("`{}` and `{}` overlap at the start, near {}", name(*a), name(*b), point(nearest.place, edge));
            refuse(message, PART.into());
        } else {
            let message = format!(
                "inset surfaces of `{}` and `{}`, which touch at the start, are {:.3e} apart near {}, less than the thickness {thickness:.3e}",
                name(*a),
                name(*b),
                nearest.distance,
                point(nearest.place, edge)
            );
            refuse(message, "make `thickness` smaller, or leave a gap between the bodies".into());
        }
        return None;
    }
    Some(Made { skin, thickness, one_sided: Vec::new() })
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

/// Nodes and weights of the vertices that go below the surface, by their nodes: at the depth (a length) of each triangle, which is 0 where it stays.
fn inset(
    bodies: &Bodies<'_>,
    skin: &Skin,
    facing: &Facing<'_>,
    frames: &BTreeMap<u32, Option<Frame>>,
    depths: &[f64],
) -> Result<BTreeMap<u32, Vec<(u32, f64)>>, NoRoom> {
    let &Bodies { model, rules, .. } = bodies;
    let mut around: BTreeMap<u32, (u32, Vec<_>)> = BTreeMap::new();
    let mut deepest: BTreeMap<u32, f64> = BTreeMap::new();
    for (t, triangle) in (0..).zip(skin.triangles()) {
        let depth = depths[t as usize];
        let largest = deepest.entry(facing.body(t)).or_insert(0.0);
        *largest = largest.max(depth);
        for &v in triangle {
            if let [(node, _)] = skin.terms(v) {
                around.entry(*node).or_insert((facing.body(t), Vec::new())).1.push((facing.normal(t), depth));
            }
        }
    }
    let mut places = BTreeMap::new();
    for (node, (body, facets)) in around {
        if facets.iter().all(|(_, depth)| *depth == 0.0) {
            continue;
        }
        let depth = facets.iter().map(|(_, depth)| *depth).fold(0.0, f64::max);
        let no_room = |reason| NoRoom { body, node, depth, reason };
        let m = mitre(&facets).ok_or_else(|| no_room("facets there face each other"))?;
        let at = std::array::from_fn(|i| model.reference[3 * node as usize + i] - m[i]);
        if let Some(frame) = frames.get(&body) {
            // cannot fail: bodies without an inside have no part in the inset.
            let frame = frame.as_ref().ok_or_else(|| no_room("the surface is flat or not closed"))?;
            places.insert(node, frame.terms(at));
            continue;
        }
        let solid = &model.bodies[body as usize].solid;
        // Vertices of traces of curved faces need not lie in an element: the nearest one goes on beyond its faces.
        let is_rim = facets.iter().any(|(_, depth)| *depth == 0.0);
        let beyond = match model.embedding.carriers(node) {
            Some(_) => BEYOND,
            None if is_rim => BESIDE,
            None => 0.0,
        };
        let point = solid.material_point_near(&model.reference, at, beyond);
        let point = point.ok_or_else(|| no_room("the body is too thin there"))?;
        let (kind, nodes) = (solid.elements().kind(point.element), &solid.elements()[point.element]);
        places.insert(node, nodes.iter().copied().zip((kind.table().shape)(point.natural)).collect());
    }
    for (&body, _) in frames.iter().filter(|(_, frame)| frame.is_some()) {
        let depth = deepest.get(&body).copied().unwrap_or_default();
        if depth == 0.0 {
            continue;
        }
        let of_body = facets_of(skin.facets(), rules, body);
        let own = (0..).zip(skin.facets()).filter(|(_, facet)| rules.body(facet.class) == body);
        let goes_inside = |f: u32| skin.triangles_of(f).iter().any(|&t| depths[t as usize] > 0.0);
        let inside: Vec<bool> = own.map(|(f, _)| goes_inside(f)).collect();
        let least = depths.iter().enumerate().filter(|(t, d)| **d > 0.0 && facing.body(*t as u32) == body);
        let least = least.map(|(_, d)| *d).fold(depth, f64::min);
        let place = |node: u32| places.get(&node).cloned();
        if !fits(&of_body, &inside, &model.reference, least, &place) {
            let node = of_body.iter().zip(&inside).find(|(_, inside)| **inside).map_or(0, |(facet, _)| facet.nodes[0]);
            return Err(NoRoom { body, node, depth, reason: "the body is too thin" });
        }
    }
    Ok(places)
}

fn facets_of(facets: &[SkinFacet], rules: &Interactions, body: u32) -> Vec<SkinFacet> {
    facets.iter().filter(|facet| rules.body(facet.class) == body).copied().collect()
}
