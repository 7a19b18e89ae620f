//! Gaps that contact keeps between surfaces in place of zero: what is seen counts beyond them.

use crate::{Meeting, Observation};
use serde::{Deserialize, Serialize};

/// The smallest and the largest gap (lengths; an overlap has a minus) that a contact keeps between two bodies, at times between which they are linear.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptGaps {
    /// The two bodies.
    pub bodies: [usize; 2],
    /// Rows of time, smallest and largest gap, with increasing times.
    pub rows: Vec<[f64; 3]>,
}

impl KeptGaps {
    /// Smallest and largest gap at a time.
    pub fn at(&self, time: f64) -> [f64; 2] {
        let after = self.rows.partition_point(|row| row[0] <= time);
        match (after.checked_sub(1).map(|before| self.rows[before]), self.rows.get(after)) {
            (Some([t0, a0, b0]), Some(&[t1, a1, b1])) => {
                let s = (time - t0) / (t1 - t0);
                [a0 + s * (a1 - a0), b0 + s * (b1 - b0)]
            }
            (Some([_, a, b]), None) | (None, Some(&[_, a, b])) => [a, b],
            (None, None) => [0.0; 2],
        }
    }

    fn is_between(&self, [a, b]: [usize; 2]) -> bool {
        self.bodies == [a, b] || self.bodies == [b, a]
    }

    /// What is kept between two bodies at a time; of several contacts between them the smallest and the largest.
    fn between(kept: &[Self], bodies: [usize; 2], time: f64) -> [f64; 2] {
        let all = kept.iter().filter(|kept| kept.is_between(bodies)).map(|kept| kept.at(time));
        all.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default()
    }
}

impl Observation {
    /// Counts depths beyond the overlaps that contacts keep at a time.
    #[must_use]
    pub fn beyond(mut self, kept: &[KeptGaps], time: f64) -> Self {
        for found in &mut self.penetrations {
            let [least, _] = KeptGaps::between(kept, [found.body, found.into], time);
            let depth = found.depth + least.min(0.0);
            if depth < found.depth {
                found.relative *= depth.max(0.0) / found.depth;
                found.depth = depth.max(0.0);
            }
        }
        self.penetrations.retain(|found| found.depth > 0.0);
        self
    }
}

impl Meeting {
    /// Counts what is left between the bodies, and what drives them, from the gaps that contacts keep at a time: an interference drives them into each other, an overlap that stays does not.
    #[must_use]
    pub fn beyond(self, kept: &[KeptGaps], time: f64) -> Self {
        let [least, most] = KeptGaps::between(kept, self.bodies, time);
        Self {
            apart: (self.apart - most.max(0.0)).max(0.0),
            drive: self.drive + most.max(0.0) + least.min(0.0),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Penetration;

    #[test]
    fn what_is_seen_counts_beyond_what_is_kept() {
        let kept = [KeptGaps { bodies: [1, 0], rows: vec![[0.0, -0.2, 0.0], [2.0, 0.0, 0.4]] }];
        assert_eq!((kept[0].at(-1.0), kept[0].at(1.0), kept[0].at(3.0)), ([-0.2, 0.0], [-0.1, 0.2], [0.0, 0.4]));
        let deep = |depth| Penetration { body: 0, node: 2, into: 1, depth, relative: 2.0 * depth, position: [0.0; 3] };
        let seen = |depth| Observation { penetrations: vec![deep(depth)], ..Observation::default() };
        assert!(seen(0.05).beyond(&kept, 1.0).penetrations.is_empty());
        let left = seen(0.15).beyond(&kept, 1.0).penetrations[0].clone();
        assert!((left.depth - 0.05).abs() < 1e-15 && (left.relative - 0.1).abs() < 1e-15);
        assert_eq!(seen(0.15).beyond(&[], 1.0).penetrations[0].depth, 0.15);
        let meeting = Meeting {
            bodies: [0, 1],
            node: 0,
            position: [0.0; 3],
            apart: 0.41,
            edge: 1.0,
            drive: 0.0,
            arch: 0.0,
            known_arches: 0.0,
            by_loads: false,
        };
        let beyond = meeting.beyond(&kept, 3.0);
        assert!((beyond.apart - 0.01).abs() < 1e-15 && beyond.drive == 0.4);
    }
}
