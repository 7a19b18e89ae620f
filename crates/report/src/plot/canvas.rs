//! Writing SVG elements. Pixels from the upper left corner, rounded to tenths; attributes that have their default are left out, so that files stay small.

use crate::svg_path::{path, pixels};
use std::fmt::Write;

/// A line's look.
#[derive(Clone, Copy, Debug)]
pub struct Stroke<'a> {
    /// Any SVG colour.
    pub colour: &'a str,
    /// Pixels.
    pub width: f64,
    /// SVG dash array; empty for a solid line.
    pub dash: &'a str,
}

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// Grey of numbers and labels.
pub const INK: &str = "#222";

/// Size of most texts.
pub const SMALL: f64 = 12.0;

/// A picture that is being written.
pub struct Canvas {
    body: String,
    width: f64,
    height: f64,
}

impl Canvas {
    /// An empty white picture.
    pub fn new(width: f64, height: f64) -> Self {
        let mut canvas = Self { body: String::new(), width, height };
        canvas.rectangle((0.0, 0.0), (width, height), "white");
        canvas
    }

    /// The whole picture.
    pub fn finish(self) -> String {
        let Self { body, width, height } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"{SMALL}\" \
             fill=\"{INK}\">\n{body}</svg>\n"
        )
    }

    fn push(&mut self, element: std::fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    /// A filled rectangle from its upper left corner.
    pub fn rectangle(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), fill: &str) {
        let [x, y, width, height] = [x, y, width, height].map(pixels);
        self.push(format_args!(r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}"/>"#));
    }

    /// A straight line.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        self.polyline(&[from, to], stroke);
    }

    /// Straight lines through all points.
    pub fn polyline(&mut self, points: &[(f64, f64)], Stroke { colour, width, dash }: Stroke) {
        let dash = if dash.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{dash}""#) };
        let width = if width == 1.0 { String::new() } else { format!(r#" stroke-width="{width}""#) };
        let join = if points.len() > 2 { r#" stroke-linejoin="round""# } else { "" };
        let line = commands(points);
        self.push(format_args!(r#"<path d="{line}" fill="none" stroke="{colour}"{width}{dash}{join}/>"#));
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[(f64, f64)], fill: &str) {
        let line = commands(points);
        self.push(format_args!(r#"<path d="{line}z" fill="{fill}"/>"#));
    }

    /// A filled circle.
    pub fn disc(&mut self, (x, y): (f64, f64), radius: f64, fill: &str) {
        let [x, y] = [x, y].map(pixels);
        self.push(format_args!(r#"<circle cx="{x}" cy="{y}" r="{radius}" fill="{fill}"/>"#));
    }

    /// A line of text; `y` is its baseline.
    pub fn text(&mut self, (x, y): (f64, f64), anchor: Anchor, size: f64, colour: &str, text: &str) {
        self.turned_text((x, y), 0.0, anchor, size, colour, text);
    }

    /// A line of text, turned by degrees (clockwise) around its point.
    pub fn turned_text(&mut self, (x, y): (f64, f64), angle: f64, anchor: Anchor, size: f64, colour: &str, text: &str) {
        if text.is_empty() {
            return;
        }
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => r#" text-anchor="middle""#,
            Anchor::End => r#" text-anchor="end""#,
        };
        let [x, y] = [x, y].map(pixels);
        let turn = if angle == 0.0 { String::new() } else { format!(r#" transform="rotate({angle} {x} {y})""#) };
        let size = if size == SMALL { String::new() } else { format!(r#" font-size="{size}""#) };
        let fill = if colour == INK { String::new() } else { format!(r#" fill="{colour}""#) };
        let text = escape(text);
        self.push(format_args!(r#"<text x="{x}" y="{y}"{anchor}{size}{fill}{turn}>{text}</text>"#));
    }
}

/// Commands of a path through points.
fn commands(points: &[(f64, f64)]) -> String {
    let mut line = String::new();
    path(&mut line, &points.iter().map(|&(x, y)| [x, y]).collect::<Vec<_>>());
    line
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Width of a text, estimated for a wide font: which font the reader has is not known.
pub fn text_width(text: &str, size: f64) -> f64 {
    let widths = text.chars().map(|symbol| match symbol {
        'i' | 'j' | 'l' | '.' | ',' | '\'' | '|' | ' ' | '(' | ')' | ':' => 0.38,
        'm' | 'w' | 'M' | 'W' => 0.95,
        '\u{2070}'..='\u{207f}' | '¹' | '²' | '³' => 0.44,
        _ => 0.64,
    });
    size * widths.sum::<f64>()
}

/// The text, cut with an ellipsis if it would be wider than `width`.
pub fn cut(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let mut short = text.to_owned();
    while short.pop().is_some() && text_width(&short, size) + 0.7 * size > width {}
    format!("{}…", short.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_cut_to_the_width() {
        assert_eq!(cut("short", 12.0, 100.0), "short");
        let long = cut("a name that is much too long for any legend", 12.0, 100.0);
        assert!(long.ends_with('…') && text_width(&long, 12.0) <= 101.0 && long.len() > 10, "{long}");
        assert_eq!(cut("abc", 12.0, 0.0), "…");
    }
}
