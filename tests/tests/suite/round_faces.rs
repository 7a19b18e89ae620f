//! Mortar contact and ties of curved quadratic faces: Lame's tubes, the natural state, turned bodies.

use crate::support::{drift, simulation, simulation_in};
use std::fmt::Write as _;
use stoss::solver::Simulation;

const YOUNG: f64 = 210_000.0;
const POISSON: f64 = 0.3;

fn run(simulation: &mut Simulation) {
    while !simulation.finished() {
        simulation.advance().unwrap_or_else(|e| panic!("{e}"));
    }
}

/// A quarter of a tube of C3D20 with all nodes on circles, for an Abaqus file, with surfaces of its sides; nodes and elements are counted on from `first`.
fn tube(text: &mut String, name: &str, radii: [f64; 2], around: usize, first: &mut [usize; 2]) {
    const RADIAL: usize = 4;
    let at = |i: usize, j: usize, k: usize| (i * (2 * around + 1) + j) * 3 + k;
    let number = |i, j, k| first[0] + 1 + at(i, j, k);
    text.push_str("*NODE\n");
    for (i, j, k) in (0..=2 * RADIAL).flat_map(|i| (0..=2 * around).flat_map(move |j| (0..3).map(move |k| (i, j, k)))) {
        if [i, j, k].iter().filter(|n| *n % 2 == 1).count() > 1 {
            continue;
        }
        let r = radii[0] + (radii[1] - radii[0]) * i as f64 / (2 * RADIAL) as f64;
        let (s, c) = (std::f64::consts::FRAC_PI_2 * j as f64 / (2 * around) as f64).sin_cos();
        let c = if j == 2 * around { 0.0 } else { c };
        writeln!(text, "{}, {:?}, {:?}, {:?}", number(i, j, k), r * c, r * s, 2.5 * k as f64).unwrap();
    }
    writeln!(text, "*ELEMENT, TYPE=C3D20, ELSET={name}").unwrap();
    let corners = [[0, 0], [2, 0], [2, 2], [0, 2]];
    let edges = [[1, 0], [2, 1], [1, 2], [0, 1]];
    for (i, j) in (0..RADIAL).flat_map(|i| (0..around).map(move |j| (i, j))) {
        let node = |[a, b]: [usize; 2], k: usize| number(2 * i + a, 2 * j + b, k).to_string();
        let layers = [(corners, 0), (corners, 2), (edges, 0), (edges, 2), (corners, 1)];
        let nodes: Vec<String> = layers.iter().flat_map(|(places, k)| places.map(|p| node(p, *k))).collect();
        let element = first[1] + 1 + i * around + j;
        writeln!(text, "{element}, {},\n{}", nodes[..10].join(", "), nodes[10..].join(", ")).unwrap();
    }
    let mut side = |side: &str, face: &str, of: &dyn Fn(usize, usize) -> bool| {
        writeln!(text, "*SURFACE, NAME={name}_{side}, TYPE=ELEMENT").unwrap();
        for (i, j) in (0..RADIAL).flat_map(|i| (0..around).map(move |j| (i, j))).filter(|&(i, j)| of(i, j)) {
            writeln!(text, "{}, {face}", first[1] + 1 + i * around + j).unwrap();
        }
    };
    side("inner", "S6", &|i, _| i == 0);
    side("outer", "S4", &|i, _| i == RADIAL - 1);
    side("t0", "S3", &|_, j| j == 0);
    side("t1", "S5", &|_, j| j == around - 1);
    side("z0", "S1", &|_, _| true);
    side("z1", "S2", &|_, _| true);
    first[0] += at(2 * RADIAL, 2 * around, 2) + 1;
    first[1] += RADIAL * around;
}

/// Two quarters of tubes in plane strain, `in` from 10 to 20 and an overlap, `out` from 20 to 30, with elements around; `between` them a contact or a tie.
fn tubes(around: [usize; 2], overlap: f64, cells: [&str; 2], between: &str) -> Simulation {
    let (text, folder) = tubes_scene(around, overlap, cells, between);
    simulation_in(&text, folder.path())
}

