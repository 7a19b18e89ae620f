//! Materials with history in whole runs: closed forms in statics, the balance of flights, restarts, stages (theory/inelastic).

use crate::support::{problem_keys, simulation};
use stoss::run::{RunOptions, run_scene};
use stoss::solver::Simulation;
use stoss::term::MaterialWork;

/// A cube in uniaxial stress whose length goes to `exp(0.5)` in ten steps.
fn tension(material: &str) -> Simulation {
    let fixed =
        |set: &str, axis: &str| format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{axis}\"]\nfixed = true\n");
    simulation(&format!(
        "[scene]\ntitle = \"tension\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.1\n\
         [[body]]\nname = \"bar\"\nmaterial = {{ {material} }}\n\
         mesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 1, 1] }}\n\
         {}{}{}[[prescribe]]\nset = \"bar.right\"\ncomponents = [\"x\"]\n\
         displacement = {{ table = [[0.0, 0.0], [1.0, {:?}]] }}\n",
        fixed("bar.left", "x"),
        fixed("bar.front", "y"),
        fixed("bar.bottom", "z"),
        0.5_f64.exp() - 1.0,
    ))
}

const ELASTIC: &str = "law = \"hencky\", lambda = 110743.46666666667, mu = 80193.8";

/// Values of theory/inelastic#closed-forms: Kirchhoff stress `t = sigma_y(a) + H_k a`, `t/E + a = 0.5`. The force is that stress over the stretch.
#[test]
fn uniaxial_tension_follows_the_hardening_curve() {
    for (plasticity, stress, strain) in [
        ("yield_stress = 450.0, hardening_modulus = 1000.0", 945.430_494_152, 0.495_430_494_152),
        (
            "yield_stress = 450.0, hardening_modulus = 129.24, saturation_stress = 715.0, saturation_rate = 16.93",
            779.073_836_355,
            0.496_234_538_157,
        ),
        ("hardening = [[0.0, 450.0], [0.01, 500.0], [0.05, 600.0], [0.5, 700.0]]", 699.248_967_119, 0.496_620_352_036),
        ("yield_stress = 450.0, kinematic_modulus = 1000.0", 945.430_494_152, 0.495_430_494_152),
    ] {
        let mut run = tension(&format!("{ELASTIC}, plasticity = {{ {plasticity} }}"));
        while !run.finished() {
            run.advance().unwrap_or_else(|e| panic!("{plasticity}: {e}"));
        }
        let reactions = run.reactions();
        let right = run.model().reference.chunks(3).zip(reactions.chunks(3)).filter(|(x, _)| x[0] == 1.0);
        let force: f64 = right.map(|(_, r)| r[0]).sum();
        assert!((force * 0.5_f64.exp() / stress - 1.0).abs() < 1e-8, "{plasticity}: {}", force * 0.5_f64.exp());
        let solid = &run.model().bodies[0].solid;
        let place = solid.state_output("equivalent_plastic_strain").unwrap();
        let nodal = solid.nodal_state_output::<1>(&run.state().q, place).unwrap().means();
        assert!(nodal.iter().all(|a| (a[0] - strain).abs() < 1e-9), "{plasticity}: {:?}", nodal[0]);
    }
}

/// A bar that spins, stretches and bends without loads.
fn flight(material: &str, scheme: &str) -> String {
    format!(
        "[scene]\ntitle = \"flight\"\nkind = \"dynamic\"\n[time]\nend = 6e-6\nstep = 2e-7\n\
         integrator = {{ scheme = \"{scheme}\" }}\n\
         [[body]]\nname = \"bar\"\nmaterial = {{ {material} }}\ndensity = 7.8e-9\n\
         mesh = {{ generator = \"block\", size = [4, 1, 1], divisions = [4, 1, 1] }}\n\
         velocity = [1e4, 2e4, -3e4]\nangular_velocity = [0, 0, 6e4]\nvelocity_about = [2.0, 0.5, 0.5]\n\
         velocity_gradient = [[6e4, 0, 0], [0, 0, 3e4], [0, 2e4, 0]]\n[output]\nevery = 10\n"
    )
}

