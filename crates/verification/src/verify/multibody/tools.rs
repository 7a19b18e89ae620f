//! Rigid bodies as tools on deformable ones, through scenes.

use super::build::place;
use super::noted;
use super::scene::{probe, run, value};
use crate::verify::check::Bound;
use crate::verify::numbers::larger;
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;
use std::f64::consts::PI;
use toml::{Table, Value};

/// Measures all cases of rigid tools.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    incline(findings)?;
    // Coarse meshes have no bound.
    if !bench.quick {
        hertz(bench, findings)?;
    }
    ironing(bench, findings)
}

/// Young's modulus and Poisson's ratio of the ball of the shipped scene; both balls have the radius 1.
const ELASTIC: [f64; 2] = [1000.0, 0.3];
/// Largest relative error on the finest mesh, with ten elements over the zone of the contact.
const CLOSE: f64 = 0.01;

/// Radius of the contact and largest pressure of an elastic ball and a rigid one of radius 1 each, thus `1/R = 2`, under a force on the whole of them
/// (Johnson, *Contact mechanics*, section 4.2).
fn of_hertz(force: f64) -> (f64, f64) {
    let modulus = ELASTIC[0] / (1.0 - ELASTIC[1] * ELASTIC[1]);
    let a = (0.75 * force * 0.5 / modulus).cbrt();
    (a, 1.5 * force / (PI * a * a))
}

/// The shipped eighth of a ball on an eighth of a rigid ball in place of the plane; `elements` over the zone of the contact.
fn two_balls(bench: &Bench, method: &str, elements: i64) -> Outcome<Table> {
    let mut scene = bench.scene("hertz-ball")?;
    for key in ["expect", "output", "probe"] {
        scene.remove(key);
    }
    let scaled = |n: i64| (n * elements + 9) / 10;
    let mesh = format!(
        "{{ generator = \"ball\", radius = 1.0, part = \"eighth\", divisions = [{}, {}, {}], refinement = {{ half_width = 0.021, elements = {elements} }} }}",
        scaled(18),
        scaled(4),
        scaled(14)
    );
    let list = |scene: &mut Table, key: &str, keep: &dyn Fn(&Table) -> bool| -> Outcome<()> {
        let items = scene.get_mut(key).and_then(Value::as_array_mut).ok_or_else(|| format!("no list {key}"))?;
        items.retain(|item| item.as_table().is_some_and(keep));
        Ok(())
    };
    let is = |item: &Table, key: &str, word: &str| item.get(key).and_then(Value::as_str) == Some(word);
    list(&mut scene, "body", &|body| is(body, "name", "ball"))?;
    list(&mut scene, "prescribe", &|item| !is(item, "set", "plane.all"))?;
    super::scene::named(&mut scene, "body", "ball")?.insert("mesh".into(), value(&mesh)?);
    let rigid = format!(
        "[{{ name = \"tool\", mesh = {mesh}, position = [0.0, 0.0, -2.0], rotation = {{ axis = [1, 1, 0], degrees = 180 }}, fixed = true }}]"
    );
    scene.insert("rigid".into(), value(&rigid)?);
    let contact = format!("[{{ method = \"{method}\", slave = \"ball.outer\", master = \"tool.outer\" }}]");
    scene.insert("contact".into(), value(&contact)?);
    Ok(scene)
}

