//! The books of a dynamic run: energy, and the tables against the frames.

use super::extremes::worst;
use super::model::Kind;
use super::motion::at_rest;
use super::vector::{minus, norm};
use super::{Criterion, Evidence, is_worse};
use crate::verify::numbers::largest;

/// Part of the energy that a run may lose where gaps close, or gain, without a word. From 1 % on it must be told, as the guide says of verdicts.
const LOSS: [f64; 2] = [0.005, 0.0105];

/// What a scheme that conserves leaves: some hundred tolerances of Newton's method.
const KEPT: [f64; 2] = [1e-8, 1e-6];

/// Difference of the tables from integrals over the frames.
const SAME: [f64; 2] = [1e-9, 1e-6];

/// Adds what is to be said.
pub fn judge(evidence: &Evidence<'_>, all: &mut Vec<Criterion>) {
    if evidence.case.known.rest {
        return;
    }
    let (kinetic, strain) = (evidence.column("kinetic"), evidence.column("strain"));
    let scale = largest(kinetic.iter().zip(&strain).map(|(k, s)| k + s));
    if scale <= at_rest(evidence) {
        return;
    }
    let total = evidence.column("total");
    let loss: Vec<f64> =
        evidence.column("closing_loss").iter().zip(evidence.column("impact_loss")).map(|(l, r)| l + r).collect();
    let step = |row: usize| format!("step {row}");
    // Coordinate augmentation is the midpoint rule for the contact (guide, [[contact]]).
    let conserves = evidence.case.claims().is_some_and(|claims| claims.energy) && evidence.case.method != "cat";
    if conserves {
        let off = total.iter().zip(&loss).map(|(t, l)| (t + l - total[0] - loss[0]).abs() / scale);
        let (row, worst) = worst(off);
        all.push(Criterion::new("energy with its losses, change", worst, KEPT).at(step(row)).promised());
    } else {
        // The work of motors and moving supports is summed up by the rule of the scheme, and says little there.
        let bounds =
            if evidence.has("motor") || evidence.has("displacement") { [LOSS[0], f64::INFINITY] } else { LOSS };
        let mut lowest = f64::INFINITY;
        let gains = total.iter().map(|&t| {
            lowest = if t.is_nan() { t } else { lowest.min(t) };
            (t - lowest) / scale
        });
        let (row, worst) = worst(gains);
        all.push(Criterion::new("gain of energy", worst, bounds).at(step(row)));
    }
    // A scheme of the first order takes energy by itself, in impacts most of all: what is lost there decides nothing.
    let dissipates = evidence.case.claims().is_some_and(|claims| claims.order < 2);
    let bounds = if dissipates { [LOSS[0], f64::INFINITY] } else { LOSS };
    // What a law of impact takes from rigid bodies alone is their restitution, an entry of the scene: the speed of the rebound judges it.
    let is_rigid = evidence.model.parts.iter().all(|part| part.driven || part.kind != Kind::Solid);
    let taken = if is_rigid { evidence.column("closing_loss") } else { loss };
    let (row, worst_loss) = worst(taken.iter().map(|l| (l - taken[0]).abs() / scale));
    all.push(Criterion::new("energy that contact took or gave", worst_loss, bounds).at(step(row)));
    if !evidence.has("friction") && !evidence.has("damping") {
        let (row, lost) = worst(evidence.column("dissipation").iter().map(|d| d.abs() / scale));
        all.push(Criterion::new("energy lost without friction or damping", lost, LOSS).at(step(row)));
    }
    tables(evidence, scale, all);
}

/// Momenta and kinetic energy of the tables against integrals over the frames.
fn tables(evidence: &Evidence<'_>, scale: f64, all: &mut Vec<Criterion>) {
    let model = &evidence.model;
    let parts: Vec<_> = model.parts.iter().filter(|part| !part.driven).collect();
    let is_known = |part: &&super::model::Part| part.is_straight && part.density.is_some() && !part.elements.is_empty();
    if !parts.iter().all(is_known) {
        return;
    }
    let kinetic = evidence.column("kinetic");
    let vectors = |names| evidence.balance.vectors(names).unwrap_or_default();
    let (linear, angular) = (vectors(["lx", "ly", "lz"]), vectors(["jx", "jy", "jz"]));
    let mut figure = (0.0, String::new());
    for frame in &model.frames {
        let (Some(&k), Some(&l), Some(&j)) = (kinetic.get(frame.step), linear.get(frame.step), angular.get(frame.step))
        else {
            continue;
        };
        let (mut mass, mut energy, mut l, mut j) = (0.0, -k, l, j);
        for part in &parts {
            let Some(own) = model.motion(part, part.density.unwrap_or_default(), frame) else { continue };
            (mass, energy) = (mass + own.mass, energy + own.kinetic);
            (l, j) = (minus(l, own.linear), minus(j, own.angular));
        }
        let momentum = (2.0 * mass * scale).sqrt();
        let reach = largest(frame.x.iter().map(|&x| norm(x)));
        for (off, what) in [
            (energy.abs() / scale, "kinetic energy"),
            (norm(l) / momentum, "linear momentum"),
            (norm(j) / (momentum * reach), "angular momentum"),
        ] {
            if is_worse(off, figure.0) {
                figure = (off, format!("{what}, step {}", frame.step));
            }
        }
    }
    all.push(Criterion::new("balance.csv against the frames", figure.0, SAME).at(figure.1));
}
