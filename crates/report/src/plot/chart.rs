//! Layout of a chart: axes, grid, lines, slopes, legend beside.

use super::axis::{Axis, Tick};
use super::canvas::{Anchor, Canvas, INK, SMALL, Stroke, cut, text_width};
use super::style::Style;
use super::{Drawn, Labels, Series};
use crate::svg_path::simplified;

const TITLE: f64 = 15.0;
const GRID: Stroke = Stroke { colour: "#e2e2e2", width: 1.0, dash: "" };
const FRAME: Stroke = Stroke { colour: "#888", width: 1.0, dash: "" };
const SLOPE: Stroke = Stroke { colour: "#999", width: 1.0, dash: "" };
/// Distance of the lines of the legend.
const LINE: f64 = 20.0;
/// Widest legend; longer names are cut.
const WIDEST_LEGEND: f64 = 230.0;
/// Distance below which the next point of a line is not marked.
const MARKER_DISTANCE: f64 = 13.0;
/// Distance in pixels by which a line may miss a point: a fraction of its width, which nobody sees.
const UNSEEN: f64 = 0.2;
/// Width and height of the corner with the slopes.
const SLOPES: (f64, f64) = (86.0, 84.0);

/// Pixels.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Width of the picture.
    pub width: f64,
    /// Height of the picture; a long legend makes it larger.
    pub height: f64,
}

/// A chart without its data.
#[derive(Clone, Copy, Debug)]
pub struct Chart<'a> {
    pub labels: Labels<'a>,
    pub x: Axis,
    pub y: Axis,
    pub drawn: Drawn,
    /// Slopes to show, of logarithmic axes.
    pub slopes: &'a [f64],
    pub size: Size,
}

impl Default for Chart<'_> {
    fn default() -> Self {
        Self {
            labels: Labels { title: "", x: "", y: "" },
            x: Axis::linear((0.0, 1.0)),
            y: Axis::linear((0.0, 1.0)),
            drawn: Drawn::Lines,
            slopes: &[],
            size: Size { width: 640.0, height: 320.0 },
        }
    }
}

/// The area inside the axes.
#[derive(Clone, Copy, Debug)]
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl Frame {
    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.left + x * self.width, self.top + (1.0 - y) * self.height)
    }
    fn right(&self) -> f64 {
        self.left + self.width
    }
    fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