/// Every kind of history, in MPa, mm, t, s.
fn materials() -> [String; 4] {
    let rubber = "law = \"neo-hooke\", lambda = 110743.5, mu = 80193.8";
    [
        format!(
            "{ELASTIC}, plasticity = {{ yield_stress = 450.0, hardening_modulus = 129.24, kinematic_modulus = 2e3 }}"
        ),
        format!(
            "{ELASTIC}, plasticity = {{ yield_stress = 450.0, rate = {{ stress = 200.0, rate = 1e4, exponent = 0.3 }} }}"
        ),
        format!("{rubber}, prony = [[0.4, 1e-6], [0.2, 1e-4], [0.1, 1e-9]]"),
        format!("{rubber}, mullins = {{ r = 1.5, m = 160.0 }}"),
    ]
}

#[test]
fn energy_and_losses_together_are_constant() {
    for material in materials() {
        let mut run = simulation(&flight(&material, "energy-momentum"));
        let start = *run.balance();
        let (mut before, mut drift) = (0.0, 0.0_f64);
        while !run.finished() {
            let record = run.advance().unwrap_or_else(|e| panic!("{material}: {e}"));
            let lost = record.balance.dissipation;
            assert!(lost >= before - 1e-14 * start.total(), "{material}: a step gained {:e}", before - lost);
            before = lost;
            drift = drift.max((record.balance.total() / start.total() - 1.0).abs());
            // The books of the body say so, and nothing is left over.
            let posting = record.books.bodies[0];
            assert!(posting.remainder.abs() < 1e-13 * start.total(), "{material}: {posting:?}");
            // By cause, to the bit.
            let MaterialWork { hardening, plastic, viscous, softening, .. } = posting.material;
            assert_eq!(posting.dissipated, plastic + viscous + softening, "{material}");
            let of_balance = &record.balance;
            assert!(hardening == of_balance.hardening && hardening <= posting.stored, "{material}: {posting:?}");
            let in_bodies = of_balance.dissipated_in_bodies();
            assert!((in_bodies - lost).abs() <= 1e-14 * lost && of_balance.damping == 0.0, "{material}");
        }
        let end = *run.balance();
        let [yields, relaxes, softens] = ["plasticity", "prony", "mullins"].map(|key| material.contains(key));
        let causes = [end.plastic_loss > 0.0, end.viscous_loss > 0.0, end.softening_loss > 0.0];
        assert_eq!(causes, [yields, relaxes, softens], "{material}");
        assert_eq!(end.hardening > 0.0, material.contains("hardening_modulus"), "{material}");
        let end = run.balance();
        assert!(drift < 1e-12, "{material}: {drift:e}");
        assert!(end.dissipation > 1e-3 * start.total() && end.dissipation < start.total(), "{material}: {end:?}");
        for i in 0..3 {
            let turned = (end.angular_momentum[i] - start.angular_momentum[i]).abs();
            assert!(turned < 1e-12 * start.angular_momentum[2].abs(), "{material}");
        }
    }
}

#[test]
fn other_schemes_run_and_lose_about_the_same() {
    let material = &materials()[0];
    let lost = |scheme: &str| {
        // Backward Euler damps too: in steps of 2e-7 it takes a fifth of the motion that would yield.
        let mut run = simulation(&flight(material, scheme).replace("step = 2e-7", "step = 4e-8"));
        while !run.finished() {
            run.advance().unwrap_or_else(|e| panic!("{scheme}: {e}"));
        }
        run.balance().dissipation
    };
    let exact = lost("energy-momentum");
    for scheme in ["midpoint", "trapezoidal", "generalised-alpha", "backward-euler"] {
        let other = lost(scheme);
        assert!((other / exact - 1.0).abs() < 0.1, "{scheme}: {other} {exact}");
    }
}

