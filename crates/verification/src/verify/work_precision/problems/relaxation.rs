//! A viscoelastic bar that is stretched at a constant speed and held.

use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

/// Shear modulus of fast strains and bulk modulus.
const SHEAR: f64 = 1.0;
const BULK: f64 = 10.0;
/// Shares and relaxation times of the branches.
const BRANCHES: [[f64; 2]; 2] = [[0.4, 0.3], [0.3, 2.0]];
/// Stretch at the end of the first half, which then is held.
const STRETCH: f64 = 1.5;
/// Times at which the force is compared.
const AT: [f64; 5] = [0.2, 0.4, 1.0, 1.2, 2.0];
const END: f64 = 2.0;

const BEST: Choice =
    Choice { scheme: "statics", method: "none", cell: "hex8", mesh: 1, steps: 40, solver: "direct", tolerance: 1e-9 };

/// Row of the table.
pub const PROBLEM: Problem = Problem {
    name: "relaxation",
    title: "Bar that relaxes",
    about: "A cube of Hencky's law with two Maxwell branches (shear modulus 1, bulk modulus 10; shares 0.4 and 0.3 with times 0.3 and 2) is stretched by a half during a time of 1, and held for a time of 1; its sides are free. \
            The strain is uniform: the error is that of the steps.",
    quantities: &["force"],
    reference: Reference::Closed {
        source: "the law in one dimension, by the method of Runge and Kutta with steps of 1e-5",
        values: one_dimension,
    },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["none"],
    cells: &["hex8"],
    meshes: &[1],
    steps: &[10, 20, 40, 80, 160],
    solvers: &["direct"],
    tolerances: &[1e-4, 1e-9],
    claims: &[Claim { line: "step", quantity: "force", at_least: 1.9 }],
    quick: 5,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let [[a, ta], [b, tb]] = BRANCHES;
    let lambda = BULK - 2.0 / 3.0 * SHEAR;
    let mut text = format!(
        "{}[[body]]\nname = \"bar\"\n{}mesh = {{ generator = \"block\", size = [1, 1, 1], divisions = [1, 1, {}] }}\n\
         material = {{ law = \"hencky\", lambda = {lambda:?}, mu = {SHEAR:?}, prony = [[{a:?}, {ta:?}], [{b:?}, {tb:?}]] }}\n",
        choice.head("Bar that relaxes", END),
        choice.cell_keys(),
        choice.mesh
    );
    for (set, component) in [("left", "x"), ("front", "y"), ("bottom", "z")] {
        text += &format!("[[prescribe]]\nset = \"bar.{set}\"\ncomponents = [\"{component}\"]\nfixed = true\n");
    }
    let pulled = STRETCH - 1.0;
    text += &format!(
        "[[prescribe]]\nset = \"bar.top\"\ncomponents = [\"z\"]\ndisplacement = {{ table = [[0.0, 0.0], [1.0, {pulled:?}], [{END:?}, {pulled:?}]] }}\n\
         [[probe]]\nname = \"pull\"\nquantity = \"reaction\"\nset = \"bar.top\"\n"
    );
    Ok(text)
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let (time, force) = (probes.column("time")?, probes.column("pull.z")?);
    let at = |t: f64| -> Outcome<f64> {
        let row = time.iter().position(|time| (time - t).abs() < 1e-9).ok_or_else(|| format!("no step ends at {t}"))?;
        Ok(force[row])
    };
    Ok(vec![AT.into_iter().map(at).collect::<Outcome<_>>()?])
}

/// Logarithmic strain `l = e + s / (6 K)` along the bar, with the deviator `s = 2 G e - 2 sum g_i G q_i` of the Kirchhoff stress and `q_i' = (e - q_i) / t_i`; the stress is `3 s / 2`, since the sides are free,
/// and the force that over the stretch.
fn one_dimension(_: &Run, _: &Choice) -> Outcome<Values> {
    let stretch = |t: f64| 1.0 + (STRETCH - 1.0) * t.min(1.0);
    let deviator = |t: f64, q: [f64; 2]| {
        let flowed: f64 = BRANCHES.iter().zip(q).map(|([share, _], q)| 2.0 * share * SHEAR * q).sum();
        let e = (stretch(t).ln() + flowed / (6.0 * BULK)) / (1.0 + SHEAR / (3.0 * BULK));
        (e, 2.0 * SHEAR * e - flowed)
    };
    let rate = |t: f64, q: [f64; 2]| -> [f64; 2] {
        let (e, _) = deviator(t, q);
        std::array::from_fn(|i| (e - q[i]) / BRANCHES[i][1])
    };
    let ahead = |q: [f64; 2], r: [f64; 2], h: f64| -> [f64; 2] { std::array::from_fn(|i| q[i] + h * r[i]) };
    let steps = 200_000;
    let h = END / f64::from(steps);
    let (mut q, mut forces) = ([0.0; 2], Vec::new());
    for step in 0..steps {
        let t = h * f64::from(step);
        let a = rate(t, q);
        let b = rate(t + 0.5 * h, ahead(q, a, 0.5 * h));
        let c = rate(t + 0.5 * h, ahead(q, b, 0.5 * h));
        let d = rate(t + h, ahead(q, c, h));
        q = std::array::from_fn(|i| q[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        if AT.iter().any(|at| (at - t - h).abs() < 0.5 * h) {
            forces.push(1.5 * deviator(t + h, q).1 / stretch(t + h));
        }
    }
    Ok(vec![forces])
}
