//! What is judged beside the largest force or way that a run had: it is known only at its end.

use crate::names::Names;
use crate::words::{short, short_time};
use crate::{Finding, FindingKind, Meeting, Penetration, Severity};
use serde::{Deserialize, Serialize};

/// Part of the way by which bodies are driven into each other from which on the deepest point is doubtful. In the mean over the contact the depth is a third of it or less, and that is, to first
/// order, the relative error of the force.
const SINKS: f64 = 0.08;
/// Part of that way from which on the deepest point is doubtful where loads alone press bodies together: forces are right, and the way of what is pressed is off by up to as much.
const SINKS_BY_LOADS: f64 = 0.25;
/// Part of that way from which on a distance that contact keeps everywhere is doubtful, which is the relative error of the force itself.
const APART: f64 = 0.05;
/// Part of that way from which on arches of facets are doubtful: a part of them cancels between the facets of both surfaces, and where they do not lie on each
/// other forces are their mean.
const ARCHES: f64 = 0.1;
/// Parts of an edge below which depths and distances are what an iteration leaves.
const NOTHING: f64 = 1.0e-4;
/// Part of the impulse of a contact without friction that may act along the surfaces: a coefficient of friction of as much.
const ALONG: f64 = 0.005;
/// Part of the largest force on supports and loads that stabilisation may carry.
const CARRIES: f64 = 0.05;

/// A quantity at its largest, and when that was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Peak {
    value: f64,
    at: (u64, f64),
}

impl Peak {
    fn note(&mut self, value: f64, at: (u64, f64)) -> bool {
        let more = value > self.value;
        if more {
            *self = Self { value, at };
        }
        more
    }
}

/// Two bodies that statics drives into each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Driven {
    pub bodies: [usize; 2],
    /// Largest way by which they were driven into each other.
    drive: f64,
    /// Largest depth of one in the other, and the deepest node: its number, its body and that which it is in.
    depth: Peak,
    deepest: (u32, [usize; 2]),
    place: [f64; 3],
    /// Largest distance that is left between them, where they act on each other.
    apart: Peak,
    /// Largest mean height of the arches of facets that lie on each other.
    arch: Peak,
    /// Largest depth while loads alone press, and the deepest node, as above.
    #[serde(default)]
    loaded: Peak,
    #[serde(default)]
    loaded_deepest: (u32, [usize; 2], [f64; 3]),
}

impl Driven {
    pub fn of(bodies: [usize; 2]) -> Self {
        Self { bodies, ..Self::default() }
    }

    pub fn note(&mut self, at: (u64, f64), meeting: &Meeting, deepest: Option<&Penetration>) {
        self.drive = self.drive.max(meeting.drive);
        self.arch.note(meeting.arch, at);
        if meeting.by_loads {
            let depth = deepest.map_or(0.0, |deepest| deepest.depth - meeting.known_arches);
            if let Some(deepest) = deepest.filter(|_| depth > NOTHING * meeting.edge)
                && self.loaded.note(depth, at)
            {
                self.loaded_deepest = (deepest.node, [deepest.body, deepest.into], deepest.position);
            }
            return;
        }
        match deepest {
            Some(deepest) => {
                let depth = deepest.depth - meeting.known_arches;
                if depth > NOTHING * meeting.edge && self.depth.note(depth, at) {
                    (self.deepest, self.place) = ((deepest.node, [deepest.body, deepest.into]), deepest.position);
                }
            }
            None => {
                let apart = meeting.apart - meeting.known_arches;
                if apart > NOTHING * meeting.edge {
                    self.apart.note(apart, at);
                }
            }
        }
    }

    /// Findings, with these names.
    pub fn findings(&self, names: &Names) -> Vec<Finding> {
        let [first, second] = self.bodies.map(|body| names.body(body).to_owned());
        let drive = short(self.drive);
        let mut found = Vec::new();
        let place = if self.loaded.value > self.depth.value { self.loaded_deepest.2 } else { self.place };
        let mut add = |peak: &Peak, limit: f64, say: &dyn Fn(String, f64) -> String| {
            // Bodies that travel beside each other first are driven by less than nothing, as far as is known.
            let part = peak.value / self.drive.max(peak.value);
            if peak.value > 0.0 && self.drive > 0.0 && part > limit {
                let at = peak.at;
                let sentence = format!("at t = {} {}", short_time(at.1), say(short(peak.value), 100.0 * part));
                let finding = Finding::new(Severity::Doubtful, FindingKind::Indentation, at, sentence, part);
                found.push(Finding { bodies: Some(self.bodies), position: Some(place), ..finding });
            }
        };
        add(&self.depth, SINKS, &|depth, percent| {
            let (node, [_, into]) = self.deepest;
            format!(
                "{} is {depth} inside `{}`, {percent:.0} % of the {drive} by which `{first}` and `{second}` were driven into each other: forces can be off by up to as much. Refine the slave there, or \
                 exchange slave and master",
                names.node(node),
                names.body(into)
            )
        });
        add(&self.loaded, SINKS_BY_LOADS, &|depth, percent| {
            let (node, [_, into], _) = self.loaded_deepest;
            format!(
                "{} is {depth} inside `{}`, {percent:.0} % of the {drive} by which loads press `{first}` and `{second}` together: forces are in equilibrium, displacements can be off by up to as much. Refine the \
                 slave there, exchange slave and master, or take `mortar`",
                names.node(node),
                names.body(into)
            )
        });
        add(&self.apart, APART, &|apart, percent| {
            format!(
                "contact keeps `{first}` and `{second}` {apart} apart, {percent:.0} % of the {drive} by which they were driven into each other: forces are too large by about as much. Take a smaller \
                 `thickness` of general contact, or name the contact"
            )
        });
        add(&self.arch, ARCHES, &|arch, percent| {
            format!(
                "the facets of `{first}` and `{second}`, curved alike, lie {arch} beside the curved surfaces in the mean, {percent:.0} % of the {drive} of overlap and motion that drives them into each \
                 other: forces between them are off by about as much. Use finer facets, say that they are `round` (general contact), or take meshes whose nodes lie opposite each other"
            )
        });
        found
    }
}

