//! Steps to stages, and amplitudes as a scene can hold them.

use stoss_mesh_io::deck::{Amplitude, Deck, DeckStep, Procedure, Times};

use crate::left_out::List;
use crate::severity::Severity;
use crate::text::number;

/// A step of the deck as a part of the run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stage {
    /// Index in [`Deck::steps`]; none if the deck has no step that maps.
    pub step: Option<usize>,
    pub name: String,
    pub start: f64,
    pub end: f64,
    pub is_dynamic: bool,
    /// Whether the step has `NLGEOM`.
    pub is_nonlinear: bool,
    /// Whether what has no amplitude acts at once; else it grows over the step.
    pub is_sudden: bool,
    /// The first increment.
    pub first: f64,
    /// The largest increment, `step` of the scene.
    pub step_size: f64,
    /// How often a step may be halved, where the default does not get to the first increment.
    pub cuts: Option<u32>,
    /// Value of `automatic` as the scene writes it.
    pub automatic: Option<String>,
    pub integrator: Option<String>,
}

/// The stages of the run, at least one, and the functions of time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Timeline {
    pub stages: Vec<Stage>,
    /// Amplitudes of the deck, without jumps.
    pub amplitudes: Vec<Amplitude>,
}

/// Increments of a dynamic step that does not say how many.
const INCREMENTS: f64 = 100.0;
/// Halvings that the scene allows by default.
const DEFAULT_CUTS: f64 = 10.0;
/// Largest ratio of the largest increment to the first one that the scene takes.
const RATIO: f64 = 1e6;

fn positive(value: Option<f64>) -> Option<f64> {
    value.filter(|value| *value > 0.0 && value.is_finite())
}

impl Timeline {
    pub fn new(deck: &Deck, list: &mut List) -> Self {
        let mut stages: Vec<Stage> = Vec::new();
        for (s, step) in deck.steps.iter().enumerate() {
            let start = stages.last().map_or(0.0, |stage| stage.end);
            match stage(deck, s, step, start, list) {
                Some(mut stage) => {
                    let own = stage.name.clone();
                    let mut number = 2;
                    while stages.iter().any(|other| other.name == stage.name) {
                        stage.name = format!("{own}-{number}");
                        number += 1;
                    }
                    stages.push(stage);
                }
                None => {
                    let lines = step.supports.len() + step.forces.len() + step.loads.len() + step.pressures.len();
                    if lines > 0 {
                        let consequence = format!(
                            "its {lines} lines of supports and loads act in the later steps that do not end them"
                        );
                        list.add(Severity::Note, step.place, "*STEP that is left out", consequence, "");
                    }
                }
            }
        }
        if stages.is_empty() {
            list.add_general(
                Severity::Missing,
                "no step with *STATIC or *DYNAMIC",
                "the scene has one static step of length 1, with the supports and loads that are left after all steps",
                "set [time], supports and loads as you need them",
            );
            stages.push(Stage {
                step: None,
                name: "step-1".to_owned(),
                start: 0.0,
                end: 1.0,
                is_dynamic: false,
                is_nonlinear: true,
                is_sudden: false,
                first: 1.0,
                step_size: 1.0,
                cuts: None,
                automatic: None,
                integrator: None,
            });
        }
        let increment = stages.iter().map(|stage| stage.first).fold(f64::INFINITY, f64::min);
        let amplitudes = deck.amplitudes.iter().map(|amplitude| without_jumps(amplitude, increment, list)).collect();
        Self { stages, amplitudes }
    }

    pub fn is_dynamic(&self) -> bool {
        self.stages.iter().any(|stage| stage.is_dynamic)
    }

    pub fn end(&self) -> f64 {
        self.stages.last().map_or(1.0, |stage| stage.end)
    }
}

