//! Values over time.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh_io::deck::{Amplitude, Deck};

use crate::records::StageRecords;
use crate::timeline::Timeline;

/// The value of a line of the deck over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Value {
    pub value: f64,
    /// Index in [`Deck::amplitudes`] and [`Timeline::amplitudes`].
    pub amplitude: Option<usize>,
    /// True for a velocity.
    pub is_rate: bool,
}

/// A function of time, linear between its rows and constant outside of them, and the stages in which it acts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct History {
    /// Whether it acts, for each stage.
    pub active: Vec<bool>,
    /// Times, which do not fall, and values. Two rows of one time are a jump, at the beginning of a stage.
    pub rows: Vec<[f64; 2]>,
    /// Time from which the function is at its values, where it begins where the nodes are at that moment; infinite if it is counted from there.
    pub ramp_until: Option<f64>,
}

impl History {
    /// Zero at all times.
    pub fn none() -> Self {
        Self { active: Vec::new(), rows: vec![[0.0, 0.0]], ramp_until: None }
    }

    /// The function with all values times a factor.
    pub fn times(&self, factor: f64) -> Self {
        Self { rows: self.rows.iter().map(|row| [row[0], factor * row[1]]).collect(), ..self.clone() }
    }

    /// True if it is zero at all times.
    pub fn is_zero(&self) -> bool {
        self.rows.iter().all(|row| row[1] == 0.0)
    }

    /// The value at a time, at a jump the one after it.
    pub fn at(&self, time: f64) -> f64 {
        interpolate(&self.rows, time)
    }

    /// The times of its jumps.
    fn jumps(&self) -> impl Iterator<Item = f64> {
        self.rows.windows(2).filter(|pair| pair[0][0] == pair[1][0]).map(|pair| pair[1][0])
    }

    /// The part between two times, of which jumps at these times are no part.
    fn between(&self, start: f64, end: f64) -> Self {
        let inside = self.rows.iter().copied().filter(|row| start < row[0] && row[0] < end);
        let first = start.is_finite().then(|| [start, self.at(start)]);
        let last = end.is_finite().then(|| {
            let at_end = self.rows.iter().find(|row| row[0] == end);
            [end, at_end.map_or_else(|| self.at(end), |row| row[1])]
        });
        let rows = first.into_iter().chain(inside).chain(last).collect();
        Self { rows: without_repeats(rows), ..self.clone() }
    }

    /// What two histories have in common if they are the same.
    pub fn key(&self) -> (Vec<bool>, Option<u64>, Vec<[u64; 2]>) {
        // Zero has two signs.
        let bits = |x: f64| if x == 0.0 { 0 } else { x.to_bits() };
        let rows = self.rows.iter().map(|row| row.map(bits)).collect();
        (self.active.clone(), self.ramp_until.map(f64::to_bits), rows)
    }
}

/// Functions between their jumps: for each part the stages in which it acts, and its functions.
pub(crate) fn between_jumps(functions: &[&History], timeline: &Timeline) -> Vec<(Vec<bool>, Vec<History>)> {
    let mut jumps: Vec<f64> = functions.iter().flat_map(|function| function.jumps()).collect();
    jumps.sort_by(f64::total_cmp);
    jumps.dedup();
    let starts = std::iter::once(f64::NEG_INFINITY).chain(jumps.iter().copied());
    let ends = jumps.iter().copied().chain([f64::INFINITY]);
    let part = |(start, end): (f64, f64)| {
        let active = timeline.stages.iter().map(|stage| start <= stage.start && stage.end <= end).collect();
        (active, functions.iter().map(|function| function.between(start, end)).collect())
    };
    starts.zip(ends).map(part).collect()
}

/// Linear between rows, constant outside of them; of two rows of one time the later one counts at that time.
fn interpolate(rows: &[[f64; 2]], time: f64) -> f64 {
    let Some(first) = rows.first() else { return 0.0 };
    let next = rows.partition_point(|row| row[0] <= time);
    match (next.checked_sub(1).map(|before| rows[before]), rows.get(next)) {
        (None, _) => first[1],
        (Some(before), None) => before[1],
        (Some([t0, v0]), Some(&[t1, v1])) => v0 + (v1 - v0) * (time - t0) / (t1 - t0),
    }
}

