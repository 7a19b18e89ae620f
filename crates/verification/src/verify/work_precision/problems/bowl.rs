//! A slider with a round bottom that slides in a hollow ball; both are free.

use crate::verify::Run;
use crate::verify::work_precision::campaign::{Choice, Problem, Reference, Values, no_files};
use crate::workspace::Outcome;

const BEST: Choice = Choice::direct("energy-momentum", "mortar", "hex8", 4, 40);

/// See the module.
pub const PROBLEM: Problem = Problem {
    name: "bowl",
    title: "Slider in a bowl",
    about: "A slider 0.8 x 0.8 x 0.4 with a round bottom of radius 0.97 falls into a free hollow ball of radii 1 and 1.3 (neo-Hooke, Young's modulus 200, Poisson's ratio 0.3, density 1 of both) with the velocity (1, 0, -0.1) and slides in it until the time 0.8; \
            `mesh` elements along the slider. Hard: sliding over curved facets, and impacts of single nodes. Without friction the energy of both, and their momenta, are what they were.",
    quantities: &["energy", "angular momentum"],
    reference: Reference::Closed { source: "conservation: the values at the start", values: at_start },
    scene,
    files: no_files,
    measure,
    best: BEST,
    schemes: &["energy-momentum", "midpoint", "backward-euler", "generalised-alpha"],
    methods: &["nts", "mortar", "general"],
    cells: &["hex8"],
    meshes: &[2, 3, 4, 6],
    steps: &[10, 20, 40, 80],
    solvers: &["direct", "iterative"],
    tolerances: &[1e-6, 1e-9],
    claims: &[],
    quick: 2,
};

fn scene(choice: &Choice) -> Outcome<String> {
    let n = choice.mesh;
    let material = "material = { law = \"neo-hooke\", young = 200.0, poisson = 0.3 }\ndensity = 1.0\n";
    let cell = choice.cell_keys();
    let text = format!(
        "{}[[body]]\nname = \"slider\"\n{cell}{material}position = [0, 0, -0.975]\nvelocity = [1, 0, -0.1]\n\
         mesh = {{ generator = \"indenter\", size = [0.8, 0.8], height = 0.4, radius = 0.97, divisions = [{n}, {n}, {}] }}\n\
         [[body]]\nname = \"bowl\"\n{cell}{material}mesh = {{ generator = \"hollow-ball\", inner_diameter = 2.0, outer_diameter = 2.6, divisions = [{}, 1] }}\n",
        choice.head("Bowl", 0.8),
        n.div_ceil(2),
        n + 1
    );
    Ok(text + &choice.contact("slider.bottom", "bowl.inner", "")?)
}

/// Energy and angular momentum in a row of `balance.csv`.
fn row(run: &Run, pick: fn(usize) -> usize) -> Outcome<Values> {
    let balance = run.balance()?;
    let row = pick(balance.total.len());
    Ok(vec![vec![balance.total[row]], balance.angular[row].to_vec()])
}

fn measure(run: &Run, _: &Choice) -> Outcome<Values> {
    row(run, |rows| rows - 1)
}

fn at_start(run: &Run, _: &Choice) -> Outcome<Values> {
    row(run, |_| 0)
}