#[test]
fn a_restart_has_the_same_bits() {
    for material in materials() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flight.toml");
        std::fs::write(&path, flight(&material, "energy-momentum")).unwrap();
        let at_once = RunOptions { out: folder.path().join("at-once"), ..RunOptions::default() };
        run_scene(&path, &at_once, &mut |_| {}).unwrap();
        let halted = RunOptions { out: folder.path().join("halted"), until: Some(3e-6), ..RunOptions::default() };
        run_scene(&path, &halted, &mut |_| {}).unwrap();
        let resumed = RunOptions { resume: true, until: None, ..halted };
        run_scene(&path, &resumed, &mut |_| {}).unwrap();
        for table in ["balance.csv", "terms.csv"] {
            let read = |out: &str| std::fs::read_to_string(folder.path().join(out).join(table)).unwrap();
            assert!(read("at-once") == read("halted"), "{material}");
            for (column, key) in [
                ("plastic_loss", "plasticity"),
                ("hardening", "plasticity"),
                ("viscous_loss", "prony"),
                ("softening_loss", "mullins"),
            ] {
                let heads = read("halted").lines().next().unwrap().to_owned();
                let has = heads.split(',').any(|head| head == column || head == format!("bar.{column}"));
                assert_eq!(has, material.contains(key), "{table}: {heads}");
            }
        }
    }
}

/// A relaxing cube that is held at a stretch of 1.2, without inertia to speak of: in a dynamic stage it goes on relaxing from the stress that it has, whatever the scheme, and its sides stay free.
/// (Forces at the start of a stage that have the flow of the coming step would leave 0.0085 of stress on the sides of all schemes that keep forces or accelerations.)
#[test]
fn a_dynamic_stage_begins_with_the_stress_that_is_there() {
    let side = |scheme: &str| {
        let text = format!(
            "[scene]\ntitle = \"relaxing\"\nkind = \"dynamic\"\n[time]\nend = 1.01\nstep = 0.1\nintegrator = {{ scheme = \"{scheme}\" }}\n\
             [[body]]\nname = \"b\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }}\ndensity = 1e-8\n\
             material = {{ law = \"hencky\", young = 2.1, poisson = 0.3, prony = [[0.4, 0.5]] }}\n\
             [[prescribe]]\nset = \"b.left\"\ncomponents = [\"x\"]\nfixed = true\n\
             [[prescribe]]\nset = \"b.front\"\ncomponents = [\"y\"]\nfixed = true\n\
             [[prescribe]]\nset = \"b.bottom\"\ncomponents = [\"z\"]\nfixed = true\n\
             [[prescribe]]\nset = \"b.right\"\ncomponents = [\"x\"]\ndisplacement = {{ table = [[0, 0.2], [3, 0.2]] }}\n\
             [[stage]]\nname = \"pull\"\nkind = \"dynamic\"\nuntil = 0.01\nstep = 0.01\nintegrator = {{ scheme = \"backward-euler\" }}\n\
             [[stage]]\nname = \"hold\"\nkind = \"dynamic\"\nuntil = 1.01\nstep = 0.1\nintegrator = {{ scheme = \"{scheme}\" }}\n"
        );
        let scene = stoss::scene::parse(&text, "relaxing.toml").unwrap();
        let built = stoss::build::build(&scene, std::path::Path::new(".")).unwrap();
        let (mut run, schedule) = (built.simulation, built.schedule);
        let mut way = Vec::new();
        while !run.finished() || schedule.advance(&mut run).unwrap() {
            run.advance().unwrap_or_else(|e| panic!("{scheme}: {e}"));
            way.push(run.state().q.chunks(3).fold(f64::NEG_INFINITY, |most, x| most.max(x[1])) - 1.0);
        }
        way
    };
    let euler = side("backward-euler");
    for scheme in ["newmark", "trapezoidal"] {
        let other = side(scheme);
        assert!(euler.len() == other.len() && euler.len() == 11, "{euler:?}");
        for (a, b) in euler.iter().zip(&other) {
            assert!((a / b - 1.0).abs() < 0.01, "{scheme}: {euler:?} {other:?}");
        }
    }
}