/// An elastic ball on a rigid one: radius of the contact from the second moment of the nodal forces, `2 a^2 / 5` of the resultant, and the largest pressure.
fn hertz(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    for method in ["mortar", "nts"] {
        let case = format!("Hertz, rigid ball, {method}");
        let mut errors = Vec::new();
        for elements in [5, 10] {
            let mut pressure = f64::NAN;
            let scene = two_balls(bench, method, elements)?;
            let simulation = run(&scene, "hertz-rigid", |_, _, record| {
                pressure = record.contact.as_ref().map_or(f64::NAN, |contact| contact.max_pressure);
            })?;
            let nodes = simulation.model().bodies[0].nodes.clone();
            let (mut force, mut moment) = (0.0, 0.0);
            for node in nodes {
                let (x, f) = (place(&simulation.state().q, node), place(simulation.contact_force(), node));
                force += f[2];
                moment += f[2] * (x[0] * x[0] + x[1] * x[1]);
            }
            // An eighth has a quarter of the contact.
            let (a, p0) = of_hertz(4.0 * force.abs());
            let found = (2.5 * moment / force).sqrt();
            let bound = if elements == 10 { Bound::AtMost(CLOSE) } else { Bound::Unbounded };
            let note =
                format!("{elements} elements over the zone; a = {a:.5}, p0 = {p0:.2}; found {found:.5}, {pressure:.2}");
            noted(findings, &case, "error of the contact radius", (found / a - 1.0).abs(), bound, note.clone());
            // The slots of nodes against surfaces have forces, not pressures.
            let bound = if method == "mortar" { bound } else { Bound::Unbounded };
            noted(findings, &case, "error of the largest pressure", (pressure / p0 - 1.0).abs(), bound, note);
            errors.push((found / a - 1.0).abs());
        }
        if let [coarse, fine] = errors[..] {
            let note = "the finer mesh is better, unless both are within the bound";
            noted(
                findings,
                &case,
                "error of the radius over that of the coarser mesh",
                fine / coarse,
                Bound::Unbounded,
                note,
            );
        }
    }
    Ok(())
}

/// Ironing with the shipped, stiff indenter and with a rigid one: forces of both, and what resists over what presses.
fn ironing(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let case = "ironing with a rigid indenter";
    let mut shipped = bench.scene("ironing-mortar-friction")?;
    for key in ["expect", "output"] {
        shipped.remove(key);
    }
    super::scene::named(&mut shipped, "body", "slab")?
        .get_mut("mesh")
        .and_then(Value::as_table_mut)
        .ok_or("no mesh")?
        .insert("divisions".into(), value("[20, 5, 3]")?);
    let end = if bench.quick { 2.0 } else { 10.0 };
    shipped.get_mut("time").and_then(Value::as_table_mut).ok_or("no [time]")?.insert("end".into(), Value::Float(end));
    shipped.remove("probe");
    let mut rigid = shipped.clone();
    let bodies = rigid.get_mut("body").and_then(Value::as_array_mut).ok_or("no bodies")?;
    bodies.retain(|body| body.get("name").and_then(Value::as_str) == Some("slab"));
    rigid.insert("rigid".into(), value("[{ name = \"indenter\", shape = { kind = \"box\", size = [1.0, 1.0, 1.0], divisions = [4, 4, 4] }, position = [1.5, 2.0, 3.5] }]")?);
    let motions = rigid.get_mut("prescribe").and_then(Value::as_array_mut).ok_or("no motion")?;
    for motion in motions.iter_mut().filter_map(Value::as_table_mut) {
        if motion.get("set").and_then(Value::as_str) == Some("indenter.top") {
            motion.remove("set");
            motion.insert("rigid".into(), Value::String("indenter".into()));
        }
    }
    let forces = |scene: &Table| -> Outcome<(Vec<[f64; 3]>, usize)> {
        let (mut forces, mut cuts) = (Vec::new(), 0);
        run(scene, "ironing", |_, _, record| {
            forces.push(record.contact.as_ref().map_or([f64::NAN; 3], |contact| contact.force_on_slave));
            cuts += record.decisions.len();
        })?;
        Ok((forces, cuts))
    };
    let ((soft, _), (stiff, cuts)) = (forces(&shipped)?, forces(&rigid)?);
    noted(findings, case, "decisions about steps", cuts as f64, Bound::Unbounded, format!("{} steps", stiff.len()));
    let (Some(a), Some(b)) = (soft.last(), stiff.last()) else { return Err("no steps".into()) };
    // The indenter is 1000 times as stiff as the slab, which is three times as high: it takes about 3e-4 of the depth.
    let note = format!("rigid {:.5?}, indenter of 1000 times the slab's stiffness {:.5?}", b, a);
    noted(
        findings,
        case,
        "force on the indenter over that on the elastic one, less one",
        (b[2] / a[2] - 1.0).abs(),
        Bound::AtMost(1e-2),
        note,
    );
    noted(
        findings,
        case,
        "what resists over what presses",
        (b[0] / b[2]).abs(),
        Bound::Unbounded,
        format!("elastic {:.4}; mu = 0.5", (a[0] / a[2]).abs()),
    );
    Ok(())
}

