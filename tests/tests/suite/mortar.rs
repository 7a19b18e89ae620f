//! Mortar contact: patch tests, convergence of Newton's method, conservation.

use crate::support::{drift, simulation};
use stoss::solver::{Simulation, StepRecord};
use stoss_reference_cases::patch::{ContactPatch, LAWS, unevenness as unevenness_of};

fn print_newton(record: &StepRecord) {
    let rows: Vec<String> = record
        .newton
        .iter()
        .map(|r| {
            format!("{:.1e}{}", r.residual, if r.changes > 0 { format!("({})", r.changes) } else { String::new() })
        })
        .collect();
    println!("step {} dt {}: {}", record.step, record.dt, rows.join(" "));
}

fn run(simulation: &mut Simulation) {
    while !simulation.finished() {
        print_newton(&simulation.advance().unwrap());
    }
}

/// Largest deviation of the Cauchy stress at any Gauss point from the mean, over the norm of the mean, and the mean.
fn unevenness(simulation: &Simulation) -> (f64, [f64; 6]) {
    let q = &simulation.state().q;
    let bodies = &simulation.model().bodies;
    let stresses: Vec<[f64; 6]> = bodies
        .iter()
        .flat_map(|b| b.solid.gauss_point_state(q).unwrap())
        .flat_map(|points| points.into_iter().map(|p| p.cauchy))
        .collect();
    unevenness_of(&stresses)
}

/// Runs to the end; the vertical force on the slave there.
fn last_vertical_force(mut simulation: Simulation) -> f64 {
    let mut force = 0.0;
    while !simulation.finished() {
        force = simulation.advance().unwrap().contact.map_or(0.0, |contact| contact.force_on_slave[2]);
    }
    force
}

/// Position of the node that started at `x`.
fn position(simulation: &Simulation, x: [f64; 3]) -> [f64; 3] {
    let reference = &simulation.model().reference;
    let node = (0..reference.len() / 3).find(|n| (0..3).all(|i| (reference[3 * n + i] - x[i]).abs() < 1e-9)).unwrap();
    std::array::from_fn(|i| simulation.state().q[3 * node + i])
}

const STANDARD: &str = "method = \"mortar\"\nmultipliers = \"standard\"";
const DUAL: &str = "method = \"mortar\"\nmultipliers = \"dual\"";

/// Uniaxial (flat) or hydrostatic (inclined) compression at finite strains, for a patch.
fn check_patch(name: &str, p: &ContactPatch<'_>) {
    let mut simulation = simulation(&p.text());
    run(&mut simulation);
    let (uneven, mean) = unevenness(&simulation);
    let stretch = position(&simulation, [0.0, p.lower, 0.0])[1] / p.lower;
    println!("{name}: uneven by {uneven:.1e}, stress {:.6}, lateral stretch {stretch:.4}", mean[2]);
    assert!(uneven < 1e-10, "{name}: {uneven:e}");
    // The dead load on the deformed area.
    assert!((mean[2] * stretch * stretch + p.pressure).abs() < 1e-9 * p.pressure, "{name}: {mean:?}");
    let height = position(&simulation, [0.0, 0.0, 2.0])[2] / 2.0;
    assert!(height < 0.98, "{name}: no finite strain");
}

#[test]
fn patch_with_overhang_is_uniform_for_all_laws() {
    for (name, material, pressure) in LAWS {
        for upper_is_slave in [true, false] {
            for contact in [STANDARD, DUAL] {
                // Two and a half facets of the lower block lie below the upper one.
                let p = ContactPatch {
                    material,
                    pressure,
                    contact,
                    lower: 2.0,
                    divisions: [5, 3],
                    slope: 0.0,
                    upper_is_slave,
                };
                check_patch(&format!("{name} overhang, upper slave {upper_is_slave}, {contact:?}"), &p);
            }
        }
    }
}

