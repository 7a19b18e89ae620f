//! The verdict on a run.

use crate::contact;
use crate::locking::{StrainEnergies, Strained};
use crate::names::Names;
use crate::standing::{Driven, Push, Stabilised};
use crate::words::{short, short_time};
use crate::{ContactState, Finding, FindingKind, Meeting, Observation, Penetration, Severity, SolidObservation};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;

/// The verdict on a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Severity of the worst finding.
    pub level: Severity,
    /// All findings, the worst first.
    pub reasons: Vec<Finding>,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reasons.as_slice() {
            [] => f.write_str("sound: the watch found nothing"),
            [first, rest @ ..] => {
                write!(f, "{}: {}", self.level, first.sentence)?;
                for finding in rest {
                    write!(f, "\n  {}: {}", finding.level, finding.sentence)?;
                }
                Ok(())
            }
        }
    }
}

/// Depths, in edge lengths, from which on a penetration is doubtful or wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Doubtful.
    pub doubtful: f64,
    /// Wrong.
    pub wrong: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { doubtful: 0.05, wrong: 0.3 }
    }
}

/// Part of the depth that is wrong from which on a depth is doubtful between bodies that statics drives into each other, whatever drives them.
const DEEP: f64 = 0.5;

/// Collects findings and keeps the worst of each kind and pair of bodies. It can be stored in a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judge {
    names: Names,
    /// Pairs of bodies between which a contact is defined.
    contacts: Vec<[usize; 2]>,
    limits: Limits,
    findings: Vec<Finding>,
    /// What pairs of bodies that are driven into each other leave between them.
    #[serde(default)]
    driven: Vec<Driven>,
    /// What contacts without friction exert along the surfaces.
    #[serde(default)]
    pushes: Vec<Push>,
    #[serde(default)]
    stabilised: Stabilised,
    /// Bodies that statics strains.
    #[serde(default)]
    strained: Vec<Strained>,
}

impl Judge {
    /// A judge of bodies of these names with these nodes, and contacts between these pairs of them.
    pub fn new(
        bodies: impl IntoIterator<Item = (String, Range<u32>)>,
        contacts: Vec<[usize; 2]>,
        limits: Limits,
    ) -> Self {
        Self {
            names: bodies.into_iter().collect(),
            contacts,
            limits,
            findings: Vec::new(),
            driven: Vec::new(),
            pushes: Vec::new(),
            stabilised: Stabilised::default(),
            strained: Vec::new(),
        }
    }

    /// Remark that no contact is defined between two bodies, to end a sentence.
    fn remark(&self, a: usize, b: usize) -> String {
        match self.contacts.contains(&[a, b]) || self.contacts.contains(&[b, a]) {
            true => String::new(),
            false if a == b => "; no contact of the body with itself is defined".to_owned(),
            false => format!("; no contact is defined between `{}` and `{}`", self.names.body(a), self.names.body(b)),
        }
    }

    /// Adds what two bodies that act on each other without friction exerted in a time: the force on the first one, and what of it their surfaces cannot exert.
    pub fn observe_push(
        &mut self,
        bodies: [usize; 2],
        force: [f64; 3],
        beside: [[f64; 3]; 2],
        at: (u64, f64),
        duration: f64,
    ) {
        let known = self.pushes.iter().position(|push| push.bodies == bodies);
        let place = known.unwrap_or_else(|| {
            self.pushes.push(Push::of(bodies));
            self.pushes.len() - 1
        });
        self.pushes[place].note(force, beside, at, duration);
    }

    /// Takes note of what stabilisation exerts in a step, and of the reactions and loads there: sums of the magnitudes of nodal forces.
    pub fn observe_stabilisation(&mut self, step: u64, time: f64, force: f64, others: f64) {
        self.stabilised.note((step, time), force, others);
    }

    /// Takes note of the strain energies of a body in statics.
    pub fn observe_strains(&mut self, step: u64, time: f64, body: usize, energies: &StrainEnergies) {
        let known = self.strained.iter().position(|strained| strained.body == body);
        let place = known.unwrap_or_else(|| {
            self.strained.push(Strained::of(body));
            self.strained.len() - 1
        });
        self.strained[place].note((step, time), energies);
    }

    /// Adds the findings of a check after a step.
    pub fn observe(&mut self, step: u64, time: f64, seen: &Observation, solids: &SolidObservation) {
        self.observe_driven(step, time, seen, solids, &[]);
    }

