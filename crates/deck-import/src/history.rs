//! Values over time.

use stoss_mesh_io::deck::{Amplitude, Deck};

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
}

impl History {
    /// True if it is zero at all times.
    pub fn is_zero(&self) -> bool {
        self.rows.iter().all(|row| row[1] == 0.0)
    }

    /// The value at a time.
    pub fn at(&self, time: f64) -> f64 {
        interpolate(&self.rows, time)
    }

    /// What two histories have in common if they are the same.
    pub fn key(&self) -> (Vec<bool>, Vec<[u64; 2]>) {
        // Zero has two signs.
        let bits = |x: f64| if x == 0.0 { 0 } else { x.to_bits() };
        (self.active.clone(), self.rows.iter().map(|row| row.map(bits)).collect())
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

/// What several lines say of one degree of freedom, as one function. `chain` are the records of each stage. Loads act from the start of the run where the deck
/// says so; displacements begin with zero and get to such a value in the first increment. Loads that end fall to zero, supports keep their last value and
/// are not active.
pub(crate) fn history(
    chain: &[Vec<u32>],
    values: &[Value],
    timeline: &Timeline,
    deck: &Deck,
    is_load: bool,
) -> History {
    let mut rows: Vec<[f64; 2]> = Vec::new();
    let mut old = 0.0;
    for (s, (stage, records)) in timeline.stages.iter().zip(chain).enumerate() {
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
        let value = |time: f64| {
            let constant = if continues {
                old - scaled_sum(start)
            } else if records.is_empty() && !is_load {
                old
            } else if has_target || records.is_empty() {
                let from = if with_amplitude.is_empty() { old } else { 0.0 };
                let part = if stage.is_sudden { 1.0 } else { (time - start) / (end - start) };
                // Exact at the end.
                if part >= 1.0 { target } else { from + (target - from) * part }
            } else if rate != 0.0 {
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
        if value(start) != old && !acts_at_once {
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
    History { active, rows: without_repeats(rows) }
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
    }
}
