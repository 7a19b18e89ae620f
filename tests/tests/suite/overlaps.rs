//! Overlaps and interference of contact pairs: what closed slots keep in place of zero.

use crate::support::simulation;
use std::path::Path;
use stoss::build::build;
use stoss::solver::Simulation;

const METHODS: [&str; 4] = [
    "method = \"nts\"\n",
    "method = \"cat\"\n",
    "method = \"mortar\"\nmultipliers = \"standard\"\n",
    "method = \"mortar\"\nmultipliers = \"dual\"\n",
];

/// Two blocks one upon the other, held below and above, that overlap; the lower one is the slave, and wider.
fn blocks(overlap: f64, steps: u32, contact: &str) -> Simulation {
    layered(overlap, 2, steps, contact)
}

/// Two such blocks with so many layers of elements in each.
fn layered(overlap: f64, layers: u32, steps: u32, contact: &str) -> Simulation {
    let step = 1.0 / f64::from(steps);
    simulation(&format!(
        "[scene]\ntitle = \"blocks\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = {step:?}\n\
         [[body]]\nname = \"low\"\nmesh = {{ generator = \"block\", min = [-0.5, -0.5, {:?}], max = [1.5, 1.5, {overlap:?}], divisions = [3, 4, {layers}] }}\n\
         material = {{ law = \"saint-venant-kirchhoff\", young = 1000.0, poisson = 0.3 }}\n\
         [[body]]\nname = \"up\"\nmesh = {{ generator = \"block\", min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0], divisions = [3, 3, {layers}] }}\n\
         material = {{ law = \"saint-venant-kirchhoff\", young = 1000.0, poisson = 0.3 }}\n\
         [[prescribe]]\nset = \"low.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n[[prescribe]]\nset = \"up.top\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
         [[contact]]\nslave = \"up.bottom\"\nmaster = \"low.top\"\n{contact}",
        overlap - 1.0
    ))
}