/// A block on one facet of a larger one, which it covers to round-off, and which is the slave: four nodes carry it, none of them with as much as half of
/// its area covered. Hydrostatic compression in one or more steps about the corner (1, 1, -1).
#[test]
fn a_patch_on_one_slave_facet_is_uniform() {
    for steps in [1, 4, 8] {
        for contact in [STANDARD, DUAL] {
            let mut text = format!(
                r#"
[scene]
title = "patch on one facet"
kind = "quasi-static"
[time]
end = 1.0
step = {}
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [0, 0, -1], max = [3, 3, 0], divisions = [3, 3, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [1, 1, 0], max = [2, 2, 1], divisions = [4, 4, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[contact]]
{contact}
slave = "lower.top"
master = "upper.bottom"
"#,
                1.0 / f64::from(steps)
            );
            let sides = ["left", "right", "front", "back"];
            let mut loaded: Vec<String> = sides.iter().map(|side| format!("lower.{side}")).collect();
            loaded.extend(["upper.right", "upper.back", "upper.top"].map(str::to_owned));
            for (set, [min, max]) in [
                ("lower.x", [[1.0, 0.0, -1.0], [1.0, 3.0, 0.0]]),
                ("lower.y", [[0.0, 1.0, -1.0], [3.0, 1.0, 0.0]]),
                ("lower.free-left", [[0.0, 0.0, 0.0], [1.0, 3.0, 0.0]]),
                ("lower.free-right", [[2.0, 0.0, 0.0], [3.0, 3.0, 0.0]]),
                ("lower.free-front", [[1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]),
                ("lower.free-back", [[1.0, 2.0, 0.0], [2.0, 3.0, 0.0]]),
            ] {
                text +=
                    &format!("[[set]]\nname = \"{set}\"\nbody = \"lower\"\nbox = {{ min = {min:?}, max = {max:?} }}\n");
                loaded.extend(set.starts_with("lower.free").then(|| set.to_owned()));
            }
            for set in loaded {
                text += &format!("[[load]]\nset = \"{set}\"\npressure = {{ table = [[0.0, 0.0], [1.0, 100.0]] }}\n");
            }
            for (set, component) in
                [("lower.x", "x"), ("lower.y", "y"), ("lower.bottom", "z"), ("upper.left", "x"), ("upper.front", "y")]
            {
                text += &format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{component}\"]\nfixed = true\n");
            }
            let mut simulation = simulation(&text);
            run(&mut simulation);
            let (uneven, _) = unevenness(&simulation);
            println!("{steps} steps, {contact:?}: uneven by {uneven:.1e}");
            assert!(uneven < 1e-10, "{steps} steps, {contact:?}: {uneven:e}");
        }
    }
}

#[test]
fn flat_and_inclined_patches_are_uniform() {
    for slope in [0.0, 1.0] {
        for upper_is_slave in [true, false] {
            for contact in [STANDARD, DUAL] {
                let (_, material, pressure) = LAWS[1];
                let p =
                    ContactPatch { material, pressure, contact, lower: 1.0, divisions: [4, 3], slope, upper_is_slave };
                check_patch(&format!("slope {slope}, upper slave {upper_is_slave}, {contact:?}"), &p);
            }
        }
    }
}

#[test]
fn node_to_surface_fails_the_patch() {
    // On the inclined interface it does not even converge at the pressure of the mortar test.
    for (lower, divisions, slope, pressure) in
        [(1.0, [4, 3], 0.0, 200.0), (1.0, [4, 3], 1.0, 20.0), (2.0, [5, 3], 0.0, 200.0)]
    {
        let material = LAWS[1].1;
        let contact = "method = \"nts\"";
        let p = ContactPatch { material, pressure, contact, lower, divisions, slope, upper_is_slave: true };
        let mut simulation = simulation(&p.text());
        run(&mut simulation);
        let (uneven, _) = unevenness(&simulation);
        println!("nts, lower side {lower}, slope {slope}: stress uneven by {uneven:.2e}");
        assert!(uneven > 1e-2);
    }
}

fn scene_file(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name);
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn two_blocks_keep_momenta_and_energy() {
    let mut simulation = simulation(&scene_file("two-blocks-mortar.toml"));
    let mut records = vec![simulation.initial_record()];
    let (mut linear, mut angular) = (Vec::new(), Vec::new());
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        if record.contact.as_ref().is_some_and(|c| c.active > 0) && records.len() % 10 == 0 {
            print_newton(&record);
        }
        linear.push(record.balance.linear_momentum);
        angular.push(record.balance.angular_momentum);
        records.push(record);
    }
    let active: Vec<bool> = records.iter().map(|r| r.contact.as_ref().is_some_and(|c| c.active > 0)).collect();
    let first = active.iter().position(|a| *a).unwrap();
    let last = active.iter().rposition(|a| *a).unwrap();
    let energy: Vec<f64> = records.iter().map(|r| r.balance.total()).collect();
    let spread = |e: &[f64]| e.iter().map(|x| (x / e[0] - 1.0).abs()).fold(0.0, f64::max);
    println!(
        "contact from step {first} to {last} of {}; momenta {:.1e} {:.1e}; energy before {:.1e}, after {:.1e}, over the impact {:.3e}",
        records.len() - 1,
        drift(&linear),
        drift(&angular),
        spread(&energy[..first]),
        spread(&energy[last..]),
        energy[last] / energy[0] - 1.0,
    );
    assert!(first > 1 && last > first);
    assert!(drift(&linear) < 1e-11 && drift(&angular) < 1e-11);
    assert!(spread(&energy[..first]) < 1e-11);
    assert!(spread(&energy[last..]) < 1e-10);
    // The impact as a whole: what closing nodes lose and what new integrals change.
    assert!((energy[last] / energy[0] - 1.0).abs() < 2e-2);
}