/// An amplitude of which no two points have one time: a table of a scene has no jumps. The new value is there at the time of the jump, as in CalculiX, and the change
/// takes the increment before; the table begins with the value after a jump at its beginning.
fn without_jumps(amplitude: &Amplitude, increment: f64, list: &mut List) -> Amplitude {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for group in amplitude.points.chunk_by(|a, b| a[0] == b[0]) {
        let (first, last) = (group[0], group[group.len() - 1]);
        if let (Some(&[t0, v0]), true) = (points.last(), first[1] != last[1]) {
            let [time, value] = first;
            let start = (time - increment).max(0.5 * t0 + 0.5 * time);
            points.push([start, v0 + (value - v0) * (start - t0) / (time - t0)]);
            let what = format!("*AMPLITUDE, NAME={}", amplitude.name);
            let consequence = format!(
                "it jumps at the time {}, and a table of a scene has no jumps: the value changes from {} on, over an increment",
                number(time),
                number(start)
            );
            list.add(Severity::Changed, amplitude.place, what, consequence, "begin a step there if the jump matters");
        }
        points.push(last);
    }
    Amplitude { points, ..amplitude.clone() }
}

/// The stage of a step; nothing if it computes something else.
fn stage(deck: &Deck, index: usize, step: &DeckStep, start: f64, list: &mut List) -> Option<Stage> {
    if step.is_perturbation {
        list.add(
            Severity::Note,
            step.place,
            "parameter PERTURBATION of *STEP",
            "the step is left out: Stoss has no linear perturbations",
            "",
        );
        return None;
    }
    if step.increments.is_some() {
        list.add_unread(step.place, "parameter INC of *STEP");
    }
    let has_contact = !deck.pairs.is_empty();
    let (times, is_dynamic) = match &step.procedure {
        Some(Procedure::Static(times)) => (*times, false),
        Some(Procedure::Dynamic { times, .. }) => (*times, true),
        Some(Procedure::Other(_)) => return None,
        None => {
            list.add(Severity::Changed, step.place, "*STEP without a procedure", "it is computed as *STATIC", "");
            (Times::default(), false)
        }
    };
    let period = positive(times.period).unwrap_or(1.0);
    let end = start + period;
    let first = match positive(times.initial) {
        Some(first) => first.min(period),
        None if is_dynamic => period / INCREMENTS,
        None => period,
    };
    let first = first.max(period / RATIO);
    let mut stage = Stage {
        step: Some(index),
        name: stage_name(step, index, list),
        start,
        end,
        is_dynamic,
        is_nonlinear: step.is_nonlinear,
        is_sudden: is_dynamic || step.is_sudden,
        first,
        step_size: first,
        cuts: None,
        automatic: None,
        integrator: None,
    };
    if let Some(Procedure::Dynamic { alpha, is_explicit, .. }) = &step.procedure {
        let (text, note) = integrator(*alpha, *is_explicit, has_contact);
        stage.integrator = Some(text);
        if let Some(note) = note {
            list.add(Severity::Changed, step.place, "*DYNAMIC", note, "for another scheme set `integrator` of [time]");
        }
        if !times.is_fixed {
            // The increments of the deck may grow to the largest one; that of a step that gives none is not known.
            stage.step_size = positive(times.largest).map_or(first, |largest| largest.min(period).max(first));
            let cuts = (stage.step_size / first).log2().ceil();
            stage.cuts = (cuts > DEFAULT_CUTS).then_some(cuts as u32);
            let which = if stage.step_size > first {
                "the largest increment of the deck"
            } else {
                "the first increment of the deck"
            };
            list.add(
                Severity::Note,
                step.place,
                "*DYNAMIC",
                format!(
                    "increments are not adapted to an estimate of the error: all are {}, {which}, and are halved only where a step does not converge",
                    number(stage.step_size)
                ),
                "compare with a run of half the `step`",
            );
        }
    } else if !times.is_fixed {
        let largest = positive(times.largest).unwrap_or(period).min(period).max(first);
        stage.step_size = largest;
        if first < largest {
            let smallest = positive(times.smallest).filter(|smallest| *smallest < first);
            let smallest = smallest.map_or(String::new(), |smallest| format!(", smallest = {}", number(smallest)));
            stage.automatic = Some(format!("{{ initial = {}{smallest} }}", number(first)));
        }
    }
    if !step.is_nonlinear && !has_contact {
        list.add(
            Severity::Note,
            step.place,
            "*STEP without NLGEOM",
            "Stoss always computes with large displacements: results agree as far as strains and rotations are small",
            "",
        );
    }
    Some(stage)
}