/// The bar of scenes/necking-bar.toml: the largest force is that of Considere, the maximum of `sigma_y(a) exp(-a)` times the first area, and a neck forms behind it.
#[test]
fn a_bar_necks_behind_the_force_of_considere() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/necking-bar.toml");
    let mut run = simulation(&std::fs::read_to_string(path).unwrap());
    let nodes = run.model().reference.clone();
    let at = |y: f64| nodes.chunks(3).enumerate().filter(move |(_, x)| (x[1] - y).abs() < 1e-9).map(|(node, _)| node);
    let (end, middle): (Vec<usize>, Vec<usize>) = (at(26.667).collect(), at(0.0).collect());
    let (mut forces, mut radii) = (Vec::new(), Vec::new());
    while !run.finished() {
        run.advance().unwrap_or_else(|e| panic!("{e}"));
        let (reactions, q) = (run.reactions(), &run.state().q);
        forces.push(4.0 * end.iter().map(|node| reactions[3 * node + 1]).sum::<f64>());
        radii.push(middle.iter().map(|node| q[3 * node]).fold(0.0, f64::max) / 6.413);
    }
    let largest = forces.iter().copied().fold(0.0, f64::max);
    let yields = |a: f64| 450.0 + 129.24 * a + 265.0 * (1.0 - (-16.93 * a).exp());
    let considere = (1..600).map(|k| 1e-3 * f64::from(k)).map(|a| yields(a) * (-a).exp()).fold(0.0, f64::max);
    // The mesh is a prism of 16 sides.
    let area = 8.0 * (std::f64::consts::PI / 8.0).sin() * 6.413_f64.powi(2);
    println!("{largest} {} {:?} {:?}", considere * area, forces.last(), radii.last());
    assert!((largest / (considere * area) - 1.0).abs() < 0.01, "{largest} {}", considere * area);
    let place = forces.iter().position(|force| *force == largest).unwrap();
    assert!(radii[place] > 0.85 && *radii.last().unwrap() < 0.55, "{} {:?}", radii[place], radii.last());
    assert!(forces.last().unwrap() / largest < 0.6);
}

/// A cube that is pulled by 1 % of strain in a unit of time, and goes back by a tenth of it in the next tenth.
fn pulled(material: &str, end: f64, more: &str) -> String {
    let fixed =
        |set: &str, axis: &str| format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{axis}\"]\nfixed = true\n");
    format!(
        "[scene]\ntitle = \"pulled\"\nkind = \"quasi-static\"\n[time]\nend = {end:?}\nstep = 0.1\n\
         [[body]]\nname = \"bar\"\nmaterial = {{ {material} }}\n\
         mesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }}\n\
         [[body]]\nname = \"beside\"\nmaterial = {{ law = \"neo-hooke\", young = 1e3, poisson = 0.3 }}\n\
         mesh = {{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 1] }}\nposition = [0, 3, 0]\n\
         {}{}{}{}{}{}[[prescribe]]\nset = \"bar.right\"\ncomponents = [\"x\"]\n\
         displacement = {{ table = [[0.0, 0.0], [1.0, 0.01], [1.1, 0.009], [1000.0, 0.009]] }}\n{more}",
        fixed("bar.left", "x"),
        fixed("bar.front", "y"),
        fixed("bar.bottom", "z"),
        fixed("beside.left", "x"),
        fixed("beside.front", "y"),
        fixed("beside.bottom", "z"),
    )
}