/// The start of the ironing: pressing in and the first facets passed.
#[test]
fn ironing_converges_quadratically() {
    for contact in ["standard", "dual"] {
        let text = scene_file("ironing-mortar.toml")
            .replace("end = 20.0", "end = 4.0")
            .replace("method = \"mortar\"", &format!("method = \"mortar\"\nmultipliers = \"{contact}\""));
        let mut simulation = simulation(&text);
        let (mut iterations, mut steps) = (0, 0);
        while !simulation.finished() {
            let record = simulation.advance().unwrap();
            print_newton(&record);
            iterations += record.iterations;
            steps += 1;
        }
        println!(
            "{contact}: {steps} steps, {:.2} iterations a step, {} cuts",
            iterations as f64 / steps as f64,
            simulation.decisions().len()
        );
        assert!(f64::from(iterations) < 7.0 * steps as f64);
    }
}

/// Integrals that stay in the step are for schemes that take forces at its middle.
#[test]
fn frozen_integrals_with_forces_at_the_end_are_refused() {
    let text = scene_file("two-blocks-mortar.toml")
        .replace("method = \"mortar\"", "method = \"mortar\"\nintegrals = \"frozen\"");
    for (scheme, refused) in [("energy-momentum", false), ("midpoint", false), ("backward-euler", true)] {
        let scene = stoss::scene::parse(&text.replace("energy-momentum", scheme), "test.toml").unwrap();
        let built = stoss::build::build(&scene, std::path::Path::new("."));
        assert_eq!(built.is_err(), refused, "{scheme}");
        if let Err(error) = built {
            assert!(error.to_string().contains("contact[0].integrals"), "{error}");
        }
    }
}

