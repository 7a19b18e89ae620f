//! Units of columns and fields, where the scene says what its numbers are measured in (`[scene] units`, `units` in `run.json`).

use serde_json::Value;

use crate::folder::Folder;

/// The unit of a column of a table, which is named by its file without `.csv`; nothing for pure numbers, and in runs without units.
pub fn of_column(folder: &Folder, table: &str, column: &str) -> Option<String> {
    if column == "time" {
        return of_time(folder);
    }
    let units = folder.run.as_ref()?.get("units")?;
    match table {
        "probes" => text(units.get("probes")?.get(column)?),
        "balance" => label(units, balance(column)?),
        "contact" => label(units, contact(column)?),
        "joints" => label(units, joint(column)?),
        _ => None,
    }
}

/// The unit of times; nothing in runs without units.
pub fn of_time(folder: &Folder) -> Option<String> {
    label(folder.run.as_ref()?.get("units")?, "time")
}

/// The unit of a field of the frames, by the name of its array or of what is taken of it (`largest_principal_cauchy_stress`); nothing for pure numbers,
/// and in runs without units.
pub fn of_field(folder: &Folder, name: &str) -> Option<String> {
    label(folder.run.as_ref()?.get("units")?, field(name)?)
}

/// A name for people with its unit behind it, as axes and colour bars have it: `gap [mm]`.
pub fn with_unit(name: &str, unit: Option<&str>) -> String {
    unit.map_or_else(|| name.to_owned(), |unit| format!("{name} [{unit}]"))
}

fn text(value: &Value) -> Option<String> {
    value.as_str().filter(|text| !text.is_empty()).map(str::to_owned)
}

fn label(units: &Value, dimension: &str) -> Option<String> {
    text(units.get("labels")?.get(dimension)?)
}

fn balance(column: &str) -> Option<&'static str> {
    Some(match column {
        "step" => return None,
        "dt" => "time",
        "lx" | "ly" | "lz" => "momentum",
        "jx" | "jy" | "jz" => "angular_momentum",
        // Kinetic, strain, and what the ledger has.
        _ => "energy",
    })
}

/// Columns of all contacts, and of one: `pair.force.x` and the like.
fn contact(column: &str) -> Option<&'static str> {
    let stem = column.strip_suffix(['x', 'y', 'z']).map_or(column, |stem| stem.trim_end_matches(['.', '_']));
    let word = stem.rsplit('.').next().unwrap_or(stem);
    match word {
        "min_gap" => Some("length"),
        "max_pressure" => Some("stress"),
        _ if word.ends_with("force") => Some("force"),
        _ if word.ends_with("moment") => Some("moment"),
        _ if word.ends_with("area") => Some("area"),
        _ if word.ends_with("work") => Some("energy"),
        _ => None,
    }
}

/// Columns of joints that have one meaning: what acts along a coordinate is a force or a moment.
fn joint(column: &str) -> Option<&'static str> {
    match column.rsplit('.').next()? {
        "fx" | "fy" | "fz" => Some("force"),
        "mx" | "my" | "mz" => Some("moment"),
        _ => None,
    }
}

fn field(name: &str) -> Option<&'static str> {
    match name {
        "displacement" | "gap" | "slip" | "distance_to_other_bodies" => Some("length"),
        "velocity" => Some("velocity"),
        "contact_pressure" | "friction_traction" | "von_mises" => Some("stress"),
        _ if name.contains("stress") => Some("stress"),
        _ if name.starts_with("reaction") || name.ends_with("force") => Some("force"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(run: &str) -> (tempfile::TempDir, Folder) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("balance.csv"), "step,time\n").unwrap();
        std::fs::write(folder.path().join("run.json"), run).unwrap();
        let opened = Folder::open(folder.path()).unwrap();
        (folder, opened)
    }

    #[test]
    fn columns_and_fields_have_the_units_of_the_run() {
        let (_keep, folder) = folder(
            r#"{"units": {"system": "mm-t-s", "probes": {"tip.x": "mm", "strain.xx": ""},
                "labels": {"time": "s", "length": "mm", "force": "N", "stress": "MPa", "energy": "mJ", "moment": "N mm",
                    "momentum": "N s", "angular_momentum": "N mm s", "velocity": "mm/s", "area": "mm²"}}}"#,
        );
        for (table, column, expected) in [
            ("probes", "tip.x", "mm"),
            ("probes", "strain.xx", ""),
            ("probes", "time", "s"),
            ("balance", "jx", "N mm s"),
            ("balance", "lz", "N s"),
            ("balance", "friction_work", "mJ"),
            ("balance", "step", ""),
            ("contact", "contact_force_x", "N"),
            ("contact", "ball/plate.force.x", "N"),
            ("contact", "ball/plate.moment_z", "N mm"),
            ("contact", "max_pressure", "MPa"),
            ("contact", "active", ""),
            ("joints", "elbow.mx", "N mm"),
            ("joints", "elbow.spring", ""),
            ("newton", "residual", ""),
        ] {
            assert_eq!(of_column(&folder, table, column).unwrap_or_default(), expected, "{table} {column}");
        }
        for (name, expected) in
            [("gap", "mm"), ("von_mises", "MPa"), ("pressure_of_cauchy_stress", "MPa"), ("contact_status", "")]
        {
            assert_eq!(of_field(&folder, name).unwrap_or_default(), expected, "{name}");
        }
        assert_eq!(with_unit("gap", Some("mm")), "gap [mm]");
        assert_eq!(with_unit("gap", None), "gap");
    }

    #[test]
    fn a_run_without_units_has_none() {
        let (_keep, folder) = folder(r#"{"bodies": []}"#);
        assert_eq!(of_column(&folder, "balance", "time"), None);
        assert_eq!(of_field(&folder, "gap"), None);
    }
}