fn run(simulation: &mut Simulation) {
    while !simulation.finished() {
        simulation.advance().unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Force of the contact on the upper block.
fn force(simulation: &Simulation) -> [f64; 3] {
    let up = simulation.model().bodies[1].nodes.clone();
    let mut sum = [0.0; 3];
    for node in up {
        (0..3).for_each(|i| sum[i] += simulation.contact_force()[3 * node as usize + i]);
    }
    sum
}

/// An overlap, the same interference, and both in time have one end.
#[test]
fn overlap_and_interference_end_alike() {
    for method in METHODS {
        let of = |overlap: f64, steps: u32, more: &str| {
            let mut simulation = blocks(overlap, steps, &format!("{method}{more}"));
            run(&mut simulation);
            force(&simulation)[2]
        };
        let sudden = of(0.002, 1, "");
        assert!(sudden > 0.5, "{method}{sudden}");
        for (found, bound) in [
            (of(0.0, 1, "interference = 0.002\n"), 1e-3),
            (of(0.0, 4, "interference = { table = [[0.0, 0.0], [1.0, 0.002]] }\n"), 1e-3),
            (of(0.002, 4, "overlap = \"ramp\"\n"), 1e-6),
            (of(0.001, 2, "interference = 0.001\n"), 1e-3),
            (of(0.004, 2, "overlap = \"keep\"\ninterference = 0.002\n"), 1e-3),
        ] {
            // With `nts` nodes on edges of the master go from facet to facet on the way.
            let bound = if method.contains("mortar") { bound } else { f64::max(bound, 1e-4) };
            assert!((found / sudden - 1.0).abs() < bound, "{method}{found} {sudden}");
        }
        let kept = of(0.002, 1, "overlap = \"keep\"\n");
        assert!(kept.abs() < 1e-12, "{method}{kept}");
    }
}

/// Half of the way of a ramp, and of a table.
#[test]
fn forces_are_in_proportion_to_time() {
    for method in METHODS {
        for (overlap, more) in
            [(0.002, "overlap = \"ramp\"\n"), (0.0, "interference = { table = [[0.0, 0.0], [1.0, 0.002]] }\n")]
        {
            let mut simulation = blocks(overlap, 2, &format!("{method}{more}"));
            simulation.advance().unwrap();
            let half = force(&simulation)[2];
            simulation.advance().unwrap();
            let ratio = half / force(&simulation)[2];
            assert!((ratio - 0.5).abs() < 2e-3, "{method}{more}{ratio}");
        }
    }
}

/// Reports have the true gap, and the gap that is kept.
#[test]
fn reports_know_what_is_kept() {
    for method in METHODS {
        let mut simulation = blocks(0.0, 1, &format!("{method}interference = 0.002\n"));
        run(&mut simulation);
        let active = simulation.active()[0].clone();
        let reports = simulation.contact_report(0).unwrap();
        let closed: Vec<_> = reports.iter().zip(active).filter(|(_, active)| *active).collect();
        assert!(closed.len() > 3, "{method}");
        for (report, _) in closed {
            assert_eq!(report.reference_gap, 0.002, "{method}");
            // With `nts` the row has the gap to the extension of a facet.
            let bound = if method.contains("mortar") { 1e-12 } else { 1e-6 };
            assert!((report.gap.unwrap() - 0.002).abs() < bound, "{method}{:?}", report.gap);
        }
    }
}

/// An overlap of four layers of elements: at once they would be turned inside out.
#[test]
fn an_overlap_that_cannot_close_at_once_closes_in_time() {
    for method in [METHODS[0], METHODS[2]] {
        let mut sudden = layered(0.3, 20, 4, &format!("{method}overlap = \"sudden\"\n"));
        assert!(sudden.advance().is_err(), "{method}");
        let mut simulation = layered(0.3, 20, 4, method);
        let record = simulation.advance().unwrap();
        let says = |decision: &&stoss::solver::Decision| decision.reason.contains("closed in proportion to time");
        let note = record.decisions.iter().find(says).unwrap();
        assert!(note.reason.contains(": 16 slave nodes overlap by up to 3.000e-1"), "{}", note.reason);
        run(&mut simulation);
        let reports = simulation.contact_report(0).unwrap();
        let closed = reports.iter().zip(&simulation.active()[0]).filter(|(_, active)| **active);
        let gaps: Vec<f64> = closed.map(|(report, _)| report.gap.unwrap()).collect();
        assert!(gaps.len() > 8 && gaps.iter().all(|gap| gap.abs() < 1e-9), "{method}{gaps:?}");
    }
}

/// A run goes on from a checkpoint with the same bits: overlaps of the start are in it.
#[test]
fn a_ramp_goes_on_with_the_same_bits() {
    for method in METHODS {
        let friction = "friction = { law = \"coulomb\", mu = 0.1 }\nclosing_friction = \"grows\"\n";
        let scene =
            format!("{method}overlap = \"ramp\"\ninterference = {{ table = [[0.0, 0.0], [2.0, 0.001]] }}\n{friction}");
        let (mut straight, mut resumed) = (blocks(0.002, 4, &scene), blocks(0.002, 4, &scene));
        (0..2).for_each(|_| drop(straight.advance().unwrap()));
        resumed.restore(straight.checkpoint("t", Default::default()), "t").unwrap();
        let reports = |simulation: &Simulation| simulation.contact_report(0).unwrap();
        assert_eq!(reports(&straight)[4].reference_gap, reports(&resumed)[4].reference_gap, "{method}");
        while !straight.finished() {
            straight.advance().unwrap();
            resumed.advance().unwrap();
        }
        assert!(straight.state().q == resumed.state().q && straight.balance() == resumed.balance(), "{method}");
    }
}

/// What closes without friction ends as a contact without friction does; with friction it does not, and a growing one is between.
#[test]
fn friction_while_surfaces_close() {
    // Pressed blocks of different width spread by different amounts, so that friction does work.
    let energy = |more: &str| {
        let mut simulation =
            blocks(0.002, 4, &format!("method = \"mortar\"\nmultipliers = \"dual\"\noverlap = \"ramp\"\n{more}"));
        run(&mut simulation);
        simulation.balance().strain
    };
    let law = "friction = { law = \"coulomb\", mu = 0.2 }\n";
    let free = energy("");
    let [none, grows, full] =
        ["none", "grows", "full"].map(|closing| energy(&format!("{law}closing_friction = \"{closing}\"\n")));
    assert!((none / free - 1.0).abs() < 1e-7, "{none} {free}");
    assert!(grows > free * 1.0001 && full > grows, "{free} {grows} {full}");
}

/// Pressed by an interference in statics, two blocks are let go in dynamics: the gap that they keep is constant, so that energy and momenta are as exact as those of surfaces that touch.
#[test]
fn what_is_kept_in_dynamics_does_no_work() {
    for method in [METHODS[0], METHODS[2], METHODS[3]] {
        for (overlap, keeps) in [(0.0, "interference = 0.01\n"), (0.01, "overlap = \"keep\"\n")] {
            let pushed = if overlap > 0.0 {
                "[[prescribe]]\nname = \"push\"\nset = \"up.top\"\ncomponents = [\"z\"]\ndisplacement = { table = [[0.0, 0.0], [1.0, -0.01]] }\n"
            } else {
                ""
            };
            let z = if overlap > 0.0 {
                ""
            } else {
                "[[prescribe]]\nname = \"push\"\nset = \"up.top\"\ncomponents = [\"z\"]\nfixed = true\n"
            };
            let text = format!(
                "[scene]\ntitle = \"let go\"\nkind = \"dynamic\"\n[time]\nend = 1.3\nstep = 1.0\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
                 [[body]]\nname = \"low\"\nmesh = {{ generator = \"block\", min = [-0.5, -0.5, -1.0], max = [1.5, 1.5, {overlap:?}], divisions = [3, 4, 2] }}\n\
                 material = {{ law = \"saint-venant-kirchhoff\", young = 1000.0, poisson = 0.3 }}\ndensity = 1.0\n\
                 [[body]]\nname = \"up\"\nmesh = {{ generator = \"block\", min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0], divisions = [3, 3, 2] }}\n\
                 material = {{ law = \"saint-venant-kirchhoff\", young = 1000.0, poisson = 0.3 }}\ndensity = 1.0\n\
                 [[prescribe]]\nname = \"low\"\nset = \"low.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
                 [[prescribe]]\nname = \"side\"\nset = \"up.top\"\ncomponents = [\"x\", \"y\"]\nfixed = true\n{z}{pushed}\
                 [[stage]]\nname = \"press\"\nkind = \"quasi-static\"\nuntil = 1.0\n\
                 [[stage]]\nname = \"fly\"\nkind = \"dynamic\"\nuntil = 1.3\nstep = 0.005\noff = [\"push\", \"side\", \"low\"]\n\
                 [[contact]]\nslave = \"up.bottom\"\nmaster = \"low.top\"\n{method}{keeps}"
            );
            let scene = stoss::scene::parse(&text, "let-go.toml").unwrap_or_else(|e| panic!("{e}"));
            let built = build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
            let (mut simulation, schedule) = (built.simulation, built.schedule);
            simulation.advance().unwrap();
            assert!(schedule.advance(&mut simulation).unwrap());
            let energy = simulation.balance().strain;
            assert!(energy > 0.01, "{method}{energy}");
            let mut closed = 0;
            while !simulation.finished() {
                simulation.advance().unwrap_or_else(|e| panic!("{method}{keeps}{e}"));
                let balance = simulation.balance();
                closed += simulation.active()[0].iter().filter(|active| **active).count();
                let total = balance.strain + balance.kinetic + balance.closing_loss + balance.impact_loss;
                assert!((total / energy - 1.0).abs() < 1e-9, "{method}{keeps}{total} {energy}");
                assert!(balance.linear_momentum.iter().chain(&balance.angular_momentum).all(|p| p.abs() < 1e-9));
            }
            // They are in contact until the wave of the release is back.
            assert!(closed > 50, "{closed}");
            let gap = simulation.contact_report(0).unwrap().iter().filter_map(|r| r.gap).fold(f64::INFINITY, f64::min);
            assert!(gap > 0.01 || overlap > 0.0, "{gap}");
        }
    }
}

/// What a scene is refused for.
fn problem(time: &str, stages: &str, contact: &str) -> String {
    let block = |name: &str, z: [f64; 2]| {
        format!(
            "[[body]]\nname = \"{name}\"\ndensity = 1.0\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             mesh = {{ generator = \"block\", min = [0, 0, {:?}], max = [1, 1, {:?}], divisions = [1, 1, 1] }}\n",
            z[0], z[1]
        )
    };
    let text = format!(
        "[scene]\ntitle = \"refused\"\n{time}{}{}{stages}[[contact]]\nslave = \"a.top\"\nmaster = \"b.bottom\"\n{contact}",
        block("a", [0.0, 1.0]),
        block("b", [1.0, 2.0])
    );
    match stoss::scene::parse(&text, "refused.toml") {
        Ok(scene) => build(&scene, Path::new(".")).map_or_else(|e| e.to_string(), |_| String::new()),
        Err(e) => e.to_string(),
    }
}

#[test]
fn what_does_work_in_dynamics_is_refused() {
    let dynamic = "kind = \"dynamic\"\n[time]\nend = 2.0\nstep = 0.1\nintegrator = { scheme = \"energy-momentum\" }\n";
    let stages = "[[stage]]\nname = \"press\"\nkind = \"quasi-static\"\nuntil = 1.0\n[[stage]]\nname = \"go\"\nkind = \"dynamic\"\nuntil = 2.0\n";
    for method in METHODS {
        for (stages, keys, expected) in [
            ("", "overlap = \"ramp\"\n", "no balance of energy has"),
            ("", "interference = 0.1\n", "no balance of energy has"),
            ("", "overlap = \"keep\"\n", ""),
            (stages, "interference = 0.1\noverlap = \"ramp\"\n", ""),
            (stages, "interference = { table = [[0.0, 0.0], [1.0, 0.1]] }\n", ""),
            (stages, "interference = { table = [[0.0, 0.0], [1.5, 0.1]] }\n", "changes in a dynamic stage"),
        ] {
            let found = problem(dynamic, stages, &format!("{method}{keys}"));
            assert!(
                if expected.is_empty() { found.is_empty() } else { found.contains(expected) },
                "{method}{keys}{found}"
            );
        }
    }
}

#[test]
fn keys_that_do_not_fit_are_refused() {
    let statics = "kind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.1\n";
    let friction = "friction = { law = \"coulomb\", mu = 0.1 }\n";
    for (keys, expected) in [
        ("interference = -0.1\n", "is negative"),
        ("closing_friction = \"none\"\n", "this contact has none"),
        (&format!("{friction}closing_friction = \"grows\"\n"), "is in proportion to time"),
        (&format!("{friction}overlap = \"ramp\"\nclosing_friction = \"grows\"\n"), ""),
        (&format!("{friction}closing_friction = \"none\"\n"), ""),
        ("[general_contact]\ninterference = 0.1\n", "is not for general contact"),
    ] {
        let found = problem(statics, "", &format!("method = \"nts\"\n{keys}"));
        assert!(if expected.is_empty() { found.is_empty() } else { found.contains(expected) }, "{keys}{found}");
    }
}