impl Chart<'_> {
    /// Stretches the axis that has room, so that a unit is as long on both; then both get a margin.
    pub fn with_equal_units(mut self, series: &[Series]) -> Self {
        let frame = self.frame(series);
        let unit = 0.94 * (self.x.unit() * frame.width).min(self.y.unit() * frame.height);
        self.x = self.x.with_unit(unit / frame.width);
        self.y = self.y.with_unit(unit / frame.height);
        self
    }

    /// The whole picture.
    pub fn draw(&self, series: &[Series]) -> String {
        let frame = self.frame(series);
        let height = frame.bottom() + if self.labels.x.is_empty() { 30.0 } else { 48.0 };
        let mut canvas = Canvas::new(self.size.width, height);
        self.axes(&mut canvas, &frame);
        let lines: Vec<_> = series.iter().map(|line| self.segments(&frame, line)).collect();
        self.slopes(&mut canvas, &frame, &lines);
        for (number, line) in lines.iter().enumerate() {
            self.line(&mut canvas, line, Style::new(number));
        }
        if series.len() > 1 {
            self.legend(&mut canvas, &frame, series);
        }
        canvas.finish()
    }

    /// Room for the widest numbers at the left and the names at the right.
    fn frame(&self, series: &[Series]) -> Frame {
        let numbers = self.y.ticks(8).iter().map(|tick| text_width(&tick.label, SMALL)).fold(20.0, f64::max);
        let left = 14.0 + numbers + if self.labels.y.is_empty() { 0.0 } else { 20.0 };
        let legend = if series.len() > 1 { 44.0 + legend_width(series) } else { 24.0 };
        let top = if self.labels.title.is_empty() { 14.0 } else { 36.0 };
        let height = (self.size.height - top - 48.0).max(LINE * series.len() as f64);
        Frame { left, top, width: self.size.width - left - legend, height }
    }

    fn axes(&self, canvas: &mut Canvas, frame: &Frame) {
        for Tick { fraction, label } in self.horizontal_ticks(frame) {
            let (x, _) = frame.place((fraction, 0.0));
            canvas.line((x, frame.top), (x, frame.bottom()), GRID);
            canvas.text((x, frame.bottom() + 16.0), Anchor::Middle, SMALL, INK, &label);
        }
        for Tick { fraction, label } in self.y.ticks((frame.height / 30.0) as usize) {
            let (_, y) = frame.place((0.0, fraction));
            canvas.line((frame.left, y), (frame.right(), y), GRID);
            canvas.text((frame.left - 6.0, y + 4.0), Anchor::End, SMALL, INK, &label);
        }
        let (top, bottom, left, right) = (frame.top, frame.bottom(), frame.left, frame.right());
        canvas.polyline(&[(left, top), (left, bottom), (right, bottom), (right, top), (left, top)], FRAME);
        let title = cut(self.labels.title, TITLE, self.size.width - left - 10.0);
        canvas.text((left, top - 14.0), Anchor::Start, TITLE, INK, &title);
        let middle = (left + 0.5 * frame.width, top + 0.5 * frame.height);
        canvas.text((middle.0, bottom + 36.0), Anchor::Middle, SMALL, INK, &cut(self.labels.x, SMALL, frame.width));
        let label = cut(self.labels.y, SMALL, frame.height);
        canvas.turned_text((16.0, middle.1), -90.0, Anchor::Middle, SMALL, INK, &label);
    }

    /// Ticks of the horizontal axis: as many numbers as fit beside each other.
    fn horizontal_ticks(&self, frame: &Frame) -> Vec<Tick> {
        let most = (2..=12).rev().find(|most| {
            let labelled: Vec<Tick> = self.x.ticks(*most).into_iter().filter(|tick| !tick.label.is_empty()).collect();
            labelled.windows(2).all(|pair| {
                let room = (pair[1].fraction - pair[0].fraction) * frame.width;
                0.5 * (text_width(&pair[0].label, SMALL) + text_width(&pair[1].label, SMALL)) + 8.0 < room
            })
        });
        self.x.ticks(most.unwrap_or(1))
    }

    /// Pixels of the pieces of a line between points that are not drawn.
    fn segments(&self, frame: &Frame, line: &Series) -> Vec<Vec<(f64, f64)>> {
        let mut pieces = vec![Vec::new()];
        for (x, y) in &line.points {
            match (self.x.fraction(*x), self.y.fraction(*y), pieces.last_mut()) {
                (Some(x), Some(y), Some(piece)) => piece.push(frame.place((x, y))),
                _ => pieces.push(Vec::new()),
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        pieces
    }

    fn line(&self, canvas: &mut Canvas, pieces: &[Vec<(f64, f64)>], style: Style) {
        for piece in pieces {
            let lonely = piece.len() == 1;
            if self.drawn != Drawn::Points && !lonely {
                canvas.polyline(&simplified(&thinned(piece), UNSEEN), style.stroke());
            }
            if self.drawn != Drawn::Lines || lonely {
                let mut last = None;
                for point in piece {
                    let near = |last: (f64, f64)| (last.0 - point.0).hypot(last.1 - point.1) < MARKER_DISTANCE;
                    if self.drawn == Drawn::Points || !last.is_some_and(near) {
                        style.mark(canvas, *point);
                        last = Some(*point);
                    }
                }
            }
        }
    }

    fn legend(&self, canvas: &mut Canvas, frame: &Frame, series: &[Series]) {
        for (number, line) in series.iter().enumerate() {
            let (x, y) = (frame.right() + 12.0, frame.top + 8.0 + LINE * number as f64);
            let style = Style::new(number);
            if self.drawn != Drawn::Points {
                canvas.line((x, y), (x + 22.0, y), style.stroke());
            }
            if self.drawn != Drawn::Lines {
                style.mark(canvas, (x + 11.0, y));
            }
            canvas.text((x + 28.0, y + 4.0), Anchor::Start, SMALL, INK, &cut(&line.name, SMALL, WIDEST_LEGEND));
        }
    }

    /// A fan of thin lines, one for each slope, in the corner through which the fewest lines go.
    fn slopes(&self, canvas: &mut Canvas, frame: &Frame, lines: &[Vec<Vec<(f64, f64)>>]) {
        if self.slopes.is_empty() {
            return;
        }
        let (width, height) = SLOPES;
        let (near, far) = (10.0, 12.0);
        let corners = [
            (frame.right() - width - near, frame.bottom() - height - far),
            (frame.left + near, frame.bottom() - height - far),
            (frame.left + near, frame.top + far),
            (frame.right() - width - near, frame.top + far),
        ];
        let crowd = |(left, top): (f64, f64)| {
            let inside = |p: &(f64, f64)| {
                (left - 8.0..left + width + 8.0).contains(&p.0) && (top - 8.0..top + height + 8.0).contains(&p.1)
            };
            lines.iter().flatten().flat_map(|piece| dense(piece)).filter(inside).count()
        };
        let Some(corner) = corners.into_iter().min_by_key(|corner| crowd(*corner)) else { return };
        let decade = (self.x.unit() * frame.width, self.y.unit() * frame.height);
        let rise = |slope: f64| slope * decade.1 / decade.0;
        let falling = self.slopes.iter().all(|slope| *slope < 0.0);
        // The fan opens to the right, its vertex is at the lower left or, for negative slopes, at the upper left.
        let vertex = (corner.0, if falling { corner.1 } else { corner.1 + height });
        let reach = (width - 24.0, height - 10.0);
        for slope in self.slopes {
            let rise = rise(*slope);
            let run = reach.0.min(reach.1 / rise.abs().max(1e-9));
            let end = (vertex.0 + run, vertex.1 - rise * run);
            canvas.line(vertex, end, SLOPE);
            canvas.text((end.0 + 4.0, end.1 + 4.0), Anchor::Start, 11.0, "#777", &slope.to_string());
        }
        let base = (vertex.0 + reach.0.min(self.longest_run(rise, reach)), vertex.1);
        canvas.line(vertex, base, SLOPE);
    }

    /// Run of the flattest slope.
    fn longest_run(&self, rise: impl Fn(f64) -> f64, reach: (f64, f64)) -> f64 {
        self.slopes.iter().map(|slope| reach.1 / rise(*slope).abs().max(1e-9)).fold(0.0, f64::max)
    }
}

fn legend_width(series: &[Series]) -> f64 {
    series.iter().map(|line| text_width(&line.name, SMALL)).fold(0.0, f64::max).min(WIDEST_LEGEND)
}

/// Points every few pixels along a line.
fn dense(piece: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    piece.windows(2).flat_map(|pair| {
        let (a, b) = (pair[0], pair[1]);
        let count = ((a.0 - b.0).hypot(a.1 - b.1) / 4.0).ceil().max(1.0);
        (0..=count as usize).map(move |k| {
            let t = k as f64 / count;
            (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1))
        })
    })
}

