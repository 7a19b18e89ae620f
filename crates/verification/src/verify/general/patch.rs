//! Two flat faces: how uniform the pressure of the layer is at a given gap, and in blocks that are pressed together.

use stoss_contact_barrier::{GeneralContact, GeneralOptions, Interaction, Interactions, Layer, Skin, SkinFacet};
use stoss_geometry::{PairKind, closest};
use stoss_reference_element::FacetNodes;
use stoss_term::{At, GradientRule, Local, StepConfiguration, StepContext, Term};

use super::judge::run;
use super::scene::{Body, Scene};
use crate::verify::check::{Bound, Check};
use crate::verify::numbers::larger;
use crate::verify::report::{Grid, ReportSection};
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;

const THICKNESS: f64 = 0.02;

/// Deviation from the uniform pressure on matching meshes, points of integration alone.
const UNIFORM: f64 = 1e-3;

/// What guards may add to a node at a given gap, the most at corners.
const GUARDS: f64 = 0.6;

/// Deviation of the stress in the elements below the surface, of blocks that are pressed together.
const SPREAD: f64 = 0.15;

/// Measures a given gap, and blocks that are pressed together.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    given_gap(findings)?;
    pressed(bench, findings)
}

/// Two blocks of the height 1 with their faces half a thickness apart, the upper one shifted along x and y.
struct Faces {
    contact: GeneralContact,
    q: Vec<f64>,
    lower: usize,
}

/// Appends a block of `n` x `n` x 1 elements; facets are outward.
fn block(facets: &mut Vec<SkinFacet>, q: &mut Vec<f64>, n: u32, from: [f64; 3], class: u32) {
    let (first, counts) = (q.len() as u32 / 3, [n, n, 1]);
    let node = |i: [u32; 3]| first + i[0] + (n + 1) * (i[1] + (n + 1) * i[2]);
    for k in 0..=1 {
        for j in 0..=n {
            for i in 0..=n {
                q.extend([from[0] + f64::from(i) / f64::from(n), from[1] + f64::from(j) / f64::from(n)]);
                q.push(from[2] + f64::from(k));
            }
        }
    }
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, counts[axis]] {
            for a in 0..counts[u] {
                for b in 0..counts[v] {
                    let at = |da: u32, db: u32| {
                        let mut i = [0; 3];
                        (i[axis], i[u], i[v]) = (side, a + da, b + db);
                        node(i)
                    };
                    let mut corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                    if side == 0 {
                        corners.reverse();
                    }
                    facets.push(SkinFacet { nodes: FacetNodes::from(corners), class });
                }
            }
        }
    }
}

fn faces(n: [u32; 2], shift: f64) -> Outcome<Faces> {
    let (mut facets, mut q) = (Vec::new(), Vec::new());
    block(&mut facets, &mut q, n[0], [0.0, 0.0, -1.0], 0);
    let lower = q.len() / 3;
    block(&mut facets, &mut q, n[1], [shift, shift, 0.5 * THICKNESS], 1);
    let mut rules = Interactions::none(&[(0, 1.0), (1, 1.0)]);
    rules.set(0, 1, Some(Interaction { modulus: 1.0, friction: None }));
    let skin = Skin::new(facets, &q, &|_| None);
    let options = GeneralOptions { thickness: THICKNESS, damping: 0.0, slip_velocity: None };
    Ok(Faces { contact: GeneralContact::new("faces", skin, rules, options)?, q, lower })
}

/// Forces along z on the nodes, guards included.
fn with_guards(faces: &mut Faces) -> Outcome<Vec<f64>> {
    let Faces { contact, q, lower } = faces;
    let mut force = vec![0.0; q.len() / 3];
    // Contacts begin with the thickness that is left, so the layer is entered by a step from outside.
    let lifted: Vec<f64> =
        q.iter().enumerate().map(|(k, x)| if k % 3 == 2 && k / 3 >= *lower { x + THICKNESS } else { *x }).collect();
    contact.begin(&StepContext::quasi_static(&lifted, 1.0))?;
    contact.renew(&At::end(q, &[], &[]), true)?;
    contact.commit(&At::end(q, &[], &[]));
    contact.begin(&StepContext::quasi_static(q, 1.0))?;
    contact.renew(&At::end(q, &[], &[]), true)?;
    let step = StepConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
    contact.assemble(&step.at(&[], &[]), false, &mut |local: &Local| {
        for (k, &node) in local.nodes.iter().enumerate() {
            force[node as usize] += local.residual[3 * k + 2];
        }
    })?;
    Ok(force)
}