/// The scene of the tubes, with the mesh in a folder.
fn tubes_scene(around: [usize; 2], overlap: f64, cells: [&str; 2], between: &str) -> (String, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let (mut mesh, mut first) = (String::new(), [0, 0]);
    tube(&mut mesh, "in", [10.0, 20.0 + overlap], around[0], &mut first);
    tube(&mut mesh, "out", [20.0, 30.0], around[1], &mut first);
    std::fs::write(folder.path().join("tubes.inp"), mesh).unwrap();
    let mut text = "[scene]\ntitle = \"tubes\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n".to_owned();
    for (name, cell) in ["in", "out"].into_iter().zip(cells) {
        let cell = if cell.is_empty() { String::new() } else { format!("cell = \"{cell}\"\n") };
        writeln!(
            text,
            "[[body]]\nname = \"{name}\"\nmesh = {{ file = \"tubes.inp\", group = \"{name}\" }}\n{cell}\
             material = {{ law = \"saint-venant-kirchhoff\", young = {YOUNG:?}, poisson = {POISSON} }}"
        )
        .unwrap();
        for (side, axis) in [("t0", "y"), ("t1", "x"), ("z0", "z"), ("z1", "z")] {
            writeln!(text, "[[prescribe]]\nset = \"{name}.{name}_{side}\"\ncomponents = [\"{axis}\"]\nfixed = true")
                .unwrap();
        }
    }
    text.push_str(between);
    (text, folder)
}

/// Radial displacement at (30, 0, 0).
fn outside(simulation: &Simulation) -> f64 {
    let x = &simulation.model().reference;
    let node =
        (0..x.len() / 3).find(|&n| (x[3 * n] - 30.0).abs() < 1e-9 && x[3 * n + 1].abs() < 1e-9 && x[3 * n + 2] == 0.0);
    let node = node.unwrap();
    simulation.state().q[3 * node] - x[3 * node]
}

fn contact(slave: &str, master: &str, more: &str) -> String {
    format!("[[contact]]\nmethod = \"mortar\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{more}")
}

const OVERLAP: f64 = 0.0025;

/// Lame in plane strain: the pressure that an overlap of two tubes 10-20-30 of one material makes, and what it moves the outside by.
fn press_fit() -> f64 {
    let (e, nu) = (YOUNG / (1.0 - POISSON * POISSON), POISSON / (1.0 - POISSON));
    let (a, b, c) = (10.0_f64, 20.0_f64, 30.0_f64);
    let yields = (c * c + b * b) / (c * c - b * b) + nu + (b * b + a * a) / (b * b - a * a) - nu;
    let pressure = OVERLAP * e / (b * yields);
    2.0 * pressure * b * b * c / (e * (c * c - b * b))
}

/// By how much the overlap of meshes with these elements around is larger than that of the circles through their nodes, in the mean. A quadratic arc of half the angle h has r^2 = R^2 (1 - (1 - cos h)^2 t^2 (1 - t^2)),
/// its mean radius is too small by R (1 - cos h)^2 / 15.
fn overlap_of_arcs(around: [usize; 2]) -> f64 {
    let [inside, outside] =
        around.map(|n| 20.0 * (1.0 - (std::f64::consts::FRAC_PI_4 / n as f64).cos()).powi(2) / 15.0);
    outside - inside
}