    /// Adds the findings of a step in which statics drives bodies into each other: depths in those that act on each other, `meetings`, are doubtful if they are
    /// not small against what drives them.
    pub fn observe_driven(
        &mut self,
        step: u64,
        time: f64,
        seen: &Observation,
        solids: &SolidObservation,
        meetings: &[Meeting],
    ) {
        for meeting in meetings {
            let deepest = seen.penetrations.iter().filter(|p| same([p.body, p.into], meeting.bodies));
            let deepest = deepest.max_by(|x, y| x.depth.total_cmp(&y.depth));
            let known = self.driven.iter().position(|driven| same(driven.bodies, meeting.bodies));
            let place = known.unwrap_or_else(|| {
                self.driven.push(Driven::of(meeting.bodies));
                self.driven.len() - 1
            });
            self.driven[place].note((step, time), meeting, deepest);
        }
        let Limits { doubtful, wrong } = self.limits;
        let is_driven = |p: &Penetration| {
            meetings.iter().any(|meeting| !meeting.by_loads && same([p.body, p.into], meeting.bodies))
        };
        let limit = |p: &Penetration| if is_driven(p) { DEEP * wrong } else { doubtful };
        let finding = |level, kind, bodies, sentence, position, figure| Finding {
            bodies,
            position,
            ..Finding::new(level, kind, (step, time), sentence, figure)
        };
        // Depths are those in facets: contact may know that the surfaces are round.
        let beyond = |p: &Penetration| {
            let meeting = meetings.iter().find(|meeting| same([p.body, p.into], meeting.bodies));
            let known = meeting.map_or(0.0, |meeting| meeting.known_arches);
            if known > 0.0 { p.relative * (1.0 - known / p.depth) } else { p.relative }
        };
        let mut found = Vec::new();
        for deepest in seen.penetrations.iter().filter(|deepest| beyond(deepest) > limit(deepest)) {
            let level = if beyond(deepest) > wrong { Severity::Wrong } else { Severity::Doubtful };
            let into = match deepest.into == deepest.body {
                true => "its own body".to_owned(),
                false => format!("`{}`", self.names.body(deepest.into)),
            };
            let sentence = format!(
                "at t = {} {} is {} ({} edge lengths) inside {into}{}",
                short_time(time),
                self.names.node(deepest.node),
                short(deepest.depth),
                short(deepest.relative),
                self.remark(deepest.body, deepest.into)
            );
            let bodies = Some([deepest.body, deepest.into]);
            let position = Some(deepest.position);
            found.push(finding(level, FindingKind::Penetration, bodies, sentence, position, deepest.relative));
        }
        for passage in &seen.tunnelled {
            let sentence = format!(
                "at t = {} {} has passed through `{}` since the last check{}",
                short_time(time),
                self.names.node(passage.node),
                self.names.body(passage.through),
                self.remark(passage.body, passage.through)
            );
            let bodies = Some([passage.body, passage.through]);
            found.push(finding(
                Severity::Wrong,
                FindingKind::Tunnelling,
                bodies,
                sentence,
                Some(passage.position),
                0.0,
            ));
        }
        if let Some((body, element, jacobian)) = solids.inverted {
            let sentence = format!(
                "at t = {} element {element} of `{}` is inverted (Jacobian {})",
                short_time(time),
                self.names.body(body),
                short(jacobian)
            );
            let bodies = Some([body, body]);
            found.push(finding(Severity::Wrong, FindingKind::InvertedElement, bodies, sentence, None, -jacobian));
        }
        if let Some((body, element, jacobian)) = solids.poor {
            let sentence = format!(
                "at t = {} element {element} of `{}` is {} at a corner (scaled Jacobian {})",
                short_time(time),
                self.names.body(body),
                if jacobian <= 0.0 { "inverted" } else { "nearly inverted" },
                short(jacobian)
            );
            let bodies = Some([body, body]);
            found.push(finding(Severity::Doubtful, FindingKind::PoorElement, bodies, sentence, None, -jacobian));
        }
        if let Some(node) = solids.not_finite {
            let sentence =
                format!("at t = {} the position of {} is not a finite number", short_time(time), self.names.node(node));
            found.push(finding(Severity::Wrong, FindingKind::NotFinite, None, sentence, None, 0.0));
        }
        if let Some((node, sizes)) = solids.far {
            let sentence = format!(
                "at t = {} {} is {} model sizes away from the model",
                short_time(time),
                self.names.node(node),
                short(sizes)
            );
            found.push(finding(Severity::Wrong, FindingKind::FarAway, None, sentence, None, sizes));
        }
        for finding in found {
            self.add(finding);
        }
    }