#[test]
fn states_are_fields_and_probes() {
    let probes: Vec<String> = [
        ("equivalent_plastic_strain", ""),
        ("plastic_strain", ""),
        ("back_stress", ""),
        ("yielding", ""),
        ("logarithmic_strain", ""),
        ("equivalent_plastic_strain", "reduce = \"max\"\n"),
        ("yielding", "reduce = \"min\"\n"),
        ("back_stress", "reduce = \"max\"\ncomponent = \"xx\"\n"),
    ]
    .iter()
    .enumerate()
    .map(|(k, (quantity, more))| {
        let at = if more.is_empty() { "point = [0.3, 0.6, 0.2]\n" } else { more };
        format!("[[probe]]\nname = \"p{k}\"\nquantity = \"{quantity}\"\nbody = \"bar\"\n{at}")
    })
    .collect();
    let fields = "[output]\nfields = [\"displacement\", \"equivalent_plastic_strain\", \"plastic_strain\", \"back_stress\", \"yielding\"]\n";
    let material = format!("{ELASTIC}, plasticity = {{ yield_stress = 450.0, kinematic_modulus = 2000.0 }}");
    let text = pulled(&material, 1.1, &(probes.concat() + fields));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pulled.toml");
    std::fs::write(&path, &text).unwrap();
    let options = RunOptions { out: folder.path().join("out"), ..RunOptions::default() };
    run_scene(&path, &options, &mut |_| {}).unwrap();
    let table = std::fs::read_to_string(options.out.join("probes.csv")).unwrap();
    let heads: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        table.lines().skip(1).map(|row| row.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let of = |row: &Vec<f64>, name: &str| row[heads.iter().position(|head| *head == name).unwrap()];
    let (virgin, pulled, back) = (&rows[0], &rows[rows.len() - 2], &rows[rows.len() - 1]);
    assert!(["p0", "p1.xx", "p2.xx", "p3"].iter().all(|name| of(virgin, name) == 0.0), "{virgin:?}");
    // Uniaxial stress: plastic strain (1, -1/2, -1/2) a, back stress 2/3 H_k of it.
    let a = of(pulled, "p0");
    assert!(a > 5e-3 && a < of(pulled, "p4.xx"), "{a}");
    for (name, value) in [
        ("p1.xx", a),
        ("p1.yy", -0.5 * a),
        ("p1.xy", 0.0),
        ("p2.xx", 2000.0 * 2.0 / 3.0 * a),
        ("p2.zz", -2000.0 / 3.0 * a),
        ("p3", 1.0),
        ("p5", a),
        ("p6", 1.0),
        ("p7", 2000.0 * 2.0 / 3.0 * a),
    ] {
        assert!((of(pulled, name) - value).abs() < 1e-9 * (1.0 + value.abs()), "{name}: {} {value}", of(pulled, name));
    }
    // On the way back it is elastic.
    assert_eq!((of(back, "p0"), of(back, "p3"), of(back, "p6")), (a, 0.0, 0.0));
    let frame = stoss::mesh_io::read_vtu(options.out.join("frames/frame_000011.vtu")).unwrap();
    let field = |name: &str| frame.point_data[name].values.clone();
    let strain = field("equivalent_plastic_strain");
    assert!(strain[..8].iter().all(|x| (x - a).abs() < 1e-12) && strain[8..].iter().all(|x| *x == 0.0), "{strain:?}");
    assert_eq!((field("back_stress").len(), field("plastic_strain").len(), field("yielding").len()), (96, 96, 16));
}

#[test]
fn viscous_strain_is_a_probe() {
    let material = "law = \"hencky\", young = 2.1, poisson = 0.3, prony = [[0.3, 0.5], [0.2, 2.0]]";
    let probe = |name: &str, quantity: &str| {
        format!("[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\nbody = \"bar\"\npoint = [0.5, 0.5, 0.5]\n")
    };
    let text = pulled(material, 40.0, &(probe("v", "viscous_strain") + &probe("e", "logarithmic_strain")));
    let scene = stoss::scene::parse(&text.replace("step = 0.1", "step = 1.0"), "test.toml").unwrap();
    let mut built = stoss::build::build(&scene, std::path::Path::new(".")).unwrap();
    while !built.simulation.finished() {
        built.simulation.advance().unwrap();
    }
    // All of the isochoric strain has relaxed after twenty times.
    let values: Vec<Vec<f64>> = built.probes.iter().map(|probe| probe.values(&built.simulation)).collect();
    let mean = (values[1][0] + values[1][1] + values[1][2]) / 3.0;
    for k in 0..3 {
        assert!((values[0][k] - (values[1][k] - mean)).abs() < 1e-7, "{values:?}");
    }
}

#[test]
fn what_no_body_has_is_refused_by_name() {
    let steel = format!("{ELASTIC}, plasticity = {{ yield_stress = 450.0 }}");
    let refused = |more: &str| {
        let scene = stoss::scene::parse(&pulled(&steel, 1.0, more), "test.toml").unwrap();
        let errors = stoss::build::build(&scene, std::path::Path::new(".")).map(|_| ()).unwrap_err();
        assert_eq!(errors.problems().len(), 1, "{errors}");
        (errors.problems()[0].key.clone(), errors.to_string())
    };
    let probe = |quantity: &str, body: &str, more: &str| {
        format!("[[probe]]\nname = \"p\"\nquantity = \"{quantity}\"\nbody = \"{body}\"\n{more}")
    };
    let (_, field) = refused("[output]\nfields = [\"back_stress\"]\n");
    for part in ["`bar` (hencky with plasticity)", "`beside` (neo-hooke)", "kinematic_modulus", "output.fields"] {
        assert!(field.contains(part), "{field}");
    }
    let point = "point = [0.5, 3.5, 0.5]\n";
    assert_eq!(refused(&probe("equivalent_plastic_strain", "beside", point)).0, "probe[0].quantity");
    assert_eq!(refused(&probe("yielding", "beside", "reduce = \"max\"\n")).0, "probe[0].quantity");
    assert_eq!(refused("[output]\nfields = [\"viscous_strain\"]\n").0, "output.fields");
}

/// A nearly incompressible cube with fibres that is pulled to a stretch of 1.2 along x; `mesh` is its mesh.
fn fibrous(fibres: &str, mesh: &str, more: &str) -> String {
    let fixed =
        |set: &str, axis: &str| format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{axis}\"]\nfixed = true\n");
    format!(
        "[scene]\ntitle = \"fibres\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.25\n\
         [[body]]\nname = \"bar\"\nvolumetric = \"mixed\"\n\
         material = {{ law = \"yeoh\", c1 = 0.5, c2 = 0.0, c3 = 0.0, kappa = 1e7, fibres = {{ k1 = 2.0, k2 = 3.0, {fibres} }} }}\n\
         mesh = {mesh}\n{more}{}{}{}[[prescribe]]\nset = \"bar.right\"\ncomponents = [\"x\"]\n\
         displacement = {{ table = [[0.0, 0.0], [1.0, 0.2]] }}\n",
        fixed("bar.left", "x"),
        fixed("bar.front", "y"),
        fixed("bar.bottom", "z"),
    )
}

