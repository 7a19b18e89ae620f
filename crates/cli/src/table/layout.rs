//! Columns as lines of text.

use super::columns::{Column, Entries};
use stoss::solver::significant;

/// The columns of several tables below each other, with a column `table` before them that has their names if there are several.
pub fn joined(parts: Vec<(&str, Vec<Column>)>) -> Vec<Column> {
    if parts.len() == 1 {
        return parts.into_iter().flat_map(|(_, columns)| columns).collect();
    }
    let height = |columns: &[Column]| columns.first().map_or(0, Column::len);
    let labels = parts.iter().flat_map(|(label, columns)| std::iter::repeat_n((*label).to_owned(), height(columns)));
    let mut all = vec![Column { name: "table".to_owned(), entries: Entries::Words(labels.collect()) }];
    let width = parts.iter().map(|(_, columns)| columns.len()).max().unwrap_or(0);
    for place in 0..width {
        let name = parts.iter().find_map(|(_, columns)| columns.get(place)).map(|column| column.name.clone());
        let cells = parts.iter().flat_map(|(_, columns)| match columns.get(place) {
            Some(column) => column.cells(&exact),
            None => vec![String::new(); height(columns)],
        });
        let of_numbers =
            parts.iter().all(|(_, columns)| matches!(columns.get(place), Some(column) if column.has_numbers()));
        let entries = match of_numbers {
            true => Entries::Numbers(cells.map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()),
            false => Entries::Words(cells.collect()),
        };
        all.push(Column { name: name.unwrap_or_default(), entries });
    }
    all
}

impl Column {
    fn len(&self) -> usize {
        match &self.entries {
            Entries::Numbers(values) => values.len(),
            Entries::Words(words) => words.len(),
        }
    }

    fn has_numbers(&self) -> bool {
        matches!(self.entries, Entries::Numbers(_))
    }

    fn cells(&self, number: &dyn Fn(f64) -> String) -> Vec<String> {
        match &self.entries {
            Entries::Numbers(values) => values.iter().map(|value| number(*value)).collect(),
            Entries::Words(words) => words.clone(),
        }
    }
}

/// A number with all its digits; nothing for what has no value.
fn exact(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:e}") }
}

/// A number with so many significant digits at most; `-` for what has no value.
fn rounded(value: f64, digits: usize) -> String {
    if value.is_nan() { "-".to_owned() } else { significant(value, digits) }
}

/// Comma-separated values (RFC 4180), with a line feed at the end.
pub fn separated(columns: &[Column]) -> String {
    let quoted = |text: &str| match text.contains([',', '"']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    };
    let mut lines = vec![columns.iter().map(|column| quoted(&column.name)).collect::<Vec<_>>().join(",")];
    let cells: Vec<Vec<String>> = columns.iter().map(|column| column.cells(&exact)).collect();
    for row in 0..columns.first().map_or(0, Column::len) {
        lines.push(cells.iter().map(|column| quoted(&column[row])).collect::<Vec<_>>().join(","));
    }
    lines.join("\n") + "\n"
}

/// Columns side by side, numbers to the right and words to the left.
pub fn aligned(columns: &[Column], digits: usize) -> String {
    let cells: Vec<Vec<String>> = columns.iter().map(|column| column.cells(&|value| rounded(value, digits))).collect();
    let length = |text: &String| text.chars().count();
    let width = |(column, cells): (&Column, &Vec<String>)| {
        cells.iter().map(length).chain([length(&column.name)]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = columns.iter().zip(&cells).map(width).collect();
    let line = |cell: &dyn Fn(usize) -> String| {
        let padded = columns.iter().enumerate().map(|(place, column)| match column.has_numbers() {
            true => format!("{:>width$}", cell(place), width = widths[place]),
            false => format!("{:<width$}", cell(place), width = widths[place]),
        });
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    let head = line(&|place| columns[place].name.clone());
    let rows = (0..columns.first().map_or(0, Column::len)).map(|row| line(&|place| cells[place][row].clone()));
    std::iter::once(head).chain(rows).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(values: &[f64]) -> Vec<Column> {
        let words = values.iter().map(|value| format!("row {value}")).collect();
        vec![
            Column { name: "name".to_owned(), entries: Entries::Words(words) },
            Column { name: "ball.z, up".to_owned(), entries: Entries::Numbers(values.to_vec()) },
        ]
    }

    #[test]
    fn numbers_stand_below_each_other() {
        let text = aligned(&columns(&[0.5, -12.0, f64::NAN]), 6);
        let lines = ["name     ball.z, up", "row 0.5         0.5", "row -12         -12", "row NaN           -"];
        assert_eq!(text, lines.join("\n"));
        assert_eq!([6.000_000_000_000_001e-4, 1e-7].map(|value| rounded(value, 6)), ["0.0006", "1e-7"]);
    }

    #[test]
    fn several_tables_have_their_names_before_the_rows() {
        let table = joined(vec![("one", columns(&[1.0, f64::NAN])), ("two, b", columns(&[0.1]))]);
        let text = "table,name,\"ball.z, up\"\none,row 1,1e0\none,row NaN,\n\"two, b\",row 0.1,1e-1\n";
        assert_eq!(separated(&table), text);
        assert_eq!(separated(&joined(vec![("one", columns(&[2.0]))])), "name,\"ball.z, up\"\nrow 2,2e0\n");
    }
}
