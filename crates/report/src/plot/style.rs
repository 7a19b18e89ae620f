//! Colours, dashes and markers that keep many series apart.

use super::canvas::{Canvas, Stroke};

/// Colours that stay apart for most kinds of colour vision (Okabe and Ito).
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#5a5a5a"];

/// Dashes: the second is used when all colours are used up, and so on.
const DASHES: [&str; 4] = ["", "7 4", "2 3", "9 3 2 3"];

/// Markers change faster than colours, and come together with the same colour late only: 6 and 7 have no common
/// divisor.
const MARKERS: [Marker; 7] =
    [Marker::Disc, Marker::Square, Marker::Up, Marker::Diamond, Marker::Cross, Marker::Down, Marker::Plus];

/// Shape of a marked point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Marker {
    Disc,
    Square,
    Up,
    Diamond,
    Cross,
    Down,
    Plus,
}

/// Colour, dash and marks of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    colour: &'static str,
    dash: &'static str,
    marker: Marker,
}

impl Style {
    /// The style of the series with this number, from 0.
    pub fn new(number: usize) -> Self {
        Self {
            colour: COLOURS[number % COLOURS.len()],
            dash: DASHES[number / COLOURS.len() % DASHES.len()],
            marker: MARKERS[number % MARKERS.len()],
        }
    }

    /// The line.
    pub fn stroke(self) -> Stroke<'static> {
        Stroke { colour: self.colour, width: 1.8, dash: self.dash }
    }

    /// The marker around a point.
    pub fn mark(self, canvas: &mut Canvas, (x, y): (f64, f64)) {
        let open = Stroke { colour: self.colour, width: 1.6, dash: "" };
        let around = |offsets: &[(f64, f64)]| offsets.iter().map(|(dx, dy)| (x + dx, y + dy)).collect::<Vec<_>>();
        match self.marker {
            Marker::Disc => canvas.disc((x, y), 3.2, self.colour),
            Marker::Square => canvas.polygon(&around(&[(-3., -3.), (3., -3.), (3., 3.), (-3., 3.)]), self.colour),
            Marker::Up => canvas.polygon(&around(&[(-3.7, 3.), (3.7, 3.), (0., -4.)]), self.colour),
            Marker::Diamond => canvas.polygon(&around(&[(-4., 0.), (0., 4.), (4., 0.), (0., -4.)]), self.colour),
            Marker::Down => canvas.polygon(&around(&[(-3.7, -3.), (3.7, -3.), (0., 4.)]), self.colour),
            Marker::Cross => {
                canvas.line((x - 3.2, y - 3.2), (x + 3.2, y + 3.2), open);
                canvas.line((x - 3.2, y + 3.2), (x + 3.2, y - 3.2), open);
            }
            Marker::Plus => {
                canvas.line((x - 4., y), (x + 4., y), open);
                canvas.line((x, y - 4.), (x, y + 4.), open);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_dozen_series_look_different_with_and_without_markers() {
        for i in 0..24 {
            for j in 0..i {
                let (a, b) = (Style::new(i), Style::new(j));
                assert_ne!((a.colour, a.dash), (b.colour, b.dash), "{i} and {j}");
                assert_ne!((a.colour, a.marker), (b.colour, b.marker), "{i} and {j}");
            }
        }
    }
}