#[test]
fn a_press_fit_of_quadratic_cells_is_that_of_lame() {
    // What the arcs overlap by themselves is 0.26 %; another program (CalculiX 2.20) is 0.54 % off on these meshes.
    let [fine, coarse] = [("in.in_outer", "out.out_inner"), ("out.out_inner", "in.in_outer")];
    let exact = |around| press_fit() * (1.0 + overlap_of_arcs(around) / OVERLAP);
    for ((slave, master), multipliers) in [(fine, "standard"), (fine, "dual"), (coarse, "standard"), (coarse, "dual")] {
        let between = contact(slave, master, &format!("multipliers = \"{multipliers}\"\n"));
        let mut simulation = tubes([12, 10], OVERLAP, [""; 2], &between);
        run(&mut simulation);
        let error = outside(&simulation) / exact([12, 10]) - 1.0;
        assert!(error.abs() < 3e-3, "{slave} {multipliers}: {error}");
    }
    // It falls with the mesh.
    let mut fine = tubes([24, 20], OVERLAP, [""; 2], &contact("in.in_outer", "out.out_inner", ""));
    run(&mut fine);
    let error = outside(&fine) / press_fit() - 1.0;
    assert!(error.abs() < 5e-4, "{error}");
}

/// Least and largest pressure that frames show, and the largest one of the equations.
fn shown(simulation: &Simulation) -> [f64; 3] {
    let (reports, pressures) = (simulation.contact_report(0).unwrap(), &simulation.pressures()[0]);
    let x = &simulation.model().reference;
    let of_body = |node: u32| !simulation.model().traces.contains_key(&node) && x.len() > 3 * node as usize;
    let mut out = [f64::INFINITY, 0.0, 0.0];
    for (slot, report) in reports.iter().enumerate().filter(|(_, report)| of_body(report.node)) {
        let value = report.shown(slot, |slot| pressures[slot]);
        out = [out[0].min(value), out[1].max(value), out[2].max(pressures[slot])];
    }
    out
}

/// Lame's pressure is the same everywhere.
#[test]
fn the_pressure_of_a_press_fit_is_that_of_lame() {
    let e = YOUNG / (1.0 - POISSON * POISSON);
    let exact = press_fit() * e * 500.0 / (2.0 * 400.0 * 30.0);
    let [fine, coarse] = [("in.in_outer", "out.out_inner"), ("out.out_inner", "in.in_outer")];
    for (around, (slave, master), multipliers, bound) in [
        ([12, 10], fine, "standard", 0.03),
        ([12, 10], fine, "dual", 0.03),
        ([12, 10], coarse, "standard", 0.03),
        ([24, 20], fine, "standard", 0.005),
        ([24, 20], fine, "dual", 0.005),
    ] {
        let more = format!("multipliers = \"{multipliers}\"\n");
        let mut simulation = tubes(around, OVERLAP, [""; 2], &contact(slave, master, &more));
        let mut record = None;
        while !simulation.finished() {
            record = simulation.advance().unwrap_or_else(|e| panic!("{e}")).contact;
        }
        let [least, largest, raw] = shown(&simulation).map(|p| p / exact - 1.0);
        let told = record.unwrap().max_pressure / exact - 1.0;
        assert!(
            least > -bound && largest < bound && told < bound,
            "{around:?} {slave} {multipliers}: {least} to {largest}, told {told}, {raw} in the equations"
        );
    }
}

