//! Columns of a table, and formulas of them.
//!
//! A formula has the arithmetic of scenes with names of columns in place of parameters, and three functions of the rows: `before(x)` is the value in the row before, `change(x)` is
//! `x - before(x)`, `sum(x)` the sum of all rows so far.

use stoss::scene::{Formula, known};
use stoss_report::table::TextTable;

/// A column with its heading.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub name: String,
    pub entries: Entries,
}

/// What a column holds; a number that is missing is NaN.
#[derive(Clone, Debug, PartialEq)]
pub enum Entries {
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

/// A function of the rows of a column.
type RowFunction = fn(&[f64]) -> Vec<f64>;

const ROW_FUNCTIONS: [(&str, RowFunction); 3] = [("before", before), ("change", change), ("sum", sum)];

fn before(x: &[f64]) -> Vec<f64> {
    std::iter::once(f64::NAN).chain(x.iter().copied()).take(x.len()).collect()
}

fn change(x: &[f64]) -> Vec<f64> {
    x.iter().zip(before(x)).map(|(x, before)| x - before).collect()
}

fn sum(x: &[f64]) -> Vec<f64> {
    let add = |sum: &mut f64, x: &f64| {
        *sum += x;
        Some(*sum)
    };
    x.iter().scan(0.0, add).collect()
}

/// The columns of a table: numbers, or words if an entry is neither a number nor empty.
pub fn of_table(table: &TextTable) -> Vec<Column> {
    let column = |(place, name): (usize, &String)| {
        let cells = || table.rows.iter().map(|row| row[place].trim());
        let numbers: Option<Vec<f64>> =
            cells().map(|cell| if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok() }).collect();
        let entries = numbers.map_or_else(|| Entries::Words(cells().map(str::to_owned).collect()), Entries::Numbers);
        Column { name: name.clone(), entries }
    };
    table.names.iter().enumerate().map(column).collect()
}

/// The columns that are asked for: names, formulas, or `NAME = FORMULA`; later ones may use the names of earlier ones.
///
/// # Errors
/// What is wrong with one, with what is there.
pub fn choose(table: &TextTable, asked: &[String]) -> Result<Vec<Column>, String> {
    let mut all = of_table(table);
    let rows = table.rows.len();
    let mut chosen = Vec::new();
    for text in asked {
        let (name, formula) = text.split_once('=').unwrap_or((text, text));
        let (name, formula) = (name.trim(), formula.trim());
        let same = all.iter().find(|column| column.name == formula);
        let entries = match same {
            Some(column) => column.entries.clone(),
            None => Entries::Numbers(
                evaluate(formula, &all, rows).map_err(|message| format!("--columns \"{text}\": {message}"))?,
            ),
        };
        let column = Column { name: name.to_owned(), entries };
        if name != formula {
            all.push(column.clone());
        }
        chosen.push(column);
    }
    Ok(chosen)
}

/// Values of a formula in all rows.
fn evaluate(text: &str, columns: &[Column], rows: usize) -> Result<Vec<f64>, String> {
    let mut series: Vec<Vec<f64>> = Vec::new();
    let (mut formula, mut rest) = (String::new(), text);
    while let Some(first) = rest.chars().next() {
        let begins = !formula.ends_with(is_of_name) && is_of_name(first);
        let length = if begins { longest_name(rest, columns) } else { 0 };
        if length > 0 {
            let (name, after) = rest.split_at(length);
            series.push(numbers(name, columns)?);
            formula += &variable(series.len() - 1);
            rest = after;
            continue;
        }
        let word = if begins && first.is_alphabetic() { word(rest) } else { "" };
        let after = &rest[word.len()..];
        let function = ROW_FUNCTIONS.iter().find(|(name, _)| *name == word);
        if let Some((_, function)) = function.filter(|_| after.trim_start().starts_with('(')) {
            let (inside, after) = bracket(after).ok_or("a closing bracket is missing")?;
            series.push(function(&evaluate(inside, columns, rows)?));
            formula += &variable(series.len() - 1);
            rest = after;
        } else if word.is_empty() {
            formula.push(first);
            rest = &rest[first.len_utf8()..];
        } else if word == "pi" || after.trim_start().starts_with('(') {
            formula += word;
            rest = after;
        } else {
            let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
            return Err(format!("there is no column `{word}`; {}", known(word, names)));
        }
    }
    let variables: Vec<String> = (0..series.len()).map(variable).collect();
    let variables: Vec<&str> = variables.iter().map(|name| name.trim()).collect();
    let formula = Formula::parse(&formula, &variables)?;
    let row = |row: usize| series.iter().map(|values| values[row]).collect::<Vec<_>>();
    Ok((0..rows).map(|k| formula.value(&row(k))).collect())
}