const CUBE: &str = "{ generator = \"block\", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 1, 1] }";

/// Force on the right face at the end.
fn force_of(text: &str, folder: &std::path::Path) -> f64 {
    let mut run = crate::support::simulation_in(text, folder);
    while !run.finished() {
        run.advance().unwrap_or_else(|e| panic!("{e}"));
    }
    let reactions = run.reactions();
    let right = run.model().reference.chunks(3).zip(reactions.chunks(3)).filter(|(x, _)| (x[0] - 1.0).abs() < 1e-9);
    right.map(|(_, r)| r[0]).sum()
}

/// Along the fibres the force of an incompressible bar is `(mu (l^2 - 1/l) + 2 W' l^2)/l` with `W' = k1 E exp(k2 E^2)`, `E = l^2 - 1`; across them, where they are
/// pressed, `mu (l - 1/l^2)`.
#[test]
fn fibres_are_stiff_along_and_soft_across() {
    let here = std::path::Path::new(".");
    let (l, mu) = (1.2_f64, 1.0);
    let e = l * l - 1.0;
    let along = (mu * (l * l - 1.0 / l) + 4.0 * e * (3.0 * e * e).exp() * l * l) / l;
    let across = mu * (l - 1.0 / (l * l));
    for (direction, force) in [("[3, 0, 0]", along), ("[0, 1, 0]", across), ("[0, 0, -2]", across)] {
        let found = force_of(&fibrous(&format!("direction = {direction}"), CUBE, ""), here);
        assert!((found / force - 1.0).abs() < 1e-5, "{direction}: {found} {force}");
    }
    // Of a cylinder far away about z the circumference at the cube is x, and both families with the angle 0 are along it: twice as stiff.
    let twice = (mu * (l * l - 1.0 / l) + 8.0 * e * (3.0 * e * e).exp() * l * l) / l;
    let found = force_of(&fibrous("axis = [0, 0, 1], point = [0.5, -1e7, 0], angle = 0.0", CUBE, ""), here);
    assert!((found / twice - 1.0).abs() < 1e-5, "{found} {twice}");
    let found = force_of(&fibrous("axis = [0, 0, 1], point = [0.5, -1e7, 0], angle = 90.0", CUBE, ""), here);
    assert!((found / across - 1.0).abs() < 1e-5, "{found} {across}");
}

