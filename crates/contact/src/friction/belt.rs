//! A surface that moves along itself while its mesh stays: a belt (theory/friction#belt).

/// Velocity of the master's surface beside that of its nodes, fixed in space: linear in time between rows `(time, velocity)`, constant before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceVelocity {
    rows: Vec<(f64, [f64; 3])>,
}

impl SurfaceVelocity {
    /// Rows with increasing times; without any the surface stays.
    pub fn new(rows: Vec<(f64, [f64; 3])>) -> Self {
        Self { rows }
    }

    /// Whether it ever moves.
    pub fn moves(&self) -> bool {
        self.rows.iter().any(|(_, velocity)| *velocity != [0.0; 3])
    }

    fn at(&self, time: f64) -> [f64; 3] {
        let next = self.rows.partition_point(|(t, _)| *t <= time);
        match (next.checked_sub(1).map(|k| self.rows[k]), self.rows.get(next)) {
            (Some((_, v)), None) | (None, Some(&(_, v))) => v,
            (None, None) => [0.0; 3],
            (Some((t_0, v_0)), Some(&(t_1, v_1))) => {
                let part = (time - t_0) / (t_1 - t_0);
                std::array::from_fn(|i| v_0[i] + part * (v_1[i] - v_0[i]))
            }
        }
    }

    /// The way of the surface from one time to another, `int v dt`, exactly.
    pub fn way(&self, from: f64, to: f64) -> [f64; 3] {
        let inside = self.rows.iter().map(|(t, _)| *t).filter(|t| *t > from && *t < to);
        let mut times: Vec<f64> = std::iter::once(from).chain(inside).collect();
        times.push(to);
        let mut way = [0.0; 3];
        for pair in times.windows(2) {
            let (a, b) = (self.at(pair[0]), self.at(pair[1]));
            way.iter_mut().enumerate().for_each(|(i, way)| *way += 0.5 * (pair[1] - pair[0]) * (a[i] + b[i]));
        }
        way
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_is_the_integral() {
        let belt = SurfaceVelocity::new(vec![(0.0, [1.0, 0.0, 0.0]), (2.0, [3.0, 0.0, -1.0])]);
        assert!(belt.moves() && !SurfaceVelocity::new(vec![(0.0, [0.0; 3])]).moves());
        // v_x = 1 + t, then 3: from -1 to 3 it is 1 + 4 + 3.
        let way = belt.way(-1.0, 3.0);
        assert!((way[0] - 8.0).abs() < 1e-15 && (way[2] + 2.0).abs() < 1e-15, "{way:?}");
    }
}
