//! Numbers and paths of SVG texts: tenths of a pixel, as short as the format allows.

use std::fmt::Write;

/// A number of pixels, rounded to tenths, without needless digits.
pub fn pixels(value: f64) -> String {
    tenths((value * 10.0).round())
}

/// A number of tenths without needless digits.
pub fn tenths(value: f64) -> String {
    // The sum turns a negative zero into zero.
    let text = format!("{}", value / 10.0 + 0.0);
    match (text.strip_prefix("0."), text.strip_prefix("-0.")) {
        (Some(digits), _) => format!(".{digits}"),
        (_, Some(digits)) => format!("-.{digits}"),
        _ => text,
    }
}

/// Appends the commands of a path through points: the first absolute, the others relative to the rounded point before, so that rounding does not add up.
pub fn path(out: &mut String, points: &[[f64; 2]]) {
    let mut last: Option<[f64; 2]> = None;
    let mut command = ' ';
    for point in points {
        let rounded = point.map(|x| (x * 10.0).round());
        let [x, y] = last.map_or(rounded, |last| [rounded[0] - last[0], rounded[1] - last[1]]);
        let (next, numbers): (char, &[f64]) = match last {
            None => ('M', &[x, y]),
            Some(_) if y == 0.0 => ('h', &[x]),
            Some(_) if x == 0.0 => ('v', &[y]),
            Some(_) => ('l', &[x, y]),
        };
        // Numbers after a command's own ones repeat it.
        let mut before = None;
        if next == command {
            before =
                Some(out.rsplit(|c: char| !c.is_ascii_digit() && c != '.').next().unwrap_or_default().contains('.'));
        } else {
            out.push(next);
        }
        for number in numbers {
            let text = tenths(*number);
            let stands_apart = text.starts_with('-') || text.starts_with('.') && before == Some(true);
            let blank = if before.is_none() || stands_apart { "" } else { " " };
            // Writing to a String does not fail.
            let _ = write!(out, "{blank}{text}");
            before = Some(text.contains('.'));
        }
        (command, last) = (next, Some(rounded));
    }
}

/// The points of a line that are needed so that it stays within `distance` of all others (Douglas and Peucker).
pub fn simplified(points: &[(f64, f64)], distance: f64) -> Vec<(f64, f64)> {
    let mut kept = vec![false; points.len()];
    let mut spans = vec![(0, points.len().saturating_sub(1))];
    while let Some((first, last)) = spans.pop() {
        for end in [first, last] {
            if let Some(kept) = kept.get_mut(end) {
                *kept = true;
            }
        }
        let off_line = |k: &usize| distance_to_segment(points[*k], points[first], points[last]);
        let inner = first + 1..last.max(first + 1);
        let Some(farthest) = inner.max_by(|a, b| off_line(a).total_cmp(&off_line(b))) else { continue };
        if off_line(&farthest) > distance {
            spans.extend([(first, farthest), (farthest, last)]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

/// Distance of `p` from the segment between `a` and `b`.
fn distance_to_segment(p: (f64, f64), a: (f64, f64), b: (f64, f64)) -> f64 {
    let (along, to) = ((b.0 - a.0, b.1 - a.1), (p.0 - a.0, p.1 - a.1));
    let square = along.0 * along.0 + along.1 * along.1;
    let t = if square > 0.0 { ((to.0 * along.0 + to.1 * along.1) / square).clamp(0.0, 1.0) } else { 0.0 };
    (to.0 - t * along.0).hypot(to.1 - t * along.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_in_paths_are_short_and_exact() {
        assert_eq!([pixels(14.04), pixels(-0.5), pixels(-0.04), pixels(0.25)], ["14", "-.5", "0", ".3"]);
        let mut out = String::new();
        path(&mut out, &[[1.26, 0.5], [1.26, 0.5], [0.0, 10.0], [2.0, 20.0], [1.5, 20.4], [1.6, 20.9], [1.6, 19.0]]);
        assert_eq!(out, "M1.3.5h0l-1.3 9.5 2 10-.5.4.1.5v-1.9");
    }

    /// Points of a path of the commands that are written here.
    fn points_of(path: &str) -> Vec<[f64; 2]> {
        let mut points: Vec<[f64; 2]> = Vec::new();
        let mut command = ' ';
        let mut rest = path;
        let mut numbers = Vec::new();
        while let Some(first) = rest.chars().next() {
            if first.is_ascii_alphabetic() {
                (command, rest) = (first, &rest[1..]);
                continue;
            }
            if first == ' ' {
                rest = &rest[1..];
                continue;
            }
            // The longest number: a sign, digits, at most one point.
            let mut has_point = false;
            let is_part = |(k, c): &(usize, char)| match c {
                '-' => *k == 0,
                '.' => !std::mem::replace(&mut has_point, true),
                c => c.is_ascii_digit(),
            };
            let length = rest.char_indices().take_while(is_part).count();
            numbers.push(rest[..length].parse::<f64>().unwrap());
            rest = &rest[length..];
            let wanted = if matches!(command, 'h' | 'v') { 1 } else { 2 };
            if numbers.len() == wanted {
                let last = points.last().copied().unwrap_or_default();
                points.push(match command {
                    'M' => [numbers[0], numbers[1]],
                    'l' => [last[0] + numbers[0], last[1] + numbers[1]],
                    'h' => [last[0] + numbers[0], last[1]],
                    'v' => [last[0], last[1] + numbers[0]],
                    other => panic!("{other}"),
                });
                numbers.clear();
            }
        }
        points
    }

    proptest! {
        #[test]
        fn a_path_goes_through_its_points(points in proptest::collection::vec([-20.0..20.0_f64, -2.0..2.0], 0..12)) {
            let mut out = String::new();
            path(&mut out, &points);
            let read = points_of(&out);
            prop_assert_eq!(read.len(), points.len(), "{}", out);
            for (read, point) in read.iter().flatten().zip(points.iter().flatten()) {
                prop_assert!((read - point).abs() < 0.05 + 1e-9, "{}", out);
            }
        }

        #[test]
        fn a_simplified_line_is_near_all_points(points in proptest::collection::vec((-9.0..9.0_f64, -9.0..9.0_f64), 0..30)) {
            let few = simplified(&points, 2.0);
            prop_assert_eq!((few.first(), few.last()), (points.first(), points.last()));
            for point in &points {
                let near = few.windows(2).any(|ends| distance_to_segment(*point, ends[0], ends[1]) <= 2.0);
                prop_assert!(near || few.contains(point));
            }
        }
    }

    #[test]
    fn points_on_a_straight_line_are_left_out() {
        let line: Vec<(f64, f64)> = (0..50).map(|k| (f64::from(k), 0.5 * f64::from(k))).collect();
        assert_eq!(simplified(&line, 0.1), [line[0], line[49]]);
        assert!(simplified(&[], 0.1).is_empty());
    }
}