/// What two bodies without friction exert on each other, summed over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Push {
    pub bodies: [usize; 2],
    /// Sum of the magnitudes of the force.
    impulse: f64,
    /// Sums of what the surface of the second body, and that of the first, cannot exert.
    beside: [[f64; 3]; 2],
    /// The largest magnitude of one of them so far.
    peak: Peak,
}

impl Push {
    pub fn of(bodies: [usize; 2]) -> Self {
        Self { bodies, ..Self::default() }
    }

    pub fn note(&mut self, force: [f64; 3], beside: [[f64; 3]; 2], at: (u64, f64), duration: f64) {
        let size = |x: &[f64; 3]| x[0].hypot(x[1]).hypot(x[2]);
        self.impulse += duration * size(&force);
        for (sum, part) in self.beside.iter_mut().zip(beside) {
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += duration * part);
            self.peak.note(size(sum), at);
        }
    }

    pub fn finding(&self, names: &Names) -> Option<Finding> {
        let part = self.peak.value / self.impulse;
        if part.is_nan() || part <= ALONG {
            return None;
        }
        let at = self.peak.at;
        let [first, second] = self.bodies.map(|body| names.body(body));
        let sentence = format!(
            "up to t = {} the contact between `{first}` and `{second}`, which has no friction, has pushed along the surfaces by {:.1} % of its impulse: no normal of the facets there has that direction. \
             Bodies slide off or are slowed by as much. Name the contact (`nts`, `mortar`), and leave `damping` out",
            short_time(at.1),
            100.0 * part
        );
        let finding = Finding::new(Severity::Doubtful, FindingKind::SideForce, at, sentence, part);
        Some(Finding { bodies: Some(self.bodies), ..finding })
    }
}

/// What stabilisation exerts beside everything else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stabilised {
    /// Largest sum of the nodal forces of stabilisation.
    force: Peak,
    /// Largest sum of the nodal forces of supports and loads.
    others: f64,
}

impl Stabilised {
    pub fn note(&mut self, at: (u64, f64), force: f64, others: f64) {
        self.force.note(force, at);
        self.others = self.others.max(others);
    }