/// The amplitude of this name.
pub(crate) fn amplitude(deck: &Deck, name: &str) -> Option<usize> {
    deck.amplitudes.iter().position(|amplitude| amplitude.name.eq_ignore_ascii_case(name))
}

/// The time of a stage in the time of an amplitude.
fn origin(amplitude: &Amplitude, start: f64) -> f64 {
    if amplitude.is_total_time { 0.0 } else { start }
}

/// The stages of a support as parts each of which is one function: where it ends and starts again the nodes are elsewhere in between, and a displacement cannot begin
/// with the end of a motion whose start is not known.
pub(crate) fn parts(by_stage: &StageRecords, values: &[Value]) -> Vec<StageRecords> {
    let mut all: Vec<StageRecords> = Vec::new();
    // The last part begins where the nodes are, and is counted from there.
    let mut is_relative = false;
    for (s, records) in by_stage.iter().enumerate().filter(|(_, records)| !records.is_empty()) {
        let follows = s > 0 && !by_stage[s - 1].is_empty();
        let is_other = s > 0 && by_stage[s - 1] != *records;
        if !follows || is_relative && is_other {
            let is_rate = records.iter().any(|&record| values[record as usize].is_rate);
            is_relative = s > 0 && is_rate;
            all.push(vec![Vec::new(); by_stage.len()]);
        }
        if let Some(part) = all.last_mut() {
            part[s].clone_from(records);
        }
    }
    all
}

