//! Observed order in time of the shipped free flight against a fine reference.

use toml::{Table, Value};

use super::check::{Bound, Check};
use super::{Bench, Findings, Suite};
use crate::verify::numbers::larger;
use crate::vtu::Grid;
use crate::workspace::Outcome;

/// Second order of the energy-momentum scheme.
pub struct Convergence;

/// Length of the runs in steps of the shipped scene: short, because the steps must resolve the fastest vibrations before
/// any order can be seen, and those are far below the shipped step.
const LENGTH: f64 = 2.0;

/// Steps of the coarsest run; each of the others has twice as many.
const COARSEST: i64 = 20;

/// Runs whose errors are compared.
const LEVELS: u32 = 3;

/// The reference has this many times the steps of the finest of them; its own error is about 1/64 of that one's.
const REFERENCE: i64 = 8;

/// Least order that counts as two.
const ORDER: f64 = 1.9;

impl Suite for Convergence {
    fn name(&self) -> &'static str {
        "convergence"
    }

    fn about(&self) -> &'static str {
        "Largest error of a node's position at the end of a short free flight, against a run with a much smaller step."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let shipped = bench.scene("flight")?;
        let mut findings = Findings::default();
        let mut solve = |steps: i64| -> Outcome<Option<Grid>> {
            let run = bench.run_variant(&format!("flight-{steps}-steps"), &variant(&shipped, steps)?)?;
            findings.checks.push(run.completed(0));
            if run.succeeded() { run.last_frame().map(Some) } else { Ok(None) }
        };
        let finest = COARSEST << (LEVELS - 1);
        let Some(reference) = solve(REFERENCE * finest)? else { return Ok(findings) };
        let mut errors = Vec::new();
        for level in 0..LEVELS {
            let steps = COARSEST << level;
            let Some(grid) = solve(steps)? else { return Ok(findings) };
            errors.push((steps, distance(&grid, &reference)?));
        }
        for pair in errors.windows(2) {
            let order = (pair[0].1 / pair[1].1).log2();
            let quantity = format!("order from {} to {} steps", pair[0].0, pair[1].0);
            let note = format!("errors {:.2e}, {:.2e}", pair[0].1, pair[1].1);
            findings.checks.push(Check::new("flight", quantity, order, Bound::AtLeast(ORDER)).noted(note));
        }
        Ok(findings)
    }
}

/// The shipped flight over [`LENGTH`] of its steps, in `steps` steps.
fn variant(shipped: &Table, steps: i64) -> Outcome<Table> {
    let mut scene = shipped.clone();
    let time = scene.get_mut("time").and_then(Value::as_table_mut).ok_or("the flight has no [time]")?;
    let step = time.get("step").and_then(Value::as_float).ok_or("the flight has no step size")?;
    let end = LENGTH * step;
    time.insert("end".into(), Value::Float(end));
    time.insert("step".into(), Value::Float(end / steps as f64));
    scene.insert("output".into(), Value::Table(format!("every = {steps}").parse()?));
    scene.remove("expect");
    Ok(scene)
}

/// Largest distance of a point between two frames of the same mesh.
fn distance(a: &Grid, b: &Grid) -> Result<f64, String> {
    let field = |grid: &'_ Grid| grid.point_data.get("displacement").cloned().ok_or("no displacement in the frame");
    let (a, b) = (field(a)?, field(b)?);
    if a.values.len() != b.values.len() || a.components != 3 {
        return Err("the frames do not fit each other".into());
    }
    let differences = a.values.chunks(3).zip(b.values.chunks(3));
    let lengths = differences.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt());
    Ok(lengths.fold(0.0, larger))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vtu::Array;

    #[test]
    fn all_variants_end_at_the_same_time() {
        let shipped: Table = "[time]\nend = 1.0\nstep = 0.5\n".parse().unwrap();
        for steps in [20, 40, 640] {
            let scene = variant(&shipped, steps).unwrap();
            assert_eq!(scene["time"]["end"].as_float(), Some(1.0));
            assert_eq!(scene["time"]["step"].as_float(), Some(1.0 / steps as f64));
        }
    }

    #[test]
    fn the_distance_is_the_largest_of_all_points() {
        let grid = |values: &[f64]| {
            let mut grid = Grid::default();
            grid.point_data.insert("displacement".into(), Array { components: 3, values: values.to_vec() });
            grid
        };
        let apart = distance(&grid(&[0.0; 6]), &grid(&[1.0, 0.0, 0.0, 0.0, 3.0, 4.0])).unwrap();
        assert_eq!(apart, 5.0);
        assert!(distance(&grid(&[0.0; 6]), &grid(&[0.0; 3])).is_err());
    }
}