/// What stands for a series in a formula, with blanks around it.
fn variable(k: usize) -> String {
    format!(" series_{k} ")
}

fn is_of_name(symbol: char) -> bool {
    symbol.is_alphanumeric() || symbol == '_' || symbol == '.'
}

/// Length of the longest name of a column with which a text begins.
fn longest_name(text: &str, columns: &[Column]) -> usize {
    let fits = |name: &&str| {
        text.strip_prefix(*name).is_some_and(|rest| !rest.starts_with(is_of_name) && !rest.starts_with('('))
    };
    columns.iter().map(|column| column.name.as_str()).filter(fits).map(str::len).max().unwrap_or(0)
}

/// The word with which a text begins.
fn word(text: &str) -> &str {
    &text[..text.find(|symbol: char| !is_of_name(symbol)).unwrap_or(text.len())]
}

/// What is inside of a bracket with which a text begins, and what follows it.
fn bracket(text: &str) -> Option<(&str, &str)> {
    let inner = text.trim_start().strip_prefix('(')?;
    let mut depth = 1;
    for (at, symbol) in inner.char_indices() {
        depth += i32::from(symbol == '(') - i32::from(symbol == ')');
        if depth == 0 {
            return Some((&inner[..at], &inner[at + 1..]));
        }
    }
    None
}

fn numbers(name: &str, columns: &[Column]) -> Result<Vec<f64>, String> {
    // The last of equal names is the one that was defined here.
    match columns.iter().rev().find(|column| column.name == name).map(|column| &column.entries) {
        Some(Entries::Numbers(values)) => Ok(values.clone()),
        _ => Err(format!("the column `{name}` has words; a formula needs numbers")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> TextTable {
        TextTable::parse("step,time,ball.z,left-end.x,body\n0,0.0,-1.0,2,a\n1,0.5,3.0,,b\n").unwrap()
    }

    fn values(text: &str) -> Vec<f64> {
        match &choose(&table(), &[text.to_owned()]).unwrap_or_else(|error| panic!("{error}"))[0].entries {
            Entries::Numbers(values) => values.clone(),
            Entries::Words(words) => panic!("{words:?}"),
        }
    }

    #[test]
    fn formulas_of_columns() {
        for (text, wanted) in [
            ("ball.z", [-1.0, 3.0]),
            ("ball.z + 2*time", [-1.0, 4.0]),
            ("total = abs(ball.z)^2", [1.0, 9.0]),
            ("-ball.z", [1.0, -3.0]),
            ("max(step, time) - pi*0", [0.0, 1.0]),
            ("2e-3 * step", [0.0, 2e-3]),
            ("sum(min(step, 1) + 1)", [1.0, 3.0]),
            ("sum = sum(step + 1)", [1.0, 3.0]),
        ] {
            assert_eq!(values(text), wanted, "{text}");
        }
        // Of the first row there is none before; what is missing has no value.
        for text in ["change(ball.z)", "before(ball.z) + 5", "4 * before(step + 1)"] {
            assert!(values(text)[0].is_nan() && values(text)[1] == 4.0, "{text}: {:?}", values(text));
        }
        let missing = values("left-end.x - time");
        assert!(missing[0] == 2.0 && missing[1].is_nan(), "{missing:?}");
    }

    #[test]
    fn later_columns_use_earlier_ones() {
        let asked = ["body", "d = change(time)", "rate = ball.z / d"].map(str::to_owned);
        let columns = choose(&table(), &asked).unwrap();
        assert_eq!(columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(), ["body", "d", "rate"]);
        assert_eq!(columns[0].entries, Entries::Words(vec!["a".into(), "b".into()]));
        assert!(matches!(&columns[2].entries, Entries::Numbers(values) if values[1] == 6.0));
    }

    #[test]
    fn mistakes_are_named() {
        for (text, says) in [
            ("ball", "there is no column `ball`; did you mean"),
            ("ball.zz + 1", "`ball.zz`"),
            ("2 * body", "has words"),
            ("sum(time", "bracket"),
            ("time +", "ends too early"),
            ("time time", "operator"),
            ("", "ends too early"),
        ] {
            let error = choose(&table(), &[text.to_owned()]).unwrap_err();
            assert!(error.contains(says) && error.contains("--columns"), "{text}: {error}");
        }
    }
}