/// A block that is pressed flat on a larger floor, the floor as slave: facets and faces are partly covered, the pressure is uniform. Exact by equilibrium, for the floor is rigid to 1e-6.
#[test]
fn the_pressure_on_partly_covered_faces_is_uniform() {
    for (cell, multipliers) in ["hex20", "hex27", "tet10"].into_iter().flat_map(|c| [(c, "standard"), (c, "dual")]) {
        let body = |name: &str, place: &str, young: &str| {
            format!(
                "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", {place} }}\ncell = \"{cell}\"\n\
                 material = {{ law = \"saint-venant-kirchhoff\", young = {young}, poisson = 0.0 }}\n"
            )
        };
        let mut text = "[scene]\ntitle = \"rim\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n".to_owned();
        text += &body("block", "min = [0.37, 0.37, 1], max = [2.67, 2.67, 2], divisions = [3, 4, 2]", "1e3");
        text += &body("floor", "min = [0, 0, 0], max = [4, 4, 1], divisions = [4, 4, 1]", "1e9");
        for (set, components, table) in [
            ("floor.bottom", "[\"x\", \"y\", \"z\"]", "fixed = true"),
            ("block.top", "[\"x\", \"y\"]", "fixed = true"),
            ("block.top", "[\"z\"]", "displacement = { table = [[0.0, 0.0], [1.0, -0.001]] }"),
        ] {
            writeln!(text, "[[prescribe]]\nset = \"{set}\"\ncomponents = {components}\n{table}").unwrap();
        }
        text += &contact("floor.top", "block.bottom", &format!("multipliers = \"{multipliers}\"\n"));
        let mut simulation = simulation(&text);
        run(&mut simulation);
        // Saint Venant-Kirchhoff: F S with F = 0.999 and S = E (F^2 - 1)/2.
        let exact = 1e3 * 0.999 * (1.0 - 0.999_f64.powi(2)) / 2.0;
        let (reports, pressures) = (simulation.contact_report(0).unwrap(), &simulation.pressures()[0]);
        for (slot, report) in reports.iter().enumerate().filter(|(slot, _)| simulation.active()[0][*slot]) {
            let error = report.shown(slot, |slot| pressures[slot]) / exact - 1.0;
            assert!(error.abs() < 1e-4, "{cell} {multipliers} {}: {error:e}", report.node);
        }
    }
}

/// The press fit of parts that fit exactly, by an interference; in time it grows in proportion to it.
#[test]
fn an_interference_is_the_press_fit_of_lame() {
    for multipliers in ["standard", "dual"] {
        let fit = |more: &str, overlap: f64| {
            let more = format!("multipliers = \"{multipliers}\"\n{more}");
            let mut simulation = tubes([12, 10], overlap, [""; 2], &contact("in.in_outer", "out.out_inner", &more));
            run(&mut simulation);
            outside(&simulation)
        };
        let by_number = fit("interference = 0.0025\n", 0.0);
        let by_meshes = fit("", OVERLAP);
        let in_time = fit("interference = { table = [[0.0, 0.0], [4.0, 0.01]] }\n", 0.0);
        // What the facets of both meshes overlap by themselves is no part of it.
        let kept = fit("overlap = \"keep\"\ninterference = 0.0025\n", 0.0);
        let of_arcs = overlap_of_arcs([12, 10]) / OVERLAP;
        for (found, of_arcs) in [(by_number, of_arcs), (by_meshes, of_arcs), (in_time, of_arcs), (kept, 0.0)] {
            let error = found / (press_fit() * (1.0 + of_arcs)) - 1.0;
            assert!(error.abs() < 3e-3, "{multipliers}: {error}");
        }
        assert!((by_number / by_meshes - 1.0).abs() < 3e-4 && by_number == in_time, "{by_number} {by_meshes}");
    }
}

/// A ramp of the overlap: in proportion to time, and the end is that of the sudden one.
#[test]
fn a_ramp_closes_an_overlap_in_proportion_to_time() {
    let stages = "[[stage]]\nname = \"a\"\nkind = \"quasi-static\"\nuntil = 1.0\nstep = 0.25\n";
    let fit = |more: &str| tubes([12, 10], OVERLAP, [""; 2], &(contact("in.in_outer", "out.out_inner", more) + stages));
    let mut sudden = fit("");
    run(&mut sudden);
    let mut ramp = fit("overlap = \"ramp\"\n");
    for step in 1..=4 {
        ramp.advance().unwrap();
        let part = outside(&ramp) / outside(&sudden);
        assert!((part - 0.25 * f64::from(step)).abs() < 1e-3, "{step}: {part}");
    }
    assert!((outside(&ramp) / outside(&sudden) - 1.0).abs() < 1e-9);
}

