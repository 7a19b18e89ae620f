//! Numbers of rows in PETSc: rank by rank; in each the nodes with three rows each, then the other equations.

use stoss_linalg::{EquationPlace, LinalgError};

/// The rows of all equations, and what this rank has of them.
#[derive(Debug, Default)]
pub struct Rows {
    /// Row of each equation.
    pub of_equation: Vec<i32>,
    /// Rows of each rank.
    pub counts: Vec<usize>,
    /// Rows of this rank that stand for prescribed components: they have no equation, and there are three rows a node all the same.
    pub padding: Vec<i32>,
    /// First row of this rank.
    pub first: usize,
    /// Equations of this rank.
    pub own: Vec<u32>,
    /// Six rigid motions of the rows of this rank, one after the other; empty if there are equations that are not of nodes.
    pub motions: Vec<f64>,
    /// Equations that are not of nodes.
    pub others: usize,
}

/// Sorts nodes before what is not of nodes, and nodes together.
fn key(place: &EquationPlace) -> (bool, u32, u32, u8) {
    match *place {
        EquationPlace::Node { body, node, component, .. } => (false, body, node, component),
        EquationPlace::Multiplier { .. } | EquationPlace::Other => (true, 0, 0, 0),
    }
}

/// A row of the six rigid motions: three translations, rotations about the three axes.
fn motion(position: [f64; 3], component: usize) -> [f64; 6] {
    let [x, y, z] = position;
    match component {
        0 => [1.0, 0.0, 0.0, 0.0, z, -y],
        1 => [0.0, 1.0, 0.0, -z, 0.0, x],
        _ => [0.0, 0.0, 1.0, y, -x, 0.0],
    }
}

impl Rows {
    /// Rows of equations with these places and owners, for one of `size` ranks.
    ///
    /// # Errors
    /// [`LinalgError::TooLarge`] for 2^31 rows and more.
    pub fn new(places: &[EquationPlace], owners: &[u32], rank: usize, size: usize) -> Result<Self, LinalgError> {
        let mut order: Vec<u32> = (0..places.len() as u32).collect();
        order.sort_by_key(|&e| (owners[e as usize], key(&places[e as usize])));
        let middle = middle(places);
        let others = places.iter().filter(|place| key(place).0).count();
        let mut rows = Self { of_equation: vec![0; places.len()], counts: vec![0; size], others, ..Self::default() };
        let (mut next, mut motions) = (0_usize, Vec::new());
        let same_node = |a: &u32, b: &u32| {
            let of = |e: u32| (owners[e as usize], key(&places[e as usize]));
            let ((owner_a, a), (owner_b, b)) = (of(*a), of(*b));
            owner_a == owner_b && !a.0 && (a.0, a.1, a.2) == (b.0, b.1, b.2)
        };
        for group in order.chunk_by(same_node) {
            let owner = owners[group[0] as usize] as usize;
            let height = if key(&places[group[0] as usize]).0 { 1 } else { 3 };
            let mut has = [false; 3];
            for &e in group {
                let component = usize::from(key(&places[e as usize]).3);
                has[component] = true;
                rows.of_equation[e as usize] = row_number(next + component)?;
                if owner == rank {
                    rows.own.push(e);
                }
            }
            if owner == rank {
                for component in 0..height {
                    if !has[component] {
                        rows.padding.push(row_number(next + component)?);
                    }
                    motions.push(match &places[group[0] as usize] {
                        EquationPlace::Node { position, .. } if has[component] => {
                            motion(std::array::from_fn(|d| position[d] - middle[d]), component)
                        }
                        _ => [0.0; 6],
                    });
                }
            }
            rows.counts[owner] += height;
            next += height;
        }
        rows.first = rows.counts[..rank].iter().sum();
        if others == 0 {
            rows.motions = (0..6).flat_map(|m| motions.iter().map(move |row| row[m])).collect();
        }
        Ok(rows)
    }
}

fn row_number(row: usize) -> Result<i32, LinalgError> {
    i32::try_from(row).map_err(|_| LinalgError::TooLarge { what: "rows of PETSc", count: row })
}

/// Mean position of the equations of nodes.
fn middle(places: &[EquationPlace]) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for place in places {
        if let EquationPlace::Node { position, .. } = place {
            (0..3).for_each(|d| sum[d] += position[d]);
            count += 1.0;
        }
    }
    sum.map(|sum| sum / f64::max(count, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(node: u32, component: u8) -> EquationPlace {
        EquationPlace::Node { body: 0, node, component, position: [f64::from(node), 2.0, -1.0] }
    }

    /// Two ranks, a node with a prescribed component, a multiplier: counted by hand.
    #[test]
    fn rows_are_those_of_ranks_and_of_whole_nodes() {
        let multiplier = EquationPlace::Multiplier { pair: 0, slot: 0 };
        let places = [node(4, 0), node(4, 2), node(7, 0), node(7, 1), node(7, 2), multiplier];
        let owners = [1, 1, 0, 0, 0, 0];
        let second = Rows::new(&places, &owners, 1, 2).unwrap();
        assert_eq!(second.of_equation, [4, 6, 0, 1, 2, 3]);
        assert_eq!((second.first, &second.counts[..]), (4, &[4, 3][..]));
        assert_eq!((&second.own[..], &second.padding[..]), (&[0, 1][..], &[5][..]));
        assert!(second.motions.is_empty() && second.others == 1);
        let first = Rows::new(&places, &owners, 0, 2).unwrap();
        assert_eq!((first.first, &first.own[..], first.padding.len()), (0, &[2, 3, 4, 5][..], 0));
    }

    /// Velocities of a rigid motion change no distance: `(x_a - x_b) . (v_a - v_b) = 0`.
    #[test]
    fn motions_are_rigid() {
        let positions = [[0.0, 0.0, 0.0], [1.0, 2.0, -0.5], [0.3, -1.0, 2.0]];
        let places: Vec<EquationPlace> = (0..9)
            .map(|e| EquationPlace::Node {
                body: 0,
                node: e / 3,
                component: (e % 3) as u8,
                position: positions[e as usize / 3],
            })
            .collect();
        let rows = Rows::new(&places, &[0; 9], 0, 1).unwrap();
        for mode in rows.motions.chunks_exact(9) {
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let rate: f64 =
                    (0..3).map(|d| (positions[a][d] - positions[b][d]) * (mode[3 * a + d] - mode[3 * b + d])).sum();
                assert!(rate.abs() < 1e-15, "{mode:?}");
            }
        }
        assert_eq!(rows.motions.len(), 54);
    }
}
