//! A thick tube that yields from the bore outwards.

use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Claim, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

/// Radii of the bore and the outside.
const RADII: [f64; 2] = [100.0, 200.0];
const YOUNG: f64 = 210e3;
const YIELD: f64 = 240.0;
/// Largest pressure; all of the tube flows at 192.09.
const PRESSURE: f64 = 180.0;
/// Pressures over the largest one at which the widening is compared: a half is elastic.
const AT: [f64; 4] = [0.5, 0.7, 0.9, 1.0];

const BEST: Choice = Choice {
    scheme: "statics",
    method: "none",
    cell: "hex20 reduced",
    mesh: 8,
    steps: 20,
    solver: "direct",
    tolerance: 1e-9,
};

/// Row of the table.
pub const PROBLEM: Problem = Problem {
    name: "plastic-tube",
    title: "Tube that yields",
    about: "A sector of two degrees of a thick tube (radii 100 and 200, Hencky's law with von Mises' yield stress 240 without hardening, Young's modulus 210 000, Poisson's ratio 0.4999, plane strain) under a pressure \
            that grows to 180 in its bore: the zone that flows grows outwards to three quarters of the wall. Mesh: elements through the wall.",
    quantities: &["widening of the bore"],
    reference: Reference::Closed {
        source: "R. Hill, The Mathematical Theory of Plasticity (1950), chapter V, small strains and no change of volume",
        values: hill,
    },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["statics"],
    methods: &["none"],
    cells: &["hex8", "hex8 mixed", "hex20", "hex20 reduced", "hex20 mixed", "hex27 mixed", "tet10", "tet10 mixed"],
    meshes: &[2, 4, 8, 16],
    steps: &[10, 20, 40, 80],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-4, 1e-6, 1e-9],
    claims: &[Claim { line: "mesh", quantity: "widening of the bore", at_least: 1.0 }],
    quick: 3,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let (sin, cos) = 2.0_f64.to_radians().sin_cos();
    let [a, b] = RADII;
    let face = |z: f64| {
        format!(
            "[{a:?}, 0, {z:?}], [{b:?}, 0, {z:?}], [{:?}, {:?}, {z:?}], [{:?}, {:?}, {z:?}]",
            b * cos,
            b * sin,
            a * cos,
            a * sin
        )
    };
    // `displacement` is what hex8 without averages is called: without a key a material that yields has averages.
    let form = if choice.cell.contains("mixed") { "" } else { "volumetric = \"displacement\"\n" };
    Ok(format!(
        "{}[[body]]\nname = \"tube\"\n{}{form}mesh = {{ generator = \"hexahedron\", corners = [{}, {}], divisions = [{}, 1, 1] }}\n\
         material = {{ law = \"hencky\", young = {YOUNG:?}, poisson = 0.4999, plasticity = {{ yield_stress = {YIELD:?} }} }}\n\
         [[prescribe]]\nset = \"tube.front\"\ncomponents = [\"y\"]\nfixed = true\n\
         [[prescribe]]\nset = \"tube.back\"\nnormal = [{:?}, {cos:?}, 0]\nfixed = true\n\
         [[prescribe]]\nset = \"tube.all\"\ncomponents = [\"z\"]\nfixed = true\n\
         [[load]]\nset = \"tube.left\"\npressure = {{ table = [[0.0, 0.0], [1.0, {PRESSURE:?}]] }}\n\
         [[probe]]\nname = \"bore\"\nquantity = \"displacement\"\nbody = \"tube\"\npoint = [{a:?}, 0, 0]\n",
        choice.head("Tube that yields", 1.0),
        choice.cell_keys(),
        face(0.0),
        face(5.0),
        choice.mesh,
        -sin,
    ))
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    let probes = run.table("probes.csv")?;
    let (time, moved) = (probes.column("time")?, probes.column("bore.x")?);
    let at = |t: f64| -> Outcome<f64> {
        let row = time.iter().position(|time| (time - t).abs() < 1e-9).ok_or_else(|| format!("no step ends at {t}"))?;
        Ok(moved[row])
    };
    Ok(vec![AT.into_iter().map(at).collect::<Outcome<_>>()?])
}

/// With the radius `c` of the zone that flows: `p = 2 Y/sqrt(3) (ln(c/a) + (1 - (c/b)^2)/2)`, and `u = sqrt(3) Y c^2 / (2 E a)`; elastic `p = 2 G u/a (1 - (a/b)^2)`, `G = E/3`.
fn hill(_: &Run, _: &Choice) -> Outcome<Values> {
    let [a, b] = RADII;
    let pressure = |c: f64| 2.0 * YIELD / 3.0_f64.sqrt() * ((c / a).ln() + 0.5 * (1.0 - (c / b).powi(2)));
    let widening = |p: f64| {
        if p < pressure(a) {
            return p * a / (2.0 / 3.0 * YOUNG * (1.0 - (a / b).powi(2)));
        }
        // The pressure grows with the zone.
        let (mut low, mut high) = (a, b);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if pressure(middle) < p { low = middle } else { high = middle }
        }
        3.0_f64.sqrt() * YIELD * low * low / (2.0 * YOUNG * a)
    };
    Ok(vec![AT.into_iter().map(|share| widening(share * PRESSURE)).collect()])
}