/// Round parts that fit exactly, whose meshes overlap here and there, have no stress with `keep`.
#[test]
fn parts_that_fit_have_no_stress_if_overlaps_are_kept() {
    for multipliers in ["standard", "dual"] {
        let more = format!("multipliers = \"{multipliers}\"\noverlap = \"keep\"\n");
        let mut simulation = tubes([12, 10], 0.0, [""; 2], &contact("in.in_outer", "out.out_inner", &more));
        run(&mut simulation);
        let moved = simulation.state().q.iter().zip(&simulation.model().reference).map(|(q, x)| (q - x).abs());
        // Of round-off of 30.
        assert!(moved.fold(0.0, f64::max) < 1e-12 && stress(&simulation) < 1e-8);
    }
}

/// Vertices of `nts` on quadratic faces lie beside them: the fit would be that of the arches of meshes that do not match.
#[test]
fn node_to_surface_fits_of_quadratic_faces_are_refused_where_arches_count() {
    let refused = |around: [usize; 2], overlap: f64, more: &str| {
        let between = contact("in.in_outer", "out.out_inner", more).replace("mortar", "nts");
        let (text, folder) = tubes_scene(around, overlap, [""; 2], &between);
        let scene = stoss::scene::parse(&text, "tubes.toml").unwrap_or_else(|e| panic!("{e}"));
        stoss::build::build(&scene, folder.path()).err().map(|e| e.to_string())
    };
    for (overlap, more) in [(OVERLAP, ""), (0.0, "interference = 0.0025\n"), (0.0, "")] {
        let told = refused([12, 10], overlap, more).unwrap_or_default();
        assert!(told.contains("a third of the height of their arches"), "{overlap} {more}{told}");
    }
    assert_eq!(refused([12, 12], OVERLAP, ""), None);
    assert_eq!(refused([12, 10], 0.0, "overlap = \"keep\"\n"), None);
}

/// A pressure inside, through tied rings of meshes that do not match: Lame's thick tube.
#[test]
fn tied_rings_are_a_thick_tube() {
    for (slave, master) in [("in.in_outer", "out.out_inner"), ("out.out_inner", "in.in_outer")] {
        let tie = format!(
            "[[tie]]\nslave = \"{slave}\"\nmaster = \"{master}\"\n[[load]]\nset = \"in.in_inner\"\npressure = 2.0\n"
        );
        let mut simulation = tubes([8, 5], 0.0, [""; 2], &tie);
        run(&mut simulation);
        let exact = 2.0 * 2.0 * 100.0 * 30.0 * (1.0 - POISSON * POISSON) / (YOUNG * 800.0);
        let error = outside(&simulation) / exact - 1.0;
        assert!(error.abs() < 5e-3, "{slave}: {error}");
    }
}

/// Largest component of stress at a Gauss point.
fn stress(simulation: &Simulation) -> f64 {
    let q = &simulation.state().q;
    let bodies = simulation.model().bodies.iter();
    let points = bodies.flat_map(|body| body.solid.gauss_point_state(q).unwrap().into_iter().flatten());
    points.flat_map(|point| point.cauchy).fold(0.0, |most: f64, s| most.max(s.abs()))
}

/// Two hollow balls, one in the other, tied at a radius of 0.75 with meshes that do not match; the outside is turned by an angle.
fn balls(cell: &str, degrees: f64, steps: u32, tie: &str) -> Simulation {
    let ball = |name: &str, diameters: [f64; 2], n: u32| {
        format!(
            "[[body]]\nname = \"{name}\"\ncell = \"{cell}\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             mesh = {{ generator = \"hollow-ball\", inner_diameter = {:?}, outer_diameter = {:?}, divisions = [{n}, 1] }}\n",
            diameters[0], diameters[1]
        )
    };
    let step = 1.0 / f64::from(steps);
    let mut simulation = simulation(&format!(
        "[scene]\ntitle = \"balls\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = {step:?}\n{}{}\
         [[prescribe]]\nset = \"outer.outer\"\n\
         rotation = {{ axis = [1.0, 2.0, 2.0], about = [0.0, 0.0, 0.0], degrees = {{ table = [[0.0, 0.0], [1.0, {degrees:?}]] }} }}\n\
         [[tie]]\nslave = \"outer.inner\"\nmaster = \"inner.outer\"\n{tie}",
        ball("inner", [1.0, 1.5], 3),
        ball("outer", [1.5, 2.0], 4)
    ));
    run(&mut simulation);
    simulation
}