/// What several lines say of one degree of freedom, as one function. `by_stage` are the records of each stage.
///
/// A value that the beginning of a stage changes at once: a load has it from the start of the run on, and jumps at the beginning of a dynamic stage; in a later
/// static stage it gets there in the first increment, whose end is the first state that is computed, so that a smaller increment is a part of the load. Displacements
/// get there in the first increment; those that begin in a later stage begin where the nodes are then. Loads that end fall to zero, supports keep their last value
/// and are not active.
pub(crate) fn history(by_stage: &StageRecords, values: &[Value], timeline: &Timeline, is_load: bool) -> History {
    let mut rows: Vec<[f64; 2]> = Vec::new();
    let mut old = 0.0;
    let mut ramp_until = None;
    let begin = by_stage.iter().position(|records| !records.is_empty()).unwrap_or(0);
    for (s, (stage, records)) in timeline.stages.iter().zip(by_stage).enumerate() {
        if !is_load && s < begin {
            continue;
        }
        // Where the nodes are at the start is not known.
        let begins_anywhere = !is_load && s == begin && s > 0;
        let (start, end) = (stage.start, stage.end);
        let records: Vec<Value> = records.iter().map(|&record| values[record as usize]).collect();
        let continues = s > 0 && by_stage[s - 1] == by_stage[s];
        let scaled = |record: &Value, time: f64| {
            record.amplitude.map_or(0.0, |a| {
                let amplitude = &timeline.amplitudes[a];
                record.value * interpolate(&amplitude.points, time - origin(amplitude, start))
            })
        };
        let is_total = |record: &&Value| record.amplitude.is_some_and(|a| timeline.amplitudes[a].is_total_time);
        let with_amplitude: Vec<Value> = if continues {
            records.iter().filter(is_total).copied().collect()
        } else {
            records.iter().filter(|record| record.amplitude.is_some()).copied().collect()
        };
        let scaled_sum = |time: f64| with_amplitude.iter().map(|record| scaled(record, time)).sum::<f64>();
        let plain = |is_rate: bool| {
            let own = records.iter().filter(move |record| record.amplitude.is_none() && record.is_rate == is_rate);
            own.map(|record| record.value).sum::<f64>()
        };
        let (target, rate) = (plain(false), plain(true));
        let has_target = records.iter().any(|record| record.amplitude.is_none() && !record.is_rate);
        let has_rate = records.iter().any(|record| record.is_rate);
        let value = |time: f64| {
            let constant = if continues {
                old - scaled_sum(start)
            } else if records.is_empty() && !is_load {
                old
            } else if has_target || records.is_empty() {
                let from = if with_amplitude.is_empty() { old } else { 0.0 };
                let part = if stage.is_sudden || begins_anywhere { 1.0 } else { (time - start) / (end - start) };
                // Exact at the end.
                if part >= 1.0 { target } else { from + (target - from) * part }
            } else if has_rate {
                old
            } else {
                0.0
            };
            constant + rate * (time - start) + scaled_sum(time)
        };
        let mut times = vec![start, end];
        for record in &with_amplitude {
            let Some(a) = record.amplitude else { continue };
            let amplitude = &timeline.amplitudes[a];
            let own = amplitude.points.iter().map(|point| point[0] + origin(amplitude, start));
            times.extend(own.filter(|time| start < *time && *time < end));
        }
        let acts_at_once = s == 0 && is_load;
        if begins_anywhere {
            ramp_until = Some(match (has_rate, stage.is_sudden || !with_amplitude.is_empty()) {
                (true, _) => f64::INFINITY,
                (false, true) => start + stage.first.min(end - start),
                (false, false) => end,
            });
        } else if value(start) != old && !acts_at_once {
            rows.push([start, old]);
            if !(is_load && stage.is_dynamic) {
                let soon = start + stage.first.min(end - start);
                times.retain(|time| *time > soon);
                times.push(soon.min(end));
            }
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        rows.extend(times.iter().map(|&time| [time, value(time)]));
        old = value(end);
    }
    rows.dedup();
    let active = by_stage.iter().map(|records| !records.is_empty()).collect();
    History { active, rows: without_repeats(rows), ramp_until }
}

/// Members with the same history together, with the records that it is made of. In the order of the first record.
pub(crate) fn by_history<T: Copy + Ord>(
    groups: BTreeMap<StageRecords, Vec<T>>,
    values: &[Value],
    timeline: &Timeline,
    is_load: bool,
) -> Vec<(History, Vec<T>, BTreeSet<u32>)> {
    let mut all: BTreeMap<_, (History, Vec<T>, BTreeSet<u32>)> = BTreeMap::new();
    for (by_stage, members) in groups {
        let own = history(&by_stage, values, timeline, is_load);
        let entry = all.entry(own.key()).or_insert_with(|| (own, Vec::new(), BTreeSet::new()));
        entry.1.extend(members);
        entry.2.extend(by_stage.into_iter().flatten());
    }
    let mut all: Vec<_> = all.into_values().collect();
    all.sort_by_key(|(_, _, records)| records.first().copied());
    all
}

/// Rows that the function does without: those between equal values, and equal ones at both ends.
fn without_repeats(rows: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::with_capacity(rows.len());
    for row in rows {
        if let [.., before, last] = kept.as_slice()
            && before[1] == last[1]
            && last[1] == row[1]
        {
            kept.pop();
        }
        kept.push(row);
    }
    while let [.., before, last] = kept.as_slice()
        && before[1] == last[1]
    {
        kept.pop();
    }
    if let [first, second, ..] = kept.as_slice()
        && first[1] == second[1]
    {
        kept.remove(0);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timeline::Stage;
    use stoss_mesh_io::deck::DeckPlace;

    fn stage(step: usize, start: f64, end: f64, is_sudden: bool) -> Stage {
        Stage {
            step: Some(step),
            name: String::new(),
            start,
            end,
            is_dynamic: false,
            is_nonlinear: true,
            is_sudden,
            first: 0.1,
            step_size: 0.1,
            cuts: None,
            automatic: None,
            integrator: None,
        }
    }

    fn two(is_sudden: bool) -> Timeline {
        let stages = vec![stage(0, 0.0, 1.0, is_sudden), stage(1, 1.0, 3.0, is_sudden)];
        Timeline { stages, amplitudes: amplitudes() }
    }

    /// A static stage, two dynamic ones.
    fn dynamic() -> Timeline {
        let dynamic = |step, start, end| Stage { is_dynamic: true, ..stage(step, start, end, true) };
        let stages = vec![stage(0, 0.0, 1.0, false), dynamic(1, 1.0, 3.0), dynamic(2, 3.0, 4.0)];
        Timeline { stages, amplitudes: amplitudes() }
    }

    fn plain(value: f64) -> Value {
        Value { value, amplitude: None, is_rate: false }
    }

    fn amplitudes() -> Vec<Amplitude> {
        let place = DeckPlace { file: 0, line: 1 };
        let amplitude = |name: &str, is_total_time| Amplitude {
            name: name.to_owned(),
            is_total_time,
            points: vec![[0.0, 0.0], [0.5, 1.0], [2.0, 4.0]],
            place,
        };
        vec![amplitude("own", false), amplitude("total", true)]
    }

    fn rows(by_stage: &[&[u32]], values: &[Value], timeline: &Timeline, is_load: bool) -> Vec<[f64; 2]> {
        let by_stage: Vec<Vec<u32>> = by_stage.iter().map(|records| records.to_vec()).collect();
        history(&by_stage, values, timeline, is_load).rows
    }

    #[test]
    fn values_grow_over_a_static_step_and_stay() {
        let values = [plain(5.0), plain(-1.0)];
        assert_eq!(rows(&[&[0], &[0]], &values, &two(false), false), [[0.0, 0.0], [1.0, 5.0]]);
        // Given again: from the present value on. Where it ends a load falls to zero, and a support keeps its value.
        assert_eq!(rows(&[&[0], &[1]], &values, &two(false), false), [[0.0, 0.0], [1.0, 5.0], [3.0, -1.0]]);
        assert_eq!(rows(&[&[0], &[]], &values, &two(false), true), [[0.0, 0.0], [1.0, 5.0], [3.0, 0.0]]);
        assert_eq!(rows(&[&[0], &[]], &values, &two(false), false), [[0.0, 0.0], [1.0, 5.0]]);
        assert_eq!(rows(&[&[0, 1], &[0, 1]], &values, &two(false), true), [[0.0, 0.0], [1.0, 4.0]]);
    }

    #[test]
    fn sudden_values_are_there_at_once_or_after_an_increment() {
        let values = [plain(5.0), plain(-1.0)];
        assert_eq!(rows(&[&[0], &[0]], &values, &two(true), true), [[0.0, 5.0]]);
        assert_eq!(rows(&[&[0], &[1]], &values, &two(true), true), [[1.0, 5.0], [1.1, -1.0]]);
        assert_eq!(rows(&[&[0], &[0]], &values, &two(true), false), [[0.0, 0.0], [0.1, 5.0]]);
    }

    /// Loads that jump at the beginning of a dynamic stage, from what the static one left and from stage to stage; what ends is zero at once.
    #[test]
    fn loads_jump_at_the_beginning_of_a_dynamic_stage() {
        let values = [plain(5.0), plain(-1.0), plain(2.0)];
        let jumping = [[0.0, 0.0], [1.0, 5.0], [1.0, -1.0], [3.0, -1.0], [3.0, 2.0]];
        assert_eq!(rows(&[&[0], &[1], &[2]], &values, &dynamic(), true), jumping);
        assert_eq!(
            rows(&[&[0], &[0], &[]], &values, &dynamic(), true),
            [[0.0, 0.0], [1.0, 5.0], [3.0, 5.0], [3.0, 0.0]]
        );
        // What does not change does not jump, and displacements take the first increment.
        assert_eq!(rows(&[&[0], &[0], &[0]], &values, &dynamic(), true), [[0.0, 0.0], [1.0, 5.0]]);
        assert_eq!(rows(&[&[0], &[1], &[1]], &values, &dynamic(), false), [[0.0, 0.0], [1.0, 5.0], [1.1, -1.0]]);
        // An amplitude in total time that begins in the second stage: 2 (1 + 3 * 0.5/1.5) = 4 at 1.
        let total = Value { value: 2.0, amplitude: Some(1), is_rate: false };
        assert_eq!(rows(&[&[], &[0], &[0]], &[total], &dynamic(), true), [[1.0, 0.0], [1.0, 4.0], [2.0, 8.0]]);
    }

    #[test]
    fn parts_between_jumps() {
        let of = |rows: &[[f64; 2]]| History { active: vec![true; 3], rows: rows.to_vec(), ramp_until: None };
        let jumping = of(&[[0.0, 0.0], [1.0, 5.0], [1.0, -1.0], [3.0, -1.0], [3.0, 2.0]]);
        let ramp = of(&[[0.0, 1.0], [4.0, 5.0]]);
        let parts = between_jumps(&[&jumping, &ramp], &dynamic());
        let stages: Vec<&[bool]> = parts.iter().map(|(active, _)| active.as_slice()).collect();
        assert_eq!(stages, [[true, false, false], [false, true, false], [false, false, true]]);
        let rows = |column: usize| parts.iter().map(|(_, own)| own[column].rows.clone()).collect::<Vec<_>>();
        assert_eq!(rows(0), [vec![[0.0, 0.0], [1.0, 5.0]], vec![[1.0, -1.0]], vec![[3.0, 2.0]]]);
        assert_eq!(rows(1), [vec![[0.0, 1.0], [1.0, 2.0]], vec![[1.0, 2.0], [3.0, 4.0]], vec![[3.0, 4.0], [4.0, 5.0]]]);
        assert_eq!(between_jumps(&[&ramp], &dynamic()), [(vec![true; 3], vec![ramp.clone()])]);
    }

    #[test]
    fn amplitudes_scale() {
        let own = Value { value: 2.0, amplitude: Some(0), is_rate: false };
        let total = Value { value: 2.0, amplitude: Some(1), is_rate: false };
        // In its own step: 0, 2 at 0.5, 2 (1 + 3 * 0.5/1.5) = 4 at 1; then it stays.
        assert_eq!(rows(&[&[0], &[0]], &[own], &two(false), false), [[0.0, 0.0], [0.5, 2.0], [1.0, 4.0]]);
        // In total time it goes on to 8 at 2.
        assert_eq!(rows(&[&[0], &[0]], &[total], &two(false), false), [[0.0, 0.0], [0.5, 2.0], [1.0, 4.0], [2.0, 8.0]]);
        // A jump at the start of the second step takes one increment.
        let jump = rows(&[&[], &[0]], &[total], &two(false), true);
        assert_eq!(jump[0], [1.0, 0.0]);
        assert!((jump[1][0] - 1.1).abs() < 1e-15 && (jump[1][1] - 4.4).abs() < 1e-12, "{jump:?}");
        let speed = Value { value: 3.0, amplitude: None, is_rate: true };
        assert_eq!(rows(&[&[0], &[]], &[speed], &two(true), false), [[0.0, 0.0], [1.0, 3.0]]);
        // A velocity zero keeps what there is.
        let values = [plain(5.0), Value { value: 0.0, ..speed }];
        assert_eq!(rows(&[&[0], &[1]], &values, &two(false), false), [[0.0, 0.0], [1.0, 5.0]]);
    }

    /// What begins in the second stage begins where the nodes are: the ramp of the scene takes them from there to the value.
    #[test]
    fn displacements_that_begin_later_begin_where_the_nodes_are() {
        let late = |value, is_sudden| history(&vec![vec![], vec![0]], &[value], &two(is_sudden), false);
        let ramp = late(plain(5.0), false);
        assert_eq!((ramp.rows, ramp.ramp_until), (vec![[1.0, 5.0]], Some(3.0)));
        let sudden = late(plain(5.0), true);
        assert_eq!((sudden.rows, sudden.ramp_until), (vec![[1.0, 5.0]], Some(1.1)));
        // Half of it in its own time at 1.5, and one increment to where it begins.
        let scaled = late(Value { value: 2.0, amplitude: Some(0), is_rate: false }, false);
        assert_eq!((scaled.rows, scaled.ramp_until), (vec![[1.0, 0.0], [1.5, 2.0], [3.0, 8.0]], Some(1.1)));
        let speed = late(Value { value: 2.0, amplitude: None, is_rate: true }, false);
        assert_eq!((speed.rows, speed.ramp_until), (vec![[1.0, 0.0], [3.0, 4.0]], Some(f64::INFINITY)));
    }

    #[test]
    fn a_support_that_ends_and_begins_anew_is_two() {
        let values = [plain(1.0), plain(2.0), Value { value: 3.0, amplitude: None, is_rate: true }];
        let of = |by_stage: &[&[u32]]| parts(&by_stage.iter().map(|records| records.to_vec()).collect(), &values);
        assert_eq!(of(&[&[0], &[1], &[1]]), [[vec![0], vec![1], vec![1]]]);
        assert_eq!(of(&[&[0], &[], &[1]]), [[vec![0], vec![], vec![]], [vec![], vec![], vec![1]]]);
        // From the start on a velocity has a known beginning.
        assert_eq!(of(&[&[2], &[1], &[]]), [[vec![2], vec![1], vec![]]]);
        assert_eq!(of(&[&[], &[2], &[1]]), [[vec![], vec![2], vec![]], [vec![], vec![], vec![1]]]);
        assert_eq!(of(&[&[], &[2], &[2]]), [[vec![], vec![2], vec![2]]]);
    }
}