/// The name of the stage of a step: that of the step, if a scene can have it.
fn stage_name(step: &DeckStep, index: usize, list: &mut List) -> String {
    let good = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    match &step.name {
        Some(name) if name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(good) => name.clone(),
        Some(name) => {
            list.add_unread(step.place, format!("parameter NAME of *STEP, {name}"));
            format!("step-{}", index + 1)
        }
        None => format!("step-{}", index + 1),
    }
}

/// The scheme, and what is not as in the deck.
fn integrator(alpha: Option<f64>, is_explicit: bool, has_contact: bool) -> (String, Option<String>) {
    let em = "{ scheme = \"energy-momentum\" }".to_owned();
    if is_explicit {
        return (em, Some("EXPLICIT: the scheme is energy-momentum, which is implicit".to_owned()));
    }
    if has_contact {
        return (
            em,
            Some(
                "the scheme is energy-momentum: alpha schemes gain energy in impacts and do not support friction"
                    .to_owned(),
            ),
        );
    }
    // alpha is that of Hilber, Hughes and Taylor, -0.05 by default, at least -1/3: rho = (1 + alpha) / (1 - alpha).
    let alpha = alpha.unwrap_or(-0.05).clamp(-1.0 / 3.0, 0.0);
    let rho = ((1.0 + alpha) / (1.0 - alpha)).clamp(0.5, 1.0);
    (format!("{{ scheme = \"hht\", rho_inf = {} }}", number(rho)), None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_mesh_io::deck::DeckPlace;

    #[test]
    fn schemes() {
        assert_eq!(integrator(Some(0.0), false, false).0, "{ scheme = \"hht\", rho_inf = 1.0 }");
        // The strongest damping, alpha = -1/3, has rho = 1/2.
        assert!(
            integrator(Some(-0.5), false, false).0.contains("rho_inf = 0.5"),
            "{:?}",
            integrator(Some(-0.5), false, false)
        );
        assert!(integrator(None, false, true).0.contains("energy-momentum"));
        assert!(integrator(None, true, false).1.unwrap().contains("EXPLICIT"));
    }

    #[test]
    fn jumps_of_amplitudes_take_an_increment() {
        let of = |points: &[[f64; 2]]| {
            let (name, place) = ("a".to_owned(), DeckPlace { file: 0, line: 3 });
            let amplitude = Amplitude { name, is_total_time: false, points: points.to_vec(), place };
            let mut list = List::new(&deck());
            let points = without_jumps(&amplitude, 0.25, &mut list).points;
            (points, list.finish(&deck()))
        };
        // From the value of the straight line at that time.
        let (points, entries) = of(&[[0.0, 0.0], [1.0, 4.0], [1.0, 7.0], [1.0, 10.0], [2.0, 10.0]]);
        assert_eq!(points, [[0.0, 0.0], [0.75, 3.0], [1.0, 10.0], [2.0, 10.0]]);
        assert_eq!(
            (entries.len(), entries[0].place.as_str(), entries[0].what.as_str()),
            (1, "a.inp:3", "*AMPLITUDE, NAME=a")
        );
        assert!(entries[0].consequence.contains("jumps at the time 1.0"), "{entries:?}");
        // Not further back than to the middle between the points.
        assert_eq!(of(&[[0.0, 0.0], [0.2, 0.0], [0.2, 1.0]]).0, [[0.0, 0.0], [0.1, 0.0], [0.2, 1.0]]);
        // A jump at the beginning, and a point that is given twice.
        let (points, entries) = of(&[[0.0, 0.0], [0.0, 1.0], [1.0, 2.0], [1.0, 2.0]]);
        assert_eq!((points, entries.len()), (vec![[0.0, 1.0], [1.0, 2.0]], 0));
    }

    /// One tetrahedron.
    fn deck() -> Deck {
        let text = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n";
        stoss_mesh_io::deck::read_deck_from_bytes("a.inp", text.as_bytes(), &mut |_| {
            Err(std::io::ErrorKind::NotFound.into())
        })
        .unwrap()
    }
}
