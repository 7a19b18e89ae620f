//! The colour bar below snapshots.

use super::canvas::{Anchor, Canvas, Colour};
use super::letters;

/// Height of the bar with numbers and label, in pixels.
pub const HEIGHT: f64 = 46.0;

/// Colour bar with three numbers, centred at the bottom.
pub fn bar(canvas: &mut dyn Canvas, label: &str, range: (f64, f64), total: [f64; 2], colour: fn(f64, f64) -> Colour) {
    const STEPS: usize = 48;
    let width = (0.5 * total[0]).min(360.0);
    let (left, top) = (0.5 * (total[0] - width), total[1] - HEIGHT);
    for step in 0..STEPS {
        let x = left + width * step as f64 / STEPS as f64;
        // A little of the last one is drawn upon by the next, so that no seams show.
        let wide = width / STEPS as f64 + if step + 1 < STEPS { 1.0 } else { 0.0 };
        canvas.rectangle(colour((step as f64 + 0.5) / STEPS as f64, 1.0), [x, top], [wide, 9.0]);
    }
    for (number, part) in bar_numbers(range).into_iter().zip([0.0, 0.5, 1.0]) {
        canvas.text(&number, [left + part * width, top + 23.0], 12.0, Anchor::Middle);
    }
    canvas.text(label, [0.5 * total[0], top + 39.0], letters::fitted(label, 13.0, 0.95 * total[0]), Anchor::Middle);
}

/// Ends and middle of a range, with as many digits as tell them apart.
fn bar_numbers((least, most): (f64, f64)) -> [String; 3] {
    if least == most {
        return [least; 3].map(short);
    }
    let values = [least, 0.5 * least + 0.5 * most, most];
    let plain = least.abs().max(most.abs()) < 1e5;
    let with = |digits: usize| {
        values.map(|value| if plain { format!("{value:.digits$}") } else { format!("{value:.digits$e}") })
    };
    let differ = |numbers: &[String; 3]| numbers[0] != numbers[1] && numbers[1] != numbers[2];
    let short = values.map(short);
    if differ(&short) {
        return short;
    }
    (2..=16).map(with).find(differ).unwrap_or(short)
}

/// Three significant digits.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if !(1e-2..1e5).contains(&size) => format!("{value:.1e}"),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_at_the_bar_differ() {
        assert_eq!(bar_numbers((0.0, 230.0)), ["0", "115", "230"]);
        assert_eq!(bar_numbers((0.1402, 0.1404)), ["0.1402", "0.1403", "0.1404"]);
        assert_eq!(bar_numbers((2.0e6, 2.02e6)), ["2.00e6", "2.01e6", "2.02e6"]);
    }
}
