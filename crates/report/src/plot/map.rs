//! A grid of coloured cells with a legend of categories, e.g. verdicts over step size and stiffness.

use super::Labels;
use super::canvas::{Anchor, Canvas, INK, SMALL, Stroke, cut, text_width};

/// Fills for the categories from best to worst, told apart by lightness too.
const FILLS: [&str; 8] = ["#2f9e78", "#8fc8ee", "#f2e35b", "#e69f00", "#c8470a", "#4d4d4d", "#cc79a7", "#0072b2"];

/// Colour of the words in a cell, for each fill.
const WORDS: [&str; 8] = ["#fff", "#222", "#222", "#222", "#fff", "#fff", "#222", "#fff"];

/// Fill of a cell without a category.
const NOTHING: &str = "#eeeeee";

const CELL: (f64, f64) = (40.0, 24.0);

/// One cell of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// Number of the category; `None` or one that there is not: grey, "not run".
    pub category: Option<usize>,
    /// A short word or number inside; left out if it does not fit.
    pub text: String,
}

/// A map: `cells[row][column]`, the first row at the bottom. `columns` and `rows` are the numbers or words along
/// the axes, `categories` (at most 8) the names in the legend, from best to worst. Rows may be shorter than others.
pub fn map(labels: Labels, columns: &[String], rows: &[String], categories: &[&str], cells: &[Vec<Cell>]) -> String {
    let widest = |texts: &mut dyn Iterator<Item = &str>| texts.map(|text| text_width(text, SMALL)).fold(0.0, f64::max);
    let left = 34.0 + widest(&mut rows.iter().map(String::as_str));
    let (width, height) = (CELL.0 * columns.len() as f64, CELL.1 * rows.len() as f64);
    let top = 40.0;
    let some_empty =
        (0..rows.len()).any(|row| (0..columns.len()).any(|column| fill(cells, row, column, categories).is_none()));
    let mut legend: Vec<(&str, &str)> = categories.iter().copied().zip(FILLS).collect();
    if some_empty {
        legend.push(("not run", NOTHING));
    }
    let names = widest(&mut legend.iter().map(|entry| entry.0));
    let total_width = (left + width + 56.0 + names).max(240.0);
    let total_height = (top + height).max(top + 22.0 * legend.len() as f64) + 50.0;
    let mut canvas = Canvas::new(total_width, total_height);
    canvas.text((left, top - 16.0), Anchor::Start, 15.0, INK, &cut(labels.title, 15.0, total_width - left - 10.0));
    for (row, label) in rows.iter().enumerate() {
        let y = top + height - CELL.1 * (row as f64 + 1.0);
        canvas.text((left - 8.0, y + 0.5 * CELL.1 + 4.0), Anchor::End, SMALL, INK, label);
        for column in 0..columns.len() {
            let x = left + CELL.0 * column as f64;
            let category = fill(cells, row, column, categories);
            let colour = category.map_or(NOTHING, |category| FILLS[category]);
            canvas.rectangle((x + 0.5, y + 0.5), (CELL.0 - 1.0, CELL.1 - 1.0), colour);
            let text = cells.get(row).and_then(|cells| cells.get(column)).map_or("", |cell| cell.text.as_str());
            if text_width(text, 10.0) < CELL.0 - 2.0 {
                let ink = category.map_or("#777", |category| WORDS[category]);
                let middle = (x + 0.5 * CELL.0, y + 0.5 * CELL.1 + 3.5);
                canvas.text(middle, Anchor::Middle, 10.0, ink, text);
            }
        }
    }
    let stride = stride(columns);
    for (column, label) in columns.iter().enumerate().step_by(stride) {
        let x = left + CELL.0 * (column as f64 + 0.5);
        canvas.text((x, top + height + 16.0), Anchor::Middle, SMALL, INK, label);
    }
    let middle = (left + 0.5 * width, top + 0.5 * height);
    canvas.text((middle.0, top + height + 36.0), Anchor::Middle, SMALL, INK, labels.x);
    canvas.turned_text((16.0, middle.1), -90.0, Anchor::Middle, SMALL, INK, &cut(labels.y, SMALL, height + 40.0));
    let outline = Stroke { colour: "#999", width: 0.6, dash: "" };
    for (number, (name, colour)) in legend.into_iter().enumerate() {
        let (x, y) = (left + width + 16.0, top + 22.0 * number as f64);
        canvas.rectangle((x, y), (16.0, 16.0), colour);
        canvas.polyline(&[(x, y), (x + 16., y), (x + 16., y + 16.), (x, y + 16.), (x, y)], outline);
        canvas.text((x + 22.0, y + 12.0), Anchor::Start, SMALL, INK, name);
    }
    canvas.finish()
}

/// Category of a cell, if it has one that there is.
fn fill(cells: &[Vec<Cell>], row: usize, column: usize, categories: &[&str]) -> Option<usize> {
    let category = cells.get(row)?.get(column)?.category?;
    (category < categories.len().min(FILLS.len())).then_some(category)
}

/// Every how many columns a label fits.
fn stride(columns: &[String]) -> usize {
    let widest = columns.iter().map(|label| text_width(label, SMALL) + 6.0).fold(0.0, f64::max);
    ((widest / CELL.0).ceil() as usize).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LABELS: Labels = Labels { title: "map", x: "step", y: "stiffness" };

    fn words(count: usize) -> Vec<String> {
        (0..count).map(|k| format!("w{k}")).collect()
    }

    #[test]
    fn the_first_row_is_at_the_bottom() {
        let cell = |category| Cell { category: Some(category), text: String::new() };
        let svg = map(LABELS, &words(1), &words(2), &["good", "bad"], &[vec![cell(0)], vec![cell(1)]]);
        let height_of = |fill: &str| {
            let line = svg.lines().find(|line| line.contains(fill) && line.contains("\"39\"")).unwrap();
            line.split("y=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap().parse::<f64>().unwrap()
        };
        assert_eq!(height_of(FILLS[0]) - height_of(FILLS[1]), CELL.1);
        assert!(!svg.contains("not run"));
    }

    #[test]
    fn odd_data_still_make_a_map() {
        let odd = Cell { category: Some(99), text: "a text that is too long for it".into() };
        for cells in [vec![], vec![vec![]], vec![vec![odd.clone()], vec![odd; 9]]] {
            let svg = map(LABELS, &words(2), &words(3), &["good"], &cells);
            assert!(svg.ends_with("</svg>\n") && svg.contains("not run") && !svg.contains("too long"));
        }
        assert!(map(LABELS, &[], &[], &[], &[]).ends_with("</svg>\n"));
        let many = vec!["c"; 20];
        let cells = vec![vec![Cell { category: Some(15), text: String::new() }]];
        assert!(map(LABELS, &words(1), &words(1), &many, &cells).contains("not run"));
    }

    #[test]
    fn long_labels_are_thinned() {
        assert_eq!(stride(&["10⁻³".into()]), 1);
        assert!(stride(&["1.25 10⁻³".into()]) > 1);
    }
}