    /// Adds the finding that a static equilibrium is unstable: its energy falls in `directions` independent directions.
    pub fn observe_unstable(&mut self, step: u64, time: f64, directions: usize) {
        let sentence = format!(
            "the equilibrium at t = {} is unstable: the energy falls in {directions} direction{}, so a buckled or bifurcated state exists. A small disturbance, such as a side load or a deviation \
             of the mesh, leads there; so does dynamics",
            short_time(time),
            if directions == 1 { "" } else { "s" }
        );
        // All are equally severe, so that the first one is reported.
        self.add(Finding::new(Severity::Doubtful, FindingKind::Unstable, (step, time), sentence, 0.0));
    }

    /// Adds the findings about what a contact reports.
    pub fn observe_contact(&mut self, step: u64, time: f64, contact: &ContactState<'_>) {
        for finding in contact::observe(step, time, contact, self.limits.doubtful, |node| self.names.node(node)) {
            self.add(finding);
        }
    }

    /// Adds a finding. Of each kind and pair of bodies the worst is kept, with the first step of its level.
    pub fn add(&mut self, finding: Finding) {
        let same = |known: &&mut Finding| known.kind == finding.kind && known.bodies == finding.bodies;
        match self.findings.iter_mut().find(same) {
            None => self.findings.push(finding),
            Some(known) if finding.level > known.level => *known = finding,
            Some(known) if finding.level == known.level && finding.figure > known.figure => {
                let (step, time) = (known.step, known.time);
                *known = Finding { step, time, worst_time: Some(finding.time), ..finding };
            }
            Some(_) => {}
        }
    }

    /// Adds several findings.
    pub fn add_all(&mut self, findings: impl IntoIterator<Item = Finding>) {
        findings.into_iter().for_each(|finding| self.add(finding));
    }

    /// The verdict so far. What is judged beside the largest force or way of the run may become less as it goes on.
    pub fn verdict(&self) -> Verdict {
        self.verdict_with(Vec::new())
    }

    /// The verdict with further findings that hold so far.
    pub fn verdict_with(&self, further: Vec<Finding>) -> Verdict {
        let mut all = self.clone();
        all.add_all(further);
        all.add_all(self.driven.iter().flat_map(|driven| driven.findings(&self.names)));
        all.add_all(self.pushes.iter().filter_map(|push| push.finding(&self.names)));
        all.add_all(self.stabilised.finding());
        all.add_all(self.strained.iter().flat_map(|strained| strained.findings(&self.names)));
        let mut reasons = all.findings;
        reasons.sort_by(|a, b| b.level.cmp(&a.level).then(a.kind.cmp(&b.kind)).then(b.figure.total_cmp(&a.figure)));
        Verdict { level: reasons.first().map_or(Severity::Sound, |worst| worst.level), reasons }
    }
}

/// Whether these are the same two bodies.
fn same([a, b]: [usize; 2], other: [usize; 2]) -> bool {
    other == [a, b] || other == [b, a]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_their_digits() {
        let times = [0.950_000_000_000_000_1, 3.0e-7, 0.0, 12.5].map(short_time);
        assert_eq!(times, ["0.95", "3e-7", "0", "12.5"]);
    }

    /// The worst finding of one kind stays, with the time at which it first was of that level and that at which it was worst.
    #[test]
    fn a_finding_has_its_first_and_its_worst_time() {
        let mut judge = Judge::new([("ball".to_owned(), 0..8)], Vec::new(), Limits::default());
        let at = |time: f64, level, figure| Finding {
            level,
            kind: FindingKind::Penetration,
            bodies: Some([0, 0]),
            step: time as u64,
            time,
            worst_time: None,
            sentence: String::new(),
            position: Some([figure; 3]),
            figure,
        };
        for (time, level, figure) in
            [(1.0, Severity::Doubtful, 0.1), (2.0, Severity::Wrong, 0.4), (3.0, Severity::Wrong, 0.9)]
        {
            judge.add(at(time, level, figure));
        }
        judge.add(at(4.0, Severity::Wrong, 0.5));
        let worst =
            Finding { worst_time: Some(3.0), position: Some([0.9; 3]), figure: 0.9, ..at(2.0, Severity::Wrong, 0.0) };
        assert_eq!(judge.verdict().reasons, [worst]);
    }
}