/// A block on a rigid plane that is inclined by 0.95 and 1.05 of the angle of friction (as gravity that is tilted): it sticks, and it slides with `g (sin a - mu cos a)`.
fn incline(findings: &mut Findings) -> Outcome<()> {
    let case = "block on a rigid plane";
    let mu = 0.3_f64;
    for (method, friction) in [
        ("mortar", "friction = { law = \"coulomb\", mu = 0.3 }"),
        ("nts", "friction = { law = \"coulomb\", mu = 0.3 }"),
    ] {
        for share in [0.95, 1.05] {
            let angle = (share * mu).atan();
            let (s, c) = angle.sin_cos();
            let text = format!(
                "[scene]\ntitle = \"incline\"\nkind = \"dynamic\"\n[time]\nend = 4.0\nstep = 0.01\nintegrator = {{ scheme = \"backward-euler\" }}\n\
                 [gravity]\nacceleration = [{:?}, 0.0, {:?}]\n\
                 [[rigid]]\nname = \"plane\"\nshape = {{ kind = \"plane\", size = [12.0, 4.0], divisions = [6, 2] }}\nposition = [3.0, 0.5, 0.0]\nfixed = true\n\
                 [[body]]\nname = \"block\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 0.5], divisions = [2, 2, 1] }}\n\
                 material = {{ law = \"neo-hooke\", young = 1e5, poisson = 0.3 }}\ndensity = 1.0\n\
                 [[contact]]\nmethod = \"{method}\"\nslave = \"block.bottom\"\nmaster = \"plane.all\"\n{friction}\n\
                 [[probe]]\nname = \"v\"\nset = \"block.bottom\"\nquantity = \"velocity\"\n",
                10.0 * s,
                -10.0 * c
            );
            let (mut early, mut late, mut creep) = (f64::NAN, f64::NAN, 0.0_f64);
            run(&text.parse()?, "incline", |simulation, probes, record| {
                let v = probe(probes, "v", simulation)[0];
                if (record.time - 2.0).abs() < 1e-6 {
                    early = v;
                }
                if record.time > 2.0 - 1e-6 {
                    creep = larger(creep, v.abs());
                }
                late = v;
            })?;
            let case = format!("{case}, {method}");
            if share < 1.0 {
                noted(
                    findings,
                    &case,
                    "0.95 of the angle: largest speed from t = 2",
                    creep,
                    Bound::AtMost(1e-9),
                    "sticks",
                );
            } else {
                let exact = 10.0 * (s - mu * c);
                let note = format!("g (sin a - mu cos a) = {exact:.4}; from t = 2 to 4");
                noted(
                    findings,
                    &case,
                    "1.05 of the angle: acceleration over the closed form, less one",
                    ((late - early) / 2.0 / exact - 1.0).abs(),
                    Bound::AtMost(1e-2),
                    note,
                );
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The resultant of the pressures is the force, `2 pi a^2 p0 / 3`, and `p0 = 2 E* a / (pi R)`.
    #[test]
    fn closed_form_carries_the_force() {
        let (a, p0) = of_hertz(0.01);
        assert!((2.0 / 3.0 * PI * a * a * p0 - 0.01).abs() < 1e-15);
        assert!((p0 / (2.0 * 1000.0 / 0.91 * a / (PI * 0.5)) - 1.0).abs() < 1e-12);
    }
}