/// Forces of points of integration alone, as the sum over all of them, each against the nearest triangle.
fn without_guards(faces: &Faces) -> Vec<f64> {
    let (skin, q) = (faces.contact.skin(), &faces.q);
    let layer = Layer::new(1.0, THICKNESS);
    let mut force = vec![0.0; q.len() / 3];
    let is_lower = |point: u32| skin.terms(point).iter().all(|&(node, _)| (node as usize) < faces.lower);
    for p in skin.vertex_count() as u32..skin.point_count() as u32 {
        // Three points in each triangle; those of side walls do not face the other body.
        let [a, b, c] = skin.triangles()[(p as usize - skin.vertex_count()) / 3].map(|v| skin.at(v, q));
        let normal = (b - a).cross(&(c - a));
        if normal.z.abs() < 0.5 * normal.norm() {
            continue;
        }
        let others = skin.triangles().iter().enumerate().filter(|(_, triangle)| is_lower(p) != is_lower(triangle[0]));
        let pairs = others.map(|(t, triangle)| {
            let points = [p, triangle[0], triangle[1], triangle[2]];
            let x = points.map(|point| skin.at(point, q));
            (t, points, x, closest(PairKind::VertexTriangle, &x))
        });
        // One plane is one patch: the nearest of its triangles.
        let nearest = pairs.min_by(|a, b| a.3.distance_squared.total_cmp(&b.3.distance_squared));
        let Some((t, points, x, pair)) = nearest.filter(|(.., pair)| layer.is_inside(pair.distance_squared)) else {
            continue;
        };
        let gap: f64 = x.iter().zip(pair.weights).map(|(x, c)| c * x[2]).sum();
        let [_, slope, _] = layer.evaluate(pair.distance_squared);
        let area = skin.point_weight(p, t as u32, [1, 2, 3].map(|i| -pair.weights[i]), 0.5, [0.0; 2]);
        for (point, c) in points.into_iter().zip(pair.weights) {
            for &(node, weight) in skin.terms(point) {
                force[node as usize] += area * slope * 2.0 * c * gap * weight;
            }
        }
    }
    force
}

/// Smallest and largest force of a node of the lower face over that of a uniform pressure.
fn ratios(faces: &Faces, force: &[f64], n: u32) -> [f64; 2] {
    // Half of the thickness: 1/2 (1 - y^2) / y^2 with y = 1/2.
    let pressure = 0.5 * 0.75 / 0.25;
    let mut range = [f64::INFINITY, 0.0_f64];
    for node in (0..faces.lower).filter(|&node| faces.q[3 * node + 2].abs() < 1e-12) {
        let part = |x: f64| if x.abs() < 1e-9 || (x - 1.0).abs() < 1e-9 { 0.5 } else { 1.0 } / f64::from(n);
        let area = part(faces.q[3 * node]) * part(faces.q[3 * node + 1]);
        let ratio = force[node] / (pressure * area);
        range = [range[0].min(ratio), range[1].max(ratio)];
    }
    range
}

fn given_gap(findings: &mut Findings) -> Outcome<()> {
    let mut rows = Vec::new();
    for (n, shift) in [([2, 2], 0.0), ([3, 3], 0.0), ([2, 3], 0.0), ([2, 5], 0.037), ([4, 5], 0.037)] {
        let mut faces = faces(n, shift)?;
        let all = with_guards(&mut faces)?;
        let (with, without) = (ratios(&faces, &all, n[0]), ratios(&faces, &without_guards(&faces), n[0]));
        let case = format!(
            "patch at a given gap, {0} x {0} below {1} x {1}{2}",
            n[0],
            n[1],
            if shift > 0.0 { ", shifted" } else { "" }
        );
        let range = |[low, high]: [f64; 2]| format!("{low:.3} to {high:.3}");
        let note = format!("without guards {}, with guards {}", range(without), range(with));
        let off = |[low, high]: [f64; 2]| (1.0 - low).max(high - 1.0);
        let bound = if n[0] == n[1] { Bound::AtMost(UNIFORM) } else { Bound::Unbounded };
        let quantity = "points of integration alone: largest deviation from the uniform pressure";
        findings.checks.push(Check::new(&case, quantity, off(without), bound).noted(note.clone()));
        let quantity = "with guards: largest deviation from the uniform pressure";
        findings.checks.push(Check::new(&case, quantity, off(with), Bound::AtMost(GUARDS)).noted(note));
        rows.push(vec![case, range(without), range(with)]);
    }
    let head = ["meshes", "points of integration alone", "with guards"].map(str::to_owned).to_vec();
    let caption =
        "Force of a node of the lower face over that of a uniform pressure; faces half a thickness apart".into();
    let table = Grid { caption, head, rows };
    findings.sections.push(ReportSection { title: "Uniform pressure".into(), reading: "Two faces half a thickness of the layer apart; the force of each node over that of a uniform pressure, smallest and largest. 1 and 1 is exact; guards are the points that keep corners and edges from passing.".into(), figures: Vec::new(), tables: vec![table] });
    Ok(())
}