/// The points of a curve that show: of those that follow each other within one pixel's width only the first, the lowest, the highest and the
/// last: looks the same, and a run of a million steps stays small.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::new();
    for run in points.chunk_by(|a, b| a.0.floor() == b.0.floor()) {
        let by_height = |a: &usize, b: &usize| run[*a].1.total_cmp(&run[*b].1);
        let lowest = (0..run.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..run.len()).max_by(by_height).unwrap_or(0);
        let mut kept = [0, lowest, highest, run.len() - 1];
        kept.sort_unstable();
        for (k, place) in kept.into_iter().enumerate() {
            if k == 0 || kept[k - 1] != place {
                out.push(run[place]);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_extremes_and_the_ends() {
        let dense: Vec<(f64, f64)> = (0..1000).map(|k| (k as f64 * 1e-3, (k as f64).sin())).collect();
        let thin = thinned(&dense);
        assert!(thin.len() <= 4 && thin[0] == dense[0] && thin.last() == dense.last());
        let highest = |points: &[(f64, f64)]| points.iter().map(|p| p.1).fold(f64::MIN, f64::max);
        assert_eq!(highest(&thin), highest(&dense));
        let sparse = [(0.0, 1.0), (5.0, 2.0), (9.0, 0.0)];
        assert_eq!(thinned(&sparse), sparse);
        assert!(thinned(&[]).is_empty());
    }

    #[test]
    fn a_unit_is_as_long_on_both_axes() {
        let chart = Chart { x: Axis::linear((0.0, 10.0)), y: Axis::linear((0.0, 1.0)), ..Chart::default() };
        let chart = chart.with_equal_units(&[]);
        let frame = chart.frame(&[]);
        let place = |x: f64, y: f64| frame.place((chart.x.fraction(x).unwrap(), chart.y.fraction(y).unwrap()));
        let (origin, right, up) = (place(0.0, 0.0), place(1.0, 0.0), place(0.0, 1.0));
        assert!(((right.0 - origin.0) - (origin.1 - up.1)).abs() < 1e-9);
    }

    #[test]
    fn lines_are_interrupted_where_a_value_is_missing() {
        let chart = Chart { x: Axis::linear((0.0, 4.0)), ..Chart::default() };
        let line = Series::new("a", &[0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 0.5, f64::NAN, 1.0, 0.0]);
        let pieces = chart.segments(&chart.frame(&[]), &line);
        assert_eq!(pieces.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
    }

    #[test]
    fn a_long_legend_makes_the_picture_higher() {
        let series: Vec<Series> = (0..30).map(|k| Series::new(&format!("line {k}"), &[0.0], [0.0])).collect();
        let svg = Chart::default().draw(&series);
        assert!(svg.contains("line 29") && !svg.contains("height=\"320\""));
    }
}
