//! The columns of each contact pair in `contact.csv`: against probes, the ledger and closed forms, over stages and a restart.

use std::collections::BTreeMap;
use std::path::Path;
use stoss::run::{RunOptions, run_scene};

/// A stiff block on two plates is pressed down while contact acts, drawn along x, and then left to itself with the second contact off.
const SCENE: &str = r#"
[scene]
title = "block on two plates"
kind = "quasi-static"
[time]
end = 3.0
step = 0.25
[[body]]
name = "block"
mesh = { generator = "block", min = [-0.5, -0.5, 1], max = [0.5, 0.5, 2], divisions = [5, 2, 2] }
material = { law = "neo-hooke", young = 1e6, poisson = 0.3 }
[[body]]
name = "left"
mesh = { generator = "block", min = [-1, -1, 0], max = [0, 1, 1], divisions = [3, 4, 2] }
material = { law = "neo-hooke", young = 1e6, poisson = 0.3 }
[[body]]
name = "right"
mesh = { generator = "block", min = [0, -1, 0], max = [1, 1, 1], divisions = [3, 4, 2] }
material = { law = "neo-hooke", young = 1e6, poisson = 0.3 }
[[prescribe]]
set = "left.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "right.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.top"
components = ["x", "y", "z"]
displacement = { table = [[0, 0, 0, 0.001], [1, 0, 0, -0.001], [2, 0.08, 0, -0.001], [3, 0.08, 0, 0.1]] }
[[contact]]
name = "on-left"
method = "METHOD"
slave = "block.bottom"
master = "left.top"
friction = { law = "coulomb", mu = 0.3 }
[[contact]]
name = "on-right"
method = "METHOD"
slave = "block.bottom"
master = "right.top"
[[stage]]
name = "pressed"
kind = "quasi-static"
until = 2.0
[[stage]]
name = "lifted"
kind = "quasi-static"
until = 3.0
off = ["on-left"]
[[probe]]
name = "force"
set = "block.bottom"
quantity = "contact_force"
[[probe]]
name = "moment"
set = "block.bottom"
quantity = "contact_moment"
"#;

/// Columns of a table by name.
fn columns(folder: &Path, name: &str) -> BTreeMap<String, Vec<f64>> {
    let text = std::fs::read_to_string(folder.join(name)).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    names.iter().enumerate().map(|(k, name)| ((*name).to_owned(), rows.iter().map(|row| row[k]).collect())).collect()
}

fn run(folder: &Path, method: &str, until: Option<f64>, resume: bool) {
    let path = folder.join("scene.toml");
    std::fs::write(&path, SCENE.replace("METHOD", method)).unwrap();
    let options = RunOptions { out: folder.join("out"), until, resume, ..RunOptions::default() };
    run_scene(&path, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn each_pair_has_its_own_columns() {
    for method in ["nts", "mortar"] {
        let folder = tempfile::tempdir().unwrap();
        run(folder.path(), method, None, false);
        let [contact, balance, probes] =
            ["contact.csv", "balance.csv", "probes.csv"].map(|t| columns(&folder.path().join("out"), t));
        let steps = contact["step"].len();
        assert_eq!(steps, balance["step"].len() - 1, "one row a step, also where a pair is off");
        for k in 0..steps {
            let sum =
                |column: &str| contact[&format!("on-left.{column}")][k] + contact[&format!("on-right.{column}")][k];
            for axis in ["x", "y", "z"] {
                let [force, moment] = [sum(&format!("force_{axis}")), sum(&format!("moment_{axis}"))];
                let total = contact[&format!("contact_force_{axis}")][k];
                let scale = 1.0 + total.abs();
                assert!((force - total).abs() < 1e-10 * scale, "{method}: {force} {total}");
                let [by_probe, moment_by_probe] = ["force", "moment"].map(|p| probes[&format!("{p}.{axis}")][k + 1]);
                assert!((force - by_probe).abs() < 1e-9 * scale, "{method}: {force} {by_probe}");
                assert!((moment - moment_by_probe).abs() < 1e-8 * scale, "{method}: {moment} {moment_by_probe}");
            }
            let work = contact["on-left.friction_work"][k];
            assert!((work - balance["friction_work"][k + 1]).abs() < 1e-12 * (1.0 + work), "{method}");
        }
        let [time, left, right] = ["time", "on-left.area", "on-right.area"].map(|name| &contact[name]);
        let at = |t: f64| time.iter().position(|now| (now - t).abs() < 1e-9).unwrap();
        // The bottom of the block, but for strains of 1e-3. Of the strip of facets above the seam of the plates, a fifth of it, mortar rows may be open.
        let least = if method == "mortar" { 0.8 } else { 1.0 };
        for t in [1.0, 1.5, 2.0] {
            let whole = left[at(t)] + right[at(t)];
            assert!(whole > least - 2e-3 && whole < 1.002, "{method}: {whole} at {t}");
        }
        // Nothing where a pair is off or the block is in the air.
        for name in ["active", "force_x", "force_z", "area", "max_pressure"] {
            assert_eq!(contact[&format!("on-left.{name}")][at(2.25)], 0.0, "{method}: {name}");
        }
        assert_eq!(left[at(3.0)] + right[at(3.0)], 0.0);
        assert_eq!(contact["on-left.min_gap"][at(3.0)], f64::INFINITY);
        // The block slides from the second step on: friction is the coefficient times the normal force, its work that times the way.
        for t in [1.5, 1.75, 2.0] {
            let of = |column: &str, k: usize| contact[&format!("on-left.{column}")][k];
            let (force, normal, k) = (of("force_x", at(t)), of("force_z", at(t)), at(t));
            assert!(
                normal > 100.0 && (force + 0.3 * normal).abs() < 0.01 * normal,
                "{method}: {force} {normal} at {t}"
            );
            let work = of("friction_work", k) - of("friction_work", k - 1);
            assert!((work / (-force * 0.02) - 1.0).abs() < 0.05, "{method}: {work} {force} at {t}");
            assert!(contact["on-right.force_x"][k].abs() < 0.01 * normal, "{method}: no friction there");
        }
        // The second half of the run from a checkpoint.
        let again = tempfile::tempdir().unwrap();
        run(again.path(), method, Some(1.5), false);
        run(again.path(), method, None, true);
        let bytes = |folder: &Path| std::fs::read(folder.join("out/contact.csv")).unwrap();
        assert!(bytes(folder.path()) == bytes(again.path()), "{method}: another table after a restart");
    }
}
