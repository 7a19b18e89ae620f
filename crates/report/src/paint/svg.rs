//! Pictures as SVG texts.

use std::fmt::Write;

use super::canvas::{Anchor, Canvas, Colour, DOT, EDGE, EDGE_OPACITY, EDGE_WIDTH, INK, LINE, RIM};
use super::colour::hex;

/// The text of an SVG file that grows. Writing to a String does not fail.
pub struct Svg(String);

impl Svg {
    /// A white picture of this size; `shown` is the size that it has on a screen.
    pub fn new(total: [f64; 2], shown: [f64; 2]) -> Self {
        let mut out = String::new();
        let _ = writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" width=\"{:.0}\" height=\"{:.0}\" \
             font-family=\"sans-serif\" fill=\"{}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>",
            total[0],
            total[1],
            shown[0],
            shown[1],
            hex(INK)
        );
        Self(out)
    }

    /// The whole text.
    pub fn finish(mut self) -> String {
        self.0.push_str("</svg>\n");
        self.0
    }
}

impl Canvas for Svg {
    fn text(&mut self, text: &str, [x, y]: [f64; 2], size: f64, anchor: Anchor) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
        };
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        let _ = writeln!(self.0, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\"{anchor}>{text}</text>");
    }

    fn rectangle(&mut self, colour: Colour, [x, y]: [f64; 2], [width, height]: [f64; 2]) {
        let fill = hex(colour);
        let _ = writeln!(self.0, "<path fill=\"{fill}\" d=\"M{x:.1} {y:.1}h{width:.1}v{height:.1}h-{width:.1}z\"/>");
    }

    fn enter(&mut self, [x, y]: [f64; 2]) {
        let _ = writeln!(
            self.0,
            "<g transform=\"translate({x:.1} {y:.1})\" fill=\"none\" stroke=\"{}\" stroke-opacity=\"{}\" \
             stroke-width=\"{}\" stroke-linejoin=\"round\">",
            hex(EDGE),
            tenths(EDGE_OPACITY * 10.0),
            tenths(EDGE_WIDTH * 10.0)
        );
    }

    fn leave(&mut self) {
        self.0.push_str("</g>\n");
    }

    fn piece(&mut self, colour: Colour, corners: &[[f64; 2]; 4]) {
        let _ = write!(self.0, "<path stroke=\"none\" fill=\"{}\" d=\"", hex(colour));
        path(&mut self.0, corners);
        self.0.push_str("z\"/>\n");
    }

    fn edges(&mut self, corners: &[[f64; 2]; 4], chosen: [bool; 4]) {
        if !chosen.contains(&true) {
            return;
        }
        self.0.push_str("<path d=\"");
        if chosen == [true; 4] {
            path(&mut self.0, corners);
            self.0.push('z');
        } else {
            for k in (0..4).filter(|&k| chosen[k]) {
                path(&mut self.0, &[corners[k], corners[(k + 1) % 4]]);
            }
        }
        self.0.push_str("\"/>\n");
    }

    fn line(&mut self, colour: Colour, ends: &[[f64; 2]; 2]) {
        // Round ends of the colour alone join the parts of a line without gaps.
        for (colour, width, cap) in [(EDGE, LINE + 2.0 * RIM, "butt"), (colour, LINE, "round")] {
            let _ = write!(
                self.0,
                "<path stroke=\"{}\" stroke-opacity=\"1\" stroke-width=\"{width:.1}\" stroke-linecap=\"{cap}\" d=\"",
                hex(colour)
            );
            path(&mut self.0, ends);
            self.0.push_str("\"/>\n");
        }
    }

    fn disc(&mut self, colour: Colour, [x, y]: [f64; 2]) {
        let (fill, radius) = (hex(colour), 0.5 * DOT);
        let _ = writeln!(
            self.0,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{fill}\" stroke-opacity=\"1\" stroke-width=\"{RIM}\"/>"
        );
    }
}

/// Absolute start, then relative lines, in tenths of a pixel.
fn path(out: &mut String, points: &[[f64; 2]]) {
    let mut last = [0.0; 2];
    for (number, point) in points.iter().enumerate() {
        let rounded = point.map(|x| (x * 10.0).round());
        let _ = write!(out, "{}", if number == 0 { 'M' } else { 'l' });
        let [x, y] = [tenths(rounded[0] - last[0]), tenths(rounded[1] - last[1])];
        let _ = write!(out, "{x}{}{y}", if y.starts_with('-') { "" } else { " " });
        last = rounded;
    }
}

/// A number of tenths without needless digits.
fn tenths(value: f64) -> String {
    let text = format!("{}", value / 10.0);
    match (text.strip_prefix("0."), text.strip_prefix("-0.")) {
        (Some(digits), _) => format!(".{digits}"),
        (_, Some(digits)) => format!("-.{digits}"),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_paths_are_short_and_exact() {
        let mut out = String::new();
        path(&mut out, &[[1.26, 0.5], [1.26, 0.5], [0.0, 10.0]]);
        assert_eq!(out, "M1.3 .5l0 0l-1.3 9.5");
    }

    #[test]
    fn texts_are_escaped() {
        let mut svg = Svg::new([10.0, 10.0], [10.0, 10.0]);
        svg.text("a < b & c", [1.0, 2.0], 12.0, Anchor::Start);
        assert!(svg.finish().contains(">a &lt; b &amp; c<"));
    }
}
