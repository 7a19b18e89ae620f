//! Charts as SVG text: lines over linear or logarithmic axes, plane curves, and maps of coloured cells.
//!
//! A picture is one `<svg>` without references to anything else. Not here: pictures of bodies (`gallery`).

mod axis;
mod canvas;
mod chart;
mod map;
mod style;

use axis::Axis;
use chart::{Chart, Size};

pub use map::{Cell, map};

/// One line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// Points; those that are not finite, or beyond 1e300, are left out, and the line is interrupted there.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// Pairs up two columns.
    pub fn new(name: &str, x: &[f64], y: impl IntoIterator<Item = f64>) -> Self {
        Self { name: name.to_owned(), points: x.iter().copied().zip(y).collect() }
    }
}

/// What a chart says around its lines.
#[derive(Clone, Copy, Debug)]
pub struct Labels<'a> {
    /// Title above the chart.
    pub title: &'a str,
    /// Label of the horizontal axis.
    pub x: &'a str,
    /// Label of the vertical axis.
    pub y: &'a str,
}

/// How the points of a series are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// Joined by a line.
    Lines,
    /// Joined by a line and marked.
    MarkedLines,
    /// Marked only.
    Points,
}

/// A chart with linear axes.
pub fn linear(labels: Labels, series: &[Series]) -> String {
    let (x, y) = ranges(series, is_drawn);
    let margin = 0.06 * (y.1 - y.0);
    let chart = Chart { labels, x: Axis::linear(x), y: Axis::linear((y.0 - margin, y.1 + margin)), ..Chart::default() };
    chart.draw(series)
}

/// A chart with a logarithmic vertical axis; values below `floor` are drawn on it.
pub fn logarithmic(labels: Labels, series: &[Series], floor: f64) -> String {
    let lifted = lift(series, floor);
    let (x, y) = ranges(&lifted, is_drawn);
    let chart = Chart { labels, x: Axis::linear(x), y: Axis::logarithmic((floor.min(y.1), y.1)), ..Chart::default() };
    chart.draw(&lifted)
}

/// A chart with two logarithmic axes and marked points. Values of `y` below `floor`, zero too, are drawn on it;
/// other points that are not positive are left out. Thin grey lines show the `slopes`, positive or negative, in an
/// empty corner.
pub fn log_log(labels: Labels, series: &[Series], floor: Option<f64>, slopes: &[f64]) -> String {
    let lifted = floor.map_or_else(|| series.to_vec(), |floor| lift(series, floor));
    let (x, y) = ranges(&lifted, |point| is_drawn(point) && point.0 > 0.0 && point.1 > 0.0);
    let chart = Chart {
        labels,
        x: Axis::logarithmic(x),
        y: Axis::logarithmic(y),
        drawn: Drawn::MarkedLines,
        slopes,
        size: Size { width: 640.0, height: 400.0 },
    };
    chart.draw(&lifted)
}

/// Curves or points in a plane: a unit is as long on both axes.
pub fn trajectory(labels: Labels, series: &[Series], drawn: Drawn) -> String {
    let (x, y) = ranges(series, is_drawn);
    let size = Size { width: 560.0, height: 420.0 };
    let chart = Chart { labels, x: Axis::linear(x), y: Axis::linear(y), drawn, size, ..Chart::default() };
    chart.with_equal_units(series).draw(series)
}

/// The series with every drawn value at least `floor`.
fn lift(series: &[Series], floor: f64) -> Vec<Series> {
    let mut lifted = series.to_vec();
    for point in lifted.iter_mut().flat_map(|line| &mut line.points).filter(|point| is_drawn(point)) {
        point.1 = point.1.max(floor);
    }
    lifted
}

/// Finite, and not so large that an axis could not be divided.
fn is_drawn(point: &(f64, f64)) -> bool {
    point.0.abs() < 1e300 && point.1.abs() < 1e300
}

/// Smallest and largest coordinates of the points that are drawn, (0, 1) if there is none.
fn ranges(series: &[Series], drawn: impl Fn(&(f64, f64)) -> bool) -> ((f64, f64), (f64, f64)) {
    let points = || series.iter().flat_map(|line| &line.points).filter(|point| drawn(point));
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = values.fold(start, |(low, high), value| (low.min(value), high.max(value)));
        if low.is_finite() { (low, high) } else { (0.0, 1.0) }
    };
    (range(&mut points().map(|point| point.0)), range(&mut points().map(|point| point.1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LABELS: Labels = Labels { title: "t", x: "x", y: "y" };

    /// Every kind of chart of these series.
    fn charts(series: &[Series]) -> Vec<String> {
        let mut charts = vec![
            linear(LABELS, series),
            logarithmic(LABELS, series, 1e-17),
            log_log(LABELS, series, None, &[1.0, 2.0]),
            log_log(LABELS, series, Some(1e-16), &[-1.0, 0.0]),
        ];
        charts.extend([Drawn::Lines, Drawn::MarkedLines, Drawn::Points].map(|drawn| trajectory(LABELS, series, drawn)));
        charts
    }

    /// A picture whose numbers are all finite.
    fn is_sound(svg: &str) -> bool {
        svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf")
    }

    #[test]
    fn odd_data_still_make_a_chart() {
        let lines = |y: [f64; 3]| [Series::new("a", &[0.0, 1.0, 2.0], y), Series::new("b", &[], [])];
        for y in [[0.0; 3], [1.0, f64::NAN, 2.0], [f64::INFINITY; 3], [1e-300, 1e300, 0.0], [-1.0, 1e-300, -1e29]] {
            for chart in charts(&lines(y)) {
                assert!(is_sound(&chart), "{y:?}: {chart}");
            }
        }
        for chart in charts(&[]) {
            assert!(is_sound(&chart), "{chart}");
        }
        let x = [f64::NAN, f64::INFINITY, 1e-200];
        assert!(charts(&[Series::new("a", &x, [1.0, 2.0, 3.0])]).iter().all(|chart| is_sound(chart)));
    }

    #[test]
    fn values_below_the_floor_lie_on_it() {
        let on_floor = log_log(LABELS, &[Series::new("a", &[1.0, 10.0], [1e-3, 1.0])], Some(1e-3), &[]);
        let below = log_log(LABELS, &[Series::new("a", &[1.0, 10.0], [0.0, 1.0])], Some(1e-3), &[]);
        assert_eq!(on_floor, below);
        let without = log_log(LABELS, &[Series::new("a", &[1.0, 10.0], [0.0, 1.0])], None, &[]);
        assert_ne!(on_floor, without);
    }

    #[test]
    fn names_cannot_break_the_picture() {
        let chart = linear(
            Labels { title: "a < b & \"c\"", x: "<", y: "&" },
            &[Series::new("<svg>", &[0.0, 1.0], [0.0, 1.0]), Series::new("&", &[0.0], [0.0])],
        );
        assert!(
            chart.contains("a &lt; b &amp; ") && chart.contains("&lt;svg&gt;") && chart.matches("<svg").count() == 1
        );
    }
}