/// Pressure of a bar of the scene's material (E = 1, nu = 0.3) at a stretch along it, sides free.
fn bar_pressure(stretch: f64) -> f64 {
    let (mu, lambda) = (1.0 / 2.6, 0.3 / (1.3 * 0.4));
    let logarithm = |side: f64| (side * side * stretch).ln();
    let (mut low, mut high) = (0.5, 2.0);
    for _ in 0..100 {
        let side = 0.5 * (low + high);
        if mu * (side * side - 1.0) + lambda * logarithm(side) > 0.0 { high = side } else { low = side }
    }
    -(mu * (stretch - 1.0 / stretch) + lambda * logarithm(low) / stretch)
}

/// Two blocks that touch are pressed together by a twentieth of their height between plates without friction.
fn pressed(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    const CLOSING: f64 = 0.1;
    let meshes: &[[u32; 2]] = if bench.quick { &[[2, 2], [2, 3]] } else { &[[2, 2], [2, 3], [2, 5]] };
    for &[n, m] in meshes {
        for thickness in [0.02, 0.005] {
            let name = format!("patch, {n} x {n} x {n} pressed by {m} x {m} x {m}, thickness {thickness}");
            let body = |name: &'static str, n: u32, z: f64| Body::block(name, [1.0; 3], [n; 3]).at([0.5, 0.5, z]);
            let mut scene = Scene::equilibria(2, "").body(body("lower", n, -0.5)).body(body("upper", m, 0.5));
            for body in ["lower", "upper"] {
                scene = scene.fixed(&format!("{body}.left"), &["x"]).fixed(&format!("{body}.front"), &["y"]);
            }
            scene = scene.fixed("lower.bottom", &["z"]).probe("force", "lower.bottom", "reaction").also(&format!(
                "\n[[prescribe]]\nset = \"upper.top\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0.0, 0.0], [1.0, -{CLOSING:?}]] }}\n"
            ));
            let middles = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
            let cells: Vec<[u32; 2]> = (0..n).flat_map(|i| (0..n).map(move |j| [i, j])).collect();
            for &[i, j] in &cells {
                let at = [middles(i), middles(j), -0.5 / f64::from(n)];
                scene = scene.also(&format!(
                    "\n[[probe]]\nname = \"s{i}-{j}\"\nbody = \"lower\"\npoint = {at:?}\nquantity = \"cauchy_stress\"\n"
                ));
            }
            let scene = scene.general(&format!("thickness = {thickness:?}"));
            let launched = run(bench, &name, &scene)?;
            findings.checks.push(launched.run.completed(0));
            if !launched.run.succeeded() {
                continue;
            }
            let probes = launched.run.table("probes.csv")?;
            let last =
                |column: &str| -> Outcome<f64> { Ok(*probes.column(column)?.last().ok_or("probes.csv has no row")?) };
            let (force, exact) = (last("force.z")?, bar_pressure(1.0 - 0.5 * CLOSING));
            // Forces enter half a thickness below the surface by functions that are linear in an element: the work of a uniform stress is less by that part
            // of the height twice, in force and in displacement. So bodies of the height 1 are stiffer by a thickness, and the layer gives way by as much. What is left is of the second order.
            let bound = Bound::AtMost(0.1 * thickness);
            let note = format!("a tenth of the thickness; {force:.6}; two bars without a layer: {exact:.6}");
            let row = Check::new(&name, "force over the closed form, less one", (force / exact - 1.0).abs(), bound);
            findings.checks.push(row.noted(note));
            let stresses: Vec<f64> =
                cells.iter().map(|[i, j]| last(&format!("s{i}-{j}.zz"))).collect::<Outcome<_>>()?;
            let mean = stresses.iter().sum::<f64>() / stresses.len() as f64;
            let spread = stresses.iter().map(|s| (s / mean - 1.0).abs()).fold(0.0, larger);
            let quantity = "stress in the elements below the surface: deviation from its mean";
            findings.checks.push(Check::new(&name, quantity, spread, Bound::AtMost(SPREAD)));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_is_a_spring_at_small_strains() {
        assert!((bar_pressure(1.0 - 1e-6) / 1e-6 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_force_that_is_not_uniform_is_noticed() {
        let faces = faces([2, 2], 0.0).unwrap();
        let mut force = without_guards(&faces);
        let [low, high] = ratios(&faces, &force, 2);
        assert!((low - 1.0).abs() < 1e-12 && (high - 1.0).abs() < 1e-12);
        force[9] *= 1.5;
        assert!((ratios(&faces, &force, 2)[1] - 1.5).abs() < 1e-12);
    }
}
