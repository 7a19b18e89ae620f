//! Rigid motions that are left free, by linear algebra on few numbers.
//!
//! A body has six: `a + w x (X - c)` with the velocity `a` of its centre `c`. Vectors here hold `a` and `w` times a length of the body, so that all entries mean
//! the same.

/// Part of the largest eigenvalue below which a motion is free.
const FREE: f64 = 1e-10;

/// Sweeps of the eigenvalue iteration; ten are more than enough for double precision.
const SWEEPS: usize = 60;

/// What a body may do.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Motions {
    /// Directions along which it may slide.
    pub translations: Vec<[f64; 3]>,
    /// Axes about which it may turn, each with a point of it if it may not slide everywhere.
    pub rotations: Vec<([f64; 3], Option<[f64; 3]>)>,
}

/// Orthonormal null vectors of a symmetric, positive semi-definite matrix, by Jacobi's iteration.
pub(super) fn null_space(mut m: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = m.len();
    let mut v: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(i == j)).collect()).collect();
    for _ in 0..SWEEPS {
        let off: f64 = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| m[i][j] * m[i][j]).sum();
        let all: f64 = (0..n).map(|i| m[i][i] * m[i][i]).sum::<f64>() + off;
        if off <= 1e-30 * all {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if m[p][q] == 0.0 {
                    continue;
                }
                let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let t = if theta == 0.0 { 1.0 } else { t };
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..n {
                    (m[k][p], m[k][q]) = (c * m[k][p] - s * m[k][q], s * m[k][p] + c * m[k][q]);
                }
                for k in 0..n {
                    (m[p][k], m[q][k]) = (c * m[p][k] - s * m[q][k], s * m[p][k] + c * m[q][k]);
                }
                for row in &mut v {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
            }
        }
    }
    let largest = (0..n).map(|i| m[i][i]).fold(0.0, f64::max);
    let free = (0..n).filter(|&i| m[i][i] <= FREE * largest || largest == 0.0);
    free.map(|i| v.iter().map(|row| row[i]).collect()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// An orthonormal basis of what some vectors span.
fn span(vectors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut left: Vec<Vec<f64>> = vectors.to_vec();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let largest = left.iter().map(|v| dot(v, v)).fold(0.0, f64::max);
    while let Some(place) = (0..left.len()).max_by(|&a, &b| dot(&left[a], &left[a]).total_cmp(&dot(&left[b], &left[b])))
    {
        let v = left.swap_remove(place);
        let length = dot(&v, &v).sqrt();
        if length <= 1e-7 || length * length <= 1e-12 * largest {
            break;
        }
        let v: Vec<f64> = v.iter().map(|x| x / length).collect();
        for other in &mut left {
            let along = dot(other, &v);
            other.iter_mut().zip(&v).for_each(|(x, v)| *x -= along * v);
        }
        basis.push(v);
    }
    basis
}

/// Directions that span a space of them: axes of coordinates if these do.
fn directions(basis: &[Vec<f64>]) -> Vec<[f64; 3]> {
    let within = |axis: &usize| basis.iter().map(|v| v[*axis] * v[*axis]).sum::<f64>() > 1.0 - 1e-6;
    let axes: Vec<usize> = (0..3).filter(within).collect();
    if axes.len() == basis.len() {
        return axes.iter().map(|&axis| std::array::from_fn(|i| f64::from(i == axis))).collect();
    }
    basis.iter().map(|v| std::array::from_fn(|i| v[i])).collect()
}

/// Tells the rigid motions of a body with this centre and length, `vectors` of six numbers, by what people call them.
pub(super) fn motions(vectors: &[Vec<f64>], centre: [f64; 3], length: f64) -> Motions {
    let basis = span(vectors);
    let k = basis.len();
    // Combinations without rotation: null vectors of the rotational parts' products.
    let products = (0..k).map(|i| (0..k).map(|j| dot(&basis[i][3..], &basis[j][3..])).collect()).collect();
    let combine = |y: &Vec<f64>| -> Vec<f64> { (0..6).map(|c| (0..k).map(|i| y[i] * basis[i][c]).sum()).collect() };
    let still: Vec<Vec<f64>> = match basis.iter().all(|v| dot(&v[3..], &v[3..]) < 1e-12) {
        true => basis.clone(),
        false => null_space(products).iter().map(combine).collect(),
    };
    let slides = span(&still.iter().map(|v| v[..3].to_vec()).collect::<Vec<_>>());
    let turns: Vec<Vec<f64>> = basis
        .iter()
        .map(|v| {
            let mut v = v.clone();
            for slide in &slides {
                let along = dot(&v[..3], slide);
                v[..3].iter_mut().zip(slide).for_each(|(x, s)| *x -= along * s);
            }
            v
        })
        .collect();
    let spins = span(&turns.iter().map(|v| v[3..].to_vec()).collect::<Vec<_>>());
    let rotations = directions(&spins).into_iter().map(|axis| {
        // The combination of turns whose rotation is the axis, by least squares over an orthonormal basis of rotations.
        let mut total = [0.0; 6];
        for v in eliminated(&turns, &spins) {
            let along = dot(&v[3..], &axis);
            total.iter_mut().zip(&v).for_each(|(t, v)| *t += along * v);
        }
        let a: [f64; 3] = std::array::from_fn(|i| total[i] * length);
        let arm = cross(axis, a);
        (axis, (slides.len() < 2).then(|| std::array::from_fn(|i| centre[i] + arm[i])))
    });
    let rotations = rotations.collect();
    Motions { translations: directions(&slides), rotations }
}

/// Combinations of vectors whose rotations are the vectors of an orthonormal basis.
fn eliminated(turns: &[Vec<f64>], spins: &[Vec<f64>]) -> Vec<Vec<f64>> {
    // Gram-Schmidt of the rotational parts, done to the whole vectors.
    let mut left = turns.to_vec();
    let mut list: Vec<Vec<f64>> = Vec::new();
    while list.len() < spins.len() {
        let size = |v: &Vec<f64>| dot(&v[3..], &v[3..]);
        let Some(place) = (0..left.len()).max_by(|&a, &b| size(&left[a]).total_cmp(&size(&left[b]))) else { break };
        let v = left.swap_remove(place);
        let length = size(&v).sqrt();
        let v: Vec<f64> = v.iter().map(|x| x / length).collect();
        for other in &mut left {
            let along = dot(&other[3..], &v[3..]);
            other.iter_mut().zip(&v).for_each(|(x, v)| *x -= along * v);
        }
        list.push(v);
    }
    list
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A direction in words.
fn axis_name(axis: &[f64; 3]) -> String {
    match (0..3).find(|&i| axis[i].abs() > 1.0 - 1e-9) {
        Some(i) => ["x", "y", "z"][i].to_owned(),
        None => format!("({:.3}, {:.3}, {:.3})", axis[0], axis[1], axis[2]),
    }
}

fn list(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

impl std::fmt::Display for Motions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let slides: Vec<String> = self.translations.iter().map(axis_name).collect();
        let turn = |(axis, point): &([f64; 3], Option<[f64; 3]>)| match point {
            None => axis_name(axis),
            Some(x) => {
                format!("{} through ({:.4}, {:.4}, {:.4})", axis_name(axis), clean(x[0]), clean(x[1]), clean(x[2]))
            }
        };
        let turns: Vec<String> = self.rotations.iter().map(turn).collect();
        match (slides.as_slice(), turns.as_slice()) {
            ([], []) => f.write_str("not free"),
            (slides, []) => write!(f, "free to slide along {}", list(slides)),
            ([], turns) => write!(f, "free to turn about {}", list(turns)),
            (slides, turns) => write!(f, "free to slide along {} and to turn about {}", list(slides), list(turns)),
        }
    }
}

/// The number without the sign of zero; zero for what is round-off.
fn clean(x: f64) -> f64 {
    if x.abs() < 5e-5 { 0.0 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of a body with the centre `c` and the length 2 whose nodes are held in these components.
    fn gram(held: &[([f64; 3], usize)], c: [f64; 3]) -> Vec<Vec<f64>> {
        let mut gram = vec![vec![0.0; 6]; 6];
        for (x, i) in held {
            let r: [f64; 3] = std::array::from_fn(|k| (x[k] - c[k]) / 2.0);
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let mut row = [0.0; 6];
            (row[*i], row[3 + j], row[3 + k]) = (1.0, r[k], -r[j]);
            (0..6).for_each(|a| (0..6).for_each(|b| gram[a][b] += row[a] * row[b]));
        }
        gram
    }

    fn words(held: &[([f64; 3], usize)], c: [f64; 3]) -> String {
        motions(&null_space(gram(held, c)), c, 2.0).to_string()
    }

    #[test]
    fn free_motions_have_the_names_that_people_give_them() {
        let c = [1.0, 0.5, 0.25];
        assert_eq!(words(&[], c), "free to slide along x, y and z and to turn about x, y and z");
        // A face held along its normal.
        let face = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
        let normal: Vec<_> = face.iter().map(|&x| (x, 0)).collect();
        assert_eq!(words(&normal, c), "free to slide along y and z and to turn about x");
        // A hinge along y through (0, ., 0.2).
        let hinge: Vec<_> =
            [[0.0, 0.0, 0.2], [0.0, 1.0, 0.2]].iter().flat_map(|&x| (0..3).map(move |i| (x, i))).collect();
        assert_eq!(words(&hinge, c), "free to turn about y through (0.0000, 0.5000, 0.2000)");
        // A slider: two faces held along their normals.
        let two: Vec<_> = face.iter().flat_map(|&x| [(x, 0), ([x[2], x[0], x[1]], 1)]).collect();
        assert_eq!(words(&two, c), "free to slide along z");
        let all: Vec<_> = face.iter().flat_map(|&x| (0..3).map(move |i| (x, i))).collect();
        assert_eq!(words(&all, c), "not free");
    }

    #[test]
    fn an_oblique_axis_is_found() {
        // Two points held: the axis goes through both.
        let (a, b) = ([0.0, 0.0, 0.0], [1.0, 1.0, 0.0]);
        let held: Vec<_> = [a, b].iter().flat_map(|&x| (0..3).map(move |i| (x, i))).collect();
        let c = [0.3, 0.9, 0.4];
        let found = motions(&null_space(gram(&held, c)), c, 2.0);
        let [(axis, Some(point))] = found.rotations[..] else { panic!("{found:?}") };
        let away = cross(axis, point);
        assert!(found.translations.is_empty() && (axis[0] - axis[1]).abs() < 1e-9 && axis[2].abs() < 1e-9, "{found:?}");
        assert!(away.iter().all(|x| x.abs() < 1e-9), "{found:?}");
    }
}