/// The natural state of a tied round interface, whatever its cells: with Young's modulus 1000 nothing is stressed.
#[test]
fn tied_round_bodies_have_no_stress_without_load() {
    for cell in ["hex20", "hex27", "tet10", "wedge15"] {
        for multipliers in ["standard", "dual"] {
            let at_rest = stress(&balls(cell, 0.0, 1, &format!("multipliers = \"{multipliers}\"\n")));
            assert!(at_rest < 1e-6, "{cell} {multipliers}: {at_rest:e}");
        }
    }
}

/// Nor is it after a turn by a right angle.
#[test]
fn a_turned_tied_interface_has_no_stress() {
    for form in ["constant", "frame-invariant"] {
        let turned = stress(&balls("hex20", 90.0, 6, &format!("form = \"{form}\"\n")));
        assert!(turned < 1e-6, "{form}: {turned:e}");
    }
}

/// Two round bodies of quadratic cells hit obliquely, with friction and without, weights that move or are held, deformable or rigid: momenta and ledger.
#[test]
fn round_quadratic_bodies_hit_without_drift() {
    let friction = "friction = { law = \"coulomb\", mu = 0.3 }\n";
    let frozen = format!("integrals = \"frozen\"\n{friction}");
    let ball = "mesh = { generator = \"ball\", radius = 0.5, divisions = [1, 1, 1] }\ncell = \"hex20\"\n\
                material = { law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }\ndensity = 1.0\n";
    let turned = "rotation = { axis = [1.0, 1.0, 0.0], degrees = 20.0 }\n";
    let soft = format!("[[body]]\nname = \"b\"\n{ball}{turned}");
    let hard = "[[rigid]]\nname = \"b\"\nshape = { kind = \"sphere\", radius = 0.5, divisions = 6 }\ndensity = 1.0\n";
    for (second, more) in [(&soft[..], ""), (&soft[..], friction), (&soft[..], &frozen[..]), (hard, friction)] {
        let text = format!(
            "[scene]\ntitle = \"balls\"\nkind = \"dynamic\"\n[time]\nend = 0.5\nstep = 0.02\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
             [[body]]\nname = \"a\"\n{ball}velocity = [-0.2, -0.1, -1.0]\nposition = [0.22, 0.15, 1.0]\n{second}{}",
            contact("a.boundary", if second == hard { "b.all" } else { "b.boundary" }, more)
        );
        let mut simulation = simulation(&text);
        let start = *simulation.balance();
        let (mut linear, mut angular) = (vec![start.linear_momentum], vec![start.angular_momentum]);
        let mut touched = false;
        while !simulation.finished() {
            let record = simulation.advance().unwrap_or_else(|e| panic!("{second} {more}: {e}"));
            linear.push(record.balance.linear_momentum);
            angular.push(record.balance.angular_momentum);
            touched |= simulation.active().iter().flatten().any(|active| *active);
        }
        assert!(touched, "{second} {more}");
        let (linear, angular) = (drift(&linear), drift(&angular));
        assert!(linear < 1e-11 && angular < 1e-10, "{second} {more}: {linear:e} {angular:e}");
        let end = simulation.balance();
        let change = (end.total() + end.closing_loss + end.impact_loss) / start.total() - 1.0;
        assert!(change.abs() < 1e-10, "{second} {more}: {change:e}");
    }
}
