//! Values over time.

use stoss_mesh_io::deck::{Amplitude, Deck};

use crate::records::Chain;
use crate::timeline::Timeline;

/// The value of a line of the deck over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Value {
    pub value: f64,
    /// Index in [`Deck::amplitudes`].
    pub amplitude: Option<usize>,
    /// True for a velocity.
    pub is_rate: bool,
}

/// A function of time, linear in between and constant outside, and the stages in which it holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct History {
    pub active: Vec<bool>,
    /// Times and values; times ascend.
    pub rows: Vec<[f64; 2]>,
    /// It begins where the nodes are at that moment, and is at its values from this time on; infinite if it is counted from there.
    pub ramp_until: Option<f64>,
}

impl History {
    /// Zero at all times.
    pub fn none() -> Self {
        Self { active: Vec::new(), rows: vec![[0.0, 0.0]], ramp_until: None }
    }

    /// With all values times a factor.
    pub fn times(&self, factor: f64) -> Self {
        Self { rows: self.rows.iter().map(|row| [row[0], factor * row[1]]).collect(), ..self.clone() }
    }

    /// True if it is zero at all times.
    pub fn is_zero(&self) -> bool {
        self.rows.iter().all(|row| row[1] == 0.0)
    }

    /// The value at a time.
    pub fn at(&self, time: f64) -> f64 {
        interpolate(&self.rows, time)
    }

    /// What two histories have in common if they are the same.
    pub fn key(&self) -> (Vec<bool>, Option<u64>, Vec<[u64; 2]>) {
        // Zero has two signs.
        let bits = |x: f64| if x == 0.0 { 0 } else { x.to_bits() };
        let rows = self.rows.iter().map(|row| row.map(bits)).collect();
        (self.active.clone(), self.ramp_until.map(f64::to_bits), rows)
    }
}

/// Linear between rows, constant outside.
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
pub(crate) fn parts(chain: &Chain, values: &[Value]) -> Vec<Chain> {
    let mut all: Vec<Chain> = Vec::new();
    // The last part begins where the nodes are, and is counted from there.
    let mut is_relative = false;
    for (s, records) in chain.iter().enumerate().filter(|(_, records)| !records.is_empty()) {
        let follows = s > 0 && !chain[s - 1].is_empty();
        let is_other = s > 0 && chain[s - 1] != *records;
        if !follows || is_relative && is_other {
            let is_rate = records.iter().any(|&record| values[record as usize].is_rate);
            is_relative = s > 0 && is_rate;
            all.push(vec![Vec::new(); chain.len()]);
        }
        if let Some(part) = all.last_mut() {
            part[s].clone_from(records);
        }
    }
    all
}

/// What several lines say of one degree of freedom, as one function. `chain` are the records of each stage. Loads act from the start of the run where the deck
/// says so; displacements begin with zero and get to such a value in the first increment, those of a later stage begin where the nodes are then. Loads that end
/// fall to zero, supports keep their last value and are not active.
pub(crate) fn history(chain: &Chain, values: &[Value], timeline: &Timeline, deck: &Deck, is_load: bool) -> History {
    let mut rows: Vec<[f64; 2]> = Vec::new();
    let mut old = 0.0;
    let mut ramp_until = None;
    let begin = chain.iter().position(|records| !records.is_empty()).unwrap_or(0);
    for (s, (stage, records)) in timeline.stages.iter().zip(chain).enumerate() {
        if !is_load && s < begin {
            continue;
        }
        // Where the nodes are at the start is not known.
        let begins_anywhere = !is_load && s == begin && s > 0;
        let (start, end) = (stage.start, stage.end);
        let records: Vec<Value> = records.iter().map(|&record| values[record as usize]).collect();
        let continues = s > 0 && chain[s - 1] == chain[s];
        let scaled = |record: &Value, time: f64| {
            record.amplitude.map_or(0.0, |a| {
                let amplitude = &deck.amplitudes[a];
                record.value * interpolate(&amplitude.points, time - origin(amplitude, start))
            })
        };
        let is_total = |record: &&Value| record.amplitude.is_some_and(|a| deck.amplitudes[a].is_total_time);
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
            let amplitude = &deck.amplitudes[a];
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
            let soon = start + stage.first.min(end - start);
            times.retain(|time| *time > soon);
            times.push(soon.min(end));
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        rows.extend(times.iter().map(|&time| [time, value(time)]));
        old = value(end);
    }
    rows.dedup_by(|later, earlier| later[0] <= earlier[0]);
    let active = chain.iter().map(|records| !records.is_empty()).collect();
    History { active, rows: without_repeats(rows), ramp_until }
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
        Timeline { stages: vec![stage(0, 0.0, 1.0, is_sudden), stage(1, 1.0, 3.0, is_sudden)] }
    }

    fn plain(value: f64) -> Value {
        Value { value, amplitude: None, is_rate: false }
    }

    fn deck() -> Deck {
        let place = DeckPlace { file: 0, line: 1 };
        let amplitude = |name: &str, is_total_time| Amplitude {
            name: name.to_owned(),
            is_total_time,
            points: vec![[0.0, 0.0], [0.5, 1.0], [2.0, 4.0]],
            place,
        };
        Deck { amplitudes: vec![amplitude("own", false), amplitude("total", true)], ..Deck::default() }
    }

    fn rows(chain: &[&[u32]], values: &[Value], timeline: &Timeline, is_load: bool) -> Vec<[f64; 2]> {
        let chain: Vec<Vec<u32>> = chain.iter().map(|records| records.to_vec()).collect();
        history(&chain, values, timeline, &deck(), is_load).rows
    }

    #[test]
    fn values_grow_over_a_static_step_and_stay() {
        let values = [plain(5.0), plain(-1.0)];
        assert_eq!(rows(&[&[0], &[0]], &values, &two(false), false), [[0.0, 0.0], [1.0, 5.0]]);
        // Said again: from the value that there is. Without an end a load falls to zero, a support keeps its value.
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
        let late = |value, is_sudden| history(&vec![vec![], vec![0]], &[value], &two(is_sudden), &deck(), false);
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
        let of = |chain: &[&[u32]]| parts(&chain.iter().map(|records| records.to_vec()).collect(), &values);
        assert_eq!(of(&[&[0], &[1], &[1]]), [[vec![0], vec![1], vec![1]]]);
        assert_eq!(of(&[&[0], &[], &[1]]), [[vec![0], vec![], vec![]], [vec![], vec![], vec![1]]]);
        // From the start on a velocity has a known beginning.
        assert_eq!(of(&[&[2], &[1], &[]]), [[vec![2], vec![1], vec![]]]);
        assert_eq!(of(&[&[], &[2], &[1]]), [[vec![], vec![2], vec![]], [vec![], vec![], vec![1]]]);
        assert_eq!(of(&[&[], &[2], &[2]]), [[vec![], vec![2], vec![2]]]);
    }
}