/// Directions from a field of the cells; they turn with the body, and go to the cells that a cell becomes.
#[test]
fn fibres_follow_a_field_of_the_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let vtu = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid>\n\
        <Piece NumberOfPoints=\"8\" NumberOfCells=\"1\">\n\
        <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n\
        0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n</DataArray></Points>\n<Cells>\n\
        <DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 4 5 6 7</DataArray>\n\
        <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">8</DataArray>\n\
        <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">12</DataArray>\n</Cells>\n\
        <CellData><DataArray type=\"Float64\" Name=\"fibre\" NumberOfComponents=\"3\" format=\"ascii\">0 4 0</DataArray></CellData>\n\
        </Piece>\n</UnstructuredGrid></VTKFile>\n";
    std::fs::write(folder.path().join("cube.vtu"), vtu).unwrap();
    let planes =
        [("left", [0.0; 3], 0), ("right", [1.0, 0.0, 0.0], 0), ("front", [0.0; 3], 1), ("bottom", [0.0; 3], 2)];
    let sets: String = planes
        .iter()
        .map(|(name, point, axis)| {
            let normal: [f64; 3] = std::array::from_fn(|i| if i == *axis { 1.0 } else { 0.0 });
            format!(
                "[[set]]\nname = \"bar.{name}\"\nbody = \"bar\"\nplane = {{ point = {point:?}, normal = {normal:?} }}\n"
            )
        })
        .collect();
    let file = "{ file = \"cube.vtu\" }";
    let l = 1.2_f64;
    let e = l * l - 1.0;
    let along = (l * l - 1.0 / l + 4.0 * e * (3.0 * e * e).exp() * l * l) / l;
    for (placed, force) in [
        ("", l - 1.0 / (l * l)),
        ("rotation = { axis = [0, 0, 1], degrees = -90.0, about = [0.5, 0.5, 0.0] }\n", along),
        ("rotation = { axis = [0, 0, 1], degrees = -90.0, about = [0.5, 0.5, 0.0] }\ncell = \"tet10\"\n", along),
    ] {
        let text = fibrous("field = [\"fibre\"]", file, &(placed.to_owned() + &sets));
        let found = force_of(&text, folder.path());
        assert!((found / force - 1.0).abs() < 1e-5, "{placed}: {found} {force}");
    }
    let scene = stoss::scene::parse(&fibrous("field = [\"fibres\"]", file, &sets), "test.toml").unwrap();
    let errors = stoss::build::build(&scene, folder.path()).map(|_| ()).unwrap_err().to_string();
    assert!(errors.contains("the mesh has fibre") && errors.contains("body[0].material.fibres.field[0]"), "{errors}");
}

#[test]
fn fibres_that_fit_nothing_are_refused() {
    for (fibres, key, part) in [
        ("dispersion = 0.1", "fibres.direction", "is missing"),
        ("direction = [1, 0, 0], axis = [0, 0, 1], angle = 3.0", "fibres.direction", "twice"),
        ("axis = [0, 0, 1]", "fibres.angle", "is missing"),
        ("direction = [0, 0, 0]", "fibres.direction", "zero vector"),
        ("direction = [1, 0, 0], dispersion = 0.4", "fibres.dispersion", "1/3"),
        ("direction = [1, 0, 0], angle = 4.0", "fibres.angle", "without `axis`"),
    ] {
        let errors = stoss::scene::parse(&fibrous(fibres, CUBE, ""), "test.toml").map(|_| ()).unwrap_err().to_string();
        assert!(errors.contains(key) && errors.contains(part), "{fibres}: {errors}");
    }
    let text = fibrous("axis = [0, 0, 1], point = [0.25, 0.5, 0], angle = 4.0", CUBE, "");
    assert_eq!(problem_keys(&text), ["body[0].material.fibres.axis"]);
    // With plasticity there is no matrix to put them into.
    let both = pulled(
        &format!(
            "{ELASTIC}, plasticity = {{ yield_stress = 450.0 }}, fibres = {{ k1 = 1.0, k2 = 1.0, direction = [1, 0, 0] }}"
        ),
        1.0,
        "",
    );
    let errors = stoss::scene::parse(&both, "test.toml").map(|_| ()).unwrap_err().to_string();
    assert!(errors.contains("fibres") && errors.contains("cannot be combined with `plasticity`"), "{errors}");
}