/// Two cubes that stand on their vertices meet with these: the area that they have in common is next to nothing, and new at every step.
#[test]
fn corners_that_meet_gain_no_energy_in_any_step() {
    let cube = |name: &str, motion: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\ndensity = 1.0\n\
             mesh = {{ generator = \"block\", size = [0.5, 0.5, 0.5], divisions = [2, 2, 2] }}\n\
             rotation = [{{ axis = [0, 0, 1], degrees = 45 }}, {{ axis = [1, 0, 0], degrees = 54.735610317245346 }}]\n{motion}"
        )
    };
    let mut s = simulation(&format!(
        "[scene]\ntitle = \"t\"\nkind = \"dynamic\"\n[time]\nend = 0.16\nstep = 0.004\nintegrator = {{ scheme = \"energy-momentum\" }}\n{}{}\
         [[contact]]\nmethod = \"mortar\"\nslave = \"upper.boundary\"\nmaster = \"lower.boundary\"\n",
        cube("lower", ""),
        cube("upper", "position = [0.02, 0.01, 0.8760254037844386]\nvelocity = [0.0, 0.0, -1.0]\n"),
    ));
    let (mut energy, mut touched) = (vec![1.0 / 16.0], 0);
    while !s.finished() {
        let record = s.advance().unwrap();
        touched += record.contact.map_or(0, |contact| contact.active);
        energy.push(record.balance.total());
    }
    let rise = energy.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    println!(
        "{} steps, {touched} contacts, energy {:.4} of the first, largest rise {rise:.1e}",
        s.step(),
        energy[energy.len() - 1] * 16.0
    );
    assert!(s.step() == 40 && touched > 0 && rise < 1e-13 * energy[0], "{rise:e}");
}

