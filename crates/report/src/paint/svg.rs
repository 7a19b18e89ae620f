//! Pictures as SVG texts.

use std::fmt::Write;

use super::canvas::{Anchor, Canvas, Colour, DOT, EDGE, EDGE_OPACITY, EDGE_WIDTH, INK, LINE, RIM};
use super::colour::hex;
use crate::svg_path::{path, pixels, tenths};

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
        let _ = writeln!(
            self.0,
            "<text x=\"{}\" y=\"{}\" font-size=\"{size}\"{anchor}>{text}</text>",
            pixels(x),
            pixels(y)
        );
    }

    fn rectangle(&mut self, colour: Colour, [x, y]: [f64; 2], [width, height]: [f64; 2]) {
        let _ = write!(self.0, "<path fill=\"{}\" d=\"", hex(colour));
        path(&mut self.0, &[[x, y], [x + width, y], [x + width, y + height], [x, y + height]]);
        self.0.push_str("z\"/>\n");
    }

    fn enter(&mut self, [x, y]: [f64; 2]) {
        let _ = writeln!(
            self.0,
            "<g transform=\"translate({} {})\" fill=\"none\" stroke-opacity=\"{}\" \
             stroke-width=\"{}\" stroke-linejoin=\"round\">",
            pixels(x),
            pixels(y),
            tenths(EDGE_OPACITY * 10.0),
            tenths(EDGE_WIDTH * 10.0)
        );
    }

    fn leave(&mut self) {
        self.0.push_str("</g>\n");
    }

    fn piece(&mut self, colour: Colour, corners: &[[f64; 2]; 4]) {
        let _ = write!(self.0, "<path fill=\"{}\" d=\"", hex(colour));
        path(&mut self.0, corners);
        self.0.push_str("z\"/>\n");
    }

    fn edges(&mut self, corners: &[[f64; 2]; 4], chosen: [bool; 4]) {
        if !chosen.contains(&true) {
            return;
        }
        // Most paths are pieces, which have no stroke: only edges name theirs.
        let _ = write!(self.0, "<path stroke=\"{}\" d=\"", hex(EDGE));
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
            "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"{}\" stroke-opacity=\"1\" stroke-width=\"{RIM}\"/>",
            pixels(x),
            pixels(y),
            hex(EDGE)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped() {
        let mut svg = Svg::new([10.0, 10.0], [10.0, 10.0]);
        svg.text("a < b & c", [1.0, 2.0], 12.0, Anchor::Start);
        assert!(svg.finish().contains(">a &lt; b &amp; c<"));
    }
}