/// Steps are halved until no point flows by more than the limit, and do not grow while points flow by more than half of it.
#[test]
fn plastic_increments_can_be_limited() {
    let material = format!("{ELASTIC}, plasticity = {{ yield_stress = 450.0, hardening_modulus = 1000.0 }}");
    let text = |limit: &str| pulled(&material, 1.0, "").replace("step = 0.1\n", &format!("step = 1.0\n{limit}\n"));
    let mut run = simulation(&text("max_plastic_increment = 1e-3"));
    let place = run.model().bodies[0].solid.state_output("equivalent_plastic_strain").unwrap();
    let (mut before, mut largest, mut steps) = (0.0, 0.0_f64, 0);
    while !run.finished() {
        let record = run.advance().unwrap();
        let nodal = run.model().bodies[0].solid.nodal_state_output::<1>(&run.state().q, place).unwrap().means();
        assert!((record.books.bodies[0].material.flow - (nodal[0][0] - before)).abs() < 1e-12);
        largest = largest.max(nodal[0][0] - before);
        before = nodal[0][0];
        steps += 1;
    }
    // 0.0077 in all: after a quarter, which is elastic nearly to its end, twelve sixteenths with 6.2e-4 each.
    assert!(largest <= 1e-3 && largest > 4e-4 && steps == 13, "{largest} {steps}");
    // The path is proportional: one step has the same end.
    let mut at_once = simulation(&text(""));
    at_once.advance().unwrap();
    assert!(at_once.finished());
    let nodal = at_once.model().bodies[0].solid.nodal_state_output::<1>(&at_once.state().q, place).unwrap().means();
    assert!((nodal[0][0] - before).abs() < 1e-9, "{before} {}", nodal[0][0]);
    // Below the smallest step the run says why it stops.
    let mut stopped = simulation(&text("max_plastic_increment = 1e-3\nmax_cuts = 2"));
    let error = loop {
        if let Err(error) = stopped.advance() {
            break error.to_string();
        }
    };
    assert!(error.contains("body bar") && error.contains("equivalent plastic strain"), "{error}");
    let scene = stoss::scene::parse(
        &pulled(ELASTIC, 1.0, "").replace("step = 0.1", "step = 0.1\nmax_plastic_increment = 0.1"),
        "t.toml",
    );
    let errors = stoss::build::build(&scene.unwrap(), std::path::Path::new(".")).map(|_| ()).unwrap_err().to_string();
    assert!(errors.contains("no body yields: `bar` (hencky), `beside` (neo-hooke)"), "{errors}");
}

/// What `stoss check` says of a body: that it yields, relaxes, softens, has fibres, and which moduli are those of fast strains.
#[test]
fn check_says_what_a_law_does() {
    let line = |material: &str| {
        let scene = stoss::scene::parse(&pulled(material, 1.0, ""), "test.toml").unwrap();
        let built = stoss::build::build(&scene, std::path::Path::new(".")).unwrap();
        built.bodies.iter().find(|line| line.starts_with("bar: ")).unwrap().clone()
    };
    let yields = line(&format!("{ELASTIC}, plasticity = {{ yield_stress = 450.0 }}"));
    assert!(yields.contains("hencky that yields (E = 2.068999e5, nu = 0.2900 at small strains)"), "{yields}");
    // G = 1 and 0.4 relaxed, K = 10: E = 9 K G/(3 K + G), nu = (3 K - 2 G)/(6 K + 2 G).
    let [fast, slow] = [1.0, 0.4].map(|g| (90.0 * g / (30.0 + g), (30.0 - 2.0 * g) / (60.0 + 2.0 * g)));
    for (given, moduli) in [(1.0, ""), (0.4, ", moduli = \"long-term\"")] {
        let lambda = 10.0 - 2.0 / 3.0 * given;
        let relaxes = line(&format!(
            "law = \"hencky\", lambda = {lambda:?}, mu = {given:?}, prony = [[0.4, 1.0], [0.2, 2.0]]{moduli}"
        ));
        for ((young, poisson), which) in [(fast, "at small fast strains, instantaneous"), (slow, "relaxed, long-term")]
        {
            assert!(relaxes.contains(&format!("E = {young:.6e}, nu = {poisson:.4} {which}")), "{relaxes}");
        }
        assert!(relaxes.contains("hencky that relaxes"), "{relaxes}");
    }
    let both = line(
        "law = \"neo-hooke\", young = 2.1, poisson = 0.3, mullins = { r = 1.5, m = 0.3 }, fibres = { k1 = 1.0, k2 = 1.0, direction = [1, 0, 0] }",
    );
    assert!(both.contains("neo-hooke that softens and has fibres") && both.contains("without the fibres"), "{both}");
    assert!(line("law = \"neo-hooke\", young = 2.1, poisson = 0.3").contains("neo-hooke (E = 2.1"));
}