/// A block held at its bottom and one that is pressed onto it by 0.05, in statics; `blocks` are the lower and the upper one, each by its corners and divisions.
fn pressed(blocks: [([f64; 3], [f64; 3], [usize; 3]); 2], contact: &str) -> Simulation {
    let names = ["lower", "upper"];
    let bodies: String = names
        .iter()
        .zip(blocks)
        .map(|(name, (min, max, divisions))| {
            format!(
                "[[body]]\nname = \"{name}\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
                 mesh = {{ generator = \"block\", min = {min:?}, max = {max:?}, divisions = {divisions:?} }}\n"
            )
        })
        .collect();
    simulation(&format!(
        "[scene]\ntitle = \"t\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.25\n{bodies}\
         [[prescribe]]\nset = \"lower.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
         [[prescribe]]\nset = \"upper.top\"\ncomponents = [\"x\", \"y\", \"z\"]\n\
         displacement = {{ table = [[0, 0, 0, 0], [1, 0, 0, -0.05]] }}\n\
         [[contact]]\nmethod = \"mortar\"\n{contact}\n"
    ))
}

/// Two stacked blocks, all of their surfaces in contact with each other, pressed together in statics: top and bottom, which are farther apart than the blocks are
/// thick, are not taken for each other, whatever the mesh.
#[test]
fn whole_surfaces_meet_where_they_touch() {
    for (lower, upper) in [([4, 4, 2], [3, 3, 2]), ([2, 2, 1], [2, 2, 1]), ([3, 3, 3], [4, 4, 3])] {
        let blocks = [([0.0; 3], [2.0, 2.0, 1.0], lower), ([0.3, 0.3, 1.0], [1.4, 1.5, 2.0], upper)];
        let mut s = pressed(blocks, "slave = \"upper.boundary\"\nmaster = \"lower.boundary\"");
        let mut active = 0;
        while !s.finished() {
            let record = s.advance().unwrap();
            active = record.contact.map_or(0, |contact| contact.active);
        }
        let bottom = (upper[0] + 1) * (upper[1] + 1);
        assert!(s.step() == 4 && active > 0 && active <= bottom, "{} steps, {active} of {bottom} nodes", s.step());
    }
}

/// A block on a slab of which the facets reach beyond it, pressed in: the block's sides, which these facets see as soon as they bulge, change nothing, whether
/// they are in the master or not.
#[test]
fn sides_of_the_master_do_not_count_in_the_contact_below_it() {
    for multipliers in ["standard", "dual"] {
        let [bottom, boundary] = ["upper.bottom", "upper.boundary"].map(|master| {
            let blocks = [([0.0; 3], [2.0, 2.0, 1.0], [5, 5, 2]), ([0.5, 0.5, 1.0], [1.5, 1.5, 2.0], [3; 3])];
            let contact = format!("slave = \"lower.top\"\nmaster = \"{master}\"\nmultipliers = \"{multipliers}\"");
            last_vertical_force(pressed(blocks, &contact))
        });
        println!("{multipliers}: {bottom} with the bottom alone, {boundary} with all sides");
        assert!(bottom < -10.0 && (boundary / bottom - 1.0).abs() < 1e-3, "{multipliers}: {bottom} {boundary}");
    }
}

/// Pins narrower than a facet of the slab below them, pressed in by the same way: whichever of the two is the slave, it takes about the same force, although
/// of no node of the slab as much as half is covered.
#[test]
fn a_contact_within_one_facet_is_carried_from_both_sides() {
    /// The two sides have different pressures to choose from.
    const SPREAD: f64 = 0.1;
    let forces = |width: f64, multipliers: &str| {
        let [low, high] = [0.5 - 0.5 * width, 0.5 + 0.5 * width];
        [("lower.top", "upper.bottom"), ("upper.bottom", "lower.top")].map(|(slave, master)| {
            let blocks = [([0.0; 3], [2.0, 2.0, 1.0], [2; 3]), ([low, low, 1.0], [high, high, 1.6], [3; 3])];
            let contact = format!("slave = \"{slave}\"\nmaster = \"{master}\"\nmultipliers = \"{multipliers}\"");
            last_vertical_force(pressed(blocks, &contact))
        })
    };
    for width in [0.4, 0.6, 0.8] {
        for multipliers in ["standard", "dual"] {
            // The slab is pushed down, the pin up.
            let [slab, pin] = forces(width, multipliers);
            println!("width {width}, {multipliers}: {slab} with the slab as the slave, {pin} with the pin");
            assert!(pin > 1.0 && (slab / pin + 1.0).abs() < SPREAD, "{width} {multipliers}: {slab} {pin}");
        }
    }
}

/// A block whose sides lean, pressed into a slab that is wider: they face the slab from 15 degrees on, but only the lower side touches it, whichever of the two is
/// the slave.
#[test]
fn leaning_sides_do_not_count_in_the_contact_below_them() {
    let forces = |degrees: f64, surfaces: &str| {
        let (low, top) = (0.5, 0.5 + degrees.to_radians().tan());
        let corners: Vec<[f64; 3]> = [(low, 0.0), (top, 1.0)]
            .iter()
            .flat_map(|&(r, z)| [[-r, -r, z], [r, -r, z], [r, r, z], [-r, r, z]])
            .collect();
        last_vertical_force(simulation(&format!(
            "[scene]\ntitle = \"frustum\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.5\n\
             [[body]]\nname = \"slab\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             mesh = {{ generator = \"block\", min = [-1, -1, -1], max = [1, 1, 0], divisions = [6, 6, 2] }}\n\
             [[body]]\nname = \"block\"\nmaterial = {{ law = \"neo-hooke\", young = 1e5, poisson = 0.3 }}\n\
             mesh = {{ generator = \"hexahedron\", corners = {corners:?}, divisions = [3, 3, 2] }}\n\
             [[prescribe]]\nset = \"slab.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
             [[prescribe]]\nset = \"block.top\"\ncomponents = [\"x\", \"y\", \"z\"]\n\
             displacement = {{ table = [[0, 0, 0, 0], [1, 0, 0, -0.03]] }}\n\
             [[contact]]\nmethod = \"mortar\"\n{surfaces}\n"
        )))
    };
    for degrees in [0.0, 14.0, 16.0, 20.0, 30.0] {
        for (all, bottom) in [
            ("slave = \"slab.top\"\nmaster = \"block.boundary\"", "slave = \"slab.top\"\nmaster = \"block.bottom\""),
            ("slave = \"block.boundary\"\nmaster = \"slab.top\"", "slave = \"block.bottom\"\nmaster = \"slab.top\""),
        ] {
            let (all, bottom) = (forces(degrees, all), forces(degrees, bottom));
            println!("{degrees} degrees: {bottom} with the bottom alone, {all} with all sides");
            // What lies farther away counts for little.
            assert!(bottom.abs() > 10.0 && (all / bottom - 1.0).abs() < 0.02, "{degrees}: {bottom} {all}");
        }
    }
}
