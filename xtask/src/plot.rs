//! Line charts as SVG text.

use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

use crate::workspace::Outcome;

/// One line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// Points; those that are not finite, or beyond 1e30, are left out.
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
    /// Above the chart.
    pub title: &'a str,
    /// Below the horizontal axis.
    pub x: &'a str,
    /// Beside the vertical axis.
    pub y: &'a str,
}

/// Width and height of a chart.
const SIZE: (u32, u32) = (720, 320);

/// Width of the numbers and the label at the left.
const LEFT: u32 = 64;

/// Width of the names of the lines at the right.
const LEGEND: u32 = 160;

/// Colours that stay apart for most kinds of colour vision (Okabe and Ito).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(90, 90, 90),
];

/// A chart with linear axes.
pub fn linear(labels: Labels, series: &[Series]) -> Outcome<String> {
    let (x, y) = (range(series, |point| point.0), range(series, |point| point.1));
    let margin = 0.06 * (y.1 - y.0);
    draw(labels, series, x.0..x.1, (y.0 - margin)..(y.1 + margin))
}

/// A chart with a logarithmic vertical axis; values below `floor` are drawn on it.
pub fn logarithmic(labels: Labels, series: &[Series], floor: f64) -> Outcome<String> {
    let mut lifted = series.to_vec();
    for line in &mut lifted {
        line.points.retain(is_drawn);
        line.points.iter_mut().for_each(|point| point.1 = point.1.max(floor));
    }
    let (x, y) = (range(&lifted, |point| point.0), range(&lifted, |point| point.1));
    draw(labels, &lifted, x.0..x.1, (floor..(3.0 * y.1).max(10.0 * floor)).log_scale())
}

/// Finite, and not so large that an axis could not be divided.
fn is_drawn(point: &(f64, f64)) -> bool {
    point.0.abs() < 1e30 && point.1.abs() < 1e30
}

/// Smallest and largest value that is drawn, moved apart if they are equal.
fn range(series: &[Series], coordinate: impl Fn(&(f64, f64)) -> f64) -> (f64, f64) {
    let values = series.iter().flat_map(|line| &line.points).filter(|point| is_drawn(point)).map(coordinate);
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    match (low.is_finite(), high - low > 1e-12 * high.abs().max(low.abs())) {
        (false, _) => (0.0, 1.0),
        (true, true) => (low, high),
        (true, false) => (low - 0.5 * low.abs().max(1e-3), high + 0.5 * high.abs().max(1e-3)),
    }
}

fn draw<Y>(labels: Labels, series: &[Series], x: std::ops::Range<f64>, y: Y) -> Outcome<String>
where
    Y: AsRangedCoord<Value = f64>,
    Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(10)
            .margin_right(if series.len() > 1 { LEGEND } else { 14 })
            .caption(labels.title, ("sans-serif", 15))
            .x_label_area_size(34)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .axis_style(RGBColor(120, 120, 120))
            .label_style(("sans-serif", 12))
            .x_desc(labels.x)
            .y_desc(labels.y)
            .y_label_formatter(&|value| number(*value))
            .draw()?;
        for (number, (line, colour)) in series.iter().zip(COLOURS.iter().cycle()).enumerate() {
            let style = colour.stroke_width(2);
            let points = line.points.iter().copied().filter(is_drawn);
            chart.draw_series(LineSeries::new(points, style))?;
            if series.len() > 1 {
                let (x, y) = ((SIZE.0 - LEGEND) as i32 + 8, 44 + 20 * number as i32);
                area.draw(&PathElement::new([(x, y), (x + 18, y)], style))?;
                area.draw(&Text::new(line.name.as_str(), (x + 24, y - 7), ("sans-serif", 12)))?;
            }
        }
        area.present()?;
    }
    Ok(text)
}

/// Short form of a number on an axis.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => {
            let text = format!("{value:.6}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => format!("{value:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LABELS: Labels = Labels { title: "t", x: "x", y: "y" };

    #[test]
    fn odd_data_still_make_a_chart() {
        let lines = |y: [f64; 3]| [Series::new("a", &[0.0, 1.0, 2.0], y), Series::new("b", &[], [])];
        for y in [[0.0; 3], [1.0, f64::NAN, 2.0], [f64::INFINITY; 3], [1e-300, 1e300, 0.0]] {
            assert!(linear(LABELS, &lines(y)).unwrap().ends_with("</svg>\n"));
            assert!(logarithmic(LABELS, &lines(y), 1e-17).unwrap().ends_with("</svg>\n"));
        }
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, 0.25, 100.0, 1e-12].map(number), ["0", "0.25", "100", "1e-12"]);
    }
}
