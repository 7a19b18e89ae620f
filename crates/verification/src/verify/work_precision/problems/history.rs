//! Values of a run at given times, and pieces of scenes that problems in motion share.

use crate::table::Table;
use crate::verify::work_precision::campaign::Choice;
use crate::workspace::Outcome;

/// Integrators of problems in motion.
pub const SCHEMES: &[&str] = &["energy-momentum", "midpoint", "backward-euler", "generalised-alpha", "newmark"];

/// Methods for the contact of two surfaces.
pub const METHODS: &[&str] = &["nts", "cat", "mortar", "mortar dual", "general"];

/// A fixed plane z = 0 that reaches `half` to all sides, the rigid body `floor`.
pub fn floor(half: f64) -> String {
    let size = 2.0 * half;
    format!("[[rigid]]\nname = \"floor\"\nshape = {{ kind = \"plane\", size = [{size:?}, {size:?}] }}\nfixed = true\n")
}

/// A `[[probe]]` of a body.
pub fn probe(name: &str, quantity: &str, body: &str) -> String {
    format!("[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\nbody = \"{body}\"\n")
}

/// A restitution for the law of impact, or why the choice has none.
pub fn restitution(choice: &Choice, value: f64) -> Outcome<String> {
    match choice.method {
        "cat" => Err("`cat` keeps the velocities of the step: it has no law of impact".into()),
        "general" => Err("general contact has no coefficient of restitution".into()),
        _ => Ok(format!("restitution = {value:?}\n")),
    }
}

/// The column at these times, linear between two steps; an error names a time that no step reaches.
pub fn at(table: &Table, column: &str, times: &[f64]) -> Outcome<Vec<f64>> {
    let (steps, values) = (table.column("time")?, table.column(column)?);
    let value = |&time: &f64| -> Outcome<f64> {
        // Round-off of the sum of steps.
        let reached = |step: &f64| time <= step + 1e-9 * time.abs();
        let after = steps.iter().position(reached).ok_or_else(|| format!("{column}: no step at {time}"))?;
        let before = after.saturating_sub(1);
        let length = steps[after] - steps[before];
        let share = if length > 0.0 { ((time - steps[before]) / length).min(1.0) } else { 0.0 };
        Ok(values[before] + share * (values[after] - values[before]))
    };
    times.iter().map(value).collect()
}

/// `count` equal parts of the time to `end`: their ends.
pub fn parts(count: u32, end: f64) -> Vec<f64> {
    (1..=count).map(|k| end * f64::from(k) / f64::from(count)).collect()
}

/// Phases of the step in which four bodies meet what they hit: their numbers, and parts of a step.
pub fn phases() -> impl Iterator<Item = (usize, f64)> {
    [0.125, 0.375, 0.625, 0.875].into_iter().enumerate()
}

/// The same in steps, two more for each, so that no two meet it in one step.
pub fn apart() -> impl Iterator<Item = (usize, f64)> {
    phases().map(|(k, phase)| (k, 2.0 * k as f64 + phase))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_interpolated_and_missing_times_named() {
        let table = Table::parse("time,a\n0,1\n0.5,2\n1.0,4\n").unwrap();
        assert_eq!(at(&table, "a", &[0.0, 0.25, 0.5, 0.75, 1.0]).unwrap(), [1.0, 1.5, 2.0, 3.0, 4.0]);
        assert!(at(&table, "a", &[1.1]).unwrap_err().to_string().contains("no step at 1.1"));
        assert_eq!(parts(4, 2.0), [0.5, 1.0, 1.5, 2.0]);
    }
}