    pub fn finding(&self) -> Option<Finding> {
        let Self { force: Peak { value, at }, others } = *self;
        let part = value / others;
        if part.is_nan() || part <= CARRIES {
            return None;
        }
        let sentence = format!(
            "at t = {} the stabilisation (`stabilise`) carried {:.0} % of the largest force on supports and loads: until the end of the stage, where it is zero, forces are those of the stabilisation. Use a \
             smaller fraction or a longer stage, or support the bodies that move",
            short_time(at.1),
            100.0 * part
        );
        Some(Finding::new(Severity::Doubtful, FindingKind::Stabilisation, at, sentence, part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Judge;
    use crate::{Limits, Observation, SolidObservation};

    fn judge() -> Judge {
        let bodies = [("tool".to_owned(), 0..4), ("block".to_owned(), 4..8)];
        Judge::new(bodies, vec![[0, 1]], Limits::default())
    }

    fn meeting(drive: f64, apart: f64, arch: f64) -> Meeting {
        Meeting {
            bodies: [0, 1],
            node: 2,
            position: [0.0; 3],
            apart,
            edge: 1.0,
            drive,
            arch,
            known_arches: 0.0,
            by_loads: false,
        }
    }

    fn seen(depth: f64) -> Observation {
        let inside = Penetration { body: 0, node: 2, into: 1, depth, relative: depth, position: [0.0; 3] };
        Observation { penetrations: vec![inside], ..Observation::default() }
    }

    fn kinds(judge: &Judge) -> Vec<(FindingKind, Severity)> {
        judge.verdict().reasons.iter().map(|reason| (reason.kind, reason.level)).collect()
    }

    const INDENTATION: (FindingKind, Severity) = (FindingKind::Indentation, Severity::Doubtful);

    /// Depths count beside the way of the whole run, not beside edges; a deep one by itself.
    #[test]
    fn depths_beside_what_drives_the_bodies() {
        let solids = SolidObservation::default();
        for (depth, drive, expected) in [
            (0.04, 0.25, vec![INDENTATION]),
            (0.04, 0.6, Vec::new()),
            (0.1, 3.0, Vec::new()),
            (0.16, 9.0, vec![(FindingKind::Penetration, Severity::Doubtful)]),
            (0.31, 99.0, vec![(FindingKind::Penetration, Severity::Wrong)]),
            (5e-5, 1e-4, Vec::new()),
        ] {
            let mut judge = judge();
            judge.observe_driven(1, 0.1, &seen(depth), &solids, &[meeting(0.01 * drive, 0.0, 0.0)]);
            judge.observe_driven(2, 0.2, &seen(0.5 * depth), &solids, &[meeting(drive, 0.0, 0.0)]);
            assert_eq!(kinds(&judge), expected, "{depth} {drive}");
        }
        // Of bodies that nothing drives an edge is the measure.
        let mut judge = judge();
        judge.observe(1, 0.1, &seen(0.06), &solids);
        assert_eq!(kinds(&judge), [(FindingKind::Penetration, Severity::Doubtful)]);
    }

    #[test]
    fn layers_and_arches_beside_what_drives_the_bodies() {
        let (none, solids) = (Observation::default(), SolidObservation::default());
        for (apart, arch, expected) in
            [(0.04, 0.09, Vec::new()), (0.06, 0.0, vec![INDENTATION]), (0.0, 0.11, vec![INDENTATION])]
        {
            let mut judge = judge();
            judge.observe_driven(1, 0.1, &none, &solids, &[meeting(1.0, apart, arch)]);
            assert_eq!(kinds(&judge), expected, "{apart} {arch}");
        }
    }

    /// What goes to and fro does no harm; what adds up is a friction.
    #[test]
    fn pushes_along_surfaces_add_up() {
        let (side, force) = ([0.03, 0.0, 0.0], [0.03, 0.0, 1.0]);
        let mut judge = judge();
        for step in 1..200 {
            let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
            judge.observe_push([0, 1], force, [side.map(|x| sign * x), [0.0; 3]], (step, 0.1), 0.01);
        }
        assert_eq!(kinds(&judge), []);
        for step in 200..300 {
            judge.observe_push([0, 1], force, [[0.0; 3], side], (step, 0.1), 0.01);
        }
        assert_eq!(kinds(&judge), [(FindingKind::SideForce, Severity::Doubtful)]);
    }

    /// A part of what is carried later is no fault; that which carries alone is.
    #[test]
    fn stabilisation_beside_the_largest_force() {
        let mut judge = judge();
        judge.observe_stabilisation(1, 0.1, 0.4, 0.4);
        assert_eq!(kinds(&judge), [(FindingKind::Stabilisation, Severity::Doubtful)]);
        judge.observe_stabilisation(2, 0.2, 0.1, 9.0);
        assert_eq!(kinds(&judge), []);
        judge.observe_stabilisation(3, 0.3, 0.0, 0.0);
        assert_eq!(kinds(&judge), []);
    }
    /// Arches alone count under loads alone; what contact knows of them is no depth.
    #[test]
    fn loads_alone_and_known_arches() {
        let solids = SolidObservation::default();
        let by_loads = |apart, arch| Meeting { by_loads: true, ..meeting(1.0, apart, arch) };
        for (of, expected) in [(by_loads(0.5, 0.05), vec![]), (by_loads(0.5, 0.2), vec![INDENTATION])] {
            let mut judge = judge();
            judge.observe_driven(1, 0.1, &Observation::default(), &solids, &[of]);
            assert_eq!(kinds(&judge), expected);
        }
        for (depth, expected) in [(0.2, vec![]), (0.28, vec![INDENTATION])] {
            let mut judge = Judge::new(
                [("tool".to_owned(), 0..4), ("block".to_owned(), 4..8)],
                vec![[0, 1]],
                Limits { doubtful: 0.9, wrong: 1.0 },
            );
            judge.observe_driven(1, 0.1, &seen(depth), &solids, &[by_loads(0.0, 0.0)]);
            assert_eq!(kinds(&judge), expected, "{depth}");
        }
        for (known_arches, expected) in [(0.0, vec![INDENTATION]), (0.09, vec![])] {
            let mut judge = judge();
            let of = Meeting { known_arches, ..meeting(1.0, 0.0, 0.0) };
            judge.observe_driven(1, 0.1, &seen(0.15), &solids, &[of]);
            assert_eq!(kinds(&judge), expected);
        }
    }
}
